#!/usr/bin/env python3
"""Lines of the sources by their purpose, and their largest parts; status 1 above the bounds below: they fall,
and rise for a capability alone (the graded grid: sources by 1400, tests by 450; the tail of passages: 160 and 70;
loads, radii and speeds over time: 1510 and 920; how sure 60;
point contacts: 2600, 604, 23 and 1,250 words; mixed, starved and warm films: 1624, 883, bench 42; fine grids of histories: 6, 12;
starved rough contacts, asperities beyond an end: 60, 34, how sure 1; point contacts in time: 680, 190, 310 words, how sure 18,
bench 15; tables of cases: 449, 219, 214 words; heat of the inlet: 38, 49, 190 words, how sure 13;
histories that stop: 22, 11, 78 words; models, targets, heat of histories: 179, 116, how sure 95, 144 words;
rows of the bench: 118 words; Eyring's law in all directions of points: 315, 147, 50 words;
histories of points: 251, 45, 49 words; their family of bars: 26, bench 24, 16 words; run_many: 19, 17 words;
limits of points: 41, how sure 8; friction of points to the border and exit: 24, 35;
film floor, film statistics and reversal of points: 114, 51; targets of points in time: 87, 2; round-off at their exit: 5;
adequacy of points: 298, 57, how sure 33; many harmonics: 1, 6;
reversal without drained films: 11, 8, 2 words; random cases of points, histories, mixed films, what they found: 58, 133;
all limits of points, their mixed outcome, the lock before trial runs, bench of their adequacy: 127, 149, how sure 12, bench 17;
spikes of points: 58, 32, how sure 15;
a further case in fewer instructions: 83, 1, 12 words, how sure 1; adequacy in half of them: 75, 23, how sure 82;
areas in fewer: 82, 9; lines of points in fewer: 37; bars of points from few grids: 53, 41, how sure 3, 56 words;
the far field of points that cavitates, their smooth crests, families in time: 55, 26, bench 55, 47 words;
bars of points in time: 40, 11, 43 words; golden cases against planted faults: tests 276)."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPUTES = ("src/film", "src/dry", "src/stokes", "src/numerics", "src/physics", "src/surface", "src/point")
# What tells how sure the numbers are: a folder, and files of others.
SURE = re.compile(r"src/accuracy/|/(contact_edges|grid_comparison|case_notes|(dry_)?adequacy_section)\.f90")
# name: bound
BOUNDS = {
    "sources": 45_771,
    "how sure": 4_964,
    "tests": 31_559,
    "bench": 3_999,
    "words of pages": 44_949,
    "imports of a file": 20,
    "components of a type": 15,
    "procedures of more than 7 arguments": 0,
}


def tracked(*patterns):
    """Paths of tracked files."""
    done = subprocess.run(["git", "ls-files", *patterns], cwd=ROOT, capture_output=True, text=True, check=True)
    return [ROOT / path for path in done.stdout.splitlines() if (ROOT / path).is_file()]


def text_of(path):
    """Text of a file."""
    return path.read_text(encoding="utf-8", errors="replace")


def lines_of(paths):
    """Lines of files together."""
    return sum(len(text_of(path).splitlines()) for path in paths)


def components(text):
    """The most components that a type of a source declares, without those of C."""
    most = 0
    head = r"^ *type\b(?:, *(?:public|abstract|extends\(\w+\)))* *:: *\w+\n"
    for body in re.findall(rf"(?ms){head}(.*?)^ *(?:contains|end type)", text):
        lines = re.findall(r"(?m)^[^!\n]*::(.*)$", re.sub(r"&\n", "", body))
        while any("(" in line for line in lines):
            lines = [re.sub(r"\([^()]*\)", "", line) for line in lines]
        most = max(most, sum(len(line.split(",")) for line in lines))
    return most


def main():
    """Prints all and compares."""
    if not (ROOT / ".git").exists():
        print("size: not applicable without git")
        return 0
    sources = tracked("src/*.f90", "src/*.inc", "app/*.f90")
    name = {path: path.relative_to(ROOT).as_posix() for path in sources}
    sure = [path for path in sources if SURE.search(name[path])]
    computes = [path for path in sources if name[path].startswith(COMPUTES) and path not in sure]
    found = {
        "sources": lines_of(sources),
        "how sure": lines_of(sure),
        "tests": lines_of(tracked("test/*.py", "test/*.pf", "test/*.f90", "test/*.nml", "test/*.toml", "test/*.txt")),
        "bench": lines_of(tracked("bench/*", ":!bench/studies")),
        "words of pages": sum(len(text_of(path).split()) for path in tracked("*.md")),
        "imports of a file": max(len(re.findall(r"(?m)^ *use\b", text_of(path))) for path in sources),
        "procedures of more than 7 arguments": sum(text_of(path).count("allow(too-many-arguments)") for path in sources),
        "components of a type": max(components(text_of(path)) for path in sources),
    }
    print(f"computes {lines_of(computes)} of {found['sources']} lines, {100 * lines_of(computes) / found['sources']:.0f} %")
    for what, number in found.items():
        print(f"{what}: {number}{f', more than {BOUNDS[what]}' if number > BOUNDS[what] else ''}")
    return any(number > BOUNDS[what] for what, number in found.items())


if __name__ == "__main__":
    sys.exit(main())

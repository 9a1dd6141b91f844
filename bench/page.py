#!/usr/bin/env python3
"""Puts what was measured into docs/performance.md, with machine and commit, and its files into docs/images/performance/.

The page is text with blocks between `<!-- NAME: written by bench/page.py -->` and `<!-- NAME: end -->`. Only the blocks
that are named are written anew, from results/; everything else stays as it is.
"""

from __future__ import annotations

import argparse
import csv
import platform
import re
import shutil
import subprocess
import sys
import textwrap
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import dry
import stability_cells
from bench_program import ROOT

RESULTS = ROOT / "results"
PAGE = ROOT / "docs" / "performance.md"
IMAGES = ROOT / "docs" / "images" / "performance"
EPILOG = """example:
  make bench && .venv/bin/python bench/page.py bench"""

CAPTIONS = {
    "moes_barus": "Newtonian contacts, Barus, incompressible, over Moes' numbers (speed sum).",
    "moes_roelands": "The same with Roelands and Dowson-Higginson.",
    "moes_eyring": "The same with an Eyring stress of 3.3 MPa and a slide-to-roll ratio of 5/3.",
    "eyring_stress": "Eyring stress against load.",
    "slide_to_roll": "Eyring stress against slide-to-roll ratio; beyond 2 the surfaces move against each other.",
    "intervals": "Given number of intervals against load, Newtonian and with low Eyring stress.",
    "relaxation": "Relaxation and sweeps of each smoother, on Case 1 and on a heavier Newtonian contact.",
    "coarsest": "Coarsest level of the cycle against load.",
    "time_step": "A ridge passes: time step against slide-to-roll ratio.",
    "rolling": "A ridge rolls into Case 1 without sliding, its oil and a Newtonian one: time step against intervals.",
    "roughness": "A wavy surface at rest under a sliding one: amplitude over central film against wavelength.",
    "ridge": "Ridges of other heights and widths pass as in Case 3.",
}


@dataclass(frozen=True)
class Block:
    """Results that a block needs (below results/), what goes to the images, and its text, made from the paths of the former."""

    needed: Sequence[str]
    images: Sequence[str]
    text: Callable[..., str]


def output_of(*command: str) -> str:
    """Standard output of a command."""
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.strip()


def measured_on() -> str:
    """Processor, cores, compiler and commit in a sentence."""
    cpu = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*:(.+)", cpu)
    processor = " ".join((model[1] if model else platform.processor()).split())
    compiler = output_of("gfortran", "-dumpfullversion")
    commit = output_of("git", "rev-parse", "--short", "HEAD")
    cores = f"{cpu.count('model name')} cores" if cpu else "unknown cores"
    return f"Measured on {processor}, {cores}, gfortran {compiler}, portable build, commit {commit}."


def fenced(text: str) -> str:
    """A block of preformatted text."""
    return f"```text\n{text.rstrip()}\n```\n"


def as_it_is(path: Path) -> str:
    """The text of a file."""
    return fenced(path.read_text(encoding="utf-8"))


def folded(text: str) -> str:
    """A block of preformatted text, long lines folded with their indent."""
    lines = []
    for line in text.splitlines():
        indent = " " * (len(line) - len(line.lstrip()))
        lines += textwrap.wrap(line, 128, subsequent_indent=indent + "    ") or [""]
    return fenced("\n".join(lines))


def conclusion(path: Path) -> str:
    """The text of a file with sentences."""
    return folded(path.read_text(encoding="utf-8"))


def rows(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV file."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def is_right(row: dict[str, str]) -> bool:
    """Whether a cell has converged, however slowly, or its grid or time step is too coarse and was called so."""
    return row["reason"] == "converged" or row["status"] == "too coarse"


def map_text(path: Path) -> str:
    """Figure, caption and counts of one map."""
    name = path.stem.removeprefix("stability_")
    counts: dict[str, Counter] = defaultdict(Counter)
    for row in rows(path):
        counts[row["method"]][is_right(row)] += 1
    parts = []
    for method, count in counts.items():
        right, total = count[True], sum(count.values())
        parts.append(f"{method} {right}" if right < total else f"{method} all")
    total = sum(next(iter(counts.values())).values())
    text = f"{CAPTIONS[name]} Right, of {total} cells each: {'; '.join(parts)}. [CSV](images/performance/{path.name})."
    lines = textwrap.wrap(text, 128, break_on_hyphens=False)
    return f"![{CAPTIONS[name].rstrip('.')}](images/performance/{path.stem}.png)\n\n" + "\n".join(lines) + "\n"


def cells_of_auto(paths: Sequence[Path]) -> str:
    """The cells in which `auto` is not right, or the statement that there are none."""
    bad = []
    total = 0
    for path in paths:
        for row in rows(path):
            if row["method"].startswith("auto"):
                total += 1
                if not is_right(row):
                    x, y = list(row)[1:3]
                    name = path.stem.removeprefix("stability_")
                    bad.append(f"- {name}, {row['method']}, {x} = {row[x]}, {y} = {row[y]}: {row['status']}")
    if not bad:
        return f"`auto` is right in all {total} cells of these maps.\n"
    return f"`auto` is right in {total - len(bad)} of {total} cells of these maps. The others:\n\n" + "\n".join(bad) + "\n"


def maps_text(*paths: Path) -> str:
    """All maps."""
    return "\n".join([cells_of_auto(paths), *map(map_text, paths)])


def dry_text(path: Path) -> str:
    """The table of `make bench-dry`."""
    return folded("\n".join(dry.line_of(row) for row in rows(path)))


MAPS = [f"stability/stability_{name}" for name in stability_cells.NAMES]
BLOCKS = {
    "bench": Block(["bench/bench.txt"], ["bench/bench.csv"], as_it_is),
    "chart": Block(["chart/conclusion.txt"], ["chart/chart.png", "chart/chart.csv", "chart/chart_models.csv"], conclusion),
    "accuracy": Block(["accuracy/conclusion.txt"], ["accuracy/accuracy.csv", "accuracy/cost.csv"], conclusion),
    "accuracy_time": Block(["accuracy/conclusion_time.txt"], ["accuracy/accuracy_time.csv", "accuracy/cost_time.csv"], conclusion),
    "families": Block(["accuracy/families.txt"], [], as_it_is),
    "stability": Block(
        [f"{name}.csv" for name in MAPS], [f"{name}{kind}" for name in MAPS for kind in (".csv", ".png")], maps_text
    ),
    "dry": Block(["bench/dry.csv"], ["bench/dry.csv"], dry_text),
    "adequacy": Block(["adequacy/adequacy.txt"], [], as_it_is),
}


def with_block(page: str, name: str, text: str) -> str:
    """The page with another text in one of its blocks. Raises ValueError if the page has no such block."""
    begin, end = f"<!-- {name}: written by bench/page.py -->\n", f"<!-- {name}: end -->\n"
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        raise ValueError(f"expected one block between {begin.strip()} and {end.strip()}")
    return page[: page.index(begin) + len(begin)] + text + page[page.index(end) :]


def put_block(name: str, text: str) -> None:
    """Puts a text, what it was measured on in front of it, into a block of the page. Raises ValueError."""
    page = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(with_block(page, name, f"{measured_on()}\n\n{text}"), encoding="utf-8")


def main() -> int:
    """Writes the blocks; status 1 if one has no results."""
    parser = argparse.ArgumentParser(description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", metavar="NAME", help=f"blocks: {', '.join(BLOCKS)}")
    names = parser.parse_args().names
    if unknown := set(names) - set(BLOCKS):
        parser.error(f"found {', '.join(sorted(unknown))}, expected some of {', '.join(BLOCKS)}")
    status = 0
    for name in names:
        block = BLOCKS[name]
        needed, images = ([RESULTS / path for path in paths] for paths in (block.needed, block.images))
        if missing := [str(path.relative_to(ROOT)) for path in (*needed, *images) if not path.exists()]:
            print(f"{name}: stays, missing: {', '.join(missing[:3])}", file=sys.stderr)
            status = 1
            continue
        put_block(name, block.text(*needed))
        for path in images:
            shutil.copy(path, IMAGES)
        print(f"{name}: written")
    return status


if __name__ == "__main__":
    sys.exit(main())

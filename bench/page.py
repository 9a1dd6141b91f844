#!/usr/bin/env python3
"""Copies measured tables and figures into docs/performance.md and docs/images/performance/, with machine and commit.

Only the named blocks between `<!-- NAME: written by bench/page.py -->` and `<!-- NAME: end -->` are rewritten, from results/.
"""

from __future__ import annotations

import argparse
import platform
import re
import shutil
import subprocess
import sys
import textwrap
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path

from bench_program import ROOT, read_csv
from families import FAMILIES
from judge import JUDGED, Row, is_tight, is_within, share
from stability_cells import NAMES

RESULTS, PAGE, IMAGES = ROOT / "results", ROOT / "docs" / "performance.md", ROOT / "docs" / "images" / "performance"


def measured_on() -> str:
    """Processor, cores, compiler and commit in a sentence."""

    def output_of(*command: str) -> str:
        return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.strip()

    cpu = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    model = re.search(r"model name\s*:(.+)", cpu)
    processor = " ".join((model[1] if model else platform.processor()).split())
    cores = f"{cpu.count('model name')} cores" if cpu else "unknown cores"
    built = f"gfortran {output_of('gfortran', '-dumpfullversion')}, commit {output_of('git', 'rev-parse', '--short', 'HEAD')}"
    return f"Measured on {processor}, {cores}, {built}."


def fenced(text: str) -> str:
    """A block of preformatted text."""
    return f"```text\n{text.rstrip()}\n```\n"


def folded(text: str) -> str:
    """A block of preformatted text, long lines folded with their indent."""
    lines = []
    for line in text.splitlines():
        indent = " " * (len(line) - len(line.lstrip()))
        lines += textwrap.wrap(line, 128, subsequent_indent=indent + "    ") or [""]
    return fenced("\n".join(lines))


def as_it_is(*paths: Path) -> str:
    """The text of files."""
    return folded("".join(path.read_text(encoding="utf-8") for path in paths))


def bench_text(path: Path) -> str:
    """Targets of speed and memory, and the median of what was measured; a star where that misses the target."""
    lines = []
    for row in (row for row in read_csv(path) if row["asked"]):
        star = "*" * (row["verdict"] in {"MISSED", "met (min.)", "met (CPU)"})
        line = f"{row['work']:<44} <= {float(row['asked']):<6g} {float(row['median']):8.3g} {row['unit']:<2} {star}"
        lines.append(line.rstrip())
    return fenced("\n".join(lines))


def families_text(path: Path) -> str:
    """A line a family: quantities judged, shares, and behind a star those of its quantities that miss a target."""
    found: dict[str, dict[str, list[Row]]] = defaultdict(lambda: defaultdict(list))
    numbers = ("value", "estimate", "true_error", "intervals")
    for row in read_csv(path):
        each = Row(**{key: float(value) if key in numbers else value for key, value in row.items()})
        if each.verdict == JUDGED:
            found[each.family][each.quantity.removeprefix("summary/")].append(each)
    asked = {family.name: family.asked for family in FAMILIES}
    lines = [f"{'family':26s} {'judged':>6s} {'within [%]':>10s} {'below 10 x [%]':>14s}"]
    for family, quantities in found.items():
        every = [row for own in quantities.values() for row in own]
        within, tight = asked[family]
        missed = [name for name, own in quantities.items() if share(own, is_within) < within or share(own, is_tight) < tight]
        shares = f"{100 * share(every, is_within):10.1f} {100 * share(every, is_tight):14.1f}"
        lines.append(f"{family:26s} {len(every):6d} {shares}" + (f"  * {', '.join(missed)}" if missed else ""))
    return fenced("\n".join(lines))


def maps_text(*paths: Path) -> str:
    """Cells in which each method is right: it converges, or its grid or step is too coarse and was called so."""
    lines = ["| map | cells | right |", "|---|---|---|"]
    for path in paths:
        right: dict[str, list[bool]] = defaultdict(list)
        for row in read_csv(path):
            right[row["method"]].append(row["reason"] == "converged" or row["status"] == "too coarse")
        words = "; ".join(f"{method} {sum(each)}" for method, each in right.items() if not all(each))
        lines.append(f"| {path.stem[10:]} | {len(next(iter(right.values())))} | {words + '; the others ' if words else ''}all |")
    return "\n".join(lines) + "\n"


def dry_text(path: Path) -> str:
    """The table of `make bench-dry`, the shares of contact [%] of a row beside each other."""
    groups = defaultdict(list)
    for row in read_csv(path):
        groups[re.sub(r", \d+ %", "", row["work"])].append(row)
    lines = []
    for work, own in groups.items():
        cells = [f"{share[0][:-2]}: " if (share := re.findall(r"\d+ %", row["work"])) else "" for row in own]
        cells = [f"{cell}{row['value']}{'*' * (row['verdict'] == 'MISSED')}" for cell, row in zip(cells, own, strict=True)]
        sign = ">=" if own[0]["unit"] == "times" else "<="
        lines.append(f"{work:<44} {sign} {own[0]['asked']:>4} {own[0]['unit']:<6} {'; '.join(cells)}")
    return fenced("\n".join(lines))


# Of each block what it needs below results/, the figures, and its text, made from the paths of the former; auto.py writes `auto`.
BLOCKS: dict[str, tuple[list[str], list[str], Callable[..., str]]] = {
    "bench": (["bench/bench.csv"], [], bench_text),
    "chart": (["chart/conclusion.txt"], ["chart/chart.png"], as_it_is),
    "targets": (["accuracy/cost_time.txt"], [], as_it_is),
    "families": (["accuracy/families.csv"], [], families_text),
    "passages": (["accuracy/passages/families.csv"], [], families_text),
    "stability": ([f"stability/stability_{name}.csv" for name in NAMES], ["stability/stability.png"], maps_text),
    "dry": (["bench/dry.csv"], [], dry_text),
    "adequacy": (["adequacy/adequacy.txt"], [], as_it_is),
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
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+", metavar="NAME", choices=BLOCKS, help=f"blocks: {', '.join(BLOCKS)}")
    status = 0
    for name in parser.parse_args().names:
        needed, images, text = BLOCKS[name]
        needed, images = ([RESULTS / path for path in paths] for paths in (needed, images))
        if missing := [str(path.relative_to(ROOT)) for path in (*needed, *images) if not path.exists()]:
            print(f"{name}: stays, missing: {', '.join(missing[:3])}", file=sys.stderr)
            status = 1
            continue
        put_block(name, text(*needed))
        for path in images:
            shutil.copy(path, IMAGES)
        print(f"{name}: written")
    return status


if __name__ == "__main__":
    sys.exit(main())

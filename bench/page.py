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
from collections.abc import Callable
from pathlib import Path

import pandas as pd
from bench_program import ROOT
from stability import is_right
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
    """A block of preformatted text, long lines folded with their indent."""
    lines = []
    for line in text.rstrip().splitlines():
        indent = " " * (len(line) - len(line.lstrip()))
        lines += textwrap.wrap(line, 128, subsequent_indent=indent + "    ") or [""]
    return "```text\n" + "\n".join(lines) + "\n```\n"


def as_it_is(*paths: Path) -> str:
    """The text of files."""
    return fenced("".join(path.read_text(encoding="utf-8") for path in paths))


def bench_text(path: Path) -> str:
    """Targets of speed and memory, and the median of what was measured; a star where that misses the target."""
    rows = pd.read_csv(path).dropna(subset=["asked"]).fillna({"unit": ""})
    stars = rows["verdict"] != "met"
    lines = [
        f"{work:<44} <= {asked:<6g} {median:8.3g} {unit:<2} {'*' * star}".rstrip()
        for work, asked, median, unit, star in zip(*(rows[key] for key in ("work", "asked", "median", "unit")), stars, strict=True)
    ]
    return fenced("\n".join(lines))


def maps_text(*paths: Path) -> str:
    """Cells in which each method is right: it converges, or its grid or step is too coarse and was called so."""
    lines = ["| map | cells | right |", "|---|---|---|"]
    for path in paths:
        rows = pd.read_csv(path)
        right = is_right(rows).groupby(rows["method"], sort=False).agg(["sum", "size"])
        words = "; ".join(f"{method} {count}" for method, count in right["sum"][right["sum"] < right["size"]].items())
        lines.append(f"| {path.stem[10:]} | {right['size'].iloc[0]} | {words + '; the others ' if words else ''}all |")
    return "\n".join(lines) + "\n"


def dry_text(path: Path) -> str:
    """The table of `make bench-dry`, the shares of contact [%] of a row beside each other."""
    rows, lines = pd.read_csv(path), []
    for work, own in rows.groupby(rows["work"].str.replace(r", \d+ %", "", regex=True), sort=False):
        shares = own["work"].str.extract(r"(\d+) %")[0].add(": ").fillna("")
        cells = shares + own["median"].map("{:.3g}".format) + own["verdict"].eq("MISSED").map({True: "*", False: ""})
        sign, unit = (">=" if own["unit"].iloc[0] == "times" else "<="), own["unit"].iloc[0]
        lines.append(f"{work:<44} {sign} {own['asked'].iloc[0]:>4g} {unit:<6} {'; '.join(cells)}")
    return fenced("\n".join(lines))


# Of each block what it needs below results/, the figures, and its text, made from the paths of the former.
BLOCKS: dict[str, tuple[list[str], list[str], Callable[..., str]]] = {
    "bench": (["bench/bench.csv"], [], bench_text),
    "chart": (["chart/conclusion.txt"], ["chart/chart.png"], as_it_is),
    "targets": (["accuracy/cost_time.txt"], [], as_it_is),
    "families": (["accuracy/families.txt"], [], as_it_is),
    "passages": (["accuracy/passages/families.txt"], [], as_it_is),
    "stability": ([f"stability/stability_{name}.csv" for name in NAMES], ["stability/stability.png"], maps_text),
    "dry": (["bench/dry.csv"], [], dry_text),
    "adequacy": (["adequacy/adequacy.txt"], [], as_it_is),
    "auto": (["auto/auto.txt"], ["auto/auto.png"], as_it_is),
}


def with_block(page: str, name: str, text: str) -> str:
    """The page with another text in one of its blocks. Raises ValueError if the page has no such block."""
    begin, end = f"<!-- {name}: written by bench/page.py -->\n", f"<!-- {name}: end -->\n"
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        raise ValueError(f"expected one block between {begin.strip()} and {end.strip()}")
    return page[: page.index(begin) + len(begin)] + text + page[page.index(end) :]


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
        page = with_block(PAGE.read_text(encoding="utf-8"), name, f"{measured_on()}\n\n{text(*needed)}")
        PAGE.write_text(page, encoding="utf-8")
        for path in images:
            shutil.copy(path, IMAGES)
        print(f"{name}: written")
    return status


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Are the error bars of transients honest, and what does a wanted accuracy cost in time? A survey of passages.

Ridges, dents, features that overtake, waviness and roughness on either surface pass through contacts of five loads, three oils
and slide-to-roll ratios from -1.9 to 4 (module passages), on 256 intervals with dT = dX. The figures of /summary, extremes over
the passage, and their estimates (`error_grid`: grid and time step) are compared with the same passage on four times the intervals
and a fourth of the step. For a wanted accuracy of h_min: whether it is met against the same finer answer, and the wall time,
choice included, beside that of the cheapest fixed choice of 2^k intervals, dT = dX, that meets it. Writes accuracy_time.csv,
cost_time.csv and conclusion_time.txt.
"""

from __future__ import annotations

import csv
import math
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import h5py
from bench_program import ENVIRONMENT, ROOT, new_parser, output_folder
from passages import Passage, passages

PROGRAM = ROOT / "build" / "bin" / "asperity"
FIGURES = ("h_min", "h_central", "p_max")
INTERVALS, FINER = 256, 4
TARGET = 1e-2
NO_BARS = {"error_bars": False}
LARGEST = 2048


@dataclass
class Row:
    """A figure of a passage, dimensionless; estimate is NaN where there is none."""

    passage: str
    figure: str
    value: float
    true_error: float
    estimate: float


@dataclass
class Result:
    """What is read of a result file."""

    converged: bool
    values: dict[str, float]
    estimates: dict[str, float]
    intervals: int
    seconds: float


def read(path: Path) -> Result:
    """A result file."""
    with h5py.File(path) as file:
        summary = file["summary"]
        values = {name: float(summary[name].attrs["dimensionless"]) for name in FIGURES}
        scale = {name: float(summary[name][()]) / values[name] for name in FIGURES}
        estimates = {name: float(summary[name].attrs.get("error_grid", math.nan)) / scale[name] for name in FIGURES}
        intervals = len(file["solution/x"]) - 1
        return Result(file.attrs["converged"] == 1, values, estimates, intervals, float(file["report/wall_seconds"][()]))


def solve(texts: dict[str, str], folder: Path, processes: int) -> dict[str, Result]:
    """Results by name; those without a solution too."""
    for name, text in texts.items():
        (folder / f"{name}.nml").write_text(text, encoding="utf-8")
    command = ["xargs", "-P", str(processes), "-n", "4", str(PROGRAM), "--quiet", "--output", str(folder)]
    names = "\n".join(str(folder / f"{name}.nml") for name in texts)
    subprocess.run(command, input=names, text=True, env=ENVIRONMENT, check=False, stderr=subprocess.DEVNULL)
    found = {name: read(folder / f"{name}.h5") for name in texts}
    for name in texts:
        (folder / f"{name}.h5").unlink()
    return found


def survey(cases: list[Passage], folder: Path) -> list[Row]:
    """The figures of all passages beside their finer answers."""
    rows = []
    for start in range(0, len(cases), 16):
        batch = cases[start : start + 16]
        texts = {case.name: case.namelist(INTERVALS, 1) for case in batch}
        texts |= {f"{case.name}_fine": case.namelist(FINER * INTERVALS, 1, accuracy=NO_BARS) for case in batch}
        found = solve(texts, folder, 2)
        for case in batch:
            own, fine = found[case.name], found[f"{case.name}_fine"]
            if own.converged and fine.converged:
                rows += [
                    Row(case.name, name, own.values[name], abs(own.values[name] - fine.values[name]), own.estimates[name])
                    for name in FIGURES
                ]
    return rows


@dataclass
class Cost:
    """A wanted accuracy of h_min: what it gave, and the time beside that of the best fixed choice."""

    passage: str
    target: float
    true_error: float
    intervals: int
    seconds: float
    best_intervals: int
    best_seconds: float


def costs(cases: list[Passage], folder: Path) -> list[Cost]:
    """The wanted accuracy of each passage, one run after another."""
    found = []
    for case in cases:
        wanted = solve({"wanted": case.namelist(None, accuracy={"target": TARGET})}, folder, 1)["wanted"]
        if not wanted.converged or wanted.intervals > LARGEST:
            continue
        sizes = [2**k for k in range(6, round(math.log2(FINER * wanted.intervals)) + 1)]
        ladder = solve({f"n{n}": case.namelist(n, accuracy=NO_BARS) for n in sizes}, folder, 1)
        exact = ladder[f"n{sizes[-1]}"].values["h_min"]
        good = [n for n in sizes if ladder[f"n{n}"].converged and abs(ladder[f"n{n}"].values["h_min"] / exact - 1) <= TARGET]
        first = next(n for n in good if all(m in good for m in sizes if m >= n))
        error = abs(wanted.values["h_min"] / exact - 1)
        seconds = ladder[f"n{first}"].seconds
        found.append(Cost(case.name, TARGET, error, wanted.intervals, wanted.seconds, first, seconds))
    return found


def conclusion(rows: list[Row], found: list[Cost], count: int) -> str:
    """What the numbers say."""
    lines = [f"{len(rows) // len(FIGURES)} of {count} passages converged on both grids"]
    for name in FIGURES:
        known = [row for row in rows if row.figure == name and math.isfinite(row.estimate)]
        below = sum(row.true_error <= row.estimate for row in known) / len(known)
        tight = sum(row.estimate < 10 * row.true_error for row in known) / len(known)
        middle = statistics.median(row.true_error / row.value for row in known)
        lines.append(
            f"{name}: {len(known)} with an estimate; true error below it in {100 * below:.1f} % (asked 95),"
            f" estimate below 10 x the true error in {100 * tight:.1f} % (asked 80); median true error {100 * middle:.2g} %"
        )
    if found:
        met = sum(cost.true_error <= cost.target for cost in found) / len(found)
        ratios = sorted(cost.seconds / cost.best_seconds for cost in found)
        lines.append(
            f"&accuracy target = {TARGET:g} on h_min, {len(found)} passages: met in {100 * met:.1f} % (asked 95), cost over the"
            f" best fixed choice: median {statistics.median(ratios):.2g}, largest {ratios[-1]:.2g} (asked 2)"
        )
    return "\n".join(lines) + "\n"


def save(items: list[Row] | list[Cost], path: Path) -> None:
    """As CSV."""
    if not items:
        return
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(vars(items[0])))
        writer.writeheader()
        writer.writerows(vars(item) for item in items)


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "fewer passages", "results/accuracy")
    parser.add_argument("--no-cost", action="store_true", help="the error bars only")
    options = parser.parse_args()
    folder = output_folder(options)
    count = 40 if options.quick else 120
    with tempfile.TemporaryDirectory() as scratch:
        rows = survey(passages(count), Path(scratch))
        found = [] if options.no_cost else costs(passages(count)[: 12 if options.quick else 40], Path(scratch))
    save(rows, folder / "accuracy_time.csv")
    save(found, folder / "cost_time.csv")
    text = conclusion(rows, found, count)
    (folder / "conclusion_time.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())

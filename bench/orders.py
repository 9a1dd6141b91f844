#!/usr/bin/env python3
"""Table of the observed orders in time: a ridge enters the contact of Case 1 on the fast surface, from X = -1.5.

The error is the largest one in P over all nodes and all times of the run, the first step included. First on one grid, against
the same grid with a far smaller time step (the error of time alone), then with the time step in proportion to the grid, against
a finer grid (the error of both). Writes orders.csv and orders.txt.
"""

from __future__ import annotations

import csv
import math
import sys

import bench_program
import namelists
from bench_program import job, new_parser, output_folder

SCHEMES = {"backward Euler": "backward_euler", "BDF2": "bdf2"}
START, END_OVER_DX = -1.5, 28  # of 256 intervals


def text(intervals: int, steps_per_dx: float, scheme: str, tolerance: float) -> str:
    """The passage with time steps of dX/steps_per_dx."""
    ridge = namelists.RIDGE | {"position": START}
    time = {"transient": True, "end_time": END_OVER_DX * 5.5 / 256, "time_step": 5.5 / intervals / steps_per_dx, "scheme": scheme}
    return namelists.case_1(intervals, {"tolerance": tolerance}, surface_2=ridge, time=time)


def errors(runs: list[tuple[int, float]], reference: tuple[int, float]) -> dict[str, list[float]]:
    """Largest error of P by scheme for (intervals, steps per dX)."""
    jobs = [job("reference", text(*reference, "bdf2", 1e-8), reference=1)]
    for name, scheme in SCHEMES.items():
        jobs += [job(f"{name}:{i}".replace(" ", "_"), text(*run, scheme, 1e-9), compare=1) for i, run in enumerate(runs)]
    answers = bench_program.run(jobs)
    bad = [answer["reason"] for answer in answers.values() if not answer.converged]
    if bad:
        sys.exit("\n".join(bad))
    return {name: [answers[f"{name}:{i}".replace(" ", "_")]["difference"] for i in range(len(runs))] for name in SCHEMES}


def table(title: str, runs: list[tuple[int, float]], found: dict[str, list[float]]) -> list[str]:
    """The errors and the order between each run and the one above it."""
    lines = [title, f"{'intervals':>9s} {'dX/dT':>6s}" + "".join(f" {name:>15s} {'order':>6s}" for name in found)]
    for i, (intervals, steps_per_dx) in enumerate(runs):
        line = f"{intervals:9d} {steps_per_dx:6g}"
        for values in found.values():
            order = f"{math.log2(values[i - 1] / values[i]):6.2f}" if i else "      "
            line += f" {values[i]:15.2e} {order}"
        lines.append(line)
    return lines


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "coarser grids", "results/orders")
    options = parser.parse_args()
    folder = output_folder(options)
    fixed = 128 if options.quick else 256
    in_time = [(fixed, factor) for factor in (1, 2, 4, 8, 16)]
    in_both = [(n, 2) for n in ((64, 128, 256) if options.quick else (64, 128, 256, 512, 1024))]
    lines, rows = [], []
    for title, runs, reference in (
        (f"Time alone: {fixed} intervals, dT halved; largest error of P", in_time, (fixed, 64)),
        ("Time and grid: dT = dX/2; largest error of P", in_both, (4 * in_both[-1][0], 2)),
    ):
        found = errors(runs, reference)
        lines += [*table(title, runs, found), ""]
        for name, values in found.items():
            rows += [(title.split(":")[0], name, *run, value) for run, value in zip(runs, values, strict=True)]
    (folder / "orders.txt").write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
    with (folder / "orders.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("table", "scheme", "intervals", "steps_per_dx", "error"))
        writer.writerows(rows)
    print("\n".join(lines[:-1]))
    return 0


if __name__ == "__main__":
    sys.exit(main())

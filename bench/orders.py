#!/usr/bin/env python3
"""Tabulates the observed orders in time: a ridge enters the contact of Case 1 on the fast surface, from X = -1.5.

The error is the largest one in P over all nodes and times, the first step included: first on one grid, against a far smaller time
step (the error of time alone), then with the time step in proportion to the grid, against a finer grid (both errors). Writes
orders.csv and orders.txt.
"""

from __future__ import annotations

import math
import sys

import bench_program
import namelists
from bench_program import conclude, job, new_parser, output_folder, write_csv

SCHEMES = {"backward Euler": "backward_euler", "BDF2": "bdf2"}
Run = tuple[int, float]


def text(run: Run, scheme: str, tolerance: float) -> str:
    """The passage of 28 spacings of 256 intervals with time steps of dX/steps_per_dx."""
    intervals, steps_per_dx = run
    time = {"transient": True, "end_time": 28 * 5.5 / 256, "time_step": 5.5 / intervals / steps_per_dx, "scheme": scheme}
    return namelists.case_1(intervals, {"tolerance": tolerance}, surface_2=namelists.RIDGE | {"position": -1.5}, time=time)


def errors(runs: list[Run], reference: Run) -> dict[str, list[float]]:
    """Largest error of P by scheme for (intervals, steps per dX)."""
    jobs = [job("reference", text(reference, "bdf2", 1e-8), reference=1)]
    jobs += [job(f"{s}:{i}", text(run, s, 1e-9), compare=1) for s in SCHEMES.values() for i, run in enumerate(runs)]
    answers = bench_program.run(jobs)
    if bad := [answer["reason"] for answer in answers.values() if not answer.converged]:
        sys.exit("\n".join(bad))
    return {name: [answers[f"{s}:{i}"]["difference"] for i in range(len(runs))] for name, s in SCHEMES.items()}


def table(title: str, runs: list[Run], found: dict[str, list[float]]) -> list[str]:
    """The errors and the order between each run and the one above it."""
    lines = [title, f"{'intervals':>9s} {'dX/dT':>6s}" + "".join(f" {name:>15s} {'order':>6s}" for name in found)]
    for i, run in enumerate(runs):
        orders = [f"{math.log2(values[i - 1] / values[i]):6.2f}" if i else " " * 6 for values in found.values()]
        cells = (f" {values[i]:15.2e} {order}" for values, order in zip(found.values(), orders, strict=True))
        lines.append(f"{run[0]:9d} {run[1]:6g}{''.join(cells)}")
    return lines


def main() -> int:
    """Command line."""
    options = new_parser(__doc__, "coarser grids", "results/orders").parse_args()
    folder, fixed = output_folder(options), 128 if options.quick else 256
    in_both = [(n, 2) for n in ((64, 128, 256) if options.quick else (64, 128, 256, 512, 1024))]
    lines, rows = [], []
    for title, runs, reference in (
        (f"Time alone: {fixed} intervals, dT halved", [(fixed, factor) for factor in (1, 2, 4, 8, 16)], (fixed, 64)),
        ("Time and grid: dT = dX/2", in_both, (4 * in_both[-1][0], 2)),
    ):
        found = errors(runs, reference)
        lines += [*table(f"{title}; largest error of P", runs, found), ""]
        rows += [(title.split(":")[0], name, *run, v) for name, vs in found.items() for run, v in zip(runs, vs, strict=True)]
    write_csv(folder / "orders.csv", ("table", "scheme", "intervals", "steps_per_dx", "error"), rows)
    conclude(folder / "orders.txt", "\n".join(lines[:-1]) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

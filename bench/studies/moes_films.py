#!/usr/bin/env python3
"""Films of the smooth contact over Moes' numbers M and L, for the regime chart (postproc/regime.py): postproc/data/moes_films.csv.

A Newtonian oil of constant density and Barus viscosity, which depends on M and L only; each film to 0.3 % of its smallest.
"""

from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path

import h5py
from study import ROOT, Case, Runner, finish, new_parser

PROGRAM = "moes_films.py"
TABLE = ROOT / "postproc" / "data" / "moes_films.csv"
LOADS = tuple(10 ** (k / 8) for k in range(-8, 25))
OILS = (0.0, 0.5, 1.0, 2.5, 5.0, 7.5, 10.0, 15.0, 20.0, 30.0, 40.0)
TARGET = 3e-3
HEADER = (
    "Films of the smooth line contact over M and L (sum of the speeds), in Moes units (h/R) sqrt(E'R/(mu_0 u_s)), estimated errors",
    "Barus, Newtonian, constant density; by make regime (bench/studies/moes_films.py)",
)
COLUMNS = ("moes_m", "moes_l", "h_min", "h_min_error", "h_central", "h_central_error")


def contact(moes_m: float, moes_l: float) -> Case:
    """The namelist of one point."""
    return {
        "case": {"problem": "ehl_line"},
        "moes": {"moes_m": moes_m, "moes_l": moes_l, "velocity": "sum"},
        "lubricant": {"viscosity_law": "barus", "density_law": "constant"},
        "accuracy": {"target": TARGET},
    }


def films(_: str, path: Path) -> list[float]:
    """Smallest and central film with their errors; the result has them with the mean speed."""
    with h5py.File(path) as file:
        values = [file[f"summary/{name}_moes"] for name in ("h_min", "h_central")]
        return [number / math.sqrt(2) for value in values for number in (value[()], value.attrs["error_estimate"])]


def study(options: argparse.Namespace) -> None:
    """All points, and the table; the quick one, of a few points, goes to the folder of the results."""
    runner = Runner(options.output, options.jobs, options.program)
    points = [(load, oil) for oil in OILS for load in (LOADS[::8] if options.quick else LOADS)]
    found = runner.run({f"m{load:.4g}_l{oil:g}": contact(load, oil) for load, oil in points}, films)
    target = options.output / TABLE.name if options.quick else TABLE
    with target.open("w", newline="", encoding="utf-8") as file:
        file.writelines(f"# {line}\n" for line in HEADER)
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(
            [f"{value:.6g}" for value in (*point, *values)] for point, values in zip(points, found.values(), strict=True)
        )
    print(target)


def main() -> None:
    """Command line."""
    finish(new_parser(PROGRAM, __doc__, "results/regime"), study)


if __name__ == "__main__":
    main()

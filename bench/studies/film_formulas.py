#!/usr/bin/env python3
"""Bias of film formulas: Dowson-Higginson, Dowson-Toyoda and Moes against random smooth contacts.

Steel in mineral and synthetic oils, rolling, each contact with the viscosity of Roelands and Barus, with constant density and
with that of Dowson and Higginson; each film to 0.3 % of the smallest. Each bias is given as the range of nine tenths of the
contacts and the whole range; that of h_central with that density also without it. The tables are in docs/theory.md and
src/physics/moes.f90.
"""

from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path

import h5py
import numpy as np
from study import Case, Runner, finish, new_parser

PROGRAM = "film_formulas.py"
TARGET = 3e-3
SEED, CONTACTS, QUICK = 17, 240, 12
MODULUS = 226e9
# Ends of radius [m], Hertzian pressure [Pa], viscosity [Pa s], alpha [1/Pa], mean speed [m/s]; all but the pressure as logarithms.
ENDS = ((2e-3, 0.1), (0.3e9, 2e9), (5e-3, 0.5), (1e-8, 3e-8), (0.05, 20.0))
M_RANGE, L_RANGE = (3.0, 500.0), (5.0, 30.0)
VISCOSITIES, DENSITIES = ("roelands", "barus"), ("constant", "dowson_higginson")
FORMULAS = {"Dowson-Higginson": "h_min", "Dowson-Toyoda": "h_central", "Moes": "h_central"}


def contacts(number: int) -> list[dict[str, float]]:
    """Random contacts within the ranges of M and L (mean speed)."""
    source = np.random.default_rng(SEED)
    found = []
    while len(found) < number:
        radius, pressure, viscosity, alpha, speed = (
            source.uniform(*ends) if ends[1] > 1e8 else math.exp(source.uniform(*map(math.log, ends))) for ends in ENDS
        )
        load = 2 * math.pi * radius * pressure**2 / MODULUS
        speed_number = viscosity * speed / (MODULUS * radius)
        moes_m, moes_l = load / (MODULUS * radius) / math.sqrt(speed_number), alpha * MODULUS * speed_number**0.25
        if M_RANGE[0] <= moes_m <= M_RANGE[1] and L_RANGE[0] <= moes_l <= L_RANGE[1]:
            found.append({"radius": radius, "pressure": pressure, "viscosity": viscosity, "alpha": alpha, "speed": speed})
    return found


def case_of(contact: dict[str, float], viscosity: str, density: str) -> Case:
    """The namelist of a contact with two laws."""
    oil = {"viscosity": contact["viscosity"], "pressure_viscosity": contact["alpha"], "viscosity_law": viscosity}
    return {
        "case": {"problem": "ehl_line"},
        "bodies": {
            "reduced_radius": contact["radius"],
            "reduced_modulus": MODULUS,
            "speed_1": contact["speed"],
            "speed_2": contact["speed"],
        },
        "load": {"hertz_pressure": contact["pressure"]},
        "lubricant": oil | {"density_law": density},
        "accuracy": {"target": TARGET},
        "output": {"adequacy": False, "si_copies": False},
    }


def differences(_: str, path: Path) -> list[float]:
    """By how much each formula lies above the computed film; M, L, and the density at the Hertzian pressure."""
    with h5py.File(path) as file:
        scale, summary = file["scaling"].attrs, file["summary"]
        radius, modulus = scale["reduced_radius"], scale["reduced_modulus"]
        speed = scale["viscosity"] * scale["speed_sum"] / 2 / (modulus * radius)
        material = scale["alpha_bar"] / scale["hertz_pressure"] * modulus
        load = scale["load_per_length"] / (modulus * radius)
        films = {
            "Dowson-Higginson": 2.65 * speed**0.7 * material**0.54 * load**-0.13 * radius,
            "Dowson-Toyoda": 3.06 * speed**0.69 * material**0.56 * load**-0.10 * radius,
            "Moes": moes(scale["moes_m_sum"], scale["moes_l_sum"]) * math.sqrt(2 * speed) * radius,
        }
        above = [film / summary[FORMULAS[name]][()] - 1 for name, film in films.items()]
        pressure = scale["hertz_pressure"]
        return [*above, scale["moes_m"], scale["moes_l"], (5.9e8 + 1.34 * pressure) / (5.9e8 + pressure)]


def moes(m: float, l: float) -> float:  # noqa: E741  Moes' letter
    """Central film by the fit of Nijenbanning, Venner and Moes for lines, in Moes units of the sum of the speeds."""
    rigid_iso, elastic_iso = 2.4475 / m, 2.621 * m**-0.2
    rigid_piezo, elastic_piezo = 1.287 * l ** (2 / 3), 1.311 * m**-0.125 * l**0.75
    power = (7 + 8 * math.exp(-2 * elastic_iso / rigid_iso)) / 5
    isoviscous = (rigid_iso ** (7 / 3) + elastic_iso ** (7 / 3)) ** (3 / 7)
    piezoviscous = (rigid_piezo**-3.5 + elastic_piezo**-3.5) ** (-2 / 7)
    return (isoviscous**power + piezoviscous**power) ** (1 / power)


def ranges(rows: np.ndarray) -> list[str]:
    """For each formula the bias of nine contacts of ten, and of all [%]."""
    inner, outer = (100 * np.percentile(rows[:, :3], ends, axis=0).T for ends in ((5, 95), (0, 100)))
    return [f"{a:+.0f} to {b:+.0f} % ({c:+.0f} to {d:+.0f} %)" for (a, b), (c, d) in zip(inner, outer, strict=True)]


def study(options: argparse.Namespace) -> None:
    """All contacts with all laws; a table of the bias of each formula."""
    runner = Runner(options.output, options.jobs, options.program)
    laws = [(viscosity, density) for viscosity in VISCOSITIES for density in DENSITIES]
    chosen = contacts(QUICK if options.quick else CONTACTS)
    cases = {f"{i}_{v}_{d}": case_of(contact, v, d) for i, contact in enumerate(chosen) for v, d in laws}
    found = {name: np.array(values) for name, values in runner.run(cases, differences).items()}
    with (options.output / "film_formulas.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", *FORMULAS, "moes_m", "moes_l", "density"])
        writer.writerows([name, *(f"{value:.6g}" for value in values)] for name, values in found.items())
    print(f"{len(chosen)} contacts; {runner.effort}")
    print("| viscosity | density |", " | ".join(f"{name}, {film}" for name, film in FORMULAS.items()), "|")
    for viscosity, density in laws:
        rows = np.array([values for name, values in found.items() if name.endswith(f"_{viscosity}_{density}")])
        print(f"| {viscosity} | {density} |", " | ".join(ranges(rows)), "|")
        if density != "constant":
            rows[:, 1:3] = (1 + rows[:, 1:3]) / rows[:, 5:6] - 1
            print("| | without it |", " | ".join(ranges(rows)), "|")


def main() -> None:
    """Command line."""
    finish(new_parser(PROGRAM, __doc__, "results/formulas"), study)


if __name__ == "__main__":
    main()

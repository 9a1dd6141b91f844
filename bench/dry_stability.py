#!/usr/bin/env python3
"""Where the dry solver converges, and in how many iterations, in results/stability/: maps for areas and profiles.

Load from first touch to full contact over hardness (none to all plastic), over the Hurst exponent, and over the number of nodes;
each cell is one run to a violation of the contact conditions of 1e-8. c: full contact or all plastic, in closed form; x: not
converged; a load above the hardness is refused before the start.
"""

from __future__ import annotations

import argparse
import csv
from collections import Counter
from pathlib import Path

import numpy as np
from dry_cases import Case, Outcome, run
from figure_style import TWO_COLUMNS, new_figure, save_figure
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm

MODULUS, HEIGHT, LENGTH = 200e9, 1e-6, 1e-3
LOADS = (1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
HARDNESSES = (None, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01)
HURSTS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
LINES = (63, 512, 1000, 4096, 16384)
AREAS = (31, 64, 100, 128, 256, 512)
SCALE = LogNorm(1, 50)
CLOSED = ("full_contact", "all_plastic")


def cell(load: float, nodes: int, is_area: bool, hurst: float = 0.8, hardness: float | None = None) -> Case:
    """One run; loads and hardnesses in units of the pressure E* g, g = 2 pi rms height over the roll-off wavelength."""
    unit = 0.5 * MODULUS * 2 * np.pi * HEIGHT / (LENGTH / 4)
    sizes = {"length": LENGTH, "intervals": nodes}
    if is_area:
        sizes = {"length_x": LENGTH, "length_y": LENGTH, "intervals_x": nodes, "intervals_y": nodes}
    bodies = {"reduced_modulus": MODULUS}
    if hardness:
        bodies["hardness"] = float(hardness * unit)
    surface = {"shape": "synthetic", "seed": 3, "hurst": hurst, "rms_height": HEIGHT, "wavelength_rolloff": LENGTH / 4}
    return {
        "case": {"problem": "dry_area" if is_area else "dry_line"},
        "bodies": bodies,
        "load": {"mean_pressure": float(load * unit)},
        "surface_1": surface,
        "domain": sizes,
        "solver": {"tolerance": 1e-8},
    }


def sign_of(outcome: Outcome | None) -> str:
    """What is written into a cell."""
    if outcome is None:
        return "refused"
    if not outcome.converged:
        return "x"
    return "c" if outcome.method in CLOSED else ""


def maps(quick: bool) -> dict[str, tuple[str, list, dict]]:
    """Title, vertical axis and values, and the case of each cell by load and value."""
    step = 3 if quick else 1
    loads = LOADS[::step]
    nodes = 64 if quick else 128
    hard = HARDNESSES[::step]
    lines, areas = (LINES[:2], AREAS[:2]) if quick else (LINES, AREAS)
    return {
        f"areas, {nodes}$^2$": ("Hardness", [*hard], {(p, h): cell(p, nodes, True, hardness=h) for p in loads for h in hard}),
        f"areas, {nodes}$^2$ ": (
            "Hurst exponent",
            [*HURSTS[::step]],
            {(p, h): cell(p, nodes, True, hurst=h) for p in loads for h in HURSTS[::step]},
        ),
        "areas": ("Nodes a side", [*areas], {(p, n): cell(p, n, True) for p in loads for n in areas}),
        "profiles": ("Nodes", [*lines], {(p, n): cell(p, n, False) for p in loads for n in lines}),
    }


def draw_panel(panel: object, name: str, label: str, values: list, found: dict) -> None:
    """One map: iterations as colour, signs in the cells."""
    loads = sorted({p for p, _ in found})
    shown = np.full((len(values), len(loads)), np.nan)
    for i, value in enumerate(values):
        for j, load in enumerate(loads):
            outcome = found[load, value]
            sign = sign_of(outcome)
            if sign == "":
                shown[i, j] = max(outcome.iterations, 1)
            else:
                text, colour = ("–", "0.6") if sign == "refused" else (sign, "#a11c1c" if sign == "x" else "0.3")
                panel.text(j, i, text, ha="center", va="center", fontsize=7.5, color=colour)
    panel.imshow(shown, cmap="Greens", norm=SCALE, aspect="auto", origin="lower")
    panel.set_xticks(range(len(loads)), [f"{p:g}" for p in loads], rotation=90)
    panel.set_yticks(range(len(values)), ["none" if v is None else f"{v:g}" for v in values])
    panel.tick_params(length=0, labelsize=7.5)
    panel.set(title=name.strip(), ylabel=label)


def main() -> None:
    """Runs all cells, writes dry_stability.csv and draws."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("results/stability"), metavar="DIR")
    parser.add_argument("--quick", action="store_true", help="every third value")
    options = parser.parse_args()
    figure, axes = new_figure(TWO_COLUMNS, 135, nrows=2, ncols=2)
    rows, count = [], Counter()
    for panel, (name, (label, values, cases)) in zip(axes.flat, maps(options.quick).items(), strict=True):
        found = {key: run(case, options.output, "stability") for key, case in cases.items()}
        for (load, value), outcome in found.items():
            sign = sign_of(outcome) or "converged"
            count[sign] += 1
            rows.append(
                (name.strip(), label, value, load, sign, outcome.iterations if outcome else "", outcome.kkt if outcome else "")
            )
        draw_panel(panel, name, label, values, found)
    for panel in axes[1]:
        panel.set_xlabel("Mean pressure over $E^* g$ [-]")
    bar = figure.colorbar(ScalarMappable(SCALE, "Greens"), ax=axes, shrink=0.8, pad=0.01, aspect=30)
    bar.set_label("Iterations (c: closed form, x: not converged, –: refused)")
    with (options.output / "dry_stability.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("map", "axis", "value", "load", "outcome", "iterations", "kkt"))
        writer.writerows(rows)
    print(", ".join(f"{number} {sign}" for sign, number in count.items()))
    for target in save_figure(figure, [options.output / "dry_stability.png", options.output / "dry_stability.pdf"]):
        print(target)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Where the dry solvers converge, and in how many iterations, in results/stability/: the default beside the thesis's method.

Load from first touch to full contact over hardness (none to all plastic), over the Hurst exponent, and over the number of nodes
of areas and profiles; each cell is one run to a violation of the contact conditions of 1e-8, by projected conjugate gradients
(left) and by steepest descent (right). The classes are those of the lubricated maps (bench/stability.py): converged within 30
iterations, converged late (the number says after how many), not converged. c: full contact or all plastic, in closed form; a load
above the hardness is refused before the start.
"""

from __future__ import annotations

import argparse
import csv
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from bench_program import Answer
from dry_runs import METHODS, Case, Outcome, run
from figure_style import TWO_COLUMNS, legend_below, new_figure, save_figure
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.patches import Patch
from stability import status
from stability_figure import CLASSES, GREEN, NOT_CONVERGED, SCALE

MODULUS, HEIGHT, LENGTH = 200e9, 1e-6, 1e-3
LOADS = (1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
HARDNESSES = (None, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01)
HURSTS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
LINES = (63, 512, 1000, 4096, 16384)
AREAS = (31, 64, 100, 128, 256, 512)
# Iterations at most; of the finest areas steepest descent would take hours.
MOST, MOST_NODES = 6000, {METHODS[1]: 256}
CLOSED = ("full_contact", "all_plastic")
LABELS = {METHODS[0]: "conjugate gradient", METHODS[1]: "steepest descent"}
LATE = CLASSES["late"][0]

Map = tuple[str, list, dict[tuple[float, object], Case]]


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
        "solver": {"tolerance": 1e-8, "max_cycles": MOST},
        "accuracy": {"error_bars": False},
        "output": {"adequacy": False},
    }


def class_of(outcome: Outcome | None) -> str:
    """The class of a cell, by the rule of the lubricated maps; `closed` of a closed form."""
    if outcome is None:
        return "refused"
    if outcome.converged and outcome.method in CLOSED:
        return "closed"
    return status(Answer({"converged": int(outcome.converged), "cycles": outcome.iterations, "steps": 1, "reason": outcome.reason}))


def maps(quick: bool) -> dict[str, Map]:
    """Vertical axis and values, and the case of each cell by load and value, of each map."""
    step = 3 if quick else 1
    loads = LOADS[::step]
    nodes = 64 if quick else 128
    hard, hursts = [*HARDNESSES[::step]], [*HURSTS[::step]]
    lines, areas = ([*LINES[:2]], [*AREAS[:2]]) if quick else ([*LINES], [*AREAS])
    return {
        f"areas, {nodes}$^2$, hardness": (
            "Hardness",
            hard,
            {(p, h): cell(p, nodes, True, hardness=h) for p in loads for h in hard},
        ),
        f"areas, {nodes}$^2$, spectrum": (
            "Hurst exponent",
            hursts,
            {(p, h): cell(p, nodes, True, hurst=h) for p in loads for h in hursts},
        ),
        "areas": ("Nodes a side", areas, {(p, n): cell(p, n, True) for p in loads for n in areas}),
        "profiles": ("Nodes", lines, {(p, n): cell(p, n, False) for p in loads for n in lines}),
    }


def solve(each: Map, method: str, folder: Path, processes: int) -> dict[tuple[float, object], Outcome | None]:
    """All cells of a map by one method; areas that are too fine for it are left out."""
    _, _, cases = each
    most = MOST_NODES.get(method)
    chosen = {key: case for key, case in cases.items() if most is None or case["domain"].get("intervals_x", 0) <= most}

    def one(item: tuple[int, Case]) -> Outcome | None:
        case = item[1] | {"solver": item[1]["solver"] | {"method": method}}
        return run(case, folder, f"stability_{item[0]}")

    with ThreadPoolExecutor(processes) as pool:
        return dict(zip(chosen, pool.map(one, enumerate(chosen.values())), strict=True))


def draw_panel(panel: Axes, title: str, each: Map, found: dict) -> None:
    """One map: iterations as colour, signs in the cells."""
    label, values, cases = each
    loads = sorted({p for p, _ in cases})
    shown = np.ones((len(values), len(loads), 4))
    for (load, value), outcome in found.items():
        row, column = values.index(value), loads.index(load)
        word = class_of(outcome)
        if word == "converged":
            shown[row, column] = GREEN(SCALE(max(outcome.iterations, 1)))
            continue
        colour, sign = ("#ffffff", "c") if word == "closed" else CLASSES[word][:2]
        sign = str(outcome.iterations) if word == "late" else sign
        shown[row, column] = [*(int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)), 1]
        tone = "white" if colour == NOT_CONVERGED else "0.25"
        panel.text(column, row, sign, ha="center", va="center_baseline", fontsize=5.0 if word == "late" else 6.5, color=tone)
    panel.imshow(shown, aspect="auto", origin="lower", interpolation="nearest")
    panel.set_xticks(range(len(loads)), [f"{p:g}" for p in loads], rotation=90)
    panel.set_yticks(range(len(values)), ["none" if v is None else f"{v:g}" for v in values])
    panel.set_xticks(np.arange(len(loads) + 1) - 0.5, minor=True)
    panel.set_yticks(np.arange(len(values) + 1) - 0.5, minor=True)
    panel.grid(which="minor", color="white", linewidth=0.4)
    panel.tick_params(which="both", length=0, labelsize=7)
    panel.set(ylabel=label)
    panel.set_title(title, fontsize=8.5)


def main() -> None:
    """Runs all cells, writes dry_stability.csv and draws."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("results/stability"), metavar="DIR")
    parser.add_argument("--quick", action="store_true", help="every third value")
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="processes side by side (default: 2)")
    options = parser.parse_args()
    every = maps(options.quick)
    figure, axes = new_figure(TWO_COLUMNS, 210, nrows=len(every), ncols=2)
    rows, seen = [], {method: Counter() for method in METHODS}
    for line, (name, each) in zip(axes, every.items(), strict=True):
        for panel, method in zip(line, METHODS, strict=True):
            found = solve(each, method, options.output, options.processes)
            for (load, value), outcome in found.items():
                word = class_of(outcome)
                seen[method][word] += 1
                numbers = (outcome.iterations, outcome.area, outcome.kkt, outcome.reason) if outcome else ("",) * 4
                rows.append((method, name, each[0], value, load, word, *numbers))
            draw_panel(panel, f"{name}: {LABELS[method]}", each, found)
    for panel in axes[-1]:
        panel.set_xlabel("Mean pressure over $E^* g$ [-]")
    for panel in axes[:, 1]:
        panel.set_ylabel("")
    bar = figure.colorbar(ScalarMappable(SCALE, GREEN), ax=axes, shrink=0.6, pad=0.01, aspect=40)
    bar.set_label("Iterations")
    bar.set_ticks([1, 2, 5, 10, 20, 30], labels=["1", "2", "5", "10", "20", "30"])
    bar.minorticks_off()
    words = set().union(*seen.values())
    handles = [Patch(facecolor=GREEN(0.5), label="converged")]
    if "closed" in words:
        handles.append(Patch(facecolor="white", edgecolor="0.4", linewidth=0.4, label="closed form (c)"))
    for word, (colour, sign, label) in CLASSES.items():
        if word in words:
            mark = "number: iterations" if word == "late" else sign
            handles.append(Patch(facecolor=colour, edgecolor="0.4", linewidth=0.4, label=f"{label} ({mark})"))
    legend_below(figure, handles, 3)
    with (options.output / "dry_stability.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("method", "map", "axis", "value", "load", "outcome", "iterations", "contact_area", "kkt", "reason"))
        writer.writerows(rows)
    for method, counts in seen.items():
        most = max((int(row[6]) for row in rows if row[0] == method and row[5] in {"converged", "late"}), default=0)
        print(f"{method}: " + ", ".join(f"{number} {word}" for word, number in counts.items()) + f"; at most {most} iterations")
    for target in save_figure(figure, [options.output / "dry_stability.png", options.output / "dry_stability.pdf"]):
        print(target)


if __name__ == "__main__":
    main()

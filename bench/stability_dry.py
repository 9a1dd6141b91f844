"""Maps where the dry solvers converge, and in how many iterations: the default and the thesis's method.

Load from first touch to full contact against hardness (none to all plastic), Hurst exponent, and nodes of areas and profiles; each
cell is one run to a violation of the contact conditions of 1e-8, by conjugate gradients (left) and steepest descent (right).
Classes are those of the lubricated maps; c: full contact or all plastic, in closed form; ?: the load exceeds the hardness.
"""

from __future__ import annotations

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np
from bench_program import Answer, run_program, write_csv
from family_dry import PROBLEMS, sizes
from namelists import BARE, Groups, namelist
from stability_cells import Axis, StabilityMap, status
from stability_figure import draw_maps

METHODS = ("conjugate_gradient", "steepest_descent")
MODULUS, HEIGHT, LENGTH = 200e9, 1e-6, 1e-3
LOADS = (1e-7, 1e-5, 1e-3, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
HARDNESSES = (None, 10.0, 3.0, 1.0, 0.3, 0.1, 0.03, 0.01)
HURSTS = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
LINES, AREAS = (63, 512, 1000, 4096, 16384), (31, 64, 100, 128, 256, 512)
# Iterations at most; of the finest areas steepest descent would take hours.
MOST, MOST_NODES = 6000, {METHODS[1]: 256}


class Outcome(Answer):
    """What a run gives: iterations (cycles), transforms, processor time, separation, area and violation of the last load."""


def read(file: h5py.File) -> Outcome:
    """From a result."""
    sweep, report = file["sweep"], file["report"]
    names = {"separation": "mean_separation", "area": "contact_area_fraction", "kkt": "kkt"}
    numbers = {"cycles": int(report["cycles"][()]), "pairs": int(report["fft_pairs"][()])}
    words = {"method": report["method"][()].decode(), "reason": file.attrs["reason"].decode()}
    times = {"seconds": float(report["cpu_seconds"][()])}
    return Outcome(words | numbers | times | {key: float(sweep[name][-1]) for key, name in names.items()})


def run(case: Groups | str) -> Outcome | None:
    """Runs one case; None if its input is refused."""
    status, _, found = run_program(namelist(case), read)
    return Outcome(found | {"converged": int(status == 0)}) if found and status in (0, 2) else None


def cell(load: float, nodes: int, is_area: bool, hurst: float = 0.8, hardness: float | None = None) -> Groups:
    """One run; loads and hardnesses in units of the pressure E* g, g = 2 pi rms height over the roll-off wavelength."""
    unit = 0.5 * MODULUS * 2 * np.pi * HEIGHT / (LENGTH / 4)
    return {
        "case": {"problem": PROBLEMS[is_area]},
        "bodies": {"reduced_modulus": MODULUS, "hardness": float(hardness * unit) if hardness else None},
        "load": {"mean_pressure": float(load * unit)},
        "surface_1": {"shape": "synthetic", "seed": 3, "hurst": hurst, "rms_height": HEIGHT, "wavelength_rolloff": LENGTH / 4},
        "domain": sizes(1 + is_area, nodes),
        "solver": {"tolerance": 1e-8, "max_cycles": MOST},
    } | BARE


def class_of(outcome: Outcome | None) -> str:
    """The class of a cell, by the rule of the lubricated maps; `closed` of a closed form."""
    if outcome is None:
        return "refused"
    return "closed" if outcome.converged and outcome["method"] in ("full_contact", "all_plastic") else status(outcome)


def maps(quick: bool) -> list[StabilityMap]:
    """The four maps; areas that are too fine for a method are left out."""
    step, nodes = (3, 64) if quick else (1, 128)
    few = (lambda values: values[:2]) if quick else list

    def one(key: str, title: str, axis: Axis, is_area: bool, **fixed: float) -> StabilityMap:
        def text(load: float, value: float, settings: dict, name: str) -> str | None:
            keys = fixed | {axis.key: value}
            if is_area and keys["nodes"] > MOST_NODES.get(name, keys["nodes"]):
                return None
            case = cell(load, is_area=is_area, **keys)
            return namelist(case | {"solver": case["solver"] | settings})

        loads = Axis("load", "Mean pressure over $E^* g$ [-]", list(LOADS[::step]))
        return StabilityMap(f"dry_{key}", title, loads, axis, {name: {"method": name} for name in METHODS}, text)

    hard, hurst = (
        Axis("hardness", "Hardness/$E^* g$", list(HARDNESSES[::step])),
        Axis("hurst", "Hurst exponent", list(HURSTS[::step])),
    )
    return [
        one("hardness", f"Areas of {nodes}$^2$ nodes", hard, True, nodes=nodes),
        one("spectrum", f"Areas of {nodes}$^2$ nodes, elastic", hurst, True, nodes=nodes),
        one("areas", "Areas, elastic", Axis("nodes", "Nodes a side", few(AREAS)), True),
        one("profiles", "Profiles, elastic", Axis("nodes", "Nodes", few(LINES)), False),
    ]


def run_maps(folder: Path, quick: bool, processes: int) -> str:
    """Runs all cells, writes dry_stability.csv and draws; counts by method."""
    every, found, rows = maps(quick), [], []
    for each in every:
        with ThreadPoolExecutor(processes) as pool:
            outcomes = dict(zip(each.cells, pool.map(run, each.cells.values()), strict=True))
        found.append({place: (class_of(o), o["cycles"] if o else 0) for place, o in outcomes.items()})
        for (method, column, row), o in outcomes.items():
            place = (method, each.key, each.y.key, each.y.values[row], each.x.values[column])
            numbers = (o["cycles"], o["area"], o["kkt"], o["reason"]) if o else ("",) * 4
            rows.append((*place, class_of(o), *numbers))
    head = ("method", "map", "axis", "value", "load", "outcome", "iterations", "contact_area", "kkt", "reason")
    write_csv(folder / "dry_stability.csv", head, rows)
    draw_maps(every, found, 2, "", folder / "dry_stability")
    lines = []
    for method in METHODS:
        counts = Counter(row[5] for row in rows if row[0] == method)
        most = max((int(row[6]) for row in rows if row[0] == method and row[5] in {"converged", "late"}), default=0)
        lines.append(f"{method}: {', '.join(f'{n} {word}' for word, n in counts.items())}; at most {most} iterations\n")
    return "".join(lines)

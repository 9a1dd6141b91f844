"""Checks /adequacy of dry contacts: random rough lines, rough areas and parabolas against fine runs with and without an ingredient.

The program runs each contact as a user would. The truth has the same heights on FINER times the nodes of a line, of an area:

    plasticity   without a hardness
    harmonics    with the coarser half of the harmonics that the result names
    periodicity  a parabola on an open half-space in place of a periodic one, or the reverse
    area         the mean of all profiles along x, as lines; its error bar is for 95 % of such means
    grid         the result itself: its change on the fine grid must lie within the estimate

`adequacy.py --kinds dry` runs them.
"""

from __future__ import annotations

import copy
import math
import random
import re

import h5py
import ingredients
import numpy as np
from family_dry import PARABOLA, PROBLEMS, height_file, sizes
from ingredients import Row, bare, change_of, rows_of, run, verdict_of
from namelists import Groups

FINER = {"dry_line": 8, "dry_area": 4}
QUANTITIES = ("contact_area_fraction", "mean_separation", "p_max")
MODULUS, LENGTH = 231e9, 1e-3


def contact(lines: int, nodes: int, bodies: dict, load: dict, surface: dict) -> Groups:
    """Its groups."""
    groups = {"case": {"problem": PROBLEMS[lines - 1]}, "bodies": {"reduced_modulus": MODULUS} | bodies, "load": load}
    return groups | {"surface_1": surface, "domain": sizes(lines, nodes)}


def rough(source: random.Random, lines: int) -> Groups:
    """A synthetic surface with 3 to 12 nodes in its shortest wave; two of three yield at some asperities."""
    nodes = round(2 ** (source.uniform(5.5, 6.8) if lines == 2 else source.uniform(7, 10.5)))
    short, rms = LENGTH / nodes * source.uniform(3, 12), 10 ** source.uniform(-7, -5.7)
    pressure = 10 ** source.uniform(-2.5, -0.7) * MODULUS / 4 * rms / short
    bodies = {"hardness": pressure * 10 ** source.uniform(0.5, 2.0)} if source.random() < 2 / 3 else {}
    surface = {"shape": "synthetic", "rms_height": rms, "wavelength_short": short, "hurst": source.uniform(0.3, 0.95)}
    return contact(lines, nodes, bodies, {"mean_pressure": pressure}, surface | {"seed": source.randint(1, 10**6)})


def parabola(source: random.Random) -> Groups:
    """A parabola in a box that its contact fills to a twentieth to two thirds, periodic or not; half of them yield."""
    lines, nodes = 2 if source.random() < 0.5 else 1, source.randint(48, 128)
    radius, half_width = 10 ** source.uniform(-3, -1), LENGTH / 2 * 10 ** source.uniform(-1.3, -0.2)
    peak = half_width * MODULUS / ((math.pi if lines == 2 else 4) * radius)
    bodies = {"reduced_radius": radius}
    if source.random() < 0.5:
        bodies["hardness"] = peak * source.uniform(0.75, 1.2)
    groups = contact(lines, nodes, bodies, {"hertz_pressure": peak}, dict(PARABOLA))
    groups["domain"]["periodic"] = source.random() < 0.5
    return groups


def values(file: h5py.File) -> dict[str, float]:
    """The compared quantities [SI]."""
    return {name: float(file[f"sweep/{name}"][-1]) for name in QUANTITIES}


def told(file: h5py.File) -> dict:
    """What the program says, with its values and its heights."""
    said = file["adequacy"].attrs
    found = {"rows": ingredients.told(file, QUANTITIES), "accuracy": float(said["accuracy"]), "values": values(file)}
    found |= {"pressure": float(said["mean_pressure"]), "heights": file["solution/height_undeformed"][()]}
    return found | {"spacing": float(file["solution/x"][1] - file["solution/x"][0])}


def on_fine_grid(groups: Groups, heights: np.ndarray, spacing: float) -> tuple[Groups, dict[str, bytes]]:
    """The same heights on a finer grid; rough ones are in a file beside it, which the program resamples by their series."""
    truth = bare(groups)
    for key in truth["domain"]:
        if key.startswith("intervals"):
            truth["domain"][key] *= FINER[groups["case"]["problem"]]
    if groups["surface_1"]["shape"] == "parabola":
        return truth, {}
    surface = {"shape": "file", "file": "heights.h5", "dataset": "z"}
    return truth | {"surface_1": surface}, {"heights.h5": height_file(heights, [spacing] * heights.ndim)}


def mean_of_profiles(groups: Groups, said: dict) -> dict[str, float] | None:
    """All profiles along x as lines, under the mean pressure of the area; None where one has no solution."""
    domain = {"length": groups["domain"]["length_x"], "intervals": groups["domain"]["intervals_x"]}
    line = groups | {"case": {"problem": "dry_line"}, "load": {"mean_pressure": said["pressure"]}, "domain": domain}
    found = []
    for heights in said["heights"]:
        truth, files = on_fine_grid(line, heights, said["spacing"])
        found.append(run(truth, values, files))
        if found[-1] is None:
            return None
    return {q: sum(one[q] for one in found) / len(found) for q in QUANTITIES}


def without(truth: Groups, ingredient: str, instead: str) -> Groups:
    """A contact without an ingredient."""
    lean = copy.deepcopy(truth)
    if ingredient == "plasticity":
        del lean["bodies"]["hardness"]
    elif ingredient == "harmonics":
        lean["surface_1"]["harmonics"] = int(re.match(r"the harmonics 1 to (\d+)", instead)[1])
    else:
        lean["domain"]["periodic"] = not truth["domain"]["periodic"]
    return lean


def judge(scene: tuple[str, Groups]) -> list[Row]:
    """All ingredients of a contact; none where it has no result or no truth."""
    name, groups = scene
    said = run(groups, told)
    if said is None:
        return []
    truth, files = on_fine_grid(groups, said["heights"], said["spacing"])
    full, rows = run(truth, values, files), []
    for ingredient, row in said["rows"].items() if full else ():
        base = full
        if ingredient == "grid":
            found, base = full, said["values"]
            # the change is the estimate
            row["changes"] = {q: (0.0, change) for q, (change, _) in row["changes"].items()}
        elif ingredient != "area":
            found = run(without(truth, ingredient, row["instead"]), values, files)
        elif groups["surface_1"]["shape"] == "parabola":
            continue
        else:
            found = mean_of_profiles(groups, said)
        if found is not None:
            true = change_of(found, base, QUANTITIES)
            rows += rows_of(name, ingredient, row, true, verdict_of(true.values(), said["accuracy"]), said["accuracy"])
    return rows


def scene(seed: int, i: int) -> tuple[str, Groups]:
    """Name and groups of one."""
    source, kind = random.Random(f"adequacy_dry {seed} {i}"), ("rough line", "rough area", "rough line", "parabola")[i % 4]
    return f"dry {kind} {i:03d}", parabola(source) if kind == "parabola" else rough(source, 2 if kind == "rough area" else 1)

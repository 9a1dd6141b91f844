#!/usr/bin/env python3
"""Is what /adequacy says of dry contacts true? Random rough lines, rough areas and parabolas beside fine runs with and without.

The program runs each contact as a user would. The truth has the same heights on FINER times the nodes of a line, of an area:

    plasticity   without a hardness
    harmonics    with the coarser half of the harmonics that the result names
    periodicity  a parabola on an open half-space in place of a periodic one, or the reverse
    area         the mean of all profiles along x, as lines
    grid         the result itself: the truth is what the fine grid changes of it

    known        there is a verdict
    right        it is that of the true changes (of the grid: it is too coarse, or not)
    surely wrong 'needed' where it is not, or less than that where it is needed
    honest       the true change is within the error bar (of the grid: the true error within the estimate), all three quantities;
                 the bar of `area` is for 95 % of such means

Asked for: 95 % right, 95 % honest. --seed draws another sample. Writes adequacy_dry.csv and adequacy_dry.txt.
"""

from __future__ import annotations

import copy
import csv
import math
import random
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import adequacy
import h5py
import numpy as np
from adequacy import Groups
from bench_program import new_parser, output_folder

SEED = 640093
COUNT, QUICK = 40, 6
FINER = {"dry_line": 8, "dry_area": 4}
QUANTITIES = ("contact_area_fraction", "mean_separation", "p_max")
WITHIN = 0.95
# Relative error that is as good as none, as in families.py.
FLOOR = 1e-6
MODULUS, LENGTH = 231e9, 1e-3
KINDS = ("rough line", "rough area", "rough line", "parabola")
EXACT = {"accuracy": {"error_bars": False}, "output": {"adequacy": False}}


@dataclass
class Row:
    """One quantity of one ingredient: change, error bar, true change; the verdicts are those of the ingredient."""

    contact: str
    ingredient: str
    quantity: str
    change: float
    error: float
    truth: float
    verdict: str
    true_verdict: str
    accuracy: float


def sizes(is_area: bool, nodes: int) -> dict[str, object]:
    """Length and nodes of a line or of a square."""
    return {f"{key}{end}": value for end in (("_x", "_y") if is_area else ("",)) for key, value in
            (("length", LENGTH), ("intervals", nodes))}  # fmt: skip


def rough(source: random.Random, is_area: bool) -> Groups:
    """A synthetic surface with 3 to 12 nodes in its shortest wave; two of three yield at some asperities."""
    nodes = round(2 ** (source.uniform(5.5, 6.8) if is_area else source.uniform(7, 10.5)))
    short, rms = LENGTH / nodes * source.uniform(3, 12), 10 ** source.uniform(-7, -5.7)
    pressure = 10 ** source.uniform(-2.5, -0.7) * MODULUS / 4 * rms / short
    bodies = {"reduced_modulus": MODULUS}
    if source.random() < 2 / 3:
        bodies["hardness"] = pressure * 10 ** source.uniform(0.5, 2.0)
    surface = {"shape": "synthetic", "rms_height": rms, "wavelength_short": short, "hurst": source.uniform(0.3, 0.95)}
    surface["seed"] = source.randint(1, 10**6)
    return contact(is_area, nodes, bodies, {"mean_pressure": pressure}, surface)


def parabola(source: random.Random) -> Groups:
    """A parabola in a box that its contact fills to a twentieth to two thirds, periodic or not; half of them yield."""
    is_area, nodes = source.random() < 0.5, source.randint(48, 128)
    radius, half_width = 10 ** source.uniform(-3, -1), LENGTH / 2 * 10 ** source.uniform(-1.3, -0.2)
    peak = half_width * MODULUS / ((math.pi if is_area else 4) * radius)
    bodies = {"reduced_modulus": MODULUS, "reduced_radius": radius}
    if source.random() < 0.5:
        bodies["hardness"] = peak * source.uniform(0.75, 1.2)
    groups = contact(is_area, nodes, bodies, {"hertz_pressure": peak}, {"shape": "parabola"})
    groups["domain"]["periodic"] = source.random() < 0.5
    return groups


def contact(is_area: bool, nodes: int, bodies: dict, load: dict, surface: dict) -> Groups:
    """Its groups."""
    problem = "dry_area" if is_area else "dry_line"
    return {
        "case": {"problem": problem},
        "bodies": bodies,
        "load": load,
        "surface_1": surface,
        "domain": sizes(is_area, nodes),
    }


def values(file: h5py.File) -> dict[str, float]:
    """The compared quantities [SI]."""
    return {name: float(file[f"sweep/{name}"][-1]) for name in QUANTITIES}


def told(file: h5py.File) -> dict:
    """What the program says, with its values and its heights."""
    rows = {}
    for name, row in file["adequacy"].items():
        changes = {q: (float(row[q][()]), float(row[q].attrs["error_estimate"])) for q in QUANTITIES if q in row}
        rows[name] = {"changes": changes} | {key: row.attrs[key].decode() for key in ("verdict", "instead")}
    return {
        "rows": rows,
        "accuracy": float(file["adequacy"].attrs["accuracy"]),
        "values": values(file),
        "pressure": float(file["adequacy"].attrs["mean_pressure"]),
        "heights": file["solution/height_undeformed"][()],
        "spacing": float(file["solution/x"][1] - file["solution/x"][0]),
    }


def on_fine_grid(groups: Groups, heights: np.ndarray, spacing: float, path: Path) -> Groups:
    """The same heights on a finer grid; rough ones are written to a file, which the program resamples by their series."""
    truth = copy.deepcopy(groups) | copy.deepcopy(EXACT)
    factor = FINER[groups["case"]["problem"]]
    for key in truth["domain"]:
        if key.startswith("intervals"):
            truth["domain"][key] *= factor
    if groups["surface_1"]["shape"] == "parabola":
        return truth
    with h5py.File(path, "w") as file:
        data = file.create_dataset("heights", data=heights)
        for name in ("spacing",) if heights.ndim == 1 else ("spacing_x", "spacing_y"):
            data.attrs[name] = spacing
    truth["surface_1"] = {"shape": "file", "file": str(path), "dataset": "heights"}
    return truth


def mean_of_profiles(groups: Groups, said: dict, folder: Path) -> dict[str, float] | None:
    """All profiles along x as lines, under the mean pressure of the area."""
    line = copy.deepcopy(groups)
    line["case"]["problem"] = "dry_line"
    line["load"] = {"mean_pressure": said["pressure"]}
    line["domain"] = {"length": groups["domain"]["length_x"], "intervals": groups["domain"]["intervals_x"]}
    found = []
    for k, heights in enumerate(said["heights"]):
        one = adequacy.run(on_fine_grid(line, heights, said["spacing"], folder / f"row_{k}.h5"), values)
        if one is None:
            return None
        found.append(one)
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


def judge(name: str, groups: Groups) -> list[Row]:
    """All ingredients of a contact; none where it has no result or no truth."""
    said = adequacy.run(groups, told)
    if said is None:
        return []
    rows = []
    with tempfile.TemporaryDirectory() as word:
        folder = Path(word)
        truth = on_fine_grid(groups, said["heights"], said["spacing"], folder / "heights.h5")
        full = adequacy.run(truth, values)
        if full is None:
            return []
        for ingredient, row in said["rows"].items():
            base = full
            if ingredient == "grid":
                found, base = full, said["values"]
            elif ingredient == "area":
                if groups["surface_1"]["shape"] == "parabola":
                    continue
                found = mean_of_profiles(groups, said, folder)
            else:
                found = adequacy.run(without(truth, ingredient, row["instead"]), values)
            if found is not None:
                rows += compare(name, ingredient, row, {q: found[q] / base[q] - 1 for q in QUANTITIES}, said["accuracy"])
    return rows


def compare(name: str, ingredient: str, row: dict, true: dict[str, float], accuracy: float) -> list[Row]:
    """The rows of an ingredient with these true changes."""
    right = adequacy.verdict_of([true[q] for q in QUANTITIES], accuracy)
    rows = []
    for q in QUANTITIES:
        change, error = row["changes"].get(q, (math.nan, math.nan))
        if ingredient == "grid":
            # the change is the estimate
            change, error = 0.0, change
        rows.append(Row(name, ingredient, q, change, error, true[q], row["verdict"], right, accuracy))
    return rows


def is_right(row: Row) -> bool:
    """Whether a known verdict is that of the true changes; of the grid whether it is fine enough."""
    if row.ingredient == "grid":
        return row.true_verdict != "needed" or row.verdict == "too coarse"
    return row.verdict == row.true_verdict


def is_surely_wrong(row: Row) -> bool:
    """Whether it is on the other side of the accuracy."""
    return not is_right(row) and "needed" in (row.verdict, row.true_verdict)


def table(rows: list[Row]) -> str:
    """A line an ingredient and kind of contact."""
    lines = [f"{'ingredient':26s} {'verdicts':>8s} {'known':>6s} {'right':>8s} {'surely wrong':>13s} {'honest':>8s}"]
    labels = {"line": lambda row: "line" in row.contact, "area": lambda row: "area" in row.contact,
              "parabola": lambda row: "parabola" in row.contact}  # fmt: skip
    for ingredient in ("plasticity", "harmonics", "periodicity", "area", "grid"):
        for label, belongs in labels.items():
            own = [row for row in rows if row.ingredient == ingredient and belongs(row)]
            if own:
                lines.append(line(f"{ingredient}, {label}", own))
    return "\n".join([*lines, line("all", rows)]) + "\n"


def line(label: str, own: list[Row]) -> str:
    """What holds of these rows."""
    verdicts = {(row.contact, row.ingredient): row for row in own}.values()
    known = [row for row in verdicts if row.verdict != "not known"]
    right, wrong = sum(map(is_right, known)), sum(map(is_surely_wrong, known))
    judged = [row for row in own if math.isfinite(row.error)]
    honest = sum(abs(row.change - row.truth) <= max(row.error, FLOOR) for row in judged)
    counts = ((right, known), (honest, judged))
    shares = [f"{100 * count / len(group):6.1f} %" if group else f"{'-':>8s}" for count, group in counts]
    return f"{label:26s} {len(verdicts):8d} {len(known):6d} {shares[0]} {wrong:13d} {shares[1]}"


def main() -> int:
    """Command line; status 1 where less is honest or right than asked for."""
    parser = new_parser(__doc__, f"{QUICK} contacts", "results/adequacy_dry")
    parser.add_argument("--seed", type=int, default=SEED, help="another sample, for fitting")
    options = parser.parse_args()
    folder = output_folder(options)
    count = QUICK if options.quick else COUNT
    rows: list[Row] = []
    unjudged = 0
    for i in range(count):
        kind = KINDS[i % len(KINDS)]
        source = random.Random(f"adequacy_dry {options.seed} {i}")
        groups = parabola(source) if kind == "parabola" else rough(source, kind == "rough area")
        own = judge(f"{kind} {i:03d}", groups)
        rows += own
        unjudged += not own
        print(f"\r{i + 1} of {count}   ", end="", file=sys.stderr, flush=True)
        with (folder / "adequacy_dry.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(Row.__dataclass_fields__)
            writer.writerows(vars(row).values() for row in rows)
    print(file=sys.stderr)
    text = table(rows) + f"{unjudged} of {count} contacts have no result or no truth\n"
    (folder / "adequacy_dry.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    shares = [float(share) for share in re.findall(r"([\d.]+) %", text.splitlines()[-2])]
    return 0 if all(share >= 100 * WITHIN for share in shares) else 1


if __name__ == "__main__":
    sys.exit(main())

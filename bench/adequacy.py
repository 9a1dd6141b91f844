#!/usr/bin/env python3
"""Is what /adequacy says of each ingredient true? Random scenes, each beside fine-grid runs with and without the ingredient.

A scene is a steady contact, smooth or with ridges or waves at rest, or a passage. The program runs it as a user would and tells
what each ingredient changes, with an error bar and a verdict. The truth is the change between two runs of their own: steady ones
for a target of TARGET, passages with half the spacing and half the time step. Without the squeeze term it is the extreme of PLACES
steady runs, of films and pressure where one surface is rough and the oil is Newtonian: the rough one stands still there, and the
other has both speeds. Rigid bodies are as many times of STIFFNESSES as stiff as have a solution, with places and times in metres,
seconds; less than the first of them tells only whether elasticity is needed. Of the time step the program tells by how much
quantities may be off because of it: that is judged as the error bar of no change, beside the same grid with a FINER_STEP of it.

    honest     the true change is within the error bar
    right      the verdict is that of the true changes (needed: one above the accuracy; irrelevant: all below a tenth of it)
    not known  no change, or no verdict

Asked for: 95 % honest, 95 % right. --seed draws another sample, for fitting; the default one judges (docs/performance.md).
Writes adequacy.csv and adequacy.txt.
"""

from __future__ import annotations

import copy
import csv
import math
import random
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import h5py
import namelists
from bench_program import ENVIRONMENT, ROOT, new_parser, output_folder

PROGRAM = ROOT / "build" / "bin" / "asperity"
SEED = 884211
TARGET, PLACES = 2e-4, 48
STIFFNESSES = (2000.0, 200.0, 20.0, 5.0, 2.0)
FINER_STEP = 0.25
COUNTS, QUICK = (45, 24), (8, 4)
WITHIN = 0.95
NO_EXTRAS = {"accuracy": {"error_bars": False}, "output": {"adequacy": False}}
STILL = ("h_min", "h_central", "p_max")
QUANTITIES = (*STILL, "friction_coefficient")
NUMERICAL = ("grid", "time_step", "domain", "iteration", "validity")
PATIENCE = 1800
# Of these everything in half-widths is scaled with the half-width.
LENGTHS = {"surface_1": ("position",), "surface_2": ("position",), "domain": ("x_inlet", "x_outlet")}
TIMES = {"time": ("end_time", "time_step", "statistics_from")}
Groups = dict[str, dict]


@dataclass
class Row:
    """One quantity of one ingredient of a scene: change, error bar, true change; the verdicts are those of the ingredient."""

    scene: str
    ingredient: str
    quantity: str
    change: float
    error: float
    truth: float
    verdict: str
    true_verdict: str
    accuracy: float
    measured_on: str
    left_out: float


def run(groups: Groups, read: Callable[[h5py.File], object]) -> object:
    """Runs a namelist in a folder of its own; None where it does not converge."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "case.nml").write_text(namelists.namelist(groups), encoding="utf-8")
        command = [PROGRAM, "--quiet", "case.nml"]
        done = subprocess.run(command, cwd=folder, env=ENVIRONMENT, check=False, capture_output=True, text=True, timeout=PATIENCE)
        if done.returncode != 0:
            return None
        with h5py.File(folder / "case.h5") as file:
            return read(file)


def quantities(file: h5py.File) -> dict[str, float]:
    """Those that are compared [SI]."""
    return {name: float(file[f"summary/{name}"][()]) for name in QUANTITIES}


def told(file: h5py.File) -> dict[str, dict]:
    """What the program says of each ingredient, and the resolution of the run."""
    group = file["adequacy"]
    rows = {}
    for name, row in group.items():
        if name in NUMERICAL:
            continue
        changes = changes_in(row)
        words = {key: row.attrs[key].decode() for key in ("verdict", "measured_on")}
        judged_by = [q for q in QUANTITIES if q in row or f"{q}_at_least" in row.attrs]
        rows[name] = {"changes": changes, "judged_by": judged_by, "left_out": float(row.attrs["left_out"])} | words
    used = file["input/effective/domain"].attrs
    domain = {"x_inlet": float(used["x_inlet"]), "x_outlet": float(used["x_outlet"]), "intervals": int(used["intervals"])}
    step = float(file["input/effective/time"].attrs.get("time_step", 0.0))
    start = float(file["summary"].attrs.get("statistics_from", 0.0))
    found = {"rows": rows, "quantities": quantities(file), "accuracy": float(group.attrs["accuracy"])}
    if "time_step" in group:
        row = group["time_step"]
        verdict = row.attrs["verdict"].decode().replace("too coarse", "needed")
        # no change, and an error bar that holds what may be off
        bounds = {q: (0.0, change + error) for q, (change, error) in changes_in(row).items()}
        found["time_step"] = {"changes": bounds, "verdict": verdict}
    return found | {"domain": domain, "step": step, "start": start}


def changes_in(row: h5py.Group) -> dict[str, tuple[float, float]]:
    """Those of a row of /adequacy that are known, with their error bars."""
    return {q: (float(row[q][()]), float(row[q].attrs["error_estimate"])) for q in QUANTITIES if q in row}


def without(groups: Groups, ingredient: str, left_out: float) -> Groups | None:
    """The scene without an ingredient, or without a share of it; None where a namelist cannot say it."""
    lean = copy.deepcopy(groups)
    oil = lean["lubricant"]
    if left_out < 1:
        return None
    if ingredient == "compressibility":
        oil["density_law"] = "constant"
    elif ingredient == "piezoviscosity":
        lean["lubricant"] = {key: oil[key] for key in oil if key not in ("pressure_viscosity", "roelands_p0")}
        lean["lubricant"]["viscosity_law"] = "constant"
    elif ingredient == "roelands":
        lean["lubricant"] = {key: oil[key] for key in oil if key != "roelands_p0"} | {"viscosity_law": "barus"}
    elif ingredient == "shear_thinning":
        lean["lubricant"] = {key: oil[key] for key in oil if key not in ("rheology", "eyring_stress")}
    elif ingredient == "roughness":
        return {key: lean[key] for key in lean if key not in ("surface_1", "surface_2", "time")}
    elif ingredient.startswith("roughness_"):
        del lean[f"surface_{ingredient[-1]}"]
    elif ingredient.startswith("feature_"):
        surface, number = ingredient.split("_")[1:]
        for key in ("amplitude", "wavelength", "position"):
            del lean[f"surface_{surface}"][key][int(number) - 1]
    return lean


def stiffer(groups: Groups, ratio: float) -> Groups:
    """The scene with stiffer bodies: their contact is narrower, everything else is where it was [m, s]."""
    stiff = copy.deepcopy(groups)
    stiff["bodies"]["reduced_modulus"] *= ratio
    for group, keys in (LENGTHS | TIMES).items():
        for key in keys:
            value = stiff.get(group, {}).get(key)
            if value is not None:
                scaled = [each * ratio**0.5 for each in value] if isinstance(value, list) else value * ratio**0.5
                stiff[group][key] = scaled
    return stiff


def lean_runs(groups: Groups, ingredient: str, left_out: float) -> Iterator[tuple[dict[str, float] | None, bool]]:
    """Quantities of a scene without an ingredient, and whether that is all of it, best first; None where there is no solution."""
    if ingredient == "squeeze":
        yield frozen(groups), True
    elif ingredient != "elasticity":
        lean = without(groups, ingredient, left_out)
        yield run(lean, quantities) if lean else None, True
    elif left_out < 1:
        yield run(stiffer(groups, 1 / (1 - left_out)), quantities), True
    else:
        for ratio in STIFFNESSES:
            yield run(stiffer(groups, ratio), quantities), ratio == STIFFNESSES[0]


def frozen(groups: Groups) -> dict[str, float] | None:
    """Extremes of steady solutions with the waves at their places."""
    bodies = groups["bodies"]
    mean = (bodies["speed_1"] + bodies["speed_2"]) / 2
    rough = [i for i in (1, 2) if f"surface_{i}" in groups]
    if len(rough) > 1 or "rheology" in groups["lubricant"]:
        return None
    [rough_one] = rough
    surface = f"surface_{rough_one}"
    extremes: dict[str, float] = {}
    for k in range(PLACES + 1):
        time = groups["time"]["end_time"] * k / PLACES
        still = {key: copy.deepcopy(groups[key]) for key in groups if key != "time"}
        still["bodies"] |= {f"speed_{rough_one}": 0.0, f"speed_{3 - rough_one}": 2 * mean}
        places = still[surface].get("position", 0.0)
        move = bodies[f"speed_{rough_one}"] / mean * time
        still[surface]["position"] = [place + move for place in places] if isinstance(places, list) else places + move
        found = run(still, quantities)
        if found is None:
            return None
        if time < groups["time"]["statistics_from"]:
            continue
        for name in STILL:
            value = found[name]
            best = max if name == "p_max" else min
            extremes[name] = best(extremes.get(name, value), value)
    return extremes


def fine(groups: Groups, said: dict) -> Groups:
    """The scene as its truths see it."""
    truth = copy.deepcopy(groups) | copy.deepcopy(NO_EXTRAS)
    if "time" in groups:
        truth["domain"] = said["domain"] | {"intervals": 2 * said["domain"]["intervals"]}
        truth["time"] |= {"time_step": said["step"] / 2, "statistics_from": said["start"]}
    else:
        truth["domain"] = {}
        truth["accuracy"] = {"target": TARGET}
        if any(key.startswith("surface") for key in groups):
            truth["domain"] = said["domain"] | {"intervals": 4 * said["domain"]["intervals"]}
            truth["accuracy"] = {"error_bars": False}
    return truth


def time_step_rows(name: str, groups: Groups, said: dict) -> list[Row]:
    """By how much each quantity is off because of the time step, beside what the program says of that."""
    if "time_step" not in said:
        return []
    bounds = said["time_step"]["changes"]
    same = copy.deepcopy(groups) | copy.deepcopy(NO_EXTRAS) | {"domain": said["domain"]}
    same["time"] |= {"time_step": said["step"] * FINER_STEP, "statistics_from": said["start"]}
    exact = run(same, quantities)
    if exact is None:
        return []
    off = {q: exact[q] / said["quantities"][q] - 1 if said["quantities"][q] != 0 else math.nan for q in QUANTITIES}
    right = verdict_of([off[q] for q in bounds if not math.isnan(off[q])], said["accuracy"])
    words = (said["time_step"]["verdict"], right, said["accuracy"], "", 1.0)
    return [Row(name, "time_step", q, *bounds.get(q, (math.nan, math.nan)), off[q], *words) for q in QUANTITIES]


def verdict_of(changes: list[float], accuracy: float) -> str:
    """By the true changes."""
    if any(abs(change) > accuracy for change in changes):
        return "needed"
    return "irrelevant" if all(abs(change) < 0.1 * accuracy for change in changes) else "matters below the accuracy"


def judge(scene: tuple[str, Groups]) -> list[Row]:
    """All ingredients of a scene; none where it does not converge, or has no truth."""
    name, groups = scene
    said = run(groups, told)
    if said is None:
        return []
    truth = fine(groups, said)
    full = run(truth, quantities)
    if full is None:
        return []
    rows = time_step_rows(name, groups, said)
    for ingredient, row in said["rows"].items():
        leans = lean_runs(truth, ingredient, row["left_out"])
        found, is_all = next((lean for lean in leans if lean[0]), (None, False))
        if found is None:
            continue
        true = {q: found[q] / full[q] - 1 if q in found and full[q] != 0 else math.nan for q in QUANTITIES}
        # of a part of an ingredient what all of it would change at that rate, as the program judges
        judged = [true[q] / row["left_out"] for q in row["judged_by"] if not math.isnan(true[q])]
        right = verdict_of(judged, said["accuracy"])
        if not is_all:
            # a part of it: no true change, and a verdict only where that part is needed already
            if right != "needed":
                continue
            true = dict.fromkeys(QUANTITIES, math.nan)
        for q in QUANTITIES:
            change, error = row["changes"].get(q, (math.nan, math.nan))
            verdicts = (row["verdict"], right, said["accuracy"], row["measured_on"], row["left_out"])
            rows.append(Row(name, ingredient, q, change, error, true[q], *verdicts))
    return rows


def steady_scene(source: random.Random, i: int) -> tuple[str, Groups]:
    """A smooth contact over the range, every third one with ridges or a wave at rest."""
    m, l = 10 ** source.uniform(-1, 2.5), source.uniform(0.3, 20)  # noqa: E741
    # in a steady contact a rough surface stands still
    slide = source.uniform(0, 1.5)
    groups = namelists.steel(m, l, slide if i % 3 else 2.0, 10 ** source.uniform(6, 9))
    if source.random() < 0.3:
        del groups["lubricant"]["rheology"], groups["lubricant"]["eyring_stress"]
    if i % 3 == 0:
        half_width, film = namelists.scales(groups)
        height = film * 10 ** source.uniform(-3.5, -0.7)
        wave = source.uniform(0.4, 1.5) * half_width
        count = source.choice((1, 2))
        places = [source.uniform(-1, 0.8) for _ in range(count)]
        shape = {"amplitude": [height] * count, "wavelength": [wave] * count, "position": places}
        groups["surface_1"] = {"shape": source.choice(("feature", "sinusoid"))} | shape
    return f"steady {i:03d}", groups


def passage_scene(source: random.Random, i: int) -> tuple[str, Groups]:
    """Ridges, a dent or a wave on one surface, or a ridge on each, through a contact of medium load."""
    slide = source.choice((-1.0, -0.3, 0.0, 0.3, 1.0, 5 / 3))
    groups = namelists.steel(10 ** source.uniform(0, 1.5), source.uniform(2, 12), slide, 10 ** source.uniform(6.3, 8))
    if source.random() < 0.4:
        del groups["lubricant"]["rheology"], groups["lubricant"]["eyring_stress"]
    half_width, film = namelists.scales(groups)
    height = film * 10 ** source.uniform(-3, -0.5)
    wave = source.uniform(0.5, 1.5) * half_width
    shape = {"shape": "feature", "amplitude": [height * source.choice((1, -1))], "wavelength": [wave], "position": [-2.5]}
    kind = source.choice(("one", "two", "both", "wave"))
    if kind == "two":
        shape = {"shape": "feature", "amplitude": [height, -height], "wavelength": [wave, wave], "position": [-2.5, -3.3]}
    if kind == "wave":
        shape = {"shape": "sinusoid", "amplitude": 0.5 * height, "wavelength": wave}
    groups["surface_2"] = shape
    if kind == "both":
        groups["surface_1"] = {"shape": "feature", "amplitude": [0.7 * height], "wavelength": [wave], "position": [-2.0]}
    groups["domain"] = {"x_inlet": -4.5, "x_outlet": 2.0, "intervals": 512}
    slowest = min(1 + slide / 2, 1 - slide / 2 if kind == "both" else 9.0)
    end = 6.0 if kind == "wave" else 4.0 / max(slowest, 0.5)
    groups["time"] = {"transient": True, "end_time": end}
    return f"passage {i:03d}", groups


def table(rows: list[Row]) -> str:
    """A line an ingredient, steady and in time."""
    lines = [f"{'ingredient':24s} {'scenes':>6s} {'not known':>9s} {'honest':>8s} {'right':>8s}"]
    for kind in ("steady", "passage"):
        names = list(dict.fromkeys(row.ingredient for row in rows if row.scene.startswith(kind)))
        ingredients = sorted(name for name in names if name not in NUMERICAL)
        for label, counted in [*((name, [name]) for name in ingredients), ("all", ingredients), ("time_step", ["time_step"])]:
            own = [row for row in rows if row.scene.startswith(kind) and row.ingredient in counted]
            if own:
                lines.append(line(f"{kind} {label}", own))
    return "\n".join(lines) + "\n"


def line(label: str, own: list[Row]) -> str:
    """What holds of these rows; changes of the smooth steady contact are no statement on a passage and are not judged."""
    scenes = {(row.scene, row.ingredient): row for row in own}
    known = [row for row in scenes.values() if row.verdict != "not known"]
    right = [row.verdict == row.true_verdict for row in known if row.left_out == 1 or row.verdict == "needed"]
    judged = [row for row in own if not (math.isnan(row.change) or math.isnan(row.truth)) and "smooth" not in row.measured_on]
    honest = [abs(row.change - row.truth) <= row.error for row in judged]
    parts = [f"{label:24s} {len(scenes):6d} {len(scenes) - len(known):9d}"]
    parts += [f"{100 * sum(values) / len(values):6.1f} %" if values else f"{'-':>8s}" for values in (honest, right)]
    return " ".join(parts)


def main() -> int:
    """Command line; status 1 where less is honest or right than asked for."""
    parser = new_parser(__doc__, f"{QUICK} scenes", "results/adequacy")
    parser.add_argument("--seed", type=int, default=SEED, help="another sample, for fitting")
    parser.add_argument("--processes", type=int, default=1, help="scenes side by side")
    options = parser.parse_args()
    counts = QUICK if options.quick else COUNTS
    scenes = []
    for draw, count in zip((steady_scene, passage_scene), counts, strict=True):
        source = random.Random(f"{draw.__name__} {options.seed}")
        scenes += [draw(source, i) for i in range(count)]
    rows: list[Row] = []
    unjudged = 0
    folder = output_folder(options)
    with ThreadPoolExecutor(options.processes) as pool:
        for i, own in enumerate(pool.map(judge, scenes)):
            rows += own
            unjudged += not own
            print(f"\r{i + 1} of {len(scenes)}   ", end="", file=sys.stderr, flush=True)
            with (folder / "adequacy.csv").open("w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                writer.writerow(Row.__dataclass_fields__)
                writer.writerows(row.__dict__.values() for row in rows)
    print(file=sys.stderr)
    text = table(rows) + f"{unjudged} of {len(scenes)} scenes have no result or no truth\n"
    (folder / "adequacy.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    lines = [line for line in text.splitlines() if " all " in line]
    shares = [float(share) for line in lines for share in re.findall(r"([\d.]+) %", line)]
    return 0 if all(share >= 100 * WITHIN for share in shares) else 1


if __name__ == "__main__":
    sys.exit(main())

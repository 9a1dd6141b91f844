#!/usr/bin/env python3
"""Checks the verdicts of /adequacy on random scenes against fine-grid runs with and without each ingredient.

A scene is a steady contact, smooth or with ridges or waves at rest, a passage or a steady point contact; `scene`: the lubricated
ones of input/scenes/. The program runs it as a user would and reports the change by each ingredient, with an error bar
and a verdict. The truth is the change between two fine runs: steady ones for a target of TARGET, passages with half the spacing
and half the time step, points with half the spacing. Rigid bodies are the stiffest of STIFFNESSES that has a solution, with places
and times in metres and seconds; below the first of them only the need for elasticity is judged. The reported error of the time
step is judged as the error bar of no change, against the same grid with FINER_STEP of the step.

    honest        the true change is within the error bar (a difference below judge.FLOOR always is)
    right         the verdict is that of the true changes (needed: one above the accuracy; irrelevant: all below a tenth of it)
    surely wrong  `needed` where it is not, or less than that where it is needed
    not known     no change, or no verdict

Targets: 95 % honest, 95 % right. --seed draws another sample, for fitting; the default one judges. Writes adequacy.csv and
adequacy.txt.
"""

from __future__ import annotations

import copy
import itertools
import math
import random
import sys
from collections.abc import Callable, Iterator

import f90nml
import family_steady
import h5py
import namelists
import pandas as pd
from bench_program import ROOT, conclude, new_parser, run_program, save, side_by_side
from family_shipped import groups_of
from judge import FLOOR
from namelists import BARE, Groups, merged, namelist

WITHIN = 0.95
SEED = 884211
NO_TRUTH = "no truth"
NUMERICAL = ("grid", "time_step", "domain", "iteration", "validity")
TARGET = 2e-4
STIFFNESSES = (2000.0, 200.0, 20.0, 5.0, 2.0)
FINER_STEP = 0.25
QUANTITIES = ("h_min", "h_central", "p_max", "friction_coefficient")
MODULI = ("youngs_modulus_1", "youngs_modulus_2", "reduced_modulus")
# What grows with the square root of the modulus at one load: places and times in half-widths, and the pressure.
SCALED = {
    **{"surface_1": ("position",), "surface_2": ("position",), "domain": ("x_inlet", "x_outlet")},
    **{"time": ("end_time", "time_step", "statistics_from"), "load": ("hertz_pressure",)},
}
# Keys of the oil without which an ingredient is gone, and those that come instead.
LEAN_OIL = {
    "compressibility": ((), {"density_law": "constant"}),
    "piezoviscosity": (("pressure_viscosity", "roelands_p0"), {"viscosity_law": "constant"}),
    "roelands": (("roelands_p0",), {"viscosity_law": "barus"}),
    "shear_thinning": (("rheology", "eyring_stress"), {}),
}


def scaled(value: object, factor: float) -> object:
    """A value, or each of a list of them, times a factor."""
    return [each * factor for each in value] if isinstance(value, list) else value * factor


def run(groups: Groups, read: Callable[[h5py.File], object]) -> object:
    """What is read of the result of a namelist; None where it does not converge."""
    done = run_program(namelist(groups), read)
    return done.found if done.status == 0 else None


def bare(groups: Groups, **others: dict) -> Groups:
    """A scene that asks for nothing but numbers, with other groups."""
    return copy.deepcopy(groups | BARE) | others


def quantities(file: h5py.File) -> pd.Series:
    """Those that are compared [SI]."""
    return pd.Series({name: float(file[f"summary/{name}"][()]) for name in QUANTITIES})


def told(file: h5py.File) -> dict[str, object] | None:
    """What the program says of each quantity of each ingredient, and the resolution of the run; None if nothing was measured."""
    if "adequacy" not in file:
        return None
    used = file["input/effective/domain"].attrs
    n, *sides = ("intervals_x", "y_half_width") if "intervals_x" in used else ("intervals",)
    rows = []
    for (name, row), q in itertools.product(file["adequacy"].items(), QUANTITIES):
        known = {"change": float(row[q][()]), "error": float(row[q].attrs["error_estimate"])} if q in row else {}
        words = {key: row.attrs.get(key, b"").decode() for key in ("verdict", "measured_on")}
        words |= {"left_out": float(row.attrs.get("left_out", 1.0)), "is_judged": q in row or f"{q}_at_least" in row.attrs}
        rows.append({"ingredient": name, "quantity": q, "change": math.nan, "error": math.nan} | known | words)
    return {
        "rows": pd.DataFrame(rows),
        "quantities": quantities(file),
        "accuracy": float(file["adequacy"].attrs["accuracy"]),
        "domain": {key: float(used[key]) for key in ("x_inlet", "x_outlet", *sides)} | {n: int(used[n])},
        "step": float(file["input/effective/time"].attrs.get("time_step", 0.0)),
        "start": float(file["summary"].attrs.get("statistics_from", 0.0)),
    }


def without(groups: Groups, ingredient: str) -> Groups:
    """The scene without an ingredient."""
    lean = copy.deepcopy(groups)
    if ingredient in LEAN_OIL:
        gone, instead = LEAN_OIL[ingredient]
        lean["lubricant"] = {key: value for key, value in lean["lubricant"].items() if key not in gone} | instead
    elif ingredient == "squeeze":
        lean["time"]["scheme"] = "quasi_steady"
    elif ingredient == "roughness":
        return {key: lean[key] for key in lean if key not in ("surface_1", "surface_2", "time")}
    elif ingredient.startswith("roughness_"):
        del lean[f"surface_{ingredient[-1]}"]
    elif ingredient.startswith("feature_"):
        surface, number = ingredient.split("_")[1:]
        for key in ("amplitude", "wavelength", "position"):
            del lean[f"surface_{surface}"][key][int(number) - 1]
    else:
        lean.pop(ingredient, None)
    return lean


def stiffer(groups: Groups, ratio: float) -> Groups:
    """The scene with stiffer bodies: their contact is narrower, everything else is where it was [m, s]."""
    stiff = copy.deepcopy(groups)
    stiff["bodies"] |= {key: stiff["bodies"][key] * ratio for key in MODULI if key in stiff["bodies"]}
    for group, keys in SCALED.items():
        for key in keys:
            if stiff.get(group, {}).get(key) is not None:
                stiff[group][key] = scaled(stiff[group][key], ratio**0.5)
    return stiff


def lean_runs(groups: Groups, ingredient: str, left_out: float) -> Iterator[tuple[pd.Series | None, bool]]:
    """Quantities of a scene without an ingredient, and whether that is all of it, best first; None where there is no solution."""
    if ingredient != "elasticity":
        yield run(without(groups, ingredient), quantities) if left_out >= 1 else None, True
    elif left_out < 1:
        yield run(stiffer(groups, 1 / (1 - left_out)), quantities), True
    else:
        for ratio in STIFFNESSES:
            yield run(stiffer(groups, ratio), quantities), ratio == STIFFNESSES[0]


def fine(groups: Groups, said: dict) -> Groups:
    """The scene as its truths see it."""
    domain = said["domain"]
    if "time" in groups:
        time = groups["time"] | {"time_step": said["step"] / 2, "statistics_from": said["start"]}
        return bare(groups, domain=domain | {"intervals": 2 * domain["intervals"]}, time=time)
    if "intervals_x" in domain:
        return bare(groups, domain=domain | {"intervals_x": 2 * domain["intervals_x"]})
    if any(key.startswith(("surface", "supply", "asperities")) for key in groups):  # even grids
        return bare(groups, domain=domain | {"intervals": 4 * domain["intervals"]})
    return bare(groups, domain={}, accuracy={"target": TARGET})


def change_of(found: pd.Series, full: pd.Series) -> pd.Series:
    """Relative changes; NaN where there is none."""
    return found.reindex(QUANTITIES) / full.where(full != 0) - 1


def verdict_of(changes: pd.Series, accuracy: float) -> str:
    """By the true changes, as far as they are known."""
    known = changes.dropna().abs()
    if (known > accuracy).any():
        return "needed"
    return "irrelevant" if (known < 0.1 * accuracy).all() else "matters below the accuracy"


def time_step_rows(groups: Groups, said: dict) -> pd.DataFrame:
    """By how much each quantity is off because of the time step, beside what the program says of that."""
    rows = said["rows"][said["rows"]["ingredient"] == "time_step"]
    if rows.empty:
        return rows
    time = groups["time"] | {"time_step": said["step"] * FINER_STEP, "statistics_from": said["start"]}
    exact = run(bare(groups, domain=said["domain"], time=time), quantities)
    if exact is None:
        return rows[:0]
    off = change_of(exact, said["quantities"])
    right = verdict_of(off[rows["change"].notna().values], said["accuracy"])
    # no change, and an error bar that holds what may be off
    rows = rows.assign(error=rows["change"] + rows["error"], change=0.0 * rows["change"])
    return rows.assign(verdict=rows["verdict"].replace("too coarse", "needed"), truth=off.values, true_verdict=right)


def judge(scene: tuple[str, Groups]) -> pd.DataFrame:
    """All ingredients of a scene, some without a truth; none where it does not converge, or has no truth."""
    name, groups = scene
    said = run(groups, told)
    if said is None:
        return pd.DataFrame()
    truth = fine(groups, said)
    full = run(truth, quantities)
    if full is None:
        return pd.DataFrame()
    rows = [time_step_rows(groups, said)]
    for ingredient, own in said["rows"].groupby("ingredient"):
        if ingredient in NUMERICAL:
            continue
        left_out = float(own["left_out"].iloc[0])
        leans = lean_runs(truth, ingredient, left_out)
        found, is_all = next((lean for lean in leans if lean[0] is not None), (pd.Series(dtype=float), False))
        true = change_of(found, full)
        # of a part of an ingredient what all of it would change at that rate, as the program judges
        right = verdict_of(true[own["is_judged"].values] / left_out, said["accuracy"])
        if not is_all:
            # a part of it: no true change, and a verdict only where that part is needed already
            true, right = true * math.nan, right if right == "needed" else NO_TRUTH
        rows.append(own.assign(truth=true.values, true_verdict=right))
    return pd.concat(rows).assign(scene=name, accuracy=said["accuracy"])


def steady_scene(source: random.Random, i: int) -> tuple[str, Groups]:
    """A smooth contact over the range, every third one with ridges or a wave at rest."""
    m, l = 10 ** source.uniform(-1, 2.5), source.uniform(0.3, 20)  # noqa: E741
    # in a steady contact a rough surface stands still
    slide = source.uniform(0, 1.5)
    stress = 10 ** source.uniform(6, 9)
    groups = namelists.steel(m, l, slide if i % 3 else 2.0, None if source.random() < 0.3 else stress)
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
    m, l, stress = 10 ** source.uniform(0, 1.5), source.uniform(2, 12), 10 ** source.uniform(6.3, 8)  # noqa: E741
    groups = namelists.steel(m, l, slide, None if source.random() < 0.4 else stress)
    half_width, film = namelists.scales(groups)
    height = film * 10 ** source.uniform(-3, -0.5)
    wave = source.uniform(0.5, 1.5) * half_width
    sign, kind = source.choice((1, -1)), source.choice(("one", "two", "both", "wave"))
    heights, places = ([height, -height], [-2.5, -3.3]) if kind == "two" else ([height * sign], [-2.5])
    feature = {"shape": "feature", "amplitude": heights, "wavelength": [wave] * len(places), "position": places}
    surfaces = {"surface_2": {"shape": "sinusoid", "amplitude": 0.5 * height, "wavelength": wave} if kind == "wave" else feature}
    if kind == "both":
        surfaces["surface_1"] = {"shape": "feature", "amplitude": [0.7 * height], "wavelength": [wave], "position": [-2.0]}
    slowest = min(1 + slide / 2, 1 - slide / 2 if kind == "both" else 9.0)
    time = {"transient": True, "end_time": 6.0 if kind == "wave" else 4.0 / max(slowest, 0.5)}
    return f"passage {i:03d}", merged(groups, domain={"x_inlet": -4.5, "x_outlet": 2.0, "intervals": 512}, time=time, **surfaces)


def point_scene(source: random.Random, i: int) -> tuple[str, Groups]:
    """A circle or an ellipse in SI, every third one with a dent at rest, on 128 intervals."""
    groups = family_steady.point(source, 2 * i + 1).case | {"domain": {"intervals_x": 128}}
    bodies = groups["bodies"]
    if i % 3 == 0:
        bodies |= {"speed_1": 0.0, "speed_2": bodies["speed_1"] + bodies["speed_2"]}
        wave, height = family_steady.half_axis(groups) * source.uniform(0.5, 1.5), -(10 ** source.uniform(-9.5, -7.5))
        groups["surface_1"] = {"shape": "feature", "amplitude": height, "position": 0.0, "wavelength": wave, "wavelength_y": wave}
    return f"point {i:03d}", groups


# Of each kind how many, and with --quick; what draws one.
DRAWS = {"steady": (45, 8, steady_scene), "passage": (24, 4, passage_scene), "point": (24, 3, point_scene)}


def scenes_of(kind: str, seed: int, quick: bool) -> list[tuple[str, Groups]]:
    """Name and groups of each."""
    if kind == "scene":
        every = [(path.stem, groups_of(f90nml.read(path))) for path in sorted((ROOT / "input" / "scenes").glob("*.nml"))]
        return [(f"scene {name}", groups) for name, groups in every if not groups["case"]["problem"].startswith("dry")]
    many, few, draw = DRAWS[kind]
    source = random.Random(f"{draw.__name__} {seed}")
    return [draw(source, i) for i in range(few if quick else many)]


def line(label: str, own: pd.DataFrame) -> tuple[str, list[float]]:
    """What holds of these rows, and the shares; changes of the smooth steady contact are no statement on a passage."""
    scenes = own.drop_duplicates(["scene", "ingredient"])
    known = scenes[scenes["verdict"] != "not known"]
    whole = known[(known["left_out"] == 1) | (known["verdict"] == "needed")]
    is_right = whole["verdict"] == whole["true_verdict"]
    wrong = (~is_right & (whole[["verdict", "true_verdict"]] == "needed").any(axis=1)).sum()
    judged = own[own["change"].notna() & own["truth"].notna() & ~own["measured_on"].str.contains("smooth")]
    is_honest = (judged["change"] - judged["truth"]).abs() <= judged["error"].clip(lower=FLOOR)
    shares = [is_honest.mean(), is_right.mean()]
    words = " ".join(f"{'-':>10s}" if math.isnan(each) else f"{100 * each:10.1f}" for each in shares)
    return f"{label:26s} {len(scenes):6d} {len(scenes) - len(known):9d} {words} {wrong:13d}", shares


def table(rows: pd.DataFrame) -> tuple[str, bool]:
    """A line an ingredient by kinds of scenes, and all of a kind without time steps; whether all kinds hold what is asked for."""
    lines = [f"{'ingredient':26s} {'scenes':>6s} {'not known':>9s} {'honest [%]':>10s} {'right [%]':>10s} {'surely wrong':>13s}"]
    holds = True
    for kind, mine in rows.groupby(rows["scene"].str.split().str[0], sort=False):
        is_step = mine["ingredient"] == "time_step"
        parts = dict(iter(mine[~is_step].groupby("ingredient"))) | {"all": mine[~is_step], "time_step": mine[is_step]}
        for label, own in ((label, own) for label, own in parts.items() if len(own)):
            words, shares = line(f"{kind} {label}", own)
            lines.append(words)
            holds = holds and (label != "all" or not any(each < WITHIN for each in shares))
    return "\n".join(lines) + "\n", holds


def main() -> int:
    """Command line; status 1 where less is honest or right than asked for."""
    parser = new_parser(__doc__, "few scenes", "results/adequacy", SEED, 1)
    kinds = (*DRAWS, "scene")
    parser.add_argument("--kinds", nargs="+", choices=kinds, default=[*DRAWS], help=f"default: {', '.join(DRAWS)}")
    options = parser.parse_args()
    scenes = [scene for kind in options.kinds for scene in scenes_of(kind, options.seed, options.quick)]
    rows, unjudged = pd.DataFrame(), 0
    for own in side_by_side(judge, scenes, options.processes):
        rows = pd.concat([rows, own[own["true_verdict"] != NO_TRUTH] if len(own) else own])
        unjudged += own.empty
        save(options.output / "adequacy.csv", rows)
    text, holds = table(rows)
    conclude(options.output / "adequacy.txt", f"{text}{unjudged} of {len(scenes)} scenes have no result or no truth\n")
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Are the verdicts of the scenes of input/scenes/ those of fine grids? Each ingredient of each scene is left out on one.

The truth is that of bench/adequacy.py: two runs of their own for a target of 2e-4, passages with half the spacing and half the time
step; dry profiles on 8 times the nodes. Rigid bodies are 2000 times as stiff, or as many times of STIFFNESSES there as have a
solution, which is a lower bound. Verdicts follow from all quantities of the closing table, friction included.

    same       the program's verdict is that of the fine grids
    other      it is not: a miss
    not known  the program gives no verdict: a miss as well
    no truth   there is none: no solution without the ingredient

Without squeeze there are only steady solutions with the waves at their places, for which no namelist asks: the truth is what the
program says itself on SQUEEZE_FINER times the nodes and time steps (against runs of other waves at rest: test_coarse_passages.pf).

Writes scenes.csv and scenes.txt; with --page docs/scenes.md and its figures too (bench/scenes_page.py).
"""

from __future__ import annotations

import copy
import csv
import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import adequacy
import f90nml
import h5py
import scenes_page
from adequacy import Groups
from bench_program import ROOT, new_parser, output_folder

SCENES = ROOT / "input" / "scenes"
DRY = ("contact_area_fraction", "mean_separation", "p_max")
DRY_FINER = 8
SQUEEZE_FINER = 4


@dataclass
class Verdict:
    """One ingredient of a scene; `change` and `truth` of the quantity that it truly changes most."""

    scene: str
    ingredient: str
    verdict: str
    truth: str
    accuracy: float
    quantity: str
    change: float
    error: float
    true_change: float
    note: str

    @property
    def outcome(self) -> str:
        """Same, other, not known, or no truth to compare with."""
        if "not known" in self.verdict or "no truth" in self.truth:
            return self.verdict if self.verdict == "not known" else self.truth
        return "same" if self.verdict == self.truth else "other"


def read_groups(path: Path) -> Groups:
    """The groups of a namelist, without its title."""
    groups = {name: dict(group) for name, group in f90nml.read(path).items()}
    del groups["case"]["title"]
    return groups


def in_reduced_bodies(groups: Groups, scaling: dict[str, float]) -> Groups:
    """The same contact with one radius, one modulus and its load, which bench/adequacy.py can make stiffer; features as lists."""
    groups = copy.deepcopy(groups)
    kept = {key: groups["bodies"][key] for key in ("speed_1", "speed_2")}
    groups["bodies"] = {key: scaling[key] for key in ("reduced_radius", "reduced_modulus")} | kept
    groups["load"] = {"load_per_length": scaling["load_per_length"]}
    for i in (1, 2):
        surface = groups.get(f"surface_{i}", {})
        if surface.get("shape") == "feature":
            surface.update({key: [surface[key]] for key in ("amplitude", "wavelength", "position")})
    return groups


def quantities(file: h5py.File) -> dict[str, float]:
    """Those that decide a verdict."""
    if "sweep" in file:
        return {name: float(file[f"sweep/{name}"][-1]) for name in DRY}
    return {name: float(file[f"summary/{name}"][()]) for name in adequacy.QUANTITIES if name in file["summary"]}


def told(file: h5py.File) -> dict:
    """What the program says: accuracy, and of each ingredient verdict, changes with their errors, what is instead."""
    rows = {}
    for name, row in file["adequacy"].items():
        if name in adequacy.NUMERICAL:
            continue
        changes = {q: (float(row[q][()]), float(row[q].attrs["error_estimate"])) for q in row}
        rows[name] = {"changes": changes} | {key: row.attrs[key].decode() for key in ("verdict", "instead")}
    said = {"rows": rows, "accuracy": float(file["adequacy"].attrs["accuracy"])}
    if "sweep" in file:
        return said | {"heights": file["solution/height_undeformed"][()], "spacing": float(file["solution/x"][1])}
    scaling = {key: float(file["scaling"].attrs[key]) for key in ("reduced_radius", "reduced_modulus", "load_per_length")}
    return adequacy.told(file) | said | {"scaling": scaling}


def lean_dry(truth: Groups, ingredient: str, instead: str) -> Groups:
    """A dry scene without an ingredient."""
    lean = copy.deepcopy(truth)
    if ingredient == "plasticity":
        del lean["bodies"]["hardness"]
    else:
        lean["surface_1"]["harmonics"] = int(re.match(r"the harmonics 1 to (\d+)", instead)[1])
    return lean


def lean_runs(truth: Groups, ingredient: str, instead: str) -> Iterator[tuple[dict | None, str]]:
    """Quantities of the scene without an ingredient, and a note, best first; None where there is no solution."""
    if truth["case"]["problem"] != "ehl_line":
        yield adequacy.run(lean_dry(truth, ingredient, instead), quantities), ""
    elif ingredient == "elasticity":
        for ratio in adequacy.STIFFNESSES:
            note = "" if ratio == adequacy.STIFFNESSES[0] else f"bodies {ratio:.0f} times as stiff"
            yield adequacy.run(adequacy.stiffer(truth, ratio), quantities), note
    else:
        yield adequacy.run(adequacy.without(truth, ingredient, 1.0), quantities), ""


def fine_dry(groups: Groups, said: dict, heights: Path) -> Groups:
    """A dry scene with the same heights on a finer grid; they are written to a file."""
    with h5py.File(heights, "w") as file:
        file.create_dataset("heights", data=said["heights"]).attrs["spacing"] = said["spacing"]
    truth = copy.deepcopy(groups) | copy.deepcopy(adequacy.NO_EXTRAS)
    truth["surface_1"] = {"shape": "file", "file": str(heights.resolve()), "dataset": "heights"}
    truth["domain"] = {"intervals": DRY_FINER * groups["domain"]["intervals"]}
    return truth


def judge(path: Path, folder: Path) -> list[Verdict]:
    """Every ingredient of a scene; `folder` takes the heights of a dry one."""
    groups = read_groups(path)
    said = adequacy.run(groups, told)
    if groups["case"]["problem"] == "ehl_line":
        truth = adequacy.fine(in_reduced_bodies(groups, said["scaling"]), said)
    else:
        truth = fine_dry(groups, said, folder / f"{path.stem}_heights.h5")
    full = adequacy.run(truth, quantities)
    if full is None:
        sys.exit(f"scenes.py: {path.stem}: does not converge on the fine grid")
    verdicts = []
    for ingredient, row in said["rows"].items():
        note = ""
        if ingredient == "squeeze":
            true = squeeze_changes(groups, said)
        else:
            leans = lean_runs(truth, ingredient, row["instead"])
            found, note = next(((lean, note) for lean, note in leans if lean), (None, ""))
            true = {q: found[q] / full[q] - 1 for q in found} if found else {}
        right = adequacy.verdict_of(list(true.values()), said["accuracy"]) if true else "no truth"
        if note.startswith("bodies") and right != "needed":
            right = "no truth"
        quantity = max(true, key=lambda q: abs(true[q]), default="")
        change, error = row["changes"].get(quantity, (float("nan"), float("nan")))
        values = (quantity, change, error, true.get(quantity, float("nan")), note)
        verdicts.append(Verdict(path.stem, ingredient, row["verdict"], right, said["accuracy"], *values))
    return verdicts


def squeeze_changes(groups: Groups, said: dict) -> dict[str, float]:
    """What the squeeze term changes on finer grids with shorter steps, by the program itself."""
    finer = copy.deepcopy(groups)
    finer["domain"] = said["domain"] | {"intervals": SQUEEZE_FINER * said["domain"]["intervals"]}
    finer["time"] |= {"time_step": said["step"] / SQUEEZE_FINER, "statistics_from": said["start"]}
    again = adequacy.run(finer, told)
    changes = again["rows"]["squeeze"]["changes"] if again else {}
    return {q: changes[q][0] for q in adequacy.QUANTITIES if q in changes}


def summary(verdicts: list[Verdict]) -> str:
    """How many scenes and ingredients are right."""
    names = list(dict.fromkeys(each.scene for each in verdicts))
    whole = [name for name in names if all(each.outcome == "same" for each in verdicts if each.scene == name)]
    never = [name for name in names if not any(each.outcome == "other" for each in verdicts if each.scene == name)]
    known = [each for each in verdicts if math.isfinite(each.change) and math.isfinite(each.true_change)]
    within = sum(abs(each.change - each.true_change) <= each.error for each in known)
    count = {word: sum(each.outcome == word for each in verdicts) for word in ("same", "other", "not known", "no truth")}
    return (
        f"Of {len(names)} scenes {len(whole)} have every verdict of the fine grids, {len(never)} have none that differs.\n"
        f"Of {len(verdicts)} verdicts {count['same']} are the same, {count['other']} differ, {count['not known']} are not known, "
        f"{count['no truth']} have no truth.\n"
        f"Of the {len(known)} largest changes that are known {within} are those of the fine grids to their error bars.\n"
    )


def main() -> int:
    """Command line; status 1 where a scene does not get the verdicts of the fine grids."""
    parser = new_parser(__doc__, "the steady scenes", "results/scenes")
    parser.add_argument("--page", action="store_true", help="write docs/scenes.md")
    options = parser.parse_args()
    folder = output_folder(options)
    verdicts: list[Verdict] = []
    for path in sorted(SCENES.glob("*.nml")):
        if options.quick and "&time" in path.read_text(encoding="utf-8"):
            continue
        print(f"{path.stem}", file=sys.stderr)
        verdicts += judge(path, folder)
        with (folder / "scenes.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow([*Verdict.__dataclass_fields__, "outcome"])
            writer.writerows([*each.__dict__.values(), each.outcome] for each in verdicts)
    text = summary(verdicts)
    (folder / "scenes.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    if options.page and not options.quick:
        print(scenes_page.write_page(folder))
    return 0 if all(each.outcome == "same" for each in verdicts) else 1


if __name__ == "__main__":
    sys.exit(main())

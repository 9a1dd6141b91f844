#!/usr/bin/env python3
"""Measures accuracy and cost of model = 'auto' on random scenes, against the full model.

Scenes are steady contacts and passages: smooth, with ridges, dents and waves that move or rest, with Newtonian and Eyring oils,
piezoviscous and not, of steel and of rubber. Each is solved with &accuracy target = TARGET by model = 'auto' and by 'full'; the
truth is 'full' with a quarter of that target. Time is the processor time of the whole program; a run that exceeds PATIENCE of it
is ended, so that a loaded machine judges the same scenes.

    met        h_min of 'auto' (of 'full') is within the target of the truth
    honest     the truth is within the error bars of 'auto' and its own

Target: 95 % met. --seed draws another sample, for fitting. Writes auto.csv, auto.txt and auto.png.
"""

from __future__ import annotations

import math
import random
import sys
from pathlib import Path

import h5py
import namelists
import pandas as pd
from adequacy import passage_scene, scaled, steady_scene
from bench_program import Answer, Run, answer, conclude, new_parser, run_program, save, side_by_side
from namelists import Groups, namelist

import figure_style as style  # isort: skip

SEED = 884222
TARGET, SHARE = 0.01, 0.25
COUNTS, QUICK = (100, 200), (4, 8)
WITHIN = 0.95
PATIENCE = 20
SOFT_MODULUS = 2e7


def run(groups: Groups, model: str, target: float) -> Run:
    """A scene by a model, within PATIENCE."""
    case = groups | {"case": {"problem": "ehl_line", "model": model}, "accuracy": {"target": target}, "output": {"adequacy": False}}
    return run_program(namelist(case), read, limit=PATIENCE)


def read(file: h5py.File) -> Answer:
    """What the program says, the error bar of h_min, and what was solved."""
    found = {"error": file["summary/h_min"].attrs["error_estimate"], "solved": ""}
    if group := file.get("adequacy/decision"):
        found["solved"] = group.attrs["solved"].decode()
    return Answer(answer(file) | found)


def judge(scene: tuple[str, Groups]) -> dict[str, object]:
    """What was solved, processor times [s], relative differences from the truth, error bars of 'auto' and the truth.

    A scene is not judged (`unjudged` says why) where one of its runs does not converge.
    """
    name, groups = scene
    runs = {}
    for word, model, target in (("truth", "full", SHARE * TARGET), ("auto", "auto", TARGET), ("full", "full", TARGET)):
        runs[word] = run(groups, model, target)
        if status := runs[word].status:
            why = f"over {PATIENCE} s" if status < 0 else f"exit status {status}"
            return {"scene": name, "unjudged": f"{word}: {why}"}
    exact, lean = (runs[word].found for word in ("truth", "auto"))
    row = {"scene": name, "unjudged": "", "solved": lean["solved"]}
    row |= {f"{word}_seconds": runs[word].processor for word in ("auto", "full")}
    row |= {f"{word}_error": runs[word].found["h_min"] / exact["h_min"] - 1 for word in ("auto", "full")}
    return row | {"error_bar": (lean["error"] + exact["error"]) / exact["h_min"]}


def scene(source: random.Random, i: int, is_passage: bool) -> tuple[str, Groups]:
    """A scene of bench/adequacy.py, with the program's domain; some of rubber, some isoviscous, some with roughness at rest."""
    name, groups = (passage_scene if is_passage else steady_scene)(source, i)
    groups.pop("domain", None)
    stretch(groups, "wavelength", 10 ** source.uniform(-0.8, 0))
    kind = source.random()
    if kind < 0.15:
        groups["lubricant"] = {"viscosity": groups["lubricant"]["viscosity"], "viscosity_law": "constant"}
    elif kind < 0.3:
        soften(groups)
    if not is_passage:
        stop(groups, 1)
    elif source.random() < 0.2 and "surface_1" not in groups:
        stop(groups, 2)
        if groups["surface_2"]["shape"] == "feature":
            groups["surface_2"]["position"] = [source.uniform(-1, 0.8) for _ in groups["surface_2"]["position"]]
    return name, groups


def stretch(groups: Groups, key: str, factor: float) -> None:
    """Waves of another length or height."""
    for surface in ("surface_1", "surface_2"):
        if surface in groups:
            groups[surface][key] = scaled(groups[surface][key], factor)


def stop(groups: Groups, surface: int) -> None:
    """All of the speed on the other surface."""
    bodies = groups["bodies"]
    bodies[f"speed_{3 - surface}"] += bodies[f"speed_{surface}"]
    bodies[f"speed_{surface}"] = 0.0


def soften(groups: Groups) -> None:
    """Rubber and a constant viscosity: the same Moes number M, waves as long over the half-width and as high over a rough film."""
    before = namelists.scales(groups)
    bodies, oil = groups["bodies"], groups["lubricant"]
    # w/(E' R) U^(-1/2) stays with the load times the ratio^(1/2)
    groups["load"]["load_per_length"] *= math.sqrt(SOFT_MODULUS / bodies["reduced_modulus"])
    bodies["reduced_modulus"] = SOFT_MODULUS
    after = namelists.scales(groups)
    groups["lubricant"] = {"viscosity": oil["viscosity"], "viscosity_law": "constant", "density_law": "constant"}
    for key, old, new in zip(("wavelength", "amplitude"), before, after, strict=True):
        stretch(groups, key, new / old)


# Groups of the table: the kind of scenes, a word of what was solved, and the mark in the figure.
PARTS = {
    "all": ("", "", ""),
    "steady contacts": ("steady", "", "o"),
    "passages": ("passage", "", ""),
    "  solved smooth and steady": ("passage", "smooth", "v"),
    "  solved rough and steady": ("passage", "its roughness", "^"),
    "  solved as passages": ("passage", "every", "s"),
}


def part_of(rows: pd.DataFrame, label: str) -> pd.DataFrame:
    """The rows of a group."""
    kind, word, _ = PARTS[label]
    return rows[rows["scene"].str.startswith(kind) & rows["solved"].str.contains(word)]


def summary(all_rows: pd.DataFrame, seed: int) -> str:
    """The outcome in lines."""
    rows = all_rows[all_rows["unjudged"] == ""]
    count = f"{len(rows)} of {len(all_rows)}"
    text = f"seed {seed}: {count} scenes converged within {PATIENCE} s a run; target {TARGET:g} of h_min\n"
    unjudged = all_rows[all_rows["unjudged"] != ""].groupby("unjudged").size()
    text += "".join(f"  not judged, {words}: {count}\n" for words, count in unjudged.items())
    text += f"{'':28s} {'scenes':>6s} {'met':>8s} {'full met':>9s} {'honest':>8s} {'time over full':>15s} {'in all':>7s}\n"
    for label in PARTS:
        own = part_of(rows, label)
        if len(own):
            met, full = (100 * (own[key].abs() <= TARGET).mean() for key in ("auto_error", "full_error"))
            known = own[own["error_bar"].notna()]
            honest = 100 * (known["auto_error"].abs() <= known["error_bar"]).mean()
            ratios, total = own["auto_seconds"] / own["full_seconds"], own["auto_seconds"].sum() / own["full_seconds"].sum()
            text += f"{label:28s} {len(own):6d} {met:6.1f} % {full:7.1f} % {honest:6.1f} %"
            text += f" {ratios.quantile(0.5, interpolation='higher'):10.2f} med. {total:7.2f}\n"
    worst = rows.loc[rows["auto_error"].abs().idxmax()]
    return f"{text}largest difference: {100 * worst['auto_error']:.2g} % ({worst['scene']}, {worst['solved']})\n"


def draw(rows: pd.DataFrame, path: Path) -> None:
    """Processor time of 'auto' over that of 'full', and how far off both are."""
    figure, (times, errors) = style.new_figure(style.TWO_COLUMNS, 75, ncols=2)
    marked = {label: marker for label, (_, _, marker) in PARTS.items() if marker}
    for (label, marker), series in zip(marked.items(), style.SERIES, strict=False):
        own = part_of(rows, label)
        shape = {"linestyle": "none", "marker": marker, "markersize": 3.5, "color": series["color"], "alpha": 0.8}
        times.loglog(1e3 * own["full_seconds"], 1e3 * own["auto_seconds"], label=label.strip(), **shape)
        errors.loglog(*(100 * own[key].abs().clip(lower=1e-6) for key in ("full_error", "auto_error")), **shape)
    errors.axhline(100 * TARGET, color="0.3", linestyle="--", linewidth=0.8, zorder=0, label="target")
    for axes in (times, errors):
        ends = [min(axes.get_xlim()[0], axes.get_ylim()[0]), max(axes.get_xlim()[1], axes.get_ylim()[1])]
        axes.plot(ends, ends, color="0.6", linewidth=0.7, zorder=0)
        axes.set(xlim=ends, ylim=ends)
    times.set(xlabel="Processor time with model = 'full' [ms]", ylabel="Processor time with model = 'auto' [ms]")
    errors.set(xlabel="Error of h_min with model = 'full' [%]", ylabel="Error of h_min with model = 'auto' [%]")
    style.legend_below(figure, [*times.get_legend_handles_labels()[0], *errors.get_legend_handles_labels()[0]], 3)
    style.save_figure(figure, [path])


def main() -> int:
    """Command line; status 1 where fewer scenes meet the target than asked for."""
    options = new_parser(__doc__, f"{QUICK} scenes", "results/auto", SEED, 1).parse_args()
    scenes = []
    for kind, count in zip(("steady", "passage"), QUICK if options.quick else COUNTS, strict=True):
        source = random.Random(f"auto {kind} {options.seed}")
        scenes += [scene(source, i, kind == "passage") for i in range(count)]
    rows = pd.DataFrame(side_by_side(judge, scenes, options.processes))
    save(options.output / "auto.csv", rows)
    judged = rows[rows["unjudged"] == ""]
    if judged.empty:
        sys.exit("auto.py: no scene is judged")
    conclude(options.output / "auto.txt", summary(rows, options.seed))
    draw(judged, options.output / "auto.png")
    return 0 if (judged["auto_error"].abs() <= TARGET).mean() >= WITHIN else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Measures accuracy and cost of model = 'auto' on random scenes, against the full model.

Scenes are steady contacts and passages: smooth, with ridges, dents and waves that move or rest, with Newtonian and Eyring oils,
piezoviscous and not, of steel and of rubber. Each is solved with &accuracy target = TARGET by model = 'auto' and by 'full'; the
truth is 'full' with a quarter of that target. Time is the processor time of the whole program; a run that exceeds PATIENCE of it
is ended, so that a loaded machine judges the same scenes.

    met        h_min of 'auto' (of 'full') is within the target of the truth
    honest     the truth is within the error bars of 'auto' and its own

Target: 95 % met. --seed draws another sample, for fitting. Finished scenes are kept in auto_SEED.csv, so that the same command
continues an interrupted run. Writes auto_SEED.txt and auto_SEED.png; --page copies both into docs/.
"""

from __future__ import annotations

import math
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import h5py
import namelists
from adequacy import STILL, passage_scene, scaled, steady_scene
from bench_program import ASPERITY, ENVIRONMENT, ROOT, conclude, new_parser, output_folder, read_csv, save, side_by_side
from judge import share
from namelists import Groups
from page import fenced, put_block

import figure_style as style  # isort: skip

SEED = 884222
TARGET, SHARE = 0.01, 0.25
COUNTS, QUICK = (100, 200), (4, 8)
WITHIN = 0.95
PATIENCE = 20
SOFT_MODULUS = 2e7


@dataclass
class Row:
    """One scene: what was solved, processor times [s], relative differences from the truth, error bars of 'auto' and the truth."""

    scene: str
    # Why it is not judged; empty: it is.
    unjudged: str
    solved: str = ""
    left_out: str = ""
    auto_seconds: float = math.nan
    full_seconds: float = math.nan
    auto_error: float = math.nan
    full_error: float = math.nan
    error_bar: float = math.nan
    h_central: float = math.nan
    p_max: float = math.nan


def run(groups: Groups, model: str, target: float) -> tuple[float, dict | str]:
    """Processor time [s] of a scene by a model, and what its result says, or why there is none within PATIENCE."""
    case = groups | {"case": {"problem": "ehl_line", "model": model}, "accuracy": {"target": target}, "output": {"adequacy": False}}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "case.nml").write_text(namelists.namelist(case), encoding="utf-8")
        silent = {"cwd": folder, "env": ENVIRONMENT, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        with subprocess.Popen([ASPERITY, "--quiet", "case.nml"], **silent) as process:
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (PATIENCE, PATIENCE))
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
        if status != 0:
            return math.nan, f"over {PATIENCE} s" if os.WIFSIGNALED(status) else f"exit status {process.returncode}"
        with h5py.File(folder / "case.h5") as file:
            return usage.ru_utime + usage.ru_stime, read(file)


def read(file: h5py.File) -> dict:
    """Quantities and their error bars [SI], what was solved and what was left out."""
    found = {"solved": "", "left_out": ""}
    for name in STILL:
        found[name] = float(file[f"summary/{name}"][()])
        found[f"{name}_error"] = float(file[f"summary/{name}"].attrs["error_estimate"])
    if "adequacy/decision" in file:
        group = file["adequacy/decision"]
        found["solved"] = group.attrs["solved"].decode()
        found["left_out"] = " ".join(name for name in group if group[name].attrs["decision"] == b"left out")
    return found


def judge(scene: tuple[str, Groups]) -> Row:
    """One scene; it is not judged where one of its runs does not converge."""
    name, groups = scene
    found = {}
    for word, model, target in (("truth", "full", SHARE * TARGET), ("auto", "auto", TARGET), ("full", "full", TARGET)):
        found[word] = run(groups, model, target)
        if isinstance(found[word][1], str):
            return Row(name, f"{word}: {found[word][1]}")
    (_, exact), (auto_seconds, lean), (full_seconds, full) = found.values()
    off = {q: lean[q] / exact[q] - 1 for q in STILL}
    bar = (lean["h_min_error"] + exact["h_min_error"]) / exact["h_min"]
    errors = off["h_min"], full["h_min"] / exact["h_min"] - 1, bar, off["h_central"], off["p_max"]
    return Row(name, "", lean["solved"], lean["left_out"], auto_seconds, full_seconds, *errors)


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


def summary(all_rows: list[Row], seed: int) -> str:
    """The outcome in lines."""
    rows = [row for row in all_rows if not row.unjudged]
    count = f"{len(rows)} of {len(all_rows)}"
    lines = [f"seed {seed}: {count} scenes converged within {PATIENCE} s a run; target {TARGET:g} of h_min\n"]
    why = Counter(row.unjudged for row in all_rows if row.unjudged)
    lines += [f"  not judged, {words}: {count}\n" for words, count in sorted(why.items())]
    lines += [f"{'':28s} {'scenes':>6s} {'met':>8s} {'full met':>9s} {'honest':>8s} {'time over full':>15s} {'in all':>7s}\n"]
    groups = {
        "all": lambda _: True,
        "steady contacts": lambda row: row.scene.startswith("steady"),
        "passages": lambda row: row.scene.startswith("passage"),
        "  solved smooth and steady": lambda row: row.scene.startswith("passage") and "smooth" in row.solved,
        "  solved rough and steady": lambda row: row.scene.startswith("passage") and "its roughness" in row.solved,
        "  solved as passages": lambda row: row.scene.startswith("passage") and "every" in row.solved,
    }
    for label, belongs in groups.items():
        own = [row for row in rows if belongs(row)]
        if own:
            met, full = (share(own, lambda row, key=key: abs(getattr(row, key)) <= TARGET) for key in ("auto_error", "full_error"))
            honest = share([row for row in own if math.isfinite(row.error_bar)], lambda row: abs(row.auto_error) <= row.error_bar)
            ratios = sorted(row.auto_seconds / row.full_seconds for row in own)
            total = sum(row.auto_seconds for row in own) / sum(row.full_seconds for row in own)
            lines.append(
                f"{label:28s} {len(own):6d} {100 * met:6.1f} % {100 * full:7.1f} % {100 * honest:6.1f} %"
                f" {ratios[len(ratios) // 2]:10.2f} med. {total:7.2f}\n"
            )
    worst = max(rows, key=lambda row: abs(row.auto_error))
    lines.append(f"largest difference: {100 * worst.auto_error:.2g} % ({worst.scene}, {worst.solved})\n")
    return "".join(lines)


def draw(rows: list[Row], path: Path) -> None:
    """Processor time of 'auto' over that of 'full', and how far off both are."""
    figure, (times, errors) = style.new_figure(style.TWO_COLUMNS, 75, ncols=2)
    looks = {
        "steady contact": ("o", lambda row: row.scene.startswith("steady")),
        "passage, solved as one": ("s", lambda row: row.scene.startswith("passage") and "every" in row.solved),
        "passage, solved steady and rough": ("^", lambda row: "its roughness" in row.solved),
        "passage, solved steady and smooth": ("v", lambda row: "smooth" in row.solved),
    }
    for (label, (marker, belongs)), series in zip(looks.items(), style.SERIES, strict=False):
        own = [row for row in rows if belongs(row)]
        shape = {"linestyle": "none", "marker": marker, "markersize": 3.5, "color": series["color"], "alpha": 0.8}
        times.loglog([1e3 * row.full_seconds for row in own], [1e3 * row.auto_seconds for row in own], label=label, **shape)
        pairs = [[100 * max(abs(error), 1e-6) for error in (row.full_error, row.auto_error)] for row in own]
        errors.loglog([pair[0] for pair in pairs], [pair[1] for pair in pairs], **shape)
    for axes in (times, errors):
        ends = [min(axes.get_xlim()[0], axes.get_ylim()[0]), max(axes.get_xlim()[1], axes.get_ylim()[1])]
        axes.plot(ends, ends, color="0.6", linewidth=0.7, zorder=0)
        axes.set(xlim=ends, ylim=ends)
    times.set(xlabel="Processor time with model = 'full' [ms]", ylabel="Processor time with model = 'auto' [ms]")
    errors.axhline(100 * TARGET, color="0.3", linestyle="--", linewidth=0.8, zorder=0, label="target")
    errors.set(xlabel="Error of h_min with model = 'full' [%]", ylabel="Error of h_min with model = 'auto' [%]")
    style.legend_below(figure, [*times.get_legend_handles_labels()[0], *errors.get_legend_handles_labels()[0]], 3)
    style.save_figure(figure, [path])


def stored(path: Path) -> list[Row]:
    """The scenes that are done."""
    words = ("scene", "unjudged", "solved", "left_out")
    return [Row(**{key: v if key in words else float(v) for key, v in values.items()}) for values in read_csv(path)]


def drawn(seed: int, counts: tuple[int, int]) -> list[tuple[str, Groups]]:
    """The scenes, both kinds all along, so that a run that is ended has seen its share of each."""
    source = [random.Random(f"auto {word} {seed}") for word in ("steady", "passage")]
    scenes = [(i / counts[k], scene(source[k], i, k == 1)) for k in (0, 1) for i in range(counts[k])]
    return [each for _, each in sorted(scenes, key=lambda pair: pair[0])]


def main() -> int:
    """Command line; status 1 where fewer scenes meet the target than asked for."""
    parser = new_parser(__doc__, f"{QUICK} scenes", "results/auto", SEED, 1)
    parser.add_argument("--page", action="store_true", help="copy table and figure of the stored scenes into docs/")
    options = parser.parse_args()
    folder = output_folder(options)
    path = folder / f"auto_{options.seed}{'_quick' if options.quick else ''}.csv"
    rows = stored(path)
    if not options.page:
        done = {row.scene for row in rows}
        left = [each for each in drawn(options.seed, QUICK if options.quick else COUNTS) if each[0] not in done]
        for row in side_by_side(judge, left, options.processes):
            rows.append(row)
            save(path, rows)
    judged = [row for row in rows if not row.unjudged]
    if not judged:
        sys.exit(f"auto.py: {path}: no scene is judged")
    text = summary(rows, options.seed)
    conclude(folder / f"auto_{options.seed}.txt", text)
    figure = folder / f"auto_{options.seed}.png"
    draw(judged, figure)
    if options.page:
        shutil.copy(figure, ROOT / "docs" / "images" / "auto.png")
        put_block("auto", fenced(text))
    return 0 if share(judged, lambda row: abs(row.auto_error) <= TARGET) >= WITHIN else 1


if __name__ == "__main__":
    sys.exit(main())

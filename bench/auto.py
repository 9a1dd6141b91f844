#!/usr/bin/env python3
"""Does model = 'auto' keep its promise, and what does it save? Random scenes, solved by it, by the full model, and by that finely.

Scenes are steady contacts and passages: smooth, with ridges, dents and waves that move or rest, with Newtonian and Eyring oils,
piezoviscous and not, of steel and of rubber. Each is solved with &accuracy target = TARGET by model = 'auto' and by 'full'; the
truth is 'full' with a quarter of that. Time is the processor time of the whole program, the least of RUNS runs that take turns.

    met        h_min of 'auto' (of 'full') is within the target of the truth
    honest     the truth is within the error bars of 'auto' and its own

Asked for: 95 % met. --seed draws another sample, for fitting. Writes auto.csv, auto.txt and auto.png.
"""

from __future__ import annotations

import copy
import csv
import math
import os
import random
import resource
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import h5py
import namelists
from adequacy import PROGRAM, STILL, Groups, passage_scene, scales, steady_scene
from bench_program import ENVIRONMENT, ROOT, new_parser, output_folder

sys.path.insert(0, str(ROOT / "postproc"))
import figure_style as style

SEED = 884222
TARGET, SHARE = 0.01, 0.25
RUNS = 1
COUNTS, QUICK = (100, 200), (4, 8)
WITHIN = 0.95
PATIENCE = 20
SOFT_MODULUS = 2e7


@dataclass
class Row:
    """One scene: what was solved, processor times [s], relative differences from the truth, error bars of 'auto' and the truth."""

    scene: str
    solved: str
    left_out: str
    auto_seconds: float
    full_seconds: float
    auto_error: float
    full_error: float
    error_bar: float
    h_central: float
    p_max: float


def run(groups: Groups, runs: int = 1) -> tuple[float, dict] | None:
    """Least processor time [s] of a namelist, and what its result says; None where it does not converge, or takes over PATIENCE."""
    seconds = math.inf
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "case.nml").write_text(namelists.namelist(groups), encoding="utf-8")
        for _ in range(runs):
            with subprocess.Popen(
                [PROGRAM, "--quiet", "case.nml"], cwd=folder, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            ) as process:
                resource.prlimit(process.pid, resource.RLIMIT_CPU, (PATIENCE, PATIENCE))
                _, status, usage = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
            if status != 0:
                return None
            seconds = min(seconds, usage.ru_utime + usage.ru_stime)
        with h5py.File(folder / "case.h5") as file:
            return seconds, read(file)


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


def judge(scene: tuple[str, Groups]) -> Row | None:
    """One scene; None where one of its runs does not converge."""
    name, groups = scene

    def asked(model: str, target: float) -> Groups:
        case = copy.deepcopy(groups)
        case["case"] = {"problem": "ehl_line", "model": model}
        case["accuracy"] = {"target": target}
        case["output"] = {"adequacy": False}
        return case

    truth = run(asked("full", SHARE * TARGET))
    best = {"auto": math.inf, "full": math.inf}
    found = {}
    for _ in range(RUNS):
        for model, seconds in best.items():
            answer = run(asked(model, TARGET))
            if answer is None or truth is None:
                return None
            best[model] = min(seconds, answer[0])
            found[model] = answer[1]
    lean, full, exact = found["auto"], found["full"], truth[1]
    off = {q: lean[q] / exact[q] - 1 for q in STILL}
    bar = (lean["h_min_error"] + exact["h_min_error"]) / exact["h_min"]
    return Row(
        name, lean["solved"], lean["left_out"], best["auto"], best["full"],
        off["h_min"], full["h_min"] / exact["h_min"] - 1, bar, off["h_central"], off["p_max"],
    )  # fmt: skip


def scene(source: random.Random, i: int, is_passage: bool) -> tuple[str, Groups]:
    """A scene of bench/adequacy.py, with the program's domain; some of rubber, some isoviscous, some with roughness at rest."""
    name, groups = (passage_scene if is_passage else steady_scene)(source, i)
    groups.pop("domain", None)
    shorten(groups, 10 ** source.uniform(-0.8, 0))
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


def shorten(groups: Groups, factor: float) -> None:
    """Waves of another length."""
    for key in ("surface_1", "surface_2"):
        if key in groups:
            value = groups[key]["wavelength"]
            groups[key]["wavelength"] = [each * factor for each in value] if isinstance(value, list) else value * factor


def stop(groups: Groups, surface: int) -> None:
    """All of the speed on the other surface."""
    bodies = groups["bodies"]
    bodies[f"speed_{3 - surface}"] += bodies[f"speed_{surface}"]
    bodies[f"speed_{surface}"] = 0.0


def soften(groups: Groups) -> None:
    """Rubber and a constant viscosity: the same Moes number M, waves as long over the half-width and as high over a rough film."""
    before = scales(groups)
    bodies, oil = groups["bodies"], groups["lubricant"]
    ratio = SOFT_MODULUS / bodies["reduced_modulus"]
    # w/(E' R) U^(-1/2) stays with the load times ratio^(1/2)
    groups["load"]["load_per_length"] *= math.sqrt(ratio)
    bodies["reduced_modulus"] = SOFT_MODULUS
    after = scales(groups)
    groups["lubricant"] = {"viscosity": oil["viscosity"], "viscosity_law": "constant", "density_law": "constant"}
    for key in ("surface_1", "surface_2"):
        for length, factor in (("wavelength", after[0] / before[0]), ("amplitude", after[1] / before[1])):
            if key in groups:
                value = groups[key][length]
                groups[key][length] = [each * factor for each in value] if isinstance(value, list) else value * factor


def summary(rows: list[Row], count: int) -> str:
    """The outcome in lines."""
    lines = [f"{len(rows)} of {count} scenes converged within {PATIENCE} s a run; target {TARGET:g} of h_min\n"]
    lines += [f"{'':28s} {'scenes':>6s} {'met':>8s} {'full met':>9s} {'honest':>8s} {'time over full':>15s} {'in all':>7s}\n"]
    passages = [row for row in rows if row.scene.startswith("passage")]
    groups = {
        "all": rows,
        "steady contacts": [row for row in rows if row not in passages],
        "passages": passages,
        "  solved smooth and steady": [row for row in passages if "smooth" in row.solved],
        "  solved rough and steady": [row for row in passages if "its roughness" in row.solved],
        "  solved as passages": [row for row in passages if "every" in row.solved],
    }
    for label, own in groups.items():
        if not own:
            continue
        met = sum(abs(row.auto_error) <= TARGET for row in own) / len(own)
        full = sum(abs(row.full_error) <= TARGET for row in own) / len(own)
        known = [row for row in own if math.isfinite(row.error_bar)]
        honest = sum(abs(row.auto_error) <= row.error_bar for row in known) / max(len(known), 1)
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
        "steady, full": ("o", lambda row: row.scene.startswith("steady")),
        "passage, full": ("s", lambda row: row.scene.startswith("passage") and "every" in row.solved),
        "passage, steady and rough": ("^", lambda row: "its roughness" in row.solved),
        "passage, steady and smooth": ("v", lambda row: "smooth" in row.solved),
    }
    for label, (marker, belongs) in looks.items():
        own = [row for row in rows if belongs(row)]
        shape = {"linestyle": "none", "marker": marker, "markersize": 3, "alpha": 0.7}
        times.loglog([1e3 * row.full_seconds for row in own], [1e3 * row.auto_seconds for row in own], label=label, **shape)
        pairs = [[100 * max(abs(error), 1e-6) for error in (row.full_error, row.auto_error)] for row in own]
        errors.loglog([pair[0] for pair in pairs], [pair[1] for pair in pairs], **shape)
    for axes in (times, errors):
        ends = [min(axes.get_xlim()[0], axes.get_ylim()[0]), max(axes.get_xlim()[1], axes.get_ylim()[1])]
        axes.plot(ends, ends, color="0.6", linewidth=0.7, zorder=0)
        axes.set(xlim=ends, ylim=ends)
    times.set(xlabel="Processor time of model = 'full' [ms]", ylabel="of model = 'auto' [ms]")
    errors.axhline(100 * TARGET, color="0.3", linestyle="--", linewidth=0.8, zorder=0)
    errors.set(xlabel="Error of h_min, model = 'full' [%]", ylabel="model = 'auto' [%]")
    handles, _ = times.get_legend_handles_labels()
    style.legend_below(figure, handles, 4)
    style.save_figure(figure, [path])


def main() -> int:
    """Command line; status 1 where fewer scenes meet the target than asked for."""
    parser = new_parser(__doc__, f"{QUICK} scenes", "results/auto")
    parser.add_argument("--seed", type=int, default=SEED, help="another sample, for fitting")
    parser.add_argument("--processes", type=int, default=1, help="scenes side by side")
    options = parser.parse_args()
    folder = output_folder(options)
    counts = QUICK if options.quick else COUNTS
    source = [random.Random(f"auto {word} {options.seed}") for word in ("steady", "passage")]
    scenes = [(i / counts[k], scene(source[k], i, k == 1)) for k in (0, 1) for i in range(counts[k])]
    # both kinds all along, so that a run that is ended (Ctrl-C) has seen its share of each
    scenes.sort(key=lambda each: each[0])
    rows: list[Row] = []
    count = 0
    with (folder / "auto.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(Row.__dataclass_fields__))
        writer.writeheader()
        with ThreadPoolExecutor(options.processes) as pool:
            try:
                for row in pool.map(judge, (each for _, each in scenes)):
                    count += 1
                    if row is not None:
                        rows.append(row)
                        writer.writerow(vars(row))
                        file.flush()
                    print(f"\r{count} of {len(scenes)}   ", end="", file=sys.stderr, flush=True)
            except KeyboardInterrupt:
                pool.shutdown(cancel_futures=True)
    print(file=sys.stderr)
    text = summary(rows, count)
    (folder / "auto.txt").write_text(text, encoding="utf-8")
    draw(rows, folder / "auto.png")
    print(text, end="")
    met = sum(abs(row.auto_error) <= TARGET for row in rows)
    return 0 if met >= WITHIN * len(rows) else 1


if __name__ == "__main__":
    sys.exit(main())

"""The panel of the chart with both errors: of the numbers, over grids of the full model, and of leaner models on one grid.

A ridge passes through Case 1. The error of the numbers is that of the smallest film of all times against the finest grid, with
time steps dX/2; that of a model is the change of that film where an ingredient is left out, on the same grid. Cost is processor
time: all runs take turns in one process, and the least of the turns counts.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import dataclass, field
from pathlib import Path

import bench_program
import namelists
from bench_program import ROOT, Answer, Job, job

sys.path.append(str(ROOT / "postproc"))

import figure_style as style
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

# On the grids of the curve, its reference, and the grid of the leaner models.
GRIDS, FINEST, LEAN_GRID = (64, 128, 256, 512), 2048, 256
TURNS = 3
STEPS_PER_DX = 2
# Case 3: the ridge leaves at this time, a whole number of steps on all grids.
END_TIME = 101 * 5.5 / 256
# alpha that agrees with z and P0 of Case 1 [1/Pa].
ALPHA = 2.3345e-8
STIFFER = 200.0
NO_ROELANDS = {"roelands_z": None, "roelands_p0": None}
LEAN: dict[str, dict[str, dict]] = {
    "constant density": {"lubricant": {"density_law": "constant"}},
    "Barus": {"lubricant": {"viscosity_law": "barus", "pressure_viscosity": ALPHA} | NO_ROELANDS},
    "constant viscosity": {"lubricant": {"viscosity_law": "constant"} | NO_ROELANDS},
    "Newtonian": {"lubricant": {"rheology": None, "eyring_stress": None}},
    "smooth, steady": {"surface_2": dict.fromkeys(namelists.RIDGE), "time": {}},
    "200 x as stiff": {},
}
# Where the names of points stand that have no room on their right [points].
SHIFTS = {
    "constant density": (-6, -8),
    "Newtonian": (-6, -3),
    "Barus": (-6, 2),
    "constant viscosity": (-6, 1),
    "200 x as stiff": (-6, -6),
}


@dataclass
class ModelPanel:
    """Points (intervals or name, processor time [s], error), and what did not converge."""

    numbers: list[tuple[int, float, float]] = field(default_factory=list)
    models: list[tuple[str, float, float]] = field(default_factory=list)
    failures: list[Answer] = field(default_factory=list)


def passage_time(n: int) -> dict[str, object]:
    """The group &time on n intervals."""
    return {"transient": True, "end_time": END_TIME, "time_step": 5.5 / n / STEPS_PER_DX, "scheme": "bdf2"}


def passage(n: int, changes: dict[str, dict] | None = None) -> str:
    """The namelist of the full model, or with changes of its groups."""
    return namelists.case_1(n, None, **({"surface_2": namelists.RIDGE, "time": passage_time(n)} | (changes or {})))


def lean_namelist(name: str) -> str:
    """The namelist of a leaner model; with stiff bodies domain, places and times stay what they are [m, s]."""
    if "stiff" not in name:
        return passage(LEAN_GRID, LEAN[name])
    wider = STIFFER**0.5
    moduli = {key: STIFFER * namelists.CASE_1["bodies"][key] for key in ("youngs_modulus_1", "youngs_modulus_2")}
    window = {key: wider * value for key, value in namelists.WINDOW.items()}
    ridge = namelists.RIDGE | {"position": wider * namelists.RIDGE["position"]}
    time = {key: wider * value if key in ("end_time", "time_step") else value for key, value in passage_time(LEAN_GRID).items()}
    return passage(LEAN_GRID, {"bodies": moduli, "domain": window | {"intervals": LEAN_GRID}, "surface_2": ridge, "time": time})


def measure(quick: bool) -> ModelPanel:
    """Runs everything in turns."""
    grids = GRIDS[:-1] if quick else GRIDS
    finest = FINEST // 2 if quick else FINEST
    jobs: list[Job] = [job("reference", passage(finest))]
    for turn in range(1 if quick else TURNS):
        jobs += [job(f"full:{n}:{turn}", passage(n), runs=3) for n in grids]
        jobs += [job(f"lean:{i}:{turn}", lean_namelist(name), runs=3) for i, name in enumerate(LEAN)]
    answers = bench_program.run(jobs)
    panel = ModelPanel(failures=[answer for answer in answers.values() if not answer.converged])
    best = {}
    for name, answer in answers.items():
        key = name.rpartition(":")[0]
        if answer.converged and (key not in best or answer["processor"] < best[key]["processor"]):
            best[key] = answer
    reference, same_grid = answers["reference"], best.get(f"full:{LEAN_GRID}")
    if not reference.converged or same_grid is None:
        return panel
    for n in grids:
        if answer := best.get(f"full:{n}"):
            panel.numbers.append((n, answer["processor"], abs(answer["h_min"] / reference["h_min"] - 1)))
    for i, name in enumerate(LEAN):
        if answer := best.get(f"lean:{i}"):
            unit = 1 / STIFFER if "stiff" in name else 1.0  # b^2/R
            panel.models.append((name, answer["processor"], abs(unit * answer["h_min"] / same_grid["h_min"] - 1)))
    return panel


def save(panel: ModelPanel, path: Path) -> None:
    """All points as CSV."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("model", "intervals", "processor_seconds", "error"))
        writer.writerows(("full", n, cost, error) for n, cost, error in panel.numbers)
        writer.writerows((name, LEAN_GRID, cost, error) for name, cost, error in panel.models)


def draw(axes: Axes, panel: ModelPanel) -> None:
    """Both errors over the processor time."""
    numbers, models = panel.numbers, panel.models
    look = style.SERIES[0]
    axes.loglog(
        [1e3 * cost for _, cost, _ in numbers],
        [100 * error for *_, error in numbers],
        label="numbers, full model",
        **look,
    )
    marks = {"linestyle": "none", "marker": "*", "markersize": 8, "color": style.SERIES[1]["color"]}
    axes.loglog(
        [1e3 * cost for _, cost, _ in models],
        [100 * error for *_, error in models],
        label="model, one part left out",
        **marks,
    )
    for words, cost, error in [*numbers, *models]:
        axes.annotate(
            str(words),
            (1e3 * cost, 100 * error),
            xytext=SHIFTS.get(words, (5, 2)),
            ha="right" if words in SHIFTS else "left",
            textcoords="offset points",
            fontsize=7,
            path_effects=[withStroke(linewidth=1.5, foreground="white")],
        )
    axes.set(title=f"Models and numbers: ridge, Case 3 (models on {LEAN_GRID})", xlabel="Processor time [ms]")
    axes.set_ylabel("Error of the smallest film [%]")
    axes.title.set_fontsize(8.5)
    axes.legend(loc=(0.01, 0.3), fontsize=7.5)


def conclusions(panel: ModelPanel) -> str:
    """What the panel says, in words."""
    lines = ["Models and numbers: a ridge through Case 1 (error of the smallest film of all times; processor time)"]
    lines += [f"  full model, {n} intervals: {100 * error:.3g} %, {1e3 * cost:.3g} ms" for n, cost, error in panel.numbers]
    full = next((cost for n, cost, _ in panel.numbers if n == LEAN_GRID), None)
    for name, cost, error in panel.models:
        ratio = f", {cost / full:.2f} x the cost of the full model" if full else ""
        lines.append(f"  {name}, {LEAN_GRID} intervals: {100 * error:.3g} %, {1e3 * cost:.3g} ms{ratio}")
    lines += [f"  not converged: {answer['name']}: {answer['reason'].strip()}" for answer in panel.failures]
    return "\n".join(lines) + "\n"

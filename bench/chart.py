#!/usr/bin/env python3
"""Charts the error of each method against its wall time: steady, in time, heavily loaded.

The error is the true one, against the contact on at least four times the intervals of the finest grid shown (steady: with the
kappa scheme, whose error is smaller still), to a tolerance far below. Steady panels show the relative error of a quantity, of film
thickness the larger of h_min's and that of h at X = 0; the panel in time the largest error in P over all nodes and times. Times are
of one core, the least of many runs, without planning, input and output; nine tenths of the runs stay below the end of a bar. A star
is the setting of the thesis. Writes chart.png, .pdf, .csv and conclusion.txt from the same numbers.

--dry: dry_chart.png, .pdf and .csv, of a profile and an area. The error is that of the mean separation against a much finer grid
of the same surface (Fourier resampling); every solution has a violation of the contact conditions of at most 1e-6 and at most 3000
iterations. Time is processor time. --peers PYTHON also solves the area by other programs (dry_areas.py), each with the loosest
of a ladder of tolerances that reaches 1e-6.
"""

from __future__ import annotations

import itertools
import math
import sys
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import bench_program
import dry_areas
import h5py
import namelists
import numpy as np
import pandas as pd
from bench_program import Answer, conclude, new_parser, run_program, save, show, solve
from family_dry import PROBLEMS, height_file, heights, sizes
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter
from namelists import BARE, namelist

import figure_style as style  # isort: skip

FAS = "fas_block_jacobi"
METHODS: dict[str, dict[str, object]] = {
    "auto": {},
    "newton_krylov": {"method": "newton_krylov"},
    "FAS, line": {"method": FAS, "smoother": "line"},
    "FAS, Gauss-Seidel": {"method": FAS, "smoother": "gauss_seidel"},
    "FAS, Block-Jacobi": {"method": FAS, "smoother": "block_jacobi"},
    "newton_dense": {"method": "newton_dense"},
    "block_jacobi": {"method": "block_jacobi"},
}
# The other space scheme, in the steady panels.
KAPPA, KAPPA_SCHEME = "auto, kappa scheme", {"space_scheme": "kappa"}
# The thesis: Block-Jacobi V-cycles from the pressure of Hertz on 1024 intervals; in time backward Euler. It prints neither sweeps,
# relaxation nor tolerance: these are ours.
THESIS, THESIS_GRID = "thesis's setting", 1024
THESIS_SOLVER = METHODS["FAS, Block-Jacobi"] | {"pre_sweeps": 10, "post_sweeps": 10, "relaxation": 0.7, "start": "hertz"}
# The default as a user calls it; with the limits that the same run writes; for a wanted accuracy; with the other time scheme.
WHOLE, LIMITS, GRADED, EULER = "auto, whole program", "auto, extrapolated", "graded, target given", "auto, backward Euler"
LOOKS = {
    **dict(zip(("auto", *list(METHODS)[2:]), style.SERIES, strict=False)),
    LIMITS: {"color": "#d99a00", "linestyle": (0, (1, 0.6)), "marker": "o", "markersize": 4, "markerfacecolor": "white"},
    KAPPA: {"color": "#008080", "linestyle": "-", "linewidth": 1.2, "marker": "d", "markersize": 4.5},
    GRADED: {"color": "#7b2d8e", "linestyle": "-", "marker": "D", "markersize": 4},
    EULER: {"color": "#d02060", "linestyle": "-", "marker": "P", "markersize": 5},
    THESIS: {"color": "black", "linestyle": "none", "marker": "*", "markersize": 11, "markerfacecolor": "#ffd700", "zorder": 5},
}
# Of dry contacts: a mark is the fastest of so many runs; length [m], mean pressure, E' [Pa] of the area, nodes of its first grid.
RUNS = 5
LENGTH, PRESSURE, MODULUS, FIRST = 1e-3, 300e6, 200e9, 64
NODES = {
    ("profile", "conjugate_gradient"): (256, 512, 1024, 2048, 4096, 8192, 16384),
    ("profile", "steepest_descent"): (256, 512, 1024, 2048),
    ("area", "conjugate_gradient"): (64, 128, 256, 512, 1024),
    ("area", "steepest_descent"): (64, 128, 256),
}
FINEST = {"profile": 65536, "area": 2048}
DRY_PANELS = {"profile": ("Profile C", "mean separation"), "area": ("Rough area", "mean separation")}
LOOKS |= dict(zip(("conjugate_gradient", "steepest_descent", *dry_areas.PEERS), style.SERIES, strict=False))
# Nothing larger is tried: their cost grows with the cube and faster.
LARGEST = {"newton_dense": 1024, "block_jacobi": 128}
# No line smoother in time: it diverges with the squeeze term.
IN_TIME = ("auto", "newton_krylov", "FAS, Gauss-Seidel", "FAS, Block-Jacobi", "newton_dense")
# Errors of the conclusions; wanted accuracies (&accuracy target) for which the program chooses the grid.
TARGETS, WANTED = (1e-1, 1e-2, 1e-3, 1e-4), (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
FILMS, FRICTION = ["h_min", "h_central"], "friction_coefficient"
HEAVY = (100, 10)
SHORT_WINDOW = 0.55
# Not drawn: what lies on the default, is far slower or has the errors of the default; conclusion.txt has them.
HIDDEN = ("newton_krylov", "block_jacobi", WHOLE)
# Curves with the numbers of intervals.
NUMBERED = ("auto", GRADED, "conjugate_gradient")
# In time there are grids of 5/4 of each power of two besides: the reference has all their nodes, and steps are whole numbers.
REFERENCE_FACTOR, STEP_UNIT = 5, 4
COLUMNS = ("cycles", "steps", "residual", "fft_pairs", "work_units", *FILMS, "p_max", FRICTION)
CASE_1 = "Steady: Case 1 (Eyring)"
# Title of each panel, its measure of error, and quantities.
PANELS: dict[str, tuple[str, str, list[str]]] = {
    "steady": (CASE_1, "film thickness", FILMS),
    "steady_pressure": (CASE_1, "largest pressure", ["p_max"]),
    "steady_friction": (CASE_1, "friction", [FRICTION]),
    "transient": ("In time: ridge, Case 3", "pressure", FILMS),
    "heavy": (f"Heavily loaded: Barus, M {HEAVY[0]}, L {HEAVY[1]}", "film thickness", FILMS),
}


def new_point(panel: str, method: str, answer: Answer, error: float, times: pd.DataFrame) -> dict[str, object]:
    """A row of chart.csv."""
    own = times[["steady", "transient", "error_bars"]].sum(axis=1)
    clock = {"seconds": own.min(), "seconds_high": own.quantile(0.9), "error": error}
    head = {"panel": panel, "method": method, "intervals": int(answer["intervals"])} | clock | {"way": answer["method"]}
    return head | {name: answer.get(name, math.nan) for name in COLUMNS} | {"runs": len(times)}


def error_of(panel: str, values: dict[str, float], reference: dict[str, float]) -> float:
    """The largest one of the relative errors of the quantities of a panel."""
    return max(abs(values[name] / reference[name] - 1) for name in PANELS[panel][2])


def steady_points(panels: list[str], text: partial, sizes: list[int], effort: dict[str, float]) -> tuple[list[dict], list[str]]:
    """Solves a steady contact by all methods, for panels of its quantities, and which runs failed; `text` is its namelist."""
    tight = {"method": "newton_krylov", "tolerance": 1e-12} | KAPPA_SCHEME
    found = {("reference", 4 * sizes[-1]): solve(text(4 * sizes[-1], tight, **BARE))}
    for method, n in itertools.product((*METHODS, KAPPA), sizes):
        if n <= LARGEST.get(method, n):
            found[method, n] = solve(text(n, METHODS.get(method, KAPPA_SCHEME), **BARE), **effort)
    for target in WANTED:
        found[GRADED, target] = solve(text(None, {}, accuracy={"target": target}, output=BARE["output"]), **effort)
    if panels[0] == "steady":  # the thesis's contact
        found[THESIS, THESIS_GRID] = solve(text(THESIS_GRID, THESIS_SOLVER, **BARE), **effort)
    (_, reference), *others = found.items()
    good = [(method, answer) for (method, _), answer in others if answer.converged]
    points = [new_point(panel, m, a, error_of(panel, a, reference), a.times) for panel in panels for m, a in good]
    default = {n: found["auto", n] for n in sizes if found["auto", n].converged}
    for n in list(default)[2:]:
        limits = solve(text(n, {}, output=BARE["output"]), **effort)
        values = {name.removesuffix("_extrapolated"): value for name, value in limits.items()}
        known = [p for p in panels if all(f"{name}_extrapolated" in limits for name in PANELS[p][2])]
        points += [new_point(p, LIMITS, limits, error_of(p, values, reference), limits.times) for p in known]
    points += whole_program(panels[0], points, {n: text(n, {}) for n in sizes}, effort)
    return points, [f"{m}:{n}: {a['reason'].strip()}" for (m, n), a in found.items() if not a.converged]


def whole_program(panel: str, points: list[dict], texts: dict[int, str], effort: dict[str, float]) -> list[dict]:
    """The default on the same grids as a user calls it: the error of the default, the time of the process."""
    found = []
    for plain in (point for point in points if (point["panel"], point["method"]) == (panel, "auto")):
        used: list[float] = []
        while plain["intervals"] in texts and len(used) < effort["runs"] and sum(used) < effort["seconds"]:
            used.append(run_program(texts[plain["intervals"]]).wall)
        if used:
            times = {"seconds": min(used), "seconds_high": np.quantile(used, 0.9)}
            found.append(plain | {"method": WHOLE} | times)
    return found


def pressures(file: h5py.File) -> Answer:
    """With P of all nodes and times, and the largest residual of all steps."""
    own = {"pressure": file["transient/pressure"][()], "residual": file["transient/residual"][1:].max()}
    return Answer(bench_program.answer(file) | own)


def largest_difference(one: np.ndarray, other: np.ndarray) -> float:
    """At the nodes and times that both have: of every grid the nodes and times of one contain those of the other."""
    for axis in (0, 1):
        least = min(each.shape[axis] for each in (one, other)) - 1
        one, other = (each.take(range(0, each.shape[axis], (each.shape[axis] - 1) // least), axis) for each in (one, other))
    return float(np.abs(one - other).max())


def transient_points(panel: str, sizes: list[int], effort: dict[str, float]) -> tuple[list[dict], list[str]]:
    """A ridge enters the contact of Case 1 on the fast surface; time steps dX/2. The largest grid is a power of two."""

    def text(n: int, solver: dict, time: dict, **others: dict) -> str:
        steps = STEP_UNIT * round(SHORT_WINDOW / (5.5 / sizes[0] / 2) / STEP_UNIT) * n // sizes[0]
        settings = {"transient": True, "end_time": steps * 2.75 / n, "time_step": 2.75 / n} | time
        return namelists.case_1(n, solver, surface_2=namelists.RIDGE | {"position": -1.5}, time=settings, **others)

    euler = {"scheme": "backward_euler"}
    methods = {name: (METHODS[name], {}) for name in IN_TIME} | {EULER: ({}, euler), THESIS: (THESIS_SOLVER, euler)}
    largest, thesis_grid = LARGEST | {"newton_dense": 256}, min(THESIS_GRID, sizes[-1])
    every = [(m, n) for m in methods for n in sizes if n <= largest.get(m, n) and (m != THESIS or n == thesis_grid)]
    stored = BARE | {"output": {"adequacy": False, "profile_stride": 1}}
    reference = solve(
        text(REFERENCE_FACTOR * sizes[-1], METHODS["newton_krylov"] | {"tolerance": 1e-8}, {}, **stored), read=pressures
    )
    found = {(m, n): solve(text(n, *methods[m], **stored), read=pressures, **effort) for m, n in every}
    errors = {key: largest_difference(a["pressure"], reference["pressure"]) for key, a in found.items() if a.converged}
    points = [new_point(panel, key[0], found[key], error, found[key].times) for key, error in errors.items()]
    points += whole_program(panel, points, {n: text(n, {}, {}) for n in sizes if n & (n - 1) == 0}, effort)
    return points, [f"{m}:{n}: {a['reason']}" for (m, n), a in found.items() if not a.converged]


def dry_points(folder: Path, quick: bool, peers: str | None) -> Iterator[dict[str, object]]:
    """Of each method on each grid: processor seconds of the fastest and the slowest run, error of the mean separation.

    The profile is C, harmonics 1 to 64, elastic at a mean pressure of 1 GPa; the area is elastic, about 10 % in contact, with
    waves from an eighth to a twenty-fourth of the length.
    """
    profile = dry_areas.profile_case("C", 1e9, harmonics=64)
    waves = {"wavelength_rolloff": 1.25e-4, "wavelength_short": 1e-3 / 24}
    surface = {"shape": "synthetic", "seed": 1, "rms_height": 1e-6} | waves
    area = {"case": {"problem": PROBLEMS[1]}, "bodies": {"reduced_modulus": MODULUS}, "load": {"mean_pressure": PRESSURE}}
    first = namelist(area | {"surface_1": surface, "domain": sizes(2, FIRST, LENGTH)})
    z = run_program(first, lambda file: file["solution/height_undeformed"][()]).found
    path = folder / "area.h5"
    path.write_bytes(height_file(z, [LENGTH / FIRST] * 2))
    grids = {key: nodes[:2] for key, nodes in NODES.items()} if quick else NODES
    area["surface_1"] = {"shape": "file", "file": str(path.resolve()), "dataset": "z"}

    def solved(kind: str, method: str, nodes: int, tolerance: float) -> list[Answer]:
        case, domain = (profile, {"intervals": nodes}) if kind == "profile" else (area, sizes(2, nodes, LENGTH))
        case = case | BARE | {"domain": domain, "solver": {"method": method, "tolerance": tolerance, "max_cycles": 3000}}
        return sorted((solve(namelist(case)) for _ in range(RUNS)), key=lambda answer: answer["cpu_seconds"])

    finest = {"profile": 4096, "area": 256} if quick else FINEST
    best = {kind: solved(kind, "conjugate_gradient", nodes, 1e-8)[0]["mean_separation"] for kind, nodes in finest.items()}
    for (kind, method), nodes in ((key, nodes) for key, every in grids.items() for nodes in every):
        first, *_, last = solved(kind, method, nodes, 1e-6)
        head = {"panel": kind, "method": method, "intervals": nodes, "iterations": first["cycles"], "pairs": first["fft_pairs"]}
        times = {"seconds": first["cpu_seconds"], "seconds_high": last["cpu_seconds"], "kkt": first["kkt"]}
        yield head | times | {"converged": first.converged, "error": abs(first["mean_separation"] / best[kind] - 1)}
    # the area by other programs, resampled as ours does it; a grid on which one fails is left out
    for peer, nodes in itertools.product(dry_areas.PEERS if peers else (), grids["area", "conjugate_gradient"]):
        fine = heights(np.fft.fft2(z) / z.size, nodes) / LENGTH
        runs = dry_areas.peer_runs(peer, peers, dry_areas.Contact(fine, PRESSURE / (0.5 * MODULUS)))
        runs = sorted((run for run in runs if run.error <= 2 * dry_areas.WANTED), key=lambda run: run.seconds)
        if runs:
            head = {"panel": "area", "method": peer, "intervals": nodes, "kkt": runs[0].error, "converged": True}
            times = {"seconds": runs[0].seconds, "seconds_high": runs[-1].seconds}
            yield head | times | {"error": abs(runs[0].separation * LENGTH / best["area"] - 1)}


def fastest(points: pd.DataFrame, target: float) -> pd.DataFrame:
    """Of each method the quickest run whose error is within the target."""
    good = points[points["error"] <= target]
    return good.loc[good.groupby("method")["seconds"].idxmin()].set_index("method")


def conclusions(points: pd.DataFrame, failures: list[str]) -> str:
    """What the numbers say, made from nothing else."""
    lines = []
    for panel, own in points.groupby("panel", sort=False):
        lines.append(f"{PANELS[panel][0]}: least wall time [ms] for an error of {PANELS[panel][1]} [%], with the intervals")
        lines.append(f"  {'method':22s}" + "".join(f"{100 * target:>15g}" for target in TARGETS))
        curves, besides = own[~own["method"].isin((THESIS, WHOLE))], own.set_index("method")
        best = [fastest(curves, target) for target in TARGETS]
        # Further quantities of a contact: only methods that differ in the discretisation.
        for method in dict.fromkeys(curves["method"]) if WHOLE in besides.index else ("auto", KAPPA, GRADED, LIMITS):
            cells = [each.loc[method] if method in each.index else None for each in best]
            words = ("-" if p is None else f"{1e3 * p['seconds']:.3g} ({p['intervals']})" for p in cells)
            lines.append(f"  {method:22s}" + "".join(f"{word:>15s}" for word in words))
        if THESIS in besides.index and WHOLE in besides.index:
            star = besides.loc[THESIS]
            error = f"error {100 * star['error']:.3g} %, {show(star['seconds'])}"
            lines.append(f"  the thesis's setting ({star['intervals']} intervals): {error}")
            if "auto" in (default := fastest(curves, star["error"])).index:
                ratio = f"{star['seconds'] / default.loc['auto', 'seconds']:.3g} x the default"
                lines[-1] += f", {ratio} of at most this error ({default.loc['auto', 'intervals']} intervals)"
        if WHOLE in besides.index:
            whole = besides.loc[[WHOLE]].iloc[[0, -1]]
            first, last = (f"{show(s)} on {n}" for s, n in zip(whole["seconds"], whole["intervals"], strict=True))
            lines.append(f"  the whole program takes {first} and {last} intervals")
    lines += [f"Not converged, not shown: {failure}" for failure in failures]
    return "\n".join(lines) + "\n"


def draw_panel(axes: Axes, title: str, measure: str, points: pd.DataFrame) -> None:
    """The curves of one contact; thin bars are the spread of the times, numbers the intervals."""
    for method, own in points[~points["method"].isin(HIDDEN)].groupby("method", sort=False):
        times, errors = 1e3 * own["seconds"], 100 * own["error"]
        axes.loglog(times, errors, label=method.replace("_", " "), **LOOKS[method])
        axes.hlines(errors, times, 1e3 * own["seconds_high"], color=LOOKS[method]["color"], linewidth=0.6)
        for at in zip(times, errors, own["intervals"], strict=True) if method in NUMBERED else ():
            look = {"fontsize": 7, "textcoords": "offset points", "path_effects": [withStroke(linewidth=1.5, foreground="white")]}
            axes.annotate(str(at[2]), at[:2], xytext=(4, 2), **look)
    axes.set(title=title, xlabel="Time [ms]", ylabel=f"Error of {measure} [%]")
    axes.title.set_fontsize(8.5)
    axes.grid(which="major", color="0.9", linewidth=0.5)
    axes.margins(x=0.16, y=0.1)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(10, numticks=12))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def draw(points: pd.DataFrame, panels: dict[str, tuple], height: float, path: Path) -> None:
    """The figure of all panels; a place that is left has the legend."""
    figure, grid = style.new_figure(style.TWO_COLUMNS, height, nrows=(len(panels) + 1) // 2, ncols=2)
    handles = {}
    for axes, (panel, (title, measure, *_)) in zip(grid.flat, panels.items(), strict=False):
        draw_panel(axes, title, measure, points[points["panel"] == panel])
        handles |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    if len(panels) % 2:
        grid.flat[-1].set_axis_off()
        grid.flat[-1].legend(handles=list(handles.values()), loc="center")
    else:
        style.legend_below(figure, list(handles.values()), len(handles))
    style.save_figure(figure, [path.with_suffix(".png"), path.with_suffix(".pdf")])


def grids(first: int, last: int) -> list[int]:
    """Powers of two from first to last."""
    return [2**k for k in range(first.bit_length() - 1, last.bit_length())]


def main() -> None:
    """Command line."""
    parser = new_parser(__doc__, "coarser grids and fewer runs, under 3 minutes", "results/chart")
    parser.add_argument("--dry", action="store_true", help="dry contacts")
    parser.add_argument("--peers", metavar="PYTHON", help="python of an environment with other programs")
    options = parser.parse_args()
    folder, quick = options.output, options.quick
    if options.dry:
        points = pd.DataFrame(dry_points(folder, quick, options.peers))
        save(folder / "dry_chart.csv", points)
        print(points.to_string(index=False))
        draw(points, DRY_PANELS, 80, folder / "dry_chart")
        return
    effort = {"runs": 15 if quick else 101, "seconds": 0.5 if quick else 1}
    last = 256 if quick else 1024
    between = [5 * n // 4 for n in grids(64, last // 2)]
    steady, in_time, heavy = list(PANELS)[:3], "transient", ["heavy"]
    heavy_text = partial(namelists.moes, *HEAVY, domain=namelists.WINDOW)
    parts = [
        steady_points(steady, namelists.case_1, grids(32, 1024 if quick else 4096), effort),
        transient_points(in_time, sorted(grids(64, last) + between), effort | {"runs": 3 if quick else 21}),
        steady_points(heavy, heavy_text, grids(128, 2048 if quick else 8192), effort),
    ]
    points = pd.DataFrame([point for part, _ in parts for point in part])
    save(folder / "chart.csv", points)
    draw(points, PANELS, 245, folder / "chart")
    conclude(folder / "conclusion.txt", conclusions(points, [failure for _, failures in parts for failure in failures]))


if __name__ == "__main__":
    sys.exit(main())

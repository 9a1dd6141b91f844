#!/usr/bin/env python3
"""Charts the error of each method against its wall time: steady, in time, heavily loaded.

The error is the true one, against the contact on at least four times the intervals of the finest grid shown (steady: with the
kappa scheme, whose error is smaller still), to a tolerance far below. Steady panels show the relative error of a quantity, of film
thickness the larger of h_min's and that of h at X = 0; the panel in time the largest error in P over all nodes and times. Times are
of one core, the least of many runs, without planning, input and output; nine tenths of the runs stay below the end of a bar. A star
is the setting of the thesis. Writes chart.png, .pdf, .csv and conclusion.txt from the same numbers.
"""

from __future__ import annotations

import itertools
import math
import sys
import tempfile
from dataclasses import dataclass, field, replace
from pathlib import Path

import bench_program
import namelists
import numpy as np
from bench_program import ASPERITY, Answer, Job, conclude, job, measured, new_parser, output_folder, write_csv
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

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
# Nothing larger is tried: their cost grows with the cube and faster.
LARGEST = {"newton_dense": 1024, "block_jacobi": 128}
# No line smoother in time: it diverges with the squeeze term.
IN_TIME = ("auto", "newton_krylov", "FAS, Gauss-Seidel", "FAS, Block-Jacobi", "newton_dense")
# Errors of the conclusions; wanted accuracies (&accuracy target) for which the program chooses the grid.
TARGETS, WANTED = (1e-1, 1e-2, 1e-3, 1e-4), (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5)
FILMS, FRICTION = ("h_min", "h_central"), "friction_coefficient"
HEAVY = (100, 10)
SHORT_WINDOW = 0.55
# In time, where the curves lie closest, the methods take turns on each grid.
TURNS = 3
# Not drawn: what lies on the default, is far slower or has the errors of the default; conclusion.txt has them.
HIDDEN = ("newton_krylov", "block_jacobi", WHOLE)
# In time there are grids of 5/4 of each power of two besides: the reference has all their nodes, and steps are whole numbers.
REFERENCE_FACTOR, STEP_UNIT = 5, 4
COLUMNS = ("cycles", "steps", "residual", "fft_pairs", "work_units", "runs", "setup_median", *FILMS, "p_max", FRICTION)


@dataclass
class Point:
    """One method on one grid; nine tenths of the runs stay below `high` [s]."""

    method: str
    intervals: int
    seconds: float
    error: float
    answer: Answer
    high: float


@dataclass
class Panel:
    """One contact: its name, the measure of error and its quantities, and the points by method; `besides` are not compared."""

    key: str
    title: str
    measure: str
    names: tuple[str, ...] = FILMS
    curves: dict[str, list[Point]] = field(default_factory=dict)
    besides: dict[str, list[Point]] = field(default_factory=dict)


def run_time(answer: Answer) -> float:
    """Least wall time without planning; the mean processor time where other programs on the machine made that smaller."""
    return min(answer["steady_least"] + answer["transient_least"], answer["processor"])


def new_point(method: str, intervals: int, answer: Answer, error: float, timed: Answer | None = None) -> Point:
    """The point of a run, at the time of it or of another one."""
    timed = timed or answer
    seconds = run_time(timed)
    return Point(method, intervals, seconds, error, answer, max(timed["steady_high"] + timed["transient_high"], seconds))


def error_of(names: tuple[str, ...], values: dict[str, float], reference: dict[str, float]) -> float:
    """The largest one of the relative errors of these quantities."""
    return max(abs(values[name] / reference[name] - 1) for name in names)


def steady_panels(panels: list[Panel], text: object, sizes: list[int], effort: dict[str, float]) -> list[Answer]:
    """Solves a steady contact by all methods, for panels of its quantities; `text(intervals, solver, accuracy)` is its namelist."""
    finest = 4 * sizes[-1]
    jobs: list[Job] = [job("reference", text(finest, {"method": "newton_krylov", "tolerance": 1e-12} | KAPPA_SCHEME))]
    every = [(m, n) for m in METHODS | {KAPPA: None} for n in sizes if n <= LARGEST.get(m, n)]
    jobs += [job(f"{method}:{n}", text(n, METHODS.get(method, KAPPA_SCHEME)), **effort) for method, n in every]
    jobs += [job(f"bars:{n}", text(n, {}), bars=1, **effort) for n in sizes[2:]]
    jobs += [job(f"target:{target:g}", text(None, {}, {"target": target}), **effort) for target in WANTED]
    if panels[0].key == "steady":  # the thesis's contact
        jobs.append(job("thesis", text(THESIS_GRID, THESIS_SOLVER), **effort))
    answers = bench_program.run(jobs)
    reference = answers["reference"]

    for panel in panels:
        every_key = [(panel.curves, method, f"{method}:{n}") for method, n in every]
        every_key += [(panel.curves, GRADED, f"target:{target:g}") for target in WANTED]
        for curves, method, key in (*every_key, (panel.besides, THESIS, "thesis")):
            answer = answers.get(key.replace(" ", "_"))
            if answer and answer.converged:
                error = error_of(panel.names, answer, reference)
                curves.setdefault(method, []).append(new_point(method, int(answer["intervals"]), answer, error))
        add_limits(panel, answers, reference)
    add_whole_program(panels[0], {n: text(n, {}) for n in sizes}, effort)
    return [answer for answer in answers.values() if not answer.converged]


def add_whole_program(panel: Panel, texts: dict[int, str], effort: dict[str, float]) -> None:
    """The default on the same grids as a user calls it: the error of the default, the time of the process."""
    points = panel.besides[WHOLE] = []
    for plain in (point for point in panel.curves.get("auto", []) if point.intervals in texts):
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "case.nml"
            path.write_text(texts[plain.intervals], encoding="utf-8")
            used: list[float] = []
            while len(used) < effort["runs"] and sum(used) < effort["seconds"]:
                run = measured([ASPERITY, path, "--output", name, "--quiet"])
                used.append(run.wall)
                if run.status != 0:
                    break
            else:
                points.append(replace(plain, method=WHOLE, seconds=min(used), high=float(np.quantile(used, 0.9))))


def add_limits(panel: Panel, answers: dict[str, Answer], reference: Answer) -> None:
    """The default on n, n/2 and n/4 intervals, extrapolated with the observed order between 1 and 2, as in /summary.

    The time is that of the run with error bars, which passes the coarser grids on its way.
    """
    points = panel.curves.get("auto", [])
    for quarter, half, full in zip(points, points[1:], points[2:], strict=False):
        values = {}
        for name in panel.names:
            q1, q2, q4 = (point.answer[name] for point in (full, half, quarter))
            order = min(max(math.log2(abs((q2 - q4) / (q1 - q2))), 1.0), 2.0)
            values[name] = q1 + (q1 - q2) / (2**order - 1)
        n, error = full.intervals, error_of(panel.names, values, reference)
        panel.curves.setdefault(LIMITS, []).append(new_point(LIMITS, n, full.answer, error, answers[f"bars:{n}"]))


def transient_panel(panel: Panel, sizes: list[int], effort: dict[str, float]) -> list[Answer]:
    """A ridge enters the contact of Case 1 on the fast surface; time steps dX/2. The largest grid is a power of two."""

    def text(n: int, solver: dict, time: dict) -> str:
        steps = STEP_UNIT * round(SHORT_WINDOW / (5.5 / sizes[0] / 2) / STEP_UNIT) * n // sizes[0]
        settings = {"transient": True, "end_time": steps * 2.75 / n, "time_step": 2.75 / n} | time
        return namelists.case_1(n, solver, surface_2=namelists.RIDGE | {"position": -1.5}, time=settings)

    euler = {"scheme": "backward_euler"}
    methods = {name: (METHODS[name], {}) for name in IN_TIME} | {EULER: ({}, euler), THESIS: (THESIS_SOLVER, euler)}
    largest = LARGEST | {"newton_dense": 256}
    every = [(THESIS, min(THESIS_GRID, sizes[-1]), 0)]
    for n in sizes:
        own = [method for method in methods if method != THESIS and n <= largest.get(method, n)]
        every += [(method, n, turn) for turn, method in itertools.product(range(TURNS), own)]
    finest = REFERENCE_FACTOR * sizes[-1]
    jobs = [job("reference", text(finest, {"method": "newton_krylov", "tolerance": 1e-8}, {}), reference=1)]
    jobs += [job(f"{method}:{n}:{turn}", text(n, *methods[method]), compare=1, **effort) for method, n, turn in every]
    answers = bench_program.run(jobs)
    failures = [] if answers["reference"].converged else [answers["reference"]]
    for method, n in dict.fromkeys((method, n) for method, n, _ in every):
        turns = [answers[f"{method}:{n}:{turn}".replace(" ", "_")] for m, k, turn in every if (m, k) == (method, n)]
        points = [new_point(method, n, answer, answer["difference"]) for answer in turns if answer.converged]
        if points:
            best = min(points, key=lambda point: point.seconds)
            best.high = max(point.high for point in points)
            (panel.besides if method == THESIS else panel.curves).setdefault(method, []).append(best)
        else:
            failures.append(turns[0])
    add_whole_program(panel, {n: text(n, {}, {}) for n in sizes if n & (n - 1) == 0}, effort)
    return failures


def fastest(panel: Panel, target: float) -> dict[str, Point]:
    """Of each method the quickest run whose error is within the target."""
    good = {method: [point for point in points if point.error <= target] for method, points in panel.curves.items()}
    return {method: min(points, key=lambda point: point.seconds) for method, points in good.items() if points}


def show_time(seconds: float) -> str:
    """Seconds or milliseconds with three digits."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{seconds * 1e3:.3g} ms"


def conclusions(panels: list[Panel], failures: list[Answer]) -> str:
    """What the numbers say, made from nothing else."""
    lines = []
    for panel in panels:
        lines.append(f"{panel.title}: least wall time [ms] for an error of {panel.measure} [%], with the intervals")
        lines.append(f"  {'method':22s}" + "".join(f"{100 * target:>15g}" for target in TARGETS))
        best = [fastest(panel, target) for target in TARGETS]
        # Further quantities of a contact: only methods that differ in the discretisation.
        is_further = WHOLE not in panel.besides
        for method in ("auto", KAPPA, GRADED, LIMITS) if is_further else panel.curves:
            points = [each.get(method) for each in best]
            cells = (f"{f'{1e3 * p.seconds:.3g} ({p.intervals})' if p else '-':>15s}" for p in points)
            lines.append(f"  {method:22s}{''.join(cells)}")
        lines += [] if is_further else besides(panel)
    lines += [f"Not converged, not shown: {answer['name']}: {answer['reason'].strip()}" for answer in failures]
    return "\n".join(lines) + "\n"


def besides(panel: Panel) -> list[str]:
    """The thesis's setting beside the default of at most its error, the whole program beside the solution."""
    lines = []
    for point in panel.besides.get(THESIS, []):
        error = f"error {100 * point.error:.3g} %, {show_time(point.seconds)}"
        lines.append(f"  the thesis's setting ({point.intervals} intervals): {error}")
        if default := fastest(panel, point.error).get("auto"):
            ratio = f"{point.seconds / default.seconds:.3g} x the default"
            lines[-1] += f", {ratio} of at most this error ({default.intervals} intervals)"
    if whole := panel.besides.get(WHOLE, []):
        first, last = (f"{show_time(point.seconds)} on {point.intervals}" for point in (whole[0], whole[-1]))
        lines.append(f"  the whole program takes {first} and {last} intervals")
    return lines


def draw_panel(axes: Axes, panel: Panel) -> None:
    """The curves of one contact; thin bars are the spread of the times, numbers the intervals."""
    for method, points in (item for item in (panel.curves | panel.besides).items() if item[0] not in HIDDEN):
        times, errors = [p.seconds * 1e3 for p in points], [100 * p.error for p in points]
        axes.loglog(times, errors, label=method, **LOOKS[method])
        axes.hlines(errors, times, [p.high * 1e3 for p in points], color=LOOKS[method]["color"], linewidth=0.6)
        for point in points if method in ("auto", GRADED) else ():
            look = {"fontsize": 7, "textcoords": "offset points", "path_effects": [withStroke(linewidth=1.5, foreground="white")]}
            axes.annotate(str(point.intervals), (point.seconds * 1e3, 100 * point.error), xytext=(4, 2), **look)
    axes.set(title=panel.title, xlabel="Wall time [ms]", ylabel=f"Error of {panel.measure} [%]")


def draw(panels: list[Panel], folder: Path) -> None:
    """The figure of all panels; the last place has the legend."""
    figure, grid = style.new_figure(style.TWO_COLUMNS, 245, nrows=3, ncols=2)
    handles = {}
    for axes, panel in zip(grid.flat, panels, strict=False):
        draw_panel(axes, panel)
        handles |= {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    grid.flat[-1].set_axis_off()
    grid.flat[-1].legend(handles=list(handles.values()), loc="center")
    for axes in grid.flat[:-1]:
        axes.title.set_fontsize(8.5)
        axes.grid(which="major", color="0.9", linewidth=0.5)
        axes.margins(x=0.16, y=0.1)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(LogLocator(10, numticks=12))
            axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axis.set_minor_formatter(NullFormatter())
    style.save_figure(figure, [folder / "chart.png", folder / "chart.pdf"])


def save(panels: list[Panel], path: Path) -> None:
    """All points as CSV."""
    rows = []
    for panel in panels:
        for point in (point for points in (panel.curves | panel.besides).values() for point in points):
            answer = point.answer
            times = (point.seconds, answer["steady_least"] + answer["transient_least"], point.high)
            own = (panel.key, point.method, point.intervals, *times, point.error, answer["method"])
            rows.append((*own, *(answer[column] for column in COLUMNS)))
    head = ("panel", "method", "intervals", "seconds", "seconds_least", "seconds_high", "error", "way", *COLUMNS)
    write_csv(path, head, rows)


def grids(first: int, last: int) -> list[int]:
    """Powers of two from first to last."""
    return [2**k for k in range(int(math.log2(first)), int(math.log2(last)) + 1)]


def main() -> int:
    """Command line."""
    options = new_parser(__doc__, "coarser grids and fewer runs, under 3 minutes", "results/chart").parse_args()
    folder, quick = output_folder(options), options.quick
    effort = {"runs": 15 if quick else 101, "seconds": 0.5 if quick else 1}
    panels = [
        Panel("steady", "Steady: Case 1 (Eyring)", "film thickness"),
        Panel("steady_pressure", "Steady: Case 1 (Eyring)", "largest pressure", ("p_max",)),
        Panel("steady_friction", "Steady: Case 1 (Eyring)", "friction", (FRICTION,)),
        Panel("transient", "In time: ridge, Case 3", "pressure"),
        Panel("heavy", f"Heavily loaded: Barus, M {HEAVY[0]}, L {HEAVY[1]}", "film thickness"),
    ]

    def case_1(n: int | None, solver: dict, accuracy: dict | None = None) -> str:
        return namelists.case_1(n, solver, accuracy=accuracy or {})

    def heavy(n: int | None, solver: dict, accuracy: dict | None = None) -> str:
        return namelists.moes(*HEAVY, n, solver, domain=namelists.WINDOW, accuracy=accuracy or {})

    last = 256 if quick else 1024
    between = [5 * n // 4 for n in grids(64, last // 2)]
    failures = steady_panels(panels[:3], case_1, grids(32, 1024 if quick else 4096), effort)
    failures += transient_panel(panels[3], sorted(grids(64, last) + between), effort | {"runs": 3 if quick else 21})
    failures += steady_panels(panels[4:], heavy, grids(128, 2048 if quick else 8192), effort)
    save(panels, folder / "chart.csv")
    draw(panels, folder)
    conclude(folder / "conclusion.txt", conclusions(panels, failures))
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Charts the error of every method over its wall time: steady, in time, heavily loaded.

The error is the true one, against the contact on at least four times the intervals of the finest grid shown (steady ones
with the kappa space scheme, whose error is smaller still), to a tolerance far below. Steady panels: the larger one of the
relative errors of h_min and h at X = 0. In time: the largest error in P over all nodes and times. The last panel has the error of
leaner models beside that of the numbers (bench/chart_models.py). Times are of one core, the
least of many runs, without planning, input and output; a bar reaches to what nine tenths of the runs stay below. A star is the
thesis's own setting; a dotted line the whole program, start-up, error bars and output too. Each run writes chart.png, .pdf,
chart.csv and conclusion.txt, which is made from the same numbers.
"""

from __future__ import annotations

import csv
import itertools
import math
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

import bench_program
import chart_models
import chart_program
import namelists
from bench_program import ROOT, Answer, Job, job, new_parser, output_folder

sys.path.append(str(ROOT / "postproc"))

import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke
from matplotlib.text import Annotation
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

METHODS: dict[str, dict[str, object]] = {
    "auto": {},
    "newton_krylov": {"method": "newton_krylov"},
    "FAS, line": {"method": "fas_block_jacobi", "smoother": "line"},
    "FAS, Gauss-Seidel": {"method": "fas_block_jacobi", "smoother": "gauss_seidel"},
    "FAS, Block-Jacobi": {"method": "fas_block_jacobi", "smoother": "block_jacobi"},
    "newton_dense": {"method": "newton_dense"},
    "block_jacobi": {"method": "block_jacobi"},
}
# The other space scheme, in the steady panels.
KAPPA = "auto, kappa scheme"
KAPPA_SCHEME = {"space_scheme": "kappa"}
# The thesis: Block-Jacobi V-cycles from the pressure of Hertz on 1024 intervals; in time backward Euler. It prints neither sweeps,
# relaxation nor tolerance: these are ours.
THESIS = "thesis's setting"
THESIS_SOLVER = METHODS["FAS, Block-Jacobi"] | {"pre_sweeps": 10, "post_sweeps": 10, "relaxation": 0.7, "start": "hertz"}
THESIS_GRID = 1024
# The default as a user calls it.
WHOLE = "auto, whole program"
LOOKS = {
    "auto": {"color": "#f0b000", "linestyle": "-", "linewidth": 4.0, "marker": "", "zorder": 1},
    **dict(zip(list(METHODS)[1:], style.SERIES, strict=True)),
    "auto, target given": {"color": "#7a3fb0", "linestyle": "-", "linewidth": 0.8, "marker": "*", "markersize": 6},
    "auto, extrapolated": {
        "color": "#f0b000",
        "linestyle": (0, (1, 0.6)),
        "linewidth": 3.0,
        "marker": "o",
        "markersize": 4,
        "markerfacecolor": "white",
        "markeredgecolor": "#404040",
        "markeredgewidth": 0.8,
        "zorder": 1.5,
    },
    KAPPA: {"color": "#008080", "linestyle": "-", "linewidth": 1.2, "marker": "d", "markersize": 4.5},
    "auto, backward Euler": {"color": "#d02060", "linestyle": "-", "marker": "P", "markersize": 5},
    THESIS: {"color": "black", "linestyle": "none", "marker": "*", "markersize": 11, "markerfacecolor": "#ffd700", "zorder": 5},
    WHOLE: {"color": "0.35", "linestyle": ":", "linewidth": 1.4, "marker": ".", "markersize": 4},
}
# Nothing larger is tried: their cost grows with the cube and faster.
LARGEST = {"newton_dense": 1024, "block_jacobi": 128}
# No line smoother in time: it diverges with the squeeze term.
IN_TIME = ("auto", "newton_krylov", "FAS, Gauss-Seidel", "FAS, Block-Jacobi", "newton_dense")
TARGETS = (1e-1, 1e-2, 1e-3, 1e-4)
# Wanted accuracy (&accuracy target) for which the program chooses the grid.
WANTED = (1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4)
HEAVY = (100, 10)
SHORT_WINDOW = 0.55
# Times that differ by less are not told apart: those of the same work do so. In time, where the curves lie closest, the methods
# take turns on each grid.
NOISE = 0.05
TURNS = 3
# The default program: its values, and the limits that the same run writes beside them.
DEFAULT = ("auto", "auto, extrapolated")
# Curves whose points are labelled, the second one at powers of two; sides of a point where a label may stand [points].
LABELLED = ("newton_krylov", "auto, backward Euler", "block_jacobi")
SIDES = [(x, y) for y in (-8, 2, -3, 7, -14) for x in (-4, 4)]
# In time there are grids of 5/4 of each power of two besides: the reference has all their nodes, and steps are whole numbers.
REFERENCE_FACTOR = 5
STEP_UNIT = 4
RIDGE_START = -1.5


@dataclass
class Point:
    """One method on one grid."""

    method: str
    intervals: int
    seconds: float
    error: float
    answer: Answer
    # What nine tenths of the runs stay below [s].
    high: float


@dataclass
class Panel:
    """One contact: its name, the measure of error, and the points by method; `besides` are not compared with the others."""

    key: str
    title: str
    measure: str
    curves: dict[str, list[Point]] = field(default_factory=dict)
    besides: dict[str, list[Point]] = field(default_factory=dict)


def largest_grid(method: str, sizes: list[int]) -> list[int]:
    """The grids on which a method is run."""
    return [n for n in sizes if n <= LARGEST.get(method, n)]


def steady_panel(panel: Panel, text: object, sizes: list[int], effort: dict[str, float]) -> list[Answer]:
    """Solves a steady contact by all methods; `text(intervals, solver, accuracy)` makes its namelist."""
    finest = 4 * sizes[-1]
    jobs: list[Job] = [job("reference", text(finest, {"method": "newton_krylov", "tolerance": 1e-12} | KAPPA_SCHEME))]
    names = {}
    for method, solver in (METHODS | {KAPPA: KAPPA_SCHEME}).items():
        for n in largest_grid(method, sizes):
            names[f"{method}:{n}"] = (method, n)
            jobs.append(job(f"{method}:{n}".replace(" ", "_"), text(n, solver), **effort))
    jobs += [job(f"bars:{n}", text(n, {}), bars=1, **effort) for n in sizes[2:]]
    for target in WANTED:
        jobs.append(job(f"target:{target:g}", text(None, {}, {"target": target}), **effort))
    if panel.key == "steady":  # the thesis's contact
        jobs.append(job("thesis", text(THESIS_GRID, THESIS_SOLVER), **effort))
    answers = bench_program.run(jobs)
    reference = answers["reference"]
    for name, (method, n) in names.items():
        answer = answers[name.replace(" ", "_")]
        if answer.converged:
            error = film_error(answer, reference)
            panel.curves.setdefault(method, []).append(new_point(method, n, answer, error))
    if "thesis" in answers and answers["thesis"].converged:
        panel.besides[THESIS] = [new_point(THESIS, THESIS_GRID, answers["thesis"], film_error(answers["thesis"], reference))]
    add_whole_program(panel, {n: text(n, {}) for n in sizes}, effort)
    add_extrapolated(panel, answers, reference)
    for target in WANTED:
        answer = answers[f"target:{target:g}"]
        if answer.converged and 4 * answer["intervals"] <= finest:
            point = new_point("auto, target given", int(answer["intervals"]), answer, film_error(answer, reference))
            panel.curves.setdefault(point.method, []).append(point)
    return [answer for answer in answers.values() if not answer.converged]


def run_time(answer: Answer) -> float:
    """Least wall time without planning; the mean processor time where other programs on the machine made that smaller."""
    return min(answer["steady_least"] + answer["transient_least"], answer["processor"])


def high_time(answer: Answer) -> float:
    """What nine tenths of the runs stay below, without planning."""
    return max(answer["steady_high"] + answer["transient_high"], run_time(answer))


def new_point(method: str, intervals: int, answer: Answer, error: float) -> Point:
    """The point of a run."""
    return Point(method, intervals, run_time(answer), error, answer, high_time(answer))


def add_whole_program(panel: Panel, texts: dict[int, str], effort: dict[str, float]) -> None:
    """The default on the same grids as a user calls it: the error of the default, the time of the process."""
    plain = {point.intervals: point for point in panel.curves.get("auto", [])}
    found = chart_program.times_of({n: texts[n] for n in texts if n in plain}, int(effort["runs"]), effort["seconds"])
    panel.besides[WHOLE] = [Point(WHOLE, n, least, plain[n].error, plain[n].answer, high) for n, (least, high) in found.items()]


def film_error(values: dict[str, float], reference: dict[str, float]) -> float:
    """The larger one of the relative errors of smallest and central film."""
    return max(abs(values[name] / reference[name] - 1) for name in ("h_min", "h_central"))


def add_extrapolated(panel: Panel, answers: dict[str, Answer], reference: Answer) -> None:
    """The default on n, n/2 and n/4 intervals, extrapolated with the observed order between 1 and 2, as in /summary.

    The time is that of the run with error bars, which passes the coarser grids on its way.
    """
    points = panel.curves.get("auto", [])
    for quarter, half, full in zip(points, points[1:], points[2:], strict=False):
        values = {}
        for name in ("h_min", "h_central"):
            q1, q2, q4 = (point.answer[name] for point in (full, half, quarter))
            order = min(max(math.log2(abs((q2 - q4) / (q1 - q2))), 1.0), 2.0)
            values[name] = q1 + (q1 - q2) / (2**order - 1)
        with_bars = answers[f"bars:{full.intervals}"]
        times = (run_time(with_bars), film_error(values, reference), full.answer, high_time(with_bars))
        point = Point("auto, extrapolated", full.intervals, *times)
        panel.curves.setdefault(point.method, []).append(point)


def time_methods() -> dict[str, tuple[dict, dict]]:
    """Methods in time: settings of the solver and of the time steps."""
    methods = {name: (METHODS[name], {}) for name in IN_TIME}
    methods["auto, backward Euler"] = ({}, {"scheme": "backward_euler"})
    return methods


def transient_panel(panel: Panel, sizes: list[int], effort: dict[str, float]) -> list[Answer]:
    """A ridge enters the contact of Case 1 on the fast surface; time steps dX/2. The largest grid is a power of two."""

    def text(n: int, solver: dict, time: dict) -> str:
        steps = STEP_UNIT * round(SHORT_WINDOW / (5.5 / sizes[0] / 2) / STEP_UNIT) * n // sizes[0]
        ridge = namelists.RIDGE | {"position": RIDGE_START}
        settings = {"transient": True, "end_time": steps * 2.75 / n, "time_step": 2.75 / n} | time
        return namelists.case_1(n, solver, surface_2=ridge, time=settings)

    finest = REFERENCE_FACTOR * sizes[-1]
    jobs = [job("reference", text(finest, {"method": "newton_krylov", "tolerance": 1e-8}, {}), reference=1)]
    methods = time_methods()
    names = {}
    methods[THESIS] = (THESIS_SOLVER, {"scheme": "backward_euler"})
    thesis_grid = min(THESIS_GRID, sizes[-1])
    names[THESIS, thesis_grid] = [THESIS.replace(" ", "_")]
    jobs.append(job(names[THESIS, thesis_grid][0], text(thesis_grid, *methods.pop(THESIS)), compare=1, **effort))
    for n in sizes:
        own = [method for method in methods if n in largest_grid(method, sizes) and (method != "newton_dense" or n <= 256)]
        for turn, method in itertools.product(range(TURNS), own):
            name = f"{method}:{n}:{turn}".replace(" ", "_")
            names.setdefault((method, n), []).append(name)
            jobs.append(job(name, text(n, *methods[method]), compare=1, **effort))
    answers = bench_program.run(jobs)
    failures = [] if answers["reference"].converged else [answers["reference"]]
    for (method, n), turns in names.items():
        good = [answers[name] for name in turns if answers[name].converged]
        if not good:
            failures.append(answers[turns[0]])
            continue
        answer = min(good, key=run_time)
        point = new_point(method, n, answer, answer["difference"])
        point.high = max(map(high_time, good))
        (panel.besides if method == THESIS else panel.curves).setdefault(method, []).append(point)
    add_whole_program(panel, {n: text(n, {}, {}) for n in sizes if n & (n - 1) == 0}, effort)
    return failures


def fastest(panel: Panel, target: float) -> dict[str, Point]:
    """Of each method the quickest run whose error is within the target."""
    best = {}
    for method, points in panel.curves.items():
        good = [point for point in points if point.error <= target]
        if good:
            best[method] = min(good, key=lambda point: point.seconds)
    return best


def show_time(seconds: float) -> str:
    """Seconds or milliseconds with three digits."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{seconds * 1e3:.3g} ms"


def percent(value: float) -> str:
    """0.01 as 1 %."""
    return f"{100 * value:.3g} %"


def is_default(point: Point, default: Point | None) -> bool:
    """Whether a point is what the default does too, so that only noise is between their times."""
    if point.method.startswith("auto,"):
        return False
    return default is not None and (point.intervals, point.answer["method"]) == (default.intervals, default.answer["method"])


def conclusions(panels: list[Panel], failures: list[Answer]) -> str:
    """What the numbers say, made from nothing else."""
    lines = []
    for panel in panels:
        lines.append(f"{panel.title} (error: {panel.measure})")
        for target in TARGETS:
            best = fastest(panel, target)
            if not best:
                lines.append(f"  {percent(target)}: no run shown here is that accurate")
                continue
            first = min(best.values(), key=lambda point: point.seconds)
            if is_default(first, best.get("auto")):
                first = replace(first, method="auto")
                best["auto"] = first
            text = f"  for {percent(target)} use {first.method} with {first.intervals} intervals: {show_time(first.seconds)}"
            default = best.get("auto")
            own = "the value itself" if first.method in DEFAULT else "default"
            if default is None:
                text += f"; {own} does not reach it on these grids"
            elif default is not first:
                ratio = default.seconds / first.seconds
                text += f" ({own}: {default.intervals} intervals, {show_time(default.seconds)}, {ratio:.2f} x)"
            others = [p for p in best.values() if p is not first and p is not default and not is_default(p, default)]
            others.sort(key=lambda point: point.seconds)
            ratios = [f"{point.method} {point.seconds / first.seconds:.1f} x" for point in others]
            lines.append(text + (f"; {', '.join(ratios)}" if ratios else ""))
        lines += [f"  {who_is_first(panel)}", f"  observed order in 1/intervals: {orders(panel)}", *besides(panel)]
    if failures:
        lines.append("Not converged, not shown:")
        lines += [f"  {answer['name']}: {answer['reason'].strip()}" for answer in failures]
    return "\n".join(lines) + "\n"


def besides(panel: Panel) -> list[str]:
    """The thesis's setting beside the default of at most its error, the whole program beside the solution, the spread of times."""
    lines = []
    for point in panel.besides.get(THESIS, []):
        text = f"  the thesis's setting ({point.intervals} intervals): error {percent(point.error)}, {show_time(point.seconds)}"
        default = fastest(panel, point.error).get("auto")
        if default is not None:
            text += f", {point.seconds / default.seconds:.3g} x the default of at most this error ({default.intervals} intervals)"
        lines.append(text)
    whole = panel.besides.get(WHOLE, [])
    if whole:
        first, last = whole[0], whole[-1]
        lines.append(
            f"  the whole program takes {show_time(first.seconds)} on {first.intervals} and {show_time(last.seconds)} on "
            f"{last.intervals} intervals"
        )
    ratios = [point.high / point.seconds for points in panel.curves.values() for point in points]
    spread = f"{np.median(ratios):.2f} x the least (median of the points), {max(ratios):.2f} x (worst)"
    lines.append(f"  nine tenths of the runs stay below {spread}")
    return lines


def who_is_first(panel: Panel) -> str:
    """Whether the default is the left-most curve at every error of a point; one run gives its values and their limits."""
    late = {}
    for error in sorted({point.error for points in panel.curves.values() for point in points}):
        best = fastest(panel, 1.001 * error)  # methods solve the same equations, up to their tolerance
        own = min((best[name].seconds for name in DEFAULT if name in best), default=math.inf)
        first = min(best.values(), key=lambda point: point.seconds)
        if first.seconds < (1 - NOISE) * own and first.method not in DEFAULT and not is_default(first, best.get("auto")):
            late[first.method, first.intervals] = f"{percent(error)} ({first.method}, {first.seconds / own:.2f} x)"
    which = "the default (auto, or the extrapolated value that the same run writes beside each figure)"
    if DEFAULT[1] not in panel.curves:
        which = "the default"
    if not late:
        return f"left-most at every error shown (times within {percent(NOISE)}): {which}"
    return f"left-most at every error shown (times within {percent(NOISE)}) but {', '.join(late.values())}: {which}"


def orders(panel: Panel) -> str:
    """Order of the error between the last two grids of each method that has its own discretisation."""
    texts = []
    for method in ("auto", KAPPA, "auto, backward Euler"):
        points = panel.curves.get(method, [])
        if len(points) > 1:
            coarse, fine = points[-2:]
            order = math.log(coarse.error / fine.error) / math.log(fine.intervals / coarse.intervals)
            texts.append(f"{method} {order:.2f}")
    return ", ".join(texts)


def draw_panel(axes: Axes, panel: Panel) -> None:
    """The curves of one contact; thin bars are the spread of the times."""
    for method, points in (panel.curves | panel.besides).items():
        times, errors = [p.seconds * 1e3 for p in points], [100 * p.error for p in points]
        axes.loglog(times, errors, label=method, **LOOKS[method])
        axes.hlines(errors, times, [p.high * 1e3 for p in points], color=LOOKS[method]["color"], linewidth=0.6)
    axes.set(title=panel.title, xlabel="Wall time [ms]", ylabel=f"Error of {panel.measure} [%]")
    axes.title.set_fontsize(8.5)
    decimal_ticks(axes)


def decimal_ticks(axes: Axes) -> None:
    """Decades as numbers, a grid, room for the labels."""
    axes.grid(which="major", color="0.9", linewidth=0.5)
    axes.margins(x=0.16, y=0.1)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(10, numticks=12))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())


def label_points(axes: Axes, panel: Panel) -> None:
    """The intervals beside the points of some curves, each on the side where it covers least of curves and other labels."""
    curves = [axes.transData.transform(line.get_xydata()) for line in axes.lines]
    covered = [along for curve in curves for start, end in itertools.pairwise(curve) for along in np.linspace(start, end, 40)]
    taken = []
    for point in (point for name in LABELLED for point in panel.curves.get(name, [])):
        if "Euler" in point.method and point.intervals & (point.intervals - 1):
            continue
        labels = [new_label(axes, point, side) for side in SIDES]
        boxes = [label.get_window_extent().padded(1) for label in labels]
        costs = [
            20 * (sum(map(box.overlaps, taken)) + (box.x0 < axes.bbox.x0)) + sum(box.contains(*spot) for spot in covered)
            for box in boxes
        ]
        best = costs.index(min(costs))
        taken.append(boxes[best])
        for label in labels[:best] + labels[best + 1 :]:
            label.remove()


def new_label(axes: Axes, point: Point, shift: tuple[int, int]) -> Annotation:
    """The intervals of a point beside it."""
    return axes.annotate(
        str(point.intervals),
        (point.seconds * 1e3, 100 * point.error),
        xytext=shift,
        textcoords="offset points",
        fontsize=7,
        ha="right" if shift[0] < 0 else "left",
        path_effects=[withStroke(linewidth=1.5, foreground="white")],
    )


def draw(panels: list[Panel], models: chart_models.ModelPanel, folder: Path) -> None:
    """The figure of all panels with one legend; the last one compares models."""
    figure, grid = style.new_figure(style.TWO_COLUMNS, 165, nrows=2, ncols=2)
    axes, last = grid.flat[: len(panels)], grid.flat[-1]
    for one, panel in zip(axes, panels, strict=True):
        draw_panel(one, panel)
    chart_models.draw(last, models)
    decimal_ticks(last)
    handles = {}
    for one in axes:
        for handle, label in zip(*one.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    style.legend_below(figure, list(handles.values()), 4)
    figure.canvas.draw()
    for one, panel in zip(axes, panels, strict=True):
        label_points(one, panel)
    style.save_figure(figure, [folder / "chart.png", folder / "chart.pdf"])


def save(panels: list[Panel], path: Path) -> None:
    """All points as CSV."""
    columns = ("cycles", "steps", "residual", "fft_pairs", "work_units", "runs", "setup_median", "h_min", "h_central", "p_max")
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("panel", "method", "intervals", "seconds", "seconds_least", "seconds_high", "error", "way", *columns))
        for panel in panels:
            for point in (point for points in (panel.curves | panel.besides).values() for point in points):
                answer = point.answer
                least = answer["steady_least"] + answer["transient_least"]
                times = (point.seconds, least, point.high)
                values = (answer[column] for column in columns)
                writer.writerow((panel.key, point.method, point.intervals, *times, point.error, answer["method"], *values))


def grids(first: int, last: int) -> list[int]:
    """Powers of two from first to last."""
    return [2**k for k in range(int(math.log2(first)), int(math.log2(last)) + 1)]


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "coarser grids and fewer runs, under 3 minutes", "results/chart")
    options = parser.parse_args()
    folder = output_folder(options)
    quick = options.quick
    effort = {"runs": 15 if quick else 101, "seconds": 0.5 if quick else 1}
    panels = [
        Panel("steady", "Steady: Case 1 (Eyring)", "film thickness"),
        Panel("transient", "In time: ridge, Case 3", "pressure"),
        Panel("heavy", f"Heavily loaded: Barus, M {HEAVY[0]}, L {HEAVY[1]}", "film thickness"),
    ]

    def case_1(n: int | None, solver: dict, accuracy: dict | None = None) -> str:
        return namelists.case_1(n, solver, accuracy=accuracy or {})

    def heavy(n: int | None, solver: dict, accuracy: dict | None = None) -> str:
        return namelists.moes(*HEAVY, n, solver, domain=namelists.WINDOW, accuracy=accuracy or {})

    failures = steady_panel(panels[0], case_1, grids(32, 1024 if quick else 4096), effort)
    once = {"runs": 3 if quick else 21, "seconds": 0.5 if quick else 1}
    last = 256 if quick else 1024
    between = [5 * n // 4 for n in grids(64, last // 2)]
    failures += transient_panel(panels[1], sorted(grids(64, last) + between), once)
    failures += steady_panel(panels[2], heavy, grids(128, 2048 if quick else 8192), effort)
    models = chart_models.measure(quick)
    save(panels, folder / "chart.csv")
    chart_models.save(models, folder / "chart_models.csv")
    draw(panels, models, folder)
    text = conclusions(panels, failures) + chart_models.conclusions(models)
    (folder / "conclusion.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    for name in ("chart.png", "chart.pdf", "chart.csv", "chart_models.csv", "conclusion.txt"):
        print(folder / name)
    return 0


if __name__ == "__main__":
    sys.exit(main())

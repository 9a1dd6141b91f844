#!/usr/bin/env python3
"""Draws several results in one figure with their difference from the first, and prints a table.

Results whose scales (half-width, b^2/R, p_h) differ are compared in SI, with or without --si.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import figure_command
import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from result_file import Axis, Result, ResultError, check_result, read_result

PROGRAM = "compare.py"
EXAMPLE = "python postproc/compare.py results/case1_256.h5 results/case1_1024.h5 --output results"
FIELDS = ("film_thickness", "pressure")
# Relative difference of two scales that is none.
ROUNDING = 1e-6
MAX_LABELS = 8
# Name in /summary, the field it belongs to.
COLUMNS = (("h_min", "film_thickness"), ("h_central", "film_thickness"), ("p_max", "pressure"))


def names(results: list[Result]) -> list[str]:
    """Short names of the results, with the folder where the stems are equal."""
    stems = [result.stem for result in results]
    if len(set(stems)) == len(stems):
        return stems
    return [str(result.path.with_suffix("")) for result in results]


def draw_field(upper: Axes, lower: Axes, results: list[Result], field: str, options: argparse.Namespace) -> None:
    """One field of all results, and below it the difference to the first."""
    first = results[0]
    x_axis, axis = first.solution["x"].axis(options.si), first.solution[field].axis(options.si)
    x_first, reference = first.solution["x"].shown(x_axis), first.solution[field].shown(axis)
    left, right = window(results, options)
    largest = 0.0
    for i, (result, label) in enumerate(zip(results, names(results), strict=True)):
        look = look_of(i, len(results))
        x, values = result.solution["x"].shown(x_axis), result.solution[field].shown(axis)
        words = style.literal(label) + when(result, options.si) + ("" if i else " (reference)")
        upper.plot(x, values, label=words, **look)
        if i > 0:
            nodes, difference = difference_of(x, values, x_first, reference)
            lower.plot(nodes, difference, **look)
            seen = np.abs(difference[(nodes >= left) & (nodes <= right)])
            largest = max(largest, float(np.nanmax(seen, initial=0.0)))
    lower.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    if largest > 0:
        lower.set_ylim(-1.1 * largest, 1.1 * largest)
    lower.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)
    upper.set_ylabel(axis.label)
    lower.set(xlabel=x_axis.label, ylabel=axis.difference_label)
    style.few_ticks(lower)
    upper.set(xlim=(left, right), ylim=(0, top_of(results, field, axis)))


def look_of(i: int, count: int) -> dict[str, object]:
    """The line of result `i`: told apart by dashes and markers, of a family by its place in a range of colours."""
    if count <= len(style.SERIES):
        return style.SERIES[i] | {"markevery": (0.03 * i, 0.15)}
    return {"color": style.plt.get_cmap(style.COLOUR_MAP)(0.92 * i / (count - 1)), "linewidth": 0.9}


def labelled(count: int) -> list[int]:
    """The results that the legend names: all of a few, of a family some, spread evenly, with the first and the last."""
    return sorted({round(i) for i in np.linspace(0, count - 1, min(count, MAX_LABELS))})


def when(result: Result, si: bool) -> str:
    """Time of the fields of a transient result, for the legend."""
    if result.last_time is None:
        return ""
    axis = result.transient["time"].axis(si)
    return f", ${axis.symbol}$ = {axis.number(result.last_time)}"


def difference_of(x: np.ndarray, values: np.ndarray, x_first: np.ndarray, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and difference to the reference, on the coarser of the two grids."""
    if x.size < x_first.size:
        return x, values - np.interp(x, x_first, reference, np.nan, np.nan)
    return x_first, np.interp(x_first, x, values, np.nan, np.nan) - reference


def window(results: list[Result], options: argparse.Namespace) -> tuple[float, float]:
    """The part of the shown positions that holds the loaded part of every result."""
    axis = results[0].solution["x"].axis(options.si)
    ends = []
    for result in results:
        scale = 1.0 if axis.unit_size is None else result.solution["x"].si_scale / axis.unit_size
        ends += [end * scale for end in style.x_window(result, options.window)]
    return min(ends), max(ends)


def top_of(results: list[Result], field: str, axis: Axis) -> float:
    """Upper end of the axis of a field."""
    if field == "pressure":
        return 1.06 * max(float(np.nanmax(r.solution[field].shown(axis))) for r in results)
    return max(style.film_limit(r.solution[field].shown(axis), r.solution["pressure"].values) for r in results)


def draw_figure(results: list[Result], options: argparse.Namespace) -> list[Path]:
    """Left film, right pressure; above the results, below their difference to the first."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 100, nrows=2, ncols=2, sharex=True, height_ratios=(1.6, 1))
    for (upper, lower), field in zip(axes.T, FIELDS, strict=True):
        draw_field(upper, lower, results, field, options)
    figure.align_ylabels(axes)
    longest = max(len(label) for label in names(results))
    columns = max(1, min(3, len(results), 90 // (longest + 20)))
    handles = axes[0, 0].get_legend_handles_labels()[0]
    style.legend_below(figure, [handles[i] for i in labelled(len(results))], columns)
    style.mark_not_converged(figure, results)
    stem = results[0].stem
    return style.save_figure(figure, figure_command.targets(options, stem, "compare"))


def same_scales(results: list[Result]) -> bool:
    """Whether a dimensionless number means the same in all results. Of &moes the film in its units tells it."""
    rows = []
    for result in results:
        if result.solution["x"].has_si:
            rows.append([result.solution[name].si_scale for name in ("x", *FIELDS)])
        else:
            rows.append([result.summary.get("h_min_moes", np.nan) / result.summary.get("h_min", np.nan)])
    if len({len(row) for row in rows}) > 1:
        return False
    return all(np.allclose(row, rows[0], rtol=ROUNDING, atol=0, equal_nan=True) for row in rows)


def settle_units(results: list[Result], options: argparse.Namespace) -> None:
    """SI where the scales differ; where a result has no SI, a warning."""
    if options.si or same_scales(results):
        return
    unknown = [str(result.path) for result in results if not result.solution["x"].has_si]
    if unknown:
        words = f"the scales of the results differ, and {', '.join(unknown)} has no SI"
        print(f"{PROGRAM}: warning: {words}: each is in units of its own b, b^2/R and p_h", file=sys.stderr)
        return
    print("the scales of the results differ: compared in SI")
    options.si = True


def number(result: Result, name: str, field: str, axis: Axis) -> float:
    """A value of /summary (SI) in the unit of the table; NaN where the file does not have it."""
    size = axis.unit_size if axis.unit_size is not None else result.solution[field].si_scale
    return result.summary.get(name, np.nan) / size


def table(results: list[Result], si: bool) -> str:
    """Each result in a line: nodes and characteristic values, each with its change in per cent."""
    width = max(6, *(len(name) for name in names(results)))
    axes = {field: results[0].solution[field].axis(si) for field in FIELDS}
    head = f"{'result':<{width}}  {'nodes':>6}"
    for name, field in COLUMNS:
        head += f"  {name + ' [' + (axes[field].unit or '-') + ']':>14}  {'change':>9}"
    lines = [head]
    for result, label in zip(results, names(results), strict=True):
        line = f"{label:<{width}}  {result.x.size:6d}"
        for name, field in COLUMNS:
            value = number(result, name, field, axes[field])
            reference = number(results[0], name, field, axes[field])
            line += f"  {value:14.7g}  {100 * (value / reference - 1):+8.3f}%"
        lines.append(line + ("" if result.converged else "  NOT CONVERGED"))
    if any(result.last_time is not None for result in results):
        lines.append("of a transient: the extremes over its time steps; the figure shows the last time")
    return "\n".join(lines)


def compare(options: argparse.Namespace) -> list[Path]:
    """Reads all results, prints the table, draws the figure."""
    findings = []
    for path in options.results:
        try:
            check_result(path)
        except ResultError as error:
            findings.append(str(error))
    if findings:
        raise ResultError("; ".join(findings))
    results = [read_result(path, options.si) for path in options.results]
    for result in results:
        figure_command.warn_not_converged(PROGRAM, result)
    settle_units(results, options)
    print(table(results, options.si))
    return draw_figure(results, options)


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    figure_command.add_window(parser)
    options = parser.parse_args(arguments)
    if len(options.results) < 2:
        parser.error("needs at least two result files")
    return figure_command.guarded(parser.prog, compare, options)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Draws residual and load error over the cycles, with their bound."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import figure_command
import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from result_file import Result, ResultError, read_result

PROGRAM = "convergence.py"
EXAMPLE = "python postproc/convergence.py results/case1.h5 --output results"
ROUND_OFF = float(np.finfo(float).eps)
LARGEST = 1e30
MOST_MARKERS = 60


def histories(result: Result) -> list[tuple[str, np.ndarray]]:
    """The histories in the file that are not empty, with their names."""
    names = {"residual_history": "residual", "load_error_history": "load error"}
    found = [
        (words, np.atleast_1d(result.report[name]))
        for name, words in names.items()
        if name in result.report and np.size(result.report[name]) > 0
    ]
    if not found:
        raise ResultError(f"{result.path}: has no /report/residual_history with at least one cycle")
    return found


def power_of_ten(value: float) -> str:
    """1.0e-08 as a reader writes it."""
    digits, exponent = f"{value:.1e}".split("e")
    return f"${digits} \\times 10^{{{int(exponent)}}}$"


def sections(result: Result) -> list[tuple[str, slice]]:
    """The parts of the history to draw: title and cycles.

    Of a transient the start, and after a failure the cycles that follow the last step. The residual
    that /transient holds for a step is that of its last cycle, which finds the cycle in the history.
    """
    history = np.atleast_1d(result.report["residual_history"])
    if "residual" not in result.transient:
        return [("", slice(None))]
    reached = result.transient["residual"].values
    first = np.flatnonzero(history == reached[0])
    last = np.flatnonzero(history == reached[-1])
    if first.size == 0 or last.size == 0:
        return [("", slice(None))]
    parts = [("start (smooth surfaces, steady)", slice(0, first[0] + 1))]
    if not result.converged and last[-1] + 1 < history.size:
        parts.append(("after the last time step", slice(last[-1] + 1, None)))
    return parts


def draw_cycles(axes: Axes, result: Result, title: str, part: slice) -> None:
    """Residual and load error after each cycle; values that could not be computed leave gaps."""
    for (words, whole), look in zip(histories(result), style.SERIES, strict=False):
        history = np.where(whole < LARGEST, np.maximum(whole, ROUND_OFF), np.nan)
        cycles = np.arange(1, history.size + 1)[part]
        few = cycles.size <= MOST_MARKERS
        axes.semilogy(cycles, history[part], label=words, **look | ({} if few else {"marker": "", "linewidth": 0.6}))
    axes.set(xlabel="Cycle", ylabel="Residual, load error [-]", title=title)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.03)


def draw_steps(axes: Axes, result: Result, si: bool) -> None:
    """Residual reached in each time step; the start is not among them."""
    axis = result.transient["time"].axis(si)
    time = result.transient["time"].shown(axis)[1:]
    residual = np.maximum(result.transient["residual"].values[1:], ROUND_OFF)
    axes.semilogy(time, residual, color=style.SERIES[0]["color"], linewidth=0.8)
    axes.set(xlabel=axis.label, ylabel="Residual [-]", title="end of each time step", xlim=(0, time[-1]))


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, draws it, returns the names of the figures."""
    result = read_result(path, options.si)
    figure_command.warn_not_converged(PROGRAM, result)
    histories(result)
    parts = sections(result)
    has_steps = "residual" in result.transient and result.transient["time"].values.size > 1
    rows = len(parts) + has_steps
    figure, axes = style.new_figure(style.ONE_COLUMN, 18 + 46 * rows, nrows=rows, squeeze=False)
    for panel, (title, part) in zip(axes[:, 0], parts, strict=False):
        draw_cycles(panel, result, title, part)
    if has_steps:
        draw_steps(axes[-1, 0], result, options.si)
    tolerance = float(result.report.get("tolerance_effective", 0.0))
    is_start = len(parts) < rows or len(parts) > 1  # which has a tolerance of its own, not in the file
    handles = axes[0, 0].get_legend_handles_labels()[0]
    if tolerance > 0:
        for panel in axes[is_start:, 0]:
            line = panel.axhline(tolerance, label=f"bound {power_of_ten(tolerance)}", **style.REFERENCE)
        handles.append(line)
    style.legend_below(figure, handles, 2)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "convergence"))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    options = parser.parse_args(arguments)
    return figure_command.run(parser, options, draw, ("solution", "report"))


if __name__ == "__main__":
    sys.exit(main())

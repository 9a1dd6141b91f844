#!/usr/bin/env python3
"""Draws residual and load error over the cycles, with the effective tolerance."""

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
MOST_MARKERS = 40


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


def draw_cycles(axes: Axes, result: Result) -> None:
    """Residual and load error after each cycle."""
    for (words, history), look in zip(histories(result), style.SERIES, strict=False):
        few = history.size <= MOST_MARKERS
        axes.semilogy(
            np.arange(1, history.size + 1),
            np.maximum(history, ROUND_OFF),
            label=words,
            **look | {"marker": look["marker"] if few else "", "linewidth": 1.2 if few else 0.6},
        )
    axes.set(xlabel="Cycle", ylabel="Residual, load error [-]")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.margins(x=0.03)


def draw_steps(axes: Axes, result: Result, si: bool) -> None:
    """Residual reached in each stored time step; the start has none of its own."""
    axis = result.transient["time"].axis(si)
    time = result.transient["time"].shown(axis)[1:]
    axes.semilogy(
        time,
        np.maximum(result.transient["residual"].values[1:], ROUND_OFF),
        color=style.SERIES[0]["color"],
        linewidth=0.8,
    )
    axes.set(xlabel=axis.label, ylabel="Residual of the step [-]", xlim=(0, time[-1]))


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, draws it, returns the names of the figures."""
    result = read_result(path, options.si)
    figure_command.warn_not_converged(PROGRAM, result)
    has_steps = "residual" in result.transient and result.transient["time"].values.size > 1
    figure, axes = style.new_figure(style.ONE_COLUMN, 105 if has_steps else 66, nrows=1 + has_steps, squeeze=False)
    draw_cycles(axes[0, 0], result)
    if has_steps:
        draw_steps(axes[1, 0], result, options.si)
    tolerance = float(result.report.get("tolerance_effective", 0.0))
    if tolerance > 0:
        label = f"effective tolerance {power_of_ten(tolerance)}"
        for panel in axes[:, 0]:
            panel.axhline(tolerance, label=label, **style.REFERENCE)
    style.legend_below(figure, axes[0, 0].get_legend_handles_labels()[0], 2)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "convergence"))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    options = parser.parse_args(arguments)
    return figure_command.run(parser, options, draw, ("solution", "report"))


if __name__ == "__main__":
    sys.exit(main())

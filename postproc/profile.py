#!/usr/bin/env python3
"""Draws pressure (left axis) and film thickness (right axis) over X, one figure per result."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import figure_command
import figure_style as style
import numpy as np
from result_file import Result, read_result

PROGRAM = "profile.py"
EXAMPLE = "python postproc/profile.py results/case1.h5 --output results --si"


def fields(result: Result, time: float | None) -> tuple[np.ndarray, np.ndarray, float | None]:
    """Pressure and film at the time stored nearest to `time`; without it, the solution."""
    if time is None:
        solution = result.solution
        return solution["pressure"].values, solution["film_thickness"].values, result.last_time
    step = int(np.argmin(np.abs(result.profile_time.values - time)))
    found = result.profile_time.values[step]
    transient = result.transient
    return transient["pressure"].values[step], transient["film_thickness"].values[step], found


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, draws it, returns the names of the figures."""
    result = read_result(path, options.si, with_transient=options.time is not None)
    figure_command.warn_not_converged(PROGRAM, result)
    pressure, film, time = fields(result, options.time)
    x_axis, p_axis, h_axis = (result.solution[name].axis(options.si) for name in ("x", "pressure", "film_thickness"))
    x = result.x * x_axis.factor
    left, right = style.x_window(result, options.window)
    hertz = np.sqrt(np.maximum(1 - result.x**2, 0))

    figure, axes = style.new_figure(style.ONE_COLUMN, 66)
    twin = axes.twinx()
    lines = axes.plot(x, pressure * p_axis.factor, label="pressure", **style.PRESSURE)
    lines += twin.plot(x, film * h_axis.factor, label="film", **style.FILM)
    lines += axes.plot(x, hertz * p_axis.factor, label="Hertz", **style.REFERENCE)
    low = np.nanargmin(film)
    lines += twin.plot(
        x[low],
        film[low] * h_axis.factor,
        "o",
        mfc="white",
        color=style.FILM["color"],
        label=f"${h_axis.symbol}_\\mathrm{{min}}$ = {h_axis.number(film[low])}",
    )
    axes.set(xlabel=x_axis.label, ylabel=p_axis.label)
    twin.set_ylabel(h_axis.label)
    axes.set_xlim(left * x_axis.factor, right * x_axis.factor)
    axes.set_ylim(0, 1.08 * np.nanmax(np.maximum(pressure, hertz)) * p_axis.factor)
    twin.set_ylim(0, style.film_limit(film, pressure) * h_axis.factor)
    style.few_ticks(axes)
    axes.tick_params(right=False)
    twin.tick_params(left=False)
    style.legend_below(figure, lines, 2)
    if time is not None:
        t_axis = result.transient["time"].axis(options.si)
        axes.set_title(f"${t_axis.symbol}$ = {t_axis.number(time)}")
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "profile"))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    figure_command.add_window(parser)
    figure_command.add_time(parser)
    options = parser.parse_args(arguments)
    return figure_command.run(parser, options, draw, figure_command.groups_of_time(options))


if __name__ == "__main__":
    sys.exit(main())

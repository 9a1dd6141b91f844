#!/usr/bin/env python3
"""Draws the statistics of the film over a passage: distributions, and how often it is thinner than given thresholds (in SI)."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import figure_command
import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from result_file import opened, read_result, values_of

PROGRAM = "film_statistics.py"
EXAMPLE = "python postproc/film_statistics.py results/rough.h5 --output results"
NANO, GIGA = 1e-9, 1e9


def read_statistics(path: Path) -> dict[str, np.ndarray]:
    """The datasets of /statistics."""
    with opened(path) as file:
        return {name: np.atleast_1d(values_of(item)) for name, item in file["statistics"].items()}


def draw_distribution(axes: Axes, edges: np.ndarray, shares: np.ndarray, look: dict[str, object]) -> None:
    """Share of the time in each class, in percent."""
    axes.stairs(100 * shares, edges, fill=True, color=look["color"], alpha=0.25)
    axes.stairs(100 * shares, edges, color=look["color"], linewidth=0.8)
    axes.set(ylabel="Share of the time [%]", ylim=(0, None))
    axes.margins(x=0.08)
    style.few_ticks(axes)


def draw_thresholds(axes: Axes, values: dict[str, np.ndarray]) -> None:
    """Time and contact area below the stated films."""
    order = np.argsort(values["film_threshold"])
    film = values["film_threshold"][order] / NANO
    for name, words, look in (
        ("time_below", "time, smallest film", style.SERIES[0]),
        ("area_below", "contact area, mean over time", style.SERIES[1]),
    ):
        axes.plot(film, 100 * values[name][order], label=words, clip_on=False, zorder=3, **look)
    axes.set(xlabel="Film $h$ [nm]", ylabel="Share below $h$ [%]", ylim=(0, 100))
    axes.margins(x=0.08)
    style.few_ticks(axes)


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, draws it, returns the names of the figures."""
    result = read_result(path)
    figure_command.warn_not_converged(PROGRAM, result)
    values = read_statistics(path)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 68, ncols=3)
    draw_distribution(axes[0], values["h_min_edges"] / NANO, values["h_min_share"], style.FILM)
    for name, words, look in (
        ("smooth_film", "smooth film at $X = 0$", style.SERIES[1]),
        ("mean_film", "mean film in the contact", style.SERIES[3]),
    ):
        line = {"color": look["color"], "linestyle": look["linestyle"], "linewidth": 1.0}
        axes[0].axvline(values[name][0] / NANO, label=words, **line)
    axes[0].set_xlabel("Smallest film $h_\\mathrm{min}$ [nm]")
    draw_distribution(axes[1], values["p_max_edges"] / GIGA, values["p_max_share"], style.PRESSURE)
    axes[1].set_xlabel("Largest pressure $p_\\mathrm{max}$ [GPa]")
    draw_thresholds(axes[2], values)
    ratio, rms = values["lambda_ratio"][0], values["rms_height"][0] / NANO
    if ratio > 0:
        axes[1].set_title(f"lambda ratio {ratio:.3g} (rms height {rms:.3g} nm)")
    for panel in (axes[0], axes[2]):  # each above its own panel
        panel.legend(loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0.2)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "film_statistics"))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    options = parser.parse_args(arguments)
    return figure_command.run(parser, options, draw, ("solution", "statistics"))


if __name__ == "__main__":
    sys.exit(main())

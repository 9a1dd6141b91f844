#!/usr/bin/env python3
"""Draws a passage: x-t maps with the paths of the features, a film strip; an animation (--parts passage, GIF).

Of a history it also draws loads and speeds; of a periodic one the last cycle.
"""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import replace
from pathlib import Path

import figure_command
import figure_style as style
import matplotlib.patheffects as effects
import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from result_file import Feature, Result, ResultError, read_result

PROGRAM = "transient.py"
EXAMPLE = "python postproc/transient.py results/case3.h5 --output results"
PARTS = ("xt", "film_strip", "history", "passage")
STRIP_CENTRES = (-1.0, -0.5, 0.0, 0.5, 1.0)
MAP_POINTS = 1200
MAXIMAL_PATHS = 24
LOADED = 0.9  # |X| up to which the film of the map is shown in full
LOADED_SHARE = 0.3  # of the largest pressure of a moment, the same of a history
LOOKS = (style.FILM, style.PRESSURE)
PATH = {
    "color": "black",
    "linewidth": 0.8,
    "linestyle": (0, (6, 4)),
    "scalex": False,
    "scaley": False,
    "path_effects": [effects.withStroke(linewidth=1.7, foreground="white")],
}


def visible_paths(result: Result, window: tuple[float, float]) -> list[Feature]:
    """Paths to draw: each feature, and of a sinusoid every crest that is seen in the window."""
    time = result.profile_time.values
    paths: list[Feature] = []
    for feature in result.features:
        if feature.shape != "sinusoid" or not feature.spacing > 0:
            paths.append(feature)
            continue
        centres = feature.centre(time)
        first = int(np.ceil((window[0] - centres.max()) / feature.spacing))
        last = int(np.floor((window[1] - centres.min()) / feature.spacing))
        if last - first < MAXIMAL_PATHS:
            paths += [feature.shifted(waves) for waves in range(first, last + 1)]
    return paths


def last_complete_crest(feature: Feature, end: float, goal: float) -> Feature:
    """Of a sinusoid the last crest that has reached `goal` at the `end`; other features as is."""
    if feature.shape != "sinusoid" or not feature.spacing > 0:
        return feature
    waves = (goal - feature.centre(end)) / feature.spacing
    return feature.shifted(math.ceil(waves) if feature.speed > 0 else math.floor(waves))


def strip_steps(result: Result, centres: list[float]) -> tuple[list[int], Feature | None]:
    """Stored profiles at which a feature is nearest to the centres, in order of time, and which.

    The first moving feature, unless a later one passes more of the centres. Evenly spaced times
    when none passes any.
    """
    time = result.profile_time.values
    margin = 0.5 * np.max(np.diff(time), initial=0.0)
    moments: list[float] = []
    followed = None
    for feature in (feature for feature in result.features if feature.speed != 0):
        goal = max(centres) if feature.speed > 0 else min(centres)
        crest = last_complete_crest(feature, time[-1], goal)
        passed = sorted(crest.time_at(x) for x in centres)
        passed = [t for t in passed if time[0] - margin <= t <= time[-1] + margin]
        if len(passed) > len(moments):
            moments, followed = passed, crest
    if followed is None:
        return list(np.unique(np.linspace(0, time.size - 1, len(centres)).astype(int))), None
    return [int(np.argmin(np.abs(time - t))) for t in moments], followed


def paths_legend(paths: list[Feature]) -> list[Line2D]:
    """Legend entry for the dashed paths; empty without paths."""
    if not paths:
        return []
    what = list(dict.fromkeys(f"{path.word} of surface {path.surface}" for path in paths))
    label = ("path of " if len(paths) == 1 else "paths: ") + ", ".join(what)
    look = {key: PATH[key] for key in ("color", "linewidth", "linestyle")}
    return [Line2D([], [], label=label, **look)]


def colour_range(result: Result, name: str, values: np.ndarray) -> tuple[float, float, str]:
    """Lowest and highest colour in stored units, and which ends of the bar are open."""
    if name == "pressure":
        return 0.0, float(np.nanmax(values)), "neither"
    low = float(np.nanmin(values))
    film, pressure = (result.transient[name].values for name in ("film_thickness", "pressure"))
    loaded = film[:, np.abs(result.x) <= LOADED]
    if result.has_history:  # its half-width changes
        loaded = film[pressure > LOADED_SHARE * np.nanmax(pressure, axis=1, keepdims=True)]
    high = float(np.nanpercentile(loaded, 99.5)) if np.isfinite(loaded).any() else float(np.nanmax(values))
    return low, max(high, 1.01 * low), "max"


def draw_map(axes: Axes, result: Result, name: str, options: argparse.Namespace) -> None:
    """One x-t map with colour bar and paths."""
    quantity, time = result.transient[name], result.profile_time.values
    shown, x_axis, t_axis = (
        quantity.axis(options.si),
        result.solution["x"].axis(options.si),
        result.profile_time.axis(options.si),
    )
    window = style.x_window(result, options.window)
    nodes = np.flatnonzero((result.x >= window[0]) & (result.x <= window[1]))
    nodes = nodes[:: 1 + nodes.size // MAP_POINTS]
    steps = np.arange(0, time.size, 1 + time.size // MAP_POINTS)
    values = quantity.values[np.ix_(steps, nodes)]
    low, high, extend = colour_range(result, name, values)
    if result.has_history:
        shown = replace(quantity, largest=high).axis(options.si)
    image = axes.pcolormesh(
        result.x[nodes] * x_axis.factor,
        time[steps] * t_axis.factor,
        values * shown.factor,
        cmap=style.COLOUR_MAP,
        vmin=low * shown.factor,
        vmax=high * shown.factor,
        shading="nearest",
        rasterized=True,
    )
    axes.figure.colorbar(image, ax=axes, location="top", label=shown.label, extend=extend, aspect=28, pad=0.02)
    ends = time[[0, -1]]
    for path in visible_paths(result, window):
        moments = ends if path.course is None else time
        axes.plot(path.centre(moments) * x_axis.factor, moments * t_axis.factor, **PATH)
    axes.set_xlim(window[0] * x_axis.factor, window[1] * x_axis.factor)
    axes.set_ylim(ends * t_axis.factor)
    axes.set(xlabel=x_axis.label, ylabel=t_axis.label)
    style.few_ticks(axes)


def draw_xt(result: Result, options: argparse.Namespace) -> list[Path]:
    """Maps of film and pressure over X and T."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 95, ncols=2, sharey=True)
    for panel, name in zip(axes, ("film_thickness", "pressure"), strict=True):
        draw_map(panel, result, name, options)
    axes[1].set_ylabel("")
    paths = visible_paths(result, style.x_window(result, options.window))
    if paths:
        style.legend_below(figure, paths_legend(paths), 1)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "xt"))


class Passage:
    """What film strip and animation share: fields, axes, limits that hold for all times."""

    def __init__(self, result: Result, options: argparse.Namespace) -> None:
        """Looks up the fields of `result` and the ends of the axes."""
        transient = result.transient
        self.time = result.profile_time.values
        self.t_axis = result.profile_time.axis(options.si)
        self.x_axis = result.solution["x"].axis(options.si)
        self.window = style.x_window(result, options.window)
        self.paths = visible_paths(result, self.window)
        self.x = result.x * self.x_axis.factor
        film, pressure = transient["film_thickness"], transient["pressure"]
        inside = (result.x >= self.window[0]) & (result.x <= self.window[1])
        tops = (
            style.film_limit(film.values[0], pressure.values[0]),
            1.06 * float(np.nanmax(pressure.values[:, inside])),
        )
        self.rows = []
        for field, look, top in zip((film, pressure), LOOKS, tops, strict=True):
            axis = field.axis(options.si)
            self.rows.append((field.shown(axis), axis, look["color"], top * axis.factor))

    def set_axes(self, column: np.ndarray) -> None:
        """Start as reference, labels and limits of a film panel above a pressure panel."""
        for panel, (values, axis, _, top) in zip(column, self.rows, strict=True):
            label = f"start (${self.t_axis.symbol} = 0$)" if self.time[0] == 0 else self.title(0)
            panel.plot(self.x, values[0], label=label, **style.REFERENCE)
            panel.set(ylabel=axis.plain_label, ylim=(0, top))
            panel.set_xlim(end * self.x_axis.factor for end in self.window)
            style.few_ticks(panel, 4)

    def title(self, step: int) -> str:
        """The time of a step."""
        return f"${self.t_axis.symbol}$ = {self.t_axis.number(self.time[step], self.time[-1])}"

    def places(self, step: int) -> list[tuple[Feature, float]]:
        """The features that are inside the window, and where (shown unit)."""
        centres = [(path, path.centre(self.time[step])) for path in self.paths]
        return [(path, x * self.x_axis.factor) for path, x in centres if self.window[0] <= x <= self.window[1]]


def draw_film_strip(result: Result, options: argparse.Namespace) -> list[Path]:
    """Film above, pressure below, one column for each place of the feature."""
    steps, feature = strip_steps(result, options.centres)
    passage = Passage(result, options)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 92, nrows=2, ncols=len(steps), sharex=True, sharey="row", squeeze=False)
    for column, step in zip(axes.T, steps, strict=True):
        passage.set_axes(column)
        for panel, (values, _, colour, _) in zip(column, passage.rows, strict=True):
            panel.plot(passage.x, values[step], color=colour)
            for path, place in passage.places(step):
                panel.axvline(place, color="0.35", linewidth=0.6, linestyle=(0, (4, 3)), zorder=0)
                panel.plot(
                    place,
                    1,
                    transform=panel.get_xaxis_transform(),
                    clip_on=False,
                    zorder=5,
                    **mark_look(path),
                )
        column[0].set_title(strip_title(passage, step, feature))
        column[1].set_xlabel(passage.x_axis.short_label)
    for panel in axes[:, 1:].flat:
        panel.set_ylabel("")
    style.legend_below(figure, [axes[0, 0].lines[0], *marks_legend(passage.paths)], 4)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "film_strip"))


def mark_look(path: Feature) -> dict[str, object]:
    """Triangle of a feature: filled on surface 2, open on surface 1; ridges down, dents up."""
    return {
        "marker": "v" if path.amplitude > 0 else "^",
        "color": "black",
        "markersize": 4.5,
        "markerfacecolor": "black" if path.surface == 2 else "white",
        "linestyle": "none",
    }


def marks_legend(paths: list[Feature]) -> list[Line2D]:
    """One entry for each kind of triangle in the figure."""
    kinds = {(path.word, path.surface): path for path in paths}
    return [Line2D([], [], label=f"{word} of surface {surface}", **mark_look(path)) for (word, surface), path in kinds.items()]


def strip_title(passage: Passage, step: int, feature: Feature | None) -> str:
    """Two lines: time, and where the followed feature is."""
    if feature is None:
        return passage.title(step)
    place = round(feature.centre(passage.time[step]), 2)
    axis = passage.x_axis
    where = axis.number(place, 1.0) if axis.unit else f"{place + 0.0:g}".replace("-", "\u2212")
    return f"{passage.title(step)}\n{feature.word} at ${axis.symbol}$ = {where}"


def draw_history(result: Result, options: argparse.Namespace) -> list[Path]:
    """Left load, radius and speeds over time, right film, pressure with that of Hertz, and friction.

    Asperities have the place of the radius, and their part of the friction; of points rolling friction has that place.
    """
    series = result.transient
    t_axis, time = series["time"].axis(options.si), series["time"].values
    figure, axes = style.new_figure(style.TWO_COLUMNS, 110, nrows=3, ncols=2, sharex=True)
    is_point = "load" in series
    speeds, load = [series[f"speed_{i}"].values for i in (1, 2)], series["load" if is_point else "load_per_length"]
    radius = series["rolling_friction_coefficient" if is_point else "reduced_radius"]
    hertz = np.cbrt(load.values) if is_point else np.sqrt(load.values / radius.values)
    second = series.get("asperity_load_share", radius)
    names = ("", "Rolling friction" if is_point else "", "Speed", "Film", "Pressure")
    rows = (
        ((load, "", load.values),),
        ((second, "", second.values * (second.si_scale if is_point else 1.0)),),
        (
            (series["speed_1"], "mean", (speeds[0] + speeds[1]) / 2),
            (series["speed_1"], "sliding, $u_2 - u_1$", speeds[1] - speeds[0]),
        ),
        ((series["h_min"], "smallest", series["h_min"].values), (series["h_central"], "central", series["h_central"].values)),
        ((series["p_max"], "largest", series["p_max"].values), (series["p_max"], "Hertz", hertz)),
    )
    for panel, curves, name in zip(axes.T.flat, rows, names, strict=False):
        axis = replace(curves[0][0], largest=max(np.nanmax(np.abs(values)) for *_, values in curves)).axis(options.si)
        for (_, label, values), look in zip(curves, style.SERIES, strict=False):
            panel.plot(time * t_axis.factor, values * axis.factor, label=label, **{**look, "marker": ""})
        panel.set(ylabel=f"{name} [{axis.unit or '-'}]" if name else axis.plain_label)
        if len(curves) > 1:
            panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=2, borderpad=0.1)
        if name not in ("Speed", "Pressure") and panel.dataLim.y0 >= 0:
            panel.set_ylim(0, 1.05 * panel.dataLim.y1)
    parts = ("friction_coefficient", "sum"), ("friction_coefficient_oil", "oil"), ("friction_coefficient_boundary", "asperities")
    for (name, label), look in zip(parts, style.SERIES, strict=False):
        if name in series:
            values = series[name].values * series[name].si_scale
            axes[2, 1].plot(time * t_axis.factor, values, label=label, **{**look, "marker": ""})
    if len(axes[2, 1].lines) > 1:
        axes[2, 1].legend(loc="lower center", bbox_to_anchor=(0.5, 1), ncols=3, borderpad=0.1)
    axes[2, 1].set(ylabel="Friction [-]")
    for panel in axes[2]:
        panel.set(xlabel=t_axis.label, xlim=time[[0, -1]] * t_axis.factor)
        style.few_ticks(panel)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "history"))


def draw_passage(result: Result, options: argparse.Namespace) -> list[Path]:
    """Animation of film and pressure over all stored profiles."""
    target = passage_target(options, result)
    passage = Passage(result, options)
    figure, axes = style.new_figure(1.3 * style.ONE_COLUMN, 95, nrows=2, sharex=True)
    passage.set_axes(axes)
    axes[1].set_xlabel(passage.x_axis.label)
    lines = [
        panel.plot(passage.x, values[0], color=colour)[0] for panel, (values, _, colour, _) in zip(axes, passage.rows, strict=True)
    ]
    title = axes[0].set_title(passage.title(-1))
    style.legend_below(figure, [axes[0].lines[0], *marks_legend(passage.paths)], 2)
    style.mark_not_converged(figure, [result])
    figure.canvas.draw()
    figure.set_layout_engine("none")
    marks: list[Line2D] = []
    writer = PillowWriter(fps=options.frames_per_second)
    with writer.saving(figure, str(target), dpi=130):
        for step in np.unique(np.linspace(0, passage.time.size - 1, options.frames).astype(int)):
            title.set_text(passage.title(step))
            for line, (values, _, _, _) in zip(lines, passage.rows, strict=True):
                line.set_ydata(values[step])
            while marks:
                marks.pop().remove()
            for panel in axes:
                for path, place in passage.places(step):
                    marks += panel.plot(place, 0.96, transform=panel.get_xaxis_transform(), **mark_look(path))
            writer.grab_frame()
    style.plt.close(figure)
    return [target]


def passage_target(options: argparse.Namespace, result: Result) -> Path:
    """Name of the animation."""
    output = Path(options.output)
    if output.suffix == ".gif":
        output.parent.mkdir(parents=True, exist_ok=True)
        return output
    output.mkdir(parents=True, exist_ok=True)
    return output / f"{result.stem}_passage.gif"


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, draws the parts asked for, returns the names of the figures."""
    result = read_result(path, options.si, with_transient=True)
    if result.profile_time.values.size < 2:
        raise ResultError(f"{path}: only profiles of T = 0: no time step was completed, or profile_stride is too long")
    figure_command.warn_not_converged(PROGRAM, result)
    if not result.has_history and options.parts == ["history"]:
        raise ResultError(f"{path}: load, radius and speeds are constant, this figure needs &history")
    keep_last_cycle(result)
    drawers = {"xt": draw_xt, "film_strip": draw_film_strip, "history": draw_history, "passage": draw_passage}
    parts = [part for part in options.parts if part != "history" or result.has_history]
    return [target for part in parts for target in drawers[part](result, options)]


def keep_last_cycle(result: Result) -> None:
    """Cuts off what lies before the last cycle of a periodic history."""
    is_kept = {
        time.values.size: time.values >= result.cycle_from * (1 - 1e-9) for time in (result.transient["time"], result.profile_time)
    }
    for name, quantity in result.transient.items():
        if name != "x" and result.cycle_from > 0:
            result.transient[name] = replace(quantity, values=quantity.values[is_kept[len(quantity.values)]])


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    figure_command.add_window(parser)
    parser.add_argument(
        "--parts",
        nargs="+",
        choices=PARTS,
        default=[part for part in PARTS if part != "passage"],
        metavar="PART",
        help="what to draw: xt, film_strip, history, passage (default: all but passage, an animation that takes some ten seconds)",
    )
    parser.add_argument(
        "--centres",
        nargs="+",
        type=float,
        default=list(STRIP_CENTRES),
        metavar="X",
        help="places of the feature in the film strip, in half-widths (default: -1 -0.5 0 0.5 1)",
    )
    parser.add_argument("--frames", type=int, default=60, metavar="N", help="frames of the animation (60)")
    parser.add_argument("--frames-per-second", type=int, default=10, metavar="N", help="frames per second of the animation (10)")
    options = parser.parse_args(arguments)
    if options.frames < 2 or options.frames_per_second < 1:
        parser.error("--frames must be at least 2 and --frames-per-second at least 1")
    ending = Path(options.output).suffix[1:]
    if len(options.parts) > 1 and ending in (*figure_command.FORMATS, "gif"):
        parser.error("--output is a file name: choose one part with --parts, or give a folder")
    return figure_command.run(parser, options, draw, ("solution", "transient"))


if __name__ == "__main__":
    sys.exit(main())

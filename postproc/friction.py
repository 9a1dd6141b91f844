#!/usr/bin/env python3
"""Draws shear stresses, pressure and film over X, the velocity across the film, and friction and power of a passage over time."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import NamedTuple

import figure_command
import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from result_file import Quantity, Result, ResultError, opened, read_result, values_of

PROGRAM = "friction.py"
EXAMPLE = "python postproc/friction.py results/case1.h5 --output results --si"
STRESSES = {
    "shear_stress_1": (r"$\tau$, wall 1", style.SERIES[1]),
    "shear_stress_mean": (r"$\tau$, mean", style.SERIES[0]),
    "shear_stress_2": (r"$\tau$, wall 2", style.SERIES[2]),
}
# Where velocity profiles are shown, in half-widths: in front of the contact, at its inlet and middle, close to the exit.
PLACES = (-1.2, -0.9, 0.0, 0.9)


CONTACT = ("pressure", "film_thickness")
# What is drawn over time: names in /transient, of sliding and of rolling.
OVER_TIME = {
    "Friction": ("friction_coefficient", "rolling_friction_coefficient"),
    "Power": ("sliding_power", "rolling_power"),
}
PARTS = ("sliding", "rolling")


class Friction(NamedTuple):
    """What a result says of its friction."""

    #: Time of the curves over X; None: steady.
    time: float | None
    #: Pressure and film at that time, as in /solution, and the stresses (nx).
    contact: dict[str, Quantity]
    stresses: dict[str, Quantity]
    #: Friction coefficient of sliding and of rolling, each with its error (NaN: not estimated); None: not known.
    sliding: tuple[float, float] | None
    rolling: tuple[float, float]
    #: u (nx, layers + 1) at zeta (layers + 1), if stored of that time.
    velocity: Quantity | None
    zeta: np.ndarray


def read_friction(path: Path, result: Result, time: float | None = None) -> Friction:
    """The part of a lubricated result that profile.py does not draw, at the time stored nearest to `time`; without it, the last."""
    with opened(path) as file:
        try:
            summary = file["summary"]
            rolling = with_error(summary["rolling_friction_coefficient"])
        except KeyError as error:
            raise ResultError(f"{path}: has no friction: {' '.join(str(error).split())}") from None
        sliding = with_error(summary["friction_coefficient"]) if "friction_coefficient" in summary else None
        group, step, found = "solution", ..., result.last_time
        if time is not None:
            step = int(np.argmin(np.abs(result.profile_time.values - time)))
            group, found = "transient", float(result.profile_time.values[step])
        fields = file[group]
        stresses = {name: quantity(fields[name], name, step) for name in STRESSES if name in fields}
        if time is not None and not (stresses and all(name in fields for name in CONTACT)):
            names = ", ".join((*CONTACT, *STRESSES))
            raise ResultError(f"{path}: has no stresses or no contact of that time; &output fields = {names} stores them")
        if not stresses:
            raise ResultError(f"{path}: has no shear stresses (by &moes the speeds of the surfaces are not known)")
        contact = {name: quantity(fields[name], name, step) for name in CONTACT}
        if "velocity" not in file or found != result.last_time:
            return Friction(found, contact, stresses, sliding, rolling, None, np.empty(0))
        velocity = quantity(file["velocity/u"], "velocity")
        zeta = np.asarray(values_of(file["velocity/zeta"]), dtype=float)
        return Friction(found, contact, stresses, sliding, rolling, velocity, zeta)


def quantity(dataset: object, name: str, step: object = ...) -> Quantity:
    """A field with its unit, or of a field over time that of one step."""
    units = dataset.attrs["si_units"]
    text = units.decode() if isinstance(units, bytes) else str(units)
    return Quantity(name, np.asarray(values_of(dataset)[step], dtype=float), text, float(dataset.attrs["si_scale"]))


def with_error(dataset: object) -> tuple[float, float]:
    """A number of /summary and its error estimate."""
    return float(dataset[()]), float(dataset.attrs["error_estimate"])


def in_words(value: tuple[float, float] | None) -> str:
    """A coefficient with its error bar."""
    if value is None:
        return "not known"
    number, error = value
    if error == 0:
        return f"{number:.4g}"
    if math.isnan(error):
        return f"{number:.4g} (error not estimated)"
    decimals = max(0, 1 - math.floor(math.log10(error)))
    return rf"{number:.{decimals}f} $\pm$ {error:.{decimals}f}"


def caption(friction: Friction, result: Result, si: bool = False) -> str:
    """Both friction coefficients; in time the largest of the times that count, and the time of the curves."""
    when = ""
    if friction.time is not None:
        axis = result.transient["time"].axis(si)
        when = f" (largest in time; curves over ${result.solution['x'].axis(si).symbol}$:"
        when += f" ${axis.symbol}$ = {axis.number(friction.time)})"
    return f"friction coefficient{when}: sliding {in_words(friction.sliding)}, rolling {in_words(friction.rolling)}"


def draw_contact(axes: Axes, result: Result, friction: Friction, si: bool) -> list:
    """Pressure and film; returns their lines."""
    p_axis, h_axis = (friction.contact[name].axis(si) for name in ("pressure", "film_thickness"))
    x = result.x * result.solution["x"].axis(si).factor
    pressure, film = (friction.contact[name].values for name in ("pressure", "film_thickness"))
    twin = axes.twinx()
    lines = axes.plot(x, pressure * p_axis.factor, label="pressure", **style.PRESSURE)
    lines += twin.plot(x, film * h_axis.factor, label="film", **style.FILM)
    axes.set(ylabel=p_axis.label)
    axes.set_ylim(0, 1.08 * np.nanmax(pressure) * p_axis.factor)
    twin.set_ylabel(h_axis.label)
    twin.set_ylim(0, style.film_limit(film, pressure) * h_axis.factor)
    axes.tick_params(right=False)
    twin.tick_params(left=False)
    return lines


def draw_stresses(axes: Axes, result: Result, friction: Friction, si: bool) -> list:
    """The stress at both walls and its mean; returns their lines."""
    x = result.x * result.solution["x"].axis(si).factor
    factor = next(iter(friction.stresses.values())).si_scale / 1e6 if si else 1.0
    unit = r"$\tau$ [MPa]" if si else r"$\tau R/(p_\mathrm{h} b)$ [-]"
    lines = []
    for name, field in friction.stresses.items():
        words, look = STRESSES[name]
        kept = {key: value for key, value in look.items() if key != "marker"}
        lines += axes.plot(x, field.values * factor, label=words, **kept)
    axes.axhline(0, color="0.7", linewidth=0.5, zorder=0)
    axes.set(ylabel=f"Shear stress {unit}")
    return lines


def draw_velocity(axes: Axes, result: Result, friction: Friction, si: bool) -> None:
    """Velocity across the film at some places, each with its own zero line."""
    field = friction.velocity
    factor = field.si_scale if si else 1.0
    x_axis = result.solution["x"].axis(si)
    for place, look in zip(PLACES, style.SERIES, strict=False):
        node = int(np.argmin(np.abs(result.x - place)))
        marks = {"markevery": max(friction.zeta.size // 6, 1), "markersize": 3}
        label = f"${x_axis.symbol}$ = {x_axis.number(result.x[node])}"
        axes.plot(field.values[node] * factor, friction.zeta, label=label, **look, **marks)
    axes.set(ylabel=r"Across the film $\zeta = z/h$ [-]", ylim=(0, 1))
    axes.set_xlabel(r"Velocity $u$ [m/s]" if si else r"Velocity $u/u_\mathrm{s}$ [-]")
    axes.legend(loc="best", fontsize=7.5)


def has_times(result: Result) -> bool:
    """Whether friction and power of every step are there; files of older versions have friction of sliding only."""
    return all(name in result.transient for names in OVER_TIME.values() for name in names)


def draw_times(rows: list[list[Axes]], result: Result, friction: Friction, si: bool) -> None:
    """Friction above, power below, sliding on the left, rolling on the right, over time; and the time of the curves over X."""
    t_axis = result.transient["time"].axis(si)
    time = result.transient["time"].values * t_axis.factor
    for row, (words, names) in zip(rows, OVER_TIME.items(), strict=True):
        for panel, name, part in zip(row, names, PARTS, strict=True):
            values = result.transient[name]
            # a friction coefficient has no unit, and is the same in both
            factor = values.si_scale if si or words != "Power" else 1.0
            panel.plot(time, values.values * factor, color="black")
            unit = "[-]"
            if words == "Power":
                unit = "[W/m]" if si else r"$/(p_\mathrm{h} b^2 u_\mathrm{s}/R)$ [-]"
            panel.set(xlabel=t_axis.label, ylabel=f"{words} {unit}", title=part, xlim=(time[0], time[-1]))
            panel.margins(y=0.12)
            panel.axvline(friction.time * t_axis.factor, color="0.7", linewidth=0.8, zorder=0)
            style.few_ticks(panel)


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, draws it, returns the names of the figures.

    The curves over X below each other, the velocity across the film on their right; in time without it the curves beside each
    other; friction and power over time in two rows below.
    """
    result = read_result(path, options.si)
    friction = read_friction(path, result, options.time)
    figure_command.warn_not_converged(PROGRAM, result)
    has_velocity, is_passage = friction.velocity is not None, has_times(result)
    width, columns = (style.TWO_COLUMNS, 2) if has_velocity or is_passage else (style.ONE_COLUMN, 1)
    rows = 2 * is_passage + (1 if is_passage and not has_velocity else 2)
    figure, axes = style.new_figure(width, 50 * rows, nrows=rows, ncols=columns, squeeze=False)
    over_x = axes[:2, 0] if has_velocity or not is_passage else axes[0]
    lines = draw_contact(over_x[0], result, friction, options.si)
    lines += draw_stresses(over_x[1], result, friction, options.si)
    if is_passage:
        draw_times(axes[-2:], result, friction, options.si)
    x_axis = result.solution["x"].axis(options.si)
    left, right = style.x_window(result, options.window)
    for one in over_x:
        one.set_xlim(left * x_axis.factor, right * x_axis.factor)
        style.few_ticks(one)
        one.set_xlabel(x_axis.label)
    if has_velocity:
        grid = axes[0, 1].get_gridspec()
        for one in axes[:2, 1]:
            one.remove()
        draw_velocity(figure.add_subplot(grid[:2, 1]), result, friction, options.si)
    words = caption(friction, result, options.si)
    if columns == 1:
        words = words.replace("sliding", "\nsliding").replace(", rolling", ",\nrolling")
    axes[0, 0].set_title(words, fontsize=8, loc="left").set_in_layout(columns == 1)
    style.legend_below(figure, lines, 3 if columns == 1 else len(lines))
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "friction"))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    figure_command.add_window(parser)
    figure_command.add_time(parser)
    options = parser.parse_args(arguments)
    return figure_command.run(parser, options, draw, figure_command.groups_of_time(options))


if __name__ == "__main__":
    sys.exit(main())

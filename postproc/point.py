#!/usr/bin/env python3
"""Draws a lubricated point contact: interferogram, map of the film, film and pressure along and across the flow.

Of a passage also a strip: the film, and cuts along y = 0, where a feature enters, passes and leaves the contact; of a history
load, speeds, film, pressure and friction over time.

The interferogram is what a camera sees through a glass disc, by light of three wavelengths and without loss of contrast
(R. Gohar and A. Cameron, Nature 200, 1963, 458). Dimensionless results (&moes) have a map of the pressure in its place.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import figure_command
import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from result_file import Axis, Result, inputs_of, opened, read_result
from transient import STRIP_CENTRES, draw_history, strip_steps

PROGRAM = "point.py"
EXAMPLE = "python postproc/point.py results/ball.h5 --output results"
WAVELENGTHS = np.array([630e-9, 530e-9, 460e-9])  # red, green, blue [m]
REFRACTION = 1.5  # of the oil
# What is shown, in half-widths of the ellipse: in front of it, behind it, to each side; pixels along each direction.
ROOM = (1.5, 1.35, 1.4)
PIXELS = 400
WIDE = 1.6  # films are shown up to so many times that at the centre
SLENDER = 2.5  # a longer window is not drawn to scale
HERTZ = {"color": style.PRESSURE["color"], "linestyle": "--", "linewidth": 0.8}
ELLIPSE = {"colors": "#ff6a3d", "linewidths": 0.7}


@dataclass
class Contact:
    """A result, and how Hertz's ellipse lies: its half-axes in the unit of x, and its turn against the flow [rad]."""

    result: Result
    ellipticity: float
    angle: float

    def field(self, name: str, x: np.ndarray, y: np.ndarray, step: int | None = None) -> np.ndarray:
        """Stored values at x (n) and y (m), linear between the nodes: (m, n); of the last time, or of a stored `step`."""
        nodes = self.result.solution
        values = nodes[name].values if step is None else self.result.transient[name].values[step]
        along = [np.interp(x, nodes["x"].values, row) for row in values]
        return np.array([np.interp(y, nodes["y"].values, column) for column in np.transpose(along)]).T

    def squared_radius(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """1 on the ellipse; x (n) and y (m) stored positions."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        return (c * x - s * y[:, None]) ** 2 + ((s * x + c * y[:, None]) / self.ellipticity) ** 2

    def window(self) -> tuple[np.ndarray, np.ndarray]:
        """Positions of the pixels: the ellipse with room around it, as far as it is computed."""
        c, s, nodes = np.cos(self.angle), np.sin(self.angle), self.result.solution
        x = np.hypot(c, self.ellipticity * s) * np.array([-ROOM[0], ROOM[1]])
        y = np.hypot(s, self.ellipticity * c) * np.array([-ROOM[2], ROOM[2]])
        ends = zip((x, y), (nodes["x"].values, nodes["y"].values), strict=True)
        return tuple(np.linspace(*np.clip(end, own[0], own[-1]), PIXELS) for end, own in ends)

    def axis(self, name: str) -> Axis:
        """Factor and label of a dataset, in SI if it has that."""
        quantity = self.result.solution[name]
        largest = WIDE * self.field(name, np.zeros(1), np.zeros(1)).item() if name == "film_thickness" else None
        return replace(quantity, largest=largest).axis(quantity.has_si)


def read_contact(path: Path) -> Contact:
    """Reads a result; ResultError if it is not one of a lubricated point contact."""
    with opened(path) as file:
        has_fields = "transient/film_thickness" in file
    result = read_result(path, with_transient=has_fields, problem="ehl_point")
    with opened(path) as file:
        angle = float(inputs_of(file, "bodies").get("entrainment_angle", 0.0))
        return Contact(result, float(file["scaling"].attrs["ellipticity"]), np.radians(angle))


def colours(film: np.ndarray) -> np.ndarray:
    """Red, green and blue, 0 to 1, of a film [m]."""
    return (1 + np.cos(4 * np.pi * REFRACTION * film[..., None] / WAVELENGTHS)) / 2


def draw_map(panel: Axes, contact: Contact, name: str, is_light: bool = False) -> None:
    """A field with contours, or the light that it lets interfere, and the ellipse."""
    x, y = contact.window()
    values, axis, axes = contact.field(name, x, y), contact.axis(name), (contact.axis("x"), contact.axis("y"))
    px, py, radius = x * axes[0].factor, y * axes[1].factor, contact.squared_radius(x, y)
    look = {"origin": "lower", "extent": (px[0], px[-1], py[0], py[-1]), "aspect": "auto"}
    if is_light:
        panel.imshow(colours(values * contact.result.solution[name].si_scale), **look)
        panel.set_title("Light of 630, 530, 460 nm")
    else:
        shown = values * axis.factor
        top = min(shown.max(), WIDE * contact.field(name, np.zeros(1), np.zeros(1)).item() * axis.factor)
        image = panel.imshow(shown, cmap=style.COLOUR_MAP, vmax=top, **look)
        panel.figure.colorbar(image, ax=panel, label=axis.plain_label, extend="max" if top < shown.max() else "neither")
        levels = MaxNLocator(10).tick_values(shown.min(), top)[1:-1]
        lines = np.where(radius < 1, shown, np.nan)
        panel.clabel(panel.contour(px, py, lines, levels, colors="white", linewidths=0.5), fontsize=6)
    panel.contour(px, py, radius, [1.0], **ELLIPSE | ({"colors": "white"} if is_light else {}))
    panel.set(xlabel=f"{axes[0].plain_label}, flow to the right", ylabel=axes[1].plain_label)
    if 1 / SLENDER < np.ptp(y) / np.ptp(x) < SLENDER:
        panel.set_aspect("equal")
    else:
        panel.set_ylabel(f"{axes[1].plain_label}, not to scale")


def draw_cut(panel: Axes, contact: Contact, along: str) -> list:
    """Film, pressure and Hertz pressure on y = 0 or on x = 0; returns their lines."""
    x, y = (pixels if name == along else np.zeros(1) for name, pixels in zip("xy", contact.window(), strict=True))
    axis, p_axis, h_axis = (contact.axis(name) for name in (along, "pressure", "film_thickness"))
    place = (x if along == "x" else y) * axis.factor
    pressure, film = contact.field("pressure", x, y).ravel(), contact.field("film_thickness", x, y).ravel()
    hertz = np.sqrt(np.maximum(1 - contact.squared_radius(x, y).ravel(), 0))
    twin = panel.twinx()
    lines = panel.plot(place, pressure * p_axis.factor, label="pressure", **style.PRESSURE)
    lines += panel.plot(place, hertz * p_axis.factor, label="Hertz", **HERTZ)
    lines += twin.plot(place, film * h_axis.factor, label="film", **style.FILM)
    if along == "y":  # where the film is least along the flow: the horseshoe
        least = contact.field("film_thickness", contact.window()[0], y).min(axis=1)
        lines += twin.plot(place, least * h_axis.factor, label="least film along x", **style.FILM | {"linestyle": ":"})
    panel.set(xlabel=axis.plain_label, ylabel=p_axis.plain_label, title="$y = 0$" if along == "x" else "$x = 0$")
    panel.set(xlim=(place[0], place[-1]), ylim=(0, 1.08 * max(pressure.max(), 1.0) * p_axis.factor))
    twin.set(ylim=(0, style.film_limit(film, pressure) * h_axis.factor), ylabel=h_axis.plain_label)
    panel.tick_params(right=False)
    return lines


def draw_passage(contact: Contact, options: argparse.Namespace) -> list[Path]:
    """Films and cuts of a passage side by side; returns the names of the figure."""
    result = contact.result
    steps, _ = strip_steps(result, list(STRIP_CENTRES))
    rows = {"nrows": 2, "gridspec_kw": {"height_ratios": (0.7, 1)}}
    figure, panels = style.new_figure(style.TWO_COLUMNS, 80, ncols=len(steps), sharex=True, sharey="row", **rows)
    x, y = contact.window()
    axes = {name: contact.axis(name) for name in ("x", "y", "pressure", "film_thickness")}
    px, py, films = x * axes["x"].factor, y * axes["y"].factor, [contact.field("film_thickness", x, y, step) for step in steps]
    inside, factor = contact.squared_radius(x, y) < 1, axes["film_thickness"].factor
    time = result.profile_time.axis(result.profile_time.has_si)
    low, high = (edge(film[inside]) * factor for edge, film in ((np.min, np.array(films).min(0)), (np.max, np.array(films).max(0))))
    for column, step in enumerate(steps):
        upper, lower = panels[:, column]
        image = upper.imshow(
            films[column] * factor, cmap=style.COLOUR_MAP, vmin=low, vmax=high, origin="lower", aspect="auto",
            extent=(px[0], px[-1], py[0], py[-1]),
        )  # fmt: skip
        upper.contour(px, py, contact.squared_radius(x, y), [1.0], **ELLIPSE)
        upper.set_title(f"{result.profile_time.values[step] * time.factor:.3g} {time.unit}".strip())
        cut = [contact.field(name, x, np.zeros(1), step).ravel() for name in ("pressure", "film_thickness")]
        lines = lower.plot(px, cut[0] * axes["pressure"].factor, label="pressure", **style.PRESSURE)
        twin = lower.twinx()
        lines += twin.plot(px, cut[1] * factor, label="film", **style.FILM)
        twin.set_ylim(0, 1.6 * high)
        twin.tick_params(labelright=column == len(steps) - 1)
        lower.set_xlabel(axes["x"].plain_label)
    twin.set_ylabel(axes["film_thickness"].plain_label)
    panels[0, 0].set_ylabel(axes["y"].plain_label)
    panels[1, 0].set_ylabel(axes["pressure"].plain_label)
    figure.colorbar(image, ax=panels[0, :].tolist(), label=axes["film_thickness"].plain_label)
    style.legend_below(figure, lines, 2)
    style.mark_not_converged(figure, [result])
    return style.save_figure(figure, figure_command.targets(options, result.stem, "passage"))


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """The figures of one result; returns their names."""
    contact = read_contact(path)
    figure_command.warn_not_converged(PROGRAM, contact.result)
    passage = draw_passage(contact, options) if "film_thickness" in contact.result.transient else []
    has_si = contact.result.solution["x"].has_si
    if "load" in contact.result.transient:
        passage += draw_history(contact.result, argparse.Namespace(**vars(options) | {"si": has_si}))
    figure, panels = style.new_figure(style.TWO_COLUMNS, 140, nrows=2, ncols=2)
    axis, films = contact.axis("film_thickness"), contact.result.summary
    h_min, h_central = (f"{films[name] / (axis.unit_size or 1):.4g} {axis.unit}".rstrip() for name in ("h_min", "h_central"))
    panels[0, 1].set_title(f"Film: smallest {h_min}, central {h_central}")
    draw_map(panels[0, 0], contact, "film_thickness" if has_si else "pressure", is_light=has_si)
    draw_map(panels[0, 1], contact, "film_thickness")
    draw_cut(panels[1, 0], contact, "x")
    style.legend_below(figure, draw_cut(panels[1, 1], contact, "y"), 4)
    style.mark_not_converged(figure, [contact.result])
    return style.save_figure(figure, figure_command.targets(options, contact.result.stem, "point")) + passage


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    options = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE).parse_args(arguments)
    return max(figure_command.guarded(PROGRAM, draw, Path(name), options) for name in options.results)


if __name__ == "__main__":
    sys.exit(main())

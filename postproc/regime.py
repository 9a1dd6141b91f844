#!/usr/bin/env python3
"""Draws where contacts lie on the chart of Moes: smallest film over M for lines of L, and regimes and films over M and L."""

from __future__ import annotations

import argparse
import csv
import math
import sys
from pathlib import Path
from typing import NamedTuple

import figure_command
import figure_style as style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from result_file import Result, ResultError, opened, read_result

PROGRAM = "regime.py"
EXAMPLE = "python postproc/regime.py results/case1.h5 results/minimal.h5 --output results"
TABLE = Path(__file__).resolve().parent / "data" / "moes_films.csv"
REGIMES = ("rigid, isoviscous", "elastic, isoviscous", "rigid, piezoviscous", "elastic, piezoviscous")
FILMS = (0.5, 1, 2, 3, 5, 8, 12, 20)
# Oils of the left panel that are drawn and named.
DRAWN = (0.0, 2.5, 5.0, 10.0, 20.0, 40.0)
LEAST, LARGEST = 0.3, 40.0
# L at which the lines of equal film are labelled: no words stand there.
LABELLED = 0.4
LINE = {"color": "0.25", "linewidth": 0.9}
ASYMPTOTE = {"color": "0.6", "linewidth": 0.7, "linestyle": (0, (4, 2))}


class Films(NamedTuple):
    """Computed smallest films of the smooth contact, in Moes units with the sum of the speeds: (L, M)."""

    moes_m: np.ndarray
    moes_l: np.ndarray
    h_min: np.ndarray

    def asymptotes(self, moes_m: np.ndarray, moes_l: np.ndarray) -> np.ndarray:
        """The four laws, in the order of REGIMES: exponents by theory, Martin's factor, the others from the ends of the table."""
        martin = 2.4475
        last = {"m": self.moes_m[-1], "l": self.moes_l[-1]}
        soft = self.h_min[0, -1] * last["m"] ** 0.2
        stiff = self.h_min[-1, self._rigid_end()] / last["l"] ** (2 / 3)
        both = self.h_min[-1, -1] * last["m"] ** 0.125 / last["l"] ** 0.75
        one = np.ones_like(moes_m * moes_l)
        return np.stack(
            [
                martin / moes_m * one,
                soft * moes_m**-0.2 * one,
                stiff * moes_l ** (2 / 3) * one,
                both * moes_m**-0.125 * moes_l**0.75 * one,
            ]
        )

    def _rigid_end(self) -> int:
        """Where on the line of the largest L the film depends least on M: there the bodies are rigid, the oil is not."""
        return int(np.argmin(np.abs(np.diff(np.log(self.h_min[-1])))))

    def regime(self, moes_m: np.ndarray, moes_l: np.ndarray) -> np.ndarray:
        """Index in REGIMES: of isoviscous laws the larger film counts, of piezoviscous the smaller, of both the larger."""
        rigid, soft, stiff, both = self.asymptotes(moes_m, moes_l)
        isoviscous = np.where(rigid >= soft, 0, 1)
        piezoviscous = np.where(stiff <= both, 2, 3)
        return np.where(np.maximum(rigid, soft) >= np.minimum(stiff, both), isoviscous, piezoviscous)

    def film(self, moes_m: float, moes_l: float) -> float:
        """The computed film, between the points of the table; NaN outside."""
        lines = [np.interp(math.log(moes_m), np.log(self.moes_m), np.log(row), math.nan, math.nan) for row in self.h_min]
        return float(np.exp(np.interp(math.log1p(moes_l), np.log1p(self.moes_l), lines, math.nan, math.nan)))


class Point(NamedTuple):
    """Where a result lies."""

    result: Result
    moes_m: float
    moes_l: float
    h_min: float


def read_films(path: Path = TABLE) -> Films:
    """The table that `make regime` makes."""
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    columns = {name: np.array([float(row[name]) for row in rows]) for name in ("moes_m", "moes_l", "h_min")}
    moes_m, moes_l = np.unique(columns["moes_m"]), np.unique(columns["moes_l"])
    films = np.empty((moes_l.size, moes_m.size))
    films[np.searchsorted(moes_l, columns["moes_l"]), np.searchsorted(moes_m, columns["moes_m"])] = columns["h_min"]
    return Films(moes_m, moes_l, films)


def is_dry(path: Path) -> bool:
    """Whether a result is that of a dry contact."""
    with opened(path) as file:
        return np.bytes_(file.attrs.get("problem", b"")).startswith(b"dry_")


def read_point(path: Path) -> Point:
    """M, L and the smallest film of a result, in the units of the chart (results have films with the mean of the speeds)."""
    result = read_result(path)
    with opened(path) as file:
        try:
            numbers = [float(np.asarray(file["scaling"].attrs[name]).item()) for name in ("moes_m_sum", "moes_l_sum")]
            film = float(file["summary/h_min_moes"][()]) / math.sqrt(2)
        except KeyError as error:
            raise ResultError(f"{path}: cannot be placed: {' '.join(str(error).split())}") from None
    return Point(result, *numbers, film)


def draw_films(axes: Axes, films: Films) -> None:
    """Smallest film over M for lines of L, with the asymptotes."""
    m = np.geomspace(films.moes_m[0], films.moes_m[-1], 200)
    for oil, row in zip(films.moes_l, films.h_min, strict=True):
        if oil in DRAWN:
            axes.plot(films.moes_m, row, **LINE)
            axes.annotate(f"{oil:g}", (films.moes_m[-1], row[-1]), (3, -3), textcoords="offset points", fontsize=8)
    axes.annotate("$L$", (films.moes_m[-1], films.h_min[-1, -1]), (3, 8), textcoords="offset points", fontsize=8)
    rigid, soft, *_ = films.asymptotes(m, np.zeros_like(m))
    _, _, stiff, both = films.asymptotes(m, np.full_like(m, LARGEST))
    for law in (rigid, soft, stiff, both):
        axes.plot(m, law, **ASYMPTOTE)
    axes.set(xscale="log", yscale="log", xlim=(films.moes_m[0], films.moes_m[-1]), ylim=(0.3, 40))
    axes.set(xlabel="Load parameter $M$ [-]", ylabel=r"Smallest film $(h_\mathrm{min}/R)\,[E'R/(\mu_0 u_\mathrm{s})]^{1/2}$ [-]")


def grid(films: Films, points: int) -> list[np.ndarray]:
    """M and L of the right panel."""
    return np.meshgrid(np.geomspace(films.moes_m[0], films.moes_m[-1], points), np.geomspace(LEAST, LARGEST, points))


def draw_regimes(axes: Axes, films: Films) -> None:
    """Regimes and computed films over M and L."""
    m, oil = grid(films, 120)
    film = np.vectorize(films.film)(m, oil)
    drawn = axes.contour(m, oil, film, levels=FILMS, colors="0.25", linewidths=0.9)
    axes.set(xscale="log", yscale="log", xlim=(films.moes_m[0], films.moes_m[-1]), ylim=(LEAST, LARGEST))
    row = np.abs(oil[:, 0] - LABELLED).argmin()
    places = [(m[row, np.abs(film[row] - level).argmin()], oil[row, 0]) for level in FILMS if level > film[row].min()]
    axes.clabel(drawn, fmt="%g", fontsize=7.5, inline_spacing=1, manual=places)
    m, oil = grid(films, 900)
    regime = films.regime(m, oil)
    axes.contour(m, oil, regime, levels=[0.5, 1.5, 2.5], colors="0.6", linewidths=0.7, linestyles="dashed")
    for i, words in enumerate(REGIMES):
        inside = regime == i
        if inside.any():
            place = (np.exp(np.log(m[inside]).mean()), np.exp(np.log(oil[inside]).mean()))
            box = {"facecolor": "white", "edgecolor": "none", "pad": 1.5}
            axes.annotate(words.replace(", ", "\n"), place, ha="center", va="center", fontsize=8, bbox=box, zorder=3)
    axes.set(xlabel="Load parameter $M$ [-]", ylabel="Viscosity parameter $L$ [-]")


def look_of(i: int) -> dict[str, str]:
    """Colour and marker of the i-th result: other pairs of them where all colours have been used."""
    count = len(style.SERIES)
    return {"color": style.SERIES[i % count]["color"], "marker": style.SERIES[(i + i // count) % count]["marker"]}


def describe(films: Films, point: Point) -> str:
    """One line about a result: where it lies, and its film beside that of the smooth contact."""
    smooth = films.film(point.moes_m, point.moes_l)
    where = REGIMES[int(films.regime(np.array(point.moes_m), np.array(point.moes_l)))]
    words = f"{point.result.stem}: M {point.moes_m:.4g}, L {point.moes_l:.4g} (speed sum): {where}; film {point.h_min:.4g}"
    if math.isnan(smooth):
        return f"{words}, outside the table"
    return f"{words}, smooth Barus contact {smooth:.4g} ({100 * (point.h_min / smooth - 1):+.1f} %)"


def draw(options: argparse.Namespace) -> list[Path]:
    """All results in one figure; returns its names."""
    films = read_films()
    dry = [name for name in options.results if is_dry(Path(name))]
    for name in dry:
        print(f"{Path(name).stem}: dry, without a film: it lies nowhere on the chart of Moes")
    points = [read_point(Path(name)) for name in options.results if name not in dry]
    if not points:
        return []
    figure, (left, right) = style.new_figure(style.TWO_COLUMNS, 82, ncols=2)
    draw_films(left, films)
    draw_regimes(right, films)
    handles = []
    for i, point in enumerate(points):
        figure_command.warn_not_converged(PROGRAM, point.result)
        print(describe(films, point))
        mark = {**look_of(i), "linestyle": "none", "markersize": 6, "zorder": 5}
        left.plot(point.moes_m, point.h_min, **mark)
        place = (np.clip(point.moes_m, films.moes_m[0], films.moes_m[-1]), np.clip(point.moes_l, LEAST, LARGEST))
        right.plot(*place, clip_on=False, **mark)
        words = style.literal(point.result.stem)
        if place != (point.moes_m, point.moes_l):
            words += f" (outside: $M$ {point.moes_m:.3g}, $L$ {point.moes_l:.2g})"
        handles.append(Line2D([], [], label=words, **mark))
    handles += [
        Line2D([], [], label="computed, smooth contact", **LINE),
        Line2D([], [], label=f"asymptotes ($L$ = 0, {LARGEST:g}), where they meet", **ASYMPTOTE),
    ]
    style.legend_below(figure, handles, 3)
    style.mark_not_converged(figure, [point.result for point in points])
    style.hide_covered(figure)
    return style.save_figure(figure, figure_command.targets(options, points[0].result.stem, "regime"))


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    options = parser.parse_args(arguments)
    return figure_command.guarded(parser.prog, draw, options)


if __name__ == "__main__":
    sys.exit(main())

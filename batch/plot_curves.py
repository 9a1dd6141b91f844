"""Curves of a gathered table: quantities over a parameter, a family by colour, a panel for each value of another one."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from case_folder import ROOT
from gathered import Gathered, short_words, words_of
from sweep_file import SweepError

sys.path.append(str(ROOT / "postproc"))

import figure_style as style

FAILURE = "#b30000"
MOST_PANELS = 12
MOST_FAMILY = 40
# Of cases at one x: this share of them lies in the band.
QUANTILES = (0.1, 0.9)
# Longest names along an axis, in characters.
LONGEST_LABEL = 36
# Most names below each other along an axis.
MOST_LINES = 3
# Factor between the values and the end of a logarithmic axis.
ROOM = 1.6


@dataclass(frozen=True)
class Wish:
    """What to draw: names of columns; which axes are logarithmic; marks without lines."""

    x: str
    y: tuple[str, ...]
    colour: str | None = None
    facet: str | None = None
    log: tuple[str, ...] = ()
    points: bool = False
    kind: str = "curves"
    regimes: bool = False


def draw_curves(table: Gathered, wish: Wish) -> object:
    """The figure: a column of panels for each facet, a row for each unit among the quantities."""
    facets = panels_of(table, wish)
    rows = [list(names) for names in rows_of(table, wish)]
    width = style.ONE_COLUMN if len(facets) == 1 else style.TWO_COLUMNS
    height = (62 if len(facets) < 3 else 52) * len(rows) + 12
    figure, axes = style.new_figure(width, height, nrows=len(rows), ncols=len(facets), squeeze=False, sharex=True, sharey="row")
    for panel, (words, _) in zip(axes[0], facets, strict=True):
        panel.set_title(style.literal(words))
    for row, names in zip(axes, rows, strict=True):
        for panel, (_, chosen) in zip(row, facets, strict=True):
            handles = draw_panel(panel, table, wish, names, chosen)
        row[0].set_ylabel(style.literal(label_of(table, names)))
    for panel in axes[-1]:
        panel.set_xlabel(style.literal(table.axis(wish.x).label))
    if table.title:
        figure.suptitle(style.literal(table.title), fontsize=9)
    finish(figure, axes, table, wish, handles)
    return figure


def rows_of(table: Gathered, wish: Wish) -> list[list[str]]:
    """Quantities of one unit share a panel, if colour does not tell something else."""
    if wish.colour:
        return [[name] for name in wish.y]
    units: dict[str, list[str]] = {}
    for name in wish.y:
        table.numbers(name)
        units.setdefault(table.units.get(name, ""), []).append(name)
    return list(units.values())


def label_of(table: Gathered, names: list[str]) -> str:
    """Names and unit of quantities that share an axis, long ones below each other; of many the unit alone: the legend has them."""
    axis = table.axis(largest(table, names))
    words = common_words(names) or ", ".join(names)
    if len(words) > LONGEST_LABEL:
        words = ",\n".join(names) if len(names) <= MOST_LINES else ""
    return axis.label if len(names) == 1 else f"{words} [{axis.unit}]".strip()


def common_words(names: list[str]) -> str:
    """The words with which all quantities end, as `Film thickness`; empty if they have none in common."""
    ends = zip(*(reversed(short_words(name).lower().split()) for name in names), strict=False)
    return " ".join([words[0] for words in itertools.takewhile(lambda words: len(set(words)) == 1, ends)][::-1]).capitalize()


def largest(table: Gathered, names: list[str]) -> str:
    """The quantity with the largest value, whose unit all of them have."""
    return max(names, key=lambda name: np.nanmax(np.abs(np.append(table.numbers(name), 0.0))))


def panels_of(table: Gathered, wish: Wish) -> list[tuple[str, np.ndarray]]:
    """Title and rows of each panel."""
    if not wish.facet:
        return [("", np.ones(len(table.columns["case"]), dtype=bool))]
    levels = table.levels(wish.facet)
    if len(levels) > MOST_PANELS:
        raise SweepError(f"{table.path}: {wish.facet} has {len(levels)} values, expected at most {MOST_PANELS} panels")
    return [(value_words(table, wish.facet, level), table.columns[wish.facet] == level) for level in levels]


def value_words(table: Gathered, name: str, value: object) -> str:
    """`name = value unit`."""
    if isinstance(value, str):
        return f"{words_of(name)} = {value}"
    axis = table.axis(name)
    return f"{axis.words} = {value / axis.size:.4g} {axis.unit.replace('-', '')}".strip()


def series_of(table: Gathered, wish: Wish, names: list[str]) -> Iterator[tuple[str, str, np.ndarray, dict[str, object]]]:
    """Quantity, label, rows and look of each series."""
    everything = np.ones(len(table.columns["case"]), dtype=bool)
    if not wish.colour:
        for name, look in zip(names, style.SERIES * 2, strict=False):
            yield name, words_of(name), everything, look
        return
    levels = table.levels(wish.colour)
    if len(levels) > MOST_FAMILY:
        raise SweepError(
            f"{table.path}: {wish.colour} has {len(levels)} values, expected at most {MOST_FAMILY} curves (or --kind map)"
        )
    for i, level in enumerate(levels):
        look = style.SERIES[i] if len(levels) <= len(style.SERIES) else family_look(i / (len(levels) - 1))
        yield names[0], value_words(table, wish.colour, level), table.columns[wish.colour] == level, look


def family_look(share: float) -> dict[str, object]:
    """One curve of many: a colour of the map, no mark of its own."""
    return {"color": family_colours()(share), "linestyle": "-", "marker": "."}


def family_colours() -> object:
    """The colour map without its lightest end, which paper does not show."""
    colours = style.plt.get_cmap(style.COLOUR_MAP)(np.linspace(0, 0.92, 256))
    return style.plt.matplotlib.colors.ListedColormap(colours)


def draw_panel(panel: object, table: Gathered, wish: Wish, names: list[str], chosen: np.ndarray) -> list:
    """All series of one panel; returns what the legend shows."""
    x_axis, y_axis = table.axis(wish.x), table.axis(largest(table, names))
    handles = []
    x = table.numbers(wish.x) / x_axis.size
    for name, label, rows, look in series_of(table, wish, names):
        y = table.numbers(name) / y_axis.size
        errors = table.errors(name)
        here = chosen & rows & np.isfinite(y) & np.isfinite(x)
        good, bad = here & table.is_done, here & table.is_unconverged
        half = None if errors is None else errors / y_axis.size
        handles.append(
            draw_series(panel, x[good], y[good], None if half is None else half[good], style.literal(label), look, wish.points)
        )
        panel.plot(x[bad], y[bad], "o", markersize=6, markerfacecolor="none", markeredgecolor=FAILURE, linestyle="none", zorder=6)
    lost = chosen & table.is_missing & np.isfinite(x)
    if lost.any():
        places = panel.get_xaxis_transform()
        panel.plot(x[lost], np.full(lost.sum(), 0.02), "x", color=FAILURE, markersize=5, transform=places, zorder=6)
    for axis in wish.log:
        if axis in ("x", "y"):
            getattr(panel, f"set_{axis}scale")("log")
    shown = np.concatenate([table.numbers(name)[~table.is_missing] for name in names]) / y_axis.size
    if "y" in wish.log and (positive := shown[shown > 0]).size:
        panel.set_ylim(positive.min() / ROOM, positive.max() * ROOM)  # an error bar that reaches zero has no end there
    return handles


def draw_series(
    panel: object, x: np.ndarray, y: np.ndarray, half: np.ndarray | None, label: str, look: dict[str, object], points: bool
) -> object:
    """One series with its error bars; of several cases at one x the median, with a band, and the cases as dots."""
    order = np.argsort(x, kind="stable")
    x, y = x[order], y[order]
    places = np.unique(x)
    if points or places.size == x.size:
        half = None if half is None else np.where(np.isfinite(half[order]), half[order], 0.0)
        shown = {**look, "linestyle": "none"} if points else look
        bars = panel.errorbar(x, y, half, label=label, capsize=0 if look["marker"] == "." else 2, elinewidth=0.7, **shown)
        for part in (*bars[1], *bars[2]):
            part.set_in_layout(False)
        return bars
    groups = [y[x == place] for place in places]
    low, high = np.array([np.quantile(group, QUANTILES) for group in groups]).T
    panel.fill_between(places, low, high, color=look["color"], alpha=0.15, linewidth=0)
    panel.plot(x, y, ".", color=look["color"], markersize=2, alpha=0.5)
    return panel.plot(places, [np.median(group) for group in groups], label=label, **look)[0]


def finish(figure: object, axes: np.ndarray, table: Gathered, wish: Wish, handles: list) -> None:
    """Colour bar or legend, with entries for what went wrong."""
    marks = failure_marks(table)
    many = wish.colour and len(handles) > len(style.SERIES)
    if many:
        scale = style.plt.cm.ScalarMappable(style.plt.Normalize(0, 1), family_colours())
        levels = table.levels(wish.colour)
        chosen = sorted({0, len(levels) // 2, len(levels) - 1})
        bar = figure.colorbar(scale, ax=axes, ticks=[i / (len(levels) - 1) for i in chosen])
        bar.ax.set_yticklabels([value_words(table, wish.colour, levels[i]).partition("= ")[2] for i in chosen])
        bar.set_label(style.literal(words_of(wish.colour)))
    shown = marks if many else [*handles, *marks]
    if shown and (len(shown) > 1 or many):
        longest = max(len(handle.get_label()) for handle in shown)
        room = 52 if figure.get_figwidth() < 1.5 * style.ONE_COLUMN else 104
        style.legend_below(figure, shown, max(1, min(len(shown), room // (longest + 8))))


def failure_marks(table: Gathered) -> list:
    """Entries of the legend for cases that did not converge, or have no result."""
    marks = []
    for rows, words, mark, face in (
        (table.is_unconverged, ", ".join(sorted(set(table.columns["status"][table.is_unconverged]))), "o", "none"),
        (table.is_missing, "no result", "x", FAILURE),
    ):
        if rows.any():
            look = {"marker": mark, "markerfacecolor": face, "markeredgecolor": FAILURE, "linestyle": "none", "markersize": 5}
            marks.append(style.plt.Line2D([], [], color=FAILURE, label=f"{words} ({rows.sum()})", **look))
    return marks

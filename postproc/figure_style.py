"""The common look of all figures: sizes, fonts, lines that differ in grey, saving."""

from __future__ import annotations

import textwrap
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter
from result_file import Result

MILLIMETRE = 1 / 25.4
ONE_COLUMN = 85 * MILLIMETRE
TWO_COLUMNS = 170 * MILLIMETRE

PNG_DPI = 200
COLOUR_MAP = "cividis"
# Numbers that read well without powers of ten, and up to how many decades show 2 and 5 between these.
PLAIN = (1e-3, 2e4)
SHORT = 2.2
REFERENCE = {"color": "0.55", "linewidth": 0.9, "linestyle": (0, (1, 1.2))}

PRESSURE = {"color": "#9c3a00", "linestyle": "-"}
FILM = {"color": "#08306b", "linestyle": (0, (5, 1.6))}

# Dark to light, each with its own dash and marker: distinct on paper without colour.
SERIES = (
    {"color": "#000000", "linestyle": "-", "marker": "o"},
    {"color": "#b03a00", "linestyle": (0, (5, 1.6)), "marker": "s"},
    {"color": "#56a8e0", "linestyle": (0, (4, 1.4, 1, 1.4)), "marker": "^"},
    {"color": "#2e6b1f", "linestyle": (0, (1, 1.2)), "marker": "D"},
    {"color": "#b79ad0", "linestyle": (0, (6, 1.4, 1, 1.4, 1, 1.4)), "marker": "v"},
    {"color": "#969696", "linestyle": (0, (2, 1)), "marker": "x"},
)

plt.rcParams.update(
    {
        "font.family": "STIXGeneral",
        "mathtext.fontset": "stix",
        "font.size": 9,
        "axes.labelsize": 9,
        "axes.titlesize": 9,
        "xtick.labelsize": 8.5,
        "ytick.labelsize": 8.5,
        "legend.fontsize": 8.5,
        "legend.frameon": False,
        "legend.handlelength": 2.4,
        "axes.linewidth": 0.6,
        "lines.linewidth": 1.2,
        "lines.markersize": 3.5,
        "xtick.direction": "in",
        "ytick.direction": "in",
        "xtick.top": True,
        "ytick.right": True,
        "figure.constrained_layout.use": True,
        "pdf.fonttype": 42,
        "svg.fonttype": "none",
    }
)


def new_figure(width: float, height_mm: float, **subplots: object) -> tuple[Figure, object]:
    """Figure and axes of a width in inches (ONE_COLUMN, TWO_COLUMNS) and a height in mm."""
    return plt.subplots(figsize=(width, height_mm * MILLIMETRE), **subplots)


def literal(text: str) -> str:
    """Text from a file or of a file name, which must not be read as mathematics."""
    return text.replace("$", r"\$")


def mark_not_converged(figure: Figure, results: list[Result]) -> None:
    """Writes above the figure which of the results did not converge, and why."""
    bad = [result for result in results if not result.converged]
    if not bad:
        return
    width = int(figure.get_figwidth() / MILLIMETRE / 1.75)
    lines = []
    for result in bad:
        name = "" if len(results) == 1 else f" {result.stem}"
        text = f"NOT CONVERGED{name}: {result.reason or 'no reason given'}"
        lines += textwrap.wrap(literal(text), width)
    figure.suptitle("\n".join(lines), fontsize=9, fontweight="bold", color="#b30000")


def x_window(result: Result, asked: list[float] | None) -> tuple[float, float]:
    """The part of the stored X to show: as asked, else the loaded part with some room around."""
    x = result.x
    if asked:
        return max(min(asked), x[0]), min(max(asked), x[-1])
    if "pressure" in result.transient:
        pressure = np.nanmax(result.transient["pressure"].values, axis=0)
    else:
        pressure = result.solution["pressure"].values
    loaded = np.flatnonzero(pressure > 0.03 * np.nanmax(pressure))
    if loaded.size == 0:
        return x[0], x[-1]
    left, right = x[loaded[0]], x[loaded[-1]]
    room = 0.06 * (right - left)
    return max(left - room, x[0]), min(right + room, x[-1])


def film_limit(film: np.ndarray, pressure: np.ndarray) -> float:
    """Upper end of a film axis: shows the film under load, not the wide open inlet."""
    loaded = pressure > 0.3 * np.nanmax(pressure)
    inside = film[loaded & np.isfinite(film)]
    return 1.6 * float(inside.max()) if inside.size else float(np.nanmax(film))


def few_ticks(axes: Axes, most: int = 5) -> None:
    """Few round numbers along X."""
    axes.xaxis.set_major_locator(MaxNLocator(most, steps=[1, 2, 5, 10]))


def label_logarithmic(axis: Axis) -> None:
    """Ticks of a logarithmic axis: plain numbers where these are short, and 2 and 5 between the powers of ten if there are few."""
    least, largest = sorted(axis.get_view_interval())
    if least < PLAIN[0] or largest > PLAIN[1]:
        return
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
    if np.log10(largest / least) < SHORT:
        axis.set_minor_locator(LogLocator(subs=range(2, 10)))
        axis.set_minor_formatter(FuncFormatter(lambda value, _: f"{value:g}" if f"{value:e}"[0] in "25" else ""))


def hide_covered(figure: Figure) -> None:
    """Hides the labels of lines on which the words of a panel, those in a box, lie."""
    figure.draw_without_rendering()
    for axes in figure.axes:
        boxes = [text.get_bbox_patch().get_window_extent() for text in axes.texts if text.get_bbox_patch()]
        for label in axes.texts:
            if not label.get_bbox_patch() and label.get_window_extent().count_overlaps(boxes):
                label.set_visible(False)


def legend_below(figure: Figure, handles: list, columns: int) -> None:
    """A legend below the axes, where it covers nothing."""
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=columns,
        columnspacing=1.6,
        borderpad=0.1,
        borderaxespad=0.1,
    )


def save_figure(figure: Figure, targets: list[Path]) -> list[Path]:
    """Saves under every name and closes the figure."""
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if axis.get_scale() == "log" and isinstance(axis.get_major_locator(), LogLocator):
                label_logarithmic(axis)
    for target in targets:
        metadata = {"CreationDate": None} if target.suffix == ".pdf" else None
        figure.savefig(target, dpi=PNG_DPI, metadata=metadata)
    plt.close(figure)
    return targets

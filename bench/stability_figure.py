"""Draws one map of `make stability`: a panel for each method in the same frame, iterations as colour."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
from bench_program import ROOT
from stability_cells import Axis, StabilityMap

sys.path.append(str(ROOT / "postproc"))

import figure_style as style
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.patches import Patch

# Light to dark green with the iterations; of other classes those that did not converge share a colour, the sign says what happened.
GREEN = LinearSegmentedColormap.from_list("iterations", colormaps["Greens"](np.linspace(0.15, 0.95, 64)))
SCALE = LogNorm(1, 30)
NOT_CONVERGED = "#a11c1c"
CLASSES = {
    "late": ("#f2b33d", "+", "converged late, after more than 30"),
    "limit": (NOT_CONVERGED, "…", "not converged: limit of iterations or time"),
    "stalled": (NOT_CONVERGED, "–", "not converged: stalled"),
    "failed": (NOT_CONVERGED, "×", "not converged: failed"),
    "too coarse": ("#a9cbe8", "o", "grid or time step too coarse, told so"),
    "refused": ("#ffffff", "?", "input refused"),
}
MOST_PANELS_IN_A_ROW = 4


def draw_map(each: StabilityMap, classes: dict[tuple[str, int, int], tuple[str, float]], folder: Path) -> None:
    """Draws the map; `classes` holds class and iterations by method, column and row."""
    panels = len(each.methods)
    columns = math.ceil(panels / math.ceil(panels / MOST_PANELS_IN_A_ROW))
    rows = math.ceil(panels / columns)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 22 + 48 * rows, nrows=rows, ncols=columns, squeeze=False)
    for i, (panel, method) in enumerate(zip(axes.flat, each.methods, strict=False)):
        draw_panel(panel, each, method, classes)
        panel.label_outer() if i + columns < panels else None
        if i % columns:
            panel.set_ylabel("")
            panel.set_yticklabels([])
    for panel in axes.flat[panels:]:
        panel.set_axis_off()
    bar = figure.colorbar(ScalarMappable(SCALE, GREEN), ax=axes, shrink=0.8, pad=0.01, aspect=30)
    bar.set_label("Iterations")
    bar.set_ticks([1, 2, 5, 10, 20, 30], labels=["1", "2", "5", "10", "20", "30"])
    bar.minorticks_off()
    figure.suptitle(each.title, fontsize=9)
    seen = {word for word, _ in classes.values()}
    handles = [Patch(facecolor=GREEN(0.5), label="converged")]
    if "no cycle" in seen:
        handles.append(Patch(facecolor=GREEN(0.0), edgecolor="0.4", linewidth=0.4, label="one level, solved exactly (e)"))
    for word, (colour, sign, label) in CLASSES.items():
        if word in seen:
            handles.append(Patch(facecolor=colour, edgecolor="0.4", linewidth=0.4, label=f"{label} ({sign})"))
    style.legend_below(figure, handles, 3 if len(handles) < 5 else 2)
    style.save_figure(figure, [folder / f"stability_{each.key}.png", folder / f"stability_{each.key}.pdf"])


def draw_panel(axes: Axes, each: StabilityMap, method: str, classes: dict[tuple[str, int, int], tuple[str, float]]) -> None:
    """The cells of one method."""
    shape = (len(each.y.values), len(each.x.values))
    image = np.ones((*shape, 4))
    for (name, column, row), (word, iterations) in classes.items():
        if name != method:
            continue
        if word in {"converged", "no cycle"}:
            image[row, column] = GREEN(SCALE(max(iterations, 1)))
            if word == "converged":
                continue
            axes.text(column, row, "e", ha="center", va="center_baseline", fontsize=5.5, color="0.45")
            continue
        colour, sign, _ = CLASSES[word]
        image[row, column] = [*(int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)), 1]
        tone = "white" if colour == NOT_CONVERGED else "0.25"
        axes.text(column, row, sign, ha="center", va="center_baseline", fontsize=5.5, color=tone)
    axes.imshow(image, origin="lower", aspect="auto", interpolation="nearest")
    axes.set_title(method, fontsize=8.5)
    axes.set(xlabel=each.x.label, ylabel=each.y.label)
    axes.tick_params(length=0, labelsize=7)
    set_ticks(axes.set_xticks, each.x, 6)
    set_ticks(axes.set_yticks, each.y, 11)
    axes.set_xticks(np.arange(shape[1] + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(shape[0] + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="white", linewidth=0.4)
    axes.tick_params(which="minor", length=0)


def set_ticks(setter: object, axis: Axis, most: int) -> None:
    """Values at some of the cells."""
    count = len(axis.values)
    places = list(range(0, count, max(1, math.ceil(count / most))))
    setter(places, labels=[value_label(axis, axis.values[i]) for i in places])


def value_label(axis: Axis, value: float) -> str:
    """A value on an axis; numbers of intervals as powers of two."""
    if axis.key == "intervals":
        return f"$2^{{{round(math.log2(value))}}}$"
    return "∞" if math.isinf(value) else f"{value:g}"

"""Draws maps of `make stability`: a panel for each method in the same frame, iterations as colour."""

from __future__ import annotations

import math
from pathlib import Path

import bench_program  # noqa: F401  (finds postproc/)
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm
from matplotlib.patches import Patch
from stability_cells import Axis, Place, StabilityMap

import figure_style as style  # isort: skip

# Light to dark green with the iterations; of other classes those that did not converge share a colour, the sign says what happened.
GREEN = LinearSegmentedColormap.from_list("iterations", colormaps["Greens"](np.linspace(0.15, 0.95, 64)))
SCALE = LogNorm(1, 30)
NOT_CONVERGED = "#a11c1c"
CLASSES = {
    "late": ("#f2b33d", "+", "converged late, after more than 30"),
    "limit": (NOT_CONVERGED, "…", "not converged: limit of iterations or time"),
    "stalled": (NOT_CONVERGED, "–", "not converged: stalled"),
    "failed": (NOT_CONVERGED, "×", "not converged: failed"),
    "too coarse": ("#a9cbe8", "o", "grid or time step too coarse, and reported"),
    "refused": ("#ffffff", "?", "input refused"),
    "closed": ("#ffffff", "c", "closed form"),
    "no cycle": ("#e4f4e0", "e", "one level, solved exactly"),
}
Classes = dict[Place, tuple[str, float]]


def draw_maps(maps: list[StabilityMap], found: list[Classes], columns: int, title: str, path: Path) -> None:
    """Draws maps, the panels of each in rows of at most `columns`; class and iterations by method, column and row of cells."""
    panels = [(each, method, classes) for each, classes in zip(maps, found, strict=True) for method in each.methods]
    columns = math.ceil(len(panels) / math.ceil(len(panels) / columns))
    rows = math.ceil(len(panels) / columns)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 22 + 48 * rows, nrows=rows, ncols=columns, squeeze=False)
    for i, (panel, content) in enumerate(zip(axes.flat, panels, strict=False)):
        draw_panel(panel, *content)
        if i % columns:
            panel.set_ylabel("")
            panel.set_yticklabels([])
        if len(maps) == 1 and i + columns < len(panels):
            panel.label_outer()
        if len(maps) > 1 and i % columns == 0:
            panel.set_title(f"\n{panel.get_title()}", fontsize=8.5)
            panel.annotate(content[0].title, (0, 1), (0, 17), "axes fraction", "offset points", fontsize=8.5).set_in_layout(False)
    for panel in axes.flat[len(panels) :]:
        panel.set_axis_off()
    bar = figure.colorbar(ScalarMappable(SCALE, GREEN), ax=axes, shrink=0.8, pad=0.01, aspect=30)
    bar.set_label("Iterations")
    bar.set_ticks([1, 2, 5, 10, 20, 30], labels=["1", "2", "5", "10", "20", "30"])
    bar.minorticks_off()
    figure.suptitle(title, fontsize=9)
    seen = {word for classes in found for word, _ in classes.values()}
    handles = [Patch(facecolor=GREEN(0.5), label="converged")]
    look = {"edgecolor": "0.4", "linewidth": 0.4}
    handles += [Patch(facecolor=colour, label=f"{label} ({s})", **look) for w, (colour, s, label) in CLASSES.items() if w in seen]
    style.legend_below(figure, handles, 3 if len(handles) < 5 else 2)
    style.save_figure(figure, [path.with_suffix(".png"), path.with_suffix(".pdf")])


def draw_panel(axes: Axes, each: StabilityMap, method: str, classes: Classes) -> None:
    """The cells of one method."""
    image = np.ones((len(each.y.values), len(each.x.values), 4))
    for (name, column, row), (word, iterations) in classes.items():
        if name == method and word == "converged":
            image[row, column] = GREEN(SCALE(max(iterations, 1)))
        elif name == method:
            colour, sign, _ = CLASSES[word]
            image[row, column] = [*(int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)), 1]
            tone = "white" if colour == NOT_CONVERGED else "0.25"
            axes.text(column, row, sign, ha="center", va="center_baseline", fontsize=5.5, color=tone)
    axes.imshow(image, origin="lower", aspect="auto", interpolation="nearest")
    axes.set_title(method.replace("_", " "), fontsize=8.5)
    axes.set(xlabel=each.x.label, ylabel=each.y.label)
    set_ticks(axes.set_xticks, each.x, 5)
    set_ticks(axes.set_yticks, each.y, 11)
    axes.set_xticks(np.arange(len(each.x.values) + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(each.y.values) + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="white", linewidth=0.4)
    axes.tick_params(which="both", length=0, labelsize=7)


def set_ticks(setter: object, axis: Axis, most: int) -> None:
    """Values at some of the cells; numbers of intervals as powers of two."""
    count = len(axis.values)
    places = list(range(0, count, max(1, math.ceil(count / most))))
    setter(places, labels=[value_label(axis, axis.values[i]) for i in places])


def value_label(axis: Axis, value: float | None) -> str:
    """A value on an axis."""
    if axis.key == "intervals":
        return f"$2^{{{round(math.log2(value))}}}$"
    return "none" if value is None else "∞" if math.isinf(value) else f"{value:g}"

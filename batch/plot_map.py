"""Maps of a gathered table: one quantity over two parameters, optionally with the regimes of lubrication."""

from __future__ import annotations

import numpy as np
from gathered import Gathered
from plot_curves import FAILURE, Wish, failure_marks, panels_of, style
from regime import REGIMES, read_films  # of postproc/, which plot_curves has put on the path
from sweep_file import SweepError

# Steps in the logarithm between which a surface is interpolated for lines.
FINE = 200


def draw_map(table: Gathered, wish: Wish) -> object:
    """The figure: a panel for each facet, cells where the parameters form a grid, else dots."""
    name = wish.y[0]
    axes_of = {word: table.axis(column) for word, column in (("x", wish.x), ("y", wish.colour), ("z", name))}
    x, y, z = (table.numbers(column) / axes_of[word].size for word, column in (("x", wish.x), ("y", wish.colour), ("z", name)))
    facets = panels_of(table, wish)
    width = style.ONE_COLUMN if len(facets) == 1 else style.TWO_COLUMNS
    figure, axes = style.new_figure(width, 78, ncols=len(facets), squeeze=False, sharex=True, sharey=True)
    good = table.is_done & np.isfinite(z)
    if not good.any():
        raise SweepError(f"{table.path}: no case with a value of {name} is done, so there is nothing to draw")
    norm = style.plt.matplotlib.colors.LogNorm if "z" in wish.log else style.plt.Normalize
    scale = norm(z[good].min(), z[good].max())
    for panel, (words, chosen) in zip(axes[0], facets, strict=True):
        for axis in wish.log:
            if axis in ("x", "y"):
                getattr(panel, f"set_{axis}scale")("log")
        image = draw_cells(panel, x[chosen], y[chosen], np.where(good, z, np.nan)[chosen], wish, scale)
        bad, lost = chosen & table.is_unconverged, chosen & table.is_missing
        panel.plot(x[bad], y[bad], "o", markersize=5, markerfacecolor="none", markeredgecolor=FAILURE, linestyle="none", zorder=6)
        panel.plot(x[lost], y[lost], "x", markersize=5, color=FAILURE, zorder=6)
        if wish.regimes:
            draw_regimes(panel, x[chosen], y[chosen], table, chosen, wish)
        panel.set_title(style.literal(words))
        panel.set_xlabel(style.literal(axes_of["x"].label))
    axes[0, 0].set_ylabel(style.literal(axes_of["y"].label))
    figure.colorbar(image, ax=axes).set_label(style.literal(axes_of["z"].label))
    if table.title:
        figure.suptitle(style.literal(table.title), fontsize=9)
    if marks := failure_marks(table):
        style.legend_below(figure, marks, len(marks))
    style.hide_covered(figure)
    return figure


def draw_cells(panel: object, x: np.ndarray, y: np.ndarray, z: np.ndarray, wish: Wish, scale: object) -> object:
    """Cells of a full grid with lines of equal value, or dots."""
    grid = on_grid(x, y, z)
    if grid is None or wish.points:
        panel.plot(x, y, ".", markersize=1, color="0.6")
        return panel.scatter(x, y, c=z, s=22, norm=scale, cmap=style.COLOUR_MAP, zorder=5)
    columns, rows, values = grid
    image = panel.pcolormesh(columns, rows, values, norm=scale, cmap=style.COLOUR_MAP, shading="nearest", rasterized=True)
    if min(values.shape) > 2 and np.isfinite(values).any():
        lines = panel.contour(
            columns, rows, values, 6 if "z" not in wish.log else scale_steps(scale), colors="white", linewidths=0.5
        )
        panel.clabel(lines, fmt="%.3g", fontsize=7)
    return image


def scale_steps(scale: object) -> np.ndarray:
    """Round levels on a logarithmic scale: 1, 2, 5 of each decade."""
    low, high = np.floor(np.log10(scale.vmin)), np.ceil(np.log10(scale.vmax))
    steps = np.array([digit * 10.0**power for power in np.arange(low, high) for digit in (1, 2, 5)])
    return steps[(steps > scale.vmin) & (steps < scale.vmax)]


def on_grid(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Values at the crossings of all x with all y; None if they are not each there once."""
    columns, across = np.unique(x, return_inverse=True)
    rows, down = np.unique(y, return_inverse=True)
    if min(columns.size, rows.size) < 2 or columns.size * rows.size != x.size or len(set(zip(across, down, strict=True))) != x.size:
        return None
    values = np.full((rows.size, columns.size), np.nan)
    values[down, across] = z
    return columns, rows, values


def draw_regimes(panel: object, x: np.ndarray, y: np.ndarray, table: Gathered, chosen: np.ndarray, wish: Wish) -> None:
    """Borders and names of the regimes, from the Moes numbers of the cases, interpolated between them."""
    grids = [on_grid(x, y, np.log(table.numbers(f"scaling_moes_{letter}_sum")[chosen])) for letter in "ml"]
    if grids[0] is None or not np.isfinite([grid[2] for grid in grids]).all():
        raise SweepError(f"{table.path}: regimes need a full grid of cases with Moes numbers")
    columns, rows = (fine(values, word in wish.log) for values, word in ((grids[0][0], "x"), (grids[0][1], "y")))
    m_sum, l_sum = (np.exp(interpolated(grid, columns, rows, wish)) for grid in grids)
    found = read_films().regime(m_sum, l_sum)
    for number, words in enumerate(REGIMES):
        inside = found == number
        if not inside.any():
            continue
        if not inside.all():
            panel.contour(columns, rows, inside.astype(float), [0.5], colors="black", linewidths=0.9)
        down, across = np.nonzero(inside)
        place = columns[int(np.median(across))], rows[int(np.median(down))]
        box = {"facecolor": "white", "alpha": 0.75, "pad": 1.0, "linewidth": 0}
        panel.text(*place, words, fontsize=8, ha="center", va="center", bbox=box, zorder=7)


def fine(values: np.ndarray, is_log: bool) -> np.ndarray:
    """A fine axis over the same stretch."""
    return np.geomspace(values[0], values[-1], FINE) if is_log else np.linspace(values[0], values[-1], FINE)


def interpolated(grid: tuple[np.ndarray, np.ndarray, np.ndarray], columns: np.ndarray, rows: np.ndarray, wish: Wish) -> np.ndarray:
    """Bilinear interpolation of a grid, along logarithms where the axis is one."""
    x, y = (np.log if "x" in wish.log else np.asarray), (np.log if "y" in wish.log else np.asarray)
    along = np.array([np.interp(x(columns), x(grid[0]), row) for row in grid[2]])
    return np.array([np.interp(y(rows), y(grid[1]), column) for column in along.T]).T

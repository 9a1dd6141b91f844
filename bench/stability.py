#!/usr/bin/env python3
"""Maps where each method converges, converges late or fails, with iterations as colour.

A cell converged (at most 30 iterations on the finest grid, in time: per step), converged late (more), did not converge (limit of
iterations, 40 s of processor time, stalled, failed), or was rightly reported as a grid too coarse for a discrete film or steps
too long for a feature. Each map gives stability_NAME.png, .pdf, .csv; SHOWN are in stability.png. conclusion.txt counts cells and
lists those where `auto` does not converge; their namelists go to not_converged/. --dry draws the maps of dry contacts in one
figure, dry_stability.png: conjugate gradients (left) and steepest descent (right).
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import pandas as pd
from bench_program import conclude, new_parser, save, side_by_side, solve
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, LogNorm, to_rgba
from matplotlib.patches import Patch
from stability_cells import AUTO, CYCLES, NAMES, StabilityMap, all_maps, dry_maps, iterations, status

import figure_style as style  # isort: skip

LIMIT = 40
# Of the common figure.
SHOWN = ("moes_eyring", "coarsest", "roughness")
COLUMNS = ("intervals", "cycles", "steps", "residual", "load_error", "h_min", "h_central", "p_max", "contact_area_fraction", "kkt")
BARE = ("--set", "accuracy.error_bars=false", "--set", "output.adequacy=false")
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


def solve_map(each: StabilityMap, processes: int) -> pd.DataFrame:
    """All cells of a map with their classes."""
    answers = side_by_side(lambda text: solve(text, options=BARE, limit=LIMIT), [*each.cells.values()], processes)
    rows = []
    for (method, column, row), answer in zip(each.cells, answers, strict=True):
        place = {"method": method, each.x.key: each.x.values[column], each.y.key: each.y.values[row]}
        found = {"status": status(answer), "iterations": iterations(answer), "way": answer["method"]}
        values = {name: answer[name] for name in COLUMNS if name in answer}
        rows.append({"column": column, "row": row} | place | found | values | {"reason": answer["reason"].strip()})
    return pd.DataFrame(rows)


def is_right(cells: pd.DataFrame) -> pd.Series:
    """Whether a cell converged, or what is too coarse for it was called so."""
    return ~cells["status"].isin(("limit", "stalled", "failed", "refused"))


def report(each: StabilityMap, cells: pd.DataFrame, folder: Path) -> str:
    """Counts by method, and the cells where `auto` is not right, whose namelists go to the folder."""
    lines = [f"{each.title}: {each.x.label} x {each.y.label}"]
    for method, own in cells.groupby("method", sort=False):
        words = ", ".join(f"{count} {word}" for word, count in own["status"].value_counts().items())
        words += f"; at most {own['iterations'].max():.0f} iterations"
        lines.append(f"  {method}: {is_right(own).sum()} of {len(own)} right ({words})")
    for i, cell in cells[cells["method"].str.startswith("auto") & (~is_right(cells) | (cells["status"] == "late"))].iterrows():
        folder.mkdir(exist_ok=True)
        target = folder / f"{each.key}_{i}.nml"
        target.write_text([*each.cells.values()][i], encoding="utf-8")
        place = ", ".join(f"{axis.key} = {cell[axis.key]}" for axis in (each.x, each.y))
        lines.append(f"    {cell['method']}: {place}: {cell['status']}: {cell['reason']} [{target.name}]")
    return "\n".join(lines) + "\n"


def draw_maps(found: list[tuple[StabilityMap, pd.DataFrame]], columns: int, title: str, path: Path) -> None:
    """Draws maps, the panels of each in rows of at most `columns`."""
    panels = [(each, method, cells[cells["method"] == method]) for each, cells in found for method in each.methods]
    columns = math.ceil(len(panels) / math.ceil(len(panels) / columns))
    rows = math.ceil(len(panels) / columns)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 22 + 48 * rows, nrows=rows, ncols=columns, squeeze=False)
    for i, (panel, content) in enumerate(zip(axes.flat, panels, strict=False)):
        draw_panel(panel, *content)
        if i % columns:
            panel.set_ylabel("")
            panel.set_yticklabels([])
        if len(found) == 1 and i + columns < len(panels):
            panel.label_outer()
        if len(found) > 1 and i % columns == 0:
            panel.set_title(f"\n{panel.get_title()}", fontsize=8.5)
            panel.annotate(content[0].title, (0, 1), (0, 17), "axes fraction", "offset points", fontsize=8.5).set_in_layout(False)
    for panel in axes.flat[len(panels) :]:
        panel.set_axis_off()
    bar = figure.colorbar(ScalarMappable(SCALE, GREEN), ax=axes, shrink=0.8, pad=0.01, aspect=30)
    bar.set_label("Iterations")
    bar.set_ticks([1, 2, 5, 10, 20, 30], labels=["1", "2", "5", "10", "20", "30"])
    bar.minorticks_off()
    figure.suptitle(title, fontsize=9)
    seen = {status for _, cells in found for status in cells["status"]}
    handles = [Patch(facecolor=GREEN(0.5), label="converged")]
    look = {"edgecolor": "0.4", "linewidth": 0.4}
    handles += [Patch(facecolor=colour, label=f"{label} ({s})", **look) for w, (colour, s, label) in CLASSES.items() if w in seen]
    style.legend_below(figure, handles, 3 if len(handles) < 5 else 2)
    style.save_figure(figure, [path.with_suffix(".png"), path.with_suffix(".pdf")])


def draw_panel(axes: Axes, each: StabilityMap, method: str, cells: pd.DataFrame) -> None:
    """The cells of one method."""
    image = np.ones((len(each.y.values), len(each.x.values), 4))
    for column, row, word, count in cells[["column", "row", "status", "iterations"]].itertuples(index=False):
        if word == "converged":
            image[row, column] = GREEN(SCALE(max(count, 1)))
            continue
        colour, sign, _ = CLASSES[word]
        image[row, column] = to_rgba(colour)
        tone = "white" if colour == NOT_CONVERGED else "0.25"
        axes.text(column, row, sign, ha="center", va="center_baseline", fontsize=5.5, color=tone)
    axes.imshow(image, origin="lower", aspect="auto", interpolation="nearest")
    axes.set_title(method.replace("_", " "), fontsize=8.5)
    axes.set(xlabel=each.x.label, ylabel=each.y.label)
    for side, setter, most in ((each.x, axes.set_xticks, 5), (each.y, axes.set_yticks, 11)):
        places = range(0, len(side.values), max(1, math.ceil(len(side.values) / most)))
        setter(places, labels=[side.value(i) for i in places])
        setter(np.arange(len(side.values) + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="white", linewidth=0.4)
    axes.tick_params(which="both", length=0, labelsize=7)


def main() -> None:
    """Command line."""
    parser = new_parser(__doc__, "fewer cells and coarser grids, under 3 minutes", "results/stability", processes=2)
    words = f"only these maps: {', '.join(NAMES)}"
    parser.add_argument("--only", nargs="+", metavar="MAP", choices=NAMES, default=NAMES, help=words)
    parser.add_argument("--dry", action="store_true", help="dry contacts")
    options = parser.parse_args()
    folder, found, text = options.output, [], ""
    maps = dry_maps(options.quick) if options.dry else (each for each in all_maps(options.quick) if each.key in options.only)
    for each in maps:
        print(each.key, end=": ", file=sys.stderr)
        cells = solve_map(each, options.processes)
        save(folder / f"stability_{each.key}.csv", cells.drop(columns=["column", "row"]))
        text += report(each, cells, folder / "not_converged")
        if not options.dry:
            draw_maps([(each, cells)], 4, each.title, folder / f"stability_{each.key}")
            each.methods = AUTO | CYCLES
        if options.dry or each.key in SHOWN:
            found.append((each, cells))
    if options.dry or len(found) == len(SHOWN):
        draw_maps(found, 2 if options.dry else 4, "", folder / ("dry_stability" if options.dry else "stability"))
    conclude(folder / ("dry_conclusion.txt" if options.dry else "conclusion.txt"), text)


if __name__ == "__main__":
    main()

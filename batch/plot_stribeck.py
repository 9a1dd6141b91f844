"""The Stribeck curve of a gathered table: friction, load of the asperities, film and its temperature over the speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from gathered import Gathered
from plot_curves import Wish, draw_panel, failure_marks, label_of, style
from sweep_file import SweepError

SHARE = "asperity_load_share"
HEAT = "temperature_rise_film"
# Quantities of each panel as its legend names them.
PANELS = (
    {"friction_coefficient": "sum", "friction_coefficient_oil": "oil", "friction_coefficient_boundary": "asperities"},
    {SHARE: "load share"},
    {"h_central": "central film $h_\\mathrm{c}$", "h_min": "smallest film $h_\\mathrm{min}$"},
    {HEAT: "temperature rise"},
)
BOX = {"frameon": True, "framealpha": 0.85, "edgecolor": "none", "borderpad": 0.1, "borderaxespad": 0.4, "labelspacing": 0.2}
# Regimes of lubrication by the load share of the asperities, and the shares between them.
REGIMES = ("full film\n< 1 %", "mixed\n1 to 90 %", "boundary\n> 90 %")
SHARES = (0.01, 0.9)
# Speeds at which the share is interpolated.
FINE = 1000
# Relative differences of one rms height among results.
SAME = 1e-6


def draw_stribeck(table: Gathered, wish: Wish) -> object:
    """The figure: panels below each other, of the quantities that the table has. Raises SweepError."""
    has_heat = np.isfinite(table.columns.get(HEAT, np.array(np.nan))).any()
    panels = PANELS if has_heat else PANELS[:-1]
    everything = np.ones(len(table.columns["case"]), dtype=bool)
    figure, axes = style.new_figure(style.ONE_COLUMN, 46 * len(panels) + 14, nrows=len(panels), sharex=True)
    for panel, words in zip(axes, panels, strict=True):
        names, is_film = list(words), "h_min" in words
        handles = draw_panel(panel, table, replace(wish, log=("x", "y") if is_film else ("x",)), names, everything)
        panel.set_ylabel(style.literal(label_of(table, names)))
        if is_film:
            handles += draw_roughness(panel, table)
        else:
            panel.set_ylim(bottom=0)
        if len(handles) > 1:
            panel.legend(handles, [*words.values(), "rms height $\\sigma$"][: len(handles)], **BOX)
    axes[0].set_ylabel("Friction coefficient [-]")
    if has_heat:
        axes[-1].set_ylabel("Temperature rise of the film [K]")
    axes[1].set_ylabel("Load share of asperities [%]")
    axes[1].set(ylim=(0, 1.4), yticks=np.arange(0, 1.1, 0.2))  # the names of regimes are above the curve
    axes[1].yaxis.set_major_formatter(style.plt.matplotlib.ticker.PercentFormatter(1, symbol=""))
    draw_regimes(axes, table, wish)
    words = table.axis(wish.x).label.replace("_", " ")
    axes[-1].set_xlabel(style.literal(words[:1].upper() + words[1:]))
    if table.title:
        figure.suptitle(style.literal(table.title), fontsize=9)
    if marks := failure_marks(table):
        style.legend_below(figure, marks, len(marks))
    return figure


def draw_roughness(panel: object, table: Gathered) -> list:
    """The rms height as a line, which it returns, and films over it along the right side; nothing if cases differ in it."""
    heights = table.numbers("h_min") / table.numbers("lambda_ratio")
    known = heights[np.isfinite(heights)]
    if not known.size or np.ptp(known) > SAME * known[0]:
        return []
    sigma = known[0] / table.axis("h_central").size
    panel.tick_params(axis="y", which="both", right=False)
    side = panel.secondary_yaxis("right", functions=(lambda film: film / sigma, lambda ratio: ratio * sigma))
    side.yaxis.set_major_formatter("{x:g}")
    side.set_ylabel("$\\lambda = h/\\sigma$ [-]")
    return [panel.axhline(sigma, **style.REFERENCE | {"color": "black"})]


def draw_regimes(axes: np.ndarray, table: Gathered, wish: Wish) -> None:
    """Names of the regimes into the second panel, the speeds between them as lines into all. Raises SweepError."""
    x, share = table.numbers(wish.x), table.numbers(SHARE)
    known = np.flatnonzero(table.is_done & np.isfinite(share) & (x > 0))
    if known.size < 2:
        raise SweepError(f"{table.path}: fewer than two cases with {SHARE} are done, so there is no curve to draw")
    known = known[np.argsort(x[known], kind="stable")]
    speeds = np.geomspace(x[known[0]], x[known[-1]], FINE)
    regime = np.digitize(np.interp(np.log(speeds), np.log(x[known]), share[known]), SHARES)
    speeds /= table.axis(wish.x).size
    for i in np.flatnonzero(np.diff(regime)):
        for panel in axes:
            panel.axvline(speeds[i], **style.REFERENCE)
    for number in np.unique(regime):
        place = np.median(speeds[regime == number])
        axes[1].text(place, 0.87, REGIMES[number], ha="center", va="center", transform=axes[1].get_xaxis_transform())

"""The figures of chapter 7 and Paper C with their numbers; bands: 10 to 90 % of the realisations."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from chapter7_claims import ALL_LOADS, FIRST
from dry_profiles import LOADS, PROFILES, Sweep
from study import save, style

Spread = dict[tuple[str, str], np.ndarray]
MICROMETRE = 1e6


def draw(given: dict[str, Sweep], spread: Spread, folder: Path) -> None:
    """All figures."""
    draw_heights(given, folder)
    draw_contact(given, spread, folder)
    draw_amplitudes(given, spread, folder)
    draw_shape(given, spread, folder)


def draw_heights(given: dict[str, Sweep], folder: Path) -> None:
    """Figures 7.1 and C.2: bearing ratio and height distribution of the undeformed profiles, from the lowest point up."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 70, ncols=2, sharey=True)
    for name, series in zip(PROFILES, style.SERIES, strict=False):
        look = {key: series[key] for key in ("color", "linestyle")}
        found = given[name]
        lowest = found["level"][0]
        axes[0].plot(100 * found["bearing_ratio_undeformed"], MICROMETRE * (found["level"] - lowest), label=name, **look)
        edge = found["density_edge"]
        middle = MICROMETRE * ((edge[1:] + edge[:-1]) / 2 - lowest)
        axes[1].plot(found["height_density_undeformed"] / MICROMETRE, middle, **look)
    axes[0].set(xlabel="Bearing ratio [%]", ylabel="Height $z$ [µm]", xlim=(0, 100), ylim=(0, None))
    axes[1].set(xlabel="Density $P(z)$ [1/µm]", xlim=(0, None))
    axes[0].legend()
    save(figure, folder, "figure_7_1_heights")


def draw_contact(given: dict[str, Sweep], spread: Spread, folder: Path) -> None:
    """Figures 7.2 (C.4) and C.7: contact area, plasticity index, mean separation."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 65, ncols=3)
    panels = {
        "contact_area_fraction": ("Contact area $A_r/A_n$ [%]", 100, True),
        "plasticity_index": ("Plasticity index $A_p/A_r$ [-]", 1, True),
        "mean_separation": ("Mean separation [µm]", MICROMETRE, False),
    }
    for panel, (column, (label, unit, banded)) in zip(axes, panels.items(), strict=True):
        for name, series in zip(PROFILES, style.SERIES, strict=False):
            panel.plot(LOADS, unit * given[name][column][:FIRST], label=name, **series)
            if banded:
                low, high = np.quantile(spread[name, column][:, :FIRST], (0.1, 0.9), axis=0)
                panel.fill_between(LOADS, unit * low, unit * high, color=series["color"], alpha=0.12, linewidth=0)
        panel.set(xlabel="Load [kN/m]", ylabel=label, xlim=(0, None), ylim=(0, None))
    axes[0].legend()
    save(figure, folder, "figure_7_2_contact")


def draw_parameters(axes: np.ndarray, panels: dict[str, tuple[str, float]], given: dict[str, Sweep], spread: Spread) -> None:
    """Parameters of the heights over the load: marked lines and bands under it, thin dots after it."""
    load = np.r_[0, ALL_LOADS]
    after_load = {"linewidth": 0.8, "linestyle": (0, (1, 1.2))}
    for panel, (key, (label, unit)) in zip(axes, panels.items(), strict=True):
        for name, series in zip(PROFILES, style.SERIES, strict=False):
            start = given[name][f"{key}_undeformed"][0]
            panel.plot(load, unit * np.r_[start, given[name][f"{key}_loaded"]], label=name, **series)
            after = unit * np.r_[start, given[name][f"{key}_unloaded"]]
            panel.plot(load, after, color=series["color"], **after_load)
            low, high = np.quantile(spread[name, f"{key}_loaded"], (0.1, 0.9), axis=0)
            panel.fill_between(ALL_LOADS, unit * low, unit * high, color=series["color"], alpha=0.12, linewidth=0)
        panel.set(xlabel="Load [kN/m]", ylabel=label, xlim=(0, None))
    handles = axes[0].get_legend_handles_labels()[0]
    handles += axes[0].plot([], [], color="0.4", label="unloaded", **after_load)
    style.legend_below(axes[0].figure, handles, 5)


def draw_amplitudes(given: dict[str, Sweep], spread: Spread, folder: Path) -> None:
    """Figures 7.3 and C.5: Ra, Rz and Rq."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 72, ncols=3)
    panels = {key: (f"$R{key[1]}$ [µm]", MICROMETRE) for key in ("ra", "rz", "rq")}
    draw_parameters(axes, panels, given, spread)
    for panel in axes:
        panel.set_ylim(bottom=0)
    save(figure, folder, "figure_7_3_amplitudes")


def draw_shape(given: dict[str, Sweep], spread: Spread, folder: Path) -> None:
    """Figures 7.4 and C.6: skewness and kurtosis."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 80, ncols=2)
    draw_parameters(axes, {"rsk": ("Skewness $Rsk$ [-]", 1.0), "rku": ("Kurtosis $Rk$ [-]", 1.0)}, given, spread)
    save(figure, folder, "figure_7_4_shape")

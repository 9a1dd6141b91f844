"""Figures of chapter 4: 4.1 to 4.6 of the thesis (profile D, cut to its first n harmonics), all profiles, and grids."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
from chapter4_claims import ACCURACY, AREA, ELASTIC, KINDS, PLASTIC, Cut
from dry_profiles import PROFILES
from study import save, style

PRINTED = {"elastic": ELASTIC, "plastic": PLASTIC}
LABELS = {"elastic": "elastic", "plastic": "elasto-plastic", "undeformed": "undeformed"}
FINEST = 65536  # nodes
QUANTITIES = {
    "contact_area_fraction": "contact area",
    "plastic_area_fraction": "plastic area",
    "mean_separation": "mean separation",
    "p_max": "largest pressure",
    "dp_mean": "mean plastic deformation",
    "elastic_energy": "stored energy",
    "dissipated_energy": "dissipated energy",
    "ra_loaded": "Ra loaded",
    "ra_unloaded": "Ra unloaded",
    "rsk_loaded": "Rsk loaded",
    "rku_loaded": "Rku loaded",
    "rms_slope_undeformed": "rms slope undeformed",
    "rms_curvature_undeformed": "rms curvature undeformed",
}
PANELS = {"ra": ("$Ra$ [µm]", 1e6), "rz": ("$Rz$ [µm]", 1e6), "rsk": ("Skewness $Rsk$ [-]", 1), "rku": ("Kurtosis $Rk$ [-]", 1)}


def draw_depth(path: Path, folder: Path) -> None:
    """Figures 4.1 and C.3: what the load leaves of the profile; shaded: the plastic deformation."""
    with h5py.File(path) as file:
        x, before, after = (file[f"solution/{name}"][()] for name in ("x", "height_undeformed", "height_unloaded"))
    figure, axes = style.new_figure(style.TWO_COLUMNS, 60)
    axes.fill_between(
        1e3 * x, 1e6 * after, 1e6 * before, color=style.SERIES[1]["color"], linewidth=0.8, label="plastic deformation"
    )
    axes.plot(1e3 * x, 1e6 * after, color="black", linewidth=0.7, label="after 100 kN/m")
    axes.set(xlabel="Position $x$ [mm]", ylabel="Height $z$ [µm]", xlim=(0, 0.4), ylim=(-1.5, 1.7))
    axes.legend(loc="lower right", ncols=2)
    save(figure, folder, "figure_4_1_depth")


def draw_area(cut: Cut, folder: Path) -> None:
    """Figures 4.2 and C.1: contact area over n with the error bars of the results; dotted: the n printed."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 75, ncols=2)
    for panel in axes:
        for kind, look in zip(PRINTED, style.SERIES, strict=False):
            area, error = (100 * cut.series[kind][key] for key in (AREA, f"{AREA}_error"))
            panel.errorbar(cut.harmonics, area, error, label=LABELS[kind], elinewidth=0.6, **look)
            panel.axvline(PRINTED[kind], color=look["color"], linewidth=0.8, linestyle=(0, (1, 1.2)))
        panel.set(xlabel="Harmonics kept $n$ [-]", ylabel="Contact area $A_r/A_n$ [%]", xlim=(0, 256))
    axes[0].set_ylim(0, 100)
    axes[1].set_ylim(0, 12)
    axes[0].legend()
    save(figure, folder, "figure_4_2_area")


def draw_parameters(cut: Cut, folder: Path) -> None:
    """Figures 4.3 to 4.6: Ra, Rz, skewness and kurtosis over n: undeformed, and under the load."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 115, nrows=2, ncols=2, sharex=True)
    lines = []
    for panel, (key, (label, unit)) in zip(axes.flat, PANELS.items(), strict=True):
        lines = []
        for kind, look in zip(LABELS, style.SERIES, strict=False):
            values = cut.series["elastic"][f"{key}_undeformed"] if kind == "undeformed" else cut.series[kind][f"{key}_loaded"]
            lines += panel.plot(cut.harmonics, unit * values, label=LABELS[kind], **(look | {"markevery": 3}))
        panel.set(ylabel=label, xlim=(0, 256))
        if key in ("ra", "rz"):
            panel.set_ylim(bottom=0)
    for panel in axes[1]:
        panel.set_xlabel("Harmonics kept $n$ [-]")
    style.legend_below(figure, lines, 3)
    save(figure, folder, "figure_4_3_to_4_6_parameters")


def draw_truncation(tables: dict[str, dict[str, np.ndarray]], harmonics: list[int], folder: Path) -> None:
    """Area, elastic and plastic, slope and Ra over the number of harmonics."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 120, nrows=2, ncols=2, sharex=True)
    panels = {
        "elastic": ("contact_area_fraction", "Contact area, elastic, over that of all"),
        "plastic": ("contact_area_fraction", "Contact area, plastic, over that of all"),
        "slope": ("rms_slope_undeformed", "Rms slope over that of all"),
        "height": ("rq_undeformed", "$Rq$ over that of all"),
    }
    for panel, (kind, (column, label)) in zip(axes.flat, panels.items(), strict=True):
        for name, series in zip(PROFILES, style.SERIES, strict=False):
            values = tables[f"{name}_{kind if kind in KINDS else 'elastic'}"][column]
            draw = panel.loglog if kind in KINDS else panel.semilogx
            draw(harmonics, values / values[-1], label=name, **series)
        panel.axhspan(1 - ACCURACY, 1 + ACCURACY, color="0.9", linewidth=0)
        panel.set(ylabel=label)
    for panel in axes[1]:
        panel.set_xlabel("Harmonics kept $n$ [-]")
    axes[0, 0].legend(ncols=2)
    save(figure, folder, "chapter4_truncation")


def draw_grids(errors: dict[str, dict[str, np.ndarray]], grids: list[int], folder: Path) -> None:
    """Error of some quantities over the number of nodes: of the contact, then of heights."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 90, ncols=2, sharey=True)
    panels = {
        "Contact": ("contact_area_fraction", "plastic_area_fraction", "mean_separation", "dissipated_energy"),
        "Heights": ("ra_loaded", "rsk_loaded", "rms_slope_undeformed", "rms_curvature_undeformed"),
    }
    for panel, (title, names) in zip(axes, panels.items(), strict=True):
        for name, series in zip(names, style.SERIES, strict=False):
            values = errors["plastic"][name]
            panel.loglog(grids, 100 * np.where(values > 0, values, np.nan), label=QUANTITIES[name], **series)
        guide = np.array([grids[0], grids[-1]], dtype=float)
        panel.loglog(guide, 30 * guide[0] / guide, label="first order", **style.REFERENCE)
        panel.set(xlabel="Nodes", title=title)
        panel.set_xticks(grids[::2], grids[::2])
        panel.minorticks_off()
        panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), ncols=2)
    axes[0].set_ylabel(f"Difference to {FINEST} nodes [%]")
    save(figure, folder, "chapter4_grids")

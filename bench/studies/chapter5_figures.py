"""The figures of chapter 5, in SI units as printed, and the time errors over the step."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from study import Table, save, style

CENTRES = (-1.0, -0.5, 0.0, 0.5, 1.0)
SPEEDS = {"case2": 1 / 6, "case3": 11 / 6}
TITLES = {"case2": "ridge on the slow surface (0.1 m/s)", "case3": "ridge on the fast surface (1.1 m/s)"}
WINDOW = (-0.22, 0.13)  # mm
CENTRE = {"color": "0.35", "linewidth": 0.6, "linestyle": (0, (4, 3)), "zorder": 0}


def draw(folder: Path, smooth: object, passages: dict[str, object], times: Table) -> None:
    """All figures of the chapter."""
    draw_smooth(folder, smooth)
    for number, (name, passage) in enumerate(passages.items(), start=2):
        draw_passage(folder, smooth, name, passage, number)
    draw_times(folder, times)


def two_axes(axes: object, smooth: object, pressure: np.ndarray, film: np.ndarray) -> list:
    """Film on the left, pressure on the right."""
    twin = axes.twinx()
    x = 1e3 * smooth.half_width * smooth.x
    lines = axes.plot(x, 1e6 * smooth.film_scale * film, label="film", **style.FILM)
    lines += twin.plot(x, 1e-9 * smooth.hertz_pressure * pressure, label="pressure", **style.PRESSURE)
    axes.set(xlim=WINDOW, ylim=(0, 2), ylabel="$h$ [µm]")
    twin.set(ylim=(0, 1), ylabel="$p$ [GPa]")
    axes.tick_params(right=False)
    twin.tick_params(left=False)
    return lines


def draw_smooth(folder: Path, smooth: object) -> None:
    """Figure 5.1."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 62)
    lines = two_axes(axes, smooth, smooth.pressure, smooth.film)
    axes.set_xlabel("Position $x$ [mm]")
    style.legend_below(figure, lines, 2)
    save(figure, folder, "figure_5_1_smooth")


def draw_passage(folder: Path, smooth: object, name: str, passage: object, number: int) -> None:
    """Figures 5.2 and 5.3: five places of the ridge."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 190, nrows=len(CENTRES), sharex=True)
    for panel, centre in zip(axes, CENTRES, strict=True):
        step = int(np.argmin(np.abs(-2.5 + SPEEDS[name] * passage.time - centre)))
        lines = two_axes(panel, smooth, passage.pressure[step], passage.film[step])
        lines += panel.plot(
            1e3 * smooth.half_width * smooth.x, 1e6 * smooth.film_scale * smooth.film, label="smooth film", **style.REFERENCE
        )
        place = -2.5 + SPEEDS[name] * passage.time[step]
        lines.append(panel.axvline(1e3 * smooth.half_width * place, label="centre of the ridge", **CENTRE))
        text = f"ridge at $X$ = {centre:g}, $T$ = {passage.time[step]:.2f}".replace("-", "\N{MINUS SIGN}")
        panel.set_title(text)
    axes[-1].set_xlabel("Position $x$ [mm]")
    figure.suptitle(f"Case {name[-1]}: {TITLES[name]}", fontsize=9)
    style.legend_below(figure, lines, 2)
    save(figure, folder, f"figure_5_{number}_{name}")


def draw_times(folder: Path, times: Table) -> None:
    """Time error (5.5) and true error over the step, with the printed values."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 78)
    printed = {"case2": (1.0, 0.057), "case3": (0.5, 1.04)}
    for name, look in zip(TITLES, style.SERIES, strict=False):
        rows = [row for row in times.rows if row["case"] == name]
        halved = [row for row in rows if row["pressure"] is not None]
        label = f"Case {name[-1]}"
        axes.loglog([r["ratio"] for r in halved], [r["pressure"] for r in halved], label=f"{label}: (5.5)", **look)
        hollow = {**look, "linestyle": (0, (1, 2)), "markerfacecolor": "white"}
        axes.loglog([r["ratio"] for r in rows], [r["true_pressure"] for r in rows], label=f"{label}: true error", **hollow)
        axes.plot(
            *printed[name], "*", color=look["color"], markersize=9, markerfacecolor="white", label=f"{label}: thesis", zorder=5
        )
    axes.set(xlabel="Time step $\\Delta T/\\Delta X$ [-]", ylabel="Error of $P$ [% of $p_\\mathrm{h}$]")
    axes.axvline(1, color="0.6", linewidth=0.6, zorder=0)
    axes.text(1.15, 0.03, "$\\Delta T = \\Delta X$", transform=axes.get_xaxis_transform(), va="bottom", color="0.35")
    style.legend_below(figure, axes.get_legend_handles_labels()[0], 2)
    save(figure, folder, "time_errors")

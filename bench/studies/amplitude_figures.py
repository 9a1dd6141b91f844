"""The figures of the amplitude study: master curve, rolling-sliding, linearity."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from study import Table, save, style

Curve = Callable[[np.ndarray], np.ndarray]
RATIO = "$A_\\mathrm{d}/A_\\mathrm{i}$ [-]"


def draw(
    folder: Path, master: Table, sliding: Table, linear: Table, curves: dict[str, Curve], fit: tuple[float, float, float]
) -> None:
    """All figures."""
    draw_master(folder, master, curves, fit)
    draw_sliding(folder, sliding, curves["published"])
    draw_linear(folder, linear)


def draw_master(folder: Path, master: Table, curves: dict[str, Curve], fit: tuple[float, float, float]) -> None:
    """Figure 2.1 of the thesis with our points."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 92)
    nabla = np.geomspace(0.3, 300, 200)
    look = {"color": "0.25", "linewidth": 1.0}
    axes.loglog(nabla, curves["published"](nabla), label="Venner et al. 1997", linestyle="-", **look)
    axes.loglog(nabla, curves["thesis"](nabla), label="thesis (2.1), $s$ = 1", linestyle=(0, (5, 2)), **look)
    axes.loglog(
        nabla, 1 / (1 + fit[0] * nabla + fit[1] * nabla**2), label="best of this form for $w$ < 20", linestyle=(0, (1, 1.2)), **look
    )
    points = list(dict.fromkeys((row["moes_m"], row["moes_l"]) for row in master.rows))
    for point, series in zip(points, style.SERIES, strict=True):
        rows = [row for row in master.rows if (row["moes_m"], row["moes_l"]) == point]
        values = [[row[name] for row in rows] for name in ("nabla", "ratio", "error")]
        marks = {**series, "linestyle": "none"}
        axes.errorbar(*values, label="$M$ = {:g}, $L$ = {:g}".format(*point), capsize=2, elinewidth=0.7, **marks)
    axes.set(xlabel="$(\\Lambda/b)\\, M^{3/4} L^{-1/2}$ [-]", ylabel=RATIO, xlim=(0.4, 250), ylim=(2e-3, 1.3))
    style.legend_below(figure, axes.get_legend_handles_labels()[0], 2)
    save(figure, folder, "amplitude_master")


def draw_sliding(folder: Path, sliding: Table, curve: Curve) -> None:
    """Amplitude and lag over the slide-to-roll ratio, and the amplitude on the master curve with the speed of the waviness."""
    figure, (left, middle, right) = style.new_figure(style.TWO_COLUMNS, 78, ncols=3)
    wavelengths = list(dict.fromkeys(row["wavelength"] for row in sliding.rows))
    for wavelength, look in zip(wavelengths, style.SERIES, strict=False):
        rows = [row for row in sliding.rows if row["wavelength"] == wavelength]
        slips, carried, error = ([row[name] for row in rows] for name in ("slip", "carried", "error"))
        left.errorbar(slips, carried, error, label=f"$\\Lambda/b$ = {wavelength:g}", capsize=2, elinewidth=0.7, **look)
        hollow = {**look, "linestyle": "none", "markerfacecolor": "none"}
        left.plot(slips, [row["in_place"] for row in rows], **hollow)
        middle.plot(slips, [row["lag"] for row in rows], **look)
        moving = [row for row in rows if row["speed"] > 0]
        right.errorbar(
            *([row[name] for row in moving] for name in ("nabla", "carried", "error")), capsize=2, **{**look, "linestyle": "none"}
        )
    nabla = np.geomspace(1.4, 40, 200)
    line = right.plot(nabla, curve(nabla), color="0.25", linewidth=1.0, label="Venner et al. 1997, pure rolling")
    slip_label = "Slide-to-roll ratio $s$ [-]"
    left.set(xlabel=slip_label, ylabel="$|A_\\mathrm{d}/A_\\mathrm{i}|$ [-]", yscale="log", ylim=(5e-4, 1.2))
    middle.set(xlabel=slip_label, ylabel="Lag at $X$ = −1 [degrees]")
    right.set(
        xlabel="$(\\Lambda/b)\\, M^{3/4} L^{-1/2} v^{-1/2}$ [-]",
        ylabel="$|A_\\mathrm{d}/A_\\mathrm{i}|$ [-]",
        xscale="log",
        yscale="log",
        xlim=(1, 60),
        ylim=(1.5e-2, 1.2),
    )
    hollow_mark = style.plt.Line2D(
        [], [], color="0.3", marker="o", markerfacecolor="none", linestyle="none", label="part that moves with the surface"
    )
    style.legend_below(figure, [*left.get_legend_handles_labels()[0], hollow_mark, *line], 3)
    save(figure, folder, "amplitude_sliding")


def draw_linear(folder: Path, linear: Table) -> None:
    """Change of the ratio and second harmonic over the amplitude."""
    figure, (upper, lower) = style.new_figure(style.ONE_COLUMN, 105, nrows=2, sharex=True)
    kinds = list(dict.fromkeys((row["slip"], row["wavelength"]) for row in linear.rows))
    for (slip, wavelength), look in zip(kinds, style.SERIES, strict=False):
        rows = [row for row in linear.rows if (row["slip"], row["wavelength"]) == (slip, wavelength)]
        amplitudes = [row["amplitude"] for row in rows]
        label = f"$\\Lambda/b$ = {wavelength:g}" + (f", $s$ = {slip:g}".replace("-", "\N{MINUS SIGN}") if slip else "")
        upper.plot(amplitudes, [row["change"] for row in rows], label=label, **look)
        lower.plot(amplitudes, [100 * row["second"] for row in rows], **look)
    upper.set(ylabel="Change of $|A_\\mathrm{d}/A_\\mathrm{i}|$ [%]")
    upper.axhline(0, color="0.6", linewidth=0.6, zorder=0)
    lower.set(
        xlabel="Amplitude $A_\\mathrm{i}/h_\\mathrm{c}$ [-]", ylabel="Second harmonic [% of first]", xlim=(0, 1.55), ylim=(0, None)
    )
    style.legend_below(figure, upper.get_legend_handles_labels()[0], 2)
    save(figure, folder, "amplitude_linearity")

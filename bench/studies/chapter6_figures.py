"""The figures of chapter 6, with the numbers of the thesis: 6.1 ... 6.10."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from chapter6_claims import DEPTHS, SLIPS, WIDTHS, Fields, Found
from overtaking import AMPLITUDE, MEETING, WAVELENGTH, Situation
from study import save, style

HALF_WIDTH = 1.05797e-4  # m
LINES = {"film": style.FILM, "reference": style.REFERENCE, "pressure": style.PRESSURE}
THINNING = "Film thinning $\\xi$ [-]"
# The axes of the dents; the thesis has the amplitude l_2 in units of 0.2 um and the wavelength m_2 in units of 0.1 mm.
UM, MM = 1e6 * AMPLITUDE, 1e3 * WAVELENGTH
DEPTH, WIDTH = "Dent depth [µm]", "Dent wavelength [mm]"
DEPTHS_UM, WIDTHS_MM = [-UM * depth for depth in DEPTHS], [MM * width for width in WIDTHS]
DEPTH_LIMITS = (UM * 0.9, UM * 6.1)
COARSE = {"linestyle": "none", "markerfacecolor": "none", "markersize": 3.0, "alpha": 0.8}


def draw(folder: Path, profiles: dict[str, Path], found: Found, overtakings: dict[str, Situation]) -> None:
    """All figures of the chapter."""
    draw_situations(folder, overtakings)
    fields = {words: Fields(profiles[words], item.meeting_time) for words, item in overtakings.items()}
    draw_maps(folder, fields, overtakings)
    draw_steps(folder, profiles, overtakings["dent-ridge"].meeting_time)
    draw_contours(folder, found)
    draw_slips(folder, found)
    draw_ridges(folder, found)
    draw_load(folder, found)


def draw_situations(folder: Path, overtakings: dict[str, Situation]) -> None:
    """Figure 6.1: the surfaces of the four situations, 0.8 half-widths apart."""
    x = np.linspace(-1.6, 1.6, 801)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 42, ncols=4, sharey=True)
    for panel, (words, item) in zip(axes, overtakings.items(), strict=True):
        for height, centre, side in ((item.l1, 0.4, -1), (item.l2, -0.4, 1)):
            shape = shape_of(x - centre, height)
            level = side * (1.0 - shape)
            panel.plot(x, level, color="black", linewidth=1.0)
            panel.fill_between(x, level, side * 2.0, color="0.85", linewidth=0)
            speed = 0.45 if side > 0 else 0.18
            arrow = {"arrowstyle": "-|>", "linewidth": 0.8, "color": "black"}
            panel.annotate("", (centre + speed, side * 1.72), (centre - speed, side * 1.72), arrowprops=arrow)
            panel.text(1.45, side * 1.72, f"$u_{1 if side < 0 else 2}$", ha="right", va="center")
        panel.set(title=words.capitalize(), xlabel="$X$ [-]", ylim=(-2, 2), xlim=(-1.6, 1.6), yticks=[])
        style.few_ticks(panel, 4)
    save(figure, folder, "figure_6_1_situations")


def shape_of(distance: np.ndarray, height: float) -> np.ndarray:
    """A feature (5.4) with m = 1, height in units of 0.2 um, over the distance in half-widths."""
    ratio = distance * HALF_WIDTH / WAVELENGTH
    return height * AMPLITUDE / 2e-7 * 0.5 * 10 ** (-10 * ratio**2) * np.cos(2 * np.pi * ratio)


def draw_maps(folder: Path, fields: dict[str, Fields], overtakings: dict[str, Situation]) -> None:
    """Figures 6.2 to 6.5: film over X and T, the paths of both features, the smallest film."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 150, nrows=2, ncols=2, sharex=True, sharey=True)
    for number, (panel, (words, item)) in enumerate(zip(axes.flat, fields.items(), strict=True), start=2):
        rows = np.flatnonzero((item.time >= -1.5) & (item.time <= 1.3))[::2]
        columns = np.flatnonzero(np.abs(item.x) <= 1.05)
        film = item.film[np.ix_(rows, columns)]
        options = {"cmap": style.COLOUR_MAP, "vmin": 0.2, "vmax": 0.9, "shading": "nearest", "rasterized": True}
        image = panel.pcolormesh(item.x[columns], item.time[rows], film, **options)
        lines = panel.contour(
            item.x[columns], item.time[rows], film, levels=np.arange(0.2, 0.9, 0.05), colors="white", linewidths=0.3
        )
        lines.set_alpha(0.7)
        ends = np.array([-1.5, 1.3])
        for speed, dash in zip(overtakings[words].speeds, ((0, (2, 2)), (0, (6, 3))), strict=True):
            panel.plot(MEETING + speed * ends, ends, color="black", linewidth=0.9, linestyle=dash, scalex=False)
        value, x, time = item.film_minimum()
        panel.plot(x, time, "o", markerfacecolor="white", markeredgecolor="black", markersize=5, zorder=5)
        panel.set_title(f"Fig. 6.{number}: {words}, $H_\\mathrm{{min}}$ = {value:.3f}")
        panel.set(xlim=(-1, 1), ylim=(-1.5, 1.3))
    for panel in axes[1]:
        panel.set_xlabel("Position $X = x/b$ [-]")
    for panel in axes[:, 0]:
        panel.set_ylabel("Time after the meeting $T - T_\\mathrm{c}$ [-]")
    figure.colorbar(image, ax=axes, label="Film thickness $H = hR/b^2$ [-]", extend="max", aspect=40)
    handles = [
        style.plt.Line2D([], [], color="black", linewidth=0.9, linestyle=(0, (6, 3)), label="fast feature (surface 2)"),
        style.plt.Line2D([], [], color="black", linewidth=0.9, linestyle=(0, (2, 2)), label="slow feature (surface 1)"),
        style.plt.Line2D(
            [], [], color="black", marker="o", markerfacecolor="white", linestyle="none", label="smallest film of the passage"
        ),
    ]
    style.legend_below(figure, handles, 3)
    save(figure, folder, "figure_6_2_to_6_5_overtakings")


def draw_steps(folder: Path, profiles: dict[str, Path], meeting_time: float) -> None:
    """Figure 6.6: the deep dent over the ridge at four times."""
    both, ridge = Fields(profiles["deep dent-ridge"], meeting_time), Fields(profiles["ridge alone"], meeting_time)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 110, nrows=2, ncols=2, sharex=True, sharey=True)
    for panel, time in zip(axes.flat, (-0.5, -0.17, 0.1, 0.4), strict=True):
        step = both.step_at(time)
        panel.plot(both.x, both.film[step], label="film $H$", **LINES["film"])
        panel.plot(ridge.x, ridge.film[step], label="film of the ridge alone $H_\\mathrm{ref}$", **LINES["reference"])
        panel.plot(both.x, both.pressure[step], label="pressure $P$", **LINES["pressure"])
        for speed, marker in ((1 / 3, "v"), (5 / 3, "^")):
            place = MEETING + speed * both.time[step]
            panel.plot(
                place, 1, marker, color="black", markersize=4.5, transform=panel.get_xaxis_transform(), clip_on=False, zorder=5
            )
        panel.set_title(f"$T - T_\\mathrm{{c}}$ = {both.time[step]:+.2f}".replace("-0", "\N{MINUS SIGN}0"), y=1.03)
        panel.set(xlim=(-2, 1.5), ylim=(0, 1.65))
    for panel in axes[1]:
        panel.set_xlabel("Position $X = x/b$ [-]")
    for panel in axes[:, 0]:
        panel.set_ylabel("$H$, $P$ [-]")
    handles = axes[0, 0].get_legend_handles_labels()[0]
    for marker, words in (("v", "ridge"), ("^", "dent")):
        handles.append(style.plt.Line2D([], [], color="black", marker=marker, linestyle="none", label=words))
    style.legend_below(figure, handles, 5)
    save(figure, folder, "figure_6_6_dent_over_ridge")


def draw_contours(folder: Path, found: Found) -> None:
    """Figure 6.7: xi over width and depth of the dent, form (b)."""
    xi = np.array([[found["b"][Situation(5, l2=depth, m2=width)].xi for width in WIDTHS] for depth in DEPTHS])
    figure, axes = style.new_figure(style.ONE_COLUMN, 75)
    levels = np.arange(0.1, 0.51, 0.05)
    image = axes.contourf(WIDTHS_MM, DEPTHS_UM, xi, levels=levels, cmap=style.COLOUR_MAP, extend="both")
    lines = axes.contour(WIDTHS_MM, DEPTHS_UM, xi, levels=levels, colors="black", linewidths=0.6)
    places = [(3 * MM, UM * depth) for depth in (1.3, 1.8, 2.3, 3, 3.8, 4.7, 5.7)]
    for text in axes.clabel(lines, fmt="%.2f", fontsize=8, inline=True, manual=places):
        text.set_bbox({"facecolor": "white", "alpha": 0.6, "pad": 0.4, "linewidth": 0})
    edge = [(MM * w, -UM * d) for d in DEPTHS for w in WIDTHS if found["b"][Situation(5, l2=d, m2=w)].edge == "inlet"]
    axes.plot(
        *np.array(edge).T,
        "s",
        markersize=3,
        markerfacecolor="white",
        markeredgecolor="black",
        clip_on=False,
        zorder=5,
        label="largest at the inlet end, $X$ = −1.3",
    )
    figure.colorbar(image, ax=axes, label=THINNING)
    axes.set(xlabel=WIDTH, ylabel=DEPTH, xlim=(0.9 * MM, 7.1 * MM), ylim=DEPTH_LIMITS)
    style.legend_below(figure, axes.get_legend_handles_labels()[0], 1)
    save(figure, folder, "figure_6_7_depth_and_width")


def draw_series(axes: object, values: list[int], found: Found, items: list[Situation], look: dict[str, object], label: str) -> None:
    """One line of form (b) with error bars, and form (a) as open marks."""
    xi, error = np.array([error_of(found, item) for item in items]).T
    axes.errorbar(values, xi, error, label=label, capsize=2, elinewidth=0.7, **look)
    coarse = [found["a"][item].xi for item in items]
    axes.plot(values, coarse, color=look["color"], marker=look["marker"], **COARSE)


def error_of(found: Found, item: Situation) -> tuple[float, float]:
    """The value of form (b) and its error."""
    b, step, grid = (found[form][item].xi for form in ("b", "b_step", "b_grid"))
    return b, (abs(b - step) + abs(step - grid)) / 3


def finish_series(figure: object, axes: object, columns: int) -> None:
    """Legend with an entry for the open marks."""
    handles, labels = axes.get_legend_handles_labels()
    open_mark = style.plt.Line2D([], [], color="0.3", marker="o", markerfacecolor="none", linestyle="none", label="thesis grid (a)")
    handles.append(open_mark)
    figure.legend(
        handles=handles, labels=[*labels, "thesis grid (a)"], loc="outside lower center", ncols=columns, columnspacing=1.4
    )


def draw_slips(folder: Path, found: Found) -> None:
    """Figure 6.8: xi over the depth for five slide-to-roll ratios."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 78)
    names = {5: "5/3", 4: "4/3", 3: "1", 2: "2/3", 1: "1/3"}
    for slip, look in zip(reversed(SLIPS), style.SERIES, strict=False):
        draw_series(axes, DEPTHS_UM, found, [Situation(slip, l2=depth) for depth in DEPTHS], look, f"$s$ = {names[slip]}")
    axes.set(xlabel=DEPTH, ylabel=THINNING, ylim=(0, 0.5), xlim=DEPTH_LIMITS)
    finish_series(figure, axes, 3)
    save(figure, folder, "figure_6_8_slide_to_roll")


def draw_ridges(folder: Path, found: Found) -> None:
    """Figure 6.9: xi over the dent width for two ridge heights, l2 = -2."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 72)
    for height, look in zip((1, 2), style.SERIES, strict=False):
        items = [Situation(5, l1=height, l2=-2, m2=width) for width in WIDTHS]
        draw_series(axes, WIDTHS_MM, found, items, look, f"ridge {UM * height:.1f} µm")
    axes.set(xlabel=WIDTH, ylabel=THINNING, ylim=(0.18, 0.3))
    finish_series(figure, axes, 2)
    save(figure, folder, "figure_6_9_ridge_amplitude")


def draw_load(folder: Path, found: Found) -> None:
    """Figure 6.10: xi over the depth for two loads."""
    figure, axes = style.new_figure(style.ONE_COLUMN, 72)
    for load, look in zip((1e5, 2e5), style.SERIES, strict=False):
        label = f"$w$ = {load / 1e3:.0f} kN/m"
        draw_series(axes, DEPTHS_UM, found, [Situation(5, load=load, l2=depth) for depth in DEPTHS], look, label)
    axes.set(xlabel=DEPTH, ylabel=THINNING, ylim=(0.1, 0.5), xlim=DEPTH_LIMITS)
    finish_series(figure, axes, 2)
    save(figure, folder, "figure_6_10_load")

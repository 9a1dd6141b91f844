#!/usr/bin/env python3
"""Draws dry contacts: the profile with pressure, or maps of heights and pressure; the load sweep; the heights; the convergence."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

import figure_command
import figure_style as style
import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from result_file import LARGEST, ResultError, inputs_of, opened, prefix_of, values_of

PROGRAM = "dry.py"
EXAMPLE = "python postproc/dry.py results/dry_profile.h5 --output results"
# Pressures on white ground: the smallest one is no longer pale.
PRESSURES = LinearSegmentedColormap.from_list("pressures", matplotlib.colormaps["magma_r"](np.linspace(0.25, 1, 128)))
STATES = ("undeformed", "loaded", "unloaded")
PROFILE_FIELDS = ["pressure", "gap", *(f"height_{state}" for state in STATES)]
# A profile of more nodes is drawn as a band, beside this many nodes round its largest pressure.
MAX_NODES, DETAIL_NODES = 1200, 300
# Bands of wavelengths in each factor of 10.
BANDS = 10


@dataclass
class DryResult:
    """What a dry result holds, in SI: datasets by name of each group."""

    path: Path
    converged: bool
    reason: str
    solution: dict[str, np.ndarray]
    sweep: dict[str, np.ndarray]
    surface: dict[str, np.ndarray]
    history: np.ndarray
    tolerance: float
    hardness: float | None
    # Error estimates of datasets of the sweep.
    errors: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def stem(self) -> str:
        """Name of the file without its ending."""
        return self.path.stem

    @property
    def is_line(self) -> bool:
        """A profile, not an area."""
        return "y" not in self.solution


def read_dry(path: Path) -> DryResult:
    """Reads a result; ResultError if it is not one of a dry contact."""
    with opened(path) as file:
        problem = file.attrs.get("problem", b"")
        problem = problem.decode() if isinstance(problem, bytes) else str(problem)
        if not problem.startswith("dry_") or "sweep" not in file:
            raise ResultError(f"{path}: not a dry result of asperity (problem is '{problem}')")
        groups = [
            {name: values_of(item, LARGEST) for name, item in file[group].items()} for group in ("solution", "sweep", "surface")
        ]
        hardness = inputs_of(file, "bodies").get("hardness")
        reason = file.attrs.get("reason", b"")
        return DryResult(
            path,
            bool(file.attrs.get("converged", 0)),
            reason.decode() if isinstance(reason, bytes) else str(reason),
            *groups,
            np.atleast_1d(values_of(file["report/residual_history"])),
            float(inputs_of(file, "solver")["tolerance"]),
            None if hardness is None else float(hardness),
            {name: item.attrs["error_estimate"] for name, item in file["sweep"].items() if "error_estimate" in item.attrs},
        )


def unit(values: np.ndarray, name: str) -> tuple[float, str]:
    """Factor and prefixed unit that suit the largest of the values."""
    largest = float(np.max(np.abs(values), initial=0.0))
    size, prefix = prefix_of(largest)
    return 1 / size, prefix + name


def load_of(result: DryResult) -> str:
    """The last load, whose fields the file holds, in words."""
    last = result.sweep["mean_pressure"][-1:]
    factor, name = unit(last, "Pa")
    return f"Mean pressure {last[0] * factor:.4g} {name}, contact {100 * result.sweep['contact_area_fraction'][-1]:.3g} %"


def draw_profile(result: DryResult) -> Figure:
    """Pressure above, heights below: undeformed, under load, after load. A long profile as a band, with a detail beside it."""
    x = result.solution["x"]
    is_long = x.size > MAX_NODES
    figure, panels = style.new_figure(style.TWO_COLUMNS, 95, nrows=2, ncols=1 + is_long, sharex="col", sharey="row", squeeze=False)
    units = {name: unit(result.solution[key], si) for name, key, si in (("p", "pressure", "Pa"), ("z", "height_undeformed", "m"))}
    if is_long:
        draw_bands(result, *panels[:, 0], *unit(x, "m"), units)
        peak = int(result.solution["pressure"].argmax())
        first = min(max(0, peak - DETAIL_NODES // 2), x.size - DETAIL_NODES)
        part = slice(first, first + DETAIL_NODES)
        factor, name = unit(x[part] - x[first], "m")
        handles = draw_lines(result, *panels[:, 1], part, factor, name, units)
        start = x[first] * unit(x, "m")[0]
        panels[1, 1].set_xlabel(f"Position $x$ [{name}]: {DETAIL_NODES} nodes round the largest pressure")
        for panel in panels[:, 0]:
            panel.axvspan(start, x[part][-1] * unit(x, "m")[0], color="0.88", zorder=0)
    else:
        handles = draw_lines(result, *panels[:, 0], slice(None), *unit(x, "m"), units)
    panels[0, 0].set_ylabel(f"Pressure $p$ [{units['p'][1]}]")
    panels[0, 0].set_ylim(bottom=0)
    panels[1, 0].set_ylabel(f"Height $z$ [{units['z'][1]}]")
    figure.suptitle(load_of(result), fontsize=9)
    style.legend_below(figure, handles, 4)
    return figure


def draw_lines(
    result: DryResult, top: Axes, bottom: Axes, part: slice, factor: float, name: str, units: dict[str, tuple[float, str]]
) -> list:
    """Pressure and heights of some nodes; returns the lines of the heights."""
    solution, x = result.solution, result.solution["x"][part] * factor
    fp, fz = units["p"][0], units["z"][0]
    top.plot(x, solution["pressure"][part] * fp, **style.PRESSURE)
    if result.hardness and solution["pressure"].max() >= result.hardness:
        top.axhline(result.hardness * fp, **style.REFERENCE)
        look = {"textcoords": "offset points", "fontsize": 8, "ha": "right", "va": "bottom", "annotation_clip": False}
        top.annotate("hardness", (1, result.hardness * fp), (-6, 1), xycoords=("axes fraction", "data"), **look)
        top.set_ylim(top=1.2 * result.hardness * fp)
    lines = []
    for state, series in zip(STATES, style.SERIES, strict=False):
        look = {key: series[key] for key in ("color", "linestyle")}
        lines += bottom.plot(x, solution[f"height_{state}"][part] * fz, label=state, **look)
    plane = (solution["height_loaded"] + solution["gap"]).mean() * fz
    lines.append(bottom.axhline(plane, label="counterbody", **style.REFERENCE))
    bottom.set(xlabel=f"Position $x$ [{name}]", xlim=(x[0], x[-1]))
    return lines


def draw_bands(result: DryResult, top: Axes, bottom: Axes, factor: float, name: str, units: dict[str, tuple[float, str]]) -> None:
    """A long profile: in each of some hundred columns the largest pressure, the lowest and the highest height."""
    solution, size = result.solution, result.solution["x"].size
    starts = np.linspace(0, size, 400, endpoint=False).astype(int)
    x = solution["x"][starts] * factor
    top.fill_between(x, 0, np.maximum.reduceat(solution["pressure"], starts) * units["p"][0], color=style.PRESSURE["color"], lw=0)
    heights = solution["height_loaded"] * units["z"][0]
    bottom.fill_between(x, np.minimum.reduceat(heights, starts), np.maximum.reduceat(heights, starts), color="0.45", lw=0)
    bottom.set(xlabel=f"Position $x$ [{name}]", xlim=(x[0], solution["x"][-1] * factor))


def draw_maps(result: DryResult) -> Figure:
    """Maps of the undeformed heights, where they are stored, and of the pressure, black where it is the hardness."""
    solution, name = result.solution, "height_undeformed"
    has_heights = name in solution
    figure, panels = style.new_figure(style.TWO_COLUMNS, 78, ncols=1 + has_heights, sharey=True, squeeze=False)
    fx, ux = unit(solution["x"], "m")
    fp, up = unit(solution["pressure"], "Pa")
    half = 0.5 * (solution["x"][1] - solution["x"][0]), 0.5 * (solution["y"][1] - solution["y"][0])
    extent = [
        (solution["x"][0] - half[0]) * fx,
        (solution["x"][-1] + half[0]) * fx,
        (solution["y"][0] - half[1]) * fx,
        (solution["y"][-1] + half[1]) * fx,
    ]
    look = {"origin": "lower", "extent": extent, "interpolation": "nearest"}
    maps = [(np.ma.masked_equal(solution["pressure"] * fp, 0), f"Pressure $p$ [{up}]", PRESSURES)]
    if has_heights:
        fz, uz = unit(solution[name], "m")
        maps.insert(0, (solution[name] * fz, f"Undeformed height $z$ [{uz}]", style.COLOUR_MAP))
    for panel, (values, label, colours) in zip(panels[0], maps, strict=True):
        figure.colorbar(panel.imshow(values, cmap=colours, **look), ax=panel, label=label, shrink=0.8)
        panel.set_xlabel(f"$x$ [{ux}]")
    panels[0, 0].set_ylabel(f"$y$ [{ux}]")
    figure.suptitle(load_of(result), fontsize=9)
    figure.get_layout_engine().set(wspace=0.06)
    return figure


def draw_sweep(result: DryResult) -> Figure:
    """Areas, separation and roughness over the load, with the error estimates of the result."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 72, ncols=3)
    sweep, handles = result.sweep, []
    order = np.argsort(sweep["mean_pressure"])
    fp, up = unit(sweep["mean_pressure"], "Pa")
    load = sweep["mean_pressure"][order] * fp
    curves: list[tuple[Axes, str, str, str]] = [
        (axes[0], "contact_area_fraction", "contact area", "1"),
        (axes[0], "plastic_area_fraction", "plastic area", "1"),
        (axes[1], "mean_separation", "mean separation", "m"),
        (axes[2], "ra_undeformed", "$Ra$ undeformed", "m"),
        (axes[2], "ra_loaded", "$Ra$ loaded", "m"),
        (axes[2], "ra_unloaded", "$Ra$ unloaded", "m"),
    ]
    looks = dict(zip((curve[1] for curve in curves), style.SERIES, strict=True))
    for panel, labels in zip(axes, ("Area over nominal area [-]", "Mean separation", "$Ra$"), strict=True):
        mine = [curve for curve in curves if curve[0] is panel]
        factor, name = (1.0, "") if mine[0][3] == "1" else unit(np.concatenate([sweep[curve[1]] for curve in mine]), "m")
        for _, key, label, _ in mine:
            error = result.errors[key][order] * factor if key in result.errors else None
            every = max(1, len(load) // 12)
            look = {"markevery": every, "errorevery": every, "elinewidth": 0.7, "capsize": 2}
            handles.append(panel.errorbar(load, sweep[key][order] * factor, error, label=label, **look, **looks[key]))
        panel.set(xlabel=f"Mean pressure [{up}]", ylabel=labels + (f" [{name}]" if name else ""))
    axes[0].set_ylim(bottom=0)
    style.legend_below(figure, handles, 3)
    return figure


def draw_surface(result: DryResult) -> Figure:
    """Bearing curves, height densities and, of periodic surfaces, the spectrum: before, under and after load."""
    surface = result.surface
    has_power = "power_undeformed" in surface
    figure, panels = style.new_figure(style.TWO_COLUMNS, 66, ncols=2 + has_power)
    (fx, ux), (fz, uz) = unit(result.solution["x"], "m"), unit(surface["level"], "m")
    lines = []
    for state, series in zip(STATES, style.SERIES, strict=False):
        look = {key: series[key] for key in ("color", "linestyle")}
        lines += panels[0].plot(100 * surface[f"bearing_ratio_{state}"], surface["level"] * fz, label=state, **look)
        density = surface[f"height_density_{state}"] / fz
        panels[1].stairs(density, surface["density_edge"] * fz, orientation="horizontal", **look)
        if has_power:
            wavelengths, power = spectrum(result, state)
            shown = power > 1e-16 * power.max()
            panels[2].loglog(wavelengths[shown] * fx, power[shown] * fz**2, **look)
    panels[0].set(xlabel="Bearing ratio [%]", ylabel=f"Height [{uz}]", xlim=(0, 100))
    panels[1].set(xlabel=f"Height density [1/{uz}]", ylim=panels[0].get_ylim())
    panels[1].set_xlim(left=0)
    if has_power:
        panels[2].set(xlabel=f"Wavelength [{ux}]", ylabel=f"Mean square height of a band [{uz}$^2$]")
    style.legend_below(figure, lines, 3)
    return figure


def spectrum(result: DryResult, state: str) -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths [m] and the mean square height of their bands [m^2]: the sum over all bands is that of the surface."""
    power, x = result.surface[f"power_{state}"], result.solution["x"]
    wavelengths = (x[-1] - x[0]) * x.size / (x.size - 1) / np.arange(1, power.size + 1)
    band = np.round(BANDS * np.log10(wavelengths / wavelengths[-1])).astype(int)
    sums = np.bincount(band, power)
    used = np.flatnonzero(np.bincount(band))
    return wavelengths[-1] * 10 ** (used / BANDS), sums[used]


def draw_convergence(result: DryResult) -> Figure:
    """The error over the iterations for the last load."""
    figure, panel = style.new_figure(style.ONE_COLUMN, 62)
    look = {key: style.SERIES[0][key] for key in ("color", "linestyle")}
    panel.semilogy(np.arange(result.history.size), np.maximum(result.history, np.finfo(float).tiny), **look)
    panel.axhline(result.tolerance, label="bound", **style.REFERENCE)
    panel.legend()
    panel.set(xlabel="Iteration", ylabel="Violation of the contact conditions [-]")
    panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    return figure


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """All figures of one result; returns their names."""
    result = read_dry(path)
    figure_command.warn_not_converged(PROGRAM, result)
    kinds = {"profile": draw_profile} if result.is_line else {"maps": draw_maps}
    missing = [name for name in (PROFILE_FIELDS if result.is_line else ["pressure"]) if name not in result.solution]
    if missing:
        print(f"{PROGRAM}: {path}: no {next(iter(kinds))}, {', '.join(missing)} not stored (&output fields)", file=sys.stderr)
        kinds = {}
    if len(result.sweep["mean_pressure"]) > 1:
        kinds["sweep"] = draw_sweep
    kinds["surface"] = draw_surface
    if result.history.size > 1:
        kinds["convergence"] = draw_convergence
    names = []
    for kind, drawing in kinds.items():
        figure = drawing(result)
        style.mark_not_converged(figure, [result])
        names += style.save_figure(figure, figure_command.targets(options, result.stem, kind))
    return names


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.new_parser(PROGRAM, __doc__, EXAMPLE)
    options = parser.parse_args(arguments)
    return max(figure_command.guarded(PROGRAM, draw, Path(name), options) for name in options.results)


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Contact area of rough areas against the load: proportionality and its constant.

Ar/An = kappa pbar/(E* g), g the rms gradient, E* = E'/2. Asperity theory (Bush, Gibson and Thomas, Wear 35, 1975, 87) gives kappa
= sqrt(2 pi) = 2.51 in the limit of light load, Persson's theory sqrt(8/pi) = 1.60. Self-affine surfaces with roll-off, several
seeds, the same surfaces on three grids (Fourier resampling), elastic and with hardnesses. Errors follow from seeds and
resolution. Compared with Greenwood and Williamson's asperities.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import h5py
import numpy as np
from asperities import compare, summits_of, wavenumbers
from study import Case, Claims, Runner, Table, finish, new_parser, save, style

PROGRAM = "area.py"
LENGTH = 1e-3
MODULUS = 200e9
ROLLOFF, SHORT = 8, 64  # waves on the length
HEIGHT = 1e-6
SHARES = (0.002, 0.004, 0.008, 0.016, 0.032, 0.064, 0.128)  # pbar/(E* g)
HARDNESSES = (0.5, 1.0, 2.0)  # over E* g
ASPERITIES, PERSSON = (2 * np.pi) ** 0.5, (8 / np.pi) ** 0.5
# Nothing but the contacts.
BARE = {"accuracy": {"error_bars": False}, "output": {"adequacy": False}}


def surface_of(seed: int, nodes: int) -> Case:
    """A run that makes one surface, on the coarsest grid."""
    return {
        "case": {"problem": "dry_area", "title": f"Rough area, seed {seed}"},
        "bodies": {"reduced_modulus": MODULUS},
        "load": {"mean_pressure": 1e-4 * MODULUS},
        "surface_1": {
            "shape": "synthetic",
            "seed": seed,
            "hurst": 0.8,
            "rms_height": HEIGHT,
            "wavelength_rolloff": LENGTH / ROLLOFF,
            "wavelength_short": LENGTH / SHORT,
        },
        "domain": {"length_x": LENGTH, "length_y": LENGTH, "intervals_x": nodes, "intervals_y": nodes},
        "solver": {"tolerance": 1e-2},
    } | BARE


def case_of(surface: str, slope: float, nodes: int, hardness: float | None = None) -> Case:
    """A surface that is there, with its rms gradient, on `nodes` x `nodes`, under all loads."""
    unit = MODULUS / 2 * slope
    case = {
        "case": {"problem": "dry_area", "title": f"Rough area {surface}, {nodes} x {nodes} nodes"},
        "bodies": {"reduced_modulus": MODULUS},
        "load": {"mean_pressure": [share * unit for share in SHARES]},
        "surface_1": {"shape": "file", "file": f"{surface}.h5", "dataset": "/solution/height_undeformed"},
        "domain": {"length_x": LENGTH, "length_y": LENGTH, "intervals_x": nodes, "intervals_y": nodes},
        "solver": {"tolerance": 1e-6},
    } | BARE
    if hardness:
        case["bodies"]["hardness"] = hardness * unit
    return case


def gradient(z: np.ndarray) -> float:
    """Rms gradient of the band-limited heights."""
    n = z.shape[0]
    power = np.abs(np.fft.rfft2(z)) ** 2
    weight = np.full(n // 2 + 1, 2.0)
    weight[0] = 1.0
    return float(np.sqrt((power * wavenumbers(n, LENGTH) ** 2 * weight).sum()) / n**2)


def read_gradient(_name: str, path: Path) -> float:
    """The rms gradient of a surface."""
    with h5py.File(path) as file:
        return gradient(file["solution/height_undeformed"][()])


def read_case(_name: str, path: Path) -> dict[str, np.ndarray]:
    """The sweep, the load and the area over their units, and the constant with and without the perimeter."""
    with h5py.File(path) as file:
        found = {name: item[()] for name, item in file["sweep"].items()}
        heights = file["solution/height_undeformed"][()]
    slope = gradient(heights)
    load = found["mean_pressure"] / (MODULUS / 2 * slope)
    return found | {
        "share": load,
        "gradient": slope,
        "kappa": found["contact_area_fraction_corrected"] / load,
        "kappa_nodes": found["contact_area_fraction"] / load,
        "summits_all": summits_of(heights, LENGTH),
        "summits_half": summits_of(heights, LENGTH, SHORT / 2),
    }


class Spread:
    """Mean over seeds with its standard error."""

    def __init__(self, values: list[np.ndarray]) -> None:
        """From one array for each seed."""
        self.mean = np.mean(values, axis=0)
        self.deviation = np.std(values, axis=0, ddof=1)
        self.error = self.deviation / len(values) ** 0.5


def draw(curves: dict, hard: dict, grids: list[int], folder: Path) -> None:
    """Area over load, and the constant over the area."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 75, ncols=2)
    finest = curves[grids[-1]]
    axes[0].loglog(finest["share"].mean, 100 * finest["area"].mean, label="elastic", **style.SERIES[0])
    for (hardness, spread), series in zip(hard.items(), style.SERIES[1:], strict=False):
        axes[0].loglog(spread["share"].mean, 100 * spread["area"].mean, label=f"hardness {hardness:g} $E^* g$", **series)
    axes[0].plot(finest["share"].mean, 100 * ASPERITIES * finest["share"].mean, label=r"$\kappa = \sqrt{2\pi}$", **style.REFERENCE)
    axes[0].set(xlabel=r"Mean pressure $\bar p/(E^* g)$ [-]", ylabel="Contact area $A_r/A_n$ [%]")
    for nodes, series in zip(grids, style.SERIES, strict=False):
        found = curves[nodes]
        area = 100 * found["area"].mean
        look = {key: series[key] for key in ("color", "marker")}
        axes[1].semilogx(area, found["kappa"].mean, label=f"{nodes}$^2$ nodes", linestyle=series["linestyle"], **look)
        counted = f"{nodes}$^2$, nodes counted"
        axes[1].semilogx(area, found["kappa_nodes"].mean, linestyle="none", markerfacecolor="none", label=counted, **look)
        if nodes == grids[-1]:
            band = found["kappa"]
            axes[1].fill_between(area, band.mean - band.deviation, band.mean + band.deviation, color="0.85", linewidth=0)
    for value, text in ((ASPERITIES, r"$\sqrt{2\pi}$"), (PERSSON, r"$\sqrt{8/\pi}$")):
        axes[1].axhline(value, **style.REFERENCE)
        axes[1].annotate(text, (1, value), (-3, 2), xycoords=("axes fraction", "data"), textcoords="offset points", ha="right")
    axes[1].set(xlabel="Contact area $A_r/A_n$ [%]", ylabel=r"$\kappa = (A_r/A_n)\,/\,(\bar p/(E^* g))$ [-]")
    for panel in axes:
        panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    save(figure, folder, "area_load")


def study(options: argparse.Namespace) -> None:
    """Runs everything, prints and saves table, statements and figure."""
    runner = Runner(options.output, options.jobs, options.program)
    seeds = range(1, 4 if options.quick else 11)
    grids = [128, 256] if options.quick else [256, 512, 1024]
    surfaces = {f"surface_{seed}": surface_of(seed, grids[0]) for seed in seeds}
    slopes = runner.run(surfaces, read_gradient, frozenset(surfaces))
    cases = {f"{nodes}_{seed}": case_of(f"surface_{seed}", slopes[f"surface_{seed}"], nodes) for nodes in grids for seed in seeds}
    for h in HARDNESSES:
        cases |= {f"h{h:g}_{seed}": case_of(f"surface_{seed}", slopes[f"surface_{seed}"], grids[1], h) for seed in seeds}
    found = runner.run(cases, read_case)

    def gathered(prefix: str) -> dict[str, Spread]:
        rows = [found[f"{prefix}_{seed}"] for seed in seeds]
        names = {"share": "share", "kappa": "kappa", "kappa_nodes": "kappa_nodes", "area": "contact_area_fraction_corrected"}
        return {name: Spread([row[key] for row in rows]) for name, key in names.items()}

    curves = {nodes: gathered(str(nodes)) for nodes in grids}
    hard = {h: gathered(f"h{h:g}") for h in HARDNESSES}
    table = Table(
        load="pbar/(E* g)",
        area="contact area, perimeter corrected",
        kappa="constant",
        seeds="standard error over seeds",
        resolution="change from half the nodes",
        nodes_counted="constant from nodes counted",
        slope="d ln Ar/d ln p from the load before",
    )
    fine, coarse = curves[grids[-1]], curves[grids[-2]]
    local = np.diff(np.log(fine["area"].mean)) / np.diff(np.log(fine["share"].mean))
    change = np.abs(fine["kappa"].mean - coarse["kappa"].mean)
    for i in range(len(SHARES)):
        table.add(
            load=float(fine["share"].mean[i]),
            area=float(fine["area"].mean[i]),
            kappa=float(fine["kappa"].mean[i]),
            seeds=float(fine["kappa"].error[i]),
            resolution=float(change[i]),
            nodes_counted=float(fine["kappa_nodes"].mean[i]),
            slope=float(local[i - 1]) if i else None,
        )
    table.write(options.output / "area", f"Contact area against load, {len(seeds)} seeds, {grids[-1]} x {grids[-1]} nodes")
    table.show(
        f"Elastic, {len(seeds)} seeds, {grids[-1]} x {grids[-1]} nodes",
        **dict.fromkeys(("load", "area"), ".4f"),
        **dict.fromkeys(("kappa", "seeds", "resolution", "nodes_counted", "slope"), ".3f"),
    )
    error = np.hypot(fine["kappa"].error, change)
    claims = Claims()
    light = int(np.argmin(np.abs(fine["area"].mean - 0.01)))
    value = fine["kappa"].mean[light]
    claims.check(
        "at light load kappa is near sqrt(2 pi)",
        bool(abs(value / ASPERITIES - 1) < 0.15),
        f"{value:.2f} +- {error[light]:.2f} at {100 * fine['area'].mean[light]:.1f} % of contact, "
        f"{100 * (value / ASPERITIES - 1):+.0f} % from 2.51, {100 * (value / PERSSON - 1):+.0f} % from 1.60",
    )
    inside = fine["area"].mean < 0.1
    claims.check(
        "below 10 % of contact the area is proportional to the load",
        bool(np.ptp(fine["kappa"].mean[inside]) / value < 0.1),
        f"kappa falls from {fine['kappa'].mean[inside][0]:.2f} to {fine['kappa'].mean[inside][-1]:.2f}; "
        f"the area grows as the load to the power {local[: inside.sum() - 1].min():.3f} to {local[: inside.sum() - 1].max():.3f}",
    )
    middle = curves[grids[1]]
    for h in HARDNESSES:
        area, load = hard[h]["area"].mean, hard[h]["share"].mean
        claims.check(
            f"hardness {h:g} E* g: the area is not below load over hardness, nor below the elastic one",
            bool((area >= load / h).all() and (area >= middle["area"].mean).all()),
            f"area over load over hardness {(area * h / load)[0]:.2f} to {(area * h / load)[-1]:.2f}; over the elastic area "
            f"{(area / middle['area'].mean)[0]:.2f} to {(area / middle['area'].mean)[-1]:.2f}",
        )
    compare([found[f"{grids[-1]}_{seed}"] for seed in seeds], MODULUS / 2, claims, options.output)
    claims.show()
    claims.table.write(options.output / "statements", "Rough areas: statements")
    draw(curves, hard, grids, options.output)
    print(runner.effort)


if __name__ == "__main__":
    finish(new_parser(PROGRAM, __doc__, "results/area"), study)

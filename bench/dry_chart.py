#!/usr/bin/env python3
"""Charts error against processor time for dry contacts, a profile and an area, by method and resolution, in results/chart/.

The error is that of the mean separation against a much finer grid of the same surface (Fourier resampling); every solution has a
violation of the contact conditions of at most 1e-6. Time is that of the solution, without reading and writing; thin bars reach
from the fastest to the slowest run. Open marks did not converge within 3000 iterations. --peers PYTHON also solves the area by
other programs (bench/dry.py), each with the loosest of a ladder of tolerances that reaches 1e-6.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

import dry
import numpy as np
from bench_program import ROOT, new_parser, output_folder, run_program, save
from family_dry import PROBLEMS, height_file, heights, sizes
from matplotlib.ticker import LogLocator, NullFormatter
from namelists import Groups, namelist
from stability_dry import METHODS, Outcome, run

import figure_style as style  # isort: skip

LABELS = {"conjugate_gradient": "conjugate gradient", "steepest_descent": "steepest descent (thesis)"}
# A mark is the fastest of so many runs.
RUNS = 5
# Of the rough area: length [m], mean pressure and E' [Pa]; nodes of its first grid.
LENGTH, PRESSURE, MODULUS, FIRST = 1e-3, 300e6, 200e9, 64
NODES = {
    **{("profile", METHODS[0]): (256, 512, 1024, 2048, 4096, 8192, 16384), ("profile", METHODS[1]): (256, 512, 1024, 2048)},
    **{("area", METHODS[0]): (64, 128, 256, 512, 1024), ("area", METHODS[1]): (64, 128, 256)},
}
FINEST = {"profile": 65536, "area": 2048}


@dataclass
class Point:
    """One method on one grid: processor seconds of the fastest and the slowest run, error of the mean separation."""

    kind: str
    method: str
    nodes: int
    iterations: int | str
    pairs: int | str
    seconds: float
    slowest: float
    kkt: float
    converged: bool
    error: float


def profile_case() -> Groups:
    """Reference profile C, harmonics 1 to 64, elastic at a mean pressure of 1 GPa."""
    file = str(ROOT / "input" / "profiles_ABCD.csv")
    return {
        "case": {"problem": "dry_line"},
        "bodies": {"youngs_modulus_1": 210e9, "poisson_ratio_1": 0.3},
        "load": {"mean_pressure": 1e9},
        "surface_1": {"shape": "file", "file": file, "positions": "x_m", "dataset": "zC_m", "harmonics": 64},
    }


def area_case(surface: dict) -> Groups:
    """A rough area, elastic, about 10 % in contact."""
    bodies, load = {"reduced_modulus": MODULUS}, {"mean_pressure": PRESSURE}
    return {"case": {"problem": PROBLEMS[1]}, "bodies": bodies, "load": load, "surface_1": surface}


def area_heights() -> np.ndarray:
    """The rough area on its first grid: waves from an eighth to a twenty-fourth of the length."""
    waves = {"wavelength_rolloff": 1.25e-4, "wavelength_short": 1e-3 / 24}
    surface = {"shape": "synthetic", "seed": 1, "rms_height": 1e-6} | waves
    text = namelist(area_case(surface) | {"domain": sizes(2, FIRST, LENGTH)})
    return run_program(text, lambda file: file["solution/height_undeformed"][()])[2]


def measure(folder: Path, quick: bool, peers: str | None) -> list[Point]:
    """Every run."""
    z = area_heights()
    path = folder / "area.h5"
    path.write_bytes(height_file(z, [LENGTH / FIRST] * 2))
    grids = {key: nodes[:2] for key, nodes in NODES.items()} if quick else NODES
    area = area_case({"shape": "file", "file": str(path.resolve()), "dataset": "z"})

    def solve(kind: str, method: str, nodes: int, tolerance: float) -> list[Outcome]:
        case, domain = (profile_case(), {"intervals": nodes}) if kind == "profile" else (area, sizes(2, nodes, LENGTH))
        case = case | {"domain": domain, "solver": {"method": method, "tolerance": tolerance, "max_cycles": 3000}}
        found = [run(case) for _ in range(RUNS)]
        if None in found:
            sys.exit(f"dry_chart.py: {kind}, {nodes} nodes: refused")
        return sorted(found, key=lambda outcome: outcome["seconds"])

    finest = {"profile": 4096, "area": 256} if quick else FINEST
    best = {kind: solve(kind, METHODS[0], nodes, 1e-8)[0]["separation"] for kind, nodes in finest.items()}
    points = []
    for (kind, method), nodes in ((key, nodes) for key, every in grids.items() for nodes in every):
        found = solve(kind, method, nodes, 1e-6)
        first = found[0]
        times, error = (first["seconds"], found[-1]["seconds"]), abs(first["separation"] / best[kind] - 1)
        points.append(Point(kind, method, nodes, first["cycles"], first["pairs"], *times, first["kkt"], first.converged, error))
    for peer in dry.PEERS if peers else ():
        points += measure_peer(peer, peers, z, grids["area", METHODS[0]], best["area"])
    return points


def measure_peer(peer: str, python: str, z: np.ndarray, sizes: tuple[int, ...], best: float) -> list[Point]:
    """The area by another program, resampled as ours does it; a grid on which it fails is left out."""
    points = []
    for nodes in sizes:
        fine = heights(np.fft.fft2(z) / z.size, nodes) / LENGTH
        runs = dry.peer_runs(peer, python, dry.Contact(fine, PRESSURE / (0.5 * MODULUS)))
        runs = sorted((run for run in runs if run.error <= 2 * dry.WANTED), key=lambda run: run.seconds)
        if runs:
            error = abs(runs[0].separation * LENGTH / best - 1)
            points.append(Point("area", peer, nodes, "", "", runs[0].seconds, runs[-1].seconds, runs[0].error, True, error))
        else:
            print(f"{peer}, {nodes}: not solved to {dry.WANTED:g}")
    return points


def draw(points: list[Point], folder: Path) -> None:
    """Two panels; each curve is a method, each mark a number of nodes."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 80, ncols=2)
    methods = list(dict.fromkeys(point.method for point in points))
    for panel, kind in zip(axes, ("profile", "area"), strict=True):
        for method, series in zip(methods, style.SERIES, strict=False):
            mine = [point for point in points if (point.kind, point.method) == (kind, method)]
            times, errors = [p.seconds for p in mine], [p.error for p in mine]
            panel.loglog(times, errors, label=LABELS.get(method, method), **series)
            panel.hlines(errors, times, [p.slowest for p in mine], color=series["color"], linewidth=0.6)
            look = {"linestyle": "none", "marker": series["marker"], "color": series["color"], "markerfacecolor": "white"}
            open_marks = [p for p in mine if not p.converged]
            panel.loglog([p.seconds for p in open_marks], [p.error for p in open_marks], **look)
            for point in (mine[0], mine[-1]) if mine and method in METHODS else ():
                text = str(point.nodes) if kind == "profile" else f"{point.nodes}$^2$"
                at = (point.seconds, point.error)
                panel.annotate(text, at, (0, -8), textcoords="offset points", va="center", ha="center", fontsize=7.5)
        panel.set(xlabel="Processor time [s]", title="profile C" if kind == "profile" else "rough area")
        panel.margins(0.12)
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.xaxis.set_major_locator(LogLocator(numticks=9))
    axes[0].set_ylabel("Error of the mean separation [-]")
    handles, labels = axes[1].get_legend_handles_labels()
    style.legend_below(figure, handles, min(len(labels), 5))
    style.save_figure(figure, [folder / "dry_chart.png", folder / "dry_chart.pdf"])


def main() -> None:
    """Measures, writes dry_chart.csv and draws."""
    parser = new_parser(__doc__, "two sizes each", "results/chart")
    parser.add_argument("--peers", metavar="PYTHON", help="python of an environment with other programs")
    options = parser.parse_args()
    folder = output_folder(options)
    points = measure(folder, options.quick, options.peers)
    save(folder / "dry_chart.csv", points)
    print(f"{'':8}{'method':20}{'nodes':>7}{'iterations':>12}{'pairs':>7}{'CPU s':>9}{'slowest':>9}{'error':>10}")
    for p in points:
        numbers = f"{p.nodes:7}{p.iterations!s:>12}{p.pairs!s:>7}{p.seconds:9.3f}{p.slowest:9.3f}{p.error:10.1e}"
        print(f"{p.kind:8}{p.method:20}{numbers}{'' if p.converged else '  not converged'}")
    draw(points, folder)


if __name__ == "__main__":
    main()

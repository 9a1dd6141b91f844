#!/usr/bin/env python3
"""Charts error against processor time for dry contacts, a profile and an area, by method and resolution, in results/chart/.

The error is that of the mean separation against a much finer grid of the same surface (Fourier resampling); every solution has a
violation of the contact conditions of at most 1e-6. Time is that of the solution, without reading and writing; thin bars reach
from the fastest to the slowest run. Open marks did not converge within 3000 iterations. --peers PYTHON also solves the area by
other programs (bench/dry.py), each with the loosest of a ladder of tolerances that reaches 1e-6.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path

import dry
import numpy as np
import pandas as pd
from bench_program import ROOT, Answer, new_parser, run_program, save, solve
from chart import draw_curve
from family_dry import PROBLEMS, height_file, heights, sizes
from matplotlib.ticker import LogLocator, NullFormatter
from namelists import BARE, Groups, namelist
from stability_cells import DRY_METHODS

import figure_style as style  # isort: skip

LABELS = {"conjugate_gradient": "conjugate gradient", "steepest_descent": "steepest descent (thesis)"}
# A mark is the fastest of so many runs.
RUNS = 5
# Of the rough area: length [m], mean pressure and E' [Pa]; nodes of its first grid.
LENGTH, PRESSURE, MODULUS, FIRST = 1e-3, 300e6, 200e9, 64
NODES = {
    **{("profile", DRY_METHODS[0]): (256, 512, 1024, 2048, 4096, 8192, 16384), ("profile", DRY_METHODS[1]): (256, 512, 1024, 2048)},
    **{("area", DRY_METHODS[0]): (64, 128, 256, 512, 1024), ("area", DRY_METHODS[1]): (64, 128, 256)},
}
FINEST = {"profile": 65536, "area": 2048}


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
    return run_program(text, lambda file: file["solution/height_undeformed"][()]).found


def points(folder: Path, quick: bool, peers: str | None) -> Iterator[dict[str, object]]:
    """Of each method on each grid: processor seconds of the fastest and the slowest run, error of the mean separation."""
    z = area_heights()
    path = folder / "area.h5"
    path.write_bytes(height_file(z, [LENGTH / FIRST] * 2))
    grids = {key: nodes[:2] for key, nodes in NODES.items()} if quick else NODES
    area = area_case({"shape": "file", "file": str(path.resolve()), "dataset": "z"})

    def solved(kind: str, method: str, nodes: int, tolerance: float) -> list[Answer]:
        case, domain = (profile_case(), {"intervals": nodes}) if kind == "profile" else (area, sizes(2, nodes, LENGTH))
        case = case | BARE | {"domain": domain, "solver": {"method": method, "tolerance": tolerance, "max_cycles": 3000}}
        return sorted((solve(namelist(case)) for _ in range(RUNS)), key=lambda answer: answer["cpu_seconds"])

    finest = {"profile": 4096, "area": 256} if quick else FINEST
    best = {kind: solved(kind, DRY_METHODS[0], nodes, 1e-8)[0]["mean_separation"] for kind, nodes in finest.items()}
    for (kind, method), nodes in ((key, nodes) for key, every in grids.items() for nodes in every):
        first, *_, last = solved(kind, method, nodes, 1e-6)
        head = {"kind": kind, "method": method, "nodes": nodes, "iterations": first["cycles"], "pairs": first["fft_pairs"]}
        times = {"seconds": first["cpu_seconds"], "slowest": last["cpu_seconds"], "kkt": first["kkt"]}
        yield head | times | {"converged": first.converged, "error": abs(first["mean_separation"] / best[kind] - 1)}
    # the area by other programs, resampled as ours does it; a grid on which one fails is left out
    for peer, nodes in itertools.product(dry.PEERS if peers else (), grids["area", DRY_METHODS[0]]):
        fine = heights(np.fft.fft2(z) / z.size, nodes) / LENGTH
        runs = dry.peer_runs(peer, peers, dry.Contact(fine, PRESSURE / (0.5 * MODULUS)))
        runs = sorted((run for run in runs if run.error <= 2 * dry.WANTED), key=lambda run: run.seconds)
        if runs:
            head = {"kind": "area", "method": peer, "nodes": nodes, "kkt": runs[0].error, "converged": True}
            times = {"seconds": runs[0].seconds, "slowest": runs[-1].seconds}
            yield head | times | {"error": abs(runs[0].separation * LENGTH / best["area"] - 1)}


def draw(found: pd.DataFrame, folder: Path) -> None:
    """Two panels; each curve is a method, each mark a number of nodes."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 80, ncols=2)
    looks = dict(zip(dict.fromkeys(found["method"]), style.SERIES, strict=False))
    for panel, (kind, title) in zip(axes, {"profile": "profile C", "area": "rough area"}.items(), strict=True):
        for method, own in found[found["kind"] == kind].groupby("method", sort=False):
            draw_curve(panel, own, ["seconds", "slowest"], LABELS.get(method, method), looks[method])
            marks = own[~own["converged"]]
            panel.loglog(marks["seconds"], marks["error"], **looks[method] | {"linestyle": "none", "markerfacecolor": "white"})
            for nodes, *at in own.iloc[[0, -1]][["nodes", "seconds", "error"]].values if method in DRY_METHODS else ():
                text = f"{nodes:.0f}" if kind == "profile" else f"{nodes:.0f}$^2$"
                panel.annotate(text, at, (0, -8), textcoords="offset points", va="center", ha="center", fontsize=7.5)
        panel.set(xlabel="Processor time [s]", title=title)
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
    found = pd.DataFrame(points(options.output, options.quick, options.peers))
    save(options.output / "dry_chart.csv", found)
    print(found.to_string(index=False))
    draw(found, options.output)


if __name__ == "__main__":
    main()

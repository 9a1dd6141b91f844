#!/usr/bin/env python3
"""Error against processor time for dry contacts: methods by resolution, a profile and an area, in results/chart/.

The error is that of the mean separation against a much finer grid, of the same surface (Fourier resampling); every solution is
taken to a violation of the contact conditions of 1e-6. Time is that of the solution, without reading and writing; thin bars reach
from the fastest to the slowest of the runs. An open mark: not converged within 3000 iterations. With --peers PYTHON the area is
solved by other programs too, each with the loosest of a ladder of tolerances that makes its violation 1e-6; they live in an
environment of their own: python3 -m venv DIR && DIR/bin/pip install tamaas ContactMechanics aspher.
"""

from __future__ import annotations

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path

import dry
from dry_runs import AREA_LENGTH, METHODS, Outcome, area_case, area_heights, make_area, profile_case, run
from figure_style import SERIES, TWO_COLUMNS, legend_below, new_figure, save_figure
from matplotlib.ticker import LogLocator, NullFormatter

LABELS = {"conjugate_gradient": "conjugate gradient", "steepest_descent": "steepest descent (thesis)"}

# A mark is the fastest of so many runs.
RUNS = 5


@dataclass
class Point:
    """One method on one grid: processor seconds of the fastest and the slowest run, error of the mean separation."""

    kind: str
    method: str
    nodes: int
    seconds: float
    slowest: float
    error: float
    kkt: float
    converged: bool
    iterations: int | str = ""
    pairs: int | str = ""


def measure(folder: Path, quick: bool, peers: str | None) -> list[Point]:
    """Every run."""
    surface = make_area(folder)
    sizes = {
        ("profile", METHODS[0]): (256, 512, 1024, 2048, 4096, 8192, 16384),
        ("profile", METHODS[1]): (256, 512, 1024, 2048),
        ("area", METHODS[0]): (64, 128, 256, 512, 1024),
        ("area", METHODS[1]): (64, 128, 256),
    }
    finest = {"profile": 65536, "area": 2048}
    if quick:
        sizes = {key: nodes[:2] for key, nodes in sizes.items()}
        finest = {"profile": 4096, "area": 256}

    def solve(kind: str, method: str, nodes: int, tolerance: float) -> list[Outcome]:
        case = profile_case(method, nodes, tolerance) if kind == "profile" else area_case(surface, method, nodes, tolerance)
        found = [run(case, folder, "chart") for _ in range(RUNS)]
        if None in found:
            raise SystemExit(f"dry_chart.py: {kind}, {nodes} nodes: refused")
        return sorted(found, key=lambda outcome: outcome.seconds)

    best = {kind: solve(kind, METHODS[0], nodes, 1e-8)[0].separation for kind, nodes in finest.items()}
    points = []
    for (kind, method), every in sizes.items():
        for nodes in every:
            found = solve(kind, method, nodes, 1e-6)
            first = found[0]
            times = (first.seconds, found[-1].seconds, abs(first.separation / best[kind] - 1))
            points.append(Point(kind, method, nodes, *times, first.kkt, first.converged, first.iterations, first.pairs))
    for peer in dry.PEERS if peers else ():
        points += measure_peer(peer, peers, surface, sizes["area", METHODS[0]], best["area"])
    return points


def measure_peer(peer: str, python: str, surface: Path, sizes: tuple[int, ...], best: float) -> list[Point]:
    """The area by another program; a grid on which it fails is left out."""
    points = []
    for nodes in sizes:
        heights, load = area_heights(surface, nodes)
        runs = [run for run in dry.peer_runs(peer, python, dry.Contact(heights, load)) if run.error <= 2 * dry.WANTED]
        if not runs:
            print(f"{peer}, {nodes}: not solved to {dry.WANTED:g}")
            continue
        runs.sort(key=lambda run: run.seconds)
        error = abs(runs[0].separation * AREA_LENGTH / best - 1)
        points.append(Point("area", peer, nodes, runs[0].seconds, runs[-1].seconds, error, runs[0].error, converged=True))
    return points


def draw(points: list[Point], folder: Path) -> None:
    """Two panels; each curve is a method, each mark a number of nodes."""
    figure, axes = new_figure(TWO_COLUMNS, 80, ncols=2)
    methods = list(dict.fromkeys(point.method for point in points))
    for panel, kind in zip(axes, ("profile", "area"), strict=True):
        for method, series in zip(methods, SERIES, strict=False):
            mine = [point for point in points if (point.kind, point.method) == (kind, method)]
            if not mine:
                continue
            times, errors = [p.seconds for p in mine], [p.error for p in mine]
            panel.loglog(times, errors, label=LABELS.get(method, method), **series)
            panel.hlines(errors, times, [p.slowest for p in mine], color=series["color"], linewidth=0.6)
            open_marks = [p for p in mine if not p.converged]
            look = {"linestyle": "none", "marker": series["marker"], "color": series["color"], "markerfacecolor": "white"}
            panel.loglog([p.seconds for p in open_marks], [p.error for p in open_marks], **look)
            if method not in METHODS:
                continue
            # Both curves begin at the same error; of profiles they run on along each other, of areas down.
            side = -1 if method == METHODS[0] else 1
            first = (4 * side, -8 if kind == "profile" and side > 0 else 8)
            for point, place in ((mine[0], first), (mine[-1], (0, -8))):
                text = str(point.nodes) if kind == "profile" else f"{point.nodes}$^2$"
                at = (point.seconds, point.error)
                panel.annotate(text, at, place, textcoords="offset points", va="center", ha="center", fontsize=7.5)
        panel.set(xlabel="Processor time [s]", title="profile C" if kind == "profile" else "rough area")
        panel.margins(0.12)
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.xaxis.set_major_locator(LogLocator(numticks=9))
    axes[0].set_ylabel("Error of the mean separation [-]")
    handles, labels = axes[1].get_legend_handles_labels()
    legend_below(figure, handles, min(len(labels), 5))
    for target in save_figure(figure, [folder / "dry_chart.png", folder / "dry_chart.pdf"]):
        print(target)


def main() -> None:
    """Measures, writes dry_chart.csv and draws."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("results/chart"), metavar="DIR")
    parser.add_argument("--quick", action="store_true", help="two sizes each")
    parser.add_argument("--peers", metavar="PYTHON", help="python of an environment with other programs")
    options = parser.parse_args()
    points = measure(options.output, options.quick, options.peers)
    columns = ("kind", "method", "nodes", "iterations", "pairs", "seconds", "slowest", "kkt", "converged", "error")
    with (options.output / "dry_chart.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([getattr(point, column) for column in columns] for point in points)
    print(f"{'':8}{'method':20}{'nodes':>7}{'iterations':>12}{'pairs':>7}{'CPU s':>9}{'slowest':>9}{'error':>10}")
    for p in points:
        mark = "" if p.converged else "  not converged"
        numbers = f"{p.nodes:7}{p.iterations!s:>12}{p.pairs!s:>7}{p.seconds:9.3f}{p.slowest:9.3f}{p.error:10.1e}"
        print(f"{p.kind:8}{p.method:20}{numbers}{mark}")
    draw(points, options.output)


if __name__ == "__main__":
    main()

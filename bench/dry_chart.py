#!/usr/bin/env python3
"""Error against processor time for dry contacts: methods by resolution, a profile and an area, in results/chart/.

The error is that of the mean separation against a much finer grid, of the same surface (Fourier resampling); every solution is
taken to a violation of the contact conditions of 1e-6. Time is that of the solution, without reading and writing. An open mark:
not converged within 3000 iterations.
"""

from __future__ import annotations

import argparse
import csv
from pathlib import Path

from dry_cases import METHODS, Outcome, area_case, make_area, profile_case, run
from figure_style import SERIES, TWO_COLUMNS, new_figure, save_figure
from matplotlib.ticker import LogLocator, NullFormatter

LABELS = {"conjugate_gradient": "conjugate gradient", "steepest_descent": "steepest descent (thesis)"}

# A mark is the fastest of so many runs.
RUNS = 5


def measure(folder: Path, quick: bool) -> list[tuple[str, str, int, Outcome, float]]:
    """Surface, method, nodes, outcome and error of every run."""
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

    def solve(kind: str, method: str, nodes: int, tolerance: float) -> Outcome:
        case = profile_case(method, nodes, tolerance) if kind == "profile" else area_case(surface, method, nodes, tolerance)
        found = [run(case, folder, "chart") for _ in range(RUNS)]
        if None in found:
            raise SystemExit(f"dry_chart.py: {kind}, {nodes} nodes: refused")
        return min(found, key=lambda outcome: outcome.seconds)

    best = {kind: solve(kind, METHODS[0], nodes, 1e-8).separation for kind, nodes in finest.items()}
    points = []
    for (kind, method), every in sizes.items():
        for nodes in every:
            found = solve(kind, method, nodes, 1e-6)
            points.append((kind, method, nodes, found, abs(found.separation / best[kind] - 1)))
    return points


def draw(points: list[tuple[str, str, int, Outcome, float]], folder: Path) -> None:
    """Two panels; each curve is a method, each mark a number of nodes."""
    figure, axes = new_figure(TWO_COLUMNS, 75, ncols=2)
    for panel, kind in zip(axes, ("profile", "area"), strict=True):
        for method, series in zip(METHODS, SERIES, strict=False):
            mine = [
                (found.seconds, error, nodes, found.converged) for k, m, nodes, found, error in points if (k, m) == (kind, method)
            ]
            panel.loglog([p[0] for p in mine], [p[1] for p in mine], label=LABELS[method], **series)
            open_marks = [p for p in mine if not p[3]]
            look = {"linestyle": "none", "marker": series["marker"], "color": series["color"], "markerfacecolor": "white"}
            panel.loglog([p[0] for p in open_marks], [p[1] for p in open_marks], **look)
            # Both curves begin at the same error: one label above it, one below.
            above = 8 if method == METHODS[0] else -8
            for (seconds, error, nodes, _), place in ((mine[0], {"xytext": (0, above)}), (mine[-1], {"xytext": (0, -8)})):
                text = str(nodes) if kind == "profile" else f"{nodes}$^2$"
                panel.annotate(text, (seconds, error), textcoords="offset points", va="center", ha="center", fontsize=7.5, **place)
        panel.set(xlabel="Processor time [s]", title="profile C" if kind == "profile" else "rough area")
        panel.margins(0.12)
        panel.xaxis.set_minor_formatter(NullFormatter())
        panel.xaxis.set_major_locator(LogLocator(numticks=9))
    axes[0].set_ylabel("Error of the mean separation [-]")
    axes[0].legend()
    for target in save_figure(figure, [folder / "dry_chart.png", folder / "dry_chart.pdf"]):
        print(target)


def main() -> None:
    """Measures, writes dry_chart.csv and draws."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", type=Path, default=Path("results/chart"), metavar="DIR")
    parser.add_argument("--quick", action="store_true", help="two sizes each")
    options = parser.parse_args()
    points = measure(options.output, options.quick)
    with (options.output / "dry_chart.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(("surface", "method", "nodes", "iterations", "fft_pairs", "cpu_seconds", "kkt", "converged", "error"))
        for kind, method, nodes, found, error in points:
            writer.writerow(
                (kind, method, nodes, found.iterations, found.pairs, found.seconds, found.kkt, int(found.converged), f"{error:.3e}")
            )
    print(f"{'':8}{'method':20}{'nodes':>7}{'iterations':>12}{'pairs':>7}{'CPU s':>9}{'error':>10}")
    for kind, method, nodes, found, error in points:
        mark = "" if found.converged else "  not converged"
        print(f"{kind:8}{method:20}{nodes:7}{found.iterations:12}{found.pairs:7}{found.seconds:9.3f}{error:10.1e}{mark}")
    draw(points, options.output)


if __name__ == "__main__":
    main()

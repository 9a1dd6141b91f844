#!/usr/bin/env python3
"""Draws a gathered table as curves, families of curves or maps, with error bars; failed cases are marked."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from case_folder import new_parser, status_of
from gathered import Gathered, read_gathered
from plot_curves import Wish, draw_curves, style
from plot_map import draw_map
from plot_stribeck import draw_stribeck
from sweep_file import SweepError

PROGRAM = "plot.py"
EPILOG = """examples:
  plot.py film_over_speed                                             as the table [plot] of the sweep says
  plot.py film_over_speed --x bodies.speed_1 --y h_min h_central --log x y
  plot.py study --x bodies.speed_1 --y h_min --colour load.hertz_pressure --facet lubricant.viscosity
  plot.py study --kind map --x bodies.speed_1 --y h_min --colour load.hertz_pressure
  plot.py stribeck --kind stribeck --x entrainment_speed              friction, load of the asperities and film of mixed contacts

A map has --x and --colour as axes and the first --y as colour. Circles: not converged or outside the model. Crosses: no result.

status: 0 drawn; 1 wrong file or usage; 3 cannot write"""
FORMATS = ("png", "pdf", "svg")
DRAW = {"curves": draw_curves, "map": draw_map, "stribeck": draw_stribeck}
ENTRIES = {"x": str, "y": list, "colour": str, "facet": str, "log": list, "points": bool, "kind": str, "regimes": bool}


def wish_of(table: Gathered, options: argparse.Namespace) -> Wish:
    """What to draw: the command line over the table [plot] of the sweep; raises SweepError."""
    plot = dict(table.sweep.get("plot", {}))
    if isinstance(plot.get("y"), str):
        plot["y"] = [plot["y"]]
    for name, value in plot.items():
        is_right = name in ENTRIES and isinstance(value, ENTRIES[name])
        if not is_right or (isinstance(value, list) and not all(isinstance(word, str) for word in value)):
            raise SweepError(f"{table.path}: found {name} = {value!r} in [plot], expected {', '.join(ENTRIES)}")
    plot |= {name: value for name in ENTRIES if (value := getattr(options, name)) not in (None, False)}
    if plot.get("kind") == "stribeck":
        plot["y"] = ["friction_coefficient"]
    if "x" not in plot or not plot.get("y"):
        raise SweepError(f"{table.path}: found nothing to draw, expected --x and --y, or [plot] with x and y in the sweep")
    if plot.get("kind", "curves") not in DRAW or not set(plot.get("log", [])) <= {"x", "y", "z"}:
        raise SweepError(f"{table.path}: expected kind {', '.join(map(repr, DRAW))}, and log of 'x', 'y', 'z'")
    if plot.get("kind") == "stribeck" and {"colour", "facet"} & plot.keys():
        raise SweepError(f"{table.path}: a Stribeck curve has --x alone; curves of the friction_coefficient may have --colour")
    if plot.get("kind") == "map" and "colour" not in plot:
        raise SweepError(f"{table.path}: a map needs --colour, its second axis")
    if "sample" in table.sweep:
        plot.setdefault("points", True)
    plot |= {"x": table.compute(plot["x"]), "y": [table.compute(name) for name in plot["y"]]}
    axes = {"x": plot["x"], "y": plot["colour"] if plot.get("kind") == "map" else ""}
    plot.setdefault("log", [axis for axis, name in axes.items() if is_logarithmic(table.sweep, name)])
    return Wish(**{name: tuple(value) if isinstance(value, list) else value for name, value in plot.items()})


def is_logarithmic(sweep: dict[str, object], name: str) -> bool:
    """Whether a sweep varies a parameter, as `group.key` or `"name"`, in equal ratios."""
    vary = sweep.get("vary", {})
    steps = vary.get(name)
    for word in name.split(".") if steps is None else ():
        vary = vary.get(word) if isinstance(vary, dict) else None
        steps = vary
    return isinstance(steps, dict) and steps.get("spacing") == "log"


def draw(path: Path, options: argparse.Namespace) -> int:
    """Draws one table and prints the names of the files; returns the exit status. Raises SweepError, OSError."""
    table = read_gathered(path)
    wish = wish_of(table, options)
    figure = DRAW[wish.kind](table, wish)
    folder = options.output or table.path.parent
    folder.mkdir(parents=True, exist_ok=True)
    for target in style.save_figure(figure, [folder / f"{options.name}.{ending}" for ending in options.format]):
        print(target)
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = new_parser(PROGRAM, __doc__, EPILOG)
    parser.add_argument("table", type=Path, metavar="FOLDER", help="folder of a sweep, or its gathered.h5")
    parser.add_argument("--x", metavar="NAME", help="column along the horizontal axis")
    parser.add_argument("--y", nargs="+", metavar="NAME", help="quantities to draw")
    parser.add_argument("--colour", metavar="NAME", help="a curve for each value of this column")
    parser.add_argument("--facet", metavar="NAME", help="a panel for each value of this column")
    parser.add_argument("--kind", choices=DRAW, help="curves (default), map or stribeck")
    parser.add_argument("--log", nargs="+", choices=("x", "y", "z"), help="logarithmic axes; z: the colours of a map")
    parser.add_argument("--points", action="store_true", help="marks without lines (default for samples)")
    parser.add_argument("--regimes", action="store_true", help="draw the regimes of lubrication into a map (Moes)")
    parser.add_argument("--output", type=Path, metavar="DIR", help="folder of the figures (default: that of the table)")
    parser.add_argument("--name", default="plot", help="name of the figures (default: plot)")
    parser.add_argument("--format", nargs="+", choices=FORMATS, default=["png", "pdf"], help="one or more of png, pdf, svg")
    options = parser.parse_args(arguments)
    return status_of(PROGRAM, lambda: draw(options.table, options))


if __name__ == "__main__":
    sys.exit(main())

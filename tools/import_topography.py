#!/usr/bin/env python3
"""Imports a measured topography, in any format that SurfaceTopography reads, to an HDF5 file for shape = 'file'.

    import_topography.py MEASUREMENT --output heights.h5 [--channel N] [--detrend tilt|curvature] [--fill]
    import_topography.py MEASUREMENT --list
    import_topography.py TABLE --unit mm,um [--column N] [--spacing S]

With --unit the file is a table of plain columns: positions and heights in these units, or with --spacing (in the first unit)
rows of heights, one column a profile, more an area; separated by commas, semicolons, tabs or blanks, with decimal points or
commas. Lines above the numbers are left out; positions may rise or fall. This needs no library.

SurfaceTopography (https://pypi.org/project/SurfaceTopography) reads the formats of the instruments; it is not needed for anything
else: `.venv/bin/pip install SurfaceTopography`. The heights are written in m as /z (ny, nx) or (nx) with the spacing of the nodes;
points that were not measured are an error unless --fill interpolates them.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import h5py
import numpy as np

PROGRAM = "import_topography.py"


class ImportFailure(Exception):
    """Why nothing was imported; one line."""


def open_measurement(path: Path) -> object:
    """The reader of a file."""
    try:
        from SurfaceTopography import open_topography  # noqa: PLC0415 - optional, and slow to load
    except ImportError as error:
        raise ImportFailure(
            f"needs the library SurfaceTopography ({error}): install it with .venv/bin/pip install SurfaceTopography"
        ) from error
    if not path.is_file():
        raise ImportFailure(f"{path}: no such file")
    try:
        return open_topography(str(path))
    except Exception as error:  # the readers raise what they like
        raise ImportFailure(f"{path}: no format that SurfaceTopography reads ({type(error).__name__}: {error})") from error


def heights_of(topography: object, path: Path, detrend: str | None, fill: bool) -> tuple[np.ndarray, tuple[float, ...]]:
    """Heights [m], (ny, nx) or (nx), and the spacing in x and y [m]."""
    if topography.unit is None:
        raise ImportFailure(f"{path}: the file states no unit of length")
    topography = topography.to_unit("m")
    if topography.has_undefined_data:
        if not fill:
            missing = int(np.ma.count_masked(topography.heights()))
            raise ImportFailure(f"{path}: {missing} points were not measured, expected all (--fill interpolates them)")
        topography = topography.interpolate_undefined_data()
    if not topography.is_uniform:
        raise ImportFailure(f"{path}: the points are not evenly spaced, expected a uniform grid")
    if detrend:
        topography = topography.detrend({"tilt": "height", "curvature": "curvature"}[detrend])
    heights = np.asarray(topography.heights(), dtype=float)
    spacing = tuple(float(s) / n for s, n in zip(topography.physical_sizes, topography.nb_grid_pts, strict=True))
    if not np.all(np.isfinite(heights)):
        raise ImportFailure(f"{path}: heights that are no numbers")
    return heights.T if heights.ndim == 2 else heights, spacing


UNITS = {"m": 1.0, "cm": 1e2, "mm": 1e3, "um": 1e6, "\u00b5m": 1e6, "\u03bcm": 1e6, "nm": 1e9, "pm": 1e12}


def units_per_metre(text: str) -> list[float]:
    """Units in a metre of positions and heights: `mm,um`, or one for both."""
    names = [name.strip() for name in text.split(",")]
    if len(names) > 2 or any(name not in UNITS for name in names):
        raise ImportFailure(f"--unit: found {text!r}, expected one or two of {', '.join(UNITS)}, as in mm,um")
    return [UNITS[names[0]], UNITS[names[-1]]]


def rows_of(path: Path) -> np.ndarray:
    """The numbers of a table; lines above the first row of numbers are left out."""
    try:
        lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except OSError as error:
        raise ImportFailure(f"{path}: {error.strerror}") from error
    rows: list[list[float]] = []
    whole_between_commas = True
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.lstrip()[0] in "#%":
            continue
        separator = next((mark for mark in (";", "\t") if mark in line), None)
        if separator is None and "," in line and ("." in line or len(line.split()) == 1 or ", " in line):
            separator = ","
        fields = [field.strip() for field in line.strip().rstrip(separator).split(separator)]
        decimal = "." if separator == "," else ","
        try:
            rows.append([float(field.replace(decimal, ".") if "." not in field else field) for field in fields])
        except ValueError as error:
            if rows:
                raise ImportFailure(f"{path}:{number}: {error}") from error
            continue
        whole_between_commas = whole_between_commas and separator == "," and all(field.lstrip("+-").isdigit() for field in fields)
        if len(rows[-1]) != len(rows[0]):
            raise ImportFailure(f"{path}:{number}: found {len(rows[-1])} numbers, expected {len(rows[0])} as in the first row")
    if len(rows) < 2:
        raise ImportFailure(f"{path}: found no rows of numbers")
    if whole_between_commas:
        raise ImportFailure(f"{path}: whole numbers between commas may be numbers with decimal commas: separate them by semicolons")
    table = np.array(rows)
    if not np.all(np.isfinite(table)):
        raise ImportFailure(f"{path}: numbers that are none, expected a height at every point")
    return table


def import_table(options: argparse.Namespace) -> tuple[np.ndarray, tuple[float, ...]]:
    """Heights [m] and spacings [m] of a table of plain columns."""
    per_metre = units_per_metre(options.unit)
    table = rows_of(options.measurement)
    if options.spacing is not None:
        if options.column is not None:
            raise ImportFailure("--column: not with --spacing, where every column is one of heights")
        if not options.spacing > 0:
            raise ImportFailure(f"--spacing: found {options.spacing}, expected a number > 0")
        spacing = options.spacing / per_metre[0]
        heights = table / per_metre[1]
        return (heights[:, 0], (spacing,)) if heights.shape[1] == 1 else (heights, (spacing, spacing))
    column = 2 if options.column is None else options.column
    if not 2 <= column <= table.shape[1]:
        raise ImportFailure(
            f"{options.measurement}: found {table.shape[1]} columns, expected heights in column {column} behind positions"
        )
    x = table[:, 0] / per_metre[0]
    steps = np.diff(x)
    spacing = (x[-1] - x[0]) / (len(x) - 1)
    if not (spacing != 0 and np.all(np.abs(steps - spacing) <= 1e-3 * abs(spacing))):
        raise ImportFailure(f"{options.measurement}: the positions in the first column neither rise nor fall evenly")
    heights = table[:, column - 1] / per_metre[1]
    return (heights if spacing > 0 else heights[::-1]), (abs(spacing),)


def flattened(heights: np.ndarray, word: str | None) -> np.ndarray:
    """Without the plane (tilt) or the paraboloid (curvature) of least squares."""
    if word is None:
        return heights
    grids = np.meshgrid(*(np.linspace(-1, 1, n) for n in heights.shape), indexing="ij")
    powers = [()] + [(i,) for i in range(heights.ndim)]
    if word == "curvature":
        powers += [(i, j) for i in range(heights.ndim) for j in range(i, heights.ndim)]
    terms = np.column_stack(
        [np.prod([grids[i] for i in power], axis=0, initial=1.0).ravel() * np.ones(heights.size) for power in powers]
    )
    return heights - (terms @ np.linalg.lstsq(terms, heights.ravel(), rcond=None)[0]).reshape(heights.shape)


def write_heights(output: Path, heights: np.ndarray, spacing: tuple[float, ...], source: str) -> None:
    """The HDF5 file that shape = 'file' reads."""
    with h5py.File(output, "w") as file:
        dataset = file.create_dataset("z", data=heights)
        for name, value in zip(("spacing_x", "spacing_y"), spacing, strict=False):
            dataset.attrs[name] = value
        dataset.attrs.update({"long_name": "measured height", "si_units": "m", "si_scale": 1.0, "source": source})


def import_file(options: argparse.Namespace) -> str:
    """Lists or imports; returns what to tell."""
    if options.unit:
        heights, spacing = import_table(options)
        heights = flattened(heights, options.detrend)
        write_heights(options.output, heights, spacing, options.measurement.name)
        return told(options, heights, spacing)
    if options.column is not None or options.spacing is not None:
        raise ImportFailure("--column and --spacing are for tables of plain columns, with --unit")
    reader = open_measurement(options.measurement)
    channels = list(reader.channels)
    if options.list:
        return "\n".join(f"{i}  {channel.name}  {channel.nb_grid_pts} nodes" for i, channel in enumerate(channels))
    if not 0 <= options.channel < len(channels):
        raise ImportFailure(f"{options.measurement}: found no channel {options.channel}, expected 0 to {len(channels) - 1}")
    topography = reader.topography(channel_index=options.channel)
    heights, spacing = heights_of(topography, options.measurement, options.detrend, options.fill)
    write_heights(options.output, heights, spacing, f"{options.measurement.name}, channel {channels[options.channel].name}")
    return told(options, heights, spacing)


def told(options: argparse.Namespace, heights: np.ndarray, spacing: tuple[float, ...]) -> str:
    """What was imported, in a line."""
    nodes = " x ".join(str(n) for n in heights.shape[::-1])
    size = " x ".join(f"{n * s:.4g} m" for n, s in zip(heights.shape[::-1], spacing, strict=True))
    return f"{options.output}: {nodes} nodes, {size}, Rq {heights.std():.4g} m; use it with shape = 'file', dataset = 'z'"


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = argparse.ArgumentParser(prog=PROGRAM, description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("measurement", type=Path, help="file of the instrument")
    parser.add_argument("--output", type=Path, default=Path("heights.h5"), help="HDF5 file to write (heights.h5)")
    parser.add_argument("--channel", type=int, default=0, metavar="N", help="channel of the file (0)")
    parser.add_argument("--detrend", choices=("tilt", "curvature"), help="subtract the mean plane, or the mean parabola")
    parser.add_argument("--fill", action="store_true", help="interpolate points that were not measured")
    parser.add_argument("--unit", metavar="X[,Z]", help="a table of plain columns: units of positions and heights, as in mm,um")
    parser.add_argument("--column", type=int, metavar="N", help="of a table: column of the heights (2)")
    parser.add_argument("--spacing", type=float, metavar="S", help="of a table without positions: distance of its points")
    parser.add_argument("--list", action="store_true", help="only list the channels")
    try:
        print(import_file(parser.parse_args(arguments)))
    except ImportFailure as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Imports a measured topography, in any format that SurfaceTopography reads, to an HDF5 file for shape = 'file'.

    import_topography.py MEASUREMENT --output heights.h5 [--channel N] [--detrend tilt|curvature] [--fill]
    import_topography.py MEASUREMENT --list

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


def write_heights(output: Path, heights: np.ndarray, spacing: tuple[float, ...], source: str) -> None:
    """The HDF5 file that shape = 'file' reads."""
    with h5py.File(output, "w") as file:
        dataset = file.create_dataset("z", data=heights)
        for name, value in zip(("spacing_x", "spacing_y"), spacing, strict=False):
            dataset.attrs[name] = value
        dataset.attrs.update({"long_name": "measured height", "si_units": "m", "si_scale": 1.0, "source": source})


def import_file(options: argparse.Namespace) -> str:
    """Lists or imports; returns what to tell."""
    reader = open_measurement(options.measurement)
    channels = list(reader.channels)
    if options.list:
        return "\n".join(f"{i}  {channel.name}  {channel.nb_grid_pts} nodes" for i, channel in enumerate(channels))
    if not 0 <= options.channel < len(channels):
        raise ImportFailure(f"{options.measurement}: found no channel {options.channel}, expected 0 to {len(channels) - 1}")
    topography = reader.topography(channel_index=options.channel)
    heights, spacing = heights_of(topography, options.measurement, options.detrend, options.fill)
    write_heights(options.output, heights, spacing, f"{options.measurement.name}, channel {channels[options.channel].name}")
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
    parser.add_argument("--list", action="store_true", help="only list the channels")
    try:
        print(import_file(parser.parse_args(arguments)))
    except ImportFailure as error:
        print(f"{PROGRAM}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

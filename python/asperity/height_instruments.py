"""Heights in the files of instruments, with the library SurfaceTopography."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from .height_tables import Floats, Heights, Refusal, metres


def read_instrument(path: Path, channel: int | None, unit: str | None) -> Heights:
    """The heights in a file, in channel `channel` of those that hold heights; `unit` where the file says none."""
    try:
        from SurfaceTopography import open_topography  # noqa: PLC0415 - optional, and slow to load
    except ImportError as error:
        raise Refusal(
            f"found no text; the files of instruments need a library: {sys.executable} -m pip install SurfaceTopography"
        ) from error
    try:
        reader = open_topography(str(path))
        # these have no mark by which a file is known, and take nearly any
        channels = [] if reader.format() in ("asc", "xyz", "npz", "nms", "hgt") else list(reader.height_channels)
        if not channels:
            raise ValueError
    except Exception as error:  # the readers raise what they like
        raise Refusal("found no text, and no format that SurfaceTopography reads, expected heights") from error
    names = [f"{i} {known.name}" for i, known in enumerate(channels, 1)]
    number = 1 if channel is None and len(channels) == 1 else channel
    if number is None or not 1 <= number <= len(channels):
        raise Refusal(f"found {len(channels)} channels of heights ({', '.join(names)}), expected --channel N, one of them")
    try:
        topography = channels[number - 1].topography()
        sizes, stated = topography.physical_sizes, topography.unit
        z: Floats = np.ma.filled(np.ma.asarray(topography.heights(), dtype=float), np.nan).T
        count, is_uniform = topography.nb_grid_pts, topography.is_uniform
        scale = topography.to_unit("m").physical_sizes[0] / sizes[0] if stated else 1.0
    except Exception as error:
        raise Refusal(
            f"found a file that SurfaceTopography cannot read ({type(error).__name__}: {error}), expected heights"
        ) from error
    if not is_uniform:
        raise Refusal("found points that are not evenly spaced, expected a uniform grid")
    if stated and unit:
        raise Refusal(f"found the unit {stated} in the file, expected no --unit")
    units = (unit or "").split(",")
    scales = (scale, scale) if stated else (metres("", units[0], "positions"), metres("", units[-1], "heights"))
    return Heights(
        z * scales[1], tuple(float(s) / n * scales[0] for s, n in zip(sizes, count, strict=True)), f"channel {names[number - 1]}"
    )

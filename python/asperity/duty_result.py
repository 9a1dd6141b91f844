"""Where the extremes of a result lie on the teeth or the cam, and what the contact loses."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import h5py
import numpy as np

from .height_tables import Floats, Refusal

if TYPE_CHECKING:
    import xarray as xr

# In the order of the columns of the table.
SERIES = ("load_per_length", "speed_1", "speed_2", "reduced_radius")
QUANTITIES = (
    *("h_min", "h_central", "p_max", "p_central"),
    *("friction_coefficient", "rolling_friction_coefficient", "sliding_power", "rolling_power"),
)
PREFIXES = {-3: "n", -2: "u", -1: "m", 0: "", 1: "k", 2: "M", 3: "G"}
# Mean difference of a series of the result from that of its table, over its largest value, at most.
SAME = 2e-3


class Places(NamedTuple):
    """Where the contact is: two lines above the numbers, and the numbers at a time [s] of the table."""

    heads: tuple[str, str]
    text: Callable[[float], str]


def prefixed(value: float, unit: str) -> str:
    """Four digits with unit and prefix."""
    if unit == "1" or not math.isfinite(value):
        return f"{value:.4g}"
    step = min(max(math.floor(math.log10(abs(value)) / 3), -3), 3) if value else 0
    return f"{value / 1000.0**step:.4g} {PREFIXES[step]}{unit}"


def share(value: float, error: float) -> str:
    """An error bar in percent of the value."""
    return f"{100 * abs(error / value):.2g} %" if value and math.isfinite(error) else "not known"


def folded(time: Floats, span: float) -> Floats:
    """Times within the first cycle; the end of a cycle stays one."""
    return np.asarray(time - span * np.floor(time / span * (1 - 1e-9)))


def compare(path: Path, transient: xr.Dataset, table: Floats) -> None:
    """Raises Refusal unless the result is of this table, and counts all of it or one cycle."""
    if not {*SERIES} <= {*map(str, transient)}:
        raise Refusal(f"{path}: found a result without &history, expected that of the table")
    time, span = np.asarray(transient["time"]), table[-1, 0]
    with h5py.File(path) as file:
        begin = file["summary"].attrs["statistics_from"] * file["scaling"].attrs["time"]
    if not abs(time[-1] - begin - span) < 1e-6 * span:
        raise Refusal(f"{path}: found extremes of {(time[-1] - begin) * 1e3:.4g} ms, expected those of {span * 1e3:.4g} ms")
    for name, column in zip(SERIES, table.T[1:], strict=True):
        difference = np.interp(folded(time, span), table[:, 0], column) - np.asarray(transient[name])
        if not np.abs(difference).mean() < SAME * np.abs(column).max():
            raise Refusal(f"{path}: found another {name} over time, expected that of the table")


def told(path: Path, table: Floats, places: Places, length: float) -> tuple[str, float, float]:
    """A line for each extreme; then the mean power [W] that `length` [m] of the contact turns into heat, and its error.

    Raises OSError, AsperityError, Refusal.
    """
    from .result import read  # noqa: PLC0415 -- who writes a table does not wait for xarray

    result = read(path)
    compare(path, result.transient, table)
    lines = [
        f"{above:>37s}{unit:>8s}{words}" for above, unit, words in zip(("error", ""), ("time", "[ms]"), places.heads, strict=True)
    ]
    for name in QUANTITIES:
        if name in result.summary:
            item, at = result.summary[name], float(result.summary[f"{name}_time"])
            value, time = float(item), float(folded(np.array([at]), table[-1, 0])[0])
            numbers = f"{prefixed(value, item.attrs['units']):>11s}{share(value, item.attrs['error_estimate']):>10s}"
            lines.append(f"{name.replace('_coefficient', ''):16s}{numbers}{round(time * 1e3, 4):8.5g}{places.text(time)}")
    mean = result.summary["mean_power"]
    return "\n".join(lines), float(mean) * length, float(mean.attrs["error_estimate"]) * length

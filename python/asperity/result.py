"""Results: the HDF5 file of a case as xarray in SI units."""

from __future__ import annotations

import contextlib
import copyreg
import math
import os
import tempfile
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Any

import f90nml
import h5py
import numpy as np
import xarray as xr

from .case_file import read_namelist
from .errors import AsperityError
from .seal import DAMAGE, SealError, check_seal

# Dimensions of the arrays of a group, by number of dimensions, where a file has no dimension scales.
_DIMENSIONS: dict[str, dict[int, tuple[str, ...]]] = {
    "solution": {1: ("x",), 2: ("y", "x")},
    "transient": {1: ("time",), 2: ("profile_time", "x")},
    "sweep": {1: ("step",)},
}
_GAP = "gap"
# Quantities that a result shows of itself.
_SHOWN = (
    "h_min",
    "h_central",
    "lambda_ratio",
    "p_max",
    "friction_coefficient",
    "contact_area_fraction",
    "plastic_area_fraction",
    "mean_separation",
)
# A largest pressure with a smaller relative error needs no other beside it.
_WELL_KNOWN = 0.01


class Result:
    """A result file. Groups are read when they are asked for, and stay in memory.

    A file that is another one by then is an AsperityError.
    """

    def __init__(self, path: str | os.PathLike[str], keep: tempfile.TemporaryDirectory[str] | None = None) -> None:
        """The result `path`; `keep`: its folder, removed with the last reference to this object."""
        self.path = Path(path).absolute()
        self._keep = keep
        self._seal: str | None = None
        self._stamp: tuple[int, ...] = ()
        with self._opened() as file:
            attributes = {name: _plain(value) for name, value in file.attrs.items()}
            if str(attributes.get("program")) != "asperity":
                raise AsperityError(f"{self.path}: no result of asperity")
            self.groups = [name for name, item in file.items() if isinstance(item, h5py.Group)]
        self.problem, self.title, self.reason = (str(attributes.get(name, "")) for name in ("problem", "title", "reason"))
        self.converged = str(attributes.get("converged")) == "1"
        default = "converged" if self.converged else "not converged"  # results of earlier versions
        self.outcome = str(attributes.get("outcome", default))
        self.program = f"asperity {attributes.get('version', '')} {attributes.get('git_commit', '')}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies, as one process gives them to another: of a temporary file each has its own."""
        if self._keep is None:
            return copyreg.__newobj__, (type(self),), self.__dict__  # type: ignore[attr-defined]
        with self._opened():
            return _restored, (self.path.name, self.path.read_bytes())

    @contextlib.contextmanager
    def _opened(self) -> Iterator[h5py.File]:
        """The open file, which is that of the first time; whatever is wrong with it is an AsperityError."""
        if self.path.suffix == ".part":
            raise AsperityError(f"{self.path}: an unfinished result, still being written or left by a run that was stopped")
        try:
            stamp = _stamp(self.path)
            if stamp != self._stamp:  # touched, or another file
                seal = check_seal(self.path)
                if self._seal not in (None, seal):
                    raise SealError("has changed since it was read: it is the result of another run now")
                self._seal, self._stamp = seal, stamp
            with h5py.File(self.path, "r") as file:
                if _stamp(self.path) != stamp:
                    raise SealError("has changed while it was read")
                yield file
        except FileNotFoundError:
            raise
        except SealError as error:
            raise AsperityError(f"{self.path}: {error}") from error
        except DAMAGE as error:
            raise AsperityError(f"{self.path}: cannot be read: {error}") from error

    def __repr__(self) -> str:
        """Problem, outcome and quantities of the summary."""
        state = {"converged": "converged", "not converged": f"NOT CONVERGED: {self.reason}"}.get(self.outcome, self.reason)
        numbers = {str(name): item for name, item in self.summary.items() if item.ndim == 0 and item.dtype.kind in "fiu"}
        found = [(name, _shown(item)) for name, item in numbers.items() if _is_shown(name, numbers)]
        width = max((len(name) for name, _ in found), default=0)
        return "\n".join([f"<asperity.Result {self.problem}, {state}>", *(f"  {name:<{width}}  {text}" for name, text in found)])

    @cached_property
    def summary(self) -> xr.Dataset:
        """The quantities of interest, SI; attributes `units`, `long_name` and `error_estimate`."""
        return self.group("summary")

    @cached_property
    def solution(self) -> xr.Dataset:
        """Fields over x (of an area over y and x); of a passage at its last time."""
        return self.group("solution")

    @cached_property
    def transient(self) -> xr.Dataset:
        """Fields over time and x, and quantities over time, of a passage; empty for others."""
        return self.group("transient")

    @cached_property
    def sweep(self) -> xr.Dataset:
        """Quantities over the loads of a dry contact; empty for others."""
        return self.group("sweep")

    @cached_property
    def report(self) -> dict[str, Any]:
        """How it was solved: method, residuals, times, notes."""
        return {str(name): item.values.tolist() if item.ndim == 0 else item.values for name, item in self.group("report").items()}

    @cached_property
    def verdicts(self) -> dict[str, str]:
        """What each ingredient of the model and each numerical choice means for this contact (`/adequacy`)."""
        with self._opened() as file:
            groups = file["adequacy"].items() if "adequacy" in file else ()
            return {name: str(_plain(item.attrs["verdict"])) for name, item in groups if "verdict" in item.attrs}

    @cached_property
    def case(self) -> f90nml.Namelist:
        """The namelist that was computed."""
        with self._opened() as file:
            return read_namelist(_plain(file["input/namelist"][()]))

    @property
    def x(self) -> xr.DataArray:
        """Positions [m]."""
        return self._field("x")

    @property
    def pressure(self) -> xr.DataArray:
        """Pressure [Pa]."""
        return self._field("pressure")

    @property
    def film(self) -> xr.DataArray:
        """Film thickness, of a dry contact the gap [m]."""
        return self._field("film_thickness" if "film_thickness" in self.solution else _GAP)

    def _field(self, name: str) -> xr.DataArray:
        if name not in self.solution:
            raise AsperityError(f"{self.path}: has no /solution/{name}")
        return self.solution[name]

    def group(self, name: str) -> xr.Dataset:
        """The datasets of any group, as `adequacy/validity`, in SI; empty if the file has no such group."""
        with self._opened() as file:
            if name not in file:
                return xr.Dataset()
            items = {key: item for key, item in file[name].items() if isinstance(item, h5py.Dataset)}
            if name == "transient" and "x" not in items:
                items["x"] = file["solution/x"]
            arrays = {key: _array(item, _dimensions(name, key, item, items)) for key, item in items.items()}
            coordinates = {key: item for key, item in arrays.items() if item.dims == (key,)}
            return xr.Dataset({key: item for key, item in arrays.items() if key not in coordinates}, coordinates)


def read(path: str | os.PathLike[str], keep: tempfile.TemporaryDirectory[str] | None = None) -> Result:
    """A result file of the program. Raises FileNotFoundError, AsperityError if it is none, or not as the program wrote it."""
    return Result(path, keep)


def _restored(name: str, content: bytes) -> Result:
    """The copy of a temporary result."""
    keep = tempfile.TemporaryDirectory(prefix="asperity-")
    path = Path(keep.name) / name
    path.write_bytes(content)
    return Result(path, keep)


def _stamp(path: Path) -> tuple[int, ...]:
    """What changes when a file does."""
    found = path.stat()
    return found.st_dev, found.st_ino, found.st_size, found.st_mtime_ns, found.st_ctime_ns


def _dimensions(group: str, name: str, item: h5py.Dataset, items: dict[str, h5py.Dataset]) -> tuple[str, ...]:
    """Names of the dimensions of a dataset: from its dimension scales, else by its group."""
    if item.is_scale or name in ("x", "y", "time", "profile_time"):
        return tuple([name] * item.ndim)
    scales = [Path(str(axis[0].name)).name if len(axis) else "" for axis in item.dims]
    names = _DIMENSIONS.get(group, {}).get(item.ndim, ())
    chosen = []
    for i, size in enumerate(item.shape):
        fallback = names[i] if i < len(names) and (names[i] not in items or items[names[i]].size == size) else f"{name}_{i + 1}"
        chosen.append(scales[i] or fallback)
    return tuple(chosen)


def _array(item: h5py.Dataset, dimensions: tuple[str, ...]) -> xr.DataArray:
    """A dataset in SI with unit and meaning."""
    attributes = {name: _plain(value) for name, value in item.attrs.items() if not name.isupper()}
    scale = attributes.pop("si_scale", 1.0)
    attributes["units"] = str(attributes.pop("si_units", attributes.get("units", "1")))
    if item.ndim == 0 and "error_estimate" in attributes:
        attributes["error_estimate"] = float(attributes["error_estimate"])
    values = item[()]
    if item.dtype.kind in "SO":
        values = np.vectorize(_plain, otypes=[object])(values)
    elif item.dtype.kind == "f" and scale != 1.0:
        values = values * scale
    return xr.DataArray(values, dims=dimensions, attrs=attributes)


def _plain(value: Any) -> Any:
    """Text for bytes, Python's numbers for those of numpy, arrays as they are."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace").rstrip()
    return value.item() if isinstance(value, np.generic) and not isinstance(value, bytes) else value


def _is_shown(name: str, summary: dict[str, xr.DataArray]) -> bool:
    """Whether the text has a quantity: the central pressure beside a largest one that is known much less."""
    if name != "p_central" or "p_max" not in summary:
        return name in _SHOWN
    errors = {key: summary[key].attrs.get("error_estimate", np.nan) for key in (name, "p_max")}
    most = max(_WELL_KNOWN * float(summary["p_max"]), 2 * errors[name])
    return math.isfinite(errors[name]) and not errors["p_max"] <= most


def _shown(item: xr.DataArray) -> str:
    """A scalar with unit and error estimate."""
    value, error = float(item), item.attrs.get("error_estimate", np.nan)
    unit = item.attrs.get("units", "1").replace("1", "")
    if not np.isfinite(error):
        return f"{value:.4g} {unit} +- not known".replace("  ", " ")
    share = 100 * abs(error / value) if value != 0 else 0.0
    bar = f"{error:.2g} {unit}".strip() if value == 0 else f"{share:.2g} %" if share < 99 else f"{share:.0f} %"
    return f"{value:.4g} {unit} +- {bar}".replace("  ", " ")

"""A gathered table in memory: columns by name, which rows are done, and what of them was varied."""

from __future__ import annotations

import sys
import tomllib
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import h5py
import numpy as np
from case_folder import ROOT
from formulas import FormulaError, evaluate
from sweep_file import SweepError

sys.path.append(str(ROOT / "postproc"))

from result_file import DAMAGE, prefix_of, short_words

PREFIXED = ("m", "Pa", "s")
# Keys in words, where those of their name do not tell.
KEYS = {
    "bodies.speed_1": "Speed of surface 1",
    "bodies.speed_2": "Speed of surface 2",
    "load.hertz_pressure": "Hertzian pressure",
}


@dataclass(frozen=True)
class Axis:
    """How a column is shown: shown = stored / size, and its label."""

    size: float
    words: str
    unit: str

    @property
    def label(self) -> str:
        """Words and unit."""
        return f"{self.words} [{self.unit}]" if self.unit else self.words


@dataclass(frozen=True)
class Gathered:
    """The columns of a gathered file."""

    path: Path
    columns: dict[str, np.ndarray]
    units: dict[str, str]
    parameters: tuple[str, ...]
    title: str
    sweep: dict[str, object]

    @property
    def is_done(self) -> np.ndarray:
        """Cases that converged."""
        return self.columns["status"] == "done"

    @property
    def is_unconverged(self) -> np.ndarray:
        """Cases with a result that did not, or is outside the model."""
        return np.isin(self.columns["status"], ["not converged", "outside the model: mixed"])

    @property
    def is_missing(self) -> np.ndarray:
        """Cases without a result: failed, or not run."""
        return ~(self.is_done | self.is_unconverged)

    def numbers(self, name: str) -> np.ndarray:
        """A column of numbers; raises SweepError if there is none of that name."""
        values = self.column(name)
        if values.dtype == object:
            raise SweepError(f"{self.path}: {name} holds words, expected numbers")
        return values

    def column(self, name: str) -> np.ndarray:
        """A column; raises SweepError if there is none of that name."""
        if name not in self.columns:
            near = [known for known in self.columns if name.lower() in known.lower()][:8] or list(self.columns)[:12]
            raise SweepError(f"{self.path}: found no column {name}, expected one of {', '.join(near)} ...")
        return self.columns[name]

    def errors(self, name: str) -> np.ndarray | None:
        """Estimated errors of a column, NaN where they are not known; None if it has none."""
        return self.columns.get(f"{name}_error")

    def axis(self, name: str) -> Axis:
        """Unit with the prefix that suits the largest value."""
        unit, size, prefix = self.units.get(name, ""), 1.0, ""
        values = np.abs(self.numbers(name))
        if unit in PREFIXED and np.any(values > 0):
            size, prefix = prefix_of(np.nanmax(values))
        unit = {"": "", "1": "-"}.get(unit, prefix + unit)
        return Axis(size, words_of(name), unit)

    def compute(self, entry: str) -> str:
        """Adds the column that `name = formula` defines, of the columns of each case; returns the name. Raises SweepError."""
        name, sign, formula = (part.strip() for part in entry.partition("="))
        if not sign:
            return entry
        values = np.full(len(self.columns["case"]), np.nan)
        for i in range(values.size):
            try:
                values[i] = evaluate(formula, partial(self._value, i))
            except LookupError:  # a value in it is not known
                continue
            except FormulaError as error:
                raise SweepError(f"{self.path}: {name}: {error}") from error
        self.columns[name] = values
        return name

    def _value(self, case: int, name: str) -> object:
        """The value of a column in one case, None without such a column; LookupError where it is not known."""
        value = self.columns[name][case] if name in self.columns else None
        if isinstance(value, float) and np.isnan(value):
            raise LookupError(name)
        return value

    def levels(self, name: str) -> list:
        """The different values of a column, sorted."""
        return sorted(set(self.column(name).tolist()))


def words_of(name: str) -> str:
    """A column in words: h_min with its name behind them, of surface_1.amplitude `Amplitude`."""
    if "." in name:
        return KEYS.get(name, name.rpartition(".")[2].replace("_", " ").capitalize())
    words = short_words(name)
    return words if name.replace("_", " ") in words.lower() or words == name else f"{words} {name}"


def read_gathered(path: Path) -> Gathered:
    """Reads a gathered file, or that of a folder; raises SweepError."""
    path = path / "gathered.h5" if path.is_dir() else path
    if path.exists() and not path.is_file():  # to open a pipe may take for ever
        raise SweepError(f"{path}: found a folder, pipe or device, expected a file")
    try:
        with h5py.File(path) as file:
            columns = {name: _values(item, file["case"].shape) for name, item in file.items()}
            units = {name: str(item.attrs.get("units", "")) for name, item in file.items()}
            sweep = tomllib.loads(file.attrs.get("sweep", ""))
            order = list(file)
        parameters = tuple(order[order.index("case") + 1 : order.index("status")])
        if columns["status"].dtype != object or columns["case"].ndim != 1 or not isinstance(sweep.get("plot", {}), dict):
            raise ValueError("case, status or [plot] are of another kind")
    except FileNotFoundError as error:
        raise SweepError(f"{path}: is not there; batch/gather.py writes it") from error
    except DAMAGE as error:
        raise SweepError(f"{path}: is no gathered table: {' '.join(str(error).split())[:200]}") from error
    return Gathered(path, columns, units, parameters, str(sweep.get("title", "")), sweep)


def _values(item: h5py.Dataset, shape: tuple[int, ...]) -> np.ndarray:
    """A column: words or numbers, one for each case; raises what h5py raises, or ValueError."""
    if item.shape != shape:
        raise ValueError(f"{item.name} has the shape {item.shape}, expected {shape}")
    return np.array(item.asstr()[()], dtype=object) if h5py.check_string_dtype(item.dtype) else item.astype(float)[()]

"""Reads a result file of asperity once: values, labels with units, report, paths of the features.

Values stay as stored (lubricated cases: dimensionless). `Quantity.axis` gives factor and label, dimensionless or SI.
"""

from __future__ import annotations

import contextlib
import math
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import h5py
import numpy as np

# of a checkout; where the package is installed, this folder is in it
sys.path.append(str(Path(__file__).resolve().parent.parent / "python"))

from asperity.seal import DAMAGE, SealError, check_seal


class ResultError(Exception):
    """A file that cannot be drawn; the message is one line and names the file."""


# Beyond this no field is one of a contact.
LARGEST = 1e30
# The best that deflate does: bytes of a dataset over bytes of the file.
DEFLATED = 1100

# What a dataset is called in words, as dimensionless symbol and as SI symbol.
SYMBOLS = {
    "x": ("Position", "X = x/b", "x"),
    "y": ("Position", "Y = y/a", "y"),
    "pressure": ("Pressure", "P = p/p_\\mathrm{h}", "p"),
    "film_thickness": ("Film thickness", "H = hR/b^2", "h"),
    "time": ("Time", "T = t\\,u_\\mathrm{s}/(2b)", "t"),
    "profile_time": ("Time", "T = t\\,u_\\mathrm{s}/(2b)", "t"),
    "load_per_length": ("Load", "w/w_\\mathrm{ref}", "w"),
    "load": ("Load", "w/w_\\mathrm{ref}", "w"),
    "reduced_radius": ("Radius", "R/R_\\mathrm{ref}", "R"),
    "asperity_load_share": ("Asperity load", "w_\\mathrm{a}/w", "w_\\mathrm{a}/w"),
}

# What quantities of /summary are called in words.
WORDS = {
    "h_min": "Smallest film thickness",
    "h_central": "Central film thickness",
    "lambda_ratio": "Lambda ratio",
    "p_max": "Largest pressure",
    "p_central": "Central pressure",
    "friction_coefficient": "Friction coefficient (sliding)",
    "rolling_friction_coefficient": "Friction coefficient (rolling)",
    "sliding_power": "Power of sliding, per length",
    "x_cavitation": "End of the pressure, behind the centre",
    "contact_area_fraction": "Contact area over nominal area",
    "plastic_area_fraction": "Plastic area over nominal area",
    "mean_separation": "Mean separation",
}
# The scripts that draw what others refuse.
DRAWN_BY = {"ehl_point": "point.py", "dry_line": "dry.py", "dry_area": "dry.py"}
PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))

# Half-widths around the contact from which figures take their prefixes.
NEAR = 4.0


def prefix_of(largest: float) -> tuple[float, str]:
    """Size and letter of the prefix that suits the largest of some values."""
    return next((p for p in PREFIXES if largest >= 0.9999 * p[0]), PREFIXES[-1])


def short_words(name: str) -> str:
    """A quantity in words, without what stands in parentheses; its name where there are none."""
    return WORDS.get(name, name).partition(" (")[0]


@dataclass(frozen=True)
class Axis:
    """How a quantity is shown: shown value = stored value * factor.

    `unit_size` is the SI value of one unit, None when dimensionless.
    """

    factor: float
    unit_size: float | None
    words: str
    symbol: str
    definition: str
    unit: str

    @property
    def label(self) -> str:
        """Words, symbol with its definition, unit."""
        return f"{self.words} ${self.definition}$ [{self.unit or '-'}]"

    @property
    def plain_label(self) -> str:
        """Words, symbol, unit."""
        return f"{self.words} ${self.symbol}$ [{self.unit or '-'}]"

    @property
    def difference_label(self) -> str:
        """As a difference to another result."""
        return f"Difference $\\Delta {self.symbol}$ [{self.unit or '-'}]"

    @property
    def short_label(self) -> str:
        """Symbol and unit."""
        return f"${self.symbol}$ [{self.unit or '-'}]"

    def number(self, value: float, largest: float | None = None) -> str:
        """The stored `value` with its unit, three digits of `largest` (default: of itself)."""
        size = abs((value if largest is None else largest) * self.factor)
        decimals = max(0, 2 - math.floor(math.log10(size))) if size > 0 else 0
        number = f"{value * self.factor + 0.0:.{decimals}f}".replace("-", "\N{MINUS SIGN}")
        return f"{number} {self.unit}".rstrip()


@dataclass(frozen=True)
class Quantity:
    """A dataset: stored values and how to get to SI (stored value * si_scale)."""

    name: str
    values: np.ndarray
    si_units: str
    si_scale: float
    largest: float | None = None  # the largest value that figures show, if not all are

    @property
    def has_si(self) -> bool:
        """False for dimensionless studies (&moes), where the SI scale is unknown."""
        return self.si_units not in ("", "1", "-")

    def shown(self, axis: Axis) -> np.ndarray:
        """The values on an axis, which may be that of another result."""
        return self.values * (1.0 if axis.unit_size is None else self.si_scale / axis.unit_size)

    def axis(self, si: bool) -> Axis:
        """Factor and label; SI with the prefix that suits the largest value."""
        words, symbol, si_symbol = SYMBOLS.get(self.name, (self.name, self.name, self.name))
        if not si or self.si_units == "1":
            return Axis(1.0, None, words, symbol.split("=")[0].strip(), symbol, "")
        largest = self.largest if self.largest is not None else np.nanmax(np.abs(self.values), initial=0.0)
        largest = float(largest) * self.si_scale
        size, prefix = prefix_of(largest)
        unit = prefix + self.si_units
        return Axis(self.si_scale / size, size, words, si_symbol, si_symbol, unit)


@dataclass(frozen=True)
class Feature:
    """A ridge, dent or sinusoid and its path X = position + speed T, or by a course (times, ways), dimensionless."""

    surface: int
    shape: str
    amplitude: float
    position: float
    speed: float
    spacing: float
    course: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def word(self) -> str:
        """What a reader calls it."""
        high, low = ("crest", "trough") if self.shape == "sinusoid" else ("ridge", "dent")
        return high if self.amplitude > 0 else low

    def centre(self, time: np.ndarray | float) -> np.ndarray | float:
        """X of the centre at the dimensionless time."""
        return self.position + (self.speed * time if self.course is None else np.interp(time, *self.course))

    def time_at(self, x: float) -> float:
        """Dimensionless time at which the centre is first at X = x, NaN: never; needs a moving feature."""
        if self.course is None:
            return (x - self.position) / self.speed
        passed = np.flatnonzero(np.diff(np.sign(self.course[1] + self.position - x)))
        return float(self.course[0][passed[0] + 1]) if passed.size else math.nan

    def shifted(self, waves: int) -> Feature:
        """The same sinusoid seen from the crest that is `waves` wavelengths further."""
        return replace(self, position=self.position + waves * self.spacing)


@dataclass
class Result:
    """One result file."""

    path: Path
    title: str
    converged: bool
    reason: str
    solution: dict[str, Quantity]
    transient: dict[str, Quantity] = field(default_factory=dict)
    summary: dict[str, float] = field(default_factory=dict)
    report: dict[str, object] = field(default_factory=dict)
    features: list[Feature] = field(default_factory=list)
    cycle_from: float = 0.0  # time from which the last cycle of a periodic history runs

    @property
    def has_history(self) -> bool:
        """Whether load, radius or speeds change in time."""
        return "load_per_length" in self.transient

    @property
    def stem(self) -> str:
        """Name of the file without folder and ending."""
        return self.path.stem

    @property
    def x(self) -> np.ndarray:
        """Stored positions (nx)."""
        return self.solution["x"].values

    @property
    def profile_time(self) -> Quantity:
        """Times of the profiles in /transient; files of older versions hold numbers at these times only."""
        return self.transient.get("profile_time", self.transient["time"])

    @property
    def last_time(self) -> float | None:
        """Stored time of /solution in a transient result, else None."""
        return float(self.transient["time"].values[-1]) if "time" in self.transient else None

    def require_si(self) -> None:
        """Refuses SI units where the file has none."""
        if not self.solution["x"].has_si:
            raise ResultError(f"{self.path}: has no SI scale (dimensionless &moes study); leave out --si")


def check_result(path: str | Path, needs: tuple[str, ...] = ("solution",)) -> None:
    """Raises ResultError unless `path` is a lubricated result with the groups `needs`."""
    with opened(Path(path)) as file:
        _check_content(Path(path), file, needs)


def read_result(path: str | Path, si: bool = False, with_transient: bool = False, problem: str = "ehl_line") -> Result:
    """Reads the lubricated result of a `problem`; `si` refuses a file without SI scale at once.

    Of /transient always the values over time, fields over time only `with_transient`.
    """
    path = Path(path)
    with opened(path) as file:
        _check_content(path, file, ("solution", "transient") if with_transient else ("solution",), problem)
        result = Result(
            path=path,
            title=text_of(file.attrs.get("title", "")),
            converged=bool(np.asarray(file.attrs.get("converged", 0)).item()),
            reason=text_of(file.attrs.get("reason", "")),
            solution=_quantities(path, file, "solution", names_of_fields(problem)),
            summary=_summary(file),
            report={name: _plain(item) for name, item in _datasets(file, "report").items()},
            features=_features(file),
        )
        series = _datasets(file, "transient").items()
        names = tuple(name for name, item in series if item.ndim == 1 and item.size > 0)
        if with_transient:
            names += ("time", "pressure", "film_thickness")
        result.transient = _quantities(path, file, "transient", names) if names else {}
        if result.has_history:
            result.features = [replace(feature, course=_course(result, feature.surface)) for feature in result.features]
            marks = file["summary"].attrs if "summary" in file else {}
            result.cycle_from = float(np.asarray(marks["statistics_from"]).item()) if "period" in marks else 0.0
    for quantities in (result.solution, result.transient):
        for quantity in quantities.values():
            if quantity.name in SYMBOLS and not np.isfinite(quantity.values).any():
                raise ResultError(f"{path}: {quantity.name} has no finite value")
    if si:
        result.require_si()
    return result


@contextlib.contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """The open file; whatever is wrong with it, also while it is read, is a ResultError."""
    with _file(path) as file:
        try:
            yield file
        except DAMAGE as error:
            raise ResultError(f"{path}: damaged: {_first_line(error)}") from None


def values_of(dataset: h5py.Dataset, largest: float = math.inf) -> object:
    """The values of a dataset; a ValueError where they cannot be what the program wrote: too many, or beyond `largest`."""
    if not isinstance(dataset, h5py.Dataset):
        raise ValueError(f"{dataset.name} is no dataset")
    if dataset.nbytes > DEFLATED * dataset.file.id.get_filesize():
        raise ValueError(f"{dataset.name} says that it holds {dataset.nbytes:.3g} bytes")
    values = dataset[()]
    if np.asarray(values).dtype.kind == "f" and np.max(np.abs(values), initial=0.0, where=np.isfinite(values)) > largest:
        raise ValueError(f"{dataset.name} holds a value beyond {largest:g}")
    return values


def _first_line(error: Exception) -> str:
    """What an error says, in one line."""
    return " ".join(str(error).split())[:200] or type(error).__name__


def _file(path: Path) -> h5py.File:
    if path.suffix == ".part":
        raise ResultError(f"{path}: an unfinished result (.part): still being written, or its run was stopped")
    try:
        check_seal(path)
        return h5py.File(path, "r")
    except FileNotFoundError:
        raise ResultError(f"{path}: no such file") from None
    except PermissionError:
        raise ResultError(f"{path}: cannot be read (permission denied)") from None
    except (OSError, SealError) as error:
        raise ResultError(f"{path}: {_first_line(error)}") from None


def names_of_fields(problem: str) -> tuple[str, ...]:
    """The datasets of /solution that figures need."""
    return ("x", *(("y",) if problem == "ehl_point" else ()), "pressure", "film_thickness")


def _check_content(path: Path, file: h5py.File, needs: tuple[str, ...], needed: str = "ehl_line") -> None:
    problem = text_of(file.attrs.get("problem", ""))
    if not problem:
        raise ResultError(f"{path}: not a result of asperity (no attribute 'problem')")
    if problem != needed:
        hint = f"; {DRAWN_BY[problem]} draws it" if problem in DRAWN_BY else ""
        raise ResultError(f"{path}: problem is '{problem}', this figure needs '{needed}'{hint}")
    for group in needs:
        if group not in file:
            hint = " (a steady result)" if group == "transient" else ""
            decision = file.get("adequacy/decision")
            solved = text_of(decision.attrs.get("solved", "")) if decision is not None else ""
            if hint and "in place of" in solved:
                hint = f": model = 'auto' solved {solved}; model = 'full' has it"
            raise ResultError(f"{path}: has no /{group}{hint}")


def _quantities(path: Path, file: h5py.File, group: str, names: tuple[str, ...]) -> dict[str, Quantity]:
    found = {}
    for name in names:
        if name not in file[group]:
            raise ResultError(f"{path}: has no /{group}/{name}")
        dataset = file[group][name]
        values = np.asarray(values_of(dataset, LARGEST), dtype=float)
        values[~np.isfinite(values)] = np.nan
        if values.size == 0:
            raise ResultError(f"{path}: /{group}/{name} is empty")
        scale = float(np.asarray(dataset.attrs.get("si_scale", 1.0)).item())
        found[name] = Quantity(name, values, text_of(dataset.attrs.get("si_units", "1")), scale)
    if "x" in found:  # the inlet of a graded grid is far, and wide open
        near = np.abs(found["x"].values) <= NEAR
        for name, quantity in found.items():
            if quantity.values.shape == near.shape and near.any():
                found[name] = replace(quantity, largest=np.nanmax(np.abs(quantity.values[near]), initial=0.0))
    return found


def _datasets(file: h5py.File, group: str) -> dict[str, h5py.Dataset]:
    if group not in file:
        return {}
    return {name: item for name, item in file[group].items() if isinstance(item, h5py.Dataset)}


def _summary(file: h5py.File) -> dict[str, float]:
    values = {name: _plain(item) for name, item in _datasets(file, "summary").items()}
    return {name: float(value) for name, value in values.items() if np.isscalar(value) and not isinstance(value, str)}


def inputs_of(file: h5py.File, group: str) -> dict[str, object]:
    """The values of a group of /input/effective: attributes; in files of layout 2 and before, datasets."""
    entry = file.get(f"input/effective/{group}")
    if entry is None:
        return {}
    return {key: _plain(value) for key, value in (*entry.attrs.items(), *entry.items())}


def _plain(source: object) -> object:
    """A dataset, or the value of an attribute, as str, number or array."""
    value = values_of(source) if isinstance(source, h5py.Dataset) else source
    if isinstance(value, (bytes, str)):
        return text_of(value)
    array = np.asarray(value)
    if array.dtype.kind in "SO":
        texts = [text_of(item) for item in array.ravel()]
        return texts[0] if len(texts) == 1 else texts
    return array.item() if array.size == 1 else array


def text_of(value: object) -> str:
    """A text as stored: bytes, str or an array of one."""
    if isinstance(value, np.ndarray):
        value = value.ravel()[0] if value.size else ""
    if isinstance(value, bytes):
        value = value.decode("utf-8", "replace")
    return str(value).strip()


def _features(file: h5py.File) -> list[Feature]:
    """The features of both surfaces from the effective input; empty for smooth surfaces."""
    bodies = inputs_of(file, "bodies")
    speeds = [_numbers(bodies, f"speed_{i}") for i in (1, 2)]
    half_width = float(np.asarray(file["scaling"].attrs.get("half_width", np.nan)).item()) if "scaling" in file else np.nan
    if not all(speeds) or speeds[0][0] + speeds[1][0] == 0:
        return []
    features = []
    for surface in (1, 2):
        group = inputs_of(file, f"surface_{surface}")
        speed = 2 * speeds[surface - 1][0] / (speeds[0][0] + speeds[1][0])
        shapes, amplitudes = _words(group, "shape"), _numbers(group, "amplitude")
        positions, wavelengths = _numbers(group, "position"), _numbers(group, "wavelength")
        for i, amplitude in enumerate(amplitudes):
            shape = shapes[min(i, len(shapes) - 1)] if shapes else ""
            if shape not in ("feature", "sinusoid") or amplitude == 0:
                continue
            position = positions[i] if i < len(positions) else 0.0
            spacing = wavelengths[i] / half_width if i < len(wavelengths) else np.nan
            features.append(Feature(surface, shape, amplitude, position, speed, spacing))
    return features


def _course(result: Result, surface: int) -> tuple[np.ndarray, np.ndarray]:
    """Times, and how far a surface has moved by then: its speed is stored over that of u_1 + u_2 in the reference state."""
    time, speed = result.transient["time"].values, result.transient[f"speed_{surface}"].values
    return time, np.append(0.0, np.cumsum(np.diff(time) * (speed[1:] + speed[:-1])))


def _words(group: dict[str, object], key: str) -> list[str]:
    """The words of an input key, stored as text ("'feature', 'sinusoid'") or as array."""
    if key not in group:
        return []
    value = group[key]
    texts = value if isinstance(value, list) else [str(value)]
    return [word for text in texts for word in re.findall(r"[A-Za-z_]+", text)]


def _numbers(group: dict[str, object], key: str) -> list[float]:
    """The numbers of an input key, stored as numbers or as namelist text ('2*1.0d-4, 3.0')."""
    if key not in group:
        return []
    value = group[key]
    if not isinstance(value, (str, list)):
        return [float(number) for number in np.atleast_1d(value)]
    numbers: list[float] = []
    for word in re.split(r"[,\s]+", " ".join(value) if isinstance(value, list) else value):
        repeat, _, last = word.rpartition("*")
        try:
            numbers += [float(last.lower().replace("d", "e"))] * int(repeat or 1)
        except ValueError:
            continue
    return numbers

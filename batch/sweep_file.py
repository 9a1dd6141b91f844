"""Reads a sweep file (TOML): the base case, the parameters with their values, formulas and the figure.

Every finding names file and line of its entry.
"""

from __future__ import annotations

import codecs
import math
import re
import tomllib
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from formulas import is_free

Value = bool | int | float | str | list

TABLES = {
    "base": str,
    "title": str,
    "leave_out": list,
    "vary": dict,
    "together": list,
    "sample": dict,
    "set": dict,
    "formula": dict,
    "plot": dict,
}
RANGE_KEYS = {"from", "to", "count", "spacing", "values", "unit"}
SPACINGS = ("linear", "log")
METHODS = ("latin_hypercube", "sobol")
# Digits of the values inside a range: enough for every namelist, and 0.3 stays 0.3.
DIGITS = 12
# Names in a row, as vary.group.key.from, and lists in lists, as of a key with several values: no sweep has more.
MOST_NAMES, MOST_LISTS = 4, 2
NAME = re.compile(r"[A-Za-z]\w*(\.[A-Za-z]\w*)?")
# What the index and the gathered table call their own columns: a parameter of such a name would be lost, or taken for one.
OWN_COLUMN = re.compile(r"case|status|reason|program|limits_passed|(summary|report|scaling|validity)_.*|.*_error", re.IGNORECASE)
CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")
# First bytes of texts in other encodings; those of UTF-32 begin as those of UTF-16.
ENCODINGS = {
    codecs.BOM_UTF32_LE: "UTF-32",
    codecs.BOM_UTF32_BE: "UTF-32",
    codecs.BOM_UTF16_LE: "UTF-16",
    codecs.BOM_UTF16_BE: "UTF-16",
}


class SweepError(Exception):
    """What is wrong with a sweep: one line for each finding."""


@dataclass(frozen=True)
class Parameter:
    """What one parameter runs through: its values, or a range from `start` to `stop`.

    `count` is None for a range that a sample covers. Two integers as ends make integers.
    """

    name: str
    line: int
    unit: str = ""
    values: tuple[Value, ...] = ()
    start: float = 0.0
    stop: float = 0.0
    count: int | None = None
    is_log: bool = False

    def value(self, i: int) -> Value:
        """Value number `i`, from 0."""
        if self.values:
            return self.values[i]
        if i == 0 or self.count == 1:
            return self.start
        return self.stop if i == self.count - 1 else self.between(i / (self.count - 1))

    def between(self, share: float) -> float:
        """The value at `share` of the way, 0 to 1."""
        if self.is_log:
            return _rounded(self.start * (self.stop / self.start) ** share)
        if isinstance(self.start, int) and isinstance(self.stop, int):
            step = (self.stop - self.start) * share
            return self.start + round(step) if self.count else self.start + math.floor(share * (self.stop - self.start + 1))
        return _rounded(self.start + (self.stop - self.start) * share)


@dataclass(frozen=True)
class Sample:
    """A sample of all ranges without a count."""

    method: str
    count: int
    seed: int
    line: int


@dataclass
class SweepFile:
    """A sweep as its file says it."""

    path: Path
    text: str
    base: Path = Path()
    title: str = ""
    leave_out: list[str] = field(default_factory=list)
    parameters: list[Parameter] = field(default_factory=list)
    together: list[list[str]] = field(default_factory=list)
    sample: Sample | None = None
    constants: dict[str, Value] = field(default_factory=dict)
    formulas: dict[str, str] = field(default_factory=dict)
    plot: dict[str, object] = field(default_factory=dict)
    findings: list[str] = field(default_factory=list)

    @cached_property
    def _lines(self) -> dict[str, int]:
        return _lines(self.text)

    def line_of(self, *names: str) -> int:
        """The line on which the entry stands, or the nearest entry around it; 1 if there is none."""
        for end in range(len(names), 0, -1):
            if (line := self._lines.get(".".join(names[:end]))) is not None:
                return line
        return 1

    def find(self, line: int, words: str) -> None:
        """Notes a finding."""
        self.findings.append(f"{self.path}:{line}: {words}")

    def refuse(self) -> None:
        """Ends with the findings, if there are any."""
        if self.findings:
            raise SweepError("\n".join(self.findings))


def read_text(path: Path) -> str:
    """A text in UTF-8 without byte-order mark, lines ended by LF, whatever ended them before; raises SweepError."""
    try:
        if path.exists() and not path.is_file():  # to read a pipe may take for ever
            raise SweepError(f"{path}: found a folder, pipe or device, expected a file")
        content = path.read_bytes()
    except (OSError, ValueError) as error:
        raise SweepError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    found = next((name for mark, name in ENCODINGS.items() if content.startswith(mark)), "")
    if found or b"\0" in content:
        raise SweepError(f"{path}: found {found or 'NUL bytes, as UTF-16 has them'}, expected a text file in UTF-8")
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        number = len(re.findall(rb"\r\n?|\n", content[: error.start])) + 1
        words = f"found the byte 0x{content[error.start]:02X}, expected a text file in UTF-8"
        raise SweepError(f"{path}:{number}: {words}") from error
    return re.sub(r"\r\n?", "\n", text)


def read_sweep_file(path: Path) -> SweepFile:
    """Reads and checks a sweep file; raises SweepError with all findings."""
    text = read_text(path)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        line = re.search(r"at line (\d+)", str(error))
        number = line[1] if line else len(text.splitlines())
        raise SweepError(f"{path}:{number}: is not TOML: {error}") from error
    except (RecursionError, ValueError) as error:
        words = "lists or tables too deep in each other" if isinstance(error, RecursionError) else "a number of thousands of digits"
        raise SweepError(f"{path}: found {words}") from error
    sweep = SweepFile(path, text)
    _check_values(sweep, tables)
    for name, value in tables.items():
        if name not in TABLES:
            sweep.find(sweep.line_of(name), f"found the unknown entry {name}, expected one of {', '.join(TABLES)}")
        elif not isinstance(value, TABLES[name]):
            sweep.find(sweep.line_of(name), f"found {value!r} for {name}, expected a {_word(TABLES[name])}")
    sweep.refuse()
    _read_base(sweep, tables)
    sweep.parameters = [
        parameter for name, value, line in _entries(sweep, tables, "vary") if (parameter := _parameter(sweep, name, value, line))
    ]
    _read_sample(sweep, tables.get("sample"))
    _read_together(sweep, tables.get("together", []))
    sweep.constants = {name: value for name, value, _ in _entries(sweep, tables, "set")}
    sweep.formulas = {name: value for name, value, _ in _entries(sweep, tables, "formula")}
    _check_names(sweep)
    sweep.title = tables.get("title", "")
    sweep.leave_out = tables.get("leave_out", [])
    sweep.plot = tables.get("plot", {})
    sweep.refuse()
    return sweep


def _check_values(sweep: SweepFile, tables: dict) -> None:
    """Ends with what TOML can say and no namelist: dates, integers of more than 64 bits, words of several lines, deep nests."""
    found: dict[tuple[str, ...], str] = {}
    entries = [((name,), 0, value) for name, value in tables.items()]
    for names, depth, value in entries:
        if isinstance(value, dict) and len(names) < MOST_NAMES:
            entries += [((*names, name), 0, inner) for name, inner in value.items()]
        elif isinstance(value, list) and depth < MOST_LISTS:
            entries += [(names, depth + 1, inner) for inner in value]
        elif isinstance(value, dict | list):
            found.setdefault(names, "lists or tables too deep in each other")
        elif not isinstance(value, Value):
            found.setdefault(names, f"the date or time {value}, expected a number, or words in quotes")
        elif isinstance(value, int) and not -(2**63) <= value < 2**63:
            found.setdefault(names, f"an integer of {len(str(abs(value)))} digits, expected at most 64 bits (or a real number)")
        elif isinstance(value, str) and (sign := CONTROL.search(value)):
            found.setdefault(names, f"the character U+{ord(sign[0]):04X} in words, expected one line of text")
    for names, words in found.items():
        sweep.find(sweep.line_of(*names), f"{'.'.join(names)}: found {words}")
    sweep.refuse()


def _read_base(sweep: SweepFile, tables: dict) -> None:
    if "base" not in tables:
        sweep.find(1, 'found no base case, expected base = "CASE.nml" (relative to this file)')
    else:
        sweep.base = sweep.path.parent / tables["base"]
        if not sweep.base.is_file():
            sweep.find(sweep.line_of("base"), f"there is no base case {sweep.base}")
    if not tables.get("vary"):
        sweep.find(sweep.line_of("vary"), "found nothing to vary, expected a table [vary] with at least one parameter")


def _entries(sweep: SweepFile, tables: dict, table: str) -> list[tuple[str, object, int]]:
    """Name, value and line of the entries of a table; `group.key` is a table in a table."""
    found = []
    for name, value in tables.get(table, {}).items():
        if isinstance(value, dict) and not (table == "vary" and RANGE_KEYS & value.keys()):
            found += [(f"{name}.{key}", inner, sweep.line_of(table, name, key)) for key, inner in value.items()]
        else:
            found.append((name, value, sweep.line_of(table, name)))
    return found


def _parameter(sweep: SweepFile, name: str, value: object, line: int) -> Parameter | None:
    """One parameter; None with a finding if it is none."""
    entry = {"values": value} if isinstance(value, list) else value
    if not isinstance(entry, dict):
        words = f"found {value!r} for {name}, expected a list, or a range {{ from = ..., to = ..., count = ... }}"
        return sweep.find(line, words)
    if unknown := sorted(entry.keys() - RANGE_KEYS):
        return sweep.find(line, f"found {', '.join(unknown)} in {name}, expected from, to, count, spacing, values, unit")
    unit = str(entry.get("unit", ""))
    if "values" in entry:
        return _listed(sweep, name, entry["values"], line, unit)
    return _range(sweep, name, entry, line, unit)


def _listed(sweep: SweepFile, name: str, values: object, line: int, unit: str) -> Parameter | None:
    if not isinstance(values, list) or not values:
        return sweep.find(line, f"found no values for {name}, expected at least one")
    if any(isinstance(value, dict) for value in values):
        return sweep.find(line, f"found a table among the values of {name}, expected numbers, words or lists of them")
    return Parameter(name, line, unit, tuple(values), count=len(values))


def _range(sweep: SweepFile, name: str, entry: dict, line: int, unit: str) -> Parameter | None:
    start, stop, count, spacing = (entry.get(key) for key in ("from", "to", "count", "spacing"))
    words = ""
    if not (_is_number(start) and _is_number(stop)):
        words = "expected numbers from and to"
    elif count is not None and (isinstance(count, bool) or not isinstance(count, int) or count < 1):
        words = f"found count = {count!r}, expected an integer >= 1"
    elif spacing not in (None, *SPACINGS):
        words = f"found spacing = {spacing!r}, expected 'linear' or 'log'"
    elif spacing == "log" and min(start, stop) <= 0:
        words = f"found a logarithmic range from {start} to {stop}, expected both ends above zero"
    elif start == stop:
        words = f"found a range from {start} to {stop}, which is one value, expected different ends (or a list)"
    elif count == 1:
        words = "found count = 1 for a range with two ends, expected at least 2"
    if words:
        return sweep.find(line, f"{name}: {words}")
    return Parameter(name, line, unit, (), start, stop, count, spacing == "log")


def _read_sample(sweep: SweepFile, entry: dict | None) -> None:
    """The table [sample], which the ranges without a count need."""
    open_ranges = [parameter for parameter in sweep.parameters if parameter.count is None]
    if entry is None:
        for parameter in open_ranges:
            sweep.find(parameter.line, f"{parameter.name}: found a range without count, expected count = ... (or a table [sample])")
        return
    line = sweep.line_of("sample")
    method, count, seed = entry.get("method", METHODS[0]), entry.get("count"), entry.get("seed", 0)
    if unknown := sorted(entry.keys() - {"method", "count", "seed"}):
        sweep.find(line, f"found {', '.join(unknown)} in [sample], expected method, count, seed")
    elif method not in METHODS:
        sweep.find(line, f"found method = {method!r}, expected 'latin_hypercube' or 'sobol'")
    elif isinstance(count, bool) or not isinstance(count, int) or count < 1:
        sweep.find(line, f"found count = {count!r} in [sample], expected an integer >= 1")
    elif isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        sweep.find(line, f"found seed = {seed!r} in [sample], expected an integer >= 0")
    elif method == "sobol" and count & (count - 1):
        sweep.find(line, f"found {count} points of a Sobol sample, which is even only with a power of two")
    elif not open_ranges:
        sweep.find(line, "found nothing to sample, expected at least one range without count")
    else:
        sweep.sample = Sample(method, count, seed, line)


def _read_together(sweep: SweepFile, lists: list) -> None:
    """Parameters that go from value to value together: lists of names."""
    line = sweep.line_of("together")
    counts = {parameter.name: parameter.count for parameter in sweep.parameters}
    if lists and all(isinstance(name, str) for name in lists):
        lists = [lists]
    seen: set[str] = set()
    for names in lists:
        if not isinstance(names, list) or len(names) < 2:
            sweep.find(line, f"found {names!r} in together, expected lists of at least two names")
            continue
        for name in names:
            if name not in counts:
                sweep.find(line, f"found {name} in together, expected parameters of [vary]")
            elif counts[name] is None:
                sweep.find(line, f"found {name} in together, whose values the sample chooses")
            elif name in seen:
                sweep.find(line, f"found {name} twice in together, expected it once")
            seen.add(name)
        lengths = {name: counts[name] for name in names if counts.get(name)}
        if len(set(lengths.values())) > 1:
            words = ", ".join(f"{name} {length}" for name, length in lengths.items())
            sweep.find(line, f"found different numbers of values in together ({words}), expected equal ones")
        sweep.together.append(names)


def _check_names(sweep: SweepFile) -> None:
    """Each key has one source, and the names of cases and results belong to the sweep."""
    owners: dict[str, str] = {}
    named = [("vary", parameter.name) for parameter in sweep.parameters]
    named += [("set", name) for name in sweep.constants] + [("formula", name) for name in sweep.formulas]
    for table, name in named:
        line = sweep.line_of(table, *name.split("."))
        if name.lower() in owners:
            sweep.find(line, f"found {name} in [{table}] and in [{owners[name.lower()]}], expected it once")
        owners[name.lower()] = table
        if name.lower() == "case.output":
            sweep.find(line, "found case.output: results are named like their cases, case_0001.h5 and so on")
        if not NAME.fullmatch(name) or (OWN_COLUMN.fullmatch(name) and "." not in name):
            words = "expected group.key, or a name of your own (columns of the gathered table are case, status, reason, program,"
            words += " limits_passed, ..._error, summary_..., report_..., scaling_..., validity_...)"
            sweep.find(line, f"found the name {name}, {words}")
        elif not is_free(name):
            sweep.find(line, f"found the name {name}, which means something else in formulas, expected another one")
        if table == "set" and "." not in name:
            sweep.find(line, f"found {name} in [set], expected group.key")
        if table == "formula" and not isinstance(sweep.formulas[name], str):
            sweep.find(line, f"found {sweep.formulas[name]!r} for {name}, expected a formula in quotes")


def _lines(text: str) -> dict[str, int]:
    """Dotted name of every table and entry -> line. (tomllib does not keep lines.)"""
    found: dict[str, int] = {}
    table = ""
    for number, line in enumerate(text.splitlines(), start=1):
        if header := re.match(r"\s*\[+([^\]]+)\]+", line):
            table = _plain(header[1])
            found.setdefault(table, number)
        elif entry := re.match(r"\s*([\w.\"' -]+?)\s*=", line):
            name = _plain(entry[1])
            found.setdefault(f"{table}.{name}" if table else name, number)
    return found


def _plain(name: str) -> str:
    return re.sub(r"[\"'\s]", "", name)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _word(kind: type) -> str:
    return {str: "text", dict: "table", list: "list"}[kind]

"""Cases as people have them, as arguments of the program."""

from __future__ import annotations

import contextlib
import io
import math
import numbers
import os
import re
import tempfile
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

import f90nml

from .errors import Finding, InputError

Case = str | os.PathLike[str] | Mapping[str, Mapping[str, Any]]
# A group, as a text has one at the start of a line.
_GROUP = re.compile(r"^\s*&\w+(\s|/\s*$)", re.MULTILINE)
_GROUP_NAME = re.compile(r"[A-Za-z]\w*", re.ASCII)
_KEY_NAME = re.compile(r"[A-Za-z]\w*( *\( *\d*( *: *\d*)? *\))?", re.ASCII)
# What f90nml calls the first elements of arrays in a dictionary.
_START_INDEX = "_start_index"
_VALUES = "a number, a text, True or False, a path, or several of one kind"
# What may lie beside a result of the same name.
_ENDINGS = (".h5", ".h5.part", ".h5.tmp", ".h5.ckpt", ".xdmf")


@contextlib.contextmanager
def namelist_of(case: Case, folder: Path | None = None) -> Iterator[list[str]]:
    """Path of the namelist of a case, then further arguments of the program; what is written for it goes at the end.

    A case that has no file gets one in `folder`, under a name that no result there has, else in a temporary folder. Its relative
    paths are those from the current folder. Raises FileNotFoundError, InputError.
    """
    if _is_path(case):
        try:
            path = os.path.abspath(os.fsdecode(case))  # type: ignore[arg-type] # noqa: PTH100 -- Path would follow links
            os.stat(path)  # noqa: PTH116
        except ValueError as error:
            raise InputError([Finding(0, "", "", f"found a path that cannot be one: {error}")]) from error
        yield [path]
        return
    text, entries = (written(case), []) if isinstance(case, Mapping) else (_as_lines(str(case)), _paths_in(str(case)))
    try:
        content = text.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError as error:
        raise InputError([Finding(0, "", "", f"found a character that is none, expected text ({error.reason})")]) from error
    with contextlib.ExitStack() as stack:
        place = folder or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="asperity-")))
        path = _new_file(place)
        stack.callback(Path(path).unlink, missing_ok=True)
        Path(path).write_bytes(content)
        yield [path, *entries]


def _is_path(case: Case) -> bool:
    """Whether a case is a path: also a string with an `&`, unless it has several lines or begins with a group."""
    if isinstance(case, str):
        return os.path.isfile(case) or not ("\n" in case or "\r" in case or _GROUP.search(case.removeprefix("\ufeff")))  # noqa: PTH113
    if not isinstance(case, Mapping | os.PathLike):
        words = f"found a case that is a {type(case).__name__}, expected a path, the text of a namelist, or a mapping of groups"
        raise InputError([Finding(0, "", "", words)])
    return isinstance(case, os.PathLike)


def _new_file(folder: Path) -> str:
    """An empty namelist in `folder` with a name of its own: that of no result, and, while it is there, of no other run."""
    number = 1
    while True:
        stem = os.path.abspath(folder / ("case" if number == 1 else f"case_{number}"))  # noqa: PTH100
        number += 1
        try:
            Path(f"{stem}.nml").touch(exist_ok=False)
        except FileExistsError:
            continue
        if not any(os.path.lexists(stem + ending) for ending in _ENDINGS):
            return f"{stem}.nml"
        Path(f"{stem}.nml").unlink()


def _as_lines(text: str) -> str:
    """A text without byte order mark, its lines ended by line feeds."""
    return text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")


def read_namelist(text: str) -> f90nml.Namelist:
    """A text as f90nml understands it. Raises InputError."""
    try:
        return f90nml.reads(_as_lines(text))
    except Exception as error:  # it raises what happens to it
        raise InputError([Finding(0, "", "", f"f90nml cannot read the namelist: {error}")]) from error


def _paths_in(text: str) -> list[str]:
    """Arguments of the program that make the relative paths of a text whole; of one that f90nml cannot read, none."""
    entries: list[str] = []
    if "file" not in text.lower():
        return entries
    try:
        groups = read_namelist(text)
    except InputError:
        return entries
    for group, keys in groups.items():
        file = keys.get("file") if isinstance(keys, Mapping) else None
        if file and isinstance(file, str) and not os.path.isabs(file):  # noqa: PTH117
            entries += ["--set", f"{group}.file={_quoted(_whole(file))}"]
    return entries


def _whole(file: str) -> str:
    return os.path.join(os.getcwd(), file)  # noqa: PTH109, PTH118


def _quoted(text: str) -> str:
    """A text as Fortran writes it."""
    return "'" + text.replace("'", "''") + "'"


class _Writer(f90nml.Namelist):  # type: ignore[misc]
    """A namelist whose texts are written as they are: f90nml alone escapes some characters as Python does."""

    def _f90str(self, value: str) -> str:
        return _quoted(value)


def written(case: Mapping[str, Mapping[str, Any]], whole: Callable[[str], str] = _whole) -> str:
    """The namelist of a mapping group -> key -> value, paths of files by `whole`. Raises InputError with all findings."""
    findings: list[Finding] = []
    groups: OrderedDict[str, OrderedDict[str, Any]] = OrderedDict()  # f90nml sorts the keys of a plain dict
    for group, keys in case.items():
        name = _name(group, "", _GROUP_NAME, groups, findings)
        if not isinstance(keys, Mapping):
            findings.append(Finding(0, name, "", f"found a {type(keys).__name__}, expected a mapping of keys to values"))
            continue
        values: OrderedDict[str, Any] = OrderedDict()
        for key, value in keys.items():
            if key == _START_INDEX:
                values[key] = value
                continue
            own = _name(key, name, _KEY_NAME, values, findings)
            try:
                values[own] = plain = _plain(value)
            except Exception as error:  # also of the value's own methods
                findings.append(Finding(0, name, own, str(error)))
                continue
            if own == "file" and plain and isinstance(plain, str):
                values[own] = whole(plain)
        if isinstance(keys, f90nml.Namelist) and keys.start_index:
            values[_START_INDEX] = keys.start_index
        groups[name] = values
    if findings:
        raise InputError(findings)
    target = io.StringIO()
    try:
        _Writer(groups).write(target)
    except Exception as error:
        raise InputError([Finding(0, "", "", f"f90nml cannot write the case: {error}")]) from error
    return target.getvalue()


def _name(name: object, group: str, pattern: re.Pattern[str], taken: Mapping[str, Any], findings: list[Finding]) -> str:
    """The name of a group or of a key of `group` in lower case, with a finding if it cannot be one, or is there already."""
    text = str(name).lower()
    if not isinstance(name, str) or not pattern.fullmatch(text):
        findings.append(Finding(0, group, "", f"found the name {name!r}, expected letters, digits and _"))
    elif text in taken:
        findings.append(Finding(0, group or text, text if group else "", "found twice, expected once"))
    return text


def _plain(value: Any) -> Any:
    """A value in Python's own types, paths as text, sequences as lists. Raises ValueError: of another kind, or nothing."""
    value = _own(value)
    if not isinstance(value, Sequence) or isinstance(value, str | bytes | bytearray):
        return _single(value)
    if not value:
        raise ValueError(f"found no value, expected {_VALUES}")
    return [_single(_own(item)) for item in value]


def _own(value: Any) -> Any:
    """A value of numpy, pandas or xarray as one of Python."""
    if hasattr(value, "to_numpy"):
        value = value.to_numpy()
    if getattr(getattr(value, "dtype", None), "kind", None) in ("m", "M"):  # they would become numbers
        raise ValueError(f"found a date or a span of time, expected {_VALUES}")
    return value.tolist() if hasattr(value, "tolist") else value


def _single(value: Any) -> bool | int | float | str:
    """One value. Raises ValueError."""
    if isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str.__str__(value)  # of an Enum too its value
    if isinstance(value, os.PathLike):
        return os.fsdecode(value)
    if isinstance(value, numbers.Real | Decimal):
        number = float(value)
        if not math.isfinite(number):
            raise ValueError(f"found {value}, expected a finite number")
        return int(value) if isinstance(value, numbers.Integral) else number
    raise ValueError(f"found {value!r:.60} ({type(value).__name__}), expected {_VALUES}")

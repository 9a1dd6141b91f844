"""Cases as people have them, as the text of a namelist."""

from __future__ import annotations

import io
import os
import re
from collections import OrderedDict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import f90nml

Case = str | os.PathLike[str] | Mapping[str, Mapping[str, Any]]
_FILE = re.compile(r"""(\bfile\s*=\s*)(['"])(.+?)\2""", re.IGNORECASE)


def name_and_text(case: Case) -> tuple[str, str]:
    """Name of a case, and its namelist with whole paths.

    A string that holds `&` is the text of a namelist, any other the path of one; paths inside a file are relative to that
    file, all others to the current folder.
    """
    if isinstance(case, Mapping):
        return "case", _with_whole_paths(_written(case), Path.cwd())
    if isinstance(case, str) and "&" in case:
        return "case", _with_whole_paths(case, Path.cwd())
    path = Path(case)
    return path.stem, _with_whole_paths(path.read_text(encoding="utf-8", errors="surrogateescape"), path.resolve().parent)


def _written(case: Mapping[str, Mapping[str, Any]]) -> str:
    """The namelist of a mapping group -> key -> value."""
    # f90nml sorts the keys of a plain dict
    plain = OrderedDict((group, OrderedDict((key, _plain(value)) for key, value in keys.items())) for group, keys in case.items())
    target = io.StringIO()
    f90nml.Namelist(plain).write(target)
    return target.getvalue()


def _plain(value: Any) -> Any:
    """Numbers and lists of Python in place of those of numpy and xarray; paths as text."""
    if hasattr(value, "tolist"):
        return value.tolist()
    return str(value) if isinstance(value, os.PathLike) else value


def _with_whole_paths(text: str, folder: Path) -> str:
    """The text with every `file = '...'` relative to `folder` made whole; no line is added or removed."""
    return _FILE.sub(lambda found: f"{found[1]}{found[2]}{folder / found[3]}{found[2]}", text)

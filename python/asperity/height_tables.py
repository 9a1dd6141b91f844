"""Tables of measured heights as other programs write them: numbers, names and units of their columns, what stands above them."""

from __future__ import annotations

import codecs
import csv
import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

Floats = np.ndarray[Any, np.dtype[np.float64]]

METRES = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "angstrom": 1e-10, "pm": 1e-12}
METRES |= {"in": 0.0254, "mil": 2.54e-5, "uin": 2.54e-8}
SPELLINGS = {"micron": "um", "inch": "in", "thou": "mil", "uinch": "uin", "microinch": "uin", "å": "angstrom"}
PREFIXES = {"": "", "centi": "c", "milli": "m", "micro": "u", "nano": "n", "pico": "p"}
SPELLINGS |= {prefix + metre: letter + "m" for prefix, letter in PREFIXES.items() for metre in ("metre", "meter")}
# A cell that may be a number; one with a decimal point; the words of programs for a point that was not measured.
NUMBER = re.compile(r"[+-]?(?:[\d.,'’]|(?<=\d) (?=\d{3}(?!\d)))*\d\.?(?:[eEdD][+-]?\d+)?")
PLAIN = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
# A number with one comma or more: a decimal mark, or one of thousands.
COMMAS = re.compile(r"[+-]?(?:(?:\d+|\d{1,3}(?:\.\d{3})+),\d+|\d{1,3}(?:,\d{3})+\.?\d*)(?:[eEdD][+-]?\d+)?")
MISSING = re.compile(r"(?i)|[+-]?(?:nan(?:\(\w*\))?|1\.#\w*|inf(?:inity)?)|#?n/?a|null|none|bad|missing|no ?data|void|[-*?_.]+")
# What names of columns and lines above a matrix say.
ROLES = {
    role: re.compile(rf"(?:{role}(?:[ _.-]?(?:pos(?:ition)?|axis|coord(?:inate)?|value)s?)?{more})")
    for role, more in {"x": "|pos(?:ition)?s?|distance|length|path", "y": "", "z": "|heights?|h|profile"}.items()
}
SIZE = r"\W+([\d.,]+(?:e[+-]?\d+)?)\W*([a-zµμåÅ]+)(?:/(?:pixel|px|point))?\W*"
SPACING = re.compile(rf"(?i)(?:xy calibration|(?:(?:lateral|xy) )?(?:pixel|point)? ?(?:size|spacing|pitch)){SIZE}")
SIZES = [re.compile(rf"(?i){word}{SIZE}") for word in ("width", "height")]
UNIT_OF_HEIGHTS = re.compile(r"(?i)(?:(?:value|height|z)s?[ _])?units?\W+([a-zµμåÅ]+)\W*")


class Refusal(Exception):
    """Why a file is not converted: one line, `found ..., expected ...`."""


@dataclass
class Table:
    """Rows of numbers (NaN: missing); name and unit of each column, if they have any; the lines above them."""

    values: Floats
    names: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    header: list[str] = field(default_factory=list)

    def listing(self, columns: Iterable[int] | None = None) -> str:
        """Columns with their ranges: the first eight, or those of these numbers."""
        words = []
        for i in range(min(8, self.values.shape[1])) if columns is None else columns:
            known = self.values[np.isfinite(self.values[:, i]), i]
            extent = f"({known.min():.6g} to {known.max():.6g})" if known.size else "(no numbers)"
            words.append(" ".join(filter(None, [str(i + 1), self.names[i] if self.names else "", extent])))
        return ", ".join(words) + (", ..." if columns is None and self.values.shape[1] > 8 else "")


@dataclass
class Heights:
    """Heights [m], (nx) or (ny, nx), NaN where none was measured; the spacing in x and y [m]; which of the file they are."""

    z: Floats
    spacing: tuple[float, ...]
    origin: str = ""


def unit_word(spelling: str) -> str:
    """The usual word for a unit of length; empty: it is none."""
    plain = re.sub("[µμ]", "u", spelling.strip().lower().replace("\u212b", "å"))
    return plain if plain in METRES else SPELLINGS.get(plain, SPELLINGS.get(plain.removesuffix("s"), ""))


def split_unit(name: str) -> tuple[str, str]:
    """Name and unit of `x_mm`, `z [um]`, `z (nm)`, `x/mm`; the unit as it is written, empty if there is none."""
    if found := re.fullmatch(r"(.*?)[\s_]*(?:[\[({<]\s*([^\[({<]*?)\s*[\])}>]|/\s*([^/]+))", name):
        return found[1], found[2] or found[3] or ""
    found = re.fullmatch(r"(.+)[\s_.,-]([^\s_.,-]+)", name)
    is_unit = found and unit_word(found[2]) and found[2].lower() not in ("in", "mil", "thou")
    return (found[1], found[2]) if found and is_unit else (name, "")


def decoded(data: bytes) -> str | None:
    """The text of a file, in UTF-8, UTF-16 or Latin-1; None: it is no text, or in the text format of an instrument."""
    marks = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
    high, low = data[:200:2].count(0), data[1:200:2].count(0)
    silent = "utf-16-be" if high > 2 * low else "utf-16-le" if low > 2 * high else "utf-8"
    try:
        text = data.decode(next((encoding for mark, encoding in marks.items() if data.startswith(mark)), silent))
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    text = text.rstrip("\x1a").translate({0xA0: " ", 0x2009: " ", 0x202F: " ", 0x2212: "-"})
    return None if re.search(r"[\x00-\x08\x0e-\x1f\x7f]", text) or text.startswith(("aISO", "aBCR")) else text


def read_npy(path: Path) -> Table:
    """The table in a file of numpy."""
    try:
        values = np.load(path, allow_pickle=False)
    except Exception as error:  # of damaged headers it raises what Python's own parser does
        raise Refusal(
            f"found a file of numpy that cannot be read ({type(error).__name__}), expected an array of numbers"
        ) from error
    if values.ndim not in (1, 2) or values.dtype.kind not in "fiu" or not values.size:
        raise Refusal(f"found an array {values.shape} of {values.dtype}, expected real numbers in one or two dimensions")
    return Table(values.astype(float).reshape(len(values), -1))


def read_text(text: str, decimal: str | None, missing: str | None) -> Table:
    """The table in a text: comments (#, %) and lines that are no rows of numbers may stand above it.

    `decimal` is the decimal mark, `.,` for both; None: that with which all cells are numbers. `missing` marks missing points,
    besides the words that programs use for them, if it is no number. Refusal: a cell that is no number, rows of different
    lengths, doubts.
    """
    missing = None if missing is None or NUMBER.fullmatch(missing) else missing
    lines = [line.strip(" ") for line in re.split(r"\r\n|\r|\n", text)]
    filled = [i for i, line in enumerate(lines) if line.lstrip()[:1] not in ("", "#", "%")]
    separator = _separator([lines[i] for i in filled], decimal, missing)
    start = next((i for i in filled if _is_row(split(lines[i], separator), missing)), len(lines))
    numbers = [i for i in filled if i >= start]
    if not numbers:
        raise Refusal("found no rows of numbers, expected heights")
    rows = list(csv.reader([lines[i] for i in numbers], delimiter=separator, skipinitialspace=True, strict=True))
    width = len(rows[0])
    for i, row in zip(numbers, rows, strict=False):
        if len(row) != width:
            raise Refusal(f"line {i + 1}: found {len(row)} numbers, expected {width} as in line {start + 1}")
    cells = pd.Series([cell.strip() for row in rows for cell in row], dtype=object)
    values = _numbers(cells, decimal, missing, lambda place: numbers[place // width] + 1).reshape(-1, width)
    used = max(i + 1 for i in range(width) if any(row[i].strip() for row in rows))
    for i in filled[: filled.index(start)]:
        first, *others = split(lines[i], separator) or [""]
        if NUMBER.fullmatch(first) and len(others) == width - 1:
            raise Refusal(f"line {i + 1}: found {lines[i]!r} above the numbers, expected names or numbers only")
    header = [re.sub(r"^[#%][#%\s]*", "", line) for line in lines[:start] if re.search(r"\w", line)]
    table = Table(values[:, :used], header=header)
    _read_names(table, width, separator)
    return table


def split(line: str, separator: str) -> list[str]:
    """The cells of a line; quotes are taken off."""
    return [cell.strip() for cell in next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])]


def _is_row(cells: list[str], missing: str | None) -> bool:
    """Whether cells are numbers, or numbers and marks of missing points."""
    numbers = [NUMBER.fullmatch(cell) is not None for cell in cells]
    marks = [cell == missing or MISSING.fullmatch(cell) is not None for cell in cells]
    counts = any(n or (m and cell[-1:].isalpha()) for n, m, cell in zip(numbers, marks, cells, strict=True))
    return counts and all(n or m for n, m in zip(numbers, marks, strict=True))


def _separator(lines: list[str], decimal: str | None, missing: str | None) -> str:
    """What separates the cells of most of the last lines; a tab if there is only one. Refusal: a comma may be a decimal mark."""
    rows = {mark: [line for line in lines[-20:] if mark in line and _is_row(split(line, mark), missing)] for mark in "\t; ,"}
    mark = max(rows, key=lambda mark: len(rows[mark]))
    if mark != "," or decimal == "." or not all(COMMAS.fullmatch(line) for line in rows[mark]):
        return mark
    names = [line for line in lines if re.search("[A-Za-z]", line)][-1:]
    if decimal is None and (not names or len(split(names[0], ",")) != len(split(rows[mark][-1], ","))):
        raise Refusal(f"found {rows[mark][-1]!r}, one number or several, expected --decimal . (several) or --decimal , (one)")
    return mark if decimal is None else "\t"


def _numbers(cells: pd.Series[str], decimal: str | None, missing: str | None, line_of: Any) -> Floats:
    """The numbers of all cells, with the decimal mark and the separators of thousands that fit all of them; NaN: missing."""
    if decimal in (None, ".") and not set("_,") & set("".join(cells)):
        try:  # most files: plain numbers
            plain: Floats = cells.to_numpy(dtype=float)
        except ValueError:
            plain = np.full(1, np.nan)
        if np.all(np.isfinite(plain)):
            return plain
    marked = cells.map(lambda cell: cell == missing or MISSING.fullmatch(cell) is not None).to_numpy(bool)
    body = cells[~marked].str.replace(r"(?<=\d)['’ ](?=\d{3}(?!\d))", "", regex=True).str.replace("[dD]", "e", regex=True)
    has_commas = body.str.contains(",", regex=False).any()
    readings = {mark: _with_mark(body, mark) for mark in ([decimal] if decimal else [".", ",", ".,"] if has_commas else ["."])}
    fitting = {mark: numbers for mark, numbers in readings.items() if np.all(np.isfinite(numbers))}
    if not fitting:
        fit = {mark: int(np.isfinite(numbers).sum()) for mark, numbers in readings.items()}
        mark = max(fit, key=lambda mark: fit[mark])
        place = np.flatnonzero(~marked)[np.flatnonzero(~np.isfinite(readings[mark]))[0]]
        raise Refusal(f"line {line_of(place)}: found {cells[place]!r}, expected a number with decimal mark {mark}")
    first, *others = fitting.values()
    for other in others:
        if np.any(differs := other != first):
            word = body.iloc[np.flatnonzero(differs)[0]]
            raise Refusal(f"found {word!r}, with decimal mark or one of thousands, expected --decimal . or , (or ., for both)")
    values = np.full(len(cells), np.nan)
    values[~marked] = first
    return values


def _with_mark(body: pd.Series[str], mark: str) -> Floats:
    """The numbers of cells with a decimal mark (`.,`: both); NaN: it is none, or too large."""
    if mark != ".,":
        other = "," if mark == "." else "."
        is_grouped = body.str.fullmatch(rf"[+-]?[1-9]\d{{0,2}}(?:[{other}]\d{{3}})+(?:[{mark}]\d*)?(?:e.*)?")
        body = body.where(~is_grouped, body.str.replace(other, "", regex=False))
        body = body.where(~body.str.contains(other, regex=False), "?")
    body = body.str.replace(",", ".", regex=False)
    numbers = pd.to_numeric(body.where(body.str.fullmatch(PLAIN), "nan"), errors="coerce").to_numpy(float)
    return np.where(np.isinf(numbers), np.nan, numbers)


def _read_names(table: Table, width: int, separator: str) -> None:
    """Names and units of the columns, from the last two lines above them. Refusal: two units of one column."""
    columns = table.values.shape[1]
    below: list[str] = []
    for line in reversed(table.header[-2:]):
        glued = re.sub(r"\s+(?=[\[({<])", "", line)
        splits = [split(line if mark.strip(" ") else glued, mark) for mark in (separator, "\t", ";", ",", " ")]
        cells = next((cells[:columns] for cells in splits if len(cells) in (columns, width)), None)
        if cells is None or re.search("[:=]", line) or (columns == 1 and re.search(r"\S\s", glued)):
            break
        words = [cell.strip("[](){}<> ") for cell in cells]
        if not below and any(map(unit_word, words)) and all(unit_word(word) or word in ("", "-", "1", "#") for word in words):
            below = words
            continue
        table.names = cells
        break
    stated = [split_unit(name)[1] for name in table.names]
    for name, above, unit in zip(table.names, stated, below, strict=False):
        if unit_word(above) and unit_word(unit) and unit_word(above) != unit_word(unit):
            raise Refusal(f"found the unit {unit!r} below the name {name!r}, expected the same of both")
    table.units = [unit or above for above, unit in itertools.zip_longest(stated, below, fillvalue="")]


def length_of(text: str, unit: str, what: str) -> float:
    """Metres in `2um`, or in `2` with the `unit` beside it."""
    found = re.fullmatch(rf"({PLAIN})\s*(.*)", text.strip().replace(",", "."))
    word = unit_word(found[2] or unit) if found else ""
    if not found or not word or not 0 < float(found[1]) < np.inf:
        raise Refusal(f"{what}: found {f'{text} {unit}'.strip()!r}, expected a length > 0 with its unit, as in 2um")
    return float(found[1]) * METRES[word]


def metres(stated: str, wanted: str, what: str) -> float:
    """Metres in the unit that the file and --unit say together. Refusal: neither says one, or they contradict each other."""
    in_file, in_option = unit_word(stated), unit_word(wanted)
    if in_file and in_option and in_file != in_option:
        raise Refusal(f"found {what} in {stated}, but --unit says {wanted}, expected the same of both")
    if not in_file and not in_option:
        found = f"the unit {stated!r}" if stated else "no unit"
        raise Refusal(f"found {found} of the {what}, expected --unit X,Z, those of positions and heights, as in mm,um")
    return METRES[in_file or in_option]


def columns_of(table: Table, wanted: str) -> list[int]:
    """The columns that --columns names: z, or x, z, or x, y, z."""
    bare = [split_unit(name)[0].strip() for name in table.names]
    chosen = []
    for word in split(wanted, ","):
        number = [int(word) - 1] if word.isdecimal() and 0 < int(word) <= table.values.shape[1] else []
        hits = [[i for i, name in enumerate(names) if name == word] for names in (table.names, bare)]
        found = number or hits[0] or hits[1]
        if len(found) != 1:
            raise Refusal(f"--columns: found {word!r}, expected one of the columns {table.listing()}")
        chosen += found
    if not 1 <= len(chosen) <= 3 or len(set(chosen)) < len(chosen):
        raise Refusal(f"--columns: found {wanted!r}, expected z, or x,z, or x,y,z")
    return chosen


def columns_by_name(table: Table) -> list[int]:
    """The columns of x, z or of x, y, z that the names show without doubt; of two columns without such names both; else none."""
    bare = [split_unit(name)[0].strip().lower() for name in table.names]
    x, y, z = ([i for i, name in enumerate(bare) if pattern.fullmatch(name)] for pattern in ROLES.values())
    if len(x) == len(z) == 1 and len(y) <= 1:
        return x + y + z
    if table.values.shape[1] == 2 and len(x) <= 1 and len(z) <= 1 and not y:
        return [x[0], 1 - x[0]] if x else [1 - z[0], z[0]] if z else [0, 1]
    return []


def has_known_names(table: Table, roles: str = "xyz") -> bool:
    """Whether a name is that of positions or heights."""
    return any(ROLES[role].fullmatch(split_unit(name)[0].strip().lower()) for role in roles for name in table.names)


def spacings_in_header(table: Table, is_matrix: bool) -> list[float]:
    """Spacings [m] in x and y that the lines above the numbers say; empty: they say none."""
    lines = [re.sub(r'[",;\t ]+', " ", line).strip() for line in table.header]
    stated = [length_of(found[1], found[2], line) for line in lines if (found := SPACING.fullmatch(line))]
    sizes = [[length_of(found[1], found[2], line) for line in lines if (found := size.fullmatch(line))] for size in SIZES]
    if is_matrix and len(sizes[0]) == len(sizes[1]) == 1:
        stated += [size[0] / points for size, points in zip(sizes, table.values.shape[::-1], strict=True)]
    if len(stated) > 2:
        raise Refusal(f"found {len(stated)} spacings above the numbers, expected one, or those in x and y")
    return stated * (2 if len(stated) == 1 else 1)


def unit_of_matrix(table: Table, columns: list[int]) -> str:
    """The unit of heights that the names of their columns or the lines above say; empty: they say none."""
    lines = [re.sub(r'[",;\t ]+', " ", line).strip() for line in table.header]
    stated = [found[1] for line in lines if (found := UNIT_OF_HEIGHTS.fullmatch(line))]
    known = {unit_word(unit) or unit for unit in stated + [table.units[i] for i in columns if table.units] if unit}
    if len(known) > 1:
        raise Refusal(f"found the units {', '.join(sorted(known))} of heights, expected one")
    return "".join(known)

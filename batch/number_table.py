"""A table of `asperity --summary`: a line for each case with the numbers that its result would hold."""

from __future__ import annotations

import csv
import io
import sys
from dataclasses import dataclass, field
from pathlib import Path

from case_folder import NUMBER, split_header

# of a checkout; where the package is installed, this folder is in it
sys.path.append(str(Path(__file__).resolve().parent.parent / "python"))

from asperity.seal import checksum_of

# The first columns; others with a point in their name are values of the namelist.
OWN = ("case", "input", "program", "outcome", "reason")
PASSED = "limits_passed"
DIGITS = 16


class RowError(Exception):
    """What gives no row; the message is the reason."""


@dataclass
class Row:
    """What a result says."""

    outcome: str
    reason: str
    program: str
    values: dict[str, float | str] = field(default_factory=dict)


@dataclass
class TableRow(Row):
    """What a row of a table says; checksums of the namelist and, behind a dash, of all values used."""

    digits: str = ""

    def is_of(self, namelist: Path) -> bool:
        """Whether the row is that of a namelist. Raises OSError."""
        content = namelist.read_bytes()
        return self.digits[:DIGITS] == checksum_of(io.BytesIO(content), len(content))


def places_in(path: Path) -> dict[str, int]:
    """Name of each case -> where its last row begins; a line that a killed run has cut is no row. Raises RowError, OSError."""
    found: dict[str, int] = {}
    place = 0
    with path.open("rb") as file:
        for line in file:
            if not line.endswith(b"\n"):
                break
            if place == 0 and not line.startswith(",".join(OWN).encode()):
                raise RowError(f"{path}: is no table of asperity --summary")
            if place > 0:
                found[Path(_cells(line)[0]).stem] = place
            place += len(line)
    return found


def read_row(path: Path, place: int, units: dict[str, str]) -> TableRow:
    """The row that begins at a place; adds units of its columns. Raises RowError, OSError."""
    with path.open("rb") as file:
        head = _cells(file.readline())
        file.seek(place)
        cells = _cells(file.readline())
    if len(cells) != len(head):
        raise RowError(f"{path}: found a row of {len(cells)} cells, expected {len(head)}")
    own = dict(zip(head[: len(OWN)], cells, strict=False))
    row = TableRow(own["outcome"], own["reason"], own["program"], digits=own["input"])
    for name, text in zip(head[len(OWN) :], cells[len(OWN) :], strict=True):
        column, unit = split_header(name)
        if text and "." not in column:
            row.values[column] = float(text) if NUMBER.fullmatch(text) else text
            units.setdefault(column, unit)
    if any(name.startswith("validity_") for name in row.values):
        row.values[PASSED] = " ".join(sorted(str(row.values.get(PASSED, "")).split()))
    return row


def _cells(line: bytes) -> list[str]:
    try:
        return next(csv.reader([line.decode()]))
    except (csv.Error, ValueError, StopIteration) as error:
        raise RowError(f"found a line that is no row: {error}") from error

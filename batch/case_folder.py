"""The folder of a sweep: what lies where, the index of its cases, and locks on it.

FOLDER/index.csv          one line for each case: its name and its parameters; written last, so that a folder has all or none
FOLDER/sweep.toml         the sweep file
FOLDER/cases/NAME.nml     the cases, and their results NAME.h5
FOLDER/log/FIRST-LAST.csv how the cases of a run ended
FOLDER/gathered.h5, .csv  a row for each case
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import fcntl
import os
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from sweep_file import SweepError

ROOT = Path(__file__).resolve().parent.parent
INDEX = "index.csv"


@dataclass(frozen=True)
class CaseFolder:
    """The cases of a sweep: names and units of the parameters, and of each case the values as text."""

    path: Path
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    names: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    @property
    def cases(self) -> Path:
        """Where namelists and results are."""
        return self.path / "cases"

    @property
    def log(self) -> Path:
        """Where runs write how their cases ended."""
        return self.path / "log"


def read_folder(path: Path) -> CaseFolder:
    """Reads the index; raises SweepError if the folder is not a complete sweep."""
    try:
        with (path / INDEX).open(newline="", encoding="utf-8") as file:
            header, *rows = csv.reader(file)
    except FileNotFoundError as error:
        words = "is not there" if not path.exists() else f"has no {INDEX}: it is no sweep, or one that is not written to its end"
        raise SweepError(f"{path}: {words}; batch/sweep.py SWEEP.toml writes one") from error
    except (OSError, UnicodeDecodeError, csv.Error, ValueError) as error:
        raise SweepError(f"{path / INDEX}: cannot be read: {error}") from error
    if not header or header[0] != "case" or not rows or any(len(row) != len(header) for row in rows):
        raise SweepError(f"{path / INDEX}: is no index of cases")
    names, units = zip(*map(split_header, header[1:]), strict=True) if len(header) > 1 else ((), ())
    return CaseFolder(path, names, units, tuple(row[0] for row in rows), tuple(tuple(row[1:]) for row in rows))


def write_index(path: Path, parameters: list[tuple[str, str]], rows: Iterator[tuple[str, list[object]]]) -> None:
    """Writes the index: (name, unit) of the parameters, then name and values of each case."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["case", *(header(name, unit) for name, unit in parameters)])
        for name, values in rows:
            writer.writerow([name, *map(cell, values)])


def header(name: str, unit: str) -> str:
    """The head of a column: name, and unit in brackets."""
    return f"{name} [{unit}]" if unit else name


def split_header(text: str) -> tuple[str, str]:
    """Name and unit."""
    found = re.fullmatch(r"(.*?)(?: \[(.*)\])?", text)
    return found[1], found[2] or ""


def cell(value: object) -> str:
    """A value as text; numbers read back to the same bits."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list | tuple):
        return " ".join(map(cell, value))
    return repr(value) if isinstance(value, float) else str(value)


@contextlib.contextmanager
def locked(path: Path, words: str, shared: bool = False) -> Iterator[None]:
    """Holds a lock on a file or folder; raises SweepError with `words` if another process has it.

    File systems without locks are used without.
    """
    descriptor = os.open(path, os.O_RDONLY)
    try:
        try:
            fcntl.flock(descriptor, (fcntl.LOCK_SH if shared else fcntl.LOCK_EX) | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise SweepError(f"{path}: {words}") from error
        except OSError:
            pass
        yield
    finally:
        os.close(descriptor)


class BatchParser(argparse.ArgumentParser):
    """A parser that ends with status 1 on bad usage, as the program does."""

    def error(self, message: str) -> NoReturn:
        """Usage errors: one line and status 1."""
        self.exit(1, f"{self.prog}: {message} (see --help)\n")


def new_parser(program: str, description: str, epilog: str) -> BatchParser:
    """A parser with name, what the script does, and example and status below."""
    return BatchParser(prog=program, description=description, epilog=epilog, formatter_class=argparse.RawDescriptionHelpFormatter)


def count_of(text: str) -> int:
    """A number of processes or threads from the command line."""
    number = int(text)
    if number < 1:
        raise ValueError
    return number


def add_program(parser: argparse.ArgumentParser) -> None:
    """The option that names asperity."""
    default = Path(os.environ.get("ASPERITY", ROOT / "build" / "bin" / "asperity"))
    parser.add_argument("--program", type=Path, default=default, metavar="FILE", help="the program (build/bin/asperity)")


def check_program(program: Path) -> Path:
    """The program's path; raises SweepError if it is not there."""
    if not program.is_file():
        raise SweepError(f"{program}: the program is not there: run make build, or name it with --program")
    return program.resolve()


def complain(program: str, error: SweepError | OSError) -> int:
    """Prints an error, a line for each finding; returns its status."""
    if isinstance(error, SweepError):
        lines, status = str(error).splitlines(), 1
    else:
        lines, status = [f"{error.filename or 'output'}: {error.strerror or error}"], 3
    for line in lines:
        print(f"{program}: {line}", file=sys.stderr)
    return status

"""The folder of a sweep: what lies where, the index of its cases, and locks on it.

FOLDER/index.csv          one line for each case: its name and its parameters; written last, so that a folder has all or none
FOLDER/sweep.toml         the sweep file
FOLDER/cases/NAME.nml     the cases, and their results NAME.h5
FOLDER/log/FIRST-LAST.csv how the cases of a run ended
FOLDER/numbers.csv        rows of `asperity --summary`, where a run asked for numbers only
FOLDER/gathered.h5, .csv  a row for each case
FOLDER/replacement.part/  index, sweep file and changed cases of a new sweep, complete, on their way to the places above
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import fcntl
import io
import os
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from program_calls import INTERRUPTED
from sweep_file import NAME, SweepError, read_text

ROOT = Path(__file__).resolve().parent.parent
INDEX, SWEEP, NUMBERS, REPLACEMENT = "index.csv", "sweep.toml", "numbers.csv", "replacement.part"
# A number as Python and the program write it; not 1_0, which float() would take for one.
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?|[+-]?(nan|inf)", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True)
class CaseFolder:
    """The cases of a sweep: names and units of the parameters, and of each case the values."""

    path: Path
    parameters: tuple[str, ...]
    units: tuple[str, ...]
    names: tuple[str, ...]
    rows: tuple[tuple[float | str, ...], ...]

    @property
    def cases(self) -> Path:
        """Where namelists and results are."""
        return self.path / "cases"

    @property
    def log(self) -> Path:
        """Where runs write how their cases ended."""
        return self.path / "log"


@contextlib.contextmanager
def opened(path: Path) -> Iterator[CaseFolder]:
    """Reads a folder, whose cases batch/sweep.py does not replace until the end. Raises SweepError, OSError.

    A replacement that was interrupted is completed before.
    """
    complete(path)
    look_for_index(path)
    words = "its cases are being written"
    with locked(path, words, shared=True):
        if (path / REPLACEMENT / INDEX).exists():
            raise SweepError(f"{path}: {words}")
        yield read_folder(path)


def look_for_index(path: Path) -> None:
    """Raises SweepError if the folder has no index."""
    if (path / INDEX).exists():
        return
    words = f"has no {INDEX}: it is no sweep, or one that is not written to its end; batch/sweep.py SWEEP.toml writes one"
    if not path.exists():
        words = "is not there; batch/sweep.py SWEEP.toml writes one"
    elif is_sweep(path):
        words = f"has no {INDEX}, since --replace was interrupted: batch/sweep.py SWEEP.toml --replace writes it, results stay"
    raise SweepError(f"{path}: {words}")


def is_sweep(path: Path) -> bool:
    """Whether batch/sweep.py has written the folder; earlier versions left one without index when --replace was interrupted."""
    return (path / INDEX).is_file() or ((path / SWEEP).is_file() and (path / "cases").is_dir())


def read_folder(path: Path) -> CaseFolder:
    """Reads the index; raises SweepError if the folder is not a complete sweep."""
    look_for_index(path)
    text = read_text(path / INDEX)
    try:
        try:
            header, *rows = csv.reader(io.StringIO(text), quoting=csv.QUOTE_NONNUMERIC)
        except ValueError:  # text without quotes: of an earlier version, or of another program
            header, *rows = csv.reader(io.StringIO(text))
            rows = [[row[0], *(float(text) if NUMBER.fullmatch(text) else text for text in row[1:])] for row in rows]
        names, units = zip(*map(split_header, header), strict=True)
        cases = [row[0] for row in rows if re.fullmatch(r"case_\d+", row[0])]
    except (csv.Error, ValueError, TypeError, IndexError) as error:
        raise SweepError(f"{path / INDEX}: is no index of cases: {error}") from error
    is_whole = cases and len(set(cases)) == len(rows) and all(len(row) == len(names) for row in rows)
    if not is_whole or names[0] != "case" or len(set(names)) < len(names) or not all(map(NAME.fullmatch, names)):
        raise SweepError(f"{path / INDEX}: is no index of cases")
    return CaseFolder(path, names[1:], units[1:], tuple(cases), tuple(tuple(row[1:]) for row in rows))


def complete(path: Path) -> None:
    """Completes a replacement that was interrupted after the whole of it was written. Raises SweepError, OSError."""
    new = path / REPLACEMENT
    if new.is_dir():
        with locked(path, "its cases are being written or run"):
            if (new / INDEX).is_file():
                take_over(path)
            remove_empty(new)


def take_over(path: Path) -> None:
    """Moves what lies in the replacement to its place, the index last; may be ended at any step, and called again."""
    new = path / REPLACEMENT
    names = set(read_folder(new).names)
    (path / "cases").mkdir(exist_ok=True)
    for case in sorted((new / "cases").glob("case_*.nml")):
        case.replace(path / "cases" / case.name)
    for name in names_before(path) - names:
        (path / "cases" / f"{name}.nml").unlink(missing_ok=True)
    if (new / SWEEP).exists():
        (new / SWEEP).replace(path / SWEEP)
    (new / INDEX).replace(path / INDEX)
    remove_empty(new)


def names_before(path: Path) -> set[str]:
    """The cases of the index as it is; none if it cannot be read."""
    try:
        return set(read_folder(path).names)
    except SweepError:
        return set()


def remove_empty(new: Path) -> None:
    """Removes the folders of a replacement that has been taken over; what else lies in them stays."""
    for folder in (new / "cases", new):
        with contextlib.suppress(OSError):
            folder.rmdir()


def write_index(path: Path, parameters: list[tuple[str, str]], rows: Iterator[tuple[str, list[object]]]) -> None:
    """Writes the index: (name, unit) of the parameters, then name and values of each case; text in quotes, numbers without."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n", quoting=csv.QUOTE_NONNUMERIC)
        writer.writerow(["case", *(header(name, unit) for name, unit in parameters)])
        for name, values in rows:
            writer.writerow([name, *map(cell, values)])


def header(name: str, unit: str) -> str:
    """The head of a column: name, and unit in brackets."""
    return f"{name} [{unit}]" if unit else name


def split_header(text: str) -> tuple[str, str]:
    """Name and unit."""
    found = re.fullmatch(r"(?s)(.*?)(?: \[(.*)\])?", text)
    return found[1], found[2] or ""


def cell(value: object) -> float | str:
    """A value as number or text; numbers read back to the same bits."""
    if isinstance(value, bool):
        return str(value).lower()
    return " ".join(str(cell(part)) for part in value) if isinstance(value, list) else value


@contextlib.contextmanager
def locked(path: Path, words: str, shared: bool = False) -> Iterator[None]:
    """Holds a lock on a file or folder; raises SweepError with `words` if another process has it.

    File systems without locks are used without.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)  # to open a pipe may take for ever
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
    """A parser with name, what the script does, and example and status below; names of files that are no text can be printed."""
    with contextlib.suppress(AttributeError):  # of a stream that somebody has put in place
        sys.stdout.reconfigure(errors="backslashreplace")
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


def status_of(program: str, work: Callable[[], int]) -> int:
    """Does the work of a script and returns its exit status; errors are printed, a line for each finding."""
    try:
        return work()
    except SweepError as error:
        lines, status = str(error).splitlines(), 1
    except OSError as error:
        lines, status = [f"{error.filename2 or error.filename or 'output'}: {error.strerror or error}"], 3
    except KeyboardInterrupt:
        lines, status = ["interrupted; the same command continues"], INTERRUPTED
    for line in lines:
        print(f"{program}: {line}", file=sys.stderr)
    return status

#!/usr/bin/env python3
"""Gathers the results of a sweep in one table, HDF5 and CSV: a row for each case, also where there is no result."""

from __future__ import annotations

import csv
import multiprocessing
import os
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from case_folder import NUMBERS, SWEEP, CaseFolder, count_of, header, new_parser, opened, status_of
from number_table import Row, RowError, places_in
from program_calls import CONVERGED, FAILED, NOT_CONVERGED
from result_row import RowReader
from sweep_file import SweepError, read_text

PROGRAM = "gather.py"
EPILOG = """example:
  gather.py film_over_speed

writes FOLDER/gathered.h5 with every number of every result, and FOLDER/gathered.csv with what was varied, what became of
each case and its quantities (--all: as in gathered.h5)

status: 0 written; 1 wrong folder or usage; 3 cannot write; 4 interrupted"""
# Rows that are read at once; with more than one process each holds one such block, and as many wait to be written.
BLOCK = 500
# Fewer cases than this are read by one process: to start another takes as long as to read that many.
FEW = 1000
DONE, UNCONVERGED, OUTSIDE, FAILURE, NOT_RUN = "done", "not converged", "outside the model: mixed", "failed", "not run"
STATUSES = (DONE, UNCONVERGED, OUTSIDE, FAILURE, NOT_RUN)
TEXT = h5py.string_dtype()
# Beginnings and parts of columns that gathered.csv has only on request: program, scales, iterations; quantities in other forms.
DETAILS, FORMS = ("program", "report_", "scaling_", "validity_"), ("_extrapolated", "_moes")
MEANINGS = {"status": ", ".join(STATUSES), "reason": "why it is not done", "program": "version and commit"}


@dataclass
class Block:
    """Status, reason, program and values of some cases, and what is known of their columns."""

    rows: list[tuple[str, str, str, dict[str, float | str]]]
    units: dict[str, str]
    meanings: dict[str, str]


class Table:
    """A gathered file being written: columns appear when the first row has them.

    A column of numbers in which a row has a word becomes one of text, the last of all.
    """

    def __init__(self, file: h5py.File, names: tuple[str, ...]) -> None:
        """One row for each of `names`, the coordinate `case`."""
        self.file, self.size = file, len(names)
        case = file.create_dataset("case", data=np.array(names, dtype=object), dtype=TEXT)
        case.make_scale("case")
        case.attrs["long_name"] = "name of the case"

    def write(self, start: int, rows: list[dict[str, float | str]], units: dict[str, str], meanings: dict[str, str]) -> None:
        """Rows from number `start` on."""
        stop = start + len(rows)
        for name in dict.fromkeys(name for row in rows for name in row):
            values = [row.get(name) for row in rows]
            is_text = any(isinstance(value, str) for value in values)
            if name not in self.file:
                self._create(name, is_text, units.get(name, ""), meanings.get(name, ""))
            elif is_text and not h5py.check_string_dtype(self.file[name].dtype):
                self._make_text(name, start)
            column = self.file[name]
            if h5py.check_string_dtype(column.dtype):
                column[start:stop] = np.array([text_of(value) for value in values], dtype=object)
            else:
                column[start:stop] = np.array([np.nan if value is None else value for value in values])

    def _make_text(self, name: str, stop: int) -> None:
        """A column of numbers as text, of which the rows before `stop` are written."""
        numbers = self.file[name]
        del self.file[name]
        self._create(name, True, numbers.attrs.get("units", ""), numbers.attrs["long_name"])
        for start in range(0, stop, BLOCK):
            part = slice(start, min(start + BLOCK, stop))
            self.file[name][part] = np.array([text_of(value) for value in numbers[part].tolist()], dtype=object)

    def _create(self, name: str, is_text: bool, unit: str, meaning: str) -> None:
        options = {"shape": (self.size,), "chunks": (min(self.size, BLOCK),)}
        if is_text:
            column = self.file.create_dataset(name, dtype=TEXT, **options)
        else:
            column = self.file.create_dataset(name, dtype=float, fillvalue=np.nan, **options)
        column.dims[0].attach_scale(self.file["case"])
        column.attrs["long_name"] = meaning
        if unit:
            column.attrs["units"] = unit


def text_of(value: float | str | None) -> str:
    """A value in a column of text; what is not known is empty."""
    if isinstance(value, str):
        return value.replace("\0", "\ufffd")  # which HDF5 would take for its end
    return "" if value is None or np.isnan(value) else repr(value)


def gather(folder: CaseFolder, jobs: int, is_whole: bool) -> Counter:
    """Writes both files under temporary names and renames them; returns the number of cases of each status."""
    if own := {name for name in folder.parameters if name in MEANINGS}:
        words = f"found the parameter {', '.join(sorted(own))}, which the table has itself; give it another name in the sweep"
        raise SweepError(f"{folder.path}: {words}, and write that with batch/sweep.py --replace: results stay")
    path = folder.path / "gathered.h5"
    part = path.with_suffix(".h5.part")
    try:
        with h5py.File(part, "w", track_order=True) as file:
            count = write_table(folder, file, jobs)
            write_csv(file, path.with_suffix(".csv.part"), is_whole)
    except RuntimeError as error:  # what h5py raises when a full disk meets a close
        raise OSError(None, str(error), part) from error
    part.replace(path)
    path.with_suffix(".csv.part").replace(path.with_suffix(".csv"))
    return count


def write_table(folder: CaseFolder, file: h5py.File, jobs: int) -> Counter:
    """All rows."""
    table = Table(file, folder.names)
    parameters = {name: column_of(folder, i) for i, name in enumerate(folder.parameters)}
    own = {"status", "reason", "program", *folder.parameters}
    units = dict(zip(folder.parameters, folder.units, strict=True))
    meanings = MEANINGS | dict.fromkeys(folder.parameters, "parameter of the sweep")
    count, programs = Counter(), Counter()
    start = 0
    for block in blocks_of(folder, jobs):
        rows = []
        for i, (status, reason, program, values) in enumerate(block.rows, start):
            found = {f"summary_{name}" if name.removesuffix("_error") in own else name: value for name, value in values.items()}
            row = {name: column[i] for name, column in parameters.items()}
            rows.append(row | {"status": status, "reason": reason, "program": program} | found)
            count[status] += 1
            programs[program] += 1
        table.write(start, rows, block.units | units, block.meanings | meanings)
        start += len(rows)
    name = os.path.realpath(folder.path).rpartition("/")[2].encode("utf-8", "backslashreplace").decode()
    file.attrs["title"] = f"{name}: {len(folder.names)} cases"
    file.attrs["programs"] = "; ".join(sorted(program for program in programs if program))
    for status in STATUSES:
        file.attrs[status.partition(":")[0].replace(" ", "_")] = count[status]
    if (folder.path / SWEEP).exists():
        file.attrs["sweep"] = read_text(folder.path / SWEEP)
    return count


def blocks_of(folder: CaseFolder, jobs: int) -> Iterator[Block]:
    """The rows of all cases in their order, read by `jobs` processes; the same whatever their number."""
    failures = read_log(folder)
    try:
        places = places_in(folder.path / NUMBERS)
    except FileNotFoundError:
        places = {}
    except RowError as error:
        raise SweepError(str(error)) from error
    tasks = []
    for start in range(0, len(folder.names), BLOCK):
        names = folder.names[start : start + BLOCK]
        found = ({name: known[name] for name in names if name in known} for known in (failures, places))
        tasks.append((folder.cases, names, *found))
    if jobs == 1:
        yield from (read_block(*task) for task in tasks)
        return
    waiting: list[Future[Block]] = []
    try:
        with ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), leave_signals) as pool:
            for task in tasks:
                waiting.append(pool.submit(read_block, *task))
                if len(waiting) > jobs:
                    yield waiting.pop(0).result()
            while waiting:
                yield waiting.pop(0).result()
    except BrokenProcessPool as error:
        raise OSError(None, "a process that reads results was ended, by somebody or for lack of memory", folder.cases) from error


def leave_signals() -> None:
    """Ctrl-C, which reaches every process of a terminal, is the business of the first one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def read_block(cases: Path, names: tuple[str, ...], failures: dict[str, str], places: dict[str, int]) -> Block:
    """What became of some cases, of which some failed and some have their row at a place of the table of numbers."""
    reader = RowReader()
    rows = [outcome_of(cases / name, reader, failures, places) for name in names]
    return Block(rows, reader.units, reader.meanings)


def column_of(folder: CaseFolder, i: int) -> list[float] | list[str]:
    """The values of parameter `i`: numbers if all of them are."""
    values = [row[i] for row in folder.rows]
    return list(map(text_of, values)) if any(isinstance(value, str) for value in values) else values


def row_of(path: Path, reader: RowReader, places: dict[str, int]) -> Row:
    """The row of a case by its path without ending: of its result, or else of the table of numbers. Raises RowError."""
    namelist = path.with_suffix(".nml")
    try:
        return reader.read(path.with_suffix(".h5"), namelist)
    except RowError:
        if path.name not in places:
            raise
    return reader.read_table(path.parent.parent / NUMBERS, places[path.name], namelist)


def outcome_of(
    path: Path, reader: RowReader, failures: dict[str, str], places: dict[str, int]
) -> tuple[str, str, str, dict[str, float | str]]:
    """Status, reason, program and values of a case."""
    case = path.name
    try:
        row = row_of(path, reader, places)
    except RowError as error:
        if case in failures:
            return FAILURE, failures[case], "", {}
        is_missing = str(error) == "no result"
        return (NOT_RUN if is_missing else FAILURE), str(error), "", {}
    status, reason = (DONE, "") if row.outcome == "converged" else (row.outcome, row.reason)
    return status, reason, row.program, row.values


def read_log(folder: CaseFolder) -> dict[str, str]:
    """Cases whose last run failed, and why; lines that a killed run has cut are left out."""
    found: dict[str, tuple[int, str]] = {}
    for path in sorted(filter(Path.is_file, folder.log.glob("*.csv")), key=lambda path: path.stat().st_mtime):
        with path.open(newline="", encoding="utf-8", errors="replace") as file:
            for line in csv.reader(file):
                if len(line) == 3 and line[1] in {str(CONVERGED), str(NOT_CONVERGED), str(FAILED)}:
                    found[line[0]] = int(line[1]), line[2]
    return {case: reason for case, (status, reason) in found.items() if status == FAILED}


def write_csv(file: h5py.File, path: Path, is_whole: bool) -> None:
    """Parameters, outcome and quantities as CSV, units in the head; every column if `is_whole`."""
    columns = [name for name in file if name != "case"]
    if not is_whole:
        head = columns.index("reason") + 1
        chosen = [name for name in columns[head:] if not (name.startswith(DETAILS) or any(form in name for form in FORMS))]
        columns = columns[:head] + [name for name in chosen if any(any(values_of(file[name], start)) for start in starts_of(file))]
    with path.open("w", newline="", encoding="utf-8") as target:
        writer = csv.writer(target, lineterminator="\n")
        writer.writerow(["case", *(header(name, file[name].attrs.get("units", "")) for name in columns)])
        for start in starts_of(file):
            block = [values_of(file[name], start) for name in ("case", *columns)]
            writer.writerows(zip(*block, strict=True))


def starts_of(file: h5py.File) -> range:
    """First rows of the blocks."""
    return range(0, file["case"].size, BLOCK)


def values_of(column: h5py.Dataset, start: int) -> list[str]:
    """A block of a column as text; what is not known is empty."""
    if h5py.check_string_dtype(column.dtype):
        return list(column.asstr()[start : start + BLOCK])
    return ["" if np.isnan(value) else repr(float(value)) for value in column[start : start + BLOCK]]


def gather_folder(path: Path, jobs: int | None = None, is_whole: bool = False) -> int:
    """Gathers a folder and says what became of its cases; returns the exit status. Raises SweepError, OSError.

    `jobs`: processes that read results; not given: one for each core, for few cases one. `is_whole`: all columns in the CSV.
    """
    with opened(path) as folder:
        if jobs is None:
            jobs = 1 if len(folder.names) < FEW else len(os.sched_getaffinity(0))
        count = gather(folder, jobs, is_whole)
    words = ", ".join(f"{count[status]} {status}" for status in STATUSES if count[status])
    print(f"{path / 'gathered.h5'}: {words}")
    return 0


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = new_parser(PROGRAM, __doc__, EPILOG)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder written by batch/sweep.py")
    words = "processes that read results (default: one for each core, for few cases one)"
    parser.add_argument("--jobs", type=count_of, metavar="K", help=words)
    parser.add_argument("--all", action="store_true", help="every column in gathered.csv")
    options = parser.parse_args(arguments)
    return status_of(PROGRAM, lambda: gather_folder(options.folder, options.jobs, options.all))


if __name__ == "__main__":
    sys.exit(main())

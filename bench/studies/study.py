"""Common parts of the studies: cases from the namelists of input/, runs side by side, tables, command line."""

from __future__ import annotations

import argparse
import copy
import csv
import os
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NoReturn

import f90nml
import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "postproc"))

import figure_style as style  # noqa: E402

__all__ = ["style"]

Case = dict[str, dict[str, object]]


class StudyError(Exception):
    """A study that cannot go on; the message is one line, or what the program said."""


def base_case(name: str) -> Case:
    """The namelist input/NAME.nml as groups of keys.

    Lubricated ones without error bars, since the studies halve grids and steps themselves, and in the space scheme of the thesis;
    dry ones without adequacy.
    """
    case = f90nml.read(ROOT / "input" / f"{name}.nml").todict()
    if case["case"]["problem"] == "ehl_line":
        case["accuracy"] = {"error_bars": False}
        case["solver"] = {**case.get("solver", {}), "space_scheme": "upwind2"}
    else:
        case["output"] = {**case.get("output", {}), "adequacy": False}
    return case


def changed(case: Case, **groups: dict[str, object] | None) -> Case:
    """A copy of a case with other values in the groups; a group that is None is left out."""
    result = copy.deepcopy(case)
    for name, keys in groups.items():
        if keys is None:
            result.pop(name, None)
        else:
            result[name] = {**result.get(name, {}), **keys}
    return result


def exchanged(case: Case) -> Case:
    """The same contact seen from the other side: both bodies change places with their speeds and surfaces."""
    other = {"1": "2", "2": "1"}

    def partner(name: str) -> str:
        return name[:-1] + other[name[-1]] if name[-2:] in ("_1", "_2") else name

    return {partner(group): {partner(key): value for key, value in keys.items()} for group, keys in case.items()}


class Runner:
    """Runs cases of the program side by side and reads what is wanted of each result."""

    def __init__(self, folder: Path, jobs: int, program: Path) -> None:
        """Results go to `folder`; at most `jobs` runs at once."""
        self.folder, self.jobs, self.program = folder, jobs, program
        self.steps, self.runs, self.seconds, self.cpu_seconds = 0, 0, 0.0, 0.0
        folder.mkdir(parents=True, exist_ok=True)

    def run(
        self, cases: dict[str, Case], read: Callable[[str, Path], object], keep: frozenset[str] = frozenset()
    ) -> dict[str, object]:
        """What `read(name, file)` finds in the result of each case; files whose name is not in `keep` are deleted."""
        start, used = time.monotonic(), resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        with ThreadPoolExecutor(self.jobs) as pool:
            waiting = {name: pool.submit(self._run_one, name, case, read, name in keep) for name, case in cases.items()}
            ended = {name: future.result() for name, future in waiting.items()}
        self.seconds += time.monotonic() - start
        self.cpu_seconds += resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - used
        self.runs += len(cases)
        self.steps += sum(steps for _, steps in ended.values())
        return {name: found for name, (found, _) in ended.items()}

    @property
    def effort(self) -> str:
        """How much was computed, and the time it took: of the clock, and of the processors for the program alone."""
        return f"{self.runs} runs, {self.steps} steps, {self.seconds:.1f} s (program: {self.cpu_seconds:.1f} s of processor time)"

    def _run_one(self, name: str, case: Case, read: Callable[[str, Path], object], keep: bool) -> tuple[object, int]:
        namelist, result = self.folder / f"{name}.nml", self.folder / f"{name}.h5"
        f90nml.Namelist(case).write(namelist, force=True)
        command = [str(self.program), str(namelist), "--output", str(self.folder), "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise StudyError(f"{namelist}: exit status {done.returncode}\n{done.stderr.strip()}")
        found = read(name, result)
        with h5py.File(result) as file:
            steps = int(file["report/steps"][()]) if "steps" in file["report"] else 0
        if not keep:
            result.unlink()
            namelist.unlink()
        return found, steps


class Table:
    """Rows with named columns, written as CSV and HDF5 and printed."""

    def __init__(self, **columns: str) -> None:
        """Name of each column, and its unit and meaning."""
        self.columns = columns
        self.rows: list[dict[str, object]] = []

    def add(self, **values: object) -> None:
        """One more row; a column without value is empty."""
        unknown = values.keys() - self.columns.keys()
        if unknown:
            raise KeyError(f"no column {sorted(unknown)}")
        self.rows.append(values)

    def column(self, name: str) -> np.ndarray:
        """The values of one column; numbers as real numbers."""
        values = [row.get(name) for row in self.rows]
        if any(isinstance(value, str) for value in values):
            return np.array([value or "" for value in values], dtype=object)
        return np.array([np.nan if value is None else value for value in values], dtype=float)

    def write(self, stem: Path, title: str) -> None:
        """STEM.csv and STEM.h5."""
        with stem.with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(self.columns)
            for row in self.rows:
                writer.writerow([self._text(row.get(name)) for name in self.columns])
        with h5py.File(stem.with_suffix(".h5"), "w") as file:
            file.attrs["title"] = title
            for name, meaning in self.columns.items():
                values = self.column(name)
                kind = h5py.string_dtype() if values.dtype == object else float
                file.create_dataset(name, data=values, dtype=kind).attrs["long_name"] = meaning

    @staticmethod
    def _text(value: object) -> str:
        if value is None or (isinstance(value, float) and np.isnan(value)):
            return ""
        return f"{value:.9g}" if isinstance(value, float) else str(value)

    def show(self, title: str, **formats: str) -> None:
        """Prints the columns named in `formats` (all without), each in its format."""
        formats = formats or dict.fromkeys(self.columns, "")
        cells = [list(formats)] + [[self._cell(row.get(name), kind) for name, kind in formats.items()] for row in self.rows]
        widths = [max(len(line[i]) for line in cells) for i in range(len(formats))]
        print(f"\n{title}")
        for line in cells:
            print("  " + "  ".join(f"{cell:>{width}}" for cell, width in zip(line, widths, strict=True)))

    @staticmethod
    def _cell(value: object, kind: str) -> str:
        if value is None or (isinstance(value, float) and np.isnan(value)):
            return "-"
        return f"{value:{kind}}" if not isinstance(value, str) else value


class Claims:
    """Statements of the text, each with what was measured and whether it holds."""

    def __init__(self) -> None:
        """Nothing checked yet."""
        self.table = Table(claim="what the text says", found="what was measured", verdict="agrees, disagrees or partly")

    def check(self, claim: str, holds: bool | str, found: str) -> None:
        """One statement; `holds` is true, false, or a verdict in words."""
        verdict = holds if isinstance(holds, str) else ("agrees" if holds else "DISAGREES")
        self.table.add(claim=claim, found=found, verdict=verdict)

    def show(self) -> None:
        """Prints all statements."""
        print("\nStatements of the text")
        for row in self.table.rows:
            print(f"  [{row['verdict']}] {row['claim']}\n      {row['found']}")


def new_parser(program: str, description: str, folder: str) -> argparse.ArgumentParser:
    """Parser with the options that all studies share."""
    parser = argparse.ArgumentParser(prog=program, description=description)
    parser.add_argument("--output", type=Path, default=Path(folder), metavar="DIR", help=f"folder of the results ({folder})")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs side by side (all cores)")
    default = Path(os.environ.get("ASPERITY", ROOT / "build" / "bin" / "asperity"))
    parser.add_argument("--program", type=Path, default=default, metavar="FILE", help="the program (build/bin/asperity)")
    parser.add_argument("--quick", action="store_true", help="a few cases only, as in the tests")
    return parser


def finish(parser: argparse.ArgumentParser, study: Callable[[argparse.Namespace], None]) -> NoReturn:
    """Runs a study; errors end with status 1 and a message."""
    options = parser.parse_args()
    try:
        study(options)
    except StudyError as error:
        sys.exit(f"{parser.prog}: {error}")
    sys.exit(0)


def save(figure: object, folder: Path, name: str) -> None:
    """Saves a figure as PNG and PDF and names it."""
    for target in style.save_figure(figure, [folder / f"{name}.png", folder / f"{name}.pdf"]):
        print(target)

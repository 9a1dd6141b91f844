"""What all benches share: the command line, tables, runs of the program, times of many runs in one process, rows of targets."""

from __future__ import annotations

import argparse
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import InitVar, dataclass, field
from pathlib import Path

import h5py
import numpy as np
import pandas as pd

ROOT = Path(__file__).resolve().parent.parent
ASPERITY = ROOT / "build" / "bin" / "asperity"
ENVIRONMENT = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
# Longest run [s of processor time].
PATIENCE = 3600
# Starts a command. The memory of a child counts from that of the process that starts it: this one is small.
MEASURE = """
import resource, subprocess, sys, time
limit, *command = sys.argv[1:]
resource.setrlimit(resource.RLIMIT_CPU, (int(limit), int(limit)))
start = time.perf_counter()
done = subprocess.run(command, stdout=subprocess.DEVNULL)
wall, used = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
print(done.returncode, wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)
"""
sys.path.append(str(ROOT / "postproc"))


def new_parser(description: str, quick: str, folder: str, seed: int | None = None, processes: int = 0) -> argparse.ArgumentParser:
    """A command line with --quick (what it does), --output (a folder, which is made), and --seed and --processes where given."""

    def made(name: str) -> Path:
        (ROOT / name).mkdir(parents=True, exist_ok=True)
        return ROOT / name

    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--output", type=made, default=folder, metavar="DIR", help=f"folder (default: {folder})")
    if seed is not None:
        parser.add_argument("--seed", type=int, default=seed, help="another sample, for fitting")
    if processes:
        parser.add_argument("--processes", type=int, default=processes, metavar="N", help=f"runs side by side ({processes})")
    return parser


def save(path: Path, rows: list | pd.DataFrame) -> None:
    """A table, or items of one dataclass, as CSV, in one stroke: a command that is ended leaves a whole file."""
    part = path.with_suffix(".part")
    pd.DataFrame(rows).to_csv(part, index=False)
    part.replace(path)


def conclude(path: Path, text: str) -> None:
    """Writes a text to a file and to standard output."""
    path.write_text(text, encoding="utf-8")
    print(text, end="")


def side_by_side(work: Callable, items: list, processes: int) -> Iterator:
    """What `work` makes of each item, in their order, with a count on standard error; those under way end with the command."""
    with ThreadPoolExecutor(processes) as pool:
        try:
            for i, found in enumerate(pool.map(work, items)):
                print(f"\r{i + 1} of {len(items)}   ", end="", file=sys.stderr, flush=True)
                yield found
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
    print(file=sys.stderr)


@dataclass
class Run:
    """A process: exit status, wall and processor time [s], peak memory [MB], why it has no result; what is read of each result."""

    status: int
    wall: float
    processor: float
    memory: float
    words: str
    results: list = field(default_factory=list)

    @property
    def found(self) -> object:
        """What is read of the first result; None: there is none."""
        return self.results[0]


def measured(
    command: list[object], folder: Path | None = None, environment: dict[str, str] = ENVIRONMENT, limit: int = PATIENCE
) -> Run:
    """Runs a command, which is ended after `limit` seconds of processor time."""
    started = [sys.executable, "-ISc", MEASURE, str(limit), *map(str, command)]
    done = subprocess.run(started, cwd=folder, env=environment, check=True, capture_output=True, text=True)
    status, *numbers = done.stdout.split()
    words = f"stopped from outside after {limit} s" if status == "-9" else done.stderr.strip()
    return Run(int(status), *map(float, numbers), words)


def run_program(
    texts: str | list[str],
    read: Callable[[h5py.File], object] | None = None,
    files: dict[str, str | bytes] | None = None,
    options: tuple[object, ...] = (),
    **limits: object,
) -> Run:
    """Runs namelists in one process, with these files beside them."""
    texts = [texts] if isinstance(texts, str) else texts
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in ({f"{i}.nml": text for i, text in enumerate(texts)} | (files or {})).items():
            (folder / file).write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        run = measured([ASPERITY, "--quiet", *(f"{i}.nml" for i in range(len(texts))), *options], folder, **limits)
        for path in (folder / f"{i}.h5" for i in range(len(texts))):
            if path.exists() and read:
                with h5py.File(path) as file:
                    run.results.append(read(file))
            else:
                run.results.append(None)
        return run


class Answer(dict):
    """Single values of a result by name, and the wall times of its runs [s]: a row each, a column a phase."""

    times: pd.DataFrame

    @property
    def converged(self) -> bool:
        """Whether the program says so."""
        return self["converged"] == 1


def answer(file: h5py.File) -> Answer:
    """From summary, report, last load, domain, time and head of a result."""
    groups = (file[name] for name in ("summary", "report") if name in file)
    found = {name: data[()] for group in groups for name, data in group.items() if data.shape == ()}
    found |= {name: data[-1] for name, data in file.get("sweep", {}).items() if data.ndim == 1}
    inputs = file["input/effective"]
    found |= {**inputs["domain"].attrs, **(inputs["time"].attrs if "time" in inputs else {}), **file.attrs}
    plain = {name: value.item() if isinstance(value, np.generic) else value for name, value in found.items()}
    return Answer({name: value.decode() if isinstance(value, bytes) else value for name, value in plain.items()})


def solve(text: str, runs: int = 0, seconds: float = 1e9, read: Callable[[h5py.File], Answer] = answer, **limits: object) -> Answer:
    """The result of a namelist, and the times of so many further runs of it."""
    run = run_program(text, read, **limits)
    if run.found is None:
        return Answer(converged=0, method="-", reason=run.words if run.status < 0 else f"refused: {run.words}")
    if runs and run.found.converged:
        run.found.times = times_of(text, runs, seconds)
    return run.found


def phases(file: h5py.File) -> pd.Series:
    """Wall time of each phase of a result [s]."""
    seconds = file["report/phase_seconds"]
    return pd.Series(seconds[()], seconds.attrs["phases"].decode().split(", "))


def times_of(text: str, runs: int, seconds: float = 1e9) -> pd.DataFrame:
    """Phases of so many runs of a namelist in one process, a row each; fewer where they would take longer than `seconds`."""
    once = run_program(text, phases).found.sum()
    return pd.DataFrame(run_program([text] * max(1, min(runs, int(seconds / once))), phases).results)


@dataclass
class Row:
    """One line of a table: least and median of what was measured [s, or `unit`]; a ratio `times` is to be large, all else small."""

    work: str
    asked: float | None
    values: InitVar[float | list[float]]
    unit: str = "s"
    note: str = ""
    residual: float = math.nan
    least: float = field(init=False)
    median: float = field(init=False)
    verdict: str = field(init=False)

    def __post_init__(self, values: float | list[float]) -> None:
        """Whether the median, or only the least value, is within what was asked."""
        self.least, self.median = float(np.min(values)), float(np.median(values))
        sign = -1 if self.unit == "times" else 1
        good, is_near = (self.asked is not None and sign * value <= sign * self.asked for value in (self.median, self.least))
        self.verdict = "" if self.asked is None else "met" if good else "met (min.)" if is_near else "MISSED"


def show_rows(title: str, rows: list[Row]) -> None:
    """Prints a table, and the notes below it."""
    table = pd.DataFrame(rows).dropna(axis="columns", how="all").drop(columns="note", errors="ignore")
    notes = [f"  {row.work.strip()}: {row.note}" for row in rows if row.note]
    print("\n".join([f"\n{title}", table.to_string(index=False, na_rep="", float_format="{:.3g}".format), *notes]), flush=True)


def show(seconds: float) -> str:
    """Seconds or milliseconds with three digits."""
    return f"{seconds:.3g} s" if seconds >= 1 else f"{seconds * 1e3:.3g} ms"

"""What all benches share: the command line, tables as CSV, runs of the program, and lists of jobs through build/bin/asperity-bench.

The latter solves many contacts in one process, a job each, and answers with a line of values for each.
"""

from __future__ import annotations

import argparse
import csv
import os
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
ASPERITY = ROOT / "build" / "bin" / "asperity"
PROGRAM = ROOT / "build" / "bin" / "asperity-bench"
ENVIRONMENT = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
PHASES = ("setup", "steady", "transient", "all")
WORDS = {"name", "method", "grid", "reason"}
# Longest run [s of wall time, generous: other work may share the machine].
PATIENCE = 3600
sys.path.append(str(ROOT / "postproc"))


def new_parser(description: str, quick: str, folder: str, seed: int | None = None, processes: int = 0) -> argparse.ArgumentParser:
    """A command line with --quick (what it does), --output (the default folder), and --seed and --processes where given."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--output", default=folder, metavar="DIR", help=f"folder (default: {folder})")
    if seed is not None:
        parser.add_argument("--seed", type=int, default=seed, help="another sample, for fitting")
    if processes:
        parser.add_argument("--processes", type=int, default=processes, metavar="N", help=f"runs side by side ({processes})")
    return parser


def output_folder(options: argparse.Namespace) -> Path:
    """The folder of --output, made if there is none."""
    folder = ROOT / options.output
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def write_csv(path: Path, head: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """A table as CSV, in one stroke: a command that is ended leaves a whole file."""
    part = path.with_suffix(".part")
    with part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)
    part.replace(path)


def read_csv(path: Path) -> list[dict[str, str]]:
    """The rows of a table; of one that is not there, none."""
    if not path.exists():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def save(path: Path, items: list) -> None:
    """Items of one dataclass as CSV; none: no file."""
    if items:
        write_csv(path, vars(items[0]), (vars(item).values() for item in items))


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


def run_program(
    text: str, read: Callable[[h5py.File], object], files: dict[str, str | bytes] | None = None, *options: str
) -> tuple[int, str, object]:
    """Runs a namelist with these files beside it: exit status, standard error, what is read of the result (None: there is none)."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, content in ({"case.nml": text} | (files or {})).items():
            (folder / file).write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        command = [ASPERITY, "--quiet", "case.nml", *options]
        done = subprocess.run(command, cwd=folder, env=ENVIRONMENT, check=False, capture_output=True, text=True, timeout=PATIENCE)
        if not (folder / "case.h5").exists():
            return done.returncode, done.stderr.strip(), None
        with h5py.File(folder / "case.h5") as file:
            return done.returncode, done.stderr.strip(), read(file)


@dataclass
class Usage:
    """What a process took: wall and processor time [s], peak memory [MB], exit status."""

    wall: float
    processor: float
    memory: float
    status: int


def measured(command: list[object], folder: Path | None = None, environment: dict[str, str] | None = None) -> Usage:
    """Runs a command. The memory of a child counts from that of the process that starts it: a small one does."""
    script = (
        "import resource, subprocess, sys, time; start = time.perf_counter()\n"
        "done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL); wall = time.perf_counter() - start\n"
        "used = resource.getrusage(resource.RUSAGE_CHILDREN)\n"
        "print(wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, done.returncode)"
    )
    started = [sys.executable, "-c", script, *map(str, command)]
    done = subprocess.run(started, cwd=folder, env=environment or ENVIRONMENT, check=True, capture_output=True, text=True)
    wall, processor, memory, status = done.stdout.split()
    return Usage(float(wall), float(processor), float(memory), int(status))


@dataclass
class Job:
    """A namelist and what the bench program does with it, in the order of its `#job` line."""

    name: str
    namelist: str
    # Runs at most; seconds after which none follows, and after which one is stopped.
    runs: int = 1
    seconds: float = 1e9
    limit: float = 1e9
    # Its fields are the reference, are compared with it; it passes the coarser grids of error bars.
    reference: int = 0
    compare: int = 0
    bars: int = 0

    def text(self) -> str:
        """Its part of the file of jobs."""
        words = self.runs, self.seconds, self.limit, self.reference, self.compare, self.bars, self.name
        return f"#job {' '.join(map(str, words))}\n{self.namelist}"


class Answer(dict):
    """The values of a job by name."""

    @property
    def converged(self) -> bool:
        """Whether the solver says so."""
        return self.get("converged") == 1

    @property
    def least_seconds(self) -> float:
        """The least wall time of several runs, or their mean processor time where other work made that smaller."""
        return min(self["all_least"], self["processor"])


def job(name: str, namelist: str, **words: float) -> Job:
    """A job, its name without blanks."""
    return Job(name.replace(" ", "_"), namelist, **words)


def failed(name: str, reason: str) -> Answer:
    """The answer to a job that has none."""
    return Answer({"name": name, "method": "-", "converged": 0, "reason": reason})


def run(jobs: list[Job], patience: float = 600.0) -> dict[str, Answer]:
    """Solves the jobs in order; one that gives no answer for `patience` seconds is killed and the rest goes on without it."""
    answers: dict[str, Answer] = {}
    left = list(jobs)
    while left:
        done, reason = _run_process(left, patience)
        answers |= done
        left = left[len(done) :]
        if left:
            answers[left[0].name] = failed(left[0].name, reason)
            left = left[1:]
    return answers


def run_parallel(jobs: list[Job], processes: int = 2, patience: float = 60.0) -> dict[str, Answer]:
    """The same with jobs that do not depend on each other, over several processes."""
    with ThreadPoolExecutor(processes) as pool:
        parts = pool.map(lambda i: run(jobs[i::processes], patience), range(processes))
        return {name: answer for part in parts for name, answer in part.items()}


def _run_process(jobs: list[Job], patience: float) -> tuple[dict[str, Answer], str]:
    """The answers of one process, and why there is none to the next job."""
    answers: dict[str, Answer] = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "jobs"
        path.write_text("".join(each.text() for each in jobs), encoding="utf-8")
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        with subprocess.Popen([PROGRAM, path], env=ENVIRONMENT, **pipes) as process:

            def lines() -> Iterator[str]:
                while True:
                    watch = threading.Timer(patience, process.kill)
                    watch.start()
                    line = process.stdout.readline()
                    watch.cancel()
                    if not line.endswith("\n"):
                        return
                    yield line

            rows = csv.reader(lines(), skipinitialspace=True)
            names, times = next(rows, []), {}
            for words in rows:
                if words[0] == "refused":
                    answers[words[1]] = failed(words[1], f"refused: {words[2]}")
                elif words[0] == "times":
                    times.setdefault(words[1], []).append([float(word) for word in words[2:]])
                else:
                    pairs = zip(names, words, strict=True)
                    answer = {name: value if name in WORDS else float(value) for name, value in pairs}
                    answer["runs"] = len(times[words[0]])
                    for phase, values in zip(PHASES, zip(*times[words[0]], strict=True), strict=True):
                        quantiles = zip(("least", "median", "high"), np.quantile(values, (0, 0.5, 0.9)), strict=True)
                        answer |= {f"{phase}_{word}": float(value) for word, value in quantiles}
                    answers[words[0]] = Answer(answer)
            errors = process.stderr.read()
    if process.returncode == 1:
        sys.exit(f"{PROGRAM.name}: {errors.strip()}")
    killed = process.returncode == -signal.SIGKILL
    return answers, "no answer within the time limit, killed" if killed else f"the program crashed, status {process.returncode}"

"""Runs lists of jobs through build/bin/asperity-bench, which solves them in one process, and reads its answers."""

from __future__ import annotations

import argparse
import csv
import os
import selectors
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build" / "bin" / "asperity-bench"
ENVIRONMENT = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
WORDS = {"name", "method", "inlet", "reason"}
HANG = "no answer within the time limit, killed"
CRASH = "the program crashed"


def new_parser(description: str, quick: str, folder: str) -> argparse.ArgumentParser:
    """A command line with --quick (what it does) and --output (the default folder)."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--output", default=folder, metavar="DIR", help=f"folder (default: {folder})")
    return parser


def output_folder(options: argparse.Namespace) -> Path:
    """The folder of --output, made if there is none."""
    folder = ROOT / options.output
    folder.mkdir(parents=True, exist_ok=True)
    return folder


@dataclass
class Job:
    """A namelist and what the bench program does with it (words of its `#job` line)."""

    name: str
    namelist: str
    words: dict[str, float] = field(default_factory=dict)

    def text(self) -> str:
        """Its part of the file of jobs."""
        pairs = " ".join(f"{key}={value}" for key, value in self.words.items())
        return f"#job name={self.name} {pairs}\n{self.namelist}"


class Answer(dict):
    """The values of a job by name; `history` holds residual and load error of each cycle."""

    def __init__(self, values: dict[str, object]) -> None:
        """From values by name."""
        super().__init__(values)
        self.history: list[tuple[float, float]] = []

    @property
    def converged(self) -> bool:
        """Whether the solver says so."""
        return self.get("converged") == 1


def job(name: str, namelist: str, **words: float) -> Job:
    """A job; words: runs, seconds, limit, reference, compare, history, products."""
    return Job(name, namelist, words)


def run(jobs: list[Job], patience: float = 600.0) -> dict[str, Answer]:
    """Solves the jobs in order; one that gives no answer for `patience` seconds is killed and the rest goes on without it."""
    answers: dict[str, Answer] = {}
    left = list(jobs)
    while left:
        finished, reason = _run_process(left, answers, patience)
        left = left[finished:]
        if left:
            answers[left[0].name] = Answer({"name": left[0].name, "method": "-", "converged": 0, "reason": reason})
            left = left[1:]
    return answers


def run_parallel(jobs: list[Job], processes: int = 2, patience: float = 60.0) -> dict[str, Answer]:
    """The same with jobs that do not depend on each other, over several processes."""
    parts = [jobs[i::processes] for i in range(processes)]
    answers: dict[str, Answer] = {}
    with ThreadPoolExecutor(processes) as pool:
        for part in pool.map(lambda part: run(part, patience), parts):
            answers |= part
    return answers


def _run_process(jobs: list[Job], answers: dict[str, Answer], patience: float) -> tuple[int, str]:
    """One process; returns how many jobs it has answered, and why the next one has none."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "jobs"
        path.write_text("".join(each.text() for each in jobs), encoding="utf-8")
        with subprocess.Popen(
            [PROGRAM, path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=ENVIRONMENT, bufsize=0
        ) as process:
            lines = _lines(process, patience)
            finished = _read(lines, answers)
            is_cut = process.poll() is None
            if is_cut:
                process.kill()
            errors = process.stderr.read().decode()
    if process.returncode == 1 and not is_cut:
        sys.exit(f"{PROGRAM.name}: {errors.strip()}")
    return finished, HANG if is_cut else f"{CRASH}, status {process.returncode}"


def _lines(process: subprocess.Popen, patience: float):
    """Complete lines of the output as they come; ends when nothing came for `patience` seconds."""
    rest = b""
    with selectors.DefaultSelector() as selector:
        selector.register(process.stdout, selectors.EVENT_READ)
        last = time.monotonic()
        while time.monotonic() - last < patience:
            if not selector.select(1.0):
                continue
            piece = os.read(process.stdout.fileno(), 65536)
            if not piece:
                process.wait()
                return
            last = time.monotonic()
            *lines, rest = (rest + piece).split(b"\n")
            yield from (line.decode() for line in lines)


def _read(lines: object, answers: dict[str, Answer]) -> int:
    """Takes the answers from the lines; returns their number."""
    names: list[str] = []
    count = 0
    for words in csv.reader(lines, skipinitialspace=True):
        if not names:
            names = words
        elif words[0] == "history":
            answers[words[1]].history.append((float(words[3]), float(words[4])))
        elif words[0] == "refused":
            answers[words[1]] = Answer({"name": words[1], "method": "-", "converged": 0, "reason": f"refused: {words[2]}"})
            count += 1
        else:
            pairs = zip(names, words, strict=True)
            values = {name: value if name in WORDS else float(value) for name, value in pairs}
            answers[values["name"]] = Answer(values)
            count += 1
    return count

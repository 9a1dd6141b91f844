#!/usr/bin/env python3
"""Runs the cases of a sweep side by side, many in one process; finished cases are skipped."""

from __future__ import annotations

import argparse
import csv
import os
import queue
import re
import signal
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TextIO

from case_folder import NUMBERS, CaseFolder, add_program, check_program, count_of, locked, new_parser, opened, status_of
from program_calls import CONVERGED, FAILED, INTERRUPTED, NOT_CONVERGED, Program
from sweep_file import SweepError

PROGRAM = "run.py"
EPILOG = """example:
  run.py film_over_speed --jobs 4
  run.py film_map --numbers

The same command continues after Ctrl-C, a crash or a power cut: complete results of the same case and program are kept.

status: 0 all converged; 1 wrong folder or usage, nothing has run; 2 some not converged or outside the model; 3 some
failed, or a file cannot be written; 4 interrupted"""
# More cases are run for their numbers only, unless they are asked for their fields.
MANY = 1000
# Cases that share a process, at most; each process checks all of its cases first.
CHUNK = 50
# The same where each reads a table of all cases, too.
TABLE_CHUNK = 500
# Seconds between two progress lines on a terminal, and in a log.
TERMINAL_SECONDS, LOG_SECONDS = 0.2, 30.0
# Reasons that the closing table shows.
SHOWN = 10
WORDS = {CONVERGED: "done", NOT_CONVERGED: "not converged", FAILED: "failed", INTERRUPTED: "not run"}
# Such a case has the status of one that did not converge, and a reason that begins so.
OUTSIDE = "outside the model"
BAD = (WORDS[NOT_CONVERGED], OUTSIDE, WORDS[FAILED])


def chunks(cases: list[str], jobs: int, most: int = CHUNK) -> Iterator[list[str]]:
    """The cases in pieces that get smaller, so that all processes end at about the same time."""
    start = 0
    while start < len(cases):
        size = max(1, min(most, (len(cases) - start) // (4 * jobs)))
        yield cases[start : start + size]
        start += size


class Progress:
    """What has become of the cases so far: one line on a terminal, a line now and then in a log."""

    def __init__(self, folder: CaseFolder, cases: list[str], stream: TextIO = sys.stderr) -> None:
        """Nothing has run yet."""
        self.folder, self.cases, self.stream = folder, cases, stream
        self.ended: dict[str, tuple[int, str]] = {}
        self.start = time.time()
        self.earlier = 0
        self.shown = self.start if not stream.isatty() else 0.0

    def add(self, case: str, status: int, reason: str) -> None:
        """One case has ended."""
        self.ended[case] = status, reason
        result = self.folder.cases / f"{case}.h5"
        if status in (CONVERGED, NOT_CONVERGED) and result.exists() and result.stat().st_mtime < self.start:
            self.earlier += 1

    def count(self) -> Counter:
        """Cases by what became of them."""
        return Counter(words_of(*ended) for ended in self.ended.values())

    @property
    def line(self) -> str:
        """Cases ended, what went wrong, remaining time."""
        count = self.count()
        words = f"{len(self.ended)} of {len(self.cases)} cases"
        words += "".join(f", {count[bad]} {bad}" for bad in BAD if count[bad])
        fresh, left = len(self.ended) - self.earlier, len(self.cases) - len(self.ended)
        if fresh and left:
            words += f", {duration((time.time() - self.start) / fresh * left)} left"
        return words

    def show(self, is_last: bool = False) -> None:
        """Shows the line if it is time."""
        pause = TERMINAL_SECONDS if self.stream.isatty() else LOG_SECONDS
        if not is_last and time.time() - self.shown < pause:
            return
        self.shown = time.time()
        if self.stream.isatty():
            print(f"\r{self.line:<78}", end="\n" if is_last else "", file=self.stream, flush=True)
        else:
            print(self.line, file=self.stream, flush=True)

    def table(self) -> str:
        """How many cases ended in which way, and why."""
        count = self.count()
        count[WORDS[INTERRUPTED]] = len(self.cases) - len(self.ended)
        lines = []
        for words in (WORDS[CONVERGED], *BAD, WORDS[INTERRUPTED]):
            if not count[words] and words != WORDS[CONVERGED]:
                continue
            lines.append(f"  {words:<17}{count[words]:4d}")
            if words in BAD:
                lines += self._reasons(words)
        if self.earlier:
            lines.append(f"  {self.earlier} of these were complete before")
        return "\n".join(lines)

    def _reasons(self, words: str) -> Iterator[str]:
        found = sorted((case, ended[1]) for case, ended in self.ended.items() if words_of(*ended) == words)
        for case, reason in found[:SHOWN]:
            yield f"    {case}  {reason}"
        if len(found) > SHOWN:
            yield f"    and {len(found) - SHOWN} more: {self.folder.path / 'gathered.csv'} will have them (batch/gather.py)"

    @property
    def status(self) -> int:
        """Exit status of the run."""
        if len(self.ended) < len(self.cases):
            return INTERRUPTED
        return max((status for status, _ in self.ended.values()), default=CONVERGED)


def words_of(status: int, reason: str) -> str:
    """What became of a case."""
    return OUTSIDE if reason.startswith(OUTSIDE) else WORDS[status]


def duration(seconds: float) -> str:
    """A time in the unit that suits it."""
    for size, unit in ((86400, "d"), (3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds:.0f} s"


def wants_numbers(folder: CaseFolder, options: argparse.Namespace) -> bool:
    """Whether the cases get rows of a table in place of results; says so where nobody has."""
    if options.numbers is None and len(folder.names) > MANY and not any(folder.cases.glob("*.h5")):
        print(f"more than {MANY} cases: numbers only, rows of {folder.path / NUMBERS} (--fields: results with fields)")
        return True
    return bool(options.numbers)


def run_cases(folder: CaseFolder, cases: list[str], program: Program, jobs: int, log: Path) -> Progress:
    """Runs `cases` in `jobs` processes at a time; each end becomes a line of `log`."""
    progress = Progress(folder, cases)
    news: queue.Queue = queue.Queue()

    def work(chunk: list[str]) -> None:
        program.run(chunk, lambda *outcome: news.put(outcome))

    with log.open("a", newline="", encoding="utf-8") as file, ThreadPoolExecutor(jobs) as pool:
        writer = csv.writer(file, lineterminator="\n")
        waiting = [pool.submit(work, chunk) for chunk in chunks(cases, jobs, TABLE_CHUNK if program.table else CHUNK)]
        try:
            while not (all(future.done() for future in waiting) and news.empty()):
                try:
                    outcome = news.get(timeout=TERMINAL_SECONDS)
                except queue.Empty:
                    file.flush()
                else:
                    progress.add(*outcome)
                    writer.writerow(outcome)
                progress.show()
        except BaseException:
            program.stop()
            raise
        for future in waiting:
            future.result()
    progress.show(is_last=True)
    return progress


def chosen(folder: CaseFolder, words: str | None) -> tuple[list[str], str]:
    """The cases `FIRST-LAST` (numbers; a LAST beyond the end is the end), and the range in words. Raises SweepError."""
    count = len(folder.names)
    first, last = 1, count
    if words is not None:
        found = re.fullmatch(r"(\d+)-(\d+)", words)
        if not found or not 1 <= int(found[1]) <= min(int(found[2]), count):
            raise SweepError(f"found --cases {words}, expected FIRST-LAST between 1 and {count}")
        first, last = int(found[1]), min(int(found[2]), count)
    return list(folder.names[first - 1 : last]), f"{first:04d}-{last:04d}"


def listen(program: Program) -> dict[int, object]:
    """From now on signals that end a run are passed on to the program; returns the earlier handlers."""

    def stop(_number: int, _frame: object) -> None:
        # not here: the thread may hold the lock that `stop` needs
        threading.Thread(target=program.stop).start()

    return {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)}


def run_folder(path: Path, options: argparse.Namespace) -> int:
    """Runs what is to be run in a folder and prints the table; returns the exit status. Raises SweepError, OSError."""
    with opened(path) as folder:
        cases, words = chosen(folder, getattr(options, "cases", None))
        program = Program(check_program(options.program), folder.cases, options.threads)
        folder.log.mkdir(exist_ok=True)
        log = folder.log / f"{words}.csv"
        log.touch()
        if not log.is_file():  # to open a pipe may take for ever
            raise SweepError(f"{log}: found a folder, pipe or device, expected a file")
        with locked(log, "these cases are being run already"):
            earlier = listen(program)
            try:
                if wants_numbers(folder, options):
                    program.table = (path / NUMBERS).resolve()
                progress = run_cases(folder, cases, program, options.jobs, log)
            finally:
                for number, handler in earlier.items():
                    signal.signal(number, handler)
    print(progress.table())
    if progress.status == INTERRUPTED:
        print(f"{PROGRAM}: interrupted; the same command continues", file=sys.stderr)
    return progress.status


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options of a run, which batch/all.py has too."""
    cores = len(os.sched_getaffinity(0))
    parser.add_argument("--jobs", type=count_of, default=cores, metavar="K", help="processes side by side (default: all cores)")
    words = f"numbers only, rows of FOLDER/{NUMBERS}, without results and checkpoints (default for more than {MANY} cases)"
    parser.add_argument("--numbers", action="store_true", default=None, help=words)
    parser.add_argument("--fields", action="store_false", dest="numbers", help="results with fields (default for fewer)")
    parser.add_argument(
        "--threads",
        type=count_of,
        default=1,
        metavar="N",
        help="threads of each, for large dry areas (default 1; jobs times threads: cores)",
    )


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = new_parser(PROGRAM, __doc__, EPILOG)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="folder written by batch/sweep.py")
    parser.add_argument("--cases", metavar="FIRST-LAST", help="only these cases, by their numbers (default: all)")
    add_options(parser)
    add_program(parser)
    options = parser.parse_args(arguments)
    return status_of(PROGRAM, lambda: run_folder(options.folder, options))


if __name__ == "__main__":
    sys.exit(main())

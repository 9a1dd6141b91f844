"""Calls of the program with many cases each: what it says of every case, what it leaves out, signals passed on."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

CONVERGED, NOT_CONVERGED, INTERRUPTED = 0, 2, 4
# Status of a case that the program did not bring to an end: bad input, a crash, no room for its result.
FAILED = 3
# Longest reason that is kept, in characters.
LONGEST = 500

Report = Callable[[str, int, str], None]


@dataclass
class Program:
    """Calls the program in the folder of the cases; one object serves all threads."""

    path: Path
    folder: Path
    threads: int = 1
    # Table of numbers in place of results.
    table: Path | None = None
    is_stopping: bool = False
    _running: set[subprocess.Popen] = field(default_factory=set)
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def run(self, cases: list[str], report: Report) -> None:
        """Runs cases one after another in as few processes as possible; `report(case, status, reason)` follows each.

        A case that ends its process is the reason of that end, and the others go on in a new one. Bad input, which the program
        refuses before it runs anything, is left out of the next call.
        """
        while cases and not self.is_stopping:
            status, seen, errors = self._call(cases, report)
            rest = [case for case in cases if case not in seen]
            if self.is_stopping or status == INTERRUPTED:
                self.is_stopping = True
            elif rest and status == 1 and not seen:
                bad = bad_input(errors, rest)
                for case, reason in bad.items():
                    report(case, FAILED, reason)
                rest = [case for case in rest if case not in bad]
            elif rest:
                report(rest.pop(0), FAILED, end_of(status, errors))
            cases = rest

    def stop(self) -> None:
        """Starts no further process and ends those that run: a case leaves its checkpoint, a second call ends it at once.

        SIGINT, since a batch system that ends a job sends SIGTERM to every process of it, and a second one of a kind counts.
        """
        with self._lock:
            self.is_stopping = True
            for process in self._running:
                process.send_signal(signal.SIGINT)

    def _call(self, cases: list[str], report: Report) -> tuple[int, set[str], str]:
        """One process: its status, the cases of which it has told, and what it wrote on standard error."""
        target = ["--summary", str(self.table)] if self.table else ["--output", "."]
        command = [str(self.path), *(f"{case}.nml" for case in cases), *target, "--resume", "--quiet", "--outcomes"]
        command += ["--threads", str(self.threads)]
        environment = {**os.environ, "OMP_NUM_THREADS": str(self.threads), "OPENBLAS_NUM_THREADS": "1"}
        seen: set[str] = set()
        with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as errors:
            with self._lock:
                if self.is_stopping:
                    return INTERRUPTED, seen, ""
                process = subprocess.Popen(
                    command,
                    cwd=self.folder,
                    env=environment,
                    stdout=subprocess.PIPE,
                    stderr=errors,
                    text=True,
                    errors="replace",
                    process_group=0,  # Ctrl-C reaches the program once, by `stop`
                )
                self._running.add(process)
            with process:
                for case, status, reason in outcomes(process.stdout):
                    if status != INTERRUPTED:
                        seen.add(case)
                        report(case, status, reason)
            with self._lock:
                self._running.discard(process)
            errors.seek(0)
            return process.returncode, seen, errors.read()


def outcomes(lines: Iterator[str]) -> Iterator[tuple[str, int, str]]:
    """Case, status and reason of each line of `--outcomes`; failures inside and unwritten results are both FAILED."""
    for line in lines:
        status, file, reason = (*line.rstrip("\n").split("\t"), "", "")[:3]
        if not line.endswith("\n") or not status.isdigit():
            continue
        number = int(status)
        yield Path(file).stem, number if number in (CONVERGED, NOT_CONVERGED, INTERRUPTED) else FAILED, reason[:LONGEST]


def bad_input(errors: str, cases: list[str]) -> dict[str, str]:
    """The findings of each case that has some; where none can be told from the others, all have the whole text."""
    found: dict[str, list[str]] = {}
    for line in errors.splitlines():
        named = re.match(r"(?:asperity: )?(.+?)\.nml(?::\d+)?: ", line)
        if named and named[1] in cases:
            found.setdefault(named[1], []).append(line)
    if not found:
        return dict.fromkeys(cases, one_line(errors) or "the program ended with status 1")
    return {case: one_line("; ".join(lines)) for case, lines in found.items()}


def end_of(status: int, errors: str) -> str:
    """Why a process ended in the middle of its cases."""
    words = f"the program ended with status {status}"
    if status < 0:
        words = f"the program was ended by {signal.Signals(-status).name}"
        if status == -signal.SIGKILL:
            words += " (by somebody, or for lack of memory)"
    last = one_line(errors)
    return f"{words}: {last}" if last else words


def one_line(text: str) -> str:
    """Text without line ends, not too long."""
    return " ".join(text.split())[:LONGEST]

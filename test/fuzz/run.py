#!/usr/bin/env python3
"""Attacks with files and circumstances that the program did not make: damaged, hostile or merely odd ones.

    run.py [KIND ...] [--seed 1] [--cases N] [--only I] [--page]

Each kind of attack is a function of a module of this folder,

    @attack(title, cases)    what is attacked, and with what; how many cases the long form has
    def KIND(program, source, folder)    one case, drawn from `source` (random.Random), in an empty folder; what broke, else None

A case depends on its kind, seed and number alone, so `run.py KIND --seed S --only I` repeats one that broke; its folder is kept
then. What counts as broken: a crash, a hang, a trap or backtrace, a wrong number taken for a right one, NaN in a result that
says `converged`, a lost or half-written file. --page writes the table of docs/testing.md. The program is that of
the environment variable ASPERITY, else build/bin/asperity. The quick form is test_fuzz.py.
"""

import argparse
import importlib
import os
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PAGE = ROOT / "docs" / "testing.md"
BEGIN, END = "<!-- fuzz: written by make fuzz -->", "<!-- fuzz: end -->"
# Processor time that a run may take, and wall time on a busy machine [s].
PROCESSOR, PATIENCE = 30, 900
STATUSES = {0, 1, 2, 3, 4}
CRASH_WORDS = ("Backtrace for this error", "Program received signal", "Fortran runtime error", "AddressSanitizer", "runtime error:")


@dataclass
class Run:
    """What a run of the program left; `status` is None where it had to be killed."""

    status: int | None
    out: str
    err: str

    def trouble(self, *right: int) -> str | None:
        """A crash, hang, trap, backtrace or a status that is not right, in words."""
        said = self.err.strip()[-200:]
        if self.status is None or self.status not in (right or STATUSES):
            return f"hang: {said}" if self.status is None else f"status {self.status}: {said}"
        found = [word for word in CRASH_WORDS if word in self.err]
        return f"{found[0]}: {said}" if found else None


def call(program: Path, folder: Path, *arguments: str, env: dict[str, str] | None = None, limits: dict | None = None, **io) -> Run:
    """Runs the program in a folder under limits of processor time and wall time; `limits`: further ones by RLIMIT number."""

    def restrain() -> None:
        for number, value in ({resource.RLIMIT_CPU: PROCESSOR} | (limits or {})).items():
            resource.setrlimit(number, (value, value))

    command = [str(program), *map(str, arguments)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "stdin": subprocess.DEVNULL} | io
    with subprocess.Popen(command, cwd=folder, env=env or os.environ, preexec_fn=restrain, **pipes) as process:  # noqa: PLW1509  one thread
        try:
            out, err = process.communicate(timeout=PATIENCE)
            status = process.returncode
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            status = None
    return Run(status, *((stream or b"").decode("utf-8", "replace") for stream in (out, err)))


@dataclass
class Attack:
    """A kind of attack: its function, and how many cases its long and its quick form have."""

    title: str
    cases: int
    quick: int
    draw: Callable[[Path, random.Random, Path], str | None]


KINDS: dict[str, Attack] = {}


def attack(title: str, cases: int, quick: int = 5) -> Callable:
    """Makes a function a kind of attack, of its name."""

    def enter(function: Callable) -> Callable:
        KINDS[function.__name__] = Attack(title, cases, quick, function)
        return function

    return enter


def kinds() -> dict[str, Attack]:
    """All attacks of this folder by name. Its modules know this one as `run`, also where it is the script."""
    sys.path[:0] = [str(HERE.parent), str(HERE)]
    for path in HERE.glob("[!t]*.py"):
        importlib.import_module(path.stem)
    return dict(sorted(importlib.import_module("run").KINDS.items()))


def outcome(name: str, kind: Attack, program: Path, seed: int, number: int, keep: bool = False) -> str | None:
    """What broke in a case, and how to repeat it."""
    folder = Path(tempfile.mkdtemp(prefix=f"{name}_{number}_"))
    try:
        broken = kind.draw(program, random.Random(f"{name} {seed} {number}"), folder)
    finally:
        if keep:
            print(f"kept: {folder}")
        else:
            shutil.rmtree(folder, ignore_errors=True)
    return f"{name} --seed {seed} --only {number}: {broken}" if broken else None


def table(rows: list[tuple[str, int, int]], seed: int) -> str:
    lines = [f"Seed {seed}:", "", "| attacked | tried | broke |", "|---|---|---|"]
    return "\n".join(lines + [f"| {title} | {tried} | {broke} |" for title, tried, broke in rows]) + "\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="KIND", help="default: all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, help="of each kind, in place of its own number")
    parser.add_argument("--only", type=int, metavar="I", help="this case alone; its folder is kept")
    parser.add_argument("--page", action="store_true", help="write the table into docs/testing.md")
    options = parser.parse_args()
    program = Path(os.environ.get("ASPERITY", ROOT / "build" / "bin" / "asperity")).resolve()
    rows = []
    for name, kind in kinds().items():
        if options.names and name not in options.names:
            continue
        numbers = [options.only] if options.only is not None else range(options.cases or kind.cases)
        broken = []
        for number in numbers:
            found = outcome(name, kind, program, options.seed, number, keep=options.only is not None)
            if found:
                broken.append(found)
                print(found, flush=True)
        rows.append((kind.title, len(numbers), len(broken)))
        print(f"{name}: {len(numbers)} tried, {len(broken)} broke", flush=True)
    if options.page:
        page = PAGE.read_text(encoding="utf-8")
        text = f"{page.split(BEGIN)[0]}{BEGIN}\n{table(rows, options.seed)}{END}{page.split(END)[1]}"
        PAGE.write_text(text, encoding="utf-8")
    return 1 if any(broke for _, _, broke in rows) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Writes the cases of a sweep: a numbered namelist for each, and an index with their parameters; all are checked."""

from __future__ import annotations

import argparse
import errno
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterable
from itertools import islice
from pathlib import Path

import f90nml
from case_folder import (
    INDEX,
    REPLACEMENT,
    SWEEP,
    add_program,
    check_program,
    complete,
    is_sweep,
    locked,
    names_before,
    new_parser,
    status_of,
    take_over,
    write_index,
)
from case_plan import Groups, Plan, plan_sweep, units_of_keys
from sweep_file import SweepError, SweepFile, read_sweep_file

PROGRAM = "sweep.py"
EPILOG = """example:
  sweep.py input/sweeps/film_over_speed.toml

status: 0 written; 1 wrong sweep, base case or usage, nothing is written; 3 cannot write; 4 interrupted"""
# More cases than this need --yes.
MANY = 100_000
# Namelists in one call of the program.
CALL = 100
FINDING = re.compile(r"(?P<case>case_\d+)\.nml(?::\d+)?: (?P<words>(?:&(?P<group>\w+)(?: (?P<key>\w+))?: )?.*)")


def write_sweep(sweep: SweepFile, folder: Path, options: argparse.Namespace) -> int:
    """Writes the folder of a sweep, whole or not at all; returns the number of its cases. Raises SweepError."""
    program = check_program(options.program)
    plan = plan_sweep(sweep, folder)
    if plan.count > MANY and not options.yes:
        raise SweepError(f"{sweep.path}: found {plan.count} cases, expected at most {MANY} (or --yes: two files for each)")
    complete(folder)
    look_at(folder)
    target = Path(os.path.realpath(folder))
    part = target.with_name(target.name + ".part")
    part.mkdir(parents=True, exist_ok=True)
    with locked(part, "another process is writing this sweep"):
        look_at_part(part)
        try:
            write_cases(plan, part, program)
            write_description(plan, part, program)
            publish(part, folder, options.replace)
        finally:
            shutil.rmtree(part, ignore_errors=True)
    return plan.count


def look_at(folder: Path) -> None:
    """Raises SweepError if `folder` is neither new, nor empty, nor a sweep."""
    if folder.exists() and not is_sweep(folder) and not (folder.is_dir() and not any(folder.iterdir())):
        raise SweepError(f"{folder}: is there and no sweep with an {INDEX}; give another folder with --output, or remove it")


def look_at_part(part: Path) -> None:
    """Raises SweepError if something else lies in `part` than what an interrupted call leaves: it will be removed."""
    cases = {path.name for path in (part / "cases").glob("*") if not re.fullmatch(r"case_\d+\.nml", path.name)}
    if others := cases | {path.name for path in part.iterdir()} - {"cases", INDEX, SWEEP}:
        raise SweepError(f"{part}: found {min(others)}, expected an unused name: the sweep is written there before it is moved")


def write_cases(plan: Plan, part: Path, program: Path) -> None:
    """The namelists, each checked: one first, then many at a time."""
    shutil.rmtree(part / "cases", ignore_errors=True)
    (part / "cases").mkdir()
    cases, size = plan.cases(), 1
    while batch := list(islice(cases, size)):
        for name, _, groups in batch:
            write_namelist(part / "cases" / f"{name}.nml", groups)
        check(plan, [(name, values) for name, values, _ in batch], part / "cases", program)
        size = CALL


def write_namelist(path: Path, groups: Groups) -> None:
    """One case."""
    with path.open("w", encoding="utf-8", errors="surrogateescape") as file:  # names of files, which need not be text
        f90nml.Namelist(groups).write(file)


def check(plan: Plan, cases: list[tuple[str, list[object]]], folder: Path, program: Path) -> None:
    """Raises SweepError with what the program finds wrong, by the lines of the sweep file."""
    command = [program, "--check", *(f"{name}.nml" for name, _ in cases)]
    done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", errors="replace", check=False)
    if done.returncode != 0:
        raise SweepError("\n".join(findings(plan, dict(cases), done.stderr)))


def findings(plan: Plan, cases: dict[str, list[object]], text: str) -> Iterable[str]:
    """The program's findings: of each key the first, with its case and where the sweep sets it."""
    first: dict[tuple[str, str], str] = {}
    count: dict[tuple[str, str], int] = {}
    for line in text.splitlines():
        found = FINDING.match(line)
        if not found:
            yield f"{plan.sweep.path}: {line}"
            continue
        place = found["group"] or "", found["key"] or ""
        count[place] = count.get(place, 0) + 1
        values = ", ".join(f"{name} = {value}" for name, value in zip(plan.parameters, cases.get(found["case"], []), strict=False))
        first.setdefault(place, f"{plan.sweep.path}:{line_of(plan.sweep, *place)}: {found['words']} ({found['case']}: {values})")
    for place, words in first.items():
        yield words + (f"; {count[place] - 1} more like it" if count[place] > 1 else "")


def line_of(sweep: SweepFile, group: str, key: str) -> int:
    """The line of the sweep file that sets a key of the namelist; that of the base case if none does."""
    names = {"vary": [p.name for p in sweep.parameters], "formula": list(sweep.formulas), "set": list(sweep.constants)}
    for table, entries in names.items():
        for name in entries:
            if name.lower() == f"{group}.{key}".lower():
                return sweep.line_of(table, *name.split("."))
    return sweep.line_of("base")


def write_description(plan: Plan, part: Path, program: Path) -> None:
    """The index, and a copy of the sweep file."""
    units = units_of_keys(program, str(plan.base.get("case", {}).get("problem", "")))
    units |= {parameter.name: parameter.unit for parameter in plan.sweep.parameters if parameter.unit}
    columns = [(name, units.get(name.lower() if "." in name else name, "")) for name in plan.parameters]
    write_index(part / INDEX, columns, ((name, values) for name, values, _ in plan.cases()))
    (part / SWEEP).write_text(plan.sweep.text, encoding="utf-8")


def publish(part: Path, folder: Path, is_replacing: bool) -> None:
    """The complete `part` becomes `folder`, or the new state of it, by one renaming; what follows that can be done later, too.

    Raises SweepError, OSError.
    """
    if not is_sweep(folder):
        part.rename(os.path.realpath(folder))
        return
    names = {path.stem for path in (part / "cases").iterdir()}
    unchanged = {name for name in names if same(part / "cases" / f"{name}.nml", folder / "cases" / f"{name}.nml")}
    differing = names_before(folder) - names | names - unchanged
    if not differing:
        (part / SWEEP).replace(folder / SWEEP)
        (part / INDEX).replace(folder / INDEX)
        return
    if not is_replacing:
        words = f"holds another sweep ({len(names - unchanged) or len(differing)} cases differ); give another folder with --output,"
        words += " or --replace: results of unchanged cases stay, the others are computed again by batch/run.py"
        raise SweepError(f"{folder}: {words}")
    with locked(folder, "its cases are being run"):
        for name in unchanged:
            (part / "cases" / f"{name}.nml").unlink()
        look_for_obstacles(folder, [folder / INDEX, folder / SWEEP, *(folder / "cases" / f"{name}.nml" for name in differing)])
        part.rename(folder / REPLACEMENT)
        take_over(folder)


def look_for_obstacles(folder: Path, targets: list[Path]) -> None:
    """Raises OSError if one of the files could not be replaced, as far as can be told before."""
    for path in filter(Path.is_dir, targets):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    for path in (folder, folder / "cases"):
        if path.exists() and not os.access(path, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)
        if path.exists() and path.stat().st_dev != folder.stat().st_dev:
            raise OSError(errno.EXDEV, "is on another file system than its sweep", path)


def same(one: Path, other: Path) -> bool:
    """Whether both files are there with the same bytes."""
    return other.is_file() and one.read_bytes() == other.read_bytes()


def add_options(parser: argparse.ArgumentParser) -> None:
    """The options of a sweep, which batch/all.py has too."""
    parser.add_argument("sweep", type=Path, metavar="SWEEP.toml", help="base case, parameters and their values (docs/batch.md)")
    parser.add_argument(
        "--output", type=Path, metavar="FOLDER", help="folder of the cases (default: name of the sweep, in the current folder)"
    )
    parser.add_argument("--yes", action="store_true", help=f"write more than {MANY} cases")
    parser.add_argument("--replace", action="store_true", help="write a changed sweep into the folder of the old one")
    add_program(parser)


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = new_parser(PROGRAM, __doc__, EPILOG)
    add_options(parser)
    options = parser.parse_args(arguments)
    return status_of(PROGRAM, lambda: write(options))


def write(options: argparse.Namespace) -> int:
    """Writes the sweep of the command line and says so; returns the exit status. Raises SweepError, OSError."""
    folder = options.output or Path(options.sweep.stem)
    print(f"{folder}: {write_sweep(read_sweep_file(options.sweep), folder, options)} cases, checked")
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Are there inputs that end with a wrong number and a small error bar? Families of random cases, each beside its truth.

A family is one kind of input that has gone wrong before: a wave narrower than the grid, an outlet ahead of film rupture, a
passage that starts inside the contact. Each module bench/family_NAME.py lists its families in FAMILIES; a family draws its
members from a seed. A member is a namelist as a user writes it, and that of the truth: a finer grid, a longer domain, a smaller
step. The program runs both, and each quantity of the member's result is put into one of these classes:

    refused     exit status 1, or not converged with a reason: no number that looks like an answer
    noted       /report/note says that the numbers are not to be relied on
    not known   no error estimate; the attribute no_estimate says why
    judged      all others: is the truth within the estimate, and the estimate below ten times the true error?

The truth of a passage is FINER times as fine as the result that it judges, in space and in time, whatever grid the program has
chosen: with schemes of second order a sixteenth of the error is left. Its inlet is FARTHER times as far. A truth that no quantity
needs is not computed.

A family holds if the truth is within the estimate for at least 95 % of those judged, and the estimate below ten times the true
error for at least 80 %. A true error below FLOOR times the value counts as within ten times: no estimate need be so small.

The seed of `make accuracy` was drawn after the rules stood; --seed draws another sample, for fitting. Writes families.csv and
families.txt.
"""

from __future__ import annotations

import csv
import importlib
import math
import random
import subprocess
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np
from bench_program import ENVIRONMENT, ROOT, new_parser, output_folder

PROGRAM = ROOT / "build" / "bin" / "asperity"
# Drawn after the rules stood: nothing was fitted on it.
SEED = 662201
WITHIN, TIGHT = 0.95, 0.80
# Relative error that is as good as none.
FLOOR = 1e-6
# Longest run [s of wall time, generous: other work may share the machine].
PATIENCE = 3600
QUICK = 6
# Spacing and time step of a result over those of its truth.
FINER = 4
# Distance of the inlet of a truth over that of the result.
FARTHER = 2
# A note that takes nothing from the numbers where the truth ends at the same time.
TOLD = "a feature is still in the contact"
# A note on the input, which says nothing of the numbers.
UNUSUAL = "is unusual, typical is"
REFUSED, NOTED, UNKNOWN, JUDGED = "refused", "noted", "not known", "judged"


@dataclass(frozen=True)
class Resolution:
    """Spacing, time step and ends of the domain of a result, over the half-width and its time."""

    spacing: float
    step: float
    x_inlet: float
    x_outlet: float

    def ends(self, x_inlet: float, x_outlet: float) -> dict[str, float]:
        """Those of a truth: FARTHER, and not nearer than these."""
        return {"x_inlet": min(FARTHER * self.x_inlet, x_inlet), "x_outlet": max(self.x_outlet, x_outlet)}

    def intervals(self, length: float, fewest: int) -> int:
        """So many on a domain of this length that they are FINER: 4, 5, 6 or 7 times a power of two, `fewest` at least."""
        wanted = max(FINER * length / self.spacing, fewest)
        power = 2 ** math.floor(math.log2(wanted / 4))
        return power * math.ceil(wanted / power)

    def time_step(self, longest: float) -> float:
        """One that is FINER, `longest` at most."""
        return min(self.step / FINER, longest)


@dataclass(frozen=True)
class Member:
    """A case as the user writes it, and the namelist whose answer counts as true, or what makes it from the case's resolution.

    `exact` holds quantities that are known in closed form [SI], by path; with all of them there `truth` may be empty. `files` are
    written beside the namelist, by name. With a `target`, a relative error that the namelist asks for, that is judged in place of
    the estimate.
    """

    name: str
    case: str
    truth: str | Callable[[Resolution], str] = ""
    exact: dict[str, float] = field(default_factory=dict)
    files: dict[str, str | bytes] = field(default_factory=dict)
    target: float = 0.0


@dataclass(frozen=True)
class Family:
    """Cases of one kind; `quantities` are paths of the result, `draw` makes so many members from a source of random numbers.

    `estimate` is the attribute that is judged: `error_grid` where the truth has the same domain.
    """

    name: str
    title: str
    quantities: tuple[str, ...]
    draw: Callable[[random.Random, int], list[Member]]
    count: int = 24
    estimate: str = "error_estimate"
    # The truth of a member goes on to a later time: its end is told by a note, which then counts.
    truth_goes_on: bool = False
    # Members are given, not drawn, and few: each truth must be within, no share is asked to be within ten times.
    given: bool = False


@dataclass
class Row:
    """One quantity of a member [SI]; estimate and true error are NaN where there are none."""

    family: str
    member: str
    quantity: str
    verdict: str
    value: float = math.nan
    estimate: float = math.nan
    true_error: float = math.nan
    reason: str = ""


@dataclass
class Result:
    """What a run says: exit status, reason of a failure, note, quantities with their estimates by path, resolution if in time."""

    status: int
    reason: str
    note: str
    values: dict[str, tuple[float, float]]
    resolution: Resolution | None = None


def as_text(value: object) -> str:
    """A string of HDF5."""
    return value.decode("utf-8") if isinstance(value, bytes) else str(value)


def run(text: str, files: dict[str, str | bytes], family: Family) -> Result:
    """Runs a namelist in a folder of its own."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "case.nml").write_text(text, encoding="utf-8")
        for file, content in files.items():
            (folder / file).write_bytes(content.encode("utf-8") if isinstance(content, str) else content)
        command = [PROGRAM, "--quiet", "case.nml"]
        done = subprocess.run(command, cwd=folder, env=ENVIRONMENT, check=False, capture_output=True, text=True, timeout=PATIENCE)
        if not (folder / "case.h5").exists():
            return Result(done.returncode, done.stderr.strip(), "", {})
        with h5py.File(folder / "case.h5") as file:
            reason = "" if file.attrs["converged"] == 1 else as_text(file.attrs["reason"])
            parts = as_text(file["report/note"][()]).split("; ") if "report/note" in file else []
            parts = [part for part in parts if UNUSUAL not in part and (family.truth_goes_on or not part.startswith(TOLD))]
            values = {path: read(file, path, family.estimate) for path in family.quantities if path in file}
            return Result(done.returncode, reason, "; ".join(parts), values, resolution(file))


def read(file: h5py.File, path: str, estimate: str) -> tuple[float, float]:
    """A quantity and its error estimate, of a sweep the last one."""
    data = file[path]
    return float(np.ravel(data[()])[-1]), float(np.ravel(data.attrs.get(estimate, math.nan))[-1])


def resolution(file: h5py.File) -> Resolution | None:
    """That of a passage."""
    groups = file["input/effective"]
    if "time" not in groups or "time_step" not in groups["time"].attrs:
        return None
    domain = groups["domain"].attrs
    ends = [float(domain[key]) for key in ("x_inlet", "x_outlet")]
    return Resolution((ends[1] - ends[0]) / float(domain["intervals"]), float(groups["time"].attrs["time_step"]), *ends)


def judge(family: Family, member: Member) -> list[Row]:
    """All quantities of a member."""
    found = run(member.case, member.files, family)
    if found.status != 0 or found.reason:
        return [Row(family.name, member.name, path, REFUSED, reason=found.reason) for path in family.quantities]
    classes = {path: classify(member, found, path) for path in family.quantities}
    truth = member.exact
    if member.truth and any(verdict == JUDGED for verdict, _ in classes.values()):
        fine = run(member.truth if isinstance(member.truth, str) else member.truth(found.resolution), member.files, family)
        if fine.status != 0:
            return [Row(family.name, member.name, path, "no truth", reason=fine.reason) for path in family.quantities]
        truth = {path: value for path, (value, _) in fine.values.items()} | truth
    rows = []
    for path, (verdict, estimate) in classes.items():
        value = found.values[path][0]
        error = abs(value - truth.get(path, math.nan))
        rows.append(Row(family.name, member.name, path, verdict, value, estimate, error, found.note))
    return rows


def classify(member: Member, found: Result, path: str) -> tuple[str, float]:
    """The class of a quantity, and what is judged: its estimate, or the target."""
    value, estimate = found.values[path]
    estimate = member.target * abs(value) or estimate
    if found.note:
        return NOTED, estimate
    return (UNKNOWN if math.isnan(estimate) else JUDGED), estimate


def is_within(row: Row) -> bool:
    """Whether the truth is within the estimate."""
    return row.true_error <= row.estimate


def is_tight(row: Row) -> bool:
    """Whether the estimate is below ten times the true error."""
    return row.estimate < 10 * max(row.true_error, FLOOR * abs(row.value))


def table(families: list[Family], rows: list[Row]) -> str:
    """A line a quantity, with the verdict on the family."""
    lines = [
        f"{'family, quantity':44s} {'cases':>5s} {'refused':>7s} {'noted':>5s} {'not known':>9s} {'within':>7s} {'< 10 x':>7s}"
    ]
    for family in families:
        lines.append(family.title)
        for path in family.quantities:
            own = [row for row in rows if row.family == family.name and row.quantity == path and row.verdict != "no truth"]
            judged = [row for row in own if row.verdict == JUDGED]
            counts = [sum(row.verdict == verdict for row in own) for verdict in (REFUSED, NOTED, UNKNOWN)]
            within, tight = (share(judged, test) for test in (is_within, is_tight))
            asked = (1.0, 0.0) if family.given else (WITHIN, TIGHT)
            verdict = "" if within >= asked[0] and tight >= asked[1] else "  missed"
            label = f"  {family.name} {path.removeprefix('summary/')}"
            lines.append(
                f"{label:44s} {len(own):5d} {counts[0]:7d} {counts[1]:5d} {counts[2]:9d} "
                f"{percent(within)} {percent(tight)}{verdict}"
            )
    return "\n".join(lines) + "\n"


def share(rows: list[Row], test: Callable[[Row], bool]) -> float:
    """Which part passes a test; of none, all."""
    return sum(test(row) for row in rows) / len(rows) if rows else 1.0


def percent(value: float) -> str:
    """Seven columns."""
    return f"{100 * value:5.1f} %"


def found_families(names: list[str]) -> list[Family]:
    """Those of all modules family_*.py, or of the named modules."""
    modules = sorted(path.stem for path in Path(__file__).parent.glob("family_*.py"))
    known = [name.removeprefix("family_") for name in modules]
    unknown = sorted(set(names) - set(known))
    if unknown:
        sys.exit(f"families.py: no module family_{unknown[0]}.py; there are {', '.join(known)}")
    wanted = [name for name in modules if not names or name.removeprefix("family_") in names]
    return [family for name in wanted for family in importlib.import_module(name).FAMILIES]


def write(folder: Path, families: list[Family], rows: list[Row]) -> str:
    """Writes what is known so far, so that a run that is stopped keeps it; the table."""
    with (folder / "families.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(Row.__dataclass_fields__)
        writer.writerows(row.__dict__.values() for row in rows)
    text = table(families, rows)
    (folder / "families.txt").write_text(text, encoding="utf-8")
    return text


def main() -> int:
    """Command line; status 1 where a family does not hold."""
    parser = new_parser(__doc__, f"{QUICK} members of each family", "results/accuracy")
    parser.add_argument("names", nargs="*", metavar="NAME", help="modules (family_NAME.py); default: all")
    parser.add_argument("--seed", type=int, default=SEED, help="another sample, for fitting")
    parser.add_argument("--members", type=int, default=0, help="members of each family; default: those of the family")
    parser.add_argument("--processes", type=int, default=1, help="members side by side")
    options = parser.parse_args()
    folder = output_folder(options)
    families = found_families(options.names)
    rows: list[Row] = []
    text = ""
    for k, family in enumerate(families):
        count = options.members or (QUICK if options.quick else family.count)
        members = family.draw(random.Random(f"{family.name} {options.seed}"), count)
        with ThreadPoolExecutor(options.processes) as pool:
            for i, own in enumerate(pool.map(lambda member, family=family: judge(family, member), members)):
                rows += own
                print(f"\r{family.name}: {i + 1} of {len(members)}   ", end="", file=sys.stderr, flush=True)
        print(file=sys.stderr)
        text = write(folder, families[: k + 1], rows)
    print(text, end="")
    return 1 if "  missed" in text else 0


if __name__ == "__main__":
    sys.exit(main())

"""Judges error bars: a contact as the user writes it, its truth, and the targets for many of them.

A member is a namelist and that of its truth: a finer grid, a longer domain, a smaller step. The program runs both, and each
quantity of the member's result falls into one of these classes:

    refused     exit status 1, or not converged with a reason: no number that looks like an answer
    noted       /report/note warns that the numbers are unreliable
    not known   no error estimate; the attribute no_estimate gives the reason
    judged      all others: is the truth within the estimate, and the estimate below ten times the true error?

The truth of a passage is FINER times as fine as its result in space and time, on any grid: schemes of second order leave a
sixteenth of the error. Its inlet is FARTHER times as far. Truths that no quantity needs are not computed.

Targets of a family: the truth is within the estimate for at least 95 % of those judged, the estimate below ten times the true
error for at least 80 %. A true error below FLOOR times the value counts as within ten times. Where the truth comes from another
discretisation (`is_other`), it is within the sum of both estimates for at least 95 %.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import h5py
import numpy as np
import pandas as pd
from bench_program import Answer, Run, answer, run_program
from namelists import NO_BARS, Groups, namelist

WITHIN, TIGHT = 0.95, 0.80
# The domain of a truth on graded nodes, whose far inlet costs little.
GRADED = {"grid": "graded"}
# Relative error that is as good as none.
FLOOR = 1e-6
# Spacing and time step of a result over those of its truth.
FINER = 4
# Distance of the inlet of a truth over that of the result.
FARTHER = 2
# Of the samples whose truth keeps the domain that the program chose: intervals of it, and length of a longer one, up to an inlet.
SAMPLE_FINER, LONGER, FARTHEST = 8, 4, 1000.0
# A note that takes nothing from the numbers where the truth ends at the same time; one on the input says nothing of them.
TOLD, UNUSUAL = "a feature is still in the contact", "is unusual, typical is"
REFUSED, NOTED, UNKNOWN, JUDGED = "refused", "noted", "not known", "judged"


@dataclass(frozen=True)
class Member:
    """A case as the user writes it, and the one whose answer counts as true, or what makes it from the case's answer.

    `exact` holds quantities that are known in closed form [SI], by path; with all of them there `truth` may be missing. `files` are
    written beside the namelist, by name. With a `target`, a relative error that the namelist asks for, that is judged in place of
    the estimate. Members without a name are numbered.
    """

    case: Groups
    truth: Groups | Callable[[Answer], Groups] | None = None
    exact: dict[str, float] = field(default_factory=dict)
    files: dict[str, str | bytes] = field(default_factory=dict)
    target: float = 0.0
    name: str = ""


@dataclass(frozen=True)
class Family:
    """Cases of one kind; `quantities` are paths of the result, `draw` makes the member of a number from a source of random numbers.

    `estimate` is the attribute that is judged, or their sum: `error_grid` where the truth has the same domain. `finish`, if there,
    draws what is left of each member when all are there.
    """

    group: str
    name: str
    title: str
    quantities: tuple[str, ...]
    draw: Callable
    count: int = 24
    estimate: str = "error_estimate"
    finish: Callable[[random.Random, Member], Member] | None = None
    # The truth of a member goes on to a later time: its end is told by a note, which then counts.
    truth_goes_on: bool = False
    # A sample that is always the same, `count` members at most, judged whatever is noted.
    is_sample: bool = False
    # What the answer of a quantity is on the finer grid, if not its own: figures of the nodes tend to those between them.
    limits: dict[str, str] = field(default_factory=dict)
    # Members are given, not drawn, and few: each truth must be within, no share is asked to be within ten times.
    given: bool = False
    # The truth is no finer than the result, and has its own estimates.
    is_other: bool = False

    @property
    def asked(self) -> tuple[float, float]:
        """Least shares of those judged whose truth is within the estimate, and whose estimate is below ten times the error."""
        return (1.0 if self.given else WITHIN), (0.0 if self.given or self.is_other else TIGHT)

    def members(self, seed: int, count: int) -> list[Member]:
        """So many of a seed."""
        source = random.Random(f"{self.name} {seed}")
        most = min(count, self.count) if self.is_sample else count
        found = self.draw() if self.given else [self.draw(source, i) for i in range(most)]
        return [self.finish(source, member) for member in found] if self.finish else found


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


def beside(groups: Groups, domain: dict, fine: dict, **others: dict) -> Member:
    """A contact on a domain, with further groups, beside its truth on another domain."""
    accuracy = {"target": 3e-4} if fine == GRADED else NO_BARS
    return Member(groups | {"domain": domain} | others, groups | {"domain": fine, "accuracy": accuracy})


def finer_passage(
    groups: Groups, ends: tuple[float, float], fewest: Callable[[float], int] | int, longest: float, **time: object
) -> Callable[[Answer], Groups]:
    """The truth of a passage, made from the answer of its case.

    Its domain reaches `ends` and FARTHER; it has FINER intervals, but no fewer than `fewest` (of its length), and a FINER time
    step, but none above `longest`; `time` are further keys.
    """

    def finer(found: Answer) -> Groups:
        start, end = found["x_inlet"], found["x_outlet"]
        domain = {"x_inlet": min(FARTHER * start, ends[0]), "x_outlet": max(end, ends[1])}
        length = domain["x_outlet"] - domain["x_inlet"]
        domain |= GRADED  # with a tail
        least, spacing = fewest(length) if callable(fewest) else fewest, (end - start) / found["intervals"]
        domain["intervals"] = rounded_up(max(FINER * length / spacing, least))
        step = min(found["time_step"] / FINER, longest)
        return groups | {"domain": domain, "accuracy": NO_BARS, "time": groups["time"] | {"time_step": step} | time}

    return finer


def finer_sample(groups: Groups, factor: int) -> Callable[[Answer], Groups | None]:
    """The truth of a steady contact: SAMPLE_FINER intervals, on a domain of `factor` times the length, if there is one."""

    def finer(found: Answer) -> Groups | None:
        start, end = found["x_inlet"], found["x_outlet"]
        far = end - factor * (end - start) if factor > 1 else start
        domain = {"x_inlet": far, "x_outlet": end, "intervals": SAMPLE_FINER * factor * found["intervals"]}
        return groups | {"domain": domain, "accuracy": NO_BARS} if factor == 1 or far > -FARTHEST else None

    return finer


def rounded_up(wanted: float) -> int:
    """4, 5, 6 or 7 times a power of two."""
    power = 2 ** math.floor(math.log2(wanted / 4))
    return power * math.ceil(wanted / power)


def read(family: Family, file: h5py.File) -> tuple[Answer, str, dict[str, tuple[float, float]]]:
    """What is judged of a result: its answer, note, quantities with their estimates by path (of a sweep the last)."""
    found = answer(file)
    parts = found.get("note", "").split("; ") if not family.is_sample else []
    note = [part for part in parts if UNUSUAL not in part and (family.truth_goes_on or not part.startswith(TOLD))]
    values = {}
    for path in (path for path in family.quantities if path in file):
        bar = sum(file[path].attrs.get(part, math.nan) for part in family.estimate.split("+"))
        values[path] = tuple(float(np.ravel(each)[-1]) for each in (file[path][()], bar))
    return found, "; ".join(note), values


def judge(family: Family, member: Member, name: str) -> list[Row]:
    """All quantities of a member."""
    take = partial(read, family)
    run = run_program(namelist(member.case), take, member.files)
    if reason := why_not(run):
        return [Row(family.name, name, path, REFUSED, reason=reason) for path in family.quantities]
    rows, (found, note, values) = [], run.found
    for path, (value, estimate) in values.items():
        bar = member.target * abs(value) or estimate
        verdict = NOTED if note else UNKNOWN if math.isnan(bar) else JUDGED
        rows.append(Row(family.name, name, path, verdict, value, bar, reason=note))
    truth = {path: (value, 0.0) for path, value in member.exact.items()}
    if member.truth and any(row.verdict == JUDGED for row in rows):
        finer = member.truth(found) if callable(member.truth) else member.truth
        fine = run_program(namelist(finer), take, member.files) if finer else None
        if fine is None or why_not(fine):
            return [replace(row, verdict="no truth", reason=why_not(fine) if fine else "") for row in rows]
        truth = fine.found[2] | truth
    for row in rows:
        value, bar = truth.get(family.limits.get(row.quantity, row.quantity), (math.nan, math.nan))
        row.true_error = abs(row.value - value)
        row.estimate += bar if family.is_other else 0.0
        if row.verdict == JUDGED and math.isnan(row.estimate):
            row.verdict = "no truth"
    return rows


def why_not(run: Run) -> str:
    """Why there is no number that looks like an answer; a film below the roughness has errors, too."""
    if run.found is None:
        return run.words or "no result"
    return "" if run.found[0].converged else run.found[0]["reason"]


def judged(rows: pd.DataFrame) -> pd.DataFrame:
    """Those that are judged: whether the truth is within the estimate, and this below ten times the true error (`tight`)."""
    own = rows[rows["verdict"] == JUDGED]
    largest = 10 * np.maximum(own["true_error"], FLOOR * own["value"].abs())
    return own.assign(within=own["true_error"] <= own["estimate"], tight=own["estimate"] <= largest)

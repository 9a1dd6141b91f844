"""Chapter 6, supplements: the loads of Figure 6.10 as printed, and internal cavitation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from overtaking import FORMS, Situation, Thinning, measure
from study import Claims, Runner, StudyError, Table

# "w = 10 kN" and "20 kN" of Figure 6.10, read per metre; the thesis has 100 kN/m in chapter 5.
PRINTED_LOADS = (1e4, 2e4)
USED_LOADS = (1e5, 2e5)
DEPTHS = tuple(range(-1, -7, -1))
# Fast over slow, by the signs of l2 and l1.
SIGNS = {"ridge-ridge": (1, 1), "ridge-dent": (1, -1), "dent-dent": (-1, -1), "dent-ridge": (-1, 1)}
AMPLITUDES = (1, 2, 3, 4, 6, 8)
# Where and when an overtaking is looked at: half-widths from the centre, and time after the meeting, as for the spikes.
INSIDE, MEETS = 0.8, (-0.6, 0.5)


@dataclass(frozen=True)
class Cavitation:
    """Internal cavitation of one overtaking: lowest P; largest length of P = 0 with pressure on both sides, and for how long."""

    lowest: float
    length: float
    duration: float


def cavitation(x: np.ndarray, time: np.ndarray, pressure: np.ndarray) -> Cavitation:
    """From P over `time` (after the meeting, rows) and X (columns)."""
    loaded = pressure > 0
    between = ~loaded & np.maximum.accumulate(loaded, axis=1) & np.maximum.accumulate(loaded[:, ::-1], axis=1)[:, ::-1]
    part = np.ix_((time >= MEETS[0]) & (time <= MEETS[1]), np.abs(x) <= INSIDE)
    count = between[part].sum(axis=1)
    length, duration = count.max() * (x[1] - x[0]), np.count_nonzero(count) * (time[1] - time[0])
    return Cavitation(float(pressure[part].min()), float(length), float(duration))


def read_cavitation(situation: Situation, path: Path) -> Cavitation:
    """The internal cavitation of a result."""
    with h5py.File(path) as file:
        time = file["transient/profile_time"][()] - situation.meeting_time
        return cavitation(file["solution/x"][()], time, file["transient/pressure"][()])


def study_cavitation(runner: Runner, claims: Claims, amplitudes: tuple[float, ...] = AMPLITUDES, form: str = "b") -> Table:
    """The four overtakings, s = 4/3, with features of the same height, higher and higher."""
    table = Table(
        situation="fast over slow",
        amplitude="height of both features / 0.2 um",
        lowest="lowest P within 0.8 half-widths of the centre, from 0.6 before to 0.5 after the meeting",
        length="there, largest length of P = 0 between loaded nodes [half-widths]",
        duration="for how long [units of T]",
        outcome="solved, or not: the film closes",
    )
    situations = {(words, a): Situation(4, l1=one * a, l2=two * a) for words, (two, one) in SIGNS.items() for a in amplitudes}
    found: dict[tuple[str, float], Cavitation] = {}
    for key, item in situations.items():
        row = {"situation": key[0], "amplitude": float(key[1])}
        case = item.case(FORMS[form], ("pressure",))
        try:
            result = runner.run({item.name: case}, lambda _, path, item=item: read_cavitation(item, path))[item.name]
        except StudyError:
            table.add(**row, outcome="not solved")
            continue
        found[key] = result
        table.add(**row, **vars(result), outcome="solved")
    judge_cavitation(claims, found, amplitudes)
    return table


def judge_cavitation(claims: Claims, found: dict[tuple[str, float], Cavitation], amplitudes: tuple[float, ...]) -> None:
    """Section 6.1: "the possibility of internal cavitation is highest in the dent-dent case"."""
    first = {
        words: min((a for a in amplitudes if (words, a) in found and found[words, a].length > 0), default=None) for words in SIGNS
    }
    lowest = {words: found[words, amplitudes[0]].lowest for words in SIGNS}
    highest = max(amplitudes)
    longest = max(found, key=lambda key: found[key].length)
    claims.check(
        "Section 6.1: the possibility of internal cavitation is highest in the dent-dent case",
        min(lowest, key=lowest.get) == "dent-dent" and min(SIGNS, key=lambda words: first[words] or np.inf) == "dent-dent",
        "lowest P near the meeting, l = +-1: "
        + ", ".join(f"{words} {value:.3f}" for words, value in lowest.items())
        + "; internal cavitation from l = "
        + ", ".join(f"{words} {value or f'none up to {highest:g}'}" for words, value in first.items())
        + f"; longest {found[longest].length:.3f} half-widths, {longest[0]}, l = {longest[1]:g}",
    )


def study_printed_loads(folder: Path, options: object, claims: Claims, used: dict[Situation, Thinning]) -> Table:
    """Film thinning at 10 and 20 kN/m beside 100 and 200 kN/m (`used`, form (b)), s = 5/3, m2 = 1."""
    items = [Situation(5, load, l2=depth) for load in PRINTED_LOADS for depth in DEPTHS]
    found = {
        form: measure(Runner(folder / form, options.jobs, options.program), items, FORMS[form])
        for form in ("b", "b_step", "b_grid")
    }
    table = Table(
        load="load per length [N/m]",
        l2="dent height / 0.2 um",
        xi="film thinning (6.1), form (b)",
        error="halving of the step and of the grid",
        h_min="smallest film of the passage over the smooth one",
    )
    for item in items:
        b, step, grid = (found[form][item].xi for form in ("b", "b_step", "b_grid"))
        error = (abs(b - step) + abs(step - grid)) / 3
        table.add(load=item.load, l2=item.l2, xi=b, error=error, h_min=found["b"][item].h_min)
    judge_loads(claims, {item: value.xi for item, value in (found["b"] | used).items()})
    return table


def judge_loads(claims: Claims, xi: dict[Situation, float]) -> None:
    """Which reading of "10 kN" and "20 kN" gives what Figure 6.10 shows: more thinning at double load, about 0.4 and 0.45."""
    rows = {load: [xi[Situation(5, load, l2=depth)] for depth in DEPTHS] for load in (*PRINTED_LOADS, *USED_LOADS)}
    light, heavy = ([rows[b][i] - rows[a][i] for i in range(len(DEPTHS))] for a, b in (PRINTED_LOADS, USED_LOADS))
    claims.check(
        'Fig. 6.10: "w = 10 kN" and "20 kN" are 100 and 200 kN/m, since more load gives more thinning',
        all(value > 0 for value in heavy) and not all(value > 0 for value in light),
        "; ".join(f"{load / 1e3:g} kN/m " + ", ".join(f"{value:.3f}" for value in values) for load, values in rows.items())
        + " for l2 = -1 ... -6",
    )

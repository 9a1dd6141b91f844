"""Table 5.3 of the thesis by every reading of (5.5) and (5.6) that the text allows, against the printed numbers.

Also smallest film and largest pressure of the passages with their errors.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from study import Claims, Table

PRINTED = {"case1": (None, 0.021), "case2": (0.057, 0.12), "case3": (1.04, 0.17)}  # time, space [%]
CENTRES = (-1.0, -0.5, 0.0, 0.5, 1.0)  # of the ridge in the figures


@dataclass(frozen=True)
class Change:
    """P and H of one run and of one with half the step or the grid, at the same times and nodes; place of the ridge centre."""

    ridge: np.ndarray
    pressure: tuple[np.ndarray, np.ndarray]
    film: tuple[np.ndarray, np.ndarray]
    central_film: float

    @property
    def by_time(self) -> np.ndarray:
        """Largest change of P over X at each time."""
        return np.abs(self.pressure[1] - self.pressure[0]).max(axis=1)


def change(coarse: object, fine: object, ridge_speed: float, central_film: float) -> Change:
    """The pair of two passages; `ridge_speed` in half-widths per unit of T, from X = -2.5."""
    fine = fine.on(coarse.time)
    skip = (fine.x.size - 1) // (coarse.x.size - 1)
    pressure, film = ((getattr(coarse, name), getattr(fine, name)[:, ::skip]) for name in ("pressure", "film"))
    return Change(-2.5 + ridge_speed * coarse.time, pressure, film, central_film)


def where_loaded(pair: Change) -> float:
    """Largest change of P over the local P, where P > 0.5."""
    first, second = pair.pressure
    loaded = second > 0.5
    return float((np.abs(second - first)[loaded] / second[loaded]).max())


MEASURES: dict[str, Callable[[Change], float]] = {
    "largest over X and T, as written": lambda pair: pair.by_time.max(),
    "ridge centre in the contact, |X_c| <= 1": lambda pair: pair.by_time[np.abs(pair.ridge) <= 1].max(),
    "at the five places of the figures": lambda pair: max(pair.by_time[np.argmin(np.abs(pair.ridge - x))] for x in CENTRES),
    "mean over T of the largest over X": lambda pair: pair.by_time.mean(),
    "of the local P, where P > 0.5": where_loaded,
    "of the film, over h_c": lambda pair: np.abs(pair.film[1] - pair.film[0]).max() / pair.central_film,
}


def readings_table(
    smooth: dict[int, float], steps: dict[str, dict[str, Change]], grids: dict[str, dict[int, Change]], exact: dict[str, float]
) -> Table:
    """All readings [%].

    `smooth`: largest change of P of Case 1 for each pair n, 2n. `steps`: for each case the pairs 'given', 'double' (twice the
    printed step) and 'both' (512 against 1024 intervals and half the step). `grids`: the pairs n, 2n of each case. `exact`: the
    difference to BDF2 with a quarter of the step.
    """
    table = Table(error="time or space", reading="how it is measured", case1="Case 1 [%]", case2="Case 2 [%]", case3="Case 3 [%]")
    for error, index in (("time", 0), ("space", 1)):
        table.add(error=error, reading="printed", **{name: pair[index] for name, pair in PRINTED.items()})
        if error == "time":
            for words, measure in MEASURES.items():
                table.add(
                    error=error, reading=words, **{name: 100 * float(measure(kinds["given"])) for name, kinds in steps.items()}
                )
            for kind, words in (
                ("double", "twice the printed step"),
                ("both", "dX and dT halved, from 512 intervals and twice the step"),
            ):
                table.add(
                    error=error, reading=words, **{name: 100 * float(kinds[kind].by_time.max()) for name, kinds in steps.items()}
                )
            table.add(error=error, reading="against BDF2 with a quarter of the step", **exact)
            continue
        for n, steady in smooth.items():
            for factor, words in ((1 / 3, "as written"), (1, "without the third")):
                row = {name: 100 * factor * float(pairs[n].by_time.max()) for name, pairs in grids.items()}
                table.add(error=error, reading=f"{n} against {2 * n} intervals, {words}", case1=100 * factor * steady, **row)
    return table


def misfit(row: dict[str, object], printed: dict[str, object]) -> float:
    """Largest factor between a reading and the printed values."""
    pairs = [(row.get(name), printed[name]) for name in PRINTED if printed.get(name) is not None]
    return max(math.inf if value is None else max(value / other, other / value) for value, other in pairs)


def check_readings(claims: Claims, table: Table) -> None:
    """Which reading comes nearest to all printed numbers, and which to each."""
    for error in ("time", "space"):
        printed, *rows = [row for row in table.rows if row["error"] == error]
        nearest = min(rows, key=lambda row: misfit(row, printed))
        known = {name: printed[name] for name in PRINTED if printed.get(name) is not None}
        values = ", ".join(f"{nearest[name]:.3f} ({value})" for name, value in known.items())
        claims.check(
            f"Table 5.3: one reading of the definitions gives all printed {error} errors",
            misfit(nearest, printed) < 1.1,
            f"nearest: {nearest['reading']}; {values} (in brackets: printed), off by up to a factor {misfit(nearest, printed):.2f}",
        )
        single = {name: min(rows, key=partial(misfit, printed={name: value})) for name, value in known.items()}
        claims.check(
            f"Table 5.3: the reading nearest to each printed {error} error",
            "see there",
            "; ".join(f"{name} {printed[name]}: {row[name]:.4f}, {row['reading']}" for name, row in single.items()),
        )


def extremes_table() -> Table:
    """Smallest film and largest pressure of the passages."""
    return Table(
        case="case",
        h_min="smallest H of the passage, 1024 intervals, printed step",
        h_error="its error: twice what halving the step changes and 4/3 of what halving dX changes",
        h_time="T at which the film is thinnest",
        h_time_error="its error likewise, and half the time between two profiles",
        p_max="largest P of the passage",
        p_error="its error",
        p_time="T at which the pressure is largest",
        p_time_error="its error",
    )


def extremes(name: str, given: object, half_step: object, fine_grid: object) -> dict[str, object]:
    """One row of `extremes_table`."""
    row: dict[str, object] = {"case": name}
    between = float(given.time[1] - given.time[0]) / 2
    half_step = half_step.on(given.time)
    for letter, field, find, value in (("h", "film", np.argmin, "h_min"), ("p", "pressure", np.argmax, "p_max")):
        found = []
        for passage in (given, half_step, fine_grid):
            values = getattr(passage, field)
            step, node = np.unravel_index(find(values), values.shape)
            found.append((float(values[step, node]), float(passage.time[step])))
        errors = [2 * abs(found[0][i] - found[1][i]) + 4 / 3 * abs(found[0][i] - found[2][i]) for i in (0, 1)]
        row |= {value: found[0][0], f"{letter}_error": errors[0], f"{letter}_time": found[0][1]}
        row[f"{letter}_time_error"] = errors[1] + between
    return row

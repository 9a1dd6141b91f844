"""The statements of chapter 7 and Paper C on the four profiles, each as a yes-or-no test of four sweeps."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from dry_profiles import LOADS, PROFILES, Statement, Statements, Sweep, straightness

ALL_LOADS = (*LOADS, 110, 120, 130, 140, 150)
FIRST = len(LOADS)  # the loads of all figures but C.5 and C.6, which reach 150 kN/m
HIGH = slice(LOADS.index(50), FIRST)
LOW = slice(0, LOADS.index(25) + 1)
RANKING = "ADBC"  # Ra, Rq and Rz of Tables 7.1 and C.1
STATES = ("loaded", "unloaded")
PARAMETERS = {"ra": "Ra", "rz": "Rz", "rq": "Rq"}
AREA, INDEX = "contact_area_fraction", "plasticity_index"
# The sweeps of A, B, C and D, and as A_hard that of A with twice the hardness.
Four = dict[str, Sweep]


def statement(
    where: str, text: str, reading: str, holds: Callable[[Four], bool], number: Callable[[Sweep], float], unit: str = ""
) -> Statement[Four]:
    """A statement with one number of each profile behind the answer."""
    return Statement(where, text, reading, holds, lambda four: ", ".join(f"{number(four[name]):.3g}{unit}" for name in PROFILES))


def of_all(test: Callable[[Sweep], bool]) -> Callable[[Four], bool]:
    """Whether all four fulfil it."""
    return lambda four: all(test(four[name]) for name in PROFILES)


def ranked(order: str, value: Callable[[Sweep], np.ndarray]) -> Callable[[Four], bool]:
    """Whether the first of `order` has the largest value everywhere, and so on."""
    return lambda four: all(bool(np.all(value(four[a]) > value(four[b]))) for a, b in pairwise(order))


def spread(four: Four, column: str, at: int, names: str = "ABCD") -> float:
    """Largest less smallest value over some profiles at one load."""
    values = [four[name][column][at] for name in names]
    return max(values) - min(values)


def high_index(sweep: Sweep) -> float:
    """Mean plasticity index from 50 kN/m on."""
    return float(sweep[INDEX][HIGH].mean())


def off_line(sweep: Sweep) -> float:
    """Largest distance of the index from a straight line from 50 kN/m on, over its mean."""
    load, index = np.array(LOADS[HIGH]), sweep[INDEX][HIGH]
    return float(np.abs(index - np.polyval(np.polyfit(load, index, 1), load)).max() / index.mean())


def with_undeformed(sweep: Sweep, parameter: str, state: str, last: int = FIRST) -> np.ndarray:
    """A parameter over the loads from 0 on."""
    return np.r_[sweep[f"{parameter}_undeformed"][0], sweep[f"{parameter}_{state}"][:last]]


def straight(sweep: Sweep, parameter: str, state: str) -> float:
    """R^2 of the straight line of a parameter over the loads from 0 on."""
    return straightness(np.r_[0, LOADS], with_undeformed(sweep, parameter, state))


def change(sweep: Sweep, parameter: str, state: str, last: int = FIRST) -> float:
    """Largest change of a parameter by the load."""
    values = with_undeformed(sweep, parameter, state, last)
    return float(np.abs(values - values[0]).max())


def most(four: Four, names: str, value: Callable[[Sweep], float]) -> bool:
    """Whether the first of `names` has a larger value than all others."""
    return all(value(four[names[0]]) > value(four[name]) for name in names[1:])


def is_similar(sweep: Sweep) -> bool:
    """From 10 to 50 and to 100 kN/m the area rises, Ra, Rz and the mean separation fall; the index is higher at high load."""
    at = [LOADS.index(load) for load in (10, 50, 100)]
    falling = all(np.all(np.diff(sweep[key][at]) < 0) for key in ("ra_loaded", "rz_loaded", "mean_separation"))
    return falling and bool(np.all(np.diff(sweep[AREA][at]) > 0)) and high_index(sweep) > sweep[INDEX][LOW].mean()


def on_contact() -> list[Statement[Four]]:
    """The statements on area, plasticity index and separation."""
    last = FIRST - 1
    half = LOADS.index(50)

    def area(sweep: Sweep) -> float:
        return 100 * float(sweep[AREA][last])

    def depth(sweep: Sweep) -> float:
        return 1e9 * float(sweep["dp_mean"][last])

    def separation(sweep: Sweep) -> np.ndarray:
        return sweep["mean_separation"][:FIRST]

    def fit(sweep: Sweep) -> float:
        return straightness(np.array(LOADS), sweep[AREA][:FIRST])

    return [
        statement(
            "7.1, C.4",
            "The contact area increases almost linearly with the load",
            "R² above 0.97 up to 100 kN/m",
            of_all(lambda s: fit(s) > 0.97),
            fit,
        ),
        statement(
            "7.1, C.4",
            "The plasticity index is quite linear at high load",
            "from 50 kN/m on within 10 % of a straight line",
            of_all(lambda s: off_line(s) < 0.1),
            off_line,
        ),
        statement(
            "7.1, C.4",
            "A suffers the largest plastic deformation",
            "largest plasticity index, mean from 50 kN/m on",
            lambda four: most(four, "ABCD", high_index),
            high_index,
        ),
        statement(
            "7.1, C.4",
            "The same by the depth of the plastic deformation",
            "largest mean depth from 50 kN/m on; nm at 100 kN/m",
            lambda four: all(np.all(four["A"]["dp_mean"][HIGH] > four[n]["dp_mean"][HIGH]) for n in "BCD"),
            depth,
        ),
        statement(
            "7.1, 7.2",
            "The area of A does not differ significantly from those of B and D",
            "A, B, D within 10 % at 100 kN/m; area in %",
            lambda four: spread(four, AREA, last, "ABD") < 0.1 * four["A"][AREA][last],
            area,
            " %",
        ),
        statement(
            "7.1, 7.2, C.4",
            "C, the smoothest, has the largest contact area",
            "at 100 kN/m, in %",
            lambda four: most(four, "CABD", area),
            area,
            " %",
        ),
        statement(
            "7.1, C.4",
            "C has the lowest plasticity index",
            "mean from 50 kN/m on",
            lambda four: all(high_index(four["C"]) < high_index(four[n]) for n in "ABD"),
            high_index,
        ),
        statement(
            "7.1, C.4",
            "D has a higher plasticity index than B",
            "mean from 50 kN/m on",
            lambda four: most(four, "DB", high_index),
            high_index,
        ),
        statement(
            "7.2, C.5",
            "The plasticity index depends highly on the roughness; its ranking is that of Ra",
            "A > D > B > C, mean from 50 kN/m on",
            ranked(RANKING, high_index),
            high_index,
        ),
        statement(
            "C abstract",
            "The plasticity index differs significantly between the profiles",
            "the largest at least 1.3 times the smallest, mean from 50 kN/m on",
            lambda four: max(high_index(four[n]) for n in PROFILES) > 1.3 * min(high_index(four[n]) for n in PROFILES),
            high_index,
        ),
        statement(
            "7.2",
            "That ranking is in part due to the same hardness of all",
            "with twice the hardness A falls below D",
            lambda four: high_index(four["A_hard"]) < high_index(four["D"]),
            high_index,
        ),
        statement(
            "C abstract",
            "Plastic deformation occurs even at low loads",
            "in all four at 10 kN/m; plasticity index there",
            of_all(lambda s: s[INDEX][1] > 0),
            lambda s: float(s[INDEX][1]),
        ),
        statement(
            "7.2, C.5",
            "The contact area is almost independent of the roughness",
            "largest over smallest below 1.5 at 100 kN/m (Rq: 6.7); area in %",
            lambda four: spread(four, AREA, last) < 0.5 * min(four[n][AREA][last] for n in PROFILES),
            area,
            " %",
        ),
        statement(
            "7.2",
            "The deviations in the area increase with the load",
            "largest less smallest at 100 above that at 50 kN/m; area in %",
            lambda four: spread(four, AREA, last) > spread(four, AREA, half),
            area,
            " %",
        ),
        statement(
            "7.2, C.5",
            "All four behave alike as the load rises",
            "area and index rise, loaded Ra, Rz and mean separation fall from 10 to 50 to 100 kN/m; 1 = does so",
            of_all(is_similar),
            lambda s: float(is_similar(s)),
        ),
        statement(
            "C.4, Fig. C.7",
            "The mean separation keeps the ranking of Ra",
            "A > D > B > C at every load; µm at 100 kN/m",
            ranked(RANKING, separation),
            lambda s: 1e6 * float(separation(s)[-1]),
        ),
    ]


def on_heights(state: str) -> list[Statement[Four]]:
    """The statements on Ra, Rz, Rq, Rsk and Rku of the heights, under the load or after it."""
    found = []
    for key, name in PARAMETERS.items():
        where = {"ra": "7.1, C.4", "rz": "7.1", "rq": "C.4"}[key]
        last = FIRST if key == "rz" else len(ALL_LOADS)

        def part(s: Sweep, key: str = key) -> float:
            return change(s, key, state) / float(s[f"{key}_undeformed"][0])

        def line(s: Sweep, key: str = key) -> float:
            return straight(s, key, state)

        def values(s: Sweep, key: str = key, last: int = last) -> np.ndarray:
            return with_undeformed(s, key, state, last)

        found += [
            statement(
                where,
                f"{name} ({state}) varies little with the load",
                "by less than 10 % up to 100 kN/m",
                of_all(lambda s, part=part: part(s) < 0.1),
                part,
            ),
            statement(
                where,
                f"{name} ({state}) decreases linearly",
                "R² above 0.97 up to 100 kN/m",
                of_all(lambda s, line=line: line(s) > 0.97),
                line,
            ),
            statement(
                where,
                f"{name} ({state}) keeps its ranking",
                f"A > D > B > C up to {ALL_LOADS[last - 1]} kN/m; µm there",
                ranked(RANKING, values),
                lambda s, values=values: 1e6 * float(values(s)[-1]),
            ),
        ]

    def kurtosis_change(s: Sweep) -> float:
        return change(s, "rku", state)

    def early_fall(s: Sweep) -> float:
        values = with_undeformed(s, "rku", state)
        return float(values[0] - values[1:][LOW].min())

    def kurtosis(s: Sweep) -> np.ndarray:
        return s[f"rku_{state}"][:FIRST]

    def skewness(s: Sweep) -> np.ndarray:
        return with_undeformed(s, "rsk", state, len(ALL_LOADS))

    def skewness_line(s: Sweep) -> float:
        return straight(s, "rsk", state)

    return [
        *found,
        statement(
            "7.1, C.4",
            f"Rsk ({state}) keeps its ranking",
            "C > D > B > A up to 150 kN/m; value there",
            ranked("CDBA", skewness),
            lambda s: float(skewness(s)[-1]),
        ),
        statement(
            "7.1, C.4",
            f"Rsk ({state}) is not linear, but for A",
            "A: R² above 0.97, and above that of the others",
            lambda four: skewness_line(four["A"]) > 0.97 and most(four, "ABCD", skewness_line),
            skewness_line,
        ),
        statement(
            "7.1, C.4",
            f"Rk ({state}) of C falls rapidly at low load",
            "up to 25 kN/m farther than that of the others",
            lambda four: most(four, "CABD", early_fall),
            early_fall,
        ),
        statement(
            "7.1, C.4",
            f"Rk ({state}) changes its ranking: C passes B",
            "C below B at some load up to 100 kN/m; smallest value",
            lambda four: bool(np.any(kurtosis(four["C"]) < kurtosis(four["B"]))),
            lambda s: float(kurtosis(s).min()),
        ),
        statement(
            "7.1, C.4",
            f"Rk ({state}) is altered most for C",
            "largest change up to 100 kN/m",
            lambda four: most(four, "CABD", kurtosis_change),
            kurtosis_change,
        ),
        statement(
            "7.1, C.4",
            f"Rk ({state}) is altered least for D",
            "largest change up to 100 kN/m",
            lambda four: all(kurtosis_change(four["D"]) < kurtosis_change(four[n]) for n in "ABC"),
            kurtosis_change,
        ),
    ]


STATEMENTS = on_contact() + [item for state in STATES for item in on_heights(state)]


def judge(given: Four, fine: Four, draws: list[Four]) -> Statements:
    """All statements: for the stand-ins, for them on a finer grid, and in how many draws they hold."""
    table = Statements("A, B, C, D of the stand-ins")
    table.judge_all(STATEMENTS, {"stand_ins": given, "fine": fine}, draws)
    return table

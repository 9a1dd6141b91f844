"""The statements of chapter 4 on a profile cut to its first n harmonics, each as a test of the curves over n."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from dry_profiles import Statement, Statements

ACCURACY = 0.1
DEPTH = 0.5  # um, printed
ELASTIC, PLASTIC = 75, 50  # harmonics, printed
KINDS = ("elastic", "plastic")
AREA = "contact_area_fraction"
LIMIT = 255  # N/2 - 1


def settled(harmonics: list[int], values: np.ndarray, tolerance: float) -> int:
    """The first n from which on all values stay within `tolerance` of the last."""
    inside = np.abs(values - values[-1]) <= tolerance
    return harmonics[len(inside) - int(np.argmin(inside[::-1])) if not inside.all() else 0]


def needed(harmonics: list[int], values: np.ndarray, accuracy: float = ACCURACY) -> int:
    """The first n from which on all values stay within `accuracy` of the last, relative."""
    return settled(harmonics, values, accuracy * abs(values[-1]))


@dataclass(frozen=True)
class Cut:
    """A profile cut to n harmonics: every quantity over n, elastic and plastic."""

    harmonics: list[int]
    series: dict[str, dict[str, np.ndarray]]

    def count(self, kind: str, key: str) -> int:
        """The n that a quantity needs: for 10 %, the skewness for 0.1."""
        values = self.series[kind][key]
        return settled(self.harmonics, values, ACCURACY) if key.startswith("rsk") else needed(self.harmonics, values)

    def area(self, kind: str) -> int:
        """The n that the contact area needs."""
        return self.count(kind, AREA)

    def counts(self, *keys: str) -> dict[str, tuple[int, ...]]:
        """The n of some parameters under load, with both materials."""
        return {key: tuple(self.count(kind, f"{key}_loaded") for kind in KINDS) for key in keys}

    def last(self, kind: str, key: str) -> float:
        """The value with all harmonics."""
        return float(self.series[kind][key][-1])

    def states(self, key: str) -> list[float]:
        """A parameter undeformed, elastic and plastic, with all harmonics."""
        return [self.last("elastic", f"{key}_undeformed"), *(self.last(kind, f"{key}_loaded") for kind in KINDS)]

    def spread(self, key: str) -> float:
        """Largest less smallest of the three."""
        return max(self.states(key)) - min(self.states(key))

    def part(self, key: str) -> float:
        """The spread over the undeformed value."""
        return self.spread(key) / abs(self.states(key)[0])


def pair(values: tuple[int, ...]) -> str:
    """Elastic and plastic."""
    return f"{values[0]} elastic, {values[1]} plastic"


def areas(cut: Cut) -> str:
    """The n of the contact areas."""
    return pair(tuple(cut.area(kind) for kind in KINDS))


def near(cut: Cut, key: str) -> bool:
    """Whether a parameter needs half to twice the harmonics of the contact area, with both materials."""
    return all(0.5 <= n / cut.area(kind) <= 2 for kind, n in zip(KINDS, cut.counts(key)[key], strict=True))


def beside_area(cut: Cut, *keys: str) -> str:
    """The n of parameters beside those of the area."""
    return "; ".join(f"{key}: {pair(values)}" for key, values in cut.counts(*keys).items()) + f"; area: {areas(cut)}"


def states_of(cut: Cut, *keys: str) -> str:
    """The three values of some parameters."""
    units = {"ra": 1e6, "rz": 1e6}
    return "; ".join(f"{key}: " + ", ".join(f"{value * units.get(key, 1):.3f}" for value in cut.states(key)) for key in keys)


def depth(cut: Cut) -> float:
    """Largest plastic deformation [um]."""
    return 1e6 * cut.last("plastic", "dp_max")


STATEMENTS: list[Statement[Cut]] = [
    Statement(
        "4.2, Fig. 4.1",
        "The plastic deformation is about 0.5 µm deep",
        "0.4 to 0.6 µm",
        lambda cut: abs(depth(cut) - DEPTH) <= 0.1,
        lambda cut: f"{depth(cut):.3f} ± {1e6 * cut.last('plastic', 'dp_max_error'):.3f} µm",
    ),
    Statement(
        "4.3, Fig. 4.2",
        "The elastic contact area is constant from n = 75 on",
        "10 % reached between 50 and 112",
        lambda cut: ELASTIC / 1.5 <= cut.area("elastic") <= ELASTIC * 1.5,
        areas,
    ),
    Statement(
        "4.3, Fig. 4.2",
        "The elasto-plastic contact area is constant from n = 50 on",
        "10 % reached between 33 and 75",
        lambda cut: PLASTIC / 1.5 <= cut.area("plastic") <= PLASTIC * 1.5,
        areas,
    ),
    Statement(
        "4.3, Fig. 4.2",
        "The elastic area needs more harmonics than the elasto-plastic one",
        "n for 10 %",
        lambda cut: cut.area("elastic") > cut.area("plastic"),
        areas,
    ),
    Statement(
        "4.3, Fig. 4.3",
        "Ra undeformed and elastic are about the same, the elasto-plastic one deviates little, but visibly",
        "below 5 %, and 2 to 10 %, farther than the elastic one; undeformed, elastic, plastic in µm",
        lambda cut: deviations(cut)[0] < 0.05 and 0.02 <= deviations(cut)[1] <= 0.1 and deviations(cut)[1] > deviations(cut)[0],
        lambda cut: states_of(cut, "ra"),
    ),
    Statement(
        "4.3, Fig. 4.3",
        "Ra converges about as the area",
        "half to twice the n for 10 %",
        lambda cut: near(cut, "ra"),
        lambda cut: beside_area(cut, "ra"),
    ),
    Statement(
        "4.3, Fig. 4.4",
        "Rz needs more harmonics than Ra",
        "n for 10 %, elastic and plastic",
        lambda cut: all(a > b for a, b in zip(*cut.counts("rz", "ra").values(), strict=True)),
        lambda cut: beside_area(cut, "rz", "ra"),
    ),
    Statement(
        "4.3",
        "All parameters are predicted with n < N/2 - 1",
        "area, Ra, Rz, Rk to 10 %, Rsk to 0.1 with fewer than 255",
        lambda cut: (
            max(n for values in cut.counts("ra", "rz", "rsk", "rku").values() for n in values) < LIMIT
            and max(cut.area(kind) for kind in KINDS) < LIMIT
        ),
        lambda cut: beside_area(cut, "ra", "rz", "rsk", "rku"),
    ),
    Statement(
        "4.4, conclusion 1",
        "The high frequency content has a negligible influence on the contact area",
        "10 % reached with half of the 255 harmonics",
        lambda cut: max(cut.area(kind) for kind in KINDS) <= LIMIT // 2,
        areas,
    ),
    Statement(
        "4.4, conclusion 2",
        "Ra converges for n < N/2 - 1, with a larger n than the contact area",
        "n for 10 %, elastic and plastic",
        lambda cut: all(n > cut.area(kind) for kind, n in zip(KINDS, cut.counts("ra")["ra"], strict=True)),
        lambda cut: beside_area(cut, "ra"),
    ),
    Statement(
        "4.4, conclusion 3",
        "Rz follows Ra, but with a larger spread between undeformed, elastic and elasto-plastic",
        "spread over the undeformed value; undeformed, elastic, plastic in µm",
        lambda cut: cut.part("rz") > cut.part("ra"),
        lambda cut: states_of(cut, "rz", "ra"),
    ),
    Statement(
        "4.4, conclusion 4",
        "Rsk and Rk converge about as the contact area",
        "half to twice the n (Rk 10 %, Rsk 0.1)",
        lambda cut: near(cut, "rsk") and near(cut, "rku"),
        lambda cut: beside_area(cut, "rsk", "rku"),
    ),
    Statement(
        "4.4, conclusion 4",
        "The spread is larger for the skewness than for the kurtosis",
        "difference of undeformed, elastic and plastic",
        lambda cut: cut.spread("rsk") > cut.spread("rku"),
        lambda cut: states_of(cut, "rsk", "rku"),
    ),
]


def deviations(cut: Cut) -> tuple[float, float]:
    """How far the elastic and the plastic Ra lie from the undeformed one."""
    start, elastic, plastic = cut.states("ra")
    return abs(elastic / start - 1), abs(plastic / start - 1)


def judge(given: Cut, draws: list[Cut], short: bool) -> Statements:
    """All statements for profile D and its realisations; `short`: few harmonics and draws."""
    table = Statements("numbers of stand-in D", short)
    table.judge_all(STATEMENTS, {"stand_ins": given}, draws)
    return table

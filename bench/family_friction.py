"""Friction and power: smooth contacts of both rheologies over the stated range, on grids chosen and given, and passages."""

from __future__ import annotations

import random
from collections.abc import Callable

import namelists
from families import Family, Member
from family_waves import moving_wave, true_passage

QUANTITIES = ("summary/friction_coefficient", "summary/rolling_friction_coefficient", "summary/rolling_power")
# Intervals and inlet of the truth: fine and, with the tail, far enough for all of them.
FINE = {"intervals": 2**15, "inlet": "tail", "x_inlet": -60.0, "x_outlet": 3.0}
NO_BARS = {"error_bars": False}


def smooth(
    moes: tuple[float, float], oils: Callable[[random.Random], float | None], domains: Callable[[random.Random], dict]
) -> Callable[[random.Random, int], list[Member]]:
    """Steel and mineral oil with log10 M between `moes`, L 3 to 20, sliding, at random; the truth has a long inlet of its own."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            m, l = 10 ** source.uniform(*moes), source.uniform(3, 20)  # noqa: E741
            groups = namelists.steel(m, l, source.choice((-1, 1)) * source.uniform(0.02, 1.8), oils(source))
            groups["domain"] = domains(source)
            truth = groups | {"domain": FINE, "accuracy": NO_BARS}
            found.append(Member(f"{i:03d}", namelists.namelist(groups), namelists.namelist(truth)))
        return found

    return draw


def eyring(source: random.Random) -> float:
    """An Eyring stress [Pa]."""
    return 10 ** source.uniform(6.0, 7.5)


def newtonian(source: random.Random) -> None:
    """No Eyring stress."""
    source.random()


def either(source: random.Random) -> float | None:
    """One or the other."""
    return eyring(source) if source.random() < 0.5 else newtonian(source)


def chosen(_: random.Random) -> dict:
    """The domain of the program."""
    return {}


def given(source: random.Random) -> dict:
    """A window like that of the thesis, or a longer one."""
    return {"x_inlet": -source.uniform(3.0, 12.0), "x_outlet": 2.0, "intervals": 2 ** source.randint(8, 11)}


def passing(source: random.Random, count: int) -> list[Member]:
    """Waves that pass, on the domain, grid and step of the program."""
    found = []
    for i in range(count):
        wave = moving_wave(source)
        found.append(Member(f"{i:03d} {wave.kind}", wave.namelist({}, time=wave.time(None)), true_passage(wave)))
    return found


FAMILIES = [
    Family("friction_eyring", "Friction, Eyring oil, chosen domain and grid", QUANTITIES, smooth((-0.5, 2.5), eyring, chosen)),
    Family("friction_newton", "Friction, Newton's oil, chosen domain and grid", QUANTITIES, smooth((-0.5, 1.5), newtonian, chosen)),
    Family("friction_given", "Friction, both oils, given domain and grid", QUANTITIES, smooth((0.3, 2.0), either, given)),
    Family("friction_time", "Friction over a passage, chosen domain, grid and step", QUANTITIES, passing, 12),
]

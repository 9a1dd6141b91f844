"""The largest pressure: spikes that the grid does not resolve, over the whole (M, L) range, on chosen and given grids, and in time.

Smooth contacts with Barus' and Roelands' law, incompressible and not, and light Eyring oils. The truth has dX so small that a
spike which ends is resolved or nearly so, and an inlet several times as
far out as the program puts one. Passages of features and waves are compared with eight times the intervals and steps on the same
domain: what is judged is `error_grid`.
"""

from __future__ import annotations

import math
import random

import namelists
from families import Family, Member
from passages import passages

P_MAX = ("summary/p_max",)
NO_BARS = {"error_bars": False}
LAWS = tuple({"viscosity_law": v, "density_law": d} for v in ("barus", "roelands") for d in ("constant", "dowson_higginson"))
# Intervals of the truth: spikes, of which loads above M = 1 are in danger, need many, light contacts a long domain.
FINE, LIGHT = 2**16, 2**15
# Inlet in units of sqrt(2 H_c) in front of X = -1, and the farthest that the program takes.
REACH, FARTHEST = 40, 1000.0


def far_inlet(m: float, l: float) -> float:  # noqa: E741
    """X of an inlet that starves nothing: from a rough film H_c of a contact (M, L with the speed sum)."""
    film = (2.45 / m + 1.3 * m**-0.125 * l**0.75 + 2.6 * m**-0.2) * math.pi / (8 * m)
    light = 1 + 3 / m
    return -min(1 + REACH * light * math.sqrt(2 * film), FARTHEST)


def contact(source: random.Random, i: int) -> tuple[dict, dict]:
    """The groups of a contact without its domain, and the domain of the truth."""
    if i % 6 < 4:
        m, l = 10 ** source.uniform(-0.5, 3.2), source.uniform(0.5, 35)  # noqa: E741
        groups = {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}, "lubricant": LAWS[i % 6]}
    else:
        m, l = 10 ** source.uniform(0, 2.9), source.uniform(3, 30)  # noqa: E741
        groups = namelists.steel(m, l, source.uniform(0.05, 2), 10 ** source.uniform(6.5, 9))
    outlet = max(1.5, 3 * math.sqrt(1 / m))
    fine = {"intervals": FINE if m > 1 else LIGHT, "inlet": "zero", "x_inlet": far_inlet(m, l), "x_outlet": outlet}
    return groups, fine


def member(i: int, groups: dict, domain: dict, fine: dict) -> Member:
    """A contact on a domain beside its truth."""
    truth = groups | {"domain": fine, "accuracy": NO_BARS}
    return Member(f"{i:03d}", namelists.namelist(groups | {"domain": domain}), namelists.namelist(truth))


def chosen(source: random.Random, count: int) -> list[Member]:
    """On the domain and grid that the program chooses."""
    contacts = [contact(source, i) for i in range(count)]
    return [member(i, groups, {}, fine) for i, (groups, fine) in enumerate(contacts)]


def given(source: random.Random, count: int) -> list[Member]:
    """On given grids of 64 to 4096 intervals."""
    found = []
    for i in range(count):
        groups, fine = contact(source, i)
        found.append(member(i, groups, {"intervals": 2 ** source.randint(6, 12)}, fine))
    return found


def in_time(source: random.Random, count: int) -> list[Member]:
    """Passages with both schemes, given grid and step."""
    found = []
    for i, case in enumerate(passages(count, source.randint(100, 10**6))):
        n = (128, 256)[i % 2]
        scheme = ("bdf2", "backward_euler")[i // 2 % 2]
        truth = case.namelist(8 * n, 1, accuracy=NO_BARS)
        found.append(Member(f"{i:03d}_{n}_{scheme}_{case.name}", case.namelist(n, 1, time={"scheme": scheme}), truth))
    return found


FAMILIES = [
    Family("pressure", "Largest pressure, chosen grids", P_MAX, chosen, count=60),
    Family("pressure_grids", "Largest pressure, given grids of 64 to 4096 intervals", P_MAX, given, count=60),
    Family("pressure_in_time", "Largest pressure of passages", P_MAX, in_time, count=40, estimate="error_grid"),
]

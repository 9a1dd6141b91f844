"""The kappa space scheme at pressure spikes; and contacts of wide ranges with the default solver.

Heavy contacts on given grids by the kappa scheme are judged by the thesis's on many more intervals of the same domain. Wide
contacts are heavy, fast and slide far (M to 3000, L to 60, tau_0 0.5 to 20 MPa, slide-to-roll ratios to 20). Stiff ones have
Barus' oil with alpha p_h of 31 to 259, where every grid has a spike that it does not resolve beside the smallest film.
"""

from __future__ import annotations

import math
import random

import namelists
from families import Family, Member
from family_domain import width

NO_BARS = {"error_bars": False}
LAWS = tuple({"viscosity_law": v, "density_law": d} for v in ("barus", "roelands") for d in ("constant", "dowson_higginson"))
# Intervals of the truth of a spike.
SPIKE_FINE = 2**17
FILMS = ("summary/h_min", "summary/h_central")
# The least film of the heaviest needs so many.
FINE = 2**18
# Wanted accuracy of stiff contacts; None: the program's grid.
TARGETS = (None, 0.01, 0.003)


def spiked(source: random.Random, count: int) -> list[Member]:
    """Heavy contacts on given grids, by the kappa scheme."""
    found = []
    for i in range(count):
        m, l, n = 10 ** source.uniform(1.3, 3), source.uniform(5, 30), source.choice((512, 1024, 2048, 4096))  # noqa: E741
        moes = {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}, "lubricant": LAWS[i % 4]}
        groups = moes | {"domain": namelists.WINDOW | {"intervals": n}, "solver": {"space_scheme": "kappa"}}
        truth = moes | {"domain": namelists.WINDOW | {"intervals": SPIKE_FINE}, "accuracy": NO_BARS}
        found.append(Member(f"{i:03d}", namelists.namelist(groups), namelists.namelist(truth)))
    return found


def wide(source: random.Random, count: int) -> list[Member]:
    """Contacts in SI, three of four with Eyring's law, on the domain and grid that the program chooses."""
    found = []
    for i in range(count):
        m, l = 10 ** source.uniform(0.5, 3.5), source.uniform(2, 60)  # noqa: E741
        stress = 10 ** source.uniform(5.7, 7.3) if i % 4 else None
        groups = namelists.steel(m, l, 10 ** source.uniform(-1.3, 1.3), stress)
        groups["lubricant"] |= LAWS[source.randrange(4)]
        if groups["lubricant"]["viscosity_law"] == "barus":
            del groups["lubricant"]["roelands_p0"]
        s = width(m, l)
        fine = {"intervals": FINE, "inlet": "tail", "x_inlet": -(1 + 16 * s), "x_outlet": 1 + max(0.75 * s, 1.0)}
        truth = groups | {"domain": fine, "accuracy": NO_BARS}
        found.append(Member(f"{i:03d}", namelists.namelist(groups), namelists.namelist(truth)))
    return found


def stiff(source: random.Random, count: int) -> list[Member]:
    """Barus' oil, dense or not, on domain and grid of the program, two of three with a target."""
    found = []
    for i in range(count):
        rise, l = 31 * (259 / 31) ** source.random(), source.uniform(10, 30)  # noqa: E741
        m = 2 * math.pi * (rise / l) ** 2  # alpha p_h = L sqrt(M/(2 pi))
        groups = {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}, "lubricant": LAWS[i % 2]}
        s = width(m, l)
        fine = {"intervals": FINE, "inlet": "tail", "x_inlet": -(1 + 16 * s), "x_outlet": 1 + max(0.75 * s, 0.5)}
        truth = groups | {"domain": fine, "accuracy": NO_BARS}
        groups["accuracy"] = {"target": TARGETS[i // 2 % 3]}
        found.append(Member(f"{i:03d}", namelists.namelist(groups), namelists.namelist(truth)))
    return found


FAMILIES = [
    Family("kappa_spikes", "Spikes by the kappa scheme, given grids", (*FILMS, "summary/p_max"), spiked, 96, estimate="error_grid"),
    Family("wide", "Heavy, fast and sliding contacts, chosen domain and grid", FILMS, wide),
    Family("stiff", "Barus' oil at high pressures, chosen domain and grid, targets", FILMS, stiff, 48),
]

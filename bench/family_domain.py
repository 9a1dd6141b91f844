"""Domains: outlets ahead of film rupture, inlets inside the pressure build-up, tails, and what the program chooses by itself.

The truth of a given domain has the grid spacing of the member and a domain several times as long, so that the error of the grid
cancels: `error_domain` is judged alone. Where the program chooses, the truth has 2^16 intervals besides, and the whole error is
judged.
"""

from __future__ import annotations

import math
import random

import namelists
from families import Family, Member

FILMS = ("summary/h_min", "summary/h_central")
DOMAIN = "error_domain"
NO_BARS = {"error_bars": False}
FARTHEST = 1000.0
NEWTONIAN = (("barus", "constant"), ("roelands", "dowson_higginson"), ("constant", "constant"))
OILS = (("barus", "constant"), ("roelands", "dowson_higginson"), ("barus", "dowson_higginson"), ("roelands", "constant"))


def log_uniform(source: random.Random, low: float, high: float) -> float:
    """Evenly in the logarithm."""
    return 10 ** source.uniform(math.log10(low), math.log10(high))


def contact(source: random.Random, is_eyring: bool, lightest: float, heaviest: float) -> tuple[float, float, dict]:
    """M, L and groups of a contact: M to `heaviest`, L to 40; Eyring stress 0.5 to 20 MPa, slide-to-roll 0 to 4."""
    m, l = log_uniform(source, lightest, heaviest), source.uniform(1, 40)  # noqa: E741
    if is_eyring:
        l = max(l, 2.0)  # noqa: E741
        return m, l, namelists.steel(m, l, source.uniform(0, 4), log_uniform(source, 0.5e6, 20e6))
    law, density = source.choice(NEWTONIAN)
    l = 0.0 if law == "constant" else l  # noqa: E741
    return (
        m,
        l,
        {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}, "lubricant": {"viscosity_law": law, "density_law": density}},
    )


def width(m: float, l: float) -> float:  # noqa: E741
    """S = sqrt(2 H_c) of a rough fit of the Newtonian film [half-widths]."""
    film = ((2.45 / m) ** 1.5 + (1.3 * l**0.75 * m**-0.12) ** 1.5) ** (1 / 1.5) if l > 0 else (2.45 / m + 3.1 * m**-0.2)
    return math.sqrt(2 * film * math.pi / (8 * m))


def member(name: str, groups: dict, domain: dict, truth: dict) -> Member:
    """A member on its domain, with the truth on a longer one."""
    exact = groups | {"domain": truth, "accuracy": NO_BARS}
    return Member(name, namelists.namelist(groups | {"domain": domain}), namelists.namelist(exact))


def given_outlets(source: random.Random, count: int) -> list[Member]:
    """From far ahead of rupture to far behind it, light to heavy loads; the truth lies on the same nodes, and twice as many."""
    found = []
    for i in range(count):
        m, l, groups = contact(source, i % 2 == 1, 0.05, 30)  # noqa: E741
        s = width(m, l)
        outlet, inlet = 1 + s * log_uniform(source, 0.05, 2), -(1 + 20 * s)
        inlet, n = max(inlet, -450.0), 8192
        common = {"x_inlet": inlet, "inlet": "tail"}
        domain = common | {"x_outlet": outlet, "intervals": n}
        truth = common | {"x_outlet": 2 * outlet - inlet, "intervals": 2 * n}
        found.append(member(f"{i:03d} M {m:.3g} L {l:.3g}", groups, domain, truth))
    return found


def chosen(source: random.Random, count: int) -> list[Member]:
    """The whole domain and grid left open, over the whole range."""
    found = []
    for i in range(count):
        m, l, groups = contact(source, i % 3 > 0, 0.02, 300)  # noqa: E741
        s = width(m, l)
        truth = {"inlet": "tail", "x_inlet": max(-(1 + 16 * s), -900.0), "x_outlet": 1 + max(0.75 * s, 1.0), "intervals": 2**16}
        found.append(member(f"{i:03d} M {m:.3g} L {l:.3g}", groups, {}, truth))
    return found


def light_eyring(source: random.Random, count: int) -> list[Member]:
    """M below 1 with low Eyring stress, domain left open: the slope of the pressure in front of the inlet thins the oil."""
    found = []
    for i in range(count):
        m, l = log_uniform(source, 0.05, 1), source.uniform(10, 40)  # noqa: E741
        groups = namelists.steel(m, l, log_uniform(source, 0.1, 20), log_uniform(source, 0.5e6, 2e6))
        s = width(m, l)
        truth = {"inlet": "tail", "x_inlet": max(-(1 + 16 * s), -900.0), "x_outlet": 1 + 0.75 * s, "intervals": 2**16}
        found.append(member(f"{i:03d} M {m:.3g} L {l:.3g}", groups, {}, truth))
    return found


def extreme(source: random.Random, count: int) -> list[Member]:
    """Domain and grid left open where all is extreme: M 0.01 to 5000, L to 60, slide-to-roll to 20; half of them with Eyring's
    law.
    """
    found = []
    for i in range(count):
        m, l = log_uniform(source, 0.01, 5000), source.uniform(2, 60)  # noqa: E741
        is_eyring = i % 2 == 1
        slide, stress = log_uniform(source, 0.1, 20), log_uniform(source, 0.5e6, 20e6)
        groups = namelists.steel(m, l, slide, stress if is_eyring else None)
        law, density = source.choice(OILS)
        groups["lubricant"] |= {"viscosity_law": law, "density_law": density}
        if law == "barus":
            del groups["lubricant"]["roelands_p0"]
        s = width(m, l)
        truth = {"inlet": "tail", "x_inlet": max(-(1 + 16 * s), -900.0), "x_outlet": 1 + max(0.75 * s, 1.0), "intervals": 2**17}
        found.append(member(f"{i:03d} M {m:.3g} L {l:.3g}", groups, {}, truth))
    return found


def given_inlets(source: random.Random, count: int, inlet: str) -> list[Member]:
    """A given inlet from inside the pressure build-up to far out; the truth at the same spacing, eight times as long."""
    found = []
    for i in range(count):
        m, l, groups = contact(source, i % 4 > 0, 0.1, 30)  # noqa: E741
        s = width(m, l)
        start, outlet = -(1 + s * log_uniform(source, 1.5, 30 if inlet == "zero" else 6)), 1 + max(0.75 * s, 1.0)
        n, factor = 4096, 8
        far = outlet - factor * (outlet - start)
        while far < -FARTHEST:
            factor //= 2
            far = outlet - factor * (outlet - start)
        domain = {"inlet": inlet, "x_inlet": start, "x_outlet": outlet, "intervals": n}
        truth = {"inlet": "tail", "x_inlet": far, "x_outlet": outlet, "intervals": factor * n}
        found.append(member(f"{i:03d} M {m:.3g} L {l:.3g}", groups, domain, truth))
    return found


def zero_inlets(source: random.Random, count: int) -> list[Member]:
    """Without pressure at the inlet."""
    return given_inlets(source, count, "zero")


def tail_inlets(source: random.Random, count: int) -> list[Member]:
    """With the tail in front."""
    return given_inlets(source, count, "tail")


FAMILIES = [
    Family("outlet", "Given outlets, from far ahead of film rupture to far behind it", FILMS, given_outlets, 30, DOMAIN),
    Family("open", "Domain and grid chosen by the program", (*FILMS, "summary/p_central"), chosen, 40),
    Family("open_light", "The same, light loads and low Eyring stress", FILMS, light_eyring, 24),
    Family("extreme", "The same where load, oil, sliding and stress are extreme", ("summary/h_min",), extreme, 24),
    Family("zero_inlet", "Given inlets without pressure, mostly Eyring", FILMS, zero_inlets, 40, DOMAIN),
    Family("tail_inlet", "Given inlets with a tail in front, mostly Eyring", FILMS, tail_inlets, 40, DOMAIN),
]

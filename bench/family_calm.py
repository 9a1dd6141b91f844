"""Ordinary contacts: smooth, over the stated range, on the domain and grid that the program chooses."""

from __future__ import annotations

import random

import namelists
from families import Family, Member

FIGURES = ("summary/h_min", "summary/h_central", "summary/p_max", "summary/p_central")
# Intervals and inlet of the truth: fine and, with the tail, far enough for all of them.
FINE = {"intervals": 2**15, "inlet": "tail"}


def smooth(source: random.Random, count: int) -> list[Member]:
    """Steel and mineral oil, load and speed at random; the truth has a long inlet of its own."""
    found = []
    for i in range(count):
        m, l = 10 ** source.uniform(0.3, 2.5), source.uniform(3, 20)  # noqa: E741
        groups = namelists.steel(m, l, source.uniform(0, 1.5), 10 ** source.uniform(6.5, 7.5))
        truth = groups | {"domain": FINE | {"x_inlet": -60.0, "x_outlet": 3.0}, "accuracy": {"error_bars": False}}
        found.append(Member(f"{i:03d}", namelists.namelist(groups), namelists.namelist(truth)))
    return found


FAMILIES = [Family("calm", "Smooth contacts, chosen domain and grid", FIGURES, smooth)]

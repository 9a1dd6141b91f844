"""Passages for a wanted accuracy: grid, time step and scheme in space chosen by pilot runs, and the error bars that they foretell.

Passages of features, waves and roughness that begin in front of the contact, those of family_pressure.py. The truth has the same
domain, 1536 or 2048 intervals and dT = dX, so that `error_grid` is judged. Whether the target was met is not.
"""

from __future__ import annotations

import random

from families import Family, Member
from family_pressure import NO_BARS, SLIDES, SLIDES_BOTH, Whole
from passages import KINDS, OILS

FIGURES = ("summary/h_min", "summary/h_central", "summary/p_max")
TARGETS = (0.01, 0.02, 0.05)


def passages(source: random.Random, count: int) -> list[tuple[Whole, float]]:
    """Passages with the target of each; the waves are so long that the fine grid has 60 nodes in each at least."""
    found = []
    for i in range(count):
        kind = KINDS[i % len(KINDS)]
        slide = source.choice(SLIDES_BOTH if kind == "overtaking" else SLIDES)
        load, oil = 10 ** source.uniform(-0.6, 0.6), source.choice(tuple(OILS))
        height, nodes = source.uniform(0.1, 0.6), 2 ** source.uniform(5.05, 6.5)
        intervals = (192, 256)[i % 2]
        found.append((Whole(kind, load, slide, oil, height, nodes, intervals, "bdf2", i), TARGETS[i // 2 % 3]))
    return found


def members(source: random.Random, count: int) -> list[Member]:
    """Each beside its truth on eight times the intervals of the family's unit."""
    found = []
    for i, (case, target) in enumerate(passages(source, count)):
        accuracy = {"target": target}
        free = {"time_step": None, "scheme": "bdf2", "transient": True, "end_time": case.end_time}
        text = case.namelist(1, domain=case.domain | {"intervals": None}, time=free, accuracy=accuracy)
        truth = case.namelist(8, accuracy=NO_BARS)
        found.append(Member(f"{i:03d}_{target}_{case.kind}", text, truth))
    return found


FAMILIES = [Family("target_in_time", "A target in time: error bars", FIGURES, members, count=24, estimate="error_grid")]

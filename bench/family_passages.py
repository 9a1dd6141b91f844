"""Passages of rough surfaces through a contact like Case 1: fixed samples, and random ones with a given domain or a target.

The rules of the error estimates were fitted on the fitted sample; the fresh one was drawn afterwards and judges them. Random ones
have eight times the intervals and steps in the truth: `error_grid` is judged.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, replace

from family_steady import Draw
from judge import Member
from namelists import CASE_1, CASE_1_FILM, CASE_1_HALF_WIDTH, NO_BARS, WINDOW, Groups, merged

MEAN_SPEED = 0.6
SLIDES = (-1.9, -1.0, -0.3, 0.0, 0.3, 1.0, 5 / 3, 1.9, 2.0, 2.5, 4.0)
# Those with which the second surface, or both, go through the contact in a short time.
PASSING, BOTH_PASSING = (-1.0, -0.3, 0.0, 0.3, 1.0, 5 / 3, 1.9, 2.5, 4.0), (-1.0, -0.3, 0.0, 0.3, 1.0)
LOADS = (0.1, 0.3, 1.0, 2.0, 4.0)
OILS = {"newtonian": None, "10 MPa": 10e6, "3.3 MPa": 3.3e6}
KINDS = ("ridge", "dent", "ridges", "overtaking", "waviness", "roughness")
LONGEST = 3.0
# H_c of Case 1; wanted accuracies.
CASE_1_H, TARGETS = 0.469, (0.01, 0.02, 0.05)


@dataclass(frozen=True)
class Passage:
    """One case: load over that of Case 1, sliding, oil, surfaces; heights over the film of Case 1, lengths over its half-width."""

    kind: str
    load: float
    slide: float
    oil: str
    height: float
    wave: float
    seed: int

    def speed(self, surface: int) -> float:
        """Speed of a surface over the mean, dX/dT."""
        return 1 + (self.slide / 2 if surface == 2 else -self.slide / 2)

    def groups(self, places: dict[int, float], heights: dict[int, float], waves: tuple[float, float, float]) -> Groups:
        """Its groups without grid and time: places of features by surface, heights where one overtakes, waves of roughness."""
        half_width = CASE_1_HALF_WIDTH * self.load**0.5
        height, wave = self.height * CASE_1_FILM, self.wave * half_width
        feature = {"shape": "feature", "wavelength": wave}
        if self.kind == "waviness":
            surfaces = {"surface_2": {"shape": "sinusoid", "amplitude": 0.5 * height, "wavelength": wave}}
        elif self.kind == "roughness":
            rough = {"shape": "synthetic", "rms_height": 0.3 * height, "seed": self.seed, "hurst": 0.8}
            names = ("wavelength_long", "wavelength_rolloff", "wavelength_short")
            surfaces = {"surface_2": rough | {name: each * half_width for name, each in zip(names, waves, strict=True)}}
        elif self.kind == "overtaking":
            surfaces = {
                f"surface_{k}": feature | {"amplitude": height * part, "position": places[k]} for k, part in heights.items()
            }
        else:
            own = [places[2], places[2] - 0.8] if self.kind == "ridges" else [places[2]]
            count, sign = len(own), -1 if self.kind == "dent" else 1
            surfaces = {
                "surface_2": feature | {"amplitude": [sign * height] * count, "wavelength": [wave] * count, "position": own}
            }
        stress = OILS[self.oil]
        oil = {"rheology": "newtonian", "eyring_stress": None} if stress is None else {"eyring_stress": stress}
        speeds = {f"speed_{k}": MEAN_SPEED * self.speed(k) for k in (1, 2)}
        return merged(CASE_1, bodies=speeds, load={"load_per_length": 1e5 * self.load}, lubricant=oil, **surfaces)

    def on_grid(self, intervals: int | None, step_over_dx: float | None = None, **others: dict) -> Groups:
        """Its groups in the window of the thesis, until the faster surface has passed.

        Features stand 1.5 half-widths before the middle, less for a slow one, on the side they come from. The step is
        `step_over_dx` times 5.5/intervals, so that it does not depend on the domain that is chosen.
        """
        end = min(3.0 / max(abs(self.speed(2)), abs(self.speed(1))), LONGEST)
        ways = {k: self.speed(k) * end for k in (1, 2)}
        places = {k: -max(min(way, 1.5), -1.5) if abs(way) > 0.5 else -0.4 for k, way in ways.items()}
        # From T = 0: the estimates are judged over the whole passage, the start included.
        time = {"transient": True, "end_time": end, "statistics_from": 0.0}
        if step_over_dx is not None:
            time |= {"time_step": step_over_dx * 5.5 / intervals, "end_time": max(2, round(end * 256 / 5.5 / 4)) * 4 * 5.5 / 256}
        groups = self.groups(places, {1: 1.0, 2: -0.7}, (2, 1, 0.4))
        return merged(merged(groups, domain=WINDOW | {"intervals": intervals}, time=time), **others)

    def whole(self, intervals: int, scheme: str) -> Callable[..., Groups]:
        """Makes the groups with so many times the intervals and steps; the wave of the passage is that many spacings.

        It begins in front of the contact, and ends when all features have left, or waves and roughness have entered and settled.
        """
        reach = math.sqrt(2 * CASE_1_H * self.load**-1.1)  # S = sqrt(2 H_c), about
        domain = {"x_inlet": -max(4.0, 1 + 3.5 * reach), "x_outlet": 1.5 + 0.5 * reach}
        dx = (domain["x_outlet"] - domain["x_inlet"]) / intervals
        length = self.wave * dx
        places = {k: -math.copysign(1 + reach + 0.5 * length, self.speed(k)) for k in (1, 2)}
        slowest = self.speed(2) if self.kind != "overtaking" else min(self.speed(1), self.speed(2))
        end = (3 + reach + 2 * length) / slowest
        if self.kind in ("waviness", "roughness"):
            end = 2 * (2 + reach) + (4 * length + 4 + reach) / self.speed(2)

        def finer(factor: int, **others: dict) -> Groups:
            time = {"transient": True, "end_time": end, "time_step": dx / factor, "scheme": scheme}
            groups = replace(self, wave=length).groups(places, {2: 1.0, 1: -0.7}, (4 * length, 2 * length, length))
            return merged(groups, domain=domain | {"intervals": factor * intervals}, time=time, **others)

        return finer


def passages(count: int, seed: int = 1) -> list[Passage]:
    """`count` cases; all kinds, slides, loads and oils come equally often."""
    source = random.Random(seed)
    columns = []
    for values in (KINDS, LOADS, SLIDES, tuple(OILS)):
        column = [values[i % len(values)] for i in range(count)]
        source.shuffle(column)
        columns.append(column)
    found = []
    for i, (kind, load, slide, oil) in enumerate(zip(*columns, strict=True)):
        height, wave = round(source.uniform(0.1, 0.6), 2), round(source.uniform(0.5, 1.5), 2)
        found.append(Passage(kind, load, slide, oil, height, wave, i))
    return found


def pressure_in_time(source: random.Random, i: int) -> Member:
    """Whole passages with both schemes, on given grids with dT = dX that resolve every wave."""
    kind, load, oil = KINDS[i % len(KINDS)], 10 ** source.uniform(-0.6, 0.6), source.choice(tuple(OILS))
    slide = source.choice(BOTH_PASSING if kind == "overtaking" else PASSING)
    height, nodes = source.uniform(0.1, 0.6), 2 ** source.uniform(5.05, 7)
    case = Passage(kind, load, slide, oil, height, nodes, i).whole((256, 512)[i // 2 % 2], ("bdf2", "backward_euler")[i % 2])
    return Member(case(1), case(8, accuracy=NO_BARS))


def target_in_time(source: random.Random, i: int) -> Member:
    """Grid and step chosen by trial runs, and the error bars of the result; the target is not judged."""
    kind = KINDS[i % len(KINDS)]
    slide = source.choice(BOTH_PASSING if kind == "overtaking" else PASSING)
    load, oil = 10 ** source.uniform(-0.6, 0.6), source.choice(tuple(OILS))
    height, nodes = source.uniform(0.1, 0.6), 2 ** source.uniform(5.05, 6.5)
    case = Passage(kind, load, slide, oil, height, nodes, i).whole((192, 256)[i % 2], "bdf2")
    free = merged(case(1), accuracy={"target": TARGETS[i // 2 % 3]}, domain={"intervals": None}, time={"time_step": None})
    return Member(free, case(8, accuracy=NO_BARS))


def sample(seeds: tuple[int, int], intervals: int, scheme: str) -> Draw:
    """Passages of two seeds on given grids with dT = dX; the truth is BDF2 on four times the intervals and a fourth of the step."""
    every = [case for seed in seeds for case in passages(120, seed)]

    def draw(_: random.Random, i: int) -> Member:
        case = every[i].on_grid(intervals, 1, time={"scheme": scheme})
        return Member(case, every[i].on_grid(4 * intervals, 1, accuracy=NO_BARS), name=f"{i:03d}_{every[i].kind}")

    return draw

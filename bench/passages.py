"""Passages of rough surfaces through a lubricated contact, drawn at random from the stated range, always the same ones."""

from __future__ import annotations

import random
from dataclasses import dataclass

import namelists

MEAN_SPEED = 0.6
SLIDES = (-1.9, -1.0, -0.3, 0.0, 0.3, 1.0, 5 / 3, 1.9, 2.0, 2.5, 4.0)
LOADS = (0.1, 0.3, 1.0, 2.0, 4.0)
OILS = {"newtonian": None, "10 MPa": 10e6, "3.3 MPa": 3.3e6}
KINDS = ("ridge", "dent", "ridges", "overtaking", "waviness", "roughness")
LONGEST = 3.0


@dataclass(frozen=True)
class Passage:
    """One case: load over that of Case 1, sliding, oil, surfaces; heights over the film of Case 1, lengths over its half-width."""

    name: str
    kind: str
    load: float
    slide: float
    oil: str
    height: float
    wave: float
    seed: int

    @property
    def half_width(self) -> float:
        """b [m]."""
        return namelists.CASE_1_HALF_WIDTH * self.load**0.5

    def speed(self, surface: int) -> float:
        """Speed of a surface over the mean, dX/dT."""
        return 1 + (self.slide / 2 if surface == 2 else -self.slide / 2)

    @property
    def end_time(self) -> float:
        """Until the rough surface (the faster one) has passed, T."""
        return min(3.0 / max(abs(self.speed(2)), abs(self.speed(1))), LONGEST)

    def surfaces(self) -> dict[str, dict]:
        """The groups of both surfaces; features stand where they enter, a slow one near the middle."""
        height = self.height * namelists.CASE_1_FILM
        wave = self.wave * self.half_width
        both = {}
        if self.kind in ("ridge", "dent", "ridges"):
            sign = -1 if self.kind == "dent" else 1
            positions = [self.entry(2), self.entry(2) - 0.8] if self.kind == "ridges" else [self.entry(2)]
            count = len(positions)
            shape = {"amplitude": [sign * height] * count, "wavelength": [wave] * count, "position": positions}
            both["surface_2"] = {"shape": "feature"} | shape
        elif self.kind == "overtaking":
            for i in (1, 2):
                shape = {"amplitude": height * (1 if i == 1 else -0.7), "wavelength": wave, "position": self.entry(i)}
                both[f"surface_{i}"] = {"shape": "feature"} | shape
        elif self.kind == "waviness":
            both["surface_2"] = {"shape": "sinusoid", "amplitude": 0.5 * height, "wavelength": wave}
        else:
            both["surface_2"] = {"shape": "synthetic", "rms_height": 0.3 * height, "seed": self.seed, "hurst": 0.8}
            both["surface_2"] |= {"wavelength_long": 2 * self.half_width, "wavelength_rolloff": self.half_width}
            both["surface_2"] |= {"wavelength_short": 0.4 * self.half_width}
        return both

    def entry(self, surface: int) -> float:
        """Centre of a feature at T = 0: 1.5 half-widths before the middle, less for a slow one, on the side it comes from."""
        way = self.speed(surface) * self.end_time
        return -max(min(way, 1.5), -1.5) if abs(way) > 0.5 else -0.4

    def namelist(self, intervals: int | None, step_over_dx: float | None = None, **others: dict) -> str:
        """Its text; the step is `step_over_dx` times 5.5/intervals, so that it does not depend on the domain that is chosen."""
        # From T = 0: the estimates are judged over the whole passage, the start included.
        time = {"transient": True, "end_time": self.end_time, "statistics_from": 0.0}
        if step_over_dx is not None:
            time["time_step"] = step_over_dx * 5.5 / intervals
            time["end_time"] = max(2, round(self.end_time * 256 / 5.5 / 4)) * 4 * 5.5 / 256
        stress = OILS[self.oil]
        oil = {"rheology": "newtonian", "eyring_stress": None} if stress is None else {"eyring_stress": stress}
        speeds = {f"speed_{i}": MEAN_SPEED * self.speed(i) for i in (1, 2)}
        groups = {"bodies": speeds, "load": {"load_per_length": 1e5 * self.load}, "lubricant": oil} | self.surfaces()
        groups["time"] = time | others.pop("time", {})
        return namelists.case_1(intervals, others.pop("solver", {}), **(groups | others))


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
        found.append(Passage(f"{seed}_{i:03d}_{kind}", kind, load, slide, oil, height, wave, i))
    return found

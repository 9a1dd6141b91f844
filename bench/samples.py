"""Fixed samples: steady contacts, and passages of rough surfaces through a contact like Case 1.

The rules of the error estimates were fitted on the fitted sample of each; the fresh one was drawn afterwards and judges them.
"""

from __future__ import annotations

import itertools
import random
from dataclasses import dataclass

import namelists
from namelists import CASE_1, CASE_1_FILM, CASE_1_HALF_WIDTH, LAWS, RIDGE, WINDOW, Groups, merged, plane, steel

MEAN_SPEED = 0.6
SLIDES = (-1.9, -1.0, -0.3, 0.0, 0.3, 1.0, 5 / 3, 1.9, 2.0, 2.5, 4.0)
LOADS = (0.1, 0.3, 1.0, 2.0, 4.0)
OILS = {"newtonian": None, "10 MPa": 10e6, "3.3 MPa": 3.3e6}
KINDS = ("ridge", "dent", "ridges", "overtaking", "waviness", "roughness")
LONGEST = 3.0
# Contacts of the fresh sample, and its seed.
FRESH, SEED = 224, 20261121


def contacts() -> list[tuple[str, Groups]]:
    """Newtonian contacts over the Moes plane with two oils, Eyring contacts in SI, Case 1 and its like, ridges at rest."""
    found: list[tuple[str, Groups]] = []
    loads = (0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
    for m, l in itertools.product(loads, (0, 2.5, 5, 10, 15, 20, 30)):  # noqa: E741
        found.append((f"incompressible_{m}_{l}", plane(m, l)))
        if l > 0:
            found.append((f"compressible_{m}_{l}", plane(m, l, LAWS[3])))
    heavy, oils = (1, 5, 20, 50, 100, 200, 500), (5, 10, 20, 30)
    for m, l, sliding in itertools.product(heavy, oils, ((0.5, 5e6), (1.0, 3.3e6), (2.0, 1.5e6))):  # noqa: E741
        found.append((f"eyring_{m}_{l}_{sliding[0]}", steel(m, l, *sliding)))
    for stress, factor in itertools.product((1e6, 3.3e6, 1e7), (0.5, 1, 2)):
        speeds = {"speed_1": 0.1 * factor, "speed_2": 1.1 * factor}
        groups = merged(CASE_1, bodies=speeds, lubricant={"eyring_stress": stress})
        found.append((f"case1_{stress:g}_{factor}", groups))
    for height, place in itertools.product((1e-7, 2e-7), (-1.0, 0.0, 0.5)):
        ridge = RIDGE | {"position": place, "amplitude": height}
        found.append((f"ridge_{height:g}_{place}", merged(CASE_1, bodies={"speed_1": 0.0}, surface_1=ridge)))
    return found


def fresh_contacts(count: int = FRESH, seed: int = SEED) -> list[tuple[str, Groups]]:
    """Contacts drawn at random from the stated range: what the rules of the estimates were not fitted on."""
    source = random.Random(seed)
    found = []
    for i in range(count):
        m, l = 10 ** source.uniform(-1, 3), source.uniform(0.5, 30)  # noqa: E741
        kind = ("moes", "moes", "moes", "eyring", "eyring", "case1", "ridge")[i % 7]
        if kind == "moes":
            groups = plane(m, l, LAWS[i // 7 % 4])
        elif kind == "eyring":
            m, l = 10 ** source.uniform(0, 2.7), source.uniform(3, 30)  # noqa: E741
            groups = steel(m, l, source.uniform(0.1, 2), 10 ** source.uniform(6, 7.3))
        else:
            speed, load = 10 ** source.uniform(-0.5, 0.5), 1e5 * 10 ** source.uniform(-1, 0.5)
            changes = {"bodies": {"speed_1": 0.1 * speed, "speed_2": 1.1 * speed}, "load": {"load_per_length": load}}
            changes["lubricant"] = {"eyring_stress": 10 ** source.uniform(6, 7.3)}
            if kind == "ridge":
                changes["bodies"]["speed_1"] = 0.0
                ridge = {"position": source.uniform(-1.2, 0.8), "amplitude": source.uniform(-2e-7, 2e-7)}
                changes["surface_1"] = RIDGE | ridge | {"wavelength": source.uniform(0.5e-4, 2e-4)}
            groups = merged(CASE_1, **changes)
        found.append((f"fresh_{i:03d}_{kind}", groups))
    return found


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

    @property
    def length(self) -> float:
        """Wavelength over b."""
        return self.wave

    def speed(self, surface: int) -> float:
        """Speed of a surface over the mean, dX/dT."""
        return 1 + (self.slide / 2 if surface == 2 else -self.slide / 2)

    @property
    def end_time(self) -> float:
        """Until the rough surface (the faster one) has passed, T."""
        return min(3.0 / max(abs(self.speed(2)), abs(self.speed(1))), LONGEST)

    def place(self, surface: int) -> float:
        """Centre of a feature at T = 0: 1.5 half-widths before the middle, less for a slow one, on the side it comes from."""
        way = self.speed(surface) * self.end_time
        return -max(min(way, 1.5), -1.5) if abs(way) > 0.5 else -0.4

    def roughness(self, half_width: float) -> dict[str, float]:
        """The wavelengths of roughness."""
        return {"wavelength_long": 2 * half_width, "wavelength_rolloff": half_width, "wavelength_short": 0.4 * half_width}

    def overtaking(self) -> dict[int, float]:
        """Heights on both surfaces where one overtakes, over that of the passage."""
        return {1: 1.0, 2: -0.7}

    def groups(self) -> Groups:
        """Its groups without grid and time; features stand where they enter."""
        half_width = CASE_1_HALF_WIDTH * self.load**0.5
        height, wave = self.height * CASE_1_FILM, self.length * half_width
        feature = {"shape": "feature", "wavelength": wave}
        if self.kind == "waviness":
            surfaces = {"surface_2": {"shape": "sinusoid", "amplitude": 0.5 * height, "wavelength": wave}}
        elif self.kind == "roughness":
            rough = {"shape": "synthetic", "rms_height": 0.3 * height, "seed": self.seed, "hurst": 0.8}
            surfaces = {"surface_2": rough | self.roughness(half_width)}
        elif self.kind == "overtaking":
            surfaces = {
                f"surface_{k}": feature | {"amplitude": height * part, "position": self.place(k)}
                for k, part in self.overtaking().items()
            }
        else:
            places = [self.place(2), self.place(2) - 0.8] if self.kind == "ridges" else [self.place(2)]
            count, sign = len(places), -1 if self.kind == "dent" else 1
            lists = {"amplitude": [sign * height] * count, "wavelength": [wave] * count, "position": places}
            surfaces = {"surface_2": feature | lists}
        stress = OILS[self.oil]
        oil = {"rheology": "newtonian", "eyring_stress": None} if stress is None else {"eyring_stress": stress}
        speeds = {f"speed_{k}": MEAN_SPEED * self.speed(k) for k in (1, 2)}
        return merged(CASE_1, bodies=speeds, load={"load_per_length": 1e5 * self.load}, lubricant=oil, **surfaces)

    def on_grid(self, intervals: int | None, step_over_dx: float | None = None, **others: dict) -> Groups:
        """Its groups; the step is `step_over_dx` times 5.5/intervals, so that it does not depend on the domain that is chosen."""
        # From T = 0: the estimates are judged over the whole passage, the start included.
        time = {"transient": True, "end_time": self.end_time, "statistics_from": 0.0}
        if step_over_dx is not None:
            time["time_step"] = step_over_dx * 5.5 / intervals
            time["end_time"] = max(2, round(self.end_time * 256 / 5.5 / 4)) * 4 * 5.5 / 256
        return merged(merged(self.groups(), domain=WINDOW | {"intervals": intervals}, time=time), **others)

    def namelist(self, intervals: int | None, **others: dict) -> str:
        """Their text."""
        return namelists.namelist(self.on_grid(intervals, **others))


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

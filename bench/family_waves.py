"""Ridges, dents and sinusoids that are narrow for the grid or fast for the time step, at rest and moving."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass

import namelists
from families import Family, Member, Resolution

QUANTITIES = ("summary/h_min", "summary/h_central")
# Domains of the truth at rest and in time, so long that they change nothing; the case leaves its own to the program.
LONG = {"x_inlet": -25.0, "x_outlet": 4.0}
LONG_IN_TIME = {"x_inlet": -16.0, "x_outlet": 2.5}
# A given grid needs a given domain, to know the nodes in a wave.
GIVEN = {"x_inlet": -8.0, "x_outlet": 2.5}
NO_BARS = {"error_bars": False}
# Fewest nodes in a wave of the truth, and steps in its passage.
FINE = 128
FINE_IN_TIME = 64
STEEL_RADIUS, STEEL_MODULUS, ALPHA = 0.01, 226.4e9, 2.2e-8


@dataclass(frozen=True)
class Wave:
    """A contact in SI with one wave: lengths over the half-width b [m], speed over the mean one, heights over the film."""

    groups: dict[str, dict]
    half_width: float
    film: float
    surface: int
    speed: float
    kind: str
    length: float
    height: float
    position: float

    def namelist(self, domain: dict, **groups: dict) -> str:
        """Its text."""
        height = self.height * self.film * {"ridge": 1.0, "dent": -1.0, "sinusoid": 0.4}[self.kind]
        shape = {"shape": "sinusoid" if self.kind == "sinusoid" else "feature", "amplitude": height}
        shape |= {"wavelength": self.length * self.half_width, "position": self.position}
        if self.kind == "sinusoid" and "time" in groups:
            shape["entry_length"] = 1.0
        return namelists.namelist(self.groups | {f"surface_{self.surface}": shape, "domain": domain} | groups)

    @property
    def end_time(self) -> float:
        """T when it has passed X = 1."""
        return (1.0 - self.position) / self.speed

    def step(self, steps: float) -> float:
        """The time step that makes so many in the passage of the wave."""
        return min(self.length / (self.speed * steps), self.end_time)

    def time(self, step: float | None) -> dict:
        """The group &time with a step, or the program's choice."""
        return {"transient": True, "end_time": self.end_time, "time_step": step}


def length(domain: dict) -> float:
    """Its length."""
    return domain["x_outlet"] - domain["x_inlet"]


def power_of_two(intervals: float) -> int:
    """The next one."""
    return 2 ** max(8, math.ceil(math.log2(intervals)))


def contact(source: random.Random, speed: float) -> tuple[dict[str, dict], float, float]:
    """Groups, half-width and film (of Dowson and Higginson) of a steel contact; `speed` of surface 1 over the mean one."""
    pressure, mean = 10 ** source.uniform(8.6, 9.18), 10 ** source.uniform(-0.7, 0.6)
    viscosity = 10 ** source.uniform(-1.7, -0.7)
    half_width = 4 * pressure * STEEL_RADIUS / STEEL_MODULUS
    load = pressure * math.pi * half_width / 2 / (STEEL_MODULUS * STEEL_RADIUS)
    speed_number = viscosity * mean / (STEEL_MODULUS * STEEL_RADIUS)
    film = 2.65 * STEEL_RADIUS * (ALPHA * STEEL_MODULUS) ** 0.54 * speed_number**0.7 / load**0.13
    oil = {"viscosity": viscosity, "pressure_viscosity": ALPHA, "roelands_p0": 1.96e8}
    if source.random() < 0.5:
        oil |= {"rheology": "eyring", "eyring_stress": source.choice((3e6, 6e6, 10e6))}
    bodies = {"reduced_radius": STEEL_RADIUS, "reduced_modulus": STEEL_MODULUS}
    bodies |= {"speed_1": speed * mean, "speed_2": (2 - speed) * mean}
    return {"bodies": bodies, "load": {"hertz_pressure": pressure}, "lubricant": oil}, half_width, film


def wave_at_rest(source: random.Random) -> Wave:
    """A wave of 0.02 to 0.5 half-widths that stands in the contact."""
    groups, half_width, film = contact(source, 0.0)
    kind, length = source.choice(("ridge", "dent", "sinusoid")), 10 ** source.uniform(-1.7, -0.3)
    return Wave(groups, half_width, film, 1, 0.0, kind, length, source.uniform(0.1, 0.7), source.uniform(-1.2, 1.1))


def moving_wave(source: random.Random) -> Wave:
    """A wave of 0.2 to 0.8 half-widths that passes, on the slow or the fast surface."""
    speed = source.uniform(0.4, 1.9)
    groups, half_width, film = contact(source, speed)
    kind, length = source.choice(("ridge", "dent", "sinusoid")), 10 ** source.uniform(-0.7, -0.1)
    front = -1 - math.sqrt(2 * film * STEEL_RADIUS) / half_width  # X = -1 - sqrt(2 H_c): where the film is made
    return Wave(groups, half_width, film, 1, speed, kind, length, source.uniform(0.1, 0.6), front - length)


def true_at_rest(wave: Wave) -> str:
    """Its truth."""
    fine = max(power_of_two(FINE * length(LONG) / wave.length), 2**15)
    return wave.namelist(LONG | {"intervals": fine}, accuracy=NO_BARS)


def true_passage(wave: Wave) -> Callable[[Resolution], str]:
    """Its truth, finer than the case in space and in time."""

    def finer(found: Resolution) -> str:
        long = found.ends(**LONG_IN_TIME)
        fewest = max(power_of_two(FINE_IN_TIME * length(long) / wave.length), 2**11)
        fine = found.intervals(length(long), fewest)
        step = found.time_step(wave.step(FINE_IN_TIME))
        return wave.namelist(long | {"intervals": fine}, time=wave.time(step), accuracy=NO_BARS)

    return finer


def at_rest(source: random.Random, count: int) -> list[Member]:
    """The grid is left to the program."""
    waves = [wave_at_rest(source) for _ in range(count)]
    return [Member(f"{i:03d}", wave.namelist({}), true_at_rest(wave)) for i, wave in enumerate(waves)]


def on_a_coarse_grid(source: random.Random, count: int) -> list[Member]:
    """The grid is given, with 1 to 64 nodes in the wave."""
    found = []
    for i in range(count):
        wave, nodes = wave_at_rest(source), 2 ** source.uniform(0, 6)
        grid = GIVEN | {"intervals": power_of_two(nodes * length(GIVEN) / wave.length)}
        found.append(Member(f"{i:03d}", wave.namelist(grid), true_at_rest(wave)))
    return found


def passing(source: random.Random, count: int) -> list[Member]:
    """Grid and time step are left to the program."""
    waves = [moving_wave(source) for _ in range(count)]
    return [Member(f"{i:03d}", wave.namelist({}, time=wave.time(None)), true_passage(wave)) for i, wave in enumerate(waves)]


def in_long_steps(source: random.Random, count: int) -> list[Member]:
    """The time step is given, with 1 to 64 steps in the passage of the wave; the grid is the program's."""
    found = []
    for i in range(count):
        wave, steps = moving_wave(source), 2 ** source.uniform(0, 6)
        found.append(Member(f"{i:03d}", wave.namelist({}, time=wave.time(wave.step(steps))), true_passage(wave)))
    return found


FAMILIES = [
    Family("waves_at_rest", "Narrow waves at rest, chosen grid", QUANTITIES, at_rest),
    Family("waves_passing", "Narrow waves that pass, chosen grid and time step", QUANTITIES, passing),
    Family("waves_coarse_grid", "Narrow waves at rest, given grid of 1 to 64 nodes a wave", QUANTITIES, on_a_coarse_grid),
    Family("waves_long_steps", "Narrow waves that pass, given step of a wave to a 64th of it", QUANTITIES, in_long_steps),
]

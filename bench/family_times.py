"""Passages in time: what is stored of them, waves that fill the contact at T = 0, ridges that begin in it or are given no place."""

from __future__ import annotations

import random
from collections.abc import Callable

import namelists
from families import Family, Member, Resolution

FIGURES = ("summary/h_min", "summary/h_central", "summary/p_max")
# Fewest intervals of a truth, and its longest step, over the mean speed.
FEWEST, LONGEST = 2048, 0.004
NO_BARS = {"error_bars": False}
SLIDES = (-1.0, -0.5, 0.0, 0.5, 1.0, 5 / 3, 1.9)


class Contact:
    """A steel contact at random and what is needed of it, lengths over its half-width."""

    def __init__(self, source: random.Random, slide: float, loads: tuple[float, float] = (0.6, 2.1), eyring: float = 0.5) -> None:
        """Draws load (lg M), oil (Eyring with that probability), and the height of a wave over the central film."""
        self.m, l = 10 ** source.uniform(*loads), source.uniform(4, 13)  # noqa: E741
        stress = 10 ** source.uniform(6.6, 7.5) if source.random() < eyring else None
        self.groups = namelists.steel(self.m, l, slide, stress)
        self.half_width, self.film = namelists.scales(self.groups, 1.05)
        self.speed = 1 + slide / 2
        self.inlet = -14.0 if self.m < 10 else -8.0 if self.m < 40 else -5.0

    def wave(self, kind: str, height: float, length: float, position: float | None) -> dict[str, object]:
        """The group of a surface: height over the film, length and place in half-widths."""
        found = {"shape": kind, "amplitude": height * self.film, "wavelength": length * self.half_width}
        return found | ({} if position is None else {"position": position})

    def text(self, surfaces: dict[str, dict], time: dict[str, object], **others: dict) -> str:
        """A namelist; the grid has at least 24 intervals in a wave of 0.5 half-widths."""
        intervals = {"intervals": 1024 if self.m < 10 else 512}
        return namelists.namelist(self.groups | surfaces | {"domain": intervals, "time": {"transient": True} | time} | others)

    def truth(self, surfaces: dict[str, dict], time: dict[str, object]) -> Callable[[Resolution], str]:
        """The same on a long domain, finer than the case in space and in time."""

        def finer(found: Resolution) -> str:
            domain = found.ends(self.inlet, 3.0 if self.m < 10 else 2.0)
            domain["intervals"] = found.intervals(domain["x_outlet"] - domain["x_inlet"], FEWEST)
            step = found.time_step(LONGEST / max(abs(self.speed), 0.5))
            return self.text(surfaces, time | {"time_step": step}, domain=domain, accuracy=NO_BARS)

        return finer


def strides(source: random.Random, count: int) -> list[Member]:
    """A ridge passes; profiles are stored of few steps, of one field, or of nothing but the start."""
    found = []
    for i in range(count):
        contact = Contact(source, source.choice(SLIDES))
        ridge = contact.wave("feature", source.choice((1, -1)) * source.uniform(0.1, 0.5), source.uniform(0.5, 1.5), -5.0)
        surfaces, time = {"surface_2": ridge}, {"end_time": 7.0 / contact.speed}
        output = {"profile_stride": source.choice((3, 10, 50, 1000)), "fields": source.choice(("pressure", "film_thickness"))}
        found.append(Member(f"{i:03d}", contact.text(surfaces, time, output=output), contact.truth(surfaces, time)))
    return found


def waves(source: random.Random, count: int) -> list[Member]:
    """Sinusoids fill the contact from T = 0 on, on one surface or both; the truth is the periodic state, much later."""
    found = []
    for i in range(count):
        contact = Contact(source, source.choice(SLIDES))
        length = source.uniform(0.5, 1.5)
        moving = contact.wave("sinusoid", source.uniform(0.05, 0.3), length, source.uniform(-1, 1))
        surfaces, period = {"surface_2": moving}, length / contact.speed
        if source.random() < 0.3:  # a wave on the other surface too, of the same period
            other = 2 - contact.speed
            surfaces["surface_1"] = contact.wave("sinusoid", source.uniform(0.05, 0.2), length * other / contact.speed, 0.0)
        end = source.uniform(1.0, 12.0)
        # whole periods later: the same phase at the end, of which the last one counts
        periods = max(2, round(10 / period))
        later = {"end_time": end + period * periods, "statistics_from": end + period * (periods - 1)}
        found.append(Member(f"{i:03d}", contact.text(surfaces, {"end_time": end}), contact.truth(surfaces, later)))
    return found


def without_position(source: random.Random, count: int) -> list[Member]:
    """Ridges and dents that are given no place; the truth begins far in front of the contact."""
    found = []
    for i in range(count):
        contact = Contact(source, source.choice(SLIDES))
        shape = ("feature", source.choice((1, -1)) * source.uniform(0.1, 0.5), source.uniform(0.5, 1.5))
        end = source.uniform(1.0, 8.0) / contact.speed
        whole = {"end_time": 9.0 / contact.speed}
        case = contact.text({"surface_2": contact.wave(*shape, None)}, {"end_time": end})
        found.append(Member(f"{i:03d}", case, contact.truth({"surface_2": contact.wave(*shape, -6.0)}, whole)))
    return found


def inside(source: random.Random, count: int) -> list[Member]:
    """A ridge on a slow surface begins inside the contact; the truth is the same time of a passage from far in front."""
    found = []
    for i in range(count):
        speed = source.uniform(0.25, 0.45)
        contact = Contact(source, 2 * speed - 2)
        shape = ("feature", source.choice((1, -1)) * source.uniform(0.1, 0.4), source.uniform(0.5, 1.2))
        place = source.uniform(-1.2, 0.0)
        end = max(6.0, (1.1 + 0.5 * shape[2] - place) / speed)
        begin = source.choice((None, 5.0))
        given = {} if begin is None else {"statistics_from": begin}
        delay = (5.0 + place) / speed
        later = {"end_time": end + delay, "statistics_from": (begin or 4.8) + delay}
        case = contact.text({"surface_2": contact.wave(*shape, place)}, {"end_time": end} | given)
        found.append(Member(f"{i:03d}", case, contact.truth({"surface_2": contact.wave(*shape, place - speed * delay)}, later)))
    return found


def beside_waves(source: random.Random, count: int) -> list[Member]:
    """A ridge begins in front of a contact that a wave of the other surface fills; the truth begins whole periods later."""
    found = []
    for i in range(count):
        contact = Contact(source, source.choice(SLIDES[:-2]))
        other = 2 - contact.speed
        shape = ("feature", source.choice((1, -1)) * source.uniform(0.1, 0.4), source.uniform(0.5, 1.2))
        place, length = source.uniform(-9.0, -2.0), source.uniform(0.5, 1.5)
        wave = {"surface_1": contact.wave("sinusoid", source.uniform(0.02, 0.15), length, 0.0)}
        end = (1.5 + 0.5 * shape[2] - place) / contact.speed + source.uniform(0.0, 2.0)
        delay = length / other * round(6 * other / length)
        case = contact.text({"surface_2": contact.wave(*shape, place)} | wave, {"end_time": end})
        later = {"surface_2": contact.wave(*shape, place - contact.speed * delay)} | wave
        found.append(Member(f"{i:03d}", case, contact.truth(later, {"end_time": end + delay})))
    return found


def narrow(source: random.Random, count: int) -> list[Member]:
    """Narrow ridges and dents in heavy contacts, mostly Newtonian: the film keeps what the inlet makes of them."""
    found = []
    for i in range(count):
        contact = Contact(source, source.choice((-1.0, -0.5, 0.0, 0.5, 1.0)), loads=(1.5, 2.5), eyring=0.25)
        length = 10 ** source.uniform(-1.0, -0.3)
        ridge = contact.wave("feature", source.choice((1, -1)) * source.uniform(0.05, 0.5), length, -1.5 - length)
        surfaces, time = {"surface_2": ridge}, {"end_time": (2.6 + 1.5 * length) / contact.speed}
        case = contact.text(surfaces, time, domain={"inlet": "auto"})
        found.append(Member(f"{i:03d}", case, contact.truth(surfaces, time)))
    return found


FAMILIES = [
    Family("strides", "Passages of which little is stored", FIGURES, strides),
    Family("periodic", "Waves that fill the contact at the start", FIGURES, waves),
    Family("placed", "Features without a place", FIGURES, without_position, truth_goes_on=True),
    Family("inside", "Features that begin inside the contact", FIGURES, inside),
    Family("narrow", "Narrow features in heavy contacts", (*FIGURES, "summary/p_central"), narrow),
    Family("beside_waves", "Features that pass beside waves", FIGURES, beside_waves),
]

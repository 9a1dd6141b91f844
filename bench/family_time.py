"""Random waves and passages: narrow for the grid, fast for the step, begun inside the contact; and their truths.

Passages on the domain, grid and step of the program are compared with a finer, longer run (judge.finer_passage).
"""

from __future__ import annotations

import math
import random
from functools import partial

import namelists
from family_steady import OILS as LAWS
from family_steady import Draw, half_axis, log_uniform, point_in_si
from judge import Answer, Member, beside, finer_passage
from namelists import NO_BARS, Groups

# Domains of the truth of a wave at rest and in time, so long that they change nothing; the case leaves its own to the program.
LONG, LONG_IN_TIME = {"x_inlet": -25.0, "x_outlet": 4.0}, (-16.0, 2.5)
# A given grid needs a given domain, to know the nodes in a wave.
GIVEN = {"x_inlet": -8.0, "x_outlet": 2.5}
LONG_LENGTH, GIVEN_LENGTH = (each["x_outlet"] - each["x_inlet"] for each in (LONG, GIVEN))
# Fewest nodes in a wave of the truth, and steps in its passage.
FINE, FINE_IN_TIME = 128, 64
STEEL_RADIUS, STEEL_MODULUS, ALPHA = 0.01, 226.4e9, 2.2e-8
# Slide-to-roll ratios.
SLIDES = (-1.0, -0.5, 0.0, 0.5, 1.0, 5 / 3, 1.9)
WAVES = ("ridge", "dent", "sinusoid")


def power_of_two(intervals: float) -> int:
    """The next one."""
    return 2 ** max(8, math.ceil(math.log2(intervals)))


def rough_contact(source: random.Random, speed: float) -> tuple[Groups, float, float]:
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


def wave(kind: str, length: float, height: float, position: float) -> dict[str, object]:
    """A surface with one wave: a ridge, a dent or a sinusoid, lengths and height in m, the place in half-widths."""
    sign = {"ridge": 1.0, "dent": -1.0, "sinusoid": 0.4}[kind]
    shape = {"shape": "sinusoid" if kind == "sinusoid" else "feature", "amplitude": sign * height}
    return shape | {"wavelength": length, "position": position}


def standing(*, is_coarse: bool) -> Draw:
    """Waves of 0.02 to 0.5 half-widths that stand in the contact, on the program's grid, or a given one of 1 to 64 nodes a wave."""

    def draw(source: random.Random, _: int) -> Member:
        groups, half_width, film = rough_contact(source, 0.0)
        kind, length = source.choice(WAVES), 10 ** source.uniform(-1.7, -0.3)
        height, place = source.uniform(0.1, 0.7), source.uniform(-1.2, 1.1)
        groups["surface_1"] = wave(kind, length * half_width, height * film, place)
        domain = {}
        if is_coarse:
            domain = GIVEN | {"intervals": power_of_two(2 ** source.uniform(0, 6) * GIVEN_LENGTH / length)}
        fine = max(power_of_two(FINE * LONG_LENGTH / length), 2**15)
        return beside(groups, domain, LONG | {"intervals": fine})

    return draw


def moving(*, is_coarse: bool) -> Draw:
    """Waves of 0.2 to 0.8 half-widths pass on the program's grid, in its time steps or in 1 to 64 given ones a wave."""

    def draw(source: random.Random, _: int) -> Member:
        speed = source.uniform(0.4, 1.9)
        groups, half_width, film = rough_contact(source, speed)
        kind, length = source.choice(WAVES), 10 ** source.uniform(-0.7, -0.1)
        front = -1 - math.sqrt(2 * film * STEEL_RADIUS) / half_width  # X = -1 - sqrt(2 H_c): where the film is made
        place = front - length
        groups["surface_1"] = wave(kind, length * half_width, source.uniform(0.1, 0.6) * film, place)
        if kind == "sinusoid":
            groups["surface_1"]["entry_length"] = 1.0
        end = (1.0 - place) / speed  # when it has passed X = 1

        def step(steps: float) -> float:
            return min(length / (speed * steps), end)

        def fewest(domain: float) -> int:
            return max(power_of_two(FINE_IN_TIME * domain / length), 2**11)

        given = step(2 ** source.uniform(0, 6)) if is_coarse else None
        groups["time"] = {"transient": True, "end_time": end, "time_step": given}
        return Member(groups, finer_passage(groups, LONG_IN_TIME, fewest, step(FINE_IN_TIME)))

    return draw


class Contact:
    """A steel contact at random and what is needed of it, lengths over its half-width."""

    def __init__(self, source: random.Random, slide: float, loads: tuple[float, float] = (0.6, 2.1), eyring: float = 0.5) -> None:
        """Draws load (lg M), oil (Eyring with that probability), and the height of a wave over the central film."""
        self.m, l = 10 ** source.uniform(*loads), source.uniform(4, 13)  # noqa: E741
        stress = 10 ** source.uniform(6.6, 7.5) if source.random() < eyring else None
        self.groups = namelists.steel(self.m, l, slide, stress)
        self.half_width, self.film = namelists.scales(self.groups, 1.05)
        self.speed = 1 + slide / 2

    def wave(self, kind: str, height: float, length: float, position: float | None) -> dict[str, object]:
        """The group of a surface: height over the film, length and place in half-widths."""
        shape = {"shape": kind, "amplitude": height * self.film, "wavelength": length * self.half_width}
        return shape | {"position": position}

    def case(self, surfaces: Groups, time: dict[str, object], **others: dict) -> Groups:
        """Its groups; the grid has at least 24 intervals in a wave of 0.5 half-widths."""
        intervals = {"intervals": 1024 if self.m < 10 else 512}
        return self.groups | surfaces | {"domain": intervals, "time": {"transient": True} | time} | others

    def member(self, case: tuple[Groups, dict], truth: tuple[Groups, dict] | None = None, **others: dict) -> Member:
        """Surfaces and time of a case and of its truth: on a long domain, finer in space and in time."""
        ends = -14.0 if self.m < 10 else -8.0 if self.m < 40 else -5.0, 3.0 if self.m < 10 else 2.0
        finer = finer_passage(self.case(*(truth or case)), ends, 2048, 0.004 / max(abs(self.speed), 0.5))
        return Member(self.case(*case, **others), finer)


def ridge(source: random.Random, heights: tuple[float, float], lengths: tuple[float, float]) -> tuple[str, float, float]:
    """Kind, height and length of a ridge or a dent."""
    return "feature", source.choice((1, -1)) * source.uniform(*heights), source.uniform(*lengths)


def strides(source: random.Random, _: int) -> Member:
    """A ridge passes; profiles are stored of few steps, of one field, or of nothing but the start."""
    contact = Contact(source, source.choice(SLIDES))
    surfaces = {"surface_2": contact.wave(*ridge(source, (0.1, 0.5), (0.5, 1.5)), -5.0)}
    output = {"profile_stride": source.choice((3, 10, 50, 1000)), "fields": source.choice(("pressure", "film_thickness"))}
    return contact.member((surfaces, {"end_time": 7.0 / contact.speed}), output=output)


def periodic(source: random.Random, _: int) -> Member:
    """Sinusoids fill the contact from T = 0 on, on one surface or both; the truth is the periodic state, much later."""
    contact = Contact(source, source.choice(SLIDES))
    length = source.uniform(0.5, 1.5)
    surfaces = {"surface_2": contact.wave("sinusoid", source.uniform(0.05, 0.3), length, source.uniform(-1, 1))}
    period = length / contact.speed
    if source.random() < 0.3:  # a wave on the other surface too, of the same period
        other = 2 - contact.speed
        surfaces["surface_1"] = contact.wave("sinusoid", source.uniform(0.05, 0.2), length * other / contact.speed, 0.0)
    end = source.uniform(1.0, 12.0)
    # whole periods later: the same phase at the end, of which the last one counts
    periods = max(2, round(10 / period))
    later = {"end_time": end + period * periods, "statistics_from": end + period * (periods - 1)}
    return contact.member((surfaces, {"end_time": end}), (surfaces, later))


def placed(source: random.Random, _: int) -> Member:
    """Ridges and dents that are given no place; the truth begins far in front of the contact."""
    contact = Contact(source, source.choice(SLIDES))
    shape = ridge(source, (0.1, 0.5), (0.5, 1.5))
    case = {"surface_2": contact.wave(*shape, None)}, {"end_time": source.uniform(1.0, 8.0) / contact.speed}
    return contact.member(case, ({"surface_2": contact.wave(*shape, -6.0)}, {"end_time": 9.0 / contact.speed}))


def inside(source: random.Random, _: int) -> Member:
    """A ridge on a slow surface begins inside the contact; the truth is the same time of a passage from far in front."""
    speed = source.uniform(0.25, 0.45)
    contact = Contact(source, 2 * speed - 2)
    shape = ridge(source, (0.1, 0.4), (0.5, 1.2))
    place = source.uniform(-1.2, 0.0)
    end = max(6.0, (1.1 + 0.5 * shape[2] - place) / speed)
    begin = source.choice((None, 5.0))
    delay = (5.0 + place) / speed
    later = {"end_time": end + delay, "statistics_from": (begin or 4.8) + delay}
    case = {"surface_2": contact.wave(*shape, place)}, {"end_time": end, "statistics_from": begin}
    return contact.member(case, ({"surface_2": contact.wave(*shape, place - speed * delay)}, later))


def beside_waves(source: random.Random, _: int) -> Member:
    """A ridge begins in front of a contact that a wave of the other surface fills; the truth begins whole periods later."""
    contact = Contact(source, source.choice(SLIDES[:-2]))
    other = 2 - contact.speed
    shape = ridge(source, (0.1, 0.4), (0.5, 1.2))
    place, length = source.uniform(-9.0, -2.0), source.uniform(0.5, 1.5)
    waves = {"surface_1": contact.wave("sinusoid", source.uniform(0.02, 0.15), length, 0.0)}
    end = (1.5 + 0.5 * shape[2] - place) / contact.speed + source.uniform(0.0, 2.0)
    delay = length / other * round(6 * other / length)
    early = waves | {"surface_2": contact.wave(*shape, place - contact.speed * delay)}
    return contact.member(
        (waves | {"surface_2": contact.wave(*shape, place)}, {"end_time": end}), (early, {"end_time": end + delay})
    )


def narrow(source: random.Random, _: int) -> Member:
    """Narrow ridges and dents in heavy contacts, mostly Newtonian: the film keeps what the inlet makes of them."""
    contact = Contact(source, source.choice((-1.0, -0.5, 0.0, 0.5, 1.0)), loads=(1.5, 2.5), eyring=0.25)
    length = 10 ** source.uniform(-1.0, -0.3)
    shape = contact.wave("feature", source.choice((1, -1)) * source.uniform(0.05, 0.5), length, -1.5 - length)
    return contact.member(({"surface_2": shape}, {"end_time": (2.6 + 1.5 * length) / contact.speed}))


def point_at_random(source: random.Random, i: int, heaviest: float) -> tuple[Groups, float, float]:
    """A circle or an ellipse in SI on 64 intervals, one of two Eyring's; its slide-to-roll ratio and a rough film [m]."""
    m, l = log_uniform(source, 3, heaviest), source.uniform(2, 12)  # noqa: E741
    slide, stress = source.uniform(-1.5, 1.5), log_uniform(source, 2e6, 20e6) if i % 2 else None
    groups, ratio = namelists.steel(m, l, slide, stress, source.choice(LAWS)), source.choice((1.0, log_uniform(source, 0.1, 3)))
    film = namelists.RADIUS * (l / (namelists.OIL_ALPHA * STEEL_MODULUS)) ** 2 * max(2.0, 1.3 * l**0.75) * m ** (-1 / 12)
    return point_in_si(source, groups, m, ratio) | {"domain": {"intervals_x": 64}}, slide, film


def finer_point(groups: Groups, found: Answer) -> Groups:
    """The truth of a passage of a point: twice the intervals, and half the step, on the same domain."""
    time = groups["time"] | {"time_step": found["time_step"] / 2}
    return groups | {"domain": {"intervals_x": 2 * found["intervals_x"]}, "time": time, "accuracy": NO_BARS}


def point_passing(source: random.Random, i: int) -> Member:
    """A ridge, a dent, a bump or waves pass, of 0.9 to 2 half-axes and 0.1 to 0.4 films."""
    groups, slide, film = point_at_random(source, i, 300)
    wave = half_axis(groups) * source.uniform(0.9, 2.0)
    surface = {"amplitude": film * source.choice((1, -1)) * source.uniform(0.1, 0.4), "wavelength": wave}
    surface |= source.choice(({}, {"wavelength_y": wave}, {"wavelength_y": 2 * wave}))
    surface |= {"shape": "feature"} if source.random() < 0.7 else {"shape": "sinusoid", "amplitude": abs(surface["amplitude"]) / 2}
    groups |= {"surface_2": surface, "time": {"transient": True, "end_time": source.uniform(3.5, 4.5) / (1 + slide / 2)}}
    return Member(groups, partial(finer_point, groups))


def point_reversing(source: random.Random, i: int) -> Member:
    """The speeds turn around by a cosine, to 0.3 to 1 of what they were, on a way of 3 to 8 half-axes at the first speed."""
    groups = point_at_random(source, i, 100)[0]
    speeds = [groups["bodies"].pop(f"speed_{k}") for k in (1, 2)]
    way, end = source.uniform(3, 8), -source.uniform(0.3, 1.0)
    span = 2 * half_axis(groups) / sum(speeds) * way
    turns = [1 + (end - 1) * 0.5 * (1 - math.cos(math.pi * k / 8)) for k in range(9)]
    rows = "".join(f"{span * k / 8:.8e},{speeds[0] * turn:.8e},{speeds[1] * turn:.8e}\n" for k, turn in enumerate(turns))
    groups |= {"history": {"file": "turn.csv", "interpolation": "cubic"}, "time": {"transient": True, "time_step": way / 60}}
    return Member(groups, partial(finer_point, groups), files={"turn.csv": "time [s],speed_1 [m/s],speed_2 [m/s]\n" + rows})

"""The largest pressure: spikes that the grid does not resolve, over the whole (M, L) range, on chosen and given grids, and in time.

Smooth contacts with Barus' and Roelands' law, incompressible and not, and Eyring oils, light and nearly rolling. The truth has dX
so small that a spike which ends is resolved or nearly so, and an inlet several times as far out as the program puts one. Passages
of features and waves begin in front of the contact and are compared with eight times the intervals and steps on the same domain:
what is judged is `error_grid`.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass

import namelists
from families import Family, Member
from family_domain import width
from passages import KINDS, MEAN_SPEED, OILS

P_MAX = ("summary/p_max",)
NO_BARS = {"error_bars": False}
LAWS = tuple({"viscosity_law": v, "density_law": d} for v in ("barus", "roelands") for d in ("constant", "dowson_higginson"))
# Intervals of the truth: spikes, of which loads above M = 1 are in danger, need many, light contacts a long domain.
FINE, LIGHT = 2**16, 2**15
# The same for the corner that Eyring's law makes of a spike: a grid errs by up to half of what pressure falls over a spacing.
CORNER_FINE = 2**17
# H_c of Case 1; slide-to-roll ratios at which the second surface, or both, go through the contact in a short time.
CASE_1_H = 0.469
SLIDES = (-1.0, -0.3, 0.0, 0.3, 1.0, 5 / 3, 1.9, 2.5, 4.0)
SLIDES_BOTH = (-1.0, -0.3, 0.0, 0.3, 1.0)
# Inlet in units of sqrt(2 H_c) in front of X = -1, and the farthest that the program takes.
REACH, FARTHEST = 40, 1000.0


def far_inlet(m: float, l: float) -> float:  # noqa: E741
    """X of an inlet that starves nothing: from a rough film H_c of a contact (M, L with the speed sum)."""
    film = (2.45 / m + 1.3 * m**-0.125 * l**0.75 + 2.6 * m**-0.2) * math.pi / (8 * m)
    light = 1 + 3 / m
    return -min(1 + REACH * light * math.sqrt(2 * film), FARTHEST)


def contact(source: random.Random, i: int) -> tuple[dict, dict]:
    """The groups of a contact without its domain, and the domain of the truth."""
    if i % 6 < 4:
        m, l = 10 ** source.uniform(-0.5, 3.2), source.uniform(0.5, 35)  # noqa: E741
        groups = {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}, "lubricant": LAWS[i % 6]}
    else:
        m, l = 10 ** source.uniform(0, 2.9), source.uniform(3, 30)  # noqa: E741
        groups = namelists.steel(m, l, source.uniform(0.05, 2), 10 ** source.uniform(6.5, 9))
    outlet = max(1.5, 3 * math.sqrt(1 / m))
    fine = {"intervals": FINE if m > 1 else LIGHT, "inlet": "tail", "x_inlet": far_inlet(m, l), "x_outlet": outlet}
    return groups, fine


def member(i: int, groups: dict, domain: dict, fine: dict) -> Member:
    """A contact on a domain beside its truth."""
    truth = groups | {"domain": fine, "accuracy": NO_BARS}
    return Member(f"{i:03d}", namelists.namelist(groups | {"domain": domain}), namelists.namelist(truth))


def chosen(source: random.Random, count: int) -> list[Member]:
    """On the domain and grid that the program chooses."""
    contacts = [contact(source, i) for i in range(count)]
    return [member(i, groups, {}, fine) for i, (groups, fine) in enumerate(contacts)]


def given(source: random.Random, count: int) -> list[Member]:
    """On given grids of 64 to 4096 intervals."""
    found = []
    for i in range(count):
        groups, fine = contact(source, i)
        found.append(member(i, groups, {"intervals": 2 ** source.randint(6, 12)}, fine))
    return found


def rolling(target: dict) -> Callable[[random.Random, int], list[Member]]:
    """Eyring oils at 0.3 to 3 GPa that slide by 0 to 5 %, on grids that the program chooses: their spikes are corners."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            hertz, l = 10 ** source.uniform(8.48, 9.48), source.uniform(8, 35)  # noqa: E741
            speed_number = (l / (namelists.OIL_ALPHA * namelists.STEEL_MODULUS)) ** 4
            m = 2 * math.pi * (hertz / namelists.STEEL_MODULUS) ** 2 / math.sqrt(speed_number)
            slide = 0.0 if i % 3 == 0 else source.uniform(0, 0.05)
            groups = namelists.steel(m, l, slide, 10 ** source.uniform(6, 7.3))
            groups["lubricant"] |= LAWS[i % 4]
            if i % 4 < 2:
                del groups["lubricant"]["roelands_p0"]
            s = width(m, l)
            fine = {"intervals": CORNER_FINE, "inlet": "tail", "x_inlet": -(1 + 16 * s), "x_outlet": 1 + max(s, 0.5)}
            truth = groups | {"domain": fine, "accuracy": NO_BARS}
            found.append(Member(f"{i:03d}", namelists.namelist(groups | {"accuracy": target}), namelists.namelist(truth)))
        return found

    return draw


@dataclass(frozen=True)
class Whole:
    """A passage of Case 1 at another load, slide and oil, from in front of the contact until all has gone through."""

    kind: str
    load: float
    slide: float
    oil: str
    height: float
    nodes: float
    intervals: int
    scheme: str
    seed: int

    @property
    def width(self) -> float:
        """S = sqrt(2 H_c), about."""
        return math.sqrt(2 * CASE_1_H * self.load**-1.1)

    @property
    def domain(self) -> dict:
        """Ends that cut no film off."""
        return {"x_inlet": -max(4.0, 1 + 3.5 * self.width), "x_outlet": 1.5 + 0.5 * self.width}

    @property
    def dx(self) -> float:
        """Spacing of the given grid, and time step."""
        return (self.domain["x_outlet"] - self.domain["x_inlet"]) / self.intervals

    def speed(self, surface: int) -> float:
        """Over the mean."""
        return 1 + (self.slide / 2 if surface == 2 else -self.slide / 2)

    @property
    def wave(self) -> float:
        """Wavelength over b."""
        return self.nodes * self.dx

    def place(self, surface: int) -> float:
        """Where a feature is in front of the contact."""
        return -math.copysign(1 + self.width + 0.5 * self.wave, self.speed(surface))

    @property
    def end_time(self) -> float:
        """When all features have left, or waves and roughness have entered and settled."""
        if self.kind in ("waviness", "roughness"):
            return 2 * (2 + self.width) + (4 * self.wave + 4 + self.width) / self.speed(2)
        slowest = self.speed(2) if self.kind != "overtaking" else min(self.speed(1), self.speed(2))
        return (3 + self.width + 2 * self.wave) / slowest

    def surfaces(self) -> dict[str, dict]:
        """The groups of both surfaces."""
        half_width = namelists.CASE_1_HALF_WIDTH * self.load**0.5
        height, wave = self.height * namelists.CASE_1_FILM, self.wave * half_width
        if self.kind == "waviness":
            return {"surface_2": {"shape": "sinusoid", "amplitude": 0.5 * height, "wavelength": wave}}
        if self.kind == "roughness":
            waves = {"wavelength_long": 4 * wave, "wavelength_rolloff": 2 * wave, "wavelength_short": wave}
            rough = {"shape": "synthetic", "rms_height": 0.3 * height, "seed": self.seed, "hurst": 0.8}
            return {"surface_2": rough | waves}
        sign = -1 if self.kind == "dent" else 1
        places = [self.place(2)] + ([self.place(2) - 0.8] if self.kind == "ridges" else [])
        count = len(places)
        both = {"surface_2": {"amplitude": [sign * height] * count, "wavelength": [wave] * count, "position": places}}
        if self.kind == "overtaking":
            both["surface_1"] = {"amplitude": -0.7 * height, "wavelength": wave, "position": self.place(1)}
        return {name: {"shape": "feature"} | keys for name, keys in both.items()}

    def namelist(self, finer: int, **others: dict) -> str:
        """Its text, with so many times the intervals and steps."""
        time = {"transient": True, "end_time": self.end_time, "time_step": self.dx / finer, "scheme": self.scheme}
        stress = OILS[self.oil]
        oil = {"rheology": "newtonian", "eyring_stress": None} if stress is None else {"eyring_stress": stress}
        speeds = {f"speed_{i}": MEAN_SPEED * self.speed(i) for i in (1, 2)}
        groups = {"bodies": speeds, "load": {"load_per_length": 1e5 * self.load}, "lubricant": oil} | self.surfaces()
        domain = self.domain | {"intervals": finer * self.intervals}
        return namelists.case_1(None, None, **(groups | {"domain": domain, "time": time} | others))


def in_time(source: random.Random, count: int) -> list[Member]:
    """Whole passages with both schemes, on given grids with dT = dX that resolve every wave."""
    found = []
    for i in range(count):
        kind, load, oil = KINDS[i % len(KINDS)], 10 ** source.uniform(-0.6, 0.6), source.choice(tuple(OILS))
        slide = source.choice(SLIDES_BOTH if kind == "overtaking" else SLIDES)
        height, nodes = source.uniform(0.1, 0.6), 2 ** source.uniform(5.05, 7)
        case = Whole(kind, load, slide, oil, height, nodes, (256, 512)[i // 2 % 2], ("bdf2", "backward_euler")[i % 2], i)
        truth = case.namelist(8, accuracy=NO_BARS)
        found.append(Member(f"{i:03d}_{case.intervals}_{case.scheme}_{kind}", case.namelist(1), truth))
    return found


FAMILIES = [
    Family("pressure", "Largest pressure, chosen grids", P_MAX, chosen, count=60),
    Family("pressure_grids", "Largest pressure, given grids of 64 to 4096 intervals", P_MAX, given, count=60),
    Family("pressure_rolling", "Largest pressure, Eyring oils that hardly slide", P_MAX, rolling({}), count=60),
    Family(
        "pressure_target",
        "A target for the largest pressure, Eyring oils that hardly slide",
        P_MAX,
        rolling({"target": 0.01, "target_p_max": 0.01}),
        count=60,
    ),
    Family("pressure_in_time", "Largest pressure of passages", P_MAX, in_time, count=40, estimate="error_grid"),
]

"""Random steady contacts: of all kinds, domains, pressure spikes, friction; each with its truth.

The truth has graded nodes, a far inlet and a target of 3e-4, except for the schemes of even grids: there a pressure spike needs a
dX that (nearly) resolves it; Eyring's law makes it a corner, where a grid errs by up to half of the pressure drop over a spacing.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable

import namelists
from judge import GRADED, LONGER, Member, beside, finer_sample
from namelists import CASE_1, LAWS, RIDGE, Groups, merged, plane, scales, steel

NEWTONIAN = (LAWS[0], LAWS[3], {"viscosity_law": "constant", "density_law": "constant"})
OILS = (LAWS[0], LAWS[3], LAWS[1], LAWS[2])
POINT = {"case": {"problem": "ehl_point"}}
# Wanted accuracy of stiff contacts; None: the program's grid.
TARGETS = (None, 0.01, 0.003)
# Contacts of the fresh sample, and its seed: the rules of the error estimates were fitted on the fitted one.
FRESH, SEED = 224, 20261121
Draw = Callable[[random.Random, int], Member]


def log_uniform(source: random.Random, low: float, high: float) -> float:
    """Evenly in the logarithm."""
    return 10 ** source.uniform(math.log10(low), math.log10(high))


def width(m: float, l: float) -> float:  # noqa: E741
    """S = sqrt(2 H_c) of a rough fit of the Newtonian film [half-widths]."""
    film = ((2.45 / m) ** 1.5 + (1.3 * l**0.75 * m**-0.12) ** 1.5) ** (1 / 1.5) if l > 0 else (2.45 / m + 3.1 * m**-0.2)
    return math.sqrt(2 * film * math.pi / (8 * m))


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


def sample(fresh: bool, longer: bool) -> Draw:
    """The contacts of a sample on the program's own grid; the truth on a longer domain or not."""
    every = fresh_contacts() if fresh else contacts()

    def draw(_: random.Random, i: int) -> Member:
        name, groups = every[i][0], every[i][1] | {"domain": {"grid": "even"}}
        return Member(groups, finer_sample(groups, LONGER if longer else 1), name=name)

    return draw


def anything(lightest: float, truth: Groups) -> Draw:
    """Smooth, M to 2000, L 0.3 to 40, below 4 GPa, of oils of all laws, rolling or sliding; domain and grid left open."""

    def draw(source: random.Random, _: int) -> Member:
        m = l = math.inf  # noqa: E741
        while l * math.sqrt(m / (2 * math.pi)) > 4e9 * namelists.OIL_ALPHA:
            m, l = log_uniform(source, lightest, 2000), source.uniform(0.3, 40)  # noqa: E741
        roelands = {"roelands_z": source.uniform(0.5, 0.7), "roelands_p0": None}
        law = {"viscosity_law": "barus"} if source.random() < 0.4 else roelands
        law["density_law"] = "constant" if source.random() < 0.2 else "dowson_higginson"
        slide = 0.0 if source.random() < 0.4 else source.uniform(0.05, 2)
        stress = source.uniform(2e6, 10e6) if source.random() < 0.38 else None
        groups = steel(m, l, slide, stress, law) | {"output": {"adequacy": False}}
        return Member(groups, groups | truth)

    return draw


graded = anything(0.1, {"accuracy": {"target": 3e-4}})
other = anything(0.5, {"domain": {"grid": "even", "intervals": 2**14}, "solver": {"space_scheme": "kappa"}})


def contact(source: random.Random, is_eyring: bool, lightest: float, heaviest: float) -> tuple[float, float, Groups]:
    """M, L and groups of a contact: M to `heaviest`, L to 40; Eyring stress 0.5 to 20 MPa, slide-to-roll 0 to 4."""
    m, l = log_uniform(source, lightest, heaviest), source.uniform(1, 40)  # noqa: E741
    if is_eyring:
        l = max(l, 2.0)  # noqa: E741
        return m, l, steel(m, l, source.uniform(0, 4), log_uniform(source, 0.5e6, 20e6))
    law = source.choice(NEWTONIAN)
    l = 0.0 if law["viscosity_law"] == "constant" else l  # noqa: E741
    return m, l, plane(m, l, law)


def given_outlet(source: random.Random, i: int) -> Member:
    """From far ahead of rupture to far behind it, light to heavy loads."""
    m, l, groups = contact(source, i % 2 == 1, 0.05, 30)  # noqa: E741
    return beside(groups, {"x_outlet": 1 + width(m, l) * log_uniform(source, 0.05, 2)}, GRADED)


def open_domain(source: random.Random, i: int) -> Member:
    """The whole domain and grid left open, over the whole range."""
    groups = contact(source, i % 3 > 0, 0.02, 300)[2]
    return beside(groups, {}, GRADED)


def light_eyring(source: random.Random, _: int) -> Member:
    """M below 1 with low Eyring stress, domain left open: the slope of the pressure in front of the inlet thins the oil."""
    m, l = log_uniform(source, 0.05, 1), source.uniform(10, 40)  # noqa: E741
    groups = steel(m, l, log_uniform(source, 0.1, 20), log_uniform(source, 0.5e6, 2e6))
    return beside(groups, {}, GRADED)


def extreme(source: random.Random, i: int) -> Member:
    """Domain and grid left open where all is extreme: M 0.01 to 5000, L to 60, slide-to-roll to 20; half with Eyring's law."""
    m, l = log_uniform(source, 0.01, 5000), source.uniform(2, 60)  # noqa: E741
    slide, stress = log_uniform(source, 0.1, 20), log_uniform(source, 0.5e6, 20e6)
    groups = steel(m, l, slide, stress if i % 2 == 1 else None, source.choice(OILS))
    return beside(groups, {}, GRADED)


def given_inlet(source: random.Random, i: int) -> Member:
    """A given inlet, from inside the pressure build-up to far out."""
    m, l, groups = contact(source, i % 4 > 0, 0.1, 30)  # noqa: E741
    start = -(1 + width(m, l) * log_uniform(source, 1.5, 30))
    return beside(groups, {"x_inlet": start}, GRADED)


def spike(source: random.Random, i: int) -> Member:
    """Heavy contacts on given grids, by the kappa scheme; the truth is the thesis's scheme on the same domain."""
    m, l, n = 10 ** source.uniform(1.3, 3), source.uniform(5, 30), source.choice((512, 1024, 2048, 4096))  # noqa: E741
    window = namelists.WINDOW
    kappa = {"space_scheme": "kappa"}
    return beside(plane(m, l, LAWS[i % 4]), window | {"intervals": n}, window | {"intervals": 2**17}, solver=kappa)


def wide(source: random.Random, i: int) -> Member:
    """Heavy, fast and far sliding (M to 3000, L to 60, tau_0 0.5 to 20 MPa, slide-to-roll to 20), three of four Eyring's."""
    m, l = 10 ** source.uniform(0.5, 3.5), source.uniform(2, 60)  # noqa: E741
    stress = 10 ** source.uniform(5.7, 7.3) if i % 4 else None
    groups = steel(m, l, 10 ** source.uniform(-1.3, 1.3), stress, LAWS[source.randrange(4)])
    return beside(groups, {}, GRADED)


def stiff(source: random.Random, i: int) -> Member:
    """Barus' oil with alpha p_h of 31 to 259, dense or not, two of three with a target.

    Every grid has a spike that it does not resolve beside the smallest film.
    """
    rise, l = 31 * (259 / 31) ** source.random(), source.uniform(10, 30)  # noqa: E741
    m = load_number(rise / namelists.OIL_ALPHA, l)
    return beside(plane(m, l, LAWS[i % 2]), {}, GRADED, accuracy={"target": TARGETS[i // 2 % 3]})


def pressure_on_a_grid(source: random.Random, i: int) -> Member:
    """Anywhere in the (M, L) range, one of three with Eyring's law, on given grids of 64 to 4096 intervals."""
    if i % 6 < 4:
        m, l = 10 ** source.uniform(-0.5, 3.2), source.uniform(0.5, 35)  # noqa: E741
        groups = plane(m, l, LAWS[i % 6])
    else:
        m, l = 10 ** source.uniform(0, 2.9), source.uniform(3, 30)  # noqa: E741
        groups = steel(m, l, source.uniform(0.05, 2), 10 ** source.uniform(6.5, 9))
    return beside(groups, {"intervals": 2 ** source.randint(6, 12)}, GRADED)


def load_number(hertz: float, l: float) -> float:  # noqa: E741
    """M of a largest pressure: alpha p_h = L sqrt(M/(2 pi))."""
    return 2 * math.pi * (namelists.OIL_ALPHA * hertz / l) ** 2


def rolling(source: random.Random, i: int) -> Member:
    """Eyring oils at 0.3 to 3 GPa that slide by 0 to 5 %, on grids that the program chooses: their spikes are corners."""
    hertz, l = 10 ** source.uniform(8.48, 9.48), source.uniform(8, 35)  # noqa: E741
    m = load_number(hertz, l)
    slide = 0.0 if i % 3 == 0 else source.uniform(0, 0.05)
    groups = steel(m, l, slide, 10 ** source.uniform(6, 7.3), LAWS[i % 4])
    return beside(groups, {}, GRADED)


def friction_given(source: random.Random, _: int) -> Member:
    """Steel and mineral oil, sliding, one of two with Eyring's law, on a window like that of the thesis or a longer one."""
    m, l = 10 ** source.uniform(0.3, 2.0), source.uniform(3, 20)  # noqa: E741
    slide = source.choice((-1, 1)) * source.uniform(0.02, 1.8)
    stress = 10 ** source.uniform(6.0, 7.5) if source.random() < 0.5 else None
    domain = {"x_inlet": -source.uniform(3.0, 12.0), "x_outlet": 2.0, "intervals": 2 ** source.randint(8, 11)}
    return beside(steel(m, l, slide, stress), domain, GRADED)


def mixed(source: random.Random, i: int) -> Member:
    """Rough contacts of 0.3 to 1.2 GPa on given grids, asperities bear hardly any load or nearly all; some starve or are warm."""
    hertz, l = log_uniform(source, 0.3e9, 1.2e9), log_uniform(source, 1, 18)  # noqa: E741
    stress, is_warm = (log_uniform(source, 2e6, 1e7) if i % 4 < 2 else None), source.random() < 0.3
    slide = source.choice((0.05, 0.3, 1.5) if is_warm else (0.0, 0.05, 0.3, 1.5))
    groups = steel(load_number(hertz, l), l, slide, stress, source.choice(LAWS) if stress is None else LAWS[3])
    film = scales(groups)[1]
    rms = film * log_uniform(source, 0.2, 10)
    pressure, decay = hertz * source.uniform(0.5, 6), rms * source.uniform(0.3, 0.55)
    law = {"law": "exponential", "contact_pressure": pressure, "decay_length": decay}
    if i % 2:
        radius = {"density_radius_height": source.uniform(0.03, 0.06), "height_over_radius": log_uniform(source, 1e-4, 1e-2)}
        law = {"law": "greenwood_tripp"} | radius
    groups["asperities"] = law | {"rms_height": rms, "flow": source.choice(("none", "patir_cheng"))}
    if source.random() < 0.3:
        groups["supply"] = {"film": max(film, rms) * log_uniform(source, 0.1, 1)}
    if is_warm:
        groups["thermal"] = {"temperature": source.uniform(20, 100)}
        groups["lubricant"]["thermal_viscosity"] = source.uniform(0.02, 0.06)
    groups["domain"] = {"intervals": source.choice((256, 512, 1024))}
    return Member(groups, finer_sample(groups, 2))


def point(source: random.Random, i: int) -> Member:
    """Circles and ellipses on 64 or 128 intervals: in turn by Moes' numbers, rolling, and in SI, sliding, one of two Eyring's.

    Half of the ellipses in SI are turned. The truth has four times the intervals: a sixteenth of the error; on the same domain,
    with which rolling friction grows.
    """
    m, l, ratio = log_uniform(source, 1, 1000), source.uniform(0, 20), log_uniform(source, 0.1, 3)  # noqa: E741
    law, n = source.choice(OILS), source.choice((64, 128))
    if i % 2 == 0:
        groups = plane(m, l, law)
        groups["moes"] |= {"radius_ratio": 1.0 if i % 4 else ratio}
    else:
        m, l, stress = log_uniform(source, 1, 5000), max(l, 2.0), log_uniform(source, 2e6, 20e6)  # noqa: E741
        groups = steel(m, l, source.uniform(0.05, 1.5), stress if i % 4 == 1 else None, law)
        groups = point_in_si(source, groups, m, ratio)
    groups |= POINT
    return beside(groups, {"intervals_x": n}, {"intervals_x": 4 * n})


def point_in_si(source: random.Random, groups: Groups, m: float, ratio: float) -> Groups:
    """A line of this M in SI as the point of that M; half of the ellipses turned."""
    unit = groups["load"]["load_per_length"] / m  # sqrt(U) E' R
    angle = source.uniform(0, 90) if source.random() < 0.5 else 0.0
    axes = {"reduced_radius_x": namelists.RADIUS, "reduced_radius_y": namelists.RADIUS / ratio, "entrainment_angle": angle}
    groups["bodies"] |= axes | {"reduced_radius": None}
    # w = M U^(3/4) E' R^2
    groups["load"] = {"load": m * unit**1.5 * math.sqrt(namelists.RADIUS / namelists.STEEL_MODULUS)}
    return groups | POINT


def half_axis(groups: Groups) -> float:
    """a of a circle with the radius, the modulus and the load of a point [m]."""
    bodies = groups["bodies"]
    return (1.5 * groups["load"]["load"] * bodies["reduced_radius_x"] / bodies["reduced_modulus"]) ** (1 / 3)

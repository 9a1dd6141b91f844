"""Namelists of the contacts that the benches solve, as groups of keys and as text."""

from __future__ import annotations

import math

Groups = dict[str, dict]

# Thesis, Table 5.1.
CASE_1 = {
    "bodies": {
        **{"radius_1": 0.01, "radius_2": 2.0, "youngs_modulus_1": 206e9, "youngs_modulus_2": 206e9},
        **{"poisson_ratio_1": 0.3, "poisson_ratio_2": 0.3, "speed_1": 0.1, "speed_2": 1.1},
    },
    "load": {"load_per_length": 1e5},
    "lubricant": {
        **{"viscosity": 0.14, "viscosity_law": "roelands", "roelands_z": 0.6, "roelands_p0": 1.98e8},
        **{"density_law": "dowson_higginson", "rheology": "eyring", "eyring_stress": 3.3e6},
    },
}
RIDGE = {"shape": "feature", "amplitude": 0.2e-6, "wavelength": 0.1e-3, "position": -2.5}
# Half-width and central film of Case 1 [m].
CASE_1_HALF_WIDTH = 1.05797e-4
CASE_1_FILM = 0.469 * CASE_1_HALF_WIDTH**2 / (1 / (1 / 0.01 + 1 / 2.0))
WINDOW = {"x_inlet": -4.0, "x_outlet": 1.5}
NO_BARS = {"error_bars": False}
# Nothing but the numbers.
BARE = {"accuracy": NO_BARS, "output": {"adequacy": False}}
LAWS = tuple({"viscosity_law": v, "density_law": d} for v in ("barus", "roelands") for d in ("constant", "dowson_higginson"))

# A steel contact with a mineral oil, for contacts in SI with given Moes numbers.
STEEL_MODULUS = 226.4e9
OIL_ALPHA = 2.2e-8
OIL_VISCOSITY = 0.04
RADIUS = 0.01


def value_text(value: object) -> str:
    """A value as a namelist has it."""
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, str):
        return f"'{value}'"
    if isinstance(value, (list, tuple)):
        return ", ".join(value_text(each) for each in value)
    return repr(value)


def namelist(groups: Groups | str) -> str:
    """The text of a namelist; empty groups and values that are None are left out."""
    if isinstance(groups, str):
        return groups
    lines = []
    for name, keys in ({"case": {"problem": "ehl_line"}} | groups).items():
        kept = {key: value for key, value in keys.items() if value is not None}
        if kept:
            lines += [f"&{name}", *(f"   {key} = {value_text(value)}" for key, value in kept.items()), "/"]
    return "\n".join(lines) + "\n"


def merged(groups: Groups, **others: dict) -> Groups:
    """Groups with further ones, or with changes of their own."""
    return {name: groups.get(name, {}) | others.get(name, {}) for name in groups | others}


def case_1(intervals: int | None, solver: dict | None = None, **others: dict) -> str:
    """Chapter 5, Case 1 on X in [-4, 1.5]; `others` are further groups, or changes of its own."""
    return namelist(merged(CASE_1 | {"domain": WINDOW | {"intervals": intervals}, "solver": solver or {}}, **others))


def plane(m: float, oil: float, law: dict | None = None) -> Groups:
    """Groups of a smooth Newtonian contact by Moes' numbers (speed sum); Barus and incompressible without a law."""
    barus = {"viscosity_law": "barus" if oil > 0 else "constant", "density_law": "constant"}
    return {"moes": {"moes_m": m, "moes_l": oil, "velocity": "sum"}, "lubricant": barus | (law or {})}


def moes(m: float, oil: float, intervals: int | None, solver: dict | None = None, **others: dict) -> str:
    """Its text; the domain is chosen by the program unless `domain` is given."""
    return namelist(merged(plane(m, oil) | {"solver": solver or {}, "domain": {"intervals": intervals}}, **others))


def steel(m: float, l: float, slide: float = 0.0, eyring_stress: float | None = None, law: dict | None = None) -> Groups:  # noqa: E741
    """Groups of a contact in SI with the Moes numbers (speed sum) M and L: steel, mineral oil, u2 faster than u1."""
    speed_number = (l / (OIL_ALPHA * STEEL_MODULUS)) ** 4  # mu_0 u_s/(E' R)
    speed_sum = speed_number * STEEL_MODULUS * RADIUS / OIL_VISCOSITY
    load = m * math.sqrt(speed_number) * STEEL_MODULUS * RADIUS
    oil = {"viscosity": OIL_VISCOSITY, "pressure_viscosity": OIL_ALPHA, "roelands_p0": 1.96e8} | (law or {})
    if oil.get("viscosity_law") == "barus":
        del oil["roelands_p0"]
    if eyring_stress is not None:
        oil |= {"rheology": "eyring", "eyring_stress": eyring_stress}
    speeds = {f"speed_{i}": 0.5 * speed_sum * (1 + sign * 0.5 * slide) for i, sign in ((1, -1), (2, 1))}
    bodies = {"reduced_radius": RADIUS, "reduced_modulus": STEEL_MODULUS} | speeds
    return {"bodies": bodies, "load": {"load_per_length": load}, "lubricant": oil}


def scales(groups: Groups, elastic: float = 1.0) -> tuple[float, float]:
    """Half-width and a rough film [m] of such a contact, for the sizes of what is rough on its surfaces.

    The film is the larger one of Moes' rigid isoviscous and elastic piezoviscous asymptotes, the latter with the factor `elastic`.
    """
    bodies, oil = groups["bodies"], groups["lubricant"]
    load, modulus, radius = groups["load"]["load_per_length"], bodies["reduced_modulus"], bodies["reduced_radius"]
    speed = oil["viscosity"] * (bodies["speed_1"] + bodies["speed_2"]) / (modulus * radius)
    m, l = load / (modulus * radius * math.sqrt(speed)), oil["pressure_viscosity"] * modulus * speed**0.25  # noqa: E741
    film = max(2.45 / m, elastic * m**-0.125 * l**0.75) * math.sqrt(speed) * radius
    return math.sqrt(8 * load * radius / (math.pi * modulus)), film

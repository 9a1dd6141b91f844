#!/usr/bin/env python3
"""Section 2.1 of the thesis: dependence of film and waviness on load, speed, radius, modulus, viscosity and its pressure
coefficient.

Exponents d ln h/d ln q of smooth contacts, by central differences of computed films, against those of the fit of Moes; and the
exponents of (2.3), d ln(A_d/A_i)/d ln q over d ln(A_d/A_i)/d ln Lambda of the linear response, pure rolling.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from linear_response import Advection, LinearFilm, linear_film, read_smooth
from study import Case, Claims, Runner, Table, finish, new_parser

PROGRAM = "trends.py"
# The inputs of (2.3) with their exponents there.
PRINTED = {"w": 1 / 4, "u": -1 / 2, "R": -3 / 4, "E'": -1 / 4, "mu_0": -1 / 2, "alpha": -1 / 2}
KEYS = {
    "w": (("load", "load_per_length"),),
    "u": (("bodies", "speed_1"), ("bodies", "speed_2")),
    "R": (("bodies", "reduced_radius"),),
    "E'": (("bodies", "reduced_modulus"),),
    "mu_0": (("lubricant", "viscosity"),),
    "alpha": (("lubricant", "pressure_viscosity"),),
}
STEP, INTERVALS = 1.05, 4096
MODULUS, RADIUS, SPEED, VISCOSITY = 226e9, 0.01, 0.5, 0.04
FILMS = ("h_min", "h_central")
WAVES = (0.5, 1.0)  # wavelengths in half-widths of the contact that nothing was changed of


def moes_contact(moes_m: float, moes_l: float) -> Case:
    """Barus, Newtonian, constant density: only Moes' numbers matter (sum of the speeds); in SI."""
    speed = 2 * VISCOSITY * SPEED / (MODULUS * RADIUS)
    return {
        "case": {"problem": "ehl_line"},
        "bodies": {"reduced_radius": RADIUS, "reduced_modulus": MODULUS, "speed_1": SPEED, "speed_2": SPEED},
        "load": {"load_per_length": moes_m * math.sqrt(speed) * MODULUS * RADIUS},
        "lubricant": {
            "viscosity": VISCOSITY,
            "viscosity_law": "barus",
            "pressure_viscosity": moes_l / (MODULUS * speed**0.25),
            "density_law": "constant",
        },
    }


def thesis_contact(eyring_stress: float | None) -> Case:
    """Case 1, (2.27) with alpha and z given; without Eyring stress Newtonian, in pure rolling."""
    oil = {"viscosity": 0.14, "pressure_viscosity": 2.3345e-8, "roelands_z": 0.6}
    speeds = {"speed_1": 0.6, "speed_2": 0.6}
    if eyring_stress:
        oil |= {"rheology": "eyring", "eyring_stress": eyring_stress}
        speeds = {"speed_1": 0.1, "speed_2": 1.1}
    return {
        "case": {"problem": "ehl_line"},
        "bodies": {"reduced_radius": 1 / (1 / 0.01 + 1 / 2.0), "reduced_modulus": 206e9 / (1 - 0.3**2), **speeds},
        "load": {"load_per_length": 1e5},
        "lubricant": oil,
    }


CONTACTS = {
    "rigid, constant viscosity": moes_contact(0.1, 0.1),
    "soft, constant viscosity": moes_contact(50, 0.1),
    "rigid, viscosity rises": moes_contact(4, 40),
    "both": moes_contact(200, 15),
    "Case 1, Newtonian": thesis_contact(None),
    "Case 1": thesis_contact(3.3e6),
}
# Of the film in Moes' units by M and L at the four asymptotes.
ASYMPTOTES = dict(zip(CONTACTS, ((-1.0, 0.0), (-1 / 5, 0.0), (0.0, 2 / 3), (-1 / 8, 3 / 4)), strict=False))
# Case 1 would leave 0.98 of a waviness as long as b: nothing there depends on anything.
WAVY = {"M = 100, L = 11": moes_contact(100, 11), "M = 20, L = 10": moes_contact(20, 10)}


def scaled(case: Case, name: str, factor: float) -> Case:
    """The contact with one input times `factor`."""
    groups = {group: dict(keys) for group, keys in case.items()}
    for group, key in KEYS[name]:
        groups[group][key] = case[group][key] * factor
    return groups


def prepared(case: Case, intervals: int, domain: dict[str, object]) -> Case:
    """The namelist of a run: smooth, space scheme of the thesis, nothing computed beside the solution."""
    return case | {
        "domain": {"intervals": intervals, **domain},
        "solver": {"space_scheme": "upwind2", "tolerance": 1e-9},
        "accuracy": {"error_bars": False},
        "output": {"adequacy": False},
    }


def films(_: str, path: Path) -> dict[str, float]:
    """Films in m, and Moes' numbers."""
    with h5py.File(path) as file:
        numbers = {name: float(file["scaling"].attrs[name]) for name in ("moes_m_sum", "moes_l_sum")}
        return numbers | {name: float(file["summary"][name][()]) for name in FILMS}


def by_inputs(by_m: float, by_l: float) -> dict[str, float]:
    """Exponents of h in the inputs from those of h/R sqrt(E' R/(mu_0 u_s)) in M and L."""
    speed = 1 / 2 - by_m / 2 + by_l / 4
    modulus = -1 / 2 - by_m / 2 + 3 / 4 * by_l
    return {"w": by_m, "u": speed, "R": 1 / 2 - by_m / 2 - by_l / 4, "E'": modulus, "mu_0": speed, "alpha": by_l}


def moes_film(moes_m: float, moes_l: float) -> float:
    """Central film in Moes' units, sum of the speeds: the fit of Nijenbanning, Venner and Moes (1994), as in moes.f90."""
    rigid, soft = 2.4475 / moes_m, 2.621 * moes_m**-0.2
    stiff, both = 1.287 * moes_l ** (2 / 3), 1.311 * moes_m**-0.125 * moes_l**0.75
    power = (7 + 8 * math.exp(-2 * min(soft / rigid, 100))) / 5
    isoviscous = (rigid ** (7 / 3) + soft ** (7 / 3)) ** (3 / 7)
    piezoviscous = (stiff**-3.5 + both**-3.5) ** (-2 / 7)
    return (isoviscous**power + piezoviscous**power) ** (1 / power)


def slope(function: Callable[[float], float], step: float = STEP) -> float:
    """d ln f/d ln x at x = 1, by a central difference."""
    return (math.log(function(step)) - math.log(function(1 / step))) / (2 * math.log(step))


def study_films(runner: Runner, names: list[str]) -> Table:
    """Exponents of both films; error: what half the intervals and twice the difference change."""
    forms = {"given": (INTERVALS, STEP), "half": (INTERVALS // 2, STEP), "wide": (INTERVALS, STEP**2)}
    cases = {f"{i}_base": prepared(CONTACTS[name], INTERVALS, {}) for i, name in enumerate(names)}
    for i, name in enumerate(names):
        for k, key in enumerate(KEYS):
            for form, (intervals, step) in forms.items():
                for side in (1, -1):
                    contact = scaled(CONTACTS[name], key, step**side)
                    cases[f"{i}_{k}_{form}_{side}"] = prepared(contact, intervals, {})
    found = runner.run(cases, films)
    table = Table(
        contact="contact",
        moes_m="M, sum of the speeds",
        moes_l="L, sum of the speeds",
        input="input",
        h_min="exponent of h_min",
        h_central="exponent of the central film",
        error="the larger one of their errors",
        moes="exponent of the central film by the fit of Moes",
        asymptote="exponent at the asymptote",
    )
    for i, name in enumerate(names):
        base = found[f"{i}_base"]
        m, oil = base["moes_m_sum"], base["moes_l_sum"]
        fit = by_inputs(slope(lambda f, m=m, oil=oil: moes_film(f * m, oil)), slope(lambda f, m=m, oil=oil: moes_film(m, f * oil)))
        limit = by_inputs(*ASYMPTOTES[name]) if name in ASYMPTOTES else {}
        for k, key in enumerate(KEYS):
            row, errors = {}, []
            for film in FILMS:
                sides = {form: [math.log(found[f"{i}_{k}_{form}_{side}"][film]) for side in (1, -1)] for form in forms}
                value = {form: (sides[form][0] - sides[form][1]) / (2 * math.log(step)) for form, (_, step) in forms.items()}
                row[film] = value["given"]
                errors.append(abs(value["half"] - value["given"]) + abs(value["wide"] - value["given"]))
            numbers = {"moes_m": m, "moes_l": oil, "error": max(errors), "moes": fit[key], "asymptote": limit.get(key)}
            table.add(contact=name, input=key, **row, **numbers)
    return table


def reduced(smooth: object, wavelength: float) -> float:
    """Modulus of A_d/A_i at X = 0 in pure rolling; `wavelength` in half-widths of this contact."""
    found: LinearFilm = linear_film(smooth, wavelength, Advection.CHARACTERISTIC)
    return abs(found.ratio())


def study_waves(runner: Runner, names: list[str], intervals: int) -> Table:
    """Exponents of (2.3) from the amplitude that is left of a waviness of given wavelength in m."""
    grids = (intervals, intervals // 2)
    domain = {"x_inlet": -2.5, "x_outlet": 1.5}
    places = {("base", 0): (None, 0)} | {(key, side): (key, side) for key in KEYS for side in (1, -1)}
    cases = {}
    for i, name in enumerate(names):
        for k, (key, side) in enumerate(places.values()):
            contact = scaled(WAVY[name], key, STEP**side) if key else WAVY[name]
            for n in grids:
                cases[f"{i}_{k}_{n}"] = prepared(contact, n, domain)

    def read(name: str, path: Path) -> tuple[object, float]:
        with h5py.File(path) as file:
            return read_smooth(name, path), float(file["scaling"].attrs["half_width"])

    found = runner.run(cases, read)
    table = Table(
        contact="contact",
        wavelength="wavelength over the half-width",
        ratio="A_d/A_i at X = 0",
        input="input",
        amplitude="d ln(A_d/A_i)/d ln(input), wavelength in m unchanged",
        exponent="the same over d ln(A_d/A_i)/d ln(wavelength): what (2.3) says of the input",
        error="error of the exponent: what half the intervals change",
        printed="exponent of (2.3)",
    )
    keys = list(places)
    for i, name in enumerate(names):
        half_width = found[f"{i}_0_{intervals}"][1]
        for wave in WAVES:

            def left(place: int, n: int, factor: float = 1.0, i: int = i, metres: float = wave * half_width) -> float:
                smooth, width = found[f"{i}_{place}_{n}"]
                return math.log(reduced(smooth, factor * metres / width))

            by_wave = {n: (left(0, n, STEP) - left(0, n, 1 / STEP)) / (2 * math.log(STEP)) for n in grids}
            ratio = math.exp(left(0, intervals))
            for key, printed in PRINTED.items():
                up, down = keys.index((key, 1)), keys.index((key, -1))
                change = {n: (left(up, n) - left(down, n)) / (2 * math.log(STEP)) for n in grids}
                value, half = (change[n] / by_wave[n] for n in grids)
                numbers = {"amplitude": change[intervals], "exponent": value, "error": abs(value - half), "printed": printed}
                table.add(contact=name, wavelength=wave, ratio=ratio, input=key, **numbers)
    return table


def judge(claims: Claims, films_table: Table, waves: Table) -> None:
    """The sentence below (2.3), and its exponents."""
    signs = np.sign(waves.column("amplitude"))
    wanted = [-math.copysign(1, PRINTED[key]) for key in waves.column("input")]
    claims.check(
        "(2.3): a decrease of w, or an increase of u_s, R, E', mu_0 or alpha leaves more of the roughness",
        bool(np.all(signs == wanted)) or f"partly: {np.count_nonzero(signs == wanted)} of {len(wanted)}",
        "; ".join(f"{key} {value:+.2f}" for key, value in zip(PRINTED, waves.column("amplitude"), strict=False))
        + f" ({waves.rows[0]['contact']}, wavelength {WAVES[0]:g} b)",
    )
    off = np.abs(waves.column("exponent") - waves.column("printed"))
    worst = int(np.argmax(off))
    claims.check(
        "(2.3): exponents w 1/4, u -1/2, R -3/4, E' -1/4, mu_0 -1/2, alpha -1/2",
        bool(off.max() < 0.05) or f"partly: within {off.max():.2f}",
        f"largest distance {off.max():.3f}, {waves.rows[worst]['input']} of {waves.rows[worst]['contact']}",
    )
    off = np.abs(films_table.column("h_central") - films_table.column("moes"))
    worst = films_table.rows[int(np.argmax(off))]
    claims.check(
        "the fit of Moes has the exponents of the computed central films",
        bool(off.max() < 0.05) or f"partly: within {off.max():.2f}",
        f"largest distance {off.max():.3f}, {worst['input']} of {worst['contact']}",
    )


def study(options: argparse.Namespace) -> None:
    """Both tables and the statements."""
    runner = Runner(options.output, options.jobs, options.program)
    films_table = study_films(runner, list(CONTACTS))
    waves = study_waves(runner, list(WAVY)[:1] if options.quick else list(WAVY), 512 if options.quick else 2048)
    numbers = dict.fromkeys(("h_min", "h_central", "moes", "asymptote"), "+.3f") | {"error": ".4f"}
    films_table.show("Exponents of films", contact="", moes_m=".3g", moes_l=".3g", input="", **numbers)
    numbers = dict.fromkeys(("ratio", "amplitude", "exponent", "printed"), "+.3f") | {"error": ".4f"}
    waves.show("Exponents of (2.3)", contact="", wavelength="g", input="", **numbers)
    films_table.write(options.output / "trends_films", "Exponents of films in the inputs")
    waves.write(options.output / "trends_waves", "Exponents of (2.3) from amplitudes")
    claims = Claims()
    judge(claims, films_table, waves)
    claims.show()
    claims.table.write(options.output / "statements", "Statements of section 2.1 on trends")
    print(runner.effort)


def main() -> None:
    """Command line."""
    finish(new_parser(PROGRAM, __doc__, "results/trends"), study)


if __name__ == "__main__":
    main()

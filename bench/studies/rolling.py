"""Waviness in pure rolling against Table 1 of Venner, Couhier, Lubrecht and Greenwood (1997): M = 100, L = 11 (speed sum).

Time marching by the program, and the linear response of the same contact in the frequency domain (linear_response.py), which has
no time step and, along the characteristics, another discretisation of advection.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import replace

from linear_response import Advection, linear_film, read_smooth
from study import Case, Claims, Runner, StudyError, Table
from waviness import Waviness, linear_films, run_all

VENNER = {4.0: 0.030, 2.0: 0.073, 1.0: 0.183, 0.5: 0.394, 0.25: 0.660, 0.125: 0.839}
TOLERANCE = 0.03
ROUNDING = 0.0005
SHORTEST = 0.125
FINEST = 4096  # intervals of the largest linear problem
Job = tuple[Waviness, Advection]


def intervals_for(wavelength: float, slip: float = 0.0) -> int:
    """Power of two with at least 64 nodes a wave, not below 1024."""
    needed = 64 * 4 * max(1.0, 1 - slip / 2) / wavelength
    return max(1024, 2 ** math.ceil(math.log2(needed) - 1e-9))


def with_nodes(nodes: int, wavelength: float = SHORTEST, **others: object) -> Waviness:
    """A run with just so many intervals on a wave, and the inlet between -2.5 and -4.6."""
    intervals = 2 ** math.ceil(math.log2(4 * nodes / wavelength) - 1e-9)
    return Waviness(wavelength=wavelength, intervals=intervals, inlet=1.5 - intervals * wavelength / nodes, **others)


def linear_ratios(runner: Runner, jobs: list[Job]) -> dict[Job, float]:
    """|A_d/A_i| at X = 0 by the linear response."""
    return {job: abs(film.ratio()) for job, film in linear_films(runner, jobs).items()}


def rolling_table(runner: Runner, wavelengths: tuple[float, ...], coarser: int = 1) -> Table:
    """Table 1 of Venner et al. by time marching; `coarser` divides the number of nodes."""
    runs = []
    for wavelength in wavelengths:
        given = Waviness(wavelength=wavelength, intervals=intervals_for(wavelength) // coarser)
        runs += [given] if coarser > 1 else [given, given.finer(2)]
    found = run_all(runner, runs)
    linear = linear_ratios(runner, [(run, Advection.BDF2) for run in runs])
    table = Table(
        wavelength="Lambda/b",
        nodes="intervals on a wave",
        ratio="A_d/A_i, half of largest minus smallest H(0, T), time marching",
        linear="its linear response with the same grid and step",
        error="a third of the change to twice the nodes; of these, a third of it",
        phase="phase of the first harmonic at X = 0 [degrees]",
        published="Venner et al. (1997), Table 1",
        deviation="deviation of ratio from it [%]",
        drift="change of the ratio over the last period",
    )
    for run, answer in found.items():
        other = found.get(run.finer(2)) or found.get(run.finer(0.5))
        value = VENNER[run.wavelength]
        table.add(
            wavelength=run.wavelength,
            nodes=run.nodes,
            ratio=answer.swing,
            linear=linear[run, Advection.BDF2],
            error=None if other is None else abs(other.swing - answer.swing) / 3 * (4 if run.finer(2) in found else 1),
            phase=math.degrees(cmath.phase(answer.ratio)),
            published=value,
            deviation=100 * (answer.swing / value - 1),
            drift=answer.drift,
        )
    return table


def check_rolling(table: Table, wavelengths: tuple[float, ...]) -> None:
    """Within 3 % and the rounding of the table, and the linear response within 0.2 %; a miss ends the study."""
    for row in table.rows:
        bound = TOLERANCE * row["published"] + ROUNDING
        if row["wavelength"] in wavelengths and abs(row["ratio"] - row["published"]) > bound:
            raise StudyError(
                f"Lambda/b = {row['wavelength']}: ratio {row['ratio']:.4f}, published {row['published']} +- {bound:.4f}"
            )
        if abs(row["ratio"] / row["linear"] - 1) > 0.002:
            raise StudyError(f"Lambda/b = {row['wavelength']}: ratio {row['ratio']:.4f}, linear response {row['linear']:.4f}")


def best_table(runner: Runner) -> Table:
    """The value for vanishing grid and step of each wavelength, and what a coarse grid would have given."""
    fine = {w: FINEST if w == SHORTEST else FINEST // 2 for w in VENNER}
    pairs = {w: tuple(Waviness(wavelength=w, intervals=n) for n in (top // 2, top)) for w, top in fine.items()}
    coarse = {w: with_nodes(48, w) if w < 0.5 else Waviness(wavelength=w, intervals=512) for w in VENNER}
    jobs = [(run, Advection.CHARACTERISTIC) for pair in pairs.values() for run in pair]
    jobs += [(run, Advection.BDF2) for run in coarse.values()]
    found = linear_ratios(runner, jobs)
    table = Table(
        wavelength="Lambda/b",
        half="linear response along the characteristics, half the nodes",
        given="the same, 2048 intervals (4096 at Lambda/b = 0.125)",
        best="extrapolated to vanishing dX (second order)",
        error="what the extrapolation changes",
        published="Venner et al. (1997), Table 1",
        deviation="deviation of best from it [%]",
        coarse="linear response of the program's scheme, dT = dX, with 512 intervals or 48 on a wave, whichever are more",
        coarse_deviation="deviation of coarse from the published value [%]",
    )
    for wavelength, published in VENNER.items():
        half, given = (found[run, Advection.CHARACTERISTIC] for run in pairs[wavelength])
        best, rough = given + (given - half) / 3, found[coarse[wavelength], Advection.BDF2]
        row = {"wavelength": wavelength, "half": half, "given": given, "best": best, "error": abs(best - given)}
        row |= {"published": published, "deviation": 100 * (best / published - 1)}
        table.add(**row, coarse=rough, coarse_deviation=100 * (rough / published - 1))
    return table


def order_table(runner: Runner, best: float) -> Table:
    """The shortest wave over nodes and steps: time marching, and the linear response of each discretisation."""
    kinds = {
        "bdf2": (Advection.BDF2, 1),
        "bdf2_half": (Advection.BDF2, 2),
        "exact": (Advection.EXACT_TIME, 1),
        "euler": (Advection.EULER, 1),
        "characteristic": (Advection.CHARACTERISTIC, 1),
    }
    runs = {nodes: with_nodes(nodes) for nodes in (24, 32, 48, 64, 96, 128)}
    cheap = {kind: [n for n, run in runs.items() if run.intervals < FINEST or kind in ("bdf2", "characteristic")] for kind in kinds}
    jobs = {(kind, n): (replace(runs[n], steps=kinds[kind][1]), kinds[kind][0]) for kind, nodes in cheap.items() for n in nodes}
    linear = linear_ratios(runner, list(jobs.values()))
    found = {key: linear[job] for key, job in jobs.items()}
    marched = {nodes: run for nodes, run in runs.items() if run.intervals < FINEST}
    other = {"euler": with_nodes(64, scheme="backward_euler"), "bdf2_half": with_nodes(64, steps=2)}
    kappa = {nodes: replace(run, space="kappa") for nodes, run in marched.items()}
    responses = run_all(runner, [*marched.values(), *other.values(), *kappa.values()])
    table = Table(
        nodes="intervals on a wave",
        marched="A_d/A_i by the program, BDF2, dT = dX",
        bdf2="linear response of the same",
        order="its observed order: fall of the distance to the best value to twice the nodes",
        bdf2_half="BDF2, dT = dX/2",
        exact="no error in time",
        euler="backward Euler, dT = dX",
        characteristic="along the characteristics",
        marched_euler="by the program, backward Euler, dT = dX",
        marched_half="by the program, BDF2, dT = dX/2",
        marched_kappa="by the program with its kappa space scheme, BDF2, dT = dX",
    )
    for nodes in runs:
        row = {kind: found.get((kind, nodes)) for kind in kinds}
        if 2 * nodes in runs:
            row["order"] = math.log2((best - row["bdf2"]) / (best - found["bdf2", 2 * nodes]))
        if nodes in marched:
            row |= {"marched": responses[marched[nodes]].swing, "marched_kappa": responses[kappa[nodes]].swing}
        if nodes == 64:
            row |= {"marched_euler": responses[other["euler"]].swing, "marched_half": responses[other["bdf2_half"]].swing}
        table.add(nodes=nodes, **row)
    return table


def readings_table(runner: Runner) -> Table:
    """What else the published contact could have been: linear response along the characteristics, dX = 4/1024."""
    given = Waviness()

    def with_oil(**keys: object) -> Case:
        case = given.smooth()
        oil = {**case["lubricant"], **keys}
        return {**case, "lubricant": {key: value for key, value in oil.items() if value is not None}}

    readings = {
        "as above": given.smooth(),
        "inlet at X = -6.5": Waviness(intervals=2048, inlet=-6.5).smooth(),
        "P0 = 1.98e8 Pa": with_oil(roelands_p0=1.98e8),
        "z = 0.6": with_oil(roelands_p0=None, roelands_z=0.6),
        "incompressible": with_oil(density_law="constant"),
        "Barus": with_oil(viscosity_law="barus", roelands_p0=None),
        "M, L with the mean speed": Waviness(100 / math.sqrt(2), 11 * 2**0.25).smooth(),
        "M = 110": Waviness(110).smooth(),
        "L = 10": Waviness(100, 10).smooth(),
    }
    smooth = runner.run({f"reading_{i}": case for i, case in enumerate(readings.values())}, read_smooth)
    columns = {f"ratio_{w:g}": f"A_d/A_i at Lambda/b = {w:g}" for w in VENNER}
    table = Table(reading="contact or place", **columns)
    table.add(reading="published", **dict(zip(columns, VENNER.values(), strict=True)))
    for words, contact in [*zip(readings, smooth.values(), strict=True), ("amplitude at X = -0.5", smooth["reading_0"])]:
        place = -0.5 if "-0.5" in words else 0.0
        ratios = [abs(linear_film(contact, w, Advection.CHARACTERISTIC).ratio(place)) for w in VENNER]
        table.add(reading=words, **dict(zip(columns, ratios, strict=True)))
    return table


def check_table_1(claims: Claims, best: Table, orders: Table, readings: Table) -> None:
    """Which value of the shortest wave is right, and why."""
    rows = {row["wavelength"]: row for row in best.rows}
    claims.check(
        "Venner et al. (1997), Table 1, within 3 % and the rounding",
        "agrees except at Lambda/b = 0.125",
        ", ".join(f"{w:g}: {row['best']:.4f} +- {row['error']:.4f} ({row['deviation']:+.1f} %)" for w, row in rows.items()),
    )
    if abs(rows[SHORTEST]["best"] - VENNER[SHORTEST]) < TOLERANCE * VENNER[SHORTEST]:
        raise StudyError("Lambda/b = 0.125 agrees with the published value: the page says it does not")
    finest = orders.rows[-1]
    claims.check(
        "Lambda/b = 0.125: two discretisations and both ways of time come to one value",
        abs(finest["bdf2"] / rows[SHORTEST]["best"] - 1) < 0.004,
        f"{finest['bdf2']:.4f} and {finest['characteristic']:.4f} with {finest['nodes']} nodes, limit "
        f"{rows[SHORTEST]['best']:.4f}; order " + ", ".join(f"{row['order']:.2f}" for row in orders.rows if row.get("order")),
    )
    claims.check(
        "The published values are those of a coarse grid: 512 intervals, or 48 on a wave if that is more, by the program's scheme",
        max(abs(row["coarse_deviation"]) for row in best.rows) < 2,
        ", ".join(f"{w:g}: {row['coarse']:.4f} ({row['coarse_deviation']:+.1f} %)" for w, row in rows.items()),
    )

    def worst(row: dict[str, object]) -> float:
        return max(abs(row[f"ratio_{w:g}"] / value - 1) for w, value in VENNER.items())

    nearest = min(readings.rows[1:], key=worst)
    claims.check(
        "No other reading of the contact gives the table",
        worst(nearest) > 0.05,
        f"the nearest, '{nearest['reading']}', is off by up to {100 * worst(nearest):.1f} %; at Lambda/b = 0.125 they give "
        f"{min(row['ratio_0.125'] for row in readings.rows[1:]):.3f} to {max(row['ratio_0.125'] for row in readings.rows[1:]):.3f}",
    )

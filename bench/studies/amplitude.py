#!/usr/bin/env python3
"""Amplitude reduction of harmonic waviness: pure rolling (table and master curve), rolling-sliding, range of linearity.

The linear response in the frequency domain gives the ratios of vanishing amplitude, each with its error; time marching by the
program checks them and their range.
"""

from __future__ import annotations

import argparse
import cmath
import math
from dataclasses import replace

import amplitude_figures
import numpy as np
from linear_response import Advection, LinearFilm
from rolling import (
    SHORTEST,
    VENNER,
    best_table,
    check_rolling,
    check_table_1,
    intervals_for,
    order_table,
    readings_table,
    rolling_table,
)
from study import Claims, Runner, Table, finish, new_parser
from waviness import Waviness, compressed, linear_films, run_all, smooth_contacts, take_apart

PROGRAM = "amplitude.py"
POINTS = ((20, 10), (50, 5), (50, 15), (100, 11), (200, 8), (500, 5))
WAVELENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0)
SLIPS = (-2.0, -4 / 3, -2 / 3, 0.0, 2 / 3, 4 / 3, 2.0)
SLIDING_WAVELENGTHS = (0.25, 0.5, 1.0, 2.0)
SMALL = 0.02  # amplitude over the film; a tenth is not small for a wave of 0.25 b on a fast surface
AMPLITUDES = (SMALL, 0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5)
ENTRY = 1.0  # half-widths over which a high waviness rises where it enters


def published(nabla: float | np.ndarray) -> float | np.ndarray:
    """Master curve of Venner et al. (1997), line contact, pure rolling."""
    return 1 / (1 + 0.17 * nabla + 0.03 * nabla**2)


def thesis(nabla: float | np.ndarray) -> float | np.ndarray:
    """(2.1) of the thesis with s = 1."""
    return 1 / (1 + 0.125 * nabla + 0.04 * nabla**2)


def in_two_grids(runner: Runner, runs: list[Waviness]) -> dict[Waviness, tuple[LinearFilm, LinearFilm]]:
    """Linear response along the characteristics of each run, and with half the nodes."""
    kind = Advection.CHARACTERISTIC
    found = linear_films(runner, [(item, kind) for run in runs for item in (run, run.finer(0.5))])
    return {run: (found[run, kind], found[run.finer(0.5), kind]) for run in runs}


def extrapolated(fine: float, half: float) -> tuple[float, float]:
    """The value for vanishing dX, of second order, and what the extrapolation has changed: the error."""
    return fine + (fine - half) / 3, abs(fine - half) / 3


def master_table(runner: Runner) -> Table:
    """Ratios in pure rolling at several operating points, linear response."""
    runs = [Waviness(*point, wavelength, intervals=2048) for point in POINTS for wavelength in WAVELENGTHS]
    table = Table(
        moes_m="M (speed sum)",
        moes_l="L (speed sum)",
        wavelength="Lambda/b",
        nabla="(Lambda/b) M^(3/4) L^(-1/2)",
        ratio="A_d/A_i, extrapolated from 1024 and 2048 intervals",
        error="what the extrapolation has changed",
        published="1/(1 + 0.17 w + 0.03 w^2), Venner et al. (1997)",
        thesis="1/(1 + 0.125 w + 0.04 w^2), (2.1) with s = 1",
        phase="phase at X = 0 [degrees]",
    )
    for run, (fine, half) in in_two_grids(runner, runs).items():
        ratio, error = extrapolated(abs(fine.ratio()), abs(half.ratio()))
        table.add(
            moes_m=run.moes_m,
            moes_l=run.moes_l,
            wavelength=run.wavelength,
            nabla=run.nabla,
            ratio=ratio,
            error=error,
            published=published(run.nabla),
            thesis=thesis(run.nabla),
            phase=math.degrees(cmath.phase(fine.ratio())),
        )
    return table


def sliding_table(runner: Runner) -> Table:
    """Complex ratios over slide-to-roll ratio and wavelength, M = 100, L = 11."""
    runs = [Waviness(wavelength=w, slip=s, intervals=2048) for s in SLIPS for w in SLIDING_WAVELENGTHS]
    marched = {run: replace(run, intervals=intervals_for(run.wavelength, run.slip), amplitude=SMALL) for run in runs}
    table = Table(
        slip="s = 2 (u2 - u1)/(u1 + u2); the waviness is on surface 1",
        speed="v = u1/u_mean = 1 - s/2",
        wavelength="Lambda/b on the surface",
        ratio="|A_d/A_i| at X = 0, linear response",
        phase="its phase [degrees]",
        carried="|A_d/A_i| of the part carried by the oil, wavelength Lambda/v, extrapolated from 1024 and 2048 intervals",
        error="of carried: what the extrapolation has changed",
        lag="how far it is behind the waviness at X = -1 [degrees]",
        in_place="|A_d/A_i| of the part that moves with the surface",
        compressed="what the compressibility of the oil leaves of it",
        misfit="what the two parts leave unexplained, largest for |X| <= 0.5",
        nabla="(Lambda/b) M^(3/4) L^(-1/2) v^(-1/2)",
        published="1/(1 + 0.17 w + 0.03 w^2) with this w",
        marched="|A_d/A_i| at X = 0 by time marching, at least 64 nodes a wave",
        marching_misfit="distance of its complex ratio to the linear response with the same grid and step",
    )
    films = in_two_grids(runner, runs)
    answers = run_all(runner, list(marched.values()))
    same = linear_films(runner, [(run, Advection.BDF2) for run in marched.values()])
    smooth = smooth_contacts(runner, runs[:1])[runs[0]]
    for run, (fine, half) in films.items():
        parts = take_apart(run, fine)
        carried, error = extrapolated(abs(parts.carried), abs(take_apart(run, half).carried))
        launch = parts.carried * cmath.exp(-1j * fine.number * (1 - run.speed))
        nabla = run.nabla / math.sqrt(run.speed) if run.speed > 0 else math.nan
        answer, linear = answers[marched[run]], same[marched[run], Advection.BDF2]
        table.add(
            slip=run.slip,
            speed=run.speed,
            wavelength=run.wavelength,
            ratio=abs(fine.ratio()),
            phase=math.degrees(cmath.phase(fine.ratio())),
            carried=carried,
            error=error,
            lag=-math.degrees(cmath.phase(launch)),
            in_place=math.nan if run.speed == 1 else abs(parts.in_place),
            compressed=compressed(run, smooth.central_film),
            misfit=parts.misfit,
            nabla=nabla,
            published=published(nabla),
            marched=abs(answer.ratio),
            marching_misfit=abs(answer.ratio - linear.ratio()),
        )
    return table


def linearity_table(runner: Runner) -> Table:
    """Ratio over the amplitude, M = 100, L = 11, pure rolling and s = 1."""
    pairs = [(0.0, wavelength) for wavelength in (0.25, 0.5, 1.0, 2.0)] + [(1.0, 0.5), (-2.0, 0.5)]
    runs = [Waviness(wavelength=w, slip=s, amplitude=a, entry=ENTRY) for s, w in pairs for a in AMPLITUDES]
    table = Table(
        slip="slide-to-roll ratio s",
        wavelength="Lambda/b",
        amplitude="A_i / smooth central film",
        ratio="|first harmonic| at X = 0 over A_i",
        change="its change against the smallest amplitude [%]",
        swing="half of largest minus smallest H(0, T) over A_i",
        second="second harmonic over the first",
        h_min="smallest H near the centre over the smooth central film",
    )
    found = run_all(runner, runs)
    for run, answer in found.items():
        first = found[replace(run, amplitude=AMPLITUDES[0])]
        table.add(
            slip=run.slip,
            wavelength=run.wavelength,
            amplitude=run.amplitude,
            ratio=abs(answer.ratio),
            change=100 * (abs(answer.ratio) / abs(first.ratio) - 1),
            swing=answer.swing,
            second=answer.second,
            h_min=answer.h_min,
        )
    return table


def fitted(table: Table) -> tuple[float, float, float]:
    """c1, c2 of 1/(1 + c1 w + c2 w^2) with least relative deviation for w < 20, and the root mean square of this."""
    rows = [row for row in table.rows if row["nabla"] < 20]
    w, r = (np.array([row[name] for row in rows]) for name in ("nabla", "ratio"))
    c1, c2 = np.linalg.lstsq(np.column_stack((r * w, r * w**2)), 1 - r, rcond=None)[0]
    return float(c1), float(c2), float(np.sqrt(np.mean((r * (1 + c1 * w + c2 * w**2) - 1) ** 2)))


def check_curves(claims: Claims, master: Table) -> None:
    """Pure rolling."""
    ratio, nabla = master.column("ratio"), master.column("nabla")
    for name, words in (("published", "Venner et al. (1997)"), ("thesis", "(2.1) of the thesis with s = 1")):
        deviation = 100 * (master.column(name) / ratio - 1)
        below = deviation[nabla < 20]
        claims.check(
            f"Pure rolling: one curve over w = (Lambda/b) M^(3/4) L^(-1/2) for all operating points, {words}",
            f"within {np.abs(below).max():.0f} % for w < 20, too low beyond",
            f"{len(below)} points with w < 20: the curve deviates by {below.min():+.0f} to {below.max():+.0f} % (root mean square "
            f"{np.sqrt(np.mean(below**2)):.0f} %); beyond, where the ratio is below 0.08, by up to {deviation.min():+.0f} %",
        )
    c1, c2, deviation = fitted(master)
    tail = nabla > 10
    slope = np.polyfit(np.log(nabla[tail]), np.log(ratio[tail]), 1)[0]
    claims.check(
        "Beyond the thesis: the best curve of this form for w < 20, and what follows",
        "ours",
        f"1/(1 + {c1:.3f} w + {c2:.4f} w^2), root mean square {100 * deviation:.0f} %; for w > 10 the ratio falls as w^{slope:.2f}",
    )


def check_sliding(claims: Claims, sliding: Table) -> None:
    """Rolling-sliding."""
    moving = [row for row in sliding.rows if row["speed"] != 1]
    share = 100 * max(row["in_place"] / row["carried"] for row in moving)
    claims.check(
        "Rolling-sliding: the waviness itself is flattened, what is left is a wave that the oil carries",
        share < 15,
        f"part that moves with it at most {max(row['in_place'] for row in moving):.3f}, {share:.0f} % of the carried part; "
        f"the two leave at most {max(row['misfit'] for row in moving):.3f} unexplained",
    )
    far = max(row["marching_misfit"] for row in sliding.rows)
    claims.check(
        "Rolling-sliding: time marching gives the linear response in the frequency domain",
        far < 0.002,
        f"complex ratios at X = 0 differ by at most {far:.4f} (amplitude {SMALL:g} h_c)",
    )
    kinds = dict.fromkeys(row["wavelength"] for row in moving)
    parts = {w: [row["in_place"] for row in moving if row["wavelength"] == w] for w in kinds}
    expected = {row["wavelength"]: row["compressed"] for row in moving}
    claims.check(
        "Beyond the thesis: the part that moves with the surface is the compressibility of the oil",
        max(abs(np.mean(v) / expected[w] - 1) for w, v in parts.items()) < 0.15,
        "found (estimate h_c k dln(rho)/dP) " + ", ".join(f"{w:g}: {np.mean(v):.4f} ({expected[w]:.4f})" for w, v in parts.items()),
    )
    groups = {
        "v >= 2/3": [row for row in sliding.rows if row["speed"] > 0.5],
        "v = 1/3": [r for r in moving if 0 < r["speed"] < 0.5],
    }
    for words, rows in groups.items():
        deviation = [100 * (row["published"] / row["carried"] - 1) for row in rows]
        claims.check(
            f"(2.2): the wavelength counts divided by the root of s, read as v = u_rough/u_mean ({words})",
            max(map(abs, deviation)) < 20,
            "Venner's curve with w = (Lambda/b) M^(3/4) L^(-1/2) v^(-1/2) deviates by "
            f"{min(deviation):+.0f} to {max(deviation):+.0f} %",
        )
    row_at = {row["speed"]: row["carried"] for row in sliding.rows if row["wavelength"] == 0.5}
    claims.check(
        "Section 2.1: a larger slide-to-roll ratio leads to a less reduced amplitude",
        "only where the rough surface is the faster one",
        "Lambda/b = 0.5: " + ", ".join(f"{ratio:.3f} at v = {speed:.2f}" for speed, ratio in row_at.items()),
    )


def check_linear(claims: Claims, linear: Table) -> None:
    """How far linearity reaches."""
    worst = max(linear.rows, key=lambda row: abs(row["change"]))
    where = f"A = {worst['amplitude']:g} h_c, Lambda/b = {worst['wavelength']:g}, s = {worst['slip']:g}"
    limits = (0.1, 0.4, 1.0)
    change = {limit: max(abs(row["change"]) for row in linear.rows if row["amplitude"] <= limit) for limit in limits}
    second = {limit: 100 * max(row["second"] for row in linear.rows if row["amplitude"] <= limit) for limit in limits}
    claims.check(
        "Linearity: the ratio does not depend on the amplitude",
        f"within {change[1.0]:.1f} % up to an amplitude of the film",
        ", ".join(f"at most {change[a]:.1f} % up to {a:g} h_c, second harmonic {second[a]:.1f} % of the first" for a in limits)
        + f"; largest change {worst['change']:+.1f} % at {where}; smallest film {min(row['h_min'] for row in linear.rows):.2f} h_c",
    )


def study(options: argparse.Namespace) -> None:
    """All parts."""
    options.output.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.output / "runs", options.jobs, options.program)
    formats = {"wavelength": "g", "nodes": ".0f", "ratio": ".4f", "error": ".4f", "linear": ".4f", "published": ".3f"}
    formats |= {"deviation": "+.1f", "phase": ".1f", "drift": ".1e"}
    title = "Pure rolling, M = 100, L = 11: amplitude at X = 0 beside Venner et al. (1997), Table 1"
    if options.quick:
        quick = (2.0, 1.0, 0.5)
        table = rolling_table(runner, quick, coarser=2)
        table.show(title, **formats)
        check_rolling(table, quick)
        table.write(options.output / "rolling_quick", title)
        return
    rolling = rolling_table(runner, tuple(VENNER))
    rolling.show(title, **formats)
    check_rolling(rolling, tuple(w for w in VENNER if w > 0.2))
    best = best_table(runner)
    formats = dict.fromkeys(("half", "given", "best", "error"), ".4f") | {"published": ".3f", "deviation": "+.1f"}
    best.show("The same by the linear response", wavelength="g", **formats, coarse=".4f", coarse_deviation="+.1f")
    orders = order_table(runner, next(row["best"] for row in best.rows if row["wavelength"] == SHORTEST))
    orders.show(f"Lambda/b = {SHORTEST:g} over nodes and steps", nodes="", **dict.fromkeys(list(orders.columns)[1:], ".4f"))
    readings = readings_table(runner)
    readings.show("Other readings of the contact", reading="", **dict.fromkeys(list(readings.columns)[1:], ".4f"))
    master = master_table(runner)
    formats = {"moes_m": "g", "moes_l": "g", "wavelength": "g", "nabla": ".2f", "ratio": ".4f", "error": ".4f"}
    master.show("Pure rolling, all operating points", **formats, published=".4f", thesis=".4f", phase=".1f")
    sliding = sliding_table(runner)
    formats = {"slip": "+.3f", "speed": ".3f", "wavelength": "g", "ratio": ".4f", "phase": ".0f", "carried": ".4f"}
    formats |= {"error": ".4f", "lag": ".0f", "in_place": ".4f", "compressed": ".4f", "misfit": ".4f", "nabla": ".2f"}
    sliding.show("Rolling-sliding, M = 100, L = 11", **formats, published=".4f", marched=".4f", marching_misfit=".4f")
    linear = linearity_table(runner)
    formats = {"slip": "g", "wavelength": "g", "amplitude": "g", "ratio": ".4f", "change": "+.2f"}
    linear.show("Linearity, M = 100, L = 11", **formats, swing=".4f", second=".4f", h_min=".3f")
    claims = Claims()
    check_table_1(claims, best, orders, readings)
    check_curves(claims, master)
    check_sliding(claims, sliding)
    check_linear(claims, linear)
    claims.show()
    print(f"\n{runner.effort}")
    tables = {
        "rolling": rolling,
        "best": best,
        "orders": orders,
        "readings": readings,
        "master": master,
        "sliding": sliding,
        "linearity": linear,
        "statements": claims.table,
    }
    for name, table in tables.items():
        table.write(options.output / name, f"Amplitude reduction: {name}")
    curves = {"published": published, "thesis": thesis}
    amplitude_figures.draw(options.output, master, sliding, linear, curves, fitted(master))


def main() -> None:
    """Command line."""
    parser = new_parser(PROGRAM, __doc__, "results/amplitude")
    finish(parser, study)


if __name__ == "__main__":
    main()

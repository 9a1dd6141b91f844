#!/usr/bin/env python3
"""Chapter 5 of the thesis: a smooth contact (Case 1) and a ridge that passes on the slow (2) or the fast surface (3).

Error tables 5.2 and 5.3 by the definitions (5.5) to (5.8) against the printed values, the open choices of the text (alpha and P0,
the pair of grids of the spatial error), figures 5.1 to 5.3, and the statements of the chapter.
"""

from __future__ import annotations

import argparse
import itertools
from dataclasses import dataclass
from pathlib import Path

import chapter5_figures
import h5py
import numpy as np
from chapter5_momentum import compare
from chapter5_passages import compare_passages
from chapter5_readings import PRINTED, Change, change, check_readings, extremes, extremes_table, readings_table
from chapter5_rule import find_rule
from study import Case, Claims, Runner, StudyError, Table, base_case, changed, exchanged, finish, new_parser

PROGRAM = "chapter5.py"
GRIDS = (256, 512, 1024, 2048)
LENGTH = 5.5  # of the domain, half-widths
# Steps of the whole passage that give the printed time steps, and the multiples of the step that are tried.
STEPS = {"case2": 4464, "case3": 812}
FACTORS = {"case2": (16, 8, 4, 2, 1, 0.5, 0.25), "case3": (4, 2, 1, 0.5, 0.25)}
PRINTED_STEP = {"case2": 0.948, "case3": 0.474}  # us
RIDGE_SPEED = {"case2": 0.1, "case3": 1.1}  # m/s
SPEED_SUM = 1.2  # m/s
# Reference values: H_min and H(0) of Case 1, smallest H and largest P of the passages.
EXPECTED = {256: (0.3848299, 0.4682792), 512: (0.3853279, 0.4688646), 1024: (0.3854453, 0.4690108), 2048: (0.3854792, 0.4690473)}
LUBRICANTS = {
    "P0 = 1.98e8 Pa, z = 0.6 (Table 5.1 and the usual P0)": {"roelands_p0": 1.98e8, "roelands_z": 0.6},
    "alpha = 2.1e-8 1/Pa, z = 0.6": {"pressure_viscosity": 2.1e-8, "roelands_z": 0.6},
    "alpha = 2.1e-8 1/Pa, P0 = 1.98e8 Pa (Table 6.1)": {"pressure_viscosity": 2.1e-8, "roelands_p0": 1.98e8},
}
CENTRAL_FILMS = (0.5274, 0.5003, 0.4961)  # um, of a reference solver at 512 intervals


@dataclass(frozen=True)
class Profile:
    """A steady result: x, P, H and the scales to SI."""

    x: np.ndarray
    pressure: np.ndarray
    film: np.ndarray
    half_width: float
    hertz_pressure: float
    film_scale: float

    @property
    def central(self) -> float:
        """H at X = 0."""
        return float(np.interp(0.0, self.x, self.film))


@dataclass(frozen=True)
class Passage:
    """Profiles of a transient result at their times."""

    time: np.ndarray
    x: np.ndarray
    pressure: np.ndarray
    film: np.ndarray

    def on(self, times: np.ndarray) -> Passage:
        """The stored steps at the given times, which must be among them."""
        rows = np.searchsorted(self.time, times - 1e-9)
        if not np.allclose(self.time[rows], times, atol=1e-9, rtol=0):
            raise StudyError("stored times of two runs do not coincide")
        return Passage(self.time[rows], self.x, self.pressure[rows], self.film[rows])


def read_profile(_: str, path: Path) -> Profile:
    """A steady result."""
    with h5py.File(path) as file:
        x, pressure, film = (file["solution"][name][()] for name in ("x", "pressure", "film_thickness"))
        scales = [float(file["scaling"].attrs[name]) for name in ("half_width", "hertz_pressure", "film_thickness")]
    return Profile(x, pressure, film, *scales)


def read_passage(_: str, path: Path) -> Passage:
    """A transient result."""
    with h5py.File(path) as file:
        series = file["transient"]
        return Passage(series["profile_time"][()], file["solution/x"][()], series["pressure"][()], series["film_thickness"][()])


def passage_case(name: str, factor: float = 1, intervals: int = 1024, scheme: str = "backward_euler") -> Case:
    """Case 2 or 3 with a multiple of the printed time step; profiles are stored every four printed steps or every step."""
    base = base_case(name)
    step = base["time"]["end_time"] / STEPS[name] * factor
    stride = max(1, round(4 / factor))
    return changed(
        base,
        domain={"intervals": intervals},
        time={"time_step": step, "scheme": scheme},
        output={"profile_stride": stride},
    )


def difference(coarse: Passage, fine: Passage, field: str = "pressure") -> float:
    """Largest difference over the times and nodes of the coarser result (its nodes are among those of the finer one)."""
    fine = fine.on(coarse.time)
    skip = (fine.x.size - 1) // (coarse.x.size - 1)
    return float(np.abs(getattr(fine, field)[:, ::skip] - getattr(coarse, field)).max())


def smooth_contact(runner: Runner) -> dict[int, Profile]:
    """Case 1 on all grids."""
    base = base_case("case1")
    found = runner.run({str(n): changed(base, domain={"intervals": n}) for n in (*GRIDS, 4096)}, read_profile)
    profiles = {int(n): profile for n, profile in found.items()}
    table = Table(
        intervals="grid intervals",
        h_min="smallest nodal H",
        h_central="H at X = 0",
        p_max="largest nodal P",
        error="(5.6): a third of the largest change of P when the grid is halved [% of p_h]",
        expected_h_min="H_min of a reference solver",
        expected_h_central="H(0) of a reference solver",
    )
    for n, profile in profiles.items():
        finer = profiles.get(2 * n)
        error = None if finer is None else 100 * float(np.abs(finer.pressure[::2] - profile.pressure).max()) / 3
        expected = EXPECTED.get(n, (None, None))
        row = {"intervals": n, "h_min": float(profile.film.min()), "h_central": profile.central}
        row |= {"p_max": float(profile.pressure.max()), "error": error}
        table.add(**row, expected_h_min=expected[0], expected_h_central=expected[1])
        if expected[0] and max(abs(row["h_min"] - expected[0]), abs(profile.central - expected[1])) > 2e-7:
            raise StudyError(f"Case 1, {n} intervals: H_min {row['h_min']}, H(0) {profile.central}, expected {expected}")
    formats = {"intervals": "", "h_min": ".7f", "expected_h_min": ".7f", "h_central": ".7f", "expected_h_central": ".7f"}
    formats |= {"p_max": ".7f", "error": ".4f"}
    table.show("Case 1 (printed spatial error 0.021 %)", **formats)
    table.write(runner.folder.parent / "case1_grids", "Case 1 on five grids")
    return profiles


def with_lubricant(case: Case, keys: dict[str, float]) -> Case:
    """A case with another two of alpha, P0 and z."""
    fixed = {key: value for key, value in case["lubricant"].items() if key not in ("roelands_p0", "roelands_z")}
    return {**case, "lubricant": {**fixed, **keys}}


def lubricants(runner: Runner, quick: bool) -> None:
    """Central film, and the errors of Case 3, for the three readings of the lubricant."""
    steady, moving = {}, {}
    for number, keys in enumerate(LUBRICANTS.values()):
        for n in (512, 1024):
            steady[f"{number}_{n}"] = changed(with_lubricant(base_case("case1"), keys), domain={"intervals": n})
        for words, settings in {"given": (1, 1024), "step": (0.5, 1024), "grid": (1, 512)}.items():
            moving[f"{number}_{words}"] = with_lubricant(passage_case("case3", *settings), keys)
    found = runner.run(steady, read_profile)
    passages = {} if quick else runner.run(moving, read_passage)
    columns = {"h_central": "h_c at 512 intervals [um]", "error": "its spatial error [um]", "expected": "reference [um]"}
    columns |= {"time": "(5.5) of Case 3, 1024 intervals [%]", "space": "(5.6) of Case 3, 512 against 1024 intervals [%]"}
    table = Table(lubricant="given values", **columns)
    for number, (words, expected) in enumerate(zip(LUBRICANTS, CENTRAL_FILMS, strict=True)):
        film, finer = (1e6 * found[f"{number}_{n}"].central * found[f"{number}_{n}"].film_scale for n in (512, 1024))
        row = {"lubricant": words, "h_central": film, "error": (finer - film) * 4 / 3, "expected": expected}
        if not quick:
            given, step, grid = (passages[f"{number}_{kind}"] for kind in ("given", "step", "grid"))
            row |= {"time": 100 * difference(given, step), "space": 100 * difference(grid, given) / 3}
        table.add(**row)
        if abs(film - expected) > 1e-4:
            raise StudyError(f"central film {film} um, expected {expected} ({words})")
    formats = {"lubricant": "", "h_central": ".4f", "error": ".4f", "expected": ".4f", "time": ".3f", "space": ".3f"}
    table.show("Central film of Case 1 [um] and errors of Case 3 [%] (the thesis gives neither alpha nor P0)", **formats)
    table.write(runner.folder.parent / "lubricants", "Three readings of the lubricant")


def time_errors(runner: Runner, table: Table, name: str) -> dict[float, Passage]:
    """(5.5) for all steps, and the true error against second order in time with a quarter of the step."""
    cases = {f"{name}_step_{factor:g}": passage_case(name, factor) for factor in FACTORS[name]}
    cases[f"{name}_bdf2"] = passage_case(name, 0.25, scheme="bdf2")
    found = runner.run(cases, read_passage, keep=frozenset({f"{name}_step_1"}))
    passages = {factor: found[f"{name}_step_{factor:g}"] for factor in FACTORS[name]}
    exact = found[f"{name}_bdf2"]
    end, spacing = exact.time[-1], LENGTH / 1024
    for factor, passage in passages.items():
        half = passages.get(factor / 2)
        table.add(
            case=name,
            ratio=end / STEPS[name] * factor / spacing,
            ridge_ratio=end / STEPS[name] * factor / spacing * RIDGE_SPEED[name] / SPEED_SUM,
            pressure=None if half is None else 100 * difference(passage, half),
            film=None if half is None else 100 * difference(passage, half, "film"),
            true_pressure=100 * difference(passage, exact),
            true_film=100 * difference(passage, exact, "film"),
        )
    return passages


def place_of_difference(coarse: Passage, fine: Passage) -> float:
    """X where P differs most."""
    fine = fine.on(coarse.time)
    skip = (fine.x.size - 1) // (coarse.x.size - 1)
    return float(coarse.x[np.abs(fine.pressure[:, ::skip] - coarse.pressure).max(axis=0).argmax()])


def on_all_grids(runner: Runner, name: str, given: Passage) -> dict[int, Passage]:
    """The passage with the printed step on every grid; `given` is that with 1024 intervals."""
    cases = {f"{name}_{n}": passage_case(name, 1, n) for n in GRIDS if n != 1024}
    found = runner.run(cases, read_passage)
    return {n: given if n == 1024 else found[f"{name}_{n}"] for n in GRIDS}


def space_errors(grids: dict[int, Passage]) -> dict[int, tuple[float, float, float]]:
    """(5.6) of P and H for the pairs n, 2n at the printed step [%], and X where P differs most."""
    found = {}
    for n in GRIDS[:-1]:
        errors = (100 * difference(grids[n], grids[2 * n], field) / 3 for field in ("pressure", "film"))
        found[n] = (*errors, place_of_difference(grids[n], grids[2 * n]))
    return found


def step_changes(runner: Runner, name: str, steps: dict[float, Passage], central_film: float) -> dict[str, Change]:
    """The pairs of runs that a time error can be taken from."""
    speed = 2 * RIDGE_SPEED[name] / SPEED_SUM
    both = runner.run({f"{name}_both": passage_case(name, 2, 512)}, read_passage)[f"{name}_both"]
    pairs = {"given": (steps[1], steps[0.5]), "double": (steps[2], steps[1]), "both": (both, steps[1])}
    return {kind: change(*pair, speed, central_film) for kind, pair in pairs.items()}


def table_5_2(profile: Profile) -> Table:
    """Mesh and steps, printed and ours."""
    table = Table(quantity="quantity of Table 5.2", printed="as printed", ours="ours")
    table.add(quantity="dX Reynolds [um]", printed=0.568, ours=1e6 * profile.half_width * LENGTH / 1024)
    for name, printed in PRINTED_STEP.items():
        end = base_case(name)["time"]["end_time"]
        step = end / STEPS[name] * 2 * profile.half_width / SPEED_SUM
        table.add(quantity=f"dt Reynolds {name} [us]", printed=printed, ours=1e6 * step)
    return table


def table_5_3(smooth: dict[int, Profile], times: Table, spaces: dict[str, dict[int, tuple[float, float, float]]]) -> Table:
    """Discretisation errors in per cent of p_h, printed and ours for every pair of grids."""
    columns = {f"grid_{n}": f"(5.6) between {n} and {2 * n} intervals" for n in GRIDS[:-1]}
    table = Table(case="case", measure="which error", printed="as printed [%]", step="(5.5) at 1024 intervals [%]", **columns)
    steady = {n: 100 * float(np.abs(smooth[2 * n].pressure[::2] - smooth[n].pressure).max()) / 3 for n in GRIDS[:-1]}
    table.add(case="case1", measure="space", printed=PRINTED["case1"][1], **{f"grid_{n}": error for n, error in steady.items()})
    for name, (time, space) in list(PRINTED.items())[1:]:
        row = given_row(times, name)
        table.add(case=name, measure="time", printed=time, step=row["pressure"])
        table.add(case=name, measure="space", printed=space, **{f"grid_{n}": pair[0] for n, pair in spaces[name].items()})
    return table


def given_row(times: Table, name: str) -> dict[str, float]:
    """The row of the printed step."""
    return next(row for row in times.rows if row["case"] == name and abs(row["ratio"] / nominal_ratio(name) - 1) < 0.01)


def nominal_ratio(name: str) -> float:
    """dT/dX of the printed step."""
    return {"case2": 1.0, "case3": 0.5}[name]


def study(options: argparse.Namespace) -> None:
    """The whole chapter."""
    options.output.mkdir(parents=True, exist_ok=True)
    runner = Runner(options.output / "runs", options.jobs, options.program)
    smooth = smooth_contact(runner)
    lubricants(runner, options.quick)
    if options.quick:
        return
    times = Table(
        case="case",
        ratio="dT/dX",
        ridge_ratio="(u_ridge dt/2)/dx",
        pressure="(5.5) of P: change when the step is halved [% of p_h]",
        film="(5.5) of H [% of b^2/R]",
        true_pressure="difference of P to BDF2 with a quarter of the printed step [% of p_h]",
        true_film="the same of H [% of b^2/R]",
    )
    passages, spaces, step_pairs, grid_pairs = {}, {}, {}, {}
    central = smooth[1024].central
    passing = extremes_table()
    for name in STEPS:
        steps = time_errors(runner, times, name)
        grids = on_all_grids(runner, name, steps[1])
        passages[name], spaces[name] = steps[1], space_errors(grids)
        passing.add(**extremes(name, steps[1], steps[0.5], grids[2048]))
        step_pairs[name] = step_changes(runner, name, steps, central)
        speed = 2 * RIDGE_SPEED[name] / SPEED_SUM
        grid_pairs[name] = {n: change(grids[n], grids[2 * n], speed, central) for n in GRIDS[:-1]}
    times.show("Time errors, 1024 intervals", case="", **dict.fromkeys(list(times.columns)[1:], ".4f"))
    times.write(options.output / "time_errors", "Time errors of Cases 2 and 3 over the step")
    passing.show("Extremes of the passages", case="", **dict.fromkeys(list(passing.columns)[1:], ".4f"))
    passing.write(options.output / "extremes", "Smallest film and largest pressure of Cases 2 and 3")
    other = table_5_2(smooth[1024])
    other.show("Table 5.2", quantity="", printed=".3f", ours=".4f")
    other.write(options.output / "table_5_2", "Table 5.2: mesh and steps")
    errors = table_5_3(smooth, times, spaces)
    errors.show("Table 5.3, errors in per cent", case="", measure="", **dict.fromkeys(list(errors.columns)[2:], ".3f"))
    errors.write(options.output / "table_5_3", "Table 5.3: discretisation errors")
    steady = {n: float(np.abs(smooth[2 * n].pressure[::2] - smooth[n].pressure).max()) for n in GRIDS[:-1]}
    true = {name: given_row(times, name)["true_pressure"] for name in STEPS}
    readings = readings_table(steady, step_pairs, grid_pairs, true)
    readings.show("Table 5.3 by other readings [%]", error="", reading="", case1=".4f", case2=".4f", case3=".4f")
    readings.write(options.output / "table_5_3_readings", "Table 5.3 by every reading of the definitions")
    claims = Claims()
    check_readings(claims, readings)
    check_coarse_steps(claims, runner)
    mirrored = runner.run({"case1_exchanged": exchanged_speeds()}, read_profile)["case1_exchanged"]
    check(claims, smooth, mirrored, passages, times, spaces)
    compare(runner, options.output, claims)
    compare_passages(runner, options.output, claims)
    find_rule(runner, options.output, claims)
    claims.show()
    claims.table.write(options.output / "statements", "Statements of chapter 5 and what was measured")
    print(f"\n{runner.effort}")
    chapter5_figures.draw(options.output, smooth[1024], passages, times)


def check_coarse_steps(claims: Claims, runner: Runner) -> None:
    """The reference solver's time error of Case 2, 512 intervals."""
    factors = (4, 2, 1)  # dT = 2 dX, dX, dX/2
    found = runner.run({f"coarse_{factor}": passage_case("case2", factor, 512) for factor in factors}, read_passage)
    wide, given = (difference(found[f"coarse_{first}"], found[f"coarse_{second}"]) for first, second in ((4, 2), (2, 1)))
    claims.check(
        "A reference solver, Case 2 with 512 intervals and dT = dX: halving dT moves P by 5e-4",
        "5e-4 is the halving from 2 dX, and the error of dT = dX; halving dX moves half of it",
        f"halving 2 dX moves P by {wide:.2e}, halving dX by {given:.2e}, and so on: the error of dT = dX is {2 * given:.1e}",
    )


def exchanged_speeds() -> Case:
    """Case 1 with the slide-to-roll ratio of the other sign."""
    case = base_case("case1")
    speeds = {name: value for name, value in exchanged(case)["bodies"].items() if name.startswith("speed")}
    return changed(case, bodies=speeds)


def check(
    claims: Claims,
    smooth: dict[int, Profile],
    mirrored: Profile,
    passages: dict[str, Passage],
    times: Table,
    spaces: dict[str, dict[int, tuple[float, float, float]]],
) -> None:
    """The statements of the chapter that need no CFD."""
    profile = smooth[1024]
    peaks = int(np.sum((profile.pressure[1:-1] > profile.pressure[:-2]) & (profile.pressure[1:-1] > profile.pressure[2:])))
    claims.check(
        "5.3: lightly loaded, a Hertzian pressure of 0.6 GPa",
        abs(profile.hertz_pressure / 0.6e9 - 1) < 0.01,
        f"p_h = {profile.hertz_pressure / 1e9:.4f} GPa, b = {1e6 * profile.half_width:.2f} um",
    )
    claims.check(
        "Case 1: no pressure spike, a smooth exit constriction",
        peaks == 1,
        f"{peaks} maximum of P, {profile.pressure.max():.4f} at X = {profile.x[profile.pressure.argmax()]:+.3f}; h_min "
        f"{1e6 * profile.film.min() * profile.film_scale:.4f} um at X = {profile.x[profile.film.argmin()]:+.3f}",
    )
    change = float(np.abs(mirrored.pressure - profile.pressure).max())
    claims.check("Case 1: the sign of the slide-to-roll ratio has no influence", change < 1e-9, f"largest change of P {change:.1e}")
    for name, words in (("case2", "Case 2 (slow ridge)"), ("case3", "Case 3 (fast ridge)")):
        passage = passages[name]
        lags = [lag(passage, smooth[1024], name, centre) for centre in chapter5_figures.CENTRES[1:4]]
        claims.check(
            f"{words}: no phase difference between the ridge and the distortion of the film"
            + ("" if name == "case2" else " (said of Case 2)"),
            max(abs(value) for value in lags) < 0.03,
            "the film is most distorted at "
            + ", ".join(f"{value:+.3f}" for value in lags)
            + " half-widths from the ridge at X = -0.5, 0, 0.5; smallest H of the passage "
            + f"{passage.film.min():.4f}, largest P {passage.pressure.max():.4f}",
        )
    rows = {name: [row for row in times.rows if row["case"] == name] for name in STEPS}
    given = {name: given_row(times, name) for name in STEPS}
    check_times(claims, rows, given)
    places = " and ".join(f"{spaces[name][512][2]:.2f}" for name in STEPS)
    claims.check(
        "Table 5.3: spatial errors",
        "see the table",
        f"P differs most between 512 and 1024 intervals at X = {places} (Cases 2 and 3)",
    )
    ratios = [row["pressure"] / row["film"] for row in given.values()]
    ratios += [spaces[name][1024][0] / spaces[name][1024][1] for name in STEPS]
    claims.check(
        "5.5: errors of the pressure are 10 to 20 times those of the film",
        all(10 <= value <= 20 for value in ratios) or f"partly: {min(ratios):.0f} to {max(ratios):.0f} times",
        "P in units of p_h, H in units of b^2/R; time, Cases 2 and 3, then space: " + ", ".join(f"{value:.1f}" for value in ratios),
    )


def check_times(claims: Claims, rows: dict[str, list[dict[str, float]]], given: dict[str, dict[str, float]]) -> None:
    """What the chapter says of the time steps."""
    for name in STEPS:
        chain = [row for row in rows[name] if row["pressure"] is not None and row["ratio"] <= 1.01]
        ratios = [second["pressure"] / first["pressure"] for first, second in itertools.pairwise(chain)]
        claims.check(
            f"(5.8), {name}: with dT <= dX halving the step halves the time error",
            all(value < 0.56 for value in ratios),
            "eps(dt/2)/eps(dt) = " + ", ".join(f"{value:.3f}" for value in ratios),
        )
    claims.check(
        "5.3.2: the largest time error is that of Case 3",
        given["case3"]["pressure"] > given["case2"]["pressure"],
        f"{given['case3']['pressure']:.3f} % against {given['case2']['pressure']:.4f} %; printed 1.04 and 0.057",
    )
    coarse = next(row for row in rows["case2"] if row["ratio"] > 7)
    claims.check(
        "5.3.2: a slow ridge is well resolved even with dT larger than dX",
        coarse["true_pressure"] < given["case3"]["true_pressure"],
        f"Case 2 with dT = {coarse['ratio']:.0f} dX: P off by {coarse['true_pressure']:.2f} %, less than Case 3 with dT = dX/2 "
        f"({given['case3']['true_pressure']:.2f} %)",
    )
    found = ", ".join(f"{row['true_pressure']:.3f} % ({row['pressure']:.3f} %)" for row in given.values())
    claims.check(
        "Beyond the thesis: (5.5) is half the true error of a method of first order",
        "a factor of two",
        f"against BDF2 with a quarter of the step (in brackets (5.5)): {found}",
    )


def lag(passage: Passage, smooth: Profile, name: str, centre: float) -> float:
    """Distance from the ridge centre to where the film is lowered most against the smooth contact."""
    speed = 2 * RIDGE_SPEED[name] / SPEED_SUM
    step = int(np.argmin(np.abs(-2.5 + speed * passage.time - centre)))
    place = -2.5 + speed * passage.time[step]
    near = np.flatnonzero(np.abs(passage.x - place) < 0.4)
    change = (passage.film[step] - smooth.film)[near]
    low = int(np.argmin(change))
    left, middle, right = change[low - 1 : low + 2]
    offset = 0.5 * (left - right) / (left - 2 * middle + right)
    return float(passage.x[near[low]] + offset * (passage.x[1] - passage.x[0]) - place)


def main() -> None:
    """Command line."""
    parser = new_parser(PROGRAM, __doc__, "results/chapter5")
    finish(parser, study)


if __name__ == "__main__":
    main()

"""The thesis again, in short: error tables of chapter 5, film thinning of chapter 6, amplitude of a rolling waviness."""

import sys

import numpy as np
import pytest
from study_runs import STUDIES, rows, run_quick

sys.path.append(str(STUDIES))

import chapter5
import chapter5_passages
import chapter5_rule
import overtaking
import waviness
from linear_response import Advection
from study import Runner, exchanged


@pytest.fixture
def runner(program, tmp_path):
    """Runs cases of the studies in an empty folder, two at once."""
    return Runner(tmp_path / "runs", 2, program)


def test_case_1_films_and_spatial_errors(program, tmp_path):
    # Films against an independent solver to its last digit (2e-7) and three readings of the lubricant to 1e-4 um: in the study.
    run_quick("chapter5.py", program, tmp_path)
    found = {int(row["intervals"]): row for row in rows(tmp_path / "case1_grids.csv")}
    # The printed 0.021 % is what 256 against 512 intervals gives (its own error: one more halving, a quarter).
    assert float(found[256]["error"]) == pytest.approx(0.0222, abs=0.0001)
    assert float(found[1024]["error"]) == pytest.approx(0.0014, abs=0.0001)
    assert float(found[256]["error"]) == pytest.approx(0.021, abs=0.0015)


def test_case_3_extremes_and_errors(runner):
    # 1024 intervals, dT = dX/2: references 0.2525 and 1.269 are rounded to the last digit.
    cases = {
        f"{n}_{factor:g}": chapter5.passage_case("case3", factor, n) for n, factor in ((512, 2), (512, 1), (1024, 1), (1024, 0.5))
    }
    found = runner.run(cases, chapter5.read_passage)
    given = found["1024_1"]
    assert given.film.min() == pytest.approx(0.2525, abs=1e-4)
    assert given.pressure.max() == pytest.approx(1.269, abs=1e-3)
    # (5.5) in per cent, of first order: 0.70 at dT = dX/2 (thesis 1.04), twice that with twice the step. The tolerance 0.005 is
    # the tolerance of a time step, 1e-6, with room for another processor.
    assert 100 * chapter5.difference(given, found["1024_0.5"]) == pytest.approx(0.7015, abs=0.005)
    assert 100 * chapter5.difference(found["512_2"], found["512_1"]) == pytest.approx(1.3765, abs=0.01)
    # (5.6) of the pair 512, 1024; the thesis prints 0.17, between this and 0.204 of the pair 256, 512.
    assert 100 * chapter5.difference(found["512_1"], given) / 3 == pytest.approx(0.0521, abs=0.001)


def test_case_2_extremes(runner):
    # 512 intervals, dT = dX: 0.3147 and 1.290 of an independent solver, rounded.
    case = chapter5.passage_case("case2", 2, 512)
    found = runner.run({"case2": case}, chapter5.read_passage)["case2"]
    assert found.film.min() == pytest.approx(0.3147, abs=2e-4)
    assert found.pressure.max() == pytest.approx(1.290, abs=1e-3)


def test_film_thinning_quick_form(program, tmp_path):
    # 0.403, 0.294 and 0.470 to 0.005: in the study. Here all widths; the time error (5 to 10 %) shifts them alike.
    run_quick("chapter6.py", program, tmp_path)
    found = {
        (float(row["slip"]) > 1, float(row["load"]), int(row["m2"])): float(row["xi_a"]) for row in rows(tmp_path / "xi_quick.csv")
    }
    widths = [found[True, 1e5, m2] for m2 in range(1, 8)]
    assert widths == pytest.approx([0.4032, 0.4496, 0.4431, 0.4248, 0.4023, 0.3903, 0.4149], abs=0.0005)


def test_film_thinning_does_not_depend_on_the_side(runner):
    # Both bodies change places with their speeds, surfaces and radii.
    situation = overtaking.Situation(1, l2=-6)
    cases = {item.name: item.case(overtaking.FORMS["a"]) for item in (situation, situation.reference)}
    cases |= {f"{name}_exchanged": exchanged(case) for name, case in cases.items()}
    films = runner.run(cases, lambda _, path: overtaking.read_film(path))
    first = overtaking.thinning(films[situation.name], films[situation.reference.name])
    second = overtaking.thinning(films[f"{situation.name}_exchanged"], films[f"{situation.reference.name}_exchanged"])
    assert second.xi == pytest.approx(first.xi, abs=1e-12)
    assert (second.x, second.time) == (first.x, first.time)


def test_window_ends_are_interpolated():
    x = np.array([-1.5, -1.25, 0.25])
    values = np.array([[2.0, 1.0, 4.0]])
    assert overtaking.at_places(x, values, np.array([-1.3, 0.0])) == pytest.approx(np.array([[1.2, 3.5]]), abs=1e-14)


def test_rolling_waviness_quick_form(program, tmp_path):
    # Venner et al. (1997), Table 1, within 3 %: in the study. Regression to 0.4 %, a fifth of the error at Lambda = 2 b.
    run_quick("amplitude.py", program, tmp_path)
    found = {float(row["wavelength"]): row for row in rows(tmp_path / "rolling_quick.csv")}
    assert {w: float(row["ratio"]) for w, row in found.items()} == pytest.approx({2: 0.0727, 1: 0.1839, 0.5: 0.3981}, rel=0.004)
    assert all(float(row["drift"]) < 1e-4 for row in found.values())


def test_shortest_wave_of_table_1_is_not_the_published_one(runner):
    # Linear response without numerical damping of what the oil carries: 0.8893 +- 0.0002 on finer grids, published 0.839.
    runs = {n: waviness.Waviness(wavelength=0.125, intervals=n) for n in (512, 1024)}
    found = waviness.linear_films(runner, [(run, Advection.CHARACTERISTIC) for run in runs.values()])
    half, given = (abs(found[run, Advection.CHARACTERISTIC].ratio()) for run in runs.values())
    assert given + (given - half) / 3 == pytest.approx(0.8893, abs=0.001)


def test_time_marching_gives_the_linear_response_in_sliding(runner):
    run = waviness.Waviness(slip=-2 / 3, amplitude=0.02, intervals=512)
    marched = waviness.run_all(runner, [run])[run].ratio
    linear = waviness.linear_films(runner, [(run, Advection.BDF2)])[run, Advection.BDF2].ratio()
    assert marched == pytest.approx(linear, abs=3e-4)
    # twice the slide-to-roll ratio is another answer: the comparison can fail
    other = waviness.Waviness(slip=-4 / 3, amplitude=0.02, intervals=512)
    assert abs(waviness.linear_films(runner, [(other, Advection.BDF2)])[other, Advection.BDF2].ratio() - marched) > 0.02


def test_a_waviness_as_high_as_the_film_enters_and_is_nearly_linear(runner):
    # Change of the ratio from 0.02 to 1 h_c: 1.2 % with 1024 intervals.
    runs = [waviness.Waviness(amplitude=a, intervals=512, entry=1.0) for a in (0.02, 1.0)]
    low, high = (abs(answer.ratio) for answer in waviness.run_all(runner, runs).values())
    assert high / low == pytest.approx(1.012, abs=0.003)


def test_ridge_by_the_full_momentum_equations(runner):
    # Full run, 512 intervals: 0.1314 +- 0.0037 % of p_h and 0.1036 +- 0.0024 % of the central film.
    case = chapter5_passages.passage_case("case3", 128, 5, 2)
    largest = runner.run({"case3": case}, chapter5_passages.read_difference)["case3"].largest()
    assert 100 * largest["pressure"] == pytest.approx(0.1314, abs=0.015)
    assert 100 * largest["film"] == pytest.approx(0.1036, abs=0.01)


def test_rule_of_the_differences_is_fitted():
    source = np.random.default_rng(5)
    rows = [{"sliding": t, "slope": s, "h_min": 3.0 * t**0.7 * s**0.4} for t, s in source.uniform(0.01, 0.3, (20, 2))]
    rule = chapter5_rule.fitted(rows, "h_min")
    assert rule == pytest.approx([3.0, 0.7, 0.4], rel=1e-9)
    assert chapter5_rule.ruled(rule, rows) == pytest.approx([row["h_min"] for row in rows], rel=1e-9)

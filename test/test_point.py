"""Lubricated point contacts from the namelist on: SI and Moes, bodies, grids, targets, ends of runs."""

import sys

import h5py
import numpy as np
import pytest
from cases import ROOT, called, ended, write

BALL = """&case problem = 'ehl_point' /
&bodies plane = .true., radius_x_1 = 12.7e-3, youngs_modulus_1 = 206e9, youngs_modulus_2 = 206e9,
        poisson_ratio_1 = 0.3, poisson_ratio_2 = 0.3, speed_1 = 0.5, speed_2 = 0.7 /
&load load = 30.0 /
&lubricant viscosity = 0.04, pressure_viscosity = 2e-8, roelands_z = 0.6 /
"""
MOES = """&case problem = 'ehl_point' /
&moes moes_m = {m}, moes_l = {l}, velocity = '{velocity}', radius_ratio = {ratio} /
&lubricant viscosity_law = '{law}', density_law = 'constant' /
&domain intervals_x = 64, far_field = .false. /
"""


DENT = "&surface_1 shape = 'feature', amplitude = -5e-8, wavelength = 2e-4, wavelength_y = 2e-4, position = -1.5 /\n"


def moes(m, material, velocity="sum", ratio=1.0, law="barus"):
    return MOES.format(m=m, l=material, velocity=velocity, ratio=ratio, law=law)


def test_moes_numbers_of_both_velocities(solved_case):
    # H_c = 3.8522417 in units of the sum of speeds (stored solution of another program)
    with solved_case(moes(200, 10)) as file:
        first = file["summary/h_central_moes"][()]
        assert first / 2**0.5 == pytest.approx(3.852241713325187, rel=1e-6)
    with solved_case(moes(200 * 2**0.75, 10 / 2**0.25, "mean")) as file:
        assert file["summary/h_central_moes"][()] == pytest.approx(first, rel=1e-9)


def test_si_and_moes_are_the_same_contact(solved_case):
    barus = BALL.replace("roelands_z = 0.6", "viscosity_law = 'barus', density_law = 'constant'")
    with solved_case(barus + "&domain intervals_x = 64, far_field = .false. /\n") as file:
        scales, film = dict(file["scaling"].attrs), file["summary/h_central"]
        radius, modulus = 12.7e-3, 206e9 / 0.91
        load = 30.0
        half_width = (1.5 * load * radius / modulus) ** (1 / 3)
        assert scales["half_width_x"] == pytest.approx(half_width, rel=1e-12)
        assert scales["hertz_pressure"] == pytest.approx(1.5 * load / (np.pi * half_width**2), rel=1e-12)
        speed = 0.04 * 1.2 / (modulus * radius)
        assert scales["moes_m_sum"] == pytest.approx(load / (modulus * radius**2) * speed**-0.75, rel=1e-12)
        assert scales["moes_l_sum"] == pytest.approx(2e-8 * modulus * speed**0.25, rel=1e-12)
        dimensionless = film.attrs["dimensionless"]
        assert film[()] == pytest.approx(dimensionless * half_width**2 / radius, rel=1e-12)
        load_of_fields = file["si/solution/pressure"][()].sum() * np.prod([np.diff(file[f"si/solution/{k}"])[0] for k in "xy"])
        assert load_of_fields == pytest.approx(load, rel=1e-7)
    with solved_case(moes(scales["moes_m_sum"], scales["moes_l_sum"])) as file:
        assert file["summary/h_central"].attrs["dimensionless"] == pytest.approx(dimensionless, rel=1e-8)


def test_two_ways_to_give_the_same_bodies(solved_cases):
    swapped = BALL.replace("radius_x_1", "radius_x_2").replace("speed_1 = 0.5, speed_2 = 0.7", "speed_1 = 0.7, speed_2 = 0.5")
    reduced = BALL.replace("plane = .true., radius_x_1 = 12.7e-3", "reduced_radius_x = 12.7e-3, reduced_radius_y = 12.7e-3")
    coarse = "&domain intervals_x = 64 /\n"
    files = solved_cases(a=BALL + coarse, b=swapped + coarse, c=reduced + coarse)
    films, frictions = ([file[f"summary/{name}"][()] for file in files] for name in ("h_central", "friction_coefficient"))
    np.testing.assert_allclose(films, films[0], rtol=1e-12)
    np.testing.assert_allclose(frictions, frictions[0], rtol=1e-12)


def test_friction_counts_the_load_beyond_the_domain(solved_case):
    # of a light contact 4 % of the load lies there
    with solved_case(BALL.replace("load = 30.0", "load = 3.0") + "&domain intervals_x = 64 /\n") as file:
        film, power = (file[f"summary/{name}"][()] for name in ("friction_coefficient", "sliding_power"))
        assert film * 3.0 * 0.2 == pytest.approx(power, rel=1e-9)


def test_a_long_ellipse_is_a_line_in_its_middle(solved_cases):
    long = BALL.replace("12.7e-3", "12.7e-3, radius_y_1 = 0.5").replace("load = 30.0", "hertz_pressure = 0.7e9")
    line = long.replace("ehl_point", "ehl_line").replace("radius_x_1 = 12.7e-3, radius_y_1 = 0.5", "radius_1 = 12.7e-3")
    point, strip = solved_cases(point=long + "&domain intervals_x = 128 /\n", line=line)
    assert point["scaling"].attrs["ellipticity"] > 10
    assert point["summary/h_central"][()] == pytest.approx(strip["summary/h_central"][()], rel=0.04)


def test_error_bars_and_target(solved_case):
    with solved_case(BALL + "&accuracy target = 4e-3 /\n") as file:
        for name in ("h_min", "h_central"):
            film = file[f"summary/{name}"]
            assert 0 < film.attrs["error_estimate"] <= 4e-3 * film[()]
            known = film[()], film.attrs["error_estimate"]
        intervals = file["input/effective/domain"].attrs["intervals_x"]
    with solved_case(BALL + f"&domain intervals_x = {2 * intervals} /\n") as file:
        assert abs(file["summary/h_central"][()] - known[0]) < known[1]


def change_of(file, ingredient, name="h_central"):
    """Change without an ingredient, and its error."""
    row = file[f"adequacy/{ingredient}/{name}"]
    return row[()], row.attrs["error_estimate"]


def verdict_on(file, ingredient):
    return file[f"adequacy/{ingredient}"].attrs["verdict"]


def test_what_a_ball_needs(solved_cases):
    """At 1 GPa compression takes a seventh of the film, the change is that of two runs; rolling thins no oil."""
    fixed = "&domain intervals_x = {}, x_inlet = -4.5, x_outlet = 1.5, y_half_width = 3.0 /\n"
    heavy = BALL.replace("load = 30.0", "hertz_pressure = 1e9").replace("0.5, speed_2 = 0.7", "0.6, speed_2 = 0.6")
    oil = heavy.replace("roelands_z", "rheology = 'eyring', eyring_stress = 5e6, roelands_z")
    full = "&output adequacy = 'full' /\n"
    leaner = {
        "compressibility": oil.replace("roelands_z", "density_law = 'constant', roelands_z"),
        "roelands": oil.replace("roelands_z = 0.6", "viscosity_law = 'barus'"),
        "shear_thinning": heavy,
    }
    whole, usual, coarse, *lean = solved_cases(
        whole=oil + fixed.format(256) + full,
        usual=oil + fixed.format(256),
        coarse=oil + fixed.format(128),
        **{name: text + fixed.format(128) for name, text in leaner.items()},
    )
    assert whole["adequacy"].attrs["intervals_at_rest"] == 128
    for name, other in zip(leaner, lean, strict=True):
        change, error = change_of(whole, name)
        assert change == pytest.approx(other["summary/h_central"][()] / coarse["summary/h_central"][()] - 1, abs=1e-6), name
        if f"{name}/h_central" in usual["adequacy"]:
            assert abs(change_of(usual, name)[0] - change) < change_of(usual, name)[1] + error, name
    change, error = change_of(whole, "compressibility")
    assert 0.13 < change / (1 + change) < 0.18
    assert error < 0.03
    assert verdict_on(usual, "compressibility") == verdict_on(whole, "compressibility") == b"needed"
    assert verdict_on(whole, "shear_thinning") in (b"irrelevant", b"matters below the accuracy")
    assert "elasticity" not in whole["adequacy"]


def test_what_a_passing_dent_needs(told_case):
    still = BALL.replace("speed_1 = 0.5", "speed_1 = 0.0")
    found, said = told_case(still + DENT.replace("-1.5", "0.0") + "&domain intervals_x = 256 /\n&output adequacy = 'full' /\n")
    assert -0.03 < found["adequacy/roughness/h_central"] < -0.005
    assert "less than that: roughness" in " ".join(said.split())
    passage = "&time transient = .true., end_time = 0.2 /\n&domain intervals_x = 128 /\n"
    found, said = told_case(BALL.replace("load = 30.0", "load = 5.0") + DENT + passage)
    assert found["adequacy/piezoviscosity@verdict"] == b"needed"
    assert all(b"not measured of a point contact in" in found[f"adequacy/{name}@not_known"] for name in ("roughness", "squeeze"))
    assert found["summary/h_min@error_grid"] > 0  # but the dent is there at once
    assert found["summary/h_min@no_estimate"].startswith(b"the start is in the quantities")
    assert "not known: roughness" in " ".join(said.split())


def test_a_coarse_grid_is_told(told_case):
    result, said = told_case(moes(1000, 10), status=2)
    assert "grid too coarse for the film, needs 128 intervals in x (has 64)" in " ".join(said.split())
    assert np.isnan(result["summary/h_central"])


def test_a_measured_area_is_what_it_holds(solved_cases, tmp_path):
    wave = np.cos(2 * np.pi * (place := 1.5e-6 * (np.arange(601) - 300)) / 1.5e-4)
    with h5py.File(tmp_path / "wavy.h5", "w") as file:
        heights = file.create_dataset("heights", data=2e-8 * wave[:, None] * wave + 1e-3 * place)
        heights.attrs["spacing_x"] = heights.attrs["spacing_y"] = 1.5e-6
    still = BALL.replace("speed_1 = 0.5", "speed_1 = 0.0") + "&domain intervals_x = 64 /\n"
    file = "&surface_1 shape = 'file', file = 'wavy.h5', dataset = 'heights' /\n"
    formula = "&surface_1 shape = 'sinusoid', amplitude = 2e-8, wavelength = 1.5e-4, wavelength_y = 1.5e-4 /\n"
    one, other, smooth = solved_cases(a=still + file, b=still + formula, c=still)
    assert b"tilt 1.00E-03" in one["report/note"][()]
    x, y = (np.abs(one[f"solution/{axis}"][()]) < 1.2 for axis in "xy")
    films = [result["si/solution/film_thickness"][()][np.ix_(y, x)] for result in (one, other, smooth)]
    np.testing.assert_allclose(films[0], films[1], rtol=2e-4)
    assert abs(films[0] / films[2] - 1).max() > 0.05
    heights = [result["si/solution/roughness_1"][()][np.ix_(y, x)] for result in (one, other)]
    np.testing.assert_allclose(*heights, atol=2e-12)


def test_a_synthetic_area_passes(solved_case):
    rough = "&surface_2 shape = 'synthetic', rms_height = 1e-8, wavelength_short = 1e-4, seed = 3 /\n"
    passage = "&domain intervals_x = 64, intervals_y = 64 /\n&time transient = .true., end_time = 6.0, time_step = 0.2 /\n"
    with solved_case(BALL + rough + passage) as file:
        assert file["transient/film_thickness"].shape == (31, 65, 65)
        assert [scale.keys()[0] for scale in file["transient/film_thickness"].dims] == ["profile_time", "y", "x"]
        assert np.ptp(series := file["transient/h_min"][()]) > 0.01 * series.mean()
        heights = file["si/solution/roughness_2"][20:45, 15:40]  # where it has entered
        assert heights.std() == pytest.approx(1e-8, rel=0.5)


def test_passages_have_bars_and_honest_ones(solved_case):
    passage = "&time transient = .true., end_time = 1.5, statistics_from = 0 /\n"
    slow = BALL.replace("load = 30.0", "load = 5.0")
    with solved_case(slow + DENT + passage + "&domain intervals_x = 256 /\n") as file:
        truth = {name: file[f"summary/{name}"][()] for name in ("h_min", "h_central", "p_max")}
    for choice in ("&domain intervals_x = 128 /\n", "&accuracy target = 0.02 /\n"):
        with solved_case(slow + DENT + passage + choice) as file:
            assert file["solution/x"].shape == (129,)
            for name, value in truth.items():
                bar = file[f"summary/{name}"].attrs["error_estimate"]
                assert abs(file[f"summary/{name}"][()] - value) < bar, name
                assert name == "p_max" or bar < 0.02 * value, name  # a spike may grow


TABLE = "&history file = 'h.csv' /\n&time transient = .true. /\n"
HISTORY = BALL.replace(", speed_1 = 0.5, speed_2 = 0.7", "").replace("&load load = 30.0 /\n", TABLE)


def test_a_history_ends_as_the_steady_contact(solved_case, tmp_path):
    """Load and speed change and stay: another reference state, the same film; the thinnest moment chooses the grid."""
    write(tmp_path, "h.csv", "time [s],load [N],speed_1 [m/s],speed_2 [m/s]\n0,1,1.5,1.2\n1e-4,5,0.9,0.8\n1e-3,5,0.9,0.8\n")
    domain = "&domain intervals_x = 64, intervals_y = 64, x_inlet = -5.0, x_outlet = 1.7, y_half_width = 3.3 /\n"
    with solved_case(HISTORY + domain) as file:
        assert file["si/transient/load"][[0, -1]] == pytest.approx([1.0, 5.0])
        assert file["transient/load"].attrs["si_units"] == b"N"
        films = [file[f"si/transient/{name}"][()] for name in ("h_central", "h_min", "p_max")]
        unit = file["scaling"].attrs["half_width_x"]
    drawn = called([sys.executable, ROOT / "postproc/point.py", "case.h5", "--format", "png"], cwd=tmp_path)
    assert "case_history.png" in ended(drawn).stdout
    steady = BALL.replace("load = 30.0", "load = 5.0").replace("speed_1 = 0.5, speed_2 = 0.7", "speed_1 = 0.9, speed_2 = 0.8")
    with solved_case(steady + domain) as file:
        assert file["scaling"].attrs["half_width_x"] == pytest.approx(unit)
        for name, series in zip(("h_central", "h_min", "p_max"), films, strict=True):
            assert series[-1] == pytest.approx(file[f"summary/{name}"][()], rel=1e-4), name
            assert abs(series[0] / series[-1] - 1) > 0.05, name


def test_histories_that_points_do_not_have(run_case, tmp_path):
    write(tmp_path, "h.csv", "time [s],load [N],reduced_radius [m]\n0,1,0.01\n1e-3,2,0.01\n")
    told = run_case(HISTORY, "--quiet", status=1).stderr
    assert "found reduced_radius [m], expected load, speed_1, speed_2" in told
    write(tmp_path, "h.csv", "time [s],load_per_length [N/m]\n0,1\n1e-3,2\n")
    assert "load_per_length" in run_case(HISTORY + "&load load = 30.0 /\n", "--quiet", status=1).stderr


def test_a_reversed_history_ends_as_it_began(solved_cases, tmp_path):
    """By half a turn, of an ellipse across the flow; one with both speeds reversed is the same by half a turn all the time."""
    times, shares = [0, 2e-4, 4e-4, 3e-3], [1, 1, -1, -1]
    domain = "&domain intervals_x = 64, intervals_y = 64 /\n&output profile_stride = 1 /\n"
    ellipse = HISTORY.replace("radius_x_1 = 12.7e-3", "radius_x_1 = 12.7e-3, radius_y_1 = 20e-3, entrainment_angle = 30.0")
    cases = {}
    for name, sign in (("a", 1), ("b", -1)):
        rows = "".join(f"{t},{sign * 0.9 * share},{sign * 0.8 * share}\n" for t, share in zip(times, shares, strict=True))
        write(tmp_path, f"{name}.csv", "time [s],speed_1 [m/s],speed_2 [m/s]\n" + rows)
        cases[name] = ellipse.replace("h.csv", f"{name}.csv") + "&load load = 5.0 /\n" + domain
    films, frictions, moving = [], [], None
    for file in solved_cases(**cases):
        films.append(file["transient/film_thickness"][()])
        frictions.append(file["transient/friction_coefficient"][()])
        moving = file["transient/pressure"][0] > 0
    turned = films[0][:, ::-1, ::-1]
    assert abs(turned[0] / films[0][0] - 1)[moving].max() > 0.1
    np.testing.assert_allclose(turned[-1][moving], films[0][0][moving], rtol=1e-3)
    np.testing.assert_allclose(turned, films[1], rtol=1e-6)
    np.testing.assert_allclose(*frictions, rtol=5e-4)  # round-off moves the exit by nodes


def test_a_reversal_leaves_a_film(solved_case, tmp_path):
    # which the arithmetic mean of rho H^3 on faces drains until it closes; on 128 intervals the least one is 15.5 nm
    write(tmp_path, "h.csv", "time [s],speed_1 [m/s],speed_2 [m/s]\n0,0.3,0.18\n0.02,-0.3,-0.18\n")
    with solved_case(HISTORY.replace("= 0.04", "= 0.08") + "&load load = 20 /\n&domain intervals_x = 64 /\n") as file:
        assert file["si/transient/h_min"][()].min() > 8e-9


def test_floor_and_thresholds_of_a_passage(solved_case):
    ridge = "&surface_2 shape = 'feature', amplitude = 8e-8, wavelength = 3e-4, wavelength_y = 3e-4, position = -1.5 /\n"
    passage = "&domain intervals_x = 64, intervals_y = 64 /\n&time transient = .true., end_time = 2.0, time_step = 0.1 /\n"
    case = BALL.replace("load = 30.0", "load = 5.0") + ridge + passage + "&output profile_stride = 1"
    asked = case + ", film_thresholds = {0}, 2e-7 /\n&solver film_floor = {0}, on_film_breakdown = '{1}' /\n"
    with solved_case(case + " /\n") as file:
        series = file["si/transient/h_min"][()]
    floor = 0.5 * (series.min() + series[0])
    with solved_case(asked.format(floor, "continue")) as file:
        low, films = file["si/transient/h_min"][()] < floor, file["si/transient/film_thickness"][()]
        assert 0 < low.sum() < len(low)
        assert (file["transient/film_breakdown"][()] == low).all()
        first, found = np.flatnonzero(low)[0], file["statistics"]
        assert file["report/film_breakdown_step"][()] == first
        row, column = np.unravel_index(films[first].argmin(), films[first].shape)
        x, y = file["solution/x"][()], file["solution/y"][()]
        assert file["report/film_breakdown_position"][()] == x[column]
        assert file["report/film_breakdown_position_y"][()] == y[row]
        counted = file["transient/time"][()] >= max(found.attrs["statistics_from"], 1e-9)
        contact = films[counted][:, x**2 + y[:, None] ** 2 <= 1]
        assert found["time_below"][0] == pytest.approx(low[counted].mean())
        assert found["area_below"][()] == pytest.approx([(contact < h).mean() for h in (floor, 2e-7)])
        assert found["mean_film"][()] == pytest.approx(contact.mean())
        assert found["smooth_film"][()] == pytest.approx(series.max(), rel=1.0)
    with solved_case(asked.format(floor, "stop"), status=2) as file:
        assert file.attrs["reason"].startswith(b"film breakdown at x = ")
        assert b"(Y = " in file.attrs["reason"]
        assert len(file["transient/time"]) == first


def test_threads_change_nothing_but_round_off(asperity, tmp_path):
    films = []
    for threads in ("1", "2"):
        write(tmp_path, "ball.nml", BALL + "&domain intervals_x = 64 /\n")
        ended(asperity("ball.nml", "--quiet", "--threads", threads))
        with h5py.File(tmp_path / "ball.h5") as file:
            films.append(file["solution/film_thickness"][()])
    np.testing.assert_allclose(films[0], films[1], rtol=1e-12)

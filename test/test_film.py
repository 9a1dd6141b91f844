"""Breakdown and statistics of the film, waves that are narrow for the grid, outlets that cut the film off, velocity across it."""

import cases
import h5py
import numpy as np
import pytest
from cases import AT_REST, STEADY, TRANSIENT, ended, text, write

# A ridge of 1 um: the film falls to 14 nm at X = 1.305, T = 2.37, with backward Euler; on so coarse a grid it closes in the limit
# of small steps, which BDF2 sees.
HIGH = (
    STEADY.replace("x_outlet = 1.5", "x_outlet = 3.0")
    + """&surface_2 shape = 'feature', amplitude = 1e-6, wavelength = 1e-4, position = -3.0 /
&time transient = .true., end_time = 3.0, time_step = 0.01, scheme = 'backward_euler' /
&accuracy error_bars = .false. /
"""
)
THRESHOLDS = [20e-9, 100e-9, 500e-9]


FLOOR = "&solver film_floor = {}, on_film_breakdown = '{}' /\n"


def test_breakdown_stops_and_says_where_and_when(run_case, tmp_path):
    done = run_case(HIGH + FLOOR.format("15e-9", "stop"), "--quiet", status=2, name="a")
    with h5py.File(tmp_path / "a.h5") as file:
        reason = text(file.attrs["reason"])
        assert reason.startswith("film breakdown at x = 13")
        assert "time step 2" in reason
        assert reason.endswith("below film_floor = 15.00 nm")
        assert " ".join(done.stderr.split()) == f"a.nml: NOT CONVERGED: {reason}"
        assert (file.attrs["converged"], file.attrs["film_breakdown"]) == (0, 1)
        scale = file["scaling"].attrs["film_thickness"]
        stored = file["transient/film_thickness"]
        assert stored[()].min() * scale > 15e-9
        step = file["report/film_breakdown_step"][()]
        assert len(stored) == step
        assert file["report/film_breakdown_time"][()] == pytest.approx(0.01 * step)
        assert file["report/film_breakdown_film"][()] * scale < 15e-9
        assert not file["transient/film_breakdown"][()].any()


@pytest.mark.path
def test_breakdown_goes_on_with_a_mark(solved_case, asperity, tmp_path):
    write(tmp_path, "a.nml", HIGH + FLOOR.format("15e-9", "continue"))
    write(tmp_path, "b.nml", HIGH)
    done = ended(asperity("a.nml", "b.nml", "--quiet"))
    assert done.stderr.startswith("asperity: film breakdown at x = 13")
    assert len(done.stderr.splitlines()) == 1
    with h5py.File(tmp_path / "a.h5") as file, h5py.File(tmp_path / "b.h5") as free:
        assert (file.attrs["converged"], file.attrs["film_breakdown"]) == (1, 1)
        assert free.attrs["film_breakdown"] == 0
        assert "film_breakdown" not in free["transient"]
        scale = file["scaling"].attrs["film_thickness"]
        low = file["transient/h_min"][()] * scale < 15e-9
        assert 1 <= low.sum() < 20
        assert (file["transient/film_breakdown"][()] == low).all()
        assert file["report/film_breakdown_count"][()] == low.sum()
        assert file["report/film_breakdown_step"][()] == np.flatnonzero(low)[0]
        # the floor is no part of the equations
        assert (file["transient/film_thickness"][()] == free["transient/film_thickness"][()]).all()
    with solved_case(HIGH.replace("x_outlet = 3.0", "x_outlet = 1.5"), status=2, name="a") as file:
        assert "smallest film before it: H = 0.01" in text(file.attrs["reason"])
        assert file["transient/film_thickness"][()].min() > 0


@pytest.mark.parametrize("action", ["stop", "continue"])
def test_surfaces_that_touch_at_the_start_leave_no_negative_film(solved_case, action):
    case = HIGH.replace("1e-6", "5e-6").replace("-3.0", "0.0")
    with solved_case(case + FLOOR.format("1e-9", action), status=2) as file:
        assert file.attrs["converged"] == 0
        assert file.attrs["film_breakdown"] == 1
        reason = text(file.attrs["reason"])
        assert reason.startswith("film closed at T = 0")
        assert "film breakdown at X = -0.0078: the film would close" in reason
        assert file["solution/film_thickness"][()].min() > 0


@pytest.mark.parametrize(("action", "status"), [("stop", 2), ("continue", 0)])
def test_steady_breakdown(solved_case, action, status):
    with solved_case(STEADY + FLOOR.format("500e-9", action), status=status, name="a") as file:
        assert file.attrs["film_breakdown"] == 1
        assert file.attrs["converged"] == (status == 0)
        assert text(file.attrs["reason"]).startswith("film breakdown at x = " if status else "converged")
        assert file["solution/film_thickness"][()].min() > 0


@pytest.mark.path
def test_statistics_are_those_of_the_stored_steps(solved_cases):
    shared = HIGH + "&output film_thresholds = 20e-9, 100e-9, 500e-9, fields = 'pressure', 'film_thickness' /\n"
    file, strided = solved_cases(a=shared, b=shared.replace("film_thresholds", "profile_stride = 50, film_thresholds"))
    scale = file["scaling"].attrs["film_thickness"]
    x, series, found = file["solution/x"][()], file["transient"], file["statistics"]
    contact = np.abs(x) <= 1
    counted = (series["time"][()] > 0) & (series["time"][()] >= found.attrs["statistics_from"])
    film, h_min = series["film_thickness"][()][counted][:, contact] * scale, series["h_min"][()][counted] * scale
    assert found["film_threshold"][()] == pytest.approx(THRESHOLDS, rel=1e-12, abs=0)
    assert found["time_below"][()] == pytest.approx([(h_min < h).mean() for h in THRESHOLDS], abs=1e-14)
    assert found["area_below"][()] == pytest.approx([(film < h).mean() for h in THRESHOLDS], abs=1e-12)
    assert found["mean_film"][()] == pytest.approx(film.mean(), rel=1e-12, abs=0)
    for name, values in (("h_min", h_min), ("p_max", series["p_max"][()][counted] * file["scaling"].attrs["hertz_pressure"])):
        share, edges = found[f"{name}_share"][()], found[f"{name}_edges"][()]
        assert share.sum() == pytest.approx(1)
        assert np.histogram(values, edges)[0] / len(values) == pytest.approx(share)
    for name in found:
        assert (found[name][()] == strided["statistics"][name][()]).all(), name


def test_lambda_ratio_of_a_waviness(solved_cases):
    """Rms of A cos is A/sqrt(2), of two waves that pass each other the root of both squares."""
    waves = """&surface_1 shape = 'sinusoid', amplitude = 30e-9, wavelength = 6e-5 /
&surface_2 shape = 'sinusoid', amplitude = 40e-9, wavelength = 4e-5 /
&time transient = .true., end_time = 20.0, time_step = 0.02 /
&output film_thresholds = 100e-9, profile_stride = 1000 /
&accuracy error_bars = .false. /
"""
    file, smooth = solved_cases(a=STEADY + waves, smooth=STEADY)
    found = file["statistics"]
    assert found["rms_height"][()] == pytest.approx(50e-9 / np.sqrt(2), rel=0.02)
    assert found["smooth_film"][()] == pytest.approx(smooth["summary/h_central"][()], rel=1e-6, abs=0)
    assert found["lambda_ratio"][()] == pytest.approx(found["smooth_film"][()] / found["rms_height"][()], rel=1e-13)


OPEN = AT_REST.replace(", intervals = 256", "")
WAVE = "&surface_1 shape = '{}', amplitude = 0.1e-6, wavelength = {}, position = 0.0 /\n"
DX = 5.5 / 256 * 1.05797e-4


@pytest.mark.parametrize("shape", ["feature", "sinusoid"])
def test_chosen_grid_sees_a_wave_of_a_spacing(told_case, shape):
    """Its crests all lie at the same place between the nodes of 256 intervals, where the sinusoid is a plane.

    Behind the outlet at 1.5 the sinusoid would carry on under pressure and add to the friction by 0.6 %, which is noted.
    """
    found, _ = told_case(OPEN + WAVE.format(shape, DX))
    assert 32 <= found["report/nodes_per_wave"] <= 40
    if shape == "feature":
        assert "report/note" not in found
    else:
        assert found["report/note"].startswith(b"the film is still under pressure at the outlet X = 1.500, which changes its")
    fine = AT_REST.replace("= 256", "= 65536") + "&accuracy error_bars = .false. /\n" + WAVE.format(shape, DX)
    truth = told_case(fine)[0]["summary/h_min"]
    assert abs(found["summary/h_min"] - truth) < min(found["summary/h_min@error_estimate"], 0.02 * truth)


@pytest.mark.path
def test_coarse_grid_is_told_and_has_no_estimate(told_case):
    found, told = told_case(AT_REST + WAVE.format("feature", 8.01 * DX))
    assert found["report/nodes_per_wave"] == pytest.approx(8.01, rel=1e-4)
    note = text(found["report/note"])
    assert note == "the finest wave of the surfaces has 8.01 nodes, 32 are needed: 1024 intervals"
    assert note in " ".join(told[told.index("dimensionless") :].split())
    assert np.isnan(found["summary/h_min@error_estimate"])
    assert found["summary/h_min@no_estimate"] == b"the finest wave of the surfaces has 8.01 nodes, an estimate needs 16"


# Rigid cylinders nearly: the film ruptures at X = 2.9, far behind the end of the contact.
LIGHT = """&case problem = 'ehl_line' /
&moes moes_m = 0.3, moes_l = 5.0, velocity = 'sum' /
&lubricant viscosity_law = 'barus', density_law = 'constant' /
&domain x_inlet = -40.0 OUTLET /
"""
FIGURES = ("h_min", "h_central", "p_max")


def solve(told_case, case):
    """Runs a case that converges: figures with value and error of the domain, note (or None), x_outlet [half-widths], log."""
    found, log = told_case(case)
    figures = {name: (found[f"summary/{name}"], found[f"summary/{name}@error_domain"]) for name in FIGURES}
    note = text(found["report/note"]) if "report/note" in found else None
    return figures, note, float(found["input/effective/domain@x_outlet"]), " ".join(log.split())


@pytest.mark.path
def test_outlet_ahead_of_rupture_is_noted_and_part_of_the_estimate(told_case):
    # both grids have the spacing of 41.5/1024
    cut, note, _, log = solve(told_case, LIGHT.replace("OUTLET", ", x_outlet = 1.5, intervals = 1024"))
    whole, no_note, _, _ = solve(told_case, LIGHT.replace("OUTLET", ", x_outlet = 43.0, intervals = 2048"))
    assert note.startswith("the film is still under pressure at the outlet X = 1.5")
    assert note.endswith("without x_outlet the program takes 3.448")
    assert note in log
    assert no_note is None
    for name in FIGURES:
        value, error = cut[name]
        true = abs(value - whole[name][0])
        assert true > 0.005 * value
        assert true < error < 10 * true


@pytest.mark.parametrize("given", ["&accuracy target = 1e-3 /", "&accuracy error_bars = .false. /"])
def test_a_wanted_accuracy_is_not_met_in_silence(told_case, given):
    figures, note, _, _ = solve(told_case, LIGHT.replace("OUTLET", ", x_outlet = 1.5") + given)
    assert note.startswith("the film is still under pressure at the outlet")
    if "target" in given:
        assert figures["h_min"][1] > 1e-2 * figures["h_min"][0]
    else:
        assert "is not known" in note


def test_chosen_outlet_lies_behind_rupture(asperity, told_case, tmp_path):
    for grid, place in ("even", 3.448), ("graded", 5.896):
        case = LIGHT.replace("OUTLET", f", grid = '{grid}'").replace("-40.0", "-400.0")
        figures, note, outlet, _ = solve(told_case, case)
        assert note is None
        assert outlet == pytest.approx(place, abs=1e-3)
        assert figures["h_min"][1] < 1e-3 * figures["h_min"][0]
    # the pressure reaches to X = 1.56 over the ridge, where smooth surfaces would have an outlet at 1.52
    ridge = "&surface_1 shape = 'feature', amplitude = 0.21e-6, wavelength = 4.2e-5, position = 1.57 /\n"
    case = AT_REST.replace("&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /\n", "") + ridge
    _, note, outlet, _ = solve(told_case, case)
    assert note is None
    assert outlet > 2.0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["solution/pressure"][-2] == 0.0
    lines = asperity("--template", "ehl_line").stdout.splitlines()
    assert not [line for line in lines if line.startswith(("   x_inlet", "   x_outlet"))]


def test_outlet_in_time_is_watched_at_every_step(told_case):
    ridge = TRANSIENT.replace("time_step = 0.05", "time_step = 0.02").replace("position = -1.5", "position = -0.5")
    cut, note, _, _ = solve(told_case, ridge.replace("x_outlet = 1.5", "x_outlet = 1.05"))
    whole, no_note, _, _ = solve(told_case, ridge.replace("x_outlet = 1.5", "x_outlet = 6.1").replace("256", "512"))
    assert "the film is still under pressure at the outlet X = 1.05" in note
    assert "outlet" not in no_note
    for name in FIGURES:
        assert abs(cut[name][0] - whole[name][0]) < cut[name][1]


@pytest.mark.path
@pytest.mark.parametrize("text", [cases.STEADY, cases.TRANSIENT])
def test_velocity_in_the_result(told_case, text):
    """Speeds of the walls in SI; of a steady film one mass flux at all nodes, of a transient the film of the last time."""
    found = told_case(text + "&output velocity_layers = 40 /\n", "--quiet")[0]
    u, zeta = found["velocity/u"], found["velocity/zeta"]
    assert u.shape == (257, 41)
    assert np.array_equal(zeta, np.arange(41) / 40)
    assert cases.text(found["velocity/u@si_units"]) == "m/s"
    speeds = u * found["velocity/u@si_scale"]
    assert np.allclose(speeds[:, 0], 0.1, rtol=1e-12)
    assert np.allclose(speeds[:, -1], 1.1, rtol=1e-12)
    mean = (u[:, 0] + u[:, -1] + 4 * u[:, 1:-1:2].sum(axis=1) + 2 * u[:, 2:-2:2].sum(axis=1)) / 120
    x, p, h = (found[f"solution/{name}"] for name in ("x", "pressure", "film_thickness"))
    inner = np.abs(x) < 0.7
    slope = np.gradient(p, x)
    by_pressure = found["solution/slip_factor"] * h**2 / found["solution/viscosity"] * slope / (2 * found["scaling@lambda"])
    assert np.allclose(mean[inner], (0.5 - by_pressure)[inner], rtol=0, atol=1e-6)
    if "transient/time" not in found:
        flux = found["solution/density"] * h * mean
        assert np.ptp(flux[inner]) < 6e-3 * flux[128]
    # nothing but a straight line where it cavitates
    empty = np.flatnonzero(p == 0)[1:]
    assert empty.size > 0
    assert np.allclose(u[empty], (0.1 + zeta) / 1.2, rtol=1e-12)

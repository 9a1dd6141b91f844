"""Film breakdown and statistics of the film: told, marked, stopped or not, and never a film that is not there."""

import h5py
import numpy as np
import pytest
from cases import STEADY, ended, text, write

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


def floor(value, action):
    return f"&solver film_floor = {value}, on_film_breakdown = '{action}' /\n"


def test_breakdown_stops_and_says_where_and_when(run_case, tmp_path):
    done = run_case(HIGH + floor("15e-9", "stop"), "--quiet", status=2, name="a")
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
    write(tmp_path, "a.nml", HIGH + floor("15e-9", "continue"))
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
    with solved_case(HIGH.replace("1e-6", "5e-6").replace("-3.0", "0.0") + floor("1e-9", action), status=2, name="a") as file:
        assert file.attrs["converged"] == 0
        assert file.attrs["film_breakdown"] == 1
        reason = text(file.attrs["reason"])
        assert reason.startswith("film closed at T = 0")
        assert "film breakdown at X = -0.0078: the film would close" in reason
        assert file["solution/film_thickness"][()].min() > 0


@pytest.mark.parametrize(("action", "status"), [("stop", 2), ("continue", 0)])
def test_steady_breakdown(solved_case, action, status):
    with solved_case(STEADY + floor("500e-9", action), status=status, name="a") as file:
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

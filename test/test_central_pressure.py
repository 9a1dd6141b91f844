"""p_central: the pressure at X = 0, beside a largest pressure that is that of a spike which the grid does not resolve."""

import h5py
import numpy as np
import pytest
from conftest import ROOT
from scipy.interpolate import CubicSpline

MINIMAL = ROOT / "input" / "minimal.nml"


def row(lines, name):
    """Relative error [%] in the closing table; None: not known."""
    (line,) = [line for line in lines if line.startswith(f"  {name} ")]
    return None if "not known" in line else float(line.split("+-")[1].split()[0])


def test_first_run_has_a_pressure_that_is_good_to_one_per_cent(asperity, tmp_path):
    coarse = asperity(MINIMAL)
    assert coarse.returncode == 0
    lines = coarse.stdout.splitlines()
    assert row(lines, "p_max") is None or row(lines, "p_max") > 1
    assert all(row(lines, name) < 1 for name in ("h_min", "h_central", "p_central"))
    with h5py.File(tmp_path / "minimal.h5") as file:
        value, error = file["summary/p_central"][()], file["summary/p_central"].attrs["error_estimate"]
    fine = asperity(MINIMAL, "--set", "accuracy.target=0.01", "--set", "accuracy.target_p_max=0.01")
    lines = fine.stdout.splitlines()
    assert row(lines, "p_max") < 1
    assert not any(line.startswith("  note") for line in lines)
    assert not any(line.startswith("  p_central") for line in lines)
    with h5py.File(tmp_path / "minimal.h5") as file:
        assert abs(value - file["summary/p_central"][()]) <= error
        assert file["summary/p_max"][()] > 1.5 * value


# Largest pressure of the spike of minimal.nml on 2^20 intervals and on infinitely many, by the first order in which it rises
# there: 988.908, 989.373 MPa on 2^19 and 2^20.
SPIKE = 989.84e6


@pytest.mark.parametrize("intervals", [16384, 32768, 65536, 131072])
def test_spike_rises_on_finer_grids_by_no_more_than_its_error(asperity, tmp_path, intervals):
    """From 65536 intervals on the grid resolves the flanks, and the vertices of parabolas rise by less than the nodes."""
    assert asperity(MINIMAL, "--quiet", "--set", f"domain.intervals={intervals}").returncode == 0
    with h5py.File(tmp_path / "minimal.h5") as file:
        found = file["summary/p_max"]
        assert 0.001 * SPIKE < SPIKE - found[()] < found.attrs["error_estimate"]


def spike_words(done):
    """What the closing table says of a spike, its lines joined."""
    lines = done.stdout.splitlines()
    first = [i for i, line in enumerate(lines) if line.startswith("  spike ")]
    if not first:
        return ""
    last = next(i for i in range(first[0] + 1, len(lines)) if not lines[i].startswith(" " * 12))
    assert all(len(line) <= 80 for line in lines[first[0] : last])
    return " ".join(line.strip() for line in lines[first[0] : last])


def test_spike_is_explained_and_the_advice_does_what_it_says(asperity):
    words = spike_words(asperity(MINIMAL))
    assert "p_max is the top of a pressure spike" in words
    assert "p_central is the pressure beside it" in words
    advice = words.partition("known to 1 %: ")[2].split()
    assert advice[::2] == ["--set", "--set"]
    fine = asperity(MINIMAL, *advice)
    assert row(fine.stdout.splitlines(), "p_max") < 1
    assert spike_words(fine) == ""


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ("domain.intervals=512", "known to 1 %, without &domain intervals: --set"),
        ("load.hertz_pressure=1.5e9", "on finer ones may rise above p_max"),
        ("time.transient=.true. time.end_time=0.2 load.hertz_pressure=0.5e9", "More &domain intervals show more of it"),
    ],
)
def test_words_about_a_spike_fit_the_case(asperity, settings, expected):
    done = asperity(MINIMAL, *[word for setting in settings.split() for word in ("--set", setting)])
    assert done.returncode == 0
    assert expected in spike_words(done)
    assert ("--set" in spike_words(done)) == ("transient" not in settings)


def test_no_words_about_a_spike_where_there_is_none(asperity, tmp_path):
    (tmp_path / "case.nml").write_text(asperity("--template", "ehl_line").stdout, encoding="utf-8")
    assert spike_words(asperity("case.nml")) == ""
    coarse = asperity(MINIMAL, "--set", "bodies.speed_1=20", "--set", "bodies.speed_2=20", "--set", "load.hertz_pressure=1e8")
    assert spike_words(coarse) == ""


def test_wanted_accuracy_of_the_spike_beyond_all_grids_is_told(asperity):
    wanted = ("--set", "accuracy.target=0.01", "--set", "accuracy.target_p_max=1e-7", "--set", "load.hertz_pressure=2e8")
    done = asperity(MINIMAL, *wanted)
    assert done.returncode == 0
    assert "the wanted accuracy of p_max is not shown: " in done.stderr
    assert "1.0E-07 was wanted" in done.stdout


@pytest.mark.parametrize("other", ["", "accuracy.target=0.01 time.transient=.true. time.end_time=1.0"])
def test_target_of_the_pressure_is_for_steady_contacts_with_a_target(asperity, other):
    words = [word for setting in other.split() for word in ("--set", setting)]
    done = asperity(MINIMAL, "--set", "accuracy.target_p_max=0.01", *words)
    assert done.returncode == 1
    assert "&accuracy target_p_max: found a key that is not used with" in done.stderr


def test_template_has_every_number_to_one_per_cent(asperity, tmp_path):
    (tmp_path / "case.nml").write_text(asperity("--template", "ehl_line").stdout, encoding="utf-8")
    lines = asperity("case.nml").stdout.splitlines()
    assert all(row(lines, name) < 1 for name in ("h_min", "h_central", "p_max", "friction"))


@pytest.mark.parametrize("intervals", [160, 256])
def test_is_the_pressure_of_the_solution(asperity, tmp_path, intervals):
    """With a node at X = 0 or none."""
    assert asperity(MINIMAL, "--quiet", "--set", f"domain.intervals={intervals}").returncode == 0
    with h5py.File(tmp_path / "minimal.h5") as file:
        x, p = file["solution/x"][()], file["solution/pressure"][()]
        found = file["summary/p_central"]
        near = np.abs(x) < 0.3
        assert found.attrs["dimensionless"] == pytest.approx(float(CubicSpline(x[near], p[near])(0.0)), rel=2e-5)
        assert found[()] == pytest.approx(found.attrs["dimensionless"] * 0.6e9, rel=1e-12)

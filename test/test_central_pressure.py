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
    fine = asperity(MINIMAL, "--set", "domain.intervals=65536")
    lines = fine.stdout.splitlines()
    assert row(lines, "p_max") < 1
    assert not any(line.startswith("  p_central") for line in lines)
    with h5py.File(tmp_path / "minimal.h5") as file:
        assert abs(value - file["summary/p_central"][()]) <= error
        assert file["summary/p_max"][()] > 1.5 * value


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

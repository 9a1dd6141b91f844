"""Dry contacts of given separation: back to the load it came from, exact solutions, refusals."""

import numpy as np
import pytest
from cases import write
from dry_cases import HARD, case_text, close, profile, solve


def separated(asperity, folder, surface, separations, **options):
    return solve(asperity, folder, surface, separations, key="separation", **options)


@pytest.mark.parametrize("bodies", ["", HARD])
@pytest.mark.parametrize("name", ["A", "C"])
def test_load_to_separation_to_load(asperity, tmp_path, name, bodies):
    # From a single node to 97.5 % of the hardness; A is mostly plastic: there the datum is an interval at some loads.
    loads = [1e5, 12.5e6, 250e6, 1e9, 3.9e9]
    with solve(asperity, tmp_path, profile(name), loads, bodies) as file:
        first = {key: value[()] for key, value in file["sweep"].items()}
    assert np.all(np.diff(first["separation"]) < 0)
    plane = first["mean_separation"] - first["dp_mean"]
    np.testing.assert_allclose(first["separation"], plane, atol=1e-12 * first["rq_undeformed"][0])
    with separated(asperity, tmp_path, profile(name), first["separation"], bodies=bodies) as file:
        second = {key: value[()] for key, value in file["sweep"].items()}
    rms = first["rq_undeformed"][0]
    np.testing.assert_allclose(second["separation"], first["separation"], rtol=0, atol=1e-12 * rms)
    np.testing.assert_allclose(second["mean_pressure"], first["mean_pressure"], rtol=1e-8)
    np.testing.assert_allclose(second["load"], first["load"], rtol=1e-8)
    assert list(second["contact_area_fraction"]) == list(first["contact_area_fraction"])
    assert list(second["plastic_area_fraction"]) == list(first["plastic_area_fraction"])
    assert second["kkt"].max() <= 1e-12


def test_datum_between_two_nodes(asperity, tmp_path):
    # All contact nodes at the hardness: the load stays, the separation is free between two values.
    heights = [4.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    write(tmp_path, "z.csv", "x,z\n" + "".join(f"{i}e-6,{z}e-6\n" for i, z in enumerate(heights)))
    surface = "shape = 'file', file = 'z.csv', detrend = 'none'"
    separations = np.array([2.6, 2.2, 1.8, 1.4]) * 1e-6
    with separated(asperity, tmp_path, surface, separations, bodies=", hardness = 1e6") as file:
        sweep = {key: value[()] for key, value in file["sweep"].items()}
    np.testing.assert_allclose(sweep["separation"], separations, rtol=1e-12)
    np.testing.assert_allclose(sweep["mean_pressure"], 1e6 / 8, rtol=1e-12)
    assert list(sweep["plastic_area_fraction"]) == [1 / 8] * 4
    # Below, the one node sinks with the plane.
    np.testing.assert_allclose(np.diff(sweep["dp_max"]), -np.diff(separations), rtol=1e-9)
    assert sweep["kkt"].max() <= 1e-12


@pytest.mark.path
def test_history_of_separations(run_case, asperity, tmp_path):
    # Back at the first separation the deformed surface is where it was; further out it has lost contact sooner.
    surface, options = profile("C"), {"bodies": HARD}
    with separated(asperity, tmp_path, surface, [2e-7, 2.6e-7, 2e-7], loading=", loading = 'history'", **options) as file:
        history = {key: value[()] for key, value in file["sweep"].items()}
    with separated(asperity, tmp_path, surface, [2.6e-7], **options) as file:
        virgin = file["sweep/load"][0]
    close(history["load"][2], history["load"][0], 1e-8)
    close(history["dp_mean"], np.full(3, history["dp_mean"][0]), 1e-8)
    assert history["load"][1] < 0.9 * virgin
    text = case_text(surface, [1e-7, 5e-7], HARD, key="separation", loading=", loading = 'history'")
    assert "found a separation at which nothing touches" in run_case(text, "--quiet", status=1, name="apart").stderr
    assert not (tmp_path / "apart.h5").exists()


def test_where_there_is_no_separation(asperity, tmp_path):
    with solve(asperity, tmp_path, profile("C"), [4e9]) as file:
        lowest = file["sweep/separation"][0]
    with separated(asperity, tmp_path, profile("C"), [lowest - 1e-7], bodies=HARD) as file:
        assert file["sweep/mean_pressure"][0] == pytest.approx(4e9, rel=1e-14)
        assert file["solution/plastic_deformation"][:].min() == pytest.approx(1e-7, rel=1e-9, abs=0)
    domain = "&domain length = 1e-3, intervals = 64, periodic = .false. /"
    surface = "shape = 'sinusoid', amplitude = 1e-6, wavelength = 1e-3"
    with solve(asperity, tmp_path, surface, [1e6], bodies="", more=domain) as file:
        assert "separation" not in file["sweep"]

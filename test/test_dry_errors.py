"""Error bars of dry contacts: where they stand, that they hold, what switches them off."""

import h5py
import numpy as np
import pytest
from cases import text, write
from dry_cases import HARD, HEIGHTS, case_text, profile, solve, write_heights

MODULUS, LENGTH = 230e9, 1e-3
ESTIMATED = {"contact_area_fraction", "plastic_area_fraction", "plasticity_index", "mean_separation", "separation", "datum"}
ESTIMATED |= {"p_max", "dp_max", "dp_mean", "elastic_energy", "dissipated_energy"}
SUMMARY = {"p_max", "contact_area_fraction", "plastic_area_fraction", "mean_separation"}
OFF = "&accuracy error_bars = .false. /"


@pytest.mark.path
def test_every_figure_has_an_estimate(asperity, tmp_path):
    with solve(asperity, tmp_path, profile("C"), [25e6, 250e6]) as file:
        assert {name for name, data in file["sweep"].items() if "error_estimate" in data.attrs} == ESTIMATED
        assert set(file["summary"]) == SUMMARY
        for name in ESTIMATED:
            found = file["sweep"][name].attrs["error_estimate"]
            assert found.shape == (2,)
            assert np.all(np.isfinite(found) & (found >= 0)), name
        for name in SUMMARY:
            last = file["sweep"][name]
            assert file["summary"][name].attrs["error_estimate"] == last.attrs["error_estimate"][-1]
            assert file["summary"][name][()] == last[-1]
        phases = text(file["report/phase_seconds"].attrs["phases"]).split(", ")
        assert file["report/phase_seconds"][phases.index("error_bars")] > 0
    found = []
    for more in ("", OFF):
        with solve(asperity, tmp_path, profile("A"), [100e6], more=more) as file:
            found.append({name: data[()] for name, data in file["sweep"].items()})
            found[-1]["pressure"] = file["solution/pressure"][()]
            if more:
                assert np.isnan(file["summary/p_max"].attrs["error_estimate"])
                assert text(file["summary/p_max"].attrs["no_estimate"]) == "no other grids are compared"
    for name, values in found[0].items():
        assert np.array_equal(values, found[1][name]), name
    write(tmp_path, "case.nml", case_text(profile("C"), [250e6], HARD))
    lines = asperity("case.nml").stdout.splitlines()
    with h5py.File(tmp_path / "case.h5") as file:
        area = file["summary/contact_area_fraction"]
        share = 100 * area.attrs["error_estimate"] / area[()]
    bar = next(line for line in lines if line.strip().startswith("+-"))
    assert float(bar.split()[1]) == pytest.approx(share, rel=0.06)
    write(tmp_path, "case.nml", case_text(profile("C"), [250e6], HARD, OFF))
    assert "+-" not in asperity("case.nml").stdout


def test_no_estimate_without_a_solution(solved_case, tmp_path, asperity):
    content = case_text(profile("C"), [100e6]).replace("tolerance = 1e-12", "tolerance = 1e-12, max_cycles = 3")
    with solved_case(content, status=2) as file:
        for name in SUMMARY:
            assert np.isnan(file["summary"][name].attrs["error_estimate"]), name
    surface = "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3"
    for nodes, is_known in ((6, False), (9, True)):
        with solve(asperity, tmp_path, surface, [1e7], "", f"&domain length = 1e-3, intervals = {nodes} /") as file:
            for name in SUMMARY:
                assert np.isfinite(file["summary"][name].attrs["error_estimate"]) == is_known, name
            if not is_known:
                assert text(file["summary/p_max"].attrs["no_estimate"]) == "no solution, or too few other grids with one"


@pytest.mark.parametrize("nodes", [96, 131, 400])
@pytest.mark.parametrize("share", [0.1, 0.3, 0.8])
def test_westergaard_is_within_the_bars(asperity, tmp_path, nodes, share):
    height = 1e-6
    full = np.pi * MODULUS / 2 * height / LENGTH
    surface = f"shape = 'sinusoid', amplitude = {height}, wavelength = {LENGTH}"
    domain = f"&domain length = {LENGTH}, intervals = {nodes} /"
    with solve(asperity, tmp_path, surface, [share * full], "", domain, modulus=MODULUS) as file:
        for name, exact in {
            "contact_area_fraction": 2 / np.pi * np.arcsin(np.sqrt(share)),
            "mean_separation": height * (1 - share * (1 - np.log(share))),
            "p_max": 2 * full * np.sqrt(share),
        }.items():
            data = file["summary"][name]
            assert abs(data[()] - exact) <= data.attrs["error_estimate"] < 0.3 * exact, name


@pytest.mark.path
@pytest.mark.parametrize("nodes", [48, 144])  # finer and coarser grids
def test_a_given_separation_has_a_load_with_an_error(asperity, tmp_path, nodes):
    sizes = f"length_x = 2.4e-4, length_y = 2.4e-4, intervals_x = {nodes}, intervals_y = {nodes}"
    radius, half_width = 0.005, 70e-6
    surface, options = "shape = 'parabola'", {"problem": "dry_area", "key": "separation", "modulus": MODULUS}
    bodies, domain = f", reduced_radius = {radius}", f"&domain {sizes} /"
    with solve(asperity, tmp_path, surface, [half_width**2 / radius], bodies, domain, **options) as file:
        load = file["sweep/load"]
        exact = 2 / 3 * MODULUS * half_width**3 / radius
        assert abs(load[0] - exact) <= load.attrs["error_estimate"][0] < 0.05 * exact
        assert load[0] == pytest.approx(exact, rel=0.3 / nodes)
        assert file["sweep/separation"][0] == pytest.approx(half_width**2 / radius, rel=1e-10, abs=0)


def test_bars_of_many_nodes_are_sharp(asperity, tmp_path):
    # Six nodes in the shortest wave: much coarser grids lose waves, which is no error of this one.
    rng = np.random.default_rng(5)
    nodes, most = 144, 24
    wave = np.hypot(*np.meshgrid(*[np.fft.fftfreq(nodes, 1 / nodes)] * 2))
    kept = np.where((wave >= 1) & (wave <= most), np.maximum(wave, 1), np.inf)
    heights = np.fft.ifft2(np.fft.fft2(rng.standard_normal((nodes, nodes))) * kept**-1.8).real
    write_heights(tmp_path, 2e-7 * heights / heights.std(), 2.4e-4 / nodes)
    found = {}
    for n, more in ((nodes, ""), (2 * nodes, OFF)):
        domain = f"&domain length_x = 2.4e-4, length_y = 2.4e-4, intervals_x = {n}, intervals_y = {n} /"
        options = {"more": f"{more}\n{domain}", "problem": "dry_area", "modulus": MODULUS}
        with solve(asperity, tmp_path, HEIGHTS, [1e8], "", **options) as file:
            found[n] = {name: (file["summary"][name][()], file["summary"][name].attrs["error_estimate"]) for name in SUMMARY}
    for name, widest in {"mean_separation": 2e-3, "p_max": 0.15, "contact_area_fraction": 0.15}.items():
        value, bar = found[nodes][name]
        exact = found[2 * nodes][name][0]
        assert abs(value - exact) <= bar < widest * exact, name


def test_each_load_of_a_sweep_has_the_bars_that_it_has_alone(asperity, tmp_path):
    loads = [25e6, 250e6]
    with solve(asperity, tmp_path, profile("C"), loads, "") as file:
        together = {name: file["sweep"][name].attrs["error_estimate"] for name in ("mean_separation", "p_max")}
    for i, load in enumerate(loads):
        with solve(asperity, tmp_path, profile("C"), [load], "") as file:
            for name, bars in together.items():
                assert file["sweep"][name].attrs["error_estimate"][0] == pytest.approx(bars[i], rel=0.05), name

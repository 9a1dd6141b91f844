"""Dry contacts end to end: reference data, surfaces from files and from seeds."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from cases import contents, ended, same_bits, write
from dry_cases import HARD, HEIGHTS, STEEL, case_text, close, profile, rows, solve, write_heights
from test_postproc import run

# Of the sweep, and of the reference table.
COLUMNS = [
    *("contact_area_fraction Ar_An_ep", "plastic_area_fraction Ap_An", "plasticity_index Ap_Ar", "mean_separation mean_gap_ep"),
    *("datum datum_ep", "dp_max dp_max", "dp_mean dp_mean", "elastic_energy U_el_J_m", "dissipated_energy D_pl_J_m"),
    *("ra_unloaded unl_Ra", "rq_unloaded unl_Rq", "rz_unloaded unl_Rz", "rsk_unloaded unl_Rsk", "rku_unloaded unl_Rk"),
    *("ra_loaded lep_Ra", "rz_loaded lep_Rz", "rku_loaded lep_Rk"),
]


@pytest.mark.path
@pytest.mark.parametrize("counter", ["rigid", "steel"])
@pytest.mark.parametrize("name", ["A", "C"])
def test_sweep_of_a_profile(asperity, tmp_path, name, counter):
    table = [row for row in rows("sweep_AC.csv") if row["profile"] == name and row["counter"] == counter]
    loads = [float(row["pbar_MPa"]) * 1e6 for row in table]
    assert len(loads) == 13
    second = STEEL if counter == "steel" else ""
    with solve(asperity, tmp_path, profile(name), loads, HARD + second) as file:
        sweep = {key: value[()] for key, value in file["sweep"].items()}
    for key, column in map(str.split, COLUMNS):
        close(sweep[key], [row[column] for row in table])
    assert sweep["kkt"].max() <= 1e-12
    with solve(asperity, tmp_path, profile(name), loads, second) as file:
        sweep = {key: value[()] for key, value in file["sweep"].items()}
    close(sweep["contact_area_fraction"], [row["Ar_An_el"] for row in table])
    close(sweep["p_max"] / 1e9, [row["pmax_el_GPa"] for row in table])
    close(sweep["mean_separation"], [row["mean_gap_el"] for row in table])
    close(sweep["rsk_loaded"], [row["lel_Rsk"] for row in table])


@pytest.mark.parametrize("row", rows("truncation_A_100kN.csv"), ids=lambda row: row["n"])
def test_truncated_profile(asperity, tmp_path, row):
    surface = profile(row["profile"], int(row["n"]))
    with solve(asperity, tmp_path, surface, [250e6]) as file:
        sweep = {key: value[0] for key, value in file["sweep"].items()}
        pressure = file["solution/pressure"][:]
    # Where 32 nodes at the hardness carry the load exactly, rounding decides whether a further node touches and whether the
    # last of them is just below the hardness, and the separation lies anywhere between two values.
    nodes = round(512 * float(row["Ar_An_ep"])), round(512 * float(row["Ar_An_ep"]) * float(row["Ap_Ar"]))
    if nodes in ((32, 31), (32, 32), (33, 32)):
        np.testing.assert_allclose(np.sort(pressure)[-32:], 4e9, rtol=1e-12)
        assert np.sort(pressure)[-33] < 1e-12 * 4e9
    else:
        close(sweep["contact_area_fraction"], float(row["Ar_An_ep"]))
        close(sweep["plasticity_index"], float(row["Ap_Ar"]))
        close(sweep["mean_separation"], float(row["mean_gap_ep"]))
        assert np.count_nonzero(pressure == 4e9) == nodes[1]
    close(sweep["ra_undeformed"], float(row["und_Ra"]))
    close(sweep["rz_undeformed"], float(row["und_Rz"]))


SYNTHETIC = """shape = 'synthetic', rms_height = 1e-6, wavelength_rolloff = 1e-4, wavelength_short = 1.25e-5, seed = {seed},
   skewness = {skewness}, kurtosis = {kurtosis}"""
SIZES = {
    "dry_line": "&domain length = 4e-4, intervals = 512 /",
    "dry_area": "&domain length_x = 4e-4, length_y = 3e-4, intervals_x = 96, intervals_y = 72 /",
}


@pytest.mark.path
@pytest.mark.parametrize("problem", SIZES)
def test_synthetic_surface_is_as_wanted(asperity, tmp_path, problem):
    heights = []
    for seed in (1, 1, 2):
        surface = SYNTHETIC.format(seed=seed, skewness=-0.5, kurtosis=3.5)
        with solve(asperity, tmp_path, surface, [1e7], "", SIZES[problem], problem) as file:
            heights.append(file["solution/height_undeformed"][:])
            assert file["sweep/rq_undeformed"][0] == pytest.approx(1e-6, rel=1e-12, abs=0)
            assert file["sweep/rsk_undeformed"][0] == pytest.approx(-0.5, abs=1e-6)
            assert file["sweep/rku_undeformed"][0] == pytest.approx(3.5, abs=1e-6)
            used = file["input/effective/surface_1"].attrs  # defaults and what is chosen are there too
            assert (used["hurst"], used["seed"], used["wavelength_long"]) == (0.8, seed, 4e-4)
            assert "amplitude" not in used
    assert np.array_equal(heights[0], heights[1])
    assert not np.array_equal(heights[0], heights[2])


@pytest.mark.path
def test_fields_that_are_stored(asperity, tmp_path):
    """Some of them, and in single precision: the same numbers, rounded; everything else to the bit."""
    for problem, size in SIZES.items():
        surface = SYNTHETIC.format(seed=1, skewness=0.0, kurtosis=3.0)
        full = contents(Path(solve(asperity, tmp_path, surface, [1e7], "", size, problem).filename))
        chosen = size + "\n&output fields = 'gap', 'pressure', precision = 'single' /"
        few = contents(Path(solve(asperity, tmp_path, surface, [1e7], "", chosen, problem).filename))
        fields = {name for name in full if name.startswith("solution/") and "@" not in name} - {"solution/x", "solution/y"}
        assert len(fields) == 6
        assert {name for name in fields if name in few} == {"solution/pressure", "solution/gap"}
        for name in ("solution/pressure", "solution/gap"):
            assert few[name].dtype == np.float32
            np.testing.assert_array_equal(few[name], full[name].astype(np.float32))
        for name in full:
            if name.startswith(("sweep/", "summary/", "surface/")) and "@" not in name:
                assert same_bits(full[name], few[name]), name


@pytest.mark.path
def test_area_from_hdf5(asperity, tmp_path):
    generator = np.random.default_rng(1)
    heights = generator.standard_normal((24, 32)) * 1e-7
    write_heights(tmp_path, heights, (1e-6, 2e-6))
    with h5py.File(tmp_path / "z.h5", "r+") as file:
        file.move("z", "maps/z")
    with solve(asperity, tmp_path, HEIGHTS.replace("'z'", "'/maps/z'"), [1e8], problem="dry_area") as file:
        assert np.array_equal(file["solution/height_undeformed"][:], heights)
        assert file["solution/x"][-1] == pytest.approx(31e-6)
        assert file["solution/y"][-1] == pytest.approx(46e-6)
        pressure = file["solution/pressure"][:]
        assert pressure.mean() == pytest.approx(1e8)
        plastic = file["solution/plastic_deformation"][:]
    assert np.all((pressure >= 0) & (pressure <= 4e9))
    assert np.all((plastic == 0) | (pressure == 4e9))


BAD_FILES = {
    "no_file": (None, "no such file"),
    "back_again": ("x,z\n0,1e-6\n1,0\n0,0\n", "found positions that neither rise nor fall"),
    "one_node": ("x,z\n0,1e-6\n", "bad.csv:2:1: found 1 row of numbers, expected at least 2"),
    "huge": ("x,z\n0,1e300\n1,0\n2,0\n", "bad.csv:2:3: found a height of 1.000E+300 m, expected at most 1000 m"),
    "tiny": ("x,z\n0,1e-300\n1,0\n2,0\n", "bad.csv: found heights that differ by 1.000E-300 m, expected 0 or at least 1.0E-20 m"),
    "far": ("x,z\n0,0\n1e300,0\n2e300,0\n", "bad.csv:3:1: found a position of 1.000E+300 m, expected at most 1000000000 m"),
    "dense": ("x,z\n0,0\n1e-300,1\n2e-300,0\n", "bad.csv:4:1: found a spacing of 1.000E-300 m, expected 1.0E-15 to 1000000 m"),
    "no_header": ("0,1e-6\n1,0\n2,0\n", "bad.csv:1:1: found no names, expected those of the keys"),
    "no_column": ("x,height\n0,1e-6\n1,0\n", "found 0 columns z in the names 'x,height', expected one"),
}


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_file(run_case, tmp_path, name):
    content, message = BAD_FILES[name]
    if content:
        write(tmp_path, "bad.csv", content)
    surface = "shape = 'file', file = 'bad.csv', dataset = 'z'"
    done = run_case(case_text(surface, [1e6], ""), status=1)
    assert done.stderr.startswith("case.nml:4: &surface_1 file: ")
    assert message in done.stderr


def test_figures_of_a_profile_and_an_area(asperity, tmp_path):
    with solve(asperity, tmp_path, profile("A"), [1e8, 2e8]):
        pass
    (tmp_path / "case.h5").rename(tmp_path / "profile.h5")
    area = SYNTHETIC.format(seed=1, skewness=0.0, kurtosis=3.0)
    more = "&domain length_x = 4e-4, length_y = 4e-4, intervals_x = 64, intervals_y = 64 /"
    with solve(asperity, tmp_path, area, [1e8], more=more, problem="dry_area"):
        pass
    (tmp_path / "case.h5").rename(tmp_path / "area.h5")
    done = run("dry", tmp_path / "profile.h5", tmp_path / "area.h5", "--output", tmp_path / "figures", "--format", "png")
    assert (done.returncode, done.stderr) == (0, "")
    names = {path.name for path in (tmp_path / "figures").iterdir()}
    assert names == {
        *("profile_profile.png", "profile_sweep.png", "profile_surface.png"),
        *("profile_convergence.png", "area_maps.png", "area_surface.png", "area_convergence.png"),
    }


def test_figures_refuse_other_files(tmp_path):
    write(tmp_path, "no.h5", "no HDF5")
    done = ended(run("dry", tmp_path / "no.h5", "--output", tmp_path), 1)
    assert "no.h5" in done.stderr


@pytest.mark.parametrize("row", rows("jgh_512.csv"), ids=lambda row: row["pbar_over_pstar"])
def test_bisinusoid(solved_case, tmp_path, row):
    nodes, length, height = 512, 1e-3, 1e-6
    wave = np.cos(2 * np.pi * np.arange(nodes) / nodes)
    write_heights(tmp_path, height * np.outer(wave, wave), length / nodes)
    full = 2**0.5 * float(np.pi) * 0.5 * 2e11 * height / length
    loads = [float(row["pbar_over_pstar"]) * full]
    text = case_text(HEIGHTS, loads, bodies="", problem="dry_area", modulus=2e11)
    with solved_case(text.replace("1e-12", "1e-10")) as file:
        sweep = {key: value[0] for key, value in file["sweep"].items()}
    assert sweep["contact_area_fraction"] == pytest.approx(float(row["area_nodes"]), abs=1e-9)
    assert sweep["contact_area_fraction_corrected"] == pytest.approx(float(row["area_perimeter_corrected"]), rel=1e-6)
    assert sweep["mean_separation"] / height == pytest.approx(float(row["mean_gap_over_D"]), abs=1e-6)
    assert sweep["p_max"] / full == pytest.approx(float(row["pmax_over_pstar"]), rel=1e-6)


@pytest.mark.path
@pytest.mark.parametrize(("bodies", "stored"), [("", 0), (", hardness = 2e8", 8)])
def test_zeros_take_no_room_and_are_read_as_zeros(asperity, tmp_path, bodies, stored):
    """The plastic deformation of an elastic contact; where something yields all nodes are stored."""
    surface = "shape = 'synthetic', rms_height = 1e-7, wavelength_short = 2e-5"
    more = "&domain length_x = 4e-4, length_y = 4e-4, intervals_x = 80, intervals_y = 72 /"
    with solve(asperity, tmp_path, surface, [1e7], bodies, more, problem="dry_area") as file:
        field = file["solution/plastic_deformation"]
        assert field.id.get_storage_size() == stored * field.size
        assert (field[()].max() > 0) == (stored > 0)
        assert field.shape == (72, 80)
        assert field[()].min() == 0
        assert file["solution/height_unloaded"].id.get_storage_size() == 8 * field.size
        assert np.array_equal(file["solution/height_unloaded"][()], file["solution/height_undeformed"][()] - field[()])
        for quantity in ("rq", "rsk", "rz"):
            assert (file[f"sweep/{quantity}_unloaded"][0] == file[f"sweep/{quantity}_undeformed"][0]) == (stored == 0)

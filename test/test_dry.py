"""Dry contacts end to end: reference data, surfaces from files on any nodes and from seeds, given separations."""

from pathlib import Path

import cases
import h5py
import numpy as np
import pytest
from cases import HARD, HEIGHTS, STEEL, case_text, close, ended, profile, solve, write, write_heights, write_profile
from test_postproc import run

DATA = cases.ROOT / "test" / "data"
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
    table = [row for row in cases.rows(DATA / "sweep_AC.csv") if row["profile"] == name and row["counter"] == counter]
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


@pytest.mark.parametrize("row", cases.rows(DATA / "truncation_A_100kN.csv"), ids=lambda row: row["n"])
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
        full = cases.contents(Path(solve(asperity, tmp_path, surface, [1e7], "", size, problem).filename))
        chosen = size + "\n&output fields = 'gap', 'pressure', precision = 'single' /"
        few = cases.contents(Path(solve(asperity, tmp_path, surface, [1e7], "", chosen, problem).filename))
        fields = {name for name in full if name.startswith("solution/") and "@" not in name} - {"solution/x", "solution/y"}
        assert len(fields) == 6
        assert {name for name in fields if name in few} == {"solution/pressure", "solution/gap"}
        for name in ("solution/pressure", "solution/gap"):
            assert few[name].dtype == np.float32
            np.testing.assert_array_equal(few[name], full[name].astype(np.float32))
        for name in full:
            if name.startswith(("sweep/", "summary/", "surface/")) and "@" not in name:
                assert cases.same_bits(full[name], few[name]), name


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


@pytest.mark.parametrize(("content", "message"), BAD_FILES.values(), ids=BAD_FILES)
def test_bad_file(run_case, tmp_path, content, message):
    if content:
        write(tmp_path, "bad.csv", content)
    surface = "shape = 'file', file = 'bad.csv', dataset = 'z'"
    done = run_case(case_text(surface, [1e6], ""), status=1)
    assert done.stderr.startswith("case.nml:4: &surface_1 file: ")
    assert message in done.stderr


def test_figures_of_a_profile_and_an_area(run_case, tmp_path):
    run_case(case_text(profile("A"), [1e8, 2e8]), "--quiet", name="profile")
    more = "&domain length_x = 4e-4, length_y = 4e-4, intervals_x = 64, intervals_y = 64 /"
    area = SYNTHETIC.format(seed=1, skewness=0.0, kurtosis=3.0)
    run_case(case_text(area, [1e8], more=more, problem="dry_area"), "--quiet", name="area")
    done = run("dry", tmp_path / "profile.h5", tmp_path / "area.h5", "--output", tmp_path / "figures", "--format", "png")
    assert (done.returncode, done.stderr) == (0, "")
    names = {"profile": ("profile", "sweep", "surface", "convergence"), "area": ("maps", "surface", "convergence")}
    expected = {f"{name}_{kind}.png" for name, kinds in names.items() for kind in kinds}
    assert {path.name for path in (tmp_path / "figures").iterdir()} == expected
    write(tmp_path, "no.h5", "no HDF5")
    assert "no.h5" in ended(run("dry", tmp_path / "no.h5", "--output", tmp_path), 1).stderr


@pytest.mark.parametrize("row", cases.rows(DATA / "jgh_512.csv"), ids=lambda row: row["pbar_over_pstar"])
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


def resampled(z, nodes):
    spectrum = np.fft.rfft(z)
    n = len(z)
    if n % 2 == 0 and nodes > n:
        spectrum[-1] /= 2
    kept = min(len(spectrum), (nodes + 1) // 2)
    return np.fft.irfft(np.concatenate([spectrum[:kept], np.zeros(nodes // 2 + 1 - kept)]), nodes) * nodes / n


def heights(nodes, seed=1):
    return np.random.default_rng(seed).standard_normal(nodes) * 1e-7


FILE = "shape = 'file', file = 'z.csv'"


@pytest.mark.parametrize(("old", "new"), [(64, 96), (64, 97), (63, 200), (64, 48), (96, 33), (50, 50)])
def test_profile_on_other_nodes(asperity, tmp_path, old, new):
    z = heights(old)
    write_profile(tmp_path / "z.csv", z, 1e-6)
    with solve(asperity, tmp_path, FILE, [1e7], "", f"&domain intervals = {new} /") as file:
        expected = z if new == old else resampled(z, new)
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=0, atol=1e-20)
        assert file["solution/x"][()][-1] == pytest.approx(old * 1e-6 * (new - 1) / new)


def test_files_on_other_nodes(asperity, tmp_path):
    # A wave is measured completely with a few nodes: Westergaard's gap to the accuracy of the fine grid.
    height, length, share, modulus = 1e-6, 1e-3, 0.3, 230e9
    write_profile(tmp_path / "z.csv", height * np.cos(2 * np.pi * np.arange(12) / 12), length / 12)
    load = float(share * np.pi * modulus / 2 * height / length)
    with solve(asperity, tmp_path, FILE, [load], "", "&domain intervals = 2000 /", modulus=modulus) as file:
        gap = file["sweep/mean_separation"][0] / height
        assert file["sweep/contact_area_fraction"][0] == pytest.approx(2 * np.arcsin(np.sqrt(share)) / np.pi, abs=2 / 2000)
    assert gap == pytest.approx(1 - share * (1 - np.log(share)), rel=1e-4)
    z = heights(24 * 20).reshape(20, 24)
    write_heights(tmp_path, z, 1e-6)
    domain = "&domain intervals_x = 36, intervals_y = 15 /"
    with solve(asperity, tmp_path, HEIGHTS, [1e7], "", domain, "dry_area") as file:
        rows = np.array([resampled(row, 36) for row in z])
        expected = np.array([resampled(column, 15) for column in rows.T]).T
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=0, atol=1e-20)
    first, second = heights(64), heights(48, 2)
    write_profile(tmp_path / "z.csv", first, 3e-6)
    write_profile(tmp_path / "other.csv", second, 4e-6)
    more = "&surface_2 shape = 'file', file = 'other.csv' /\n&domain periodic = .true. /"
    with solve(asperity, tmp_path, FILE, [1e7], "", more) as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], first + resampled(second, 64), rtol=0, atol=1e-20)


REFUSED = {
    "&domain intervals = 96, periodic = .false. /": "&domain intervals: found 96, expected the 64 nodes of the file",
    "&surface_2 shape = 'file', file = 'other.csv' /": "expected the length of the domain",
    "&domain length = 1e-3 /": "nodes times spacing of the file",
    "&surface_2 shape = 'file', file = 'coarse.csv' /\n&domain periodic = .false. /": (
        "&surface_2 file: found 32 x 1 nodes, expected 64 x 1 as in the other surface"
    ),
}


@pytest.mark.parametrize("more", REFUSED)
def test_what_cannot_be_resampled(run_case, tmp_path, more):
    for name, nodes, spacing in (("z", 64, 1e-6), ("other", 64, 2e-6), ("coarse", 32, 2e-6)):
        write_profile(tmp_path / f"{name}.csv", heights(nodes), spacing)
    assert REFUSED[more] in run_case(case_text(FILE, [1e7], "", more), status=1).stderr


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
    write_profile(tmp_path / "z.csv", [4e-6, 2e-6, 0, 0, 0, 0, 0, 0], 1e-6)
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

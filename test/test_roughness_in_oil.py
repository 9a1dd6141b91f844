"""Measured and synthetic roughness in the oil film: interpolated, moving, entering without a jump."""

import h5py
import numpy as np
import pytest
from cases import STEADY, write
from kill_and_resume import different, undisturbed

PASSAGE = "&time transient = .true., end_time = {end}, time_step = 0.02 /\n&accuracy error_bars = .false. /\n"
SPACING = 1e-6


def passage(surfaces, end=3.0, extra=""):
    return STEADY + surfaces + PASSAGE.format(end=end) + extra


def wave(nodes=400, waves=8, amplitude=40e-9):
    return amplitude * np.cos(2 * np.pi * waves * np.arange(nodes) / nodes)


def write_csv(path, heights):
    table = "".join(f"{i * SPACING:.9e},{0.0:.3e},{z:.17e}\n" for i, z in enumerate(heights))
    path.write_text("x,other,z\n" + table, encoding="utf-8")


def write_hdf5(path, heights):
    with h5py.File(path, "w") as file:
        file["scan/z"] = heights
        file["scan/z"].attrs["spacing"] = SPACING


def run(asperity, tmp_path, text, name="case"):
    write(tmp_path, f"{name}.nml", text)
    done = asperity(f"{name}.nml")
    assert done.returncode == 0, done.stderr
    return tmp_path / f"{name}.h5", done.stderr


def test_csv_and_hdf5_give_the_same(asperity, tmp_path):
    write_csv(tmp_path / "p.csv", wave())
    write_hdf5(tmp_path / "p.h5in.h5", wave())
    surface = "&surface_2 shape = 'file', file = '{}', dataset = '{}' /\n"
    first, _ = run(asperity, tmp_path, passage(surface.format("p.csv", "z")), "first")
    second, _ = run(asperity, tmp_path, passage(surface.format("p.h5in.h5", "scan/z")), "second")
    assert different(first, second) == []


def test_profile_is_interpolated_where_the_surface_is(asperity, tmp_path):
    """A cosine in a file is a cosine in the contact, at its place, once the entry has passed."""
    write_csv(tmp_path / "p.csv", wave())
    surface = "&surface_1 shape = 'file', file = 'p.csv', dataset = 'z', harmonics = 8, position = 0.0 /\n"
    fast = surface.replace("surface_1", "surface_2")
    path, _ = run(asperity, tmp_path, passage(fast, end=6.0))
    with h5py.File(path) as file:
        x, scale = file["solution/x"][()], file["solution/roughness_2"].attrs["si_scale"]
        half_width = file["scaling"].attrs["half_width"]
        moved = 2 * 1.1 / 1.2 * file["solution/time"][()]
        s = (x - moved) * half_width + 0.5 * 399 * SPACING
        expected = 40e-9 * np.cos(2 * np.pi * s / (50 * SPACING))
        assert file["solution/roughness_2"][()] * scale == pytest.approx(expected, abs=2e-4 * 40e-9)
        assert not file["solution/roughness_1"][()].any()


def test_roughness_enters_without_a_jump(asperity, tmp_path):
    write_csv(tmp_path / "p.csv", wave(nodes=4000, waves=80))
    surface = "&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n"
    path, _ = run(asperity, tmp_path, passage(surface, end=4.0))
    smooth, _ = run(asperity, tmp_path, STEADY, "smooth")
    with h5py.File(path) as file, h5py.File(smooth) as other:
        film = file["transient/film_thickness"][()]
        assert film[0] == pytest.approx(other["solution/film_thickness"][()], abs=1e-12)
        steps = np.abs(np.diff(file["transient/h_min"][()]))
        assert steps[:20].max() < 1e-4
        assert np.ptp(file["transient/h_min"][150:]) > 0.01


def test_profile_that_has_passed_leaves_a_smooth_contact(asperity, tmp_path):
    write_csv(tmp_path / "p.csv", wave())
    surface = "&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n"
    path, _ = run(asperity, tmp_path, passage(surface, end=9.0))
    with h5py.File(path) as file:
        assert np.ptp(file["transient/h_min"][()]) > 0.005
        assert not file["solution/roughness_2"][()].any()


def test_entry_of_a_waviness(asperity, tmp_path):
    sinusoid = "&surface_1 shape = 'sinusoid', amplitude = 50e-9, wavelength = 1e-4, entry_length = 2.0 /\n"
    path, _ = run(asperity, tmp_path, passage(sinusoid))
    with h5py.File(path) as file:
        assert np.abs(np.diff(file["transient/h_min"][()]))[0] < 1e-5
        assert file["solution/roughness_1"][0] != 0
        assert file["solution/roughness_1"][-1] == 0


def test_synthetic_surface_has_its_rms_height(asperity, tmp_path):
    surfaces = """&surface_1 shape = 'synthetic', rms_height = 30e-9, wavelength_short = 6e-5, wavelength_long = 2e-4, seed = 3 /
&surface_2 shape = 'synthetic', rms_height = 40e-9, wavelength_short = 6e-5, wavelength_long = 2e-4, seed = 4 /
"""
    statistics = "&output film_thresholds = 1e-7, profile_stride = 100 /\n"
    path, _ = run(asperity, tmp_path, passage(surfaces, 60.0, statistics).replace("time_step = 0.02", "time_step = 0.05"))
    with h5py.File(path) as file:
        assert file["statistics/rms_height"][()] == pytest.approx(50e-9, rel=0.2)
        assert file["input/effective/surface_1/seed"][()] == 3
        assert file["input/effective/surface_1/entry_length"][()] == 1.0


def test_seed_decides(asperity, tmp_path):
    surface = "&surface_2 shape = 'synthetic', rms_height = 30e-9, wavelength_short = 8e-5, seed = {} /\n"
    first, _ = run(asperity, tmp_path, passage(surface.format(1)), "first")
    again, _ = run(asperity, tmp_path, passage(surface.format(1)), "again")
    other, _ = run(asperity, tmp_path, passage(surface.format(2)), "other")
    assert different(first, again) == []
    assert different(first, other)


def test_too_few_nodes_are_told(asperity, tmp_path):
    surface = "&surface_2 shape = 'synthetic', rms_height = 30e-9, wavelength_short = 5e-5 /\n"
    _, told = run(asperity, tmp_path, passage(surface))
    assert "the finest waves of the roughness have 22. nodes, 48 are needed: 1024 intervals" in told
    _, told = run(asperity, tmp_path, passage(surface.replace("5e-5", "3e-4")))
    assert "finest waves" not in told


def test_steady_with_a_rough_surface_at_rest(asperity, tmp_path):
    write_csv(tmp_path / "p.csv", wave(nodes=1000, waves=10))
    surface = "&surface_1 shape = 'file', file = 'p.csv', dataset = 'z' /\n"
    path, _ = run(asperity, tmp_path, STEADY.replace("speed_1 = 0.1", "speed_1 = 0.0") + surface)
    with h5py.File(path) as file:
        scale = file["solution/roughness_1"].attrs["si_scale"]
        assert np.abs(file["solution/roughness_1"][()]).max() * scale == pytest.approx(40e-9, rel=5e-3)


def test_checkpoint_knows_the_heights(program, asperity, tmp_path):
    write_csv(tmp_path / "p.csv", wave())
    text = passage("&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n", 3.0, "&output checkpoint_interval = 0.0 /\n")
    reference, _ = undisturbed(program, tmp_path, text)
    with h5py.File(reference) as file:
        assert len(file["input/effective/surface_2/heights_checksum"][()]) == 16
    write_csv(tmp_path / "p.csv", wave(amplitude=41e-9))
    other, _ = run(asperity, tmp_path, text, "other")
    with h5py.File(reference) as one, h5py.File(other) as two:
        path = "input/effective/surface_2/heights_checksum"
        assert one[path][()] != two[path][()]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("x,z\n0,0\n1e-6,one\n", "p.csv:3: found 'one', expected a number"),
        ("x,z\n0,0\n1e-6,1\n5e-6,1\n", "found uneven positions in"),
        ("x,y\n0,0\n1e-6,1\n", "found no column z in the header of"),
        ("x,z\n0,0\n1e-6,nan\n", "found a height that is no number"),
    ],
)
def test_bad_file(asperity, tmp_path, content, message):
    (tmp_path / "p.csv").write_text(content, encoding="utf-8")
    write(tmp_path, "a.nml", passage("&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n"))
    done = asperity("a.nml")
    assert done.returncode == 1
    assert "&surface_2 file: " in done.stderr
    assert message in done.stderr

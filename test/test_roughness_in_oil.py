"""Measured and synthetic roughness in the oil film, of any length; tilt, form and long waves of measured heights are taken off."""

import signal

import h5py
import numpy as np
import pytest
from cases import AT_REST, HEIGHTS, STEADY, case_text, ended, profile, solve, text, write, write_heights, write_profile
from kill_and_resume import different, killed_at_last, undisturbed, wait_for
from test_long_run import peak_memory

PASSAGE = "&time transient = .true., end_time = {end}, time_step = 0.02 /\n&accuracy error_bars = .false. /\n"
SPACING = 1e-6
FROM_START = "statistics_from = 0.0, end_time"  # short passages of roughness that enters: what counts needs no longer run


def passage(surfaces, end=3.0, extra=""):
    return STEADY + surfaces + PASSAGE.format(end=end) + extra


def wave(nodes=400, waves=8, amplitude=40e-9):
    return amplitude * np.cos(2 * np.pi * waves * np.arange(nodes) / nodes)


def write_hdf5(path, heights, **options):
    with h5py.File(path, "w") as file:
        file.create_dataset("scan/z", data=heights, **options).attrs["spacing"] = FINE


def run(asperity, tmp_path, text, name="case"):
    write(tmp_path, f"{name}.nml", text)
    done = ended(asperity(f"{name}.nml", "--verbose"))
    return tmp_path / f"{name}.h5", done.stderr + done.stdout


# Several windows of the program pass through the contact.
FINE = 1e-8


def fine_profile(nodes=250000):
    """2.5 mm of waviness under noise, 23 half-widths."""
    source = np.random.default_rng(5)
    return 30e-9 * np.cos(np.arange(nodes) * FINE * 2 * np.pi / 3e-4) + 1e-9 * source.standard_normal(nodes)


def fine_passage(name, speeds=(0.1, 1.1), group="surface_2"):
    surface = f"&{group} shape = 'file', file = '{name}', dataset = '{'z' if 'csv' in name else 'scan/z'}' /\n"
    case = passage(surface, 8.0, "&output checkpoint_interval = 0.0, profile_stride = 10 /\n")
    case = case.replace("time_step = 0.02", "time_step = 0.05").replace("intervals = 256", "intervals = 128")
    return case.replace("speed_1 = 0.1, speed_2 = 1.1", f"speed_1 = {speeds[0]}, speed_2 = {speeds[1]}")


@pytest.mark.parametrize(("speeds", "group"), [((0.1, 1.1), "surface_2"), ((-0.9, 2.1), "surface_1")])
def test_long_profile_is_the_same_from_every_file(asperity, tmp_path, speeds, group):
    """Read in windows: a table, a plain dataset and a compressed one; the two directions of motion."""
    heights = fine_profile()
    write_profile(tmp_path / "p.csv", heights, FINE)
    write_hdf5(tmp_path / "plain.h5", heights)
    write_hdf5(tmp_path / "packed.h5", heights, chunks=(10000,), compression="gzip")
    results = [
        run(asperity, tmp_path, fine_passage(name, speeds, group).replace("checkpoint_interval = 0.0, ", ""), f"result_{i}")[0]
        for i, name in enumerate(("p.csv", "plain.h5", "packed.h5"))
    ]
    assert different(results[0], results[1]) == []
    assert different(results[0], results[2]) == []
    with h5py.File(results[0]) as file:
        sums = [text(h5py.File(path)[f"input/effective/{group}"].attrs["heights_checksum"]) for path in results]
        assert sums[0] == sums[1] == sums[2]
        x = file["solution/x"][()] * file["scaling"].attrs["half_width"]
        heights_now = file[f"solution/roughness_{group[-1]}"]
        moved = 2 * speeds[int(group[-1]) - 1] / sum(speeds) * 8.0
        first = -4.0 + moved if moved > 0 else 1.5 + moved
        length = (len(heights) - 1) * FINE
        place = x - first * file["scaling"].attrs["half_width"] + (length if moved > 0 else 0.0)
        expected = np.interp(place, np.arange(len(heights)) * FINE, heights)
        assert heights_now[()] * heights_now.attrs["si_scale"] == pytest.approx(expected, abs=3e-9)


def test_long_profile_goes_on_after_a_signal(program, asperity, tmp_path):
    write_hdf5(tmp_path / "p.h5", fine_profile())
    reference, _ = undisturbed(program, tmp_path, fine_passage("p.h5"))
    with killed_at_last(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running, times=7)
        running.send_signal(signal.SIGTERM)
        assert "--resume continues" in running.stderr.read()
    assert running.returncode == 4
    assert "continues after step" in ended(asperity("case.nml", "--resume")).stderr
    assert different(reference, tmp_path / "case.h5") == []


def test_memory_does_not_grow_with_the_profile(program, tmp_path):
    """20 million nodes, of which only the first are written: the others are fill values and need no place in the file."""
    memory = []
    for nodes in (100000, 20000000):
        with h5py.File(tmp_path / "p.h5", "w") as file:
            scan = file.create_dataset("scan/z", (nodes,), chunks=(10000,), dtype="f8", fillvalue=2e-9)
            scan[:50000] = fine_profile(50000)
            scan.attrs["spacing"] = FINE
        write(tmp_path, "case.nml", fine_passage("p.h5").replace("end_time = 8.0", "end_time = 1000.0"))
        with killed_at_last(program, tmp_path) as running:
            wait_for(tmp_path / "case.h5.part", running, times=3)
            memory.append(peak_memory(running))
    assert memory[1] - memory[0] < 4
    assert memory[1] < 60


def test_synthetic_profile_of_any_length(run_case, program, asperity, tmp_path):
    """Longer than what is made at once: from pieces, with the same result every time, in the memory of a short one."""
    surface = "&surface_2 shape = 'synthetic', rms_height = 10e-9, wavelength_short = {}, wavelength_long = 3e-6, seed = 3 /\n"
    stride = "&output profile_stride = 5 /\n"
    case = passage(surface.format("1.5e-8"), 3.0, stride).replace("time_step = 0.02", "time_step = 0.05")
    first, told = run(asperity, tmp_path, case, "first")
    assert "nodes, 32 are needed" in told
    again, _ = run(asperity, tmp_path, case, "again")
    assert different(first, again) == []
    with h5py.File(first) as file:
        assert "heights_checksum" not in file["input/effective/surface_2"].attrs
        heights = file["solution/roughness_2"]
        assert np.std(heights[()]) * heights.attrs["si_scale"] == pytest.approx(10e-9, rel=0.4)
    write(tmp_path, "case.nml", case.replace("end_time = 3.0", "end_time = 10000.0"))
    with killed_at_last(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running, times=3)
        assert peak_memory(running) < 100
    done = run_case(case.replace("3e-6", "4e-5"), status=1)
    assert "&surface_2 wavelength_long: found 4.00000E-05 m, expected at most 2048 times wavelength_short" in done.stderr


def test_heights_that_vanish_end_the_run(program, tmp_path):
    write_hdf5(tmp_path / "p.h5", fine_profile())
    write(tmp_path, "case.nml", fine_passage("p.h5"))
    with killed_at_last(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running, times=2)
        (tmp_path / "p.h5").unlink()
        message = running.stderr.read()
    assert running.returncode == 2
    assert "p.h5: no such file" in " ".join(message.split())
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 0
        assert "p.h5: no such file" in text(file.attrs["reason"])
        assert len(file["transient/time"]) >= 2


def test_complete_result_with_other_heights_is_run_again(asperity, tmp_path):
    surface = "&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n"
    write_profile(tmp_path / "p.csv", wave(), SPACING)
    run(asperity, tmp_path, passage(surface))
    assert "is complete: nothing to do" in asperity("case.nml", "--resume").stderr
    write_profile(tmp_path / "p.csv", wave(amplitude=41e-9), SPACING)
    assert "starts at the beginning" in ended(asperity("case.nml", "--resume")).stderr


def test_profiles_that_enter_and_pass(asperity, tmp_path):
    write_profile(tmp_path / "p.csv", wave(nodes=4000, waves=80), SPACING)
    surface = "&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n"
    path, _ = run(asperity, tmp_path, passage(surface, end=4.0))
    smooth, _ = run(asperity, tmp_path, STEADY, "smooth")
    with h5py.File(path) as file, h5py.File(smooth) as other:
        film = file["transient/film_thickness"][()]
        assert film[0] == pytest.approx(other["solution/film_thickness"][()], abs=1e-12)
        assert np.abs(np.diff(file["transient/h_min"][()]))[:20].max() < 1e-4
        assert np.ptp(file["transient/h_min"][150:]) > 0.01
    write_profile(tmp_path / "p.csv", wave(), SPACING)
    surface = "&surface_2 shape = 'file', file = 'p.csv', dataset = 'z' /\n"
    path, _ = run(asperity, tmp_path, passage(surface, end=9.0))
    with h5py.File(path) as file:
        assert np.ptp(file["transient/h_min"][()]) > 0.005
        assert not file["solution/roughness_2"][()].any()
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
        assert file["input/effective/surface_1"].attrs["seed"] == 3
        assert file["input/effective/surface_1"].attrs["entry_length"] == 1.0
        # The program has placed them in front of the inlet, where they enter.
        assert all(file[f"input/effective/surface_{i}"].attrs["position"] < file["solution/x"][0] for i in (1, 2))


def test_too_few_nodes_are_told(asperity, tmp_path):
    surface = "&surface_2 shape = 'synthetic', rms_height = 30e-9, wavelength_short = 5e-5 /\n"
    path, told = run(asperity, tmp_path, passage(surface).replace("end_time", FROM_START))
    note = "the finest wave of the surfaces has 22.0 nodes, 32 are needed: 384 intervals; the finest moving wave passes in "
    note += "12.9 time steps, 16 are needed: time_step = 0.016"
    table = " ".join(told[told.index("dimensionless") :].split())
    assert f"case.nml: {note}\n" in told
    assert f"note {note} model needed" in table
    with h5py.File(path) as file:
        assert text(file["report/note"][()]) == note
        dx = np.diff(file["solution/x"][:2])[0] * file["scaling"].attrs["half_width"]
        assert file["report/nodes_per_wave"][()] == pytest.approx(5e-5 / dx)
        assert file["report/steps_per_wave"][()] == pytest.approx(12.9, abs=0.05)
    path, told = run(asperity, tmp_path, passage(surface.replace("5e-5", "3e-4")).replace("end_time", FROM_START))
    assert "finest wave" not in told
    with h5py.File(path) as file:
        assert "note" not in file["report"]
        assert file["report/nodes_per_wave"][()] == pytest.approx(3e-4 / dx)


LENGTH = 4e-3
FILE = "shape = 'file', file = 'z.csv'{}"
IN_OIL = AT_REST + "&surface_1 shape = 'file', file = 'z.h5', dataset = 'z'{} /\n&accuracy error_bars = .false. /\n"


def rough(nodes=1000):
    """Roughness of a tenth of a micrometre without tilt and curvature, which does not close [m]."""
    x = np.linspace(-1, 1, nodes)
    z = 1e-7 * np.random.default_rng(7).standard_normal(nodes) + 2e-7 * np.cos(43 * x + 1)
    return x, z - np.polyval(np.polyfit(x, z, 2), x)


def dry(asperity, folder, z, keys="", domain="", bodies=""):
    write_profile(folder / "z.csv", z, LENGTH / (len(z) - 1))
    with solve(asperity, folder, FILE.format(keys), [5e5], bodies, domain) as file:
        heights = file["solution/height_undeformed"][()]
        surface = dict(file["input/effective/surface_1"].attrs)
        note = text(file["report/note"][()]) if "note" in file["report"] else ""
        return heights, surface, note, file["sweep/contact_area_fraction"][0], file["sweep/mean_separation"][0]


@pytest.mark.parametrize("domain", ["", "&domain periodic = .false. /"])
def test_tilt_is_taken_off_and_told(asperity, tmp_path, domain):
    """5 um over 4 mm, in the contact as before the tilt."""
    x, z = rough()
    if domain:
        z = z - 2e-5 * x**2  # a crowned one, which an open domain holds
    plain, _, _, area, separation = dry(asperity, tmp_path, z, domain=domain)
    heights, surface, note, tilted_area, tilted_separation = dry(asperity, tmp_path, z + 2.5e-6 * x + 3e-6, domain=domain)
    np.testing.assert_allclose(heights, plain, rtol=0, atol=1e-19)
    assert tilted_area == area
    assert tilted_separation == pytest.approx(separation, rel=1e-9, abs=0)
    assert surface["detrend"] == b"line"
    assert surface["heights_tilt"] == pytest.approx(1.25e-3, rel=1e-9)
    assert "tilt 0.00125, 5.00E-06 m over 0.00400 m subtracted from the heights of surface_1 (detrend = 'line')" in note


@pytest.mark.parametrize(("word", "degree"), [("none", -1), ("mean", 0), ("line", 1), ("parabola", 2)])
def test_every_word(asperity, tmp_path, word, degree):
    x, z = rough()
    z = z + 3e-6 + 2.5e-6 * x - 4e-6 * x**2
    heights, surface, note, *_ = dry(asperity, tmp_path, z, f", detrend = '{word}'")
    expected = z if degree < 0 else z - np.polyval(np.polyfit(x, z, degree), x)
    np.testing.assert_allclose(heights, expected, rtol=0, atol=1e-17)
    assert surface["detrend"] == word.encode()
    assert ("heights_mean" in surface) == (degree >= 0)
    assert ("subtracted" in note) == (degree >= 1)
    if degree == 2:
        assert surface["heights_curvature"] == pytest.approx(-8e-6 / (LENGTH / 2) ** 2, rel=1e-9)
        assert "curvature -2.00 1/m, 4.00E-06 m high subtracted" in note


def test_heights_that_close_are_repeated_as_they_are(asperity, tmp_path):
    """A wave over the whole period has a line of least squares, but no tilt."""
    wave = 1e-7 * np.sin(2 * np.pi * np.arange(500) / 500)
    heights, surface, note, *_ = dry(asperity, tmp_path, wave)
    np.testing.assert_array_equal(heights, np.loadtxt(tmp_path / "z.csv", delimiter=",", skiprows=1)[:, 1])
    assert (surface["detrend"], note) == (b"none", "")
    with solve(asperity, tmp_path, profile("A"), [1e8]) as file:
        assert file["input/effective/surface_1"].attrs["detrend"] == b"none"


def test_plane_of_an_area(asperity, tmp_path):
    source = np.random.default_rng(2)
    y, x = np.mgrid[-1:1:20j, -1:1:30j]
    z = 1e-8 * source.standard_normal((20, 30)) + 1e-6 + 2e-7 * x - 3e-7 * y
    terms = np.column_stack([np.ones(600), x.ravel(), y.ravel()])
    expected = z - (terms @ np.linalg.lstsq(terms, z.ravel(), rcond=None)[0]).reshape(z.shape)
    write_heights(tmp_path, z, 1e-6)
    with solve(asperity, tmp_path, HEIGHTS, [1e7], "", problem="dry_area") as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=0, atol=1e-20)
        tilts = file["input/effective/surface_1"].attrs["heights_tilt"]
        assert "m in y subtracted from the heights of surface_1" in text(file["report/note"][()])
    assert tilts == pytest.approx([4e-7 / 29e-6, -6e-7 / 19e-6], rel=0.1)


@pytest.mark.path
@pytest.mark.parametrize("nodes", [3000, 200000])
def test_tilt_in_oil(asperity, tmp_path, nodes):
    """Also of a profile that is read in windows: the contact is that of the level one."""
    x = np.linspace(-1, 1, nodes)
    z = 20e-9 * np.cos(40 * x + 1)
    z -= np.polyval(np.polyfit(x, z, 1), x)
    write(tmp_path, "case.nml", IN_OIL.format(""))
    fields = []
    for tilt in (0.0, 2e-6):
        write_heights(tmp_path, z + tilt * x + tilt, LENGTH / (nodes - 1))
        done = ended(asperity("case.nml", "--verbose"))
        words = " ".join((done.stdout + done.stderr).split())
        assert words.count("m over 0.00400 m subtracted from the heights of surface_1") == (2 if tilt else 0)
        with h5py.File(tmp_path / "case.h5") as file:
            fields.append(file["solution/roughness_1"][()])
            assert file["input/effective/surface_1"].attrs["heights_tilt"] == pytest.approx(tilt / 2e-3, abs=1e-12)
    np.testing.assert_allclose(fields[1], fields[0], rtol=0, atol=1e-9 * np.abs(fields[0]).max())


ALPHA = np.sqrt(np.log(2) / np.pi)


def mean_line(z, spacing, cutoff):
    """ISO 16610-21 by its weighting function, as a sum; the weights at the ends have a sum of one."""
    x = np.arange(len(z)) * spacing
    s = np.exp(-np.pi * ((x[:, None] - x[None, :]) / (ALPHA * cutoff)) ** 2)
    return s @ z / s.sum(axis=1)


def by_series(z, spacing, cutoff):
    """The same for many nodes, as a product of series."""
    nodes = len(z) + int(3 * cutoff / spacing)
    share = 0.5 ** (cutoff * np.fft.rfftfreq(nodes, spacing)) ** 2
    line, weights = (np.fft.irfft(np.fft.rfft(values, nodes) * share, nodes)[: len(z)] for values in (z, np.ones(len(z))))
    return line / weights


def test_cut_offs_of_a_profile(asperity, tmp_path):
    x, z = rough()
    spacing = LENGTH / (len(z) - 1)
    keys = ", cutoff_long = 0.8e-3, cutoff_short = 60e-6"
    heights, surface, *_ = dry(asperity, tmp_path, z + 1e-6 * x, keys)
    line = np.polyfit(x, z, 1)
    smooth = mean_line(z - np.polyval(line, x), spacing, 60e-6)
    np.testing.assert_allclose(heights, smooth - mean_line(smooth, spacing, 0.8e-3), rtol=0, atol=1e-18)
    assert (surface["cutoff_long"], surface["cutoff_short"]) == (0.8e-3, 60e-6)


@pytest.mark.parametrize("nodes", [3000, 100000])
def test_cut_offs_in_oil(solved_case, tmp_path, nodes):
    """The same as of heights that were filtered before."""
    place = np.linspace(-1, 1, nodes)
    z = 20e-9 * np.cos(130 * place + 1) + 2e-6 * np.cos(3 * place) + 20e-9 * np.cos(2500 * place)
    spacing = LENGTH / (nodes - 1)
    level = z - np.polyval(np.polyfit(place, z, 1), place)
    smooth = by_series(level, spacing, 20e-6)
    keys = ", cutoff_long = 0.8e-3, cutoff_short = 20e-6"
    fields = []
    for heights, more in ((smooth - by_series(smooth, spacing, 0.8e-3), ", detrend = 'none'"), (z, keys)):
        write_heights(tmp_path, heights, spacing)
        with solved_case(IN_OIL.format(more)) as file:
            fields.append(file["solution/roughness_1"][()] * file["solution/roughness_1"].attrs["si_scale"])
    assert np.abs(fields[0]).max() > 1e-8
    np.testing.assert_allclose(fields[1], fields[0], rtol=0, atol=1e-15)


BAD_CUTOFFS = {
    "cutoff_short = 10e-6": "&surface_1 cutoff_short: found 1.00000E-05 m, expected 1.60E-05 to 0.00400 m, 4 spacings to the",
    "cutoff_long = 5e-3": "&surface_1 cutoff_long: found 0.00500000 m, expected 1.60E-05 to 0.00400 m, 4 spacings to the length",
    "cutoff_long = 2e-4, cutoff_short = 3e-4": "&surface_1 cutoff_short: found 3.00000E-04 m, expected less than cutoff_long",
}


@pytest.mark.parametrize("keys", BAD_CUTOFFS)
def test_cut_offs_that_cannot_be(run_case, tmp_path, keys):
    write_profile(tmp_path / "z.csv", rough()[1], LENGTH / 999)
    assert BAD_CUTOFFS[keys] in run_case(case_text(FILE.format(", " + keys), [1e6], ""), status=1).stderr

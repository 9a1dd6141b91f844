"""Measured and synthetic roughness in the oil film: interpolated, moving, entering without a jump, of any length."""

import signal

import h5py
import numpy as np
import pytest
from cases import STEADY, ended, text, write
from kill_and_resume import different, killed_at_last, undisturbed, wait_for
from test_long_run import peak_memory

PASSAGE = "&time transient = .true., end_time = {end}, time_step = 0.02 /\n&accuracy error_bars = .false. /\n"
SPACING = 1e-6


def passage(surfaces, end=3.0, extra=""):
    return STEADY + surfaces + PASSAGE.format(end=end) + extra


def counted(case):
    """Short passages of roughness that enters: what counts from T = 0 on needs no longer run."""
    return case.replace("end_time", "statistics_from = 0.0, end_time")


def wave(nodes=400, waves=8, amplitude=40e-9):
    return amplitude * np.cos(2 * np.pi * waves * np.arange(nodes) / nodes)


def write_csv(path, heights, spacing=SPACING):
    table = "".join(f"{i * spacing:.9e},{z:.17e}\n" for i, z in enumerate(heights))
    path.write_text("x,z\n" + table, encoding="utf-8")


def write_hdf5(path, heights, spacing=SPACING, **options):
    with h5py.File(path, "w") as file:
        file.create_dataset("scan/z", data=heights, **options)
        file["scan/z"].attrs["spacing"] = spacing


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
    write_csv(tmp_path / "p.csv", heights, FINE)
    write_hdf5(tmp_path / "plain.h5", heights, FINE)
    write_hdf5(tmp_path / "packed.h5", heights, FINE, chunks=(10000,), compression="gzip")
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
    write_hdf5(tmp_path / "p.h5", fine_profile(), FINE)
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
    write_hdf5(tmp_path / "p.h5", fine_profile(), FINE)
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
    write_csv(tmp_path / "p.csv", wave())
    run(asperity, tmp_path, passage(surface))
    assert "is complete: nothing to do" in asperity("case.nml", "--resume").stderr
    write_csv(tmp_path / "p.csv", wave(amplitude=41e-9))
    assert "starts at the beginning" in ended(asperity("case.nml", "--resume")).stderr


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


def test_profiles_that_enter_and_pass(asperity, tmp_path):
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
    write_csv(tmp_path / "p.csv", wave())
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
    path, told = run(asperity, tmp_path, counted(passage(surface)))
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
    path, told = run(asperity, tmp_path, counted(passage(surface.replace("5e-5", "3e-4"))))
    assert "finest wave" not in told
    with h5py.File(path) as file:
        assert "note" not in file["report"]
        assert file["report/nodes_per_wave"][()] == pytest.approx(3e-4 / dx)

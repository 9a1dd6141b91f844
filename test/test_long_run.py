"""Long runs, and coarse runs on a thread of their own: memory does not grow, parts are readable, the bits are the same."""

import pathlib
import random
import signal
import time

import h5py
import numpy as np
import pytest
from cases import HANGING, STEADY, contents, members, same_bits, write
from kill_and_resume import BUSY, busy, different, killed_at_last, read_part, start, undisturbed, wait_for

STEP = 0.01


def long_case(steps, intervals, output=""):
    """Waviness on both surfaces over `steps` time steps; `output` are keys of &output."""
    text = BUSY.replace("intervals = 128", f"intervals = {intervals}").replace("end_time = 12.0", f"end_time = {steps * STEP:.10g}")
    return text + f"&accuracy error_bars = .false. /\n&output checkpoint_interval = 5.0{output} /\n"


def peak_memory(running):
    """Largest resident memory of a process so far [MB]; None if it has ended."""
    try:
        status = pathlib.Path(f"/proc/{running.pid}/status").read_text(encoding="ascii")
    except OSError:
        return None
    line = [line for line in status.splitlines() if line.startswith("VmHWM:")]
    return int(line[0].split()[1]) / 1024 if line else None


def check_part(part, step=STEP):
    """Every time that is counted is there, whole; returns how many."""
    series = read_part(part)
    times = len(series["time"])
    for name, values in series.items():
        assert len(values) == times, name
    assert np.allclose(series["time"], step * np.arange(times), rtol=1e-12), "times are missing"
    for place in {0, times // 2, times - 1}:
        film, pressure = series["film_thickness"][place], series["pressure"][place]
        assert (film > 0).all(), f"a film that is not there at time {place}"
        assert pressure.max() > 0.5, f"a pressure that is not there at time {place}"
        assert series["h_min"][place] <= film.min() * (1 + 1e-12), f"another film at time {place}"
    return times


def follow(running, part, marks):
    """Waits until a run has stored as many times as each of `marks`, looks into the file then; returns the memory at each."""
    memory = []
    for mark in marks:
        wait_for(part, running, times=mark, seconds=3600)
        memory.append(peak_memory(running))
        assert check_part(part) >= mark
    return memory


def test_memory_does_not_grow_with_the_steps(program, tmp_path):
    write(tmp_path, "case.nml", long_case(100000, 64))
    most = members(4000, 40000)
    with killed_at_last(program, tmp_path) as running:
        first, last = follow(running, tmp_path / "case.h5.part", [1000, most])
    # what grows is the residual history: 16 bytes a cycle, doubled when full
    assert last - first < members(1.5, 12)
    assert last < 60
    assert check_part(tmp_path / "case.h5.part") > most


def test_long_run_ends_in_little_memory(program, tmp_path):
    write(tmp_path, "case.nml", long_case(6000, 64))
    with killed_at_last(program, tmp_path) as running:
        (before,) = follow(running, tmp_path / "case.h5.part", [1000])
    largest = 0.0
    with start(program, tmp_path, "--resume") as running:
        while running.poll() is None:
            largest = max(largest, peak_memory(running) or 0.0)
            time.sleep(0.02)
        assert running.returncode == 0, running.stderr.read()
    assert largest < before + 8
    with h5py.File(tmp_path / "case.h5") as result:
        assert len(result["transient/time"]) == 6001


# Wall times, which differ from run to run.
CLOCKS = ("report/wall_seconds", "report/phase_seconds")
WITH_BARS = busy(0.0, "&accuracy error_bars = .true. /\n").replace("end_time = 12.0", "end_time = 4.0")


DOMAIN = "&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /"


def passage(source: random.Random) -> str:
    """A ridge or a wave in steps of either order, on a domain that is long enough or not."""
    shape = source.choice(["feature", "sinusoid"])
    lines = [
        STEADY.replace(DOMAIN, source.choice([DOMAIN.replace("256", "64"), DOMAIN.replace("256", "128"), ""])),
        f"&surface_2 shape = '{shape}', amplitude = {source.uniform(1e-8, 2e-7)!r}, wavelength = {source.uniform(0.8e-4, 2e-4)!r},",
        "   position = -2.5 /",
        f"&time transient = .true., end_time = {source.uniform(0.5, 3.0)!r}, time_step = 0.03,",
        f"   scheme = '{source.choice(['bdf2', 'backward_euler'])}' /",
    ]
    return "\n".join(lines) + "\n"


# The coarse runs began on a domain that becomes longer: they are made again.
LONGER = STEADY.replace("load_per_length = 1e5", "load_per_length = 2e3").replace("x_inlet = -4.0, x_outlet = 1.5, ", "")
LONGER += "&surface_2 shape = 'feature', amplitude = 1e-8, wavelength = 1e-4, position = -4.0 /\n"
LONGER += "&time transient = .true., end_time = 0.5, time_step = 0.05 /\n"


def test_two_threads_give_the_same_bits(asperity, tmp_path):
    source = random.Random(20261310)
    for i, text in enumerate([passage(source) for _ in range(12)] + [LONGER]):
        write(tmp_path, "case.nml", text)
        results = []
        for threads in ("1", "2"):
            done = asperity("case.nml", "--threads", threads, "--quiet")
            assert done.returncode in (0, 2), done.stderr
            results.append(contents(tmp_path / "case.h5"))
        one, two = results
        assert one.keys() == two.keys()
        assert [path for path in one if path not in CLOCKS and not same_bits(one[path], two[path])] == [], i


@pytest.fixture(scope="module", name="whole")
def _whole(program, tmp_path_factory):
    """A passage that nobody disturbs, and how long it takes [s]."""
    folder = tmp_path_factory.mktemp("whole")
    return undisturbed(program, folder, WITH_BARS, "--threads", "2")


@pytest.mark.parametrize("moment", [0.1, 0.4, 0.7, 0.95, 1.1, 1.4])
def test_a_signal_at_any_moment(program, asperity, whole, tmp_path, moment):
    """Interrupted in the march or in the coarse runs: a checkpoint or a whole result, and the same bits in the end."""
    reference, seconds = whole
    write(tmp_path, "case.nml", WITH_BARS)
    with start(program, tmp_path, "--threads", "2") as running:
        time.sleep(moment * seconds)
        running.send_signal(signal.SIGTERM)
        running.communicate(timeout=HANGING)
    assert running.returncode in (0, 4, -signal.SIGTERM)
    assert asperity("case.nml", "--quiet", "--resume", "--threads", "2").returncode == 0
    assert different(reference, tmp_path / "case.h5") == []
    with h5py.File(tmp_path / "case.h5") as file:
        assert "error_estimate" in file["summary/h_min"].attrs

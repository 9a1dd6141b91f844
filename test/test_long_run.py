"""A long transient: its memory does not grow, and NAME.h5.part can be read while it runs and after it was killed."""

import pathlib
import time

import h5py
import numpy as np
from cases import members, write
from kill_and_resume import BUSY, killed_at_last, read_part, start, wait_for

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


def finish(program, folder):
    """Takes the run up again and lets it end; returns its largest memory [MB]."""
    largest = 0.0
    with start(program, folder, "--resume") as running:
        while running.poll() is None:
            largest = max(largest, peak_memory(running) or 0.0)
            time.sleep(0.02)
        assert running.returncode == 0, running.stderr.read()
    return largest


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
    assert finish(program, tmp_path) < before + 8
    with h5py.File(tmp_path / "case.h5") as result:
        assert len(result["transient/time"]) == 6001

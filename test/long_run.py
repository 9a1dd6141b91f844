#!/usr/bin/env python3
"""A long transient: its memory does not grow, and NAME.h5.part can be read while it runs and after it was killed.

    long_run.py [--steps 100000] [--intervals 1024] [--limit 500] [PROGRAM]

Looks into NAME.h5.part when a hundredth, a tenth, half and nearly all of the steps are done, kills the run, goes on with
--resume to the end, and prints the resident memory at each of these moments. Fails if it exceeds the limit [MB] or if the file
does not hold what it should. The quick form of this is in test_long_run.py.
"""

import pathlib
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np
from cases import write
from kill_and_resume import BUSY, killed_at_last, new_parser, read_part, start, wait_for

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


def main():
    parser = new_parser(__doc__)
    parser.add_argument("--steps", type=int, default=100000)
    parser.add_argument("--intervals", type=int, default=1024)
    parser.add_argument("--limit", type=float, default=500.0, help="largest resident memory [MB]")
    arguments = parser.parse_args()
    steps, program = arguments.steps, arguments.program.resolve()
    marks = [steps // 100, steps // 10, steps // 2, steps - steps // 50]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        part = folder / "case.h5.part"
        write(folder, "case.nml", long_case(steps, arguments.intervals))
        begin = time.monotonic()
        with killed_at_last(program, folder) as running:
            memory = follow(running, part, marks)
        seconds = time.monotonic() - begin
        times = check_part(part)
        for mark, peak in zip(marks, memory, strict=True):
            print(f"{mark:7d} times: {peak:.1f} MB")
        used = int(subprocess.run(["du", "-k", part], check=True, capture_output=True, text=True).stdout.split()[0]) / 1024
        print(f"killed after {times - 1} steps, {seconds:.0f} s: all of them readable, {used:.0f} MB on the disk", flush=True)
        memory.append(finish(program, folder))
        with h5py.File(folder / "case.h5") as result:
            assert len(result["transient/time"]) == steps + 1
            assert result.attrs["converged"] == 1
        print(f"resumed and ended: {memory[-1]:.1f} MB, result of {(folder / 'case.h5').stat().st_size / 2**20:.0f} MB")
    if max(memory) > arguments.limit:
        print(f"more than {arguments.limit:.0f} MB")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

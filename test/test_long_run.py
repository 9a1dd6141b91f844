"""Memory and threads: forecasts, long runs whose memory does not grow, parts that are readable, the same bits on two threads."""

import os
import pathlib
import random
import re
import resource
import signal
import subprocess
import time

import bench_program
import h5py
import numpy as np
import pytest
from cases import HANGING, STEADY, TRANSIENT, called, case_text, contents, ended, members, same_bits, write, write_profile
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


MEGABYTE = 1e6
WAVE = "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3"
AREA = "&domain length_x = 1e-3, length_y = 1e-3, intervals_x = {0}, intervals_y = {0}, periodic = .{1}. /"
LINE = "&domain length = 1e-3, intervals = {0}, periodic = .{1}. /"
# Address space of OpenBLAS that is hardly written to.
MAPPED = 136.0
CASES = {
    "line": (case_text(WAVE, [1e6], "", LINE.format(100000, "true")), 0.0),
    "open_line": (case_text(WAVE, [1e6], "", LINE.format(300000, "false")), 0.0),
    "area": (case_text(WAVE, [1e6], "", AREA.format(640, "true"), "dry_area"), 0.0),
    "open_area": (case_text(WAVE, [1e6], "", AREA.format(400, "false"), "dry_area"), 0.0),
    "steady": (STEADY.replace("intervals = 256", "intervals = 65536"), MAPPED),
    "dense": (STEADY.replace("256", "2048") + "&solver method = 'newton_dense' /\n", MAPPED),
    "transient": (TRANSIENT.replace("256", "8192"), MAPPED),
}


def call(program, folder, text, kinds=(), limit=0.0, **env):
    def restrict():
        for kind in kinds:
            resource.setrlimit(kind, (int(limit * MEGABYTE),) * 2)

    write(folder, "case.nml", text)
    return called([program, "case.nml", "--quiet"], cwd=folder, env=os.environ | env, preexec_fn=restrict)


def memory_of(program, folder):
    """Largest memory of a case [MB]."""
    run = bench_program.measured([program, "case.nml", "--quiet"], folder)
    assert run.status in (0, 2), run.words
    return run.memory * 1024**2 / MEGABYTE


def test_memory_does_not_grow_with_a_profile(program, tmp_path):
    surface = "&surface_2 shape = 'file', file = 'z.csv', x_unit = 'm', z_unit = 'm' /\n"
    write(tmp_path, "case.nml", STEADY + surface + "&time transient = .true., end_time = 0.5, time_step = 0.05 /\n")
    memory = []
    for rows in 4000, 400000:  # one that was held took 200 MB, by copies of its contact
        write_profile(tmp_path / "z.csv", 1e-8 * np.sin(0.05 * np.arange(rows)), 5e-6)
        memory.append(memory_of(program, tmp_path))
    assert memory[1] - memory[0] < 4


@pytest.mark.parametrize(("text", "mapped"), CASES.values(), ids=CASES)
def test_what_is_predicted_is_enough_and_asked_for(program, tmp_path, text, mapped):
    refused = call(program, tmp_path, text, [resource.RLIMIT_DATA], 30.0)
    pattern = r"found a grid that needs up to (\S+) MB of memory, expected at most 30.00 MB, the limit of data \(ulimit -d\)\n"
    found = re.search(pattern, ended(refused, 1).stderr)
    assert found, refused.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["case.nml"]
    predicted = float(found[1])
    assert memory_of(program, tmp_path) <= predicted - mapped
    for kind, most in (resource.RLIMIT_DATA, predicted), (resource.RLIMIT_AS, predicted + 100):
        done = call(program, tmp_path, text, [kind], most + 1)
        assert done.returncode in (0, 2), done.stderr


def test_address_space_that_is_too_small(program, tmp_path):
    for limit in (60.0, 100.0, 140.0):
        done = ended(call(program, tmp_path, STEADY, [resource.RLIMIT_AS], limit), 1)
        assert "what the limit of the address space (ulimit -v) leaves beside the libraries" in done.stderr
        assert not (tmp_path / "case.h5").exists()


def test_libraries_with_threads_under_a_limit(program, tmp_path):
    """Each thread of OpenBLAS takes 134 MB, or waits for them for ever: the program says what to do and ends."""
    (tmp_path / "threads.c").write_text(
        "#include <pthread.h>\n#include <unistd.h>\nstatic pthread_t thread;\n"
        "static void *wait_for_ever(void *_) { for (;;) pause(); }\n"
        "__attribute__((constructor)) static void begin(void) { pthread_create(&thread, 0, wait_for_ever, 0); }\n"
        "__attribute__((destructor)) static void end(void) { pthread_join(thread, 0); }\n",
        encoding="utf-8",
    )
    command = ["gcc", "-shared", "-fPIC", "-o", "threads.so", "threads.c", "-lpthread"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=HANGING)
    done = ended(call(program, tmp_path, STEADY, [resource.RLIMIT_AS], 1000.0, LD_PRELOAD=str(tmp_path / "threads.so")), 1)
    told = "found a library with threads under a limit of memory (ulimit -v or -d), expected OPENBLAS_NUM_THREADS=1 in the"
    assert done.stderr == f"{told} environment\n"

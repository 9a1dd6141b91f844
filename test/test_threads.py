"""Coarse runs on a thread of their own: the same bits as on one, whatever happens in between."""

import random
import signal
import time

import h5py
import pytest
from cases import HANGING, STEADY, contents, same_bits, write
from kill_and_resume import busy, different, start, undisturbed

# Wall times, which differ from run to run.
CLOCKS = ("report/wall_seconds", "report/phase_seconds")
BUSY = busy(0.0, "&accuracy error_bars = .true. /\n").replace("end_time = 12.0", "end_time = 4.0")


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


def test_two_threads_give_the_same_bits(asperity, tmp_path):
    source = random.Random(20261310)
    for i in range(12):
        write(tmp_path, "case.nml", passage(source))
        results = []
        for threads in ("1", "2"):
            done = asperity("case.nml", "--threads", threads, "--quiet")
            assert done.returncode in (0, 2), done.stderr
            results.append(contents(tmp_path / "case.h5"))
        one, two = results
        assert one.keys() == two.keys()
        assert [path for path in one if path not in CLOCKS and not same_bits(one[path], two[path])] == [], i


def test_a_domain_that_becomes_longer(asperity, tmp_path):
    """The coarse runs began on the shorter one: they are made again."""
    text = STEADY.replace("load_per_length = 1e5", "load_per_length = 2e3").replace("x_inlet = -4.0, x_outlet = 1.5, ", "")
    text += "&surface_2 shape = 'feature', amplitude = 1e-8, wavelength = 1e-4, position = -4.0 /\n"
    write(tmp_path, "case.nml", text + "&time transient = .true., end_time = 0.5, time_step = 0.05 /\n")
    results = []
    for threads in ("1", "2"):
        assert asperity("case.nml", "--threads", threads, "--quiet").returncode in (0, 2)
        results.append(contents(tmp_path / "case.h5"))
    assert [path for path in results[0] if path not in CLOCKS and not same_bits(results[0][path], results[1][path])] == []


@pytest.fixture(scope="module", name="whole")
def _whole(program, tmp_path_factory):
    """A passage that nobody disturbs, and how long it takes [s]."""
    folder = tmp_path_factory.mktemp("whole")
    return undisturbed(program, folder, BUSY, "--threads", "2")


@pytest.mark.parametrize("moment", [0.1, 0.4, 0.7, 0.95, 1.1, 1.4])
def test_a_signal_at_any_moment(program, asperity, whole, tmp_path, moment):
    """Interrupted in the march or in the coarse runs: a checkpoint or a whole result, and the same bits in the end."""
    reference, seconds = whole
    write(tmp_path, "case.nml", BUSY)
    with start(program, tmp_path, "--threads", "2") as running:
        time.sleep(moment * seconds)
        running.send_signal(signal.SIGTERM)
        running.communicate(timeout=HANGING)
    assert running.returncode in (0, 4, -signal.SIGTERM)
    assert asperity("case.nml", "--quiet", "--resume", "--threads", "2").returncode == 0
    assert different(reference, tmp_path / "case.h5") == []
    with h5py.File(tmp_path / "case.h5") as file:
        assert "error_estimate" in file["summary/h_min"].attrs

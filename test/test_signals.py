"""Whoever asks the program to end gets status 4 within a second, a word, and no left-over files; nobody has to listen to it."""

import contextlib
import os
import signal
import subprocess
from pathlib import Path

import h5py
import pytest
from cases import HANGING, LONG, STEADY, called, ended, write
from kill_and_resume import wait_for
from test_resume import SIGNALS, names

# Seconds of solving, without a look at the outside.
DRY = """&case problem = 'dry_area' /
&bodies youngs_modulus_1 = 206e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 1e7, 2e7, 4e7, 8e7, 1e8, 2e8, 3e8, 4e8, 5e8, 6e8 /
&surface_1 shape = 'synthetic', seed = 3, hurst = 0.8, rms_height = 1e-6, wavelength_long = 1e-3, wavelength_short = 4e-6 /
&domain length_x = 1e-3, length_y = 1e-3, intervals_x = 1024, intervals_y = 1024 /
"""


def begin(program, folder, *arguments):
    return subprocess.Popen([program, *arguments, "--quiet"], cwd=folder, stderr=subprocess.PIPE, text=True)


def end(running, number):
    """Sends a signal; status, what was said, and processor time from the signal to the end [s]."""
    with Path(f"/proc/{running.pid}/stat").open(encoding="ascii") as file:
        before = sum(map(int, file.read().rsplit(")", 1)[1].split()[11:13])) / os.sysconf("SC_CLK_TCK")
    running.send_signal(number)
    _, status, usage = os.wait4(running.pid, 0)
    running.returncode = os.waitstatus_to_exitcode(status)
    return running.returncode, running.stderr.read(), usage.ru_utime + usage.ru_stime - before


@pytest.mark.parametrize("number", SIGNALS)
def test_a_dry_case_ends_within_a_second(program, tmp_path, number):
    write(tmp_path, "dry.nml", DRY)
    write(tmp_path, "later.nml", STEADY)
    with begin(program, tmp_path, "dry.nml", "later.nml") as running:
        wait_for(tmp_path / "dry.h5.part", running)
        status, message, seconds = end(running, number)
    assert (status, message) == (4, "asperity: interrupted without a checkpoint, nothing is kept of dry.h5\n")
    assert seconds < 1.5
    assert names(tmp_path) == ["dry.nml", "later.nml"]


def test_a_reader_that_no_longer_reads_does_not_hold_up_the_end(program, tmp_path):
    """Standard error is a full pipe, and there is one thread, which the handler of a signal must not leave waiting for it."""
    write(tmp_path, "dry.nml", DRY)
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while os.write(writer, b"x"):
            pass
    os.set_blocking(writer, True)
    one_thread = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    with subprocess.Popen([program, "dry.nml", "--quiet"], cwd=tmp_path, stderr=writer, env=one_thread) as running:
        wait_for(tmp_path / "dry.h5.part", running)
        running.send_signal(signal.SIGTERM)
        try:
            assert running.wait(HANGING) == 4
        finally:
            running.kill()
            os.close(reader)
            os.close(writer)
    assert names(tmp_path) == ["dry.nml"]


def test_an_ignored_signal_stays_ignored(program, tmp_path):
    """nohup."""
    write(tmp_path, "case.nml", LONG.replace("end_time = 1000.0", "end_time = 2.0"))
    command = ["nohup", program, "case.nml", "--quiet"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as running:
        wait_for(tmp_path / "case.h5.part", running)
        assert end(running, signal.SIGHUP)[0] == 0


def test_later_cases_run_though_nobody_reads(program, tmp_path):
    cases = ("one.nml", "dry.nml", "two.nml")
    write(tmp_path, "one.nml", STEADY)
    write(tmp_path, "two.nml", STEADY)
    write(tmp_path, "dry.nml", DRY.replace("1024", "64").replace("4e-6", "5e-5"))
    with subprocess.Popen([program, *cases], cwd=tmp_path, stderr=subprocess.PIPE) as running:
        running.stderr.close()
    assert running.returncode == 0
    assert names(tmp_path) == sorted([*cases, "one.h5", "dry.h5", "two.h5"])


@pytest.mark.parametrize("closed", ["2>&-", ">&-", "<&-", "<&- >&- 2>&-"])
def test_closed_streams_do_not_end_up_in_a_result(program, tmp_path, closed):
    """A file gets the lowest free descriptor: without care messages would go into the first one that is opened."""
    write(tmp_path, "case.nml", STEADY)
    assert subprocess.run(f"'{program}' case.nml {closed}", shell=True, cwd=tmp_path, check=False).returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 1
    done = called([program, "case.nml", "--resume"], cwd=tmp_path)
    assert done.stderr == "case.nml: case.h5 is complete: nothing to do\n"


@pytest.mark.parametrize("option", ["--help", "--version", "--keys", "--keys-markdown", "--template ehl_line", "--check case.nml"])
@pytest.mark.parametrize("target", ["> /dev/full", ">&-"])
def test_lost_text_is_told(program, tmp_path, option, target):
    write(tmp_path, "case.nml", STEADY)
    command = f"'{program}' {option} {target}"
    done = ended(called(command, shell=True, cwd=tmp_path), 3)
    assert done.stderr == "cannot write to standard output: the disk is full, or nobody reads it\n"

"""Long runs survive: interrupted or killed at any moment, they go on to the same bits."""

import os
import random
import re
import signal
import subprocess
import time

import h5py
import numpy as np
import pytest
from asperity import read_part
from cases import HANGING, LONG, POINT, ROOT, STEADY, TRANSIENT, ended, members, seal, text, write
from kill_and_resume import busy, check_part, different, kill_often, killed_at_last, start, stored_times, undisturbed, wait_for

SIGNALS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU]


def flipped(content, place):
    place %= len(content)
    return content[:place] + bytes([content[place] ^ 4]) + content[place + 1 :]


def names(folder):
    return sorted(path.name for path in folder.iterdir())


@pytest.fixture
def interrupted(program, tmp_path):
    """A run of the case that was ended by SIGTERM after its first checkpoint.

    That run keeps a checkpoint after every step (the time between them is not part of the case), which makes it long: on a busy
    machine it could else be at its end before the signal comes.
    """

    def call(text=None):
        text = text or busy(0.05)
        write(tmp_path, "case.nml", re.sub("checkpoint_interval = [0-9.]+", "checkpoint_interval = 0.0", text))
        with start(program, tmp_path) as running:
            wait_for(tmp_path / "case.h5.ckpt", running)
            running.send_signal(signal.SIGTERM)
            message = running.stderr.read()
        write(tmp_path, "case.nml", text)
        return running.returncode, message

    return call


def test_killed_at_random_moments(program, tmp_path):
    kill_often(program, tmp_path, busy, random.Random(3), members(12, 200), resumed=8)


@pytest.mark.path
@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_ends_with_status_4_and_a_checkpoint(program, asperity, tmp_path, number):
    write(tmp_path, "case.nml", LONG)
    with killed_at_last(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running, times=20)
        running.send_signal(number)
        message = running.stderr.read()
    assert running.returncode == 4
    assert message.startswith("asperity: interrupted; --resume continues after step ")
    assert message.endswith(" with case.h5.ckpt\n")
    assert names(tmp_path) == ["case.h5.ckpt", "case.h5.part", "case.nml"]
    step = int(message.split("after step ")[1].split()[0])
    assert len(read_part(tmp_path / "case.h5.part")["time"]) == stored_times(tmp_path / "case.h5.part") == step + 1
    assert f"NOT CONVERGED: {step + 1} times to T " in ended(asperity("table", "case.h5.part")).stdout


METHODS = {
    "default": "",
    "backward_euler": "&time transient = .true., end_time = 6.0, time_step = 0.01, scheme = 'backward_euler' /\n",
    "fas": "&solver method = 'fas_block_jacobi' /\n",
    "gauss_seidel": "&solver smoother = 'gauss_seidel' /\n",
    "newton_dense": "&solver method = 'newton_dense' /\n",
    "inlet": "&domain intervals = 128 /\n",  # what lies in front of it carries load
    "statistics": "&output film_thresholds = 3e-7, 4e-7, checkpoint_interval = 0.05 /\n",
    "breakdown": "&solver film_floor = 390e-9, on_film_breakdown = 'continue' /\n",
    "mixed": "&surface_2 shape = 'feature', amplitude = 1e-7, wavelength = 1e-4, position = -2.1 /\n"
    "&asperities law = 'exponential', rms_height = 6e-7, contact_pressure = 1.2e9 /\n",  # bear a third of the load
    "stride": "&output profile_stride = 7, fields = 'pressure', 'shear_stress_1', checkpoint_interval = 0.05 /\n",
}


@pytest.mark.parametrize("name", METHODS)
def test_every_method_goes_on_to_the_same_bits(program, interrupted, asperity, tmp_path, name):
    text = busy(0.05).replace("end_time = 12.0", "end_time = 6.0")
    others = METHODS[name]
    if others:
        group = others.split()[0]
        text = "".join(line + "\n" for line in text.splitlines() if not line.startswith(group)) + others
    reference, _ = undisturbed(program, tmp_path, text)
    assert interrupted(text)[0] == 4
    assert asperity("case.nml", "--resume", "--quiet").returncode == 0
    assert different(reference, tmp_path / "case.h5") == []
    with h5py.File(reference) as one, h5py.File(tmp_path / "case.h5") as other:
        assert set(one["report"]) == set(other["report"])
        for path in ("cycles", "steps", "uncut_steps", "fft_pairs", "work_units", "method", "levels"):
            assert one["report"][path][()] == other["report"][path][()], path
        assert (one["report/residual_history"][()] == other["report/residual_history"][()]).all()


# Cases with a target, it, the error that it bounds, and what the program chooses.
CHOSEN = {
    "line": (
        busy(0.05, "&accuracy target = 2.5e-3 /\n").replace("intervals = 128", "").replace(", time_step = 0.01", ""),
        *(2.5e-3, "error_grid", ("domain/intervals", "time/time_step", "solver/tolerance")),
    ),
    "point": (
        POINT.replace("&domain intervals_x = 64 /", "&time transient = .true., end_time = 1.5 /")
        + "&surface_2 shape = 'feature', amplitude = 3e-8, wavelength = 2e-4, wavelength_y = 4e-4, position = -1.5 /\n"
        + "&output checkpoint_interval = 0.05 /\n&accuracy target = 0.1 /\n",
        *(0.1, "error_estimate", ("domain/intervals_x", "domain/intervals_y", "time/time_step", "output/profile_stride")),
    ),
}


@pytest.mark.parametrize("name", CHOSEN)
def test_a_chosen_resolution_goes_on_to_the_same_bits(program, interrupted, asperity, tmp_path, name):
    """Intervals, time step, tolerance and the errors of trial runs come back with the checkpoint, or are made again."""
    text, target, error, chosen = CHOSEN[name]
    reference, _ = undisturbed(program, tmp_path, text)
    assert interrupted(text)[0] == 4
    assert asperity("case.nml", "--resume", "--quiet").returncode == 0
    assert different(reference, tmp_path / "case.h5") == []
    with h5py.File(reference) as one, h5py.File(tmp_path / "case.h5") as other:
        h_min = one["summary/h_min"]
        assert h_min.attrs["error_grid"] > 0
        is_told = b"the target accuracy is not shown" in one["report/note"][()] if "report/note" in one else False
        assert is_told != (h_min.attrs[error] <= target * h_min[()])  # or there is no error while the start counts
        for group, key in (each.split("/") for each in chosen):
            assert len({file["input/effective"][group].attrs[key] for file in (one, other)}) == 1, key
        assert name == "point" or float(one["input/effective/solver"].attrs["tolerance"]) == 2.5e-4


def test_an_outlet_that_was_moved_out_stays_there(program, interrupted, asperity, tmp_path):
    """The domain of a starved contact, chosen anew after its start, comes back with the checkpoint."""
    text = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 226.4e9, speed_1 = 0.764, speed_2 = -0.218 /
&load load_per_length = 1559.5 /
&lubricant viscosity = 0.04, pressure_viscosity = 2.2e-8, roelands_p0 = 196e6 /
&domain intervals = 64 /
&surface_2 shape = 'feature', amplitude = 5.6e-10, wavelength = 1e-3 /
&time transient = .true., end_time = 10.0, time_step = 0.01 /
&supply film = 1e-6 /
&output checkpoint_interval = 1000.0 /
"""
    reference, _ = undisturbed(program, tmp_path, text)
    assert interrupted(text)[0] == 4
    with h5py.File(tmp_path / "case.h5.ckpt") as file:
        assert file["report/fit"][6] == 1  # outlet_moves, behind three reals of two words
    assert asperity("case.nml", "--resume", "--quiet").returncode == 0
    assert different(reference, tmp_path / "case.h5") == []


def test_resume_begins_without_a_checkpoint_and_leaves_a_complete_result_alone(run_case, asperity, tmp_path):
    assert run_case(TRANSIENT, "--resume").stderr.startswith("case.nml: no checkpoint case.h5.ckpt: starts at the beginning\n")
    assert names(tmp_path) == ["case.h5", "case.nml"]
    written = (tmp_path / "case.h5").stat().st_mtime_ns
    done = asperity("case.nml", "--resume")
    assert (done.returncode, done.stderr) == (0, "case.nml: case.h5 is complete: nothing to do\n")
    assert (tmp_path / "case.h5").stat().st_mtime_ns == written
    run_case(TRANSIENT.replace("1e5", "1.1e5"), "--resume")
    assert (tmp_path / "case.h5").stat().st_mtime_ns > written


UNCONVERGED = {
    "steady": STEADY + "&solver start = 'hertz', max_cycles = 1 /\n",
    "in time": TRANSIENT + "&solver tolerance = 1e-15, max_cycles = 3 /\n",
    "dry": (ROOT / "input" / "dry_sphere.nml").read_text() + "&solver max_cycles = 1 /\n",
}


@pytest.mark.parametrize("kind", UNCONVERGED)
def test_resume_says_that_a_complete_result_did_not_converge(solved_case, asperity, tmp_path, kind):
    """With its reason, as the run told it, and how to compute it again."""
    with solved_case(UNCONVERGED[kind], status=2) as file:
        reason = text(file.attrs["reason"])
    assert reason
    written = (tmp_path / "case.h5").stat().st_mtime_ns
    again = ended(asperity("case.nml", "--resume"), 2)
    assert again.stderr == f"asperity: case.nml: case.h5 is there, NOT CONVERGED: {reason}; without --resume it is computed again\n"
    quiet = asperity("case.nml", "--quiet", "--resume")
    assert (quiet.returncode, quiet.stderr) == (2, again.stderr)
    assert (tmp_path / "case.h5").stat().st_mtime_ns == written
    assert asperity("case.nml", "--quiet").returncode == 2
    assert (tmp_path / "case.h5").stat().st_mtime_ns > written


@pytest.mark.path
def test_checkpoint_of_another_case_is_refused(run_case, interrupted, tmp_path):
    text = busy(0.05)
    interrupted(text)
    kept = {path: (tmp_path / path).read_bytes() for path in ("case.h5.ckpt", "case.h5.part")}
    for old, new, reason in [
        ("load_per_length = 1e5", "load_per_length = 1.1e5", "&load load_per_length = 100000.0"),
        ("intervals = 128", "intervals = 256", "&domain intervals = 128, the namelist &domain intervals = 256"),
        ("end_time = 12.0", "end_time = 13.0", "&time end_time = 12.0"),
    ]:
        done = run_case(text.replace(old, new), "--resume", "--quiet", status=1)
        assert "cannot resume: case.h5.ckpt is of another case: it has " + reason in done.stderr
        assert {path: (tmp_path / path).read_bytes() for path in kept} == kept
    done = run_case(text.replace("Öl, smooth", "another title").replace("checkpoint_interval = 0.05", ""), "--resume")
    assert done.stderr.startswith("case.nml: continues after step ")
    assert "cycle 1" not in done.stderr


def test_damaged_checkpoint_and_one_of_another_version_are_refused(interrupted, asperity, tmp_path):
    interrupted()
    whole = (tmp_path / "case.h5.ckpt").read_bytes()
    cut = (b"", b"not HDF5", whole[: len(whole) // 2], whole[:-1])
    for content in (*cut, whole + b"\n", flipped(whole, 3000), flipped(whole, -40)):
        (tmp_path / "case.h5.ckpt").write_bytes(content)
        done = ended(asperity("case.nml", "--resume", "--quiet"), 1)
        assert "cannot resume: cannot read case.h5.ckpt" in done.stderr
        assert done.stderr.endswith("; delete it, and the run starts at the beginning\n")
    for name, value in (("version", np.bytes_("0.0.1")), ("git_commit", np.bytes_("0123456789ab")), ("checkpoint_format", 0)):
        (tmp_path / "case.h5.ckpt").write_bytes(whole)
        with h5py.File(tmp_path / "case.h5.ckpt", "r+") as file:
            file.attrs[name] = value
        seal(tmp_path / "case.h5.ckpt")
        done = ended(asperity("case.nml", "--resume", "--quiet"), 1)
        assert "cannot resume: case.h5.ckpt was written by another version, asperity " in done.stderr
    (tmp_path / "case.h5.ckpt").write_bytes(whole)
    with h5py.File(tmp_path / "case.h5.ckpt", "r+") as file:
        del file["march/mass"]
        file["march/mass"] = np.zeros(8)
    seal(tmp_path / "case.h5.ckpt")
    done = ended(asperity("case.nml", "--resume", "--quiet"), 1)
    assert "case.h5.ckpt (/march/mass): found 8 values, expected 516" in done.stderr
    (tmp_path / "case.h5.ckpt").unlink()
    assert "starts at the beginning" in asperity("case.nml", "--resume").stderr


def test_damaged_missing_or_wrong_part_is_refused(interrupted, asperity, tmp_path):
    """The times before the checkpoint go from NAME.part into the result: one bit of the last pressure makes another result."""

    def refusal():
        return ended(asperity("case.nml", "--resume", "--quiet"), 1).stderr

    interrupted()
    part = tmp_path / "case.h5.part"
    nodes = read_part(part)["pressure"].shape[1]
    whole = part.read_bytes()
    part.write_bytes(flipped(whole, -16 - 8 * nodes - 8 * nodes // 2))  # before the film and the checksum
    changed = part.read_bytes()
    assert "cannot resume: case.h5.part is damaged: its checksum is not that of the checkpoint; delete the" in refusal()
    assert part.read_bytes() == changed
    part.unlink()
    assert refusal() == "asperity: cannot resume: case.h5.part is missing\n"
    part.write_bytes(whole[:1000])
    assert "case.h5.part holds less than the checkpoint says" in refusal()
    part.write_bytes(whole)
    ended(asperity("case.nml", "--resume", "--quiet"))


def test_a_new_run_removes_the_old_checkpoint(program, interrupted, tmp_path):
    interrupted()
    write(tmp_path, "case.nml", LONG)
    with killed_at_last(program, tmp_path):
        deadline = time.monotonic() + HANGING
        while (tmp_path / "case.h5.ckpt").exists():
            assert time.monotonic() < deadline


def test_checkpoint_that_cannot_be_written_does_not_stop_the_run(asperity, tmp_path):
    write(tmp_path, "case.nml", busy(0.0))
    (tmp_path / "case.h5.ckpt.tmp").mkdir()
    assert "asperity: cannot write case.h5.ckpt.tmp" in ended(asperity("case.nml", "--quiet")).stderr
    assert (tmp_path / "case.h5").exists()


def test_an_interrupted_list_of_cases_goes_on(program, asperity, tmp_path):
    write(tmp_path, "first.nml", STEADY)
    write(tmp_path, "case.nml", busy(0.0))
    write(tmp_path, "last.nml", STEADY)
    files = ("first.nml", "case.nml", "last.nml")
    with start(program, tmp_path, "first.nml", "last.nml") as running:
        wait_for(tmp_path / "case.h5.ckpt", running)
        running.send_signal(signal.SIGTERM)
        assert running.wait() == 4
    assert not (tmp_path / "last.h5").exists()
    write(tmp_path, "case.nml", busy(0.05))
    assert "continues after step" in ended(asperity(*files, "--resume")).stderr
    assert names(tmp_path) == ["case.h5", "case.nml", "first.h5", "first.nml", "last.h5", "last.nml"]


def test_the_end_is_said_once_however_long_it_takes(program, tmp_path):
    """Before the first step. The timer (SIGALRM) that would end a hanging program fires after its last words."""
    write(tmp_path, "case.nml", STEADY.replace("intervals = 256", "intervals = 1048576"))
    for _ in range(3):
        with subprocess.Popen([program, "case.nml", "--quiet"], cwd=tmp_path, stderr=subprocess.PIPE) as running:
            wait_for(tmp_path / "case.h5.part", running)
            running.send_signal(signal.SIGTERM)
            message = os.read(running.stderr.fileno(), 1000)
            running.send_signal(signal.SIGALRM)
            message += running.stderr.read()
        assert running.returncode == 4
        assert message == b"asperity: interrupted without a checkpoint, nothing is kept of case.h5\n"
        assert names(tmp_path) == ["case.nml"]


def test_part_is_readable_while_the_run_writes(program, tmp_path):
    reference, _ = undisturbed(program, tmp_path, busy(1000.0).replace("end_time = 12.0", "end_time = 6.0"))
    # slow: a checkpoint after every step
    write(tmp_path, "case.nml", busy(0.0).replace("end_time = 12.0", "end_time = 6.0"))
    seen = []
    with start(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running)
        while running.poll() is None:
            try:
                seen.append(check_part(tmp_path / "case.h5.part", reference))
            except FileNotFoundError:
                assert not any(seen) or (tmp_path / "case.h5").exists() or not (tmp_path / "case.h5.part").exists()
            time.sleep(0.01)
    assert len(set(seen)) > 5
    assert seen == sorted(seen)

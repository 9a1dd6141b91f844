"""Kills runs at random moments, goes on with --resume, and compares the result with that of a run that nobody disturbed.

After every kill NAME.h5.part must be readable, and hold what the undisturbed run has at the same times.
"""

import contextlib
import pathlib
import signal
import subprocess
import sys
import time

import h5py
import numpy as np
from cases import HANGING, STEADY, contents, same_bits, write

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "python"))
from asperity import AsperityError, read_part
from asperity.running import layout

# A second or less: waviness on both surfaces, so that no step is like another.
BUSY = (
    STEADY.replace("intervals = 256", "intervals = 128")
    + """&surface_1 shape = 'sinusoid', amplitude = 3e-8, wavelength = 6e-5, position = 0.1 /
&surface_2 shape = 'sinusoid', amplitude = 3e-8, wavelength = 4e-5, position = -0.2 /
&time transient = .true., end_time = 12.0, time_step = 0.01 /
"""
)
RESULT = ("solution", "transient", "summary", "statistics", "momentum")
PROFILES = ("profile_time", "pressure", "film_thickness", "shear_stress_1", "shear_stress_mean", "shear_stress_2")


def busy(interval, others=""):
    """A busy case with a checkpoint every `interval` seconds."""
    return BUSY + f"&output checkpoint_interval = {interval} /\n" + others


def different(first, second):
    """Paths in which two results differ that must be the same."""
    old, new = contents(first), contents(second)
    keys = [path for path in old.keys() | new.keys() if path.split("/")[0].split("@")[0] in RESULT]
    return [path for path in keys if path not in old or path not in new or not same_bits(old[path], new[path])]


def check_part(part, reference):
    """The series in `part` begin like those of the undisturbed run; returns how many times there are."""
    try:
        found = read_part(part)
    except AsperityError:
        return 0
    times = len(found["time"])
    with h5py.File(reference) as whole:
        profiles = np.count_nonzero(whole["transient/profile_time"][()] <= max(found["time"], default=-np.inf))
        for name, series in whole["transient"].items():
            if name == "x":  # a link to /solution/x, which a part does not have
                continue
            count = profiles if name in PROFILES else times
            assert len(found[name]) == count, name
            assert same_bits(found[name], series[:count]), name
    return times


def stored_times(part):
    """Number of times in a file being written, by its size, which costs the run no time; 0 before there are any."""
    try:
        with part.open("rb") as file:
            nodes, stride, names, profiles = layout(part, file.readline(10000))
            size = -file.tell() + file.seek(0, 2)
    except (OSError, AsperityError):
        return 0
    numbers, rows = 8 * len(names) + 16, 8 * len(profiles) * nodes
    blocks, rest = divmod(size, stride * numbers + rows)
    return blocks * stride + max(rest - rows, 0) // numbers


def wait_for(path, running, times=0, size=0, seconds=HANGING):
    """Waits until a run has made a file, of so many bytes or with so many stored times."""
    deadline = time.monotonic() + seconds
    while stored_times(path) < times if times else not path.exists() or path.stat().st_size < size:
        assert running.poll() is None, f"{path} is not there yet, and the run has ended"
        assert time.monotonic() < deadline, f"{path} did not appear or grow"
        time.sleep(0.002)


def start(program, folder, *options, name="case.nml"):
    return subprocess.Popen([program, name, "--quiet", *options], cwd=folder, stderr=subprocess.PIPE, text=True)


@contextlib.contextmanager
def killed_at_last(program, folder, *options):
    """A run that is killed at the end of the block, also where the block fails; one that has ended is left alone."""
    with start(program, folder, *options) as running:
        try:
            yield running
        finally:
            running.kill()


def undisturbed(program, folder, text, *options):
    """Runs the case without interruption; its result and how long it took."""
    write(folder, "case.nml", text)
    begin = time.monotonic()
    with start(program, folder, *options) as running:
        assert running.wait(HANGING) == 0, running.stderr.read()
    (folder / "case.h5").rename(folder / "reference.h5")
    return folder / "reference.h5", time.monotonic() - begin


def kill_until_complete(program, folder, reference, source, longest):
    """Starts, kills and resumes until the run is complete; returns the number of kills and of resumed checkpoints.

    Each run gets up to `longest` seconds, and more where that was too short for a new checkpoint: the machine may be busier
    than when the undisturbed run was timed, so busy that no run would ever get beyond its start. At last one more run clears up
    after a kill in the last moment, between the result and the removal of what it came from.
    """
    kills, resumed = 0, 0
    part, checkpoint = folder / "case.h5.part", folder / "case.h5.ckpt"
    while not (folder / "case.h5").exists():
        had_checkpoint = checkpoint.exists()
        old_checkpoint = checkpoint.read_bytes() if had_checkpoint else b""
        with start(program, folder, "--resume") as running:
            try:
                status = running.wait(source.uniform(0.0, longest))
            except subprocess.TimeoutExpired:
                running.send_signal(signal.SIGKILL)
                status = running.wait()
            message = running.stderr.read()
        assert status in (0, -signal.SIGKILL), message
        kills += status != 0
        resumed += had_checkpoint
        if (checkpoint.read_bytes() if checkpoint.exists() else b"") == old_checkpoint:
            longest *= 1.2
        assert checkpoint.exists() >= (had_checkpoint and status != 0 and not (folder / "case.h5").exists())
        if part.exists() and part.stat().st_size > 0:
            assert check_part(part, reference) > 0 or not checkpoint.exists(), "a part that cannot be read beside a checkpoint"
    with start(program, folder, "--resume") as running:
        assert running.wait(HANGING) == 0, running.stderr.read()
    return kills, resumed


def kill_often(program, folder, text, source, kills, resumed, check=None):
    """Kills a case, `text(seconds between checkpoints)`, as often as that or more: each time the bits of the undisturbed run."""
    reference, seconds = undisturbed(program, folder, text(1000.0))
    while kills > 0 or resumed > 0:
        # the time between checkpoints is not part of the case
        write(folder, "case.nml", text(source.choice([0.0, 0.005, 0.01, 0.03])))
        new_kills, new_resumed = kill_until_complete(program, folder, reference, source, source.choice([0.4, 0.6, 1.0]) * seconds)
        kills, resumed = kills - new_kills, resumed - new_resumed
        assert different(reference, folder / "case.h5") == []
        if check:
            check(reference)
        assert sorted(path.name for path in folder.iterdir()) == ["case.h5", "case.nml", "reference.h5"]
        (folder / "case.h5").unlink()

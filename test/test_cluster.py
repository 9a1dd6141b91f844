"""The job scripts of batch/ on a real Slurm that runs on this machine alone (tools/slurm_local.sh), beside a run without it."""

import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import time

import cases
import h5py
import numpy as np
import pytest
from cases import ROOT, called, ended, swept

LOCAL = ROOT / "tools" / "slurm_local.sh"
COUNT = 24
BAD, UNCONVERGED, GUARDED, KILLED = 5, 2, 9, 18  # numbers of cases


def sweep_text():
    """24 short transients; two of them take some seconds, of one the film is below its floor."""
    long = [160.0 if number in (GUARDED, KILLED) else 1.0 for number in range(1, COUNT + 1)]
    floors = [1e-6 if number == UNCONVERGED else 1e-10 for number in range(1, COUNT + 1)]
    speeds = [1.0 + 0.01 * number for number in range(COUNT)]
    return f"""base = "base.nml"
together = ["bodies.speed_2", "time.end_time", "solver.film_floor"]
[vary]
bodies.speed_2 = {speeds}
time.end_time = {long}
solver.film_floor = {floors}
[set]
domain.intervals = 128
time.time_step = 0.02
accuracy.error_bars = false
output.profile_stride = 50
solver.method = "fas_block_jacobi"
"""


@pytest.fixture(scope="module", name="slurm")
def _slurm():
    """The environment of a private Slurm."""
    needed, path = ("munged", "slurmctld", "slurmd", "sbatch"), f"{os.environ['PATH']}:/usr/sbin"
    missing = [name for name in needed if not shutil.which(name, path=path)]
    if missing:
        pytest.skip(f"not applicable: Slurm is not installed ({', '.join(missing)}); tools/slurm_local.sh install")
    folder = pathlib.Path(tempfile.mkdtemp(prefix="slurm"))  # short: the name of a socket is
    with contextlib.ExitStack() as stack:
        ports = [stack.enter_context(socket.socket()) for _ in range(8)]
        for port in ports:
            port.bind(("127.0.0.1", 0))
        numbers = sorted(port.getsockname()[1] for port in ports)
    first = next((n for n in numbers if n + 1 not in numbers), numbers[0])
    environment = {**os.environ, "SLURM_LOCAL_DIR": str(folder), "SLURM_LOCAL_PORT": str(first)}
    started = called([LOCAL, "start"], env=environment)
    try:
        if started.returncode != 0:
            pytest.fail(f"Slurm does not start: {started.stderr}")
        yield {**environment, "SLURM_CONF": str(folder / "slurm.conf"), "PATH": f"{os.environ['PATH']}:/usr/sbin:/sbin"}
    finally:
        subprocess.run([LOCAL, "stop", "--purge"], env=environment, capture_output=True, timeout=cases.HANGING, check=False)


def state(job, environment):
    """States of the tasks of a job, by their names."""
    done = ended(called(["scontrol", "-o", "show", "job", job], env=environment))
    return {word.removeprefix("JobState=") for word in done.stdout.split() if word.startswith("JobState=")}


def send(signal, whom, task, environment):
    """Sends a signal to a task; scancel itself may then wait for ever for one that is queued again."""
    command = ["scancel", f"--signal={signal}", whom, task]
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(command, env=environment, capture_output=True, timeout=1, check=False)


def start_now(task, environment):
    """A task that is queued again waits for two minutes, unless somebody says otherwise.

    Slurm refuses a start in the same second of the clock in which it has ended the task, and then the task fails.
    """
    until(lambda: state(task, environment) == {"PENDING"}, "the task to be queued again")
    time.sleep(1.1)
    command = ["scontrol", "update", f"JobId={task}", "StartTime=now"]
    until(lambda: called(command, env=environment).returncode == 0, "its start")


def until(condition, words, seconds=cases.HANGING):
    """Waits until `condition()` is true, and returns its value."""
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, f"waited in vain for {words}"
        time.sleep(0.1)
    return value


def submit(folder, environment, program, *options):
    """Array and gather job of batch/submit.sh."""
    command = [ROOT / "batch" / "submit.sh", folder, "--per-task", "4", "--mem-per-cpu=100M", *options]
    done = ended(called(command, env={**environment, "ASPERITY": str(program)}))
    words = done.stdout.replace(":", "").replace(";", "").split()
    return words[1], words[words.index("gather") + 1]


def gathered(folder):
    """Columns of the table; what differs from run to run, the seconds, is left out."""
    with h5py.File(folder / "gathered.h5") as file:
        return {name: np.asarray(column[()]) for name, column in file.items() if "seconds" not in name}


@pytest.fixture
def folder(tmp_path, program):
    """The sweep, with one case of bad input."""
    found = swept(tmp_path, program, sweep_text(), cases.TRANSIENT)
    bad = found / "cases" / f"case_{BAD:04d}.nml"
    bad.write_text(bad.read_text(encoding="utf-8").replace("viscosity =", "viscosty ="), encoding="utf-8")
    return found


def test_an_array_that_is_killed_and_queued_again_gives_the_table_of_a_local_run(batch, slurm, folder, program, tmp_path):
    local = shutil.copytree(folder, tmp_path / "local")
    batch("run.py", "local", "--jobs", "2", status=3)
    batch("gather.py", "local")

    array, gather = submit(folder, slurm, program, "--at-once", "2")
    results = folder / "cases"
    # near the time limit of a task Slurm sends USR1 to its script: here by hand, while its long case runs
    until((results / f"case_{GUARDED:04d}.h5.part").exists, "the case that is to be queued again")
    time.sleep(0.5)
    task = (GUARDED - 1) // 4 + 1
    send("USR1", "--batch", f"{array}_{task}", slurm)
    until((results / f"case_{GUARDED:04d}.h5.ckpt").exists, "the checkpoint")
    # another task is killed without a warning, as by a node that fails
    until((results / f"case_{KILLED:04d}.h5.part").exists, "the case that is to be killed")
    send("KILL", "--full", f"{array}_{(KILLED - 1) // 4 + 1}", slurm)
    start_now(f"{array}_{task}", slurm)
    over = {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL"}
    until(lambda: state(gather, slurm) <= over, "the gather job")
    assert state(gather, slurm) == {"COMPLETED"}  # though tasks have failed
    log = (folder / "log" / f"task_{task}.log").read_text(encoding="utf-8")
    assert log.count(f"task {task}, job") == 2
    assert f"task {task}: near the time limit, queued again" in log
    # a task with a case that did not converge is no failed task; one with bad input, or killed, is
    tasks = [(number - 1) // 4 + 1 for number in (BAD, UNCONVERGED, GUARDED, KILLED)]
    states = [state(f"{array}_{number}", slurm) for number in tasks]
    assert states[:3] == [{"FAILED"}, {"COMPLETED"}, {"COMPLETED"}]
    assert states[3] in ({"CANCELLED"}, {"FAILED"})
    first = gathered(folder)
    assert first["status"][KILLED - 1] == b"not run"
    assert first["status"][GUARDED - 1] == b"done"

    stamps = {path.name: path.stat().st_mtime_ns for path in results.glob("*.h5")}
    _, gather = submit(folder, slurm, program)
    until(lambda: state(gather, slurm) <= over, "the second gather job")
    one, other = gathered(folder), gathered(local)
    assert one.keys() == other.keys()
    assert [name for name in one if not cases.same_bits(one[name], other[name]) and one[name].dtype != object] == []
    assert [name for name in one if one[name].dtype == object and list(one[name]) != list(other[name])] == []
    assert [number for number in range(1, COUNT + 1) if one["status"][number - 1] == b"failed"] == [BAD]
    assert [number for number in range(1, COUNT + 1) if one["status"][number - 1] == b"not converged"] == [UNCONVERGED]
    # nothing was run twice
    assert all((results / name).stat().st_mtime_ns == stamp for name, stamp in stamps.items())


def test_what_submit_refuses(tmp_path, folder, slurm):
    def refused(*arguments):
        command = [ROOT / "batch" / "submit.sh", *arguments]
        done = ended(called(command, env=slurm), 1)
        return done.stdout + done.stderr

    assert "batch/submit.sh FOLDER" in refused()
    assert "has no index.csv" in refused(tmp_path)
    assert "found --per-task 0, expected a number above 0" in refused(folder, "--per-task", "0")
    assert "found --at-once without a value" in refused(folder, "--at-once")
    with (folder / "index.csv").open("a", encoding="utf-8") as file:
        file.write("case_0000,1,1,1\n" * 3000)
    assert "found 3024 tasks, expected fewer than 1001: give at least --per-task 4" in refused(folder, "--per-task", "1")


def test_without_slurm_submit_says_so(tmp_path):
    (tmp_path / "index.csv").write_text("case,x\ncase_0001,1\n", encoding="utf-8")
    tools = tmp_path / "bin"
    tools.mkdir()
    for name in ("bash", "dirname", "env"):
        (tools / name).symlink_to(shutil.which(name))
    done = ended(called([shutil.which("bash"), ROOT / "batch" / "submit.sh", tmp_path], env={"PATH": str(tools)}), 1)
    assert "there is no sbatch here: run the cases with batch/run.py" in done.stderr

"""Limits of memory, environment variables, signals and long work: the same answer, or one message; a line every 5 s."""

import itertools
import os
import random
import re
import resource
import signal
import subprocess
import time
from pathlib import Path

import h5py
import numpy as np
import valid_cases
from cases import LONG, STEADY, TRANSIENT
from height_files import AREA, MOES, SIDE
from run import attack, call
from test_resume import SIGNALS
from test_signals import AREA as LONG_AREA
from test_signals import FIELDS, HEIGHTS, ONE_THREAD, processor_seconds, write_heights

MEGABYTE = 2**20
LIMITS = {"address space": resource.RLIMIT_AS, "data": resource.RLIMIT_DATA}
# The loader and the libraries, before the program begins.
BEFORE = ["error while loading shared libraries", "blas_thread_init: pthread_create failed"]
LINE = AREA.replace("dry_area", "dry_line").replace("intervals_x = {x}, intervals_y = {y}", "intervals = {x}").replace("{hard}", "")
OIL = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 2e11, speed_1 = 0.5, speed_2 = 1.5 /
&load load_per_length = {load} /
&lubricant viscosity = 0.04, pressure_viscosity = 2e-8, roelands_p0 = 1.96e8 /
&domain {intervals} /
&solver method = '{method}' /
&accuracy {accuracy} /
{more}
"""
MOVING = """&time transient = .true., end_time = {end} /
&surface_1 shape = 'feature', amplitude = 1e-8, wavelength = 1e-4 /
"""


def dry(source: random.Random, folder: Path) -> str:
    """A line or an area; heights from a formula, synthetic or from a file that is larger or smaller than the grid."""
    is_line = source.random() < 0.4
    most = 2e5 if is_line else 1500
    x, y = (int(valid_cases.logarithmic(source, 16, most)) for _ in range(2))
    shape = source.choice(["file", "synthetic", "sinusoid"])
    surface = {
        "synthetic": "shape = 'synthetic', rms_height = 1e-7",
        "sinusoid": "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3",
        "file": "shape = 'file', file = 'heights.h5', dataset = 'z'",
    }[shape]
    lengths = "" if shape == "file" else ("length = 1e-3," if is_line else SIDE)
    if shape == "file":
        nodes = [int(valid_cases.logarithmic(source, 16, most)) for _ in range(1 if is_line else 2)]
        with h5py.File(folder / "heights.h5", "w") as file:
            data = file.create_dataset("z", data=np.random.default_rng(1).standard_normal(nodes) * 1e-8)
            data.attrs["spacing"] = 1e-6
    values = {"surface": surface, "lengths": lengths, "x": x, "y": y, "load": source.choice([1e6, 1e8])}
    values["periodic"] = source.choice([".true.", ".false."])
    values["hard"] = f", hardness = {source.choice([2e9, 1e15])}"
    return (LINE if is_line else AREA).format(**values)


def oil(source: random.Random) -> str:
    """A steady or moving contact on a grid of the user, of the program, or of a wanted accuracy."""
    method = source.choice(["auto", "auto", "newton_dense", "newton_krylov", "fas_block_jacobi"])
    most = 3000 if method == "newton_dense" else 2e5
    intervals = 2 ** int(np.log2(valid_cases.logarithmic(source, 64, most)))
    is_moving = source.random() < 0.4
    accuracy = source.choice(["error_bars = .true.", "error_bars = .false.", "target = 1e-4"])
    if is_moving:
        intervals = min(intervals, 8192)
        accuracy = accuracy.replace("1e-4", "0.05")
    return OIL.format(
        load=valid_cases.logarithmic(source, 2e4, 3e5),
        intervals="" if "target" in accuracy or source.random() < 0.2 else f"intervals = {intervals}",
        method=method,
        accuracy=accuracy,
        more=MOVING.format(end=100 / max(intervals, 1000)) if is_moving else "",
    )


@attack("small address space or data (60 to 400 MB), sizes, threads", 150)
def address_space(program: Path, source: random.Random, folder: Path) -> str | None:
    draw = source.choice([lambda: dry(source, folder), lambda: oil(source), lambda: valid_cases.lubricated(source, folder)])
    valid_cases.write_valid(program, folder, draw)
    kinds = source.choice([["address space"], ["address space"], ["data"], ["address space", "data"]])
    limits = {LIMITS[kind]: int(source.uniform(60, 400) * MEGABYTE) for kind in kinds}
    arguments = source.choice([[], [], ["--threads", str(source.choice([2, 3, 8, 500]))]])
    env = dict(os.environ)
    env.pop("OPENBLAS_NUM_THREADS", None)
    if source.random() < 0.2:
        env["OPENBLAS_NUM_THREADS"] = source.choice(["1", "4"])
    run = call(program, folder, "case.nml", *arguments, env=env, limits={resource.RLIMIT_CPU: valid_cases.LIMIT} | limits)
    if run.status in (127, 130, -2) and any(words in run.err for words in BEFORE):
        return None
    broken = valid_cases.trouble(run, folder)
    if broken or run.status in (0, 2):
        return broken
    is_told = "found" in run.err and "expected" in run.err
    return None if run.status == 1 and is_told else f"status {run.status}: {run.err.strip()[-300:]}"


VARIABLES = {
    "GFORTRAN_OPTIONAL_PLUS": ["1", "y", "0"],
    "GFORTRAN_UNBUFFERED_ALL": ["1"],
    "GFORTRAN_UNBUFFERED_PRECONNECTED": ["1"],
    "GFORTRAN_SHOW_LOCUS": ["0"],
    "GFORTRAN_DEFAULT_RECL": ["1", "80", "-5", "x"],
    "GFORTRAN_LIST_SEPARATOR": [";", "   ", "x"],
    "GFORTRAN_CONVERT_UNIT": ["big_endian", "swap", "native;swap:1-99", "rubbish"],
    "GFORTRAN_ERROR_BACKTRACE": ["0", "1"],
    "GFORTRAN_FORMATTED_BUFFER_SIZE": ["1", "0", "1000000"],
    "OMP_NUM_THREADS": ["0", "1", "7", "-1", "x", "100"],
    "OMP_STACKSIZE": ["1M", "rubbish", "100M"],
    "OPENBLAS_NUM_THREADS": ["0", "5", "x"],
    "LC_ALL": ["C", "de_DE.UTF-8", "tr_TR", "rubbish"],
    "LANG": ["de_DE.UTF-8", ""],
    "TZ": ["rubbish"],
    "TMPDIR": ["/nonexistent", ""],
    "HOME": ["", "/nonexistent"],
    "PATH": [""],
    "HDF5_USE_FILE_LOCKING": ["TRUE", "BEST_EFFORT", "x"],
    "HDF5_DISABLE_VERSION_CHECK": ["1", "2"],
    "HDF5_PLUGIN_PATH": ["/nonexistent", "::"],
    "HDF5_DEBUG": ["all"],
    "MALLOC_ARENA_MAX": ["1"],
    "TERM": ["", "dumb", "xterm"],
    "COLUMNS": ["1", "0", "-1", "x", "99999999999"],
}
STACKS = [48, 64, 100, 128, 200, 300, 500, 900, 1024, 8192]
ROUGH = {"hard": "", "load": "1e7, 2e7", "surface": "shape = 'synthetic', rms_height = 1e-7", "lengths": SIDE}
USUAL = [
    AREA.format(**ROUGH, x=32, y=32, periodic=".true."),
    MOES.format(m=10.0, intervals="intervals = 256", method="auto").replace("&accuracy error_bars = .false. /\n", ""),
]
ANSWERS: dict[tuple, np.ndarray] = {}


def pressure(program: Path, folder: Path, text: str) -> np.ndarray:
    if (program, text) not in ANSWERS:
        (folder / "usual.nml").write_text(text, encoding="utf-8")
        call(program, folder, "usual.nml", "--quiet")
        with h5py.File(folder / "usual.h5") as file:
            ANSWERS[program, text] = file["solution/pressure"][()]
    return ANSWERS[program, text]


@attack("environment variables of the run-time libraries, small stacks", 300)
def environment(program: Path, source: random.Random, folder: Path) -> str | None:
    text = source.choice(USUAL)
    usual = pressure(program, folder, text)
    names = source.sample(sorted(VARIABLES), source.randint(1, 4))
    env = dict(os.environ) | {name: source.choice(VARIABLES[name]) for name in names}
    limits = {resource.RLIMIT_STACK: source.choice(STACKS) * 1024} if source.random() < 0.3 else {}
    (folder / "case.nml").write_text(text, encoding="utf-8")
    run = call(program, folder, "case.nml", env=env, limits=limits)
    if run.status == 1 and limits and "ulimit -s" in run.err:
        return run.trouble()
    if run.trouble(0):
        return run.trouble(0)
    if "***" in run.err + run.out or not run.err + run.out:
        return f"broken report: {run.err.strip()[-200:]}"
    with h5py.File(folder / "case.h5") as file:
        return None if np.array_equal(file["solution/pressure"][()], usual) else "another answer"


PROBLEMS = {
    "steady": STEADY.replace("256", "16384"),
    "dense": STEADY.replace("256", "4096") + "&solver method = 'newton_dense' /\n",
    "transient": TRANSIENT.replace("time_step = 0.05", "time_step = 0.005"),
    "long": LONG,
    "area": LONG_AREA.replace("2048", "512").replace("short = 4e-6", "short = 8e-6"),
    "one load": LONG_AREA.replace("1e7, 1e8, 3e8, 1e9, 3e9", "3e9"),
    "target": STEADY.replace(", intervals = 256", "") + "&accuracy target = 1e-6 /\n",
    "time target": TRANSIENT.replace(", intervals = 256", "").replace(", time_step = 0.05", "") + "&accuracy target = 3e-3 /\n",
    "fields": FIELDS,
    "heights": HEIGHTS,
}
# Wall time that a busy machine gets; processor time after which a signal comes at the latest, and which the program may then take.
SECONDS, LATEST, RESPONSE = 900, 8.0, 1.0


@attack("signals (TERM, INT, HUP, USR1, USR2, XCPU) at random moments, closed standard error", 100, quick=2)
def signals(program: Path, source: random.Random, folder: Path) -> str | None:
    chosen = [source.choice(list(PROBLEMS)) for _ in range(2)]
    for number, name in enumerate(chosen):
        (folder / f"case{number}.nml").write_text(PROBLEMS[name], encoding="utf-8")
    if "heights" in chosen:
        write_heights(folder, 1_000_000)
    number = source.choice(SIGNALS)
    is_heard = source.random() < 0.7
    command = [program, "case0.nml", "case1.nml", "--quiet"]
    # a shell may have had SIGINT ignored for us, and the program would inherit that
    options = {"cwd": folder, "stderr": subprocess.PIPE, "env": ONE_THREAD}
    with subprocess.Popen(command, **options, preexec_fn=lambda: signal.signal(number, signal.SIG_DFL)) as running:  # noqa: PLW1509
        if not is_heard:
            running.stderr.close()
        wait_for_moment(running, source.uniform(0.1, LATEST))
        asked = processor_seconds(running.pid)
        os.kill(running.pid, number)
        message, answered = "", None
        for line in running.stderr if is_heard else []:
            answered = answered or processor_seconds(running.pid)
            message += line.decode()
        _, status, usage = os.wait4(running.pid, 0)
        running.returncode = status = os.waitstatus_to_exitcode(status)
    seconds = (answered or usage.ru_utime + usage.ru_stime) - asked
    if seconds > RESPONSE and is_heard:
        return f"{chosen}: signal {number}: seen after {seconds:.2f} s of processor time"
    return look_at(folder, chosen, number, status, message if is_heard else None)


def wait_for_moment(running: subprocess.Popen, moment: float) -> None:
    """Until the program has taken so much processor time, or has ended. (In its first milliseconds it does not listen yet.)"""
    end, state = time.monotonic() + SECONDS, ""
    while processor_seconds(running.pid) < moment and state != "Z" and time.monotonic() < end:
        time.sleep(0.01)
        state = Path(f"/proc/{running.pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[0]


def look_at(folder: Path, chosen: list[str], number: int, status: int, message: str | None) -> str | None:
    names = sorted(path.name for path in folder.iterdir() if path.suffix not in {".nml", ".csv"})
    if status == 0:
        return None if names == ["case0.h5", "case1.h5"] else f"{chosen}: status 0 with {names}"
    if status != 4:
        return f"{chosen}: signal {number}: status {status}: {message}"
    if message is not None and "interrupted" not in message:
        return f"{chosen}: signal {number}: not a word: {message}"
    with_checkpoint = {name.removesuffix(".ckpt") for name in names if name.endswith(".ckpt")}
    allowed = {"case0.h5", "case1.h5"} | {f"{name}{ending}" for name in with_checkpoint for ending in (".ckpt", ".part")}
    if not set(names) <= allowed:
        return f"{chosen}: signal {number}: left over: {names}"
    for name in set(names) & {"case0.h5", "case1.h5"}:
        with h5py.File(folder / name) as file:
            if "converged" not in file.attrs:
                return f"{chosen}: half a result"
    return None


# Longest silence and longest run [s of processor time]; the quick form is test_signals.py.
SILENCE, LIMIT = 5.0, 40


@attack("silence of long runs: dense systems, areas, targets, reading, writing, coarse runs", 30, quick=0)
def silences(program: Path, source: random.Random, folder: Path) -> str | None:
    kind, factor, threads = source.choice(list(PROBLEMS)), source.choice([1, 2]), source.choice(["1", "2"])
    text = re.sub(r"(intervals\w* = )(\d+)", lambda found: f"{found[1]}{factor * int(found[2])}", PROBLEMS[kind])
    (folder / "case.nml").write_text(text, encoding="utf-8")
    if kind == "heights":
        write_heights(folder, source.choice([300_000, 3_000_000, 8_000_000]))
    limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT + 2))  # noqa: E731
    command, heard = [program, "case.nml", "--threads", threads], [("the start", 0.0)]
    pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.DEVNULL}
    with subprocess.Popen(command, cwd=folder, env=ONE_THREAD, preexec_fn=limit, **pipes) as running:  # noqa: PLW1509  one thread
        for line in running.stderr:
            heard.append((line.decode("utf-8", "replace").rstrip("\n"), processor_seconds(running.pid)))
        _, status, usage = os.wait4(running.pid, 0)
        running.returncode = status = os.waitstatus_to_exitcode(status)
    heard.append(("the end", usage.ru_utime + usage.ru_stime))
    silence, line = max((after[1] - before[1], before[0]) for before, after in itertools.pairwise(heard))
    if silence >= SILENCE:
        return f"{kind}: {silence:.1f} s of silence behind {line!r}"
    return None if status in {0, 2, 4} else f"{kind}: status {status}: {heard[1][0]}"

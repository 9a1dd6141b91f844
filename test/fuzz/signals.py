"""Signals at random moments of random kinds of work: a word or the end within a second of processor time, status 4 and no left-over
files; or a complete result."""

import os
import random
import signal
import subprocess
import time
from pathlib import Path

import h5py
from cases import LONG, STEADY, TRANSIENT
from silence import ONE_THREAD, processor_seconds
from test_silence import AREA, FIELDS, HEIGHTS, write_heights

TITLE = "signals (TERM, INT, HUP, USR1, USR2, XCPU) at random moments, closed standard error"
CASES = 100
QUICK = 2
SIGNALS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU]
PROBLEMS = {
    "steady": STEADY.replace("256", "16384"),
    "dense": STEADY.replace("256", "4096") + "&solver method = 'newton_dense' /\n",
    "transient": TRANSIENT.replace("time_step = 0.05", "time_step = 0.005"),
    "long": LONG,
    "area": AREA.replace("2048", "512").replace("short = 4e-6", "short = 8e-6"),
    "one load": AREA.replace("1e7, 1e8, 3e8, 1e9, 3e9", "3e9"),
    "target": STEADY.replace(", intervals = 256", "") + "&accuracy target = 1e-6 /\n",
    "time target": TRANSIENT.replace(", intervals = 256", "").replace(", time_step = 0.05", "") + "&accuracy target = 3e-3 /\n",
    "fields": FIELDS,
    "heights": HEIGHTS,
}
# Wall time that a busy machine gets; processor time after which a signal comes at the latest, and which the program may then take.
SECONDS, LATEST, RESPONSE = 900, 8.0, 1.0


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    chosen = [source.choice(list(PROBLEMS)) for _ in range(2)]
    for number, name in enumerate(chosen):
        (folder / f"case{number}.nml").write_text(PROBLEMS[name], encoding="utf-8")
    if "heights" in chosen:
        write_heights(folder, 1_000_000)
    number = source.choice(SIGNALS)
    is_heard = source.random() < 0.7
    command = [program, "case0.nml", "case1.nml", "--quiet"]
    # a shell may have had SIGINT ignored for us, and the program would inherit that
    with subprocess.Popen(
        command,
        cwd=folder,
        stderr=subprocess.PIPE,
        env=ONE_THREAD,
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),  # noqa: PLW1509
    ) as running:
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
    end = time.monotonic() + SECONDS
    while processor_seconds(running.pid) < moment and not is_over(running.pid) and time.monotonic() < end:
        time.sleep(0.01)


def is_over(pid: int) -> bool:
    """Whether a process has ended and nobody has asked for its status yet."""
    return Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()[0] == "Z"


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

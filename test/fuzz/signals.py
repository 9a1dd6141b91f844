"""Signals at random moments of random problems: status 4 in time, a word, no left-over files; or a complete result."""

from __future__ import annotations

import random
import signal
import subprocess
import time
from pathlib import Path

import h5py
from cases import LONG, STEADY, TRANSIENT

TITLE = "signals (TERM, INT, HUP, USR1, USR2, XCPU) at random moments, closed standard error"
CASES = 100
QUICK = 4
SIGNALS = [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2, signal.SIGXCPU]
AREA = """&case problem = 'dry_area' /
&bodies youngs_modulus_1 = 206e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 1e7, 3e7, 1e8, 3e8 /
&surface_1 shape = 'synthetic', seed = 3, hurst = 0.8, rms_height = 1e-6, wavelength_long = 1e-3, wavelength_short = 4e-6 /
&domain length_x = 1e-3, length_y = 1e-3, intervals_x = 512, intervals_y = 512 /
"""
PROBLEMS = {
    "steady": STEADY.replace("256", "16384"),
    "dense": STEADY.replace("256", "4096") + "&solver method = 'newton_dense' /\n",
    "transient": TRANSIENT.replace("time_step = 0.05", "time_step = 0.005"),
    "long": LONG,
    "area": AREA,
}
# Wall time that a busy machine gets; the program itself needs one second.
SECONDS = 60


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    """Two cases in one call, one signal."""
    chosen = [source.choice(list(PROBLEMS)) for _ in range(2)]
    for number, name in enumerate(chosen):
        (folder / f"case{number}.nml").write_text(PROBLEMS[name], encoding="utf-8")
    number = source.choice(SIGNALS)
    is_heard = source.random() < 0.7
    command = [program, "case0.nml", "case1.nml", "--quiet"]
    # a shell may have had SIGINT ignored for us, and the program would inherit that
    with subprocess.Popen(
        command,
        cwd=folder,
        stderr=subprocess.PIPE,
        preexec_fn=lambda: signal.signal(number, signal.SIG_DFL),  # noqa: PLW1509
    ) as running:
        if not is_heard:
            running.stderr.close()
        wait_until_it_begins(running, folder)
        time.sleep(source.uniform(0.0, 2.0))
        running.send_signal(number)
        try:
            status = running.wait(SECONDS)
        except subprocess.TimeoutExpired:
            running.kill()
            return f"{chosen}: signal {number} is not seen"
        message = running.stderr.read().decode() if is_heard else ""
    return look_at(folder, chosen, number, status, message if is_heard else None)


def wait_until_it_begins(running: subprocess.Popen, folder: Path) -> None:
    """Before it has made its first file the program has nothing to leave behind, and may not listen yet."""
    end = time.monotonic() + SECONDS
    while not any(folder.glob("*.h5*")) and running.poll() is None and time.monotonic() < end:
        time.sleep(0.01)


def look_at(folder: Path, chosen: list[str], number: int, status: int, message: str | None) -> str | None:
    """What the run left."""
    names = sorted(path.name for path in folder.iterdir() if path.suffix != ".nml")
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

"""Damaged checkpoints, and damaged files of time steps beside whole ones: refused, or resumed to the same bits."""

import functools
import random
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

from damage import damaged
from kill_and_resume import busy, different
from run import call

TITLE = "damaged checkpoints and `.part` files (bytes flipped, zeroed, cut, swapped), `--resume`"
CASES = 1000
SECONDS = 900


@functools.cache
def interrupted(program: Path) -> Path:
    """A folder with an interrupted run, and what comes out where nobody damages it (reference.h5)."""
    folder = Path(tempfile.mkdtemp(prefix="interrupted_"))
    text = busy(0.0).replace("end_time = 12.0", "end_time = 1.0")
    (folder / "case.nml").write_text(text, encoding="utf-8")
    with subprocess.Popen([program, "case.nml", "--quiet"], cwd=folder) as running:
        deadline = time.monotonic() + SECONDS
        while not (folder / "case.h5.ckpt").exists() and time.monotonic() < deadline:
            time.sleep(0.002)
        running.send_signal(signal.SIGTERM)
    whole = Path(tempfile.mkdtemp(prefix="whole_"))
    shutil.copytree(folder, whole, dirs_exist_ok=True)
    run = call(program, whole, "case.nml", "--resume", "--quiet")
    if run.status != 0:
        message = f"the undamaged checkpoint is not resumed: {run.err}"
        raise RuntimeError(message)
    shutil.move(whole / "case.h5", folder / "reference.h5")
    shutil.rmtree(whole)
    return folder


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    shutil.copytree(interrupted(program), folder, dirs_exist_ok=True)
    victim = folder / source.choice(["case.h5.ckpt", "case.h5.ckpt", "case.h5.ckpt", "case.h5.part"])
    victim.write_bytes(damaged(victim.read_bytes(), source))
    kept = {path.name: path.read_bytes() for path in folder.iterdir()}
    run = call(program, folder, "case.nml", "--resume", "--quiet")
    if run.trouble():
        return run.trouble()
    if run.status == 0:
        paths = different(folder / "reference.h5", folder / "case.h5")
        return f"resumed to other bits: {paths[:3]}" if paths else None
    if run.status != 1 or "cannot resume" not in run.err or "starts at the beginning" not in run.err:
        return f"status {run.status}: {run.err.strip()[-200:]}"
    now = {path.name: path.read_bytes() for path in folder.iterdir()}
    return None if now == kept else f"refused, but changed {[name for name in kept if now.get(name) != kept[name]]}"

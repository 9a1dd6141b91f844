"""Damaged results read back by --resume: recognised as damaged and made again, or refused; never taken for complete."""

import functools
import random
import shutil
import tempfile
from pathlib import Path

from cases import STEADY, TRANSIENT
from damage import damaged
from kill_and_resume import different
from run import call

TITLE = "damaged results (bytes flipped, zeroed, cut, swapped), `--resume`"
CASES = 1000
QUICK = 8


@functools.cache
def complete(program: Path) -> Path:
    folder = Path(tempfile.mkdtemp(prefix="complete_"))
    for name, text in (("steady", STEADY), ("transient", TRANSIENT)):
        (folder / f"{name}.nml").write_text(text.replace("intervals = 256", "intervals = 64"), encoding="utf-8")
        run = call(program, folder, f"{name}.nml", "--quiet")
        if run.status != 0:
            raise RuntimeError(run.err)
    return folder


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    name = source.choice(["steady", "transient"])
    reference = complete(program) / f"{name}.h5"
    shutil.copy(complete(program) / f"{name}.nml", folder)
    (folder / f"{name}.h5").write_bytes(damaged(reference.read_bytes(), source))
    run = call(program, folder, f"{name}.nml", "--resume")
    if run.trouble():
        return run.trouble()
    if "nothing to do" in run.err:
        return "taken for complete"
    if run.status == 0:
        paths = different(reference, folder / f"{name}.h5")
        return f"other bits: {paths[:3]}" if paths else None
    return None if run.status == 1 and "no result of asperity" in run.err else f"status {run.status}: {run.err.strip()[-200:]}"

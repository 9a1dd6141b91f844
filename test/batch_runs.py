"""What the tests of batch/ share: calling its scripts as a user does, and a sweep that takes a moment."""

import os
import sys

from cases import ROOT, called, ended

BATCH = ROOT / "batch"

# Four contacts on 256 intervals; the second one has room for one cycle of a slow method only and does not converge.
SMALL = """base = "base.nml"
together = ["load.hertz_pressure", "solver.max_cycles"]
[vary]
load.hertz_pressure = [0.4e9, 0.6e9, 0.5e9, 0.3e9]
solver.max_cycles = [100, 1, 100, 100]
[set]
domain.intervals = 256
solver.method = "fas_block_jacobi"
accuracy.error_bars = false
"""
BASE = (ROOT / "input" / "minimal.nml").read_text(encoding="utf-8")


def call(script, *arguments, folder, program, **options):
    environment = {**os.environ, "ASPERITY": str(program), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "agg"}
    command = [sys.executable, "-W", "error", str(BATCH / script), *map(str, arguments)]
    return called(command, cwd=folder, env=environment, **options)


def write_sweep(folder, text=SMALL, base=BASE, name="small.toml"):
    (folder / "base.nml").write_text(base, encoding="utf-8")
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def swept(folder, program, text=SMALL, base=BASE):
    """The folder of a sweep, written by batch/sweep.py."""
    write_sweep(folder, text, base)
    ended(call("sweep.py", "small.toml", folder=folder, program=program))
    return folder / "small"

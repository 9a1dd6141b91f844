"""Environment variables of the run-time libraries, and small stacks: the same answer to the bit, or one message."""

import os
import random
import resource
from pathlib import Path

import h5py
import numpy as np
from run import call

TITLE = "environment variables of the run-time libraries, small stacks"
CASES = 300

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
CASE = """&case problem = 'dry_area' /
&bodies reduced_modulus = 2e11 /
&load mean_pressure = 1e7, 2e7 /
&surface_1 shape = 'synthetic', rms_height = 1e-7 /
&domain length_x = 1e-3, length_y = 1e-3, intervals_x = 32, intervals_y = 32 /
"""
OIL = """&case problem = 'ehl_line' /
&moes moes_m = 10.0, moes_l = 5.0, velocity = 'mean' /
&lubricant /
&domain intervals = 256 /
"""
ANSWERS: dict[tuple, np.ndarray] = {}


def pressure(program: Path, folder: Path, text: str) -> np.ndarray:
    if (program, text) not in ANSWERS:
        (folder / "usual.nml").write_text(text, encoding="utf-8")
        call(program, folder, "usual.nml", "--quiet")
        with h5py.File(folder / "usual.h5") as file:
            ANSWERS[program, text] = file["solution/pressure"][()]
    return ANSWERS[program, text]


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    text = source.choice([CASE, OIL])
    usual = pressure(program, folder, text)
    env = dict(os.environ) | {
        name: source.choice(VARIABLES[name]) for name in source.sample(sorted(VARIABLES), source.randint(1, 4))
    }
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

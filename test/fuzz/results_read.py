"""Damaged and foreign results given to the package and to gather: refused with the reason, never shown, never another error."""

import contextlib
import os
import random
import shutil
import sys
from pathlib import Path

import h5py
import numpy as np
from cases import seal
from damage import damaged
from results_resumed import complete
from run import ROOT

sys.path += [str(ROOT / "python"), str(ROOT / "batch")]

import asperity
from gather import DONE, FAILURE, outcome_of
from result_row import RowReader

TITLE = "damaged, foreign and changed results, `asperity.read` and `gather`"
CASES = 1000
QUICK = 20
KINDS = ["bytes", "bytes", "bytes", "foreign", "edited", "behind", "other", "whole"]
VALUES = [
    *(1.0, b"text", np.zeros(0), np.arange(3), np.zeros((2, 3, 4))),
    *(h5py.Empty("f8"), np.array((1, 2.0), dtype=[("a", "i4"), ("b", "f8")])),
]
NAMES = [
    *("summary/h_min", "solution/x", "solution/pressure", "report/method"),
    *("input/namelist", "transient", "adequacy/validity/x", "scaling"),
]


def change(path: Path, source: random.Random) -> None:
    """Something else in the place of a dataset or an attribute, through HDF5, which keeps no seal."""
    with h5py.File(path, "a") as file:
        for name in source.sample(NAMES, source.randint(1, 4)):
            if name in file:
                del file[name]
            with contextlib.suppress(ValueError, OSError, TypeError):  # a dataset is in the way
                file[name] = source.choice(VALUES)
                file[name].attrs[source.choice(["si_scale", "units", "error_estimate", "verdict"])] = source.choice(VALUES)
        name = source.choice(["program", "converged", "reason", "title", "problem"])
        file.attrs[name] = source.choice(VALUES) if source.random() < 0.3 else b"asperity"


def put(path: Path, kind: str, source: random.Random) -> None:
    """What is wrong with the file."""
    if kind == "bytes":
        path.write_bytes(damaged(path.read_bytes(), source))
    elif kind == "behind":
        path.write_bytes(path.read_bytes() + source.choice([b"\0", b"\n", source.randbytes(80)]))
    elif kind == "other":
        path.unlink()
        source.choice(
            [
                path.mkdir,
                lambda: os.mkfifo(path),
                lambda: path.symlink_to("/dev/zero"),
                lambda: path.write_bytes(source.randbytes(300)),
            ]
        )()
    elif kind != "whole":
        if kind == "foreign":
            path.unlink()
        change(path, source)


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    name, kind = source.choice(["steady", "transient"]), source.choice(KINDS)
    for ending in (".nml", ".h5"):
        shutil.copy(complete(program) / (name + ending), folder)
    path = folder / f"{name}.h5"
    put(path, kind, source)
    is_sealed = kind in ("foreign", "edited") and source.random() < 0.5
    if is_sealed:
        seal(path)
    status, reason, _, values = outcome_of(folder / name, RowReader(), {}, {})
    was_read = False
    try:
        result = asperity.read(path)
        was_read = True
        for part in ("summary", "solution", "transient", "sweep", "report", "verdicts", "case", "x", "pressure", "film"):
            getattr(result, part)
        repr(result)
    except asperity.AsperityError as error:
        if str(path) not in str(error):
            return f"{kind}: no name in the message: {error}"
    except Exception as error:  # whatever it is
        return f"{kind}: {type(error).__name__}: {error!s:.200}"
    if is_sealed:
        return None
    wanted = DONE if kind == "whole" else FAILURE
    if was_read != (kind == "whole"):
        return f"{kind}: {'read' if was_read else 'refused'}"
    return None if status == wanted and bool(values) == (kind == "whole") else f"{kind}: gathered as {status}: {reason}"

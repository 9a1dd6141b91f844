"""HDF5 files of heights with damaged bytes: an answer with the heights as they are in the file, or one message."""

import random
from pathlib import Path

import h5py
import numpy as np
from damage import damaged
from surfaces import judged, solved

TITLE = "HDF5 files of heights, damaged bytes"
CASES = 400


def write(path: Path, source: random.Random) -> None:
    """A file as h5py writes it: contiguous, chunked or compressed, old or new format."""
    z = np.random.default_rng(source.randrange(2**32)).standard_normal(256) * 1e-7
    options = source.choice([{}, {"chunks": (64,)}, {"compression": "gzip"}, {"chunks": (64,), "fletcher32": True}])
    with h5py.File(path, "w", libver=source.choice(["earliest", "latest"])) as file:
        data = file.create_dataset("scan/z", data=z, **options)
        data.attrs["spacing_x"] = 1e-6
        data.attrs["si_scale"] = 1.0


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    path = folder / "z.h5"
    write(path, source)
    path.write_bytes(damaged(path.read_bytes(), source))
    kind = source.choice(["line", "oil"])
    return judged(solved(program, folder, kind, "z.h5", ", dataset = 'scan/z'"), folder, "z.h5")

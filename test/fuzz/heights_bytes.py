"""HDF5 files of heights with damaged bytes: an answer with the heights as they are in the file, or one message."""

from __future__ import annotations

import random
from pathlib import Path

import h5py
import numpy as np
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
    content = bytearray(path.read_bytes())
    for _ in range(source.choice([1, 1, 2, 4, 16])):
        place = source.randrange(source.choice([len(content), min(len(content), 2500)]))
        length = source.choice([1, 1, 4, 8, 64])
        kind = source.randrange(4)
        if kind == 0:
            content[place] ^= 1 << source.randrange(8)
        elif kind == 1:
            content[place : place + length] = bytes(source.choice([0, 255]) for _ in content[place : place + length])
        elif kind == 2:
            content[place] = source.randrange(256)
        else:
            other = source.randrange(len(content))
            piece = content[other : other + length]
            content[place : place + len(piece)] = piece
        if source.random() < 0.05:
            del content[source.randrange(1, len(content)) :]
    path.write_bytes(content)
    kind = source.choice(["line", "oil"])
    return judged(solved(program, folder, kind, "z.h5", ", dataset = 'scan/z'"), folder, "z.h5")

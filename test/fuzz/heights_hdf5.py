"""HDF5 files of heights with attributes, types, shapes, values and storage that nobody expects."""

import os
import random
from pathlib import Path

import h5py
import numpy as np
from surfaces import judged, solved

TITLE = "HDF5 files of heights: attributes, packed and missing values, types, shapes, storage"
CASES = 240

NEGATIVE = -1e-6  # of a spacing; as a scale it turns heights into depths
SPACINGS = [
    *(np.full(number, 1e-6) for number in (2, 3, 64, 1000, 7000)),
    np.zeros(0),
    h5py.Empty("f8"),
    *(0.0, NEGATIVE, 1e-320, 1e-300, 1e300, np.inf, -np.inf, np.nan),
    *("1e-6", np.bytes_("1e-6"), np.array([b"1e-6"] * 3), True, 1e-6 + 1e-6j),
    np.array((1, 2.0), dtype=[("a", "i4"), ("b", "f8")]),
]
VALUES = [1e308, -1e308, np.inf, np.nan, 1e300, 1e-320, 5e3]
TYPES = ["S4", "O", "c16", "compound", "bool", "opaque", "reference"]


def heights(source: random.Random, shape: tuple[int, ...]) -> np.ndarray:
    return np.random.default_rng(source.randrange(2**32)).standard_normal(shape) * 1e-7


def bad_attribute(file: h5py.File, z: np.ndarray, source: random.Random) -> None:
    """An attribute that is no single number, or none that can be."""
    data = file.create_dataset("z", data=z)
    name = source.choice(["spacing", "spacing_x", "si_scale"])
    data.attrs["spacing"] = 1e-6
    data.attrs[name] = source.choice([value for value in SPACINGS if name != "si_scale" or value is not NEGATIVE])


def bad_values(file: h5py.File, z: np.ndarray, source: random.Random) -> None:
    """One or all heights of a size that is none."""
    z = z.copy()
    value = source.choice(VALUES)
    if source.random() < 0.5:
        z.flat[source.randrange(z.size)] = value
    else:
        z[...] = value
    file.create_dataset("z", data=z).attrs["spacing"] = 1e-6


def bad_type(file: h5py.File, z: np.ndarray, source: random.Random) -> None:
    """Heights that are no numbers."""
    kind = source.choice(TYPES)
    if kind == "O":
        data = file.create_dataset("z", z.shape, dtype=h5py.string_dtype())
    elif kind == "compound":
        data = file.create_dataset("z", z.shape, dtype=[("a", "f8"), ("b", "S3")])
    elif kind == "reference":
        data = file.create_dataset("z", z.shape, dtype=h5py.ref_dtype)
    elif kind == "opaque":
        data = file.create_dataset("z", z.shape, dtype="V8")
    else:
        data = file.create_dataset("z", data=z.astype(kind))
    data.attrs["spacing"] = 1e-6


def bad_shape(file: h5py.File, _: np.ndarray, source: random.Random) -> None:
    """No heights, one, or more dimensions than two."""
    shape = source.choice([(), (0,), (1,), (0, 4), (4, 0), (2, 2, 2), (1,) * 32, None])
    if shape is None:
        file.create_dataset("z", data=h5py.Empty("f8")).attrs["spacing"] = 1e-6
    else:
        file.create_dataset("z", data=np.zeros(shape)).attrs["spacing"] = 1e-6


def missing(file: h5py.File, z: np.ndarray, source: random.Random) -> None:
    """Packed heights of which one is missing or not valid, or lies far from all others."""
    counts = np.rint(z / 1e-10).astype("i2")
    name, value = source.choice([("_FillValue", -32768), ("missing_value", 0), ("valid_min", -32000), ("valid_max", 32000)])
    beyond = {"valid_min": -1, "valid_max": 1}.get(name, 0)
    far = source.random() < 0.3
    counts = counts // 100 if far else counts
    counts.flat[source.randrange(z.size)] = source.choice([-32768, 32767]) if far else value + beyond
    data = file.create_dataset("z", data=counts)
    data.attrs.update(spacing=1e-6, scale_factor=1e-10, add_offset=source.choice([0.0, 1e-6]))
    if not far:
        data.attrs[name] = source.choice([np.int16(value), np.array([value]), float(value)])


def bad_storage(file: h5py.File, z: np.ndarray, source: random.Random) -> None:
    """Values in other files, in a dataset that contains itself, in one huge chunk, or declared and not stored."""
    kind = source.choice(["external", "virtual", "itself", "chunk", "declared", "link", "group", "loop"])
    if kind == "external":
        file.create_dataset("z", (32,), "f8", external=[(source.choice(["/etc/passwd", "/dev/zero", "other"]), 0, 256)])
    elif kind in ("virtual", "itself"):
        name = "z.h5" if kind == "itself" else source.choice(["other.h5", "pipe.h5", "."])
        layout = h5py.VirtualLayout(z.shape, "f8")
        layout[...] = h5py.VirtualSource(name, "z", shape=z.shape)
        file.create_virtual_dataset("z", layout)
    elif kind == "chunk":
        file.create_dataset("z", (2**29,), "f8", chunks=(2**28,))
    elif kind == "declared":
        file.create_dataset("z", source.choice([(2**31,), (2**45,), (2**40, 2**20), (65536, 65536)]), "f8", chunks=True)
    elif kind == "link":
        file["z"] = h5py.ExternalLink(source.choice(["pipe.h5", "good.h5", "z.h5", "/dev/zero"]), "z")
    elif kind == "group":
        file.create_group("z")
    else:
        file["z"] = h5py.SoftLink("/z")
    if isinstance(file.get("z", getlink=True), h5py.HardLink):
        file["z"].attrs["spacing"] = 1e-6


ATTACKS = [bad_attribute, bad_attribute, bad_values, bad_type, bad_shape, bad_storage, bad_storage, missing, None]


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice(["line", "area", "oil"])
    z = heights(source, (12, 16) if kind == "area" else (64,))
    chosen = source.choice(ATTACKS)
    os.mkfifo(folder / "pipe.h5")
    with h5py.File(folder / "good.h5", "w") as file:
        file.create_dataset("z", data=z).attrs["spacing"] = 1e-6
    with h5py.File(folder / "z.h5", "w") as file:
        if chosen:
            chosen(file, z, source)
        else:
            file.create_dataset("z", data=z, dtype=source.choice(["f4", "f8", ">f8", ">f4"])).attrs["spacing"] = np.float32(1e-6)
    run = solved(program, folder, kind, "z.h5", ", dataset = 'z'")
    return judged(run, folder, "z.h5", is_good=chosen is None)

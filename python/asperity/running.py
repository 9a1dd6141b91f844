"""The time steps of a run that goes on, or was stopped: the records in `NAME.h5.part`.

The program appends them (`src/output/transient_store.f90`): a line that says what is in them, then for each time step its numbers,
the profiles of every so many steps, and the checksum of all bytes before it, 16 digits.
"""

from __future__ import annotations

import io
import itertools
import os
import re
from pathlib import Path

import numpy as np
import numpy.typing as npt

from .errors import AsperityError
from .seal import checksum_of

_LINE = re.compile(r"asperity series nodes (\d+) stride (\d+) numbers ([\w ]+) profiles ?([\w ]*?) *\n")


def read_part(path: str | os.PathLike[str]) -> dict[str, npt.NDArray[np.float64]]:
    """All whole time steps: series of one number, and profiles with a row for each `profile_time`, as in `/transient`."""
    numbers, rows, times = [], [], []
    with Path(path).open("rb") as file:
        line = file.readline(10000)
        nodes, stride, names, profiles = layout(path, line)
        sums = checksum_of(io.BytesIO(line), len(line))
        for step in itertools.count():
            has_profiles = step % stride == 0
            size = 8 * (len(names) + has_profiles * len(profiles) * nodes)
            record, digits = file.read(size), file.read(len(sums))
            sums = checksum_of(io.BytesIO(record), size, sums)
            if sums.encode() != digits:
                break
            sums = checksum_of(io.BytesIO(digits), len(digits), sums)
            values = np.frombuffer(record, "<f8")
            numbers.append(values[: len(names)])
            if has_profiles:
                times.append(values[0])
                rows.append(values[len(names) :].reshape(len(profiles), nodes))
    columns = np.reshape(numbers, (-1, len(names))).T
    planes = np.reshape(rows, (-1, len(profiles), nodes)).swapaxes(0, 1)
    return {
        **dict(zip(names, columns, strict=True)),
        "profile_time": np.array(times),
        **dict(zip(profiles, planes, strict=True)),
    }


def layout(path: str | os.PathLike[str], line: bytes) -> tuple[int, int, list[str], list[str]]:
    """What the first line of a file says: nodes of a profile, steps between profiles, names of numbers and of profiles."""
    found = _LINE.fullmatch(line.decode("ascii", "replace"))
    if not found:
        raise AsperityError(f"{path}: no time steps of asperity, or none yet")
    return int(found[1]), int(found[2]), found[3].split(), found[4].split()

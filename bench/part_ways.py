#!/usr/bin/env python3
"""Ways of the HDF5 library to keep NAME.part readable while it grows: what a reader finds in it, and what a record costs.

    part_ways.py [--records 60] [--nodes 1025]

The series of a transient grow record by record, once under SWMR with a flush of each series, once in a file that is opened
and closed again for each record. What a reader like any other (h5py.File(path)) may find at some moment, or after a kill, is
the file after any number of the library's writes to it: all of these files are looked at. For the decision on running series
in docs/decisions.md.
"""

from __future__ import annotations

import argparse
import collections
import io
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import h5py
import numpy as np

NUMBERS = ("time", "rigid_displacement", "h_min", "p_max", "residual", "profile_time")
ROWS = ("pressure", "film_thickness")
CHUNK = 32768


class Recorder(io.FileIO):
    """A file that keeps a list of what is done to it."""

    def __init__(self, path: pathlib.Path) -> None:
        """Opens a file that is there."""
        super().__init__(path, "r+")
        self.changes: list[tuple[int, bytes | None]] = []

    def write(self, data: bytes) -> int:
        """Place and bytes of a write."""
        self.changes.append((self.tell(), bytes(data)))
        return super().write(data)

    def truncate(self, size: int | None = None) -> int:
        """A new length."""
        self.changes.append((size, None))
        return super().truncate(size)


def create(file: h5py.File, nodes: int) -> None:
    """Series without records."""
    for name in NUMBERS + ROWS:
        row = (nodes,) if name in ROWS else ()
        chunk = (max(CHUNK // nodes, 1), nodes) if row else (1024,)
        file.create_dataset(name, (0, *row), "f8", maxshape=(None, *row), chunks=chunk)


def append(file: h5py.File, record: int, flushes: bool) -> None:
    """Record number `record` (from 0) holds record + 1 everywhere; time comes last."""
    for name in reversed(NUMBERS + ROWS):
        file[name].resize(record + 1, axis=0)
        file[name][record] = record + 1.0
        if flushes:
            file[name].flush()


def found(path: pathlib.Path, swmr: bool = False) -> str:
    """What a reader finds."""
    try:
        with h5py.File(path, swmr=swmr) as file:
            lengths = {name: len(file[name]) for name in NUMBERS + ROWS}
            if min(lengths.values()) < lengths["time"]:
                return "fewer values than times"
            values = [file[name][()] for name in NUMBERS] + [file[name][:, -1] for name in ROWS]
            is_right = all(np.array_equal(got, np.arange(1, len(got) + 1)) for got in values)
            return "whole" if is_right else "other numbers than written"
    except (OSError, RuntimeError, KeyError) as error:
        return "refused" + (" as open for writing" if "already open for write" in str(error) else "")


def reopened(folder: pathlib.Path, records: int, nodes: int) -> tuple[collections.Counter, float]:
    """What is found after each write of a file that is opened for each record; seconds of a record."""
    path, copy, seen, seconds = folder / "reopen.h5", folder / "copy.h5", collections.Counter(), 0.0
    with h5py.File(path, "w") as file:
        create(file, nodes)
    for record in range(records):
        shutil.copy(path, copy)
        with Recorder(path) as recorder:
            begin = time.process_time()
            with h5py.File(recorder, "r+") as file:
                append(file, record, flushes=False)
            seconds += time.process_time() - begin
        for place, data in recorder.changes:
            with copy.open("r+b") as stream:
                stream.seek(place)
                stream.truncate() if data is None else stream.write(data)
            seen[found(copy)] += 1
    return seen, seconds / records


def under_swmr(path: str, records: int, nodes: int) -> None:
    """Writes under SWMR and stays, to be killed; says what a record costs."""
    file = h5py.File(path, "w", libver="latest")
    create(file, nodes)
    file.swmr_mode = True
    begin = time.process_time()
    for record in range(records):
        append(file, record, flushes=True)
    print((time.process_time() - begin) / records, flush=True)
    time.sleep(600)


def main() -> None:
    """Both ways."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--records", type=int, default=60)
    parser.add_argument("--nodes", type=int, default=1025)
    parser.add_argument("--swmr", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.swmr:
        under_swmr(options.swmr, options.records, options.nodes)
        return
    print(f"HDF5 {h5py.version.hdf5_version}, {options.records} records of {options.nodes} nodes")
    with tempfile.TemporaryDirectory() as name:
        path = pathlib.Path(name) / "swmr.h5"
        command = [sys.executable, __file__, "--swmr", str(path), "--records", str(options.records), "--nodes", str(options.nodes)]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as running:
            seconds = float(running.stdout.readline())
            live = found(path)
            running.kill()
        print(
            f"SWMR: {1e3 * seconds:.2f} ms a record; live: {live}; after a kill: {found(path)}, with swmr=True {found(path, True)}"
        )
        seen, seconds = reopened(pathlib.Path(name), options.records, options.nodes)
        print(f"opened for each record: {1e3 * seconds:.2f} ms; after each write: {dict(seen.most_common())}")


if __name__ == "__main__":
    main()

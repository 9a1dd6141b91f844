"""Files of heights: damaged bytes, sizes at the ends of what numbers hold, names of what is no file."""

import os
import random
import socket
from pathlib import Path

import h5py
import numpy as np
from cases import damaged
from run import Run, attack, call

LINE = """&case problem = 'dry_line' /
&bodies reduced_modulus = 2e11 /
&load mean_pressure = 1e7 /
&surface_1 shape = 'file', file = '{file}'{more} /
"""
OIL = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 2e11, speed_1 = 1.0, speed_2 = 0.0 /
&load load_per_length = 1e5 /
&lubricant viscosity = 0.05, pressure_viscosity = 2e-8, roelands_z = 0.6 /
&surface_2 shape = 'file', file = '{file}'{more} /
&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 64 /
&accuracy error_bars = .false. /
"""
TEXTS = {"line": LINE, "area": LINE.replace("dry_line", "dry_area"), "oil": OIL}


def solved(program: Path, folder: Path, kind: str, file: str, more: str = "", **options) -> Run:
    (folder / "case.nml").write_text(TEXTS[kind].format(file=file, more=more), encoding="utf-8")
    return call(program, folder, "case.nml", "--quiet", **options)


def nonsense(path: Path) -> str | None:
    """Fields of a result that says `converged` and holds what is no answer."""
    with h5py.File(path) as file:
        if not file.attrs["converged"]:
            return None
        for name in ("solution", "sweep", "summary", "surface"):
            for key, data in file.get(name, {}).items():
                values = data[()]
                if not np.all(np.isfinite(values)) or (key == "pressure" and np.min(values) < 0):
                    return f"{name}/{key} with converged = 1"
    return None


def judged(run: Run, folder: Path, file: str) -> str | None:
    """What broke: a crash, a message without the file, nonsense that converged."""
    if run.trouble():
        return run.trouble()
    if run.status == 1:
        return None if file in run.err and "case.nml:" in run.err else f"no file in the message: {run.err.strip()[-200:]}"
    return nonsense(folder / "case.h5") if (folder / "case.h5").exists() else f"no result, status {run.status}"


def write(path: Path, source: random.Random) -> None:
    """A file as h5py writes it: contiguous, chunked or compressed, old or new format."""
    z = np.random.default_rng(source.randrange(2**32)).standard_normal(256) * 1e-7
    options = source.choice([{}, {"chunks": (64,)}, {"compression": "gzip"}, {"chunks": (64,), "fletcher32": True}])
    with h5py.File(path, "w", libver=source.choice(["earliest", "latest"])) as file:
        data = file.create_dataset("scan/z", data=z, **options)
        data.attrs["spacing_x"] = 1e-6
        data.attrs["si_scale"] = 1.0


@attack("HDF5 files of heights, damaged bytes", 400)
def heights_bytes(program: Path, source: random.Random, folder: Path) -> str | None:
    path = folder / "z.h5"
    write(path, source)
    path.write_bytes(damaged(path.read_bytes(), source))
    kind = source.choice(["line", "oil"])
    return judged(solved(program, folder, kind, "z.h5", ", dataset = 'scan/z'"), folder, "z.h5")


SIDES = [2, 3, 1000, 4096, 32768, 46341, 65536, 65537, 2147483647, 2147483648, 4294967296, -1, 0]
INTERVALS = [8, 16384, 1048576, 16777216, 33554432, 2147483648, 12, 11, 7]
AREA = """&case problem = 'dry_area' /
&bodies reduced_modulus = 2e11{hard} /
&load mean_pressure = {load} /
&surface_1 {surface} /
&domain {lengths} intervals_x = {x}, intervals_y = {y}, periodic = {periodic} /
"""
SIDE = "length_x = 1e-3, length_y = 1e-3,"
WAVE = {"hard": "", "load": 1e7, "lengths": SIDE, "surface": "shape = 'sinusoid', amplitude = 1e-8, wavelength = 1e-3"}
MOES = """&case problem = 'ehl_line' /
&moes moes_m = {m}, moes_l = 5.0, velocity = 'mean' /
&lubricant /
&domain {intervals} /
&solver method = '{method}' /
&accuracy error_bars = .false. /
"""


@attack("sizes: nodes, intervals, threads", 120)
def sizes(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice(["area", "oil", "threads"])
    arguments = ["--check"]
    if kind == "oil":
        method = source.choice(["auto", "newton_dense", "block_jacobi", "newton_krylov"])
        intervals = source.choice(["", f"intervals = {source.choice(INTERVALS)}"])
        text = MOES.format(m=source.choice([1.0, 10.0, 100.0]), intervals=intervals, method=method)
        is_too_large = any(f"= {number}" in intervals for number in (33554432, 2147483648, 11, 7))
    else:
        x, y = (source.choice(SIDES) for _ in range(2))
        is_too_large = not (2 <= x <= 65536 and 2 <= y <= 65536 and x * y < 2**29)
        if kind == "threads":
            x = y = source.choice([64, 256, 1024])
            is_too_large = False
            arguments = ["--quiet", "--threads", str(source.choice([1, 2, 3, 64, 500, 2000, 9999]))]
        text = AREA.format(**WAVE, x=x, y=y, periodic=source.choice([".true.", ".false."]) if kind == "area" else ".true.")
    (folder / "case.nml").write_text(text, encoding="utf-8")
    run = call(program, folder, "case.nml", *arguments)
    if is_too_large and run.trouble() is None and (run.status != 1 or "case.nml:" not in run.err):
        return f"too large and taken: {run.status} {run.err.strip()[-200:]}"
    return run.trouble(0, 1)


ENDINGS = [".csv", ".h5", ".hdf5", "", ".CSV", ".H5", ".txt"]
DEVICES = ["/dev/zero", "/dev/null", "/dev/full", "/dev/random", "/dev/tty", "/dev/stdin", "/proc/self/mem", "/proc/kmsg", "/sys"]
ODD = ["", " ", "..", ".", "a" * 300, "a" * 5000, "~", "*", "$HOME", "z\tz", "\u00e4", "-", "z\\n", "/" * 50, "a/b/c"]


def make(kind: str, path: Path) -> None:
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(os.path.relpath(path))
    elif kind == "circle":
        path.symlink_to(path.name)
    elif kind == "nowhere":
        path.symlink_to("nothing")
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "empty":
        path.touch()
    else:
        path.write_bytes(b"x,z\n")


@attack("names: pipes, devices, folders, sockets, links, odd characters", 160)
def names(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice(["pipe", "folder", "socket", "circle", "nowhere", "device", "empty", "header", "special", "odd"])
    name = "z" + source.choice(ENDINGS)
    here = Path.cwd()
    os.chdir(folder)
    try:
        if kind == "special":
            name = source.choice([*DEVICES, "/"])
        elif kind == "odd":
            name = source.choice(ODD) + source.choice(ENDINGS)
        else:
            make(kind, folder / name)
    finally:
        os.chdir(here)
    if source.random() < 0.3 and not name.startswith("-"):
        run = call(program, folder, "--check", name)
        wanted = name[:40]
    else:
        text = TEXTS[source.choice(["line", "area", "oil"])].format(file=name.replace("'", "''"), more=", dataset = 'z'")
        (folder / "case.nml").write_text(text, encoding="utf-8")
        run = call(program, folder, "case.nml", "--quiet")
        wanted = "case.nml:"
    if run.trouble():
        return run.trouble()
    if run.status != 1:
        return f"{name[:60]!r} taken, status {run.status}"
    is_named = wanted in run.err or "more than 4096 characters" in run.err
    return None if is_named else f"no name in the message: {run.err.strip()[-200:]}"

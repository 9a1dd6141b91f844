"""Limits of address space or data: a result or one message with both numbers, no backtrace, no waiting for memory."""

import os
import random
import resource
from pathlib import Path

import h5py
import numpy as np
import valid_cases
from run import call

TITLE = "small address space or data (60 to 400 MB), sizes, threads"
CASES = 150
MEGABYTE = 2**20
LIMITS = {"address space": resource.RLIMIT_AS, "data": resource.RLIMIT_DATA}
# The loader and the libraries, before the program begins.
BEFORE = ["error while loading shared libraries", "blas_thread_init: pthread_create failed"]
AREA = """&case problem = 'dry_area' /
&bodies reduced_modulus = 2e11, hardness = {hardness} /
&load mean_pressure = {load} /
&surface_1 {surface} /
&domain {lengths} intervals_x = {x}, intervals_y = {y}, periodic = {periodic} /
"""
LINE = """&case problem = 'dry_line' /
&bodies reduced_modulus = 2e11 /
&load mean_pressure = {load} /
&surface_1 {surface} /
&domain {lengths} intervals = {x}, periodic = {periodic} /
"""
OIL = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 2e11, speed_1 = 0.5, speed_2 = 1.5 /
&load load_per_length = {load} /
&lubricant viscosity = 0.04, pressure_viscosity = 2e-8, roelands_p0 = 1.96e8 /
&domain {intervals} /
&solver method = '{method}' /
&accuracy {accuracy} /
{more}
"""
MOVING = """&time transient = .true., end_time = {end} /
&surface_1 shape = 'feature', amplitude = 1e-8, wavelength = 1e-4 /
"""


def dry(source: random.Random, folder: Path) -> str:
    """A line or an area; heights from a formula, synthetic or from a file that is larger or smaller than the grid."""
    is_line = source.random() < 0.4
    most = 2e5 if is_line else 1500
    x, y = (int(valid_cases.logarithmic(source, 16, most)) for _ in range(2))
    shape = source.choice(["file", "synthetic", "sinusoid"])
    surface = {
        "synthetic": "shape = 'synthetic', rms_height = 1e-7",
        "sinusoid": "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3",
        "file": "shape = 'file', file = 'heights.h5', dataset = 'z'",
    }[shape]
    lengths = "" if shape == "file" else ("length = 1e-3," if is_line else "length_x = 1e-3, length_y = 1e-3,")
    if shape == "file":
        nodes = [int(valid_cases.logarithmic(source, 16, most)) for _ in range(1 if is_line else 2)]
        with h5py.File(folder / "heights.h5", "w") as file:
            data = file.create_dataset("z", data=np.random.default_rng(1).standard_normal(nodes) * 1e-8)
            data.attrs["spacing"] = 1e-6
    values = {"surface": surface, "lengths": lengths, "x": x, "y": y, "load": source.choice([1e6, 1e8])}
    values["periodic"] = source.choice([".true.", ".false."])
    values["hardness"] = source.choice([2e9, 1e15])
    return (LINE if is_line else AREA).format(**values)


def oil(source: random.Random) -> str:
    """A steady or moving contact on a grid of the user, of the program, or of a wanted accuracy."""
    method = source.choice(["auto", "auto", "newton_dense", "newton_krylov", "fas_block_jacobi"])
    most = 3000 if method == "newton_dense" else 2e5
    intervals = 2 ** int(np.log2(valid_cases.logarithmic(source, 64, most)))
    is_moving = source.random() < 0.4
    accuracy = source.choice(["error_bars = .true.", "error_bars = .false.", "target = 1e-4"])
    if is_moving:
        intervals = min(intervals, 8192)
        accuracy = accuracy.replace("1e-4", "0.05")
    return OIL.format(
        load=valid_cases.logarithmic(source, 2e4, 3e5),
        intervals="" if "target" in accuracy or source.random() < 0.2 else f"intervals = {intervals}",
        method=method,
        accuracy=accuracy,
        more=MOVING.format(end=100 / max(intervals, 1000)) if is_moving else "",
    )


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    draw = source.choice([lambda: dry(source, folder), lambda: oil(source), lambda: valid_cases.lubricated(source, folder)])
    valid_cases.write_valid(program, folder, draw)
    kinds = source.choice([["address space"], ["address space"], ["data"], ["address space", "data"]])
    limits = {LIMITS[kind]: int(source.uniform(60, 400) * MEGABYTE) for kind in kinds}
    arguments = source.choice([[], [], ["--threads", str(source.choice([2, 3, 8, 500]))]])
    env = dict(os.environ)
    env.pop("OPENBLAS_NUM_THREADS", None)
    if source.random() < 0.2:
        env["OPENBLAS_NUM_THREADS"] = source.choice(["1", "4"])
    run = call(program, folder, "case.nml", *arguments, env=env, limits={resource.RLIMIT_CPU: valid_cases.LIMIT} | limits)
    if run.status in (127, 130, -2) and any(words in run.err for words in BEFORE):
        return None
    broken = valid_cases.trouble(run, folder)
    if broken or run.status in (0, 2):
        return broken
    is_told = "found" in run.err and "expected" in run.err
    return None if run.status == 1 and is_told else f"status {run.status}: {run.err.strip()[-300:]}"

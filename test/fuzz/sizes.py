"""Grids of every size, spacings and numbers of threads at the ends of what numbers hold."""

import random
from pathlib import Path

import h5py
import numpy as np
from run import call
from surfaces import judged, solved

TITLE = "sizes: nodes, intervals, spacings, threads"
CASES = 120

SIDES = [2, 3, 1000, 4096, 32768, 46341, 65536, 65537, 2147483647, 2147483648, 4294967296, -1, 0]
INTERVALS = [8, 16384, 1048576, 16777216, 33554432, 2147483648, 12, 11, 7]
AREA = """&case problem = 'dry_area' /
&bodies reduced_modulus = 2e11 /
&load mean_pressure = 1e7 /
&surface_1 shape = 'sinusoid', amplitude = 1e-8, wavelength = 1e-3 /
&domain length_x = 1e-3, length_y = 1e-3, intervals_x = {x}, intervals_y = {y}, periodic = {periodic} /
"""
OIL = """&case problem = 'ehl_line' /
&moes moes_m = {m}, moes_l = 5.0, velocity = 'mean' /
&lubricant /
&domain {intervals} /
&solver method = '{method}' /
&accuracy error_bars = .false. /
"""


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice(["area", "oil", "spacing", "threads"])
    if kind == "spacing":
        spacing = source.choice([1e-320, 1e-300, 1e-200, 1e200, 1e308, np.inf, 1e-16, 1e7])
        with h5py.File(folder / "z.h5", "w") as file:
            data = file.create_dataset("z", data=np.random.default_rng(1).standard_normal(64) * 1e-7)
            data.attrs["spacing"] = spacing
        return judged(
            solved(program, folder, source.choice(["line", "oil"]), "z.h5", ", dataset = 'z'"), folder, "z.h5", is_good=False
        )
    arguments = ["--check"]
    if kind == "oil":
        method = source.choice(["auto", "newton_dense", "block_jacobi", "newton_krylov"])
        intervals = source.choice(["", f"intervals = {source.choice(INTERVALS)}"])
        text = OIL.format(m=source.choice([1.0, 10.0, 100.0]), intervals=intervals, method=method)
        is_too_large = any(f"= {number}" in intervals for number in (33554432, 2147483648, 11, 7))
    else:
        x, y = (source.choice(SIDES) for _ in range(2))
        is_too_large = not (2 <= x <= 65536 and 2 <= y <= 65536 and x * y < 2**29)
        if kind == "threads":
            x = y = source.choice([64, 256, 1024])
            is_too_large = False
            arguments = ["--quiet", "--threads", str(source.choice([1, 2, 3, 64, 500, 2000, 9999]))]
        text = AREA.format(x=x, y=y, periodic=source.choice([".true.", ".false."]) if kind == "area" else ".true.")
    (folder / "case.nml").write_text(text, encoding="utf-8")
    run = call(program, folder, "case.nml", *arguments)
    if is_too_large and run.trouble() is None and (run.status != 1 or "case.nml:" not in run.err):
        return f"too large and taken: {run.status} {run.err.strip()[-200:]}"
    return run.trouble(0, 1)

"""Dry contacts with a wanted accuracy of their contact area: Hertz, sinusoids, files, synthetic surfaces, rough bodies.

The contacts are those of family_dry.py without their number of nodes. Truths of files are the same Fourier series on many more
nodes. A synthetic surface has the series of its first grid, 8 nodes in its shortest wave, which is read from a result on that
grid and written to a file for the truth.
"""

from __future__ import annotations

import math
import random
import re
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
from bench_program import ENVIRONMENT
from families import PROGRAM, Family, Member
from family_dry import FILE, LENGTH, MODULUS, hdf5, heights, hertz, hertz_pressure, rough, sizes, text, waves

FIGURES = ("summary/contact_area_fraction",)
# Nodes a side of the truth.
FINE = {1: 2**17, 2: 2048}
# Nodes of first grids.
FIRST = {1: (64, 96, 128, 256, 512, 1024), 2: (32, 40, 48, 56, 64)}
# Wanted accuracy of a line and of an area: the truth of an area must be finer by far than the grid.
TARGETS = {1: (0.01, 0.05), 2: (0.02, 0.05)}


def aimed(lines: int, draw):
    """The contacts of another family, the number of nodes left to the program."""

    def draw_aimed(source: random.Random, count: int) -> list[Member]:
        return [aim(source, lines, member) for member in draw(source, count)]

    return draw_aimed


def aim(source: random.Random, lines: int, member: Member) -> Member:
    """One of them, with the truth on the same fine grid for all."""
    least, most = TARGETS[lines]
    target = least * (most / least) ** source.random()
    case = re.sub(r"intervals(_[xy])? = \d+,? ?", "", member.case).replace("error_bars = .true.", f"target = {target!r}")
    truth = re.sub(r"(intervals(_[xy])?) = \d+", rf"\1 = {FINE[lines]}", member.truth)
    return replace(member, case=case, truth=truth, target=target)


def smooth_area(source: random.Random, count: int) -> list[Member]:
    """Files of periodic areas with few waves: others need more nodes than a truth has."""
    found = []
    for i in range(count):
        nodes = source.choice(FIRST[2])
        synthesis, load, bodies = rough_case(source, nodes)
        z = solved_heights(text(2, "mean_pressure = 1.0", synthesis, sizes(2, nodes), bars=False))
        case, truth = (text(2, load, FILE, sizes(2, n), bodies=bodies, bars=bars) for n, bars in ((nodes, True), (FINE[2], False)))
        found.append(aim(source, 2, Member(f"{i:03d}", case, truth, files={"z.h5": hdf5(z)})))
    return found


def rough_case(source: random.Random, nodes: int) -> tuple[str, str, str]:
    """Keys of a synthetic surface with 8 nodes in its shortest wave, of a load and of bodies."""
    shortest, rolloff = 8 * LENGTH / nodes, LENGTH / source.uniform(1, 4)
    surface = (
        f"shape = 'synthetic', seed = {source.randint(1, 10**6)}, rms_height = 1e-6, hurst = {source.uniform(0.3, 1)!r}, "
        f"wavelength_short = {shortest!r}, wavelength_rolloff = {rolloff!r}"
    )
    if source.random() < 0.3:
        surface += f", skewness = {source.uniform(-0.5, 0.3)!r}, kurtosis = 3.3"
    # About the rms slope times E'/2.
    slope = 2 * math.pi * 1e-6 / math.sqrt(rolloff * shortest)
    load = MODULUS / 2 * slope * 10 ** source.uniform(-1.5, -0.3)
    hardness = max(MODULUS / 2 * slope * 10 ** source.uniform(-1, -0.3), 1.3 * load)
    bodies = f", hardness = {hardness!r}" if source.random() < 0.4 else ""
    return surface, f"mean_pressure = {load!r}", bodies


def synthetic(lines: int):
    """Periodic surfaces from a seed."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            nodes = source.choice(FIRST[lines])
            surface, load, bodies = rough_case(source, nodes)
            z = solved_heights(text(lines, "mean_pressure = 1.0", surface, sizes(lines, nodes), bars=False))
            case = text(lines, load, surface, sizes(lines, nodes), bodies=bodies)
            truth = text(lines, load, FILE, sizes(lines, nodes), bodies=bodies, bars=False)
            found.append(aim(source, lines, Member(f"{i:03d}", case, truth, files={"z.h5": hdf5(z)})))
        return found

    return draw


def synthetic_body(lines: int):
    """A parabola with roughness from a seed, on an open domain."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            nodes, width = source.choice(FIRST[lines]), source.uniform(0.3, 0.7) * LENGTH / 2
            surface, _, _ = rough_case(source, nodes)
            radius = width**2 / (2e-6 * 10 ** source.uniform(0.5, 1.7))
            peak = hertz_pressure(lines, width, radius)
            mean = peak * width * (math.pi / 2 / LENGTH if lines == 1 else 2 / 3 * math.pi * width / LENGTH**2)
            load = f"mean_pressure = {mean!r}"
            bodies = f", reduced_radius = {radius!r}"
            if source.random() < 0.5:
                bodies += f", hardness = {peak * 10 ** source.uniform(-0.1, 0.7)!r}"
            body, domain = "&surface_2 shape = 'parabola' /\n", sizes(lines, nodes, more=", periodic = .false.")
            case = text(lines, load, surface, domain, bodies=bodies) + body
            truth = text(lines, load, FILE, domain, bodies=bodies, bars=False) + body
            z = centred(solved_heights(text(lines, "mean_pressure = 1.0", surface, sizes(lines, nodes), bars=False)), FINE[lines])
            found.append(aim(source, lines, Member(f"{i:03d}", case, truth, files={"z.h5": hdf5(z)})))
        return found

    return draw


def solved_heights(case: str) -> np.ndarray:
    """The heights of a case [m]."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "case.nml").write_text(case, encoding="utf-8")
        subprocess.run([PROGRAM, "--quiet", "case.nml"], cwd=folder, env=ENVIRONMENT, check=True)
        with h5py.File(Path(folder, "case.h5")) as file:
            return file["solution/height_undeformed"][()]


def centred(z: np.ndarray, nodes: int) -> np.ndarray:
    """Heights at the centres of cells on so many more of them, by their Fourier series."""
    spectrum, old = np.fft.fftn(z) / z.size, z.shape[0]
    turn = np.exp(-1j * np.pi * np.fft.fftfreq(old, 1 / old) / old)
    for axis in range(z.ndim):
        spectrum = spectrum * turn.reshape((-1,) + (1,) * (z.ndim - 1 - axis))
    return heights(spectrum, nodes, centres=True)


FAMILIES = [
    Family("target_hertz_line", "A target: Hertz, line", FIGURES, aimed(1, hertz(1, hardness=False)), 48),
    Family("target_hertz_area", "A target: Hertz, point", FIGURES, aimed(2, hertz(2, hardness=False))),
    Family("target_ball", "A target: a ball that yields", FIGURES, aimed(2, hertz(2, hardness=True))),
    Family("target_waves", "A target: sinusoids", FIGURES, aimed(1, waves)),
    Family("target_file_line", "A target: profiles of a file, elastic", FIGURES, aimed(1, rough(1, hardness=False))),
    Family("target_plastic_line", "A target: profiles of a file that yield", FIGURES, aimed(1, rough(1, hardness=True))),
    Family("target_file_area", "A target: areas of a file", FIGURES, smooth_area),
    Family("target_synthetic_line", "A target: synthetic profiles", FIGURES, synthetic(1)),
    Family("target_synthetic_area", "A target: synthetic areas", FIGURES, synthetic(2)),
    Family("target_open_line", "A target: rough rollers", FIGURES, synthetic_body(1)),
    Family("target_open_area", "A target: rough balls", FIGURES, synthetic_body(2)),
]

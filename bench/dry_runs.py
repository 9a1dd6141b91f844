"""Dry cases for the dry panels of `make chart` and `make stability`: namelists, runs and what is read of their results."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import f90nml
import h5py
import numpy as np
from bench_program import ROOT

sys.path.append(str(ROOT / "postproc"))

PROGRAM = ROOT / "build" / "bin" / "asperity"
# Of the rough area: length [m], mean pressure and E' [Pa].
AREA_LENGTH, AREA_PRESSURE, AREA_MODULUS = 1e-3, 300e6, 200e9
METHODS = ("conjugate_gradient", "steepest_descent")

Case = dict[str, dict[str, object]]


@dataclass
class Outcome:
    """What a run gives: status, iterations, transforms, processor time, separation and error of the last load."""

    converged: bool
    method: str
    iterations: int
    pairs: int
    seconds: float
    separation: float
    area: float
    kkt: float
    reason: str


def run(case: Case, folder: Path, name: str) -> Outcome | None:
    """Runs one case; None if its input is refused."""
    folder.mkdir(parents=True, exist_ok=True)
    namelist, result = folder / f"{name}.nml", folder / f"{name}.h5"
    f90nml.Namelist(case).write(namelist, force=True)
    done = subprocess.run([PROGRAM, namelist, "--output", folder, "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 2):
        return None
    with h5py.File(result) as file:
        sweep, report = file["sweep"], file["report"]
        outcome = Outcome(
            done.returncode == 0,
            report["method"][()].decode(),
            int(report["cycles"][()]),
            int(report["fft_pairs"][()]),
            float(report["cpu_seconds"][()]),
            float(sweep["mean_separation"][-1]),
            float(sweep["contact_area_fraction"][-1]),
            float(sweep["kkt"][-1]),
            file.attrs["reason"].decode(),
        )
    result.unlink()
    namelist.unlink()
    return outcome


def profile_case(method: str, nodes: int, tolerance: float = 1e-6) -> Case:
    """Reference profile C, harmonics 1 to 64, elastic at a mean pressure of 1 GPa, on any number of nodes."""
    return {
        "case": {"problem": "dry_line"},
        "bodies": {"youngs_modulus_1": 210e9, "poisson_ratio_1": 0.3},
        "load": {"mean_pressure": 1e9},
        "surface_1": {
            "shape": "file",
            "file": str(ROOT / "test" / "data" / "profiles_ABCD.csv"),
            "positions": "x_m",
            "dataset": "zC_m",
            "harmonics": 64,
        },
        "domain": {"intervals": nodes},
        "solver": {"method": method, "tolerance": tolerance, "max_cycles": 3000},
    }


def area_case(surface: Path, method: str, nodes: int, tolerance: float = 1e-6) -> Case:
    """A rough area from a result file, elastic, about 10 % in contact, on any number of nodes."""
    return {
        "case": {"problem": "dry_area"},
        "bodies": {"reduced_modulus": AREA_MODULUS},
        "load": {"mean_pressure": AREA_PRESSURE},
        "surface_1": {"shape": "file", "file": str(surface.resolve()), "dataset": "/solution/height_undeformed"},
        "domain": {"length_x": AREA_LENGTH, "length_y": AREA_LENGTH, "intervals_x": nodes, "intervals_y": nodes},
        "solver": {"method": method, "tolerance": tolerance, "max_cycles": 3000},
    }


def make_area(folder: Path) -> Path:
    """The rough area on 64 x 64 nodes: waves from an eighth to a twenty-fourth of the length; a result file."""
    case = {
        "case": {"problem": "dry_area"},
        "bodies": {"reduced_modulus": AREA_MODULUS},
        "load": {"mean_pressure": AREA_PRESSURE},
        "surface_1": {
            "shape": "synthetic",
            "seed": 1,
            "rms_height": 1e-6,
            "wavelength_rolloff": 1.25e-4,
            "wavelength_short": 1e-3 / 24,
        },
        "domain": {"length_x": AREA_LENGTH, "length_y": AREA_LENGTH, "intervals_x": 64, "intervals_y": 64},
    }
    folder.mkdir(parents=True, exist_ok=True)
    f90nml.Namelist(case).write(folder / "area.nml", force=True)
    subprocess.run([PROGRAM, folder / "area.nml", "--output", folder, "--quiet"], check=True)
    return folder / "area.h5"


def area_heights(surface: Path, nodes: int) -> tuple[np.ndarray, float]:
    """The rough area on so many nodes, resampled as the program does it, on a unit square; and its mean pressure over E*."""
    with h5py.File(surface) as file:
        coarse = file["solution/height_undeformed"][()] / AREA_LENGTH
    before = coarse.shape[0]
    spectrum = np.fft.fftshift(np.fft.fft2(coarse))
    half = before // 2
    spectrum[0, :] = spectrum[:, 0] = 0.0  # nothing is there: the shortest wave has 64/24 nodes
    wide = np.zeros((nodes, nodes), dtype=complex)
    place = slice(nodes // 2 - half, nodes // 2 - half + before)
    wide[place, place] = spectrum
    return np.fft.ifft2(np.fft.ifftshift(wide)).real * (nodes / before) ** 2, AREA_PRESSURE / (0.5 * AREA_MODULUS)

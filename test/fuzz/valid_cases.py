"""Valid cases from the whole range of the input: a result or a reason, no trap, no NaN under `converged`, nothing left over."""

import random
import resource
import sys
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from run import ROOT, Run, call

sys.path.append(str(ROOT / "bench"))

import namelists

TITLE = "random valid cases, lubricated and dry (`ASPERITY=build/bin/asperity-debug`: with traps)"
CASES = 650
QUICK = 5
# Draws of a case until a valid one is found, at most.
MOST_DRAWS = 100
# Processor time that a case may take [s]; the checked build is five times slower.
LIMIT = 120


def logarithmic(source: random.Random, low: float, high: float) -> float:
    return low * (high / low) ** source.random()


def heights(source: random.Random, film: float, width: float) -> dict[str, object]:
    """A surface: smooth, features, a sinusoid or synthetic roughness, up to the height of the film."""
    shape = source.choice(["smooth", "smooth", "feature", "sinusoid", "synthetic"])
    if shape == "smooth":
        return {"shape": shape}
    height, wave = film * logarithmic(source, 0.01, 1.5), width * logarithmic(source, 0.1, 4)
    if shape == "synthetic":
        waves = {"wavelength_long": 4 * wave, "wavelength_rolloff": 2 * wave, "wavelength_short": 0.5 * wave}
        return {"shape": shape, "rms_height": 0.3 * height, "seed": source.randrange(99), "hurst": 0.8} | waves
    sign = source.choice([-1, 1])
    return {"shape": shape, "amplitude": sign * height, "wavelength": wave, "position": source.uniform(-2.5, 1)}


def lubricated(source: random.Random) -> str:
    """A steel contact anywhere in the range, steady or in time."""
    m, l, slide = logarithmic(source, 0.05, 1000), source.uniform(0.5, 30), source.uniform(-4, 4)  # noqa: E741
    groups = namelists.steel(m, l, slide, source.choice([None, logarithmic(source, 1e6, 5e7)]))
    b = (8 * groups["load"]["load_per_length"] * namelists.RADIUS / (np.pi * namelists.STEEL_MODULUS)) ** 0.5
    film = 0.5 * b**2 / namelists.RADIUS * min(1.0, 3 / m)
    groups["domain"] = {"intervals": source.choice([None, 64, 128, 256])}
    if source.random() < 0.3:
        groups["solver"] = {"method": source.choice(["newton_krylov", "newton_dense", "fas_block_jacobi", "block_jacobi"])}
        groups["domain"] = {"intervals": source.choice([32, 64, 128])}
    groups["surface_1"] = heights(source, film, b)
    groups["surface_2"] = heights(source, film, b)
    is_rough = any(groups[f"surface_{i}"]["shape"] != "smooth" for i in (1, 2))
    if is_rough:
        groups["time"] = {"transient": True, "end_time": source.uniform(0.2, 1.5), "time_step": source.choice([0.05, 0.1])}
    return namelists.namelist(groups)


def dry(source: random.Random) -> str:
    kind = source.choice(["dry_line", "dry_area"])
    nodes = source.choice([32, 64, 128] if kind == "dry_area" else [64, 256, 1000])
    length = logarithmic(source, 1e-5, 1e-2)
    hardness = source.choice([None, logarithmic(source, 1e9, 1e10)])
    rms = length * logarithmic(source, 1e-5, 1e-2)
    loads = sorted(logarithmic(source, 1e5, 8e8) for _ in range(source.randint(1, 3)))
    spectrum = {"wavelength_long": length, "wavelength_rolloff": length / 2, "wavelength_short": 8 * length / nodes}
    suffix = ("_x", "_y") if kind == "dry_area" else ("",)
    domain = {f"length{end}": length for end in suffix} | {f"intervals{end}": nodes for end in suffix}
    groups = {
        "case": {"problem": kind},
        "bodies": {"youngs_modulus_1": 2.1e11, "poisson_ratio_1": 0.3, "hardness": hardness},
        "load": {"mean_pressure": loads},
        "surface_1": {"shape": "synthetic", "seed": source.randrange(99), "hurst": 0.8, "rms_height": rms} | spectrum,
        "domain": domain,
    }
    return namelists.namelist(groups)


def write_valid(program: Path, folder: Path, draw: Callable[[], str]) -> None:
    """Draws a case until one has no finding: some have waves that their grid cannot see."""
    for _ in range(MOST_DRAWS):
        (folder / "case.nml").write_text(draw(), encoding="utf-8")
        if call(program, folder, "case.nml", "--check").status == 0:
            return
    raise RuntimeError("no valid case in many draws")


def trouble(run: Run, folder: Path) -> str | None:
    """A crash, a left-over file, a converged result that is not finite."""
    if run.trouble():
        return run.trouble()
    if list(folder.glob("*.part")):
        return f"status {run.status}, left over: case.h5.part"
    if run.status == 0:
        with h5py.File(folder / "case.h5") as file:
            bad = [name for name, item in file["solution"].items() if not np.all(np.isfinite(item[()]))]
        return f"converged, not finite: {bad}" if bad else None
    return None


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice([lubricated, lubricated, dry])
    write_valid(program, folder, lambda: kind(source))
    run = call(program, folder, "case.nml", limits={resource.RLIMIT_CPU: LIMIT})
    return trouble(run, folder) or run.trouble(0, 2)

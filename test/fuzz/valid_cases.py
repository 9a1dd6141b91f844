"""Valid cases from the whole range of the input: a result or a reason, no trap, no NaN under `converged`, nothing left over,
the same bits after a kill and `--resume`."""

import contextlib
import random
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
from kill_and_resume import different
from run import ROOT, Run, attack, call

sys.path.append(str(ROOT / "bench"))

import namelists

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


def history(source: random.Random, folder: Path, loads: str, values: dict[str, float], span: float) -> dict[str, object]:
    """A table beside the namelist: load and speeds wander, stop or reverse within `span` [s]."""
    names, units = [loads, "speed_1", "speed_2"], ["N/m" if loads == "load_per_length" else "N", "m/s", "m/s"]
    least = [0.3, -1.0, source.choice([-1.0, 0.0, 0.4])]
    times = np.linspace(0, span, source.randint(2, 6))
    shares = [[1.0 if t == 0 else source.uniform(low, 1.0) for low in least] for t in times]
    table = shares * np.array([values[name] for name in names])
    kept = sorted(source.sample(range(3), source.randint(1, 3)))
    header = ",".join(["time [s]"] + [f"{names[i]} [{units[i]}]" for i in kept])
    np.savetxt(folder / "history.csv", np.column_stack([times, table[:, kept]]), "%.6e", ",", header=header, comments="")
    return {"file": "history.csv", "interpolation": source.choice(["linear", "cubic"]), "periodic": source.random() < 0.3}


def further(source: random.Random, film: float, rms: float) -> dict[str, dict[str, object]]:
    """What else a line contact may have, of each with a chance of its own."""
    exponential = {"law": "exponential", "contact_pressure": logarithmic(source, 1e7, 1e10)}
    tripp = {"law": "greenwood_tripp", "density_radius_height": 0.05, "height_over_radius": logarithmic(source, 1e-4, 1e-1)}
    law = source.choice([exponential, tripp])
    choices = {
        "asperities": law | {"rms_height": rms, "flow": source.choice(["none", "patir_cheng"])},
        "supply": {"film": film * logarithmic(source, 0.1, 10)},
        "thermal": {"temperature": source.uniform(20, 120), "inlet_heating": source.choice([True, False])},
        "accuracy": {"target": logarithmic(source, 1e-3, 0.1)},
        "output": {"xdmf": True, "adequacy": source.choice(["full", True]), "velocity_layers": source.choice([0, 5])},
        "film": {"layers": source.choice([4, 10]), "inertia": source.choice([True, False])},
    }
    return {name: group for name, group in choices.items() if source.random() < 0.15}


def lubricated(source: random.Random, folder: Path) -> str:
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
    groups |= further(source, film, film * logarithmic(source, 0.05, 2))
    groups["case"] = {"problem": "ehl_line", "model": "auto" if "accuracy" in groups and "film" not in groups else "full"}
    if "film" in groups:
        groups["case"]["equations"] = "stokes"
    is_rough = any(groups[f"surface_{i}"]["shape"] != "smooth" for i in (1, 2))
    if is_rough:
        groups["time"] = {"transient": True, "end_time": source.uniform(0.2, 1.5), "time_step": source.choice([None, 0.05, 0.1])}
    elif source.random() < 0.4:
        values = groups["load"] | groups["bodies"]
        span = b / max(abs(values["speed_1"]), abs(values["speed_2"])) * logarithmic(source, 2, 50)
        groups["history"] = history(source, folder, "load_per_length", values, span)
        groups["time"] = {"transient": True}
    return namelists.namelist(groups)


def point(source: random.Random, folder: Path) -> str:
    """A circular or elliptic contact of steel, steady or in time, on few intervals."""
    radius, speed, slide = 0.01, logarithmic(source, 0.02, 20), source.uniform(-4, 4)
    pressure, ratio = logarithmic(source, 5e7, 2e9), source.choice([1, 1, logarithmic(source, 0.05, 20)])
    bodies = {"reduced_radius_x": radius, "reduced_radius_y": ratio * radius, "reduced_modulus": namelists.STEEL_MODULUS}
    bodies |= {"entrainment_angle": source.choice([0, 0, 90, source.uniform(-90, 90)])}
    bodies |= {"speed_1": speed * (1 - slide / 2), "speed_2": speed * (1 + slide / 2)}
    oil = {"viscosity": logarithmic(source, 0.005, 0.5), "pressure_viscosity": 2e-8, "roelands_p0": 1.96e8}
    oil["density_law"] = source.choice(["constant", "dowson_higginson"])
    if source.random() < 0.4:
        oil |= {"rheology": "eyring", "eyring_stress": logarithmic(source, 1e6, 5e7), "shear_limit": "cut", "limit_ratio": 0.05}
    a = np.pi * pressure * radius / namelists.STEEL_MODULUS
    film = 1e-7 * speed**0.67 * (oil["viscosity"] / 0.04) ** 0.67
    groups = {"case": {"problem": "ehl_point"}, "bodies": bodies, "lubricant": oil, "load": {"hertz_pressure": pressure}}
    groups["domain"] = {"intervals_x": source.choice([None, 32, 64]), "far_field": source.choice([True, True, False])}
    groups["surface_1"] = heights(source, film, 5 * a)
    groups["surface_2"] = heights(source, film, 5 * a)
    for surface in (groups["surface_1"], groups["surface_2"]):
        if "wavelength" in surface and source.random() < 0.5:
            surface |= {"wavelength_y": a * logarithmic(source, 0.1, 4), "position_y": source.uniform(-1, 1)}
    if any(groups[f"surface_{i}"]["shape"] != "smooth" for i in (1, 2)):
        groups["time"] = {"transient": True, "end_time": source.uniform(0.1, 0.5), "time_step": 0.1}
        groups["domain"]["intervals_x"] = source.choice([32, 64])
    elif source.random() < 0.3:
        groups["load"] = {"load": 2 * np.pi * pressure * a**2 / 3}
        groups["history"] = history(source, folder, "load", groups["load"] | bodies, a / speed * logarithmic(source, 0.5, 5))
        groups["time"] = {"transient": True, "time_step": 0.2}
        groups["domain"]["intervals_x"] = source.choice([32, 64])
    elif source.random() < 0.2:
        groups["accuracy"], groups["domain"]["intervals_x"] = {"target": logarithmic(source, 0.01, 0.1)}, None
    return namelists.namelist(groups)


def dry(source: random.Random, _: Path) -> str:
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
            fields = [item for group in ("solution", "transient") for item in file.get(group, {}).values()]
            bad = [item.name for item in fields if not np.all(np.isfinite(item[()]))]
        return f"converged, not finite: {bad}" if bad else None
    return None


def resumed(program: Path, source: random.Random, folder: Path, seconds: float) -> str | None:
    """A run like the one that took `seconds`, killed at any moment of it and resumed: the same bits, or how it broke."""
    (folder / "case.h5").rename(folder / "reference.h5")
    arguments = [program, "case.nml", "--quiet", "--set", "output.checkpoint_interval=0.0"]
    with contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(arguments, check=False, cwd=folder, timeout=seconds * source.random(), capture_output=True)
    run = call(program, folder, *arguments[1:], "--resume", limits={resource.RLIMIT_CPU: LIMIT})
    paths = [] if run.trouble(0, 2) else different(folder / "reference.h5", folder / "case.h5")
    return f"resumed to other bits: {paths[:3]}" if paths else run.trouble(0, 2)


@attack("random valid cases: lines, points, histories, mixed, dry (`ASPERITY=build/bin/asperity-debug`: with traps)", 650)
def valid_cases(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice([lubricated, lubricated, point, dry])
    write_valid(program, folder, lambda: kind(source, folder))
    begin = time.monotonic()
    run = call(program, folder, "case.nml", limits={resource.RLIMIT_CPU: LIMIT})
    if run.status == -signal.SIGKILL and (run.err.rstrip().endswith("left") or " % of steps on " in run.err.splitlines()[-1]):
        return None  # long, and it said so
    found = trouble(run, folder) or run.trouble(0, 2)
    if found or "transient" not in (folder / "case.nml").read_text(encoding="utf-8"):
        return found
    return resumed(program, source, folder, time.monotonic() - begin)

"""Random dry contacts: Hertz, sinusoids, rough profiles and areas, rough bodies; unsuitable domains and grids; targets.

Truths are closed forms, or the same surface on four to eight times the nodes a side: the program resamples periodic heights by
their Fourier series, heights of an open domain are written for both grids. Members with a target for their contact area give no
number of nodes, and their truths have many; a synthetic surface keeps the series of its first grid, 8 nodes in the shortest wave,
which is read from a result on that grid and written to a file for the truth.
"""

from __future__ import annotations

import io
import math
import random
from collections.abc import Callable
from dataclasses import replace

import h5py
import numpy as np
from bench_program import run_program
from judge import Member, rounded_up
from namelists import NO_BARS, Groups, namelist

MODULUS, LENGTH = 2e11, 1e-3
PROBLEMS = ("dry_line", "dry_area")
# The same heights on both grids: a line through few of them is not one through many.
FILE = {"shape": "file", "file": "z.h5", "dataset": "z", "detrend": "none"}
PARABOLA = {"shape": "parabola"}
OPEN = {"periodic": False}
# Where a target is given: nodes a side of the truth and of first grids, and the wanted accuracy, of a line and of an area, whose
# truth must be finer by far than the grid.
FINE, TARGETS = (2**17, 2048), ((0.01, 0.05), (0.02, 0.05))
FIRST = ((64, 96, 128, 256, 512, 1024), (32, 40, 48, 56, 64))
Draw = Callable[[random.Random, int], Member]


def contact(lines: int, load: dict, surface: dict, domain: dict, bodies: dict | None = None, *, bars: bool = True) -> Groups:
    """The groups of a profile (`lines` = 1) or an area (2)."""
    return {
        "case": {"problem": PROBLEMS[lines - 1]},
        "bodies": {"reduced_modulus": MODULUS} | (bodies or {}),
        "load": load,
        "surface_1": surface,
        "domain": domain,
        "accuracy": {"error_bars": bars},
    }


def sizes(lines: int, nodes: int, length: float = LENGTH) -> dict:
    """Length and nodes of a line or of a square."""
    names = ("",) if lines == 1 else ("_x", "_y")
    return {f"length{name}": length for name in names} | {f"intervals{name}": nodes for name in names}


def resized(groups: Groups, nodes: int | None) -> Groups:
    """On so many nodes a side."""
    return groups | {"domain": {key: nodes if key.startswith("intervals") else value for key, value in groups["domain"].items()}}


def both(lines: int, nodes: int, load: dict, surface: dict, bodies: dict) -> tuple[Groups, Groups]:
    """A contact, and the same on the finer grid of a truth."""
    case = contact(lines, load, surface, sizes(lines, nodes), bodies)
    return case, resized(case, finer(lines, nodes)) | {"accuracy": NO_BARS}


def finer(lines: int, nodes: int) -> int:
    """At least eight times the nodes a side, of many nodes four times."""
    return rounded_up(nodes * (8 if nodes <= (2048, 64)[lines - 1] else 4))


def count_of(source: random.Random, lines: int, *, many: bool = False) -> int:
    """Nodes a side, even or odd; `many`: so many that the errors come from coarser grids."""
    if many:
        return round(2 ** (source.uniform(17.1, 17.45) if lines == 1 else source.uniform(7.1, 8.3)))
    return round(2 ** (source.uniform(5.5, 11) if lines == 1 else source.uniform(5, 7)))


def hertz_pressure(lines: int, half_width: float, radius: float) -> float:
    """Greatest pressure of Hertz of a contact of this half-width [Pa]."""
    return half_width * MODULUS / ((4 if lines == 1 else math.pi) * radius)


def hertz(lines: int, *, hardness: bool = False) -> Draw:
    """A parabola on an open domain, elastic with the closed forms of Hertz, or yielding."""

    def draw(source: random.Random, _: int) -> Member:
        nodes, width = count_of(source, lines), source.uniform(0.2, 0.9)
        radius = 10 ** source.uniform(-3, -1)
        peak = hertz_pressure(lines, width * LENGTH / 2, radius)
        bodies = {"reduced_radius": radius}
        if hardness:
            bodies["hardness"] = peak * source.uniform(0.7, 0.95)
        exact = {"summary/p_max": peak, "summary/contact_area_fraction": (width, math.pi * width**2 / 4)[lines - 1]}
        return Member(*both(lines, nodes, {"hertz_pressure": peak}, PARABOLA, bodies), {} if hardness else exact)

    return draw


def waves(source: random.Random, _: int) -> Member:
    """A sinusoid under a share of the load that flattens it (H. M. Westergaard, J. Appl. Mech. 6, 1939, A49)."""
    nodes, share = count_of(source, 1), source.uniform(0.03, 0.95)
    height, wave = 1e-6, LENGTH / source.randint(1, max(1, nodes // 16))
    full = math.pi * MODULUS / 2 * height / wave
    surface = {"shape": "sinusoid", "amplitude": height, "wavelength": wave, "position": source.random() * wave}
    exact = {
        "summary/contact_area_fraction": 2 / math.pi * math.asin(math.sqrt(share)),
        "summary/mean_separation": height * (1 - share * (1 - math.log(share))),
        "summary/p_max": 2 * full * math.sqrt(share),
    }
    return Member(contact(1, {"mean_pressure": share * full}, surface, sizes(1, nodes)), None, exact)


def series(source: random.Random, lines: int, nodes: int) -> np.ndarray:
    """Coefficients of a self-affine surface, rms 1, in the order of the transform, with 2 to 64 nodes in its finest wave."""
    per_wave = max(2.0, min(2 ** source.uniform(1, 6), nodes / 6))
    rng = np.random.default_rng(source.getrandbits(32))
    numbers = np.meshgrid(*[np.fft.fftfreq(nodes, 1 / nodes)] * lines, indexing="ij")
    wave_numbers = np.sqrt(sum(number**2 for number in numbers))
    most = nodes / per_wave
    rolloff, hurst = source.uniform(1, max(1.01, min(8, most / 2))), source.uniform(0.3, 1)
    keep = (wave_numbers >= 1) & (wave_numbers <= most * (1 + 1e-9)) & (np.abs(numbers).max(axis=0) < nodes / 2)
    noise = np.fft.fftn(rng.standard_normal((nodes,) * lines))
    spectrum = np.where(keep, np.maximum(wave_numbers, rolloff) ** (-hurst - lines / 2), 0) * noise
    return spectrum / np.sqrt((np.abs(spectrum) ** 2).sum())


def heights(spectrum: np.ndarray, nodes: int, shift: float = 0.0) -> np.ndarray:
    """The series on so many nodes, from `shift` of the domain on along each axis."""
    full, old = spectrum, spectrum.shape[0]
    number = np.fft.fftfreq(old, 1 / old).astype(int)
    for axis in range(spectrum.ndim):
        full = np.moveaxis(full, axis, -1)
        wider = np.zeros((*full.shape[:-1], nodes), complex)
        wider[..., number % nodes] = full * np.exp(2j * np.pi * number * shift)
        full = np.moveaxis(np.fft.ifft(wider) * nodes, -1, axis)
    return full.real


def height_file(z: np.ndarray, spacings: list[float] | None = None) -> bytes:
    """A file of heights `z` with these spacings along x, and y of an area; without them on the length or the square."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        data = file.create_dataset("z", data=z)
        for i, name in enumerate(("spacing",) if z.ndim == 1 else ("spacing_x", "spacing_y")):
            data.attrs[name] = spacings[i] if spacings else LENGTH / z.shape[0]
    return buffer.getvalue()


def rough(lines: int, *, hardness: bool = False, many: bool = False) -> Draw:
    """Periodic rough surfaces with 2 to 64 nodes in the finest wave, from first contact to most of the area."""

    def draw(source: random.Random, _: int) -> Member:
        nodes = count_of(source, lines, many=many)
        z = 1e-6 * heights(series(source, lines, nodes), nodes)
        slope = math.sqrt(sum(((np.roll(z, -1, a) - z) ** 2).mean() for a in range(lines))) / (LENGTH / nodes)
        pressure = MODULUS / 2 * slope * 10 ** source.uniform(-2.3, -0.3)
        bodies = {}
        if hardness:
            bodies = {"hardness": max(MODULUS / 2 * slope * 10 ** source.uniform(-1.3, -0.3), 1.3 * pressure)}
        return Member(*both(lines, nodes, {"mean_pressure": pressure}, FILE, bodies), files={"z.h5": height_file(z)})

    return draw


def body(source: random.Random, lines: int, half_width: float) -> tuple[dict, dict, float]:
    """Load and bodies of a parabola of roughness height 1e-6 on an open domain, half of them yielding; its radius."""
    radius = half_width**2 / (2e-6 * 10 ** source.uniform(0.5, 1.7))
    peak = hertz_pressure(lines, half_width, radius)
    mean = peak * half_width * math.pi / 2 / LENGTH if lines == 1 else 2 / 3 * math.pi * peak * half_width**2 / LENGTH**2
    hardness = {"hardness": peak * 10 ** source.uniform(-0.1, 0.7)} if source.random() < 0.5 else {}
    return {"mean_pressure": mean}, hardness, radius


def rough_body(lines: int, *, many: bool = False) -> Draw:
    """A rough parabola on an open domain, elastic or yielding."""

    def draw(source: random.Random, _: int) -> Member:
        nodes = count_of(source, lines, many=many)
        spectrum = 1e-6 * series(source, lines, nodes)
        load, hardness, radius = body(source, lines, source.uniform(0.3, 0.7) * LENGTH / 2)
        files, cases = {}, []
        for name, n in (("z.h5", nodes), ("fine.h5", finer(lines, nodes))):
            x = ((np.arange(n) + 0.5) / n - 0.5) * LENGTH
            square = sum(g**2 for g in np.meshgrid(*[x] * lines))
            # Cell centres begin half a cell from the border; the series is that of the domain.
            files[name] = height_file(heights(spectrum, n, 0.5 / n) - square / (2 * radius))
            cases.append(contact(lines, load, FILE | {"file": name}, OPEN, hardness, bars=name == "z.h5"))
        return Member(*cases, files=files)

    return draw


def too_small(source: random.Random, _: int) -> Member:
    """Open domains that end inside the contact, known before the run or only after it."""
    lines, nodes, radius = source.randint(1, 2), source.randint(32, 128), 10 ** source.uniform(-3, -1)
    half_width = LENGTH / 2 * source.uniform(1.02, 3)
    load, bodies = {"hertz_pressure": hertz_pressure(lines, half_width, radius)}, {"reduced_radius": radius}
    case = contact(lines, load, PARABOLA, sizes(lines, nodes), bodies)
    if source.random() < 0.5:
        case["surface_2"] = {"shape": "synthetic", "rms_height": half_width**2 / radius / 200, "wavelength_short": 1e-4}
    return Member(case, contact(lines, load, PARABOLA, sizes(lines, 512 // lines, 3 * half_width), bodies, bars=False))


def boxed(source: random.Random, _: int) -> Member:
    """Parabolas in a box, said to be periodic or not said: a single contact is the truth."""
    lines, radius, width = source.randint(1, 2), 10 ** source.uniform(-3, -1), source.uniform(0.2, 0.6)
    peak = hertz_pressure(lines, width * LENGTH / 2, radius)
    said = source.choice(({}, {"periodic": True}))
    domain = sizes(lines, source.randint(48, 160)) | said
    case = contact(lines, {"hertz_pressure": peak}, PARABOLA, domain, {"reduced_radius": radius})
    return Member(case, None, {"summary/p_max": peak})


def aim(source: random.Random, member: Member) -> Member:
    """A contact with a target, the number of nodes left to the program; the truth on the same fine grid for all."""
    k = PROBLEMS.index(member.case["case"]["problem"])
    least, most = TARGETS[k]
    target = least * (most / least) ** source.random()
    case = resized(member.case, None) | {"accuracy": {"target": target}}
    return replace(member, case=case, truth=member.truth and resized(member.truth, FINE[k]), target=target)


def synthetic(source: random.Random, nodes: int) -> tuple[dict, dict, dict]:
    """A synthetic surface with 8 of these nodes in its shortest wave, a load and bodies."""
    shortest, rolloff = 8 * LENGTH / nodes, LENGTH / source.uniform(1, 4)
    surface = {"shape": "synthetic", "seed": source.randint(1, 10**6), "rms_height": 1e-6, "hurst": source.uniform(0.3, 1)}
    surface |= {"wavelength_short": shortest, "wavelength_rolloff": rolloff}
    if source.random() < 0.3:
        surface |= {"skewness": source.uniform(-0.5, 0.3), "kurtosis": 3.3}
    # About the rms slope times E'/2.
    slope = 2 * math.pi * 1e-6 / math.sqrt(rolloff * shortest)
    load = MODULUS / 2 * slope * 10 ** source.uniform(-1.5, -0.3)
    hardness = max(MODULUS / 2 * slope * 10 ** source.uniform(-1, -0.3), 1.3 * load)
    return surface, {"mean_pressure": load}, {"hardness": hardness} if source.random() < 0.4 else {}


def solved_heights(lines: int, nodes: int, surface: dict) -> np.ndarray:
    """The heights of a synthetic surface on so many nodes [m]."""
    case = contact(lines, {"mean_pressure": 1.0}, surface, sizes(lines, nodes), bars=False)
    return run_program(namelist(case), lambda file: file["solution/height_undeformed"][()]).found


def synthetic_surface(lines: int, *, in_file: bool = False) -> Draw:
    """Periodic surfaces from a seed, or in a file: of areas with few waves, others need more nodes than a truth has."""

    def draw(source: random.Random, _: int) -> Member:
        nodes = source.choice(FIRST[lines - 1])
        surface, load, bodies = synthetic(source, nodes)
        case = contact(lines, load, FILE if in_file else surface, sizes(lines, nodes), bodies)
        files = {"z.h5": height_file(solved_heights(lines, nodes, surface))}
        return aim(source, Member(case, case | {"surface_1": FILE, "accuracy": NO_BARS}, files=files))

    return draw


def synthetic_body(lines: int) -> Draw:
    """A parabola with roughness from a seed, on an open domain."""

    def draw(source: random.Random, _: int) -> Member:
        nodes, half_width = source.choice(FIRST[lines - 1]), source.uniform(0.3, 0.7) * LENGTH / 2
        surface, _, _ = synthetic(source, nodes)
        load, hardness, radius = body(source, lines, half_width)
        case = contact(lines, load, surface, sizes(lines, nodes) | OPEN, {"reduced_radius": radius} | hardness)
        case["surface_2"] = PARABOLA
        z = solved_heights(lines, nodes, surface)
        # the centres of the cells of the fine grid begin half a cell of the first one earlier
        fine = FINE[lines - 1]
        files = {"z.h5": height_file(heights(np.fft.fftn(z) / z.size, fine, 0.5 / fine - 0.5 / nodes))}
        return aim(source, Member(case, case | {"surface_1": FILE, "accuracy": NO_BARS}, files=files))

    return draw


yielding = rough(1, hardness=True)

"""Dry contacts: Hertz, sinusoids, rough profiles and areas, rough bodies on an open half-space; domains and grids that do not fit.

Truths are closed forms, or the same surface on four to eight times the nodes a side: the program resamples periodic heights by
their Fourier series, heights of an open domain are written for both grids.
"""

from __future__ import annotations

import io
import math
import random

import h5py
import numpy as np
from families import Family, Member

MODULUS, LENGTH = 2e11, 1e-3
FIGURES = ("summary/contact_area_fraction", "summary/mean_separation", "summary/p_max")
PLASTIC = ("summary/contact_area_fraction", "summary/plastic_area_fraction", "summary/mean_separation", "sweep/dp_mean")
# The same heights on both grids: a line through few of them is not one through many.
FILE = "shape = 'file', file = 'z.h5', dataset = 'z', detrend = 'none'"
CASE = """&case problem = '{problem}' /
&bodies reduced_modulus = {modulus!r}{bodies} /
&load {load} /
&surface_1 {surface} /
&domain {domain} /
&accuracy error_bars = {bars} /
"""


def text(lines: int, load: str, surface: str, domain: str, *, bodies: str = "", bars: bool = True) -> str:
    """A namelist of a profile (`lines` = 1) or an area (2)."""
    return CASE.format(
        problem=("dry_line", "dry_area")[lines - 1],
        modulus=MODULUS,
        bodies=bodies,
        load=load,
        surface=surface,
        domain=domain,
        bars=".true." if bars else ".false.",
    )


def sizes(lines: int, nodes: int, length: float = LENGTH, more: str = "") -> str:
    """Length and nodes of a line or of a square."""
    names = ("",) if lines == 1 else ("_x", "_y")
    return ", ".join(f"length{name} = {length!r}, intervals{name} = {nodes}" for name in names) + more


def count_of(source: random.Random, lines: int, *, many: bool = False) -> int:
    """Nodes a side, even or odd; `many`: so many that the errors come from coarser grids."""
    if many:
        return round(2 ** (source.uniform(17.1, 17.45) if lines == 1 else source.uniform(7.1, 8.3)))
    return round(2 ** (source.uniform(5.5, 11) if lines == 1 else source.uniform(5, 7)))


def finer(lines: int, nodes: int) -> int:
    """Nodes a side of the truth: at least eight times as many, of many nodes four times; 4 to 7 times a power of two."""
    wanted = nodes * (8 if nodes <= (2048, 64)[lines - 1] else 4)
    power = 2 ** math.floor(math.log2(wanted / 4))
    return power * math.ceil(wanted / power)


def hertz_pressure(lines: int, half_width: float, radius: float) -> float:
    """Greatest pressure of Hertz of a contact of this half-width [Pa]."""
    return half_width * MODULUS / ((4 if lines == 1 else math.pi) * radius)


def hertz(lines: int, hardness: bool):
    """A parabola on an open domain, elastic with the closed forms of Hertz, or yielding."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            nodes, width = count_of(source, lines), source.uniform(0.2, 0.9)
            radius, half_width = 10 ** source.uniform(-3, -1), width * LENGTH / 2
            peak = hertz_pressure(lines, half_width, radius)
            bodies = f", reduced_radius = {radius!r}"
            if hardness:
                bodies += f", hardness = {peak * source.uniform(0.7, 0.95)!r}"
            exact = {"summary/p_max": peak, "summary/contact_area_fraction": (width, math.pi * width**2 / 4)[lines - 1]}
            case, truth = (
                text(lines, f"hertz_pressure = {peak!r}", "shape = 'parabola'", sizes(lines, n), bodies=bodies, bars=bars)
                for n, bars in ((nodes, True), (finer(lines, nodes), False))
            )
            found.append(Member(f"{i:03d}", case, truth, {} if hardness else exact))
        return found

    return draw


def waves(source: random.Random, count: int) -> list[Member]:
    """A sinusoid under a share of the load that flattens it (H. M. Westergaard, J. Appl. Mech. 6, 1939, A49)."""
    found = []
    for i in range(count):
        nodes, share = count_of(source, 1), source.uniform(0.03, 0.95)
        number = source.randint(1, max(1, nodes // 16))
        height, wave = 1e-6, LENGTH / number
        full = math.pi * MODULUS / 2 * height / wave
        surface = f"shape = 'sinusoid', amplitude = {height!r}, wavelength = {wave!r}, position = {source.random() * wave!r}"
        exact = {
            "summary/contact_area_fraction": 2 / math.pi * math.asin(math.sqrt(share)),
            "summary/mean_separation": height * (1 - share * (1 - math.log(share))),
            "summary/p_max": 2 * full * math.sqrt(share),
        }
        found.append(Member(f"{i:03d}", text(1, f"mean_pressure = {share * full!r}", surface, sizes(1, nodes)), "", exact))
    return found


def series(source: random.Random, lines: int, nodes: int, per_wave: float) -> np.ndarray:
    """Coefficients of a self-affine surface, rms 1, in the order of the transform, with so many nodes in its finest wave."""
    rng = np.random.default_rng(source.getrandbits(32))
    numbers = np.meshgrid(*[np.fft.fftfreq(nodes, 1 / nodes)] * lines, indexing="ij")
    waves = np.sqrt(sum(number**2 for number in numbers))
    most = nodes / per_wave
    rolloff, hurst = source.uniform(1, max(1.01, min(8, most / 2))), source.uniform(0.3, 1)
    keep = (waves >= 1) & (waves <= most * (1 + 1e-9)) & (np.abs(numbers).max(axis=0) < nodes / 2)
    spectrum = np.where(keep, np.maximum(waves, rolloff) ** (-hurst - lines / 2), 0) * np.fft.fftn(
        rng.standard_normal((nodes,) * lines)
    )
    return spectrum / np.sqrt((np.abs(spectrum) ** 2).sum())


def heights(spectrum: np.ndarray, nodes: int, *, centres: bool = False) -> np.ndarray:
    """The series on so many nodes; at the centres of their cells, or from 0 on."""
    full, old = spectrum, spectrum.shape[0]
    for axis in range(spectrum.ndim):
        number = np.fft.fftfreq(old, 1 / old).astype(int)
        wider = np.zeros((*full.shape[:axis], nodes, *full.shape[axis + 1 :]), complex)
        turned = full * np.exp(1j * np.pi * number / nodes * centres).reshape((-1,) + (1,) * (full.ndim - 1 - axis))
        np.moveaxis(wider, axis, 0)[number % nodes] = np.moveaxis(turned, axis, 0)
        full = np.fft.ifft(wider, axis=axis) * nodes
    return full.real


def height_file(z: np.ndarray, spacings: list[float]) -> bytes:
    """A file of heights `z` with these spacings along x, and y of an area."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w") as file:
        data = file.create_dataset("z", data=z)
        for name, spacing in zip(("spacing",) if z.ndim == 1 else ("spacing_x", "spacing_y"), spacings, strict=True):
            data.attrs[name] = spacing
    return buffer.getvalue()


def hdf5(z: np.ndarray) -> bytes:
    """A file of heights on the length or the square."""
    return height_file(z, [LENGTH / z.shape[0]] * z.ndim)


def nodes_per_wave(source: random.Random, nodes: int) -> float:
    """2 to 64, at least a few waves on the domain."""
    return max(2.0, min(2 ** source.uniform(1, 6), nodes / 6))


def rough(lines: int, hardness: bool, *, many: bool = False):
    """Periodic rough surfaces with 2 to 64 nodes in the finest wave, from first contact to most of the area."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            nodes = count_of(source, lines, many=many)
            z = 1e-6 * heights(series(source, lines, nodes, nodes_per_wave(source, nodes)), nodes)
            slope = math.sqrt(sum(((np.roll(z, -1, a) - z) ** 2).mean() for a in range(lines))) / (LENGTH / nodes)
            pressure = MODULUS / 2 * slope * 10 ** source.uniform(-2.3, -0.3)
            bodies = ""
            if hardness:
                bodies = f", hardness = {max(MODULUS / 2 * slope * 10 ** source.uniform(-1.3, -0.3), 1.3 * pressure)!r}"
            case, truth = (
                text(lines, f"mean_pressure = {pressure!r}", FILE, sizes(lines, n), bodies=bodies, bars=bars)
                for n, bars in ((nodes, True), (finer(lines, nodes), False))
            )
            found.append(Member(f"{i:03d}", case, truth, files={"z.h5": hdf5(z)}))
        return found

    return draw


def rough_body(lines: int, *, many: bool = False):
    """A rough parabola on an open domain, elastic or yielding."""

    def draw(source: random.Random, count: int) -> list[Member]:
        found = []
        for i in range(count):
            nodes = count_of(source, lines, many=many)
            spectrum = 1e-6 * series(source, lines, nodes, nodes_per_wave(source, nodes))
            half_width = source.uniform(0.3, 0.7) * LENGTH / 2
            radius = half_width**2 / (2e-6 * 10 ** source.uniform(0.5, 1.7))
            peak = hertz_pressure(lines, half_width, radius)
            mean = peak * half_width * math.pi / 2 / LENGTH if lines == 1 else 2 / 3 * math.pi * peak * half_width**2 / LENGTH**2
            bodies = f", hardness = {peak * 10 ** source.uniform(-0.1, 0.7)!r}" if source.random() < 0.5 else ""
            files, cases = {}, []
            for name, n in (("z.h5", nodes), ("fine.h5", finer(lines, nodes))):
                x = ((np.arange(n) + 0.5) / n - 0.5) * LENGTH
                square = sum(g**2 for g in np.meshgrid(*[x] * lines))
                # Cell centres begin half a cell from the border; the series is that of the domain.
                files[name] = hdf5(heights(spectrum, n, centres=True) - square / (2 * radius))
                surface = f"shape = 'file', file = '{name}', dataset = 'z', detrend = 'none'"
                domain = "periodic = .false."
                cases.append(text(lines, f"mean_pressure = {mean!r}", surface, domain, bodies=bodies, bars=name == "z.h5"))
            found.append(Member(f"{i:03d}", *cases, files=files))
        return found

    return draw


def too_small(source: random.Random, count: int) -> list[Member]:
    """Open domains that end inside the contact, known before the run or only after it."""
    found = []
    for i in range(count):
        lines, nodes, radius = source.randint(1, 2), source.randint(32, 128), 10 ** source.uniform(-3, -1)
        half_width = LENGTH / 2 * source.uniform(1.02, 3)
        peak = hertz_pressure(lines, half_width, radius)
        bodies = f", reduced_radius = {radius!r}"
        load = f"hertz_pressure = {peak!r}"
        case = text(lines, load, "shape = 'parabola'", sizes(lines, nodes), bodies=bodies)
        if source.random() < 0.5:
            case += f"&surface_2 shape = 'synthetic', rms_height = {half_width**2 / radius / 200!r}, wavelength_short = 1e-4 /\n"
        truth = text(lines, load, "shape = 'parabola'", sizes(lines, 512 // lines, 3 * half_width), bodies=bodies, bars=False)
        found.append(Member(f"{i:03d}", case, truth))
    return found


def boxed(source: random.Random, count: int) -> list[Member]:
    """Parabolas in a box, said to be periodic or not said: a single contact is the truth."""
    found = []
    for i in range(count):
        lines, radius, width = source.randint(1, 2), 10 ** source.uniform(-3, -1), source.uniform(0.2, 0.6)
        peak = hertz_pressure(lines, width * LENGTH / 2, radius)
        said = source.choice(("", ", periodic = .true."))
        domain = sizes(lines, source.randint(48, 160), more=said)
        case = text(lines, f"hertz_pressure = {peak!r}", "shape = 'parabola'", domain, bodies=f", reduced_radius = {radius!r}")
        found.append(Member(f"{i:03d}", case, "", {"summary/p_max": peak}))
    return found


FAMILIES = [
    Family("dry_hertz_line", "Hertz, line", FIGURES, hertz(1, hardness=False), 48),
    Family("dry_hertz_area", "Hertz, point", FIGURES, hertz(2, hardness=False)),
    Family("dry_waves", "Sinusoids", FIGURES, waves, 48),
    Family("dry_line", "Rough profiles, periodic, elastic", FIGURES, rough(1, hardness=False), 96),
    Family("dry_area", "Rough areas, periodic, elastic", FIGURES, rough(2, hardness=False), 96),
    Family("dry_open_line", "Rough rollers, open", FIGURES, rough_body(1), 96),
    Family("dry_open_area", "Rough balls, open", FIGURES, rough_body(2), 96),
    Family("dry_plastic_line", "Rough profiles that yield", PLASTIC, rough(1, hardness=True), 48),
    Family("dry_plastic_area", "Rough areas that yield", PLASTIC, rough(2, hardness=True), 96),
    Family("dry_plastic_ball", "A ball that yields", PLASTIC, hertz(2, hardness=True), 48),
    Family("dry_many_line", "Rough profiles of 140 to 180 thousand nodes", FIGURES, rough(1, hardness=False, many=True), 40),
    Family("dry_many_area", "Rough areas of 137 to 315 nodes a side", FIGURES, rough(2, hardness=False, many=True), 60),
    Family("dry_many_open_area", "Rough balls, as many", FIGURES, rough_body(2, many=True), 60),
    Family("dry_many_plastic_area", "Rough areas that yield, as many", PLASTIC, rough(2, hardness=True, many=True), 144),
    Family("dry_too_small", "Open domains inside the contact", ("summary/p_max",), too_small),
    Family("dry_boxed", "Parabolas in a box", ("summary/p_max",), boxed),
]

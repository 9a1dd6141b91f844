"""Harmonic waviness in a Newtonian line contact: the cases in SI, and the complex ratio of deformed to initial amplitude.

Moes numbers M and L count with the sum of the speeds, as Venner and Lubrecht do. The waviness is on surface 1, which moves at
v = 1 - s/2 half-widths per unit of T; s = 2 (u2 - u1)/(u1 + u2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np
from study import Case, Runner, base_case, changed

OUTLET = 1.5
FLUSHED = 5.0  # T after which what was in the contact at T = 0 has left it
PHASES = 16  # positions of a waviness that stands still
HARMONICS = 4
INSIDE = 0.5  # |X| where the film is taken apart into its two waves
ALPHA, P0, MU_0 = 2.2e-8, 1.96e8, 0.04  # Venner, Couhier, Lubrecht and Greenwood (1997): z = 0.6684


@dataclass(frozen=True)
class Waviness:
    """One run; wavelength in half-widths, amplitude over the smooth central film, grid."""

    moes_m: float = 100.0
    moes_l: float = 11.0
    wavelength: float = 1.0
    slip: float = 0.0
    amplitude: float = 0.1
    intervals: int = 1024
    inlet: float = -2.5

    @property
    def spacing(self) -> float:
        """dX."""
        return (OUTLET - self.inlet) / self.intervals

    @property
    def nodes(self) -> float:
        """Intervals on the shorter of the wave on the surface and the wave that the oil carries."""
        return self.wavelength / max(1.0, self.speed) / self.spacing

    @property
    def speed(self) -> float:
        """Half-widths per unit of T at which the waviness moves."""
        return 1 - self.slip / 2

    @property
    def nabla(self) -> float:
        """Abscissa of the master curve, (Lambda/b) M^(3/4) L^(-1/2)."""
        return self.wavelength * self.moes_m**0.75 / math.sqrt(self.moes_l)

    @property
    def name(self) -> str:
        """Name of its files."""
        values = (self.moes_m, self.moes_l, self.wavelength, self.slip, self.amplitude, self.intervals, self.inlet)
        return "w" + "_".join(f"{value:.5g}" for value in values)

    def finer(self, factor: float) -> Waviness:
        """The same on another grid, and with the step that goes with it."""
        return replace(self, intervals=round(self.intervals * factor))

    def operating_point(self) -> tuple[dict[str, object], float, float]:
        """Bodies, Hertz pressure and half-width that belong to M and L."""
        bodies = base_case("rolling_sinusoid")["bodies"]
        radius, modulus = bodies["reduced_radius"], bodies["reduced_modulus"]
        pressure = self.moes_l * math.sqrt(self.moes_m / (2 * math.pi)) / ALPHA
        speed_sum = (self.moes_l / (ALPHA * modulus)) ** 4 * modulus * radius / MU_0
        half_width = 4 * radius * pressure / modulus
        speeds = {"speed_1": speed_sum / 2 * self.speed, "speed_2": speed_sum / 2 * (2 - self.speed)}
        return {**bodies, **speeds}, pressure, half_width

    def cases(self, central_film: float) -> dict[str, Case]:
        """The run, or one for each phase when the waviness stands still; `central_film` in b^2/R."""
        bodies, pressure, half_width = self.operating_point()
        height = self.amplitude * central_film * half_width**2 / bodies["reduced_radius"]
        surface = {"shape": "sinusoid", "amplitude": height, "wavelength": self.wavelength * half_width, "position": 0.0}
        base = changed(base_case("rolling_sinusoid"), bodies=bodies, load={"hertz_pressure": pressure}, domain=self.domain())
        if self.speed == 0:
            steady = changed(base, time=None, output=None)
            places = [phase * self.wavelength / PHASES for phase in range(PHASES)]
            return {f"{self.name}_{i}": changed(steady, surface_1={**surface, "position": x}) for i, x in enumerate(places)}
        period = self.wavelength / self.speed
        per_period = 16 * math.ceil(period * max(1.0, self.speed) / self.spacing / 16)
        periods = math.ceil(FLUSHED / period) + 2
        time = {"end_time": periods * period, "time_step": period / per_period, "scheme": "bdf2"}
        output = {"fields": "film_thickness", "profile_stride": per_period // 16}
        return {self.name: changed(base, surface_1=surface, time=time, output=output)}

    def smooth(self) -> Case:
        """The contact without waviness."""
        bodies, pressure, _ = self.operating_point()
        base = changed(base_case("rolling_sinusoid"), surface_1=None, time=None, output=None)
        return changed(base, bodies=bodies, load={"hertz_pressure": pressure}, domain=self.domain())

    def domain(self) -> dict[str, object]:
        """The group &domain."""
        return {"x_inlet": self.inlet, "x_outlet": OUTLET, "intervals": self.intervals}


def compressed(run: Waviness, film: float) -> float:
    """What flattening a waviness leaves because the oil gives way: h_c k d(ln rho)/dP at P = 1, with P = k A flattening it."""
    pressure = run.operating_point()[1]
    c1, c2 = 5.9e8, 1.34  # Dowson and Higginson
    softness = (c2 - 1) * c1 / ((c1 + pressure) * (c1 + c2 * pressure)) * pressure
    return film * 2 * math.pi / run.wavelength * softness


@dataclass(frozen=True)
class Response:
    """What the waviness leaves in the film.

    `ratio` is the complex ratio of the first harmonic at X = 0 to the waviness (1: undeformed), `swing` half of largest minus
    smallest H(0, T) over the amplitude, `second` the second harmonic over the first. `in_place` and `carried` are the parts that
    move with the surface and with the mean speed of the oil, `misfit` what these two leave unexplained; `drift` is the change of
    the ratio over the last period, `h_min` the smallest H near the centre over the smooth central film, `film` the latter [b^2/R].
    """

    ratio: complex
    swing: float
    second: float
    in_place: complex
    carried: complex
    misfit: float
    drift: float
    h_min: float
    film: float


def harmonics(phase: np.ndarray, film: np.ndarray) -> np.ndarray:
    """Complex amplitudes c_k of H = Re sum c_k exp(i k phase), k = 0 ... HARMONICS, for every column of `film`."""
    columns = [np.ones_like(phase)]
    for k in range(1, HARMONICS + 1):
        columns += [np.cos(k * phase), -np.sin(k * phase)]
    fitted = np.linalg.lstsq(np.column_stack(columns), film, rcond=None)[0]
    return np.concatenate((fitted[:1] + 0j, fitted[1::2] + 1j * fitted[2::2]))


def read_moving(_: str, path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """X, time, film over time, and the smallest film."""
    with h5py.File(path) as file:
        x, series = file["solution/x"][()], file["transient"]
        return x, series["time"][()], series["film_thickness"][()], float(series["h_min"][()].min())


def read_steady(_: str, path: Path) -> tuple[np.ndarray, np.ndarray, float]:
    """X, film and the smallest film of a steady run."""
    with h5py.File(path) as file:
        x, film = file["solution/x"][()], file["solution/film_thickness"][()]
    return x, film, float(film.min())


def run_all(runner: Runner, runs: list[Waviness]) -> dict[Waviness, Response]:
    """All responses; the smooth contacts are run first, for the amplitudes."""
    points = {(run.moes_m, run.moes_l): Waviness(run.moes_m, run.moes_l, intervals=2048) for run in runs}
    smooth = runner.run({f"smooth_{i}": point.smooth() for i, point in enumerate(points.values())}, read_steady)
    films = {key: float(np.interp(0.0, *result[:2])) for key, result in zip(points, smooth.values(), strict=True)}
    cases, heights = {}, {}
    for run in sorted(runs, key=lambda item: -item.intervals):
        film = films[run.moes_m, run.moes_l]
        cases |= run.cases(film)
        heights[run] = run.amplitude * film
    found = runner.run(cases, read_any)
    return {run: from_results(run, heights[run], found) for run in runs}


def read_any(name: str, path: Path) -> tuple:
    """A steady or a transient result."""
    with h5py.File(path) as file:
        is_transient = "transient" in file
    return read_moving(name, path) if is_transient else read_steady(name, path)


def from_results(run: Waviness, height: float, found: dict[str, tuple]) -> Response:
    """The response of one run; a waviness that stands still has a result for each phase."""
    if run.speed == 0:
        results = [found[f"{run.name}_{i}"] for i in range(PHASES)]
        phase = 2 * math.pi * np.arange(PHASES) / PHASES
        return response(run, height, results[0][0], phase, np.array([film for _, film, _ in results]))
    x, time, film, _ = found[run.name]
    return response(run, height, x, 2 * math.pi * run.speed * time / run.wavelength, film)


def at_centre(x: np.ndarray, values: np.ndarray) -> complex:
    """Linear interpolation to X = 0."""
    return complex(np.interp(0.0, x, values.real), np.interp(0.0, x, values.imag))


def response(run: Waviness, height: float, x: np.ndarray, phase: np.ndarray, film: np.ndarray) -> Response:
    """Takes the last two periods of a film apart; `phase` is 2 pi v T/Lambda, `height` the amplitude in b^2/R."""
    wave = 2 * math.pi / run.wavelength
    near = np.flatnonzero(np.abs(x) <= INSIDE + 0.1)
    x, film = x[near], film[:, near]
    last = phase > phase[-1] - 2 * math.pi * (1 + 1e-9)
    if phase[-1] > 4 * math.pi:
        before = (phase > phase[-1] - 4 * math.pi * (1 + 1e-9)) & (phase <= phase[-1] - 2 * math.pi * (1 - 1e-9))
        earlier = at_centre(x, harmonics(phase[before], film[before])[1])
    else:
        earlier = None
    found = harmonics(phase[last], film[last])
    centre = [at_centre(x, values) for values in found]
    turn = np.linspace(0, 2 * math.pi, 721)
    course = sum((c * np.exp(1j * k * turn)).real for k, c in enumerate(centre[1:], start=1))
    inside = np.abs(x) <= INSIDE
    waves = np.column_stack([np.exp(-1j * wave * x[inside]), np.exp(-1j * wave * run.speed * x[inside])])
    if run.speed == 1:
        waves = waves[:, :1]
    parts, *_ = np.linalg.lstsq(waves, -found[1][inside] / height, rcond=None)
    rest = np.abs(waves @ parts + found[1][inside] / height).max()
    return Response(
        ratio=-centre[1] / height,
        swing=float((course.max() - course.min()) / 2 / height),
        second=float(abs(centre[2]) / abs(centre[1])),
        in_place=complex(parts[0]),
        carried=complex(parts[1]) if len(parts) > 1 else 0j,
        misfit=float(rest),
        drift=float("nan") if earlier is None else abs(earlier - centre[1]) / height,
        h_min=float(film[last].min()) * run.amplitude / height,
        film=height / run.amplitude,
    )

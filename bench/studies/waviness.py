"""Harmonic waviness in a Newtonian line contact: the cases in SI, and the complex ratio of deformed to initial amplitude.

Moes numbers M and L count with the sum of the speeds, as Venner and Lubrecht do. The waviness is on surface 1, which moves at
v = 1 - s/2 half-widths per unit of T; s = 2 (u2 - u1)/(u1 + u2).
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np
from linear_response import C1, C2, Advection, LinearFilm, Smooth, linear_film, read_smooth
from study import Case, Runner, base_case, changed

OUTLET = 1.5
FLUSHED = 5.0  # T after which what was in the contact has left it
PHASES = 16  # positions of a waviness that stands still
HARMONICS = 4
INSIDE = 0.5  # |X| where the film is taken apart into its two waves
ALPHA, P0, MU_0 = 2.2e-8, 1.96e8, 0.04  # Venner, Couhier, Lubrecht and Greenwood (1997): z = 0.6684


@dataclass(frozen=True)
class Waviness:
    """One run; wavelength in half-widths, amplitude over the smooth central film, grid, steps of time in dX.

    `entry` = 0: the waviness covers the whole domain from T = 0; else it enters from the inlet and rises over this length.
    """

    moes_m: float = 100.0
    moes_l: float = 11.0
    wavelength: float = 1.0
    slip: float = 0.0
    amplitude: float = 0.1
    intervals: int = 1024
    inlet: float = -2.5
    entry: float = 0.0
    scheme: str = "bdf2"
    steps: int = 1
    space: str = "upwind2"

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
        values = (self.moes_m, self.moes_l, self.wavelength, self.slip, self.amplitude, self.intervals, self.inlet, self.entry)
        return "w" + "_".join(f"{value:.5g}" for value in values) + f"_{self.scheme}_{self.steps}_{self.space}"

    @property
    def steps_in_period(self) -> int:
        """Steps of time in a period, a multiple of 16: dT is at most dX/`steps`, and that over v for a faster surface."""
        return 16 * math.ceil(self.steps * self.wavelength / min(1.0, self.speed) / self.spacing / 16 - 1e-9)

    @property
    def time_step(self) -> float:
        """dT; 0 for a waviness that stands still."""
        return self.wavelength / self.speed / self.steps_in_period if self.speed > 0 else 0.0

    @property
    def entry_time(self) -> float:
        """T until the waviness is whole up to X = -1, where the oil takes over what it carries."""
        return (-1 - self.inlet + self.entry) / self.speed if self.entry > 0 else 0.0

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
        if self.entry > 0:
            surface["entry_length"] = self.entry
        base = changed(base_case("rolling_sinusoid"), bodies=bodies, load={"hertz_pressure": pressure}, domain=self.domain())
        base = changed(base, solver={"space_scheme": self.space})
        if self.speed == 0:
            steady = changed(base, time=None, output=None)
            places = [phase * self.wavelength / PHASES for phase in range(PHASES)]
            return {f"{self.name}_{i}": changed(steady, surface_1={**surface, "position": x}) for i, x in enumerate(places)}
        period, per_period = self.wavelength / self.speed, self.steps_in_period
        periods = math.ceil((FLUSHED + self.entry_time) / period) + 2
        time = {"end_time": periods * period, "time_step": period / per_period, "scheme": self.scheme}
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
    softness = (C2 - 1) * C1 / ((C1 + pressure) * (C1 + C2 * pressure)) * pressure
    return film * 2 * math.pi / run.wavelength * softness


@dataclass(frozen=True)
class Response:
    """What the waviness leaves in the film.

    `ratio` is the complex ratio of the first harmonic at X = 0 to the waviness (1: undeformed), `swing` half of largest minus
    smallest H(0, T) over the amplitude, `second` the second harmonic over the first; `drift` is the change of the ratio over the
    last period, `h_min` the smallest H near the centre over the smooth central film.
    """

    ratio: complex
    swing: float
    second: float
    drift: float
    h_min: float


@dataclass(frozen=True)
class Parts:
    """A film of linear response as two waves: the part that moves with the surface, and the one that the oil carries.

    `in_place` and `carried` are their complex amplitudes at X = 0 (in pure rolling they are one, `carried`), `misfit` is what they
    leave unexplained, largest for |X| <= 0.5.
    """

    in_place: complex
    carried: complex
    misfit: float


def take_apart(run: Waviness, answer: LinearFilm) -> Parts:
    """Least squares over |X| <= 0.5 with the waves exp(-i k X) and exp(-i k v X)."""
    inside = np.abs(answer.x) <= INSIDE
    x, film = answer.x[inside], answer.film[inside]
    waves = np.column_stack([np.exp(-1j * answer.number * run.speed * x), np.exp(-1j * answer.number * x)])
    if run.speed == 1:
        waves = waves[:, :1]
    parts, *_ = np.linalg.lstsq(waves, film, rcond=None)
    return Parts(complex(parts[1]) if len(parts) > 1 else 0j, complex(parts[0]), float(np.abs(waves @ parts - film).max()))


def smooth_contacts(runner: Runner, runs: list[Waviness]) -> dict[Waviness, Smooth]:
    """The smooth contact of each run, to a tolerance far below what a linear response sees."""
    kinds = {run: Waviness(run.moes_m, run.moes_l, intervals=run.intervals, inlet=run.inlet) for run in runs}
    cases = {kind: changed(kind.smooth(), solver={"tolerance": 1e-9}) for kind in kinds.values()}
    found = runner.run({f"smooth_{kind.name}": case for kind, case in cases.items()}, read_smooth)
    return {run: found[f"smooth_{kind.name}"] for run, kind in kinds.items()}


def linear_films(runner: Runner, jobs: list[tuple[Waviness, Advection]]) -> dict[tuple[Waviness, Advection], LinearFilm]:
    """Linear responses with the grid and step of each run, side by side."""
    smooth = smooth_contacts(runner, [run for run, _ in jobs])

    def solve(job: tuple[Waviness, Advection]) -> LinearFilm:
        run, advection = job
        return linear_film(smooth[run], run.wavelength, advection, run.speed, run.time_step or run.spacing)

    # The largest first: all cores end at about the same time, and the memory of two large ones is there only once.
    order = sorted(jobs, key=lambda job: -job[0].intervals)
    with ThreadPoolExecutor(runner.jobs) as pool:
        return dict(zip(order, pool.map(solve, order), strict=True))


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
        return x, series["profile_time"][()], series["film_thickness"][()], float(series["h_min"][()].min())


def read_steady(_: str, path: Path) -> tuple[np.ndarray, np.ndarray, float]:
    """X, film and the smallest film of a steady run."""
    with h5py.File(path) as file:
        x, film = file["solution/x"][()], file["solution/film_thickness"][()]
    return x, film, float(film.min())


def run_all(runner: Runner, runs: list[Waviness]) -> dict[Waviness, Response]:
    """All responses by time marching; the smooth contacts are run first, for the amplitudes."""
    finest = {run: Waviness(run.moes_m, run.moes_l, intervals=2048) for run in runs}
    smooth = smooth_contacts(runner, list(finest.values()))
    films = {(run.moes_m, run.moes_l): smooth[point].central_film for run, point in finest.items()}
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
    return Response(
        ratio=-centre[1] / height,
        swing=float((course.max() - course.min()) / 2 / height),
        second=float(abs(centre[2]) / abs(centre[1])),
        drift=float("nan") if earlier is None else abs(earlier - centre[1]) / height,
        h_min=float(film[last].min()) * run.amplitude / height,
    )

"""Linear response of a smooth contact to a small waviness, in the frequency domain: no time steps, no initial state.

Psi = exp(i (omega T - k X)), k = 2 pi/Lambda, omega = v k, changes a smooth steady solution P, H by P', H' exp(i omega T). (2.57)
and (2.58) of the thesis, linearised, with m = rho H and P' = 0 where P = 0:

    d/dX( eps' dP/dX + eps dP'/dX ) - lambda (d/dX + i omega) m' = 0 ,   H' = H0' - K P'/pi - Psi ,   Int P' dX = 0

The diffusive term and the kernel K are discretised as in the program; the advective term in three ways (`Advection`).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import h5py
import numpy as np

C1, C2 = 5.9e8, 1.34  # Dowson and Higginson
NEAR = 0.6  # half-widths


class Advection(Enum):
    """Discretisation of (d/dX + d/dT) m; the first two are those of the program."""

    BDF2 = "second order upstream in X, BDF2 in T"
    EULER = "second order upstream in X, backward Euler in T"
    EXACT_TIME = "second order upstream in X, exact in T"
    CHARACTERISTIC = "second order upstream along T - X, exact for what the oil carries"

    def stencil(self, spacing: float, omega: float, step: float) -> tuple[complex, complex, complex]:
        """Factors of m(i), m(i-1), m(i-2); `step` is dT."""
        turn = np.exp(-1j * omega * step)
        if self is Advection.CHARACTERISTIC:
            turn = np.exp(-1j * omega * spacing)
            return 1.5 / spacing, -2 * turn / spacing, 0.5 * turn**2 / spacing
        rate = {
            Advection.BDF2: (3 - 4 * turn + turn**2) / (2 * step),
            Advection.EULER: (1 - turn) / step,
            Advection.EXACT_TIME: 1j * omega,
        }[self]
        return 1.5 / spacing + rate, -2 / spacing, 0.5 / spacing


@dataclass(frozen=True)
class Smooth:
    """A smooth steady solution (x, P, H) with lambda and the laws of the oil; pressures in p_h, d ln mu/dP and ln mu at nodes."""

    x: np.ndarray
    pressure: np.ndarray
    film: np.ndarray
    ln_viscosity: np.ndarray
    ln_viscosity_slope: np.ndarray
    density: np.ndarray
    density_slope: np.ndarray
    wedge: float

    @property
    def central_film(self) -> float:
        """H at X = 0."""
        return float(np.interp(0.0, self.x, self.film))


def read_smooth(_: str, path: Path) -> Smooth:
    """A steady Newtonian result of the program."""
    with h5py.File(path) as file:
        x, pressure, film = (file["solution"][name][()] for name in ("x", "pressure", "film_thickness"))
        scales, oil = file["scaling"].attrs, file["input/effective/lubricant"].attrs
        hertz, alpha = float(scales["hertz_pressure"]), float(scales["alpha_bar"])
        wedge = float(scales["lambda"])
        is_barus = oil["viscosity_law"] == b"barus"
        p0, z = (1.0, 1.0) if is_barus else (float(oil["roelands_p0"]) / hertz, float(oil["roelands_z"]))
        is_compressible = oil["density_law"] != b"constant"
    ratio = 1 + pressure / p0
    soft = (C1 / hertz, C2) if is_compressible else (1.0, 1.0)
    return Smooth(
        x=x,
        pressure=pressure,
        film=film,
        ln_viscosity=alpha * p0 / z * (ratio**z - 1),
        ln_viscosity_slope=alpha * ratio ** (z - 1),
        density=(soft[0] + soft[1] * pressure) / (soft[0] + pressure),
        density_slope=(soft[1] - 1) * soft[0] / (soft[0] + pressure) ** 2,
        wedge=wedge,
    )


def kernel(nodes: int, spacing: float) -> np.ndarray:
    """K of (2.68) by the distance of the nodes."""

    def integral(z: np.ndarray) -> np.ndarray:
        return z * (np.log(np.abs(z)) - 1)

    distance = spacing * np.arange(nodes)
    return integral(distance + spacing / 2) - integral(distance - spacing / 2)


@dataclass(frozen=True)
class LinearFilm:
    """-H' of a waviness of amplitude 1 over X, |X| < `NEAR`: undeformed it would be exp(-i k X)."""

    x: np.ndarray
    film: np.ndarray
    number: float

    def ratio(self, place: float = 0.0) -> complex:
        """Complex ratio of film to waviness at X = `place` (1: undeformed)."""
        values = self.film * np.exp(1j * self.number * self.x)
        return complex(np.interp(place, self.x, values.real), np.interp(place, self.x, values.imag))


def linear_film(smooth: Smooth, wavelength: float, advection: Advection, speed: float = 1.0, step: float = 0.0) -> LinearFilm:
    """The film of a waviness that moves at v = `speed`; `step` is dT, for the discretisations that have one."""
    x, p, h, rho = smooth.x, smooth.pressure, smooth.film, smooth.density
    spacing = float(x[1] - x[0])
    inside = np.flatnonzero(p > 0)
    number = 2 * np.pi / wavelength
    mobility = rho * h**3 * np.exp(-smooth.ln_viscosity)
    between = (mobility[1:] + mobility[:-1]) / 2
    rise = np.diff(p)
    # What a change of eps, of P in the gradient, and of m at node i + offset does to the equation of node i.
    right, left = rise[inside], rise[inside - 1]
    by_mobility = {-1: -left / 2, 0: (right - left) / 2, 1: right / 2}
    by_gradient = {-1: between[inside - 1], 0: -between[inside - 1] - between[inside], 1: between[inside]}
    advected = {-offset: factor for offset, factor in enumerate(advection.stencil(spacing, speed * number, step))}
    psi = np.exp(-1j * number * x)
    influence = kernel(x.size, spacing) / np.pi
    count = inside.size
    matrix = np.zeros((count + 1, count + 1), dtype=complex)
    rhs = np.zeros(count + 1, dtype=complex)
    for offset in (-2, -1, 0, 1):
        node = np.maximum(inside + offset, 0)
        to_mobility = by_mobility.get(offset, 0) * mobility[node] / (smooth.wedge * spacing)
        to_mass = -advected.get(offset, 0) * spacing
        to_film = 3 * to_mobility / h[node] + to_mass * rho[node]
        slope = smooth.density_slope[node]
        to_pressure = to_mobility * (slope / rho[node] - smooth.ln_viscosity_slope[node]) + to_mass * slope * h[node]
        to_pressure = to_pressure + by_gradient.get(offset, 0) / (smooth.wedge * spacing)
        matrix[:count, :count] -= to_film[:, None] * influence[np.abs(node[:, None] - inside[None, :])]
        matrix[:count, count] += to_film
        rhs[:count] += to_film * psi[node]
        column = node - inside[0]
        rows = np.flatnonzero((column >= 0) & (column < count))
        matrix[rows, column[rows]] += to_pressure[rows]
    matrix[count, :count] = spacing
    found = np.linalg.solve(matrix, rhs)
    near = np.flatnonzero(np.abs(x) < NEAR)
    film = psi[near] - found[count] + influence[np.abs(near[:, None] - inside[None, :])] @ found[:count]
    return LinearFilm(x[near], film, number)

"""Small statements of the thesis that no study needs: exponents of (2.3), squeeze of a ridge (5.9) to (5.11), section 2.7."""

import copy
import math

import asperity as package
import f90nml
import h5py
import numpy as np
import pytest
from conftest import ROOT


@pytest.fixture(autouse=True)
def use_the_program(program, monkeypatch):
    monkeypatch.setenv("ASPERITY", str(program))


CASE_1 = f90nml.read(ROOT / "input" / "case1.nml").todict()


def changed(**keys):
    """Case 1 without what takes time beside its solution, with other values: group__key = value, None to leave it out."""
    case = copy.deepcopy(CASE_1)
    case["accuracy"] = {"error_bars": False}
    case["output"] = {"adequacy": False}
    for name, value in keys.items():
        group, key = name.split("__")
        if value is None:
            case[group].pop(key)
        else:
            case[group][key] = value
    return case


def test_exponents_of_the_wavelength_parameter():
    # (2.2) is (Lambda/b) M^(3/4)/L^(1/2), with the sum of the speeds; (2.3) says how it depends on each input. Powers: exact.
    oil = {"viscosity": 0.14, "viscosity_law": "barus", "pressure_viscosity": 2e-8, "density_law": "constant"}
    bodies = {"reduced_radius": 0.01, "reduced_modulus": 2.2e11, "speed_1": 0.6, "speed_2": 0.6}
    base = {"bodies": bodies, "lubricant": oil, "load": {"load_per_length": 1e5}}

    def parameter(**factors):
        case = changed() | copy.deepcopy(base) | {"domain": {"intervals": 256}}
        for key, factor in factors.items():
            for group in ("bodies", "lubricant", "load"):
                if key in case[group]:
                    case[group][key] *= factor
        result = package.run(case)
        with h5py.File(result.path) as file:
            scaling = dict(file["scaling"].attrs)
        return scaling["moes_m_sum"] ** 0.75 / scaling["moes_l_sum"] ** 0.5 / scaling["half_width"]

    reference = parameter()
    printed = {"load_per_length": 1 / 4, "reduced_radius": -3 / 4, "reduced_modulus": -1 / 4, "viscosity": -1 / 2}
    for key, exponent in (printed | {"pressure_viscosity": -1 / 2}).items():
        assert math.log(parameter(**{key: 1.1}) / reference) / math.log(1.1) == pytest.approx(exponent, abs=1e-12), key
    both = parameter(speed_1=1.1, speed_2=1.1)
    assert math.log(both / reference) / math.log(1.1) == pytest.approx(-1 / 2, abs=1e-12)


def ridge(x, amplitude, wavelength):
    """(5.4) at the distance x from its centre."""
    return amplitude * 10 ** (-10 * (x / wavelength) ** 2) * np.cos(2 * np.pi * x / wavelength)


def printed_squeeze(x, amplitude, wavelength, speed):
    """(5.11) without the density, for xc = xs - u t as printed."""
    fall = -20 * math.log(10) * speed / wavelength * ridge(x, amplitude, wavelength) * x / wavelength
    wave = 2 * np.pi * speed / wavelength * np.sin(2 * np.pi * x / wavelength) * amplitude * 10 ** (-10 * (x / wavelength) ** 2)
    return fall - wave


def test_squeeze_of_a_moving_ridge():
    x, step = np.linspace(-1e-4, 1e-4, 401), 1e-9
    for speed in (0.1, 1.1):
        # with xc = xs - u t the distance x - xc grows by u dt; the error of the central difference is (u dt/Lambda)^2
        after, before = (ridge(x + sign * speed * step, 2e-7, 1e-4) for sign in (1, -1))
        exact = (after - before) / (2 * step)
        np.testing.assert_allclose(printed_squeeze(x, 2e-7, 1e-4, speed), exact, atol=1e-6 * np.abs(exact).max())
    # linear in the speed, and of the other sign for the ridges of the thesis, which move to +x
    slow, fast, backwards = (printed_squeeze(x, 2e-7, 1e-4, speed) for speed in (0.1, 1.1, -0.1))
    np.testing.assert_allclose(fast, 11 * slow, rtol=1e-12, atol=1e-30)
    np.testing.assert_allclose(backwards, -slow, rtol=0, atol=1e-30)


def frozen_system(result, inverse_step=0.0):
    """A, B, C of A P + B H = f, C P + H = g (2.39), frozen at a solution, at the loaded nodes; and lambda rho there."""
    with h5py.File(result.path) as file:
        value = {name: item[()] for name, item in file["solution"].items()}
        speed = file["scaling"].attrs["lambda"]
    x, dx, density = value["x"], value["x"][1] - value["x"][0], value["density"]
    mobility = density * value["film_thickness"] ** 3 * value["slip_factor"] / value["viscosity"]
    between = 0.5 * (mobility[1:] + mobility[:-1]) / dx**2
    size = x.size
    flow, wedge = np.zeros((size, size)), np.zeros((size, size))
    for i in range(2, size - 1):
        flow[i, i - 1 : i + 2] = between[i - 1], -between[i - 1] - between[i], between[i]
        wedge[i, i - 2 : i + 1] = -speed / (2 * dx) * np.array([1, -4, 3]) * density[i - 2 : i + 1]
        wedge[i, i] -= speed * density[i] * inverse_step

    def integral(a):
        return a * (np.log(np.maximum(np.abs(a), 1e-300)) - 1)

    distance = x[:, None] - x[None, :]
    kernel = (integral(distance + dx / 2) - integral(distance - dx / 2)) / np.pi
    loaded = [i for i in np.flatnonzero(value["pressure"] > 0) if 2 <= i < size - 1]
    return *(matrix[np.ix_(loaded, loaded)] for matrix in (flow, wedge, kernel)), speed * density[loaded]


@pytest.mark.parametrize(("intervals", "is_newtonian", "diverges"), [(64, False, False), (64, True, True), (256, True, True)])
def test_ordinary_jacobi(intervals, is_newtonian, diverges):
    # Papers A and B: ordinary Jacobi does not converge (A.24), (B.19). Linearised about the solution, so for small errors: true of
    # a Newtonian oil at 0.6 GPa (9.5 and 3.0 times the error in each sweep), not of Case 1, whose oil shear thins (0.991).
    oil = {"lubricant__rheology": "newtonian", "lubricant__eyring_stress": None} if is_newtonian else {}
    a, b, c, _ = frozen_system(package.run(changed(domain__intervals=intervals, **oil)))
    one, none = np.eye(len(a)), np.zeros_like(a)
    whole = np.block([[a, b], [c, one]])
    # I - D^-1 A of ordinary Jacobi and of Block-Jacobi for (2.39), H0 given
    parts = np.block([[a * one, none], [none, one]]), np.block([[a * one, b * one], [c * one, one]])
    ordinary, block = (np.linalg.eigvals(np.eye(2 * len(a)) - np.linalg.solve(part, whole)) for part in parts)
    growth = float(np.abs(ordinary).max())
    assert growth > 1.5 if diverges else growth < 1
    # Block-Jacobi needs under-relaxation, and then converges slowly, as the thesis says
    assert np.abs(block).max() > 1
    relaxed = np.abs(1 - 0.1 + 0.1 * block).max()
    assert 0.99 < relaxed < 1


def test_small_steps_magnify_errors_of_h0():
    # Section 2.7, below (2.73). Case 1, 256 intervals, frozen at its solution: dT over dX, and what an error of 1 in H0 does.
    result = package.run(changed(domain__intervals=256))
    dx, steps = 5.5 / 256, (1e9, 16, 4, 1, 0.5)
    squeeze, load, left = [], [], []
    for step in steps:
        a, b, c, mass = frozen_system(result, 1 / (step * dx))
        one = np.ones(len(a))
        squeeze.append(mass.max() / (step * dx))
        # P of the step at this H0, the film of the step before right: by how much the load is then wrong
        load.append(dx * np.linalg.solve(a - b @ c, -b @ one).sum())
        # the error is in the film of the step before, H0 of this one balances the load
        whole = np.block([[a - b @ c, (b @ one)[:, None]], [dx * one[None, :], np.zeros((1, 1))]])
        left.append(np.linalg.solve(whole, np.append(-mass / (step * dx), 0)))
    assert squeeze[4] == pytest.approx(2 * squeeze[3], rel=1e-12)
    assert squeeze[3:] == pytest.approx([7.62, 15.2], rel=0.01)
    assert load == pytest.approx([-0.189, -3.45, -5.05, -7.82, -10.4], rel=0.01)
    # such an error goes on, but it is not magnified: P is changed the less the smaller the step
    assert [np.abs(one[:-1]).max() for one in left[1:]] == pytest.approx([0.122, 0.0640, 0.0298, 0.0199], rel=0.01)
    assert [one[-1] for one in left[1:]] == pytest.approx([1] * 4, abs=0.006)


@pytest.mark.parametrize(("stress", "factor"), [(3.3e6, 1.00236), (1e6, 1.0478)])
def test_slip_factor_where_the_film_cavitates(stress, factor):
    # Section 2.7: S "will drop to zero" there and is set to 1. By (A.5) it tends to sqrt(1 + B^2), B = mu_0 (u2 - u1)/(tau_0 h).
    result = package.run(changed(lubricant__eyring_stress=stress))
    with h5py.File(result.path) as file:
        slip, pressure, film = (file["solution"][name][()] for name in ("slip_factor", "pressure", "film_thickness"))
        height = film * file["scaling"].attrs["film_thickness"]
    rest = np.flatnonzero(pressure == 0)
    rest = rest[rest > pressure.size // 2]
    np.testing.assert_allclose(slip[rest[1:]], np.sqrt(1 + (0.14 * 1.0 / (stress * height[rest[1:]])) ** 2), rtol=1e-12)
    assert slip.min() >= 1
    assert slip[rest[1]] == pytest.approx(factor, abs=1e-4)

"""The velocity of the oil across the film, /velocity: walls, flow, who may ask for it."""

import cases
import numpy as np
import pytest

LAYERS = "&output velocity_layers = 40 /\n"


@pytest.mark.path
@pytest.mark.parametrize("text", [cases.STEADY, cases.TRANSIENT])
def test_velocity_in_the_result(told_case, text):
    """Speeds of the walls in SI; of a steady film one mass flux at all nodes, of a transient the film of the last time."""
    found = told_case(text + LAYERS, "--quiet")[0]
    u, zeta = found["velocity/u"], found["velocity/zeta"]
    assert u.shape == (257, 41)
    assert np.array_equal(zeta, np.arange(41) / 40)
    assert cases.text(found["velocity/u@si_units"]) == "m/s"
    speeds = u * found["velocity/u@si_scale"]
    assert np.allclose(speeds[:, 0], 0.1, rtol=1e-12)
    assert np.allclose(speeds[:, -1], 1.1, rtol=1e-12)
    mean = (u[:, 0] + u[:, -1] + 4 * u[:, 1:-1:2].sum(axis=1) + 2 * u[:, 2:-2:2].sum(axis=1)) / 120
    x, p, h = (found[f"solution/{name}"] for name in ("x", "pressure", "film_thickness"))
    inner = np.abs(x) < 0.7
    slope = np.gradient(p, x)
    by_pressure = found["solution/slip_factor"] * h**2 / found["solution/viscosity"] * slope / (2 * found["scaling@lambda"])
    assert np.allclose(mean[inner], (0.5 - by_pressure)[inner], rtol=0, atol=1e-6)
    if "transient/time" not in found:
        flux = found["solution/density"] * h * mean
        assert np.ptp(flux[inner]) < 6e-3 * flux[128]
    # nothing but a straight line where it cavitates
    empty = np.flatnonzero(p == 0)[1:]
    assert empty.size > 0
    assert np.allclose(u[empty], (0.1 + zeta) / 1.2, rtol=1e-12)

"""Dry contacts against exact solutions: observed orders on odd and even grids, images of a periodic box, symmetries."""

import h5py
import numpy as np
import pytest
from dry_cases import HEIGHTS, case_text, solve, write_heights

RADIUS, MODULUS, PEAK = 0.01, 230e9, 1e9
LINE = 4 * RADIUS * PEAK / MODULUS  # half-width of the Hertzian line
POINT = np.pi * PEAK * RADIUS / MODULUS  # radius of the Hertzian circle


def hertz(asperity, folder, nodes, length, problem="dry_line", periodic=False):
    """Fields and figures of a parabola under the Hertzian pressure PEAK."""
    names = ("_x", "_y") if problem == "dry_area" else ("",)
    sizes = ", ".join(f"length{name} = {float(length)!r}, intervals{name} = {nodes}" for name in names)
    return fields_of(
        solve(
            asperity,
            folder,
            "shape = 'parabola'",
            [PEAK],
            f", reduced_radius = {RADIUS}",
            f"&domain {sizes}, periodic = .{str(periodic).lower()}. /",
            problem,
            key="hertz_pressure",
            modulus=MODULUS,
        )
    )


def fields_of(file):
    """The solution and the figures of the last load, in memory."""
    with file:
        found = {name: item[()] for name, item in file["solution"].items()}
        return found | {name: item[-1] for name, item in file["sweep"].items()}


def hertz_line(asperity, folder, nodes, _kernel):
    """Pressure, gap, their exact values, and the contact width in nodes with its exact value."""
    length = np.pi * LINE
    found = hertz(asperity, folder, nodes, length)
    x = np.abs(found["x"]) / LINE
    outside = np.sqrt(np.maximum(x**2 - 1, 0))
    gap = LINE**2 / (2 * RADIUS) * np.where(x > 1, x * outside - np.log(np.maximum(x + outside, 1)), 0)
    pressure = PEAK * np.sqrt(np.maximum(1 - x**2, 0))
    return found, pressure, gap, PEAK, 2 * LINE / length


def hertz_point(asperity, folder, nodes, _kernel):
    """The same of a ball on an open area."""
    length = np.e * POINT
    found = hertz(asperity, folder, nodes, length, "dry_area")
    r = np.hypot(found["x"][None, :], found["y"][:, None]) / POINT
    inside = np.arccos(1 / np.maximum(r, 1))
    gap = POINT**2 / (np.pi * RADIUS) * (np.sqrt(np.maximum(r**2 - 1, 0)) - (2 - r**2) * inside) * (r > 1)
    return found, PEAK * np.sqrt(np.maximum(1 - r**2, 0)), gap, PEAK, np.pi * POINT**2 / length**2


def westergaard(asperity, folder, nodes, kernel):
    """The same of a periodic sinusoid (H. M. Westergaard, J. Appl. Mech. 6, 1939, A49) at 0.3 of the full load."""
    length, height, share = 1e-3, 1e-6, 0.3
    full = np.pi * MODULUS / 2 * height / length
    domain = f"&domain length = {length}, intervals = {nodes}, kernel = '{kernel}' /"
    surface = f"shape = 'sinusoid', amplitude = {height}, wavelength = {length}"
    found = fields_of(solve(asperity, folder, surface, [share * full], "", domain, modulus=MODULUS))
    angle = np.pi * ((found["x"] / length + 0.5) % 1 - 0.5)
    edge = np.arcsin(np.sqrt(share))
    inside = np.sqrt(np.maximum(share - np.sin(angle) ** 2, 0))
    pressure = 2 * full * np.cos(angle) * inside
    s = np.abs(np.sin(angle)) / np.sqrt(share)
    outside = np.sqrt(np.maximum(s**2 - 1, 0))
    gap = height * 2 * share * np.where(np.abs(angle) > edge, s * outside - np.log(np.maximum(s + outside, 1)), 0)
    return found, pressure, gap, 2 * full * np.sqrt(share), 2 * edge / np.pi


CONTACTS = {
    "hertz_line": (hertz_line, "", range(24)),
    "hertz_point": (hertz_point, "", range(0, 13)),
    "westergaard": (westergaard, "band_limited", range(24)),
    "westergaard_element": (westergaard, "element", range(24)),
}


@pytest.mark.parametrize("parity", [0, 1], ids=["even", "odd"])
@pytest.mark.parametrize("name", CONTACTS)
def test_observed_orders(asperity, tmp_path, name, parity):
    contact, kernel, sizes = CONTACTS[name]
    nodes = sorted({round(24 * 2 ** (k / 4)) // 2 * 2 + parity for k in sizes})
    errors = []
    for n in nodes:
        found, pressure, gap, peak, area = contact(asperity, tmp_path, n, kernel)
        difference = np.abs(found["pressure"] - pressure)
        errors.append(
            [
                difference.sum() / pressure.sum(),
                np.abs(found["gap"] - gap).mean() / gap.max(),
                abs(found["p_max"] / peak - 1),
                difference.max() / peak,
            ]
        )
        if pressure.ndim == 1:
            assert abs(found["contact_area_fraction"] - area) <= 2 / n
        else:
            # Half a node all round.
            assert found["contact_area_fraction"] == pytest.approx(area, rel=np.e / n)
    mean_pressure, mean_gap, largest, edge = -np.polyfit(np.log(nodes), np.log(errors), 1)[0]
    # The pressure ends like a root: order 1.5 in the mean, 0.5 at the edge; the gap and the largest pressure do better.
    assert mean_pressure == pytest.approx(1.5, abs=0.15)
    assert 1.5 < mean_gap < 2.5
    assert largest == pytest.approx(2.0, abs=0.4)
    assert 0.1 < edge < 0.8


def test_images_of_a_periodic_point(asperity, tmp_path):
    # Images of balls fall with the third power of their distance.
    rise = [hertz(asperity, tmp_path, 200, ratio * POINT, "dry_area", periodic=True)["p_max"] / PEAK - 1 for ratio in (3, 4, 6)]
    assert np.polyfit(np.log([3, 4, 6]), np.log(rise), 1)[0] == pytest.approx(-3, abs=0.2)


def rough_area(nx=36, ny=24):
    """Uneven heights without symmetry: waves with random phases."""
    phase = np.random.default_rng(7).random((6, 6))
    x, y = np.arange(nx) / nx, np.arange(ny)[:, None] / ny
    return 1e-6 * sum(
        np.cos(2 * np.pi * (i * x + j * y + phase[i, j])) / (1 + i * i + j * j) for i in range(6) for j in range(6) if i + j
    )


def press(asperity, folder, heights, spacing, pressure, hardness):
    """Pressure and heights after unloading of an area, solved as far as rounding allows."""
    write_heights(folder, heights, spacing)
    text = case_text(HEIGHTS, [pressure], f", hardness = {hardness!r}", problem="dry_area")
    (folder / "case.nml").write_text(text.replace("1e-12", "1e-14"), encoding="utf-8")
    assert asperity("case.nml", "--quiet").returncode == 0
    with h5py.File(folder / "case.h5") as file:
        assert file["sweep/plastic_area_fraction"][0] > 0
        return file["solution/pressure"][()], file["solution/plastic_deformation"][()]


def test_turned_and_larger_surfaces(asperity, tmp_path):
    """Turned by 90 degrees; everything geometric by 8, which leaves the pressures to the bit."""
    z = rough_area()
    pressure, plastic = press(asperity, tmp_path, z, (1e-6, 1.25e-6), 3e8, 2e9)
    turned = press(asperity, tmp_path, np.rot90(z), (1.25e-6, 1e-6), 3e8, 2e9)
    for before, after in zip((pressure, plastic), turned, strict=True):
        np.testing.assert_allclose(after, np.rot90(before), rtol=0, atol=1e-12 * before.max())
    larger = press(asperity, tmp_path, 8 * z, (8e-6, 10e-6), 3e8, 2e9)
    assert np.array_equal(larger[0], pressure)
    assert np.array_equal(larger[1], 8 * plastic)

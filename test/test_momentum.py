"""The full momentum equations of the film: fields, balance of mass, errors, and where there is no solution."""

import random
import re

import cases
import h5py
import numpy as np
import pytest
from cases import STOKES, members
from kill_and_resume import kill_often


@pytest.mark.path
def test_fields_and_differences(told_case):
    """The film of Case 1: its flux, the speeds of its walls, its mean pressure, and what the closing table says."""
    found, printed = told_case(STOKES + "&film layers = 10 /")
    assert found["@converged"] == 1
    pressure, film = found["solution/pressure"], found["solution/film_thickness"]
    for name in ("u", "w", "layer_pressure", "shear_stress", "viscosity"):
        assert found[f"momentum/{name}"].shape == (257, 10)
    assert np.allclose(found["momentum/layer_pressure"].mean(axis=1), pressure, rtol=0, atol=1e-14)
    u = found["momentum/u"]
    # u1 = 0.1, u2 = 1.1 m/s: continued linearly to the walls, in the middle of the contact
    inner = np.abs(found["solution/x"]) < 0.5
    assert np.allclose(1.5 * u[inner, 0] - 0.5 * u[inner, 1], 0.1 / 1.2, atol=5e-3)
    assert np.allclose(1.5 * u[inner, -1] - 0.5 * u[inner, -2], 1.1 / 1.2, atol=5e-3)
    # one flux at all nodes with pressure, as far as means of fields on the nodes tell (second order)
    flux = found["solution/density"] * film * u.mean(axis=1)
    assert np.ptp(flux[inner]) < 2e-3 * flux[128]
    # stress below tau_0 times the asinh of a shear rate that cannot be larger
    assert np.abs(found["momentum/shear_stress"]).max() * found["momentum/shear_stress@si_scale"] < 3e7
    # differences are those of the stored fields
    before = found["momentum/reynolds_film_thickness"]
    x = found["solution/x"]
    change = np.interp(0, x, film) / np.interp(0, x, before) - 1
    assert found["momentum/difference_h_min"] == pytest.approx(5.8e-4, rel=0.03)
    assert found["momentum/difference_h_central"] == pytest.approx(change, abs=1e-9)
    gap = np.abs(pressure - found["momentum/reynolds_pressure"]).max()
    assert found["momentum/difference_pressure"] == pytest.approx(gap, rel=1e-12, abs=0)
    assert 0.04 < found["momentum/stress_rise"] < 0.08
    assert "full momentum equations on 10 layers" in " ".join(printed.split())


def test_error_bars_are_those_of_reynolds(told_case, tmp_path):
    """Quantities are those of the full equations, their errors those of the Reynolds equation by the same scheme."""
    full, _ = told_case(STOKES)
    plain, _ = told_case(cases.STEADY + "&solver space_scheme = 'kappa' /")
    for name in ("h_min", "h_central", "p_max"):
        key = f"summary/{name}"
        assert full[key] / plain[key] - 1 == pytest.approx(full[f"momentum/difference_{name}"], abs=1e-9)
        assert full[f"{key}@error_grid"] == pytest.approx(plain[f"{key}@error_grid"], rel=1e-6, abs=0)
    with h5py.File(tmp_path / "case.h5") as file:
        assert "momentum" not in file


def test_inertia_is_small(told_case):
    """The convective terms change the film by millionths, in proportion to the density."""
    found = {}
    for density in (0, 870, 8700):
        inertia = f"&film inertia = {'.true.' if density else '.false.'} /"
        text = STOKES.replace("viscosity = 0.14", f"viscosity = 0.14, density = {max(density, 870)}") + inertia
        found[density] = told_case(text)[0]["momentum/difference_h_min"]
    assert found[870] - found[0] == pytest.approx(2.1e-6, rel=0.2)
    assert found[8700] - found[0] == pytest.approx(10 * (found[870] - found[0]), rel=0.02)


@pytest.mark.path
def test_no_solution_has_its_reason(told_case):
    """Where shear stress rises with pressure by more than 1 the result says so and holds no film."""
    found, printed = told_case(STOKES.replace("3.3e6", "100e6"), status=2)
    assert found["@converged"] == 0
    assert "(T_max)" in cases.text(found["@reason"])
    assert "no solution of the full momentum equations" in " ".join(printed.split())
    assert not any(name.startswith("momentum") for name in found)


ROLLING = STOKES.replace("rheology = 'eyring', eyring_stress = 3.3e6", "rheology = 'newtonian'").replace("1e5", "4e4")
ROLLING = ROLLING.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 1.0, speed_2 = 1.0")


@pytest.mark.parametrize("radii", ["radius_1 = 0.01, radius_2 = 2.0", "radius_1 = 0.02, radius_2 = 0.02"])
def test_a_newtonian_oil_rolls(told_case, radii):
    """T_max is that of the pressure gradient, tau = h/2 dp/dx at the walls; the oil that turns with the film has no part in it, and
    there is a solution near that of Reynolds' equation."""
    text = ROLLING.replace("radius_1 = 0.01, radius_2 = 2.0", radii)
    found, _ = told_case(text + "&film layers = 8 /&accuracy error_bars = .false. /")
    assert found["@converged"] == 1
    pressure, film = found["momentum/reynolds_pressure"], found["momentum/reynolds_film_thickness"]
    slope = found["scaling@half_width"] / found["scaling@reduced_radius"]
    # d ln mu/dP of Roelands' law, at the nodes
    p0, z = 1.98e8 / found["scaling@hertz_pressure"], 0.6
    rise = (np.log(0.14) + 9.67) * z / p0 * (1 + pressure / p0) ** (z - 1)
    wall = np.abs(np.diff(pressure) / np.diff(found["solution/x"])) * (film[1:] + film[:-1]) / 4
    expected = slope * (wall * (rise[1:] + rise[:-1]) / 2).max()
    assert found["momentum/stress_rise"] == pytest.approx(expected, rel=1e-3)  # 9.67 is rounded
    assert 0.3 < expected < 1
    assert 0 < found["momentum/difference_h_min"] < 1e-3


@pytest.mark.path
def test_a_ridge_passes_where_a_newtonian_oil_rolls(told_case):
    passage = PASSAGE.replace("end_time = 1.4", "end_time = 0.1").replace("0.2e-6", "0.02e-6")
    found, _ = told_case(ROLLING + passage)
    assert found["@converged"] == 1
    assert 0.3 < found["momentum/stress_rise"] < 1
    assert np.abs(found["momentum/transient/difference_h_min"]).max() < 1e-3


def test_ridge_at_rest(told_case):
    still = STOKES.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 0.0, speed_2 = 1.2")
    ridge = still + "&surface_1 shape = 'feature', amplitude = 0.2e-6, wavelength = 1e-4, position = 0.0 /"
    smooth, _ = told_case(still)
    rough, _ = told_case(ridge)
    assert rough["@converged"] == 1
    assert rough["momentum/pressure_variation"] > 2 * smooth["momentum/pressure_variation"]


def test_random_contacts_are_solved(told_case):
    """Contacts at random with T_max below one half: each has a solution, near that of the Reynolds equation."""
    source = np.random.default_rng(20261123)
    for _ in range(members(3, 6)):
        stress, load, slip = 10 ** source.uniform(6, 7), 10 ** source.uniform(4.5, 5.3), source.uniform(-0.5, 0.5)
        text = STOKES.replace("3.3e6", f"{stress:.3e}").replace("1e5", f"{load:.3e}")
        text = text.replace("speed_1 = 0.1, speed_2 = 1.1", f"speed_1 = {0.6 - slip:.3f}, speed_2 = {0.6 + slip:.3f}")
        found, _ = told_case(text + "&film layers = 8 /&accuracy error_bars = .false. /")
        assert found["@converged"] == 1
        assert found["momentum/stress_rise"] < 0.5
        # Reynolds' equation is within 1 % there
        assert abs(found["momentum/difference_h_min"]) < 0.01


def test_nearly_rolling_contacts_are_solved(told_case):
    """Sharp pressure spikes and slides of 2 % or none, at random: from the Reynolds film, or with slopes growing from it."""
    source = np.random.default_rng(20261124)
    for _ in range(members(2, 6)):
        stress, load, speed = 10 ** source.uniform(6.2, 6.9), 10 ** source.uniform(4.5, 5.0), 10 ** source.uniform(0.3, 1.3)
        half_slide = source.choice([0, 1]) * 10 ** source.uniform(-4, -2)
        speeds = f"speed_1 = {speed * (1 - half_slide):.6g}, speed_2 = {speed * (1 + half_slide):.6g}"
        text = STOKES.replace("3.3e6", f"{stress:.4g}").replace("1e5", f"{load:.4g}")
        text = text.replace("speed_1 = 0.1, speed_2 = 1.1", speeds)
        found, _ = told_case(text + "&film layers = 10 /&accuracy error_bars = .false. /")
        assert found["@converged"] == 1
        assert 0 < found["momentum/difference_h_min"] < 0.01


PASSAGE = (
    "&surface_2 shape = 'feature', amplitude = 0.2e-6, wavelength = 1e-4, position = -2.5 /"
    "&time transient = .true., end_time = 1.4, time_step = 0.02 /&film layers = 6 /&output profile_stride = 10 /"
    "&accuracy error_bars = .false. /"
)


def test_passage_beside_reynolds(told_case):
    """A ridge on the fast surface: the same steps by both equations, small differences, few Newton steps."""
    found, printed = told_case(STOKES + PASSAGE)
    text = STOKES.replace(", equations = 'stokes'", "") + PASSAGE.replace("&film layers = 6 /", "&solver space_scheme = 'kappa' /")
    plain, _ = told_case(text)
    assert found["@converged"] == 1
    # the result is that of Reynolds' equation
    assert np.array_equal(found["transient/pressure"], plain["transient/pressure"])
    assert np.array_equal(found["summary/h_min"], plain["summary/h_min"])
    assert np.allclose(found["momentum/transient/time"], found["transient/time"], rtol=0, atol=1e-12)
    assert np.allclose(found["momentum/transient/profile_time"], found["transient/profile_time"], rtol=0, atol=1e-12)
    # the profiles are those that the differences are of
    pressure, film = (found[f"momentum/transient/{name}"] for name in ("pressure", "film_thickness"))
    gap = np.abs(pressure - found["transient/pressure"]).max(axis=1)
    assert np.allclose(gap, found["momentum/transient/difference_pressure"][::10], rtol=1e-12)
    gap = np.abs(film - found["transient/film_thickness"]).max(axis=1)
    assert np.allclose(gap, found["momentum/transient/difference_film"][::10], rtol=1e-12)
    # larger than in the smooth contact at T = 0, and still small
    differences = found["momentum/transient/difference_pressure"]
    assert 1.2 * differences[0] < differences.max() < 5e-3
    assert found["momentum/difference_pressure"] == differences.max()
    smallest = found["momentum/transient/h_min"].min() / plain["transient/h_min"].min() - 1
    assert found["momentum/difference_h_min"] == pytest.approx(smallest, abs=2e-4)
    assert np.abs(found["momentum/transient/difference_h_central"]).max() < 0.01
    assert most_steps(printed) <= 3
    assert found["momentum/layer_pressure"].shape == (257, 6)
    assert np.allclose(found["momentum/reynolds_pressure"], found["solution/pressure"], rtol=0, atol=0)


def ridge_at_random(source, slides, steepest, longest_step):
    """Case 1 with a ridge or sinusoid on one surface, for 24 time steps; `longest_step` in spacings that it moves."""
    stress, load, slide = 10 ** source.uniform(6, 6.8), 10 ** source.uniform(4.7, 5.1), source.uniform(*slides)
    speeds = [0.6 - slide, 0.6 + slide][:: source.choice([-1, 1])]
    surface, length = source.integers(1, 3), 10 ** source.uniform(-4.2, -3.7)
    step = source.uniform(0.3, longest_step) * 5.5 / 256 / max(speeds[surface - 1] / 0.6, 0.2)
    shape = source.choice(["'feature'", "'sinusoid'"])
    place = f", position = {source.uniform(-1.5, 0.7):.3f}" if "feature" in shape else ""
    size = f"amplitude = {length * source.uniform(0.0005, steepest):.4g}, wavelength = {length:.4g}{place}"
    text = STOKES.replace("3.3e6", f"{stress:.4g}").replace("1e5", f"{load:.4g}")
    return text.replace("speed_1 = 0.1, speed_2 = 1.1", f"speed_1 = {speeds[0]:.5g}, speed_2 = {speeds[1]:.5g}") + (
        f"&surface_{surface} shape = {shape}, {size} /"
        f"&time transient = .true., end_time = {24 * step:.6g}, time_step = {step:.6g} /&film layers = 4 /"
        "&accuracy error_bars = .false. /"
    )


def most_steps(printed):
    """Of Newton's method for one time step, as the note says."""
    return int(re.search(r"at most (\d+) of Newton for one", " ".join(printed.split()))[1])


def test_three_newton_steps_do(told_case):
    """Case 2 (Case 3: above), and ridges at random of their steepness on sliding surfaces: no time step takes more."""
    source = np.random.default_rng(20261125)
    slow = PASSAGE.replace("end_time = 1.4, time_step = 0.02", "end_time = 12.0, time_step = 0.12")
    rough = [ridge_at_random(source, (0.1, 0.5), 0.002, 1.0) for _ in range(members(2, 6))]
    for text in [STOKES + slow.replace("&surface_2", "&surface_1"), *rough]:
        found, printed = told_case(text)
        assert found["@converged"] == 1
        assert most_steps(printed) <= 3


def test_steep_ridges_are_followed(asperity, tmp_path):
    """Ridges at random up to three times as steep, rolling or sliding: every passage that Reynolds' equation has is solved."""
    source = np.random.default_rng(20261126)
    endings = []
    for _ in range(members(4, 10)):
        done = asperity(cases.write(tmp_path, "case.nml", ridge_at_random(source, (0.0, 0.5), 0.006, 2.0)), "--output", tmp_path)
        endings.append(done.returncode == 0 or "outside the model: mixed" in done.stdout)  # solved, beyond the roughness or below
        assert endings[-1] or "film breakdown" in done.stderr, done.stderr
    assert endings.count(True) >= 0.7 * len(endings)


# Short steps on a coarse grid, of which some have profiles.
INTERRUPTED = STOKES.replace("256", "96") + PASSAGE.replace("0.02", "0.01").replace("layers = 6", "layers = 4")


def test_a_killed_passage_goes_on_to_the_same_bits(program, tmp_path):
    """A passage by both equations, killed at random moments and resumed: fields, series and counters as if nothing had been."""

    def with_checkpoints(interval):
        return INTERRUPTED.replace("profile_stride = 10", f"profile_stride = 3, checkpoint_interval = {interval}")

    def counters(path):
        with h5py.File(path) as file:
            note = " ".join(cases.text(file["report/note"][()]).split())
            return [int(file["momentum"].attrs[name]) for name in ("newton_steps", "factorisations", "linear_iterations")] + [note]

    def check(reference):
        assert counters(reference) == counters(tmp_path / "case.h5")

    kill_often(program, tmp_path, with_checkpoints, random.Random(5), 5, 3, check)


def test_si_copies_are_the_fields_in_si(told_case, tmp_path):
    """/si/momentum holds what /momentum holds, in SI, with names, units and axes; not where it is not wanted."""
    text = STOKES.replace("intervals = 256", "intervals = 96") + PASSAGE.replace("end_time = 1.4", "end_time = 0.4")
    told_case(text)
    with h5py.File(tmp_path / "case.h5") as file:
        for group in ("momentum", "momentum/transient"):
            plain, copies = file[group], file["si"][group]
            scaled = {name for name, item in plain.items() if isinstance(item, h5py.Dataset) and "si_scale" in item.attrs}
            scaled = {name for name in scaled if plain[name].attrs["si_scale"] != 1} | {"zeta"} & set(plain)
            assert scaled | {"x"} == {name for name, item in copies.items() if isinstance(item, h5py.Dataset)}
            for name in scaled - {"zeta", "x"}:
                item, copy = plain[name], copies[name]
                assert np.array_equal(copy[()], item[()] * item.attrs["si_scale"])
                assert copy.attrs["units"] == item.attrs["si_units"]
                assert item.attrs["long_name"].startswith(copy.attrs["long_name"])
                own, others = ([axis[0].name.rsplit("/", 1)[1] for axis in each.dims if len(axis)] for each in (item, copy))
                assert own == others
            assert np.array_equal(copies["x"][()], file["si/solution/x"][()])
        assert file["si/momentum/u"].shape == (97, 6)
        # between the speeds of the walls, 0.1 and 1.1 m/s
        across = file["si/momentum/u"][48]
        assert 0.1 < across[0] < 0.3
        assert 0.9 < across[-1] < 1.1
    told_case(text.replace("&output ", "&output si_copies = .false., "))
    with h5py.File(tmp_path / "case.h5") as file:
        assert "si" not in file

"""What users know in place of the values that the solver takes: mean speed and slide-to-roll ratio, a plane, alpha alone."""

import random

import h5py
import pytest
from cases import STEADY, contents, ended, text, write

CASE = STEADY.replace("intervals = 256", "intervals = 128") + "&accuracy error_bars = .false. /\n&output adequacy = .false. /\n"
SPEEDS = "speed_1 = 0.1, speed_2 = 1.1"
RADII = "radius_1 = 0.01, radius_2 = 2.0"
ROELANDS = "roelands_z = 0.6, roelands_p0 = 1.98e8"
PARABOLA = """&case problem = 'dry_area' /
&bodies {}, youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3 /
&load load = 5 /
&surface_1 shape = 'parabola' /
&domain length_x = 4e-4, length_y = 4e-4, intervals_x = 32, intervals_y = 32, periodic = .false. /
"""


def solved(asperity, folder, content, name="a"):
    """Contents of the result, and what is said."""
    write(folder, f"{name}.nml", content)
    done = ended(asperity(f"{name}.nml"))
    return contents(folder / f"{name}.h5"), done


def fields(found):
    return {name: value for name, value in found.items() if name.startswith(("solution", "summary", "scaling"))}


def assert_same(one, other, rel):
    assert one.keys() == other.keys()
    for name, value in one.items():
        if getattr(value, "dtype", None) is not None and value.dtype.kind == "f":
            assert other[name] == pytest.approx(value, rel=rel, abs=rel, nan_ok=True), name


def test_mean_speed_and_slide_to_roll_are_the_two_speeds(asperity, tmp_path):
    """u1 = U (1 - S/2), u2 = U (1 + S/2), of either sign and beyond simple sliding, where a surface runs backwards."""
    chance = random.Random(17)
    for mean, slide in [(0.6, 5 / 3), (0.6, 0.0), (0.6, -2.0)] + [
        (chance.uniform(0.1, 2), chance.uniform(-3, 3)) for _ in range(3)
    ]:
        first, second = mean * (1 - slide / 2), mean * (1 + slide / 2)
        assert second - first == pytest.approx(slide * mean)
        two, _ = solved(asperity, tmp_path, CASE.replace(SPEEDS, f"speed_1 = {first!r}, speed_2 = {second!r}"))
        way = f"entrainment_speed = {mean!r}" + (f", slide_to_roll = {slide!r}" if slide else "")
        one, _ = solved(asperity, tmp_path, CASE.replace(SPEEDS, way))
        assert_same(fields(one), fields(two), 1e-9)
        assert one["scaling@slide_to_roll"] == pytest.approx(slide, abs=1e-12)
        kept = [float(one[f"input/effective/bodies@{key}"]) for key in ("entrainment_speed", "slide_to_roll", "speed_1", "speed_2")]
        assert kept == pytest.approx([mean, slide, first, second], abs=1e-12)


@pytest.mark.parametrize("key", ["radius_1", "radius_2"])
def test_a_plane_has_no_curvature(asperity, tmp_path, key):
    reduced, _ = solved(asperity, tmp_path, CASE.replace(RADII, "reduced_radius = 0.01"))
    plane, _ = solved(asperity, tmp_path, CASE.replace(RADII, f"{key} = 0.01, plane = .true."))
    assert_same(fields(reduced), fields(plane), 0)
    ball, _ = solved(asperity, tmp_path, PARABOLA.format("reduced_radius = 0.01"))
    dry, _ = solved(asperity, tmp_path, PARABOLA.format(f"{key} = 0.01, plane = .true."))
    assert_same(fields(ball), fields(dry), 0)


@pytest.mark.parametrize("alpha", [1.2e-8, 2.2e-8])
def test_alpha_alone_takes_the_usual_p0(asperity, tmp_path, alpha):
    both, done = solved(asperity, tmp_path, CASE.replace(ROELANDS, f"pressure_viscosity = {alpha}, roelands_p0 = 1.96e8"))
    assert "given alone" not in done.stderr
    alone, done = solved(asperity, tmp_path, CASE.replace(ROELANDS, f"pressure_viscosity = {alpha}"))
    assert_same(fields(both), fields(alone), 0)
    z = float(alone["input/effective/lubricant@roelands_z"])
    assert float(alone["input/effective/lubricant@roelands_p0"]) == 1.96e8
    words = f"&lubricant pressure_viscosity is given alone: Roelands with P0 = 1.96E+08 Pa, z = {z:.4f}"
    assert f"a.nml:5: {words}\n" in done.stderr
    with h5py.File(tmp_path / "a.h5") as file:
        assert text(file["report/note"][()]) == words
    assert f"a.nml:5: {words}\n" in asperity("--check", "a.nml").stdout

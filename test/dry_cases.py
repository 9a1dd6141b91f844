"""Dry contacts: namelists, reference profiles and tables for the end-to-end tests."""

import cases
import h5py
import numpy as np
from cases import write

DATA, INPUT = cases.ROOT / "test" / "data", cases.ROOT / "input"

CASE = """&case problem = '{problem}' /
&bodies {elastic}{bodies} /
&load {key} = {loads}{loading} /
&surface_1 {surface} /
{more}
&solver tolerance = 1e-12 /
"""
STEEL = ", youngs_modulus_2 = 210e9, poisson_ratio_2 = 0.3"
HARD = ", hardness = 4e9"
HEIGHTS = "shape = 'file', file = 'z.h5', dataset = 'z'"
LEAN = "&output adequacy = .false. /\n&accuracy error_bars = .false. /"


def profile(name, harmonics=None):
    more = f", harmonics = {harmonics}" if harmonics else ""
    return f"shape = 'file', file = '{INPUT}/profiles_ABCD.csv', positions = 'x_m', dataset = 'z{name}_m'{more}"


def write_heights(folder, z, spacing):
    """Heights in z.h5 of a folder, HEIGHTS for a namelist; `spacing` a number, or two along x and y [m]."""
    with h5py.File(folder / "z.h5", "w") as file:
        data = file.create_dataset("z", data=z)
        data.attrs["spacing_x"], data.attrs["spacing_y"] = np.broadcast_to(spacing, 2)


def write_profile(path, z, spacing):
    """Positions and heights of a profile [m] as a table."""
    path.write_text("x,z\n" + "".join(f"{i * spacing!r},{float(h)!r}\n" for i, h in enumerate(z)), encoding="utf-8")


def case_text(surface, loads, bodies=HARD, more="", problem="dry_line", loading="", key="mean_pressure", modulus=None):
    """The namelist of a case; `modulus` replaces steel against a rigid plane."""
    elastic = f"reduced_modulus = {modulus!r}" if modulus else "youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3"
    load = {"key": key, "loads": ", ".join(repr(float(load)) for load in loads), "loading": loading}
    return CASE.format(problem=problem, elastic=elastic, bodies=bodies, surface=surface, more=more, **load)


def solve(asperity, folder, surface, loads, bodies=HARD, more="", problem="dry_line", **options):
    write(folder, "case.nml", case_text(surface, loads, bodies, more, problem, **options))
    assert cases.ended(asperity("case.nml", "--quiet")).stderr == ""
    return h5py.File(folder / "case.h5")


def rows(name):
    return cases.rows(DATA / name)


def close(found, expected, tolerance=1e-6):
    """Whether two lists agree relative to the largest of the expected values."""
    found, expected = np.asarray(found), np.asarray(expected, dtype=float)
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance * np.abs(expected).max() * 1e-3)

"""A wanted accuracy in time: a result whose own coarse runs show a larger error says so."""

import random

import families
import h5py
import namelists
import pytest

COUNT = 20


def test_an_error_above_the_target_is_noted(run_case, tmp_path):
    """Passages at random, the domain given: there is a note where grid and time step err by more than wanted, else none."""
    (family,) = families.chosen(["target_in_time"])
    noted = []
    source = random.Random(7003)
    for i in range(COUNT):
        case = family.draw(source, i).case
        done = run_case(namelists.namelist(case), "--verbose")
        target = case["accuracy"]["target"]
        with h5py.File(tmp_path / "case.h5") as file:
            film = file["summary/h_min"]
            note = file["report/note"].asstr()[()] if "report/note" in file else ""
            is_above = film.attrs["error_grid"] > target * film[()]
        assert ("the target accuracy is not shown" in note) == is_above, i
        assert ("the target accuracy is not shown" in done.stderr) == is_above, i
        noted.append(is_above)
    assert any(noted)
    assert not all(noted)


SINUSOID = """&case problem = 'ehl_line' /
&bodies reduced_radius = {}, reduced_modulus = 2.2e11, speed_1 = {}, speed_2 = {} /
&load load_per_length = {} /
&lubricant viscosity = {}, pressure_viscosity = {}, {} /
&surface_1 shape = 'sinusoid', amplitude = {}, wavelength = {} /
&time transient = .true., end_time = 2.0 /
&accuracy target = {} /
&solver space_scheme = 'kappa' /
&output adequacy = .false. /
"""
BARUS = "viscosity_law = 'barus'"
EYRING = "viscosity_law = 'roelands', roelands_z = 0.6, rheology = 'eyring', eyring_stress = 6e6"
HEAVY = [
    (0.02, 2.33051, 3.33344, 2.37361e06, 0.2534, 1.956e-08, BARUS, 1.166e-07, 0.000137, 0.1),
    (0.02, 1.00375, 2.39156, 1.82449e06, 0.09377, 1.253e-08, BARUS, 5.502e-08, 3.896e-05, 0.02),
    (0.01, 1.0192, 1.46009, 425775, 0.09875, 1.59e-08, EYRING, 8.114e-08, 2.677e-05, 0.1),
]


@pytest.mark.parametrize("values", HEAVY)
def test_a_step_without_solution_starts_from_the_other_scheme(run_case, tmp_path, values):
    """Waves in heavy contacts, a step of which Newton's method finds only from the solution of the thesis's scheme."""
    run_case(SINUSOID.format(*values))
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["input/effective/solver"].attrs["space_scheme"] == b"kappa"

"""A wanted accuracy in time: a result whose own coarse runs show a larger error says so."""

import random

import families
import h5py
import namelists
import pytest

COUNT = 10


def test_an_error_above_the_target_is_noted(asperity, tmp_path):
    """Passages at random, the domain given: there is a note where grid and time step err by more than wanted, else none."""
    (family,) = families.chosen(["target_in_time"])
    noted = []
    source = random.Random(7002)
    for i in range(COUNT):
        case = family.draw(source, i).case
        (tmp_path / "case.nml").write_text(namelists.namelist(case), encoding="utf-8")
        done = asperity("case.nml")
        assert done.returncode == 0, done.stderr
        target = case["accuracy"]["target"]
        with h5py.File(tmp_path / "case.h5") as file:
            film = file["summary/h_min"]
            note = file["report/note"].asstr()[()] if "report/note" in file else ""
            is_above = film.attrs["error_grid"] > target * film[()]
        assert ("the wanted accuracy is not shown" in note) == is_above, i
        assert ("the wanted accuracy is not shown" in done.stderr) == is_above, i
        noted.append(is_above)
    assert any(noted)
    assert not all(noted)


SINUSOID = """&case problem = 'ehl_line' /
&bodies reduced_radius = {radius}, reduced_modulus = 2.2e11, speed_1 = {speeds[0]}, speed_2 = {speeds[1]} /
&load load_per_length = {load} /
&lubricant viscosity = {viscosity}, pressure_viscosity = {alpha}, {law} /
&surface_{surface} shape = 'sinusoid', amplitude = {wave[0]}, wavelength = {wave[1]} /
&time transient = .true., end_time = 2.0 /
&accuracy target = {target} /
&solver space_scheme = 'kappa' /
&output adequacy = .false. /
"""


@pytest.mark.parametrize(
    "case",
    [
        {
            "radius": 0.02,
            "speeds": (2.33051, 3.33344),
            "load": 2.37361e06,
            "viscosity": 0.2534,
            "alpha": 1.956e-08,
            "law": "viscosity_law = 'barus'",
            "surface": 1,
            "wave": (1.166e-07, 0.000137),
            "target": 0.1,
        },
        {
            "radius": 0.02,
            "speeds": (1.00375, 2.39156),
            "load": 1.82449e06,
            "viscosity": 0.09377,
            "alpha": 1.253e-08,
            "law": "viscosity_law = 'barus'",
            "surface": 1,
            "wave": (5.502e-08, 3.896e-05),
            "target": 0.02,
        },
        {
            "radius": 0.01,
            "speeds": (1.0192, 1.46009),
            "load": 425775,
            "viscosity": 0.09875,
            "alpha": 1.59e-08,
            "law": "viscosity_law = 'roelands', roelands_z = 0.6, rheology = 'eyring', eyring_stress = 6e6",
            "surface": 1,
            "wave": (8.114e-08, 2.677e-05),
            "target": 0.1,
        },
    ],
)
def test_a_step_without_solution_starts_from_the_other_scheme(asperity, tmp_path, case):
    """Waves in heavy contacts, a step of which Newton's method finds only from the solution of the thesis's scheme."""
    (tmp_path / "case.nml").write_text(SINUSOID.format(**case), encoding="utf-8")
    done = asperity("case.nml")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["input/effective/solver"].attrs["space_scheme"] == b"kappa"

"""Cases built to break each method: an answer or a stated reason, within a bounded time, never NaN, never a hang."""

import math
from pathlib import Path

import h5py
import namelists
import numpy as np
import pytest
from cases import text, write
from test_borders import heavy

FAS = "fas_block_jacobi"
METHODS = {
    "auto": {},
    "krylov": {"method": "newton_krylov"},
    "dense": {"method": "newton_dense"},
    "block_jacobi": {"method": "block_jacobi", "max_cycles": 200},
    "fas_block_jacobi": {"method": FAS, "smoother": "block_jacobi"},
    "fas_gauss_seidel": {"method": FAS, "smoother": "gauss_seidel"},
    "fas_line": {"method": FAS, "smoother": "line"},
    "fas_hybrid": {"method": FAS, "smoother": "hybrid"},
}
CYCLES = [name for name in METHODS if name.startswith("fas")]
# A step of the plain smoother ends by its own limit of cycles.
IN_TIME = METHODS | {"block_jacobi": {"method": "block_jacobi"}}
# Processor time that a run may take [s], also by the checked build.
PATIENCE = 100


def spike(solver: dict, intervals: int = 2048) -> str:
    """A pressure spike of 11 Hertz pressures on 2048 intervals, a node or two wide on each grid."""
    return namelists.moes(3, 40, intervals, solver, domain=namelists.WINDOW)


def waves(amplitude: float, solver: dict) -> str:
    """Case 1 with a wavy surface at rest, amplitude in central films."""
    wave = {"shape": "sinusoid", "amplitude": amplitude * namelists.CASE_1_FILM, "wavelength": namelists.CASE_1_HALF_WIDTH / 4}
    return namelists.case_1(256, solver, bodies={"speed_1": 0.0, "speed_2": 1.2}, surface_1=wave)


def feature(amplitude: float, solver: dict, position: float = -1.6, intervals: int = 256) -> str:
    """A ridge or dent passes Case 1; amplitude in central films."""
    form = {"shape": "feature", "amplitude": amplitude * namelists.CASE_1_FILM, "wavelength": 1e-4, "position": position}
    time = {"transient": True, "end_time": 1.2, "time_step": 0.04}
    return namelists.case_1(intervals, solver, surface_2=form, time=time)


def low_stress(stress: float, solver: dict) -> str:
    """An Eyring stress at which a start has |Sigma| beyond 717, where exp(|Sigma|) overflows."""
    groups = namelists.steel(300, 15, 5 / 3, stress)
    return namelists.namelist(groups | {"domain": {"intervals": 512}, "solver": solver})


def collect():
    cases = {}
    for name, solver in METHODS.items():
        cases[f"far_start-{name}"] = heavy(1000, 1024, solver | {"start": "hertz"})
        cases[f"far_start_of_shear_thinning-{name}"] = low_stress(1e6, solver | {"start": "hertz"})
        cases[f"low_stress-{name}"] = low_stress(2e5, solver)
        cases[f"closing_film-{name}"] = waves(3.0, solver)
        # the dense method takes seconds a step on 2048
        cases[f"spike-{name}"] = spike(solver, 1024 if name == "dense" else 2048)
    # the others have no levels: a test of bad input
    for name in ["auto", *CYCLES]:
        cases[f"coarsest_level_of_16_at_m_1000-{name}"] = heavy(1000, 1024, METHODS[name] | {"levels": 7})
    for name in CYCLES:
        # a tolerance below the round-off floor, which the bound is then taken from
        solver = METHODS[name] | {"tolerance": 1e-14}
        cases[f"round_off_of_fine_grids-{name}"] = namelists.case_1(2**16, solver, accuracy={"error_bars": False})
    for name, solver in IN_TIME.items():
        cases[f"ridge_through_the_film-{name}"] = feature(3.0, solver)
        cases[f"film_closes_on_the_way-{name}"] = feature(6.0, solver, position=-2.6, intervals=128)
        cases[f"dent_deeper_than_the_film-{name}"] = feature(-3.0, solver)
        cases[f"feature_appears_in_the_contact-{name}"] = feature(1.5, solver, position=0.0)
    return cases


CASES = collect()
# What must not only end but be solved.
SOLVED = {
    *("far_start-auto", "far_start_of_shear_thinning-auto", "low_stress-auto", "spike-auto"),
    *("spike-krylov", "spike-dense", "coarsest_level_of_16_at_m_1000-auto"),
    *(f"round_off_of_fine_grids-fas_{name}" for name in ("block_jacobi", "gauss_seidel", "line")),
    *("dent_deeper_than_the_film-auto", "dent_deeper_than_the_film-krylov"),
}


def look_at(path: Path, returncode: int) -> str:
    """Checks of a result whatever came out; returns its reason."""
    with h5py.File(path) as file:
        reason, outcome = text(file.attrs["reason"]), text(file.attrs["outcome"])
        pressure, film = file["solution/pressure"][()], file["solution/film_thickness"][()]
        history = file["report/residual_history"][()]
        assert (outcome == "converged") == (returncode == 0)
        assert file.attrs["converged"] == (outcome != "not converged")
        assert np.isfinite(pressure).all()
        assert np.isfinite(film).all()
        assert (pressure >= 0).all()
        assert not np.isnan(history).any()
        if outcome != "not converged":
            assert reason.startswith(outcome)
            assert (film > 0).all()
            assert history[-1] <= file["report/tolerance_effective"][()]
        else:
            assert len(reason) > 10
            assert reason != "converged"
    return reason


@pytest.mark.parametrize("name", CASES)
def test_breaks_no_method_without_a_word(diverging, tmp_path, name):
    write(tmp_path, "case.nml", CASES[name])
    done = diverging("case.nml", "--quiet", seconds=PATIENCE)
    assert done.returncode in {0, 2}, done.stderr
    reason = look_at(tmp_path / "case.h5", done.returncode)
    if name in SOLVED:
        assert done.returncode == 0, reason
    if name.startswith("film_closes_on_the_way"):
        assert "time step 2 of 30" in reason
        assert "smallest film before it" in reason
    if name.startswith("closing_film") and done.returncode == 2 and not reason.startswith("outside the model: mixed"):
        assert reason.startswith("the surfaces rise to 2.5 times the estimated film of the smooth contact; ")


# theory page, residuals and convergence: the rest of P is kept on more than 2^13 intervals, by Newton's method
ROUND_OFF = [
    (2**13, {"method": "newton_krylov"}, 5 * 2.8e-11 * 8**2),
    (2**14, {"method": FAS, "smoother": "line"}, 5 * 2.8e-11 * 16**2),
    (2**14, {"method": "newton_krylov"}, 5 * 1.5e-12 * 16),
]


@pytest.mark.parametrize(("intervals", "solver", "bound"), ROUND_OFF)
def test_round_off_bounds_the_residual(run_case, tmp_path, intervals, solver, bound):
    text = namelists.case_1(intervals, solver | {"tolerance": 1e-14}, accuracy={"error_bars": False})
    run_case(text, "--quiet", seconds=PATIENCE)
    with h5py.File(tmp_path / "case.h5") as file:
        assert math.isclose(file["report/tolerance_effective"][()], bound, rel_tol=0.05)
        assert file["report/residual_history"][-1] <= file["report/tolerance_effective"][()]


# H_min of before the rest of P was kept, when the residual ended at 1.1e-7 and 1.8e-6.
@pytest.mark.parametrize(("intervals", "h_min"), [(2**16, 0.3854881180690946), (2**18, 0.3854881286127418)])
def test_reaches_its_tolerance_on_fine_grids(run_case, tmp_path, intervals, h_min):
    solver = {"method": "newton_krylov", "tolerance": 1e-8}
    run_case(namelists.case_1(intervals, solver, accuracy={"error_bars": False}), "--quiet", seconds=PATIENCE)
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["report/tolerance_effective"][()] == 1e-8
        assert file["report/residual_history"][-1] <= 1e-8
        # a step of Newton's method from a residual of 1e-7 changes it by 3e-11
        assert math.isclose(file["summary/h_min"].attrs["dimensionless"], h_min, rel_tol=1e-9)

"""Borders of the methods as `make stability` maps them: inside converges, outside ends with status 2 and a stated reason."""

from pathlib import Path

import h5py
import namelists
import numpy as np
import pytest
import stability_cells
from cases import ended, write

KRYLOV = {"method": "newton_krylov"}
CYCLE = {"method": "fas_block_jacobi", "smoother": "block_jacobi"}
LINE = {"method": "fas_block_jacobi", "smoother": "line"}
PLAIN = {"method": "block_jacobi"}
DENSE = {"method": "newton_dense"}
GAUSS_SEIDEL = {"method": "fas_block_jacobi", "smoother": "gauss_seidel"}


def thinning(m: float, oil: float, intervals: int | None, solver: dict, slide: float = 5 / 3) -> str:
    """A contact with an Eyring stress of 1 MPa."""
    groups = namelists.steel(m, oil, slide, 1e6)
    return namelists.namelist(groups | {"domain": {"intervals": intervals}, "solver": solver})


def heavy(m: float, intervals: int, solver: dict) -> str:
    """Barus, L = 10, on the domain of the thesis."""
    return namelists.moes(m, 10, intervals, solver, domain=namelists.WINDOW)


def rolling(intervals: int, steps_per_dx: float, solver: dict, oil: dict | None = None) -> str:
    """A ridge rolls into the contact of Case 1 without sliding, ten time steps."""
    step = 5.5 / intervals / steps_per_dx
    time = {"transient": True, "end_time": 10 * step, "time_step": step}
    groups = {"lubricant": oil or {}, "surface_2": namelists.RIDGE | {"position": -1.5}, "time": time}
    return namelists.case_1(intervals, solver, bodies={"speed_1": 0.6, "speed_2": 0.6}, accuracy={"error_bars": False}, **groups)


def without_sliding(intervals: int, solver: dict) -> str:
    """Case 1, both surfaces at its mean speed: an Eyring oil that nothing thins."""
    return namelists.case_1(intervals, solver, bodies={"speed_1": 0.6, "speed_2": 0.6})


def narrow_ridge(solver: dict, height: float = 1.2) -> str:
    """A ridge of a height over the film and 12 intervals wide passes Case 1."""
    ridge = {
        "shape": "feature",
        "amplitude": height * namelists.CASE_1_FILM,
        "wavelength": 0.125 * namelists.CASE_1_HALF_WIDTH,
        "position": -2.0,
    }
    time = {"transient": True, "end_time": 1.5, "time_step": 5.5 / 512 / 2}
    return namelists.case_1(512, solver, surface_2=ridge, time=time, accuracy={"error_bars": False})


SHORT_WAVES = {"shape": "sinusoid", "amplitude": namelists.CASE_1_FILM, "wavelength": 0.25 * namelists.CASE_1_HALF_WIDTH}
NEWTONIAN = {"rheology": "newtonian", "eyring_stress": None}
INSIDE = {
    "gauss_seidel_in_time_without_sliding": rolling(256, 2, GAUSS_SEIDEL),
    "gauss_seidel_in_small_steps_without_sliding": rolling(256, 4, GAUSS_SEIDEL),
    "gauss_seidel_in_small_steps_newtonian": rolling(512, 16, GAUSS_SEIDEL, NEWTONIAN),
    "gauss_seidel_in_time_newtonian": rolling(512, 2, GAUSS_SEIDEL, NEWTONIAN),
    "auto_in_time_without_sliding": rolling(1024, 4, {}, NEWTONIAN),
    "block_jacobi_in_time_without_sliding": rolling(256, 2, CYCLE | {"relaxation": 0.4}),
    "line_in_time_without_sliding": rolling(128, 0.5, LINE),
    "plain_block_jacobi_relaxation": namelists.case_1(64, PLAIN | {"relaxation": 0.8}),
    "dense_when_thinning": thinning(100, 40, 512, DENSE),
    "dense_in_time": rolling(64, 2, DENSE),
    "auto_on_short_high_waves": namelists.case_1(512, bodies={"speed_1": 0.0, "speed_2": 1.2}, surface_1=SHORT_WAVES),
    "auto_heavy_isoviscous": namelists.moes(980, 0, 2048),
    "auto_heavy_isoviscous_window": namelists.moes(980, 0, 2048, domain=namelists.WINDOW),
    "auto_heaviest_thinning": thinning(2000, 40, 2048, {}),
    "auto_heaviest_thinning_by_much_sliding": thinning(2000, 40, None, {}, 4),
    "auto_heaviest_thinning_without_sliding": thinning(2000, 40, None, {}, 0),
    "auto_heavy_thinning_on_a_given_grid": thinning(2000, 25, 8192, {}, 4),
    "auto_thinning_by_much_sliding": thinning(900, 30, 8192, {}, 4),
    "auto_thinning_without_sliding": thinning(410, 40, 8192, {}, 0),
    "auto_thinning_on_a_fine_grid": thinning(500, 40, 2**17, {}),
    "gauss_seidel_without_sliding_on_a_fine_grid": without_sliding(4096, GAUSS_SEIDEL),
    "line_without_sliding": without_sliding(512, LINE),
    "krylov_with_a_ridge_as_high_as_the_film": narrow_ridge(KRYLOV, 1.0),
    "auto_passes_over_coarse_levels": heavy(100, 512, {"levels": 7}),
    "krylov_lightest": namelists.moes(0.01, 10, 256, KRYLOV),
    "krylov_heaviest": namelists.moes(2000, 40, 1024, KRYLOV),
}
OUTSIDE = {
    "gauss_seidel_in_time_without_sliding": (rolling(256, 2, GAUSS_SEIDEL | {"relaxation": 0.8}), "time step 1 of 10"),
    "gauss_seidel_in_small_steps_newtonian": (rolling(512, 16, GAUSS_SEIDEL | {"relaxation": 0.4}, NEWTONIAN), "time step 1 of 10"),
    "block_jacobi_in_time_without_sliding": (rolling(256, 2, CYCLE | {"relaxation": 0.8}), "stagnation"),
    "line_in_time_without_sliding": (rolling(256, 2, LINE | {"relaxation": 0.6}), "time step 1 of 10"),
    "plain_block_jacobi_relaxation": (namelists.case_1(64, PLAIN | {"relaxation": 0.9}), "block_jacobi: stagnation"),
    "plain_block_jacobi_heavier": (heavy(5, 64, PLAIN), "block_jacobi: "),
    "plain_block_jacobi_in_time": (rolling(64, 2, PLAIN), "block_jacobi: "),
    "dense_when_thinning": (thinning(500, 40, 256, DENSE), "grid too coarse for the film, needs 1024 intervals (has 256)"),
    "on_a_coarse_level": (heavy(100, 512, GAUSS_SEIDEL | {"levels": 7}), "the exact solution of the coarse start grid failed"),
    "gauss_seidel_without_sliding_on_a_fine_grid": (without_sliding(4096, GAUSS_SEIDEL | {"relaxation": 0.6}), "stagnation"),
    "line_without_sliding": (without_sliding(512, LINE | {"relaxation": 0.6}), "stagnation"),
    "too_coarse_to_thin": (thinning(2000, 40, 2048, {}, 4), "grid too coarse for the film, needs 32768 intervals (has 2048)"),
    "ridge_on_too_few_intervals": (narrow_ridge(KRYLOV), "the finest wave of the surfaces has 12 intervals"),
    "steps_at_round_off": (
        thinning(1000, 20, 2048, {}, 4).replace("&domain\n", "&domain\n   x_inlet = -1.610753503704516\n"),
        "Newton steps at round-off leave the residual at",
    ),
}


# Map, method, a cell inside and one outside, of the maps in full; methods without one are right in every cell of the map.
CELLS = [
    ("moes_barus", "FAS, line", (0.74, 20), (0.74, 30)),
    ("moes_barus", "FAS, Gauss-Seidel", (0.36, 25), (0.74, 25)),
    ("moes_barus", "FAS, Block-Jacobi", (0.36, 25), (0.74, 25)),
    ("moes_roelands", "FAS, Gauss-Seidel", (13, 20), (3.1, 40)),
    ("moes_eyring", "FAS, line", (230, 20), (980, 40)),
    ("moes_eyring", "FAS, Gauss-Seidel", (230, 20), (980, 40)),
    ("moes_eyring", "FAS, Block-Jacobi", (230, 10), (980, 40)),
    ("slide_to_roll", "FAS, Gauss-Seidel", (12, 1), (16, 1)),
    ("intervals", "auto, L = 10", (512, 2000), (128, 2000)),
    ("intervals", "auto, L = 40", (512, 2000), (128, 2000)),
    ("intervals", "auto, L = 10, 3.3 MPa", (512, 2000), (128, 2000)),
    ("intervals", "auto, L = 40, 1 MPa", (1024, 500), (128, 500)),
    ("intervals", "FAS, Gauss-Seidel, L = 10", (512, 2000), (128, 2000)),
    ("relaxation", "FAS, Block-Jacobi: Case 1", (0.9, 5), (1.0, 5)),
    ("relaxation", "FAS, line: Barus 20, 10", (0.9, 7), (1.1, 10)),
    ("relaxation", "FAS, Gauss-Seidel: Barus 20, 10", (0.7, 5), (0.8, 5)),
    ("relaxation", "FAS, Block-Jacobi: Barus 20, 10", (0.8, 5), (0.9, 5)),
    ("coarsest", "FAS, line", (5, 16), (5, 8)),
    ("coarsest", "FAS, Gauss-Seidel", (50, 64), (50, 32)),
    ("coarsest", "FAS, Block-Jacobi", (5, 16), (5, 8)),
    ("roughness", "FAS, line", (0.5, 0.1), (0.25, 0.1)),
    ("roughness", "FAS, Gauss-Seidel", (0.5, 0.6), (0.25, 0.6)),
    ("roughness", "FAS, Block-Jacobi", (0.75, 0.4), (0.25, 0.4)),
]
MAPS = {each.key: each for each in stability_cells.all_maps(False)}
REASONS = ("stagnation: 12 cycles left the residual at", "divergence: ", "film closed: ", "grid too coarse for the film, needs ")
REASONS += ("the exact solution of the coarse start grid failed",)


def cell_text(key: str, method: str, cell: tuple[float, float]) -> str:
    """The namelist of a cell of a map."""
    return namelists.namelist(MAPS[key].text(*cell, MAPS[key].methods[method], method))


def stated_failure(path: Path) -> str:
    """The reason of a result that is marked as not converged; its fields are numbers all the same."""
    with h5py.File(path) as file:
        stated = file.attrs["reason"]
        assert file.attrs["converged"] == 0
        for name in ("pressure", "film_thickness"):
            assert np.isfinite(file[f"solution/{name}"][()]).all(), name
    return stated.decode() if isinstance(stated, bytes) else stated


@pytest.mark.parametrize(("key", "method", "inside", "outside"), CELLS)
def test_border_of_a_map(asperity, diverging, tmp_path, key, method, inside, outside):
    write(tmp_path, "inside.nml", cell_text(key, method, inside))
    write(tmp_path, "outside.nml", cell_text(key, method, outside))
    assert asperity("inside.nml", "--quiet").returncode == 0
    assert diverging("outside.nml", "--quiet").returncode == 2
    reason = stated_failure(tmp_path / "outside.h5")
    assert any(each in reason for each in REASONS), reason


@pytest.mark.parametrize("name", INSIDE)
def test_inside_converges(run_case, tmp_path, name):
    """Waves as high as the film leave less of it than their rms height: solved, but outside the model."""
    run_case(INSIDE[name], "--quiet", status=2 if name == "auto_on_short_high_waves" else 0)
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 1


@pytest.mark.parametrize(("text", "reason"), OUTSIDE.values(), ids=OUTSIDE)
def test_outside_says_why(diverging, tmp_path, text, reason):
    write(tmp_path, "case.nml", text)
    ended(diverging("case.nml", "--quiet"), 2)
    assert reason in stated_failure(tmp_path / "case.h5")


@pytest.mark.path
def test_cycle_solves_the_parts_of_the_first_step(diverging, tmp_path):
    """The first one is 1.5e-5 long; the ways that are tried before the right one may outgrow all numbers."""
    pressures = []
    for name, solver in {"newton": KRYLOV, "cycle": GAUSS_SEIDEL}.items():
        time = {"transient": True, "end_time": 2.75 / 1024, "time_step": 2.75 / 1024}
        ridge = namelists.RIDGE | {"position": -1.5}
        text = namelists.case_1(1024, solver, surface_2=ridge, time=time, accuracy={"error_bars": False})
        write(tmp_path, f"{name}.nml", text)
        ended(diverging(f"{name}.nml", "--quiet"))
        with h5py.File(tmp_path / f"{name}.h5") as file:
            assert file["report/uncut_steps"][()] == 0
            pressures.append(file["solution/pressure"][()])
    # what a residual of 1e-6 leaves (measured 4e-10; a whole first step of backward Euler differs by 2.5e-3)
    assert np.abs(pressures[0] - pressures[1]).max() < 1e-5 * pressures[0].max()

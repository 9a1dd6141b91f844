"""Where the methods converge: borders as `make stability` maps them, and cases built to break each method.

Inside a border a case converges, outside it ends with status 2 and a stated reason; whatever is built to break a method is an
answer or a stated reason, within a bounded time, never NaN, never a hang.
"""

import math
from pathlib import Path

import bench_program
import h5py
import namelists
import numpy as np
import pytest
import stability
import stability_cells
from bench_program import Answer
from cases import ended, text, write

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
KRYLOV, DENSE, PLAIN = METHODS["krylov"], METHODS["dense"], {"method": "block_jacobi"}
CYCLE, GAUSS_SEIDEL, LINE = (METHODS[f"fas_{smoother}"] for smoother in ("block_jacobi", "gauss_seidel", "line"))


def thinning(m: float, oil: float, intervals: int | None, solver: dict, slide: float = 5 / 3) -> str:
    """A contact with an Eyring stress of 1 MPa."""
    groups = namelists.steel(m, oil, slide, 1e6)
    return namelists.namelist(groups | {"domain": {"intervals": intervals}, "solver": solver})


def heavy(m: float, intervals: int, solver: dict) -> str:
    """Barus, L = 10, on the domain of the thesis."""
    return namelists.moes(m, 10, intervals, solver, domain=namelists.WINDOW)


MAPS = {each.key: each for each in stability_cells.all_maps(False)}


def rolling(intervals: int, factor: float, solver: dict, oil: str = "Eyring") -> str:
    """A ridge rolls into the contact of Case 1 without sliding, ten time steps of `factor` spacings."""
    return MAPS["rolling"].text(intervals, factor, solver, f": {oil}")


def without_sliding(intervals: int, solver: dict) -> str:
    """Case 1, both surfaces at its mean speed: an Eyring oil that nothing thins."""
    return namelists.case_1(intervals, solver, bodies={"speed_1": 0.6, "speed_2": 0.6})


def narrow_ridge(solver: dict, height: float = 1.2) -> str:
    """A ridge of a height over the film and 12 intervals wide passes Case 1."""
    return MAPS["ridge"].text(0.125, height, solver, "")


SHORT_WAVES = {"shape": "sinusoid", "amplitude": namelists.CASE_1_FILM, "wavelength": 0.25 * namelists.CASE_1_HALF_WIDTH}
INSIDE = {
    "gauss_seidel_in_time_without_sliding": rolling(256, 0.5, GAUSS_SEIDEL),
    "gauss_seidel_in_small_steps_without_sliding": rolling(256, 0.25, GAUSS_SEIDEL),
    "gauss_seidel_in_small_steps_newtonian": rolling(512, 0.0625, GAUSS_SEIDEL, "Newtonian"),
    "gauss_seidel_in_time_newtonian": rolling(512, 0.5, GAUSS_SEIDEL, "Newtonian"),
    "auto_in_time_without_sliding": rolling(1024, 0.25, {}, "Newtonian"),
    "block_jacobi_in_time_without_sliding": rolling(256, 0.5, CYCLE | {"relaxation": 0.4}),
    "line_in_time_without_sliding": rolling(128, 2, LINE),
    "plain_block_jacobi_relaxation": namelists.case_1(64, PLAIN | {"relaxation": 0.8}),
    "dense_when_thinning": thinning(100, 40, 512, DENSE),
    "dense_in_time": rolling(64, 0.5, DENSE),
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
    "gauss_seidel_in_time_without_sliding": (rolling(256, 0.5, GAUSS_SEIDEL | {"relaxation": 0.8}), "time step 1 of 10"),
    "gauss_seidel_in_small_steps_newtonian": (
        rolling(512, 1 / 16, GAUSS_SEIDEL | {"relaxation": 0.4}, "Newtonian"),
        "step 1 of 10",
    ),
    "block_jacobi_in_time_without_sliding": (rolling(256, 0.5, CYCLE | {"relaxation": 0.8}), "stagnation"),
    "line_in_time_without_sliding": (rolling(256, 0.5, LINE | {"relaxation": 0.6}), "time step 1 of 10"),
    "plain_block_jacobi_relaxation": (namelists.case_1(64, PLAIN | {"relaxation": 0.9}), "block_jacobi: stagnation"),
    "plain_block_jacobi_heavier": (heavy(5, 64, PLAIN), "block_jacobi: "),
    "plain_block_jacobi_in_time": (rolling(64, 0.5, PLAIN), "block_jacobi: "),
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
REASONS = ("stagnation: 12 cycles left the residual at", "divergence: ", "film closed: ", "grid too coarse for the film, needs ")
REASONS += ("the exact solution of the coarse start grid failed",)


def cell_text(key: str, method: str, cell: tuple[float, float]) -> str:
    """The namelist of a cell of a map."""
    return namelists.namelist(MAPS[key].text(*cell, MAPS[key].methods[method], method))


def stated_failure(path: Path) -> str:
    """The reason of a result that is marked as not converged; its fields are numbers all the same."""
    with h5py.File(path) as file:
        assert file.attrs["converged"] == 0
        for name in ("pressure", "film_thickness"):
            assert np.isfinite(file[f"solution/{name}"][()]).all(), name
        return text(file.attrs["reason"])


@pytest.mark.parametrize(("key", "method", "inside", "outside"), CELLS)
def test_border_of_a_map(asperity, diverging, tmp_path, key, method, inside, outside):
    write(tmp_path, "inside.nml", cell_text(key, method, inside))
    write(tmp_path, "outside.nml", cell_text(key, method, outside))
    assert asperity("inside.nml", "--quiet").returncode == 0
    assert diverging("outside.nml", "--quiet").returncode == 2
    reason = stated_failure(tmp_path / "outside.h5")
    assert any(each in reason for each in REASONS), reason


@pytest.mark.parametrize("name", INSIDE)
def test_inside_converges(solved_case, name):
    """Waves as high as the film leave less of it than their rms height: solved, but outside the model."""
    with solved_case(INSIDE[name], status=2 if name == "auto_on_short_high_waves" else 0) as file:
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


# A step of the plain smoother ends by its own limit of cycles.
IN_TIME = METHODS | {"block_jacobi": PLAIN}
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


def answer(cycles, reason="converged", steps=0):
    return Answer({"converged": int(reason == "converged"), "cycles": cycles, "steps": steps, "reason": reason})


@pytest.mark.parametrize(
    ("found", "word"),
    [
        (answer(30), "converged"),
        (answer(31), "late"),
        (answer(300, steps=10), "converged"),
        (answer(301, steps=10), "late"),
        # whatever it took, a cell that did not converge is never late: 97 of 279 time steps
        (answer(3000, "FAS: stagnation at residual 1e-3, time step 97 of 279", steps=97), "stalled"),
        (answer(264, "newton_krylov: cycle limit, time step 264 of 279", steps=264), "limit"),
        (answer(5, "stopped from outside"), "limit"),
        (answer(5, "the residual is not a number"), "failed"),
        (answer(1, "grid too coarse for the film, needs 1024 intervals (has 256)"), "too coarse"),
        (answer(0, "refused: 1 finding"), "refused"),
        (answer(6000, "the error is 1.2E-05 after 6000 iterations"), "limit"),
        (answer(40, "the error has stopped falling at 1.2E-05"), "stalled"),
    ],
)
def test_class_of_a_cell(found, word):
    assert stability.status(found) == word


def test_every_class_has_a_look_and_what_failed_one_colour():
    looks = stability.CLASSES
    assert {looks[word][0] for word in ("limit", "stalled", "failed")} == {stability.NOT_CONVERGED}
    assert looks["late"][0] != stability.NOT_CONVERGED
    assert len({sign for _, sign, _ in looks.values()}) == len(looks)


def test_dry_cells_have_the_same_classes(program, monkeypatch):
    monkeypatch.setattr(bench_program, "ASPERITY", program)

    def word_of(method, **keys):
        case = stability_cells.dry_cell(**keys)
        case["solver"] |= {"method": method, "max_cycles": 100}
        return stability.status(bench_program.solve(namelists.namelist(case)))

    few, many = stability_cells.DRY_METHODS
    line = {"load": 0.03, "nodes": 512, "is_area": False}
    assert word_of(few, **line) == "converged"
    assert word_of(many, **line) == "limit"
    assert word_of(many, load=0.03, nodes=31, is_area=True) == "late"
    assert word_of(few, load=10.0, nodes=31, is_area=True) == "closed"
    assert word_of(few, load=1.0, nodes=31, is_area=True, hardness=0.3) == "refused"

"""The kappa space scheme: one solution at a pressure spike, whatever the start, no zigzag in front of it, and the way back."""

import random

import h5py
import namelists
import numpy as np
import pytest
from cases import ended
from conftest import ROOT

STARTS = (({}, True), ({}, False), ({"levels": 1}, False))
COUNT = 16
MINIMAL = ROOT / "input" / "minimal.nml"


def pressures(asperity, folder, moes, law, intervals):
    """The pressure from each start that converges; a start that does not has a reason."""
    for solver, bars in STARTS:
        text = namelists.moes(
            *moes,
            intervals,
            {"space_scheme": "kappa"} | solver,
            lubricant=law,
            domain=namelists.WINDOW,
            accuracy={"error_bars": bars},
        )
        (folder / "case.nml").write_text(text, encoding="utf-8")
        done = asperity("case.nml", "--quiet")
        assert done.returncode in {0, 2}, done.stderr
        if done.returncode == 2:
            assert "NOT CONVERGED: " in done.stderr
            continue
        with h5py.File(folder / "case.h5") as file:
            yield file["solution/pressure"][()]


def test_one_solution_from_every_start(asperity, tmp_path):
    """Heavy contacts at random: the same pressure from each start, with two maxima at most, the crest and the spike."""
    source = random.Random(20261122)
    compared = 0
    for i in range(COUNT):
        moes = 10 ** source.uniform(1.3, 3), source.uniform(5, 30)
        law = {"viscosity_law": ("barus", "roelands")[i % 2], "density_law": ("constant", "dowson_higginson")[i // 2 % 2]}
        found = list(pressures(asperity, tmp_path, moes, law, source.choice((512, 1024, 2048))))
        compared += len(found) > 1
        for pressure in found:
            assert np.allclose(pressure, found[0], rtol=0, atol=1e-5 * found[0].max())
            assert np.sum((pressure[1:-1] > pressure[:-2]) & (pressure[1:-1] >= pressure[2:])) <= 2
    assert compared >= 0.75 * COUNT


@pytest.mark.path
def test_error_of_h_min_at_a_spike(solved_case):
    """A contact whose h_min changes by chance between its own coarser grids, by a tenth of its error: the truth, of 2^18
    intervals, is within the estimate, and that within ten times the error."""
    law = {"viscosity_law": "roelands", "density_law": "dowson_higginson"}
    solver = {"space_scheme": "kappa"}
    text = namelists.moes(72.12493615601822, 11.929744565822535, 1024, solver, lubricant=law, domain=namelists.WINDOW)
    with solved_case(text) as file:
        film = file["summary/h_min"]
        error = abs(film[()] - 0.0196218)
        assert error < film.attrs["error_grid"] < 10 * error


@pytest.mark.path
def test_a_trial_run_without_solution_is_followed_by_a_finer_one(asperity, tmp_path):
    """In four cycles the first trial run for a target in time fails with kappa, not with upwind2."""
    groups = namelists.steel(68.2, 27.32, 1.65, 15.4e6)
    groups["surface_2"] = {"shape": "feature", "amplitude": 1e-8, "wavelength": 1e-3, "position": -2.5}
    groups |= {"time": {"transient": True, "end_time": 0.25}, "domain": namelists.WINDOW, "accuracy": {"target": 0.1}}
    intervals = {}
    for scheme in ("kappa", "upwind2"):
        groups["solver"] = {"max_cycles": 4, "space_scheme": scheme}
        (tmp_path / "case.nml").write_text(namelists.namelist(groups), encoding="utf-8")
        ended(asperity("case.nml", "--quiet"))
        with h5py.File(tmp_path / "case.h5") as file:
            intervals[scheme] = file["input/effective/domain"].attrs["intervals"]
    assert intervals["upwind2"] < intervals["kappa"]


def test_smallest_grids_call_no_library_wrongly(asperity, tmp_path):
    """LAPACK prints a line of its own where it is given sizes that cannot be."""
    said = ""
    for intervals in (8, 10, 12, 14, 16, 20, 24, 28, 32):
        for method in ("auto", "newton_krylov", "newton_dense"):
            values = f"domain.intervals={intervals}", f"solver.method={method}", "solver.space_scheme=kappa"
            changes = [word for value in values for word in ("--set", value)]
            done = asperity(MINIMAL, *changes, "--output", tmp_path, "--quiet")
            assert done.returncode in (0, 2)
            said += done.stdout + done.stderr
    assert "On entry" not in said

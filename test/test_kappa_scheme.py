"""The kappa space scheme has one solution at a pressure spike, whatever the start, and no zigzag in front of it."""

import random
import sys
from pathlib import Path

import h5py
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent.parent / "bench"))

import namelists

STARTS = (({}, True), ({}, False), ({"levels": 1}, False))
COUNT = 16


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

"""Whole time steps that end at the wanted time."""

import random

import h5py
import numpy as np
import pytest
from cases import TRANSIENT, write

FAST = "&accuracy error_bars = .false. /\n"
SOURCE = random.Random(20261122)
# End and step; the last one is given to a few digits only: rounding adds no step.
STEPS = [(0.37, 0.1), (0.3, 0.1), (0.1, 0.1), (0.218066, 0.0272583)]
STEPS += [(round(SOURCE.uniform(0.05, 0.4), 4), round(SOURCE.uniform(0.01, 0.05), 4)) for _ in range(8)]


def case(end, step):
    return TRANSIENT.replace("end_time = 1.0", f"end_time = {end}").replace("time_step = 0.05", f"time_step = {step}") + FAST


def test_steps_end_at_the_end_time(asperity, tmp_path):
    for i, (end, step) in enumerate(STEPS):
        write(tmp_path, f"{i}.nml", case(end, step))
    assert asperity(*(f"{i}.nml" for i in range(len(STEPS))), "--quiet").returncode == 0
    for i, (end, step) in enumerate(STEPS):
        with h5py.File(tmp_path / f"{i}.h5") as file:
            times, taken = file["transient/time"][()], file["input/effective/time"].attrs["time_step"]
        assert times[-1] == pytest.approx(end, rel=1e-14)
        assert np.diff(times) == pytest.approx(taken, rel=1e-9)
        # the given step or shorter, by no more than the last step was too long
        assert taken <= step * (1 + 1e-3)
        assert len(times) - 1 == int(np.ceil(end / step - 1e-3))


def test_a_step_that_fits_is_taken_as_it_is(solved_case):
    step = 5.37109375e-3
    with solved_case(case(20 * step, step)) as file:
        assert file["input/effective/time"].attrs["time_step"] == step

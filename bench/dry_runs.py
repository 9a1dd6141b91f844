"""Runs of dry cases for the charts and maps, and what is read of their results."""

from __future__ import annotations

import h5py
from bench_program import Answer, run_program
from namelists import Groups, namelist

METHODS = ("conjugate_gradient", "steepest_descent")
Case = Groups


class Outcome(Answer):
    """What a run gives: iterations (cycles), transforms, processor time, separation, area and violation of the last load."""


def read(file: h5py.File) -> Outcome:
    """From a result."""
    sweep, report = file["sweep"], file["report"]
    names = {"separation": "mean_separation", "area": "contact_area_fraction", "kkt": "kkt"}
    numbers = {"cycles": int(report["cycles"][()]), "pairs": int(report["fft_pairs"][()])}
    words = {"method": report["method"][()].decode(), "reason": file.attrs["reason"].decode()}
    times = {"seconds": float(report["cpu_seconds"][()])}
    return Outcome(words | numbers | times | {key: float(sweep[name][-1]) for key, name in names.items()})


def run(case: Case | str) -> Outcome | None:
    """Runs one case; None if its input is refused."""
    status, _, found = run_program(namelist(case), read)
    return Outcome(found | {"converged": int(status == 0)}) if found and status in (0, 2) else None

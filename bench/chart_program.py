"""The whole program for the chart: start-up, reading, solving, error bars, adequacy and writing, on the grids of a panel."""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from bench_program import ENVIRONMENT, ROOT

PROGRAM = ROOT / "build" / "bin" / "asperity"


def times_of(texts: dict[int, str], runs: int, seconds: float) -> dict[int, tuple[float, float]]:
    """Wall time of the program for each namelist [s]: the least, and what nine tenths of the runs stay below.

    At most `runs` runs, and none after `seconds`; a case that does not converge is left out.
    """
    found = {}
    with tempfile.TemporaryDirectory() as name:
        for n, text in texts.items():
            path = Path(name) / "case.nml"
            path.write_text(text, encoding="utf-8")
            command = [PROGRAM, path, "--output", name, "--quiet"]
            used: list[float] = []
            begun = time.perf_counter()
            while len(used) < runs and (not used or time.perf_counter() - begun < seconds):
                start = time.perf_counter()
                done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, check=False)
                used.append(time.perf_counter() - start)
                if done.returncode != 0:
                    break
            else:
                found[n] = (min(used), float(np.quantile(used, 0.9)))
    return found

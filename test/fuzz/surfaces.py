"""Cases that read a file of heights, and what counts as broken in their answers."""

from pathlib import Path

import h5py
import numpy as np
from run import Run, call

LINE = """&case problem = 'dry_line' /
&bodies reduced_modulus = 2e11 /
&load mean_pressure = 1e7 /
&surface_1 shape = 'file', file = '{file}'{more} /
"""
AREA = LINE.replace("dry_line", "dry_area")
OIL = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 2e11, speed_1 = 1.0, speed_2 = 0.0 /
&load load_per_length = 1e5 /
&lubricant viscosity = 0.05, pressure_viscosity = 2e-8, roelands_z = 0.6 /
&surface_2 shape = 'file', file = '{file}'{more} /
&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 64 /
&accuracy error_bars = .false. /
"""
CASES = {"line": LINE, "area": AREA, "oil": OIL}


def solved(program: Path, folder: Path, kind: str, file: str, more: str = "", **options) -> Run:
    (folder / "case.nml").write_text(CASES[kind].format(file=file, more=more), encoding="utf-8")
    return call(program, folder, "case.nml", "--quiet", **options)


def nonsense(path: Path) -> str | None:
    """Fields of a result that says `converged` and holds what is no answer."""
    with h5py.File(path) as file:
        if not file.attrs["converged"]:
            return None
        for name in ("solution", "sweep", "summary", "surface"):
            for key, data in file.get(name, {}).items():
                values = data[()]
                if not np.all(np.isfinite(values)) or (key == "pressure" and np.min(values) < 0):
                    return f"{name}/{key} with converged = 1"
    return None


def judged(run: Run, folder: Path, file: str, is_good: bool | None = None) -> str | None:
    """What broke: a crash, a message without the file, nonsense that converged, bad heights taken or good ones refused."""
    if run.trouble():
        return run.trouble()
    if run.status == 1:
        if is_good:
            return f"good heights refused: {run.err.strip()[-200:]}"
        return None if file in run.err and "case.nml:" in run.err else f"no file in the message: {run.err.strip()[-200:]}"
    if is_good is False:
        return f"bad heights taken, status {run.status}"
    return nonsense(folder / "case.h5") if (folder / "case.h5").exists() else f"no result, status {run.status}"

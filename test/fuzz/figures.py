"""Damaged and foreign result files given to the figure scripts: a figure, or one line and a status that is not 0."""

import functools
import random
import sys
import tempfile
from pathlib import Path

import damage
from cases import POINT, STEADY, TRANSIENT, write
from run import ROOT, call

TITLE = "result files, damaged, given to the figure scripts"
CASES = 300
QUICK = 3
SCRIPTS = ("profile", "transient", "convergence", "compare", "film_statistics", "dry", "point")
DRY = """&case problem = 'dry_line' /
&bodies youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3, hardness = 4e9 /
&load mean_pressure = 1e8, 2e8 /
&surface_1 shape = 'synthetic', seed = 1, hurst = 0.8, rms_height = 5e-7, wavelength_long = 1e-4, wavelength_short = 4e-6 /
&domain length = 4e-4, intervals = 512 /
"""
CONTENT = {"steady": STEADY, "transient": TRANSIENT + "&output film_thresholds = 2e-7, 4e-7 /\n", "dry": DRY, "point": POINT}


@functools.cache
def result(program: Path, kind: str) -> bytes:
    with tempfile.TemporaryDirectory() as name:
        write(Path(name), "case.nml", CONTENT[kind])
        run = call(program, Path(name), "case.nml", "--quiet")
        assert run.status == 0, run.err
        return (Path(name) / "case.h5").read_bytes()


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    script = source.choice(SCRIPTS)
    suited = {"dry": ("dry",), "point": ("point",), "transient": ("transient",), "film_statistics": ("transient",)}
    kind = source.choice(suited.get(script, ("steady", "transient")))
    (folder / "case.h5").write_bytes(damage.damaged(result(program, kind), source))
    arguments = [ROOT / "postproc" / f"{script}.py", "case.h5", "--format", "png"]
    if script == "compare":
        (folder / "good.h5").write_bytes(result(program, kind))
        arguments[2:2] = ["good.h5"]
    if script == "transient":
        arguments += ["--parts", "xt"]
    run = call(Path(sys.executable), folder, *arguments)
    if run.status is None or run.status < 0:
        return f"{script}: hang or crash ({run.status}): {run.err.strip()[-200:]}"
    if "Traceback" in run.err:
        return f"{script}: {run.err.strip()[-300:]}"
    if run.status == 0:
        return None if list(folder.glob("*.png")) else f"{script}: status 0 without a figure"
    return None if run.err.strip() else f"{script}: status {run.status} without a word"

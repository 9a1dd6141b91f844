"""The inputs of the repository and the templates of the program: does a finer, longer, later run contradict their numbers?

The members are what is there: the seed and the number of members do not matter.
"""

from __future__ import annotations

import copy
import io
import random
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

import f90nml
import h5py
from bench_program import ENVIRONMENT, ROOT
from families import FINER, PROGRAM, Family, Member, Resolution
from family_dry import height_file

QUANTITIES = {
    "ehl_line": ("summary/h_min", "summary/h_central", "summary/p_max"),
    "dry": ("summary/contact_area_fraction", "summary/mean_separation", "summary/p_max"),
    "plastic": ("summary/contact_area_fraction", "summary/plastic_area_fraction", "summary/mean_separation"),
}
HEIGHTS = "heights"
# Domains of the truths, of those in time at least; intervals of those in time, at least.
AT_REST = {"x_inlet": -60.0, "x_outlet": 6.0, "intervals": 2**16}
ENDS_IN_TIME, INTERVALS_IN_TIME = (-9.0, 3.0), 2048


def kind_of(case: f90nml.Namelist) -> str:
    """Which quantities are judged."""
    if case["case"]["problem"] == "ehl_line":
        return "ehl_line"
    return "plastic" if "hardness" in case["bodies"] else "dry"


def shipped() -> list[tuple[str, f90nml.Namelist]]:
    """Name and namelist of each input and of each template."""
    found = [(path.stem, f90nml.read(path)) for path in sorted((ROOT / "input").glob("*.nml"))]
    for problem in ("ehl_line", "dry_line", "dry_area"):
        command = [PROGRAM, "--template", problem]
        done = subprocess.run(command, env=ENVIRONMENT, check=True, capture_output=True, text=True)
        found.append((f"template_{problem}", f90nml.reads(done.stdout)))
    return found


def text_of(case: f90nml.Namelist) -> str:
    """The namelist as text."""
    buffer = io.StringIO()
    case.write(buffer)
    return buffer.getvalue()


def finer_film(case: f90nml.Namelist) -> str | Callable[[Resolution], str]:
    """A lubricated truth: a long domain, a fine grid, a fine step; of periodic waves many periods later."""
    truth = copy.deepcopy(case)
    truth["accuracy"] = {"error_bars": False}
    if not case.get("time", {}).get("transient", False):
        truth["domain"] = AT_REST
        return text_of(truth)

    def finer(found: Resolution) -> str:
        domain = found.ends(*ENDS_IN_TIME)
        domain["intervals"] = found.intervals(domain["x_outlet"] - domain["x_inlet"], INTERVALS_IN_TIME)
        truth["domain"] = domain
        truth["time"] |= {"time_step": found.time_step(case["time"]["end_time"]), "scheme": "bdf2"}
        if case.get("surface_1", {}).get("shape") == "sinusoid":
            truth["time"]["end_time"] = 3 * case["time"]["end_time"]
        return text_of(truth)

    return finer


def finer_contact(case: f90nml.Namelist, files: dict[str, str | bytes]) -> f90nml.Namelist:
    """A dry truth: the heights that the case had, on more nodes."""
    truth = copy.deepcopy(case)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "case.nml").write_text(text_of(case), encoding="utf-8")
        for file, content in files.items():
            (folder / file).write_bytes(content)
        subprocess.run([PROGRAM, "--quiet", "case.nml"], cwd=folder, env=ENVIRONMENT, check=True)
        with h5py.File(folder / "case.h5") as result:
            heights = result["solution/height_undeformed"][()]
            spacing = [float(result[f"solution/{axis}"][1] - result[f"solution/{axis}"][0]) for axis in "xy"[: heights.ndim]]
    names = ("",) if heights.ndim == 1 else ("_x", "_y")
    truth["accuracy"] = {"error_bars": False}
    truth["domain"] = {
        **{key: value for key, value in case.get("domain", {}).items() if key == "periodic"},
        **{f"intervals{name}": FINER * nodes for name, nodes in zip(names, heights.shape[::-1], strict=True)},
    }
    if case["surface_1"]["shape"] == "parabola":
        truth["domain"] |= {key: value for key, value in case["domain"].items() if key.startswith("length")}
        return truth
    files[f"{HEIGHTS}.h5"] = height_file(heights, spacing)
    truth["surface_1"] = {"shape": "file", "file": f"{HEIGHTS}.h5", "dataset": "z"}
    return truth


def members(kind: str):
    """Draws those whose quantities are `kind`."""

    def draw(_source: random.Random, _count: int) -> list[Member]:
        found = []
        for name, case in shipped():
            if kind_of(case) != kind:
                continue
            files: dict[str, str | bytes] = {}
            surface = case.get("surface_1", {})
            if "file" in surface:
                source = (ROOT / "input" / surface["file"]).resolve()
                files[source.name] = source.read_bytes()
                surface["file"] = source.name
            truth = finer_film(case) if kind == "ehl_line" else text_of(finer_contact(case, files))
            found.append(Member(name, text_of(case), truth, files=files))
        return found

    return draw


FAMILIES = [
    Family("shipped_film", "Lubricated inputs and template", QUANTITIES["ehl_line"], members("ehl_line"), given=True),
    Family("shipped_dry", "Dry elastic inputs", QUANTITIES["dry"], members("dry"), given=True),
    Family("shipped_plastic", "Dry inputs and templates with a hardness", QUANTITIES["plastic"], members("plastic"), given=True),
]

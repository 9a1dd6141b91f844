"""Checks the inputs of the repository and the templates against finer, longer, later runs."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import f90nml
from bench_program import ASPERITY, ENVIRONMENT, ROOT, run_program
from family_dry import height_file
from judge import FINER, Member, Resolution, finer_passage
from namelists import NO_BARS, Groups, namelist

# Domain of a truth at rest; ends of one in time, at least.
AT_REST, ENDS_IN_TIME = {"x_inlet": -60.0, "x_outlet": 6.0, "intervals": 2**16}, (-9.0, 3.0)

# Of histories the command of asperity-duty that makes their namelist, and times the intervals of the truth: some take long.
DUTY = {
    **{"spur_gear": ("gear", 2), "cam": ("cam", 2), "reciprocating": ("", 4)},
    **{"stop_start": ("", 4), "mixed_start": ("", 4), "rough_ring": ("", 2)},
}


def kind_of(case: Groups) -> str:
    """Which quantities are judged."""
    if case["case"]["problem"] == "ehl_line":
        return "film"
    return "plastic" if "hardness" in case["bodies"] else "dry"


def groups_of(case: f90nml.Namelist) -> Groups:
    """The groups of a namelist, without its title."""
    groups = {name: dict(keys) for name, keys in case.items()}
    groups["case"].pop("title", None)
    return groups


def shipped() -> list[tuple[str, Groups]]:
    """Name and groups of each input and of each template."""
    found = [(path.stem, groups_of(f90nml.read(path))) for path in sorted((ROOT / "input").glob("*.nml"))]
    for problem in ("ehl_line", "dry_line", "dry_area"):
        command = [ASPERITY, "--template", problem]
        done = subprocess.run(command, env=ENVIRONMENT, check=True, capture_output=True, text=True)
        found.append((f"template_{problem}", groups_of(f90nml.reads(done.stdout))))
    return found


def finer_film(case: Groups) -> Groups | Callable:
    """A lubricated truth: long domain and fine grid, or a target; in time a fine step; of periodic waves many periods later."""
    if not case.get("time", {}).get("transient", False):
        return case | ({"accuracy": NO_BARS, "domain": AT_REST} if "domain" in case else {"accuracy": {"target": 1e-4}})
    end = case["time"]["end_time"]
    later = {"end_time": 3 * end} if case.get("surface_1", {}).get("shape") == "sinusoid" else {}
    return finer_passage(case, ENDS_IN_TIME, 2048, end, scheme="bdf2", **later)


def finer_contact(case: Groups, files: dict[str, str | bytes]) -> Groups:
    """A dry truth: the heights that the case had, on more nodes; `files` gets them."""

    def solved(file):
        z = file["solution/height_undeformed"][()]
        return z, [float(file[f"solution/{axis}"][1] - file[f"solution/{axis}"][0]) for axis in "xy"[: z.ndim]]

    z, spacings = run_program(namelist(case), solved, files).found
    names = ("",) if z.ndim == 1 else ("_x", "_y")
    given = case.get("domain", {})
    domain = {key: value for key, value in given.items() if key == "periodic"}
    domain |= {f"intervals{name}": FINER * nodes for name, nodes in zip(names, z.shape[::-1], strict=True)}
    truth = case | {"accuracy": NO_BARS, "domain": domain}
    if case["surface_1"]["shape"] == "parabola":
        return truth | {"domain": domain | {key: value for key, value in given.items() if key.startswith("length")}}
    files["heights.h5"] = height_file(z, spacings)
    return truth | {"surface_1": {"shape": "file", "file": "heights.h5", "dataset": "z"}}


def refined(case: Groups, factor: int, found: Resolution) -> Groups:
    """The truth of a history or a point: `factor` times the intervals."""
    key = "intervals_x" if case["case"]["problem"] == "ehl_point" else "intervals"
    return case | {"accuracy": NO_BARS, "domain": {key: factor * found.intervals}, "output": {}}


def histories() -> list[Member]:
    """Those of input/duty/, and the point contacts of input/scenes/."""
    found = []
    with tempfile.TemporaryDirectory() as name:
        for word in ("spur_gear", "cam"):
            command = [ASPERITY.with_name("asperity-duty"), DUTY[word][0], ROOT / "input/duty" / f"{word}.toml", "--output", name]
            subprocess.run(command, env=ENVIRONMENT, check=True, capture_output=True)
        paths = [
            Path(name) / f"{word}.nml" if command else ROOT / "input/duty" / f"{word}.nml" for word, (command, _) in DUTY.items()
        ]
        points = sorted(path for path in (ROOT / "input/scenes").glob("*.nml") if "ehl_point" in path.read_text(encoding="utf-8"))
        for path in (*paths, *points):
            case = groups_of(f90nml.read(path))
            files = {case["history"]["file"]: (path.parent / case["history"]["file"]).read_bytes()} if "history" in case else {}
            truth = partial(refined, case, DUTY.get(path.stem, ("", 2))[1])
            found.append(Member(case, truth, files=files, name=path.stem))
    return found


def members(kind: str) -> Callable[[], list[Member]]:
    """Those of a kind."""

    def all_of_them() -> list[Member]:
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
            truth = finer_film(case) if kind == "film" else finer_contact(case, files)
            found.append(Member(case, truth, files=files, name=name))
        return found

    return all_of_them

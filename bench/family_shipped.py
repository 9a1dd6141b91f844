"""Checks the inputs of the repository and the templates against finer, longer, later runs."""

from __future__ import annotations

import subprocess
from collections.abc import Callable

import f90nml
from bench_program import ASPERITY, ENVIRONMENT, ROOT, run_program
from family_dry import height_file
from judge import FINER, Member, finer_passage
from namelists import NO_BARS, Groups, namelist

# Domain of a truth at rest; ends of one in time, at least.
AT_REST, ENDS_IN_TIME = {"x_inlet": -60.0, "x_outlet": 6.0, "intervals": 2**16}, (-9.0, 3.0)


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

    z, spacings = run_program(namelist(case), solved, files)[2]
    names = ("",) if z.ndim == 1 else ("_x", "_y")
    given = case.get("domain", {})
    domain = {key: value for key, value in given.items() if key == "periodic"}
    domain |= {f"intervals{name}": FINER * nodes for name, nodes in zip(names, z.shape[::-1], strict=True)}
    truth = case | {"accuracy": NO_BARS, "domain": domain}
    if case["surface_1"]["shape"] == "parabola":
        return truth | {"domain": domain | {key: value for key, value in given.items() if key.startswith("length")}}
    files["heights.h5"] = height_file(z, spacings)
    return truth | {"surface_1": {"shape": "file", "file": "heights.h5", "dataset": "z"}}


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

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
from judge import FINER, Answer, Member, finer_passage
from namelists import NO_BARS, Groups, namelist

# Domain of a truth at rest; ends of one in time, at least.
AT_REST, ENDS_IN_TIME = {"x_inlet": -60.0, "x_outlet": 6.0, "intervals": 2**16}, (-9.0, 3.0)

# Histories that asperity-duty makes.
DUTY = (("gear", "spur_gear"), ("cam", "cam"))
# Of histories and points times the intervals of the truth: the rest takes long.
REFINED, FINER_HISTORIES = 2, {"reciprocating": 4, "stop_start": 4, "mixed_start": 4}


def kind_of(case: Groups) -> str:
    """Which quantities are judged."""
    problem = case["case"]["problem"]
    if "history" in case or problem == "ehl_point":
        return "history"
    return "film" if problem == "ehl_line" else "plastic" if "hardness" in case["bodies"] else "dry"


def groups_of(case: f90nml.Namelist) -> Groups:
    """The groups of a namelist, without its title."""
    groups = {name: dict(keys) for name, keys in case.items()}
    groups["case"].pop("title", None)
    return groups


def shipped(folder: Path) -> list[tuple[Path, Groups]]:
    """File and groups of each input, template, history, and point contact of the scenes; made ones are put into the folder."""
    source = ROOT / "input"
    commands = [(ASPERITY.with_name("asperity-duty"), word, source / "duty" / f"{name}.toml") for word, name in DUTY]
    for command in commands:
        subprocess.run([*command, "--output", folder], env=ENVIRONMENT, check=True, capture_output=True)
    for problem in ("ehl_line", "dry_line", "dry_area"):
        done = subprocess.run([ASPERITY, "--template", problem], env=ENVIRONMENT, check=True, capture_output=True)
        (folder / f"template_{problem}.nml").write_bytes(done.stdout)
    paths = [path for each in (source, folder, source / "duty") for path in sorted(each.glob("*.nml"))]
    points = sorted(path for path in (source / "scenes").glob("*.nml") if "ehl_point" in path.read_text(encoding="utf-8"))
    return [(path, groups_of(f90nml.read(path))) for path in (*paths, *points)]


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


def refined(case: Groups, factor: int, found: Answer) -> Groups:
    """The truth of a history or a point: `factor` times the intervals."""
    key = "intervals_x" if case["case"]["problem"] == "ehl_point" else "intervals"
    return case | {"accuracy": NO_BARS, "domain": {key: factor * found[key]}, "output": {}}


def members(kind: str) -> Callable[[], list[Member]]:
    """Those of a kind."""

    def all_of_them() -> list[Member]:
        found = []
        with tempfile.TemporaryDirectory() as name:
            for path, case in ((path, case) for path, case in shipped(Path(name)) if kind_of(case) == kind):
                files: dict[str, str | bytes] = {}
                for group in (case[key] for key in ("surface_1", "history") if "file" in case.get(key, {})):
                    source = path.parent / group["file"]
                    files[source.name] = source.read_bytes()
                    group["file"] = source.name
                if kind == "history":
                    truth = partial(refined, case, FINER_HISTORIES.get(path.stem, REFINED))
                else:
                    truth = finer_film(case) if kind == "film" else finer_contact(case, files)
                found.append(Member(case, truth, files=files, name=path.stem))
        return found

    return all_of_them

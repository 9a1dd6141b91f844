"""Names of results that lead to something else: inputs, other results, files of the user, through links and folders."""

import os
import random
from pathlib import Path

import h5py
import numpy as np
from cases import STEADY
from run import call

TITLE = "names of results (inputs, other results, files of the user; links, folders, temporary names)"
CASES = 300
SMALL = STEADY.replace("intervals = 256", "intervals = 32")
DRY = """&case problem = 'dry_line' /
&bodies youngs_modulus_1 = 206e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 1e8 /
&surface_1 shape = 'file', file = 'heights.h5', dataset = 'z' /
"""
ENDINGS = ["", "", "", ".part", ".tmp", ".ckpt", ".ckpt.tmp"]


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    (folder / "sub").mkdir()
    (folder / "loop").symlink_to(source.choice([".", "sub/.."]))
    (folder / "precious.txt").write_text("precious", encoding="utf-8")
    with h5py.File(folder / "heights.h5", "w") as file:
        file["z"] = 1e-7 * np.cos(2 * np.pi * np.arange(64) / 64)
        file["z"].attrs["spacing"] = 1e-6
    targets = ["precious.txt", "heights.h5", "a.nml", "b.nml", "x.h5", "sub/x.h5", "a.h5", "b.h5"]
    for name in ("a", "b"):
        text = source.choice([SMALL, DRY])
        if source.random() < 0.8:
            output = disguised(source.choice(targets) + source.choice(ENDINGS), folder, source)
            text = text.replace("&case", f"&case output = '{output}',")
        (folder / f"{name}.nml").write_text(text, encoding="utf-8")
    if source.random() < 0.3:
        beside = folder / f"{source.choice(['x.h5', 'a.h5', 'b.h5'])}{source.choice(ENDINGS)}"
        if not beside.exists() and source.random() < 0.5:
            beside.write_text("precious", encoding="utf-8")
        elif not beside.exists():
            beside.symlink_to(source.choice(["precious.txt", "heights.h5", "a.nml"]))
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file() and not path.is_symlink()}
    links = {path: path.readlink() for path in folder.rglob("*") if path.is_symlink()}
    run = call(program, folder, "a.nml", "b.nml", "--quiet", *source.choice([(), ("--resume",)]))
    return run.trouble() or look_at(folder, run.status, before, links)


def disguised(name: str, folder: Path, source: random.Random) -> str:
    """Another way to the same file: a detour, the whole path, or a link."""
    way = source.randrange(6)
    if way == 0:
        return f"./{name}"
    if way == 1:
        return f"sub/../loop/{name}"
    if way == 2:
        return str(folder / name)
    link = folder / f"link{source.randrange(3)}.h5"
    if way == 3 and not link.exists() and not link.is_symlink():
        link.symlink_to(name)
        return link.name
    if way == 4 and (folder / name).is_file() and not link.exists() and not link.is_symlink():
        os.link(folder / name, link)
        return link.name
    return name


def look_at(folder: Path, status: int, before: dict[Path, bytes], links: dict[Path, Path]) -> str | None:
    """What was there must be there; status 0 means two results."""
    lost = [path.name for path, content in before.items() if not path.exists() or path.read_bytes() != content]
    if lost:
        return f"status {status}, lost: {lost}"
    followed = [path.name for path, target in links.items() if path.is_symlink() and path.readlink() != target]
    if followed:
        return f"link changed: {followed}"
    new = [path for path in folder.rglob("*") if path.is_file() and not path.is_symlink() and path not in before]
    left = [path.name for path in new if not is_result(path)]
    if left:
        return f"status {status}, left over: {left}"
    return f"status 0 with {len(new)} results" if status == 0 and len(new) != 2 else None


def is_result(path: Path) -> bool:
    try:
        with h5py.File(path) as file:
            return "converged" in file.attrs
    except OSError:
        return False

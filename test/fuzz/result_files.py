"""Damaged, foreign and misplaced results, checkpoints and parts: refused with the reason or made again, never taken for whole."""

import contextlib
import functools
import os
import random
import shutil
import signal
import sys
import tempfile
from pathlib import Path

import h5py
from cases import HARD, POINT, STEADY, TRANSIENT, case_text, damaged, seal, write
from kill_and_resume import busy, different, start, undisturbed, wait_for
from run import ROOT, attack, call
from test_output_names import DRY, heights

sys.path += [str(ROOT / "python"), str(ROOT / "batch")]

import asperity
import numpy as np
from gather import DONE, FAILURE, outcome_of
from result_row import RowReader


@functools.cache
def interrupted(program: Path) -> Path:
    """A folder with an interrupted run, and what comes out where nobody ends it (reference.h5)."""
    folder = Path(tempfile.mkdtemp(prefix="interrupted_"))
    undisturbed(program, folder, busy(0.0).replace("end_time = 12.0", "end_time = 1.0"))
    with start(program, folder) as running:
        wait_for(folder / "case.h5.ckpt", running)
        running.send_signal(signal.SIGTERM)
    return folder


@attack("damaged checkpoints and `.part` files (bytes flipped, zeroed, cut, swapped), `--resume`", 1000)
def checkpoints(program: Path, source: random.Random, folder: Path) -> str | None:
    shutil.copytree(interrupted(program), folder, dirs_exist_ok=True)
    victim = folder / source.choice(["case.h5.ckpt", "case.h5.ckpt", "case.h5.ckpt", "case.h5.part"])
    victim.write_bytes(damaged(victim.read_bytes(), source))
    kept = {path.name: path.read_bytes() for path in folder.iterdir()}
    run = call(program, folder, "case.nml", "--resume", "--quiet")
    if run.trouble():
        return run.trouble()
    if run.status == 0:
        paths = different(folder / "reference.h5", folder / "case.h5")
        return f"resumed to other bits: {paths[:3]}" if paths else None
    if run.status != 1 or "cannot resume" not in run.err or "starts at the beginning" not in run.err:
        return f"status {run.status}: {run.err.strip()[-200:]}"
    now = {path.name: path.read_bytes() for path in folder.iterdir()}
    return None if now == kept else f"refused, but changed {[name for name in kept if now.get(name) != kept[name]]}"


ROUGH = "shape = 'synthetic', seed = 1, hurst = 0.8, rms_height = 5e-7, wavelength_long = 1e-4, wavelength_short = 4e-6"
DRY_LINE = case_text(ROUGH, [1e8, 2e8], HARD, "&domain length = 4e-4, intervals = 512 /")
PASSAGE = TRANSIENT.replace("intervals = 256", "intervals = 64") + "&output film_thresholds = 2e-7, 4e-7 /\n"
CONTENT = {"steady": STEADY.replace("intervals = 256", "intervals = 64"), "transient": PASSAGE, "dry": DRY_LINE, "point": POINT}


@functools.cache
def complete(program: Path, kind: str) -> bytes:
    """The result of a kind."""
    with tempfile.TemporaryDirectory() as name:
        write(Path(name), f"{kind}.nml", CONTENT[kind])
        run = call(program, Path(name), f"{kind}.nml", "--quiet")
        assert run.status == 0, run.err
        return (Path(name) / f"{kind}.h5").read_bytes()


@attack("damaged results (bytes flipped, zeroed, cut, swapped), `--resume`", 1000, quick=8)
def results_resumed(program: Path, source: random.Random, folder: Path) -> str | None:
    name = source.choice(["steady", "transient"])
    write(folder, f"{name}.nml", CONTENT[name])
    (folder / "whole.h5").write_bytes(complete(program, name))
    (folder / f"{name}.h5").write_bytes(damaged(complete(program, name), source))
    run = call(program, folder, f"{name}.nml", "--resume")
    if run.trouble():
        return run.trouble()
    if "nothing to do" in run.err:
        return "taken for complete"
    if run.status == 0:
        paths = different(folder / "whole.h5", folder / f"{name}.h5")
        return f"other bits: {paths[:3]}" if paths else None
    return None if run.status == 1 and "no result of asperity" in run.err else f"status {run.status}: {run.err.strip()[-200:]}"


KINDS = ["bytes", "bytes", "bytes", "foreign", "edited", "behind", "other", "whole"]
VALUES = [1.0, b"text", np.zeros(0), np.arange(3), np.zeros((2, 3, 4)), h5py.Empty("f8")]
VALUES += [np.array((1, 2.0), dtype=[("a", "i4"), ("b", "f8")])]
NAMES = ["summary/h_min", "solution/x", "solution/pressure", "report/method", "input/namelist", "transient", "scaling"]
NAMES += ["adequacy/validity/x"]


def change(path: Path, source: random.Random) -> None:
    """Something else in the place of a dataset or an attribute, through HDF5, which keeps no seal."""
    with h5py.File(path, "a") as file:
        for name in source.sample(NAMES, source.randint(1, 4)):
            if name in file:
                del file[name]
            with contextlib.suppress(ValueError, OSError, TypeError):  # a dataset is in the way
                file[name] = source.choice(VALUES)
                file[name].attrs[source.choice(["si_scale", "units", "error_estimate", "verdict"])] = source.choice(VALUES)
        name = source.choice(["program", "converged", "reason", "title", "problem"])
        file.attrs[name] = source.choice(VALUES) if source.random() < 0.3 else b"asperity"


def put(path: Path, kind: str, source: random.Random) -> None:
    """What is wrong with the file."""
    if kind == "bytes":
        path.write_bytes(damaged(path.read_bytes(), source))
    elif kind == "behind":
        path.write_bytes(path.read_bytes() + source.choice([b"\0", b"\n", source.randbytes(80)]))
    elif kind == "other":
        path.unlink()
        ways = [path.mkdir, lambda: os.mkfifo(path), lambda: path.symlink_to("/dev/zero")]
        source.choice([*ways, lambda: path.write_bytes(source.randbytes(300))])()
    elif kind != "whole":
        if kind == "foreign":
            path.unlink()
        change(path, source)


@attack("damaged, foreign and changed results, `asperity.read` and `gather`", 1000, quick=20)
def results_read(program: Path, source: random.Random, folder: Path) -> str | None:
    name, kind = source.choice(["steady", "transient"]), source.choice(KINDS)
    write(folder, f"{name}.nml", CONTENT[name])
    path = folder / f"{name}.h5"
    path.write_bytes(complete(program, name))
    put(path, kind, source)
    is_sealed = kind in ("foreign", "edited") and source.random() < 0.5
    if is_sealed:
        seal(path)
    status, reason, _, values = outcome_of(folder / name, RowReader(), {}, {})
    was_read = False
    try:
        result = asperity.read(path)
        was_read = True
        for part in ("summary", "solution", "transient", "sweep", "report", "verdicts", "case", "x", "pressure", "film"):
            getattr(result, part)
        repr(result)
    except asperity.AsperityError as error:
        if str(path) not in str(error):
            return f"{kind}: no name in the message: {error}"
    except Exception as error:  # whatever it is
        return f"{kind}: {type(error).__name__}: {error!s:.200}"
    if is_sealed:
        return None
    wanted = DONE if kind == "whole" else FAILURE
    if was_read != (kind == "whole"):
        return f"{kind}: {'read' if was_read else 'refused'}"
    return None if status == wanted and bool(values) == (kind == "whole") else f"{kind}: gathered as {status}: {reason}"


SCRIPTS = ("profile", "transient", "convergence", "compare", "film_statistics", "dry", "point")


@attack("result files, damaged, given to the figure scripts", 300, quick=3)
def figures(program: Path, source: random.Random, folder: Path) -> str | None:
    script = source.choice(SCRIPTS)
    suited = {"dry": ("dry",), "point": ("point",), "transient": ("transient",), "film_statistics": ("transient",)}
    kind = source.choice(suited.get(script, ("steady", "transient")))
    (folder / "case.h5").write_bytes(damaged(complete(program, kind), source))
    arguments = [ROOT / "postproc" / f"{script}.py", "case.h5", "--format", "png"]
    if script == "compare":
        (folder / "good.h5").write_bytes(complete(program, kind))
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


SMALL = STEADY.replace("intervals = 256", "intervals = 32")
MEASURED = DRY.replace("rough.h5", "heights.h5")
ENDINGS = ["", "", "", ".part", ".tmp", ".ckpt", ".ckpt.tmp"]


@attack("names of results (inputs, other results, files of the user; links, folders, temporary names)", 300)
def outputs(program: Path, source: random.Random, folder: Path) -> str | None:
    (folder / "sub").mkdir()
    (folder / "loop").symlink_to(source.choice([".", "sub/.."]))
    (folder / "precious.txt").write_text("precious", encoding="utf-8")
    heights(folder / "heights.h5")
    targets = ["precious.txt", "heights.h5", "a.nml", "b.nml", "x.h5", "sub/x.h5", "a.h5", "b.h5"]
    for name in ("a", "b"):
        text = source.choice([SMALL, MEASURED])
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

"""What the package puts on PATH: the program itself, and the scripts for figures and sweeps."""

from __future__ import annotations

import os
import runpy
import sys
from pathlib import Path

from .errors import AsperityError
from .program import program_path

HERE = Path(__file__).resolve().parent


def asperity() -> None:
    """The program, in place of this process; `asperity gear` and `asperity cam`: what writes its input."""
    if sys.argv[1:2] in (["gear"], ["cam"]):
        from . import duty  # noqa: PLC0415 -- the program alone starts without numpy

        sys.exit(duty.main(sys.argv[1:], "asperity"))
    path = _program()
    try:
        os.execv(path, ["asperity", *sys.argv[1:]])
    except OSError as error:
        sys.exit(f"asperity: {path} cannot be run: {error.strerror}")


def _program() -> Path:
    """The program, else one line and status 1."""
    try:
        return program_path()
    except AsperityError as error:
        sys.exit(f"asperity: {error}")


def plot() -> None:
    """`asperity-plot SCRIPT ...`: a script of postproc/."""
    _run_script("asperity-plot", "postproc")


def batch() -> None:
    """`asperity-batch SCRIPT ...`: a script of batch/."""
    _run_script("asperity-batch", "batch")


def _run_script(command: str, name: str) -> None:
    """Runs a script of a folder as if called itself: the folder first on the path of modules."""
    folder = next(path for path in (HERE / name, HERE.parent.parent / name) if path.is_dir())
    # who can be called has a main()
    scripts = {path.stem: path for path in sorted(folder.glob("*.py")) if "__main__" in path.read_text(encoding="utf-8")}
    if len(sys.argv) < 2 or sys.argv[1] not in scripts:
        wants_help = len(sys.argv) > 1 and sys.argv[1] in ("-h", "--help")
        words = f"{command} SCRIPT [ARGUMENTS], SCRIPT one of: {', '.join(scripts)}\n{command} SCRIPT --help says what it does"
        print(words, file=sys.stdout if wants_help else sys.stderr)
        sys.exit(0 if wants_help else 1)
    path = scripts[sys.argv[1]]
    sys.path.insert(0, str(folder))
    sys.argv = [str(path), *sys.argv[2:]]
    os.environ.setdefault("ASPERITY", str(_program()))
    runpy.run_path(str(path), run_name="__main__")

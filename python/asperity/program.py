"""Where the program is."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from .errors import AsperityError


def program_path() -> Path:
    """The program: the environment variable ASPERITY, that of this package, that of a checkout, or the first on PATH."""
    given = os.environ.get("ASPERITY")
    if given:
        if not Path(given).is_file():
            raise AsperityError(f"the environment variable ASPERITY names {given}, which is no file")
        return Path(given).resolve()
    here = Path(__file__).resolve().parent
    for path in (here / "bin" / "asperity", here.parent.parent / "build" / "bin" / "asperity"):
        if path.is_file():
            return path
    found = shutil.which("asperity")
    if found is None:
        raise AsperityError("the program asperity is not here: neither in the package, nor on PATH, nor in the variable ASPERITY")
    return Path(found)


def version() -> str:
    """Version and commit of the program."""
    done = subprocess.run([program_path(), "--version"], capture_output=True, text=True, errors="replace", check=False)
    if done.returncode != 0:
        raise AsperityError(f"{program_path()} does not run: {done.stderr.strip()}")
    return done.stdout.splitlines()[0]

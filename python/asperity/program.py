"""Where the program is, and calls of it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections import deque
from collections.abc import Callable
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


def example(name: str) -> Path:
    """An input or profile that comes with the program: example("minimal.nml"); `example(".")` is the folder of all."""
    here = Path(__file__).resolve().parent
    folder = next(path for path in (here / "input", here.parent.parent / "input") if path.is_dir())
    path = folder / name
    if not path.exists():
        raise AsperityError(f"{name} is no example: {', '.join(sorted(file.name for file in folder.iterdir()))}")
    return path


def version() -> str:
    """Version and commit of the program."""
    status, lines = call(["--version"])
    if status != 0 or not lines or not lines[0].startswith("asperity "):
        raise AsperityError(end_of(status, lines))
    return lines[0]


def call(arguments: list[str], listen: Callable[[str], None] = lambda _: None, keep: int | None = None) -> tuple[int, list[str]]:
    """Runs the program: its status, and its last `keep` lines (default: all), each passed on as it comes.

    Raises AsperityError if the program is not there or cannot be started.
    """
    program = program_path()
    last: deque[str] = deque(maxlen=keep)
    try:
        process = subprocess.Popen(
            [str(program), *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="surrogateescape"
        )
    except (OSError, ValueError) as error:
        words = error.strerror if isinstance(error, OSError) else error
        raise AsperityError(f"{program} cannot be run: {words}") from error
    with process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                last.append(line.rstrip("\n"))
                listen(last[-1])
        except BaseException:  # also Ctrl-C: the program must not go on without its caller
            process.terminate()
            raise
    return process.returncode, list(last)


def end_of(status: int, lines: list[str]) -> str:
    """How the program ended without what was wanted of it, and what it said."""
    how = f"ended with status {status}"
    if status < 0:
        names = {number.value: number.name for number in signal.Signals}
        how = f"was killed by {names.get(-status, f'signal {-status}')}"
    return "\n".join([f"{program_path()} {how}{':' if lines else ', without a word'}", *map(printable, lines)])


def printable(text: str) -> str:
    """A line of the program with marks in place of what is no UTF-8."""
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")

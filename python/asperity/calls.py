"""Calls of the program: check a case, run a case."""

from __future__ import annotations

import re
import subprocess
import tempfile
import warnings
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .case_text import Case, name_and_text
from .errors import AsperityError, Finding, InputError, findings_in
from .program import program_path
from .result import Result, read

CONVERGED, BAD_INPUT, NOT_CONVERGED = 0, 1, 2
# Lines that are kept for the message of an error.
LAST_LINES = 50
_COUNT = re.compile(r"\b(\d+)/(\d+)\b")


class NotConvergedWarning(UserWarning):
    """The result is that of a case that did not converge; the message is the reason."""


@dataclass(frozen=True)
class Progress:
    """A line of the program's log; of a passage or a load sweep with the steps done and in all (0: no count)."""

    text: str
    done: int = 0
    total: int = 0


def check(case: Case) -> list[Finding]:
    """All that is wrong with a case, empty if nothing is; nothing is computed.

    `case`: path or text of a namelist, a mapping group -> key -> value, or a f90nml.Namelist.
    """
    name, text = name_and_text(case)
    with tempfile.TemporaryDirectory(prefix="asperity-") as folder:
        path = Path(folder) / f"{name}.nml"
        path.write_text(text, encoding="utf-8", errors="surrogateescape")
        done = subprocess.run([program_path(), "--check", path], capture_output=True, text=True, errors="replace", check=False)
    return [] if done.returncode == CONVERGED else findings_in(done.stderr)


def run(
    case: Case, folder: str | Path | None = None, threads: int = 1, progress: Callable[[Progress], None] | bool | None = None
) -> Result:
    """Computes a case and returns its result.

    `case`: as for `check`. `folder`: where the HDF5 file is kept, under the name of the case; without it the file lives as long as
    the result. `threads`: of dry areas. `progress`: is called with each line of the log; True shows a bar of tqdm.

    Raises InputError with all findings, AsperityError if the program ends without a result. A case that does not converge gives
    its result with `converged` False, and a NotConvergedWarning with the reason.
    """
    name, text = name_and_text(case)
    kept = tempfile.TemporaryDirectory(prefix="asperity-")
    path = Path(kept.name) / f"{name}.nml"
    path.write_text(text, encoding="utf-8", errors="surrogateescape")
    target = Path(kept.name) if folder is None else Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    command = [str(program_path()), str(path), "--output", str(target), "--threads", str(threads)]
    status, lines = _followed(command, _listener(progress))
    if status == BAD_INPUT and lines:
        raise InputError(findings_in("\n".join(lines)))
    if status not in (CONVERGED, NOT_CONVERGED):
        raise AsperityError("\n".join(lines) or f"the program ended with status {status}")
    result = read(target / f"{name}.h5", keep=kept if folder is None else None)
    if not result.converged:
        warnings.warn(result.reason, NotConvergedWarning, stacklevel=2)
    return result


def _followed(command: list[str], listen: Callable[[Progress], None]) -> tuple[int, list[str]]:
    """Exit status and last lines of a call whose lines are passed on as they come."""
    last: deque[str] = deque(maxlen=LAST_LINES)
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace") as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                last.append(line.rstrip())
                count = _COUNT.search(line)
                listen(Progress(line.rstrip(), *map(int, count.groups())) if count else Progress(line.rstrip()))
        except BaseException:  # also Ctrl-C: the program must not go on without its caller
            process.terminate()
            raise
    return process.returncode, list(last)


def _listener(progress: Callable[[Progress], None] | bool | None) -> Callable[[Progress], None]:
    if progress is None or progress is False:
        return lambda _: None
    if callable(progress):
        return progress
    from tqdm import tqdm  # noqa: PLC0415 -- only for those who want a bar

    bar = tqdm(unit="step")

    def show(state: Progress) -> None:
        if state.total:
            bar.total = state.total
            bar.update(state.done - bar.n)
        if state.done and state.done == state.total:
            bar.close()

    return show

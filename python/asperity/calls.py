"""Calls of the program: check a case, run a case."""

from __future__ import annotations

import re
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .case_file import Case, namelist_of
from .errors import AsperityError, Finding, InputError, findings_in
from .program import call, end_of, printable
from .result import Result, read

CONVERGED, BAD_INPUT, NOT_CONVERGED = 0, 1, 2
# Lines that are kept for the message of an error and the name of the result.
LAST_LINES = 500
_COUNT = re.compile(r"\b(\d+)/(\d+)\b")
_NO_FINDINGS = ": no findings"
_RESULT = "  result    "


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

    `case`: path or text of a namelist, a mapping group -> key -> value, or a f90nml.Namelist. Raises FileNotFoundError, and
    AsperityError if the program cannot say: it is not there, does not run, or died.
    """
    try:
        with namelist_of(case) as arguments:
            status, lines = call(["--check", *arguments])
    except InputError as error:  # what no namelist can say
        return error.findings
    findings = findings_in(lines, arguments[0])
    if status == CONVERGED and arguments[0] + _NO_FINDINGS in lines:
        return []
    if status == BAD_INPUT and findings:
        return findings
    raise AsperityError(end_of(status, lines))


def run(
    case: Case, folder: str | Path | None = None, threads: int = 1, progress: Callable[[Progress], None] | bool | None = None
) -> Result:
    """Computes a case and returns its result.

    `case`: as for `check`. `folder`: where the HDF5 file is kept, without it the file lives as long as the result. It gets the name
    that `output` of the case says, else that of the namelist, as from the program; a case without a file gets a name that no
    result in the folder has: case.h5, case_2.h5, ... `threads`: of dry areas. `progress`: is called with each line of the log;
    True shows a bar of tqdm.

    Raises FileNotFoundError, InputError with all findings, AsperityError if the program ends without a result. A case that does
    not converge, or whose `outcome` is outside the model, gives its result and a NotConvergedWarning with the reason.
    """
    kept = tempfile.TemporaryDirectory(prefix="asperity-") if folder is None else None
    target = Path(kept.name) if kept else Path(folder or "").absolute()
    target.mkdir(parents=True, exist_ok=True)
    with namelist_of(case, target) as arguments:
        options = ["--output", str(target), "--threads", str(threads)]
        status, lines = call([*arguments, *options], _listener(progress), LAST_LINES)
    findings = findings_in(lines, arguments[0])
    if status == BAD_INPUT and findings:
        raise InputError(findings)
    written = [line.removeprefix(_RESULT) for line in lines if line.startswith(_RESULT)]
    if status not in (CONVERGED, NOT_CONVERGED) or not written:
        raise AsperityError(end_of(status, lines))
    result = read(target / Path(written[-1]).name, keep=kept)
    if result.outcome != "converged":
        warnings.warn(result.reason, NotConvergedWarning, stacklevel=2)
    return result


def _listener(progress: Callable[[Progress], None] | bool | None) -> Callable[[str], None]:
    """What is done with each line."""
    if progress is None or progress is False:
        return lambda _: None
    show = progress if callable(progress) else _bar()

    def listen(line: str) -> None:
        text, count = printable(line), _COUNT.search(line)
        show(Progress(text, *map(int, count.groups())) if count else Progress(text))

    return listen


def _bar() -> Callable[[Progress], None]:
    """A bar of tqdm."""
    from tqdm import tqdm  # noqa: PLC0415 -- only for those who want a bar

    bar = tqdm(unit="step")

    def show(state: Progress) -> None:
        if state.total:
            bar.total = state.total
            bar.update(state.done - bar.n)
        if state.done and state.done == state.total:
            bar.close()

    return show

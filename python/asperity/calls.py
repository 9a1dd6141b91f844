"""Calls of the program: check a case, run a case."""

from __future__ import annotations

import contextlib
import csv
import re
import tempfile
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from .case_file import Case, namelist_of, read_namelist
from .errors import AsperityError, Finding, InputError, findings_in
from .program import call, end_of, printable
from .result import Result, read

if TYPE_CHECKING:
    import pandas as pd

CONVERGED, BAD_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 1, 2, 4
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


def run_many(cases: Iterable[Case], progress: Callable[[Progress], None] | bool | None = None) -> pd.DataFrame:
    """Computes cases of one kind in one process, without result files: a row of numbers and words for each, in their order.

    `cases`: each as for `check`. Columns are those of `--summary` that any case has; `outcome` is 'failed' where the program gave
    up, and `reason` says why. `progress`: as for `run`. Raises InputError with all findings, before anything is computed, and
    AsperityError if the program ends early.
    """
    import pandas as pd  # noqa: PLC0415 -- only for those who want a table

    with contextlib.ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="asperity-")))
        paths = []
        for number, case in enumerate(cases):
            place = folder / str(number)
            place.mkdir()
            arguments = stack.enter_context(namelist_of(case, place))
            if len(arguments) > 1:  # paths of this case alone
                arguments = stack.enter_context(namelist_of(read_namelist(str(case)), place))
            paths.append(arguments[0])
        if not paths:
            return pd.DataFrame()
        table = folder / "table.csv"
        options = ["--summary", str(table), "--outcomes"]
        status, lines = call([*dict.fromkeys(paths), *options], _listener(progress))
        if not table.exists() or status < 0 or status >= INTERRUPTED:
            findings = [
                replace(finding, text=f"case {number}: {finding.text}")
                for number, path in enumerate(paths)
                for finding in findings_in([line for line in lines if line.startswith(f"{path}:")], path)
            ]
            raise InputError(findings) if status == BAD_INPUT and findings else AsperityError(end_of(status, lines[-LAST_LINES:]))
        with table.open(encoding="utf-8", newline="") as file:
            cells = [{name: _value(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
    rows = pd.DataFrame(cells).set_index("case").drop(columns=["input", "program"]).reindex(paths)
    reasons = {words[1]: words[2] for words in (line.split("\t") for line in lines) if len(words) == 3}
    has_failed = rows["outcome"].isna()
    rows.loc[has_failed, "outcome"] = "failed"
    rows.loc[has_failed, "reason"] = [reasons.get(path, "") for path in rows.index[has_failed]]
    return rows.dropna(axis="columns", how="all").reset_index(drop=True)


def _value(cell: str) -> float | str | None:
    """What a cell of a table holds: a number, a text, or nothing."""
    try:
        return float(cell)
    except ValueError:
        return cell or None


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

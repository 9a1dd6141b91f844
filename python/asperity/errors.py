"""What can go wrong, as exceptions."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

_FINDING = re.compile(r"(?:(?P<line>\d+):| --set:)? *(?:&(?P<group>\w+)(?: (?P<key>[^:]+))?: )?(?P<text>.*)")


@dataclass(frozen=True)
class Finding:
    """One thing that is wrong with a case: line (0: no line), group and key (empty: the case as a whole), and what was found."""

    line: int
    group: str
    key: str
    text: str

    def __str__(self) -> str:
        """The finding in one line."""
        place = " ".join(word for word in (f"line {self.line}" if self.line else "", f"&{self.group}", self.key) if word.strip("&"))
        return f"{place}: {self.text}" if place else self.text


class AsperityError(Exception):
    """The program ended without a result, or a file is none: the message says why."""


class InputError(AsperityError, ValueError):
    """A case that is refused: `findings` has all that is wrong with it."""

    def __init__(self, findings: Sequence[Finding]) -> None:
        """All findings of a case."""
        self.findings = list(findings)
        super().__init__("\n".join(map(str, findings)))

    def __reduce__(self) -> tuple[type[InputError], tuple[list[Finding]]]:
        """A copy, as one process gives it to another, has the findings too."""
        return InputError, (self.findings,)


def findings_in(lines: Sequence[str], path: str) -> list[Finding]:
    """The findings about the namelist `path` that the program has printed, one a line; empty: these are no findings."""
    own = [line.removeprefix(f"{path}:") for line in lines if line.startswith((f"{path}:", "asperity: "))]
    return [_finding(line) for line in own]


def _finding(line: str) -> Finding:
    match = _FINDING.fullmatch(line)
    assert match
    return Finding(int(match["line"] or 0), match["group"] or "", (match["key"] or "").strip(), match["text"])

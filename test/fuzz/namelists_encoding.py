"""One namelist with every mix of line ends and in every encoding: the same values and findings at the same lines, or a refusal."""

import random
from pathlib import Path

from namelist_syntax import effective, namelist
from run import Run, call

TITLE = "one namelist with line ends LF, CR LF, CR and mixes of them, in UTF-8 with and without mark, UTF-16, Latin-1"
CASES = 400
# Lines with a finding each, and comments that must end with their line.
FAULTS = ["viscosity = 1 2", "typo = 3", "intervals = 'x'", "speed_1 = 1.0.0", "&nobody /", "title = 'open", "text"]
COMMENTS = ["! intervals = 3", "!", "! Öl, µm, 油膜", "", "   ! it's / & not = an entry"]
UNICODE = ["utf-16", "utf-16-le", "utf-16-be"]


def with_ends(lines: list[str], ends: list[str], source: random.Random) -> str:
    """The lines with ends drawn from `ends`; a CR is never followed by an LF that would end the same line."""
    text = ""
    for line in lines:
        end = source.choice(ends)
        if text.endswith("\r") and not line and end == "\n":
            end = "\r\n"
        text += line + end
    return text


def plain_and_odd(source: random.Random) -> tuple[str, bytes, str]:
    """A case with LF in UTF-8, the same in another form, and its encoding."""
    lines = namelist(source).replace("\r\n", "\n").split("\n")
    for _ in range(source.randrange(6)):
        lines.insert(source.randrange(len(lines) + 1), source.choice(COMMENTS))
    if source.random() < 0.5:
        for _ in range(source.randrange(1, 4)):
            lines.insert(source.randrange(len(lines) + 1), source.choice(FAULTS))
    text = with_ends(lines, source.choice([["\r"], ["\r\n"], ["\n"], ["\r", "\n"], ["\r", "\r\n"], ["\r", "\r\n", "\n"]]), source)
    encoding = source.choice(["utf-8"] * 4 + ["utf-8-sig"] * 3 + ["latin-1", *UNICODE])
    return "\n".join(lines) + "\n", text.encode(encoding, "replace"), encoding


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    plain, odd, encoding = plain_and_odd(source)
    runs = []
    for name, content in (("plain", plain.encode()), ("other", odd)):
        (folder / name).mkdir()
        (folder / name / "case.nml").write_bytes(content)
        runs.append(call(program, folder / name, "case.nml", "--quiet"))
    trouble = [run.trouble() for run in runs if run.trouble()]
    if trouble:
        return trouble[0]
    if encoding in UNICODE and "case.nml:1: found UTF-16, expected" not in runs[1].err:
        return f"{encoding}: {runs[1].err[-200:]}"
    return compare(*runs, folder, None if odd_bytes(odd) else encoding)


def odd_bytes(odd: bytes) -> bool:
    """Whether it is no UTF-8 text without null bytes."""
    try:
        return "\0" in odd.decode("utf-8")
    except UnicodeDecodeError:
        return True


def compare(plain: Run, other: Run, folder: Path, encoding: str | None) -> str | None:
    """What the other form changed; without an `encoding` that can be read it is refused by name."""
    if encoding is None:
        refused = other.status == 1 and other.err.endswith(", expected a text file in UTF-8\n") and "found " in other.err
        return None if refused else f"status {other.status}: {other.err[-200:]}"
    if encoding == "latin-1":
        return None  # other characters, all of them ASCII
    if (plain.status, plain.err) != (other.status, other.err):
        return f"{encoding}: status {plain.status} {plain.err[-200:]}, in the other form {other.status} {other.err[-200:]}"
    if plain.status == 1:
        return None
    values = [effective(folder / name / "case.h5") for name in ("plain", "other")]
    return None if values[0] == values[1] else "other values"

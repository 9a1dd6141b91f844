"""Namelists with a few bytes changed, cut, doubled or swapped: an answer, or findings with file and line."""

import random
from pathlib import Path

from run import ROOT, call

TITLE = "namelists with changed, cut, doubled or swapped bytes, `--check`"
CASES = 1000
INPUTS = sorted((ROOT / "input").glob("*.nml"))
ODD = b"&/='\",!*()0123456789.eE+-\n\t \x00\xff"


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    text = bytearray(source.choice(INPUTS).read_bytes())
    for _ in range(source.randint(1, 4)):
        place = source.randrange(len(text))
        end = place + source.randint(1, 12)
        change = source.randrange(4)
        if change == 0:
            text[place] = source.choice(ODD)
        elif change == 1:
            del text[place:end]
        elif change == 2:
            text[place:place] = text[place:end]
        else:
            text[place:end] = bytes(reversed(text[place:end]))
    (folder / "case.nml").write_bytes(text)
    run = call(program, folder, "--check", "case.nml")
    if run.status == 1 and "case.nml" not in run.err:
        return f"no file in the message: {run.err.strip()[-200:]}"
    return run.trouble(0, 1)

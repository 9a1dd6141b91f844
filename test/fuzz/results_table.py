"""Damaged results in `asperity table`: a row with the reason and status 1, or the row of the whole result."""

import json
import random
from pathlib import Path

from damage import damaged
from results_resumed import complete
from run import call

TITLE = "damaged results (bytes flipped, zeroed, cut, swapped), `asperity table`"
CASES = 400


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    reference = complete(program) / f"{source.choice(['steady', 'transient'])}.h5"
    (folder / "whole.h5").write_bytes(reference.read_bytes())
    (folder / "damaged.h5").write_bytes(damaged(reference.read_bytes(), source))
    run = call(program, folder, "table", "whole.h5", "damaged.h5", "--format", "json")
    if run.trouble():
        return run.trouble()
    whole, other = (json.loads(line) for line in run.out.splitlines())
    if other["converged"] is None:
        return None if run.status == 1 and other["reason"] else f"status {run.status} without a reason"
    return None if other | {"file": "whole.h5"} == whole else "other numbers"

"""Long runs of all kinds of work, to their end or to a limit of processor time: a line at least every 5 s of it."""

import random
import resource
from pathlib import Path

from cases import STEADY, TRANSIENT
from silence import listen, longest_silence
from test_silence import AREA, HEIGHTS, write_heights

TITLE = "silence of long runs: dense systems, areas, targets, reading, writing, coarse runs"
CASES = 30
# The quick form is test_silence.py.
QUICK = 0
# Longest silence and longest run [s of processor time].
SILENCE, LIMIT = 5.0, 40


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice(list(KINDS))
    (folder / "case.nml").write_text(KINDS[kind](source, folder), encoding="utf-8")
    threads = source.choice(["1", "2"])
    resource_limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (LIMIT, LIMIT + 2))  # noqa: E731
    status, heard = listen([program, "case.nml", "--threads", threads], folder, resource_limit)
    silence, line = longest_silence(heard)
    if silence >= SILENCE:
        return f"{kind}: {silence:.1f} s of silence before {line!r}"
    return None if status in {0, 2, 4} else f"{kind}: status {status}: {heard[0][0]}"


def dense(source: random.Random, _: Path) -> str:
    """Newton's method with matrices."""
    return STEADY.replace("256", str(source.choice([2048, 4096, 8192]))) + "&solver method = 'newton_dense' /\n"


def area(source: random.Random, _: Path) -> str:
    """A sweep, or one load."""
    loads = ", ".join(f"{10 ** source.uniform(7, 10):.3g}" for _ in range(source.choice([1, 4])))
    return AREA.replace("1e7, 1e8, 3e8, 1e9, 3e9", loads).replace("2048", str(source.choice([1000, 2048, 2187])))


def heights(source: random.Random, folder: Path) -> str:
    """A table of any length, read and solved."""
    write_heights(folder, source.choice([300_000, 3_000_000, 8_000_000]))
    return HEIGHTS


def fields(source: random.Random, _: Path) -> str:
    """A passage with its fields; coarse runs and packing take as long as the steps."""
    steps, intervals = source.choice([(2000, 4096), (500, 16384), (250, 65536)])
    return TRANSIENT.replace("256", str(intervals)).replace("time_step = 0.05", f"time_step = {1 / steps}")


def target(source: random.Random, _: Path) -> str:
    """Grid and step by accuracy."""
    wanted = 10 ** source.uniform(-6, -2.5)
    case = source.choice([STEADY, TRANSIENT]).replace(", intervals = 256", "").replace(", time_step = 0.05", "")
    return case + f"&accuracy target = {wanted:.2g} /\n"


def fine(source: random.Random, _: Path) -> str:
    """A fine steady grid by any way, on a domain that may cut the film off."""
    way = source.choice(["method = 'fas_block_jacobi'", "smoother = 'gauss_seidel'", "method = 'newton_krylov'", "start = 'hertz'"])
    outlet = source.choice(["1.05", "1.5", "4.0"])
    return STEADY.replace("1.5, intervals = 256", f"{outlet}, intervals = {source.choice([32768, 131072])}") + f"&solver {way} /\n"


KINDS = {"dense": dense, "area": area, "heights": heights, "fields": fields, "target": target, "fine": fine}

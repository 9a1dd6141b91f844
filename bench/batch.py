#!/usr/bin/env python3
"""Measures the cost of a sweep: solution, error bars, adequacy, everything else; memory, gathering.

Prints a table; on a busy machine compare processor times (CPU) only.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import h5py
import pandas as pd
from bench_program import ASPERITY, ROOT, Run, measured, new_parser

HEAD = 'base = "{base}"\n[set]\ndomain.intervals = 256\n{extra}'
STEADY = HEAD + "[vary]\nload.hertz_pressure = {{ from = 0.3e9, to = 0.9e9, count = {count} }}\n"
STEPS = "time.time_step = 0.0215\noutput.profile_stride = 103\n"
PASSAGE = HEAD + STEPS + "[vary]\nbodies.speed_2 = {{ from = 1.0, to = 1.3, count = {count} }}\n"
SWEEPS = {"steady contacts": ("minimal", STEADY), "passages, 103 steps": ("case3_demo", PASSAGE)}
# What is left out one after the other; the cost of each is the difference.
NO_ADEQUACY = "output.adequacy = false\n"
EXTRAS = ("", NO_ADEQUACY, NO_ADEQUACY + "output.si_copies = false\naccuracy.error_bars = false\n")


def run(script: str, *arguments: object) -> Run:
    """What a script of batch/ takes with all that it starts; memory is that of the largest process."""
    used = measured([sys.executable, ROOT / "batch" / script, *arguments])
    if used.status != 0:
        sys.exit(f"batch.py: {script}: {used.words}")
    return used


def solution_seconds(path: Path) -> float:
    """Wall time of a solution without error bars and adequacy."""
    with h5py.File(path) as file:
        return float(file["report/phase_seconds"][:3].sum())


def sweep_costs(folder: Path, base: str, text: str, count: int, jobs: int) -> dict[str, object]:
    """Processor time of a case [ms], of run.py and all that it starts, and its parts."""
    seconds = []
    for number, extra in enumerate(EXTRAS):
        name = folder / f"{base}_{number}"
        content = text.format(base=ROOT / "input" / f"{base}.nml", count=count, extra=extra)
        name.with_suffix(".toml").write_text(content, encoding="utf-8")
        run("sweep.py", name.with_suffix(".toml"), "--output", name)
        used = run("run.py", name, "--jobs", jobs)
        seconds.append(1e3 * used.processor / count)
    every, lean, bare = seconds
    # on a busy machine the shortest one is nearest to its processor time
    solution = 1e3 * min(map(solution_seconds, (name / "cases").glob("*.h5")))
    parts = {
        "all": every,
        "adequacy": every - lean,
        "error bars": lean - bare,
        "solution": solution,
        "not solving": bare - solution,
    }
    return parts | {"share [%]": 100 * (bare - solution) / every, "memory [MB]": used.memory}


def gathered(source: Path, folder: Path, count: int) -> str:
    """The cost of `count` results (hard links to few) gathered."""
    cases = sorted((source / "cases").glob("*.h5"))[:100]
    (folder / "cases").mkdir(parents=True)
    names = [f"case_{i:06d}" for i in range(1, count + 1)]
    for i, name in enumerate(names):
        for kind in (".h5", ".nml"):
            (folder / "cases" / f"{name}{kind}").hardlink_to(cases[i % len(cases)].with_suffix(kind))
    pd.DataFrame({"case": names, "x": range(count)}).to_csv(folder / "index.csv", index=False)
    used = run("gather.py", folder)
    sizes = " and ".join(f"{(folder / f'gathered.{kind}').stat().st_size / 1e6:.1f} MB {kind}" for kind in ("h5", "csv"))
    return f"gather {count} results: {used.wall:.1f} s, CPU {used.processor:.1f} s, {used.memory:.0f} MB; {sizes}"


def main() -> None:
    """Command line."""
    parser = new_parser(__doc__, "few cases", "results/bench")
    parser.add_argument("--cases", type=int, default=1000, metavar="N", help="short cases of each kind (1000)")
    parser.add_argument("--jobs", type=int, default=2, metavar="K", help="processes side by side (2)")
    parser.add_argument("--results", type=int, default=10_000, metavar="N", help="results to gather (10000)")
    options = parser.parse_args()
    count = 10 if options.quick else options.cases
    with tempfile.TemporaryDirectory(prefix="asperity_batch_") as name:
        folder = Path(name)
        print(f"{count} cases each on 256 intervals, {options.jobs} processes ({os.cpu_count()} cores); of a case [ms]")
        rows = {words: sweep_costs(folder, *sweep, count, options.jobs) for words, sweep in SWEEPS.items()}
        print(pd.DataFrame(rows).T.to_string(float_format="{:.2f}".format))
        cases = sorted((folder / "minimal_0" / "cases").glob("*.nml"))
        used = {n: measured([ASPERITY, *cases[:n], "--quiet", "--output", folder]).memory for n in (5, 50, 200)}
        print("memory of one process: " + ", ".join(f"{n} cases {memory:.1f} MB" for n, memory in used.items()))
        print(gathered(folder / "minimal_0", folder / "many", 20 if options.quick else options.results))


if __name__ == "__main__":
    main()

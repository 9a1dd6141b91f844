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
from bench_program import ASPERITY, ROOT, Usage, measured, new_parser

HEAD = 'base = "{base}"\n[set]\ndomain.intervals = 256\n{extra}'
STEADY = HEAD + "[vary]\nload.hertz_pressure = {{ from = 0.3e9, to = 0.9e9, count = {count} }}\n"
STEPS = "time.time_step = 0.0215\noutput.profile_stride = 103\n"
PASSAGE = HEAD + STEPS + "[vary]\nbodies.speed_2 = {{ from = 1.0, to = 1.3, count = {count} }}\n"
SWEEPS = {"steady contacts": ("minimal", STEADY), "passages, 103 steps": ("case3_demo", PASSAGE)}
# What is left out one after the other; the cost of each is the difference.
NO_ADEQUACY = "output.adequacy = false\n"
EXTRAS = ("", NO_ADEQUACY, NO_ADEQUACY + "output.si_copies = false\naccuracy.error_bars = false\n")


def run(script: str, *arguments: object) -> Usage:
    """What a script of batch/ takes with all that it starts; memory is that of the largest process."""
    used = measured([sys.executable, ROOT / "batch" / script, *arguments])
    if used.status != 0:
        sys.exit(f"batch.py: {script}: exit status {used.status}")
    return used


def solution_seconds(folder: Path) -> float:
    """Shortest wall time of a solution without error bars and adequacy: on a busy machine nearest to its processor time."""
    found = []
    for path in (folder / "cases").glob("*.h5"):
        with h5py.File(path) as file:
            item = file["report/phase_seconds"]
            seconds = dict(zip(item.attrs["phases"].decode().split(", "), item[()], strict=True))
            found.append(seconds["setup"] + seconds["steady"] + seconds["transient"])
    return min(found)


def bench_runs(folder: Path, count: int, jobs: int) -> None:
    """Rows of the two kinds of short cases."""
    print(f"{count} cases each on 256 intervals, {jobs} processes ({os.cpu_count()} cores, load {os.getloadavg()[0]:.1f})")
    print("processor time of a case [ms], of run.py and all that it starts")
    print(f"{'':22}{'all':>8}{'adequacy':>10}{'error bars':>12}{'solution':>10}{'not solving':>13}{'share':>9}{'memory':>9}")
    for words, (base, text) in SWEEPS.items():
        seconds = []
        for number, extra in enumerate(EXTRAS):
            name = folder / f"{base}_{number}"
            content = text.format(base=ROOT / "input" / f"{base}.nml", count=count, extra=extra)
            name.with_suffix(".toml").write_text(content, encoding="utf-8")
            run("sweep.py", name.with_suffix(".toml"), "--output", name)
            used = run("run.py", name, "--jobs", jobs)
            seconds.append(1e3 * used.processor / count)
        solution = 1e3 * solution_seconds(name)
        rest = seconds[2] - solution
        print(
            f"{words:22}{seconds[0]:8.2f}{seconds[0] - seconds[1]:10.2f}{seconds[1] - seconds[2]:12.2f}"
            f"{solution:10.2f}{rest:13.2f}{100 * rest / seconds[0]:7.1f} %{used.memory:6.0f} MB"
        )


def bench_gather(source: Path, folder: Path, count: int) -> None:
    """One row: `count` results (hard links to few) gathered."""
    cases = sorted((source / "cases").glob("*.h5"))[:100]
    (folder / "cases").mkdir(parents=True)
    names = [f"case_{i:06d}" for i in range(1, count + 1)]
    for i, name in enumerate(names):
        for kind in (".h5", ".nml"):
            (folder / "cases" / f"{name}{kind}").hardlink_to(cases[i % len(cases)].with_suffix(kind))
    (folder / "index.csv").write_text("case,x\n" + "".join(f"{n},{i}\n" for i, n in enumerate(names)), encoding="utf-8")
    used = run("gather.py", folder)
    sizes = [(folder / f"gathered.{ending}").stat().st_size / 1e6 for ending in ("h5", "csv")]
    print(f"gather {count} results: {used.wall:.1f} s, CPU {used.processor:.1f} s, {used.memory:.0f} MB; ", end="")
    print(f"{sizes[0]:.1f} MB HDF5, {sizes[1]:.1f} MB CSV")


def main() -> None:
    """Command line."""
    parser = new_parser(__doc__, "few cases", "results/bench")
    parser.add_argument("--cases", type=int, default=1000, metavar="N", help="short cases of each kind (1000)")
    parser.add_argument("--jobs", type=int, default=2, metavar="K", help="processes side by side (2)")
    parser.add_argument("--results", type=int, default=10_000, metavar="N", help="results to gather (10000)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="asperity_batch_") as name:
        folder = Path(name)
        bench_runs(folder, 10 if options.quick else options.cases, options.jobs)
        steady = folder / "minimal_0"
        cases = sorted((steady / "cases").glob("*.nml"))
        used = {n: measured([ASPERITY, *cases[:n], "--quiet", "--output", folder]).memory for n in (5, 50, 200)}
        print("memory of one process: " + ", ".join(f"{n} cases {memory:.1f} MB" for n, memory in used.items()))
        bench_gather(steady, folder / "many", 20 if options.quick else options.results)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""What a sweep costs: solution, error bars, adequacy, and what is not solving; memory, gathering, files.

Prints a table; on a machine with other work compare processor times (CPU) only.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = Path(os.environ.get("ASPERITY", ROOT / "build" / "bin" / "asperity"))
HEAD = 'base = "{base}"\n[set]\ndomain.intervals = 256\n'
STEADY = HEAD + "[vary]\nload.hertz_pressure = {{ from = 0.3e9, to = 0.9e9, count = {count} }}\n"
PASSAGE = (
    HEAD
    + "time.time_step = 0.0215\noutput.profile_stride = 103\n[vary]\nbodies.speed_2 = {{ from = 1.0, to = 1.3, count = {count} }}\n"
)
SWEEPS = {"steady contacts": ("minimal", STEADY), "passages, 103 steps": ("case3_demo", PASSAGE)}
# What is left out one after the other; the cost of each is the difference.
NO_ADEQUACY = "output.adequacy = false\n"
NUMBERS_ONLY = NO_ADEQUACY + "output.si_copies = false\naccuracy.error_bars = false\n"


def run(script: str, *arguments: object) -> tuple[float, float, float]:
    """Runs a script of batch/: wall and processor seconds of it and what it starts, peak memory [MB] of the largest process."""
    code = (
        "import resource, runpy, sys; sys.argv = sys.argv[1:]; sys.path.insert(0, sys.argv[0].rpartition('/')[0])\n"
        "try: runpy.run_path(sys.argv[0], run_name='__main__')\n"
        "except SystemExit: pass\n"
        "both = [resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]\n"
        "print(sum(r.ru_utime + r.ru_stime for r in both), both[0].ru_maxrss, both[1].ru_maxrss)"
    )
    command = [sys.executable, "-c", code, str(ROOT / "batch" / script), *map(str, arguments)]
    start = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    wall = time.monotonic() - start
    seconds, own, children = map(float, done.stdout.splitlines()[-1].split())
    return wall, seconds, (children or own) / 1024


def solution_seconds(folder: Path) -> float:
    """Shortest wall time of a solution without error bars and adequacy: on a busy machine nearest to its processor time."""
    found = []
    for path in (folder / "cases").glob("*.h5"):
        with h5py.File(path) as file:
            item = file["report/phase_seconds"]
            seconds = dict(zip(item.attrs["phases"].decode().split(", "), item[()], strict=True))
            found.append(seconds["setup"] + seconds["steady"] + seconds["transient"])
    return min(found)


def bench_runs(folder: Path, count: int, jobs: int) -> Path:
    """Rows of the two kinds of short cases; returns the folder of the last sweep."""
    print(f"{count} cases each on 256 intervals, {jobs} processes ({os.cpu_count()} cores, load {os.getloadavg()[0]:.1f})")
    print("processor time of a case [ms], of run.py and all that it starts")
    print(f"{'':22}{'all':>8}{'adequacy':>10}{'error bars':>12}{'solution':>10}{'not solving':>13}{'share':>9}{'memory':>9}")
    for words, (base, text) in SWEEPS.items():
        seconds = []
        for number, extra in enumerate(("", NO_ADEQUACY, NUMBERS_ONLY)):
            name = f"{base}_{number}"
            content = text.format(base=ROOT / "input" / f"{base}.nml", count=count).replace("[vary]", extra + "[vary]")
            (folder / f"{name}.toml").write_text(content, encoding="utf-8")
            run("sweep.py", folder / f"{name}.toml", "--output", folder / name)
            _, cpu, memory = run("run.py", folder / name, "--jobs", jobs)
            seconds.append(1e3 * cpu / count)
        solution = 1e3 * solution_seconds(folder / name)
        beside = seconds[2] - solution
        print(
            f"{words:22}{seconds[0]:8.2f}{seconds[0] - seconds[1]:10.2f}{seconds[1] - seconds[2]:12.2f}"
            f"{solution:10.2f}{beside:13.2f}{100 * beside / seconds[0]:7.1f} %{memory:6.0f} MB"
        )
    return folder / name


def bench_memory(folder: Path) -> None:
    """Peak memory of one process with few and with many cases."""
    cases = sorted((folder / "cases").glob("*.nml"))
    words = []
    for count in (5, 50, 200):
        script = "import resource, subprocess, sys; subprocess.run(sys.argv[1:]); " + (
            "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)"
        )
        command = [sys.executable, "-c", script, PROGRAM, *cases[:count], "--quiet", "--output", folder]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        words.append(f"{count} cases {float(done.stdout.splitlines()[-1]) / 1024:.1f} MB")
    print("memory of one process: " + ", ".join(words))


def bench_gather(source: Path, folder: Path, count: int) -> None:
    """One row: `count` results (hard links to few) gathered."""
    cases = sorted((source / "cases").glob("*.h5"))[:100]
    (folder / "cases").mkdir(parents=True)
    names = [f"case_{i:06d}" for i in range(1, count + 1)]
    for i, name in enumerate(names):
        result = cases[i % len(cases)]
        (folder / "cases" / f"{name}.h5").hardlink_to(result)
        (folder / "cases" / f"{name}.nml").hardlink_to(result.with_suffix(".nml"))
    (folder / "index.csv").write_text("case,x\n" + "".join(f"{n},{i}\n" for i, n in enumerate(names)), encoding="utf-8")
    wall, cpu, memory = run("gather.py", folder)
    sizes = [(folder / f"gathered.{ending}").stat().st_size / 1e6 for ending in ("h5", "csv")]
    print(f"gather {count} results: {wall:.1f} s, CPU {cpu:.1f} s, {memory:.0f} MB; {sizes[0]:.1f} MB HDF5, {sizes[1]:.1f} MB CSV")


def bench_files(folder: Path, count: int, size: int) -> None:
    """What `count` results cost as files, and as rows of one file."""
    folder.mkdir()
    content = os.urandom(size)
    times = {}

    def timed(words: str, work: object) -> None:
        start, used = time.monotonic(), time.process_time()
        for i in range(count):
            work(folder / f"{i:06d}.h5")
        times[words] = (time.monotonic() - start) / count, (time.process_time() - used) / count

    def write(path: Path) -> None:
        part = path.with_suffix(".part")
        part.write_bytes(content)
        part.rename(path)

    timed("write and rename", write)
    timed("look", Path.exists)
    timed("read", Path.read_bytes)
    timed("remove", Path.unlink)
    start, used = time.monotonic(), time.process_time()
    with (folder / "packed").open("wb") as file:
        for _ in range(count):
            file.write(content)
    packed = (time.monotonic() - start) / count, (time.process_time() - used) / count
    words = ", ".join(f"{name} {1e6 * wall:.0f} us (CPU {1e6 * cpu:.0f})" for name, (wall, cpu) in times.items())
    print(f"{count} files of {size} bytes, each: {words}")
    print(f"the same behind each other in one file: {1e6 * packed[0]:.0f} us (CPU {1e6 * packed[1]:.0f})")


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000, metavar="N", help="short cases of each kind (1000)")
    parser.add_argument("--jobs", type=int, default=2, metavar="K", help="processes side by side (2)")
    parser.add_argument("--results", type=int, default=10_000, metavar="N", help="results to gather (10000)")
    parser.add_argument("--files", type=int, default=100_000, metavar="N", help="files of the load on the file system (100000)")
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="asperity_batch_"))
    try:
        passages = bench_runs(folder, options.cases, options.jobs)
        steady = folder / "minimal_0"
        bench_memory(steady)
        bench_gather(steady, folder / "many", options.results)
        shutil.rmtree(passages)
        bench_files(folder / "files", options.files, 4096)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"(memory of this script: {peak:.0f} MB)", file=sys.stderr)


if __name__ == "__main__":
    main()

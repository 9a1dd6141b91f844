#!/usr/bin/env python3
"""Measures speed and memory: what was asked for, what was reached, with the residual reached and a verdict.

Every time is of one core and of many runs in one process (minimum and median); start-up, input and output are a row of
their own. The verdict is that of the median; `met (min.)` and `met (CPU)` are for a machine that others use too: by the minimum,
by the mean processor time of a run (planning included). Results: a table on standard output, results/bench/bench.csv.
"""

from __future__ import annotations

import csv
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import bench_program
import h5py
import namelists
from bench_program import ROOT, Answer, Job, job, new_parser, output_folder

ASPERITY = ROOT / "build" / "bin" / "asperity"
BLOCK_JACOBI = {"method": "fas_block_jacobi", "smoother": "block_jacobi"}
THESIS_SWEEPS = BLOCK_JACOBI | {"pre_sweeps": 10, "post_sweeps": 10, "relaxation": 0.7, "start": "hertz"}
LINE = {"method": "fas_block_jacobi", "smoother": "line"}
GAUSS_SEIDEL = {"method": "fas_block_jacobi", "smoother": "gauss_seidel"}
KRYLOV = {"method": "newton_krylov"}
DENSE = {"method": "newton_dense"}
# Far below every tolerance: cycles go on to the limit given by max_cycles.
NEVER = 1e-15

# Routines of FFTW where it is linked into the program: codelets have a size at their end.
FFTW = re.compile(r"[a-z][a-z0-9]*_\d+|apply\w*|dobatch|bytwiddle\w*|fftwf?_\w+")
# Other procedures and libraries by what they do, for the shares; the first match counts.
SHARES = (
    ("factor and solve", ("__semiseparable_MOD", "fill_factors", "solve_semiseparable_system", "precondition_bordered")),
    (
        "laws",
        (
            "__eyring_MOD",
            "__viscosity_MOD",
            "__density_MOD",
            "__mobility_MOD",
            "__lubricant_MOD",
            "libmvec",
            "_exp",
            "_log",
            "_pow",
        ),
    ),
)


@dataclass
class Row:
    """One line of the table; values in seconds unless `unit` says otherwise."""

    work: str
    asked: float | None
    least: float
    median: float
    unit: str = "s"
    residual: float = math.nan
    aim: float | None = None
    note: str = ""
    processor: float = math.nan

    @property
    def verdict(self) -> str:
        """Whether the median is within what was asked."""
        if self.asked is None:
            return ""
        if not self.median <= self.asked:
            return "met (min.)" if self.least <= self.asked else "met (CPU)" if self.processor <= self.asked else "MISSED"
        return "met, aim too" if self.aim is not None and self.median <= self.aim else "met"

    def cells(self) -> tuple[str, ...]:
        """Text of the columns."""
        asked = "-" if self.asked is None else f"<= {show(self.asked, self.unit)}"
        residual = "" if math.isnan(self.residual) else f"{self.residual:.0e}"
        times = [show(value, self.unit) for value in (self.least, self.median)]
        processor = "" if math.isnan(self.processor) else show(self.processor, self.unit)
        return self.work, asked, *times, processor, residual, self.verdict


def show(value: float, unit: str) -> str:
    """A value with three digits and its unit."""
    if math.isnan(value):
        return "-"
    if unit == "s":
        scale, name = (1e3, "ms") if value < 1 else (1, "s")
        return f"{value * scale:.3g} {name}"
    return f"{value:.3g} {unit}".strip()


class Table:
    """Rows, printed as they come: 100 columns."""

    WIDTHS = (43, 10, 8, 8, 8, 5, 12)
    HEAD = ("work", "asked", "min.", "median", "CPU", "resid", "")

    def __init__(self) -> None:
        """An empty table."""
        self.rows: list[Row] = []
        self.lines: list[str] = []

    def title(self, text: str) -> None:
        """Starts a part of the table."""
        self.say(f"\n{text}\n{self._line(self.HEAD)}\n{'-' * (sum(self.WIDTHS) + 6)}")

    def add(self, row: Row) -> None:
        """Adds and prints a row; its note in a line of its own."""
        self.rows.append(row)
        self.say(self._line(row.cells()))
        if row.note:
            self.say(f"    {row.note}")

    def say(self, line: str) -> None:
        """Prints and keeps a line."""
        self.lines.append(line)
        print(line, flush=True)

    def _line(self, cells: tuple[str, ...]) -> str:
        parts = [
            cell.ljust(w) if i in {0, 6} else cell.rjust(w) for i, (cell, w) in enumerate(zip(cells, self.WIDTHS, strict=True))
        ]
        return " ".join(parts).rstrip()

    def save(self, path: Path) -> None:
        """The rows as CSV, and the lines as they were printed beside it."""
        path.parent.mkdir(parents=True, exist_ok=True)
        path.with_suffix(".txt").write_text("\n".join(self.lines).strip() + "\n", encoding="utf-8")
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(("work", "asked", "aim", "minimum", "median", "processor", "unit", "residual", "verdict", "note"))
            for row in self.rows:
                writer.writerow(
                    (
                        row.work,
                        row.asked,
                        row.aim,
                        row.least,
                        row.median,
                        row.processor,
                        row.unit,
                        row.residual,
                        row.verdict,
                        row.note,
                    )
                )


def timed(answer: Answer, work: str, asked: float | None, phase: str = "steady", **more: object) -> Row:
    """A row of one phase of an answer."""
    if not answer.converged:
        return Row(work, asked, math.nan, math.nan, note=f"not converged: {answer['reason']}")
    residual = answer["step_residual" if phase == "transient" else "residual"]
    processor = answer["processor"] if phase != "setup" else math.nan
    return Row(work, asked, answer[f"{phase}_least"], answer[f"{phase}_median"], residual=residual, processor=processor, **more)


def solve(*jobs: Job) -> dict[str, Answer]:
    """Answers to jobs; the first one of the process warms up."""
    warm = job("warm", namelists.case_1(256), runs=5)
    return bench_program.run([warm, *jobs])


def case_1_rows(table: Table, runs: int) -> None:
    """Case 1, 1024 intervals, by the methods that have a limit."""
    words = {"runs": runs, "seconds": 5}
    answers = solve(
        job("hertz", namelists.case_1(1024, BLOCK_JACOBI | {"start": "hertz"}), **words),
        job("fmg", namelists.case_1(1024, BLOCK_JACOBI), **words),
        job("line", namelists.case_1(1024, LINE), **words),
        job("krylov", namelists.case_1(1024, KRYLOV), **words),
        job("auto", namelists.case_1(1024), **words),
        job("dense", namelists.case_1(1024, DENSE), runs=max(3, runs // 20), seconds=5),
    )
    cycles = {name: f"{answer['cycles']:.0f} cycles, {answer['fft_pairs']:.0f} FFT pairs" for name, answer in answers.items()}
    table.add(timed(answers["hertz"], "Case 1, 1024: Block-Jacobi FAS, hertz", 0.030, note=cycles["hertz"]))
    table.add(timed(answers["fmg"], "Case 1, 1024: Block-Jacobi FAS, fmg", 0.015, note=cycles["fmg"]))
    table.add(timed(answers["line"], "Case 1, 1024: FAS, line smoother", 0.005, note=cycles["line"]))
    table.add(timed(answers["krylov"], "Case 1, 1024: newton_krylov", 0.005, aim=0.002, note=cycles["krylov"]))
    table.add(timed(answers["auto"], "Case 1, 1024: auto", None))
    table.add(timed(answers["krylov"], "  planning, kernels, storage for it", None, "setup"))
    table.add(timed(answers["dense"], "Case 1, 1025 nodes: newton_dense", 0.5))


def reduction_rows(table: Table, sizes: tuple[int, ...]) -> None:
    """Error of P after each V-cycle of Block-Jacobi, 10 + 10 sweeps, relaxation 0.7, from Hertz."""
    most = 14
    jobs = []
    for n in sizes:
        jobs.append(job(f"{n}", namelists.case_1(n, KRYLOV | {"tolerance": NEVER, "max_cycles": 30}), reference=1))
        for cycles in range(1, most + 1):
            text = namelists.case_1(n, THESIS_SWEEPS | {"tolerance": NEVER, "max_cycles": cycles})
            jobs.append(job(f"{n}:{cycles}", text, compare=1))
    answers = solve(*jobs)
    for n in sizes:
        errors = [answers[f"{n}:{cycles}"]["difference"] for cycles in range(1, most + 1)]
        last = next((i for i, error in enumerate(errors) if error < 1e-8), len(errors) - 1)
        rate = (errors[last] / errors[1]) ** (1 / (last - 1)) if last > 1 else math.nan
        work = answers[f"{n}:{last + 1}"]["work_units"]
        shown = " ".join(f"{error:.0e}" for error in errors[: last + 1])
        note = f"{work:.0f} work units to 1e-8; error after each cycle: {shown}"
        table.add(Row(f"error per V(10,10), Block-Jacobi, {n}", 0.15, rate, rate, "", note=note))


def transient_rows(table: Table, runs: int) -> None:
    """Case 3 in 812 steps; the error in P against a run with a tight tolerance."""
    answers = solve(
        job("tight", namelists.case_3(1024, KRYLOV | {"tolerance": 1e-10}), reference=1),
        job("auto", namelists.case_3(1024), compare=1, runs=runs, seconds=15),
        job("krylov", namelists.case_3(1024, KRYLOV | {"tolerance": 1e-4}), compare=1, runs=runs, seconds=15),
        job("gauss_seidel", namelists.case_3(1024, GAUSS_SEIDEL), compare=1, seconds=10),
    )
    for name, asked, aim in (("auto", 1.0, 0.4), ("krylov", 1.0, 0.4), ("gauss_seidel", 3.0, None)):
        answer = answers[name]
        words = {"auto": "auto", "krylov": "tolerance 1e-4", "gauss_seidel": "FAS, Gauss-Seidel"}[name]
        row = timed(answer, f"Case 3, 1024, 812 steps: {words}", asked, "transient", aim=aim)
        if answer.converged:
            per_step = answer["cycles"] / answer["steps"]
            row.note = f"largest error in P {answer['difference']:.1e} (asked 1e-4), {per_step:.2f} cycles a step"
            if answer["difference"] > 1e-4:
                row.asked, row.note = math.nan, row.note + ": TOO LARGE"
        table.add(row)


def process(arguments: list[str]) -> tuple[float, float, float]:
    """Wall time [s], peak memory [MB] and processor time [s] of a whole run of asperity."""
    start = time.perf_counter()
    child = subprocess.Popen([ASPERITY, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    seconds = time.perf_counter() - start
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in {0, 2}:
        sys.exit(f"asperity {' '.join(arguments)}: exit status {child.returncode}")
    return seconds, usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


def size_rows(table: Table, runs: int, largest: int) -> None:
    """Memory and cost of large grids."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "large.nml"
        for words, solver in (("auto", {}), ("Block-Jacobi FAS", BLOCK_JACOBI)):
            path.write_text(namelists.case_1(2**16, solver), encoding="utf-8")
            _, memory, _ = process([str(path), "--output", folder, "--quiet"])
            answer = solve(job("large", path.read_text(), runs=3, seconds=10))["large"]
            table.add(Row(f"peak memory, Case 1, 2^16: {words}", 200, memory, memory, "MB"))
            table.add(timed(answer, f"  its time, {answer['cycles']:.0f} cycles", None))
    sizes = [2**k for k in range(10, 17, 2)]
    jobs = []
    for n in sizes:
        for cycles in (2, 6):
            solver = THESIS_SWEEPS | {"tolerance": NEVER, "max_cycles": cycles}
            jobs.append(job(f"{n}:{cycles}", namelists.case_1(n, solver), runs=max(3, runs * 1024 // n)))
    answers = solve(*jobs)
    cost = {n: (answers[f"{n}:6"]["processor"] - answers[f"{n}:2"]["processor"]) / 4 / n for n in sizes}
    ratio = max(cost.values()) / min(cost.values())
    shown = ", ".join(f"2^{int(math.log2(n))} {value * 1e6:.2f} us" for n, value in cost.items())
    table.add(Row("per node and cycle, 2^10...2^16: ratio", 2, ratio, ratio, "", note=shown))
    per_node(table, runs, largest)


def per_node(table: Table, runs: int, largest: int) -> None:
    """Newton-Krylov: time per node of the largest grid over that of 2^12."""
    small = 2**12
    words = {"runs": runs, "seconds": 5}
    answers = solve(
        job("small", namelists.case_1(small, KRYLOV), **words), job("large", namelists.case_1(largest, KRYLOV), runs=3, seconds=10)
    )
    small_answer, large_answer = answers["small"], answers["large"]
    least, median = (
        (large_answer[f"steady_{which}"] / largest) / (small_answer[f"steady_{which}"] / small) for which in ("least", "median")
    )
    processor = (large_answer["processor"] / largest) / (small_answer["processor"] / small)
    times = [show(each["steady_least"], "s") for each in (small_answer, large_answer)]
    steps = [f"{each['cycles']:.0f}" for each in (small_answer, large_answer)]
    note = f"{' and '.join(times)}, {' and '.join(steps)} steps on the finest grid; CPU with planning"
    work = f"newton_krylov: per node, 2^{int(math.log2(largest))} over 2^12"
    table.add(Row(work, 4, least, median, "", large_answer["residual"], aim=2, note=note, processor=processor))


def process_rows(table: Table, runs: int) -> None:
    """A whole process on a smooth case: what is not solving."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case1.nml"
        path.write_text(namelists.case_1(1024), encoding="utf-8")
        whole, around, processor = [], [], []
        for _ in range(runs):
            seconds, memory, used = process([str(path), "--output", folder, "--quiet"])
            with h5py.File(Path(folder) / "case1.h5") as file:
                phases = file["report/phase_seconds"][()]
                around.append(seconds - float(sum(phases)))
            whole.append(seconds)
            processor.append(used)
    times = f"minimum {show(min(whole), 's')}, median {show(statistics.median(whole), 's')}"
    note = f"whole process: {times}; peak memory {memory:.0f} MB; CPU: of the whole"
    table.add(
        Row(
            "start-up, input, output of a smooth case",
            0.050,
            min(around),
            statistics.median(around),
            note=note,
            processor=statistics.mean(processor),
        )
    )


def further_rows(table: Table, runs: int) -> None:
    """Whole processes that do nothing but solve, and two threads beside one."""
    bare = {"accuracy": {"error_bars": False}, "output": {"adequacy": False, "si_copies": False}}
    with tempfile.TemporaryDirectory() as folder:
        many = [Path(folder) / f"{i}.nml" for i in range(21)]
        for i, path in enumerate(many):
            path.write_text(namelists.case_1(256, load={"load_per_length": 5e4 + 2.5e3 * i}, **bare), encoding="utf-8")
        case = Path(folder) / "case.nml"
        case.write_text(namelists.case_1(1024, **bare), encoding="utf-8")
        passage = Path(folder) / "passage.nml"
        passage.write_text(namelists.case_3(1024), encoding="utf-8")
        end = ["--output", folder, "--quiet"]
        cold, further, walls = [], [], []
        for _ in range(runs):
            cold.append(process([str(case), *end])[2])
            first, all_of_them = (process([str(path) for path in paths] + end)[2] for paths in (many[:1], many))
            further.append((all_of_them - first) / (len(many) - 1))
            walls.append([process([str(passage), *end, "--threads", str(threads)])[0] for threads in (1, 2)])
    words = "processor time; no adequacy, error bars, SI copies"
    table.add(Row("whole process, Case 1, 1024", 0.010, min(cold), statistics.median(cold), aim=0.006, note=words))
    table.add(Row("a further case of 256 in it", 0.004, min(further), statistics.median(further), aim=0.002, note=words))
    ratios = [two / one for one, two in walls]
    note = f"wall, {show(min(one for one, _ in walls), 's')} and {show(min(two for _, two in walls), 's')}; with error bars"
    table.add(Row("Case 3, 812 steps: two threads over one", 0.55, min(ratios), statistics.median(ratios), "", aim=0.45, note=note))


def momentum_rows(table: Table, runs: int) -> None:
    """Case 1 by the full momentum equations: processor time of a whole process, Reynolds' equation included."""
    least = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "momentum.nml"
        for intervals, asked in ((448, 0.5), (1792, 2.5)):
            text = namelists.case_1(intervals).replace("problem = 'ehl_line'", "problem = 'ehl_line'\n   equations = 'stokes'")
            path.write_text(text + "&film layers = 20 /\n", encoding="utf-8")
            spent = [process([str(path), "--output", folder, "--quiet"]) for _ in range(runs)]
            seconds = [each[2] for each in spent]
            with h5py.File(path.with_suffix(".h5")) as file:
                steps, factors = (int(file["momentum"].attrs[name]) for name in ("newton_steps", "factorisations"))
            least[intervals] = min(seconds)
            note = f"processor time; {steps} Newton steps, {factors} factorisations, {max(each[1] for each in spent):.0f} MB"
            median = statistics.median(seconds)
            table.add(Row(f"Case 1, {intervals} x 20, full momentum", asked, min(seconds), median, note=note))
    ratio = (least[1792] / 1792) / (least[448] / 448)
    table.add(Row("full momentum: per interval, 1792 over 448", 1.3, ratio, ratio, ""))


def map_row(table: Table, cells: int) -> None:
    """`auto` over the M-L plane; intervals and domain chosen by the program."""
    side = round(math.sqrt(cells))
    ms = [0.01 * 2e5 ** (i / (side - 1)) for i in range(side)]
    ls = [40 * j / (side - 1) for j in range(side)]
    cells = [(f"{m:.4g},{oil:.4g}", namelists.moes(m, oil, None)) for m in ms for oil in ls]
    answers = solve(*(job(name, text, limit=60) for name, text in cells))
    del answers["warm"]
    total = sum(answer["all_least"] for answer in answers.values())
    processor = sum(answer["processor"] for answer in answers.values())
    bad = [name for name, answer in answers.items() if not answer.converged]
    worst = max(answers, key=lambda name: answers[name]["all_least"])
    residual = max(answer["residual"] for answer in answers.values() if answer.converged)
    scale = 400 / len(answers)
    note = f"{len(bad)} not converged, dearest M,L = {worst}: {show(answers[worst]['all_least'], 's')}"
    if bad:
        note += f"; not converged: M,L = {'; '.join(bad[:6])}"
    table.add(
        Row(
            f"auto, M-L map, {len(answers)} cells, as 400",
            20,
            total * scale,
            total * scale,
            aim=4,
            residual=residual,
            processor=processor * scale,
            note=note,
        )
    )


def share_rows(table: Table) -> None:
    """Where the time of newton_krylov goes: sampled by perf, and its FFT pairs times the time of one."""
    text = namelists.case_1(1024, KRYLOV)
    answer = solve(job("products", text, runs=200, products=1))["products"]
    ratio = answer["steady_least"] / answer["product_seconds"]
    taken = f"{show(answer['product_seconds'], 's')} of {show(answer['steady_least'], 's')}"
    note = f"{answer['fft_pairs']:.0f} FFT pairs on all levels take {taken}"
    table.add(Row("Case 1, 1024: time over that of FFT pairs", None, ratio, ratio, "", note=note))
    for name, jobs in (
        ("Case 1, 1024", [job("shares", text, runs=1500)]),
        ("Case 1, 2^16", [job("shares", namelists.case_1(2**16, KRYLOV), runs=6)]),
        ("Case 3, 1024", [job("shares", namelists.case_3(1024, KRYLOV), runs=2)]),
    ):
        shares = sampled_shares(jobs)
        if not shares:
            table.say("    shares of FFT, factor and solve, laws, rest: not measured, perf is not usable here")
            return
        listed = ", ".join(f"{words} {100 * share:.0f} %" for words, share in shares.items())
        table.say(f"    {name}, newton_krylov: {listed}")
        for words, share in shares.items():
            table.rows.append(Row(f"{name}: share of {words}", None, share, share, ""))


def sampled_shares(jobs: list[Job]) -> dict[str, float]:
    """Share of the user time by what it is spent on; empty where perf does not work."""
    if not shutil.which("perf"):
        return {}
    with tempfile.TemporaryDirectory() as folder:
        path, data = Path(folder) / "jobs", str(Path(folder) / "perf.data")
        path.write_text("".join(each.text() for each in jobs), encoding="utf-8")
        record = ["perf", "record", "-q", "-F", "2000", "-e", "cpu-clock:u", "-o", data, bench_program.PROGRAM, path]
        if subprocess.run(record, capture_output=True, env=bench_program.ENVIRONMENT, check=False).returncode != 0:
            return {}
        report = ["perf", "report", "-q", "-i", data, "--stdio", "--sort", "dso,symbol", "--percent-limit", "0"]
        lines = subprocess.run(report, capture_output=True, text=True, check=False).stdout.splitlines()
    shares = dict.fromkeys(["FFT", *(name for name, _ in SHARES), "rest"], 0.0)
    for line in lines:
        words = line.split()
        if not words or not words[0].endswith("%"):
            continue
        found = next((name for name, marks in SHARES if any(mark in line for mark in marks)), "rest")
        if "libfftw3" in line or FFTW.fullmatch(line.partition("[.]")[2].split()[0]):
            found = "FFT"
        shares[found] += float(words[0].rstrip("%"))
    total = sum(shares.values())
    return {name: share / total for name, share in shares.items()} if total > 0 else {}


def main() -> int:
    """Command line; status 1 if a row that has a limit is missed, unless --quick."""
    parser = new_parser(__doc__, "fewer runs and cells, under 30 s", "results/bench")
    options = parser.parse_args()
    runs = 20 if options.quick else 300
    table = Table()
    load = f"{os.cpu_count()} in the machine, load {os.getloadavg()[0]:.1f} at the start"
    table.say(f"asperity, one core ({load}); the verdict is that of the median")
    table.title("Steady, 5.5 half-widths, Reynolds-Eyring (chapter 5, Case 1), residual 1e-8")
    case_1_rows(table, runs)
    table.title("Error reduction per V-cycle, geometric mean from cycle 2 to 1e-8")
    reduction_rows(table, (256, 1024, 4096))
    table.title("In time (chapter 5, Case 3)")
    transient_rows(table, 1 if options.quick else 5)
    table.title("Large grids")
    size_rows(table, runs, 2**18 if options.quick else 2**20)
    table.title("Full momentum equations of the film, whole process (asked for 400 and 1600 intervals)")
    momentum_rows(table, 3 if options.quick else 7)
    table.title("Whole program, map")
    process_rows(table, max(runs // 10, 10))
    further_rows(table, 3 if runs < 100 else 9)
    map_row(table, 100 if options.quick else 400)
    table.title("Where the time goes")
    share_rows(table)
    path = output_folder(options) / "bench.csv"
    table.save(path)
    missed = [row.work for row in table.rows if row.verdict == "MISSED"]
    print(f"\n{path.relative_to(ROOT)}; missed: {', '.join(missed) or 'none'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Measures speed and memory against targets, with the residual reached.

Every time is of one core and of many runs in one process (minimum and median); start-up, input and output have their own row. The
verdict is that of the median; `met (min.)` and `met (CPU)` are for a busy machine: by the minimum, by the mean processor time of
a run (planning included). Results: a table on standard output, bench.txt and bench.csv.
"""

from __future__ import annotations

import math
import os
import statistics
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path

import bench_program
import f90nml
import h5py
from bench_program import ASPERITY, ROOT, Answer, Job, Usage, job, measured, new_parser, output_folder, write_csv
from chart import METHODS, THESIS_SOLVER
from namelists import BARE, case_1, case_3, moes, namelist

BLOCK_JACOBI, LINE, GAUSS_SEIDEL = (METHODS[f"FAS, {name}"] for name in ("Block-Jacobi", "line", "Gauss-Seidel"))
KRYLOV, DENSE = METHODS["newton_krylov"], METHODS["newton_dense"]
# Far below every tolerance: cycles go on to the limit given by max_cycles.
NEVER = 1e-15
LEAN = BARE | {"output": {"adequacy": False, "si_copies": False}}
COUNTS = ("newton_steps", "factorisations")
WIDTHS = (43, 10, 8, 8, 8, 5, 12)
HEAD = ("work", "asked", "min.", "median", "CPU", "resid", "")


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

    def line(self) -> str:
        """Its text, without the note."""
        asked = "-" if self.asked is None else f"<= {show(self.asked, self.unit)}"
        residual = "" if math.isnan(self.residual) else f"{self.residual:.0e}"
        processor = "" if math.isnan(self.processor) else show(self.processor, self.unit)
        times = [show(value, self.unit) for value in (self.least, self.median)]
        return in_columns((self.work, asked, *times, processor, residual, self.verdict))


def several(work: str, asked: float, values: list[float], unit: str = "s", **more: object) -> Row:
    """A row of measurements."""
    return Row(work, asked, min(values), statistics.median(values), unit, **more)


def in_columns(cells: tuple[str, ...]) -> str:
    """A line of the table."""
    parts = [cell.ljust(w) if i in {0, 6} else cell.rjust(w) for i, (cell, w) in enumerate(zip(cells, WIDTHS, strict=True))]
    return " ".join(parts).rstrip()


def show(value: float, unit: str) -> str:
    """A value with three digits and its unit."""
    if math.isnan(value):
        return "-"
    if unit == "s":
        scale, name = (1e3, "ms") if value < 1 else (1, "s")
        return f"{value * scale:.3g} {name}"
    return f"{value:.3g} {unit}".strip()


def timed(answer: Answer, work: str, asked: float | None, phase: str = "steady", **more: object) -> Row:
    """A row of one phase of an answer."""
    if not answer.converged:
        return Row(work, asked, math.nan, math.nan, note=f"not converged: {answer['reason']}")
    residual = answer["step_residual" if phase == "transient" else "residual"]
    processor = answer["processor"] if phase != "setup" else math.nan
    return Row(work, asked, answer[f"{phase}_least"], answer[f"{phase}_median"], residual=residual, processor=processor, **more)


def solve(*jobs: Job) -> dict[str, Answer]:
    """Answers to jobs; the first one of the process warms up."""
    return bench_program.run([job("warm", case_1(256), runs=5), *jobs])


def case_1_rows(runs: int) -> list[Row]:
    """Case 1, 1024 intervals, by the methods that have a limit."""
    words = {"runs": runs, "seconds": 5}
    solvers = {"hertz": BLOCK_JACOBI | {"start": "hertz"}, "fmg": BLOCK_JACOBI, "line": LINE, "krylov": KRYLOV, "auto": {}}
    jobs = [job(name, case_1(1024, solver), **words) for name, solver in solvers.items()]
    answers = solve(*jobs, job("dense", case_1(1024, DENSE), runs=max(3, runs // 20), seconds=5))
    cycles = {name: f"{answer['cycles']:.0f} cycles, {answer['fft_pairs']:.0f} FFT pairs" for name, answer in answers.items()}
    return [
        timed(answers["hertz"], "Case 1, 1024: Block-Jacobi FAS, hertz", 0.030, note=cycles["hertz"]),
        timed(answers["fmg"], "Case 1, 1024: Block-Jacobi FAS, fmg", 0.015, note=cycles["fmg"]),
        timed(answers["line"], "Case 1, 1024: FAS, line smoother", 0.005, note=cycles["line"]),
        timed(answers["krylov"], "Case 1, 1024: newton_krylov", 0.005, aim=0.002, note=cycles["krylov"]),
        timed(answers["auto"], "Case 1, 1024: auto", None),
        timed(answers["krylov"], "  planning, kernels, storage for it", None, "setup"),
        timed(answers["dense"], "Case 1, 1025 nodes: newton_dense", 0.5),
    ]


def reduction_rows(sizes: tuple[int, ...]) -> list[Row]:
    """Error of P after each V-cycle of Block-Jacobi, 10 + 10 sweeps, relaxation 0.7, from Hertz."""
    most, jobs, rows = 14, [], []
    for n in sizes:
        jobs.append(job(f"{n}", case_1(n, KRYLOV | {"tolerance": NEVER, "max_cycles": 30}), reference=1))
        for k in range(1, most + 1):
            jobs.append(job(f"{n}:{k}", case_1(n, THESIS_SOLVER | {"tolerance": NEVER, "max_cycles": k}), compare=1))
    answers = solve(*jobs)
    for n in sizes:
        errors = [answers[f"{n}:{cycles}"]["difference"] for cycles in range(1, most + 1)]
        last = next((i for i, error in enumerate(errors) if error < 1e-8), len(errors) - 1)
        rate = (errors[last] / errors[1]) ** (1 / (last - 1)) if last > 1 else math.nan
        shown = " ".join(f"{error:.0e}" for error in errors[: last + 1])
        note = f"{answers[f'{n}:{last + 1}']['work_units']:.0f} work units to 1e-8; error after each cycle: {shown}"
        rows.append(several(f"error per V(10,10), Block-Jacobi, {n}", 0.15, [rate], "", note=note))
    return rows


def transient_rows(runs: int) -> list[Row]:
    """Case 3 in 812 steps; the error in P against a run with a tight tolerance."""
    words = {"compare": 1, "runs": runs, "seconds": 15}
    answers = solve(
        job("tight", case_3(1024, KRYLOV | {"tolerance": 1e-10}), reference=1),
        job("auto", case_3(1024), **words),
        job("krylov", case_3(1024, KRYLOV | {"tolerance": 1e-4}), **words),
        job("gauss_seidel", case_3(1024, GAUSS_SEIDEL), compare=1, seconds=10),
    )
    asked = {"auto": ("auto", 1.0, 0.4), "krylov": ("tolerance 1e-4", 1.0, 0.4), "gauss_seidel": ("FAS, Gauss-Seidel", 3.0, None)}
    rows = []
    for name, (words, bound, aim) in asked.items():
        answer = answers[name]
        row = timed(answer, f"Case 3, 1024, 812 steps: {words}", bound, "transient", aim=aim)
        if answer.converged:
            per_step = answer["cycles"] / answer["steps"]
            row.note = f"largest error in P {answer['difference']:.1e} (asked 1e-4), {per_step:.2f} cycles a step"
            if answer["difference"] > 1e-4:
                row.asked, row.note = math.nan, row.note + ": TOO LARGE"
        rows.append(row)
    return rows


def process(*texts: str, options: tuple[str, ...] = (), read: Callable | None = None) -> tuple[Usage, object]:
    """What a whole run of asperity on these namelists takes, and what is read of the first result."""
    with tempfile.TemporaryDirectory() as name:
        paths = [Path(name) / f"{i}.nml" for i in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        used = measured([ASPERITY, *paths, "--output", name, "--quiet", *options])
        if used.status not in {0, 2}:
            sys.exit(f"asperity: exit status {used.status}")
        with h5py.File(paths[0].with_suffix(".h5")) as file:
            return used, read(file) if read else None


def size_rows(runs: int, largest: int) -> list[Row]:
    """Memory and cost of large grids."""
    rows = []
    for words, solver in (("auto", {}), ("Block-Jacobi FAS", BLOCK_JACOBI)):
        text = case_1(2**16, solver)
        rows.append(several(f"peak memory, Case 1, 2^16: {words}", 200, [process(text)[0].memory], "MB"))
        answer = solve(job("large", text, runs=3, seconds=10))["large"]
        rows.append(timed(answer, f"  its time, {answer['cycles']:.0f} cycles", None))
    sizes = [2**k for k in range(10, 17, 2)]
    solvers = {cycles: THESIS_SOLVER | {"tolerance": NEVER, "max_cycles": cycles} for cycles in (2, 6)}
    jobs = [job(f"{n}:{k}", case_1(n, solver), runs=max(3, runs * 1024 // n)) for n in sizes for k, solver in solvers.items()]
    answers = solve(*jobs)
    cost = {n: (answers[f"{n}:6"]["processor"] - answers[f"{n}:2"]["processor"]) / 4 / n for n in sizes}
    shown = ", ".join(f"2^{int(math.log2(n))} {value * 1e6:.2f} us" for n, value in cost.items())
    rows.append(several("per node and cycle, 2^10...2^16: ratio", 2, [max(cost.values()) / min(cost.values())], "", note=shown))
    small = 2**12
    jobs = [job("small", case_1(small, KRYLOV), runs=runs, seconds=5), job("large", case_1(largest, KRYLOV), runs=3, seconds=10)]
    few, many = (answer for name, answer in solve(*jobs).items() if name != "warm")
    least, median, cpu = ((many[key] / largest) / (few[key] / small) for key in ("steady_least", "steady_median", "processor"))
    times = " and ".join(show(each["steady_least"], "s") for each in (few, many))
    note = f"{times}, {few['cycles']:.0f} and {many['cycles']:.0f} steps on the finest grid; CPU with planning"
    work = f"newton_krylov: per node, 2^{int(math.log2(largest))} over 2^12"
    return [*rows, Row(work, 4, least, median, "", many["residual"], 2, note, cpu)]


def process_rows(runs: int, few: int) -> list[Row]:
    """Whole processes: what is not solving on a smooth case, those that do nothing but solve, and two threads beside one."""
    all_of_it = [process(case_1(1024), read=lambda file: float(sum(file["report/phase_seconds"][()]))) for _ in range(runs)]
    whole = [used.wall for used, _ in all_of_it]
    times = f"minimum {show(min(whole), 's')}, median {show(statistics.median(whole), 's')}"
    note = f"whole process: {times}; peak memory {all_of_it[-1][0].memory:.0f} MB; CPU: of the whole"
    around, mean = [used.wall - phases for used, phases in all_of_it], statistics.mean(used.processor for used, _ in all_of_it)
    rows = [several("start-up, input, output of a smooth case", 0.050, around, note=note, processor=mean)]
    many = [case_1(256, load={"load_per_length": 5e4 + 2.5e3 * i}, **LEAN) for i in range(21)]
    cold, further, walls = [], [], []
    for _ in range(few):
        cold.append(process(case_1(1024, **LEAN))[0].processor)
        further.append((process(*many)[0].processor - process(many[0])[0].processor) / (len(many) - 1))
        walls.append([process(case_3(1024), options=("--threads", str(threads)))[0].wall for threads in (1, 2)])
    words = "processor time; no adequacy, error bars, SI copies"
    rows.append(several("whole process, Case 1, 1024", 0.010, cold, aim=0.006, note=words))
    rows.append(several("a further case of 256 in it", 0.004, further, aim=0.002, note=words))
    note = f"wall, {show(min(one for one, _ in walls), 's')} and {show(min(two for _, two in walls), 's')}; with error bars"
    ratios = [two / one for one, two in walls]
    return [*rows, several("Case 3, 812 steps: two threads over one", 0.55, ratios, "", aim=0.45, note=note)]


def momentum_rows(runs: int) -> list[Row]:
    """Case 1 by the full momentum equations: processor time of a whole process, Reynolds' equation included."""
    rows, least = [], {}
    for intervals, asked in ((448, 0.5), (1792, 2.5)):
        text = case_1(intervals, case={"problem": "ehl_line", "equations": "stokes"}, film={"layers": 20})
        done = [process(text, read=lambda file: [int(file["momentum"].attrs[name]) for name in COUNTS]) for _ in range(runs)]
        steps, factors = done[0][1]
        seconds, most = [used.processor for used, _ in done], max(used.memory for used, _ in done)
        least[intervals] = min(seconds)
        note = f"processor time; {steps} Newton steps, {factors} factorisations, {most:.0f} MB"
        rows.append(several(f"Case 1, {intervals} x 20, full momentum", asked, seconds, note=note))
    return [*rows, several("full momentum: per interval, 1792 over 448", 1.3, [least[1792] / 1792 / (least[448] / 448)], "")]


def history_rows(runs: int) -> list[Row]:
    """The mesh of a gear tooth: processor time of a whole process, and its memory over the number of steps."""
    with tempfile.TemporaryDirectory() as name:
        measured([ASPERITY.with_name("asperity-duty"), "gear", ROOT / "input/duty/spur_gear.toml", "--output", name])
        groups = f90nml.read(Path(name) / "spur_gear.nml").todict()
        groups["history"]["file"] = f"{name}/spur_gear.csv"
        groups["output"] = {"adequacy": False}
        end = 48.4028  # of the mesh [T]

        def mesh(steps: int, intervals: int = 512, bars: bool = False, **time: object) -> list[Usage]:
            """Runs of the mesh."""
            own = {"transient": True, "time_step": end / steps} | time
            text = namelist(groups | {"time": own, "domain": {"intervals": intervals}, "accuracy": {"error_bars": bars}})
            return [process(text)[0] for _ in range(runs)]

        few, many = mesh(900), mesh(9000)
        rows = [several("gear mesh, 900 steps, 512", 1.0, [used.processor for used in few])]
        rows.append(several("  with error bars", 2.5, [used.processor for used in mesh(900, bars=True)]))
        march = mesh(200, 256, scheme="quasi_steady")
        rows.append(several("quasi-steady march, 200 moments, 256", 0.15, [used.processor for used in march]))
        ratio = [many[0].memory / few[0].memory]
        return [*rows, several("memory, 9000 steps over 900", 1.1, ratio, "", note=f"{few[0].memory:.0f} MB")]


def stribeck_row(runs: int) -> list[Row]:
    """Thirty speeds of a mixed contact: processor time of a process without error bars."""
    groups = f90nml.read(ROOT / "input/mixed_bearing.nml").todict() | {"accuracy": {"error_bars": False}}
    groups["domain"] |= {"intervals": 512, "x_inlet": -12.0}
    pairs = [{"speed_1": u / 6, "speed_2": u * 11 / 6} for u in (10 ** (4 * i / 29 - 3) for i in range(30))]
    texts = [namelist(groups | {"bodies": groups["bodies"] | pair}) for pair in pairs]
    return [several("Stribeck curve, 30 speeds, 512", 1.5, [process(*texts)[0].processor for _ in range(runs)])]


def point_rows(runs: int) -> list[Row]:
    """Point contacts of Moes' M, L 10, circular: processor time of a process without error bars; two threads beside one."""
    thick, thin = {"viscosity_law": "roelands", "roelands_z": 0.68}, {"viscosity_law": "barus", "density_law": "constant"}
    contacts = [(20, thick, 128, 0.15), (200, thick, 128, 0.15), (20, thick, 512, 3), (200, thick, 512, 3), (1000, thin, 512, 7)]
    rows = []
    for m, oil, n, asked in contacts:
        groups = {"case": {"problem": "ehl_point"}, "moes": {"moes_m": m, "moes_l": 10, "velocity": "sum"}, "lubricant": oil}
        text = namelist(groups | {"domain": {"intervals_x": n, "far_field": False}, "accuracy": {"error_bars": False}})
        done = [process(text, read=lambda file: file["report/grid_work"][()]) for _ in range(runs)]
        mean = max(iterations / steps for steps, iterations in done[0][1])
        note = f"GMRES: at most {mean:.1f} iterations a Newton step in the mean of a grid; {done[0][0].memory:.0f} MB"
        rows.append(several(f"M {m}, {oil['viscosity_law']}, {n} x {n}", asked, [used.processor for used, _ in done], note=note))
    walls = [[process(text, options=("--threads", str(k)))[0].wall for k in (1, 2)] for _ in range(runs)]
    rows += [several("the last one: two threads over one", 0.62, [two / one for one, two in walls], "")]
    dent = {"shape": "feature", "amplitude": -1e-7, "wavelength": 1e-4, "wavelength_y": 1e-4}
    bodies = {"reduced_radius_x": 12.7e-3, "reduced_modulus": 226e9, "speed_1": 0.5, "speed_2": 0.7}
    groups = {
        "case": {"problem": "ehl_point"},
        "bodies": bodies,
        "load": {"load": 30.0},
        "surface_2": dent,
        "time": {"transient": True},
    }
    groups |= {"lubricant": {"viscosity": 0.04, "pressure_viscosity": 2e-8, "roelands_z": 0.6}, "domain": {"intervals_x": 128}}
    names = ("steps", "cycles", "fft_pairs")
    text = namelist(groups | {"accuracy": {"error_bars": False}})
    used, (steps, cycles, pairs) = process(text, read=lambda file: [file[f"report/{name}"][()] for name in names])
    note = f"{cycles / steps:.1f} Newton steps; {steps} steps take {show(used.processor, 's')}"
    return [*rows, several("a dent, 128 x 128: transforms a time step", 25, [pairs / steps], "", note=note)]


def map_row(cells: int) -> list[Row]:
    """`auto` over the M-L plane; intervals and domain chosen by the program."""
    side = round(math.sqrt(cells))
    ms = [0.01 * 2e5 ** (i / (side - 1)) for i in range(side)]
    ls = [40 * j / (side - 1) for j in range(side)]
    answers = solve(*(job(f"{m:.4g},{oil:.4g}", moes(m, oil, None), limit=60) for m in ms for oil in ls))
    del answers["warm"]
    scale = 400 / len(answers)
    total, processor = (scale * sum(answer[key] for answer in answers.values()) for key in ("all_least", "processor"))
    bad = [name for name, answer in answers.items() if not answer.converged]
    worst = max(answers, key=lambda name: answers[name]["all_least"])
    residual = max(answer["residual"] for answer in answers.values() if answer.converged)
    note = f"{len(bad)} not converged, dearest M,L = {worst}: {show(answers[worst]['all_least'], 's')}"
    note += f"; not converged: M,L = {'; '.join(bad[:6])}" if bad else ""
    work = f"auto, M-L map, {len(answers)} cells, as 400"
    return [several(work, 20, [total], aim=4, residual=residual, processor=processor, note=note)]


def main() -> int:
    """Command line; status 0 whatever is missed: the last line says what."""
    options = new_parser(__doc__, "fewer runs and cells, under 30 s", "results/bench").parse_args()
    quick, folder = options.quick, output_folder(options)
    runs = 20 if quick else 300
    parts = {
        "Steady, 5.5 half-widths, Reynolds-Eyring (chapter 5, Case 1), residual 1e-8": partial(case_1_rows, runs),
        "Error reduction per V-cycle, geometric mean from cycle 2 to 1e-8": partial(reduction_rows, (256, 1024, 4096)),
        "In time (chapter 5, Case 3)": partial(transient_rows, 1 if quick else 5),
        "Large grids": partial(size_rows, runs, 2**18 if quick else 2**20),
        "Full momentum equations, whole process (asked for 400 and 1600 intervals)": partial(momentum_rows, 3 if quick else 7),
        "Histories of load, radius and speeds, whole process": partial(history_rows, 3 if quick else 9),
        "Stribeck curve of input/sweeps/stribeck.toml, whole process": partial(stribeck_row, 3 if quick else 9),
        "Point contacts, whole process": partial(point_rows, 3 if quick else 7),
        "Whole program": partial(process_rows, max(runs // 10, 10), 3 if quick else 9),
        "Map": partial(map_row, 100 if quick else 400),
    }
    load = f"{os.cpu_count()} in the machine, load {os.getloadavg()[0]:.1f} at the start"
    lines, rows = [f"asperity, one core ({load}); the verdict is that of the median"], []
    print(lines[0])
    for title, part in parts.items():
        own = part()
        text = [f"\n{title}", in_columns(HEAD), "-" * (sum(WIDTHS) + 6)]
        text += [row.line() + (f"\n    {row.note}" if row.note else "") for row in own]
        print("\n".join(text), flush=True)
        lines, rows = lines + text, rows + own
        (folder / "bench.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
        write_csv(folder / "bench.csv", [*asdict(rows[0]), "verdict"], ([*asdict(row).values(), row.verdict] for row in rows))
    missed = [row.work for row in rows if row.verdict == "MISSED"]
    print(f"\n{folder / 'bench.csv'}; missed: {', '.join(missed) or 'none'}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

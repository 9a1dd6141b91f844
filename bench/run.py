#!/usr/bin/env python3
"""Measures speed and memory against targets, with the residual reached.

Every time is of one core and of many runs in one process (minimum and median); start-up, input and output have their own row. The
verdict is that of the median; `met (min.)` is for a busy machine: by the minimum. Results: a table, and bench.csv.
"""

from __future__ import annotations

import itertools
import math
import os
import sys
import tempfile
from functools import partial
from pathlib import Path

import bench_program
import f90nml
import h5py
import numpy as np
import pandas as pd
from bench_program import ROOT, Answer, Row, Run, answer, measured, phases, run_program, save, show, solve
from chart import METHODS, THESIS_SOLVER, largest_difference, pressures
from namelists import BARE, RIDGE, case_1, moes, namelist

BLOCK_JACOBI, LINE, GAUSS_SEIDEL = (METHODS[f"FAS, {name}"] for name in ("Block-Jacobi", "line", "Gauss-Seidel"))
KRYLOV, DENSE = METHODS["newton_krylov"], METHODS["newton_dense"]
# Far below every tolerance: cycles go on to the limit given by max_cycles.
NEVER = 1e-15
LESS = "no adequacy, error bars, SI copies"
LEAN = BARE | {"output": {"adequacy": False, "si_copies": False}}
# Base and varied key of sweeps; what is left out one after the other: the cost of each is the difference.
SWEEPS = {
    "steady contact": ("minimal", "[vary]\nload.hertz_pressure = {{ from = 0.3e9, to = 0.9e9, count = {} }}\n"),
    "passage, 103 steps": (
        "case3_demo",
        "time.time_step = 0.0215\noutput.profile_stride = 103\n[vary]\nbodies.speed_2 = {{ from = 1.0, to = 1.3, count = {} }}\n",
    ),
}
NO_ADEQUACY = "output.adequacy = false\n"
LEFT_OUT = (NO_ADEQUACY, NO_ADEQUACY + "output.si_copies = false\naccuracy.error_bars = false\n")


def timed(answer: Answer, work: str, asked: float | None, phase: str = "steady", note: str = "") -> Row:
    """A row of one phase of an answer."""
    if not answer.converged:
        return Row(work, asked, math.nan, note=f"not converged: {answer['reason']}")
    if not note:
        note = f"{answer['cycles']} cycles, {answer['fft_pairs']} FFT pairs; "
        note += f"planning, kernels, storage {show(answer.times['setup'].median())}"
    return Row(work, asked, answer.times[phase], note=note, residual=answer["residual"])


def case_1_rows(runs: int) -> list[Row]:
    """Case 1, 1024 intervals, by the methods that have a limit."""
    methods = (
        ("Block-Jacobi FAS, hertz", BLOCK_JACOBI | {"start": "hertz"}, 0.030, runs),
        ("Block-Jacobi FAS, fmg", BLOCK_JACOBI, 0.015, runs),
        ("FAS, line smoother", LINE, 0.005, runs),
        ("newton_krylov", KRYLOV, 0.005, runs),
        ("newton_dense", DENSE, 0.5, max(3, runs // 20)),
    )
    found = [(words, asked, solve(case_1(1024, solver, **BARE), count, 5)) for words, solver, asked, count in methods]
    return [timed(answer, f"Case 1, 1024: {words}", asked) for words, asked, answer in found]


def reduction_rows(sizes: tuple[int, ...]) -> list[Row]:
    """Error of P after each V-cycle of Block-Jacobi, 10 + 10 sweeps, relaxation 0.7, from Hertz."""

    def after(n: int, cycles: int, solver: dict) -> tuple[np.ndarray, float]:
        text = case_1(n, solver | {"tolerance": NEVER, "max_cycles": cycles}, **BARE)
        return run_program(text, lambda file: (file["solution/pressure"][()], file["report/work_units"][()])).found

    rows = []
    for n in sizes:
        exact, _ = after(n, 30, KRYLOV)
        found = [after(n, cycles, THESIS_SOLVER) for cycles in range(1, 15)]
        errors = [np.abs(pressure - exact).max() for pressure, _ in found]
        last = next((i for i, error in enumerate(errors) if error < 1e-8), len(errors) - 1)
        rate = (errors[last] / errors[1]) ** (1 / (last - 1)) if last > 1 else math.nan
        shown = " ".join(f"{error:.0e}" for error in errors[: last + 1])
        note = f"{found[last][1]:.0f} work units to 1e-8; error after each cycle: {shown}"
        rows.append(Row(f"error per V(10,10), Block-Jacobi, {n}", 0.15, rate, "", note))
    return rows


def case_3(solver: dict, **others: dict) -> str:
    """Chapter 5, Case 3: the ridge on the fast surface; 812 steps of dX/2, the scheme of the thesis."""
    time = {"transient": True, "end_time": 2.1806640625, "time_step": 5.5 / 2048, "scheme": "backward_euler"}
    return case_1(1024, solver, surface_2=RIDGE, time=time, **others)


def transient_rows(runs: int) -> list[Row]:
    """Case 3 in 812 steps; the error in P against a run with a tight tolerance."""

    def found(solver: dict, runs: int = 0) -> Answer:
        stored = {"adequacy": False, "profile_stride": 1}
        return solve(case_3(solver, accuracy=BARE["accuracy"], output=stored), runs, 15, read=pressures)

    exact, rows = found(KRYLOV | {"tolerance": 1e-10}), []
    for words, solver, bound, count in (
        ("auto", {}, 1.0, runs),
        ("tolerance 1e-4", KRYLOV | {"tolerance": 1e-4}, 1.0, runs),
        ("FAS, Gauss-Seidel", GAUSS_SEIDEL, 3.0, 1),
    ):
        own = found(solver, count)
        error = largest_difference(own["pressure"], exact["pressure"])
        note = f"largest error in P {error:.1e} (asked 1e-4), {own['cycles'] / own['steps']:.2f} cycles a step"
        asked = bound if error <= 1e-4 else math.nan
        rows.append(timed(own, f"Case 3, 1024, 812 steps: {words}", asked, "transient", note))
    return rows


def size_rows(runs: int, largest: int) -> list[Row]:
    """Memory and cost of large grids."""
    rows = []
    for words, solver in (("auto", {}), ("Block-Jacobi FAS", BLOCK_JACOBI)):
        rows.append(Row(f"peak memory, Case 1, 2^16: {words}", 200, run_program(case_1(2**16, solver)).memory, "MB"))
    cost = {}
    for n in (2**k for k in range(10, 17, 2)):
        solvers = (THESIS_SOLVER | {"tolerance": NEVER, "max_cycles": cycles} for cycles in (2, 6))
        few, many = (bench_program.times_of(case_1(n, each, **BARE), max(3, runs * 1024 // n))["steady"].min() for each in solvers)
        cost[n] = (many - few) / 4 / n
    shown = ", ".join(f"2^{int(math.log2(n))} {value * 1e6:.2f} us" for n, value in cost.items())
    rows.append(Row("per node and cycle, 2^10...2^16: ratio", 2, max(cost.values()) / min(cost.values()), "", shown))
    small = 2**12
    few, many = solve(case_1(small, KRYLOV, **BARE), runs, 5), solve(case_1(largest, KRYLOV, **BARE), 3, 10)
    medians = [each.times["steady"].median() for each in (few, many)]
    note = f"{' and '.join(map(show, medians))}, {few['cycles']} and {many['cycles']} steps on the finest grid"
    work = f"newton_krylov: per node, 2^{int(math.log2(largest))} over 2^12"
    return [*rows, Row(work, 4, medians[1] / medians[0] * small / largest, "", note, many["residual"])]


def whole(work: str, asked: float | None, texts: str | list[str], runs: int, files: dict | None = None) -> tuple[Row, Run]:
    """Processor time of whole processes, and the last of them."""
    done = [run_program(texts, files=files) for _ in range(runs)]
    memory = f"processor time; {max(used.memory for used in done):.0f} MB"
    return Row(work, asked, [used.processor for used in done], note=memory), done[-1]


def two_threads(work: str, asked: float, text: str, runs: int) -> Row:
    """Wall time of two threads over that of one."""
    walls = np.array([[run_program(text, options=("--threads", k)).wall for k in (1, 2)] for _ in range(runs)])
    return Row(work, asked, walls[:, 1] / walls[:, 0], "", f"wall, {' and '.join(show(least) for least in walls.min(axis=0))}")


def process_rows(runs: int, few: int) -> list[Row]:
    """Whole processes: what is not solving on a smooth case, those that do nothing but solve, and two threads beside one."""
    every = [run_program(case_1(1024), phases) for _ in range(runs)]
    note = f"whole process: median {show(np.median([used.wall for used in every]))}; peak memory {every[-1].memory:.0f} MB"
    many = [case_1(256, load={"load_per_length": 5e4 + 2.5e3 * i}, **LEAN) for i in range(21)]
    pairs = [(run_program(many).processor, run_program(many[0]).processor) for _ in range(few)]
    return [
        Row("start-up, input, output of a smooth case", 0.050, [used.wall - used.found.sum() for used in every], note=note),
        whole("whole process, Case 1, 1024", 0.010, case_1(1024, **LEAN), few)[0],
        Row("a further case of 256 in it", 0.004, [(all_ - one) / 20 for all_, one in pairs], note=LESS),
        two_threads("Case 3, 812 steps: two threads over one", 0.55, case_3({}), few),
    ]


def momentum_rows(runs: int) -> list[Row]:
    """Case 1 by the full momentum equations, Reynolds' equation included."""
    rows = []
    for intervals, asked in ((448, 0.5), (1792, 2.5)):
        text = case_1(intervals, case={"problem": "ehl_line", "equations": "stokes"}, film={"layers": 20})
        rows.append(whole(f"Case 1, {intervals} x 20, full momentum", asked, text, runs)[0])
    return [*rows, Row("full momentum: per interval, 1792 over 448", 1.3, rows[1].least / rows[0].least / 4, "")]


def history_rows(runs: int) -> list[Row]:
    """The mesh of a gear tooth: processor time of a whole process, and its memory over the number of steps."""
    with tempfile.TemporaryDirectory() as name:
        measured([bench_program.ASPERITY.with_name("asperity-duty"), "gear", ROOT / "input/duty/spur_gear.toml", "--output", name])
        groups = f90nml.read(Path(name) / "spur_gear.nml").todict() | {"output": {"adequacy": False}}
        files = {groups["history"]["file"]: (Path(name) / "spur_gear.csv").read_bytes()}
    end = 48.4028  # of the mesh [T]

    def mesh(work: str, asked: float | None, steps: int, n: int = 512, bars: bool = False, **time: object) -> tuple[Row, Run]:
        """Row and last run of the mesh."""
        own = {"transient": True, "time_step": end / steps} | time
        text = namelist(groups | {"time": own, "domain": {"intervals": n}, "accuracy": {"error_bars": bars}})
        return whole(work, asked, text, runs, files=files)

    row, few = mesh("gear mesh, 900 steps, 512", 1.0, 900)
    bars, _ = mesh("  with error bars", 2.5, 900, bars=True)
    march, _ = mesh("quasi-steady march, 200 moments, 256", 0.15, 200, 256, scheme="quasi_steady")
    _, many = mesh("", None, 9000)
    return [row, bars, march, Row("memory, 9000 steps over 900", 1.1, many.memory / few.memory, "")]


def stribeck_row(runs: int) -> list[Row]:
    """Thirty speeds of a mixed contact: processor time of a process without error bars."""
    groups = f90nml.read(ROOT / "input/mixed_bearing.nml").todict() | {"accuracy": {"error_bars": False}}
    groups["domain"] |= {"intervals": 512, "x_inlet": -12.0}
    pairs = [{"speed_1": u / 6, "speed_2": u * 11 / 6} for u in np.logspace(-3, 1, 30).tolist()]
    texts = [namelist(groups | {"bodies": groups["bodies"] | pair}) for pair in pairs]
    return [whole("Stribeck curve, 30 speeds, 512", 1.5, texts, runs)[0]]


def point_rows(runs: int) -> list[Row]:
    """Point contacts of Moes' M, L 10, circular: processor time of a process without error bars; two threads beside one."""
    thick, thin = {"viscosity_law": "roelands", "roelands_z": 0.68}, {"viscosity_law": "barus", "density_law": "constant"}
    contacts = [(20, thick, 128, 0.15), (200, thick, 128, 0.15), (20, thick, 512, 3), (200, thick, 512, 3), (1000, thin, 512, 7)]
    point, rows = {"case": {"problem": "ehl_point"}, "accuracy": {"error_bars": False}}, []
    for m, oil, n, asked in contacts:
        groups = point | {"moes": {"moes_m": m, "moes_l": 10, "velocity": "sum"}, "lubricant": oil}
        text = namelist(groups | {"domain": {"intervals_x": n, "far_field": False}})
        rows.append(whole(f"M {m}, {oil['viscosity_law']}, {n} x {n}", asked, text, runs)[0])
    rows.append(two_threads("the last one: two threads over one", 0.62, text, runs))
    groups = point | {
        "bodies": {"reduced_radius_x": 12.7e-3, "reduced_modulus": 226e9, "speed_1": 0.5, "speed_2": 0.7},
        "load": {"load": 30.0},
        "lubricant": {"viscosity": 0.04, "pressure_viscosity": 2e-8, "roelands_z": 0.6},
        "surface_2": {"shape": "feature", "amplitude": -1e-7, "wavelength": 1e-4, "wavelength_y": 1e-4},
        "time": {"transient": True},
        "domain": {"intervals_x": 128},
    }
    used = run_program(namelist(groups), answer)
    steps, cycles, pairs = (used.found[name] for name in ("steps", "cycles", "fft_pairs"))
    note = f"{cycles / steps:.1f} Newton steps; {steps} steps take {show(used.processor)}"
    return [*rows, Row("a dent, 128 x 128: transforms a time step", 25, pairs / steps, "", note)]


def map_row(cells: int) -> list[Row]:
    """`auto` over the M-L plane, intervals and domain chosen by the program: setup and solution in one process."""
    side = round(math.sqrt(cells))
    places = [(0.01 * 2e5 ** (i / (side - 1)), 40 * j / (side - 1)) for i in range(side) for j in range(side)]
    texts = [moes(m, oil, None, **BARE) for m, oil in places]
    solved = run_program(texts, lambda file: (answer(file), phases(file)[:3].sum())).results
    bad = [f"{m:.4g},{oil:.4g}" for (m, oil), (found, _) in zip(places, solved, strict=True) if not found.converged]
    note = f"not converged: M,L = {'; '.join(bad) or 'none'}; dearest cell {show(max(seconds for _, seconds in solved))}"
    work, worst = f"auto, M-L map, {len(places)} cells, as 400", max(found["residual"] for found, _ in solved if found.converged)
    return [Row(work, 20, 400 / len(places) * sum(seconds for _, seconds in solved), note=note, residual=worst)]


def script(name: str, *arguments: object) -> Run:
    """What a script of batch/ takes with all that it starts."""
    used = measured([sys.executable, ROOT / "batch" / name, *arguments])
    if used.status != 0:
        sys.exit(f"run.py: {name}: {used.words}")
    return used


def sweep_rows(count: int, results: int) -> list[Row]:
    """Sweeps on 256 intervals: processor time of a case, of batch/run.py and all that it starts, and its parts; gathering."""
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for words, (base, text) in SWEEPS.items():
            name, seconds = Path(folder) / base, []
            for extra in ("", *LEFT_OUT):
                head = f'base = "{ROOT / "input" / base}.nml"\n[set]\ndomain.intervals = 256\n{extra}'
                name.with_suffix(".toml").write_text(head + text.format(count), encoding="utf-8")
                script("sweep.py", name.with_suffix(".toml"), "--output", name, "--replace")
                seconds.append(script("run.py", name, "--jobs", 2).processor / count)
            found = []
            for path in (name / "cases").glob("*.h5"):
                with h5py.File(path) as file:
                    found.append(phases(file)[:3].sum())
            # on a busy machine the shortest one is nearest to its processor time
            every, lean, bare, solution = *seconds, min(found)
            parts = {"all": every, "adequacy": every - lean, "error bars": lean - bare}
            parts |= {"solution": solution, "not solving": bare - solution}
            rows += [Row(f"{words}, in a sweep: {part}", None, value) for part, value in parts.items()]
        cases = sorted((Path(folder) / "minimal" / "cases").glob("*.h5"))[:100]
        many = Path(folder) / "many"
        (many / "cases").mkdir(parents=True)
        names = [f"case_{i:06d}" for i in range(1, results + 1)]
        for (i, case), kind in itertools.product(enumerate(names), (".h5", ".nml")):
            (many / "cases" / f"{case}{kind}").hardlink_to(cases[i % len(cases)].with_suffix(kind))
        pd.DataFrame({"case": names, "x": range(results)}).to_csv(many / "index.csv", index=False)
        used = script("gather.py", many)
    note = f"processor time {used.processor:.1f} s, {used.memory:.0f} MB"
    return [*rows, Row(f"gathering {results} steady results", None, used.wall, note=note)]


def main() -> None:
    """Command line; status 0 whatever is missed: the last line says what."""
    options = bench_program.new_parser(__doc__, "fewer runs and cells, under 30 s", "results/bench").parse_args()
    quick, path = options.quick, options.output / "bench.csv"
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
        "Sweeps": partial(sweep_rows, *((10, 20) if quick else (500, 10_000))),
        "Map": partial(map_row, 100 if quick else 400),
    }
    load = f"{os.cpu_count()} in the machine, load {os.getloadavg()[0]:.1f} at the start"
    print(f"asperity, one core ({load}); the verdict is that of the median")
    rows = []
    for title, part in parts.items():
        own = part()
        bench_program.show_rows(title, own)
        rows += own
        save(path, rows)
    missed = [row.work for row in rows if row.verdict == "MISSED"]
    print(f"\n{path}; missed: {', '.join(missed) or 'none'}")


if __name__ == "__main__":
    main()

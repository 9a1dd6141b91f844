#!/usr/bin/env python3
"""Writes docs/performance.md from the results of `make bench`, `chart`, `accuracy` and `stability`, and copies their figures.

Every number and every statement of the page comes from these results; run it after the four commands.
"""

from __future__ import annotations

import csv
import platform
import re
import shutil
import subprocess
import sys
import textwrap
from collections import Counter, defaultdict
from pathlib import Path

import chart_models
import dry
import stability_cells
from bench_program import ROOT

RESULTS = ROOT / "results"
PAGE = ROOT / "docs" / "performance.md"
IMAGES = ROOT / "docs" / "images" / "performance"

HEAD = """# Performance

How fast the solvers are, how accurate for their time, and where each of them fails. This page is written by
`bench/page.py` from the results of five commands; nothing in it is typed by hand but the sentences between the numbers.

<!-- not run: takes more than an hour -->
```sh
make bench        # results/bench/: the tables
make chart        # results/chart/: error against wall time
make accuracy     # results/accuracy/: are the error bars honest, what does a wanted accuracy cost
make accuracy-time   # the same of transients
make stability    # results/stability/: maps of convergence
.venv/bin/python bench/page.py
```

Each has a short form, `ARGS=--quick`. Measured on {processor}, {cores}, gfortran {compiler}, portable build, commit {commit}.

## Speed and memory

Wall time of one core, and the mean processor time of a run, planning included (`CPU`). `resid` is the residual that the solver
reached. The verdict is that of the median; where other work on the machine (see its load) made that miss, `met (min.)` and
`met (CPU)` say that the minimum or the processor time is within what was asked. Times of solving do not
contain planning of transforms, kernels and storage, which have a row of their own, nor start-up, input and output.

```text
{bench}
```

[The rows as CSV](images/performance/bench.csv).
{native}
## Error against wall time

![Error against wall time of every method, in three panels, and of leaner models](images/performance/chart.png)

The error is the true one, against the same contact on a grid at least four times finer than the finest shown, solved far below its
discretisation error. Numbers at the points are intervals. In the steady panels it is the larger one of the relative errors of
h_min and of h at X = 0; in time it is the largest error in P over all nodes and times. On grids that are no finer than its coarsest
level a cycle is nothing but its exact solution: there the curves of FAS are those of dense Newton. `auto, extrapolated` is the
Richardson value that `/summary` holds beside every figure, at the time of the run with error bars; `auto, target given` lets the
program choose the grid (`&accuracy target`), at the time of the choice and the solution. `auto, kappa scheme` has
`&solver space_scheme = 'kappa'`, without error bars; the reference of the steady panels has it too. Thin bars reach from the least
time to what nine tenths of the runs stay below. The star is the thesis's own setting: Block-Jacobi V-cycles on 1024
intervals from the pressure of Hertz, in time backward Euler with dT = dX/2; it prints neither sweeps, relaxation nor tolerance,
those are ours. `auto, whole program` is the default as a user calls it, at the wall time of the process with start-up, input,
error bars and output.

The last panel sets the error of the model beside that of the numbers: a ridge passes through Case 1, by the full model on finer and
finer grids (curve), and with one ingredient left out on the grid of {lean_grid} intervals (stars). Its error is that of the
smallest film of all times, its cost processor time, all runs taking turns.

```text
{chart}
```

The points as CSV: [methods](images/performance/chart.csv), [models](images/performance/chart_models.csv).

## Error bars and a wanted accuracy

Steady contacts: those on which the rules of the estimates were fitted (over the Moes plane, two Newtonian oils and Eyring oils,
Case 1 and its like, ridges at rest), and fresh ones, drawn at random from the same range when the rules stood. The known answer is
that on 8 times the intervals (`grid`), with four times the domain besides (`whole`). `none`: cases without an estimate. `true
below`: the true error is below the estimate; `below 10 x`: the estimate is below ten times the true error; `median`: of estimate
over true error. The wanted accuracy of h_min holds for grid and domain together; the best fixed grid is the coarsest with 2^k
intervals whose true error meets it, on the same domain.

```text
{accuracy}
```

Transients: ridges, dents, features that overtake, waviness and roughness pass through contacts of five loads and three oils,
slide-to-roll -1.9 to 4, on 256 and on 128 intervals with dT = dX, against four times as many and a fourth of the step (BDF2, for
both schemes); fitted samples and fresh ones. Columns as above; `error`: median of the true error, relative. The wanted accuracy
counts everything, pilot runs included, beside the fewest 2^k intervals (1 %: 64 to 1024, 0.1 %: to 4096) with dT = dX and the space
scheme of the thesis from which on all meet it; where it says so, beside the cheaper one of such choices with either space scheme:
the program takes the kappa scheme. Errors of grid and time step of opposite signs often make a fixed choice good by chance,
which no program can know beforehand: these are the cases with the largest ratios.

```text
{accuracy_time}
```

Kinds of input that once ended with a wrong number and a small estimate, each a family of random members beside their truth
(`bench/families.py`), on a seed that no rule was fitted on. `refused`: no number that looks like an answer; `noted`: the
closing table says that the numbers are not to be relied on; `not known`: no estimate; of all others, how often the truth is
within the estimate (asked: 95 %), and the estimate below ten times the true error (80 %). The inputs and templates of the
repository, `shipped_...`, are no sample: there every truth must be within.

```text
{families}
```

The rows as CSV: [errors](images/performance/accuracy.csv), [cost](images/performance/cost.csv); of transients
[errors](images/performance/accuracy_time.csv), [cost](images/performance/cost_time.csv).

## Where the methods converge

Iterations on the finest grid as colour, one frame for all methods. A cell counts as right if it converges, or if its given grid is
too coarse for a discrete film, or its time step too long for a feature, and the program says so. Orange: converged after more than
30 iterations; red: not converged, the sign says why. Maps with few cells are those of the short form of the command.
"""

CAPTIONS = {
    "moes_barus": "Newtonian contacts, Barus, incompressible, over Moes' numbers (speed sum).",
    "moes_roelands": "The same with Roelands and Dowson-Higginson.",
    "moes_eyring": "The same with an Eyring stress of 3.3 MPa and a slide-to-roll ratio of 5/3.",
    "eyring_stress": "Eyring stress against load.",
    "slide_to_roll": "Eyring stress against slide-to-roll ratio; beyond 2 the surfaces move against each other.",
    "intervals": "Given number of intervals against load, Newtonian and with low Eyring stress.",
    "relaxation": "Relaxation and sweeps of each smoother, on Case 1 and on a heavier Newtonian contact.",
    "coarsest": "Coarsest level of the cycle against load.",
    "time_step": "A ridge passes: time step against slide-to-roll ratio.",
    "rolling": "A ridge rolls into Case 1 without sliding, its oil and a Newtonian one: time step against intervals.",
    "roughness": "A wavy surface at rest under a sliding one: amplitude over central film against wavelength.",
    "ridge": "Ridges of other heights and widths pass as in Case 3.",
}


def first_match(pattern: str, text: str, default: str) -> str:
    """The first group of a pattern."""
    match = re.search(pattern, text)
    return match[1].strip() if match else default


def output_of(*command: str) -> str:
    """Standard output of a command."""
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout.strip()


def machine() -> dict[str, str]:
    """Processor, compiler and commit."""
    cpu = Path("/proc/cpuinfo").read_text(encoding="utf-8") if Path("/proc/cpuinfo").exists() else ""
    processor = first_match(r"model name\s*:(.+)", cpu, platform.processor())
    cores = f"{cpu.count('model name')} cores" if cpu else "unknown cores"
    compiler = output_of("gfortran", "-dumpfullversion")
    return {
        "processor": processor,
        "cores": cores,
        "compiler": compiler,
        "commit": output_of("git", "rev-parse", "--short", "HEAD"),
    }


def wrapped(text: str) -> str:
    """Long lines folded, with their indent."""
    lines = []
    for line in text.splitlines():
        indent = " " * (len(line) - len(line.lstrip()))
        lines += textwrap.wrap(line, 128, subsequent_indent=indent + "    ") or [""]
    return "\n".join(lines)


def native_table() -> str:
    """Rows of a run with NATIVE=1 in results/bench_native beside those of the portable build."""
    path = RESULTS / "bench_native" / "bench.csv"
    if not path.exists():
        return ""
    portable, native = ({row["work"].strip(): row for row in rows(file)} for file in (RESULTS / "bench" / "bench.csv", path))
    lines = ["", "With `NATIVE=1` (`-march=native`), medians:", "", "| work | portable | native |", "|---|---|---|"]
    for work, row in portable.items():
        if row["unit"] == "s" and work in native and "nan" not in {row["median"], native[work]["median"]}:
            ours, theirs = (float(each["median"]) * 1e3 for each in (row, native[work]))
            lines.append(f"| {work} | {ours:.3g} ms | {theirs:.3g} ms |")
    return "\n".join(lines) + "\n"


def rows(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV file."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def is_right(row: dict[str, str]) -> bool:
    """Whether a cell has converged, however slowly, or its grid or time step is too coarse and was called so."""
    return row["reason"] == "converged" or row["status"] == "too coarse"


def map_section(name: str) -> str:
    """Figure, caption and counts of one map."""
    counts: dict[str, Counter] = defaultdict(Counter)
    for row in rows(RESULTS / "stability" / f"stability_{name}.csv"):
        counts[row["method"]][is_right(row)] += 1
    parts = []
    for method, count in counts.items():
        right, total = count[True], sum(count.values())
        parts.append(f"{method} {right}" if right < total else f"{method} all")
    total = sum(next(iter(counts.values())).values())
    text = f"{CAPTIONS[name]} Right, of {total} cells each: {'; '.join(parts)}. [CSV](images/performance/stability_{name}.csv)."
    title = CAPTIONS[name].rstrip(".")
    return (
        f"\n![{title}](images/performance/stability_{name}.png)\n\n"
        + "\n".join(textwrap.wrap(text, 128, break_on_hyphens=False))
        + "\n"
    )


def cells_of_auto(names: list[str]) -> str:
    """The cells in which `auto` is not right, or the statement that there are none."""
    bad = []
    total = 0
    for name in names:
        for row in rows(RESULTS / "stability" / f"stability_{name}.csv"):
            if row["method"].startswith("auto"):
                total += 1
                if not is_right(row):
                    axes = list(row)[1:3]
                    bad.append(
                        f"- {name}, {row['method']}, {axes[0]} = {row[axes[0]]}, {axes[1]} = {row[axes[1]]}: {row['status']}"
                    )
    if not bad:
        return f"\n`auto` is right in all {total} cells of these maps.\n"
    return f"\n`auto` is right in {total - len(bad)} of {total} cells of these maps. The others:\n\n" + "\n".join(bad) + "\n"


DRY_HEAD = """
## Dry contacts

`make bench-dry`: time of solutions to an error measure of 1e-6, in processor seconds of one core, beside the fastest of aspher,
tamaas and ContactMechanics on the same surface, each with the loosest tolerance that makes its answer as good by the same measure.
Planning of transforms is counted against asperity. `over transforms`: time of the solution without planning over the sum, for all
its transforms, of FFTW's own time at their size and precision with plans measured beforehand. A row names the peers that it
was measured beside; nothing was asked of two threads but to print them beside FFTW's own. `whole process`: the same time of the
peer over the processor time of our whole process, which reads the heights from HDF5 and writes all fields in double precision,
without error bars and adequacy. A solution takes few transforms (6 to 11 pairs). Of the instructions of a whole process of 1024²
nodes FFTW takes 28 %, the network that saves transforms 11 %, lists of nodes in contact 9 %, copies and the symbol 9 %, memory 8 %,
roughness statistics 8 % at 5 % of contact; at 15 % the network takes 25 % and FFTW 21 %. So no single part is the bound; FFTW is
the largest one up to about 10 % of contact.

"""


def dry_section() -> str:
    """The table of `make bench-dry`, of this run or as it is on the page already."""
    fresh, kept = RESULTS / "bench" / "dry.csv", IMAGES / "dry.csv"
    if fresh.exists():
        shutil.copy(fresh, kept)
    if not kept.exists():
        return ""
    table = "\n".join(wrapped(dry.line_of(row)) for row in rows(kept))
    return f"{DRY_HEAD}```text\n{table}\n```\n\n[The rows as CSV](images/performance/dry.csv).\n"


RESULT_FILE = """
## What a result file costs

A steady contact on 256 intervals with adequacy writes 93 datasets with 673 attributes. Without adequacy, error bars and SI copies
it takes 30 million instructions as a further case of a process (`valgrind --tool=callgrind`; all parts in
[batch.md](batch.md#what-it-costs)), 36 before the inputs were attributes instead of datasets. Types of strings, the dataspace of
one number and the properties of datasets are made once a file, and up to 16 numbers lie in the header of their dataset. Tried and
slower: the newer headers of HDF5 (41.1 where the old ones took 36.2); of no use: larger blocks for headers.

From start to result, processor time of the fastest of 25 runs in turns (2 cores, load 0.3), before and with HDF5, FFTW and an
OpenBLAS without threads linked into the program and the inputs as attributes:

| | before | now |
|---|---|---|
| `asperity --version` | 8.9 ms | 1.2 ms |
| `asperity case1.nml`, with adequacy, error bars and SI copies | 32.1 ms | 17.5 ms |
| the same without these three | 21.6 ms | 9.9 ms |
| a further case on 256 intervals without these three | 8.1 ms | 4.3 ms |

Profiles of passages were compressed (deflate 4). That made the files smaller by a fourth, 27.1 to 19.2 MB for `input/case3.nml`,
and the whole run longer by 17 to 44 % (case3 44, rough_passage 21, overtaking 18, case3_demo 33, rolling_sinusoid 31 %); with
level 1 the run was 3 % shorter. They are not compressed any more; `h5repack` does it. `&output si_copies = .false.` halves these
files.

## The whole process

What was asked of whole processes, and what they take; 2 cores of an AMD EPYC, nothing else running, load 0.4 to 1.5, `make bench`
and `bench/dry.py --peers PYTHON` (aspher, the fastest peer). Processor times, but for the wall time of two threads.

| work | asked | measured | what holds it |
|---|---|---|---|
| Case 1 from start to result, nothing but the solution | 10 ms | 10.0 ms at best, median 10.6 ms | HDF5 and the namelist |
| a further case of 256 intervals in the process | 4 ms | 4.3 to 4.8 ms | HDF5: 54 datasets, 433 attributes |
| elastic area, peer over our process: 256², 1/5/15 % | 5 | 1.0/1.8/1.6 | files, statistics of roughness |
| 512² | 5 | 1.5/3.3/3.0 | the same |
| 1024² | 7 | 2.7/4.9/5.8 | the same |
| 2048² | 10 | 5.7/6.5/8.5 | writing 200 MB, pages cleared by the system |
| peer over our solution: 256² | 6 | 3.0/4.3/3.2 | network and lists; planning is a third at 1 % |
| 512² | 8 | 3.9/6.6/5.0 | the same |
| 1024² | 10 | 9.7/9.2/8.8 | network and transforms |
| two threads, 4096² | 1.5 | 1.09 in one run (1.45 on another machine), FFTW alone 1.65 | what is not transforms |
| Case 3, 812 steps, error bars, two cores, wall over that of before | 0.55 | **0.39** (0.57 s for 1.45 s) | |
| the same over one thread of today | - | 0.61 | the march itself, adequacy |
| a time step on 1024 intervals | 0.75 of 0.57 to 0.74 ms | 0.38 ms | |

`&output fields` and `precision = 'single'` shorten what is written of areas. Memory that is kept (see above) raises the peak by 2 %
(1024²) to 7 % (2048², 15 %); 4096² takes 2.25 GB.
"""

ADEQUACY_HEAD = """
## What a model needs

What `/adequacy` says of lubricated models (`bench/adequacy.py`, 36 members of seed 350827, on which no rule was fitted): random
steady contacts, a third of them with ridges or waves, and passages, beside runs on fine grids with and without each ingredient.
`honest`: how often the true change of a quantity is within the error bar, but for changes of the smooth contact that a passage
starts from; `right`: how often the verdict is that of the true changes, where there is one. Asked of both: 95 %.

```text
"""

ADEQUACY_TAIL = """```

Both are met, with few members in some of the rows. On seed 715093, 36 members by which the order of the measurements and what
counts as small at rest were chosen, it was 96.6 and 94.3 % in steady contacts, 98.1 and 95.5 % in passages; films and pressure
of steady contacts were within their bars in 97 %, friction in 87 %, since that of a Newtonian oil at a spike has no limit of
fine grids.

That is known now. Steady contacts alone, with the friction that [a spike may carry](theory.md#friction), bodies stiffened at
the same places in metres, and verdicts that count the friction of the truth where the program says that it is at least so much
(the first 24 of seed 20261209, drawn after the rule): changes of friction were within their bars in 91 of 92, 22 are not known;
films and pressure in 275 of 282.

```text
ingredient               scenes not known   honest    right
steady compressibility       24         4   97.5 %  100.0 %
steady elasticity            23         0   92.3 %  100.0 %
steady feature_1_1            2         0  100.0 %  100.0 %
steady feature_1_2            2         0  100.0 %  100.0 %
steady piezoviscosity        24         2  100.0 %  100.0 %
steady roelands              24         3  100.0 %  100.0 %
steady roughness              8         2   92.0 %  100.0 %
steady shear_thinning        17         1   98.1 %   87.5 %
steady all                  124        12   97.9 %   98.2 %
0 of 24 scenes have no result or no truth
```

What it costs, in millions of instructions (valgrind); asked: a tenth of the run, or 20 ms. Processor time with and without, the
least of 15 interleaved runs on a loaded machine: `minimal` 49 and 38 ms, `case1` 54 and 43 ms. `rough_passage` ends at T = 5
here.

| input | without | with | more |
|---|---|---|---|
| `minimal` | 81 | 158 | 78, 11 ms: met |
| `case1` | 89 | 159 | 70, 10 ms: met |
| `dry_area` | 669 | 748 | 79, 11 ms: met |
| `case3_demo` | 3665 | 4029 | 9.9 %: met |
| `rough_passage` | 1711 | 1849 | 8.1 %: met |
"""


def adequacy_section() -> str:
    """The table of bench/adequacy.py, of this run or as it is on the page already."""
    fresh, kept = RESULTS / "adequacy" / "adequacy.txt", IMAGES / "adequacy.txt"
    if fresh.exists():
        shutil.copy(fresh, kept)
    return ADEQUACY_HEAD + kept.read_text(encoding="utf-8") + ADEQUACY_TAIL


AUTO = """
## What model = 'auto' saves

Random scenes (`bench/auto.py`), steady contacts and passages over the whole range, each solved with a target of 1 % of h_min by
`model = 'auto'` and by the full model, beside the full model with a quarter of that. `met`: h_min is within the target of the
truth; `honest`: within the error bars; time is processor time, one run each. [Scenes as CSV](images/performance/auto.csv).

```text
{auto}
```

![Processor time and error of model = 'auto' over those of the full model](images/auto.png)
"""


def auto_section() -> str:
    """What bench/auto.py --page has stored."""
    kept = IMAGES / "auto.txt"
    return AUTO.format(auto=kept.read_text(encoding="utf-8").strip()) if kept.exists() else ""


def main() -> int:
    """Writes the page; status 1 if results are missing."""
    needed = [RESULTS / "bench" / "bench.txt"]
    needed += [RESULTS / name / "conclusion.txt" for name in ("chart", "accuracy", "stability")]
    needed += [RESULTS / "accuracy" / name for name in ("conclusion_time.txt", "families.txt")]
    missing = [str(path) for path in needed if not path.exists()]
    if missing:
        print(
            f"page.py: missing: {', '.join(missing)}: make bench, chart, accuracy, accuracy-time, stability first",
            file=sys.stderr,
        )
        return 1
    IMAGES.mkdir(parents=True, exist_ok=True)
    names = [name for name in stability_cells.NAMES if (RESULTS / "stability" / f"stability_{name}.csv").exists()]
    files = [RESULTS / "bench" / "bench.csv", RESULTS / "chart" / "chart.png", RESULTS / "chart" / "chart.csv"]
    files.append(RESULTS / "chart" / "chart_models.csv")
    files += [RESULTS / "accuracy" / name for name in ("accuracy.csv", "cost.csv", "accuracy_time.csv", "cost_time.csv")]
    files += [RESULTS / "stability" / f"stability_{name}.{kind}" for name in names for kind in ("png", "csv")]
    for path in files:
        shutil.copy(path, IMAGES)
    bench, chart, accuracy, _, in_time, families = (path.read_text(encoding="utf-8").strip() for path in needed)
    texts = {"chart": wrapped(chart), "accuracy": wrapped(accuracy), "accuracy_time": wrapped(in_time), "families": families}
    texts["lean_grid"] = chart_models.LEAN_GRID
    text = HEAD.format(bench=bench, native=native_table(), **texts, **machine())
    text += cells_of_auto(names) + "".join(map_section(name) for name in names) + dry_section() + RESULT_FILE
    text += adequacy_section() + auto_section()
    PAGE.write_text(text, encoding="utf-8")
    print(PAGE)
    return 0


if __name__ == "__main__":
    sys.exit(main())

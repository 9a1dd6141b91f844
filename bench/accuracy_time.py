#!/usr/bin/env python3
"""Are the error bars of transients honest, and what does a wanted accuracy cost in time? A survey of passages.

Ridges, dents, features that overtake, waviness and roughness on either surface pass through contacts of five loads, three oils
and slide-to-roll ratios from -1.9 to 4 (module passages), on 256 and on 128 intervals with dT = dX. The figures of /summary,
extremes over the passage, and their estimates (`error_grid`: grid and time step) are compared with the same passage on four times
the intervals and a fourth of the step; with backward Euler too, against the same answers of BDF2. For a wanted accuracy of h_min:
whether it is met, and the wall time, choice included, beside that of the best fixed choice: the fewest 2^k intervals (1 %: 64 to
1024, 0.1 %: to 4096) with dT = dX and the thesis's space scheme from which on all meet it; for 1 % also beside the cheaper one of
the two best fixed choices with either space scheme. The exact answer is that of the thesis's scheme on 2048 intervals, for 0.1 %
that of the kappa scheme on 4096 with dT = dX/2. Writes accuracy_time.csv, cost_time.csv and conclusion_time.txt.
"""

from __future__ import annotations

import csv
import itertools
import math
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import bench_program
import h5py
from bench_program import ENVIRONMENT, ROOT, job, new_parser, output_folder
from passages import Passage, passages

PROGRAM = ROOT / "build" / "bin" / "asperity"
FIGURES = ("h_min", "h_min_node", "h_central", "p_max", "x_cavitation")
INTERVALS, FINER = (256, 128), 4
NO_BARS = {"error_bars": False}
SCHEMES = ("bdf2", "backward_euler")
# Seed and number of passages whose error bars are looked at: those that the estimates were fitted on (seeds 3 to 7 and
# 11 to 14 were looked at too), and others that had no part in any rule.
BARS = {"fitted": ((1, 120), (2, 120)), "fresh": ((21, 120), (22, 120))}
# The same of a wanted accuracy: seed, and passages of which the first ones are run.
SAMPLES = {"fitted": (1, 120), "fresh": (3, 60)}


@dataclass(frozen=True)
class Wanted:
    """A wanted accuracy: how many passages, and what it is compared with."""

    target: float
    passages: int
    largest: int
    schemes: tuple[str, ...]
    exact: dict[str, object]


WANTED = (
    Wanted(1e-2, 40, 1024, ("upwind2", "kappa"), {"intervals": 2048}),
    Wanted(
        1e-3, 20, 4096, ("upwind2",), {"intervals": 4096, "time": {"time_step": 5.5 / 8192}, "solver": {"space_scheme": "kappa"}}
    ),
)


@dataclass
class Row:
    """A figure of a passage, dimensionless; estimate is NaN where there is none."""

    sample: str
    scheme: str
    intervals: int
    passage: str
    figure: str
    value: float
    true_error: float
    estimate: float


@dataclass
class Result:
    """What is read of a result file."""

    converged: bool
    values: dict[str, float]
    estimates: dict[str, float]
    intervals: int
    seconds: float


def read(path: Path) -> Result:
    """A result file."""
    with h5py.File(path) as file:
        summary = file["summary"]
        values = {name: float(summary[name].attrs["dimensionless"]) for name in FIGURES}
        scale = {name: float(summary[name][()]) / values[name] for name in FIGURES}
        estimates = {name: float(summary[name].attrs.get("error_grid", math.nan)) / scale[name] for name in FIGURES}
        intervals = len(file["solution/x"]) - 1
        return Result(file.attrs["converged"] == 1, values, estimates, intervals, float(file["report/wall_seconds"][()]))


def solve(texts: dict[str, str], folder: Path, processes: int) -> dict[str, Result]:
    """Results by name; those without a solution too."""
    for name, text in texts.items():
        (folder / f"{name}.nml").write_text(text, encoding="utf-8")
    command = ["xargs", "-P", str(processes), "-n", "4", str(PROGRAM), "--quiet", "--output", str(folder)]
    names = "\n".join(str(folder / f"{name}.nml") for name in texts)
    subprocess.run(command, input=names, text=True, env=ENVIRONMENT, check=False, stderr=subprocess.DEVNULL)
    found = {name: read(folder / f"{name}.h5") for name in texts}
    for name in texts:
        (folder / f"{name}.h5").unlink()
    return found


def survey(sample: str, cases: list[Passage], folder: Path) -> list[Row]:
    """The figures of all passages beside their finer answers."""
    rows = []
    for start in range(0, len(cases), 16):
        batch = cases[start : start + 16]
        texts = {}
        for case, n in itertools.product(batch, INTERVALS):
            texts[f"{case.name}_{n}_fine"] = case.namelist(FINER * n, 1, accuracy=NO_BARS)
            for scheme in SCHEMES:
                texts[f"{case.name}_{n}_{scheme}"] = case.namelist(n, 1, time={"scheme": scheme})
        found = solve(texts, folder, 2)
        for case, n, scheme in itertools.product(batch, INTERVALS, SCHEMES):
            own, fine = found[f"{case.name}_{n}_{scheme}"], found[f"{case.name}_{n}_fine"]
            if own.converged and fine.converged:
                for name, value in own.values.items():
                    error = abs(value - fine.values[name])
                    rows.append(Row(sample, scheme, n, case.name, name, value, error, own.estimates[name]))
    return rows


@dataclass
class Cost:
    """A wanted accuracy of h_min: what it gave, and the time beside that of the best fixed choice."""

    passage: str
    target: float
    true_error: float
    intervals: int
    steps: int
    seconds: float
    # The best fixed choice with each space scheme; NaN: there is none, or it was not looked for.
    best_intervals: float
    best_seconds: float
    kappa_intervals: float
    kappa_seconds: float

    @property
    def ratio(self) -> float:
        """Time over that of the best fixed choice with the thesis's scheme."""
        return self.seconds / self.best_seconds

    @property
    def ratio_to_either(self) -> float:
        """Time over that of the cheaper one of the best fixed choices with both schemes."""
        return self.seconds / min(self.best_seconds, self.kappa_seconds)


def costs(wanted: Wanted, cases: list[Passage]) -> list[Cost]:
    """A wanted accuracy for each passage, its choice included, beside fixed choices."""
    found = []
    sizes = [2**k for k in range(6, round(math.log2(wanted.largest)) + 1)]
    effort = {"runs": 3, "seconds": 0.2, "limit": 300}
    for case in cases:
        jobs = [job("wanted", case.namelist(None, accuracy={"target": wanted.target}), **effort)]
        for scheme in wanted.schemes:
            settings = {"accuracy": NO_BARS, "solver": {"space_scheme": scheme}}
            jobs += [job(f"{scheme}{n}", case.namelist(n, **settings), **effort) for n in sizes]
        jobs.append(job("exact", case.namelist(accuracy=NO_BARS, **wanted.exact), limit=300))
        answers = bench_program.run(jobs)
        exact = answers["exact"]["h_min"] if answers["exact"].converged else math.nan
        error = {name: abs(each["h_min"] / exact - 1) if each.converged else math.inf for name, each in answers.items()}
        best = {"upwind2": (math.nan, math.nan), "kappa": (math.nan, math.nan)}
        for scheme in wanted.schemes:
            good = [n for n in sizes if all(error[f"{scheme}{m}"] <= wanted.target for m in sizes if m >= n)]
            if good:
                best[scheme] = good[0], least_seconds(answers[f"{scheme}{good[0]}"])
        own = answers["wanted"]
        chosen = int(own["intervals"]), int(own["steps"])
        found.append(Cost(case.name, wanted.target, error["wanted"], *chosen, least_seconds(own), *best["upwind2"], *best["kappa"]))
    return found


def least_seconds(answer: bench_program.Answer) -> float:
    """Time of a run: the least wall time of several, or the mean processor time where that is less."""
    return min(answer["all_least"], answer["processor"])


def bars_text(rows: list[Row], count: int) -> str:
    """How honest the error bars of a sample of `count` passages are, as a table."""
    head = f"  {'figure':<14}{'scheme':<16}{'intervals':>9}{'cases':>7}{'none':>6}{'true below':>12}{'below 10 x':>12}"
    lines = [f"{head}{'median':>8}{'error':>9}"]
    missing = 0
    for n, scheme in itertools.product(INTERVALS, SCHEMES):
        own = [row for row in rows if row.scheme == scheme and row.intervals == n]
        missing += count - len(own) // len(FIGURES)
        for name in FIGURES:
            mine = [row for row in own if row.figure == name]
            known = [row for row in mine if math.isfinite(row.estimate)]
            below = 100 * sum(row.true_error <= row.estimate for row in known) / len(known)
            tight = 100 * sum(row.estimate < 10 * row.true_error for row in known) / len(known)
            ratio = statistics.median(row.estimate / max(row.true_error, 1e-12) for row in known)
            middle = 100 * statistics.median(row.true_error / abs(row.value) for row in known)
            numbers = f"{len(known):7d}{len(mine) - len(known):6d}{below:10.1f} %{tight:10.1f} %{ratio:7.1f}x{middle:7.2g} %"
            lines.append(f"  {name:<14}{scheme:<16}{n:>9}{numbers}")
    missed = f"  {missing} of {count * len(INTERVALS) * len(SCHEMES)} passages did not converge"
    return "\n".join(lines + ([missed] if missing else [])) + "\n"


def cost_text(found: list[Cost]) -> str:
    """What a wanted accuracy gave and cost."""
    judged = [cost for cost in found if math.isfinite(cost.true_error)]
    met = sum(cost.true_error <= cost.target for cost in judged) / len(judged)
    known = [cost for cost in judged if cost.best_seconds > 0]
    ratios = sorted(cost.ratio for cost in known)
    text = (
        f"&accuracy target = {found[0].target:g} on h_min, {len(found)} passages: met in {100 * met:.1f} % (asked 95), cost over"
        f" the best fixed choice: median {statistics.median(ratios):.2f} (asked 2), 90 % {ratios[int(0.9 * len(ratios))]:.2f},"
        f" largest {ratios[-1]:.2f}; all together {sum(c.seconds for c in known) / sum(c.best_seconds for c in known):.2f}"
    )
    if len(judged) < len(found):
        text += f" (without {len(found) - len(judged)} passages whose truth took too long)"
    if len(known) < len(judged):
        text += f" (without {len(judged) - len(known)} passages for which no fixed choice does)"
    either = [cost.ratio_to_either for cost in known if cost.kappa_seconds > 0]
    if either:
        text += f"; over the cheaper one of both space schemes: median {statistics.median(either):.2f}"
    return text + "\n"


def save(items: list[Row] | list[Cost], path: Path) -> None:
    """As CSV."""
    if not items:
        return
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(vars(items[0])))
        writer.writeheader()
        writer.writerows(vars(item) for item in items)


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "fewer passages", "results/accuracy")
    parser.add_argument("--no-cost", action="store_true", help="the error bars only")
    options = parser.parse_args()
    folder = output_folder(options)
    rows, found, text = [], [], ""
    for name, samples in BARS.items():
        cases = [case for seed, count in samples for case in passages(count // 3 if options.quick else count, seed)]
        with tempfile.TemporaryDirectory() as scratch:
            own = survey(name, cases, Path(scratch))
        seeds = " and ".join(str(seed) for seed, _ in samples)
        text += f"Error estimates of {len(cases)} {name} passages (seeds {seeds})\n{bars_text(own, len(cases))}"
        rows += own
    for name, (seed, count) in {} if options.no_cost else SAMPLES.items():
        for wanted in WANTED[:1] if options.quick else WANTED:
            cost = costs(wanted, passages(count // 3 if options.quick else count, seed)[: 12 if options.quick else wanted.passages])
            text += f"{name} (seed {seed}): {cost_text(cost)}"
            found += cost
    save(rows, folder / "accuracy_time.csv")
    save(found, folder / "cost_time.csv")
    (folder / "conclusion_time.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())

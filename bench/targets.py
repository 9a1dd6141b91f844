#!/usr/bin/env python3
"""Measures the cost of a target for h_min of passages, and whether it is met: fitted and fresh samples (samples.py).

The time, choice included, is compared with the best fixed grid: the fewest intervals (1 %: 64 to 1024, 0.1 %: to 4096) with dT = dX
and the thesis's scheme from which on all meet it; for 1 % also with the cheaper of the best fixed grids of both schemes. The exact
answer is that of the thesis's scheme on 2048 intervals, for 0.1 % that of the kappa scheme on 4096 with dT = dX/2. Times are of one
core, the least wall time of several runs, or their mean processor time where other work on the machine made that smaller. Writes
cost_time.csv and .txt. Targets of steady contacts: group `graded` of families.py, and chart.py.
"""

from __future__ import annotations

import itertools
import math
import sys
from dataclasses import dataclass

import bench_program
from bench_program import conclude, job, new_parser, output_folder, save
from judge import quantile, share
from namelists import NO_BARS
from samples import Passage, passages

TARGETS = (1e-2, 1e-3)
# Seed and number of passages of a sample, of which the first ones are run.
PASSAGES = {"Fitted": (1, 120), "Fresh": (3, 60)}
# Passages for each target, the largest fixed grid, the space schemes of the fixed choices, and the exact answer.
IN_TIME = {
    1e-2: (40, 1024, ("upwind2", "kappa"), {"intervals": 2048}),
    1e-3: (20, 4096, ("upwind2",), {"intervals": 4096, "time": {"time_step": 5.5 / 8192}, "solver": {"space_scheme": "kappa"}}),
}


@dataclass
class Cost:
    """A wanted accuracy: what it gave, and the time beside that of the best fixed choice; NaN: none, or none looked for."""

    case: str
    target: float
    error: float
    intervals: int
    seconds: float
    best_intervals: float = math.nan
    best_seconds: float = math.nan
    kappa_intervals: float = math.nan
    kappa_seconds: float = math.nan


def passage_cost(name: str, case: Passage, target: float) -> Cost:
    """A wanted accuracy for a passage, its choice included, beside fixed choices."""
    _, largest, schemes, exact_settings = IN_TIME[target]
    sizes = [2**k for k in range(6, round(math.log2(largest)) + 1)]
    effort = {"runs": 3, "seconds": 0.2, "limit": 300}
    jobs = [job("wanted", case.namelist(None, accuracy={"target": target}), **effort)]
    for scheme, n in itertools.product(schemes, sizes):
        jobs.append(job(f"{scheme}{n}", case.namelist(n, accuracy=NO_BARS, solver={"space_scheme": scheme}), **effort))
    jobs.append(job("exact", case.namelist(accuracy=NO_BARS, **exact_settings), limit=300))
    answers = bench_program.run(jobs)
    exact = answers["exact"]["h_min"] if answers["exact"].converged else math.nan
    error = {key: abs(each["h_min"] / exact - 1) if each.converged else math.inf for key, each in answers.items()}
    cost = Cost(name, target, error["wanted"], int(answers["wanted"]["intervals"]), answers["wanted"].least_seconds)
    for scheme, word in zip(schemes, ("best", "kappa"), strict=False):
        good = [n for n in sizes if all(error[f"{scheme}{m}"] <= target for m in sizes if m >= n)]
        if good:
            setattr(cost, f"{word}_intervals", good[0])
            setattr(cost, f"{word}_seconds", answers[f"{scheme}{good[0]}"].least_seconds)
    return cost


HEAD = (
    f"{'sample, target [%]':22s}{'cases':>6s}{'met [%]':>9s}{'median':>8s}{'90 %':>7s}{'largest':>9s}{'in all':>8s}{'either':>8s}\n"
)


def cost_text(label: str, found: list[Cost]) -> str:
    """What a wanted accuracy of h_min gave (of those with a truth), and its time over that of the best fixed choice, if any.

    `either`: the median over the cheaper one of the best fixed choices with both space schemes.
    """
    judged = [cost for cost in found if math.isfinite(cost.error)]
    known = [cost for cost in judged if cost.best_seconds > 0]
    ratios = [cost.seconds / cost.best_seconds for cost in known]
    both = [cost.seconds / min(cost.best_seconds, cost.kappa_seconds) for cost in known if cost.kappa_seconds > 0]
    met = 100 * share(judged, lambda cost: cost.error <= cost.target)
    in_all = sum(cost.seconds for cost in known) / sum(cost.best_seconds for cost in known)
    numbers = f"{quantile(ratios, 0.5):8.2f}{quantile(ratios, 0.9):7.2f}{max(ratios):9.2f}{in_all:8.2f}"
    either = f"{quantile(both, 0.5):8.2f}" if both else f"{'-':>8s}"
    return f"{f'{label}, {100 * found[0].target:g}':22s}{len(judged):6d}{met:9.1f}{numbers}{either}\n"


def in_time(sample: str, quick: bool) -> list[Cost]:
    """A sample of passages."""
    seed, count = PASSAGES[sample]
    every = list(enumerate(passages(count // 3 if quick else count, seed)))
    targets = {target: 12 if quick else IN_TIME[target][0] for target in (TARGETS[:1] if quick else TARGETS)}
    return [passage_cost(f"{i:03d}_{case.kind}", case, target) for target, most in targets.items() for i, case in every[:most]]


def main() -> int:
    """Command line."""
    options = new_parser(__doc__, "fewer passages", "results/accuracy").parse_args()
    folder, every, words = output_folder(options), [], HEAD
    for sample in ("Fitted", "Fresh"):
        print(sample, file=sys.stderr)
        found = in_time(sample, options.quick)
        words += "".join(
            cost_text(f"{sample} passages", [c for c in found if c.target == t]) for t in dict.fromkeys(c.target for c in found)
        )
        every += found
    save(folder / "cost_time.csv", every)
    conclude(folder / "cost_time.txt", words)
    return 0


if __name__ == "__main__":
    sys.exit(main())

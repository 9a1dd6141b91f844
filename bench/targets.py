#!/usr/bin/env python3
"""Measures the cost of a target for h_min, and whether it is met: fitted and fresh samples (samples.py), steady or --in-time.

The time, choice included, is compared with the best fixed grid: for steady contacts the coarsest even one of 2^k intervals whose
true error meets the target, the truth being that for an eighth of the target; for passages the fewest (1 %: 64 to 1024, 0.1 %: to
4096) with dT = dX and the thesis's scheme from which on all meet it; for 1 % also with the cheaper of the best fixed grids of both
schemes. The exact answer of a passage is that of the thesis's scheme on 2048 intervals, for 0.1 % that of the kappa scheme on 4096
with dT = dX/2. Times are of one core, the least wall time of several runs, or their mean processor time where other work on the
machine made that smaller. Writes cost.csv and .txt, of passages cost_time.csv and .txt.
"""

from __future__ import annotations

import itertools
import math
import sys
from dataclasses import dataclass

import bench_program
from bench_program import conclude, job, new_parser, output_folder, save
from judge import quantile, share
from namelists import NO_BARS, Groups, namelist
from samples import FRESH, Passage, contacts, fresh_contacts, passages

TARGETS = (1e-2, 1e-3)
# A target over that of its steady reference; intervals of the even grids.
FINER, EVEN = 8, tuple(2**k for k in range(5, 15))
BATCH = 16
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


def steady_costs(batch: list[tuple[str, Groups]], effort: dict[str, float]) -> list[Cost]:
    """Wanted accuracies beside even grids; the answer is that for a FINER target."""
    every = {f"{name}:{target:g}": (name, groups, target) for name, groups in batch for target in TARGETS}
    wanted = {key: namelist(groups | {"accuracy": {"target": target}}) for key, (_, groups, target) in every.items()}
    chosen = bench_program.run([job(key, text, **effort) for key, text in wanted.items()])
    every = {key: value for key, value in every.items() if chosen[key].converged}
    jobs = []
    for key, (_, groups, target) in every.items():
        jobs += [job(f"{key}:{size}", namelist(groups | {"domain": {"intervals": size}}), **effort) for size in EVEN]
        jobs.append(job(f"{key}:finer", namelist(groups | {"accuracy": {"target": target / FINER}}), limit=20))
    fixed = bench_program.run(jobs)
    found = []
    for key, (name, _, target) in every.items():
        own = {size.removeprefix(f"{key}:"): a for size, a in fixed.items() if size.startswith(f"{key}:") and a.converged}
        reference, answer = own.pop("finer", None), chosen[key]
        good = [a for a in own.values() if reference and abs(a["h_min"] / reference["h_min"] - 1) <= target]
        if good:
            best = min(good, key=lambda a: a["intervals"])
            error = abs(answer["h_min"] / reference["h_min"] - 1)
            sizes = int(answer["intervals"]), answer.least_seconds, int(best["intervals"]), best.least_seconds
            found.append(Cost(name, target, error, *sizes))
    return found


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


def steady(sample: str, quick: bool) -> list[Cost]:
    """A sample of steady contacts."""
    effort = {"runs": 5 if quick else 10, "seconds": 0.1, "limit": 20}
    every = contacts(quick) if sample == "Fitted" else fresh_contacts(FRESH // 4 if quick else FRESH)
    return [cost for start in range(0, len(every), BATCH) for cost in steady_costs(every[start : start + BATCH], effort)]


def in_time(sample: str, quick: bool) -> list[Cost]:
    """A sample of passages."""
    seed, count = PASSAGES[sample]
    every = list(enumerate(passages(count // 3 if quick else count, seed)))
    targets = {target: 12 if quick else IN_TIME[target][0] for target in (TARGETS[:1] if quick else TARGETS)}
    return [passage_cost(f"{i:03d}_{case.kind}", case, target) for target, most in targets.items() for i, case in every[:most]]


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "fewer contacts", "results/accuracy")
    parser.add_argument("--in-time", action="store_true", help="passages instead of steady contacts")
    options = parser.parse_args()
    folder, ending = output_folder(options), "_time" if options.in_time else ""
    every, words = [], HEAD
    for sample in ("Fitted", "Fresh"):
        print(sample, file=sys.stderr)
        found = (in_time if options.in_time else steady)(sample, options.quick)
        label = f"{sample} {'passages' if options.in_time else 'contacts'}"
        words += "".join(cost_text(label, [c for c in found if c.target == t]) for t in dict.fromkeys(c.target for c in found))
        every += found
    save(folder / f"cost{ending}.csv", every)
    conclude(folder / f"cost{ending}.txt", words)
    return 0


if __name__ == "__main__":
    sys.exit(main())

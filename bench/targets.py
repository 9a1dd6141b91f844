#!/usr/bin/env python3
"""Measures the cost of a target for h_min of passages, and whether it is met: fitted and fresh samples (family_passages.py).

The time, choice included, is compared with the best fixed grid: the fewest intervals (1 %: 64 to 1024, 0.1 %: to 4096) with dT = dX
and the thesis's scheme from which on all meet it; for 1 % also with the cheaper of the best fixed grids of both schemes. The exact
answer is that of the thesis's scheme on 2048 intervals, for 0.1 % that of the kappa scheme on 4096 with dT = dX/2. Times are of one
core, the least of several runs. Writes cost_time.csv and .txt. Targets of steady contacts: group `graded` of families.py, and
chart.py.
"""

from __future__ import annotations

import math

import pandas as pd
from bench_program import Answer, conclude, new_parser, save, side_by_side, solve
from family_passages import Passage, passages
from namelists import BARE, namelist

# Seed and number of passages of a sample, of which the first ones are run.
PASSAGES = {"Fitted": (1, 120), "Fresh": (3, 60)}
# Of each target: passages, the largest fixed grid, the space schemes of the fixed choices, and the exact answer.
TARGETS = {
    1e-2: (40, 1024, ("upwind2", "kappa"), {"intervals": 2048}),
    1e-3: (20, 4096, ("upwind2",), {"intervals": 4096, "time": {"time_step": 5.5 / 8192}, "solver": {"space_scheme": "kappa"}}),
}
EFFORT = {"runs": 3, "seconds": 0.2, "limit": 300}


def least_seconds(answer: Answer) -> float:
    """Wall time of all phases."""
    return answer.times.sum(axis=1).min() if answer.converged else math.nan


def passage_cost(item: tuple[str, str, Passage, float]) -> dict[str, object]:
    """A wanted accuracy: what it gave, and the time beside that of the best fixed choices; NaN: none, or none looked for."""
    sample, name, case, target = item
    _, largest, schemes, exact_settings = TARGETS[target]
    answer = solve(namelist(case.on_grid(**exact_settings, **BARE)), limit=300)
    exact = answer["h_min"] if answer.converged else math.nan

    def error(answer: Answer) -> float:
        return abs(answer["h_min"] / exact - 1) if answer.converged else math.inf

    wanted = solve(namelist(case.on_grid(None, accuracy={"target": target}, output=BARE["output"])), **EFFORT)
    cost = {"sample": sample, "case": name, "target": target, "error": error(wanted), "intervals": wanted.get("intervals", 0)}
    cost["seconds"] = least_seconds(wanted)
    for scheme, word in zip(schemes, ("best", "kappa"), strict=False):
        cost |= {f"{word}_intervals": math.nan, f"{word}_seconds": math.nan}
        for n in (2**k for k in range(round(math.log2(largest)), 5, -1)):
            fixed = solve(namelist(case.on_grid(n, solver={"space_scheme": scheme}, **BARE)), **EFFORT)
            if not error(fixed) <= target:
                break
            cost |= {f"{word}_intervals": n, f"{word}_seconds": least_seconds(fixed)}
    return cost


def cost_text(costs: pd.DataFrame) -> str:
    """What a wanted accuracy of h_min gave (of those with a truth), and its time over that of the best fixed choice, if any.

    `either`: the median over the cheaper one of the best fixed choices with both space schemes.
    """
    names = ("cases", 6), ("met [%]", 9), ("median", 8), ("90 %", 7), ("largest", 9), ("in all", 8), ("either", 8)
    text = f"{'sample, target [%]':22s}{''.join(f'{name:>{width}s}' for name, width in names)}\n"
    for (sample, target), found in costs.groupby(["sample", "target"], sort=False):
        judged = found[found["error"].notna() & (found["error"] < math.inf)]
        known = judged[judged["best_seconds"] > 0]
        ratios = known["seconds"] / known["best_seconds"]
        both = (known["seconds"] / known[["best_seconds", "kappa_seconds"]].min(axis=1))[known["kappa_seconds"] > 0]
        met, in_all = 100 * (judged["error"] <= target).mean(), known["seconds"].sum() / known["best_seconds"].sum()
        median, most = ratios.quantile([0.5, 0.9], interpolation="higher")
        numbers = f"{median:8.2f}{most:7.2f}{ratios.max():9.2f}{in_all:8.2f}"
        either = f"{both.quantile(0.5, interpolation='higher'):8.2f}" if len(both) else f"{'-':>8s}"
        text += f"{f'{sample} passages, {100 * target:g}':22s}{len(judged):6d}{met:9.1f}{numbers}{either}\n"
    return text


def main() -> None:
    """Command line."""
    options = new_parser(__doc__, "fewer passages", "results/accuracy").parse_args()
    items = []
    for sample, (seed, count) in PASSAGES.items():
        every = list(enumerate(passages(count // 3 if options.quick else count, seed)))
        for target in list(TARGETS)[: 1 if options.quick else 2]:
            most = 12 if options.quick else TARGETS[target][0]
            items += [(sample, f"{i:03d}_{case.kind}", case, target) for i, case in every[:most]]
    costs = pd.DataFrame(side_by_side(passage_cost, items, 1))
    save(options.output / "cost_time.csv", costs)
    conclude(options.output / "cost_time.txt", cost_text(costs))


if __name__ == "__main__":
    main()

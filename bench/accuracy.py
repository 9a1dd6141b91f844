#!/usr/bin/env python3
"""Are the error bars honest, and what does a wanted accuracy cost? A survey of steady contacts with known finer answers.

The first sample is the one on which the rules of the estimates were fitted, the second one is drawn afresh (seed SEED), so that it
judges them. For each contact the figures of /summary and their estimates, on the grid that the program chooses, are compared with
the same contact on 8 times the intervals (error of the grid), and with a domain four times as long besides (the whole error). For
each wanted accuracy of h_min: whether it is met as a whole, and the time beside that of the best fixed choice, the coarsest 2^k
intervals on the same domain whose true error meets it. Times are of one core, the least wall time of several runs, or their
mean processor time where other work on the machine made that smaller. Writes accuracy.csv, cost.csv and conclusion.txt.
"""

from __future__ import annotations

import csv
import math
import random
import sys
from dataclasses import dataclass
from pathlib import Path

import bench_program
import namelists
from bench_program import Answer, job, new_parser, output_folder

FIGURES = ("h_min", "h_min_node", "h_central", "p_max", "x_cavitation")
# What the answer of a figure is on the finer grid: nodal figures tend to those between the nodes.
LIMITS = {"h_min_node": "h_min"}
TARGETS = (1e-2, 1e-3)
FINER = 8
LONGER = 4
# Largest distance of the inlet that the program takes [half-widths].
FARTHEST = 1000.0
# Most intervals of a reference.
LARGEST = 2**17
COMPRESSIBLE = {"viscosity_law": "roelands", "density_law": "dowson_higginson"}
BATCH = 16
# Contacts of the fresh sample, and its seed.
FRESH, SEED = 224, 20261121


@dataclass
class Contact:
    """A contact by name; `groups` of its namelist without the domain."""

    name: str
    groups: dict[str, dict[str, object]]

    def text(self, domain: dict[str, object] | None = None, **others: dict[str, object]) -> str:
        """Its namelist on a domain."""
        return namelists.namelist(self.groups | {"domain": domain or {}} | others)


def contacts(quick: bool) -> list[Contact]:
    """Newtonian contacts over the Moes plane with two oils, Eyring contacts in SI, Case 1 and its like, ridges at rest."""
    found = []
    loads = (0.5, 5, 50, 500) if quick else (0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
    for m in loads:
        for l in (0, 10) if quick else (0, 2.5, 5, 10, 15, 20, 30):  # noqa: E741
            moes = {"moes_m": m, "moes_l": l, "velocity": "sum"}
            law = {"viscosity_law": "barus" if l > 0 else "constant", "density_law": "constant"}
            found.append(Contact(f"incompressible_{m}_{l}", {"moes": moes, "lubricant": law}))
            if l > 0:
                found.append(Contact(f"compressible_{m}_{l}", {"moes": moes, "lubricant": COMPRESSIBLE}))
    for m in (5, 50) if quick else (1, 5, 20, 50, 100, 200, 500):
        for l in (10,) if quick else (5, 10, 20, 30):  # noqa: E741
            for slide, stress in ((0.5, 5e6), (1.0, 3.3e6), (2.0, 1.5e6)):
                found.append(Contact(f"eyring_{m}_{l}_{slide}", namelists.steel(m, l, slide, stress)))
    for stress in (1e6, 3.3e6, 1e7):
        for factor in (1,) if quick else (0.5, 1, 2):
            groups = {name: dict(keys) for name, keys in namelists.CASE_1.items()}
            groups["bodies"] |= {"speed_1": 0.1 * factor, "speed_2": 1.1 * factor}
            groups["lubricant"]["eyring_stress"] = stress
            found.append(Contact(f"case1_{stress:g}_{factor}", groups))
    for height in (1e-7, 2e-7):
        for place in (-1.0, 0.0, 0.5):
            groups = {name: dict(keys) for name, keys in namelists.CASE_1.items()}
            groups["bodies"]["speed_1"] = 0.0
            groups["surface_1"] = namelists.RIDGE | {"position": place, "amplitude": height}
            found.append(Contact(f"ridge_{height:g}_{place}", groups))
    return found


def fresh_contacts(count: int, seed: int) -> list[Contact]:
    """Contacts drawn at random from the stated range: what the rules of the estimates were not fitted on."""
    source = random.Random(seed)
    laws = [{"viscosity_law": v, "density_law": d} for v in ("barus", "roelands") for d in ("constant", "dowson_higginson")]
    found = []
    for i in range(count):
        m, l = 10 ** source.uniform(-1, 3), source.uniform(0.5, 30)  # noqa: E741
        kind = ("moes", "moes", "moes", "eyring", "eyring", "case1", "ridge")[i % 7]
        if kind == "moes":
            groups = {"moes": {"moes_m": m, "moes_l": l, "velocity": "sum"}, "lubricant": laws[i // 7 % 4]}
        elif kind == "eyring":
            m, l = 10 ** source.uniform(0, 2.7), source.uniform(3, 30)  # noqa: E741
            groups = namelists.steel(m, l, source.uniform(0.1, 2), 10 ** source.uniform(6, 7.3))
        else:
            groups = {name: dict(keys) for name, keys in namelists.CASE_1.items()}
            speed = 10 ** source.uniform(-0.5, 0.5)
            groups["bodies"] |= {"speed_1": 0.1 * speed, "speed_2": 1.1 * speed}
            groups["load"] = {"load_per_length": 1e5 * 10 ** source.uniform(-1, 0.5)}
            groups["lubricant"]["eyring_stress"] = 10 ** source.uniform(6, 7.3)
            if kind == "ridge":
                groups["bodies"]["speed_1"] = 0.0
                ridge = {"position": source.uniform(-1.2, 0.8), "amplitude": source.uniform(-2e-7, 2e-7)}
                groups["surface_1"] = namelists.RIDGE | ridge | {"wavelength": source.uniform(0.5e-4, 2e-4)}
        found.append(Contact(f"fresh_{i:03d}_{kind}", groups))
    return found


@dataclass
class Row:
    """A figure of a contact: value, estimates and true errors (of the grid alone, and whole)."""

    contact: str
    figure: str
    intervals: int
    value: float
    estimated_grid: float
    true_grid: float
    estimated: float
    true: float


def survey(batch: list[Contact]) -> list[Row]:
    """Figures, estimates and true errors of some contacts on the program's own grid."""
    first = bench_program.run([job(each.name, each.text(), bars=1) for each in batch])
    batch = [each for each in batch if first[each.name].converged]
    jobs = []
    for each in batch:
        answer = first[each.name]
        n, inlet, outlet = int(answer["intervals"]), answer["x_inlet"], answer["x_outlet"]
        domain = {"inlet": answer["inlet"], "x_inlet": inlet, "x_outlet": outlet, "intervals": FINER * n}
        jobs.append(job(each.name + "_finer", each.text(domain), limit=20))
        far = outlet - LONGER * (outlet - inlet)
        if far > -FARTHEST:
            domain |= {"x_inlet": far, "intervals": FINER * LONGER * n}
            jobs.append(job(each.name + "_longer", each.text(domain), limit=20))
    finer = bench_program.run(jobs)
    rows = []
    for each in batch:
        answer, fine = first[each.name], finer[each.name + "_finer"]
        whole = finer.get(each.name + "_longer", Answer({}))
        if not fine.converged:
            continue
        for name in FIGURES:
            limit = LIMITS.get(name, name)
            true = abs(answer[name] - whole[limit]) if whole.converged else math.nan
            grid = abs(answer[name] - fine[limit])
            estimates = answer[name + "_error_grid"], answer[name + "_error"]
            rows.append(Row(each.name, name, int(answer["intervals"]), answer[name], estimates[0], grid, estimates[1], true))
    return rows


@dataclass
class Cost:
    """What a wanted accuracy cost."""

    contact: str
    target: float
    intervals: int
    error: float
    seconds: float
    best_intervals: int
    best_error: float
    best_seconds: float

    @property
    def ratio(self) -> float:
        """Time over that of the best fixed choice."""
        return self.seconds / self.best_seconds


def costs(batch: list[Contact], effort: dict[str, float]) -> list[Cost]:
    """Wanted accuracies beside fixed grids on the same domain; the answer is that on a finer grid and a longer domain."""
    jobs = [job(f"{each.name}:{t:g}", each.text(accuracy={"target": t}), **effort) for each in batch for t in TARGETS]
    chosen = bench_program.run(jobs)
    jobs = []
    for each in batch:
        for target in TARGETS:
            answer = chosen[f"{each.name}:{target:g}"]
            if not answer.converged:
                continue
            n, inlet, outlet = int(answer["intervals"]), answer["x_inlet"], answer["x_outlet"]
            sizes = [2**k for k in range(max(5, int(math.log2(n)) - 3), int(math.log2(n)) + 2)]
            domain = {"inlet": answer["inlet"], "x_inlet": inlet, "x_outlet": outlet}
            jobs += [job(f"{each.name}:{target:g}:{size}", each.text(domain | {"intervals": size}), **effort) for size in sizes]
            domain["x_inlet"] = max(outlet - LONGER * (outlet - inlet), -FARTHEST)
            finest = min(FINER * LONGER * 2 ** math.ceil(math.log2(n)), LARGEST)
            jobs.append(job(f"{each.name}:{target:g}:finer", each.text(domain | {"intervals": finest}), limit=20))
    fixed = bench_program.run(jobs)
    found = []
    for each in batch:
        for target in TARGETS:
            answer, key = chosen[f"{each.name}:{target:g}"], f"{each.name}:{target:g}:"
            reference = fixed.get(key + "finer", Answer({}))
            if not reference.converged:
                continue
            true = reference["h_min"]
            grids = [a for name, a in fixed.items() if name.startswith(key) and not name.endswith("finer") and a.converged]
            good = [a for a in grids if abs(a["h_min"] / true - 1) <= target]
            if good:
                best = min(good, key=lambda a: a["intervals"])
                times = [min(a["all_least"], a["processor"]) for a in (answer, best)]
                errors = [abs(a["h_min"] / true - 1) for a in (answer, best)]
                sizes = int(answer["intervals"]), int(best["intervals"])
                found.append(Cost(each.name, target, sizes[0], errors[0], times[0], sizes[1], errors[1], times[1]))
    return found


def share(flags: list[bool]) -> str:
    """How many, in percent."""
    return f"{100 * sum(flags) / max(len(flags), 1):.1f} %"


def quantile(values: list[float], part: float) -> float:
    """The value below which this part lies."""
    ordered = sorted(values)
    return ordered[min(int(part * len(ordered)), len(ordered) - 1)] if ordered else math.nan


def conclusion(rows: list[Row], found: list[Cost]) -> str:
    """What the numbers say."""
    lines = [f"Error estimates of {len({row.contact for row in rows})} contacts on the program's own grids"]
    lines.append(f"  {'figure':14s} {'part':7s} {'cases':>5s} {'none':>5s} {'true below':>11s} {'below 10 x':>11s} {'median':>7s}")
    for name in FIGURES:
        for part in ("grid", "whole"):
            pairs = [(r.estimated_grid, r.true_grid) if part == "grid" else (r.estimated, r.true) for r in rows if r.figure == name]
            pairs = [pair for pair in pairs if not math.isnan(pair[1])]
            known = [pair for pair in pairs if not math.isnan(pair[0])]
            ratios = [e / t if t > 0 else math.inf for e, t in known]
            below, tight = share([t <= e for e, t in known]), share([e < 10 * t for e, t in known])
            lines.append(
                f"  {name:14s} {part:7s} {len(known):5d} {len(pairs) - len(known):5d} {below:>11s} {tight:>11s} "
                f"{quantile(ratios, 0.5):6.1f}x"
            )
    if found:
        lines.append("Wanted accuracy of h_min: time over that of the best fixed grid")
    for target in TARGETS if found else ():
        each = [cost for cost in found if cost.target == target]
        ratios = [cost.ratio for cost in each]
        finer = [cost.intervals / cost.best_intervals for cost in each]
        lines.append(
            f"  {100 * target:g} %: {len(each)} cases, met in {share([c.error <= target for c in each])}; median "
            f"{quantile(ratios, 0.5):.2f}, 90 % {quantile(ratios, 0.9):.2f}, largest {max(ratios, default=math.nan):.2f}; "
            f"intervals over the best: median {quantile(finer, 0.5):.2f}, 90 % {quantile(finer, 0.9):.2f}"
        )
    return "\n".join(lines) + "\n"


def save(items: list[Row] | list[Cost], path: Path) -> None:
    """As CSV."""
    if not items:
        return
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(items[0].__dict__)
        writer.writerows(item.__dict__.values() for item in items)


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "fewer contacts", "results/accuracy")
    parser.add_argument("--no-cost", action="store_true", help="the error bars only")
    parser.add_argument("--fresh", action="store_true", help="only the contacts that the estimates were not fitted on")
    options = parser.parse_args()
    folder = output_folder(options)
    effort = {"runs": 5 if options.quick else 10, "seconds": 0.1, "limit": 20}
    rows: list[Row] = []
    found: list[Cost] = []
    text = ""
    fresh = fresh_contacts(FRESH // 4 if options.quick else FRESH, SEED)
    for name, sample in {"Fitted": contacts(options.quick), "Fresh": fresh}.items():
        if options.fresh and name != "Fresh":
            continue
        own_rows, own_costs = [], []
        for start in range(0, len(sample), BATCH):
            batch = sample[start : start + BATCH]
            own_rows += survey(batch)
            if not options.no_cost:
                own_costs += costs(batch, effort)
            print(f"\r{name}: {start + len(batch)} of {len(sample)}", end="", file=sys.stderr, flush=True)
        print(file=sys.stderr)
        text += f"{name} contacts. {conclusion(own_rows, own_costs)}"
        rows += own_rows
        found += own_costs
    save(rows, folder / "accuracy.csv")
    save(found, folder / "cost.csv")
    (folder / "conclusion.txt").write_text(text, encoding="utf-8")
    print(text, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())

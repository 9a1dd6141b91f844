#!/usr/bin/env python3
"""Chapter 7 of the thesis and Paper C: four rough profiles pressed on a rigid plane, and many realisations of each.

The measured profiles of the thesis are not published; stand-ins with the parameters of Table 7.1 replace them (Figures 7.1 to
7.4, C.2 and C.4 to C.7). A profile is one draw: each statement is also counted over synthetic realisations.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import h5py
import numpy as np
from chapter7_claims import ALL_LOADS, Four, judge
from chapter7_figures import draw
from dry_profiles import NODES, PROFILES, Sweep, accepted_seeds, read_sweep, realisation, stand_in
from study import Case, Runner, Table, changed, finish, new_parser

PROGRAM = "chapter7.py"
COLUMNS = (
    *("contact_area_fraction", "plastic_area_fraction", "plasticity_index", "mean_separation", "dp_max", "dp_mean"),
    *(f"{parameter}_{state}" for parameter in ("ra", "rq", "rz", "rsk", "rku") for state in ("loaded", "unloaded")),
)


def twice_as_hard(case: Case) -> Case:
    """The case with twice the hardness."""
    return changed(case, bodies={"hardness": 2 * case["bodies"]["hardness"]})


def with_heights(name: str, path: Path) -> Sweep:
    """The sweep, and the bearing ratio and density of the undeformed heights."""
    with h5py.File(path) as file:
        return read_sweep(name, path) | {key: item[()] for key, item in file["surface"].items()}


def four_of(found: dict[str, Sweep], seeds: list[int], i: int) -> Four:
    """A draw: each profile with another seed, since those of one seed are alike."""
    chosen = {name: seeds[(i + shift) % len(seeds)] for shift, name in enumerate(PROFILES)}
    return {name: found[f"{name}_{seed}"] for name, seed in chosen.items()} | {"A_hard": found[f"A_{chosen['A']}_hard"]}


def study(options: argparse.Namespace) -> None:
    """Runs everything, prints and saves tables, statements and figures."""
    runner = Runner(options.output, options.jobs, options.program)
    seeds = accepted_seeds(5 if options.quick else 50, options.program, options.output)
    cases = {name: stand_in(name, ALL_LOADS) for name in PROFILES}
    cases["A_hard"] = twice_as_hard(cases["A"])
    given = runner.run(cases, with_heights)
    fine = runner.run({name: changed(case, domain={"intervals": 4 * NODES}) for name, case in cases.items()}, read_sweep)
    cases = {f"{name}_{seed}": realisation(name, seed, ALL_LOADS) for name in PROFILES for seed in seeds}
    cases |= {f"A_{seed}_hard": twice_as_hard(cases[f"A_{seed}"]) for seed in seeds}
    drawn = runner.run(cases, read_sweep)
    table = Table(profile="profile", load="load [kN/m]", **{column: column.replace("_", " ") for column in COLUMNS})
    for name in PROFILES:
        for i, load in enumerate(ALL_LOADS):
            table.add(profile=name, load=load, **{column: float(given[name][column][i]) for column in COLUMNS})
    table.write(options.output / "chapter7", f"Chapter 7: four profiles, {len(ALL_LOADS)} loads")
    statements = judge(given, fine, [four_of(drawn, seeds, i) for i in range(len(seeds))])
    statements.write(options.output / "statements", "Chapter 7 and Paper C: statements")
    statements.show()
    errors = "; ".join(f"{name} {100 * given[name]['contact_area_fraction_error'][ALL_LOADS.index(100)]:.1f}" for name in PROFILES)
    print(f"\nError bars of the contact area at 100 kN/m, in % of the nominal area: {errors}")
    draw(
        given,
        {(name, key): np.array([drawn[f"{name}_{s}"][key] for s in seeds]) for name in PROFILES for key in COLUMNS},
        options.output,
    )
    print(runner.effort)


if __name__ == "__main__":
    finish(new_parser(PROGRAM, __doc__, "results/chapter7"), study)

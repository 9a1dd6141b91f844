#!/usr/bin/env python3
"""Searches for inputs that give a wrong number with a small error bar: families of random cases, each with its truth.

A family is one kind of input that has failed before: a wave narrower than the grid, an outlet ahead of film rupture, a passage
that starts inside the contact. The table below holds them in groups, which the command line names; a family draws its members
from a seed. Classes, truths and targets: bench/judge.py.

The seed of `make accuracy` was drawn after the rules were fixed; --seed draws another sample, for fitting. Writes families.csv
and families.txt.
"""

from __future__ import annotations

import sys

import family_dry as dry
import family_passages as passages
import family_shipped as shipped
import family_steady as steady
import family_time as in_time
import pandas as pd
from bench_program import conclude, new_parser, save, side_by_side
from judge import Family, Row, judge, judged

# Drawn after the rules stood: nothing was fitted on it.
SEED = 662201
QUICK = 6


def summary(*names: str) -> tuple[str, ...]:
    """Paths of quantities."""
    return tuple(f"summary/{name}" for name in names)


FILMS, P_MAX = summary("h_min", "h_central"), summary("p_max")
FIGURES, CENTRAL = FILMS + P_MAX, summary("p_central")
FRICTION = summary("friction_coefficient", "rolling_friction_coefficient", "rolling_power")
MOST, OTHERS = FIGURES + CENTRAL + FRICTION[:2], FILMS + CENTRAL + FRICTION
AREA, DRY = summary("contact_area_fraction"), summary("contact_area_fraction", "mean_separation", "p_max")
PLASTIC = (*summary("contact_area_fraction", "plastic_area_fraction", "mean_separation"), "sweep/dp_mean")
GRID = "error_grid"
# Where the truth leaves out of the model what the result leaves out.
NUMERICAL = "error_grid+error_domain+error_iteration"
FORCES = summary("asperity_load_share", "friction_coefficient", "friction_coefficient_oil", "friction_coefficient_boundary")
MIXED = FIGURES + FORCES + summary("x_meniscus", "temperature_rise_film")
HISTORY = FIGURES + summary("friction_coefficient", "mean_power", "asperity_load_share")
SAMPLED = summary("h_min", "h_min_node", "h_central", "p_max", "x_cavitation")
ALL = {"is_sample": True}
NODAL = ALL | {"limits": {"summary/h_min_node": "summary/h_min"}}

FAMILIES = [
    *(
        Family("contacts", f"{name}_{part}", f"{name} contacts", SAMPLED, steady.sample(fresh, longer), count, bar, **NODAL)
        for name, fresh, count in (("fitted", False, 255), ("fresh", True, 224))
        for part, longer, bar in (("grid", False, GRID), ("whole", True, "error_estimate"))
    ),
    *(
        Family("passages", f"{name}_{scheme}_{n}", f"{name} passages", SAMPLED, passages.sample(seeds, n, scheme), 240, GRID, **ALL)
        for name, seeds in (("fitted", (1, 2)), ("fresh", (21, 22)))
        for n in (256, 128)
        for scheme in ("bdf2", "backward_euler")
    ),
    Family("graded", "graded", "Smooth contacts of all kinds, chosen domain and grid", MOST, steady.graded, 300),
    Family("graded", "graded_even", "The same beside even grids, kappa scheme", OTHERS, steady.other, 100, is_other=True),
    Family("domain", "outlet", "Given outlets, far ahead of film rupture to far behind it", FILMS, steady.given_outlet, 30),
    Family("domain", "open", "Domain and grid chosen by the program", FILMS + CENTRAL, steady.open_domain, 40),
    Family("domain", "open_light", "The same, light loads and low Eyring stress", FILMS, steady.light_eyring),
    Family("domain", "extreme", "The same where load, oil, sliding and stress are extreme", summary("h_min"), steady.extreme),
    Family("domain", "given_inlet", "Given inlets, mostly Eyring", FILMS, steady.given_inlet, 40),
    Family("dry", "dry_hertz_line", "Hertz, line", DRY, dry.hertz(1), 48),
    Family("dry", "dry_hertz_area", "Hertz, point", DRY, dry.hertz(2)),
    Family("dry", "dry_waves", "Sinusoids", DRY, dry.waves, 48),
    Family("dry", "dry_line", "Rough profiles, periodic, elastic", DRY, dry.rough(1), 96),
    Family("dry", "dry_area", "Rough areas, periodic, elastic", DRY, dry.rough(2), 96),
    Family("dry", "dry_open_line", "Rough rollers, open", DRY, dry.rough_body(1), 96),
    Family("dry", "dry_open_area", "Rough balls, open", DRY, dry.rough_body(2), 96),
    Family("dry", "dry_plastic_line", "Rough profiles that yield", PLASTIC, dry.yielding, 48),
    Family("dry", "dry_plastic_area", "Rough areas that yield", PLASTIC, dry.rough(2, hardness=True), 96),
    Family("dry", "dry_plastic_ball", "A ball that yields", PLASTIC, dry.hertz(2, hardness=True), 48),
    Family("dry", "dry_many_line", "Rough profiles of 140 to 180 thousand nodes", DRY, dry.rough(1, many=True), 40),
    Family("dry", "dry_many_area", "Rough areas of 137 to 315 nodes a side", DRY, dry.rough(2, many=True), 60),
    Family("dry", "dry_many_open_area", "Rough balls, as many", DRY, dry.rough_body(2, many=True), 60),
    Family("dry", "dry_many_plastic_area", "Rough areas that yield, as many", PLASTIC, dry.rough(2, hardness=True, many=True), 144),
    Family("dry", "dry_too_small", "Open domains inside the contact", P_MAX, dry.too_small),
    Family("dry", "dry_boxed", "Parabolas in a box", P_MAX, dry.boxed),
    Family("dry_target", "target_hertz_line", "A target: Hertz, line", AREA, dry.hertz(1), 48, finish=dry.aim),
    Family("dry_target", "target_hertz_area", "A target: Hertz, point", AREA, dry.hertz(2), finish=dry.aim),
    Family("dry_target", "target_ball", "A target: a ball that yields", AREA, dry.hertz(2, hardness=True), finish=dry.aim),
    Family("dry_target", "target_waves", "A target: sinusoids", AREA, dry.waves, finish=dry.aim),
    Family("dry_target", "target_file_line", "A target: profiles of a file, elastic", AREA, dry.rough(1), finish=dry.aim),
    Family("dry_target", "target_plastic_line", "A target: profiles of a file that yield", AREA, dry.yielding, finish=dry.aim),
    Family("dry_target", "target_file_area", "A target: areas of a file", AREA, dry.synthetic_surface(2, in_file=True)),
    Family("dry_target", "target_synthetic_line", "A target: synthetic profiles", AREA, dry.synthetic_surface(1)),
    Family("dry_target", "target_synthetic_area", "A target: synthetic areas", AREA, dry.synthetic_surface(2)),
    Family("dry_target", "target_open_line", "A target: rough rollers", AREA, dry.synthetic_body(1)),
    Family("dry_target", "target_open_area", "A target: rough balls", AREA, dry.synthetic_body(2)),
    Family("friction", "friction_given", "Friction, both oils, given domain and grid", FRICTION, steady.friction_given),
    Family("friction", "friction_time", "Friction over a passage, all chosen", FRICTION, in_time.moving(is_coarse=False), 12),
    Family("kappa", "kappa_spikes", "Spikes by the kappa scheme, given grids", FIGURES, steady.spike, 96, GRID),
    Family("kappa", "wide", "Heavy, fast and sliding contacts, chosen domain and grid", FILMS, steady.wide),
    Family("kappa", "stiff", "Barus' oil at high pressures, chosen domain and grid, targets", FILMS, steady.stiff, 48),
    Family("mixed", "mixed", "Asperities, starved, warm, given grids", MIXED, steady.mixed, 144, NUMERICAL),
    Family("point", "point", "Circles and ellipses, given grids", FIGURES + FRICTION[:1], steady.point, 60, GRID),
    Family("point", "point_passing", "Points, waves pass", FIGURES + FRICTION[:1], in_time.point_passing, 24, GRID, **ALL),
    Family("point", "point_reversing", "Points that reverse", FIGURES + FRICTION[:1], in_time.point_reversing, 24, GRID),
    Family("pressure", "pressure_grids", "Largest pressure, grids of 64 to 4096 intervals", P_MAX, steady.pressure_on_a_grid, 60),
    Family("pressure", "pressure_rolling", "Largest pressure, Eyring oils that hardly slide", P_MAX, steady.rolling, 60),
    Family("pressure", "pressure_in_time", "Largest pressure of passages", P_MAX, passages.pressure_in_time, 40, GRID),
    Family("shipped", "shipped_film", "Lubricated inputs and template", FIGURES, shipped.members("film"), given=True),
    Family("shipped", "shipped_dry", "Dry elastic inputs", DRY, shipped.members("dry"), given=True),
    Family("shipped", "shipped_plastic", "Dry inputs with a hardness", PLASTIC[:3], shipped.members("plastic"), given=True),
    Family("histories", "histories", "Histories, and points of the scenes", HISTORY, shipped.members("history"), given=True),
    Family("target_in_time", "target_in_time", "A target in time: error bars", FIGURES, passages.target_in_time, 24, GRID),
    Family("times", "strides", "Passages of which little is stored", FIGURES, in_time.strides),
    Family("times", "periodic", "Waves that fill the contact at the start", FIGURES, in_time.periodic),
    Family("times", "placed", "Features without a place", FIGURES, in_time.placed, truth_goes_on=True),
    Family("times", "inside", "Features that begin inside the contact", FIGURES, in_time.inside),
    Family("times", "narrow", "Narrow features in heavy contacts", FIGURES + CENTRAL, in_time.narrow),
    Family("times", "beside_waves", "Features that pass beside waves", FIGURES, in_time.beside_waves),
    Family("waves", "waves_at_rest", "Narrow waves at rest, chosen grid", FILMS, in_time.standing(is_coarse=False)),
    Family("waves", "waves_passing", "Narrow waves that pass, chosen grid and time step", FILMS, in_time.moving(is_coarse=False)),
    Family("waves", "waves_coarse_grid", "Narrow waves at rest, 1 to 64 nodes a wave", FILMS, in_time.standing(is_coarse=True)),
    Family("waves", "waves_long_steps", "Narrow waves that pass, 1 to 64 steps a wave", FILMS, in_time.moving(is_coarse=True)),
]  # fmt: skip


def chosen(names: list[str]) -> list[Family]:
    """Those of the named groups, or of all but those of `make accuracy-time` and `make scenes`."""
    known = sorted({family.group for family in FAMILIES})
    if unknown := sorted(set(names) - set(known)):
        sys.exit(f"families.py: no group {unknown[0]}; there are {', '.join(known)}")
    return [family for family in FAMILIES if family.group in (names or {*known} - {"passages", "histories"})]


def table(rows: pd.DataFrame) -> str:
    """A line a family: quantities judged, shares, and behind a star those of its quantities that miss a target."""
    asked = {family.name: family.asked for family in FAMILIES}
    lines = [f"{'family':26s} {'judged':>6s} {'within [%]':>10s} {'below 10 x [%]':>14s}"]
    for family, own in judged(rows).groupby("family", sort=False):
        shares = own.groupby("quantity", sort=False)[["within", "tight"]].mean()
        missed = shares.index[(shares < asked[family]).any(axis=1)].str.removeprefix("summary/")
        within, tight = 100 * own[["within", "tight"]].mean()
        words = f"  * {', '.join(missed)}" if len(missed) else ""
        lines.append(f"{family:26s} {len(own):6d} {within:10.1f} {tight:14.1f}{words}")
    return "\n".join(lines) + "\n"


def main() -> int:
    """Command line; status 1 where a family does not hold."""
    parser = new_parser(__doc__, f"{QUICK} members of each family", "results/accuracy", SEED, 1)
    parser.add_argument("names", nargs="*", metavar="NAME", help="groups of families; default: all")
    parser.add_argument("--members", type=int, default=0, help="members of each family; default: those of the family")
    options = parser.parse_args()
    rows: list[Row] = []
    for family in chosen(options.names):
        members = family.members(options.seed, options.members or (QUICK if options.quick else family.count))
        named = [(member.name or f"{i:03d}", member) for i, member in enumerate(members)]
        print(f"{family.name}, {family.title}", end=": ", file=sys.stderr)
        for own in side_by_side(lambda pair, family=family: judge(family, pair[1], pair[0]), named, options.processes):
            rows += own
        save(options.output / "families.csv", rows)
    text = table(pd.DataFrame(rows))
    conclude(options.output / "families.txt", text)
    return 1 if "  * " in text else 0


if __name__ == "__main__":
    sys.exit(main())

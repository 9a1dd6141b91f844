#!/usr/bin/env python3
"""Chapter 4 of the thesis: harmonics and nodes that the contact area needs.

Four rough profiles cut to their harmonics 1 ... n (4.1) at one load, elastic and elastic-perfectly plastic; synthetic
realisations of them; and a cut profile on finer and finer grids (Fourier resampling), every quantity against the finest. Figures
and statements of the chapter are those of profile D.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import h5py
import numpy as np
from chapter4_claims import KINDS, Cut, judge, needed
from chapter4_figures import FINEST, QUANTITIES, draw_area, draw_depth, draw_grids, draw_parameters, draw_truncation
from dry_profiles import PROFILES, Statements, accepted_seeds, realisation, stand_in, without_hardness
from study import Case, Claims, Runner, Table, changed, finish, new_parser

PROGRAM = "chapter4.py"
PRESSURE = 250e6  # 100 kN per metre of width
LOW_PRESSURE = 62.5e6
HARMONICS = (5, 8, 12, 16, 20, 26, 32, 40, 50, 64, 80, 100, 130, 160, 200, 255)
# For the figures of the chapter.
DENSE = (*range(2, 30, 2), *range(30, 80, 4), 80, 85, 90, 95, 100, 110, 120, 130, 145, 160, 175, 190, 205, 220, 235, 255)
CUT = 64
GRIDS = (256, 512, 1024, 2048, 4096, 8192, 16384)


def one_load(case: Case, kind: str, harmonics: int | None = None, nodes: int | None = None, pressure: float = PRESSURE) -> Case:
    """The case at one load, elastic or plastic, cut and on other nodes as wanted."""
    case = changed(case, load={"mean_pressure": pressure})
    if kind == "elastic":
        case = without_hardness(case)
    if harmonics:
        case = changed(case, surface_1={"harmonics": harmonics})
    if nodes:
        case = changed(case, domain={"intervals": nodes})
    return case


def read_figures(_name: str, path: Path) -> dict[str, float]:
    """Every quantity of the last load, and as NAME_error its error bar."""
    with h5py.File(path) as file:
        found = {name: float(item[()]) for name, item in file["surface"].items() if item.shape == ()}
        for name, item in file["sweep"].items():
            found[name] = float(item[-1])
            if "error_estimate" in item.attrs:
                found[f"{name}_error"] = float(item.attrs["error_estimate"][-1])
        return found


def cut_of(found: dict[str, dict[str, float]], name: str, harmonics: list[int]) -> Cut:
    """The curves over n of the runs NAME_elastic_n and NAME_plastic_n."""
    series = {}
    for kind in KINDS:
        rows = [found[f"{name.format(kind)}_{n}"] for n in harmonics]
        series[kind] = {key: np.array([row[key] for row in rows]) for key in rows[0].keys() & rows[-1].keys()}
    return Cut(harmonics, series)


def study_truncation(runner: Runner, harmonics: list[int], folder: Path) -> tuple[dict, dict[str, dict[str, int]]]:
    """The four profiles with n harmonics; the n needed for each quantity."""
    cases = {f"{name}_{kind}_{n}": one_load(stand_in(name), kind, n) for name in PROFILES for kind in KINDS for n in harmonics}
    found = runner.run(cases, read_figures)
    table = Table(profile="profile", kind="elastic or plastic", harmonics="harmonics kept", **QUANTITIES)
    series: dict[str, dict[str, np.ndarray]] = {}
    for name in PROFILES:
        for kind in KINDS:
            rows = [found[f"{name}_{kind}_{n}"] for n in harmonics]
            series[f"{name}_{kind}"] = {key: np.array([row[key] for row in rows]) for key in rows[0]}
            for n, row in zip(harmonics, rows, strict=True):
                table.add(profile=name, kind=kind, harmonics=n, **{key: row[key] for key in QUANTITIES})
    table.write(folder / "chapter4_truncation", "Chapter 4: cut profiles at 100 kN/m")
    enough: dict[str, dict[str, int]] = {}
    columns = ("contact_area_fraction", "mean_separation", "ra_unloaded", "rms_slope_undeformed", "rq_undeformed")
    summary = Table(profile="profile", kind="elastic or plastic", **{column: f"n for 10 % of {column}" for column in columns})
    for key, values in series.items():
        enough[key] = {column: needed(harmonics, values[column]) for column in columns}
        summary.add(profile=key[0], kind=key[2:], **enough[key])
    summary.write(folder / "chapter4_needed", "Harmonics from which on a quantity stays within 10 %")
    summary.show("Harmonics from which on a quantity stays within 10 % of that with all")
    return series, enough


def study_seeds(runner: Runner, seeds: list[int], harmonics: list[int]) -> tuple[dict[str, np.ndarray], list[Cut]]:
    """Over realisations: the n needed for the area, for the slope, and area times slope with few harmonics over that with all.

    Also the curves of the realisations of D.
    """
    cases = {
        f"{name}_{kind}_{seed}_{n}": one_load(realisation(name, seed), kind, n)
        for name in PROFILES
        for kind in KINDS
        for seed in seeds
        for n in harmonics
    }
    found = runner.run(cases, read_figures)
    result = {}
    for name in PROFILES:
        for kind in KINDS:
            area, slope = (
                np.array([[found[f"{name}_{kind}_{seed}_{n}"][key] for n in harmonics] for seed in seeds])
                for key in ("contact_area_fraction", "rms_slope_undeformed")
            )
            result[f"{name}_{kind}_area"] = np.array([needed(harmonics, row) for row in area])
            result[f"{name}_{kind}_slope"] = np.array([needed(harmonics, row) for row in slope])
            result[f"{name}_{kind}_product"] = (area * slope)[:, harmonics.index(20)] / (area * slope)[:, -1]
            result[f"{name}_{kind}_ratio"] = area[:, harmonics.index(20)] / area[:, -1]
    return result, [cut_of(found, f"D_{{}}_{seed}", harmonics) for seed in seeds]


def study_profile(runner: Runner, harmonics: list[int], folder: Path) -> Cut:
    """Profile D as the chapter has it: Figures 4.1 to 4.6."""
    cases = {f"D_{kind}_{n}": one_load(stand_in("D"), kind, n) for kind in KINDS for n in harmonics}
    whole = f"D_plastic_{harmonics[-1]}"
    cut = cut_of(runner.run(cases, read_figures, frozenset({whole})), "D_{}", harmonics)
    draw_depth(folder / f"{whole}.h5", folder)
    draw_area(cut, folder)
    draw_parameters(cut, folder)
    area = "contact_area_fraction"
    table = Table(kind="elastic or plastic", harmonics="harmonics kept", **{key: key for key in (area, f"{area}_error")})
    for kind in KINDS:
        for i, n in enumerate(harmonics):
            table.add(kind=kind, harmonics=n, **{key: float(cut.series[kind][key][i]) for key in (area, f"{area}_error")})
    table.write(folder / "figure_4_2", "Figure 4.2: contact area of profile D over the harmonics kept")
    return cut


def judge_load(runner: Runner, seeds: list[int], harmonics: list[int], cuts: list[Cut], statements: Statements) -> None:
    """Whether the n from which on the area is constant depends on the load: 25 against 100 kN/m."""
    cases = {
        f"D_{kind}_{seed}_{n}": one_load(realisation("D", seed), kind, n, pressure=LOW_PRESSURE)
        for kind in KINDS
        for seed in seeds
        for n in harmonics
    }
    found = runner.run(cases, read_figures)
    low = [cut_of(found, f"D_{{}}_{seed}", harmonics) for seed in seeds]
    counts = [[tuple(cut.area(kind) for kind in KINDS) for cut in some] for some in (low, cuts)]
    medians = [np.median(values, axis=0) for values in counts]
    statements.judge(
        "4.3",
        "The n from which on the area is constant depends on the load",
        "another n at 25 than at 100 kN/m, elastic or plastic",
        "medians of the draws: " + "; ".join(f"{m[0]:.0f} elastic, {m[1]:.0f} plastic" for m in medians),
        {},
        [a != b for a, b in zip(*counts, strict=True)],
    )


def study_grids(runner: Runner, grids: list[int], folder: Path) -> dict[str, dict[str, np.ndarray]]:
    """Profile A cut to CUT harmonics on finer and finer grids: differences to the finest."""
    cases = {f"{kind}_{n}": one_load(stand_in("A"), kind, CUT, n) for kind in KINDS for n in [*grids, FINEST]}
    found = runner.run(cases, read_figures)
    table = Table(kind="elastic or plastic", nodes="nodes", **QUANTITIES)
    shown = Table(
        kind="elastic or plastic",
        quantity="quantity",
        order="observed order",
        **{f"n{n}": f"difference with {n} nodes" for n in grids},
    )
    errors: dict[str, dict[str, np.ndarray]] = {}
    for kind in KINDS:
        for n in [*grids, FINEST]:
            table.add(kind=kind, nodes=n, **{key: found[f"{kind}_{n}"][key] for key in QUANTITIES})
        errors[kind] = {}
        for key, label in QUANTITIES.items():
            best = found[f"{kind}_{FINEST}"][key]
            values = np.array([abs(found[f"{kind}_{n}"][key] - best) for n in grids]) / (abs(best) or 1.0)
            errors[kind][key] = values
            some = values > 0
            order = -np.polyfit(np.log(np.array(grids)[some]), np.log(values[some]), 1)[0] if some.sum() > 1 else None
            shown.add(kind=kind, quantity=label, order=order, **{f"n{n}": float(e) for n, e in zip(grids, values, strict=True)})
    table.write(folder / "chapter4_grids", f"Profile A, harmonics 1 to {CUT}, at 100 kN/m: every quantity over the nodes")
    shown.show(f"Relative difference to {FINEST} nodes", kind="", quantity="", order=".2f", **{f"n{n}": ".1e" for n in grids})
    return errors


def findings(enough: dict, drawn: dict, errors: dict, grids: list[int], seeds: int, short: bool) -> Claims:
    """What the chapter asks, for all four profiles; with a short list of harmonics and few draws what fails proves nothing."""
    claims = Claims()
    fails = "not judged: the short form has too few harmonics and draws" if short else False

    def list_of(kind: str, column: str) -> str:
        return ", ".join(f"{name} {enough[f'{name}_{kind}'][column]}" for name in PROFILES)

    claims.check(
        "few harmonics suffice for the heights, not for the elastic contact",
        all(enough[f"{name}_elastic"]["rq_undeformed"] < enough[f"{name}_elastic"]["contact_area_fraction"] for name in PROFILES)
        or fails,
        f"n for 10 % of Rq: {list_of('elastic', 'rq_undeformed')}; of the elastic area: "
        f"{list_of('elastic', 'contact_area_fraction')}; of the plastic area: {list_of('plastic', 'contact_area_fraction')}",
    )
    for kind in KINDS:
        quantiles = {k: np.quantile(drawn[f"{k}_{kind}_area"], (0.1, 0.5, 0.9)) for k in PROFILES}
        claims.check(
            f"harmonics needed for 10 % of the {kind} area, over {seeds} realisations",
            "measured",
            "; ".join(f"{k} {q[1]:.0f} ({q[0]:.0f} to {q[2]:.0f})" for k, q in quantiles.items()),
        )
    ratios = {k: (np.median(drawn[f"{k}_elastic_ratio"]), np.median(drawn[f"{k}_elastic_product"])) for k in PROFILES}
    close = [abs(product - 1) < 0.1 for _, product in ratios.values()]
    claims.check(
        "the elastic area goes with 1/(rms slope): what a measurement misses of the slope it adds to the area",
        all(close) or ("partly" if any(close) else fails),
        "20 harmonics, area and area times slope over those of all: "
        + "; ".join(f"{k} {ratio:.2f} and {product:.2f}" for k, (ratio, product) in ratios.items()),
    )
    at, errors = list(grids).index(512), errors["plastic"]
    area = errors["contact_area_fraction"][at]
    claims.check(
        "512 nodes give the contact of 64 harmonics to two nodes",
        bool(area * 0.066 * 512 < 2),
        f"profile A: area off by {100 * area:.1f} % ({area * 0.066 * 512:.1f} nodes), mean separation by "
        f"{100 * errors['mean_separation'][at]:.2f} %, dissipated energy by {100 * errors['dissipated_energy'][at]:.1f} %",
    )
    return claims


def study(options: argparse.Namespace) -> None:
    """Runs everything, prints and saves tables, statements and figures."""
    runner = Runner(options.output, options.jobs, options.program)
    harmonics = [n for n in HARMONICS if n in (8, 20, 50, 130, 255)] if options.quick else list(HARMONICS)
    grids = [n for n in GRIDS if n <= 1024] if options.quick else list(GRIDS)
    seeds = accepted_seeds(2 if options.quick else 20, options.program, options.output)
    series, enough = study_truncation(runner, harmonics, options.output)
    drawn, cuts = study_seeds(runner, seeds, harmonics)
    errors = study_grids(runner, grids, options.output)
    claims = findings(enough, drawn, errors, grids, len(seeds), options.quick)
    claims.show()
    claims.table.write(options.output / "findings", "Chapter 4: findings")
    given = study_profile(runner, harmonics if options.quick else list(DENSE), options.output)
    statements = judge(given, cuts, options.quick)
    judge_load(runner, seeds, harmonics, cuts, statements)
    statements.write(options.output / "statements", "Chapter 4: statements")
    statements.show()
    draw_truncation(series, harmonics, options.output)
    draw_grids(errors, grids, options.output)
    print(runner.effort)


if __name__ == "__main__":
    finish(new_parser(PROGRAM, __doc__, "results/chapter4"), study)

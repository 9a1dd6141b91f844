#!/usr/bin/env python3
"""Chapter 4 of the thesis: which harmonics must a measurement resolve to trust the contact area, and how fine must the grid be?

Four rough profiles cut to their harmonics 1 ... n (4.1) at one load, elastic and elastic-perfectly plastic; the same over synthetic
realisations; and a cut profile on ever finer grids (Fourier resampling), every quantity against the finest.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import h5py
import numpy as np
from chapter7 import PROFILES, accepted_seeds, realisation, stand_in
from study import Case, Claims, Runner, Table, changed, finish, new_parser, save, style

PROGRAM = "chapter4.py"
PRESSURE = 250e6  # 100 kN per metre of width
HARMONICS = (5, 8, 12, 16, 20, 26, 32, 40, 50, 64, 80, 100, 130, 160, 200, 255)
KINDS = ("elastic", "plastic")
CUT = 64
GRIDS = (256, 512, 1024, 2048, 4096, 8192, 16384)
FINEST = 65536
ACCURACY = 0.1
QUANTITIES = {
    "contact_area_fraction": "contact area",
    "plastic_area_fraction": "plastic area",
    "mean_separation": "mean separation",
    "p_max": "largest pressure",
    "dp_mean": "mean plastic deformation",
    "elastic_energy": "stored energy",
    "dissipated_energy": "dissipated energy",
    "ra_loaded": "Ra loaded",
    "ra_unloaded": "Ra unloaded",
    "rsk_loaded": "Rsk loaded",
    "rku_loaded": "Rku loaded",
    "rms_slope_undeformed": "rms slope undeformed",
    "rms_curvature_undeformed": "rms curvature undeformed",
}


def one_load(case: Case, kind: str, harmonics: int | None = None, nodes: int | None = None) -> Case:
    """The case at one load, elastic or plastic, cut and on other nodes as wanted."""
    case = changed(case, load={"mean_pressure": PRESSURE})
    if kind == "elastic":
        bodies = {key: value for key, value in case["bodies"].items() if key != "hardness"}
        case = changed(changed(case, bodies=None), bodies=bodies)
    if harmonics:
        case = changed(case, surface_1={"harmonics": harmonics})
    if nodes:
        case = changed(case, domain={"intervals": nodes})
    return case


def read_figures(_name: str, path: Path) -> dict[str, float]:
    """Every quantity of the last load."""
    with h5py.File(path) as file:
        found = {name: float(item[-1]) for name, item in file["sweep"].items()}
        return found | {name: float(item[()]) for name, item in file["surface"].items() if item.shape == ()}


def needed(harmonics: list[int], values: np.ndarray, accuracy: float) -> int:
    """The first harmonic from which on all values stay within `accuracy` of the last."""
    inside = np.abs(values / values[-1] - 1) <= accuracy
    return harmonics[len(inside) - int(np.argmin(inside[::-1])) if not inside.all() else 0]


def draw_truncation(tables: dict[str, dict[str, np.ndarray]], harmonics: list[int], folder: Path) -> None:
    """Area, elastic and plastic, slope and Ra over the number of harmonics."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 120, nrows=2, ncols=2, sharex=True)
    panels = {
        "elastic": ("contact_area_fraction", "Contact area, elastic, over that of all"),
        "plastic": ("contact_area_fraction", "Contact area, plastic, over that of all"),
        "slope": ("rms_slope_undeformed", "Rms slope over that of all"),
        "height": ("rq_undeformed", "$Rq$ over that of all"),
    }
    for panel, (kind, (column, label)) in zip(axes.flat, panels.items(), strict=True):
        for name, series in zip(PROFILES, style.SERIES, strict=False):
            values = tables[f"{name}_{kind if kind in KINDS else 'elastic'}"][column]
            draw = panel.loglog if kind in KINDS else panel.semilogx
            draw(harmonics, values / values[-1], label=name, **series)
        panel.axhspan(1 - ACCURACY, 1 + ACCURACY, color="0.9", linewidth=0)
        panel.set(ylabel=label)
    for panel in axes[1]:
        panel.set_xlabel("Harmonics kept $n$ [-]")
    axes[0, 0].legend(ncols=2)
    save(figure, folder, "chapter4_truncation")


def draw_grids(errors: dict[str, dict[str, np.ndarray]], grids: list[int], folder: Path) -> None:
    """Error of each quantity over the number of nodes: contact, then heights."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 95, ncols=2, sharey=True)
    panels = (
        ("contact_area_fraction", "plastic_area_fraction", "mean_separation", "stored_energy", "dissipated_energy", "elastic_peak"),
        ("ra_loaded", "ra_unloaded", "rsk_loaded", "rku_loaded", "rms_slope_undeformed", "rms_curvature_undeformed"),
    )
    curves = errors["plastic"] | {
        "stored_energy": errors["plastic"]["elastic_energy"],
        "elastic_peak": errors["elastic"]["p_max"],
    }
    labels = QUANTITIES | {"stored_energy": "stored energy", "elastic_peak": "largest elastic pressure"}
    for panel, names in zip(axes, panels, strict=True):
        for name, series in zip(names, style.SERIES, strict=True):
            values = curves[name]
            panel.loglog(grids, np.where(values > 0, values, np.nan), label=labels[name], **series)
        guide = np.array([grids[0], grids[-1]], dtype=float)
        panel.loglog(guide, 0.3 * guide[0] / guide, label="order 1", **style.REFERENCE)
        panel.set(xlabel="Nodes $N$ [-]")
        panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.18), fontsize=7.5, ncols=2)
    axes[0].set_ylabel(f"Difference to {FINEST} nodes [-]")
    save(figure, folder, "chapter4_grids")


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
        enough[key] = {column: needed(harmonics, values[column], ACCURACY) for column in columns}
        summary.add(profile=key[0], kind=key[2:], **enough[key])
    summary.write(folder / "chapter4_needed", "Harmonics from which on a quantity stays within 10 %")
    summary.show("Harmonics from which on a quantity stays within 10 % of that with all")
    return series, enough


def study_seeds(runner: Runner, seeds: list[int], harmonics: list[int]) -> dict[str, np.ndarray]:
    """Over realisations: the n needed for the area, for the slope, and area times slope with few harmonics over that with all."""
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
            result[f"{name}_{kind}_area"] = np.array([needed(harmonics, row, ACCURACY) for row in area])
            result[f"{name}_{kind}_slope"] = np.array([needed(harmonics, row, ACCURACY) for row in slope])
            result[f"{name}_{kind}_product"] = (area * slope)[:, harmonics.index(20)] / (area * slope)[:, -1]
            result[f"{name}_{kind}_ratio"] = area[:, harmonics.index(20)] / area[:, -1]
    return result


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


def judge(enough: dict, drawn: dict, errors: dict, grids: list[int], seeds: int) -> Claims:
    """What the chapter asks."""
    claims = Claims()

    def list_of(kind: str, column: str) -> str:
        return ", ".join(f"{name} {enough[f'{name}_{kind}'][column]}" for name in PROFILES)

    claims.check(
        "few harmonics suffice for the heights, not for the elastic contact",
        all(enough[f"{name}_elastic"]["rq_undeformed"] < enough[f"{name}_elastic"]["contact_area_fraction"] for name in PROFILES),
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
        all(close) or ("partly" if any(close) else False),
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
    drawn = study_seeds(runner, seeds, [n for n in harmonics if n <= 64] + [255])
    errors = study_grids(runner, grids, options.output)
    claims = judge(enough, drawn, errors, grids, len(seeds))
    claims.show()
    claims.table.write(options.output / "statements", "Chapter 4: statements")
    draw_truncation(series, harmonics, options.output)
    draw_grids(errors, grids, options.output)
    print(runner.effort)


if __name__ == "__main__":
    finish(new_parser(PROGRAM, __doc__, "results/chapter4"), study)

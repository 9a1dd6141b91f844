#!/usr/bin/env python3
"""Chapter 3 of the thesis: effect of a hardness on the contact of the four profiles and of a rough area, against a rigid and an
elastic counterbody, under rising and falling load.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import h5py
import numpy as np
import similarity
from dry_profiles import LOADS, PROFILES, pressures, stand_in, without_hardness
from study import Case, Claims, Runner, Table, base_case, changed, finish, new_parser, save, style

PROGRAM = "chapter3.py"
NO_BARS = {"error_bars": False}
COUNTERS = {"rigid": {}, "steel": {"youngs_modulus_2": 210e9, "poisson_ratio_2": 0.3}}
COLUMNS = ("contact_area_fraction", "plastic_area_fraction", "mean_separation", "p_max", "elastic_energy", "dissipated_energy")


def cycle_of(case: Case, steps: int) -> Case:
    """Up to the largest load of the case, down again, each step on what the one before left, and up once more."""
    largest = max(np.atleast_1d(case["load"]["mean_pressure"]))
    up = np.linspace(0, 1, steps + 1)[1:]
    loads = np.concatenate([up, up[-2::-1], up]) * largest
    return changed(case, load={"mean_pressure": [float(load) for load in loads], "loading": "history"})


def read_sweep(_name: str, path: Path) -> dict[str, np.ndarray]:
    """The sweep of a result, and the fields of a profile."""
    with h5py.File(path) as file:
        found = {name: item[()] for name, item in file["sweep"].items()}
        return found | {name: item[()] for name, item in file["solution"].items() if item.ndim == 1}


def draw_profile(found: dict[str, dict[str, np.ndarray]], folder: Path) -> None:
    """Pressure and heights of profile A around its largest elastic pressure, elastic and plastic."""
    elastic = found["A_elastic_rigid"]
    left = max(0.0, 1e6 * elastic["x"][elastic["pressure"].argmax()] - 60)
    figure, axes = style.new_figure(style.TWO_COLUMNS, 100, nrows=2, ncols=2, sharex=True, sharey="row")
    for column, kind in zip(axes.T, ("elastic", "plastic"), strict=True):
        result = found[f"A_{kind}_rigid"]
        x = 1e6 * result["x"]
        column[0].plot(x, 1e-9 * result["pressure"], **style.PRESSURE)
        column[0].set_title("elastic" if kind == "elastic" else "elastic-perfectly plastic, hardness 4 GPa")
        lines = []
        for state, series in zip(("undeformed", "loaded", "unloaded"), style.SERIES, strict=False):
            look = {key: series[key] for key in ("color", "linestyle")}
            lines += column[1].plot(x, 1e6 * result[f"height_{state}"], label=state, **look)
        column[1].set(xlabel="Position $x$ [µm]", xlim=(left, left + 120))
    axes[0, 0].set_ylabel("Pressure [GPa]")
    axes[1, 0].set_ylabel("Height [µm]")
    axes[0, 0].set_ylim(bottom=0)
    style.legend_below(figure, lines, 3)
    save(figure, folder, "chapter3_profile")


def draw_loads(found: dict[str, dict[str, np.ndarray]], folder: Path) -> None:
    """Contact area and separation over the load, elastic and plastic."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 70, ncols=2)
    for name, series in zip(PROFILES, style.SERIES, strict=False):
        for kind in ("elastic", "plastic"):
            result = found[f"{name}_{kind}_rigid"]
            look = {**series, "linestyle": "-" if kind == "plastic" else (0, (1, 1.2))}
            label = name if kind == "plastic" else None
            axes[0].plot(LOADS, 100 * result["contact_area_fraction"], label=label, **look)
            axes[1].plot(LOADS, result["mean_separation"] / result["rq_undeformed"], **look)
    axes[0].set(xlabel="Load [kN/m]", ylabel="Contact area [%]", ylim=(0, None))
    axes[1].set(xlabel="Load [kN/m]", ylabel="Mean separation over $Rq$ [-]")
    axes[0].legend(title="lines: plastic, dots: elastic", ncols=2)
    save(figure, folder, "chapter3_loads")


def draw_cycle(found: dict[str, dict[str, np.ndarray]], steps: int, folder: Path) -> None:
    """Load over separation, and contact area over load: first loading, unloading, reloading."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 70, ncols=2)
    result = found["cycle_area"]
    parts = {
        "first loading": slice(0, steps),
        "unloading": slice(steps - 1, 2 * steps - 1),
        "reloading": slice(2 * steps - 1, None),
    }
    for (label, part), series in zip(parts.items(), style.SERIES, strict=False):
        look = series | {"markevery": max(1, steps // 10)}
        axes[0].plot(1e6 * result["separation"][part], 1e-6 * result["mean_pressure"][part], label=label, **look)
        axes[1].plot(1e-6 * result["mean_pressure"][part], 100 * result["contact_area_fraction"][part], **look)
    axes[0].set(xlabel="Separation [µm]", ylabel="Mean pressure [MPa]", ylim=(0, None))
    axes[1].set(xlabel="Mean pressure [MPa]", ylabel="Contact area [%]", xlim=(0, None), ylim=(0, None))
    axes[0].legend()
    save(figure, folder, "chapter3_cycle")


def judge(found: dict, cycles: dict, steps: int) -> Claims:
    """What the model of chapter 3 says."""
    claims = Claims()
    ratio = {
        k: found[f"{k}_plastic_rigid"]["contact_area_fraction"] / found[f"{k}_elastic_rigid"]["contact_area_fraction"]
        for k in PROFILES
    }
    claims.check(
        "plastic flow enlarges the contact",
        all((values >= 1).all() for values in ratio.values()),
        "plastic over elastic area at 5 and 100 kN/m: " + "; ".join(f"{k} {v[0]:.2f}, {v[-1]:.2f}" for k, v in ratio.items()),
    )
    peak = {k: found[f"{k}_elastic_rigid"]["p_max"][[0, -1]] * 1e-9 for k in PROFILES}
    claims.check(
        "elastic pressures exceed the hardness of 4 GPa at the largest load",
        all(values[-1] > 4.0 for values in peak.values()),
        "largest elastic pressure in GPa at 5 and 100 kN/m: " + "; ".join(f"{k} {v[0]:.0f}, {v[1]:.0f}" for k, v in peak.items()),
    )
    lowered = {
        k: 1 - found[f"{k}_plastic_rigid"]["mean_separation"][-1] / found[f"{k}_elastic_rigid"]["mean_separation"][-1]
        for k in PROFILES
    }
    claims.check(
        "plastic flow brings the surfaces closer",
        all(value > 0 for value in lowered.values()),
        "mean separation at 100 kN/m lower by " + "; ".join(f"{k} {100 * v:.1f} %" for k, v in lowered.items()),
    )
    change = {
        kind: {
            k: found[f"{k}_{kind}_steel"]["contact_area_fraction"][-1] / found[f"{k}_{kind}_rigid"]["contact_area_fraction"][-1]
            for k in PROFILES
        }
        for kind in ("elastic", "plastic")
    }
    claims.check(
        "an elastic counterbody changes the elastic area more than the plastic one",
        all(change["plastic"][k] < change["elastic"][k] for k in PROFILES),
        "area against steel over that against a rigid plane, elastic and plastic, at 100 kN/m: "
        + "; ".join(f"{k} {change['elastic'][k]:.2f}, {change['plastic'][k]:.2f}" for k in PROFILES),
    )
    share = {
        name: values["dissipated_energy"][steps - 1]
        / (values["dissipated_energy"][steps - 1] + values["elastic_energy"][steps - 1])
        for name, values in cycles.items()
    }
    claims.check(
        "part of the work is lost in the first loading",
        all(0 < value < 1 for value in share.values()),
        "dissipated over all work: " + "; ".join(f"{name.removeprefix('cycle_')} {100 * v:.0f} %" for name, v in share.items()),
    )
    new = max(np.abs(values["dp_mean"][steps - 1 :] / values["dp_mean"][steps - 1] - 1).max() for values in cycles.values())
    back = max(
        abs(values[key][-1] / values[key][steps - 1] - 1)
        for values in cycles.values()
        for key in ("datum", "contact_area_fraction")
    )
    claims.check(
        "running-in: below the earlier maximum nothing yields, back at it all is as it was",
        bool(new < 1e-6 and back < 1e-6),
        f"plastic deformation changes by at most {new:.0e}, datum and area by {back:.0e} (relative)",
    )
    area = cycles["cycle_area"]
    half = steps // 2 - 1
    claims.check(
        "after running-in the contact is larger at the same load",
        bool(area["contact_area_fraction"][2 * steps - 1 + half] > area["contact_area_fraction"][half]),
        f"rough area at half of the largest load: {100 * area['contact_area_fraction'][half]:.1f} % at first, "
        f"{100 * area['contact_area_fraction'][2 * steps - 1 + half]:.1f} % when loaded again",
    )
    return claims


def study(options: argparse.Namespace) -> None:
    """Runs everything, prints and saves tables, statements and figures."""
    runner = Runner(options.output, options.jobs, options.program)
    steps = 10 if options.quick else 40
    cases = {}
    for name in PROFILES:
        for counter, bodies in COUNTERS.items():
            plastic = changed(stand_in(name), bodies=bodies, accuracy=NO_BARS)
            cases[f"{name}_plastic_{counter}"] = plastic
            cases[f"{name}_elastic_{counter}"] = without_hardness(plastic)
    found = runner.run(cases, read_sweep)
    area = changed(base_case("dry_area"), load={"mean_pressure": 400e6}, accuracy=NO_BARS)
    if options.quick:
        area = changed(area, domain={"intervals_x": 64, "intervals_y": 64}, surface_1={"wavelength_short": 2.5e-5})
    cycles = runner.run(
        {f"cycle_{name}": cycle_of(changed(stand_in(name), accuracy=NO_BARS), steps) for name in PROFILES}
        | {"cycle_area": cycle_of(area, steps)},
        read_sweep,
    )
    table = Table(
        profile="profile", kind="elastic or plastic", counter="counterbody", load="load [kN/m]", **{c: c for c in COLUMNS}
    )
    for key, values in found.items():
        name, kind, counter = key.split("_")
        for i, load in enumerate(LOADS):
            table.add(profile=name, kind=kind, counter=counter, load=load, **{c: float(values[c][i]) for c in COLUMNS})
    table.write(options.output / "chapter3", "Chapter 3: elastic against elastic-perfectly plastic")
    claims = judge(found, cycles, steps)
    similarity.study(runner, 2 if options.quick else 4, claims)
    claims.show()
    claims.table.write(options.output / "statements", "Chapter 3: statements")
    draw_profile(found, options.output)
    draw_loads(found, options.output)
    draw_cycle(cycles, steps, options.output)
    print(f"loads of {pressures()[0] * 1e-6:.1f} to {pressures()[-1] * 1e-6:.1f} MPa; {runner.effort}")


if __name__ == "__main__":
    finish(new_parser(PROGRAM, __doc__, "results/chapter3"), study)

#!/usr/bin/env python3
"""Chapter 7 of the thesis: four rough profiles pressed on a rigid plane, and the same over many realisations of each.

The measured profiles of the thesis are not published; stand-ins with the parameters of Table 7.1 take their place (Figures 7.1 to
7.4). One profile is one draw: each statement is therefore counted over synthetic realisations with the same parameters too.
"""

from __future__ import annotations

import argparse
import subprocess
from pathlib import Path

import f90nml
import h5py
import numpy as np
from study import ROOT, Case, Claims, Runner, StudyError, Table, base_case, changed, finish, new_parser, save, style

PROGRAM = "chapter7.py"
LOADS = (5, 10, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 100)  # kN per metre of width
LENGTH = 4e-4
NODES = 512
# Table 7.1: Rq [m], Rsk, Rku.
PROFILES = {"A": (1.2e-6, -1.0, 4.4), "B": (0.38e-6, -0.25, 3.2), "C": (0.18e-6, -0.02, 3.5), "D": (0.45e-6, -0.07, 3.1)}
COLUMNS = ("contact_area_fraction", "plastic_area_fraction", "plasticity_index", "mean_separation", "ra_loaded", "ra_unloaded")


def pressures() -> list[float]:
    """Mean pressures [Pa] of the loads."""
    return [1e3 * load / LENGTH for load in LOADS]


def stand_in(name: str) -> Case:
    """A stand-in profile under all loads."""
    data = str(ROOT / "test" / "data" / "profiles_ABCD.csv")
    return changed(
        base_case("dry_profile"),
        load={"mean_pressure": pressures()},
        surface_1={"file": data, "dataset": f"z{name}_m"},
    )


def realisation(name: str, seed: int) -> Case:
    """A synthetic profile with the parameters of `name`: roll-off at harmonic 14, cut-off at 65, as the stand-ins."""
    rms, skewness, kurtosis = PROFILES[name]
    case = changed(base_case("dry_profile"), load={"mean_pressure": pressures()}, surface_1=None)
    surface = {
        "shape": "synthetic",
        "seed": seed,
        "hurst": 0.8,
        "rms_height": rms,
        "skewness": skewness,
        "kurtosis": kurtosis,
        "wavelength_rolloff": LENGTH / 14,
        "wavelength_short": LENGTH / 65,
    }
    return changed(case, surface_1=surface, domain={"length": LENGTH, "intervals": NODES})


def accepted_seeds(count: int, program: Path, folder: Path) -> list[int]:
    """The first seeds whose four surfaces can all be given the wanted skewness and kurtosis."""
    folder.mkdir(parents=True, exist_ok=True)
    namelist = folder / "seed.nml"
    seeds, seed = [], 0
    while len(seeds) < count and seed < 4 * count:
        seed += 1
        for name in PROFILES:
            f90nml.Namelist(realisation(name, seed)).write(namelist, force=True)
            done = subprocess.run([str(program), "--check", str(namelist)], capture_output=True, check=False)
            if done.returncode != 0:
                break
        else:
            seeds.append(seed)
    namelist.unlink()
    if len(seeds) < count:
        raise StudyError(f"only {len(seeds)} of {seed} seeds give surfaces with the wanted parameters")
    return seeds


def read_sweep(_name: str, path: Path) -> dict[str, np.ndarray]:
    """The sweep of a result."""
    with h5py.File(path) as file:
        return {column: file[f"sweep/{column}"][:] for column in COLUMNS}


def linearity(area: np.ndarray) -> float:
    """R^2 of a straight line through the areas over the loads."""
    load = np.array(LOADS, dtype=float)
    fit = np.polyval(np.polyfit(load, area, 1), load)
    return float(1 - ((area - fit) ** 2).sum() / ((area - area.mean()) ** 2).sum())


def draw(found: dict[str, dict[str, np.ndarray]], spread: dict[str, np.ndarray], folder: Path) -> None:
    """Areas, plasticity, separation and roughness over the load; bands: 10 to 90 % of the realisations."""
    figure, axes = style.new_figure(style.TWO_COLUMNS, 120, nrows=2, ncols=2)
    panels = {
        "contact_area_fraction": "Contact over nominal area [-]",
        "plasticity_index": "Plastic over contact area [-]",
        "mean_separation": "Mean separation [µm]",
        "ra_unloaded": "$Ra$ after load over before [-]",
    }
    for panel, (column, label) in zip(axes.flat, panels.items(), strict=True):
        for name, series in zip(PROFILES, style.SERIES, strict=False):
            values = found[name][column] * (1e6 if column == "mean_separation" else 1.0)
            if column == "ra_unloaded":
                values = values / found[name]["ra_undeformed"]
            panel.plot(LOADS, values, label=name, **series)
            if column in ("contact_area_fraction", "plasticity_index"):
                low, high = np.quantile(spread[name, column], (0.1, 0.9), axis=0)
                panel.fill_between(LOADS, low, high, color=series["color"], alpha=0.15, linewidth=0)
        panel.set(xlabel="Load [kN/m]", ylabel=label)
    axes[0, 0].legend(ncols=2)
    save(figure, folder, "chapter7_loads")


def judge(found: dict, spread: dict, seeds: int) -> Claims:
    """What the text says, for the stand-ins and counted over the realisations."""
    claims = Claims()
    last = {key: values[:, -1] for key, values in spread.items()}
    fits = [linearity(area) for name in PROFILES for area in spread[name, "contact_area_fraction"]]
    own = [linearity(found[name]["contact_area_fraction"]) for name in PROFILES]
    claims.check(
        "the contact area grows linearly with the load",
        min(own) > 0.97,
        f"R^2 {min(own):.3f} to {max(own):.3f}; realisations: median {np.median(fits):.3f}, least {min(fits):.3f}",
    )
    area, index = "contact_area_fraction", "plasticity_index"
    rest = np.max([last[name, area] for name in "ABD"], axis=0)
    count = int((last["C", area] > rest).sum())
    claims.check(
        "the smoothest profile, C, has the largest contact area",
        all(found["C"][area][-1] > found[name][area][-1] for name in "ABD"),
        f"at 100 kN/m: {', '.join(f'{n} {found[n][area][-1]:.4f}' for n in PROFILES)}; in {count} of {seeds} realisations",
    )
    rest = np.max([last[name, index] for name in "BCD"], axis=0)
    count = int((last["A", index] >= rest).sum())
    ranking = int(
        (
            (last["A", index] > last["D", index]) & (last["D", index] > last["B", index]) & (last["B", index] > last["C", index])
        ).sum()
    )
    claims.check(
        "the roughest profile, A, has the largest plastic share",
        all(found["A"][index][-1] >= found[name][index][-1] for name in "BCD"),
        f"at 100 kN/m: {', '.join(f'{n} {found[n][index][-1]:.3f}' for n in PROFILES)}; in {count} of {seeds} realisations; "
        f"A > D > B > C in {ranking}",
    )
    return claims


def study(options: argparse.Namespace) -> None:
    """Runs everything, prints and saves tables, statements and the figure."""
    runner = Runner(options.output, options.jobs, options.program)
    seeds = accepted_seeds(5 if options.quick else 50, options.program, options.output)
    found = runner.run({name: stand_in(name) for name in PROFILES}, read_with_roughness, frozenset(PROFILES))
    cases = {f"{name}_{seed}": realisation(name, seed) for name in PROFILES for seed in seeds}
    drawn = runner.run(cases, read_sweep)
    spread = {
        (name, column): np.array([drawn[f"{name}_{seed}"][column] for seed in seeds]) for name in PROFILES for column in COLUMNS
    }
    table = Table(profile="profile", load="load [kN/m]", **{column: column.replace("_", " ") for column in COLUMNS})
    for name in PROFILES:
        for i, load in enumerate(LOADS):
            table.add(profile=name, load=load, **{column: float(found[name][column][i]) for column in COLUMNS})
    table.write(options.output / "chapter7", "Chapter 7: four profiles, 13 loads")
    claims = judge(found, spread, len(seeds))
    claims.show()
    draw(found, spread, options.output)
    print(runner.effort)


def read_with_roughness(name: str, path: Path) -> dict[str, np.ndarray]:
    """The sweep and Ra before the load."""
    with h5py.File(path) as file:
        return read_sweep(name, path) | {"ra_undeformed": file["sweep/ra_undeformed"][:]}


if __name__ == "__main__":
    finish(new_parser(PROGRAM, __doc__, "results/chapter7"), study)

"""Common parts of chapters 3, 4 and 7: the four profiles, their realisations, loads, and the judgement of statements over draws."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar

import f90nml
import h5py
import numpy as np
from study import ROOT, Case, StudyError, Table, base_case, changed

LOADS = (5, 10, 15, 20, 25, 30, 40, 50, 60, 70, 80, 90, 100)  # kN per metre of width
LENGTH = 4e-4
NODES = 512
# Rq [m] of Table C.1; Rsk, Rku of Table 7.1.
PROFILES = {"A": (1.2e-6, -1.0, 4.4), "B": (0.38e-6, -0.25, 3.2), "C": (0.18e-6, -0.02, 3.5), "D": (0.45e-6, -0.07, 3.1)}
NEARLY_ALL, HARDLY_ANY = 0.9, 0.1  # share of the draws
Sweep = dict[str, np.ndarray]
# What statements are about: what was computed of one profile, or of all four.
Subject = TypeVar("Subject")


def pressures(loads: Sequence[float] = LOADS) -> list[float]:
    """Mean pressures [Pa] of the loads."""
    return [1e3 * load / LENGTH for load in loads]


def stand_in(name: str, loads: Sequence[float] = LOADS) -> Case:
    """A stand-in profile under all loads."""
    data = str(ROOT / "input" / "profiles_ABCD.csv")
    return changed(
        base_case("dry_profile"),
        load={"mean_pressure": pressures(loads)},
        surface_1={"file": data, "positions": "x_m", "dataset": f"z{name}_m"},
    )


def realisation(name: str, seed: int, loads: Sequence[float] = LOADS) -> Case:
    """A synthetic profile with the parameters of `name`: roll-off at harmonic 14, cut-off at 65, as the stand-ins."""
    rms, skewness, kurtosis = PROFILES[name]
    case = changed(base_case("dry_profile"), load={"mean_pressure": pressures(loads)}, surface_1=None)
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


def without_hardness(case: Case) -> Case:
    """The elastic case."""
    bodies = {key: value for key, value in case["bodies"].items() if key != "hardness"}
    return changed(changed(case, bodies=None), bodies=bodies)


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


def read_sweep(_name: str, path: Path) -> Sweep:
    """Every quantity over the loads, and as NAME_error its error bar."""
    with h5py.File(path) as file:
        sweep = file["sweep"]
        errors = {f"{name}_error": item.attrs["error_estimate"] for name, item in sweep.items() if "error_estimate" in item.attrs}
        return {name: item[()] for name, item in sweep.items()} | errors


def straightness(x: np.ndarray, y: np.ndarray) -> float:
    """R^2 of a straight line through y over x."""
    rest = y - np.polyval(np.polyfit(x, y, 1), x)
    return float(1 - (rest**2).sum() / ((y - y.mean()) ** 2).sum())


def verdict(draws: Sequence[bool]) -> str:
    """What a statement about the measured profiles is worth: agrees or disagrees if nearly all draws say the same."""
    share = float(np.mean(draws))
    if share >= NEARLY_ALL:
        return "agrees"
    return "disagrees" if share <= HARDLY_ANY else "not decidable with stand-ins"


@dataclass(frozen=True)
class Statement(Generic[Subject]):
    """A statement, where it stands, how it is read, whether profiles fulfil it, and the numbers behind the answer."""

    where: str
    text: str
    reading: str
    holds: Callable[[Subject], bool]
    numbers: Callable[[Subject], str]


class Statements(Table):
    """Statements of the text about the measured profiles, each with the draws in which it holds."""

    def __init__(self, numbers: str, short: bool = False) -> None:
        """`numbers` says what is shown of the stand-ins; in a short form what fails is not judged."""
        self.short = short
        super().__init__(
            where="section",
            claim="what the text says",
            reading="how it is read",
            numbers=numbers,
            stand_ins="holds for the stand-ins",
            fine="holds for them on four times the nodes",
            draws="draws in which it holds",
            of="draws",
            verdict="agrees, disagrees or not decidable with stand-ins",
        )

    def judge(self, where: str, claim: str, reading: str, numbers: str, given: dict[str, bool], draws: Sequence[bool]) -> None:
        """One statement; `given`: whether it holds for the stand-ins (stand_ins, fine)."""
        held = {key: "yes" if value else "no" for key, value in given.items()}
        found = verdict(draws)
        self.add(
            where=where,
            claim=claim,
            reading=reading,
            numbers=numbers,
            **held,
            draws=sum(map(bool, draws)),
            of=len(draws),
            verdict="not judged: short form" if self.short and found == "disagrees" else found,
        )

    def judge_all(self, items: list[Statement[Subject]], given: dict[str, Subject], draws: list[Subject]) -> None:
        """Statements for the stand-ins (`given`, stand_ins and fine) and for others like them."""
        for item in items:
            held = {key: item.holds(subject) for key, subject in given.items()}
            numbers = item.numbers(given["stand_ins"])
            self.judge(item.where, item.text, item.reading, numbers, held, [item.holds(draw) for draw in draws])

    def show(self) -> None:
        """Prints all statements."""
        print("\nStatements of the text")
        for row in self.rows:
            print(f"  [{row['verdict']}] {row['where']}: {row['claim']}\n      read as: {row['reading']}\n      {row['numbers']}")
            held = [f"{label} {row[key]}" for key, label in (("stand_ins", "stand-ins"), ("fine", "on finer grid")) if key in row]
            print("      " + "; ".join([*held, f"in {row['draws']} of {row['of']} draws"]))

"""Judges verdicts: what the program reports of each ingredient of a model, against fine-grid runs with and without it.

    honest        the true change is within the error bar (a difference below judge.FLOOR always is)
    right         the verdict is that of the true changes (needed: one above the accuracy; irrelevant: all below a tenth of it);
                  of a grid: it is reported too coarse if it is
    surely wrong  `needed` where it is not, or less than that where it is needed
    not known     no change, or no verdict

Targets: 95 % honest, 95 % right.
"""

from __future__ import annotations

import argparse
import copy
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import h5py
import numpy as np
import pandas as pd
from bench_program import conclude, run_program, save, side_by_side
from judge import FLOOR
from namelists import BARE, Groups, namelist

WITHIN = 0.95
NO_TRUTH = "no truth"
NUMERICAL = ("grid", "time_step", "domain", "iteration", "validity")


@dataclass
class Row:
    """One quantity of one ingredient of a scene: change, error bar, true change; the verdicts are those of the ingredient."""

    scene: str
    ingredient: str
    quantity: str
    change: float
    error: float
    truth: float
    verdict: str
    true_verdict: str
    accuracy: float
    measured_on: str = ""
    left_out: float = 1.0


def run(groups: Groups, read: Callable[[h5py.File], object], files: dict[str, bytes] | None = None) -> object:
    """What is read of the result of a namelist with these files beside it; None where it does not converge."""
    done = run_program(namelist(groups), read, files)
    return done.found if done.status == 0 else None


def bare(groups: Groups, **others: dict) -> Groups:
    """A copy that asks for nothing but numbers, with other groups."""
    return copy.deepcopy(groups) | copy.deepcopy(BARE) | others


def told(file: h5py.File, quantities: Iterable[str]) -> dict[str, dict]:
    """What the program says of each ingredient: changes with their error bars, and the words of the row."""
    rows = {}
    for name, row in file["adequacy"].items():
        words = {key: row.attrs[key].decode() for key in ("verdict", "instead", "measured_on") if key in row.attrs}
        changes = {q: (float(row[q][()]), float(row[q].attrs["error_estimate"])) for q in quantities if q in row}
        rows[name] = {"changes": changes, "left_out": float(row.attrs.get("left_out", 1.0))} | words
        rows[name]["judged_by"] = [q for q in quantities if q in row or f"{q}_at_least" in row.attrs]
    return rows


def verdict_of(changes: Iterable[float], accuracy: float) -> str:
    """By the true changes, as far as they are known."""
    known = [abs(change) for change in changes if not math.isnan(change)]
    if any(change > accuracy for change in known):
        return "needed"
    return "irrelevant" if all(change < 0.1 * accuracy for change in known) else "matters below the accuracy"


def change_of(found: dict[str, float], full: dict[str, float], quantities: Iterable[str]) -> dict[str, float]:
    """Relative changes; NaN where there is none."""
    return {q: found[q] / full[q] - 1 if q in found and full.get(q, 0.0) != 0 else math.nan for q in quantities}


def rows_of(name: str, ingredient: str, row: dict, true: dict[str, float], right: str, accuracy: float) -> list[Row]:
    """The rows of an ingredient with these true changes."""
    words = row["verdict"], right, accuracy, row.get("measured_on", ""), row.get("left_out", 1.0)
    return [Row(name, ingredient, q, *row["changes"].get(q, (math.nan, math.nan)), true[q], *words) for q in true]


def line(label: str, own: pd.DataFrame) -> tuple[str, list[float]]:
    """What holds of these rows, and the shares; changes of the smooth steady contact are no statement on a passage."""
    scenes = own.drop_duplicates(["scene", "ingredient"])
    known = scenes[scenes["verdict"] != "not known"]
    whole = known[(known["left_out"] == 1) | (known["verdict"] == "needed")]
    told, true = whole["verdict"], whole["true_verdict"]
    is_right = np.where(whole["ingredient"] == "grid", (true != "needed") | (told == "too coarse"), told == true)
    wrong = (~is_right & ((told == "needed") | (true == "needed"))).sum()
    judged = own[own["change"].notna() & own["truth"].notna() & ~own["measured_on"].str.contains("smooth")]
    is_honest = (judged["change"] - judged["truth"]).abs() <= judged["error"].clip(lower=FLOOR)
    shares = [each.mean() if len(each) else math.nan for each in (is_honest, is_right)]
    words = " ".join(f"{'-':>10s}" if math.isnan(each) else f"{100 * each:10.1f}" for each in shares)
    return f"{label:26s} {len(scenes):6d} {len(scenes) - len(known):9d} {words} {wrong:13d}", shares


def table(rows: pd.DataFrame, kinds: Iterable[str]) -> tuple[str, bool]:
    """A line an ingredient by kinds of scenes, and all of a kind without time steps; whether all kinds hold what is asked for."""
    lines = [f"{'ingredient':26s} {'scenes':>6s} {'not known':>9s} {'honest [%]':>10s} {'right [%]':>10s} {'surely wrong':>13s}"]
    holds = True
    for kind in kinds:
        mine = rows[rows["scene"].str.startswith(kind)]
        others = mine[mine["ingredient"] != "time_step"]
        parts = dict(iter(others.groupby("ingredient"))) | {"all": others}
        for label, own in (parts | {"time_step": mine[mine["ingredient"] == "time_step"]}).items():
            if len(own):
                words, shares = line(f"{kind} {label}", own)
                lines.append(words)
                holds = holds and (label != "all" or all(each >= WITHIN for each in shares if not math.isnan(each)))
    return "\n".join(lines) + "\n", holds


def judge_all(options: argparse.Namespace, judge: Callable[[tuple[str, Groups]], list[Row]], scenes: list) -> int:
    """Judges all scenes, writes adequacy.csv and adequacy.txt; status 1 where less is honest or right than asked for."""
    rows, unjudged = [], 0
    for own in side_by_side(judge, scenes, options.processes):
        rows += [row for row in own if row.true_verdict != NO_TRUTH]
        unjudged += not own
        save(options.output / "adequacy.csv", rows)
    text, holds = table(pd.DataFrame(rows), dict.fromkeys(name.split()[0] for name, _ in scenes))
    conclude(options.output / "adequacy.txt", f"{text}{unjudged} of {len(scenes)} scenes have no result or no truth\n")
    return 0 if holds else 1

"""Judges verdicts: what the program reports of each ingredient of a model, against fine-grid runs with and without it.

    honest        the true change is within the error bar (a true change below `floor` always is)
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
from bench_program import conclude, output_folder, run_program, save, side_by_side
from judge import share
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
    status, _, found = run_program(namelist(groups), read, files)
    return found if status == 0 else None


def bare(groups: Groups, **others: dict) -> Groups:
    """A copy that asks for nothing but numbers, with other groups."""
    return copy.deepcopy(groups) | copy.deepcopy(BARE) | others


def changes_in(row: h5py.Group, quantities: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Those of a row of /adequacy that are known, with their error bars."""
    return {q: (float(row[q][()]), float(row[q].attrs["error_estimate"])) for q in quantities if q in row}


def told(file: h5py.File, quantities: Iterable[str]) -> dict[str, dict]:
    """What the program says of each ingredient: changes, and the words of the row."""
    rows = {}
    for name, row in file["adequacy"].items():
        words = {key: row.attrs[key].decode() for key in ("verdict", "instead", "measured_on") if key in row.attrs}
        rows[name] = {"changes": changes_in(row, quantities), "left_out": float(row.attrs.get("left_out", 1.0))} | words
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


def is_right(row: Row) -> bool:
    """Whether a known verdict is that of the true changes."""
    if row.ingredient == "grid":
        return row.true_verdict != "needed" or row.verdict == "too coarse"
    return row.verdict == row.true_verdict


def line(label: str, own: list[Row], floor: float) -> tuple[str, list[float]]:
    """What holds of these rows, and the shares; changes of the smooth steady contact are no statement on a passage."""
    scenes = {(row.scene, row.ingredient): row for row in own}
    known = [row for row in scenes.values() if row.verdict != "not known"]
    whole = [row for row in known if row.left_out == 1 or row.verdict == "needed"]
    wrong = sum(not is_right(row) and "needed" in (row.verdict, row.true_verdict) for row in whole)
    judged = [row for row in own if not (math.isnan(row.change) or math.isnan(row.truth)) and "smooth" not in row.measured_on]
    shares = [
        share(judged, lambda row: abs(row.change - row.truth) <= max(row.error, floor)) if judged else math.nan,
        share(whole, is_right) if whole else math.nan,
    ]
    words = " ".join(f"{'-':>10s}" if math.isnan(each) else f"{100 * each:10.1f}" for each in shares)
    return f"{label:26s} {len(scenes):6d} {len(scenes) - len(known):9d} {words} {wrong:13d}", shares


def table(
    rows: list[Row], kinds: tuple[str, ...], *, judged: tuple[str, ...] = (), apart: tuple[str, ...] = (), floor: float = 0.0
) -> tuple[str, bool]:
    """A line an ingredient, by kinds of scenes, and all of a kind without those that stand apart.

    And whether what is asked for holds of all kinds, or of those that are judged.
    """
    lines = [f"{'ingredient':26s} {'scenes':>6s} {'not known':>9s} {'honest [%]':>10s} {'right [%]':>10s} {'surely wrong':>13s}"]
    holds = True
    for kind in kinds:
        mine = [row for row in rows if kind in row.scene]
        names = sorted({row.ingredient for row in mine} - set(apart))
        for label, counted in (*((name, [name]) for name in names), ("all", names), *((name, [name]) for name in apart)):
            own = [row for row in mine if row.ingredient in counted]
            if own:
                words, shares = line(f"{kind} {label}", own, floor)
                lines.append(words)
                if label == "all" and kind in (judged or kinds):
                    holds = holds and all(each >= WITHIN for each in shares if not math.isnan(each))
    return "\n".join(lines) + "\n", holds


def judge_all(
    options: argparse.Namespace, name: str, judge: Callable, scenes: list, kinds: tuple[str, ...], **words: object
) -> int:
    """Judges all scenes, writes NAME.csv and NAME.txt; status 1 where less is honest or right than asked for."""
    folder, rows, unjudged = output_folder(options), [], 0
    for own in side_by_side(judge, scenes, options.processes):
        rows += [row for row in own if row.true_verdict != NO_TRUTH]
        unjudged += not own
        save(folder / f"{name}.csv", rows)
    text, holds = table(rows, kinds, **words)
    conclude(folder / f"{name}.txt", f"{text}{unjudged} of {len(scenes)} scenes have no result or no truth\n")
    return 0 if holds else 1

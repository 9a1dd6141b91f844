#!/usr/bin/env python3
"""Maps where each method converges, converges late or does not; iterations as colour; one frame for all methods.

A cell is converged (at most 30 iterations on the finest grid, in time: per step), late (more), not converged (ended by the limit
of iterations or of 40 s of processor time, stalled, or failed), or has a grid that is too coarse for a discrete film or steps
that are too long for a feature, and is called so, which is the right answer. One rule for all methods. Results for each map:
stability_NAME.png, .pdf, .csv; conclusion.txt counts cells and lists those where `auto` does not converge, whose namelists go to
not_converged/.
"""

from __future__ import annotations

import csv
import sys
import time
from collections import Counter
from pathlib import Path

import bench_program
import stability_cells
from bench_program import Answer, job, new_parser, output_folder
from stability_cells import Cell, StabilityMap
from stability_figure import draw_map

LIMIT = 40.0
MANY = 30


def status(answer: Answer | None) -> str:
    """The class of a cell."""
    if answer is None:
        return "blank"
    if answer.converged:
        return "converged" if iterations(answer) <= MANY else "late"
    words = {
        "grid too coarse": "too coarse",
        "of its wavelength, expected at most": "too coarse",  # what a feature moves in a time step
        "refused": "refused",
        "stopped from outside": "limit",
        "stagnation": "stalled",
        "cycle limit": "limit",
        "has stopped falling": "stalled",  # of dry contacts
        "the error is ": "limit",
    }
    return next((name for text, name in words.items() if text in answer["reason"]), "failed")


def iterations(answer: Answer) -> float:
    """Iterations on the finest grid, in time per step."""
    return answer["cycles"] / max(answer["steps"], 1)


def solve_map(each: StabilityMap, processes: int) -> dict[tuple[str, int, int], Answer]:
    """Answers of all cells of a map by method, column and row."""
    jobs = {}
    for cell in each.cells():
        name = f"{len(jobs)}"
        jobs[name] = (cell, job(name, cell.namelist, limit=LIMIT))
    answers = bench_program.run_parallel([one for _, one in jobs.values()], processes, patience=20 * LIMIT)
    return {(cell.method, cell.column, cell.row): answers[name] for name, (cell, _) in jobs.items()}


def save(each: StabilityMap, answers: dict[tuple[str, int, int], Answer], path: Path) -> None:
    """All cells of a map as CSV."""
    columns = ("intervals", "cycles", "steps", "residual", "load_error", "tolerance", "all_least", "h_min", "h_central", "p_max")
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("method", each.x.key, each.y.key, "status", "way", *columns, "reason"))
        for (method, column, row), answer in answers.items():
            values = (answer.get(name, "") for name in columns)
            place = (method, each.x.values[column], each.y.values[row])
            writer.writerow((*place, status(answer), answer["method"], *values, answer["reason"].strip()))


def report(each: StabilityMap, answers: dict[tuple[str, int, int], Answer], cells: list[Cell], folder: Path) -> list[str]:
    """Counts by method, and the cells where `auto` is not right."""
    lines = [f"{each.title}: {each.x.label} x {each.y.label}"]
    for method in each.methods:
        counts = Counter(status(answer) for (name, _, _), answer in answers.items() if name == method)
        total = sum(counts.values())
        solved = sum(answer.converged for (name, _, _), answer in answers.items() if name == method)
        right = solved + counts["too coarse"]
        words = ", ".join(f"{count} {word}" for word, count in counts.most_common())
        lines.append(f"  {method}: {right} of {total} right ({words})")
    for cell in cells:
        answer = answers[cell.method, cell.column, cell.row]
        if not cell.method.startswith("auto") or status(answer) in {"converged", "too coarse"}:
            continue
        place = f"{each.x.key} = {each.x.values[cell.column]}, {each.y.key} = {each.y.values[cell.row]}"
        method = "".join(sign if sign.isalnum() else "_" for sign in cell.method)
        target = folder / f"{each.key}_{method}_{cell.column}_{cell.row}.nml"
        folder.mkdir(exist_ok=True)
        target.write_text(cell.namelist, encoding="utf-8")
        lines.append(f"    {cell.method}: {place}: {status(answer)}: {answer['reason'].strip()} [{target.name}]")
    return lines


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "fewer cells and coarser grids, under 3 minutes", "results/stability")
    parser.add_argument("--only", nargs="+", metavar="MAP", help=f"only these maps: {', '.join(stability_cells.NAMES)}")
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="processes side by side (default: 2)")
    options = parser.parse_args()
    unknown = set(options.only or []) - set(stability_cells.NAMES)
    if unknown:
        parser.error(f"no map is named {', '.join(sorted(unknown))}")
    folder = output_folder(options)
    lines = []
    for each in stability_cells.all_maps(options.quick):
        if options.only and each.key not in options.only:
            continue
        start = time.perf_counter()
        answers = solve_map(each, options.processes)
        save(each, answers, folder / f"stability_{each.key}.csv")
        classes = {place: (status(answer), iterations(answer) if answer.converged else 0) for place, answer in answers.items()}
        for place, answer in answers.items():
            if place[0].startswith("FAS") and answer.converged and answer["levels"] == 1:
                classes[place] = ("no cycle", 1)
        draw_map(each, classes, folder)
        part = report(each, answers, list(each.cells()), folder / "not_converged")
        print("\n".join(part), f"\n  {time.perf_counter() - start:.0f} s", flush=True)
        lines += part
    (folder / "conclusion.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())

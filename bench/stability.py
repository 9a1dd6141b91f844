#!/usr/bin/env python3
"""Maps where each method converges, converges late or fails, with iterations as colour.

A cell converged (at most 30 iterations on the finest grid, in time: per step), converged late (more), did not converge (limit of
iterations, 40 s of processor time, stalled, failed), or was rightly reported as a grid too coarse for a discrete film or steps
too long for a feature. Each map gives stability_NAME.png, .pdf, .csv; SHOWN are in stability.png. conclusion.txt counts cells and
lists those where `auto` does not converge; their namelists go to not_converged/. --dry draws the maps of dry contacts in one
figure.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

import bench_program
import stability_dry
from bench_program import Answer, conclude, job, new_parser, output_folder, write_csv
from stability_cells import AUTO, CYCLES, NAMES, Place, StabilityMap, all_maps, iterations, status
from stability_figure import draw_maps

LIMIT = 40.0
# Of the common figure.
SHOWN = ("moes_eyring", "coarsest", "roughness")
COLUMNS = ("intervals", "cycles", "steps", "residual", "load_error", "tolerance", "all_least", "h_min", "h_central", "p_max")


def solve_map(each: StabilityMap, processes: int) -> dict[Place, Answer]:
    """Answers of all cells of a map."""
    names = {place: f"{i}" for i, place in enumerate(each.cells)}
    jobs = [job(names[place], text, limit=LIMIT) for place, text in each.cells.items()]
    answers = bench_program.run_parallel(jobs, processes, patience=20 * LIMIT)
    return {place: answers[name] for place, name in names.items()}


def save(each: StabilityMap, answers: dict[Place, Answer], path: Path) -> None:
    """All cells of a map as CSV."""
    rows = []
    for (method, column, row), answer in answers.items():
        values = (answer.get(name, "") for name in COLUMNS)
        place = (method, each.x.values[column], each.y.values[row])
        rows.append((*place, status(answer), answer["method"], *values, answer["reason"].strip()))
    write_csv(path, ("method", each.x.key, each.y.key, "status", "way", *COLUMNS, "reason"), rows)


def report(each: StabilityMap, answers: dict[Place, Answer], folder: Path) -> list[str]:
    """Counts by method, and the cells where `auto` is not right, whose namelists go to the folder."""
    lines = [f"{each.title}: {each.x.label} x {each.y.label}"]
    for method in each.methods:
        own = [answer for (name, _, _), answer in answers.items() if name == method]
        counts = Counter(map(status, own))
        right = sum(answer.converged for answer in own) + counts["too coarse"]
        words = ", ".join(f"{count} {word}" for word, count in counts.most_common())
        lines.append(f"  {method}: {right} of {len(own)} right ({words})")
    for (method, column, row), answer in answers.items():
        if method.startswith("auto") and status(answer) not in {"converged", "too coarse"}:
            folder.mkdir(exist_ok=True)
            word = "".join(sign if sign.isalnum() else "_" for sign in method)
            target = folder / f"{each.key}_{word}_{column}_{row}.nml"
            target.write_text(each.cells[method, column, row], encoding="utf-8")
            place = f"{each.x.key} = {each.x.values[column]}, {each.y.key} = {each.y.values[row]}"
            lines.append(f"    {method}: {place}: {status(answer)}: {answer['reason'].strip()} [{target.name}]")
    return lines


def main() -> int:
    """Command line."""
    parser = new_parser(__doc__, "fewer cells and coarser grids, under 3 minutes", "results/stability", processes=2)
    parser.add_argument("--only", nargs="+", metavar="MAP", choices=NAMES, help=f"only these maps: {', '.join(NAMES)}")
    parser.add_argument("--dry", action="store_true", help="dry contacts")
    options = parser.parse_args()
    folder = output_folder(options)
    if options.dry:
        print(stability_dry.run_maps(folder, options.quick, options.processes), end="")
        return 0
    lines, shown = [], []
    for each in all_maps(options.quick):
        if options.only and each.key not in options.only:
            continue
        answers = solve_map(each, options.processes)
        save(each, answers, folder / f"stability_{each.key}.csv")
        classes = {place: (status(answer), iterations(answer)) for place, answer in answers.items()}
        for place, answer in answers.items():
            if place[0].startswith("FAS") and answer.converged and answer["levels"] == 1:
                classes[place] = ("no cycle", 1)
        draw_maps([each], [classes], 4, each.title, folder / f"stability_{each.key}")
        lines += report(each, answers, folder / "not_converged")
        if each.key in SHOWN:
            each.methods = AUTO | CYCLES
            shown.append((each, classes))
        print(each.key, file=sys.stderr)
    if len(shown) == len(SHOWN):
        draw_maps(*map(list, zip(*shown, strict=True)), 4, "", folder / "stability")
    conclude(folder / "conclusion.txt", "\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

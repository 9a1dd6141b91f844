#!/usr/bin/env python3
"""Compares the verdicts of the scenes of input/scenes/ and input/duty/ with fine grids, one ingredient left out at a time.

The truth is that of bench/adequacy.py and bench/adequacy_dry.py. Without squeeze there are only steady solutions with the waves
at their places, which no namelist describes: the truth is the program's own verdict on SQUEEZE_FINER times the nodes and time
steps. A finer grid judges the error bars of histories.

    same       the program's verdict is that of the fine grids
    other      it is not: a miss
    not known  the program gives no verdict: a miss as well
    no truth   no solution exists without the ingredient

Writes scenes.csv and scenes.txt; --page also writes docs/scenes.md and its figures (bench/scenes_page.py).
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import adequacy
import adequacy_dry
import f90nml
import h5py
import scenes_page
from bench_program import ROOT, conclude, new_parser, output_folder, save
from family_shipped import groups_of
from ingredients import NO_TRUTH, NUMERICAL, Row, bare, run
from namelists import Groups

SQUEEZE_FINER = 4
# Of histories in input/duty/ number, what makes their namelist, and times the intervals of the grid that judges: some take long.
HISTORIES = {
    **{"spur_gear.toml": (11, "gear", 2), "cam.toml": (12, "cam", 2), "reciprocating.nml": (13, "", 4)},
    **{"stop_start.nml": (14, "", 4), "mixed_start.nml": (16, "", 4), "rough_ring.nml": (17, "", 2)},
}
# Of a point contact error bars are judged as well, on a grid so many times finer along each axis.
POINT_FINER = 2
QUANTITIES, WITHIN = (*adequacy.QUANTITIES, "mean_power", "asperity_load_share"), "within the error bar"


def squeeze_changes(groups: Groups, said: dict) -> dict[str, float]:
    """What the squeeze term changes on finer grids with shorter steps, by the program itself."""
    domain = said["domain"] | {"intervals": SQUEEZE_FINER * said["domain"]["intervals"]}
    time = groups["time"] | {"time_step": said["step"] / SQUEEZE_FINER, "statistics_from": said["start"]}
    again = run(groups | {"domain": domain, "time": time}, adequacy.told)
    changes = again["rows"]["squeeze"]["changes"] if again else {}
    return {q: changes[q][0] for q in adequacy.QUANTITIES if q in changes}


def judge(name: str, groups: Groups) -> list[Row]:
    """Of each ingredient of a scene the quantity that it truly changes most."""
    is_dry = groups["case"]["problem"] != "ehl_line"
    rows = adequacy_dry.judge((name, groups)) if is_dry else adequacy.judge((name, groups), squeeze_changes)
    if not rows:
        sys.exit(f"scenes.py: {name}: does not converge, or not on the fine grid")
    by_size = sorted(rows, key=lambda row: [-1.0 if math.isnan(change) else abs(change) for change in (row.truth, row.change)])
    largest = {row.ingredient: row for row in by_size}
    return [largest[name] for name in dict.fromkeys(row.ingredient for row in rows) if name not in NUMERICAL]


def judge_history(path: Path, finer: int) -> list[Row]:
    """Whether `finer` times the intervals change each quantity by no more than its error bar; the change of a row is none."""

    def told(file: h5py.File) -> tuple[dict[str, tuple[float, float]], dict[str, int]]:
        domain, own = file["input/effective/domain"].attrs, {q: file["summary"][q] for q in QUANTITIES if q in file["summary"]}
        found = {q: (float(row[()]), float(row.attrs["error_estimate"])) for q, row in own.items()}
        return found, {key: finer * int(domain[key]) for key in ("intervals", "intervals_x", "intervals_y") if key in domain}

    groups = groups_of(f90nml.read(path))
    files = {group["file"]: (path.parent / group["file"]).read_bytes() for key, group in groups.items() if key == "history"}
    said, domain = run(groups, told, files)
    truth = bare(groups, domain=domain)
    if "intervals_x" in domain:
        del truth["output"]  # points have no /adequacy to leave out
    fine, _ = run(truth, told, files)
    rows = []
    for q, (value, bar) in ((q, pair) for q, pair in said.items() if pair[0] > 0):
        truth, error = fine[q][0] / value - 1, bar / value
        verdict, right = (WITHIN, WITHIN if abs(truth) <= error else "outside it") if error >= 0 else ("not known", "")
        rows.append(Row(path.stem, "nothing", q, 0 * error, error, truth, verdict, right, error))
    return rows


def outcome(row: Row) -> str:
    """Same, other, not known, or no truth to compare with."""
    if row.verdict == "not known" or row.true_verdict == NO_TRUTH:
        return row.verdict if row.verdict == "not known" else NO_TRUTH
    return "same" if row.verdict == row.true_verdict else "other"


def summary(rows: list[Row]) -> str:
    """How many scenes and ingredients are right."""
    scenes = {row.scene: {outcome(own) for own in rows if own.scene == row.scene} for row in rows}
    known = [row for row in rows if math.isfinite(row.change) and math.isfinite(row.truth)]
    within = sum(abs(row.change - row.truth) <= row.error for row in known)
    count = [outcome(row) for row in rows].count
    return (
        f"Of {len(scenes)} scenes {sum(found == {'same'} for found in scenes.values())} have every verdict of the fine grids, "
        f"{sum('other' not in found for found in scenes.values())} have none that differs.\n"
        f"Of {len(rows)} verdicts {count('same')} are the same, {count('other')} differ, {count('not known')} are not known, "
        f"{count(NO_TRUTH)} have no truth.\n"
        f"Of the {len(known)} largest changes that are known {within} are those of the fine grids to their error bars.\n"
    )


def main() -> int:
    """Command line; status 1 where a scene does not get the verdicts of the fine grids."""
    parser = new_parser(__doc__, "the steady scenes", "results/scenes")
    parser.add_argument("--page", action="store_true", help="write docs/scenes.md")
    options = parser.parse_args()
    folder = output_folder(options)
    rows: list[Row] = []
    sources = {int(path.name[:2]): (path, path) for path in (ROOT / "input" / "scenes").glob("*.nml")}
    for name, (number, command, _) in HISTORIES.items():
        source = ROOT / "input" / "duty" / name
        sources[number] = scenes_page.made(command, source, folder) if command else source, source
    for _, (path, source) in sorted(sources.items()):
        if options.quick and "&time" in path.read_text(encoding="utf-8"):
            continue
        print(path.stem, file=sys.stderr)
        finer = HISTORIES.get(source.name, (POINT_FINER if "ehl_point" in path.read_text(encoding="utf-8") else 0,))[-1]
        rows += judge_history(path, finer) if finer else judge(path.stem, groups_of(f90nml.read(path)))
        save(folder / "scenes.csv", rows)
    text = summary(rows)
    conclude(folder / "scenes.txt", text)
    if options.page and not options.quick:
        print(scenes_page.write_page(sources, [(row, outcome(row)) for row in rows], text, folder))
    return 0 if all(outcome(row) == "same" for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())

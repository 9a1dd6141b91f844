#!/usr/bin/env python3
"""Chapter 6 of the thesis: ridges and dents that overtake each other, about 100 transients in two forms.

Form (a) is the thesis's grid (256 intervals, backward Euler, dT = dX), form (b) a fine one (512, BDF2, dT = dX/2). The error of
(a) is its distance from (b); that of (b) is a third of the changes by halving the step and by halving the grid.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path

import chapter6_besides
import chapter6_claims
import chapter6_figures
from overtaking import FINEST, FORMS, LENGTH, Situation, Thinning, film_errors, measure
from study import ROOT, Claims, Runner, StudyError, Table, finish, new_parser

PROGRAM = "chapter6.py"
DEPTHS = tuple(range(-1, -7, -1))
WIDTHS = tuple(range(1, 8))
SLIPS = tuple(range(1, 6))
# What the reference solver gives and how near (a) and (b) must come: situation -> form -> (value, tolerance).
EXPECTED = {
    Situation(5, 1e5, l2=-6): {"a": (0.403, 0.005), "b": (0.425, 0.00425)},
    Situation(1, 1e5, l2=-6): {"a": (0.294, 0.005), "b": (0.326, 0.00326)},
    Situation(5, 2e5, l2=-6): {"a": (0.470, 0.005), "b": (0.477, 0.00477)},
}
# Figures 6.2 to 6.5: fast over slow.
OVERTAKINGS = {
    "ridge-ridge": Situation(4, l2=1),
    "ridge-dent": Situation(4, l1=-1, l2=1),
    "dent-dent": Situation(4, l1=-1, l2=-1),
    "dent-ridge": Situation(4, l2=-1),
}
# Besides: what the text compares them with, and Figure 6.6.
COMPANIONS = {
    "half ridges": Situation(4, l1=0.5, l2=0.5),
    "ridge alone": Situation(4),
    "deep dent-ridge": Situation(4, l2=-5),
    "deep dent alone": Situation(4, l1=0, l2=-5),
    "fast ridge alone": Situation(4, l1=0, l2=1),
    "fast dent alone": Situation(4, l1=0, l2=-1),
    "sum on the slow surface": Situation(4, l1=-4),
    "sum on the fast surface": Situation(4, l1=0, l2=-4),
    "smooth": Situation(4, l1=0),
}


def figures_of(situation: Situation) -> str:
    """The figures of the thesis that show this combination."""
    found = []
    first = (situation.load, situation.l1, situation.m1) == (1e5, 1, 1)
    if first and situation.slip == 5:
        found.append("6.7")
    if first and situation.m2 == 1:
        found.append("6.8")
    if situation.load == 1e5 and situation.slip == 5 and situation.l2 == -2:
        found.append("6.9")
    if situation.slip == 5 and (situation.l1, situation.m2) == (1, 1):
        found.append("6.10")
    return " ".join(found)


def combinations() -> list[Situation]:
    """Every combination of the parameter study, Figures 6.7 to 6.10."""
    found = {Situation(5, l2=depth, m2=width) for depth in DEPTHS for width in WIDTHS}
    found |= {Situation(slip, l2=depth) for slip in SLIPS for depth in DEPTHS}
    found |= {Situation(5, l1=2, l2=-2, m2=width) for width in WIDTHS}
    found |= {Situation(5, load=2e5, l2=depth) for depth in DEPTHS}
    return sorted(found)


def study_table(found: dict[str, dict[Situation, Thinning]]) -> Table:
    """One row for each combination: both forms with their errors."""
    table = Table(
        figures="figures of the thesis",
        slip="slide-to-roll ratio s",
        load="load per length [N/m]",
        l1="ridge height / 0.2 um",
        l2="dent height / 0.2 um",
        m2="dent wavelength / 0.1 mm",
        xi_a="film thinning (6.1), form (a)",
        error_a="error of xi_a: distance to form (b)",
        xi_b="film thinning (6.1), form (b)",
        error_b="error of xi_b: halving of the step and of the grid",
        contact_b="the same as xi_b in -1 <= X <= 0 alone",
        x="position of the maximum in form (b) [half-widths]",
        time_after="time of the maximum after the meeting of the centres, form (b)",
        edge="end of the window that holds the maximum, form (b)",
        h_min="smallest film of the passage, form (b), over the smooth one",
    )
    for item, a in found["a"].items():
        row = {
            "figures": figures_of(item),
            "slip": item.slide_to_roll,
            "load": item.load,
            "l1": item.l1,
            "l2": item.l2,
            "m2": item.m2,
            "xi_a": float(a.xi),
        }
        if "b" in found:
            b, step, grid = (found[form][item] for form in ("b", "b_step", "b_grid"))
            error = (abs(b.xi - step.xi) + abs(step.xi - grid.xi)) / 3
            row |= {
                "error_a": float(abs(a.xi - b.xi)),
                "xi_b": float(b.xi),
                "error_b": float(error),
                "contact_b": float(b.contact),
                "x": b.x,
                "time_after": b.time - item.meeting_time,
                "edge": b.edge,
                "h_min": float(b.h_min),
            }
        table.add(**row)
    return table


def check_expected(found: dict[str, dict[Situation, Thinning]]) -> None:
    """The values known from a reference solver; a miss ends the study."""
    misses = []
    print("\nFilm thinning of the deepest dent (m2 = 1) beside the reference")
    for item, expected in EXPECTED.items():
        for form, (value, tolerance) in expected.items():
            if form not in found or item not in found[form]:
                continue
            xi = found[form][item].xi
            print(f"  ({form}) s = {item.slide_to_roll:.3f}, {item.load:.0e} N/m: {xi:.4f}, expected {value} +- {tolerance:.4f}")
            if abs(xi - value) > tolerance:
                misses.append(item.name)
    if misses:
        raise StudyError(f"film thinning misses its reference: {', '.join(misses)}")


def run_profiles(folder: Path, options: argparse.Namespace) -> dict[str, Path]:
    """The overtakings of Figures 6.2 to 6.6 with film and pressure, form (b); results stay."""
    runner = Runner(folder, options.jobs, options.program)
    both = ("film_thickness", "pressure")
    situations = OVERTAKINGS | COMPANIONS
    cases = {item.name: item.case(FORMS["b"], both) for item in situations.values()}
    runner.run(cases, lambda _, path: path, keep=frozenset(cases))
    return {words: folder / f"{item.name}.h5" for words, item in situations.items()}


def extremes_table(profiles: dict[str, Path], options: argparse.Namespace) -> Table:
    """Smallest film and highest spike of the four overtakings, each with its place, its time and their errors."""
    runner = Runner(options.output / "extremes", options.jobs, options.program)
    both = ("film_thickness", "pressure")
    coarser = {(words, form): item.case(FORMS[form], both) for words, item in OVERTAKINGS.items() for form in ("b_step", "b_grid")}
    meetings = {f"{OVERTAKINGS[words].name}_{form}": OVERTAKINGS[words].meeting_time for words, form in coarser}
    cases = {f"{OVERTAKINGS[words].name}_{form}": case for (words, form), case in coarser.items()}
    found = runner.run(cases, lambda name, path: chapter6_claims.Fields(path, meetings[name]))
    table = Table(
        situation="fast over slow",
        extreme="H: smallest film of the passage; P: highest spike near the meeting",
        value="form (b)",
        error="a third of what halving the step and of what halving the grid change",
        x="its place",
        x_error="its error likewise, and half of dX",
        time="its time after the meeting of the centres",
        time_error="its error likewise, and half the time between two profiles",
    )
    for words, item in OVERTAKINGS.items():
        fields = [chapter6_claims.Fields(profiles[words], item.meeting_time)]
        fields += [found[f"{item.name}_{form}"] for form in ("b_step", "b_grid")]
        for letter, rows in (("H", [f.film_minimum() for f in fields]), ("P", [f.spike() for f in fields])):
            errors = [(abs(b - step) + abs(step - grid)) / 3 for b, step, grid in zip(*rows, strict=True)]
            half = LENGTH / FORMS["b"].intervals / 2
            row = {"value": rows[0][0], "error": errors[0], "x": rows[0][1], "x_error": errors[1] + half}
            table.add(situation=words, extreme=letter, **row, time=rows[0][2], time_error=errors[2] + half)
    return table


def show_besides(options: argparse.Namespace, claims: Claims, fine: dict[Situation, Thinning]) -> None:
    """Internal cavitation, and the loads of Figure 6.10 as printed; `fine` is form (b)."""
    folder = options.output / "besides"
    holes = chapter6_besides.study_cavitation(Runner(folder, options.jobs, options.program), claims)
    numbers = dict.fromkeys(("lowest", "length", "duration"), ".3f")
    holes.show("Internal cavitation of the four overtakings, s = 4/3", situation="", amplitude="g", **numbers, outcome="")
    holes.write(options.output / "cavitation", "Internal cavitation of the four overtakings over the height of the features")
    light = chapter6_besides.study_printed_loads(folder, options, claims, fine)
    light.show("Film thinning at the loads as printed", load=".0e", l2="g", xi=".4f", error=".4f", h_min=".3f")
    light.write(options.output / "printed_loads", "Film thinning (6.1) at 10 and 20 kN/m")


def animate(options: argparse.Namespace) -> None:
    """A film of the slow overtaking, s = 1/3, by the script for passages."""
    item, folder = Situation(1, l2=-6), options.output / "profiles"
    case = item.case(FORMS["b"], ("film_thickness", "pressure"))
    Runner(folder, 1, options.program).run({item.name: case}, lambda _, path: path, keep=frozenset({item.name}))
    script, target = ROOT / "postproc" / "transient.py", options.output / "overtaking.gif"
    command = [sys.executable, str(script), str(folder / f"{item.name}.h5"), "--output", str(target)]
    subprocess.run([*command, "--parts", "passage", "--frames", "80"], check=True)


def quick(options: argparse.Namespace) -> None:
    """The two values of form (a) alone, and the seven dents of Figure 6.7 with l2 = -6."""
    items = [*EXPECTED, *(Situation(5, l2=-6, m2=width) for width in WIDTHS[1:])]
    runner = Runner(options.output, options.jobs, options.program)
    found = {"a": measure(runner, items, FORMS["a"])}
    check_expected(found)
    study_table(found).write(options.output / "xi_quick", "Film thinning (6.1), form (a), some combinations")


def study(options: argparse.Namespace) -> None:
    """The whole chapter."""
    options.output.mkdir(parents=True, exist_ok=True)
    if options.quick:
        quick(options)
        return
    items = combinations()
    found = {}
    for form, settings in FORMS.items():
        runner = Runner(options.output / form, options.jobs, options.program)
        found[form] = measure(runner, items, settings)
        words = f"{settings.intervals} intervals, {settings.scheme}, {settings.steps_per_interval} step(s) per interval"
        print(f"form {form} ({words}): {runner.effort}", flush=True)
        if form in ("a", "b"):
            check_expected({form: found[form]})
    runner = Runner(options.output / "finest", options.jobs, options.program)
    print("\nThe same with 1024 intervals, BDF2, dT = dX/2")
    for item, thinning in measure(runner, list(EXPECTED), FINEST).items():
        print(f"  s = {item.slide_to_roll:.3f}, {item.load:.0e} N/m: {thinning.xi:.4f}")
    table = study_table(found)
    table.write(options.output / "xi", "Film thinning (6.1) of every combination of chapter 6")
    formats = {"figures": "", "slip": ".3f", "load": ".0e", "l1": "g", "l2": "g", "m2": "g", "xi_a": ".4f", "error_a": ".4f"}
    formats |= {"xi_b": ".4f", "error_b": ".4f", "contact_b": ".4f", "x": "+.3f", "time_after": "+.3f", "edge": "", "h_min": ".3f"}
    table.show("Film thinning (6.1)", **formats)
    profiles = run_profiles(options.output / "profiles", options)
    extremes = extremes_table(profiles, options)
    extremes.show("Extremes of the overtakings", situation="", extreme="", **dict.fromkeys(list(extremes.columns)[2:], ".4f"))
    extremes.write(options.output / "extremes", "Smallest film and highest spike of the overtakings")
    claims = Claims()
    chapter6_claims.check_overtakings(claims, profiles, {words: item.meeting_time for words, item in OVERTAKINGS.items()})
    chapter6_claims.check_study(claims, found)
    steepest = [Situation(slip, l2=-6) for slip in SLIPS]
    runner = Runner(options.output / "errors", options.jobs, options.program)
    chapter6_claims.check_errors(claims, found, {item: film_errors(runner, item) for item in steepest})
    show_besides(options, claims, found["b"])
    claims.show()
    claims.table.write(options.output / "statements", "Statements of chapter 6 and what was measured")
    chapter6_figures.draw(options.output, profiles, found, OVERTAKINGS)
    animate(options)


def main() -> None:
    """Command line."""
    parser = new_parser(PROGRAM, __doc__, "results/chapter6")
    finish(parser, study)


if __name__ == "__main__":
    main()

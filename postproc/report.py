#!/usr/bin/env python3
"""Writes one page to pass on a result: input, outcome with error bars, figures, limits and needs of the model (HTML)."""

from __future__ import annotations

import argparse
import base64
import math
import profile as film_profile
import sys
import tempfile
from pathlib import Path

import dry
import figure_command
import figure_style as style
import h5py
import jinja2
import numpy as np
import point
import transient
from matplotlib import pyplot as plt
from result_file import WORDS, ResultError, inputs_of, opened, prefix_of, read_result, short_words, text_of, values_of

PROGRAM = "report.py"
EXAMPLE = "python postproc/report.py results/case1.h5 --output results"
PROBLEMS = {
    "ehl_line": "lubricated line contact",
    "ehl_point": "lubricated point contact",
    "dry_line": "dry contact of a rough profile",
    "dry_area": "dry contact of a rough area",
}
# What the contact is: attribute of /scaling, words.
CONTACT = {
    "reduced_radius": "Reduced radius",
    "reduced_radius_x": "Reduced radius in the plane of x",
    "radius_ratio": "Ratio of the reduced radii, x over y",
    "reduced_modulus": "Reduced modulus",
    "load": "Load",
    "load_per_length": "Load per length",
    "hertz_pressure": "Hertzian pressure",
    "half_width": "Half-width of the Hertzian contact",
    "half_width_x": "Half-axis of the Hertzian ellipse along x",
    "half_width_y": "Half-axis along y",
    "speed_sum": "Sum of the surface speeds",
    "slide_to_roll": "Slide-to-roll ratio",
    "viscosity": "Ambient viscosity",
    "moes_m": "Moes load number M",
    "moes_l": "Moes material number L",
}
# A relative error beyond this is one of a grid that does not show the quantity.
COARSE = 0.2
# Quantities of a passage that are drawn over time.
HISTORIES = ("h_min", "p_max", "friction_coefficient")


def shown(value: float, unit: str, digits: int = 4) -> str:
    """A number with a prefixed unit: 443.1 nm; without a unit alone."""
    if not math.isfinite(value):
        return "not known"
    if unit in ("1", ""):
        return rounded(value, digits)
    base, slash, below = unit.partition("/")
    if base not in ("m", "Pa", "N", "W", "s", "Pa s", "J"):
        return f"{rounded(value, digits)} {unit}"
    size, prefix = prefix_of(abs(value) or 1.0)
    return f"{rounded(value / size, digits)} {prefix}{base}{slash}{below}"


def rounded(value: float, digits: int, sign: str = "") -> str:
    """A number with so many digits, large ones without an exponent: 0.0197, 110."""
    return f"{float(f'{value:.{digits}g}'):{sign}.12g}"


def percent(share: float, sign: str = "") -> str:
    """A share in percent with two digits: 0.14 %, 110 %."""
    return f"{rounded(100 * share, 2, sign)} %" if abs(share) >= 1e-5 else "less than 0.001 %"


def attribute(item: h5py.Dataset | h5py.Group, name: str) -> str:
    """A text attribute; empty if it is not there."""
    return text_of(item.attrs.get(name, ""))


def results_of(summary: h5py.Group) -> list[dict[str, str]]:
    """Rows of the table of results."""
    rows = []
    for name, words in WORDS.items():
        if name not in summary:
            continue
        item = summary[name]
        value, unit = float(values_of(item)), attribute(item, "units")
        error = float(item.attrs.get("error_estimate", math.nan))
        if not (value or error):  # nothing slides
            continue
        share = error / abs(value) if value else math.nan
        reason = "not resolved by this grid" if share > COARSE else attribute(item, "no_estimate")
        when = f"{name}_time"
        rows.append(
            {
                "words": words.removesuffix(", per length") if unit == "W" else words,
                "value": shown(value, unit),
                "error": f"± {percent(share)}" if math.isfinite(share) else "not known",
                "time": shown(float(values_of(summary[when])), attribute(summary[when], "units")) if when in summary else "",
                "reason": reason,
            }
        )
    return rows


def limits_of(group: h5py.Group) -> list[dict[str, object]]:
    """The limits of the model: those passed first."""
    rows = [
        {
            "name": name.replace("_", " "),
            "words": attribute(item, "long_name").partition(";")[0],
            "value": shown(float(values_of(item)), attribute(item, "units") or "1", 3),
            "bound": f"{attribute(item, 'beyond')} {shown(float(item.attrs['threshold']), attribute(item, 'units') or '1', 3)}",
            "source": attribute(item, "source"),
            "is_passed": bool(item.attrs["exceeded"]),
        }
        for name, item in group.items()
    ]
    return sorted(rows, key=lambda row: not row["is_passed"])


def needs_of(group: h5py.Group) -> list[dict[str, str]]:
    """What leaving an ingredient out, or a finer grid, changes: verdict and largest known change."""
    rows = []
    for name, item in group.items():
        if name in ("validity", "decision"):
            continue
        changes = {key: float(values_of(value)) for key, value in item.items() if isinstance(value, h5py.Dataset)}
        largest = max(changes, key=lambda key: abs(changes[key]), default="")
        change = f"{percent(changes[largest], '+')} of {short_words(largest).lower()}" if largest else "not known"
        rows.append(
            {
                "name": name.replace("_", " "),
                "instead": attribute(item, "instead"),
                "verdict": attribute(item, "verdict"),
                "change": change,
            }
        )
    return rows


def draw_histories(path: Path, folder: Path) -> list[Path]:
    """The smallest film, the largest pressure and the friction of a passage over time."""
    result = read_result(path)
    names = [name for name in HISTORIES if name in result.transient and np.nanmax(abs(result.transient[name].values)) > 0]
    si = result.solution["x"].has_si
    figure, axes = style.new_figure(style.TWO_COLUMNS, 55, ncols=len(names), squeeze=False)
    time = result.transient["time"]
    for panel, name in zip(axes[0], names, strict=True):
        quantity = result.transient[name]
        panel.plot(time.values * time.axis(si).factor, quantity.values * quantity.axis(si).factor, color="#08306b")
        panel.set(xlabel=f"Time [{time.axis(si).unit or '-'}]", ylabel=f"{short_words(name)} [{quantity.axis(si).unit or '-'}]")
        panel.set_ylim(bottom=0)
    return style.save_figure(figure, [folder / f"{path.stem}_history.svg"])


def figures_of(path: Path, folder: Path, problem: str, is_transient: bool, has_si: bool) -> list[tuple[str, str]]:
    """Figures as data of the page, with a caption each: those of the other scripts."""
    options = argparse.Namespace(
        results=[str(path)],
        output=str(folder),
        format=["svg"],
        si=has_si,
        window=None,
        time=None,
        parts=["film_strip", "xt"],
        centres=list(transient.STRIP_CENTRES),
    )
    captions = {
        "profile": "Pressure and film thickness at the end" if is_transient else "Pressure and film thickness",
        "film_strip": "Film thickness and pressure while the roughness passes (dotted: the smooth contact)",
        "xt": "Film thickness and pressure over position and time",
        "history": "Over time",
        "maps": "Pressure and contact",
        "point": ("Interference of light" if has_si else "Pressure")
        + ", film, cuts along and across the flow; thin, dashed: Hertz",
        "sweep": "Over the load, with error bars",
        "surface": "Heights before, under and after the load",
        "convergence": "Convergence",
    }
    with plt.rc_context({"svg.fonttype": "path"}):
        if problem == "ehl_line":
            files = film_profile.draw(path, options)
            if is_transient:
                files += draw_histories(path, folder) + transient.draw(path, options)
        elif problem == "ehl_point":
            files = point.draw(path, options)
        else:
            captions["profile"] = "Pressure and heights"
            files = dry.draw(path, options)
    return [
        (base64.b64encode(file.read_bytes()).decode(), captions[file.stem.removeprefix(f"{path.stem}_")])
        for file in files
        if not file.stem.endswith("_convergence")
    ]


def content_of(path: Path, folder: Path) -> dict[str, object]:
    """Everything that the page shows."""
    with opened(path) as file:
        problem = attribute(file, "problem")
        if problem not in PROBLEMS:
            raise ResultError(f"{path}: not a result of asperity (problem is '{problem}')")
        scaling = file["scaling"].attrs
        is_transient = "transient" in file
        needs = needs_of(file["adequacy"]) if "adequacy" in file else []
        limits = limits_of(file["adequacy/validity"]) if "adequacy/validity" in file else []
        content = {
            "name": path.name,
            "title": attribute(file, "title") or path.stem,
            "problem": PROBLEMS[problem],
            "state": "in time" if is_transient else "steady" if problem in ("ehl_line", "ehl_point") else "",
            "is_converged": bool(file.attrs["converged"]),
            "is_outside": attribute(file, "outcome").startswith("outside"),
            "reason": attribute(file, "reason"),
            "note": text_of(values_of(file["report/note"])) if "report/note" in file else "",
            "contact": [
                (words, shown(float(scaling[name]), text_of(scaling[f"{name}_units"])))
                for name, words in CONTACT.items()
                if name in scaling
            ],
            "results": results_of(file["summary"]),
            "limits": limits,
            "passed": [limit["name"] for limit in limits if limit["is_passed"]],
            "needs": needs,
            "accuracy": percent(float(file["adequacy"].attrs["accuracy"])) if needs else "",
            "namelist": text_of(values_of(file["input/namelist"])),
            "inputs": {group: inputs_of(file, group) for group in file["input/effective"]},
            "version": f"{attribute(file, 'version')}, commit {attribute(file, 'git_commit')}",
            "seconds": f"{float(values_of(file['report/wall_seconds'])):.3g}",
        }
        has_si = not problem.startswith("ehl_") or attribute(file["solution/x"], "si_units") == "m"
    content["figures"] = figures_of(path, folder, problem, is_transient, has_si)
    return content


def draw(path: Path, options: argparse.Namespace) -> list[Path]:
    """One result: reads it, writes its page, returns the name of that."""
    output = Path(options.output)
    target = output if output.suffix == ".html" else output / f"{path.stem}.html"
    if target is output and len(options.results) > 1:
        raise ResultError(f"{output}: one file name for several results; give a folder")
    loader = jinja2.FileSystemLoader(Path(__file__).parent / "data")
    page = jinja2.Environment(loader=loader, autoescape=True, trim_blocks=True, lstrip_blocks=True).get_template("report.html.j2")
    with tempfile.TemporaryDirectory() as folder:
        text = page.render(content_of(path, Path(folder)))
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text, encoding="utf-8")
    return [target]


def main(arguments: list[str] | None = None) -> int:
    """Command line; returns the exit status."""
    parser = figure_command.FigureParser(
        prog=PROGRAM,
        description=__doc__,
        epilog=f"example:\n  {EXAMPLE}\n\nstatus: 0 written, 1 wrong file or usage, 3 cannot write",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("results", nargs="+", metavar="RESULT.h5", help="result files of asperity")
    parser.add_argument("--output", default=".", metavar="DIR", help="folder for the pages (default: the current one) or NAME.html")
    options = parser.parse_args(arguments)
    return max(figure_command.guarded(PROGRAM, draw, Path(name), options) for name in options.results)


if __name__ == "__main__":
    sys.exit(main())

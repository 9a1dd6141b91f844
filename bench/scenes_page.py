"""Writes docs/scenes.md: the ten scenes of input/scenes/ with their closing tables, verdicts, regimes and figures."""

from __future__ import annotations

import csv
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

from bench_program import ENVIRONMENT, ROOT

PROGRAM = ROOT / "build" / "bin" / "asperity"
PAGE = ROOT / "docs" / "scenes.md"
IMAGES = ROOT / "docs" / "images" / "scenes"
# What is drawn of each scene, and what of it is the figure.
FIGURES = {
    "01_journal_bearing": (("profile.py", "--si"), "profile", "pressure and film"),
    "02_rubber_seal": (("profile.py", "--si"), "profile", "pressure and film"),
    "03_roller_bearing": (("profile.py", "--si"), "profile", "pressure and film"),
    "04_gear_tooth": (("friction.py", "--si"), "friction", "pressure, film and shear stresses"),
    "05_traction_rig": (("friction.py", "--si"), "friction", "pressure, film, shear stresses and the velocity of the oil"),
    "06_ridge_passage": (("transient.py", "--parts", "film_strip"), "film_strip", "the ridge at several places"),
    "07_waviness": (("profile.py", "--si"), "profile", "pressure and film at the last time"),
    "08_rough_in_oil": (("profile.py", "--si"), "profile", "pressure and film at the last time"),
    "09_dry_machined": (("dry.py",), "profile", "the profile, undeformed, under load and unloaded"),
    "10_run_in": (("dry.py",), "profile", "the profile, undeformed, under load and unloaded"),
}
TARGET = 0.03
WIDTH = 128

HEAD = """# Ten scenes

Contacts as they occur, in [input/scenes/](../input/scenes). Of each: the input, what the program says, where it lies on the chart
of Moes, and what of the model it needs, beside what fine grids say of the same. `make scenes` runs them, leaves out every
ingredient on fine grids, and writes this page; nothing on it is typed by hand but the comments of the inputs.

Inputs are typical values, not measurements of one machine: of oils a viscosity of their ISO class at the temperature beside it
(ISO 3448 gives it at 40 degrees), for alpha 20 1/GPa, Eyring stresses of 4 to 6 MPa; pressures that bearings and gears are
made for.

<!-- not run: takes minutes -->
```sh
make scenes
```

## Are the verdicts right?

{summary}
`change` is what the program measured, on its coarse grids, of the quantity that the fine grids change most, with its error bar;
`fine grids` is what they say: passages with half the spacing and half the time step, steady contacts for 2e-4 of h_min, dry
profiles on 8 times the nodes, with the heights of the scene's own grid. The verdicts compare with the accuracy of the result. A
verdict that is `not known` is no error, but no answer either: measuring may cost a tenth of the run, and where its error bar is
larger than what it compares with there is none. Without squeeze there are steady solutions with the waves at their places, for
which no namelist asks: `fine grids` is what the program says itself on 4 times the nodes and time steps. Rigid bodies are 2000
times as stiff, or as many times as stands beside the verdict: stiffer ones had no solution.

| scene | accuracy | same | other | not known | no truth |
|---|---|---|---|---|---|
{counts}

"""


def text_of(*command: object, folder: Path) -> str:
    """What a command prints, which must succeed."""
    done = subprocess.run([str(word) for word in command], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, check=True)
    return done.stdout


def closing_table(printed: str, name: str) -> str:
    """The end of what the program prints, without times of the machine and the name of the result."""
    lines = printed.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(f"{name}.nml: converged"))
    lines[first] = re.sub(r", [\d.E+-]+ s$", "", lines[first])
    return "\n".join(line for line in lines[first:] if not line.startswith("  result "))


def percent(text: str) -> str:
    """A share of the CSV in percent; empty where it is not known."""
    value = float(text)
    return "" if value != value else f"{100 * value:.3g} %"  # noqa: PLR0124


def verdict_table(rows: list[dict[str, str]]) -> str:
    """The ingredients of one scene."""
    lines = ["| without | verdict | by fine grids | most changed | change | fine grids |", "|---|---|---|---|---|---|"]
    for row in rows:
        right = row["truth"] + (f" ({row['note']})" if row["note"] else "")
        told = f"{percent(row['change'])} +- {percent(row['error'])}" if percent(row["change"]) else "not known"
        mark = " **(other)**" if row["outcome"] == "other" else ""
        name = row["quantity"].replace("_", " ")
        lines.append(
            f"| {row['ingredient']} | {row['verdict']}{mark} | {right} | {name} | {told} | {percent(row['true_change'])} |"
        )
    return "\n".join(lines)


def regime(path: Path, folder: Path) -> str:
    """Where a result lies on the chart."""
    printed = text_of(sys.executable, ROOT / "postproc" / "regime.py", path, "--output", folder, "--format", "png", folder=folder)
    return printed.splitlines()[0].split(": ", 1)[1]


def draw(name: str, folder: Path) -> str:
    """The figure of a scene; returns the words below it."""
    command, kind, words = FIGURES[name]
    script, *options = command
    result = folder / f"{name}.h5"
    text_of(sys.executable, ROOT / "postproc" / script, result, *options, "--output", folder, "--format", "png", folder=folder)
    IMAGES.mkdir(parents=True, exist_ok=True)
    shutil.copy(folder / f"{name}_{kind}.png", IMAGES / f"{name}.png")
    return words


def auto_table(path: Path, text: str, folder: Path) -> str:
    """What model = 'auto' decides of a scene for a target of TARGET, and why."""
    if "ehl_line" not in text:
        return "A dry contact has no `model = 'auto'`: it is solved with everything that it is given."
    lean = folder / f"{path.stem}_auto.nml"
    chosen = re.sub(r"^ *intervals *=.*\n", "", text, flags=re.MULTILINE).replace("   problem =", "   model = 'auto'\n   problem =")
    lean.write_text(f"{chosen}&accuracy\n   target = {TARGET}\n/\n", encoding="utf-8")
    lines = text_of(PROGRAM, lean, "--output", folder, folder=folder).splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("  auto "))
    last = next(i for i, line in enumerate(lines) if i > first and not line.startswith("      "))
    solved = [line.split(": ", 1)[1] for line in lines if line.startswith(f"{lean.name}: solves ")]
    told = "\n".join([f"  {line}" for line in solved] + lines[first:last])
    return f"With `model = 'auto'` and `&accuracy target = {TARGET}`, the grid chosen by the program:\n\n```text\n{told}\n```"


def section(path: Path, rows: list[dict[str, str]], folder: Path) -> str:
    """The part of the page about one scene."""
    text = path.read_text(encoding="utf-8")
    title = re.search(r"title = '(.*)'", text)[1]
    comment = " ".join(line[2:] for line in text.splitlines() if line.startswith("! "))
    printed = text_of(PROGRAM, path, "--output", folder, folder=folder)
    words = draw(path.stem, folder)
    parts = [f"## {path.stem[:2]} {title}", "\n".join(textwrap.wrap(comment, WIDTH))]
    parts.append(f"![{title}: {words}](images/scenes/{path.stem}.png)")
    if "ehl_line" in text:
        parts.append("\n".join(textwrap.wrap(f"On the chart of Moes: {regime(folder / f'{path.stem}.h5', folder)}.", WIDTH)))
    parts.append(f"[input/scenes/{path.name}](../input/scenes/{path.name}):")
    code = "\n".join(line for line in text.splitlines() if not line.startswith("! "))
    parts += [f"```fortran\n{code}\n```", f"```text\n{closing_table(printed, path.stem)}\n```", verdict_table(rows)]
    parts.append(auto_table(path, text, folder))
    return "\n\n".join(parts) + "\n"


def count_line(name: str, rows: list[dict[str, str]]) -> str:
    """One scene in the table of all."""
    counts = [sum(row["outcome"] == word for row in rows) for word in ("same", "other", "not known", "no truth")]
    return f"| {name} | {percent(rows[0]['accuracy'])} | " + " | ".join(map(str, counts)) + " |"


def write_page(results: Path) -> Path:
    """Writes the page from scenes.csv and scenes.txt of bench/scenes.py, and runs of the program."""
    with (results / "scenes.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    by_scene = {name: [row for row in rows if row["scene"] == name] for name in dict.fromkeys(row["scene"] for row in rows)}
    summary = (results / "scenes.txt").read_text(encoding="utf-8")
    text = HEAD.format(summary=summary, counts="\n".join(count_line(name, own) for name, own in by_scene.items()))
    text += "\n".join(section(ROOT / "input" / "scenes" / f"{name}.nml", own, results) for name, own in by_scene.items())
    PAGE.write_text(text, encoding="utf-8")
    return PAGE

"""Writes docs/scenes.md: scenes of input/scenes/ and input/duty/ with their closing tables, verdicts, regimes and figures."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

from bench_program import ASPERITY, ENVIRONMENT, ROOT
from ingredients import Row

PAGE = ROOT / "docs" / "scenes.md"
IMAGES = ROOT / "docs" / "images" / "scenes"
DUTY = ASPERITY.with_name("asperity-duty")
# The script that draws a scene, and what of that is the figure.
FIGURES = {
    **dict.fromkeys(("04", "05"), (("friction.py", "--si"), "friction", "pressure, film, shear stresses")),
    "01": (("profile.py", "--si", "--window", "-15", "4"), "profile", "pressure and film"),  # inside the journal
    "06": (("transient.py", "--parts", "film_strip"), "film_strip", "the ridge at several places"),
    **dict.fromkeys(("09", "10"), (("dry.py",), "profile", "the profile, undeformed, under load and unloaded")),
    **dict.fromkeys(("18", "19", "20"), (("point.py",), "point", "interferogram, film and pressure")),
}
OVER_TIME = "load, radius or load of asperities, speeds, film, pressure and friction over time"
HISTORY = (("transient.py", "--si", "--parts", "history"), "history", OVER_TIME)
PROFILE = (("profile.py", "--si"), "profile", "pressure and film, of a passage at the last time")
TARGET = 0.03
WIDTH = 128

HEAD = """# Twenty scenes

Contacts as they occur, in [input/scenes/](../input/scenes) and [input/duty/](../input/duty). Each section shows the input, the
closing table, the place on the chart of Moes, and the needs of the model, compared with fine grids. `make scenes` runs the scenes,
omits each ingredient on fine grids, and writes this page from the results and the comments of the inputs.

Inputs are typical values, not measurements of one machine: oils have the viscosity of their ISO class at the given temperature
(ISO 3448: at 40 degrees), alpha 18 to 20 1/GPa, Eyring stresses of 4 to 6 MPa; pressures are design values of bearings and gears,
roughness is that of ground or run-in surfaces.

## Are the verdicts right?

{summary}
`change` is the measured change, on the coarse grids of the program, of the quantity that the fine grids change most, with its error
bar; `fine grids` is the same change on fine grids: passages with half the spacing and half the time step, steady contacts for 2e-4
of h_min, dry profiles on 8 times the nodes with the heights of the scene's grid. Verdicts are at the accuracy of the result. `not
known` is no error, but no answer: the measurement may cost a tenth of the run, and gives no verdict where its error bar is too
large. Without squeeze there are steady solutions with the waves at their places, which no namelist describes: there `fine grids` is
the program's own value on 4 times the nodes and time steps. Rigid bodies are 2000 times as stiff, or less where they have no
solution, which still shows whether elasticity is needed. Where load, speeds or radius change in time, and of point contacts,
error bars are judged, by the change on 2 or 4 times the intervals.

"""


def text_of(*command: object, folder: Path) -> str:
    """What a command prints, which must succeed."""
    done = subprocess.run([str(word) for word in command], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, check=True)
    return done.stdout


def drawn(script: str, *options: object, folder: Path) -> str:
    """What a script of postproc/ prints that leaves a figure in the folder."""
    ends = ("--output", folder, "--format", "png")
    return text_of(sys.executable, ROOT / "postproc" / script, *options, *ends, folder=folder)


def made(command: str, source: Path, folder: Path) -> Path:
    """The namelist that `asperity-duty` writes beside its table in the folder."""
    text_of(DUTY, command, source, "--output", folder, "--force", folder=folder)
    return folder / f"{source.stem}.nml"


def closing_table(printed: str, name: str) -> str:
    """The end of what the program prints, without times of the machine and the name of the result."""
    lines = printed.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(f"{name}.nml: converged"))
    lines[first] = re.sub(r", [\d.E+-]+ s(, [\d.E+-]+ MB)?$", "", lines[first])
    return "\n".join(line for line in lines[first:] if not line.startswith("  result "))


def percent(value: float) -> str:
    """A share in percent; empty where it is not known."""
    return "" if value != value else f"{100 * value:.3g} %"  # noqa: PLR0124


def verdict_table(verdicts: list[tuple[Row, str]]) -> str:
    """The ingredients of one scene."""
    lines = ["| without | verdict | by fine grids | most changed | change | fine grids |", "|---|---|---|---|---|---|"]
    for row, outcome in verdicts:
        told = f"{percent(row.change)} +- {percent(row.error)}" if percent(row.change) else "not known"
        verdict = row.verdict + (" **(other)**" if outcome == "other" else "")
        cells = (row.ingredient, verdict, row.true_verdict, row.quantity.replace("_", " "), told, percent(row.truth))
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def auto_table(path: Path, text: str, folder: Path) -> str:
    """What model = 'auto' decides of a scene for a target of TARGET, and why."""
    lean = folder / f"{path.stem}_auto.nml"
    chosen = re.sub(r"^ *intervals *=.*\n", "", text, flags=re.MULTILINE).replace("   problem =", "   model = 'auto'\n   problem =")
    lean.write_text(f"{chosen}&accuracy\n   target = {TARGET}\n/\n", encoding="utf-8")
    lines = text_of(ASPERITY, lean, "--verbose", "--output", folder, folder=folder).splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("  auto "))
    last = next(i for i, line in enumerate(lines) if i > first and not line.startswith("      "))
    solved = [line.split(": ", 1)[1] for line in lines if line.startswith(f"{lean.name}: solves ")]
    told = "\n".join([f"  {line}" for line in solved] + lines[first:last])
    return f"With `model = 'auto'` and `&accuracy target = {TARGET}`, the grid chosen by the program:\n\n```text\n{told}\n```"


def section(number: int, path: Path, source: Path, verdicts: list[tuple[Row, str]], folder: Path) -> str:
    """The part of the page about one scene: a namelist, and the file from which it is made, if not itself."""
    text, name, is_history = source.read_text(encoding="utf-8"), path.stem, source.parent.name == "duty"
    title = re.search(r"title = ['\"](.*)['\"]", text)[1]
    comment = " ".join(line[2:] for line in text.splitlines() if line.startswith(("! ", "# ")))
    printed = text_of(ASPERITY, path, "--output", folder, folder=folder)
    (script, *options), kind, words = HISTORY if is_history else FIGURES.get(name[:2], PROFILE)
    drawn(script, folder / f"{name}.h5", *options, folder=folder)
    IMAGES.mkdir(parents=True, exist_ok=True)
    shutil.copy(folder / f"{name}_{kind}.png", IMAGES / f"{name}.png")
    parts = [f"## {number:02d} {title}", "\n".join(textwrap.wrap(comment, WIDTH)), f"![{title}: {words}](images/scenes/{name}.png)"]
    if is_film := "ehl_line" in text and not is_history:
        regime = drawn("regime.py", folder / f"{name}.h5", folder=folder).splitlines()[0].split(": ", 1)[1]
        parts.append("\n".join(textwrap.wrap(f"On the chart of Moes: {regime}.", WIDTH)))
    own = [pair for pair in verdicts if pair[0].scene == name]
    code = "\n".join(line for line in text.splitlines() if not line.startswith(("! ", "# ")))
    place, language = source.relative_to(ROOT), "toml" if source != path else "fortran"
    parts += [f"[{place}](../{place}):", f"```{language}\n{code}\n```", f"```text\n{closing_table(printed, name)}\n```"]
    if source != path:
        told = text_of(DUTY, "cam" if "[cam]" in text else "gear", source, "--result", folder / f"{name}.h5", folder=folder)
        parts.append(f"```text\n{told.rstrip()}\n```")
    has_target = is_film and "&supply" not in text
    return "\n\n".join([*parts, verdict_table(own), *([auto_table(path, text, folder)] if has_target else [])]) + "\n"


def write_page(sources: dict[int, tuple[Path, Path]], verdicts: list[tuple[Row, str]], summary: str, results: Path) -> Path:
    """Writes the page from the rows of bench/scenes.py with their outcomes, and runs of the program."""
    sections = [section(number, *pair, verdicts, results) for number, pair in sorted(sources.items())]
    PAGE.write_text(HEAD.format(summary=summary) + "\n".join(sections), encoding="utf-8")
    return PAGE

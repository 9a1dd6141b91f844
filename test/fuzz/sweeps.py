"""Sweeps: odd sweep files, indices, results and tables that are none."""

import os
import random
import sys
from pathlib import Path

import h5py
import numpy as np
from cases import BASE, BATCH, damaged
from height_files import make
from run import Run, attack, call

SWEEP = 'title = "T"\nbase = "base.nml"\ntogether = ["case.title", "u"]\n[vary]\ncase.title = ["1_0", "b"]\n'
SWEEP += 'u = { values = [1, 2.5], unit = "m" }\nload.hertz_pressure = { from = 4e8, to = 5e8, count = 2, spacing = "log" }\n'
SWEEP += '[set]\ndomain.intervals = 256\n[formula]\nv = "u*sqrt(2)"\nbodies.speed_1 = "0.1*v"\n[plot]\nx = "u"\ny = ["v"]\n'
# Right and wrong values between bars; keys and names with blanks between them.
VALUES_TEXT = r"""[1, 2] | 1 | nan | [inf] | [] | {} | [[1], [2, 3]] | [[[1]]] | 2024-01-01 | [07:32:00] | ["a", 1] | true
| "\u0000" | ["a\nb"] | [1e999] | [-0.0, 0.0] | { from = 1, to = 2, count = 2 } | { values = [1], unit = 'm] [' }
| { from = -1e308, to = 1e308, count = 3 } | { from = 1, to = 1e-320, count = 2, spacing = 'log' }"""
VALUES = [value.strip() for value in VALUES_TEXT.split("|")]
VALUES += ["[" * 5000, "[" * 5000 + "]" * 5000, "9" * 400, f"[{'9' * 6000}]", f"{{ from = 1, to = {'9' * 400}, count = 3 }}"]
KEYS = """u vary.u pi load.hertz_pressure load base sample together plot.y plot.log formula.w set.u a.b.c.d leave_out
sample.count title 'x' 'µ' _start_index.u case._start_index unit from"""


def script(program: Path, folder: Path, name: str, *arguments: str) -> Run:
    environment = {**os.environ, "ASPERITY": str(program), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "agg"}
    return call(Path(sys.executable), folder, str(BATCH / name), *arguments, env=environment)


def broken(run: Run, *statuses: int) -> str | None:
    """A hang, a traceback, another status than one of `statuses`."""
    if "Traceback" in run.err or run.status not in statuses:
        return run.trouble() or f"status {run.status}: {run.err.strip()[-300:]}"
    return "a refusal without words" if run.status == 1 and ".py: " not in run.err else None


def sweep(program: Path, folder: Path, text: str | bytes) -> str | None:
    """What broke in a call of sweep.py: its status, or a refusal that left something."""
    (folder / "base.nml").write_bytes(BASE.encode())
    (folder / "small.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    run = script(program, folder, "sweep.py", "small.toml")
    left = [path.name for path in folder.iterdir() if path.name not in {"base.nml", "small.toml"}]
    return f"refused, and left {left}" if run.status == 1 and left else broken(run, 0, 1)


def sweep_files(program: Path, source: random.Random, folder: Path) -> str | None:
    """A sweep file with damaged bytes, or with entries that do not belong there."""
    if source.random() < 0.4:
        return sweep(program, folder, damaged(SWEEP.encode(), source))
    lines = SWEEP.splitlines()
    for _ in range(source.choice([1, 1, 2, 3])):
        key = source.choice([*KEYS.split(), "u" + ".u" * 6000])
        lines.insert(source.randrange(len(lines) + 1), f"{key} = {source.choice(VALUES)}")
    return sweep(program, folder, "\n".join(lines) + "\n")


def places(program: Path, source: random.Random, folder: Path) -> str | None:
    """Things in the folder of a sweep that are no files, or a damaged index: rows with a reason, or one line."""
    if found := sweep(program, folder, SWEEP):
        return found
    small = folder / "small"
    (small / "log").mkdir()
    targets = [*(small / "cases" / f"case_000{i}.{ending}" for i in (1, 2) for ending in ("h5", "nml")), small / "log" / "a.csv"]
    targets += [small / "index.csv", small / "sweep.toml"]
    is_index = source.random() < 0.4
    for path in source.sample(targets, source.choice([0, 1, 2]) if is_index else source.choice([1, 2, 3])):
        path.unlink(missing_ok=True)
        if (kind := source.choice(["pipe", "folder", "circle", "nowhere", "device", "empty", "text"])) == "device":
            path.symlink_to("/dev/null")
        else:
            make(kind, path)
    if is_index and (small / "index.csv").is_file():
        (small / "index.csv").write_bytes(damaged((small / "index.csv").read_bytes(), source))
    return broken(script(program, folder, "gather.py", "small"), 0, 1)


PLOTS = """x = "u"\ny = "h_min" | x = "u"\ny = [1] | x = "v"\ny = ["h_min"]\nlog = [["x"]] | x = "u"\ny = "v"\nlog = ["x", "y"]
| x = "u"\ny = ["h_min"]\ncolour = "v"\nkind = "map" | x = "u"\ny = ["v"]\nfacet = "case"\ncolour = "status" """


def tables(program: Path, source: random.Random, folder: Path) -> str | None:
    """A picture of a table with columns of another shape or kind, or with damaged bytes."""
    with h5py.File(folder / "gathered.h5", "w", track_order=True) as file:
        file["case"] = [f"case_{i}" for i in range(4)]
        file["u"], file["v"] = np.arange(4.0), np.arange(4.0) ** 2
        file["status"] = ["done"] * 4
        file["h_min"], file["h_min_error"] = np.ones(4), np.full(4, 0.1)
        odd = [np.ones((4, 2)), np.ones(3), np.float64(1), np.array(["a"] * 4, dtype=object), np.full(4, np.nan)]
        odd += [np.zeros(4, "f8,i4"), np.zeros(4, complex), np.ones(4, bool), np.full(4, 2**62), np.ones((4, 0))]
        odd += [np.array([b"\xff"] * 4), np.full(4, 1e308)]
        for name in source.sample(list(file), source.choice([0, 1, 2])):
            del file[name]
            if (values := source.choice([None, *odd])) is not None:
                file[name] = values
        plots = [f"[plot]\n{plot.strip()}\n" for plot in PLOTS.split("|")]
        file.attrs["sweep"] = source.choice([*plots, "plot = 3", "sample = 1", "x = '\u2028'", "["])
    if source.random() < 0.3:
        content = (folder / "gathered.h5").read_bytes()
        (folder / "gathered.h5").write_bytes(damaged(content, source))
    return broken(script(program, folder, "plot.py", "gathered.h5", "--format", "png"), 0, 1)


@attack("sweeps: TOML, indices, pipes for results, tables of figures", 300, quick=7)
def sweeps(program: Path, source: random.Random, folder: Path) -> str | None:
    return source.choice([sweep_files, places, tables])(program, source, folder)

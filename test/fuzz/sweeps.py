"""Sweeps: odd sweep files, bases and names, indices, results and tables that are none, `--replace` that is ended at any moment."""

import csv
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import f90nml
import h5py
import numpy as np
from cases import BASE, BATCH, damaged
from height_files import make
from run import Run, attack, call

HEAD = 'base = "base.nml"\n[vary]\n'
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
NAMES = """slip pi Pi min lambda None True e E program Status case reason h_min h_min_error nan summary_h_min limits_passed x1 J
µx aµ aμ größe sqrt inf step units title report_cycles scaling_ validity_x error_ k_error"""
# Ends itself by a signal, or by a full disk, at the file operation of that number.
ENDING = """import errno, os, signal, sys
path, step, end = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
sys.path.insert(0, path)
import sweep
called = 0
def counted(operation):
    def act(*arguments, **options):
        global called
        called += 1
        if called == step and end:
            os.kill(os.getpid(), end)
        elif called == step:
            raise OSError(errno.ENOSPC, "no room", str(arguments[0]))
        return operation(*arguments, **options)
    return act
for name in ("mkdir", "rename", "replace", "rmdir", "unlink"):
    setattr(os, name, counted(getattr(os, name)))
sys.exit(sweep.main(sys.argv[4:]))
"""


def script(program: Path, folder: Path, name: str, *arguments: str) -> Run:
    environment = {**os.environ, "ASPERITY": str(program), "PYTHONDONTWRITEBYTECODE": "1", "MPLBACKEND": "agg"}
    return call(Path(sys.executable), folder, str(BATCH / name), *arguments, env=environment)


def broken(run: Run, *statuses: int) -> str | None:
    """A hang, a traceback, another status than one of `statuses`."""
    if "Traceback" in run.err or run.status not in statuses:
        return run.trouble() or f"status {run.status}: {run.err.strip()[-300:]}"
    return "a refusal without words" if run.status == 1 and ".py: " not in run.err else None


def sweep(program: Path, folder: Path, text: str | bytes, base: bytes = BASE.encode(), *options: str) -> tuple[Run, str | None]:
    """Calls sweep.py; also what broke: status, or a refusal that left something."""
    (folder / "base.nml").write_bytes(base)
    (folder / "small.toml").write_bytes(text if isinstance(text, bytes) else text.encode())
    run = script(program, folder, "sweep.py", "small.toml", *options)
    left = [path.name for path in folder.iterdir() if path.name not in {"base.nml", "small.toml"}]
    if run.status == 1 and left and not options:
        return run, f"refused, and left {left}"
    return run, broken(run, 0, 1)


def sweep_files(program: Path, source: random.Random, folder: Path) -> str | None:
    """A sweep file with damaged bytes, or with entries that do not belong there."""
    if source.random() < 0.4:
        return sweep(program, folder, damaged(SWEEP.encode(), source))[1]
    lines = SWEEP.splitlines()
    for _ in range(source.choice([1, 1, 2, 3])):
        key = source.choice([*KEYS.split(), "u" + ".u" * 6000])
        lines.insert(source.randrange(len(lines) + 1), f"{key} = {source.choice(VALUES)}")
    return sweep(program, folder, "\n".join(lines) + "\n")[1]


def own_names(program: Path, source: random.Random, folder: Path) -> str | None:
    """A parameter of any name is refused, or is what formulas, index and table take it for."""
    name, values = source.choice(NAMES.split()), [source.uniform(1, 9) for _ in range(3)]
    run, found = sweep(program, folder, HEAD + f'"{name}" = {values}\n[formula]\nbodies.speed_1 = "{name}*0.01"\n')
    if found or run.status == 1:
        return found or (None if f"found the name {name}" in run.err else f"refused for another reason: {run.err}")
    gathered = script(program, folder, "gather.py", "small")
    if found := broken(gathered, 0):
        return found
    with (folder / "small" / "gathered.csv").open(encoding="utf-8", newline="") as file:
        columns = [row.get(name) for row in csv.DictReader(file)]
    speeds = [f90nml.read(folder / "small" / "cases" / f"case_000{i}.nml")["bodies"]["speed_1"] for i in (1, 2, 3)]
    is_right = columns == [repr(value) for value in values] and np.allclose(speeds, [value * 0.01 for value in values], rtol=1e-14)
    return None if is_right else f"{name}: {values} became {columns}, {speeds}"


def bases(program: Path, source: random.Random, folder: Path) -> str | None:
    """A base in any encoding with any line ends: all of it, or told by the name of the encoding."""
    surface = "&surface_1\nshape = 'sinusoid'\n{}\nwavelength = 1e-4, 2e-4 ! \u00d6l / &\n/\n"
    surface += "&time transient = .true., end_time = 1.0, time_step = 0.1 /\n"
    lists = ["amplitude = 1e-7, 2e-7", "amplitude(1) = 1e-7\namplitude(2) = 2e-7", "amplitude(2) = 2e-7 amplitude(1) = 1e-7"]
    text = source.choice([BASE + surface, surface + BASE]).format(source.choice(lists))
    ends = [source.choice(["\r", "\n", "\r\n"]) for _ in range(2)]
    text = "".join(line + source.choice(ends) for line in text.split("\n"))
    encoding = source.choice(["utf-8", "utf-8-sig", "utf-8-sig", "utf-16", "utf-32", "utf-16-be", "latin-1"])
    run, found = sweep(program, folder, HEAD + "load.hertz_pressure = [4e8, 5e8]\n", text.encode(encoding))
    if found:
        return found
    if not encoding.startswith("utf-8"):
        words = {"utf-16": "found UTF-16", "utf-32": "found UTF-32", "latin-1": "found the byte 0xD6"}.get(encoding, "UTF-16")
        return None if run.status == 1 and words in run.err else f"{encoding}: status {run.status}: {run.err}"
    if run.status != 0:
        return f"{encoding} refused: {run.err}"
    groups = f90nml.read(folder / "small" / "cases" / "case_0002.nml")
    expected = f90nml.reads((BASE + surface).format(lists[0]))
    expected["load"]["hertz_pressure"] = 5e8
    return None if dict(groups.todict()) == dict(expected.todict()) else f"{encoding}, {ends}: {groups}"


def places(program: Path, source: random.Random, folder: Path) -> str | None:
    """Things in the folder of a sweep that are no files, or a damaged index: rows with a reason, or one line."""
    _, found = sweep(program, folder, SWEEP)
    if found:
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


def state(small: Path) -> dict[str, bytes]:
    kept = (path for path in small.rglob("*") if path.suffix in {".csv", ".toml", ".nml"})
    return {str(path.relative_to(small)): path.read_bytes() for path in kept}


def replacements(program: Path, source: random.Random, folder: Path) -> str | None:
    """--replace that is ended by a signal or a full disk, at a file operation or at any moment, then given again."""
    states = {}
    for name in ("old", "new"):
        text = HEAD + f"load.hertz_pressure = {sorted({source.randrange(3, 9) * 1e8 for _ in range(6)})}\n"
        if found := sweep(program, folder, text, BASE.encode(), "--output", name)[1]:
            return found
        states[name] = state(folder / name)
    small = folder / "old"
    results = [small / "cases" / f"case_000{i}.h5" for i in (1, 2, 3, 4)]
    for result in results:
        result.write_text(result.name, encoding="utf-8")
    arguments = ["small.toml", "--output", "old", "--replace", "--program", str(program)]
    if found := end_at_random(source, folder, arguments) or what_is_left(small, states):
        return found
    again = script(program, folder, "sweep.py", *arguments)
    lost = [path.name for path in results if not path.exists() or path.read_text(encoding="utf-8") != path.name]
    left = [str(path.relative_to(folder)) for path in folder.rglob("*.part")]
    if lost or left or state(small) != states["new"]:
        return f"lost {lost}, left {left}, {sorted(state(small))}: {again.err}"
    return broken(again, 0)


def end_at_random(source: random.Random, folder: Path, arguments: list[str]) -> str | None:
    """Calls sweep.py and ends it; what broke."""
    end = source.choice([0, signal.SIGKILL, signal.SIGKILL, signal.SIGINT])
    step = source.randrange(1, 25) if source.random() < 0.7 else 1000
    command = [sys.executable, "-c", ENDING, str(BATCH), str(step), str(int(end)), *arguments]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        if step == 1000:
            time.sleep(source.uniform(0, 1.5))
            process.send_signal(end or signal.SIGINT)
        err = process.communicate()[1]
    # Ctrl-C while Python loads its modules is Python's own business
    return f"traceback: {err[-300:]}" if "Traceback" in err and "sweep.main" in err else None


def what_is_left(small: Path, states: dict[str, dict[str, bytes]]) -> str | None:
    """The old or the new sweep must be there, or the old one with the new one ready."""
    found = state(small)
    if found.get("index.csv") not in [wanted["index.csv"] for wanted in states.values()]:
        return "no index"
    is_ready = (small / "replacement.part" / "index.csv").exists()
    return None if is_ready or any(wanted.items() <= found.items() for wanted in states.values()) else "a mixture of two sweeps"


TITLE = "sweeps: TOML, names, bases by encoding, indices, pipes for results, tables of figures, `--replace` ended at any moment"


@attack(TITLE, 300, quick=7)
def sweeps(program: Path, source: random.Random, folder: Path) -> str | None:
    kinds = [sweep_files, sweep_files, own_names, bases, places, tables, replacements, replacements]
    return source.choice(kinds)(program, source, folder)

#!/usr/bin/env python3
"""Compares everything that a program makes of small cases with what is stored: a net for changes that must change nothing.

    golden.py [--program PATH] [--store] [--count] [--first] [NAME ...]

All data sets and attributes of results, what is printed, exit statuses: texts to the letter, numbers to 1e-12. Of long arrays
a few sums are stored. Clocks, memory and versions are left out. What is stored is of one compiler, its default flags and one
processor: elsewhere round-off differs, and --store comes before the change. A change that is meant is stored with --store, and
the difference printed before belongs into the message of the commit. With --count valgrind counts the instructions of some
cases, as shares of the stored ones: all below 1.03 pass.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shlex
import signal
import subprocess
import sys
import tempfile
import time

import numpy as np
from cases import contents
from golden_cases import COUNTED, HEIGHTS, MORE, ONE

HERE = pathlib.Path(__file__).resolve().parent

STORED = HERE / "data" / "golden.json"
COUNTS = HERE / "data" / "instructions.json"
MOST_INSTRUCTIONS = 1.03
PROCESSOR_SECONDS = 60
TOLERANCE = 1e-12
# Longest array whose values are stored one by one.
FEW = 6
# Most printed lines that are stored one by one.
MANY = 60
# What depends on the machine or the day, not on the case.
LEFT_OUT = re.compile(r"seconds|memory|@git_commit|@version|program_")
# Distances from an exact solution, dimensionless: round-off is part of them.
ROUND_OFF = re.compile(r"report/(residual|load_error)")
ROUND_OFF_BOUND = 1e-11
DURATION = re.compile(r"\b[0-9.]+(E[-+]\d+)? (ms|s|min|h|d|kB|MB|GB)\b( \d+ (s|min|h))?")


def printed(text, folder):
    """What is printed, without clocks, places, and lines that appear only if it takes long."""
    text = text.replace(str(folder), "")
    late = r": (cycle|step|time step) \d+ .*|\bleft$|version|x \d+ step (?!(1|2|4|8|16|32|64|128) )"
    lines = [line for line in text.splitlines() if not re.search(late, line)]
    return [DURATION.sub("TIME", line.rstrip()) for line in lines]


def summary(value):
    """A value as it is stored: text, few numbers, or sums over many."""
    array = np.asarray(value)
    if array.dtype.kind in "SOU":
        text = "\n".join(v.decode("utf-8") if isinstance(v, bytes) else str(v) for v in np.ravel(array))
        return text if len(text) < 80 else "md5 " + hashlib.md5(text.encode()).hexdigest()
    kind = f"{array.dtype.str[1:]}{list(array.shape)}" if array.shape else array.dtype.str[1:]
    if array.dtype.kind in "V":
        return f"{kind} {array}"
    numbers = array.astype(float).ravel()
    if numbers.size > FEW:
        known = numbers[np.isfinite(numbers)]
        waves = np.cos(np.outer([0.7, 1.9], np.arange(known.size)))
        size = np.abs(known).sum()
        numbers = [known.size, known.min(initial=np.inf), known.max(initial=-np.inf), size, *(waves @ known)]
    return [kind, *(float(f"{number:.13g}") for number in numbers)]


def same(path, old, new):
    if not (isinstance(old, list) and isinstance(new, list)):
        return old == new
    if len(old) != len(new) or old[0] != new[0]:
        return False
    first, second = np.array(old[1:], float), np.array(new[1:], float)
    bound = TOLERANCE * np.nanmax(np.abs(first), initial=0.0)
    shape = re.search(r"\[.*\]", old[0])
    if shape and np.prod(json.loads(shape[0])) > FEW:
        extreme, size = np.abs(first[1:3]).max(), first[3]
        bound = TOLERANCE * np.array([0.0, extreme, extreme, size, size, size])
    if ROUND_OFF.search(path):
        bound = ROUND_OFF_BOUND
    return bool(np.all((first == second) | (np.isnan(first) & np.isnan(second)) | (np.abs(first - second) <= bound)))


def stop(program, folder, name):
    """Runs a case and ends it by SIGTERM after its first checkpoint."""
    running = subprocess.Popen([program, name, "--quiet"], cwd=folder, stderr=subprocess.PIPE)
    checkpoint = (folder / name).with_suffix(".h5.ckpt")
    while running.poll() is None and not checkpoint.exists():
        time.sleep(0.001)
    running.send_signal(signal.SIGTERM)
    running.communicate()
    return {"status": running.returncode}


def run(program, folder, command):
    if command.startswith("stop "):
        return stop(program, folder, command.removeprefix("stop "))
    names = {"asperity": program, "python": sys.executable}
    calls = [f'{name}() {{ {shlex.quote(path)} "$@"; }}' for name, path in names.items()]
    script = "\n".join([f"ulimit -t {PROCESSOR_SECONDS}", *calls, command])
    done = subprocess.run(["sh", "-c", script], cwd=folder, capture_output=True, text=True, check=False)
    return {
        "status": done.returncode,
        "out": printed(done.stdout, folder),
        "err": printed(done.stderr, folder),
    }


def outcome(program, name):
    """Everything that a case leaves: texts and statuses by step, and its files."""
    files, steps = MORE.get(name) or ({f"{name}.nml": ONE[name]}, [f"asperity {name}.nml --verbose"])
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place).resolve()
        for file, text in (files | HEIGHTS).items():
            (folder / file).write_bytes(text.encode("utf-8"))
        found = {step: run(program, folder, step) for step in steps}
        for path in sorted(folder.rglob("*")):
            relative = str(path.relative_to(folder))
            if path.suffix == ".h5":
                found[relative] = {key: summary(v) for key, v in contents(path).items() if not LEFT_OUT.search(key)}
            elif path.is_file() and relative not in files | HEIGHTS:
                found[relative] = {"text": hashlib.md5(path.read_bytes()).hexdigest()}
    return found


def flat(name, tree):
    """A case as {path: value}; printed lines one by one, unless there are very many."""
    found = {}
    for step, values in tree.items():
        file = step.replace(name, "NAME")
        for key, value in values.items():
            path = f"{file}: {key}"
            if not isinstance(value, list) or key not in ("out", "err"):
                found[path] = value
            elif len(value) > MANY:
                found[path] = summary("\n".join(value))
            else:
                found |= {f"{path} line {number}": line for number, line in enumerate(value, 1)}
    return found


def differences(old, new):
    return [
        f"{path}: {old.get(path, 'not there')} -> {new.get(path, 'not there')}"
        for path in sorted(old.keys() | new.keys())
        if path not in old or path not in new or not same(path, old[path], new[path])
    ]


def read():
    """The stored cases {name: {path: value}}. The file has a line for each path, with its values and their cases."""
    cases = {}
    if STORED.exists():
        for path, values in json.loads(STORED.read_text(encoding="utf-8")).items():
            for value, names in values:
                for name in names.split():
                    cases.setdefault(name, {})[path] = value
    return cases


def write(cases):
    """Stores cases: most values are the same in many."""
    paths = {}
    for name, values in cases.items():
        for path, value in values.items():
            paths.setdefault(path, {}).setdefault(json.dumps(value, ensure_ascii=False), []).append(name)
    lines = [
        f"{json.dumps(path)}: [" + ", ".join(f'[{value}, "{" ".join(names)}"]' for value, names in sorted(values.items())) + "]"
        for path, values in sorted(paths.items())
    ]
    STORED.write_text("{" + ",\n".join(lines) + "}\n", encoding="utf-8")


def instructions(program, name):
    with tempfile.TemporaryDirectory() as place:
        path = pathlib.Path(place) / f"{name}.nml"
        path.write_text(ONE[name], encoding="utf-8")
        command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=counts", program, path.name, "--quiet"]
        subprocess.run(command, cwd=place, capture_output=True, check=True)
        return int(re.search(r"^(?:summary|totals): (\d+)", (path.parent / "counts").read_text(encoding="utf-8"), re.M)[1])


def count(program, store):
    stored = json.loads(COUNTS.read_text(encoding="utf-8")) if COUNTS.exists() else {}
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = dict(zip(COUNTED, pool.map(lambda name: instructions(program, name), COUNTED), strict=True))
    failed = 0
    for name, number in found.items():
        share = number / stored.get(name, number)
        failed += share > MOST_INSTRUCTIONS
        print(f"{name:12} {number / 1e6:8.1f} M instructions, {share:.3f} of the stored")
    if store:
        COUNTS.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return failed


def main():
    np.seterr(over="ignore", invalid="ignore")  # sums of numbers as large as there are
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=os.environ.get("ASPERITY", "build/bin/asperity"))
    parser.add_argument("--store", action="store_true", help="keep what the program makes today")
    parser.add_argument("--count", action="store_true", help="count instructions instead")
    parser.add_argument("--first", action="store_true", help="end at the first case that differs")
    parser.add_argument("--most", type=int, default=12, help="lines printed for a case")
    parser.add_argument("names", nargs="*", help="cases; without one all")
    chosen = parser.parse_args()
    program = str(pathlib.Path(chosen.program).resolve())
    if chosen.count:
        failed = count(program, chosen.store)
        print(f"{len(COUNTED) - failed} passed, {failed} failed")
        return 1 if failed else 0
    stored = read()
    names = chosen.names or [*ONE, *MORE]
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count(), "", np.seterr, (None, None, "ignore", None, "ignore")) as pool:
        for name, found in zip(names, pool.map(lambda name: flat(name, outcome(program, name)), names), strict=True):
            lines = differences(stored.get(name, {}), found)
            stored[name] = found
            failed += bool(lines)
            if lines:
                print(f"{name}: {len(lines)} differences", *lines[: chosen.most], sep="\n  ", flush=True)
            if lines and chosen.first:
                pool.shutdown(cancel_futures=True)
                break
    if chosen.store:
        write({name: stored[name] for name in [*ONE, *MORE]})
        print(f"stored {len(names)} cases")
        return 0
    print(f"{len(names) - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

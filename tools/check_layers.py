#!/usr/bin/env python3
"""Check the order of the layers by the `use` lines: a module uses only its own layer and those to its left.

    base -> physics -> numerics -> surface -> film -> stokes -> dry -> accuracy -> point -> system -> hdf5 -> heights -> input
    -> output -> app

physics and numerics do not use each other, nor dry and film or stokes. Every module lies in a layer
folder and has the name of its file.
Prints `file:line: what is wrong`; exit status 1 if anything is.
"""

import pathlib
import re
import sys

LAYERS = [
    *("base", "physics", "numerics", "surface", "film", "stokes", "dry", "accuracy", "point"),
    *("system", "hdf5", "heights", "input", "output", "app"),
]
STRANGERS = {("numerics", "physics"), ("dry", "film"), ("dry", "stokes")}
ROOT = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")


def layer_of(path):
    """The layer folder of a source file: src/LAYER/file.f90 or app/file.f90."""
    parts = path.relative_to(ROOT).parts
    return "app" if parts[0] == "app" else parts[1]


def main():
    """Check every Fortran file under src/ and app/."""
    paths = sorted([*ROOT.glob("src/**/*.f90"), *ROOT.glob("app/**/*.f90")])
    layers = {path.stem: layer_of(path) for path in paths}
    findings = [] if paths else ["no source files found"]
    for path in paths:
        own = layer_of(path)
        if own not in LAYERS:
            findings.append(f"{path}:1: lies in no layer folder ({', '.join(LAYERS)})")
            continue
        for number, line in enumerate(path.read_text(encoding="utf-8").lower().splitlines(), 1):
            module = re.match(r"\s*module\s+(\w+)\s*$", line)
            if module and module[1] not in {path.stem, "procedure"}:
                findings.append(f"{path}:{number}: module {module[1]} must have the name of its file")
            used = re.match(r"\s*use\b\s*(?:::)?\s*(\w+)", line)
            other = layers.get(used[1]) if used else None
            if other not in LAYERS:
                continue  # not a module of ours, or reported with its own file
            if LAYERS.index(other) > LAYERS.index(own) or (own, other) in STRANGERS:
                findings.append(f"{path}:{number}: {own} must not use {used[1]} of {other}")
    sys.stdout.writelines(f"{finding}\n" for finding in findings)
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())

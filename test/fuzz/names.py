"""Files that are none: pipes, devices, folders, sockets, links that lead nowhere or in circles, odd names."""

import os
import random
import socket
from pathlib import Path

from run import call
from surfaces import CASES as TEXTS

TITLE = "names: pipes, devices, folders, sockets, links, odd characters"
CASES = 160

ENDINGS = [".csv", ".h5", ".hdf5", "", ".CSV", ".H5", ".txt"]
DEVICES = [
    *("/dev/zero", "/dev/null", "/dev/full", "/dev/random", "/dev/tty"),
    *("/dev/stdin", "/proc/self/mem", "/proc/kmsg", "/sys", "/"),
]
ODD = ["", " ", "..", ".", "a" * 300, "a" * 5000, "~", "*", "$HOME", "z\tz", "\u00e4", "-", "z\\n", "/" * 50, "a/b/c"]


def make(kind: str, path: Path) -> None:
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    elif kind == "socket":
        with socket.socket(socket.AF_UNIX) as end:
            end.bind(os.path.relpath(path))
    elif kind == "circle":
        path.symlink_to(path.name)
    elif kind == "nowhere":
        path.symlink_to("nothing")
    elif kind == "device":
        path.symlink_to("/dev/zero")
    elif kind == "empty":
        path.touch()
    else:
        path.write_bytes(b"x,z\n")


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    kind = source.choice(["pipe", "folder", "socket", "circle", "nowhere", "device", "empty", "header", "special", "odd"])
    name = "z" + source.choice(ENDINGS)
    here = Path.cwd()
    os.chdir(folder)
    try:
        if kind == "special":
            name = source.choice(DEVICES)
        elif kind == "odd":
            name = source.choice(ODD) + source.choice(ENDINGS)
        else:
            make(kind, folder / name)
    finally:
        os.chdir(here)
    if source.random() < 0.3 and not name.startswith("-"):
        run = call(program, folder, "--check", name)
        wanted = name[:40]
    else:
        text = TEXTS[source.choice(["line", "area", "oil"])].format(file=name.replace("'", "''"), more=", dataset = 'z'")
        (folder / "case.nml").write_text(text, encoding="utf-8")
        run = call(program, folder, "case.nml", "--quiet")
        wanted = "case.nml:"
    if run.trouble():
        return run.trouble()
    if run.status != 1:
        return f"{name[:60]!r} taken, status {run.status}"
    is_named = wanted in run.err or "more than 4096 characters" in run.err
    return None if is_named else f"no name in the message: {run.err.strip()[-200:]}"

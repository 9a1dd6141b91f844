"""Random cases of the Python package: what each gives is what the program gives for the same values, or findings."""

import datetime
import functools
import os
import random
import sys
import tempfile
from collections import deque
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import f90nml
import numpy as np
from run import ROOT, call

sys.path.append(str(ROOT / "python"))

import asperity

TITLE = "Python cases: dictionaries, texts, paths; types of values, names, folders, byte order marks, line ends"
CASES = 400
HEIGHTS = "x_m,z_m\n" + "".join(f"{i * 1e-5:.5f},{1e-7 * (i % 4):.2e}\n" for i in range(64))
GROUPS = {
    "case": {"problem": "dry_line"},
    "bodies": {"reduced_modulus": 230e9},
    "load": {"mean_pressure": [1e7, 2e7]},
    "surface_1": {"shape": "file", "file": "h.csv", "detrend": "mean"},
    "output": {"adequacy": False},
    "accuracy": {"error_bars": False},
}
LETTERS = [*"ab &'\"\\!=#%,(ö\u00a0\U0001f600;$-", "file = 'x'", ".nml"]
BAD = [
    *(None, datetime.date(2026, 1, 2), 1j, float("nan"), float("inf"), b"x", {1}, {"a": 1}, [], [[1]], object(), 10**400, "\ud800"),
    *(np.datetime64(1, "ns"), np.timedelta64(1, "s"), np.ones((2, 2)), Decimal("NaN"), [None], float, np.complex128(1)),
]  # fmt: skip
NUMBERS = [float, np.float64, lambda x: Decimal(repr(x)), Fraction, np.array, np.longdouble, lambda x: [x], lambda x: (x,)]
LISTS = [list, tuple, np.array, deque, lambda x: [Decimal(repr(y)) for y in x], lambda x: [np.float64(y) for y in x]]


def word(source: random.Random) -> str:
    return "x" + "".join(source.choices(LETTERS, k=source.randint(0, 6))) + "y"


@functools.cache
def expected(program: Path) -> np.ndarray:
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "h.csv").write_text(HEIGHTS, encoding="utf-8")
        f90nml.Namelist(GROUPS).write(Path(name) / "case.nml")
        run = call(program, Path(name), "case.nml", "--quiet")
        assert run.status == 0, run.err
        return asperity.read(Path(name) / "case.h5").pressure.values


def dictionary(groups: dict, source: random.Random) -> dict:
    """The same values as other types, the same names in other letters."""
    case = {}
    for group, keys in groups.items():
        own = case.setdefault(source.choice([str.upper, str.lower, str.title])(group), {})
        for key, value in keys.items():
            new = value
            if isinstance(value, bool):
                new = source.choice([bool, np.bool_])(value)
            elif isinstance(value, float):
                new = source.choice(NUMBERS)(value)
            elif isinstance(value, list):
                new = source.choice(LISTS)(value)
            elif key == "file":
                new = source.choice([str, Path, np.str_, os.path.abspath])(value)
            own[source.choice([str.upper, str.lower])(key)] = new
    return case


def text(groups: dict, source: random.Random) -> str:
    def written(value: object) -> str:
        if isinstance(value, str):
            return "'" + value.replace("'", "''") + "'"
        return ", ".join(map(written, value)) if isinstance(value, list) else {False: ".false."}.get(value, repr(value))

    lines = [
        f"&{group}\n" + "".join(f"  {key} = {written(value)}\n" for key, value in keys.items()) + "/\n"
        for group, keys in groups.items()
    ]
    return source.choice(["", "\ufeff"]) + "! a comment\n".join(lines).replace("\n", source.choice(["\n", "\r\n", "\r"]))


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    before, own = Path.cwd(), os.environ.get("ASPERITY")
    here = folder / word(source)
    here.mkdir()
    (here / "h.csv").write_text(HEIGHTS, encoding="utf-8")
    os.environ["ASPERITY"] = str(program)
    os.chdir(here)
    try:
        return wrong(program, source, here)
    except Exception as error:  # whatever it is
        return f"{type(error).__name__}: {error!s:.200}"
    finally:
        os.chdir(before)
        os.environ["ASPERITY"] = own or str(program)


def wrong(program: Path, source: random.Random, here: Path) -> str | None:
    """What is wrong with one case."""
    title = word(source)
    groups = GROUPS | {"case": {"problem": "dry_line", "title": title}}
    if source.random() < 0.2:
        groups["case"]["output"] = "sub/" + word(source) + ".h5"
    kind = source.choice(["dictionary", "dictionary", "namelist", "text", "path", "bad"])
    target = source.choice([None, here, here / f"results {word(source)}"])
    if kind == "bad":
        return not_refused(dictionary(groups, source), source)
    case = {"dictionary": dictionary, "namelist": lambda case, _: f90nml.Namelist(case), "text": text, "path": text}[kind](
        groups, source
    )
    if kind == "path":
        path = here / (word(source) + source.choice(["", ".nml"]))
        path.write_bytes(case.replace("\r\n", "\n").replace("\r", "\n").replace("\n", source.choice(["\n", "\r\n"])).encode())
        case = source.choice([path, str(path), path.name])
    if asperity.check(case):
        return f"findings of a good case: {asperity.check(case)}"
    first = asperity.run(case, folder=target)
    other = asperity.run(dictionary(GROUPS | {"load": {"mean_pressure": [3e7]}}, source), folder=target)
    if first.title != title or not np.array_equal(first.pressure, expected(program)):
        return f"{kind}: another case: title {first.title!r} for {title!r}"
    return None if abs(float(other.pressure.mean()) / 3e7 - 1) < 1e-9 else "the result of another case"


def not_refused(case: dict, source: random.Random) -> str | None:
    """A case with one bad value or name: findings, by check and run alike, that name the place."""
    group = source.choice(list(case))
    key = source.choice(list(case[group]))
    kind = source.choice(["value", "value", "value", "key", "group", "keys", "twice"])
    value = source.choice(BAD)
    changes = {
        "value": {group: case[group] | {key: value}},
        "key": {group: case[group] | {source.choice([1, "", "a b", "x/ &load", "é"]): 1.0}},
        "group": {source.choice([1, "", "a b", "x/ &load", None]): {}},
        "keys": {group: source.choice([1.0, [1], "text", None])},
        "twice": {group.swapcase(): {}},
    }
    bad = case | changes[kind]
    findings = asperity.check(bad)
    try:
        asperity.run(bad)
    except asperity.InputError as error:
        if error.findings != findings or not findings:
            return f"other findings: {findings}"
        is_named = kind == "group" or isinstance(value, str) or any(found.group == group.lower() for found in findings)
        return None if is_named else f"{kind} {group} {key} {value!r:.60}: {findings}"
    return f"taken: {kind} {group} {key} {value!r:.60}"

"""Namelists in every way of writing that the standard knows: the values they state, or findings with file and line."""

import itertools
import random
from pathlib import Path

import h5py
from run import call

TITLE = "valid namelists in unusual syntax: the values that they state, or a finding"
CASES = 400
QUICK = 20

GROUPS = {
    "case": {"problem": "ehl_line", "title": 'it\'s a / title, with = & "!" in it'},
    "bodies": {"reduced_radius": 0.01, "reduced_modulus": 2e11, "speed_1": 0.0, "speed_2": 0.5},
    "load": {"load_per_length": 1e5},
    "lubricant": {"viscosity": 0.05, "pressure_viscosity": 2e-8, "viscosity_law": "barus", "density_law": "constant"},
    "surface_1": {
        "shape": "feature",
        "amplitude": [1e-8, 1e-8, 2e-8],
        "wavelength": [2e-4, 2e-4, 2e-4],
        "position": [-0.5, 0.0, 0.5],
    },
    "domain": {"x_inlet": -4.0, "x_outlet": 1.5, "intervals": 64},
    "accuracy": {"error_bars": False},
}


def real(value: float, source: random.Random) -> str:
    text = source.choice([repr(value), f"{value:.17e}", f"{value:+.17E}"])
    text = text.replace("e", "d").replace("E", "D") if source.random() < 0.4 else text
    return text.replace("e+", "+").replace("E-", "-") if source.random() < 0.1 else text


def word(value: object, source: random.Random) -> str:
    if isinstance(value, bool):
        letter = "t" if value else "f"
        return source.choice([letter, letter.upper(), f".{letter}", f".{letter}.", f".{value}.", str(value)])
    if isinstance(value, int):
        return source.choice([str(value), f"+{value}", f"00{value}"])
    if isinstance(value, float):
        return real(value, source)
    quote = source.choice("'\"")
    return quote + value.replace(quote, 2 * quote) + quote


def values(value: object, source: random.Random) -> str:
    """The right side of an entry: lists with commas, blanks, line ends, repeat counts or nulls behind."""
    if not isinstance(value, list):
        return word(value, source) + (",," if source.random() < 0.03 else "")
    items = [word(item, source) for item in value]
    if len(set(value)) == 1 and source.random() < 0.5:
        items = [f"{len(value)}*{items[0]}"]
    return source.choice([", ", " , ", " ", ",\n   ", "\n", "\t"]).join(items)


def section(first: int, part: list, source: random.Random) -> str:
    """The subscript of a part of an array: where it begins, or begins and ends, with or without blanks."""
    blank = source.choice(["", " "])
    return f"{blank}({blank}{first}{source.choice(['', f'{blank}:{blank}{first + len(part) - 1}'])}{blank})"


def entry(key: str, value: object, source: random.Random) -> str:
    """One entry, an array whole, by element or by section."""
    name = "".join(source.choice([letter.upper(), letter]) for letter in key)
    equals = source.choice([" = ", "=", "=\n", " =\t"])
    if isinstance(value, list) and source.random() < 0.4:
        ends = sorted({0, len(value), *(source.randint(0, len(value)) for _ in value)})
        parts = [(first, value[first:last]) for first, last in itertools.pairwise(ends)]
        source.shuffle(parts)
        return "\n".join(name + section(first + 1, part, source) + equals + values(part, source) for first, part in parts)
    return name + equals + values(value, source)


def namelist(source: random.Random) -> str:
    text = source.choice(["", "! a comment with / and & and '\n", "\n\n"])
    groups = list(GROUPS.items())
    source.shuffle(groups)
    for name, entries in groups:
        keys = list(entries.items())
        source.shuffle(keys)
        text += source.choice(["&", "   &", "&"]) + source.choice([name, name.upper()]) + source.choice(["\n", " ", "\n\n"])
        for key, value in keys:
            text += entry(key, value, source) + source.choice(["\n", "\n", ", ", "  ", " ! it's a / comment = 3\n", "\r\n"])
        text += " / text behind the slash\n" if source.random() < 0.03 else source.choice(["/\n", "/ ! comment\n", "&end\n"])
    return text


def plain() -> str:
    source = random.Random(0)
    lines = []
    for name, entries in GROUPS.items():
        words = {key: map(repr, value) if isinstance(value, list) else [word(value, source)] for key, value in entries.items()}
        rows = [f"   {key} = {', '.join(items)}" for key, items in words.items()]
        lines += [f"&{name}", *rows, "/"]
    return "\n".join(lines) + "\n"


def effective(path: Path) -> dict[str, object]:
    with h5py.File(path) as file:
        groups = file["input/effective"]
        return {f"{name}/{key}": value.tolist() for name, group in groups.items() for key, value in group.attrs.items()}


def attack(program: Path, source: random.Random, folder: Path) -> str | None:
    (folder / "odd.nml").write_text(namelist(source), encoding="utf-8", newline="")
    (folder / "plain.nml").write_text(plain(), encoding="utf-8")
    odd = call(program, folder, "odd.nml", "--quiet")
    if odd.trouble():
        return odd.trouble()
    if odd.status == 1:
        return None if "odd.nml:" in odd.err else f"no file and line in the message: {odd.err.strip()[-200:]}"
    as_usual = call(program, folder, "plain.nml", "--quiet")
    if as_usual.status != 0 or odd.status != 0:
        return f"status {odd.status} where the plain case ends with {as_usual.status}: {odd.err.strip()[-200:]}"
    different = {name for name, value in effective(folder / "plain.h5").items() if effective(folder / "odd.h5").get(name) != value}
    return f"other values: {', '.join(sorted(different))}" if different else None

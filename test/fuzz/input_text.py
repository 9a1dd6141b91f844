"""Namelists with changed bytes, in any way of writing, line end and encoding: the values they state, or findings with lines."""

import itertools
import random
from pathlib import Path

import h5py
from run import ROOT, Run, attack, call

INPUTS = sorted((ROOT / "input").glob("*.nml"))
WORDS = [b"1e999", b"9" * 40, b"=", b"*", b"(", b")", b"'", b'"', b"&", b"/"]
ODD = b"&/='\",!*()0123456789.eE+-\n\t \x00\xff"


@attack("namelists with changed, cut, doubled or swapped bytes, `--check`", 1000, quick=40)
def namelist_bytes(program: Path, source: random.Random, folder: Path) -> str | None:
    text = bytearray(source.choice(INPUTS).read_bytes())
    for _ in range(source.randint(1, 4)):
        place = source.randrange(len(text))
        end = place + source.randint(1, 12)
        change = source.randrange(5)
        if change == 0:
            text[place] = source.choice(ODD)
        elif change == 1:
            del text[place:end]
        elif change == 2:
            text[place:place] = text[place:end]
        elif change == 3:
            text[place:end] = bytes(reversed(text[place:end]))
        else:
            text[place:end] = source.choice(WORDS)
    (folder / "case.nml").write_bytes(text)
    run = call(program, folder, "--check", "case.nml")
    if run.status == 1 and "case.nml" not in run.err:
        return f"no file in the message: {run.err.strip()[-200:]}"
    return run.trouble(0, 1)


GROUPS = {
    "case": {"problem": "ehl_line", "title": 'it\'s a / title, with = & "!" in it'},
    "bodies": {"reduced_radius": 0.01, "reduced_modulus": 2e11, "speed_1": 0.0, "speed_2": 0.5},
    "load": {"load_per_length": 1e5},
    "lubricant": {"viscosity": 0.05, "pressure_viscosity": 2e-8, "viscosity_law": "barus", "density_law": "constant"},
    "surface_1": {"shape": "feature", "amplitude": [1e-8, 1e-8, 2e-8], "wavelength": [2e-4] * 3, "position": [-0.5, 0.0, 0.5]},
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


@attack("valid namelists in unusual syntax: the values that they state, or a finding", 400, quick=20)
def namelist_syntax(program: Path, source: random.Random, folder: Path) -> str | None:
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


# Lines with a finding each, and comments that must end with their line.
FAULTS = ["viscosity = 1 2", "typo = 3", "intervals = 'x'", "speed_1 = 1.0.0", "&nobody /", "title = 'open", "text"]
COMMENTS = ["! intervals = 3", "!", "! Öl, µm, 油膜", "", "   ! it's / & not = an entry"]
UNICODE = ["utf-16", "utf-16-le", "utf-16-be"]


def with_ends(lines: list[str], ends: list[str], source: random.Random) -> str:
    """The lines with ends drawn from `ends`; a CR is never followed by an LF that would end the same line."""
    text = ""
    for line in lines:
        end = source.choice(ends)
        if text.endswith("\r") and not line and end == "\n":
            end = "\r\n"
        text += line + end
    return text


def plain_and_odd(source: random.Random) -> tuple[str, bytes, str]:
    """A case with LF in UTF-8, the same in another form, and its encoding."""
    lines = namelist(source).replace("\r\n", "\n").split("\n")
    for _ in range(source.randrange(6)):
        lines.insert(source.randrange(len(lines) + 1), source.choice(COMMENTS))
    if source.random() < 0.5:
        for _ in range(source.randrange(1, 4)):
            lines.insert(source.randrange(len(lines) + 1), source.choice(FAULTS))
    text = with_ends(lines, source.choice([["\r"], ["\r\n"], ["\n"], ["\r", "\n"], ["\r", "\r\n"], ["\r", "\r\n", "\n"]]), source)
    encoding = source.choice(["utf-8"] * 4 + ["utf-8-sig"] * 3 + ["latin-1", *UNICODE])
    return "\n".join(lines) + "\n", text.encode(encoding, "replace"), encoding


@attack("one namelist with line ends LF, CR LF, CR and mixes of them, in UTF-8 with and without mark, UTF-16, Latin-1", 400)
def namelists_encoding(program: Path, source: random.Random, folder: Path) -> str | None:
    plain, odd, encoding = plain_and_odd(source)
    runs = []
    for name, content in (("plain", plain.encode()), ("other", odd)):
        (folder / name).mkdir()
        (folder / name / "case.nml").write_bytes(content)
        runs.append(call(program, folder / name, "case.nml", "--quiet"))
    trouble = [run.trouble() for run in runs if run.trouble()]
    if trouble:
        return trouble[0]
    if encoding in UNICODE and "case.nml:1: found UTF-16, expected" not in runs[1].err:
        return f"{encoding}: {runs[1].err[-200:]}"
    return compare(*runs, folder, None if odd_bytes(odd) else encoding)


def odd_bytes(odd: bytes) -> bool:
    """Whether it is no UTF-8 text without null bytes."""
    try:
        return "\0" in odd.decode("utf-8")
    except UnicodeDecodeError:
        return True


def compare(plain: Run, other: Run, folder: Path, encoding: str | None) -> str | None:
    """What the other form changed; without an `encoding` that can be read it is refused by name."""
    if encoding is None:
        refused = other.status == 1 and other.err.endswith(", expected a text file in UTF-8\n") and "found " in other.err
        return None if refused else f"status {other.status}: {other.err[-200:]}"
    if encoding == "latin-1":
        return None  # other characters, all of them ASCII
    if (plain.status, plain.err) != (other.status, other.err):
        return f"{encoding}: status {plain.status} {plain.err[-200:]}, in the other form {other.status} {other.err[-200:]}"
    if plain.status == 1:
        return None
    values = [effective(folder / name / "case.h5") for name in ("plain", "other")]
    return None if values[0] == values[1] else "other values"

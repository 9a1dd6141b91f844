"""Tables of heights as instruments and spreadsheets write them: dialects, headers and units at random.

Each file is read as the plain one, or refused with a message that says what it looks like; never a wrong number.
"""

import random

import h5py
import numpy as np
import pytest
from cases import STEADY, write
from dry_cases import case_text

FILE = "shape = 'file', file = '{}'"
SPACING = 2e-6
PER_METRE = {"m": 1.0, "mm": 1e3, "um": 1e6, "nm": 1e9, "cm": 1e2}
SPELLINGS = {
    "m": ["m", "metre", "meters"],
    "cm": ["cm"],
    "mm": ["mm", "MM", "millimetre", "Millimeters"],
    "um": ["um", "\u00b5m", "\u03bcm", "micron", "micrometers"],
    "nm": ["nm", "nanometre"],
}
FORMS = ["{} [{}]", "{} ({})", "{}({})", "{}/{}", "{}_{}", "{}[{}]"]


def heights(nodes, seed=1):
    """A wavy profile that closes on itself [m]."""
    source = np.random.default_rng(seed)
    places = 2 * np.pi * np.arange(nodes) / nodes
    return 1e-7 * sum(source.standard_normal() * np.cos(k * places + source.uniform(0, 6)) for k in range(1, 6))


def read_back(asperity, folder, name, keys="", refused=None):
    """Heights and positions [m] that the program makes of a file; where it refuses it, its message."""
    write(
        folder,
        "case.nml",
        case_text(FILE.format(name) + keys, [1e6], "", "&output adequacy = .false. /\n&accuracy error_bars = .false. /"),
    )
    done = asperity("case.nml", "--quiet")
    if refused is None:
        assert (done.returncode, done.stderr) == (0, "")
    if done.returncode:
        assert done.returncode == 1
        return done.stderr
    with h5py.File(folder / "case.h5") as file:
        return file["solution/height_undeformed"][()], file["solution/x"][()]


def number(value, decimal, source):
    """A number as text, with all its digits."""
    text = source.choice([repr(float(value)), f"{value:.17e}", f"{value:.17E}"])
    return text.replace(".", decimal)


def table(source, z, dialect):
    """Bytes of a table of a dialect, with a header or none."""
    separator, decimal = dialect["separator"], dialect["decimal"]
    between = {"blanks": lambda: source.choice([" ", "   ", " \t "])}.get(separator, lambda: separator)
    units = dialect["units"]
    rows = []
    for i, height in enumerate(z):
        fields = [number(i * SPACING * PER_METRE[units[0]], decimal, source), number(height * PER_METRE[units[1]], decimal, source)]
        if dialect["more"]:
            fields.append(number(source.gauss(0, 1), decimal, source))
        if dialect["quoted"]:
            fields = [f'"{field}"' for field in fields]
        rows.append(dialect["before"] + between().join(fields) + dialect["behind"])
    names = dialect["names"]
    if names:
        joint = "  " if separator == "blanks" else separator
        names = [f'"{name}"' for name in names] if dialect["quoted"] else names
        rows.insert(0, dialect["mark"] + joint.join(names) + dialect["behind"])
    if dialect["unit_row"]:
        rows.insert(1, (separator if separator != "blanks" else " ").join(dialect["unit_row"]))
    for k in range(dialect["comments"]):
        rows.insert(0 if dialect["mark"] else source.randrange(len(rows)), f"# scan {k}, stylus 4711; made by hand")
    if dialect["blank_lines"]:
        rows.insert(source.randrange(len(rows)), "")
    text = dialect["ends"].join(rows) + source.choice(["", dialect["ends"]])
    return (b"\xef\xbb\xbf" if dialect["mark_of_order"] else b"") + text.encode(dialect["encoding"])


def any_dialect(source):
    """A dialect, and the keys that it needs."""
    separator = source.choice([",", ";", "\t", "blanks"])
    decimal = "." if separator == "," else source.choice([".", ","])
    units = [source.choice(list(PER_METRE)), source.choice(list(PER_METRE))]
    said_by = source.choice(["names", "names", "names", "unit_row", "keys", "both"])
    spelled = [source.choice(SPELLINGS[unit]) for unit in units]
    more = source.random() < 0.3
    names = ["x", "z"] + (["remark"] if more else [])
    unit_row = None
    if said_by in {"names", "both"}:
        form = source.choice([f for f in FORMS if separator != "blanks" or "/" in f or "_" in f or "[" in f])
        names[:2] = [form.format(name, unit) for name, unit in zip(names, spelled, strict=False)]
    elif said_by == "unit_row":
        unit_row = [source.choice(["{}", "[{}]"]).format(unit) for unit in spelled] + (["-"] if more else [])
    elif source.random() < 0.4:
        names = None
    if names is None and separator == "," and more:
        more = False  # refused on purpose, see below
    encodings = ["utf-8"] + (["latin-1"] if "\u03bcm" not in spelled else [])
    keys = f", x_unit = '{units[0]}', z_unit = '{units[1]}'" if said_by in {"keys", "both"} else ""
    encoding = source.choice(encodings)
    return keys, {
        "separator": separator,
        "decimal": decimal,
        "units": units,
        "names": names,
        "unit_row": unit_row,
        "more": more,
        "mark": source.choice(["", "", "# ", "#"]) if names and not unit_row else "",
        "before": source.choice(["", "", " "]) if separator != "\t" else "",
        "behind": source.choice(["", "", separator]) if separator in ",;" else "",
        "quoted": source.random() < 0.15,
        "comments": source.choice([0, 0, 1, 3]),
        "blank_lines": source.random() < 0.2,
        "ends": source.choice(["\n", "\r\n"]),
        "mark_of_order": encoding == "utf-8" and source.random() < 0.3,
        "encoding": encoding,
    }


@pytest.mark.parametrize("seed", range(120))
def test_any_dialect_is_read_as_the_plain_table(asperity, tmp_path, seed):
    source = random.Random(1000 + seed)
    z = heights(source.choice([16, 33, 120]), seed)
    keys, dialect = any_dialect(source)
    (tmp_path / "z.csv").write_bytes(table(source, z, dialect))
    found, x = read_back(asperity, tmp_path, "z.csv", keys + ", detrend = 'none'" * HAS_DETREND)
    np.testing.assert_allclose(found, z, rtol=1e-14, atol=1e-22, err_msg=str(dialect))
    np.testing.assert_allclose(x[1], SPACING, rtol=1e-12, err_msg=str(dialect))


HAS_DETREND = True


def broken(source, z):
    """A table with something wrong that could be read as other numbers, and what the message must have of it."""
    um = [f"{i * SPACING * 1e6:.6f},{height * 1e6:.6f}" for i, height in enumerate(z)]
    with_commas = [f"{i},{source.randrange(10)},{source.randrange(10)},{source.randrange(10)}" for i in range(len(z))]
    semicolons = [row.replace(",", ";").replace(".", ",") for row in um]
    damaged = semicolons[:]
    damaged[source.randrange(5, len(z))] = "1.000,5;2.000,25"
    return {
        "decimal commas between commas": (["x,z", *with_commas], "it looks like decimal commas between commas"),
        "the same without names": (with_commas, "may be numbers with decimal commas"),
        "millimetres and micrometres as metres": (
            [f"{i * SPACING * 1e3!r},{float(height) * 1e6!r}" for i, height in enumerate(z)],
            "expected at most 10 (are the units right: x_unit, z_unit?)",
        ),
        "a unit that is none": (["x [mm],z [furlong]", *um], "found the unit furlong in the header 'x [mm],z [furlong]'"),
        "one unit only": (["x_um,z", *um], "found a unit of positions only in the header"),
        "a unit in a comment": (["# all lengths in um", "x,z", *um], "found the unit 'um' in a comment"),
        "pixels": (["x_px,z_um", *um], "found the unit px in the header 'x_px,z_um'"),
        "thousands": (["x_um;z_um", *damaged], "found '1.000,5', expected a number (fields separated by semicolons"),
        "a word in the first row": (["0,0,one", *um], "found"),
        "two lines of text": (["Profile,7", "x_um,z_um", *um], "z.csv"),
        "one column": (["z", *(str(height) for height in z)], "no row of two or more numbers in the two lines below"),
        "three lines of text": (["Profile R1", "2024-01-02", "x_um,z_um", *um], "(# before other lines)"),
        "no rows": (["x,z"], "no row of two or more numbers in the two lines below"),
        "nothing": ([""], "found no rows"),
    }


@pytest.mark.parametrize("name", broken(random.Random(0), heights(20)))
def test_what_could_be_other_numbers_is_refused(asperity, tmp_path, name):
    rows, expected = broken(random.Random(3), heights(20))[name]
    (tmp_path / "z.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    message = read_back(asperity, tmp_path, "z.csv", refused=True)
    assert isinstance(message, str), message
    assert expected in message
    assert "z.csv" in message


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"x,z\r0,1\r1,2\r", "found lines that end with carriage returns alone"),
        ("x,z\n0,1\n1,2\n".encode("utf-16"), "found bytes that are no text, as of UTF-16"),
    ],
)
def test_bytes_that_are_no_table(asperity, tmp_path, content, expected):
    (tmp_path / "z.csv").write_bytes(content)
    assert expected in read_back(asperity, tmp_path, "z.csv", refused=True)


def test_file_and_key_contradict_each_other(asperity, tmp_path):
    (tmp_path / "z.csv").write_text("x_mm,z_um\n0,0\n0.001,0.1\n0.002,0\n", encoding="utf-8")
    message = read_back(asperity, tmp_path, "z.csv", ", z_unit = 'nm'", refused=True)
    assert "found the unit um in the header 'x_mm,z_um', but z_unit = 'nm', expected the same of both" in message


def test_column_by_its_name_without_unit_or_by_number(asperity, tmp_path):
    (tmp_path / "z.csv").write_text("x [um];left [nm];right [nm]\n0;0;0\n1;10;20\n2;0;0\n", encoding="utf-8")
    assert read_back(asperity, tmp_path, "z.csv", ", dataset = 'right'")[0].max() == pytest.approx(20e-9, rel=1e-14)
    (tmp_path / "z.csv").write_text("0;0;0\n1e-6;1e-8;2e-8\n2e-6;0;0\n", encoding="utf-8")
    assert read_back(asperity, tmp_path, "z.csv", ", dataset = '3'")[0].max() == pytest.approx(20e-9, rel=1e-14)
    assert "found no header line" in read_back(asperity, tmp_path, "z.csv", ", dataset = 'z'", refused=True)


@pytest.mark.parametrize("variable", [True, False])
@pytest.mark.parametrize(("attribute", "keys"), [("units", ""), ("unit", ""), (None, ", z_unit = 'um'"), ("si_scale", "")])
def test_units_of_hdf5(asperity, tmp_path, attribute, keys, variable):
    z = heights(40)
    with h5py.File(tmp_path / "z.h5", "w") as file:
        data = file.create_dataset("z", data=z * 1e6)
        data.attrs["spacing"] = SPACING * 1e3
        data.attrs["spacing_units"] = "mm" if variable else np.bytes_("mm")
        if attribute == "si_scale":
            data.attrs["si_scale"] = 1e-6
        elif attribute:
            data.attrs[attribute] = "\u00b5m" if variable else np.bytes_("um")
    found, x = read_back(asperity, tmp_path, "z.h5", ", dataset = 'z'" + keys)
    np.testing.assert_allclose(found, z, rtol=1e-14, atol=1e-22)
    assert x[1] == pytest.approx(SPACING, rel=1e-12)


def test_units_of_hdf5_that_contradict(asperity, tmp_path):
    with h5py.File(tmp_path / "z.h5", "w") as file:
        data = file.create_dataset("z", data=heights(40) * 1e6)
        data.attrs["spacing"] = SPACING
        data.attrs["units"] = "um"
    message = read_back(asperity, tmp_path, "z.h5", ", dataset = 'z', z_unit = 'nm'", refused=True)
    assert "found the unit um in the attributes of z, but z_unit = 'nm'" in message
    with h5py.File(tmp_path / "z.h5", "r+") as file:
        file["z"].attrs["si_scale"] = 1e-9
    message = read_back(asperity, tmp_path, "z.h5", ", dataset = 'z'", refused=True)
    assert "found si_scale = 1.000E-09 [m] beside the unit um, expected the same of both" in message


def oil(surface):
    return STEADY.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 0.0, speed_2 = 1.1") + f"&surface_1 {surface} /\n"


@pytest.mark.parametrize(("amplitude", "status"), [(20e-9, 0), (10e-6, 0), (1.4e-3, 1)])
def test_heights_beside_the_film(asperity, tmp_path, amplitude, status):
    """The film is about half a micrometre; long waves of these heights are not steep."""
    x = np.arange(2000) * 1e-5
    z = amplitude * np.cos(2 * np.pi * (x - 1e-2) / 1e-2)
    np.savetxt(tmp_path / "z.csv", np.column_stack([x, z]), delimiter=",", header="x_m,z_m")
    write(tmp_path, "case.nml", oil("shape = 'file', file = 'z.csv'"))
    done = asperity("case.nml", "--check")
    assert done.returncode == status, done.stderr
    assert ("times the film that is expected" in done.stderr) == (status == 1)
    if status:
        return
    done = asperity("case.nml")
    words = " ".join((done.stdout + done.stderr).split())
    assert words.count("times the film that is expected") == (2 if amplitude > 1e-6 else 0), words


def test_steep_profile_is_noted(asperity, tmp_path):
    z = [1e-6 * (i % 2) for i in range(16)]
    (tmp_path / "z.csv").write_text("".join(f"{i * 0.8e-6:.7e},{h!r}\n" for i, h in enumerate(z)), encoding="utf-8")
    write(tmp_path, "case.nml", case_text(FILE.format("z.csv"), [1e6], ""))
    done = asperity("case.nml")
    assert done.returncode == 0
    assert "have an rms slope of 1.25 (are the units right: x_unit, z_unit?)" in " ".join((done.stdout + done.stderr).split())


def test_units_that_are_stated_are_believed(asperity, tmp_path):
    """A profile steeper than any surface is refused, and only noted with both units stated."""
    z = [1e-4 * (i % 2) for i in range(16)]
    (tmp_path / "z.csv").write_text("".join(f"{i * 0.8e-6:.7e},{h!r}\n" for i, h in enumerate(z)), encoding="utf-8")
    for units, status in (("", 1), (", z_unit = 'm'", 1), (", x_unit = 'm', z_unit = 'm'", 0)):
        write(tmp_path, "case.nml", case_text(FILE.format("z.csv") + units, [1e6], ""))
        done = asperity("case.nml")
        assert done.returncode == status, done.stderr
        assert "rms slope of 125" in " ".join((done.stdout + done.stderr).split())


def test_long_profile_is_noted(asperity, tmp_path):
    z = heights(64)
    (tmp_path / "z.csv").write_text("x,z\n" + "".join(f"{i},{h!r}\n" for i, h in enumerate(map(float, z))), encoding="utf-8")
    write(tmp_path, "case.nml", case_text(FILE.format("z.csv"), [1e-3], ""))
    done = asperity("case.nml")
    assert done.returncode == 0
    words = " ".join((done.stdout + done.stderr).split())
    assert "the heights of surface_1 are 63.0 m long (are the units right: x_unit, z_unit?)" in words

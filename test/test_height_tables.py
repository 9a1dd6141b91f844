"""Tables of heights at random: the strict ones are read, all others are refused with the command that converts them."""

import random

import h5py
import numpy as np
import pytest
from cases import AT_REST, LEAN, case_text, write

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


TEXT = "x_um,z_um\n0,0.1\n1,0.2\n2,0.1\n"


def heights(nodes, seed=1):
    """A wavy profile that closes on itself [m]."""
    source = np.random.default_rng(seed)
    places = 2 * np.pi * np.arange(nodes) / nodes
    return 1e-7 * sum(source.standard_normal() * np.cos(k * places + source.uniform(0, 6)) for k in range(1, 6))


def read_back(asperity, folder, name, keys="", refused=None):
    """Heights and positions [m] that the program makes of a file; where it refuses it, its message."""
    write(folder, "case.nml", case_text(FILE.format(name) + keys, [1e6], "", LEAN))
    done = asperity("case.nml", "--quiet")
    assert done.returncode in ((0, 1) if refused else (0,)), done.stderr
    if done.returncode:
        return done.stderr
    assert refused or done.stderr == ""
    with h5py.File(folder / "case.h5") as file:
        return file["solution/height_undeformed"][()], file["solution/x"][()]


def number(value, decimal, source):
    text = source.choice([repr(float(value)), f"{value:.17e}", f"{value:.17E}", f"{value:.17E}".replace("E", "D")])
    return text.replace(".", decimal)


def table(source, z, form):
    """Bytes of a table: positions and heights at `form["columns"]` among others."""
    separator = form["separator"]
    between = (lambda: source.choice([" ", "   "])) if separator == "blanks" else (lambda: separator)
    rows = []
    for i, height in enumerate(z):
        fields = [source.gauss(0, 1) for _ in range(form["count"])]
        for column, value, unit in zip(form["columns"], (i * SPACING, height), form["units"], strict=True):
            fields[column] = value * PER_METRE[unit]
        rows.append(form["before"] + between().join(number(field, form["decimal"], source) for field in fields))
    if form["names"]:
        rows.insert(0, between().join(form["names"]))
    for k in range(form["comments"]):
        rows.insert(source.randrange(len(rows)), f"{source.choice('#%')} scan {k}, stylus 4711; made by hand")
    for _ in range(form["blank_lines"]):
        rows.insert(source.randrange(len(rows)), source.choice(["", "  "]))
    text = form["ends"].join(rows) + source.choice(["", form["ends"]])
    return b"\xef\xbb\xbf" * form["byte_order_mark"] + text.encode()


def any_form(source):
    """A form that is read, and the keys that it needs."""
    separator = source.choice([",", ";", "\t", "blanks"])
    units = [source.choice(list(PER_METRE)), source.choice(list(PER_METRE))]
    said_by = source.choice(["names", "names", "names", "keys", "both"])
    count = source.choice([2, 2, 3, 5])
    columns = source.sample(range(count), 2) if count > 2 else [0, 1]
    names = [f"other{i}" for i in range(count)]
    forms = [f for f in FORMS if separator != "blanks" or " " not in f or "[" in f]
    for column, name, unit in zip(columns, ("x", "height"), units, strict=True):
        spelled = source.choice(SPELLINGS[unit])
        names[column] = source.choice(forms).format(name, spelled) if said_by != "keys" else name
    keys = f", x_unit = '{units[0]}', z_unit = '{units[1]}'" if said_by != "names" else ""
    if count > 2:
        keys += ", positions = 'x', dataset = 'height'"
    elif said_by == "keys" and source.random() < 0.5:
        names = None
    return keys, {
        "separator": separator,
        "decimal": source.choice([".", ","]) if separator in ";\t" else ".",
        "units": units,
        "names": names,
        "count": count,
        "columns": columns,
        "before": source.choice(["", "", " "]) if separator != "\t" else "",
        "comments": source.choice([0, 0, 1, 3]),
        "blank_lines": source.choice([0, 0, 2]),
        "ends": source.choice(["\n", "\r\n", "\r"]),
        "byte_order_mark": source.random() < 0.3,
    }


@pytest.mark.parametrize("seed", range(60))
def test_any_strict_table_is_read_to_the_last_digit(asperity, tmp_path, seed):
    source = random.Random(1000 + seed)
    z = heights(source.choice([16, 33, 120]), seed)
    keys, form = any_form(source)
    (tmp_path / "z.csv").write_bytes(table(source, z, form))
    found, x = read_back(asperity, tmp_path, "z.csv", keys + ", detrend = 'none'")
    np.testing.assert_allclose(found, z, rtol=4e-16, atol=0, err_msg=str(form))
    np.testing.assert_allclose(x[1], SPACING, rtol=1e-12, err_msg=str(form))


def rows_of(z, separator=",", factors=(1e6, 1e6)):
    return [f"{i * SPACING * factors[0]:.6f}{separator}{height * factors[1]:.6f}" for i, height in enumerate(z)]


def other(source, z):
    """Tables of other forms, {what it is: (rows, what the message has of it)}; `source` says where something is wrong."""
    um = rows_of(z)
    at = source.randrange(5, len(z))
    areal = [f"{i % 6}.0,{i // 6}.0,{height * 1e6:.3f}" for i, height in enumerate(z)]
    commas = [f"{i},{source.randrange(10)},{source.randrange(10)},{source.randrange(10)}" for i in range(len(z))]

    def changed(row, rows=um, names="x_um,z_um"):
        return [names, *rows[:at], row, *rows[at + 1 :]]

    decimal = [row.replace(",", ";").replace(".", ",") for row in um]
    place = f"z.csv:{at + 2}:"
    mark = source.choice(["9999", "-32768", "1e10", "-9999.0", "32767", "1e5"])
    told = "likely the mark of a missing point" if float(mark) < 1e9 else "m, expected"
    x = um[at].split(",")[0]
    return {
        "x y z": (["X [mm];Y [mm];Z [um]", *(row.replace(",", ";") for row in areal)], "z.csv:1:1: found 3 columns, expected two"),
        "running number": (["No;X;Z", *(f"{i};{row.replace(',', ';')}" for i, row in enumerate(um))], "found 3 columns"),
        "area without names": (areal, "found 3 columns"),
        "matrix": ([" ".join(row.split(",")[1] for row in um[:4])] * 6, "found 4 columns"),
        "one column": ([row.split(",")[1] for row in um], "found one column"),
        "quoted names": (['"x_um","z_um"', *um], "without quotes"),
        "quoted numbers": (changed('"' + um[at].replace(",", '","') + '"'), f"{place}1: found '\"{x}\"', expected a number"),
        "decimal commas between commas": (["x_um,z_um", *commas], "z.csv:2:1: found 4 fields, expected the 2 of the first row"),
        "the same without names": (commas, "found 4 columns"),
        "mixed decimal marks": (changed(um[at].replace(",", ";"), decimal, "x_um;z_um"), "expected a number with a decimal comma"),
        "thousands": (changed("1.000,5;2.000,25", decimal, "x_um;z_um"), f"{place}1: found '1.000,5', expected a number"),
        "blank thousands": (changed("1 000,5;2", decimal, "x_um;z_um"), f"{place}1: found '1 000,5', expected a number"),
        "a field more": (changed(um[at] + ",1"), f"{place}1: found 3 fields, expected the 2 of the first row"),
        "a field less": (changed(x), f"{place}1: found 1 field, expected the 2 of the first row"),
        "trailing separators": (["x_um,z_um,", *(row + "," for row in um)], "found 3 columns"),
        "another separator": (changed(um[at].replace(",", ";")), f"{place}1: found 1 field"),
        "text": (changed(f"{x},gap"), "found 'gap', expected a number"),
        "no number": (changed(f"{x},NaN"), "found 'NaN', expected a number"),
        "nothing in a field": (changed(f"{x},"), "found nothing, expected a number"),
        "mark of a missing point": (changed(f"{x},{mark}"), told),
        "many of them": (
            [*changed(f"{x},{mark}"), *(f"{(len(z) + i) * SPACING * 1e6:.6f},{mark}" for i in range(40))],
            f"{place}" if float(mark) < 1e9 else "m, expected",
        ),
        "all equal": (["x_um,z_um", *(row.split(",")[0] + ",0.25" for row in um)], "found heights that are all 0.25"),
        "falling positions": (["x_um,z_um", *um[::-1]], "found falling positions"),
        "uneven positions": (changed(f"{float(x) + 0.3},{um[at].split(',')[1]}"), f"{place}1: found uneven positions"),
        "two lines of names": (["Profile,7", "x_um,z_um", *um], "found 'Profile,7', expected names or numbers"),
        "a row of units": (["x,z", "um,um", *um], "z.csv:2:1: found 'um', expected a number"),
        "sep=": (["sep=,", "x_um,z_um", *um], "z.csv:"),
        "title": (["Profile R1", "2024-01-02", "x_um,z_um", *um], "z.csv:2:1: found 1 field"),
        "a unit that is none": (["x [mm],z [furlong]", *um], "found the unit furlong in the names 'x [mm],z [furlong]'"),
        "one unit only": (["x_um,z", *um], "found a unit of positions only"),
        "a unit in a comment": (["# all lengths in um", "x,z", *um], "found the unit 'um' in a comment"),
        "names in a comment": (["# x_um,z_um", *um], "found the unit 'um' in a comment"),
        "pixels": (["x_px,z_um", *um], "found the unit px in the names 'x_px,z_um'"),
        "names alone": (["x,z"], "found 0 rows of numbers, expected at least 2"),
        "nothing": ([""], "found no rows"),
    }


@pytest.mark.parametrize("name", other(random.Random(0), heights(20)))
def test_every_other_table_is_refused_with_the_command(asperity, tmp_path, name):
    """In one line that ends with it; never a wrong number."""
    for seed in range(2):
        rows, expected = other(random.Random(seed), heights(36, 7 + seed))[name]
        (tmp_path / "z.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
        message = read_back(asperity, tmp_path, "z.csv", refused=True)
        assert isinstance(message, str), (rows, message)
        assert expected in message
        assert "z.csv:" in message
        assert message.endswith("; to convert it: asperity-heights z.csv z.h5\n")
        assert message.count("\n") == 1


ODD = "#N/A|0.1 um|1e-7/3|3*1e-7|1e-7 2e-7|1;5|/|inf|-Infinity|1e300|1e400|1_000|0x1p3|'1e-7'|1e|e5|.|+|--1|1.2.3|(1,2)|T|1e-7!"
ODD += "|1e-7\t2|&|2*|1e+-5|\u221e|=1|-|1e5000000000|1e-7\x00|" + "9" * 70


@pytest.mark.parametrize("position", [True, False])
def test_no_odd_number_is_taken(asperity, tmp_path, position):
    """In a position `#` begins a comment."""
    for field in ODD.split("|")[position:]:
        rows = [f"x,z\n0,1e-7\n1,{field}\n2,0\n", f"x,z\n0,1e-7\n1,0\n{field},0\n"]
        (tmp_path / "z.csv").write_text(rows[position], encoding="utf-8")
        message = read_back(asperity, tmp_path, "z.csv", refused=True)
        assert isinstance(message, str), field
        assert "case.nml:4: &surface_1 file: z.csv:" in message
        assert message.endswith("; to convert it: asperity-heights z.csv z.h5\n")


@pytest.mark.path
@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (TEXT.encode("utf-16"), "found UTF-16"),
        (TEXT.encode("utf-16-le"), "found UTF-16"),
        (TEXT.encode("utf-16-be"), "found UTF-16"),
        ("x [\u00b5m];z [\u00b5m]\n0;1\n1;2\n2;1\n".encode("latin-1"), "found the byte 0x"),
        (b"\x93NUMPY\x01\x00", "found the byte 0x"),
        (b"\x89HDF\r\n", "found the byte 0x"),
    ],
)
@pytest.mark.parametrize("file", ["a b.csv", "z.h5", "profile"])
def test_bytes_that_are_no_table(asperity, tmp_path, content, expected, file):
    """What a file is its content says, not its name."""
    (tmp_path / file).write_bytes(content)
    message = read_back(asperity, tmp_path, file, refused=True)
    assert expected in message
    command = {"a b.csv": '"a b.csv" "a b.h5"', "z.h5": "z.h5 z_heights.h5", "profile": "profile profile.h5"}[file]
    assert message.endswith(f"asperity-heights {command}\n")


@pytest.mark.parametrize(("names", "problem"), [(("z.csv", "a.txt"), "line"), (("z.csv", "z.h5"), "area")])
def test_the_content_tells_the_kind_of_a_file(asperity, tmp_path, names, problem):
    """HDF5 under a name of tables and the reverse; an area asks for HDF5, and says how a table becomes it."""
    z = heights(36).reshape(6, 6) if problem == "area" else heights(36)
    with h5py.File(tmp_path / names[0], "w") as file:
        file["z"] = z
        file["z"].attrs["spacing"] = SPACING
    (tmp_path / names[1]).write_text("\n".join(["x_um,z_um", *rows_of(heights(36))]), encoding="utf-8")
    for name, keys in zip(names, [", dataset = 'z'", ""], strict=True):
        write(tmp_path, "case.nml", case_text(FILE.format(name) + keys, [1e6], "", LEAN, problem=f"dry_{problem}"))
        done = asperity("case.nml", "--quiet")
        refusal = "z.h5: found a profile, expected an area; to convert it: asperity-heights z.h5 z_heights.h5\n"
        assert done.returncode == (name == "z.h5")
        assert done.stderr.endswith(refusal) if name == "z.h5" else done.stderr == ""


def test_units_that_contradict(asperity, tmp_path):
    (tmp_path / "z.csv").write_text("x_mm,z_um\n0,0\n0.001,0.1\n0.002,0\n", encoding="utf-8")
    message = read_back(asperity, tmp_path, "z.csv", ", z_unit = 'nm'", refused=True)
    assert "found the unit um in the names 'x_mm,z_um', but z_unit = 'nm', expected the same of both" in message
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


@pytest.mark.path
@pytest.mark.parametrize(
    ("names", "keys", "expected"),
    [
        ("x [um];left [nm];right [nm]", ", positions = 'x', dataset = 'right'", 20e-9),
        ("x [um];left [nm];right [nm]", ", positions = 'x [um]', dataset = 'left [nm]'", 10e-9),
        ("x [um];left [nm];right [nm]", ", dataset = 'right'", "or names and the keys positions and dataset with two of them"),
        ("x [um];left [nm];right [nm]", ", positions = 'x'", "or names and the keys positions and dataset with two of them"),
        ("x [um];left [nm];right [nm]", ", positions = 'x', dataset = '3'", "found 0 columns 3 in the names"),
        ("x [um];z [nm];z [nm]", ", positions = 'x', dataset = 'z'", "found 2 columns z in the names 'x [um];z [nm];z [nm]'"),
        ("x [um];left [nm];right [nm]", ", positions = 'left', dataset = 'left'", "found positions and heights in the same column"),
        ("", ", positions = 'x', dataset = 'z'", "found 3 columns"),
    ],
)
def test_columns_by_their_names(asperity, tmp_path, names, keys, expected):
    (tmp_path / "z.csv").write_text(f"{names}\n0;0;0\n1;10;20\n2;0;0\n", encoding="utf-8")
    found = read_back(asperity, tmp_path, "z.csv", keys, refused=True)
    if isinstance(expected, str):
        assert expected in found
    else:
        assert found[0].max() == pytest.approx(expected, rel=1e-14, abs=0)


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
    assert x[1] == pytest.approx(SPACING, rel=1e-12, abs=0)


@pytest.mark.parametrize(("amplitude", "status"), [(20e-9, 0), (10e-6, 0), (1.4e-3, 1)])
def test_heights_beside_the_film(run_case, asperity, tmp_path, amplitude, status):
    """The film is about half a micrometre; long waves of these heights are not steep."""
    x = np.arange(2000) * 1e-5
    z = amplitude * np.cos(2 * np.pi * (x - 1e-2) / 1e-2)
    np.savetxt(tmp_path / "z.csv", np.column_stack([x, z]), delimiter=",", header="x_m,z_m", comments="")
    done = run_case(AT_REST + "&surface_1 shape = 'file', file = 'z.csv' /\n", "--check", status=status)
    assert ("times the film that is expected" in done.stderr) == (status == 1)
    if status:
        return
    done = asperity("case.nml", "--verbose")
    words = " ".join((done.stdout + done.stderr).split())
    assert words.count("times the film that is expected") == (2 if amplitude > 1e-6 else 0), words


def test_notes_on_profiles(run_case, tmp_path):
    z = [1e-6 * (i % 2) for i in range(16)]
    (tmp_path / "z.csv").write_text("".join(f"{i * 0.8e-6:.7e},{h!r}\n" for i, h in enumerate(z)), encoding="utf-8")
    done = run_case(case_text(FILE.format("z.csv"), [1e6], ""))
    assert "have an rms slope of 1.25 (are the units right: x_unit, z_unit?)" in " ".join((done.stdout + done.stderr).split())
    # A profile steeper than any surface is refused, and only noted with both units stated.
    z = [1e-4 * (i % 2) for i in range(16)]
    (tmp_path / "z.csv").write_text("".join(f"{i * 0.8e-6:.7e},{h!r}\n" for i, h in enumerate(z)), encoding="utf-8")
    for units, status in (("", 1), (", z_unit = 'm'", 1), (", x_unit = 'm', z_unit = 'm'", 0)):
        done = run_case(case_text(FILE.format("z.csv") + units, [1e6], ""), status=status)
        assert "rms slope of 125" in " ".join((done.stdout + done.stderr).split())
    z = heights(64)
    (tmp_path / "z.csv").write_text("x,z\n" + "".join(f"{i},{h!r}\n" for i, h in enumerate(map(float, z))), encoding="utf-8")
    done = run_case(case_text(FILE.format("z.csv"), [1e-3], ""))
    words = " ".join((done.stdout + done.stderr).split())
    assert "the heights of surface_1 are 63.0 m long (are the units right: x_unit, z_unit?)" in words

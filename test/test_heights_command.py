"""asperity-heights: files as other programs write them, made from known heights at random, give these back or are refused."""

import csv
import importlib.util
import io
import os
import random
import subprocess
import sys
import warnings

import h5py
import numpy as np
import pytest
from asperity import heights
from asperity.height_tables import METRES
from cases import LEAN, ROOT, called, ended, solve

UNITS = {"m": ["m"], "mm": ["mm", "Millimeters"], "um": ["um", "\u00b5m", "\u03bcm", "micron"], "nm": ["nm", "nanometre"]}
FORMS = ["{} [{}]", "{} ({})", "{}/{}", "{}_{}", "{}[{}]"]
# separator, decimal mark, quoted
DIALECTS = [("\t", ".", 0), ("\t", ",", 0), (";", ".", 0), (";", ",", 0), (",", ".", 0), (" ", ".", 0), (" ", ",", 0)]
DIALECTS += [("   ", ".", 0), (",", ",", 1), (",", ".", 1), (";", ",", 1), (", ", ".", 0)]
ENCODINGS = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"]


@pytest.fixture
def convert(capsys, tmp_path, monkeypatch):
    """Calls the command in an empty folder: (status, what it prints), one line always."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        try:
            status = heights.main([*map(str, arguments)])
        except SystemExit as error:  # what argparse does
            status = error.code
        out, err = capsys.readouterr()
        assert (out if status == 0 else err).count("\n") == 1, (out, err)
        assert (err if status == 0 else out) == ""
        return status, out + err

    return call


def written(path="out.h5"):
    """Heights [m] and spacings [m] of a file."""
    with h5py.File(path) as file:
        z = file["z"]
        return z[()], [z.attrs[name] for name in ("spacing_x", "spacing_y")[: z.ndim]]


class Sample:
    """A file of known heights in a dialect at random; `options` are those that it needs."""

    def __init__(self, kind, seed):
        self.chance = random.Random(f"{kind} {seed}")
        source = np.random.default_rng(self.chance.randrange(2**32))
        self.units = [self.chance.choice(list(UNITS)) for _ in "xz"]
        self.separator, self.decimal, self.quoted = self.chance.choice(DIALECTS)
        self.shape = (self.chance.randint(9, 14), self.chance.randint(9, 16)) if "area" in kind else (self.chance.randint(9, 40),)
        size = 10.0 ** self.chance.randint(-1, 4 if self.units[1] != "m" else 1)
        self.digits = self.chance.choice([3, 4, 6])
        self.z = np.round(size * source.standard_normal(self.shape), self.digits)
        self.step = self.chance.choice([0.5, 2.0, 0.125, 3.0])
        self.first = self.chance.choice([0.0, 12.5, -4.0])
        self.options, self.header = [], []
        x, z = self.positions(), self.z
        columns = {
            "two columns": {"x": x, "z": z},
            "turned": {"x": x[::-1], "z": z},
            "constant y": {"X": x, "Y": np.full(self.shape, 7.0), "Z": z},
            "running number": {"No": np.arange(z.size), "X": x, "Z": z},
            "more columns": {"Time": np.arange(z.size), "x": x, "raw": z**2, "z": z, "Intensity": -z},
            "chosen": {"a": z * 3, "b": x, "c": z, "d": -z},
        }
        self.columns = columns.get(kind, {})
        if kind == "turned":
            self.z = z[::-1].copy()
        elif kind == "chosen":
            self.options = ["--columns", self.chance.choice(["b,c", "2,3", "2,c"]), "--unit", ",".join(self.units)]
        elif not self.columns:
            getattr(self, kind.replace(" ", "_"))()

    def cell(self, number):
        thousands = {".": ["", "'", "," * self.quoted], ",": ["", "."]}[self.decimal] if abs(self.z).max() > 1000 else [""]
        text = f"{number:,.{self.digits}f}".replace(",", "t").replace(".", self.decimal)
        self.thousands = getattr(self, "thousands", None) or [self.chance.choice(thousands)]
        return text.replace("t", self.thousands[0])

    def names(self):
        """The lines above columns that say their names and units, in one of the usual ways."""
        words = [self.chance.choice(UNITS[self.units[name in "Zz"]]) if name in "xyzXYZ" else "" for name in self.columns]
        named = "".join(self.columns).lower().strip("xyz") or len(words) == 3
        ways = ["names", "row"] + ([] if named or self.separator.strip(" ") == "" else ["comment", "units only"]) + ["option"]
        way = self.chance.choice(ways)
        if way == "option" or (self.separator.strip(" ") == "" and way != "names"):
            self.options += ["--unit", ",".join(self.units)]
            return [list(self.columns)]
        if way == "row":
            return [list(self.columns), [f"[{word}]" if word else "" for word in words]]
        if way == "units only":
            return [words]
        form = self.chance.choice(FORMS)
        line = [form.format(name, word) if word else name for name, word in zip(self.columns, words, strict=True)]
        return [["# " * (way == "comment") + line[0], *line[1:]]]

    def matrix_area(self):
        self.matrix = self.z
        self.options = ["--spacing", f"{self.step}{self.units[0]}", "--unit", ",".join(self.units)]

    def matrix_profile(self):
        self.matrix = self.z[:, None]
        self.options = ["--spacing", f"{self.step}", "--unit", ",".join(self.units)]
        self.separator = ";"

    def calibrated_area(self):
        self.matrix = self.z
        calibration = ["XY calibration", f"{self.step:.4f}", f"{self.units[0]}/pixel"]
        self.header = [["Model", "X-0000"], calibration, ["Unit", self.units[1]], []]
        self.separator, self.decimal, self.quoted = ",", ".", 1

    def exported_area(self):
        self.matrix = self.z
        width, height = (n * self.step for n in self.z.shape[::-1])
        word = self.chance.choice(UNITS[self.units[1]][:1])
        sizes = [f"{name}: {size!r} {self.units[0]}" for name, size in (("Width", width), ("Height", height))]
        self.header = [[f"# {line}"] for line in ("Channel: Topography", *sizes, f"Value units: {word}")]
        self.separator, self.decimal, self.quoted = "\t", ".", 0

    def list_of_area(self):
        ny, nx = self.z.shape
        order = np.arange(self.z.size)
        self.chance.shuffle(order)
        x, y = (np.tile(self.positions(nx), ny), np.repeat(self.positions(ny), nx))
        self.columns = {"x": x[order], "y": y[order], "z": self.z.ravel()[order]}

    def positions(self, count=None):
        return self.first + self.step * np.arange(count or self.z.size)

    def lines(self):
        if not self.columns:
            return self.header + [[self.cell(z) for z in row] for row in self.matrix]
        formats = {name: (lambda v: str(int(v))) if name in ("No", "Time") else self.cell for name in self.columns}
        cells = zip(*self.columns.values(), strict=True)
        rows = [[formats[name](v) for name, v in zip(self.columns, row, strict=True)] for row in cells]
        return self.names() + rows

    def data(self):
        buffer = io.StringIO()
        if self.separator.strip(" ") in ("", ",") and self.quoted == 0:
            buffer.write("\n".join(self.separator.join(row) for row in self.lines()) + "\n")
        else:
            style = csv.QUOTE_ALL if self.quoted else csv.QUOTE_MINIMAL
            csv.writer(buffer, delimiter=self.separator[0], quoting=style, lineterminator="\n").writerows(self.lines())
        text = buffer.getvalue()
        encoding = self.chance.choice(ENCODINGS)
        text = text.replace("\n", self.chance.choice(["\n", "\r\n", "\r"]))
        return (text.replace("\u03bc", "\u00b5") if encoding == "latin-1" else text).encode(encoding)


KINDS = ["two columns", "turned", "constant y", "running number", "more columns", "chosen", "matrix area", "matrix profile"]
KINDS += ["calibrated area", "exported area", "list of area"]


@pytest.mark.parametrize("kind", KINDS)
def test_a_family_gives_its_heights_back(convert, tmp_path, kind):
    for seed in range(12):
        sample = Sample(kind, seed)
        data = sample.data()
        (tmp_path / "scan.txt").write_bytes(data)
        status, words = convert("scan.txt", "out.h5", *sample.options)
        if "expected --decimal" in words:
            status, words = convert("scan.txt", "out.h5", *sample.options, "--decimal", sample.decimal)
        assert status == 0, (kind, seed, words, data[:300], sample.options)
        z, spacing = written()
        scale = METRES[sample.units[1]]
        np.testing.assert_allclose(z, sample.z * scale, rtol=1e-12, atol=1e-12 * scale, err_msg=f"{kind} {seed} {words}")
        np.testing.assert_allclose(spacing, sample.step * METRES[sample.units[0]], rtol=1e-9)
        assert words.startswith(f"out.h5: {' x '.join(map(str, z.shape[::-1]))} points, spacing ")
        assert f"Rq {z.std() * 1e6:.4g} um" in words


def test_damaged_files_end_in_a_line(convert, tmp_path):
    """Whatever happened to a file: what it holds, or one line; never a traceback."""
    for seed in range(40):
        chance = random.Random(seed)
        sample = Sample(chance.choice(KINDS), seed)
        data = bytearray(sample.data())
        for _ in range(chance.randint(1, 6)):
            place = chance.randrange(len(data))
            match chance.randrange(5):
                case 0:
                    data[place] = chance.randrange(256)
                case 1:
                    del data[place:]
                case 2:
                    del data[place : place + chance.randint(1, 20)]
                case 3:
                    data[place:place] = chance.choice([b'"', b",", b";", b"-", b".", b"\x00", b"nan", b"1e999", b"\n", b"9" * 50])
                case 4:
                    data[place:place] = data[: chance.randint(1, len(data))]
            data = data or bytearray(b" ")
        (tmp_path / "scan.txt").write_bytes(data)
        status, words = convert("scan.txt", "out.h5", *sample.options)
        assert status in (0, 1), (seed, words)
        assert status == 0 or words.startswith("asperity-heights: ")


PROFILE = "".join(f"{i};{v}\n" for i, v in enumerate([0.1, 0.3, 0.2, 0.5, 0.4, 0.6, 0.1, 0.9, 0.2, 0.3]))
REFUSED = {
    "no units": ("x;z\n" + PROFILE, [], "found no unit of the heights, expected --unit X,Z"),
    "unknown unit": ("x [px];z [um]\n" + PROFILE, [], "found the unit 'px' of the positions"),
    "one unit": ("x;z [um]\n" + PROFILE, [], "found no unit of the positions"),
    "other unit": ("x [mm];z [um]\n" + PROFILE, ["--unit", "mm,nm"], "found heights in um, but --unit says nm"),
    "no unit at all": (PROFILE, ["--unit", "mm,furlong"], "--unit: found 'mm,furlong', expected one or two of m, cm, mm, um"),
    "two units": ("x [mm];z [um]\nmm;nm\n" + PROFILE, [], "found the unit 'nm' below the name 'z [um]'"),
    "two heights": ("x_mm;z_um;z_um\n0;1;2\n1;2;1\n2;1;3\n", [], "columns 1 x_mm (0 to 2), 2 z_um (1 to 2), 3 z_um (1 to 3)"),
    "no such column": ("x_mm;z_um\n" + PROFILE, ["--columns", "x,h"], "--columns: found 'h', expected one of the columns 1 x_mm"),
    "uneven": ("0 1\n1 2\n2 1\n7 3\n7.5 1\n", ["--unit", "mm"], "found positions that are not evenly spaced"),
    "twice": ("0 1\n1 2\n1 1\n2 3\n", ["--unit", "mm"], "found 1 positions more than once"),
    "matrix": ("1 2 1 2\n2 1 2 1\n", ["--unit", "um"], "found 2 rows without known positions"),
    "matrix with numbers": (
        "".join(f"{i} 0.{i * i % 7} 0.{9 - i} 0.3\n" for i in range(9)),
        ["--spacing", "1um"],
        "found positions or numbers",
    ),
    "matrix with axes": (
        "".join(";".join(str(i + j if 0 in (i, j) else i * j % 7) for j in range(9)) + "\n" for i in range(5)),
        ["--spacing", "1um", "--unit", "um"],
        "found positions or numbers",
    ),
    "channel": ("x_mm;z_um\n" + PROFILE, ["--channel", "1"], "found --channel, expected it for an instrument only"),
    "spacing and positions": ("x_mm;z_um\n" + PROFILE, ["--spacing", "2mm"], "0.001 m apart"),
    "spacings": ('"Pixel size","2","um"\n1,2,1\n2,1,2\n', ["--spacing", "3um"], "2e-06 m in the file, but 3e-06 m in --spacing"),
    "spacing without unit": ("1 2 1 2\n2 1 2 1\n", ["--spacing", "2"], "--spacing: found '2', expected a length > 0 with its unit"),
    "thousands": ("0;1,234\n1;2,345\n2;1,111\n", ["--unit", "um"], "expected --decimal . or ,"),
    "one number or two": ("0,5\n1,5\n2,5\n", ["--unit", "um"], "one number or several, expected --decimal ."),
    "words": ("x_mm;z_um\n0;1\n1;high\n2;1\n", [], "line 3: found 'high', expected a number with decimal mark ."),
    "too high": ("0 1\n1 2e9\n2 1.5e9\n3 0\n", ["--unit", "mm"], "expected heights up to 1000 m"),
    "too far": ("0 1\n1e200 2\n2e200 3\n", ["--unit", "mm"], "expected heights up to 1000 m and spacings from 1e-15"),
    "too few": ("x_mm;z_um\n0;1\n1;2\n2\n", [], "line 4: found 1 numbers, expected 2 as in line 2"),
    "a first row with a word": ("x_mm;z_um\n0;1x\n1;2\n2;5\n", ["--unit", "mm,um"], "line 2: found '0;1x' above the numbers"),
    "equal": ("x_mm;z_um\n0;1\n1;1\n2;1\n", [], "found 3 heights, all equal or none"),
    "empty": ("", [], "found no rows of numbers"),
    "prose": ("no topography\n", [], "found no rows of numbers"),
    "mark": ("x_mm;z_um\n" + PROFILE + "10;-9999\n", [], "found 1 heights of -9999 um far from all others, 0.1 to 0.9 um"),
    "gap": ("x_mm;z_um\n" + PROFILE + "12;0.5\n", [], "2 of 13 points are missing, the first x = 10000 um from the first point"),
    "BAD": ("x_mm;z_um\n" + PROFILE + "10;BAD\n11;0.3\n", [], "found that 1 of 12 points are missing, the first x = 10000 um"),
    "blank": ("x_mm;z_um\n" + PROFILE + "10;\n11;0.3\n", [], "expected all, or --fill to interpolate them"),
}


@pytest.mark.parametrize(("text", "options", "words"), REFUSED.values(), ids=REFUSED)
def test_what_is_in_doubt_is_refused(convert, tmp_path, text, options, words):
    (tmp_path / "scan.txt").write_text(text, encoding="utf-8")
    status, said = convert("scan.txt", "out.h5", *options)
    assert (status, said.startswith("asperity-heights: scan.txt: ") or said.startswith("asperity-heights: ")) == (1, True)
    assert words in said
    assert not list(tmp_path.glob("out*"))


READ = {
    "mixed decimals": ("0.5;1,25\n1.5;2,5\n2.5;0,25\n", ["--unit", "um"], [1.25, 2.5, 0.25], [1]),
    "thousands": ('"0","1,234.5"\n"1,000","2,345.5"\n"2,000","1.5"\n', ["--unit", "um"], [1234.5, 2345.5, 1.5], [1000]),
    "told thousands": ("0;1,234\n1;2,345\n2;1,111\n", ["--unit", "um", "--decimal", "."], [1234, 2345, 1111], [1]),
    "told decimals": ("0;1,234\n1;2,345\n2;1,111\n", ["--unit", "um", "--decimal", ","], [1.234, 2.345, 1.111], [1]),
    "one column": ("0,5\n1,5\n2,25\n", ["--unit", "um", "--decimal", ",", "--spacing", "2"], [0.5, 1.5, 2.25], [2]),
    "Fortran": ("0 1.5D-1\n1 2.5d0\n2 -1D0\n", ["--unit", "um"], [0.15, 2.5, -1], [1]),
    "mark": ("0 1\n1 999\n2 3\n3 2\n", ["--unit", "um", "--missing", "999", "--fill"], [1, 2, 3, 2], [1]),
    "mark is a position": ("0 1\n1 2\n2 1\n3 0\n4 3\n", ["--unit", "um", "--missing", "1", "--fill"], [2, 2, 1, 0, 3], [1]),
    "blank rows": ("x_um;z_um;\n0;1;\n1;2;\n2;5;\n;;\n", [], [1, 2, 5], [1]),
    "word": ("0;1\n1;out\n2;3\n", ["--unit", "um", "--missing", "out", "--fill"], [1, 2, 3], [1]),
    "no mark": ("0 1\n1 2\n2 3\n3 -9999\n", ["--unit", "um", "--missing", "none"], [1, 2, 3, -9999], [1]),
    "gap": ("0 1\n1 2\n4 5\n5 1\n6 2\n", ["--unit", "um", "--fill"], [1, 2, 3, 4, 5, 1, 2], [1]),
    "words": ("0;1\n1;n/a\n2;BAD\n3;4\n4;\n", ["--unit", "um", "--fill"], [1, 2, 3, 4, 4], [1]),
    "list with a hole": (
        "0 0 1\n1 0 2\n2 0 3\n0 1 1\n2 1 3\n",
        ["--unit", "um", "--fill", "--columns", "1,2,3"],
        [[1, 2, 3], [1, 2, 3]],
        [1, 1],
    ),
    "a row of a matrix": ("1 2 4 3\n", ["--unit", "um", "--spacing", "3um"], [1, 2, 4, 3], [3]),
    "two spacings": ("1 2 4 3\n4 1 2 2\n", ["--unit", "um", "--spacing", "3um,5um"], [[1, 2, 4, 3], [4, 1, 2, 2]], [3, 5]),
    "printed positions": ("0.00 1\n0.33 2\n0.67 1\n1.00 4\n", ["--unit", "um"], [1, 2, 1, 4], [1 / 3]),
}


@pytest.mark.parametrize(("text", "options", "z", "spacing"), READ.values(), ids=READ)
def test_what_is_said_is_read(convert, tmp_path, text, options, z, spacing):
    (tmp_path / "scan.txt").write_text(text, encoding="utf-8")
    status, words = convert("scan.txt", "out.h5", *options)
    assert status == 0, words
    assert ("linear interpolation" in words) == ("--fill" in options)
    found = written()
    np.testing.assert_allclose(found[0], np.array(z) * 1e-6, rtol=1e-12)
    np.testing.assert_allclose(found[1], np.array(spacing) * 1e-6, rtol=1e-12)


def test_arrays_of_numpy(convert, tmp_path):
    z = np.random.default_rng(1).standard_normal((12, 9)).astype(np.float32)
    np.save(tmp_path / "z.npy", z)
    assert convert("z.npy", "out.h5", "--unit", "um", "--spacing", "2,3")[0] == 0
    np.testing.assert_allclose(written()[0], z.astype(float) * 1e-6, rtol=1e-12)
    np.testing.assert_allclose(written()[1], [2e-6, 3e-6])
    np.save(tmp_path / "xz.npy", np.column_stack([np.arange(12) * 0.5, z[:, 0]]))
    assert convert("xz.npy", "out.h5", "--unit", "mm,um")[0] == 0
    np.testing.assert_allclose(written()[0], z[:, 0].astype(float) * 1e-6, rtol=1e-12)
    others = {"text": np.array(["a"]), "object": np.array([{}]), "three": np.zeros((2, 2, 2)), "none": np.zeros(0)}
    for name, array in others.items():
        np.save(tmp_path / f"{name}.npy", array)
        assert convert(f"{name}.npy", "new.h5", "--unit", "um", "--spacing", "2")[0] == 1
    whole = (tmp_path / "z.npy").read_bytes()
    for data in (whole[:200], whole[:20], whole.replace(b"}", b" "), whole.replace(b"(12, 9)", b"(99999999999, 9)")):
        (tmp_path / "cut.npy").write_bytes(data)
        assert convert("cut.npy", "new.h5", "--unit", "um", "--spacing", "2")[0] == 1


def test_only_its_own_files_are_replaced(convert, tmp_path):
    (tmp_path / "scan.txt").write_text("x_mm;z_um\n" + PROFILE, encoding="utf-8")
    assert convert("scan.txt", "out.h5")[0] == convert("scan.txt", "out.h5")[0] == 0
    with h5py.File("other.h5", "w") as file:
        file["z"] = 1
    (tmp_path / "text.h5").write_text("mine", encoding="utf-8")
    for name in ("other.h5", "text.h5"):
        before = (tmp_path / name).read_bytes()
        status, words = convert("scan.txt", name)
        assert (status, f"{name}: found a file that asperity-heights did not write" in words) == (1, True)
        assert (tmp_path / name).read_bytes() == before
        assert convert("scan.txt", name, "--force")[0] == 0
    (tmp_path / "own.h5").write_text("x_mm;z_um\n" + PROFILE, encoding="utf-8")
    assert convert("own.h5", "own.h5", "--force")[0] == 1
    (tmp_path / "folder.h5").mkdir()
    assert convert("scan.txt", "folder.h5", "--force")[0] == 1
    assert convert("scan.txt", "out.csv")[0] == convert("none.txt", "new.h5")[0] == convert("scan.txt")[0] == 1
    assert convert("scan.txt", "missing/out.h5")[0] == 3
    assert not [path.name for path in tmp_path.iterdir() if "part" in path.name]


def test_names_that_are_no_text(convert, tmp_path):
    name = os.fsdecode(b"scan \xb5m.txt")
    (tmp_path / name).write_text("x [mm];z [\u03bcm]\n" + PROFILE, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "python"), "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    command = [sys.executable, "-m", "asperity.heights", name, "out.h5"]
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b"2 z [\\u03bcm] (0.1 to 0.9)" in done.stdout
    assert convert(name, "out.csv")[0] == 1


def test_the_program_reads_what_is_written(asperity, tmp_path):
    """A profile and an area, through the command of a checkout."""
    command = ROOT / "build" / "bin" / "asperity-heights"
    for kind, problem in (("running number", "dry_line"), ("list of area", "dry_area")):
        sample = Sample(kind, 5)
        sample.units = ["um", "nm"]
        (tmp_path / "scan.txt").write_bytes(sample.data())
        done = called([command, "scan.txt", "scan.h5", *sample.options], cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
        surface = "shape = 'file', file = 'scan.h5', dataset = 'z', detrend = 'none'"
        with solve(asperity, tmp_path, surface, [1e3], "", LEAN, problem=problem) as file:
            z = file["solution/height_undeformed"][()]
            np.testing.assert_allclose(z, sample.z * 1e-9, rtol=1e-12, atol=1e-21)
            assert file["solution/x"][1] - file["solution/x"][0] == pytest.approx(sample.step * 1e-6, rel=1e-9, abs=0)


def test_without_the_library_it_is_said(tmp_path):
    # A module of that name that fails stands for one that is missing.
    (tmp_path / "SurfaceTopography.py").write_text("raise ImportError('No module named muFFT')\n", encoding="utf-8")
    (tmp_path / "scan.x3p").write_bytes(b"PK\x03\x04\x00")
    folders = [str(tmp_path), str(ROOT / "python")]
    command = f"import sys; sys.path[:0] = {folders!r}; import asperity.heights as h; sys.exit(h.main())"
    done = ended(called([sys.executable, "-c", command, "scan.x3p", "out.h5"], cwd=tmp_path), 1)
    words = f"scan.x3p: found no text; the files of instruments need a library: {sys.executable} -m pip install Surface"
    assert words in done.stderr


@pytest.fixture
def library():
    if importlib.util.find_spec("SurfaceTopography") is None:
        pytest.skip("not applicable: SurfaceTopography is not installed (.venv/bin/python -m pip install SurfaceTopography)")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return importlib.import_module("SurfaceTopography")


def measured(nx=24, ny=16):
    """Heights [µm], first index x."""
    x, y = np.arange(nx)[:, None] / nx, np.arange(ny)[None, :] / ny
    return np.cos(2 * np.pi * (2 * x + y)) + 0.5 * np.sin(2 * np.pi * 3 * y) + x


@pytest.mark.parametrize("ending", ["nc", "x3p"])
def test_area_of_an_instrument(library, convert, tmp_path, ending):
    z = measured()
    topography = library.Topography(z, (48.0, 64.0), unit="µm")
    {"nc": topography.to_netcdf, "x3p": topography.to_x3p}[ending](str(tmp_path / f"scan.{ending}"))
    status, words = convert(f"scan.{ending}", "out.h5")
    assert status == 0, words
    assert "24 x 16 points, spacing 2 x 4 um, length 46 x 60 um" in words
    np.testing.assert_allclose(written()[0], z.T * 1e-6, rtol=0, atol=1e-14)
    np.testing.assert_allclose(written()[1], [2e-6, 4e-6], rtol=1e-12)
    assert "found --spacing, expected it for a table only" in convert(f"scan.{ending}", "out.h5", "--spacing", "1um")[1]
    assert "expected no --unit" in convert(f"scan.{ending}", "out.h5", "--unit", "mm")[1]
    told = convert(f"scan.{ending}", "out.h5", "--channel", "3")[1]
    assert "found 1 channels of heights (1 Default), expected --channel N" in told
    data = bytearray((tmp_path / f"scan.{ending}").read_bytes())
    for seed in range(6):
        damaged = data[: len(data) // 2] if seed == 0 else bytearray(data)
        for place in random.Random(seed).sample(range(len(damaged)), 40):
            damaged[place] ^= 0x15
        (tmp_path / f"scan.{ending}").write_bytes(damaged)
        assert convert(f"scan.{ending}", "out.h5")[0] in (0, 1)


def test_gaps_of_an_instrument(library, convert, tmp_path):
    z = measured()
    holes = np.ma.masked_array(z, mask=np.zeros_like(z, dtype=bool))
    holes[5:7, 3] = np.ma.masked
    library.Topography(holes, (48.0, 64.0), unit="µm").to_netcdf(str(tmp_path / "scan.nc"))
    assert "found that 2 of 384 points are missing, the first x = 10 um, y = 12 um" in convert("scan.nc", "out.h5")[1]
    assert convert("scan.nc", "out.h5", "--fill")[0] == 0
    filled = written()[0].T * 1e6
    np.testing.assert_allclose(filled[~holes.mask], z[~holes.mask], atol=1e-9)
    assert np.all(np.abs(filled - z) < 1)


def test_bytes_of_no_format(library, convert, tmp_path):
    assert library is not None
    for seed in range(5):  # of the size of a tile of terrain too, which has no mark
        (tmp_path / "scan.dat").write_bytes(random.Random(seed).randbytes(2 * 40**2))
        assert "found no text, and no format that SurfaceTopography reads" in convert("scan.dat", "out.h5")[1]

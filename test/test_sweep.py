"""batch/sweep.py: from a TOML file to checked namelists and an index."""

import codecs
import fcntl
import keyword
import os
import random

import cases
import f90nml
import numpy as np
import pytest
from case_folder import read_folder
from case_plan import read_base
from cases import BASE, write, write_sweep
from formulas import CONSTANTS, FUNCTIONS, FormulaError, evaluate
from gather import MEANINGS
from result_row import GROUPS, PASSED
from sweep_file import SweepError, read_sweep_file

TOP = 'base = "base.nml"\n'
HEAD = TOP + "[vary]\n"
LOAD = HEAD + "load.hertz_pressure = "


@pytest.fixture
def sweep(batch, tmp_path):
    def run(text, *options, base=BASE, status=0):
        write_sweep(tmp_path, text, base)
        return batch("sweep.py", "small.toml", *options, status=status)

    return run


def rows_of(folder):
    return cases.rows(folder / "index.csv")


def column(folder, head):
    return [float(row[head]) for row in rows_of(folder)]


def namelist(folder, number):
    return f90nml.read(folder / "cases" / f"case_{number:04d}.nml")


def test_product_of_a_list_and_two_ranges(sweep, tmp_path):
    text = HEAD + (
        "load.hertz_pressure = [0.5e9, 0.7e9]\n"
        'bodies.speed_1 = { from = 0.01, to = 1.0, count = 3, spacing = "log" }\n'
        "lubricant.viscosity = { from = 0.1, to = 0.3, count = 3 }\n"
        '[formula]\nbodies.speed_2 = "2*bodies.speed_1"\nratio = "bodies.speed_2/bodies.speed_1"\n'
    )
    assert sweep(text).stdout == "small: 18 cases, checked\n"
    folder = tmp_path / "small"
    assert column(folder, "load.hertz_pressure [Pa]") == [0.5e9] * 9 + [0.7e9] * 9
    assert column(folder, "bodies.speed_1 [m/s]")[:9] == [0.01] * 3 + [0.1] * 3 + [1.0] * 3
    assert column(folder, "lubricant.viscosity [Pa s]")[:3] == [0.1, 0.2, 0.3]
    assert column(folder, "ratio") == [2.0] * 18
    for number, row in enumerate(rows_of(folder), start=1):
        groups = namelist(folder, number)
        assert row["case"] == f"case_{number:04d}"
        assert groups["bodies"]["speed_2"] == 2 * groups["bodies"]["speed_1"] == 2 * float(row["bodies.speed_1 [m/s]"])
        assert groups["lubricant"]["viscosity"] == float(row["lubricant.viscosity [Pa s]"])
        assert groups["bodies"]["reduced_radius"] == 0.01  # of the base case: the namelist is complete


def test_values_of_ranges_are_where_numpy_puts_them(sweep, tmp_path):
    text = LOAD + '{ from = 0.3e9, to = 0.9e9, count = 7, spacing = "log" }\n'
    sweep(text)
    # values are written with 12 digits, so that 0.3 stays 0.3
    np.testing.assert_allclose(column(tmp_path / "small", "load.hertz_pressure [Pa]"), np.geomspace(0.3e9, 0.9e9, 7), rtol=1e-11)


def test_together_goes_step_by_step_integers_stay_integers_and_keys_are_left_out(sweep, tmp_path):
    text = TOP + 'together = ["domain.intervals", "lubricant.viscosity"]\nleave_out = ["load.hertz_pressure"]\n[vary]\n'
    sweep(text + "domain.intervals = [64, 128]\nload.load_per_length = [1e5, 2e5]\nlubricant.viscosity = [0.1, 0.2]\n")
    folder = tmp_path / "small"
    found = [(int(row["domain.intervals [1]"]), float(row["lubricant.viscosity [Pa s]"])) for row in rows_of(folder)]
    assert found == [(64, 0.1)] * 2 + [(128, 0.2)] * 2
    assert namelist(folder, 3)["domain"]["intervals"] == 128
    assert dict(namelist(folder, 2)["load"]) == {"load_per_length": 2e5}


@pytest.mark.parametrize(("method", "count"), [("sobol", 64), ("latin_hypercube", 50)])
def test_samples_fill_their_ranges_evenly(sweep, tmp_path, method, count):
    text = TOP + f'[sample]\nmethod = "{method}"\ncount = {count}\nseed = 3\n[vary]\n'
    text += "load.hertz_pressure = { from = 3e8, to = 9e8 }\n"
    text += 'lubricant.viscosity = { from = 0.01, to = 1.0, spacing = "log" }\n'
    text += "domain.intervals = [64, 128]\n"
    sweep(text)
    folder = tmp_path / "small"
    assert len(rows_of(folder)) == 2 * count  # the sample times the list
    pressure = np.array(column(folder, "load.hertz_pressure [Pa]"))[::2]
    viscosity = np.array(column(folder, "lubricant.viscosity [Pa s]"))[::2]
    for share in ((pressure - 3e8) / 6e8, np.log10(viscosity / 0.01) / 2):
        # both kinds have exactly one point in each of `count` slices of every range: that is what they are for
        assert sorted(np.floor(share * count)) == list(range(count))
    assert len(set(zip(pressure, viscosity, strict=True))) == count


def test_a_seed_repeats_a_sample_and_integers_are_drawn_as_such(sweep, tmp_path):
    text = TOP + "[sample]\ncount = 8\nseed = 5\n[vary]\nsolver.max_cycles = { from = 1, to = 8 }\n"
    sweep(text, "--output", "one")
    sweep(text, "--output", "two")
    one = [row["solver.max_cycles [1]"] for row in rows_of(tmp_path / "one")]
    assert one == [row["solver.max_cycles [1]"] for row in rows_of(tmp_path / "two")]
    assert sorted(map(int, one)) == list(range(1, 9))


def test_heights_are_found_from_the_new_place(sweep, tmp_path):
    base = (cases.ROOT / "input" / "dry_profile.nml").read_text(encoding="utf-8")
    name = f90nml.reads(base)["surface_1"]["file"]
    base = base.replace(name, os.path.relpath(cases.ROOT / "input" / name, tmp_path))
    sweep(HEAD + "load.mean_pressure = [1e7, 2e7]\n", base=base)  # --check reads the heights


# What is wrong, and what must be said; line 3 is the first one of [vary].
BAD = {
    "an unknown key": (HEAD + "load.hertz_presure = [4e8, 5e8]\n", "small.toml:3: &load hertz_presure: found an unknown key"),
    "an unknown group": (HEAD + "loads.hertz_pressure = [4e8, 5e8]\n", "found an unknown group"),
    "a range of nothing": (LOAD + "{ from = 5e8, to = 5e8, count = 4 }\n", "small.toml:3: load.hertz_pressure"),
    "an empty list": (LOAD + "[]\n", "small.toml:3: found no values for load.hertz_pressure"),
    "no cases": (LOAD + "{ from = 4e8, to = 5e8, count = 0 }\n", "found count = 0, expected an integer >= 1"),
    "a billion cases": (
        LOAD + "{ from = 4e8, to = 5e8, count = 1000000000 }\n",
        "found 1000000000 cases, expected at most 100000 (or --yes",
    ),
    "what the base forbids": (HEAD + "load.load_per_length = [1e5, 2e5]\n", "found more than one load"),
    "one value twice": (LOAD + "[4e8, 5e8, 4e8]\n", "small.toml:3: load.hertz_pressure: found 400000000.0 as value"),
    "a value out of range": (HEAD + "lubricant.viscosity = [0.1, 1e9]\n", "small.toml:3: &lubricant viscosity: found 1000000000.0"),
    "one name for all results": (HEAD + 'case.output = ["a.h5", "b.h5"]\n', "small.toml:3: found case.output: results are named"),
    "no value": (HEAD + 'u = [0.0, 1.0]\n[formula]\nbodies.speed_1 = "1/u"\n', "small.toml:5: bodies.speed_1: '1/u' has no"),
    "an unknown name": (HEAD + 'u = [0.5, 1.0]\n[formula]\nbodies.speed_1 = "2*v"\n', "found v, expected a parameter"),
    "no TOML": (LOAD + "[4e8\n", "small.toml:3: is not TOML"),
    "nothing to vary": (TOP, "small.toml:1: found nothing to vary"),
    "no base": ('base = "none.nml"\n[vary]\nload.hertz_pressure = [4e8]\n', "small.toml:1: there is no base case"),
    "an unknown entry": (TOP + "limit = 3\n[vary]\nload.hertz_pressure = [4e8]\n", "small.toml:2: found the unknown entry limit"),
    "a range without count": (LOAD + "{ from = 4e8, to = 5e8 }\n", "small.toml:3: load.hertz_pressure: found a range"),
    "negative": (HEAD + 'bodies.speed_1 = { from = -1, to = 1, count = 3, spacing = "log" }\n', "expected both ends above zero"),
    "set twice": (LOAD + "[4e8]\n[set]\nload.hertz_pressure = 5e8\n", "small.toml:5: found load.hertz_pressure in"),
    "unequal lengths": (
        TOP + 'together = ["lubricant.viscosity", "load.hertz_pressure"]\n[vary]\nlubricant.viscosity = [0.1]\n'
        "load.hertz_pressure = [4e8, 5e8]\n",
        "small.toml:2: found different numbers of values",
    ),
    "left out twice": (
        TOP + 'leave_out = ["load.load_per_length"]\n[vary]\nload.hertz_pressure = [4e8]\n',
        "small.toml:2: found load.load_per_length in leave_out",
    ),
    "an own name that is a constant": (
        HEAD + 'pi = [1.0, 2.0]\n[formula]\nbodies.speed_1 = "pi*0.1"\n',
        "small.toml:3: found the name pi, which means something else in formulas",
    ),
    "an own name that is a column of the table": (
        LOAD + "[4e8]\nprogram = [1, 2]\n",
        "small.toml:4: found the name program, expected group.key, or a name of your own",
    ),
    "lists ten thousand deep": (HEAD + f"u = {'[' * 10000}{']' * 10000}\n", "small.toml: found lists or tables too deep"),
    "tables ten thousand deep": (HEAD + f"u{'.u' * 10000} = 1\n", "found lists or tables too deep in each other"),
    "400 digits": (HEAD + f"u = {{ from = 1, to = {'1' * 400}, count = 3 }}\n", "small.toml:3: vary.u.to: found an integer of 400"),
    "5000 digits": (HEAD + f"u = [{'1' * 5000}]\n", "small.toml: found a number of thousands of digits"),
    "a date": (HEAD + "u = [2024-02-03, 1]\n", "small.toml:3: vary.u: found the date or time 2024-02-03, expected a number"),
    "NUL in words": (HEAD + 'u = ["a\\u0000b"]\n', "small.toml:3: vary.u: found the character U+0000 in words"),
    "arithmetic with words": (HEAD + 'u = ["a", "b"]\n[formula]\nv = "2*u"\n', "small.toml:5: v: '2*u' has no value: u is 'a'"),
    "huge": (HEAD + 'u = [1]\n[formula]\nv = "((9**999)**999)**999"\n', "small.toml:5: v: '((9**999)**999)**999' has no value"),
    "an odd Sobol sample": (
        TOP + '[sample]\nmethod = "sobol"\ncount = 50\n[vary]\nload.hertz_pressure = { from = 4e8, to = 5e8 }\n',
        "small.toml:2: found 50 points of a Sobol sample",
    ),
}


@pytest.mark.parametrize(("text", "words"), BAD.values(), ids=BAD)
def test_bad_sweeps_are_refused_with_their_line_and_leave_nothing(text, words, sweep, tmp_path):
    assert words in sweep(text, status=1).stderr
    assert sorted(path.name for path in tmp_path.iterdir()) == ["base.nml", "small.toml"]


def test_a_base_that_is_no_namelist(sweep):
    assert "small.toml:1:" in sweep(LOAD + "[4e8]\n", base="&case problem = \n", status=1).stderr


def sweep_of(folder, names):
    return write_sweep(folder, HEAD + "".join(f'"{name}" = [1, 2]\n' for name in names))


def test_every_name_that_formulas_index_and_table_use_themselves_is_refused(tmp_path):
    """Names are taken from where they are used; in capitals they would differ by that alone."""
    own = {*CONSTANTS, *FUNCTIONS, *MEANINGS, "case", PASSED, "h_min_error"}
    own |= {f"{prefix}x" for prefix in (*GROUPS.values(), "scaling_", "summary_") if prefix}
    odd = {"a\u00b5", "\u210e", "x y", "x.y.z", "1a"}  # signs that Python reads as others, and no names at all
    for name in sorted(own | {name.upper() for name in own} | odd | set(keyword.kwlist)):
        with pytest.raises(SweepError, match=r"small\.toml:\d: found the name"):
            read_sweep_file(sweep_of(tmp_path, [name]))
    free = ["slip", "h_min", "Gr\u00f6\u00dfe", "lambda_1", "pi2", "errors", "time.pi", "match"]
    assert [parameter.name for parameter in read_sweep_file(sweep_of(tmp_path, free)).parameters] == free


def test_text_that_looks_like_a_number_stays_text(sweep, tmp_path):
    words = ["1_0", "10", "1e5", "nan", "=1", 'a "b", c', " 2"]
    quoted = ", ".join(f"'{word}'" for word in words)
    text = TOP + f'together = ["case.title", "load.hertz_pressure"]\n[vary]\ncase.title = [{quoted}]\n'
    sweep(text + f"load.hertz_pressure = {[4e8 + 1 / 3 + i for i in range(7)]}\n")
    folder = read_folder(tmp_path / "small")
    assert [row[0] for row in folder.rows] == words
    assert [row[1] for row in folder.rows] == [4e8 + 1 / 3 + i for i in range(7)]
    assert [namelist(tmp_path / "small", i)["case"]["title"] for i in range(1, 8)] == words


def test_an_index_of_an_earlier_version_is_read_and_replaced_by_the_same_sweep(sweep, tmp_path):
    text = LOAD + "[4e8, 5e8]\n"
    sweep(text)
    index = tmp_path / "small" / "index.csv"
    new = index.read_text(encoding="utf-8")
    index.write_text(new.replace('"', "").replace("500000000.0", "1_0"), encoding="utf-8")
    assert read_folder(tmp_path / "small").rows == ((4e8,), ("1_0",))
    sweep(text)
    assert index.read_text(encoding="utf-8") == new


@pytest.mark.parametrize(
    "damage",
    [
        *('"case","x"\n"case_0001",1\n"case_0001",2\n', '"case","x"\n"case_\0001",1\n'),
        *('"case","x","x"\n"case_0001",1,2\n', "1,2\n3,4\n", '"case","x"\n"../case_1",1\n'),
        *('"case","x/y"\n"case_0001",1\n', '"case","x"\n"case_0001"\n', '"case"\n', "", "\n", '"case","x\n'),
    ],
)
def test_a_damaged_index_is_told(tmp_path, damage):
    (tmp_path / "index.csv").write_text(damage, encoding="utf-8")
    with pytest.raises(SweepError, match=r"index\.csv: (is no index of cases|found NUL bytes)"):
        read_folder(tmp_path)


def test_a_base_is_read_the_same_whatever_ends_its_lines(tmp_path):
    """Any mixture of line ends, with and without byte-order mark, subscripts for lists; of the sweep too."""
    source = random.Random(30)
    text = BASE.replace("&load", "! \u00d6l: a comment / & \n&surface_1\n amplitude{}\n wavelength = 1e-4, 2e-4 ! [m]\n/\n&load")
    lists = (" = 1e-7, 2e-7", "(1) = 1e-7\n amplitude(2) = 2e-7", "(2) = 2e-7, amplitude(1) = 1e-7", "(1:2) = 1e-7, 2e-7")
    sweep_file = write_sweep(tmp_path, LOAD + "[4e8]\n")
    write(tmp_path, "base.nml", text.format(lists[0]))
    expected = read_base(read_sweep_file(sweep_file), tmp_path)
    assert expected["surface_1"] == {"amplitude": [1e-7, 2e-7], "wavelength": [1e-4, 2e-4]}
    for _ in range(60):
        ends = source.choice(["\r", "\n", "\r\n", "\r\n "])
        lines = text.format(source.choice(lists)).split("\n")
        mixed = "".join(line + (ends if source.random() < 0.8 else source.choice(["\r", "\n", "\r\n"])) for line in lines)
        (tmp_path / "base.nml").write_bytes(source.choice([b"", codecs.BOM_UTF8]) + mixed.encode())
        end = source.choice([b"\r", b"\n", b"\r\n"])
        sweep_file.write_bytes(source.choice([b"", codecs.BOM_UTF8]) + f"{LOAD}[4e8]\n".encode().replace(b"\n", end))
        assert read_base(read_sweep_file(sweep_file), tmp_path) == expected


@pytest.mark.parametrize(
    ("encoding", "words"),
    [
        ("utf-16", "found UTF-16"),
        ("utf-32", "found UTF-32"),
        ("utf-16-le", "found NUL bytes"),
        ("latin-1", ":2: found the byte 0xD6"),
    ],
)
def test_other_encodings_are_told_by_their_names(tmp_path, encoding, words):
    sweep_file = write_sweep(tmp_path, LOAD + "[4e8]\n")
    content = ("# one\r# \u00d6l\n" + sweep_file.read_text(encoding="utf-8")).encode(encoding)
    (tmp_path / "base.nml").write_bytes(("! one\r! \u00d6l\n" + BASE).encode(encoding))
    with pytest.raises(SweepError, match=rf"small\.toml:1: .*base\.nml:?.*{words}.*, expected a text file in UTF-8"):
        read_base(read_sweep_file(sweep_file), tmp_path)
    sweep_file.write_bytes(content)
    with pytest.raises(SweepError, match=rf"small\.toml:?.*{words}.*, expected a text file in UTF-8"):
        read_sweep_file(sweep_file)


def test_bases_with_subscripts_are_written_as_lists(sweep, tmp_path):
    surface = "&surface_1 shape = 'feature', amplitude(2) = 2e-7, amplitude(1) = 1e-7, wavelength = 2*1e-4, position = -2, -1 /\n"
    base = BASE + surface + "&time transient = .true., end_time = 1.0, time_step = 0.05 /\n"
    sweep(LOAD + "[4e8, 5e8]\n", base=base)
    assert namelist(tmp_path / "small", 1)["surface_1"]["amplitude"] == [1e-7, 2e-7]
    done = sweep(LOAD + "[4e8]\n", "--output", "other", base=base.replace("amplitude(1) = 1e-7,", ""), status=1)
    assert "&surface_1 amplitude: found" in done.stderr


def test_names_of_files_that_are_no_text(batch, tmp_path):
    """Bytes of Latin-1 in the names of sweep and folder: read, printed, and found again."""
    name = os.fsdecode(b"s\xf6")
    write_sweep(tmp_path, LOAD + "[4e8]\n", BASE, f"{name}.toml")
    assert batch("all.py", f"{name}.toml").stdout.startswith("s\\udcf6: 1 cases, checked\n")
    assert (tmp_path / name / "gathered.h5").exists()


def test_the_same_sweep_again_changes_nothing_and_another_one_needs_a_word(sweep, tmp_path):
    first = LOAD + "[4e8, 5e8, 6e8]\n"
    other = LOAD + "[4e8, 7e8]\n"
    sweep(first)
    result = tmp_path / "small" / "cases" / "case_0001.h5"
    result.write_text("kept", encoding="utf-8")
    stamp = (tmp_path / "small" / "cases" / "case_0001.nml").stat().st_mtime_ns
    sweep(first)
    assert "holds another sweep (1 cases differ)" in sweep(other, status=1).stderr
    assert len(rows_of(tmp_path / "small")) == 3
    sweep(other, "--replace")
    assert column(tmp_path / "small", "load.hertz_pressure [Pa]") == [4e8, 7e8]
    assert sorted(path.name for path in (tmp_path / "small" / "cases").glob("*.nml")) == ["case_0001.nml", "case_0002.nml"]
    assert (tmp_path / "small" / "cases" / "case_0001.nml").stat().st_mtime_ns == stamp
    assert result.read_text(encoding="utf-8") == "kept"
    assert list(tmp_path.glob("*.part")) == []


def test_a_folder_that_another_process_is_writing(sweep, tmp_path):
    part = tmp_path / "small.part"
    part.mkdir()
    descriptor = os.open(part, os.O_RDONLY)
    fcntl.flock(descriptor, fcntl.LOCK_EX)
    assert "another process is writing this sweep" in sweep(LOAD + "[4e8]\n", status=1).stderr
    os.close(descriptor)
    sweep(LOAD + "[4e8]\n")  # the one that was killed has left its folder


def test_a_folder_of_the_user_is_left_alone(sweep, tmp_path):
    (tmp_path / "small").mkdir()
    (tmp_path / "small" / "thesis.txt").write_text("mine", encoding="utf-8")
    assert "is there and no sweep" in sweep(LOAD + "[4e8]\n", status=1).stderr
    assert [path.name for path in (tmp_path / "small").iterdir()] == ["thesis.txt"]


@pytest.mark.parametrize("path", sorted((cases.ROOT / "input" / "sweeps").glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_sweeps_pass_their_checks(batch, path, tmp_path):
    batch("sweep.py", path)
    assert len(rows_of(tmp_path / path.stem)) > 10


def test_formulas():
    known = {"u": 3.0, "bodies.speed_1": 2.0, "n": 5}
    assert evaluate("u**2 + 2*bodies.speed_1/4 - (n % 3)", known.get) == 8.0
    assert evaluate("round(sqrt(u*3)) + min(n, 7) + abs(-1)", known.get) == 9
    assert evaluate("cos(pi)", known.get) == -1.0
    for bad in ("__import__('os')", "u.real.imag", "[1]", "9**9**9", "1/0", "sqrt(-1)", "(-1)**0.5", "unknown", "u +", "'text'"):
        with pytest.raises(FormulaError):
            evaluate(bad, known.get)

"""What the command line changes of cases: --set, --keep-going, --output; the table of results; where things are printed."""

import csv
import io
import json
import math
import os
import random
import subprocess

import h5py
import pytest
from cases import MOES, POINT, ROOT, STEADY, contents, damaged, ended, seal, text, write

COARSE = STEADY.replace("intervals = 256", "intervals = 64") + "&accuracy error_bars = .false. /\n&output adequacy = .false. /\n"
SPHERE = ROOT / "input" / "dry_sphere.nml"
SETS = {
    "load.load_per_length=2e5": ("load_per_length = 1e5", "load_per_length = 2e5"),
    "bodies.speed_2=1.3": ("speed_2 = 1.1", "speed_2 = 1.3"),
    "lubricant.rheology=newtonian": ("rheology = 'eyring', eyring_stress = 3.3e6", "rheology = 'newtonian'"),
    "lubricant.viscosity=0.1": ("viscosity = 0.14", "viscosity = 0.1"),
    "case.title=it's a/b & c ! d": ("'Öl, smooth'", "'it''s a/b & c ! d'"),
    "DOMAIN.Intervals=128": ("intervals = 64", "intervals = 128"),
    "solver.method='newton_dense'": ("&accuracy", "&solver method = 'newton_dense' /\n&accuracy"),
    "time.transient=.false.": ("&accuracy", "&time transient = .false. /\n&accuracy"),
}


def effective(path):
    """What a result says of its input, and its numbers."""
    starts = ("input/effective", "summary", "solution", "@title")
    return {name: value for name, value in contents(path).items() if name.startswith(starts)}


def test_set_is_the_file_with_that_entry(asperity, tmp_path):
    # Random sets of entries; the namelist that the result keeps gives the same case again.
    chance = random.Random(3)
    for _ in range(6):
        chosen = chance.sample(sorted(SETS), 3)
        changed = COARSE
        for entry in chosen:
            changed = changed.replace(*SETS[entry], 1)
        if "lubricant.rheology=newtonian" in chosen:
            chosen.append("lubricant.rheology=newtonian")  # the last one counts
        thinned = COARSE.replace(", eyring_stress = 3.3e6", "") if "lubricant.rheology=newtonian" in chosen else COARSE
        write(tmp_path, "a.nml", thinned)
        write(tmp_path, "b.nml", changed)
        assert asperity("a.nml", "--quiet", *(word for entry in chosen for word in ("--set", entry))).returncode == 0
        assert asperity("b.nml", "--quiet").returncode == 0
        for name in ("a", "b"):
            with h5py.File(tmp_path / f"{name}.h5") as file:
                (tmp_path / f"{name}_again.nml").write_bytes(file["input/namelist"][()])
        assert asperity("a_again.nml", "--quiet").returncode == 0
        wanted = effective(tmp_path / "b.h5")
        for name in ("a", "a_again"):
            found = effective(tmp_path / f"{name}.h5")
            assert found.keys() == wanted.keys()
            assert all(repr(found[key]) == repr(wanted[key]) for key in found)
    # Comments stay, and findings about the rest name the lines of the file.
    content = STEADY.replace("load_per_length = 1e5 /", "load_per_length = 1e5, ! 7 kN/m = not\n ! here\n/").replace("0.14", "-1")
    line = 1 + content[: content.index("viscosity = -1")].count("\n")
    write(tmp_path, "case.nml", content)
    done = asperity("--check", "case.nml", "--set", "load.load_per_length=2e5", "--set", "domain.x_inlet=-5")
    assert done.stderr.startswith(f"case.nml:{line}: &lubricant viscosity: found -1, expected ")
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("load.load_per_length=-1", "&load load_per_length: found -1, expected a real number >= 1e-6, <= 1e12 [N/m]"),
        ("load.load_per_length=1 2", "&load load_per_length: found 2 values, 1 2, expected a real number >= 1e-6"),
        ("load.lod=1", "&load 'lod': found an unknown key"),
        ("lod.load=1", "&lod: found an unknown group, expected one of those that asperity --keys lists; did you mean &load?"),
        (
            "lubricant.rheology=eyrin",
            "&lubricant rheology: found 'eyrin', expected 'newtonian' or 'eyring'; did you mean 'eyring'?",
        ),
        ("time.end_time=3", "&time end_time: not used with transient = .false.: remove it"),
    ],
)
def test_findings_name_set(asperity, tmp_path, entry, message):
    write(tmp_path, "case.nml", STEADY)
    done = ended(asperity("--check", "case.nml", "--set", entry), 1)
    assert f"case.nml: --set: {message}".replace("'lod'", "lod") in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "entry", ["load", "load=1", "load.x", ".x=1", "a.=1", "a.b=", "a.b=1 /", "a.b=1, c=2", "a.b=1!", "a.b='x", "a.b=1\n2"]
)
def test_what_is_no_entry_is_refused(run_case, tmp_path, entry):
    assert run_case(STEADY, "--set", entry, status=1).stderr.startswith("found --set")
    assert not (tmp_path / "case.h5").exists()


@pytest.mark.path
def test_keep_going_runs_the_good_cases(asperity, tmp_path):
    write(tmp_path, "good.nml", COARSE)
    write(tmp_path, "bad.nml", COARSE.replace("1e5", "-1"))
    write(tmp_path, "late.nml", STEADY + "&solver start = 'hertz', max_cycles = 1 /\n")
    cases = ("bad.nml", "good.nml", "none.nml", "late.nml")
    assert asperity(*cases, "--quiet").returncode == 1
    assert not list(tmp_path.glob("*.h5"))
    done = ended(asperity(*cases, "--quiet", "--keep-going", "--outcomes"), 2)
    told = [["1", "bad.nml"], ["1", "none.nml"], ["0", "good.nml"], ["2", "late.nml"]]
    assert [line.split("\t")[:2] for line in done.stdout.splitlines()] == told
    assert "&load load_per_length: found -1" in done.stdout
    assert "bad.nml:4: &load load_per_length: found -1, expected" in done.stderr
    assert sorted(path.name for path in tmp_path.glob("*.h5")) == ["good.h5", "late.h5"]
    done = asperity("--check", "--keep-going", "bad.nml", "good.nml")
    assert (done.returncode, done.stdout) == (1, "good.nml: no findings\n")


def test_names_of_files_and_folders(asperity, tmp_path, run_case):
    write(tmp_path, "case.nml", COARSE)
    assert asperity("--check", "case.nml", "--output", "deep/er").returncode == 0
    assert not (tmp_path / "deep").exists()
    assert asperity("case.nml", "--quiet", "--output", "deep/er/").returncode == 0
    assert (tmp_path / "deep" / "er" / "case.h5").is_file()
    assert "case.nml is a file, not a folder" in run_case(COARSE, "--quiet", "--output", "case.nml", status=3).stderr
    assert (tmp_path / "case.nml").read_text(encoding="utf-8") == COARSE
    run_case(COARSE, "--quiet")
    told = "case.h5:1: found an HDF5 file, expected a namelist (results are shown by asperity table)\n"
    assert ended(asperity("case.h5"), 1).stderr == told
    write(tmp_path, "case.nml", COARSE)
    assert asperity("case").stderr == "case: no such file; did you mean case.nml?\n"
    assert asperity("other").stderr == "other: no such file\n"


@pytest.fixture(name="results")
def _results(asperity, tmp_path):
    write(tmp_path, "oil.nml", STEADY)
    write(tmp_path, "moes.nml", MOES)
    write(tmp_path, "late.nml", STEADY + "&solver start = 'hertz', max_cycles = 1 /\n")
    write(tmp_path, "ball.nml", SPHERE.read_text())
    write(tmp_path, "point.nml", POINT)
    assert asperity("oil.nml", "moes.nml", "late.nml", "ball.nml", "point.nml", "--quiet").returncode == 2
    (tmp_path / "text.h5").write_text("no result")
    (tmp_path / "cut.h5").write_bytes((tmp_path / "oil.h5").read_bytes()[:3000])
    with h5py.File(tmp_path / "other.h5", "w") as file:
        file["summary/h_min"] = 1.0
    return ["oil.h5", "moes.h5", "late.h5", "ball.h5", "point.h5", "text.h5", "cut.h5", "other.h5", "none.h5"]


@pytest.mark.path
def test_table_has_a_row_for_each_result(asperity, tmp_path, results):
    forms = {form: asperity("table", *results, "--format", form) for form in ("text", "csv", "json")}
    assert {done.returncode for done in forms.values()} == {1}
    assert asperity("table", *results[:5]).returncode == 0
    shown = forms["text"].stdout.splitlines()
    assert asperity("table", *results).stdout == forms["text"].stdout
    rows = {
        "csv": list(csv.DictReader(io.StringIO(forms["csv"].stdout))),
        "json": list(map(json.loads, forms["json"].stdout.splitlines())),
    }
    for found in rows.values():
        assert [row["file"] for row in found] == results
    assert [line.split()[0] for line in shown[1:]] == results
    for i, name in enumerate(results):
        if i > 4:
            assert rows["json"][i]["converged"] is None
            assert rows["csv"][i]["converged"] == ""
            assert rows["json"][i]["reason"] == rows["csv"][i]["reason"]
            assert shown[i + 1].endswith(f"NOT READ: {rows['json'][i]['reason']}")
            continue
        with h5py.File(tmp_path / name) as file:
            assert rows["json"][i]["converged"] == bool(file.attrs["converged"])
            assert rows["json"][i]["reason"] == rows["csv"][i]["reason"] == text(file.attrs["reason"])
            summary = file["summary"]
            known = [key for key in rows["json"][i] if key in summary]
            assert "p_max" in known
            for key in known:
                cell, units = rows["json"][i][key], text(summary[key].attrs["units"])
                assert cell["value"] == pytest.approx(summary[key][()], rel=1e-11, abs=0)
                assert cell["units"] == units
                error = summary[key].attrs["error_estimate"]
                assert cell["error_estimate"] == (pytest.approx(error, rel=1e-11, abs=0) if math.isfinite(error) else None)
                column = f"{key} [{units}]"
                assert float(rows["csv"][i][column]) == cell["value"]
    assert "NOT CONVERGED: " in shown[3]
    assert "no such file" in shown[-1] and "NOT READ: " in shown[-2]
    assert "h_min [1]" in rows["csv"][0]
    table = list(csv.reader(io.StringIO(asperity("table", "oil.h5", "--profiles").stdout)))
    assert table[0][:3] == ["x [m]", "pressure [Pa]", "film_thickness [m]"]
    with h5py.File(tmp_path / "oil.h5") as file:
        assert {name.split()[0] for name in table[0]} == {name for name, array in file["solution"].items() if array.shape}
        for i, name in enumerate(table[0]):
            array = file["solution"][name.split()[0]]
            assert [float(row[i]) for row in table[1:]] == pytest.approx(array[()] * array.attrs["si_scale"], rel=1e-10, abs=0)
    for name in results[5:]:
        assert ended(asperity("table", name, "--profiles"), 1).stderr.startswith(f"{name}: ")
    for name in results[3:5]:
        assert "an area has maps" in ended(asperity("table", name, "--profiles"), 1).stderr


def test_table_refuses_what_is_not_whole(run_case, asperity, tmp_path):
    """Forty damaged copies, one with a bit of h_min turned over, one changed by another program: no row has other numbers."""
    run_case(COARSE, "--quiet", name="a")
    whole = (tmp_path / "a.h5").read_bytes()
    source, names = random.Random(20261125), [f"damaged_{number}.h5" for number in range(40)]
    for name in names:
        (tmp_path / name).write_bytes(damaged(whole, source))
    with h5py.File(tmp_path / "a.h5") as file:
        place = whole.index(file["summary/h_min"][()].tobytes())
    (tmp_path / "bit.h5").write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1 :])
    (tmp_path / "changed.h5").write_bytes(whole)
    with h5py.File(tmp_path / "changed.h5", "r+") as file:
        file["summary/h_min"][()] *= 2
    done = asperity("table", "a.h5", "bit.h5", "changed.h5", *names, "--format", "json")
    first, bit, changed, *rows = map(json.loads, done.stdout.splitlines())
    assert done.returncode == 1
    assert (bit["converged"], bit["reason"]) == (None, "it is damaged: its checksum differs")
    assert changed["converged"] is None
    assert "it has no checksum" in changed["reason"]
    assert sum(row["converged"] is None for row in rows) > 30
    for row in rows:
        assert row["converged"] is None or row | {"file": "a.h5"} == first, row["file"]
    seal(tmp_path / "changed.h5")
    (sealed,) = map(json.loads, asperity("table", "changed.h5", "--format", "json").stdout.splitlines())
    assert sealed["h_min"]["value"] == 2 * first["h_min"]["value"]


@pytest.mark.parametrize("what", ["--check", "--check, bad", "--check, one name", "text", "csv", "json"])
def test_many_files_take_their_number_in_time(run_case, program, tmp_path, what):
    """Four times as many: four times the processor time, not sixteen times."""
    run_case(COARSE, "--quiet", name="a")
    result = (tmp_path / "a.h5").read_bytes()
    case = {
        "--check, bad": COARSE.replace("speed_2", "sped_2"),
        "--check, one name": COARSE.replace("&case", "&case output = 'b.h5',"),
    }

    def seconds(count):
        names = [f"{number}.{'nml' if what.startswith('--check') else 'h5'}" for number in range(count)]
        for name in names:
            (tmp_path / name).write_bytes(case.get(what, COARSE).encode() if what.startswith("--check") else result)
        words = [*names, "--check"] if what.startswith("--check") else ["table", *names, "--format", what]
        with subprocess.Popen([program, *words], cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as running:
            _, status, usage = os.wait4(running.pid, 0)
            running.returncode = os.waitstatus_to_exitcode(status)
        assert running.returncode == (1 if "," in what else 0)
        return usage.ru_utime + usage.ru_stime

    assert seconds(800) < 8 * seconds(200)

"""`asperity --summary`: the rows are what gather reads of results, whatever happens to the process; batch/run.py --numbers."""

import resource
import shutil
import signal
import subprocess
import time
from types import SimpleNamespace

import cases
import h5py
import numpy as np
import pytest
from cases import BATCH, LONG, MOES, POINT, ROOT, STEADY, TRANSIENT, ended, rows, swept, write
from kill_and_resume import start
from number_table import RowError, places_in, read_row
from result_row import RowReader
from test_batch_run import module_of

BARE = "&accuracy error_bars = .false. /\n&output adequacy = .false. /\n"
SPHERE = (ROOT / "input" / "dry_sphere.nml").read_text(encoding="utf-8").replace("intervals_x = 64", "intervals_x = 32")
PROFILE = (ROOT / "input" / "dry_profile.nml").read_text(encoding="utf-8").replace("file = '", f"file = '{ROOT}/input/")
FEW = "&solver method = 'fas_block_jacobi', max_cycles = 1 /\n"
KINDS = {
    "bars": STEADY,
    "few": STEADY + FEW,
    "passage": TRANSIENT + BARE,
    "mixed": STEADY.replace("speed_1 = 0.1,", "speed_1 = 0.1, roughness_1 = 1e-6,") + BARE,
    "moes": MOES,
    "sphere": SPHERE,
    "profile": PROFILE,
    "point": POINT,
    "point_passage": POINT + "&time transient = .true., end_time = 0.5, time_step = 0.1 /\n",
    "point_few": POINT + "&solver max_cycles = 1 /\n",
}


def row_of(folder, case, table="t.csv"):
    return RowReader().read_table(folder / table, places_in(folder / table)[case], folder / f"{case}.nml")


@pytest.mark.parametrize("kind", KINDS)
def test_a_row_is_what_gather_reads_of_a_result(asperity, tmp_path, kind):
    namelist = write(tmp_path, f"{kind}.nml", KINDS[kind])
    done = asperity(f"{kind}.nml", "--quiet", "--outcomes", "--summary", "t.csv")
    assert sorted(path.name for path in tmp_path.iterdir()) == [f"{kind}.nml", "t.csv"]
    other = asperity(f"{kind}.nml", "--quiet", "--outcomes")
    assert (done.returncode, done.stdout, done.stderr) == (other.returncode, other.stdout, other.stderr)
    reader = RowReader()
    wanted, found = reader.read(tmp_path / f"{kind}.h5", namelist), row_of(tmp_path, kind)
    assert (found.outcome, found.reason, found.program) == (wanted.outcome, wanted.reason, wanted.program)
    assert found.values.keys() == wanted.values.keys()
    assert len(found.values) > 20
    for name, value in wanted.values.items():
        if "seconds" not in name and "memory" not in name:
            assert repr(found.values[name]) == repr(value), name
    units = {}
    read_row(tmp_path / "t.csv", places_in(tmp_path / "t.csv")[kind], units)
    assert units == {name: reader.units.get(name, "") for name in units}
    # what the program has used stands there, too, with its unit
    row = rows(tmp_path / "t.csv")[0]
    keys = {name.split(" ")[0]: value for name, value in row.items() if "." in name.split(" ")[0]}
    with h5py.File(tmp_path / f"{kind}.h5") as file:
        for group, item in file["input/effective"].items():
            for key, value in item.attrs.items():
                if f"{group}.{key}" in keys and np.ndim(value) == 0:
                    number = isinstance(value, int | float | np.number)
                    assert (float(keys[f"{group}.{key}"]) == value) if number else (keys[f"{group}.{key}"] == cases.text(value))


def test_two_processes_write_one_table(program, tmp_path):
    names = [f"case_{i:02d}.nml" for i in range(24)]
    for name in names:
        write(tmp_path, name, STEADY + BARE)
    command = [str(program), "--quiet", "--summary", "t.csv"]
    both = [subprocess.Popen([*command, *names[i::2]], cwd=tmp_path) for i in (0, 1)]
    assert [process.wait(timeout=cases.HANGING) for process in both] == [0, 0]
    found = rows(tmp_path / "t.csv")
    assert sorted(row["case"] for row in found) == names
    assert not any(None in row or None in row.values() for row in found)  # cells beyond the head, or too few


def test_what_a_killed_process_leaves_of_a_line_is_cut(asperity, tmp_path):
    table = tmp_path / "t.csv"
    for name in "ab":
        write(tmp_path, f"{name}.nml", STEADY + BARE)
        ended(asperity(f"{name}.nml", "--quiet", "--summary", "t.csv"))
    head, first, last = table.read_bytes().splitlines(keepends=True)
    for size in (0, 40, len(head) - 1, len(head), len(head + first) - 1, len(head + first) + 200, len(head + first + last) - 1):
        cut = (head + first + last)[:size]
        table.write_bytes(cut)
        assert "b" not in places_in(table)
        ended(asperity("b.nml", "--quiet", "--resume", "--summary", "t.csv"))
        lines = table.read_bytes().splitlines(keepends=True)
        whole = cut.splitlines(keepends=True)[1:2] if cut.startswith(head + first) else []
        assert (lines[0], lines[1:-1]) == (head, whole)
        assert row_of(tmp_path, "b").outcome == "converged"


def test_resume_computes_what_has_no_row(asperity, tmp_path):
    file = "&surface_1 shape = 'file', file = 'heights.csv' /\n"
    write(tmp_path, "heights.csv", "".join(f"{i * 2e-6},{1e-8 * (i % 7)}\n" for i in range(400)))
    rough = STEADY.replace("speed_1 = 0.1", "speed_1 = 0") + file + BARE
    texts = {"good": STEADY + BARE, "few": STEADY + FEW + BARE, "rough": rough}
    for name, text in texts.items():
        write(tmp_path, f"{name}.nml", text)
    arguments = [*(f"{name}.nml" for name in texts), "--quiet", "--outcomes", "--summary", "t.csv"]
    done = asperity(*arguments)
    before = (tmp_path / "t.csv").read_bytes()
    assert before.count(b"\n") == 4, done.stderr
    again = asperity(*arguments, "--resume")
    assert (again.returncode, again.stdout, (tmp_path / "t.csv").read_bytes()) == (done.returncode, done.stdout, before)
    write(tmp_path, "heights.csv", (tmp_path / "heights.csv").read_text(encoding="utf-8").replace(",2e-08", ",3e-08"))
    write(tmp_path, "good.nml", texts["good"].replace("1e5", "2e5"))
    assert asperity(*arguments, "--resume").returncode == done.returncode
    assert [row["case"] for row in rows(tmp_path / "t.csv")[3:]] == ["good.nml", "rough.nml"]
    assert row_of(tmp_path, "good").values["scaling_load_per_length"] == 2e5
    write(tmp_path, "t.csv", (tmp_path / "t.csv").read_text(encoding="utf-8").replace(row_of(tmp_path, "few").program, "0.0.9 abc"))
    assert asperity(*arguments, "--resume").returncode == done.returncode
    assert len(rows(tmp_path / "t.csv")) == 8


def test_what_is_no_table_is_refused_before_anything_runs(asperity, tmp_path):
    write(tmp_path, "a.nml", STEADY + BARE)
    write(tmp_path, "b.nml", MOES + BARE)
    write(tmp_path, "x.nml", STEADY + "&output xdmf = .true. /\n")
    ended(asperity("a.nml", "--quiet", "--summary", "t.csv"))
    content = (tmp_path / "t.csv").read_bytes()
    write(tmp_path, "older.csv", content.decode().replace("h_min [m]", "h_least [m]"))
    (tmp_path / "folder").mkdir()
    for words, *arguments in (
        ("older.csv: found another first line", "a.nml", "--summary", "older.csv"),
        ("a.nml: found another first line", "a.nml", "--summary", "a.nml"),
        ("t.csv: found another first line", "b.nml", "--summary", "t.csv"),
        ("b.nml: found another problem than that of a.nml", "a.nml", "b.nml", "--summary", "new.csv"),
        ("folder: found a folder, expected a file", "a.nml", "--summary", "folder"),
        ("x.nml: found &output xdmf = .true. and --summary", "x.nml", "--summary", "t.csv"),
        ("found --summary and --output", "a.nml", "--summary", "t.csv", "--output", "."),
        ("found --summary without a value", "a.nml", "--summary"),
        ("found --summary t.h5, expected a name as TABLE.csv", "a.nml", "--summary", "t.h5"),
    ):
        done = ended(asperity(*arguments), 1)
        assert words in done.stderr
        assert "converged" not in done.stdout
    assert (tmp_path / "t.csv").read_bytes() == content
    with pytest.raises(RowError, match="is no table"):
        places_in(tmp_path / "a.nml")


def test_no_room_and_no_folder_for_the_row(program, tmp_path):
    write(tmp_path, "a.nml", STEADY + BARE)
    command = [str(program), "a.nml", "--quiet", "--summary"]
    done = ended(cases.called([*command, "none/t.csv"], cwd=tmp_path), 3)
    assert "cannot write none/t.csv: it cannot be opened" in done.stderr

    def little_room():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))

    done = ended(cases.called([*command, "t.csv"], cwd=tmp_path, preexec_fn=little_room), 3)
    assert "cannot write t.csv: no space" in done.stderr
    assert (tmp_path / "t.csv").read_bytes() == b""


def test_an_interrupted_passage_has_no_row(program, tmp_path):
    write(tmp_path, "long.nml", LONG)
    with start(program, tmp_path, "--summary", "t.csv", name="long.nml") as process:
        time.sleep(1.5)
        process.send_signal(signal.SIGINT)
        words = process.stderr.read()
    assert process.returncode == 4
    assert "interrupted without a checkpoint, nothing is kept of t.csv, the row of long.nml" in words
    assert [path.name for path in tmp_path.iterdir()] == ["long.nml"]


def test_a_sweep_of_numbers_gathers_what_results_give(batch, tmp_path, program):
    folder = swept(tmp_path, program)
    results = shutil.copytree(folder, tmp_path / "results")
    said = {}
    for path, option in ((folder, "--numbers"), (results, "--fields")):
        said[option] = batch("run.py", path.name, "--jobs", "2", option, status=2).stdout
        assert batch("gather.py", path.name, "--all").stdout.endswith(": 3 done, 1 not converged\n")
    assert said["--numbers"] == said["--fields"]
    assert not list((folder / "cases").glob("*.h5"))
    with h5py.File(folder / "gathered.h5") as found, h5py.File(results / "gathered.h5") as wanted:
        assert found.keys() == wanted.keys()
        for name in wanted:
            assert found[name].attrs.get("units") == wanted[name].attrs.get("units")
            if "seconds" not in name and "memory" not in name:
                np.testing.assert_array_equal(found[name][()], wanted[name][()])
    # a second run keeps all rows, and one of a changed case appends its own
    before = (folder / "numbers.csv").read_bytes()
    assert batch("run.py", "small", "--numbers", status=2).stdout == said["--numbers"]
    assert (folder / "numbers.csv").read_bytes() == before
    namelist = folder / "cases" / "case_0004.nml"
    namelist.write_text(namelist.read_text(encoding="utf-8").replace("300000000.0", "350000000.0"), encoding="utf-8")
    batch("gather.py", "small")
    assert "an earlier form of this case" in rows(folder / "gathered.csv")[3]["reason"]
    batch("run.py", "small", "--numbers", status=2)
    assert len(rows(folder / "numbers.csv")) == 5
    (folder / "numbers.csv").write_text("case,x\n", encoding="utf-8")
    assert "numbers.csv: found another first line" in batch("run.py", "small", "--numbers", status=3).stdout
    assert "numbers.csv: is no table of asperity --summary" in batch("gather.py", "small", status=1).stderr


def test_many_cases_are_run_for_their_numbers(tmp_path, capsys):
    wants = module_of(BATCH / "run.py").wants_numbers
    folder = SimpleNamespace(path=tmp_path, cases=tmp_path, names=("x",) * 1001)
    assert wants(folder, SimpleNamespace(numbers=None))
    assert "more than 1000 cases: numbers only" in capsys.readouterr().out
    assert not wants(folder, SimpleNamespace(numbers=False))
    (tmp_path / "case_0001.h5").touch()  # results of an earlier run
    assert not wants(folder, SimpleNamespace(numbers=None))
    assert not wants(SimpleNamespace(path=tmp_path, cases=tmp_path, names=("x",) * 1000), SimpleNamespace(numbers=None))

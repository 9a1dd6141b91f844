"""batch/gather.py: a row for each case, whatever became of it, in files that other programs open without a word."""

import os
import shutil
import subprocess
import sys
import warnings

import cases
import h5py
import numpy as np
import pytest
from case_folder import header, read_folder, split_header
from cases import ROOT, call, called, ended, swept


@pytest.fixture(scope="module", name="finished")
def _finished(tmp_path_factory, program):
    """Four cases that have run; the second one has not converged."""
    folder = swept(tmp_path_factory.mktemp("finished"), program)
    assert call("run.py", "small", folder=folder.parent, program=program).returncode == 2
    return folder


@pytest.fixture
def folder(finished, tmp_path):
    return shutil.copytree(finished, tmp_path / "small")


@pytest.fixture
def gather(batch):
    """What gather.py says of the folder of the sweep."""
    return lambda *options: batch("gather.py", "small", *options).stdout


def rows_of(folder):
    return {row["case"]: row for row in cases.rows(folder / "gathered.csv")}


ROUGH = """base = "base.nml"
[vary]
bodies.roughness_1 = [1e-7, 1e-6]
[set]
domain.intervals = 256
"""


def test_film_below_the_roughness_has_a_status_of_its_own(batch, gather, tmp_path, program):
    folder = swept(tmp_path, program, ROUGH)
    done = batch("run.py", "small", status=2)
    assert "  done                1\n  outside the model   1\n    case_0002  outside the model: mixed lubr" in done.stdout
    assert "2 of 2 cases, 1 outside the model\n" in done.stderr
    assert gather() == "small/gathered.h5: 1 done, 1 outside the model: mixed\n"
    rows = rows_of(folder)
    assert rows["case_0001"]["status"] == "done"
    assert rows["case_0002"]["status"] == "outside the model: mixed"
    ratios = [float(rows[f"case_000{i}"]["lambda_ratio [1]"]) for i in (1, 2)]
    assert ratios[0] == pytest.approx(10 * ratios[1], rel=1e-12)
    options = ("small/gathered.h5", "--x", "bodies.roughness_1", "--y", "lambda_ratio", "--format", "svg")
    batch("plot.py", *options)


def test_rows_hold_parameters_and_every_number_of_the_summary_with_its_error(gather, folder):
    assert gather() == "small/gathered.h5: 3 done, 1 not converged\n"
    with h5py.File(folder / "gathered.h5") as file:
        assert list(file["status"].asstr()) == ["done", "not converged", "done", "done"]
        assert list(file["load.hertz_pressure"]) == [0.4e9, 0.6e9, 0.5e9, 0.3e9]
        for i, name in enumerate(file["case"].asstr()):
            found = cases.contents(folder / "cases" / f"{name}.h5")
            summary = [key for key in found if key.startswith("summary/") and "@" not in key]
            assert len(summary) > 4
            for key in summary:
                column = file[key.removeprefix("summary/")]
                assert column[i] == found[key]
                assert column.attrs["units"] == cases.text(found[f"{key}@units"])
                error = file[key.removeprefix("summary/") + "_error"]
                np.testing.assert_equal(error[i], found[f"{key}@error_estimate"])
                assert error.attrs["units"] == column.attrs["units"]
            passed = [key.split("/")[2].removesuffix("@exceeded") for key, value in found.items() if "@exceeded" in key and value]
            assert sorted(file["limits_passed"].asstr()[i].split()) == sorted(passed)
            assert file["report_cycles"][i] == found["report/cycles"]
            assert file["scaling_moes_m"][i] == found["scaling@moes_m"]
            assert file["report_method"].asstr()[i] == cases.text(found["report/method"])
        assert file["reason"].asstr()[1].startswith("fas block_jacobi")
        assert file["reason"].asstr()[0] == ""
        assert file.attrs["done"] == 3
        assert file.attrs["sweep"] == (folder / "sweep.toml").read_text(encoding="utf-8")
    rows = rows_of(folder)
    with h5py.File(folder / "cases" / "case_0003.h5") as file:
        assert float(rows["case_0003"]["h_min [m]"]) == file["summary/h_min"][()]


def test_error_estimates_and_loads_of_dry_contacts(batch, gather, tmp_path, program):
    text = 'base = "base.nml"\n[vary]\nload.hertz_pressure = [0.8e9, 1e9]\n[set]\n'
    text += "domain.intervals_x = 32\ndomain.intervals_y = 32\n"
    folder = swept(tmp_path, program, text, (ROOT / "input" / "dry_sphere.nml").read_text(encoding="utf-8"))
    batch("run.py", "small")
    gather()
    with h5py.File(folder / "gathered.h5") as file, h5py.File(folder / "cases" / "case_0002.h5") as result:
        for name in ("p_max", "contact_area_fraction"):
            assert file[name][1] == result[f"summary/{name}"][()]
            assert file[f"{name}_error"][1] == result[f"summary/{name}"].attrs["error_estimate"] > 0
        assert file["elastic_energy"][1] == result["sweep/elastic_energy"][0]
        assert file["elastic_energy"].attrs["units"] == "J"


def test_missing_and_broken_results_are_rows_with_their_reason(gather, folder):
    results = folder / "cases"
    (results / "case_0001.h5").unlink()
    content = (results / "case_0002.h5").read_bytes()
    (results / "case_0002.h5").write_bytes(content[: len(content) // 2])
    namelist = results / "case_0003.nml"
    namelist.write_text(namelist.read_text(encoding="utf-8") + "! edited\n", encoding="utf-8")
    damaged = bytearray((results / "case_0004.h5").read_bytes())
    damaged[8:200] = bytes(192)
    (results / "case_0004.h5").write_bytes(damaged)
    assert gather() == "small/gathered.h5: 3 failed, 1 not run\n"
    rows = rows_of(folder)
    reasons = ["no result", "not complete, or was changed", "an earlier form of this case", "the result cannot be read"]
    for row, words in zip(rows.values(), reasons, strict=True):
        assert words in row["reason"]
    assert [row["status"] for row in rows.values()] == ["not run", "failed", "failed", "failed"]
    assert [row["load.hertz_pressure [Pa]"] for row in rows.values()] == [f"{i}00000000.0" for i in (4, 6, 5, 3)]


def test_what_is_no_file_in_place_of_a_result_is_a_row_with_its_reason(batch, gather, folder):
    """A pipe, to open which takes for ever; also in place of a case, and of the log of a run."""
    results = folder / "cases"
    for name in ("case_0001.h5", "case_0002.nml", "case_0003.h5", "case_0004.h5"):
        (results / name).unlink()
    os.mkfifo(results / "case_0001.h5")
    os.mkfifo(results / "case_0002.nml")
    (results / "case_0003.h5").mkdir()
    (results / "case_0004.h5").symlink_to("nowhere")
    os.mkfifo(folder / "log" / "another.csv")
    assert gather() == "small/gathered.h5: 3 failed, 1 not run\n"
    reasons = [row["reason"] for row in rows_of(folder).values()]
    assert reasons[:3] == [
        "the result cannot be read: is no regular file",
        "found a folder, pipe or device in place of the case, expected a file",
        "the result cannot be read: is a folder, expected a result file (.h5)",
    ]
    (folder / "index.csv").unlink()
    os.mkfifo(folder / "index.csv")
    assert "index.csv: found a folder, pipe or device, expected a file" in batch("gather.py", "small", status=1).stderr


def test_titles_stay_text_and_a_parameter_of_an_earlier_version_is_no_column_of_the_table(batch, gather, folder):
    index = '"case","case.title","x [1]"\n' + "".join(f'"case_000{i}","{i}_0",{i}e0\n' for i in range(1, 5))
    (folder / "index.csv").write_text(index, encoding="utf-8")
    gather()
    with h5py.File(folder / "gathered.h5") as file:
        assert list(file["case.title"].asstr()) == ["1_0", "2_0", "3_0", "4_0"]
        assert list(file["x"]) == [1.0, 2.0, 3.0, 4.0]
    (folder / "index.csv").write_text(index.replace("x [1]", "program"), encoding="utf-8")
    assert "found the parameter program, which the table has itself" in batch("gather.py", "small", status=1).stderr


def test_the_reason_of_a_failure_is_that_of_its_run(batch, gather, folder):
    (folder / "cases" / "case_0001.h5").unlink()
    bad = folder / "cases" / "case_0001.nml"
    bad.write_text(bad.read_text(encoding="utf-8").replace("viscosity", "viscosty"), encoding="utf-8")
    batch("run.py", "small", status=3)
    gather()
    row = rows_of(folder)["case_0001"]
    assert row["status"] == "failed"
    assert "viscosty: found an unknown key" in row["reason"]
    assert row["h_min [m]"] == ""


def test_pandas_and_xarray_open_it_without_a_word(batch, gather, folder):
    pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
    (folder / "cases" / "case_0004.h5").unlink()
    gather()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with xarray.open_dataset(folder / "gathered.h5", engine="h5netcdf") as data:
            assert data.sizes == {"case": 4}
            assert data["h_min"].attrs["units"] == "m"
            assert list(data["status"].values) == ["done", "not converged", "done", "not run"]
            assert np.isnan(data["h_min"].sel(case="case_0004"))
            assert data.where(data["status"] == "done", drop=True).sizes == {"case": 2}
            frame = data.to_dataframe()
        table = pandas.read_csv(folder / "gathered.csv")
    assert list(table.columns[:4]) == ["case", "load.hertz_pressure [Pa]", "solver.max_cycles [1]", "status"]
    heads = {name: header(name, column.attrs.get("units", "")) for name, column in data.items()}
    assert set(heads.values()) > set(table.columns) - {"case"}
    assert {heads[name] for name in ("reason", "h_min", "p_max")} < set(table.columns)
    assert len(table.columns) < 30 and not any("extrapolated" in name for name in table.columns)
    batch("gather.py", folder.name, "--all")
    assert list(pandas.read_csv(folder / "gathered.csv").columns) == ["case", *heads.values()]
    np.testing.assert_array_equal(table["h_min [m]"], frame["h_min"])


def test_a_parameter_with_the_name_of_a_result(batch, gather, tmp_path, program):
    text = 'base = "base.nml"\n[vary]\nh_min = [1.0, 2.0]\n[formula]\nload.hertz_pressure = "h_min*4e8"\n'
    folder = swept(tmp_path, program, text)
    batch("run.py", "small")
    gather()
    with h5py.File(folder / "gathered.h5") as file:
        assert list(file["h_min"]) == [1.0, 2.0]
        assert 0 < file["summary_h_min"][0] < 1e-5
        assert 0 < file["summary_h_min_error"][0] < file["summary_h_min"][0]
        assert "h_min_error" not in file  # a picture would show it as that of the parameter


def many_of(folder, target, count):
    """A folder of `count` cases that are those of `folder` again and again."""
    index = read_folder(folder)
    (target / "cases").mkdir(parents=True)
    names = [f"case_{i:04d}" for i in range(1, count + 1)]
    for i, name in enumerate(names):
        for ending in ("nml", "h5"):
            (target / "cases" / f"{name}.{ending}").hardlink_to(folder / "cases" / f"{index.names[i % 4]}.{ending}")
    (target / "index.csv").write_text("case,x\n" + "".join(f"{name},{i}\n" for i, name in enumerate(names)), encoding="utf-8")
    return target


def measured_gather(folder, block, jobs):
    """Processor seconds and peak memory [kB] of one process that gathers, in blocks of so many results, and what it says."""
    script = (
        "import resource, sys, time; sys.path.insert(0, sys.argv[1]); import pathlib, gather; start = time.process_time();"
        "gather.BLOCK = int(sys.argv[3]); gather.gather_folder(pathlib.Path(sys.argv[2]), int(sys.argv[4]), True);"
        "print(time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)"
    )
    command = [sys.executable, "-c", script, str(ROOT / "batch"), str(folder), str(block), str(jobs)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    said, numbers = done.stdout.splitlines()
    return (*map(float, numbers.split()), said)


def test_time_and_memory_do_not_grow_with_the_number_of_files(folder, tmp_path):
    """Processor time of a result among 240 and among 60, and memory of both: the bench times 10 000 (docs/batch.md)."""
    seconds, kilobytes = {}, {}
    for count in (60, 240):
        many = many_of(folder, tmp_path / f"many{count}", count)
        seconds[count], kilobytes[count], _ = measured_gather(many, 60, 1)
    assert seconds[240] / 240 < 2 * seconds[60] / 60  # a search through all that was read would give 4
    assert kilobytes[240] < kilobytes[60] + 4000


def test_any_number_of_processes_writes_the_same_files(folder, tmp_path):
    """Blocks with different columns, in their order; the reading is done by the others."""
    many = many_of(folder, tmp_path / "many", 90)
    for i in (3, 30, 31, 60):
        (many / "cases" / f"case_{i:04d}.h5").unlink()
    with_words(many / "cases" / "case_0055.h5", "cycles", "seven")
    (many / "log").mkdir()
    (many / "log" / "a.csv").write_text("case_0031,3,no room\0\n", encoding="utf-8")
    written, seconds = {}, {}
    for jobs in (1, 2, 3):
        seconds[jobs], *_ = measured_gather(many, 25, jobs)
        written[jobs] = [(many / f"gathered.{ending}").read_bytes() for ending in ("h5", "csv")]
    assert written[1] == written[2] == written[3]
    assert seconds[2] < 0.7 * seconds[1]
    status = [row["status"] for row in rows_of(many).values()]
    assert [i + 1 for i, word in enumerate(status) if word == "not run"] == [3, 30, 60]
    assert rows_of(many)["case_0031"]["reason"] == "no room\ufffd"


def test_a_process_that_is_killed_leaves_the_older_table(folder, tmp_path):
    many = many_of(folder, tmp_path / "many", 1200)
    (many / "gathered.h5").write_text("older", encoding="utf-8")
    script = (
        "import os, sys; sys.path.insert(0, sys.argv[1]); import pathlib, gather;"
        "pool = gather.ProcessPoolExecutor;"
        "gather.ProcessPoolExecutor = lambda jobs, context, start: pool(jobs, context, os._exit, (1,));"
        "sys.exit(gather.main([sys.argv[2]]))"
    )
    done = ended(called([sys.executable, "-c", script, str(ROOT / "batch"), str(many)]), 3)
    words = "a process that reads results was ended, by somebody or for lack of memory"
    assert done.stderr == f"gather.py: {many / 'cases'}: {words}\n"
    assert (many / "gathered.h5").read_text(encoding="utf-8") == "older"


def with_words(path, name, words):
    """Another file at `path`, whose /report/NAME is a text."""
    content = path.read_bytes()
    path.unlink()  # it may have other names
    path.write_bytes(content)
    with h5py.File(path, "r+") as file:
        del file[f"report/{name}"]
        file["report"].create_dataset(name, data=np.bytes_(words))
    cases.seal(path)


@pytest.mark.parametrize("words", ["seven", "eight888"])
def test_words_in_a_column_of_numbers_are_kept(gather, folder, words):
    """Of any length, also that of a number."""
    with_words(folder / "cases" / "case_0003.h5", "cycles", words)
    gather("--all")
    with h5py.File(folder / "gathered.h5") as file, h5py.File(folder / "cases" / "case_0001.h5") as result:
        assert file["report_cycles"].asstr()[2] == words
        assert float(file["report_cycles"].asstr()[0]) == result["report/cycles"][()]
        assert list(file["status"].asstr()) == ["done", "not converged", "done", "done"]
    assert rows_of(folder)["case_0003"]["report_cycles [1]"] == words


def test_words_behind_blocks_of_numbers(folder, tmp_path):
    many = many_of(folder, tmp_path / "many", 105)
    (many / "cases" / "case_0002.h5").unlink()
    *_, said = measured_gather(many, 100, 1)
    before = rows_of(many)
    with_words(many / "cases" / "case_0103.h5", "cycles", "seven")
    assert measured_gather(many, 100, 1)[2] == said
    rows = rows_of(many)
    assert list(rows["case_0001"])[-1] == "report_cycles [1]"
    assert rows["case_0103"].pop("report_cycles [1]") == "seven"
    assert before["case_0103"].pop("report_cycles [1]") != ""
    assert rows["case_0002"]["report_cycles [1]"] == ""
    assert rows == before


def test_heads_of_columns():
    for name, unit in (("h_min", "m"), ("load.hertz_pressure", "Pa"), ("slip", ""), ("x", "N/m")):
        assert split_header(header(name, unit)) == (name, unit)

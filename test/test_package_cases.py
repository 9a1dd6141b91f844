"""The Python package: cases of any type, text and path, programs that die; results that show their own file or say why not."""

import copy
import datetime
import io
import os
import pickle
import random
import shutil
import subprocess
import sys
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal
from enum import Enum
from fractions import Fraction
from pathlib import Path

import asperity
import f90nml
import h5py
import numpy as np
import pandas as pd
import pytest
import xarray as xr
from asperity import seal
from cases import ROOT, called, ended, write
from cases import seal as write_seal

sys.path.append(str(ROOT / "postproc"))

import result_file
import result_row

pytestmark = pytest.mark.usefixtures("package")

DRY = {
    "case": {"problem": "dry_line", "title": "plain"},
    "bodies": {"reduced_modulus": 230e9},
    "load": {"mean_pressure": [1e7, 2e7]},
    "surface_1": {"shape": "sinusoid", "amplitude": 1e-7, "wavelength": 1e-4},
    "domain": {"length": 1e-3, "intervals": 64},
    "accuracy": {"error_bars": False},
    "output": {"adequacy": False},
}
HEIGHTS = "x_m,z_m\n" + "".join(f"{i * 1e-5:.5f},{1e-7 * (i % 4):.2e}\n" for i in range(64))
TEXT = """&bodies reduced_modulus = 230e9 /
&load mean_pressure = 1e7, 2e7 /
&accuracy error_bars = .false. /
&output adequacy = .false. /
"""
MEASURED = DRY | {"surface_1": {"shape": "file", "file": "h.csv"}, "domain": {}}


class Word(str, Enum):  # noqa: UP042 -- one that is written as Word.WORD by itself
    WORD = "sinusoid"


def test_values_of_many_types_are_the_same_case():
    plain = asperity.run(DRY)
    loads = [(1e7, 2e7), np.array([1e7, 2e7]), deque([Decimal("1e7"), Fraction(20000000)])]
    loads += [pd.Series([1e7, 2e7]), xr.DataArray([1e7, 2e7])]
    lengths = [Decimal("0.001"), np.float64(1e-3), np.longdouble("1e-3"), np.array(1e-3), Fraction(1, 1000), xr.DataArray(1e-3)]
    intervals = [np.int8(64), np.uint64(64), np.array(64), True + 63, pd.Series([64]), range(64, 65)]
    words = [Word.WORD, np.str_("sinusoid"), np.array("sinusoid"), ["sinusoid"], ("sinusoid",)]
    for load, length, count, word in zip(loads, lengths, intervals, words, strict=False):
        case = DRY | {"LOAD": {"Mean_Pressure": load}, "domain": {"length": length, "intervals": count}}
        case = {key: case[key] for key in case if key != "load"} | {"surface_1": DRY["surface_1"] | {"shape": word}}
        np.testing.assert_array_equal(asperity.run(case).pressure, plain.pressure)
    assert "gap" not in asperity.run(DRY | {"output": {"fields": ("pressure",), "adequacy": np.False_}}).solution


BAD = [
    *(None, datetime.date(2026, 1, 2), datetime.datetime(2026, 1, 2), datetime.timedelta(1), 1j, float("nan"), Decimal("inf")),
    *(b"1", {1.0}, {"a": 1}, [], (), [[1.0]], np.ones((2, 2)), object(), 10**400, np.datetime64(1, "ns"), Decimal("sNaN")),
    *(pd.Timestamp("2026-01-02"), pd.NA, np.array([1, None]), np.array([np.datetime64(1, "ns")]), [np.timedelta64(1, "ns")]),
    *(np.complex64(1), float, iter([1.0]), np.ma.masked_array([1.0, 2.0], [0, 1]), Decimal("1e999"), [pd.Timestamp(0)]),
]  # fmt: skip


def test_values_that_no_namelist_can_say_are_findings_all_at_once():
    for value in BAD:
        case = DRY | {"load": {"mean_pressure": value}, "domain": {"length": value, "intervals": 64}}
        findings = asperity.check(case)
        assert [(found.group, found.key) for found in findings] == [("load", "mean_pressure"), ("domain", "length")], value
        assert all(found.text.startswith(("found", "cannot", "int too")) for found in findings), findings
        with pytest.raises(asperity.InputError) as caught:
            asperity.run(case)
        assert caught.value.findings == findings
    odd = ({1: {}}, {"a b": {}}, {"a/ &load": {}}, {"load": 3}, {"load": [1]}, {"load": {"x/ &y z": 1}}, {"Load": {}, "load": {}})
    for bad in (*odd, 7, b"&case /"):
        assert asperity.check(bad)
    assert asperity.check(DRY | {"case": {"problem": "dry_line", "title": "\ud800"}})


def test_titles_are_kept_and_never_edited(tmp_path):
    (tmp_path / "x").write_text(HEIGHTS, encoding="utf-8")
    titles = ["file = 'x'", "it's", "a \"b' c", "back\\slash\\", "\\'", "a\\\\b", "x#;$(,-y.nml", "R&D / 50 % ! no", "a = 1, b"]
    titles += ["\u00a0\u200b ö \U0001f600"]
    for title in titles:
        quoted = title.replace("'", "''")
        text = f"&case problem = 'dry_line', title = '{quoted}' /\n{TEXT}&domain length = 1e-3, intervals = 64 /\n"
        text += "&surface_1 shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-4 /\n"
        assert asperity.run(text).title == title
        case = DRY | {"case": {"problem": "dry_line", "title": title}}
        assert asperity.run(case).title == title
        assert asperity.run(f90nml.Namelist(case)).title == title


FOLDERS = ["R&D", "O'Neil", 'in "quotes"', "&case x", "a b", "100% ! = #", "Öl", "back\\slash", "-x", "a.b", "$HOME", "*"]
FOLDERS += ["a;b,(c#"]


def test_folders_of_any_name(tmp_path, monkeypatch):
    """Paths as text and as Path, relative and whole; heights beside the namelist, or in the current folder."""
    text = f"&case problem = 'dry_line' /\n{TEXT}&surface_1 shape = 'file', file = 'h.csv' /\n"
    expected = None
    for i, name in enumerate(FOLDERS):
        folder = tmp_path / name
        folder.mkdir()
        (folder / "h.csv").write_text(HEIGHTS, encoding="utf-8")
        (folder / "one & two.nml").write_text(text, encoding="utf-8-sig", newline="\r\n")
        monkeypatch.chdir(tmp_path)
        paths = [folder / "one & two.nml", str(folder / "one & two.nml"), f"./{name}/one & two.nml"]
        found = [asperity.run(paths[i % 3], folder=folder / "results & more")]
        assert found[0].path == folder / "results & more" / "one & two.h5"
        monkeypatch.chdir(folder)
        cases = [MEASURED, "one & two.nml", text, "\ufeff" + text.replace("\n", "\r\n"), text.replace("\n", "\r")]
        found += [asperity.run(cases[j % 5]) for j in (i, i + 2)]
        expected = expected or found[0]
        for result in found:
            np.testing.assert_array_equal(result.pressure, expected.pressure)
    assert expected.case["load"]["mean_pressure"] == [1e7, 2e7]
    with pytest.raises(FileNotFoundError):
        asperity.run("R&D/nothing.nml")
    with pytest.raises(FileNotFoundError):
        asperity.check(Path("&case.nml"))
    with pytest.raises(asperity.InputError):
        asperity.run("a\0b")


def test_a_folder_that_is_no_utf8(tmp_path, monkeypatch):
    folder = tmp_path / os.fsdecode(b"latin\xf6")
    folder.mkdir()
    (folder / "h.csv").write_text(HEIGHTS, encoding="utf-8")
    monkeypatch.chdir(folder)
    f90nml.Namelist(MEASURED).write("one.nml")
    assert asperity.run("one.nml", folder=folder).converged
    with pytest.raises(asperity.InputError, match="UTF-8"):  # a whole path in the namelist would not be
        asperity.run(MEASURED)


def test_first_elements_of_arrays_stay_where_they_are():
    """As f90nml reads them: a dictionary has them in _start_index."""
    groups = f90nml.reads("&surface_1 shape = 'sinusoid', wavelength = 1e-4, amplitude(2) = 1e-7 /\n")
    for case in (groups, groups.todict()):
        findings = asperity.check(DRY | {"surface_1": case["surface_1"]})
        assert any("found element 2 but not element 1" in found.text for found in findings)


PROGRAMS = {
    "SIGKILL": "kill -KILL $$",
    "SIGSEGV": "kill -SEGV $$",
    "status 0, without a word": "exit 0",
    "status 1, without a word": "exit 1",
    "status 3:\nno room": "echo no room >&2; exit 3",
    "status 1:\nTraceback": "echo Traceback; exit 1",
    "status 2": "exit 2",
    "cannot be run: Permission denied": None,
    "cannot be run: Exec format error": None,
    "which is no file": None,
}


@pytest.mark.parametrize("words", PROGRAMS)
def test_a_program_that_dies_or_does_not_start_is_said(words, tmp_path, monkeypatch):
    program = tmp_path / "program"
    monkeypatch.setenv("ASPERITY", str(program))
    if "no file" not in words:
        program.write_text("garbage" if "format" in words else f"#!/bin/sh\n{PROGRAMS[words]}\n", encoding="utf-8")
        program.chmod(0o644 if "Permission" in words else 0o755)
    for call in (lambda: asperity.check(DRY), lambda: asperity.run(DRY), asperity.version):
        with pytest.raises(asperity.AsperityError) as caught:
            call()
        assert words in str(caught.value)
        assert not isinstance(caught.value, asperity.InputError)
    if PROGRAMS[words] is None:
        code = "import sys; from asperity.commands import asperity; asperity()"
        done = ended(called([sys.executable, "-c", code]), 1)
        assert done.stderr.startswith("asperity: ")
        assert words in done.stderr
        assert done.stderr.count("\n") == 1


def test_many_cases_in_one_process(tmp_path, monkeypatch):
    """Rows in the order of the cases, with the numbers of their results; a relative path of a text; what cannot be a case."""
    monkeypatch.chdir(tmp_path)
    Path("h.csv").write_text(HEIGHTS, encoding="utf-8")
    text = TEXT + "&case problem = 'dry_line' /\n&surface_1 shape = 'file', file = 'h.csv' /\n"
    rows = asperity.run_many([DRY, text, DRY | {"domain": {"length": 1e-3, "intervals": 128}}, DRY])
    assert list(rows["outcome"]) == ["converged"] * 4
    assert list(rows["domain.intervals [1]"]) == [64, 64, 128, 64]
    areas, one = rows["contact_area_fraction [1]"], asperity.run(DRY).sweep
    assert areas[0] == areas[3] == float(one.contact_area_fraction[-1])
    assert areas[1] != areas[0]
    assert rows["p_max [Pa]"][0] == float(one.p_max[-1])
    assert asperity.run_many([]).empty
    bad = DRY | {"bodies": {"reduced_modulus": -1.0}}
    with pytest.raises(asperity.InputError, match=r"case 1: found -1\.0") as refused:
        asperity.run_many([DRY, bad])
    assert [finding.key for finding in refused.value.findings] == ["reduced_modulus"]


def loaded(pressure):
    return DRY | {"load": {"mean_pressure": [pressure]}}


def mean(result):
    return float(result.pressure.mean())


def test_names_of_results(tmp_path):
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda pressure: asperity.run(loaded(pressure), folder=tmp_path), [1e7, 2e7, 3e7, 4e7]))
    results.append(asperity.run(loaded(5e7), folder="."))
    assert {result.path.name for result in results} == {"case.h5", *(f"case_{i}.h5" for i in range(2, 6))}
    assert [mean(result) for result in results] == pytest.approx([1e7, 2e7, 3e7, 4e7, 5e7])
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".h5"] * 5
    case = loaded(1e7) | {"case": {"problem": "dry_line", "OUTPUT": "sub/of mine.h5"}}
    kept, temporary = asperity.run(case, folder=tmp_path / "new"), asperity.run(case)
    assert kept.path == tmp_path / "new" / "of mine.h5"
    assert temporary.path.name == "of mine.h5"
    assert mean(kept) == mean(temporary) == pytest.approx(1e7)


def test_a_file_that_changed_under_a_result_is_an_error(tmp_path, monkeypatch):
    def case(pressure):
        f90nml.Namelist(loaded(pressure)).write(tmp_path / "one.nml", force=True)
        return tmp_path / "one.nml"

    first = asperity.run(case(1e7), folder="here")
    whole = first.path.read_bytes()
    os.utime(first.path)  # touched, copied: the same content
    assert first.summary.sizes == {}
    shutil.copy(first.path, tmp_path / "copy.h5")
    (tmp_path / "copy.h5").replace(first.path)
    monkeypatch.chdir("/")
    assert first.report["method"]
    second = asperity.run(case(2e7), folder=tmp_path / "here")
    assert second.path == first.path
    with pytest.raises(asperity.AsperityError, match=r"one.h5: has changed since it was read"):
        first.pressure  # noqa: B018
    assert mean(second) == pytest.approx(2e7)
    second.path.write_bytes(whole[:-1] + b" ")
    with pytest.raises(asperity.AsperityError, match=r"one.h5: no result of asperity, or one that is not complete"):
        second.case  # noqa: B018
    second.path.unlink()
    with pytest.raises(FileNotFoundError):
        second.case  # noqa: B018


def test_copies_of_a_temporary_result_outlive_it(tmp_path):
    results = [asperity.run(loaded(1e7)), asperity.run(loaded(1e7), folder=tmp_path)]
    ways = (lambda result: pickle.loads(pickle.dumps(result)), copy.deepcopy, copy.copy)
    copies = [way(result) for result in results for way in ways]
    del results
    assert [mean(copied) for copied in copies] == pytest.approx([1e7] * 6)
    findings = asperity.check({"load": {"mean_pressure": 1e7}})
    assert pickle.loads(pickle.dumps(asperity.InputError(findings))).findings == findings


def test_the_checksum_is_that_of_the_program(tmp_path):
    """Of any length, also longer than what is added at once, and of bits all set or clear; tests have their own form of it."""
    source = random.Random(1)
    for length in (0, 1, 7, 8, 9, 4 * seal._WORDS, 4 * seal._WORDS + 3, *(source.randrange(400000) for _ in range(6))):
        content = source.choice([source.randbytes, lambda n: b"\xff" * n, bytes])(length)
        path = tmp_path / "a.h5"
        path.write_bytes(content)
        write_seal(path)
        assert seal.check_seal(path) == path.read_bytes()[length + 18 :][:16].decode()
        assert seal.checksum_of(io.BytesIO(content), length) == seal.check_seal(path)
    assert asperity.run(loaded(1e7), folder=tmp_path / "own").converged


def refusals(path, namelist):
    """What each reader says of a file that is no result."""
    said = []
    for read, error in (
        (asperity.read, asperity.AsperityError),
        (result_file.read_result, result_file.ResultError),
        (lambda name: result_row.RowReader().read(name, namelist), result_row.RowError),
    ):
        with pytest.raises(error) as caught:
            read(path)
        said.append(str(caught.value))
    return said


def test_one_bit_anywhere_and_what_is_no_file_are_seen_by_every_reader(tmp_path):
    whole = asperity.run(loaded(1e7), folder=tmp_path).path.read_bytes()
    source = random.Random(30)
    path = tmp_path / "damaged.h5"
    for _ in range(40):
        content = bytearray(whole)
        content[source.randrange(len(content))] ^= 1 << source.randrange(8)
        path.write_bytes(content)
        for words in refusals(path, tmp_path / "none.nml"):
            assert "damaged" in words or "does not end with its checksum" in words
    with h5py.File(path, "w") as file:
        file.attrs["program"] = "asperity"
    assert all("no result of asperity" in words for words in refusals(path, tmp_path / "none.nml"))
    os.mkfifo(tmp_path / "pipe.h5")
    (tmp_path / "folder.h5").mkdir()
    (tmp_path / "device.h5").symlink_to("/dev/zero")
    for name in ("pipe", "folder", "device"):
        assert all("is a folder" in words or "no regular file" in words for words in refusals(tmp_path / f"{name}.h5", tmp_path))


def test_a_foreign_file_with_a_seal_is_refused_in_words(tmp_path):
    """Nobody writes one, but whatever it holds is no other error."""
    path = tmp_path / "a.h5"
    for content in (np.arange(3), np.bytes_("&case"), np.zeros(0)):
        with h5py.File(path, "w") as file:
            file.attrs["program"] = "asperity"
            file["solution"], file["input/namelist"], file["adequacy/x"] = content, content, content
            file["adequacy/x"].attrs["verdict"] = np.zeros(0)
        write_seal(path)
        result = asperity.read(path)
        for name in ("solution", "pressure", "x"):
            with pytest.raises(asperity.AsperityError):
                getattr(result, name)


def test_an_array_in_the_place_of_a_number_gives_no_row(tmp_path):
    """HDF5 would write all of it where there is room for one."""
    path, namelist = tmp_path / "a.h5", write(tmp_path, "a.nml", "&case /\n")
    with h5py.File(path, "w") as file:
        for name in ("program", "version", "git_commit"):
            file.attrs[name] = np.bytes_("asperity")
        file["input/namelist"] = np.bytes_("&case /\n")
        file.attrs["converged"] = np.ones(4000)
    write_seal(path)
    with pytest.raises(result_row.RowError, match="converged is no single number"):
        result_row.RowReader().read(path, namelist)


def test_the_seal_is_read_without_the_rest_of_the_package():
    code = "import asperity.seal, sys; assert not {'xarray', 'h5py', 'f90nml'} & set(sys.modules)"
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)

"""Results of the Python package: each shows its own file, whole as the program wrote it, or says that it cannot."""

import copy
import io
import os
import pickle
import random
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import asperity
import cases
import f90nml
import h5py
import numpy as np
import pytest
from asperity import seal
from batch_runs import ROOT
from test_package_cases import DRY

sys.path.append(str(ROOT / "postproc"))

import result_file
import result_row

pytestmark = pytest.mark.usefixtures("package")


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
    copies = [
        copied for result in results for copied in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result), copy.copy(result))
    ]
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
        cases.seal(path)
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


def test_one_bit_anywhere_is_seen_by_every_reader(tmp_path):
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


def test_what_is_no_file_is_refused_at_once(tmp_path):
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
        cases.seal(path)
        result = asperity.read(path)
        for name in ("solution", "pressure", "x"):
            with pytest.raises(asperity.AsperityError):
                getattr(result, name)


def test_an_array_in_the_place_of_a_number_gives_no_row(tmp_path):
    """HDF5 would write all of it where there is room for one."""
    path, namelist = tmp_path / "a.h5", cases.write(tmp_path, "a.nml", "&case /\n")
    with h5py.File(path, "w") as file:
        for name in ("program", "version", "git_commit"):
            file.attrs[name] = np.bytes_("asperity")
        file["input/namelist"] = np.bytes_("&case /\n")
        file.attrs["converged"] = np.ones(4000)
    cases.seal(path)
    with pytest.raises(result_row.RowError, match="converged is no single number"):
        result_row.RowReader().read(path, namelist)


def test_the_seal_is_read_without_the_rest_of_the_package():
    code = "import asperity.seal, sys; assert not {'xarray', 'h5py', 'f90nml'} & set(sys.modules)"
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)

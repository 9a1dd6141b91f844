"""Only files that the program has written are replaced or removed, whatever lies beside a result or appears there during a run."""

import os
import random
import signal

import h5py
import numpy as np
import pytest
from cases import HANGING, LONG, STEADY, TRANSIENT, called, ended, members, text, write
from kill_and_resume import busy, different, killed_at_last, start, undisturbed, wait_for
from test_output_names import heights, refused
from test_signals import DRY

WORKING = [".part", ".tmp", ".ckpt", ".ckpt.tmp"]
XDMF = "&output xdmf = .true. /\n"


def precious(path, source):
    """A file of the user: text, a table, HDF5 of another program, random bytes."""
    kind = source.randrange(4)
    if kind == 0:
        path.write_text("asperity: notes on the program 'asperity'\n" * source.randrange(1, 200), encoding="utf-8")
    elif kind == 1:
        path.write_text("\n".join(f"{x}, {x * x}" for x in range(source.randrange(1, 999))), encoding="utf-8")
    elif kind == 2:
        heights(path)
        with h5py.File(path, "r+") as file:
            file.attrs["made_by"] = np.bytes_("asperity_heights")
            file.attrs["program"] = np.bytes_("another one")
    else:
        path.write_bytes(source.randbytes(source.randrange(1, 5000)))
    return path.read_bytes()


@pytest.mark.path
@pytest.mark.parametrize("ending", WORKING)
def test_files_of_the_user_keep_their_place(asperity, tmp_path, ending):
    source = random.Random(ending)
    write(tmp_path, "case.nml", STEADY)
    path = tmp_path / f"case.h5{ending}"
    for _ in range(4):
        content = precious(path, source)
        assert refused(asperity, tmp_path, "case.nml") == [
            f"case.nml: found {path.name} as its temporary file, which is there and no temporary file of asperity, "
            "expected another &case output (or remove it)"
        ]
        assert asperity("case.nml", "--resume", "--quiet").returncode in {1, 3}
        assert path.read_bytes() == content


def test_a_user_s_file_in_the_place_of_the_next_xdmf_file(asperity, tmp_path):
    write(tmp_path, "case.nml", STEADY + XDMF)
    (tmp_path / "case.xdmf.part").write_text("precious", encoding="utf-8")
    assert "found case.xdmf.part as its temporary file" in refused(asperity, tmp_path, "case.nml")[0]


@pytest.mark.parametrize("passage", [False, True])
def test_a_file_that_appears_at_the_name_stays(program, tmp_path, passage):
    """The result stays as well, under a name that is told."""
    write(tmp_path, "case.nml", busy(1000.0) if passage else STEADY.replace("intervals = 256", "intervals = 65536"))
    with start(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running)
        (tmp_path / "case.h5").write_text("precious", encoding="utf-8")
        assert running.wait(HANGING) == 3
        assert running.stderr.read() == (
            "asperity: cannot rename case.h5.tmp to case.h5: it is there, and asperity has not written it; "
            "the result is case.h5.new\n"
        )
    assert (tmp_path / "case.h5").read_text(encoding="utf-8") == "precious"
    with h5py.File(tmp_path / "case.h5.new") as file:
        assert (file.attrs["converged"], text(file.attrs["reason"])) == (1, "converged")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.h5", "case.h5.new", "case.nml"]


def test_an_end_by_force_removes_no_file_of_the_user(program, tmp_path):
    """Appeared beside a dry case, which a timer ends."""
    source = random.Random(1)
    write(tmp_path, "case.nml", DRY)
    with start(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running)
        kept = {ending: precious(tmp_path / f"case.h5{ending}", source) for ending in WORKING[1:]}
        running.send_signal(signal.SIGTERM)
        assert running.wait(HANGING) == 4
    assert {ending: (tmp_path / f"case.h5{ending}").read_bytes() for ending in kept} == kept
    assert not (tmp_path / "case.h5.part").exists()


def harm(part, source):
    """What another program may do to a file: cut it off, overwrite it, remove it, put another one in its place."""
    kind = source.choice(["empty", "cut", "overwrite", "remove", "swap", "swap a copy"])
    size = part.stat().st_size
    if kind == "empty":
        os.truncate(part, 0)
    elif kind == "cut":
        os.truncate(part, source.randrange(size))
    elif kind == "overwrite":
        with part.open("r+b") as file:
            file.seek(source.randrange(size))
            file.write(source.randbytes(source.choice([8, 512, 65536])))
    elif kind == "remove":
        part.unlink()
    else:
        other = part.with_name("other")
        other.write_bytes(part.read_bytes() if kind == "swap a copy" else b"precious")
        other.replace(part)
    return kind


def test_a_part_that_somebody_changes(program, tmp_path):
    """The passage ends with status 3 and the reason, or with the bits of one that nobody disturbed."""
    reference, _ = undisturbed(program, tmp_path, busy(1000.0))
    source, part, told = random.Random(20261125), tmp_path / "case.h5.part", 0
    for number in range(members(6, 16)):
        with start(program, tmp_path) as running:
            wait_for(part, running, times=source.choice([1, 3, 30, 100]))
            kind = harm(part, source)
            status, words = running.wait(HANGING), running.stderr.read()
        left = part.read_bytes() if part.exists() else b""
        assert status in {0, 3}, (number, kind, words)
        if status == 0:
            assert different(reference, tmp_path / "case.h5") == [], (number, kind)
            assert kind in {"overwrite", "cut", "empty"}, (number, kind)
        else:
            told += 1
            assert "case.h5.part" in words, (number, kind)
            assert not (tmp_path / "case.h5").exists(), (number, kind)
        assert (left == b"precious") == (kind == "swap"), (number, kind)
        for path in tmp_path.glob("case.h5*"):
            if path.suffix == ".new":
                assert different(reference, path) == [], (number, kind)
            path.unlink()
    assert told > members(6, 16) / 2


def test_a_part_cut_off_before_its_checkpoint(program, asperity, tmp_path):
    write(tmp_path, "case.nml", LONG + "&output checkpoint_interval = 0.0 /\n")
    with killed_at_last(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.ckpt", running)
        os.truncate(tmp_path / "case.h5.part", 3000)
        running.send_signal(signal.SIGTERM)
        assert running.wait(HANGING) == 4
    assert "cannot resume: case.h5.part" in ended(asperity("case.nml", "--resume", "--quiet"), 1).stderr


def test_one_run_only_where_the_part_was_removed(run_case, program, tmp_path):
    """The lock is gone with it: two runs are on their way to one name, and only the later one may have it."""
    write(tmp_path, "case.nml", busy(1000.0))
    with start(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running, times=3)
        (tmp_path / "case.h5.part").unlink()
        run_case(TRANSIENT.replace("&case", "&case output = 'case.h5',"), "--quiet", name="other")
        first = (tmp_path / "case.h5").read_bytes()
        assert running.wait(HANGING) == 3
        assert "case.h5.part was removed or replaced while the run went on" in running.stderr.read()
    assert (tmp_path / "case.h5").read_bytes() == first


def test_a_pipe_is_not_waited_for(program, tmp_path):
    write(tmp_path, "case.nml", STEADY)
    os.mkfifo(tmp_path / "case.h5")
    ended(called([program, "case.nml"], cwd=tmp_path), 1)

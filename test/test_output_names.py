"""Only what the program has written is replaced or removed: inputs, other results and files of the user stay, also during a run."""

import os
import random
import signal

import h5py
import numpy as np
import pytest
from cases import HANGING, LONG, STEADY, TRANSIENT, case_text, ended, members, text, write
from kill_and_resume import busy, different, killed_at_last, start, undisturbed, wait_for
from test_signals import DRY as LONG_DRY

DRY = case_text("shape = 'file', file = 'rough.h5', dataset = 'z'", [1e8], "")
HEIGHTS = ["rough.h5", "./rough.h5", "sub/../rough.h5", "link.h5", "hard.h5", "sub/link.h5"]


def to(output, text=STEADY):
    return text.replace("&case", f"&case output = '{output}',")


def heights(path):
    with h5py.File(path, "w") as file:
        file["z"] = 1e-7 * np.cos(2 * np.pi * np.arange(64) / 64)
        file["z"].attrs["spacing"] = 1e-6


def refused(asperity, folder, *arguments):
    """The findings of a call that must change nothing; with --check they are the same."""
    before = {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    done = [asperity(*arguments, *more) for more in ((), ("--check",))]
    assert [run.returncode for run in done] == [1, 1], done[0].stderr
    assert done[0].stderr == done[1].stderr
    assert {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()} == before
    return done[0].stderr.splitlines()


# The name of a result that is taken, the namelists of the call, and the finding; the default result of rough.nml is rough.h5.
TAKEN = [
    *((name, {"rough.nml": to(name, DRY)}, "the height file rough.h5 as its result") for name in HEIGHTS[1:]),
    (HEIGHTS[0], {"rough.nml": DRY}, "the height file rough.h5 as its result"),
    *((way, {"case.nml": to(way)}, "the namelist case.nml as its result") for way in ("case.nml", "./case.nml", "sub/../case.nml")),
    ("link", {"case.nml": to("link")}, "the namelist case.nml as its result"),
    # a.h5.tmp is removed when a.h5 is begun
    ("a.h5.tmp", {"a.nml": STEADY, "a.h5.tmp": to("b.h5")}, "the namelist a.h5.tmp as its temporary file"),
]
# Two results of one name, or one in the way of the checkpoint of the other.
TWICE = ["x.h5", "./x.h5", "sub/../x.h5", "loop/x.h5", "x.h5.ckpt"]


@pytest.mark.parametrize(("name", "namelists", "finding"), TAKEN)
def test_inputs_are_no_place_for_a_result(asperity, tmp_path, name, namelists, finding):
    (tmp_path / "sub").mkdir()
    heights(tmp_path / "rough.h5")
    (tmp_path / "link.h5").symlink_to("rough.h5")
    (tmp_path / "link").symlink_to("case.nml")
    (tmp_path / "sub" / "link.h5").symlink_to(tmp_path / "link.h5")
    os.link(tmp_path / "rough.h5", tmp_path / "hard.h5")
    for file, content in namelists.items():
        write(tmp_path, file, content)
    first = next(iter(namelists))
    assert refused(asperity, tmp_path, *namelists) == [f"{first}: found {finding}, expected another &case output"], name


@pytest.mark.parametrize("name", TWICE)
def test_two_results_of_one_name(asperity, tmp_path, name):
    (tmp_path / "sub").mkdir()
    (tmp_path / "loop").symlink_to(".")
    write(tmp_path, "x.nml", STEADY)
    write(tmp_path, "y.nml", to(name))
    told = f"y.nml: found the result {name}, which is also that of x.nml, expected different names"
    assert refused(asperity, tmp_path, "x.nml", "y.nml") == [told]


def link(path):
    path.with_name("precious.txt").write_text("precious", encoding="utf-8")
    path.symlink_to("precious.txt")


def other_program(path):
    heights(path)
    with h5py.File(path, "r+") as file:
        file.attrs["program"] = np.bytes_("another")


# Files of the user, by what makes them.
FOREIGN = {
    "text": lambda path: path.write_text("asperity: notes on the program 'asperity'\n", encoding="utf-8"),
    "bytes": lambda path: path.write_bytes(bytes(range(256)) * 9),
    "empty": lambda path: path.touch(),
    "other HDF5": heights,
    "HDF5 of another program": other_program,
    "damaged": lambda path: path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(range(256))),
    "pipe": os.mkfifo,
    "link": link,
}


@pytest.mark.parametrize("kind", FOREIGN)
def test_what_is_no_result_is_not_replaced(asperity, tmp_path, kind):
    write(tmp_path, "case.nml", to(tmp_path / "precious.h5"))
    FOREIGN[kind](tmp_path / "precious.h5")
    assert refused(asperity, tmp_path, "case.nml") == [
        f"case.nml: found {tmp_path}/precious.h5 as its result, which is there and no result of asperity, "
        "expected another &case output (or remove it)"
    ]


def test_all_findings_at_once(asperity, tmp_path):
    (tmp_path / "notes.txt").write_text("precious", encoding="utf-8")
    write(tmp_path, "a.nml", to("a.nml"))
    write(tmp_path, "b.nml", to("notes.txt"))
    write(tmp_path, "c.nml", to("d.h5"))
    write(tmp_path, "d.nml", STEADY)
    found = refused(asperity, tmp_path, "a.nml", "b.nml", "c.nml", "d.nml")
    assert [line.split(":")[0] for line in found] == ["a.nml", "b.nml", "d.nml"]


def test_an_older_result_is_replaced(run_case, asperity, tmp_path):
    run_case(STEADY, "--quiet")
    first = (tmp_path / "case.h5").stat().st_ino
    assert asperity("case.nml", "--quiet").returncode == 0
    assert (tmp_path / "case.h5").stat().st_ino != first


@pytest.mark.parametrize("ending", [".part", ".tmp", ".ckpt", ".ckpt.tmp"])
def test_no_link_is_followed_beside_the_result(asperity, tmp_path, ending):
    write(tmp_path, "case.nml", STEADY)
    (tmp_path / "precious.txt").write_text("precious", encoding="utf-8")
    (tmp_path / f"case.h5{ending}").symlink_to("precious.txt")
    for options in ((), ("--resume",)):
        done = asperity("case.nml", "--quiet", *options)
        assert (done.returncode, done.stderr) == (3, f"asperity: cannot write case.h5: case.h5{ending} is a link\n")
        assert (tmp_path / "precious.txt").read_text(encoding="utf-8") == "precious"


def test_resume_leaves_a_running_job_alone(run_case, program, asperity, tmp_path):
    """A complete result is there, and another run makes it again: its checkpoint and temporary file are not ours."""
    short = LONG.replace("end_time = 1000.0", "end_time = 0.1")
    run_case(short, "--quiet")
    complete = (tmp_path / "case.h5").read_bytes()
    write(tmp_path, "long.nml", to("case.h5", LONG + "&output checkpoint_interval = 0.0 /\n"))
    with start(program, tmp_path, name="long.nml") as running:  # the same case would be done too soon: another one, to its name
        wait_for(tmp_path / "case.h5.ckpt", running)
        wait_for(tmp_path / "case.h5.part", running, times=20)
        done = asperity("case.nml", "--resume", "--quiet")
        assert (done.returncode, done.stderr) == (3, "asperity: cannot write case.h5: another run is writing case.h5.part\n")
        assert (tmp_path / "case.h5.ckpt").exists()
        assert (tmp_path / "case.h5.part").exists()
        running.send_signal(signal.SIGTERM)
        assert running.wait(HANGING) == 4
    assert (tmp_path / "case.h5").read_bytes() == complete
    assert asperity("case.nml", "--resume").stderr == "case.nml: case.h5 is complete: nothing to do\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["case.h5", "case.nml", "long.nml"]


WORKING = [".part", ".tmp", ".ckpt", ".ckpt.tmp"]
XDMF = "&output xdmf = .true. /\n"


@pytest.mark.path
@pytest.mark.parametrize("ending", WORKING)
def test_files_of_the_user_keep_their_place(asperity, tmp_path, ending):
    write(tmp_path, "case.nml", STEADY)
    path = tmp_path / f"case.h5{ending}"
    for kind in ("text", "bytes", "other HDF5", "HDF5 of another program"):
        path.unlink(missing_ok=True)
        FOREIGN[kind](path)
        content = path.read_bytes()
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
    write(tmp_path, "case.nml", LONG_DRY)
    with start(program, tmp_path) as running:
        wait_for(tmp_path / "case.h5.part", running)
        for ending in WORKING[1:]:
            (tmp_path / f"case.h5{ending}").write_text("precious", encoding="utf-8")
        running.send_signal(signal.SIGTERM)
        assert running.wait(HANGING) == 4
    assert [(tmp_path / f"case.h5{ending}").read_text(encoding="utf-8") for ending in WORKING[1:]] == ["precious"] * 3
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

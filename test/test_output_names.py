"""A result never takes the place of what the user has: inputs, other results, files that are no results, what links lead to."""

import os
import signal

import h5py
import numpy as np
import pytest
from cases import HANGING, LONG, STEADY, write
from kill_and_resume import start, wait_for

DRY = """&case problem = 'dry_line' /
&bodies youngs_modulus_1 = 206e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 1e8 /
&surface_1 shape = 'file', file = 'rough.h5', dataset = 'z' /
"""
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
    *(
        (name, {"case.nml": to(name)}, "the namelist case.nml as its result")
        for name in ("case.nml", "./case.nml", "sub/../case.nml")
    ),
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
    assert refused(asperity, tmp_path, "x.nml", "y.nml") == [
        f"y.nml: found the result {name}, which is also that of x.nml, expected different names"
    ]


def foreign(path, kind):
    if kind == "text":
        path.write_text("precious", encoding="utf-8")
    elif kind == "empty":
        path.touch()
    elif "HDF5" in kind:
        heights(path)
        with h5py.File(path, "r+") as file:
            file.attrs.update({"program": np.bytes_("another")} if "program" in kind else {})
    elif kind == "damaged":
        path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(range(256)))
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "link":
        (path.parent / "precious.txt").write_text("precious", encoding="utf-8")
        path.symlink_to("precious.txt")


@pytest.mark.parametrize("kind", ["text", "empty", "other HDF5", "HDF5 of another program", "damaged", "pipe", "link"])
def test_what_is_no_result_is_not_replaced(asperity, tmp_path, kind):
    write(tmp_path, "case.nml", to(tmp_path / "precious.h5"))
    foreign(tmp_path / "precious.h5", kind)
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

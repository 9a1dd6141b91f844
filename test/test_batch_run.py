"""batch/run.py and `asperity --outcomes`: what runs, what is left alone, what is said of each case."""

import csv
import importlib.util
import os
import resource
import shutil
import signal
import subprocess
import sys
import time

import cases
import h5py
import pytest
from cases import BATCH, swept
from program_calls import FAILED, bad_input, end_of, outcomes


def module_of(path):
    """A script by its path: other folders have a run.py, too."""
    spec = importlib.util.spec_from_file_location("batch_run", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


chunks = module_of(BATCH / "run.py").chunks

# Transients of some seconds: long enough to be interrupted, with checkpoints.
SLOW = """base = "base.nml"
[vary]
bodies.speed_2 = [1.0, 1.1, 1.2, 1.3]
[set]
time.end_time = 160.0
time.time_step = 0.02
accuracy.error_bars = false
output.profile_stride = 100
"""


@pytest.fixture
def run(batch):
    """Calls run.py with two jobs on a folder."""
    return lambda folder, *options, **more: batch("run.py", folder.name, "--jobs", "2", *options, **more)


def stamps(folder):
    return {path.name: path.stat().st_mtime_ns for path in (folder / "cases").glob("*.h5")}


@pytest.mark.path
def test_outcomes_are_a_line_for_each_case(asperity, tmp_path):
    cases.write(tmp_path, "good.nml", cases.STEADY)
    cases.write(tmp_path, "few.nml", cases.STEADY + "&solver method = 'fas_block_jacobi', max_cycles = 1 /\n")
    cases.write(tmp_path, "blocked.nml", cases.STEADY)
    (tmp_path / "blocked.h5").mkdir()
    done = cases.ended(asperity("good.nml", "few.nml", "blocked.nml", "--quiet", "--outcomes"), 3)
    good, few, blocked = (line.split("\t") for line in done.stdout.splitlines())
    assert good == ["0", "good.nml", ""]
    assert few[:2] == ["2", "few.nml"]
    with h5py.File(tmp_path / "few.h5") as file:
        assert few[2] == cases.text(file.attrs["reason"])
    assert blocked == ["3", "blocked.nml", "cannot write blocked.h5: it is a folder"]
    again = asperity("good.nml", "few.nml", "--quiet", "--outcomes", "--resume")
    assert again.stdout == "\t".join(good) + "\n" + "\t".join(few) + "\n"
    assert asperity("good.nml", "--quiet").stdout == ""


def test_runs_all_then_nothing_then_what_has_changed(run, tmp_path, program):
    folder = swept(tmp_path, program)
    done = run(folder, status=2)
    assert "done                3" in done.stdout
    assert "case_0002  fas block_jacobi" in done.stdout
    assert "4 of 4 cases, 1 not converged" in done.stderr
    with next((folder / "log").glob("*.csv")).open(newline="", encoding="utf-8") as file:
        log = list(csv.reader(file))
    assert sorted(row[:2] for row in log) == [[f"case_{i:04d}", "2" if i == 2 else "0"] for i in (1, 2, 3, 4)]
    before = stamps(folder)
    time.sleep(0.05)
    assert "4 of these were complete before" in run(folder, status=2).stdout
    assert stamps(folder) == before
    # a damaged result, a missing one, and one of another input: these three run again
    damaged = folder / "cases" / "case_0001.h5"
    damaged.write_bytes(damaged.read_bytes()[:-2000])
    (folder / "cases" / "case_0003.h5").unlink()
    namelist = folder / "cases" / "case_0004.nml"
    namelist.write_text(namelist.read_text(encoding="utf-8").replace("300000000.0", "350000000.0"), encoding="utf-8")
    assert "1 of these were complete before" in run(folder, status=2).stdout
    after = stamps(folder)
    assert [name for name in after if after[name] == before.get(name)] == ["case_0002.h5"]
    # results of another version run again
    for path in (folder / "cases").glob("*.h5"):
        with h5py.File(path, "r+") as file:
            file.attrs["version"] = "0.0.9"
        cases.seal(path)
    assert "complete before" not in run(folder, status=2).stdout
    assert all(stamps(folder)[name] != stamp for name, stamp in after.items())


def test_bad_input_and_a_blocked_name_keep_nothing_else_from_running(run, tmp_path, program):
    folder = swept(tmp_path, program)
    bad = folder / "cases" / "case_0001.nml"
    bad.write_text(bad.read_text(encoding="utf-8").replace("viscosity", "viscosty"), encoding="utf-8")
    (folder / "cases" / "case_0004.h5").mkdir()
    done = run(folder, status=3)
    assert "done                1" in done.stdout
    assert "failed              2" in done.stdout
    assert "case_0001  case_0001.nml:" in done.stdout
    assert "viscosty: found an unknown key" in done.stdout
    assert "case_0004  cannot write ./case_0004.h5: it is a folder" in done.stdout
    (folder / "cases" / "case_0004.h5").rmdir()
    done = run(folder, status=3)  # repeats the two that failed
    assert "2 of these were complete before" in done.stdout
    assert "failed              1" in done.stdout


def test_a_case_that_ends_its_process_does_not_end_the_others(batch, run, tmp_path, program):
    folder = swept(tmp_path, program)
    crashing = tmp_path / "crashing"
    crashing.write_text(
        f"""#!/usr/bin/env python3
import os, signal, subprocess, sys
for i, word in enumerate(sys.argv[1:]):
    if word == "case_0003.nml":
        sys.argv[i + 1 :] = [w for w in sys.argv[i + 1 :] if w.startswith("--")] + ["--output", "."]
        if i: subprocess.run(["{program}", *sys.argv[1:]])
        print("backtrace of something", file=sys.stderr)
        os.kill(os.getpid(), signal.SIGSEGV)
os.execv("{program}", ["{program}", *sys.argv[1:]])
""",
        encoding="utf-8",
    )
    crashing.chmod(0o755)
    done = batch("run.py", "small", "--jobs", "1", "--program", str(crashing), status=3)
    assert "done                2" in done.stdout
    assert "case_0003  the program was ended by SIGSEGV: backtrace of something" in done.stdout
    run(folder, status=2)


def test_a_full_disk_in_the_middle(run, tmp_path, program):
    """A limit on the size of files stands for it: the result has no room, the log has."""
    folder = swept(tmp_path, program)

    def little_room():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))

    assert "failed              4" in run(folder, preexec_fn=little_room, status=3).stdout
    assert list((folder / "cases").glob("*.h5*")) == []
    run(folder, status=2)
    assert len(stamps(folder)) == 4


def running(folder, program, jobs):
    """run.py, which has begun a case."""
    command = [sys.executable, str(BATCH / "run.py"), "small", "--jobs", jobs]
    options = {"text": True, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    process = subprocess.Popen(command, cwd=folder.parent, env={**os.environ, "ASPERITY": str(program)}, **options)
    while not list((folder / "cases").glob("*.part")):
        assert process.poll() is None
        time.sleep(0.02)
    return process


def test_an_interrupted_run_goes_on_and_ends_as_if_it_had_not_been(run, tmp_path, program):
    folder = swept(tmp_path, program, SLOW, cases.TRANSIENT)
    whole = shutil.copytree(folder, tmp_path / "whole")
    run(whole)
    process = running(folder, program, "2")
    time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=cases.HANGING)
    assert process.returncode == 4, err
    assert "not run" in out
    assert "interrupted; the same command continues" in err
    # nothing goes on behind our back, and what was begun has left a checkpoint
    found = sorted(path.name for path in (folder / "cases").iterdir())
    time.sleep(0.3)
    assert found == sorted(path.name for path in (folder / "cases").iterdir())
    assert any(name.endswith(".ckpt") for name in found)
    run(folder)
    for path in (whole / "cases").glob("*.h5"):
        one, other = cases.contents(path), cases.contents(folder / "cases" / path.name)
        assert one.keys() == other.keys()
        assert [key for key in one if "seconds" not in key and not cases.same_bits(one[key], other[key])] == []


def test_two_runs_of_the_same_cases(batch, run, tmp_path, program):
    folder = swept(tmp_path, program, SLOW, cases.TRANSIENT)
    process = running(folder, program, "1")
    assert "these cases are being run already" in run(folder, status=1).stderr
    batch("sweep.py", "small.toml", "--replace")  # nothing has changed
    (tmp_path / "small.toml").write_text(SLOW.replace("1.3", "1.4"), encoding="utf-8")
    assert "its cases are being run" in batch("sweep.py", "small.toml", "--replace", status=1).stderr
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=cases.HANGING)
    assert process.returncode == 4


def test_a_part_of_the_cases(tmp_path, program, run):
    folder = swept(tmp_path, program)
    for words in ("0-3", "3-1", "5-9", "two", "-3"):
        assert "expected FIRST-LAST between 1 and 4" in run(folder, f"--cases={words}", status=1).stderr
    run(folder, "--cases", "3-9")
    assert sorted(stamps(folder)) == ["case_0003.h5", "case_0004.h5"]


def test_folders_that_are_no_sweep(batch, run, tmp_path, program):
    (tmp_path / "empty").mkdir()
    unfinished = "has no index.csv: it is no sweep, or one that is not written to its end"
    for name, words in (("none", "is not there"), ("empty", unfinished)):
        for script in ("run.py", "gather.py"):
            assert words in batch(script, name, status=1).stderr
    folder = swept(tmp_path, program)
    assert "run make build" in batch("run.py", "small", "--program", "nowhere", status=1).stderr
    (folder / "index.csv").write_text("x,y\n1\n", encoding="utf-8")
    assert "is no index of cases" in run(folder, status=1).stderr


def test_chunks_hold_every_case_once_and_get_smaller():
    for count, jobs in ((1, 1), (30, 2), (1000, 2), (1000, 64), (7, 8)):
        names = [str(i) for i in range(count)]
        pieces = list(chunks(names, jobs))
        assert [name for piece in pieces for name in piece] == names
        sizes = [len(piece) for piece in pieces]
        assert sizes == sorted(sizes, reverse=True)
        assert sizes[-1] == 1
        assert max(sizes) <= 50


def test_what_the_program_says_is_understood():
    lines = ["0\tcase_1.nml\t\n", "3\tcase_2.nml\tno room\n", "1\tcase_3.nml\tno memory\n"]
    lines += ["2\tcase_4.nml\tstagnation", "x\n", "\n"]
    assert list(outcomes(iter(lines))) == [("case_1", 0, ""), ("case_2", FAILED, "no room"), ("case_3", FAILED, "no memory")]
    errors = "case_1.nml:3: &load load: found nothing\ncase_1.nml:4: again\n"
    assert bad_input(errors, ["case_1", "case_2"]) == {"case_1": "case_1.nml:3: &load load: found nothing; case_1.nml:4: again"}
    assert bad_input("asperity: no memory\n", ["a", "b"]) == dict.fromkeys("ab", "asperity: no memory")
    assert end_of(-9, "") == "the program was ended by SIGKILL (by somebody, or for lack of memory)"
    assert end_of(7, "one\ntwo\n") == "the program ended with status 7: one two"

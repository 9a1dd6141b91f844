"""What a run says: few lines, a word before 5 s of work are over, a short table; asked to end it ends within a second."""

import contextlib
import os
import pty
import re
import signal
import subprocess
from pathlib import Path

import h5py
import pytest
from cases import AT_REST, HANGING, LONG, ROOT, STEADY, TRANSIENT, called, ended, write
from kill_and_resume import start, wait_for
from test_resume import SIGNALS, names

# Processor time of several threads is no measure of waiting.
ONE_THREAD = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
# Most processor time without a line, and from a signal to the end [s].
SILENCE, RESPONSE = 5.0, 1.0
DENSE = STEADY.replace("intervals = 256", "intervals = 8192") + "&solver method = 'newton_dense' /\n"
AREA = """&case problem = 'dry_area' /
&bodies youngs_modulus_1 = 206e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 1e7, 1e8, 3e8, 1e9, 3e9 /
&surface_1 shape = 'synthetic', seed = 3, hurst = 0.8, rms_height = 1e-6, wavelength_long = 1e-3, wavelength_short = 4e-6 /
&domain length_x = 1e-3, length_y = 1e-3, intervals_x = 2048, intervals_y = 2048 /
"""
HEIGHTS = """&case problem = 'dry_line' /
&bodies youngs_modulus_1 = 206e9, poisson_ratio_1 = 0.3 /
&load mean_pressure = 1e7 /
&surface_1 shape = 'file', file = 'rough.csv' /
"""
ROWS = 4_000_000
NOTHING = "interrupted without a checkpoint, nothing is kept of case.h5"
GOES_ON = "interrupted; --resume continues after step 200 with case.h5.ckpt"
# Few steps on a fine grid: to write the result takes half as long as they do. A checkpoint at each of them, the last one too.
FIELDS = (
    TRANSIENT.replace("256", "32768").replace("end_time = 1.0, time_step = 0.05", "end_time = 0.8, time_step = 0.004")
    + "&accuracy error_bars = .false. /\n&output checkpoint_interval = 1e-3 /\n"
)
TARGET = TRANSIENT.replace(", intervals = 256", "").replace("1.0, time_step = 0.05", "12.0") + "&accuracy target = 1e-6 /\n"


def processor_seconds(pid):
    """Processor time of all threads of a process so far [s]; None where there is none any more."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    except (FileNotFoundError, ProcessLookupError):
        return None
    return sum(map(int, fields[11:13])) / os.sysconf("SC_CLK_TCK")


def write_heights(folder, rows):
    """A table that takes a second for each million of rows to read; two heights, with more digits than are read fast."""
    table = "".join(f"{i}e-7,1.{5 - i % 2}0000000000000000e-8\n" for i in range(rows))
    (folder / "rough.csv").write_text("x,z\n" + table, encoding="ascii")


def shown(reader):
    """What comes through a pipe or a terminal, as it comes."""
    with contextlib.suppress(OSError):  # a terminal: the other end is closed
        while text := os.read(reader, 65536):
            yield text
    os.close(reader)


def channel(is_terminal):
    if not is_terminal:
        return os.pipe()
    try:
        return pty.openpty()
    except OSError:
        pytest.skip("not applicable: no pseudo-terminals here")


@pytest.mark.parametrize(
    ("case", "is_terminal", "words", "last", "kept"),
    [
        (DENSE, False, r"steady on 8192 intervals by newton_dense, \d+ s", NOTHING, []),
        (AREA, True, r"solving, \d+ s", NOTHING, []),
        (HEIGHTS, False, r"reading rough.csv, \d+ s", "interrupted", []),
        (TARGET, False, r"coarse run, \d+ % of steps on \d+ intervals, \d+ s", NOTHING, []),
        (FIELDS, False, "step 200/200 .*", GOES_ON, ["case.h5.ckpt", "case.h5.part"]),
    ],
    ids=["dense", "area", "heights", "target", "fields"],
)
def test_no_long_silence(program, tmp_path, case, is_terminal, words, last, kept):
    """Listens until the sign of what takes long has come (writing a result: the last step), and then asks the program to end."""
    write(tmp_path, "case.nml", case)
    if case == HEIGHTS:
        write_heights(tmp_path, ROWS)
    before, asked, message = 0.0, None, ""
    reader, writer = channel(is_terminal)
    with subprocess.Popen([program, "case.nml"], cwd=tmp_path, stderr=writer, env=ONE_THREAD) as running:
        os.close(writer)
        for piece in filter(None, (line.strip() for text in shown(reader) for line in re.split(rb"[\r\n]+", text))):
            message = piece.decode()
            now = processor_seconds(running.pid) or before
            assert now - before < SILENCE, message
            before = now
            if asked is None and re.fullmatch(rf"case\.nml: {words}", message):
                asked = now
                running.send_signal(signal.SIGTERM)
        _, status, usage = os.wait4(running.pid, 0)
        running.returncode = os.waitstatus_to_exitcode(status)
    assert asked is not None, message
    assert usage.ru_utime + usage.ru_stime - asked < RESPONSE
    assert running.returncode == 4
    assert message.endswith(f"asperity: {last}")
    assert [name for name in names(tmp_path) if name not in ("case.nml", "rough.csv")] == kept
    if case == FIELDS:
        subprocess.run([program, "case.nml", "--resume", "--quiet"], cwd=tmp_path, check=True)
        with h5py.File(tmp_path / "case.h5") as file:
            assert file.attrs["converged"] == 1
            assert len(file["transient/pressure"]) == 201
        assert names(tmp_path) == ["case.h5", "case.nml"]


# Seconds of solving, without a look at the outside.
DRY = AREA.replace("2048", "1024").replace("1e7, 1e8, 3e8, 1e9, 3e9", "1e7, 2e7, 4e7, 8e7, 1e8, 2e8, 3e8, 4e8, 5e8, 6e8")


def end(running, number):
    """Sends a signal; status, what was said, and processor time from the signal to the end [s]."""
    before = processor_seconds(running.pid)
    running.send_signal(number)
    _, status, usage = os.wait4(running.pid, 0)
    running.returncode = os.waitstatus_to_exitcode(status)
    return running.returncode, running.stderr.read(), usage.ru_utime + usage.ru_stime - before


@pytest.mark.parametrize("number", SIGNALS)
def test_a_dry_case_ends_within_a_second(program, tmp_path, number):
    write(tmp_path, "dry.nml", DRY)
    write(tmp_path, "later.nml", STEADY)
    with start(program, tmp_path, "later.nml", name="dry.nml") as running:
        wait_for(tmp_path / "dry.h5.part", running)
        status, message, seconds = end(running, number)
    assert (status, message) == (4, "asperity: interrupted without a checkpoint, nothing is kept of dry.h5\n")
    assert seconds < 1.5
    assert names(tmp_path) == ["dry.nml", "later.nml"]


def test_a_reader_that_no_longer_reads_does_not_hold_up_the_end(program, tmp_path):
    """Standard error is a full pipe, and there is one thread, which the handler of a signal must not leave waiting for it."""
    write(tmp_path, "dry.nml", DRY)
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while os.write(writer, b"x"):
            pass
    os.set_blocking(writer, True)
    one_thread = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    with subprocess.Popen([program, "dry.nml", "--quiet"], cwd=tmp_path, stderr=writer, env=one_thread) as running:
        wait_for(tmp_path / "dry.h5.part", running)
        running.send_signal(signal.SIGTERM)
        try:
            assert running.wait(HANGING) == 4
        finally:
            running.kill()
            os.close(reader)
            os.close(writer)
    assert names(tmp_path) == ["dry.nml"]


def test_an_ignored_signal_stays_ignored(program, tmp_path):
    """nohup."""
    write(tmp_path, "case.nml", LONG.replace("end_time = 1000.0", "end_time = 2.0"))
    command = ["nohup", program, "case.nml", "--quiet"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as running:
        wait_for(tmp_path / "case.h5.part", running)
        assert end(running, signal.SIGHUP)[0] == 0


def test_later_cases_run_though_nobody_reads(program, tmp_path):
    cases = ("one.nml", "dry.nml", "two.nml")
    write(tmp_path, "one.nml", STEADY)
    write(tmp_path, "two.nml", STEADY)
    write(tmp_path, "dry.nml", DRY.replace("1024", "64").replace("4e-6", "5e-5"))
    with subprocess.Popen([program, *cases], cwd=tmp_path, stderr=subprocess.PIPE) as running:
        running.stderr.close()
    assert running.returncode == 0
    assert names(tmp_path) == sorted([*cases, "one.h5", "dry.h5", "two.h5"])


@pytest.mark.parametrize("closed", ["2>&-", ">&-", "<&-", "<&- >&- 2>&-"])
def test_closed_streams_do_not_end_up_in_a_result(program, tmp_path, closed):
    """A file gets the lowest free descriptor: without care messages would go into the first one that is opened."""
    write(tmp_path, "case.nml", STEADY)
    assert subprocess.run(f"'{program}' case.nml {closed}", shell=True, cwd=tmp_path, check=False).returncode == 0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 1
    done = called([program, "case.nml", "--resume"], cwd=tmp_path)
    assert done.stderr == "case.nml: case.h5 is complete: nothing to do\n"


@pytest.mark.parametrize("option", ["--help", "--version", "--keys", "--keys-markdown", "--template ehl_line", "--check case.nml"])
@pytest.mark.parametrize("target", ["> /dev/full", ">&-"])
def test_lost_text_is_told(program, tmp_path, option, target):
    write(tmp_path, "case.nml", STEADY)
    command = f"'{program}' {option} {target}"
    done = ended(called(command, shell=True, cwd=tmp_path), 3)
    assert done.stderr == "cannot write to standard output: the disk is full, or nobody reads it\n"


# The ridge leaves the contact before the end.
WHOLE = TRANSIENT.replace("end_time = 1.0, time_step = 0.05", "end_time = 2.0, time_step = 0.025")
WHOLE += "&accuracy error_bars = .false. /\n"


def test_log_has_few_plain_lines(run_case):
    done = run_case(WHOLE, name="a")
    lines = done.stderr.splitlines()
    assert "\r" not in done.stderr
    steps = [line for line in lines if "step " in line]
    assert len(steps) == 10
    assert re.match(r"a\.nml: step 8/80  T 0\.2000  h_min \d+\.?\d* nm  \d+ s left$", steps[0])
    assert any(re.match(r"a\.nml: cycle 1  residual \S+  load error \S+$", line) for line in lines)
    assert max(len(line) for line in lines) <= 80


@pytest.mark.parametrize("name", ["case1", "case3_demo", "minimal", "moes_barus", "overtaking", "rolling_sinusoid"])
def test_table_is_short(asperity, name):
    """At most twelve lines, and of what is not in them their number."""
    lines = asperity(ROOT / "input" / f"{name}.nml").stdout.splitlines()
    assert 7 <= len(lines) <= 12
    assert max(map(len, lines)) <= 80
    assert lines[1].split()[:2] == ["contact", "M" if name == "moes_barus" else "p_h"]
    assert [line.split()[0] for line in lines[2:4]] == ["h_min", "h_central"]
    assert ("+-" in lines[2]) and (" at T " in lines[2]) == (name in ("case3_demo", "overtaking", "rolling_sinusoid"))
    assert ("  lambda ratio 11.02 " in "\n".join(lines)) == (name == "rolling_sinusoid")
    assert any(re.match(r"  more      \d lines with --verbose", line) for line in lines) == (name == "overtaking")


def test_reasons_are_told_once(run_case):
    done = run_case(STEADY + "&solver start = 'hertz', max_cycles = 1 /\n", status=2, name="a")
    for stream in (done.stderr, done.stdout):
        assert "a.nml: NOT CONVERGED: " in stream
        assert max(len(line) for line in stream.splitlines()) <= 80
    # Newton's method fails with three starts in the same way.
    done = run_case(STILL.replace("1e5", "1e4") + WAVES, "--quiet", status=2)
    outcome = " ".join(done.stderr.split("NOT CONVERGED: ")[1].split())
    assert outcome.startswith("the surfaces rise to ")
    reasons = outcome.split("; ")
    assert len(reasons) == len(set(reasons)) > 1
    done = run_case(STILL + WAVES + "&solver smoother = 'hybrid' /\n", status=2, name="a")
    assert "h_min" not in done.stdout
    assert done.stdout.splitlines()[-1].split() == ["result", "a.h5"]


# Waves of many films on a surface at rest; the domain is the program's.
STILL = "".join(line + "\n" for line in AT_REST.splitlines() if "&domain" not in line)
WAVES = "&surface_1 shape = 'sinusoid', amplitude = 5e-6, wavelength = 6e-5 /\n"


def test_terminal_shows_one_updating_line(program, tmp_path):
    write(tmp_path, "a.nml", WHOLE)
    reader, writer = channel(is_terminal=True)
    with subprocess.Popen([program, "a.nml"], cwd=tmp_path, stdout=writer, stderr=writer) as running:
        os.close(writer)
        text = b"".join(shown(reader)).decode()
    assert running.returncode == 0
    lines = text.replace("\r\n", "\n").split("\n")
    assert len(lines) == 13  # the updating line with the table's first line, eleven more, and what follows the last
    assert "\r" in lines[0]
    assert "cycle 1" in lines[0]
    assert lines[0].split("\r")[-1].startswith("a.nml: converged")
    assert all("\r" not in line for line in lines[1:])

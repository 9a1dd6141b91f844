"""Wherever a run spends its time it says so before 5 s of processor time are over, and a signal ends it within a second there."""

import contextlib
import os
import pty
import re
import signal
import subprocess

import h5py
import pytest
from cases import STEADY, TRANSIENT, write
from silence import ONE_THREAD, processor_seconds
from test_resume import names

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


def write_heights(folder, rows):
    """A table that takes a second for each million of rows to read; two heights, with more digits than are read fast."""
    table = "".join(f"{i}e-7,1.{5 - i % 2}0000000000000000e-8\n" for i in range(rows))
    (folder / "rough.csv").write_text("x,z\n" + table, encoding="ascii")


def pieces(reader):
    """What comes through a pipe or a terminal, line by line or updated line by updated line."""
    with contextlib.suppress(OSError):  # a terminal: the other end is closed
        while text := os.read(reader, 65536):
            yield from filter(None, (piece.strip() for piece in re.split(rb"[\r\n]+", text)))
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
        for piece in pieces(reader):
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

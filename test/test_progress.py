"""Progress: few lines in a log, one updating line on a terminal, a short closing table."""

import os
import pty
import re
import subprocess

import pytest
from cases import AT_REST, STEADY, TRANSIENT, write
from conftest import ROOT

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
    try:
        reader, writer = pty.openpty()
    except OSError:
        pytest.skip("not applicable: no pseudo-terminals here")
    with subprocess.Popen([program, "a.nml"], cwd=tmp_path, stdout=writer, stderr=writer) as running:
        os.close(writer)
        shown = b""
        while True:
            try:
                piece = os.read(reader, 65536)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            shown += piece
    os.close(reader)
    assert running.returncode == 0
    lines = shown.decode().replace("\r\n", "\n").split("\n")
    assert len(lines) == 13  # the updating line with the table's first line, eleven more, and what follows the last
    assert "\r" in lines[0]
    assert "cycle 1" in lines[0]
    assert lines[0].split("\r")[-1].startswith("a.nml: converged")
    assert all("\r" not in line for line in lines[1:])

"""How long a run says nothing, in its own processor time: other work on the machine does not count."""

import os
import subprocess
from pathlib import Path

TICKS = os.sysconf("SC_CLK_TCK")
# Processor time of several threads is no measure of waiting.
ONE_THREAD = os.environ | {"OPENBLAS_NUM_THREADS": "1"}


def processor_seconds(pid):
    """Processor time of all threads of a process so far [s]; None where there is none any more."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    except (FileNotFoundError, ProcessLookupError):
        return None
    return sum(map(int, fields[11:13])) / TICKS


def listen(command, folder, prepare=None):
    """Runs a command, after a call in its process: its status, and lines of standard error with the processor time when they came
    [s], the end last."""
    heard = []
    pipes = {"stderr": subprocess.PIPE, "stdout": subprocess.DEVNULL}
    with subprocess.Popen(command, cwd=folder, env=ONE_THREAD, preexec_fn=prepare, **pipes) as running:  # noqa: PLW1509  one thread
        for line in running.stderr:
            heard.append((line.decode("utf-8", "replace").rstrip("\n"), processor_seconds(running.pid)))
        _, status, usage = os.wait4(running.pid, 0)
        running.returncode = os.waitstatus_to_exitcode(status)
    heard.append(("", usage.ru_utime + usage.ru_stime))
    return running.returncode, heard


def longest_silence(heard):
    """The longest silence [s], and the line that ended it."""
    times = [0.0] + [seconds for _, seconds in heard]
    return max((times[i + 1] - times[i], line) for i, (line, _) in enumerate(heard))

"""How long a run says nothing, in its own processor time: other work on the machine does not count."""

import os
import subprocess
from pathlib import Path

TICKS = os.sysconf("SC_CLK_TCK")


def processor_seconds(pid):
    """Processor time of all threads of a process so far [s]; None where there is none any more."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    except (FileNotFoundError, ProcessLookupError):
        return None
    return sum(map(int, fields[11:13])) / TICKS


def listen(command, folder):
    """Runs a command; its status, and pairs of a line of standard error and the processor time when it came [s], the end last."""
    heard = []
    with subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL) as running:
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

"""Memory: the forecast of a case, what is refused because of it, and that what is not refused has enough."""

import os
import re
import resource
import subprocess
import sys

import pytest
from cases import HANGING, STEADY, TRANSIENT, called, ended, write
from dry_cases import case_text

MEGABYTE = 1e6
WAVE = "shape = 'sinusoid', amplitude = 1e-7, wavelength = 1e-3"
AREA = "&domain length_x = 1e-3, length_y = 1e-3, intervals_x = {0}, intervals_y = {0}, periodic = .{1}. /"
LINE = "&domain length = 1e-3, intervals = {0}, periodic = .{1}. /"
# Address space of OpenBLAS that is hardly written to.
MAPPED = 136.0
CASES = {
    "line": (case_text(WAVE, [1e6], "", LINE.format(100000, "true")), 0.0),
    "open_line": (case_text(WAVE, [1e6], "", LINE.format(300000, "false")), 0.0),
    "area": (case_text(WAVE, [1e6], "", AREA.format(640, "true"), "dry_area"), 0.0),
    "open_area": (case_text(WAVE, [1e6], "", AREA.format(400, "false"), "dry_area"), 0.0),
    "steady": (STEADY.replace("intervals = 256", "intervals = 65536"), MAPPED),
    "dense": (STEADY.replace("256", "2048") + "&solver method = 'newton_dense' /\n", MAPPED),
    "transient": (TRANSIENT.replace("256", "8192"), MAPPED),
}


# Starts the program from a small process, and prints its largest memory [kB]: a process that is forked off inherits that.
MEASURE = """import os, sys
started = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(started, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""


def call(program, folder, text, kinds=(), limit=0.0, **env):
    def restrict():
        for kind in kinds:
            resource.setrlimit(kind, (int(limit * MEGABYTE),) * 2)

    write(folder, "case.nml", text)
    return called([program, "case.nml", "--quiet"], cwd=folder, env=os.environ | env, preexec_fn=restrict)


@pytest.mark.parametrize("name", CASES)
def test_what_is_predicted_is_enough_and_asked_for(program, tmp_path, name):
    text, mapped = CASES[name]
    refused = call(program, tmp_path, text, [resource.RLIMIT_DATA], 30.0)
    pattern = r"found a grid that needs up to (\S+) MB of memory, expected at most 30.00 MB, the limit of data \(ulimit -d\)\n"
    found = re.search(pattern, ended(refused, 1).stderr)
    assert found, refused.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["case.nml"]
    predicted = float(found[1])
    done = called([sys.executable, "-S", "-E", "-c", MEASURE, program, "case.nml", "--quiet"], cwd=tmp_path)
    assert done.returncode in (0, 2), done.stderr
    assert int(done.stdout) * 1024 / MEGABYTE <= predicted - mapped
    for kind, most in (resource.RLIMIT_DATA, predicted), (resource.RLIMIT_AS, predicted + 100):
        done = call(program, tmp_path, text, [kind], most + 1)
        assert done.returncode in (0, 2), done.stderr


def test_address_space_that_is_too_small(program, tmp_path):
    for limit in (60.0, 100.0, 140.0):
        done = ended(call(program, tmp_path, STEADY, [resource.RLIMIT_AS], limit), 1)
        assert "what the limit of the address space (ulimit -v) leaves beside the libraries" in done.stderr
        assert not (tmp_path / "case.h5").exists()


def test_libraries_with_threads_under_a_limit(program, tmp_path):
    """Each thread of OpenBLAS takes 134 MB, or waits for them for ever: the program says what to do and ends."""
    (tmp_path / "threads.c").write_text(
        "#include <pthread.h>\n#include <unistd.h>\nstatic pthread_t thread;\n"
        "static void *wait_for_ever(void *_) { for (;;) pause(); }\n"
        "__attribute__((constructor)) static void begin(void) { pthread_create(&thread, 0, wait_for_ever, 0); }\n"
        "__attribute__((destructor)) static void end(void) { pthread_join(thread, 0); }\n",
        encoding="utf-8",
    )
    command = ["gcc", "-shared", "-fPIC", "-o", "threads.so", "threads.c", "-lpthread"]
    subprocess.run(command, cwd=tmp_path, check=True, timeout=HANGING)
    done = ended(call(program, tmp_path, STEADY, [resource.RLIMIT_AS], 1000.0, LD_PRELOAD=str(tmp_path / "threads.so")), 1)
    told = "found a library with threads under a limit of memory (ulimit -v or -d), expected OPENBLAS_NUM_THREADS=1 in the"
    assert done.stderr == f"{told} environment\n"

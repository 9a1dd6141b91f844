"""What the end-to-end tests share: the program, called as a user calls it."""

import contextlib
import os
import pathlib
import signal

import h5py
import pytest
from cases import ROOT, called, contents, ended, processor, write
from cases import call as call_batch

# Shells ignore SIGINT for what runs in the background, nohup SIGHUP, and programs inherit that: the runs that these tests interrupt
# must not. A handler of our own is not inherited.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, lambda *_: None)


def pytest_collection_modifyitems(items):
    """Tests that are marked `nightly` run where NIGHTLY is set."""
    for item in items if not os.environ.get("NIGHTLY") else ():
        if item.get_closest_marker("nightly"):
            item.add_marker(pytest.mark.skip(reason="not applicable: .ci/nightly runs it"))


@pytest.fixture(scope="session")
def program():
    """Path of the asperity to test: the environment variable ASPERITY, else what `make build` left."""
    path = pathlib.Path(os.environ.get("ASPERITY", ROOT / "build" / "bin" / "asperity")).resolve()
    if not path.is_file():
        pytest.fail(f"{path} is missing: run make build")
    return path


@pytest.fixture
def package(program, tmp_path, monkeypatch):
    """The Python package with this program, in an empty folder."""
    monkeypatch.setenv("ASPERITY", str(program))
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def diverging(program, asperity):
    """Like asperity, for runs that may outgrow all numbers: there the checked build ends at the first overflow, as it should."""

    def call(*arguments, **options):
        done = asperity(*arguments, **options)
        if done.returncode == -signal.SIGFPE and program.name == "asperity-debug":
            pytest.skip("not applicable: the checked build ends at the first overflow")
        return done

    return call


@pytest.fixture
def asperity(program, tmp_path):
    """Calls the program in an empty folder: asperity('case.nml', '--quiet') gives returncode, stdout and stderr.

    It is killed, so that its status is -9, after so many `seconds` of processor time.
    """

    def call(*arguments, cwd=tmp_path, seconds=120):
        command = [str(program), *map(str, arguments)]
        return called(command, cwd=cwd, preexec_fn=processor(seconds))

    return call


@pytest.fixture(scope="module")
def solve_all(program, tmp_path_factory):
    """Runs cases that are given as {name: text}, none of which has a word to say: the folder with their results."""

    def call(cases):
        folder = tmp_path_factory.mktemp("results")
        for name, content in cases.items():
            write(folder, f"{name}.nml", content)
            done = called([program, f"{name}.nml", "--quiet"], cwd=folder)
            assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
        return folder

    return call


@pytest.fixture
def batch(program, tmp_path):
    """Calls a script of batch/ in an empty folder: batch('sweep.py', 'small.toml', status=1) ended with that status, in words."""

    def call(script, *arguments, status=0, **options):
        done = ended(call_batch(script, *arguments, folder=tmp_path, program=program, **options), status)
        assert "Traceback" not in done.stderr
        return done

    return call


@pytest.fixture
def run_case(asperity, tmp_path):
    """Runs a case that is given as text: run_case(text, '--quiet', status=2) ended with that status."""

    def call(content, *options, status=0, name="case", **more):
        write(tmp_path, f"{name}.nml", content)
        return ended(asperity(f"{name}.nml", *options, **more), status)

    return call


@pytest.fixture
def solved_case(run_case, tmp_path):
    """Runs a case that converges, or ends with `status`: solved_case(text) is its result, open."""

    def call(content, *options, status=0, name="case"):
        run_case(content, "--quiet", *options, status=status, name=name)
        return h5py.File(tmp_path / f"{name}.h5")

    return call


@pytest.fixture
def told_case(run_case, tmp_path):
    """Runs a case: told_case(text) are the contents of its result, and all that is said."""

    def call(content, *options, status=0, name="case"):
        done = run_case(content, "--verbose", *options, status=status, name=name)
        return contents(tmp_path / f"{name}.h5"), done.stderr + done.stdout

    return call


@pytest.fixture
def solved_cases(asperity, tmp_path):
    """Runs cases that converge, in one call: solved_cases(a=text, b=text) are their results a.h5 and b.h5, open."""
    with contextlib.ExitStack() as opened:

        def call(**cases):
            for name, content in cases.items():
                write(tmp_path, f"{name}.nml", content)
            ended(asperity(*(f"{name}.nml" for name in cases), "--quiet"))
            return [opened.enter_context(h5py.File(tmp_path / f"{name}.h5")) for name in cases]

        yield call

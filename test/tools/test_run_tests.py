"""The count at the end of `make test`: a test that exists and did not run is a failure."""

import pathlib
import shutil
import sys

from cases import called

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
UNIT = """module test_a
contains
@test
subroutine one()
end subroutine one
@Test
subroutine two()
end subroutine two
end module test_a
"""
GOOD_UNIT_OUTPUT = "test_a_suite.one\ntest_a_suite.two\n2 passed, 0 failed\n"
PYTHON = "def test_good():\n    assert True\n"


def run(folder, unit_output, python_tests, status=0):
    """A small tree with these test files; returns (exit status, output)."""
    (folder / "tools").mkdir()
    shutil.copy(TOOLS / "run_tests.py", folder / "tools")
    (folder / "test" / "unit" / "base").mkdir(parents=True)
    (folder / "test" / "unit" / "base" / "test_a.pf").write_text(UNIT, encoding="utf-8")
    (folder / "test" / "test_b.py").write_text(python_tests, encoding="utf-8")
    (folder / "pyproject.toml").write_text("", encoding="utf-8")
    unit_command = [sys.executable, "-c", f"print({unit_output!r}, end=''); raise SystemExit({status})"]
    command = [sys.executable, str(folder / "tools" / "run_tests.py"), "asperity", *unit_command]
    result = called(command)
    return result.returncode, result.stdout


def test_all_that_exists_has_passed(tmp_path):
    status, output = run(tmp_path, GOOD_UNIT_OUTPUT, PYTHON)
    assert status == 0
    assert output.splitlines()[-1] == "3 passed, 0 failed"


def test_unit_test_that_did_not_run(tmp_path):
    status, output = run(tmp_path, "test_a_suite.one\n1 passed, 0 failed\n", PYTHON)
    assert status == 1
    assert "unit test did not run: test_a_suite.two" in output
    assert output.splitlines()[-1] == "2 passed, 1 failed"


def test_crash_of_the_unit_tests(tmp_path):
    status, output = run(tmp_path, "test_a_suite.one\n", PYTHON, status=136)
    assert status == 1
    assert output.splitlines()[-1] == "1 passed, 2 failed"


def test_failing_skipped_and_missing_python_tests(tmp_path):
    python_tests = PYTHON + (
        "import pytest\n"
        "def test_bad():\n    assert False\n"
        "def test_skipped():\n    pytest.skip('no time')\n"
        "def test_elsewhere():\n    pytest.skip('not applicable: another system')\n"
        "if False:\n    def test_never():\n        pass\n"
    )
    status, output = run(tmp_path, GOOD_UNIT_OUTPUT, python_tests)
    assert status == 1
    assert "end-to-end test did not run: test_b.test_never" in output
    assert "skipped, which counts as failed: test_skipped: no time" in output
    assert output.splitlines()[-1] == "3 passed, 3 failed"


def test_no_python_tests_at_all(tmp_path):
    status, output = run(tmp_path, GOOD_UNIT_OUTPUT, "")
    assert status == 1
    assert output.splitlines()[-1] == "2 passed, 1 failed"

#!/usr/bin/env python3
"""Run the unit tests and the end-to-end tests, and make sure that every test that exists has run.

    run_tests.py [--paths] PROGRAM UNIT_COMMAND...

PROGRAM is the asperity that the end-to-end tests call; UNIT_COMMAND runs the unit tests (with -v, which names each).
The names of the tests that exist are read from the test files themselves, independently of the tools that run them: a
test that did not run counts as failed, and so does one that is skipped, unless its reason starts with "not applicable".
With --paths only end-to-end tests that are marked `path` run: about one for every path through the program.
The last line is `N passed, N failed`; exit status 0 only if none failed.
"""

import ast
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from concurrent.futures import ThreadPoolExecutor

ROOT = pathlib.Path(__file__).resolve().parent.parent
LOG = ROOT / "build" / "tests"


def unit_tests_that_exist():
    """Names `suite.test` of all @test of the .pf files."""
    names = set()
    for path in [*(ROOT / "test" / "unit").rglob("*.pf"), *(ROOT / "test" / "verification").rglob("*.pf")]:
        text = path.read_text(encoding="utf-8")
        for match in re.finditer(r"^\s*@test\n\s*subroutine\s+(\w+)", text, re.M | re.I):
            names.add(f"{path.stem}_suite.{match[1]}".lower())
    return names


def python_tests_that_exist():
    """Names `file.test` of all test functions of the pytest files."""
    names = set()
    for path in [*(ROOT / "test").rglob("test_*.py"), *(ROOT / "test").rglob("*_test.py")]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                names.add(f"{path.stem}.{node.name}")
    return names


def run_unit_tests(command):
    """Run the unit tests; returns (passed, failed, what failed)."""
    result = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    (LOG / "unit.log").write_text(result.stdout, encoding="utf-8")
    counts = re.search(r"^(\d+) passed, (\d+) failed$", result.stdout, re.M)
    if not counts:
        words = f"{result.stdout[-3000:]}\nunit tests: ended without a count (crash or build error)"
        return 0, max(1, len(unit_tests_that_exist())), words
    passed, failed = int(counts[1]), int(counts[2])
    words = result.stdout[result.stdout.find("\nFailure in ") :] if failed else ""
    ran = {line.strip().lower() for line in result.stdout.splitlines()}
    missing = sorted(unit_tests_that_exist() - ran)
    for name in missing:
        words += f"unit test did not run: {name}\n"
    if result.returncode != 0 and failed == 0:
        words += f"unit tests: exit status {result.returncode}\n"
        failed = 1
    return passed, failed + len(missing), words


def run_python_tests(program, paths_only):
    """Run pytest over all end-to-end tests, or those marked `path`; returns (passed, failed)."""
    report = LOG / "pytest.xml"
    report.unlink(missing_ok=True)
    environment = {**os.environ, "ASPERITY": str(program.resolve()), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, "-m", "pytest", "--tb=short", f"--junitxml={report}", "test"]
    if paths_only:
        command += ["-m", "path"]
    if importlib.util.find_spec("xdist"):
        command += ["--numprocesses", "2", "--dist", "worksteal"]
    status = subprocess.run(command, cwd=ROOT, env=environment, check=False).returncode
    if not report.exists():
        return 0, 1
    passed, failed, ran = 0, 0, set()
    for case in ET.parse(report).iter("testcase"):
        kinds = {child.tag: child.get("message", "") for child in case}
        ran.add(f"{pathlib.Path(case.get('classname', '').replace('.', '/')).name}.{case.get('name', '').split('[')[0]}")
        skipped = kinds.get("skipped")
        if "failure" in kinds or "error" in kinds:
            failed += 1
        elif skipped is not None and not skipped.startswith("not applicable"):
            print(f"skipped, which counts as failed: {case.get('name')}: {skipped}")
            failed += 1
        elif skipped is None:
            passed += 1
    missing = [] if paths_only else sorted(python_tests_that_exist() - ran)
    for name in missing:
        print(f"end-to-end test did not run: {name}")
    failed += len(missing)
    if status != 0 and failed == 0:
        print(f"pytest: exit status {status}")
        failed = 1
    return passed, failed


def main():
    """Run both kinds of tests and print the sum."""
    start = time.monotonic()
    LOG.mkdir(parents=True, exist_ok=True)
    paths_only = sys.argv[1] == "--paths"
    program, *unit_command = sys.argv[2 if paths_only else 1 :]
    with ThreadPoolExecutor() as pool:  # the unit tests take one core
        waiting = pool.submit(run_unit_tests, unit_command)
        python = run_python_tests(pathlib.Path(program), paths_only)
        unit = waiting.result()
    if unit[2]:
        print(unit[2])  # last, where it is seen
    print(f"unit tests: {unit[0]} passed, {unit[1]} failed")
    print(f"end-to-end tests: {python[0]} passed, {python[1]} failed, all tests in {time.monotonic() - start:.0f} s")
    passed, failed = unit[0] + python[0], unit[1] + python[1]
    print(f"{passed} passed, {failed} failed")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())

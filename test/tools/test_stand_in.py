"""The stand-in for pFUnit: wrong tests fail, and what the real pFUnit would drop or refuse is refused with file:line."""

import pathlib
import subprocess
import sys

import pytest
from cases import called, ended

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"

# Fails in `prepare`, before the body of the second test.
BEFORE = """module test_before
use funit
implicit none (type, external)
integer :: counter = 0
contains
@before
subroutine prepare()
counter = counter + 1
@assertLessThan(counter, 2, 'the second time')
end subroutine
@test
subroutine prepared()
@assertEqual(1, counter)
end subroutine
@test
subroutine body_does_not_run()
stop 'the body ran'
end subroutine
end module
"""

PASSING = """
      @assertEqual(1.0_wp, 1.0_wp)
      @assertEqual(1, 1.0_wp)
      @assertEqual(1.0_wp, 1.1_wp, 0.2_wp, 'with a message')
      @assertEqual(1.0_wp, 1.1_wp, tolerance=0.2_wp)
      @assertEqual(1.0_wp, [1.0_wp, 1.0_wp])
      @assertEqual([1.0_wp, 2.0_wp], [1.0_wp, 2.0_wp])
      @assertEqual(0.0_wp, reshape([0.1_wp, 0.2_wp, 0.3_wp, 0.4_wp], [2, 2]), 0.5_wp)
      @assertEqual(0.0_wp, reshape([real(wp) ::], [0, 2]))
      @assertEqual(inf, inf)
      @assertEqual(5, 5_int64)
      @assertEqual([1, 2], [1, 2], message='integers')
      @assertEqual(.true., .true.)
      @assertEqual('abc', '  abc ')
      @assertLessThan(1.0_wp, 2.0_wp)
      @assertLessThan(2.0_wp, 1.9_wp, 0.2_wp)
      @assertLessThan(0.0_wp, [1.0_wp, 2.0_wp])
      @assertLessThanOrEqual(1, 1)
      @assertGreaterThan(3, 2)
      @assertGreaterThanOrEqual(2.0_wp, 2.0_wp)
      @assertRelativelyEqual(100.0_wp, 101.0_wp, 0.02_wp)
      @assertTrue([.true., .true.])
      @assertFalse([.false., .false.])
      @assertIsNaN(nan)
      @assertIsFinite(1.0_wp)
      @assertequal (1, 1)
""".strip().splitlines()

FAILING = """
      @assertEqual(1.0_wp, 1.1_wp)
      @assertEqual(1.0_wp, 1.1_wp, 0.05_wp)
      @assertEqual(nan, nan)
      @assertEqual(0.0_wp, nan, 1.0_wp)
      @assertEqual(inf, -inf)
      @assertEqual(0.0_wp, inf, huge(1.0_wp))
      @assertEqual(-huge(1.0_wp), huge(1.0_wp), huge(1.0_wp))
      @assertEqual([1.0_wp, 2.0_wp], [1.0_wp, 2.1_wp])
      @assertEqual([1.0_wp, 2.0_wp], [1.0_wp, 2.0_wp, 3.0_wp])
      @assertEqual(0.0_wp, reshape([0.0_wp, 0.0_wp, 0.3_wp, 0.0_wp], [2, 2]))
      @assertEqual(5, 6_int64)
      @assertEqual([1, 2], [1, 3])
      @assertEqual(.true., .false.)
      @assertEqual('abc', 'abd')
      @assertLessThan(1.0_wp, 1.0_wp)
      @assertLessThan(nan, 1.0_wp)
      @assertLessThan(1.0_wp, [2.0_wp, 1.0_wp])
      @assertLessThanOrEqual(2, 1)
      @assertGreaterThan(2, 2)
      @assertGreaterThanOrEqual(1.9_wp, 2.0_wp)
      @assertRelativelyEqual(100.0_wp, 103.0_wp, 0.02_wp)
      @assertRelativelyEqual(0.0_wp, 0.0_wp, 1.0_wp)
      @assertRelativelyEqual(1.0_wp, nan, 1.0_wp)
      @assertTrue(.false.)
      @assertTrue([.true., .false.])
      @assertFalse(.true.)
      @assertFalse([.false., .true.])
      @assertIsNaN(1.0_wp)
      @assertIsFinite(inf)
      @assertFail('on purpose')
""".strip().splitlines()


def one_test_each(module, assertions):
    """A .pf file with one test for each assertion."""
    uses = ["use, intrinsic :: ieee_arithmetic", "use, intrinsic :: iso_fortran_env, only: wp => real64, int64", "use funit"]
    lines = [f"module {module}", *uses, "implicit none (type, external)", "contains"]
    for i, assertion in enumerate(assertions):
        lines += ["@test", f"subroutine t{i}()", "real(wp) :: nan, inf"]
        lines += ["nan = ieee_value(nan, ieee_quiet_nan)", "inf = ieee_value(inf, ieee_positive_inf)"]
        lines += [assertion, f"end subroutine t{i}"]
    return "\n".join([*lines, f"end module {module}"]) + "\n"


def translate(folder, **files):
    """Translate files given as name=text; the result of the translator."""
    paths = []
    for name, text in files.items():
        path = folder / f"{name}.pf"
        path.write_text(text, encoding="utf-8")
        paths.append(str(path))
    command = [sys.executable, str(TOOLS / "pf2f90.py"), str(folder / "out"), *paths]
    return called(command)


@pytest.fixture(scope="session")
def runtime(tmp_path_factory):
    """Folder with the compiled run-time of the stand-in."""
    folder = tmp_path_factory.mktemp("runtime")
    assert translate(folder, test_any=one_test_each("test_any", ["@assertTrue(.true.)"])).returncode == 0
    compile_files(folder / "out", "funit_lite.f90", "funit.f90")
    return folder / "out"


def compile_files(folder, *names, extra=()):
    """Compile with the traps of the checked build."""
    flags = ["-std=f2018", "-g", "-Werror=line-truncation", "-fcheck=all", "-ffpe-trap=invalid,zero,overflow", "-finit-real=snan"]
    subprocess.run(["gfortran", *flags, *extra, "-c", *names], cwd=folder, check=True)


@pytest.fixture
def run(tmp_path, runtime):
    """Translates, compiles and runs .pf files given as name=text; options of the test program come first."""

    def call(*options, **files):
        ended(translate(tmp_path, **files))
        out = tmp_path / "out"
        (out / "unit.f90").write_text("program unit\nuse pf_suites\ncall run_suites()\nend program\n", encoding="utf-8")
        names = [*[f"{name}.f90" for name in files], "pf_suites.f90", "unit.f90"]
        compile_files(out, *names, extra=[f"-I{runtime}"])
        objects = [str(runtime / name) for name in ("funit_lite.o", "funit.o")] + [f"{name[:-4]}.o" for name in names]
        subprocess.run(["gfortran", *objects, "-o", "unit"], cwd=out, check=True)
        return called([str(out / "unit"), *options])

    return call


def failed_tests(result):
    return [line.split(".")[-1] for line in result.stdout.splitlines() if line.startswith("Failure in ")]


def module(body, name="test_x"):
    return f"module {name}\nuse funit\nimplicit none (type, external)\ncontains\n{body}\nend module {name}\n"


def test_good_assertions_pass_and_bad_ones_fail(run):
    result = run(test_good=one_test_each("test_good", PASSING), test_bad=one_test_each("test_bad", FAILING))
    assert failed_tests(result) == [f"t{i}" for i in range(len(FAILING))]
    assert result.stdout.splitlines()[-1] == f"{len(PASSING)} passed, {len(FAILING)} failed"
    assert result.returncode == 1
    assert "[test_bad.pf:12]" in result.stdout
    assert "Arrays not conformable" in result.stdout
    assert "found 2.9999999999999999E-001 at (1,2)" in result.stdout


def test_all_passing_exits_0_and_a_filter_without_match_2(run):
    files = {"test_x": module("@test\nsubroutine good()\n@assertTrue(.true.)\nend subroutine")}
    assert ended(run(**files)).stdout.endswith("1 passed, 0 failed\n")
    assert ended(run("-f", "nothing_like_this", **files), 2).stdout.endswith("0 passed, 0 failed\n")
    assert "test_x_suite.good" in run("-v", "-f", "go", **files).stdout


def test_helper_returns_from_itself_only(run):
    body = "@test\nsubroutine two()\ncall helper()\n@assertEqual(3, 4)\nend subroutine\n"
    body += "subroutine helper()\n@assertEqual(1, 2)\n@assertEqual(5, 6)\nend subroutine"
    result = run(test_x=module(body))
    assert "expected 1, found 2" in result.stdout
    assert "expected 3, found 4" in result.stdout
    assert "expected 5" not in result.stdout
    assert result.stdout.endswith("0 passed, 1 failed\n")


def test_before_runs_before_each_test(run):
    result = run(test_before=BEFORE)
    assert failed_tests(result) == ["body_does_not_run"]
    assert "the second time" in result.stdout
    assert result.stdout.endswith("1 passed, 1 failed\n")


def test_long_line_and_strings_survive(run):
    message = "it''s @ " + "long " * 18
    ended(run(test_x=module(f"@test\nsubroutine long()\n@assertEqual(max(1, 2), 2, '{message}, (')\nend subroutine")))


def test_modules_that_tests_share_are_copied(run, tmp_path):
    shared = "module answers\nimplicit none (type, external)\ninteger, parameter :: answer = 42\nend module answers\n"
    text = module("@test\nsubroutine a()\nuse answers, only: answer\n@assertEqual(42, answer)\nend subroutine")
    assert run(answers=shared, test_x=text).returncode == 0
    for wrong in (shared.replace("implicit", "@test\nimplicit"), shared.replace("module answers", "module other")):
        assert "answers.pf:" in ended(translate(tmp_path, answers=wrong, test_x=text), 1).stderr


REFUSED = {
    "continuation": ("@assertEqual(1, &\n1)", 6, "no '&'"),
    "trailing comment": ("@assertEqual(1, 1) ! comment", 6, "trailing comment"),
    "semicolon": ("@assertEqual(1, 1); x = 1", 6, "';'"),
    "blank behind the sign": ("@ assertEqual(1, 1)", 6, "alone on its line"),
    "inside an if": ("if (x) @assertEqual(1, 1)", 6, "alone on its line"),
    "something behind": ("@assertEqual(1, 1) (2)", 6, "nothing may follow"),
    "open parenthesis": ("@assertEqual(1, (1)", 6, "do not balance"),
    "too few arguments": ("@assertEqual(1)", 6, "takes 2 to 4"),
    "relative without tolerance": ("@assertRelativelyEqual(1.0, 1.0)", 6, "takes 3 to 4"),
    "whitespace keyword": ("@assertEqual('a', 'a', whitespace=KEEP_ALL)", 6, "'whitespace'"),
    "not in the subset": ("@assertThat(x, is(1))", 6, "@assertThat is not in the subset"),
    "not exported by pFUnit": ("@assertIsInfinite(x)", 6, "@assertIsInfinite is not in the subset"),
    "preprocessor": ("#ifdef X", 6, "preprocessor"),
}


@pytest.mark.parametrize(("text", "line", "reason"), REFUSED.values(), ids=REFUSED)
def test_refused_inside_a_test(tmp_path, text, line, reason):
    result = ended(translate(tmp_path, test_x=module(f"@test\nsubroutine a()\n{text}\nend subroutine")), 1)
    assert f"test_x.pf:{line + 1}: " in result.stderr
    assert reason in result.stderr


PLAIN = "subroutine b()\nend subroutine\n"
STRUCTURE = {
    "recursive test": ("@test\nrecursive subroutine a()\nend subroutine", "without prefix"),
    "bind(c) test": ("@test\nsubroutine a() bind(c)\nend subroutine", "without prefix, argument, bind"),
    "test without subroutine": ("@test\n\nsubroutine a()\nend subroutine", "the line after @test"),
    "function": ("@test\nfunction a()\nend function", "the line after @test"),
    "test at the end": ("subroutine a()\nend subroutine\n@test", "the line after @test"),
    "two annotations": ("@before\n@test\nsubroutine a()\nend subroutine", "@before must be followed"),
    "ifdef": (f"@test(ifdef=X)\n{PLAIN}", "@test does not take"),
    "comment behind the subroutine": ("@test\nsubroutine a() ! comment\nend subroutine", "comment"),
    "no test": (PLAIN, "no @test in this file"),
    "two of one name": ("@test\nsubroutine a()\nend subroutine\n@test\nsubroutine A()\nend subroutine", "two tests are called"),
    "long name": (f"@test\nsubroutine {'a' * 45}()\nend subroutine", "at most 44"),
    "argument": ("@test\nsubroutine a(this)\nend subroutine", "without prefix, argument"),
    "suite": (f"@suite(name='x')\n{PLAIN}", "@suite is not in the subset"),
    "after": (f"@after\n{PLAIN}", "@after is not in the subset"),
}


@pytest.mark.parametrize(("text", "reason"), STRUCTURE.values(), ids=STRUCTURE)
def test_refused_structure(tmp_path, text, reason):
    result = ended(translate(tmp_path, test_x=module(text)), 1)
    assert "test_x.pf:" in result.stderr
    assert reason in result.stderr
    assert not (tmp_path / "out").exists()


def test_refused_module_of_another_name(tmp_path):
    assert "must be called test_x" in ended(translate(tmp_path, test_x=module(f"@test\n{PLAIN}", name="test_y")), 1).stderr


def test_stale_translations_disappear(tmp_path):
    assert translate(tmp_path, test_x=module(f"@test\n{PLAIN}"), test_y=module(f"@test\n{PLAIN}", name="test_y")).returncode == 0
    assert (tmp_path / "out" / "test_y.f90").exists()
    assert translate(tmp_path, test_x=module(f"@test\n{PLAIN}")).returncode == 0
    assert not (tmp_path / "out" / "test_y.f90").exists()

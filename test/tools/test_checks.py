"""The checks of `make lint` find planted mistakes; a test that exists and did not run is a failure; blocks of bench/page.py."""

import pathlib
import shutil
import subprocess
import sys

import page
import pytest
from cases import called

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"


def check(tool, folder, **sources):
    """Run a checker over sources given as layer__module=text; returns (exit status, output)."""
    for name, text in sources.items():
        layer, module = name.split("__")
        path = folder / "src" / layer / f"{module}.f90"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    result = called([sys.executable, str(TOOLS / tool), str(folder)])
    return result.returncode, result.stdout


def test_layers_may_be_used_from_the_right_only(tmp_path):
    good = {"base__kinds": "module kinds\nend module\n", "hdf5__files": "module files\nuse kinds, only: wp\nend module\n"}
    assert check("check_layers.py", tmp_path, **good) == (0, "")
    status, output = check(
        "check_layers.py",
        tmp_path,
        film__film="module film\nuse files, only: x\nend module\n",
        physics__laws="module laws\nuse, intrinsic :: iso_c_binding\nend module\n",
        dry__area="module area\nuse film, only: x\nend module\n",
        numerics__fft="module transform\nuse laws, only: x\nend module\n",
        other__thing="module thing\nend module\n",
    )
    assert status == 1
    found = sorted(line.split("src/")[1] for line in output.splitlines())
    places = ["dry/area.f90:2", "film/film.f90:2", "numerics/fft.f90:1", "numerics/fft.f90:2", "other/thing.f90:1"]
    assert [":".join(line.split(":")[:2]) for line in found] == places


def test_a_chain_of_modules_is_bounded():
    tool = [sys.executable, str(TOOLS / "use_graph.py")]
    told = subprocess.run(tool, capture_output=True, text=True, check=True).stdout.splitlines()
    depth = int(told[0].split()[-1])
    assert len(told) == depth + 1
    assert subprocess.run([*tool, "--most", str(depth)], check=False).returncode == 0
    assert subprocess.run([*tool, "--most", str(depth - 1)], capture_output=True, check=False).returncode == 1


def test_no_sources_is_a_finding(tmp_path):
    for tool in ("check_layers.py", "check_errors.py", "check_cases.py", "check_reads.py", "check_public.py"):
        assert check(tool, tmp_path)[0] == 1


LAW = """module laws
contains
subroutine stress(law, tau)
   select case (law)
   case (newtonian, {name})
      tau = 1
{default}
   end select
end subroutine
end module
"""


def test_no_law_passes_for_another(tmp_path):
    good = {
        "stops": ("eyring", "case default\n error stop 'no case'"),
        "others": ("eyring", "case default  ! all others\n tau = 2"),
    }
    good["literal"] = ("2", "case default\n tau = 2")
    sources = {f"film__{name}": LAW.format(name=case, default=default) for name, (case, default) in good.items()}
    assert check("check_cases.py", tmp_path, **sources) == (0, "")
    bad = {"film__none": LAW.format(name="eyring", default=""), "film__law": LAW.format(name="a", default="case default\n tau = 2")}
    status, output = check("check_cases.py", tmp_path, **bad)
    assert status == 1
    assert [line.split("film/")[1].split(": ")[0] for line in output.splitlines()] == ["law.f90:4", "none.f90:4"]


GOOD_CALLS = """module good
contains
subroutine a(x, error)
type(error_t), allocatable, intent(out) :: error
call first(x, &
   error) ! comment
if (allocated(error)) return
if (x > 0) then
   call second(x, error=error)
else
   call third(x, error)
   if (x > 1 .and. allocated(error)) return
   call fourth(error)
end if
end subroutine a
subroutine b(error)
type(error_t), allocatable, intent(out) :: error
call fifth(error) ! error: does not matter here
x = 1
end subroutine b
end module good
"""

BAD_CALLS = """module bad
contains
subroutine a(x, error)
type(error_t), allocatable, intent(out) :: error
type(error_t), allocatable :: close_error
call first(x, error)
x = 1
if (x > 0) then
   call second(x, error)
else
   call third(x, close_error)
end if
call self%fourth(x, 'a ! b', error)
call fifth(x, error)
if (allocated(error)) return
if (x > 0) call sixth(x, &
   & error)
call message('error')
end subroutine a
end module bad
"""


def test_calls_whose_error_nobody_looks_at_are_found(tmp_path):
    assert check("check_errors.py", tmp_path, base__good=GOOD_CALLS) == (0, "")
    status, output = check("check_errors.py", tmp_path, base__bad=BAD_CALLS)
    assert status == 1
    assert [int(line.split(":")[1]) for line in output.splitlines()] == [6, 9, 11, 13, 16]


def test_list_directed_reads_are_found(tmp_path):
    good = "read (text, '(f70.0)') x\nread (unit) y*z\nread (unit, '(a)') a(1, *)\nx = read_real(2*3)\nend\n"
    assert check("check_reads.py", tmp_path, base__good=good) == (0, "")
    bad = "read (text(2:n), *, iostat=status) x\nread (unit=u, fmt=*) x\nread *, x\nread (text, &\n   *) x\nend\n"
    status, output = check("check_reads.py", tmp_path, base__bad=bad)
    assert status == 1
    assert [line.split(":")[1] for line in output.splitlines()] == ["1", "2", "3", "4"]


def test_public_names_have_a_user(tmp_path):
    kinds = """module kinds
private
public :: used, lonely
integer, parameter, public :: wp = 8, other = max(1, 2), spare = 3
type, public :: pair_t
end type
contains
"""
    laws = "module laws\nuse kinds, only: wp, other, used\n! lonely, spare\nend module\n"
    status, output = check("check_public.py", tmp_path, base__kinds=kinds, physics__laws=laws)
    assert status == 1
    assert [line.split("base/")[1].split(" is")[0] for line in output.splitlines()] == ["kinds.f90:3: lonely", "kinds.f90:4: spare"]
    assert check("check_public.py", tmp_path, physics__laws=laws.replace("! lonely", "x = lonely"))[0] == 0


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
UNIT_ALONE = "test_a_suite.one\n1 passed, 0 failed\n"
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


COUNTS = {
    "all passed": (GOOD_UNIT_OUTPUT, PYTHON, 0, "", "3 passed, 0 failed"),
    "one missing": (UNIT_ALONE, PYTHON, 0, "unit test did not run: test_a_suite.two", "2 passed, 1 failed"),
    "unit tests crashed": ("test_a_suite.one\n", PYTHON, 136, "", "1 passed, 2 failed"),
    "no Python tests": (GOOD_UNIT_OUTPUT, "", 0, "", "2 passed, 1 failed"),
}


@pytest.mark.parametrize(("unit_output", "python", "status", "words", "last"), COUNTS.values(), ids=COUNTS)
def test_counts_of_what_exists(tmp_path, unit_output, python, status, words, last):
    ended_with, output = run(tmp_path, unit_output, python, status)
    assert ended_with == (", 0 failed" not in last)
    assert words in output
    assert output.splitlines()[-1] == last


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


PAGE_TEXT = "before\n<!-- dry: written by bench/page.py -->\nold\n<!-- dry: end -->\nafter\n"


def test_only_the_block_changes():
    assert page.with_block(PAGE_TEXT, "dry", "new\n") == PAGE_TEXT.replace("old", "new")
    assert page.with_block(page.with_block(PAGE_TEXT, "dry", "new\n"), "dry", "old\n") == PAGE_TEXT


@pytest.mark.parametrize(
    "text", [PAGE_TEXT.replace("dry: end", "end"), PAGE_TEXT * 2, "nothing\n", "\n".join(reversed(PAGE_TEXT.splitlines()))]
)
def test_a_page_without_the_block_is_refused(text):
    with pytest.raises(ValueError, match="expected one block between <!-- dry: written"):
        page.with_block(text, "dry", "new\n")


@pytest.mark.parametrize("name", page.BLOCKS)
def test_the_page_has_every_block(name):
    text = page.PAGE.read_text(encoding="utf-8")
    assert page.with_block(text, name, "new\n").count("new\n") == text.count("new\n") + 1


def test_long_lines_are_folded_with_their_indent():
    lines = page.fenced("  " + "word " * 40).splitlines()
    assert lines[0] == "```text"
    assert max(map(len, lines)) <= 128
    assert lines[2].startswith("      word")

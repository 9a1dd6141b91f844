"""The checks of `make lint`: planted mistakes are found, good code passes."""

import pathlib
import subprocess
import sys

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
    assert [line.split(":")[0:2] for line in found] == [
        ["dry/area.f90", "2"],
        ["film/film.f90", "2"],
        ["numerics/fft.f90", "1"],
        ["numerics/fft.f90", "2"],
        ["other/thing.f90", "1"],
    ]


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

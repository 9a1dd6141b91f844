"""A transient of many steps needs no more memory than one of few. The long form is long_run.py."""

from cases import write
from kill_and_resume import killed_at_last
from long_run import check_part, finish, follow, long_case


def test_memory_does_not_grow_with_the_steps(program, tmp_path):
    write(tmp_path, "case.nml", long_case(100000, 64))
    with killed_at_last(program, tmp_path) as running:
        first, last = follow(running, tmp_path / "case.h5.part", [1000, 4000])
    # what grows is the residual history: 16 bytes a cycle, doubled when full
    assert last - first < 1.5
    assert last < 60
    assert check_part(tmp_path / "case.h5.part") > 4000


def test_long_run_ends_in_little_memory(program, tmp_path):
    write(tmp_path, "case.nml", long_case(6000, 64))
    with killed_at_last(program, tmp_path) as running:
        (before,) = follow(running, tmp_path / "case.h5.part", [1000])
    assert finish(program, tmp_path) < before + 8

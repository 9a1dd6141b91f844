"""batch/sweep.py --replace that is ended at any step: the old or the new sweep is there, whole, and no result is lost."""

import errno
import os
import pathlib
import shutil
import signal

import pytest
from case_folder import INDEX, REPLACEMENT, SWEEP, opened, read_folder
from cases import BASE, call, ended, write_sweep
from sweep import publish
from sweep_file import SweepError

HEAD = 'base = "base.nml"\n[vary]\nload.hertz_pressure = '
STEPS = {name: getattr(pathlib.Path, name) for name in ("mkdir", "rename", "replace", "rmdir", "unlink")}


@pytest.fixture(scope="module", name="sweeps")
def _sweeps(tmp_path_factory, program):
    """A sweep of five cases and its successor of four, of which one is as before, two are others and one has gone twice."""
    folder = tmp_path_factory.mktemp("sweeps")
    for name, values in (("old", "[4e8, 5e8, 6e8, 7e8, 8e8]"), ("new", "[4e8, 5.5e8, 6.5e8]")):
        write_sweep(folder, f"{HEAD}{values}\n", BASE, f"{name}.toml")
        ended(call("sweep.py", f"{name}.toml", folder=folder, program=program))
    for i in range(1, 6):
        (folder / "old" / "cases" / f"case_{i:04d}.h5").write_text(f"result {i}", encoding="utf-8")
    return folder


@pytest.fixture(name="places")
def _places(sweeps, tmp_path):
    """Makes a copy of the old folder and of the new one as it is written before it is moved."""

    def make(name):
        return shutil.copytree(sweeps / "new", tmp_path / f"{name}.part"), shutil.copytree(sweeps / "old", tmp_path / name)

    return make


def content(folder):
    files = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".h5")
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def results(folder):
    return {path.name: path.read_text(encoding="utf-8") for path in (folder / "cases").glob("*.h5")}


def failing(monkeypatch, step, kind):
    """The file operations, of which number `step` ends; returns the list of those that were called."""
    called = []
    for name, step_of in STEPS.items():

        def operation(self, *arguments, name=name, step_of=step_of, **options):
            called.append(name)
            if len(called) == step:
                end(kind, self)
            return step_of(self, *arguments, **options)

        monkeypatch.setattr(pathlib.Path, name, operation)
    return called


def end(kind, path):
    if kind == "full disk":
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), path)
    if kind == "interrupted":
        raise KeyboardInterrupt
    os.kill(os.getpid(), signal.SIGKILL)


def in_a_child(work):
    """Whether `work`, in a process of its own, was ended before its end."""
    child = os.fork()
    if child == 0:
        try:
            work()
            os._exit(0)
        finally:
            os._exit(1)
    return os.waitpid(child, 0)[1] != 0


@pytest.mark.parametrize("kind", ["full disk", "interrupted", "killed"])
def test_the_old_or_the_new_sweep_survives_at_every_step(sweeps, places, monkeypatch, kind):
    old, new, kept = content(sweeps / "old"), content(sweeps / "new"), results(sweeps / "old")
    seen = set()
    for step in range(1, 100):
        part, folder = places(f"small{step}")
        with monkeypatch.context() as patch:

            def replace(patch=patch, part=part, folder=folder, step=step):
                failing(patch, step, kind)
                publish(part, folder, True)

            was_ended = in_a_child(replace)
        found = content(folder)
        assert found[INDEX] in (old[INDEX], new[INDEX])
        assert results(folder) == kept
        is_pending = (folder / REPLACEMENT / INDEX).exists()
        if not is_pending:
            assert found == (old if found[INDEX] == old[INDEX] else new)
        seen.add((is_pending, found[INDEX] == new[INDEX]))
        shutil.rmtree(part, ignore_errors=True)
        with opened(folder) as read:
            assert len(read.names) == (5 if found[INDEX] == old[INDEX] and not is_pending else 3)
        publish(shutil.copytree(sweeps / "new", part), folder, True)
        assert content(folder) == new
        assert results(folder) == kept
        assert not (folder / REPLACEMENT).exists()
        if not was_ended:
            break
    assert seen == {(False, False), (True, False), (False, True)}
    assert step > 8


def test_what_an_earlier_version_left_without_index_is_completed(batch, sweeps, places, tmp_path):
    """It removed the index first, then cases that had gone, then moved the others one by one, and left SMALL.part when killed."""
    new, kept = content(sweeps / "new"), results(sweeps / "old")
    for step in range(6):
        part, folder = places("new")
        (folder / INDEX).unlink()
        for name in ("case_0004", "case_0005")[:step]:
            (folder / "cases" / f"{name}.nml").unlink()
        for name in ("case_0002", "case_0003")[: max(0, step - 2)]:
            (part / "cases" / f"{name}.nml").replace(folder / "cases" / f"{name}.nml")
        if step == 5:
            (part / SWEEP).replace(folder / SWEEP)
        with pytest.raises(SweepError, match="--replace writes it, results stay"):
            read_folder(folder)
        write_sweep(tmp_path, (sweeps / "new.toml").read_text(encoding="utf-8"), BASE, "new.toml")
        if step == 0:
            assert "or --replace" in batch("sweep.py", "new.toml", status=1).stderr
            assert results(folder) == kept
        batch("sweep.py", "new.toml", "--replace")
        assert new.items() <= content(folder).items()
        assert results(folder) == kept
        assert not part.exists()
        shutil.rmtree(folder)


@pytest.mark.parametrize("name", ["cases/case_0003.nml", "cases/case_0005.nml", SWEEP])
def test_a_name_that_cannot_be_replaced_is_told_before_anything_changes(sweeps, places, name):
    part, folder = places("small")
    (folder / name).unlink()
    (folder / name).mkdir()
    before = content(folder)
    with pytest.raises(IsADirectoryError) as error:
        publish(part, folder, True)
    assert error.value.filename == folder / name
    assert (content(folder), results(folder)) == (before, results(sweeps / "old"))


def test_run_and_gather_complete_a_replacement(batch, sweeps, places):
    part, folder = places("small")
    part.rename(folder / REPLACEMENT)
    batch("gather.py", "small")
    assert content(sweeps / "new").items() <= content(folder).items()
    assert not (folder / REPLACEMENT).exists()


def test_a_folder_of_the_user_beside_the_sweep_is_left_alone(batch, sweeps, tmp_path):
    shutil.copy(sweeps / "base.nml", tmp_path)
    shutil.copy(sweeps / "new.toml", tmp_path)
    (tmp_path / "new.part").mkdir()
    (tmp_path / "new.part" / "thesis.txt").write_text("mine", encoding="utf-8")
    assert "found thesis.txt" in batch("sweep.py", "new.toml", status=1).stderr
    assert (tmp_path / "new.part" / "thesis.txt").read_text(encoding="utf-8") == "mine"

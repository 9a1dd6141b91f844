"""The scenes of input/scenes/: they pass the check, run, converge, and get the verdicts that docs/scenes.md shows."""

import pathlib
import re
import shutil

import h5py
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = sorted((ROOT / "input" / "scenes").glob("*.nml"))
NUMERICAL = {"grid", "time_step", "domain", "iteration", "validity"}


def verdicts_on_the_page():
    """{scene: {ingredient: verdict}} of docs/scenes.md."""
    found = {}
    for part in (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8").split("\n## ")[2:]:
        name = re.search(r"\(\.\./input/scenes/(\w+)\.nml\)", part)[1]
        rows = re.findall(r"^\| (\w+) \| ([\w ]+?)(?: \*\*\(other\)\*\*)? \| ", part, re.M)
        found[name] = {ingredient: verdict for ingredient, verdict in rows if ingredient != "without"}
    return found


def test_every_scene_is_on_the_page():
    """Ten scenes, each with a namelist and a section."""
    assert sorted(verdicts_on_the_page()) == [path.stem for path in SCENES]
    assert len(SCENES) == 10


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene_gets_the_verdicts_of_the_page(asperity, tmp_path, path):
    """--check finds nothing, the scene converges, and its verdicts are those shown."""
    shutil.copy(path, tmp_path)
    done = asperity("--check", path.name)
    assert (done.returncode, done.stderr) == (0, "")
    assert asperity(path.name, "--quiet").returncode == 0
    with h5py.File(tmp_path / f"{path.stem}.h5") as file:
        assert file.attrs["converged"] == 1
        said = {name: row.attrs["verdict"].decode() for name, row in file["adequacy"].items() if name not in NUMERICAL}
    assert said == verdicts_on_the_page()[path.stem]

"""The scenes of input/scenes/: they pass the check, run, converge, and get the verdicts that fine grids give (`make scenes`)."""

import pathlib
import shutil

import h5py
import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = sorted((ROOT / "input" / "scenes").glob("*.nml"))
NUMERICAL = {"grid", "time_step", "domain", "iteration", "validity"}
# Ingredients of each scene by verdict; bench/scenes.py compares them with those of fine grids.
OIL = "compressibility elasticity piezoviscosity roelands shear_thinning"
VERDICTS = {
    "01_journal_bearing": {"irrelevant": "compressibility roelands", "matters below the accuracy": "elasticity piezoviscosity"},
    "02_rubber_seal": {
        **{"irrelevant": "compressibility roelands", "needed": "elasticity"},
        **{"matters below the accuracy": "piezoviscosity"},
    },
    **{name: {"needed": OIL} for name in ("03_roller_bearing", "04_gear_tooth", "05_traction_rig")},
    **{name: {"needed": f"{OIL} roughness squeeze"} for name in ("06_ridge_passage", "07_waviness", "08_rough_in_oil")},
    "09_dry_machined": {"needed": "harmonics plasticity"},
    "10_run_in": {"needed": "harmonics", "irrelevant": "plasticity"},
}


def test_every_scene_has_its_verdicts():
    """Ten scenes."""
    assert sorted(VERDICTS) == [path.stem for path in SCENES]
    assert len(SCENES) == 10


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene_gets_its_verdicts(asperity, tmp_path, path):
    """--check finds nothing, the scene converges, and its verdicts are those of the table."""
    shutil.copy(path, tmp_path)
    done = asperity("--check", path.name)
    assert (done.returncode, done.stderr) == (0, "")
    done = asperity(path.name, "--quiet")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / f"{path.stem}.h5") as file:
        assert file.attrs["converged"] == 1
        said = {name: row.attrs["verdict"].decode() for name, row in file["adequacy"].items() if name not in NUMERICAL}
    assert said == {name: verdict for verdict, names in VERDICTS[path.stem].items() for name in names.split()}

"""A wanted accuracy in time: a result whose own coarse runs show a larger error says so."""

import random
import sys
from pathlib import Path

import h5py

sys.path.append(str(Path(__file__).resolve().parent.parent / "bench"))

import family_target_in_time

COUNT = 10


def test_an_error_above_the_target_is_noted(asperity, tmp_path):
    """Passages at random, the domain given: there is a note where grid and time step err by more than wanted, else none."""
    (family,) = family_target_in_time.FAMILIES
    noted = []
    for member in family.draw(random.Random(7002), COUNT):
        (tmp_path / "case.nml").write_text(member.case, encoding="utf-8")
        done = asperity("case.nml")
        assert done.returncode == 0, done.stderr
        target = float(member.case.split("target = ")[1].split()[0])
        with h5py.File(tmp_path / "case.h5") as file:
            film = file["summary/h_min"]
            note = file["report/note"].asstr()[()] if "report/note" in file else ""
            is_above = film.attrs["error_grid"] > target * film[()]
        assert ("the wanted accuracy is not shown" in note) == is_above, member.name
        assert ("the wanted accuracy is not shown" in done.stderr) == is_above, member.name
        noted.append(is_above)
    assert any(noted)
    assert not all(noted)

"""/adequacy of lubricated results: what each ingredient changes, in the file, in the closing table and switched off."""

import h5py
import numpy as np
import pytest
from cases import STEADY, TRANSIENT, contents, write
from conftest import ROOT

OFF = "&output adequacy = .false. /\n"
INGREDIENTS = {"compressibility", "elasticity", "piezoviscosity", "roelands", "shear_thinning"}
NUMERICAL = {"grid", "domain", "iteration"}
CASE_1 = STEADY.replace("256", "1024")


def verdict(group):
    return group.attrs["verdict"].decode()


@pytest.mark.path
def test_every_ingredient_has_changes_and_a_verdict(asperity, tmp_path):
    write(tmp_path, "case.nml", CASE_1)
    assert "  model     at 4.4 % nothing simpler will do\n" in asperity("case.nml").stdout
    done = asperity("case.nml", "--verbose")
    assert "model     needed at" in done.stdout
    assert "elasticity" in done.stdout
    with h5py.File(tmp_path / "case.h5") as file:
        group = file["adequacy"]
        assert set(group) - {"validity"} == INGREDIENTS | NUMERICAL
        assert group.attrs["accuracy"] >= 0.01
        for name in INGREDIENTS:
            for quantity in ("h_min", "h_central"):
                change = group[name][quantity]
                assert 0 < change.attrs["error_estimate"] < 0.1
                assert abs(change[()]) < 1
        # films of constant density are thicker, of constant viscosity thinner, of Newtonian oil thicker
        assert group["compressibility/h_central"][()] > 0.1
        assert group["piezoviscosity/h_min"][()] < -0.5
        assert group["shear_thinning/h_min"][()] > 0.05
        assert {verdict(group[name]) for name in ("piezoviscosity", "compressibility", "elasticity")} == {"needed"}
        film = file["summary/h_min"]
        for name in NUMERICAL:
            share = film.attrs[f"error_{name}"] / film[()]
            assert group[name]["h_min"][()] == pytest.approx(share, rel=1e-12)


@pytest.mark.path
def test_passage_tells_of_roughness_and_squeeze(solved_case):
    with solved_case(TRANSIENT.replace("time_step = 0.05", "time_step = 0.02")) as file:
        group = file["adequacy"]
        assert {"roughness", "squeeze"} <= set(group)
        # without its ridge the passage is the smooth steady contact that it starts from
        smooth = file["transient/h_min"][0] / np.min(file["transient/h_min"]) - 1
        change = group["roughness/h_min"]
        assert smooth > 0.01
        assert abs(change[()] - smooth) <= change.attrs["error_estimate"]
        for name in ("piezoviscosity", "elasticity"):
            assert group[name].attrs["measured_on"].decode().startswith("the smooth steady contact")


TWO_RIDGES = """&surface_2 shape = 'feature', amplitude = 4e-9, 2e-9, wavelength = 1.5e-4, 1.5e-4, position = -2.5, -3.5 /
&time transient = .true., end_time = {end}, time_step = {step} /
"""
FULL = "&output adequacy = 'full' /\n"
BARE = OFF + "&accuracy error_bars = .false. /\n"


def films(path):
    with h5py.File(path) as file:
        return {name: file[f"summary/{name}"][()] for name in ("h_min", "h_central")}


def test_single_ridges_and_the_time_step(asperity, tmp_path):
    """Each of two low ridges, and the time step, beside runs without the ridge and with a quarter of the step."""
    case = CASE_1.replace("1024", "512")
    step = 5.5 / 512
    both = TWO_RIDGES.format(end=4.0, step=step)
    write(tmp_path, "both.nml", case + both + FULL)
    write(tmp_path, "usual.nml", case + both)
    for name, height, place in (("one", "2e-9", "-3.5"), ("two", "4e-9", "-2.5")):
        ridges = both.replace("4e-9, 2e-9", height).replace("1.5e-4, 1.5e-4", "1.5e-4").replace("-2.5, -3.5", place)
        write(tmp_path, f"{name}.nml", case + ridges + BARE)
    write(tmp_path, "slow.nml", case + TWO_RIDGES.format(end=4.0, step=step / 4) + BARE)
    assert asperity("usual.nml", "one.nml", "two.nml", "slow.nml", "--quiet").returncode == 0
    assert "adequacy = 'full' takes up to 2.2 times" in asperity("both.nml").stderr
    with h5py.File(tmp_path / "usual.h5") as file:
        for name in ("feature_2_1", "feature_2_2"):
            assert verdict(file[f"adequacy/{name}"]) == "not known"
            assert "adequacy = 'full'" in file[f"adequacy/{name}"].attrs["not_known"].decode()
    full = films(tmp_path / "both.h5")
    with h5py.File(tmp_path / "both.h5") as file:
        group = file["adequacy"]
        for name, lean in (("feature_2_1", "one"), ("feature_2_2", "two")):
            assert verdict(group[name]) != "not known"
            for quantity, value in films(tmp_path / f"{lean}.h5").items():
                change = group[name][quantity]
                assert abs(change[()] - (value / full[quantity] - 1)) <= change.attrs["error_estimate"]
        row = group["time_step"]
        assert verdict(row) in ("irrelevant", "matters below the accuracy")
        for quantity, value in films(tmp_path / "slow.h5").items():
            assert abs(full[quantity] / value - 1) <= row[quantity][()] <= group["grid"][quantity][()]


@pytest.mark.parametrize("words", ["time_step = 0.02, scheme = 'backward_euler'", "scheme = 'bdf2'", "scheme = 'backward_euler'"])
def test_time_step_of_other_runs(solved_case, words):
    """Of first order by the scheme of second order, with a target too."""
    case = TRANSIENT.replace("time_step = 0.05", words)
    if "time_step" not in words:
        case = case.replace(", intervals = 256", "").replace("end_time = 1.0", "end_time = 2.5") + "&accuracy target = 0.05 /\n"
    with solved_case(case) as file:
        row, grid = file["adequacy/time_step"], file["adequacy/grid"]
        assert 0 < row["h_min"][()] <= grid["h_min"][()]
        assert row["h_min"].attrs["error_estimate"] == 0
        assert "h_min" in file["adequacy/roughness"]


def test_what_is_not_known_says_why(asperity, tmp_path, run_case):
    # A dent that overtakes a ridge: the smooth steady contact tells the friction of some oils alone; no number is a NaN.
    assert asperity(ROOT / "input" / "overtaking.nml", "--output", tmp_path, "--quiet").returncode == 0
    found = contents(tmp_path / "overtaking.h5")
    names = {name.split("/")[1].split("@")[0] for name in found if name.startswith("adequacy/")} - {"validity"}
    partly = 0
    for name in names:
        group = {key: value for key, value in found.items() if key.startswith((f"adequacy/{name}/", f"adequacy/{name}@"))}
        assert all(np.all(np.isfinite(value)) for value in group.values() if not isinstance(value, bytes)), name
        untold = [q for q in ("h_min", "h_central", "p_max", "friction_coefficient") if f"adequacy/{name}/{q}" not in group]
        why = group.get(f"adequacy/{name}@not_known", b"").decode()
        assert not untold or why.startswith(", ".join(untold) + ": ")
        assert (why != "") == bool(untold or group[f"adequacy/{name}@verdict"] == b"not known")
        partly += 0 < len(untold) < 4
    assert partly >= 1
    run_case(STEADY + "&solver max_cycles = 1 /\n", status=2)
    with h5py.File(tmp_path / "case.h5") as file:
        assert "adequacy" not in file

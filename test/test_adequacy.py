"""/adequacy of lubricated results: what each ingredient changes; model = 'auto': what is left out, and that the result says so."""

import h5py
import numpy as np
import pytest
from cases import ROOT, STEADY, TRANSIENT, contents, ended, same_bits, write
from test_postproc import run

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


def test_what_is_not_known_says_why(asperity, tmp_path):
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


TARGET = "&accuracy target = 0.01 /\n"


def without_numbers(text):
    """The same case with grid and step left to the program."""
    return text.replace(", intervals = 256", "").replace(", time_step = 0.05", "") + TARGET


def auto(text):
    return text.replace("problem = 'ehl_line'", "problem = 'ehl_line', model = 'auto'")


PASSAGE = without_numbers(TRANSIENT.replace("position = -2.1", "position = -2.5").replace("end_time = 1.0", "end_time = 2.2"))
LOW = PASSAGE.replace("0.2e-6", "2e-10")
# the ridge on a surface at rest, inside the contact
RESTING = PASSAGE.replace("position = -2.5", "position = 0.2").replace("end_time = 2.2", "end_time = 8.0")
RESTING = RESTING.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 1.2, speed_2 = 0.0")


@pytest.mark.path
def test_low_ridge_is_left_out_and_the_result_says_so(asperity, tmp_path, told_case):
    lean, log = told_case(auto(LOW), name="lean")
    full, _ = told_case(LOW, name="full")
    drawn = ended(run("transient", tmp_path / "lean.h5"), 1)
    assert "has no /transient: model = 'auto' solved the steady contact with smooth surfaces, in place of" in drawn.stderr
    assert "model = 'full' has it" in drawn.stderr
    assert "solves the steady contact with smooth surfaces, in place of the passage" in log
    table = log[log.index("  auto  ") :].splitlines()
    assert table[0].split()[:2] == ["auto", "roughness"]
    assert table[0].endswith("left out")
    assert any(line.split()[0] == "squeeze" and line.endswith("left out: with roughness") for line in table)
    assert max(map(len, table)) <= 80
    assert lean["adequacy/decision@solved"].startswith(b"the steady contact with smooth surfaces")
    assert lean["adequacy/decision/roughness@decision"] == b"left out"
    assert lean["adequacy/decision/elasticity@decision"] == b"kept"
    assert lean["input/effective/time@transient"] == b".false."
    assert "transient/time" in full
    assert not any(name.startswith("transient") for name in lean)
    for name in ("h_min", "h_central"):
        change = lean[f"adequacy/decision/roughness/{name}"]
        influence = abs(change) + lean[f"adequacy/decision/roughness/{name}@error_estimate"]
        assert 0 < influence <= 0.0025
        value = lean[f"summary/{name}"]
        assert lean[f"summary/{name}@error_model"] == pytest.approx(influence * value, rel=1e-9, abs=0)
        parts = sum(lean[f"summary/{name}@error_{part}"] for part in ("grid", "domain", "iteration", "start", "model"))
        assert lean[f"summary/{name}@error_estimate"] == pytest.approx(parts, rel=1e-9, abs=0)
        bars = lean[f"summary/{name}@error_estimate"] + full[f"summary/{name}@error_estimate"]
        assert abs(value - full[f"summary/{name}"]) <= bars
    assert lean["summary/h_min"] == pytest.approx(full["summary/h_min"], rel=0.01)
    assert "complete: nothing to do" in ended(asperity("--resume", "lean.nml")).stderr


def test_high_ridge_is_solved_as_by_the_full_model(told_case):
    lean, log = told_case(auto(PASSAGE), name="auto")
    full, _ = told_case(PASSAGE, name="full")
    assert "kept: too high" in log
    assert "kept: may matter" in told_case(auto(PASSAGE.replace("0.2e-6", "2.4e-9")), name="between")[1]
    assert lean["adequacy/decision@solved"] == b"the case with every ingredient"
    solved = [name for name in full if not name.startswith("input") and "seconds" not in name]
    assert len(solved) > 50
    assert [name for name in solved if not same_bits(lean[name], full[name])] == []


def test_what_is_solved_steadily_or_kept(told_case):
    lean, _ = told_case(auto(RESTING), name="lean")
    full, _ = told_case(RESTING, name="full")
    assert lean["adequacy/decision@solved"] == b"the steady contact with its roughness, in place of the passage"
    assert lean["adequacy/decision/squeeze@decision"] == b"left out"
    assert lean["adequacy/decision/roughness@decision"] == b"kept"
    assert lean["summary/h_min"] == pytest.approx(full["summary/h_min"], rel=0.01)
    early = RESTING.replace("end_time = 8.0", "end_time = 8.0, statistics_from = 1.0")
    _, log = told_case(auto(early), name="early")
    assert "kept: the start counts" in log
    lean, log = told_case(auto(without_numbers(STEADY)), name="auto")
    full, _ = told_case(without_numbers(STEADY), name="full")
    # what is measured afterwards stands in the table
    line = next(line for line in log.splitlines() if line.split()[:1] == ["elasticity"])
    assert line.endswith("kept: cheap at rest")
    assert "%" in line
    solved = [name for name in full if not name.startswith("input") and "seconds" not in name]
    assert [name for name in solved if not same_bits(lean[name], full[name])] == []
    smooth = RESTING[: RESTING.index("&surface_2")] + RESTING[RESTING.index("&time") :]
    found, log = told_case(auto(smooth), name="lean")
    assert rows_of(log)["squeeze"] == "left out: at rest"
    assert "time_step" not in rows_of(log)
    assert found["adequacy/decision/squeeze@decision"] == b"left out"
    assert not any(name.startswith("transient") for name in found)
    lean, log = told_case(auto(LOW) + "&output film_thresholds = 1e-7 /\n", name="case")
    assert "kept: passage is wanted" in log
    assert "transient/time" in lean


def rows_of(log):
    """Rows of the table: what stands in the last column behind each name."""
    lines = log[log.index("  auto  ") :].splitlines()
    table = [line[12:] for line in lines if line.startswith(("  auto  ", " " * 12))]
    return {line.split()[0]: line[44:].strip() for line in table}


def test_table_shows_what_was_chosen_of_the_numbers(told_case):
    """Grid, domain, time step and method as in the lists of effective values; what was given is told as given."""
    inlet = "&domain x_inlet = -4.0, x_outlet = 1.5 /"
    assert inlet in PASSAGE
    found, log = told_case(auto(PASSAGE), name="auto")
    rows = rows_of(log)
    assert rows["grid"] == f"chosen: {found['input/effective/domain@intervals']} intervals"
    assert rows["domain"] == "given: -4 to 1.50"
    assert float(rows["time_step"].removeprefix("chosen: dT ")) == pytest.approx(found["input/effective/time@time_step"], rel=5e-4)
    assert rows["method"] == f"chosen: {found['report/method'].decode()}"
    for name in ("grid", "domain", "time_step", "method"):
        group = f"adequacy/decision/{name}"
        assert rows[name] == f"{found[f'{group}@decision'].decode()}: {found[f'{group}@value'].decode()}"
    case = auto(STEADY.replace(", intervals = 256", "").replace(", x_outlet = 1.5", "")) + TARGET
    found, log = told_case(case, name="steady")
    rows = rows_of(log)
    assert "inlet given: -4 to " in log
    assert rows["method"] == "chosen: newton_graded"
    assert "time_step" not in rows
    found, _ = told_case(auto(PASSAGE.replace(inlet, "")), name="open")
    assert found["adequacy/decision/domain@decision"] == b"chosen"

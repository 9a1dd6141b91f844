"""model = 'auto': what is left out, what is kept, and that the result says so."""

import h5py
import pytest
from cases import STEADY, TRANSIENT, same_bits
from test_postproc import run

TARGET = "&accuracy target = 0.01 /\n"


def without_numbers(text):
    """The same case with grid and step left to the program."""
    return text.replace(", intervals = 256", "").replace(", time_step = 0.05", "") + TARGET


def auto(text):
    return text.replace("problem = 'ehl_line'", "problem = 'ehl_line', model = 'auto'")


PASSAGE = without_numbers(TRANSIENT.replace("position = -2.1", "position = -2.5").replace("end_time = 1.0", "end_time = 2.2"))
LOW = PASSAGE.replace("0.2e-6", "2e-10")
# the ridge on a surface at rest, inside the contact
RESTING = (
    PASSAGE.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 1.2, speed_2 = 0.0")
    .replace("position = -2.5", "position = 0.2")
    .replace("end_time = 2.2", "end_time = 8.0")
)


def test_figure_over_time_says_why_there_are_no_times(told_case, tmp_path):
    told_case(auto(LOW), name="lean")
    done = run("transient", tmp_path / "lean.h5")
    assert done.returncode != 0
    assert "has no /transient: model = 'auto' solved the steady contact with smooth surfaces, in place of" in done.stderr
    assert "model = 'full' has it" in done.stderr


@pytest.mark.path
def test_low_ridge_is_left_out_and_the_result_says_so(told_case):
    lean, log = told_case(auto(LOW), name="lean")
    full, _ = told_case(LOW, name="full")
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
        parts = ("grid", "domain", "iteration", "start", "model")
        assert lean[f"summary/{name}@error_estimate"] == pytest.approx(
            sum(lean[f"summary/{name}@error_{part}"] for part in parts), rel=1e-9, abs=0
        )
        bars = lean[f"summary/{name}@error_estimate"] + full[f"summary/{name}@error_estimate"]
        assert abs(value - full[f"summary/{name}"]) <= bars
    assert lean["summary/h_min"] == pytest.approx(full["summary/h_min"], rel=0.01)


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


def test_later_run_finds_its_lean_result_complete(run_case, asperity, tmp_path):
    run_case(auto(LOW))
    again = asperity("--resume", "case.nml")
    assert "complete: nothing to do" in again.stderr
    with h5py.File(tmp_path / "case.h5") as file:
        assert file.attrs["converged"] == 1

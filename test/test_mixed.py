"""Mixed lubrication from the namelist on: numbers of an independent prototype, histories, dry results as laws, refusals."""

import h5py
import numpy as np
import pytest
from cases import LEAN, STEADY, case_text, ended, write

# Case 1 with the constants of the prototype, whose inputs have eight digits; EXPONENTIAL: A = 2 p_h, l = 0.45 sigma.
CASE = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.0099502488, reduced_modulus = 226373630000.0, speed_1 = {slow}, speed_2 = {fast} /
&load load_per_length = 1e5 /
&lubricant viscosity = 0.14, viscosity_law = 'roelands', roelands_z = 0.6, roelands_p0 = 1.98e8,
           density_law = 'dowson_higginson', rheology = 'eyring', eyring_stress = 3.3e6 /
&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /
&solver space_scheme = 'upwind2', tolerance = 1e-9 /
"""
P_H, FILM, TIME = 601736020.0, 1.124901e-06, 0.021484375
EXPONENTIAL = f"&asperities law = 'exponential', rms_height = 2e-7, contact_pressure = {2 * P_H}, decay_length = 9e-8 /\n"
TRIPP = "&asperities law = 'greenwood_tripp', rms_height = 2e-7, density_radius_height = 0.05, height_over_radius = 0.01, "
TABLE = "&asperities law = 'table', rms_height = 1.8e-7, file = 'law.csv' /\n"
ROWS = "1.475926,250 1.5332689,225 1.598324,200 1.6658249,175 1.7604534,150 1.937559,125 2.1969078,100 2.5292601,75 2.7394507,62.5"
ROWS += " 2.9985575,50 3.3345119,37.5 3.7009375,25 4.1409305,12.5"
LAW = "gap [m],pressure [Pa]\n" + "".join(f"{row.replace(',', 'e-7,')}e6\n" for row in ROWS.split())
# Speed, the groups; H at X = 0 (separation), smallest mean gap, largest total pressure, share of load; first and last full node.
PROTOTYPE = {
    "exponential": (0.1, EXPONENTIAL, (0.12440346, 0.10843424, 0.96924398, 0.55892804), (-3.9785156, 0.8984375)),
    "greenwood_tripp": (
        *(0.1, TRIPP + "flow = 'patir_cheng' /\n"),
        *((0.11676002, 0.13974495, 0.98194099, 0.053318508), (-3.9785156, 1.0703125)),
    ),
    "table": (0.1, TABLE, (0.12464092, 0.11199038, 0.97162379, 0.61771586), (-3.9785156, 0.8984375)),
    "starved": (
        *(0.3, EXPONENTIAL + f"&supply film = {0.1 * FILM} /\n"),
        *((0.092106616, 0.090660133, 0.96106156, 0.78825144), (-0.84179688, 0.70507812)),
    ),
}


def case_of(speed, groups):
    return CASE.format(slow=0.1 * speed, fast=1.1 * speed) + groups


@pytest.mark.parametrize(("speed", "groups", "expected", "ends"), PROTOTYPE.values(), ids=PROTOTYPE)
def test_numbers_of_the_prototype(solved_case, tmp_path, speed, groups, expected, ends):
    write(tmp_path, "law.csv", LAW)
    with solved_case(case_of(speed, groups) + LEAN) as file:
        fields = {key: value[()] for key, value in file["solution"].items() if value.ndim == 1}
        summary = {key: value[()] * value.attrs.get("si_scale", 1) for key, value in file["summary"].items()}
    x, solid = fields["x"], fields["asperity_pressure"]
    full = x[fields["pressure"] > solid]
    central = np.interp(0, x, fields["separation"])
    share = solid.sum() / fields["pressure"].sum()
    np.testing.assert_allclose((central, fields["film_thickness"].min(), fields["pressure"].max(), share), expected, rtol=1e-6)
    np.testing.assert_allclose((full.min(), full.max()), ends, atol=1e-6)
    assert summary["asperity_load_share"] == pytest.approx(share, rel=1e-9)
    assert summary["friction_coefficient_boundary"] == pytest.approx(0.12 * share, rel=1e-6)
    parts = summary["friction_coefficient_oil"] + summary["friction_coefficient_boundary"]
    assert summary["friction_coefficient"] == pytest.approx(parts, rel=1e-12)
    assert (fields["saturation"] > 0).all()
    assert (fields["saturation"] <= 1).all()


@pytest.mark.parametrize(("speed", "sigma"), [(1e-3, 2e-6), (1e-4, 1e-6), (1e-5, 2e-6)])
def test_the_chosen_domain_holds_all_asperities_that_touch(solved_case, speed, sigma):
    """Heights like the indentation or above it, films far below: no contact is solved on the domain of the film alone."""
    rough = f"&asperities law = 'exponential', rms_height = {sigma}, contact_pressure = {2 * P_H}, decay_length = {0.5 * sigma} /\n"
    with solved_case(case_of(speed, rough).replace("x_inlet = -4.0, x_outlet = 1.5, ", "") + LEAN) as file:
        solid = file["solution/asperity_pressure"][()]
        assert file["summary/asperity_load_share"][()] > 0.5
    assert solid[[1, -2]].max() < 1e-6 * solid.max()


SLOW = """&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = 226.4e9, speed_1 = 2e-4, speed_2 = 2e-4 /
&load load_per_length = 5e4 /
&lubricant viscosity = 0.04, pressure_viscosity = 2.2e-8, viscosity_law = 'barus' /
&asperities law = 'greenwood_tripp', rms_height = 2.7e-9, density_radius_height = 0.06, height_over_radius = 4e-4,
            flow = 'patir_cheng' /
&domain intervals = 512 /
"""
STARVED = {"dry": (4e-8, case_of(0.003, EXPONENTIAL)), "shared": (7e-8, case_of(0.03, EXPONENTIAL)), "smoother": (9e-10, SLOW)}


@pytest.mark.parametrize(("supply", "text"), STARVED.values(), ids=STARVED)
def test_what_arrives_passes_the_centre(solved_case, supply, text):
    """Films of a few nanometres, starved: the front lies where pressures are high, and moves far when a little less oil arrives."""
    with solved_case(text + f"&supply film = {supply} /\n" + LEAN) as file:
        gap = file["solution/film_thickness"]
        content = gap[()] * gap.attrs["si_scale"] * file["solution/density"][()] * file["solution/saturation"][()]
        x = file["solution/x"][()]
    assert np.interp(0, x, content) == pytest.approx(supply, rel=0.02)


@pytest.mark.parametrize(("ends", "status"), [((-1.2, 1.2), 2), ((-4.0, 1.5), 0)])
def test_a_domain_that_cuts_off_asperities_is_told(solved_case, ends, status):
    """Such contacts have no solution, or one that lacks what asperities behind the end would bear."""
    rough = f"&asperities law = 'exponential', rms_height = 1e-6, contact_pressure = {2 * P_H}, decay_length = 5e-7 /\n"
    text = case_of(0.1, rough).replace("x_inlet = -4.0, x_outlet = 1.5", f"x_inlet = {ends[0]}, x_outlet = {ends[1]}")
    with solved_case(text + LEAN, status=status) as file:
        told = (file.attrs["reason"] if status else file["report/note"][()]).decode()
    end = min(map(abs, ends))
    assert f"{end:.3f}, where asperities still press with about 0." in told
    assert "of the Hertz pressure: leave out x_" in told


def test_ridge_of_the_prototype(solved_case):
    rough = f"&asperities law = 'exponential', rms_height = 5e-8, contact_pressure = {4 * P_H}, decay_length = 2.25e-8 /\n"
    ridge = "&surface_2 shape = 'feature', amplitude = 2e-7, wavelength = 1e-4, position = -2.5 /\n"
    time = f"&time transient = .true., end_time = {100 * TIME}, time_step = {TIME} /\n"
    with solved_case(case_of(0.3, rough) + ridge + time + LEAN) as file:
        assert file["transient/film_thickness"][()].min() == pytest.approx(0.0884009, rel=1e-5)
        assert file["transient/pressure"][()].max() == pytest.approx(1.7713565, rel=1e-5)


HOT = (
    CASE.replace("1e5", "2e5").replace("0.14", "0.04").replace("3.3e6", "5e6, shear_limit = 'bair_winer', limit_ratio = 0.05")
    + "&thermal temperature = 40 /\n"
)
# Speeds, the groups; H (mean gap) at X = 0, smallest, largest total pressure; rises of film and surfaces [K]; friction of the oil.
WARM = {
    "smooth": ((4.0, 6.0), "", (0.36910546, 0.30191524, 0.97559386), (27.887415, 11.388304, 9.5635699), 0.021057514),
    "mixed": (
        *((0.4, 0.6), "&asperities law = 'exponential', rms_height = 1e-7, contact_pressure = 1.70196648e9 /\n"),
        *((0.075318607, 0.064384295, 0.99173294), (4.6171609, 4.3956107, 4.1773397), 0.023341186),
    ),
}


@pytest.mark.parametrize("name", WARM)
def test_warm_films_of_the_prototype(solved_case, name):
    """Its rounds end at 1e-4 of the rise; its friction is a sum over nodes."""
    (slow, fast), groups, expected, rises, friction = WARM[name]
    with solved_case(HOT.format(slow=slow, fast=fast) + groups + LEAN) as file:
        fields = {key: value[()] for key, value in file["solution"].items() if value.ndim == 1}
        oil = file["summary/friction_coefficient_oil" if groups else "summary/friction_coefficient"]
        told = [file["summary"][f"temperature_rise_{key}"][()] for key in ("film", "1", "2")]
        assert (oil[()], oil.attrs["no_estimate"]) == (pytest.approx(friction, rel=1e-3), b"no coarser grids are compared")
    central = np.interp(0, fields["x"], fields["film_thickness"])
    np.testing.assert_allclose((central, fields["film_thickness"].min(), fields["pressure"].max()), expected, rtol=1e-6)
    np.testing.assert_allclose(told, rises, rtol=5e-6)
    assert fields["temperature_rise"].max() == told[0]


def test_what_is_left_out_is_measured(solved_case):
    """Each row of adequacy is the change to a run without the group; friction may err by what the full energy equation says."""
    groups = {"supply": f"&supply film = {0.12 * FILM} /\n", "heat": "&thermal temperature = 40 /\n", "asperities": EXPONENTIAL}
    films = {}
    for leave in ("", *groups):
        text = HOT.format(slow=0.4, fast=0.6).replace(groups["heat"], "")
        with solved_case(text + "".join(groups[name] for name in groups if name != leave)) as file:
            told_of = {name: "friction_coefficient" if name == "heat" else "h_central" for name in groups}  # what it changes
            films[leave] = {name: file["summary"][name][()] for name in set(told_of.values())}
            if not leave:
                friction = file["summary/friction_coefficient"]
                oil = file["summary/friction_coefficient_oil"][()]
                assert friction.attrs["error_model"] == pytest.approx(0.11 * oil, rel=1e-9)
                rows = {name: file[f"adequacy/{name}/{key}"] for name, key in told_of.items()}
                told = {name: (row[()], row.attrs["error_estimate"]) for name, row in rows.items()}
    for name, (change, error) in told.items():
        assert films[name][told_of[name]] / films[""][told_of[name]] - 1 == pytest.approx(change, abs=error), name
        assert error < 0.5 * abs(change), name


ROLLERS = CASE.replace("1e5", "2e5").replace("0.14", "0.04").replace("3.3e6", "5e6")


def test_heat_of_the_inlet_thins_the_film(solved_case):
    """The full energy equation has 640 nm; adequacy tells the change; to oil that does not thin the key does nothing."""
    found = {}
    for key in (".false.", ".true."):
        for text in (ROLLERS, ROLLERS.replace("0.04, ", "0.04, thermal_viscosity = 0.0, ")):
            with solved_case(text.format(slow=4.0, fast=6.0) + f"&thermal temperature = 40, inlet_heating = {key} /\n") as file:
                found[key, text] = file["solution/film_thickness"][()], file["summary/h_min"][()], file["summary/h_central"][()]
                if (key, text) == (".true.", ROLLERS):
                    row = file["adequacy/inlet_heating/h_central"]
                    change, error = row[()], row.attrs["error_estimate"]
                    missing = file["adequacy/validity"].attrs["not_evaluated"].decode()
                    friction = file["summary/friction_coefficient"]
                    assert friction.attrs["error_model"] == pytest.approx(0.13 * friction[()], rel=1e-9)
        cold = found[key, text][0]
    assert "inlet_heating: the model has it, the formula leaves 0.812 of the film" in missing
    assert found[".false.", ROLLERS][1] > 1.04 * 640e-9
    assert found[".true.", ROLLERS][1] == pytest.approx(640e-9, rel=0.025)
    assert found[".false.", ROLLERS][2] / found[".true.", ROLLERS][2] - 1 == pytest.approx(change, abs=error)
    assert error < 0.5 * change
    np.testing.assert_allclose(found[".false.", text][0], cold, rtol=1e-9)


# beta mu_0 u^2/k: film over that of cold oil, Grubin's inlet with all temperatures across it.
GRUBIN = {0.1: 0.9817, 0.2857: 0.9505, 1.0: 0.8553}


@pytest.mark.parametrize("loading", GRUBIN)
def test_rolling_heats_the_inlet(solved_case, loading):
    """Barus' law, surfaces that stay cold; Grubin's inlet ends at X = -1. What a supply limits, heat does not thin."""
    text = ROLLERS.replace("rheology = 'eyring', eyring_stress = 5e6", f"thermal_conductivity = {0.04 / loading}")
    text = text.replace("x_inlet = -4.0, x_outlet = 1.5, intervals = 256", "intervals = 1024").format(slow=5.0, fast=5.0)
    text = text.replace("'roelands', roelands_z = 0.6, roelands_p0 = 1.98e8", "'barus', pressure_viscosity = 1.5e-8")
    text = text.replace("speed_1", "thermal_effusivity = 1e6, speed_1").replace("dowson_higginson", "constant") + LEAN
    text = text.replace("space_scheme = 'upwind2', ", "")
    for supply, loss in ("", 1 - GRUBIN[loading]), ("&supply film = 2e-7 /\n", 0):
        films = []
        for key in (".false.", ".true."):
            with solved_case(text + supply + f"&thermal temperature = 40, inlet_heating = {key} /\n") as file:
                films.append(file["summary/h_central"][()])
        assert 1 - films[1] / films[0] == pytest.approx(loss, rel=0.2, abs=1e-3), supply


def test_a_dry_sweep_is_a_law(solved_case, asperity, tmp_path):
    """What the dry contact of a profile bears, at its mean gap: the same rows as a table in CSV."""
    loads = [2e6, 1e7, 5e7, 2e8]
    wave = "shape = 'sinusoid', amplitude = 4e-7, wavelength = 1e-4"
    write(tmp_path, "dry.nml", case_text(wave, loads, more="&domain length = 1e-4, intervals = 256 /\n" + LEAN))
    ended(asperity("dry.nml", "--quiet"))
    with h5py.File(tmp_path / "dry.h5") as file:
        gaps, pressures = (file["sweep"][key][()][::-1].tolist() for key in ("mean_separation", "mean_pressure"))
    write(tmp_path, "law.csv", "gap [m],pressure [Pa]\n" + "".join(f"{g!r},{p!r}\n" for g, p in zip(gaps, pressures, strict=True)))
    fields = []
    for law in ("dry.h5", "law.csv"):
        with solved_case(case_of(0.1, TABLE.replace("law.csv", law)) + LEAN) as file:
            fields.append([file["solution"][key][()] for key in ("asperity_pressure", "separation", "pressure")])
    assert all(np.array_equal(*pair) for pair in zip(*fields, strict=True))
    solid, gap, total = fields[0]
    assert 0.05 < solid.sum() / total.sum() < 1
    inside = (solid > 0) & (solid * P_H < pressures[0]) & (gap * FILM < gaps[-1])  # between the rows ln p is close to lines
    assert np.count_nonzero(inside) > 10
    lines = np.interp(gap[inside] * FILM, gaps, np.log(pressures))
    np.testing.assert_allclose(np.log(solid[inside] * P_H), lines, atol=0.3)


TABLES = {
    "1e-7,2e8\n2e-7,3e8\n": "found 3.000E+08 Pa at 2.000E-07 m behind 2.000E+08 Pa at 1.000E-07 m, expected a",
    "1e-7,2e8\n": "found 1 row, expected names with units and at least two rows",
    "1e-7,2e8\n2e-7,-1\n": "found '-1', expected a number from",
}


def test_files_that_hold_no_law_are_refused(tmp_path, run_case, solved_case):
    told = run_case(case_of(1, TABLE), "--check", status=1).stderr
    assert told == "case.nml:8: &asperities file: law.csv: no such file\n"
    for rows, reason in TABLES.items():
        write(tmp_path, "law.csv", "gap [m],pressure [Pa]\n" + rows)
        assert reason in run_case(case_of(1, TABLE), "--check", status=1).stderr
    solved_case(STEADY + LEAN, name="film").close()
    assert "film.h5" in run_case(case_of(1, TABLE.replace("law.csv", "film.h5")), "--check", status=1).stderr

"""Limits of the model: every row of /adequacy/validity is passed by one scene and kept by a milder one, and told in one line."""

import json
import re

import h5py
import numpy as np
import pytest
from cases import AT_REST, MOES, POINT, STEADY, STOKES, TRANSIENT, ended, text, write

AUTO = STEADY.replace("&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /\n", "")
ROLLING = STEADY.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 0.6, speed_2 = 0.6")
LOAD = "load_per_length = 1e5"


def changed(case, *pairs):
    for old, new in pairs:
        assert old in case, old
        case = case.replace(old, new)
    return case


def with_bodies(words):
    return changed(STEADY, ("speed_2 = 1.1", f"speed_2 = 1.1, {words}"))


def soft(modulus):
    return f"""&case problem = 'ehl_line' /
&bodies reduced_radius = 0.01, reduced_modulus = {modulus}, speed_1 = 0.5, speed_2 = 0.5 /
&load load_per_length = 1000.0 /
&lubricant viscosity = 0.1, viscosity_law = 'constant', density_law = 'constant' /
"""


def water(speed):
    return f"""&case problem = 'ehl_line' /
&bodies reduced_radius = 0.1, reduced_modulus = 226e9, speed_1 = {speed}, speed_2 = {speed} /
&load load_per_length = 500.0 /
&lubricant viscosity = 1e-3, viscosity_law = 'constant', density_law = 'constant', density = 1000.0 /
"""


def wavy(amplitude, wavelength):
    still = AT_REST.replace("256", "4096")
    return still + f"&surface_1 shape = 'sinusoid', amplitude = {amplitude}, wavelength = {wavelength} /\n"


# row: scene beyond the limit, milder scene, what is told
SCENES = {
    "starvation": (STEADY, AUTO, "starves the film by 2.1 %"),
    "mixed_lubrication": (wavy(0.2e-6, 1e-4), wavy(0.1e-6, 1e-4), "times the composite roughness"),
    "viscosity_data": (changed(AUTO, (LOAD, "hertz_pressure = 1.3e9")), AUTO, "viscosities are measured to 1.030 GPa"),
    "limiting_stress": (changed(AUTO, ("'eyring', eyring_stress = 3.3e6", "'newtonian'")), STEADY, "oils give way near 0.1"),
    "shear_heating": (STEADY, ROLLING, "less viscosity, up to"),
    "hardness": (with_bodies("hardness = 0.5e9"), with_bodies("hardness = 0.7e9"), "pass the hardness, 500.0 MPa"),
    "shakedown": (with_bodies("hardness = 0.85e9"), with_bodies("hardness = 0.95e9"), "shakedown limit, 566.7 MPa"),
    "inlet_heating": (STEADY, ROLLING, "heat of the inlet, not in the model"),
    "side_flow": (with_bodies("contact_length = 1e-3"), with_bodies("contact_length = 2e-3"), "of the film: the contact is short"),
    "stokes_number": (changed(STEADY, ("3.3e6", "40e6")), STEADY, "(T_max)"),
    "surface_slope": (soft(1e7), soft(1e9), "surfaces are as steep as"),
    "film_over_wave": (wavy(1e-9, 3e-6), wavy(1e-9, 2e-5), "of the finest wave"),
    "turbulence": (water(60.0), water(10.0), "not laminar"),
}


def limit_of(asperity, folder, name, row, case):
    write(folder, f"{name}.nml", case)
    done = ended(asperity(f"{name}.nml", "--verbose"))
    with h5py.File(folder / f"{name}.h5") as file:
        group = file["adequacy/validity"]
        value, label = group[row][()], dict(group[row].attrs)
        # what is told is what is stored, each in one sentence behind its own mark
        exceeded = sum(group[other].attrs["exceeded"] for other in group)
    told = [line for line in done.stdout.splitlines() if line.startswith(("  limit ", "  inlet "))]
    assert len(told) == exceeded
    lines = done.stdout.splitlines()
    for line in told:
        assert len(line) <= 80
        # nothing of it is left for another line
        assert lines[lines.index(line) + 1].split()[0] in {"limit", "inlet", "times", "model", "note", "result"}
    return value, label, " ".join((done.stderr + done.stdout).split())


@pytest.mark.parametrize("row", SCENES)
def test_each_limit_on_either_side(asperity, tmp_path, row):
    beyond, milder, words = SCENES[row]
    value, label, log = limit_of(asperity, tmp_path, "beyond", row, beyond)
    below = label["beyond"] == b"below"
    assert label["exceeded"] == 1
    assert (value < label["threshold"]) == below
    assert words in log
    assert len(label["source"]) > 20
    value, label, log = limit_of(asperity, tmp_path, "milder", row, milder)
    assert label["exceeded"] == 0
    assert (value > label["threshold"]) == below
    assert words not in log


SLIDING = changed(POINT, ("entrainment_speed = 1.0", "speed_1 = 0.9, speed_2 = 1.1"))
# Rms heights of both surfaces, and whether asperities carry load: the films are 0.43 um.
ROUGHNESS = {
    "film below": (STEADY, "roughness_1 = 0.3e-6, roughness_2 = 0.4e-6", True),
    "film above": (STEADY, "roughness_1 = 0.3e-6, roughness_2 = 0.2e-6", False),
    "one surface": (STEADY, "roughness_2 = 0.2e-6", False),
    "passage": (TRANSIENT, "roughness_1 = 0.5e-6", True),
    "ellipse": (SLIDING, "roughness_1 = 0.3e-6", True),
}


@pytest.mark.path
@pytest.mark.parametrize(("case", "words", "is_mixed"), ROUGHNESS.values(), ids=ROUGHNESS)
def test_film_below_the_roughness_is_outside_the_model(asperity, tmp_path, case, words, is_mixed):
    """The same outcome in the file, the closing table, the outcomes, the table of results, and of --resume."""
    write(tmp_path, "a.nml", changed(case, ("speed_2 = 1.1", f"speed_2 = 1.1, {words}")))
    done = ended(asperity("a.nml"), 2 if is_mixed else 0)
    with h5py.File(tmp_path / "a.h5") as file:
        outcome, reason = text(file.attrs["outcome"]), text(file.attrs["reason"])
        ratio, film = file["summary/lambda_ratio"], file["summary/h_min"]
        assert file.attrs["converged"] == 1
        rms = np.linalg.norm([float(number) for number in re.findall(r"\d\S+e-6", words)])
        assert ratio[()] == pytest.approx(film[()] / rms, rel=1e-12)
        share = film.attrs["error_estimate"] / film[()]
        assert ratio.attrs["error_estimate"] / ratio[()] == pytest.approx(share, rel=1e-12, nan_ok=True)
        assert file["adequacy/validity/mixed_lubrication"][()] == ratio[()]
        found = ratio[()]
        assert (found < 1) == is_mixed
    lines = done.stdout.splitlines()
    (row,) = [line.split() for line in lines if line.startswith("  lambda ratio ")]
    assert float(row[2]) == pytest.approx(found, rel=1e-3)
    assert outcome == ("outside the model: mixed" if is_mixed else "converged")
    assert len(lines) <= 12
    row = json.loads(asperity("table", "a.h5", "--format", "json").stdout)
    assert (row["converged"], row["outcome"], row["reason"]) == (True, outcome, reason)
    told = asperity("table", "a.h5").stdout
    for again in (asperity("a.nml", "--quiet", "--outcomes"), asperity("a.nml", "--quiet", "--outcomes", "--resume")):
        assert again.stdout == f"{done.returncode}\ta.nml\t{reason if is_mixed else ''}\n"
        assert ("outside the model" in again.stderr) == is_mixed
    if is_mixed:
        assert reason.startswith("outside the model: mixed lubrication, the smallest film is 0.")
        assert " ".join(lines[:3]).replace("   ", " ").startswith(f"a.nml: {reason}, ")
        assert told.endswith(f"{reason}\n")
        assert "times the composite roughness: mixed lubrication" not in done.stdout
    else:
        assert "  limit     the film is" in done.stdout
        assert "outside" not in told


@pytest.mark.path
def test_what_is_not_known_is_named(solved_cases):
    file, moes = solved_cases(a=STEADY, b=MOES)
    group = file["adequacy/validity"]
    missing = group.attrs["not_evaluated"].decode()
    assert "mixed_lubrication: no roughness: neither sinusoid nor profile" in missing
    for name in ("hardness: &bodies hardness is not given", "side_flow: &bodies contact_length is not given"):
        assert name in missing
    assert {part.split(":")[0] for part in missing.split("; ")} | set(group) == set(SCENES)
    assert list(moes["adequacy/validity"]) == ["starvation"]
    # the two numbers of Stokes against Reynolds are those of the design: Case 1, T_max 0.057 on a fine grid
    assert group["stokes_number"][()] == pytest.approx(0.0575, abs=1e-3)


@pytest.mark.path
def test_a_transient_takes_the_extremes_and_a_failure_nothing(asperity, tmp_path):
    write(tmp_path, "a.nml", TRANSIENT)
    write(tmp_path, "b.nml", STEADY + "&solver max_cycles = 1 /\n")
    assert asperity("a.nml", "b.nml", "--quiet").returncode == 2
    with h5py.File(tmp_path / "a.h5") as file, h5py.File(tmp_path / "b.h5") as failed:
        assert file["adequacy/validity/viscosity_data"][()] == pytest.approx(file["summary/p_max"][()], rel=1e-12)
        assert "adequacy" not in failed


def rise_by(heat, x, film, bodies, oil):
    """Largest rise by heat constant over each interval: surfaces of Jaeger and Archard, and by Fourier in the film."""
    ways = np.sqrt(np.arange(len(x) + 1.0)) * np.sqrt(x[1] - x[0])
    surfaces = 2 * np.convolve(heat, np.diff(ways))[: len(x)] / np.sqrt(np.pi)
    surfaces /= bodies["thermal_effusivity"] * np.sqrt(np.abs([bodies["speed_1"], bodies["speed_2"]])).sum()
    return float((surfaces + heat * film / (8 * oil["thermal_conductivity"])).max())


def in_si(file, pressure, film):
    """Positions, pressure and film [m, Pa, m] of dimensionless fields."""
    scales = file["scaling"].attrs
    fields = (file["solution/x"][()], "half_width"), (pressure, "hertz_pressure"), (film, "film_thickness")
    return [field * scales[unit] for field, unit in fields]


def rise_of(file, pressure, film):
    """Largest temperature rise of a film by sliding, from dimensionless fields and the input alone, in SI."""
    given = file["input/effective"]
    oil, bodies = given["lubricant"].attrs, given["bodies"].attrs
    x, p, h = in_si(file, pressure, film)
    sliding, stress_0 = abs(bodies["speed_2"] - bodies["speed_1"]), oil["eyring_stress"]
    exponent = (np.log(oil["viscosity"]) + 9.67) * ((1 + p / oil["roelands_p0"]) ** oil["roelands_z"] - 1)
    rate = oil["viscosity"] * np.exp(exponent) * sliding / (stress_0 * h)
    slope = np.gradient(p, x)
    slope[-1] = 0.0
    sigma = np.maximum(np.abs(0.5 * h * slope / stress_0), 1e-8)
    heat = sliding * stress_0 * np.arcsinh(rate * sigma / np.sinh(sigma))
    heat[1:] *= p[1:] > 0
    return rise_by(heat, x, h, bodies, oil)


def test_heat_of_a_passage_is_the_largest_of_all_times(solved_cases):
    """A ridge has left the contact at the end: it was warmer before; to what averaging heat over pairs of nodes changes."""
    case = changed(TRANSIENT, ("position = -2.1", "position = -1.0"), ("end_time = 1.0", "end_time = 2.5, statistics_from = 0.0"))
    file, late = solved_cases(a=case, b=changed(case, ("statistics_from = 0.0", "statistics_from = 2.45")))
    series = file["transient"]
    assert len(series["profile_time"]) == len(series["time"])
    rises = [rise_of(file, *fields) for fields in zip(series["pressure"][()], series["film_thickness"][()], strict=True)]
    found = file["adequacy/validity/shear_heating"][()]
    assert found == pytest.approx(max(rises), rel=0.02)
    assert found > 1.04 * max(rises[0], rises[-1])
    assert late["adequacy/validity/shear_heating"][()] == pytest.approx(max(rises[-2:]), rel=0.02)


def test_limits_of_an_ellipse_are_those_of_a_line(solved_case):
    """Each with a value or a reason; the heat is that of its hottest row."""
    with solved_case(SLIDING) as file:
        group, given, fields = file["adequacy/validity"], file["input/effective"], file["si/solution"]
        missing = {part.split(":")[0] for part in group.attrs["not_evaluated"].decode().split("; ")}
        assert missing == {"film_over_wave", "hardness", "mixed_lubrication", "shakedown", "side_flow"}
        assert missing | set(group) == set(SCENES)
        oil, bodies = given["lubricant"].attrs, given["bodies"].attrs
        rows = zip(0.2 * fields["shear_stress_mean"][()], fields["film_thickness"][()], strict=True)
        rises = [rise_by(heat, fields["x"][()], film, bodies, oil) for heat, film in rows]
        assert group["shear_heating"][()] == pytest.approx(max(rises), rel=1e-9)


def test_what_is_solved_is_not_doubted(solved_case):
    # With the full momentum equations no limit of Reynolds' equation is left.
    with solved_case(changed(STOKES, ("256", "128"))) as file:
        group = file["adequacy/validity"]
        assert not {"stokes_number", "surface_slope", "film_over_wave"} & set(group)
        assert "stokes_number: the full momentum equations are solved" in group.attrs["not_evaluated"].decode()
    # Where the length is not given the result says below which one it would matter.
    with solved_case(STEADY) as file:
        words = file["adequacy/validity"].attrs["not_evaluated"].decode().split("side_flow: ")[1].split(";")[0]
        width = 2 * file["scaling"].attrs["half_width"]
    length, unit = words.split("shorter than ")[1].split(" would lose 1")[0].split()
    assert float(length) * {"mm": 1e-3, "um": 1e-6}[unit] == pytest.approx(np.log(100) / 0.68 * width, rel=1e-3)


def test_pure_rolling_has_no_sliding_for_reynolds_to_fail_by(solved_cases):
    """T_max is 0, though the pressure gradient shears the oil: the films of the full equations agree to 0.1 %."""
    rolling = "speed_1 = 3.0, speed_2 = 3.0"
    case = changed(STEADY, ("speed_1 = 0.1, speed_2 = 1.1", rolling), ("eyring_stress = 3.3e6", "eyring_stress = 20e6"))
    full = changed(case, ("problem = 'ehl_line'", "problem = 'ehl_line', equations = 'stokes'")) + "&film layers = 10 /\n"
    file, full, other = solved_cases(a=case, full=full, sliding=changed(case, (rolling, "speed_1 = 1.0, speed_2 = 5.0")))
    number = file["adequacy/validity/stokes_number"]
    assert number[()] == 0.0
    assert number.attrs["exceeded"] == 0
    assert full["momentum/stress_rise"][()] > number.attrs["threshold"]
    for name in ("h_min", "h_central"):
        assert abs(full[f"momentum/difference_{name}"][()]) < 1e-3
    assert other["adequacy/validity/stokes_number"].attrs["exceeded"] == 1


def limits_from_fields(file, pressure, film):
    """T_max and the largest slope of a film, from dimensionless fields and the input alone, in SI."""
    given = file["input/effective"]
    oil = {name: float(given["lubricant"].attrs[name]) for name in ("viscosity", "roelands_z", "roelands_p0", "eyring_stress")}
    sliding = abs(float(given["bodies"].attrs["speed_2"] - given["bodies"].attrs["speed_1"]))
    x, p, h = in_si(file, pressure, film)
    ratio, exponent = 1 + p / oil["roelands_p0"], np.log(oil["viscosity"]) + 9.67
    viscosity = oil["viscosity"] * np.exp(exponent * (ratio ** oil["roelands_z"] - 1))
    by_pressure = exponent * oil["roelands_z"] / oil["roelands_p0"] * ratio ** (oil["roelands_z"] - 1)
    rate = viscosity * sliding / (oil["eyring_stress"] * h)
    number = oil["eyring_stress"] * by_pressure * rate / np.sqrt(1 + rate**2)
    slopes = np.abs(np.diff(h) / np.diff(x))
    loaded = np.minimum(p[1:], p[:-1]) > 0.01 * p.max()
    return float(number.max()), float(slopes[loaded].max())


def limits_by_definition(file):
    """What every limit of a steady contact with a wave on a surface at rest compares, from its fields and its input in SI."""
    given = file["input/effective"]
    oil, bodies, wave = (given[group].attrs for group in ("lubricant", "bodies", "surface_1"))
    scales = file["scaling"].attrs
    x, p, h = in_si(file, file["solution/pressure"][()], file["solution/film_thickness"][()])
    stress = np.abs(file["solution/shear_stress_mean"][()]) * scales["shear_stress"]
    film = float(np.interp(0.0, x, h))
    speeds = np.array([bodies["speed_1"], bodies["speed_2"]])
    mean, sliding = speeds.mean(), abs(speeds[1] - speeds[0])
    loading = oil["thermal_viscosity"] * oil["viscosity"] * mean**2 / oil["thermal_conductivity"]
    strain = scales["hertz_pressure"] / scales["reduced_modulus"]
    inlet = 1 + 0.213 * (1 + 2.23 * (sliding / mean) ** 0.83) * loading**0.64
    width = 2 * max(scales["half_width"], np.sqrt(2 * scales["reduced_radius"] * film))
    number, slope = limits_from_fields(file, file["solution/pressure"][()], file["solution/film_thickness"][()])
    return {
        "mixed_lubrication": float(file["summary/h_min"][()]) / (wave["amplitude"] / np.sqrt(2)),
        "viscosity_data": p.max(),
        "limiting_stress": (stress / np.maximum(p, 1.0))[p > 0.1 * p.max()].max(),
        "hardness": p.max(),
        "shakedown": scales["hertz_pressure"],
        "shear_heating": rise_by(stress * sliding, x, h, bodies, oil),
        "inlet_heating": 1 - (1 - 13.2 * strain * loading**0.42) / inlet,
        "side_flow": np.exp(-0.68 * bodies["contact_length"] / width),
        "stokes_number": number,
        "surface_slope": slope,
        "film_over_wave": film / wave["wavelength"],
        "turbulence": oil["density"] * mean * film / oil["viscosity"],
    }


@pytest.mark.parametrize(("grid", "place"), [("intervals = 512", -1.6), ("intervals = 512", -2.5), ("grid = 'graded'", -2.0)])
def test_what_a_near_inlet_starves_is_measured(asperity, tmp_path, grid, place):
    """Against a domain that is far longer, to its error of grids."""
    near = AUTO + f"&domain x_inlet = {place}, {grid} /\n"
    write(tmp_path, "near.nml", near)
    write(tmp_path, "far.nml", AUTO + "&domain x_inlet = -20.0, intervals = 4096 /\n")
    done = asperity("near.nml")
    assert (done.returncode, asperity("far.nml", "--quiet").returncode) == (0, 0)
    with h5py.File(tmp_path / "near.h5") as file, h5py.File(tmp_path / "far.h5") as whole:
        films = [result["summary/h_central"] for result in (file, whole)]
        assert file["adequacy/validity/starvation"][()] == pytest.approx(1 - films[0][()] / films[1][()], abs=4e-3)
        assert abs(films[0][()] - films[1][()]) <= films[0].attrs["error_estimate"] + films[1].attrs["error_estimate"]
        assert "starves the film" in done.stdout


def test_every_limit_by_its_definition(solved_cases):
    """Values from the result file alone; starvation against a domain that is far longer: its rule is good to a factor of two."""
    bodies = "speed_2 = 1.1, hardness = 0.9e9, contact_length = 1e-3"
    case = changed(wavy(0.05e-6, 1e-4), ("speed_2 = 1.1", bodies), ("4096", "512"))
    far = changed(case, ("x_inlet = -4.0", "x_inlet = -15.0"), ("intervals = 512", "intervals = 1536"))
    file, whole = solved_cases(a=case, far=far + "&accuracy error_bars = .false. /&output adequacy = .false. /\n")
    found = {name: item[()] for name, item in file["adequacy/validity"].items()}
    assert set(found) == set(SCENES)
    starved = 1 - file["summary/h_central"][()] / whole["summary/h_central"][()]
    assert 0.5 < found.pop("starvation") / starved < 2.0
    expected = limits_by_definition(file)
    # on 513 nodes the program averages heat over pairs of them
    assert found.pop("shear_heating") == pytest.approx(expected.pop("shear_heating"), rel=0.02)
    assert found == pytest.approx(expected, rel=1e-9)

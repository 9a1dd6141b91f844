"""`asperity gear` and `asperity cam`: every formula against a closed form, what cannot be is refused."""

import math
import re
import sys
from pathlib import Path

import f90nml
import h5py
import numpy as np
import pytest
from asperity import commands, duty
from cases import ROOT, seal

DEGREE = math.pi / 180
INPUT = ROOT / "input" / "duty"
GEAR = "module_mm = 4\nteeth = [20, 40]\ntorque_Nm = 300\nspeed_rpm = 1500\nface_width_mm = 30\n"
CAM = "base_radius_mm = 16\nwidth_mm = 10\nspeed_rpm = 1000\npreload_N = 400\nspring_rate_N_per_mm = 60\nmass_kg = 0.2\n"


@pytest.fixture
def write(capsys, tmp_path, monkeypatch):
    """Calls a command on the keys of its table: (status, what it prints), the table and the namelist."""
    monkeypatch.chdir(tmp_path)

    def call(command, keys, *arguments, lift="", tables=""):
        (tmp_path / "lift.csv").write_text(lift, encoding="utf-8")
        head = "" if keys[:1] == "[" else f"[{command}]\n"
        (tmp_path / "mesh.toml").write_text(head + keys + tables, encoding="utf-8")
        status = duty.main([command, "mesh.toml", *arguments])
        out, err = capsys.readouterr()
        assert (err if status == 0 else out) == ""
        return status, out + err

    return call


def table_of(path="mesh.csv"):
    table = np.genfromtxt(path, delimiter=",", skip_header=1, names=True, deletechars="")
    assert table.dtype.names == tuple(name.replace(" ", "_") for name in duty.COLUMNS)
    columns = [table[name] for name in table.dtype.names]
    assert columns[0][0] == 0
    assert np.all(np.diff(columns[0]) > 0)
    return columns


def lift_of(angles, lift):
    rows = "".join(f"{angle:.9f},{height:.12f}\n" for angle, height in zip(angles, lift, strict=True))
    return f"# a comment\n{duty.LIFT_HEADER}\n{rows}"


def test_pitch_point_and_sum_of_radii(write):
    status, words = write("gear", GEAR)
    assert status == 0, words
    time, load, u1, u2, radius = table_of()
    w1, r1, r2, angle = 1500 * math.pi / 30, 0.04, 0.08, 20 * DEGREE
    line = (r1 + r2) * math.sin(angle)
    np.testing.assert_allclose(u1 / w1 + u2 / (w1 / 2), line, rtol=1e-10)
    pitch = np.interp(0, u1 - u2, time)
    assert np.interp(pitch, time, u1) == pytest.approx(w1 * r1 * math.sin(angle), rel=1e-9)
    assert np.interp(pitch, time, radius) == pytest.approx(r1 * r2 * math.sin(angle) / (r1 + r2), rel=1e-5)
    path = math.sqrt(0.044**2 - (r1 * math.cos(angle)) ** 2) + math.sqrt(0.084**2 - (r2 * math.cos(angle)) ** 2) - line
    assert time[-1] == pytest.approx(path / (w1 * r1 * math.cos(angle)), rel=1e-10)
    full = 300 / (r1 * math.cos(angle)) / 0.03
    np.testing.assert_allclose([load[0], load.max(), load[-1]], [full / 3, full, full / 3], rtol=1e-9)


def test_two_pairs_share_the_whole_load():
    mesh = duty.mesh_of(4e-3, (20, 40), 20 * DEGREE)
    s = np.linspace(mesh.start, mesh.end - mesh.base_pitch, 50)
    for ends in (1 / 3, 0.05, 0.5):
        np.testing.assert_allclose(mesh.share(s, ends) + mesh.share(s + mesh.base_pitch, ends), 1, rtol=1e-12)
        np.testing.assert_allclose(mesh.share(np.array([mesh.start, mesh.end]), ends), ends, rtol=1e-12)
    path = mesh.path(200)
    jumps = np.flatnonzero(np.abs(np.diff(mesh.share(path, 1 / 3))) > 0.3)
    np.testing.assert_allclose(np.diff(path)[jumps], duty.JUMP * (mesh.end - mesh.start), rtol=1e-9)
    assert len(jumps) == 2


def test_contact_ratios_of_textbooks():
    # R. L. Norton, Machine Design, example 12-1: 6 teeth per inch of diameter, path 0.798 in, contact ratio 1.62
    mesh = duty.mesh_of(1 / 6, (19, 37), 20 * DEGREE)
    assert (round(mesh.end - mesh.start, 3), round(mesh.contact_ratio, 2)) == (0.798, 1.62)
    for z in (18, 30, 77):  # equal gears
        expected = (math.sqrt((z + 2) ** 2 - (z * math.cos(20 * DEGREE)) ** 2) - z * math.sin(20 * DEGREE)) / math.pi
        ratio = duty.mesh_of(1e-3, (z, z), 20 * DEGREE).contact_ratio
        assert ratio == pytest.approx(expected / math.cos(20 * DEGREE), rel=1e-12)


def test_profile_shift_and_helix():
    for angle in (0.01, 0.35, 1.2):
        assert duty.involute_angle(duty.involute(angle)) == pytest.approx(angle, rel=1e-12)
    assert duty.mesh_of(1, (20, 30), 0.35, 0, (0.3, -0.3)).working_angle == pytest.approx(0.35, rel=1e-12)
    # printed examples: KHK gear technical reference, table 4.3; a pair of 21 deg helix at a distance of 116.5 mm
    for module, teeth, helix, shift, angle, distance in (
        (3, (12, 24), 0, (0.6, 0.36), 26.0886, 56.4999),
        (3.5, (31, 30), 21, (0.291, 0.3608771312), 23.8707609654, 116.5),
    ):
        mesh = duty.mesh_of(module, teeth, 20 * DEGREE, helix * DEGREE, shift)
        assert mesh.working_angle / DEGREE == pytest.approx(angle, abs=1e-4)
        assert sum(mesh.base_radii) / math.cos(mesh.working_angle) == pytest.approx(distance, abs=1e-4)
    # tan b_b = tan b cos a_t, and the ellipse that a plane normal to the contact line cuts from a cylinder
    base_helix = math.atan(math.tan(21 * DEGREE) * math.cos(math.atan(math.tan(20 * DEGREE) / math.cos(21 * DEGREE))))
    assert mesh.radius(np.array([mesh.line / 2]))[0] == pytest.approx(mesh.line / 4 / math.cos(base_helix), rel=1e-12)


@pytest.mark.parametrize(("harmonics", "exact"), [(0, 2e-4), (3, 1e-8)])
def test_an_eccentric_circle_is_a_cam(write, harmonics, exact):
    """Radius a, centre e beside the axis: rho = a, and what moves over it is the centre."""
    e, w = 4.0, 1000 * math.pi / 30
    angles = np.linspace(0, 360, 361) + 0.3 * np.sin(np.linspace(0, 2 * np.pi, 361))
    keys = f'lift = "lift.csv"\nharmonics = {harmonics}\n{CAM}'
    status, words = write("cam", keys, lift=lift_of(angles, e * (1 - np.cos(angles * DEGREE))))
    assert status == 0, words
    time, load, u1, u2, radius = table_of()
    assert time[-1] == pytest.approx(0.06, rel=1e-11)
    np.testing.assert_allclose([column[-1] for column in (load, u1, u2, radius)], [c[0] for c in (load, u1, u2, radius)])
    np.testing.assert_allclose(radius, 20e-3, rtol=exact)
    np.testing.assert_allclose(u1, w * 20e-3, rtol=exact)
    np.testing.assert_allclose(u2, w * e * 1e-3 * np.cos(w * time), atol=exact * w * e * 1e-3)
    force = 400 + 60 * e * (1 - np.cos(w * time)) + 0.2 * w**2 * e * 1e-3 * np.cos(w * time)
    np.testing.assert_allclose(load, force / 0.01, rtol=exact)


REFUSED = {
    "several": ("gear", GEAR.replace("4", '"4"', 1).replace("torque", "torqe") + "[lubricant]\nviscosity = [[1]]\n", 4),
    "no numbers": ("gear", GEAR.replace("[20, 40]", "[20, 40.5]").replace("1500", "nan").replace("mm = 30", "mm = true"), 3),
    "interference": ("gear", GEAR.replace("20", "8"), "tips of gear 2 that reach 4.64 mm beyond the involute of gear 1"),
    "contact ratio": ("gear", GEAR + "addendum_factor = [0.5, 0.5]\n", "a contact ratio of 0.8848, expected more than 1"),
    "pointed": ("gear", GEAR + "profile_shift = [1.5, 0.0]\n", "pointed teeth of gear 1"),
    "overlap": ("gear", GEAR + "profile_shift = [-1.5, -1.5]\n", "found the sum -3, expected a larger one"),
    "no table": ("gear", "[cam]\n", "found no table [gear], expected it with module_mm, teeth"),
    "no TOML": ("gear", "a = b", "found no TOML: Invalid value"),
    "no lift": ("cam", 'lift = "none.csv"\n' + CAM, "[cam] lift: found none.csv, which cannot be read: No such file"),
    "header": ("cam", ("x,y", [0] * 20), "[cam] lift: found 'x,y', expected the header 'angle [deg],lift [mm]'"),
    "hollow": ("cam", (None, 9 * np.sin(np.radians(np.arange(0, 360, 5))) ** 4), "a radius of curvature of -11"),
    "jump": ("cam", (None, -4 * np.cos(np.radians(np.arange(0, 360, 5)))), "a load of -1116 N at 180 deg"),
    "part of a revolution": ("cam", (None, np.linspace(1, 2, 30)), "145 deg with lifts of 1 and 2 mm at its ends"),
    "words": ("cam", (None, [0, 1, 2, 3, math.nan, 3, 2, 1, 0]), "no numbers, expected those of a revolution"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_is_refused(write, tmp_path, name):
    command, keys, words = REFUSED[name]
    lift = ""
    if isinstance(keys, tuple):
        header, heights = keys
        lift = lift_of(np.arange(len(heights)) * 5, heights).replace(duty.LIFT_HEADER, header or duty.LIFT_HEADER)
        keys = 'lift = "lift.csv"\n' + CAM + "harmonics = 0\n"
        keys = keys.replace("0.2", "40").replace("16", "30") if name == "jump" else keys
    status, said = write(command, keys, lift=lift)
    assert status == 1
    assert all(re.match(r"mesh\.toml: .*(found|expected) ", line) for line in said.splitlines()), said
    assert said.count("\n") == words if isinstance(words, int) else words in said
    assert not (tmp_path / "mesh.csv").exists()


@pytest.mark.parametrize(("command", "name"), [("gear", "spur_gear"), ("cam", "cam")])
def test_examples_and_their_files(monkeypatch, capsys, tmp_path, command, name):
    monkeypatch.chdir(tmp_path)
    for options, status in (([], 0), ([], 1), (["--force"], 0), (["--output", "new/folder"], 0)):
        monkeypatch.setattr(sys, "argv", ["asperity", command, str(INPUT / f"{name}.toml"), *options])
        with pytest.raises(SystemExit) as end:
            commands.asperity()
        assert end.value.code == status
    out, err = capsys.readouterr()
    assert f"{name}.csv: found a file of that name, expected none, another --output, or --force" in err
    assert 0.75 < float(re.search(r"Hertz pressure up to (\S+) GPa", out)[1]) < 1.2
    columns, case = table_of(f"{name}.csv"), f90nml.read(f"new/folder/{name}.nml")
    assert case["history"] == {"file": f"{name}.csv", "interpolation": "linear", "periodic": command == "cam"}
    assert (case["case"]["problem"], case["time"]["transient"], case["lubricant"]["viscosity"]) == ("ehl_line", True, 0.017)
    assert all(np.all(columns[i] > 0) for i in (1, 4))


def test_paths_and_keys_of_the_namelist(write, tmp_path):
    tables = '[surface_1]\nshape = "file"\nfile = "rough.csv"\n[history]\ninterpolation = "cubic"\n'
    assert write("gear", GEAR, "--output", "out", tables=tables)[0] == 0
    case = f90nml.read(tmp_path / "out" / "mesh.nml")
    assert case["surface_1"]["file"] == "../rough.csv"
    assert case["history"] == {"file": "mesh.csv", "interpolation": "cubic", "periodic": False}
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert write("gear", GEAR, "--output", "file/folder")[0] == 3


def put(group: h5py.Group, name: str, values: object, units: str = "1", scale: float = 1.0) -> None:
    """A dataset with the attributes that every dataset has."""
    dataset = group.create_dataset(name, data=values)
    dataset.attrs["long_name"] = name.replace("_", " ")
    dataset.attrs["si_units"] = units
    dataset.attrs["si_scale"] = scale


def made_result(heat, bar=0.01, cycles=1):
    """mesh.h5: a result of the table mesh.csv with h_min at a fourth of it, and this heat [W/m] of its load, speeds and radius."""
    time, *series = table_of()
    span, path = time[-1], Path("mesh.h5")
    with h5py.File(path, "w") as file:
        file.attrs.update(program="asperity", version="0", problem="ehl_line", converged=1)
        file.create_group("scaling").attrs["time"] = span
        put(file.create_group("solution"), "x", np.zeros(3))
        put(file.create_group("transient"), "time", np.concatenate([time / span + i for i in range(cycles)]), "s", span)
        for name, values in zip(("load_per_length", "speed_1", "speed_2", "reduced_radius"), series, strict=True):
            put(file["transient"], name, np.tile(values, cycles))
        file.create_group("summary").attrs["statistics_from"] = cycles - 1.0
        values = 1e-7, (cycles - 0.75) * span, np.trapezoid(heat(*series), time) / span
        for name, unit, value in zip(("h_min", "h_min_time", "mean_power"), ("m", "s", "W/m"), values, strict=True):
            put(file["summary"], name, value, unit)
            file["summary"][name].attrs["error_estimate"] = bar * value
    seal(path)


@pytest.mark.parametrize(("keys", "angles"), [("", ()), ("profile_shift = [0.3, -0.1]\nhelix_angle_deg = 15\n", (15, (0.3, -0.1)))])
def test_loss_and_places_of_a_mesh(write, keys, angles):
    """With a friction coefficient f: P_loss/P = pi f (1/z1 + 1/z2) (1 - e + e1^2 + e2^2)/cos b_b. Jumps of load are ramps."""
    keys = f"{GEAR}load_share_at_ends = 0.5\n{keys}"
    assert write("gear", keys)[0] == 0
    made_result(lambda load, u1, u2, _: 0.05 * load * np.abs(u2 - u1))
    words = write("gear", keys, "--result", "mesh.h5")[1]
    assert words.endswith("error 1 %\n"), words
    mesh = duty.mesh_of(4e-3, (20, 40), 20 * DEGREE, *(angle * DEGREE for angle in angles[:1]), *angles[1:])
    pitch = mesh.base_radii[0] * math.tan(mesh.working_angle)
    e1, e2 = (mesh.end - pitch) / mesh.base_pitch, (pitch - mesh.start) / mesh.base_pitch
    expected = math.pi * 0.05 * (1 / 20 + 1 / 40) / math.cos(mesh.base_helix_angle) * (1 - e1 - e2 + e1**2 + e2**2)
    loss, share, power = (float(re.search(rf"([\d.]+) {unit}", words.splitlines()[-1])[1]) for unit in ("W", "%", "kW"))
    assert [share, loss, power] == pytest.approx([100 * expected, share * power * 10, 300 * 1500 * math.pi / 30e3], rel=2e-3)
    h_min, s = re.search(r"h_min +100 nm +1 % +\S+ (.*)", words)[1].split(), mesh.start + (mesh.end - mesh.start) / 4
    sides = list(zip((s, mesh.line - s), mesh.base_radii, strict=True))
    places = [(s - pitch) * 1e3, *(leg / base / DEGREE for leg, base in sides), *(math.hypot(*side) * 1e3 for side in sides)]
    np.testing.assert_allclose(np.array(h_min, dtype=float), places, atol=5.1e-3)


def test_loss_and_angles_of_a_cam(write):
    angles = np.linspace(-90, 270, 73)
    keys, lift = f'lift = "lift.csv"\n{CAM}', lift_of(angles, 4 * (1 - np.cos(angles * DEGREE)))
    assert write("cam", keys, lift=lift)[0] == 0
    made_result(lambda load, *_: 700 + 0 * load, math.nan, 3)
    h_min = r"\nh_min +100 nm +not known +15 +0\.00\nloss of the contact: 7 W, a mean torque of 66\.85 mN m; error not known\n$"
    assert re.search(h_min, write("cam", keys, "--result", "mesh.h5", lift=lift)[1])
    others = {"1000": "extremes of 60 ms, expected those of 59.46 ms", "16": "another speed_1", "400": "another load_per_length"}
    for old, found in others.items():
        status, words = write("cam", keys.replace(old, f"{old[:-1]}9"), "--result", "mesh.h5", lift=lift)
        assert (status, f"found {found}" in words) == (1, True), words
    assert [write("cam", keys, "--result", name, lift=lift)[0] for name in ("mesh.csv", "none.h5")] == [1, 3]

"""Input that must be accepted, what users know in place of the solver's values, the template, the key table, the command line."""

import random
import re
import tomllib

import h5py
import pytest
from cases import MOES, ROOT, STEADY, TRANSIENT, ended, text


def check(asperity, folder, content):
    path = folder / "case.nml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
    done = asperity("--check", path, seconds=10)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"{path}: no findings\n"


def ridges(old, amplitudes, positions, count=2):
    """The passage with several ridges, their amplitudes written in place of `old`."""
    return TRANSIENT.replace(old, amplitudes).replace("= 1e-4", f"= {count}*1e-4").replace("-2.1", positions)


FORMS = {
    "byte_order_mark": "\ufeff" + STEADY,
    "utf_8_title": STEADY.replace("Öl", "Öl 油 µm 🛢"),
    "crlf": STEADY.replace("\n", "\r\n"),
    "tabs": STEADY.replace(" ", "\t"),
    "no_line_feed_at_end": STEADY.rstrip(),
    "point_at_end": STEADY.replace("1e5", "100000."),
    "point_at_start": STEADY.replace("1e5", ".1e6"),
    "integer_for_real": STEADY.replace("1e5", "+100000"),
    "trailing_comma": STEADY.replace("1e5", "1e5,"),
    "repeat_of_one": STEADY.replace("1e5", "1*1e5"),
    "equals_on_next_line": STEADY.replace("= 1e5", "\n = 1e5"),
    "closed_by_end": STEADY.replace("1e5 /", "1e5 ! [N/m]\n&end"),
    "empty_title": STEADY.replace("'Öl, smooth'", "''"),
    "array_tail": ridges("amplitude = 0.2e-6", "amplitude = 1e-7 amplitude(2) = 2e-7, 3e-7", "3*-2.0", 3),
    "subscript_with_blanks": ridges("amplitude =", "amplitude ( 1 : 1 ) =", "-2.0", 1),
    "shapes_mixed": ridges("0.2e-6", "1e-7, 2e-7", "2*-2.0").replace("'feature'", "'feature', 'sinusoid'"),
    "one_field": TRANSIENT + "&output fields = 'pressure' profile_stride = 3 /\n",
    "still_rough_steady": STEADY.replace("speed_1 = 0.1", "speed_1 = 0")
    + "&surface_1 shape = 'sinusoid', amplitude = 1e-8, wavelength = 1e-4 /\n",
    "concave_body": STEADY.replace("radius_2 = 2.0", "radius_2 = -0.02"),
    "alpha_and_p0": STEADY.replace("roelands_z = 0.6", "pressure_viscosity = 2.1e-8"),
    "three_that_agree": STEADY.replace("roelands_z = 0.6", "roelands_z = 0.6, pressure_viscosity = 2.3345e-8"),
    "moes_roelands": MOES.replace("'barus'", "'roelands'").replace("'constant'", "'dowson_higginson'"),
    "moes_isoviscous": MOES.replace("moes_l = 5.0", "moes_l = 0"),
    "solver_settings": STEADY + "&solver method = 'fas_block_jacobi', tolerance = 1e-7, levels = 3, relaxation = 0.7 /\n",
}


@pytest.mark.parametrize("name", FORMS)
def test_form_is_accepted(asperity, tmp_path, name):
    check(asperity, tmp_path, FORMS[name])


def test_a_load_is_that_of_the_length_of_the_contact(solve_all):
    over_length = STEADY.replace("load_per_length = 1e5", "load = 2e3").replace("speed_1 =", "contact_length = 0.02, speed_1 =")
    folder = solve_all({"whole": over_length, "per_length": STEADY})
    films = []
    for name in ("whole", "per_length"):
        with h5py.File(folder / f"{name}.h5") as file:
            assert file["scaling"].attrs["load_per_length"] == pytest.approx(1e5, rel=1e-14)
            films.append(file["summary/h_min"][()])
    assert films[0] == films[1]


SHEETS = {
    "viscosity_grade = 46, temperature = 60": "mineral oil ISO VG 46, viscosity index 95, at 60 degC: 20.4 mm2/s, 0.0177 Pa s",
    "viscosity_grade = 46, viscosity_index=150, temperature=40": "oil ISO VG 46, viscosity index 150, at 40 degC: 46.0 mm2/s, 0.04",
    "kinematic_viscosity = 404, 28, temperature = 60": "oil of 404 mm2/s at 40 degC, 28 at 100 degC, at 60 degC: 132 mm2/s, 0.115",
    "kinematic_viscosity = 20.4, density = 900": "oil of 20.4 mm2/s, 0.0184 Pa s",
}


@pytest.mark.parametrize("sheet", SHEETS)
def test_an_oil_by_its_data_sheet_is_that_of_its_viscosity(solved_case, run_case, tmp_path, sheet):
    """Bit for bit, thermal_viscosity as stated; the words stand in the log and in the result."""
    assert f"sheet.nml:5: {SHEETS[sheet]}" in run_case(STEADY.replace("viscosity = 0.14", sheet), name="sheet").stderr
    with h5py.File(tmp_path / "sheet.h5") as file:
        oil = dict(file["input/effective/lubricant"].attrs)
        film = file["solution/film_thickness"][()]
        assert SHEETS[sheet] in text(file["report/note"][()])
    assert float(SHEETS[sheet].split("mm2/s, ")[-1].split()[0]) == pytest.approx(oil["viscosity"], rel=5e-3)
    assert (oil["thermal_viscosity"] == 0.04) == ("temperature" not in sheet)
    with solved_case(STEADY.replace("viscosity = 0.14", f"viscosity = {oil['viscosity']}")) as file:
        assert (file["solution/film_thickness"][()] == film).all()


PROBLEMS = ["ehl_line", "ehl_point", "dry_line", "dry_area"]


@pytest.mark.parametrize("problem", PROBLEMS)
def test_template_names_every_key(asperity, problem):
    template = asperity("--template", problem).stdout
    for line in asperity("--keys-markdown").stdout.splitlines():
        if line.startswith("| `"):
            key = line.split("`")[1]
            problems = re.search(r"\(((?:ehl_line|ehl_point|dry_line|dry_area| )+)\) \|$", line)
            assert f" {key} = " in template or (problems and problem not in problems[1].split())


@pytest.mark.parametrize("page", ["--keys", "--keys-markdown", "--template ehl_line", "--template dry_line"])
def test_keys_of_methods_stand_apart(asperity, page):
    """Behind all others of their group, commented in a template; &surface_2 refers to &surface_1."""
    groups = re.split(r"(?m)^(?:## |! )?&(?=\w+(?: |$))", asperity(*page.split()).stdout)
    (solver,) = (group for group in groups if group.startswith("solver"))
    others, _, methods = solver.partition("Keys of methods; the defaults are right for nearly everyone:\n")
    for key in ["method", "tolerance", "max_cycles"] + ["smoother", "levels", "start"] * (page != "--template dry_line"):
        assert re.search(rf"\b{key}\b", methods)
        assert not re.search(rf"(?m)^\W*{key}\b", others)
    assert ("film_floor" in others) == (page != "--template dry_line")
    assert page[:10] != "--template" or "\n   " not in methods.split("/\n")[0]
    (second,) = (group for group in groups if group.startswith("surface_2"))
    assert "the keys of &surface_1" in second.replace("The keys are those", "the keys")
    assert not re.search(r"\bshape\b", second)


def test_commented_keys_of_the_template_are_good_alternatives(asperity, tmp_path):
    template = asperity("--template", "ehl_line").stdout
    for given, other in [
        (["radius_1", "radius_2"], ["reduced_radius"]),
        (["youngs_modulus_1", "youngs_modulus_2", "poisson_ratio_1", "poisson_ratio_2"], ["reduced_modulus"]),
        (["load_per_length"], ["hertz_pressure"]),
        (["roelands_z"], ["pressure_viscosity"]),
    ]:
        text = template
        for key in given:
            text = text.replace(f"\n   {key} =", f"\n!  {key} =")
        for key in other:
            text = text.replace(f"\n!  {key} =", f"\n   {key} =")
        check(asperity, tmp_path, text)


def test_manual_keys_and_help(asperity):
    page = (ROOT / "docs" / "input.md").read_text(encoding="utf-8")
    assert asperity("--keys-markdown").stdout == page, "make the page again: asperity --keys-markdown > docs/input.md"
    lines = asperity("--keys").stdout.splitlines()
    assert len(lines) > 100
    assert max(map(len, lines)) <= 100
    done = ended(asperity("--help"))
    words = "Examples|--output|--threads|--check|--resume|--quiet|--template|--keys|--version|Exit status"
    for word in words.split("|"):
        assert word in done.stdout


def test_one_version_everywhere(asperity):
    version = tomllib.loads((ROOT / "fpm.toml").read_text(encoding="utf-8"))["version"]
    assert asperity("--version").stdout.startswith(f"asperity {version} (commit ")
    for name, pattern in {
        "src/base/build_info.f90": r"program_version = '(.+)'",
        "CITATION.cff": r"^version: [\"']?(.+?)[\"']?$",
        "docs/CHANGELOG.md": r"^## \[?(\d\S*?)\]?(?: |$)",
    }.items():
        assert re.search(pattern, (ROOT / name).read_text(encoding="utf-8"), re.M)[1] == version, name


BAD_CALLS = {
    "nothing": ([], "found no namelist file, expected at least one"),
    "check_of_nothing": (["--check"], "found no namelist file"),
    "unknown_option": (["--chek", "a.nml"], "found the unknown option --chek; did you mean --check?"),
    "output_without_folder": (["a.nml", "--output"], "found --output without a value"),
    "threads_word": (["a.nml", "--threads", "two"], "found --threads two, expected a number of threads"),
    "no_threads": (["a.nml", "--threads", "0"], "found --threads 0, expected a number of threads"),
    "resume_of_nothing": (["--resume"], "found no namelist file"),
    "unknown_template": (["--template", "wet"], "found --template wet, expected ehl_line, ehl_point, dry_line or dry_area"),
    "no_template": (["--template"], "found --template without a value"),
    "table_of_nothing": (["table"], "found no result"),
    "unknown_form": (["table", "a.h5", "--format", "xml"], "found --format xml, expected text,"),
    "profiles_of_two": (["table", "a.h5", "b.h5", "--profiles"], "with one result"),
    "profiles_of_a_case": (["a.nml", "--profiles"], "with one result"),
    "two_actions": (["--keys", "--version"], "found --keys and --version, expected one of them"),
}


@pytest.mark.parametrize(("arguments", "message"), BAD_CALLS.values(), ids=BAD_CALLS)
def test_bad_call(asperity, arguments, message):
    done = ended(asperity(*arguments), 1)
    assert done.stdout == ""
    assert message in done.stderr


def test_output_key_is_relative_to_the_namelist_and_output_folder_wins(asperity, tmp_path):
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "case.nml").write_text(STEADY.replace("&case", "&case output = 'mine.h5'"), encoding="utf-8")
    for options, result in (((), "a/mine.h5"), (("--output", "."), "mine.h5")):
        assert asperity("a/case.nml", "--quiet", *options).returncode == 0
        assert (tmp_path / result).is_file()


CASE = STEADY.replace("intervals = 256", "intervals = 128") + "&accuracy error_bars = .false. /\n&output adequacy = .false. /\n"
SPEEDS = "speed_1 = 0.1, speed_2 = 1.1"
RADII = "radius_1 = 0.01, radius_2 = 2.0"
ROELANDS = "roelands_z = 0.6, roelands_p0 = 1.98e8"
PARABOLA = """&case problem = 'dry_area' /
&bodies {}, youngs_modulus_1 = 210e9, poisson_ratio_1 = 0.3 /
&load load = 5 /
&surface_1 shape = 'parabola' /
&domain length_x = 4e-4, length_y = 4e-4, intervals_x = 32, intervals_y = 32, periodic = .false. /
"""


def fields(found):
    return {name: value for name, value in found.items() if name.startswith(("solution", "summary", "scaling"))}


def assert_same(one, other, rel):
    assert one.keys() == other.keys()
    for name, value in one.items():
        if getattr(value, "dtype", None) is not None and value.dtype.kind == "f":
            assert other[name] == pytest.approx(value, rel=rel, abs=rel, nan_ok=True), name


def test_mean_speed_and_slide_to_roll_are_the_two_speeds(told_case):
    """u1 = U (1 - S/2), u2 = U (1 + S/2), of either sign and beyond simple sliding, where a surface runs backwards."""
    chance = random.Random(17)
    for mean, slide in [(0.6, 5 / 3), (0.6, 0.0), (0.6, -2.0)] + [
        (chance.uniform(0.1, 2), chance.uniform(-3, 3)) for _ in range(3)
    ]:
        first, second = mean * (1 - slide / 2), mean * (1 + slide / 2)
        assert second - first == pytest.approx(slide * mean)
        two, _ = told_case(CASE.replace(SPEEDS, f"speed_1 = {first!r}, speed_2 = {second!r}"))
        way = f"entrainment_speed = {mean!r}" + (f", slide_to_roll = {slide!r}" if slide else "")
        one, _ = told_case(CASE.replace(SPEEDS, way))
        assert_same(fields(one), fields(two), 1e-9)
        assert one["scaling@slide_to_roll"] == pytest.approx(slide, abs=1e-12)
        kept = [float(one[f"input/effective/bodies@{key}"]) for key in ("entrainment_speed", "slide_to_roll", "speed_1", "speed_2")]
        assert kept == pytest.approx([mean, slide, first, second], abs=1e-12)


@pytest.mark.parametrize("key", ["radius_1", "radius_2"])
def test_a_plane_has_no_curvature(told_case, key):
    reduced, _ = told_case(CASE.replace(RADII, "reduced_radius = 0.01"))
    plane, _ = told_case(CASE.replace(RADII, f"{key} = 0.01, plane = .true."))
    assert_same(fields(reduced), fields(plane), 0)
    ball, _ = told_case(PARABOLA.format("reduced_radius = 0.01"))
    dry, _ = told_case(PARABOLA.format(f"{key} = 0.01, plane = .true."))
    assert_same(fields(ball), fields(dry), 0)


@pytest.mark.parametrize("alpha", [1.2e-8, 2.2e-8])
def test_alpha_alone_takes_the_usual_p0(asperity, told_case, alpha):
    both, said = told_case(CASE.replace(ROELANDS, f"pressure_viscosity = {alpha}, roelands_p0 = 1.96e8"))
    assert "given alone" not in said
    alone, said = told_case(CASE.replace(ROELANDS, f"pressure_viscosity = {alpha}"))
    assert_same(fields(both), fields(alone), 0)
    z = float(alone["input/effective/lubricant@roelands_z"])
    assert float(alone["input/effective/lubricant@roelands_p0"]) == 1.96e8
    words = f"&lubricant pressure_viscosity is given alone: Roelands with P0 = 1.96E+08 Pa, z = {z:.4f}"
    assert f"case.nml:5: {words}\n" in said
    assert text(alone["report/note"]) == words
    assert f"case.nml:5: {words}\n" in asperity("--check", "case.nml").stdout

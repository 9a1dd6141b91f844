"""Values that no usual contact has are told: what is shipped is silent, slips of a unit are not."""

import random
import re

import h5py
import pytest
from cases import called, ended, members, text, write
from conftest import ROOT

SHIPPED = sorted((ROOT / "input").glob("*.nml")) + sorted((ROOT / "input" / "scenes").glob("*.nml"))
SLIPS = 1e3, 1e-3, 1e6
WORDS = "is unusual, typical is"
MINIMAL = (ROOT / "input" / "minimal.nml").read_text()
NUMBER = r"[-+]?[0-9.]+(?:e[-+]?[0-9]+)?"


@pytest.mark.parametrize("path", [*SHIPPED, *(ROOT / "input" / "duty").glob("*.nml")], ids=lambda path: path.stem)
def test_shipped_inputs_are_silent(asperity, path):
    assert asperity("--check", path).stdout == f"{path}: no findings\n"


@pytest.mark.path
@pytest.mark.parametrize("problem", ["ehl_line", "ehl_point", "dry_line", "dry_area"])
def test_templates_are_silent(ranges, asperity, tmp_path, problem):
    """Their comments too: every example of a key is a typical value of it."""
    template = asperity("--template", problem).stdout
    write(tmp_path, "case.nml", template)
    assert asperity("--check", "case.nml").stdout == "case.nml: no findings\n"
    group = ""
    for line in template.splitlines():
        group = (re.findall(r"^(?:! )?&(\w+)$", line) or [group])[0]
        entry = re.match(rf"!?  +(\w+) = ({NUMBER}(?:, {NUMBER})*)(?: |$)", line)
        lowest, largest = ranges.get((group, entry[1]) if entry else None, (0.0, 1e99))
        for value in re.findall(NUMBER, entry[2]) if entry else []:
            assert float(value) == 0 or lowest <= abs(float(value)) <= largest, line


@pytest.fixture(scope="module", name="ranges")
def _ranges(program):
    """{(group, key): (lowest, largest)} of the page of keys."""
    found, group = {}, ""
    for line in called([program, "--keys-markdown"]).stdout.splitlines():
        group = (re.findall(r"^## &(\w+)", line) or [group])[0]
        if row := re.match(r"\| `(\w+)`.*, typical ([0-9.e+-]+) to ([0-9.e+-]+) \|", line):
            found[group, row[1]] = float(row[2]), float(row[3])
    return found | {("surface_2", key): limits for (group, key), limits in found.items() if group == "surface_1"}


def slips(ranges):
    """Every physical key of every shipped input, with each slip: (file, text, group, key, values)."""
    for path in SHIPPED:
        group = ""
        lines = path.read_text().splitlines(keepends=True)
        for i, line in enumerate(lines):
            group = (re.findall(r"^ *&(\w+)", line) or [group])[0]
            entry = re.match(rf" *(\w+) = ({NUMBER}(?:, {NUMBER})*)", line)
            if not entry or (group, entry[1]) not in ranges:
                continue
            for factor in SLIPS:
                values = [factor * float(value) for value in entry[2].split(",")]
                changed = f"   {entry[1]} = {', '.join(map(repr, values))}\n"
                whole = "".join([*lines[:i], changed, *lines[i + 1 :]])
                yield path, re.sub(r"file = '", f"file = '{path.parent}/", whole), group, entry[1], values


def told(asperity, folder, ranges, slip):
    """'told', 'refused' or 'silent': what the program says of a slip; it must be told if it leaves the typical range."""
    path, content, group, key, values = slip
    write(folder, "slip.nml", content)
    done = asperity("--check", "slip.nml")
    if done.returncode == 1:
        return "refused"
    lowest, largest = ranges[group, key]
    is_typical = all(value == 0 or lowest <= abs(value) <= largest for value in values)
    is_told = f"&{group} {key}: " in done.stdout and WORDS in done.stdout
    assert is_told != is_typical, (path.name, group, key, values, done.stdout)
    return "told" if is_told else "silent"


def test_slips_of_a_unit_are_told(ranges, asperity, tmp_path):
    """Random ones, all of them by night."""
    every = list(slips(ranges))
    sample = random.Random(17).sample(every, members(100, len(every)))
    outcomes = [told(asperity, tmp_path, ranges, slip) for slip in sample]
    print({outcome: outcomes.count(outcome) for outcome in set(outcomes)})
    assert outcomes.count("told") > 10
    assert outcomes.count("told") + outcomes.count("refused") > 0.6 * len(sample)


@pytest.mark.path
def test_unusual_values_stand_in_log_and_result(asperity, tmp_path):
    write(tmp_path, "case.nml", MINIMAL.replace("= 0.01 ", "= 12.0 ").replace("viscosity = 0.14", "viscosity = 30"))
    line = "case.nml:7: &bodies reduced_radius: 12 m is unusual, typical is 1e-4 to 5 m; is it in mm?\n"
    assert line in ended(asperity("case.nml")).stderr
    assert asperity("case.nml", "--quiet").stderr == ""
    with h5py.File(tmp_path / "case.h5") as file:
        note = text(file["report/note"][()])
    assert note.startswith("&bodies reduced_radius: 12 m is unusual, typical is 1e-4 to 5 m; &lubricant viscosity: 30 Pa s is")
    content = (ROOT / "input" / "dry_sphere.nml").read_text().replace("hertz_pressure = 1e9", "hertz_pressure = 3e4")
    write(tmp_path, "case.nml", content.replace("reduced_radius = 0.005", "reduced_radius = 8"))
    done = asperity("case.nml")
    assert "&bodies reduced_radius: 8 m is unusual, typical is 1e-4 to 5 m; is it in mm?" in done.stderr
    with h5py.File(tmp_path / "case.h5") as file:
        assert "&load hertz_pressure: 30000 Pa is unusual" in text(file["report/note"][()])
    content = (ROOT / "input" / "dry_area.nml").read_text()
    changed = re.sub(r"mean_pressure = [^!\n]*", "mean_pressure = 1,5e8 ", content)
    assert changed != content
    write(tmp_path, "case.nml", changed)
    line = "&load mean_pressure: 1 Pa is unusual, typical is 1e4 to 1e10 Pa; numbers have a decimal point, not a comma\n"
    assert line in asperity("--check", "case.nml").stdout


@pytest.mark.parametrize("signed", ["speed_1 = 0.0", "speed_1 = -0.3"])
def test_sign_and_nothing_are_usual(asperity, tmp_path, signed):
    write(tmp_path, "case.nml", MINIMAL.replace("speed_1 = 0.6", signed))
    assert asperity("--check", "case.nml").stdout == "case.nml: no findings\n"

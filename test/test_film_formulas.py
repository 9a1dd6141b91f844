"""The guide's table of film formulas beside computed films: each row again."""

import re

import h5py
import pytest
from cases import write
from conftest import ROOT

MINIMAL = (ROOT / "input" / "minimal.nml").read_text()
ROELANDS = "   roelands_z = 0.6\n   roelands_p0 = 1.98e8         ! [Pa]\n"
SLOW, FAST = (["bodies.speed_1=" + speed, "bodies.speed_2=" + speed] for speed in ("0.1", "3"))
CASES = {
    "input/minimal.nml": (MINIMAL, []),
    "p_h = 1 GPa": (MINIMAL, ["load.hertz_pressure=1e9"]),
    "speeds of 0.1 m/s": (MINIMAL, SLOW),
    "speeds of 3 m/s": (MINIMAL, FAST),
    "p_h = 1.5 GPa, speeds of 0.1 m/s": (MINIMAL, [*SLOW, "load.hertz_pressure=1.5e9"]),
    "constant density": (MINIMAL, ["lubricant.density_law=constant"]),
    "constant density, Barus": (
        MINIMAL.replace(ROELANDS, "   viscosity_law = 'barus', pressure_viscosity = 2.3345e-8\n"),
        ["lubricant.density_law=constant"],
    ),
    "the Eyring oil of the template": ("", []),
}


def rows():
    page = (ROOT / "docs" / "guide.md").read_text(encoding="utf-8")
    table = page.split("## What film formulas give\n")[1].split("\nThe 12 to 26 %")[0]
    return {cells[1]: cells[2:6] for cells in (re.split(r" *\| *", line) for line in table.splitlines()[6:] if line)}


def test_all_rows_are_cases():
    assert rows().keys() == CASES.keys()


@pytest.mark.parametrize("name", CASES)
def test_row(asperity, tmp_path, name):
    content, entries = CASES[name]
    write(tmp_path, "a.nml", content or asperity("--template", "ehl_line").stdout)
    sets = [word for entry in [*entries, "accuracy.target=1e-3", "case.output=a.h5"] for word in ("--set", entry)]
    assert asperity("a.nml", "--quiet", *sets).returncode == 0
    with h5py.File(tmp_path / "a.h5") as file:
        scales, summary = file["scaling"].attrs, file["summary"]
        radius, modulus = scales["reduced_radius"], scales["reduced_modulus"]
        speed = scales["viscosity"] * scales["speed_sum"] / 2 / (modulus * radius)
        material = scales["alpha_bar"] / scales["hertz_pressure"] * modulus
        load = scales["load_per_length"] / (modulus * radius)
        formulas = {
            "h_min": 2.65 * speed**0.7 * material**0.54 * load**-0.13 * radius,
            "h_central": 3.06 * speed**0.69 * material**0.56 * load**-0.10 * radius,
        }
        shown = rows()[name]
        for (film, formula), said, deviation in zip(formulas.items(), shown[::2], shown[1::2], strict=True):
            computed = summary[film][()]
            assert float(said.split()[0]) == pytest.approx(1e9 * computed, rel=1e-3)
            assert float(deviation.split()[0]) == pytest.approx(100 * (formula / computed - 1), abs=0.6)

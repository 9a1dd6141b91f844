"""Outlets that cut the film off: noted, their effect part of the error estimates; the program's own moves out."""

import h5py
import pytest
from cases import AT_REST, TRANSIENT, ended, text, write

# Rigid cylinders nearly: the film ruptures at X = 2.9, far behind the end of the contact.
LIGHT = """&case problem = 'ehl_line' /
&moes moes_m = 0.3, moes_l = 5.0, velocity = 'sum' /
&lubricant viscosity_law = 'barus', density_law = 'constant' /
&domain x_inlet = -40.0 OUTLET /
"""
FIGURES = ("h_min", "h_central", "p_max")


def solve(asperity, folder, case):
    """Runs a case that converges: figures with value and error of the domain, note (or None), x_outlet [half-widths], log."""
    write(folder, "case.nml", case)
    done = ended(asperity("case.nml", "--verbose"))
    with h5py.File(folder / "case.h5") as file:
        figures = {name: (file["summary"][name][()], file["summary"][name].attrs["error_domain"]) for name in FIGURES}
        note = text(file["report/note"][()]) if "report/note" in file else None
        return figures, note, float(file["input/effective/domain"].attrs["x_outlet"]), " ".join((done.stderr + done.stdout).split())


@pytest.mark.path
def test_outlet_ahead_of_rupture_is_noted_and_part_of_the_estimate(asperity, tmp_path):
    # both grids have the spacing of 41.5/1024
    cut, note, _, log = solve(asperity, tmp_path, LIGHT.replace("OUTLET", ", x_outlet = 1.5, intervals = 1024"))
    whole, no_note, _, _ = solve(asperity, tmp_path, LIGHT.replace("OUTLET", ", x_outlet = 43.0, intervals = 2048"))
    assert note.startswith("the film is still under pressure at the outlet X = 1.5")
    assert note.endswith("without x_outlet the program takes 3.448")
    assert note in log
    assert no_note is None
    for name in FIGURES:
        value, error = cut[name]
        true = abs(value - whole[name][0])
        assert true > 0.005 * value
        assert true < error < 10 * true


@pytest.mark.parametrize("given", ["&accuracy target = 1e-3 /", "&accuracy error_bars = .false. /"])
def test_a_wanted_accuracy_is_not_met_in_silence(asperity, tmp_path, given):
    figures, note, _, _ = solve(asperity, tmp_path, LIGHT.replace("OUTLET", ", x_outlet = 1.5") + given)
    assert note.startswith("the film is still under pressure at the outlet")
    if "target" in given:
        assert figures["h_min"][1] > 1e-2 * figures["h_min"][0]
    else:
        assert "is not known" in note


def test_chosen_outlet_lies_behind_rupture(asperity, tmp_path):
    for grid, place in ("even", 3.448), ("graded", 5.896):
        figures, note, outlet, _ = solve(
            asperity, tmp_path, LIGHT.replace("OUTLET", f", grid = '{grid}'").replace("-40.0", "-400.0")
        )
        assert note is None
        assert outlet == pytest.approx(place, abs=1e-3)
        assert figures["h_min"][1] < 1e-3 * figures["h_min"][0]
    # the pressure reaches to X = 1.56 over the ridge, where smooth surfaces would have an outlet at 1.52
    ridge = "&surface_1 shape = 'feature', amplitude = 0.21e-6, wavelength = 4.2e-5, position = 1.57 /\n"
    case = AT_REST + ridge
    open_case = case.replace("&domain x_inlet = -4.0, x_outlet = 1.5, intervals = 256 /\n", "")
    _, note, outlet, _ = solve(asperity, tmp_path, open_case)
    assert note is None
    assert outlet > 2.0
    with h5py.File(tmp_path / "case.h5") as file:
        assert file["solution/pressure"][-2] == 0.0
    lines = asperity("--template", "ehl_line").stdout.splitlines()
    assert not [line for line in lines if line.startswith(("   x_inlet", "   x_outlet"))]


def test_outlet_in_time_is_watched_at_every_step(asperity, tmp_path):
    ridge = TRANSIENT.replace("time_step = 0.05", "time_step = 0.02").replace("position = -1.5", "position = -0.5")
    cut, note, _, _ = solve(asperity, tmp_path, ridge.replace("x_outlet = 1.5", "x_outlet = 1.05"))
    whole, no_note, _, _ = solve(asperity, tmp_path, ridge.replace("x_outlet = 1.5", "x_outlet = 6.1").replace("256", "512"))
    assert "the film is still under pressure at the outlet X = 1.05" in note
    assert "outlet" not in no_note
    for name in FIGURES:
        assert abs(cut[name][0] - whole[name][0]) < cut[name][1]

"""Features and sinusoids that are narrow for the grid: seen by the chosen grid, told on a given one."""

import h5py
import numpy as np
import pytest
from cases import AT_REST, ended, text, write

OPEN = AT_REST.replace(", intervals = 256", "")
WAVE = "&surface_1 shape = '{}', amplitude = 0.1e-6, wavelength = {}, position = 0.0 /\n"
DX = 5.5 / 256 * 1.05797e-4


def solved(asperity, tmp_path, content):
    write(tmp_path, "case.nml", content)
    done = ended(asperity("case.nml", "--verbose"))
    with h5py.File(tmp_path / "case.h5") as file:
        h_min = file["summary/h_min"]
        note = text(file["report/note"][()]) if "report/note" in file else ""
        reason = text(h_min.attrs["no_estimate"]) if "no_estimate" in h_min.attrs else ""
        return h_min[()], h_min.attrs["error_estimate"], file["report/nodes_per_wave"][()], note, reason, done.stderr + done.stdout


@pytest.mark.parametrize("shape", ["feature", "sinusoid"])
def test_chosen_grid_sees_a_wave_of_a_spacing(asperity, tmp_path, shape):
    """Its crests all lie at the same place between the nodes of 256 intervals, where the sinusoid is a plane.

    Behind the outlet at 1.5 the sinusoid would carry on under pressure and add to the friction by 0.6 %, which is noted.
    """
    h_min, error, nodes, note, _, _ = solved(asperity, tmp_path, OPEN + WAVE.format(shape, DX))
    assert 32 <= nodes <= 40
    if shape == "feature":
        assert note == ""
    else:
        assert note.startswith("the film is still under pressure at the outlet X = 1.500, which changes its")
    fine = AT_REST.replace("= 256", "= 65536") + "&accuracy error_bars = .false. /\n" + WAVE.format(shape, DX)
    truth = solved(asperity, tmp_path, fine)[0]
    assert abs(h_min - truth) < min(error, 0.02 * truth)


@pytest.mark.path
def test_coarse_grid_is_told_and_has_no_estimate(asperity, tmp_path):
    _, error, nodes, note, reason, told = solved(asperity, tmp_path, AT_REST + WAVE.format("feature", 8.01 * DX))
    assert nodes == pytest.approx(8.01, rel=1e-4)
    assert note == "the finest wave of the surfaces has 8.01 nodes, 32 are needed: 1024 intervals"
    assert note in " ".join(told[told.index("dimensionless") :].split())
    assert np.isnan(error)
    assert reason == "the finest wave of the surfaces has 8.01 nodes, an estimate needs 16"

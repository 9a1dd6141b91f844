"""Tilt and form of measured heights are subtracted, and what was subtracted is said."""

import h5py
import numpy as np
import pytest
from cases import STEADY, ended, text, write
from dry_cases import HEIGHTS, case_text, profile, solve, write_heights

LENGTH = 4e-3
FILE = "shape = 'file', file = 'z.csv'{}"


def rough(nodes=1000):
    """Roughness of a tenth of a micrometre without tilt and curvature, which does not close [m]."""
    x = np.linspace(-1, 1, nodes)
    z = 1e-7 * np.random.default_rng(7).standard_normal(nodes) + 2e-7 * np.cos(43 * x + 1)
    return x, z - np.polyval(np.polyfit(x, z, 2), x)


def write_csv(folder, z):
    table = np.column_stack([np.linspace(0, LENGTH, len(z)), z])
    np.savetxt(folder / "z.csv", table, delimiter=",", header="x_m,z_m", comments="", fmt="%.17e")


def dry(asperity, folder, z, keys="", domain="", bodies=""):
    write_csv(folder, z)
    file = solve(asperity, folder, FILE.format(keys), [5e5], bodies, domain)
    with file:
        heights = file["solution/height_undeformed"][()]
        surface = dict(file["input/effective/surface_1"].attrs)
        note = text(file["report/note"][()]) if "note" in file["report"] else ""
        return heights, surface, note, file["sweep/contact_area_fraction"][0], file["sweep/mean_separation"][0]


@pytest.mark.parametrize("domain", ["", "&domain periodic = .false. /"])
def test_tilt_is_taken_off_and_told(asperity, tmp_path, domain):
    """5 um over 4 mm, in the contact as before the tilt."""
    x, z = rough()
    if domain:
        z = z - 2e-5 * x**2  # a crowned one, which an open domain holds
    plain, _, _, area, separation = dry(asperity, tmp_path, z, domain=domain)
    heights, surface, note, tilted_area, tilted_separation = dry(asperity, tmp_path, z + 2.5e-6 * x + 3e-6, domain=domain)
    np.testing.assert_allclose(heights, plain, rtol=0, atol=1e-19)
    assert tilted_area == area
    assert tilted_separation == pytest.approx(separation, rel=1e-9, abs=0)
    assert surface["detrend"] == b"line"
    assert surface["heights_tilt"] == pytest.approx(1.25e-3, rel=1e-9)
    assert "tilt 0.00125, 5.00E-06 m over 0.00400 m subtracted from the heights of surface_1 (detrend = 'line')" in note


@pytest.mark.parametrize(("word", "degree"), [("none", -1), ("mean", 0), ("line", 1), ("parabola", 2)])
def test_every_word(asperity, tmp_path, word, degree):
    x, z = rough()
    z = z + 3e-6 + 2.5e-6 * x - 4e-6 * x**2
    heights, surface, note, *_ = dry(asperity, tmp_path, z, f", detrend = '{word}'")
    expected = z if degree < 0 else z - np.polyval(np.polyfit(x, z, degree), x)
    np.testing.assert_allclose(heights, expected, rtol=0, atol=1e-17)
    assert surface["detrend"] == word.encode()
    assert ("heights_mean" in surface) == (degree >= 0)
    assert ("subtracted" in note) == (degree >= 1)
    if degree == 2:
        assert surface["heights_curvature"] == pytest.approx(-8e-6 / (LENGTH / 2) ** 2, rel=1e-9)
        assert "curvature -2.00 1/m, 4.00E-06 m high subtracted" in note


def test_heights_that_close_are_repeated_as_they_are(asperity, tmp_path):
    """A wave over the whole period has a line of least squares, but no tilt."""
    wave = 1e-7 * np.sin(2 * np.pi * np.arange(500) / 500)
    heights, surface, note, *_ = dry(asperity, tmp_path, wave)
    np.testing.assert_array_equal(heights, np.loadtxt(tmp_path / "z.csv", delimiter=",", skiprows=1)[:, 1])
    assert (surface["detrend"], note) == (b"none", "")
    with solve(asperity, tmp_path, profile("A"), [1e8]) as file:
        assert file["input/effective/surface_1"].attrs["detrend"] == b"none"


def test_plane_of_an_area(asperity, tmp_path):
    source = np.random.default_rng(2)
    y, x = np.mgrid[-1:1:20j, -1:1:30j]
    z = 1e-8 * source.standard_normal((20, 30)) + 1e-6 + 2e-7 * x - 3e-7 * y
    terms = np.column_stack([np.ones(600), x.ravel(), y.ravel()])
    expected = z - (terms @ np.linalg.lstsq(terms, z.ravel(), rcond=None)[0]).reshape(z.shape)
    write_heights(tmp_path, z, 1e-6)
    with solve(asperity, tmp_path, HEIGHTS, [1e7], "", problem="dry_area") as file:
        np.testing.assert_allclose(file["solution/height_undeformed"][()], expected, rtol=0, atol=1e-20)
        tilts = file["input/effective/surface_1"].attrs["heights_tilt"]
        assert "m in y subtracted from the heights of surface_1" in text(file["report/note"][()])
    assert tilts == pytest.approx([4e-7 / 29e-6, -6e-7 / 19e-6], rel=0.1)


@pytest.mark.path
@pytest.mark.parametrize("nodes", [3000, 200000])
def test_tilt_in_oil(asperity, tmp_path, nodes):
    """Also of a profile that is read in windows: the contact is that of the level one."""
    x = np.linspace(-1, 1, nodes)
    z = 20e-9 * np.cos(40 * x + 1)
    z -= np.polyval(np.polyfit(x, z, 1), x)
    case = STEADY.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 0.0, speed_2 = 1.1")
    case += "&surface_1 shape = 'file', file = 'z.h5', dataset = 'z' /\n&accuracy error_bars = .false. /\n"
    write(tmp_path, "case.nml", case)
    fields = []
    for tilt in (0.0, 2e-6):
        write_heights(tmp_path, z + tilt * x + tilt, LENGTH / (nodes - 1))
        done = ended(asperity("case.nml", "--verbose"))
        words = " ".join((done.stdout + done.stderr).split())
        assert words.count("m over 0.00400 m subtracted from the heights of surface_1") == (2 if tilt else 0)
        with h5py.File(tmp_path / "case.h5") as file:
            fields.append(file["solution/roughness_1"][()])
            assert file["input/effective/surface_1"].attrs["heights_tilt"] == pytest.approx(tilt / 2e-3, abs=1e-12)
    np.testing.assert_allclose(fields[1], fields[0], rtol=0, atol=1e-9 * np.abs(fields[0]).max())


ALPHA = np.sqrt(np.log(2) / np.pi)


def mean_line(z, spacing, cutoff):
    """ISO 16610-21 by its weighting function, as a sum; the weights at the ends have a sum of one."""
    x = np.arange(len(z)) * spacing
    s = np.exp(-np.pi * ((x[:, None] - x[None, :]) / (ALPHA * cutoff)) ** 2)
    return s @ z / s.sum(axis=1)


def by_series(z, spacing, cutoff):
    """The same for many nodes, as a product of series."""
    nodes = len(z) + int(3 * cutoff / spacing)
    share = 0.5 ** (cutoff * np.fft.rfftfreq(nodes, spacing)) ** 2
    line, weights = (np.fft.irfft(np.fft.rfft(values, nodes) * share, nodes)[: len(z)] for values in (z, np.ones(len(z))))
    return line / weights


def test_cut_offs_of_a_profile(asperity, tmp_path):
    x, z = rough()
    spacing = LENGTH / (len(z) - 1)
    keys = ", cutoff_long = 0.8e-3, cutoff_short = 60e-6"
    heights, surface, *_ = dry(asperity, tmp_path, z + 1e-6 * x, keys)
    line = np.polyfit(x, z, 1)
    smooth = mean_line(z - np.polyval(line, x), spacing, 60e-6)
    np.testing.assert_allclose(heights, smooth - mean_line(smooth, spacing, 0.8e-3), rtol=0, atol=1e-18)
    assert (surface["cutoff_long"], surface["cutoff_short"]) == (0.8e-3, 60e-6)


@pytest.mark.parametrize("nodes", [3000, 100000])
def test_cut_offs_in_oil(solved_case, tmp_path, nodes):
    """The same as of heights that were filtered before."""
    place = np.linspace(-1, 1, nodes)
    z = 20e-9 * np.cos(130 * place + 1) + 2e-6 * np.cos(3 * place) + 20e-9 * np.cos(2500 * place)
    spacing = LENGTH / (nodes - 1)
    level = z - np.polyval(np.polyfit(place, z, 1), place)
    smooth = by_series(level, spacing, 20e-6)
    keys = ", cutoff_long = 0.8e-3, cutoff_short = 20e-6"
    case = STEADY.replace("speed_1 = 0.1, speed_2 = 1.1", "speed_1 = 0.0, speed_2 = 1.1")
    case += "&surface_1 shape = 'file', file = 'z.h5', dataset = 'z'{} /\n&accuracy error_bars = .false. /\n"
    fields = []
    for heights, more in ((smooth - by_series(smooth, spacing, 0.8e-3), ", detrend = 'none'"), (z, keys)):
        write_heights(tmp_path, heights, spacing)
        with solved_case(case.format(more)) as file:
            fields.append(file["solution/roughness_1"][()] * file["solution/roughness_1"].attrs["si_scale"])
    assert np.abs(fields[0]).max() > 1e-8
    np.testing.assert_allclose(fields[1], fields[0], rtol=0, atol=1e-15)


BAD_CUTOFFS = {
    "cutoff_short = 10e-6": "&surface_1 cutoff_short: found 1.00000E-05 m, expected 1.60E-05 to 0.00400 m, 4 spacings to the",
    "cutoff_long = 5e-3": "&surface_1 cutoff_long: found 0.00500000 m, expected 1.60E-05 to 0.00400 m, 4 spacings to the length",
    "cutoff_long = 2e-4, cutoff_short = 3e-4": "&surface_1 cutoff_short: found 3.00000E-04 m, expected less than cutoff_long",
}


@pytest.mark.parametrize("keys", BAD_CUTOFFS)
def test_cut_offs_that_cannot_be(run_case, tmp_path, keys):
    write_csv(tmp_path, rough()[1])
    assert BAD_CUTOFFS[keys] in run_case(case_text(FILE.format(", " + keys), [1e6], ""), status=1).stderr

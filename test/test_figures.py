"""What the figure scripts compute before they draw; the page of a result to pass on."""

import base64
import re
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from cases import POINT, ROOT, STEADY, TRANSIENT, called, case_text, ended, profile

sys.path.insert(0, str(ROOT / "postproc"))
import compare
import dry
import point
import result_file

MOES_POINT = """&case problem = 'ehl_point' /
&moes moes_m = 5, moes_l = 5, velocity = 'sum' /
&lubricant viscosity_law = 'barus' /
"""


def dry_result(nodes, power=(), hardness=None):
    x = np.arange(nodes) * 1e-6
    heights = 1e-6 * np.sin(x / 3e-5)
    solution = dict.fromkeys(("height_undeformed", "height_loaded", "height_unloaded"), heights)
    solution |= {"x": x, "pressure": np.where(np.arange(nodes) == nodes // 3, 5e8, 0.0), "gap": 2e-6 - heights}
    sweep = {"mean_pressure": np.array([1e6, 2e7]), "contact_area_fraction": np.array([0.01, 0.0345])}
    surface = {"power_loaded": np.array(power)}
    return dry.DryResult("a.h5", True, "", solution, sweep, surface, np.ones(3), 1e-8, hardness)


@pytest.mark.parametrize("nodes", [64, 512, 4096])
def test_the_bands_of_a_spectrum_hold_all_of_it(nodes):
    power = np.random.default_rng(3).random(nodes // 2) ** 4
    wavelengths, sums = dry.spectrum(dry_result(nodes, power), "loaded")
    assert sums.sum() == pytest.approx(power.sum(), rel=1e-12, abs=0)
    assert np.all(np.diff(wavelengths) > 0)
    # the longest wave is the length, the shortest two nodes, each to half a band
    assert wavelengths[-1] == pytest.approx(nodes * 1e-6, rel=0.13)
    assert wavelengths[0] == pytest.approx(2e-6, rel=1e-12, abs=0)
    # one wave alone is in the band of its wavelength
    lone = np.zeros(nodes // 2)
    lone[9] = 1.0
    wavelengths, sums = dry.spectrum(dry_result(nodes, lone), "loaded")
    assert wavelengths[sums.argmax()] == pytest.approx(nodes * 1e-7, rel=0.13)


@pytest.mark.parametrize(("nodes", "columns"), [(1200, 1), (1201, 2), (100_000, 2)])
def test_a_long_profile_has_a_detail_round_its_largest_pressure(nodes, columns):
    figure = dry.draw_profile(dry_result(nodes, hardness=5e8))
    assert len(figure.axes) == 2 * columns
    assert "20 MPa, contact 3.45 %" in figure.get_suptitle()
    detail = figure.axes[columns - 1].lines[0].get_ydata()
    assert detail.max() == pytest.approx(500)  # MPa
    assert sum(len(line.get_xdata()) for panel in figure.axes for line in panel.lines) < 6000
    dry.style.plt.close(figure)


def test_the_sweep_has_the_error_bars_of_the_result():
    result = dry_result(64)
    known = ("plastic_area_fraction", "mean_separation", "ra_undeformed", "ra_loaded", "ra_unloaded")
    result.sweep |= dict.fromkeys(known, np.array([2e-7, 1e-7]))
    result.errors = {"contact_area_fraction": np.array([0.002, 0.003])}
    figure = dry.draw_sweep(result)
    (bars,) = figure.axes[0].containers[0].lines[2]
    assert [np.ptp(ends[:, 1]) for ends in bars.get_segments()] == pytest.approx([0.004, 0.006])
    assert not figure.axes[1].containers[0].has_yerr
    dry.style.plt.close(figure)


@pytest.mark.parametrize("count", [2, 6, 7, 8, 9, 40])
def test_a_family_of_results_has_a_short_legend(count):
    named = compare.labelled(count)
    assert len(named) == min(count, 8)
    assert (named[0], named[-1]) == (0, count - 1)
    looks = {str(compare.look_of(i, count)["color"]) for i in range(count)}
    assert len(looks) == count


def test_light_is_extinguished_at_odd_quarters_of_its_wavelength_in_oil():
    quarter = np.array([630e-9, 530e-9, 460e-9]) / (4 * 1.5)
    for orders, intensity in ((0, 1), (1, 0), (2, 1), (3, 0), (0.5, 0.5)):
        assert np.diag(point.colours(orders * quarter)) == pytest.approx(intensity, abs=1e-12)


def test_a_point_contact_lies_in_its_ellipse(solve_all, tmp_path, monkeypatch):
    folder = solve_all({"tilted": POINT, "moes": MOES_POINT})
    contact = point.read_contact(folder / "tilted.h5")
    nodes = contact.result.solution
    assert np.array_equal(contact.field("film_thickness", nodes["x"].values, nodes["y"].values), nodes["film_thickness"].values)
    x, y = contact.window()
    pressure = contact.field("pressure", x, y)
    both = (contact, replace(contact, angle=-contact.angle))
    shares = [pressure[own.squared_radius(x, y) < 1].sum() / pressure.sum() for own in both]
    assert shares[0] > 0.8
    assert shares[1] < 0.6
    figures = []
    monkeypatch.setattr(point.style, "save_figure", lambda figure, targets: figures.append(figure) or targets)
    assert point.main([str(folder / "tilted.h5"), str(folder / "moes.h5"), "--output", str(tmp_path)]) == 0
    light, plain = ([panel.get_title() for panel in figure.axes[:2]] for figure in figures)
    assert (light[0], plain[0]) == ("Light of 630, 530, 460 nm", "")
    smallest = contact.result.summary["h_min"]
    assert f"smallest {1e9 * smallest:.4g} nm" in light[1]
    assert [figure.axes[2].get_xlabel() for figure in figures] == ["Position $x$ [µm]", "Position $X$ [-]"]
    for figure in figures:
        point.style.plt.close(figure)
    with pytest.raises(result_file.ResultError, match="needs 'ehl_line'; point\\.py draws it"):
        result_file.read_result(folder / "moes.h5")


class Page:
    """The cells of a page, row by row, and its pictures; it must be well-formed."""

    def __init__(self, text):
        root = ElementTree.fromstring(text)
        self.rows = [["".join(cell.itertext()).strip() for cell in row.iter("td")] for row in root.iter("tr")]
        self.pictures = [base64.b64decode(image.get("src").partition("base64,")[2]) for image in root.iter("img")]

    def row(self, name):
        return next(row for row in self.rows if row[:1] == [name])


def report(*arguments):
    return called([sys.executable, str(ROOT / "postproc" / "report.py"), *map(str, arguments)])


@pytest.fixture(scope="module")
def folder(solve_all):
    found = solve_all({"steady": STEADY, "ridge": TRANSIENT, "dry": case_text(profile("A", 10), [50e6, 100e6]), "point": POINT})
    done = report(*sorted(found.glob("*.h5")), "--output", found / "pages")
    assert (done.returncode, done.stderr) == (0, "")
    return found


@pytest.mark.parametrize(("name", "pictures"), [("steady", 1), ("ridge", 4), ("dry", 3), ("point", 1)])
def test_a_page_is_complete_in_itself(folder, name, pictures):
    text = (folder / "pages" / f"{name}.html").read_text(encoding="utf-8")
    page = Page(text)
    assert len(page.pictures) == pictures
    assert all(b"<svg" in picture for picture in page.pictures)
    assert not re.search(r'(src|href)="(?!data:|#)', text)
    assert "nan" not in re.sub(r"base64,[^\"]*", "", text)
    assert "<pre>&amp;case" in text
    assert "<b>Not converged" not in text


def test_results_have_units_errors_and_times(folder):
    page = Page((folder / "pages" / "ridge.html").read_text(encoding="utf-8"))
    film, pressure = page.row("Smallest film thickness"), page.row("Largest pressure")
    assert re.fullmatch(r"[\d.]+ nm", film[1])
    assert "time steps, an estimate needs" in film[2]
    steady = Page((folder / "pages" / "steady.html").read_text(encoding="utf-8"))
    assert re.fullmatch(r"± [\d.]+ %", steady.row("Smallest film thickness")[2])
    assert re.fullmatch(r"[\d.]+ µs", film[3])
    assert pressure[1].endswith(" MPa")
    assert page.row("Slide-to-roll ratio")[1] == "1.667"
    assert page.row("roughness")[3] == "smooth surfaces"
    dry = Page((folder / "pages" / "dry.html").read_text(encoding="utf-8"))
    assert re.fullmatch(r"[\d.]+ µm", dry.row("Mean separation")[1])
    assert 'alt="Interference of light, film' in (folder / "pages" / "point.html").read_text(encoding="utf-8")
    point = Page((folder / "pages" / "point.html").read_text(encoding="utf-8"))
    assert re.fullmatch(r"[\d.]+ nm", point.row("Central film thickness")[1])
    names = ("Half-axis of the Hertzian ellipse along x", "Half-axis along y")
    along_x, along_y = (float(point.row(name)[1].split()[0]) for name in names)
    assert along_y > 3 * along_x


BAD = {
    "Not converged:": STEADY + "&solver max_cycles = 1 /\n",
    "<b>Outside the model: mixed lubrication, the smallest film": STEADY.replace("speed_2", "roughness_1 = 1e-6, speed_2"),
}


@pytest.mark.parametrize("words", BAD)
def test_no_solution_is_said_first(run_case, tmp_path, words):
    run_case(BAD[words], status=2, name="bad")
    assert report(tmp_path / "bad.h5", "--output", tmp_path / "page.html").returncode == 0
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert text.index(words) < text.index("Results")
    assert ("<td>Lambda ratio</td>" in text) == ("mixed" in words)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "no.h5").write_text("nothing")
    done = ended(report(tmp_path / "no.h5", tmp_path / "missing.h5"), 1)
    assert len(done.stderr.splitlines()) == 2
    assert not list(tmp_path.glob("*.html"))

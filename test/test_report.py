"""The page of a result to pass on: complete in itself, with outcome, limits and input; other files are refused."""

import base64
import re
import sys
from xml.etree import ElementTree

import pytest
from cases import POINT, STEADY, TRANSIENT, called, ended
from conftest import ROOT
from dry_cases import case_text, profile


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
    assert float(point.row("Half-axis along y")[1].split()[0]) > 3 * float(
        point.row("Half-axis of the Hertzian ellipse along x")[1].split()[0]
    )


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

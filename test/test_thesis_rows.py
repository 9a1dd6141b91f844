"""docs/thesis.md and docs/dry.md have a row for all that the thesis numbers: where it is computed, and its test."""

import re

import pytest
from conftest import ROOT

THESIS, DRY = ((ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8") for name in ("thesis", "dry"))
HEADING = "Every equation, figure, table and conclusion"
HEADER = ["item", "content", "where", "test", "verdict"]


def numbered(equations, figures, tables, conclusions):
    """Everything that has a number, in the order of the table: how many each chapter or paper has."""
    kinds = (("({}.{})", equations), ("Figure {}.{}", figures), ("Table {}.{}", tables), ("Conclusion {}-{}", conclusions))
    for form, counts in kinds:
        yield from (form.format(part, i) for part, count in counts.items() for i in range(1, count + 1))


def items(cell):
    """The names in a first cell, as in "(2.6) to (2.8), (A.5)" or "Figure 5.1, A.1"."""
    kind = re.match(r"[A-Z][a-z]+ |", cell)[0]
    for part in cell.removeprefix(kind).split(", "):
        stem, first, end, last = re.fullmatch(r"(.*?)(\d+)(\)?)(?: to \1(\d+)\3)?", part).groups()
        yield from (f"{kind}{stem}{i}{end}" for i in range(int(first), int(last or first) + 1))


def table_under(page, heading=HEADING):
    section = re.split(r"^## ", page.split(f"## {heading}\n")[1], flags=re.M)[0]
    lines = [line for line in section.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines]


OF_THESIS = numbered(
    equations={"2": 73, "5": 11, "6": 1, "A": 27, "B": 22},
    figures={"2": 2, "5": 3, "6": 10, "A": 3, "B": 5},
    tables={"5": 3, "6": 1, "A": 3, "B": 1},
    conclusions={"6.3": 9, "A.6": 3, "B.4": 9},
)
OF_DRY = numbered(
    equations={"3": 24, "4": 3, "C": 3},
    figures={"3": 1, "4": 6, "7": 4, "C": 7},
    tables={"7": 1, "C": 1},
    conclusions={"4.4": 4, "7.2": 3, "C.5": 4},
)
PAGES = [
    (THESIS, list(OF_THESIS), ("agrees", "disagrees", "partly", "used")),
    (DRY, list(OF_DRY), ("agrees", "disagrees", "partly", "not decidable", "used")),
]


@pytest.mark.parametrize(("page", "names", "verdicts"), PAGES, ids=["thesis", "dry"])
def test_every_number_of_the_thesis_has_a_row(page, names, verdicts):
    """Each number in one row, rows in order, with no cell empty and a verdict that begins with one of these words."""
    header, *rows = table_under(page)
    assert header == HEADER
    places = [[names.index(name) for name in items(row[0])] for row in rows]
    assert sorted(place for row in places for place in row) == list(range(len(names)))
    assert places == sorted(sorted(place) for place in places)
    assert [row for row in rows if len(row) != len(HEADER) or not all(row)] == []
    assert [row for row in rows if not row[-1].startswith(verdicts)] == []


@pytest.mark.parametrize("page", [THESIS, DRY], ids=["thesis", "dry"])
def test_tests_of_the_rows_exist(page):
    patterns = ("test/*.py", "test/unit/**/*.pf", "test/verification/*.pf")
    sources = [path.read_text(encoding="utf-8") for pattern in patterns for path in ROOT.glob(pattern)]
    there = set(re.findall(r"(?:def|subroutine) (\w+)\(", "\n".join(sources)))
    assert {name for row in table_under(page)[1:] for name in re.findall(r"`(\w+)`", row[3])} - there == set()


def test_what_papers_repeat_has_the_verdict_of_the_chapter():
    rows = table_under(THESIS)[1:]
    found = {name: row for row in rows for name in items(row[0])}
    for row in rows:
        same = re.search(r"as (\(\d\.\d+\)|(?:\d\.\d+)(?:-\d)?)$", row[1])
        if same is None:
            continue
        kind = row[0].split(" ")[0]
        other = found[same[1] if same[1].startswith("(") else f"{kind} {same[1]}"]
        assert row[3] == other[3]
        if not row[0].startswith("("):  # a misprint may stand in one of two places only
            assert row[4] == other[4]

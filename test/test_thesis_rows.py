"""docs/thesis.md has a row for all that chapters 2, 5 and 6 and Papers A and B number; with docs/dry.md it is the whole thesis."""

import re

from conftest import ROOT

PAGE = (ROOT / "docs" / "thesis.md").read_text(encoding="utf-8")
# How many the thesis has: equations, figures, tables, conclusions.
EQUATIONS = {"2": 73, "5": 11, "6": 1, "A": 27, "B": 22}
FIGURES = {"2": 2, "5": 3, "6": 10, "A": 3, "B": 5}
TABLES = {"5": 3, "6": 1, "A": 3, "B": 1}
CONCLUSIONS = {"6.3": 9, "A.6": 3, "B.4": 9}
VERDICTS = ("agrees", "disagrees", "partly", "used")


def rows():
    """The table as lists of cells."""
    section = PAGE.split("## Every equation, figure, table and conclusion\n")[1]
    lines = [line for line in section.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines]


def numbered():
    """Everything that has a number."""
    yield from (f"({part}.{i})" for part, count in EQUATIONS.items() for i in range(1, count + 1))
    yield from (f"Figure {part}.{i}" for part, count in FIGURES.items() for i in range(1, count + 1))
    yield from (f"Table {part}.{i}" for part, count in TABLES.items() for i in range(1, count + 1))
    yield from (f"Conclusion {part}-{i}" for part, count in CONCLUSIONS.items() for i in range(1, count + 1))


def test_every_number_of_the_thesis_has_a_row():
    header, *items = rows()
    assert header == ["item", "what", "where we do it", "test", "verdict"]
    assert [row[0] for row in items] == list(numbered())
    assert [row for row in items if len(row) != len(header) or not all(row)] == []
    assert [row for row in items if not row[-1].startswith(VERDICTS)] == []


def test_tests_of_the_rows_exist():
    patterns = ("test/*.py", "test/unit/**/*.pf", "test/verification/*.pf")
    sources = [path.read_text(encoding="utf-8") for pattern in patterns for path in ROOT.glob(pattern)]
    there = set(re.findall(r"(?:def|subroutine) (\w+)\(", "\n".join(sources)))
    assert {name for row in rows()[1:] for name in re.findall(r"`(\w+)`", row[3])} - there == set()


def test_what_papers_repeat_has_the_verdict_of_the_chapter():
    found = {row[0]: row for row in rows()[1:]}
    for row in found.values():
        same = re.search(r"as (\(\d\.\d+\)|(?:\d\.\d+)(?:-\d)?)$", row[1])
        if same is None:
            continue
        kind = row[0].split(" ")[0]
        other = found[same[1] if same[1].startswith("(") else f"{kind} {same[1]}"]
        assert row[3] == other[3]
        if not row[0].startswith("("):  # a misprint may stand in one of two places only
            assert row[4] == other[4]

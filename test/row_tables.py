"""The tables of docs/thesis.md and docs/dry.md with a row for everything that the thesis numbers: read, and checked."""

import re
from dataclasses import dataclass

from conftest import ROOT

HEADING = "Every equation, figure, table and conclusion"
HEADER = ["item", "what", "where we do it", "test", "verdict"]


@dataclass
class Numbers:
    """How many equations, figures, tables and conclusions each chapter or paper has."""

    equations: dict[str, int]
    figures: dict[str, int]
    tables: dict[str, int]
    conclusions: dict[str, int]

    def names(self):
        """Everything that has a number, in the order of the table."""
        kinds = (("({}.{})", self.equations), ("Figure {}.{}", self.figures), ("Table {}.{}", self.tables))
        for form, counts in (*kinds, ("Conclusion {}-{}", self.conclusions)):
            yield from (form.format(part, i) for part, count in counts.items() for i in range(1, count + 1))


def items(cell):
    """The names in a first cell, as in "(2.6) to (2.8), (A.5)" or "Figure 5.1, A.1"."""
    kind = re.match(r"[A-Z][a-z]+ |", cell)[0]
    for part in cell.removeprefix(kind).split(", "):
        stem, first, end, last = re.fullmatch(r"(.*?)(\d+)(\)?)(?: to \1(\d+)\3)?", part).groups()
        yield from (f"{kind}{stem}{i}{end}" for i in range(int(first), int(last or first) + 1))


def table_under(page, heading=HEADING):
    """The rows of the tables of a section as lists of cells, headers too."""
    section = re.split(r"^## ", page.split(f"## {heading}\n")[1], flags=re.M)[0]
    lines = [line for line in section.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("| ").split(" | ")] for line in lines]


def check_rows(page, numbers, verdicts):
    """Each number in one row, rows in order, with no cell empty and a verdict that begins with one of these words."""
    header, *rows = table_under(page)
    assert header == HEADER
    names = list(numbers.names())
    places = [[names.index(name) for name in items(row[0])] for row in rows]
    assert sorted(place for row in places for place in row) == list(range(len(names)))
    assert places == sorted(sorted(place) for place in places)
    assert [row for row in rows if len(row) != len(HEADER) or not all(row)] == []
    assert [row for row in rows if not row[-1].startswith(verdicts)] == []


def check_tests(page):
    """The tests that the rows name exist."""
    patterns = ("test/*.py", "test/unit/**/*.pf", "test/verification/*.pf")
    sources = [path.read_text(encoding="utf-8") for pattern in patterns for path in ROOT.glob(pattern)]
    there = set(re.findall(r"(?:def|subroutine) (\w+)\(", "\n".join(sources)))
    assert {name for row in table_under(page)[1:] for name in re.findall(r"`(\w+)`", row[3])} - there == set()

"""docs/thesis.md has a row for all that chapters 2, 5 and 6 and Papers A and B number; with docs/dry.md it is the whole thesis."""

import re

from conftest import ROOT
from row_tables import Numbers, check_rows, check_tests, items, table_under

PAGE = (ROOT / "docs" / "thesis.md").read_text(encoding="utf-8")
NUMBERS = Numbers(
    equations={"2": 73, "5": 11, "6": 1, "A": 27, "B": 22},
    figures={"2": 2, "5": 3, "6": 10, "A": 3, "B": 5},
    tables={"5": 3, "6": 1, "A": 3, "B": 1},
    conclusions={"6.3": 9, "A.6": 3, "B.4": 9},
)


def test_every_number_of_the_thesis_has_a_row():
    check_rows(PAGE, NUMBERS, ("agrees", "disagrees", "partly", "used"))


def test_tests_of_the_rows_exist():
    check_tests(PAGE)


def test_what_papers_repeat_has_the_verdict_of_the_chapter():
    rows = table_under(PAGE)[1:]
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

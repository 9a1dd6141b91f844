"""The five usual tasks of docs/tasks.md need no script of more than ten lines; that they run is up to test_docs.py."""

import re

from conftest import ROOT

TASKS = [
    "A roller of your own",
    "Its film over the speed",
    "A measured profile, dry and in oil",
    "Results in xarray",
    "Two hundred cases",
]


def test_each_task_is_short():
    page = (ROOT / "docs" / "tasks.md").read_text(encoding="utf-8")
    sections = dict(part.split("\n", 1) for part in page.split("\n## ")[1:])
    assert list(sections) == TASKS
    for title, text in sections.items():
        scripts = re.findall(r"^```(?:sh|python)\n(.*?)^```$", text, re.M | re.S)
        assert scripts, title
        assert max(script.count("\n") for script in scripts) <= 10, title

"""The notebooks run, draw what they show, and their stored numbers are those of this program."""

import os
import re

import nbclient
import nbformat
import pytest
from conftest import ROOT

NOTEBOOKS = sorted((ROOT / "notebooks").glob("*.ipynb"))
QUANTITY = re.compile(r"(h_min|h_central|p_max|friction_coefficient) +(\S+)")


def quantities(book):
    """Names and values of all results that a notebook shows."""
    texts = [output["data"].get("text/plain", "") for cell in book.cells for output in cell.get("outputs", []) if "data" in output]
    return [(name, float(value)) for text in texts if "asperity.Result" in text for name, value in QUANTITY.findall(text)]


def pictures(book):
    return [i for i, cell in enumerate(book.cells) for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path, program, monkeypatch):
    monkeypatch.setenv("ASPERITY", str(program))
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    stored = nbformat.read(path, 4)
    book = nbformat.read(path, 4)
    environment = dict(os.environ)
    nbclient.NotebookClient(book, timeout=600, resources={"metadata": {"path": str(path.parent)}}).execute(env=environment)
    assert len(quantities(stored)) >= 3
    assert [name for name, _ in quantities(book)] == [name for name, _ in quantities(stored)]
    for (name, value), (_, shown) in zip(quantities(book), quantities(stored), strict=True):
        assert value == pytest.approx(shown, rel=1e-3), name
    assert pictures(book) == pictures(stored) != []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_cells_are_short(path):
    """No task needs a script of more than ten lines."""
    cells = [cell.source for cell in nbformat.read(path, 4).cells if cell.cell_type == "code"]
    assert len(cells) >= 5
    assert max(source.count("\n") + 1 for source in cells) <= 10

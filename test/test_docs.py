"""The pages and notebooks for people: their examples run, their links lead somewhere, the files and keys that they name exist.

Fenced blocks of a page are run in their order, in one folder that looks like a checkout in which `make build` has run:
`sh` and `python` blocks are executed and must succeed; a `text` block behind one is its output, where `...` stands for what may
differ; `fortran` blocks with a &case are checked as namelists, `toml` blocks with a base as sweeps. A comment
`<!-- not run: reason -->` above a block exempts it, `<!-- by night -->` unless NIGHTLY is set.
"""

import os
import re
import shutil
import sys

import h5py
import nbclient
import nbformat
import pytest
from cases import ROOT, called

PAGES = ["README.md", *(f"docs/{name}.md" for name in ("CONTRIBUTING", "guide", "dry", "batch", "theory", "developer", "tasks"))]
OTHERS = ("CHANGELOG", "decisions", "input", "ford", "thesis", "performance", "testing")
LINKED_PAGES = [*PAGES, *(f"docs/{name}.md" for name in OTHERS)]
BLOCK = re.compile(r"^(?P<exempt><!-- (?:not run: [^\n]+|by night) -->\n)?```(?P<language>\w*)\n(?P<code>.*?)^```$", re.M | re.S)
FOLDERS = r"(?:src|app|test|tools|docs|input|postproc|include|bench|batch|python|\.ci)"


def page_text(page):
    return (ROOT / page).read_text(encoding="utf-8")


def blocks(page):
    """(language, code, is_exempt, line number) of the fenced blocks of a page."""
    text = page_text(page)
    for match in BLOCK.finditer(text):
        by_night = "by night" in (match["exempt"] or "") and os.environ.get("NIGHTLY")
        yield match["language"], match["code"], bool(match["exempt"]) and not by_night, text.count("\n", 0, match.start()) + 1


def prose(page):
    return BLOCK.sub("", page_text(page))


@pytest.fixture
def checkout(program, tmp_path):
    """A folder that looks like a checkout after `make build`, with the program to test in it."""
    for name in ("input", "postproc", "batch", "test", "docs", "tools", "src"):
        (tmp_path / name).symlink_to(ROOT / name)
    (tmp_path / "build" / "bin").mkdir(parents=True)
    (tmp_path / "build" / "bin" / "asperity").symlink_to(program.resolve())
    for command in ("asperity-heights", "asperity-duty"):
        (tmp_path / "build" / "bin" / command).symlink_to(ROOT / "build" / "bin" / command)
    python = tmp_path / ".venv" / "bin" / "python"
    python.parent.mkdir(parents=True)
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n', encoding="utf-8")
    python.chmod(0o755)
    return tmp_path


def run_block(language, code, folder):
    """The combined output of one block; fails if the block does."""
    command = [sys.executable, "-c", code] if language == "python" else ["sh", "-euc", code]
    environment = {**os.environ, "MPLBACKEND": "agg", "PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(ROOT / "python")}
    environment["ASPERITY"] = str(folder / "build" / "bin" / "asperity")
    done = called(command, cwd=folder, env=environment)
    assert done.returncode == 0, f"{code}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def missing_lines(shown, output):
    """The lines of `shown` that are not in `output`; `...` stands for anything, blanks at the ends do not count."""
    lines = [line.strip() for line in output.splitlines()]
    for line in filter(str.strip, shown.splitlines()):
        pattern = ".*".join(re.escape(part) for part in line.strip().split("..."))
        if not any(re.fullmatch(pattern, candidate) for candidate in lines):
            yield line


@pytest.mark.parametrize("page", PAGES)
def test_examples_run_and_show_what_the_page_shows(page, checkout):
    output = None
    for language, code, is_exempt, line in blocks(page):
        if is_exempt:
            output = None
        elif language in {"sh", "python"}:
            output = run_block(language, code, checkout)
        elif language == "fortran" and "&case" in code:
            (checkout / "block.nml").write_text(code, encoding="utf-8")
            run_block("sh", "build/bin/asperity --check block.nml", checkout)
        elif language == "toml" and "base =" in code:
            (checkout / "block.toml").write_text(code.replace('"../', '"input/'), encoding="utf-8")
            run_block("sh", ".venv/bin/python batch/sweep.py block.toml", checkout)
        elif language == "text" and output is not None:
            assert list(missing_lines(code, output)) == [], f"{page}:{line}: not in the output\n{output}"
            output = None


def headings(page):
    """The anchors of a page, as GitHub makes them."""
    titles = re.findall(r"^#+ (.+)$", prose(page), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", LINKED_PAGES)
def test_what_a_page_names_exists(page):
    """Where its links lead, files, and words of make."""
    text = prose(page)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (ROOT / page).parent / path if path else ROOT / page
        assert file.exists(), f"{page}: {target} is not there"
        if anchor:
            assert anchor in headings(file.resolve().relative_to(ROOT)), f"{page}: {target} has no such heading"
    named = set(re.findall(rf"`({FOLDERS}/[\w./*-]*|[\w-]+\.(?:toml|cff|txt)|Makefile|bootstrap)`", text))
    made = ("docs/api", "test/generated")
    missing = [name for name in named if not name.startswith(made) and not list(ROOT.glob(name.rstrip("/")))]
    assert missing == [], f"{page} names files that are not there"
    targets = set(re.findall(r"^([a-z0-9-]+):", page_text("Makefile"), re.M))
    named = set(re.findall(r"(?:`|^|\./)(?:make|bootstrap) ([a-z0-9-]+)", page_text(page), re.M)) - {"-f"}
    assert named - targets == set(), f"{page} names words of make that the Makefile does not have"


@pytest.mark.parametrize("page", PAGES)
def test_keys_that_are_named_exist(page):
    table, group = set(), ""
    for line in page_text("docs/input.md").splitlines():
        if line.startswith("## &"):
            group = line[4:]
        if found := re.match(r"\| `(\w+)` \|", line):
            table.add(f"&{group} {found[1]}")
        if found := re.match(r"- `(&\w+ \w+)`", line):
            table.add(found[1])
    named = set(re.findall(r"`(&\w+ \w+)(?: = [^`]*)?`", prose(page)))
    assert named - table == set(), f"{page} names keys that are not in docs/input.md"


def test_minimal_case_of_the_readme_is_the_file():
    code = [code for language, code, _, _ in blocks("README.md") if language == "fortran"]
    assert code == [page_text("input/minimal.nml")]


def test_names_of_the_developer_page_are_in_the_source():
    patterns = ("src/**/*.f90", "app/*.f90", "tools/*", "test/**/*.p[fy]", "bench/*.py", "batch/*.py")
    files = [path for pattern in patterns for path in ROOT.glob(pattern) if path.is_file()]
    words = {word for path in files for word in re.findall(r"\w+", path.read_text(encoding="utf-8"))}
    named = set(re.findall(r"`([a-z]\w*_\w+)`", prose("docs/developer.md")))
    parts = {name for name in named if name.endswith("_") and any(word.startswith(name) for word in words)}
    assert named - words - parts == set(), "docs/developer.md has names that are not in the source"


def test_each_task_fits_a_screen():
    page = (ROOT / "docs" / "tasks.md").read_text(encoding="utf-8")
    sections = dict(part.split("\n", 1) for part in page.split("\n## ")[1:])
    assert len(sections) == 11
    for title, text in sections.items():
        assert text.count("\n") <= 50, title


SCENES = sorted((ROOT / "input" / "scenes").glob("*.nml"))
NUMERICAL = {"grid", "time_step", "domain", "iteration", "validity"}
# Ingredients of each scene by verdict; bench/adequacy.py --kinds scene compares them with fine grids.
OIL = "compressibility elasticity piezoviscosity roelands shear_thinning"
BELOW = "matters below the accuracy"
VERDICTS = {
    "01_journal_bearing": {"irrelevant": "compressibility roelands", BELOW: "elasticity piezoviscosity"},
    "02_rubber_seal": {"irrelevant": "compressibility roelands", BELOW: "piezoviscosity", "needed": "elasticity"},
    **{name: {"needed": OIL} for name in ("03_roller_bearing", "04_gear_tooth", "05_traction_rig")},
    **{name: {"needed": f"{OIL} roughness squeeze"} for name in ("06_ridge_passage", "07_waviness", "08_rough_in_oil")},
    "09_dry_machined": {"needed": "harmonics plasticity"},
    "10_run_in": {"needed": "harmonics", "irrelevant": "plasticity"},
    "15_starved_bearing": {"needed": f"{OIL} supply"},
    "18_ball_on_disc": {"needed": "compressibility roelands piezoviscosity"},
    "19_ball_bearing": {"needed": "compressibility roelands piezoviscosity"},
    "20_traction_ball": {"needed": "shear_thinning compressibility roelands piezoviscosity"},
}


def test_every_scene_has_its_verdicts():
    assert sorted(VERDICTS) == [path.stem for path in SCENES]


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scene_gets_its_verdicts(asperity, tmp_path, path):
    """The scene converges, and its verdicts are those of the table."""
    shutil.copy(path, tmp_path)
    done = asperity(path.name)
    assert (done.returncode, len(done.stdout.splitlines()) <= 12) == (0, True)
    with h5py.File(tmp_path / f"{path.stem}.h5") as file:
        assert file.attrs["converged"] == 1
        said = {name: row.attrs["verdict"].decode() for name, row in file.get("adequacy", {}).items() if name not in NUMERICAL}
    assert said == {name: verdict for verdict, names in VERDICTS[path.stem].items() for name in names.split()}


NOTEBOOKS = sorted((ROOT / "python" / "notebooks").glob("*.ipynb"))
QUANTITY = re.compile(r"(h_min|h_central|p_max|friction_coefficient) +(\S+)")


def quantities(book):
    """Names and values of all results that a notebook shows."""
    texts = [output["data"].get("text/plain", "") for cell in book.cells for output in cell.get("outputs", []) if "data" in output]
    return [(name, float(value)) for text in texts if "asperity.Result" in text for name, value in QUANTITY.findall(text)]


def pictures(book):
    return [i for i, cell in enumerate(book.cells) for output in cell.get("outputs", []) if "image/png" in output.get("data", {})]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebook(path, program, monkeypatch, tmp_path):
    """From an empty folder. Its cells are short."""
    monkeypatch.setenv("ASPERITY", str(program))
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "python"))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    stored = nbformat.read(path, 4)
    cells = [cell.source for cell in stored.cells if cell.cell_type == "code"]
    assert len(cells) >= 5
    assert max(source.count("\n") + 1 for source in cells) <= 10
    book = nbformat.read(path, 4)
    environment = dict(os.environ)
    nbclient.NotebookClient(book, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute(env=environment)
    assert len(quantities(stored)) >= 3
    assert [name for name, _ in quantities(book)] == [name for name, _ in quantities(stored)]
    for (name, value), (_, shown) in zip(quantities(book), quantities(stored), strict=True):
        assert value == pytest.approx(shown, rel=1e-3), name
    assert pictures(book) == pictures(stored) != []

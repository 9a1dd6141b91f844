"""One version everywhere: fpm.toml, the program, CITATION.cff and CHANGELOG.md."""

import re
import tomllib

from cases import ended
from conftest import ROOT


def text_of(name):
    return (ROOT / name).read_text(encoding="utf-8")


VERSION = tomllib.loads(text_of("fpm.toml"))["version"]


def test_version_of_the_source():
    assert re.search(r"program_version = '(.+)'", text_of("src/base/build_info.f90"))[1] == VERSION


def test_version_of_the_program(asperity):
    assert ended(asperity("--version")).stdout.startswith(f"asperity {VERSION}")


def test_version_of_the_citation():
    assert re.search(r"^version: (.+)$", text_of("CITATION.cff"), re.M)[1].strip("\"'") == VERSION


def test_changelog_has_the_version():
    assert re.search(r"^## \[?(\d\S*?)\]?( |$)", text_of("CHANGELOG.md"), re.M)[1] == VERSION

"""bench/page.py: blocks of docs/performance.md."""

import page
import pytest

TEXT = "before\n<!-- dry: written by bench/page.py -->\nold\n<!-- dry: end -->\nafter\n"


def test_only_the_block_changes():
    assert page.with_block(TEXT, "dry", "new\n") == TEXT.replace("old", "new")
    assert page.with_block(page.with_block(TEXT, "dry", "new\n"), "dry", "old\n") == TEXT


@pytest.mark.parametrize("text", [TEXT.replace("dry: end", "end"), TEXT * 2, "nothing\n", "\n".join(reversed(TEXT.splitlines()))])
def test_a_page_without_the_block_is_refused(text):
    with pytest.raises(ValueError, match="expected one block between <!-- dry: written"):
        page.with_block(text, "dry", "new\n")


@pytest.mark.parametrize("name", page.BLOCKS)
def test_the_page_has_every_block(name):
    text = page.PAGE.read_text(encoding="utf-8")
    assert page.with_block(text, name, "new\n").count("new\n") == text.count("new\n") + 1


def test_long_lines_are_folded_with_their_indent():
    lines = page.fenced("  " + "word " * 40).splitlines()
    assert lines[0] == "```text"
    assert max(map(len, lines)) <= 128
    assert lines[2].startswith("      word")

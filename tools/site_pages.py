"""Hook of MkDocs: README as the first page, a page of example inputs, and links to sources that are not pages as plain names."""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s#]+)(#[^)\s]*)?\)")


def examples() -> str:
    """The page of examples: each input with the sentence that its first comment says, and its text."""
    parts = ["# Examples\n\nInputs to start from; `asperity NAME.nml` runs one.\n"]
    folders = {"input": "Single cases", "input/scenes": "Scenes from machines", "input/duty": "Loads and speeds over time"}
    for folder, title in folders.items():
        parts.append(f"## {title}\n")
        for path in sorted((ROOT / folder).glob("*.nml")):
            text = path.read_text(encoding="utf-8")
            first = re.match(r"(?:! ?.*\n)+", text)
            words = " ".join(line.lstrip("! ") for line in first[0].splitlines()) if first else ""
            parts.append(f"### {path.stem}\n\n{words}\n\n```fortran\n{text}```\n")
    return "\n".join(parts)


def on_files(files: Files, config: Any) -> Files:
    """Adds the pages that are no files of docs/."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "index.md", content=readme))
    files.append(File.generated(config, "examples.md", content=examples()))
    return files


def on_page_markdown(markdown: str, page: Any, files: Files, **_: Any) -> str:
    """Links between pages work; what lies outside of docs/ is named by its path."""
    folder = "" if page.file.src_uri == "index.md" else "docs"

    def link(found: re.Match[str]) -> str:
        mark, words, target, anchor = found.groups()
        if re.match(r"[a-z]+:", target):
            return found[0]
        path = posixpath.normpath(posixpath.join(folder, target))
        inside = "index.md" if path == "README.md" else posixpath.relpath(path, "docs")
        if files.get_file_from_path(inside):
            return f"{mark}[{words}]({inside}{anchor or ''})"
        if path.startswith("input/") and path.endswith(".nml"):
            return f"[{words}](examples.md#{Path(path).stem})"
        if not os.path.lexists(ROOT / path):
            raise PluginError(f"{page.file.src_uri}: {target} is no file of the project")
        return words if words.strip("`/") == path else f"{words} (`{path}`)"

    return LINK.sub(link, markdown)

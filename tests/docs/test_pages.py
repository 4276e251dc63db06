"""The documentation's form: what it names is there, and the README stays short."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from .pages import DOCS, PAGES, ROOT, TOP, outside_of_blocks

PATH = re.compile(r"`((?:playground|tests|glsl|docs|screenshots)/[\w./-]+)`")
ROOM = re.compile(r"^  (\w+(?:/|\.py)) ", re.MULTILINE)


def test_the_readme_is_short():
    text = (ROOT / "README.md").read_text("utf-8")
    assert len(text.splitlines()) <= 150 and len(text.split()) <= 1200


@pytest.mark.parametrize("page", TOP, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(page: Path):
    """Of the pages in docs/, ``mkdocs build --strict`` looks at them, anchors too."""
    links = re.findall(r"\]\(([^)#:\s]+)\)", page.read_text("utf-8"))
    missing = [link for link in links if not (page.parent / link).exists()]
    assert not missing


def test_paths_that_are_named_exist():
    missing = {}
    for page in PAGES:
        for path in PATH.findall(outside_of_blocks(page)):
            if not re.search(r"\b[A-Z]{3,}\b", path) and not (ROOT / path).exists():
                missing[path] = page.relative_to(ROOT).as_posix()
    assert not missing


def test_the_layers_are_the_folders_of_the_package():
    text = (DOCS / "explanation" / "architecture.md").read_text("utf-8")
    named = set(ROOM.findall(text[text.index("playground/\n") : text.index("glsl/ ")]))
    package = ROOT / "playground"
    rooms = {f"{path.parent.name}/" for path in package.glob("*/__init__.py")}
    assert rooms <= named, "explanation/architecture.md does not name them"
    assert not [name for name in named if not (package / name).exists()]


def test_the_library_names_its_folders():
    text = (ROOT / "glsl" / "README.md").read_text("utf-8")
    there = {path.name for path in (ROOT / "glsl").iterdir() if path.is_dir()}
    table = text[text.index("| folder | holds |") : text.index("## Axes")]
    assert set(re.findall(r"`(\w+)/`", table)) == there


def test_the_changelog_has_its_form():
    text = (ROOT / "CHANGELOG.md").read_text("utf-8")
    assert re.search(r"^## \[Unreleased\]$", text, re.MULTILINE)
    kinds = {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"}
    assert set(re.findall(r"^### (.*)$", text, re.MULTILINE)) <= kinds


def test_every_page_is_in_the_navigation():
    from site_pages import pages

    nav = yaml.load((ROOT / "mkdocs.yml").read_text("utf-8"), yaml.SafeLoader)["nav"]
    named = set(re.findall(r"[\w/-]+\.md", str([pages.expanded(entry) for entry in nav])))
    written = {path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md")}
    written -= {path for path in written if path.startswith("editors/")}  # of extensions, not of the site
    generated = {path for path in pages.generated_paths() if path.endswith(".md")}
    assert named == written | generated

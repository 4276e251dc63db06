"""Find the blocks of code in the documentation.

A block that cannot be run says why in a comment on the line above it:

    <!-- not run: needs a network -->

A block with a title, as title="dunes/sketch.toml", is a file of that name.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

TOP = (ROOT / "README.md", ROOT / "glsl" / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md")
PAGES = (*TOP, *sorted(DOCS.rglob("*.md")))

_FENCE = re.compile(
    r"^(?:<!-- not run: (?P<reason>[^\n]+?) -->\n+)?"
    r"(?P<ticks>`{3,})(?P<language>\w*)(?: title=\"(?P<title>[^\"]+)\")?[^\n]*\n(?P<text>.*?)^(?P=ticks)$",
    re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class Block:
    """A fenced block of a page."""

    page: Path
    line: int
    language: str
    title: str  # the file that it is; "" for a part of one
    text: str
    reason: str  # why it is not run; "" where it is

    @property
    def name(self) -> str:
        """How a test is called that runs it."""
        text = f"{self.page.relative_to(ROOT).as_posix()}:{self.line}"
        return f"{text}:{self.title}" if self.title else text


@cache
def blocks_of(page: Path) -> tuple[Block, ...]:
    """Return the blocks of a page."""
    text = page.read_text("utf-8")
    return tuple(
        Block(
            page,
            text.count("\n", 0, match.start("ticks")) + 1,
            match["language"],
            match["title"] or "",
            match["text"],
            match["reason"] or "",
        )
        for match in _FENCE.finditer(text)
    )


def blocks(language: str) -> list[Block]:
    """Return the blocks of all pages in a language that are to be run."""
    return [b for page in PAGES for b in blocks_of(page) if b.language == language and not b.reason]


def outside_of_blocks(page: Path) -> str:
    """Return a page's text without its blocks."""
    return _FENCE.sub("", page.read_text("utf-8"))


def files() -> dict[str, str]:
    """Return the files that blocks with a title are, by their path."""
    return {b.title: b.text for page in PAGES for b in blocks_of(page) if b.title}


def write_files(folder: Path, below: str) -> None:
    """Write the files whose path is this one, or begins with this folder."""
    for title, text in files().items():
        if title == below or title.startswith(f"{below}/"):
            target = folder / title
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")

"""The extras that messages and documents name are those of pyproject.toml, quoted for every shell."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.remote.remotes import missing_extra

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS = set(PROJECT["optional-dependencies"])
NAME = PROJECT["name"]

QUOTED = re.compile(rf"""(?P<before>.?)(?:{NAME}|(?<![\w/*])\.)\[(?P<extras>[a-z]+(?:,[a-z]+)*)\]""")
NAMED = re.compile(r"\bextra,? `+([a-z]+)`+|\bthe extra ([a-z]+) reads")
MADE = re.compile(r"""missing_extra\([^()]*"([a-z]+)"\)""")


def texts() -> Iterator[tuple[str, str]]:
    kinds = ("*.py", "*.md", "*.toml", "*.html", "*.js")
    for folder in ("playground", "docs", "glsl"):
        for kind in kinds:
            for path in sorted((ROOT / folder).rglob(kind)):
                if "node_modules" not in path.parts:
                    yield path.relative_to(ROOT).as_posix(), path.read_text("utf-8")
    for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"):
        yield name, (ROOT / name).read_text("utf-8")


def named() -> list[tuple[str, str, str]]:
    """Return every extra that is named: the file, the extra, and the letter before what pip is to install."""
    found = []
    for path, text in texts():
        for match in QUOTED.finditer(text):
            if re.search(r"pip install [^\n]{0,12}$", text[: match.start() + 1]) or match["before"] in "\"'":
                found += [(path, extra, match["before"]) for extra in match["extras"].split(",")]
        for pattern in (NAMED, MADE):
            found += [(path, next(filter(None, m.groups())), "") for m in pattern.finditer(text)]
    return found


ALL = named()


def test_every_extra_that_is_named_exists():
    wrong = [(path, extra) for path, extra, _ in ALL if extra not in EXTRAS]
    assert not wrong
    assert {path.partition("/")[0] for path, _, _ in ALL} >= {"playground", "docs", "README.md"}


def test_they_are_quoted_so_that_every_shell_takes_them():
    """In cmd.exe single quotes belong to the word; in zsh brackets without quotes are a pattern."""
    wrong = [(path, extra, before) for path, extra, before in ALL if before not in ('"', "")]
    assert not wrong


def test_how_to_install_names_every_extra():
    page = {extra for path, extra, _ in ALL if path == "docs/how-to/install.md"}
    assert page == EXTRAS


@pytest.mark.parametrize(
    ("package", "extra"), [("mido", "midi"), ("python-osc", "osc"), ("aiohttp", "remote")]
)
def test_a_message_names_the_extra_that_has_the_package(package: str, extra: str):
    message = str(missing_extra("it", package, extra))
    assert f'pip install "{NAME}[{extra}]"' in message and package in message
    assert any(re.match(rf"{package}\b", needed) for needed in PROJECT["optional-dependencies"][extra])

"""The extras that messages and documents name are those of pyproject.toml, quoted for every shell."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from playground import extras
from playground.commands.extras import main

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS = set(PROJECT["optional-dependencies"])
NAME = PROJECT["name"]

QUOTED = re.compile(rf"""(?P<before>.?)(?:{NAME}|(?<![\w/*])\.)\[(?P<extras>[a-z]+(?:,[a-z]+)*)\]""")
NAMED = re.compile(r"\bextra,? `+([a-z]+)`+|\bthe extra ([a-z]+) reads")
MADE = re.compile(r"""\b(?:needs|install_command)\([^()]*["']([a-z]+)["']\)""")
OFFERED = re.compile(r"\./play add ([a-z ]+)")


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
    result = []
    for path, text in texts():
        for match in QUOTED.finditer(text):
            if re.search(r"pip install [^\n]{0,12}$", text[: match.start() + 1]) or match["before"] in "\"'":
                result += [(path, extra, match["before"]) for extra in match["extras"].split(",")]
        for match in OFFERED.finditer(text):
            result += [(path, extra, "") for extra in match[1].split()]
        for pattern in (NAMED, MADE):
            result += [(path, next(filter(None, m.groups())), "") for m in pattern.finditer(text)]
    return result


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
    table = re.findall(r"^\| (`.*?`) \|", (ROOT / "docs/how-to/install.md").read_text("utf-8"), re.MULTILINE)
    page = {extra for cell in table for extra in re.findall(r"`([a-z]+)`", cell)}
    assert page == EXTRAS


def test_every_extra_has_a_purpose():
    assert set(extras.EXTRAS) == EXTRAS


def test_no_text_installs_this_distribution_from_an_index():
    """It is on none; CHANGELOG.md tells what was."""
    wrong = re.compile(rf"""pip install (?:-\S+ )*["'\\]*{NAME}(?!\S*\.whl)""")
    assert not [path for path, text in texts() if path != "CHANGELOG.md" and wrong.search(text)]


@pytest.mark.parametrize(
    ("package", "extra"), [("mido", "midi"), ("python-osc", "osc"), ("aiohttp", "remote"), ("av", "video")]
)
def test_a_message_names_the_extra_that_has_the_package(package: str, extra: str):
    message = extras.needs("it", package, extra)
    assert message == f"it needs {package}: {extras.install_command(extra)}"
    assert any(re.match(rf"{package}\b", needed) for needed in PROJECT["optional-dependencies"][extra])


# The command for each kind of installation


def test_a_checkout_that_play_started_is_told_to_add(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    checkout = tmp_path / "my land"
    (checkout / ".venv").mkdir(parents=True)
    (checkout / ".venv" / ".play-stamp").touch()
    monkeypatch.setattr(extras, "CHECKOUT", checkout)
    monkeypatch.setattr(sys, "prefix", str(checkout / ".venv"))
    monkeypatch.chdir(checkout)
    assert extras.install_command("gis") == "./play add gis"
    monkeypatch.chdir(tmp_path)
    assert words_of(extras.install_command("gis")) == [str(checkout / "play"), "add", "gis"]


def test_a_checkout_in_another_environment_keeps_editable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    checkout, python = tmp_path / "my $land", str(tmp_path / "an environment" / "bin" / "python")
    monkeypatch.setattr(extras, "CHECKOUT", checkout)
    monkeypatch.setattr(sys, "executable", python)
    command = [python, "-m", "pip", "install", "-e", f"{checkout}[gis]"]
    assert words_of(extras.install_command("gis")) == command


@pytest.mark.parametrize("extra", sorted(EXTRAS))
def test_a_wheel_is_told_the_packages_of_the_extra(
    extra: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    info = tmp_path / "terrain_shader_playground-9.dist-info"
    info.mkdir()
    lines = [f"Requires-Dist: {line}" for line in ("numpy>=2.1", *as_in_a_wheel())]
    (info / "METADATA").write_text(
        "\n".join([f"Metadata-Version: 2.4\nName: {NAME}\nVersion: 9", *lines, ""])
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(extras, "CHECKOUT", None)
    words = words_of(extras.install_command(extra))
    assert words[:4] == [sys.executable, "-m", "pip", "install"]
    assert {Requirement(text) for text in words[4:]} == set(expanded(extra))


def words_of(command: str) -> list[str]:
    """Return the words of a command as the shell hands them over."""
    if os.name == "nt":
        return shlex.split(command, posix=False)
    script = f"set -- {command}\nprintf '%s\\n' \"$@\""
    return subprocess.run(
        ["sh", "-c", script], capture_output=True, text=True, check=True
    ).stdout.splitlines()


def as_in_a_wheel() -> Iterator[str]:
    """Write the extras as metadata have them: the condition of each requirement names its extra."""
    for extra, listed in PROJECT["optional-dependencies"].items():
        for text in listed:
            needed, _, marker = text.partition(";")
            yield (
                f"{needed.strip()}; ({marker.strip()}) and extra == '{extra}'"
                if marker
                else (f"{needed}; extra == '{extra}'")
            )


def expanded(extra: str) -> Iterator[Requirement]:
    for text in PROJECT["optional-dependencies"][extra]:
        needed = Requirement(text)
        if needed.name == NAME:
            yield from (each for other in needed.extras for each in expanded(other))
        else:
            yield needed


# ./play add


def test_without_names_the_extras_are_listed_with_their_packages(capsys: pytest.CaptureFixture[str]):
    assert main([]) == 0
    listed = re.split(r"\n(?=\S)", capsys.readouterr().out)
    assert [line.split()[0] for line in listed] == sorted(EXTRAS)
    for line in listed:
        names = {needed.name for needed in expanded(line.split()[0])}
        assert names <= set(re.findall(r"[\w-]+", line))


def test_names_are_checked_and_the_nearest_is_suggested(capsys: pytest.CaptureFixture[str]):
    assert main(["gis", "video", "gis"]) == 0
    assert capsys.readouterr().out == "gis,video\n"
    assert main(["gis", "vidoe"]) == 2
    assert capsys.readouterr().err == "play: no extra 'vidoe'; did you mean 'video'?\n"

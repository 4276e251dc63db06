"""Texts as they are edited, read in place of their files: of an editor, or of the window's code pane."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playground.allowed_files import SHADERS, looking_once, reading_unsaved, root_of
from playground.paths import GLSL, SKETCHES
from playground.shader.source import read_text
from playground.sketch import shader_names
from playground.sketch.shader_names import Shader

_HEAD = re.compile(r"^[ \t]*format[ \t]*=", re.MULTILINE)
_PASS = re.compile(r"^[ \t]*\[\[[ \t]*pass[ \t]*\]\]", re.MULTILINE)


@dataclass(frozen=True)
class EditedText:
    """The text of a file as it is edited."""

    path: Path  # where it is or would be saved, links followed
    text: str  # with LF at its lines' ends

    @property
    def is_toml(self) -> bool:
        """Whether it is, or may become, a sketch or a technique of several passes."""
        return self.path.suffix == ".toml"

    @property
    def is_ours(self) -> bool:
        """Whether it is a shader, or a TOML that is a sketch or a technique and of no other program."""
        if not self.is_toml:
            return self.path.suffix in SHADERS
        head = self.text.partition("\n[")[0]
        is_sketch = self.path.name == "sketch.toml" or self.path.is_relative_to(GLSL)
        return is_sketch or bool(_HEAD.search(head) or _PASS.search(self.text))

    @property
    def root(self) -> Path:
        """The folder that it may include from, besides ``glsl/``."""
        return root_for(self.path)


def root_for(path: Path) -> Path:
    """Return the folder that a file may include from, as ``check`` has it."""
    return GLSL if path.is_relative_to(GLSL) and not path.is_relative_to(SKETCHES) else root_of(path)


class EditedTexts:
    """The texts that are open, and the folders whose files may be changed with them."""

    def __init__(self, texts: Iterable[EditedText] = (), folders: tuple[Path, ...] = ()) -> None:
        self.folders = folders
        self._texts = tuple(texts)

    def __iter__(self) -> Iterator[EditedText]:
        return iter(self._texts)

    def at(self, path: Path) -> EditedText | None:
        """Return the open text of a file; None where it is not open."""
        return next((text for text in self if text.path == path), None)

    def read(self, path: Path) -> str:
        """Return the text of a file, as it is open; raise ``SketchError`` where it cannot be read."""
        text = self.at(path)
        return text.text if text is not None else read_text(path)

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Take the open texts in place of what their files hold."""
        with reading_unsaved({text.path: text.text for text in self}), looking_once():
            yield

    def is_open_folder(self, path: Path) -> bool:
        """Return whether a file is in a folder that is open, or is open itself."""
        return any(path.is_relative_to(folder) for folder in self.folders) or self.at(path) is not None


def shader_of(text: EditedText, texts: EditedTexts) -> Shader:
    """Return what is known of an open shader."""
    return shader_at(text.path, text.text, text.root, texts)


def shader_at(path: Path, text: str, root: Path, texts: EditedTexts) -> Shader:
    """Return what is known of a shader's file, with the texts that are open in place of the files'."""
    with texts.reading():
        return shader_names.shader_at(path, text, root)

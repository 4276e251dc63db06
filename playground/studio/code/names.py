"""The names in open texts: what may stand at a place, what stands there, where it is declared, a new name.

The language server's core answers. It reads syntax, which a start does without, so it is imported when it is
first asked. A place is an offset in its text.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import PlaygroundError

if TYPE_CHECKING:
    from playground.sketch.edited import EditedText, EditedTexts
    from playground.sketch.rename import Edit
    from playground.sketch.shader_names import DeclarationSite
    from playground.sketch.suggestions import Suggestion


class Names:
    """Answers for the files of one pane; ``typed`` returns the texts in it that are not saved."""

    def __init__(self, typed: Callable[[], Mapping[Path, str]]) -> None:
        self._typed = typed
        self._is_prepared = False
        self._known: tuple[object, Suggestion | None] = (None, None)  # of the word that was asked for last

    def prepare(self) -> None:
        """Read what the library declares, in the background: the first completion need not wait for it."""
        if not self._is_prepared:
            self._is_prepared = True
            threading.Thread(target=_read_library, name="library", daemon=True).start()

    def suggest(self, path: Path, text: str, at: int) -> list[Suggestion]:
        """Return what may stand at a place of a kernel's or a sketch's text."""
        from playground.engine.meshes import MESHES
        from playground.engine.sources import SOURCES
        from playground.sketch.suggestions import suggestions
        from playground.sketch.toml_suggestions import suggestions_in_sketch

        opened, texts = self._opened(path, text)
        listed = {"mesh": tuple(MESHES), "name": tuple(SOURCES)}
        try:
            with texts.reading():
                if opened.is_toml:
                    return suggestions_in_sketch(opened, at)
                return suggestions(path, text, opened.root, at, listed)
        except PlaygroundError:
            return []

    def meaning(self, path: Path, text: str, at: int) -> Suggestion | None:
        """Return what is known of the word at a place; None for nothing."""
        from playground.shader.names import word_at
        from playground.sketch.toml_suggestions import meaning_in_sketch

        word, start = word_at(text, at)
        key = path, text, start, word
        if self._known[0] != key:
            opened, texts = self._opened(path, text)
            if opened.is_toml:
                with texts.reading():
                    self._known = key, meaning_in_sketch(opened, at)
            else:
                found = self.suggest(path, text, start + len(word)) if word else []
                known = (each for each in found if each.label == word and each.kind != "keyword")
                self._known = key, next(known, None)
        return self._known[1]

    def declaration(self, path: Path, text: str, at: int) -> DeclarationSite | None:
        """Return where what stands at a place is declared; None where that is not known."""
        from playground.shader.names import word_at
        from playground.sketch.edited import shader_of
        from playground.sketch.toml_suggestions import declaration_in_sketch

        opened, texts = self._opened(path, text)
        word, start = word_at(text, at)
        try:
            with texts.reading():
                if opened.is_toml:
                    return declaration_in_sketch(opened, at)
                return shader_of(opened, texts).find(word, start) if word else None
        except PlaygroundError:
            return None

    def rename_span(self, path: Path, text: str, at: int) -> tuple[int, int]:
        """Return where the name at a place is; raise ``Refused`` where it cannot be renamed."""
        from playground.sketch.rename import prepare

        return prepare(*self._opened(path, text), at)

    def rename(self, path: Path, text: str, at: int, new: str, folder: Path) -> dict[Path, list[Edit]]:
        """Return the edits, by file, that rename what is at a place; raise ``Refused`` where that is unsafe.

        Files in ``folder`` may change, and those with a text that is not saved.
        """
        from playground.sketch.rename import rename

        opened, texts = self._opened(path, text)
        texts.folders = (folder,)
        return rename(opened, texts, at, new)

    def _opened(self, path: Path, text: str) -> tuple[EditedText, EditedTexts]:
        from playground.sketch.edited import EditedText, EditedTexts

        typed = {**self._typed(), path: text}
        texts = [EditedText(each, typed) for each, typed in typed.items()]
        return EditedText(path, text), EditedTexts(texts)


def _read_library() -> None:
    from playground.sketch.shader_names import library_declared

    library_declared()

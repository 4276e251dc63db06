"""Read the files of another tool's shader, and know what they were: readers get their texts from here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import Diagnostic, SketchError
from playground.paths import PART_OF_FILE, shown
from playground.sketch.allowed_files import is_file, is_inside
from playground.sketch.dialects.foreign import commented_files, places_of
from playground.sketch.source import Line, Origin, SourceText, normalised, read_source_and_origin, read_text


@dataclass
class Files:
    """The files of one shader, inside ``root``.

    ``instead`` has texts, by absolute path, in place of files'; ``named``: a user has named the dialect.
    """

    path: Path
    root: Path
    instead: Mapping[str, str] = field(default_factory=dict)
    named: bool = False
    title: str = ""  # that the other tool gives it
    notes: list[Diagnostic] = field(default_factory=list)  # of what is not as in the other tool
    _origins: list[Origin] = field(default_factory=list)
    _texts: dict[str, str] = field(default_factory=dict)
    _there: dict[Path, bool] = field(default_factory=dict)

    def text(self, path: Path | None = None) -> str:
        """Return a file's text, by default the shader's; raise ``SketchError`` where it cannot be read."""
        path = path or self.path
        found = self.instead.get(str(path))
        found = read_text(path, any_encoding=True) if found is None else found
        self._texts[str(path)] = found
        return found

    def check_inside(self, path: Path) -> None:
        """Raise ``SketchError`` for a file that leads out of the root; a user may name such a shader."""
        if path != self.path and not is_inside(path, (self.root,)):
            message = f"this leads outside the shader's own folder, {shown(self.root)}, and is not read"
            raise SketchError(message, file=shown(path))

    def source(self, path: Path | None = None) -> SourceText:
        """Return a file with its includes, by default the shader's; raise as ``read_source`` does."""
        self.check_inside(path or self.path)
        source, origin = read_source_and_origin(path or self.path, (self.root,), self.instead, foreign=True)
        self._origins.append(origin)
        for line, file in commented_files(source):
            for place in places_of(file, line, self.root):
                self.is_there(place)
        return source

    def part(self, label: str, text: str) -> SourceText:
        """Return a text that is a part of the file: its lines are those of "file:label", from 1."""
        named = self.path.with_name(f"{self.path.name}{PART_OF_FILE}{label}")
        instead = {**self.instead, str(named): normalised(text)}
        source, origin = read_source_and_origin(named, (self.root,), instead, foreign=True)
        self._origins.append(Origin(tuple(t for t in origin.texts if t[0] != str(named)), origin.places))
        files = (str(self.path), *(name for name in source.files if name != str(named)))
        return SourceText(str(self.path), source.lines, files)

    def note(self, message: str, line: int = 0, path: Path | None = None) -> None:
        """Note what a user is told of the file, at one of its lines."""
        self._note(Diagnostic(message, shown(path or self.path), line, severity="warning"))

    def note_at(self, line: Line, message: str) -> None:
        """Note what a user is told of a line."""
        self._note(line.diagnostic(message, severity="warning"))

    def _note(self, found: Diagnostic) -> None:
        if found not in self.notes:
            self.notes.append(found)

    def is_there(self, place: Path) -> bool:
        """Return whether there is a file at a place, in the folder or not."""
        found = self._there[place] = str(place) in self.instead or is_file(place)
        return found

    def hold(self) -> bool:
        """Return whether all that was read and looked for is still the same."""
        return (
            all(is_file(place) == there for place, there in self._there.items())
            and Origin(tuple(self._texts.items()), ()).holds()
            and all(origin.holds() for origin in self._origins)
        )

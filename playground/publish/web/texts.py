"""Gather the GLSL of a page: each file once, under a name that says nothing of where it lies on a disk.

A file of the library is named as sketches include it ("noise/hash.glsl"), one of a sketch's own folder
as "./waves.glsl", one of a library that the user named as that library's ("lygia/math/saturate.glsl").
Of another tool's shader, whose lines the playground rewrote, the page gets the rewritten ones.
"""

from __future__ import annotations

from pathlib import Path

from playground.errors import PlaygroundError
from playground.paths import GLSL, PART_OF_FILE
from playground.shader.libraries import libraries, library_around
from playground.shader.source import Line, SourceText, read_source


class Texts:
    """The files of a page by name, and which file each include means."""

    def __init__(self) -> None:
        self.files: dict[str, str] = {}
        self.includes: dict[str, dict[str, str]] = {}
        self._names: dict[str, str] = {}  # absolute path, or what else a text is known by → name
        self._added: dict[tuple[int, str, str], tuple[SourceText, str]] = {}  # by identity, which it keeps

    def add(self, source: SourceText, folder: str, label: str) -> str:
        """Add all files of a kernel's text; return the name of the outermost.

        ``folder`` is the sketch's; ``label`` names the text where it is not that of its file.
        """
        key = (id(source), folder, label)
        if key not in self._added:
            self._added[key] = source, self._add(source, folder, label)
        return self._added[key][1]

    def _add(self, source: SourceText, folder: str, label: str) -> str:
        files = _files_of(source)
        if not _is_as_written(source, files, folder):
            return self._rewritten(source, folder, label)
        for path, text in files.items():
            self.files[self._name(path, folder)] = text
        for file, written, target in source.includes:
            self.includes.setdefault(self._name(file, folder), {})[written] = self._name(target, folder)
        return self._name(source.path, folder)

    def lines_of(self, source: SourceText, folder: str, label: str) -> dict[tuple[str, int], tuple[str, int]]:
        """Return where each line of a text is: the name of its file here, and its number there.

        By the absolute path and the number of the author's file.
        """
        name = self.add(source, folder, label)
        if name != self._names.get(source.path):  # all of its lines are one text
            return {(line.file, line.number): (name, at) for at, line in enumerate(source.lines, 1)}
        return {
            (line.file, line.number): (self._name(line.file, folder), line.number) for line in source.lines
        }

    def add_file(self, path: str, text: str, folder: str) -> str:
        """Add a text that is no shader, such as a sketch's TOML; return its name."""
        name = self._name(path, folder)
        self.files[name] = text
        return name

    def name_of(self, path: Path) -> str:
        """Return the name of a file of the library, which need not be among the texts."""
        return self._names.get(str(path)) or _short_name(path, "")

    def _rewritten(self, source: SourceText, folder: str, label: str) -> str:
        text = "\n".join(map(_with_comment, source.lines))
        name_known = f"{source.path}{PART_OF_FILE}{label}"
        if self.files.get(self._names.get(name_known, ""), text) != text:
            name_known += f" {len(self.files)}"
        name = self._name(name_known, folder)
        self.files[name] = text
        return name

    def _name(self, path: str, folder: str) -> str:
        if path not in self._names:
            short_name = _short_name(Path(path), folder)
            name, number = short_name, 2
            while name in self._names.values():
                name, number = f"{short_name}-{number}", number + 1
            self._names[path] = name
        return self._names[path]


def _short_name(path: Path, folder: str) -> str:
    if path.is_relative_to(GLSL):
        return path.relative_to(GLSL).as_posix()
    if path.is_relative_to(folder):
        return f"./{path.relative_to(folder).as_posix()}"
    named = libraries()
    around = library_around(path, named)
    return f"{around}/{path.relative_to(named[around]).as_posix()}" if around else f"./{path.name}"


def _files_of(source: SourceText) -> dict[str, str]:
    """Return the texts of a source's files by path, as they were read."""
    lines: dict[str, dict[int, str]] = {}
    for line in source.lines:
        lines.setdefault(line.file, {}).setdefault(line.number, line.text)
    return {file: "\n".join(numbered[n] for n in sorted(numbered)) for file, numbered in lines.items()}


def _is_as_written(source: SourceText, files: dict[str, str], folder: str) -> bool:
    """Return whether its files give a source's lines, or something has been rewritten in between."""
    try:
        return read_source(Path(source.path), (Path(folder), GLSL), files).code == source.code
    except PlaygroundError:
        return False


def _with_comment(line: Line) -> str:
    comment = f"//{line.comment}" if line.comment else ""
    return f"{line.code}  {comment}" if line.code and comment else line.code or comment

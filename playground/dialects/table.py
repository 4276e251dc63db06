"""Read shaders of other tools, unchanged, as sketches: a table of dialects, by their signs.

A reader returns an ordinary ``Graph`` of plain shaders. The file's lines stay where they are, so that a
driver's complaint names them. Each reader is imported with the first file that shows its signs: most
sketches have none.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import Diagnostic
from playground.memo import FILES
from playground.shader.conditions import WEBGL_2, code_of, live_code
from playground.shader.dialect import OWN, Dialects, Read, has_own_pragma
from playground.shader.kernel import ForeignShader, Graph
from playground.shader.source import read_text
from playground.shader.syntax.tokens import is_named

if TYPE_CHECKING:
    from playground.dialects.foreign import Files, Made, Shader

_EXPORTED = ".json"
_REFUSED = "sound"

_ISF = re.compile(
    r"(?:\s|//[^\n]*\n)*/\*\s*\{(?:\s*\}|(?:(?!\*/).)*"
    r'"(?:INPUTS|PASSES|ISFVSN|VSN|CATEGORIES|IMPORTED|PERSISTENT_BUFFERS|DESCRIPTION|CREDIT)"\s*:)',
    re.DOTALL,
)
_DESCRIBED = re.compile(r"(?:\s|//[^\n]*\n)*/\*\s*\{")
_ISF_NAMES = frozenset(
    "isf_FragNormCoord vv_FragNormCoord IMG_PIXEL IMG_NORM_PIXEL IMG_THIS_PIXEL IMG_THIS_NORM_PIXEL IMG_SIZE "
    "RENDERSIZE FRAMEINDEX PASSINDEX TIME TIMEDELTA DATE".split()
)
_EXPORT = re.compile(r'\s*[\[{](?=.*"renderpass")', re.DOTALL)
_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(?:i[A-Z]\w*|StrictCompatibility)\b", re.MULTILINE)


@dataclass(frozen=True)
class Dialect:
    """A row of the table."""

    name: str  # as --dialect takes it
    sign: Callable[[str, str], object]  # of the text, and of its code
    reader: str = ""  # module and function that give its passes; "": our own
    # No passes: the file runs as it is, as a plain shader.
    is_webgl: bool = False  # its branches are judged as WebGL 2 judges them
    in_folders: bool = False  # a file may be one of several in a folder
    ending: str = ".frag"  # of a new file for a text

    def shaders(self, files: Files) -> Sequence[Shader | Made]:
        """Return the passes of a file, or of the folder that it is one of several in."""
        if self.in_folders:
            from playground.dialects import shadertoy

            if shadertoy.has_more(files):
                return shadertoy.folder_passes(files)
        module, _, function = self.reader.partition(".")
        passes: Sequence[Shader | Made] = getattr(import_module(f"{__package__}.{module}"), function)(files)
        return passes


def _names(code: str, *names: str, called: bool = False) -> bool:
    return any(is_named(line, names, called=called) for line in code.split("\n"))


def _is_isf(text: str, code: str) -> bool:
    """Return whether a text begins with ISF's description, or with another and reads a name of ISF's."""
    return bool(_ISF.match(text) or (_DESCRIBED.match(text) and _names(code, *_ISF_NAMES)))


def _has_main(text: str, code: str) -> bool:
    return _names(code, "main", called=True)  # where a line ends, a macro may stand for it


ROWS = (
    Dialect("isf", _is_isf, "isf.shaders", ending=".fs"),
    Dialect("export", lambda text, code: _EXPORT.match(text), "shadertoy.export_shaders", ending=_EXPORTED),
    Dialect(OWN, lambda text, code: has_own_pragma(code), ending=".glsl"),
    Dialect(
        "vscode", lambda text, code: _DIRECTIVE.search(code), "shadertoy.vscode_shaders", in_folders=True
    ),
    Dialect(
        "shadertoy",
        lambda text, code: _names(code, "mainImage") and not _has_main(text, code),
        "shadertoy.shaders",
        is_webgl=True,
        in_folders=True,
    ),
    Dialect("main", _has_main, "main.shaders"),
    Dialect(
        _REFUSED,
        lambda text, code: _names(code, "mainSound", "mainVR", "mainCubemap", called=True),
        "shadertoy.refused",
        in_folders=True,
    ),
)
"""The dialects, in the order in which a text is looked at."""


def dialect_of(text: str) -> Dialect | None:
    """Return the dialect of a text, by the first sign that it shows; None where it has nothing to run.

    Branches that are off count where nothing else shows a sign.
    """

    def live(dialect: Dialect) -> str:
        return live_code(text, WEBGL_2 if dialect.is_webgl else {})

    dialect = next((d for d in ROWS if d.sign(text, live(d))), None)
    return dialect or next((d for d in ROWS if d.sign(text, code_of(text))), None)


class _OfOtherTools(Dialects):
    """The interface, by the rows above."""

    names = tuple(d.name for d in ROWS if d.name != _REFUSED)
    endings = (_EXPORTED,)

    def name_of(self, text: str) -> str:
        dialect = dialect_of(text)
        return dialect.name if dialect else ""

    def ending(self, name: str) -> str:
        return next(d.ending for d in ROWS if d.name == name)

    def is_export(self, path: Path) -> bool:
        return path.suffix == _EXPORTED and _EXPORT.match(read_text(path)) is not None

    def read(
        self,
        path: Path,
        name: str,
        root: Path,
        read: Read,
        dialect: str = "",
        *,
        instead: Mapping[str, str] | None = None,
    ) -> Graph | None:
        from playground.dialects.foreign import Files, graph_of_shaders

        key = (_OfOtherTools, path, root, dialect)
        cached: tuple[Graph | None, Files] | None = FILES.get(key) if not instead else None
        if cached is not None and cached[1].hold():
            return cached[0]
        files = Files(path, root, instead or {}, named=bool(dialect))
        text = files.text()
        chosen = next((d for d in ROWS if d.name == dialect), None) if dialect else dialect_of(text)
        if chosen is None or not chosen.reader:
            return None
        shaders = chosen.shaders(files)
        graph = graph_of_shaders(name, shaders, read, root) if shaders else None
        if graph is not None:
            title = files.title or graph.title
            graph = replace(graph, title=title, warnings=(*files.notes, *graph.warnings))
        if not instead:
            FILES.put(key, (graph, files))
        return graph

    def image_of(self, folder: Path) -> Path | None:
        from playground.dialects.shadertoy import image_of

        return image_of(folder)

    def is_inside(self, path: Path) -> bool:
        from playground.dialects.shadertoy import is_image, is_of_folder

        return not is_image(path) and is_of_folder(path)

    def head(self, kernel: ForeignShader) -> str:
        if kernel.dialect != "isf":
            return ""
        from playground.dialects.isf import read_header

        return f"/*{json.dumps(read_header(kernel.source).table)}*/\n"

    def given(self) -> Mapping[str, tuple[str, str]]:
        from playground.dialects import isf, main

        return {**isf.NAMES, **main.NAMES}

    def unfed_warnings(self, kernel: ForeignShader, wired: Collection[str]) -> tuple[Diagnostic, ...]:
        from playground.dialects.foreign import unfed_warnings

        return unfed_warnings(kernel, wired)

    def stand_ins(self) -> Collection[str]:
        from playground.dialects.foreign import STAND_INS

        return STAND_INS.values()

    def stand_in_paths(self, path: str, sampler: str) -> Collection[str]:
        from playground.dialects.foreign import stand_in_paths

        return stand_in_paths(path, sampler)

    def sizes(self) -> Mapping[str, tuple[str, str]]:
        from playground.dialects.foreign import SIZES

        return SIZES

    def size_of_shape(self, shape: str) -> tuple[str, str]:
        from playground.dialects.foreign import SIZES_OF_SHAPES, STAND_IN_SIZE

        return SIZES_OF_SHAPES.get(shape, STAND_IN_SIZE)


DIALECTS = _OfOtherTools()

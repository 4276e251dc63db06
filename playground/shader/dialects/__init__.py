"""Read shaders of other tools, unchanged, as sketches: a table of dialects, by their signs.

A reader returns an ordinary ``Graph`` of plain shaders. The file's lines stay where they are, so that a
driver's complaint names them. Each reader is imported with the first file that shows its signs: most
sketches have none.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import ParameterError, nearest
from playground.memo import FILES
from playground.shader.kernel import Graph
from playground.shader.source import read_text

if TYPE_CHECKING:
    from playground.shader.dialects.foreign import Files, Made, Read, Shader

OWN = "own"
EXPORT = ".json"
_REFUSED = "sound"

_ISF = re.compile(
    r"(?:\s|//[^\n]*\n)*/\*\s*\{(?:\s*\}|(?:(?!\*/).)*"
    r'"(?:INPUTS|PASSES|ISFVSN|VSN|CATEGORIES|IMPORTED|PERSISTENT_BUFFERS|DESCRIPTION|CREDIT)"\s*:)',
    re.DOTALL,
)
_DESCRIBED = re.compile(r"(?:\s|//[^\n]*\n)*/\*\s*\{")
_ISF_NAME = re.compile(
    r"\b(?:(?:isf|vv)_FragNormCoord|IMG_(?:NORM_|THIS_|THIS_NORM_)?PIXEL|IMG_SIZE|RENDERSIZE|FRAMEINDEX"
    r"|PASSINDEX|TIME|TIMEDELTA|DATE)\b"
)
_EXPORT = re.compile(r'\s*[\[{](?=.*"renderpass")', re.DOTALL)
_OWN_PRAGMA = re.compile(r"^[ \t]*#[ \t]*pragma[ \t]+(?:kernel|source|draw|compute)\b", re.MULTILINE)
_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(?:i[A-Z]\w*|StrictCompatibility)\b", re.MULTILINE)
_MAIN = re.compile(r"\bmain\s*(?:\(|$)", re.MULTILINE)  # a macro may stand for it
_MAIN_IMAGE = re.compile(r"\bmainImage\b")  # likewise
_SOUND = re.compile(r"\bmain(Sound|VR|Cubemap)\s*\(")


@dataclass(frozen=True)
class Dialect:
    """A row of the table."""

    name: str  # as --dialect takes it
    sign: Callable[[str, str], object]  # of the text, and of its code
    reader: str = ""  # module and function that give its passes; "": our own
    # No passes: the file runs as it is, as a plain shader.
    is_webgl: bool = False  # its branches are judged as WebGL 2 judges them
    in_folders: bool = False  # a file may be one of several in a folder

    def shaders(self, files: Files) -> Sequence[Shader | Made]:
        """Return the passes of a file, or of the folder that it is one of several in."""
        if self.in_folders:
            from playground.shader.dialects import shadertoy

            if shadertoy.has_more(files):
                return shadertoy.folder_passes(files)
        module, _, function = self.reader.partition(".")
        passes: Sequence[Shader | Made] = getattr(import_module(f"{__name__}.{module}"), function)(files)
        return passes


def _is_isf(text: str, code: str) -> bool:
    """Return whether a text begins with ISF's description, or with another and reads a name of ISF's."""
    return bool(_ISF.match(text) or (_DESCRIBED.match(text) and _ISF_NAME.search(code)))


DIALECTS = (
    Dialect("isf", _is_isf, "isf.shaders"),
    Dialect("export", lambda text, code: _EXPORT.match(text), "shadertoy.export_shaders"),
    Dialect(OWN, lambda text, code: _OWN_PRAGMA.search(code)),
    Dialect(
        "vscode", lambda text, code: _DIRECTIVE.search(code), "shadertoy.vscode_shaders", in_folders=True
    ),
    Dialect(
        "shadertoy",
        lambda text, code: _MAIN_IMAGE.search(code) and not _MAIN.search(code),
        "shadertoy.shaders",
        is_webgl=True,
        in_folders=True,
    ),
    Dialect("main", lambda text, code: _MAIN.search(code), "main.shaders"),
    Dialect(_REFUSED, lambda text, code: _SOUND.search(code), "shadertoy.refused", in_folders=True),
)
"""The dialects, in the order in which a text is looked at."""


def names() -> tuple[str, ...]:
    """Return what ``--dialect`` takes."""
    return tuple(d.name for d in DIALECTS if d.name != _REFUSED)


def check_name(name: str) -> str:
    """Return a dialect's name; raise ``ParameterError`` if it is none."""
    if name and name not in names():
        raise ParameterError(f"--dialect {name}: no such dialect{nearest(name, names())}")
    return name


def dialect_of(text: str) -> Dialect | None:
    """Return the dialect of a text, by the first sign that it shows; None where it has nothing to run.

    Branches that are off count where nothing else shows a sign.
    """
    from playground.shader.preprocessor import WEBGL_2, code_of, live_code

    def live(dialect: Dialect) -> str:
        return live_code(text, WEBGL_2 if dialect.is_webgl else {})

    dialect = next((d for d in DIALECTS if d.sign(text, live(d))), None)
    return dialect or next((d for d in DIALECTS if d.sign(text, code_of(text))), None)


def is_export(path: Path) -> bool:
    """Return whether a file is a JSON that Shadertoy, or a tool in its place, wrote."""
    return path.suffix == EXPORT and _EXPORT.match(read_text(path)) is not None


def read_foreign(
    path: Path,
    name: str,
    root: Path,
    read: Read,
    dialect: str = "",
    *,
    instead: Mapping[str, str] | None = None,
) -> Graph | None:
    """Read another tool's shader as a technique called ``name``; None for what is none.

    Its files stay in ``root``. ``dialect`` is one of ``names()``, or "" to go by its signs.
    ``instead`` has texts, by absolute path, in place of files'. The same files give the same object.

    Raises ``SketchError`` or ``ShaderError`` for what is wrong in the text.
    """
    from playground.shader.dialects.foreign import Files, graph_of_shaders

    key = (read_foreign, path, root, dialect)
    cached: tuple[Graph | None, Files] | None = FILES.get(key) if not instead else None
    if cached is not None and cached[1].hold():
        return cached[0]
    files = Files(path, root, instead or {}, named=bool(dialect))
    text = files.text()
    chosen = next((d for d in DIALECTS if d.name == dialect), None) if dialect else dialect_of(text)
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

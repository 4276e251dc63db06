"""Read a lesson's file: front matter between two lines of ``+++``, pieces of Markdown, tables of fences."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeVar

from markdown_it import MarkdownIt
from markdown_it.token import Token
from mdit_py_plugins.dollarmath import dollarmath_plugin

from playground.course import model
from playground.course.measures import MEASURES
from playground.course.model import Prose
from playground.course.scenes import PICTURE, STATE, Sketches, located, read_scene
from playground.errors import SketchError, nearest
from playground.paths import GLSL
from playground.shader.parameter import spell
from playground.shader.source import read_text
from playground.sketch.assign import resolve
from playground.sketch.toml_table import TomlFile

_KINDS = {
    "heading_open": "heading",
    "paragraph_open": "paragraph",
    "bullet_list_open": "list",
    "ordered_list_open": "list",
    "table_open": "table",
    "math_block": "formula",
    "blockquote_open": "quote",
    "code_block": "code",
    "fence": "fence",
    "hr": "rule",
}


@dataclass(frozen=True, slots=True)
class Piece:
    """A top-level part of a text: a paragraph, a list, a fenced block."""

    kind: str  # heading | paragraph | list | table | formula | quote | code | fence | rule
    text: str  # as written, without the empty lines around it
    line: int  # from 1, in the text
    level: int = 0  # of a heading, from 1
    info: str = ""  # of a fence: what follows its opening
    inside: str = ""  # of a fence: its lines


def parser() -> MarkdownIt:
    """Return the parser of lessons: CommonMark without HTML, with tables and formulas between dollars."""
    markdown = MarkdownIt("commonmark", {"html": False}).enable("table")
    return markdown.use(
        dollarmath_plugin, allow_space=False, allow_digits=False, allow_labels=False, double_inline=False
    )


def pieces(text: str) -> list[Piece]:
    """Split a text into its top-level parts, in order."""
    lines = text.split("\n")
    result = []
    for token in parser().parse(text):
        if token.level or token.map is None or token.type not in _KINDS:
            continue
        start, end = token.map
        written = "\n".join(lines[start:end]).strip("\n")
        level = int(token.tag[1]) if token.type == "heading_open" else 0
        fence = token.type == "fence"
        info, inside = (token.info.strip(), token.content) if fence else ("", "")
        result.append(Piece(_KINDS[token.type], written, start + 1, level, info, inside))
    return result


def formulas(text: str) -> Iterator[str]:
    """Yield the formulas of a text, as LaTeX."""
    for token in every_token(parser().parse(text)):
        if token.type.startswith("math_"):
            yield token.content


def links(text: str) -> Iterator[str]:
    """Yield the addresses that a text links to."""
    for token in every_token(parser().parse(text)):
        if token.type == "link_open":
            yield str(token.attrs["href"])


def images(text: str) -> Iterator[str]:
    """Yield the addresses of a text's images."""
    for token in every_token(parser().parse(text)):
        if token.type == "image":
            yield str(token.attrs["src"])


_ENDS = ("softbreak", "hardbreak", "paragraph_close", "heading_close", "td_close", "th_close")
_BLANKS = re.compile(r"[ \n]+")  # a no-break space stays


def plain(text: str, formula: Callable[[str], str] = str) -> str:
    """Return Markdown as plain text on one line, formulas as ``formula`` writes their LaTeX."""
    parts = []
    for token in every_token(parser().parse(text)):
        if token.type in _ENDS:
            parts.append(" ")
        elif token.type in ("math_inline", "math_block"):
            parts.append(formula(token.content))
        elif token.type in ("text", "code_inline", "fence", "code_block"):
            parts.append(token.content)
    return _BLANKS.sub(" ", "".join(parts)).strip()


def every_token(tokens: list[Token]) -> Iterator[Token]:
    """Yield every token, those inside of others too."""
    for token in tokens:
        yield token
        yield from every_token(token.children or [])


_EDGE = "+++"
_HEADING = re.compile(r"^#+\s*(.*?)\s*#*$")


@dataclass(frozen=True)
class Document:
    """A lesson's file: its front matter, and the pieces of its Markdown with their lines."""

    path: Path
    front: TomlFile
    pieces: tuple[Piece, ...]  # lines as in the file


def read_document(path: Path) -> Document:
    """Split a lesson's file; raise ``SketchError`` where it does not begin with front matter."""
    lines = read_text(path).split("\n")
    edges = [number for number, line in enumerate(lines) if line.rstrip() == _EDGE]
    if len(edges) < 2 or edges[0] != 0:
        raise SketchError(f"a lesson begins with TOML between two lines of {_EDGE}", file=path, line=1)
    end = edges[1]
    front = TomlFile(path, path.parent, "\n".join(lines[1:end]), 1)
    body = "\n".join(lines[end + 1 :])
    moved = tuple(replace(piece, line=piece.line + end + 1) for piece in pieces(body))
    return Document(path, front, moved)


def prose_of(piece: Piece) -> Prose:
    """Return the prose of a piece that is no block of a lesson's own."""
    markdown = piece.text
    if piece.kind == "heading":
        match = _HEADING.match(markdown)
        markdown = match[1] if match else markdown
    kind = "code" if piece.kind == "fence" else piece.kind
    return Prose(piece.line, piece.text, kind, piece.level, markdown)


def texts_in(front: TomlFile, key: str) -> tuple[str, ...]:
    """Return the list of texts that a key has; raise ``SketchError`` for anything else."""
    texts = front.take(front.table, key, list, [])
    if not all(isinstance(item, str) for item in texts):
        raise front.error(f"{key} = {spell(texts)}: expected texts in quotes", key)
    return tuple(texts)


B = TypeVar("B", bound=model.Named)


@dataclass(frozen=True)
class Fence:
    """A fenced block, opened: its kind, its name, and its lines as TOML."""

    kind: str
    name: str
    piece: Piece
    line: int  # in the file, from 1
    file: TomlFile
    sketches: Sketches

    def only(self, kind: type[model.Named], *own: str) -> None:
        """Raise ``SketchError`` for a key that is neither a text of such a block nor one of ``own``."""
        self.file.only(self.file.table, [*own, *map(model.key_of, model.translated_fields(kind))])

    def take(self, key: str, kind: type, default: Any) -> Any:
        """Return what a key has, checked to be of a kind."""
        return self.file.take(self.file.table, key, kind, default)

    def markdown(self, key: str, *, needed: bool = True) -> str:
        """Return the text that a key has; raise ``SketchError`` if it is needed and not there."""
        text: str = self.take(key, str, "")
        if needed and not text.strip():
            raise self.error(f'a {self.kind} block needs {key} = "…"')
        return text.strip()

    def texts(self, key: str) -> tuple[str, ...]:
        """Return the list of texts that a key has."""
        return tuple(item.strip() for item in texts_in(self.file, key))

    def block(self, kind: type[B], **fields: Any) -> B:
        """Return the block with these fields; its line, its name and its texts are read."""
        for text in model.translated_fields(kind):
            key, meaning = model.key_of(text), text.metadata
            if text.name not in fields:
                fields[text.name] = (
                    self.texts(key) if "listed" in meaning else self.markdown(key, needed=meaning["needed"])
                )
        return kind(line=self.line, text=self.piece.text, name=self.name, **fields)

    @property
    def state(self) -> dict[str, Any]:
        """Its keys that describe a picture."""
        return {key: value for key, value in self.file.table.items() if key in STATE}

    def scene(self, pixels: tuple[int, int] = PICTURE) -> model.Scene:
        """Return the picture that the block's own keys describe."""
        return read_scene(self.file, self.state, (), self.sketches, pixels)

    def error(self, message: str, *key_path: str | int) -> SketchError:
        """Return an error at a place in the block."""
        return self.file.error(message, *key_path)

    def located(self, *key_path: str | int) -> AbstractContextManager[None]:
        """Give an error inside the place of a key."""
        return located(self.file, *key_path)


def measure_of(
    fence: Fence, table: Mapping[str, Any], *key_path: str | int
) -> tuple[str, tuple[tuple[str, float], ...], tuple[float, float] | None]:
    """Return the name of the measure that a table asks for, its arguments, and what it must lie between."""
    file = fence.file
    what = file.take(table, "what", str, "", *key_path)
    if not what:
        raise fence.error(f'a {fence.kind} of a measure needs what = "…"', *key_path)
    if what not in MEASURES:
        message = f"what = '{what}': there is no such measure{nearest(what, MEASURES)}"
        raise fence.error(message, *key_path, "what")
    arguments: Mapping[str, Any] = file.take(table, "with", dict, {}, *key_path)
    parameters = MEASURES[what].arguments
    file.only(arguments, parameters, *key_path, "with")
    if any(name not in arguments for name in parameters):
        names = ", ".join(f"{name} = …" for name in parameters)
        raise fence.error(f"{what} needs with = {{ {names} }}", *key_path)
    taken = tuple(
        (name, float(file.take(arguments, name, float, 0.0, *key_path, "with"))) for name in parameters
    )
    return what, taken, _between(fence, table, *key_path)


def shader(fence: Fence) -> str:
    """Return the ``file`` of a block; raise ``SketchError`` unless it is in ``glsl/``."""
    file = fence.markdown("file")
    path = (GLSL / file).resolve()
    if not path.is_relative_to(GLSL.resolve()) or not path.is_file():
        names = [p.relative_to(GLSL).as_posix() for p in GLSL.rglob("*") if p.suffix in (".glsl", ".comp")]
        raise fence.error(f"file = '{file}': not in glsl/{nearest(file, names)}", "file")
    return file


def check_path(fence: Fence, scene: model.Scene, path: str, *key_path: str) -> None:
    """Raise ``SketchError`` where a key names no parameter of a picture."""
    with fence.located(*key_path):
        resolve(scene.sketch.graph, path)


def _between(fence: Fence, table: Mapping[str, Any], *key_path: str | int) -> tuple[float, float] | None:
    bounds = fence.file.take(table, "between", list, None, *key_path)
    if bounds is None:
        return None
    numbers = all(type(v) in (int, float) for v in bounds)
    if len(bounds) != 2 or not numbers or any(b < a for a, b in pairwise(bounds)):
        raise fence.error(f"between = {spell(bounds)}: expected [lowest, highest]", *key_path, "between")
    return float(bounds[0]), float(bounds[1])

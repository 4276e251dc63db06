"""GLSL in colours, line by line."""

from __future__ import annotations

from pygments.lexers.graphics import GLShaderLexer
from pygments.token import Comment, Keyword, Name, Number, Operator

from playground.memo import INTERFACE

Rgb = tuple[int, int, int]

_PLAIN: Rgb = (226, 230, 233)
_COLOURS: tuple[tuple[object, Rgb], ...] = (
    (Comment.Preproc, (220, 170, 220)),
    (Comment, (140, 160, 150)),
    (Keyword, (126, 186, 240)),
    (Number, (244, 196, 112)),
    (Operator, (190, 198, 204)),
    (Name.Builtin, (126, 220, 200)),
)


@INTERFACE.cached(weight=16)
def coloured(code: str) -> tuple[tuple[tuple[str, Rgb], ...], ...]:
    """Return the lines of a shader, each as its parts with their colours, 0..255."""
    lines: list[list[tuple[str, Rgb]]] = [[]]
    for kind, text in GLShaderLexer(stripnl=False, ensurenl=False).get_tokens(code):
        ink = next((rgb for group, rgb in _COLOURS if kind in group), _PLAIN)  # type: ignore[operator]
        for number, part in enumerate(text.split("\n")):
            if number:
                lines.append([])
            if part:
                lines[-1].append((part, ink))
    return tuple(tuple(line) for line in lines)

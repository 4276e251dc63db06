"""Warn of what a sketch's texts say and its picture does not show.

That is a sampler that nothing feeds, a division of whole numbers with a remainder, a ``#line``; and what the
readers of the files noted. ``engine.sketch_warnings`` has those that only a check looks for.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from playground.errors import Diagnostic
from playground.paths import GLSL
from playground.shader import expressions
from playground.shader.expressions import ExpressionError
from playground.shader.header import unfed_samplers
from playground.shader.source import SourceText
from playground.sketch.model import ForeignShader, Graph, Kernel, PlainShader, Sketch


def unheeded(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a picture does not show though the text says it: unfed samplers, ``1/4``, ``#line``."""
    is_plain = isinstance(kernel, PlainShader) and not isinstance(kernel, ForeignShader)
    diagnostics = [*(unfed_samplers(kernel.source) if is_plain else ())]
    diagnostics += whole_divisions(kernel.source)
    if isinstance(kernel, ForeignShader) and kernel.vertex_source:
        diagnostics += whole_divisions(kernel.vertex_source)
    diagnostics += [
        line.diagnostic("#line is left out, so that errors name the file's own lines", severity="warning")
        for line in kernel.source.lines
        if line.left_out
    ]
    return tuple(dict.fromkeys(diagnostics))


# ── divisions of whole numbers ───────────────────────────────────────────────

_MAYBE_DIVIDED = re.compile(r"[\d)]\s*/\s*[\d(]")
_TOKEN = re.compile(r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?\w*|[A-Za-z_]\w*|&&|\|\||[<>=!]=|\S")
_WHOLE = re.compile(r"\d+")
_MAX_LITERALS = 64  # tokens of a product of literals
_WHOLE_TYPE = re.compile(r"u?int|[iu]vec[234]")
_DECLARED_WHOLE = re.compile(r"\b(?:u?int|[iu]vec[234])\b(?!\s*\()([^;(){}]*)")
_TAKES = re.compile(r"\b[A-Za-z_]\w* ([A-Za-z_]\w*) \( ([^()]*\b(?:u?int|[iu]vec[234])\b[^()]*) \)")
_WHOLE_GIVEN = frozenset("size iteration iterations until stage texel gl_InstanceID gl_VertexID".split())
_TAKES_WHOLE = frozenset(
    "texelFetch texelFetchOffset textureSize imageLoad imageStore bitfieldExtract".split()
)
_GENERIC = frozenset("abs clamp max min sign".split())  # whole if their arguments are
_NO_CALLS = frozenset("if while for return".split())
_ENDS = frozenset(("(", ")", ",", ";", "{", "}", "?", ":", "&&", "||", "=", "return", "[", "]"))


def whole_divisions(source: SourceText) -> list[Diagnostic]:
    """Return a warning for each division of two whole literals that leaves a remainder, as ``1/4``.

    In GLSL that is a whole number, here 0. Left alone is what is meant so: an index, an array's size, and
    where a whole number is declared, set, compared or handed over.
    """
    if not _MAYBE_DIVIDED.search(source.code):
        return []
    diagnostics: list[Diagnostic] = []
    tokens: list[tuple[str, int, int]] = []  # text, index of its line, column
    directive = False
    for index, line in enumerate(source.lines):
        directive = line.code.lstrip().startswith("#") or (
            directive and source.lines[index - 1].code.endswith("\\")
        )
        if not directive:
            tokens += [(m[0], index, m.start() + 1) for m in _TOKEN.finditer(line.code)]
    texts = [text for text, _, _ in tokens]
    whole = set(_WHOLE_GIVEN)
    for declared in _DECLARED_WHOLE.finditer(" ".join(texts)):
        whole |= set(re.findall(r"(?:^|,)\s*([A-Za-z_]\w*)", declared[1]))
    whole |= {function[1] for function in _TAKES.finditer(" ".join(texts))}
    for at, text in enumerate(texts):
        if text != "/":
            continue
        start, left = _whole_before(texts, at)
        after, right = _whole_after(texts, at + 1)
        if left is None or not right or left % right == 0 or _is_whole(texts, start, after, whole):
            continue
        line, column = source.lines[tokens[start][1]], tokens[start][2]
        last, end = tokens[after - 1][1], tokens[after - 1][2] - 1 + len(texts[after - 1])
        written = line.code[column - 1 : end] if source.lines[last] is line else f"{left}/{right}"
        message = f"{written} divides whole numbers, which gives {left // right}; write {left}.0/{right}.0"
        diagnostics.append(line.diagnostic(message, column, "warning"))
    return diagnostics


def _whole_before(texts: Sequence[str], at: int) -> tuple[int, int | None]:
    """Return where the product of whole literals before a place begins, and its value if it is one."""
    start = at
    while 0 < start and at - start <= _MAX_LITERALS:
        begin = _group_before(texts, start)
        if begin == start or (begin > 0 and texts[begin] == "(" and re.match(r"\w", texts[begin - 1])):
            return at, None
        start = begin
        if start == 0 or texts[start - 1] not in ("*", "/", "%"):
            return start, _evaluated(texts[start:at])
        start -= 1
    return at, None


def _group_before(texts: Sequence[str], end: int) -> int:
    """Return where the literal or bracket of literals begins that ends at a place; else the place."""
    if _WHOLE.fullmatch(texts[end - 1]):
        return end - 1
    depth = 0
    for at in range(end - 1, max(end - _MAX_LITERALS, 0) - 1, -1):
        depth += (texts[at] == ")") - (texts[at] == "(")
        if depth == 0:
            return at if texts[at] == "(" else end
        if not re.fullmatch(r"[()+*/%-]|\d+", texts[at]):
            break
    return end


def _whole_after(texts: Sequence[str], start: int) -> tuple[int, int | None]:
    """Return where the literal, or the bracket of literals, ends that begins at a place, and its value."""
    depth = 0
    for at in range(start, min(start + _MAX_LITERALS, len(texts))):
        if not re.fullmatch(r"[()+*/%-]|\d+", texts[at]):
            break
        depth += (texts[at] == "(") - (texts[at] == ")")
        if depth == 0:
            return at + 1, _evaluated(texts[start : at + 1])
    return start, None


def _evaluated(texts: Sequence[str]) -> int | None:
    """Return the value of literals, brackets and operators, as GLSL has it of positive numbers; else None."""
    try:
        return int(expressions.evaluate(" ".join("//" if text == "/" else text for text in texts), {}))
    except ExpressionError:
        return None


def _is_whole(texts: Sequence[str], start: int, end: int, whole: set[str]) -> bool:
    """Return whether a division stands where a whole number is meant."""
    if _is_among_whole(texts, start, end, whole):
        return True
    before, depth, calls = start, 0, list[str]()
    while before > 0 and texts[before - 1] not in (";", "{", "}"):
        before -= 1
        depth += (texts[before] in (")", "]")) - (texts[before] in ("(", "["))
        if depth < 0:  # a bracket around it
            depth = 0
            if texts[before] == "[":
                return True
            calls.append(texts[before - 1] if before else "")
    # The innermost call decides; what is no call, as a bracket or if, leaves it to what is around.
    for call in calls:
        if _WHOLE_TYPE.fullmatch(call) or call in _TAKES_WHOLE or call == "switch":
            return True
        if re.fullmatch(r"[A-Za-z_]\w*", call) and call not in _NO_CALLS:
            return call in whole
    head = [text for text in texts[before:start] if text not in ("const", "highp", "mediump", "lowp", "(")]
    while head and head[0] in ("if", "else", "for", "while"):
        head.pop(0)
    if head and (_WHOLE_TYPE.fullmatch(head[0]) or head[0] == "case"):
        return True
    if "=" in head and _is_set_whole(" ".join(head[: head.index("=")]), whole):
        return True
    if head[:1] == ["return"]:
        return _returns_whole(texts, before)
    return False


def _is_among_whole(texts: Sequence[str], start: int, end: int, whole: set[str]) -> bool:
    """Return whether only whole numbers join a division, as in ``n + 7/2`` or ``max(n, 7/2)``."""
    while True:
        left, right = _reach(texts, start, -1), _reach(texts, end, 1)
        names = _names_read(texts, [*range(left, start), *range(end, right)])
        opens, closes = left - 1, right
        if not names and (generic := _opening_of_generic(texts, left)) >= 0:
            opens = generic
            while closes < len(texts) and texts[closes] == ",":
                closes = _reach(texts, closes + 1, 1)
            names = _names_read(texts, [*range(opens + 1, start), *range(end, closes)])
            left = opens - 1
        if names:
            return whole >= names
        is_bracket = opens >= 0 and texts[opens] == "(" and texts[closes : closes + 1] == [")"]
        if not is_bracket or (left == opens + 1 and re.match(r"\w", texts[opens - 1])):
            return False
        start, end = min(left, opens), closes + 1


def _reach(texts: Sequence[str], at: int, step: int) -> int:
    """Return how far the operands beside a place reach, with the brackets among them."""
    opens, closes = (("(", "["), (")", "]")) if step > 0 else ((")", "]"), ("(", "["))
    ends = _ENDS.difference(opens)
    depth, index = 0, at if step > 0 else at - 1
    while 0 <= index < len(texts):
        text = texts[index]
        if text in ends and depth == 0:
            break
        depth += (text in opens) - (text in closes)
        index += step
    return index if step > 0 else index + 1


def _opening_of_generic(texts: Sequence[str], at: int) -> int:
    """Return the index of the bracket around an argument of ``max`` or its like; -1 where none is there."""
    while at > 0 and texts[at - 1] == ",":
        at = _reach(texts, at - 1, -1)
    return at - 1 if at > 1 and texts[at - 1] == "(" and texts[at - 2] in _GENERIC else -1


def _names_read(texts: Sequence[str], places: Sequence[int]) -> set[str]:
    """Return the names and the numbers with a point at some places; no members, no ``max`` or its like."""
    return {
        texts[k]
        for k in places
        if re.match(r"[A-Za-z_]|\.\d|\d+\.", texts[k]) and texts[k - 1] != "." and texts[k] not in _GENERIC
    }


def _is_set_whole(target: str, whole: set[str]) -> bool:
    """Return whether what is set, as ``n``, ``n[k]``, ``v.x`` or ``s.count``, is a whole number."""
    bare = re.sub(r"\[[^\]]*\]", "", target).rpartition(")")[2]
    names = bare.strip("+-*/%&|^<> ").split(" . ")
    return names[0] in whole or (len(names) > 1 and names[-1] in whole)


def _returns_whole(texts: Sequence[str], at: int) -> bool:
    """Return whether the function around a place returns a whole number."""
    depth = 0
    for k in range(at - 1, -1, -1):
        depth += (texts[k] == "}") - (texts[k] == "{")
        if depth == -1 and texts[k] == "{" and k and texts[k - 1] == ")":
            opened = next((i for i in range(k - 1, -1, -1) if texts[i : i + 1] == ["("]), 0)
            if opened > 1 and re.match(r"[A-Za-z_]", texts[opened - 2]):
                return bool(_WHOLE_TYPE.fullmatch(texts[opened - 2]))
            depth = 0  # of an if or a loop
    return False


def warnings_of_sketch(sketch: Sketch) -> tuple[Diagnostic, ...]:
    """Return the warnings of a sketch's file and of its own techniques' files."""
    return tuple(dict.fromkeys([*sketch.warnings, *_of_graph(sketch.graph)]))


def _of_graph(graph: Graph) -> Iterator[Diagnostic]:
    if not Path(graph.path).is_relative_to(GLSL):
        yield from graph.warnings
    for spec in graph.passes:
        if isinstance(spec.technique, Graph):
            yield from _of_graph(spec.technique)

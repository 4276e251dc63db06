"""The page colours a GLSL text as Pygments does, character for character."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from pygments.lexers.graphics import GLShaderLexer
from pygments.token import Comment, Keyword, Number

from playground.paths import GLSL

from .node import RUNTIME, Node

pytestmark = pytest.mark.skipif(
    not (RUNTIME.parent / "node_modules" / "@codemirror").is_dir(),
    reason="needs npm ci in playground/publish/web",
)
FILES = sorted([*GLSL.rglob("*.glsl"), *GLSL.rglob("*.frag"), *GLSL.rglob("*.comp")])
OF_PYGMENTS = (
    (Comment.Preproc, "directive"),
    (Comment, "comment"),
    (Keyword, "keyword"),
    (Number, "number"),
)
OURS = {"annotation": "comment", "pragma": "directive", "type": "keyword", "builtin": ""}
# In a line of text: a directive that Pygments takes to its end, with the comment behind it.
_DIRECTIVE = re.compile(r"^[ \t]*#(?:.*\\\n)*.*$", re.MULTILINE)
# Suffixes of numbers, exponents without a point, hexadecimals that end in u: Pygments takes these for names.
_NUMBER = re.compile(r"(?<![\w.])(?:0[xX][0-9a-fA-F]+u?|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[uf]?)")


def by_pygments(text: str) -> list[str]:
    """Return what each character is."""
    names: list[str] = []
    for token, part in GLShaderLexer(stripnl=False, stripall=False, ensurenl=False).get_tokens(text):
        kind = next((name for known_names, name in OF_PYGMENTS if token in known_names), "")
        names += [kind] * len(part)
    assert len(names) == len(text)
    for match in _NUMBER.finditer(text):
        if names[match.start()] == "number":
            names[match.start() : match.end()] = ["number"] * len(match.group())
    return names


SPANS = """async (text, load) => {
    const { glslLanguage, glslColours } = await load("glsl_language.js");
    const { highlightTree } = await load("../node_modules/@lezer/highlight/dist/index.js");
    const spans = [];
    const tree = glslLanguage.parser.parse(text);
    highlightTree(tree, glslColours, (from, to, kind) => spans.push([from, to, kind]));
    return spans;
}"""


def by_page(node: Node, text: str) -> list[str]:
    """Return what each character is, by the names of Pygments."""
    names = [""] * len(text)
    for start, end, kind in node.run(SPANS, text):
        names[start:end] = [OURS.get(kind, kind)] * (end - start)
    return names


def judged(text: str) -> Iterator[int]:
    """Yield the places that both judge alike: no blanks, and of directives the first word."""
    apart: set[int] = set()
    for match in _DIRECTIVE.finditer(text):
        head = re.match(r"\s*#\s*\w*", match.group())
        assert head
        apart |= set(range(match.start() + head.end(), match.end()))
    yield from (at for at, character in enumerate(text) if not character.isspace() and at not in apart)


@pytest.mark.slow
@pytest.mark.parametrize("step", [5, pytest.param(1, marks=pytest.mark.slow)])
def test_every_shipped_text_is_coloured_as_by_pygments(node: Node, step: int):
    assert len(FILES) > 200
    seen: dict[str, int] = {}
    for path in FILES[::step]:
        text = path.read_text(encoding="utf-8").rstrip("\n")
        theirs, ours = by_pygments(text), by_page(node, text)
        assert len(theirs) == len(ours)
        for at in judged(text):
            line = text.count("\n", 0, at) + 1
            assert ours[at] == theirs[at], f"{path}:{line}: {text[max(at - 20, 0) : at + 20]!r}"
            seen[ours[at]] = seen.get(ours[at], 0) + 1
    assert all(seen.get(kind, 0) > 1000 // step for kind in ("", "comment", "keyword", "number", "directive"))


def test_a_pragma_of_the_playground_and_an_annotation_stand_out(node: Node):
    text = (
        '#pragma kernel(output = "h:r32f", \\\n  where = "n // 2; \\\n  m") // no\nuniform int a; //! slider'
    )
    spans = [(text[start:end], kind) for start, end, kind in node.run(SPANS, text)]
    assert [kind for _, kind in spans] == ["pragma"] * 3 + ["comment", "keyword", "type", "annotation"]
    assert "n // 2" in spans[1][0]


@pytest.mark.parametrize(
    ("before", "code", "kind"),
    [("/* a\n", "b */ 1.0", "number"), ("/* a\n", "b", "comment"), ("#define A \\\n", "1", "directive")],
)
def test_a_line_begins_in_what_the_line_before_left_open(node: Node, before: str, code: str, kind: str):
    assert node.run(SPANS, before + code)[-1][2] == kind

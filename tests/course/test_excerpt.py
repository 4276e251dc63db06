"""Excerpts by anchors, and the lines around a bug."""

from __future__ import annotations

import pytest

from playground.course.scenes import anchors, bug_region, excerpt, with_bug
from playground.errors import SketchError
from playground.paths import GLSL

TEXT = """float a;
    // anchor: outer
    float b = 1.0;

    // anchor: inner
        float c = 2.0;
    // end: inner
    // end: outer
float d;
"""


def test_anchor_excerpt_is_dedented_without_markers():
    excerpts = anchors("x.glsl", TEXT)
    assert excerpts["outer"].text == "float b = 1.0;\n\n    float c = 2.0;"
    assert excerpts["outer"].line == 3
    assert excerpts["inner"].text == "float c = 2.0;"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("// anchor: a\nx\n", "anchor 'a' has no end"),
        ("// end: a\n", "anchor 'a' ends before it begins"),
        ("// anchor: a\n// end: a\n// anchor: a\n// end: a\n", "a second anchor 'a'"),
    ],
)
def test_marks_that_do_not_fit(text, words):
    with pytest.raises(SketchError, match=words):
        anchors("x.glsl", text)


def test_an_anchor_there_is_not():
    with pytest.raises(SketchError, match="no anchor 'iner'; did you mean 'inner'"):
        excerpt("x.glsl", "iner", TEXT)


def test_every_anchor_of_the_library_can_be_read():
    texts = {
        path: path.read_text(encoding="utf-8")
        for path in GLSL.rglob("*")
        if path.suffix in (".glsl", ".comp")
    }
    marked = {path: anchors(path.name, text) for path, text in texts.items() if "// anchor:" in text}
    assert marked
    for path, result in marked.items():
        for name, item in result.items():
            assert 1 <= len(item.text.split("\n")) <= 40, (path, name)


def test_the_lines_around_a_bug(lesson):
    block = lesson.named["fault"]
    result = bug_region(block)
    correct, broken = result.correct, result.broken
    assert "total / count" in correct and "total / 8.0" in broken
    differing = [
        pair for pair in zip(correct.split("\n"), broken.split("\n"), strict=True) if pair[0] != pair[1]
    ]
    assert len(differing) == 1


def test_lines_put_back_make_the_file_again(lesson):
    block = lesson.named["fault"]
    result = bug_region(block)
    text = (GLSL / block.file).read_text(encoding="utf-8")
    same = [
        line.strip()
        for line in text.split("\n")
        if line.strip() and "// anchor" not in line and "// end:" not in line
    ]
    back = [
        line.strip()
        for line in result.with_lines(result.correct).split("\n")
        if line.strip() and "// anchor" not in line and "// end:" not in line
    ]
    assert back == same
    assert "8.0" in result.with_lines(result.broken)


@pytest.mark.parametrize(
    ("find", "words"),
    [
        ("no such text", "found 0 times"),
        ("float", "expected once in generation/diamond_square/raw.glsl, found"),
    ],
)
def test_a_bug_that_does_not_fit(make_lesson, find, words):
    block = make_lesson(('find   = "total / count"', f'find = "{find}"')).named["fault"]
    with pytest.raises(SketchError, match=words):
        with_bug(block)

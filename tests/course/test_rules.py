"""What every lesson keeps to: each rule, broken by one change."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.course import rules
from playground.course.rules import broken_rules, wrong_pictures


def sentences(lesson):
    return [sentence for _, sentence in broken_rules(lesson)]


@pytest.fixture(autouse=True)
def _one_lesson(monkeypatch):
    monkeypatch.setattr(rules, "lesson_files", lambda: ["small"])


def test_the_small_lesson_keeps_to_all(lesson):
    assert sentences(lesson) == []


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("A picture first.", "word " * 61, "61 words before the first figure"),
        (
            "A picture first.",
            "```question early\nask = 'a'\nanswer = 'b'\n```",
            "the first block of a lesson is a figure",
        ),
        ('anchor  = "kernel"', 'anchor = "nowhere"', "no anchor 'nowhere'"),
        ("## One thing", "## Bare\n\nOnly words.\n\n## One thing", "section 'Bare' shows nothing"),
        ('```exercise third\nask      = "Change."\nsolution = "So."\n```', "", "2 exercises; a lesson has 3"),
        ("spread is {{spread}}", "spread is {{spraed}}", "{{spraed}}: there is no measure"),
        ("lesson:small", "lesson:smaller", "a link to lesson 'smaller'"),
        ("lesson:small", "http://example.org", "a link to 'http://example.org'"),
        ("lesson:small", "sketch:nothing", "a link to sketch 'nothing'"),
        ("term:texel", "term:texl", "a link to term 'texl', which does not exist; did you mean 'texel'?"),
        ("Turn by turn.", "[Texels](term:texel).", "a second link to term 'texel'"),
        ("lesson:small", "thesis:one", "a link to section 'one'"),
        (
            'alt     = "A lattice of discs."',
            'alt = "Five by five, with *all* of it known."',
            "alt repeats the caption",
        ),
        ('thesis  = ["1.3.2"]', "thesis = []", "names sections of the thesis"),
        ('goal    = "Know $r^2$."', r"""goal = 'Know $\foo{r}$.' """, "formula"),
        ('goal    = "Know $r^2$."', "goal = 'Know $r^2^3$.'", "formula $r^2^3$"),
        ('goal    = "Know $r^2$."', r"""goal = 'Know $\left( r$.' """, r"formula $\left( r$"),
        (
            "A picture first.",
            "![A picture](https://example.org/x.png) first.",
            "an image of 'https://example.org/x.png'",
        ),
        ('find   = "total / count"', 'find = "nothing of it"', "found 0 times"),
        (
            'file   = "generation/diamond_square/raw.glsl"',
            'file = "generation/white_noise.glsl"',
            "does not use",
        ),
    ],
)
def test_each_rule(make_lesson, before, after, words):
    assert any(words in sentence for sentence in sentences(make_lesson((before, after))))


def test_a_wrong_link_is_named_by_its_line(make_lesson):
    wrong = make_lesson(("term:texel", "term:tile"))
    (result,) = [(line, sentence) for line, sentence in broken_rules(wrong) if "term 'tile'" in sentence]
    assert Path(wrong.file).read_text(encoding="utf-8").split("\n")[result[0] - 1].startswith("The spread is")


def test_a_bug_must_be_visible_and_a_claim_must_hold(make_lesson, engine):
    assert list(wrong_pictures(engine, make_lesson())) == []
    hidden = make_lesson(('put    = "total / 8.0"', 'put = "total / (1.0001 * count)"'))
    assert [s for _, s in wrong_pictures(engine, hidden)] == [
        "break 'fault': the bug hardly changes the picture"
    ]
    false = make_lesson(("between = [0.1, 2.0]", "between = [3.0, 4.0]"))
    (sentence,) = [s for _, s in wrong_pictures(engine, false)]
    assert sentence.startswith("measure 'spread': 0.") and sentence.endswith("is not between 3 and 4")

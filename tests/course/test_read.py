"""A lesson's file becomes blocks; each mistake and each broken rule is one message with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.course import rules
from playground.course.library import lesson_names
from playground.course.model import (
    Break,
    Code,
    Compare,
    Exercise,
    Figure,
    Measure,
    Question,
    Slider,
    Steps,
    Trace,
)
from playground.course.rules import broken_rules, wrong_pictures
from playground.course.scenes import anchors, bug_region, excerpt, with_bug
from playground.errors import SketchError
from playground.paths import GLSL


def test_what_it_says_of_itself(lesson):
    assert lesson.title == "A small lesson" and lesson.number == len(lesson_names())
    assert lesson.thesis == ("1.3.2",)
    assert [section.title for section in lesson.sections] == ["", "One thing", "Exercises"]


def test_every_kind_of_block_is_read(lesson):
    kinds = [type(block) for block in lesson.named.values()]
    assert kinds[:7] == [Figure, Steps, Slider, Compare, Code, Trace, Question]
    assert kinds[7:] == [Break, Measure, Question, *[Exercise] * 3]


def test_a_figure_that_is_a_shot_is_plain(lesson, make_lesson):
    terrain = lesson.named["land"]
    assert terrain.scene.plain and terrain.scene.pixels == (480, 480)
    assert dict(terrain.scene.steps) == {"height.raw": 5, "phase": 5}
    more = make_lesson(('shot    = "figure-1-11"', 'shot = "figure-1-11"\nset = { size = 9 }')).named["land"]
    assert not more.scene.plain


def test_steps_stop_all_their_passes_at_each_turn(lesson):
    steps = lesson.named["turns"]
    assert steps.iterations == (0, 1, 2, 3, 4, 5)  # 5 texels a side: the corners, then twice two turns
    assert [dict(scene.steps) for scene in steps.scenes] == [{"height.raw": t, "phase": t} for t in range(6)]


def test_a_slider_goes_from_one_value_to_the_other(lesson):
    slider = lesson.named["smooth"]
    assert slider.values == (0.1, 0.5, 0.9)
    assert [dict(scene.sketch.overrides)["height.smoothing"] for scene in slider.scenes] == [0.1, 0.5, 0.9]


def test_variants_stand_over_what_the_block_sets(make_lesson):
    block = 'pixels  = [96, 96]\ncaption = "Two lands."'
    result = make_lesson((block, f'set = {{ "height.seed" = 3 }}\n{block}')).named["two"]
    assert [dict(scene.values) for scene in result.scenes] == [
        {"height.seed": 3, "height.smoothing": smoothing} for smoothing in (0.0, 0.9)
    ]


def test_a_texture_from_above(make_lesson, engine):
    """Its greys are the texture's values between the ends of the range."""
    from playground.course.scenes import draw

    lesson = make_lesson(
        ('pixels    = [96, 96]\ncaption   = "Smoother', 'pixels = [20, 20]\ncaption = "Smoother'),
        ("frames    = 3", 'frames = 3\nview = "height"\nrange = [0.0, 2.0]'),
    )
    scene = lesson.named["smooth"].scenes[0]
    picture = draw(engine, scene).array[..., 0].astype(float) / 255
    values = engine.read(scene.sketch, "height", size=scene.pixels)
    expected = values[::-1].repeat(4, 0).repeat(4, 1) / 2.0
    assert abs(picture - expected).max() < 0.005


@pytest.mark.parametrize(
    ("before", "after", "line", "words"),
    [
        ('title   = "A small lesson"', "title = 3", 2, "title = 3: expected text in quotes"),
        ('goal    = "Know $r^2$."\n', "", 1, "front matter lacks goal"),
        ('sketch  = "diamond_square_steps"\n+++', 'sketch = "nothing"\n+++', 6, "sketch = 'nothing'"),
        (
            "```figure land",
            "```figur land",
            11,
            "no block of a lesson is called 'figur'; did you mean 'figure'?",
        ),
        ("```figure land", "```figure Land", 11, "small letters"),
        ('shot    = "figure-1-11"', 'shot = "figure-1-1"', 13, "no shot 'figure-1-1'"),
        ('alt     = "A lattice of discs."\n', "", 11, 'a figure block needs alt = "…"'),
        (
            'sliders = ["height.smoothing"]',
            'sliders = ["height.smothing"]',
            16,
            "did you mean 'height.smoothing'?",
        ),
        ('passes  = ["height.raw", "phase"]', 'passes = ["height.smooth"]', 25, "height.smooth"),
        (
            'shot    = "figure-1-11"',
            'shot = "figure-1-11"\nsteps = { phase = 99 }',
            14,
            "steps: 'phase' stops after 99 steps, but it has 5 in all",
        ),
        ("frames    = 3", "frames = 1", None, "from, to and frames (2 to 64)"),
        ("to        = 0.9", "to = 7.0", None, "height.smoothing"),
        ('labels  = ["even", "uneven"]', 'labels = ["even"]', None, "labels: 1 for 2 variants"),
        (
            'file    = "generation/white_noise.glsl"',
            'file = "generation/white_nois.glsl"',
            None,
            "did you mean",
        ),
        ('what    = "spread"', 'what = "spraed"', None, "did you mean 'spread'?"),
        ("right   = 0", "right = 2", None, "expected the place of a choice, 0 to 1"),
        ("between = [0.1, 2.0]", "between = [2.0, 0.1]", None, "expected [lowest, highest]"),
        ("```exercise second", "```exercise first", None, "a second block named 'first'"),
        ('ask      = "Predict."\n', "", None, 'needs ask = "…"'),
        ('caption = "Two lands."', 'caption = "Two lands.', None, "not TOML"),
        ('set = { "height.smoothing" = 0.9 }', 'set = { "height.smoothing" = 9 }', None, "9"),
        ('labels  = ["even"', 'set = 3\nlabels = ["even"', 48, "set = 3: expected a table"),
        (
            'labels  = ["even", "uneven"]\n[[variant]]\nset = { "height.smoothing" = 0.0 }',
            'labels = ["even", "uneven"]\nset = { "height.seed" = 1 }\n[[variant]]\nset = 3',
            51,
            "set = 3: expected a table",
        ),
        (
            'alt     = "A lattice of discs."',
            'alt = "A lattice of discs."\nrange = [0, 1]',
            16,
            "range: there is no view",
        ),
    ],
)
def test_a_mistake_is_a_sentence_with_its_line(write_lesson, before, after, line, words):
    from playground.course.read import read_file

    path = write_lesson((before, after))
    with pytest.raises(SketchError) as caught:
        read_file(path)
    (diagnostic,) = caught.value.diagnostics
    assert words in diagnostic.message
    lines = path.read_text(encoding="utf-8").split("\n")
    assert 1 <= diagnostic.line <= len(lines)
    if line is not None:
        assert diagnostic.line == line, lines[diagnostic.line - 1]


def test_a_file_without_front_matter(tmp_path):
    from playground.course.read import read_file

    path = tmp_path / "bare.md"
    path.write_text("# No front\n", encoding="utf-8")
    with pytest.raises(SketchError, match="begins with TOML between two lines"):
        read_file(path)


def test_a_formula_with_a_label_is_a_formula(make_lesson):
    """Nothing of the text is lost."""
    lesson = make_lesson(("A picture first.", "$$\nx = 1\n$$ (one)\n\nA picture first."))
    assert "x = 1" in lesson.blocks[0].markdown and "(one)" in lesson.blocks[0].markdown
    assert lesson.blocks[1].markdown == "A picture first."


# ── excerpts ──────────────────────────────────────────────────────────────────


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


# ── rules ─────────────────────────────────────────────────────────────────────


def rule_sentences(lesson):
    return [sentence for _, sentence in broken_rules(lesson)]


@pytest.fixture(autouse=True)
def _one_lesson(monkeypatch):
    monkeypatch.setattr(rules, "lesson_files", lambda: ["small"])


def test_the_small_lesson_keeps_to_all(lesson):
    assert rule_sentences(lesson) == []


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
    assert any(words in sentence for sentence in rule_sentences(make_lesson((before, after))))


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

"""A translation says words and nothing else, and knows which of them have gone stale."""

from __future__ import annotations

import pytest

from playground.course import library
from playground.course.document import read_document
from playground.course.read import mark, read_file, stale, status_of, translated, write_hashes
from playground.errors import SketchError


@pytest.fixture
def pair(write_lesson, french, tmp_path):
    """Give the English file and the marked French one."""
    return tmp_path / "small.md", tmp_path / "petit.md"


def lines_of(english, lost):
    return [english.pieces[index - 1].text.split("\n")[0] if index else "front" for index in lost]


def test_its_words_stand_in_the_place_of_the_english_ones(french, lesson):
    assert (french.language, french.title) == ("fr", "Une petite leçon")
    assert french.named["land"].alt == "Un treillis de disques."
    assert french.named["two"].labels == ("uni", "inégal")
    assert french.named["spread"].sentence.startswith("Du plus bas")
    assert french.sections[1].title == "Une chose"
    assert not french.stale


def test_all_else_is_the_english_lesson_s(french, lesson):
    for name, block in lesson.named.items():
        other = french.named[name]
        for field in ("scene", "scenes", "turns", "values", "file", "find", "put", "right", "between"):
            assert getattr(block, field, None) == getattr(other, field, None), (name, field)


@pytest.mark.parametrize(
    ("before", "after", "changed"),
    [
        ("A picture first.", "Another sentence.", ["A picture first."]),
        ('caption = "Two lands."', 'caption = "Three lands."', ["```compare two"]),
        ('title   = "A small lesson"', 'title = "A smaller lesson"', ["front"]),
        ("frames    = 3", "frames = 4", ["```slider smooth"]),
    ],
)
def test_a_changed_block_is_stale_and_only_that(pair, write_lesson, before, after, changed):
    english, french = pair
    old = read_document(english)
    write_lesson((before, after))
    lost = stale(read_document(english), read_document(french))
    assert lines_of(old, lost.changed) == changed
    assert not lost.added and not lost.removed


def test_broken_lines_are_not_a_change(pair, write_lesson):
    english, french = pair
    write_lesson(("A picture first.", "A picture\nfirst."))
    assert not stale(read_document(english), read_document(french)).any


def test_a_new_block_is_in_english_until_it_is_translated(pair, write_lesson):
    english, french = pair
    write_lesson(("## One thing\n", "## One thing\n\nA new paragraph.\n"))
    lost = stale(read_document(english), read_document(french))
    assert lines_of(read_document(english), lost.added) == ["A new paragraph."] and not lost.changed
    result = translated(read_file(english), read_document(english), read_document(french), "fr")
    words = [block.markdown for block in result.blocks if hasattr(block, "kind")]
    assert "A new paragraph." in words and "Une image d’abord." in words
    assert result.named["third"].ask == "Changez."  # what comes after keeps its place
    assert [result.blocks[i].markdown for i in result.stale] == ["A new paragraph."]


def test_a_block_that_is_gone(pair, write_lesson):
    english, french = pair
    write_lesson(("A picture first.\n", ""))
    assert stale(read_document(english), read_document(french)).removed == 1
    result = translated(read_file(english), read_document(english), read_document(french), "fr")
    assert result.named["land"].caption == "Cinq sur cinq, tout est connu."
    assert not any(getattr(block, "markdown", "") == "Une image d’abord." for block in result.blocks)


def test_marking_it_again_makes_it_current(pair, write_lesson):
    english, french = pair
    write_lesson(("A picture first.", "Another sentence."))
    before = french.read_text(encoding="utf-8")
    write_hashes(read_document(english), read_document(french))
    assert not stale(read_document(english), read_document(french)).any
    changed = [
        a
        for a, b in zip(before.split("\n"), french.read_text(encoding="utf-8").split("\n"), strict=True)
        if a != b
    ]
    assert len(changed) == 1  # one hash, and nothing of what was written by hand


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            'caption = "Deux terrains."',
            'caption = "Deux."\npixels = [9, 9]',
            "'pixels' is not for a translation",
        ),
        ('labels  = ["uni", "inégal"]', 'labels = ["uni"]', "labels: 1 here, 2 in English"),
        ('hint     = "Glissez."\n', "", 'needs hint = "…"'),
        (
            "```slider smooth",
            "```slider rough",
            "expected the block 'slider smooth' here, found slider rough",
        ),
        ("## Une chose", "Une chose", "a paragraph is here, where the English has a heading"),
    ],
)
def test_what_a_translation_may_not(pair, before, after, words):
    english, french = pair
    text = french.read_text(encoding="utf-8")
    assert before in text
    french.write_text(text.replace(before, after), encoding="utf-8")
    with pytest.raises(SketchError) as caught:
        translated(read_file(english), read_document(english), read_document(french), "fr")
    assert words in caught.value.diagnostics[0].message
    assert caught.value.diagnostics[0].line


def test_marking_translation_with_other_blocks_is_refused(pair):
    english, french = pair
    text = french.read_text(encoding="utf-8").replace("Une image d’abord.\n", "Une image.\n\nD’abord.\n")
    french.write_text(text, encoding="utf-8")
    with pytest.raises(SketchError, match="expected the block 'figure land' here, found a paragraph"):
        write_hashes(read_document(english), read_document(french))
    assert french.read_text(encoding="utf-8") == text


def test_the_status_of_a_folder_of_lessons(pair, write_lesson, tmp_path, monkeypatch):
    english, french = pair
    for language, path in (("en", english), ("fr", french)):
        (tmp_path / language).mkdir()
        (tmp_path / language / "small.md").write_bytes(path.read_bytes())
    monkeypatch.setattr(library, "TEXTS", tmp_path)
    assert status_of("small", "fr").state == "current"
    text = (tmp_path / "en" / "small.md").read_text(encoding="utf-8")
    (tmp_path / "en" / "small.md").write_text(text.replace("A picture first.", "Two."), encoding="utf-8")
    result = status_of("small", "fr")
    line = text.split("\n").index("A picture first.") + 1
    assert (result.state, result.changed_lines) == ("stale", (line,))
    assert result.sentences == [f"changed: line {line}"]
    (tmp_path / "fr" / "small.md").unlink()
    assert status_of("small", "fr").state == "missing"


def test_a_block_that_became_one_of_another_kind_is_in_english(pair, write_lesson):
    """A stale translation can be read, whatever the English has become."""
    english, french = pair
    write_lesson(("A picture first.\n", "* A list\n* first\n"))
    result = translated(read_file(english), read_document(english), read_document(french), "fr")
    assert result.blocks[0].markdown == "* A list\n* first" and result.stale == (0,)
    assert result.named["land"].caption == "Cinq sur cinq, tout est connu."


def test_a_block_that_got_more_parts_is_in_english(pair, write_lesson):
    english, french = pair
    write_lesson(
        ('labels  = ["even", "uneven"]', 'labels = ["even", "uneven", "more"]'),
        ("0.9 }\n```", '0.9 }\n[[variant]]\nset = { "height.smoothing" = 0.5 }\n```'),
    )
    result = translated(read_file(english), read_document(english), read_document(french), "fr")
    assert result.named["two"].labels == ("even", "uneven", "more")
    assert [result.blocks[i].name for i in result.stale] == ["two"]
    assert result.named["third"].ask == "Changez."


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("## Une chose", "Une chose", "a paragraph is here, where the English has a heading"),
        ('labels  = ["uni", "inégal"]', 'labels = ["uni"]', "labels: 1 here, 2 in English"),
    ],
)
def test_one_that_says_something_else_is_not_marked(pair, before, after, words):
    english, french = pair
    text = french.read_text(encoding="utf-8").replace(before, after)
    french.write_text(text, encoding="utf-8")
    with pytest.raises(SketchError, match=words):
        mark(read_file(english), read_document(english), read_document(french), "fr")
    assert french.read_text(encoding="utf-8") == text


def test_translation_with_fewer_blocks_than_marked_is_outdated(pair):
    english, french = pair
    text = french.read_text(encoding="utf-8").replace("Une image d’abord.\n", "")
    french.write_text(text, encoding="utf-8")
    with pytest.raises(SketchError, match="blocks, but source names"):
        stale(read_document(english), read_document(french))

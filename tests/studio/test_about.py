"""The words with which the panel begins: the comment at the head of a sketch's own file."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.paths import SKETCHES
from playground.sketch.find import shipped_sketches
from playground.sketch.load import load
from playground.studio.panel.about import about, paragraphs_of
from playground.studio.start.thumbnails import thumbnails

from .panel_desk import Bare, OpenBare
from .screen import HILLS

LONG = "# Hills of one wave, and of nothing else that could be named here; so it takes a while to read on.\n"
FILES = {
    "sketch.toml": f"{LONG}# Two more sentences. They are folded.\n#\n# And a paragraph.\n{HILLS}",
    "terrain.glsl": '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n',
}


def test_every_shipped_sketch_begins_with_its_sentence() -> None:
    rows = {row.name: row.about for row in thumbnails()}
    for name in shipped_sketches():
        sketch = load(SKETCHES / f"{name}.toml")
        words = [sketch.title, *about(sketch)]
        assert any(text.startswith(rows[name].rstrip(".")) for text in words), name


@pytest.mark.parametrize(
    ("text", "title", "paragraphs"),
    [
        ("// waves.glsl -- waves on a pond\n// at night\n#pragma kernel\n", "", ["Waves on a pond at night"]),
        ("#version 330\n\n/* One.\n * Two.\n *\n * Three. */\nvoid main() {}", "One", ["Two.", "Three."]),
        ('/*{ "DESCRIPTION": "x" }*/\nvoid main() {}', "", []),
        ("// Copyright 2020 A. Author\n// Licensed under MIT\n\n// A sea.\n", "", ["A sea."]),
        ("void main() {} // nothing\n", "", []),
        ("/* One line. */ void main() {}\n// not this\n", "", ["One line."]),
        ("// ======\n// Rocks.\n// ------\n", "", ["Rocks."]),
        ("", "", []),
    ],
)
def test_a_shader_is_about_its_first_comment(text: str, title: str, paragraphs: list[str]) -> None:
    assert paragraphs_of(text, title) == paragraphs


def test_two_lines_are_shown_and_more_unfolds_the_rest(bare: Bare) -> None:
    bare.run_frames(2)
    more, search = bare.places["more###about"], bare.places["##search"]
    bare.click("more###about")
    bare.run_frames(2)
    assert bare.places["##search"][1] > search[1] and bare.places["less###about"][1] > more[1]
    bare.click("less###about")
    bare.run_frames(2)
    assert bare.places["##search"] == search


def test_a_sketch_without_words_has_no_empty_lines(open_bare: OpenBare, tmp_path: Path) -> None:
    tops = []
    for text in ("", "# Short.\n"):
        folder = tmp_path / str(len(text))
        folder.mkdir()
        (folder / "sketch.toml").write_text(text + HILLS, encoding="utf-8")
        (folder / "terrain.glsl").write_text(FILES["terrain.glsl"], encoding="utf-8")
        bare = open_bare(folder)
        bare.run_frames(2)
        assert not any("###about" in label for label in bare.places), "what fits has nothing to unfold"
        tops.append(bare.places["##search"][1])
    assert 10 < tops[1] - tops[0] < 30, "one line"

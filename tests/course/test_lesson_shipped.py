"""The lessons that ship, as the window has to show them: their formulas, their letters, their pictures."""

from __future__ import annotations

from pathlib import Path

import imgui_bundle
import pytest
from imgui_bundle import imgui

from playground.course.document import formulas
from playground.course.library import LANGUAGES, TEXTS, lesson_files
from playground.course.model import Break, Compare, Exercise, Figure, Slider, Steps
from playground.course.read import read_lesson
from playground.course.typeset import INSTEAD, set_formula
from playground.course.window.figure_view import edits_of, map_of, steps_of
from playground.studio.edits.edits import Draft

from ..loading import load

FILES = sorted(TEXTS.glob("*/*.md"))


def test_there_are_lessons_in_every_language():
    assert {path.parent.name for path in FILES} == set(LANGUAGES) and len(lesson_files()) >= 10


@pytest.mark.parametrize("path", FILES, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_formula_can_be_set(path):
    for latex in formulas(path.read_text(encoding="utf-8")):
        typeset_formula = set_formula(latex, 20, 0xFFEEEEEE, display=False)
        assert typeset_formula is not None, latex
        shown = typeset_formula.pixels[typeset_formula.pixels[..., 3] > 0].astype(int)
        assert not ((shown[:, 0] > 200) & (shown[:, 1] < 50)).any(), f"{latex}: red is what is not known"


def test_every_letter_is_in_the_fonts():
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    fonts = Path(imgui_bundle.__file__).parent / "assets" / "fonts"
    text = io.fonts.add_font_from_file_ttf(str(fonts / "Roboto" / "Roboto-Regular.ttf"), 15)
    missing = {}
    for path in FILES:
        letters = set(path.read_text(encoding="utf-8").translate(INSTEAD)) - {"\n"}
        gone = sorted(letter for letter in letters if not text.is_glyph_in_font(ord(letter)))
        if gone:
            missing[f"{path.parent.name}/{path.stem}"] = gone
    imgui.destroy_context(context)
    assert not missing


@pytest.mark.slow
@pytest.mark.parametrize("name", lesson_files())
def test_every_picture_can_be_set_by_hand(name):
    count = 0
    for block in read_lesson(name).blocks:
        if isinstance(block, Figure | Break | Exercise):
            written = isinstance(block, Exercise) and block.file  # its picture is of a kernel, not of values
            scenes = (block.scene,) if block.scene and not written else ()
        else:
            scenes = block.scenes if isinstance(block, Steps | Slider | Compare) else ()
        for scene in scenes:
            count += 1
            file = load(Path(scene.sketch.file))
            made = Draft(file, file, edits_of(scene, file)).sketch
            assert all(step >= 0 for step in steps_of(scene).values())
            if scene.view:
                shown = map_of(scene)
                assert shown is not None and ":" in shown.ref
            else:
                same = made.with_values({}) == scene.sketch.with_values({})
                assert same, block.name  # the difference of two sketches is thousands of lines
    assert count >= 5

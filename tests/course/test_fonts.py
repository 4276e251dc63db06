"""Every character of lessons, and of the labels around them, is in the fonts that the window loads."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.course.typeset import written
from playground.studio.theme import Theme

from ..studio.test_fonts import constants, missing
from ..studio.test_fonts import theme as theme

COURSE = Path(__file__).resolve().parents[2] / "playground" / "course"
TEXTS = COURSE / "texts"


@pytest.mark.slow
def test_labels_of_lessons_can_be_shown(theme: Theme):
    text = "".join(s for path in COURSE.rglob("*.py") for s in constants(path))
    text += "".join(path.read_text(encoding="utf-8") for path in (COURSE / "labels").glob("*.toml"))
    assert "→" in text
    for font in (theme.text, theme.bold, theme.italic):
        assert not missing(written(text), font)


@pytest.mark.parametrize("language", sorted(path.name for path in TEXTS.iterdir() if path.is_dir()))
def test_lessons_can_be_shown(theme: Theme, language: str):
    text = "".join(path.read_text(encoding="utf-8") for path in (TEXTS / language).glob("*"))
    assert len(text) > 10_000
    for font in (theme.text, theme.bold, theme.italic, theme.code):
        assert not missing(written(text), font)

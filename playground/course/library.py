"""Find lessons, their languages and their texts."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from playground.errors import SketchError, nearest

HERE = Path(__file__).resolve().parent

TEXTS = HERE / "texts"
"""A folder for each language, in it a file for each lesson."""

SOURCE = "en"
"""The language that lessons are written in."""

LANGUAGES = {"en": "English", "fr": "Français"}
"""The languages that lessons can be read in, by code, each as it calls itself."""

THESIS = (
    "H. Belaiche, Illumination réaliste de terrains en temps réel, mémoire de magistère, "
    "Université Mohamed Khider, Biskra, 2010"
)
"""What all lessons come from."""


def lesson_file(name: str, language: str = SOURCE) -> Path:
    """Return the path of a lesson's text; raise ``SketchError`` for an unknown name or language."""
    if language not in LANGUAGES:
        raise SketchError(f"no language '{language}'{nearest(language, LANGUAGES)}")
    if name not in lesson_files():
        raise SketchError(f"no lesson '{name}'{nearest(name, lesson_files())}")
    return TEXTS / language / f"{name}.md"


def lesson_files() -> list[str]:
    """List the names of lessons by their files, in no order of their own."""
    return sorted(path.stem for path in (TEXTS / SOURCE).glob("*.md"))


def preferred_language(environment: Mapping[str, str] = os.environ) -> str:
    """Return the language that the environment asks for, if lessons have it; else English."""
    for variable in ("LC_ALL", "LC_MESSAGES", "LANG"):
        language = environment.get(variable, "")
        if language:
            code = language[:2].lower()
            return code if code in LANGUAGES else SOURCE
    return SOURCE

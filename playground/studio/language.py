"""The window's words in the language that is chosen: ``tr("Undo")``.

The English words stand in the code; the ``french.toml`` of this room, and that of each room with words of
its own, has the others by them. Where a translation is missing the English words are shown, and a test names
them. Words with numbers in them are templates, as ``tr("reloaded in {ms} ms", ms=12)``.
"""

from __future__ import annotations

import locale
import re
import tomllib
from functools import cache
from pathlib import Path

from playground import errors

LANGUAGES = {"en": "English", "fr": "Français"}

_chosen = "en"
_NO_BREAK = re.compile(r"(?<=\S) (?=[:;?!»])|(?<=«) ")
"""Blanks at which no French line ends; the file of words has plain ones."""
_MARKS = str.maketrans({",": "\u00a0", ".": ",", "%": "\u00a0%"})
"""The marks of a French number, by the English ones."""


def language() -> str:
    """Return the code of the language in use."""
    return _chosen


def choose_language(code: str) -> str:
    """Use a language from now on, "" for the system's; return its code. An unknown one is English."""
    global _chosen
    code = code or (locale.getlocale()[0] or "en").lower()[:2]
    _chosen = code if code in LANGUAGES else "en"
    return _chosen


def tr(text: str, /, **values: object) -> str:
    """Return words of the window in the language that is in use, with values in the place of their names."""
    words = _translations(_chosen).get(text, text) if _chosen != "en" else text
    return words.format(**values) if values else words


def tr_label(text: str) -> str:
    """Return a label or a title that a sketch or a kernel has, translated where it is a shipped one."""
    return _translations("fr labels").get(text, text) if _chosen == "fr" else text


def labels_of(text: str) -> tuple[str, str]:
    """Return a label in every language, the English one first, for a search in all of them."""
    return text, _translations("fr labels").get(text, "")


def counted(number: int, noun: str) -> str:
    """Return "1 file", "2 files" in the language that is in use; in French 0 is singular too."""
    if _chosen == "en":
        return errors.counted(number, noun)
    return f"{number} {tr(noun if number in (0, 1) else f'{noun}s')}"


def numeral(value: float, form: str = "g") -> str:
    """Return what is measured or counted as the language in use writes it: "1,234.5", "1 234,5".

    What can be typed has a point in every language, as in a sketch's file.
    """
    text = format(value, form)
    return text if _chosen == "en" else text.translate(_MARKS)


def shortcut(keys: str) -> str:
    """Return the keys of a shortcut as keyboards of the language have them: "Ctrl+Shift+Z", "Ctrl+Maj+Z"."""
    return re.sub(r"[A-Z][a-z]\w+", lambda word: tr(word[0]), keys)


@cache
def _translations(code: str) -> dict[str, str]:
    names = {"fr": "*/french.toml", "fr labels": "studio/french_labels.toml"}
    files = Path(__file__).parent.parent.glob(names[code])
    tables = [tomllib.loads(file.read_text("utf-8")) for file in files]
    return {english: _NO_BREAK.sub("\u00a0", text) for table in tables for english, text in table.items()}

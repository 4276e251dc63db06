"""What a page says: in each language the same, and nothing that nobody says."""

from __future__ import annotations

import re
from itertools import combinations

import pytest

from .node import RUNTIME, Node

TABLES = {
    "page_words.js": "PAGE_WORDS",
    "editor_words.js": "EDITOR_WORDS",
    "book_words.js": "BOOK_WORDS",
    "notebook_sketch.js": "NOTEBOOK_WORDS",
    "trace_words.js": "TRACE_WORDS",
}
FILES = {
    path: path.read_text("utf-8") for path in RUNTIME.glob("*.js") if not path.name.endswith("_words.js")
}

BY_NAME = {
    "editor.js": ("broken", "edited"),
    "sketch_page.js": (
        *("keyFrame", "keyFull", "keyHelp", "keyMap", "keyPanel"),
        *("keyPlay", "keyResetView", "keySave", "keyStart"),
    ),
    "session.js": ("size", "extent", "relief", "base_elevation"),
    "sketch_files.js": (
        *("ownFiles", "kernelFiles", "libraryFiles"),
        *("header", "annotation", "initial", "added", "removed"),
    ),
}
"""The words that are chosen while a page runs, by ``words[…]``, and the file that names them."""


@pytest.fixture(scope="module")
def tables(node: Node) -> dict[str, dict[str, dict[str, str]]]:
    value = "async (name, table, load) => (await load(name))[table]"
    return {name: node.run(value, name, table) for name, table in TABLES.items()}


@pytest.mark.parametrize("name", TABLES)
def test_both_languages_have_the_same_words(name: str, tables):
    """And the same places for values in them."""
    places = {
        language: {key: sorted(re.findall(r"\{\w+\}", text)) for key, text in words.items()}
        for language, words in tables[name].items()
    }
    assert places["en"] == places["fr"]
    assert not [key for key, text in tables[name]["fr"].items() if "'" in text or not text.strip()]


def test_no_two_parts_share_a_name(tables):
    for first, other in combinations(tables.values(), 2):
        assert not first["en"].keys() & other["en"].keys()


def test_every_word_is_used_and_every_use_has_one(tables):
    existing = {key for table in tables.values() for key in table["en"]}
    text = "\n".join(FILES.values())
    used = set(re.findall(r"\bwords\.([a-zA-Z]\w*)\b(?!\()", text)) - {"js", "length"}  # a file; a list
    for names in re.findall(r"\{ ([\w, ]+) \} = (?:\w+\.)*words;", text):
        used |= set(names.split(", "))
    assert not used - existing
    for name, keys in BY_NAME.items():
        assert not [key for key in keys if f'"{key}"' not in FILES[RUNTIME / name]], name
    assert existing - used == {key for keys in BY_NAME.values() for key in keys}


def test_the_words_of_a_language_are_those_of_its_tables(node: Node, tables):
    """Another language than these two has English ones."""
    value = [tables["page_words.js"], tables["editor_words.js"]]
    for tag, language in (("fr", "fr"), ("fr-CA", "fr"), ("en", "en"), ("de", "en"), ("fro", "en")):
        expected = {**value[0][language], **value[1][language]}
        assert node.call("words.js", "wordsOf", tag, *value) == expected

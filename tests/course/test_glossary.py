"""The glossary as lessons read it, and its pages in the documentation."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from playground.course.glossary import alphabetical, linked_term, terms, terms_in
from playground.course.library import LANGUAGES
from playground.course.site import glossary


def test_terms_are_found_by_the_links_of_a_text():
    assert linked_term("term:texel") is terms()["texel"]
    assert linked_term("term:texl") is None and linked_term("lesson:texel") is None
    text = "A [mesh](term:mesh) of [texels](term:texel), `[mip](term:mip_level)`."
    assert [term.key for term in terms_in(text, "[again](term:mesh) [x](term:none)")] == ["mesh", "texel"]


def test_a_definition_names_the_term_in_its_language():
    term = terms()["mesh"]
    assert term.definition("en") == "mesh: Triangles that are drawn in perspective."
    assert term.definition("fr") == "maillage\u00a0: Des triangles dessinés en perspective."


def test_accents_do_not_count_in_the_alphabet():
    names = [term.names["fr"][0] for term in alphabetical("fr")]
    assert names.index("échantillonnage") < names.index("élévation") < names.index("esquisse")
    assert len(names) == len(terms())


def test_definitions_can_be_titles_of_links():
    for term in terms().values():
        for language in ("en", "fr"):
            assert '"' not in term.definition(language) and "\\" not in term.definition(language)


def test_the_glossary_has_each_term_in_both_languages():
    terms = alphabetical("en")
    assert len(terms) > 70
    for language in LANGUAGES:
        names = [term.names[language][0] for term in terms]
        assert len(set(names)) == len(names)
        text = glossary(language, str)
        for term in terms:
            assert f"{{ #{term.key} }}" in text
            assert re.fullmatch(r"[^.].*\.", term.meaning[language]) and len(term.meaning[language]) < 200
    avoided = {word for term in terms for word in term.avoid}
    assert not avoided & {term.names["en"][0] for term in terms}


def test_sections_of_the_thesis_have_a_page():
    form = re.compile(r"(?:(?:\d(?:\.\d)+|introduction), p\. \d+)?")
    assert not [term.key for term in terms().values() if not form.fullmatch(term.thesis)]


def test_a_term_without_its_french_is_refused(tmp_path: Path):
    file = tmp_path / "glossary.toml"
    file.write_text('[texel]\nen = ["texel"]\nmeans = "One element."\n')
    with pytest.raises(ValueError, match=r"texel.*missing.*fr"):
        terms(file)

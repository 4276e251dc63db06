"""The glossary as lessons read it."""

from __future__ import annotations

from playground.course.glossary import alphabetical, linked_term, terms, terms_in


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

"""A page carries those parts of the runtime that its sketches need, and no others."""

from __future__ import annotations

import pytest

from playground.publish.web import addons
from playground.publish.web.bundle import BUNDLES, read_bundle
from playground.publish.web.page_data import page_data

from ...loading import load
from .node import Node, NodeError

NEEDED = {
    "diamond_square": [],
    "sun_flight": ["with_keyframes.js"],
    "from_elsewhere": ["with_plain.js"],
}


@pytest.mark.parametrize("name", NEEDED)
def test_a_page_carries_what_its_sketch_needs(name: str):
    page = page_data([load(name)])
    expected = "".join(map(read_bundle, [*NEEDED[name], "page.js"]))
    assert addons.page_script(page) == expected


def test_page_of_several_sketches_bundles_needs_of_any():
    page = page_data([load("diamond_square"), load("sun_flight")])
    assert read_bundle("with_keyframes.js") in addons.page_script(page)


def test_every_add_on_is_carried_by_some_page():
    assert addons._NEEDED_BY.keys() == {path.name for path in BUNDLES.glob("with_*.js")}


def test_without_an_add_on_a_sentence_says_which(node: Node):
    script = """async (load) => {
        const { addOns, needed } = await load("addons.js"), { valueAt } = needed("keyframes");
        delete addOns.keyframes;
        try { return needed("keyframes"); } finally { addOns.keyframes = { valueAt }; }
    }"""
    with pytest.raises(NodeError, match="put together without 'keyframes'"):
        node.run(script)

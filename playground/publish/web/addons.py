"""Choose what of the runtime a page carries: page.js, after the add-ons that its sketches need.

An add-on is a bundle of its own that puts functions into the table of addons.js, where the engine looks
them up.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from playground.publish.web.bundle import read_bundle

Data = Mapping[str, Any]

_NEEDED_BY: dict[str, Callable[[Data], bool]] = {
    "with_keyframes.js": lambda sketch: bool(sketch["tracks"]),
    "with_plain.js": lambda sketch: any(item["kind"] == "plain_fragment" for item in sketch["kernels"]),
}
"""Bundle → whether a sketch needs it: see ``Sketch`` in schema.js."""


def page_script(page: Data) -> str:
    """Return the runtime's script for a page; raise ``PlaygroundError`` where a bundle is not built."""
    names = [name for name, is_needed in _NEEDED_BY.items() if any(map(is_needed, page["sketches"]))]
    return "".join(read_bundle(name) for name in (*names, "page.js"))

"""Make one HTML file of a page's data and the runtime, which opens from disk and asks nothing of a network.

The runtime's style, the data as JSON and the runtime's script are one text, packed (gzip in base64), in an
element that no browser runs. The loader, a short script, unpacks that; the page's policy names all scripts
and styles by their hashes, and nothing else may run or be fetched. What people wrote is escaped where it
stands in the page itself (``markup``), and packed in the data. The poster is the picture for printing, and
for browsers that cannot run the rest.
"""

from __future__ import annotations

import base64
import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from playground._version import __version__
from playground.markup import Markup, tag
from playground.publish.web.blobs import packed
from playground.publish.web.bundle import read_bundle

_MARK = "\ufeff"  # that this is UTF-8, whatever a server says
_ICON = "data:,"  # or a browser would ask for favicon.ico
_POSTER_STYLE = "img{max-width:100%;height:auto}"
_WORDS = {
    "en": {
        "about": "{title}: a terrain shader that runs in this page.",
        "scripts_off": "This picture is alive where scripts may run: allow them for this page, or open it in"
        " a browser.",
        "too_old": "This browser has no DecompressionStream, which unpacks the live picture: update it to"
        " Chrome 80, Firefox 113, Safari 16.4 or later.",
        "damaged": "This file is damaged, so the picture stands still: export or copy it again.",
    },
    "fr": {
        "about": "{title} : un shader de terrain qui s’exécute dans cette page.",
        "scripts_off": "Cette image est vivante là où les scripts sont permis : autorisez-les pour cette"
        " page, ou ouvrez-la dans un navigateur.",
        "too_old": "Ce navigateur n’a pas DecompressionStream, qui décompresse l’image vivante : mettez-le à"
        " jour (Chrome 80, Firefox 113, Safari 16.4 ou plus récent).",
        "damaged": "Ce fichier est endommagé, l’image reste donc fixe : exportez-le ou copiez-le de nouveau.",
    },
}
"""What a page says before its script runs; what it says then is in the runtime's tables."""
LANGUAGES = tuple(_WORDS)


@dataclass(frozen=True)
class Poster:
    """The picture that a page begins with."""

    data: bytes
    media_type: str  # as image/webp
    size: tuple[int, int]  # pixels


def page_html(
    page: Mapping[str, Any], poster: Poster, *, script: str, style: str, language: str = "en"
) -> str:
    """Return the whole page: one HTML file.

    ``script`` and ``style`` are the runtime's (see ``bundle``); ``language`` is one of ``LANGUAGES``. The
    same arguments give the same text.
    """
    words = _WORDS[language]
    loader = read_bundle("loader.js")
    content = packed("\0".join((style, page_text(page), script)).encode())
    blobs = page["shared"]["blobs"]
    sketch = page["sketches"][0]
    title = sketch["title"] or sketch["name"]
    width, height = poster.size
    image = tag(
        "img",
        id="playground-poster",
        src=f"data:{poster.media_type};base64,{base64.b64encode(poster.data).decode('ascii')}",
        alt=title,
        width=width,
        height=height,
    )
    head = (
        Markup('<meta charset="utf-8">'),
        tag("meta", http_equiv="Content-Security-Policy", content=policy_of(loader, script, style)),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("meta", name="description", content=words["about"].format(title=title)),
        tag("meta", name="generator", content=f"terrain shader playground {__version__}"),
        tag("title", title),
        tag("link", rel="icon", href=_ICON),
        tag("style", Markup(_POSTER_STYLE)),
    )
    body = (
        tag("main", image, id="playground"),
        tag("noscript", tag("p", words["scripts_off"])),
        tag("p", words["too_old"], id="playground-old", hidden=True),
        tag("p", words["damaged"], id="playground-damaged", hidden=True),
        "\n",
        tag(
            "script",
            Markup(content),
            type="text/plain",
            id="playground-packed",
        ),
        "\n",
        *(tag("script", Markup(text), type="text/plain", data_blob=key) for key, text in blobs.items()),
        "\n",
        tag("script", Markup(loader)),
    )
    html = tag("html", tag("head", *head), "\n", tag("body", *body), lang=language)
    return f"{_MARK}<!doctype html>\n{html}\n"


def page_text(page: Mapping[str, Any]) -> str:
    """Return a page's data as JSON without its blobs, which are elements of their own: see packed.js."""
    shared = {name: value for name, value in page["shared"].items() if name != "blobs"}
    return json.dumps({**page, "shared": shared}, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def policy_of(loader: str, script: str, style: str) -> str:
    """Return the page's Content-Security-Policy: its own scripts and style, and pictures that it makes."""
    scripts, styles = (
        " ".join(f"'sha256-{_hash(text)}'" for text in texts)
        for texts in ((loader, script), (_POSTER_STYLE, style))
    )
    return (
        f"default-src 'none'; script-src {scripts}; style-src {styles};"
        " img-src data: blob:; base-uri 'none'; form-action 'none'"
    )


def _hash(text: str) -> str:
    return base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")

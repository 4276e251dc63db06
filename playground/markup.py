"""Write HTML in which text is always text: what is not marked as markup is escaped.

    tag("p", "a < b", tag("b", "!"), class_="note")   →   <p class="note">a &lt; b<b>!</b></p>

So a name with ``<script>`` in it cannot become one: there is no way to forget to escape it.
"""

from __future__ import annotations

import base64
import hashlib
from html import escape

_NOWHERE = "base-uri 'none'; form-action 'none'"
_VOID = frozenset({"img", "input", "br", "meta", "link", "hr", "col"})


class Markup(str):
    """A text that is HTML already."""

    __slots__ = ()


def tag(name: str, /, *inside: str | Markup | None, **attributes: str | int | bool | None) -> Markup:
    """Return an element with what is inside it, escaped where it is no `Markup`; None is left out.

    Attributes are named as in HTML, with ``_`` for ``-`` and a ``_`` at the end of Python's own
    keywords (``class_``); True gives the bare name, False and None none.
    """
    written = [name]
    for key, value in attributes.items():
        if value is None or value is False:
            continue
        html_name = key.rstrip("_").replace("_", "-")
        written.append(html_name if value is True else f'{html_name}="{escape(str(value))}"')
    opening = f"<{' '.join(written)}>"
    if name in _VOID:
        return Markup(opening)
    return Markup(f"{opening}{joined(*inside)}</{name}>")


def joined(*parts: str | Markup | None) -> Markup:
    """Return parts one after the other, escaped where they are no `Markup`."""
    return Markup("".join(p if isinstance(p, Markup) else escape(p) for p in parts if p is not None))


def with_code(text: str) -> Markup:
    """Return a text, escaped, in which what stands between backquotes is code."""
    return joined(*(tag("code", part) if odd % 2 else part for odd, part in enumerate(text.split("`"))))


def document(
    language: str, title: str, body: Markup, *, policy: str, head: Markup | None = None, style: str = ""
) -> str:
    """Return a page: its ``policy`` is what it may load besides ``style``, which is inside."""
    inside = tag("style", Markup(style)) if style else None
    if style:
        policy = f"{policy}; style-src '{policy_hash(style)}'"
    whole = tag(
        "head",
        Markup('<meta charset="utf-8">'),
        tag("meta", http_equiv="Content-Security-Policy", content=f"{policy}; {_NOWHERE}"),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", title),
        inside,
        head,
    )
    return f"<!doctype html>\n{tag('html', whole, body, lang=language)}\n"


def policy_hash(text: str) -> str:
    """Return the hash of a style or a script, by which a page's policy allows it."""
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def data_url(kind: str, data: bytes) -> str:
    """Return the address of a file that is inside a page; ``kind`` is its media type."""
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"

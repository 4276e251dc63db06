"""Write HTML in which text is always text: what is not marked as markup is escaped.

    tag("p", "a < b", tag("b", "!"), class_="note")   →   <p class="note">a &lt; b<b>!</b></p>

So a name with ``<script>`` in it cannot become one: there is no way to forget to escape it.
"""

from __future__ import annotations

from html import escape

_VOID = frozenset({"img", "input", "br", "meta", "link", "hr"})


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

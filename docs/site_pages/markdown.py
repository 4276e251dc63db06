"""Write Markdown: plain text escaped, tables, anchors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

_SPECIAL = re.compile(r"([\\`*_{}\[\]<>|#])")


def escaped(text: str) -> str:
    """Return plain text as Markdown that shows just that text, on one line; `words` stay code."""
    parts = re.split(r"`([^`]+)`", " ".join(text.split()))
    return "".join(code(part) if at % 2 else _SPECIAL.sub(r"\\\1", part) for at, part in enumerate(parts))


def code(text: str) -> str:
    """Return a text in the code's font; "" stays empty."""
    return f"<code>{_entities(text)}</code>" if text else ""


def _entities(text: str) -> str:
    for sign, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ("|", "&#124;"), ("*", "&#42;")):
        text = text.replace(sign, entity)
    return text.replace("_", "&#95;")


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table without the columns in which every row is empty; "" without rows."""
    result = [tuple(row) for row in rows]
    if not result:
        return ""
    used = [at for at in range(len(head)) if any(row[at] for row in result)]
    lines = [[head[at] for at in used], ["---"] * len(used)]
    lines += [[row[at] for at in used] for row in result]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines) + "\n"


def fenced(text: str, language: str) -> str:
    """Return a block of code."""
    return f"```{language}\n{text.rstrip()}\n```\n\n"


def indented(text: str) -> str:
    """Return Markdown as the body of an admonition."""
    return "".join(f"    {line}\n" if line.strip() else "\n" for line in text.splitlines())


def folded(title: str, body: str) -> str:
    """Return a body that is shown when its title is clicked."""
    return f'??? note "{title}"\n\n{indented(body)}\n'


def slug(text: str) -> str:
    """Return a text as an anchor."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")

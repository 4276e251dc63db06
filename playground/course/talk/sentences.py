"""Cut a text into sentences, and choose those that a class reads from the last row."""

from __future__ import annotations

import re

from playground.course.model import Markdown

MAX_WORDS = 40
"""Words that are shown large at a time; only a single longer sentence is more."""

_WHOLE = re.compile(r"`[^`]*`|\$[^$]*\$|\[[^\]]*\]\([^)]*\)|\{\{[^}]*\}\}|«[^»]*»")  # never cut inside
_END = re.compile(r"[.!?…][\"”’)*_]*(?:\s+)(?=[A-ZÀ-Þ0-9«`$*\[({“\x00])")
_SHORT = re.compile(r"(?:\b(?:e\.g|i\.e|cf|p|pp|fig|vol|M|Mr|Dr|et al|env)|\b[A-Z])\.$")
_WORD = re.compile(r"[^\W_]+(?:['’.,\-][^\W_]+)*")
_BLANKS = re.compile(r"[ \t\n]+")  # a no-break space stays
_LINK = re.compile(r"\]\([^)]*\)")


def sentences(text: Markdown) -> list[Markdown]:
    """Return the sentences of one paragraph; code, formulas, links and quotations stay whole."""
    stored: list[str] = []

    def store(match: re.Match[str]) -> str:
        stored.append(match[0])
        return f"\0{len(stored) - 1}\1"

    flat = _BLANKS.sub(" ", _WHOLE.sub(store, text)).strip()
    parts, start = [], 0
    for end in _END.finditer(flat):
        part = flat[start : end.end()].strip()
        if _SHORT.search(part) or part.count("**") % 2:
            continue
        parts.append(part)
        start = end.end()
    parts.append(flat[start:].strip())
    return [re.sub("\0(\\d+)\1", lambda m: stored[int(m[1])], part) for part in parts if part]


def words(text: Markdown) -> int:
    """Count what is read of a text: its words, its numbers, the names in its formulas."""
    return len(_WORD.findall(_LINK.sub("]", text)))


def shown_of(text: Markdown, most: int = MAX_WORDS) -> Markdown:
    """Return the first sentences of a paragraph, of at most so many words; the first one always."""
    parts: list[Markdown] = []
    for sentence in sentences(text):
        if parts and words(" ".join([*parts, sentence])) > most:
            break
        parts.append(sentence)
    return " ".join(parts)

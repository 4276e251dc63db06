"""Compare texts of kernels without their comments and how they are laid out."""

from __future__ import annotations

import re

_COMMENT = re.compile(r"//(?:\\\n|[^\n])*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_TOKEN = re.compile(r"\w+|[^\w\s]")


def normalised(text: str) -> str:
    """Return a text as its tokens, without comments and without how it is laid out."""
    return " ".join(_TOKEN.findall(_COMMENT.sub(" ", text)))

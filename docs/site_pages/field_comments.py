"""Have mkdocstrings show what fields of dataclasses say of themselves: the comment at their line's end."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import griffe

_COMMENT = re.compile(r"\s#\s(.+)$")


class FieldComments(griffe.Extension):
    """Take the comment at the end of a field's line as its docstring, where it has no other."""

    def on_attribute_instance(self, *, attr: griffe.Attribute, **more: Any) -> None:
        """Look at one attribute."""
        owner = attr.parent
        if attr.docstring or not isinstance(owner, griffe.Class) or not attr.lineno:
            return
        file = attr.filepath
        if isinstance(file, Path):
            line = file.read_text("utf-8").splitlines()[attr.lineno - 1]
            if match := _COMMENT.search(line):
                attr.docstring = griffe.Docstring(match[1], lineno=attr.lineno, parent=attr)

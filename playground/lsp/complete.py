"""Completion in kernels and in sketches, as the protocol has it."""

from __future__ import annotations

from lsprotocol import types

from playground.engine.meshes import MESHES
from playground.engine.sources import SOURCES
from playground.lsp import describe
from playground.lsp.documents import Document, Documents
from playground.sketch.suggestions import Suggestion, include_row, suggestions
from playground.sketch.toml_suggestions import suggestions_in_sketch

Kind = types.CompletionItemKind
_KINDS = {
    "function": Kind.Function,
    "struct": Kind.Struct,
    "variable": Kind.Constant,
    "uniform": Kind.Variable,
    "macro": Kind.Constant,
    "keyword": Kind.Keyword,
    "property": Kind.Property,
    "choice": Kind.EnumMember,
    "field": Kind.Field,
    "file": Kind.File,
    "module": Kind.Module,
}


def complete_shader(document: Document, documents: Documents, at: int) -> list[types.CompletionItem]:
    """Return what may stand at a place of a shader."""
    listed = {"mesh": tuple(MESHES), "name": tuple(SOURCES)}
    with documents.reading():
        found = suggestions(document.path, document.text, document.root, at, listed)
    return [_item_of(suggestion, document, at) for suggestion in found]


def complete_sketch(document: Document, documents: Documents, at: int) -> list[types.CompletionItem]:
    """Return what may stand at a place of a sketch or of a technique of several passes."""
    with documents.reading():
        found = suggestions_in_sketch(document, at)
    return [_item_of(suggestion, document, at) for suggestion in found]


def _item_of(suggestion: Suggestion, document: Document, at: int) -> types.CompletionItem:
    kind, about = _KINDS[suggestion.kind], describe.suggestion(suggestion)
    if suggestion.kind == "variable" and not isinstance(suggestion.origin, tuple):
        kind = Kind.Variable
    if suggestion.include:
        about += f'\n\nadds `#include "{suggestion.include}"`'
    made = types.CompletionItem(
        suggestion.label,
        kind=kind,
        detail=suggestion.detail or None,
        documentation=types.MarkupContent(types.MarkupKind.Markdown, about) if about else None,
        sort_text=f"{suggestion.order}{suggestion.label}",
    )
    if suggestion.include:
        position = types.Position(include_row(document.text), 0)
        edit_range = types.Range(position, position)
        made.additional_text_edits = [types.TextEdit(edit_range, f'#include "{suggestion.include}"\n')]
    if suggestion.start >= 0:  # what is typed may hold dots and slashes
        made.text_edit = types.TextEdit(document.range(suggestion.start, at), suggestion.label)
        made.filter_text = suggestion.label
    return made

"""The record of a case's fast variants: what is reduced runs without being verified."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from playground.errors import PlaygroundError
from playground.shader.header import parse_kernel
from playground.shader.source import read_source
from playground.sketch.model import ComputeVariant, Kernel
from playground.sketch.variants import Verified, content_of, written


def record_text(pairs: Mapping[str, tuple[str, str]]) -> str:
    """Return a record in which each kernel's text and its variant's, by the variant's file, agree.

    A text that is no kernel has no place in it.
    """
    entries = {name: _contents(name, *texts) for name, texts in pairs.items()}
    return written({name: contents for name, contents in entries.items() if contents is not None})


def _contents(name: str, text: str, variant_text: str) -> Verified | None:
    try:
        plain, variant = _kernel("case.glsl", text), _kernel(name, variant_text)
    except PlaygroundError:
        return None
    if plain is None or not isinstance(variant, ComputeVariant):
        return None
    variant = replace(variant, outputs=plain.outputs, accepts=plain.accepts)
    return content_of(plain), content_of(variant)


def _kernel(name: str, text: str) -> Kernel | None:
    path = Path.cwd() / name
    return parse_kernel(name, read_source(path, (), {str(path.resolve()): text}))

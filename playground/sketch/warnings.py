"""Warn of what in a kernel's text has no effect, or another one than its author can see."""

from __future__ import annotations

from playground.errors import Diagnostic
from playground.sketch.model import Kernel
from playground.sketch.uniforms import unfed_samplers
from playground.sketch.unused_parameters import unread


def warnings_of_kernel(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a kernel's author should know: parameters that nothing reads, and ``unheeded``."""
    return (*unread(kernel), *unheeded(kernel))


def unheeded(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a picture does not show though the text says it: unfed samplers, ``#line``."""
    is_plain = kernel.kind.startswith("plain") and not kernel.dialect
    found = [*(unfed_samplers(kernel.source) if is_plain else ())]
    found += [
        line.diagnostic("#line is left out, so that errors name the file's own lines", severity="warning")
        for line in kernel.source.lines
        if line.left_out
    ]
    return tuple(dict.fromkeys(found))

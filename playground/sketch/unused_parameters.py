"""Find parameters that no code reads: moving them changes nothing."""

from __future__ import annotations

import re

from playground.errors import Diagnostic
from playground.sketch.model import Kernel, kernels_of


def unread(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return a warning for each parameter and input of a kernel that nothing reads.

    Included declarations count, at their own file and line. What a fast variant, a pragma or a macro
    reads counts as read. Sources and draws are left alone: the engine reads their uniforms.
    """
    if kernel.kind in ("source", "draw"):
        return ()
    variants = [inner for v in kernel.variants for _, inner in kernels_of(v.technique)]
    texts = [each.source for each in (kernel, *variants)]
    code = "\n".join([text.code for text in texts] + [line.pragma for text in texts for line in text.lines])
    found = []
    for name in [parameter.name for parameter in kernel.parameters] + [i.name for i in kernel.inputs]:
        declared = rf"\buniform\b[^;\n]*?\b{re.escape(name)}\s*(?:=[^;\n]*)?;"
        rest = re.sub(declared, "", code)
        if re.search(rf"\b(?:\w+_)?{re.escape(name)}\b", rest):
            continue
        for line in kernel.source.lines:
            match = re.search(declared, line.code)
            if match:
                column = match.start() + match[0].index(name) + 1
                found.append(
                    line.diagnostic(f"nothing reads '{name}', so it has no effect", column, "warning")
                )
                break
    return tuple(found)

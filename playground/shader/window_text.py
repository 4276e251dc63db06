"""Change a kernel's text so that it runs for a window of a picture, or return why that cannot be.

The text is changed in three places: it gets the texel of the whole, reads the window's own textures at the
window's texel, and ``gl_FragCoord`` counts from the whole's corner.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace

from playground.memo import GRAPHS
from playground.shader.kernel import Draw, ForeignShader, Kernel, TexelKernel
from playground.shader.reserved_names import MATCHES, WINDOW, WIRED, ZOOM
from playground.shader.source import SourceText

_KERNEL = re.compile(r"\bkernel\s*\(\s*(?:in\s+)?(ivec2\s+)(\w+)\b[^)]*\)\s*\{")
_BLOCK = re.compile(r"^(?:\w+\s+\w+\s*\([^()]*\)|struct\s+\w+)\s*\{", re.MULTILINE)
_LOCAL = "k_local"
_COORDINATES = re.compile(r"\bgl_FragCoord\b")


@GRAPHS.cached(identities=1)
def for_window(kernel: Kernel, inputs: tuple[str, ...]) -> Kernel | str:
    """Return a kernel that knows its window, or why there can be none."""
    code = kernel.source.code
    if isinstance(kernel, TexelKernel):
        if not kernel.runs_once or _names(code, "previous", *_previous(kernel)):
            return "it depends on the iteration"
        code_and_inputs = _kernel_code(kernel, code, inputs)
    else:
        others = [name for name in inputs if name != "initial" and _names(code, name)]
        if others:
            return f"it reads '{others[0]}' while it draws"
        code_and_inputs = _with_coordinates(kernel, code), ""
    changed, why = code_and_inputs
    return why if changed is None else replace(kernel, source=_source(kernel.source, changed))


def _previous(kernel: Kernel) -> list[str]:
    return [f"previous_{output.name}" for output in kernel.outputs]


def _names(code: str, *names: str) -> bool:
    """Return whether a text names something besides a sampler's declaration and fields of that name."""
    return any(re.search(rf"(?<!sampler2D )(?<!\.)\b{name}\b", code) for name in names)


def _kernel_code(kernel: Kernel, code: str, inputs: Iterable[str]) -> tuple[str | None, str]:
    """Return a kernel's text for a window; or None, and why there is none."""
    match = _KERNEL.search(code)
    if match is None:  # the driver's wrapper says what is wrong with its signature
        return code, ""
    texel = match.group(2)
    start, end = match.end(), _end_of_body(code, match.end())
    body = code[start:end]
    if re.search(rf"\b{texel}\s*(?:\.\w+\s*)?(?:[-+*/%]?=(?!=)|\+\+|--)|(?:\+\+|--)\s*{texel}\b", body):
        return None, f"it changes its '{texel}'"
    others = code[:start] + code[end:]
    for name in inputs:
        own = rf"\btexelFetch\s*\(\s*{name}\s*,\s*{texel}\s*,\s*0\s*\)"
        body = re.sub(own, f"texelFetch(k_own_{name}, {_LOCAL}, 0)", body)
        body = re.sub(rf"\btextureSize\s*\(\s*{name}\s*,\s*0\s*\)", "size", body)
        if _names(body, name) or _names(_without_own(others, name), name):
            return None, f"it reads '{name}' elsewhere than at its own texel"
        body = body.replace(f"k_own_{name}", name)
    for wired in (i.name for i in kernel.inputs if i.name not in inputs):
        whole = f"({WIRED}{wired} && textureSize({wired}, 0) == size)"
        body, others = (re.sub(rf"\b{MATCHES}{wired}\b", whole, text) for text in (body, others))
    head = code[: match.start(1)] + f"ivec2 {_LOCAL}" + code[match.end(2) : start]
    if others != code[:start] + code[end:]:
        return None, "a function of its own asks whether an input matches"
    return f"{head} ivec2 {texel} = {_LOCAL} + {WINDOW};{body}{code[end:]}", ""


def _without_own(code: str, name: str) -> str:
    """Blank the functions and structs of a text that have a variable of a name: there it is no texture."""
    own = re.compile(rf"\b(?!(?:return|else|case)\b)[A-Za-z_]\w*\s+{name}\b")
    text = code
    for match in _BLOCK.finditer(code):
        end = _end_of_body(code, match.end())
        if own.search(code, match.start(), end):
            text = text[: match.start()] + " " * (end - match.start()) + text[end:]
    return text


def _end_of_body(code: str, start: int) -> int:
    depth = 1
    for index in range(start, len(code)):
        depth += {"{": 1, "}": -1}.get(code[index], 0)
        if depth == 0:
            return index
    return len(code)


def _with_coordinates(kernel: Kernel, code: str) -> str:
    """Let ``gl_FragCoord`` count from the whole picture's corner."""
    changed = _COORDINATES.sub(f"(gl_FragCoord + vec4({WINDOW}, 0.0, 0.0))", code)
    if isinstance(kernel, Draw):
        return f"{changed}uniform vec4 {ZOOM};\n"  # a line of its own
    if changed == code or isinstance(kernel, ForeignShader):  # whose wrapper declares it
        return changed
    # A plain shader declares for itself: before its first line that is neither blank nor of the preprocessor.
    lines, depth = changed.split("\n"), 0
    for index, line in enumerate(lines):
        word = re.match(r"\s*#\s*(\w+)", line)
        if word:
            depth += {"if": 1, "ifdef": 1, "ifndef": 1, "endif": -1}.get(word.group(1), 0)
        elif line.strip() and depth == 0:
            lines[index] = f"uniform ivec2 {WINDOW}; {line}"
            break
    return "\n".join(lines)


def _source(source: SourceText, code: str) -> SourceText:
    """Return a text with other code on the same lines; what comes after them is taken for the last."""
    changed = code.removesuffix("\n").split("\n")
    lines = (*source.lines, *source.lines[-1:] * (len(changed) - len(source.lines)))
    together = zip(lines, changed, strict=True)
    return SourceText(source.path, tuple(replace(line, code=now) for line, now in together), source.files)

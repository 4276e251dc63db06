"""Write the functions by which a compute variant reads its buffers: as they are, or as textures."""

from __future__ import annotations

import re
from itertools import count

from playground.shader.outline import outline
from playground.shader.reserved_names import READ
from playground.shader.stage_recipe import Part
from playground.sketch.kernel import Buffer, ComputeVariant

TEXELS = "k_texels_"
"""What begins the name of the sampler by which a buffer is read, and is the choice to read buffers so."""

FIRST_UNIT = 32
"""The texture unit of the first buffer that is read so, the others' follow: beyond those of inputs."""

_SWIZZLES = {"float": ".r", "vec2": ".rg", "vec4": ""}  # of the buffers that may be read so
_FUNCTION = re.compile(rf"^(\w+) {READ}(\w+)\(int place\) {{ return \2\[place\]; }}$", re.MULTILINE)


def read_by_functions(kernel: ComputeVariant) -> list[Buffer]:
    """Return the buffers that a compute variant reads by these functions, unless it has its own."""
    found = [b for b in kernel.storage.buffers if b.type in _SWIZZLES and kernel.reads(f"{READ}{b.name}")]
    own = {one.name for one in outline(kernel.source.code)} if found else set()
    return [buffer for buffer in found if f"{READ}{buffer.name}" not in own]


def reading(kernel: ComputeVariant) -> list[Part]:
    """Return these functions."""
    return [
        Part(f"{buffer.type} {READ}{buffer.name}(int place) {{ return {buffer.name}[place]; }}")
        for buffer in read_by_functions(kernel)
    ]


def with_texels(text: str) -> str:
    """Have those functions read textures, which changes no line."""
    units = count(FIRST_UNIT)

    def by_sampler(match: re.Match[str]) -> str:
        kind, name = match.groups()
        sampler = f"layout(binding = {next(units)}) uniform samplerBuffer {TEXELS}{name};"
        fetch = f"texelFetch({TEXELS}{name}, place){_SWIZZLES[kind]}"
        return f"{sampler} {kind} {READ}{name}(int place) {{ return {fetch}; }}"

    return _FUNCTION.sub(by_sampler, text)

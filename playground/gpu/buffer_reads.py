"""Write the functions by which a compute variant reads its buffers: as they are, or as textures."""

from __future__ import annotations

import re
from itertools import count

from playground.gpu.stage_recipe import Part
from playground.sketch.model import Buffer
from playground.sketch.reserved_names import READ

TEXELS = "k_texels_"
"""What begins the name of the sampler by which a buffer is read, and is the choice to read buffers so."""

FIRST_UNIT = 32
"""The texture unit of the first buffer that is read so, the others' follow: beyond those of inputs."""

_SWIZZLES = {"float": ".r", "vec2": ".rg", "vec4": ""}  # of the buffers that may be read so
_FUNCTION = re.compile(rf"^(\w+) {READ}(\w+)\(int place\) {{ return \2\[place\]; }}$", re.MULTILINE)


def reading(buffer: Buffer) -> tuple[Part, ...]:
    """Return the function that reads a number of a buffer, declared where a text names it."""
    if buffer.type not in _SWIZZLES:
        return ()
    name = f"{READ}{buffer.name}"
    return (Part(f"{buffer.type} {name}(int place) {{ return {buffer.name}[place]; }}", (name,)),)


def with_texels(text: str) -> str:
    """Have those functions read textures, which changes no line."""
    units = count(FIRST_UNIT)

    def by_sampler(match: re.Match[str]) -> str:
        kind, name = match.groups()
        sampler = f"layout(binding = {next(units)}) uniform samplerBuffer {TEXELS}{name};"
        fetch = f"texelFetch({TEXELS}{name}, place){_SWIZZLES[kind]}"
        return f"{sampler} {kind} {READ}{name}(int place) {{ return {fetch}; }}"

    return _FUNCTION.sub(by_sampler, text)

"""Parts of the small sketches that tests write, as their TOML has them."""

from __future__ import annotations

from typing import Any

SMALL_VIEW = """[view]
use = "view/terrain"
set = { grid = 9 }
"""
"""A view of a terrain that draws next to nothing."""


def toml_value(value: object) -> str:
    """Return a parameter's value as TOML writes it."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{ " + ", ".join(f'"{key}" = {toml_value(item)}' for key, item in value.items()) + " }"
    if isinstance(value, tuple | list):
        return "[" + ", ".join(map(toml_value, value)) + "]"
    return f'"{value}"' if isinstance(value, str) else f"{value}"


def settings(**values: object) -> str:
    """Return the line that sets parameters; nothing where there are none."""
    return (
        "set = { " + ", ".join(f"{k} = {toml_value(v)}" for k, v in values.items()) + " }" if values else ""
    )


def use(
    technique: str, *lines: str, size: object = None, inputs: dict[str, str] | None = None, **values: object
) -> tuple[str, ...]:
    """Return what ``passes`` takes of one pass: its technique, its size, its wires and its parameters.

    A size may be an expression, a text. Other lines are as TOML has them.
    """
    sized = () if size is None else (f"size = {toml_value(size)}",)
    wired = (f"inputs = {toml_value(inputs)}",) if inputs else ()
    return technique, *sized, *wired, settings(**values), *lines


def passes(**uses: str | tuple[str, ...]) -> str:
    """Return passes by their names, each with the technique that it uses and what other lines it has."""
    text = ""
    for name, value in uses.items():
        technique, *lines = (value,) if isinstance(value, str) else value
        text += f'[[pass]]\nname = "{name}"\nuse = "{technique}"\n' + "".join(f"{line}\n" for line in lines)
    return text


def view(technique: str, *lines: str, samples: int = 1, **more: Any) -> str:
    """Return the view of a sketch, of what ``use`` takes of a pass."""
    technique, *lines = use(technique, *lines, **more)
    return f'[view]\nuse = "{technique}"\nsamples = {samples}\n' + "".join(f"{line}\n" for line in lines)


TYPES = {"r": "float", "rg": "vec2", "rgb": "vec3", "rgba": "vec4"}


def kernel(value: str, output: str = "height:r32f", *lines: str) -> str:
    """Return a kernel's text: an expression of ``texel``, or statements that return it.

    Lines before it have its uniforms and includes. What draws random numbers includes the library's hash.
    """
    kind = TYPES[output.partition(":")[2].rstrip("0123456789f")]
    body = value if "return " in value else f"return {value};"
    include = ['#include "noise/hash.glsl"'] if "random" in value else []
    head = [*include, f'#pragma kernel(output = "{output}")', *lines]
    return "\n".join([*head, f"{kind} kernel(ivec2 texel) {{ {body} }}\n"])


def map_of(shown: str, channel: str = "") -> str:
    """Return the view that shows a texture from above, in grey or a channel as it is."""
    text = f'[view]\nuse = "view/map"\ninputs = {{ shown = "{shown}" }}\n'
    return text + (f'set = {{ channel = "{channel}" }}\n' if channel else "")


def map_of_height(use: str = "./terrain", channel: str = "") -> str:
    """Return a pass "height" and the view that shows it from above."""
    return passes(height=use) + map_of("height", channel)


TERRAIN_IN_3D = (
    "format = 1\nsize = 33\n" + passes(height="./terrain") + '[view]\nuse = "view/terrain"\nsamples = 1\n'
)
"""A sketch of one kernel, terrain.glsl, in the 3D view."""

LIT_NOISE = passes(height="generation/white_noise", light="lighting/l_dot_n")
"""The cheapest terrain of the library and the cheapest light."""

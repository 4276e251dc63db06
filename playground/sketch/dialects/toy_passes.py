"""Make shaders of Shadertoy's passes: their order, what each is given, what its channels read."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from playground.errors import ShaderError
from playground.sketch.dialects.conditions import WEBGL_2, live_source
from playground.sketch.dialects.declarations import is_declared
from playground.sketch.dialects.directives import KEYBOARD
from playground.sketch.dialects.es import rewritten
from playground.sketch.dialects.shader import Channel, Rules, Shader
from playground.sketch.dialects.shadertoy import MACROS, MORE_NAMES, NAMES, defines, with_sampler_types
from playground.sketch.model import Parameter, Sampling, Widget
from playground.sketch.source import SourceText

IMAGE, BUFFER, CUBE = "image", "buffer", "cubemap"
CUBE_SIDE = 1024
"""Texels of a side of a cube map's face, as on Shadertoy's site."""

OF_BUFFERS = Sampling("linear", "clamp")
"""How a pass is read where nothing says how."""

_ORDER = (BUFFER, CUBE, IMAGE)
_EPILOGUES = {IMAGE: "main_image.glsl", BUFFER: "main_buffer.glsl", CUBE: "main_cubemap.glsl"}
_FORMATS = {IMAGE: "rgba8", BUFFER: "rgba32f", CUBE: "rgba16f"}
_FUNCTIONS = {IMAGE: "mainImage", BUFFER: "mainImage", CUBE: "mainCubemap"}
_NOT_NAMES = re.compile(r"\W+")


@dataclass(frozen=True)
class ToyInput:
    """What one channel reads: a pass or a technique, or an image file."""

    channel: Channel
    type: str = "sampler2D"
    file: str = ""  # an image, from the root


@dataclass(frozen=True)
class ToyPass:
    """One pass, as its tool calls it."""

    label: str  # "Buffer A"
    kind: str  # image | buffer | cubemap
    source: SourceText  # what they have in common before it
    inputs: Mapping[str, ToyInput] = field(default_factory=dict)  # by sampler; others are noise
    may_have_main: bool = False  # one of its own, in place of the function of its kind
    called: str = ""  # its name, where that is not made of the label

    @property
    def name(self) -> str:
        """Its name as a pass, and as what others read."""
        return self.called or pass_name(self.label)


def pass_name(label: str) -> str:
    """Return the name of a pass that its tool calls so: ``buffer_a`` of "Buffer A"."""
    return _NOT_NAMES.sub("_", label.strip()).strip("_").lower()


def with_common(common: SourceText | None, source: SourceText) -> SourceText:
    """Return a pass's text after what all have in common; each line stays that of its own file."""
    if common is None:
        return source
    files = tuple(dict.fromkeys((*source.files, *common.files)))
    return SourceText(source.path, (*common.lines, *source.lines), files)


def shaders_of(passes: Sequence[ToyPass], dialect: str = "shadertoy") -> tuple[Shader, ...]:
    """Return the shaders of some passes in the order in which they are drawn, the image last.

    ``dialect`` is the name of their row.

    Buffers and cube maps come in the order given. Raises ``ShaderError`` for one without its function.
    """
    ordered = sorted(passes, key=lambda one: _ORDER.index(one.kind))
    macros = {"SHADER_TOY": "", **WEBGL_2} if dialect == "vscode" else MACROS
    live = [replace(one, source=live_source(one.source, macros)) for one in ordered]
    return tuple(_shader(one, dialect) for one in live)


def _shader(one: ToyPass, dialect: str) -> Shader:
    function = _FUNCTIONS[one.kind]
    is_there = function in one.source.names
    has_main = one.may_have_main and not is_there and is_declared(one.source.code, "main", anywhere=False)
    if not (is_there or has_main):
        own = [line for line in one.source.lines if line.text.strip()]
        place = own[-1] if own else one.source.lines[-1]
        others = next((f for f in ("mainImage", "mainCubemap", "mainSound") if f in one.source.names), "")
        hint = f", but a {others}" if others else ""
        raise ShaderError(diagnostics=[place.diagnostic(f"{one.label} has no {function}{hint}")])
    names = dict(with_sampler_types(MORE_NAMES if dialect == "vscode" else NAMES, one.source))
    parameters = []
    for sampler, feeds in one.inputs.items():
        if feeds.file:
            names.pop(sampler, None)
            line = one.source.lines[-1]
            parameters.append(
                Parameter(
                    sampler,
                    "sampler2D",
                    feeds.file,
                    Widget("file"),
                    sampling=feeds.channel.sampling,
                    file=line.file,
                    line=line.number,
                )
            )
        else:
            names[sampler] = (feeds.type, "none")
    if one.kind == CUBE:
        names["iResolution"] = ("vec3", "square_resolution")
    has_keyboard = KEYBOARD in one.inputs
    return Shader(
        one.name,
        rewritten(one.source),
        Rules(
            dialect,
            names,
            epilogue="" if has_main else _EPILOGUES[one.kind],
            helpers=("vscode_keyboard.glsl",) if has_keyboard else (),
            defines=defines if dialect != "vscode" else lambda source: (),
        ),
        named=frozenset({KEYBOARD}) if has_keyboard else frozenset(),
        target=one.name,
        channels={name: feeds.channel for name, feeds in one.inputs.items() if not feeds.file},
        parameters=tuple(parameters),
        size=(str(CUBE_SIDE), str(6 * CUBE_SIDE)) if one.kind == CUBE else None,
        format=_FORMATS[one.kind],
        prelude=_prelude(one.kind, dialect),
        keeps=one.kind != IMAGE,
    )


def _prelude(kind: str, dialect: str) -> tuple[str, ...]:
    found = (f"const float k_side = {CUBE_SIDE}.0;",) if kind == CUBE else ()
    return ("#define SHADER_TOY", *found) if dialect == "vscode" else found


def reading(target: str, sampling: Sampling = OF_BUFFERS) -> Channel:
    """Return a channel that reads a pass."""
    return replace(Channel(target=target), sampling=sampling)

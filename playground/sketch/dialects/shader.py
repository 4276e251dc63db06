"""One pass of another tool's file: its text, what its dialect gives it, what its samplers read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from playground.sketch.dialects.es import Rewritten
from playground.sketch.model import Parameter, Sampling, Value
from playground.sketch.source import SourceText

Names = Mapping[str, tuple[str, str]]
"""Name → GLSL type and meaning: a key of ``Runner``'s values; of a sampler "noise 0", "picture 3", "none"."""

STAND_INS = {
    "noise": "foreign/noise",
    "picture": "foreign/picture",
    "sky": "foreign/sky_box",
    "volume": "foreign/noise",
    "sound": "foreign/spectrum",
    "fft": "foreign/spectrum",
    "keys": "foreign/keys",
}
"""What is drawn where nothing feeds a channel: the first word of its meaning → a technique of ``glsl/``."""

STAND_INS_OF_SHAPES = {"cube": "sky", "volume": "volume"}
"""Likewise, by a channel's shape, where it has one of its own."""

SAMPLING = Sampling("linear", "repeat", mipmap=True)
STAND_IN_SIZE = ("256", "256")
SIZES = {
    "foreign/keys": ("256", "3"),
    "foreign/microphone": ("512", "2"),
    "foreign/sky_box": ("128", "768"),
    "foreign/sound": ("512", "2"),
    "foreign/spectrum": ("512", "2"),
}
"""Texels of techniques that feed a channel, where they are not ``STAND_IN_SIZE``."""

SIZES_OF_SHAPES = {"cube": ("64", "384"), "volume": ("32", "1024"), "line": ("256", "1")}
"""Texels of other techniques, by the channel's shape."""

_CLAMPED = Sampling("linear", "clamp")
_SAMPLINGS = {"sound": _CLAMPED, "fft": _CLAMPED, "keys": Sampling("nearest", "clamp")}
_STRENGTHS = {"fft": 0.01}  # Bonzomatic's shaders multiply what they hear, by 100 as a rule
_ALIKE = ("keys",)  # stand-ins that have no numbers


@dataclass(frozen=True)
class Rules:
    """What a dialect gives a shader."""

    name: str  # of its row
    names: Names
    declared_anywhere: bool = False  # a name declared in any function counts as declared
    epilogue: str = ""  # of gpu/shaders
    varyings: tuple[str, ...] = ()  # declarations of what every text may take from its vertex shader
    helpers: tuple[str, ...] = ()  # of gpu/shaders, between what is declared and the text
    vertex_helpers: tuple[str, ...] = ()  # likewise, of a vertex shader of the author's own
    defines: Callable[[SourceText], tuple[str, ...]] = lambda source: ()  # lines of the prelude


@dataclass(frozen=True)
class Channel:
    """What one sampler of a shader reads: a target, or a technique of ``glsl/``; neither: black."""

    target: str = ""  # of the same file: its latest write in this frame, else that of the frame before
    use: str = ""  # a technique, as "foreign/image"
    values: tuple[tuple[str, Value], ...] = ()  # of the technique
    size: tuple[str, str] = STAND_IN_SIZE  # [texels] likewise, expressions
    sampling: Sampling = SAMPLING
    unfed: str = ""  # what is drawn instead, where the technique is a stand-in: the end of a sentence


def stand_in(kind: str, number: int, unfed: str) -> Channel:
    """Return a channel that a stand-in feeds; ``kind`` is a key of ``STAND_INS``."""
    size = SIZES.get(STAND_INS[kind]) or SIZES_OF_SHAPES.get(kind, STAND_IN_SIZE)
    values: tuple[tuple[str, Value], ...] = () if kind in _ALIKE else (("number", number),)
    if kind in _STRENGTHS:
        values = (*values, ("strength", _STRENGTHS[kind]))
    sampling = _SAMPLINGS.get(kind, SAMPLING)
    return Channel(use=STAND_INS[kind], values=values, size=size, sampling=sampling, unfed=unfed)


@dataclass(frozen=True)
class Shader:
    """One pass of another tool's file."""

    name: str  # of the pass, one of its own in the file
    text: Rewritten
    rules: Rules
    target: str = ""  # what others read its picture as; of two that write one, the later counts
    channels: Mapping[str, Channel] = field(default_factory=dict)  # by sampler; others go by the rules
    parameters: tuple[Parameter, ...] = ()  # besides the uniforms that the text declares
    size: tuple[str, str] | None = None  # expressions; None: the size of the picture
    format: str = "rgba8"
    named: frozenset[str] = frozenset()  # names of the rules that the prelude names
    prelude: tuple[str, ...] = ()  # lines besides those that the rules give
    vertex: Rewritten | None = None  # the author's own vertex shader
    keeps: bool = False  # what it wrote in the last frame may be read
    repeat: str = ""  # an expression: it is drawn so often, and reads what it wrote before by ``feeds``
    feeds: str = ""  # a sampler


@dataclass(frozen=True)
class Made:
    """A pass that a technique of ``glsl/`` makes of what others wrote; its output is ``frame``."""

    name: str
    use: str
    reads: Mapping[str, str]  # input → target
    target: str = ""
    size: tuple[str, str] | None = None
    repeat: str = ""
    feeds: str = ""  # an input
    keeps: bool = True

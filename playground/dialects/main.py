"""Read a fragment shader with a ``main`` of its own, and glslViewer's passes of one text.

``BUFFER_n``, ``DOUBLE_BUFFER_n``, ``PYRAMID_n``, ``FLOOD_n`` and ``POSTPROCESSING`` are passes where the
text has other lines with the macro than without. A pyramid's levels are passes too, as many as the largest
picture needs; those that a smaller one has not, hand on what they are given. A flood is a loop.

The names are those of glslCanvas, glslViewer, KodeLife, Bonzomatic and glslsandbox.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from playground.dialects import shadertoy
from playground.dialects.es import Rewritten, directives, rewritten, version_of
from playground.dialects.foreign import VIEW, Files, Made, Names, Rules, Shader, ShaderChannel
from playground.shader.conditions import WEBGL, Conditions, live_source, macros_of
from playground.shader.declarations import uniforms, vertex_outputs
from playground.shader.parameter import Sampling
from playground.shader.reserved_names import DEPTH, PLAIN_UNIFORMS, SIZES, VALUE
from playground.shader.source import SourceText
from playground.shader.syntax.tokens import is_named

LEVELS = 12
"""The most that a pyramid goes down."""

_PASS = re.compile(r"(BUFFER|DOUBLE_BUFFER|(?:CONVOLUTION_)?PYRAMID|FLOOD)_(\d{1,9})|(CONVOLUTION_PYRAMID)")
_KINDS = {"BUFFER": "buffer", "DOUBLE_BUFFER": "double_buffer", "FLOOD": "flood"}  # all others: pyramid
_ORDER = ("buffer", "double_buffer", "pyramid", "flood")
_SAMPLERS = {
    "buffer": ("u_buffer",),
    "double_buffer": ("u_doubleBuffer",),
    "pyramid": ("u_pyramid", "u_convolutionPyramid"),
    "flood": ("u_flood",),
}
_PYRAMIDS, _FLOODS = ("PYRAMID_ALGORITHM", "CONVOLUTION_PYRAMID_ALGORITHM"), ("FLOOD_ALGORITHM",)
_SIZE = re.compile(r"\s*(?:(\d{1,9})\d*\s*x\s*(\d{1,9})\d*|(\d*\.\d+)(?:\s*x\s*(\d*\.\d+))?)(?![\w.])")
_BUFFER = Sampling("linear", "repeat")
_LEVEL = Sampling("nearest", "clamp")
_SEED = Sampling("nearest", "repeat")  # a round reads texels: between two of them there is no place
_SCENE = "scene"
_MAX_FACTOR = 1e6  # of a pass's size to the picture's

Size = tuple[str, str] | None


@dataclass(frozen=True)
class _Pass:
    """A pass that the text has."""

    define: str
    kind: str
    number: str

    @property
    def name(self) -> str:
        return f"{self.kind}{self.number}"

    @property
    def samplers(self) -> tuple[str, ...]:
        return tuple(f"{begins}{self.number}" for begins in _SAMPLERS[self.kind])


def shaders_of(text: Rewritten, rules: Rules, macros: Mapping[str, str]) -> Sequence[Shader | Made]:
    """Return the passes of a text, the picture last; of a text without any, none.

    ``macros`` are macros that a driver would define besides those of the rules.
    """
    return _Viewer(text, rules, macros).shaders()


class _Viewer:
    """One text, and which of its lines each pass has."""

    def __init__(self, text: Rewritten, rules: Rules, names: Mapping[str, str]) -> None:
        self.text = text
        self.driver_macros = names
        self.rules = rules
        self.conditions = Conditions([line.code for line in text.source.lines])
        before = [line for line in rules.defines(text.source) if not line.endswith("BACKGROUND")]
        self.declared = tuple(line for line in before if not line.startswith("#define"))
        self.given_macros = macros_of(before)
        self._live: dict[tuple[str, ...], tuple[str, ...]] = {}
        self.bare = self.live()
        self.sources: dict[tuple[str, ...], SourceText] = {}

    def live(self, *macros: str) -> tuple[str, ...]:
        """Return the lines that there are where some passes' macros are defined."""
        if macros not in self._live:
            self._live[macros] = self.conditions.live(
                {**self.driver_macros, **self.given_macros, **dict.fromkeys(macros, "")}
            )
        return self._live[macros]

    def changes(self, macro: str) -> bool:
        """Return whether the text has other lines where a macro is defined."""
        return macro in self.conditions.names and self.live(macro) != self.bare

    @cached_property
    def passes(self) -> tuple[_Pass, ...]:
        """Those that are drawn before the picture, in order."""
        passes: dict[str, _Pass] = {}
        for name in sorted(self.conditions.names):
            if (match := _PASS.fullmatch(name)) and self.changes(name):
                viewer_pass = _Pass(name, _KINDS.get(match[1] or "", "pyramid"), match[2] or "")
                passes.setdefault(viewer_pass.name, viewer_pass)
        return tuple(
            sorted(
                passes.values(),
                key=lambda viewer_pass: (_ORDER.index(viewer_pass.kind), int(viewer_pass.number or 0)),
            )
        )

    def shaders(self) -> list[Shader | Made]:
        """Return all passes, the picture last; none where there is but the picture."""
        post = self.changes("POSTPROCESSING")
        if not self.passes and not post:
            return []
        result: list[Shader | Made] = []
        for viewer_pass in self.passes:
            size = self._size(viewer_pass)
            if viewer_pass.kind == "pyramid":
                result += self._pyramid(viewer_pass, size)
            elif viewer_pass.kind == "flood":
                result += self._flood(viewer_pass, size)
            else:
                result.append(
                    self._shader(viewer_pass.name, (viewer_pass.define,), size=size, own=viewer_pass)
                )
        background = ("BACKGROUND",) if self.changes("BACKGROUND") else ()
        if not post:
            return [*result, self._shader(VIEW, background)]
        result.append(self._shader(_SCENE, background, channels={"u_scene": ShaderChannel()}))
        return [*result, self._shader(VIEW, ("POSTPROCESSING",))]

    def _shader(
        self,
        name: str,
        macros: tuple[str, ...],
        *,
        size: Size = None,
        own: _Pass | None = None,
        channels: Mapping[str, ShaderChannel] | None = None,
        names: Names | None = None,
        repeat: str = "",
        feeds: str = "",
    ) -> Shader:
        """Return the text with some macros defined, as a pass; ``own`` is the pass that it is the text of.

        Others read each by its name, but the picture; the scene has 8 bits as well.
        """
        made = Rewritten(self._source(macros), self.text.prelude)
        defined = {**self.given_macros, **dict.fromkeys(macros, "")}
        before = (*(f"#define {n} {v}".rstrip() for n, v in defined.items()), *self.declared)
        samplers: Names = {
            s: ("sampler2D", "none") for viewer_pass in self.passes for s in viewer_pass.samplers
        }
        rules = replace(
            self.rules, names={**self.rules.names, **samplers, **(names or {})}, defines=lambda source: before
        )
        return Shader(
            name,
            made,
            rules,
            target="" if name == VIEW else name,
            channels={**self._buffers(own), **(channels or {})},
            size=size,
            format="rgba8" if name in (VIEW, _SCENE) else "rgba32f",
            keeps=name != VIEW,
            repeat=repeat,
            feeds=feeds,
        )

    def _source(self, macros: tuple[str, ...]) -> SourceText:
        """Return the text where some macros are defined: the same object for the same lines."""
        codes = self.live(*macros)
        if codes not in self.sources:
            self.sources[codes] = self.text.source.with_codes(codes)
        return self.sources[codes]

    def _buffers(self, own: _Pass | None) -> dict[str, ShaderChannel]:
        """Return what reads the scene and the passes; only double buffers and floods read themselves."""
        channels: dict[str, ShaderChannel] = {}
        if self.changes("POSTPROCESSING"):  # before it is drawn, the scene is that of the last frame
            channels["u_scene"] = ShaderChannel(target=_SCENE, sampling=_BUFFER)
        for viewer_pass in self.passes:
            sampling = _LEVEL if viewer_pass.kind == "pyramid" else _BUFFER
            black = viewer_pass is own and viewer_pass.kind in ("buffer", "pyramid")
            channel = ShaderChannel() if black else ShaderChannel(target=viewer_pass.name, sampling=sampling)
            channels |= dict.fromkeys(viewer_pass.samplers, channel)
        return channels

    def _size(self, viewer_pass: _Pass) -> Size:
        """Return the size in the comment behind a sampler's declaration: texels, or shares of the picture."""
        for line in self.text.source.lines:
            is_of_pass = is_named(line.code, ("uniform",)) and is_named(line.code, viewer_pass.samplers)
            if is_of_pass and (match := _SIZE.match(line.comment)):
                if match[1]:
                    return f"max({int(match[1])}, 1)", f"max({int(match[2])}, 1)"
                wide, tall = (min(float(text), _MAX_FACTOR) for text in (match[3], match[4] or match[3]))
                return f"max(floor(size.x * {wide!r}), 1)", f"max(floor(size.y * {tall!r}), 1)"
        return None

    def _algorithm(self, macros: tuple[str, ...]) -> tuple[str, ...]:
        """Return the macro of the text's own algorithm; none where it has none."""
        return tuple(macro for macro in macros if self.changes(macro))[:1]

    # ── floods ───────────────────────────────────────────────────────────────

    def _flood(self, viewer_pass: _Pass, size: Size) -> list[Shader | Made]:
        """Return the pass of the seeds, and the rounds of jumps after it."""
        seeds = f"{viewer_pass.name}_seeds"
        first = self._shader(seeds, (viewer_pass.define,), size=size, own=viewer_pass)
        algorithm = self._algorithm(_FLOODS)
        if not algorithm:
            reads = {"initial": seeds}
            return [first, Made(viewer_pass.name, "foreign/jump_flood", reads, viewer_pass.name, size)]
        width, height = size or ("size.x", "size.y")
        rounds = self._shader(
            viewer_pass.name,
            algorithm,
            size=size,
            channels={"u_floodSrc": ShaderChannel(target=seeds, sampling=_SEED)},
            names={"u_floodIndex": ("int", "iteration"), "u_floodTotal": ("int", "iterations")},
            repeat=f"1 + bits(max({width}, {height}) - 1)",
            feeds="u_floodSrc",
        )
        return [first, rounds]

    # ── pyramids ─────────────────────────────────────────────────────────────

    def _pyramid(self, viewer_pass: _Pass, size: Size) -> list[Shader | Made]:
        """Return the pass at the foot of a pyramid, its levels down, and those up again.

        Of a picture whose shorter side is m there are levels while m is at least 2 ** (level + 2). Of
        the others, those up give what they are given of their own level: nothing runs for them.
        """
        algorithm = self._algorithm(_PYRAMIDS)
        foot = f"{viewer_pass.name}_foot"
        pyramid: list[Shader | Made] = [
            self._shader(foot, (viewer_pass.define,), size=size, own=viewer_pass),
        ]
        width, height = size or ("size.x", "size.y")
        downs = [foot, *(f"{viewer_pass.name}_down{level}" for level in range(LEVELS))]

        def size_of(level: int) -> tuple[str, str]:
            return f"max({width} // {2**level}, 1)", f"max({height} // {2**level}, 1)"

        def add(name: str, level: int, reads: tuple[str, str], repeat: str, below: int) -> None:
            if not algorithm:
                use = "foreign/pyramid_up" if repeat else "foreign/pyramid_down"
                inputs = dict(zip(("level", "coarser") if repeat else ("finer",), reads, strict=False))
                feeds = "level" if repeat else ""
                pyramid.append(Made(name, use, inputs, name, size_of(below), repeat, feeds))
                return
            pyramid.append(self._level(name, level, reads, size_of(below), repeat, below, algorithm))

        for level in range(LEVELS):
            add(downs[level + 1], level, (downs[level], ""), "", level + 1)
        coarser = downs[LEVELS]
        for level in reversed(range(LEVELS)):
            name = viewer_pass.name if level == 0 else f"{viewer_pass.name}_up{level}"
            repeat = f"0 + (min({width}, {height}) >= {2 ** (level + 2)})"
            add(name, level, (downs[level], coarser), repeat, level)
            coarser = name
        return pyramid

    def _level(
        self,
        name: str,
        level: int,
        reads: tuple[str, str],
        size: tuple[str, str],
        repeat: str,
        below: int,
        algorithm: tuple[str, ...],
    ) -> Shader:
        """Return a level by the text's own algorithm; it is ``below`` the foot, as powers of two."""
        channels: dict[str, ShaderChannel] = {}
        names: dict[str, tuple[str, str]] = {}
        for begins in _SAMPLERS["pyramid"]:
            for number, read in enumerate(reads):
                sampler = f"{begins}Tex{number}"
                channels[sampler] = ShaderChannel(target=read, sampling=_LEVEL) if read else ShaderChannel()
                names[sampler] = ("sampler2D", "none")
            names[f"{begins}Depth"] = ("int", f"{VALUE}{level}")
            names[f"{begins}Upscaling"] = ("bool", f"{VALUE}{int(bool(repeat))}")
            for total in ("TotalDepth", "Depths"):
                names[f"{begins}{total}"] = ("int", f"{DEPTH}{below}")
        feeds = next((f"{b}Tex0" for b in _SAMPLERS["pyramid"] if f"{b}Tex0" in self.text.source.names), "")
        return self._shader(
            name,
            algorithm,
            size=size,
            channels=channels,
            names=names,
            repeat=repeat,
            feeds=feeds if repeat else "",
        )


_MAX_IMAGES = 10
_TYPES = {
    "time": "float",
    "resolution": "vec2",
    "mouse": "vec2",
    "frame": "int",
    "delta": "float",
    "date": "vec4",
}
_MEANINGS = {"mouse": "hover", "frame": "frame_of_time"}
_MATRICES = (
    "u_modelMatrix u_viewMatrix u_projectionMatrix u_modelViewMatrix u_modelViewProjectionMatrix".split()
)
_PICTURES = range(_MAX_IMAGES)
_BEFORE = ("backbuffer", "u_backbuffer", "prevFrame", "prevPass", "texPreviousFrame")
"""Samplers that read the picture of the frame before: 8 bits a channel, as the tools have it."""

_ELSEWHERE: Names = {
    # glslViewer
    **{f"u_tex{n}": ("sampler2D", f"picture {n}") for n in _PICTURES},
    **{f"u_tex{n}Resolution": ("vec2", f"{SIZES}u_tex{n}") for n in _PICTURES},
    "u_camera": ("vec3", "camera"),
    "u_light": ("vec3", "light"),
    "u_lightColor": ("vec3", "one"),
    "u_view2d": ("mat3", "identity3"),
    "u_normalMatrix": ("mat3", "identity3"),
    **{name: ("mat4", "identity4") for name in _MATRICES},
    "u_SH": ("vec3[9]", "none"),
    "u_cubeMap": ("samplerCube", "sky 0"),
    "u_scene": ("sampler2D", "none"),
    # Bonzomatic
    "fGlobalTime": ("float", "time"),
    "fFrameTime": ("float", "delta"),
    "v2Resolution": ("vec2", "resolution"),
    **{name: ("sampler1D", "fft 0") for name in ("texFFT", "texFFTSmoothed", "texFFTIntegrated")},
    "texChecker": ("sampler2D", "picture 0"),
    "texNoise": ("sampler2D", "noise 0"),
    **{f"texTex{n}": ("sampler2D", f"picture {n}") for n in range(1, 5)},
    # KodeLife and glslsandbox
    "mouse": ("vec2", "hover_share"),
    "spectrum": ("vec3", "bands"),
    **{f"texture{n}": ("sampler2D", f"picture {n}") for n in range(4)},
    **{name: ("sampler2D", "none") for name in _BEFORE},
}

NAMES: Names = {
    **{
        name: (_TYPES[meaning], _MEANINGS.get(meaning, meaning))
        for meaning, names in PLAIN_UNIFORMS.items()
        for name in names
    },
    **shadertoy.NAMES,
    **_ELSEWHERE,
}


def _needs_dialect(source: SourceText) -> bool:
    """Return whether a text of ``#version`` 330 or more needs what a plain shader is not given.

    That is what a vertex shader gives it, and names that it declares or lacks of tools other than those
    whose names every plain shader may use.
    """
    code = source.code
    declared = uniforms(code)
    return bool(vertex_outputs(code)) or any(
        name in source.names and (name in declared or name.startswith("u_"))
        for name in _ELSEWHERE
        if name != "mouse"
    )


def _defines(source: SourceText) -> tuple[str, ...]:
    """Return glslViewer's own macros where its names occur."""
    result = ["#define GLSLVIEWER 1", "#define PLATFORM_LINUX"]
    result = result if any(name.startswith("u_") for name in source.names) else []
    tested = {name for words in directives(source) if words[0] in _CONDITIONS for name in words[1:]}
    for name, lines in _SHADOW_MAP.items():  # where a text asks for it first, it does without
        if name in source.names and name not in tested:
            result += [
                line for line in lines if line.startswith("#") or "u_lightShadowMap" not in source.names
            ]
    return (*result, "#define BACKGROUND") if "BACKGROUND" in source.names else tuple(result)


_CONDITIONS = ("if", "ifdef", "ifndef", "elif")
_SHADOW_MAP = {
    "LIGHT_SHADOWMAP": ["#define LIGHT_SHADOWMAP u_lightShadowMap", "uniform sampler2D u_lightShadowMap;"],
    "LIGHT_SHADOWMAP_SIZE": ["#define LIGHT_SHADOWMAP_SIZE 2048.0"],
}
"""What glslViewer defines for a scene: here the map is black."""

RULES = Rules("main", NAMES, declared_anywhere=True, defines=_defines)


def shaders(files: Files) -> Sequence[Shader | Made]:
    """Return the passes of a file, none where it lacks nothing that a plain shader is given."""
    whole = files.source()
    version = version_of(whole)
    defined = {} if version else WEBGL
    rules = replace(RULES, names=shadertoy.with_sampler_types(NAMES, whole))
    if shaders_of_text := shaders_of(rewritten(whole), rules, defined):
        return shaders_of_text
    macros = {**defined, **macros_of(_defines(whole))}
    source = live_source(whole, macros, unknown=None if version else False)
    if not files.named and version >= 330 and not _needs_dialect(source):
        return ()
    text = rewritten(source)
    before = dict.fromkeys(_BEFORE, ShaderChannel(target=VIEW, sampling=Sampling("linear", "clamp")))
    return (Shader(VIEW, text, rules, target=VIEW, channels=before, keeps=True),)

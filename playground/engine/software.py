"""What is done otherwise on a software renderer, which runs shaders on a processor: the same bits, sooner.

``Software.stage`` says what is known of a step that is about to run, and ``specialise`` writes that into its
stages; no line and no column of the kernel's own changes, so that complaints of the driver stay in their
places. What llvmpipe gains by:

* constants: it goes both ways of every ``if``, so checkboxes, menus and what is wired are compiled in.
* nearest texels: a sampler that gives the nearest texel, and 0 outside, is quicker than ``texelFetch``.
* own size: where all inputs are as large as the pass, ``textureSize`` is a uniform.
* interpolated place: ``gl_FragCoord`` is upside down in a texture, and put right by two uniforms that are
  read for each eight texels: of a pass that fetches four texels a seventh. The vertex shader says the place
  instead; between two vertices it is rounded by far less than the half texel to the next.
* fixed texels: one fetched at a place written as numbers, ``texelFetch(daylight, ivec2(5, 0), 0)``, is read
  back once and becomes a uniform.
* costly rest: a kernel says ``if (skips_rest()) return …;`` between what is cheap and what is not. It is
  drawn up to there, marking the texels that are done in a depth buffer, then whole where the depth test
  lets it.
* buffers as textures: a buffer is loaded a float at a time, a texture a vec4: half of the time.
* filling: with a logic operation enabled, whose default is to copy, a text is compiled once, not a second
  time for tiles whose old texels need not be loaded: half of what a save waits for.
"""

from __future__ import annotations

import ctypes
import re
import sys
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from itertools import count
from typing import TYPE_CHECKING

from playground.engine.gl_calls import Calls
from playground.engine.plan import Step
from playground.engine.results import MATCHING, Result, Wired, has_unwired, wires_of
from playground.engine.results import UNWIRED as NOT_WIRED
from playground.engine.textures import make_framebuffer, release_framebuffer
from playground.engine.tuning import Choices, FirstPart, Stage, Tuning
from playground.memo import GRAPHS
from playground.shader.own_shaders import own_part, own_shader
from playground.shader.reserved_names import FETCHES, MATCHES, READ, SKIPS, UNWIRED, WIRED
from playground.shader.sampler_reads import fetched_alone, fixed_texels, read_by_texels_alone
from playground.shader.wrap import (
    FRAGMENT,
    NOTHING_SKIPPED,
    ShaderStage,
    Wrapped,
    previous_name,
    read_by_functions,
    reads_unwired,
)
from playground.sketch.model import ComputeVariant, Kernel, TexelKernel

if TYPE_CHECKING:
    import moderngl

NEAREST = "k_nearest"
"""A choice: what is read texel by texel alone is fetched by the sampler of nearest texels."""

OWN_SIZE = "k_size_here"
"""A choice: all inputs have the size of the pass. So is called what replaces textureSize, as long, then."""

PLACE = "k_place"
"""A choice: a kernel is told its texel's place by the vertex shader."""

QUICKER = NEAREST, OWN_SIZE, PLACE
"""Choices that change how a text is computed, and not what."""

FIXED = "k_fixed_"
"""What begins the choice to have an input's fixed texels as uniforms, and the name of such a uniform: x, y
and the input follow, as in k_fixed_5_0_daylight."""

_TEXELS = "k_texels_"  # begins the name of a sampler by which a buffer is read, and is the choice to read so
_FIRST_UNIT = 32  # texture unit of the first such buffer, the others' follow: beyond those of inputs
_QUICK_FETCHES = {"texelFetch": "k_texel_of", "k_fetch_in": "k_texel_in"}  # each as long as what it replaces
_GIVEN_SIZE = "uniform ivec2 size;"
_OWN_SHARE = "k_own_share"
_PLACE_FROM, _PLACE_TO = "ivec2(gl_FragCoord.xy)", "ivec2(k_place_at)"
_READ_FUNCTION = re.compile(rf"^(\w+) {READ}(\w+)\(int place\) {{ return \2\[place\]; }}$", re.MULTILINE)
_SWIZZLES = {"float": ".r", "vec2": ".rg", "vec4": ""}
_TEXTURE_BUFFER = 0x8C2A
_BUFFER_FORMATS = {"float": 0x822E, "vec2": 0x8230, "vec4": 0x8814}  # GL_R32F, GL_RG32F, GL_RGBA32F
_UINTS = (ctypes.c_uint,) * 3
_COLOR_LOGIC_OP = 0x0BF2
_MAX_READ_BACK = 2**16  # texels of an input whose fixed ones become uniforms
_MAX_DEPTHS = 2  # sizes whose depth buffers are held: of a picture and of its preview
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # glibc's M_TRIM_THRESHOLD and M_MMAP_THRESHOLD
_MAPPED = 2**23  # [bytes] from which a block goes back to the system as soon as it is freed
_KEPT = 6 * 2**23  # [bytes] of freed blocks that stay: a frame's triangles are some 30 MiB

MIPMAPS = 90.0
"""[ms] that llvmpipe takes in each process to compile what makes the first mipmaps of a format."""


class Software(Tuning):
    """What a software renderer gains by, on one context."""

    anisotropy = 1.0  # more costs a hundred times as much
    replaces_draws = True
    has_timers = False  # a draw of 275 ms reads 1 ms
    mipmap_cost = MIPMAPS
    waits = True

    def __init__(self, ctx: moderngl.Context) -> None:
        keep_freed_memory()
        self.ctx = ctx
        self.filling = Filling(ctx)
        self._call = Calls(ctx)
        self._depths: dict[tuple[int, int], moderngl.Renderbuffer] = {}  # where a kernel is done, by size
        self.buffer_textures: list[ctypes.c_uint] = []  # by number of the buffer that is read

    def release(self) -> None:
        """Release depth buffers, and the textures that are buffers, not the buffers."""
        for depth in self._depths.values():
            depth.release()
        self._depths.clear()
        for name in self.buffer_textures:
            self._call("glDeleteTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
        self.buffer_textures.clear()

    def stage(self, step: Step, inputs: Mapping[str, Wired], driver: str, *, in_loop: bool) -> Stage:
        """Return how a step runs: what is known of it is constant, and read in the quickest way."""
        kernel = step.kernel
        choices = [
            (p.name, int(step.values[p.name]))  # type: ignore[arg-type]
            for p in kernel.parameters
            if (p.type == "bool" or p.widget.kind == "menu") and p.widget.kind != "button"
        ]
        for declared in kernel.inputs:
            name, texture = declared.name, inputs.get(declared.name, NOT_WIRED).texture
            if kernel.reads(f"{WIRED}{name}"):
                choices.append((f"{WIRED}{name}", int(texture is not None)))
            if kernel.reads(f"{MATCHES}{name}"):
                choices.append((f"{MATCHES}{name}", int(texture is not None and texture.size == step.size)))
        if reads_unwired(kernel):
            choices.append((UNWIRED, int(has_unwired(kernel, inputs))))
        choices += [(name, 1) for name in _quicker(step, inputs, driver)]
        uniforms: dict[str, tuple[float, ...]] = {}
        if not in_loop:  # where each iteration would wait for what it reads back
            names = {texel.input for texel in fixed_texels(kernel.source)}
            fixed = sorted(name for name in names if _is_read_back(name, inputs))
            choices += [(f"{FIXED}{name}", 1) for name in fixed]
            uniforms = _values_of(fixed, kernel, inputs) if fixed else uniforms
        written, first = tuple(choices), None
        once = isinstance(kernel, TexelKernel) and kernel.runs_once
        if once and driver == FRAGMENT and kernel.reads(SKIPS):
            first = FirstPart((*written, (SKIPS, 1)), self._drawing_once)
        return Stage(written, uniforms, fetched_alone(kernel).inputs, first)

    @staticmethod
    def write(wrapped: Wrapped, choices: Choices, *, plainly: bool = False) -> Wrapped:
        """Return stages with what is chosen written into them: see ``Tuning.write``."""
        return specialise(wrapped, [c for c in choices if c[0] not in QUICKER] if plainly else choices)

    def texels_read(self, kernel: Kernel, inputs: Mapping[str, Wired]) -> list[float] | None:
        """Return all that a text reads of those inputs of which it reads single texels only.

        Of each texel the components that it takes. None where one of the inputs cannot be read back.
        """
        texels: list[float] = []
        names = [name for name in read_by_texels_alone(kernel.source) if name in inputs]
        names = [name for name in names if inputs[name].texture is not None]
        if not all(_is_read_back(name, inputs) for name in names):
            return None
        for texel in fixed_texels(kernel.source):
            if texel.input in names:
                values = _texel(inputs[texel.input], texel.x, texel.y, alone=True)
                texels += [values[component] for component in sorted(texel.components)]
        return texels

    # ── costly rest ──────────────────────────────────────────────────────────

    @contextmanager
    def _drawing_once(self, result: Result) -> Iterator[None]:
        """Draw to a result: first the part of a kernel that ends early, then all where that has not."""
        ctx, size = self.ctx, result.size
        depth = self._depths.pop(size, None) or ctx.depth_renderbuffer(size)
        self._depths[size] = depth
        while len(self._depths) > _MAX_DEPTHS:
            self._depths.pop(next(iter(self._depths))).release()
        textures = [result.textures[output.name] for output in result.outputs]
        target = make_framebuffer(ctx, textures, depth)
        target.use()
        target.clear(depth=1.0)
        ctx.enable(ctx.DEPTH_TEST)
        ctx.depth_func = "<"
        try:
            yield
        finally:
            ctx.disable(ctx.DEPTH_TEST)
            release_framebuffer(target)

    # ── buffers as textures ──────────────────────────────────────────────────

    @contextmanager
    def reading(self, kernel: ComputeVariant, buffers: Mapping[str, moderngl.Buffer]) -> Iterator[Choices]:
        """Bind, within the context, the buffers that a variant reads as textures, each on a unit of its own.

        None where one is longer than a texture may be. Taken off afterwards: a buffer that is released stays
        in memory while it is a texture.
        """
        read = read_by_functions(kernel)
        longest = max([buffers[b.name].size // 4 for b in read], default=0)  # in texels of a float
        if not read or longest > self.max_texels:
            yield ()
            return
        while len(self.buffer_textures) < len(read):
            self.buffer_textures.append(self._new_texture())
        for number, declared in enumerate(read):
            self._attach(number, _BUFFER_FORMATS[declared.type], buffers[declared.name].glo)
        try:
            yield ((_TEXELS, 1),)
        finally:
            for number in range(len(self.buffer_textures)):
                self._attach(number, _BUFFER_FORMATS["float"], 0)
                self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, 0)

    def _attach(self, number: int, form: int, buffer: int) -> None:
        """Bind a texture to its unit, and a buffer to it; 0 takes the buffer off."""
        self._call.activate(_FIRST_UNIT + number)
        self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, self.buffer_textures[number].value)
        self._call("glTexBuffer", _UINTS, _TEXTURE_BUFFER, form, buffer)

    @cached_property
    def max_texels(self) -> int:
        """Return how many texels a texture may have that is a buffer."""
        return int(self.ctx.info["GL_MAX_TEXTURE_BUFFER_SIZE"])

    def _new_texture(self) -> ctypes.c_uint:
        name = ctypes.c_uint()
        self._call("glGenTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
        return name


class Filling:
    """Within it, a context draws over the whole of a framebuffer.

    Blending "all of the new, nothing of the old" would do as well, but there it works out (new - old) + old,
    which is not the new.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx

    def __enter__(self) -> None:
        self.ctx.enable_direct(_COLOR_LOGIC_OP)

    def __exit__(self, *_: object) -> None:
        self.ctx.disable_direct(_COLOR_LOGIC_OP)


@GRAPHS.cached(identities=1)
def quicker_choices(kernel: Kernel) -> frozenset[str]:
    """Return which of ``QUICKER`` may be made for a kernel.

    ``OWN_SIZE`` holds where each input is as large as what the kernel makes, ``PLACE`` where the fragment
    driver draws the whole of that at once.
    """
    choices = set[str]()
    if fetched_alone(kernel).fetches or any(kernel.reads(previous_name(kernel, o)) for o in kernel.outputs):
        choices.add(NEAREST)
    if isinstance(kernel, TexelKernel) and not kernel.fills_lattice:
        choices.add(PLACE)
        # No texture but inputs may be asked for its size.
        if not kernel.file_parameters and (NEAREST in choices or kernel.reads("textureSize")):
            choices.add(OWN_SIZE)
    return frozenset(choices)


def _quicker(step: Step, inputs: Mapping[str, Wired], driver: str) -> list[str]:
    """Return which of ``QUICKER`` are made for a step."""
    quicker = quicker_choices(step.kernel)
    if quicker and (step.window is not None or step.size != step.full_size):
        quicker -= {OWN_SIZE, PLACE}
    if PLACE in quicker and driver != FRAGMENT:
        quicker -= {PLACE}
    if OWN_SIZE in quicker and not all([wire == MATCHING for wire in wires_of(step, inputs)]):
        quicker -= {OWN_SIZE}
    return sorted(quicker)


def _is_read_back(name: str, inputs: Mapping[str, Wired]) -> bool:
    """Return whether texels of an input can be read back: few texels, of floats, whose bits stay the same."""
    result, texture, _ = inputs.get(name, NOT_WIRED)
    if result is None or texture is None or result.surface is not None:
        return False
    return texture.width * texture.height <= _MAX_READ_BACK and texture.dtype in ("f2", "f4")


def _values_of(
    fixed: Sequence[str], kernel: Kernel, inputs: Mapping[str, Wired]
) -> dict[str, tuple[float, ...]]:
    """Return the values of the uniforms that are texels of some inputs."""
    alone = reads_unwired(kernel) and has_unwired(kernel, inputs)
    return {
        _fixed_name(texel.x, texel.y, texel.input): _texel(inputs[texel.input], texel.x, texel.y, alone=alone)
        for texel in fixed_texels(kernel.source)
        if texel.input in fixed
    }


def _texel(wired: Wired, x: int, y: int, *, alone: bool) -> tuple[float, ...]:
    """Return a texel of an input that can be read back.

    ``alone``: a texture of one texel has that everywhere, as where another input is unwired.
    """
    assert wired.result is not None, "only such an input is read so: see ``_is_read_back``"
    at = (0, 0) if alone and wired.result.size == (1, 1) else (x, y)
    return wired.result.texel(wired.output, *at)


# ── writing what is chosen into stages ───────────────────────────────────────


def specialise(wrapped: Wrapped, choices: Sequence[tuple[str, int]]) -> Wrapped:
    """Return stages with what is chosen written into them: see ``Software.stage``."""
    stages = {}
    quick, own_size, position = [any(choice == name for choice, _ in choices) for name in QUICKER]
    fixed = frozenset(choice.removeprefix(FIXED) for choice, _ in choices if choice.startswith(FIXED))
    for name, stage in wrapped.stages.items():
        text = stage.text
        for choice, value in choices:
            pattern = rf"^([ \t]*)uniform([ \t]+(bool|int)[ \t]+{choice}\b)[^;\n]*;"

            def constant(match: re.Match[str], value: int = value) -> str:
                literal = ("true" if value else "false") if match.group(3) == "bool" else str(value)
                return f"{match.group(1)}const  {match.group(2)} = {literal};"

            text = re.sub(pattern, constant, text, flags=re.MULTILINE)
            if choice == _TEXELS:
                text = _with_buffers_as_textures(text)
            if choice == SKIPS:
                text = text.replace(NOTHING_SKIPPED, f"bool {SKIPS}() {{ discard; return true; }}")
        stage = replace(stage, text=text)
        stage = _with_uniform_texels(stage, fixed) if fixed else stage
        stage = _with_quick_fetches(stage, wrapped.kernel, own_size=own_size) if quick else stage
        stages[name] = _with_own_size(stage) if own_size else stage
    wrapped = replace(wrapped, stages=stages)
    return _with_interpolated_place(wrapped) if position else wrapped


def _fixed_name(x: int, y: int, name: str) -> str:
    """Return the name of the uniform with one texel of an input."""
    return f"{FIXED}{x}_{y}_{name}"


def _with_uniform_texels(stage: ShaderStage, inputs: Collection[str]) -> ShaderStage:
    """Write uniforms in place of the fetches of some inputs' texels at places written as numbers.

    A software renderer fetches such a texel again for every texel that it computes, which takes it as long
    as one that differs; a uniform is there. No column changes: a fetch takes more letters than the name.
    """
    if not stage.first:
        return stage
    lines, uniforms = stage.text.split("\n"), {}
    for texel in fixed_texels(stage.source):
        index, uniform = stage.first - 1 + texel.line, _fixed_name(texel.x, texel.y, texel.input)
        own = stage.source.lines[texel.line].code[texel.start : texel.end]
        fetch = lines[index][texel.start : texel.end]
        # What a stage does not have, as the other's function, is blank.
        if texel.input in inputs and fetch in (own, own.replace("texelFetch", FETCHES["texelFetch"])):
            line = lines[index]
            lines[index] = line[: texel.start] + uniform.ljust(len(fetch)) + line[texel.end :]
            uniforms[uniform] = f"uniform vec4 {uniform};"
    if not uniforms:
        return stage
    lines[stage.first - 1 : stage.first - 1] = uniforms.values()
    return replace(stage, text="\n".join(lines), first=stage.first + len(uniforms))


def _with_own_size(stage: ShaderStage) -> ShaderStage:
    """Have a text's function ``textureSize`` give the pass's own size, which the driver knows as a uniform.

    What a text does for textures of other sizes is left out then as it is compiled.
    """
    if not stage.first:
        return stage
    lines = stage.text.split("\n")
    lines_given = [i for i in range(stage.first - 1) if lines[i] == _GIVEN_SIZE]
    for index in lines_given:  # the part declares it, before all that asks
        lines[index] = ""
    part = own_part("own_size.glsl", size=OWN_SIZE, share=_OWN_SHARE).split("\n")
    lines[1:1] = part
    return replace(stage, text="\n".join(lines), first=stage.first + len(part))


def _with_quick_fetches(stage: ShaderStage, kernel: Kernel, *, own_size: bool) -> ShaderStage:
    """Write another function in place of ``texelFetch`` where it reads what samplers give as texels."""
    if not stage.first:
        return stage
    lines, changed, own = stage.text.split("\n"), False, stage.first - 1
    for index in range(own):  # the engine's function for the iteration before, whose places are inside
        fetch = "texelFetch(k_previous_"
        changed |= fetch in lines[index]
        lines[index] = lines[index].replace(fetch, f"{_QUICK_FETCHES['texelFetch']}(k_previous_")
    used = set()
    for number, column in fetched_alone(kernel).fetches:
        line, end = lines[own + number], column + len("texelFetch")
        called = line[column:end]
        if called in _QUICK_FETCHES:  # what a stage does not have is blank, and some are uniforms by now
            lines[own + number] = line[:column] + _QUICK_FETCHES[called] + line[end:]
            used.add(called)
    if not used and not changed:
        return stage
    if FETCHES["texelFetch"] in used:
        unwired = own_part(
            "quick_fetch_unwired.glsl",
            unwired=UNWIRED,
            fetch=_QUICK_FETCHES["texelFetch"],
            fetch_unwired=_QUICK_FETCHES[FETCHES["texelFetch"]],
        )
        lines[own:own] = unwired.split("\n")
    share = _OWN_SHARE if own_size else "(1.0 / vec2(textureSize(k_input, 0)))"
    part = own_part("quick_fetch.glsl", fetch=_QUICK_FETCHES["texelFetch"], share=share)
    lines[1:1] = part.split("\n")  # behind the version
    return replace(stage, text="\n".join(lines), first=stage.first + len(lines) - stage.text.count("\n") - 1)


def _with_interpolated_place(wrapped: Wrapped) -> Wrapped:
    """Have the vertex shader say the texel's place, of a pass whose target has the size ``size``."""
    fragment = wrapped.stages["fragment"]
    version, rest = fragment.text.split("\n", 1)
    before, _, after = rest.rpartition(_PLACE_FROM)  # behind the kernel's own lines
    text = f"{version}\nnoperspective in vec2 k_place_at;\n{before}{_PLACE_TO}{after}"
    stages = {
        "vertex": replace(wrapped.stages["vertex"], text=own_shader("triangle_with_place.vert")),
        "fragment": replace(fragment, text=text, first=fragment.first + 1),
    }
    return replace(wrapped, stages=stages)


def _with_buffers_as_textures(text: str) -> str:
    """Have the functions that read buffers read textures, which changes no line."""
    units = count(_FIRST_UNIT)

    def by_sampler(match: re.Match[str]) -> str:
        kind, name = match.groups()
        sampler = f"layout(binding = {next(units)}) uniform samplerBuffer {_TEXELS}{name};"
        fetch = f"texelFetch({_TEXELS}{name}, place){_SWIZZLES[kind]}"
        return f"{sampler} {kind} {READ}{name}(int place) {{ return {fetch}; }}"

    return _READ_FUNCTION.sub(by_sampler, text)


def keep_freed_memory() -> None:
    """Let the C library keep what it frees, up to 48 MiB of blocks below 8 MiB each.

    llvmpipe allocates the triangles of each frame and frees them. Given back to the system, their pages
    are made again in the next frame: 7 of 69 ms of a draw of 133,000 triangles. glibc only.
    """
    if not sys.platform.startswith("linux"):
        return
    setter = getattr(ctypes.CDLL(None), "mallopt", None)
    if setter is not None:
        setter(_MMAP_THRESHOLD, _MAPPED)
        setter(_TRIM_THRESHOLD, _KEPT)

"""What is done otherwise on a software renderer, which runs shaders on a processor: the same bits, sooner.

``Software.choices`` says what is known of a step that is about to run, and ``specialise`` writes that into
its stages; no line and no column of the kernel's own changes, so that complaints of the driver stay in their
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
from bisect import bisect_right
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import count
from typing import TYPE_CHECKING

from playground.engine.gl_calls import Calls, surround
from playground.engine.plan import Step
from playground.engine.results import UNWIRED as NOT_WIRED
from playground.engine.results import Result, Wired, are_of_own_size, has_unwired
from playground.engine.textures import make_framebuffer, release_framebuffer
from playground.memo import GRAPHS, TEXTS
from playground.shader.outline import Declared, outline
from playground.shader.own_shaders import own_part, own_shader
from playground.shader.reserved_names import FETCHES, MATCHES, READ, SKIPS, UNWIRED, WIRED
from playground.shader.source import SourceText
from playground.shader.wrap import (
    FRAGMENT,
    NOTHING_SKIPPED,
    ShaderStage,
    Wrapped,
    previous_name,
    read_by_functions,
    reads_unwired,
)
from playground.sketch.model import ComputeVariant, Input, Kernel, PlainShader, TexelKernel

if TYPE_CHECKING:
    import moderngl

Fixed = tuple[str, str, int, int]
"""A uniform that is a texel of an input: its name, the input, the place."""

FIRST_PART = SKIPS, 1
"""The choice of the part of a kernel that ends before its costly rest."""

Choices = tuple[tuple[str, int], ...]
"""What is written into a text: checkboxes and menus with their values, and the choices below."""

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
_FIXED_NAME = re.compile(rf"{FIXED}(\d+)_(\d+)_(\w+)")
_PLACE_FROM, _PLACE_TO = "ivec2(gl_FragCoord.xy)", "ivec2(k_place_at)"
_READ_FUNCTION = re.compile(rf"^(\w+) {READ}(\w+)\(int place\) {{ return \2\[place\]; }}$", re.MULTILINE)
_SWIZZLES = {"float": ".r", "vec2": ".rg", "vec4": ""}
_TEXTURE_BUFFER = 0x8C2A
_BUFFER_FORMATS = {"float": 0x822E, "vec2": 0x8230, "vec4": 0x8814}  # GL_R32F, GL_RG32F, GL_RGBA32F
_UINTS = (ctypes.c_uint,) * 3
_COLOR_LOGIC_OP = 0x0BF2
_MAX_READ_BACK = 2**16  # texels of an input whose fixed ones become uniforms
_MAX_DEPTHS = 2  # sizes whose depth buffers are held: of a picture and of its preview

_DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\\n|\\[^\n])*", re.MULTILINE)  # and its further lines
_NAME = re.compile(r"[A-Za-z_]\w*")
_CALLED = re.compile(r"([A-Za-z_]\w*)\s*\Z")
_BRACKETS = re.compile(r"[()\[\],]")
_OPENS = re.compile(r"\s*\(")
_ASKED = frozenset({"texelFetch", "textureSize"})  # functions of GLSL, whose first argument is a sampler
_OF_GLSL = re.compile(r"texture|texel|shadow")  # its functions that take samplers begin so
_SAMPLER = re.compile(r"\bsampler2D\s+([A-Za-z_]\w*)")
_DECLARED = re.compile(r"\bsampler2D\s+\Z")
_UNIFORM = re.compile(r"\buniform\s+(?:(?:highp|mediump|lowp)\s+)?sampler2D\s+[A-Za-z_]\w*\s*;")
_SAMPLERS = re.compile(r"\bsampler2D\b")
_FETCH = re.compile(
    r"\btexelFetch[ \t]*\([ \t]*([A-Za-z_]\w*)[ \t]*,[ \t]*"
    r"ivec2[ \t]*\([ \t]*(\d{1,4})[ \t]*(?:,[ \t]*(\d{1,4})[ \t]*)?\)[ \t]*,[ \t]*0[ \t]*\)"
)
_COMPONENTS = re.compile(r"[ \t]*\.[ \t]*([xyzw]{1,4}|[rgba]{1,4}|[stpq]{1,4})\b")
_DECLARES = re.compile(r"\bsampler2D[ \t]+$")


class Software:
    """What a software renderer needs on one context."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.filling = Filling(ctx)
        self._call = Calls(ctx)
        self._nearest: moderngl.Sampler | None = None  # gives texels, and 0 around them
        self._depths: dict[tuple[int, int], moderngl.Renderbuffer] = {}  # where a kernel is done, by size
        self._textures: list[ctypes.c_uint] = []  # that are buffers, by number of the buffer that is read

    def release(self) -> None:
        """Release sampler, depth buffers, and the textures that are buffers, not the buffers."""
        if self._nearest is not None:
            self._nearest.release()
            self._nearest = None
        for depth in self._depths.values():
            depth.release()
        self._depths.clear()
        for name in self._textures:
            self._call("glDeleteTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
        self._textures.clear()

    def choices(
        self, step: Step, inputs: Mapping[str, Wired], driver: str, *, in_loop: bool
    ) -> list[tuple[str, int]]:
        """Return what is known of a step that is about to run, and how it is quickest."""
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
        if not in_loop:  # where each iteration would wait for what it reads back
            names = {texel.input for texel in fixed_texels(kernel.source)}
            choices += [(f"{FIXED}{name}", 1) for name in sorted(names) if _is_read_back(name, inputs)]
        return choices

    def sampler_of(
        self, kernel: Kernel, declared: Input, made: Callable[[], None]
    ) -> moderngl.Sampler | None:
        """Return the sampler of an input that is read by ``texelFetch`` alone; None for any other.

        ``made`` is called after a sampler was made, which may have taken the place of that of unit 0.
        """
        if declared.name not in fetched_alone(kernel).inputs:
            return None
        if self._nearest is None:
            self._nearest = self.ctx.sampler(repeat_x=False, repeat_y=False)
            self._nearest.filter = self.ctx.NEAREST, self.ctx.NEAREST
            surround(self.ctx, self._nearest)
            made()
        return self._nearest

    def values_of(
        self, fixed: Sequence[Fixed], kernel: Kernel, inputs: Mapping[str, Wired]
    ) -> dict[str, tuple[float, ...]]:
        """Return the values of uniforms that are texels of inputs."""
        values = {}
        unwired = reads_unwired(kernel) and has_unwired(kernel, inputs)
        for uniform, name, x, y in fixed:
            result, _, output = inputs[name]
            assert result is not None, "only such an input is written so: see ``_is_read_back``"
            if unwired and result.size == (1, 1):  # where one input is unwired, so is each of one texel
                x = y = 0
            values[uniform] = result.texel(output, x, y)
        return values

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
                result, _, output = inputs[texel.input]
                assert result is not None, "it can be read back"
                # With another input unwired, one of a single texel gives that at every place.
                at = (0, 0) if result.size == (1, 1) else (texel.x, texel.y)
                values = result.texel(output, *at)
                texels += [values[component] for component in sorted(texel.components)]
        return texels

    # ── costly rest ──────────────────────────────────────────────────────────

    def runs_in_parts(self, kernel: Kernel) -> bool:
        """Return whether a kernel says where its costly rest begins; one that repeats has none."""
        return isinstance(kernel, TexelKernel) and kernel.runs_once and kernel.reads(SKIPS)

    @contextmanager
    def drawing_once(self, result: Result) -> Iterator[None]:
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

    def begin_reading(self, kernel: ComputeVariant, buffers: Mapping[str, moderngl.Buffer]) -> Choices:
        """Bind the buffers that a variant reads as textures, each on a unit of its own; return the choice.

        None where one is longer than a texture may be. ``end_reading`` takes them off.
        """
        result = read_by_functions(kernel)
        longest = max([buffers[b.name].size // 4 for b in result], default=0)  # in texels of a float
        if not result or longest > self.max_texels:
            return ()
        while len(self._textures) < len(result):
            self._textures.append(self._new_texture())
        for number, declared in enumerate(result):
            self._call.activate(_FIRST_UNIT + number)
            self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, self._textures[number].value)
            form, buffer = _BUFFER_FORMATS[declared.type], buffers[declared.name].glo
            self._call("glTexBuffer", _UINTS, _TEXTURE_BUFFER, form, buffer)
        return ((_TEXELS, 1),)

    def end_reading(self) -> None:
        """Take the buffers off: one that is released stays in memory while it is a texture."""
        for number, texture in enumerate(self._textures):
            self._call.activate(_FIRST_UNIT + number)
            self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, texture.value)
            self._call("glTexBuffer", _UINTS, _TEXTURE_BUFFER, _BUFFER_FORMATS["float"], 0)
            self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, 0)

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
    if quicker and (step.window is not None or step.size != step.whole_size):
        quicker -= {OWN_SIZE, PLACE}
    if PLACE in quicker and driver != FRAGMENT:
        quicker -= {PLACE}
    if OWN_SIZE in quicker and not are_of_own_size(step, inputs):
        quicker -= {OWN_SIZE}
    return sorted(quicker)


def _is_read_back(name: str, inputs: Mapping[str, Wired]) -> bool:
    """Return whether texels of an input can be read back: few texels, of floats, whose bits stay the same."""
    result, texture, _ = inputs.get(name, NOT_WIRED)
    if result is None or texture is None or result.surface is not None:
        return False
    return texture.width * texture.height <= _MAX_READ_BACK and texture.dtype in ("f2", "f4")


# ── writing what is chosen into stages ───────────────────────────────────────


def specialise(wrapped: Wrapped, choices: Sequence[tuple[str, int]]) -> Wrapped:
    """Return stages with what is chosen written into them: see ``Software.choices``."""
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


def fixed_texel(uniform: str) -> tuple[str, int, int] | None:
    """Return the input and the place, x and y, of the texel that a uniform is; None for any other."""
    match = _FIXED_NAME.fullmatch(uniform)
    return (match[3], int(match[1]), int(match[2])) if match else None


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


# ── reading what a text does with its textures ───────────────────────────────


def _without_directives(code: str) -> str:
    """Return a text as long as this one, with spaces in place of its directives."""
    return _DIRECTIVE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), code)


def _arguments_of(signature: str) -> list[str]:
    """Return the names of a function's arguments; "" for one without."""
    inside = signature[signature.index("(") + 1 : signature.rindex(")")]
    return [(_NAME.findall(part) or [""])[-1] for part in inside.split(",")]


def _given_to(code: str, at: int) -> list[str]:
    """Return the arguments of the call whose bracket opens at a place, or behind white space there."""
    opens = _OPENS.match(code, at)
    if opens is None:
        return []
    names, depth, start = [], 1, opens.end()
    for mark in _BRACKETS.finditer(code, opens.end()):
        if mark.group() in "([":
            depth += 1
        elif mark.group() in ")]":
            depth -= 1
        if depth == 0 or (depth == 1 and mark.group() == ","):
            names.append(code[start : mark.start()].strip())
            start = mark.end()
        if depth == 0:
            return names
    return []


def _call_around(code: str, at: int) -> tuple[str, int, int] | None:
    """Return of the call that has an argument at a place its name, which argument it is, and its bracket.

    None where no bracket of a call is open there.
    """
    depth, index, opens = 0, 0, at - 1
    while opens >= 0 and not (depth == 0 and code[opens] in "(;{"):
        mark = code[opens]
        depth += (mark in ")]") - (mark in "([")
        index += mark == "," and depth == 0
        opens -= 1
    called = _CALLED.search(code, max(opens - 80, 0), max(opens, 0))
    return (called[1], index, opens) if called and opens >= 0 and code[opens] == "(" else None


_Sampler = tuple[str, int]  # a function and which of its arguments; of a uniform its name and -1


@dataclass(frozen=True, slots=True)
class FetchedAlone:
    """What of a text reads inputs by ``texelFetch`` alone."""

    inputs: frozenset[str] = frozenset()
    fetches: tuple[tuple[int, int], ...] = ()  # of level 0, of these inputs: line and column, both from 0


def fetched_alone(kernel: Kernel) -> FetchedAlone:
    """Return what of a kernel reads inputs by ``texelFetch`` alone; nothing of a plain shader.

    How a sampler filters and what it gives outside of its texture count for none of these inputs. A function
    that is handed samplers reads one of these inputs if it is handed nothing else, by any call. What a macro
    writes is not read: what it might mean counts as another use.
    """
    if isinstance(kernel, PlainShader):
        return FetchedAlone()
    return _fetched_alone(kernel.source, tuple([declared.name for declared in kernel.inputs]))


@TEXTS.cached()
def _fetched_alone(source: SourceText, inputs: tuple[str, ...]) -> FetchedAlone:
    if "texelFetch" not in source.names or not inputs:
        return FetchedAlone()
    text = _Uses(source.code)
    if text.is_unclear:
        return FetchedAlone()
    free = _reaching(text.handed_by, [*text.used_otherwise, *text.uniforms_but(inputs)])
    # A function that may be handed another sampler too fetches as it did.
    mixed = _reaching(text.handed_to, free)
    alone = frozenset([name for name in inputs if (name, -1) in text.samplers and (name, -1) not in free])
    reached = _reaching(text.handed_to, [(name, -1) for name in alone])
    places = [at for at, sampler in text.fetches if sampler in reached and sampler not in mixed]
    lines = [0, *(match.end() for match in re.finditer("\n", source.code))]
    result = []
    for at in sorted(places):
        line = bisect_right(lines, at) - 1
        result.append((line, at - lines[line]))
    return FetchedAlone(alone, tuple(result))


class _Uses:
    """What a text does with its samplers."""

    def __init__(self, code: str) -> None:
        self._code = _without_directives(code)
        of_macros = " ".join(match.group() for match in _DIRECTIVE.finditer(code))
        self._functions = [
            item for item in outline(code) if item.kind == "function" and "(" in item.signature
        ]
        self._starts = [function.start for function in self._functions]
        self._names = [_arguments_of(function.signature) for function in self._functions]
        self._takes: dict[str, set[int]] = defaultdict(set)  # which arguments of a function are samplers
        for function in self._functions:
            inside = function.signature[function.signature.index("(") :].split(",")
            self._takes[function.name] |= {i for i, part in enumerate(inside) if _SAMPLER.search(part)}
        self.samplers: set[_Sampler] = set()
        self.used_otherwise: set[_Sampler] = set()
        self.handed_to: dict[_Sampler, set[_Sampler]] = defaultdict(set)
        self.handed_by: dict[_Sampler, set[_Sampler]] = defaultdict(set)
        self.fetches: list[tuple[int, _Sampler]] = []
        names = set(_SAMPLER.findall(self._code))
        self._in_macros = in_macros = set(re.findall(r"[A-Za-z_]\w*", of_macros))
        takers = {name for name, taken in self._takes.items() if taken}
        # Each sampler that the text declares is a uniform, or an argument of a function that is known.
        declared_samplers = sum(len(_SAMPLER.findall(function.signature)) for function in self._functions)
        declared_samplers += len(_UNIFORM.findall(self._code))
        self.is_unclear = bool(
            declared_samplers != len(_SAMPLERS.findall(self._code))
            or in_macros & {"sampler2D", *_ASKED, *names, *takers}
            or _ASKED & self._takes.keys()
        )
        if names and not self.is_unclear:
            for match in re.finditer(rf"\b(?:{'|'.join(sorted(names))})\b", self._code):
                self._look(match.group(), match.start())

    def uniforms_but(self, names: Collection[str]) -> Iterator[_Sampler]:
        """Yield the uniform samplers that have other names than these."""
        yield from (sampler for sampler in self.samplers if sampler[1] < 0 and sampler[0] not in names)

    def _look(self, name: str, at: int) -> None:
        """Note what one naming of a sampler does."""
        sampler = self._meant(name, at)
        called = _call_around(self._code, at)
        function, index, opens = called or ("", 0, at)
        if _DECLARED.search(self._code, max(at - 40, 0), at):
            self.samplers.add(sampler)
        elif function in _ASKED and index == 0:
            self.samplers.add(sampler)
            if function == "texelFetch" and _given_to(self._code, opens)[2:] != ["0"]:
                self.used_otherwise.add(sampler)
            elif function == "texelFetch":
                self.fetches.append((self._code.rindex("texelFetch", 0, opens), sampler))
        elif index in self._takes.get(function, ()):
            # Of several functions of a name the text does not say which: the sampler may come to each.
            self.samplers.add(sampler)
            self.handed_to[sampler].add((function, index))
            self.handed_by[function, index].add(sampler)
        elif (
            (index == 0 and _OF_GLSL.match(function))
            or function in self._in_macros
            or (not function and self._is_in_brackets(name, at))
        ):
            self.samplers.add(sampler)
            self.used_otherwise.add(sampler)
        # Anything else is a variable of that name: a sampler can only be handed on.

    def _is_in_brackets(self, name: str, at: int) -> bool:
        """Return whether a name has brackets of its own, within which it is still a sampler."""
        before, after = self._code[:at].rstrip(), self._code[at + len(name) :].lstrip()
        return before.endswith("(") and after.startswith(")")

    def _meant(self, name: str, at: int) -> _Sampler:
        """Return what a name means in some place: an argument of the function around, or a uniform."""
        before = bisect_right(self._starts, at) - 1
        if before >= 0 and at < self._functions[before].end and name in self._names[before]:
            return self._functions[before].name, self._names[before].index(name)
        return name, -1


def _reaching(steps: dict[_Sampler, set[_Sampler]], starts: Collection[_Sampler]) -> set[_Sampler]:
    """Return what is reached from some samplers by steps, themselves included."""
    samplers, left = set(starts), list(starts)
    while left:
        for step in steps.get(left.pop(), ()):
            if step not in samplers:
                samplers.add(step)
                left.append(step)
    return samplers


@dataclass(frozen=True, slots=True)
class FixedTexel:
    """One fetch of a text: which texel of which input, and where the text has it."""

    input: str
    x: int  # [texels]
    y: int  # [texels]
    line: int  # of the text, from 0
    start: int  # column, from 0
    end: int  # behind it
    components: frozenset[int] = frozenset(range(4))  # what the text takes of it


@TEXTS.cached()
def fixed_texels(source: SourceText) -> tuple[FixedTexel, ...]:
    """Return the fetches of a flattened text at a place written as numbers, in its order.

    A function may fetch from a sampler that it is handed: then every call, up the chain of calls, must hand
    it the input of that name, else the text does not say which texture is read. What a macro writes is left
    alone.
    """
    if "texelFetch" not in source.names:
        return ()
    matches = [(match.start(), match) for match in _FETCH.finditer(source.code)]
    if not matches:
        return ()
    text = _Text(source.code)
    texels = []
    for at, match in matches:
        if not text.reads_uniform(match[1], at):
            continue
        line_start = source.code.rfind("\n", 0, at) + 1
        line, x = source.code.count("\n", 0, at), int(match[2])
        y = x if match[3] is None else int(match[3])
        taken = _COMPONENTS.match(source.code, match.end())
        components = frozenset(_index(letter) for letter in (taken[1] if taken else "xyzw"))
        start, end = at - line_start, match.end() - line_start
        texels.append(FixedTexel(match[1], x, y, line, start, end, components))
    return tuple(texels)


@TEXTS.cached()
def read_by_texels_alone(source: SourceText) -> frozenset[str]:
    """Return the samplers of which a flattened text reads nothing but what ``fixed_texels`` finds."""
    starts: dict[str, set[int]] = {}
    lines = [0, *(match.end() for match in re.finditer("\n", source.code))]
    for texel in fixed_texels(source):
        starts.setdefault(texel.input, set()).add(lines[texel.line] + texel.start)
    if not starts:
        return frozenset()
    text = _Text(source.code)
    return frozenset([name for name, offset in starts.items() if text.has_no_other_use(name, offset)])


def _index(component: str) -> int:
    return next(names.index(component) for names in ("xyzw", "rgba", "stpq") if component in names)


class _Text:
    """The functions of a text, and what their samplers stand for."""

    def __init__(self, code: str) -> None:
        directives = list(_DIRECTIVE.finditer(code))
        self.directives = [match.span() for match in directives]
        self.code = _without_directives(code)
        self.of_macros = " ".join([match.group() for match in directives])
        self.functions: list[Declared] = [
            function for function in outline(code) if function.kind == "function"
        ]

    def reads_uniform(self, sampler: str, at: int, seen: frozenset[str] = frozenset()) -> bool:
        """Return whether a name in some place stands for the uniform of that name, and for nothing else."""
        if any(start <= at < end for start, end in self.directives):
            return False
        if re.search(rf"\bdefine[ \t]+(?:{sampler}|texelFetch|ivec2)\b", self.of_macros):
            return False
        around = next(
            (
                function
                for function in self.functions
                if function.body >= 0 and function.start <= at < function.end
            ),
            None,
        )
        if around is None:
            return False
        arguments = _arguments_of(around.signature)
        if sampler not in arguments:
            return True
        if around.name in seen:
            return True  # a recursion, which is judged where it is entered
        alike = [
            function for function in self.functions if function.name == around.name and function.body >= 0
        ]
        if len(alike) > 1 or re.search(rf"\b{around.name}\b", self.of_macros):
            return False
        return self._is_handed(around, arguments.index(sampler), sampler, seen | {around.name})

    def has_no_other_use(self, sampler: str, fetches: Collection[int]) -> bool:
        """Return whether a name is only declared, fetched from at these places, and handed on as itself."""
        name = re.compile(rf"\b{sampler}\b")
        if name.search(self.of_macros):
            return False
        for match in name.finditer(self.code):
            before = self.code[: match.start()]
            opens = before.rfind("(")
            if opens >= 0 and re.search(r"\btexelFetch[ \t]*$", before[:opens]):
                fetch = before.rfind("texelFetch")
                if fetch not in fetches or before[opens + 1 :].strip():
                    return False
            elif not _DECLARES.search(before) and not self._is_handed_on(match.start(), sampler):
                return False
        return True

    def _is_handed_on(self, at: int, sampler: str) -> bool:
        """Return whether a name in some place is an argument of a function that calls it so too."""
        call = _call_around(self.code, at)
        if call is None:
            return False
        name, index, opens = call
        alike = [function for function in self.functions if function.name == name]
        arguments = _given_to(self.code, opens) if alike else []
        if len(arguments) <= index or arguments[index] != sampler:
            return False
        parameters = [_arguments_of(function.signature) for function in alike]
        return all(len(arguments) > index and arguments[index] == sampler for arguments in parameters)

    def _is_handed(self, function: Declared, index: int, sampler: str, seen: frozenset[str]) -> bool:
        """Return whether each call hands a function the uniform of a name as its argument of that index."""
        declared = {item.at for item in self.functions if item.name == function.name}
        for call in re.finditer(rf"\b{function.name}\b", self.code):
            if call.start() in declared:
                continue
            arguments = _given_to(self.code, call.end())
            if len(arguments) <= index or arguments[index] != sampler:
                return False
            if not self.reads_uniform(sampler, call.start(), seen):
                return False
        return True

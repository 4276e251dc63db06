"""Write one pass as GLSL that every format can take: its declarations, and the statements that run it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from playground.engine.camera import unit_vector
from playground.publish.export_formats import COLOUR
from playground.publish.shader_export.declarations import (
    Declaration,
    declaration_of,
    declarations_of,
    number,
    vector,
)
from playground.publish.shader_export.passes import ExportPlan, ShaderPass, Wire
from playground.shader.parameter import AS_IT_IS, Sampling
from playground.shader.reserved_names import MATCHES, TOWARDS, WIRED
from playground.shader.wrap import previous_name
from playground.sketch.model import Kernel, Output, Parameter, Value

_READS = frozenset("texelFetch texelFetchOffset textureLod textureSize texture".split())
_FALLBACKS = {"white": "vec4(1.0)", "black": "vec4(0.0, 0.0, 0.0, 1.0)"}
_BYTES = ("r8", "rg8", "rgba8")
CONSTANT = "constant_"
ENCODE, DECODE = "srgb_of_linear", "linear_of_srgb"
_ENCODE_TEXT = (
    f"vec3 {ENCODE}(vec3 light) {{ vec3 c = clamp(light, 0.0, 1.0);"
    " return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)); }"
)
_DECODE_TEXT = (
    f"vec3 {DECODE}(vec3 c) {{"
    " return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }"
)
ENCODING = declaration_of(_ENCODE_TEXT, ENCODE)
DECODING = declaration_of(_DECODE_TEXT, DECODE)


@dataclass(frozen=True)
class Sampled:
    """A texture that a pass reads."""

    word: str  # as its text calls it
    source: str  # the pass that gives it, or the file parameter's pass
    sampling: Sampling = AS_IT_IS
    is_before: bool = False  # as it was in the frame before


@dataclass(frozen=True)
class PassText:
    """One pass as text."""

    name: str
    size: tuple[int | None, int | None]
    declarations: tuple[Declaration, ...]
    reads: tuple[Sampled, ...]
    statements: tuple[str, ...]  # before the result
    result: str  # an expression, a vec4
    is_bytes: bool = False  # its texels have 8 bits a channel
    title: str = ""


@dataclass(frozen=True)
class Host:
    """What a format gives a pass."""

    size: str  # an ivec2, of the pass's target
    texel: str  # an ivec2
    time: str  # seconds, a float
    frame: str  # its number, an int from 0
    pixel: str  # the pixel's middle, a vec2
    parameter: Callable[[ShaderPass, Parameter, Value], tuple[tuple[Declaration, ...], tuple[str, ...]]]
    file: Callable[[ShaderPass, Parameter, Value], str]  # returns the pass that gives a file's texels
    native: frozenset[tuple[str, str]] = frozenset()  # names that it gives by themselves, and their types
    mouse: str = ""  # a vec4 as Shadertoy has it; "" where there is none


def text_of(leaving: ExportPlan, pass_: ShaderPass, host: Host, sizes: Mapping[str, object]) -> PassText:
    """Return a pass's text; ``sizes`` are those of the passes so far, by name."""
    kernel, step = pass_.step.kernel, pass_.step
    if pass_.copies.name:
        return _copy(pass_, host)
    arguments, statements = _given(leaving, pass_, host)
    reads: list[Sampled] = []
    unwired: dict[str, str] = {}
    starting: dict[str, str] = {}
    for declared, wire in pass_.inputs:
        source = wire.name
        if source:
            reads.append(Sampled(declared.name, source, declared.sampling, wire.is_before))
            if wire.first:
                starting[declared.name] = f"{declared.name}_at_first"
                reads.append(Sampled(starting[declared.name], wire.first, declared.sampling))
        else:
            unwired[declared.name] = _FALLBACKS.get(declared.fallback, "vec4(0.0)")
        if kernel.reads(f"{WIRED}{declared.name}"):
            arguments.append(_constant("bool", f"{WIRED}{declared.name}", "true" if source else "false"))
        if kernel.reads(f"{MATCHES}{declared.name}"):
            matches = "true" if source and sizes[source] == pass_.size else "false"
            arguments.append(_constant("bool", f"{MATCHES}{declared.name}", matches))
    for parameter in kernel.parameters:
        value = step.values[parameter.name]
        if parameter.widget.kind == "file":
            reads.append(Sampled(parameter.name, host.file(pass_, parameter, value), parameter.sampling))
            continue
        own, setting = host.parameter(pass_, parameter, value)
        arguments += own
        statements += setting
    for output, wire in pass_.previous:
        arguments.append(_previous(kernel, output, wire, host))
        if wire.name:
            reads.append(Sampled(f"{output.name}_before", wire.name, is_before=wire.is_before))
        if wire.first:
            reads.append(Sampled(f"{output.name}_at_first", wire.first))
    declarations = [without_unwired(d, unwired) for d in declarations_of(kernel.source.lines)]
    declarations = [_with_start(d, starting, host.frame) for d in declarations]
    for name in unwired:
        if any(d.reads(name) for d in declarations):
            reads.append(_instead(pass_, name, reads))
    lines, value = _call(kernel, pass_.output, host.texel)
    result = _filled(pass_.output, value)
    if pass_.shows:
        result, more = _shown(pass_.output, value, pass_.shows)
        arguments += more
    return PassText(
        name=pass_.name,
        size=pass_.size,
        declarations=(*arguments, *declarations),
        reads=tuple(reads),
        statements=(*statements, *lines),
        result=result,
        is_bytes=pass_.output.format in _BYTES,
        title=kernel.title,
    )


def _instead(pass_: ShaderPass, name: str, reads: Sequence[Sampled]) -> Sampled:
    """Return what an unwired input reads that a function is handed: a pass of its constant.

    Where the text asks first whether anything is wired, it is never read, and any texture will do.
    """
    if pass_.step.kernel.reads(f"{WIRED}{name}") and reads:
        return Sampled(name, reads[0].source, reads[0].sampling)
    declared = next(declared for declared, _ in pass_.inputs if declared.name == name)
    return Sampled(name, f"{CONSTANT}{declared.fallback}", declared.sampling)


def constants_of(texts: Sequence[PassText]) -> list[PassText]:
    """Return the passes of the constants that some passes read."""
    names = dict.fromkeys(read.source for text in texts for read in text.reads)
    constants = [name for name in names if name.startswith(CONSTANT)]
    title = "an input to which nothing is wired"
    return [
        PassText(
            name,
            (None, None),
            (),
            (),
            (),
            _FALLBACKS.get(name.removeprefix(CONSTANT), "vec4(0.0)"),
            True,
            title,
        )
        for name in constants
    ]


def handed_on(text: PassText, word: str) -> bool:
    """Return whether a text does more with a texture than to fetch single texels of it."""
    return any(use.function != "texelFetch" for each in text.declarations for use in each.uses(word))


def is_sampled(text: PassText, word: str) -> bool:
    """Return whether a text may sample a texture between its texels, itself or in a function it calls."""
    samplers = {"textureLod", "texture"}
    while True:
        more = {n for d in text.declarations if any(map(d.reads, samplers)) for n in d.names} - samplers
        if not more:
            break
        samplers |= more
    return any(use.function in samplers for each in text.declarations for use in each.uses(word))


def with_size_of(text: PassText, word: str, size: str) -> PassText:
    """Return a text in which the size of a texture that it reads is written as a constant."""

    def fixed(function: str, before: str, behind: str) -> str:
        return size if function == "textureSize" else f"{before}{word}{behind}"

    return replace(text, declarations=tuple(each.with_calls(word, fixed) for each in text.declarations))


def variable_of(kind: str, name: str) -> Declaration:
    """Return a global variable, which a pass sets before its function reads it."""
    return declaration_of(f"{kind} {name} = {kind}(0);", name)  # without the 0 a driver warns


def _constant(kind: str, name: str, value: str, comment: str = "") -> Declaration:
    return declaration_of(f"const {kind} {name} = {value};" + (f"  // {comment}" if comment else ""), name)


def _given(leaving: ExportPlan, argument: ShaderPass, host: Host) -> tuple[list[Declaration], list[str]]:
    """Return what stands for the names that the engine gives a kernel, and what sets them."""
    kernel, terrain = argument.step.kernel, leaving.plan.terrain
    assert terrain.extent is not None and terrain.relief is not None  # a plan's terrain is known
    declarations: list[Declaration] = []
    statements: list[str] = []

    def variable(kind: str, name: str, value: str) -> None:
        declarations.append(variable_of(kind, name))
        statements.append(f"{name} = {value};")

    reads_spacing = kernel.reads("spacing")
    if kernel.reads("size") or reads_spacing or argument.previous:
        variable("ivec2", "size", size_of(argument.size, host))
    free = leaving.follows and leaving.sketch.terrain.extent is None and argument.size == (None, None)
    if (kernel.reads("extent") or reads_spacing) and free:
        wide = number(terrain.extent[0])
        ratio = "float(size.y - 1) / float(max(size.x - 1, 1))"
        if not statements:
            variable("ivec2", "size", host.size)
        variable("vec2", "extent", f"{wide} * vec2(1.0, {ratio})")
    elif kernel.reads("extent") or reads_spacing:
        declarations.append(_constant("vec2", "extent", vector(terrain.extent), "metres, east and north"))
    if reads_spacing:
        variable("vec2", "spacing", "extent / vec2(max(size - 1, ivec2(1)))")
    if kernel.reads("relief"):
        declarations.append(_constant("float", "relief", number(terrain.relief), "metres from height 0 to 1"))
    if kernel.reads("base_elevation"):
        base = number(terrain.base_elevation or 0.0)
        declarations.append(_constant("float", "base_elevation", base, "metres above sea level at height 0"))
    if kernel.reads("time"):
        variable("float", "time", f"float({host.frame}) / 60.0" if argument.by_frames else host.time)
    counts: dict[str, int | str]
    counts = {"iteration": argument.iteration, "iterations": argument.iterations, "until": argument.until}
    if argument.by_frames:
        counts = {"iteration": host.frame, "iterations": f"{host.frame} + 1", "until": f"{host.frame} + 1"}
    for name, count in counts.items():
        if kernel.reads(name):
            variable("int", name, str(count))
    return declarations, statements


def size_of(size: tuple[int | None, int | None], host: Host) -> str:
    """Return a pass's size as an ivec2; ``host.size`` is that of a pass as large as the picture."""
    if size == (None, None):
        return host.size
    sides = [str(side) if side else f"{host.size}.{axis}" for side, axis in zip(size, "xy", strict=True)]
    return f"ivec2({', '.join(sides)})"


def towards(name: str, direction: tuple[float, ...]) -> Declaration:
    """Return the unit vector towards a direction, as a constant."""
    return _constant("vec3", f"{TOWARDS}{name}", vector(unit_vector(direction)))


def _copy(pass_: ShaderPass, host: Host) -> PassText:
    """Return a pass that holds what another gave in the frame before."""
    reads = [Sampled("texels", pass_.copies.name, is_before=True)]
    result = f"texelFetch(texels, {host.texel}, 0)"
    if pass_.copies.first:
        reads.append(Sampled("texels_at_first", pass_.copies.first))
        result = f"{host.frame} == 0 ? texelFetch(texels_at_first, {host.texel}, 0) : {result}"
    is_bytes = pass_.output.format in _BYTES
    title = f"{pass_.copies.name} as it was in the frame before"
    return PassText(pass_.name, pass_.size, (), tuple(reads), (), result, is_bytes, title)


def _with_start(declaration: Declaration, starting: Mapping[str, str], frame: str) -> Declaration:
    """Return a declaration that reads a texture's start in the first frame."""
    for name, start in starting.items():

        def either(function: str, before: str, behind: str, name: str = name, start: str = start) -> str:
            call = f"{before}{name}{behind}"
            if function != "texelFetch":
                return call
            return f"({frame} == 0 ? {before}{start}{behind} : {call})"

        declaration = declaration.with_calls(name, either)
    return declaration


def _previous(kernel: Kernel, output: Output, wire: Wire, host: Host) -> Declaration:
    name, kind = previous_name(kernel, output), output.glsl
    head = f"{kind} {name}(ivec2 texel) {{"
    if not wire.name:
        return declaration_of(f"{head} return {kind}(0.0); }}  // there is no step before", name)
    swizzle = {1: ".r", 2: ".rg", 4: ""}[output.components]
    texel = "clamp(texel, ivec2(0), size - 1)"
    fetch = f"texelFetch({output.name}_before, {texel}, 0){swizzle}"
    if wire.first:
        fetch = f"{host.frame} == 0 ? texelFetch({output.name}_at_first, {texel}, 0){swizzle} : {fetch}"
    return declaration_of(f"{head} return {fetch}; }}", name)


def _call(kernel: Kernel, output: Output, texel: str) -> tuple[list[str], str]:
    if len(kernel.outputs) == 1:
        return [], f"kernel({texel})"
    lines = [f"{o.glsl} {o.name}_out;" for o in kernel.outputs]
    names = ", ".join(f"{o.name}_out" for o in kernel.outputs)
    return [*lines, f"kernel({texel}, {names});"], f"{output.name}_out"


def _filled(output: Output, value: str) -> str:
    return {1: f"vec4({value}, 0.0, 0.0, 1.0)", 2: f"vec4({value}, 0.0, 1.0)", 4: value}[output.components]


def _shown(output: Output, value: str, kind: str) -> tuple[str, tuple[Declaration, ...]]:
    """Return a texture's texel as a picture: a number in grey, colours encoded as sRGB."""
    three = {1: f"vec3({value})", 2: f"vec3({value}, 0.0)", 4: f"({value}).rgb"}[output.components]
    if kind == COLOUR:
        return f"vec4({ENCODE}({three}), 1.0)", (ENCODING,)
    return f"vec4({three}, 1.0)", ()


def shown_text(text: PassText, components: int, kind: str, host: Host) -> PassText:
    """Return a pass that shows a texture of any size over the whole picture, nearest texel."""
    output = Output("shown", {1: "r32f", 2: "rg32f", 4: "rgba32f"}[components])
    swizzle = {1: ".r", 2: ".rg", 4: ""}[components]
    texel = f"{host.texel} * {size_of(text.size, host)} / {host.size}"
    result, more = _shown(output, f"texelFetch(shown, {texel}, 0){swizzle}", kind)
    return PassText("picture", (None, None), more, (Sampled("shown", text.name),), (), result)


def without_unwired(declaration: Declaration, unwired: Mapping[str, str]) -> Declaration:
    """Return a declaration in which what an unwired input is read by is a constant."""
    for name, value in unwired.items():

        def constant(function: str, before: str, behind: str, name: str = name, value: str = value) -> str:
            if function not in _READS:
                return f"{before}{name}{behind}"
            return "ivec2(1)" if function == "textureSize" else value

        declaration = declaration.with_calls(name, constant)
    return declaration

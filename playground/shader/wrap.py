"""Wrap a kernel's text for a driver: the fragment driver (GL 3.3 up) or the compute driver (GL 4.3 up).

Both drivers get the same lines; only what is before and after them differs, as the recipe of
each stage says (see ``stage_recipe``). Each wrapped stage remembers where the kernel's own lines
begin, so that a driver's log can be given back its file and line.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from playground.errors import ShaderError
from playground.shader.kernel import (
    DRIVERS,
    Buffer,
    ComputeVariant,
    Draw,
    ForeignShader,
    Kernel,
    Output,
    PlainCompute,
    PlainFragment,
    TexelKernel,
    VertexShader,
)
from playground.shader.outline import outline
from playground.shader.own_shaders import TRIANGLE, own_part
from playground.shader.reserved_names import (
    FETCHES,
    GIVEN,
    MATCHES,
    PART,
    READ,
    SKIPS,
    TOWARDS,
    UNWIRED,
    WINDOW,
    WIRED,
    ZOOM,
)
from playground.shader.source import Line, SourceText
from playground.shader.stage_recipe import SIGNATURE, VERSION_NUMBER, Recipe, StagePart, version_line
from playground.shader.syntax.nodes import Function
from playground.shader.syntax.symbols import symbols_of
from playground.shader.syntax.tokens import as_written

_, FRAGMENT, COMPUTE = DRIVERS
LOCAL = 8
"""Side of a compute driver's work group, in texels."""

CORNER = "k_corner"
"""What a vertex shader is handed where its version has no numbers of vertices: a vec2 in clip space."""

NOTHING_SKIPPED = f"bool {SKIPS}() {{ return false; }}"
"""What a kernel calls where none of it is skipped."""
_READABLE = ("float", "vec2", "vec4")  # types of the buffers that functions read


@dataclass(frozen=True)
class ShaderStage:
    """The text of one shader stage."""

    text: str
    first: int  # line of the text, from 1, of the kernel's first line; 0: it has none
    source: SourceText
    expected: str  # the signatures that the kernel's file should have, for errors outside its lines

    def locate(self, line: int) -> Line | None:
        """Return the kernel's line that a line of the text came from, if it did."""
        index = line - self.first
        return self.source.lines[index] if self.first and 0 <= index < len(self.source.lines) else None


@dataclass(frozen=True)
class Wrapped:
    """What a driver compiles."""

    kernel: Kernel
    driver: str  # fragment | compute | draw
    stages: dict[str, ShaderStage]  # vertex and fragment, or compute


def wrap(kernel: Kernel, driver: str, version_code: int = 330) -> Wrapped:
    """Wrap a kernel, a draw, a compute variant or a plain shader.

    ``version_code`` is the context's: of another tool's shader that names none it is the text's version.
    Raises ``ShaderError`` where the file's functions do not have the signatures its header asks for.
    """
    runs_by, recipes = recipes_of(kernel, driver, version_code)
    return Wrapped(kernel, runs_by, {name: _made(recipe) for name, recipe in recipes.items()})


def recipes_of(kernel: Kernel, driver: str, version_code: int = 330) -> tuple[str, dict[str, Recipe]]:
    """Return what runs a kernel (fragment, compute or draw), and the recipe of each stage."""
    match kernel:
        case Draw():
            return "draw", _draw(kernel)
        case ComputeVariant():
            return COMPUTE, {"compute": _variant(kernel)}
        case ForeignShader():
            return FRAGMENT, _foreign(kernel, version_code)
        case PlainFragment():
            version = version_line(kernel.source)
            assert version is not None  # or it would be no plain shader
            return FRAGMENT, {"vertex": _quad(kernel, version.code.strip()), "fragment": _unwrapped(kernel)}
        case PlainCompute():
            return COMPUTE, {"compute": _unwrapped(kernel)}
    assert isinstance(kernel, TexelKernel)  # a source has no text to run
    _check_signature(kernel)
    if driver == COMPUTE:
        return COMPUTE, {"compute": _compute(kernel)}
    return FRAGMENT, {"vertex": _quad(kernel), "fragment": _fragment(kernel)}


def _made(recipe: Recipe) -> ShaderStage:
    text, first = recipe.make()
    return ShaderStage(text, first, recipe.source, recipe.expected)


def wrap_library(kernel: Kernel, driver: str) -> Wrapped:
    """Wrap a library file, which has nothing to run, so that it can be compiled alone.

    A function that it declares for who includes it to define gets a body.
    """
    bodies = _missing_bodies(kernel.source.code)
    if driver == COMPUTE:
        before = ["#version 430", "layout(local_size_x = 1) in;"]
        after = [*bodies, "void main() {}"]
        return Wrapped(kernel, COMPUTE, {"compute": _made(_recipe(kernel, before, after, ""))})
    after = [*bodies, "out vec4 k_out;", "void main() { k_out = vec4(0.0); }"]
    stage = _made(_recipe(kernel, ["#version 330"], after, ""))
    return Wrapped(kernel, FRAGMENT, {"vertex": _made(_quad(kernel)), "fragment": stage})


def _missing_bodies(code: str) -> list[str]:
    """Return a definition of each function that a text declares and does not define."""
    tree = symbols_of(code).tree
    functions = [node for node in tree.declarations if isinstance(node, Function)]
    defined = {node.name for node in functions if node.body is not None}
    bodies = []
    for node in functions:
        if node.name not in defined:
            kind = tree.source(node.type)
            body = "" if kind == "void" else f"{kind} k_any; return k_any;"
            bodies.append(f"{tree.source(node).removesuffix(';')} {{ {body} }}")
    return bodies


def signature(kernel: Kernel) -> str:
    """Return the signature that a kernel's function must have."""
    if len(kernel.outputs) == 1:
        return f"{kernel.outputs[0].glsl} kernel(ivec2 texel)"
    return f"void kernel(ivec2 texel, {', '.join(f'out {o.glsl} {o.name}' for o in kernel.outputs)})"


def previous_name(kernel: Kernel, output: Output) -> str:
    """Return the name of the function that reads an output's texel of the iteration before."""
    return "previous" if len(kernel.outputs) == 1 else f"previous_{output.name}"


def _quad(kernel: Kernel, version: str = "#version 330") -> Recipe:
    """Return the vertex shader that covers the picture, in the version of the fragment shader.

    Versions differ in their words, and those of OpenGL ES link with their own kind only.
    """
    number = VERSION_NUMBER.match(version)
    is_old = number is not None and int(number.group(1)) < 130
    text = own_part("triangle_from_buffer.vert", corner=CORNER) if is_old else TRIANGLE
    return Recipe(kernel.source, text=text.replace("#version 330", version))


def _unwrapped(kernel: Kernel) -> Recipe:
    """Return a plain shader as it is."""
    return Recipe(kernel.source, keeps_version=True, expected="void main()")


def _foreign(kernel: ForeignShader, version_code: int) -> dict[str, Recipe]:
    """Wrap another tool's shader: its own version or the context's, what its tool declares, its lines."""
    own = version_line(kernel.source)
    version = own.code.strip() if own else f"#version {400 if version_code >= 400 else 330}"
    begins = (version, "#extension GL_ARB_shading_language_420pack : enable")
    before = [*begins, *kernel.prelude, f"uniform ivec2 {WINDOW};", *map(own_part, kernel.helpers)]
    after = f"{own_part(kernel.epilogue, window=WINDOW)}\n" if kernel.epilogue else ""
    extensions = [line for line in kernel.prelude if line.startswith("#extension")]
    if isinstance(kernel.vertex, VertexShader):
        vertex = _own_vertex(kernel.vertex, begins)
    else:
        triangle = own_part(
            "triangle_with_outputs.vert",
            version="\n".join([version, *extensions]),
            shares=PART,
            declarations="\n".join(declaration for declaration, _ in kernel.vertex),
            statements="\n    ".join(statements for _, statements in kernel.vertex),
        )
        vertex = Recipe(kernel.source, text=triangle + "\n")
    expected = "void mainImage(out vec4, in vec2)" if kernel.epilogue else "void main()"
    if "mainCubemap" in kernel.source.names and "cubemap" in kernel.epilogue:
        expected = "void mainCubemap(out vec4, in vec2, in vec3, in vec3)"
    fragment = Recipe(kernel.source, tuple(map(StagePart, before)), after, expected=expected)
    return {"vertex": vertex, "fragment": fragment}


def _own_vertex(vertex: VertexShader, begins: Sequence[str]) -> Recipe:
    """Return the vertex stage of another tool's shader whose author wrote one."""
    before = [*begins, *vertex.prelude]
    before += [own_part(part, shares=PART) for part in vertex.helpers]
    return Recipe(vertex.source, tuple(map(StagePart, before)), expected="void main()")


def reads_unwired(kernel: Kernel) -> bool:
    """Return whether a kernel fetches texels while some input of it may stay unwired."""
    return any(i.fallback for i in kernel.inputs) and any(map(kernel.reads, FETCHES))


def _recipe(
    kernel: Kernel, before: Sequence[str | StagePart], after: Sequence[str], expected: str, without: str = ""
) -> Recipe:
    """Return the recipe of a kernel's stage; where an input may stay unwired, fetches ask for that."""
    parts = [part if isinstance(part, StagePart) else StagePart(part) for part in before]
    replaced: tuple[tuple[str, str], ...] = ()
    if any(declared.fallback for declared in kernel.inputs):
        fetch, offset = FETCHES.values()
        text = own_part("fetch_unwired.glsl", unwired=UNWIRED, fetch=fetch, fetch_offset=offset)
        parts.append(StagePart(text, tuple(FETCHES)))
        replaced = tuple(FETCHES.items())
    return Recipe(
        kernel.source,
        tuple(parts),
        "\n".join(after) + "\n",
        without=without,
        replaced=replaced,
        expected=expected,
    )


def _given(kernel: Kernel, always: tuple[str, ...] = ()) -> list[StagePart]:
    """Return the declarations of what the engine gives: each where the text names it, or ``always``."""
    names = [(kind, name) for name, (kind, _) in GIVEN.items()]
    names += [("bool", f"{begins}{i.name}") for i in kernel.inputs for begins in (WIRED, MATCHES)]
    names += [("vec3", f"{TOWARDS}{p.name}") for p in kernel.parameters if p.widget.kind == "direction"]
    names.append(("ivec2", WINDOW))
    parts = [StagePart(f"uniform {kind} {name};", () if name in always else (name,)) for kind, name in names]
    return [*parts, StagePart(NOTHING_SKIPPED, (SKIPS,))]


def _fragment(kernel: TexelKernel) -> Recipe:
    lattice = kernel.fills_lattice
    before: list[str | StagePart] = ["#version 330", *_given(kernel, ("size",) if lattice else ())]
    if lattice:
        before.append("uniform int k_shift, k_previous_shift;")
    before += [_previous(kernel, output, "strided" if lattice else "sampler") for output in kernel.outputs]
    after = [f"layout(location = {i}) out {o.glsl} k_out_{o.name};" for i, o in enumerate(kernel.outputs)]
    shift = " << k_shift" if lattice else ""
    after.append(own_part("main_fragment.glsl", shift=shift, call=_call(kernel)))
    return _recipe(kernel, before, after, signature(kernel))


def _previous(kernel: Kernel, output: Output, where: str) -> StagePart:
    """Return the function that reads an output's texel of the iteration before, and what it reads."""
    name = previous_name(kernel, output)
    swizzle = {1: ".r", 2: ".rg", 4: ""}[output.components]
    part = f"previous_{where}.glsl"
    text = own_part(part, swizzle=swizzle, output=output.name, type=output.glsl, previous=name)
    return StagePart(text, (name,))


def _call(kernel: Kernel) -> str:
    """Return the call of a kernel's function for ``k_texel``."""
    names = [f"k_out_{output.name}" for output in kernel.outputs]
    return f"{names[0]} = kernel(k_texel);" if len(names) == 1 else f"kernel(k_texel, {', '.join(names)});"


def _compute(kernel: TexelKernel) -> Recipe:
    before: list[str | StagePart] = [
        "#version 430",
        f"layout(local_size_x = {LOCAL}, local_size_y = {LOCAL}) in;",
    ]
    before += _given(kernel, ("size",))
    in_place = bool(kernel.visits)
    if in_place:
        before.append("uniform ivec2 k_cells;")
    for unit, output in enumerate(kernel.outputs):
        reads = kernel.reads(previous_name(kernel, output))
        access = "" if in_place and reads else "writeonly "
        before.append(
            f"layout({output.format}, binding = {unit}) uniform {access}image2D k_image_{output.name};"
        )
        before.append(_previous(kernel, output, "image" if in_place else "sampler"))
    lines = [f"{o.glsl} k_out_{o.name};" for o in kernel.outputs]
    lines.append(_call(kernel))
    lines += [f"imageStore(k_image_{o.name}, k_texel, k_filled(k_out_{o.name}));" for o in kernel.outputs]
    main = "main_compute_in_place.glsl" if in_place else "main_compute.glsl"
    after = [own_part(main, call="\n    ".join(lines))]
    return _recipe(kernel, before, after, signature(kernel))


def _variant(kernel: ComputeVariant) -> Recipe:
    before: list[str | StagePart] = [
        "#version 430",
        "#define COMPUTE_STAGE",
        f"layout(local_size_x = {kernel.local[0]}, local_size_y = {kernel.local[1]}) in;",
    ]
    before += _given(kernel)
    for unit, output in enumerate(kernel.outputs):
        if kernel.storage.of_output(output.name) is None:
            before.append(f"layout({output.format}, binding = {unit}) uniform image2D out_{output.name};")
    for unit, buffer in enumerate(kernel.storage.buffers):
        block = f"buffer k_buffer_{buffer.name} {{ {buffer.type} {buffer.name}[]; }};"
        before.append(f"layout(std430, binding = {unit}) {block}")
    before += [
        StagePart(f"{buffer.type} {READ}{buffer.name}(int place) {{ return {buffer.name}[place]; }}")
        for buffer in read_by_functions(kernel)
    ]
    return _recipe(kernel, before, [], "void main()")


def read_by_functions(kernel: ComputeVariant) -> list[Buffer]:
    """Return the buffers that a compute variant reads by ``read_NAME(place)``, unless it has its own."""
    buffers = kernel.storage.buffers
    result = [b for b in buffers if b.type in _READABLE and kernel.reads(f"{READ}{b.name}")]
    own = {item.name for item in outline(kernel.source.code)} if result else set()
    return [buffer for buffer in result if f"{READ}{buffer.name}" not in own]


def _draw(kernel: Draw) -> dict[str, Recipe]:
    vertex = _function(kernel, "vertex", "vec4 vertex(vec3 corner, out vec3 position)")
    fragment = _function(kernel, "fragment", "vec4 fragment(vec3 position)")
    several = kernel.outputs if len(kernel.outputs) > 1 else ()
    if several:
        fragment = _without_outputs(kernel, fragment)
    varyings = {name: kind for way, kind, name in vertex if way == "out"}
    attributes = [(kind, name) for way, kind, name in vertex if way != "out"]
    for _, kind, name in fragment:
        if varyings.get(name) != kind:
            line = _line_of(kernel, "fragment")
            outputs = ", ".join(f"{k} {n}" for n, k in varyings.items()) or "nothing"
            raise line.error(f"fragment takes {kind} {name}, which vertex does not give; it gives {outputs}")
    expected = "vec4 vertex(…) and vec4 fragment(…)"
    # Draws of one mesh by several programs must agree to the last bit where depths are equal.
    before: list[str | StagePart] = ["#version 330", "#define VERTEX_STAGE", "invariant gl_Position;"]
    before += _given(kernel)
    after = [f"in {kind} k_in_{name};" for kind, name in attributes]
    after += [f"{_flat(kind)}out {kind} k_to_{name};" for name, kind in varyings.items()]
    arguments = [f"k_to_{name}" if way == "out" else f"k_in_{name}" for way, _, name in vertex]
    zoom = f"gl_Position.xy = gl_Position.xy * {ZOOM}.xy + gl_Position.w * {ZOOM}.zw;"
    main = own_part(
        "main_vertex.glsl", arguments=", ".join(arguments), zoom=zoom if kernel.reads(ZOOM) else ""
    )
    after.append(main)
    first = _recipe(kernel, before, after, expected, without="fragment")
    before = ["#version 330", "#define FRAGMENT_STAGE", *_given(kernel)]
    after = [f"{_flat(kind)}in {kind} k_to_{name};" for name, kind in varyings.items()]
    names = [f"k_out_{output.name}" for output in several] or ["k_out"]
    after += [f"layout(location = {unit}) out vec4 {name};" for unit, name in enumerate(names)]
    read = ", ".join([f"k_to_{name}" for _, _, name in fragment] + (names if several else []))
    call = f"fragment({read});" if several else f"k_out = fragment({read});"
    after.append(own_part("main_draw.glsl", call=call))
    second = _recipe(kernel, before, after, expected, without="vertex")
    return {"vertex": first, "fragment": second}


def _flat(kind: str) -> str:
    return "flat " if kind in ("int", "uint") or kind.startswith(("ivec", "uvec")) else ""


def _function(kernel: Kernel, name: str, example: str) -> list[tuple[str, str, str]]:
    """Return (in | out, type, name) of each argument of a draw's function."""
    match = re.search(SIGNATURE.format(name=name), kernel.source.code)
    several = name == "fragment" and len(kernel.outputs) > 1
    if match and several and match.group(1) != "void":
        raise _line_of(kernel, name).error(f"fragment must be {_fragment_signature(kernel)}")
    if not match or match.group(1) != ("void" if several else "vec4"):
        raise _unsigned(kernel, f"a draw needs a function {example}")
    arguments = [_argument(part) for part in match.group(2).split(",") if part.strip()]
    for (way, kind, called), part in zip(arguments, match.group(2).split(","), strict=False):
        if not called or way == "inout" or not kind.isidentifier():
            message = f"cannot read the argument '{part.strip()}' of {name}; expected {example}"
            raise _line_of(kernel, name).error(message)
    return arguments


def _fragment_signature(kernel: Kernel) -> str:
    """Return the signature of the fragment function of a draw with several outputs."""
    return f"void fragment(…, {', '.join(f'out vec4 {output.name}' for output in kernel.outputs)})"


def _without_outputs(kernel: Kernel, arguments: list[tuple[str, str, str]]) -> list[tuple[str, str, str]]:
    """Return the arguments of a fragment function that are not outputs; refuse other outputs than wanted."""
    first = len(arguments) - len(kernel.outputs)
    outputs = [("out", "vec4", output.name) for output in kernel.outputs]
    if arguments[max(first, 0) :] != outputs or any(way == "out" for way, _, _ in arguments[:first]):
        message = (
            f"fragment must be {_fragment_signature(kernel)}: its outputs last, in the order of the pragma"
        )
        raise _line_of(kernel, "fragment").error(message)
    return arguments[:first]


def _line_of(kernel: Kernel, name: str) -> Line:
    return kernel.source.line_naming(name, called=True) or kernel.source.lines[0]


def _check_signature(kernel: TexelKernel) -> None:
    code = kernel.source.code
    match = re.search(SIGNATURE.format(name="kernel"), code)
    if not match:
        raise _unsigned(kernel, f"there is no function {signature(kernel)}")
    single = len(kernel.outputs) == 1
    arguments = [_argument(part) for part in match.group(2).split(",")]
    expected = [("in", "ivec2")] if single else [("in", "ivec2"), *(("out", o.glsl) for o in kernel.outputs)]
    result = kernel.outputs[0].glsl if single else "void"
    if match.group(1) != result or [(way, kind) for way, kind, _ in arguments] != expected:
        raise _unsigned(kernel, f"kernel must be {signature(kernel)}", match.start(1))
    names = [name for _, _, name in arguments[1:]]
    if not single and names != [o.name for o in kernel.outputs]:
        message = f"kernel must be {signature(kernel)}: its outputs in the order of the pragma"
        raise _unsigned(kernel, message, match.start(1))
    if kernel.visits and not re.search(r"\bivec2\s+visit\s*\(\s*(?:const\s+)?(?:in\s+)?ivec2\b", code):
        raise _unsigned(kernel, "a kernel with visits needs a function ivec2 visit(ivec2 cell)")
    _check_previous(kernel)


def _argument(text: str) -> tuple[str, str, str]:
    """Return (in | out | inout, type, name) of a function's argument; "" for what is not there."""
    words = [w for w in text.split() if w not in ("const", "highp", "mediump", "lowp")]
    way = words.pop(0) if words and words[0] in ("in", "out", "inout") else "in"
    kind, name, more = (*words, "", "", "")[:3]
    return way, kind if not more else text.strip(), name


def _check_previous(kernel: Kernel) -> None:
    """Refuse what reads an iteration before where there is none, or by a name that no output has."""
    names = [previous_name(kernel, output) for output in kernel.outputs]
    possible = {"previous", *(f"previous_{output.name}" for output in kernel.outputs)}
    for line in kernel.source.lines:
        tokens = list(as_written(line.code)) if "previous" in line.code else []
        for token, after in pairwise(tokens):
            called = token.text if after.text == "(" else ""
            if called in names and kernel.repeat == "1":
                message = f"{called} is the iteration before, but the kernel has one only; give it a repeat"
                raise line.error(message, token.start + 1)
            if called not in names and called in possible:
                message = f"the iteration before is read by {' and '.join(names)}, not {called}"
                raise line.error(message, token.start + 1)


def _unsigned(kernel: Kernel, message: str, position: int = -1) -> ShaderError:
    if position < 0:
        pragma = next((line for line in kernel.source.lines if line.pragma), None)
        return (pragma or kernel.source.lines[0]).error(message)
    code = kernel.source.code
    number = code.count("\n", 0, position)
    return kernel.source.lines[number].error(message, position - (code.rfind("\n", 0, position) + 1) + 1)

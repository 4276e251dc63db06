"""Read a kernel's header from its text: its pragma, and with ``uniforms`` what it declares."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import replace

from playground.errors import nearest
from playground.sketch import expressions
from playground.sketch.agreement import read_agreement
from playground.sketch.allowed_files import SHADERS
from playground.sketch.annotation import arguments
from playground.sketch.expressions import ExpressionError
from playground.sketch.model import Buffer, Kernel, Output
from playground.sketch.reserved_names import DRIVER_BOUND, OF_THE_TERRAIN, PLAIN_UNIFORMS
from playground.sketch.source import Line, SourceText
from playground.sketch.uniforms import check_name, is_given, read_uniforms

FORMATS: tuple[str, ...] = tuple(f"{c}{d}" for c in ("r", "rg", "rgba") for d in ("8", "16", "16f", "32f"))

_PRAGMA = re.compile(r"#\s*pragma\s+(\w+)\s*(.*)", re.DOTALL)
_OTHER_PRAGMA = re.compile(r"\s*#\s*pragma\s+(\w+)\s*\(")
_DEFINE = re.compile(r"^\s*#\s*define\s+(\w+)")
_UNIFORM = re.compile(r"uniform\b[^;]*;$")
_VERSION = re.compile(r"^\s*#\s*version\b")
_MAIN = re.compile(r"\bvoid\s+main\s*\(")
_OWN_NAME = re.compile(rf"^\S+(?:{'|'.join(map(re.escape, SHADERS))})\s*(?:--|—|–|:)\s*")
_LONGEST_TITLE = 72
_BETWEEN = ("squares", "triangles")
_BLENDS = ("none", "alpha", "add")
_DEPTHS = ("less", "equal", "none")
_STEPS = ("visits", "stride", "between", "at_once", "until")
_IMAGE = re.compile(
    r"layout\s*\(([^)]*)\)\s*(?:(?:writeonly|readonly|restrict|coherent|volatile)\s+)*"
    r"uniform\s+(?:\w+\s+)*image2D\s+(\w+)"
)
PRAGMAS: dict[str, tuple[str, ...]] = {
    "kernel": (
        *("where", "output", "repeat", "accepts", "visits", "stride", "between", "at_once", "until"),
        "warns",
    ),
    "source": ("name", "output", "reads"),
    "draw": (
        *("where", "mesh", "count", "instances", "output", "blend", "depth", "over", "samples", "repeat"),
    ),
    "compute": (
        *("where", "accepts", "groups", "local", "buffers", "repeat", "stages", "overwrites", "aligned"),
        *("in_place", "active", "agrees"),
    ),
}
"""Kind of a pragma → its options."""
# The options that may use the names of where.
_EXPRESSIONS = ("groups", "buffers", "repeat", "count", "instances", "visits", "stride", "at_once")
_EXAMPLES = {
    "kernel": '(output = "height:r32f")',
    "source": '("elevation_file", output = "height:r32f")',
    "draw": '(mesh = "grid")',
    "compute": '(groups = "size.y, 1", agrees = "exact")',
}
_SIZE = ("size.x", "size.y")
_SOURCE_READS = ("time", "keys", "microphone", "camera", *OF_THE_TERRAIN)
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?![\w.]|\s*:)")
_NOT_IN_WHERE = ("size", "if", "else", "and", "or", "not", "log2", "min", "max", "abs", "floor", "ceil")
CHOICES: dict[str, tuple[str, ...]] = {
    "blend": _BLENDS,
    "depth": _DEPTHS,
    "between": _BETWEEN,
    "until": ("unchanged",),
    "reads": _SOURCE_READS,
    "samples": ("0", "1"),
    "aligned": ("4", "8", "16", "32"),
}
"""Option of a pragma → what it may be, where that is one of a few."""
_BUFFER_TYPES = "float int uint vec2 vec4 ivec2 ivec4 uvec2 uvec4".split()


def parse_kernel(name: str, source: SourceText) -> Kernel | None:
    """Return what a GLSL file declares; None for a library file, which declares nothing to run.

    Raises ``ShaderError`` naming file and line for each mistake in the header.
    """
    outermost = [line for line in source.lines if not line.chain]
    found = [line for line in outermost if line.pragma]
    versions = [line for line in outermost if _VERSION.match(line.code)]
    if versions and not found:
        return _plain(name, source, versions[0])
    _refuse_misspelt(outermost)
    if not found:
        return None
    if versions:
        raise versions[0].error(
            "a kernel has no #version of its own; only a plain shader, without #pragma, has one"
        )
    if len(found) > 1:
        raise found[1].error("a second #pragma; a file is one kernel, one source or one draw")
    line = found[0]
    match = _PRAGMA.match(line.pragma)
    assert match is not None  # or source.py would not have taken it for a pragma
    kind = match.group(1)
    options = _options(kind, match.group(2), line)
    _refuse_redefined(source)
    parameters, inputs = read_uniforms(source)
    kernel = Kernel(name, kind, source, (), parameters, inputs, title=title_of(source))
    if "where" in options:
        options = _with_names_replaced(options, kernel, line)
    if kind == "compute":
        return _compute(kernel, options, line)
    text = options.get("output", "frame:rgba16f" if kind == "draw" else "")
    if not text:
        raise line.error(f'#pragma {kind} needs output = "name:format", as output = "height:r32f"')
    kernel = replace(kernel, outputs=_outputs(text, line))
    for output in kernel.outputs:
        if parameter := kernel.parameter(output.name):
            place = next(x for x in source.lines if (x.file, x.number) == (parameter.file, parameter.line))
            raise place.error(f"'{output.name}' is both an output and a parameter")
    if kind == "source":
        if not options.get("name"):
            raise line.error(f"#pragma source needs its name, as #pragma source{_EXAMPLES[kind]}")
        _refuse_code(source)
        return replace(kernel, registry=options["name"], depends=_depends(options.get("reads", ""), line))
    numbers = _numbers(kernel)
    repeat = options.get("repeat", "1")
    _check("repeat", repeat, (*_SIZE, *expressions.CLOCKS, *numbers), line)
    if expressions.counts_frames(repeat) and "frames" in numbers:
        raise line.error(f"repeat '{repeat}': 'frames' {expressions.TWO_FRAMES}")
    if kind == "draw":
        return _draw(kernel, options, line)
    _refuse_driver_bound(source)
    texts = {key: options[key] for key in (*_STEPS, "accepts") if key in options}
    warns = _warns(options.get("warns", ""), numbers, line)
    kernel = replace(kernel, repeat=repeat, warns=warns, **texts)  # type: ignore[arg-type]
    _check_steps(kernel, numbers, line)
    _check_accepts(kernel.accepts, line)
    return kernel


def _depends(text: str, line: Line) -> tuple[str, ...]:
    """Return what a source depends on besides its parameters."""
    found = tuple(filter(None, (part.strip() for part in text.split(","))))
    for name in found:
        if name not in _SOURCE_READS:
            hint = nearest(name, _SOURCE_READS)
            raise line.error(f"reads = '{text}': a source cannot read '{name}'{hint}")
    return found


def _warns(text: str, numbers: Collection[str], line: Line) -> tuple[tuple[str, str], ...]:
    """Return conditions of the parameters, and what is warned of where one holds."""
    found: list[tuple[str, str]] = []
    for part in filter(None, (part.strip() for part in text.split(";"))):
        condition, colon, message = (piece.strip() for piece in part.partition(":"))
        if not colon or not message:
            example = "frequency <= tiles: no detail is left (several are separated by ;)"
            raise line.error(f"warns '{part}': expected condition: message, as {example}")
        _check("warns", condition, (*_SIZE, *numbers), line)
        found.append((condition, " ".join(message.split())))
    return tuple(found)


def _check_accepts(accepts: str, line: Line) -> None:
    try:
        if accepts:
            expressions.accepted_sizes(accepts)
    except ExpressionError as error:
        raise line.error(f'accepts: {error}; as accepts = "2**n + 1"') from None


def _check_steps(kernel: Kernel, numbers: Collection[str], line: Line) -> None:
    """Check how a kernel's steps run: which texels they visit, how far apart those are, how many at once."""
    known = (*_SIZE, "iteration", "iterations", *numbers)
    if kernel.visits:
        _check("visits", kernel.visits, known, line, count=2)
    if kernel.stride:
        _check("stride", kernel.stride, known, line)
        if not kernel.visits:
            raise line.error("stride says how far apart the texels of visits lie; give the kernel visits")
    if kernel.between:
        if kernel.between not in _BETWEEN:
            raise line.error(f"between = '{kernel.between}'{nearest(kernel.between, _BETWEEN)}")
        if not kernel.stride:
            raise line.error("between says how the texels of a stride are joined; give the kernel a stride")
    if kernel.until:
        _check_until(kernel, line)
    if kernel.at_once == "1":
        return
    _check("at_once", kernel.at_once, (*_SIZE, *numbers), line)
    if kernel.visits:
        raise line.error("at_once and visits: a kernel has one or the other")
    if kernel.repeat == "1":
        raise line.error("at_once counts steps, but the kernel has one step only; give it a repeat")
    if not kernel.reads("until"):
        raise line.error(
            "at_once: the kernel must do the steps from iteration up to until, but never names until"
        )


def _check_until(kernel: Kernel, line: Line) -> None:
    """Check that what a kernel does of a state is the same at every step: then an unchanged one stays."""
    if kernel.until != "unchanged":
        raise line.error(f"until = '{kernel.until}'{nearest(kernel.until, ('unchanged',))}")
    if kernel.repeat == "1":
        raise line.error(
            "until says when a repeat may end, but the kernel has one step only; give it a repeat"
        )
    if kernel.visits or kernel.at_once != "1":
        name = "visits" if kernel.visits else "at_once"
        raise line.error(f"until and {name}: a kernel has one or the other")
    for name in ("iteration", "iterations", "until", "time"):
        if kernel.reads(name):
            raise line.error(
                f"until: the text names '{name}', so after a step that changes nothing another may"
            )


def title_of(source: SourceText) -> str:
    """Return the sentence that a file begins with, without its own name, as a heading."""
    for line in source.lines:
        if line.chain or line.pragma or _VERSION.match(line.code):
            continue
        if line.code.strip() or line.comment.startswith("!"):
            break
        text = _OWN_NAME.sub("", line.comment.strip())
        if any(letter.isalnum() for letter in text):
            return _titled(text)
    return ""


def _titled(text: str) -> str:
    """Return a sentence as a heading: no full stop, a capital, of a long one the part before its colon."""
    if len(text) > _LONGEST_TITLE:
        text = text.partition(": ")[0]
    text = text.removesuffix(".")
    # Not sRGB or iTime, which are spelt so.
    return text[:1].upper() + text[1:] if text.partition(" ")[0].islower() else text


def _plain(name: str, source: SourceText, version: Line) -> Kernel:
    is_compute = source.path.endswith(".comp") or "local_size_x" in source.names
    if not _MAIN.search(source.code):
        raise version.error("a shader with its own #version needs its own main()")
    usual = {n for names in PLAIN_UNIFORMS.values() for n in names}
    parameters, _ = read_uniforms(source, plain=True, skip=usual)
    output = Output("frame", "rgba8")
    local = (1, 1)
    if is_compute:
        image = _IMAGE.search(source.code)
        if not image:
            example = "layout(rgba8, binding = 0) uniform image2D picture;"
            raise version.error(f"a plain compute shader needs an image2D to write, as {example}")
        formats = [w.strip() for w in image.group(1).split(",") if w.strip() in FORMATS]
        if not formats:
            raise version.error(f"the image {image.group(2)} needs a format; there are: {', '.join(FORMATS)}")
        output = Output("frame", formats[0])
        sizes = [re.search(rf"local_size_{axis}\s*=\s*(\d{{1,5}})\b", source.code) for axis in "xy"]
        local = (int(sizes[0].group(1)) if sizes[0] else 1, int(sizes[1].group(1)) if sizes[1] else 1)
        if min(local) < 1:
            raise version.error("local_size_x and local_size_y should be 1 or more")
    kind = "plain_compute" if is_compute else "plain_fragment"
    return Kernel(name, kind, source, (output,), parameters, local=local, title=title_of(source))


def _draw(kernel: Kernel, options: dict[str, str], line: Line) -> Kernel:
    if not options.get("mesh"):
        raise line.error('#pragma draw needs a mesh, as mesh = "grid"')
    blend, depth = options.get("blend", "none"), options.get("depth", "less")
    for key, value, valid in (
        ("blend", blend, _BLENDS),
        ("depth", depth, _DEPTHS),
    ):
        if value not in valid:
            raise line.error(f'{key} = "{value}": expected one of {", ".join(valid)}')
    samples, count = options.get("samples", "0"), options.get("count", "")
    if samples not in ("0", "1"):
        raise line.error(f"samples = {samples}: expected 1, or 0 for as many as the view has")
    if count:
        sizes = [f"{declared.name}.{axis}" for declared in kernel.inputs for axis in _SIZE]
        _check("count", count, (*_SIZE, *_numbers(kernel), *sizes), line)
    instances = options.get("instances", "")
    if instances:
        texels = [f"{declared.name}.{component}" for declared in kernel.inputs for component in "xyzw"]
        _check("instances", instances, (*_SIZE, *_numbers(kernel), *texels), line)
    over, inputs = options.get("over", ""), [declared.name for declared in kernel.inputs]
    if over and over not in inputs:
        raise line.error(f"over: there is no input '{over}'{nearest(over, inputs)}")
    kernel = replace(kernel, registry=options["mesh"], blend=blend, depth=depth, count=count)
    kernel = replace(kernel, instances=instances, over=over)
    return replace(kernel, samples=int(samples), repeat=options.get("repeat", "1"))


def _compute(kernel: Kernel, options: dict[str, str], line: Line) -> Kernel:
    if not options.get("groups"):
        raise line.error('#pragma compute needs groups, as groups = "size.y, 1"')
    names = (*_SIZE, *_numbers(kernel))
    local = [part.strip() for part in options.get("local", "8, 8").split(",")]
    if len(local) != 2 or not all(re.fullmatch(r"[1-9][0-9]{0,4}", part) for part in local):
        raise line.error(f'local = "{options.get("local")}": expected two whole numbers, as "256, 1"')
    buffers: list[Buffer] = []
    for part in filter(None, (p.strip() for p in options.get("buffers", "").split(";"))):
        pieces = [p.strip() for p in part.split(":", 2)]
        if len(pieces) != 3 or not re.fullmatch(r"[A-Za-z_]\w*", pieces[0], re.ASCII):
            example = "stack:vec4:size.x * 64 (several separated by ;)"
            raise line.error(f"buffer '{part}': expected name:type:count, as {example}")
        if pieces[1] not in _BUFFER_TYPES:
            raise line.error(
                f"buffer '{pieces[0]}' has no type '{pieces[1]}'{nearest(pieces[1], _BUFFER_TYPES)}"
            )
        _check(f"buffer '{pieces[0]}'", pieces[2], names, line)
        buffers.append(Buffer(pieces[0], pieces[1], pieces[2]))
    stages = [part.strip() for part in filter(None, options.get("stages", "").split(","))]
    if not all(re.fullmatch(r"[0-9]{1,4}", part, re.ASCII) for part in stages):
        raise line.error(f'stages = "{options["stages"]}": expected whole numbers separated by commas')
    if stages and "repeat" in options:
        raise line.error("stages says how many steps there are; leave repeat out")
    if options.get("aligned", "8") not in CHOICES["aligned"]:
        raise line.error(
            f'aligned = "{options["aligned"]}": expected 4, 8, 16 or 32, the bytes that rows are filled up to'
        )
    active, there = options.get("active", ""), [buffer.name for buffer in buffers]
    if active and active not in there:
        raise line.error(f"active: no buffer '{active}'{nearest(active, there)}")
    if active and "repeat" not in options:
        raise line.error("active says when a repeat may end; give the compute variant a repeat")
    in_place = options.get("in_place", "")
    if in_place and in_place not in there:
        raise line.error(f"in_place: no buffer '{in_place}'{nearest(in_place, there)}")
    if in_place and not kernel.inputs:
        raise line.error("in_place: there is no input that the buffer could begin as")
    try:
        agrees = read_agreement(options["agrees"]) if "agrees" in options else ()
    except ValueError as error:
        raise line.error(f"agrees: {error}") from None
    _check_accepts(options.get("accepts", ""), line)
    _check("groups", options["groups"], (*names, "iteration"), line, count=2)
    _check("repeat", options.get("repeat", "1"), names, line)
    return replace(
        kernel,
        own_accepts=options.get("accepts", ""),
        groups=options["groups"],
        local=(int(local[0]), int(local[1])),
        buffers=tuple(buffers),
        repeat=str(len(stages)) if stages else options.get("repeat", "1"),
        stages=tuple(int(part) for part in stages),
        aligned=int(options.get("aligned", "8")),
        in_place=in_place,
        active=active,
        overwrites=tuple(filter(None, (p.strip() for p in options.get("overwrites", "").split(",")))),
        agrees=agrees,
    )


def _options(kind: str, text: str, line: Line) -> dict[str, str]:
    text = text.strip()
    if not text.startswith("(") or not text.endswith(")"):
        raise line.error(f"#pragma {kind} needs its options in brackets, as #pragma {kind}{_EXAMPLES[kind]}")
    found: dict[str, str] = {}
    for key, value in arguments(text[1:-1], line):
        if not key and kind == "source" and "name" not in found:
            key = "name"
        if key not in PRAGMAS[kind]:
            what = f"has no option '{key}'" if key else f"cannot tell what '{value}' is for"
            raise line.error(f"#pragma {kind} {what}{nearest(key, PRAGMAS[kind])}")
        if key in found:
            raise line.error(f"#pragma {kind} gives '{key}' twice")
        found[key] = value
    return found


def _with_names_replaced(options: dict[str, str], kernel: Kernel, line: Line) -> dict[str, str]:
    """Replace the names that ``where`` gives to expressions, in the options that are expressions."""
    known = (*_SIZE, "iteration", "iterations", *expressions.CLOCKS, *_numbers(kernel))
    meant: dict[str, str] = {}
    for part in filter(None, (p.strip() for p in options["where"].split(";"))):
        name, equals, text = (piece.strip() for piece in part.partition("="))
        if not equals or not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            example = "half = size.x // 2 (several separated by ;)"
            raise line.error(f"where '{part}': expected name = expression, as {example}")
        if name in known or name in meant or name in _NOT_IN_WHERE or kernel.parameter(name):
            raise line.error(f"where: the name '{name}' is taken")
        text = _replaced(text, meant)
        _check(f"where '{name}'", text, known, line)
        meant[name] = f"({text})"
    return {key: _replaced(text, meant) if key in _EXPRESSIONS else text for key, text in options.items()}


def _replaced(text: str, meant: dict[str, str]) -> str:
    # Not a component, as the x of size.x; nor the name or the type of a buffer, which colons follow.
    return _NAME.sub(lambda match: meant.get(match.group(), match.group()), text)


def _outputs(text: str, line: Line) -> tuple[Output, ...]:
    found: list[Output] = []
    for part in text.split(","):
        name, _, form = (piece.strip() for piece in part.partition(":"))
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            raise line.error(f"output '{part.strip()}': expected name:format, as height:r32f")
        if form not in FORMATS:
            raise line.error(f"output '{name}' has no format '{form}'{nearest(form, FORMATS)}")
        if name in [o.name for o in found]:
            raise line.error(f"output '{name}' appears twice")
        check_name(name, line, "output")
        found.append(Output(name, form))
    if len(found) > 8:
        raise line.error(f"{len(found)} outputs; OpenGL promises no more than 8")
    return tuple(found)


def _numbers(kernel: Kernel) -> tuple[str, ...]:
    """Return the parameters that an expression may name."""
    return tuple(p.name for p in kernel.parameters if p.type in ("float", "int", "uint", "bool"))


def _check(what: str, text: str, known: Collection[str], line: Line, count: int = 1) -> None:
    try:
        expressions.check(text, known, count=count)
    except ExpressionError as error:
        raise line.error(f"{what}: {error}") from None


def _refuse_misspelt(lines: list[Line]) -> None:
    for line in lines:
        match = _OTHER_PRAGMA.match(line.code)
        hint = nearest(match.group(1), PRAGMAS) if match else ""
        if match and "did you mean" in hint:
            raise line.error(f"no #pragma '{match.group(1)}'{hint}")


def _refuse_redefined(source: SourceText) -> None:
    if "define" not in source.names:
        return
    for line in source.lines:
        match = _DEFINE.match(line.code) if "define" in line.code else None
        if match and is_given(match.group(1)):
            check_name(match.group(1), line, "macro")


def _refuse_code(source: SourceText) -> None:
    """Refuse code in a source's file: no driver is given it, so that a mistake in it would never show."""
    for line in source.lines:
        code = line.code.strip()
        if code and not code.startswith("#") and not _UNIFORM.match(code):
            message = "a source's file has parameters only, and nothing runs this code; take it out"
            raise line.error(message, len(line.code) - len(line.code.lstrip()) + 1)


def _refuse_driver_bound(source: SourceText) -> None:
    if not any(name in DRIVER_BOUND or name.startswith("gl_") for name in source.names):
        return
    for line in source.lines:
        for match in re.finditer(r"[A-Za-z_]\w*", line.code):
            word = match.group()
            if word in DRIVER_BOUND:
                raise line.error(f"a kernel may not use '{word}': {DRIVER_BOUND[word]}", match.start() + 1)
            if word.startswith("gl_"):
                raise line.error(
                    f"a kernel may not use '{word}': its texel is an argument", match.start() + 1
                )

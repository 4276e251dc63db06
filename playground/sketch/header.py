"""Read a kernel's header from its text: its pragma, its ``//!`` parameters, its inputs.

Parameters are read from the text, never from the driver, where a uniform that is
optimised away vanishes.
"""

from __future__ import annotations

import re
from dataclasses import replace

from playground.errors import ParameterError, nearest
from playground.sketch import values
from playground.sketch.model import Buffer, Input, Kernel, Output, Parameter, Sampling, Value, Widget
from playground.sketch.source import Line, SourceText
from playground.sketch.words import DRIVER_BOUND, GIVEN, GLSL_WORDS, PREFIX

FORMATS: tuple[str, ...] = tuple(f"{c}{d}" for c in ("r", "rg", "rgba") for d in ("8", "16", "16f", "32f"))

_PRAGMA = re.compile(r"^\s*#\s*pragma\s+(kernel|source|draw|compute)\b\s*(.*)$")
_VERSION = re.compile(r"^\s*#\s*version\b")
_MAIN = re.compile(r"\bvoid\s+main\s*\(")
_UNIFORM = re.compile(r"^\s*uniform\s+(?:(?:lowp|mediump|highp)\s+)?(\w+)\s+(\w+)\s*(\[[^\]]*\])?\s*(?:=\s*([^;]+?))?\s*;")
_LITERAL = re.compile(r"^[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?[uUfF]*$")
_VECTOR = re.compile(r"^([iu]?vec[234])\s*\((.*)\)$")
_CALL = re.compile(r"\s*([a-z_]+)\s*(\()?")
_ARGUMENT = re.compile(r'\s*(?:(\w+)\s*=\s*)?("(?:[^"\\]|\\.)*"|[^,()"]+)\s*(,|$)')
_SCALARS = frozenset({"float", "int", "uint", "bool"})
_VECTORS = frozenset({"vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "uvec2", "uvec3", "uvec4"})
_WIDGETS = frozenset({"slider", "log_slider", "angle", "direction", "colour", "menu", "checkbox", "point", "file", "input"})
_MODIFIERS = frozenset({"step", "unit", "group", "label"})
_KEYS = {
    "kernel": ("output", "repeat", "accepts", "visits"),
    "source": ("name", "output"),
    "draw": ("mesh", "output", "blend", "depth", "repeat"),
    "compute": ("groups", "local", "buffers", "repeat"),
}
_MESSAGE_FOR_BARE = "a kernel's file needs a line such as #pragma kernel(output = \"height:r32f\")"

PLAIN_UNIFORMS: dict[str, tuple[str, ...]] = {
    "time": ("iTime", "iGlobalTime", "u_time", "time", "uTime"),
    "resolution": ("iResolution", "u_resolution", "resolution", "uResolution"),
    "mouse": ("iMouse", "u_mouse", "mouse", "uMouse"),
    "frame": ("iFrame", "u_frame", "frame", "uFrame"),
    "delta": ("iTimeDelta", "u_delta", "u_time_delta", "uDelta"),
    "date": ("iDate", "u_date"),
}
"""What a plain shader is given, under the names that such shaders use."""


def parse_kernel(name: str, source: SourceText, companion: Kernel | None = None) -> Kernel | None:
    """Return what a GLSL file declares; None for a library file, which declares nothing to run.

    Raises ``ShaderError`` naming file and line for each mistake in the header.
    """
    outermost = [line for line in source.lines if not line.chain]
    found = [(line, match) for line in outermost if (match := _PRAGMA.match(_uncommented(line)))]
    if any(_VERSION.match(line.code) for line in outermost):
        return _plain(name, source)
    if not found:
        return None
    if len(found) > 1:
        raise found[1][0].error("a second #pragma; a file is one kernel, one source or one draw")
    line, match = found[0]
    kind = match.group(1)
    options = _options(kind, match.group(2), line)
    parameters, inputs = _uniforms(source, kind)
    kernel = Kernel(name, kind, source, (), parameters, inputs, title=title_of(source), companion=companion)
    if kind == "compute":
        return _companion(kernel, options, line)
    default = "frame:rgba16f" if kind == "draw" else ""
    text = options.get("output", default)
    if not text:
        raise line.error(f'#pragma {kind} needs output = "name:format", as output = "height:r32f"')
    kernel = replace(kernel, outputs=_outputs(text, line))
    for output in kernel.outputs:
        for other in (*parameters, *inputs):
            if output.name == other.name and not isinstance(other, Input):
                raise line.error(f"'{output.name}' is both an output and a parameter")
    if kind == "source":
        if not options.get("name"):
            raise line.error('#pragma source needs its name, as #pragma source("elevation_file", output = "height:r32f")')
        return replace(kernel, registry=options["name"])
    if kind == "draw":
        return _draw(kernel, options, line)
    _refuse_driver_bound(source)
    return replace(
        kernel,
        repeat=options.get("repeat", "1"),
        accepts=options.get("accepts", ""),
        visits=options.get("visits", ""),
    )


def title_of(source: SourceText) -> str:
    """Return the sentence that a file begins with, without its own name."""
    for line in source.lines:
        if line.comment.strip():
            text = line.comment.strip()
            return re.sub(r"^\S+\.(glsl|comp|frag)\s*(--|:)\s*", "", text)
        if line.code.strip():
            break
    return ""


def _uncommented(line: Line) -> str:
    """Return a line as written, a pragma's quotes included, without its comment."""
    if not line.text.lstrip().startswith("#"):
        return line.code
    return line.text.removesuffix(f"//{line.comment}") if line.comment else line.text


def _plain(name: str, source: SourceText) -> Kernel:
    is_compute = source.path.endswith(".comp") or "local_size_x" in source.names
    if not _MAIN.search(source.code):
        raise source.lines[0].error("a shader with its own #version needs its own main()")
    usual = {n for names in PLAIN_UNIFORMS.values() for n in names}
    parameters, _ = _uniforms(source, "plain", skip=usual)
    output = Output("frame", "rgba8")
    local = (1, 1)
    if is_compute:
        image = re.search(r"layout\s*\(([^)]*)\)\s*(?:(?:writeonly|readonly|restrict|coherent|volatile)\s+)*uniform\s+(?:\w+\s+)*image2D\s+(\w+)", source.code)
        if not image:
            raise source.lines[0].error("a plain compute shader needs an image2D to write, as layout(rgba8, binding = 0) uniform image2D picture;")
        formats = [w.strip() for w in image.group(1).split(",") if w.strip() in FORMATS]
        if not formats:
            raise source.lines[0].error(f"the image {image.group(2)} needs a format; there are: {', '.join(FORMATS)}")
        output = Output("frame", formats[0])
        sizes = [re.search(rf"local_size_{axis}\s*=\s*(\d+)", source.code) for axis in "xy"]
        local = (int(sizes[0].group(1)) if sizes[0] else 1, int(sizes[1].group(1)) if sizes[1] else 1)
    kind = "plain_compute" if is_compute else "plain_fragment"
    return Kernel(name, kind, source, (output,), parameters, local=local, title=title_of(source))


def _draw(kernel: Kernel, options: dict[str, str], line: Line) -> Kernel:
    if not options.get("mesh"):
        raise line.error('#pragma draw needs a mesh, as mesh = "grid"')
    if len(kernel.outputs) != 1:
        raise line.error("a draw has one output")
    blend, depth = options.get("blend", "none"), options.get("depth", "less")
    for key, value, valid in (("blend", blend, ("none", "alpha", "add")), ("depth", depth, ("less", "none"))):
        if value not in valid:
            raise line.error(f"{key} = \"{value}\": expected one of {', '.join(valid)}")
    return replace(kernel, registry=options["mesh"], blend=blend, depth=depth, repeat=options.get("repeat", "1"))


def _companion(kernel: Kernel, options: dict[str, str], line: Line) -> Kernel:
    if not options.get("groups"):
        raise line.error('#pragma compute needs groups, as groups = "size.y, 1"')
    local = [part.strip() for part in options.get("local", "8, 8").split(",")]
    if len(local) != 2 or not all(part.isdigit() and int(part) > 0 for part in local):
        raise line.error(f"local = \"{options.get('local')}\": expected two whole numbers, as \"256, 1\"")
    buffers = []
    for part in filter(None, (p.strip() for p in options.get("buffers", "").split(";"))):
        pieces = [p.strip() for p in part.split(":", 2)]
        if len(pieces) != 3:
            raise line.error(f"buffer '{part}': expected name:type:count, as stack:vec4:size.x * 64 (several parted by ;)")
        buffers.append(Buffer(pieces[0], pieces[1], pieces[2]))
    return replace(
        kernel,
        groups=options["groups"],
        local=(int(local[0]), int(local[1])),
        buffers=tuple(buffers),
        repeat=options.get("repeat", "1"),
    )


def _options(kind: str, text: str, line: Line) -> dict[str, str]:
    text = text.strip()
    if not text.startswith("(") or not text.endswith(")"):
        raise line.error(f"#pragma {kind} needs its options in brackets on one line; {_MESSAGE_FOR_BARE}")
    found: dict[str, str] = {}
    for key, value in _arguments(text[1:-1], line):
        if not key and kind == "source" and "name" not in found:
            key = "name"
        if key not in _KEYS[kind]:
            raise line.error(f"#pragma {kind} has no option '{key}'{nearest(key, _KEYS[kind])}")
        if key in found:
            raise line.error(f"#pragma {kind} gives '{key}' twice")
        found[key] = value
    return found


def _arguments(text: str, line: Line) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    position = 0
    while position < len(text) and text[position:].strip():
        match = _ARGUMENT.match(text, position)
        if not match:
            raise line.error(f"cannot read '{text[position:].strip()}'; expected values parted by commas, text in quotes")
        raw = match.group(2).strip()
        found.append((match.group(1) or "", raw[1:-1] if raw.startswith('"') else raw))
        position = match.end()
    return found


def _outputs(text: str, line: Line) -> tuple[Output, ...]:
    found: list[Output] = []
    for part in text.split(","):
        name, _, form = (piece.strip() for piece in part.partition(":"))
        if not re.fullmatch(r"[A-Za-z_]\w*", name):
            raise line.error(f"output '{part.strip()}': expected name:format, as height:r32f")
        if form not in FORMATS:
            raise line.error(f"output '{name}' has no format '{form}'{nearest(form, FORMATS)}")
        if name in [o.name for o in found]:
            raise line.error(f"output '{name}' stands twice")
        _check_name(name, line, "output")
        found.append(Output(name, form))
    if len(found) > 8:
        raise line.error(f"{len(found)} outputs; OpenGL promises no more than 8")
    return tuple(found)


def _check_name(name: str, line: Line, what: str) -> None:
    column = line.code.find(name) + 1
    if name in GIVEN:
        raise line.error(f"'{name}' is given to every kernel; name the {what} something else", column)
    if name.startswith((PREFIX, "gl_")) or "__" in name:
        raise line.error(f"'{name}': names that begin with {PREFIX} or gl_, or hold __, are reserved", column)
    if name in GLSL_WORDS:
        raise line.error(f"'{name}' is a word of GLSL itself; name the {what} something else", column)


def _uniforms(
    source: SourceText, kind: str, skip: frozenset[str] | set[str] = frozenset()
) -> tuple[tuple[Parameter, ...], tuple[Input, ...]]:
    parameters: list[Parameter] = []
    inputs: list[Input] = []
    seen: set[str] = set()
    for line in source.lines:
        match = _UNIFORM.match(line.code)
        if not match:
            if re.match(r"^\s*uniform\b", line.code) and kind != "plain" and "image" not in line.code:
                raise line.error("a uniform is declared on one line: uniform TYPE NAME = LITERAL;  //! annotation")
            continue
        glsl_type, name, array, initial = match.groups()
        if name in skip:
            continue
        if kind == "plain" and (array or glsl_type not in _SCALARS | _VECTORS):
            continue
        if array:
            raise line.error(f"'{name}' is an array; parameters are scalars and vectors")
        if kind != "plain":
            _check_name(name, line, "parameter")
        if name in seen:
            raise line.error(f"'{name}' is declared twice")
        seen.add(name)
        note = line.comment[1:] if line.comment.startswith("!") else ""
        calls, tooltip = _annotation(note, line)
        if glsl_type == "sampler2D":
            item = _sampler(name, calls, tooltip, line)
            if isinstance(item, Input):
                inputs.append(item)
            else:
                parameters.append(item)
        elif glsl_type in _SCALARS | _VECTORS:
            parameters.append(_parameter(name, glsl_type, initial, calls, tooltip, line))
        else:
            raise line.error(f"a parameter may not be a {glsl_type}; scalars, vectors and sampler2D may")
    return tuple(parameters), tuple(inputs)


def _annotation(note: str, line: Line) -> tuple[dict[str, list[str]], str]:
    calls: dict[str, list[str]] = {}
    position = 0
    while match := _CALL.match(note, position):
        word = match.group(1)
        if word not in _WIDGETS | _MODIFIERS:
            if match.group(2) and position == 0:
                raise line.error(f"no widget '{word}'{nearest(word, _WIDGETS | _MODIFIERS)}", line.text.find(word) + 1)
            break
        if match.group(2):
            end = note.find(")", match.end())
            if end < 0:
                raise line.error(f"'{word}(' is not closed", line.text.find(word) + 1)
            calls[word] = [value for _, value in _arguments(note[match.end() : end], line)]
            position = end + 1
        else:
            calls[word] = []
            position = match.end()
    return calls, note[position:].strip()


def _sampler(name: str, calls: dict[str, list[str]], tooltip: str, line: Line) -> Parameter | Input:
    words = list(calls.get("input", []))
    is_file = "file" in calls
    path = ""
    if is_file:
        words = list(calls["file"])
        path = words.pop(0) if words else ""
    valid = {"nearest", "linear", "clamp", "repeat", "mipmap"} | (set() if is_file else {"white", "black"})
    for word in words:
        if word not in valid:
            raise line.error(f"'{word}' is not a way to read a texture{nearest(word, valid)}")
    sampling = Sampling(
        "linear" if "linear" in words else "nearest", "repeat" if "repeat" in words else "clamp", "mipmap" in words
    )
    if is_file:
        return Parameter(
            name, "sampler2D", path, Widget("file"), group="".join(calls.get("group", [])),
            label="".join(calls.get("label", [])), tooltip=tooltip, sampling=sampling, file=line.file, line=line.number,
        )
    fallback = "white" if "white" in words else "black" if "black" in words else ""
    return Input(name, sampling, fallback, line.number)


def _parameter(
    name: str, glsl_type: str, initial: str | None, calls: dict[str, list[str]], tooltip: str, line: Line
) -> Parameter:
    widgets = [word for word in calls if word in _WIDGETS]
    if len(widgets) > 1:
        raise line.error(f"'{name}' has two widgets: {' and '.join(widgets)}")
    kind = widgets[0] if widgets else ("checkbox" if glsl_type == "bool" else "number")
    arguments = calls.get(kind, [])
    fits = {
        "direction": ("vec2",),
        "point": ("vec2",),
        "colour": ("vec3", "vec4"),
        "menu": ("int",),
        "checkbox": ("bool",),
        "angle": ("float",),
        "log_slider": ("float", "int", "uint"),
    }.get(kind)
    if kind in ("file", "input"):
        raise line.error(f"{kind} is for a sampler2D; '{name}' is a {glsl_type}")
    if fits and glsl_type not in fits:
        raise line.error(f"{kind} is for {' or '.join(fits)}; '{name}' is a {glsl_type}")
    widget = Widget(kind)
    if kind in ("slider", "log_slider", "angle") and (arguments or kind != "angle"):
        numbers = _range(name, kind, arguments, line)
        widget = Widget(kind, *numbers)
    elif kind == "angle":
        widget = Widget(kind, -360.0, 360.0)
    elif kind == "point":
        widget = Widget(kind, 0.0, 1.0)
    elif kind == "menu":
        if len(arguments) < 2:
            raise line.error(f'the menu of \'{name}\' needs its choices, as menu("linear", "smooth")')
        widget = Widget(kind, choices=tuple(arguments))
    step = None
    if "step" in calls:
        step = _range(name, "step", calls["step"], line, count=1)[0]
    parameter = Parameter(
        name, glsl_type, 0, widget, step, "".join(calls.get("unit", [])), "".join(calls.get("group", [])),
        "".join(calls.get("label", [])), tooltip, file=line.file, line=line.number,
    )
    default = _literal(name, glsl_type, initial, line)
    try:
        return replace(parameter, default=values.coerce(parameter, default))
    except ParameterError as error:
        raise line.error(f"the default of {error.diagnostics[0].message}") from None


def _range(name: str, word: str, arguments: list[str], line: Line, count: int = 2) -> tuple[float, ...]:
    try:
        numbers = tuple(float(a) for a in arguments)
    except ValueError:
        numbers = ()
    if len(numbers) != count or (count == 2 and not numbers[0] < numbers[1]):
        wanted = "two numbers, the lower first, as slider(0, 1)" if count == 2 else "one number, as step(0.01)"
        raise line.error(f"{word} of '{name}': expected {wanted}")
    if word == "log_slider" and numbers[0] <= 0:
        raise line.error(f"log_slider of '{name}': its range must lie above 0")
    return numbers


def _literal(name: str, glsl_type: str, initial: str | None, line: Line) -> Value | list[float]:
    length = values.length_of(glsl_type)
    if initial is None:
        return False if glsl_type == "bool" else (0 if length == 1 else [0] * length)
    text = initial.strip()
    column = line.code.find(text) + 1
    if glsl_type == "bool":
        if text in ("true", "false"):
            return text == "true"
        raise line.error(f"'{name}' is a bool; expected true or false, found {text}", column)
    parts = [text]
    if length > 1:
        vector = _VECTOR.match(text)
        if not vector or vector.group(1) != glsl_type:
            raise line.error(f"the initialiser of '{name}' must be a literal, as {glsl_type}(…)", column)
        parts = [part.strip() for part in vector.group(2).split(",")]
        if len(parts) == 1:
            parts *= length
    if len(parts) != length or not all(_LITERAL.match(part) for part in parts):
        raise line.error(f"the initialiser of '{name}' must be a literal, found {text}", column)
    numbers = [float(part.rstrip("uUfF")) for part in parts]
    whole = [int(n) if values.is_whole(glsl_type) else n for n in numbers]
    return whole if length > 1 else whole[0]


def _refuse_driver_bound(source: SourceText) -> None:
    for line in source.lines:
        for match in re.finditer(r"[A-Za-z_]\w*", line.code):
            word = match.group()
            if word in DRIVER_BOUND:
                raise line.error(f"a kernel may not use '{word}': {DRIVER_BOUND[word]}", match.start() + 1)
            if word.startswith("gl_"):
                raise line.error(f"a kernel may not use '{word}': it is told its texel as an argument", match.start() + 1)

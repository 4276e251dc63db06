"""Read a kernel's uniforms from its text: parameters with their ``//!`` annotations, inputs.

They are read from the text, never from the driver, where a uniform that is optimised
away vanishes.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

from playground.errors import Diagnostic, ParameterError, nearest
from playground.paths import shown
from playground.sketch import values
from playground.sketch.annotation import calls as read_calls
from playground.sketch.annotation import note_at
from playground.sketch.follows import read_follows
from playground.sketch.model import Input, Parameter, Sampling, Value, Widget
from playground.sketch.reserved_names import (
    GIVEN,
    GIVEN_INSTEAD,
    GLSL_WORDS,
    MATCHES,
    PLAIN_UNIFORMS,
    PREFIX,
    RESERVED,
    TOWARDS,
    WIRED,
)
from playground.sketch.source import Line, SourceText
from playground.sketch.widgets import SCALARS, VECTORS, WIDGETS

FALLBACKS = ("white", "black", "zero")
"""What an input reads where nothing is wired: "zero" is black with alpha 0, and a loop's first iteration
reads zeros of the size of what is fed back."""
_UNIFORM = re.compile(
    r"^\s*uniform\s+(?:(?:lowp|mediump|highp)\s+)?(\w+)\s+(\w+)\s*(\[[^\]]*\])?\s*(?:=([^;]*))?;"
)
_LAYOUT = re.compile(r"^\s*layout\s*\([^)]*\)(?=\s*uniform\b)")
_SAMPLERS = re.compile(r"\buniform\s+(?:(?:lowp|mediump|highp)\s+)?([iu]?sampler\w+)\s+([^;]*);")
_WORD_UNIFORM = re.compile(r"\buniform\b")
_IMAGE = re.compile(r"\b[iu]?image[123]D\b")
_FLOAT = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eEfF]))(?:[eE][-+]?\d+)?[fF]?")
_WHOLE = re.compile(r"([-+]?)(?:0[xX]([0-9a-fA-F]+)|(\d+))[uU]?")
_VECTOR = re.compile(r"([iu]?vec[234])\s*\((.*)\)", re.DOTALL)
_LONGEST_LITERAL = 64

_TYPES = frozenset(SCALARS + VECTORS)
_ROLES = WIDGETS.keys() - {"number"} | {"input"}
_BARE = frozenset(word for word in _ROLES if word == "input" or WIDGETS[word].bare)
MODIFIERS = frozenset(
    {"step", "unit", "group", "label", "parts", "values", "follows", "was", "erode", "preview"}
)
"""Words of an annotation that may follow its widget."""

Calls = dict[str, list[str]]


def read_uniforms(
    source: SourceText, *, plain: bool = False, skip: Collection[str] = ()
) -> tuple[tuple[Parameter, ...], tuple[Input, ...]]:
    """Return the parameters and the inputs of a file with its includes, in the order of their lines.

    Of a ``plain`` shader only what can be understood is taken, ``skip`` left out, and of its
    samplers those that an image file feeds; in any other, raises ``ShaderError`` for a
    declaration that cannot be.
    """
    parameters: list[Parameter] = []
    inputs: list[Input] = []
    seen: dict[str, Line] = {}
    following: list[tuple[int, list[str], Line]] = []  # which parameter, what it follows
    for index, line in enumerate(source.lines):
        if "uniform" not in line.code:  # most lines: a text with its includes has a thousand
            continue
        match = _UNIFORM.match(_LAYOUT.sub("", line.code) if plain else line.code)
        if not plain:
            _check_declaration(line, match)
        if not match:
            continue
        glsl_type, name, array, initial = match.groups()
        feeds = plain and glsl_type == "sampler2D" and line.comment.startswith("!")
        if name in skip or (plain and not feeds and (array or glsl_type not in _TYPES)):
            continue
        if array:
            raise line.error(f"'{name}' is an array; parameters are scalars and vectors")
        if not plain:
            check_name(name, line, "parameter")
            _refuse_given_elsewhere(name, initial, line)
        if name in seen:
            # A file that is included twice is here twice; its guard leaves one to the driver.
            if (seen[name].file, seen[name].number) == (line.file, line.number):
                continue
            first = f"{shown(seen[name].file)}:{seen[name].number}"
            raise line.error(f"'{name}' is declared twice: first at {first}")
        seen[name] = line
        calls, tooltip = read_calls(note_at(source.lines, index), _ROLES | MODIFIERS, _BARE)
        if glsl_type == "sampler2D":
            item = _sampler(name, calls, tooltip, line)
            if isinstance(item, Input) and plain:
                example = f'uniform sampler2D {name};  //! file("picture.png")'
                raise line.error(f"a plain shader has no inputs, but may read an image file: {example}")
            if isinstance(item, Input):
                inputs.append(item)
            else:
                parameters.append(item)
        elif glsl_type in _TYPES:
            if "follows" in calls:
                following.append((len(parameters), calls["follows"], line))
            parameters.append(_parameter(name, glsl_type, initial, calls, tooltip, line))
        else:
            raise line.error(f"a parameter may not be a {glsl_type}; scalars, vectors and sampler2D may")
    for number, words, line in following:
        found = read_follows(parameters[number], words, parameters, line)
        parameters[number] = replace(parameters[number], follows=found)
    _check_former_names(parameters, seen)
    return tuple(parameters), tuple(inputs)


def unfed_samplers(source: SourceText) -> tuple[Diagnostic, ...]:
    """Return a warning for each sampler of a plain shader that no image file feeds: it reads black."""
    fed = {p.name for p in read_uniforms(source, plain=True)[0] if p.type == "sampler2D"}
    found: list[Diagnostic] = []
    for line in source.lines:
        for match in _SAMPLERS.finditer(line.code):
            kind, names = match.groups()
            for one in re.finditer(r"([A-Za-z_]\w*)\s*(?:\[[^\]]*\]\s*)?(?:,|$)", names):
                name, column = one.group(1), match.start(2) + one.start() + 1
                example = f'uniform sampler2D {name};  //! file("picture.png")'
                more = f"an image file does: {example}"
                if kind != "sampler2D":
                    more = "only a sampler2D may be fed"
                if name not in fed:
                    message = f"nothing feeds '{name}', so it reads black; {more}"
                    found.append(line.diagnostic(message, column, "warning"))
    return tuple(dict.fromkeys(found))


def is_given(name: str) -> bool:
    """Return whether a name is one that the engine gives, or calls."""
    return name in GIVEN or name in RESERVED or name.startswith(("previous_", WIRED, MATCHES, TOWARDS))


def check_name(name: str, line: Line, what: str) -> None:
    """Raise ``ShaderError`` for a name that GLSL or the engine has taken."""
    if is_given(name):
        message = f"'{name}' is given to every kernel; name the {what} something else"
    elif name.startswith((PREFIX, "gl_")) or "__" in name:
        message = f"'{name}': names that begin with {PREFIX} or gl_, or hold __, are reserved"
    elif name in GLSL_WORDS:
        message = f"'{name}' is a word of GLSL itself; name the {what} something else"
    else:
        return
    found = re.search(rf"\b{re.escape(name)}\b", line.code)
    raise line.error(message, found.start() + 1 if found else 0)


def _refuse_given_elsewhere(name: str, initial: str | None, line: Line) -> None:
    """Refuse a uniform that only plain shaders are given: here it would always have its default.

    One with an annotation is meant as a parameter, and so is a plain word with a default.
    """
    meaning = next((m for m, names in PLAIN_UNIFORMS.items() if name in names), "")
    if not meaning or line.comment.startswith("!") or (name == meaning and initial is not None):
        return
    column = line.code.index(name) + 1
    wrong = f"'{name}' is given to plain shaders only, and here nothing would set it"
    if name in GIVEN_INSTEAD:
        given = GIVEN_INSTEAD[name]
        raise line.error(f"{wrong}; did you mean '{given}'? It is given: take this line out", column)
    raise line.error(f"{wrong}; an annotation makes it a parameter, as //! point for a vec2", column)


def _check_declaration(line: Line, match: re.Match[str] | None) -> None:
    count = len(_WORD_UNIFORM.findall(line.code))
    if line.code.lstrip().startswith("#") or _IMAGE.search(line.code) or count == bool(match):
        return
    raise line.error(
        "a uniform is declared on one line of its own: uniform TYPE NAME = LITERAL;  //! annotation"
    )


def _sampler(name: str, calls: Calls, tooltip: str, line: Line) -> Parameter | Input:
    wrong = sorted(set(calls) & _ROLES - {"file", "input"})
    if wrong:
        raise line.error(f"{wrong[0]} is not for a sampler2D; '{name}' may be an input or a file")
    if "file" in calls and "input" in calls:
        raise line.error(f"'{name}' has two widgets: file and input")
    is_file = "file" in calls
    if "erode" in calls and not (is_file and "paint" in calls["file"]):
        raise line.error(f"'{name}' is not painted on; erode is for a file with the word \"paint\"")
    if "was" in calls and not is_file:
        raise line.error(f"'{name}' is an input; was is for a parameter")
    words = list(calls.get("file" if is_file else "input", []))
    path = words.pop(0) if is_file and words else ""
    if "\0" in path:
        raise line.error(f"the path of '{name}' holds a zero byte")
    valid = [
        "nearest",
        "linear",
        "clamp",
        "repeat",
        "mipmap",
        *(["paint"] if is_file else FALLBACKS),
    ]
    for word in words:
        if word not in valid:
            raise line.error(f"'{word}' is not a way to read a texture{nearest(word, valid)}")
    for pair in (("nearest", "linear"), ("clamp", "repeat"), FALLBACKS):
        if len(both := [word for word in pair if word in words]) > 1:
            raise line.error(f"'{name}' is both {both[0]} and {both[1]}")
    sampling = Sampling(
        "linear" if "linear" in words else "nearest",
        "repeat" if "repeat" in words else "clamp",
        "mipmap" in words,
    )
    if not is_file:
        fallback = next((word for word in FALLBACKS if word in words), "")
        return Input(name, sampling, fallback, line.number)
    return Parameter(
        name,
        "sampler2D",
        path,
        Widget("file"),
        sampling=sampling,
        painted="paint" in words,
        erode=_text(calls, "erode", line),
        **_described(calls, tooltip, line),
        former=_former_names(name, calls, line),
    )


def _parameter(
    name: str, glsl_type: str, initial: str | None, calls: Calls, tooltip: str, line: Line
) -> Parameter:
    widgets = [word for word in calls if word in _ROLES]
    if "erode" in calls:
        raise line.error(f"erode is for a file that is painted on; '{name}' is a {glsl_type}")
    if len(widgets) > 1:
        raise line.error(f"'{name}' has two widgets: {' and '.join(widgets)}")
    kind = widgets[0] if widgets else ("checkbox" if glsl_type == "bool" else "number")
    if kind in ("file", "input"):
        raise line.error(f"{kind} is for a sampler2D; '{name}' is a {glsl_type}")
    fits = WIDGETS[kind].types
    if glsl_type not in fits:
        wanted = " or ".join(fits) if len(fits) <= 3 else "numbers"
        raise line.error(f"{kind} is for {wanted}; '{name}' is a {glsl_type}")
    step = _numbers(name, "step", calls["step"], 1, line)[0] if "step" in calls else None
    if step is not None and step <= 0:
        raise line.error(f"step of '{name}': expected a number above 0")
    widget = _widget(name, kind, calls.get(kind, []), line)
    widget = replace(widget, values=_menu_values(name, widget, calls, line))
    parameter = Parameter(
        name,
        glsl_type,
        0,
        replace(widget, renamed=_renamed_choices(name, widget, calls, line)),
        step,
        _text(calls, "unit", line),
        parts=_parts(name, glsl_type, kind, calls, line),
        **_described(calls, tooltip, line),
        former=_former_names(name, calls, line),
    )
    default = _literal(name, glsl_type, initial, line)
    if widget.values:
        if default not in widget.values:
            listed = ", ".join(map(str, widget.values))
            raise line.error(f"the default of '{name}' is {default}; its menu's values are {listed}")
        default = widget.values.index(default)
    if kind == "button" and default:
        raise line.error(f"the default of '{name}' must be false: a button is true while it is pressed")
    try:
        parameter = replace(parameter, default=values.coerce(parameter, default))
    except ParameterError as error:
        raise line.error(f"the default of {error.diagnostics[0].message}") from None
    return replace(parameter, preview=_preview(parameter, calls, line))


def _parts(name: str, glsl_type: str, kind: str, calls: Calls, line: Line) -> tuple[str, ...]:
    """Return the names of a vector's components, one each."""
    found = tuple(calls.get("parts", ()))
    count = values.length_of(glsl_type)
    if not found:
        return ()
    if kind not in ("slider", "number"):
        raise line.error(f"parts is for a vector of numbers; '{name}' is a {kind}")
    if count == 1 or len(found) != count or len(set(found)) < count or not all(found):
        example = ", ".join(f'"{part}"' for part in ("west", "east", "south", "north")[:count])
        wanted = f"{count} different names, as parts({example})" if count > 1 else "a vector"
        raise line.error(f"parts of '{name}', a {glsl_type}: expected {wanted}")
    return found


def _preview(parameter: Parameter, calls: Calls, line: Line) -> Value | None:
    """Return the choice of a menu, or the number, that previews have; None for what is the same there."""
    if "preview" not in calls:
        return None
    found = calls["preview"]
    if parameter.widget.kind not in ("menu", "slider", "log_slider") or len(found) != 1:
        example = 'preview("fast"), or a slider\'s number'
        raise line.error(f"preview of '{parameter.name}': expected one choice of a menu, as {example}")
    try:
        return values.coerce(parameter, found[0])
    except ParameterError as error:
        raise line.error(f"the preview of {error.diagnostics[0].message}") from None


def _menu_values(name: str, widget: Widget, calls: Calls, line: Line) -> tuple[int, ...]:
    """Return what the uniform gets for each choice of a menu; nothing where that is the choice's number."""
    if "values" not in calls:
        return ()
    found = [_number(word, fractions=False) for word in calls["values"]]
    numbers = tuple(n for n in found if isinstance(n, int) and -(2**31) <= n < 2**31)
    if widget.kind != "menu" or len(numbers) != len(widget.choices) or len(found) != len(numbers):
        wanted = f"{len(widget.choices)} whole numbers" if widget.choices else "a menu before it"
        raise line.error(f'values of \'{name}\': expected {wanted}, as menu("soft", "hard") values(1, 4)')
    return numbers


def _former_names(name: str, calls: Calls, line: Line) -> tuple[str, ...]:
    """Return the names that ``was("stride")`` gives; ``was("mended: removed")`` is of a menu's choices."""
    found = tuple(word for word in calls.get("was", ()) if ":" not in word)
    wrong = next((word for word in found if not word.isidentifier()), None)
    if wrong is not None or ("was" in calls and not calls["was"]):
        example = 'as was("stride"), or of a choice was("former: present")'
        raise line.error(f"was of '{name}': expected its former name, {example}")
    return found


def _renamed_choices(name: str, widget: Widget, calls: Calls, line: Line) -> tuple[tuple[str, str], ...]:
    """Return former choices of a menu with what each is called now."""
    pairs = [word.partition(":") for word in calls.get("was", ()) if ":" in word]
    found = tuple((former.strip(), present.strip()) for former, _, present in pairs)
    for former, present in found:
        if present not in widget.choices:
            raise line.error(f"was of '{name}': no choice '{present}'{nearest(present, widget.choices)}")
        if former in widget.choices:
            raise line.error(f"was of '{name}': '{former}' is one of its choices still")
    return found


def _check_former_names(parameters: Sequence[Parameter], seen: Mapping[str, Line]) -> None:
    """Raise ``ShaderError`` for a former name that something else of the file has, or had."""
    owners: dict[str, str] = {}
    for parameter in parameters:
        for former in parameter.former:
            other = former if former in seen else owners.setdefault(former, parameter.name)
            if other != parameter.name or former in seen:
                message = f"was of '{parameter.name}': '{former}' is the name of '{other}'"
                raise seen[parameter.name].error(message)


def _widget(name: str, kind: str, arguments: list[str], line: Line) -> Widget:
    facts = WIDGETS[kind]
    if facts.takes == "range" or (facts.takes == "range or nothing" and arguments):
        low, high = _numbers(name, kind, arguments, 2, line)
        if kind == "log_slider" and low <= 0:
            raise line.error(f"log_slider of '{name}': its range must lie above 0")
        return Widget(kind, low, high)
    if facts.takes == "ranges" and arguments:
        pairs = [arguments[:2], arguments[2:]] if len(arguments) > 2 else [arguments]
        axes = [_numbers(name, kind, pair, 2, line) for pair in pairs]
        return with_axes(kind, [(low, high) for low, high in axes])
    if facts.takes == "raw or nothing" and arguments:
        if arguments != ["raw"]:
            example = f'as {kind}("raw") for one that is not linear, or {kind}'
            raise line.error(f"{kind} of '{name}' takes only raw in brackets, {example}")
        return Widget(kind, raw=True)
    if facts.takes == "choices":
        if len(arguments) < 2:
            raise line.error(f'the {kind} of \'{name}\' needs its choices, as {kind}("linear", "smooth")')
        if len(set(arguments)) < len(arguments):
            raise line.error(f"the {kind} of '{name}' has a choice twice")
        return Widget(kind, choices=tuple(arguments))
    if arguments:
        raise line.error(f"{kind} of '{name}' takes nothing in brackets")
    return Widget(kind, *(facts.range or (None, None)))


def with_axes(kind: str, axes: Sequence[tuple[float, float]]) -> Widget:
    """Return a widget of a vector whose numbers have these ranges: one for all, or one each."""
    low, high = min(low for low, _ in axes), max(high for _, high in axes)
    return Widget(kind, low, high, axes=tuple(axes) if len(set(axes)) > 1 else ())


def _numbers(name: str, word: str, arguments: list[str], count: int, line: Line) -> tuple[float, ...]:
    try:
        numbers = tuple(float(a) for a in arguments)
    except ValueError:
        numbers = ()
    ordered = count == 1 or (len(numbers) == 2 and numbers[0] < numbers[1])
    if len(numbers) != count or not ordered or not all(map(math.isfinite, numbers)):
        two = f"two numbers, the lower first, as {word}(0, 1)"
        raise line.error(f"{word} of '{name}': expected {two if count == 2 else 'one number, as step(0.01)'}")
    return numbers


def _described(calls: Calls, tooltip: str, line: Line) -> dict[str, Any]:
    """Return the fields that any parameter has, of a number or a file."""
    texts = {word: _text(calls, word, line) for word in ("group", "label")}
    return {**texts, "tooltip": tooltip, "file": line.file, "line": line.number}


def _text(calls: Calls, word: str, line: Line) -> str:
    if word in calls and len(calls[word]) != 1:
        raise line.error(f'{word}() takes one text in quotes, as {word}("m")')
    return calls[word][0] if word in calls else ""


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
        vector = _VECTOR.fullmatch(text)
        if not vector or vector.group(1) != glsl_type:
            raise line.error(f"the initialiser of '{name}' must be a literal, as {glsl_type}(…)", column)
        parts = [part.strip() for part in vector.group(2).split(",")]
        if len(parts) == 1:
            parts *= length
    # A constructor takes any numbers, a scalar is converted from whole to real alone.
    fractions = length > 1 or not values.is_whole(glsl_type)
    numbers = [_number(part, fractions=fractions) for part in parts]
    if len(parts) != length or any(number is None for number in numbers):
        wanted = "" if fractions else "whole "
        raise line.error(f"the initialiser of '{name}' must be a {wanted}literal, found {text}", column)
    found = [math.trunc(n) if values.is_whole(glsl_type) else n for n in numbers if n is not None]
    return found if length > 1 else found[0]


def _number(text: str, *, fractions: bool) -> float | int | None:
    """Read a number as GLSL writes it: 0x1F and 017 have the bases 16 and 8."""
    if len(text) > _LONGEST_LITERAL:
        return None
    if whole := _WHOLE.fullmatch(text):
        sign, sixteen, digits = whole.groups()
        base = 16 if sixteen else 8 if digits.startswith("0") else 10
        try:
            return int(sixteen or digits, base) * (-1 if sign == "-" else 1)
        except ValueError:  # 089 is neither
            return None
    if not fractions or not _FLOAT.fullmatch(text):
        return None
    number = float(text.rstrip("fF"))
    return number if math.isfinite(number) else None

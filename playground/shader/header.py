"""A kernel's header: its pragma, its parameters with ``//!`` annotations, its inputs.

All of it is read from the text, never from the driver, where a uniform that is optimised away vanishes.

An annotation as ``slider(0, 1) step(0.01) The tooltip`` is split into calls with their arguments, and a
tooltip. The widgets are the rows of ``WIDGETS`` in ``widgets``, the options of a pragma those of the kernel
classes in ``kernel``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar, cast

from playground.allowed_files import SHADERS
from playground.errors import Diagnostic, ParameterError, ShaderError, nearest
from playground.memo import FILES, GRAPHS
from playground.paths import shown
from playground.shader import expressions
from playground.shader import parameter as values
from playground.shader.kernel import (
    FORMATS,
    PRAGMAS,
    RECORDS,
    SIZE,
    CpuSource,
    Input,
    Kernel,
    Output,
    PlainCompute,
    PlainFragment,
    Scope,
    TexelKernel,
    Variant,
    check_expression,
    options_of,
)
from playground.shader.parameter import Brush, Follows, Parameter, Sampling
from playground.shader.reserved_names import (
    DRIVER_BOUND,
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
from playground.shader.source import Line, Origin, SourceText, read_source_and_origin
from playground.shader.syntax.tokens import as_written, directive, place_of, tokenize
from playground.shader.widgets import SCALARS, VECTORS, WIDGETS, Value, Widget

_ARGUMENT = re.compile(r'\s*(?:(\w+)\s*=\s*)?("(?:[^"\\]|\\.)*"|[^,()"]+)\s*(,|$)')
_WORD = re.compile(r"\s*([A-Za-z_]\w*)(\s*\()?")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')

Argument = tuple[str, str]
"""A name, "" where there is none, and a text."""


@dataclass(frozen=True, slots=True)
class Note:
    """The text of one annotation, and the lines that it is on."""

    text: str
    lines: tuple[tuple[int, Line], ...]  # where in the text each line's part begins, and that line

    def line_at(self, position: int) -> Line:
        """Return the line that a position of the text is on."""
        return next(line for start, line in reversed(self.lines) if start <= position)

    def error(self, message: str, word: str, position: int) -> ShaderError:
        """Return an error that points at a word of the note, at or before a position."""
        line = self.line_at(position)
        return line.error(message, line.text.find(word) + 1)


def note_at(lines: Sequence[Line], index: int) -> Note:
    """Return the annotation that begins on a line, with the lines after it that hold ``//!`` alone."""
    text, comments = "", list[tuple[int, Line]]()
    for line in lines[index:]:
        goes_on = not line.code and line.file == lines[index].file and line.chain == lines[index].chain
        if not line.comment.startswith("!") or (comments and not goes_on):
            break
        text += " " if comments else ""
        comments.append((len(text), line))
        text += line.comment[1:].strip()
    return Note(text, tuple(comments) or ((0, lines[index]),))


def arguments(text: str, line: Line) -> list[Argument]:
    """Split the text in brackets at its commas; texts lose their quotes. Raises ``ShaderError``."""
    result: list[Argument] = []
    position, end = 0, len(text.rstrip())
    while position < end:
        match = _ARGUMENT.match(text, position, end)
        if not match or not match.group(2).strip():
            rest = text[position:end].strip()
            raise line.error(f"cannot read '{rest}'; expected values separated by commas, text in quotes")
        raw = match.group(2).strip()
        if raw.startswith('"'):
            raw = re.sub(r"\\(.)", r"\1", raw[1:-1])
        result.append((match.group(1) or "", raw))
        position = match.end()
    return result


def annotation_calls(
    note: Note, words: Collection[str], bare: Collection[str]
) -> tuple[dict[str, list[str]], str]:
    """Return (the calls of a note with their arguments, the tooltip that follows them).

    ``words`` may be called; those of ``bare`` need no brackets as the first word.
    Raises ``ShaderError`` for a word in brackets that is nearly one of ``words``.
    """
    names: dict[str, list[str]] = {}
    position = 0
    while match := _WORD.match(note.text, position):
        word, opens, start = match.group(1), bool(match.group(2)), match.start(1)
        if word not in words:
            hint = nearest(word, words) if opens else ""
            if opens and (position == 0 or "did you mean" in hint):
                raise note.error(f"no widget '{word}'{hint}", word, start)
            break
        if not opens:
            if position or word not in bare:
                break
            names[word] = []
            position = match.end()
            continue
        if word in names:
            raise note.error(f"'{word}' appears twice", word, start)
        end = _closing(note.text, match.end())
        if end < 0:
            raise note.error(f"'{word}(' is not closed", word, start)
        pairs = arguments(note.text[match.end() : end], note.line_at(start))
        for name, _ in pairs:
            if name:
                raise note.error(f"{word}() takes no '{name} ='", word, start)
        names[word] = [value for _, value in pairs]
        position = end + 1
    return names, note.text[position:].strip()


def _closing(text: str, position: int) -> int:
    """Return where a bracket closes, brackets in quotes apart; -1 if it does not."""
    while position < len(text):
        if text[position] == ")":
            return position
        string = _STRING.match(text, position)
        position = string.end() if string else position + 1
    return -1


FALLBACKS = ("white", "black", "zero")
"""What an input reads where nothing is wired: "zero" is black with alpha 0, and a loop's first iteration
reads zeros of the size of what is fed back."""
_PRECISIONS = frozenset({"lowp", "mediump", "highp"})
_IMAGES = frozenset(f"{kind}image{n}D" for kind in ("", "i", "u") for n in (1, 2, 3))
_FLOAT = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eEfF]))(?:[eE][-+]?\d+)?[fF]?")
_WHOLE = re.compile(r"([-+]?)(?:0[xX]([0-9a-fA-F]+)|(\d+))[uU]?")
_VECTOR = re.compile(r"([iu]?vec[234])\s*\((.*)\)", re.DOTALL)
_MAX_LITERAL = 64

_TYPES = frozenset(SCALARS + VECTORS)
_ROLES = WIDGETS.keys() - {"number"} | {"input"}
_BARE = frozenset(word for word in _ROLES if word == "input" or WIDGETS[word].bare)
MODIFIERS = frozenset({"step", "unit", "group", "label", "parts", "values", "follows", "erode", "preview"})
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
        declared = _declared(line.code, plain=plain)
        if not plain:
            _check_declaration(line, is_declared=declared is not None)
        if declared is None:
            continue
        glsl_type, name, array, initial = declared
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
        calls, tooltip = annotation_calls(note_at(source.lines, index), _ROLES | MODIFIERS, _BARE)
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
        rule = read_follows(parameters[number], words, parameters, line)
        parameters[number] = replace(parameters[number], follows=rule)
    return tuple(parameters), tuple(inputs)


def unfed_samplers(source: SourceText) -> tuple[Diagnostic, ...]:
    """Return a warning for each sampler of a plain shader that no image file feeds: it reads black."""
    fed = {p.name for p in read_uniforms(source, plain=True)[0] if p.type == "sampler2D"}
    diagnostics: list[Diagnostic] = []
    for line in source.lines:
        kind, before = "", ""
        for token in tokenize(line.code)[0] if "sampler" in line.code else ():
            if before == "uniform" and "sampler" in token.text:
                kind = token.text
            elif kind and before in (kind, ",") and token.text not in fed:
                example = f'uniform sampler2D {token.text};  //! file("picture.png")'
                more = f"an image file does: {example}"
                if kind != "sampler2D":
                    more = "only a sampler2D may be fed"
                message = f"nothing feeds '{token.text}', so it reads black; {more}"
                diagnostics.append(line.diagnostic(message, token.start + 1, "warning"))
            kind = "" if token.text == ";" else kind
            before = before if token.text in _PRECISIONS else token.text
    return tuple(dict.fromkeys(diagnostics))


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
    raise line.error(message, place_of(line.code, name) + 1)


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
        replacement = GIVEN_INSTEAD[name]
        raise line.error(f"{wrong}; did you mean '{replacement}'? It is given: take this line out", column)
    raise line.error(f"{wrong}; an annotation makes it a parameter, as //! point for a vec2", column)


def _declared(code: str, *, plain: bool) -> tuple[str, str, str, str | None] | None:
    """Return type, name, array and initial value of the uniform that a line declares; None for none.

    Of a ``plain`` shader it may have a layout.
    """
    tokens = tokenize(code)[0]
    texts = [*(token.text for token in tokens), *[""] * 4]
    at = texts.index(")") + 1 if plain and texts[:2] == ["layout", "("] and ")" in texts else 0
    if texts[at] != "uniform":
        return None
    at += 2 if texts[at + 1] in _PRECISIONS else 1
    kind, name = texts[at : at + 2]
    at += 2
    array, initial = "", None
    if texts[at] == "[" and "]" in texts[at:]:
        first, at = at, texts.index("]", at) + 1
        array = code[tokens[first].start : tokens[at - 1].end]
    if texts[at] == "=" and ";" in texts[at:]:
        first, at = at, texts.index(";", at)
        initial = code[tokens[first].end : tokens[at].start]
    is_whole = texts[at] == ";" and kind.isidentifier() and name.isidentifier()
    return (kind, name, array, initial) if is_whole else None


def _check_declaration(line: Line, *, is_declared: bool) -> None:
    if is_declared and line.code.count("uniform") == 1:
        return
    texts = [token.text for token in tokenize(line.code)[0]]
    if texts.count("uniform") == is_declared or not _IMAGES.isdisjoint(texts):
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
        brush=Brush(_text(calls, "erode", line)) if "paint" in words else None,
        **_described(calls, tooltip, line),
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
        expected = " or ".join(fits) if len(fits) <= 3 else "numbers"
        raise line.error(f"{kind} is for {expected}; '{name}' is a {glsl_type}")
    step = _numbers(name, "step", calls["step"], 1, line)[0] if "step" in calls else None
    if step is not None and step <= 0:
        raise line.error(f"step of '{name}': expected a number above 0")
    widget = _widget(name, kind, calls.get(kind, []), line)
    parameter = Parameter(
        name,
        glsl_type,
        0,
        replace(widget, values=_menu_values(name, widget, calls, line)),
        step,
        _text(calls, "unit", line),
        parts=_parts(name, glsl_type, kind, calls, line),
        **_described(calls, tooltip, line),
    )
    default = _literal(name, glsl_type, initial, line)
    if numbers := parameter.widget.values:
        if default not in numbers:
            listed = ", ".join(map(str, numbers))
            raise line.error(f"the default of '{name}' is {default}; its menu's values are {listed}")
        default = numbers.index(default)
    if kind == "button" and default:
        raise line.error(f"the default of '{name}' must be false: a button is true while it is pressed")
    try:
        parameter = replace(parameter, default=values.coerce(parameter, default))
    except ParameterError as error:
        raise line.error(f"the default of {error.diagnostics[0].message}") from None
    return replace(parameter, widget=replace(parameter.widget, preview=_preview(parameter, calls, line)))


def _parts(name: str, glsl_type: str, kind: str, calls: Calls, line: Line) -> tuple[str, ...]:
    """Return the names of a vector's components, one each."""
    parts = tuple(calls.get("parts", ()))
    count = values.length_of(glsl_type)
    if not parts:
        return ()
    facts = WIDGETS[kind]
    if facts.control != "numbers" or not facts.has_vectors:
        raise line.error(f"parts is for a vector of numbers; '{name}' is a {kind}")
    if count == 1 or len(parts) != count or len(set(parts)) < count or not all(parts):
        example = ", ".join(f'"{part}"' for part in ("west", "east", "south", "north")[:count])
        expected = f"{count} different names, as parts({example})" if count > 1 else "a vector"
        raise line.error(f"parts of '{name}', a {glsl_type}: expected {expected}")
    return parts


def _preview(parameter: Parameter, calls: Calls, line: Line) -> Value | None:
    """Return the choice of a menu, or the number, that previews have; None for what is the same there."""
    if "preview" not in calls:
        return None
    result = calls["preview"]
    if parameter.widget.facts.takes not in ("choices", "range") or len(result) != 1:
        example = 'preview("fast"), or a slider\'s number'
        raise line.error(f"preview of '{parameter.name}': expected one choice of a menu, as {example}")
    try:
        return values.coerce(parameter, result[0])
    except ParameterError as error:
        raise line.error(f"the preview of {error.diagnostics[0].message}") from None


def _menu_values(name: str, widget: Widget, calls: Calls, line: Line) -> tuple[int, ...]:
    """Return what the uniform gets for each choice of a menu; nothing where that is the choice's number."""
    if "values" not in calls:
        return ()
    numbers_read = [_number(word, fractions=False) for word in calls["values"]]
    numbers = tuple(n for n in numbers_read if isinstance(n, int) and -(2**31) <= n < 2**31)
    if widget.kind != "menu" or len(numbers) != len(widget.choices) or len(numbers_read) != len(numbers):
        expected = f"{len(widget.choices)} whole numbers" if widget.choices else "a menu before it"
        raise line.error(f'values of \'{name}\': expected {expected}, as menu("soft", "hard") values(1, 4)')
    return numbers


def _widget(name: str, kind: str, arguments: list[str], line: Line) -> Widget:
    facts = WIDGETS[kind]
    if facts.takes == "range" or (facts.takes == "range or nothing" and arguments):
        low, high = _numbers(name, kind, arguments, 2, line)
        if facts.is_log and low <= 0:
            raise line.error(f"{kind} of '{name}': its range must lie above 0")
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
        expected = "" if fractions else "whole "
        raise line.error(f"the initialiser of '{name}' must be a {expected}literal, found {text}", column)
    components = [math.trunc(n) if values.is_whole(glsl_type) else n for n in numbers if n is not None]
    return components if length > 1 else components[0]


def _number(text: str, *, fractions: bool) -> float | int | None:
    """Read a number as GLSL writes it: 0x1F and 017 have the bases 16 and 8."""
    if len(text) > _MAX_LITERAL:
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


def read_follows(
    parameter: Parameter, words: Sequence[str], parameters: Iterable[Parameter], line: Line
) -> Follows:
    """Return what an annotation's ``follows(…)`` says; raise ``ShaderError`` where it cannot be."""

    def wrong(message: str) -> ShaderError:
        return line.error(f"follows of '{parameter.name}': {message}")

    if parameter.widget.kind != "angle" or len(words) not in (1, 3):
        raise wrong(
            'an angle follows a direction, as follows("sun"), '
            'or while a menu has a choice, as follows("sun", "form", "near")'
        )
    by_name = {p.name: p for p in parameters}
    directions = [name for name, p in by_name.items() if p.widget.kind == "direction"]
    if words[0] not in directions:
        raise wrong(f"no direction '{words[0]}' here{nearest(words[0], directions)}")
    if len(words) == 1:
        return Follows(words[0])
    menus = {name: p.widget.choices for name, p in by_name.items() if p.widget.kind == "menu"}
    if words[1] not in menus:
        raise wrong(f"no menu '{words[1]}' here{nearest(words[1], menus)}")
    choices = menus[words[1]]
    if words[2] not in choices:
        raise wrong(f"'{words[1]}' has no choice '{words[2]}'{nearest(words[2], choices)}")
    return Follows(words[0], words[1], choices.index(words[2]))


_OWN_NAME = re.compile(rf"^\S+(?:{'|'.join(map(re.escape, SHADERS))})\s*(?:--|—|–|:)\s*")
_MAX_TITLE = 72
_IMAGE_DECLARATION = re.compile(
    r"layout\s*\(([^)]*)\)\s*(?:(?:writeonly|readonly|restrict|coherent|volatile)\s+)*"
    r"uniform\s+(?:\w+\s+)*image2D\s+(\w+)"
)
_NAME = re.compile(r"(?<![\w.])[A-Za-z_]\w*(?![\w.]|\s*:)")
_NUMBERS = ("float", "int", "uint", "bool")
"""Types of the parameters that an expression may name."""
_NOT_IN_WHERE = ("size", "if", "else", "and", "or", "not", "log2", "min", "max", "abs", "floor", "ceil")


def parse_kernel(name: str, source: SourceText) -> Kernel | None:
    """Return what a GLSL file declares; None for a library file, which declares nothing to run.

    Raises ``ShaderError`` naming file and line for each mistake in the header.
    """
    outermost = [line for line in source.lines if not line.chain]
    lines = [line for line in outermost if line.pragma]
    versions = [line for line in outermost if directive(line.code)[0] == "version"]
    if versions and not lines:
        return _plain_shader(name, source, versions[0])
    _refuse_misspelt(outermost)
    if not lines:
        return None
    if versions:
        raise versions[0].error(
            "a kernel has no #version of its own; only a plain shader, without #pragma, has one"
        )
    if len(lines) > 1:
        raise lines[1].error("a second #pragma; a file is one kernel, one source or one draw")
    line = lines[0]
    word, options = directive(f"#{directive(line.pragma)[1]}")
    kind = PRAGMAS[word]
    texts = _texts(kind, options, line)
    _refuse_redefined(source)
    parameters, inputs = read_uniforms(source)
    texts = _with_names_replaced(kind, texts, parameters, line)
    outputs = _outputs(texts["output"], line) if "output" in texts else ()
    for output in outputs:
        for parameter in parameters:
            if parameter.name == output.name:
                at = parameter.file, parameter.line
                position = next(x for x in source.lines if (x.file, x.number) == at)
                raise position.error(f"'{output.name}' is both an output and a parameter")
    numbers = tuple(p.name for p in parameters if p.type in _NUMBERS)
    values = _values(kind, texts, Scope(numbers, tuple(declared.name for declared in inputs)), line)
    kernel = kind(name, source, outputs, parameters, inputs, title_of(source), **values)
    for row, _ in kernel.options:
        if complaint := row.check(kernel):
            raise line.error(complaint)
    if isinstance(kernel, CpuSource):
        _refuse_code(source)
    elif isinstance(kernel, TexelKernel):
        _refuse_driver_bound(source)
    return kernel


def _values(kind: type[Kernel], texts: Mapping[str, str], scope: Scope, line: Line) -> dict[str, Any]:
    """Return the values of a pragma's options, by the fields of its kernel."""
    result: dict[str, Any] = {}
    records: dict[str, dict[str, Any]] = {}  # field with a record → the fields in it
    for name, row in options_of(kind).items():
        if not row.attribute or name not in texts:
            continue
        try:
            value = row.parse(name, texts[name], scope)
        except ValueError as error:
            raise line.error(str(error)) from None
        record, _, attribute = row.attribute.rpartition(".")
        (records.setdefault(record, {}) if record else result)[attribute] = value
    return result | {record: RECORDS[record](**fields) for record, fields in records.items()}


def title_of(source: SourceText) -> str:
    """Return the sentence that a file begins with, without its own name, as a heading."""
    for line in source.lines:
        if line.chain or line.pragma or directive(line.code)[0] == "version":
            continue
        if line.code.strip() or line.comment.startswith("!"):
            break
        text = _OWN_NAME.sub("", line.comment.strip())
        if any(letter.isalnum() for letter in text):
            return _titled(text)
    return ""


def _titled(text: str) -> str:
    """Return a message as a heading: no full stop, a capital, of a long one the part before its colon."""
    if len(text) > _MAX_TITLE:
        text = text.partition(": ")[0]
    text = text.removesuffix(".")
    # Not sRGB or iTime, which are spelt so.
    return text[:1].upper() + text[1:] if text.partition(" ")[0].islower() else text


def _plain_shader(name: str, source: SourceText, version: Line) -> Kernel:
    is_compute = source.path.endswith(".comp") or "local_size_x" in source.names
    if source.line_naming("main", called=True) is None:
        raise version.error("a shader with its own #version needs its own main()")
    usual = {n for names in PLAIN_UNIFORMS.values() for n in names}
    parameters, _ = read_uniforms(source, plain=True, skip=usual)
    title = title_of(source)
    if not is_compute:
        return PlainFragment(name, source, (Output("frame", "rgba8"),), parameters, title=title)
    image = _IMAGE_DECLARATION.search(source.code)
    if not image:
        example = "layout(rgba8, binding = 0) uniform image2D picture;"
        raise version.error(f"a plain compute shader needs an image2D to write, as {example}")
    formats = [w.strip() for w in image.group(1).split(",") if w.strip() in FORMATS]
    if not formats:
        raise version.error(f"the image {image.group(2)} needs a format; there are: {', '.join(FORMATS)}")
    texts = [token.text for token in tokenize(source.code)[0]]
    sizes = {name: size for name, sign, size in zip(texts, texts[1:], texts[2:], strict=False) if sign == "="}
    given = [sizes.get(f"local_size_{axis}", "1") for axis in "xy"]
    local = int(given[0]) if given[0].isdecimal() else 1, int(given[1]) if given[1].isdecimal() else 1
    if min(local) < 1:
        raise version.error("local_size_x and local_size_y should be 1 or more")
    return PlainCompute(name, source, (Output("frame", formats[0]),), parameters, title=title, local=local)


def _texts(kind: type[Kernel], text: str, line: Line) -> dict[str, str]:
    """Return the texts of a pragma's options, by name; those of required ones at least."""
    pragma, text, rows = f"#pragma {kind.kind}", text.strip(), options_of(kind)
    if not text.startswith("(") or not text.endswith(")"):
        raise line.error(f"{pragma} needs its options in brackets, as {pragma}{kind.example}")
    texts: dict[str, str] = {}
    for key, value in arguments(text[1:-1], line):
        if not key:
            key = next((name for name, row in rows.items() if row.positional and name not in texts), "")
        if key not in rows:
            what = f"has no option '{key}'" if key else f"cannot tell what '{value}' is for"
            raise line.error(f"{pragma} {what}{nearest(key, rows)}")
        if key in texts:
            raise line.error(f"{pragma} gives '{key}' twice")
        texts[key] = value
    for name, row in rows.items():
        for other in row.excludes if name in texts else ():
            if other in texts:
                raise line.error(f"{name} and {other}: a kernel has one or the other; leave {other} out")
        if row.required and not texts.get(name):
            raise line.error(f"{pragma} needs {row.required}")
        if not row.attribute and row.default:
            texts.setdefault(name, row.default)
    return texts


def _with_names_replaced(
    kind: type[Kernel], texts: dict[str, str], parameters: Sequence[Parameter], line: Line
) -> dict[str, str]:
    """Replace the names that ``where`` gives to expressions, in the options that are expressions."""
    names = [parameter.name for parameter in parameters]
    numbers = [parameter.name for parameter in parameters if parameter.type in _NUMBERS]
    valid = (*SIZE, *expressions.COUNTERS, *expressions.CLOCKS, *numbers)
    meant: dict[str, str] = {}
    for part in filter(None, (p.strip() for p in texts.get("where", "").split(";"))):
        name, equals, text = (piece.strip() for piece in part.partition("="))
        if not equals or not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            example = "half = size.x // 2 (several separated by ;)"
            raise line.error(f"where '{part}': expected name = expression, as {example}")
        if name in valid or name in meant or name in _NOT_IN_WHERE or name in names:
            raise line.error(f"where: the name '{name}' is taken")
        text = _replaced(text, meant)
        try:
            check_expression(f"where '{name}'", text, valid)
        except ValueError as error:
            raise line.error(str(error)) from None
        meant[name] = f"({text})"
    rows = options_of(kind)
    return {n: _replaced(text, meant) if rows[n].expressions else text for n, text in texts.items()}


def _replaced(text: str, meant: dict[str, str]) -> str:
    # Not a component, as the x of size.x; nor the name or the type of a buffer, which colons follow.
    return _NAME.sub(lambda match: meant.get(match.group(), match.group()), text)


def _outputs(text: str, line: Line) -> tuple[Output, ...]:
    outputs: list[Output] = []
    for part in text.split(","):
        name, _, form = (piece.strip() for piece in part.partition(":"))
        if not re.fullmatch(r"[A-Za-z_]\w*", name, re.ASCII):
            raise line.error(f"output '{part.strip()}': expected name:format, as height:r32f")
        if form not in FORMATS:
            raise line.error(f"output '{name}' has no format '{form}'{nearest(form, FORMATS)}")
        if name in [o.name for o in outputs]:
            raise line.error(f"output '{name}' appears twice")
        check_name(name, line, "output")
        outputs.append(Output(name, form))
    if len(outputs) > 8:
        raise line.error(f"{len(outputs)} outputs; OpenGL promises no more than 8")
    return tuple(outputs)


def _refuse_misspelt(lines: list[Line]) -> None:
    for line in lines:
        word, rest = directive(line.code)
        word, options = directive(f"#{rest}") if word == "pragma" else ("", "")
        hint = nearest(word, PRAGMAS) if options.startswith("(") else ""
        if "did you mean" in hint:
            raise line.error(f"no #pragma '{word}'{hint}")


def _refuse_redefined(source: SourceText) -> None:
    if "define" not in source.names:
        return
    for line in source.lines:
        if "define" in line.code:
            word, rest = directive(line.code)
            name = directive(f"#{rest}")[0]
            if word == "define" and is_given(name):
                check_name(name, line, "macro")


def _refuse_code(source: SourceText) -> None:
    """Refuse code in a source's file: no driver is given it, so that a mistake in it would never show."""
    for line in source.lines:
        code = line.code.strip()
        is_uniform = code.split(maxsplit=1)[:1] == ["uniform"] and code.find(";") == len(code) - 1
        if code and not code.startswith("#") and not is_uniform:
            message = "a source's file has parameters only, and nothing runs this code; take it out"
            raise line.error(message, len(line.code) - len(line.code.lstrip()) + 1)


def _refuse_driver_bound(source: SourceText) -> None:
    if not any(name in DRIVER_BOUND or name.startswith("gl_") for name in source.names):
        return
    for line in source.lines:
        for token in as_written(line.code):
            word = token.text
            if word in DRIVER_BOUND:
                raise line.error(f"a kernel may not use '{word}': {DRIVER_BOUND[word]}", token.start + 1)
            if word.startswith("gl_"):
                raise line.error(f"a kernel may not use '{word}': its texel is an argument", token.start + 1)


# ── parsed kernels, cached ───────────────────────────────────────────────────
#
# A live session reads its sketch again at every save, and most of its kernels have not changed; parsing
# them all again would take longer than drawing. A cached kernel is also the same object, by whose
# identity other caches go.

_AnyKernel = TypeVar("_AnyKernel", bound=Kernel)


def parsed_kernel(name: str, path: Path, roots: Sequence[Path]) -> Kernel | None:
    """Return what ``parse_kernel`` makes of a file, parsed again only if anything it is made of changed."""
    key = (parsed_kernel, name, path, tuple(roots))
    cached: tuple[Kernel | None, Origin] | None = FILES.get(key)
    if cached is None or not cached[1].holds():
        source, origin = read_source_and_origin(path, roots)
        cached = FILES.put(key, (parse_kernel(name, source), origin))
    return cached[0]


def replaced(kernel: _AnyKernel, **changes: Any) -> _AnyKernel:
    """Return a kernel with some fields replaced: the same object for the same kernel and changes."""
    key = (replaced, id(kernel), *((name, _identity(value)) for name, value in changes.items()))
    cached: _AnyKernel | None = GRAPHS.get(key)
    # What it is made of is held too, so that its identity is not given to another object.
    return cached or cast(_AnyKernel, GRAPHS.put(key, replace(kernel, **changes), 1, kernel, changes))


def _identity(value: Any) -> Any:
    """Return what a value is known by: kernels are large, so those of fast variants by which they are.

    Passes of a variant are read again with each sketch, so they are known by what they are made of.
    """
    if isinstance(value, tuple):
        return tuple(_identity(element) for element in value)
    if not isinstance(value, Variant):
        return value
    technique = id(value.technique) if isinstance(value.technique, Kernel) else value.technique
    return technique, value.verified, value.record

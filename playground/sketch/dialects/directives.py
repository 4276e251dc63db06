"""Read the lines that the VS Code extension Shader Toy knows: ``#iChannel0``, ``#iUniform``, ``#iKeyboard``.

A driver is given a uniform in the place of ``#iUniform`` and nothing in that of the others; that the
keyboard is asked for stays as a pragma, which ``rewritten`` takes away.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field, replace

from playground.errors import nearest
from playground.sketch.model import Sampling
from playground.sketch.source import Line, SourceText
from playground.sketch.values import spell

KEYBOARD = "iKeyboard"
MOST_CHANNELS = 10

_STRICT = "StrictCompatibility"  # mainImage is what runs: so it is here wherever a text has one
_DIRECTIVE = re.compile(rf"\s*#\s*(i[A-Z]\w*|{_STRICT})\b(.*)", re.DOTALL)
_ASKS_FOR_KEYS = f"#pragma {KEYBOARD}"
_CHANNEL = re.compile(r'\s*#\s*iChannel(\d)\s*(?:::\s*(\w+)\s*)?(["\'])(.*?)\3')
_UNIFORM = re.compile(
    r"\s*(\w+)\s+([A-Za-z_]\w*)\s*(?:=\s*(.+?)\s*)?(?:\bin\s*\{\s*([^,{}]+),\s*([^,{}]+)\})?"
    r"\s*(?:\bstep\s+(\S+))?\s*;?\s*$"
)
_NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_COLOURS = {"color3": "vec3", "color4": "vec4"}
_TYPES = ("float", "int", "uint", "bool", *(f"{kind}vec{n}" for kind in ("", "i", "u") for n in (2, 3, 4)))
_FILTERS = (
    "Nearest", "Linear", "NearestMipMapNearest", "NearestMipMapLinear", "LinearMipMapNearest",
    "LinearMipMapLinear",
)  # fmt: skip
_NOT_DONE = {
    "iFirstPersonControls": ": no key moves a camera here, so iViewMatrix stays the identity",
    "iVertex": ": no vertex shader is run here, so the picture is drawn over the whole view",
    "iSound": " is sound, which is not drawn",
}
"""What is not as in the extension, by directive: the rest of a sentence."""
_CHOICES = {
    "MinFilter": _FILTERS,
    "MagFilter": ("Nearest", "Linear"),
    "WrapMode": ("Clamp", "Repeat", "Mirror"),
    "Type": ("Texture2D", "CubeMap"),
}


@dataclass
class Channel:
    """What the lines of one channel say."""

    line: Line  # the first of them
    path: str = ""  # "file://x.png", "self"; "" where no line says it
    settings: dict[str, str] = field(default_factory=dict)  # MinFilter, MagFilter, WrapMode, Type

    @property
    def is_cube(self) -> bool:
        """Whether it is a cube map."""
        return self.settings.get("Type") == "CubeMap"

    def sampling(self, usual: Sampling) -> Sampling:
        """Return how it is read; what no line says is as ``usual``."""
        least, most = self.settings.get("MinFilter", ""), self.settings.get("MagFilter", "")
        wrap = self.settings.get("WrapMode", "")
        found = replace(usual, wrap=wrap.lower()) if wrap else usual
        if least:
            form = "nearest" if least.startswith("Nearest") else "linear"
            found = replace(found, filter=form, mipmap="MipMap" in least)
        return replace(found, magnify=most.lower()) if most else found


@dataclass(frozen=True)
class Read:
    """A text without its directives, and what they say."""

    source: SourceText
    channels: dict[int, Channel]
    notes: tuple[tuple[Line, str], ...]  # lines, and what is not as in the extension


def read_directives(source: SourceText) -> Read:
    """Read the directives of a text; raise ``ShaderError`` at a line that cannot be understood."""
    channels: dict[int, Channel] = {}
    notes: list[tuple[Line, str]] = []
    lines = []
    for line in source.lines:
        match = _DIRECTIVE.match(line.code)
        if match is None:
            lines.append(line)
        elif match.group(1).startswith("iChannel"):
            _channel(line, channels)
            lines.append(replace(line, code=""))
        elif match.group(1) == "iUniform":
            lines.append(_uniform(line, match.group(2)))
        elif match.group(1) == KEYBOARD:
            lines.append(replace(line, code=_ASKS_FOR_KEYS))
        else:
            name = match.group(1)
            if name != _STRICT:
                notes.append((line, f"#{name}{_NOT_DONE.get(name, ' is not known here, and does nothing')}"))
            lines.append(replace(line, code=""))
    return Read(SourceText(source.path, tuple(lines), source.files), channels, tuple(notes))


def has_keyboard(source: SourceText) -> bool:
    """Return whether a text, with what is included and common, asks for the keyboard."""
    return any(line.code == _ASKS_FOR_KEYS for line in source.lines)


def _channel(line: Line, channels: dict[int, Channel]) -> None:
    match = _CHANNEL.match(line.text)
    if match is None:
        raise line.error('expected #iChannel0 "file://picture.png", or #iChannel0::WrapMode "Repeat"')
    number, name, text = int(match.group(1)), match.group(2), match.group(4)
    channel = channels.setdefault(number, Channel(line))
    if not name:
        channel.path, channel.line = text, line
        return
    setting = next((known for known in _CHOICES if known.lower() == name.lower()), None)
    if setting is None:
        raise line.error(
            f"#iChannel{number} has no '{name}'{nearest(name, _CHOICES)}", line.text.find(name) + 1
        )
    value = next((known for known in _CHOICES[setting] if known.lower() == text.lower()), None)
    if value is None:
        wrong = f"{setting} of #iChannel{number}: no '{text}'{nearest(text, _CHOICES[setting])}"
        raise line.error(wrong, line.text.find(text) + 1)
    channel.settings[setting] = value


def _uniform(line: Line, text: str) -> Line:
    """Return a line that declares a parameter as ours do, with a ``//!`` annotation."""
    match = _UNIFORM.match(text)
    if match is None:
        example = "#iUniform float size = 1.0 in { 0.0, 5.0 } step 0.1"
        raise line.error(f"cannot read this #iUniform; expected as {example}")
    kind, name, initial, low, high, step = match.groups()
    if kind not in (*_TYPES, *_COLOURS):
        hint = nearest(kind, (*_TYPES, *_COLOURS))
        raise line.error(f"#iUniform of the type '{kind}'{hint}", line.text.find(kind) + 1)
    glsl = _COLOURS.get(kind, kind)
    bounds = [_float(line, word) for word in (low, high)] if low else []
    value = _initial(line, kind, glsl, initial, bounds)
    calls = ["colour"] if kind in _COLOURS else []
    if len(bounds) == 2 and bounds[0] < bounds[1] and kind not in _COLOURS and glsl != "bool":
        calls.append(f"slider({bounds[0]:g}, {bounds[1]:g})")
    if step and glsl != "bool" and (size := _float(line, step)) > 0:
        calls.append(f"step({size:g})")
    note = " ".join(["!", *calls, line.comment.strip()])
    return replace(line, code=f"uniform {glsl} {name}{value};", comment=note)


def _initial(line: Line, kind: str, glsl: str, initial: str | None, bounds: list[float]) -> str:
    """Return " = value" in GLSL, within the bounds; "" where there is none."""
    if initial is None:
        return ""
    if glsl == "bool" or not (bounds or glsl != kind or "vec" in glsl):
        return f" = {initial}"
    numbers = initial.partition("(")[2] if "(" in initial else initial
    given = [_float(line, number) for number in _NUMBER.findall(numbers)]
    if len(bounds) == 2 and bounds[0] < bounds[1]:
        given = [min(max(number, bounds[0]), bounds[1]) for number in given]
    whole = glsl in ("int", "uint") or glsl.startswith(("i", "u"))
    texts = [str(int(number)) if whole else repr(number) for number in given]
    if "vec" not in glsl:
        return f" = {texts[0] if texts else initial}"
    return f" = {glsl}({', '.join(texts)})"


def _float(line: Line, text: str) -> float:
    text = text.strip()
    try:
        number = float(text.rstrip("fF"))
    except ValueError:
        number = math.nan
    if not abs(number) < 1e30:
        raise line.error(f"expected a number, not {spell(text)}", line.text.find(text) + 1)
    return number

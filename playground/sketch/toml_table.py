"""Checked access to a TOML file's tables: each mistake has a line; the keys, each with its meaning.

What reads the tables takes the keys that it knows from here, and so does what completes and explains
them in an editor; `docs/reference/sketch-file.md` says more of each.
"""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import Any

from playground.errors import Diagnostic, SketchError, nearest
from playground.json_text import long_number
from playground.memo import TEXTS
from playground.paths import shown
from playground.shader.parameter import spell
from playground.shader.source import read_text
from playground.sketch.toml_text import KeyPath, TomlPlaces

SKETCH: dict[str, str] = {
    "format": "Version of the format: 1.",
    "title": "Title, a text; the file's name without it.",
    "pass": "A pass: one technique, its inputs and its values.",
    "base_elevation": "Metres above sea level at height 0; from the elevation file without it.",
    "extent": "Metres from the first texel to the last, a number or [east, north]; from the elevation file.",
    "keyframe": "Values and a camera at a time.",
    "main": 'Paths of the parameters that the sketch is about, as ["height.seed", "light.sun"].',
    "preset": "Values that go together, under a name.",
    "relief": "Metres from height 0 to height 1; from the elevation file without it.",
    "shot": "A picture that the sketch promises: a test compares it with its reference.",
    "size": "Texels of a pass that says no other, a number or [x, y]; from the elevation file without it.",
    "view": "The technique that gives the frame, and the camera.",
}
"""At the head of a sketch."""

TECHNIQUE: dict[str, str] = {
    "format": SKETCH["format"],
    "title": SKETCH["title"],
    "pass": SKETCH["pass"],
    "parameters": 'What may be set from outside: name → a path inside, or a list of them; "*" = "*" for all.',
    "inputs": "Inputs wired from outside: name → inputs of passes inside, a path or a list of them.",
    "outputs": 'What it gives: name → "pass:output"; without it what the last pass gives.',
}
"""At the head of a technique of several passes."""

VARIANT: dict[str, str] = {
    "agrees": "How closely a fast variant's outputs agree with the technique's.",
}
"""Besides these, at the head of a fast variant of several passes."""

PASS: dict[str, str] = {
    "name": "Letters, digits and _; not view.",
    "use": 'A technique: "generation/mixed", or "./x" of the sketch\'s own folder, without ending.',
    "inputs": 'Input → "pass", "pass:output" or "pass.inner:output".',
    "set": "Parameter → value.",
    "size": 'Texels, an expression or two, as "height.size // 2"; of the technique\'s own without it.',
    "repeat": "How often a technique of several passes runs, a number or an expression; needs feedback.",
    "feedback": "Input → its own output, which it reads from the second step on.",
}

VIEW: dict[str, str] = {
    "use": "The technique that gives the frame; view/terrain without it.",
    "inputs": PASS["inputs"],
    "set": PASS["set"],
    "camera": "Where the eye is: azimuth, elevation, distance, target, field_of_view.",
    "samples": "Antialiasing of draws: 1, 2, 4 or 8 samples a pixel; 4 without it.",
    "supersample": "Rendered pictures are drawn n times as wide and high, 1 to 8; not in the window.",
    "above_ground": "An eye under the terrain is raised to just above it; false leaves it there.",
}

CAMERA: dict[str, str] = {
    "azimuth": "Degrees clockwise from north: direction from the target to the eye; 200 without it.",
    "elevation": "Degrees of the eye above the target's horizon, −89 to 89; 32 without it.",
    "distance": "Metres from the target; 0 shows the whole terrain.",
    "target": "What the eye looks at, [east, north, up] in metres; the middle without it.",
    "field_of_view": "Vertical, in degrees, 5 to 120; 35 without it.",
}

PRESET: dict[str, str] = {"name": "A name of its own.", "set": "Path of a parameter → value."}

SHOT: dict[str, str] = {
    "name": "Letters, digits, _ and -.",
    "size": "[width, height] in pixels; [640, 360] without it.",
    "time": "Seconds; 0 without it.",
    "camera": "A camera of its own; the view's without it.",
    "set": PRESET["set"],
    "preset": "A preset to begin with, by its name.",
    "samples": "Samples a pixel; the view's without it.",
    "supersample": VIEW["supersample"],
    "steps": "Repeated pass → the step to stop at.",
    "marks": 'Names of pytest\'s markers, as ["slow"].',
    "tolerance": 'What may differ: "rounding", "edges", "noise", levels, or { levels = 6, share = 0.01 }.',
    "reason": "Why the tolerance is needed; required with one.",
    "mask": "Areas not compared: [x, y, width, height], a PNG or texture that is light there, or several.",
    "allow_blank": "Whether a picture of one colour may be right; false without it.",
}

KEYFRAME: dict[str, str] = {
    "time": "Seconds.",
    "camera": "A camera at that time.",
    "set": PRESET["set"],
    "ease": "How values go on to the next keyframe: smooth, linear or hold.",
}

TABLES: dict[str, dict[str, str]] = {
    "pass": PASS,
    "view": VIEW,
    "preset": PRESET,
    "shot": SHOT,
    "keyframe": KEYFRAME,
    "camera": CAMERA,
}
"""By the key that holds the table."""

LISTS = ("pass", "preset", "shot", "keyframe")
"""Tables of which there may be several: [[pass]]."""


FORMAT = 1

_AT = re.compile(r"\s*\(at line (\d+), column (\d+)\)$")
_NOUNS = {
    str: "text in quotes",
    dict: "a table",
    list: "a list",
    int: "a whole number",
    float: "a finite number",
    bool: "true or false",
}


@TEXTS.cached()
def _places_in(text: str) -> TomlPlaces:
    """Return where everything is in a text: once, for a sketch is loaded again at every save."""
    return TomlPlaces(text)


_table_of = TEXTS.cached()(tomllib.loads)  # once, likewise


class TomlFile:
    """One TOML file being read; a place in it is keys and numbers, as ``"pass", 0, "use"``."""

    def __init__(self, path: Path, root: Path, text: str | None = None, before: int = 0) -> None:
        """Read ``path``; ``root`` is the folder that what it names must stay in.

        ``text`` is the part of the file that is TOML, where not all of it is, and ``before`` how
        many lines come before that part. Raises ``SketchError`` if it cannot be read or is not TOML.
        """
        self.path = path.resolve()
        self.root = root
        self.warnings: dict[Diagnostic, None] = {}  # of what it says, though it can be read
        self._before = before
        if text is None:
            text = read_text(self.path)
        self._places = _places_in(text)
        try:
            self.table: Mapping[str, Any] = _table_of(text)  # shared: never changed in place
        except tomllib.TOMLDecodeError as error:
            raise self._syntax(error, text) from None
        except RecursionError:
            raise SketchError("not TOML: nested too deeply", file=self.path) from None
        except ValueError as error:  # a number of thousands of digits, a date that is none
            message, _, at = long_number(text, error)
            line = self._before + text.count("\n", 0, at) + 1 if at else 0
            raise SketchError(f"not TOML: {message}", file=self.path, line=line) from None

    def _syntax(self, error: tomllib.TOMLDecodeError, text: str) -> SketchError:
        message = str(error)
        match = _AT.search(message)
        if match is None:
            last = text.count("\n") + 1
            message = f"not TOML: {message.split(' (at')[0]}"
            return SketchError(message, file=self.path, line=self._before + last)
        line, column = map(int, match.groups())
        return SketchError(
            f"not TOML: {message[: match.start()]}",
            file=self.path,
            line=self._before + line,
            column=column,
            excerpt=text.split("\n")[line - 1],
        )

    def line(self, *key_path: str | int) -> int:
        """Return the line of a place, or of the nearest table around it; 0 if none is known.

        A key may be a dotted path, however the text writes its dots.
        """
        line = self._places.line(key_path)
        return self._before + line if line or self._before else 0

    def error(self, message: str, *key_path: str | int) -> SketchError:
        """Return an error that points at a place."""
        return SketchError(message, file=self.path, line=self.line(*key_path))

    def warn(self, message: str, *key_path: str | int) -> None:
        """Add a warning that points at a place."""
        line = self.line(*key_path)
        self.warnings[Diagnostic(message, shown(self.path), line, severity="warning")] = None

    def version(self, *, required: bool) -> None:
        """Raise ``SketchError`` if the format is one that cannot be read."""
        version = self.table.get("format", None if required else FORMAT)
        if version is None:
            raise self.error(f"a sketch begins with format = {FORMAT}")
        if type(version) is not int or version != FORMAT:
            raise self.error(f"format = {spell(version)}: this version reads format = {FORMAT}", "format")

    def only(self, table: Mapping[str, Any], valid: Collection[str], *key_path: str | int) -> None:
        """Raise ``SketchError`` for a key that is not among ``valid``."""
        for key in table:
            if key not in valid:
                raise self.error(f"no key '{key}' here{nearest(key, valid)}", *key_path, key)

    def take(self, table: Mapping[str, Any], key: str, kind: type, default: Any, *key_path: str | int) -> Any:
        """Return what ``key`` has in a table, checked to be of a kind; ``default`` where it is absent."""
        if key not in table:
            return default
        value = table[key]
        if kind is float and isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**64:
            value = float(value)
        fits = isinstance(value, kind) and (kind is bool or not isinstance(value, bool))
        if not fits or (isinstance(value, float) and not math.isfinite(value)):
            raise self.error(f"{key} = {spell(value)}: expected {_NOUNS[kind]}", *key_path, key)
        return value

    def tables(self, key: str) -> list[dict[str, Any]]:
        """Return the tables of a list of tables, ``[[key]]``; none where it is absent."""
        value = self.table.get(key, [])
        if isinstance(value, dict):
            raise self.error(f"[{key}]: expected [[{key}]], for there may be several", key)
        if not isinstance(value, list) or not all(isinstance(item, dict) for item in value):
            raise self.error(f"{key} = {spell(value)}: expected tables, each begun by [[{key}]]", key)
        return value

    def texts(self, table: Mapping[str, Any], key: str, *key_path: str | int) -> tuple[tuple[str, str], ...]:
        """Return the pairs of a table whose values are texts; dotted keys need no quotes."""
        return self._pairs(table, key, key_path, _NOUNS[str], lambda value: isinstance(value, str))

    def sources(
        self, table: Mapping[str, Any], key: str, *key_path: str | int
    ) -> tuple[tuple[str, str | tuple[str, ...]], ...]:
        """Return the pairs of a table whose values are texts, or lists of texts, as tuples."""

        def fits(value: object) -> bool:
            texts = value if isinstance(value, list) else [value]
            return bool(texts) and all(isinstance(text, str) for text in texts)

        pairs = self._pairs(table, key, key_path, f"{_NOUNS[str]}, or a list of such", fits)
        return tuple((name, tuple(v) if isinstance(v, list) else v) for name, v in pairs)

    def whole_numbers(
        self, table: Mapping[str, Any], key: str, *key_path: str | int
    ) -> tuple[tuple[str, int], ...]:
        """Return the pairs of a table whose values are 0, 1, 2, …; dotted keys need no quotes."""
        return self._pairs(
            table, key, key_path, f"{_NOUNS[int]}, 0 or more", lambda v: type(v) is int and 0 <= v < 2**31
        )

    def _pairs(
        self,
        table: Mapping[str, Any],
        key: str,
        key_path: KeyPath,
        expected: str,
        fits: Callable[[Any], bool],
    ) -> tuple[tuple[str, Any], ...]:
        pairs = tuple(_joined(self.take(table, key, dict, {}, *key_path)))
        for name, value in pairs:
            if not fits(value):
                raise self.error(f"{name} = {spell(value)}: expected {expected}", *key_path, key, name)
        return pairs


def _joined(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    keys_by_action: list[tuple[str, Any]] = []
    for key, value in table.items():
        keys_by_action += (
            _joined(value, f"{prefix}{key}.") if isinstance(value, dict) else [(f"{prefix}{key}", value)]
        )
    return keys_by_action

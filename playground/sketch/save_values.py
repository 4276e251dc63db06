"""Format values as a sketch's TOML writes them; read how a text writes one so far."""

from __future__ import annotations

import re

from playground.sketch.assign import TERRAIN_KEYS, current_path, resolve
from playground.sketch.colour import parse_hex, to_hex
from playground.sketch.model import Parameter, Sketch, Technique, Value
from playground.sketch.toml_edit import text_of
from playground.sketch.toml_places import Place, TomlPlaces
from playground.sketch.values import is_whole, shortest

_QUOTED = re.compile(r"(?<=[\"'])[\w.]+(?=[\"'])")


def written_value(sketch: Sketch, path: str, value: Value, before: str) -> str:
    """Return a value as TOML writes it, in the fewest digits that a shader reads as the same number.

    A direction is written in braces where ``before``, the text that it replaces, has them.
    """
    if path in TERRAIN_KEYS:
        return written_terrain_value(value)
    value = shortest(value)
    parameter: Parameter = resolve(sketch.graph, path)[0].parameter
    kind = parameter.widget.kind
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return text_of(value)
    if kind == "menu" and isinstance(value, int):
        return text_of(parameter.widget.choices[value])
    if kind == "colour" and isinstance(value, tuple):
        raw = parameter.widget.raw
        text = to_hex(value, raw=raw)
        if shortest((*parse_hex(text, raw=raw), 1.0)[: len(value)]) == value:
            return text_of(text)
    if kind == "direction" and isinstance(value, tuple) and before.startswith("{"):
        return f"{{ azimuth = {written_number(value[0])}, elevation = {written_number(value[1])} }}"
    whole = is_whole(parameter.type) or before.lstrip("+-").isdigit()
    if whole or isinstance(value, int | tuple):
        return written_number(value)
    return repr(float(value))


def written_number(value: float | tuple[float, ...]) -> str:
    """Return a number without a point where it is whole; several in square brackets."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(written_number, value))}]"
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return repr(value)


def written_terrain_value(value: Value) -> str:
    """Return one of the terrain's own values as TOML writes it: two equal sides as one number."""
    if isinstance(value, tuple) and len(set(value)) == 1:
        value = value[0]
    return str(value) if isinstance(value, str) else written_number(value)


def with_current_names(text: str, sketch: Sketch) -> str:
    """Return a sketch's text with the present names of what it sets, or lists in ``main``, by former ones."""
    while (span := _former_name(text, sketch)) is not None:
        start, end, name = span
        text = text[:start] + name + text[end:]
    main = TomlPlaces(text).pairs.get(("main",))
    if main is None:
        return text
    listed = _QUOTED.sub(lambda path: current_path(sketch.graph, path.group()), text[main.value : main.end])
    return text[: main.value] + listed + text[main.end :]


def _former_name(text: str, sketch: Sketch) -> tuple[int, int, str] | None:
    """Return where the text has a former name, and the present one; None where it has none."""
    places = TomlPlaces(text)
    for place, pair in places.pairs.items():
        at = next((n for n, part in enumerate(place) if part == "set"), 0)
        path = ".".join(map(str, place[at + 1 :]))
        technique = _set_at(sketch, place[:at])
        if technique is None or current_path(technique, path) == path:
            continue
        former, name = (some.rpartition(".")[2] for some in (path, current_path(technique, path)))
        start = text.rindex(former, pair.key, pair.value)
        return start, start + len(former), name
    return None


def _set_at(sketch: Sketch, table: Place) -> Technique | None:
    """Return the technique, or the sketch's graph, whose parameters a table sets; None for other tables."""
    if table == ("view",):
        view = sketch.graph.find("view")
        return view.technique if view else None
    if len(table) == 2 and table[0] == "pass":
        return sketch.graph.passes[int(table[1])].technique
    return sketch.graph if len(table) == 2 and table[0] in ("preset", "shot", "keyframe") else None


def written_so_far(text: str, table: Place, key: str) -> str:
    """Return how a text writes the value of a key so far; "" where it does not."""
    places = TomlPlaces(text)
    place = places.find(table, key)
    if place is None:
        # Azimuth and elevation may also be set by two dotted keys; then the key itself has no value.
        return ""
    pair = places.pairs[place]
    return text[pair.value : pair.end]

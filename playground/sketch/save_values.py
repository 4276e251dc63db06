"""Values as a sketch's TOML writes them, and what a text says in their place so far."""

from __future__ import annotations

from playground.sketch.assign import TERRAIN_KEYS, current_path, resolve
from playground.sketch.colour import parse_hex, to_hex
from playground.sketch.model import Parameter, Sketch, Technique, Value
from playground.sketch.toml_edit import text_of
from playground.sketch.toml_places import Place, TomlPlaces
from playground.sketch.values import is_whole, shortest


def written_value(sketch: Sketch, path: str, value: Value, said: str) -> str:
    """Return a value as TOML writes it, in the fewest digits that a shader reads as the same number.

    A direction stands in braces where ``said``, what stands there, has them.
    """
    if path in TERRAIN_KEYS:
        return written_land(value)
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
        seen = to_hex(value)
        if shortest((*parse_hex(seen), 1.0)[: len(value)]) == value:
            return text_of(seen)
    if kind == "direction" and isinstance(value, tuple) and said.startswith("{"):
        return f"{{ azimuth = {written_number(value[0])}, elevation = {written_number(value[1])} }}"
    whole = is_whole(parameter.type) or (bool(said) and said.lstrip("+-").isdigit())
    if isinstance(value, tuple):
        return f"[{', '.join(written_number(n) for n in value)}]"
    return written_number(value) if whole or isinstance(value, int) else repr(float(value))


def written_number(value: float | int) -> str:
    """Return a number without a point where it is whole."""
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return repr(value)


def written_land(value: object) -> str:
    """Return one of the terrain's own values as TOML writes it: two equal sides as one number."""
    if not isinstance(value, tuple):
        return written_number(value) if isinstance(value, int | float) else str(value)
    numbers = [written_number(n) for n in value]
    return numbers[0] if len(set(numbers)) == 1 else f"[{', '.join(numbers)}]"


def with_current_names(text: str, sketch: Sketch) -> str:
    """Return a sketch's text with the present name of each parameter that it sets by a former one."""
    while (span := _former_name(text, sketch)) is not None:
        start, end, name = span
        text = text[:start] + name + text[end:]
    return text


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


def said_so_far(text: str, table: Place, key: str) -> str:
    """Return what the text says there so far, "" where nothing is."""
    places = TomlPlaces(text)
    place = places.find(table, key)
    if place is None:
        # Azimuth and elevation may also be set by two dotted keys, which no value stands behind.
        return ""
    pair = places.pairs[place]
    return text[pair.value : pair.end]

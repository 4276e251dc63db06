"""Shaders of other tools, written for the tests: one for each rule of a dialect, and some combinations.

Each table of a ``.toml`` here is a case: the files that it consists of, and what must come of them (the
keys are in tests/dialects/test_cases.py). A key with a dot names a file, one of ``FILE_KEYS`` is the ending
of a file of the case's own name; the first file is opened, or ``opens``, "" for the folder. A list of
tables is an export of Shadertoy, a table a pass. ``$plain`` is a text of ``[texts]``. ``HERE`` is a line at
which a mistake may be planted.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from playground.data.image_files import write_png

HERE = "    // here\n"
MISTAKE = "    float wrong = not_declared;\n"
FILE_KEYS = ("frag", "fs", "vs", "glsl", "toml")
FAMILIES = ("main", "isf", "shadertoy")
_KINDS = {"I": "image", "B": "buffer", "C": "common", "S": "sound"}


def read(number: object, channel: int = 0, **more: object) -> dict[str, object]:
    """Return an input of an export that reads the output of a number."""
    return {"id": number, "ctype": "buffer", "channel": channel, **more}


def one(name: str, code: str, *inputs: object, kind: str = "", output: object = 37) -> dict[str, object]:
    """Return a pass of an export."""
    outputs = [{"id": output, "channel": 0}] if output else []
    made = {"code": code, "name": name, "inputs": list(inputs), "outputs": outputs}
    return {**made, "type": kind or _KINDS[name[0]]}


def cube(code: str, *inputs: object) -> dict[str, object]:
    """Return a cube map pass of an export, whose output is 41."""
    return one("Cube A", code, *inputs, kind="cubemap", output=41)


def export(*passes: object, form: str = "") -> str:
    """Return an export as the site writes it; as a ``list``, or ``bare``, as other programs do."""
    bare = {"renderpass": list(passes)}
    whole = {"Shader": {"ver": "0.1", "info": {"name": "Made here"}, **bare}}
    return json.dumps({"list": [bare], "bare": bare}.get(form, whole))


@dataclass(frozen=True)
class Case:
    """A shader of another tool, in files, and what must come of it."""

    family: str
    name: str
    files: Mapping[str, str]
    opens: str  # a file; "" the folder
    expected: Mapping[str, Any] = field(default_factory=dict)

    def __str__(self) -> str:
        return f"{self.family} {self.name}"

    def write(self, folder: Path) -> Path:
        """Write the files into a folder, and return what is opened."""
        for name, text in self.files.items():
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        if image := self.expected.get("image"):
            write_png(folder / image, photo(5))
        return folder / self.opens

    def mistakes(self) -> Iterator[tuple[Case, str, int]]:
        """Yield the case with a mistake at each ``HERE``: where it is as messages name it, and its line."""
        for name, text in self.files.items():
            if name.endswith(".json"):
                for place, changed, line in _in_passes(json.loads(text)):
                    yield replace(self, files={**self.files, name: changed}), f"{name}:{place}", line
            elif HERE in text:
                changed = text.replace(HERE, MISTAKE)
                line = text[: text.index(HERE)].count("\n") + 1
                yield replace(self, files={**self.files, name: changed}), name.rpartition("/")[2], line

    def with_mistake(self) -> tuple[Case, int]:
        """Return the case with a mistake at its first ``HERE``, and the line."""
        case, _, line = next(self.mistakes())
        return case, line


def photo(seed: int) -> np.ndarray:
    """Return an opaque image of 8 x 6 texels of noise."""
    pixels = np.random.default_rng(seed).integers(0, 256, (6, 8, 4), dtype=np.uint8)
    pixels[..., 3] = 255
    return pixels


def _in_passes(data: Any) -> Iterator[tuple[str, str, int]]:
    inside = data[0] if isinstance(data, list) else data.get("Shader", data)
    for each in inside["renderpass"]:
        code = (each or {}).get("code", "")
        if HERE in code:
            each["code"] = code.replace(HERE, MISTAKE)
            yield each.get("name", "Image"), json.dumps(data), code[: code.index(HERE)].count("\n") + 1
            each["code"] = code


def _cases(family: str) -> dict[str, Case]:
    tables = tomllib.loads((Path(__file__).parent / f"{family}.toml").read_text(encoding="utf-8"))
    TEXTS.update(tables.pop("texts", {}))
    return {name: _case(family, name, table) for name, table in tables.items()}


def _case(family: str, name: str, table: dict[str, Any]) -> Case:
    files, expected = {}, {}
    for key, value in table.items():
        if key not in FILE_KEYS and "." not in key:
            expected[key] = value
        elif isinstance(value, str):
            files[key if "." in key else f"{name}.{key}"] = _text(value)
        else:
            files[key] = export(*map(_pass, value), form=table.get("form", ""))
    return Case(family, name, files, table.get("opens", next(iter(files))), expected)


def _text(text: str) -> str:
    return TEXTS[text[1:]] if text.startswith("$") else text


def _pass(table: dict[str, Any]) -> dict[str, object] | None:
    if "code" not in table:
        return {} if table else None
    code = _text(table["code"])
    if "name" not in table:
        return {**table, "code": code}
    inputs = [each if isinstance(each, dict) else read(each) for each in table.get("inputs", ())]
    named = {"kind": table.get("type", ""), "output": table.get("output", 37)}
    return one(table["name"], code, *inputs, **named)


TEXTS: dict[str, str] = {}
"""Texts that several cases and tests have, by name."""

CASES: dict[str, dict[str, Case]] = {family: _cases(family) for family in FAMILIES}
"""Shaders that are drawn, of each family, by name."""

EVERY = tuple(case for cases in CASES.values() for case in cases.values())

RESULTS, REFUSALS = _cases("results"), _cases("refusals")
"""Cases of which more must come than a picture, and those that are refused."""

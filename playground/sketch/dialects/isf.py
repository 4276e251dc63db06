"""Read an ISF shader, version 1 or 2: a fragment shader with a description in JSON before it.

Source: the Interactive Shader Format's specification, versions 1 and 2.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from playground.errors import Diagnostic
from playground.sketch.dialects.conditions import live_source
from playground.sketch.dialects.declarations import is_declared, uniforms
from playground.sketch.dialects.es import Rewritten, rewritten
from playground.sketch.dialects.isf_header import is_true, read_header
from playground.sketch.dialects.isf_inputs import IMAGE, Inputs, read_inputs
from playground.sketch.dialects.isf_sizes import translated
from playground.sketch.dialects.passes import VIEW
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.shader import Channel, Names, Rules, Shader
from playground.sketch.expressions import ExpressionError
from playground.sketch.source import SourceText

NAMES: Names = {
    "TIME": ("float", "time"),
    "TIMEDELTA": ("float", "delta"),
    "FRAMEINDEX": ("int", "frame_of_time"),
    "RENDERSIZE": ("vec2", "resolution"),
    "DATE": ("vec4", "date_from_1"),
}
"""What every ISF shader is given; ``PASSINDEX`` is a macro, and coordinates come from the vertex shader."""

VERTEX_FILES = (".vs", ".vert")
"""What a vertex shader of the author's own ends in, beside the file and of its name."""

_MACROS = ("PASSINDEX",)  # other ones of each pass
_COORDINATE = "in vec2 isf_FragNormCoord;"
_TAKEN = re.compile(
    r"(?:vv|isf)_(?:FragNormCoord|vertShaderInit)|IMG_(?:NORM_|THIS_|THIS_NORM_)?PIXEL|IMG_SIZE|PASSINDEX"
)
_PROPERTY = re.compile(r"\b_(\w+)_(imgRect|imgSize|flip)\b")
_PROPERTIES = {"imgRect": "vec4(0.0, 0.0, IMG_SIZE({0}))", "imgSize": "IMG_SIZE({0})", "flip": "false"}
_SENTENCE = re.compile(r"(.{3,}?[.!?])(?:\s|$)")
_LONGEST_TITLE = 72
_MOST_PASSES = 64
_MODES = ("", "ISF", "FRAGMENT", "FRAGMENT_SHADER")
_KEYS = (
    *("MODE", "ISFVSN", "VSN", "DESCRIPTION", "CREDIT", "CATEGORIES", "INPUTS", "PASSES", "IMPORTED"),
    *("PERSISTENT_BUFFERS", "LABEL", "KEYWORDS", "TAGS", "LICENSE"),
)
_PASS_KEYS = ("TARGET", "PERSISTENT", "FLOAT", "WIDTH", "HEIGHT", "DESCRIPTION")
_BUFFER_KEYS = ("NAME", "FLOAT", "WIDTH", "HEIGHT", "PERSISTENT", "DESCRIPTION")


@dataclass(frozen=True)
class _Target:
    """A buffer that passes write."""

    name: str
    keeps: bool
    is_float: bool
    sizes: Mapping[str, Any]  # WIDTH and HEIGHT, where they are given


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file."""
    return _Reader(files).shaders()


class _Reader:
    """One file, its description read."""

    def __init__(self, files: Files) -> None:
        self.files = files
        self.source = live_source(files.source(), {}, unsure=_MACROS, unknown=None)
        self.header = read_header(self.source)
        if not is_declared(self.source.code, "main", anywhere=False):
            raise self.source.lines[-1].error(
                "an ISF shader needs a main() of its own, after its description"
            )
        mode = self.header.table.get("MODE")
        if isinstance(mode, str) and mode.upper() not in _MODES:
            message = f"MODE {mode}: only ISF's own kind is drawn, a fragment shader over the whole picture"
            raise self.header.line_of("MODE").error(message)
        self.notes: list[Diagnostic] = []
        note = self.header.unknown(self.header.table.keys(), _KEYS, "the description")
        self.notes += [note] if note else []
        self.passes = self.header.items("PASSES") or [{}]
        if len(self.passes) > _MOST_PASSES:
            message = f"{len(self.passes)} passes are more than the {_MOST_PASSES} that are drawn"
            raise self.header.line_of("PASSES").error(message)
        self.inputs: Inputs = read_inputs(self.header, files, _taken)
        self.notes += self.inputs.notes
        self.targets = {target.name: target for target in self._targets()}
        self.text = self._rewritten(self.source)
        self.vertex = self._vertex()

    def shaders(self) -> list[Shader]:
        samplers = [*self.inputs.channels, *self.targets]
        names = {**NAMES, **{name: ("sampler2D", "none") for name in map(self._called, samplers)}}
        names |= {name: ("samplerCube", "none") for name in map(self._called, self.inputs.cubes)}
        helpers = ("isf_image.glsl", "isf_fragment.glsl"), ("isf_image.glsl", "isf_vertex.glsl")
        rules = Rules("isf", names, varyings=(_COORDINATE,), helpers=helpers[0], vertex_helpers=helpers[1])
        channels = {self._called(name): channel for name, channel in self.inputs.channels.items()}
        channels |= {self._called(name): Channel(target=name, sampling=IMAGE) for name in self.targets}
        parameters = tuple(self._parameters())
        properties = self._properties()
        common = [f"#define _{name}_{what} {_PROPERTIES[what].format(name)}" for name, what in properties]
        found = []
        for index, (one, name) in enumerate(zip(self.passes, self._pass_names(), strict=True)):
            target = self.targets.get(str(one.get("TARGET") or ""))
            found.append(
                Shader(
                    name,
                    self.text,
                    rules,
                    target=target.name if target else "",
                    channels=channels,
                    parameters=parameters,
                    size=self._size(one, target, index),
                    format="rgba32f"
                    if is_true(one.get("FLOAT")) or (target and target.is_float)
                    else "rgba8",
                    prelude=(*self._index(index), *common),
                    named=frozenset(name for name, what in properties if what != "flip"),
                    vertex=self.vertex,
                    keeps=target is not None and target.keeps,
                )
            )
        self.files.notes += dict.fromkeys(self.notes)
        self.files.title = self._title()
        return found

    # ── what the description says ────────────────────────────────────────────

    def _title(self) -> str:
        """Return the description's first sentence, and whose it is."""
        description, credit = self.header.text_of("DESCRIPTION"), self.header.text_of("CREDIT")
        match = _SENTENCE.match(description)
        title = (match.group(1) if match else description).rstrip(".")
        title = title if len(title) <= _LONGEST_TITLE else f"{title[: _LONGEST_TITLE - 1]}…"
        credit = credit if len(credit) <= _LONGEST_TITLE else ""
        if credit and not credit.lower().startswith(("by ", "created by ")):
            credit = f"by {credit}"
        return f"{title or self.files.path.stem}, {credit}" if credit else title

    def _targets(self) -> Iterator[_Target]:
        """Yield the buffers of PASSES, and of version 1's PERSISTENT_BUFFERS."""
        kept = {}
        for one in self.header.items("PERSISTENT_BUFFERS", named=True):
            name = self._target_name(one.get("NAME"), "a persistent buffer")
            kept[name] = one
            self._note(one, _BUFFER_KEYS, f"buffer '{name}'")
        writers: dict[str, list[Mapping[str, Any]]] = {name: [] for name in kept}
        for index, one in enumerate(self.passes):
            self._note(one, _PASS_KEYS, f"pass {index}")
            if one.get("TARGET"):
                writers.setdefault(
                    self._target_name(one["TARGET"], f"the target of pass {index}"), []
                ).append(one)
        for name, some in writers.items():
            known = [*some, kept.get(name, {})]
            sizes = {
                key: next((one[key] for one in known if one.get(key) not in (None, "")), None)
                for key in ("WIDTH", "HEIGHT")
            }
            keeps = name in kept or any(is_true(one.get("PERSISTENT")) for one in some)
            yield _Target(name, keeps, any(is_true(one.get("FLOAT")) for one in known), sizes)

    def _target_name(self, name: object, what: str) -> str:
        line = self.header.line_of_input(name) if isinstance(name, str) else self.header.line_of("PASSES")
        if not isinstance(name, str) or not name.isidentifier() or not name.isascii():
            raise line.error(f"{what} needs a name that GLSL can use; found {name!r}")
        taken = "an input has this name" if name in self.inputs.names else _taken(name)
        if taken:
            raise line.error(f"{what} cannot be called '{name}': {taken}")
        return name

    def _note(self, found: Mapping[str, Any], known: Sequence[str], what: str) -> None:
        note = self.header.unknown(found.keys(), known, what)
        self.notes += [note] if note else []

    def _size(self, one: Mapping[str, Any], target: _Target | None, index: int) -> tuple[str, str] | None:
        """Return the size of a pass; the last one's is the picture's."""
        given = {key: one.get(key) or (target.sizes[key] if target else None) for key in ("WIDTH", "HEIGHT")}
        if not any(given.values()):
            return None
        numbers = {p.name: self._called(p.name) for p in self.inputs.parameters if p.type in _NUMBERS}
        found = []
        for key, default in (("WIDTH", "$WIDTH"), ("HEIGHT", "$HEIGHT")):
            try:
                found.append(translated(given[key] or default, numbers))
            except ExpressionError as error:
                after = str(one.get("TARGET") or "PASSES")
                raise self.header.line_of(key, after).error(f"{key} of pass {index}: {error}") from None
        if index == len(self.passes) - 1:
            if found != [translated("$WIDTH", {}), translated("$HEIGHT", {})]:
                line = self.header.line_of(
                    "WIDTH" if given["WIDTH"] else "HEIGHT", str(one.get("TARGET") or "")
                )
                message = f"pass {index} is the last, so it is the picture and has the picture's size"
                self.notes.append(line.diagnostic(message, severity="warning"))
            return None
        return found[0], found[1]

    def _pass_names(self) -> list[str]:
        """Return a name for each pass: that of its target where it has one."""
        if len(self.passes) == 1:
            return [VIEW]
        found: list[str] = []
        for index, one in enumerate(self.passes):
            first = name = str(one.get("TARGET") or f"pass_{index}")
            number = 2
            while name in found or name in self.inputs.names or (name in self.targets and name != first):
                name, number = f"{first}_{number}", number + 1
            found.append(name)
        return found

    # ── its texts ────────────────────────────────────────────────────────────

    def _rewritten(self, source: SourceText, *, is_vertex: bool = False) -> Rewritten:
        declared = [*self.inputs.names, *self.targets]
        return rewritten(source, is_vertex=is_vertex, declared=declared)

    def _called(self, name: str) -> str:
        """Return what a name is called in the text, where GLSL 3.30 has taken it."""
        return self.text.names.get(name, name)

    def _parameters(self) -> Iterator[Any]:
        for parameter in self.inputs.parameters:
            called = self._called(parameter.name)
            label = parameter.label or ("" if called == parameter.name else parameter.title)
            yield replace(parameter, name=called, label=label)

    def _vertex(self) -> Rewritten | None:
        """Return the author's own vertex shader, if there is one beside the file."""
        places = [self.files.path.with_suffix(suffix) for suffix in VERTEX_FILES]
        there = [place for place in places if self.files.is_there(place)]
        if not there:
            return None
        source = live_source(self.files.source(there[0]), {}, unsure=_MACROS, unknown=None)
        if not is_declared(source.code, "main", anywhere=False):
            raise source.lines[-1].error("a vertex shader needs a main() of its own")
        return self._rewritten(source, is_vertex=True)

    def _index(self, index: int) -> Iterator[str]:
        if "PASSINDEX" not in uniforms(self.source.code):
            yield f"#define PASSINDEX {index}"

    def _properties(self) -> dict[tuple[str, str], None]:
        """Return what the texts read that an image has besides its texels: image and property."""
        code = self.text.source.code + (self.vertex.source.code if self.vertex else "")
        known = {*map(self._called, self.inputs.channels), *map(self._called, self.targets)}
        known |= {p.name for p in self._parameters() if p.type == "sampler2D"}
        return dict.fromkeys((name, what) for name, what in _PROPERTY.findall(code) if name in known)


_NUMBERS = ("float", "int", "bool")


def _taken(name: str) -> str:
    """Return why a name cannot be an input's, "" where it can."""
    if name in NAMES or _TAKEN.fullmatch(name):
        return "ISF itself gives this name"
    if name.startswith(("k_", "gl_")) or "__" in name:
        return "names that begin with k_ or gl_, or hold __, are taken"
    return ""

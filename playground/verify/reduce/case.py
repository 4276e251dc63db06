"""A sketch inlined: its passes, their texts, and what is set; written out as files it is a sketch again.

What a text no longer declares is neither set nor wired, and a pass that nothing leads to
is not written, so any line may be taken out of a text without touching the rest.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from playground.memo import PickledByFields
from playground.sketch.map_sketch import USE
from playground.sketch.model import Camera, Value
from playground.sketch.variants import NAME
from playground.verify.reduce.variant import record_text

SHOT = "reduced"
"""The one shot of a sketch that is written: its picture's size and time."""

_CAMERA = Camera()
_DECLARED = re.compile(r"^\s*uniform\s+\w+\s+(\w+)", re.MULTILINE)
_REPEATS = re.compile(r"^\s*#pragma\s+(?:draw\b|kernel\b.*\brepeat\s*=)", re.MULTILINE)


@dataclass(frozen=True, kw_only=True)
class Pass(PickledByFields):
    """One pass, with the whole text of what fills it."""

    name: str
    text: str  # tidy; includes in place
    variant: str = ""  # text of the compute variant that runs in its place
    inputs: tuple[tuple[str, str], ...] = ()  # input → "pass:output"
    values: tuple[tuple[str, Value], ...] = ()  # parameter → value
    size: tuple[int, int] | None = None  # texels; None: the terrain's
    repeat: int = 0  # steps of a pass that feeds itself; 0: it does not
    feedback: tuple[tuple[str, str], ...] = ()  # input → own output
    suffix: str = ".glsl"
    head: str = ""  # what another tool's file has to begin with; none of it is taken out
    beside: tuple[tuple[str, str], ...] = ()  # suffix → text of a file that goes with it, likewise

    @cached_property
    def declared(self) -> frozenset[str]:
        """The names of its uniforms."""
        return frozenset(_DECLARED.findall(self.text))

    @property
    def live_inputs(self) -> tuple[tuple[str, str], ...]:
        """What is wired to inputs that its text still has."""
        return tuple(pair for pair in self.inputs if pair[0] in self.declared or self._begins(pair[0]))

    @property
    def live_values(self) -> tuple[tuple[str, Value], ...]:
        """What is set of the parameters that its text still has."""
        return tuple(pair for pair in self.values if pair[0] in self.declared)

    def _begins(self, name: str) -> bool:
        return name.startswith("initial") and bool(_REPEATS.search(self.text))


@dataclass(frozen=True, kw_only=True)
class Case(PickledByFields):
    """Something that may fail."""

    passes: tuple[Pass, ...]
    target: str  # the pass that is looked at; "view": it is the picture itself
    size: tuple[int, int] = (33, 33)  # [texels] of the terrain
    extent: tuple[float, float] | None = None  # [m]
    relief: float | None = None  # [m]
    base_elevation: float | None = None  # [m]
    camera: Camera = _CAMERA
    samples: int = 4
    frame: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    steps: tuple[tuple[str, int], ...] = ()
    files: tuple[tuple[str, str], ...] = field(default=(), compare=False)  # name in the folder → its source

    @property
    def file(self) -> str:
        """The name of the file to open."""
        only = self.passes[-1]
        return "sketch.toml" if only.suffix == ".glsl" else f"{only.name}{only.suffix}"

    @cached_property
    def live(self) -> tuple[Pass, ...]:
        """The passes that lead to the target, in order, the target last."""
        names = {self.target}
        passes = []
        for pass_ in reversed(self.passes):
            if pass_.name in names:
                passes.append(pass_)
                names |= {source.partition(":")[0] for _, source in pass_.live_inputs}
        return tuple(passes[::-1])

    @property
    def lines(self) -> int:
        """Lines of GLSL, blank ones apart."""
        return sum(pass_.text.count("\n") + pass_.variant.count("\n") for pass_ in self.live)

    @property
    def settings(self) -> int:
        """How many parameters there are."""
        return sum(len(pass_.declared - {name for name, _ in pass_.inputs}) for pass_ in self.live)

    def with_pass(self, changed: Pass) -> Case:
        """Return the case with one pass replaced by another of its name."""
        return replace(self, passes=tuple(changed if p.name == changed.name else p for p in self.passes))

    def looking_at(self, name: str) -> Case:
        """Return the case with another pass looked at, and what comes after that left out."""
        index = next(i for i, pass_ in enumerate(self.passes) if pass_.name == name)
        return replace(self, passes=self.passes[: index + 1], target=name)

    def texts(self) -> dict[str, str]:
        """Return the files of the sketch by name: ``sketch.toml`` and one or two for each pass."""
        texts: dict[str, str] = {}
        for pass_ in self.live:
            texts[f"{pass_.name}{pass_.suffix}"] = pass_.head + pass_.text
            texts |= {f"{pass_.name}{suffix}": text for suffix, text in pass_.beside}
            if pass_.variant:
                texts[f"{pass_.name}.comp"] = pass_.variant
        variants = {f"{pass_.name}.comp": (pass_.text, pass_.variant) for pass_ in self.live if pass_.variant}
        if variants:
            texts[NAME] = record_text(variants)
        if self.file == "sketch.toml":
            texts["sketch.toml"] = self._toml()
        return texts

    def _toml(self) -> str:
        lines = ["format = 1", f"size = {_numbers(self.size)}"]
        if self.extent is not None:
            lines.append(f"extent = {_numbers(self.extent)}")
        for key in ("relief", "base_elevation"):
            if (value := getattr(self, key)) is not None:
                lines.append(f"{key} = {spelt(value)}")
        for pass_ in self.live:
            if pass_.name != "view":
                lines += ["", "[[pass]]", f'name = "{pass_.name}"', *_pass(pass_)]
        if self.target == "view":
            lines += ["", "[view]", *_pass(self.live[-1])]
        else:
            lines += ["", "[view]", f'use = "{USE}"', f'inputs = {{ shown = "{self.target}" }}']
        if self.samples != 4:
            lines.append(f"samples = {self.samples}")
        camera = [
            f"{key} = {spelt(getattr(self.camera, key))}"
            for key in ("azimuth", "elevation", "distance", "target", "field_of_view")
            if getattr(self.camera, key) != getattr(_CAMERA, key)
        ]
        if camera:
            lines.append(f"camera = {{ {', '.join(camera)} }}")
        lines += ["", "[[shot]]", f'name = "{SHOT}"', f"size = {_numbers(self.frame)}"]
        if self.time:
            lines.append(f"time = {spelt(self.time)}")
        names = {pass_.name for pass_ in self.live}
        steps = [f"{path} = {steps}" for path, steps in self.steps if path in names]
        if steps:
            lines.append(f"steps = {{ {', '.join(steps)} }}")
        return "\n".join(lines) + "\n"


def _pass(pass_: Pass) -> list[str]:
    lines = [f'use = "./{pass_.name}"']
    if pass_.live_inputs:
        wires = ", ".join(f'{name} = "{source}"' for name, source in pass_.live_inputs)
        lines.append(f"inputs = {{ {wires} }}")
    if pass_.live_values:
        lines.append(
            f"set = {{ {', '.join(f'{name} = {spelt(value)}' for name, value in pass_.live_values)} }}"
        )
    if pass_.size is not None and pass_.name != "view":
        lines.append(f"size = {_numbers(pass_.size)}")
    if pass_.repeat:
        fed = ", ".join(f'{name} = "{output}"' for name, output in pass_.feedback)
        lines += [f"repeat = {pass_.repeat}", f"feedback = {{ {fed} }}"]
    return lines


def spelt(value: Value) -> str:
    """Return a value as TOML takes it."""
    if isinstance(value, tuple):
        return f"[{', '.join(spelt(element) for element in value)}]"
    return json.dumps(value)


def _numbers(pair: tuple[int, int] | tuple[float, float]) -> str:
    return spelt(pair)


def glsl_of(kind: str, value: Value) -> str:
    """Return a value as a literal of a GLSL type; "" for a file's name."""
    if isinstance(value, str):
        return ""
    if isinstance(value, tuple):
        inner = "int" if kind[0] == "i" else "uint" if kind[0] == "u" else "float"
        return f"{kind}({', '.join(glsl_of(inner, element) for element in value)})"
    if kind == "bool":
        return "true" if value else "false"
    if kind in ("int", "uint"):
        return f"{int(value)}{'u' if kind == 'uint' else ''}"
    return repr(float(value))


def copied(files: tuple[tuple[str, str], ...], texts: Mapping[str, str]) -> list[tuple[str, Path]]:
    """Return the data files that the texts still name, each with where it comes from."""
    together = "\n".join(text for name, text in texts.items() if name.endswith((".toml", ".frag")))
    return [(name, Path(source)) for name, source in files if json.dumps(name) in together]

"""A sketch inlined: its passes, their texts, and what is set; written out as files it is a sketch again.

Techniques of several passes become passes, includes become text. What a text no longer declares is neither
set nor wired, and a pass that nothing leads to is not written, so any line may be taken out of a text
without touching the rest.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from playground.engine.plan import LoopStep, Plan, PlanNode, PlanRequest, Step
from playground.engine.planner import make_plan
from playground.errors import PlaygroundError, SketchError
from playground.memo import PickledByFields
from playground.paths import shown
from playground.shader.conditions import without_guards
from playground.shader.dialect import dialects
from playground.shader.header import note_at, parse_kernel
from playground.shader.reserved_names import MATCHES, WIRED
from playground.shader.source import SourceText, read_source, read_source_and_origin
from playground.shader.syntax.tokens import as_written, with_edits
from playground.sketch.flat import Ref, Source
from playground.sketch.map_sketch import USE
from playground.sketch.model import (
    Camera,
    ComputeVariant,
    ForeignShader,
    Kernel,
    PlainFragment,
    PlainShader,
    Sketch,
    Value,
)
from playground.sketch.variants import NAME, Verified, active_variant, content_of, written
from playground.verify.reduce.edits import read, tidy, uniforms_of

# ── the record of fast variants: what is reduced runs without being verified ─


def record_text(pairs: Mapping[str, tuple[str, str]]) -> str:
    """Return a record in which each kernel's text and its variant's, by the variant's file, agree.

    A text that is no kernel has no place in it.
    """
    entries = {name: _contents(name, *texts) for name, texts in pairs.items()}
    return written({name: contents for name, contents in entries.items() if contents is not None})


def _contents(name: str, text: str, variant_text: str) -> Verified | None:
    try:
        plain, variant = _kernel("case.glsl", text), _kernel(name, variant_text)
    except PlaygroundError:
        return None
    if plain is None or not isinstance(variant, ComputeVariant):
        return None
    variant = replace(variant, outputs=plain.outputs, accepts=plain.accepts)
    return content_of(plain), content_of(variant)


def _kernel(name: str, text: str) -> Kernel | None:
    path = Path.cwd() / name
    return parse_kernel(name, read_source(path, (), {str(path.resolve()): text}))


# ── cases ────────────────────────────────────────────────────────────────────


SHOT = "reduced"
"""The one shot of a sketch that is written: its picture's size and time."""

_CAMERA = Camera()
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
    given: tuple[tuple[str, str], ...] = ()  # name that another tool gives it → its type

    @cached_property
    def declared(self) -> frozenset[str]:
        """The names of its uniforms."""
        return frozenset(uniforms_of(self.text))

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


# ── a loaded sketch inlined ──────────────────────────────────────────────────


_OF_SHADERS = (".fs", ".fragment", ".glsl", ".json")


def inline_sketch(
    sketch: Sketch, *, frame: tuple[int, int], time: float = 0.0, steps: dict[str, int] | None = None
) -> Case:
    """Return the sketch as a case that looks at its picture.

    Raises ``PlaygroundError`` for what is wrong before any shader is compiled, and ``SketchError``
    for what has no place in an inlined sketch: a loop of several passes, another tool's shader among
    other passes.
    """
    plan = make_plan(sketch, PlanRequest(frame_size=frame, time=time, steps=steps or {}))
    leaves = list(plan.walk())
    alone = len(leaves) == 1 or Path(sketch.file).suffix != ".toml"  # the rest replaces its channels
    own = [leaf.kernel for leaf in leaves if isinstance(leaf.kernel, ForeignShader)]
    foreign = {_words(_whole_source(kernel, plan), as_written=True) for kernel in own}
    if alone and len(foreign) > 1:
        raise SketchError(
            f"{len(foreign)} passes of another tool's shader cannot be inlined; reduce a file of one of them",
            file=Path(sketch.file),
        )
    if alone and isinstance(leaves[-1].kernel, PlainShader):
        return _plain(leaves[-1], plan)
    if own:
        raise SketchError(
            f"another tool's shader among other passes cannot be inlined; reduce {shown(own[0].path)} alone",
            file=Path(sketch.file),
        )
    inliner = _Inliner(plan, leaves[-1].path)
    passes = tuple(inliner.one(node) for node in plan.nodes)
    terrain = plan.terrain
    assert terrain.size is not None and terrain.extent is not None
    return Case(
        passes=passes,
        target=passes[-1].name,
        size=terrain.size,
        extent=terrain.extent,
        relief=terrain.relief,
        base_elevation=terrain.base_elevation or None,
        camera=sketch.camera,
        samples=sketch.picture.samples,
        frame=frame,
        time=time,
        steps=tuple((inliner.name(path), steps) for path, steps in plan.steps.items()),
        files=tuple(inliner.files.items()),
    )


def _plain(step: Step, plan: Plan) -> Case:
    kernel, suffix = step.kernel, Path(step.kernel.path).suffix
    foreign = kernel if isinstance(kernel, ForeignShader) else None
    name = "shader" if isinstance(kernel, PlainFragment) else "compute"
    vertex = foreign.vertex_source if foreign else None
    pass_ = Pass(
        name=name,
        text=_words(_whole_source(kernel, plan), as_written=foreign is not None),
        suffix=".frag" if suffix in _OF_SHADERS else suffix,
        head=dialects().head(foreign) if foreign else "",
        beside=((Path(vertex.path).suffix, _words(vertex, as_written=True)),) if vertex else (),
        given=tuple(_given(foreign.prelude)) if foreign else (),
    )
    named = [(p.default, step.values[p.name]) for p in kernel.file_parameters]
    files = tuple((str(written_out), str(parts)) for written_out, parts in named if foreign)
    return Case(passes=(pass_,), target=name, frame=plan.frame_size, time=plan.time, samples=1, files=files)


def _given(prelude: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield what stands before another tool's shader: names, and their types."""
    for symbol in read("\n".join(prelude)).symbols:
        if symbol.kind in ("uniform", "variable", "function") and symbol.type and not symbol.arrays:
            yield symbol.name, symbol.type


def _whole_source(kernel: Kernel, plan: Plan) -> SourceText:
    """Return a kernel's text; where it is one pass of several of a text, and has some of its lines, all."""
    several = sum(step.kernel.path == kernel.path for step in plan.walk()) > 1
    if not isinstance(kernel, ForeignShader) or kernel.dialect != "main" or not several:
        return kernel.source
    return read_source_and_origin(Path(kernel.path), (Path(plan.sketch.folder),), foreign=True)[0]


def _words(source: SourceText, *, as_written: bool) -> str:
    """Return a text without blank lines: of another tool's shader the author's words, for its reader."""
    lines = [line for line in source.lines if line.code.strip()]
    return "\n".join(line.text if as_written else line.code for line in lines) + "\n"


class _Inliner:
    def __init__(self, plan: Plan, last: str) -> None:
        self.plan = plan
        self.last = last
        self.files: dict[str, str] = {}

    def name(self, path: str) -> str:
        """Return the pass's name: the picture itself is the view."""
        if path == self.last:
            return "view"
        return "view_" if path == "view" else path.replace(".", "_")

    def one(self, node: PlanNode) -> Pass:
        repeat = 0
        feedback: tuple[tuple[str, str], ...] = ()
        step = node
        initial: dict[str, Source | None] = {}
        if isinstance(node, LoopStep):
            if len(node.bodies) > 1:
                raise SketchError(f"pass '{node.path}' has a size for each step, which cannot be inlined")
            inside = node.body[0]
            if len(node.body) != 1 or isinstance(inside, LoopStep):
                raise SketchError(
                    f"pass '{node.path}' is a loop of several passes, which cannot be inlined;"
                    " reduce one of its kernels alone"
                )
            repeat, step = node.repeat, inside
            feedback = tuple((name, ref.output) for name, _, ref in node.feedback)
            initial = {name: first for name, first, _ in node.feedback}
        assert isinstance(step, Step)
        variant = active_variant(step.kernel, ("compute",))
        text = written_out(step.kernel)
        variant_text = (
            written_out(variant.technique) if variant and isinstance(variant.technique, Kernel) else ""
        )
        inputs = []
        for name, source in step.inputs:
            first = initial.get(name, source)
            if isinstance(first, Ref):
                inputs.append((name, f"{self.name(first.path)}:{first.output}"))
            elif not name.startswith("initial"):
                text, variant_text = unwired(text, name), unwired(variant_text, name)
        return Pass(
            name=self.name(step.path),
            text=text,
            variant=variant_text,
            inputs=tuple(inputs),
            values=tuple(
                (name, self._value(step.kernel, name, value)) for name, value in step.values.items()
            ),
            size=None if step.size == self.plan.terrain.size else step.size,
            repeat=repeat,
            feedback=feedback,
        )

    def _value(self, kernel: Kernel, name: str, value: Value) -> Value:
        parameter = kernel.parameter(name)
        if parameter is None or parameter.widget.kind != "file":
            return value if parameter is None else parameter.widget.chosen(value)
        path = Path(str(value))
        short_names = {source: short for short, source in self.files.items()}
        if str(path) in short_names:
            return short_names[str(path)]
        short = path.name if path.name not in self.files else f"{len(self.files)}-{path.name}"
        self.files[short] = str(path)
        return short


def written_out(kernel: Kernel) -> str:
    """Return a kernel's text, tidy: its includes in place, without comments but for annotations."""
    lines = _lines(kernel.source)
    return tidy("\n".join([lines[index] for index in without_guards(lines)]))


def _lines(source: SourceText) -> list[str]:
    lines_of_text = []
    for index, line in enumerate(source.lines):
        if line.pragma:
            if not line.chain:
                lines_of_text.append(line.pragma)
        elif line.code.strip():
            note = (
                note_at(source.lines, index).text.strip() if line.code.lstrip().startswith("uniform") else ""
            )
            lines_of_text.append(f"{line.code}  //! {note}" if note else line.code)
    return lines_of_text


def unwired(text: str, name: str) -> str:
    """Return a text whose input has a name that no output has: it then stays unwired.

    An input that nothing is wired to would else take the latest earlier output of its name.
    """
    symbols = read(text)
    members = {symbols.tree.tokens[one.token].spelled for one in symbols.symbols if one.kind == "member"}
    fresh = name if name.startswith("no_") else f"no_{name}"
    renamed = {f"{prefix}{name}": f"{prefix}{fresh}" for prefix in (WIRED, MATCHES, "")}
    tokens = list(as_written(text))  # of every branch, and of macros
    return with_edits(
        text,
        {
            (token.start, token.end): renamed[token.text]
            for before, token in zip([None, *tokens], tokens, strict=False)
            if token.text in renamed and token.start not in members and not (before and before.text == ".")
        },
    )

"""Inline a loaded sketch: techniques of several passes become passes, includes become text."""

from __future__ import annotations

import re
from pathlib import Path

from playground.engine.plan import LoopStep, Plan, PlanNode, PlanRequest, Step
from playground.engine.planner import make_plan
from playground.errors import SketchError
from playground.paths import shown
from playground.shader.dialect import dialects
from playground.shader.header import note_at
from playground.shader.preprocessor import without_guards
from playground.shader.reserved_names import MATCHES, WIRED
from playground.shader.source import SourceText, read_source_and_origin
from playground.sketch.flat import Ref, Source
from playground.sketch.model import ForeignShader, Kernel, PlainFragment, PlainShader, Sketch, Value
from playground.sketch.variants import active_variant
from playground.verify.reduce.case import Case, Pass
from playground.verify.reduce.tokens import tidy

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
    )
    named = [(p.default, step.values[p.name]) for p in kernel.file_parameters]
    files = tuple((str(written), str(parts)) for written, parts in named if foreign)
    return Case(passes=(pass_,), target=name, frame=plan.frame_size, time=plan.time, samples=1, files=files)


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
        text = written(step.kernel)
        variant_text = written(variant.technique) if variant and isinstance(variant.technique, Kernel) else ""
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


def written(kernel: Kernel) -> str:
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
    fresh = name if name.startswith("no_") else f"no_{name}"
    return re.sub(rf"(?<![\w.])({WIRED}|{MATCHES}|){name}\b", lambda match: f"{match.group(1)}{fresh}", text)

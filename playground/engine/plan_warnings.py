"""Report the warnings of a plan's texts and files, which can be drawn: each warning once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from playground.data.live_inputs import LiveInputs
from playground.engine.plan import Plan, PlanNode, Step, most_iterations, walk
from playground.engine.source_kinds import Terrain
from playground.engine.sources import source_kind
from playground.errors import DataError, Diagnostic
from playground.memo import PLANS
from playground.paths import GLSL, shown
from playground.shader import expressions
from playground.shader.dialect import dialects
from playground.shader.expressions import ExpressionError, Number
from playground.sketch.assign import effective_values
from playground.sketch.flat import Flat, Ref, Source
from playground.sketch.model import (
    ComputeVariant,
    CpuSource,
    ForeignShader,
    Graph,
    Kernel,
    Sketch,
    TexelKernel,
    kernels_of,
)
from playground.sketch.variants import INSIDE, canonical_path
from playground.sketch.warnings import unheeded, warnings_of_sketch


class PlanWarnings:
    """Reports each warning of what is drawn, once."""

    def __init__(self, inputs: Callable[[], LiveInputs] = LiveInputs) -> None:
        self.inputs = inputs  # of the engine
        self.report: Callable[[Diagnostic], None] | None = None  # None: nothing is reported
        self._reported: set[tuple[str, str]] = set()  # about what, and of which file
        self._last: Sketch | None = None  # whose file and kernels were looked at last

    def look(self, plan: Plan) -> None:
        """Report the warnings of a plan that were not reported yet."""
        if self.report is None:
            return
        last, self._last = self._last, plan.sketch
        graph, is_new = plan.sketch.graph, last is None
        is_new |= last is not None and not (last.graph is graph and last.warnings is plan.sketch.warnings)
        warnings = list(warnings_of_sketch(plan.sketch)) if is_new else []
        warnings += source_warnings(plan, self.inputs())
        warnings += [w for kernel in (own_kernels(graph) if is_new else ()) for w in unheeded(kernel)]
        for warning in warnings:
            self.once(warning, warning.message)
        for path, warning in _stops_past_the_end(plan):
            self.once(warning, f"steps of {path}")  # in a film each frame would have another number

    def once(self, warning: Diagnostic, about: str) -> None:
        """Report a warning, unless one of its file about the same was reported."""
        if self.report is not None and (about, warning.file) not in self._reported:
            self._reported.add((about, warning.file))
            self.report(warning)


def _stops_past_the_end(plan: Plan) -> list[tuple[str, Diagnostic]]:
    """Return the repeats that stop after more steps than they have now, which change with the time."""
    most = most_iterations(plan.nodes) if plan.steps else {}
    stops = []
    for path, steps in plan.steps.items():
        if steps > most.get(path, steps):
            message = f"steps: '{path}' stops after {steps} steps, but at {plan.time:g} s it has {most[path]}"
            file = shown(plan.sketch.file)
            stops.append((path, Diagnostic(message, file, severity="warning")))
    return stops


def own_kernels(graph: Graph) -> list[Kernel]:
    """Return a sketch's own kernels; those that ship are left out."""
    return [kernel for _, kernel in graph.kernels if not Path(kernel.path).is_relative_to(GLSL)]


def source_warnings(plan: Plan, inputs: LiveInputs | None = None) -> tuple[Diagnostic, ...]:
    """Return what a plan's sources assumed of their files, or lost, at the pass that names each file.

    Of another tool's shader what nothing feeds, at its line; of a live input why nothing comes from it, with
    the inputs that read it. ``inputs`` None: there is no window. And of which parameters, by what their
    kernels say, make no sense together.
    """
    live = inputs or LiveInputs()
    diagnostics: dict[str, Diagnostic] = {}
    assumptions = _assumptions(plan)
    for step in _fed_from_outside(plan.nodes):
        if isinstance(step.kernel, ForeignShader):
            for warning in dialects().unfed_warnings(step.kernel, _wired(plan, step)):
                diagnostics.setdefault(f"{step.kernel.path} {warning.message}", warning)
        if isinstance(step.kernel, CpuSource):
            spec = plan.flat.user(step.path)
            kind, notes = source_kind(step.kernel.registry), tuple[str, ...]()
            with suppress(DataError):  # the file has gone since; drawing reports it
                notes = kind.notes(step.values)
            if lack := kind.lack(step.values, live):
                notes = (*notes, f"{_readers(plan, step)}: {lack}")
            for note in (*notes, *assumptions.get(step.path, ())):
                file = spec.file or shown(step.kernel.path)
                note = note.removeprefix(f"{Path(file).name}: ")  # of a file that was opened itself
                diagnostics.setdefault(note, Diagnostic(note, file, spec.line, severity="warning"))
    for step, conditions in _with_conditions(plan.nodes, plan.flat):
        spec = plan.flat.user(step.path)
        for condition, message, numbers in conditions:
            names: dict[str, Number] = {"size.x": step.size[0], "size.y": step.size[1], **numbers}
            names |= _numbers(step.values)
            with suppress(ExpressionError):  # a division by zero, say: nothing that can be warned of
                if expressions.evaluate(condition, names):
                    text = f"pass '{spec.name}': {message}"
                    file = spec.file or shown(step.kernel.path)
                    diagnostics.setdefault(text, Diagnostic(text, file, spec.line, severity="warning"))
    return tuple(diagnostics.values())


def _assumptions(plan: Plan) -> dict[str, tuple[str, ...]]:
    """Return what is assumed of the terrain's metres, by the path of the source that leaves them open.

    What the sketch says itself is not assumed.
    """
    own, terrain = plan.sketch.terrain, plan.terrain
    for leaf in plan.flat.sources:
        kind, step = source_kind(leaf.kernel.registry), plan.step(leaf.path)
        if step is None:
            continue
        try:
            facts = kind.describe(step.values)
        except DataError:  # the file has gone since; drawing reports it
            return {}
        if facts == Terrain():
            continue
        name, messages = Path(str(step.values[kind.files[0]])).name, list[str]()
        assert terrain.relief is not None and terrain.base_elevation is not None and terrain.extent
        if own.relief is None and facts.relief is None:
            low, high = terrain.base_elevation, terrain.base_elevation + terrain.relief
            messages.append(f"{name}: its heights have no unit and are stretched to {low:g}..{high:g} m")
        elif own.relief is None and facts.assumed:
            messages.append(f"{name}: {facts.assumed}")
        if own.extent is None and facts.extent is None and facts.size and not facts.place:
            messages.append(
                f"{name}: nothing says how large it is; a width of {terrain.extent[0]:g} m is assumed"
            )
        return {leaf.path: tuple(messages)}
    return {}


def _conditions(flat: Flat, step: Step) -> list[tuple[str, str, dict[str, Number]]]:
    """Return what a step's kernel warns of, with its parameters' values where the step has none of its own.

    Where a fast variant runs, which has only some of the parameters, they are those of the technique.
    """
    technique = flat.specs[canonical_path(step.path)].technique
    is_variant = isinstance(step.kernel, ComputeVariant) or f".{INSIDE}." in step.path
    if not is_variant:
        technique = step.kernel
    values = effective_values(technique)
    conditions = []
    for path, kernel in kernels_of(technique):
        if not isinstance(kernel, TexelKernel):
            continue
        own = {p.name: values[f"{path}.{p.name}" if path else p.name] for p in kernel.parameters}
        conditions += [(condition, message, _numbers(own)) for condition, message in kernel.warns]
    return conditions


def _numbers(values: Mapping[str, object]) -> dict[str, Number]:
    return {name: value for name, value in values.items() if isinstance(value, int | float)}


@PLANS.cached(identities=2)
def _with_conditions(
    nodes: tuple[PlanNode, ...], flat: Flat
) -> tuple[tuple[Step, list[tuple[str, str, dict[str, Number]]]], ...]:
    """Return the steps of kernels that warn of some values of their parameters, and what they warn of."""
    each = [(step, _conditions(flat, step)) for step in walk(nodes)]
    return tuple([(step, conditions) for step, conditions in each if conditions])


@PLANS.cached(identities=1)
def _fed_from_outside(nodes: tuple[PlanNode, ...]) -> tuple[Step, ...]:
    """Return the steps of sources, and of other tools' shaders."""
    return tuple([step for step in walk(nodes) if isinstance(step.kernel, ForeignShader | CpuSource)])


def _readers(plan: Plan, source: Step) -> str:
    """Return the inputs that read a step, or its own name where none does."""
    inputs = [(name, s) for step in plan.walk() for name, s in step.inputs]
    readers = dict.fromkeys(name for name, s in inputs if isinstance(s, Ref) and s.path == source.path)
    return ", ".join(readers) or source.path


def _wired(plan: Plan, step: Step) -> set[str]:
    """Return the inputs that something feeds besides the stand-ins that another tool's shader comes with."""

    def is_stand_in(name: str, source: Source) -> bool:
        if not isinstance(source, Ref) or source.path not in dialects().stand_in_paths(step.path, name):
            return False
        return plan.flat.specs[source.path].use in dialects().stand_ins()

    return {name for name, source in step.inputs if source is not None and not is_stand_in(name, source)}

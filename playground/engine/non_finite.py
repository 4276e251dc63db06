"""Find the first number that is not finite among what went into a picture.

NaN and infinity spread, and then hide: a picture's bytes hold neither, the blur of an edge or
a `max` swallows them, and what is left is a black spot or none. So every texture of floating
point that the last frame went through is looked at, in the order in which the passes ran.

Passes that write bytes themselves (nearly every view does, and weights of textures) hide
theirs: such a pass is run once more into textures of half floats, and what it writes there is
looked at. What is not finite there may only be too large for a half: then the pass is run into
32 bits as well. It need be done only for one that has run again; of terrain that stays, and is lit
again, only the light is looked at again. Left as they are: passes inside a loop, kernels that
repeat, compute variants (whose kernels give the same), and draws that go on from another one's samples.

A hole in the terrain counts too: no shipped source leaves one (`no_data` refuses or fills them),
and the kernels that bear with one do so to show it, not to want it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from playground.engine.execution import FrameSource
from playground.engine.plan import LoopStep, Plan, Step, every_node
from playground.engine.results import Result, Wired
from playground.engine.textures import read_bands, split_format
from playground.shader.wrap import FRAGMENT
from playground.sketch.flat import Ref
from playground.sketch.model import Draw, Kernel, PlainFragment, TexelKernel

if TYPE_CHECKING:
    import moderngl


# All bits of the exponent are set in NaN and infinity, and in nothing else (IEEE 754).
_EXPONENTS: dict[np.dtype[Any], tuple[str, int]] = {
    np.dtype("f2"): ("u2", 0x7C00),
    np.dtype("f4"): ("u4", 0x7F800000),
}


@dataclass(frozen=True, slots=True)
class NotFinite:
    """Where numbers are not finite."""

    path: str  # of the pass
    output: str
    texel: tuple[int, int]  # x and y from the south-west corner, of the first, row by row from the south
    value: str  # "NaN", "infinity" or "-infinity"
    count: int  # texels of that texture with such a number
    size: tuple[int, int]  # texels of it

    def __str__(self) -> str:
        x, y = self.texel
        whole = self.size[0] * self.size[1]
        where = f"pass '{self.path}', output '{self.output}': {self.value} at texel ({x}, {y})"
        return f"{where} from the south-west corner; {self.count} of {whole} texels are not finite"

    def everywhere(self) -> str:
        """Describe it of a texture in which no texel is finite."""
        where = f"pass '{self.path}', output '{self.output}'"
        return (
            f"{where}: none of its {self.size[0] * self.size[1]} texels is finite; the first is {self.value}"
        )


class FiniteCheck:
    """Checks the textures of a source's frames; remembers which it has checked."""

    def __init__(self, source: FrameSource) -> None:
        self.source = source
        self.looked_at = 0  # textures read for the last frame
        # What was found of each result, and after how many iterations: some go on in place.
        self._checked: WeakKeyDictionary[Result, tuple[int, NotFinite | None]] = WeakKeyDictionary()
        self._wide: dict[tuple[int, str], tuple[Kernel, Kernel]] = {}  # kernels whose outputs are floats
        self._early: dict[tuple[str, str], NotFinite | None] = {}  # as passes ran, by the step's path and key

    def first(self) -> NotFinite | None:
        """Return what is not finite in the first such texture of the last frame; None if all is."""
        return next((not_finite for not_finite in self.looks() if not_finite is not None), None)

    def look_early(self, step: Step, result: Result, key: str) -> None:
        """Look at what a step outside of loops has just given: it will not be there when the frame ends."""
        self._early[step.path, key] = self._look(step, result, within=False)

    def looks(self) -> Iterator[NotFinite | None]:
        """Look at the last frame, a pass at a time: yield after each what is not finite in it.

        Of a pass with several such outputs, the first. It ends early if another frame is drawn meanwhile.
        """
        self.looked_at = 0
        record = self.source.record
        for step, within in _steps(record.plan):
            early = step.path, record.keys.computed(step.path)
            if early in self._early:
                yield self._early[early]
                continue
            now = self.source.record
            if now.plan is not record.plan or now.results is not record.results:
                return
            result = record.results.get(step.path)
            if result is None:
                continue
            iterations, entry = self._checked.get(result, (-1, None))
            if iterations != result.iterations:
                with self.source.borrowed():
                    entry = self._look(step, result, within)
                self._checked[result] = result.iterations, entry
            # Another sketch may have the same result under another name.
            yield entry if entry is None else replace(entry, path=step.path)

    def _look(self, step: Step, result: Result, within: bool) -> NotFinite | None:
        for output in result.outputs:
            if output.format.endswith("f"):
                self.looked_at += 1
                not_finite = _not_finite(result.textures[output.name])
                if not_finite is not None:
                    return replace(not_finite, path=step.path, output=output.name)
        if within or all(output.format.endswith("f") for output in result.outputs):
            return None
        not_finite = self._look_beneath(step, result, "16f")
        return not_finite if not_finite is None else self._look_beneath(step, result, "32f")

    def _look_beneath(self, step: Step, result: Result, form: str) -> NotFinite | None:
        """Look at what a pass that writes bytes would have written, in floats of a form."""
        again = self._again(step, form)
        if again is None:
            return None
        wide, inputs = again
        runner = self.source.runner
        # Of a kernel the fragment driver has the same text for any format, so nothing is compiled.
        made = runner.run(wide, inputs, driver=FRAGMENT)
        try:
            for output in result.outputs:
                if not output.format.endswith("f"):
                    self.looked_at += 1
                    not_finite = _not_finite(made.textures[output.name])
                    if not_finite is not None:
                        return replace(not_finite, path=step.path, output=output.name)
        finally:
            runner.pool.give(made)
        return None

    def _again(self, step: Step, form: str) -> tuple[Step, Mapping[str, Wired]] | None:
        """Return a step that writes floats, and what it reads; None if it is left as it is."""
        kernel = step.kernel
        if not isinstance(kernel, TexelKernel | Draw | PlainFragment) or kernel.repeat != "1":
            return None
        inputs: dict[str, Wired] = {}
        for name, source in step.inputs:
            if not isinstance(source, Ref):
                inputs[name] = Wired()
                continue
            result = self.source.record.results.get(source.path)
            if result is None:
                return None
            if isinstance(kernel, Draw) and name == "initial" and result.surface is not None:
                return None
            inputs[name] = Wired(result, result.textures[source.output], source.output)
        return replace(step, kernel=self._widened(kernel, form)), inputs

    def _widened(self, kernel: Kernel, form: str) -> Kernel:
        entry = self._wide.get((id(kernel), form))
        if entry is None:
            outputs = tuple(replace(o, format=_widened(o.format, form)) for o in kernel.outputs)
            entry = self._wide[id(kernel), form] = kernel, replace(kernel, outputs=outputs)
            while len(self._wide) > 64:
                self._wide.pop(next(iter(self._wide)))
        return entry[1]


def _not_finite(texture: moderngl.Texture) -> NotFinite | None:
    """Return where numbers of a texture are not finite; a large one is read a part at a time."""
    first, count = None, 0
    for south, values in read_bands(texture):
        not_finite = not_finite_in(values)
        if not_finite is not None:
            count += not_finite.count
            first = first or replace(not_finite, texel=(not_finite.texel[0], south + not_finite.texel[1]))
    width, height = texture.size
    return first and replace(first, count=count, size=(width, height))


def not_finite_in(values: NDArray[Any]) -> NotFinite | None:
    """Return where numbers of a texture, (ny, nx) or (ny, nx, components), are not finite; None if all are.

    Floats of 16 or 32 bits; others are always finite.
    """
    if values.dtype not in _EXPONENTS:
        return None
    whole, exponent = _EXPONENTS[values.dtype]
    wrong: NDArray[np.bool_] = (values.view(whole) & exponent) == exponent
    if not wrong.any():
        return None
    texels = wrong if wrong.ndim == 2 else wrong.any(axis=2)
    y, x = divmod(int(texels.argmax()), texels.shape[1])
    value = float(np.atleast_1d(values[y, x])[np.atleast_1d(wrong[y, x])][0])
    name = "NaN" if np.isnan(value) else "infinity" if value > 0 else "-infinity"
    return NotFinite("", "", (x, y), name, int(np.count_nonzero(texels)), (texels.shape[1], texels.shape[0]))


def _widened(form: str, output: str) -> str:
    components, _ = split_format(form)
    return form if form.endswith("f") else {1: "r", 2: "rg", 4: "rgba"}[components] + output


def _steps(plan: Plan | None) -> Iterator[tuple[Step, bool]]:
    """Yield the steps of a plan in order, and whether each is inside a loop."""
    if plan is None:
        return
    inside: set[int] = set()
    for node in every_node(plan.nodes):
        if isinstance(node, LoopStep):
            inside |= {id(step) for step in every_node(node.body)}
        else:
            yield node, id(node) in inside

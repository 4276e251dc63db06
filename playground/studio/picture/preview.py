"""Draw a preview on a software renderer: what is being changed shows at once, and in full when it rests.

One sample a pixel instead of several, and a mesh of a quarter of the vertices where the user set no
number of them; of a seventh where the picture has fewer pixels too. Each pass before the draw stays
as it is, so that the full picture differs from the preview along edges alone. Samples go first:
for what four of them cost in a third of the pixels a side, half of the pixels a side are drawn with one.
Of a pass that runs anyway, as one of shadows while the sun is dragged, a menu has the choice that its
annotation gives for previews, unless somebody set that menu or something of the same group. A number
has the one for previews where these have fewer pixels than the picture.

A preview has as many pixels as let it follow the hand that moves it. A picture's cost grows with its
pixels. What the passes took lately says what the next picture will take at its whole size, at a half, a
third and a quarter of the pixels a side: the largest is chosen that stays within its budget. Where passes
cost most that do not follow the picture's size, as one that makes terrain, fewer pixels gain nothing, and
it stays whole.

The budget grows as the pixels go: all of them are worth having at 25 pictures a second, a half of
each side at 10, a quarter at 5.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import Any

from playground.engine.engine import Engine
from playground.engine.meshes import mesh_parameters
from playground.engine.plan import LoopStep, Plan, every_node, walk
from playground.shader.expressions import follows_time
from playground.sketch.assign import values_of
from playground.sketch.model import Draw, Kernel, Parameter, Sketch, Value
from playground.sketch.traits import traits_of
from playground.studio.cost.costs import PassCosts

Size = tuple[int, int]

GRID = 129  # vertices a side
GRID_OF_FEWER = 97  # for fewer pixels than the picture has
_RESOLUTION = "grid"  # the draw's parameter that sets the resolution of its mesh


def as_preview(
    sketch: Sketch, size: Size = (1, 1), pixels: Size = (1, 1), faster: Collection[str] = ()
) -> Sketch:
    """Return a sketch to draw as a preview; the same object where that would make no difference.

    ``pixels`` are drawn of a picture of a ``size``, and enlarged; ``faster`` are the paths of passes
    whose menus have the choices of previews.
    """
    traits = traits_of(sketch)
    draws = [(path, k) for path, k in traits.draws if _RESOLUTION in mesh_parameters(k.mesh)]
    fewer = pixels[0] < size[0]
    quick = [(path, k) for path, k in traits.faster if path in faster or fewer]
    values = values_of(sketch) if draws or quick else {}
    coarse: list[tuple[str, Value]] = []
    grid = GRID_OF_FEWER if fewer else GRID
    for path, kernel in draws:
        parameter = kernel.parameter(_RESOLUTION)
        name = f"{path}.{_RESOLUTION}"
        if parameter is not None and values[name] == parameter.default and int(parameter.default) > grid:  # type: ignore[arg-type]
            coarse.append((name, grid))
    chosen = [
        (f"{path}.{parameter.name}", parameter.widget.preview)
        for path, kernel in quick
        for parameter in kernel.parameters
        if parameter.widget.preview is not None
        and (path in faster if parameter.widget.kind == "menu" else fewer)
        and _is_unset(path, parameter, kernel, values)
    ]
    samples = 1 if traits.draws else sketch.picture.samples
    if sketch.picture.samples == samples and not coarse and not chosen:
        return sketch
    sketch = replace(sketch, overrides=(*sketch.overrides, *coarse, *chosen))
    return sketch.with_picture(samples=samples)


def _is_unset(path: str, parameter: Parameter, kernel: Kernel, values: Mapping[str, Value]) -> bool:
    """Return whether a parameter has its default, and of a menu all else of its group has.

    Who has set something of a menu's group wants to see what that does, and another form may not read it.
    """
    group = [p for p in kernel.parameters if p.group and p.group == parameter.group]
    if parameter.widget.kind != "menu" or not group:
        group = [parameter]
    return all(values[f"{path}.{p.name}"] == p.default for p in group)


# ── the size ──────────────────────────────────────────────────────────────────


BUDGETS = {1: 0.04, 2: 0.1, 3: 0.15, 4: 0.2}
"""[s] that a picture may take while something moves, by the parts that each side is divided by."""
DIVISORS = tuple(BUDGETS)
SLOW = 0.2
"""[s] of a whole picture from which on time that runs is better paused, so that it is seen at all."""
MIN_PREVIEW_PIXELS = 2**15
"""Pixels that a preview has at least: fewer show nothing."""

_STAYS, _GROWS = 1.2, 0.8  # of the budget: within these the size does not change, so that it is steady
_GAINS = 1.25  # what none brings into the budget has to gain by as much with fewer pixels


def divided(size: Size, divisor: int) -> Size:
    """Return a picture's size with each side divided, at least one pixel."""
    return max(round(size[0] / divisor), 1), max(round(size[1] / divisor), 1)


def chosen_divisor(expected: Mapping[int, float], current: int) -> int:
    """Return the divisor of the sides for the next picture.

    ``expected``: seconds by divisor; ``current``: the last picture's. The choice has hysteresis: what
    fits stays until it takes a fifth more than its budget, and grows where a fifth is left.
    """

    def fits(divisor: int) -> bool:
        factor = _STAYS if divisor == current else _GROWS if divisor < current else 1.0
        return expected[divisor] <= BUDGETS[divisor] * factor

    divisors = [divisor for divisor in expected if fits(divisor)]
    if not divisors:
        enough = _GAINS * min(expected.values())
        divisors = [divisor for divisor in expected if expected[divisor] <= enough]
    return min(divisors)


class PreviewSize:
    """The size of one session's previews, by what its passes took."""

    def __init__(self) -> None:
        self.divisor = 1  # of each side, of the last picture that was chosen for
        self.guessed = False  # nobody knew what that one would take
        self.whole = 0.0  # [s] that it would take with all pixels, as far as is known
        self._costs = PassCosts()

    def take(self, plan: Plan, times: Mapping[str, float], *, in_full: bool) -> None:
        """Take what the passes of a picture took [ms], by path.

        ``in_full``: its draws had more samples and vertices than those of a preview, and are left out.
        """
        draws = {step.path for step in plan.walk() if isinstance(step.kernel, Draw)} if in_full else set()
        taken = {path: spent for path, spent in times.items() if path not in draws}
        self._costs.take(_texels(plan), taken)

    def forget(self) -> None:
        """Forget all: another sketch is opened."""
        self.divisor = 1
        self._costs.clear()

    def choose(
        self, engine: Engine, sketch: Sketch, size: Size, changed: Collection[str] | None, **at: Any
    ) -> Size:
        """Return the pixels for the next picture of a sketch, of which ``changed`` passes will run.

        None: those that are stale. A pass that runs once for another size, and then no more, is not
        counted. ``at``: the time and what else ``Engine.plan_for`` takes. Raises as that does.
        """
        self.guessed, self.whole = False, 0.0
        possible = [d for d in DIVISORS if d == 1 or size[0] * size[1] >= MIN_PREVIEW_PIXELS * d * d]
        if len(possible) == 1:
            self.divisor = 1
            return size
        whole = engine.plan(sketch, size, **at)
        smaller = engine.plan(sketch, divided(size, 2), **at)
        sizes, halved = _texels(whole), _texels(smaller)
        following = {path for path, texels in sizes.items() if halved.get(path) != texels}
        # Of the picture in full it is others: that has fast variants of its own.
        if changed is None or not sizes.keys() >= set(changed):
            changed = engine.stale(sketch, size=size, **at)
        if not _goes_on(whole).isdisjoint(following):
            self.divisor = 1  # it would begin again at each size
            return size
        expected: dict[int, float] = {}
        for divisor in possible:
            cost = 0.0
            for path in changed:
                texels = sizes[path] // (divisor**2 if path in following else 1)
                spent = self._costs.expected(path, max(texels, 1))
                if spent is None and path in following:
                    self.divisor, self.guessed = possible[-1], True
                    return divided(size, self.divisor)
                cost += (spent or 0.0) / 1e3
            expected[divisor] = cost
        self.whole = expected[1]
        self.divisor = chosen_divisor(expected, self.divisor)
        return divided(size, self.divisor)


def _texels(plan: Plan) -> dict[str, int]:
    return {step.path: step.size[0] * step.size[1] for step in plan.walk()}


def _goes_on(plan: Plan) -> set[str]:
    """Return the paths of the passes that go on from an earlier time's, as those of a simulation do."""
    names: set[str] = set()
    for node in every_node(plan.nodes):
        if isinstance(node, LoopStep):
            if follows_time(node.spec.repeat):
                names |= {step.path for step in walk(node.body)}
        elif follows_time(node.kernel.repeat):
            names.add(node.path)
    return names

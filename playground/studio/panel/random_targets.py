"""Choose which parameters random values are for: those of the terrain's shape, unless more is wanted.

Sun, camera and exposure at random give pictures in which nothing can be compared, and the
sizes of a raw file at random give no terrain at all.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from playground.sketch.model import Parameter, PassSpec, Sketch, kernels_of
from playground.sketch.wiring import output_names
from playground.studio.edits.edits import Draft
from playground.studio.panel.parameter_list import Filter, Item, Listing

Targets = list[tuple[str, Parameter]]


def targets(
    draft: Draft | None, listing: Listing, filter_: Filter, *, everything: bool = False
) -> tuple[Targets, str]:
    """Return the parameters that random values are for, by path, and a few words for them.

    What a search has found; else, with ``everything``, all that the passes show; else the main
    parameters of the passes that make the shape, or all that those show. In a sketch without
    such passes: its main parameters, or all that its passes show but the view's.
    """
    if draft is None:
        return [], ""
    sections = listing.filtered(draft, filter_).values()
    items, words = [item for section in sections for item in section.items], "those found by the search"
    if not filter_:
        items, words = [item for item in items if item.exported], "all that the passes show"
        if not everything:
            items, words = _of_the_shape(draft.base, items, listing.main(draft))
    return [(item.path, item.parameter) for item in items if item.path not in draft.edits.locked], words


def _of_the_shape(sketch: Sketch, items: list[Item], main: tuple[Item, ...]) -> tuple[list[Item], str]:
    others = [spec for spec in sketch.graph.passes if spec.name != "view"]
    shape = [spec for spec in others if "height" in output_names(spec.technique) and not _reads_file(spec)]
    for places_found, words in (
        (_within(main, shape), "the main ones of the shape"),
        (_within(items, shape), "those of the shape"),
        (_within(main, others), "the main ones"),
        (_within(items, others), "every pass but the view"),
    ):
        if places_found:
            return places_found, words
    return [], "there are none"


def _within(items: Iterable[Item], passes: Collection[PassSpec]) -> list[Item]:
    names = {spec.name for spec in passes}
    return [item for item in items if item.path.partition(".")[0] in names]


def _reads_file(spec: PassSpec) -> bool:
    """Say whether a pass reads a file: its terrain is not made, and its parameters say how it is stored."""
    return any(p.widget.kind == "file" for _, kernel in kernels_of(spec.technique) for p in kernel.parameters)

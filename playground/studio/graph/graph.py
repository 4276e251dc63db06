"""The passes of a sketch as a graph: which reads which, and where each is drawn.

A pass is one column right of the last that it reads, as in Sugiyama, Tagawa and Toda
1981, "Methods for Visual Understanding of Hierarchical System Structures"; within a column
passes are put in the order of the middle of those that they are joined to.

Thumbnails of its textures are drawn small by the graphics card, only when stale, one at a time.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import make_texture
from playground.errors import counted
from playground.shader.colours import linear_to_srgb
from playground.shader.own_shaders import own_shader
from playground.sketch.flat import Fed, Flat, Ref, leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch
from playground.studio.picture.full_screen import TexelShader
from playground.studio.session import Session, Version

if TYPE_CHECKING:
    import moderngl

Edge = tuple[str, str]
"""From who gives to who reads."""
_SWEEPS = 4


@dataclass(frozen=True)
class Wiring:
    """A sketch's passes as a graph with a layout."""

    refs: Mapping[str, str]  # each node's texture, "pass:output", by the node's path; in the order they run
    edges: tuple[Edge, ...]
    places: Mapping[str, tuple[int, int]]  # column from the left, row from above


def wiring_of(sketch: Sketch, *, inner: bool) -> Wiring:
    """Return the graph of a sketch's own passes, or of all passes that run, those inside techniques."""
    flat = flatten(sketch)
    refs: dict[str, str] = {}
    edges: dict[Edge, None] = {}
    for leaf in leaves_of(flat.nodes):
        node = leaf.path if inner else leaf.path.partition(".")[0]
        refs.setdefault(node, _main(flat, node))
        for _, source in leaf.inputs:
            giver = _giver(flat, source)
            giver = giver if inner else giver.partition(".")[0]
            if giver and giver != node and not isinstance(source, Fed):
                edges[giver, node] = None
    return Wiring(refs, tuple(edges), node_grid(tuple(refs), tuple(edges)))


def cost_of(session: Session, node: str) -> tuple[str, bool, float | None]:
    """Return how often a pass ran, as "3 runs", whether it did for the last picture, and its time [ms].

    What is inside it counts. Without a time None.
    """
    engine = session.engine
    inside = [path for path in engine.runs if path == node or path.startswith(f"{node}.")]
    spent = [session.times[path] for path in inside if path in session.times]
    runs = counted(sum(engine.runs[path] for path in inside), "run")
    return runs, any(path in inside for path in engine.record.ran), sum(spent) if spent else None


def node_grid(nodes: Sequence[str], edges: Sequence[Edge]) -> dict[str, tuple[int, int]]:
    """Return a column and a row for each node; every edge goes to the right, no two nodes share a place.

    The nodes are in an order in which each comes after those that it reads.
    """
    column = dict.fromkeys(nodes, 0)
    for node in nodes:
        column[node] = max((column[giver] + 1 for giver, reader in edges if reader == node), default=0)
    columns = [[n for n in nodes if column[n] == c] for c in range(max(column.values(), default=-1) + 1)]
    row = {node: float(r) for each in columns for r, node in enumerate(each)}
    for sweep in range(_SWEEPS):
        for each in columns if sweep % 2 == 0 else columns[::-1]:
            middles = {node: _middle(node, edges, row, sweep % 2) for node in each}
            each.sort(key=lambda node: middles[node])
            row |= {node: float(r) for r, node in enumerate(each)}
    return {node: (c, r) for c, each in enumerate(columns) for r, node in enumerate(each)}


def _middle(node: str, edges: Sequence[Edge], row: Mapping[str, float], backwards: int) -> float:
    """Return the mean row of those on one side that a node is joined to; its own where there is none."""
    near = [row[edge[backwards]] for edge in edges if edge[1 - backwards] == node]
    return sum(near) / len(near) if near else row[node]


def _giver(flat: Flat, source: object) -> str:
    return source.path if isinstance(source, Ref) and source.path.partition(".")[0] in flat.specs else ""


def _main(flat: Flat, node: str) -> str:
    """Return a node's texture: that of its own name, else its first."""
    outputs = flat.outputs[node]
    name = node.rpartition(".")[2]
    return f"{node}:{name if name in outputs else next(iter(outputs))}"


# ── thumbnails ────────────────────────────────────────────────────────────────


SIDE = 64
"""Texels of a thumbnail."""
THUMBNAIL_INTERVAL = 0.1
"""[s] from one that is drawn to the next."""
_NO_NUMBER = (1.0, 0.0, 1.0)


class Thumbnails:
    """The thumbnails of one session's textures, by name."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.made = 0  # how many were drawn so far
        self._cached: dict[str, tuple[object, moderngl.Texture]] = {}  # what each is of, and the thumbnail
        self._shrink: TexelShader | None = None
        self._last = -THUMBNAIL_INTERVAL

    def get(self, name: str) -> moderngl.Texture | None:
        """Return the thumbnail of "pass:output" as it was drawn last, ``SIDE`` texels a side; rgba8."""
        cached = self._cached.get(name)
        return cached[1] if cached is not None else None

    def is_current(self, name: str) -> bool:
        """Return whether the last picture was made from this very texture."""
        source, cached = self._source(name), self._cached.get(name)
        return source is not None and cached is not None and cached[0] == source[1]

    def refresh(self, names: Iterable[str], now: float) -> bool:
        """Draw the first that is stale, unless another was drawn a moment ago; return whether more are stale.

        ``now``: seconds of any clock. What has another name is released.
        """
        names_shown = list(names)
        for name in [name for name in self._cached if name not in names_shown]:
            self._cached.pop(name)[1].release()
        stale = [n for n in names_shown if self._source(n) is not None and not self.is_current(n)]
        if stale and now - self._last >= THUMBNAIL_INTERVAL and not self.session.awaits_data:
            self._last = now
            self._draw(stale.pop(0))
        return bool(stale)

    def release(self) -> None:
        """Release all of them; they are drawn again where they are needed."""
        cached, self._cached = self._cached, {}
        shrink, self._shrink = self._shrink, None
        for _, texture in cached.values():
            texture.release()
        if shrink is not None:
            shrink.release()

    def _draw(self, name: str) -> None:
        source = self._source(name)
        assert source is not None
        texture, of = source
        engine = self.session.engine
        if self._shrink is not None and self._shrink.ctx is not engine.ctx:
            self._shrink, self._cached = None, {}  # they went with a context that was lost
        with engine.borrowed():
            if self._shrink is None:
                self._shrink = TexelShader(engine.ctx, own_shader("thumbnail.frag"), (SIDE, SIDE))
            values = self._shrink.compute({"shown": texture}, side=float(SIDE))
            cached = self._cached.get(name)
            small = cached[1] if cached is not None else make_texture(engine.ctx, (SIDE, SIDE), "rgba8")
            small.filter = (engine.ctx.LINEAR, engine.ctx.LINEAR)
            small.write(picture_of(values, texture.components, encoded=texture.dtype == "f1").tobytes())
        self._cached[name] = of, small
        self.made += 1

    def _source(self, name: str) -> tuple[moderngl.Texture, Version] | None:
        if name.partition(":")[0].partition(".")[0] == "view" and self.session.view.map is not None:
            return None  # that is the map
        return self.session.result_of(name)


def picture_of(values: NDArray[np.float32], components: int, *, encoded: bool) -> NDArray[np.uint8]:
    """Return texels, (ny, nx, 4), as a picture of bytes.

    One or two components are numbers, from the least to the greatest; more are light, and
    ``encoded`` colours are as the eye takes them already.
    What is no number is magenta.
    """
    shown = values[..., :1] if components < 3 else values[..., :3]
    finite = np.isfinite(shown)
    tidy = np.where(finite, shown, 0.0).astype(np.float64)
    if components < 3:
        low = float(tidy[finite].min()) if finite.any() else 0.0
        high = float(tidy[finite].max()) if finite.any() else 0.0
        tidy = np.repeat((tidy - low) / ((high - low) or 1.0), 3, axis=2)
        finite = np.repeat(finite, 3, axis=2)
    else:
        tidy = np.clip(tidy, 0.0, 1.0)
        tidy = tidy if encoded else np.asarray(linear_to_srgb(tidy))
    colour = np.where(finite.all(axis=2, keepdims=True), tidy, np.array(_NO_NUMBER))
    alpha = np.ones((*colour.shape[:2], 1))
    whole: NDArray[np.float64] = np.concatenate([colour, alpha], axis=2)
    return np.rint(np.clip(whole, 0, 1) * 255).astype(np.uint8)


# ── the window ────────────────────────────────────────────────────────────────


@dataclass
class Graph:
    """The window of the passes."""

    session: Session
    on: bool = False
    inner: bool = False  # passes inside techniques, too
    timed: bool = False
    _stale: bool = False
    _wiring: tuple[object, bool, Wiring] | None = None  # of which sketch's passes, with those inside
    thumbnails: Thumbnails = field(init=False)

    def __post_init__(self) -> None:
        self.thumbnails = Thumbnails(self.session)

    def toggle(self) -> None:
        """Show or hide the passes."""
        self.on = not self.on

    def wiring(self, sketch: Sketch) -> Wiring:
        """Return the graph of a sketch; worked out once for each."""
        if self._wiring is None or self._wiring[0] is not sketch.graph or self._wiring[1] != self.inner:
            self._wiring = sketch.graph, self.inner, wiring_of(sketch, inner=self.inner)
        return self._wiring[2]

    def update(self, now: float) -> None:
        """Draw one stale thumbnail; release all while the graph is hidden."""
        sketch = self.session.sketch
        if not self.on or sketch is None:
            self._stale = False
            self.thumbnails.release()
        else:
            self._stale = self.thumbnails.refresh(self.wiring(sketch).refs.values(), now)

    @property
    def waits(self) -> bool:
        """Whether thumbnails are still to be drawn."""
        return self.on and self._stale

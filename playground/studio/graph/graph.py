"""The passes of a sketch as a graph: which reads which, what is chosen in it, and thumbnails of its textures.

Thumbnails are drawn small by the graphics card, only when stale, one at a time.
"""

from __future__ import annotations

import tomllib
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import make_texture
from playground.paths import SKETCHES
from playground.shader.colours import linear_to_srgb
from playground.shader.own_shaders import own_shader
from playground.sketch.edit_passes import Wire, carried_by, closes_circle, output_for, wires_of
from playground.sketch.flat import Fed, Flat, Ref, leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch
from playground.sketch.wiring import input_names
from playground.studio.graph.edits import Catalogue, Entry, outputs_of
from playground.studio.graph.layout import Edge, Layout, layout_of, nearest_node
from playground.studio.language import counted
from playground.studio.picture.full_screen import TexelShader
from playground.studio.picture.view import Place
from playground.studio.session import Session, Version
from playground.studio.start.thumbnails import place_of, read_atlas, thumbnails

if TYPE_CHECKING:
    import moderngl

MAX_PLACES = 500
"""Nodes whose places are remembered; those that were moved first are forgotten."""

Pin = tuple[str, str]
"""A pass, and the name of an input or an output."""


@dataclass(frozen=True)
class Wiring:
    """A sketch's passes as a graph with a layout."""

    refs: Mapping[str, str]  # each node's texture, "pass:output", by the node's path; in the order they run
    wires: tuple[Wire, ...]
    layout: Layout
    inputs: Mapping[str, tuple[str, ...]]  # the pins at each node's left
    outputs: Mapping[str, tuple[str, ...]]  # and at its right, the main one first
    above: tuple[str, ...] = ()  # nodes that were moved, and lie over the others; the last on top

    @property
    def edges(self) -> tuple[Edge, ...]:
        """From who gives to who reads."""
        return tuple(dict.fromkeys((wire.giver, wire.reader) for wire in self.wires))

    def input_for(self, giver: str, output: str, reader: str) -> str:
        """Return the input that a wire dropped on a node feeds: of its name, else free, else the first."""
        names = self.inputs.get(reader, ())
        taken = {wire.input for wire in self.wires if wire.reader == reader}
        free = next((name for name in names if name not in taken), "")
        return output if output in names else free or next(iter(names), "")

    def wire_to(self, pin: Pin | None) -> Wire | None:
        """Return the wire to an input, given as (reader, input); None for none."""
        return next((wire for wire in self.wires if (wire.reader, wire.input) == pin), None)

    def moved(self, places: Mapping[str, Place]) -> Wiring:
        """Return the graph with some nodes elsewhere."""
        above = tuple(node for node in places if node in self.refs)
        others = tuple(node for node in self.above if node not in above)
        return replace(self, layout=self.layout.moved(places), above=others + above) if above else self

    @property
    def stacked(self) -> list[str]:
        """The nodes from the lowest to the one on top."""
        return [*(node for node in self.refs if node not in self.above), *self.above]


def wiring_of(sketch: Sketch, inside: str | None = None) -> Wiring:
    """Return the graph of a sketch's own passes, or of those that run ``inside`` one of them; "": in all."""
    flat = flatten(sketch)
    head = f"{inside}." if inside else ""
    paths = [leaf.path for leaf in leaves_of(flat.nodes) if leaf.path.startswith(head)]
    nodes = paths if inside is not None else [path.partition(".")[0] for path in paths]
    refs = {node: _main(flat, node) for node in nodes}
    if inside is not None:
        wires = tuple(w for w in _inner_wires(flat) if w.giver in refs and w.reader in refs)
        inputs: dict[str, tuple[str, ...]] = {w.reader: ("",) for w in wires}
        outputs: dict[str, tuple[str, ...]] = {w.giver: ("",) for w in wires}
    else:
        wires = tuple(wire for wire in wires_of(sketch.graph) if wire.giver != wire.reader)
        inputs, outputs = {}, {}
        for spec in sketch.graph.passes:
            written = [wire.input for wire in wires if wire.reader == spec.name]
            inputs[spec.name] = tuple(dict.fromkeys([*input_names(spec.technique), *written]))
            outputs[spec.name] = outputs_of(spec) if spec.name != "view" else ()
    edges = tuple(dict.fromkeys((wire.giver, wire.reader) for wire in wires))
    return Wiring(refs, wires, layout_of(tuple(refs), edges), inputs, outputs)


def _inner_wires(flat: Flat) -> tuple[Wire, ...]:
    """Return the wires between the kernels that run, of each two one."""
    edges: dict[Edge, None] = {}
    for leaf in leaves_of(flat.nodes):
        for _, source in leaf.inputs:
            giver = _giver(flat, source)
            if giver and giver != leaf.path and not isinstance(source, Fed):
                edges[giver, leaf.path] = None
    return tuple(Wire(giver, "", reader, "", giver, False) for giver, reader in edges)


def cost_of(session: Session, node: str) -> tuple[str, bool, float | None]:
    """Return how often a pass ran, as "3 runs", whether it did for the last picture, and its time [ms].

    What is inside it counts. Without a time None.
    """
    engine = session.engine
    inside = [path for path in engine.runs if path == node or path.startswith(f"{node}.")]
    spent = [session.times[path] for path in inside if path in session.times]
    runs = counted(sum(engine.runs[path] for path in inside), "run")
    return runs, any(path in inside for path in engine.record.ran), sum(spent) if spent else None


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


class Pictures:
    """Pictures of techniques: of the shipped sketch named like one, else of the least that uses it."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self._cells: dict[str, int] | None = None  # by technique: its place in the atlas
        self._atlas: moderngl.Texture | None = None

    @property
    def cells(self) -> Mapping[str, int]:
        """The place in the atlas of each technique that has a picture."""
        if self._cells is None:
            self._cells = _cells()
        return self._cells

    def get(self, use: str) -> tuple[moderngl.Texture, tuple[float, float, float, float]] | None:
        """Return a texture, and what of it shows a technique: left, top, right, bottom; None without one."""
        cell = self.cells.get(use, -1)
        if cell < 0:
            return None
        if self._atlas is None:
            try:
                pixels = np.asarray(read_atlas())
            except OSError:
                self._cells = {}
                return None
            size = pixels.shape[1], pixels.shape[0]
            ctx = self.session.engine.ctx
            self._atlas = ctx.texture(size, 3, pixels.tobytes(), alignment=1)
            self._atlas.filter = ctx.LINEAR, ctx.LINEAR
        return self._atlas, place_of(cell, self._atlas.size)

    def release(self) -> None:
        """Release the atlas."""
        atlas, self._atlas = self._atlas, None
        if atlas is not None:
            atlas.release()


def _cells() -> dict[str, int]:
    """Return the place in the atlas of each technique's picture."""
    found: dict[str, tuple[bool, int, int]] = {}
    for row in thumbnails():
        table = tomllib.loads((SKETCHES / f"{row.name}.toml").read_text("utf-8"))
        passes = table.get("pass", [])
        for spec in (*passes, table.get("view", {})) if row.cell >= 0 else ():
            use = str(spec.get("use", ""))
            mine = use.rpartition("/")[2] != row.name, len(passes), row.cell
            found[use] = min(found.get(use, mine), mine)
    return {use: cell for use, (_, _, cell) in found.items()}


# ── the window ────────────────────────────────────────────────────────────────


@dataclass
class Chooser:
    """The list of techniques that may be added."""

    after: str = ""  # behind which pass; "" before the view
    output: str = ""  # that the wire let go in the empty was pulled from; "" where there was none
    on: Wire | None = None  # the wire that the new pass goes on
    search: str = ""
    marked: int = 0  # the entry that Enter adds
    opens: bool = False  # it is to open in the next frame
    is_open: bool = False
    catalogue: Catalogue = field(default_factory=Catalogue)
    _carried: tuple[str, int] = ("", 0)  # by that wire: name, how many numbers

    def open(self, sketch: Sketch, after: str, output: str = "", on: Wire | None = None) -> None:
        """Open it behind a pass, or for one on a wire."""
        self.after, self.output, self.on, self.search, self.marked = after, output, on, "", 0
        self._carried = carried_by(sketch.graph, on) if on is not None else ("", 0)
        self.opens = self.is_open = True
        self.catalogue.begin(sketch)

    def outputs(self, wiring: Wiring) -> tuple[str, ...]:
        """Return what the new pass may go on from."""
        if self.on is not None:
            return (self._carried[0],)
        return (self.output,) if self.output else wiring.outputs.get(self.after, ())

    def entries(self, wiring: Wiring, pictured: Container[str] = ()) -> list[Entry]:
        """Return what is found and fits there, best first: on a wire and behind an output, what takes it."""
        found = self.catalogue.found(self.search, self.outputs(wiring), pictured)
        if self.on is not None:
            return [e for e in found if e.inputs and output_for(e.outputs, *self._carried)]
        return [e for e in found if e.inputs] if self.output else found


@dataclass(frozen=True)
class Pull:
    """A wire that is begun at an output of a pass."""

    giver: str
    output: str
    by_keys: bool = False


@dataclass
class _Frame:
    """What of the tab is on the screen."""

    drawn: bool = False  # in this frame, so far
    on: bool = False  # in the last
    stale: bool = False  # thumbnails are


@dataclass
class Graph:
    """The tab of the passes."""

    session: Session
    inside: str | None = None  # the pass whose inner passes are drawn; "": all; None: the sketch's own
    timed: bool | None = None  # each pass is timed; None: while the picture is still
    chosen: str = ""  # the node that keys act on
    wire: Pin | None = None  # the wire that they act on: reader and input
    has_keys: bool = False  # the keys are the graph's
    gets_keys: bool = False  # as soon as the tab is drawn
    took_key: bool = False  # in this frame it has used one
    touched: bool = False  # the graph was used: its textures are wanted
    pulled: Pull | None = None
    chooser: Chooser = field(default_factory=Chooser)
    _frame: _Frame = field(default_factory=_Frame)
    _wiring: tuple[object, str | None, Wiring] | None = None  # of which sketch's passes, inside which
    thumbnails: Thumbnails = field(init=False)
    pictures: Pictures = field(init=False)

    def __post_init__(self) -> None:
        self.thumbnails, self.pictures = Thumbnails(self.session), Pictures(self.session)

    @property
    def on(self) -> bool:
        """Whether the tab was on the screen in the last frame."""
        return self._frame.on

    @property
    def sketch(self) -> Sketch | None:
        """The sketch whose passes are drawn: what is shown, or, at once, what is being checked."""
        drafts = self.session.drafts
        latest = drafts.latest
        return latest.sketch if latest is not None else drafts.sketch

    def wiring(self, sketch: Sketch) -> Wiring:
        """Return the graph of a sketch; worked out once for each. A pass that is gone forgets its place."""
        places = self.session.view.places
        if self._wiring is None or self._wiring[0] is not sketch.graph or self._wiring[1] != self.inside:
            names = [spec.name for spec in sketch.graph.passes]
            self.inside = self.inside if self.inside in (None, "", *names) else None
            self._wiring = sketch.graph, self.inside, wiring_of(sketch, self.inside)
            wires = self._wiring[2].wires
            self.chosen = self.chosen if self.chosen in self._wiring[2].refs else ""
            self.wire = self.wire if self.wire in [(wire.reader, wire.input) for wire in wires] else None
            for node in [node for node in places if node.partition(".")[0] not in names]:
                del places[node]
        return self._wiring[2].moved(places)

    def place(self, node: str, place: Place) -> None:
        """Move a node; the others stay where they are."""
        places = self.session.view.places
        places.pop(node, None)
        places[node] = place
        while len(places) > MAX_PLACES:
            del places[next(iter(places))]

    def tidy(self) -> None:
        """Have all nodes where they are worked out to be."""
        self.session.view.places.clear()

    def leave(self) -> None:
        """Let go of a wire that was begun; else go out of a technique; else give the keys back."""
        if self.pulled is not None:
            self.pulled = None
        elif self.inside:
            self.chosen, self.inside = self.inside, None
        else:
            self.has_keys = False

    def is_refused(self, giver: str, reader: str) -> bool:
        """Return whether a wire from one pass to another would close a circle."""
        sketch = self.sketch
        return sketch is None or closes_circle(sketch.graph, giver, reader)

    def step(self, across: int, down: int) -> None:
        """Choose the next node to one side; with none chosen, the first."""
        sketch = self.sketch
        if sketch is not None:
            wiring = self.wiring(sketch)
            self.chosen = nearest_node(wiring.layout, self.chosen, across, down, wiring.edges)

    def step_on(self, by: int) -> None:
        """Choose the next node or the one before, in the order in which they run; round again at the ends."""
        nodes = list(self._wiring[2].refs) if self._wiring is not None else []
        at = nodes.index(self.chosen) + by if self.chosen in nodes else min(by, 0)
        self.chosen, self.wire = nodes[at % len(nodes)] if nodes else "", None

    def step_wire(self) -> None:
        """Choose the next wire of the node that is chosen, those to it first; after the last, none."""
        wires = self._wiring[2].wires if self._wiring is not None and self.inside is None else ()
        pins = [
            (w.reader, w.input)
            for end in ("reader", "giver")
            for w in wires
            if getattr(w, end) == self.chosen
        ]
        at = pins.index(self.wire) + 1 if self.wire in pins else 0
        self.wire = pins[at] if at < len(pins) else None

    def entries(self, wiring: Wiring) -> list[Entry]:
        """Return what may be added, best first; of equals what shipped sketches show."""
        return self.chooser.entries(wiring, self.pictures.cells)

    @property
    def times(self) -> bool:
        """Whether passes are timed while the tab is on the screen."""
        session = self.session
        return self.timed if self.timed is not None else not (session.animated and session.clock.playing)

    def begin(self, now: float) -> Wiring | None:
        """Begin to draw the tab: draw one stale thumbnail, and return the graph; None without a sketch.

        ``now``: seconds of any clock.
        """
        self._frame.drawn = self._frame.on = True
        self.took_key = False
        if self.gets_keys:
            self.has_keys, self.touched, self.gets_keys = True, True, False
        sketch = self.sketch
        if sketch is None:
            return None
        wiring = self.wiring(sketch)
        self._frame.stale = self.thumbnails.refresh(wiring.refs.values(), now)
        return wiring

    def end(self) -> None:
        """End a frame: where the tab was not drawn in it, it has no keys, and its pictures are released."""
        self._frame = _Frame(on=self._frame.drawn, stale=self._frame.stale and self._frame.drawn)
        if not self.on:
            self.has_keys = self.took_key = self.touched = self.chooser.is_open = False
            self.release()

    def release(self) -> None:
        """Release all pictures; they are made again where they are needed."""
        self.thumbnails.release()
        self.pictures.release()

    @property
    def waits(self) -> bool:
        """Whether thumbnails are still to be drawn."""
        return self.on and self._frame.stale

    @property
    def reads(self) -> bool:
        """Whether the chooser still reads techniques."""
        return self.on and self.chooser.is_open and not self.chooser.catalogue.is_whole

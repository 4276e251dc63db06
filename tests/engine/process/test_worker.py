"""A sketch is sent whole, but no kernel that the other end has already; what is no frame is recognised."""

from __future__ import annotations

import io
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import pytest

from playground.engine.process.worker import (
    Decoder,
    Encoder,
    NotAFrame,
    read_frame,
    write_frame,
)
from playground.engine.sandbox import TryLibrary, TrySketch
from playground.shader.kernel import Kernel, Technique
from playground.sketch.load import load
from playground.sketch.model import Sketch, kernels_of

from ...sketch_texts import passes

TERRAIN = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return 0.5; }
"""
SKETCH = (
    "format = 1\nsize = 33\n"
    + passes(
        height="./terrain", again="./terrain", light=("lighting/ray_cast", 'inputs = { height = "height" }')
    )
    + '[view]\nuse = "view/terrain"\n'
)


@dataclass
class Ends:
    """Both ends, and the size of what was sent last."""

    encoder: Encoder
    decoder: Decoder
    bytes: int = 0

    def send(self, message: object) -> object:
        data = self.encoder.encode(message)
        self.bytes = len(data)
        self.encoder.sent()
        return self.decoder.decode(data)


@pytest.fixture
def ends() -> Ends:
    return Ends(Encoder(), Decoder())


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "terrain.glsl").write_text(TERRAIN)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    return tmp_path


def kernels(sketch: Sketch) -> dict[str, Kernel]:
    return dict(kernels_of(sketch.graph))


def sent_alone(technique: Technique) -> Iterator[Kernel]:
    """Yield the kernels of a technique, and those of fast variants that replace several passes of it."""
    if isinstance(technique, Kernel):
        yield technique
        return
    for inside in (*technique.passes, *technique.variants):
        yield from sent_alone(inside.technique)


def test_what_is_received_is_what_was_sent(ends, folder):
    for edit in ("0.5", "0.25", "0.5"):
        (folder / "terrain.glsl").write_text(TERRAIN.replace("0.5", edit))
        request = TrySketch(load(folder), time=1.0, drivers=("fragment",))
        assert ends.send(request) == request
    library = TryLibrary("a", "b")
    assert ends.send(library) == library
    assert ends.send(request) == request, "neither end held any of it"


def test_only_what_changed_is_sent(ends, folder):
    before = kernels(ends.send(TrySketch(load(folder))).sketch)
    whole = ends.bytes
    (folder / "terrain.glsl").write_text(TERRAIN.replace("0.5", "0.25"))
    after = kernels(ends.send(TrySketch(load(folder))).sketch)
    assert ends.bytes < whole / 4
    assert {path for path in after if after[path] is not before[path]} == {"height", "again"}
    assert after["height"] is after["again"], "one object stays one"


def test_what_was_encoded_and_not_sent_is_sent_by_the_next(ends, folder):
    request = TrySketch(load(folder))
    ends.encoder.encode(request)  # cancelled before it was sent
    assert ends.send(request) == request
    ends.encoder.encode(TryLibrary("a", "b"))
    assert ends.send(request) == request


def test_neither_end_holds_what_is_no_longer_used(ends, folder):
    for number in range(6):
        (folder / "terrain.glsl").write_text(TERRAIN.replace("0.5", f"0.{number + 1}"))
        sketch = load(folder)
        ends.send(TrySketch(sketch))
        distinct = len({id(kernel) for kernel in sent_alone(sketch.graph)})
        assert len(ends.encoder.known) == len(ends.decoder.known) == distinct


class Meanwhile(str):
    """A text whose pickling lets another thread run: ``other`` is what that does."""

    other: Callable[[], object] = staticmethod(lambda: None)

    def __reduce__(self):
        self.other()
        return str, (str(self),)


def cached(value: object) -> list[str]:
    """Return the names of a value's cached properties."""
    attributes = {name: a for kind in type(value).__mro__ for name, a in vars(kind).items()}
    return [name for name, attribute in attributes.items() if isinstance(attribute, cached_property)]


@pytest.mark.parametrize("kind", ["graph", "kernel", "text"])
def test_what_is_sent_may_be_drawn_by_another_thread_meanwhile(ends, folder, kind):
    sketch, said = load(folder), Meanwhile("said")
    kernel = kernels(sketch)["height"]
    if kind == "text":
        changed = replace(kernel, source=replace(kernel.source, files=(said,)))
    else:
        changed = replace(kernel, title=said if kind == "kernel" else kernel.title)
    specs = tuple(
        replace(spec, technique=changed, file=said if kind == "graph" else spec.file)
        if spec.name == "height"
        else spec
        for spec in sketch.graph.passes
    )
    sent = replace(sketch, graph=replace(sketch.graph, passes=specs))
    value = {"graph": sent.graph, "kernel": changed, "text": changed.source}[kind]
    assert not {*cached(value)} & {*vars(value)}
    said.other = lambda: [getattr(value, name) for name in cached(value)]
    received = ends.send(TrySketch(sent))
    assert {*cached(value)} <= {*vars(value)}, "they were computed while it was sent"
    assert received == TrySketch(sent)


def test_what_was_computed_of_a_sketch_is_not_sent(ends, folder):
    sketch = load(folder)
    values = [sketch.graph, *(value for k in sent_alone(sketch.graph) for value in (k, k.source))]
    plain = Encoder().encode(sketch)
    assert [getattr(value, name) for value in values for name in cached(value)]
    assert len(Encoder().encode(sketch)) == len(plain)


@pytest.mark.parametrize("data", [b"", b"one", bytes(100_000)])
def test_what_is_read_is_what_was_written(data: bytes):
    stream = io.BytesIO()
    write_frame(stream, data)
    write_frame(stream, b"next")
    stream.seek(0)
    assert (read_frame(stream), read_frame(stream)) == (data, b"next")
    with pytest.raises(EOFError):
        read_frame(stream)


def framed(data: bytes) -> bytes:
    """Return the bytes of a frame: its mark of 8 bytes, its length, the data."""
    stream = io.BytesIO()
    write_frame(stream, data)
    return stream.getvalue()


@pytest.mark.parametrize(
    ("data", "kind"),
    [
        (b"", EOFError),
        (framed(b"abc")[:9], EOFError),
        (framed(b"cut short" + bytes(21))[:-21], EOFError),
        (b"Mesa", NotAFrame),
        (b"Mesa: error: ZINK: failed to choose pdev", NotAFrame),
        (framed(b"")[:8] + struct.pack("<Q", 2**60), NotAFrame),  # it is not even tried to read so much
    ],
)
def test_what_is_no_frame_is_recognised(data: bytes, kind: type[Exception]):
    with pytest.raises(kind):
        read_frame(io.BytesIO(data))

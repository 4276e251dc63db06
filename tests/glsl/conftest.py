"""What the library's tests share: any pure function of it over arrays, and small sketches."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from pathlib import Path

import moderngl
import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.shader.source import read_source
from playground.sketch.model import Sketch

from ..loading import load
from ..sketch_texts import passes, toml_value, use

BOTH_TEXTS = pytest.mark.parametrize("engine", ["fragment", "auto"], indirect=True)
"""For a technique that has a second text, a fast variant: both are compared with the truth."""
LETTERS = {"uint": ("u", "u4", np.uint32), "int": ("i", "i4", np.int32), "float": ("", "f4", np.float32)}


def _glsl(kind: str) -> str:
    """Return "uvec3" for "uint3"."""
    base = kind.rstrip("234")
    return base if kind == base else f"{LETTERS[base][0]}vec{kind[-1]}"


def _scalar(kind: str) -> tuple[str, int]:
    base = kind.rstrip("234")
    return base, int(kind[len(base) :] or 1)


TYPES = [base + n for base in LETTERS for n in ("", "2", "3", "4")]
RESULT = np.dtype([("k_bits", "u4", 4), ("k_type", "i4")])


def _overloads() -> str:
    """Return GLSL of ``k_take(x)``, whose overload for the type of x writes that type and its bits."""
    lines = ["flat out uvec4 k_bits;", "flat out int k_type;"]
    for number, kind in enumerate(TYPES):
        base, width = _scalar(kind)
        values = ", ".join(["floatBitsToUint(x)" if base == "float" else "x", *["0u"] * (4 - width)])
        lines.append(f"void k_take({_glsl(kind)} x) {{ k_type = {number}; k_bits = uvec4({values}); }}")
    return "\n".join(lines) + "\n"


OVERLOADS = _overloads()


@lru_cache(maxsize=64)
def _code(file: str) -> str:
    return read_source(GLSL / file, (GLSL,)).code


@pytest.fixture(scope="module")
def functions(shared_context: moderngl.Context) -> Iterator[dict[str, moderngl.Program]]:
    """Give the programs of a file's tests by their texts: each is compiled once."""
    made: dict[str, moderngl.Program] = {}
    yield made
    shared_context.__enter__()
    for program in made.values():
        program.release()


@pytest.fixture
def on_gpu(
    ctx: moderngl.Context, functions: dict[str, moderngl.Program]
) -> Iterator[Callable[..., np.ndarray]]:
    """Give ``on_gpu(file, expression, **arrays)``: a pure GLSL expression, worked out for each element.

    A number or an array of one dimension is a scalar; a tuple, or an array whose last axis
    is 2 to 4 long, is a vector; the first axes are broadcast. NumPy's floats, signed and
    unsigned integers become float, int and uint. Returns float32, int32 or uint32.
    """
    # Transform feedback draws nothing, but wants a framebuffer that it could draw to.
    surface = ctx.simple_framebuffer((1, 1))

    def evaluate(file: str, expression: str, **arrays: object) -> np.ndarray:
        columns = {name: _column(value) for name, value in arrays.items()}
        count = max((len(values) for values, _ in columns.values()), default=1)
        inputs = "".join(f"in {_glsl(kind)} {name};\n" for name, (_, kind) in columns.items())
        surface.use()
        text = f"#version 330\n{_code(file)}\n{inputs}{OVERLOADS}void main() {{ k_take({expression}); }}\n"
        if text not in functions:
            functions[text] = ctx.program(vertex_shader=text, varyings=RESULT.names)
        program = functions[text]
        content, buffers = [], []
        for name, (values, kind) in columns.items():
            base, width = _scalar(kind)
            shape = (count, width)
            data = np.ascontiguousarray(np.broadcast_to(values.reshape(-1, width), shape), LETTERS[base][2])
            buffers.append(ctx.buffer(data.tobytes()))
            if name in program:
                content.append((buffers[-1], f"{width}{LETTERS[base][1]}", name))
        target = ctx.buffer(reserve=count * RESULT.itemsize)
        vao = ctx.vertex_array(program, content)
        vao.transform(target, moderngl.POINTS, vertices=count)
        rows = np.frombuffer(target.read(), RESULT)
        base, width = _scalar(TYPES[rows["k_type"][0]])
        for item in (vao, target, *buffers):
            item.release()
        actual = rows["k_bits"][:, :width].copy().view(LETTERS[base][2])
        return actual[:, 0].copy() if width == 1 else actual

    yield evaluate
    ctx.detect_framebuffer(0).use()  # what is read next binds again what was bound before, which goes here
    for item in (*surface.color_attachments, surface.depth_attachment, surface):
        item.release()


@pytest.fixture(scope="module")
def kept(shared_context: moderngl.Context) -> Iterator[Engine]:
    """Give one engine for the file: programs are compiled once. Ask for ``ctx`` as well, which is checked."""
    shared_context.__enter__()
    with Engine(shared_context) as made:
        yield made


@pytest.fixture
def engine(request: pytest.FixtureRequest, ctx: moderngl.Context) -> Iterator[Engine]:
    """Give an engine that runs the canonical texts: test_drivers proves that both drivers give their bits.

    Under ``BOTH_TEXTS`` it runs fast variants as well, where there is another text to be tested.
    """
    with Engine(ctx, driver=getattr(request, "param", "fragment")) as made:
        yield made


@pytest.fixture
def compute(ctx: moderngl.Context) -> moderngl.Context:
    """Give the context where there are compute shaders."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    return ctx


@pytest.fixture
def both_texts(compute: moderngl.Context) -> Iterator[tuple[Engine, Engine]]:
    """Give an engine that runs canonical texts, and one that runs their fast variants."""
    with Engine(compute, driver="fragment") as canonical, Engine(compute) as fast:
        yield canonical, fast


def _column(value: object) -> tuple[np.ndarray, str]:
    """Return (values with elements along the first axis, type as "float3")."""
    array = np.asarray(value)
    base = {"f": "float", "i": "int", "u": "uint", "b": "int"}[array.dtype.kind]
    width = array.shape[-1] if isinstance(value, tuple) or array.ndim > 1 else 1
    return np.atleast_1d(array).reshape(-1, width), base + (str(width) if width > 1 else "")


@pytest.fixture
def make_sketch(tmp_path: Path) -> Callable[..., Sketch]:
    """Give ``make_sketch(passes, size=…, extent=…, name=text)``: a sketch written to a folder and loaded."""
    numbers = iter(range(1_000_000))

    def make(
        passes: str, *, size: object = 33, extent: object = 1000.0, relief: float = 100.0, **files: str
    ) -> Sketch:
        for name, text in files.items():
            (tmp_path / f"{name}.glsl").write_text(text)
        head = f"format = 1\nsize = {toml_value(size)}\nextent = {toml_value(extent)}\nrelief = {relief}\n"
        path = tmp_path / f"sketch_{next(numbers)}.toml"
        path.write_text(head + passes)
        return load(path)

    return make


@pytest.fixture
def single(make_sketch: Callable[..., Sketch]) -> Callable[..., Sketch]:
    """Give ``single(technique, size=…, extent=…, **parameters)``: a sketch of it, as the pass ``terrain``.

    ``before`` are passes that its ``inputs`` name.
    """

    def make(
        technique: str,
        size: object = 33,
        extent: object = 1000.0,
        before: str = "",
        inputs: dict[str, str] | None = None,
        **values: object,
    ) -> Sketch:
        terrain = passes(terrain=use(technique, inputs=inputs, **values))
        return make_sketch(before + terrain, size=size, extent=extent)

    return make


@pytest.fixture
def lit(make_sketch: Callable[..., Sketch]) -> Callable[..., Sketch]:
    """Give a sketch of a terrain and its light: sun in degrees, sizes in texels, metres.

    ``given`` are parameters of the terrain, a kernel's text; ``values`` those of the light, None for none.
    """

    def make(
        terrain: str,
        method: str,
        sun: tuple[float, float],
        *,
        size: object = 65,
        extent: object = 1000.0,
        relief: float = 100.0,
        light_size: str = "",
        given: dict[str, object] | None = None,
        **values: object,
    ) -> Sketch:
        values = {k: v for k, v in values.items() if v is not None}
        at = (f"size = {light_size}",) if light_size else ()
        both = passes(
            height=use("./terrain", **(given or {})), light=use(f"lighting/{method}", *at, sun=sun, **values)
        )
        return make_sketch(both, size=size, extent=extent, relief=relief, terrain=terrain)

    return make

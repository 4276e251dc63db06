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
from .terrains import toml_value

TYPES = [kind + n for kind in ("uint", "int", "float") for n in ("", "2", "3", "4")]
LETTERS = {"uint": ("u", "u4", np.uint32), "int": ("i", "i4", np.int32), "float": ("", "f4", np.float32)}


def _glsl(kind: str) -> str:
    """Return "uvec3" for "uint3"."""
    base = kind.rstrip("234")
    return base if kind == base else f"{LETTERS[base][0]}vec{kind[-1]}"


def _scalar(kind: str) -> tuple[str, int]:
    base = kind.rstrip("234")
    return base, int(kind[len(base) :] or 1)


@lru_cache(maxsize=64)
def _code(file: str) -> str:
    return read_source(GLSL / file, (GLSL,)).code


@pytest.fixture
def on_gpu(ctx: moderngl.Context) -> Iterator[Callable[..., np.ndarray]]:
    """Give ``on_gpu(file, expression, **arrays)``: a pure GLSL expression, worked out for each element.

    A number or an array of one dimension is a scalar; a tuple, or an array whose last axis
    is 2 to 4 long, is a vector; the first axes are broadcast. NumPy's floats, signed and
    unsigned integers become float, int and uint. Returns float32, int32 or uint32.
    """
    kept: list[moderngl.Program] = []
    # Transform feedback draws nothing, but wants a framebuffer that it could draw to.
    surface = ctx.simple_framebuffer((1, 1))

    def evaluate(file: str, expression: str, **arrays: object) -> np.ndarray:
        columns = {name: _column(value) for name, value in arrays.items()}
        count = max((len(values) for values, _ in columns.values()), default=1)
        inputs = "".join(f"in {_glsl(kind)} {name};\n" for name, (_, kind) in columns.items())
        surface.use()
        program, result = _compiled(ctx, _code(file), inputs, expression)
        kept.append(program)
        content, buffers = [], []
        for name, (values, kind) in columns.items():
            base, width = _scalar(kind)
            shape = (count, width)
            data = np.ascontiguousarray(np.broadcast_to(values.reshape(-1, width), shape), LETTERS[base][2])
            buffers.append(ctx.buffer(data.tobytes()))
            if name in program:
                content.append((buffers[-1], f"{width}{LETTERS[base][1]}", name))
        base, width = _scalar(result)
        target = ctx.buffer(reserve=count * width * 4)
        vao = ctx.vertex_array(program, content)
        vao.transform(target, moderngl.POINTS, vertices=count)
        actual = np.frombuffer(target.read(), LETTERS[base][2]).reshape(count, width)
        for item in (vao, target, *buffers):
            item.release()
        return actual[:, 0].copy() if width == 1 else actual.copy()

    yield evaluate
    ctx.detect_framebuffer(0).use()  # what is read next binds again what was bound before, which goes here
    for attachment in (*surface.color_attachments, surface.depth_attachment):
        attachment.release()
    for item in (*kept, surface):
        item.release()


@pytest.fixture(scope="module")
def kept(shared_context: moderngl.Context) -> Iterator[Engine]:
    """Give one engine for the file: programs are compiled once. Ask for ``ctx`` as well, which is checked."""
    shared_context.__enter__()
    with Engine(shared_context) as made:
        yield made


@pytest.fixture
def same_by_both_drivers(ctx: moderngl.Context) -> Callable[[Callable[[Engine], np.ndarray]], None]:
    """Give what sees that both drivers read the same bits; skips where there are no compute shaders."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")

    def see(read: Callable[[Engine], np.ndarray]) -> None:
        result = []
        for driver in ("fragment", "compute"):
            with Engine(ctx, driver=driver) as engine:
                result.append(read(engine))
        np.testing.assert_array_equal(*result)

    return see


def _column(value: object) -> tuple[np.ndarray, str]:
    """Return (values with elements along the first axis, type as "float3")."""
    array = np.asarray(value)
    base = {"f": "float", "i": "int", "u": "uint", "b": "int"}[array.dtype.kind]
    width = array.shape[-1] if isinstance(value, tuple) or array.ndim > 1 else 1
    return np.atleast_1d(array).reshape(-1, width), base + (str(width) if width > 1 else "")


def _compiled(ctx: moderngl.Context, code: str, inputs: str, expression: str) -> tuple[moderngl.Program, str]:
    """Compile for the type that the expression has: GLSL 3.30 makes floats of integers, never the reverse."""
    complaint = ""
    for kind in TYPES:
        text = f"#version 330\n{code}\n{inputs}{_out(kind)} k_result;\n"
        text += f"void main() {{ k_result = {expression}; }}\n"
        try:
            return ctx.program(vertex_shader=text, varyings=["k_result"]), kind
        except moderngl.Error as error:
            complaint = str(error)
        finally:
            _ = ctx.error
    raise AssertionError(f"{expression} does not compile: {complaint}")


def _out(kind: str) -> str:
    return ("out " if kind.startswith("float") else "flat out ") + _glsl(kind)


@pytest.fixture
def make_sketch(tmp_path: Path) -> Callable[..., Sketch]:
    """Give ``make_sketch(passes, size=…, files={name: text})``: a sketch written to a folder and loaded."""
    numbers = iter(range(1_000_000))

    def make(
        passes: str, *, size: object = 33, extent: object = 1000.0, relief: float = 100.0, **files: str
    ) -> Sketch:
        for name, text in files.items():
            (tmp_path / f"{name}.glsl").write_text(text)
        head = f"format = 1\nsize = {size}\nextent = {extent}\nrelief = {relief}\n"
        path = tmp_path / f"sketch_{next(numbers)}.toml"
        path.write_text(head + passes)
        return load(path)

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
        values = {"sun": list(sun), **{k: v for k, v in values.items() if v is not None}}
        settings = ["".join(f"{k} = {toml_value(v)}\n" for k, v in s.items()) for s in (given or {}, values)]
        at = f"size = {light_size}\n" if light_size else ""
        passes = (
            f'[[pass]]\nname = "height"\nuse = "./terrain"\n[pass.set]\n{settings[0]}'
            f'[[pass]]\nname = "light"\nuse = "lighting/{method}"\n{at}[pass.set]\n{settings[1]}'
        )
        return make_sketch(passes, size=size, extent=extent, relief=relief, terrain=terrain)

    return make


@pytest.fixture(scope="session")
def python_random() -> Callable[..., np.ndarray]:
    """Give noise/hash.glsl's ``random(point, seed)`` in Python: x and y broadcast, float64 in [0, 1).

    ``part`` 1 is the second number of ``random_pair``.
    """

    def number(x: object, y: object, seed: int, part: int = 0) -> np.ndarray:
        return np.asarray(mixed(x, y, seed)[part] // 256, np.float64) / 2.0**24

    return number


def mixed(x: object, y: object, z: object) -> list[np.ndarray]:
    """Mix three whole numbers as pcg3d does, with Python's own integers, which never overflow."""
    whole = 2**32
    pythons = np.frompyfunc(int, 1, 1)
    v = [np.asarray(pythons(n), object) % whole * 1664525 + 1013904223 for n in (x, y, z)]

    def stir() -> None:
        for i in range(3):
            v[i] = (v[i] + v[(i + 1) % 3] * v[(i + 2) % 3]) % whole

    stir()
    for i in range(3):
        v[i] = v[i] ^ (v[i] // 2**16)
    stir()
    return v

"""Draw meshes: samples of colour and depth, blending, resolved into a texture at the end.

Meshes stay on the graphics card, with a vertex array for each program that draws them;
what a draw drew on is used again by the next draw of its size.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

import numpy as np

from playground.engine.kernels import Job, Kernels
from playground.engine.programs import Program
from playground.engine.results import Result, Surface
from playground.errors import ContextError, SketchError
from playground.gpu.textures import drain, make_framebuffer, split_format
from playground.sketch import expressions
from playground.sketch.expressions import ExpressionError
from playground.sketch.model import Value
from playground.terrain.meshes import build_mesh, mesh_key, mesh_parameters

if TYPE_CHECKING:
    import moderngl

_MAX_MESHES = 8
_MAX_SURFACES = 2
_MeshKey = tuple[str, tuple[tuple[str, int], ...]]


class Draws:
    """Runs draws on one context."""

    def __init__(self, ctx: moderngl.Context, kernels: Kernels) -> None:
        self.ctx = ctx
        self.kernels = kernels
        self.finest: int | None = None  # no mesh is finer than this, whatever its draw asks for
        self._meshes: OrderedDict[_MeshKey, _Loaded] = OrderedDict()
        self._surfaces: list[Surface] = []  # spare, newest last

    def release(self) -> None:
        """Give back every mesh and surface kept."""
        for key, mesh in self._meshes.items():
            self.kernels.programs.forget_mesh(key)
            mesh.release()
        for surface in self._surfaces:
            surface.release()
        self._meshes.clear()
        self._surfaces.clear()

    def run(self, job: Job) -> Result:
        """Draw a mesh over what the draw starts from; the result is the caller's."""
        step, kernel, ctx = job.step, job.step.kernel, self.ctx
        output = kernel.outputs[0]
        program = self.kernels.program(job, "draw")
        array = self._array(program, job)
        surface = self._surface(step.size, output.format, job.samples)
        self._start_from(job, surface)
        surface.framebuffer.use()
        self.kernels.binder.bind(program, step, job.given, job.inputs)
        try:
            _enable(ctx, kernel.depth, kernel.blend)
            for iteration in range(step.repeat):
                job.count(program, iteration, kernel.repeat, step.whole)
                array.render(ctx.TRIANGLES)
        finally:
            _enable(ctx, "none", "none")
        result = self.kernels.pool.take(step.size, kernel.outputs)
        ctx.copy_framebuffer(result.framebuffer(ctx), surface.framebuffer)
        if job.keeps_surface:
            result.surface = surface
        else:
            self._surfaces = [*self._surfaces, surface]
            while len(self._surfaces) > _MAX_SURFACES:
                self._surfaces.pop(0).release()
        return result

    def _surface(self, size: tuple[int, int], form: str, samples: int) -> Surface:
        """Return something to draw on: a spare one where there is, cleared."""
        for spare in self._surfaces:
            if (spare.size, spare.format, spare.samples) == (size, form, samples):
                self._surfaces.remove(spare)
                break
        else:
            spare = self._new_surface(size, form, samples)
        spare.framebuffer.use()
        spare.framebuffer.clear(0, 0, 0, 0, depth=1.0)
        return spare

    def _new_surface(self, size: tuple[int, int], form: str, samples: int) -> Surface:
        components, dtype = split_format(form)
        many = samples if samples > 1 else 0
        drain(self.ctx)
        colour = self.ctx.renderbuffer(size, components, samples=many, dtype=dtype)
        depth = self.ctx.depth_renderbuffer(size, samples=many)
        fault = self.ctx.error
        try:
            if fault != "GL_NO_ERROR":
                raise RuntimeError(fault)
            framebuffer = make_framebuffer(self.ctx, [colour], depth)
        except Exception as error:  # moderngl raises its own Error for an incomplete framebuffer
            colour.release()
            depth.release()
            raise ContextError(
                f"the driver refused to draw {size[0]} x {size[1]} {form} with {samples} samples: {error}"
            ) from None
        return Surface(framebuffer, colour, depth, size, form, samples)

    def _start_from(self, job: Job, surface: Surface) -> None:
        """Begin with an earlier picture: a draw's samples and depth, or a texture's colours."""
        wired = job.inputs.get("initial")
        if wired is None or wired.texture is None:
            return
        earlier = wired.result.surface if wired.result is not None else None
        if earlier is not None and (earlier.size, earlier.samples) == (surface.size, surface.samples):
            self.ctx.copy_framebuffer(surface.framebuffer, earlier.framebuffer)
            return
        self.kernels.copy(surface.framebuffer, surface.size, wired.texture)

    def _array(self, program: Program, job: Job) -> moderngl.VertexArray:
        step = job.step
        try:
            key = (step.kernel.registry, mesh_key(step.kernel.registry, _mesh_values(job)))
        except (SketchError, ExpressionError) as error:
            raise step.spec.error(str(error)) from None
        if self.finest is not None:
            key = key[0], tuple((name, min(value, self.finest)) for name, value in key[1])
        if key not in self._meshes:
            self._meshes[key] = _Loaded(self.ctx, key)
            while len(self._meshes) > _MAX_MESHES:
                old, mesh = self._meshes.popitem(last=False)
                self.kernels.programs.forget_mesh(old)
                mesh.release()
        self._meshes.move_to_end(key)
        array = program.arrays.get(key)
        if array is None:
            array = program.arrays[key] = self._meshes[key].array(program)
        return array


def _mesh_values(job: Job) -> dict[str, Value]:
    """Return a draw's parameters, and the count that its header works out."""
    step, kernel = job.step, job.step.kernel
    if not kernel.count:
        return dict(step.values)
    if "count" not in mesh_parameters(kernel.registry):
        raise SketchError(f"mesh '{kernel.registry}' takes no count")
    return {**step.values, "count": expressions.evaluate(kernel.count, job.numbers())}


def _enable(ctx: Any, depth: str, blend: str) -> None:
    """Switch depth test and blending as a draw's header says; both "none" is how others find the context."""
    ctx.enable_only((ctx.DEPTH_TEST if depth != "none" else 0) | (ctx.BLEND if blend != "none" else 0))
    ctx.depth_func = "==" if depth == "equal" else "<"
    if blend == "add":
        ctx.blend_func = ctx.ONE, ctx.ONE
    elif blend == "alpha":
        ctx.blend_func = ctx.SRC_ALPHA, ctx.ONE_MINUS_SRC_ALPHA, ctx.ONE, ctx.ONE_MINUS_SRC_ALPHA
    else:
        ctx.blend_func = ctx.DEFAULT_BLENDING


class _Loaded:
    """A mesh in buffers."""

    def __init__(self, ctx: moderngl.Context, key: _MeshKey) -> None:
        mesh = build_mesh(*key)
        self._ctx = ctx
        self._attributes = [
            (
                ctx.buffer(np.ascontiguousarray(array, np.float32).tobytes()),
                f"{array.shape[1]}f",
                f"k_in_{name}",
            )
            for name, array in mesh.attributes.items()
        ]
        self._indices = ctx.buffer(mesh.indices.astype(np.uint32).tobytes())

    def array(self, program: Program) -> moderngl.VertexArray:
        """Join the mesh to a program's attributes."""
        names = set(program.compiled)
        content = [attribute for attribute in self._attributes if attribute[2] in names]
        return self._ctx.vertex_array(
            program.compiled, content, index_buffer=self._indices, index_element_size=4
        )

    def release(self) -> None:
        """Give the buffers back to the driver."""
        for buffer, _, _ in self._attributes:
            buffer.release()
        self._indices.release()

"""Draw meshes: samples of colour and depth, blending, resolved into a texture at the end.

Meshes stay on the graphics card, with a vertex array for each program that draws them;
the surface of a draw is used again by the next draw of its size. Of a mesh with levels of
detail, only what the view needs is drawn: the textures that the choice depends on are read
back from the graphics card once, when they were computed. So is the texel that says how many
instances of a mesh are drawn: OpenGL 3.3 takes no counts from textures by itself.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.gl_calls import copy_depth
from playground.engine.kernels import Kernels, numbers_of
from playground.engine.lod import CHOOSERS, Chosen, View, ranges
from playground.engine.meshes import drawn_mesh, mesh_key, mesh_parameters
from playground.engine.plan import LoopIteration, Step, Window
from playground.engine.programs import Program
from playground.engine.results import Result, Surface, Wired, started
from playground.engine.textures import drain, make_framebuffer, split_format
from playground.errors import ContextError, SketchError
from playground.memo import Memo
from playground.shader import expressions
from playground.shader.expressions import ExpressionError, Number
from playground.shader.reserved_names import ZOOM
from playground.sketch.flat import Ref
from playground.sketch.model import Draw, Kernel, Technique, Value

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
        self.finest: int | None = None  # no mesh is finer than this
        self.meshes: Memo[_MeshKey, _Loaded] = Memo("meshes", _MAX_MESHES, dropped=self._release_mesh)
        self._surfaces: list[Surface] = []  # spare, newest last
        limits = ctx.info["GL_MAX_VIEWPORT_DIMS"]
        self.widest: tuple[int, int] = (int(limits[0]), int(limits[1]))  # [pixels] of a viewport
        self.triangles = 0  # of the last draw of a mesh with levels of detail
        self.drawn = 0  # triangles of every draw that ran

    def release(self) -> None:
        """Release every mesh and surface."""
        self.meshes.clear()
        for surface in self._surfaces:
            surface.release()
        self._surfaces.clear()

    def run(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        around: LoopIteration | None,
        samples: int,
        *,
        keeps_surface: bool,
    ) -> Result:
        """Draw a mesh over what the draw starts from, with ``samples`` a pixel; the result is the caller's.

        ``keeps_surface``: a later draw goes on from this one. The others are those of ``Kernels.run``.
        """
        kernel, ctx = step.kernel, self.ctx
        assert isinstance(kernel, Draw)
        program, stage = self.kernels.program(step, "draw", inputs, around)
        loaded, array = self._array(program, step, inputs)
        instances = instances_of(step, inputs, ctx) if step.repeat else 0
        chosen = None
        if loaded.places is not None and step.repeat:
            chosen = self._chosen(step, inputs, uniforms)
        pool = self.kernels.pool
        result = pool.take(step.size, kernel.outputs) if samples == 1 else None
        try:
            surface = self._target(result) if result is not None else self._surface(step, samples)
            self._begin(step, kernel, inputs, surface)
            if step.window is not None:
                self._look_through(step.window, program)
            self.kernels.binder.bind(program, step, uniforms, inputs, stage)
            _enable(ctx, "over" if kernel.over else kernel.depth, kernel.blend)
            for iteration in range(step.repeat):
                program.count(kernel.repeat, iteration, step.total, around)
                if chosen is None:
                    if instances:
                        array.render(ctx.TRIANGLES, instances=instances)
                    self.drawn += loaded.triangles * instances
                else:
                    self.triangles = loaded.render(array, chosen)
                    self.drawn += self.triangles
        except Exception:
            if result is not None:
                pool.give(result)
            raise
        finally:
            _enable(ctx, "none", "none")
        if result is not None:
            result.surface = surface if keeps_surface else None
            return result
        result = pool.take(step.size, kernel.outputs)
        ctx.copy_framebuffer(result.framebuffer(ctx), surface.framebuffer)
        if keeps_surface:
            result.surface = surface
        else:
            self._surfaces.append(surface)
            while len(self._surfaces) > _MAX_SURFACES:
                self._surfaces.pop(0).release()
        return result

    def draw_again(
        self,
        program: Program,
        step: Step,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        around: LoopIteration | None,
        iteration: int,
        depth: str,
    ) -> None:
        """Draw a step's mesh once more by another program into what is bound, unblended.

        ``iteration`` is that of the step's own repeat; ``depth`` the function by which fragments pass, "" for
        all. The others are those of ``run``.
        """
        kernel, ctx = _draw_of(step), self.ctx
        own, stage = self.kernels.program(step, "draw", inputs, around)
        loaded, _ = self._array(own, step, inputs)
        chosen = self._chosen(step, inputs, uniforms) if loaded.places is not None else None
        self.kernels.binder.bind(program, step, uniforms, inputs, stage)
        program.count(kernel.repeat, iteration, step.total, around)
        array = loaded.array(program)
        ctx.enable_only(ctx.DEPTH_TEST if depth else 0)
        try:
            if depth:
                ctx.depth_func = depth
            if chosen is None:
                array.render(ctx.TRIANGLES, instances=instances_of(step, inputs, ctx))
            else:
                loaded.render(array, chosen)
        finally:
            _enable(ctx, "none", "none")
            array.release()

    def _look_through(self, window: Window, program: Program) -> None:
        """Clip a draw of the whole picture to a window of it.

        The whole's viewport leaves clip space as it is; where the driver has none so large, clip
        space is scaled instead, which rounds otherwise.
        """
        (x, y), (width, height), (wide, tall) = window.origin, window.size, window.full_size
        if wide <= self.widest[0] and tall <= self.widest[1]:
            self.ctx.viewport = (-x, -y, wide, tall)
            program.set(ZOOM, (1.0, 1.0, 0.0, 0.0))
            return
        moved = (wide - 2 * x - width) / width, (tall - 2 * y - height) / height
        program.set(ZOOM, (wide / width, tall / height, *moved))

    def _surface(self, step: Step, samples: int) -> Surface:
        """Return something to draw several samples a pixel on: a spare surface if there is one."""
        size, formats = step.size, tuple([output.format for output in step.kernel.outputs])
        for spare in self._surfaces:
            if (spare.size, spare.formats, spare.samples) == (size, formats, samples):
                self._surfaces.remove(spare)
                return spare
        return self._new_surface(size, formats, samples)

    def _target(self, result: Result) -> Surface:
        """Return a result's own textures to draw on, with a depth that stays theirs.

        What has one sample a pixel needs nothing resolved: no copy of the picture.
        """
        if result.target is None:
            formats = tuple([output.format for output in result.outputs])
            textures = tuple([result.textures[output.name] for output in result.outputs])
            result.target = self._made(result.size, formats, 1, textures)
        return result.target

    def _new_surface(self, size: tuple[int, int], formats: tuple[str, ...], samples: int) -> Surface:
        kinds = [split_format(form) for form in formats]
        drain(self.ctx)
        colours = [self.ctx.renderbuffer(size, parts, samples=samples, dtype=dtype) for parts, dtype in kinds]
        return self._made(size, formats, samples, tuple(colours))

    def _made(
        self,
        size: tuple[int, int],
        formats: tuple[str, ...],
        samples: int,
        colours: tuple[moderngl.Renderbuffer | moderngl.Texture, ...],
    ) -> Surface:
        """Return a new surface of some colours, which are a result's textures where there is one sample."""
        own = () if samples == 1 else colours
        depth = self.ctx.depth_renderbuffer(size, samples=samples if samples > 1 else 0)
        error = self.ctx.error
        try:
            if error != "GL_NO_ERROR":
                raise RuntimeError(error)
            framebuffer = make_framebuffer(self.ctx, colours, depth)
        except Exception as refusal:  # moderngl raises its own Error for an incomplete framebuffer
            for buffer in (*own, depth):
                buffer.release()
            what = f"{size[0]} x {size[1]} {', '.join(formats)} with {samples} samples"
            raise ContextError(f"the driver refused to draw {what}: {refusal}") from None
        return Surface(framebuffer, colours, depth, size, formats, samples, is_target=samples == 1)

    def _begin(self, step: Step, kernel: Draw, inputs: Mapping[str, Wired], surface: Surface) -> None:
        """Give a surface what a draw begins with, and bind it."""
        surface.framebuffer.depth_mask = not kernel.over
        if kernel.over:
            self._take_depth(step, kernel.over, inputs, surface)
        self._start_from(step, kernel, inputs, surface)
        surface.framebuffer.use()

    def _start_from(self, step: Step, kernel: Draw, inputs: Mapping[str, Wired], surface: Surface) -> None:
        """Begin with an earlier draw's samples and depth, with a texture's colours, or with nothing."""
        # A copy binds again what is bound: GL_BACK, of no texture, is GL_INVALID_ENUM before OpenGL 4.
        surface.framebuffer.use()
        wired = inputs.get("initial", Wired())
        # Of what a draw over another's pixels starts from, the depth is that draw's.
        earlier = wired.result.surface if wired.result is not None and not kernel.over else None
        if earlier is not None and (earlier.size, earlier.samples) == (surface.size, surface.samples):
            _refuse_others(step, wired)
            self.ctx.copy_framebuffer(surface.framebuffer, earlier.framebuffer)
            return
        textures = started(kernel.outputs, wired)
        if len(surface.formats) == 1:  # what is overwritten needs no clearing
            surface.framebuffer.color_mask = (not textures,) * 4
        surface.framebuffer.clear(0, 0, 0, 0, depth=1.0)
        if len(surface.formats) == 1:
            surface.framebuffer.color_mask = (True,) * 4
        alike = surface.samples == 1 and wired.result is not None and wired.result.size == surface.size
        if wired.result is not None and alike and _same_outputs(wired.result, surface, textures):
            # The same bits, on a software renderer in a tenth of the time.
            self.ctx.copy_framebuffer(surface.framebuffer, wired.result.framebuffer(self.ctx))
            return
        for unit, output in enumerate(kernel.outputs):
            if output.name in textures:
                self._copy_into(surface, unit, textures[output.name])

    def _take_depth(self, step: Step, name: str, inputs: Mapping[str, Wired], surface: Surface) -> None:
        """Begin with the depth of the draw whose pixels are drawn over; it is read and not written."""
        wired = inputs.get(name, Wired())
        earlier = wired.result.surface if wired.result is not None else None
        if earlier is None or (earlier.size, earlier.samples) != (surface.size, surface.samples):
            what = (
                f"a draw of {surface.size[0]} x {surface.size[1]} pixels and {surface.samples} samples each"
            )
            raise step.spec.error(f"pass '{step.path}' draws over '{name}', which needs to be {what}")
        copy_depth(self.ctx, surface.framebuffer, earlier.framebuffer, surface.size)

    def _copy_into(self, surface: Surface, unit: int, texture: moderngl.Texture) -> None:
        """Begin one of the outputs with a texture, nearest texel for nearest."""
        if len(surface.colours) == 1:
            self.kernels.copy(surface.framebuffer, surface.size, texture)
            return
        single = make_framebuffer(self.ctx, [surface.colours[unit]])
        self.kernels.copy(single, surface.size, texture)
        single.release()

    def _chosen(self, step: Step, inputs: Mapping[str, Wired], uniforms: Mapping[str, Any]) -> Chosen:
        """Return what to draw of a mesh with levels of detail."""
        kernel = _draw_of(step)
        chooser = CHOOSERS[kernel.mesh]
        required = ("clip_from_world", "eye", "extent", "relief")
        names = {*uniforms, *step.values}
        missing = [name for name in (*required, *chooser.parameters) if name not in names]
        if missing:
            raise kernel.error(f"mesh '{kernel.mesh}' needs a draw that reads {', '.join(missing)}")
        matrix = np.array(uniforms["clip_from_world"], np.float64).reshape(4, 4).T
        view = View(matrix, uniforms["eye"], uniforms["extent"], uniforms["relief"], step.full_size)

        def tables() -> dict[str, NDArray[np.float32]]:
            return {name: self._table(step, name, inputs) for name in chooser.inputs}

        return chooser.choose(step.values, tables, view)

    def _table(self, step: Step, name: str, inputs: Mapping[str, Wired]) -> NDArray[np.float32]:
        """Return the texels of an input, read once each time that they are computed."""
        result, texture, output = inputs.get(name, Wired())
        if result is None or texture is None:
            mesh = _draw_of(step).mesh
            raise step.spec.error(f"mesh '{mesh}' at this detail needs the input '{name}' wired")
        return result.array(output)

    def _array(
        self, program: Program, step: Step, inputs: Mapping[str, Wired]
    ) -> tuple[_Loaded, moderngl.VertexArray]:
        try:
            name = _draw_of(step).mesh
            key = (name, mesh_key(name, _mesh_values(step, inputs)))
        except (SketchError, ExpressionError) as error:
            raise step.spec.error(str(error)) from None
        if self.finest is not None:
            key = key[0], tuple((name, min(value, self.finest)) for name, value in key[1])
        mesh: _Loaded = self.meshes.get(key) or self.meshes.put(key, _Loaded(self.ctx, key))
        array = program.arrays.get(key)
        if array is None:
            array = program.arrays[key] = mesh.array(program)
        return mesh, array

    def _release_mesh(self, key: _MeshKey, mesh: _Loaded) -> None:
        self.kernels.programs.forget_mesh(key)
        mesh.release()


def _same_outputs(result: Result, surface: Surface, textures: Mapping[str, moderngl.Texture]) -> bool:
    """Return whether a result has just the textures that a surface begins with, in its order."""
    formats = tuple([output.format for output in result.outputs])
    return formats == surface.formats and [*result.textures.values()] == [*textures.values()]


def _refuse_others(step: Step, wired: Wired) -> None:
    """Refuse to go on from a draw of more or fewer outputs, whose samples have no place here."""
    outputs = [output.name for output in wired.result.outputs] if wired.result else []
    own = [output.name for output in step.kernel.outputs]
    if len(outputs) != len(own) or outputs[0] != wired.output:
        source = dict(step.inputs)["initial"]
        earlier = source.path if isinstance(source, Ref) else "initial"
        what = f"a draw of {', '.join(outputs)}; it gives {', '.join(own)}, and they must be as many"
        raise step.spec.error(f"pass '{step.path}' goes on from '{earlier}', {what}")


def _draw_of(step: Step) -> Draw:
    assert isinstance(step.kernel, Draw)
    return step.kernel


def _mesh_values(step: Step, inputs: Mapping[str, Wired]) -> dict[str, Value]:
    """Return a draw's parameters, and the count that its header computes."""
    kernel = _draw_of(step)
    if not kernel.count:
        return dict(step.values)
    if "count" not in mesh_parameters(kernel.mesh):
        raise SketchError(f"mesh '{kernel.mesh}' takes no count")
    sizes = {
        f"{name}.size.{axis}": wired.texture.size[k] if wired.texture else 1
        for name, wired in inputs.items()
        for k, axis in enumerate("xy")
    }
    return {**step.values, "count": expressions.evaluate(kernel.count, numbers_of(step, **sizes))}


def _enable(ctx: Any, depth: str, blend: str) -> None:
    """Switch depth test and blending as a draw's header says; with "none" twice, restore the defaults.

    "over" is for the far plane: where another draw has drawn, there it lies behind.
    """
    ctx.enable_only((ctx.DEPTH_TEST if depth != "none" else 0) | (ctx.BLEND if blend != "none" else 0))
    ctx.depth_func = {"equal": "==", "over": ">"}.get(depth, "<")
    if blend == "add":
        ctx.blend_func = ctx.ONE, ctx.ONE
    elif blend == "alpha":
        ctx.blend_func = ctx.SRC_ALPHA, ctx.ONE_MINUS_SRC_ALPHA, ctx.ONE, ctx.ONE_MINUS_SRC_ALPHA
    else:
        ctx.blend_func = ctx.DEFAULT_BLENDING


class _Loaded:
    """A mesh in buffers."""

    def __init__(self, ctx: moderngl.Context, key: _MeshKey) -> None:
        mesh = drawn_mesh(*key)
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
        self.triangles = mesh.indices.size // 3
        # Of a mesh with levels of detail: the tiles of the piece being drawn.
        self.places = ctx.buffer(reserve=16, dynamic=True) if key[0] in CHOOSERS else None

    def array(self, program: Program) -> moderngl.VertexArray:
        """Join the mesh to a program's attributes."""
        names = set(program.compiled)
        content: list[tuple[Any, ...]] = [each for each in self._attributes if each[2] in names]
        if self.places is not None and "k_in_tile" in names:
            content.append((self.places, "4f/i", "k_in_tile"))
        return self._ctx.vertex_array(
            program.compiled, content, index_buffer=self._indices, index_element_size=4
        )

    def render(self, array: moderngl.VertexArray, chosen: Chosen) -> int:
        """Draw each piece once for all of its tiles; return the number of triangles."""
        assert self.places is not None
        done, triangles = 0, 0
        for piece, count in chosen.runs:
            first, length = ranges().get(piece, (0, self._indices.size // 4))
            triangles += count * (length // 3)
            self.places.orphan(16 * count)  # what the driver still reads stays as it is
            self.places.write(np.ascontiguousarray(chosen.places[done : done + count]).tobytes())
            array.render(self._ctx.TRIANGLES, vertices=length, first=first, instances=count)
            done += count
        return triangles

    def release(self) -> None:
        """Release the buffers."""
        if self.places is not None:
            self.places.release()
        for buffer, _, _ in self._attributes:
            buffer.release()
        self._indices.release()


MAX_INSTANCES = 2**20
"""Instances that one draw may have."""
_COMPONENTS = "xyzw"


def instances_of(step: Step, inputs: Mapping[str, Wired], ctx: moderngl.Context) -> int:
    """Return how often a step's mesh is drawn; 1 where its header does not say.

    Raises ``SketchError`` where that is not a whole number from 0 to ``MAX_INSTANCES``.
    """
    kernel = step.kernel
    if not isinstance(kernel, Draw) or not kernel.instances:
        return 1
    if kernel.mesh in CHOOSERS:
        mesh = f"mesh '{kernel.mesh}' is drawn once for each of its tiles"
        raise kernel.error(f"{mesh}; it takes no instances")
    numbers = numbers_of(step)

    def number(name: str) -> Number:
        return numbers[name] if name in numbers else _component(step, name, inputs, ctx)

    try:
        count = expressions.evaluate(kernel.instances, number)
    except ExpressionError as error:
        raise step.spec.error(f"pass '{step.path}': instances {error}") from None
    if not 0 <= count <= MAX_INSTANCES:
        raise step.spec.error(f"pass '{step.path}': instances = {count}; 0 to {MAX_INSTANCES} were expected")
    return count


def counts_instances(technique: Technique, name: str) -> bool:
    """Return whether the first texel of an input of a technique says how often a draw in it is drawn."""
    if isinstance(technique, Kernel):
        if not isinstance(technique, Draw):
            return False
        named = (read.rpartition(".") for read in expressions.names_in(technique.instances or "0"))
        return any(declared == name and component in _COMPONENTS for declared, _, component in named)
    targets = (
        target.partition(".") for each in technique.inputs if each.name == name for target in each.targets
    )
    inside = ((technique.find(head), rest) for head, _, rest in targets)
    return any(spec is not None and counts_instances(spec.technique, rest) for spec, rest in inside)


def _component(step: Step, name: str, inputs: Mapping[str, Wired], ctx: moderngl.Context) -> Number:
    """Return a component of an input's first texel, of a name as ``list.x``."""
    declared, _, component = name.partition(".")
    wired = inputs.get(declared, Wired())
    if wired.result is None:
        raise ExpressionError(f"names '{declared}', to which nothing is wired")
    texel = wired.result.first_texel(ctx, wired.output)
    index = _COMPONENTS.index(component)
    if index >= len(texel):
        form = next(o.format for o in wired.result.outputs if o.name == wired.output)
        raise ExpressionError(f"names '{name}': '{declared}' has no component {component}; it is {form}")
    if not math.isfinite(texel[index]):
        raise step.spec.error(
            f"pass '{step.path}': instances: '{declared}' holds {texel[index]}; a number was expected"
        )
    return int(texel[index]) if texel[index].is_integer() else texel[index]

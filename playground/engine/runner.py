"""Run one step on a context: a kernel by either driver, a companion, a draw, a source, a plain shader.

Programs, meshes and file textures are kept; results are the caller's.
"""

from __future__ import annotations

import datetime
from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from playground.engine.files import content_hash
from playground.engine.plan import Plan, Step
from playground.engine.results import Result
from playground.errors import ContextError, SketchError
from playground.gpu.context import ContextInfo
from playground.gpu.program import compile_wrapped
from playground.gpu.textures import bytes_of, clear_texture, make_framebuffer, make_texture, write_texture
from playground.gpu.wrap import COMPUTE, LOCAL, Wrapped, wrap
from playground.images.files import read_image
from playground.sketch import expressions
from playground.sketch.expressions import ExpressionError
from playground.sketch.flatten import initial_names
from playground.sketch.header import PLAIN_UNIFORMS
from playground.sketch.model import Kernel, Output, Parameter, Sampling, Value
from playground.sketch.words import GIVEN
from playground.terrain.meshes import build_mesh, mesh_key
from playground.terrain.sources import source_kind

if TYPE_CHECKING:
    import moderngl

Wired = tuple["Result | None", "moderngl.Texture | None", str]
_SRGB8_ALPHA8 = 0x8C43  # GL_SRGB8_ALPHA8: the sampler decodes, before it filters
_MAX_PROGRAMS = 256
_COPY = """#version 330
uniform sampler2D k_picture;
out vec4 k_out;
void main() {
    vec2 share = gl_FragCoord.xy / vec2(textureSize(k_picture, 0));
    k_out = textureLod(k_picture, share, 0.0);
}
"""
_TRIANGLE = """#version 330
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""


class Runner:
    """Runs steps on one context."""

    def __init__(self, ctx: moderngl.Context, info: ContextInfo) -> None:
        self.ctx = ctx
        self.info = info
        self.mouse = (0.0, 0.0, 0.0, 0.0)  # of plain shaders: pixels from the lower left, then where it was pressed
        self.frame = 0  # of plain shaders
        self.delta = 1 / 60  # [s] of plain shaders
        self.compile_times: dict[str, float] = {}  # [ms] of each program compiled, by file
        self._programs: OrderedDict[Any, tuple[Any, moderngl.VertexArray | None]] = OrderedDict()
        self._samplers: dict[Sampling, moderngl.Sampler] = {}
        self._meshes: dict[Any, tuple[list[Any], moderngl.Buffer]] = {}
        self._files: OrderedDict[Any, moderngl.Texture] = OrderedDict()
        self._constants: dict[str, moderngl.Texture] = {}
        self._given: dict[str, Any] = {}

    def begin(self, plan: Plan) -> None:
        """Begin a frame."""
        eye = plan.eye
        self._given = {
            "time": plan.time,
            "extent": plan.land.extent,
            "relief": plan.land.relief,
            "base_elevation": plan.land.base_elevation,
            "clip_from_world": tuple(eye.clip_from_world.T.ravel().tolist()),
            "world_from_clip": tuple(eye.world_from_clip.T.ravel().tolist()),
            "eye": eye.position,
        }

    def release(self) -> None:
        """Give back every program, mesh and texture kept."""
        for program, vao in self._programs.values():
            if vao is not None:
                vao.release()
            program.release()
        for buffers, indices in self._meshes.values():
            for buffer, _, _ in buffers:
                buffer.release()
            indices.release()
        for kept in (*self._samplers.values(), *self._files.values(), *self._constants.values()):
            kept.release()
        self._programs.clear()
        self._meshes.clear()
        self._samplers.clear()
        self._files.clear()
        self._constants.clear()

    def given_for(self, kernel: Kernel, step: Step, plan: Plan) -> dict[str, Any]:
        """Return what the engine gives that the kernel's text names, turn counters apart."""
        found: dict[str, Any] = {}
        for name in GIVEN:
            if name in ("iteration", "iterations") or not kernel.reads(name):
                continue
            if name == "size":
                found[name] = step.size
            elif name == "spacing":
                extent = plan.land.extent or (1.0, 1.0)
                found[name] = tuple(e / max(s - 1, 1) for e, s in zip(extent, step.size, strict=True))
            else:
                found[name] = self._given[name]
        return found

    def program(self, kernel: Kernel, driver: str) -> Any:
        """Return the compiled program of a kernel, kept while its text stays; raise ``ShaderError``."""
        return self._program(wrap(kernel, driver))[0]

    def run(
        self,
        step: Step,
        plan: Plan,
        driver: str,
        inputs: Mapping[str, Wired],
        key: str,
        turn: tuple[int, int] | None = None,
    ) -> Result:
        """Run a step and return its textures; ``turn`` is that of the loop around it."""
        kernel = step.kernel
        self.ctx.disable(self.ctx.BLEND | self.ctx.DEPTH_TEST | self.ctx.CULL_FACE)
        if kernel.kind == "source":
            return self._source(step, key)
        if kernel.kind == "draw":
            return self._draw(step, plan, inputs, key)
        if kernel.kind == "compute":
            return self._companion(step, plan, inputs, key)
        if kernel.kind.startswith("plain"):
            return self._plain(step, plan, driver, key)
        if driver == COMPUTE:
            return self._compute(step, plan, inputs, key, turn)
        return self._fragment(step, plan, inputs, key, turn)

    # ── kernels ──────────────────────────────────────────────────────────────

    def _fragment(
        self, step: Step, plan: Plan, inputs: Mapping[str, Wired], key: str, turn: tuple[int, int] | None
    ) -> Result:
        program, vao = self._program(wrap(step.kernel, "fragment"))
        unit = self._common(program, step, plan, inputs)
        previous = self._initial(step, inputs)
        if step.repeat == 0:
            return self._untouched(step, previous, key)
        result = self._make_result(step, key)
        spare: Result | None = None
        for iteration in range(step.repeat):
            self._bind_previous(program, step.kernel, previous, unit)
            self._count(program, iteration, step, turn)
            framebuffer = make_framebuffer(self.ctx, [result.textures[o.name] for o in step.kernel.outputs])
            framebuffer.use()
            vao.render(self.ctx.TRIANGLES, vertices=3)
            framebuffer.release()
            if iteration + 1 < step.repeat:
                previous = result.textures
                if spare is None:
                    spare = self._make_result(step, key)
                result, spare = spare, result
        if spare is not None:
            spare.release()
        return result

    def _compute(
        self, step: Step, plan: Plan, inputs: Mapping[str, Wired], key: str, turn: tuple[int, int] | None
    ) -> Result:
        kernel = step.kernel
        program, _ = self._program(wrap(kernel, COMPUTE))
        unit = self._common(program, step, plan, inputs)
        previous = self._initial(step, inputs)
        if step.repeat == 0:
            return self._untouched(step, previous, key)
        if kernel.visits:
            return self._in_place(step, program, previous, key, turn)
        result = self._make_result(step, key)
        spare: Result | None = None
        groups = tuple(-(-side // LOCAL) for side in step.size)
        for iteration in range(step.repeat):
            self._bind_previous(program, kernel, previous, unit)
            self._count(program, iteration, step, turn)
            self._bind_images(kernel, result, read=False)
            program.run(*groups)
            self.ctx.memory_barrier()
            if iteration + 1 < step.repeat:
                previous = result.textures
                if spare is None:
                    spare = self._make_result(step, key)
                result, spare = spare, result
        if spare is not None:
            spare.release()
        return result

    def _in_place(
        self, step: Step, program: Any, previous: Mapping[str, moderngl.Texture], key: str, turn: tuple[int, int] | None
    ) -> Result:
        result = self._untouched(step, previous, key)
        self._bind_images(step.kernel, result, read=True)
        for iteration in range(step.repeat):
            self._count(program, iteration, step, turn)
            names: dict[str, expressions.Number] = {"size.x": step.size[0], "size.y": step.size[1]}
            names |= {"iteration": iteration, "iterations": step.repeat}
            names |= {k: v for k, v in step.values.items() if isinstance(v, int | float)}
            try:
                cells = expressions.evaluate_pair(step.kernel.visits, names)
            except ExpressionError as error:
                raise step.spec.error(f"pass '{step.path}': visits {error}") from None
            if min(cells) < 1:
                continue
            _set(program, "k_cells", cells)
            program.run(-(-cells[0] // LOCAL), -(-cells[1] // LOCAL))
            self.ctx.memory_barrier()
        return result

    def _companion(self, step: Step, plan: Plan, inputs: Mapping[str, Wired], key: str) -> Result:
        kernel = step.kernel
        program, _ = self._program(wrap(kernel, COMPUTE))
        self._common(program, step, plan, inputs)
        result = self._make_result(step, key)
        names: dict[str, expressions.Number] = {"size.x": step.size[0], "size.y": step.size[1]}
        names |= {k: v for k, v in step.values.items() if isinstance(v, int | float)}
        buffers = []
        try:
            repeat = expressions.evaluate(kernel.repeat, names)
            for unit, declared in enumerate(kernel.buffers):
                texel = {"vec4": 16, "ivec4": 16, "uvec4": 16, "vec2": 8, "ivec2": 8, "uvec2": 8}.get(declared.type, 4)
                buffer = self.ctx.buffer(reserve=max(expressions.evaluate(declared.count, names), 1) * texel)
                buffer.bind_to_storage_buffer(unit)
                buffers.append(buffer)
            self._bind_images(kernel, result, read=True)
            for iteration in range(repeat):
                groups = expressions.evaluate_pair(kernel.groups, {**names, "iteration": iteration})
                _set(program, "iteration", iteration)
                _set(program, "iterations", repeat)
                program.run(max(groups[0], 1), max(groups[1], 1))
                self.ctx.memory_barrier()
        except ExpressionError as error:
            raise step.spec.error(f"pass '{step.path}': {error}") from None
        finally:
            for buffer in buffers:
                buffer.release()
        return result

    def _plain(self, step: Step, plan: Plan, driver: str, key: str) -> Result:
        kernel = step.kernel
        wrapped = wrap(kernel, driver)
        program, vao = self._program(wrapped)
        for name, value in step.values.items():
            _set(program, name, value)
        width, height = step.size
        now = datetime.datetime.now()
        midnight = now.replace(hour=0, minute=0, second=0, microsecond=0)
        date = (now.year, now.month - 1, now.day, (now - midnight).total_seconds())
        for meaning, value in {
            "time": (plan.time,),
            "resolution": (float(width), float(height), 1.0),
            "mouse": self.mouse,
            "frame": (self.frame,),
            "delta": (self.delta,),
            "date": date,
        }.items():
            for name in PLAIN_UNIFORMS[meaning]:
                if name in program:
                    member = program[name]
                    components = getattr(member, "dimension", 1)
                    found = value[:components]
                    member.value = (int(found[0]) if meaning == "frame" and _is_whole(member) else found[0]) if components == 1 else found
        result = self._make_result(step, key)
        texture = result.textures[kernel.outputs[0].name]
        if wrapped.driver == COMPUTE:
            clear_texture(self.ctx, texture)
            texture.bind_to_image(0, read=True, write=True)
            program.run(-(-width // kernel.local[0]), -(-height // kernel.local[1]))
            self.ctx.memory_barrier()
            return result
        framebuffer = make_framebuffer(self.ctx, [texture])
        framebuffer.use()
        framebuffer.clear(0, 0, 0, 1)
        assert vao is not None
        vao.render(self.ctx.TRIANGLES, vertices=3)
        framebuffer.release()
        return result

    def _source(self, step: Step, key: str) -> Result:
        arrays = source_kind(step.kernel.registry).make(step.values, step.size)
        result = self._make_result(step, key)
        for output in step.kernel.outputs:
            if output.name not in arrays:
                raise step.spec.error(f"source '{step.kernel.registry}' gives {', '.join(arrays)}, not '{output.name}'")
            write_texture(result.textures[output.name], arrays[output.name])
        return result

    # ── draws ────────────────────────────────────────────────────────────────

    def _draw(self, step: Step, plan: Plan, inputs: Mapping[str, Wired], key: str) -> Result:
        ctx, kernel = self.ctx, step.kernel
        output = kernel.outputs[0]
        program, _ = self._program(wrap(kernel, "draw"))
        samples = min(plan.sketch.samples, self.info.max_samples)
        components = output.components
        dtype = "f1" if output.format.endswith("8") else "f4" if output.format.endswith("32f") else "f2"
        colour = ctx.renderbuffer(step.size, components, samples=samples if samples > 1 else 0, dtype=dtype)
        depth = ctx.depth_renderbuffer(step.size, samples=samples if samples > 1 else 0)
        surface = make_framebuffer(ctx, [colour], depth)
        surface.use()
        surface.clear(0, 0, 0, 0, depth=1.0)
        self._start_from(inputs.get("initial"), surface, samples)
        surface.use()
        unit = self._common(program, step, plan, inputs)
        del unit
        vao = self._mesh(program, step)
        if kernel.depth == "less":
            ctx.enable(ctx.DEPTH_TEST)
        if kernel.blend != "none":
            ctx.enable(ctx.BLEND)
            ctx.blend_func = (
                (ctx.SRC_ALPHA, ctx.ONE_MINUS_SRC_ALPHA, ctx.ONE, ctx.ONE_MINUS_SRC_ALPHA)
                if kernel.blend == "alpha"
                else (ctx.ONE, ctx.ONE)
            )
        for iteration in range(step.repeat):
            self._count(program, iteration, step, None)
            vao.render(ctx.TRIANGLES)
        ctx.disable(ctx.BLEND | ctx.DEPTH_TEST)
        vao.release()
        result = self._make_result(step, key)
        resolved = make_framebuffer(ctx, [result.textures[output.name]])
        ctx.copy_framebuffer(resolved, surface)
        resolved.release()
        result.surface = surface
        result.bytes += bytes_of(step.size, output.format) * samples + step.size[0] * step.size[1] * 4 * samples
        return result

    def _start_from(self, wired: Wired | None, surface: moderngl.Framebuffer, samples: int) -> None:
        """Begin a draw with an earlier picture: a draw's samples and depth, or a texture's colours."""
        if wired is None or wired[1] is None:
            return
        result, texture, _ = wired
        if result is not None and result.surface is not None and result.surface.samples == surface.samples:
            self.ctx.copy_framebuffer(surface, result.surface)
            return
        program, vao = self._plain_program(("copy",), _COPY)
        texture.use(0)
        self._sampler(Sampling("nearest")).use(0)
        _set(program, "k_picture", 0)
        vao.render(self.ctx.TRIANGLES, vertices=3)

    def _mesh(self, program: Any, step: Step) -> moderngl.VertexArray:
        try:
            key = mesh_key(step.kernel.registry, step.values)
        except SketchError as error:
            raise step.spec.error(str(error)) from None
        full = (step.kernel.registry, key)
        if full not in self._meshes:
            mesh = build_mesh(*full)
            buffers = []
            for name, array in mesh.attributes.items():
                buffer = self.ctx.buffer(np.ascontiguousarray(array, np.float32).tobytes())
                buffers.append((buffer, f"{array.shape[1]}f", name))
            self._meshes[full] = (buffers, self.ctx.buffer(mesh.indices.astype(np.uint32).tobytes()))
        buffers, indices = self._meshes[full]
        content = [(buffer, form, f"k_in_{name}") for buffer, form, name in buffers if f"k_in_{name}" in program]
        return self.ctx.vertex_array(program, content, index_buffer=indices, index_element_size=4)

    # ── what they share ──────────────────────────────────────────────────────

    def _make_result(self, step: Step, key: str) -> Result:
        textures = {o.name: make_texture(self.ctx, step.size, o.format) for o in step.kernel.outputs}
        total = sum(bytes_of(step.size, o.format) for o in step.kernel.outputs)
        return Result(key, step.size, textures, total)

    def _untouched(self, step: Step, previous: Mapping[str, moderngl.Texture], key: str) -> Result:
        """Return the state before the first turn, in textures of its own."""
        result = self._make_result(step, key)
        for output in step.kernel.outputs:
            target = result.textures[output.name]
            if output.name in previous:
                source = make_framebuffer(self.ctx, [previous[output.name]])
                destination = make_framebuffer(self.ctx, [target])
                self.ctx.copy_framebuffer(destination, source)
                source.release()
                destination.release()
            else:
                clear_texture(self.ctx, target)
        return result

    def _initial(self, step: Step, inputs: Mapping[str, Wired]) -> dict[str, moderngl.Texture]:
        found: dict[str, moderngl.Texture] = {}
        for name, output in initial_names(step.kernel).items():
            texture = inputs.get(name, (None, None, ""))[1]
            if texture is None:
                continue
            if texture.size != step.size:
                raise step.spec.error(
                    f"pass '{step.path}': {name} is {texture.width} x {texture.height} texels, "
                    f"the pass {step.size[0]} x {step.size[1]}; they must agree"
                )
            found[output] = texture
        return found

    def _common(self, program: Any, step: Step, plan: Plan, inputs: Mapping[str, Wired]) -> int:
        """Set what stays over the turns: given names, parameters, textures. Returns the next free texture unit."""
        kernel = step.kernel
        for name, value in self.given_for(kernel, step, plan).items():
            _set(program, name, value)
        _set(program, "size", step.size)
        unit = 0
        for parameter in kernel.parameters:
            if parameter.widget.kind != "file":
                _set(program, parameter.name, step.values[parameter.name])
            elif parameter.name in program:
                texture = self._file(parameter, step.values[parameter.name])
                texture.use(unit)
                self._sampler(parameter.sampling).use(unit)
                program[parameter.name].value = unit
                unit += 1
        for declared in kernel.inputs:
            if declared.name not in program:
                continue
            result, texture, output = inputs.get(declared.name, (None, None, ""))
            if texture is None:
                texture = self._constant(declared.fallback or "black")
            elif declared.sampling.mipmap and (result is None or output not in result.mipmapped):
                texture.build_mipmaps()
                if result is not None:
                    result.mipmapped.add(output)
            texture.use(unit)
            self._sampler(declared.sampling).use(unit)
            program[declared.name].value = unit
            unit += 1
        return unit

    def _bind_previous(
        self, program: Any, kernel: Kernel, previous: Mapping[str, moderngl.Texture], unit: int
    ) -> None:
        for output in kernel.outputs:
            name = f"k_previous_{output.name}"
            if name in program:
                texture = previous.get(output.name) or self._constant("zero")
                texture.use(unit)
                self._sampler(Sampling()).use(unit)
                program[name].value = unit
                unit += 1

    def _bind_images(self, kernel: Kernel, result: Result, *, read: bool) -> None:
        for unit, output in enumerate(kernel.outputs):
            result.textures[output.name].bind_to_image(unit, read=read, write=True)

    def _count(self, program: Any, iteration: int, step: Step, turn: tuple[int, int] | None) -> None:
        """Tell a kernel its turn: its own where it repeats, else that of the loop around it."""
        inner = turn is None or step.kernel.repeat != "1"
        now, whole = (iteration, step.repeat) if inner or turn is None else turn
        _set(program, "iteration", now)
        _set(program, "iterations", whole)

    def _program(self, wrapped: Wrapped) -> tuple[Any, Any]:
        key = tuple(stage.text for stage in wrapped.stages.values())
        if key not in self._programs:
            import time

            start = time.perf_counter()
            program = compile_wrapped(self.ctx, wrapped)
            self.compile_times[wrapped.kernel.path] = (time.perf_counter() - start) * 1e3
            vao = self.ctx.vertex_array(program, []) if wrapped.driver == "fragment" else None
            self._keep(key, program, vao)
        self._programs.move_to_end(key)
        return self._programs[key]

    def _plain_program(self, key: tuple[str], fragment: str) -> tuple[Any, Any]:
        if key not in self._programs:
            program = self.ctx.program(vertex_shader=_TRIANGLE, fragment_shader=fragment)
            self._keep(key, program, self.ctx.vertex_array(program, []))
        return self._programs[key]

    def _keep(self, key: Any, program: Any, vao: Any) -> None:
        self._programs[key] = (program, vao)
        while len(self._programs) > _MAX_PROGRAMS:
            _, (old, old_vao) = self._programs.popitem(last=False)
            if old_vao is not None:
                old_vao.release()
            old.release()

    def _sampler(self, sampling: Sampling) -> moderngl.Sampler:
        if sampling not in self._samplers:
            linear = sampling.filter == "linear"
            sampler = self.ctx.sampler(repeat_x=sampling.wrap == "repeat", repeat_y=sampling.wrap == "repeat")
            shrink = self.ctx.LINEAR if linear else self.ctx.NEAREST
            if sampling.mipmap:
                shrink = self.ctx.LINEAR_MIPMAP_LINEAR if linear else self.ctx.NEAREST_MIPMAP_NEAREST
            sampler.filter = (shrink, self.ctx.LINEAR if linear else self.ctx.NEAREST)
            self._samplers[sampling] = sampler
        return self._samplers[sampling]

    def _file(self, parameter: Parameter, value: Value) -> moderngl.Texture:
        path = Path(str(value))
        key = (str(path), content_hash(path), parameter.sampling.mipmap)
        if key not in self._files:
            pixels = read_image(path).pixels[::-1]
            height, width = pixels.shape[:2]
            if max(width, height) > self.info.max_texture:
                raise ContextError(f"an image of {width} x {height}; this driver takes {self.info.max_texture} a side", file=path)
            if pixels.dtype == np.uint8:
                data = np.ascontiguousarray(pixels).tobytes()
                texture = self.ctx.texture((width, height), 4, data, alignment=1, internal_format=_SRGB8_ALPHA8)
            else:
                from playground.sketch.colour import srgb_to_linear

                top = float(np.iinfo(pixels.dtype).max) if pixels.dtype.kind == "u" else 1.0
                linear = pixels.astype(np.float64) / top
                linear[..., :3] = srgb_to_linear(linear[..., :3])
                texture = self.ctx.texture((width, height), 4, linear.astype(np.float16).tobytes(), alignment=1, dtype="f2")
            if parameter.sampling.mipmap:
                texture.build_mipmaps()
            self._files[key] = texture
            while len(self._files) > 32:
                self._files.popitem(last=False)[1].release()
        self._files.move_to_end(key)
        return self._files[key]

    def _constant(self, name: str) -> moderngl.Texture:
        if name not in self._constants:
            value = {"white": (1, 1, 1, 1), "black": (0, 0, 0, 1), "zero": (0, 0, 0, 0)}[name]
            self._constants[name] = self.ctx.texture((1, 1), 4, np.array(value, np.float32).tobytes(), dtype="f4")
        return self._constants[name]


def _is_whole(member: Any) -> bool:
    return getattr(member, "gl_type", 0) in (0x1404, 0x1405)  # GL_INT, GL_UNSIGNED_INT


def _set(program: Any, name: str, value: Any) -> None:
    """Set a uniform if the driver kept it."""
    if name in program:
        program[name].value = value

"""Run what computes texels: a kernel by either driver, a companion, a plain shader.

A kernel that repeats writes two sets of textures in turn, reading one and writing the
other; one with visits, in compute, changes its only set in place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from playground.engine.binder import Binder
from playground.engine.plan import Step
from playground.engine.programs import Program, Programs
from playground.engine.results import Pool, Result, Wired
from playground.gpu.textures import make_framebuffer
from playground.gpu.wrap import COMPUTE, FRAGMENT, LOCAL
from playground.sketch import expressions
from playground.sketch.expressions import ExpressionError, Number
from playground.sketch.header import PLAIN_UNIFORMS
from playground.sketch.model import Kernel, Sampling
from playground.sketch.wiring import initial_names

if TYPE_CHECKING:
    import moderngl

_COPY = """#version 330
uniform sampler2D k_picture;
uniform ivec2 k_size;
out vec4 k_out;
void main() {
    ivec2 whole = textureSize(k_picture, 0);
    ivec2 texel = ivec2(gl_FragCoord.xy / vec2(k_size) * vec2(whole));
    k_out = texelFetch(k_picture, min(texel, whole - 1), 0);
}
"""
_BYTES = {"vec2": 8, "ivec2": 8, "uvec2": 8, "vec3": 16, "ivec3": 16, "uvec3": 16}
_BYTES |= {"vec4": 16, "ivec4": 16, "uvec4": 16, "mat4": 64}
_MAX_BUFFER = 2**31 - 1
_SAMPLER_2D = 0x8B5E


@dataclass(frozen=True, slots=True)
class Job:
    """One step about to run, with all it reads."""

    step: Step
    given: Mapping[str, Any]  # what the engine gives, by name
    inputs: Mapping[str, Wired]
    turn: tuple[int, int] | None = None  # of the loop around it, and its turns in all
    start: Result | None = None  # the same step after fewer turns, to go on from; it is used up
    samples: int = 1  # of a draw
    keeps_surface: bool = False  # a later draw goes on from this one

    def count(self, program: Program, iteration: int, repeat: str, whole: int) -> None:
        """Tell a kernel its turn: its own where it repeats, else that of the loop around it."""
        now, total = (iteration, whole) if repeat != "1" or self.turn is None else self.turn
        program.set("iteration", now)
        program.set("iterations", total)

    def numbers(self, **more: Number) -> dict[str, Number]:
        """Return what the expressions of a header may name."""
        found: dict[str, Number] = {"size.x": self.step.size[0], "size.y": self.step.size[1], **more}
        return found | {k: v for k, v in self.step.values.items() if isinstance(v, int | float)}


class Kernels:
    """Runs kernels, companions and plain shaders on one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: Programs, binder: Binder, pool: Pool, *, software: bool
    ) -> None:
        self.ctx = ctx
        self.software = software  # whether the processor draws
        self.programs = programs
        self.binder = binder
        self.pool = pool

    def run(self, job: Job, driver: str) -> Result:
        """Run a kernel by a driver; the result is the caller's."""
        step = job.step
        program = self.program(step, driver)
        state = self._initial(job)
        if step.repeat == 0:
            return self._untouched(step, state)
        unit = self.binder.bind(program, step, job.given, job.inputs)
        if driver == COMPUTE and step.kernel.visits:
            return self._in_place(job, program, state)
        return self._by_turns(job, program, driver, state, unit)

    def program(self, step: Step, driver: str) -> Program:
        """Return the program of a step; where the processor draws, one for each choice of menus."""
        if not self.software:
            return self.programs.get(step.kernel, driver)
        choices = (
            (p.name, step.values[p.name])
            for p in step.kernel.parameters
            if p.type == "bool" or p.widget.kind == "menu"
        )
        return self.programs.get(step.kernel, driver, tuple((n, int(v)) for n, v in choices))  # type: ignore[arg-type]

    def copy(self, target: moderngl.Framebuffer, size: tuple[int, int], texture: moderngl.Texture) -> None:
        """Fill a framebuffer with a texture, nearest texel for nearest."""
        target.use()
        program = self.programs.own(_COPY)
        self.binder.texture(program, "k_picture", 0, texture, Sampling())
        program.set("k_size", size)
        program.fill()

    def empty(self, step: Step) -> Result:
        """Return the textures of a step, all zeros."""
        result = self.pool.take(step.size, step.kernel.outputs)
        framebuffer = result.framebuffer(self.ctx)
        framebuffer.use()  # clear() binds anew what was bound before, which may have been released by now
        framebuffer.clear()
        return result

    def companion(self, job: Job) -> Result:
        """Run a companion: its textures and buffers are zeros when it begins."""
        step, kernel = job.step, job.step.kernel
        program = self.program(step, COMPUTE)
        names = job.numbers()
        buffers: list[moderngl.Buffer] = []
        result = self.empty(step)
        try:
            repeat = expressions.evaluate(kernel.repeat, names)
            for unit, declared in enumerate(kernel.buffers):
                count = max(expressions.evaluate(declared.count, names), 1) * _BYTES.get(declared.type, 4)
                if count > _MAX_BUFFER:
                    megabytes = count / 2**20
                    message = f"buffer '{declared.name}' would be {megabytes:.0f} MiB; 2048 at most"
                    raise kernel.error(f"pass '{step.path}': {message}")
                buffer = self.ctx.buffer(reserve=count)
                buffers.append(buffer)
                buffer.clear()
                buffer.bind_to_storage_buffer(unit)
            self.binder.bind(program, step, job.given, job.inputs)
            self._images(result, read=True)
            for iteration in range(repeat):
                groups = expressions.evaluate_pair(kernel.groups, {**names, "iteration": iteration})
                job.count(program, iteration, kernel.repeat, repeat)
                program.run(max(groups[0], 1), max(groups[1], 1))
        except ExpressionError as error:
            self.pool.give(result)
            raise kernel.error(f"pass '{step.path}': {error}") from None
        except Exception:
            self.pool.give(result)
            raise
        finally:
            for buffer in buffers:
                buffer.release()
        return result

    def plain(self, job: Job, usual: Mapping[str, tuple[float, ...]]) -> Result:
        """Run a plain shader; ``usual`` are the uniforms that such shaders know under several names."""
        step, kernel = job.step, job.step.kernel
        driver = COMPUTE if kernel.kind == "plain_compute" else FRAGMENT
        program = self.programs.get(kernel, driver)
        for name, value in step.values.items():
            program.set(name, value)
        for meaning, values in usual.items():
            for name in PLAIN_UNIFORMS[meaning]:
                if name in program:
                    _set_fitting(program, name, values)
        unit = 0
        for name, uniform in program.uniforms.items():
            if getattr(uniform, "gl_type", 0) == _SAMPLER_2D:  # a channel that nothing feeds
                unit = self.binder.texture(program, name, unit, self.binder.constant("black"), Sampling())
        result = self.empty(step)
        if driver == COMPUTE:
            self._images(result, read=True)
            program.run(-(-step.size[0] // kernel.local[0]), -(-step.size[1] // kernel.local[1]))
            return result
        result.framebuffer(self.ctx).use()
        program.fill()
        return result

    # ── turns ────────────────────────────────────────────────────────────────

    def _by_turns(
        self, job: Job, program: Program, driver: str, state: Mapping[str, moderngl.Texture], unit: int
    ) -> Result:
        step, kernel = job.step, job.step.kernel
        groups = (-(-step.size[0] // LOCAL), -(-step.size[1] // LOCAL))
        before, result = job.start, None  # two sets of textures that change places
        first = before.turn if before else 0
        for iteration in range(first, step.repeat):
            result = self.pool.take(step.size, kernel.outputs)
            self.binder.previous(program, kernel, state, unit)
            job.count(program, iteration, kernel.repeat, step.whole)
            if driver == COMPUTE:
                self._images(result, read=False)
                program.run(*groups)
            else:
                result.framebuffer(self.ctx).use()
                self._fill(program)
            if before is not None:
                self.pool.give(before)
            before, state = result, result.textures
        assert before is not None
        before.turn = step.repeat
        return before

    def _fill(self, program: Program) -> None:
        """Draw over the whole of the bound framebuffer.

        Blending with "all of the new, nothing of the old" changes no bit, but llvmpipe then
        compiles a text once, not a second time for tiles whose old texels it need not load:
        a quarter less of what a save waits for.
        """
        if not self.software:
            program.fill()
            return
        self.ctx.enable_only(self.ctx.BLEND)
        self.ctx.blend_func = self.ctx.ONE, self.ctx.ZERO
        try:
            program.fill()
        finally:
            self.ctx.enable_only(self.ctx.NOTHING)
            self.ctx.blend_func = self.ctx.DEFAULT_BLENDING  # type: ignore[assignment]

    def _in_place(self, job: Job, program: Program, state: Mapping[str, moderngl.Texture]) -> Result:
        step, kernel = job.step, job.step.kernel
        result = job.start or self._untouched(step, state)
        self._images(result, read=True)
        for iteration in range(result.turn, step.repeat):
            job.count(program, iteration, kernel.repeat, step.whole)
            names = job.numbers(iteration=iteration, iterations=step.whole)
            try:
                cells = expressions.evaluate_pair(kernel.visits, names)
            except ExpressionError as error:
                self.pool.give(result)
                raise kernel.error(f"pass '{step.path}': visits {error}") from None
            if min(cells) >= 1:
                program.set("k_cells", cells)
                program.run(-(-cells[0] // LOCAL), -(-cells[1] // LOCAL))
        result.turn = step.repeat
        return result

    def _initial(self, job: Job) -> dict[str, moderngl.Texture]:
        """Return the state before the first turn to run, by output; what is missing is zero."""
        if job.start is not None:
            return dict(job.start.textures)
        step = job.step
        found: dict[str, moderngl.Texture] = {}
        for name, output in initial_names(step.kernel).items():
            texture = job.inputs.get(name, Wired()).texture
            if texture is None:
                continue
            if texture.size != step.size:
                raise step.spec.error(
                    f"pass '{step.path}': {name} is {texture.width} x {texture.height} texels, "
                    f"the pass {step.size[0]} x {step.size[1]}; they must agree"
                )
            found[output] = texture
        return found

    def _untouched(self, step: Step, state: Mapping[str, moderngl.Texture]) -> Result:
        """Return the state before the first turn, in textures of its own."""
        result = self.empty(step)
        for output in step.kernel.outputs:
            if output.name in state:
                self.copy_texture(result.textures[output.name], state[output.name])
        return result

    def copy_texture(self, target: moderngl.Texture, source: moderngl.Texture) -> None:
        """Fill a texture with another, nearest texel for nearest."""
        single = make_framebuffer(self.ctx, [target])
        self.copy(single, target.size, source)
        single.release()

    def _images(self, result: Result, *, read: bool) -> None:
        for unit, output in enumerate(result.outputs):
            result.textures[output.name].bind_to_image(unit, read=read, write=True)


def usual_of(kernel: Kernel, known: Mapping[str, tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    """Return those of the usual uniforms that a plain shader's text names."""
    return {
        meaning: values
        for meaning, values in known.items()
        if any(kernel.reads(name) for name in PLAIN_UNIFORMS[meaning])
    }


def _set_fitting(program: Program, name: str, values: tuple[float, ...]) -> None:
    """Set as many components as the uniform has, in its own kind of number."""
    uniform = program.uniforms[name]
    count = int(getattr(uniform, "dimension", 1))
    whole = getattr(uniform, "gl_type", 0) in _WHOLE
    found: list[float] = [int(v) if whole else float(v) for v in (*values, *(0.0,) * count)[:count]]
    uniform.value = found[0] if count == 1 else tuple(found)


_WHOLE = frozenset({0x1404, 0x1405, *range(0x8B53, 0x8B56), *range(0x8DC6, 0x8DC9)})
"""GL_INT, GL_UNSIGNED_INT, GL_INT_VEC2 to 4, GL_UNSIGNED_INT_VEC2 to 4."""

"""Run what computes texels: a kernel by either driver, or a plain shader.

A kernel that repeats writes two sets of textures alternately: it reads one and writes the
other; one with visits, in compute, changes its only set in place. One whose iterations fill a
lattice ever more closely fills, in fragment, as small a part of its textures as that takes.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isqrt
from typing import TYPE_CHECKING, Any

from playground.engine.binder import Binder
from playground.engine.lattice import shift_after
from playground.engine.plan import LoopIteration, Step
from playground.engine.programs import Bound, Program, Programs
from playground.engine.results import UNWIRED as NOT_WIRED
from playground.engine.results import Pool, Result, Swap, Wired, wires_of
from playground.engine.textures import make_framebuffer
from playground.engine.tuning import Choices, Stage, Tuning
from playground.shader import expressions
from playground.shader.expressions import ExpressionError, Number
from playground.shader.own_shaders import own_shader
from playground.shader.parameter import Sampling
from playground.shader.reserved_names import DEPTH, ELEMENT, PART, PRESSED, SIZES, VALUE, WINDOW
from playground.shader.wrap import COMPUTE, FRAGMENT, LOCAL
from playground.sketch.model import ForeignShader, Kernel, Output, PlainCompute, TexelKernel
from playground.sketch.wiring import initial_names

if TYPE_CHECKING:
    import moderngl

_BLOCK = 4  # texels a side that one fragment compares
_TARGET = (Output("k_changed", "r8"),)


class Settling:
    """Compares the steps of repeats on one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: Programs, binder: Binder, pool: Pool, *, waits: bool
    ) -> None:
        self.ctx = ctx
        self.programs = programs
        self.binder = binder
        self.pool = pool
        self.waits = waits  # for each answer, else for that to the comparison before
        self.compared = 0  # so far
        self._query: Any = None  # read before it is used again

    def watch(self, done: int, unit: int) -> Watch:
        """Return what watches one repeat after ``done`` steps; ``unit`` and those after it are free."""
        return Watch(self, done, unit)

    def compare(self, now: Result, before: Result, unit: int) -> Any:
        """Return a query of whether two steps differ; it leaves another framebuffer and program bound."""
        self._query = self._query or self.ctx.query(samples=True)
        self.compared += 1
        width, height = now.size
        target = self.pool.take((-(-width // _BLOCK), -(-height // _BLOCK)), _TARGET)
        program = self.programs.own(own_shader("changed.frag"))
        target.framebuffer(self.ctx).use()
        program.set("k_block", _BLOCK)
        with self._query:
            for output in now.outputs:
                for name, result, texture_unit in (("k_now", now, unit), ("k_before", before, unit + 1)):
                    self.binder.texture(program, name, texture_unit, result.textures[output.name], Sampling())
                program.fill()
        self.pool.give(target)
        return self._query


class Watch:
    """Watches the steps of one repeat."""

    def __init__(self, settling: Settling, done: int, unit: int) -> None:
        self._settling = settling
        self._unit = unit
        self._next = done + 2 + isqrt(done)
        self._asked: Any = None  # the last comparison, whose answer was not read

    def has_settled(self, done: int, now: Result, before: Result) -> bool:
        """Return whether a step is known to have changed nothing; ``done`` counts the last one, ``now``."""
        if done < self._next:
            return False
        self._next = done + 1 + isqrt(done)
        earlier = self._asked
        if earlier is not None and not earlier.samples:
            return True
        self._asked = self._settling.compare(now, before, self._unit)
        return self._settling.waits and not self._asked.samples


_SAMPLERS = frozenset(
    {*range(0x8B5D, 0x8B65), *range(0x8DC0, 0x8DC6), *range(0x8DC9, 0x8DD9), *range(0x9108, 0x910E)}
)
"""GL_SAMPLER_1D to GL_UNSIGNED_INT_SAMPLER_2D_MULTISAMPLE_ARRAY."""
_MAX_LEVELS = 12  # of a pyramid of another tool
_SHAPES = {0x8B5D: "line", 0x8B5F: "volume", 0x8B60: "cube", 0x8DC1: "layers"}
"""GL_SAMPLER_1D, 3D, CUBE and 2D_ARRAY, with the shapes of what they read."""


def numbers_of(step: Step, **more: Number) -> dict[str, Number]:
    """Return what the expressions of a step's header may name."""
    width, height = step.full_size
    numbers: dict[str, Number] = {"size.x": width, "size.y": height, **more}
    return numbers | {k: v for k, v in step.values.items() if isinstance(v, int | float)}


class Kernels:
    """Runs kernels and plain shaders on one context."""

    def __init__(self, ctx: moderngl.Context, pool: Pool, tuning: Tuning) -> None:
        self.ctx = ctx
        self.pool = pool
        self.tuning = tuning
        self.programs = Programs(ctx, tuning)
        self.binder = Binder(ctx, tuning)
        self.settling = Settling(ctx, self.programs, self.binder, pool, waits=tuning.waits)
        # Programs of this frame's steps, by the step's identity; the step is held with it.
        self._known: dict[tuple[int, str, tuple[int, ...]], tuple[Step, Program, Stage]] = {}
        self._frame = 0

    def release(self) -> None:
        """Release programs, samplers, and the textures of files."""
        self.tuning.release()
        self.binder.release()
        self.programs.release()

    def run(
        self,
        step: Step,
        driver: str,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        around: LoopIteration | None,
        start: Result | None,
    ) -> Result:
        """Run a kernel by a driver; the result is the caller's.

        ``uniforms`` are what the engine gives, by name; ``around`` is where the step is in the loops around
        it; ``start`` the same step after fewer iterations, to go on from, which is used up.
        """
        kernel = step.kernel
        assert isinstance(kernel, TexelKernel)
        program, stage = self._known_program(step, driver, inputs, around)
        if start is not None and start.settled:
            start.iterations = step.repeat
            return start
        state = self.initial(step, inputs) if start is None else dict(start.textures)
        if step.repeat == 0:
            return self._untouched(step, state)
        if stage.first is not None:
            first = self.programs.get(kernel, driver, stage.first.choices)
            result = self.pool.take(step.size, kernel.outputs)
            with stage.first.drawing(result):
                for part in (first, program):
                    unit = self.binder.bind(part, step, uniforms, inputs, stage)
                    self.binder.previous(self.binder.previous_units(part, kernel, unit), state)
                    part.count(kernel.repeat, 0, step.total, around)
                    with self.tuning.filling:
                        part.fill()
            result.iterations = step.repeat
            return result
        unit = self.binder.bind(program, step, uniforms, inputs, stage)
        if driver == COMPUTE and kernel.visits:
            return self._in_place(step, kernel, program, start or self._untouched(step, state), around)
        return self._alternately(step, kernel, program, driver, state, unit, start, around)

    def _known_program(
        self, step: Step, driver: str, inputs: Mapping[str, Wired], around: LoopIteration | None
    ) -> tuple[Program, Stage]:
        """Return the program of a step and how it runs: as before in this frame, where it is wired so."""
        if self._frame != self.programs.frame:
            self._frame = self.programs.frame
            self._known.clear()
        key = id(step), driver, wires_of(step, inputs)
        if key not in self._known:
            self._known[key] = step, *self.program(step, driver, inputs, around)
        return self._known[key][1:]

    def program(
        self,
        step: Step,
        driver: str,
        inputs: Mapping[str, Wired],
        around: LoopIteration | None,
        more: Choices = (),
    ) -> tuple[Program, Stage]:
        """Return the program of a step and how it runs; ``more`` is written into it, if anything is."""
        stage = self.tuning.stage(step, inputs, driver, in_loop=around is not None)
        return self.programs.get(step.kernel, driver, (*stage.choices, *more)), stage

    def draw_utility_shader(
        self, shader: str, target: moderngl.Framebuffer, source: moderngl.Texture, **uniforms: Any
    ) -> None:
        """Fill a framebuffer by one of the engine's own fragment shaders, which reads a texture."""
        target.use()
        program = self.programs.own(own_shader(shader))
        self.binder.texture(program, "k_picture", 0, source, Sampling())
        program.set_all(uniforms)
        program.fill()

    def run_utility_shader(self, shader: str, result: Result, **uniforms: Any) -> Result:
        """Return new textures of the caller, each filled from a result's as ``draw_utility_shader`` does."""
        result_textures = self.pool.take(result.size, result.outputs)
        for output in result.outputs:
            target = make_framebuffer(self.ctx, [result_textures.textures[output.name]])
            self.draw_utility_shader(shader, target, result.textures[output.name], **uniforms)
            target.release()
        return result_textures

    def copy(self, target: moderngl.Framebuffer, size: tuple[int, int], texture: moderngl.Texture) -> None:
        """Fill a framebuffer with a texture, nearest texel for nearest."""
        self.draw_utility_shader("copy.frag", target, texture, k_size=size)

    def copied(self, result: Result) -> Result:
        """Return a result's copy, the caller's."""
        copy = self.pool.take(result.size, result.outputs)
        for output in result.outputs:
            self.copy_texture(copy.textures[output.name], result.textures[output.name])
        copy.iterations, copy.settled = result.iterations, result.settled
        return copy

    def empty(self, step: Step) -> Result:
        """Return the textures of a step, all zeros."""
        result = self.pool.take(step.size, step.kernel.outputs)
        framebuffer = result.framebuffer(self.ctx)
        framebuffer.use()  # clear() binds again what was bound before, which may have been released by now
        framebuffer.clear()
        return result

    def plain(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        around: LoopIteration | None,
        usual: Mapping[str, tuple[float, ...]],
    ) -> Result:
        """Run a plain shader; ``usual`` are the uniforms that such shaders know under several names.

        The others are those of ``run``.
        """
        kernel = step.kernel
        driver = COMPUTE if isinstance(kernel, PlainCompute) else FRAGMENT
        program = self.programs.get(kernel, driver)
        self.bind_plain(program, step, inputs, uniforms, around, usual)
        result = self.empty(step)
        if isinstance(kernel, PlainCompute):
            self.images(result, read=True)
            program.run(-(-step.size[0] // kernel.local[0]), -(-step.size[1] // kernel.local[1]))
            return result
        result.framebuffer(self.ctx).use()
        program.fill(vertices_of(kernel))
        return result

    def bind_plain(
        self,
        program: Program,
        step: Step,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        around: LoopIteration | None,
        usual: Mapping[str, tuple[float, ...]],
    ) -> None:
        """Set all that a plain shader's program reads; arguments as those of ``plain``."""
        kernel, unit = step.kernel, 0
        foreign = isinstance(kernel, ForeignShader)
        sizes: dict[str, tuple[int, int, int]] = {}  # [texels] of what each sampler reads
        for parameter in kernel.parameters:
            value = step.values[parameter.name]
            if parameter.widget.kind != "file":
                program.set(parameter.name, uniforms.get(f"{PRESSED}{parameter.name}", value))
            elif parameter.name in program.uniforms or foreign:
                texture = self.binder.file_texture(parameter, value, encoded=True)
                sizes[parameter.name] = (*texture.size, 1)
                unit = self.binder.texture(program, parameter.name, unit, texture, parameter.sampling)
        for declared in kernel.inputs:
            readable, sizes[declared.name] = self.binder.shaped(declared, inputs)
            if declared.name in program.uniforms:
                unit = self.binder.texture(program, declared.name, unit, readable, declared.sampling)
        origin = step.window.origin if step.window is not None else (0, 0)
        program.set(WINDOW, origin)
        program.set(PART, _shares(step.full_size, origin, step.size))
        for name, meaning in kernel.usual:
            kind = getattr(program.uniforms.get(name), "gl_type", 0)  # of another type it is the text's own
            if kind in _NUMBERS or (kind in _MATRICES and meaning.startswith("identity")):
                _set_fitting(program, name, usual.get(meaning) or _numbers(meaning, step, around, sizes))
        fed = {parameter.name for parameter in kernel.parameters if parameter.type == "sampler2D"}
        declared_inputs = {declared.name: declared for declared in kernel.inputs}
        fed |= declared_inputs.keys()
        for name, uniform in program.uniforms.items():
            kind = getattr(uniform, "gl_type", 0)
            if name in fed or kind not in _SAMPLERS:
                continue
            # A channel that nothing feeds. Two kinds of samplers may not share a unit, used or not.
            count = int(getattr(uniform, "array_length", 1))
            program.write(name, unit if count == 1 else [*range(unit, unit + count)])
            elements = [declared_inputs.get(f"{name}{ELEMENT}{number}") for number in range(count)]
            for element in elements if count > 1 else [None]:
                readable = self.binder.shaped_constant("black", _SHAPES.get(kind, ""))
                if element is not None:
                    readable, _ = self.binder.shaped(element, inputs)
                unit = self.binder.unit(unit, readable, element.sampling if element else Sampling())

    # ── iterations ───────────────────────────────────────────────────────────

    def _alternately(
        self,
        step: Step,
        kernel: TexelKernel,
        program: Program,
        driver: str,
        state: Mapping[str, moderngl.Texture],
        unit: int,
        start: Result | None,
        around: LoopIteration | None,
    ) -> Result:
        iteration = start.iterations if start else 0
        at_once = self.at_once(step)
        # Where there is something to begin with, texels off the lattice count as well.
        lattice = kernel.fills_lattice and driver == FRAGMENT and not state
        shift = 0
        watch = self.settling.watch(iteration, unit + len(kernel.outputs)) if kernel.until else None
        previous = self.binder.previous_units(program, kernel, unit)
        with Swap(self.pool, step.size, kernel.outputs, start) as swap, self.tuning.filling:
            while iteration < step.repeat:
                count = min(at_once, step.repeat - iteration)
                result, before = swap.target(), swap.before
                self.binder.previous(previous, state)
                program.count(kernel.repeat, iteration, step.total, around, count)
                if driver == FRAGMENT:
                    program.set("k_previous_shift", shift)
                    names = numbers_of(step, iterations=step.total) if lattice else {}
                    shift = shift_after(kernel, step.path, iteration, names) if lattice else 0
                    program.set("k_shift", shift)
                self.write(program, driver, result, shift)
                iteration += count
                if before is not None and watch and watch.has_settled(iteration, result, before):
                    result.settled = iteration
                swap.advance()
                state = result.textures
                if result.settled:
                    break
        utility_shader = swap.before
        assert utility_shader is not None
        if shift:  # each texel of the lattice goes to its place, with zeros between
            close, utility_shader = (
                utility_shader,
                self.run_utility_shader("spread.frag", utility_shader, k_shift=shift),
            )
            self.pool.give(close)
        utility_shader.iterations = step.repeat
        return utility_shader

    def bound_for(self, step: Step, driver: str, inputs: Mapping[str, Wired]) -> tuple[Program, Bound] | None:
        """Return the program of a step that has just run, and what it is bound for.

        To run it again, only textures and counts need be set. None where another step has taken the program
        since, where it reads image files or its own last iteration, or is drawn in two parts.
        """
        wires = wires_of(step, inputs)
        _, program, stage = self._known.get((id(step), driver, wires), (None, None, None))
        if program is None or stage is None or stage.first is not None:
            return None
        bound = program.bound
        if bound is None or bound.step is not step or bound.wires != wires:
            return None
        reads_itself = any(f"k_previous_{output.name}" in program.uniforms for output in step.kernel.outputs)
        return None if reads_itself else (program, bound)

    def write(self, program: Program, driver: str, result: Result, shift: int = 0) -> None:
        """Run a program over all texels of a result, or where they lie 2**shift apart.

        Fragments are drawn within the tuning's ``filling``.
        """
        width, height = result.size
        if driver == COMPUTE:
            self.images(result, read=False)
            program.run(-(-width // LOCAL), -(-height // LOCAL))
            return
        result.framebuffer(self.ctx).use()
        if shift:
            self.ctx.viewport = (0, 0, ((width - 1) >> shift) + 1, ((height - 1) >> shift) + 1)
        program.fill()
        if shift:
            self.ctx.viewport = (0, 0, width, height)

    def at_once(self, step: Step) -> int:
        """Return how many iterations of a kernel run at once."""
        kernel = step.kernel
        assert isinstance(kernel, TexelKernel)
        if kernel.at_once == "1":
            return 1
        try:
            return max(expressions.evaluate(kernel.at_once, numbers_of(step)), 1)
        except ExpressionError as error:
            raise kernel.error(f"pass '{step.path}': at_once {error}") from None

    def _in_place(
        self,
        step: Step,
        kernel: TexelKernel,
        program: Program,
        result: Result,
        around: LoopIteration | None,
    ) -> Result:
        result.rewrite(self.ctx)
        self.images(result, read=True)
        for iteration in range(result.iterations, step.repeat):
            program.count(kernel.repeat, iteration, step.total, around)
            names = numbers_of(step, iteration=iteration, iterations=step.total)
            try:
                cells = expressions.evaluate_pair(kernel.visits, names)
            except ExpressionError as error:
                self.pool.give(result)
                raise kernel.error(f"pass '{step.path}': visits {error}") from None
            if min(cells) >= 1:
                program.set("k_cells", cells)
                program.run(-(-cells[0] // LOCAL), -(-cells[1] // LOCAL))
        result.iterations = step.repeat
        return result

    def initial(self, step: Step, inputs: Mapping[str, Wired]) -> dict[str, moderngl.Texture]:
        """Return the state before the first iteration, by output; what is missing is zero."""
        textures: dict[str, moderngl.Texture] = {}
        for name, output in initial_names(step.kernel).items():
            texture = inputs.get(name, NOT_WIRED).texture
            if texture is None:
                continue
            if texture.size != step.size:
                raise step.spec.error(
                    f"pass '{step.path}': {name} is {texture.width} x {texture.height} texels, "
                    f"the pass {step.size[0]} x {step.size[1]}; they must agree"
                )
            textures[output] = texture
        return textures

    def _untouched(self, step: Step, state: Mapping[str, moderngl.Texture]) -> Result:
        """Return the state before the first iteration, in textures of its own."""
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

    def images(self, result: Result, *, read: bool) -> None:
        """Bind textures as the images that a compute shader writes."""
        for unit, output in enumerate(result.outputs):
            result.textures[output.name].bind_to_image(unit, read=read, write=True)


def vertices_of(kernel: Kernel) -> int:
    """Return how many vertices the triangles have that a shader is drawn with over the whole target."""
    return 6 if isinstance(kernel, ForeignShader) and kernel.vertex_source else 3


def usual_of(kernel: Kernel, values: Mapping[str, tuple[float, ...]]) -> dict[str, tuple[float, ...]]:
    """Return those of the usual uniforms that a plain shader's text names, by meaning."""
    return {meaning: values[meaning] for _, meaning in kernel.usual if meaning in values}


def _shares(whole: tuple[int, int], *pairs: tuple[int, int]) -> tuple[float, ...]:
    """Return pairs of numbers as shares of a whole pair."""
    return tuple(number / side for pair in pairs for number, side in zip(pair, whole, strict=True))


def _numbers(
    meaning: str, step: Step, around: LoopIteration | None, sizes: Mapping[str, tuple[int, int, int]]
) -> tuple[float, ...]:
    """Return what a uniform is given whose meaning depends on its own step: see ``reserved_names``."""
    if meaning.startswith(VALUE):
        return (float(meaning.removeprefix(VALUE)),)
    if meaning.startswith(DEPTH):
        halved = int(meaning.removeprefix(DEPTH))
        return (float(min(max(min(step.full_size).bit_length() + halved - 2, 0), _MAX_LEVELS)),)
    if meaning in ("iteration", "iterations"):
        number, whole = (around.number, around.total) if around is not None else (0, 1)
        return (float(number if meaning == "iteration" else whole),)
    return _size(meaning, sizes)


def _size(meaning: str, sizes: Mapping[str, tuple[int, int, int]]) -> tuple[float, ...]:
    """Return the sizes [texels] of the samplers that a meaning lists, three numbers each; 0 for none."""
    result = [sizes.get(name, (0, 0, 0)) for name in meaning.removeprefix(SIZES).split()]
    return tuple(float(number) for size in result for number in size)


def _set_fitting(program: Program, name: str, values: tuple[float, ...]) -> None:
    """Set as many components as the uniform has, in its own kind of number; an array's elements in turn.

    Of several elements, ``values`` has three numbers each, or one number for all of them.
    """
    uniform = program.uniforms[name]
    count, length = int(getattr(uniform, "dimension", 1)), int(getattr(uniform, "array_length", 1))
    whole = getattr(uniform, "gl_type", 0) in _WHOLE
    elements: list[Any] = []
    for index in range(length):
        own = values[3 * index : 3 * index + 3] if length > 1 and len(values) > 1 else values
        numbers = [int(v) if whole else float(v) for v in (*own, *(0.0,) * count)[:count]]
        elements.append(numbers[0] if count == 1 else tuple(numbers))
    program.write(name, elements[0] if length == 1 else elements)


_WHOLE = frozenset({0x1404, 0x1405, *range(0x8B53, 0x8B5A), *range(0x8DC6, 0x8DC9)})
"""GL_INT, GL_UNSIGNED_INT, GL_INT_VEC2 to 4, GL_BOOL, GL_BOOL_VEC2 to 4, GL_UNSIGNED_INT_VEC2 to 4."""

_NUMBERS = _WHOLE | {0x1406, *range(0x8B50, 0x8B53), 0x140A, *range(0x8FFC, 0x8FFF)}
"""Those, GL_FLOAT, GL_FLOAT_VEC2 to 4, GL_DOUBLE, GL_DOUBLE_VEC2 to 4."""
_MATRICES = (0x8B5B, 0x8B5C)
"""GL_FLOAT_MAT3 and 4."""

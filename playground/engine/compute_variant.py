"""Run compute variants: compute shaders that write their images and buffers themselves.

What one writes begins as zeros, except what its header says it overwrites. Buffers
are used again by the next run, for what needs as much or a little less: fresh memory of such a size costs
more than filling it. A buffer
with an output's name is that output, and is copied to its texture after the last iteration:
llvmpipe takes five times as long to store texels in an image one by one. One that works in place
begins as the input, too.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from math import isqrt
from typing import TYPE_CHECKING, Any, NamedTuple

from playground.engine.gl_calls import Calls
from playground.engine.kernels import Kernels, numbers_of
from playground.engine.plan import LoopIteration, Step
from playground.engine.programs import Program
from playground.engine.results import UNWIRED, Result, Wired
from playground.engine.tuning import Choices
from playground.shader import expressions
from playground.shader.expressions import ExpressionError, Number
from playground.shader.kernel import Buffer
from playground.shader.wrap import COMPUTE
from playground.sketch.model import ComputeVariant

if TYPE_CHECKING:
    import moderngl

_BYTES = {"vec2": 8, "ivec2": 8, "uvec2": 8, "vec4": 16, "ivec4": 16, "uvec4": 16}
_MAX_BUFFER = 2**31 - 1
_MAX_SPARE_RATIO = 1.25  # of the bytes needed: those that passes of one size ask for differ a little
RECENT = 32  # runs: those of one picture, of a sketch with many
_MAX_ALIGNMENT = 8  # bytes, of those that OpenGL fills rows up to
_UNPACK_ROW_LENGTH, _PACK_ROW_LENGTH = 0x0CF2, 0x0D02  # GL's, in texels; 0: the texture's own


class Spare(NamedTuple):
    """A buffer that is used again."""

    buffer: moderngl.Buffer
    run: int  # the last one that it was part of, of all runs


class ComputeVariants:
    """Runs compute variants on one context."""

    def __init__(self, ctx: moderngl.Context, kernels: Kernels) -> None:
        self.ctx = ctx
        self.kernels = kernels
        self.spare: list[Spare] = []  # newest last
        self._runs = 0

    def release(self) -> None:
        """Release every spare buffer."""
        for spare in self.spare:
            spare.buffer.release()
        self.spare.clear()

    def run(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        around: LoopIteration | None,
    ) -> Result:
        """Run a compute variant; the result is the caller's. The arguments are those of ``Kernels.run``."""
        kernel = _variant_of(step)
        storage, names = kernel.storage, numbers_of(step)
        buffers: list[moderngl.Buffer] = []
        whole = all([output.name in storage.overwrites for output in kernel.outputs])
        pool = self.kernels.pool
        result = pool.take(step.size, kernel.outputs) if whole else self.kernels.empty(step)

        def program_of(iteration: int, bound: Program | None, reading: Choices) -> Program:
            """Return the program of an iteration with all that it reads, unless it is ``bound``.

            Where choices are written into it, there is one for each stage: else what the others do would be
            computed as well, and discarded. One with ``reading`` buffers as textures is another.
            """
            stages = (("stage", kernel.stages[iteration]),) if kernel.stages else ()
            more = (*stages, *reading)
            program, stage = self.kernels.program(step, COMPUTE, inputs, around, more)
            if program is not bound:  # a program that was bound before may find other textures on its units
                self.kernels.binder.bind(program, step, uniforms, inputs, stage)
            for name, number in stages:
                program.set(name, number)
            return program

        try:
            repeat = expressions.evaluate(kernel.repeat, names)
            for unit, declared in enumerate(storage.buffers):
                buffers.append(self._buffer(step, declared, names))
                if declared.name == storage.in_place:
                    self._begin(step, inputs, result, declared, buffers[-1])
                buffers[-1].bind_to_storage_buffer(unit, size=self._size(declared, names))
            named = dict(zip([declared.name for declared in storage.buffers], buffers, strict=True))
            program: Program | None = None
            active = sum(self._size(b, names) for b in storage.buffers if b.name == storage.active)
            iteration, check = 0, 2
            with self.kernels.tuning.reading(kernel, named) as reading:
                self.kernels.images(result, read=True)
                while iteration < repeat:
                    groups = expressions.evaluate_pair(kernel.groups, {**names, "iteration": iteration})
                    if not kernel.stages or 0 not in groups:  # a 0: a step that this size does not need
                        program = program_of(iteration, program, reading)
                        program.count(kernel.repeat, iteration, repeat, around)
                        program.run(max(groups[0], 1), max(groups[1], 1))
                    iteration += 1
                    if storage.active and iteration == check:
                        check += 1 + isqrt(iteration)  # as in kernels.py: about √n steps too many
                        if not any(named[storage.active].read(active)):
                            iteration = max(iteration, repeat - 1)
            if program is None and repeat > 0:
                raise kernel.error(f"pass '{step.path}': groups of 0 leave out every step at this size")
            for output in kernel.outputs:
                if (held := storage.of_output(output.name)) is not None:
                    buffer = buffers[storage.buffers.index(held)]
                    self._copy(step, held, result.textures[output.name], buffer)
        except ExpressionError as error:
            pool.give(result)
            raise kernel.error(f"pass '{step.path}': {error}") from None
        except Exception:
            pool.give(result)
            raise
        finally:
            self._runs += 1
            self.spare += [Spare(buffer, self._runs) for buffer in buffers]
            self._trim()
        return result

    def _buffer(self, step: Step, declared: Buffer, names: dict[str, Number]) -> moderngl.Buffer:
        kernel = _variant_of(step)
        size = self._size(declared, names)
        if size > _MAX_BUFFER:
            message = f"buffer '{declared.name}' would be {size / 2**20:.0f} MiB; 2048 at most"
            raise kernel.error(f"pass '{step.path}': {message}")
        fitting = [spare for spare in self.spare if size <= spare.buffer.size <= size * _MAX_SPARE_RATIO]
        if fitting:
            taken = min(reversed(fitting), key=_bytes)
            self.spare.remove(taken)
            buffer = taken.buffer
        else:
            buffer = self.ctx.buffer(reserve=size)
        if declared.name not in kernel.storage.overwrites:
            buffer.clear()
        return buffer

    @staticmethod
    def _size(declared: Buffer, names: dict[str, Number]) -> int:
        """Return the bytes of a buffer."""
        return max(expressions.evaluate(declared.count, names), 1) * _BYTES.get(declared.type, 4)

    def _begin(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        result: Result,
        declared: Buffer,
        buffer: moderngl.Buffer,
    ) -> None:
        """Fill a buffer with the first input, if that has the step's size: its kernel looks at that first."""
        kernel = step.kernel
        source = inputs.get(kernel.inputs[0].name, UNWIRED).texture
        if source is None or source.size != step.size:
            return
        target = result.textures[kernel.outputs[0].name]
        if (source.dtype, source.components) != (target.dtype, target.components):
            self.kernels.copy_texture(target, source)  # which turns its numbers into the output's
            source = target
        with self._rows(step, declared, target, buffer, _PACK_ROW_LENGTH) as alignment:
            source.read_into(buffer, alignment=alignment)

    def _copy(self, step: Step, declared: Buffer, texture: moderngl.Texture, buffer: moderngl.Buffer) -> None:
        """Fill an output's texture with its buffer."""
        with self._rows(step, declared, texture, buffer, _UNPACK_ROW_LENGTH) as alignment:
            texture.write(buffer, alignment=alignment)

    @contextmanager
    def _rows(
        self, step: Step, declared: Buffer, texture: moderngl.Texture, buffer: moderngl.Buffer, length: int
    ) -> Iterator[int]:
        """Yield OpenGL's alignment of a buffer's rows, which are those of a texture, from the south.

        OpenGL fills rows up to 8 bytes at most; for more, it is told the ``length`` of a row.
        """
        aligned, texel = _variant_of(step).storage.aligned, texture.components * 4
        row = -(-texture.width * texel // aligned) * aligned
        needed = row * texture.height
        if texture.dtype != "f4" or buffer.size < needed:
            message = f"buffer '{declared.name}' holds {buffer.size} bytes; the output needs {needed}"
            raise step.kernel.error(f"pass '{step.path}': {message}, 32 bits a number")
        if aligned <= _MAX_ALIGNMENT:
            yield aligned
            return
        call, kinds = Calls(self.ctx), (ctypes.c_int, ctypes.c_int)
        call("glPixelStorei", kinds, length, row // texel)
        try:
            yield 4
        finally:
            call("glPixelStorei", kinds, length, 0)

    def _trim(self) -> None:
        """Release the oldest spare buffers over the bound in bytes.

        Those of the last run stay, and the largest of the others, as long as runs need it again and again.
        """
        older = [spare for spare in self.spare if spare.run < self._runs]
        recent = [spare for spare in older if spare.run > self._runs - RECENT]
        largest = max(recent, key=_bytes, default=None)
        held = sum([spare.buffer.size for spare in self.spare])
        for spare in older:
            if held <= self.kernels.pool.limit:
                return
            if spare is not largest:
                self.spare.remove(spare)
                held -= spare.buffer.size
                spare.buffer.release()


def _variant_of(step: Step) -> ComputeVariant:
    assert isinstance(step.kernel, ComputeVariant)
    return step.kernel


def _bytes(spare: Spare) -> int:
    return int(spare.buffer.size)

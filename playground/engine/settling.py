"""Find out whether a step of a repeat changed any texel, so that the steps after it need not be run.

Two steps are compared bit by bit, by a program whose fragments an occlusion query counts. After n steps the
next comparison is about √n steps away: so a repeat that settles after n steps runs O(√n) steps too many,
and compares O(√n) times. A graphics card is never waited for: the answer to a comparison is read at the next.
"""

from __future__ import annotations

from math import isqrt
from typing import TYPE_CHECKING, Any

from playground.engine.results import Pool, Result
from playground.shader.own_shaders import own_shader
from playground.sketch.model import Output, Sampling

if TYPE_CHECKING:
    import moderngl

    from playground.engine.binder import Binder
    from playground.engine.programs import Programs

_BLOCK = 4  # texels a side that one fragment compares
_TARGET = (Output("k_changed", "r8"),)


class Settling:
    """Compares the steps of repeats on one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: Programs, binder: Binder, pool: Pool, *, software: bool
    ) -> None:
        self.ctx = ctx
        self.programs = programs
        self.binder = binder
        self.pool = pool
        self.software = software
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
                for name, result, place in (("k_now", now, unit), ("k_before", before, unit + 1)):
                    self.binder.texture(program, name, place, result.textures[output.name], Sampling())
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
        return self._settling.software and not self._asked.samples

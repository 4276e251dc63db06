"""Run a kernel's costly rest only where it is needed, on a software renderer.

A software renderer goes both ways of every ``if``, so that a kernel which returns early at nearly all
texels costs as if it did at none. Where its text says ``if (skips_rest()) return …;`` between what
is cheap and what is not, it is drawn twice: first up to there, which marks the texels that are done
in a depth buffer, then whole, where the depth test lets it before the shader runs. Elsewhere
``skips_rest()`` is false, and the kernel runs once as it is written.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from playground.engine.plan import Step
from playground.engine.results import Result
from playground.engine.textures import make_framebuffer
from playground.shader.reserved_names import SKIPS
from playground.sketch.model import TexelKernel

if TYPE_CHECKING:
    import moderngl

_MOST = 2  # sizes whose depth buffers are held: of a picture and of its preview


class CostlyRest:
    """The depth buffers of one context that say where a kernel is done."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._depths: dict[tuple[int, int], moderngl.Renderbuffer] = {}

    def has(self, step: Step) -> bool:
        """Return whether a step's kernel says where its costly rest begins; one that repeats has none."""
        kernel = step.kernel
        return isinstance(kernel, TexelKernel) and kernel.runs_once and kernel.reads(SKIPS)

    @contextmanager
    def target(self, result: Result) -> Iterator[None]:
        """Draw to a result: what is drawn first is done, and later draws leave it."""
        ctx, size = self.ctx, result.size
        depth = self._depths.pop(size, None) or ctx.depth_renderbuffer(size)
        self._depths[size] = depth
        while len(self._depths) > _MOST:
            self._depths.pop(next(iter(self._depths))).release()
        textures = [result.textures[output.name] for output in result.outputs]
        target = make_framebuffer(ctx, textures, depth)
        target.use()
        target.clear(depth=1.0)
        ctx.enable(ctx.DEPTH_TEST)
        ctx.depth_func = "<"
        try:
            yield
        finally:
            ctx.disable(ctx.DEPTH_TEST)
            target.release()

    def release(self) -> None:
        """Release the buffers."""
        for depth in self._depths.values():
            depth.release()
        self._depths.clear()

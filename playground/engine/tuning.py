"""How a step runs on a renderer: as its text says, or with the same bits in a way that is quicker there.

An engine has one ``Tuning`` for its context and asks it once for each step that is about to run (``stage``).
The base class is that of a graphics card, which runs everything as it is written. What another kind of
renderer gains by is a subclass, which nothing else knows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from typing import TYPE_CHECKING, Any, NamedTuple

from playground.engine.plan import Step
from playground.engine.results import Result, Wired
from playground.shader.wrap import Wrapped
from playground.sketch.model import ComputeVariant, Kernel

if TYPE_CHECKING:
    import moderngl

Choices = tuple[tuple[str, int], ...]
"""What is written into a text, by name: checkboxes and menus with their values, and what a tuning adds."""


class FirstPart(NamedTuple):
    """A program that is drawn before that of the whole text, and sets some of the texels."""

    choices: Choices
    drawing: Callable[[Result], AbstractContextManager[None]]  # within it the whole text draws the others


class Stage(NamedTuple):
    """How one step runs."""

    choices: Choices = ()
    uniforms: Mapping[str, Any] = {}  # besides those of its text
    single_texels: frozenset[str] = frozenset()  # inputs whose sampler gives single texels, and 0 around them
    first: FirstPart | None = None


class Tuning:
    """What a graphics card gains by: nothing, and what it does quickly."""

    anisotropy = 8.0  # of textures with mipmaps, at most
    replaces_draws = False  # by variants that are quicker where a processor draws
    has_timers = True  # queries of the time that work takes, which are right
    mipmap_cost = 0.0  # [ms] of the first mipmaps of a texture in a process; 0: they are not cached on disk
    waits = False  # for each comparison of a repeat's steps, which is there sooner than another step
    filling: AbstractContextManager[None] = nullcontext()  # within it a program fills a whole framebuffer

    def stage(self, step: Step, inputs: Mapping[str, Wired], driver: str, *, in_loop: bool) -> Stage:
        """Return how a step runs whose inputs are wired so."""
        return _AS_WRITTEN

    @staticmethod
    def write(wrapped: Wrapped, choices: Choices, *, plainly: bool = False) -> Wrapped:
        """Return stages with what is chosen written into them.

        ``plainly``: without what replaces functions, so that a driver names what the author wrote.
        """
        return wrapped

    def reading(
        self, kernel: ComputeVariant, buffers: Mapping[str, moderngl.Buffer]
    ) -> AbstractContextManager[Choices]:
        """Bind, within the context, what a variant reads buffers by; yield what is chosen for that."""
        return nullcontext(())

    def texels_read(self, kernel: Kernel, inputs: Mapping[str, Wired]) -> list[float] | None:
        """Return all that a text reads of those inputs of which it reads single texels; None: not known."""
        return None

    def release(self) -> None:
        """Release what it has made."""


_AS_WRITTEN = Stage()

"""Hold the textures that one pass computed, and give those that are no longer used to the next pass.

A ``Result`` is the textures of one pass; the ``Pool`` keeps spare ones.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from playground.engine.plan import Step
from playground.engine.textures import (
    Shaped,
    bytes_of,
    make_framebuffer,
    make_texture,
    read_texture,
    release_framebuffer,
)
from playground.sketch.model import Kernel, Output

if TYPE_CHECKING:
    import moderngl
    from numpy.typing import NDArray


@dataclass(eq=False)
class Surface:
    """What a draw draws on: samples of colour and depth."""

    framebuffer: moderngl.Framebuffer
    colours: tuple[moderngl.Renderbuffer | moderngl.Texture, ...]  # of each output
    depth: moderngl.Renderbuffer
    size: tuple[int, int]
    formats: tuple[str, ...]  # of each output
    samples: int  # 1: without multisampling
    is_target: bool = False  # its colours are a result's textures, which release themselves

    @property
    def bytes(self) -> int:
        """Bytes held, without textures of a result."""
        width, height = self.size
        colours = 0 if self.is_target else sum([bytes_of(self.size, form) for form in self.formats])
        return (colours + 4 * width * height) * self.samples

    def release(self) -> None:
        """Release its framebuffer, depth and, unless they are a result's, colours."""
        release_framebuffer(self.framebuffer)
        for colour in () if self.is_target else self.colours:
            colour.release()
        self.depth.release()


@dataclass(eq=False)
class Result:
    """The textures that one pass computed."""

    size: tuple[int, int]
    outputs: tuple[Output, ...]
    textures: dict[str, moderngl.Texture]  # by output
    iterations: int = 0  # done, of a pass that repeats
    settled: int = 0  # the steps that ran, of one that was stopped since they changed nothing more
    number: int = 0  # of all that its pool has handed out: textures are used again, it is not
    surface: Surface | None = None  # a draw's samples and depth, where a later draw goes on from it
    target: Surface | None = None  # what draws of one sample a pixel draw on: its textures, and a depth
    mipmapped: set[str] = field(default_factory=set)  # outputs whose mipmaps are made
    with_levels: set[str] = field(default_factory=set)  # outputs that had mipmaps when they were others'
    shaped: dict[tuple[str, str], Shaped] = field(default_factory=dict)  # copies, by output and shape
    _arrays: dict[str, NDArray[np.float32]] = field(default_factory=dict)  # read back, by output
    _firsts: dict[str, tuple[float, ...]] = field(default_factory=dict)  # texels, likewise
    own_bytes: int = 0  # of its textures without mipmaps; 0: not counted yet
    _framebuffer: moderngl.Framebuffer | None = None

    @property
    def bytes(self) -> int:
        """Bytes held, mipmaps and samples included."""
        if not self.own_bytes:
            self.own_bytes = sum([bytes_of(self.size, output.format) for output in self.outputs])
        levels = self.mipmapped | self.with_levels
        if not levels and not self.shaped and self.surface is None and self.target is None:
            return self.own_bytes
        total = self.own_bytes
        total += sum([bytes_of(self.size, o.format) // 3 for o in self.outputs if o.name in levels])
        total += sum([copy.bytes for copy in self.shaped.values()])
        if self.surface is not None and self.surface is not self.target:
            total += self.surface.bytes
        if self.target is not None:
            total += self.target.bytes
        return total

    def array(self, output: str) -> NDArray[np.float32]:
        """Return the texels of an output as ``read_texture`` does, read back once."""
        array = self._arrays.get(output)
        if array is None:
            array = self._arrays[output] = read_texture(self.textures[output])
        return array

    def first_texel(self, ctx: moderngl.Context, output: str) -> tuple[float, ...]:
        """Return the components of an output's texel in the south-west corner, read back once."""
        if output not in self._firsts:
            index = [each.name for each in self.outputs].index(output)
            read = self.framebuffer(ctx).read(
                (0, 0, 1, 1), self.outputs[index].components, attachment=index, alignment=1, dtype="f4"
            )
            self._firsts[output] = tuple(np.frombuffer(read, np.float32).tolist())
        return self._firsts[output]

    def texel(self, output: str, x: int, y: int) -> tuple[float, ...]:
        """Return a texel as a shader fetches it, zeros outside: of floats, read back once."""
        if x >= self.size[0] or y >= self.size[1]:
            return (0.0, 0.0, 0.0, 0.0)
        components = np.atleast_1d(self.array(output)[y, x]).astype(float).tolist()
        return tuple([*components, *(0.0, 0.0, 0.0, 1.0)[len(components) :]])

    def framebuffer(self, ctx: moderngl.Context) -> moderngl.Framebuffer:
        """Return the framebuffer that draws to all of its textures."""
        if self._framebuffer is None:
            self._framebuffer = make_framebuffer(ctx, [self.textures[o.name] for o in self.outputs])
        return self._framebuffer

    def rewrite(self, ctx: moderngl.Context) -> None:
        """Forget what was made of its textures, which are about to be written again."""
        self._arrays.clear()
        self._firsts.clear()
        self.release_copies()
        for name in self.mipmapped:  # their levels are made again before anybody reads them
            self.textures[name].filter = ctx.LINEAR, ctx.LINEAR
        self.with_levels |= self.mipmapped
        self.mipmapped = set()

    def release_framebuffer(self) -> None:
        """Release what draws to its textures; it is made again where one is drawn to."""
        if self._framebuffer is not None:
            release_framebuffer(self._framebuffer)
            self._framebuffer = None

    def release_copies(self) -> None:
        """Release what was copied into other shapes."""
        for copy in self.shaped.values():
            copy.release()
        self.shaped.clear()

    def release(self) -> None:
        """Release its textures and what draws to them."""
        self.release_copies()
        self.release_framebuffer()
        self.release_surface()
        if self.target is not None:
            self.target.release()
            self.target = None
        for texture in self.textures.values():
            texture.release()

    def release_surface(self) -> None:
        """Release what a later draw would go on from; its target stays, to be drawn on again."""
        if self.surface is not None and self.surface is not self.target:
            self.surface.release()
        self.surface = None


class Swap:
    """Two sets of a pass's textures that change places: each iteration reads one and writes the other.

    ``before`` is the ``start``, if there is one, then the last iteration's, which is the caller's in the end;
    where an iteration fails everything goes back to the pool.
    """

    def __init__(
        self, pool: Pool, size: tuple[int, int], outputs: Sequence[Output], start: Result | None
    ) -> None:
        self.before = start
        self._pool = pool
        self._size = size
        self._outputs = outputs
        self._start = start
        self._spare: Result | None = None
        self._target: Result | None = None

    def __enter__(self) -> Swap:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        mine = [self._spare] if kind is None else [self._spare, self._target, self.before]
        for result in mine:
            if result is not None:
                self._pool.give(result)

    def target(self) -> Result:
        """Return what the next iteration writes."""
        self._target = self._spare or self._pool.take(self._size, self._outputs)
        self._spare = None
        return self._target

    def advance(self) -> None:
        """Make what was written what is read."""
        self._spare, self.before, self._target = self.before, self._target, None
        if self._spare is not None and (self._pool.clears or self._spare is self._start):
            self._pool.give(self._spare)  # what was read of a start, as mipmaps, would be its own still
            self._spare = None


class Wired(NamedTuple):
    """What an input reads: a texture, and the result that it is part of; nothing where nothing is wired."""

    result: Result | None = None
    texture: moderngl.Texture | None = None
    output: str = ""


UNWIRED = Wired()


def started(outputs: Sequence[Output], start: Wired) -> dict[str, moderngl.Texture]:
    """Return the textures that a draw's outputs begin with, by output, of what its ``initial`` reads.

    The first begins with what is wired, each other with the output of its name beside that, if there is one.
    """
    if start.texture is None or start.result is None:
        return {}
    textures = {o.name: start.result.textures[o.name] for o in outputs[1:] if o.name in start.result.textures}
    return {outputs[0].name: start.texture, **textures}


_Shape = tuple[tuple[int, int], tuple[str, ...]]


def _shape(size: tuple[int, int], outputs: Sequence[Output]) -> _Shape:
    """Return the size and the formats of textures: those of another result with the same may be used."""
    return size, tuple([output.format for output in outputs])


class Pool:
    """Spare results, to be used again: making a texture costs more than filling it.

    Before it makes one, it calls ``make_room`` with its bytes, for others to give what they can do without.
    """

    def __init__(self, ctx: moderngl.Context, limit: int) -> None:
        self.ctx = ctx
        self.limit = limit  # [bytes]
        self.make_room: Callable[[int], None] = lambda _: None
        self.made = 0  # how often a texture was made again
        # Whether texels begin as zeros: what does not write all of them shows nothing of what others drew.
        self.clears = False
        self._taken = 0
        self._spare: OrderedDict[int, Result] = OrderedDict()  # by identity, the oldest first
        self._alike: dict[_Shape, list[Result]] = {}  # the same, by what may take their place
        self._bytes = 0
        self._awaited = 0  # [bytes] over the limit, of a result that waits for one like it to be given

    @property
    def bytes(self) -> int:
        """Bytes held."""
        return self._bytes

    def __len__(self) -> int:
        return len(self._spare)

    def take(self, size: tuple[int, int], outputs: Sequence[Output]) -> Result:
        """Return a result with undefined texels, or zeros if this pool clears.

        Raises ``ContextError`` where the driver refuses its size.
        """
        result = self._take(size, outputs)
        if self.clears:
            framebuffer = result.framebuffer(self.ctx)
            framebuffer.use()  # clear() binds anew what was bound before, which may have been released by now
            framebuffer.clear()
        return result

    def _take(self, size: tuple[int, int], outputs: Sequence[Output]) -> Result:
        outputs = tuple(outputs)
        self._taken += 1
        if alike := self._alike.get(_shape(size, outputs)) or self._given(size, outputs):
            spare = alike.pop()
            del self._spare[id(spare)]
            self._bytes -= spare.bytes
            textures = dict(zip([o.name for o in outputs], spare.textures.values(), strict=True))
            result = Result(size, outputs, textures, number=self._taken, own_bytes=spare.own_bytes)
            result._framebuffer, result.target = spare._framebuffer, spare.target
            if spare.with_levels:
                pairs = zip(outputs, spare.outputs, strict=True)
                result.with_levels = {now.name for now, before in pairs if before.name in spare.with_levels}
            return result
        self.made += 1
        made: dict[str, moderngl.Texture] = {}
        try:
            for output in outputs:
                made[output.name] = make_texture(self.ctx, size, output.format)
        except Exception:
            for texture in made.values():
                texture.release()
            raise
        return Result(size, outputs, made, number=self._taken)

    def _given(self, size: tuple[int, int], outputs: Sequence[Output]) -> list[Result]:
        """Return the spare results of a shape of which there was none, once others have made room."""
        self._awaited = sum([bytes_of(size, output.format) for output in outputs])
        try:
            self.make_room(self._awaited)
        finally:
            self._awaited = 0
        alike = self._alike.get(_shape(size, outputs), [])
        if not alike:
            self._trim()
        return alike

    def give(self, result: Result) -> None:
        """Take a result that is no longer read; it may be released at once."""
        result.release_surface()
        result.rewrite(self.ctx)
        if result.bytes > self.limit + self._awaited:
            result.release()
            return
        self._spare[id(result)] = result
        self._alike.setdefault(_shape(result.size, result.outputs), []).append(result)
        self._bytes += result.bytes
        self._trim()

    def _trim(self) -> None:
        """Release the oldest until the bound holds."""
        while self._bytes > self.limit + self._awaited:
            _, oldest = self._spare.popitem(last=False)
            self._alike[_shape(oldest.size, oldest.outputs)].remove(oldest)
            self._bytes -= oldest.bytes
            oldest.release()

    def clear(self) -> None:
        """Release everything."""
        for result in self._spare.values():
            result.release()
        self._spare.clear()
        self._alike.clear()
        self._bytes = 0


OPEN, WIRED, MATCHING = range(3)
"""How an input is wired: by nothing, by a texture, by one of the step's size."""


def wires_of(step: Step, inputs: Mapping[str, Wired]) -> tuple[int, ...]:
    """Return how each input of a step is wired: by nothing, by a texture, by one of the step's size."""
    wires = []
    for declared in step.kernel.inputs:
        texture = inputs.get(declared.name, UNWIRED).texture
        wires.append(OPEN if texture is None else MATCHING if texture.size == step.size else WIRED)
    return tuple(wires)


def has_unwired(kernel: Kernel, inputs: Mapping[str, Wired]) -> bool:
    """Return whether nothing is wired to some input that may stay so."""
    return any([i.fallback and inputs.get(i.name, UNWIRED).texture is None for i in kernel.inputs])


@dataclass(eq=False)
class Cached:
    """The results of one pass, or of all passes of a loop after some iteration."""

    results: dict[str, Result]  # by the pass's path
    iterations: int = 0  # done, of a loop
    # Keys of the versions of its pass or loop, what was used last at the end.
    versions: OrderedDict[str, None] | None = None

    @property
    def result(self) -> Result:
        """The only result, of a pass."""
        return next(iter(self.results.values()))

    @property
    def bytes(self) -> int:
        """Bytes held."""
        return sum([result.bytes for result in self.results.values()])

    def release_to(self, pool: Pool) -> None:
        """Give the textures to a pool."""
        for result in self.results.values():
            pool.give(result)
        self.results = {}

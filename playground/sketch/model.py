"""What a sketch is made of: frozen values that can be hashed, compared and sent to a child process."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from playground.errors import ParameterError, ShaderError, SketchError, nearest
from playground.sketch.agreement import Bound
from playground.sketch.source import Line, SourceText

Value = float | int | bool | str | tuple[float, ...] | tuple[int, ...]
"""A parameter's value: a scalar, a tuple for a vector, or a path for a file."""

LARGEST_SIDE = 16_384
"""Texels or pixels that a side may have: what common graphics cards take."""

LARGEST_PICTURE = 65_536
"""Pixels that a side of a picture drawn in parts may have: so far, single precision tells pixels apart."""

DEFAULT_PICTURE = (1280, 720)
"""Size in pixels of a picture for which nobody asks another."""

DRIVERS = ("auto", "fragment", "compute")
"""What may run kernels; "auto" takes for each the one that it gains by."""

VARIANTS = ("compute", "passes")
"""The kinds of fast variants: a ``.comp`` needs compute shaders, a ``.fast.toml`` does not."""


@dataclass(frozen=True, slots=True)
class Widget:
    """How a parameter is shown and what it may be."""

    kind: str = "number"  # a row of sketch/widgets.py
    low: float | None = None  # None: unbounded
    high: float | None = None
    choices: tuple[str, ...] = ()  # of a menu


@dataclass(frozen=True, slots=True)
class Sampling:
    """How a texture is read."""

    filter: str = "nearest"  # nearest | linear
    wrap: str = "clamp"  # clamp | repeat
    mipmap: bool = False


@dataclass(frozen=True, slots=True)
class Follows:
    """An angle that takes a direction's azimuth while it has its default."""

    direction: str  # a parameter of the same file
    menu: str = ""  # likewise; "" where it always follows
    choice: int = 0  # of the menu, while it follows


@dataclass(frozen=True, slots=True)
class Parameter:
    """A uniform with its ``//!`` annotation."""

    name: str
    type: str  # GLSL: float int uint bool vec2..4 ivec2..4 uvec2..4, or sampler2D for a file
    default: Value
    widget: Widget = Widget()
    step: float | None = None
    unit: str = ""
    group: str = ""
    label: str = ""
    tooltip: str = ""
    sampling: Sampling = Sampling()  # of a file
    painted: bool = False  # a file that may be painted on in the window
    follows: Follows | None = None  # where its value comes from while nobody sets it
    parts: tuple[str, ...] = ()  # what a vector's components are, one name each; (): x, y, z, w
    file: str = ""
    line: int = 0

    @property
    def title(self) -> str:
        """What a panel writes beside it."""
        return self.label or self.name.replace("_", " ").capitalize()


@dataclass(frozen=True, slots=True)
class Input:
    """A texture that a kernel reads."""

    name: str
    sampling: Sampling = Sampling()
    fallback: str = ""  # "white" or "black": what it reads when nothing is wired; "": must be wired
    line: int = 0


@dataclass(frozen=True, slots=True)
class Output:
    """A texture that a kernel writes."""

    name: str
    format: str  # r8 r16 r16f r32f and their rg and rgba forms

    @property
    def components(self) -> int:
        """Channels of a texel."""
        return 4 if self.format.startswith("rgba") else 2 if self.format.startswith("rg") else 1

    @property
    def glsl(self) -> str:
        """The GLSL type of a texel."""
        return {1: "float", 2: "vec2", 4: "vec4"}[self.components]


@dataclass(frozen=True, slots=True)
class Buffer:
    """A storage buffer of a compute variant."""

    name: str
    type: str  # GLSL scalar or vec4
    count: str  # expression


@dataclass(frozen=True)
class Kernel:
    """One GLSL file that can be run: a kernel, a source, a draw, a compute variant or a plain shader."""

    name: str  # "generation/diamond_square"
    kind: str  # kernel | source | draw | compute | plain_fragment | plain_compute
    source: SourceText
    outputs: tuple[Output, ...]
    parameters: tuple[Parameter, ...] = ()
    inputs: tuple[Input, ...] = ()
    repeat: str = "1"
    accepts: str = ""
    visits: str = ""
    stride: str = ""  # after a turn, only texels at multiples of it are known
    between: str = ""  # how the texels of a stride are joined where a run is stopped: squares | triangles
    at_once: str = "1"  # turns that one run may take
    registry: str = ""  # of a source or a draw: the name of the source or mesh
    blend: str = "none"
    depth: str = "less"
    count: str = ""  # of a draw: elements of a mesh that has no size of its own
    samples: int = 0  # of a draw: samples a pixel; 0: the view's
    groups: str = ""  # of a compute variant
    local: tuple[int, int] = (8, 8)
    buffers: tuple[Buffer, ...] = ()
    aligned: int = 8  # bytes that rows of an output's buffer are filled up to
    stages: tuple[int, ...] = ()  # of a compute variant: what each of its turns does
    overwrites: tuple[str, ...] = ()  # of a compute variant: outputs and buffers that need not begin as zeros
    agrees: tuple[Bound, ...] = ()  # of a compute variant: how closely, with the technique beside it
    title: str = ""  # the sentence that the file begins with
    variants: tuple[Variant, ...] = ()  # the fast variants beside it, the fastest first

    @property
    def path(self) -> str:
        """Absolute path of the file."""
        return self.source.path

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the kernel is made of."""
        return tuple(dict.fromkeys((*self.source.files, *(f for v in self.variants for f in v.files))))

    @property
    def pragma(self) -> Line | None:
        """The line of its header; a plain shader has none."""
        return next((line for line in self.source.lines if line.pragma and not line.chain), None)

    def error(self, message: str) -> ShaderError:
        """Return an error that points at its header."""
        line = self.pragma
        return line.error(message) if line else ShaderError(message, file=self.path)

    def parameter(self, name: str) -> Parameter | None:
        """Return the parameter of that name, if there is one."""
        return next((p for p in self.parameters if p.name == name), None)

    def reads(self, given: str) -> bool:
        """Say whether the text names something that the engine gives."""
        return given in self.source.names

    @property
    def needs_inputs(self) -> tuple[str, ...]:
        """Inputs that must be wired."""
        return tuple(i.name for i in self.inputs if not i.fallback)


@dataclass(frozen=True, slots=True)
class Export:
    """A name that a technique of several passes shows outside, and what it stands for inside."""

    name: str
    targets: tuple[str, ...]  # paths inside; the first gives annotation and default
    line: int = 0


@dataclass(frozen=True)
class PassSpec:
    """A ``[[pass]]`` of a TOML file, with the technique that fills it."""

    name: str
    use: str
    technique: Technique
    inputs: tuple[tuple[str, str], ...] = ()  # input → "pass[.inner…][:output]"
    values: tuple[tuple[str, Value], ...] = ()  # parameter path inside the technique → value
    size: tuple[str, str] | None = None  # expressions; None: the size of what it stands in
    repeat: str = ""
    feedback: tuple[tuple[str, str], ...] = ()  # input → own output
    file: str = ""
    line: int = 0
    set_lines: tuple[tuple[str, int], ...] = ()  # parameter path of ``values`` → line of the file

    def error(self, message: str) -> SketchError:
        """Return an error that points at this pass."""
        return SketchError(message, file=self.file, line=self.line)


@dataclass(frozen=True)
class Graph:
    """A technique of several passes; a sketch is one too."""

    name: str
    path: str  # absolute path of its TOML
    passes: tuple[PassSpec, ...]
    parameters: tuple[Export, ...] = ()
    inputs: tuple[Export, ...] = ()
    outputs: tuple[tuple[str, str], ...] = ()  # name → "inner:output"; empty: the last pass's
    title: str = ""
    agrees: tuple[Bound, ...] = ()  # of a fast variant: how closely, with the technique beside it
    variants: tuple[Variant, ...] = ()  # the fast variants beside it, the fastest first
    line: int = 0  # of its outputs

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file the technique is made of."""
        found = dict.fromkeys([self.path])
        for spec in self.passes:
            found |= dict.fromkeys(spec.technique.files)
        for variant in self.variants:
            found |= dict.fromkeys(variant.files)
        return tuple(found)

    def find(self, name: str) -> PassSpec | None:
        """Return the pass of that name, if there is one."""
        return next((p for p in self.passes if p.name == name), None)


Technique = Kernel | Graph


@dataclass(frozen=True)
class Variant:
    """A fast variant: another form of a technique, that gives the same within a stated bound."""

    technique: Technique  # of a .comp its kernel, of a .fast.toml its passes
    verified: tuple[str, str] | None = None  # contents that were found to agree: canonical, its own
    record: str = ""  # absolute path of the user's file that says so; "" where there is none

    @property
    def kind(self) -> str:
        """One of ``VARIANTS``."""
        return "passes" if isinstance(self.technique, Graph) else "compute"

    @property
    def path(self) -> str:
        """Absolute path of its file."""
        return self.technique.path

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every file that it is made of."""
        return (*self.technique.files, *filter(None, [self.record]))


@dataclass(frozen=True, slots=True)
class Camera:
    """An eye that orbits a point of the land."""

    azimuth: float = 200.0  # [degrees] clockwise from north: where the eye stands, seen from the target
    elevation: float = 32.0  # [degrees] of the eye above the target's horizon, -89..89
    distance: float = 0.0  # [m] from the target; 0: as far as shows the whole land
    target: tuple[float, float, float] | None = None  # [m] of the land; None: its middle, at half its relief
    field_of_view: float = 35.0  # [degrees] vertical, 5..120


@dataclass(frozen=True)
class Shot:
    """A picture that a sketch promises."""

    name: str
    size: tuple[int, int] = (640, 360)  # pixels
    time: float = 0.0  # [s]
    camera: Camera | None = None  # None: the view's
    values: tuple[tuple[str, Value], ...] = ()  # parameter path → value
    preset: str = ""
    samples: int | None = None  # None: the view's
    steps: tuple[tuple[str, int], ...] = ()  # pass → turn to stop at
    marks: tuple[str, ...] = ()  # pytest's markers of its test, as "slow"
    line: int = 0


@dataclass(frozen=True, slots=True)
class Preset:
    """Values that go together."""

    name: str
    values: tuple[tuple[str, Value], ...]


@dataclass(frozen=True)
class Keyframe:
    """What the camera and some parameters are at a time, and how they go on from there."""

    time: float  # [s]
    camera: tuple[tuple[str, float | tuple[float, ...]], ...] = ()  # fields of ``Camera`` → value
    values: tuple[tuple[str, Value], ...] = ()  # parameter path → value
    ease: str = "smooth"  # smooth | linear | hold: to the next keyframe that says the same thing
    line: int = 0


@dataclass(frozen=True)
class Sketch:
    """A whole sketch: what a user opens, shares and keeps under version control."""

    name: str
    file: str  # absolute path of the TOML, or of the kernel opened alone
    folder: str  # absolute path; its own files stay inside
    graph: Graph  # the passes; the view is the last of them, named "view"
    title: str = ""
    size: tuple[int, int] | None = None  # texels, x and y; None: from the land's file
    extent: tuple[float, float] | None = None  # [m]
    relief: float | None = None  # [m]
    base_elevation: float | None = None  # [m] above sea level at height 0
    camera: Camera = Camera()
    samples: int = 4  # antialiasing of draws
    shots: tuple[Shot, ...] = ()
    presets: tuple[Preset, ...] = ()
    overrides: tuple[tuple[str, Value], ...] = ()  # parameter path → value, over what the file sets
    keyframes: tuple[Keyframe, ...] = ()  # by time; what is set by hand stands over them
    plain: bool = False  # every technique in its canonical form: no fast variant runs
    main: tuple[str, ...] = ()  # paths of the parameters that it is about: a panel shows them first

    @property
    def files(self) -> tuple[str, ...]:
        """Absolute paths of every text file the sketch is made of."""
        return tuple(dict.fromkeys([self.file, *self.graph.files]))

    def shot(self, name: str) -> Shot:
        """Return the shot of that name; raise ``SketchError`` if there is none."""
        for shot in self.shots:
            if shot.name == name:
                return shot
        raise SketchError(
            f"no shot '{name}' in sketch {self.name}{nearest(name, [s.name for s in self.shots])}"
        )

    def with_values(self, values: Mapping[str, object]) -> Sketch:
        """Return the sketch with parameters set, by path; text is read as on the command line.

        ``size``, ``extent``, ``relief`` and ``base_elevation`` may be set as well.
        Raises ``ParameterError`` naming the nearest path or the range.
        """
        from playground.sketch.assign import assign  # it needs this module

        return assign(self, values)

    def with_camera(self, camera: Camera) -> Sketch:
        """Return the sketch seen by another camera, whatever its keyframes say of theirs."""
        keyframes = tuple(replace(keyframe, camera=()) for keyframe in self.keyframes)
        return replace(self, camera=camera, keyframes=keyframes)

    def plainly(self, plain: bool = True) -> Sketch:
        """Return the sketch with every technique in its canonical form, or with fast variants again."""
        return replace(self, plain=plain)

    def at(self, time: float) -> Sketch:
        """Return the sketch as its keyframes make it at a time in seconds, and without them."""
        from playground.sketch.keyframes import at  # it needs this module

        return at(self, time)

    def with_preset(self, name: str) -> Sketch:
        """Return the sketch with a preset's values; raise ``ParameterError`` if there is no such preset."""
        for preset in self.presets:
            if preset.name == name:
                return self.with_values(dict(preset.values))
        raise ParameterError(f"no preset '{name}'{nearest(name, [p.name for p in self.presets])}")

    def for_shot(self, shot: Shot) -> Sketch:
        """Return the sketch as a shot shows it."""
        sketch = self.with_preset(shot.preset) if shot.preset else self
        sketch = sketch.with_values(dict(shot.values))
        if shot.camera is not None:
            sketch = sketch.with_camera(shot.camera)
        if shot.samples is not None:
            sketch = replace(sketch, samples=shot.samples)
        return sketch


def kernels_of(technique: Technique, prefix: str = "") -> Iterator[tuple[str, Kernel]]:
    """Yield (path, kernel) of every kernel a technique is made of, in the order of the files."""
    if isinstance(technique, Kernel):
        yield prefix, technique
        return
    for spec in technique.passes:
        yield from kernels_of(spec.technique, f"{prefix}.{spec.name}" if prefix else spec.name)

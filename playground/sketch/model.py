"""A sketch as a value: graph, terrain, view, shots, presets, keyframes, and the tolerances of shots.

All of it is frozen: what changes a sketch returns a new one. The classes of kernels, graphs and parameters
are in ``shader.kernel`` and ``shader.parameter``, keyframes in ``keyframes``; most can be imported from
here as well.

Tiers of tolerance have names:

    rounding   3 levels of 255, at 0.5 % of the pixels: what another build of a renderer may differ by
    edges      any number of levels, at 0.5 % of the pixels: single pixels that fall the other way
    noise      8 levels at any pixel: grain and dithering that are different in each run

How they are applied, and what no tolerance lets pass, is up to the room ``verify``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from playground.errors import Diagnostic, ParameterError, SketchError, nearest
from playground.shader.kernel import VARIANTS as VARIANTS
from playground.shader.kernel import ComputeVariant as ComputeVariant
from playground.shader.kernel import CpuSource as CpuSource
from playground.shader.kernel import Draw as Draw
from playground.shader.kernel import ForeignShader as ForeignShader
from playground.shader.kernel import Graph as Graph
from playground.shader.kernel import Input as Input
from playground.shader.kernel import Kernel as Kernel
from playground.shader.kernel import Output as Output
from playground.shader.kernel import PassSpec as PassSpec
from playground.shader.kernel import PlainCompute as PlainCompute
from playground.shader.kernel import PlainFragment as PlainFragment
from playground.shader.kernel import PlainShader as PlainShader
from playground.shader.kernel import Technique as Technique
from playground.shader.kernel import TexelKernel as TexelKernel
from playground.shader.kernel import kernels_of as kernels_of
from playground.shader.parameter import MAX_SIDE as MAX_SIDE
from playground.shader.parameter import Parameter as Parameter
from playground.shader.widgets import Value as Value
from playground.sketch.assign import TERRAIN_KEYS, check_value
from playground.sketch.keyframes import Keyframe as Keyframe
from playground.sketch.keyframes import at
from playground.sketch.wiring import as_wired

Given = str | int | Mapping[str, object]


@dataclass(frozen=True, slots=True)
class Tolerance:
    """What may differ from a reference."""

    levels: int = 3  # [of 255] that any channel of any pixel may differ by
    share: float = 0.005  # of the pixels that may differ by more than one level
    name: str = ""  # of the tier; "": its numbers were given
    reason: str = ""  # why it is needed, for whoever reads the report

    def __str__(self) -> str:
        named = f"{self.name}, " if self.name else ""
        return f"{named}{self.levels} of 255 at {100 * self.share:g} % of the pixels ({self.reason})"


TIERS = {
    "rounding": Tolerance(3, 0.005, "rounding"),
    "edges": Tolerance(255, 0.005, "edges"),
    "noise": Tolerance(8, 1.0, "noise"),
}
"""The tolerances that have names."""


_DEFAULT = TIERS["rounding"]


def tolerance_of(declared: Given | None, reason: str) -> Tolerance | None:
    """Return a tolerance from a tier's name, levels, or a table of levels and share; None for none.

    Raises ``ValueError`` with a message for another value, and without a reason.
    """
    if declared is None:
        if reason:
            raise ValueError("reason: there is no tolerance that it is a reason for")
        return None
    tolerance = _allowed(declared)
    if not reason.strip():
        raise ValueError('tolerance: it needs a reason, as reason = "the grain is different in each run"')
    return replace(tolerance, reason=reason.strip())


def _allowed(declared: Given) -> Tolerance:
    if isinstance(declared, str):
        if declared not in TIERS:
            raise ValueError(f"tolerance = {declared!r}: expected {_CHOICES}{nearest(declared, TIERS)}")
        return TIERS[declared]
    table = declared if isinstance(declared, Mapping) else {"levels": declared}
    unknown = [key for key in table if key not in ("levels", "share")]
    if unknown or not table:
        raise ValueError(f"tolerance = {declared!r}: expected {_CHOICES}")
    levels, share = table.get("levels", _DEFAULT.levels), table.get("share", _DEFAULT.share)
    if type(levels) is not int or not 2 <= levels <= 255:
        raise ValueError(f"tolerance: levels = {levels!r}: expected a whole number from 2 to 255")
    if type(share) not in (int, float) or not 0.0 < share <= 1.0:  # type: ignore[operator]
        raise ValueError(f"tolerance: share = {share!r}: expected a fraction of the pixels, above 0 and to 1")
    return Tolerance(levels, float(share))  # type: ignore[arg-type]


_CHOICES = f"{', '.join(TIERS)}, a number of levels of 255, or {{ levels = 6, share = 0.01 }}"

MAX_PICTURE_SIDE = 65_536
"""Pixels that a side of a picture drawn in parts may have: the limit of single precision."""

DEFAULT_PICTURE = (1280, 720)
"""Size in pixels of a picture unless another is given."""

FPS = 30
"""Pictures a second of a film unless another rate is given."""

MAX_SUPERSAMPLE = 8
"""Times that a picture may be drawn as wide and as high as it is wanted."""


@dataclass(frozen=True, slots=True)
class Camera:
    """An eye that orbits a point of the terrain; a frozen value.

    For example:

        camera = playground.Camera(azimuth=120.0, elevation=45.0)
        sketch = playground.load("l_dot_n").with_camera(camera)
    """

    azimuth: float = 200.0  # [degrees] clockwise from north: the eye, seen from the target
    elevation: float = 32.0  # [degrees] of the eye above the target's horizon, -89..89
    distance: float = 0.0  # [m] from the target; 0: as far as shows the whole terrain
    target: tuple[float, float, float] | None = None  # [m]; None: the terrain's middle, at half its relief
    field_of_view: float = 35.0  # [degrees] vertical, 5..120


@dataclass(frozen=True)
class Shot:
    """A picture that a sketch promises: what its ``[[shot]]`` says.

    For example:

        sketch = playground.load("l_dot_n")
        for shot in sketch.shots:
            print(shot.name, shot.size, shot.time)
    """

    name: str
    size: tuple[int, int] = (640, 360)  # pixels
    time: float = 0.0  # [s]
    camera: Camera | None = None  # None: the view's
    values: tuple[tuple[str, Value], ...] = ()  # parameter path → value
    preset: str = ""
    samples: int | None = None  # None: the view's
    supersample: int | None = None  # likewise
    steps: tuple[tuple[str, int], ...] = ()  # pass → step to stop at
    marks: tuple[str, ...] = ()  # pytest's markers of its test, as "slow"
    allow_blank: bool = False  # whether a picture of one colour may be right
    tolerance: Tolerance | None = None  # None: the usual one
    mask: tuple[tuple[int, int, int, int] | str, ...] = ()  # rectangles [pixels], images, textures
    line: int = 0


@dataclass(frozen=True, slots=True)
class TerrainSettings:
    """What a sketch says of its terrain; None: what the terrain's file says."""

    size: tuple[int, int] | None = None  # texels, x and y
    extent: tuple[float, float] | None = None  # [m]
    relief: float | None = None  # [m]
    base_elevation: float | None = None  # [m] above sea level at height 0


@dataclass(frozen=True, slots=True)
class PictureSettings:
    """How a sketch's picture is drawn."""

    samples: int = 4  # antialiasing of draws
    supersample: int = 1  # times as wide and high as a finished picture is drawn; not live
    above_ground: bool = True  # an eye under the terrain is raised over it


@dataclass(frozen=True, slots=True)
class Preset:
    """Values that go together."""

    name: str
    values: tuple[tuple[str, Value], ...]
    left_out: tuple[str, ...] = ()  # a message for each value that no parameter takes


@dataclass(frozen=True)
class Sketch:
    """A whole sketch: what a user opens, shares and puts under version control.

    ``playground.load`` gives one. It is a frozen value that can be hashed, compared and pickled: what
    changes it gives another sketch.

        sketch = playground.load("l_dot_n")
        assert sketch.with_values({"relief": 500.0}) != sketch
    """

    name: str
    file: str  # absolute path of the TOML, or of the kernel opened alone
    folder: str  # absolute path; its own files stay inside
    graph: Graph  # the passes that are there; the view is the last of them, named "view"
    title: str = ""
    terrain: TerrainSettings = TerrainSettings()
    camera: Camera = Camera()
    picture: PictureSettings = PictureSettings()
    shots: tuple[Shot, ...] = ()
    presets: tuple[Preset, ...] = ()
    overrides: tuple[tuple[str, Value], ...] = ()  # parameter path → value, over what the file sets
    keyframes: tuple[Keyframe, ...] = ()  # by time; user edits override them
    plain: bool = False  # every technique in its canonical form: no fast variant runs
    main: tuple[str, ...] = ()  # paths of the parameters that it is about: a panel shows them first
    warnings: tuple[Diagnostic, ...] = field(default=(), compare=False)  # of its file

    def __post_init__(self) -> None:
        """Leave out the passes whose condition does not hold for what is wired."""
        object.__setattr__(self, "graph", as_wired(self.graph))

    @property
    def files(self) -> tuple[str, ...]:
        """Return the absolute paths of every text file the sketch is made of.

        For example:

            print(playground.load("l_dot_n").files)
        """
        return tuple(dict.fromkeys([self.file, *self.graph.files]))

    def shot(self, name: str) -> Shot:
        """Return the shot of that name; raise ``SketchError`` if there is none.

        For example:

            sketch = playground.load("l_dot_n")
            assert sketch.shot(sketch.shots[0].name) == sketch.shots[0]
        """
        for shot in self.shots:
            if shot.name == name:
                return shot
        raise SketchError(
            f"no shot '{name}' in sketch {self.name}{nearest(name, [s.name for s in self.shots])}"
        )

    def with_values(self, values: Mapping[str, object]) -> Sketch:
        """Return the sketch with ``values`` of parameters set, by path; text is read as on the command line.

        ``size``, ``extent``, ``relief`` and ``base_elevation`` may be set as well.

        Where a parameter takes a file, an array does as well: NumPy's, xarray's, and what has
        ``__array__``. It is copied, into a read-only file that goes with the last sketch that has it. A
        grid is (ny, nx), row 0 in the south, as ``Engine.read`` gives it; NaN is no data. Of an
        xarray.DataArray, the coordinates say which way its rows go and how far apart they are, in
        metres, kilometres or degrees, and rioxarray's ``rio.crs`` where it lies. A picture is (ny, nx),
        (ny, nx, 3) or (ny, nx, 4), top row first: uint8, uint16, or floats 0 to 1, sRGB.

            import numpy

            hills = numpy.hypot(*numpy.mgrid[-1:1:33j, -1:1:33j])
            sketch = playground.load("jacksboro").with_values({"height.elevation": hills, "relief": 300.0})

        Raises ``ParameterError`` naming the nearest path or the range.
        """
        overrides, changes = dict(self.overrides), dict[str, Any]()
        for path, raw in values.items():
            value = check_value(self, path, raw)
            if path in TERRAIN_KEYS:
                changes[path] = value
            else:
                overrides.pop(path, None)  # what is set last comes last, and wins
                overrides[path] = value
        terrain = replace(self.terrain, **changes) if changes else self.terrain
        return replace(self, overrides=tuple(overrides.items()), terrain=terrain)

    def with_inputs(self, arrays: Mapping[str, object]) -> Sketch:
        """Return the sketch with ``arrays`` as the textures of inputs, by ``pass.input``.

        Each is (ny, nx) or (ny, nx, 1 to 4) of finite numbers, row 0 in the south, as ``Engine.read``
        gives them, of any size; it is copied, as by ``with_values``, and takes the place of what the input
        was wired to. A sketch's file cannot say it, so that such a sketch is not saved or packed.

            import numpy

            flat = numpy.full((65, 65), 0.5)
            sketch = playground.load("diamond_square").with_inputs({"view.height": flat})

        Raises ``ParameterError`` naming the nearest input, or what is wrong with an array.
        """
        from playground.sketch.array_inputs import wired  # loads NumPy, which few loads need

        graph, files = self.graph, dict(self.overrides)
        for path, array in arrays.items():
            graph, parameter, file = wired(graph, path, array)
            files[parameter] = file
        return replace(self, graph=graph, overrides=tuple(files.items()))

    def with_camera(self, camera: Camera) -> Sketch:
        """Return the sketch seen by another camera, without the camera of its keyframes.

        For example:

            sketch = playground.load("l_dot_n").with_camera(playground.Camera(elevation=60.0))
        """
        keyframes = tuple(replace(keyframe, camera=()) for keyframe in self.keyframes)
        return replace(self, camera=camera, keyframes=keyframes)

    def with_picture(self, **changes: Any) -> Sketch:
        """Return the sketch with ``changes`` in its ``PictureSettings``.

        For example:

            sketch = playground.load("l_dot_n").with_picture(samples=1)
        """
        return replace(self, picture=replace(self.picture, **changes))

    def plainly(self, plain: bool = True) -> Sketch:
        """Return the sketch with every technique in its ``plain``, canonical form, or with fast variants.

        For example:

            assert playground.load("l_dot_n").plainly().plain
        """
        return replace(self, plain=plain)

    def at(self, time: float) -> Sketch:
        """Return the sketch as its keyframes make it at a time in seconds, and without them.

        What the user, a preset or a shot has set stays as it was set.

            sketch = playground.load("l_dot_n").at(2.0)
        """
        if not self.keyframes:
            return self
        changes, values = at(self.keyframes, self.graph, time)
        camera = replace(self.camera, **changes) if changes else self.camera
        return replace(self, camera=camera, overrides=(*values, *self.overrides), keyframes=())

    @property
    def duration(self) -> float:
        """Return the time in seconds of the last keyframe; 0 where there is none.

        For example:

            assert playground.load("l_dot_n").duration == 0.0
        """
        return self.keyframes[-1].time if self.keyframes else 0.0

    def with_preset(self, name: str) -> Sketch:
        """Return the sketch with a preset's values; raise ``ParameterError`` if there is no such preset.

        For example:

            sketch = playground.load("l_dot_n")
            for preset in sketch.presets:
                print(sketch.with_preset(preset.name).overrides)
        """
        for preset in self.presets:
            if preset.name == name:
                return self.with_values(dict(preset.values))
        raise ParameterError(f"no preset '{name}'{nearest(name, [p.name for p in self.presets])}")

    def for_shot(self, shot: Shot) -> Sketch:
        """Return the sketch as a shot shows it.

        For example:

            sketch = playground.load("l_dot_n")
            shown = sketch.for_shot(sketch.shots[0])
        """
        sketch = self.with_preset(shot.preset) if shot.preset else self
        sketch = sketch.with_values(dict(shot.values))
        if shot.camera is not None:
            sketch = sketch.with_camera(shot.camera)
        asked = {"samples": shot.samples, "supersample": shot.supersample}
        changes = {name: number for name, number in asked.items() if number is not None}
        return sketch.with_picture(**changes) if changes else sketch

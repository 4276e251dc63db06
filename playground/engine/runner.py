"""Run one step of any kind on a context, and know what the engine gives it.

Programs, meshes and file textures stay here; results are the caller's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING, Any

import numpy as np

from playground.data.live_inputs import LiveInputs, Now
from playground.data.media import bands_at
from playground.engine.camera import unit_vector
from playground.engine.compute_variant import ComputeVariants
from playground.engine.context import ContextInfo
from playground.engine.draws import Draws
from playground.engine.exaggeration import Exaggeration
from playground.engine.kernels import Kernels, usual_of
from playground.engine.painted_images import Painted, PaintedFiles, PaintedTextures, channels_of
from playground.engine.plan import LoopIteration, Plan, Step, error_at
from playground.engine.results import Pool, Result, Wired
from playground.engine.source_kinds import Material, SourceKind
from playground.engine.sources import source_kind
from playground.engine.textures import read_texture, split_format, write_texture
from playground.engine.tuning import Tuning
from playground.engine.unfinished import Arrays, SourceWorks, Task
from playground.errors import ContextError, DataError
from playground.shader.expressions import FRAME_RATE, last_frame_at
from playground.shader.reserved_names import MOMENT, NEUTRAL, OF_THE_TERRAIN, PRESSED
from playground.shader.wrap import COMPUTE, FRAGMENT
from playground.sketch.model import (
    ComputeVariant,
    CpuSource,
    Draw,
    Kernel,
    PlainCompute,
    PlainShader,
    TexelKernel,
)

if TYPE_CHECKING:
    import moderngl

_NOTHING = nullcontext()


class Runner:
    """Runs steps on one context."""

    def __init__(
        self,
        ctx: moderngl.Context,
        info: ContextInfo,
        driver: str,
        pool: Pool,
        painted: PaintedFiles,
        tuning: Tuning,
    ) -> None:
        self.ctx = ctx
        self.info = info
        self.driver = driver  # see ``Engine``
        self.computes = info.compute  # whether there are compute shaders
        self.pool = pool
        self.tuning = tuning
        # Uniforms of plain shaders; what has a window and a clock sets them before each frame.
        self.mouse = (0.0, 0.0, 0.0, 0.0)  # pixels from the lower left, then where it was pressed
        self.hover = (0.0, 0.0)  # pixels from the lower left, pressed or not
        self.drag = (0.0, 0.0, 0.0, 0.0)  # as ShaderToy's iMouse
        self.pressed: frozenset[str] = frozenset()  # paths of the buttons that are pressed in this frame
        self.exaggeration: Exaggeration | None = None  # of what a window shows
        self.inputs = LiveInputs()
        self.delta = 1 / 60  # [s] since the last one
        self.date = (1970.0, 0.0, 1.0, 0.0)  # year, month from 0, day, seconds
        self.kernels = Kernels(ctx, pool, tuning)
        self.programs, self.binder = self.kernels.programs, self.kernels.binder
        self.compute_variants = ComputeVariants(ctx, self.kernels)
        self.draws = Draws(ctx, self.kernels)
        self.painted = painted
        self.paint = PaintedTextures(ctx)
        self.works = SourceWorks()
        self.before_step: Callable[[Step], None] | None = None  # called before each step runs
        self._of_draws = ctx.BLEND | ctx.DEPTH_TEST | ctx.CULL_FACE
        self._plan: Plan | None = None
        self._given: dict[str, Any] = {}
        # What a step was given since, and with which buttons pressed, by its identity.
        self._known_given: dict[int, tuple[Step, frozenset[str], dict[str, Any]]] = {}

    @property
    def compile_times(self) -> dict[str, float]:
        """Milliseconds of each program compiled, by file."""
        return self.programs.compile_times

    def set_frame(self, plan: Plan) -> None:
        """Take terrain, time and camera from a plan."""
        self._plan = plan
        eye = plan.eye
        self._known_given.clear()
        self._given = {
            "time": plan.time,
            "extent": plan.terrain.extent,
            "relief": plan.terrain.relief,
            "base_elevation": plan.terrain.base_elevation,
            "clip_from_world": tuple(eye.clip_from_world.T.ravel().tolist()),
            "world_from_clip": tuple(eye.world_from_clip.T.ravel().tolist()),
            "eye": eye.position,
        }

    def release(self) -> None:
        """Release every program, mesh and texture."""
        self.works.keep(lambda _: "")
        self.paint.release()
        self.draws.release()
        self.compute_variants.release()
        self.kernels.release()

    def given_for(self, step: Step, frame: int | None = None) -> dict[str, Any]:
        """Return what the engine gives besides the parameters and the iteration, where the text names it.

        ``frame`` is that of the loop around it that counts frames: the time is that frame's.
        """
        kernel = step.kernel
        if isinstance(kernel, CpuSource):
            return self._moment(step, frame) | self._of_the_terrain(step)
        uniforms: dict[str, Any] = {}
        if self.pressed:
            names = (p.name for p in kernel.parameters if p.widget.kind == "button")
            uniforms |= {f"{PRESSED}{name}": True for name in names if f"{step.path}.{name}" in self.pressed}
        if isinstance(kernel, PlainShader):
            return uniforms | dict(usual_of(kernel, self.frame_uniforms(step, frame)))
        for name in kernel.engine_uniforms:
            if name == "spacing":
                uniforms[name] = self._spacing(step)
            elif name == "time" and frame is not None:
                uniforms[name] = frame / FRAME_RATE
            elif name in self._given:
                uniforms[name] = self._given[name]
        if self.exaggeration is not None:
            replaced = self.exaggeration.given(kernel, step.values, self._given)
            uniforms |= {name: value for name, value in replaced.items() if name in uniforms}
        return uniforms

    def _spacing(self, step: Step) -> tuple[float, float]:
        (width, height), (wide, tall) = self._given["extent"], step.full_size
        return width / max(wide - 1, 1), height / max(tall - 1, 1)

    def _of_the_terrain(self, step: Step) -> dict[str, Any]:
        """Return what a source reads of the terrain."""
        values = {"spacing": self._spacing(step), "relief": self._given["relief"]}
        return {name: values[name] for name in step.kernel.depends if name in OF_THE_TERRAIN}

    def given_for_key(self, step: Step) -> dict[str, Any]:
        """Return all that the engine gives a step and that its textures depend on."""
        uniforms = self.given_for(step)
        if not isinstance(step.kernel, Draw):
            return uniforms
        return {**uniforms, "samples": self._samples_for(step.kernel)}

    def _samples_for(self, kernel: Kernel) -> int:
        """Return how many samples a pixel of a draw has here."""
        assert self._plan is not None, "set_frame() comes first"
        own = kernel.samples if isinstance(kernel, Draw) else 0
        return max(min(own or self._plan.sketch.picture.samples, self.info.max_samples), 1)

    def driver_for(self, step: Step) -> str:
        """Return by which driver the kernel of a step runs."""
        kernel = step.kernel
        if isinstance(kernel, ComputeVariant | PlainCompute):
            if not self.computes:
                message = f"'{kernel.name}' is a compute shader; this context is {self.info.opengl}"
                raise ContextError(f"{message}, and compute needs 4.3")
            return COMPUTE
        if not isinstance(kernel, TexelKernel) or not self.computes or self.driver == FRAGMENT:
            return FRAGMENT
        return COMPUTE if self.driver == COMPUTE or kernel.visits else FRAGMENT

    def run(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        *,
        driver: str = "",
        around: LoopIteration | None = None,
        start: Result | None = None,
        keeps_surface: bool = False,
        key: str = "",
    ) -> Result:
        """Run a step and return its textures, which are the caller's.

        ``driver`` runs its kernel, by default that of ``driver_for``; ``around`` is where it is in the loops
        around it; ``start`` the same step after fewer iterations, which is used up; ``keeps_surface`` says
        that a later draw goes on from this one; ``key`` is what its textures depend on, "" in a loop.
        """
        assert self._plan is not None, "set_frame() comes first"
        driver = driver or self.driver_for(step)
        if self.before_step is not None:
            self.before_step(step)
        self.disable_draw_state()
        kernel = step.kernel
        if isinstance(kernel, TexelKernel):
            uniforms = self._given_now(step, around)
            with self._placed(step) if kernel.file_parameters else _NOTHING:
                return self.kernels.run(step, driver, inputs, uniforms, around, start)
        frame = around.frame if around is not None else None
        uniforms = self.given_for(step, frame)
        with self._placed(step):
            match kernel:
                case Draw():
                    samples = self._samples_for(kernel)
                    return self.draws.run(
                        step, inputs, uniforms, around, samples, keeps_surface=keeps_surface
                    )
                case ComputeVariant():
                    return self.compute_variants.run(step, inputs, uniforms, around)
                case CpuSource():
                    return self._source(step, inputs, uniforms, key)
            return self.kernels.plain(step, inputs, uniforms, around, self.frame_uniforms(step, frame))

    def disable_draw_state(self) -> None:
        """Disable what only draws have enabled: blending, the depth test, culling."""
        self.ctx.disable(self._of_draws)

    def _given_now(self, step: Step, around: LoopIteration | None) -> dict[str, Any]:
        """Return what the engine gives a kernel in this frame: the very same in every iteration, if it is."""
        if around is not None and around.frame is not None and "time" in step.kernel.engine_uniforms:
            return self.given_for(step, around.frame)
        step_before, pressed, uniforms = self._known_given.get(id(step), (None, None, {}))
        if step_before is not step or pressed is not self.pressed:
            uniforms = self.given_for(step)
            self._known_given[id(step)] = step, self.pressed, uniforms
        return uniforms

    @contextmanager
    def _placed(self, step: Step) -> Iterator[None]:
        """Raise an error of a data file at the pass that names it."""
        assert self._plan is not None, "set_frame() comes first"
        try:
            yield
        except DataError as error:
            raise error_at(error, self._plan.sketch, self._plan.flat.user(step.path)) from error

    def _moment(self, step: Step, frame: int | None) -> dict[str, Any]:
        """Return what a source depends on besides its parameters, as ``moment``."""
        moment = source_kind(step.kernel.registry).moment
        if moment is None:
            return {}
        with self._placed(step):
            return {MOMENT: moment(step.values, Now(self._time_at(frame), self.inputs))}

    def _time_at(self, frame: int | None) -> float:
        """Return the time of the frame that a loop is at, else of the picture."""
        return float(self._given["time"]) if frame is None else frame / FRAME_RATE

    def _source(
        self, step: Step, inputs: Mapping[str, Wired], uniforms: Mapping[str, Any], key: str
    ) -> Result:
        kind = source_kind(step.kernel.registry)
        painted = self._painted_for(step, kind)
        arrays = self._arrays(step, kind, inputs, uniforms, key) if painted is None else {}
        result = self.pool.take(step.size, step.kernel.outputs)
        if painted is not None:
            output = step.kernel.outputs[0]
            self.kernels.copy_texture(
                result.textures[output.name], self.paint.texture_of(painted, output.format)
            )
            return result
        for output in step.kernel.outputs:
            if output.name not in arrays:
                names = ", ".join(arrays)
                raise step.spec.error(f"source '{step.kernel.registry}' gives {names}, not '{output.name}'")
            write_texture(result.textures[output.name], arrays[output.name])
        return result

    def _arrays(
        self,
        step: Step,
        kind: SourceKind,
        inputs: Mapping[str, Wired],
        uniforms: Mapping[str, Any],
        key: str,
    ) -> Arrays:
        """Return what a source makes, by its outputs' names."""
        work = kind.work
        if work is None:
            assert kind.make is not None, "a kind has one of the two"
            return kind.make(step.values, step.size, uniforms.get(MOMENT))
        if self.works.idle:
            width, height = step.size
            return {
                o.name: np.zeros((height, width, split_format(o.format)[0]), np.float32)
                for o in step.kernel.outputs
            }

        def task() -> Task:
            wired = {
                name: wired_input.texture
                for name, wired_input in inputs.items()
                if wired_input.texture is not None
            }
            arrays = {name: read_texture(texture) for name, texture in wired.items()}
            facts = {name: uniforms[name] for name in OF_THE_TERRAIN if name in uniforms}
            return lambda report: work(step.values, step.size, Material(arrays, report=report, **facts))

        return self.works.made(step.path, key, task)

    def _painted_for(self, step: Step, kind: SourceKind) -> Painted | None:
        """Return the picture whose pixels are a source's texels as they are, if it is painted here."""
        path = kind.picture(step.values, step.size)
        painted = self.painted.of(path) if path is not None else None
        outputs = step.kernel.outputs
        if painted is None or len(outputs) != 1 or painted.pixels.shape[1::-1] != step.size:
            return None
        return painted if split_format(outputs[0].format)[0] == channels_of(painted) else None

    def frame_uniforms(self, step: Step, frame: int | None) -> dict[str, tuple[float, ...]]:
        """Return the values of the uniforms that the window or the frame sets, by name."""
        width, height = step.full_size
        time = self._time_at(frame)
        return {
            "time": (time,),
            "resolution": (float(width), float(height), 1.0),
            "square_resolution": (float(width), float(width), 1.0),  # of a face of a cube map
            "buttons": (float(self.drag[2] > 0), 0.0, 0.0, 0.0),
            "mouse": self.mouse,
            "delta": (self.delta if frame is None else 1 / FRAME_RATE,),
            "date": self.date,
            "date_from_1": (self.date[0], self.date[1] + 1.0, *self.date[2:]),
            "frame": (last_frame_at(time),),
            "frame_of_time": (last_frame_at(time),),
            "bands": bands_at(time),
            "hover": self.hover,
            "hover_share": (self.hover[0] / width, self.hover[1] / height),
            "drag": self.drag,
            **NEUTRAL,
            **self._scene(step),
        }

    def _scene(self, step: Step) -> dict[str, tuple[float, ...]]:
        """Return the sketch's camera and sun, where a step's shader asks for one of them."""
        assert self._plan is not None, "set_frame() comes first"
        needs_scene = any(meaning in OF_THE_SCENE for _, meaning in step.kernel.usual)
        return scene_of(self._plan) if needs_scene else {}


OF_THE_SCENE = frozenset({"camera", "light"})
"""What ``scene_of`` knows."""

_SUN = "sun"


def scene_of(plan: Plan) -> dict[str, tuple[float, ...]]:
    """Return the camera's place [m] and the unit vector towards the sun, both east, north and up.

    A sketch without a draw has no camera, one without a direction among its parameters no sun; of several
    that which is called ``sun`` counts. What there is not has a neutral value.
    """
    neutral, steps = NEUTRAL["forward"], plan.walk()
    directions = [
        (parameter.name != _SUN, step.values[parameter.name])
        for step in steps
        for parameter in step.kernel.parameters
        if parameter.widget.kind == "direction"
    ]
    sun = min(directions, key=lambda direction: direction[0])[1] if directions else None
    return {
        "camera": plan.eye.position if any(isinstance(s.kernel, Draw) for s in steps) else neutral,
        "light": unit_vector(sun) if isinstance(sun, tuple) else neutral,
    }

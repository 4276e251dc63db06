"""Bind what a program reads: given names, parameters, textures with their samplers.

Image files become textures here, which are cached, as are samplers and the single texels that
replace what is not wired.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from playground.data.content_hash import content_hash
from playground.data.image_files import MAX_HALF, read_image
from playground.engine.camera import unit_vector
from playground.engine.gl_calls import wrap_sampler
from playground.engine.plan import Step
from playground.engine.programs import Bound, Program
from playground.engine.results import MATCHING, OPEN, Wired, has_unwired, wires_of
from playground.engine.results import UNWIRED as NOT_WIRED
from playground.engine.textures import FACES, Shaped, check_size, copied, drain, shaped_size
from playground.engine.tuning import Stage, Tuning
from playground.errors import ContextError
from playground.memo import Memo
from playground.paths import shown
from playground.shader.colours import srgb_to_linear
from playground.shader.parameter import Sampling
from playground.shader.reserved_names import MATCHES, PRESSED, TOWARDS, UNWIRED, WINDOW, WIRED
from playground.sketch.model import Input, Kernel, Parameter, Value

if TYPE_CHECKING:
    import moderngl

    Readable = moderngl.Texture | Shaped

_SRGB8_ALPHA8 = 0x8C43  # GL_SRGB8_ALPHA8: the sampler decodes, before it filters
_MAX_FILES = 32
_EXACT = Sampling()  # what reads one texel as it is
_SINGLE = Sampling(wrap="border")  # likewise, and 0 around the texture
_WRAPS = {"mirror": 0x8370, "border": 0x812D}  # GL_MIRRORED_REPEAT, GL_CLAMP_TO_BORDER
_CONSTANTS = {"white": (1, 1, 1, 1), "black": (0, 0, 0, 1), "zero": (0, 0, 0, 0)}


class Binder:
    """Binds textures and sets uniforms on one context."""

    def __init__(self, ctx: moderngl.Context, tuning: Tuning) -> None:
        self.ctx = ctx
        self._anisotropy = min(tuning.anisotropy, float(ctx.max_anisotropy or 1.0))
        self._samplers: dict[Sampling, moderngl.Sampler] = {}
        self._constants: dict[str, moderngl.Texture] = {}
        self._shaped: dict[tuple[str, str], Shaped] = {}  # constants, by name and shape
        self._files: Memo[tuple[str, bool, bool, bool], moderngl.Texture] = Memo(
            "textures of files", _MAX_FILES, dropped=lambda _, texture: texture.release()
        )
        self._units = 0  # texture units used in this frame
        self._on_units: dict[int, moderngl.Sampler] = {}  # the samplers on them

    def release(self) -> None:
        """Release every texture and sampler."""
        for texture in self._constants.values():
            texture.release()
        for shaped in self._shaped.values():
            shaped.release()
        for sampler in self._samplers.values():
            sampler.release()
        self._samplers.clear()
        self._constants.clear()
        self._shaped.clear()
        self._files.clear()

    def tidy(self) -> None:
        """Take the samplers off the texture units: they would change how others read theirs."""
        if self._units:
            self.ctx.clear_samplers(0, self._units)
            self._units = 0
            self._on_units.clear()

    def bind(
        self,
        program: Program,
        step: Step,
        values: Mapping[str, Any],
        inputs: Mapping[str, Wired],
        stage: Stage,
    ) -> int:
        """Set what is the same for all iterations of a step; return the next free texture unit.

        Where the program was last bound for the very same, uniforms keep their values, and only the textures
        of the inputs are bound.
        """
        wires = wires_of(step, inputs)
        if stage.uniforms:
            program.set_all(stage.uniforms)
        bound = program.bound
        if bound and bound.step is step and bound.uniforms is values and bound.wires == wires:
            for declared, unit, sampler in bound.units:
                self.use(unit, self.wired(declared, inputs), sampler)
            return bound.unit
        program.bound = None
        kernel, uniforms, unit = step.kernel, {**values, "size": step.full_size}, 0
        if step.window is not None:
            uniforms[WINDOW] = step.window.origin
        for parameter in kernel.parameters:
            value = step.values[parameter.name]
            if parameter.widget.kind != "file":
                uniforms[parameter.name] = value
                if parameter.widget.kind == "button":
                    uniforms[parameter.name] = values.get(f"{PRESSED}{parameter.name}", value)
                if parameter.widget.kind == "direction":
                    uniforms[f"{TOWARDS}{parameter.name}"] = unit_vector(value)  # type: ignore[arg-type]
            elif parameter.name in program.uniforms:
                unit = self.file(program, parameter, value, unit)
        has_files = unit > 0
        if UNWIRED in program.uniforms:
            uniforms[UNWIRED] = has_unwired(kernel, inputs)
        units: list[tuple[Input, int, moderngl.Sampler]] = []
        for declared, wire in zip(kernel.inputs, wires, strict=True):
            uniforms[f"{WIRED}{declared.name}"] = wire != OPEN
            uniforms[f"{MATCHES}{declared.name}"] = wire == MATCHING
            if declared.name in program.uniforms:
                single = declared.name in stage.single_texels
                sampler = self.sampler(_SINGLE if single else declared.sampling)
                units.append((declared, unit, sampler))
                program.set(declared.name, unit)
                self.use(unit, self.wired(declared, inputs), sampler)
                unit += 1
        program.set_all(uniforms)
        if not has_files:
            program.bound = Bound(step, values, wires, tuple(units), unit)
        return unit

    def wired(self, declared: Input, inputs: Mapping[str, Wired]) -> moderngl.Texture:
        """Return what an input reads, with its mipmaps; one texel where nothing is wired."""
        result, texture, output = inputs.get(declared.name, NOT_WIRED)
        if texture is None:
            return self.constant(declared.fallback or "black")
        if declared.sampling.mipmap and (result is None or output not in result.mipmapped):
            if result is not None:
                # Mesa moves the texels to make room for the levels: a framebuffer would hold the old ones.
                result.release_framebuffer()
            texture.build_mipmaps()
            if result is not None:
                result.mipmapped.add(output)
        return texture

    def shaped(self, declared: Input, inputs: Mapping[str, Wired]) -> tuple[Readable, tuple[int, int, int]]:
        """Return what an input reads, in its own shape, and the size of that in texels.

        The copy belongs to the result that it is of; one texel a side where nothing is wired.
        """
        shape, (result, texture, output) = declared.shape, inputs.get(declared.name, NOT_WIRED)
        if not shape:
            texture = self.wired(declared, inputs)
            return texture, shaped_size(shape, texture.size)
        if texture is None:
            return self.shaped_constant(declared.fallback or "black", shape), (1, 1, 1)
        assert result is not None, "what is wired is part of a result"
        copy = result.shaped.get((output, shape))
        if copy is None:
            copy = result.shaped[output, shape] = copied(self.ctx, shape, texture)
        if declared.sampling.mipmap:
            copy.build_mipmaps()
        return copy, shaped_size(shape, texture.size)

    def previous_units(self, program: Program, kernel: Kernel, unit: int) -> list[tuple[str, int]]:
        """Return on which unit the texture of the iteration before goes, by output, where it is read."""
        units: list[tuple[str, int]] = []
        for output in kernel.outputs:
            name = f"k_previous_{output.name}"
            if name in program.uniforms:
                program.set(name, unit)
                units.append((output.name, unit))
                unit += 1
        return units

    def previous(self, units: Sequence[tuple[str, int]], state: Mapping[str, moderngl.Texture]) -> None:
        """Bind the textures of the iteration before; zeros where there is none."""
        sampler = self.sampler(_EXACT)
        for output, unit in units:
            self.use(unit, state.get(output) or self.constant("zero"), sampler)

    def texture(self, program: Program, name: str, unit: int, texture: Readable, sampling: Sampling) -> int:
        """Bind one texture to a sampler; return the next free unit."""
        program.set(name, unit)
        return self.unit(unit, texture, sampling)

    def unit(self, unit: int, texture: Readable, sampling: Sampling) -> int:
        """Bind one texture to a unit; return the next free one."""
        self.use(unit, texture, self.sampler(sampling))
        return unit + 1

    def sampler(self, sampling: Sampling) -> moderngl.Sampler:
        """Return the sampler that reads textures so: the same for samplings that are equal."""
        sampler = self._samplers.get(sampling)
        if sampler is None:
            sampler = self._samplers[sampling] = self.new_sampler(sampling)
            self._put_back()
        return sampler

    def _put_back(self) -> None:
        """Put back the sampler of unit 0, where a new one may have been while it was made."""
        before = self._on_units.get(0)
        if before is not None:
            before.use(0)

    def use(self, unit: int, texture: Readable, sampler: moderngl.Sampler) -> None:
        """Bind one texture to a unit, and the sampler that reads it unless it is there."""
        texture.use(unit)
        if self._on_units.get(unit) is not sampler:
            sampler.use(unit)
            self._on_units[unit] = sampler
            self._units = max(self._units, unit + 1)

    def file(self, program: Program, parameter: Parameter, value: Value, unit: int) -> int:
        """Bind an image file's texture to a sampler, in linear light; return the next free unit."""
        texture = self.file_texture(parameter, value)
        return self.texture(program, parameter.name, unit, texture, parameter.sampling)

    def file_texture(self, parameter: Parameter, value: Value, *, encoded: bool = False) -> moderngl.Texture:
        """Return an image file's texture: decoded to linear light, or as it is ``encoded`` in the file."""
        path, sampling = Path(str(value)), parameter.sampling
        encoded = encoded and not sampling.decode
        key = (content_hash(path), sampling.mipmap, encoded, sampling.flip)
        texture: moderngl.Texture | None = self._files.get(key)
        if texture is None:
            texture = self._files.put(key, self._read(path, encoded=encoded, flip=sampling.flip))
            if sampling.mipmap:
                texture.build_mipmaps()
        return texture

    def constant(self, name: str) -> moderngl.Texture:
        """Return a texture of one texel: white, black, or zero in every channel."""
        if name not in self._constants:
            texel = np.array(_CONSTANTS[name], np.float32).tobytes()
            self._constants[name] = self.ctx.texture((1, 1), 4, texel, dtype="f4")
        return self._constants[name]

    def shaped_constant(self, name: str, shape: str) -> Readable:
        """Return a texture of a shape, one texel a side, as ``constant`` does."""
        if not shape:
            return self.constant(name)
        if (name, shape) not in self._shaped:
            size = (1, FACES if shape == "cube" else 1)
            texels = np.tile(np.array(_CONSTANTS[name], np.float32), size[1]).tobytes()
            source = self.ctx.texture(size, 4, texels, dtype="f4")
            try:
                self._shaped[name, shape] = copied(self.ctx, shape, source)
            finally:
                source.release()
        return self._shaped[name, shape]

    def new_sampler(self, sampling: Sampling) -> moderngl.Sampler:
        """Create a sampler: anisotropic where mipmaps are filtered linearly."""
        linear, around = sampling.filter == "linear", sampling.wrap in ("repeat", "mirror")
        shrink = self.ctx.LINEAR if linear else self.ctx.NEAREST
        if sampling.mipmap:
            shrink = self.ctx.LINEAR_MIPMAP_LINEAR if linear else self.ctx.NEAREST_MIPMAP_NEAREST
        sampler = self.ctx.sampler(repeat_x=around, repeat_y=around, repeat_z=around)
        near = (sampling.magnify or sampling.filter) == "linear"
        sampler.filter = (shrink, self.ctx.LINEAR if near else self.ctx.NEAREST)
        if linear and sampling.mipmap and self._anisotropy > 1:
            sampler.anisotropy = self._anisotropy
        if sampling.wrap in _WRAPS:
            wrap_sampler(self.ctx, sampler, _WRAPS[sampling.wrap])
        return sampler

    def _read(self, path: Path, *, encoded: bool, flip: bool) -> moderngl.Texture:
        """Make a texture of an image file, row 0 south unless ``flip``: in linear light, or as encoded."""
        pixels = read_image(path).pixels[:: 1 if flip else -1]
        size = (pixels.shape[1], pixels.shape[0])
        try:
            check_size(self.ctx, size, "an image")
        except ContextError as error:
            raise ContextError(str(error), file=shown(path)) from None
        if pixels.dtype == np.uint8:
            data = np.ascontiguousarray(pixels).tobytes()
            decoded = None if encoded else _SRGB8_ALPHA8
            texture = self.ctx.texture(size, 4, data, alignment=1, internal_format=decoded)
        else:
            texels = pixels.astype(np.float64)
            if not encoded:
                texels[..., :3] = srgb_to_linear(texels[..., :3])
            with np.errstate(under="ignore"):
                half = np.clip(texels, -MAX_HALF, MAX_HALF).astype(np.float16)
            texture = self.ctx.texture(size, 4, half.tobytes(), alignment=1, dtype="f2")
        drain(self.ctx)
        return texture

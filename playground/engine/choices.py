"""Write into a wrapped text what is known when it runs on a software renderer, which gains by it.

No line and no column of the kernel's own changes, so that complaints of the driver stay in their places.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import replace

from playground.engine.interpolated_place import with_interpolated_place
from playground.shader.buffer_reads import TEXELS, with_texels
from playground.shader.fetched_alone import FETCH
from playground.shader.fixed_texels import fixed_texels
from playground.shader.own_shaders import own_part
from playground.shader.reserved_names import (
    FETCHES,
    FIXED,
    NEAREST,
    OWN_SIZE,
    PLACE,
    QUICK_FETCHES,
    SKIPS,
    UNWIRED,
)
from playground.shader.wrap import NOTHING_SKIPPED, ShaderStage, Wrapped, previous_name
from playground.sketch.model import Kernel, TexelKernel

QUICKER = NEAREST, OWN_SIZE, PLACE
"""Choices that change how a text is computed, and not what."""

_GIVEN_SIZE = "uniform ivec2 size;"
_OWN_SHARE = "k_own_share"
_FIXED = re.compile(rf"{FIXED}(\d+)_(\d+)_(\w+)")


def with_choices(wrapped: Wrapped, choices: Sequence[tuple[str, int]]) -> Wrapped:
    """Write checkboxes and menus into a wrapped text as constants, which changes no line and no column.

    A software renderer goes both ways of every ``if``: what was not chosen costs as much
    as what was, unless the compiler can see that it never happens. With the choice ``SKIPS`` the text is
    that of the part of a kernel that ends before its costly rest: see ``engine.costly_rest``. With the
    choices that ``FIXED`` begins, texels of these inputs become uniforms: see ``_with_uniform_texels``. With
    the choice ``NEAREST`` texels are fetched as this renderer is quick to: see ``_with_quick_fetches``. With
    ``OWN_SIZE`` textures are not asked for their size: see ``_with_own_size``. With ``PLACE`` the vertex
    shader says which texel it is: see ``interpolated_place``. With ``TEXELS`` buffers are read as textures:
    see ``engine.buffer_texels``.
    """
    stages = {}
    quick, own_size, place = [any(choice == name for choice, _ in choices) for name in QUICKER]
    fixed = frozenset(choice.removeprefix(FIXED) for choice, _ in choices if choice.startswith(FIXED))
    for name, stage in wrapped.stages.items():
        text = stage.text
        for choice, value in choices:
            pattern = rf"^([ \t]*)uniform([ \t]+(bool|int)[ \t]+{choice}\b)[^;\n]*;"

            def constant(match: re.Match[str], value: int = value) -> str:
                literal = ("true" if value else "false") if match.group(3) == "bool" else str(value)
                return f"{match.group(1)}const  {match.group(2)} = {literal};"

            text = re.sub(pattern, constant, text, flags=re.MULTILINE)
            if choice == TEXELS:
                text = with_texels(text)
            if choice == SKIPS:
                text = text.replace(NOTHING_SKIPPED, f"bool {SKIPS}() {{ discard; return true; }}")
        stage = replace(stage, text=text)
        stage = _with_uniform_texels(stage, fixed) if fixed else stage
        stage = _with_quick_fetches(stage, wrapped.kernel, own_size=own_size) if quick else stage
        stages[name] = _with_own_size(stage) if own_size else stage
    wrapped = replace(wrapped, stages=stages)
    return with_interpolated_place(wrapped) if place else wrapped


def fixed_name(x: int, y: int, name: str) -> str:
    """Return the name of the uniform with one texel of an input."""
    return f"{FIXED}{x}_{y}_{name}"


def fixed_texel(uniform: str) -> tuple[str, int, int] | None:
    """Return the input and the place, x and y, of the texel that a uniform is; None for any other."""
    match = _FIXED.fullmatch(uniform)
    return (match[3], int(match[1]), int(match[2])) if match else None


def _with_uniform_texels(stage: ShaderStage, inputs: Collection[str]) -> ShaderStage:
    """Write uniforms in place of the fetches of some inputs' texels at places written as numbers.

    A software renderer fetches such a texel anew for every texel that it computes, which takes it as long
    as one that differs; a uniform is there. No column changes: a fetch takes more letters than the name.
    """
    if not stage.first:
        return stage
    lines, uniforms = stage.text.split("\n"), {}
    for texel in fixed_texels(stage.source):
        index, uniform = stage.first - 1 + texel.line, fixed_name(texel.x, texel.y, texel.input)
        own = stage.source.lines[texel.line].code[texel.start : texel.end]
        given = lines[index][texel.start : texel.end]
        # What a stage does not have, as the other's function, is blank.
        if texel.input in inputs and given in (own, own.replace("texelFetch", FETCHES["texelFetch"])):
            line = lines[index]
            lines[index] = line[: texel.start] + uniform.ljust(len(given)) + line[texel.end :]
            uniforms[uniform] = f"uniform vec4 {uniform};"
    if not uniforms:
        return stage
    lines[stage.first - 1 : stage.first - 1] = uniforms.values()
    return replace(stage, text="\n".join(lines), first=stage.first + len(uniforms))


def quicker_choices(kernel: Kernel) -> frozenset[str]:
    """Return which of ``QUICKER`` may be made for a kernel.

    Where ``NEAREST`` is made, ``Binder`` binds the inputs of ``fetched_alone`` by a sampler that gives the
    nearest texel, and 0 outside of the texture. ``OWN_SIZE`` holds where each input is as large as what the
    kernel makes, ``PLACE`` where the fragment driver draws the whole of that at once.
    """
    found = set()
    if kernel.fetched_alone.fetches or _reads_previous(kernel):
        found.add(NEAREST)
    if isinstance(kernel, TexelKernel) and not kernel.fills_lattice:
        found.add(PLACE)
        # No texture but inputs may be asked for its size.
        if not kernel.file_parameters and (NEAREST in found or kernel.reads("textureSize")):
            found.add(OWN_SIZE)
    return frozenset(found)


def _reads_previous(kernel: Kernel) -> bool:
    return any(kernel.reads(previous_name(kernel, output)) for output in kernel.outputs)


def _with_own_size(stage: ShaderStage) -> ShaderStage:
    """Have a text's function ``textureSize`` give the pass's own size, which the driver knows as a uniform.

    What a text does for textures of other sizes is left out then as it is compiled.
    """
    if not stage.first:
        return stage
    lines = stage.text.split("\n")
    given = [i for i in range(stage.first - 1) if lines[i] == _GIVEN_SIZE]
    for index in given:  # the part declares it, before all that asks
        lines[index] = ""
    part = own_part("own_size.glsl", size=OWN_SIZE, share=_OWN_SHARE).split("\n")
    lines[1:1] = part
    return replace(stage, text="\n".join(lines), first=stage.first + len(part))


def _with_quick_fetches(stage: ShaderStage, kernel: Kernel, *, own_size: bool) -> ShaderStage:
    """Write another function in place of ``texelFetch`` where it reads what samplers give as texels."""
    if not stage.first:
        return stage
    lines, changed, own = stage.text.split("\n"), False, stage.first - 1
    for index in range(own):  # the engine's function for the iteration before, whose places are inside
        fetch = f"{FETCH}(k_previous_"
        changed |= fetch in lines[index]
        lines[index] = lines[index].replace(fetch, f"{QUICK_FETCHES[FETCH]}(k_previous_")
    used = set()
    for number, column in kernel.fetched_alone.fetches:
        line, end = lines[own + number], column + len(FETCH)
        called = line[column:end]
        if called in QUICK_FETCHES:  # what a stage does not have is blank, and some are uniforms by now
            lines[own + number] = line[:column] + QUICK_FETCHES[called] + line[end:]
            used.add(called)
    if not used and not changed:
        return stage
    if FETCHES[FETCH] in used:
        unwired = own_part(
            "quick_fetch_unwired.glsl",
            unwired=UNWIRED,
            fetch=QUICK_FETCHES[FETCH],
            fetch_unwired=QUICK_FETCHES[FETCHES[FETCH]],
        )
        lines[own:own] = unwired.split("\n")
    share = _OWN_SHARE if own_size else "(1.0 / vec2(textureSize(k_input, 0)))"
    part = own_part("quick_fetch.glsl", fetch=QUICK_FETCHES[FETCH], share=share)
    lines[1:1] = part.split("\n")  # behind the version
    return replace(stage, text="\n".join(lines), first=stage.first + len(lines) - stage.text.count("\n") - 1)

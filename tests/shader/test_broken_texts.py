"""What is read from a half-typed text: never an exception, and as many lines where a text comes of it."""

from __future__ import annotations

import random
from dataclasses import replace

import pytest

from playground.engine.sketch_warnings import warnings_of_kernel
from playground.paths import GLSL
from playground.shader.conditions import Conditions, live_code, without_guards
from playground.shader.declarations import declared_names, uniforms, vertex_outputs
from playground.shader.sampler_reads import fetched_alone, fixed_texels, read_by_texels_alone
from playground.shader.window_text import for_window
from playground.shader.zero_values import zeroed
from playground.sketch.techniques import read_kernel

KERNELS = ("generation/smooth/line", "water/fill/outward", "erosion/hydraulic/move", "simulation/life/step")
TYPED = [*"{}()[];,=?.#", "#if 1\n", "#else\n", "#endif\n", "#define X(a) a\n", "#define\n", "/*", "*/", "//"]
TYPED += ["uniform sampler2D s;", "texelFetch(s, ivec2(1), 0)", "1/4", "in vec3 v;", "layout(", "return", "é"]
TYPED += ["struct S {float a;} b;", "const int N = N;", "switch (1) { case 0: float q; break; case 1: q; }"]
EDITS = 10  # of each kernel


@pytest.mark.parametrize("name", KERNELS)
def test_half_typed_texts_raise_nothing(name: str) -> None:
    kernel = read_kernel(GLSL / f"{name}.glsl", GLSL)
    assert kernel is not None
    chance = random.Random(name)
    count = len(kernel.source.lines)
    for _ in range(EDITS):
        code = kernel.source.code
        for _ in range(chance.randrange(1, 5)):
            start = chance.randrange(len(code))
            end = start + chance.choice((0, chance.randrange(20)))
            code = code[:start] + chance.choice(TYPED) + code[end:]
        lines = [*code.split("\n"), *[""] * count][:count]
        edited = replace(kernel, source=kernel.source.with_codes(lines))
        text = edited.source.code
        fetched_alone(edited), fixed_texels(edited.source), read_by_texels_alone(edited.source)
        for_window(edited, tuple(declared.name for declared in edited.inputs))
        warnings_of_kernel(edited)
        declared_names(text), uniforms(text), vertex_outputs(text), live_code(code, {})
        assert zeroed(text).count("\n") == text.count("\n")
        assert len(Conditions(lines).live({})) == count
        assert set(without_guards(lines)) <= set(range(count))

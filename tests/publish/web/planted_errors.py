"""Twenty mistakes, each at a known line of a kernel or of a file that it includes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from playground.shader.wrap import FRAGMENT, Wrapped, wrap
from playground.sketch.techniques import read_kernel

HEAD = """\
// k.glsl -- a kernel with a mistake
#include "waves.glsl"
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
"""
WAVES = """\
// waves.glsl -- a file that is included
float hills(vec2 place) {
    /* two
       lines */ return sin(place.x);
}
"""
BODY = "float kernel(ivec2 texel) {\n    float a = hills(vec2(texel));\n    HERE\n}\n"
AT = 7  # line of k.glsl that HERE is on


@dataclass(frozen=True)
class Planted:
    """A mistake: the texts, and where it is to be found."""

    kernel: str
    line: int
    part: str  # of the message, in plain words
    file: str = "k.glsl"
    waves: str = WAVES

    def wrapped(self, folder: Path) -> Wrapped:
        """Return what the driver is given."""
        (folder / "k.glsl").write_text(self.kernel, encoding="utf-8")
        (folder / "waves.glsl").write_text(self.waves, encoding="utf-8")
        kernel = read_kernel(folder / "k.glsl", folder)
        assert kernel is not None
        return wrap(kernel, FRAGMENT)


def _in_body(code: str, part: str, line: int = AT) -> Planted:
    return Planted(HEAD + BODY.replace("HERE", code), line, part)


PLANTED = {
    "a parameter misspelt": _in_body("return levle;", "did you mean `level`?"),
    "a given name misspelt": _in_body("return tiem;", "did you mean `time`?"),
    "a function misspelt": _in_body("return smothstep(0.0, 1.0, a);", "did you mean `smoothstep`?"),
    "a function of the file misspelt": _in_body("return hils(vec2(1.0));", "did you mean `hills`?"),
    "HLSL's function": _in_body("return lerp(0.0, 1.0, a);", "its name for that is `mix`"),
    "a function of the library": _in_body("return unit_from_bits(5u);", "noise/hash.glsl"),
    "no semicolon": _in_body("a += 1.0\n    return a;", "missing `;`", AT + 1),
    "whole and decimal": _in_body("int b = a; return a;", "Whole and decimal"),
    "a whole number for a function": _in_body("return max(a, 1);", "No form of `max`"),
    "sizes": _in_body("vec3 b = vec2(1.0); return b.x;", "differ in size"),
    "too few components": _in_body("vec3 b = vec3(1.0, 2.0); return b.x;", "too few components"),
    "% of floats": _in_body("return a % 2.0;", "write `mod(a, b)`"),
    "a component that is not there": _in_body("return vec2(1.0).z;", "These components do not exist"),
    "declared twice": _in_body("float a = 2.0; return a;", "This name is taken"),
    "a uniform is written": _in_body("level = 2.0; return level;", "cannot be written to"),
    "a number for a condition": _in_body("if (a) return 1.0; return 0.0;", "A condition is a bool"),
    "a copied blank": _in_body("return\u00a0a;", "NO-BREAK SPACE"),
    "recursion": Planted(
        HEAD + "float f(float x) { return f(x); }\n" + BODY.replace("HERE", "return f(a);"), 5, "no recursion"
    ),
    "in the included file": Planted(
        HEAD + BODY.replace("HERE", "return a;"),
        4,
        "did you mean `place`?",
        "waves.glsl",
        WAVES.replace("place.x", "plase.x"),
    ),
    "behind an include": Planted(
        HEAD + BODY.replace("HERE", "return a;") + "\nfloat tail() { return level + nothing; }\n",
        10,
        "is not declared at this point",
    ),
    "an open bracket": Planted(
        HEAD + BODY.replace("HERE", "return a;").rstrip("}\n"), 7, "is a bracket unclosed?"
    ),
}

_INITIALISER = re.compile(r"^(\s*uniform\s+\w+\s+\w+)\s*=[^;]*;", re.MULTILINE)


def in_es(text: str) -> str:
    """Return a stage's text as WebGL2 takes it, line for line."""
    head, _, rest = text.partition("\n")
    assert head.startswith("#version 330")
    rest = _INITIALISER.sub(r"\1;", rest)
    return f"#version 300 es\nprecision highp float; precision highp int; {rest}"

"""Types of expressions: glslang accepts each and no narrower one, and shipped files contradict none."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from playground.paths import GLSL
from playground.shader.reserved_names import GIVEN
from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Call,
    Conditional,
    Declaration,
    Declarator,
    Index,
    Literal,
    Member,
    Method,
    Name,
    Node,
    Parenthesized,
    Unary,
    walk,
)
from playground.shader.syntax.parser import parse
from playground.shader.syntax.symbols import resolve
from playground.shader.syntax.types import ExpressionType, ExpressionTypes, conversions
from playground.sketch.techniques import read_kernel

from ...cases import each

EXPRESSIONS = (
    Assign,
    Binary,
    Call,
    Conditional,
    Index,
    Literal,
    Member,
    Method,
    Name,
    Parenthesized,
    Unary,
)
GIVEN_TYPES = {name: of_type for name, (of_type, _) in GIVEN.items()}
HEAD = """#version 460
struct Ray { vec3 from; vec3 towards; float far[2]; };
struct Scene { Ray rays[3]; int count; };
uniform sampler2D flat_;
uniform isampler3D volume;
uniform usampler2DArray layers;
uniform sampler2DShadow shadow;
uniform samplerCube sky;
uniform sampler1D line;
uniform samplerBuffer row;
layout(rgba32ui, binding = 0) uniform uimage2D picture;
layout(std140) uniform Camera { mat4 clip; vec3 eye; } camera;
layout(std140) uniform Sun { vec3 to_sun; };
#define TWICE(x) ((x) * 2)
const float PI = 3.14159;
float f; int i; uint u; bool b; double d;
vec2 v2; vec3 v3; vec4 v4; ivec2 i2; ivec3 i3; uvec3 u3; bvec3 b3; dvec2 d2;
mat2 m2; mat3 m3; mat4 m4; mat2x3 m23; mat3x2 m32; mat4x2 m42;
float row_of[4]; vec2 grid[3][2]; Ray ray; Scene scene;
float one(float x) { return x; }
int one(int x) { return x; }
vec3 one(vec3 x) { return x; }
uint two(uint x, float y) { return x; }
float two(float x, float y) { return x; }
ivec2 three(out float x, int y) { x = 0.0; return ivec2(y); }
Ray made(vec3 from) { return Ray(from, from, float[2](0.0, 1.0)); }
float[2] pair() { return float[2](0.0, 1.0); }
vec4 fract(int x) { return vec4(x); }
"""
CASES = """
bool: true | f < 1.0 | b && !b | v3 == v3 | b ^^ b | any(b3) | all(lessThan(v2, v2)) | i == 2
bool: isnan(f) | gl_FrontFacing | scene.rays[0] == ray
int: 1 | 0x1F | 0xE | -i | ~i | i << 2u | i % 3 | i3.y | i++ | row_of.length() | scene.count | findMSB(i)
int: one(1) | i += 2 | floatBitsToInt(f) | textureSize(line, 0) | textureSize(row) | bitCount(u) | abs(i)
int: max(i, 2) | b ? 1 : 2 | (f, i) | i & 3 | gl_SampleID | min(i3, 2).x
uint: 1u | 0xFFu | u + 1u | i * u | u >> 1 | two(u, f) | u3.x | packHalf2x16(v2) | findLSB(u) > 0 ? 1u : u
uint: uint(f) | max(u, 1u) | floatBitsToUint(f)
float: 1.0 | 1e3 | .5f | 2.f | f * 2.0 | i * f | u + f | one(f) | v3.x | v3[1] | m3[0][2] | m23[1].z | PI
float: dot(v3, v3) | length(v2) | distance(v3, v3) | row_of[i] | ray.far[1] | pair()[0] | TWICE(f)
float: b ? 1 : 2.0 | sin(1) | pow(f, 2.0) | determinant(m3) | texture(shadow, v3) | scene.rays[2].from.x
float: clamp(f, 0.0, 1.0) | mod(f, 2.0) | two(f, f) | f += 1.0 | gl_FragCoord.x | grid[0][1].y | fract(f)
float: camera.eye.z | to_sun.x | max(f, 1) | intBitsToFloat(i) | step(0.5, f) | mix(f, 1.0, b) | sign(f)
double: d | 1.0lf | d * f | d2.x | max(d, d) | sqrt(d)
vec2: v3.xy | v2 * 2.0 | 2 * v2 | vec2(1, 2) | v4.rg | v4.st | grid[1][0] | m2[0] | m32[2] | v2 * i | v2 / f
vec2: -v2 | v2 = vec2(0) | unpackHalf2x16(u) | m2 * v2 | v3 * m23 | m32 * v3 | b ? v2 : vec2(1) | i2 * v2
vec2: i2 + 0.5 | max(v2, 0.0) | fract(v2) | step(0.5, v2) | step(v2, v2) | normalize(v2) | refract(v2, v2, f)
vec2: textureQueryLod(flat_, v2) | smoothstep(0.0, 1.0, v2) | mix(v2, v2, bvec2(true)) | mix(v2, v2, 0.5)
vec2: min(i2, v2) | mod(v2, 2.0)
vec3: v3.zyx | v4.xyz | cross(v3, v3) | m3 * v3 | v3 * m3 | m23 * v2 | v2 * m32 | m23[0] | reflect(v3, v3)
vec3: one(v3) | ray.from | scene.rays[i].towards | made(v3).from | camera.eye | to_sun | clamp(v3, 0.0, 1.0)
vec3: v3 += 1.0 | v3++ | f + v3 | dFdx(v3) | vec3(v2, 1) | (v3) | faceforward(v3, v3, v3) | m42[0].xyy
vec4: texture(flat_, v2) | texelFetch(flat_, i2, 0) | textureLod(sky, v3, 0.0) | m4 * v4 | camera.clip[1]
vec4: camera.clip * vec4(camera.eye, 1.0) | v2.xxyy | fract(i) | textureGather(shadow, v2, f) | gl_FragCoord
vec4: textureGrad(flat_, v2, v2, v2) | textureProj(flat_, v3) | unpackUnorm4x8(u) | texelFetch(row, 0)
ivec2: i2 + 1 | textureSize(flat_, 0) | ivec2(v2) | three(f, i) | textureSize(sky, 0) | i2 % 2 | i2 << 1
ivec2: imageSize(picture) | abs(i2) | i3.xz | textureSize(shadow, 0) | i2 << i2 | floatBitsToInt(v2) | -i2
ivec3: textureSize(volume, 0) | textureSize(layers, 0) | i3 * 2 | i3 & 1 | findMSB(u3) | clamp(i3, 0, 2)
ivec4: texture(volume, v3) | texelFetch(volume, i3, 0)
uvec3: u3 + 1u | u3 * i3 | i3 + u3 | uvec3(v3) | u3 >> 1 | max(u3, 1u)
uvec4: texture(layers, v3) | imageLoad(picture, i2) | texelFetch(layers, i3, 0)
bvec3: lessThan(v3, v3) | not(b3) | greaterThanEqual(i3, i3) | isinf(v3) | equal(b3, b3) | notEqual(u3, u3)
dvec2: d2 | d2 * f | dvec2(1) | v2 * d | d2 + i2
mat2: m2 * m2 | m2 + 1.0 | 2.0 * m2 | inverse(m2) | m32 * m23 | m2 * 2 | -m2 | transpose(m2)
mat3: m3 | mat3(1) | matrixCompMult(m3, m3) | m23 * m32 | outerProduct(v3, v3) | mat3(m4) | m3 / f
mat3x2: transpose(m23) | outerProduct(v2, v3) | m2 * m32 | m32 + m32
mat2x3: transpose(m32) | m3 * m23 | outerProduct(v3, v2) | m23 * 2.0
mat4: camera.clip | m4 - m4
Ray: ray | scene.rays[1] | made(v3) | Ray(v3, v3, float[2](0.0, 1.0)) | b ? ray : ray
float[]: ray.far | pair() | float[2](1.0, 2.0) | float[](1.0, 2.0) | row_of
vec2[]: grid[0]
vec2[][]: grid
"""
TYPED = [
    (expression.strip(), of_type)
    for of_type, _, row in (line.partition(": ") for line in CASES.strip().splitlines())
    for expression in row.split(" | ")
]


def typed(text: str) -> tuple[ExpressionType, ExpressionTypes, Node]:
    """Return the type of the last variable's value, and what knows the others."""
    tree = parse(text)
    assert not tree.errors
    types = ExpressionTypes(resolve(tree))
    last = [node for node in walk(*tree.declarations) if isinstance(node, Declarator) and node.value][-1]
    assert last.value is not None
    return types.of(last.value), types, last.value


def spelled(of_type: ExpressionType) -> str:
    return of_type[0] + "[]" * of_type[1]


@each(("expression", "of_type"), TYPED)
def test_an_expression_has_its_type(expression: str, of_type: str) -> None:
    assert spelled(typed(f"{HEAD}void main() {{ float k = {expression}; }}\n")[0]) == of_type


def compiles(folder: Path, texts: list[str]) -> list[bool]:
    """Return whether glslang takes each of some fragment shaders."""
    program = shutil.which("glslangValidator")
    if program is None:
        pytest.skip("needs glslangValidator, which is in the package glslang-tools of Debian and Ubuntu")
    paths = {str(folder / f"{number}.frag"): text for number, text in enumerate(texts)}
    for path, text in paths.items():
        Path(path).write_text(text)
    done = subprocess.run([program, *paths], capture_output=True, text=True, check=False)
    refused, path = set(), ""
    for line in done.stdout.splitlines():
        path = line if line in paths else path
        refused |= {path} if line.startswith("ERROR") else set()
    return [path not in refused for path in paths]


NARROWER = "bool int uint float double ivec2 uvec2 vec2 dvec2 ivec3 uvec3 vec3 ivec4 uvec4 vec4".split()


@pytest.mark.slow
def test_glslang_agrees_with_every_type(tmp_path: Path) -> None:
    """It takes a variable of this type, and none of a type that would be converted to it."""
    texts, expected = [], []
    for expression, of_type in TYPED:
        if expression in ("(f, i)",):
            continue  # glslang reads a declaration's comma otherwise
        name, _, brackets = of_type.partition("[")
        kinds = [name, *(other for other in NARROWER if conversions((other, 0), (name, 0)))]
        for kind in kinds if not brackets else [name]:
            array = f"[{brackets}" if brackets else ""
            texts.append(f"{HEAD}void main() {{ {kind} k{array} = {expression}; }}\n")
            expected.append(kind == name)
    taken = compiles(tmp_path, texts)
    wrong = [text.splitlines()[-1] for text, a, b in zip(texts, taken, expected, strict=True) if a != b]
    assert not wrong


@each(
    ("call", "of_type"),
    [
        ("g(1)", "int"),
        ("g(1u)", "uint"),  # exact before int → float
        ("g(1.0)", "float"),
        ("g(u)", "uint"),
        ("h(1, 1.0)", "vec2"),  # one conversion, not two
        ("h(1.0, 1)", "vec3"),
        ("k(v)", "mat2"),
        ("k(v.xxx)", "mat3"),
        ("w(f)", "bool"),  # out: the parameter is converted
        ("later(f)", "vec4"),
    ],
)
def test_the_overload_that_converts_least_is_meant(call: str, of_type: str) -> None:
    head = """
    uint u; float f; vec2 v; vec4 later(float x);
    int g(int x) { return x; } uint g(uint x) { return x; } float g(float x) { return x; }
    vec2 h(float x, float y) { return vec2(x); } vec3 h(float x, int y) { return vec3(x); }
    vec3 h(vec2 x, int y) { return vec3(1); } mat2 k(vec2 x) { return mat2(1); }
    mat3 k(vec3 x) { return mat3(1); } bool w(out int x) { return true; } bool w(out float x) { return true; }
    """
    result, types, node = typed(f"{head} void main() {{ float a = {call}; }}")
    assert spelled(result) == of_type
    assert isinstance(node, Call)
    symbol = types.overload(node)
    assert symbol is not None and symbol.type == of_type


def test_what_is_not_known_has_no_type() -> None:
    for expression in ("nowhere", "nowhere + 1.0", "f().x", "ray.nothing", "size"):
        assert typed(f"{HEAD}void main() {{ float k = {expression}; }}")[0][0] == ""
    tree = parse("float k = float(size.x);")
    types = ExpressionTypes(resolve(tree), {"size": "ivec2"})
    member = next(node for node in walk(*tree.declarations) if isinstance(node, Member))
    assert types.of(member) == ("int", 0)


def test_structs_of_one_name_contradict_no_member() -> None:
    text = "struct S { float a; float b; }; void g() { struct S { float a; vec2 b; }; S s; float k = s.b; }"
    assert typed(text)[0] == ("", 0)
    assert typed(text.replace("s.b", "s.a"))[0] == ("float", 0)


def kernels() -> dict[Path, str]:
    """Return the flattened texts of the library's kernels by their files."""
    paths = sorted([*GLSL.rglob("*.glsl"), *GLSL.rglob("*.comp")])
    read = ((path, read_kernel(path, path.parent)) for path in paths)
    return {path: kernel.source.code for path, kernel in read if kernel is not None}


@pytest.mark.slow
def test_declarations_of_shipped_kernels_contradict_no_type() -> None:
    known = count = 0
    for path, text in kernels().items():
        tree = parse(text)
        types = ExpressionTypes(resolve(tree), GIVEN_TYPES)
        for node in walk(*tree.declarations):
            if isinstance(node, EXPRESSIONS):
                known, count = known + bool(types.of(node)[0]), count + 1
            for one in node.names if isinstance(node, Declaration) else ():
                if one.value is not None and types.of(one.value)[0]:
                    declared = node.type.name, len(node.type.arrays) + len(one.arrays)
                    value = types.of(one.value)
                    assert conversions(value, declared) is not None, (path, tree.source(node), value)
    assert count > 100_000
    assert known > 0.99 * count

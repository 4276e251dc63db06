"""List the names that a kernel may not take: GLSL's own, and those the engine gives it.

Source: The OpenGL Shading Language 4.60.8, chapter 3.6 (keywords, reserved
words) and chapter 8 (built-in functions). A parameter named after one of them
compiles on some drivers and fails on others.
"""

from __future__ import annotations

PREFIX = "k_"
"""Names that begin so belong to the driver that wraps a kernel."""

GIVEN: dict[str, tuple[str, str]] = {
    "size": ("ivec2", "texels of this pass's textures"),
    "iteration": ("int", "this step of a repeated kernel, from 0"),
    "iterations": ("int", "steps in all"),
    "stage": ("int", "what this step of a compute variant does, where its header lists stages"),
    "until": ("int", "the step after the last of this run, where one run takes several"),
    "time": ("float", "seconds"),
    "spacing": ("vec2", "metres from one texel of this pass to the next, east and north"),
    "extent": ("vec2", "metres from the terrain's first texel to its last, east and north"),
    "relief": ("float", "metres from height 0 to height 1"),
    "base_elevation": ("float", "metres above sea level at height 0"),
    "clip_from_world": ("mat4", "the camera: metres of the terrain to clip space"),
    "world_from_clip": ("mat4", "its inverse"),
    "eye": ("vec3", "position of the camera, metres of the terrain"),
}
"""Name → (GLSL type, meaning) of what every kernel and draw is given; declared where its text names it."""

SKIPS = "skips_rest"
"""A function that is true in what a software renderer draws first of a kernel: see ``engine.tuning``.

It stays in canonical texts: the engine cannot tell which lines are costly, and a variant of each of these
kernels would be its whole text again with one line more.
"""

RESERVED: frozenset[str] = frozenset({"previous", "kernel", "visit", "vertex", "fragment", SKIPS})
"""Functions that the engine gives or calls; ``previous_`` begins more of them."""

OF_THE_TERRAIN = ("spacing", "relief")
"""Given names that a source may read; they change with the terrain, not from frame to frame."""

WIRED, MATCHES, TOWARDS = "wired_", "matches_", "towards_"
"""What begins a given name for each input (bool: something is wired to it; it has the size of this
pass) and each direction (vec3: the unit vector towards it); declared where a text names it."""

READ = "read_"
"""What begins the name of a function that reads a compute variant's buffer: ``read_heights(place)`` is
``heights[place]``; declared where a text names it."""

UNWIRED = "k_unwired"
"""Whether any input that may stay unwired is, a bool; declared where a text fetches texels."""

FETCHES = {"texelFetch": "k_fetch_in", "texelFetchOffset": "k_fetch_in_shift"}
"""What replaces GLSL's own functions, as long as these, where an input may stay unwired: the one
texel of its white or black answers for every place."""

PRESSED = "pressed "
"""What begins the name of a button among what a step is given, while the button is pressed."""

WINDOW = "k_window"
"""Where the window that is drawn lies in the whole picture, an ivec2 in pixels."""

PART = "k_part"
"""Which part of the whole picture is drawn, a vec4: the share where it begins, then its share of the size."""

ZOOM = "k_zoom"
"""What stretches a draw's clip space to a window, a vec4: factors, then what is added."""

PLAIN_UNIFORMS: dict[str, tuple[str, ...]] = {
    "time": ("iTime", "iGlobalTime", "u_time", "time", "uTime"),
    "resolution": ("iResolution", "u_resolution", "resolution", "uResolution"),
    "mouse": ("iMouse", "u_mouse", "mouse", "uMouse"),
    "frame": ("iFrame", "u_frame", "frame", "uFrame"),
    "delta": ("iTimeDelta", "u_delta", "u_time_delta", "uDelta"),
    "date": ("iDate", "u_date"),
}
"""What a plain shader is given, under the names that such shaders use."""

_IDENTITY_3 = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
_IDENTITY_4 = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)

MOMENT = "moment"
"""What a source depends on besides its parameters, such as a frame of a film, among what a step is given."""

CLOCKED = frozenset(
    {"time", "frame", "frame_of_time", "delta", "date", "date_from_1"}
    | {"mouse", "hover", "hover_share", "drag", "buttons", "bands", MOMENT}
)
"""What belongs to one frame: given names and meanings that, in a loop that counts ``frames``, are those
of its iteration, so that what is computed of the frames before stays."""

SIZES = "sizes: "
"""What begins the meaning of a uniform that is given the sizes of samplers, whose names follow."""

ELEMENT = "_"
"""What is between the name of an array of samplers and the number of one, in the name of what feeds it."""

VALUE = "value: "
"""What begins the meaning of a uniform that is given a number, which follows."""

DEPTH = "depth: "
"""What begins the meaning of a uniform that is given the levels of a pyramid; how often the foot was halved
for this pass follows."""

NEUTRAL: dict[str, tuple[float, ...]] = {
    "frame_rate": (60.0,),
    "sample_rate": (44_100.0,),
    "forward": (0.0, 0.0, 1.0),
    "none": (0.0,),
    "one": (1.0, 1.0, 1.0, 1.0),
    "identity3": _IDENTITY_3,
    "identity4": _IDENTITY_4,
}
"""What other tools' shaders are given that never changes here, by meaning."""

GIVEN_INSTEAD: dict[str, str] = {
    name: value
    for meaning, value in {"time": "time", "frame": "time", "delta": "time", "resolution": "size"}.items()
    for name in PLAIN_UNIFORMS[meaning]
}
"""Names that a plain shader is given, with what a kernel is given in their place; the rest has nothing."""

_KEYWORDS = """
attribute const uniform varying buffer shared coherent volatile restrict readonly writeonly
atomic_uint layout centroid flat smooth noperspective patch sample break continue do for while
switch case default if else subroutine in out inout int void bool true false float double
discard return lowp mediump highp precision struct common partition active asm class union enum
typedef template this resource goto inline noinline public static extern external interface long
short half fixed unsigned superp input output hvec2 hvec3 hvec4 fvec2 fvec3 fvec4 filter sizeof
cast namespace using sampler3DRect invariant precise
vec2 vec3 vec4 ivec2 ivec3 ivec4 uvec2 uvec3 uvec4 bvec2 bvec3 bvec4 dvec2 dvec3 dvec4
mat2 mat3 mat4 mat2x2 mat2x3 mat2x4 mat3x2 mat3x3 mat3x4 mat4x2 mat4x3 mat4x4 uint
sampler1D sampler2D sampler3D samplerCube sampler2DArray sampler2DShadow sampler2DRect
samplerBuffer sampler2DMS isampler2D usampler2D image1D image2D image3D iimage2D uimage2D
"""

_RESULTS: dict[str, str] = {
    "float*": """
        radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2 log2 sqrt
        inversesqrt floor trunc round roundEven ceil fract mod step smoothstep fma normalize dFdx dFdy fwidth
        intBitsToFloat uintBitsToFloat
    """,
    "*": "abs sign min max clamp mix",
    "first": """
        modf frexp ldexp faceforward reflect refract matrixCompMult inverse uaddCarry usubBorrow
        bitfieldExtract bitfieldInsert bitfieldReverse
    """,
    "bool*": "isnan isinf lessThan lessThanEqual greaterThan greaterThanEqual equal notEqual not",
    "int*": "floatBitsToInt bitCount findLSB findMSB",
    "uint*": "floatBitsToUint",
    "bool": "any all",
    "float": "length distance dot determinant noise1",
    "vec2": "unpackUnorm2x16 unpackSnorm2x16 unpackHalf2x16 textureQueryLod noise2",
    "vec3": "cross noise3",
    "vec4": "unpackUnorm4x8 unpackSnorm4x8 noise4",
    "uint": "packUnorm2x16 packSnorm2x16 packUnorm4x8 packSnorm4x8 packHalf2x16",
    "texel": """
        texture textureProj textureLod textureOffset texelFetch texelFetchOffset textureGrad textureGather
        imageLoad
    """,
    "texels": "textureSize imageSize",
    "columns": "outerProduct transpose",
    "void": "umulExtended imulExtended imageStore barrier memoryBarrier groupMemoryBarrier",
}
BUILT_IN_FUNCTIONS: dict[str, str] = {
    name: result for result, names in _RESULTS.items() for name in names.split()
}
"""Name → type of its result. ``float*``: as many as the longest argument has; ``*``: likewise, of their
scalar type; ``first``: the first argument's type; ``texel`` of a texture, and its size in ``texels``;
``columns``: a matrix of the arguments' columns and rows."""

OUT_ARGUMENTS: dict[str, tuple[int, ...]] = {
    "modf": (1,),
    "frexp": (1,),
    "uaddCarry": (2,),
    "usubBorrow": (2,),
    "umulExtended": (2, 3),
    "imulExtended": (2, 3),
}
"""Functions of GLSL that write an argument → which."""

BUILT_IN_VARIABLES: dict[str, str] = {
    name: of_type
    for of_type, names in {
        "vec4": "gl_FragCoord gl_Position gl_FragColor",
        "vec2": "gl_PointCoord",
        "float": "gl_FragDepth gl_PointSize",
        "bool": "gl_FrontFacing",
        "int": """
            gl_VertexID gl_InstanceID gl_PrimitiveID gl_SampleID gl_Layer gl_ViewportIndex gl_InvocationID
            gl_MaxDrawBuffers
        """,
        "uvec3": """
            gl_NumWorkGroups gl_WorkGroupSize gl_WorkGroupID gl_LocalInvocationID gl_GlobalInvocationID
        """,
        "uint": "gl_LocalInvocationIndex",
    }.items()
    for name in names.split()
}
"""Name → type of the variables that the stages of a program have."""

GLSL_WORDS: frozenset[str] = frozenset(_KEYWORDS.split()) | frozenset({*BUILT_IN_FUNCTIONS, "main"})
"""Keywords, reserved words and built-in functions of GLSL 4.60."""

DRIVER_BOUND: dict[str, str] = {
    "texture": "use texelFetch, or textureLod with a level: the two drivers choose levels differently",
    "textureGrad": "use textureLod with a level",
    "textureGather": "GLSL 3.30 has none: use four texelFetch",
    "textureQueryLod": "a compute shader has no derivatives",
    "dFdx": "a compute shader has no derivatives: take differences of texels",
    "dFdy": "a compute shader has no derivatives: take differences of texels",
    "fwidth": "a compute shader has no derivatives: take differences of texels",
    "discard": "a compute shader cannot discard: return previous(texel)",
    "fma": "GLSL 3.30 has none, and it rounds once where a*b+c rounds twice",
    "precise": "GLSL 3.30 has none",
    "findMSB": "GLSL 3.30 has none",
}
"""What a kernel may not use, since its text runs as a fragment and as a compute shader; with the reason."""

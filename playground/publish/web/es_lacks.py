"""Tell what a text names of desktop GLSL that the GLSL ES 3.00 of web pages has not.

What can be said otherwise the runtime rewrites (desktop_glsl.js, conversions.js); the rest is here.
"""

from __future__ import annotations

import re

_FUNCTIONS = frozenset(
    """
    textureGather textureGatherOffset textureGatherOffsets textureQueryLod textureQueryLevels fma frexp
    ldexp bitCount bitfieldExtract bitfieldInsert bitfieldReverse findLSB findMSB uaddCarry usubBorrow
    umulExtended imulExtended packUnorm4x8 packSnorm4x8 unpackUnorm4x8 unpackSnorm4x8 packDouble2x32
    unpackDouble2x32 imageLoad imageStore imageSize interpolateAtCentroid interpolateAtSample
    interpolateAtOffset dFdxFine dFdyFine dFdxCoarse dFdyCoarse fwidthFine fwidthCoarse
    """.split()
)
_TYPES = re.compile(
    r"\b(?:double|dvec[234]|dmat[234](?:x[234])?|[iu]?sampler(?:2DMS(?:Array)?|Buffer|2DRect|CubeArray|1DArray)"
    r"|[iu]?image(?:1D|2D|3D|Cube|2DArray))\b"
)
_CALL = re.compile(r"\b([A-Za-z_]\w*)\s*\(")
_OWN = re.compile(r"\b[A-Za-z_]\w*\s+([A-Za-z_]\w*)\s*\([^;{}()]*\)\s*\{|#\s*define\s+(\w+)")


def lacking(code: str) -> str:
    """Return the first name in a text that GLSL ES 3.00 lacks, a function with brackets; "" if there is none.

    A function that the text itself defines is none.
    """
    match = _TYPES.search(code)
    if match:
        return match.group(0)
    own = {name for pair in _OWN.findall(code) for name in pair}
    called = (match.group(1) for match in _CALL.finditer(code))
    return next((f"{name}()" for name in called if name in _FUNCTIONS and name not in own), "")

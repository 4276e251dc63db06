// complaint_words.js -- what Python knows of drivers' logs: written by playground/publish/web/complaint_words.py.

export const WORDS = {
  formats: [
    [
      "[0-9]{1,9}:(?<line>[0-9]{1,9})\\((?<column>[0-9]{1,9})\\): (?<kind>(?:preprocessor" +
      " |fatal |internal )?(?:error|warning)|note|info): ?(?<message>.*)", "",
    ],
    [
      "[^\\s()]*\\([0-9]{1,9},[-0-9]{1,19}\\): (?<kind>(?:preprocessor |fatal |internal )?" +
      "(?:error|warning)|note|info)(?: X[0-9]+)?: ?(?<message>.*)", "",
    ],
    [
      "(?<kind>ERROR|WARNING|NOTE|INFO): [^\\s:]*:(?<line>-?[0-9]{1,9}):(?:(?<column>[0-" +
      "9]{1,9}):)?\\s*(?:(?:error|warning)\\(#[0-9]+\\)\\s*)?(?<message>.*)", "",
    ],
    [
      "(?<kind>(?:fatal |internal )?(?:error|warning)|ERROR|WARNING|Error|Warning|Inter" +
      "nal error):\\s*(?:(?:error|warning)\\(#[0-9]+\\)\\s*)?(?<message>.*)", "",
    ],
  ],
  benign: ["No errors\\.?|.{0,80} was successfully compiled to run on hardware\\.?|Success\\.?", "i"],
  frame: ["[-=^~]{2,}|\\^|[\\w ()]{1,40} info|-- error message --", "i"],
  summary: [
    "compilation terminated\\.?|[0-9]+ compilation errors?\\. *No code generated\\.?|(?:[0" +
    "-9]+ (?:errors?|warnings?)(?: and )?){1,2} generated\\.?|.{0,40}shader failed to co" +
    "mpile with the following errors:?|(?:[\\w ]{0,40}shader\\(s\\) (?:failed to link|(?:w" +
    "as |were )?linked)[,.]? ?){1,6}|[\\w ]{0,40}link error: INVALID_OPERATION\\.?|.{0,40" +
    "}shader\\(s\\) were not successfully compiled before glLinkProgram\\(\\) was called\\.." +
    "*|One or more attached shaders not successfully compiled\\.?|linking with uncompile" +
    "d/unspecialized shader|LINK_ERROR", "i",
  ],
  unbroken: ["(?<=\\))(?=(?:error|warning): )", ""],
  hints: [
    [
      "^(?=.*(?:undeclared|undefined|no function|no matching|not known|removed|deprecat" +
      "ed)).*?\\b((?:texture|shadow)(?:[123]D|Cube)\\w*)\\b", "i",
      "`{0}` is not in core GLSL: call `texture`, or `textureLod` and `texelFetch` in a kernel.",
    ],
    [
      "^(?=.*(?:undeclared|undefined|no function|no matching|not known|removed|deprecat" +
      "ed)).*?\\b(gl_Frag(?:Color|Data))\\b", "i",
      "`{0}` is not in core GLSL: declare an `out vec4` of your own and write to that.",
    ],
    ["[`'\"](attribute|varying)[`'\"]", "i", "`{0}` is not in core GLSL: write `in` or `out`."], [
      "#version must|#version (?:is )?required|only valid for function parameters in GL" +
      "SL|requires \\\"?#version", "i",
      "The text needs a newer `#version` on its very first line, such as `#version 330`.",
    ],
    [
      "(?:GLSL|version|version number) '?([0-9.]+)'? (?:is )?not supported|unsupported version ([0-9]+)",
      "i", "This driver has no GLSL `{0}`: ask for a lower `#version`.",
    ],
    [
      "extension:? [`'\"]?(\\w+)[`'\"]? ?:? ?.*(?:unsupported|not supported)|[`'\"](\\w+)[`'" +
      "\"] ?:.*extension.*not supported", "i",
      "This driver lacks the extension `{0}`: do without it, or guard it with `#ifdef {0}`.",
    ],
    ["#extension (\\w+)", "i", "This needs an extension: add `#extension {0} : enable` below `#version`."],
    [
      "not supported for this version|unrecognized layout identifier|Unknown identifier" +
      " .* in layout|(?:only )?(?:available|allowed|supported) (?:only )?in (?:GLSL|ver" +
      "sion)|GLSL .* required", "i",
      "The `#version` at the top is too old for this: raise it, or add the right `#extension`.",
    ],
    [
      "(?:reserved word:? [`'\"]?|keyword [`'\"])(\\w+)|[`'\"](\\w+)[`'\"] ?:.*reserved word", "i",
      "`{0}` is a reserved word of GLSL: choose another name.",
    ],
    [
      "unexpected (SAMPLE|SMOOTH|FLAT|PATCH|BUFFER|SHARED|CENTROID|INVARIANT|PRECISE|RE" +
      "SOURCE|SUBROUTINE)\\b|(?:at token|Syntax error:) \\\"(active|buffer|cast|class|comm" +
      "on|external|filter|fixed|flat|half|input|output|partition|patch|sample|shared|sm" +
      "ooth|this|union)\\\"|[`'\"](active|buffer|cast|class|common|external|filter|fixed|f" +
      "lat|half|input|output|partition|patch|sample|shared|smooth|this|union)[`'\"] ?: s" +
      "yntax error", "", "`{1}` is a reserved word of GLSL: choose another name.",
    ],
    ["unexpected ERROR_TOK", "", ""], [
      "[`'\"](gl_\\w*)[`'\"].*(?:reserved|prefix|redeclared)", "i",
      "Names that begin with `gl_` belong to GLSL: choose another name.",
    ],
    [
      "unexpected (?:end of file|\\$end|\\$undefined|EOF)|at token \\\"<EOF>\\\"|premature end", "i",
      "The text ends too soon: a `{{`, a `(` or a `;` is missing its partner somewhere above.",
    ],
    [
      "unexpected '\\}', expecting end of file|unexpected '\\}' at token|extraneous", "i",
      "There is one closing brace too many here or above.",
    ],
    [
      "syntax error.*expecting[^a-z]*(?:','|';'|COMMA|SEMICOLON)", "",
      "A `;` is missing, usually at the end of the line above, or a type name is misspelt.",
    ],
    [
      "unexpected NEW_IDENTIFIER|undeclared type|typename expected", "i",
      "A word that GLSL does not know is where a type should be: check its spelling.",
    ],
    [
      "\\b(?:syntax|parse) error|Syntax error", "i",
      "GLSL cannot read this: look for a missing `;`, comma or bracket here and on the line above.",
    ],
    [
      "of operator % must be an integer|operands to \\\"%\\\" must be integral|'%' ?:.*\\bfloat\\b", "i",
      "`%` is for whole numbers: write `mod(a, b)` for floats.",
    ],
    [
      "(?:if-statement|loop) condition must be scalar boolean|boolean expression expected", "i",
      "A condition is a bool: compare a number, as in `x > 0.0`.",
    ],
    ["recursion|recursive function", "i", "GLSL has no recursion: write a loop."],
    ["C-style initialization", "i", "Braces do not fill an array here: write `float[](1.0, 2.0)`."], [
      "swizzle|field selection|cannot access field|unknown field|no such field", "i",
      "These components do not exist here: a `vec3` has x y z (or r g b), a scalar has " +
      "none, and the two sets do not mix.",
    ],
    [
      "read-only|l-?value required|can(?:'t|not) modify|non-lvalue|assignment to const", "i",
      "This cannot be written to: `uniform`, `const` and `in` are read-only, so copy it" +
      " into a local variable first.",
    ],
    [
      "no return statement|does not return a value|missing return|not all .*paths? retu" +
      "rn|`?return'? with no value", "i",
      "A function that promises a value must end in `return` with one on every path.",
    ],
    [
      "redeclar|redefin|already (?:defined|declared|has a body)|conflicts with previous declaration", "i",
      "This name is taken already in the same scope or by an included file: rename one " +
      "of the two, or drop the repetition.",
    ],
    [
      "too few components to construct|too little data in type constructor|not enough d" +
      "ata|too few arguments.*construct", "i",
      "The constructor gets too few components: a `vec4` takes four numbers in all, or a single one.",
    ],
    [
      "too many parameters to .*constructor|too much data in type constructor|too many " +
      "arguments.*construct|constructor.*too many arguments", "i",
      "The constructor gets too many components: count those of its arguments together.",
    ],
    [
      "no function with name [`'\"](\\w+)|invalid call of (?:undeclared identifier )?[`'\"" +
      "](\\w+)|[`'\"](\\w+)[`'\"] ?: function is not known", "i",
      "No function `{0}` is known here: check its spelling, the `#include` that brings " +
      "it and the `#version`, and that no variable has the same name.",
    ],
    [
      "[`'\"](\\w+)[`'\"] ?:? ?undeclared|(?:undefined variable|undeclared (?:identifier|v" +
      "ariable)):? [`'\"]?(\\w+)", "i",
      "`{0}` is not declared at this point: check its spelling, and that its declaratio" +
      "n or `#include` is above.",
    ],
  ],
  misfit: [
    "no matching|could not implicitly convert|cannot be assigned to variable|cannot con" +
    "vert|wrong operand|does not operate on|incompatible type|implicit (?:cast|narrowin" +
    "g)|invalid operands|overloaded function|with wrong type|size mismatch|dimension mi" +
    "smatch|non-matching types|must be (?:an )?integer|wrong type", "i",
  ],
  call: [
    "(?:call to|overloaded function(?: found:| reference)?) [`'\"]?(?!found\\b|reference\\" +
    "b)(\\w+)(?:\\(([^()]*)\\))?|[`'\"](\\w+)[`'\"] ?: no matching", "",
  ],
  type: [
    "(?:(?<size>[234])-component vector of )?(?:(?:low|medium|high)p )?\\b(?<word>float|" +
    "double|unsigned int|uint|int|bool|[biud]?vec[234]|[d]?mat[234](?:x[234])?)\\b", "",
  ],
  bases: {"f": "float", "d": "float", "v": "float", "m": "float", "i": "int", "u": "uint", "b": "bool"},
  misfits: {
    "whole call":
      "No form of `{0}` takes ({1}): most built-in functions want floats, so write 2.0 fo" +
      "r 2, or float(...).",
    "call": "No form of `{0}` takes these arguments: check its spelling, their number, order and types.",
    "bool": "A bool is not a number: compare to get one, or convert with float(...) or int(...).", "float":
      "Whole and decimal numbers do not mix: write 2.0 for 2, or convert with float(...) " +
      "or int(...).",
    "sign": "Signed and unsigned do not mix: write 2u for 2, or convert with uint(...) or int(...).",
    "size":
      "The two sides differ in size: pick components with a swizzle such as .xyz, or buil" +
      "d the vector.",
    "types": "The types on the two sides do not fit: convert one of them, as in float(...) or vec3(...).",
  },
  unknown: [
    "no function with name [`'\"](\\w+)|invalid call of (?:undeclared identifier )?[`'\"](" +
    "\\w+)|[`'\"](\\w+)[`'\"] ?: function is not known|[`'\"](\\w+)[`'\"] ?: no matching overl" +
    "oaded function found|[`'\"](\\w+)[`'\"] ?:? ?undeclared|(?:undefined variable|undecla" +
    "red (?:identifier|variable)):? [`'\"]?(\\w+)", "i",
  ],
  follows: [
    "\\berror\\b|numeric|mismatch|no matching|cannot|can't|could not|wrong|incompatible|i" +
    "nvalid|does not|must be|non-vector|swizzle|field|unable to find", "i",
  ],
  unfit: ["no matching|unable to find compatible", "i"],
  unread: ["syntax error|parse error|NEW_IDENTIFIER|undeclared type|typename expected", "i"],
  function: [
    "\\b(?:void|bool|u?int|float|double|[biud]?vec[234]|d?mat[234](?:x[234])?|[iu]?sampl" +
    "er\\w+|[A-Z]\\w*)\\s+(\\w+)\\s*\\(", "",
  ],
  variable: [
    "\\b(?:void|bool|u?int|float|double|[biud]?vec[234]|d?mat[234](?:x[234])?|[iu]?sampl" +
    "er\\w+|[A-Z]\\w*)\\s+(\\w+)\\s*(?:\\[[^\\]]*\\])?\\s*(?=[=;,)])", "",
  ],
  define: ["^\\s*#\\s*define\\s+(\\w+)(\\()?", "m"],
  definition: [
    "^(?:void|bool|u?int|float|double|[biud]?vec[234]|d?mat[234](?:x[234])?|[iu]?sample" +
    "r\\w+|[A-Z]\\w*)\\s+(\\w+)\\s*\\(", "m",
  ],
  runs: ["^\\s*#\\s*(?:pragma\\s+(?:kernel|source|draw|compute)\\b|version\\b)", "m"],
  defined: ["function [`'\\\"](\\w+) (\\w+)\\(([^)]*)\\)[`'\\\"]", ""],
  chain: ["call chain: (\\w+)", ""],
  cast: ["(?<![\\w)\\]])\\(\\s*(float|int|uint|bool|[iub]?vec[234])\\s*\\)\\s*[\\w(.]", ""],
  types: [
    "float", "int", "uint", "bool", "void", "vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "uvec2",
    "uvec3", "uvec4", "bvec2", "bvec3", "bvec4", "mat2", "mat3", "mat4", "sampler2D", "const", "uniform",
    "return", "struct",
  ],
  near: 0.75,
  elsewhere: {
    "lerp": "mix", "frac": "fract", "fmod": "mod", "rsqrt": "inversesqrt", "ddx": "dFdx", "ddy": "dFdy",
    "atan2": "atan", "tex2D": "texture", "tex2Dlod": "textureLod", "float2": "vec2", "float3": "vec3",
    "float4": "vec4", "int2": "ivec2", "int3": "ivec3", "int4": "ivec4", "float4x4": "mat4", "fabs": "abs",
    "fabsf": "abs", "sinf": "sin", "cosf": "cos", "sqrtf": "sqrt", "floorf": "floor", "powf": "pow",
    "fmin": "min", "fmax": "max", "fminf": "min", "fmaxf": "max", "ln": "log",
  },
  guesses: {
    "elsewhere": "GLSL knows no `{0}`: its name for that is `{1}`.",
    "saturate": "GLSL knows no `saturate`: write `clamp(x, 0.0, 1.0)`.",
    "instead": "`{0}` is given to plain shaders; a kernel is given `{1}`.",
    "library": "`{0}` is in the library: add {1} above.",
    "near": "`{0}` is not declared; did you mean `{1}`?",
    "cast": "GLSL has no casts like ({0}): write {0}(...).",
    "type": "GLSL knows no `{0}`; did you mean `{1}`?",
    "below": "`{0}` is defined further down, at {1}: GLSL reads from above, so move it up.",
  },
  instead: {
    "iTime": "time", "iGlobalTime": "time", "u_time": "time", "time": "time", "uTime": "time",
    "iFrame": "time", "u_frame": "time", "frame": "time", "uFrame": "time", "iTimeDelta": "time",
    "u_delta": "time", "u_time_delta": "time", "uDelta": "time", "iResolution": "size",
    "u_resolution": "size", "resolution": "size", "uResolution": "size",
  },
  given: [
    "size", "iteration", "iterations", "stage", "until", "time", "spacing", "extent", "relief",
    "base_elevation", "clip_from_world", "world_from_clip", "eye",
  ],
  known:
    "abs acos acosh active all any asin asinh asm atan atanh atomic_uint attribute barrie" +
    "r bitCount bitfieldExtract bitfieldInsert bitfieldReverse bool break buffer bvec2 bv" +
    "ec3 bvec4 case cast ceil centroid clamp class coherent common const continue cos cos" +
    "h cross dFdx dFdy default degrees determinant discard distance do dot double dvec2 d" +
    "vec3 dvec4 else enum equal exp exp2 extern external faceforward false filter findLSB" +
    " findMSB fixed flat float floatBitsToInt floatBitsToUint floor fma for fract frexp f" +
    "vec2 fvec3 fvec4 fwidth goto greaterThan greaterThanEqual groupMemoryBarrier half hi" +
    "ghp hvec2 hvec3 hvec4 if iimage2D image1D image2D image3D imageLoad imageSize imageS" +
    "tore imulExtended in inline inout input int intBitsToFloat interface invariant inver" +
    "se inversesqrt isampler2D isinf isnan ivec2 ivec3 ivec4 layout ldexp length lessThan" +
    " lessThanEqual log log2 long lowp main mat2 mat2x2 mat2x3 mat2x4 mat3 mat3x2 mat3x3 " +
    "mat3x4 mat4 mat4x2 mat4x3 mat4x4 matrixCompMult max mediump memoryBarrier min mix mo" +
    "d modf namespace noinline noise1 noise2 noise3 noise4 noperspective normalize not no" +
    "tEqual out outerProduct output packHalf2x16 packSnorm2x16 packSnorm4x8 packUnorm2x16" +
    " packUnorm4x8 partition patch pow precise precision public radians readonly reflect " +
    "refract resource restrict return round roundEven sample sampler1D sampler2D sampler2" +
    "DArray sampler2DMS sampler2DRect sampler2DShadow sampler3D sampler3DRect samplerBuff" +
    "er samplerCube shared short sign sin sinh sizeof smooth smoothstep sqrt static step " +
    "struct subroutine superp switch tan tanh template texelFetch texelFetchOffset textur" +
    "e textureGather textureGrad textureLod textureOffset textureProj textureQueryLod tex" +
    "tureSize this transpose true trunc typedef uaddCarry uimage2D uint uintBitsToFloat u" +
    "mulExtended uniform union unpackHalf2x16 unpackSnorm2x16 unpackSnorm4x8 unpackUnorm2" +
    "x16 unpackUnorm4x8 unsigned usampler2D using usubBorrow uvec2 uvec3 uvec4 varying ve" +
    "c2 vec3 vec4 void volatile while writeonly",
  fetches: {"texelFetch": "k_fetch_in", "texelFetchOffset": "k_fetch_in_shift"},
  foreign: "the character U+{0}, {1}, is none of GLSL's: only comments may have it",
  nameless: "of no name",
  characters: {
    "\u00a0": "NO-BREAK SPACE", "\u00ad": "SOFT HYPHEN", "\u2002": "EN SPACE", "\u2003": "EM SPACE",
    "\u2007": "FIGURE SPACE", "\u2009": "THIN SPACE", "\u200a": "HAIR SPACE", "\u200b": "ZERO WIDTH SPACE",
    "\u202f": "NARROW NO-BREAK SPACE", "\u2060": "WORD JOINER", "\u3000": "IDEOGRAPHIC SPACE",
    "\ufeff": "ZERO WIDTH NO-BREAK SPACE", "\u2018": "LEFT SINGLE QUOTATION MARK",
    "\u2019": "RIGHT SINGLE QUOTATION MARK", "\u201a": "SINGLE LOW-9 QUOTATION MARK",
    "\u201c": "LEFT DOUBLE QUOTATION MARK", "\u201d": "RIGHT DOUBLE QUOTATION MARK",
    "\u201e": "DOUBLE LOW-9 QUOTATION MARK", "\u00ab": "LEFT-POINTING DOUBLE ANGLE QUOTATION MARK",
    "\u00bb": "RIGHT-POINTING DOUBLE ANGLE QUOTATION MARK", "\u2032": "PRIME", "\u2033": "DOUBLE PRIME",
    "\u00b4": "ACUTE ACCENT", "\u2010": "HYPHEN", "\u2011": "NON-BREAKING HYPHEN", "\u2012": "FIGURE DASH",
    "\u2013": "EN DASH", "\u2014": "EM DASH", "\u2015": "HORIZONTAL BAR", "\u2212": "MINUS SIGN",
    "\u00d7": "MULTIPLICATION SIGN", "\u00f7": "DIVISION SIGN", "\u00b7": "MIDDLE DOT", "\u2022": "BULLET",
    "\u2026": "HORIZONTAL ELLIPSIS", "\u2215": "DIVISION SLASH", "\u2217": "ASTERISK OPERATOR",
    "\u037e": "GREEK QUESTION MARK", "\uff08": "FULLWIDTH LEFT PARENTHESIS",
    "\uff09": "FULLWIDTH RIGHT PARENTHESIS", "\uff0c": "FULLWIDTH COMMA", "\uff1b": "FULLWIDTH SEMICOLON",
    "\u00b0": "DEGREE SIGN", "\u00b2": "SUPERSCRIPT TWO", "\u00b3": "SUPERSCRIPT THREE",
    "\u2264": "LESS-THAN OR EQUAL TO", "\u2265": "GREATER-THAN OR EQUAL TO", "\u2260": "NOT EQUAL TO",
    "\u00b1": "PLUS-MINUS SIGN",
  },
  pastEnd: "{0}; is a bracket unclosed? the file needs {1}",
};

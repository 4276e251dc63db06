"""Shaders of Shadertoy's kinds of several passes, written for these tests: one for each rule.

Each is files by name; the first is opened, "" in the name's place opens their folder. ``HERE`` is a line at
which a mistake may be planted; ``AT`` says which file, and which pass in it, has it.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

from tests.dialect_texts import HERE, MISTAKE

IMAGE = f"""void mainImage(out vec4 c, in vec2 p) {{
    vec2 uv = p / iResolution.xy;
{HERE}    c = texture(iChannel0, uv);
}}
"""
PLAIN = "void mainImage(out vec4 c, in vec2 p) { c = vec4(p / iResolution.xy, fract(iTime), 1.0); }\n"
CUBE = """void mainCubemap(out vec4 c, in vec2 p, in vec3 origin, in vec3 ray) {
    c = vec4(0.5 + 0.5 * ray, 1.0) + vec4(origin, 0.0);
}
"""
SHOWS = IMAGE.replace(HERE, "")
SOUND = "vec2 mainSound(int s, float t) { return vec2(t); }"
GROWS = """void mainImage(out vec4 c, in vec2 p) {
    vec2 uv = p / iResolution.xy;
    // here
    vec4 before = texture(iChannel0, uv);
    c = iFrame < 2 ? vec4(uv, 0.0, 1.0) : vec4(uv, before.z + 1.0 / 256.0, 1.0);
}
"""


def read(number: int, channel: int = 0, **more: object) -> dict[str, object]:
    """Return an input that reads the output of a number."""
    return {"id": number, "ctype": "buffer", "channel": channel, **more}


def one(name: str, code: str, *inputs: object, kind: str = "", output: object = 37) -> dict[str, object]:
    """Return an entry of ``renderpass``."""
    kinds = {"I": "image", "B": "buffer", "C": "common", "S": "sound"}
    outputs = [{"id": output, "channel": 0}] if output else []
    made = {"code": code, "name": name, "inputs": list(inputs), "outputs": outputs}
    return {**made, "type": kind or kinds[name[0]]}


def cube(code: str, *inputs: object) -> dict[str, object]:
    """Return an entry of a cube map pass, whose output is 41."""
    return one("Cube A", code, *inputs, kind="cubemap", output=41)


def export(*passes: object) -> str:
    """Return an export as the site writes it."""
    return json.dumps({"Shader": {"ver": "0.1", "info": {"name": "Made here"}, "renderpass": list(passes)}})


@dataclass(frozen=True)
class Toy:
    """One sketch of another tool, in files."""

    files: dict[str, str]
    at: str  # the file, or "file:pass", that HERE is in
    opens: str = ""  # a file; "" the folder

    def with_mistake(self) -> tuple[dict[str, str], int]:
        """Return the files with a mistake in them, and its line in ``at``."""
        line = 0
        files = {}
        for name, text in self.files.items():
            files[name] = text
            if name.rpartition("/")[2] == self.at.partition(":")[0]:
                files[name], line = _planted(text, self.at.partition(":")[2])
        assert line
        return files, line


def _planted(text: str, part: str) -> tuple[str, int]:
    if not part:
        assert text.count(HERE) == 1
        return text.replace(HERE, MISTAKE), text[: text.index(HERE)].count("\n") + 1
    whole = json.loads(text)
    inside = whole[0] if isinstance(whole, list) else whole
    inside = inside.get("Shader", inside)
    (entry,) = [p for p in inside["renderpass"] if p and HERE in p["code"]]
    code = entry["code"]
    entry["code"] = code.replace(HERE, MISTAKE)
    return json.dumps(whole), code[: code.index(HERE)].count("\n") + 1


def _json(at: str, text: str) -> Toy:
    return Toy({"shader.json": text}, f"shader.json:{at}", "shader.json")


A = one("Buffer A", PLAIN, output=257)
WRAPPED = {"filter": "nearest", "wrap": "repeat", "vflip": "true", "srgb": "false", "internal": "byte"}

EXPORTS: dict[str, Toy] = {
    "one_pass": _json("Image", export(one("Image", IMAGE))),
    "buffer": _json("Image", export(one("Image", IMAGE, read(257)), A)),
    "list": _json("Image", json.dumps([{"renderpass": [A, one("Image", IMAGE, read(257))]}])),
    "bare": _json("Image", json.dumps({"renderpass": [None, {}, one("Image", IMAGE, read(257)), A]})),
    "other_input": _json(
        "Image",
        export(
            one(
                "Image",
                IMAGE,
                {"id": "4dXGR8", "type": "buffer", "filepath": "/media/previz/buffer00.png", "channel": 0},
            ),
            one("Buffer A", PLAIN, output="4dXGR8"),
        ),
    ),
    "by_preview": _json(
        "Image",
        export(
            one("Image", IMAGE, {**read(0), "id": "x", "src": "/media/previz/buffer01.png"}),
            one("Buffer B", PLAIN, output=0),
        ),
    ),
    "no_names": _json(
        "Image",
        json.dumps(
            {
                "renderpass": [
                    {"code": IMAGE, "type": "image", "inputs": [read(258)]},
                    {"code": PLAIN, "type": "buffer", "outputs": [{"id": 257}]},
                    {"code": PLAIN.replace("p /", "p * 0.5 /"), "type": "buffer", "outputs": [{"id": 258}]},
                ]
            }
        ),
    ),
    "common": _json(
        "Common",
        export(
            one("Image", PLAIN.replace("fract(iTime)", "shade(p.x)")),
            one("Common", f"float shade(float x) {{\n{HERE}    return fract(x * 0.1);\n}}\n", output=0),
        ),
    ),
    "common_in_a_buffer": _json(
        "Buffer A",
        export(
            one("Image", "float more = SHADE;\n" + IMAGE.replace(HERE, ""), read(257)),
            one("Common", "\n#define SHADE 0.5\n\n", output=0),
            one("Buffer A", IMAGE.replace("texture(iChannel0, uv)", "vec4(uv, SHADE, 1.0)"), output=257),
        ),
    ),
    "sparse_order": _json(
        "Buffer C",
        export(
            one("Image", IMAGE.replace(HERE, ""), read(259)),
            one("Buffer C", IMAGE, read(257), output=259),
            A,
        ),
    ),
    "sampler": _json("Image", export(one("Image", IMAGE, read(257, sampler=WRAPPED)), A)),
    "mipmap_of_a_buffer": _json(
        "Image",
        export(
            one("Image", IMAGE.replace("uv);", "uv, 1.0);"), read(257, sampler={"filter": "mipmap"})),
            A,
        ),
    ),
    "site": _json(
        "Image",
        export(
            one(
                "Image",
                f"""void mainImage(out vec4 c, in vec2 p) {{
    vec2 uv = p / iResolution.xy;
{HERE}    c = texture(iChannel0, uv) + texture(iChannel1, vec3(uv - 0.5, 0.5));
    c += texture(iChannel2, vec3(uv, 0.5)) + texture(iChannel3, uv);
    c *= 0.25 * iChannelResolution[1].x / 128.0 * iChannelResolution[2].z / 32.0;
}}
""",
                {"id": "a", "src": "/media/a/1.jpg", "ctype": "texture", "channel": 0},
                {"id": "b", "src": "/media/a/2.png", "ctype": "cubemap", "channel": 1},
                {"id": "c", "src": "/media/a/3.bin", "ctype": "volume", "channel": 2},
                {"id": "d", "src": "/media/a/4.webm", "ctype": "video", "channel": 3},
            )
        ),
    ),
    "devices": _json(
        "Image",
        export(
            one(
                "Image",
                f"""void mainImage(out vec4 c, in vec2 p) {{
    vec2 uv = p / iResolution.xy;
{HERE}    c = texture(iChannel0, vec2(uv.x, 0.25)) + texelFetch(iChannel1, ivec2(65, 0), 0).rrrr;
    c += texture(iChannel2, uv) + texture(iChannel3, uv);
    c.rg = mix(c.rg, uv, 0.5);
}}
""",
                {"id": "a", "src": "/media/a/1.mp3", "ctype": "music", "channel": 0},
                {"id": "b", "src": "/presets/tex00.jpg", "ctype": "keyboard", "channel": 1},
                {"id": "c", "src": "", "ctype": "webcam", "channel": 2},
                {"id": "d", "src": "", "ctype": "mic", "channel": 3},
            )
        ),
    ),
    "sound": _json(
        "Image",
        export(one("Image", IMAGE), one("Sound", SOUND, output=0)),
    ),
    "cube": _json(
        "Image",
        export(
            one("Image", IMAGE.replace("iChannel0, uv", "iChannel0, vec3(uv - 0.5, 0.5)"),
                {"id": 41, "ctype": "cubemap", "src": "/media/previz/cubemap00.png", "channel": 0}),
            cube(CUBE),
        ),
    ),
    "cube_at_its_line": _json(
        "Cube A",
        export(
            one("Image", IMAGE.replace(HERE, "").replace("iChannel0, uv", "iChannel0, vec3(uv - 0.5, 0.5)"),
                {"id": 41, "ctype": "cubemap", "channel": 0}),
            cube(CUBE.replace("    c =", f"{HERE}    c =")),
        ),
    ),
    "feedback": _json(
        "Buffer A",
        export(one("Image", SHOWS, read(257)), one("Buffer A", GROWS, read(257), output=257)),
    ),
    "later": _json(
        "Buffer A",
        export(
            one("Image", IMAGE.replace(HERE, ""), read(257)),
            one("Buffer A", GROWS, read(258), output=257),
            one("Buffer B", IMAGE.replace(HERE, ""), read(257), output=258),
        ),
    ),
}  # fmt: skip


INCLUDED = "vec2 halved(vec2 uv) {\n    return uv * 0.5;\n}\n"
SELF = """#iChannel0 "self"
#iChannel0::MinFilter "Nearest"
#iChannel0::MagFilter "Nearest"
"""
OWN_MAIN = """#iChannel0 "file://grows.glsl"
void main() {
    vec2 uv = gl_FragCoord.xy / iResolution.xy;
    // here
    gl_FragColor = texture2D(iChannel0, uv) + 0.1 * iMouseButton;
}
"""
UNIFORMS = f"""#iUniform float level = 1.5 in {{ 0.0, 1.0 }} step 0.1  // how bright
#iUniform int count = 3 in {{1, 15}}
#iUniform color3 tint = color3(1.0, .5, .0)
#iUniform color4 other = color4(1.0)
#iUniform vec2 place = vec2(0.25) in {{ 0., 1. }}
#iUniform bool on = true
#iUniform float free = 2.
void mainImage(out vec4 c, in vec2 p) {{
    vec2 uv = p / iResolution.xy;
{HERE}    c = on ? vec4(tint * level * uv.x, 1.0) * other : vec4(0.0);
    c.rg += place + free * 0.01 + float(count) / 15.0 * uv;
}}
"""
KEYS = f"""#iKeyboard
void mainImage(out vec4 c, in vec2 p) {{
    vec2 uv = p / iResolution.xy;
{HERE}    bool any_key = isKeyDown(Key_A) || isKeyPressed(Key_Space) || isKeyToggled(Key_UpArrow);
    c = vec4(uv, any_key ? 1.0 : 0.0, 1.0);
    c.b += texture(iKeyboard, uv).r + (isKeyReleased(Key_F1) ? 0.25 : 0.0);
}}
"""

FOLDERS: dict[str, Toy] = {
    "folder": Toy({"Image.glsl": IMAGE, "Buffer A.glsl": PLAIN}, "Image.glsl"),
    "folder_frag_without_space": Toy({"Image.frag": SHOWS, "BufferA.frag": GROWS}, "BufferA.frag"),
    "folder_by_its_image": Toy({"Image.glsl": IMAGE, "Buffer A.glsl": PLAIN}, "Image.glsl", "Image.glsl"),
    "folder_in_small_letters": Toy(
        {
            "common.glsl": "#define HERE(s, p) texture(s, p / iResolution.xy)\n",
            "image.glsl": "// iChannel1: buffer_b\n" + SHOWS.replace("iChannel0, uv", "iChannel1, uv"),
            "buffer_b.glsl": PLAIN.replace("{ c", f"{{\n{HERE} c")
            + "vec4 f() { return HERE(iChannel0, vec2(1.0)); }\n",
        },
        "buffer_b.glsl",
    ),
    "folder_that_includes_its_common": Toy(
        {
            "common.frag": f"float shade(float x) {{\n{HERE}    return fract(x * 0.1);\n}}\n",
            "image.frag": '#include "common.frag"\n// iChannel0: bufferA\n'
            + SHOWS.replace("uv);", "uv) * shade(p.x);"),
            "bufferA.frag": '#include "common.frag"\n' + PLAIN.replace("fract(iTime)", "shade(p.x)"),
        },
        "common.frag",
    ),
    "folder_with_a_keyboard": Toy(
        {
            "Image.glsl": "// iChannel0 = Buffer A\n// iChannel1 = Keyboard\n"
            + IMAGE.replace("uv);", "uv) + texelFetch(iChannel1, ivec2(65, 0), 0).x;"),
            "Buffer A.glsl": PLAIN,
        },
        "Image.glsl",
    ),
    "folder_common": Toy(
        {
            "Common.glsl": f"float shade(float x) {{\n{HERE}    return fract(x * 0.1);\n}}\n",
            "Image.glsl": "\n" + PLAIN.replace("fract(iTime)", "shade(p.x)"),
            "Buffer B.glsl": PLAIN,
        },
        "Common.glsl",
    ),
    "folder_cube": Toy(
        {
            "Image.glsl": "// iChannel2: Cube A\n"
            + SHOWS.replace("iChannel0, uv", "iChannel2, vec3(uv, 0.5)"),
            "Cube A.glsl": CUBE.replace("    c =", f"{HERE}    c ="),
        },
        "Cube A.glsl",
    ),
    "folder_comment": Toy(
        {
            "Image.glsl": "// iChannel0: Buffer B\n" + IMAGE,
            "Buffer A.glsl": GROWS.replace(HERE, ""),
            "Buffer B.glsl": SHOWS,
        },
        "Image.glsl",
    ),
    "folder_directive": Toy(
        {"Image.glsl": f'#iChannel0 "file://Buffer A.glsl"\n{SHOWS}', "Buffer A.glsl": f"{SELF}{GROWS}"},
        "Buffer A.glsl",
    ),
}

VSCODE: dict[str, Toy] = {
    "code_self": Toy({"a.glsl": f"{SELF}{GROWS}"}, "a.glsl", "a.glsl"),
    "code_file": Toy(
        {"a.glsl": f'#iChannel0 "file://b.glsl"\n{SHOWS}', "b.glsl": f"\n\n{SELF}{GROWS}"}, "b.glsl", "a.glsl"
    ),
    "code_circle": Toy(
        {"a.glsl": f'#iChannel0 "file://b.glsl"\n{IMAGE}', "b.glsl": f'#iChannel0 "file://a.glsl"\n{GROWS}'},
        "b.glsl",
        "a.glsl",
    ),
    "code_own_main": Toy({"a.glsl": OWN_MAIN, "grows.glsl": f"{SELF}{GROWS}"}, "a.glsl", "a.glsl"),
    "code_uniforms": Toy({"a.glsl": UNIFORMS}, "a.glsl", "a.glsl"),
    "code_keys": Toy({"a.glsl": KEYS}, "a.glsl", "a.glsl"),
    "code_include": Toy(
        {
            "a.glsl": '#include "lib/x.glsl"\n#iChannel1 "file://gone.png"\n'
            + SHOWS.replace("iChannel0, uv", "iChannel1, halved(uv)"),
            "lib/x.glsl": INCLUDED.replace("    return", f"{HERE}    return"),
        },
        "x.glsl",
        "a.glsl",
    ),
    "code_many_channels": Toy(
        {
            "a.glsl": '#iChannel9 "file://b.glsl"\n#iChannel9::WrapMode "Mirror"\n'
            + IMAGE.replace("iChannel0, uv", "iChannel9, uv * 2.0").replace(
                "c =", "c = iChannelResolution[9].z *"
            ),
            "b.glsl": PLAIN,
        },
        "a.glsl",
        "a.glsl",
    ),
    "code_web_and_sound": Toy(
        {
            "a.glsl": '#iChannel0 "https://x.example/y.jpg"\n#iChannel1 "file://music/epic.mp3"\n'
            + IMAGE.replace("uv);", "uv) + texture(iChannel1, uv);")
        },
        "a.glsl",
        "a.glsl",
    ),
    "code_no_cube": Toy(
        {
            "a.glsl": '#iChannel0 "file://sky_{}.jpg"  // no such files\n#iChannel0::Type "CubeMap"\n'
            + IMAGE.replace("iChannel0, uv", "iChannel0, vec3(uv - 0.5, 0.3)")
        },
        "a.glsl",
        "a.glsl",
    ),
}

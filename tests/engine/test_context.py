"""Contexts: those there are, those made to look old, those missing, with advice that can be followed."""

from __future__ import annotations

import ctypes.util
import json
import os
import re
import runpy
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from playground.engine import context as module
from playground.engine import driver_advice
from playground.engine.context import ContextInfo, context_info, open_context
from playground.engine.driver_advice import COMPLAINTS, DEBIAN_RENDER, advice, complaint
from playground.errors import ContextError

from ..cases import each

ROOT = Path(__file__).resolve().parents[2]
KERNELS = {
    "start": '#pragma kernel(output = "h:r32f", repeat = "4", visits = "size.x, 1")\n'
    "ivec2 visit(ivec2 cell) { return ivec2(cell.x, iteration); }\n"
    "float kernel(ivec2 texel) { return texel.y == iteration ? float(texel.x) + 0.5 : previous(texel); }\n",
    "view": '#pragma draw(mesh = "grid", output = "frame:rgba16f")\n'
    'uniform sampler2D h; //! input("linear")\n'
    "uniform int grid = 9; //! slider(2, 99)\nuniform uint seed = 4000000000u;\n"
    "vec4 vertex(vec3 corner, out vec2 place) { place = corner.xy; return "
    "vec4(corner.xy * 1.6 - 0.8, 0.0, 1.0); }\n"
    "vec4 fragment(vec2 place) { return vec4(texture(h, place).r / 17.0, "
    "place.y, float(seed >> 24) / 255.0, 1.0); }\n",
}
SKETCH = 'format = 1\nsize = 17\n[[pass]]\nname = "h"\nuse = "./start"\n[view]\nuse = "./view"\n'
SCRIPT = """
import hashlib, json, sys
from playground.engine.engine import Engine
from playground.engine.context import context_info, open_context
from playground.sketch.load import load
ctx = open_context()
info = context_info(ctx)
with Engine(ctx) as engine:
    sketch = load(sys.argv[1])
    frame = engine.render(sketch, size=(32, 18))
    height = engine.read(sketch, "h")
print(json.dumps({
    "version": info.version_code, "compute": info.compute, "software": info.software, "opengl": info.opengl,
    "frame": hashlib.sha256(frame.array.tobytes()).hexdigest(), "mean": float(frame.array.mean()),
    "height": hashlib.sha256(height.tobytes()).hexdigest(), "error": ctx.error,
}))
"""


def in_a_child(script: str, *arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script), *arguments],
        env={**os.environ, "PYTHONPATH": str(ROOT), **environment},
        capture_output=True,
        text=True,
        timeout=180,
    )


@pytest.fixture(scope="module")
def sketch(tmp_path_factory):
    folder = tmp_path_factory.mktemp("old")
    for name, text in KERNELS.items():
        (folder / f"{name}.glsl").write_text(text)
    (folder / "sketch.toml").write_text(SKETCH)
    return folder / "sketch.toml"


@pytest.mark.slow
def test_an_older_context_draws_the_same(sketch):
    """4.1 is what macOS has, 3.3 the least that will do: no compute, the same bits."""
    result = {}
    for version in ("", "4.1", "3.3"):
        environment = {"MESA_GL_VERSION_OVERRIDE": version} if version else {}
        done = in_a_child(SCRIPT, str(sketch), **environment)
        assert done.returncode == 0, done.stderr
        result[version] = json.loads(done.stdout)
    if result["4.1"]["version"] != 410:
        pytest.skip("this driver does not let itself be made older")
    assert [result[v]["version"] for v in ("4.1", "3.3")] == [410, 330]
    assert [result[v]["compute"] for v in ("", "4.1", "3.3")] == [True, False, False]
    assert result["4.1"]["opengl"] == "OpenGL 4.1"
    for key in ("frame", "height"):
        assert len({item[key] for item in result.values()}) == 1, f"{key} differs"
    assert all(item["error"] == "GL_NO_ERROR" for item in result.values())
    assert 20 < result[""]["mean"] < 250


@pytest.mark.slow
def test_compute_that_is_not_there_is_a_sentence(sketch):
    script = """
    import sys
    from playground.engine.engine import Engine
    from playground.errors import ContextError
    from playground.engine.context import open_context
    from playground.sketch.load import load
    ctx = open_context()
    try:
        Engine(ctx, driver="compute")
    except ContextError as error:
        print(error)
    try:
        Engine(ctx).render(load(sys.argv[1]))
    except ContextError as error:
        print(error)
    """
    plain = sketch.parent / "plain.comp"
    plain.write_text(
        "#version 430\nlayout(local_size_x = 1) in;\nlayout(rgba8, binding = 0) uniform image2D p;\n"
        "void main() { imageStore(p, ivec2(gl_GlobalInvocationID.xy), vec4(1)); }\n"
    )
    done = in_a_child(script, str(plain), MESA_GL_VERSION_OVERRIDE="4.1")
    lines = done.stdout.strip().split("\n")
    assert lines[0] == "this context is OpenGL 4.1; compute needs 4.3", done.stderr
    assert lines[1].endswith("is a compute shader; this context is OpenGL 4.1, and compute needs 4.3")


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="EGL is Linux's")
def test_gl_libraries_load_by_name_without_ldconfig(monkeypatch):
    """Three of them took as long as the context itself."""
    if not all(map(module.is_loadable, ("libEGL.so.1", "libGL.so.1"))):
        pytest.skip("the libraries of this system have other names")
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("a process is started"))
    monkeypatch.setattr("ctypes.util.find_library", lambda name: pytest.fail(f"{name} is looked for"))
    open_context().release()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="EGL is Linux's")
def test_libraries_of_other_names_are_looked_for(monkeypatch):
    looked_for = []
    monkeypatch.setattr(module, "is_loadable", lambda name: False)
    find = ctypes.util.find_library
    monkeypatch.setattr("ctypes.util.find_library", lambda name: looked_for.append(name) or find(name))
    open_context().release()
    assert "EGL" in looked_for


def test_one_that_is_too_old_says_what_it_offers():
    done = in_a_child(
        "from playground.engine.context import open_context\ntry:\n    open_context()\n"
        "except Exception as e: print(type(e).__name__, e)",
        MESA_GL_VERSION_OVERRIDE="3.0",
    )
    assert done.stdout.startswith("ContextError "), done.stdout + done.stderr
    assert done.stdout.count("\n") == 1
    assert "3.3" in done.stdout


@pytest.mark.parametrize("device", [99, 2**31, -1])
def test_an_impossible_device_is_one_sentence(device):
    done = in_a_child(
        "import sys\nfrom playground.engine.context import open_context\n"
        "try:\n    open_context(device=int(sys.argv[1]))\n"
        "except Exception as e: print(type(e).__name__, e)",
        str(device),
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("ContextError "), done.stdout
    assert done.stdout.count("\n") == 1
    assert "Traceback" not in done.stderr


def test_software_is_software():
    done = in_a_child(
        "from playground.engine.context import context_info, open_context\n"
        "i = context_info(open_context(software=True))\n"
        "print(i.software, i.slug)"
    )
    assert done.stdout.split() == ["True", "llvmpipe"], done.stderr


def test_a_device_that_only_linux_has_is_refused_elsewhere(monkeypatch):
    monkeypatch.setattr(module.sys, "platform", "darwin")
    with pytest.raises(ContextError, match="only Linux has"):
        open_context(device=0)


def test_what_a_context_is(ctx):
    info = context_info(ctx)
    assert info.version_code >= 330
    assert info.max_samples >= 1
    assert info.compute == (info.version_code >= 430)


@pytest.mark.parametrize(
    ("renderer", "slug", "software"),
    [
        ("llvmpipe (LLVM 15.0.6, 256 bits)", "llvmpipe", True),
        ("NVIDIA H200/PCIe/SSE2", "nvidia-h200", False),
        ("AMD Radeon RX 6800 (navi21, LLVM 15.0.6, DRM 3.49)", "amd-radeon-rx-6800", False),
        ("Apple M2", "apple-m2", False),
        ("Mesa Intel(R) UHD Graphics 620 (KBL GT2)", "mesa-intel-uhd-graphics-620", False),
        ("", "unknown", False),
    ],
)
def test_a_renderer_s_folder_is_the_same_for_every_build(renderer, slug, software):
    info = ContextInfo(450, renderer, "", "", 8)
    assert (info.slug, info.software) == (slug, software)


@pytest.mark.parametrize(("count", "message"), [(2, "there are 2, from 0"), (1, "the only one is 0")])
def test_missing_egl_device_reports_its_index_and_available_ones(monkeypatch, count, message):
    def refuse(**_: object) -> None:
        raise ValueError(f"requested device index 99, but found {count} devices")

    monkeypatch.setattr(module.sys, "platform", "linux")
    monkeypatch.setattr("moderngl.create_context", refuse)
    with pytest.raises(ContextError) as caught:
        open_context(device=99)
    assert str(caught.value) == f"--device 99: there is no such EGL device; {message}"


def test_software_advice_omits_variables_set_by_playground():
    code = """
import moderngl
def fail(*arguments, **options): raise Exception("found 0 devices")
moderngl.create_context = fail
from playground.engine.context import open_context
try:
    open_context(software=True)
except Exception as error:
    print(error)
"""
    clean = {k: v for k, v in os.environ.items() if k != "__EGL_VENDOR_LIBRARY_FILENAMES"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=clean)
    assert "found 0 devices" in done.stdout
    assert "__EGL_VENDOR_LIBRARY_FILENAMES" not in done.stdout


KEEPS = """
import ctypes, resource, sys
from playground.engine.software import keep_freed_memory
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.free.argtypes = ctypes.c_void_p, (ctypes.c_void_p,)
if sys.argv[1] == "keeps":
    keep_freed_memory()
def once():
    blocks = [libc.malloc(65536) for _ in range(400)]
    for block in blocks:
        ctypes.memset(block, 1, 65536)
    for block in reversed(blocks):
        libc.free(block)
once()
before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
once()
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "mallopt"), reason="another C library")
def test_memory_that_is_freed_and_taken_again_has_its_pages():
    """Blocks as llvmpipe's, 25 MiB of them: 6400 pages."""
    faults = [
        int(subprocess.run([sys.executable, "-c", KEEPS, how], capture_output=True, check=True).stdout)
        for how in ("keeps", "as it is")
    ]
    assert faults[0] < 200 < 5000 < faults[1]


# ── `advice` knows the texts that drivers really print, and gives advice that can be followed


# Texts as users saw them: in public threads (named), or provoked on Mesa 22.3.6 with
# glcontext 3.1 and GLFW 3.4, or (binary) as they stand in those two for other platforms.
MESSAGES = [
    ("no EGL library", "libEGL.so not loaded"),  # glcontext 3.1
    ("no EGL library", "libEGL.so not found in /lib, /usr/lib or LD_LIBRARY_PATH"),  # moderngl#382
    ("no EGL library", "libEGL.so.1: cannot open shared object file: No such file or directory"),
    ("no EGL library", "EGL: Library not found"),  # GLFW
    ("no GL library", "libGL.so not loaded"),  # glcontext 3.1
    ("no GL library", "(detect) libGL.so not loaded"),  # glcontext 3.1
    ("no GL library", "libGL.so not found in /lib, /usr/lib or LD_LIBRARY_PATH"),  # moderngl#397
    ("no GL library", "ImportError: libGL.so.1: cannot open shared object file: No such file or directory"),
    ("no GL library", "libOpenGL.so.0: cannot open shared object file: No such file or directory"),
    ("no GL library", "/nowhere/libfoo.so.1 not loaded"),  # GLCONTEXT_LINUX_LIBGL names no file
    ("no GL library", "GLX: Failed to load GLX"),  # GLFW
    ("no X library", "ImportError: libX11.so.6: cannot open shared object file: No such file or directory"),
    ("no X library", "X11: Failed to load Xlib"),  # GLFW
    ("no Wayland library", "Wayland: Failed to load libwayland-client"),  # GLFW
    ("no device", "requested device index 0, but found 0 devices"),  # moderngl#666, #683
    ("wrong device", "requested device index 5, but found 1 devices"),
    ("old EGL", "eglGetPlatformDisplayEXT not found"),  # glcontext 3.1
    ("old EGL", "eglQueryDevicesEXT not found"),  # glcontext 3.1
    ("no EGL display", "eglInitialize failed (0x3001)"),  # moderngl#405, #652
    ("no EGL display", "eglGetPlatformDisplayEXT failed (0x3000)"),  # moderngl#382
    ("no EGL display", "mgl.Error: cannot detect EGL display"),  # moderngl#189
    ("no EGL display", "peglgears: eglInitialize failed"),  # nvidia-docker#1751
    ("no EGL display", "EGL: Failed to initialize EGL: EGL is not or could not be initialized"),  # GLFW
    ("version too low", "eglCreateContext failed (0x3009)"),
    ("version too low", "Requested OpenGL version 430, got version 410"),
    ("version too low", "Requested OpenGL version 330, got version 300"),  # moderngl#584
    ("version too low", "ERROR: 0:2: '' :  version '330' is not supported"),  # moderngl#172
    (
        "version too low",
        "0:1(10): error: GLSL 3.30 is not supported. Supported versions are: 1.00 ES, and 3.00 ES",
    ),
    ("version too low", "GLX: Failed to create context: GLXBadFBConfig"),
    ("version too low", "WGL: Driver does not support OpenGL version 4.3"),  # GLFW
    ("no current context", "Requested OpenGL version 330, got version 0"),  # moderngl#581, #711
    ("no current context", "(detect) glXGetCurrentContext: cannot detect OpenGL context"),  # glcontext 3.1
    ("context refused", "eglCreateContext failed (0x3006)"),
    ("out of memory", "eglCreateContext failed (0x3003)"),
    ("only OpenGL ES", "eglBindAPI failed (0x300c)"),  # glcontext 3.1
    ("no screen", "(standalone) XOpenDisplay: cannot open display"),
    ("no screen", "(65550) b'X11: The DISPLAY environment variable is missing'"),  # glfw#1754
    ("no screen", "(65550) b'X11: Failed to open display :77'"),
    ("no screen", "(65544) b'Wayland: Failed to connect to display'"),  # glfw#1880
    ("screen without OpenGL", "(standalone) glXChooseVisual: cannot choose visual"),  # moderngl#382
    ("screen without OpenGL", "(standalone) glXChooseFBConfig failed"),  # glcontext 3.1
    ("screen without OpenGL", "Error: couldn't find RGB GLX visual or fbconfig"),  # moderngl#189
    ("screen without OpenGL", "Exception: (standalone) cannot create context"),  # moderngl#529
    (
        "no Mesa driver",
        "libGL error: MESA-LOADER: failed to open swrast: /usr/lib/dri/swrast_dri.so: cannot open shared"
        " object file: No such file or directory (search paths /usr/lib/x86_64-linux-gnu/dri:\\$${ORIGIN},"
        " suffix _dri)\nlibGL error: failed to load driver: swrast",  # WSL#10659
    ),
    (
        "no Mesa driver",
        "libEGL warning: DRI2: failed to create dri screen\neglInitialize failed (0x3001)",
    ),  # #652
    ("no Mesa driver", "libEGL warning: egl: failed to create dri2 screen"),
    ("no Mesa driver", "MESA: error: ZINK: failed to choose pdev\nglx: failed to create drisw screen"),
    (
        "no Mesa driver",
        "libgallium-25.0.7-2.so: cannot open shared object file: No such file or directory",
    ),
    (
        "forced software",
        "libEGL warning: Not allowed to force software rendering when API explicitly selects",
    ),
    (
        "forbidden device",
        "libEGL warning: failed to open /dev/dri/renderD128: Permission denied",
    ),  # WSL#12584
    (
        "old libstdc++",
        "libGL error: MESA-LOADER: failed to open iris: conda/lib/libstdc++.so.6: version"
        " `GLIBCXX_3.4.29' not found (required by /usr/lib64/dri/iris_dri.so)",  # anaconda-issues#12522
    ),
    ("Windows without OpenGL", "(65542) b'WGL: The driver does not appear to support OpenGL'"),  # glfw#862
    ("Windows without OpenGL", "(standalone) ChoosePixelFormat failed (0x0)"),  # binary
    ("Mac without OpenGL", "(65545) b'NSGL: Failed to find a suitable pixel format'"),  # glfw#2570
    ("Mac without OpenGL", "(standalone) cannot choose pixel format"),  # binary
    (
        "no runtime",
        "ImportError: DLL load failed while importing mgl: The specified module could not be found.",
    ),
]
PLATFORMS = ["linux", "darwin", "win32"]


@each(("name", "message"), MESSAGES)
def test_a_real_message_is_known(name, message):
    result = complaint(message)
    assert result is not None
    assert result.name == name


def test_every_complaint_of_the_table_has_a_real_message():
    assert {c.name for c in COMPLAINTS} == {name for name, _ in MESSAGES}


@each("platform", PLATFORMS)
@each("message", sorted({message for _, message in MESSAGES} | {"", "an unknown message"}))
def test_the_answer_is_one_line_of_whole_sentences(message, platform):
    answer = advice(message, platform, {})
    assert "\n" not in answer
    assert re.fullmatch(r"[A-Zm_].*\.", answer), answer
    assert "  " not in answer


@each("platform", ["darwin", "win32"])
@each(("name", "message"), MESSAGES)
def test_linux_package_manager_advice_is_never_given_elsewhere(name, message, platform):
    answer = advice(message, platform, {"DISPLAY": ":0", "WSL_DISTRO_NAME": "Debian"})
    assert "apt" not in answer.split()
    assert "dnf" not in answer.split()
    assert "WSL" not in answer


@each("platform", PLATFORMS)
def test_an_unknown_message_gets_the_general_advice(platform):
    assert complaint("the cat sat on the keyboard") is None
    assert advice("the cat sat on the keyboard", platform, {}).startswith("OpenGL did not start")


def test_an_unknown_platform_is_taken_for_linux():
    assert advice("libEGL.so not loaded", "freebsd14", {}) == advice("libEGL.so not loaded", "linux", {})


@each("message", ["libEGL.so not loaded", "libGL.so.1: cannot open shared object file"])
def test_missing_library_names_runtime_package_not_dev_package(message):
    answer = advice(message, "linux", {})
    assert f"apt install {' '.join(DEBIAN_RENDER)}" in answer
    assert "-dev" not in answer


@each(
    ("message", "environ", "expected"),
    [
        ("found 0 devices", {"NVIDIA_VISIBLE_DEVICES": "all"}, "NVIDIA_DRIVER_CAPABILITIES=all"),
        (
            "eglInitialize failed (0x3001)",
            {"NVIDIA_VISIBLE_DEVICES": "0", "NVIDIA_DRIVER_CAPABILITIES": "compute,utility"},
            "NVIDIA_DRIVER_CAPABILITIES=all",
        ),
        (
            "eglInitialize failed (0x3001)",
            {"NVIDIA_VISIBLE_DEVICES": "0", "NVIDIA_DRIVER_CAPABILITIES": "compute,graphics"},
            "10_nvidia.json",
        ),
        ("found 0 devices", {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere"}, "unset it"),
        ("eglInitialize failed (0x3001)", {"LIBGL_DRIVERS_PATH": "/nowhere"}, "LIBGL_DRIVERS_PATH"),
        ("/nowhere.so not loaded", {"GLCONTEXT_LINUX_LIBGL": "/nowhere.so"}, "GLCONTEXT_LINUX_LIBGL"),
        ("eglCreateContext failed (0x3009)", {"MESA_GL_VERSION_OVERRIDE": "3.1"}, "MESA_GL_VERSION_OVERRIDE"),
        ("The DISPLAY environment variable is missing", {"WSL_DISTRO_NAME": "Ubuntu"}, "wsl --update"),
        ("The DISPLAY environment variable is missing", {"SSH_CONNECTION": "x"}, "ssh"),
        ("X11: Failed to open display :77", {"DISPLAY": ":77"}, "does not answer"),
        ("Wayland: Failed to connect to display", {"WAYLAND_DISPLAY": "wayland-0"}, "XDG_RUNTIME_DIR"),
    ],
)
def test_the_environment_shows_the_likelier_cause(message, environ, expected):
    assert expected in advice(message, "linux", environ)
    assert len(advice(message, "linux", {})) < len(advice(message, "linux", environ))


def test_container_without_nvidia_gpu_gets_no_nvidia_advice():
    answer = advice("found 0 devices", "linux", {"NVIDIA_VISIBLE_DEVICES": "void"})
    assert "NVIDIA" not in answer


def test_play_finds_its_advice_and_its_packages_here() -> None:
    """It runs this file alone, before anything is installed, by a path that no import checks."""
    text = (ROOT / "play").read_text(encoding="utf-8")
    named = set(re.findall(r'"\$root/(playground/engine/\w+\.py)"', text))
    assert named == {Path(driver_advice.__file__).relative_to(ROOT).as_posix()}
    taken = {
        *re.findall(r'\["(\w+)"\]', text),
        *re.findall(r"\b(?:DEBIAN|FEDORA)_(?:RENDER|WINDOW|TEST)\b", text),
    }
    assert taken <= set(runpy.run_path(str(ROOT / named.pop()))) and len(taken) >= 5

"""`advice` knows the texts that drivers really print, and gives advice that can be followed."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

from playground.engine import driver_advice
from playground.engine.driver_advice import COMPLAINTS, DEBIAN_RENDER, advice, complaint

from ..cases import each

ROOT = Path(__file__).resolve().parents[2]

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

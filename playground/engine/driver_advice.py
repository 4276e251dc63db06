"""Return how to fix what OpenGL, EGL or the window system complains of.

Drivers answer with a code or half a message (``eglInitialize failed
(0x3001)``). `advice` finds the complaint in one table, and gives back what it
means and what to do, on this platform, in one line. The environment is handed
in, since some complaints have another cause inside a container, under WSL or
with an override set.

It opens nothing and looks at no file. ``play`` runs this file by its path,
before anything else can be imported, so it needs the standard library only;
there, too, the packages to install have their only home.

The texts are those in the binaries of glcontext 3.1 and GLFW 3.4, those that
Mesa 22 to 25 prints, and those of public threads: moderngl#189, #382, #397,
#405, #529, #581, #584, #652, #666, #683; glcontext#13; glfw#862, #1245, #1754,
#1880, #2570; WSL#10659, #12584; nvidia-docker#1520; anaconda-issues#12522.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

# Packages by name: to draw at all, to open a window, and for the tests of windows.
DEBIAN_RENDER = ("libegl1", "libgl1", "libgl1-mesa-dri")
DEBIAN_WINDOW = ("libx11-6", "libxcursor1", "libxi6", "libxinerama1", "libxkbcommon0", "libxrandr2")
DEBIAN_TEST = ("xvfb", "xdotool")
FEDORA_RENDER = ("mesa-libEGL", "mesa-libGL", "mesa-dri-drivers")
FEDORA_WINDOW = ("libX11", "libXcursor", "libXi", "libXinerama", "libxkbcommon", "libXrandr")
FEDORA_TEST = ("xorg-x11-server-Xvfb", "xdotool")


def _install(debian: tuple[str, ...], fedora: tuple[str, ...]) -> str:
    on_debian, on_fedora = " ".join(debian), " ".join(fedora)
    return f"On Debian and Ubuntu: sudo apt install {on_debian}; on Fedora: sudo dnf install {on_fedora}."


_RENDER = _install(DEBIAN_RENDER, FEDORA_RENDER)
_WINDOW = _install(DEBIAN_WINDOW, FEDORA_WINDOW)
_WAYLAND = _install(
    ("libwayland-client0", "libwayland-cursor0", "libwayland-egl1", "libxkbcommon0"),
    ("libwayland-client", "libwayland-cursor", "libwayland-egl", "libxkbcommon"),
)
# LIBGL_ALWAYS_SOFTWARE does not hold for EGL devices, which are chosen by number.
_SOFTWARE = (
    "To draw with Mesa's software renderer, set LIBGL_ALWAYS_SOFTWARE=1 for a window, and without a window"
    " GLCONTEXT_DEVICE_INDEX=1 or more: it is the last device."
)
_ELSEWHERE = (
    "Elsewhere name the two files, libEGL.so.1 and libGL.so.1, in GLCONTEXT_LINUX_LIBEGL and"
    " GLCONTEXT_LINUX_LIBGL."
)
_NO_WINDOW = "Without a screen every picture can still be made: use the commands that write a PNG."
_MAC_SCREEN = (
    "Run it in a session that is logged in at the screen, not over ssh; in a virtual machine, switch graphics"
    " acceleration on."
)
_WINDOWS_DRIVER = (
    "Install the graphics driver from the maker of the graphics card (Intel, AMD or NVIDIA). Over Remote"
    " Desktop or in a virtual machine, use the machine's own screen, or put Mesa's opengl32.dll next to"
    " python.exe."
)
_CURRENT = (
    "Make the window's context current before handing it over, and ask for a core profile, 3.3 or more."
)
_MEMORY = "Close other programs that draw, or choose a smaller size."


@dataclass(frozen=True, slots=True)
class Complaint:
    """One way to fail: how to know it, what it means, what to do."""

    name: str  # what the causes below call it
    says: tuple[str, ...]  # regular expressions; one found anywhere, in any case, will do
    means: str  # one message, true on every platform
    linux: str = ""  # sentences; empty: the advice that helps most often
    darwin: str = ""
    win32: str = ""

    def matches(self, message: str) -> bool:
        """Report whether the message is this complaint."""
        return any(re.search(pattern, message, re.IGNORECASE) for pattern in self.says)


# The first that matches is taken, so the particular comes before the general.
COMPLAINTS = (
    Complaint(
        "old libstdc++",
        (r"(GLIBCXX|CXXABI)_[\d.]+\W* not found",),
        "The driver needs a newer libstdc++ than the one that Python has loaded, as happens with conda.",
        linux="Use a Python that is not conda's, or: conda install -c conda-forge libstdcxx-ng.",
    ),
    Complaint(
        "forbidden device",
        (r"/dev/(dri|nvidia|dxg).*permission denied", r"permission denied.*/dev/(dri|nvidia|dxg)"),
        "The graphics card's device file may not be opened by this user.",
        linux="Join its group and log in again: sudo usermod -aG render,video $USER; in Docker, add"
        ' --device /dev/dri --group-add "$(stat -c %g /dev/dri/renderD128)".',
    ),
    Complaint(
        "forced software",
        (r"not allowed to force software rendering",),
        "LIBGL_ALWAYS_SOFTWARE is set, but a hardware device was chosen by its number.",
        linux="Unset it, or set GLCONTEXT_DEVICE_INDEX to the last device, which is the software renderer.",
    ),
    Complaint(
        "no Mesa driver",
        (
            r"MESA-LOADER: failed to open",
            r"\w+_dri\.so\W+cannot open",
            r"libgallium\S*\W+(not found|cannot open)",
            r"failed to load driver: \w+",
            r"failed to create (dri\d?|drisw|swrast) screen",
            r"ZINK: failed|ZINK: vkCreate",
        ),
        "Mesa is there, but finds none of its drivers, not even the software one.",
        linux=_RENDER,
    ),
    Complaint(
        "no X library",
        (r"libX11\S*\W+(not (loaded|found)|cannot open)", r"X11: Failed to load"),
        "The X11 library, which a window needs, is not installed.",
        linux=_WINDOW,
        darwin="Leave the choice of the backend to the playground: macOS needs no X11.",
    ),
    Complaint(
        "no Wayland library",
        (r"Wayland: Failed to load (lib|all)",),
        "The desktop is Wayland, and a library that a Wayland window needs is not installed.",
        linux=_WAYLAND,
    ),
    Complaint(
        "no EGL library",
        (r"libEGL\S*\W+(not (loaded|found)|cannot open)", r"EGL: (Library not found|Failed to load)"),
        "The EGL library is not installed, or is not where libraries are looked for.",
        linux=f"{_RENDER} {_ELSEWHERE}",
        darwin="Leave the choice of the backend to the playground: macOS has no EGL.",
        win32="Leave the choice of the backend to the playground: Windows has no EGL.",
    ),
    Complaint(
        "no GL library",
        (
            r"lib(GL|GLX|OpenGL|GLdispatch)[-_\w]*\.so\S*\W+(not (loaded|found)|cannot open)",
            r"\.so\S* not (loaded|found in /lib)",
            r"GLX: Failed to load GLX",
        ),
        "The OpenGL library is not installed, or is not where libraries are looked for.",
        linux=f"{_RENDER} {_ELSEWHERE}",
    ),
    Complaint(
        "no runtime",
        (r"DLL load failed", r"(VCRUNTIME|MSVCP)140"),
        "The Microsoft C++ runtime is missing.",
        win32="Install the Microsoft Visual C++ Redistributable, 2015 to 2022, x64.",
    ),
    Complaint(
        "no device",
        (r"found 0 devices", r"eglQueryDevicesEXT failed"),
        "EGL is installed, but no driver offers it a device.",
        linux=f"Mesa's software renderer needs neither a graphics card nor /dev/dri. {_RENDER}",
    ),
    Complaint(
        "wrong device",
        (r"requested device index \d+, but found [1-9]",),
        "There is no graphics device of the requested number; they count from 0.",
        linux="Set GLCONTEXT_DEVICE_INDEX to a smaller number, or unset it to take the first device.",
    ),
    Complaint(
        "old EGL",
        (r"egl[A-Z]\w+ not found",),
        "The EGL library is too old: it cannot draw without a screen.",
        linux=f"Update Mesa or the card's driver. {_RENDER}",
    ),
    Complaint(
        "no EGL display",
        (
            r"eglInitialize(\(\))? (is )?failed",
            r"baseOperation = eglInitialize",
            r"eglGet(Platform)?Display(EXT)? failed",
            r"cannot detect EGL display",
            r"EGL: Failed to (initialize EGL|get EGL display)",
        ),
        "EGL finds a device, but its driver does not start.",
        linux=f"Mesa's software renderer needs no graphics card. {_RENDER} {_SOFTWARE}",
    ),
    Complaint(
        "version too low",
        (
            r"eglCreateContext failed \(0x300[459]\)",  # EGL_BAD_ATTRIBUTE, _CONFIG, _MATCH
            r"requested OpenGL version \d+, got version [1-9]",
            r"Driver does not support (the requested )?OpenGL (version|profile)",
            r"version '?\d+\w*'? is not supported",
            r"GLSL \d\.\d+ is not supported",
            r"GLXBadFBConfig",
            r"(WGL|GLX)_ARB_create_context\w* is unavailable",
            r"does not support OpenGL 3",
            r"CreateContextAttribsARB (failed|not found)",
        ),
        "The driver offers a lower version of OpenGL than was requested: 3.3 is the least that will do, and"
        " compute shaders need 4.3.",
        linux=f"Update the driver; Mesa's software renderer has 4.5. {_SOFTWARE}",
        darwin="macOS ends at OpenGL 4.1, without compute shaders: use a technique that does without them.",
        win32=_WINDOWS_DRIVER,
    ),
    Complaint(
        "only OpenGL ES",
        (r"eglBindAPI failed", r"eglChooseConfig failed", r"EGL: (Failed to (bind|find)|No EGLConfigs)"),
        "The driver knows OpenGL ES only, as those of phones and small boards do.",
        linux=f"{_SOFTWARE} {_RENDER}",
    ),
    Complaint(
        "out of memory",
        (r"eglCreateContext failed \(0x3003\)", r"EGL_BAD_ALLOC", r"GL_OUT_OF_MEMORY", r"GLXBadAlloc"),
        "The driver has no memory left for another context.",
        linux=_MEMORY,
        darwin=_MEMORY,
        win32=_MEMORY,
    ),
    Complaint(
        "context refused",
        (r"egl(CreateContext|MakeCurrent) failed", r"EGL: Failed to (create|make) context"),
        "The driver started, but refused to make a context.",
        linux=f"Update the driver. {_SOFTWARE}",
    ),
    Complaint(
        "no current context",
        (r"cannot detect OpenGL context", r"got version 0\b", r"(glX|egl|wgl)GetCurrent\w+ failed"),
        "No OpenGL context is current in this thread.",
        linux=_CURRENT,
        darwin=f"{_CURRENT} It must also be forward compatible.",
        win32=_CURRENT,
    ),
    Complaint(
        "no screen",
        (
            r"XOpenDisplay: cannot open display",
            r"DISPLAY environment variable is missing",
            r"X11: Failed to open (X )?display",
            r"Wayland: Failed to connect to display",
            r"Failed to detect any supported platform",
            r"(cannot|unable to) (connect to X server|open display)",
        ),
        "There is no screen to open a window on.",
        linux=f"Start it from the desktop, or lend it a screen with xvfb-run. {_NO_WINDOW}",
        darwin=f"{_MAC_SCREEN} {_NO_WINDOW}",
        win32=_NO_WINDOW,
    ),
    Complaint(
        "screen without OpenGL",
        (
            r"glXChoose(FBConfig|Visual)\W.*(failed|cannot)",
            r"No matching fbConfigs",
            r"RGB GLX visual",
            r"GLX extension not found",
            r"\(standalone\) (cannot create context|XCreateWindow|glXMakeCurrent)",
            r"GLX: (Failed|No GLXFBConfigs)",
        ),
        "The screen is there, but offers no OpenGL, as with ssh -X, VNC and some old servers.",
        linux="Use the machine's own screen, or Xvfb's: xvfb-run -s '-screen 0 1280x800x24 +extension GLX'."
        f" {_NO_WINDOW}",
        darwin=_MAC_SCREEN,
    ),
    Complaint(
        "Windows without OpenGL",
        (r"\bWGL: ", r"\bwgl\w+ (failed|not found)", r"(Choose|Set)PixelFormat failed", r"opengl32\.dll"),
        "Windows has no OpenGL driver for this screen.",
        win32=_WINDOWS_DRIVER,
    ),
    Complaint(
        "Mac without OpenGL",
        (r"\bNSGL: ", r"\bCocoa: Failed", r"cannot choose pixel format", r"cannot create OpenGL context"),
        "macOS gives no OpenGL here.",
        darwin=_MAC_SCREEN,
    ),
)

_ANYWHERE = {
    "linux": f"Update the graphics driver. {_SOFTWARE} {_RENDER}",
    "darwin": _MAC_SCREEN,
    "win32": _WINDOWS_DRIVER,
}


@dataclass(frozen=True, slots=True)
class _Cause:
    """What in the environment, on Linux, makes one reason likelier than the rest."""

    of: frozenset[str]  # names of complaints
    holds: Callable[[Mapping[str, str]], bool]
    advice: str  # sentences, put before the complaint's own


def _any_set(*names: str) -> Callable[[Mapping[str, str]], bool]:
    return lambda environ: any(environ.get(name) for name in names)


def _nvidia_container(*, draws: bool) -> Callable[[Mapping[str, str]], bool]:
    def holds(environ: Mapping[str, str]) -> bool:
        capabilities = {"all", "graphics"} & set(environ.get("NVIDIA_DRIVER_CAPABILITIES", "").split(","))
        return (
            environ.get("NVIDIA_VISIBLE_DEVICES", "") not in {"", "void", "none"}
            and bool(capabilities) == draws
        )

    return holds


_NO_DRIVER = frozenset({"no device", "no EGL display", "context refused", "no Mesa driver"})
_NO_LIBRARY = frozenset({"no EGL library", "no GL library", "no X library"})
_NO_SCREEN = frozenset({"no screen", "screen without OpenGL"})
_CAUSES = (
    _Cause(
        _NO_DRIVER,
        _nvidia_container(draws=False),
        "This container was given NVIDIA's driver for computing only: start it with"
        " -e NVIDIA_DRIVER_CAPABILITIES=all, or use Mesa's.",
    ),
    _Cause(
        _NO_DRIVER,
        _nvidia_container(draws=True),
        "This container was given NVIDIA's driver: see that libEGL_nvidia.so.0 is there and that"
        " /usr/share/glvnd/egl_vendor.d/10_nvidia.json names it, or use Mesa's.",
    ),
    _Cause(
        _NO_DRIVER,
        _any_set("__EGL_VENDOR_LIBRARY_FILENAMES", "__EGL_VENDOR_LIBRARY_DIRS"),
        "__EGL_VENDOR_LIBRARY_FILENAMES or __EGL_VENDOR_LIBRARY_DIRS is set: unset it, or see that what it"
        " names exists.",
    ),
    _Cause(
        _NO_DRIVER,
        _any_set("LIBGL_DRIVERS_PATH", "MESA_LOADER_DRIVER_OVERRIDE"),
        "LIBGL_DRIVERS_PATH or MESA_LOADER_DRIVER_OVERRIDE is set: unset it.",
    ),
    _Cause(
        _NO_LIBRARY,
        _any_set("GLCONTEXT_LINUX_LIBEGL", "GLCONTEXT_LINUX_LIBGL", "GLCONTEXT_LINUX_LIBX11"),
        "GLCONTEXT_LINUX_LIBEGL, _LIBGL or _LIBX11 is set: unset it, or see that the file it names exists.",
    ),
    _Cause(
        frozenset({"version too low"}),
        _any_set("MESA_GL_VERSION_OVERRIDE", "GLCONTEXT_GLVERSION"),
        "MESA_GL_VERSION_OVERRIDE or GLCONTEXT_GLVERSION is set: unset it.",
    ),
    _Cause(
        _NO_SCREEN | {"forbidden device", "no Mesa driver"},
        _any_set("WSL_DISTRO_NAME", "WSL_INTEROP"),
        "This is WSL, where windows need WSL 2: in Windows run wsl --update and wsl --shutdown.",
    ),
    _Cause(
        _NO_SCREEN,
        _any_set("SSH_CONNECTION"),
        "This is an ssh session, which has no screen of its own.",
    ),
    _Cause(
        frozenset({"no screen"}),
        lambda environ: bool(environ.get("WAYLAND_DISPLAY")) and not environ.get("XDG_RUNTIME_DIR"),
        "WAYLAND_DISPLAY is set but XDG_RUNTIME_DIR is not, so the desktop cannot be found.",
    ),
    _Cause(
        frozenset({"no screen"}),
        _any_set("DISPLAY"),
        "DISPLAY names a screen that does not answer: see that it runs and that this user may use it (in"
        " Docker: -v /tmp/.X11-unix:/tmp/.X11-unix).",
    ),
)


def complaint(message: str) -> Complaint | None:
    """Return the entry of the table that a message belongs to, or None."""
    return next((row for row in COMPLAINTS if row.matches(message)), None)


def advice(message: str, platform: str, environ: Mapping[str, str]) -> str:
    """Return, in one line, what a failure means and what to do about it.

    ``message`` is what the exception says, with what the driver printed before
    it where that is at hand; ``platform`` is `sys.platform`; ``environ`` is
    `os.environ`. An unknown message gets the advice that helps most often.
    """
    system = platform if platform in _ANYWHERE else "linux"
    match = complaint(message)
    if match is None:
        return f"OpenGL did not start, for a reason that is not known here. {_ANYWHERE[system]}"
    likely = (
        [c.advice for c in _CAUSES if match.name in c.of and c.holds(environ)] if system == "linux" else []
    )
    own = {"linux": match.linux, "darwin": match.darwin, "win32": match.win32}[system]
    return " ".join([match.means, *likely, own or _ANYWHERE[system]])

"""Shaders of other tools: what the rest asks of the room that reads them, and what is said without it.

A sketch, a check or a window asks ``dialects()``. Where a room has a module ``table``, its ``DIALECTS`` is
that; else it is ``Dialects`` itself, which knows our own kernels and plain shaders alone.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import cache
from pathlib import Path

from playground.errors import Diagnostic, ParameterError, nearest
from playground.rooms import modules
from playground.shader.kernel import ForeignShader, Graph, Technique
from playground.shader.source import is_own_pragma
from playground.shader.syntax.tokens import directive, is_named

OWN = "own"

Read = Callable[[str, Path, Path], Technique]
"""Return the technique that ``use`` names: see ``Techniques.read``."""


def has_own_pragma(code: str) -> bool:
    """Return whether code without comments has a pragma of our own kernels."""
    return any(is_own_pragma(line) for line in code.split("\n") if "pragma" in line)


class Dialects:
    """What a room that reads shaders of other tools gives; here what there is without one."""

    names: tuple[str, ...] = (OWN,)
    """What ``--dialect`` takes."""

    endings: tuple[str, ...] = ()
    """Endings of files that hold several texts and are no GLSL themselves."""

    def name_of(self, text: str) -> str:
        """Return the name of a text's dialect; "" where it has nothing to run.

        One that is not in ``names`` is known, and not drawn.
        """
        from playground.shader.conditions import code_of

        code = code_of(text)
        lines = code.split("\n")
        has_version = any(directive(line)[0] == "version" for line in lines if "#" in line)
        is_plain = has_version and any(is_named(line, ("main",), called=True) for line in lines)
        return OWN if has_own_pragma(code) or is_plain else ""

    def ending(self, name: str) -> str:
        """Return the ending of a new file for a text of a dialect."""
        return ".glsl"

    def is_export(self, path: Path) -> bool:
        """Return whether a file is one of ``endings`` and holds the texts of a shader."""
        return False

    def read(
        self,
        path: Path,
        name: str,
        root: Path,
        read: Read,
        dialect: str = "",
        *,
        instead: Mapping[str, str] | None = None,
    ) -> Graph | None:
        """Read another tool's shader as a technique called ``name``; None for what is none.

        Its files stay in ``root``. ``dialect`` is one of ``names``, or "" to go by its signs.
        ``instead`` has texts, by absolute path, in place of files'. The same files give the same object.

        Raises ``SketchError`` or ``ShaderError`` for what is wrong in the text.
        """
        return None

    def image_of(self, folder: Path) -> Path | None:
        """Return the file by which a folder of several texts opens; None where it has none."""
        return None

    def is_inside(self, path: Path) -> bool:
        """Return whether a file is read with another of its folder, the one by which that opens."""
        return False

    def head(self, kernel: ForeignShader) -> str:
        """Return the comment by which a text says what it is given, as one line; "" where it has none."""
        return ""

    def given(self) -> Mapping[str, tuple[str, str]]:
        """Return what tools give their shaders: name → GLSL type and meaning."""
        return {}

    def unfed_warnings(self, kernel: ForeignShader, wired: Collection[str]) -> tuple[Diagnostic, ...]:
        """Return a warning for each thing that a shader lacks; ``wired`` are inputs that are fed."""
        return ()

    def stand_ins(self) -> Collection[str]:
        """Return the techniques of ``glsl/`` that are drawn where nothing feeds a channel."""
        return ()

    def stand_in_paths(self, path: str, sampler: str) -> Collection[str]:
        """Return the paths that a channel's own stand-in may have; ``path`` is that of the shader's pass."""
        return ()

    def sizes(self) -> Mapping[str, tuple[str, str]]:
        """Return the texels of techniques that feed a channel, where these have a size of their own."""
        return {}

    def size_of_shape(self, shape: str) -> tuple[str, str]:
        """Return the texels of any other technique, by the channel's shape."""
        return ("256", "256")


@cache
def dialects() -> Dialects:
    """Return what reads shaders of other tools; where no room does, what knows ours alone."""
    rooms: list[Dialects] = [module.DIALECTS for module in modules("table")]
    return rooms[0] if rooms else Dialects()


def check_name(name: str) -> str:
    """Return a dialect's name, or "" for none; raise ``ParameterError`` if it is not one of ``names``."""
    if name and name not in (names := dialects().names):
        raise ParameterError(f"--dialect {name}: no such dialect{nearest(name, names)}")
    return name

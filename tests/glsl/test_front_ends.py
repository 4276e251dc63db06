"""Another compiler's word on the library: glslang, which browsers and Vulkan tools have, takes every stage.

The drivers of this machine take more than the language has, as a struct's member named ``length``.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from ..loading import stages

ENDINGS = {"vertex": "vert", "fragment": "frag", "compute": "comp"}


def refused(folder: Path, texts: dict[tuple[str, str], str]) -> dict[str, list[str]]:
    """Return the errors of glslang by the names of stages, which are given by kind and text."""
    program = shutil.which("glslangValidator")
    if program is None:
        pytest.skip("needs glslangValidator, which is in the package glslang-tools of Debian and Ubuntu")
    names: dict[str, str] = {}
    for number, ((kind, text), name) in enumerate(texts.items()):
        file = folder / f"{number}.{ENDINGS[kind]}"
        file.write_text(text, encoding="utf-8")
        names[str(file)] = name
    ran = subprocess.run([program, *names], capture_output=True, text=True, timeout=120, check=False)
    assert ran.returncode in (0, 2), ran.stderr
    errors: dict[str, list[str]] = {}
    name = ""
    for line in ran.stdout.splitlines():
        name = names.get(line, name)
        if line.startswith("ERROR"):
            errors.setdefault(name, []).append(line)
    assert bool(errors) == bool(ran.returncode)
    return errors


@pytest.mark.slow
def test_glslang_takes_every_stage_of_the_library(tmp_path: Path) -> None:
    """Kernels as both drivers have them, draws and compute variants."""
    assert len(stages()) > 500
    assert refused(tmp_path, stages()) == {}


def test_glslang_refuses_a_member_named_length(tmp_path: Path) -> None:
    """What a driver lets pass is found: the check above can fail."""
    text = "#version 330\nstruct S { int length; };\nout float k;\n"
    text += "void main() { S s = S(1); k = float(s.length); }\n"
    right = text.replace("length", "count")
    assert list(refused(tmp_path, {("fragment", text): "wrong", ("fragment", right): "right"})) == ["wrong"]

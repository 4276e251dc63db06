"""What the engine's tests share: sketches made of a few small kernels in a folder of their own."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.sketch.model import Sketch

from ..loading import load


class Folder:
    """A sketch's folder that a test fills."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def write(self, name: str, text: str) -> Path:
        """Write a file, and see that its time differs from the last one's."""
        path = self.path / name
        before = path.stat().st_mtime_ns if path.exists() else 0
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        if path.stat().st_mtime_ns <= before:
            os.utime(path, ns=(before + 1, before + 1))
        return path

    def kernels(self, **texts: str) -> None:
        """Write kernels by their names."""
        for name, text in texts.items():
            self.write(f"{name}.glsl", text)

    def sketch(self, body: str, *, size: str = "size = 17") -> Sketch:
        """Load a sketch; ``body`` follows format and size. Its view is a map of its last pass."""
        return load(self.write("sketch.toml", f"format = 1\n{size}\n{body}"))

    def one(self, kernel: str, *, size: str = "size = 17", more: str = "") -> Sketch:
        """Load a sketch of one kernel in a pass named ``a``."""
        self.write("one.glsl", kernel)
        return self.sketch(f'[[pass]]\nname = "a"\nuse = "./one"\n{more}', size=size)


def on_both_kinds(
    any_engine: Engine, monkeypatch: pytest.MonkeyPatch, sketch: Sketch, texture: str
) -> list[np.ndarray]:
    """Return a texture as it is made on what passes for a software renderer, and for a GPU."""
    arrays = []
    for software in (True, False):
        monkeypatch.setattr(ContextInfo, "software", software)
        with Engine(any_engine.ctx) as engine:
            arrays.append(engine.read(sketch, texture))
    return arrays


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    """Give an empty folder for a sketch."""
    return Folder(tmp_path)


@pytest.fixture
def compute_engine(any_engine: Engine) -> Engine:
    """Give an engine that chooses its drivers itself, where there are compute shaders."""
    if not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")
    return any_engine

"""The empty sketch that ``new`` writes is what the first lesson begins with."""

from __future__ import annotations

import tomllib
from pathlib import Path

from playground.course.tasks import EXERCISES
from playground.engine.engine import Engine
from playground.paths import SKETCHES
from playground.sketch.load import load
from playground.sketch.templates import make_sketch


def test_empty_template_matches_first_lesson_and_start_kernel(engine: Engine, tmp_path: Path) -> None:
    made = make_sketch(tmp_path / "first", empty=True)
    assert sorted(path.name for path in made.iterdir()) == ["height.glsl", "sketch.toml"]
    assert (made / "height.glsl").read_bytes() == (EXERCISES / "first_height/empty.glsl").read_bytes()
    assert not engine.read(load(made), "height").any()
    own, shipped = (
        tomllib.loads(path.read_text()) for path in (made / "sketch.toml", SKETCHES / "first_height.toml")
    )
    assert own["pass"][0].pop("use") == "./height"
    assert shipped["pass"][0].pop("use") == "generation/first_height"
    assert own.pop("title") == "First" and shipped.pop("title")
    assert "main" not in own and shipped.pop("main")  # the kernel begins without parameters
    assert own["shot"][0].pop("name") and shipped["shot"][0].pop("name")
    assert own == shipped

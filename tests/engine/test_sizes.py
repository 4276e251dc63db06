"""Sizes as a sketch writes them: of passes, of what feeds an input, and of fast variants."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..loading import load
from ..sketch_texts import map_of, passes

TERRAIN = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.x + 100 * texel.y); }
"""
ROWS = """#pragma kernel(output = "rows:r32f")
uniform sampler2D height; //! input
float kernel(ivec2 texel) {
    float total = 0.0;
    for (int x = 0; x < textureSize(height, 0).x; x++) total += texelFetch(height, ivec2(x, texel.y), 0).r;
    return total;
}
"""
ALL = """#pragma kernel(output = "total:r32f")
uniform sampler2D rows; //! input
float kernel(ivec2 texel) {
    float total = 0.0;
    for (int y = 0; y < textureSize(rows, 0).y; y++) total += texelFetch(rows, ivec2(0, y), 0).r;
    return total;
}
"""
SUM = (
    passes(rows=("./rows", 'size = [1, "height.size.y"]'), total=("./all", "size = 1"))
    + '[inputs]\nheight = "rows.height"\n'
)
VARIANT = """// The same sum at once.
#pragma compute(groups = "1, 1", local = "1, 1")
uniform sampler2D height; //! input
void main() {
    ivec2 whole = textureSize(height, 0);
    float total = 0.0;
    for (int y = 0; y < whole.y; y++) {
        for (int x = 0; x < whole.x; x++) total += texelFetch(height, ivec2(x, y), 0).r;
    }
    imageStore(out_total, ivec2(0), vec4(total));
}
"""
SKETCH = (
    "format = 1\nsize = [17, 9]\n"
    + passes(
        terrain=("./terrain", 'size = ["size.x // 2", "size.y + 3"]'),
        sum=("./sum", 'inputs = { height = "terrain" }'),
    )
    + map_of("sum")
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in {"terrain.glsl": TERRAIN, "rows.glsl": ROWS, "all.glsl": ALL, "sum.toml": SUM}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


def total(engine: Engine, folder: Path) -> float:
    terrain = engine.read(load(folder), "terrain")
    assert terrain.shape == (12, 8)
    return float(terrain.astype(np.float64).sum())


def test_an_expression_names_the_size_of_what_feeds_an_input(engine: Engine, folder: Path):
    sketch = load(folder)
    assert engine.read(sketch, "sum.rows").shape == (12, 1)
    result = engine.read(sketch, "sum")
    assert result.shape == (1, 1)
    assert float(result[0, 0]) == total(engine, folder)


@pytest.mark.usefixtures("trusted_variants")
def test_compute_variant_has_size_of_replaced_pass(engine: Engine, folder: Path):
    (folder / "sum.comp").write_text(VARIANT, encoding="utf-8")
    sketch = load(folder)
    result = engine.read(sketch, "sum")
    stood_in = engine.driver == "compute"
    assert ("sum" in engine.runs) == stood_in
    assert result.shape == (1, 1)
    assert float(result[0, 0]) == total(engine, folder)


@pytest.mark.usefixtures("trusted_variants")
def test_pass_replaced_by_compute_variant_can_still_be_read(engine: Engine, folder: Path):
    (folder / "sum.comp").write_text(VARIANT, encoding="utf-8")
    assert engine.read(load(folder), "sum.rows").shape == (12, 1)


def test_a_size_may_ask_for_compute_shaders(ctx, tmp_path: Path):
    (tmp_path / "flat.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n',
        encoding="utf-8",
    )
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\nuse = "./flat"\nsize = "17 if compute else 9"\n',
        encoding="utf-8",
    )
    for driver in ("fragment", "auto"):
        notices: list[str] = []
        with Engine(ctx, driver=driver, notice=notices.append) as engine:
            has = engine.info.compute and driver != "fragment"
            for _ in range(2):
                assert engine.read(load(tmp_path), "height").shape == ((17, 17) if has else (9, 9))
        assert len(notices) == (0 if has else 1)
        assert has or notices[0].startswith(
            "the sketch does without compute shaders, which are not here: see "
        )

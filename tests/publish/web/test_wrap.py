"""A page makes stages by the engine's recipes; of shipped sketches, see test_page_data.py."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.paths import GLSL
from playground.publish.web.kernels import stage_data
from playground.shader.source import read_source
from playground.shader.stage_recipe import Recipe, StagePart
from playground.shader.wrap import FRAGMENT, recipes_of

from ...cases import each
from .node import Node
from .texts import kernels, shared_files


def made(node: Node, recipe: Recipe, folder: Path, file: str) -> dict[str, object]:
    script = """async (stage, shared, file, load) => (await load("kernel_texts.js")).stageText(
      stage, (await load("source.js")).flatten(shared, file))"""
    values = node.run(script, stage_data(recipe), shared_files(folder, "./"), file)
    assert isinstance(values, dict)
    return values


@pytest.mark.slow
def test_every_program_of_the_library(node: Node):
    script = """async (stages, shared, load) => {
      const { stageText } = await load("kernel_texts.js"), { flatten } = await load("source.js");
      return stages.map(([stage, file]) => stageText(stage, flatten(shared, file)));
    }"""
    recipes = [
        (name, recipe)
        for name, kernel in kernels().items()
        for recipe in recipes_of(kernel, FRAGMENT)[1].values()
    ]
    shared = shared_files(GLSL)
    result = node.run(script, [(stage_data(recipe), name) for name, recipe in recipes], shared)
    for (name, recipe), stage in zip(recipes, result, strict=True):
        text, first = recipe.make()
        assert stage == {"text": text, "first": first}, name


TEXT = """// a

#version 330
int texelFetchOffset; vec4 vertex(vec3 a,
 out vec3 b) {
 if (a) { }
}
int after;
"""


@each(
    "how",
    [
        {},
        {"before": (StagePart("x"), StagePart("y\ny", ("after", "none")), StagePart("z", ("none",)))},
        {"before": (StagePart("#version 330"),), "after": "int last;\n"},
        {"without": "vertex"},
        {"without": "fragment"},
        {"replaced": (("texelFetch", "k_fetch_in"), ("after", "k_aft"))},
        {"replaced": (("texelFetchOffset", "k_fetch_in_shift"),), "without": "vertex"},
        {"keeps_version": True},
        {"text": "#version 330\nvoid main() {}\n"},
    ],
)
def test_each_way_to_make_a_stage(node: Node, tmp_path: Path, how: dict[str, object]):
    file = tmp_path / f"{abs(hash(str(how)))}.glsl"
    file.write_text(TEXT)
    recipe = Recipe(read_source(file, []), **how)
    text, first = recipe.make()
    assert made(node, recipe, tmp_path, f"./{file.name}") == {"text": text, "first": first}


@pytest.mark.parametrize("text", ["vec4 vertex(vec3 a) { {", "vec4 vertex(vec3 a) { } }", "vertex() {}", ""])
def test_a_function_that_does_not_end_is_blanked_to_the_end(node: Node, tmp_path: Path, text: str):
    (tmp_path / "a.glsl").write_text(f"int b;\n{text}\nint c;\n")
    recipe = Recipe(read_source(tmp_path / "a.glsl", []), without="vertex")
    assert made(node, recipe, tmp_path, "./a.glsl")["text"] == recipe.make()[0]

"""A loop whose sizes and counts follow its iteration gives what its levels give as passes written one by one.

The truth is the same sketch with a pass for each level, of the size that a person would work out.
"""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.plan import PlanRequest
from playground.engine.planner import make_plan, repeats_of
from playground.errors import PlaygroundError

# What it reads, as a fraction of the terrain, its own size, and where it is in the loop.
GROW = """#pragma kernel(output = "ground:r32f")
uniform sampler2D ground_before; //! input("black")
uniform float rise = 1.0;        //! slider(0, 10)
float kernel(ivec2 texel) {
    ivec2 from = textureSize(ground_before, 0);
    ivec2 near = ivec2(floor(vec2(texel) * vec2(from - 1) / vec2(max(size - 1, 1)) + 0.5));
    return texelFetch(ground_before, near, 0).r * 3.0 + rise * float((texel.x * 5 + texel.y * 3) % 7)
        + 0.125 * float(size.x) + 0.0625 * float(size.y) + spacing.x / 1024.0;
}
"""
SMOOTH = """#pragma kernel(output = "ground:r32f")
uniform sampler2D ground_before; //! input
float kernel(ivec2 texel) {
    float sum = 0.0;
    for (int i = -1; i <= 1; i++)
        sum += texelFetch(ground_before, clamp(texel + ivec2(i, 0), ivec2(0), size - 1), 0).r;
    return sum / 3.0 + 0.5;
}
"""
STILL = """#pragma kernel(output = "still:r32f")
float kernel(ivec2 texel) { return float(texel.x); }
"""
START = """#pragma kernel(output = "ground:r32f")
uniform float level = 2.0; //! slider(0, 10)
float kernel(ivec2 texel) { return level * float(texel.x - texel.y); }
"""
COARSE = '"(size.x - 1) // 2 ** (iterations - 1 - iteration) + 1"'
LOOP = f"""
[[pass]]
name = "start"
use = "./start"
[[pass]]
name = "a"
use = "./grow"
inputs = {{ ground_before = "start" }}
repeat = 4
size = {COARSE}
feedback = {{ ground_before = "ground" }}
"""


def by_hand(sides: list[int], use: str = "./grow") -> str:
    text, before = '\n[[pass]]\nname = "start"\nuse = "./start"\n', "start"
    for number, side in enumerate(sides):
        text += f'[[pass]]\nname = "level{number}"\nuse = "{use}"\nsize = {side}\n'
        text += f'inputs = {{ ground_before = "{before}" }}\n'
        before = f"level{number}"
    return text


@pytest.fixture
def levels(folder):
    for name, text in {"grow": GROW, "smooth": SMOOTH, "still": STILL, "start": START}.items():
        folder.write(f"{name}.glsl", text)
    folder.write(
        "one.toml",
        '[[pass]]\nname = "grow"\nuse = "./grow"\n'
        '[[pass]]\nname = "smooth"\nuse = "./smooth"\nrepeat = "REPEAT"\n'
        'inputs = { ground_before = "grow" }\nfeedback = { ground_before = "ground" }\n'
        '[inputs]\nground_before = "grow.ground_before"\n[outputs]\nground = "smooth:ground"\n'.replace(
            "REPEAT", "5 if iteration == 0 else iterations - iteration"
        ),
    )
    return folder


def test_each_level_has_its_size_and_reads_coarser_texture(engine, levels):
    result = engine.read(levels.sketch(LOOP, size="size = 33"), "a")
    hand = engine.read(levels.sketch(by_hand([5, 9, 17, 33]), size="size = 33"), "level3")
    assert result.shape == (33, 33)
    np.testing.assert_array_equal(result, hand)


def test_sizes_may_differ_along_the_axes(engine, levels):
    both = '["2 + 3 * iteration", "(size.y - 1) // 2 ** (iterations - 1 - iteration) + 1"]'
    result = engine.read(levels.sketch(LOOP.replace(COARSE, both)), "a")
    hand = by_hand([0, 1, 2, 3])
    for number, size in enumerate(([2, 3], [5, 5], [8, 9], [11, 17])):
        hand = hand.replace(f"size = {number}\n", f"size = {size}\n")
    np.testing.assert_array_equal(result, engine.read(levels.sketch(hand), "level3"))


@pytest.mark.parametrize("steps", [1, 2, 3])
def test_stopped_early_it_leaves_the_smaller_texture(engine, levels, steps):
    sides = [5, 9, 17, 33][:steps]
    sketch = levels.sketch(LOOP, size="size = 33")
    result = engine.read(sketch, "a", steps={"a": steps})
    hand = engine.read(levels.sketch(by_hand(sides), size="size = 33"), f"level{steps - 1}")
    np.testing.assert_array_equal(result, hand)


def test_steps_yield_every_level_and_run_each_once(engine, levels):
    sketch = levels.sketch(LOOP, size="size = 33")
    assert [values.shape[0] for _, values in engine.steps(sketch, "a")] == [5, 5, 9, 17, 33]
    assert engine.runs["a"] == 4
    before = next(iter(engine.steps(sketch, "a")))[1]
    y, x = np.round(np.mgrid[0:5, 0:5] * 8)
    assert before.shape == (5, 5) and (np.abs(before - 2.0 * (x - y)) <= 2.0 * 8).all()


def test_a_technique_in_the_loop_has_its_sizes_and_counts(engine, levels):
    sketch = levels.sketch(LOOP.replace("./grow", "./one"), size="size = 33")
    result = engine.read(sketch, "a")
    hand, before = '\n[[pass]]\nname = "start"\nuse = "./start"\n', "start"
    for number, (side, count) in enumerate([(5, 5), (9, 3), (17, 2), (33, 1)]):
        hand += f'[[pass]]\nname = "g{number}"\nuse = "./grow"\nsize = {side}\n'
        hand += f'inputs = {{ ground_before = "{before}" }}\n'
        hand += f'[[pass]]\nname = "s{number}"\nuse = "./smooth"\nsize = {side}\nrepeat = {count}\n'
        hand += f'inputs = {{ ground_before = "g{number}" }}\nfeedback = {{ ground_before = "ground" }}\n'
        before = f"s{number}"
    np.testing.assert_array_equal(result, engine.read(levels.sketch(hand, size="size = 33"), "s3"))
    assert repeats_of(sketch) == {"a": 4, "a.smooth": 5}
    assert [len(v) for _, v in engine.steps(sketch, "a.smooth")] == [33] * 6


def test_the_innermost_loop_gives_the_names(engine, levels):
    levels.write(
        "inner.toml",
        '[[pass]]\nname = "in"\nuse = "./grow"\nrepeat = "iteration + 1"\n'
        'size = "2 ** (iteration + 1) + iterations"\nfeedback = { ground_before = "ground" }\n'
        '[inputs]\nground_before = "in.ground_before"\n',
    )
    sketch = levels.sketch(
        '[[pass]]\nname = "a"\nuse = "./inner"\nrepeat = 3\nfeedback = { ground_before = "ground" }\n'
    )
    sides = [2**j + n for n in (1, 2, 3) for j in range(1, n + 1)]
    hand = by_hand(sides).replace('inputs = { ground_before = "start" }\n', "")
    result = engine.read(sketch, "a")
    assert result.shape == (11, 11)
    np.testing.assert_array_equal(result, engine.read(levels.sketch(hand), f"level{len(sides) - 1}"))


def test_feedback_input_has_size_of_previous_iteration(engine, levels):
    levels.write(
        "twice.toml",
        '[[pass]]\nname = "grow"\nuse = "./grow"\nsize = "2 * ground_before.size.x - 1 + 0 * iteration"\n'
        '[inputs]\nground_before = "grow.ground_before"\n',
    )
    start = '\n[[pass]]\nname = "start"\nuse = "./start"\nsize = 3\n'
    sketch = levels.sketch(
        start + '[[pass]]\nname = "a"\nuse = "./twice"\nrepeat = 3\ninputs = { ground_before = "start" }\n'
        'feedback = { ground_before = "ground" }\n'
    )
    hand = by_hand([5, 9, 17]).replace('use = "./start"\n', 'use = "./start"\nsize = 3\n')
    np.testing.assert_array_equal(engine.read(sketch, "a"), engine.read(levels.sketch(hand), "level2"))


def test_outside_its_size_is_that_of_the_last_iteration(engine, levels):
    after = '[[pass]]\nname = "b"\nuse = "./smooth"\nsize = "a.size.x"\ninputs = { ground_before = "a" }\n'
    sketch = levels.sketch(LOOP.replace("repeat = 4", 'repeat = "3"') + after, size="size = 33")
    assert engine.read(sketch, "b").shape == (33, 33)
    assert engine.read(sketch, "b", steps={"a": 2}).shape == (17, 17)


def test_constant_pass_runs_once_and_resized_pass_each_level(engine, levels):
    levels.write(
        "two.glsl",
        '#pragma kernel(output = "ground:r32f")\nuniform sampler2D ground_before; //! input("black")\n'
        "uniform sampler2D once; //! input\nuniform sampler2D each; //! input\n"
        "float kernel(ivec2 texel) { return texelFetch(ground_before, texel / 2, 0).r"
        " + texelFetch(once, ivec2(6, 0), 0).r + texelFetch(each, size - 1, 0).r; }\n",
    )
    levels.write(
        "both.toml",
        '[[pass]]\nname = "once"\nuse = "./still"\nsize = 7\n[[pass]]\nname = "each"\nuse = "./still"\n'
        '[[pass]]\nname = "two"\nuse = "./two"\ninputs = { once = "once", each = "each" }\n'
        '[inputs]\nground_before = "two.ground_before"\n',
    )
    sketch = levels.sketch(
        f'[[pass]]\nname = "a"\nuse = "./both"\nrepeat = 3\nsize = {COARSE}\n'
        'feedback = { ground_before = "ground" }\n'
    )
    result = engine.read(sketch, "a")
    assert engine.runs == {"a.once": 1, "a.each": 3, "a.two": 3}
    assert result[0, 0] == 3 * 6 + 4 + 8 + 16


def test_only_what_is_stale_runs_again(engine, levels):
    sketch = levels.sketch(LOOP, size="size = 33")
    engine.texture(sketch, "a")
    engine.texture(sketch, "a")
    assert engine.record.ran == []
    changed = sketch.with_values({"a.rise": 2.0})
    result = engine.read(changed, "a").copy()
    assert engine.record.ran == ["a"] * 4
    with Engine(engine.ctx, driver=engine.driver) as fresh:
        np.testing.assert_array_equal(result, fresh.read(changed, "a"))


def test_more_levels_restart_loop_as_first_sizes_differ(engine, levels):
    engine.texture(levels.sketch(LOOP, size="size = 33"), "a")
    more = levels.sketch(LOOP.replace("repeat = 4", "repeat = 5"), size="size = 33")
    result = engine.read(more, "a")
    assert engine.record.ran == ["a"] * 5
    hand = engine.read(levels.sketch(by_hand([3, 5, 9, 17, 33]), size="size = 33"), "level4")
    np.testing.assert_array_equal(result, hand)


def test_a_size_of_a_later_iteration_is_in_the_key(engine, levels):
    result = []
    for side in (9, 8):
        sketch = levels.sketch(LOOP.replace(COARSE, f'"{side} if iteration == 2 else 5"'))
        result.append(engine.read(sketch, "a").copy())
        hand = levels.sketch(by_hand([5, 5, side, 5]))
        np.testing.assert_array_equal(result[-1], engine.read(hand, "level3"))
    assert not np.array_equal(*result)


def test_a_value_that_a_size_names_makes_the_plan_anew(engine, levels):
    levels.write(
        "sized.glsl",
        GROW.replace("uniform float rise", "uniform int side = 3; //! slider(1, 9)\nuniform float rise"),
    )
    loop = LOOP.replace("./grow", "./sized").replace(COARSE, '"a.side + 2 * iteration"')
    sketch = levels.sketch(loop)
    assert engine.read(sketch, "a").shape == (9, 9)
    assert engine.read(sketch.with_values({"a.side": 5}), "a").shape == (11, 11)


def test_a_loop_of_no_iteration_has_the_size_of_the_only_one(engine, levels):
    sketch = levels.sketch(LOOP.replace("repeat = 4", "repeat = 0"))
    assert engine.read(sketch, "a").shape == (17, 17)


def test_one_plan_has_one_step_for_one_size(levels):
    sketch = levels.sketch(LOOP.replace(COARSE, '"5 if iteration < 3 else 9"'))
    loop = make_plan(sketch, PlanRequest(frame_size=(9, 9))).node("a")
    assert [body[0].size for body in loop.bodies] == [(5, 5)] * 3 + [(9, 9)]
    assert loop.bodies[0] is loop.bodies[1] is loop.bodies[2]
    assert loop.body is loop.bodies[3]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            '[[pass]]\nname = "a"\nuse = "./start"\nsize = "2 + iteration"\n',
            "pass 'a': size names 'iteration', which is for the size of a pass with a repeat "
            "and for the passes inside it",
        ),
        (
            LOOP.replace("repeat = 4", 'repeat = "iterations"'),
            "pass 'a': repeat names 'iterations', which is for the size of a pass with a repeat "
            "and for the passes inside it",
        ),
        (
            LOOP.replace(COARSE, '"2 - iteration"'),
            "pass 'a': size 0 x 0 in iteration 2; 1 to 16384 a side were expected",
        ),
        (
            LOOP.replace(COARSE, '"size.x + iteratoin"'),
            "pass 'a': size: 'size.x + iteratoin' names 'iteratoin', which is not known here; "
            "did you mean 'iteration'?",
        ),
        (
            LOOP.replace("repeat = 4", "repeat = 5000"),
            "pass 'a': repeat '5000' gives 5000; 0 to 1024 were expected where a size or a repeat inside "
            "names the iteration",
        ),
    ],
)
def test_mistakes_are_said_in_a_sentence(levels, text, sentence):
    with pytest.raises(PlaygroundError) as caught:
        make_plan(levels.sketch(text), PlanRequest(frame_size=(9, 9)))
    assert caught.value.diagnostics[0].message == sentence


def test_a_technique_outside_any_loop_is_in_iteration_0_of_1(engine, levels):
    sketch = levels.sketch('[[pass]]\nname = "a"\nuse = "./one"\n')
    assert repeats_of(sketch) == {"a.smooth": 5}
    assert engine.read(sketch, "a").shape == (17, 17)


def test_a_parameter_of_that_name_comes_before_the_loop(engine, levels):
    levels.write(
        "named.toml",
        '[[pass]]\nname = "grow"\nuse = "./grow"\nsize = "iterations + 2"\n'
        '[parameters]\niterations = "grow.rise"\n[inputs]\nground_before = "grow.ground_before"\n',
    )
    sketch = levels.sketch(
        '[[pass]]\nname = "a"\nuse = "./named"\nrepeat = 3\nfeedback = { ground_before = "ground" }\n'
        "set = { iterations = 5 }\n"
    )
    assert engine.read(sketch, "a").shape == (7, 7)

"""A ``.comp`` beside a kernel or a technique gives the same answer, where there is compute.

Which of them may run, ``test_fast_variants`` says.
"""

from __future__ import annotations

import numpy as np
import pytest

from playground.engine.compute_variant import RECENT
from playground.engine.engine import Engine
from playground.engine.software import Software
from playground.errors import PlaygroundError

from ..sketch_texts import passes

pytestmark = pytest.mark.usefixtures("trusted_variants")

SUMS = """#pragma kernel(output = "sums:r32f", repeat = "log2(size.x)")
uniform sampler2D values; //! input
uniform float scale = 1.0; //! slider(0, 10)
float kernel(ivec2 texel) {
    // Sums of all to the west, in doubling steps: the first iteration reads the values.
    int reach = 1 << iteration;
    float here = iteration == 0 ? texelFetch(values, texel, 0).r * scale : previous(texel);
    ivec2 west = texel - ivec2(reach, 0);
    float there = west.x < 0 ? 0.0 : iteration == 0 ? texelFetch(values, west, 0).r * scale : previous(west);
    return here + there;
}
"""
SWEEP = """#pragma compute(groups = "1, size.y", local = "1, 1")
uniform sampler2D values; //! input
uniform float scale = 1.0; //! slider(0, 10)
void main() {
    float sum = 0.0;
    int y = int(gl_GlobalInvocationID.y);
    for (int x = 0; x < size.x; x++) {
        sum += texelFetch(values, ivec2(x, y), 0).r * scale;
        imageStore(out_sums, ivec2(x, y), vec4(sum));
    }
}
"""
VALUES = """#pragma kernel(output = "values:r32f")
float kernel(ivec2 texel) { return float((texel.x * 3 + texel.y * 5) % 8); }
"""
BODY = "\n" + passes(values="./values", sums="./sums")


def truth(scale: float = 1.0) -> np.ndarray:
    y, x = np.mgrid[0:16, 0:16]
    return np.cumsum(((x * 3 + y * 5) % 8).astype(np.float64), axis=1) * scale


@pytest.fixture
def sums(folder):
    folder.write("values.glsl", VALUES)
    folder.write("sums.glsl", SUMS)
    folder.write("sums.comp", SWEEP)
    return folder.sketch(BODY, size="size = 16")


@pytest.fixture
def ran(monkeypatch):
    """List the files whose programs are requested."""
    from playground.engine.programs import Programs

    requested: list[str] = []
    get = Programs.get

    def spy(self, kernel, driver, choices=()):
        requested.append(kernel.path.rpartition("/")[2])
        return get(self, kernel, driver, choices)

    monkeypatch.setattr(Programs, "get", spy)
    return requested


@pytest.mark.parametrize("driver", ["auto", "compute", "fragment"])
def test_it_runs_where_there_is_compute_and_agrees(ctx, sums, ran, driver):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver=driver) as engine:
        for scale in (1.0, 2.0):
            result = engine.read(sums.with_values({"sums.scale": scale}), "sums")
            np.testing.assert_allclose(result, truth(scale), rtol=1e-6)
        assert ("sums.comp" in ran) == (driver != "fragment")
        assert ("sums.glsl" in ran) == (driver == "fragment")
        assert engine.runs["sums"] == 2


def test_its_iterations_are_shown_by_the_kernel(any_engine, sums, ran):
    result = any_engine.read(sums, "sums", steps={"sums": 1})
    west = np.pad(truth()[:, :-1], ((0, 0), (1, 0)))
    values = truth() - west
    np.testing.assert_allclose(result, values + np.pad(values[:, :-1], ((0, 0), (1, 0))))
    assert "sums.comp" not in ran
    assert len(list(any_engine.steps(sums, "sums"))) == 5


def test_a_changed_variant_is_stale_and_so_is_a_removed_one(compute_engine, folder, sums):
    compute_engine.texture(sums, "sums")
    folder.write("sums.comp", SWEEP.replace("vec4(sum)", "vec4(sum * 2.0)"))
    np.testing.assert_allclose(compute_engine.read(folder.sketch(BODY, size="size = 16"), "sums"), truth(2.0))
    (folder.path / "sums.comp").unlink()
    np.testing.assert_allclose(compute_engine.read(folder.sketch(BODY, size="size = 16"), "sums"), truth())


def test_a_start_that_it_knows_nothing_of_keeps_it_out(any_engine, folder, sums, ran):
    folder.write("sums.glsl", SUMS.replace("iteration == 0", "false"))
    wired = BODY + 'inputs = { initial = "values", values = "values" }\n'
    result = any_engine.read(folder.sketch(wired, size="size = 16"), "sums")
    np.testing.assert_allclose(result, truth(), rtol=1e-6)
    assert "sums.comp" not in ran


GRAPH = (
    "\n"
    + passes(doubled="./doubled", add="./add")
    + """[inputs]
values = ["doubled.values", "add.values"]
[parameters]
scale = ["doubled.scale", "add.scale"]
[outputs]
sum = "add:sum"
"""
)
DOUBLED = """#pragma kernel(output = "doubled:r32f")
uniform sampler2D values; //! input
uniform float scale = 1.0; //! slider(0, 10)
float kernel(ivec2 texel) { return 2.0 * scale * texelFetch(values, texel, 0).r; }
"""
ADD = """#pragma kernel(output = "sum:r32f")
uniform sampler2D values;  //! input
uniform sampler2D doubled; //! input
uniform float scale = 1.0; //! slider(0, 10)
float kernel(ivec2 texel) { return texelFetch(doubled, texel, 0).r + scale * texelFetch(values, texel, 0).r; }
"""
TRIPLE_HEAD = (
    '#pragma compute(groups = "size.x / 4, size.y / 2", local = "4, 2", repeat = "3", '
    'buffers = "kept:float:size.x * size.y; marks:vec4:1")'
)
TRIPLE = """
uniform sampler2D values; //! input
uniform float scale = 1.0; //! slider(0, 10)
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    int place = texel.y * size.x + texel.x;
    if (iteration == 0 && marks[0] != vec4(0.0)) kept[place] = 1e9;  // buffers begin as zeros
    kept[place] += scale * texelFetch(values, texel, 0).r;
    vec4 before = imageLoad(out_sum, texel);
    imageStore(out_sum, texel, vec4(before.r + (iteration == iterations - 1 ? kept[place] : 0.0)));
}
"""


def test_one_next_to_a_technique_replaces_all_of_it(ctx, folder):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    folder.kernels(values=VALUES, doubled=DOUBLED, add=ADD)
    folder.write("triple.toml", GRAPH)
    folder.write("triple.comp", TRIPLE_HEAD + TRIPLE)
    body = '[[pass]]\nname = "values"\nuse = "./values"\n[[pass]]\nname = "t"\nuse = "./triple"\n'
    sketch = folder.sketch(body, size="size = 16").with_values({"t.scale": 2.0})
    with Engine(ctx, driver="fragment") as slow, Engine(ctx) as fast:
        np.testing.assert_array_equal(slow.read(sketch, "t"), fast.read(sketch, "t"))
        assert slow.read(sketch, "t").max() == 2 * 3 * 7
        assert set(slow.runs) == {"values", "t.doubled", "t.add"}
        assert set(fast.runs) == {"values", "t"}
        for _ in range(3):
            fast.cache.clear()
            np.testing.assert_array_equal(
                slow.read(sketch, "t"), fast.read(sketch, "t"), "nothing is left over"
            )


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ('groups = "1 / 3, 1"', "gives 0.333333"),
        ('groups = "size.x, 1", buffers = "b:vec4:2**40"', "2048 at most"),
        ('groups = "size.x, 1", repeat = "log2(3)"', "power of two"),
    ],
)
def test_a_wrong_expression_names_the_pass(compute_engine, folder, sums, option, message):
    folder.write("sums.comp", SWEEP.replace('groups = "1, size.y", local = "1, 1"', option))
    with pytest.raises(PlaygroundError, match=message):
        compute_engine.read(folder.sketch(BODY, size="size = 16"), "sums")


FILL = """#pragma compute(groups = "size.x, size.y", local = "1, 1", buffers = "work:float:500"OPTION)
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    int at = texel.y * size.x + texel.x;
    work[at] += 1.0;
    imageStore(out_sums, texel, vec4(work[at]));
}
"""
PLAIN_FILL = """#pragma kernel(output = "sums:r32f")
uniform float again = 0.0; //! slider(0, 9)
float kernel(ivec2 texel) { return 1.0 + 0.0 * again; }
"""


def filled(folder, variant: str, size: str = "size = 19"):
    """Return a sketch of PLAIN_FILL with a compute variant."""
    folder.write("fill.glsl", PLAIN_FILL)
    folder.write("fill.comp", variant)
    return folder.sketch(passes(a="./fill"), size=size)


def test_spare_buffer_is_cleared_unless_overwritten(compute_engine, folder):
    """The buffer of the run before is used again, so a variant that adds to it shows what it began with."""
    for option, second in (("", 1.0), (', overwrites = "work"', 2.0)):
        folder.write("fill.glsl", PLAIN_FILL)
        again = "uniform float again = 0.0; //! slider(0, 9)\n"
        text = FILL.replace("OPTION", option).replace(
            "void main() {", f"{again}void main() {{ if (again > 99.0) return;"
        )
        folder.write("fill.comp", text)
        sketch = folder.sketch('[[pass]]\nname = "a"\nuse = "./fill"\n', size="size = 19")
        assert (compute_engine.read(sketch, "a") == 1.0).all()
        assert (compute_engine.read(sketch.with_values({"a.again": 1.0}), "a") == second).all()
        compute_engine.runner.compute_variants.release()


def test_a_spare_buffer_serves_what_needs_a_little_less(compute_engine, folder):
    """19 x 19 numbers, then 18 x 18, and the shader knows of no more; of 12 x 12 too much would be idle."""
    folder.write("fill.glsl", PLAIN_FILL)
    text = FILL.replace("OPTION", "").replace("500", "size.x * size.y")
    folder.write("fill.comp", text.replace("+= 1.0", "+= float(work.length())"))
    spare = compute_engine.runner.compute_variants.spare
    result = []
    for side in (19, 18, 12):
        sketch = folder.sketch('[[pass]]\nname = "a"\nuse = "./fill"\n', size=f"size = {side}")
        assert (compute_engine.read(sketch, "a") == side * side).all()
        result.append([item.buffer.size for item in spare])
    assert result[0] == result[1] == [19 * 19 * 4] and result[2] == [19 * 19 * 4, 12 * 12 * 4]


def test_largest_spare_buffer_over_budget_stays_while_in_use(compute_engine, folder, monkeypatch):
    """A frame's smaller passes do not have it made again each time; once none asks for it, it goes."""
    folder.write("fill.glsl", PLAIN_FILL)
    again = "uniform float again = 0.0; //! slider(0, 9)\n"
    text = FILL.replace("OPTION", "").replace("500", "size.x * size.y")
    folder.write(
        "fill.comp", text.replace("void main() {", f"{again}void main() {{ if (again > 99.0) return;")
    )
    monkeypatch.setattr(compute_engine.runner.pool, "limit", 0)
    spare = compute_engine.runner.compute_variants.spare

    def sizes_after(*sides):
        for number, side in enumerate(sides):
            sketch = folder.sketch('[[pass]]\nname = "a"\nuse = "./fill"\n', size=f"size = {side}")
            compute_engine.read(sketch.with_values({"a.again": number / 9}), "a")
        return [item.buffer.size // 4 for item in spare]

    assert sizes_after(19, 12, 4) == [19 * 19, 4 * 4], "of two the larger stays, and the last run's"
    kept = spare[0].buffer
    assert sizes_after(5, 19, 6) == [19 * 19, 6 * 6] and spare[0].buffer is kept
    assert sizes_after(*[3, 5] * (RECENT // 2 + 1)) == [3 * 3, 5 * 5]


BUFFERED_HEAD = (
    '#pragma compute(groups = "1, size.y", local = "1, 1", overwrites = "sums", '
    'buffers = "sums:float:(size.x + 1) // 2 * 2 * size.y")'
)
BUFFERED = """
uniform sampler2D values; //! input
uniform float scale = 1.0; //! slider(0, 10)
void main() {
    float sum = 0.0;
    int y = int(gl_GlobalInvocationID.y);
    for (int x = 0; x < size.x; x++) {
        sum += texelFetch(values, ivec2(x, y), 0).r * scale;
        sums[y * ((size.x + 1) / 2 * 2) + x] = sum;
    }
}
"""


@pytest.mark.parametrize("size", [16, 17, [5, 3]])
def test_a_buffer_of_an_outputs_name_is_that_output(compute_engine, folder, sums, size):
    """Its rows are filled up to 8 bytes, so those of an odd terrain have a float more."""
    folder.write("sums.glsl", SUMS.replace("log2(size.x)", "5"))
    folder.write("sums.comp", BUFFERED_HEAD + BUFFERED)
    result = compute_engine.read(folder.sketch(BODY, size=f"size = {size}"), "sums")
    nx, ny = size if isinstance(size, list) else (size, size)
    y, x = np.mgrid[0:ny, 0:nx]
    np.testing.assert_array_equal(result, np.cumsum((x * 3 + y * 5) % 8, axis=1))


def test_a_buffer_too_small_for_its_output_has_a_sentence(compute_engine, folder, sums):
    folder.write("sums.comp", BUFFERED_HEAD.replace("2 * 2 *", "2 *") + BUFFERED)
    with pytest.raises(PlaygroundError, match="holds 512 bytes; the output needs 1024"):
        compute_engine.read(folder.sketch(BODY, size="size = 16"), "sums")


STAGES = (
    '#pragma compute(stages = "2, 0, 2, 1", groups = "size.x, size.y", '
    'local = "1, 1", buffers = "work:int:500")'
    """
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    int at = texel.y * size.x + texel.x;
    if (stage == 2) work[at] = 10 * work[at] + 2 + iteration;
    if (stage == 0) work[at] = 10 * work[at] + 9;
    if (stage == 1) imageStore(out_sums, texel, vec4(float(work[at] * iterations)));
}
"""
)


def test_stages_say_what_each_iteration_does(compute_engine, folder):
    sketch = filled(folder, STAGES, "size = 19")
    before = compute_engine.runner.programs.compiled
    for _ in range(2):
        assert (compute_engine.read(sketch, "a") == 4 * 294).all()
        compute_engine.cache.clear()
    made = compute_engine.runner.programs.compiled - before
    assert made == (3 if compute_engine.info.software else 1), "one for each stage, where the processor draws"


def test_a_stage_with_no_groups_is_left_out(compute_engine, folder):
    """As for a step that only larger sizes need."""
    groups = "0 if iteration % 3 == 1 else size.x // 8 + 1, size.y"
    head = f'#pragma compute(stages = "0, 0, 0, 0, 0, 1", groups = "{groups}", local = "8, 1", '
    folder.write("fill.glsl", PLAIN_FILL)
    folder.write(
        "fill.comp",
        head
        + """buffers = "work:float:size.x * size.y")
    void main() {
        ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
        if (texel.x >= size.x) return;
        int at = texel.y * size.x + texel.x;
        if (stage == 0) work[at] = 10.0 * work[at] + float(iteration + 1);
        if (stage == 1) imageStore(out_sums, texel, vec4(work[at]));
    }
    """,
    )
    for side, expected in ((19, 134.0), (3, 134.0)):
        sketch = folder.sketch('[[pass]]\nname = "a"\nuse = "./fill"\n', size=f"size = {side}")
        np.testing.assert_array_equal(compute_engine.read(sketch, "a"), expected)


def test_a_stage_that_comes_back_reads_what_it_read_before(compute_engine, folder):
    constant = '#pragma kernel(output = "value:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
    folder.write("one.glsl", constant.format("1.0"))
    folder.write("hundred.glsl", constant.format("100.0"))
    inputs = "uniform sampler2D one; //! input\nuniform sampler2D hundred; //! input\n"
    folder.write(
        "added.glsl",
        f'#pragma kernel(output = "sum:r32f")\n{inputs}'
        "float of(sampler2D field, ivec2 texel) { return texelFetch(field, texel, 0).r; }\n"
        "float kernel(ivec2 texel) { return 2.0 * of(one, texel) + of(hundred, texel); }\n",
    )
    folder.write(
        "added.comp",
        '#pragma compute(stages = "0, 1, 0", groups = "size.x, size.y", local = "1, 1")\n'
        f"{inputs}"
        """void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    float more = 0.0;
    if (stage == 0) more = texelFetch(one, texel, 0).r;
    if (stage == 1) more = texelFetch(hundred, texel, 0).r;
    imageStore(out_sum, texel, imageLoad(out_sum, texel) + vec4(more));
}
""",
    )
    passes = [("one", "./one"), ("hundred", "./hundred"), ("added", "./added")]
    body = "".join(f'[[pass]]\nname = "{name}"\nuse = "{use}"\n' for name, use in passes)
    sketch = folder.sketch(body, size="size = 8")
    np.testing.assert_array_equal(compute_engine.read(sketch, "added"), 102.0)


READ = """#pragma compute(stages = "0, 1", groups = "(size.x * size.y + 3) // 4, 1", local = "1, 1", \\
                aligned = "4", buffers = "ones:float:size.x * size.y + 3; \\
                pairs:vec2:size.x * size.y // 2 + 2; sums:vec4:(size.x * size.y + 3) // 4")
void main() {
    int at = int(gl_GlobalInvocationID.x);
    for (int i = 0; i < 4 && stage == 0; i++) ones[4 * at + i] = float(4 * at + i);
    for (int i = 0; i < 2 && stage == 0; i++) pairs[2 * at + i] = vec2(100.0, 200.0) * float(2 * at + i);
    if (stage == 0) sums[at] = vec4(0.25);
    if (stage == 0) return;
    vec4 sum = read_sums(at);
    for (int i = 0; i < 4; i++) sum[i] += read_ones(4 * at + i) + read_pairs(2 * at + i / 2)[i % 2];
    sums[at] = sum;
}
"""


@pytest.mark.parametrize("size", [(19, 7), (64, 64)])
@pytest.mark.parametrize("fits", [True, False])
def test_buffers_are_read_by_functions(compute_engine, folder, size, fits, monkeypatch):
    """By textures on a software renderer, where those may be so long; what a step has written is there."""
    tuning = compute_engine.runner.tuning
    if isinstance(tuning, Software) and not fits:
        monkeypatch.setattr(tuning, "max_texels", 16)
    sketch = filled(folder, READ, f"size = {list(size)}")
    at = np.arange(size[0] * size[1])
    expected = (0.25 + at + at // 2 * np.where(at % 2, 200, 100)).reshape(size[::-1])
    for _ in range(2):  # the second time buffers are used again
        np.testing.assert_array_equal(compute_engine.read(sketch, "a"), expected)
        compute_engine.cache.clear()
    if isinstance(tuning, Software):
        assert bool(tuning.buffer_textures) == fits
        tuning.release()


def test_a_variants_own_function_of_such_a_name_is_its_own(compute_engine, folder):
    own = "float read_ones(int place) { return 2.0 * ones[place]; }\nvoid main"
    sketch = filled(folder, READ.replace("void main", own), "size = [19, 7]")
    at = np.arange(19 * 7)
    expected = (0.25 + 2 * at + at // 2 * np.where(at % 2, 200, 100)).reshape(7, 19)
    np.testing.assert_array_equal(compute_engine.read(sketch, "a"), expected)


def test_a_variant_whose_every_step_has_no_groups_is_told(compute_engine, folder):
    """What it would give was never written."""
    folder.write("fill.glsl", PLAIN_FILL)
    folder.write("fill.comp", READ.replace("(size.x * size.y + 3) // 4, 1", "size.x // 64, 1", 1))
    with pytest.raises(PlaygroundError, match="pass 'a': groups of 0 leave out every step at this size"):
        compute_engine.read(
            folder.sketch('[[pass]]\nname = "a"\nuse = "./fill"\n', size="size = [19, 7]"), "a"
        )


ROWS = """#pragma compute(groups = "size.x,size.y", local = "1,1", aligned = "4", buffers = "sums:float:SIZE")
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    sums[texel.y * size.x + texel.x] = float(texel.x + 100 * texel.y);
}
"""


@pytest.mark.parametrize("size", [(19, 7), (2, 3), (64, 64)])
@pytest.mark.parametrize("fours", [1, 2])
def test_rows_of_a_buffer_may_be_whole_fours_or_eights(compute_engine, folder, size, fours):
    """OpenGL itself fills rows up to 8 bytes at most."""
    row = f"(size.x + {4 * fours - 1}) // {4 * fours} * {fours}"
    head = f'#pragma compute(groups = "{row}, size.y", local = "1, 1", aligned = "{16 * fours}", '
    body = f"""buffers = "sums:vec4:{row} * size.y")
    void main() {{
        ivec2 four = ivec2(gl_GlobalInvocationID.xy);
        vec4 x = float(4 * four.x) + vec4(0.0, 1.0, 2.0, 3.0);
        sums[four.y * ({row.replace("//", "/")}) + four.x] = x + 100.0 * float(four.y);
    }}
    """
    sketch = filled(folder, head + body, f"size = {list(size)}")
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    np.testing.assert_array_equal(compute_engine.read(sketch, "a"), x + 100 * y)


IN_PLACE = """#pragma compute(groups = "size.x * size.y, 1", local = "1, 1", aligned = "4", \\
                buffers = "held:float:size.x * size.y", in_place = "held", overwrites = "more, held")
uniform sampler2D values; //! input
void main() {
    int at = int(gl_GlobalInvocationID.x);
    held[at] = matches_values ? held[at] + 100.0 : float(textureSize(values, 0).x);
}
"""
PLUS = """#pragma kernel(output = "more:r32f")
uniform sampler2D values; //! input
float kernel(ivec2 texel) {
    return matches_values ? texelFetch(values, texel, 0).r + 100.0 : float(textureSize(values, 0).x);
}
"""
NUMBERS = """#pragma kernel(output = "values:FORM")
KIND kernel(ivec2 texel) { return KIND(vec4(float((texel.x + 2 * texel.y) % 5) / 5.0, 9.0, 9.0, 9.0)); }
"""


def in_place(folder, values=VALUES, plus=IN_PLACE, size=""):
    folder.write("values.glsl", values)
    folder.write("plus.glsl", PLUS)
    folder.write("plus.comp", plus)
    body = passes(values=("./values", size), a="./plus")
    return folder.sketch("\n" + body, size="size = [19, 7]")


@pytest.mark.parametrize(
    ("form", "kind"), [("r32f", "float"), ("rgba32f", "vec4"), ("rg16f", "vec2"), ("r8", "float")]
)
def test_a_buffer_may_begin_as_the_input_and_end_as_the_output(any_engine, folder, ran, form, kind):
    """Of an input in another format too, whose numbers become the output's."""
    sketch = in_place(folder, NUMBERS.replace("FORM", form).replace("KIND", kind))
    result = any_engine.read(sketch, "a")
    assert ("plus.comp" in ran) == any_engine.info.compute
    values = any_engine.read(sketch, "values").reshape(7, 19, -1)[..., 0]
    np.testing.assert_array_equal(result, values + np.float32(100))
    assert np.ptp(result) > 0.7


def test_a_buffer_does_not_begin_as_an_input_of_another_size(any_engine, folder):
    assert (any_engine.read(in_place(folder, size="size = [5, 4]"), "a") == 5.0).all()


@pytest.mark.parametrize("size", [(19, 7), (2, 3), (64, 64)])
def test_a_buffer_may_be_an_output(compute_engine, folder, size):
    sketch = filled(folder, ROWS.replace("SIZE", "size.x * size.y"), f"size = {list(size)}")
    y, x = np.mgrid[0 : size[1], 0 : size[0]]
    np.testing.assert_array_equal(compute_engine.read(sketch, "a"), x + 100 * y)


def test_technique_variant_accepts_sizes_of_its_technique(any_engine, folder):
    folder.write("values.glsl", VALUES)
    folder.write("doubled.glsl", DOUBLED)
    folder.write("add.glsl", ADD.replace('"sum:r32f"', '"sum:r32f", accepts = "2**n"'))
    folder.write("triple.toml", GRAPH)
    folder.write("triple.comp", TRIPLE_HEAD + TRIPLE)
    body = '[[pass]]\nname = "values"\nuse = "./values"\n[[pass]]\nname = "t"\nuse = "./triple"\n'
    any_engine.read(folder.sketch(body, size="size = 16"), "t")
    with pytest.raises(PlaygroundError, match="not 20 x 20; the nearest it takes: 16 x 16 or 32 x 32"):
        any_engine.read(folder.sketch(body, size="size = 20"), "t")


LEFT = """#pragma compute(groups = "1, 1", local = "1, 1", repeat = "1000000", active = "left", \\
                aligned = "4", \\
                buffers = "plus:float:size.x * size.y; ran:uint:1; left:uint:2")
void main() {
    if (iteration == 0) left[1] = 100u;
    else if (left[1] > 0u) left[1]--;
    ran[0]++;
    if (iteration < iterations - 1) return;
    for (int k = 0; k < size.x * size.y; k++) plus[k] = float(ran[0]);
}
"""


def left(folder, text=LEFT):
    folder.write("fill.glsl", PLAIN_FILL.replace("sums", "plus"))
    folder.write("fill.comp", text)
    return folder.sketch('[[pass]]\nname = "a"\nuse = "./fill"\n', size="size = 4")


def test_with_nothing_left_to_do_only_the_last_step_runs(compute_engine, folder, ran):
    """101 steps until nothing is left; that is noticed within their root of them, and one step ends it."""
    result = compute_engine.read(left(folder), "a")
    assert (result == result[0, 0]).all()
    assert 102 <= result[0, 0] <= 101 + 11 + 1


@pytest.mark.parametrize(
    ("variant", "old", "new", "message"),
    [
        (FILL, "OPTION", ', overwrites = "wrok"', "no output or buffer 'wrok'; did you mean 'work'"),
        (STAGES, '2, 1"', '2, 1", repeat = "4"', "leave repeat out"),
        (STAGES, '2, 1"', '2, 1, x"', "whole numbers separated by commas"),
        (IN_PLACE, 'in_place = "held"', 'in_place = "hold"', "no buffer 'hold'; did you mean 'held'"),
        (IN_PLACE, "uniform sampler2D values; //! input\n", "", "no input that the buffer could begin as"),
        (IN_PLACE, "held:float", "held:int", "a buffer of int cannot be the output more:r32f"),
        (ROWS, "float:SIZE", "int:9", "a buffer of int cannot be the output sums:r32f"),
        (ROWS, "float:SIZE", "vec2:9", "a buffer of vec2 cannot be the output sums:r32f"),
        (ROWS.replace("sums", "thin"), "SIZE", "size.x * size.y", "cannot be the output thin:r16f"),
        (LEFT, 'active = "left"', 'active = "lift"', "active: no buffer 'lift'; did you mean 'left'"),
        (LEFT, 'repeat = "1000000", ', "", "active says when a repeat may end"),
    ],
)
def test_a_wrong_header_of_a_variant_is_refused(folder, variant, old, new, message):
    outputs = {FILL: "sums", STAGES: "sums", ROWS: "sums", LEFT: "plus"}
    kernel = PLUS if variant is IN_PLACE else PLAIN_FILL.replace("sums", outputs.get(variant, "thin"))
    folder.write("fill.glsl", kernel.replace("thin:r32f", "thin:r16f"))
    folder.write("fill.comp", variant.replace(old, new))
    with pytest.raises(PlaygroundError, match=message):
        folder.sketch(passes(a="./fill"))

"""A fast variant runs only while both texts are those that were found to agree, and an edit always shows."""

from __future__ import annotations

import json

import numpy as np
import pytest

from playground.api import headless
from playground.engine.engine import Engine
from playground.errors import PlainFormWarning, PlaygroundError, SketchError
from playground.sketch.flatten import omitted
from playground.sketch.model import VARIANTS, Sketch
from playground.sketch.variants import NAME, unverified
from playground.verify.variants import recorded, subjects, verify

from ..loading import load
from ..sketch_texts import passes
from ..variants import trust

HILL = """\
#include "rise.glsl"
#pragma kernel(output = "height:r32f", repeat = "4")
uniform float scale = 1.0; //! slider(0, 4) How high
float kernel(ivec2 texel) { return previous(texel) + scale * rise_of(texel.x); }
"""
RISE = "// rise.glsl -- how far the terrain rises.\nfloat rise_of(int x) { return 0.25 * float(x); }\n"
COMPUTE = """\
#pragma compute(groups = "size.x, size.y", local = "1, 1", agrees = "1e-5")
uniform float scale = 1.0; //! slider(0, 4) How high
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    imageStore(out_height, texel, vec4(scale * float(texel.x)));
}
"""
PASSES = (
    'agrees = "1e-5"\n' + passes(part="./part", height="./twice") + '[parameters]\nscale = "part.scale"\n'
)
HALF = """\
#pragma kernel(output = "part:r32f")
uniform float scale = 1.0; //! slider(0, 4) How high
float kernel(ivec2 texel) { return 0.5 * scale * float(texel.x); }
"""
TWICE = """\
#pragma kernel(output = "height:r32f")
uniform sampler2D part; //! input
float kernel(ivec2 texel) { return 2.0 * texelFetch(part, texel, 0).r; }
"""
BODY = '[[pass]]\nname = "h"\nuse = "./hill"\n'
NESTED = '[[pass]]\nname = "h"\nuse = "./around"\n'
AROUND = '[[pass]]\nname = "hill"\nuse = "./hill"\n'


@pytest.fixture(params=["compute", "passes"])
def kind(request, ctx):
    if request.param == "compute" and ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    return request.param


@pytest.fixture
def hill(folder, kind):
    """A kernel with a fast variant of one kind, verified."""
    folder.write("hill.glsl", HILL)
    folder.write("rise.glsl", RISE)
    folder.write("part.glsl", HALF)
    folder.write("twice.glsl", TWICE)
    folder.write(
        "hill.comp" if kind == "compute" else "hill.fast.toml", COMPUTE if kind == "compute" else PASSES
    )
    trust(folder.path)
    return folder


@pytest.fixture
def drawing(ctx):
    """An engine, and the sentences that it says."""
    sentences: list[str] = []
    with Engine(ctx, notice=sentences.append) as engine:
        yield engine, sentences


def slopes(scale=1.0):
    return np.broadcast_to(np.arange(17) * np.float32(scale), (17, 17))


def ran_fast(engine: Engine) -> bool:
    return any(step.kernel.kind == "compute" or ".fast." in step.path for step in engine.record.plan.walk())


def test_a_verified_variant_runs_and_says_nothing(drawing, hill):
    engine, sentences = drawing
    for scale in (1.0, 3.0):
        sketch = hill.sketch(BODY).with_values({"h.scale": scale})
        np.testing.assert_allclose(engine.read(sketch, "h"), slopes(scale), atol=1e-5)
        assert ran_fast(engine)
    assert sentences == []


@pytest.mark.parametrize("around", [False, True], ids=["alone", "inside"])
def test_wired_input_missing_in_variant_runs_canonical_form(drawing, hill, kind, around):
    """A variant would leave out what is wired: of the inputs it may have fewer."""
    more = HALF.replace("float kernel", 'uniform sampler2D more;  //! input("black")\nfloat kernel')
    hill.write("part.glsl", more.replace("return", "return 4.0 * texelFetch(more, texel, 0).r +"))
    hill.write("both.toml", PASSES.partition("\n")[2] + '[inputs]\nmore = "part.more"\n')
    ending = ".comp" if kind == "compute" else ".fast.toml"
    (hill.path / f"hill{ending}").rename(hill.path / f"both{ending}")
    hill.write("one.glsl", '#pragma kernel(output = "one:r32f")\nfloat kernel(ivec2 texel) { return 1.0; }\n')
    hill.write("around.toml", '[[pass]]\nname = "hill"\nuse = "./both"\n[inputs]\nmore = "hill.more"\n')
    trust(hill.path)
    engine, sentences = drawing
    body = '[[pass]]\nname = "one"\nuse = "./one"\n[[pass]]\nname = "h"\nuse = "./both"\n'
    body = body.replace("./both", "./around") if around else body
    plain = hill.sketch(body)
    np.testing.assert_array_equal(engine.read(plain, "h"), slopes())
    assert ran_fast(engine)
    wired = hill.sketch(body + 'inputs = { more = "one" }\n')
    for scale in (1.0, 2.0):  # the second plan is the first with another value
        result = engine.read(wired.with_values({"h.hill.scale" if around else "h.scale": scale}), "h")
        np.testing.assert_array_equal(result, scale * slopes() + 8.0)
    assert not ran_fast(engine)
    name, path = f"both{ending}", "h.hill" if around else "h"
    assert sentences == [
        f"{path}: {name} is left out, the plain form runs: it does not read what is wired to more"
    ]
    assert list(omitted(wired, (kind,))) == sentences


def test_renamed_canonical_parameter_disables_variant(drawing, hill):
    engine, sentences = drawing
    hill.write("hill.glsl", HILL.replace("scale", "steepness"))
    np.testing.assert_array_equal(engine.read(hill.sketch(BODY), "h"), slopes())
    assert not ran_fast(engine) and len(sentences) == 1
    assert "hill.glsl has changed since the two were found to agree" in sentences[0]
    (subject,) = subjects(str(hill.path / "hill.glsl"), hill.path / "picture.png")
    verdict = verify(engine, subject.variant, subject.technique, subject.places)
    assert not verdict.ok and "'scale' is not among the parameters and inputs of hill" in verdict.words


def test_edited_canonical_text_shows_and_is_reported_once(drawing, hill):
    engine, sentences = drawing
    engine.read(hill.sketch(BODY), "h")
    hill.write("hill.glsl", HILL.replace("+ scale", "+ 0.5 * scale"))
    for _ in range(2):
        np.testing.assert_allclose(engine.read(hill.sketch(BODY), "h"), slopes(0.5))
    assert not ran_fast(engine)
    (sentence,) = sentences
    assert "is left out, the plain form runs" in sentence
    assert "hill.glsl has changed since the two were found to agree" in sentence


@pytest.mark.parametrize("accepts", ["n up to 17, m up to 16", "2**n + 1, 2**m"])
def test_size_outside_variant_range_runs_canonical_form(drawing, hill, kind, accepts):
    """It says so once, and is not refused; at its own sizes the variant runs."""
    engine, sentences = drawing
    if kind == "compute":
        hill.write("hill.comp", COMPUTE.replace("agrees", f'accepts = "{accepts}", agrees'))
    else:
        hill.write("part.glsl", HALF.replace('f")', f'f", accepts = "{accepts}")'))
    trust(hill.path)
    for sides, fast in (((17, 16), True), ((17, 17), False), ((17, 18), False), ((17, 8), True)):
        sketch = hill.sketch(BODY, size=f"size = {list(sides)}")
        for scale in (1.0, 3.0):  # the second plan is the first with another value
            result = engine.read(sketch.with_values({"h.scale": scale}), "h")
            expected = np.broadcast_to(np.arange(17), sides[::-1])
            np.testing.assert_allclose(result / scale, expected, atol=1e-5)
            assert ran_fast(engine) is fast
    file = "hill.comp" if kind == "compute" else "part.glsl"
    assert sentences == [
        f"h: {file} takes {accepts} texels a side, not 17 x {height}; the plain form runs"
        for height in (17, 18)
    ]


@pytest.mark.parametrize(("most", "fast"), [(17, True), (16, False), (8, False)])
def test_loop_over_levels_uses_variant_if_it_accepts_every_size(drawing, hill, kind, most, fast):
    """Sizes 5, 9 and 17."""
    engine, sentences = drawing
    accepts = f'accepts = "n up to {most}"'
    if kind == "compute":
        hill.write("hill.comp", COMPUTE.replace("agrees", f"{accepts}, agrees"))
    else:
        hill.write("part.glsl", HALF.replace('f")', f'f", {accepts})'))
    trust(hill.path)
    hill.write(
        "sum.glsl",
        '#pragma kernel(output = "sum:r32f")\nuniform sampler2D height; //! input\n'
        'uniform sampler2D last; //! input("black")\n'
        "float kernel(ivec2 texel) { return texelFetch(height, size - 1, 0).r"
        " + texelFetch(last, ivec2(0), 0).r; }\n",
    )
    hill.write("level.toml", passes(height="./hill", sum="./sum") + '[inputs]\nlast = "sum.last"\n')
    sketch = hill.sketch(
        '[[pass]]\nname = "l"\nuse = "./level"\nrepeat = 3\nfeedback = { last = "sum" }\n'
        'size = "2 ** (iteration + 2) + 1"\n'
    )
    assert engine.read(sketch, "l:sum")[0, 0] == 4 + 8 + 16
    assert ran_fast(engine) is fast
    file, side = "hill.comp" if kind == "compute" else "part.glsl", 17 if most == 16 else 9
    expected = (
        f"l.height: {file} takes n up to {most} texels a side, not {side} x {side}; the plain form runs"
    )
    assert sentences == ([] if fast else [expected])


def test_comments_and_white_space_change_nothing(drawing, hill):
    engine, sentences = drawing
    text = HILL.replace("float kernel", "// mine\nfloat   kernel").replace("How high", "A tooltip")
    hill.write("hill.glsl", text.replace("{ return", "{\n\n    return"))
    hill.write("rise.glsl", "/* more\nwords */\n" + RISE)
    engine.read(hill.sketch(BODY), "h")
    assert ran_fast(engine) and sentences == []


EDITS = {
    "an include": ("rise.glsl", "0.25", "0.5"),
    "the header": ("hill.glsl", 'repeat = "4"', 'repeat = "8"'),
    "a default": ("hill.glsl", "scale = 1.0", "scale = 2.0"),
    "a range": ("hill.glsl", "slider(0, 4)", "slider(0, 40)"),
}


@pytest.mark.parametrize("what", EDITS)
def test_all_that_the_plain_text_is_made_of_counts(drawing, hill, what):
    engine, sentences = drawing
    name, before, after = EDITS[what]
    text = (hill.path / name).read_text()
    assert before in text
    hill.write(name, text.replace(before, after))
    sketch = hill.sketch(BODY)
    result = engine.read(sketch, "h")
    assert not ran_fast(engine) and len(sentences) == 1
    np.testing.assert_array_equal(result, engine.read(sketch.plainly(), "h"))


def test_an_edited_variant_does_not_run_before_it_is_verified(drawing, hill, kind):
    engine, sentences = drawing
    if kind == "compute":
        hill.write("hill.comp", COMPUTE.replace("scale * float", "2.0 * scale * float"))
    else:
        hill.write("twice.glsl", TWICE.replace("2.0", "4.0"))
    np.testing.assert_allclose(engine.read(hill.sketch(BODY), "h"), slopes())
    assert not ran_fast(engine)
    (sentence,) = sentences
    assert "it has changed since it was verified" in sentence and "playground variants renew" in sentence


def test_one_that_was_never_verified_does_not_run(drawing, hill):
    engine, sentences = drawing
    (hill.path / NAME).unlink()
    np.testing.assert_allclose(engine.read(hill.sketch(BODY), "h"), slopes())
    assert not ran_fast(engine)
    assert "was never verified against" in sentences[0]
    assert not (hill.path / NAME).exists(), "nothing is written unasked"


def test_an_edit_inside_a_technique_around_it_shows_too(drawing, hill):
    engine, sentences = drawing
    hill.write("around.toml", AROUND)
    engine.read(hill.sketch(NESTED), "h")
    assert ran_fast(engine)
    hill.write("hill.glsl", HILL.replace("+ scale", "+ 0.5 * scale"))
    np.testing.assert_allclose(engine.read(hill.sketch(NESTED), "h"), slopes(0.5))
    assert len(sentences) == 1


def test_an_inner_pass_counts_for_a_technique_s_variant(drawing, hill, kind):
    engine, sentences = drawing
    hill.write("around.toml", AROUND + '[parameters]\nscale = "hill.scale"\n')
    hill.write(
        "around.comp" if kind == "compute" else "around.fast.toml", COMPUTE if kind == "compute" else PASSES
    )
    trust(hill.path)
    engine.read(hill.sketch(NESTED), "h")
    assert ran_fast(engine) and "h.hill" not in engine.runs
    hill.write("rise.glsl", RISE.replace("0.25", "0.5"))
    np.testing.assert_allclose(engine.read(hill.sketch(NESTED), "h"), slopes(2.0))
    assert len(sentences) == 2, "neither the technique's nor its pass's runs"


def test_plain_forces_the_plain_form(drawing, hill):
    engine, sentences = drawing
    sketch = hill.sketch(BODY)
    for plain in (False, True, False):
        engine.read(sketch.plainly(plain), "h")
        assert ran_fast(engine) != plain
    (hill.path / NAME).unlink()
    engine.read(hill.sketch(BODY).plainly(), "h")
    assert sentences == [], "the plain form was requested, so nothing is reported"


def test_steps_are_those_of_the_plain_form(drawing, hill):
    engine, _ = drawing
    sketch = hill.sketch(BODY)
    values = [values[0, 4] for _, values in engine.steps(sketch, "h")]
    assert values == [0, 1, 2, 3, 4]
    assert not ran_fast(engine)


def test_which_form_ran_is_in_keys_and_hashes(drawing, hill):
    engine, _ = drawing
    sketch = hill.sketch(BODY)
    forms = [sketch, sketch.plainly()]
    assert len({engine.fingerprint(form) for form in forms}) == 2
    for form in forms:
        engine.render(form, size=(32, 32))
        assert engine.stale(form, size=(32, 32)) == []
    engine.render(sketch, size=(32, 32))
    assert engine.stale(sketch.plainly(), size=(32, 32)) == []
    assert not any(path.startswith("h") for path in engine.record.ran), "both stay in memory"


def test_only_what_cannot_run_here_is_reported(ctx, hill, kind):
    (hill.path / NAME).unlink()
    sentences: list[str] = []
    with Engine(ctx, driver="fragment", notice=sentences.append) as engine:
        engine.read(hill.sketch(BODY), "h")
    assert len(sentences) == (kind == "passes"), "without compute a .comp would not run anyway"


def test_an_engine_of_one_s_own_warns(hill):
    (hill.path / NAME).unlink()
    with headless() as engine, pytest.warns(PlainFormWarning, match="was never verified"):
        engine.render(hill.sketch(BODY), size=(16, 16))


def test_the_passes_of_a_variant_are_no_paths_of_the_sketch(drawing, hill, kind):
    engine, _ = drawing
    sketch = hill.sketch(BODY)
    engine.read(sketch, "h")
    assert engine.record.plan.flat.outputs.keys() == {"h", "view"}
    if kind == "passes":
        assert {"h.fast.part", "h.fast.height"} <= set(engine.record.ran)
        with pytest.raises(SketchError, match=r"no pass 'h\.fast\.part'"):
            engine.read(sketch, "h.fast.part")
    with pytest.raises(PlaygroundError, match=r"no parameter 'h\.fast\.part\.scale'"):
        sketch.with_values({"h.fast.part.scale": 2.0})


def test_the_fastest_goes_first(ctx, folder):
    for name, text in {"hill.glsl": HILL, "rise.glsl": RISE, "part.glsl": HALF, "twice.glsl": TWICE}.items():
        folder.write(name, text)
    folder.write("hill.comp", COMPUTE)
    folder.write("hill.fast.toml", PASSES)
    trust(folder.path)
    runs = {}
    for driver in ("auto", "fragment"):
        with Engine(ctx, driver=driver) as engine:
            engine.read(folder.sketch(BODY), "h")
            runs[driver] = engine.record.ran
    assert runs["fragment"] == ["h.fast.part", "h.fast.height"]
    if ctx.version_code >= 430:
        assert runs["auto"] == ["h"]


# ── verifying ────────────────────────────────────────────────────────────────


def verdicts(ctx, what, folder):
    with Engine(ctx) as engine:
        result = subjects(str(what), folder / "stand-in.png")
        return [verify(engine, s.variant, s.technique, s.places) for s in result]


@pytest.mark.parametrize("of", ["the sketch", "the variant"])
def test_renewing_draws_both_and_records_what_agrees(ctx, drawing, hill, kind, tmp_path, of):
    engine, sentences = drawing
    (hill.path / NAME).unlink()
    sketch = hill.sketch(BODY)
    own = next(hill.path.glob("hill.comp" if kind == "compute" else "hill.fast.toml"))
    (result,) = verdicts(ctx, hill.path if of == "the sketch" else own, tmp_path)
    assert result.ok and result.drawings > 10
    assert recorded([result]) == [hill.path / NAME]
    engine.read(load(sketch.file), "h")
    assert ran_fast(engine) and sentences == []


WRONG = {
    "everywhere": ("scale * float(texel.x)", "1.01 * scale * float(texel.x)", "height differs by"),
    "at odd sizes": ("scale * float", "(size.x % 2 == 1 ? 2.0 : 1.0) * scale * float", "height differs by"),
    "at one end of a slider": ("scale * float", "min(scale, 3.0) * float", "with scale = 4.0"),
    "where the terrain is not square": (
        "scale * float",
        "(spacing.x != spacing.y ? 2.0 : 1.0) * scale * float",
        "by",
    ),
}


@pytest.mark.parametrize("where", WRONG)
def test_one_that_differs_is_not_recorded(ctx, folder, tmp_path, where):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    before, after, words = WRONG[where]
    folder.write("hill.glsl", HILL)
    folder.write("rise.glsl", RISE)
    folder.write("hill.comp", COMPUTE.replace(before, after))
    trust(folder.path)
    sketch = folder.sketch(BODY)
    (result,) = verdicts(ctx, folder.path, tmp_path)
    assert not result.ok and words in result.wrong and "hill.glsl" in result.wrong
    recorded([result])
    assert json.loads((folder.path / NAME).read_text())["variants"] == {}
    assert len(unverified(load(sketch.file))) == 1


def test_one_without_a_bound_is_refused_in_a_sentence(ctx, folder, tmp_path):
    folder.write("hill.glsl", HILL)
    folder.write("rise.glsl", RISE)
    folder.write("hill.comp", COMPUTE.replace(', agrees = "1e-5"', ""))
    (sentence,) = map(str, unverified(folder.sketch(BODY)))
    assert sentence.endswith('it does not say how closely it agrees, as agrees = "1e-5"')
    (result,) = verdicts(ctx, folder.path, tmp_path)
    assert not result.ok and "how closely" in result.wrong


@pytest.mark.parametrize(
    ("agrees", "words"),
    [
        ("nearly", "'nearly' states no bound"),
        ("0", "'0' states no bound"),
        ("hight: exact", "no output 'hight'; did you mean 'height'"),
        ("exact; 1e-5", "all other outputs appears twice"),
    ],
)
def test_a_bound_that_is_none_is_a_sentence(folder, agrees, words):
    folder.write("hill.glsl", HILL)
    folder.write("rise.glsl", RISE)
    folder.write("hill.comp", COMPUTE.replace("1e-5", agrees))
    with pytest.raises(PlaygroundError, match=words):
        folder.sketch(BODY)


def test_a_damaged_record_is_a_sentence(hill):
    hill.write(NAME, '{"format": 1, "variants": [')
    with pytest.raises(SketchError, match="not a record of fast variants; remove it") as caught:
        hill.sketch(BODY)
    assert caught.value.diagnostics[0].file.endswith(NAME)


# ── the shape of a .fast.toml ────────────────────────────────────────────────

SHAPES = {
    "'scala' is not among the parameters and inputs of hill; did you mean 'scale'": (
        "\nscale =",
        "\nscala =",
    ),
    "gives part:r32f; hill gives height:r32f": ('[[pass]]\nname = "height"\nuse = "./twice"\n', ""),
    "use each other in a circle": ('use = "./twice"', 'use = "./hill"'),
}


@pytest.mark.parametrize("words", SHAPES)
def test_a_fast_toml_has_its_technique_s_shape(folder, words):
    for name, text in {"hill.glsl": HILL, "rise.glsl": RISE, "part.glsl": HALF, "twice.glsl": TWICE}.items():
        folder.write(name, text)
    before, after = SHAPES[words]
    assert before in PASSES
    folder.write("hill.fast.toml", PASSES.replace(before, after))
    with pytest.raises(SketchError, match=words):
        folder.sketch(BODY)


def test_fast_toml_is_refused_by_name_and_opens_its_technique(folder):
    for name, text in {"hill.glsl": HILL, "rise.glsl": RISE, "part.glsl": HALF, "twice.glsl": TWICE}.items():
        folder.write(name, text)
    path = folder.write("hill.fast.toml", PASSES)
    with pytest.raises(SketchError, match=r"'\./hill\.fast' is a fast variant; use = '\./hill' runs it"):
        folder.sketch(BODY.replace("./hill", "./hill.fast"))
    assert isinstance(load(path), Sketch) and load(path).graph.find("height").technique.name == "hill"
    (folder.path / "hill.glsl").unlink()
    with pytest.raises(SketchError, match=r"in place of hill\.glsl or hill\.toml, which is missing"):
        load(path)


def test_variants_of_either_kind_are_a_kind(hill, kind):
    assert [v.kind for v in hill.sketch(BODY).graph.passes[0].technique.variants] == [kind]
    assert kind in VARIANTS

"""The library's fast variants: the record of them is fresh, and each agrees within its bound."""

from pathlib import Path

import numpy as np
import pytest

from playground.allowed_files import is_variant
from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.sketch.find import shipped_sketches
from playground.sketch.flatten import flatten, substitute_variants
from playground.sketch.model import VARIANTS, Graph, PassSpec, Sketch, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.variants import NAME, content_of, is_verified, read, why_not, written
from playground.verify.variants import compared, places_in, subjects, verify

from ..loading import load


def name_of(variant):
    return Path(variant.path).relative_to(GLSL).as_posix()


VARIANTS_THAT_SHIP = sorted(p.relative_to(GLSL).as_posix() for p in GLSL.rglob("*") if is_variant(p))
# One of each kind is verified again every day. The others were when they were recorded, and every day
# test_the_record_is_fresh sees that their texts are still those: only the engine could break them.
EVERY_DAY = {
    "generation/diamond_square.comp",
    "generation/circles/raw.fast.toml",
    "view/splat/land.fast.toml",
}


@pytest.fixture(scope="module")
def those_that_ship(tmp_path_factory):
    picture = tmp_path_factory.mktemp("stand-in") / "stand-in.png"
    return {name_of(subject.variant): subject for subject in subjects("", picture)}


def test_the_record_is_fresh(those_that_ship):
    """Where this fails, a text has changed: ``playground variants renew`` verifies and records."""
    wrong = [
        why_not(s.technique, s.variant)
        for s in those_that_ship.values()
        if not is_verified(s.technique, s.variant)
    ]
    assert wrong == []
    entries = {
        n: (content_of(s.technique), content_of(s.variant.technique)) for n, s in those_that_ship.items()
    }
    assert read(GLSL / NAME) == entries
    assert (GLSL / NAME).read_text(encoding="utf-8") == written(entries)


def test_every_file_that_is_one_by_its_name_is_one(those_that_ship):
    assert set(VARIANTS_THAT_SHIP) == set(those_that_ship)
    assert {s.variant.kind for s in those_that_ship.values()} == set(VARIANTS)
    assert {those_that_ship[name].variant.kind for name in EVERY_DAY} == set(VARIANTS)


# One of the places has rain, which that one does not read: the plain form runs there, as it says.
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*accumulation.comp is left out:playground.errors.PlainFormWarning")
@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[] if n in EVERY_DAY else [pytest.mark.slow]) for n in VARIANTS_THAT_SHIP],
)
def test_it_agrees_within_its_bound(ctx, those_that_ship, name):
    """At every size, seed, choice of a menu and end of a slider: see ``verify.variants``."""
    subject = those_that_ship[name]
    with Engine(ctx) as engine:
        verdict = verify(engine, subject.variant, subject.technique, subject.places)
    if verdict.skipped:
        pytest.skip(verdict.skipped)
    assert verdict.ok, verdict.words
    assert verdict.drawings >= 10


def with_edit(text):
    """Return a kernel's text that gives a fifth of what it gave."""
    body = text.index("{", text.index(" kernel(ivec2 texel) {"))
    end = text.index("\n}", body)
    head, _, value = text[:end].rpartition("return ")
    return f"{head}return 0.2 * ({value.replace(';', ');', 1)}{text[end:]}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("sketch", "file"),
    [("diamond_square", "generation/diamond_square/raw.glsl"), ("fourier", "generation/fourier/filter.glsl")],
)
def test_an_edit_of_a_shipped_kernel_shows(ctx, sketch, file):
    notices = []
    path = str(GLSL / file)
    small = load(sketch).with_values({"size": 33})
    edited = with_texts(small, {path: with_edit(Path(path).read_text(encoding="utf-8"))})
    with Engine(ctx, notice=notices.append) as engine:
        before = engine.read(small, "height:height", size=(64, 36))
        engine.render(small, size=(64, 36))
        assert notices == []
        after = engine.read(edited.with_values({"height.normalise": "none"}), "height:height", size=(64, 36))
        plain = engine.read(
            edited.with_values({"height.normalise": "none"}).plainly(), "height:height", size=(64, 36)
        )
    assert (after != before).any()
    np.testing.assert_array_equal(after, plain)
    assert len(notices) == (ctx.version_code >= 430)


@pytest.mark.parametrize("name", VARIANTS_THAT_SHIP)
def test_an_edit_of_any_file_of_the_plain_form_drops_it(those_that_ship, name):
    subject = those_that_ship[name]
    files = {f for _, kernel in kernels_of(subject.technique) for f in kernel.source.files}
    sketch = Sketch("s", "", str(GLSL), Graph("s", "", (PassSpec("t", "t", subject.technique),)))
    for file in sorted(files):
        text = Path(file).read_text(encoding="utf-8")
        for more, stays in (("// a comment\n", True), ("float an_edit() { return 1.0; }\n", False)):
            head, guard, tail = text.rpartition("#endif\n")
            changed = with_texts(sketch, {file: f"{head}{more}{guard}{tail}" if guard else text + more})
            technique = changed.graph.passes[0].technique
            (variant,) = (v for v in technique.variants if v.path == subject.variant.path)
            assert is_verified(technique, variant) == stays, (file, more)


@pytest.mark.slow
@pytest.mark.parametrize("name", shipped_sketches())
def test_it_agrees_in_every_sketch_that_uses_it(ctx, name):
    """At the sketch's own sizes, with its own values."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx) as engine:
        for use in places_in(load(name), GLSL):
            verdict = compared(engine, use)
            assert not verdict.wrong, f"{use.path}: {verdict.words}"


def test_pass_running_canonical_form_compares_and_draws_nothing(ctx):
    """A pixel of several samples is drawn by no fast variant, though both forms of a view share files."""
    sketch = load("fbm")
    assert sketch.picture.samples > 1
    position = next(p for p in places_in(sketch, GLSL) if p.path == "view")
    with Engine(ctx) as engine:
        assert compared(engine, position).drawings == 0
        assert not engine.runs


@pytest.mark.parametrize("path", ["height.noise.direction", "height.spectrum.direction"])
def test_inner_parameter_unknown_to_variant_runs_canonical_form(path):
    """Set by whatever means: a variant would ignore it."""
    sketch = load("fourier")

    def kernels(asked):
        return [leaf.kernel.path for leaf in substitute_variants(flatten(asked), VARIANTS).leaves]

    assert any(name.endswith("fourier.comp") for name in kernels(sketch))
    assert any(
        name.endswith("fourier.comp") for name in kernels(sketch.with_values({"height.roughness": 1.0}))
    )
    inner = sketch.with_values({path: "forward"}), sketch.with_values({path: "backward"})
    for asked in inner:
        assert not any(name.endswith(".comp") and "fourier" in name for name in kernels(asked))

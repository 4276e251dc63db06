"""The must-fail suite: no mutant of a real terrain passes, and nothing harmless is refused."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import moderngl
import numpy as np
import pytest

from playground import cli
from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.paths import PLAIN_SKETCH
from playground.sketch.model import Sketch
from playground.verify.shots import judge
from playground.verify.shots.compare import compare
from playground.verify.shots.mutants import repeatability as repeatability_module
from playground.verify.shots.mutants.finished import FINISHED
from playground.verify.shots.mutants.rendering import (
    DoesNotApply,
    Edit,
    ImageMutant,
    Picture,
    SketchMutant,
    broken,
    rendering_mutants,
)
from playground.verify.shots.mutants.repeatability import (
    Drawing,
    Process,
    Redrawn,
    commented,
    processes,
    redraw,
)
from playground.verify.shots.mutants.suite import (
    TIERS,
    MutantResult,
    MutantRunner,
    all_mutants,
    kill_rate,
    named,
    shot_of,
    survivors,
)
from playground.verify.shots.suite import ShotCase, render_shot

from ...loading import load
from ...sketch_texts import map_of_height

SIZE = (160, 90)
SMALLER = {"size": (86, 101), "view.grid": 97}  # the file's is 344 × 403, the colour sixteen times that

SLOPE = """// slope.glsl -- slopes side by side, higher with each step and with time.
#pragma kernel(output = "height:r32f", repeat = "3")
uniform float rise = 1.0;  //! slider(0, 4) How high they rise
float kernel(ivec2 texel) {
    return previous(texel) + rise * (0.3 + time) * fract(dot(vec2(texel), vec2(0.2, 0.3)));
}
"""
MINE = (
    'format = 1\ntitle = "A slope"\nsize = 33\n'
    + map_of_height("./slope", channel="red")
    + '[[shot]]\nname = "dark"\nsize = [66, 44]\nset = { "height.rise" = 0.25 }\n'
)


def mutant(name: str) -> SketchMutant:
    (rendering,) = (m for m in rendering_mutants() if m.name == name)
    return rendering


def finished(name: str) -> Callable[[Picture], Picture]:
    (result,) = (m for m in FINISHED if m.name == name)
    return result.change


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "sketch.toml").write_text(MINE)
    (folder / "slope.glsl").write_text(SLOPE)
    return folder


@pytest.fixture(scope="module")
def jacksboro() -> Sketch:
    return load(PLAIN_SKETCH).with_values(SMALLER)


@pytest.fixture(scope="module")
def bench(shared_context: moderngl.Context, jacksboro: Sketch) -> Iterator[MutantRunner]:
    with Engine(shared_context) as engine:
        yield MutantRunner(engine, jacksboro, size=SIZE)


@pytest.fixture(scope="module")
def results(bench: MutantRunner) -> list[MutantResult]:
    return list(bench.run(all_mutants()))


def noise_like(shape: tuple[int, int] = (90, 160)) -> Picture:
    picture = np.random.default_rng(5).integers(8, 240, (*shape, 4), np.uint8)
    picture[..., 3] = 255
    return picture


# ── what the suite is there for ──────────────────────────────────────────────


@pytest.mark.slow
def test_the_same_build_catches_every_defect_of_jacksboro(results: list[MutantResult]):
    assert survivors(results, 0) == []
    caught, of = kill_rate(results, 0)
    assert caught == of >= 60
    assert sum(r.counts and r.mutant.kind == "rendering" for r in results) >= 40


def test_every_mutant_of_jacksboro_is_seen_or_says_why_not(results: list[MutantResult]):
    assert [r.mutant.name for r in results if r.unseen] == []
    assert {r.mutant.name: r.why_not for r in results if not r.applies} == {
        "one-turn-fewer": "nothing in the sketch repeats",
        "one-frame-late": "nothing in the sketch changes with time",
    }


def test_noise_of_one_level_is_no_defect(results: list[MutantResult]):
    (exempt,) = (r for r in results if r.mutant.exempt)
    assert exempt.comparison is not None and exempt.comparison.most == 1
    assert exempt.well and not exempt.caught()


def test_looser_tiers_catch_less_but_all_that_is_large(results: list[MutantResult]):
    passed = [set(survivors(results, number)) for number in range(len(TIERS))]
    assert "specks" in passed[1]  # what another build may do is as small as this
    assert "no-shadow" not in passed[1] and "no-shadow" in passed[2]
    large = {"sun-from-behind", "layers-swapped", "upside-down", "no-gamma", "no-alpha", "no-haze"}
    large |= {"magenta-square", "half-blank", "blank", "a-row-short"}
    assert [large & names for names in passed] == [set(), set(), set()]


@pytest.mark.parametrize("tolerance", [2, 8])
def test_a_looser_comparison_is_seen(
    tolerance: int, results: list[MutantResult], bench: MutantRunner, monkeypatch: pytest.MonkeyPatch
):
    """The suite is sharp: with a tolerance above 1, mutants survive, by name."""
    monkeypatch.setattr(judge, "TOLERANCE", tolerance)
    again_judged = list(bench.run(FINISHED))
    survived = survivors(again_judged, 0)
    assert {"two-levels-brighter", "noise-of-two"} <= set(survived)
    assert not all(r.well for r in again_judged)
    of_all = [
        r.mutant.name
        for r in results
        if r.counts and compare(r.picture, bench.expected[r.shot].array, tolerance).ok
    ]
    assert len(of_all) >= (2 if tolerance == 2 else 7)


def test_a_comparison_that_forgets_alpha_is_seen(bench: MutantRunner, monkeypatch: pytest.MonkeyPatch):
    def forgetful(actual: Picture, expected: Picture | None, tolerance: int = 1, **rule: Any):
        opaque = [p if p is None else np.where([1, 1, 1, 0], p, np.uint8(255)) for p in (actual, expected)]
        return compare(*opaque, tolerance, **rule)

    monkeypatch.setattr(judge, "compare", forgetful)
    assert survivors(list(bench.run([mutant("no-alpha"), mutant("no-gamma")])), 0) == ["no-alpha"]


# ── the machinery breaks what it says, and nothing else ──────────────────────


@pytest.mark.slow
def test_texts_read_again_with_comments_draw_the_same_bits(bench: MutantRunner):
    shot = shot_of(bench.sketch, size=SIZE)
    expected = bench.unbroken(shot)
    edited = commented(bench.sketch)
    assert edited.graph is not bench.sketch.graph
    assert "says nothing" in "".join(
        line.text for line in edited.graph.passes[2].technique.passes[-1].technique.source.lines
    )
    with Engine(bench.engine.ctx) as engine:
        frame = render_shot(engine, ShotCase(edited, shot))
    np.testing.assert_array_equal(frame.array, expected.array)
    assert frame.drawn == expected.drawn != ""


def test_drawn_content_hash_detects_every_rendering_defect(results: list[MutantResult]):
    for result in results:
        if result.applies:
            reported = any("the drawn content has changed" in line for line in result.tiers[0].differences)
            assert reported is (result.mutant.kind == "rendering"), result.mutant.name


def test_non_finite_values_are_reported_as_nan_in_every_tier(results: list[MutantResult]):
    (result,) = (r for r in results if r.mutant.name == "not-numbers")
    assert [judgement.word for judgement in result.tiers] == ["nan"] * len(TIERS)


def test_values_are_changed_from_what_the_shot_has(jacksboro: Sketch):
    evening = jacksboro.for_shot(jacksboro.shot("evening"))
    turned = dict(broken(mutant("sun-from-behind"), evening).overrides)
    assert turned["light.sun"] == (70.0, 9.0)  # 250 + 180 degrees, round the compass
    assert dict(broken(mutant("haze-twice"), evening).overrides)["view.haze"] == pytest.approx(0.24)
    wide = broken(mutant("field-of-view"), evening).camera
    assert wide.field_of_view == pytest.approx(38.0 * 1.01)
    assert broken(mutant("no-antialiasing"), evening).picture.samples == 1


def test_wires_are_exchanged(jacksboro: Sketch):
    colour = broken(mutant("layers-swapped"), jacksboro).graph.find("colour")
    assert colour is not None
    mix = colour.technique.find("mix")
    assert dict(mix.inputs) == {"height": "ragged", "grass": "rock", "rock": "grass"}


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (Edit("view/present.glsl", "no such words", ""), "expected once, found 0 times: no such words"),
        (Edit("view/present.glsl", "light", ""), "expected once, found"),
    ],
)
def test_missing_or_repeated_anchor_is_mutant_error(edit: Edit, message: str, jacksboro: Sketch):
    with pytest.raises(DataError, match=message) as caught:
        broken(SketchMutant(name="old", broke="It is old.", edits=(edit,)), jacksboro)
    assert "present.glsl" in str(caught.value) and "'old'" in str(caught.value)


def test_a_sketch_of_ones_own_is_broken_as_far_as_it_can_be(mine: Path, any_engine: Engine):
    bench = MutantRunner(any_engine, load(mine))
    result = {r.mutant.name: r for r in bench.run(all_mutants())}
    assert result["no-shadow"].why_not == "the sketch does not use lighting/ray_cast/visibility.glsl"
    assert result["sun-1-degree"].why_not == "there is no parameter 'light.sun'"
    assert result["layers-swapped"].why_not == "there is no input 'colour.mix.grass'"
    assert [m.name for m in FINISHED if not (result[m.name].applies and result[m.name].well)] == []
    assert result["one-turn-fewer"].caught() and result["one-frame-late"].caught()
    # A third of the light is missing with one step of three.
    assert result["one-turn-fewer"].picture.mean() < bench.expected["dark"].array.mean()
    assert result["one-frame-late"].picture.mean() > bench.expected["dark"].array.mean()


def test_a_shot_that_does_not_show_a_defect_says_so(bench: MutantRunner):
    def shown(by: int) -> MutantResult:
        change = ImageMutant("more", "More.", lambda picture: np.clip(picture, 0, 255 - by) + np.uint8(by))
        return next(bench.run([change]))

    (wire,) = bench.run(
        [SketchMutant(name="none", broke="Nothing.", values=(("view.wire", (0.1, 0.2, 0.3)),))]
    )
    for result in (wire, shown(1)):
        assert result.unseen and result.well and not result.counts
    assert shown(2).counts and not shown(2).unseen


def test_mutant_names_are_unique_and_descriptions_are_sentences():
    names = [m.name for m in all_mutants()]
    assert len(set(names)) == len(names) >= 60
    assert all(m.broke[0].isupper() and m.broke.endswith(".") for m in all_mutants())


# ── finished pictures ────────────────────────────────────────────────────────


def test_picture_mutants_break_as_described_and_keep_original():
    picture = noise_like()
    original = picture.copy()
    for item in FINISHED:
        changed = item.change(picture)
        np.testing.assert_array_equal(picture, original)
        assert changed.dtype == np.uint8 and changed.shape[2] == 4
        assert (changed.shape == picture.shape) is (item.name != "a-row-short")
        np.testing.assert_array_equal(changed, item.change(picture))  # random numbers are seeded
    for name in ("upside-down", "mirrored", "blue-for-red"):
        np.testing.assert_array_equal(finished(name)(finished(name)(picture)), picture)
    magenta = finished("magenta-square")(picture)
    assert int((magenta != picture).any(axis=2).sum()) == 32 * 32
    assert int((finished("dead-pixel")(picture) != picture).any(axis=2).sum()) == 1
    assert np.flatnonzero((finished("dead-row")(picture) != picture).any(axis=(1, 2))).tolist() == [30]
    np.testing.assert_array_equal(finished("one-pixel-along")(picture)[:, 7], picture[:, 6])
    np.testing.assert_array_equal(finished("lost-row")(picture)[40], picture[41])


def test_noise_is_as_strong_as_it_says():
    picture = noise_like()
    item = finished("noise-of-one")(picture).astype(int) - picture
    assert set(np.unique(item[..., :3])) == {-1, 0, 1} and not item[..., 3].any()
    two = finished("noise-of-two")(picture).astype(int) - picture
    assert set(np.unique(two)) == {-2, 0, 2}
    assert 0.005 < (two != 0).any(axis=2).mean() < 0.02


# ── drawn again ──────────────────────────────────────────────────────────────


def redrawn(bench: MutantRunner, sketch: Sketch, count: int) -> list[Redrawn]:
    shot = shot_of(sketch, size=SIZE)
    # A process loads the file, which says nothing of a smaller terrain; so the shot does.
    smaller = replace(shot, values=tuple(SMALLER.items()))
    return list(redraw(sketch, smaller, bench.unbroken(shot), bench.engine.info, count))


HARMLESS = Process(
    (
        Drawing("auto", before="another camera", commented=True),
        Drawing("auto", fresh=True, cache_bytes=2**20, before="a mutant"),
    ),
    (("LC_ALL", "de_DE.UTF-8"), ("LP_NUM_THREADS", "1"), ("MESA_GL_VERSION_OVERRIDE", "4.1")),
    elsewhere=True,
    moved=True,
)


@pytest.mark.slow
def test_what_must_not_matter_does_not(mine: Path, any_engine: Engine, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(repeatability_module, "processes", lambda count, drivers: [HARMLESS])
    bench = MutantRunner(any_engine, load(mine))
    shot = shot_of(bench.sketch)
    result = list(redraw(bench.sketch, shot, bench.unbroken(shot), any_engine.info, 2))
    assert [(item.refused, item.identical) for item in result] == [("", True), ("", True)]


@pytest.mark.slow
def test_nor_does_it_to_jacksboro(bench: MutantRunner, jacksboro: Sketch, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(repeatability_module, "processes", lambda count, drivers: [HARMLESS])
    result = redrawn(bench, jacksboro, 2)
    assert [(item.refused, item.identical) for item in result] == [("", True), ("", True)]


@pytest.mark.slow
def test_a_process_that_fails_counts_as_refused(mine: Path, any_engine: Engine):
    bench = MutantRunner(any_engine, load(mine))
    shot = shot_of(bench.sketch)
    arguments = (bench.sketch, shot, bench.unbroken(shot), any_engine.info, 1)
    (late,) = redraw(*arguments, limit=0.01)
    assert late.refused == "the drawing took more than 0.01 s and was stopped"
    (mine / "slope.glsl").write_text(SLOPE.replace("rise *", "ryse *"))
    (wrong,) = redraw(*arguments)
    assert "slope.glsl:" in wrong.refused and "ryse" in wrong.refused and not wrong.identical


def test_a_picture_that_is_not_the_same_is_refused(mine: Path, any_engine: Engine):
    bench = MutantRunner(any_engine, load(mine))
    shot = shot_of(bench.sketch)
    unbroken = bench.unbroken(shot)
    expected = replace(unbroken, array=finished("two-levels-brighter")(unbroken.array))
    (result,) = redraw(bench.sketch, shot, expected, any_engine.info, 1)
    assert result.refused.startswith("differs: max difference 2") and not result.identical


DRAWINGS = 72
"""As few as have every condition; ``playground shots mutants --again 200`` draws more."""


def test_the_drawings_have_every_condition():
    drivers = ("auto", "fragment", "compute")
    result = processes(DRAWINGS, drivers)
    assert result == processes(DRAWINGS, drivers)
    drawings = [drawing for process in result for drawing in process.drawings]
    assert len(drawings) == DRAWINGS
    assert {drawing.driver for drawing in drawings} == set(drivers)
    assert {"", "a mutant", "all shots", "another camera", "a smaller picture"} <= {
        d.before for d in drawings
    }
    for condition in ("fresh", "commented", "cache_bytes"):
        assert {bool(getattr(drawing, condition)) for drawing in drawings} == {True, False}
    for condition in ("elsewhere", "moved", "cold"):
        assert {getattr(process, condition) for process in result} == {True, False}
    environment = {pair for process in result for pair in process.environment}
    assert {("LP_NUM_THREADS", number) for number in "0124"} <= environment
    assert {("MESA_GL_VERSION_OVERRIDE", "4.1"), ("MESA_SHADER_CACHE_DISABLE", "true")} <= environment


@pytest.mark.slow
def test_no_false_alarm_in_many_drawings(bench: MutantRunner, jacksboro: Sketch):
    refused = [
        f"{item.words}: {item.refused}" for item in redrawn(bench, jacksboro, DRAWINGS) if item.refused
    ]
    assert refused == []


# ── the command ──────────────────────────────────────────────────────────────


@pytest.mark.slow
def test_the_command_prints_a_row_a_mutant_and_writes_pictures(
    mine: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.chdir(tmp_path)
    chosen = ["--mutant", "upside-down", "--mutant", "no-shadow", "--mutant", "noise-of-one"]
    assert cli.main(["shots", "mutants", "mine", *chosen, "--pictures", "seen", "--again", "1"]) == 0
    out, error = capsys.readouterr()
    rows = {line.split("\t")[0]: line.split("\t") for line in out.splitlines() if "\t" in line}
    assert set(rows) == {"upside-down", "noise-of-one"}
    assert rows["upside-down"][-1] == "Rows are read from the bottom up."
    assert "same build: 1 of 1 caught" in out and "noise-of-one: passes, as it should" in out
    assert "drawn again 1 time: 0 refused, 1 the same to the last bit" in out
    assert "no-shadow does not apply: the sketch does not use" in error
    expected, _ = read_png(tmp_path / "seen" / "unbroken.dark.png")
    upside_down, _ = read_png(tmp_path / "seen" / "upside-down.png")
    np.testing.assert_array_equal(upside_down, expected[::-1])
    assert (tmp_path / "seen" / "upside-down.difference.png").is_file()


def test_the_command_fails_where_a_defect_passes(
    mine: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(judge, "TOLERANCE", 2)
    chosen = ["--mutant", "noise-of-two", "--mutant", "half-blank"]
    assert cli.main(["shots", "mutants", str(mine), *chosen, "--json"]) == 1
    result = json.loads(capsys.readouterr().out)
    assert result["tiers"]["same build"] == {"caught": 1, "of": 2, "passed": ["noise-of-two"]}
    assert [entry["tiers"]["same build"]["caught"] for entry in result["mutants"]] == [False, True]


def test_every_mutant_can_be_chosen_by_name():
    assert named(()) == all_mutants()
    (item,) = named(["seam"])
    assert isinstance(item, SketchMutant) and isinstance(named(["grey"])[0], ImageMutant)
    with pytest.raises(DoesNotApply):
        broken(
            SketchMutant(name="x", broke="X.", wires=(("colour.mix.grass", "nowhere"),)), load(PLAIN_SKETCH)
        )

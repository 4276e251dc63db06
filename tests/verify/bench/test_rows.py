"""Every row that ships can be measured: its sketch loads, its texture is there, its peers are known."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest

from playground.errors import ParameterError
from playground.rooms import modules
from playground.verify.bench.context import BenchContext, Options
from playground.verify.bench.measures import BYTES, MEASURES, counted, run, timed_calls, unchanging
from playground.verify.bench.peers import PEERS
from playground.verify.bench.rows import FOLDER, chosen, suites

ROWS = {row.name: row for row in chosen(())}


def test_row_names_are_unique_and_suites_match_files():
    assert len(ROWS) == sum(len(rows) for rows in suites().values())
    files = {path.stem for path in FOLDER.glob("*.toml")}
    assert set(suites()) == files | {module.__name__.split(".")[1] for module in modules("measures")}


def test_rows_are_chosen_by_suite_by_name_and_by_pattern():
    assert {row.suite for row in chosen(["lighting"])} == {"lighting"}
    assert [row.name for row in chosen(["fourier", "hard_shadow_*"])] == [
        "fourier",
        "hard_shadow_5",
        "hard_shadow_25",
    ]
    with pytest.raises(ParameterError, match="no suite or row 'fourrier'; did you mean 'fourier'"):
        chosen(["fourrier"])


@pytest.mark.parametrize("name", ROWS)
def test_its_measure_and_its_peers_are_known(name):
    row = ROWS[name]
    assert row.measure in {*MEASURES, *(each for context in modules("measures") for each in context.MEASURES)}
    assert {peer["peer"] for peer in row.peers} <= PEERS.keys()
    goal = row.goal
    assert not goal.times or goal.than


@pytest.mark.parametrize("name", [row.name for row in ROWS.values() if row.measure == "texture"])
def test_its_sketch_has_the_texture_and_what_changes(name):
    row = ROWS[name]
    with BenchContext(Options()) as context:
        sketch = context.sketch(row.options, 65)
        changed = {path: 3 for path in row.options.get("seeds", ())}
        changed |= dict.fromkeys(row.options.get("suns", ()), (120.0, 30.0))
        changed |= dict.fromkeys(row.options.get("nudged", ()), row.options.get("around", 0.5) + 0.01)
        assert changed, "each run is to make something new"
        expected = str(row.options["texture"])
        plan = context.engine().plan(sketch.with_values(changed), (64, 36), 0.0, None, expected)
        plan.flat.ref(expected, "sketch")
        if "part" in row.options:
            assert row.options["part"] != expected
            engine = context.engine()
            engine.texture(sketch.with_values(changed), row.options["part"])
            assert "a" not in engine.record.ran, "the part is made without what is measured"


@pytest.mark.parametrize(("name", "read"), [("unchanged", 1), ("unchanged_chain", 7)])
def test_unchanged_picture_reads_one_pass_or_whole_chain(name, read):
    with BenchContext(Options()) as context:
        engine, sketch = context.engine(), unchanging(ROWS[name], context, 7)
        engine.draw(sketch, size=(16, 9))
        assert sum(path.startswith("p") for path in engine.record.ran) == read
        turned = sketch.with_camera(replace(sketch.camera, azimuth=sketch.camera.azimuth + 1.0))
        engine.draw(turned, size=(16, 9))
        assert engine.record.ran and not any(path.startswith("p") for path in engine.record.ran)


def test_measured_row_has_every_form_and_reports_missing_peer(monkeypatch):
    names: list[str] = []
    monkeypatch.setitem(__import__("sys").modules, "opensimplex", None)  # an import of it fails
    rows = chosen(["layered_noise_sum", "white_noise"])
    results = run(rows, [33, 65], Options(rounds=2, say=names.append))
    assert [(f.name, f.size) for f in results.figures] == [
        ("layered_noise_sum", 33),
        ("layered_noise_sum", 65),
        ("white_noise", 33),
        ("white_noise", 65),
    ]
    assert list(results.figures[0].ours) == ["auto", "fragment", "plain"]
    assert list(results.figures[2].ours) == ["auto", "fragment"], "it has no fast variant"
    assert all(len(s.wall) == 2 for f in results.figures for s in f.ours.values())
    assert sum("opensimplex is not installed" in each for each in names) == 1
    assert results.notes == names
    assert results.machine["renderer"] and results.machine["processors"] >= 1


def test_rows_of_rooms_and_of_comparisons_are_measured():
    modes = [row for name in ("stroke", "judge_same") if name in ROWS for row in chosen([name])]
    figures = run(modes, [33], Options(rounds=2)).figures
    assert {figure.name.partition("-")[0] for figure in figures} == {row.name for row in modes}
    assert all(len(figure.ours["auto"].wall) == 2 for figure in figures)
    assert all(figure.ours["auto"].median() > 0.01 for figure in figures), "something is drawn, or compared"


def test_calls_are_counted_and_moderngl_is_as_before(engine):
    import moderngl

    before = moderngl.VertexArray.render
    texture = engine.ctx.texture((4, 4), 1, dtype="f4")
    with counted() as counts:
        texture.use(0)
        texture.use(1)
        texture.write(bytes(64))
        texture.read()
        engine.ctx.finish()
    texture.release()
    assert counts["textures bound"] == 2 and counts["waits"] == 1 and counts["draw calls"] == 0
    assert counts[BYTES] == 128
    assert moderngl.VertexArray.render is before


def test_the_time_inside_calls_is_told_apart(engine, monkeypatch):
    import moderngl

    def slow(self, location=0):
        time.sleep(0.02)

    monkeypatch.setattr(moderngl.Texture, "use", slow)
    texture = engine.ctx.texture((4, 4), 1, dtype="f4")
    with timed_calls() as spent:
        texture.use(0)
        time.sleep(0.05)
    texture.release()
    assert 20 <= spent.milliseconds < 50 and moderngl.Texture.use is slow

"""Which shots earn their place: what is changed in a shader, and who is named as not needed."""

from __future__ import annotations

from pathlib import Path

from playground.sketch.model import Graph, Shot, Sketch
from playground.verify.shots.mutants.rendering import rendering_mutants
from playground.verify.shots.suite import ShotCase

from .everyday import EACH, changes_of, without_a_place

TEXT = """// 2.5 + 1.5 is a comment
uniform float gain = 3.5;  //! slider(0, 9)
float f(float x) {
    for (int i = 0; i < 9; i++) x += 1.5;
    return max(x, 0.25) - 4.5 * x;
}
"""


def test_a_change_is_of_the_code_and_of_no_declaration_or_loop(tmp_path: Path) -> None:
    path = tmp_path / "f.glsl"
    path.write_text(TEXT, encoding="utf-8")
    changes = changes_of(str(path))
    assert len(changes) == EACH
    for change in changes:
        before, after = TEXT.splitlines(), change.text().splitlines()
        assert [n for n, (a, b) in enumerate(zip(before, after, strict=True), 1) if a != b] == [5]
    assert changes[0].text().splitlines()[4] == "    return min(x, 0.25) - 4.5 * x;"


def test_shot_killing_no_extra_mutant_is_redundant_but_one_stays() -> None:
    defects = list(rendering_mutants()[:2])

    def case(sketch: str, shot: str) -> ShotCase:
        return ShotCase(Sketch(sketch, sketch, "", Graph(sketch, sketch, ())), Shot(shot))

    first, other, alone, second = (
        case("a", "one"),
        case("a", "other"),
        case("b", "alone"),
        case("b", "second"),
    )
    killed = {other: [], first: defects, alone: [], second: []}
    assert list(without_a_place(killed)) == [other, second]

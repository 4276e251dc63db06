"""The file by which a window tells editors which texel it traces."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from playground.engine.trace.live_texel import LiveTexel, live_file, read_live_texel, write_live_texel

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
VALUES = st.one_of(st.booleans(), st.integers(), NUMBERS, st.text(), st.lists(NUMBERS, min_size=2).map(tuple))
PAIRS = st.tuples(st.integers(0, 10**6), st.integers(0, 10**6))


@given(
    texel=st.builds(
        LiveTexel,
        sketch=st.text(),
        path=st.text(),
        texel=PAIRS,
        iteration=st.none() | st.integers(0),
        size=st.none() | PAIRS,
        time=NUMBERS,
        values=st.dictionaries(st.text(), VALUES).map(lambda values: tuple(values.items())),
    )
)
def test_what_is_written_is_read(tmp_path_factory: pytest.TempPathFactory, texel: LiveTexel) -> None:
    file = live_file(tmp_path_factory.getbasetemp() / "live")
    write_live_texel(texel, file)
    assert read_live_texel(file) == texel
    write_live_texel(None, file)
    assert read_live_texel(file) is None and not file.exists()
    write_live_texel(None, file)


GOOD = {"format": 1, "sketch": "a", "path": "b", "texel": [1, 2], "iteration": None, "size": None}
GOOD |= {"time": 0, "values": {}}


@pytest.mark.parametrize(
    "change",
    [
        {"format": 2},
        {"texel": [1]},
        {"texel": ["1", 2]},
        {"sketch": None},
        {"iteration": "last"},
        {"values": []},
        {"values": {"a": {"b": 1}}},
        {"time": "soon"},
    ],
    ids=str,
)
def test_what_another_version_writes_is_nothing(tmp_path: Path, change: dict[str, object]) -> None:
    file = tmp_path / "t.json"
    file.write_text(json.dumps(GOOD | {"more": 1}))
    assert read_live_texel(file) is not None
    for text in (json.dumps(GOOD | change), json.dumps(GOOD)[:-5], "[" * 100_000, "3"):
        file.write_text(text)
        assert read_live_texel(file) is None


def test_a_folder_that_cannot_be_written_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    write_live_texel(LiveTexel("a", "b", (0, 0)), live_file(tmp_path / "file"))
    assert read_live_texel(live_file(tmp_path / "file")) is None

"""Each row of ``refusals/verify.toml`` is refused in one message that names what is wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.errors import PlaygroundError
from playground.sketch.model import tolerance_of
from playground.verify.bench.results import read
from playground.verify.shots.adapters import levels_of, picture_from
from playground.verify.shots.compare import Light, compare, mask_of
from playground.verify.shots.judge import strip_of
from playground.verify.shots.mutants.rendering import rendering_mutants
from playground.verify.shots.references import read_fallbacks
from playground.verify.shots.results import Record, from_json, read_results, to_json, write_result

from ..cases import each
from ..test_refusals import Row, rows

RECORD = json.loads(to_json(Record(sketch="hills", shot="dawn", word="differs", message="it differs")))
NAMES = {
    **{each.__name__: each for each in (compare, from_json, levels_of, mask_of, read, read_fallbacks)},
    **{each.__name__: each for each in (Light, read_results, strip_of, picture_from, tolerance_of)},
    "np": np,
    "PICTURE": np.zeros((4, 6, 4), np.uint8),
    "A": "name = 'a'\nbroke = 'A.'\nsamples = 1",
}


def record(without: str = "", **changes: Any) -> Record:
    data = {key: value for key, value in (RECORD | changes).items() if key != without}
    return from_json(json.dumps(data), "out/hills/dawn.json")


@each("row", rows("verify"), ids=lambda row: row["call"][:60])
def test_a_mistake_is_one_message(row: Row, tmp_path: Path) -> None:
    def file(text: str) -> Path:
        (tmp_path / "file").write_text(text)
        return tmp_path / "file"

    def written(sketch: str, shot: str) -> Record:
        return write_result(tmp_path / "out", Record(sketch=sketch, shot=shot, word="same", message=""), {})

    names = NAMES | {"HERE": tmp_path, "record": record, "written": written}
    names |= {"figures": lambda text: read(file(text))}
    names |= {"mutants": lambda text: rendering_mutants(file(f"[[mutant]]\n{text}\n"))}
    with pytest.raises((PlaygroundError, ValueError)) as caught:
        eval(row["call"], names)
    message = str(caught.value)
    assert row["names"] in message and "\n" not in message
    assert message.startswith("out/hills/dawn.json: ") or not row["call"].startswith("record")
    assert not (tmp_path / "out").exists()

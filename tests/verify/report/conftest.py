"""Results as a run of pytest leaves them, for what shows and accepts them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.data.image_files import encode_png
from playground.verify.shots.compare import compare, difference_picture
from playground.verify.shots.references import accepted_in
from playground.verify.shots.results import Record, digests_of, record_of, write_result

from .pictures import BEFORE, TEXTS


@pytest.fixture
def leave(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Record]:
    """Give what leaves a result in ``results/``, and a reference in ``screenshots/`` where one is given."""
    monkeypatch.chdir(tmp_path)

    def leave(
        name: str = "hills/dawn",
        actual: NDArray[np.uint8] | None = None,
        expected: NDArray[np.uint8] | None = None,
        **fields: object,
    ) -> Record:
        sketch, shot = name.split("/")
        position = tmp_path / "screenshots" / sketch / "llvmpipe"
        pictures = {}
        values: dict[str, object] = {"word": "crash", "message": "the process died"}
        if actual is not None:
            result = compare(actual, expected)
            values = {"word": result.verdict, "message": str(result), "renderer": "llvmpipe", "texts": TEXTS}
            values |= {"size": result.size, "expected_size": result.expected_size, "place": result.position}
            values |= {"root": str(tmp_path), "home": "screenshots"}
            pictures = {"actual": actual}
        if expected is not None:
            position.mkdir(parents=True, exist_ok=True)
            (position / f"{shot}.png").write_bytes(encode_png(expected, BEFORE))
            files = accepted_in(position, shot)
            values |= {"expected_texts": BEFORE, "compared": f"{shot}.png", "references": digests_of(files)}
            values |= {
                "tier": "same build",
                "fingerprint": ("OpenGL version: 22.3.6; the reference's: 22.3.5",),
            }
            assert actual is not None
            pictures |= {"expected": expected, "difference": difference_picture(actual, expected)}
        record = record_of({"sketch": sketch, "shot": shot, **values, **fields})
        return write_result(tmp_path / "results", record, {} if record.ok else pictures)

    return leave

"""What a checked shot tells of itself in ``--junitxml``: a property each, beginning with ``shot``.

    shot                        the picture's name, "hills/dawn"; what follows it is of that one
    shot.result                 "same", or why it fails: "differs", "missing", …
    shot.renderer               what drew it, as the folders of references are named
    shot.reference              the reference that it was held against
    shot.stands-in              whose references stood in for that renderer's, if any did
    shot.score.<number>         what was measured, with its unit, as the report has it
    shot.picture.<word>         its pictures, unless it passed: actual, expected, difference, flip, masked

Paths are from the folder in which the tests were started where they lie in that.
"""

from __future__ import annotations

from pathlib import Path

from playground.verify.shots.plugin_constants import SHOT
from playground.verify.shots.results import Record


def properties_of(folder: Path, record: Record) -> list[tuple[str, object]]:
    """Return the properties of a record that was written into the results folder ``folder``."""
    root = Path(record.run.root)
    properties = {
        SHOT: f"{record.sketch}/{record.shot}",
        "shot.result": record.word,
        "shot.renderer": record.renderer,
        "shot.reference": record.expected.reference,
        "shot.stands-in": record.expected.stands_in,
        **{f"shot.score.{name}": f"{value:.6g}" for name, value in record.numbers.items()},
        **{
            f"shot.picture.{word}": (folder.relative_to(root) / name).as_posix()
            if folder.is_relative_to(root)
            else str(folder / name)
            for word, name in record.actual.pictures.items()
        },
    }
    return [(name, value) for name, value in properties.items() if value]

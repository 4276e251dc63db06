"""Each edit of passes, on the sketches that ship: they load, comments stay, undo restores every byte."""

from __future__ import annotations

import random
import re
import shutil
from collections import Counter
from pathlib import Path

import pytest

from playground.errors import PlaygroundError
from playground.paths import SKETCHES
from playground.sketch.edit_passes import wires_of
from playground.sketch.toml_text import blocks
from playground.studio.bench import Workbench
from playground.studio.interface import WindowControls

from ..loading import load
from .session_desk import OpenSession

COMMENT = re.compile(r"""^(?:[^"'#\n]|"(?:[^"\\\n]|\\.)*"|'[^'\n]*')*(#.*)$""", re.MULTILINE)
KINDS = ("add", "insert", "put", "wire", "duplicate", "move", "mute", "delete")


def comments(text: str) -> Counter[str]:
    return Counter(COMMENT.findall(text))


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(SKETCHES.glob("*.toml")), ids=lambda path: path.stem)
def test_edits_of_shipped_sketches(path: Path, tmp_path: Path, open_session: OpenSession) -> None:
    """In an order by chance, each kind once at least; what is refused leaves the file alone."""
    file = tmp_path / path.name
    text = re.sub(r"\A((?:(?!\[\[).*\n)*?size\s*= )\d+\b", r"\g<1>33", path.read_text(encoding="utf-8"))
    file.write_text(text, encoding="utf-8")
    for other in SKETCHES.iterdir():
        if other.is_dir() and other.name in text:
            shutil.copytree(other, tmp_path / other.name)
    try:
        load(file)
    except PlaygroundError:
        pytest.skip("it needs files of its own")
    session = open_session(file)
    session.frame((16, 16))
    if session.shown is None:
        pytest.skip(f"it cannot be drawn: {session.error}")
    bench = Workbench(session, WindowControls(lambda: None), folder=tmp_path)
    edits, chance, texts = bench.passes, random.Random(path.stem), [file.read_bytes()]
    for kind in (*KINDS, *chance.choices(KINDS, k=4)):
        draft = edits.draft
        assert draft is not None
        names = [spec.name for spec in draft.file.graph.passes if spec.name != "view"]
        name, wires = chance.choice(names), wires_of(draft.file.graph)
        wire = chance.choice(wires) if wires else None
        before = file.read_text(encoding="utf-8")
        kept = comments(before)
        if kind == "add":
            edits.add("generation/smooth", name)
        elif kind == "insert" and wire is not None:
            edits.add("generation/smooth", on=(wire.reader, wire.input))
        elif kind == "put" and wire is not None:
            edits.put(name, wire.reader, wire.input)
        elif kind == "wire" and wire is not None:
            edits.wire(name, wire.output, wire.reader, wire.input)
        elif kind == "duplicate":
            edits.duplicate(name)
        elif kind == "move":
            edits.move(name, chance.choice((-1, 1)))
        elif kind == "mute":
            edits.mute(name)
            assert file.read_bytes() == texts[-1]
        elif kind == "delete" and edits.delete(name):
            start, end = blocks(before, "pass")[names.index(name)]
            kept = comments(before[:start] + before[end:])
        load(file)
        assert not kept - comments(file.read_text(encoding="utf-8")), kind
        if file.read_bytes() != texts[-1]:
            texts.append(file.read_bytes())
    assert bench.undo.history.done == len(texts) - 1 >= 2
    for text in reversed(texts[:-1]):
        bench.undo.undo()
        assert file.read_bytes() == text
    for text in texts[1:]:
        bench.undo.redo()
        assert file.read_bytes() == text

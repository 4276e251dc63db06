"""What is no regular file is never opened, and is refused in a message wherever a file may be named."""

from __future__ import annotations

import os
import signal
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.allowed_files import ELEVATIONS, VECTORS
from playground.data.content_hash import content_hash, content_key
from playground.data.elevation import read_elevation
from playground.data.image_files import picture_size, read_image, read_png
from playground.data.media import film_of, open_media
from playground.data.models import read_model
from playground.data.vectors import read_vectors
from playground.errors import PlaygroundError
from playground.flight.record import read_record
from playground.publish.export_formats import refuse_foreign_files
from playground.shader.source import read_source, read_text
from playground.sketch.files import find_file
from playground.sketch.find import find
from playground.sketch.load import load
from playground.studio.code.open_files import OpenText
from playground.verify.shots.results import digests_of, read_result

pytestmark = pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system's folders hold files alone")

READERS = [
    ("a.glsl", read_text),
    ("a.glsl", lambda path: read_source(path, (path.parent,))),
    ("a.glsl", find),
    ("a.glsl", load),
    ("a.toml", load),
    ("a.json", load),
    ("a.zip", load),
    ("a.glsl", OpenText.read),
    ("a.png", read_image),
    ("a.png", read_png),
    ("a.png", picture_size),
    ("a.png", content_hash),
    ("a.png", content_key),
    ("a.png", lambda path: digests_of([path])),
    ("a.png", lambda path: find_file(path.name, str(path.parent), str(path.parent / "k.glsl"), "image")),
    ("a.mp4", film_of),
    ("a.wav", lambda path: open_media(path, "a sound", (".wav",))),
    ("a.glb", read_model),
    ("a.json", read_result),
    ("a.txt", read_record),
    ("a.prj", lambda path: refuse_foreign_files(path.with_suffix(".tif"), [path])),
    *((f"a{ending}", read_elevation) for ending in ELEVATIONS),
    *((f"a{ending}", read_vectors) for ending in VECTORS),
]


@pytest.fixture(autouse=True)
def limit() -> Iterator[None]:
    """End a test that waits for a writer or reads for ever."""

    def late(*_: object) -> None:
        raise TimeoutError("it was opened")

    before = signal.signal(signal.SIGALRM, late)
    signal.setitimer(signal.ITIMER_REAL, 5.0)
    yield
    signal.setitimer(signal.ITIMER_REAL, 0.0)
    signal.signal(signal.SIGALRM, before)


def put(kind: str, path: Path) -> None:
    """Put what is no regular file at a path."""
    if kind == "FIFO":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    else:
        with socket.socket(socket.AF_UNIX) as item:
            item.bind(str(path))


@pytest.mark.parametrize("kind", ["FIFO", "device", "socket"])
def test_no_reader_opens_what_is_no_file(tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # a socket's path may be no longer than some hundred bytes
    for number, (name, read) in enumerate(READERS):
        folder = Path(f"{number}")
        folder.mkdir()
        put(kind, folder / name)
        with pytest.raises(PlaygroundError) as caught:
            read(tmp_path / folder / name)
        message = str(caught.value)
        if (
            kind == "device" and "lies outside" in message
        ):  # as any link that leads out of the sketch's folder
            continue
        assert f"this is a {kind}, not a file" in message, (name, read, message)


def test_a_file_next_to_it_that_is_none_is_not_opened(tmp_path: Path) -> None:
    (tmp_path / "a.asc").write_text("ncols 2\nnrows 2\ncellsize 1\nxllcorner 0\nyllcorner 0\n1 2\n3 4\n")
    os.mkfifo(tmp_path / "a.prj")
    with pytest.raises(PlaygroundError, match=r"a\.prj: this is a FIFO, not a file"):
        read_elevation(tmp_path / "a.asc")
    (tmp_path / "a.shp").write_bytes(b"\0\0\x27\x0a" + bytes(96))
    os.mkfifo(tmp_path / "a.dbf")
    with pytest.raises(PlaygroundError, match=r"a\.dbf: this is a FIFO, not a file"):
        read_vectors(tmp_path / "a.shp")


def test_a_folder_whose_sketch_is_none_says_so(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "sketch.toml")
    with pytest.raises(PlaygroundError, match=r"sketch\.toml: this is a FIFO, not a file"):
        load(tmp_path)


def test_an_include_and_a_technique_that_are_none_are_named(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "part.glsl")
    (tmp_path / "k.glsl").write_text('#include "part.glsl"\n#pragma kernel(output = "height:r32f")\n')
    with pytest.raises(PlaygroundError, match=r"k\.glsl:1.*'part\.glsl': this is a FIFO, not a file"):
        load(tmp_path / "k.glsl")
    (tmp_path / "sketch.toml").write_text('format = 1\n[[pass]]\nname = "height"\nuse = "./part"\n')
    with pytest.raises(PlaygroundError, match=r"'\./part': this is a FIFO, not a file"):
        load(tmp_path)

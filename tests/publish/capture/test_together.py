"""Files that belong together: all or none, and no other program's is replaced."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import playground
from playground import DataError, Sketch
from playground.engine.engine import Engine
from playground.publish.export import write_together

ROOT = Path(__file__).resolve().parents[3]


def test_all_take_their_names_or_none(tmp_path: Path):
    (tmp_path / "a").write_bytes(b"before")
    with pytest.raises(DataError, match="there is no folder"):
        write_together({tmp_path / "a": b"after", tmp_path / "none" / "b": b"after"})
    assert (tmp_path / "a").read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]
    write_together({tmp_path / "a": b"after", tmp_path / "b": b"after"})
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes() == b"after"


FULL = """
import resource, signal, sys
from pathlib import Path
from playground.publish.export import write_together
from playground.errors import DataError
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    write_together({Path("terrain.mtl"): b"small", Path("terrain.obj"): bytes(200_000)})
except DataError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no limit to a file's size can be set")
def test_a_disk_that_fills_up_leaves_nothing_half_written(tmp_path: Path):
    done = subprocess.run(
        [sys.executable, "-c", FULL],
        cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, timeout=180,
    )  # fmt: skip
    assert done.stdout == "terrain.obj: cannot be written: File too large\n", done.stderr
    assert not list(tmp_path.iterdir())


def test_a_folder_that_may_not_be_written_to_is_a_sentence(
    any_engine: Engine, lop: Sketch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def refused(self: Path, *_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied", str(self))

    real = Path.open
    monkeypatch.setattr(Path, "open", lambda p, m="r", **k: refused(p) if "x" in m else real(p, m, **k))
    with pytest.raises(DataError, match=r"terrain\.glb: cannot be written: Permission denied"):
        playground.export(lop, tmp_path / "terrain.glb", engine=any_engine)


def test_a_sidecar_replaces_only_what_an_export_wrote(any_engine: Engine, lop: Sketch, tmp_path: Path):
    for name, sidecar in (("a.obj", "a-texture.png"), ("b.obj", "b.mtl"), ("a.r16", "a.r16.json")):
        mine = tmp_path / sidecar
        mine.write_bytes(b"my own work")
        with pytest.raises(DataError, match=rf"{name}: {sidecar} is there already, and no export wrote it"):
            playground.export(lop, tmp_path / name, engine=any_engine)
        assert mine.read_bytes() == b"my own work" and not (tmp_path / name).exists()
        mine.unlink()
        first = playground.export(lop, tmp_path / name, engine=any_engine)
        again = playground.export(lop.with_values({"relief": 500}), tmp_path / name, engine=any_engine)
        assert first.sidecars == again.sidecars and mine in again.sidecars

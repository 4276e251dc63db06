"""A file that a parameter names is found as it is now, whatever was found before."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.errors import DataError
from playground.sketch import files
from playground.sketch.files import find_file


@pytest.fixture
def places(tmp_path: Path) -> tuple[Path, Path]:
    """Give the folder of a sketch, and in it that of a kernel."""
    sketch = tmp_path / "sketch"
    kernel = sketch / "kernels"
    kernel.mkdir(parents=True)
    return sketch, kernel


def found(places: tuple[Path, Path], text: str = "p.png") -> Path:
    return find_file(text, str(places[0]), str(places[1] / "k.glsl"), "picture")


def test_a_file_that_stays_is_not_looked_for_anew(places, monkeypatch):
    (places[1] / "p.png").write_bytes(b"1")
    assert found(places) == places[1] / "p.png"
    monkeypatch.setattr(files.Path, "resolve", lambda *_: pytest.fail("its links are followed again"))
    assert found(places) == places[1] / "p.png"


def test_file_appearing_in_first_search_folder_is_found(places):
    (places[1] / "p.png").write_bytes(b"1")
    assert found(places) == places[1] / "p.png"
    (places[0] / "p.png").write_bytes(b"2")
    assert found(places) == places[0] / "p.png"


def test_one_that_goes_is_missed_and_one_that_is_replaced_found(places):
    file = places[0] / "p.png"
    file.write_bytes(b"1")
    assert found(places) == file
    file.unlink()
    with pytest.raises(DataError, match="no such file"):
        found(places)
    file.write_bytes(b"2")
    assert found(places) == file


def test_a_link_that_leads_elsewhere_is_followed_there(places, tmp_path):
    for name in ("one", "two"):
        (places[0] / name).mkdir()
        (places[0] / name / "p.png").write_bytes(b"1")
    link = places[0] / "link"
    link.symlink_to("one", target_is_directory=True)
    assert found(places, "link/p.png") == places[0] / "one" / "p.png"
    link.unlink()
    link.symlink_to("two", target_is_directory=True)
    assert found(places, "link/p.png") == places[0] / "two" / "p.png"
    link.unlink()
    (tmp_path / "p.png").write_bytes(b"1")
    link.symlink_to(tmp_path, target_is_directory=True)
    with pytest.raises(DataError):
        found(places, "link/p.png")


def test_sidecar_link_out_of_folder_is_refused_once_it_appears(places, tmp_path):
    (places[0] / "dem.asc").write_text("1", encoding="utf-8")
    assert found(places, "dem.asc") == places[0] / "dem.asc"
    (tmp_path / "dem.prj").write_text("1", encoding="utf-8")
    (places[0] / "dem.prj").symlink_to(tmp_path / "dem.prj")
    with pytest.raises(DataError, match="leads out of the sketch's folder"):
        found(places, "dem.asc")

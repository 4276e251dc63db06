"""``playground cache``: terrain that is cached on disk is shown and removed; the doctor reports it."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest

from playground import cli
from playground.commands.cache import in_bytes
from playground.engine.disk_cache import CachedTextures, DiskCache, cache_directory

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="the folder is set by XDG_CACHE_HOME"
)


@pytest.fixture
def cached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make a cache with the textures of two passes, a damaged file, and something else."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("PLAYGROUND_CACHE", raising=False)
    store = DiskCache(cache_directory())
    data = memoryview(bytes(256 * 256 * 4))
    store.write("one", CachedTextures((256, 256), (("height", "r32f"),), 1234.5, "alps: height", (data,)))
    store.write("two", CachedTextures((256, 256), (("light", "rgba8"),), 80.25, "alps: light", (data,)))
    store.close()
    os.utime(store.path_of("two"), (1e9, 1e9))
    (cache_directory() / "broken.land").write_bytes(b"x")
    os.utime(cache_directory() / "broken.land", (9e8, 9e8))
    (tmp_path / "terrain-shader-playground" / "packs").mkdir()
    return tmp_path


def test_show_names_every_pass_used_last_first(cached: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["cache", "show"]) == 0
    first, item, two, broken = capsys.readouterr().out.splitlines()
    assert first == f"3 files, 512 KiB of at most 1.0 GiB, in {cache_directory()}"
    assert item == "alps: height\t256x256\t256 KiB\t1.2 s\tjust now"
    assert two.startswith("alps: light\t256x256\t256 KiB\t80 ms\t") and two.endswith("days ago")
    assert broken.startswith("(damaged)\t\t1 byte\t\t")


def test_show_as_json(cached: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["cache", "show", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["folder"] == str(cache_directory()) and result["most_bytes"] == 2**30
    assert result["bytes"] == sum(each["bytes"] for each in result["files"])
    item, two, broken = result["files"]
    assert (item["made_for"], item["size"], item["outputs"], item["cost_ms"]) == (
        "alps: height",
        [256, 256],
        {"height": "r32f"},
        1234.5,
    )
    assert two["used"] == 1e9 and broken["made_for"] is None


def test_clear_removes_terrain_and_nothing_else(cached: Path, capsys: pytest.CaptureFixture[str]):
    (cache_directory() / "notes.txt").write_text("mine")
    assert cli.main(["cache", "clear"]) == 0
    assert capsys.readouterr().out == "3 files removed, 512 KiB\n"
    assert [path.name for path in cache_directory().iterdir()] == ["notes.txt"]
    assert (cache_directory().parent / "packs").is_dir()
    assert cli.main(["cache", "show"]) == 0
    assert capsys.readouterr().out == f"0 files, 0 bytes of at most 1.0 GiB, in {cache_directory()}\n"
    assert cli.main(["cache", "clear"]) == 0
    assert capsys.readouterr().out == "0 files removed, 0 bytes\n"


def test_the_bound_is_the_environments(
    cached: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("PLAYGROUND_CACHE", "250M")
    assert cli.main(["cache", "show"]) == 0
    assert "of at most 250 MiB" in capsys.readouterr().out
    monkeypatch.setenv("PLAYGROUND_CACHE", "0")
    assert cli.main(["cache", "show"]) == 0
    assert "(PLAYGROUND_CACHE turns caching off)" in capsys.readouterr().out
    monkeypatch.setenv("PLAYGROUND_CACHE", "plenty")
    for command in (["cache", "show"], ["live"]):
        monkeypatch.setenv("DISPLAY", ":0")
        assert cli.main(command) == 2
        assert capsys.readouterr().err == (
            "error: PLAYGROUND_CACHE=plenty: expected a size, as 500M or 2G, or 0 to cache nothing\n"
        )


@pytest.mark.slow
def test_the_doctor_says_size_and_place(cached: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["doctor", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)["cache"]
    assert result == {
        "folder": str(cache_directory()),
        "files": 3,
        "bytes": result["bytes"],
        "most_bytes": 2**30,
    }
    assert result["bytes"] == sum(path.stat().st_size for path in cache_directory().iterdir())
    assert cli.main(["doctor"]) == 0
    assert f"3 files, 512 KiB of at most 1.0 GiB, in {cache_directory()}" in capsys.readouterr().out


def test_the_group_alone_lists_its_commands(cached: Path, capsys: pytest.CaptureFixture[str]):
    assert cli.main(["cache"]) == 0
    assert "playground cache clear" in capsys.readouterr().out


def test_sizes_are_formatted():
    texts = {0: "0 bytes", 999: "999 bytes", 1000: "1.0 KiB", 2**20: "1.0 MiB", 250 * 2**20: "250 MiB"}
    texts |= {2**30: "1.0 GiB", 3 * 2**29: "1.5 GiB", 5 * 2**40: "5.0 TiB"}
    assert {size: in_bytes(size) for size in texts} == texts


def test_a_picture_for_a_file_keeps_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.chdir(tmp_path)
    assert (
        cli.main(["render", "contours_map", "-o", "terrain.png", "--size", "64x36", "--set", "size=65"]) == 0
    )
    assert (tmp_path / "terrain.png").is_file() and not cache_directory().exists()

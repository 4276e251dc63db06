"""An elevation file on the command line: opened alone, large in little memory, mistakes as sentences."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from PIL import Image

from playground import cli

from ..elevations import write_geotiff


@pytest.mark.slow
def test_a_file_is_rendered_exported_checked_and_packed(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_geotiff(tmp_path / "dem.tif")
    assert cli.main(["render", "dem.tif", "-o", "a.png", "--size", "96x54"]) == 0
    with Image.open("a.png") as picture:
        assert picture.size == (96, 54) and np.asarray(picture)[..., :3].std() > 5
    assert cli.main(["export", "dem.tif", "--to", "b.tif", "--texture", "colour"]) == 0
    assert cli.main(["check", "dem.tif"]) == 0
    assert cli.main(["pack", "dem.tif"]) == 0
    assert cli.main(["render", "dem.zip", "-o", "c.png", "--size", "96x54"]) == 0
    assert (tmp_path / "a.png").read_bytes()[-2000:] == (tmp_path / "c.png").read_bytes()[-2000:]
    assert "warning" not in capsys.readouterr().err


@pytest.mark.slow
def test_a_page_of_a_file_has_its_sketch_to_edit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_geotiff(tmp_path / "dem.tif")
    assert cli.main(["export", "dem.tif", "--to", "page.html"]) == 0
    assert (tmp_path / "page.html").stat().st_size > 100_000


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.tif", b"hello", "a.tif: not a TIFF file, although its name ends like one"),
        ("a.hgt", b"x" * 7, "a.hgt: is no SRTM tile; expected 1201 x 1201"),
        ("a.asc", b"what is this", "a.asc: is no ESRI grid; expected a header of ncols"),
        ("a.bil", b"0000", "a.bil: needs a.hdr next to it"),
        ("a.npy", b"\x93NUMPY", "a.npy: the file is damaged or cut short"),
        ("a.nc", b"CDF", "a.nc: "),
        ("a.vrt", b"<VRTDataset", "a.vrt: is no VRT; expected <VRTDataset>"),
        ("a.img", b"EHFA", "a.img: is no .img file to GDAL's driver HFA"),
        ("a.jp2", b"jp2", "a.jp2: is no .jp2 file to GDAL's driver JP2OpenJPEG"),
        ("a.gpkg", b"SQLite", "a.gpkg: holds no raster"),
    ],
)
def test_what_is_no_elevation_file_is_one_sentence(tmp_path, monkeypatch, capsys, name, content, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_bytes(content)
    assert cli.main(["render", name]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: {words}") and said.count("\n") == 1 and said.count(name) <= 2


MEMORY = (
    "import resource, subprocess, sys\n"
    "subprocess.run([sys.executable, '-m', 'playground', *sys.argv[1:]], check=True, stdout=sys.stderr)\n"
    "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)\n"
)
"""A program that prints the most memory of a command, which begins with no more than this small one has."""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="the memory of a process is asked for as on Unix")
def test_dem_of_10000_squared_opens_in_under_two_gibibytes(tmp_path):
    """400 MB of holes, after a hill."""
    with (tmp_path / "dem.npy").open("wb") as file:
        head = {"descr": "<f4", "fortran_order": False, "shape": (10_000, 10_000)}
        np.lib.format.write_array_header_1_0(file, head)
        np.linspace(0.0, 900.0, 2**20, dtype="<f4").tofile(file)
        file.truncate(file.tell() + 4 * (10_000**2 - 2**20))
    command = [sys.executable, "-c", MEMORY, "render", "dem.npy", "-o", "a.png", "--size", "320x180"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    unit = 1 if sys.platform == "darwin" else 1024  # [bytes] of its numbers
    assert int(done.stdout) * unit < 2 * 2**30

"""Two packages with one name to import: the command says whose it is, and what to do."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

from playground import cli
from playground.commands.import_name import DISTRIBUTION, other_owners

ROOT = Path(__file__).resolve().parent.parent.parent


def install(folder: Path, name: str, *files: str) -> None:
    """Write what pip writes of a distribution that has these files, and those that are not there yet."""
    info = folder / f"{name.replace('-', '_')}-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (info / "direct_url.json").write_text('{"url": "file:///a/b.whl", "archive_info": {}}')
    (info / "RECORD").write_text("".join(f"{file},,\n" for file in files))
    for file in map(folder.joinpath, files):  # Python 3.13 counts no file that is missing
        file.parent.mkdir(exist_ok=True)
        file.touch()


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """Give a folder of installed packages in which this one is."""
    shutil.copytree(
        ROOT / "playground",
        tmp_path / "playground",
        ignore=shutil.ignore_patterns("node_modules", "__pycache__", "texts", "runtime", "bundle"),
    )
    install(tmp_path, DISTRIBUTION, "playground/__init__.py", "playground/cli.py")
    return tmp_path


def run(site: Path) -> subprocess.CompletedProcess[str]:
    """Start the command where the folder comes first, and this checkout (a .pth file) is not found at all."""
    code = "import sys; from playground.cli import main; sys.exit(main(['--version']))"
    paths = os.pathsep.join([str(site), sysconfig.get_path("purelib"), sysconfig.get_path("platlib")])
    return subprocess.run(
        [sys.executable, "-S", "-c", code],
        cwd=site.parent,
        env=os.environ | {"PYTHONPATH": paths},
        capture_output=True,
        text=True,
        timeout=60,
    )


@pytest.mark.slow
def test_a_package_that_has_overwritten_this_one_is_named(site: Path):
    assert run(site).returncode == 0
    install(site, "swings-and-slides", "playground/__init__.py", "playground/swing.py")
    (site / "playground" / "__init__.py").write_text('"""Swings."""\n')
    done = run(site)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        f"error: 'import playground' gives {site / 'playground' / '__init__.py'}, which belongs not to"
        f" {DISTRIBUTION} but to swings-and-slides: python -m pip uninstall swings-and-slides, then"
        f' {sys.executable} -m pip install --force-reinstall --no-deps "file:///a/b.whl"\n'
    )


@pytest.mark.slow
def test_uninstall_removing_shared_file_is_reported_with_fix(site: Path):
    (site / "playground" / "__init__.py").unlink()
    done = run(site)
    assert done.returncode == 2 and done.stderr.count("\n") == 1
    assert done.stderr.endswith(
        f': {sys.executable} -m pip install --force-reinstall --no-deps "file:///a/b.whl"\n'
    )


@pytest.mark.slow
def test_doctor_finds_one_that_does_no_harm_yet(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    assert other_owners() == []
    install(tmp_path, "swings-and-slides", "playground/swing.py")
    monkeypatch.syspath_prepend(tmp_path)
    assert other_owners() == ["swings-and-slides"]
    assert cli.main(["doctor"]) == 1
    message = (
        "1 other package here, swings-and-slides, has a module 'playground' too: python -m pip uninstall"
    )
    assert message in capsys.readouterr().err
    assert cli.main(["doctor", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["other_playgrounds"] == ["swings-and-slides"]

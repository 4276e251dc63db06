"""./play keeps .venv what it must be: its extras stay, and a copy of the playground is replaced.

Its Python is a stub whose pip installs nothing and writes down what it is asked for.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
STUB = """#!/bin/sh
site=$(dirname "$0")/../lib/python3.11/site-packages
case $* in
    *"pip install"*)
        printf '%s\\n' "${*##* -e }" >>"{root}/asked"
        [ ! -e "{root}/no-network" ] || exit 1
        rm -rf "$site/playground"
        mkdir -p "$site"
        printf '%s' "{root}" >"$site/_editable.pth" ;;
    *"pip --version"* | "-I - "*) ;;
    *"-m pytest"*) echo "pytest $*" ;;
    *) exec "{python}" "$@" ;;
esac
"""

pytestmark = pytest.mark.skipif(os.name == "nt", reason="play is for sh; play.cmd does it there")


class Checkout:
    def __init__(self, root: Path) -> None:
        self.root, self.venv = root, root / ".venv"
        self.site = self.venv / "lib" / "python3.11" / "site-packages"
        (self.venv / "bin").mkdir(parents=True)
        (root / "playground").mkdir()
        for name in ("play", "pyproject.toml", "playground/_version.py"):
            shutil.copy(ROOT / name, root / name)
        stub = STUB.replace("{root}", str(root)).replace("{python}", sys.executable)
        echo = '#!/bin/sh\necho "started $*"\necho "as $PLAYGROUND_PROGRAM"\n'
        for name, text in (("python", stub), ("playground", echo)):
            (self.venv / "bin" / name).write_text(text)
            (self.venv / "bin" / name).chmod(0o755)

    def play(self, *words: str, status: int = 0) -> str:
        """Start ./play and return what it says."""
        done = subprocess.run(
            [str(self.root / "play"), *words],
            capture_output=True,
            text=True,
            cwd=self.root.parent,
            env=os.environ | {"PLAY_NO_APT": "1"},
            timeout=60,
        )
        assert done.returncode == status, done.stderr
        return done.stdout + done.stderr

    def asked(self) -> list[str]:
        """Return the extras that pip was asked for since the last call, "" for none."""
        file = self.root / "asked"
        result = file.read_text().splitlines() if file.exists() else []
        file.unlink(missing_ok=True)
        return [line.removeprefix(str(self.root)).strip("[]") for line in result]

    def edit(self) -> None:
        """Change what .venv was made from."""
        with (self.root / "pyproject.toml").open("a") as file:
            file.write("# another line\n")


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    made = Checkout(tmp_path / "my land")
    assert f"as {made.root}/play\n" in made.play("live") and made.asked() == [""]
    assert "started --version" in made.play("--version") and made.asked() == []
    return made


def test_extras_stay_when_the_environment_is_refreshed(checkout: Checkout):
    assert ".venv has gis,video" in checkout.play("add", "gis", "video", "gis")
    assert checkout.asked() == ["gis,video"]
    checkout.play("add", "video")
    assert checkout.asked() == []
    assert "pytest" in checkout.play("test", "a")
    checkout.play("add", "lsp")
    assert checkout.asked() == ["gis,video,test", "gis,video,test,lsp"]
    checkout.edit()
    checkout.play("live")
    assert checkout.asked() == ["gis,video,test,lsp"]


def test_extras_stay_when_a_refresh_fails(checkout: Checkout):
    checkout.play("add", "gis")
    checkout.edit()
    (checkout.root / "no-network").touch()
    assert "could not be installed with gis" in checkout.play("live", status=1)
    (checkout.root / "no-network").unlink()
    assert "started live" in checkout.play("live")
    assert checkout.asked() == ["gis"] * 3


def test_an_extra_that_cannot_be_installed_breaks_nothing(checkout: Checkout):
    (checkout.root / "no-network").touch()
    assert "midi could not be installed" in checkout.play("add", "midi", status=1)
    assert checkout.asked() == ["midi"]
    assert "started live" in checkout.play("live") and checkout.asked() == []


def test_extras_are_listed_and_a_wrong_name_is_refused(checkout: Checkout):
    assert "xarray" in checkout.play("add")
    assert "no extra 'vidoe'; did you mean 'video'?" in checkout.play("add", "gis", "vidoe", status=2)
    assert checkout.asked() == []


@pytest.mark.parametrize("removed", [False, True])
def test_a_copy_of_the_playground_is_replaced(checkout: Checkout, removed: bool):
    """As ``pip install .`` leaves it; an editable one may have an empty folder of that name."""
    checkout.play("add", "docs")
    (checkout.site / "playground" / "glsl").mkdir(parents=True)
    checkout.play("live")
    assert checkout.asked() == ["docs"]
    (checkout.site / "_editable.pth").unlink()
    if not removed:
        (checkout.site / "playground" / "__init__.py").touch()
    said = checkout.play("live")
    assert "copy of the playground, which does not follow this checkout" in said and "started live" in said
    assert checkout.asked() == ["docs"]
    checkout.play("live")
    assert checkout.asked() == []

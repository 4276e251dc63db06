"""The action of GitHub for other projects: its steps, and the pictures that it puts into a branch."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest
import yaml

from playground import paths

assert paths.CHECKOUT is not None
FOLDER = paths.CHECKOUT / ".github" / "actions" / "shots"

pytestmark = pytest.mark.skipif(
    not (shutil.which("git") and shutil.which("bash")), reason="needs git and bash"
)


def test_each_step_says_its_shell_or_its_action_with_a_version() -> None:
    action = yaml.safe_load((FOLDER / "action.yml").read_text(encoding="utf-8"))
    assert action["runs"]["using"] == "composite"
    for step in action["runs"]["steps"]:
        assert ("run" in step and step["shell"] == "bash") or "@v" in step["uses"], step
    text = str(action["runs"])
    assert all(f"inputs.{name}" in text for name in action["inputs"])
    # What a step is given is never written into its text, where a shell would run what is in it.
    assert not [step for step in action["runs"]["steps"] if "inputs." in step.get("run", "")]


def git(folder: Path, *words: str) -> str:
    done = subprocess.run(["git", "-C", str(folder), *words], check=True, capture_output=True, text=True)
    return done.stdout


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a clone of a repository with one commit, and a report with a failed shot."""
    for name in ("AUTHOR", "COMMITTER"):
        monkeypatch.setenv(f"GIT_{name}_NAME", "a")
        monkeypatch.setenv(f"GIT_{name}_EMAIL", "a@b")
    git(tmp_path, "init", "-q", "--bare", "-b", "main", "origin.git")
    git(tmp_path, "clone", "-q", "origin.git", "clone")
    clone = tmp_path / "clone"
    git(clone, "commit", "-q", "--allow-empty", "-m", "one")
    git(clone, "push", "-q", "origin", "HEAD:main")
    picture = clone / "shots-report" / "hills" / "at dawn.actual.png"
    picture.parent.mkdir(parents=True)
    picture.write_bytes(b"a picture")
    (picture.parent / "at dawn.json").write_text("{}")
    return clone


def publish(clone: Path, folder: str) -> list[str]:
    """Publish the report, and return the files of the branch."""
    command = ["bash", str(FOLDER / "publish.sh"), "shots-report", "shots", folder]
    subprocess.run(command, cwd=clone, check=True)
    git(clone, "fetch", "-q", "origin", "shots")
    return git(clone, "ls-tree", "-r", "--name-only", "FETCH_HEAD").splitlines()


def test_the_pictures_of_each_run_are_in_a_folder_of_their_own(clone: Path) -> None:
    assert publish(clone, "7-1-a") == ["7-1-a/hills/at dawn.actual.png"]
    assert publish(clone, "10-1-a") == ["10-1-a/hills/at dawn.actual.png", "7-1-a/hills/at dawn.actual.png"]
    assert git(clone, "rev-list", "--count", "origin/main").strip() == "1"
    assert (
        not (clone / ".git" / "rebase-merge").exists() and git(clone, "status", "--porcelain", "-uno") == ""
    )


def test_the_oldest_runs_go(clone: Path) -> None:
    publish(clone, "9-1-a")
    work = clone.parent / "more"
    git(clone.parent, "clone", "-q", "-b", "shots", "origin.git", "more")
    for number in range(10, 60):
        (work / f"{number}-1-a").mkdir()
        (work / f"{number}-1-a" / "a.png").write_bytes(b"")
    git(work, "add", "--all")
    git(work, "commit", "-q", "-m", "more")
    git(work, "push", "-q", "origin", "shots")
    runs = {name.split("/")[0] for name in publish(clone, "100-1-a")}
    assert len(runs) == 50
    assert "100-1-a" in runs and "59-1-a" in runs and not {"9-1-a", "10-1-a"} & runs

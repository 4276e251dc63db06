"""The bundles that ship are made of the sources as they are now."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

from playground.errors import PlaygroundError
from playground.publish.web import bundle

WEB = Path(bundle.__file__).parent
ENTRIES = re.compile(r"^const ENTRIES = \{(.*?)\};", re.MULTILINE | re.DOTALL)


def entries() -> set[str]:
    match = ENTRIES.search((WEB / "build.mjs").read_text())
    assert match
    return set(re.findall(r'"([\w.]+)":', match[1]))


def bundles() -> dict[str, Path]:
    remote = WEB.parents[1] / "studio" / "remote" / "page"
    return {path.name: path for path in [*bundle.BUNDLES.glob("*"), *remote.glob("remote.[jc]s*")]}


def test_every_entry_is_bundled_and_nothing_else():
    assert bundles().keys() == entries()


def test_every_bundle_is_made_of_the_sources_as_they_are():
    for name, path in bundles().items():
        assert bundle.sources_in(path.read_text("utf-8")) == bundle.hash_of_sources(), (
            f"{name}: run 'npm ci' and 'npm run build' in playground/publish/web"
        )


def test_the_hash_changes_with_a_source(tmp_path: Path):
    web = tmp_path / "publish" / "web"
    (web / "runtime").mkdir(parents=True)
    (tmp_path / "shader").mkdir()
    for name in ("build.mjs", "package-lock.json", "../../shader/widgets.json"):
        (web / name).write_bytes(b"")
    result = [bundle.hash_of_sources(web)]
    table = ("../../../shader/widgets.json", "{}")
    for name, text in (("b.js", "1"), ("b.js", "2"), ("a.js", ""), ("a.css", ""), table, ("README", "")):
        (web / "runtime" / name).write_text(text)
        result.append(bundle.hash_of_sources(web))
    assert result[-1] == result[-2]
    assert len(set(result)) == len(result) - 1


def test_a_bundle_that_is_not_there_is_a_sentence():
    with pytest.raises(PlaygroundError, match=r"nothing\.js is not built; run 'npm ci' and 'npm run build'"):
        bundle.read_bundle("nothing.js")


@pytest.mark.parametrize("text", ["a = '</script>'", "'</SCRIPT '", "'<!--'"])
def test_a_bundle_that_would_end_its_element_is_refused(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    (tmp_path / "page.js").write_text(text)
    monkeypatch.setattr(bundle, "BUNDLES", tmp_path)
    with pytest.raises(PlaygroundError, match="cannot stand in a page"):
        bundle.read_bundle("page.js")


def test_what_builds_is_pinned_and_names_no_address():
    versions = json.loads((WEB / "package.json").read_text())
    assert "dependencies" not in versions
    assert all(re.fullmatch(r"[\d.]+", version) for version in versions["devDependencies"].values())
    lock = (WEB / "package-lock.json").read_text()
    assert "resolved" not in lock and "://" not in lock


def test_what_node_installs_is_not_committed():
    done = subprocess.run(
        ["git", "check-ignore", "-q", str(WEB / "node_modules" / "x")], cwd=WEB, capture_output=True
    )
    assert done.returncode in (0, 128)  # 128: no checkout

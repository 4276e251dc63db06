"""Every command, technique, public name, key and term has its place in the generated pages."""

from __future__ import annotations

import inspect
import re
from dataclasses import replace
from pathlib import Path

import hooks
import pytest
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from site_pages import commands, gallery, keys, pages, python, shots, techniques

import playground
from playground.cli import command_line
from playground.commands.entries import techniques as listed
from playground.paths import GLSL
from playground.studio.keys import all_keys

from .pages import ROOT


def test_every_command_and_each_of_its_options_is_there():
    text = commands.page()

    def walk(name: str, command: object) -> None:
        assert re.search(rf"^##+ {name}$", text, re.MULTILINE), name
        part = text.partition(f" {name}\n\n")[2].partition("\n##")[0]
        for parameter in command.params:  # type: ignore[attr-defined]
            for option in parameter.opts if parameter.param_type_name == "option" else ():
                assert f"<code>{option}</code>" in part, (name, option)
        for child, result in getattr(command, "commands", {}).items():
            walk(f"{name} {child}", result)

    walk("playground", command_line())


@pytest.mark.slow
def test_every_technique_page_lists_parameters_and_description():
    named = {entry.name for entries in techniques.entries().values() for entry in entries}
    assert named == {entry.name for entry in listed()} and len(named) > 60
    index = techniques.index()
    for entries in techniques.entries().values():
        for entry in entries:
            text = techniques.page(entry)
            assert techniques.path_of(entry).rpartition("/")[2] in index
            for choice in entry.parameters:
                assert choice.path.replace("_", "&#95;") in text, (entry.name, choice.path)


def test_methods_name_their_source_and_their_checks():
    texts = [techniques.page(e) for names in techniques.entries().values() for e in names]
    assert sum("| Source of the method |" in text for text in texts) > 0.9 * len(texts)
    plain = " ".join(texts).replace("\\_", "_").replace("&#95;", "_")
    checks = set(re.findall(r"\btests/\w+/\w+\.py", plain))
    missing = [path for path in checks if not (ROOT / path).exists()]
    assert checks and not missing


def test_every_fast_variant_is_on_a_page():
    texts = "".join(techniques.page(e) for names in techniques.entries().values() for e in names)
    files = [path for ending in ("comp", "fast.toml") for path in GLSL.rglob(f"*.{ending}")]
    names = {path.relative_to(GLSL).as_posix().replace("_", "&#95;") for path in files}
    assert names and not {name for name in names if name not in texts}


def test_a_technique_that_says_nothing_of_itself_is_refused(tmp_path: Path):
    silent = tmp_path / "silent.glsl"
    silent.write_text('#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 t) { return 0.0; }\n')
    entry = replace(next(iter(techniques.entries()["generation"])), file=str(silent))
    with pytest.raises(ValueError, match="begins with no comment"):
        techniques.description(entry)


def test_most_techniques_have_a_picture():
    every = [e.name for names in techniques.entries().values() for e in names]
    without = [name for name in every if shots.picture_of(name) is None]
    assert len(without) <= len(every) // 10, without


def test_every_shot_with_a_reference_is_in_the_gallery():
    text = gallery.page()
    stems = re.compile(r"[^.]+")  # not morning.2, a further reference of morning
    files = [p for p in shots.SCREENSHOTS.glob(f"*/{shots.RENDERER}/*.png") if stems.fullmatch(p.stem)]
    assert len(files) > 200
    assert not [p for p in files if f"{p.parts[-3]}-{p.stem}.webp" not in text]


@pytest.mark.parametrize(
    ("module", "name", "value", "message"),
    [
        (shots, "SCREENSHOTS", Path("/nowhere"), r"^\d{3} pictures of the site missing: /nowhere/"),
        (pages, "PICTURES", {"a.webp": "nowhere.png"}, r"^1 picture of the site missing: \S*nowhere\.png$"),
        (hooks, "CHECKOUT", None, "whose pages would not follow .* ./play add docs"),
    ],
)
def test_the_site_is_not_built_without_its_pictures(monkeypatch, module, name, value, message):
    monkeypatch.setattr(module, name, value)
    with pytest.raises(PluginError, match=message):
        hooks.on_config(MkDocsConfig())


def test_every_public_name_is_in_reference_with_docstring():
    text = python.page()
    for name in playground.__all__:
        assert re.search(rf"\bplayground\.{name}\b", text), name
        assert name == "__version__" or inspect.getdoc(getattr(playground, name)), name


def test_every_key_is_in_the_table():
    text = keys.page()
    for key in all_keys():
        assert key.meaning.split(";")[0] in text, key.name


def test_links_of_a_text_from_elsewhere_lead_into_the_site():
    text = "[a](docs/how-to/fly.md#controls) [b](glsl/README.md) [c](LICENSE) [d](https://example.org)"
    assert pages.moved(text, "CONTRIBUTING.md", "contributing.md") == (
        "[a](how-to/fly.md#controls) [b](reference/shaders.md) c [d](https://example.org)"
    )

"""The extension for VS Code: its files agree with the project, and it starts the server."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from playground.allowed_files import SHADERS

FOLDER = Path(__file__).resolve().parents[2] / "docs" / "editors" / "vscode"
PACKAGE = json.loads((FOLDER / "package.json").read_text(encoding="utf-8"))

STUBS = """
const Module = require("module");
const real = Module._load;
const seen = [];
Module._load = (name, ...rest) => {
  if (name === "vscode")
    return {
      workspace: { getConfiguration: (part) => ({ get: (key) => settings[`${part}.${key}`].default }) },
      window: { showErrorMessage: (text) => seen.push(text) },
    };
  if (name === "vscode-languageclient/node")
    return { LanguageClient: class {
      constructor(...given) { seen.push(given); }
      async start() { throw new Error("ENOENT"); }
      async stop() { seen.push("stopped"); }
    } };
  return real(name, ...rest);
};
const settings = require(process.argv[1] + "/package.json").contributes.configuration.properties;
const extension = require(process.argv[1] + "/extension.js");
extension.activate().then(extension.deactivate).then(() => console.log(JSON.stringify(seen)));
"""


def test_its_endings_are_those_that_the_playground_reads() -> None:
    languages = {item["id"]: item for item in PACKAGE["contributes"]["languages"]}
    assert sorted(languages["glsl"]["extensions"]) == sorted(SHADERS)
    for language in languages.values():
        json.loads((FOLDER / language["configuration"]).read_text(encoding="utf-8"))


@pytest.mark.skipif(shutil.which("node") is None, reason="Node is not installed")
def test_it_starts_the_server_and_says_so_where_it_cannot() -> None:
    done = subprocess.run(
        ["node", "-e", STUBS, str(FOLDER)], capture_output=True, text=True, check=True, timeout=60
    )
    started, message, stopped = json.loads(done.stdout)
    assert started[2] == {"command": "playground", "args": ["lsp"]}
    selected = {(item["scheme"], item["language"]) for item in started[3]["documentSelector"]}
    assert selected == {(s, language) for s in ("file", "untitled") for language in ("glsl", "toml")}
    assert "ENOENT" in message and "playground.command" in message
    assert stopped == "stopped"

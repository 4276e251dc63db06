// Starts `playground lsp` and connects VS Code to it; all else is the server's.
"use strict";

const vscode = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;

async function activate() {
  const [command, ...args] = vscode.workspace.getConfiguration("playground").get("command");
  const languages = ["glsl", "toml"];
  client = new LanguageClient(
    "playground",
    "Terrain shader playground",
    { command, args },
    {
      documentSelector: languages.flatMap((language) => [
        { scheme: "file", language },
        { scheme: "untitled", language },
      ]),
    },
  );
  try {
    await client.start();
  } catch (error) {
    vscode.window.showErrorMessage(
      `${command} could not be started (${error.message}): install the playground with its extra lsp,` +
        " or name what starts it in the setting playground.command.",
    );
  }
}

async function deactivate() {
  await client?.stop();
}

module.exports = { activate, deactivate };

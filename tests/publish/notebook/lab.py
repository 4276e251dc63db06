"""A JupyterLab of its own, and a notebook of it in a browser."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType

import nbformat

from ...browser import GENEROUS, MESA, Browser
from ...browser import MISSING as NO_BROWSER

MISSING = NO_BROWSER or ("" if importlib.util.find_spec("jupyterlab") else "needs jupyterlab, for a browser")
NAME = "page.ipynb"
CELLS = "window.jupyterapp.shell.currentWidget.content.widgets"


class Lab:
    """A server in a folder, and a browser in which a notebook with some cells has run."""

    def __init__(self, folder: Path, cells: list[str], width: int = 1100, height: int = 1500) -> None:
        book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
        book.metadata["kernelspec"] = {"display_name": "", "language": "python", "name": "python3"}
        nbformat.write(book, folder / NAME)
        quiet = folder / "settings/@jupyterlab/apputils-extension/notification.jupyterlab-settings"
        quiet.parent.mkdir(parents=True)
        quiet.write_text('{"fetchNews": "false", "checkForUpdates": false}', encoding="utf-8")
        homes = {f"JUPYTER_{name}_DIR": str(folder / name.lower()) for name in ("CONFIG", "DATA", "RUNTIME")}
        own = {
            **homes,
            "JUPYTERLAB_SETTINGS_DIR": str(folder / "settings"),
            "IPYTHONDIR": str(folder / "ipython"),
        }
        command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--port=0"]
        command += [
            "--ServerApp.token=",
            "--LabApp.expose_app_in_browser=True",
        ]
        command += ["--ServerApp.disable_check_xsrf=True", f"--ServerApp.root_dir={folder}"]
        self._log = (folder / "server.log").open("w+", encoding="utf-8")
        environment = {**os.environ, **own, "PYTHONDONTWRITEBYTECODE": ""}
        self._server = subprocess.Popen(
            command, stdout=self._log, stderr=subprocess.STDOUT, env=environment, cwd=folder
        )
        self._folder = folder
        self.browser = Browser(folder / "profile", width, height, flags=MESA)
        try:
            self.browser.open(f"{self._address()}/lab/tree/{NAME}")
            self.browser.wait(
                f"window.jupyterapp?.shell.currentWidget?.content && {CELLS}.length === {len(cells)}"
            )
            self.browser.wait("!!window.jupyterapp.shell.currentWidget.sessionContext.session?.kernel")
            self.command("application:toggle-left-area")
            self.command("notebook:run-all-cells")
        except BaseException:
            self.__exit__(None, None, None)
            raise

    def _address(self) -> str:
        end = time.monotonic() + GENEROUS
        while True:
            result = re.search(r"http://(?:localhost|127\.0\.0\.1):(\d+)/", self.log())
            if result:
                return f"http://127.0.0.1:{result[1]}"
            assert self._server.poll() is None and time.monotonic() < end, self.log()
            time.sleep(0.1)

    def log(self) -> str:
        """Return what the server has written."""
        return (self._folder / "server.log").read_text(encoding="utf-8")

    def command(self, name: str, **arguments: object) -> None:
        """Run a command of JupyterLab."""
        self.browser.run("void window.jupyterapp.commands.execute(...arguments)", name, arguments)

    def python(self, code: str) -> str:
        """Run some code in the notebook's kernel and return what it prints, or its error."""
        return str(
            self.browser.run(
                """
                const kernel = window.jupyterapp.shell.currentWidget.sessionContext.session.kernel;
                const asked = kernel.requestExecute({ code: arguments[0] });
                let text = "";
                asked.onIOPub = ({ content }) => { text += content.text ?? content.evalue ?? ""; };
                return asked.done.then(() => text);
                """,
                code,
            )
        ).strip()

    def __enter__(self) -> Lab:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.browser.__exit__(kind, error, trace)
        finally:
            self._server.terminate()
            self._server.wait(GENEROUS)
            self._log.close()

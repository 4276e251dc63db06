"""The command: what it needs, and a port in place of the standard streams."""

from __future__ import annotations

import json
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from playground import cli
from playground.extras import install_command
from playground.paths import GLSL


def test_without_the_extra_one_sentence_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.startswith("playground.lsp")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "pygls", None)
    assert cli.main(["lsp"]) == 2
    error = capsys.readouterr().err
    assert install_command("lsp") in error and len(error.strip().split("\n")) == 1


@pytest.mark.parametrize("port", ["0", "70000", "many"])
def test_a_port_that_is_none_is_refused(port: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["lsp", "--tcp", port]) == 2
    assert f"--tcp {port}: expected a port" in capsys.readouterr().err


@pytest.mark.slow
def test_a_port_that_is_taken_is_a_sentence() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        command = [sys.executable, "-m", "playground", "lsp", "--tcp", str(taken.getsockname()[1])]
        done = subprocess.run(command, cwd=GLSL.parent, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2 and "in use" in done.stderr and "Traceback" not in done.stderr


@pytest.mark.slow
def test_an_editor_may_connect_to_a_port(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "playground", "lsp", "--tcp", str(port)]
    process = subprocess.Popen(command, cwd=GLSL.parent)
    try:
        end = time.monotonic() + 30.0
        while True:
            try:
                connection = socket.create_connection(("127.0.0.1", port))
                break
            except ConnectionRefusedError:
                assert time.monotonic() < end and process.poll() is None
                time.sleep(0.1)
        params = {"processId": None, "rootUri": tmp_path.as_uri(), "capabilities": {}}
        body = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "initialize", "params": params}).encode()
        with connection, connection.makefile("rwb") as stream:
            stream.write(b"Content-Length: %d\r\n\r\n%b" % (len(body), body))
            stream.flush()
            length = int(stream.readline().split(b":")[1])
            while stream.readline().strip():
                pass
            assert json.loads(stream.read(length))["result"]["capabilities"]["hoverProvider"]
    finally:
        process.kill()
        process.wait()

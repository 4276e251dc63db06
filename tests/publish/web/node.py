"""Call the runtime's modules in one Node process: arrays, maps and every number arrive as they are."""

from __future__ import annotations

import base64
import json
import math
import shutil
import subprocess
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

import playground.publish.web

RUNTIME = Path(playground.publish.web.__file__).parent / "runtime"
NODE = shutil.which("node")
MISSING = "" if NODE else "needs Node"

_TYPED = {
    "Float32Array": "<f4",
    "Float64Array": "<f8",
    "Int8Array": "i1",
    "Uint8Array": "u1",
    "Int32Array": "<i4",
    "Uint16Array": "<u2",
    "Uint32Array": "<u4",
}
_NAMES = {np.dtype(code): name for name, code in _TYPED.items()}


class NodeError(Exception):
    """What a function of the runtime threw."""

    def __init__(self, message: str, details: dict[str, Any], stack: str) -> None:
        super().__init__(message)
        self.message = message
        self.details = details  # what the error had besides its message
        self.add_note(stack)


class Node:
    """A Node process, until the block ends."""

    def __init__(self) -> None:
        assert NODE
        self._process = subprocess.Popen(
            [NODE, str(Path(__file__).with_name("node.mjs"))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            encoding="utf-8",
        )

    def call(self, module: str, name: str, *values: object) -> Any:
        """Return what a function of a module returns, as ``call("draws.js", "buildMesh", …)``.

        Typed arrays are flat NumPy arrays on this side, whatever the shape that they were given with.
        Raises ``NodeError`` with what the function threw.
        """
        return self._ask({"module": module, "name": name, "values": values})

    def each(self, module: str, name: str, cases: Iterable[Sequence[object]]) -> list[Any]:
        """Return what a function of a module returns for each case, a list of its values."""
        script = "async (cases, [module, name], load) => {"
        script += " const found = (await load(module))[name]; return cases.map((case_) => found(...case_)); }"
        values = self.run(script, list(cases), [module, name])
        assert isinstance(values, list)
        return values

    def run(self, script: str, *values: object) -> Any:
        """Return what a function returns, written as text: of the values, and of what imports a module.

        As ``run("async (data, load) => (await load('kernel_texts.js')).toES(data)", text)``.
        """
        return self._ask({"script": script, "values": values})

    def _ask(self, question: dict[str, object]) -> Any:
        assert self._process.stdin and self._process.stdout
        # By name: what a test has patched or saved in between is not asked for again.
        line = json.dumps(_encoded({"folder": RUNTIME.as_posix(), **question}), allow_nan=False)
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()
        said = self._process.stdout.readline()
        assert said, "Node ended"
        answer = json.loads(said)
        if "error" in answer:
            raise NodeError(answer["error"], _decoded(answer["details"]), answer["stack"])
        return _decoded(answer["value"])

    def __enter__(self) -> Node:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate(timeout=60)


def _encoded(value: object) -> object:
    """Return a value as node.mjs reads it."""
    if isinstance(value, np.ndarray):
        name = _NAMES[value.dtype]
        return {"$": name, "data": base64.b64encode(np.ascontiguousarray(value).tobytes()).decode()}
    if isinstance(value, np.generic):
        return _encoded(value.item())
    if isinstance(value, float) and (
        not math.isfinite(value) or (value == 0 and math.copysign(1, value) < 0)
    ):
        words = {math.inf: "Infinity", -math.inf: "-Infinity", 0.0: "-0"}
        return {"$": "number", "data": words.get(value, "NaN")}
    if isinstance(value, Mapping):
        assert all(isinstance(key, str) for key in value), "keys of an object are strings"
        return {key: _encoded(each) for key, each in value.items()}
    if isinstance(value, (set, frozenset)):
        return {"$": "Set", "data": [_encoded(each) for each in value]}
    if isinstance(value, (list, tuple)):
        return [_encoded(each) for each in value]
    return value


def _decoded(value: Any) -> Any:
    """Return what node.mjs wrote."""
    if isinstance(value, list):
        return [_decoded(each) for each in value]
    if not isinstance(value, dict):
        return value
    kind = value.get("$")
    if kind == "number":
        return float(value["data"])
    if kind == "Map":
        return {_hashable(key): _decoded(each) for key, each in value["data"]}
    if kind == "Set":
        return {_hashable(each) for each in value["data"]}
    if kind in _TYPED:
        return np.frombuffer(base64.b64decode(value["data"]), _TYPED[kind])
    return {key: _decoded(each) for key, each in value.items()}


def _hashable(value: Any) -> Any:
    result = _decoded(value)
    return tuple(result) if isinstance(result, list) else result

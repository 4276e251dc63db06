"""Logs of browsers' compilers become complaints at the kernel's own lines, in the words of the terminal."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from playground.errors import Diagnostic
from playground.paths import shown
from playground.publish.web import complaint_words
from playground.shader.complaints import explain
from playground.shader.driver_log import hint, library, parse_log
from playground.shader.wrap import ShaderStage, Wrapped

from ...browser import MISSING, SWIFTSHADER, Browser
from ...shader.test_logs import EXPECTED
from ...shader.test_logs import LOGS as OTHERS
from .node import Node
from .planted_errors import PLANTED, in_es

LOGS = Path(__file__).parent / "logs" / "angle.json"
LIBRARY = {name: " or ".join(f'`#include "{f}"`' for f in files[:3]) for name, files in library().items()}

WITH_TEXTS = """async (log, given, texts, load) =>
    (await load("complaints.js")).complaints(log, { ...given, text: (file) => texts[file] })"""
COMPILE = """
const gl = document.createElement("canvas").getContext("webgl2");
const shader = gl.createShader(gl.FRAGMENT_SHADER);
gl.shaderSource(shader, arguments[0]);
gl.compileShader(shader);
return gl.getShaderInfoLog(shader);
"""


def given(stage: ShaderStage, wrapped: Wrapped) -> dict[str, object]:
    """Return what JavaScript is notified of a stage's text."""
    lines = [
        {"code": line.code, "file": shown(line.file), "line": line.number} for line in stage.source.lines
    ]
    whole = {"first": stage.first, "lines": lines, "expected": stage.expected, "library": LIBRARY}
    return {**whole, "file": shown(wrapped.kernel.path), "kernel": wrapped.kernel.name}


def in_terminal(log: str, wrapped: Wrapped) -> list[Diagnostic]:
    title = "GLSL Compiler failed\n\nfragment_shader\n===============\n"
    return list(explain(title + log, wrapped).diagnostics)


def logs() -> dict[str, str]:
    return dict(json.loads(LOGS.read_text(encoding="utf-8")))


def test_the_module_of_words_is_up_to_date():
    assert complaint_words.FILE.read_text(encoding="utf-8") == complaint_words.text()


@pytest.mark.parametrize("name", PLANTED)
def test_a_recorded_complaint_is_at_its_line_in_plain_words(node: Node, tmp_path: Path, name: str):
    planted, log = PLANTED[name], logs()[name]
    wrapped = planted.wrapped(tmp_path)
    texts = {shown(f): Path(f).read_text(encoding="utf-8") for f in wrapped.kernel.source.files}
    result = node.run(WITH_TEXTS, log, given(wrapped.stages["fragment"], wrapped), texts)
    assert (Path(result[0]["file"]).name, result[0]["line"]) == (planted.file, planted.line), log
    assert planted.part in result[0]["message"]
    assert result[0]["kernel"] == wrapped.kernel.name
    theirs = in_terminal(log, wrapped)
    assert [(c["file"], c["line"], c["message"], c["severity"]) for c in result] == [
        (d.file, d.line, d.message, d.severity) for d in theirs
    ]


def test_no_line_of_the_wrapper_is_named(node: Node, tmp_path: Path):
    wrapped = PLANTED["recursion"].wrapped(tmp_path)
    stage = wrapped.stages["fragment"]
    count = stage.text.count("\n") + 1
    own = {(shown(line.file), line.number) for line in stage.source.lines}
    about = given(stage, wrapped)
    for number in range(count + 3):
        (result,) = node.call("complaints.js", "complaints", f"ERROR: 0:{number}: 'x' : odd", about)
        assert result["line"] == 0 or (result["file"], result["line"]) in own
        line = stage.locate(number) if number else None
        if line is not None:
            assert (result["file"], result["line"]) == (shown(line.file), line.number)


@pytest.mark.parametrize("name", [n for n in EXPECTED if n.startswith(("angle", "mesa", "apple"))])
def test_a_log_that_a_browser_may_give_is_read_as_in_python(node: Node, name: str):
    log = (OTHERS / f"{name}.txt").read_text(encoding="utf-8").partition("\n")[2]
    theirs = [(e.line, e.column, e.severity, e.message) for e in parse_log(log)]
    ours = [
        (e["line"], e["column"], e["severity"], e["message"])
        for e in node.call("complaints.js", "parseLog", log)
    ]
    assert ours == theirs


def test_hints_are_python_s(node: Node):
    messages = {
        line for path in OTHERS.glob("*.txt") for line in path.read_text(encoding="utf-8").splitlines()
    }
    messages |= {line for log in logs().values() for line in log.splitlines()}
    result = node.each("complaints.js", "hint", [[message] for message in sorted(messages)])
    assert result == [hint(message) for message in sorted(messages)]
    assert len({sentence for sentence in result if sentence}) > 12


def test_likeness_is_difflib_s(node: Node):
    from difflib import SequenceMatcher

    pick = random.Random(3)
    words = ["".join(pick.choices("abcd_", k=pick.randrange(1, 14))) for _ in range(600)]
    pairs = list(zip(words[::2], words[1::2], strict=True))
    assert node.each("complaints.js", "likeness", pairs) == [
        SequenceMatcher(None, a, b).ratio() for a, b in pairs
    ]


def test_a_page_knows_what_its_library_defines(node: Node):
    files = {
        "noise/a.glsl": "float fall(vec2 p) {}\nvec3 rise(\n",
        "b.glsl": '#pragma kernel(output = "x:r32f")\nfloat kernel(ivec2 t) {}',
    }
    result = node.call("complaints.js", "libraryOf", {**files, "./own.glsl": "float mine() {}"})
    assert result == {"fall": '`#include "noise/a.glsl"`', "rise": '`#include "noise/a.glsl"`'}


@pytest.mark.slow
@pytest.mark.skipif(bool(MISSING), reason=MISSING)
def test_this_machine_s_browser_complains_as_recorded(tmp_path: Path):
    result = {}
    with Browser(tmp_path / "profile", flags=SWIFTSHADER) as browser:
        for name, planted in PLANTED.items():
            folder = tmp_path / name
            folder.mkdir()
            result[name] = browser.run(COMPILE, in_es(planted.wrapped(folder).stages["fragment"].text)).strip(
                "\0\n"
            )
    assert result == logs()

"""Texts of other tools as syntax trees: what compiles has no error, and what is unfinished never raises."""

from __future__ import annotations

import json
import random

import pytest

from playground.dialects.es import rewritten
from playground.dialects.shadertoy import names_reached, sampler_types
from playground.dialects.table import dialect_of
from playground.shader.common_glsl import in_common_glsl, lacking
from playground.shader.source import read_source_and_origin
from playground.shader.syntax.parser import parse
from playground.shader.syntax.symbols import resolve
from playground.shader.wrap import FRAGMENT, wrap

from ..foreign_cases import EVERY, RESULTS
from .drawing import kernels

CASES = (*EVERY, *RESULTS.values())
NAMED_AS_STATEMENTS = "main words"  # GLSL 1.00 with a variable called switch, which compiles rewritten


def texts_of(case):
    """Yield the texts of a case's files, of an export those of its passes."""
    for name, text in case.files.items():
        if name.endswith((".frag", ".fs", ".vs", ".glsl")):
            yield text
        elif name.endswith(".json"):
            data = json.loads(text)
            inside = data[0] if isinstance(data, list) else data.get("Shader", data)
            yield from (table["code"] for table in inside["renderpass"] if table)


def errors_of(tree):
    return [(tree.line(error.token) + 1, error.message) for error in tree.errors]


@pytest.mark.parametrize("all_branches", [False, True])
def test_an_author_s_text_has_no_error(all_branches):
    for case in CASES:
        for text in texts_of(case) if str(case) != NAMED_AS_STATEMENTS else ():
            assert errors_of(parse(text, all_branches=all_branches)) == [], case


def test_a_text_that_a_driver_takes_has_no_error(tmp_path):
    for number, case in enumerate(CASES):
        for kernel in kernels(case.write(tmp_path / str(number))):
            for stage in wrap(kernel, FRAGMENT).stages.values():
                tree = parse(stage.text)
                assert errors_of(tree) == [], case
                assert any(symbol.name == "main" for symbol in resolve(tree).functions()), case


def test_an_unfinished_text_never_raises(tmp_path):
    chance, path = random.Random(4), tmp_path / "cut.frag"
    for case in CASES:
        for text in texts_of(case):
            start, end = sorted(chance.choices(range(len(text) + 1), k=2))
            cut = text[:end] if chance.random() < 0.5 else text[:start] + text[end:]
            path.write_text(cut.replace("include", "inc"), encoding="utf-8")
            resolve(parse(cut, all_branches=True))
            dialect_of(cut)
            names_reached(cut, sampler_types(cut))
            assert in_common_glsl(cut).count("\n") == cut.count("\n")
            assert isinstance(lacking(cut), str)
            source, _ = read_source_and_origin(path, (tmp_path,), foreign=True)
            assert len(rewritten(source).source.lines) == len(source.lines)

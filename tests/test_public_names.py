"""Every public name: typed, documented, and with an example, which runs."""

from __future__ import annotations

import importlib
import inspect
import re
import textwrap
import threading
import warnings
from collections.abc import Iterator
from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest

import playground
from playground.engine.engine import Engine
from playground.rooms import ROOMS

CLASSES = [name for name in playground.__all__ if isinstance(getattr(playground, name), type)]
EXPLAINED = {
    "ctx", "draw", "driver", "fingerprint", "forget_unused", "info", "metres", "not_finite", "read",
    "release", "render", "steps", "texture", "trace", "trace_frame",
}  # fmt: skip
"""What programs call; each has an example."""
TOOLS = {
    "borrowed", "cache", "clock", "disk_caching", "draw_above_terrain", "draw_window", "drawn",
    "eye_height", "keys_of", "not_finite_by_pass", "options", "painted",
    "picture_hash", "plain_forms", "plan", "plan_for_window", "recall", "record", "released", "run_apart",
    "runner", "runs", "stale", "supposing", "texture_of", "tracer", "warnings",
}  # fmt: skip
"""What the window and other tools use as well."""


def public() -> Iterator[tuple[str, Any]]:
    """Yield every public name with what it means, and the methods and properties of the classes."""
    for name in sorted(set(playground.__all__) - {"__version__"}):
        result = getattr(playground, name)
        yield name, result
        if isinstance(result, type) and not issubclass(result, Exception):
            for inner, member in vars(result).items():
                if not inner.startswith("_") and (inspect.isfunction(member) or isinstance(member, property)):
                    yield f"{name}.{inner}", member


PUBLIC = dict(public())


def example_of(thing: Any) -> str:
    """Return the indented lines of a docstring."""
    lines = (inspect.getdoc(thing) or "").splitlines()
    code = [line for line in lines if line.startswith("    ") or not line]
    return textwrap.dedent("\n".join(code)).strip("\n")


@pytest.fixture(scope="module")
def warm(shared_context) -> Iterator[Engine]:
    """Give an engine that has drawn before: what examples draw is the same, mostly."""
    with Engine(shared_context) as made:
        yield made


OPENS = ("headless", "Engine.release", "Engine.driver", "ContextError", "widget", "compare")
"""Those whose examples are about the opening, or open an engine in a thread."""

# Imported here: what is imported first while another is in its place would keep that.
HOMES = [
    importlib.import_module(f"playground.{home}")
    for home in ("api", *(("publish.export", "publish.series") if "publish" in ROOMS else ()))
]


@pytest.mark.parametrize("name", PUBLIC)
def test_its_example_runs(name, tmp_path, monkeypatch, ctx, warm):
    example = example_of(PUBLIC[name])
    assert example, f"{name} has no example in its docstring"
    assert name.rpartition(".")[2] in example or name in CLASSES, f"the example of {name} does not use it"
    if "render_video" in example:
        pytest.importorskip("av")
    if "playground.sweep" in example:
        pytest.importorskip("xarray")
    monkeypatch.chdir(tmp_path)
    if name not in OPENS:
        for home in HOMES:
            monkeypatch.setattr(home, "headless", lambda **_: nullcontext(warm))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", playground.PlainFormWarning)
        exec(compile(example, name, "exec"), {"playground": playground, "print": lambda *_: None})


@pytest.mark.parametrize("name", PUBLIC)
def test_public_name_is_typed_and_documents_arguments_and_errors(name):
    thing = PUBLIC[name]
    documentation = inspect.getdoc(thing) or ""
    if isinstance(thing, type):
        return
    function = thing.fget if isinstance(thing, property) else thing
    signature = inspect.signature(function)
    value = [p for n, p in signature.parameters.items() if n != "self"]
    untyped = [p.name for p in value if p.annotation is inspect.Parameter.empty]
    assert not untyped and signature.return_annotation is not inspect.Signature.empty
    if "." in name:  # methods have the same names for the same, which the first of them explains
        documentation += inspect.getdoc(playground.Engine.render) or ""
    missing = [p.name for p in value if not re.search(rf"\b{p.name}\b", documentation)]
    assert not missing, f"{name} says nothing of {', '.join(missing)}"
    if "." not in name and value:
        assert "Raises" in documentation or name == "parameters"


def test_the_checks_can_fail():
    assert example_of(lambda: None) == ""
    assert example_of(playground.Engine.metres).startswith(
        "with playground.headless() as engine:\n    metres"
    )


def test_an_engine_shows_what_a_program_calls(engine):
    assert {name for name in dir(engine) if not name.startswith("_")} == EXPLAINED | TOOLS


def test_metres_are_heights_times_relief_above_the_base(any_engine):
    sketch = playground.load("jacksboro").with_values({"relief": 400.0, "base_elevation": -25.0})
    shares = any_engine.read(sketch, "height").astype(np.float64)
    metres = any_engine.metres(sketch, "height")
    assert metres.dtype == np.float32 and metres.shape == shares.shape
    np.testing.assert_allclose(metres, 400.0 * shares - 25.0, atol=1e-4)
    with pytest.raises(playground.SketchError, match=r"texture 'light' has \d channels; heights have one"):
        any_engine.metres(sketch, "light")


def test_a_frame_is_an_array():
    frame = playground.Frame(np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4))
    assert np.shares_memory(np.asarray(frame), frame.array)
    assert np.shares_memory(np.array(frame, copy=False), frame.array)
    assert not np.shares_memory(np.array(frame), frame.array)
    assert np.asarray(frame, dtype=np.float32).dtype == np.float32
    with pytest.raises(ValueError, match="copy"):
        np.array(frame, dtype=np.float32, copy=False)
    np.testing.assert_array_equal(np.asarray(frame), frame.array)


# ── threads ──────────────────────────────────────────────────────────────────


def in_thread(work: Any) -> Any:
    """Return what some work gives in a thread of its own, or the error that it raises."""
    values: list[Any] = []

    def run() -> None:
        try:
            values.append(work())
        except Exception as error:
            values.append(error)

    thread = threading.Thread(target=run, name="other")
    thread.start()
    thread.join()
    return values[0]


@pytest.mark.slow
def test_a_call_from_another_thread_is_refused_in_a_sentence(any_engine):
    sketch = playground.load("diamond_square").with_values({"size": 33})
    expected = any_engine.render(sketch, size=(32, 18)).array
    calls = [
        lambda: any_engine.render(sketch, size=(32, 18)),
        lambda: any_engine.read(sketch, "height"),
        lambda: any_engine.fingerprint(sketch),
        lambda: any_engine.not_finite(),
        lambda: any_engine.forget_unused(),
        lambda: any_engine.release(),
        lambda: any_engine.__enter__(),
    ]
    for call in calls:
        error = in_thread(call)
        assert isinstance(error, playground.ContextError), call
        assert "opened in thread 'MainThread' and is called from 'other'" in str(error)
        assert "open an engine in each" in str(error)
    any_engine.cache.clear()
    np.testing.assert_array_equal(any_engine.render(sketch, size=(32, 18)).array, expected)


@pytest.mark.slow
def test_one_engine_draws_many_sketches_and_is_per_thread(any_engine):
    square = playground.load("diamond_square")
    names = (9, 17, 33)
    sketches = {side: square.with_values({"size": side}) for side in names}

    def drawn() -> dict[int, np.ndarray]:
        arrays = {}
        with playground.headless() as engine:
            for _ in range(2):  # the second time, each after another
                for name, sketch in sketches.items():
                    arrays[name] = engine.render(sketch, size=(48, 27)).array
        return arrays

    expected = {name: any_engine.render(sketch, size=(48, 27)).array for name, sketch in sketches.items()}
    results: list[Any] = [None, None]

    def run(place: int) -> None:
        results[place] = drawn()

    threads = [threading.Thread(target=run, args=(index,)) for index in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results:
        for name in names:
            np.testing.assert_array_equal(result[name], expected[name])

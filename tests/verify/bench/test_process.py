"""Processes that a row times: to their end, or to where they say; modules are compiled once."""

from __future__ import annotations

import os

import pytest

from playground.errors import PlaygroundError
from playground.verify.bench.context import BenchContext, Options
from playground.verify.bench.measures import environment_of, spent

PAUSE = "import time\ntime.sleep(0.6)\n"


def test_the_time_ends_with_the_process_or_where_it_calls_spent():
    whole, busy, most = spent(f"print('a picture')\n{PAUSE}", os.environ)
    assert whole >= 0.6 > busy > 0.0 and most > 0.0
    until, _, _ = spent(f"{PAUSE}spent()\n{PAUSE}", os.environ)
    assert 0.6 <= until < 1.2


def test_modules_are_compiled_once_whatever_the_environment_says(monkeypatch, tmp_path):
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    (tmp_path / "slow_one.py").write_text("value = 1\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with BenchContext(Options()) as context:
        spent("import slow_one", environment_of(context))
        assert list((context.folder / "modules").rglob("slow_one.*.pyc"))


def test_what_fails_is_told():
    with pytest.raises(PlaygroundError, match="failed: ValueError: no terrain"):
        spent("raise ValueError('no terrain')", os.environ)

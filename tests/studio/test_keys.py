"""Each key means one thing."""

from __future__ import annotations

from collections import Counter

from playground.studio.keys import all_keys


def test_no_two_meanings_share_a_key() -> None:
    struck = Counter((key.key, key.letter, key.sign, key.ctrl, key.shift) for key in all_keys())
    assert [keys for keys, count in struck.items() if count > 1] == []

"""JSON from elsewhere: what cannot be read is one kind of error, however deep it is."""

from __future__ import annotations

import json

import pytest

from playground.json_text import MAX_DEPTH, MAX_DIGITS, read_json


@pytest.mark.always
@pytest.mark.parametrize("opening", ["[", '{"a":', '[{"a":'])
@pytest.mark.parametrize("times", [MAX_DEPTH, 400, 3000, 100_000])
def test_what_is_nested_too_deeply_is_refused(opening: str, times: int):
    closing = "".join({"[": "]", "{": "}"}[c] for c in reversed(opening) if c in "[{")
    for text in (opening * times + "[]" + closing * times, opening * (MAX_DEPTH + 1)):
        with pytest.raises(ValueError):
            read_json(text)


def test_what_is_nested_as_deep_as_allowed_is_read():
    text = "[" * MAX_DEPTH + "]" * MAX_DEPTH
    value = read_json(text)
    for _ in range(MAX_DEPTH - 1):
        (value,) = value
    assert value == []
    assert read_json(b'{"a": [1, {"b": null}]}') == {"a": [1, {"b": None}]}


@pytest.mark.parametrize("as_bytes", [False, True])
def test_a_number_of_too_many_digits_has_a_place(as_bytes: bool):
    text = '[1,\n "é", -' + "9" * (MAX_DIGITS + 1) + "]"
    with pytest.raises(json.JSONDecodeError, match=f"{MAX_DIGITS + 1} digits") as caught:
        read_json(text.encode() if as_bytes else text)
    assert (caught.value.lineno, caught.value.colno) == (2, 8)
    assert read_json("9" * MAX_DIGITS) == 10**MAX_DIGITS - 1

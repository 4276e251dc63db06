"""What Python presses, the runtime unpresses: any bytes, any text, and nothing that a page would change."""

from __future__ import annotations

import random

import numpy as np
import pytest

from playground.publish.web.blobs import Blobs
from playground.publish.web.page import page_texts
from playground.publish.web.pressed import dense, pressed

from .node import Node, NodeError
from .unpressed import undense, unpressed

RANDOM = random.Random(7)
KINDS = {
    "nothing": b"",
    "one zero": b"\0",
    "zeros": bytes(1000),
    "ones": b"\xff" * 1001,
    "every byte": bytes(range(256)) * 3,
    "any bytes": RANDOM.randbytes(20_001),
}


@pytest.mark.parametrize("data", KINDS.values(), ids=KINDS)
def test_bytes_come_back_as_they_were(data: bytes, node: Node):
    assert node.call("dense.js", "undense", dense(data)).tobytes() == data
    assert undense(dense(data)) == data


def test_bytes_of_every_length_come_back(node: Node):
    for length in range(40):
        data = RANDOM.randbytes(length)
        assert node.call("dense.js", "undense", dense(data)).tobytes() == data


def test_a_letter_of_one_byte_holds_seven_bits():
    data = RANDOM.randbytes(70_000)
    assert len(dense(data).encode()) <= 80_002


def test_packed_letters_survive_script_element_and_editor():
    letters = {ord(letter) for letter in dense(RANDOM.randbytes(200_000) + bytes(range(256)))}
    assert not letters & set(b"\0\a\b\t\n\v\f\r\x1a\x1b&<\x7f")
    assert not letters & set(range(0x80, 0xA0)) and max(letters) < 0x800
    assert letters >= set(range(32, 127)) - set(b"&<")


TEXTS = {
    "nothing": "",
    "a letter": "a",
    "the same": "abc" * 20_000,
    "letters far apart": "".join(chr(RANDOM.randrange(32, 0x3000)) for _ in range(9000)),
    "words": " ".join(RANDOM.choices("vec3 float height = texture ( ) ; for\n // of".split(), k=30_000)),
    "its mark of another order": "\ufeffa\0b",
    "every letter and sign": "".join(map(chr, range(0x250))) * 2 + " height texture height",
    "far repeats": (far := "".join(RANDOM.choices("abcdefgh", k=150_000))) + "!" + far,
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_texts_come_back_as_they_were(text: str, node: Node):
    assert node.call("pressed.js", "unpressed", pressed(text)) == text


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_it_is_read_by_its_definition(text: str):
    assert unpressed(pressed(text)) == text


def test_bytes_without_any_order_come_back(node: Node):
    text = np.random.default_rng(1).integers(0, 256, 300_000, np.uint8).tobytes().decode("latin-1")
    assert node.call("pressed.js", "unpressed", pressed(text)) == text


def test_a_letter_that_is_another_or_missing_is_noticed(node: Node):
    """Of LZMA alone not one would be: it gives other bytes, and throws nothing."""
    good = pressed("vec3 height = texture(rock, place);\n" * 40)
    places = range(0, len(good), 7)
    damaged = [good[:at] + ("a" if good[at] != "a" else "b") + good[at + 1 :] for at in places]
    damaged += [good[:at] + good[at + 1 :] for at in places] + [good[:at] for at in places]
    for text in damaged:
        with pytest.raises(NodeError, match="damaged"):
            node.call("pressed.js", "unpressed", text)


def test_blobs_count_what_they_take_in_a_page():
    """As they stand in it: seven bits a letter, not base64's six."""
    blobs = Blobs()
    blobs.add(RANDOM.randbytes(70_000))
    _, texts = page_texts({"shared": {"blobs": blobs.texts}})
    assert blobs.size == pytest.approx(sum(len(text.encode()) for text in texts.values()), rel=1e-3)

"""Read the contents of a glTF 2.0 file: its JSON, typed entries of it, and the numbers of its accessors.

A file is a stranger's: what every entry is, every offset and every count is checked, and how many numbers
are read in all has a bound. What the entries mean together is for ``model_files`` to say.

Source: Khronos Group 2021, "glTF 2.0 Specification" (section 3.6 for accessors, 4.4 for GLB).
"""

from __future__ import annotations

import base64
import binascii
import struct
from collections.abc import Iterator, Mapping
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from playground.json_text import read_json

MOST_BYTES = 32 * 2**20
MOST_TRIANGLES = 2**16
MOST_NUMBERS = 2**22  # in accessors; with 3 corners of 11 numbers each the most triangles have half of them
_TYPES = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_UNSIGNED = (5121, 5123, 5125)
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
_GLB, _JSON, _BIN = 0x46546C67, 0x4E4F534A, 0x004E4942
_KNOWN = ("KHR_mesh_quantization", "KHR_materials_unlit")  # what changes nothing that is read here


class WrongModel(Exception):
    """What is wrong with a file, in words that follow its name."""


def is_whole(value: Any) -> TypeGuard[int]:
    """Return whether a value of JSON is a whole number: true and 1.0 are none."""
    return isinstance(value, int) and not isinstance(value, bool)


def brief(value: Any) -> str:
    """Return a value of JSON as a message shows it."""
    return str(value)[:60]


def list_of(owner: Mapping[str, Any], key: str) -> list[Any]:
    """Return a list of an object; none is empty.

    Raises:
        WrongModel: it is something else.
    """
    found = owner.get(key, [])
    if not isinstance(found, list):
        raise WrongModel(f"has {key} {brief(found)}; a list was expected")
    return found


def object_of(found: Any, key: str) -> dict[str, Any]:
    """Return what is an object.

    Raises:
        WrongModel: it is something else.
    """
    if not isinstance(found, dict):
        raise WrongModel(f"has {key} {brief(found)}; an object was expected")
    return found


def read_document(data: bytes) -> Document:
    """Return the document of a file's bytes.

    Raises:
        WrongModel: they are neither GLB nor JSON, no glTF 2, or need an extension that is not read.
    """
    binary = None
    if data[:4] == b"glTF":
        if len(data) < 20:
            raise WrongModel("ends within its header; a GLB of 20 bytes or more was expected")
        _, version, length = struct.unpack_from("<III", data)
        if version != 2:
            raise WrongModel(f"is glTF {version}; version 2 was expected")
        if length > len(data):
            raise WrongModel(f"ends after {len(data)} bytes of the {length} that its header says")
        chunks = dict(reversed(list(_chunks(data[:length]))))
        if _JSON not in chunks:
            raise WrongModel("has no JSON chunk")
        text, binary = chunks[_JSON], chunks.get(_BIN, b"")
    else:
        text = data
    try:
        document = read_json(text.decode("utf-8"))
    except ValueError:
        raise WrongModel("is neither GLB nor JSON; glTF 2.0, .glb or .gltf, was expected") from None
    if not isinstance(document, dict) or not isinstance(document.get("asset"), dict):
        raise WrongModel("is JSON, but no glTF: it has no 'asset'")
    if not str(document["asset"].get("version", "")).startswith("2"):
        raise WrongModel(f"is glTF {brief(document['asset'].get('version'))}; version 2 was expected")
    needed = [name for name in list_of(document, "extensionsRequired") if name not in _KNOWN]
    if needed:
        raise WrongModel(f"needs {brief(needed[0])}, which is not read here; export it without compression")
    return Document(document, binary)


def _chunks(data: bytes) -> Iterator[tuple[int, bytes]]:
    at = 12
    while at + 8 <= len(data):
        length, kind = struct.unpack_from("<II", data, at)
        if at + 8 + length > len(data):
            raise WrongModel("has a chunk that goes on after its end")
        yield kind, data[at + 8 : at + 8 + length]
        at += 8 + length


class Document:
    """Gives entries and accessors of one document."""

    def __init__(self, json_: Mapping[str, Any], binary: bytes | None) -> None:
        self.json = json_
        self.binary = binary
        self._numbers_left = MOST_NUMBERS
        self._buffers: dict[int, bytes] = {}
        self._numbers: dict[int, NDArray[np.float64]] = {}

    def entry(self, kind: str, index: Any) -> dict[str, Any]:
        """Return one of a list of the document.

        Raises:
            WrongModel: there is none of that index, or it is no object.
        """
        entries = list_of(self.json, kind)
        if not is_whole(index) or not 0 <= index < len(entries) or not isinstance(entries[index], dict):
            raise WrongModel(f"names {kind}[{brief(index)}], which it does not have")
        found: dict[str, Any] = entries[index]
        return found

    def numbers(
        self, index: Any, name: str, widths: tuple[int, ...], count: int | None = None
    ) -> NDArray[np.float64]:
        """Return an accessor's numbers, (count, width); each accessor is read once.

        Raises:
            WrongModel: they are of another form, as many as not expected, outside the file, or no numbers.
        """
        accessor = self.entry("accessors", index)
        kind, shape = accessor.get("componentType"), accessor.get("type")
        width = _WIDTHS.get(shape) if isinstance(shape, str) else None
        if not is_whole(kind) or kind not in _TYPES or width is None or width not in widths:
            expected = " or ".join(str(each) for each in widths)
            raise WrongModel(f"has {name} of a form that is not read; {expected} numbers each were expected")
        many = accessor.get("count")
        if not is_whole(many) or not 1 <= many <= 3 * MOST_TRIANGLES or count not in (None, many):
            expected = f"1 to {3 * MOST_TRIANGLES}" if count is None else str(count)
            raise WrongModel(f"has {brief(many)} of {name}; {expected} were expected")
        if "sparse" in accessor:
            raise WrongModel(f"has sparse {name}, which are not read here")
        if index not in self._numbers:
            self._numbers_left -= many * width
            if self._numbers_left < 0:
                raise WrongModel(f"has more than {MOST_NUMBERS} numbers in its accessors")
            self._numbers[index] = self._decoded(accessor, name, (many, width))
        return self._numbers[index]

    def indices(self, index: Any) -> NDArray[np.int64]:
        """Return an accessor's whole numbers from 0, (count,).

        Raises:
            WrongModel: as ``numbers``, or they are of a type that has a sign or parts.
        """
        accessor = self.entry("accessors", index)
        kind = accessor.get("componentType")
        if not is_whole(kind) or kind not in _UNSIGNED or accessor.get("normalized", False):
            raise WrongModel("has indices of a form that is not read; whole numbers from 0 were expected")
        return self.numbers(index, "indices", (1,))[:, 0].astype(np.int64)

    def _decoded(self, accessor: Mapping[str, Any], name: str, shape: tuple[int, int]) -> NDArray[np.float64]:
        """Return the numbers of an accessor, of that shape."""
        many, width = shape
        if "bufferView" not in accessor:
            return np.zeros(shape)
        view = self.entry("bufferViews", accessor["bufferView"])
        data = self._buffer(view.get("buffer"))
        dtype = np.dtype(_TYPES[accessor["componentType"]])
        size = dtype.itemsize * width
        stride = view.get("byteStride", size)
        numbers = [
            view.get("byteOffset", 0),
            accessor.get("byteOffset", 0),
            view.get("byteLength", 0),
            stride,
        ]
        if not all(is_whole(n) and 0 <= n <= MOST_BYTES for n in numbers) or stride < size:
            raise WrongModel(f"has {name} at no place that can be")
        start, end = numbers[0] + numbers[1], numbers[0] + numbers[2]
        if end > len(data) or start + (many - 1) * stride + size > end:
            raise WrongModel(f"ends before its {name} do")
        rows = np.lib.stride_tricks.as_strided(
            np.frombuffer(data, np.uint8, offset=start)[: (many - 1) * stride + size],
            (many, size),
            (stride, 1),
        )
        found = np.ascontiguousarray(rows).view(dtype).astype(np.float64).reshape(many, width)
        if not np.isfinite(found).all():
            raise WrongModel(f"has {name} that are no numbers")
        normalised = accessor.get("normalized", False) and dtype.kind in "iu"
        return np.maximum(found / np.iinfo(dtype).max, -1.0) if normalised else found

    def _buffer(self, index: Any) -> bytes:
        buffer = self.entry("buffers", index)
        if index in self._buffers:
            return self._buffers[index]
        uri = buffer.get("uri")
        if uri is None:
            if index != 0 or self.binary is None:
                raise WrongModel(f"has no data for buffers[{index}]")
            data = self.binary
        elif isinstance(uri, str) and uri.startswith("data:") and ";base64," in uri[:100]:
            try:
                data = base64.b64decode(uri.partition(";base64,")[2], validate=True)
            except (binascii.Error, ValueError):
                raise WrongModel(f"has damaged data in buffers[{index}]") from None
        else:
            raise WrongModel(f"has its data in another file, {brief(uri)}; one file, .glb, was expected")
        self._buffers[index] = data
        return data

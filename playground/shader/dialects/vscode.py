"""Read a shader of the VS Code extension Shader Toy: files that name the files that their channels read."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from playground.allowed_files import SHADERS, how_to_open, is_inside, names_below
from playground.errors import ShaderError, nearest
from playground.paths import shown
from playground.shader.dialects import shadertoy
from playground.shader.dialects.foreign import SAMPLING, SIZES, Files, Shader, ShaderChannel, stand_in
from playground.shader.dialects.shadertoy import (
    BUFFER,
    CUBE,
    IMAGE,
    OF_BUFFERS,
    ToyInput,
    ToyPass,
    note_not_drawn,
    pass_name,
    reading,
    shaders_of,
    with_common,
)
from playground.shader.parameter import Sampling
from playground.shader.preprocessor import WEBGL_2, live_source
from playground.shader.source import Line, SourceText

_OF_CUBES = Sampling("linear", "clamp", mipmap=True)
_SCHEME = re.compile(r"(?:file|buf|glsl)://")
_WEB = re.compile(r"https?://", re.IGNORECASE)
_SOUND = (".mp3", ".wav", ".ogg", ".flac", ".m4a", ".aac", ".opus")
_PICTURES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
_FACES = (
    ("px", "nx", "py", "ny", "pz", "nz"),
    ("e", "w", "u", "d", "n", "s"),
    ("east", "west", "up", "down", "north", "south"),
    ("posx", "negx", "posy", "negy", "posz", "negz"),
)
_FACE_NAMES = ("right", "left", "top", "bottom", "front", "back")
_CUBE_SIZE = ("512", "3072")
_MAX_PASSES = 32


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file, those that its channels read before it."""
    reader = Reader(files)
    reader.add(files.path, IMAGE)
    return shaders_of(reader.passes(), "vscode")


@dataclass
class Reader:
    """Reads files that read each other, each once.

    ``labels`` are those of files that have one besides their name, ``inputs`` what their channels read that
    no line of theirs names; ``common`` comes before each.
    """

    files: Files
    labels: dict[Path, str] = field(default_factory=dict)
    kinds: dict[Path, str] = field(default_factory=dict)
    inputs: dict[Path, dict[str, ToyInput]] = field(default_factory=dict)
    common: SourceText | None = None
    _names: dict[Path, str] = field(default_factory=dict)  # of passes, those that are being read too
    _done: dict[Path, ToyPass] = field(default_factory=dict)  # in the order in which they are drawn
    _read_before: set[Path] = field(default_factory=set)  # whose last frame somebody reads

    def add(self, path: Path, kind: str) -> str:
        """Read a file and those that it reads; return the name of its pass."""
        if path in self._names:
            if path not in self._done:
                self._read_before.add(path)
            return self._names[path]
        if len(self._names) >= _MAX_PASSES:
            raise ShaderError(f"more than {_MAX_PASSES} passes", file=path)
        label = self.labels.get(path, path.stem)
        name = pass_name(label) or "pass"
        while name in self._names.values():
            name += "_"
        self._names[path] = name
        read = shadertoy.read_directives(self.files.source(path))
        for line, message in read.notes:
            self.files.note_at(line, message)
        note_not_drawn(self.files, live_source(read.source, WEBGL_2, unsure={"SHADER_TOY"}))
        feeds = dict(self.inputs.get(path, {}))
        for number, channel in read.channels.items():
            feeds[f"iChannel{number}"] = self._feed(path, number, channel)
        source = with_common(self.common, read.source)
        if shadertoy.has_keyboard(source):
            feeds[shadertoy.KEYBOARD] = ToyInput(stand_in("keys", 0, ""))
        label = self.labels.get(path, path.name)
        self._done[path] = ToyPass(label, kind, source, feeds, True, name)
        return name

    def passes(self) -> tuple[ToyPass, ...]:
        """Return the passes; where the picture reads itself, one more shows it."""
        passes = []
        for path, toy in self._done.items():
            if toy.kind == IMAGE and path in self._read_before:
                passes += [replace(toy, kind=BUFFER), _showing(toy)]
            else:
                passes.append(toy)
        return tuple(passes)

    def _feed(self, path: Path, number: int, channel: shadertoy.ChannelLines) -> ToyInput:
        """Return what a channel reads; raise ``ShaderError`` for a shader that is not there."""
        text = _SCHEME.sub("", channel.path)
        of_buffers, of_pictures = channel.sampling(OF_BUFFERS), channel.sampling(SAMPLING)
        if text == "self":
            self._read_before.add(path)
            return ToyInput(reading(self._names[path], of_buffers))
        ending = Path(text).suffix.lower()
        if ending in SHADERS:
            path_found = self._found(text, channel.line)
            if path_found is None:
                hint = nearest(text, names_below((path.parent,), SHADERS))
                raise channel.line.error(f"#iChannel{number}: there is no file '{text}'{hint}")
            if path_found == path:
                self._read_before.add(path)
            kind = self.kinds.get(path_found, BUFFER)
            name = self.add(path_found, kind)
            return ToyInput(reading(name, of_buffers), "samplerCube" if kind == CUBE else "sampler2D")
        if channel.is_cube:
            return self._cube(text, channel, number)
        form, unfed = "picture", ""
        if not text:
            form, unfed = "noise", "no line says what it reads, so a stand-in is drawn"
        elif _WEB.match(text):
            unfed = f"'{text}' is on the web, where nothing is read, so a stand-in is drawn"
        elif ending in _SOUND:
            return ToyInput(self._sound(text, number, channel))
        elif ending not in _PICTURES:
            unfed = f"'{text}' is no image that can be read, so a stand-in is drawn"
        elif (path_found := self._found(text, channel.line)) is not None:
            file = path_found.relative_to(self.files.root.resolve()).as_posix()
            return ToyInput(ShaderChannel(sampling=of_pictures), file=file)
        else:
            unfed = f"there is no file '{text}' in this folder, so a stand-in is drawn"
        return ToyInput(stand_in(form, number, unfed, of_pictures))

    def _sound(self, text: str, number: int, channel: shadertoy.ChannelLines) -> ShaderChannel:
        """Return a sound file's spectrum and wave, or those of a made-up one."""
        sampling, path_found = channel.sampling(OF_BUFFERS), self._found(text, channel.line)
        if path_found is not None:
            file = path_found.relative_to(self.files.root.resolve()).as_posix()
            return ShaderChannel("", "foreign/sound", (("sound", file),), SIZES["foreign/sound"], sampling)
        unfed = f"there is no file '{text}' in this folder, so a made-up sound stands in for it"
        return stand_in("sound", 0, unfed, sampling)

    def _cube(self, text: str, channel: shadertoy.ChannelLines, number: int) -> ToyInput:
        """Return a cube map of six files, or a sky."""
        sampling = channel.sampling(_OF_CUBES)
        if "{}" in text:
            for letters in _FACES:
                faces = [self._found(text.replace("{}", letter), channel.line) for letter in letters]
                there = [face for face in faces if face is not None]
                if len(there) == len(letters):
                    root = self.files.root.resolve()
                    values = [
                        (name, face.relative_to(root).as_posix())
                        for name, face in zip(_FACE_NAMES, there, strict=True)
                    ]
                    made = ShaderChannel(
                        use="foreign/cube_faces", values=tuple(values), size=_CUBE_SIZE, sampling=sampling
                    )
                    return ToyInput(made, "samplerCube")
        unfed = f"'{text}' is not there with all of px nx py ny pz nz for {{}}, so a stand-in is drawn"
        return ToyInput(stand_in("sky", number, unfed, sampling), "samplerCube")

    def _found(self, text: str, line: Line) -> Path | None:
        """Return the file that a line names, inside the folder; None where there is none."""
        root = self.files.root.resolve()
        for folder in _around(Path(line.file).parent, root):
            path = folder / text
            if "\0" not in text and self.files.is_there(path):
                if is_inside(path, (root,)):
                    return path.resolve()
                more = how_to_open(path.resolve(), root)
                raise line.error(f"'{text}' lies outside the shader's own folder, {shown(root)}{more}")
        return None


def _around(folder: Path, root: Path) -> Iterator[Path]:
    """Yield a folder, those around it up to the root, and the root."""
    yield folder
    yield from (parent for parent in folder.parents if parent.is_relative_to(root))
    yield root


def _showing(toy: ToyPass) -> ToyPass:
    """Return the pass that shows another, opaque."""
    first = toy.source.lines[0]
    code = "void mainImage(out vec4 c, in vec2 p) { c = texelFetch(k_shown, ivec2(p), 0); }"
    line = Line("", code, "", first.file, first.number)
    source = SourceText(toy.source.path, (line,), toy.source.files)
    return ToyPass("shown", IMAGE, source, {"k_shown": ToyInput(reading(toy.name))})

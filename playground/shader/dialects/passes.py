"""Wire the passes of another tool's file into an ordinary technique.

Its last pass is ``view``: the shader itself, or a technique of several shaders where there are more.
Before it come the passes that feed its channels, each named like its channel, so that what a user wires
to the channel takes its place. Where a shader reads what it or a later one writes, that is what was
written in the frame before, and the whole of ``view`` is a loop over the frames.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from playground.errors import Diagnostic, ShaderError, nearest
from playground.paths import GLSL, shown
from playground.shader.dialects.foreign import ForeignKernel, Made, Shader, ShaderChannel
from playground.shader.kernel import Export, ForeignShader, Graph, Kernel, PassSpec, Technique

Read = Callable[[str, Path, Path], Technique]
"""Return the technique that ``use`` names: see ``Techniques.read``."""

VIEW = "view"
_BEFORE = "before_"  # begins the input that has a target's content of the frame before
_MAX_NAMED = 3  # passes in one message
_FRAMES = "frames"


def graph_of_shaders(name: str, shaders: Sequence[Shader | Made], read: Read, root: Path) -> Graph:
    """Return a technique called ``name``, whose picture is that of the last of its shaders.

    Its channels are inputs, and its shaders' own uniforms parameters: one for those of the same name.
    ``root`` is the folder that its files stay in. Raises ``ShaderError`` for a sampler of a target that
    no shader writes.
    """
    return _Passes(name, shaders, read, root).graph()


class _Passes:
    """The shaders of one file, as kernels, and what wires them."""

    def __init__(self, name: str, shaders: Sequence[Shader | Made], read: Read, root: Path) -> None:
        self.name = name
        self.shaders = shaders
        self.read = read  # returns what feeds a channel, and what makes a pass
        self.techniques: list[Technique] = []
        self.channels: list[Mapping[str, ShaderChannel]] = []
        for shader in shaders:
            if isinstance(shader, Made):
                self.techniques.append(read(shader.use, GLSL, GLSL))
                self.channels.append({name: ShaderChannel(target) for name, target in shader.reads.items()})
            else:
                foreign = ForeignKernel(shader, root)
                self.techniques.append(foreign.kernel(name))
                self.channels.append(foreign.channels)
        self._drop_unread()
        self.kernels = [kernel for kernel in self.techniques if isinstance(kernel, ForeignShader)]
        # Of each shader: samplers, and the passes of this frame that they read.
        self.wires: list[list[tuple[str, str]]] = [[] for _ in shaders]
        self.state: dict[str, list[str]] = {}  # target → the samplers that read it as it was, as paths
        for index, channels in enumerate(self.channels):
            for sampler, channel in channels.items():
                if channel.target:
                    self._wire(index, sampler, channel.target)
        self.inputs = dict(self._inputs())

    def _unread(self) -> Iterator[Diagnostic]:
        """Yield a warning that names the passes which the picture does not depend on: they are not drawn."""
        last = {shader.target: shader.name for shader in self.shaders}
        reads: dict[str, set[str]] = {shader.name: set() for shader in self.shaders}
        for shader, wires in zip(self.shaders, self.wires, strict=True):
            reads[shader.name] |= {name for _, name in wires}
        for target, paths in self.state.items():
            for path in paths:
                reads[path.partition(".")[0]].add(last[target])
        reached, read_names = set[str](), {self.shaders[-1].name}
        while read_names:
            reached |= read_names
            read_names = set().union(*[reads[name] for name in read_names]) - reached
        left = [shader.name for shader in self.shaders if shader.name not in reached]
        if left:
            more = f" and {len(left) - _MAX_NAMED} more" if len(left) > _MAX_NAMED else ""
            names = f"{', '.join(left[:_MAX_NAMED])}{more}"
            message = f"the picture reads nothing of {names}: what the picture does not need is not drawn"
            yield self.kernels[-1].source.lines[0].diagnostic(message, severity="warning")

    def _drop_unread(self) -> None:
        """Drop the parameters that a pass declares and only other passes read."""
        kernels = [technique for technique in self.techniques if isinstance(technique, ForeignShader)]
        reads = {id(kernel): _names_read(kernel) for kernel in kernels}
        declared = {p.name for kernel in kernels for p in kernel.parameters}
        anywhere = set().union(*reads.values())
        anywhere |= {name for kernel in kernels for name in declared if kernel.source.counts[name] > 1}
        for index, technique in enumerate(self.techniques):
            if isinstance(technique, ForeignShader):
                kept = [
                    p
                    for p in technique.parameters
                    if p.name in reads[id(technique)] or p.name not in anywhere
                ]
                if len(kept) < len(technique.parameters):
                    self.techniques[index] = replace(technique, parameters=tuple(kept))

    def _wire(self, index: int, sampler: str, target: str) -> None:
        writers = [i for i, shader in enumerate(self.shaders) if shader.target == target]
        if not writers:
            raise self._unwritten(index, sampler, target)
        earlier = [i for i in writers if i < index]
        if earlier:
            self.wires[index].append((sampler, self.shaders[earlier[-1]].name))
        elif self.shaders[writers[-1]].keeps:
            self.state.setdefault(target, []).append(f"{self.shaders[index].name}.{sampler}")

    def _unwritten(self, index: int, sampler: str, target: str) -> ShaderError:
        made = self.techniques[index]
        source = (made if isinstance(made, Kernel) else self.kernels[-1]).source
        line = source.line_with(rf"\b{sampler}\b") or source.lines[0]
        hint = nearest(target, [shader.target for shader in self.shaders if shader.target])
        return line.error(f"{sampler} reads '{target}', which no pass writes{hint}")

    def _inputs(self) -> Iterator[tuple[str, tuple[ShaderChannel, list[str]]]]:
        """Yield what may be wired from outside: a name, what feeds it, the samplers that read it, as paths.

        Samplers of one name that are fed alike are one input.
        """
        channels_by_pass: dict[str, list[tuple[str, ShaderChannel]]] = {}
        for shader, channels in zip(self.shaders, self.channels, strict=True):
            for sampler, channel in channels.items():
                if not channel.target:
                    channels_by_pass.setdefault(sampler, []).append((shader.name, channel))
        for sampler, readers in channels_by_pass.items():
            if all(channel == readers[0][1] for _, channel in readers):
                yield sampler, (readers[0][1], [f"{shader}.{sampler}" for shader, _ in readers])
                continue
            for shader_name, channel in readers:
                yield _own_name(shader_name, sampler), (channel, [f"{shader_name}.{sampler}"])

    def graph(self) -> Graph:
        """Return the whole."""
        view = self._view()
        passes = [
            PassSpec(name, c.use, self.read(c.use, GLSL, GLSL), values=c.values, size=c.size)
            for name, (c, _) in self.inputs.items()
            if c.use
        ]
        return Graph(
            self.name,
            self.kernels[-1].path,
            (*passes, view),
            parameters=tuple(_inside(VIEW, parameter.name) for parameter in view.technique.parameters),
            inputs=tuple(_inside(VIEW, name) for name in self.inputs),
            title=next((kernel.title for kernel in self.kernels if kernel.title), ""),
            warnings=tuple(self._unread()),
        )

    def _view(self) -> PassSpec:
        path = self.kernels[-1].path
        use, file = f"./{Path(path).stem}", shown(path)
        if len(self.shaders) == 1 and not self.state:
            return PassSpec(VIEW, use, self.kernels[0], size=self.shaders[0].size, file=file)
        passes = tuple(
            PassSpec(
                shader.name,
                shader.use if isinstance(shader, Made) else use,
                technique,
                inputs=tuple(wires),
                size=shader.size,
                repeat=shader.repeat,
                feedback=((shader.feeds, "frame"),) if shader.feeds else (),
                file=file,
            )
            for shader, technique, wires in zip(self.shaders, self.techniques, self.wires, strict=True)
        )
        last = {shader.target: shader.name for shader in self.shaders}
        inputs = [Export(name, tuple(readers)) for name, (_, readers) in self.inputs.items()]
        inputs += [Export(f"{_BEFORE}{target}", tuple(readers)) for target, readers in self.state.items()]
        several = Graph(
            self.name,
            path,
            passes,
            parameters=tuple(self._parameters()),
            inputs=tuple(inputs),
            outputs=(
                ("frame", f"{passes[-1].name}:frame"),
                *((target, f"{last[target]}:frame") for target in self.state),
            ),
        )
        feedback = tuple((f"{_BEFORE}{target}", target) for target in self.state)
        return PassSpec(VIEW, use, several, repeat=_FRAMES if feedback else "", feedback=feedback, file=file)

    def _parameters(self) -> Iterator[Export]:
        """Yield one parameter for those of one name and type; where types differ, one for each shader.

        Two that name different files differ as well.
        """
        parameters_by_pass: dict[str, list[tuple[str, object]]] = {}
        for shader, technique in zip(self.shaders, self.techniques, strict=True):
            if isinstance(shader, Made) or not isinstance(technique, Kernel):
                continue
            for p in technique.parameters:
                kind = (p.type, p.default) if p.widget.kind == "file" else p.type
                parameters_by_pass.setdefault(p.name, []).append((shader.name, kind))
        for name, owners in parameters_by_pass.items():
            if len({kind for _, kind in owners}) == 1:
                yield Export(name, tuple(f"{owner}.{name}" for owner, _ in owners))
            else:
                yield from (Export(_own_name(owner, name), (f"{owner}.{name}",)) for owner, _ in owners)


def _names_read(kernel: ForeignShader) -> set[str]:
    """Return the parameters that a text names besides declaring them."""
    return {p.name for p in kernel.parameters if kernel.source.counts[p.name] > 1 or kernel.vertex_source}


def stand_in_paths(path: str, sampler: str) -> set[str]:
    """Return the paths that a channel's own stand-in may have; ``path`` is that of the shader's pass."""
    around, _, name = path.rpartition(".")
    outer = around.rpartition(".")[0]
    inside = {(around, sampler), (outer, sampler), (outer, _own_name(name, sampler))}
    return {f"{where}.{called}" if where else called for where, called in inside}


def _own_name(shader: str, name: str) -> str:
    """Return the name of one shader's channel or parameter where another shader's is not the same."""
    return f"{shader}_{name}"


def _inside(where: str, name: str) -> Export:
    return Export(name, (f"{where}.{name}",))

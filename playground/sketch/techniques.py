"""Read techniques: a GLSL file or a TOML of several passes, each with its fast variants."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from playground.allowed_files import (
    FAST,
    TECHNIQUES,
    canonical_of,
    how_to_open,
    is_file,
    is_inside,
    is_variant,
    leads_outside,
    looking_once,
    names_below,
    real,
    root_of,
)
from playground.errors import PlaygroundError, ShaderError, SketchError, nearest
from playground.files import irregularity
from playground.paths import GLSL, shown
from playground.shader.dialect import OWN, dialects
from playground.shader.header import parsed_kernel, replaced
from playground.shader.kernel import Variant
from playground.shader.source import EncodingError
from playground.sketch.find import shipped_names
from playground.sketch.model import (
    ComputeVariant,
    Draw,
    Graph,
    Kernel,
    PlainFragment,
    PlainShader,
    Technique,
    TexelKernel,
)
from playground.sketch.toml_sketch import read_graph
from playground.sketch.toml_table import TomlFile
from playground.sketch.variants import check_shape, content_of, verified, without_variants
from playground.sketch.wiring import outputs_with_formats

_MAX_NESTING = 16
_MAX_KERNELS = 1_000


def read_kernel(path: Path, folder: Path) -> Kernel | None:
    """Read one GLSL file with its fast variants; None for a library file.

    ``folder`` is where its includes and its files may be, besides ``glsl/``.
    """
    return Techniques().kernel(path, folder)


def read_technique(use: str, folder: Path, root: Path) -> Technique:
    """Return what ``use`` names: ``./x`` in ``folder`` (inside ``root``), else in ``glsl/``.

    Raises ``SketchError`` with the nearest name when there is none.
    """
    return Techniques().read(use, folder, root)


def nothing_to_run(path: Path) -> SketchError:
    """Return the error of a shader file that is opened alone and has nothing to run."""
    if path.suffix == ".glsl":
        message = "a library file: it has no #pragma kernel, source or draw to run"
        return SketchError(message, file=path)
    return SketchError("nothing to run: no main, mainImage or #pragma kernel", file=path)


def technique_beside(path: Path) -> Path | None:
    """Return the technique that a fast variant replaces; None for another file, and where there is none.

    A ``.comp`` with its own ``#version`` is a plain shader and replaces none.
    """
    if not is_variant(path):
        return None
    kernel = read_kernel(path, root_of(path)) if path.suffix == ".comp" else None
    return None if isinstance(kernel, PlainShader) else canonical_of(path)


def lonely_variant(path: Path) -> SketchError:
    """Return the error of a fast variant whose technique is missing."""
    name = path.name.removesuffix(".comp").removesuffix(".fast.toml")
    return SketchError(
        f"a fast variant runs in place of {name}.glsl or {name}.toml, which is missing", file=path
    )


@looking_once()
def shipped_techniques() -> list[str]:
    """List the names of the techniques in ``glsl/``: kernels, draws, sources and TOML techniques.

    One whose files are wrong is listed as well: it exists, and reading it raises the error.

        assert "lighting/l_dot_n" in playground.shipped_techniques()
    """
    names = []
    for name in shipped_names():
        path = GLSL / f"{name}.glsl"
        try:
            if not is_file(path) or read_kernel(path, GLSL) is not None:
                names.append(name)
        except PlaygroundError:
            names.append(name)
    return names


class Techniques:
    """Reads techniques for one sketch, each file once."""

    def __init__(self, dialect: str = "") -> None:
        self.dialect = dialect  # of a shader that is opened alone; "": by its signs
        self.techniques: dict[tuple[str, Path, Path], Technique] = {}
        self.open: list[Path] = []  # techniques of several passes that are being read, outermost first
        self.deepest = 0  # the most that were open at once

    def has_room_for(self, depth: int) -> bool:
        """Return whether techniques nested so deep may be read inside those that are open."""
        return len(self.open) + depth <= _MAX_NESTING

    def read(self, use: str, folder: Path, root: Path) -> Technique:
        """Return what ``use`` names, as ``read_technique`` does."""
        named = (use, folder, root) if use.startswith("./") else (use, GLSL, GLSL)
        if named not in self.techniques:
            path, limit = _locate(use, folder, root)
            is_graph = path.suffix == ".toml"
            technique = self.graph(path, use, limit) if is_graph else self.shader(path, limit)
            if technique is None:
                message = "it has no #pragma kernel, source or draw to run"
                raise SketchError(f"'{use}' is a library file: {message}")
            self.techniques[named] = technique
        return self.techniques[named]

    def shader(self, path: Path, folder: Path, dialect: str = "") -> Technique | None:
        """Return a shader file's kernel, or the passes of another tool's shader; None for a library file.

        ``dialect`` is that of another tool, or "", where the text decides.
        """
        path, kernel = _followed(path), None
        wrong: ShaderError | EncodingError | None = None
        if dialect in ("", OWN):
            try:
                kernel = self.kernel(path, folder)
            except (ShaderError, EncodingError) as error:
                wrong = error
        if (
            (kernel is None or isinstance(kernel, PlainFragment))
            and path.suffix != ".comp"
            and dialect != OWN
        ):
            technique = dialects().read(path, name_of(path), folder, self.read, dialect)
            if technique is not None:
                for _, own in technique.kernels:
                    _check_files(own, folder)
                return technique
        if wrong is not None:
            raise wrong
        return kernel

    def kernel(self, path: Path, folder: Path) -> Kernel | None:
        """Return the kernel of one GLSL file, as ``read_kernel`` does."""
        path = _followed(path)
        kernel = parsed_kernel(name_of(path), path, (folder,))
        if kernel is None:
            return None
        _check_files(kernel, folder)
        if path.suffix == ".glsl" and isinstance(kernel, TexelKernel | Draw):
            variants = self._variants(path, kernel, folder)
            return replaced(kernel, variants=variants) if variants else kernel
        return kernel

    def graph(self, path: Path, name: str, root: Path) -> Graph:
        """Return a technique of several passes, by the path of its TOML, with its fast variants."""
        graph = self._graph(path, name, root)
        variants = self._variants(_followed(path), graph, root)
        return replace(graph, variants=variants) if variants else graph

    def _graph(self, path: Path, name: str, root: Path) -> Graph:
        path = _followed(path)
        if path in self.open:
            circle = [*self.open[self.open.index(path) :], path]
            raise SketchError("techniques use each other in a circle: " + " → ".join(map(shown, circle)))
        if not self.has_room_for(1):
            raise SketchError(f"techniques nest more than {_MAX_NESTING} deep")
        self.open.append(path)
        self.deepest = max(self.deepest, len(self.open))
        try:
            graph = read_graph(TomlFile(path, root), name, self.read)
            check_kernel_count(graph)
        finally:
            self.open.pop()
        return graph

    def _variants(self, path: Path, of: Technique, root: Path) -> tuple[Variant, ...]:
        """Return the fast variants of a technique in a file, the fastest first."""
        return tuple(
            self._variant(variant, of, root)
            for ending in FAST
            if is_file(variant := path.with_name(f"{path.stem}{ending}"))
        )

    def _variant(self, path: Path, of: Technique, root: Path) -> Variant:
        if not is_inside(path, (root, GLSL)):
            raise SketchError("lies outside the sketch's own folder and glsl/", file=path)
        technique: ComputeVariant | Graph
        if path.suffix == ".comp":
            technique = _compute_variant(path, root, of)
        else:
            plain = without_variants(self._graph(path, name_of(path), root))
            assert isinstance(plain, Graph)
            technique = plain
        agreed, record = verified(Path(technique.path))
        if agreed is None or agreed[0] == content_of(of):
            check_shape(technique, of)  # else it is left out anyway
        return Variant(technique, agreed, record)


def _followed(path: Path) -> Path:
    return real(path) or path.resolve()


def name_of(path: Path) -> str:
    """Return a technique's name by its file: in ``glsl/`` what ``use`` takes, elsewhere the file's own."""
    return path.relative_to(GLSL).with_suffix("").as_posix() if path.is_relative_to(GLSL) else path.stem


class WithLibrary(Techniques):
    """Reads a sketch's own techniques again, and those of ``glsl/`` once for all who share ``library``."""

    def __init__(self, library: Techniques) -> None:
        super().__init__()
        self._library = library

    def read(self, use: str, folder: Path, root: Path) -> Technique:
        """Return what ``use`` names, as ``read_technique`` does."""
        own = "./" in use and not folder.is_relative_to(GLSL)
        return super().read(use, folder, root) if own else self._library.read(use, folder, root)


def check_kernel_count(graph: Graph) -> None:
    """Raise ``SketchError`` for more kernels than any terrain needs: a few lines can nest millions."""
    count = _count(graph, {})
    if count > _MAX_KERNELS:
        raise graph.error(f"{count} passes with those inside; {_MAX_KERNELS} is the most")


def _count(technique: Technique, counts: dict[int, int]) -> int:
    if isinstance(technique, Kernel):
        return 1
    if id(technique) not in counts:
        counts[id(technique)] = sum(_count(spec.technique, counts) for spec in technique.passes)
    return counts[id(technique)]


def _locate(use: str, folder: Path, root: Path) -> tuple[Path, Path]:
    """Return the file that ``use`` names, and the folder that it must stay in."""
    own = use.startswith("./")
    limit = root if own else GLSL
    base = (folder if own else GLSL) / (use[2:] if own else use)
    others = dialects().endings if own else ()
    candidates = [base.parent / f"{base.name}{suffix}" for suffix in (*TECHNIQUES, *others)]
    if not base.name.strip(".") or not all(is_inside(path, (limit,)) for path in candidates):
        where = f"the sketch’s own folder{how_to_open(real(base), limit, marks=False)}" if own else "glsl/"
        raise SketchError(f"use = '{use}' lies outside {where}")
    present = [
        path
        for path in candidates
        if is_file(path) and (path.suffix not in others or dialects().is_export(path))
    ]
    if present and is_variant(present[0]):
        raise SketchError(f"use = '{use}' is a fast variant; use = '{use.removesuffix('.fast')}' runs it")
    if len(present) > 1:
        raise SketchError(f"use = '{use}' is both {shown(present[0])} and {shown(present[1])}; remove one")
    if present:
        return _followed(present[0]), limit
    if what := next(filter(None, map(irregularity, candidates)), ""):
        raise SketchError(f"use = '{use}': {what}")
    ending = f" (without '{base.suffix}')" if base.suffix in TECHNIQUES else ""
    files = names_below((folder,), TECHNIQUES) if own else []
    names = [f"./{name.rpartition('.')[0]}" for name in files] if own else shipped_names()
    raise SketchError(f"there is no technique '{use}'{ending}{nearest(use, names)}")


def _compute_variant(path: Path, folder: Path, of: Technique) -> ComputeVariant:
    kernel = parsed_kernel(path.stem, path, (folder,))
    if not isinstance(kernel, ComputeVariant):
        message = 'a .comp next to a kernel begins with #pragma compute(groups = "…", agrees = "…")'
        raise SketchError(message, file=path)
    outputs = of.outputs if isinstance(of, Kernel) else outputs_with_formats(of)
    return replaced(kernel, outputs=outputs, accepts=_accepts(of))


def _accepts(technique: Kernel | Graph) -> str:
    """Return the sizes that a technique takes: those of the first kernel in it that asks for some."""
    if isinstance(technique, Kernel):
        return technique.accepts
    rules = (_accepts(spec.technique) for spec in technique.passes if spec.size is None)
    return next(filter(None, rules), "")


def _check_files(kernel: Kernel, folder: Path) -> None:
    for parameter in kernel.parameters:
        path = str(parameter.default)
        if parameter.widget.kind == "file" and path and leads_outside(path, folder, parameter.file):
            message = f"'{path}' lies outside the sketch's own folder and glsl/"
            raise SketchError(message, file=shown(parameter.file), line=parameter.line)

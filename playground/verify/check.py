"""Check files: compile every kernel by both drivers, load every sketch, draw one small frame of each.

A kernel is drawn in a sketch of its own: placeholder textures for its inputs, a placeholder
picture for files that nothing names, and a view that only copies, so that a mistake
elsewhere cannot pass for one of its own. What is drawn is drawn in the sandbox,
where it can crash or hang.

Numbers that are not finite are a mistake: any in a sketch, in a technique only where a whole
texture holds nothing else, for placeholders may be what it cannot compute with.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from playground.allowed_files import TEXTS, is_elevation, is_variant, named_root, root_of, unsaved_texts
from playground.engine.on_arrays import free_name
from playground.engine.plan import PlanRequest, located_at
from playground.engine.plan_warnings import own_kernels, source_warnings
from playground.engine.planner import make_plan
from playground.engine.sandbox import Request, Sandbox, SandboxReport, TryLibrary, TrySketch
from playground.engine.sketch_warnings import kernel_warnings, shadowed_by_files, warnings_of_kernel
from playground.errors import (
    DataError,
    Diagnostic,
    PlaygroundError,
    SandboxTimeout,
    SketchError,
    nearest,
)
from playground.files import irregularity
from playground.paths import GLSL, SKETCHES, shown
from playground.shader.common_glsl import desktop_only
from playground.shader.dialect import dialects
from playground.shader.source import read_text
from playground.shader.wrap import COMPUTE, FRAGMENT
from playground.sketch.assign import values_of
from playground.sketch.find import ENDING, is_pack, unpacked
from playground.sketch.flatten import omitted
from playground.sketch.load import is_technique, load, plain_sketch
from playground.sketch.model import (
    VARIANTS,
    ComputeVariant,
    Graph,
    PlainCompute,
    PlainShader,
    Sketch,
    Technique,
    kernels_of,
)
from playground.sketch.techniques import (
    Techniques,
    lonely_variant,
    nothing_to_run,
    read_technique,
    technique_beside,
)
from playground.sketch.variants import (
    any_variants,
    check_shape,
    is_verified,
    trusted,
    unverified,
    why_not,
    without_variants,
)
from playground.sketch.warnings import warnings_of_sketch
from playground.sketch.wiring import deciding_inputs, form_of, missing_input
from playground.verify.standalone import standalone_sketch, with_pictures

BOTH = (FRAGMENT, COMPUTE)
_FRAME = (64, 36)  # pixels
_NAME = re.compile(r"[a-z]\w*", re.ASCII | re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class FileReport:
    """What was found in one file."""

    path: str  # as the user would name it
    ok: bool
    skipped: tuple[str, ...] = ()  # drivers that this machine does not have
    errors: tuple[Diagnostic, ...] = ()
    warnings: tuple[Diagnostic, ...] = ()  # what fails nothing
    notes: tuple[str, ...] = ()  # messages: fast variants that do not run
    seconds: float = 0.0  # in the sandbox

    def as_json(self) -> dict[str, object]:
        """Return it as JSON takes it; ``line`` and ``column`` count from 1, 0 where unknown."""
        errors, warnings = (
            [{"file": d.file, "line": d.line, "column": d.column, "message": d.message} for d in some]
            for some in (self.errors, self.warnings)
        )
        report = {"path": self.path, "ok": self.ok, "skipped": list(self.skipped)}
        return report | {"errors": errors, "warnings": warnings, "notes": list(self.notes)}


def find_files(paths: Iterable[str | Path]) -> list[tuple[Path, Path]]:
    """Return every file to check with the folder it may include from, each file once.

    A folder is searched through and through, but for hidden folders, virtual environments
    and TOML files of other programs. Raises ``DataError`` for a path that is not there or
    cannot be checked, and for folders in which there is nothing to check.
    """
    files: dict[Path, Path] = {}
    named: list[str] = []
    for path_text in paths:
        path = Path(path_text).expanduser()
        named.append(shown(path))
        if path.is_dir():
            for file in _inside(path):
                files.setdefault(file.resolve(), named_root(file.resolve()) or path.resolve())
        elif path.is_file():
            if is_pack(path):
                sketch = unpacked(path)
                for file in _inside(sketch.parent):
                    files.setdefault(file.resolve(), sketch.parent.resolve())
                continue
            if path.suffix not in TEXTS and not dialects().is_export(path) and not is_elevation(path):
                expected = ", ".join((*TEXTS, ENDING, "an elevation file"))
                raise DataError(f"cannot be checked; expected a folder or {expected}", file=shown(path))
            files.setdefault(path.resolve(), root_of(path.resolve()))
        elif what := irregularity(path):
            raise DataError(what, file=shown(path))
        else:
            near = [p.name for p in path.parent.iterdir()] if path.parent.is_dir() else []
            hint = nearest(path.name, near)
            raise DataError(
                f"there is no such file or folder{hint if 'mean' in hint else ''}", file=shown(path)
            )
    if not files:
        expected = ", ".join(TEXTS)
        raise DataError(f"nothing to check in {', '.join(named)}; expected files ending in {expected}")
    return list(files.items())


def check_file(
    path: Path, sandbox: Sandbox, root: Path | None = None, *, plain: bool = False, dialect: str = ""
) -> FileReport:
    """Check one file and return what is wrong with it; ``root`` is the folder it may include from.

    ``plain``: no fast variant is drawn. ``dialect`` is that of a shader of another tool; "": by its text.
    """
    path = path.resolve()
    with TemporaryDirectory(prefix="playground-check-") as folder:
        root = root_of(path) if root is None else root
        report = _Check(sandbox, path, root, Path(folder), plain, dialect).run()
    return report


class _Check:
    """One file being checked."""

    def __init__(
        self, sandbox: Sandbox, path: Path, root: Path, scratch: Path, plain: bool, dialect: str
    ) -> None:
        self.plain = plain
        self.dialect = dialect
        self.notes: tuple[str, ...] = ()
        self.sandbox = sandbox
        self.path = path
        self.root = GLSL if path.is_relative_to(GLSL) and not path.is_relative_to(SKETCHES) else root
        self.scratch = scratch  # where the placeholder picture is written
        self.skipped: dict[str, None] = {}
        self.errors: dict[Diagnostic, None] = {}
        self.warnings: dict[Diagnostic, None] = {}
        self.seconds = 0.0

    def run(self) -> FileReport:
        check: Callable[[], None] = self.shader
        if technique_beside(self.path) is not None:
            check = self.variant
        elif is_elevation(self.path):
            check = self.sketch
        elif self.path.suffix == ".toml":
            check = self.technique if is_technique(self.path) else self.sketch
        try:
            check()
        except PlaygroundError as error:
            self.failed(error)
        wrong = tuple(self.errors)
        mild = () if wrong else tuple(self.warnings)  # a misspelt name would be one that nothing reads
        skipped, notes = tuple(self.skipped), self.notes
        return FileReport(shown(self.path), not wrong, skipped, wrong, mild, notes, self.seconds)

    # ── the kinds of file ────────────────────────────────────────────────────

    def shader(self) -> None:
        kernel = Techniques().shader(self.path, self.root, self.dialect)
        if kernel is None and self.path.suffix != ".glsl":
            raise nothing_to_run(self.path)
        for _, kernel_inside in kernels_of(kernel) if kernel is not None else ():
            if not Path(kernel_inside.path).is_relative_to(GLSL) or self.path.is_relative_to(GLSL):
                self.warnings |= dict.fromkeys(warnings_of_kernel(kernel_inside))
                self.warnings |= dict.fromkeys(desktop_only(kernel_inside))
        if kernel is None:
            self.attempt(TryLibrary(str(self.path), str(self.root), tuple(unsaved_texts().items())))
        elif isinstance(kernel, Graph) or isinstance(kernel, PlainShader):
            sketch = with_pictures(plain_sketch(self.path, kernel, self.root), self.picture)
            if isinstance(kernel, Graph):
                self.notes = (f"read as {kernel.dialect}",)
                self.warnings |= dict.fromkeys(warnings_of_sketch(sketch))
                self.warnings |= dict.fromkeys(
                    source_warnings(make_plan(sketch, PlanRequest(frame_size=_FRAME)))
                )
            self.attempt(TrySketch(sketch, _FRAME, drivers=_drivers(sketch), refuses="all"))
        elif isinstance(kernel, ComputeVariant):
            raise lonely_variant(self.path)
        else:
            self.check_standalone(kernel)

    def variant(self) -> None:
        """Try a fast variant, verified or not."""
        owner = technique_beside(self.path)
        assert owner is not None
        technique = self.read(owner)
        own = next((v for v in technique.variants if Path(v.path) == self.path), None)
        if own is None:  # a .comp with its own #version, next to a shader that can have no fast variant
            self.shader()
            return
        check_shape(own.technique, technique)
        if not is_verified(technique, own):
            self.notes = (f"it does not run, the plain form does: {why_not(technique, own)}",)
        if not self.plain:
            alone = trusted(replace(without_variants(technique), variants=(own,)))
            self.attempt(
                self.request(alone, (COMPUTE,) if isinstance(own.technique, ComputeVariant) else BOTH)
            )

    def technique(self) -> None:
        if is_variant(self.path):
            raise lonely_variant(self.path)
        self.check_standalone(self.read(self.path))

    def sketch(self) -> None:
        sketch = load(self.path).plainly(self.plain)
        self.notes = omitted(sketch, VARIANTS)
        self.warnings |= dict.fromkeys(warnings_of_sketch(sketch))
        request = TrySketch(sketch, _FRAME, drivers=_drivers(sketch), refuses="any")
        if reads := _names_files(sketch):  # a plan asks its files for their size: the child reads them first
            self.attempt(request)
            if self.errors:
                return
        # The child draws small; what is wrong at the sketch's own size shows in the plan.
        plan = make_plan(sketch, PlanRequest(frame_size=_FRAME))
        self.warnings |= dict.fromkeys([*kernel_warnings(sketch.graph), *source_warnings(plan)])
        self.warnings |= dict.fromkeys(w for k in own_kernels(sketch.graph) for w in desktop_only(k))
        self.warnings |= dict.fromkeys(shadow.warning for shadow in shadowed_by_files(sketch))
        for preset in sketch.presets:
            make_plan(sketch.with_preset(preset.name), PlanRequest(frame_size=_FRAME))
        for shot in sketch.shots:
            with located_at(sketch, shot):
                make_plan(
                    sketch.for_shot(shot),
                    PlanRequest(frame_size=shot.size, time=shot.time, steps=dict(shot.steps)),
                )
        if not reads:
            self.attempt(request)

    # ── trying ───────────────────────────────────────────────────────────────

    def check_standalone(self, technique: Technique) -> None:
        """Try a technique: its own text by both drivers, then its fast variants, verified or not."""
        result = () if self.plain else unverified(self.standalone_sketch(technique))
        self.notes = tuple(map(str, result))
        plain = without_variants(technique)
        self.attempt(self.request(plain, BOTH))
        deciding = deciding_inputs(plain)
        if isinstance(plain, Graph) and deciding and not missing_input(form_of(plain, ())):
            whole = self.standalone_sketch(plain)
            passes = tuple(spec for spec in whole.graph.passes if spec.name not in deciding)
            least = replace(whole, graph=replace(whole.graph, passes=passes))
            self.attempt(TrySketch(least, _FRAME, drivers=BOTH, refuses="all"))
        if any_variants(technique) and not self.plain and not self.errors:
            self.attempt(self.request(trusted(technique), (COMPUTE,)))

    def attempt(self, request: Request) -> None:
        report: SandboxReport = self.sandbox.run(request)
        self.seconds += report.seconds
        self.skipped |= dict.fromkeys(report.skipped)
        if report.error is not None:
            self.failed(report.error, f"; --limit {2 * self.sandbox.limit_seconds:g} gives it more time")
        elif not report.ok:
            self.failed(PlaygroundError("the sandbox failed and gave no reason"))

    def failed(self, error: PlaygroundError, more_time: str = "") -> None:
        """Add an error; ``more_time`` is what a message about the limit ends in."""
        for diagnostic in error.diagnostics:
            if diagnostic.severity == "error":
                if isinstance(error, SandboxTimeout):
                    diagnostic = replace(diagnostic, message=f"{diagnostic.message}{more_time}")
                located = diagnostic if diagnostic.file else replace(diagnostic, file=shown(self.path))
                self.errors[located] = None

    def read(self, path: Path) -> Technique:
        if path.is_relative_to(GLSL):
            return read_technique(path.relative_to(GLSL).with_suffix("").as_posix(), GLSL, GLSL)
        return read_technique(f"./{path.stem}", path.parent, self.root)

    def request(self, technique: Technique, drivers: tuple[str, ...]) -> TrySketch:
        return TrySketch(self.standalone_sketch(technique), _FRAME, drivers=drivers, refuses="all")

    def standalone_sketch(self, technique: Technique) -> Sketch:
        """Return a sketch that shows a technique, its inputs wired to placeholders."""
        subject = self.path.stem if _NAME.fullmatch(self.path.stem) else "technique"
        sketch = standalone_sketch(technique, free_name(subject, technique), self.root, self.picture)
        return replace(sketch, name=self.path.stem, file=str(self.path))

    @property
    def picture(self) -> Path:
        """The file that replaces those that nothing names."""
        return self.scratch / "placeholder.png"


def _inside(folder: Path) -> Iterator[Path]:
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name in ("node_modules", "__pycache__"):
            continue
        if path.is_dir():
            if not (path / "pyvenv.cfg").exists() and not path.is_symlink():
                yield from _inside(path)
        elif path.suffix in TEXTS and (path.suffix != ".toml" or _is_ours(path)):
            if not dialects().is_inside(path):  # the Image is checked with all of its passes
                yield path
        elif path.suffix in dialects().endings and _holds_passes(path):
            yield path


def _holds_passes(path: Path) -> bool:
    """Return whether a JSON is an export; one that cannot be read is somebody else's."""
    with suppress(SketchError):
        return dialects().is_export(path)
    return False


def _is_ours(path: Path) -> bool:
    try:
        table = tomllib.loads(read_text(path))
    except (SketchError, ValueError, RecursionError):
        return True  # so that it is reported
    return "pass" in table or "format" in table or "view" in table


def _names_files(sketch: Sketch) -> bool:
    """Return whether any parameter names an image or an elevation file."""
    values = values_of(sketch)
    return any(
        parameter.widget.kind == "file" and values[f"{path}.{parameter.name}"]
        for path, kernel in kernels_of(sketch.graph)
        for parameter in kernel.parameters
    )


def _drivers(sketch: Sketch) -> tuple[str, ...]:
    """Return the drivers that a sketch can be drawn by: a plain compute shader has one only."""
    only_compute = any(isinstance(kernel, PlainCompute) for _, kernel in kernels_of(sketch.graph))
    return (COMPUTE,) if only_compute else BOTH

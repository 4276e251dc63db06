"""Write what is left into a folder: a sketch that reproduces the failure, and a text that says how."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from shlex import quote as quoted

from playground._version import __version__
from playground.errors import DataError, counted
from playground.files import write_file, writing
from playground.json_text import read_json
from playground.paths import shown
from playground.shader.wrap import wrap
from playground.sketch.load import load
from playground.sketch.model import kernels_of
from playground.verify.reduce.candidate import (
    CandidateProcess,
    CommandFailure,
    DrawTask,
    DriverFailure,
    FailureKind,
    Finding,
    Probe,
    Refused,
)
from playground.verify.reduce.case import SHOT, Case, copied
from playground.verify.reduce.initial_case import InitialCase, Question
from playground.verify.reduce.search import Search

RECORD = "reduced.json"
"""The file by which a folder is known to be one of ours."""


@dataclass(frozen=True, eq=False)
class Account:
    """What the text in the folder says."""

    command_line: str
    question: Question
    initial: InitialCase
    search: Search
    finding: Finding  # of what is left


def claim(folder: Path) -> None:
    """Check that a folder can be written: it is not there, is empty, or an earlier one of ours."""
    if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
        raise DataError("is no folder; choose another name with -o", file=shown(folder))
    if folder.is_dir() and any(folder.iterdir()) and not (folder / RECORD).is_file():
        raise DataError(
            "this folder holds other things, and nothing is overwritten; choose another with -o",
            file=shown(folder),
        )
    if not folder.parent.is_dir():
        raise DataError(f"there is no folder '{folder.parent}' to make it in", file=shown(folder))


def write_folder(folder: Path, account: Account, more: Mapping[str, str]) -> list[Path]:
    """Write the folder, and some texts ``more``, and return its files.

    The files of an earlier one of ours go, any others stay.

    Raises ``DataError`` where it cannot be written.
    """
    claim(folder)
    texts = account.search.best.texts()
    data = copied(account.search.best.files, texts)
    texts |= {"README.txt": readme_text(account, folder), **more}
    names = sorted([*texts, *(name for name, _ in data), RECORD])
    with writing(shown(folder)):
        folder.mkdir(exist_ok=True)
        for name in set(_earlier(folder)) - set(names):
            (folder / name).unlink(missing_ok=True)
        record = {"playground": __version__, "sketch": account.question.sketch.name, "files": names}
        texts[RECORD] = json.dumps(record, indent=2) + "\n"
        for name, text in texts.items():
            write_file(folder / name, text)
        for name, source in data:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, folder / name)
    return [folder / name for name in names]


def _earlier(folder: Path) -> list[str]:
    """Return the names of the files that an earlier run wrote, none that lead elsewhere."""
    try:
        names = read_json((folder / RECORD).read_text(encoding="utf-8"))["files"]
        return [name for name in names if isinstance(name, str) and Path(name).name == name]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def readme_text(account: Account, folder: Path) -> str:
    """Return the text that goes with a report of the failure."""
    question, initial, search = account.question, account.initial, account.search
    before, after = initial.case, search.best
    lines = [
        f"{question.sketch.name}, reduced: {account.finding.kind}",
        "",
        f"    {account.finding.details.strip()}".replace("\n", "\n    "),
        "",
        "To see it:",
        "",
        *(f"    {command}" for command in to_reproduce(question, folder, after, initial.probe.failure)),
        "",
        f"Looked at: pass '{after.target}', the last of {len(after.live)}.",
        f"Reduced from {before.lines} to {counted(after.lines, 'line')} of GLSL,"
        f" from {before.settings} to {counted(after.settings, 'parameter')},"
        f" from {len(before.live)} to {len(after.live)} passes,"
        f" in {search.tries} tries and {search.state.seconds:.0f} s.",
        "Nothing more goes: without any one of its lines it fails no more, or otherwise."
        if search.finished
        else "It was stopped before nothing more went: it may be shortened further.",
        "",
    ]
    for index, info in enumerate(initial.renderers):
        name = "Renderer" if len(initial.renderers) == 1 else f"Renderer {index + 1}"
        lines += [f"{name}:", f"    {info.renderer}", f"    {info.version}", f"    {info.vendor}"]
        if index == 1:
            lines += [f"    {key}={value}" for key, value in question.environment.items()]
    lines += ["", f"Made by terrain-shader-playground {__version__}:", f"    {account.command_line}", ""]
    return "\n".join(lines)


def to_reproduce(question: Question, folder: Path, case: Case, failure: FailureKind) -> tuple[str, ...]:
    """Return the commands that show the failure of what is left, from the folder that holds the folder."""
    name = quoted(folder.name)
    if isinstance(failure, CommandFailure):
        return (f"cd {name}", failure.command)
    path = name if case.file == "sketch.toml" else f"{name}/{case.file}"
    shot = f" --shot {SHOT}" if case.file == "sketch.toml" else ""
    look = "" if failure.as_picture or not shot else f" --texture {case.target}"
    ending = ".npy" if look else ".png"
    lines = []
    for index, side in enumerate(failure.sides):
        other = index > 0 and question.criterion.kind == "against"
        pairs = question.environment.items() if other else ()
        device = question.other_device if other and question.other_device is not None else question.device
        before = "".join(f"{key}={quoted(value)} " for key, value in pairs)
        options = f" --driver {side.driver}" if side.driver != "auto" else ""
        options += " --software" if question.software else ""
        options += f" --device {device}" if device is not None else ""
        number = "" if len(failure.sides) == 1 else f"-{index + 1}"
        command = f"playground render {path}{shot}{look}{options} -o {SHOT}{number}{ending}"
        lines.append(before + command)
    return tuple(lines)


def plain_texts(case: Case, probe: Probe, finding: Finding, process: CandidateProcess) -> dict[str, str]:
    """Return the reduced pass as the driver sees it, all wrapping in place, if that still fails so.

    By file name; empty where the plain shader does not fail in the same way. The probe's
    folder must hold the case. Raises ``DataError`` for a failure that is not the compiler's.
    """
    failure = probe.failure
    if not isinstance(failure, Refused | DriverFailure):
        raise DataError("--plain is for what the compiler refuses, or dies of")
    graph = load(probe.folder / case.file).graph
    kernel = next(kernel for path, kernel in kernels_of(graph) if path in (case.target, "view"))
    driver = failure.sides[0].driver
    stages = wrap(kernel, driver).stages
    endings = {"vertex": ".vert", "fragment": ".frag", "compute": ".comp"}
    texts = {f"plain{endings[stage]}": stages[stage].text for stage in stages}
    for name, text in texts.items():
        write_file(probe.folder / name, text)
    opened = "plain.frag" if "plain.frag" in texts else "plain.comp"
    result = process.draw(
        DrawTask(sketch=str(probe.folder / opened), ref="", driver=driver, frame=case.frame, time=case.time)
    )
    after = failure.finding([result])
    return texts if after is not None and after.kind == finding.kind else {}

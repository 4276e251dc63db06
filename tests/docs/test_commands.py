"""Every command that the documentation and the lessons quote runs.

What is quoted is found in the texts: the lines of shell blocks, and what is between backticks
and begins with a program's name. Each is run in a folder of its own that holds the files it speaks
of, at a small size. A command that opens a window is run twice: without a display, where its
arguments are read and the missing display is reported, and, in the slow tests, in a window under Xvfb.
What is not run is in NOT_RUN, with its reason; a whole block says it in a comment (see pages.py).
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from contextlib import nullcontext, redirect_stdout
from itertools import takewhile
from pathlib import Path

import pytest

from playground import cli

from ..elevations import write_geotiff
from ..studio.screen import ON_LINUX, Program, Screen
from .pages import PAGES, ROOT, blocks_of, files, outside_of_blocks, write_files

TEXTS = ROOT / "playground" / "course" / "texts"
LESSONS = tuple(sorted(TEXTS.rglob("*.md")))
INLINE = re.compile(r"`((?:\./play|playground|python|pytest|pip)(?: [^`\n]*)?)`")
FORM = re.compile(  # how a command is used, not a command
    r"[…\[\]]|\b(?:FILE|NAME|PATH|FOLDER|DIR|COMMAND)\b"
)

NOT_RUN = {
    r"export \w+=.*": "sets a variable; test_editors.py and test_cache.py read it",
    r"(python -m )?pip (install|wheel) .*": "needs a network; ./play does as much, and .ci/run begins by it",
    r"\./play add( .*)?": "installs into .venv: tests/test_play.py, with a pip that installs nothing",
    r"sudo apt-get .*": "needs a network and an administrator",
    r"\./play test( -m slow)?": "is these tests",
    r"pytest -n 2 --dist loadfile": "is these tests, in two processes",
    r"\.venv/bin/.*": "is a step of .ci/run",
    r"playground shots review.*": "serves until it is stopped: tests/verify/report/test_review.py",
    r"playground shots accept .*": "needs a shot that failed: tests/verify/report/test_accept.py",
    r"playground lsp.*": "serves until its editor ends: tests/lsp",
    r"playground live -": "reads a pipe or the clipboard: tests/studio/test_window.py",
    r"playground reduce my-land --shot morning": "needs a reference that fails: verify/reduce/test_reduce.py",
    r"playground reduce my-land --against .*": "takes minutes: test_two_environments_that_differ does it",
    r"playground reduce my-land --command .*": "is-good is the user's: test_a_command_judges_and_the_folder",
    r"playground shots report": "names the command; verify/report/test_report.py has results to give it",
    r"playground (render --video|check --json|reduce|pack|shots mutants)": "names it; with more it is run",
    r"playground (trace|export --trace)": "names it; with more it is run",
    r"\./play lesson present .* --video .*": "takes minutes; test_present_film.py has a small one",
    r"playground bench": "takes minutes: tests/verify/bench run small parts of it",
    r"playground lesson translated": "names the command; tests/course have a translation to give it",
    r"playground variants renew": "writes this checkout's record; that of a folder is written",
    r"pytest|pip": "names the program",
}

SLOPE = """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return 0.25 * float(texel.x); }
"""
SLOPE_FAST = """#pragma compute(groups = "size.x // 8 + 1, size.y // 8 + 1", local = "8, 8", agrees = "exact")
void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(texel, size))) imageStore(out_height, texel, vec4(0.25 * float(texel.x)));
}
"""
FLIGHT = {
    "format": "playground flight",
    "version": 1,
    "sketch": "flight",
    "size": [64, 36],
    "step": 1 / 60,
    "radius": 1.5,
    "values": {},
    "start": None,
}


def quoted() -> list[str]:
    """Return the commands of all texts, each once, in the order of the texts."""
    result: dict[str, None] = {}
    for path in (*PAGES, *LESSONS):
        for block in blocks_of(path):
            if not block.reason:
                result |= dict.fromkeys(lines_of(block.language, block.text))
            if path in LESSONS:  # exercises lie in TOML blocks
                result |= dict.fromkeys(INLINE.findall(block.text))
        result |= dict.fromkeys(INLINE.findall(outside_of_blocks(path)))
    once = {re.sub(r"^\./play\b(?! test)", "playground", command): command for command in reversed(result)}
    return [command for command in reversed(once.values()) if not FORM.search(command)]


def lines_of(kind: str, block: str) -> Iterator[str]:
    """Yield the commands of a shell block, and of a workflow's steps."""
    if kind == "sh":
        for line in block.replace("\\\n", " ").splitlines():
            command = re.sub(r"\s+# .*", "", line).strip()
            if command and not command.startswith("#"):
                yield re.sub(r"\s+", " ", command)
    if kind == "yaml":
        for command in re.findall(r"- run: (.*)", block):
            yield from re.sub(r"\s+#.*", "", command).split(" && ")


def arguments(command: str) -> list[str]:
    """Return what a command gives to the playground, without where its output goes; ``./play`` is it too."""
    words = list(takewhile(lambda word: word != ">", shlex.split(command)[1:]))
    return [str(ROOT / word) if word.startswith("glsl/") else word for word in words]


def runs_by_playground(command: str) -> bool:
    return command.split()[0] in ("playground", "./play") and not command.startswith("./play test")


def opens_a_window(command: str) -> bool:
    words = arguments(command)
    if command in ("./play", "playground") or words[:1] == ["live"] or words[:2] == ["lesson", "open"]:
        return True
    if words[:2] == ["lesson", "present"]:
        return "--video" not in words
    return words[:1] == ["fly"] and "--frames" not in words


def is_run(command: str) -> bool:
    return not any(re.fullmatch(pattern, command) for pattern in NOT_RUN)


ALL = quoted()
OURS = [c for c in ALL if is_run(c) and runs_by_playground(c)]
WINDOWS = [c for c in OURS if opens_a_window(c)]
OTHERS = [c for c in ALL if is_run(c) and not runs_by_playground(c)]
SLOW = re.compile(
    r"(playground|\./play) (check|list)$|check (hills|dunes|ridges|--json)|lesson (build|check|grade|handout)"
    r"|reduce|fly|variants verify|mutants"
    r"|--video|--frames|\.glb|--sweep|20000|--texture|--technique|--profile|\.html"
)


def test_there_are_commands_and_each_reason_is_still_needed():
    assert len(ALL) > 50
    unused = [pattern for pattern in NOT_RUN if not any(re.fullmatch(pattern, c) for c in ALL)]
    assert not unused


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Give a folder that is the present one, with caches and memories of its own."""
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("COLUMNS", "200")
    monkeypatch.delenv("PLAYGROUND_CACHE", raising=False)
    return here


FAST = 'agrees = "exact"\n[[pass]]\nname = "height"\nuse = "./twin"\n'


def furnish(folder: Path, command: str) -> None:
    """Put there what a command speaks of and does not make itself."""
    from playground.sketch.techniques import read_kernel
    from playground.sketch.templates import make_sketch

    words = arguments(command)
    for title in files():
        made = title.partition("/")[0]
        if made in words and words[:1] != ["new"]:
            write_files(folder, made)
    for name in ("hills", "my-land"):
        if words[:1] != ["new"] and (name in words or (name == "my-land" and words == ["check"])):
            shutil.rmtree(folder / name, ignore_errors=True)
            made = make_sketch(folder / name)
            if words[0] == "variants":
                (made / "slope.glsl").write_text(SLOPE, "utf-8")
                (made / "slope.comp").write_text(SLOPE_FAST, "utf-8")
                sketch = made / "sketch.toml"
                more = '[[pass]]\nname = "slope"\nuse = "./slope"\n'
                sketch.write_text(f"{sketch.read_text('utf-8')}\n{more}", "utf-8")
            if words[0] == "reduce":
                kernel = made / "my_land.glsl"
                text = kernel.read_text("utf-8")
                at = text.index("return")
                kernel.write_text(text[:at] + "float wrong = fract(1.0, 2.0);\n    " + text[at:], "utf-8")
            if words[0] == "variants":
                (made / "twin.glsl").write_text((made / "my_land.glsl").read_text("utf-8"), "utf-8")
                plain = read_kernel(made / "my_land.glsl", made)
                assert plain is not None
                exports = "".join(f'{p.name} = "height.{p.name}"\n' for p in plain.parameters)
                (made / "my_land.fast.toml").write_text(f"{FAST}[parameters]\n{exports}", "utf-8")
    if "first" in words and words[:1] != ["new"]:
        make_sketch(folder / "first", empty=True)
    if words[:2] == ["live", "week3.zip"] or words[:2] == ["lesson", "grade"]:
        assert cli.main(["lesson", "handout", "diamond_square", "-o", "week3.zip"]) == 0
        (folder / "handed-in").mkdir()
        shutil.copyfile("week3.zip", "handed-in/Zoë.zip")
    if "--wheel" in words:
        name = words[words.index("--wheel") + 1]
        with zipfile.ZipFile(name, "w") as archive:
            archive.writestr(f"{'-'.join(name.split('-')[:2])}.dist-info/METADATA", "")
    if "lesson.zip" in words and words[0] != "pack":
        make_sketch(folder / "my-land")
        assert cli.main(["pack", "my-land", "-o", "lesson.zip"]) == 0
    for heightmap in ("land.png", "land.r16"):
        if f"height.elevation={heightmap}" in words:
            assert cli.main(["export", "jacksboro", "--to", heightmap]) == 0
    if "before.json" in words and "--against" in words:
        assert cli.main(["bench", "normalisation", "--size", "65", "--rounds", "1", "-o", "before.json"]) == 0
    if "dem.tif" in words:
        write_geotiff(folder / "dem.tif")
    if "--replay" in words:
        (folder / "evening.jsonl").write_text(
            "\n".join([json.dumps(FLIGHT), "[20, 50, 10, -30, 0]"]), "utf-8"
        )


def smaller(words: list[str]) -> list[str]:
    """Return a command's arguments with small pictures, short films, few values and one lesson."""
    names = list(words)
    for at, word in enumerate(words):
        if word == "--size" and names[0] == "bench":
            names[at + 1] = "65"
        elif word == "--size":
            width, height = (int(n) for n in words[at + 1].split("x"))
            names[at + 1] = f"{max(width // 100, 32)}x{max(height // 100, 32)}"
        if word == "--frames" and ".." in words[at + 1]:
            names[at + 1] = "0..1"
        if word == "-n":
            names[at + 1] = "2"
    if "--video" in names:
        names += ["--seconds", "0.1"]
    if names[0] == "render" and "--size" not in names:
        names += ["--size", "64x36"]
    if names[:2] == ["shots", "mutants"]:
        names += ["--size", "64x36", "--mutant", "no-shadow"]
    if "--again" in names:
        names[names.index("--again") + 1] = "1"
    if names[:2] in (["variants", "verify"], ["variants", "renew"]) and "my-land" not in names:
        names = ["variants", "verify", "generation/smooth"]  # and nothing is written into the library
    if names == ["check"]:
        names += ["my-land"]
    if names[:2] in (["lesson", "build"], ["lesson", "check"]):
        names += ["heightfield"]
    return names


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(c, marks=pytest.mark.slow if SLOW.search(c) else ())
        for c in OURS
        if not opens_a_window(c)
    ],
)
def test_it_runs(command: str, folder: Path, capsys: pytest.CaptureFixture[str]):
    furnish(folder, command)
    _, piped, target = command.partition(" > ")
    with Path(target).open("w") if piped else nullcontext(sys.stdout) as out, redirect_stdout(out):
        status = cli.main(smaller(arguments(command)))
    assert status == 0, capsys.readouterr().err
    assert not piped or Path(target).stat().st_size > 100


@pytest.mark.parametrize("command", WINDOWS)
def test_without_a_display_only_the_display_is_missing(
    command: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """Its arguments are read before the display is needed."""
    for variable in ("DISPLAY", "WAYLAND_DISPLAY", "XDG_SESSION_TYPE"):
        monkeypatch.delenv(variable, raising=False)
    furnish(folder, command)
    status = cli.main(arguments(command))
    message = capsys.readouterr().err
    assert "screen to open a window" in message or "no display" in message
    assert status == (0 if command in ("./play", "playground") else 2)


def shape_of(command: str) -> tuple[str, ...]:
    """Return what of a command that opens a window tells it from others: of names, only what they end in."""
    words = arguments(command)
    known_names = {"live", "fly", "lesson", "open", "present"}
    return tuple(w if w in known_names or w.startswith("-") else Path(w).suffix for w in words)


@pytest.mark.slow
@pytest.mark.parametrize(
    "command", [pytest.param(c, marks=ON_LINUX) for c in {shape_of(c): c for c in reversed(WINDOWS)}.values()]
)
def test_it_opens_its_window(command: str, folder: Path, tmp_path: Path):
    furnish(folder, command)
    screen = Screen(tmp_path, 800, 600)
    program = Program(screen, tmp_path, [sys.executable, "-m", "playground", *arguments(command)], folder)
    try:
        if arguments(command)[:1] == ["fly"]:
            wait_for_a_picture(program)
        else:
            program.wait(lambda now: (now["draws"] or now["layers"] == ["start page"]) and not now["error"])
    finally:
        program.close()
        screen.close()


def wait_for_a_picture(program: Program) -> None:
    """Wait until something is on the screen: ``fly`` does not tell what it shows."""
    import time

    end = time.monotonic() + 90
    while time.monotonic() < end:
        assert program.process.poll() is None, program.complaint()
        if program.screen.pixels().std() > 5:
            return
        time.sleep(0.2)
    pytest.fail("no picture")


# What is named in a text


def test_every_option_that_is_named_exists():
    def options(command: object) -> set[str]:
        own = {o for p in command.params for o in (*p.opts, *p.secondary_opts)}  # type: ignore[attr-defined]
        return own.union(*map(options, getattr(command, "commands", {}).values()))

    plugin = (ROOT / "playground" / "verify" / "shots" / "plugin.py").read_text("utf-8")
    own_tests = (ROOT / "tests" / "conftest.py").read_text("utf-8")
    existing = options(cli.command_line()) | set(re.findall(r'"(--shots-[a-z-]+)"', plugin))
    existing |= set(re.findall(r'addoption\(\s*"(--[a-z-]+)"', own_tests))
    existing |= {
        "--help",
        "--reuse-window",
        "--at",
        "--strict",
        "--dist",
        "--junitxml",
        "--check",
        "--to",
        "--execute",
    }  # of others
    named = {o for page in PAGES for o in re.findall(r"(?<![\w-])--[a-z][a-z-]+", page.read_text("utf-8"))}
    assert named and not named - existing - {"--no-install-recommends", "--no-deps"}


# Programs other than the playground


def run(folder: Path, words: list[str], *, timeout: float = 500) -> subprocess.CompletedProcess[str]:
    """Run a program of this Python's; return its output."""
    words = [sys.executable if word == "python" else word for word in words]
    if words[0] == "pytest":
        words[:1] = [sys.executable, "-m", "pytest"]
    return subprocess.run(
        words, cwd=folder, capture_output=True, text=True, encoding="utf-8", timeout=timeout
    )


SMALL = {
    "python tests/truth": ["--size", "25"],
}
IN_HILLS = [c for c in OTHERS if re.fullmatch(r"(python -m pytest|pytest|\./play test) hills.*", c)]
EXPORT = "jupyter nbconvert --to terrain_html diamond_square.ipynb"
OF_PLAY = [c for c in OTHERS if c.startswith("./play test ") and c not in IN_HILLS]
UPDATE = "pytest hills --shots-update"
COLLECT = """
import shlex, sys, pytest
for command in sys.argv[1:]:  # in one process, which imports all that there is once
    if status := pytest.main([*shlex.split(command)[1:], "--collect-only"]):
        sys.exit(f"{command}: {status}")
"""


def test_every_other_program_is_known():
    assert set(OTHERS) == {*SMALL, *IN_HILLS, *OF_PLAY, EXPORT}
    assert {"pytest hills", UPDATE} <= set(IN_HILLS)


@pytest.mark.slow  # three seconds of a program whose parts tests/truth tests every day
def test_the_truth_is_printed():
    done = run(ROOT, ["python", "tests/truth", "--size", "25", "L·N"])
    assert done.returncode == 0, done.stderr
    assert "L·N" in done.stdout and "cone" in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("command", SMALL)
def test_a_program_of_the_checkout_runs(command: str):
    done = run(ROOT, [*command.split(), *SMALL[command]])
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_the_pictures_of_hills_from_none_to_accepted(folder: Path):
    """As the tutorial has it: no reference fails, an update writes it, then it passes; a turned sun fails."""
    assert cli.main(["new", "hills"]) == 0
    for command, total in (("pytest hills", 1), (UPDATE, None), ("pytest hills", 0)):
        done = run(folder, shlex.split(command))
        assert total is None or done.returncode == total, done.stdout
    assert list((folder / "hills" / "screenshots").rglob("*.png"))
    others = {f"pytest hills{c.partition(' hills')[2]}" for c in IN_HILLS} - {"pytest hills", UPDATE}
    done = run(folder, ["python", "-c", COLLECT, *others])
    assert done.returncode == 0, done.stdout + done.stderr
    sketch = folder / "hills" / "sketch.toml"
    text = sketch.read_text("utf-8")
    tutorial = (ROOT / "docs" / "tutorials" / "first-screenshot-test.md").read_text("utf-8")
    before, after = re.findall(r"`(azimuth = [\d.]+)`", tutorial)
    assert before in text
    sketch.write_text(text.replace(before, after), encoding="utf-8")
    assert run(folder, ["pytest", "hills"]).returncode == 1


@pytest.mark.slow
@pytest.mark.parametrize("command", OF_PLAY)
def test_play_test_finds_what_is_named(command: str):
    """The tests themselves are run elsewhere; an update would write this checkout's references."""
    done = run(ROOT, ["pytest", "--collect-only", "-q", "-m", "", *shlex.split(command)[2:]])
    assert done.returncode == 0 and "::" in done.stdout, done.stdout

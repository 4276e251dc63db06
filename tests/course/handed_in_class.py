"""Make what a class hands in for exercises: right, nearly right, wrong, endless, hostile.

Run as a script it writes a class for a measurement by hand:

    python -m tests.course.handed_in_class FOLDER 100 diamond_square
"""

from __future__ import annotations

import re
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

from playground.course.handout import Assignment, assignments_of, student_files
from playground.course.read import read_lesson
from playground.course.tasks import answer_text, starter_text
from playground.sketch.save import written_value
from playground.sketch.toml_text import put

_KERNEL = re.compile(r"^(\w+) kernel\((ivec2|vec2) (\w+)\) \{", re.MULTILINE)


def around(text: str, body: str, before: str = "") -> str:
    """Return a kernel's text with another body, which may call the kernel as ``given()``."""
    match = _KERNEL.search(text)
    assert match, "a kernel of another form"
    kind, position, name = match.groups()
    inner = text.replace(match[0], f"{kind} inner_kernel({position} {name}) {{", 1)
    body = body.replace("given()", f"inner_kernel({name})")
    return f"{inner}\n{before}\n{kind} kernel({position} {name}) {{ {body} }}\n"


def right(assignment: Assignment) -> str:
    """Return the file of a student who has solved an exercise, as text of their own."""
    if assignment.task.file:
        return answer_text(assignment.task) + "\n// by myself\n"
    scene = assignment.task.scene
    assert scene is not None
    return with_values(assignment, {p: v for p, v in scene.values if p in assignment.task.sliders})


def with_values(assignment: Assignment, values: dict[str, object]) -> str:
    """Return the sketch of an exercise with values set in it."""
    text = student_files(assignment)[assignment.file].decode()
    names = re.findall(r'^name\s*=\s*"(\w+)"', text, re.MULTILINE)
    for path, value in values.items():
        owner, _, rest = path.partition(".")
        position = ("view", "set") if owner == "view" else ("pass", names.index(owner), "set")
        text = put(text, position, rest, written_value(assignment.task.begin.sketch, path, value, ""))
    return text


def untouched(assignment: Assignment) -> str:
    """Return the file as it was handed out."""
    return (
        starter_text(assignment.task)
        if assignment.task.file
        else student_files(assignment)[assignment.file].decode()
    )


def nearly(assignment: Assignment) -> str:
    """Return a kernel that is a little off everywhere; the hand-out where values are set."""
    return (
        around(answer_text(assignment.task), "return given() * 0.97;")
        if assignment.task.file
        else untouched(assignment)
    )


def wrong(assignment: Assignment) -> str:
    """Return a text that does not compile."""
    return (
        around(answer_text(assignment.task), "return given() + hieght;")
        if assignment.task.file
        else "set = {"
    )


def endless(assignment: Assignment) -> str:
    """Return a kernel that never ends, which no compiler can see."""
    # llvmpipe leaves a loop after 65 535 turns: two, one in the other, are endless for it too.
    inner = "for (;;) { k = (k * 5 + 1) & 255; if (k > 300) break; }"
    loop = f"int k = 0; for (;;) {{ {inner} if (k > 301) break; }} return given() + float(k) + 1.0;"
    return around(answer_text(assignment.task), loop) if assignment.task.file else untouched(assignment)


def hostile(assignment: Assignment, secret: Path) -> dict[str, str]:
    """Return texts that are made to do harm, by what they are."""
    if not assignment.task.file:
        text = untouched(assignment)
        return {
            "climbs": text + '\n[[pass]]\nname = "x"\nuse = "../../other/x"\n',
            "device": text + '\n[[preset]]\nname = "x"\nset = { "height.image" = "/dev/zero" }\n',
            "nested": "a = " + "[" * 5000 + "]" * 5000,
        }
    text = answer_text(assignment.task)
    macros = "".join(f"#define M{k}(x) M{k - 1}(x) + M{k - 1}(x) + M{k - 1}(x)\n" for k in range(1, 15))
    model = "../" * 8 + str(Path("playground/course/exercises").resolve() / assignment.task.answer).lstrip(
        "/"
    )
    return {
        "other": f'#include "{secret}"\n{text}',
        "model": f'#include "{model}"\n',
        "picture": around(
            text,
            "return given() + texelFetch(stolen, ivec2(0), 0).r;",
            f'uniform sampler2D stolen; //! file("{secret.with_suffix(".png")}")',
        ),
        "memory": around(text, f"float a[{2**28}]; a[int(given())] = 1.0; return a[int(given()) + 7];"),
        "macros": around(text, "return given() + M14(1.0);", f"#define M0(x) x + x + x\n{macros}"),
        "lines": "\n" * 300_000,
    }


def write(folder: Path, student: str, files: dict[str, str | bytes], *, zipped: bool = False) -> None:
    """Write what a student hands in: files by their names, in a folder or a zip."""
    if zipped:
        with zipfile.ZipFile(folder / f"{student}.zip", "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in files.items():
                archive.writestr(name, data)
        return
    for name, data in files.items():
        path = folder / student / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data if isinstance(data, bytes) else data.encode())


def write_class(folder: Path, count: int, assignments: Sequence[Assignment]) -> None:
    """Write a class as classes are: half of them right, some off, some wrong, a few endless, some missing."""
    kinds = [right, nearly, right, untouched, wrong, right, nearly, right, right, untouched]
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(count):
        files: dict[str, str | bytes] = {}
        for index, assignment in enumerate(assignments):
            make = endless if (number + index) % 33 == 32 else kinds[(number + 3 * index) % len(kinds)]
            mark = f"\n// student {number}\n" if assignment.task.file else f"\n# student {number}\n"
            files[f"week/{assignment.name}/{assignment.file}"] = (
                make(assignment) + mark
            )  # no two texts are the same
        write(folder, f"Student {number:03}", files, zipped=number % 2 == 1)


if __name__ == "__main__":
    chosen = assignments_of(read_lesson(name) for name in sys.argv[3:])[:3]
    print("\n".join(item.name for item in chosen))
    write_class(Path(sys.argv[1]), int(sys.argv[2]), chosen)

"""List the keys of a sketch's TOML and of a technique's, table by table, each with what it means.

What reads the tables takes the keys that it knows from here, and so does what completes and explains
them in an editor; `docs/reference/sketch-file.md` says more of each.
"""

from __future__ import annotations

SKETCH: dict[str, str] = {
    "format": "Version of the format: 1.",
    "title": "Title, a text; the file's name without it.",
    "pass": "A pass: one technique, its inputs and its values.",
    "base_elevation": "Metres above sea level at height 0; from the elevation file without it.",
    "extent": "Metres from the first texel to the last, a number or [east, north]; from the elevation file.",
    "keyframe": "Values and a camera at a time.",
    "main": 'Paths of the parameters that the sketch is about, as ["height.seed", "light.sun"].',
    "preset": "Values that go together, under a name.",
    "relief": "Metres from height 0 to height 1; from the elevation file without it.",
    "shot": "A picture that the sketch promises: a test compares it with its reference.",
    "size": "Texels of a pass that says no other, a number or [x, y]; from the elevation file without it.",
    "view": "The technique that gives the frame, and the camera.",
}
"""At the head of a sketch."""

TECHNIQUE: dict[str, str] = {
    "format": SKETCH["format"],
    "title": SKETCH["title"],
    "pass": SKETCH["pass"],
    "parameters": 'What may be set from outside: name → a path inside, or a list of them; "*" = "*" for all.',
    "inputs": "What is wired from outside: name → inputs of passes inside, a path or a list of them.",
    "outputs": 'What it gives: name → "pass:output"; without it what the last pass gives.',
}
"""At the head of a technique of several passes."""

VARIANT: dict[str, str] = {
    "agrees": "How closely a fast variant's outputs agree with the technique's.",
}
"""Besides these, at the head of a fast variant of several passes."""

PASS: dict[str, str] = {
    "name": "Letters, digits and _; not view.",
    "use": 'A technique: "generation/mixed", or "./x" of the sketch\'s own folder, without ending.',
    "inputs": 'Input → "pass", "pass:output" or "pass.inner:output".',
    "set": "Parameter → value.",
    "size": 'Texels, an expression or two, as "height.size // 2"; of the technique\'s own without it.',
    "repeat": "How often a technique of several passes runs, a number or an expression; needs feedback.",
    "feedback": "Input → its own output, which it reads from the second step on.",
    "when": "In a technique: the input, or a list of them, without which the pass is not there.",
}

VIEW: dict[str, str] = {
    "use": "The technique that gives the frame; view/terrain without it.",
    "inputs": PASS["inputs"],
    "set": PASS["set"],
    "camera": "Where the eye is: azimuth, elevation, distance, target, field_of_view.",
    "samples": "Antialiasing of draws: 1, 2, 4 or 8 samples a pixel; 4 without it.",
    "supersample": "Rendered pictures are drawn so many times as wide and high, 1 to 8; not in the window.",
    "above_ground": "An eye under the terrain is raised to just above it; false leaves it there.",
}

CAMERA: dict[str, str] = {
    "azimuth": "Degrees clockwise from north: direction from the target to the eye; 200 without it.",
    "elevation": "Degrees of the eye above the target's horizon, −89 to 89; 32 without it.",
    "distance": "Metres from the target; 0 shows the whole terrain.",
    "target": "What the eye looks at, [east, north, up] in metres; the middle without it.",
    "field_of_view": "Vertical, in degrees, 5 to 120; 35 without it.",
}

PRESET: dict[str, str] = {"name": "A name of its own.", "set": "Path of a parameter → value."}

SHOT: dict[str, str] = {
    "name": "Letters, digits, _ and -.",
    "size": "[width, height] in pixels; [640, 360] without it.",
    "time": "Seconds; 0 without it.",
    "camera": "A camera of its own; the view's without it.",
    "set": PRESET["set"],
    "preset": "A preset to begin with, by its name.",
    "samples": "Samples a pixel; the view's without it.",
    "supersample": VIEW["supersample"],
    "steps": "Repeated pass → the step to stop at.",
    "marks": 'Names of pytest\'s markers, as ["slow"].',
    "tolerance": 'What may differ: "rounding", "edges", "noise", levels, or { levels = 6, share = 0.01 }.',
    "reason": "Why the tolerance is needed; required with one.",
    "mask": "What is not compared: [x, y, width, height], a PNG or texture that is light there, or several.",
    "allow_blank": "Whether a picture of one colour may be right; false without it.",
}

KEYFRAME: dict[str, str] = {
    "time": "Seconds.",
    "camera": "A camera at that time.",
    "set": PRESET["set"],
    "ease": "How values go on to the next keyframe: smooth, linear or hold.",
}

TABLES: dict[str, dict[str, str]] = {
    "pass": PASS,
    "view": VIEW,
    "preset": PRESET,
    "shot": SHOT,
    "keyframe": KEYFRAME,
    "camera": CAMERA,
}
"""By the key that holds the table."""

LISTS = ("pass", "preset", "shot", "keyframe")
"""Tables of which there may be several: [[pass]]."""

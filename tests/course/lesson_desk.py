"""A lesson for tests, in two languages, and the panel of lessons under a mouse and keys, without a screen."""

from __future__ import annotations

from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.course import library
from playground.course.addition import Lessons
from playground.course.document import read_document
from playground.course.read import write_hashes
from playground.course.scenes import Sketches
from playground.course.window.reader import Reader
from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.studio.bench import Host
from playground.studio.edits.autosave import Autosave, memory_of
from playground.studio.keyframes.panel import height_of_timeline

from ..sketch_texts import map_of_height
from ..studio.panel_desk import Bare

FILE = (GLSL / "generation/diamond_square/raw.glsl").resolve()
"""The shader that the lesson quotes and breaks."""
OWN = "format = 1\nsize = 17\n" + map_of_height("generation/white_noise")
"""The reader's own sketch."""
SHIPPED = Sketches()
"""The shipped sketches that lessons show; no test changes them, so each is loaded once."""
ENGLISH = r"""+++
title   = "Halving"
goal    = "Know what a mean of *four* gives."
thesis  = ["1.3.2"]
papers  = []
sketch  = "white_noise"
+++

Four corners, then means: $h = \frac{a+b+c+d}{4}$.

```figure rubble
sketch  = "white_noise"
set     = { "height.seed" = 3 }
caption = "Numbers without a neighbour."
alt     = "Rubble"
sliders = ["height.seed"]
```

## Step by step

Each step halves. There are {{peaks}} peaks.

```step halves
sketch   = "diamond_square_steps"
passes   = ["height.raw", "phase"]
iterations    = [0, 1, 2, 4]
caption  = "Known texels."
alt      = "A grid that fills"
captions = ["corners", "one centre", "edges", "all"]
```

```measure peaks
sketch = "white_noise"
set    = { size = 33 }
what   = "local_maxima"
text   = "Of this terrain {{peaks}} texels are peaks."
```

## One value

```slider rough
sketch    = "diamond_square_steps"
parameter = "height.smoothing"
values    = [0.0, 0.5, 1.0]
caption   = "Roughness."
alt       = "Terrains that get rougher"
```

```compare seeds
sketch  = "white_noise"
caption = "Two terrains."
alt     = "Two terrains of rubble"
labels  = ["first", "second"]
[[variant]]
set = { "height.seed" = 1 }
[[variant]]
set = { "height.seed" = 2 }
```

```trace centre
sketch    = "diamond_square_steps"
pass      = "height.raw"
texel     = [2, 2]
iteration = 1
file      = "generation/diamond_square/raw.glsl"
anchor    = "height"
loop      = "i"
variables = ["total"]
rows      = [0, 3]
caption   = "The first centre."
```

```question corners
trace    = "centre"
variable = "total"
step     = 3
ask      = "What is the sum of 0.2, 0.9, 0.6 and 0.4?"
answer   = "Their sum."
```

## A bug

```code mean
file   = "generation/diamond_square/raw.glsl"
anchor = "height"
```

```break quarter
sketch = "diamond_square_steps"
file   = "generation/diamond_square/raw.glsl"
find   = "total / count"
put    = "total / (count > 3.0 ? 4.0 : 9.0)"
ask    = "Its border sinks. Why?"
hint   = "How many are summed?"
fix    = "A mean divides by their count."
alt    = "Heights that shrink"
```

## Exercises

```question which
ask     = "What is the mean of 1 and 3?"
choices = ["2", "4"]
right   = 0
answer  = "Half of their sum."
```

```exercise guess
ask      = "Guess."
hint     = "Look."
solution = "So it is: see [the first](lesson:halving)."
sketch   = "white_noise"
set      = { "height.seed" = 9 }
alt      = "Other rubble"
```

```exercise try
ask      = "Try."
solution = "Done."
sketch   = "white_noise"
view     = "height"
alt      = "Greys"
pixels   = [480, 480]
```

```exercise change
ask      = "Change."
solution = "Changed."
```
"""
OTHER = """+++
title   = "After it"
goal    = "Nothing more."
thesis  = []
papers  = []
sketch  = "white_noise"
+++

The end.
"""
FRENCH = r"""+++
title = "Moitiés"
goal  = "Savoir ce que donne une moyenne de *quatre*."
+++

Quatre coins, puis des moyennes : $h = \frac{a+b+c+d}{4}$.

```figure rubble
caption = "Des nombres sans voisin."
alt     = "Des gravats"
```

## Étape par étape

Chaque étape divise. Il y a {{peaks}} sommets.

```step halves
caption  = "Texels connus."
alt      = "Une grille qui se remplit"
captions = ["coins", "un centre", "arêtes", "tous"]
```

```measure peaks
text = "Ici {{peaks}} texels sont des sommets."
```

## Une valeur

```slider rough
caption = "Rugosité."
alt     = "Des terrains plus rugueux"
```

```compare seeds
caption = "Deux terrains."
alt     = "Deux terrains de gravats"
labels  = ["premier", "second"]
```

```trace centre
caption = "Le premier centre."
```

```question corners
ask    = "Quelle est la somme de 0,2, 0,9, 0,6 et 0,4 ?"
answer = "Leur somme."
```

## Une faute

```code mean
```

```break quarter
ask  = "Cela monte. Pourquoi ?"
hint = "Combien en additionne-t-on ?"
fix = "Une moyenne divise par leur nombre."
alt  = "Des hauteurs qui croissent"
```

## Exercices

```question which
ask     = "Quelle est la moyenne de 1 et 3 ?"
choices = ["2", "4"]
answer  = "La moitié de leur somme."
```

```exercise guess
ask      = "Devinez."
hint     = "Regardez."
solution = "C'est ainsi."
alt      = "D'autres gravats"
```

```exercise try
ask      = "Essayez."
solution = "Fait."
alt      = "Des gris"
```

```exercise change
ask      = "Changez."
solution = "Changé."
```
"""


COURSE = """
[[part]]
title   = { en = "All", fr = "Tout" }
lessons = ["halving", "after"]
"""


def write_lessons(folder: Path) -> Path:
    """Write the lessons into a folder, as the library has them; return it."""
    for language in ("en", "fr"):
        (folder / language).mkdir(parents=True, exist_ok=True)
    (folder / "en" / "halving.md").write_text(ENGLISH, encoding="utf-8")
    (folder / "en" / "after.md").write_text(OTHER, encoding="utf-8")
    (folder / "fr" / "halving.md").write_text(FRENCH, encoding="utf-8")
    write_hashes(read_document(folder / "en" / "halving.md"), read_document(folder / "fr" / "halving.md"))
    (folder.parent / "course.toml").write_text(COURSE, encoding="utf-8")
    return folder


def shelved(monkeypatch: pytest.MonkeyPatch, folder: Path) -> None:
    """Have the library hold the lessons of this file, and a state folder of their own."""
    monkeypatch.setattr(library, "TEXTS", write_lessons(folder / "texts"))
    monkeypatch.setenv("XDG_STATE_HOME", str(folder / "state"))
    monkeypatch.setattr("sys.platform", "linux")
    for variable in ("LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(variable, raising=False)


class Harness(Bare):
    """A panel of lessons next to a sketch, frame by frame."""

    lessons: Lessons | None = None

    def __init__(self, engine: Engine, path: Path, size: tuple[int, int] = (1280, 720)) -> None:
        super().__init__(engine, path, size)
        for name in ("small_button", "radio_button"):
            self.watch(imgui, name)
        self.autosave = Autosave(self.session, memory_of(self.session.path))
        host = Host(
            self.bench, self.autosave, lambda: self.autosave.look(size), lambda: None, lambda: self.theme
        )
        self.lessons = Lessons(host)
        self.bench.additions = [self.lessons]
        self.reader.catalogue.sketches = SHIPPED
        self.bench.interface.panel_shown = True

    @property
    def reader(self) -> Reader:
        assert self.lessons is not None
        return self.lessons.reader

    def open(self, page: int = 0, **rest: object) -> None:
        """Open the lesson at a page, and wait until it shows."""
        assert self.reader.open("halving", page=page, **rest)  # type: ignore[arg-type]
        self.run_frames(4)

    def draw(self) -> None:
        if self.lessons is None:
            super().draw()
            return
        self.bench.inspection.begin()
        left = self.lessons.draw_panel()
        left += self.panel.draw(self.bench, self.theme, left) if self.bench.interface.panel_shown else 0.0
        room = imgui.get_io().display_size
        area = left, 0.0, max(room.x - left, 1.0), room.y
        self.draw_pane(area)
        assert height_of_timeline(self.session, self.bench.interface, self.theme) >= 0
        if self.picture is not None:
            self.bench.inspection.compare.follow(self.picture)
        self.lessons.update(idle=True)

    def close(self) -> None:
        if self.lessons is not None:
            self.lessons.release()
        self.autosave.close()
        super().close()


def value(harness: Harness, path: str) -> object:
    """Return a parameter's value in the sketch that is shown."""
    assert harness.session.shown is not None
    return dict(harness.session.shown.applied)[path]

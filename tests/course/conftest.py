"""What tests of lessons share: a small lesson, written where the test can change it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from playground.course.document import read_document
from playground.course.model import Lesson
from playground.course.read import read_file, translated, write_hashes
from playground.course.scenes import Sketches
from playground.engine.engine import Engine

from ..publish.web.conftest import node as node
from ..studio.conftest import screen as screen
from .lesson_desk import OWN, Harness, shelved

FRONT = """+++
title   = "A small lesson"
goal    = "Know $r^2$."
thesis  = ["1.3.2"]
papers  = ["Somebody 1982, https://doi.org/10.1145/358523.358553"]
sketch  = "diamond_square_steps"
+++
"""

BODY = """
A picture first.

```figure land
sketch  = "diamond_square_steps"
shot    = "figure-1-11"
caption = "Five by five, with *all* of it known."
alt     = "A lattice of discs."
sliders = ["height.smoothing"]
```

## One thing

The spread is {{spread}}, see [the last](lesson:small). Each disc is a [texel](term:texel).

```step turns
sketch  = "diamond_square_steps"
passes  = ["height.raw", "phase"]
pixels  = [96, 96]
caption = "Turn by turn."
alt     = "Rings fill the lattice."
```

```slider smooth
sketch    = "diamond_square_steps"
parameter = "height.smoothing"
from      = 0.1
to        = 0.9
frames    = 3
pixels    = [96, 96]
caption   = "Smoother, rougher."
alt       = "The greys grow apart."
label     = "Smoothing"
```

```compare two
sketch  = "diamond_square_steps"
pixels  = [96, 96]
caption = "Two lands."
alt     = "The left is even."
labels  = ["even", "uneven"]
[[variant]]
set = { "height.smoothing" = 0.0 }
[[variant]]
set = { "height.smoothing" = 0.9 }
```

```code mean
file    = "generation/white_noise.glsl"
anchor  = "kernel"
caption = "All of it."
```

```trace height
sketch    = "diamond_square_steps"
pass      = "height.raw"
texel     = [2, 2]
iteration = 1
file      = "generation/diamond_square/raw.glsl"
anchor    = "height"
loop      = "i"
variables = ["total", "count"]
rows      = [0, 1, 2, 3]
caption   = "The centre, from the corners."
```

```question corners
trace    = "height"
variable = "total"
step     = 3
points   = 2
ask      = "The {{height:count:3}} corners: 0.2, 0.9, 0.6, 0.4. What is `total` at step 3?"
answer   = "Their sum."
```

```break fault
sketch = "diamond_square_steps"
pixels = [96, 96]
file   = "generation/diamond_square/raw.glsl"
find   = "total / count"
put    = "total / 8.0"
ask    = "Why is it dark?"
hint   = "Count the neighbours."
fix    = "Four of them."
alt    = "Dark discs."
```

```measure spread
sketch  = "diamond_square_steps"
what    = "spread"
digits  = 2
between = [0.1, 2.0]
text    = "From lowest to highest: {{spread}}."
```

```question count
ask     = "How many points has it?"
choices = ["25", "16"]
right   = 0
answer  = "Five times five."
```

## Exercises

```exercise first
ask      = "Predict."
solution = "So."
```

```exercise second
ask      = "Try."
hint     = "Drag."
solution = "So."
sketch   = "diamond_square_steps"
pixels   = [96, 96]
alt      = "The same."
```

```exercise third
ask      = "Change."
solution = "So."
```
"""

FRENCH = """+++
title = "Une petite leçon"
goal  = "Connaître $r^2$."
+++

Une image d’abord.

```figure land
caption = "Cinq sur cinq, tout est connu."
alt     = "Un treillis de disques."
```

## Une chose

L’écart est de {{spread}}, voir [la dernière](lesson:small). Chaque disque est un [texel](term:texel).

```step turns
caption = "Tour par tour."
alt     = "Des anneaux remplissent le treillis."
```

```slider smooth
caption = "Plus lisse, plus rude."
alt     = "Les gris s’éloignent."
label   = "Lissage"
```

```compare two
caption = "Deux terrains."
alt     = "Celui de gauche est uni."
labels  = ["uni", "inégal"]
```

```code mean
caption = "En entier."
```

```trace height
caption = "Le centre, depuis les coins."
```

```question corners
ask    = "Les {{height:count:3}} coins : 0,2, 0,9, 0,6, 0,4. Combien vaut `total` au pas 3 ?"
answer = "Leur somme."
```

```break fault
ask  = "Pourquoi est-ce sombre ?"
hint = "Comptez les voisins."
fix  = "Ils sont quatre."
alt  = "Des disques sombres."
```

```measure spread
text = "Du plus bas au plus haut : {{spread}}."
```

```question count
ask     = "Combien de points ?"
choices = ["25", "16"]
answer  = "Cinq fois cinq."
```

## Exercices

```exercise first
ask      = "Prédisez."
solution = "Ainsi."
```

```exercise second
ask      = "Essayez."
hint     = "Glissez."
solution = "Ainsi."
alt      = "La même."
```

```exercise third
ask      = "Changez."
solution = "Ainsi."
```
"""

SKETCHES = Sketches()


@pytest.fixture
def engine(any_engine: Engine) -> Engine:
    """Give one engine: what lessons say does not depend on the driver, which others see to."""
    return any_engine


@pytest.fixture
def write_lesson(tmp_path: Path) -> Callable[..., Path]:
    """Write the small lesson, with some of its text replaced, and return its file."""

    def write(*changes: tuple[str, str], name: str = "small.md") -> Path:
        text = FRONT + BODY
        for before, after in changes:
            assert before in text
            text = text.replace(before, after)
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture
def make_lesson(write_lesson: Callable[..., Path]) -> Callable[..., Lesson]:
    """Read the small lesson, with some of its text replaced."""
    return lambda *changes: read_file(write_lesson(*changes), SKETCHES)


@pytest.fixture
def lesson(make_lesson: Callable[..., Lesson]) -> Lesson:
    """Give the small lesson."""
    return make_lesson()


def both_languages(english: Path, french: Path) -> dict[str, list[Lesson]]:
    """Return the lesson of a file and its translation in another, as a book has them."""
    document = read_document(english)
    write_hashes(document, read_document(french))
    lesson = read_file(english, SKETCHES)
    return {"en": [lesson], "fr": [translated(lesson, document, read_document(french), "fr")]}


@pytest.fixture
def french(write_lesson: Callable[..., Path], tmp_path: Path) -> Lesson:
    """Give the small lesson in French."""
    path = tmp_path / "petit.md"
    path.write_text(FRENCH, encoding="utf-8")
    return both_languages(write_lesson(), path)["fr"][0]


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Iterator[Harness]:
    """Give a panel of lessons on the reader's own sketch."""
    shelved(monkeypatch, tmp_path)
    own = tmp_path / "own"
    own.mkdir()
    (own / "sketch.toml").write_text(OWN, encoding="utf-8")
    made = Harness(any_engine, own)
    yield made
    made.close()

"""Export a notebook as one HTML file with live figures, which asks nothing of a network.

    jupyter nbconvert --to terrain_html lesson.ipynb

JupyterLab has it as well: File, Save and Export Notebook As. What ``--to html`` writes of a notebook with
saved widgets loads Jupyter's widget scripts from a network, and shows no picture without them. Here figures
are live by themselves, with the values they had when the notebook was saved; the runtime is there once, and
formulas are MathML. Cells whose outputs need a network keep it, and are named in a warning; of the text, only
formulas are looked at: one that has no MathML here stays LaTeX, and is named in a warning too.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from jinja2 import DictLoader, pass_context
from latex2mathml.converter import convert
from nbconvert.exporters import HTMLExporter
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from nbconvert.preprocessors import Preprocessor

from playground.publish.notebook.saved import (
    runtime_of,
    runtimes_in,
    saved_figure,
    without_runtime,
)

_VIEW = "application/vnd.jupyter.widget-view+json"
_STATES = "application/vnd.jupyter.widget-state+json"
_FIGURES = (
    "notebook.widget.PictureWidget",
    "notebook.sketch_widget.SketchWidget",
    "notebook.sketch_widget.CompareWidget",
)
_SCRIPTED = ("application/javascript", "text/latex", "text/vnd.mermaid")  # by scripts from a network
_TEMPLATE = """{%- extends 'index.html.j2' -%}
{%- block html_head_js_requirejs -%}
{%- if resources.needs_network -%}{{ super() }}{%- endif -%}
{%- endblock html_head_js_requirejs -%}
{%- block html_head_js_mathjax -%}
{%- if resources.needs_network -%}{{ super() }}{%- endif -%}
{%- endblock html_head_js_mathjax -%}
"""


class LiveFigures(Preprocessor):  # type: ignore[misc]
    """Puts live figures in the place of their widgets, and takes the widgets' state away."""

    def preprocess(self, nb: Any, resources: Any) -> tuple[Any, Any]:
        """Change a notebook and say in the resources whether it still needs a network."""
        saved = nb.metadata.get("widgets", {}).get(_STATES, {}).get("state", {})
        held: set[str] = set()
        for number, output in _outputs(nb):
            data = output["data"]
            model = data.get(_VIEW, {}).get("model_id")
            if _is_figure(saved.get(model, {})):
                self.show(data, saved[model], number)
            elif "data-terrain-saved" in _text(data.get("text/html", "")):
                data.pop(_VIEW, None)
            if "text/html" in data:
                html = _text(data["text/html"])
                data["text/html"] = without_runtime(html, held)
                held |= runtimes_in(html)
        others = {model: model_state for model, model_state in saved.items() if not _is_figure(model_state)}
        if not any(map(_shown, others.values())):
            nb.metadata.pop("widgets", None)
        else:
            models_text = json.dumps(others)  # a figure in another widget is shown by that
            for model in saved.keys() - others.keys():
                if f'"IPY_MODEL_{model}"' not in models_text:
                    del saved[model]
        left = [number for number, output in _outputs(nb) if {_VIEW, *_SCRIPTED} & output["data"].keys()]
        if left:
            cells = ", ".join(map(str, dict.fromkeys(left)))
            self.log.warning(f"the outputs of cells {cells} are shown by scripts that a network gives")
        return nb, {**resources, "needs_network": bool(left)}

    def show(self, data: Any, model: Mapping[str, Any], number: int) -> None:
        """Put a figure as it was saved into the data of an output."""
        data.pop(_VIEW)
        state = model["state"]
        pictures = [buffer["data"] for buffer in model.get("buffers", []) if buffer["path"] == ["picture"]]
        try:
            png = base64.b64decode((pictures or [_text(data["image/png"])])[0])
            runtime = runtime_of(state["_esm"], state["_css"])
            data["image/png"] = base64.b64encode(png).decode()
            if state["page"]:
                data["text/html"] = str(saved_figure(state, png, runtime))
        except (KeyError, ValueError, OSError) as error:
            reason = f"it has no {error}" if isinstance(error, KeyError) else str(error)
            self.log.warning(f"cell {number}: the saved figure is damaged: {reason}; run the cell again")


class TerrainHTMLExporter(HTMLExporter):  # type: ignore[misc]
    """A notebook as HTML whose figures are live without a network."""

    export_from_notebook = "HTML with live terrain figures"

    def __init__(self, *args: Any, **options: Any) -> None:
        loader = DictLoader({"terrain.html.j2": _TEMPLATE})
        super().__init__(*args, **{"extra_loaders": [loader], "template_file": "terrain.html.j2", **options})
        self.register_preprocessor(LiveFigures(parent=self), enabled=True)

    @pass_context
    def markdown2html(self, context: Any, source: str) -> str:
        """Return Markdown as HTML, its formulas as MathML."""
        renderer = _MathML(
            escape=False,
            attachments=context.get("cell", {}).get("attachments", {}),
            embed_images=self.embed_images,
            path=context.get("resources", {}).get("metadata", {}).get("path", ""),
            anchor_link_text=self.anchor_link_text,
            exclude_anchor_links=self.exclude_anchor_links,
            **self.lexer_options,
        )
        renderer.warn = self.log.warning
        return str(MarkdownWithMath(renderer=renderer).render(source))


class _MathML(IPythonRenderer):  # type: ignore[misc]
    warn: Callable[[str], None]

    def block_math(self, body: str) -> str:
        return self.formula(body, "block") or str(super().block_math(body))

    def inline_math(self, body: str) -> str:
        return self.formula(body, "inline") or str(super().inline_math(body))

    def latex_environment(self, name: str, body: str) -> str:
        whole = f"\\begin{{{name}}}{body}\\end{{{name}}}"
        return self.formula(whole, "block") or str(super().latex_environment(name, body))

    def formula(self, latex: str, display: str) -> str:
        """Return a formula as MathML; "" and a warning for one that cannot be."""
        made = _formula(latex, display)
        if not made:
            self.warn(f"the formula {' '.join(latex.split())} stays LaTeX: it has no MathML here")
        return made


def _formula(latex: str, display: str) -> str:
    """Return a formula as MathML; "" for one that cannot be: its LaTeX is shown."""
    try:
        made = convert(latex, display=display)
    except Exception:  # its errors have no class in common
        return ""
    return "" if "\\" in made else made  # a command that it does not know stays as it is


def _outputs(nb: Any) -> Iterator[tuple[int, Any]]:
    """Yield all outputs that have data, each with its cell's number, from 1."""
    for number, cell in enumerate(nb.cells, start=1):
        for output in cell.get("outputs", []):
            if "data" in output:
                yield number, output


def _is_figure(model: Mapping[str, Any]) -> bool:
    """Whether a saved widget is a figure: of a lesson, or of sketches."""
    return str(model.get("state", {}).get("_anywidget_id", "")).endswith(_FIGURES)


def _shown(model: Mapping[str, Any]) -> bool:
    """Whether a saved widget is something to see: a layout and a style are not."""
    return not str(model.get("model_name", "")).endswith(("LayoutModel", "StyleModel"))


def _text(text: str | list[str]) -> str:
    """Return a text that a notebook may hold as lines."""
    return text if isinstance(text, str) else "".join(text)

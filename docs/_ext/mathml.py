"""Formulas as MathML, which browsers show without scripts, fonts or network."""

import re
from collections.abc import Iterator
from html import escape

from docutils import nodes
from latex2mathml.commands import CONVERSION_MAP
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

logger = logging.getLogger(__name__)

COMMAND = re.compile(r"\\[A-Za-z]+")
ENVIRONMENT = re.compile(r"\\begin\{([a-z]+\*?)\}")
SUBSTITUTES = {"{aligned}": "{split}", "{align}": "{align*}"}
"""Environments that the converter does not know, or numbers beside Sphinx, and what to use."""


def normalised(latex: str) -> str:
    """Write a formula with environments that the converter knows."""
    for environment, substitute in SUBSTITUTES.items():
        latex = latex.replace(environment, substitute)
    if r"\\" in latex and r"\begin" not in latex:
        return rf"\begin{{split}}{latex}\end{{split}}"
    return latex


def unknown(latex: str, result: str) -> Iterator[str]:
    """Commands and environments that the converter passed over without an error."""
    yield from COMMAND.findall(result)
    for environment in ENVIRONMENT.findall(latex):
        if rf"\{environment}" not in CONVERSION_MAP:
            yield environment


def mathml(node: nodes.Node, display: str) -> str:
    """Convert a formula, with a warning where it holds what the converter does not know."""
    latex = normalised(node.astext())
    try:
        result = convert(latex, display=display)
    except Exception as error:
        logger.warning("formula %r: %r", latex, error, location=node, type="mathml")
        return f"<code>{escape(latex)}</code>"
    for name in unknown(latex, result):
        logger.warning("formula %r: unknown %s", latex, name, location=node, type="mathml")
    return result


def visit_inline(self: HTML5Translator, node: nodes.math) -> None:
    self.body.append(mathml(node, "inline"))
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.math_block) -> None:
    self.body.append(self.starttag(node, "div", CLASS="math"))
    if node["number"]:
        self.body.append(f'<span class="eqno">({escape(str(node["number"]))})')
        self.add_permalink_ref(node, "Link to this equation")
        self.body.append("</span>")
    self.body.append(mathml(node, "block"))
    self.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}

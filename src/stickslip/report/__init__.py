"""Reports: self-contained HTML pages, and verdicts as such a page, a JSON document and a rig."""

from stickslip.report.core.animations import Animation
from stickslip.report.core.blocks import (
    Block,
    Caption,
    Code,
    Columns,
    Fact,
    Facts,
    Figure,
    Gallery,
    KeyValue,
    KeyValues,
    Math,
    Note,
    Panel,
    Paragraph,
    Reference,
    References,
    Subheading,
)
from stickslip.report.core.documents import LawLine, Opening, Page, Section
from stickslip.report.core.markup import inline, mathml, symbol, symbol_text
from stickslip.report.core.page import render, write
from stickslip.report.core.sparklines import Axis, Mark, RowPlot
from stickslip.report.core.tables import Blank, Cell, Column, Correlations, Name, Number, Row, Table

__all__ = [
    "Animation",
    "Axis",
    "Blank",
    "Block",
    "Caption",
    "Cell",
    "Code",
    "Column",
    "Columns",
    "Correlations",
    "Fact",
    "Facts",
    "Figure",
    "Gallery",
    "KeyValue",
    "KeyValues",
    "LawLine",
    "Mark",
    "Math",
    "Name",
    "Note",
    "Number",
    "Opening",
    "Page",
    "Panel",
    "Paragraph",
    "Reference",
    "References",
    "Row",
    "RowPlot",
    "Section",
    "Subheading",
    "Table",
    "inline",
    "mathml",
    "render",
    "symbol",
    "symbol_text",
    "write",
]

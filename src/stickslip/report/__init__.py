"""Reports: self-contained HTML pages, and verdicts as such a page, a JSON document and a rig."""

from stickslip.report.animations import Animation
from stickslip.report.blocks import (
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
from stickslip.report.documents import LawLine, Opening, Page, Section
from stickslip.report.markup import inline, mathml, symbol, symbol_text
from stickslip.report.page import render, write
from stickslip.report.rowplots import Axis, Mark, RowPlot
from stickslip.report.tables import Blank, Cell, Column, Correlations, Name, Number, Row, Table
from stickslip.report.verdicts import write_report

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
    "write_report",
]

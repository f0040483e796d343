# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.show.report.blocks import Animation as Animation
from stickslip.show.report.blocks import Block as Block
from stickslip.show.report.blocks import Caption as Caption
from stickslip.show.report.blocks import Code as Code
from stickslip.show.report.blocks import Columns as Columns
from stickslip.show.report.blocks import Fact as Fact
from stickslip.show.report.blocks import Facts as Facts
from stickslip.show.report.blocks import Figure as Figure
from stickslip.show.report.blocks import Gallery as Gallery
from stickslip.show.report.blocks import KeyValue as KeyValue
from stickslip.show.report.blocks import KeyValues as KeyValues
from stickslip.show.report.blocks import MOST as MOST
from stickslip.show.report.blocks import Math as Math
from stickslip.show.report.blocks import Note as Note
from stickslip.show.report.blocks import Opening as Opening
from stickslip.show.report.blocks import Origin as Origin
from stickslip.show.report.blocks import Page as Page
from stickslip.show.report.blocks import Panel as Panel
from stickslip.show.report.blocks import Paragraph as Paragraph
from stickslip.show.report.blocks import Reference as Reference
from stickslip.show.report.blocks import References as References
from stickslip.show.report.blocks import Section as Section
from stickslip.show.report.blocks import SectionMaker as SectionMaker
from stickslip.show.report.blocks import Subheading as Subheading
from stickslip.show.report.blocks import colophon as colophon
from stickslip.show.report.blocks import made_sections as made_sections
from stickslip.show.report.blocks import render as render
from stickslip.show.report.blocks import versions as versions
from stickslip.show.report.blocks import write as write
from stickslip.show.report.markup import formula_text as formula_text
from stickslip.show.report.markup import inline as inline
from stickslip.show.report.markup import mathml as mathml
from stickslip.show.report.markup import plain as plain
from stickslip.show.report.markup import published_dict as published_dict
from stickslip.show.report.markup import symbol as symbol
from stickslip.show.report.markup import symbol_text as symbol_text
from stickslip.show.report.runs import RunReport as RunReport
from stickslip.show.report.runs import run_page as run_page
from stickslip.show.report.runs import run_sections as run_sections
from stickslip.show.report.shared_sections import figure as figure
from stickslip.show.report.shared_sections import opening as opening
from stickslip.show.report.shared_sections import record_and_checks as record_and_checks
from stickslip.show.report.shared_sections import reproduce as reproduce
from stickslip.show.report.tables import Axis as Axis
from stickslip.show.report.tables import Cell as Cell
from stickslip.show.report.tables import Column as Column
from stickslip.show.report.tables import Mark as Mark
from stickslip.show.report.tables import Name as Name
from stickslip.show.report.tables import Number as Number
from stickslip.show.report.tables import Row as Row
from stickslip.show.report.tables import RowPlot as RowPlot
from stickslip.show.report.tables import Table as Table
from stickslip.show.report.tables import table_of as table_of

__all__ = [
    "Animation",
    "Axis",
    "Block",
    "Caption",
    "Cell",
    "Code",
    "Column",
    "Columns",
    "Fact",
    "Facts",
    "Figure",
    "Gallery",
    "KeyValue",
    "KeyValues",
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

# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.report.core import documents as documents
from stickslip.report.core.blocks import Animation as Animation
from stickslip.report.core.blocks import Block as Block
from stickslip.report.core.blocks import Caption as Caption
from stickslip.report.core.blocks import Code as Code
from stickslip.report.core.blocks import Columns as Columns
from stickslip.report.core.blocks import Fact as Fact
from stickslip.report.core.blocks import Facts as Facts
from stickslip.report.core.blocks import Figure as Figure
from stickslip.report.core.blocks import Gallery as Gallery
from stickslip.report.core.blocks import KeyValue as KeyValue
from stickslip.report.core.blocks import KeyValues as KeyValues
from stickslip.report.core.blocks import MOST as MOST
from stickslip.report.core.blocks import Math as Math
from stickslip.report.core.blocks import Note as Note
from stickslip.report.core.blocks import Panel as Panel
from stickslip.report.core.blocks import Paragraph as Paragraph
from stickslip.report.core.blocks import Reference as Reference
from stickslip.report.core.blocks import References as References
from stickslip.report.core.blocks import Subheading as Subheading
from stickslip.report.core.documents import LawLine as LawLine
from stickslip.report.core.documents import Opening as Opening
from stickslip.report.core.documents import Origin as Origin
from stickslip.report.core.documents import Page as Page
from stickslip.report.core.documents import PageSections as PageSections
from stickslip.report.core.documents import Section as Section
from stickslip.report.core.documents import SectionMaker as SectionMaker
from stickslip.report.core.documents import colophon as colophon
from stickslip.report.core.documents import made_sections as made_sections
from stickslip.report.core.documents import versions as versions
from stickslip.report.core.formulas import formula_text as formula_text
from stickslip.report.core.formulas import published_dict as published_dict
from stickslip.report.core.markup import inline as inline
from stickslip.report.core.markup import label_of as label_of
from stickslip.report.core.markup import mathml as mathml
from stickslip.report.core.markup import plain as plain
from stickslip.report.core.markup import symbol as symbol
from stickslip.report.core.markup import symbol_text as symbol_text
from stickslip.report.core.markup import typeset as typeset
from stickslip.report.core.page import render as render
from stickslip.report.core.page import write as write
from stickslip.report.core.shared_sections import candidates_heading as candidates_heading
from stickslip.report.core.shared_sections import identified_heading as identified_heading
from stickslip.report.core.shared_sections import law_references as law_references
from stickslip.report.core.shared_sections import opening as opening
from stickslip.report.core.shared_sections import parameters as parameters
from stickslip.report.core.shared_sections import record_and_checks as record_and_checks
from stickslip.report.core.shared_sections import reproduce as reproduce
from stickslip.report.core.sparklines import Axis as Axis
from stickslip.report.core.sparklines import Colour as Colour
from stickslip.report.core.sparklines import Mark as Mark
from stickslip.report.core.sparklines import RowPlot as RowPlot
from stickslip.report.core.sparklines import error_axis as error_axis
from stickslip.report.core.sparklines import error_plot as error_plot
from stickslip.report.core.tables import Blank as Blank
from stickslip.report.core.tables import Cell as Cell
from stickslip.report.core.tables import Column as Column
from stickslip.report.core.tables import Correlations as Correlations
from stickslip.report.core.tables import Name as Name
from stickslip.report.core.tables import Number as Number
from stickslip.report.core.tables import Row as Row
from stickslip.report.core.tables import Table as Table
from stickslip.report.laws import characterization_page as characterization_page
from stickslip.report.runs import ContactsReport as ContactsReport
from stickslip.report.runs import RunReport as RunReport
from stickslip.report.runs import contacts_page as contacts_page
from stickslip.report.runs import run_page as run_page

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

# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.report.blocks import Animation as Animation
from stickslip.report.blocks import Block as Block
from stickslip.report.blocks import Caption as Caption
from stickslip.report.blocks import Code as Code
from stickslip.report.blocks import Columns as Columns
from stickslip.report.blocks import Fact as Fact
from stickslip.report.blocks import Facts as Facts
from stickslip.report.blocks import Figure as Figure
from stickslip.report.blocks import Gallery as Gallery
from stickslip.report.blocks import KeyValue as KeyValue
from stickslip.report.blocks import KeyValues as KeyValues
from stickslip.report.blocks import LawLine as LawLine
from stickslip.report.blocks import MOST as MOST
from stickslip.report.blocks import Math as Math
from stickslip.report.blocks import Note as Note
from stickslip.report.blocks import Opening as Opening
from stickslip.report.blocks import Origin as Origin
from stickslip.report.blocks import Page as Page
from stickslip.report.blocks import PageSections as PageSections
from stickslip.report.blocks import Panel as Panel
from stickslip.report.blocks import Paragraph as Paragraph
from stickslip.report.blocks import Reference as Reference
from stickslip.report.blocks import References as References
from stickslip.report.blocks import Section as Section
from stickslip.report.blocks import SectionMaker as SectionMaker
from stickslip.report.blocks import Subheading as Subheading
from stickslip.report.blocks import colophon as colophon
from stickslip.report.blocks import made_sections as made_sections
from stickslip.report.blocks import render as render
from stickslip.report.blocks import versions as versions
from stickslip.report.blocks import write as write
from stickslip.report.contacts import ContactsReport as ContactsReport
from stickslip.report.contacts import contacts_page as contacts_page
from stickslip.report.laws import characterization_page as characterization_page
from stickslip.report.markup import formula_text as formula_text
from stickslip.report.markup import inline as inline
from stickslip.report.markup import label_of as label_of
from stickslip.report.markup import mathml as mathml
from stickslip.report.markup import plain as plain
from stickslip.report.markup import published_dict as published_dict
from stickslip.report.markup import symbol as symbol
from stickslip.report.markup import symbol_text as symbol_text
from stickslip.report.markup import typeset as typeset
from stickslip.report.runs import RunReport as RunReport
from stickslip.report.runs import run_page as run_page
from stickslip.report.shared_sections import candidates_heading as candidates_heading
from stickslip.report.shared_sections import identified_heading as identified_heading
from stickslip.report.shared_sections import law_references as law_references
from stickslip.report.shared_sections import opening as opening
from stickslip.report.shared_sections import parameters as parameters
from stickslip.report.shared_sections import record_and_checks as record_and_checks
from stickslip.report.shared_sections import reproduce as reproduce
from stickslip.report.tables import Axis as Axis
from stickslip.report.tables import Blank as Blank
from stickslip.report.tables import Cell as Cell
from stickslip.report.tables import Colour as Colour
from stickslip.report.tables import Column as Column
from stickslip.report.tables import Correlations as Correlations
from stickslip.report.tables import Mark as Mark
from stickslip.report.tables import Name as Name
from stickslip.report.tables import Number as Number
from stickslip.report.tables import Row as Row
from stickslip.report.tables import RowPlot as RowPlot
from stickslip.report.tables import Table as Table
from stickslip.report.tables import error_axis as error_axis
from stickslip.report.tables import error_plot as error_plot

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

"""Reports: self-contained HTML pages, and the sections of which they are made."""

from stickslip.lazy import attach

HOMES = {
    "Animation": "core.animations",
    "Axis": "core.sparklines",
    "Blank": "core.tables",
    "Block": "core.blocks",
    "Caption": "core.blocks",
    "Cell": "core.tables",
    "Code": "core.blocks",
    "Column": "core.tables",
    "Columns": "core.blocks",
    "Correlations": "core.tables",
    "Fact": "core.blocks",
    "Facts": "core.blocks",
    "Figure": "core.blocks",
    "Gallery": "core.blocks",
    "KeyValue": "core.blocks",
    "KeyValues": "core.blocks",
    "LawLine": "core.documents",
    "Mark": "core.sparklines",
    "Math": "core.blocks",
    "Name": "core.tables",
    "Note": "core.blocks",
    "Number": "core.tables",
    "Opening": "core.documents",
    "Page": "core.documents",
    "Panel": "core.blocks",
    "Paragraph": "core.blocks",
    "Reference": "core.blocks",
    "References": "core.blocks",
    "Row": "core.tables",
    "RowPlot": "core.sparklines",
    "Section": "core.documents",
    "Subheading": "core.blocks",
    "Table": "core.tables",
    "inline": "core.markup",
    "mathml": "core.markup",
    "render": "core.page",
    "symbol": "core.markup",
    "symbol_text": "core.markup",
    "write": "core.page",
}

INSIDE = {
    "ContactsReport": "runs",
    "Origin": "core.documents",
    "RunReport": "runs",
    "SectionMaker": "core.documents",
    "characterization_page": "laws",
    "colophon": "core.versions",
    "contacts_page": "runs",
    "documents": "core",
    "feature_sections": "features.sections",
    "formula_text": "core.formulas",
    "joint_sections": "joints.sections",
    "law_references": "core.reproduce",
    "made_sections": "core.documents",
    "plain": "core.markup",
    "plan_page": "plans",
    "published_dict": "core.formulas",
    "rate_state_sections": "rate_state.sections",
    "record_sections": "records.sections",
    "run_page": "runs",
    "travel_sections": "travels.sections",
    "versions": "core.versions",
}
"""Names that other subpackages use, and that are not part of the public interface."""

__all__ = sorted(HOMES)  # noqa: PLE0605  # read off the table above

__getattr__, __dir__ = attach(__name__, HOMES | INSIDE)

# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.exports.base import Export as Export
from stickslip.exports.base import Target as Target
from stickslip.exports.fmu.export import export_fmu as export_fmu
from stickslip.exports.identifiers import identifier as identifier
from stickslip.exports.registry import TARGETS as TARGETS
from stickslip.exports.verb import export as export

__all__ = [
    "Export",
    "TARGETS",
    "Target",
    "export",
    "export_fmu",
]

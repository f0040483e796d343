# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.exports.applying import Applied as Applied
from stickslip.exports.applying import AppliedJoint as AppliedJoint
from stickslip.exports.applying import apply as apply
from stickslip.exports.applying import check_output as check_output
from stickslip.exports.fmu.export import compiler_here as compiler_here
from stickslip.exports.fmu.export import export_fmu as export_fmu
from stickslip.exports.program import Export as Export
from stickslip.exports.program import Target as Target
from stickslip.exports.program import identifier as identifier
from stickslip.exports.verb import TARGETS as TARGETS
from stickslip.exports.verb import export as export

__all__ = [
    "Applied",
    "AppliedJoint",
    "Export",
    "TARGETS",
    "Target",
    "apply",
    "export",
    "export_fmu",
]

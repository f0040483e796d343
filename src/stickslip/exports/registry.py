"""The targets by name."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from stickslip.exports.base import Target
from stickslip.exports.c_code import CCode
from stickslip.exports.joints import Mjcf, Urdf
from stickslip.exports.matlab import Matlab
from stickslip.exports.modelica import Modelica
from stickslip.exports.tables import CsvTable, JsonDocument

TARGETS: Final[Mapping[str, Target]] = MappingProxyType(
    {
        one.name: one
        for one in (CCode(), Matlab(), Modelica(), Mjcf(), Urdf(), CsvTable(), JsonDocument())
    }
)
"""What a law can be exported to."""

"""Friction at steady speeds, fitted and told as records are."""

from typing import final

from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.kinds.friction_tables.selection import ROUTE, select_table
from stickslip.kinds.kind import Request
from stickslip.kinds.records.kind import RecordKind
from stickslip.kinds.records.verdict import RecordVerdict


@final
class FrictionTableKind(RecordKind):
    """Friction against velocity without time: no bristles, no fault, rows in any order."""

    routes = (ROUTE,)

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all(one.kind == "friction-map" for one in measurement.records())

    @override
    def select(self, request: Request) -> RecordVerdict:
        return select_table(request)

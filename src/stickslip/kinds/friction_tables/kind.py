"""Friction at steady speeds, fitted and told as records are."""

from typing import final

from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.kinds.friction_tables.selection import ROUTE, select_table
from stickslip.kinds.kind import Options, SelectRequest
from stickslip.kinds.records import RecordKind
from stickslip.selection import RecordVerdict


@final
class FrictionTableKind(RecordKind):
    """Friction against velocity without time: no bristles, no fault, rows in any order."""

    routes = (ROUTE,)

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all(one.kind == "friction-map" for one in measurement.records())

    @override
    def select(self, request: SelectRequest, options: Options) -> RecordVerdict:
        return select_table(
            request.mechanism,
            request.laws,
            request.measurement,
            purpose=options.purpose or "simulate",
            horizon=options.horizon,
            route=options.route,
            validate=options.validate,
            settings=options.settings,
            executor=options.executor,
            **request.shared,
        )

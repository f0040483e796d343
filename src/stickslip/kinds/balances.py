"""Records of one coordinate, judged by `stickslip.identify` where the route "balance" is asked."""

from typing import Any, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.identification import Parameters
from stickslip.identify import BandVerdict, select_record
from stickslip.kinds.friction_tables import BandKind
from stickslip.kinds.kind import Request


@final
class BalanceKind(BandKind):
    """Motion and force, friction in time, or a free motion, of one coordinate."""

    routes = ("balance",)  # type: ignore[assignment]
    measured = "records of one coordinate by their force balance"
    settings = frozenset()

    @override
    def serves(self, measurement: Measurement) -> bool:
        return False  # only where its route is asked for

    @override
    def select(self, request: Request) -> BandVerdict:  # type: ignore[override]
        measurement = request.measurement
        if measurement.joints or "voltage" in measurement.quantities():
            raise InputError(
                "route 'balance' is for positions and forces of one coordinate: leave it out for"
                " joints and for motors with a recorded voltage."
            )
        chosen: Any = Parameters.of(
            request.mechanism, None, request.vary, request.fixed, measurement=measurement
        )
        if len(chosen.unknown) > 1:
            raise InputError(
                "route 'balance' finds one parameter of the mechanism, its inertia, and was asked"
                f" for {', '.join(chosen.unknown)}: vary the inertia alone."
            )
        return select_record(
            chosen.mechanism,
            measurement,
            laws=request.laws,
            vary=chosen.unknown,
            validate=request.validate,
            route=self.routes[0],
        )

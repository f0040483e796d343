"""Tables of friction over the speed, judged by `stickslip.identify`."""

from dataclasses import fields

from typing_extensions import override

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.identify import BandVerdict, select_table
from stickslip.identify.fits import LAW, RecordSettings, names_of
from stickslip.identify.kinds.kind import Request
from stickslip.identify.kinds.records import WITHOUT_EFFECT, BandKind
from stickslip.show.formatting import joined

FORCE_MAP = "force-map"
"""Route by which tables are fitted."""


class FrictionTableKind(BandKind):
    """Friction against velocity without time: no bristles, rows in any order."""

    routes = ("table", FORCE_MAP)
    measured = "tables of friction"
    settings = frozenset(field.name for field in fields(RecordSettings)) - WITHOUT_EFFECT[FORCE_MAP]

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all(one.kind == "friction-map" for one in measurement.records())

    @override
    def why_unused(self, name: str, request: Request) -> str:
        if name == "route" and request.route and not self.serves(request.measurement):
            own = f"{request.route!r} applies to {self.measured}"
            return f"{own}, not to this measurement: leave it out."
        return super().why_unused(name, request)

    @override
    def select(self, request: Request) -> BandVerdict:
        varied = {*names_of(request.vary or ())} - {LAW}
        for name, given in (("vary", varied), ("fixed", request.fixed)):
            if given:
                raise InputError(
                    f"{name} applies to `fit` of {self.measured}; it has no effect on `select`,"
                    f" got {joined(sorted(given))}: leave it out."
                )
        return select_table(
            request.mechanism,
            request.measurement,
            laws=request.laws,
            validate=request.validate,
            route=self.routes[0],
        )

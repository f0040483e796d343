"""Tables of friction over the speed, judged by `stickslip.identify`."""

from typing import Any, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import NO_VALUE, joined, percent
from stickslip.identification import LAW, asked_for, names_of
from stickslip.identify import BandVerdict, select_table, verdict_sections
from stickslip.kinds.kind import Comparison, Request
from stickslip.kinds.records.kind import WITHOUT_EFFECT, RecordKind
from stickslip.report import Origin, SectionMaker
from stickslip.selection import score_text

FORCE_MAP = "force-map"
"""Route by which tables are fitted."""


class BandKind(RecordKind):
    """What `stickslip.identify` judges; fits are those of records.

    The first of its routes is that of `select`, the others are those of `fit`.
    """

    climbs = False
    uses = frozenset({"route", "validate"})

    @override
    def candidates(self, laws: Any, measurement: Measurement) -> list[str]:
        return ["laws"]

    @override
    def resolved(self, request: Request) -> Request:
        return request if request.law is None else super().resolved(request)

    @override
    def why_unused(self, name: str, request: Request) -> str:
        selects, asked = request.law is None, asked_for(request.route)
        verb, other = ("select", "fit") if selects else ("fit", "select")
        unused = (
            f"applies to `{other}` of {self.measured}; it has no effect on `{verb}`: leave it out."
        )
        if name == "route" and asked and (asked == self.routes[0]) is not selects:
            return f"{asked!r} {unused}"
        if selects and (name == "settings" or name in self.settings):
            return unused
        known = name in self.uses | self.settings
        return super().why_unused(name, request) if known and not selects else ""

    @override
    def comparison(self, verdict: BandVerdict) -> Comparison:  # type: ignore[override]
        unit = verdict.score_unit
        scale = verdict.scale
        closest = verdict.closest
        rows = [
            [
                one.title,
                str(one.count),
                score_text(scale, one.held_out).value,
                percent(one.share) if one.share >= 0.005 else NO_VALUE,
                one.outcome,
            ]
            for one in verdict.candidates
        ]
        assert closest.fit is not None
        return Comparison(
            heads=["law", "parameters", f"held-out error, {scale.unit or unit}", "share", ""],
            rows=rows,
            checks=verdict.checks,
            fitted=(closest.title, closest.fit.estimates),
        )

    @override
    def sections(  # type: ignore[override]
        self, verdict: BandVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return verdict_sections(verdict, origin, remark)


@final
class FrictionTableKind(BandKind):
    """Friction against velocity without time: no bristles, rows in any order."""

    routes = ("table", FORCE_MAP)  # type: ignore[assignment]  # the base class has other names
    measured = "tables of friction"
    settings = RecordKind.settings - WITHOUT_EFFECT[FORCE_MAP]

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all(one.kind == "friction-map" for one in measurement.records())

    @override
    def why_unused(self, name: str, request: Request) -> str:
        if name == "route" and request.route and not self.serves(request.measurement):
            asked = asked_for(request.route)
            return f"{asked!r} applies to {self.measured}, not to this measurement: leave it out."
        return super().why_unused(name, request)

    @override
    def select(self, request: Request) -> BandVerdict:  # type: ignore[override]
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

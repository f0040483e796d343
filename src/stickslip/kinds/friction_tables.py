"""Tables of friction over the speed, judged by `stickslip.identify`."""

from typing import Any, final

from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.formatting import NO_VALUE, percent
from stickslip.identify import BandVerdict, select_table, verdict_sections
from stickslip.kinds.kind import Comparison, Request
from stickslip.kinds.records.kind import RecordKind
from stickslip.report import Origin, SectionMaker
from stickslip.selection import score_text


class BandKind(RecordKind):
    """What `stickslip.identify` judges; fits are those of records."""

    climbs = False
    uses = frozenset({"route", "validate"})

    @override
    def candidates(self, laws: Any, measurement: Measurement) -> list[str]:
        return ["laws"]

    @override
    def resolved(self, request: Request) -> Request:
        return request

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

    routes = ("table",)  # type: ignore[assignment]  # those of fits are those of records
    measured = "tables of friction"

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all(one.kind == "friction-map" for one in measurement.records())

    @override
    def select(self, request: Request) -> BandVerdict:  # type: ignore[override]
        return select_table(
            request.mechanism,
            request.measurement,
            laws=request.laws,
            validate=request.validate,
            route=self.routes[0],
        )

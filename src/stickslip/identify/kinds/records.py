"""Records in time, and measured friction."""

from collections.abc import Collection
from functools import partial
from typing import Any

from stickslip.data import Measurement, refuse_unused
from stickslip.errors import InputError
from stickslip.identify import (
    BandVerdict,
    LawFit,
    fitted_law,
    importance,
    ladder_rows,
    select_record,
    select_table,
    verdict_sections,
)
from stickslip.identify.candidates import in_sentence
from stickslip.identify.fits import (
    LAW,
    Laws,
    Parameters,
    check_inputs,
    goes_straight,
    inside,
    load_of,
    names_of,
)
from stickslip.identify.kinds.kind import (
    OVER_ALL_LAWS,
    Comparison,
    FitSummary,
    Kind,
    Request,
)
from stickslip.show.formatting import joined
from stickslip.show.report import Origin, SectionMaker


def refuse_overrides(measurement: Measurement, paths: Collection[str]) -> None:
    """Refuse trials with values of their own for what is one unknown of all of them."""
    for number, record in enumerate(measurement.records(), 1):
        for path in record.overrides:
            if path in paths:
                raise InputError(
                    f"trial {record.name or number} overrides {path}, which is fitted as one value"
                    " for all trials: leave the override out, or do not vary it."
                )


class BandKind(Kind[LawFit, BandVerdict]):
    """Laws are compared, and one is fitted, by the posterior of `stickslip.identify`."""

    uses = frozenset({"route", "validate", "tolerance"})

    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return ["laws"]

    def fit(self, request: Request) -> LawFit:
        law: Any = self.owner(request.law)
        chosen = request.parameters(law)
        check_inputs(chosen.law, chosen.mechanism, request.measurement)
        refuse_unused(request.measurement, inside(chosen.mechanism, request.measurement))
        return fitted_law(
            partial(self._select, request, chosen),
            chosen.law,
            free=chosen.free,
            known=chosen.known,
            load=load_of(chosen.mechanism),
            unknown=chosen.unknown,
        )

    def _select(self, request: Request, chosen: Parameters[Any], laws: Any) -> BandVerdict:
        """Return the verdict on some laws, for what is known and looked for of a mechanism."""
        raise NotImplementedError

    def comparison(self, verdict: BandVerdict) -> Comparison:
        closest = verdict.closest
        assert closest.fit is not None
        values = sorted(verdict.intervals, key=importance)
        heads, rows = ladder_rows(verdict)
        return Comparison(
            heads=heads,
            rows=rows,
            checks=verdict.checks,
            fitted=(OVER_ALL_LAWS.format(closest.title), values) if values else None,
        )

    def summary(self, fit: LawFit, validate: Measurement | None = None) -> FitSummary:
        assert fit.verdict is not None
        words, second = fit.verdict.words, None
        lines = [words.verdict, words.lede, *words.settles[:1]]
        if validate is not None:
            other = fit.predict(validate)
            lines.append(f"On the second record {in_sentence(str(other))}.")
            second = other.error
        return FitSummary(
            lines=[*lines, *fit.remarks],
            open=("Limitations", fit.sentences),
            second=second,
        )

    def sections(
        self, verdict: BandVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return verdict_sections(verdict, origin, remark)


class RecordKind(BandKind):
    """Records in time: by the force balance along the motion, or by runs that follow them."""

    routes = ("balance",)
    measured = "records of motion or friction"
    content = "records"
    settings = frozenset({"hold"})

    def why_unused(self, name: str, request: Request) -> str:
        if name == "hold" and not _holds(request.measurement):
            return (
                "applies to records of a force that drives the motion, and this has none: leave it"
                " out."
            )
        return ""

    def select(self, request: Request) -> BandVerdict:
        return self._select(request, request.parameters(None), request.laws)

    def _select(self, request: Request, chosen: Parameters[Any], laws: Any) -> BandVerdict:
        refuse_overrides(request.measurement, chosen.unknown)
        return select_record(
            chosen.mechanism,
            request.measurement,
            laws=laws,
            vary=chosen.unknown,
            offset="mechanism.offset" not in chosen.held,
            hold=request.settings.hold if request.settings else None,
            validate=request.validate,
            tolerance=request.tolerance,
        )


def _holds(measurement: Measurement) -> bool:
    """Return whether anything is recorded that may hold between samples."""
    return any(not goes_straight(record, "zero") for record in measurement.records())


# Tables of friction over the speed.


class FrictionTableKind(BandKind):
    """Friction against velocity without time: no bristles, rows in any order."""

    routes = ("table",)
    measured = "tables of friction"
    content = "tables"

    def why_unused(self, name: str, request: Request) -> str:
        if name == "route" and request.route and not self.serves(request.measurement):
            own = f"{request.route!r} applies to {self.measured}"
            return f"{own}, not to this measurement: leave it out."
        return ""

    def select(self, request: Request) -> BandVerdict:
        varied = {*names_of(request.vary or ())} - {LAW}
        for name, given in (("vary", varied), ("fixed", request.fixed)):
            if given:
                raise InputError(
                    f"{name} applies to `fit` of {self.measured}; it has no effect on `select` and"
                    f" `plan`, got {joined(sorted(given))}: leave it out."
                )
        chosen = Parameters.of(request.mechanism, None, measurement=request.measurement)
        return self._select(request, chosen, request.laws)

    def _select(self, request: Request, chosen: Parameters[Any], laws: Any) -> BandVerdict:
        if chosen.unknown:
            raise InputError(
                f"vary: a table of friction tells nothing of {chosen.unknown[0]}: leave it out."
            )
        return select_table(
            chosen.mechanism,
            request.measurement,
            laws=laws,
            validate=request.validate,
            tolerance=request.tolerance,
        )

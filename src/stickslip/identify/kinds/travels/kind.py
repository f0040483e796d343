"""Travels: distances to rest, or per cycle of a drive."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from stickslip.data import Checks, Measurement, check, is_filmed, travels_of_films
from stickslip.friction import law_type
from stickslip.identify import USUAL_LAWS
from stickslip.identify.criteria import limits_of
from stickslip.identify.fits import AnyLaw, Laws, quantities_read
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Law, Request, terminal_table
from stickslip.identify.kinds.travels.fit import T_END, TravelFit, fit_travels
from stickslip.identify.kinds.travels.selection import select_travels
from stickslip.identify.kinds.travels.verdict import TravelVerdict, columns_of
from stickslip.show.formatting import quantity
from stickslip.show.report import Origin, SectionMaker


class TravelKind(Kind[TravelFit, TravelVerdict]):
    """Runs to rest, fitted to distances."""

    routes = ("travel",)
    measured = "travels"
    content = "travels"
    uses = frozenset({"assumed", "t_end"})
    has_criteria = True
    counts_runs = True

    def reads(self, measurement: Measurement) -> bool:
        return is_filmed(measurement)

    def why_unused(self, name: str, request: Request) -> str:
        if name == "validate":
            return "requires a second record, and travels have none: give more trials instead."
        return ""

    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return [one if isinstance(one, str) else one.name for one in laws or USUAL_LAWS]

    def owner(self, law: Law) -> AnyLaw:
        return law_type(law) if isinstance(law, str) else law

    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        return self.owner(law), vary

    def fit(self, request: Request) -> TravelFit:
        request, t_end = _read(request)
        return fit_travels(t_end=t_end, **request.arguments("law"))

    def select(self, request: Request) -> TravelVerdict:
        request, t_end = _read(request)
        return select_travels(t_end=t_end, **request.arguments("laws", "assumed"))

    def comparison(self, verdict: TravelVerdict) -> Comparison:
        everyone = verdict.candidates
        notes = [f"{c.title}: {c.dropped}" for c in everyone if c.dropped]
        if any(trial.cycles is not None for trial in verdict.trials):
            notes += _speeds(verdict)
        heads, rows = terminal_table(columns_of(verdict), everyone)
        return Comparison(heads=heads, rows=rows, notes=notes, checks=_of_units(verdict))

    def summary(
        self, fit: TravelFit, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        rows, read = [], quantities_read(fit.trials)
        for trial, *pair in zip(fit.trials, fit.measured, fit.predicted, strict=True):
            rows.append([quantity(travel, "m") for travel in pair])
            rows[-1] += [trial.as_read(travel) for travel in pair] if read else []
        heads = ["measured travel", "predicted"]
        heads += [f"measured {read}", "predicted"] if read else []
        return FitSummary(heads=heads, rows=rows, limits=limits_of(fit))

    def sections(
        self, verdict: TravelVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        # figures are loaded where a page is made
        from stickslip.identify.kinds.travels.page import sections

        return sections(verdict, origin, remark)


def _read(request: Request) -> tuple[Request, float]:
    """Return the request with travels, read off films where it has these, and when runs end."""
    if not is_filmed(request.measurement):
        return request, T_END if request.t_end is None else request.t_end
    read, t_end = travels_of_films(request.mechanism, request.measurement, request.t_end)
    return replace(request, measurement=read), t_end


def _speeds(verdict: TravelVerdict) -> list[str]:
    """Return lines with the mean velocity of each trial, measured and predicted."""
    table = verdict.compared()
    rows = [
        [str(name), quantity(measured, "m/s", 3), quantity(predicted, "m/s", 3)]
        for name, measured, predicted in zip(
            table.index, table["measured"].tolist(), table["predicted"].tolist(), strict=True
        )
    ]
    rows = [["mean velocity of", "measured", "predicted"], *rows]
    wide = [max(len(row[k]) for row in rows) for k in range(3)]
    return ["   ".join(cell.rjust(w) for cell, w in zip(row, wide, strict=True)) for row in rows]


def _of_units(verdict: TravelVerdict) -> Checks:
    """Return what is doubtful about the units of the readings; the verdict says the rest itself."""
    found = check(verdict.measurement, mechanism=verdict.mechanism)
    return replace(found, findings=tuple(one for one in found.findings if one.kind == "units"))

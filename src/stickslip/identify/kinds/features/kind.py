"""The force of a spring that pulls a block, compared by features of stick-slip."""

from collections.abc import Collection

from stickslip.data import Measurement
from stickslip.identify.fits import Laws
from stickslip.identify.kinds.features.fit import fit_features
from stickslip.identify.kinds.features.result import FeatureFit
from stickslip.identify.kinds.features.selection import feature_laws, select_features
from stickslip.identify.kinds.features.verdict import COLUMNS, FeatureVerdict
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Request, terminal_table
from stickslip.identify.problems.slip_features import COMPARED, FEATURES
from stickslip.mechanisms import Mechanism, input_names
from stickslip.show.formatting import number, quantity, signed_percent
from stickslip.show.report import Origin, SectionMaker

UNITS = {"frequency": "Hz"}
"""Of features that have one."""


class FeatureKind(Kind[FeatureFit, FeatureVerdict]):
    """Limit cycles of a towed block, fitted to frequency, mean and standard deviation."""

    routes = (FEATURES,)
    measured = "the force of a spring"
    content = "spring force"
    uses = frozenset({"route", "validate"})
    settings = frozenset({"seed"})

    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return [*feature_laws(laws)]

    def residual_text(self, error: float, request: Request) -> str:
        return f"residual of the features {number(error, 2)}"

    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        return input_names(mechanism)

    def fit(self, request: Request) -> FeatureFit:
        seed = 0 if request.settings is None else request.settings.seed
        return fit_features(seed=seed, **request.arguments("law"))

    def select(self, request: Request) -> FeatureVerdict:
        return select_features(**request.arguments("laws", "validate", "settings"))

    def comparison(self, verdict: FeatureVerdict) -> Comparison:
        heads, cells = terminal_table(COLUMNS, verdict.candidates)
        best = verdict.best
        return Comparison(
            heads=heads,
            rows=cells,
            notes=[f"{one.name}: {one.outcome}" for one in verdict.candidates],
            checks=verdict.checks,
            fitted=(best.title, best.fit.estimates) if best and best.fit else None,
        )

    def summary(
        self, fit: FeatureFit, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        second = {} if validate is None else fit.judged(validate)
        heads = ["feature of F/N", "measured", "fitted", "error"]
        heads += ["second record, error"] if second else []
        rows = []
        for name in COMPARED:
            cells = [_sized(name, getattr(fit.observed, name)), _sized(name, fit.predicted[name])]
            cells += [signed_percent(fit.errors[name])]
            cells += [signed_percent(second[name])] if second else []
            rows.append([name.replace("_", " "), *cells])
        return FitSummary(
            heads=heads,
            rows=rows,
            open=("Remarks", fit.sentences),
            second=second or None,
        )

    def sections(
        self, verdict: FeatureVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        from stickslip.identify.kinds.features.page import (
            sections,  # figures are loaded where a page is made
        )

        return sections(verdict, origin, remark)


def _sized(name: str, value: float) -> str:
    return quantity(value, UNITS.get(name, "1"))

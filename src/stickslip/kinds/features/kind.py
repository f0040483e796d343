"""The force of a spring that pulls a block, compared by features of stick-slip."""

import math
from collections.abc import Collection
from functools import partial
from typing import final

from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.formatting import NO_VALUE, percent, quantity, signed_percent
from stickslip.identification import Laws
from stickslip.kinds.features.features import COMPARED, FEATURES
from stickslip.kinds.features.fit import fit_features
from stickslip.kinds.features.result import FeatureFit
from stickslip.kinds.features.selection import feature_laws, select_features
from stickslip.kinds.features.verdict import FeatureCandidate, FeatureVerdict
from stickslip.kinds.features.wording import share_parts
from stickslip.kinds.kind import Comparison, FitRequest, FitSummary, Kind, Options, SelectRequest
from stickslip.mechanisms import Mechanism, input_names
from stickslip.report import Origin, SectionMaker

SHORT = {"standard_deviation": "deviation"}
"""Column headings, shortened for a terminal of 80 characters."""
UNITS = {"frequency": "Hz"}
"""Of features that have one."""


@final
class FeatureKind(Kind[FeatureFit, FeatureVerdict]):
    """Limit cycles of a towed block, fitted to frequency, mean and standard deviation."""

    routes = (FEATURES,)
    measured = "the force of a spring"
    uses = frozenset({"route", "validate", "executor"})
    settings = frozenset({"seed"})

    @override
    def serves(self, measurement: Measurement) -> bool:
        return measurement.only_spring_force

    @override
    def candidates(self, laws: Laws | None, measurement: Measurement) -> list[str]:
        return [one.name for one in feature_laws(laws)]

    @override
    def residual_text(self, error: float, measurement: Measurement, options: Options) -> str:
        return f"error of the features {percent(error)}"

    @override
    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        return input_names(mechanism)

    @override
    def fit(self, request: FitRequest, options: Options) -> FeatureFit:
        seed = 0 if options.settings is None else options.settings.seed
        return request.passed_to(partial(fit_features, seed=seed))

    @override
    def select(self, request: SelectRequest, options: Options) -> FeatureVerdict:
        return request.passed_to(
            partial(
                select_features,
                validate=options.validate,
                settings=options.settings,
                executor=options.executor,
            )
        )

    @override
    def comparison(self, verdict: FeatureVerdict) -> Comparison:
        second = any(one.second for one in verdict.candidates)
        heads = ["law", "free", "held-out, %", *(SHORT.get(name, name) for name in COMPARED)]
        heads += ["second"] if second else []
        rows = [_row(one, one.name, second=second) for one in verdict.candidates]
        if verdict.control:
            name = f"{verdict.control.name}, nominal"
            rows.append(_row(verdict.control, name, second=second))
        best = verdict.best
        return Comparison(
            heads=heads,
            rows=rows,
            notes=[f"{one.name}: {one.outcome}" for one in verdict.candidates],
            checks=verdict.checks,
            fitted=(best.title, best.fit.estimates) if best and best.fit else None,
        )

    @override
    def summary(
        self, fit: FeatureFit, validate: Measurement | None = None, horizon: float | None = None
    ) -> FitSummary:
        second = {} if validate is None else fit.judged(validate)
        heads = ["feature of F/N", "first half", "fitted", "second half", "error"]
        heads += ["second record, error"] if second else []
        rows = []
        for name in COMPARED:
            cells = [_sized(name, getattr(fit.observed, name)), _sized(name, fit.predicted[name])]
            cells += ["" if fit.held_out is None else _sized(name, getattr(fit.held_out, name))]
            cells += [signed_percent(fit.held_out_errors[name]) if fit.held_out_errors else ""]
            cells += [signed_percent(second[name])] if second else []
            rows.append([name.replace("_", " "), *cells])
        return FitSummary(
            heads=heads,
            rows=rows,
            open=("Remarks", fit.sentences),
            second=second or None,
        )

    @override
    def sections(
        self, verdict: FeatureVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        from stickslip.kinds.features.page import (
            sections,  # figures are loaded where a page is made
        )

        return sections(verdict, origin, remark)


def _row(one: FeatureCandidate, name: str, *, second: bool) -> list[str]:
    def shown(value: float | None) -> str:
        return NO_VALUE if value is None or not math.isfinite(value) else signed_percent(value)

    cells = [
        name,
        str(one.parameters) if one.fit else NO_VALUE,
        " ".join(share_parts(one)).strip() if one.fit else NO_VALUE,
        *(shown(one.errors.get(feature)) for feature in COMPARED),
    ]
    size = math.sqrt(sum(e**2 for e in one.second.values()) / max(len(one.second), 1))
    return cells + ([percent(size) if one.second else NO_VALUE] if second else [])


def _sized(name: str, value: float) -> str:
    return quantity(value, UNITS.get(name, "1"))

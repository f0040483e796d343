"""Records of several joints, fitted by inverse dynamics with all joints at once."""

from collections.abc import Collection, Mapping, Sequence
from functools import partial
from typing import Any, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import quantity
from stickslip.identification import JOINTS, RecordFit, RecordSettings, fit_joints
from stickslip.report import Origin, SectionMaker
from stickslip.routes.route import (
    Comparison,
    FitRequest,
    FitSummary,
    Law,
    Options,
    Route,
    SelectRequest,
    SeveralLaws,
)
from stickslip.selection import Verdict, limits_of, restarts_text

__all__ = ["JointRoute"]


@final
class JointRoute(Route[RecordFit[Any], Verdict]):
    """Friction of every joint by inverse dynamics, with the parameters of all in one problem."""

    names = (JOINTS,)
    measured = "records of several joints"
    uses = frozenset({"validate"})
    settings = frozenset({"hold", "starts", "seed"})
    by_contact = True

    @override
    def serves(self, measurement: Measurement) -> bool:
        return bool(measurement.joint_names())

    @override
    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        raise _not_selected()

    @override
    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        return law, vary

    @override
    def fit(self, request: FitRequest, options: Options) -> RecordFit[Any]:
        return request.passed_to(partial(fit_joints, settings=options.settings or RecordSettings()))

    @override
    def select(self, request: SelectRequest, options: Options) -> Verdict:
        raise _not_selected()

    @override
    def comparison(self, verdict: Verdict) -> Comparison:
        raise NotImplementedError  # there are no verdicts

    @override
    def summary(
        self,
        fit: RecordFit[Any],
        validate: Measurement | None = None,
        horizon: float | None = None,
    ) -> FitSummary:
        own = fit.score()
        second = None if validate is None else fit.score(validate)
        heads = ["joint", "residual of the force", *(["second record"] if second else [])]
        rows = []
        for name, one in own.joints.items():
            other = [] if second is None else [second.joints[name]]
            rows.append([name, *(quantity(each.rms, each.unit) for each in (one, *other))])
        return FitSummary(
            heads=heads,
            rows=rows,
            lines=[f"Restarts: {restarts_text(fit)}", *fit.remarks],
            limits=limits_of(fit),
            open=("Limitations", fit.sentences),
            second=None if second is None else _by_joint(second.joints),
        )

    @override
    def sections(self, verdict: Verdict, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
        raise NotImplementedError  # there are no verdicts


def _not_selected() -> InputError:
    return InputError(
        "laws are not selected for several joints yet: fit each combination, and compare"
        " `fit.score(other)` on a record that no fit has seen."
    )


def _by_joint(scores: Mapping[str, Any]) -> dict[str, float]:
    return {name: one.rms for name, one in scores.items()}

"""Records of several joints: fitted by inverse dynamics, judged joint by joint."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from stickslip.data import Measurement
from stickslip.identify import JointVerdict, joint_sections, probability_text, select_joints
from stickslip.identify.criteria import limits_of
from stickslip.identify.fits import JOINTS, RecordFit, RecordSettings, fit_joints
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Law, Request, SeveralLaws
from stickslip.identify.kinds.records import left_text, restarts_lines
from stickslip.mechanisms import Mechanism, input_names
from stickslip.show.formatting import percent
from stickslip.show.report import Origin, SectionMaker


class JointKind(Kind[RecordFit[Any], JointVerdict]):
    """Friction of every joint; fits have the parameters of all in one problem."""

    routes = (JOINTS,)
    measured = "records of several joints"
    content = "joints"
    uses = frozenset({"validate", "tolerance"})
    settings = frozenset({"hold", "starts", "seed", "position_zeros"})
    by_contact = True

    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        return [*measurement.joint_names()]

    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        return law, vary

    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        own = {name: 0 for one in mechanism.contacts() for name in input_names(mechanism, one.name)}
        return (*own, *measurement.input_names())  # fits ask for those of each contact

    def why_unused(self, name: str, request: Request) -> str:
        if request.law is None and name in {"starts", "seed"}:
            return (
                f"applies to `fit` of {self.measured}; it has no effect on `select`: leave it out."
            )
        return ""

    def fit(self, request: Request) -> RecordFit[Any]:
        settings = request.settings or RecordSettings()
        return fit_joints(laws=request.law, settings=settings, **request.arguments())

    def select(self, request: Request) -> JointVerdict:
        return select_joints(
            request.mechanism,
            request.laws,
            request.measurement,
            vary=request.vary,
            fixed=request.fixed,
            validate=request.validate,
            tolerance=request.tolerance,
            settings=request.settings,
        )

    def comparison(self, verdict: JointVerdict) -> Comparison:
        rows = [
            [
                name,
                one.title,
                str(one.count),
                percent(one.distance),
                own.scale.error(one.left),
                probability_text(one.share),
                one.outcome,
            ]
            for name, own in verdict.joints.items()
            for one in own.candidates
        ]
        fit = verdict.closest.fit
        return Comparison(
            heads=["joint", "law", "parameters", "stays within", "leaves", "probability", ""],
            rows=rows,
            checks=verdict.checks,
            fitted=None if fit is None else (verdict.closest.title, fit.shown),
        )

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
            scale = own.scales[one.unit]
            rows.append([name, *(scale.quantity(each.rms) for each in (one, *other))])
        return FitSummary(
            heads=heads,
            rows=rows,
            lines=[f"{left_text(fit)}.", *restarts_lines(fit), *fit.remarks, *fit.assumptions],
            findings=[f"Model error: {error}" for error in fit.model_errors],
            limits=limits_of(fit),
            open=("Limitations", fit.sentences),
            second=None if second is None else _by_joint(second.joints),
        )

    def sections(
        self, verdict: JointVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return joint_sections(verdict, origin, remark)


def _by_joint(scores: Mapping[str, Any]) -> dict[str, float]:
    return {name: one.rms for name, one in scores.items()}

"""Records of several joints: judged joint by joint, with the links that all tell together."""

from collections.abc import Collection, Sequence
from itertools import chain

from stickslip.data import Measurement
from stickslip.identify import (
    JointLawFit,
    JointVerdict,
    fit_joints,
    joint_sections,
    probability_text,
    select_joints,
)
from stickslip.identify.candidates import in_sentence
from stickslip.identify.joint_request import JOINTS
from stickslip.identify.kinds.kind import Comparison, FitSummary, Kind, Law, Request, SeveralLaws
from stickslip.mechanisms import Mechanism, input_names
from stickslip.show.formatting import percent
from stickslip.show.report import Origin, SectionMaker


class JointKind(Kind[JointLawFit, JointVerdict]):
    """Friction of every joint."""

    routes = (JOINTS,)
    measured = "records of several joints"
    content = "joints"
    uses = frozenset({"validate", "tolerance"})
    settings = frozenset({"hold", "position_zeros"})
    by_contact = True

    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        return [*measurement.joint_names()]

    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        return law, vary

    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        own = [input_names(mechanism, contact.name) for contact in mechanism.contacts()]
        return (
            *dict.fromkeys(chain(*own)),
            *measurement.input_names(),
        )  # fits ask for those of each contact

    def fit(self, request: Request) -> JointLawFit:
        return fit_joints(laws=request.law, **request.arguments("settings"))

    def select(self, request: Request) -> JointVerdict:
        return select_joints(**request.arguments("laws", "validate", "tolerance", "settings"))

    def comparison(self, verdict: JointVerdict) -> Comparison:
        rows = [
            [
                name,
                candidate.title,
                str(candidate.count),
                percent(candidate.distance),
                own.scale.error(candidate.left),
                probability_text(candidate.share),
                candidate.outcome,
            ]
            for name, own in verdict.joints.items()
            for candidate in own.candidates
        ]
        fit = verdict.closest.fit
        return Comparison(
            heads=["joint", "law", "parameters", "differs by", "scatter", "probability", ""],
            rows=rows,
            checks=verdict.checks,
            fitted=None if fit is None else (verdict.closest.title, fit.shown),
        )

    def summary(self, fit: JointLawFit, validate: Measurement | None = None) -> FitSummary:
        assert fit.verdict is not None
        second = {} if validate is None else fit.predict(validate)
        lines = [fit.verdict.words.verdict, fit.verdict.words.lede]
        lines += [
            f"On the second record, {name}: {in_sentence(str(x))}." for name, x in second.items()
        ]
        return FitSummary(
            lines=[*lines, *fit.remarks],
            open=("Limitations", fit.sentences),
            second={name: item.error for name, item in second.items()} or None,
        )

    def sections(
        self, verdict: JointVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        return joint_sections(verdict, origin, remark)

"""Records of several joints, fitted by inverse dynamics with all joints at once."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any, final

from typing_extensions import override

from stickslip.experiments import Measurement
from stickslip.formatting import NO_VALUE
from stickslip.identification import JOINTS, RecordFit, RecordSettings, fit_joints
from stickslip.kinds.joints.selection import joint_specifications, select_joints
from stickslip.kinds.joints.verdict import JointVerdict
from stickslip.kinds.kind import Comparison, FitSummary, Kind, Law, Request, SeveralLaws
from stickslip.kinds.records import restarts_text
from stickslip.mechanisms import Mechanism, input_names
from stickslip.report import Origin, SectionMaker
from stickslip.selection import CrossValidatedVerdict, limits_of, score_text


@final
class JointKind(Kind[RecordFit[Any], JointVerdict]):
    """Friction of every joint by inverse dynamics, with the parameters of all in one problem."""

    routes = (JOINTS,)
    measured = "records of several joints"
    uses = frozenset({"validate", "executor"})
    settings = frozenset({"hold", "starts", "seed", "position_zeros"})
    by_contact = True
    climbs = True

    @override
    def serves(self, measurement: Measurement) -> bool:
        return bool(measurement.joint_names())

    @override
    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        specs = joint_specifications(laws)
        return [f"{joint}: {one.name}" for joint in measurement.joint_names() for one in specs]

    @override
    def law_and_parameters(
        self, law: Law, vary: str | Sequence[str] | None, fixed: Collection[str] = ()
    ) -> tuple[Law, str | Sequence[str] | None]:
        return law, vary

    @override
    def known_inputs(self, mechanism: Mechanism, measurement: Measurement) -> Collection[str]:
        own = {name: 0 for one in mechanism.contacts() for name in input_names(mechanism, one.name)}
        return (*own, *measurement.input_names())  # fits ask for those of each contact

    @override
    def fit(self, request: Request) -> RecordFit[Any]:
        settings = request.settings or RecordSettings()
        return fit_joints(laws=request.law, settings=settings, **request.arguments())

    @override
    def select(self, request: Request) -> JointVerdict:
        return select_joints(**request.arguments("laws", "validate", "settings", "executor"))

    @override
    def comparison(self, verdict: JointVerdict) -> Comparison:
        second = verdict.second is not None
        heads = ["joint", "law", "free", "held-out error", *(["second record"] if second else [])]
        rows, notes = [], []
        for name, own in verdict.joints.items():
            for one in own.candidates:
                value = score_text(own.scale, one.score, one.score_error)
                error = " ".join(value).strip()
                cells = [name, one.title, str(one.parameters) if one.fit else NO_VALUE]
                cells.append(f"{error} {own.scale.unit}" if one.validation else NO_VALUE)
                if second:
                    cells.append(own.scale.error(one.second.rms) if one.second else NO_VALUE)
                rows.append(cells)
                notes.append(f"{name}, {one.title}: {one.outcome}")
            notes += [f"{name}: {line}" for line in own.missing]
        closest = verdict.closest
        return Comparison(
            heads=heads,
            rows=rows,
            notes=notes,
            checks=verdict.checks,
            fitted=(title_of(verdict), closest.fit.shown) if closest.fit else None,
        )

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
            scale = own.scales[one.unit]
            rows.append([name, *(scale.quantity(each.rms) for each in (one, *other))])
        return FitSummary(
            heads=heads,
            rows=rows,
            lines=[f"Restarts: {restarts_text(fit)}", *fit.remarks, *fit.assumptions],
            findings=[f"Model error: {error}" for error in fit.model_errors],
            limits=limits_of(fit),
            open=("Limitations", fit.sentences),
            second=None if second is None else _by_joint(second.joints),
        )

    @override
    def sections(
        self, verdict: JointVerdict, origin: Origin, remark: str
    ) -> tuple[SectionMaker, ...]:
        from stickslip.kinds.joints.page import (
            joint_sections,  # figures are loaded where a page is made
        )

        return joint_sections(verdict, origin, remark)


def _by_joint(scores: Mapping[str, Any]) -> dict[str, float]:
    return {name: one.rms for name, one in scores.items()}


def title_of(verdict: CrossValidatedVerdict[Any]) -> str:
    """Return the closest law as the title of its parameters, and whether it is recommended."""
    title: str = verdict.closest.title
    return title if verdict.best else f"{title}, fits best but not recommended"

"""Selection for several joints: the law of each by coordinate descent over the candidates."""

import itertools
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias, cast, final

from stickslip.errors import ConvergenceError, InputError, SimulationError
from stickslip.experiments import Checks, Finding, Measurement
from stickslip.formatting import Scale
from stickslip.friction import CandidateSpec, FrictionLaw, Laws
from stickslip.identification import (
    LAW,
    FittedLaw,
    JointFitter,
    RecordFit,
    RecordSettings,
    joint_record,
    joint_view,
    names_of,
)
from stickslip.kinds.joints.explained import Explained, told_to
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict
from stickslip.kinds.joints.judging import (
    unfitted,
    verdict_on,
    with_contained,
    with_errors,
    with_objections,
    with_scores,
    without_spare,
)
from stickslip.kinds.joints.ladder import climbed
from stickslip.kinds.joints.verdict import JointVerdict, combination_of, joint_wording
from stickslip.mechanisms import Mechanism
from stickslip.selection import LEFT_OUT, Plan, Watch, checked, control, plan_of, specifications

SWEEPS = 6
"""Sweeps over the joints at most."""
APART = 0.1
"""Share of the residual that laws of their own must take off for trials to count as different: what
the filter makes of reversals differs by record, which a test of a few blocks takes for the law."""
HORIZON = 1.0
"""Length of held-out stretches [s]: what is scored is the force along the measured motion."""

Chosen: TypeAlias = Mapping[str, CandidateSpec]
"""A candidate for each contact."""
AnyLaws: TypeAlias = (
    Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None
)


def joint_specifications(laws: AnyLaws) -> tuple[CandidateSpec, ...]:
    """Return the candidates for each joint: those given, or the usual ones without bristles.

    The common filter of the balances hides most of presliding, and laws with bristles take a
    hundred times as long; they are compared where they are asked for.

    Examples
    --------
    >>> [one.name for one in joint_specifications(None)][:3]
    ['viscous', 'coulomb', 'coulomb-viscous']
    """
    found = specifications(laws)
    return tuple(one for one in found if laws is not None or not _has_bristles(one))


def _has_bristles(one: CandidateSpec) -> bool:
    kind = one.law if isinstance(one.law, type) else type(one.law)
    return bool(kind.states)


def select_joints(
    mechanism: Mechanism,
    laws: AnyLaws,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
    executor: Executor | None = None,
) -> JointVerdict:
    """Select a law for each joint from records of positions and forces; arguments as in `select`.

    The force balance of each joint is explained first, by the search over structures that serves
    one coordinate: the law of its structure, its rivals and Coulomb + viscous friction are the
    candidates, and faults are named with the joint. Then joint by joint every candidate is fitted
    with the laws of the others as they are, in one problem with all parameters. Named is the law
    that the balance asks for; where it cannot be judged, or where laws are given without it, one is
    chosen as for other records, by held-out errors of the force of that joint, beginning with the
    simplest. This is repeated until no choice changes.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; records may override its parameters.
    laws : mapping of str to FrictionLaw or sequence of FrictionLaw or type or str or None
        The candidates for each joint; if None, those that its force balance asks for, or the usual
        ones without bristles where that cannot be judged.
    measurement : Measurement
        Records in time of positions and forces by joint.
    vary : str or sequence of str, optional
        Parameters of the mechanism to fit too, by path or last name.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism, and of constant forces, that are held [SI].
    validate : Measurement, optional
        A second record, which no fit sees.
    settings : RecordSettings, optional
        Starts, seed and hold.
    progress : callable, optional
        Called with joint and law, and the least residual so far; False ends the search with the
        best so far.
    executor : Executor, optional
        Processes that fit laws at the same time; one after the other if not given.

    Returns
    -------
    JointVerdict
        A verdict for each joint, and the combination of laws with its fit.
    """
    specs = joint_specifications(laws)
    names = [LAW, *(name for name in names_of(vary or LAW) if name != LAW)]
    checks = checked(mechanism, measurement, validate)
    prepared = partial(
        JointFitter.of,
        mechanism,
        _laws_of(mechanism, specs[0]),
        measurement,
        vary=names,
        fixed=fixed,
        settings=settings,
    )
    bristles = any(map(_has_bristles, specs))
    fitter = prepared(bristles=bristles)
    if fitter.wrong_columns:
        found = Finding(kind="joint columns", sentence=fitter.wrong_columns, severity="warning")
        checks = replace(checks, findings=(found, *checks.findings))
    asked = _explained(fitter, progress)
    own = {
        contact: asked[contact].specs if laws is None and contact in asked else specs
        for contact in fitter.contacts.values()
    }
    if not bristles and any(_has_bristles(one) for every in own.values() for one in every):
        fitter = prepared(bristles=True)
    descent = _Descent.of(
        fitter, own, asked, validate, checks, progress, executor, usual=laws is None
    )
    return descent.verdict()


def _explained(fitter: JointFitter, watch: Watch | None) -> dict[str, Explained]:
    """Return what the force balance of each joint asks for, by contact."""

    def told(joint: str, share: float, structure: str) -> None:
        if watch is not None:
            told_to(watch, share, structure, f"{fitter.contacts[joint]}: ")

    return {
        fitter.contacts[joint]: Explained.of(
            one,
            joint_record(fitter.mechanism, fitter.measurement, joint),
            fitter.settings,
        )
        for joint, one in fitter.asked(told).items()
    }


def _laws_of(mechanism: Mechanism, one: CandidateSpec) -> dict[str, CandidateSpec]:
    return {contact.name or contact.slips[0]: one for contact in mechanism.contacts()}


@final
@dataclass
class _Descent:
    """A coordinate descent: the choice so far, and what was compared on its way."""

    fitter: JointFitter
    specs: Mapping[str, tuple[CandidateSpec, ...]]
    """Candidates of each contact."""
    asked: Mapping[str, Explained]
    """What the force balance of each contact asks for, where it could be judged."""
    validate: Measurement | None
    checks: Checks
    watch: Watch | None
    executor: Executor | None
    chosen: dict[str, CandidateSpec]
    """The law of each contact."""
    fits: dict[str, RecordCandidate]
    """Combinations that were fitted, by name; those that were compared have held-out errors."""
    plan: Plan
    """Held-out blocks of all comparisons."""
    records: dict[str, tuple[tuple[Measurement, Measurement], ...]]
    """Of each contact, what was fitted and validated of its joint, with the whole records."""
    usual: bool
    """Whether no laws were named."""
    scales: Mapping[str, Scale]
    """What errors of all joints are shown in, by their SI unit."""
    stopped: bool = False
    """Whether the search was ended early."""

    @classmethod
    def of(
        cls,
        fitter: JointFitter,
        specs: Mapping[str, tuple[CandidateSpec, ...]],
        asked: Mapping[str, Explained],
        validate: Measurement | None,
        checks: Checks,
        watch: Watch | None,
        executor: Executor | None,
        *,
        usual: bool,
    ) -> "_Descent":
        """Begin with the laws that the force balances ask for, and else with the simplest ones.

        Of several simplest ones, that with the least residual.
        """
        begun = [_begun(specs, asked, at, usual=usual) for at in _simplest(specs)]
        begun = list({combination_of(one): one for one in begun}.values())
        tried = [_begin(fitter, one, asked) for one in begun]
        known = [at for at, one in enumerate(tried) if one.fit is not None]
        if not known:
            reasons = "; ".join(f"{one.title}: {one.dropped}" for one in tried)
            raise ConvergenceError(f"no candidate can predict this record: {reasons}")
        at = min(known, key=lambda i: tried[i].residual)
        first = tried[at]
        assert first.fit is not None
        whole = [fitter.measurement, *([] if validate is None else [validate])]
        return cls(
            fitter=fitter,
            specs=specs,
            asked=asked,
            validate=validate,
            checks=checks,
            watch=watch,
            executor=executor,
            chosen=begun[at],
            fits={first.name: _told(first, begun[at], asked)},
            plan=plan_of(first.fit, horizon=HORIZON),
            records={
                contact: tuple((joint_record(fitter.mechanism, one, joint), one) for one in whole)
                for joint, contact in fitter.contacts.items()
            },
            usual=usual,
            scales=first.fit.score().scales,
        )

    def verdict(self) -> JointVerdict:
        """Sweep over the joints until no choice changes, and return the verdict."""
        verdicts: dict[str, RecordVerdict] = {}
        based: dict[str, str] = {}
        seen = [self._name()]
        for sweep in itertools.count(1):
            before = self._name()
            for joint, contact in self.fitter.contacts.items():
                others = self._name({contact: None})
                if based.get(contact) == others:  # the comparison stands
                    continue
                verdicts[contact], based[contact] = self._compared(joint, contact), others
                taken = verdicts[contact].closest.name
                self.chosen[contact] = next(one for one in self.specs[contact] if one.name == taken)
            settled = self._name() == before
            if settled or self._name() in seen or sweep == SWEEPS or self.stopped:
                break
            seen.append(self._name())
        return self._concluded(verdicts, sweep, settled=settled and not self.stopped)

    def _name(self, changes: Mapping[str, CandidateSpec | None] | None = None) -> str:
        return combination_of({**self.chosen, **(changes or {})})

    def _compared(self, joint: str, contact: str) -> RecordVerdict:
        """Return the verdict on one joint, the laws of the others being those chosen so far."""
        work = partial(
            _fitted,
            fitter=self.fitter,
            chosen=dict(self.chosen),
            contact=contact,
            now=self.fits[self._name()],
            starts=_starts(self.asked, [contact]),
        )
        watch = self.watch and partial(_by_joint, self.watch, joint, self)
        found = climbed(
            self.specs[contact],
            work,
            watch,
            self.executor,
            seen=lambda tried, specs: with_contained(
                [self._alone(one, joint, contact) for one in tried], specs
            ),
            at_noise=lambda _: False,  # of one among several joints there is no estimate
            usual=self.usual and contact not in self.asked,
        )
        tried, specs = found.tried, found.specs
        judge = partial(with_scores, plan=self.plan, validate=self.validate)
        without = _without(work)
        every = [*tried, *([without] if without else [])]
        if self.watch is not None:
            self.watch(f"held-out blocks: {joint}", math.nan)
        run = map if self.executor is None else self.executor.map
        scored = list(run(judge, every))
        views = [with_objections(self._alone(one, joint, contact)) for one in scored]
        for one, spec in zip(scored, specs, strict=False):
            laws = {**self.chosen, contact: spec}
            if one.fit is not None:
                named = replace(one, name=combination_of(laws), title=_title(laws))
                self.fits[named.name] = _told(named, laws, self.asked)
        asked = self.asked.get(contact)
        judged = [
            one if asked is None else with_errors(one, asked, views, usual=self.usual)
            for one in views[: len(tried)]
        ]
        judged = with_contained(judged, specs)
        own = self.records[contact]
        verdict = verdict_on(
            self.fitter.mechanism,
            own[0][0],
            judged,
            views[-1] if without else None,
            self.plan,
            replace(self.checks, findings=()),
            own[1][0] if len(own) > 1 else None,
            fault=self._fault(),
            material=APART,
            shown=self.scales[own[0][0].unit("force")],
            asked=asked,
        )
        return replace(verdict, usual=self.usual, untried=found.untried, why_untried=found.why)

    def _fault(self) -> str:
        """Return why no law can be recommended at any joint; empty if nothing is known."""
        text = self.fitter.wrong_columns
        return text[:1].lower() + text[1:].rstrip(".")

    def _alone(self, one: RecordCandidate, joint: str, contact: str) -> RecordCandidate:
        """Return a candidate with all that is of one joint."""
        if one.fit is None:
            return one
        fit = joint_view(cast("Any", one.fit), contact, records=self.records[contact])
        prefix = f"friction.{contact}."
        gone = [path for path in one.left_out if path.startswith(prefix)]
        return replace(
            one,
            fit=fit,
            left_out=tuple(path.replace(prefix, "friction.", 1) for path in gone),
            validation=one.validation and one.validation.joints.get(joint),
            second=one.second and one.second.joints[joint],
        )

    def _concluded(
        self, verdicts: Mapping[str, RecordVerdict], sweeps: int, *, settled: bool
    ) -> JointVerdict:
        named = self._name()
        best = self.fits[named]
        sound = all(one.best is not None for one in verdicts.values())
        known = [one for one in self.fits.values() if math.isfinite(one.score)]
        ordered = sorted(known, key=lambda one: (one.name != named, one.score))
        outcomes = [replace(one, outcome=_outcome(one, best, recommended=sound)) for one in ordered]
        best = outcomes[0]
        verdict = JointVerdict(
            mechanism=self.fitter.mechanism,
            measurement=self.fitter.measurement,
            words=joint_wording(
                verdicts,
                sweeps,
                settled=settled,
                checks=self.checks,
                compared=len(known),
                resting=self.fitter.resting,
                assumptions=best.fit.assumptions if best.fit else (),
            ),
            candidates=tuple(outcomes),
            ranked=True,
            best=best if sound else None,
            not_recommended=None if sound else best,
            checks=self.checks,
            joints=dict(verdicts),
            sweeps=sweeps,
            settled=settled,
            usual=self.usual,
            plan=self.plan,
            second=self.validate,
            settings=self.fitter.settings,
        )
        return verdict


def _outcome(one: RecordCandidate, best: RecordCandidate, *, recommended: bool) -> str:
    if one.name == best.name:
        return "chosen" if recommended else "fits best, not recommended"
    pairs = zip(one.name.split(","), best.name.split(","), strict=True)
    changed = [own for own, other in pairs if own != other]
    return f"differs from the choice at {len(changed)} joint{'s' if len(changed) > 1 else ''}"


def _size(one: CandidateSpec) -> int:
    """Return how many parameters of a law are looked for."""
    kind = one.law if isinstance(one.law, type) else type(one.law)
    return len(kind.fit_order if one.free is None else one.free)


def _title(chosen: Chosen) -> str:
    return ", ".join(f"{one.title} ({contact})" for contact, one in chosen.items())


def _simplest(specs: Mapping[str, tuple[CandidateSpec, ...]]) -> list[str]:
    """Return the names of the laws with the fewest parameters, of all joints."""
    every = {one.name: one for own in specs.values() for one in own}
    least = min(map(_size, every.values()))
    return [name for name, one in every.items() if _size(one) == least]


def _begun(
    specs: Mapping[str, tuple[CandidateSpec, ...]],
    asked: Mapping[str, Explained],
    simplest: str,
    *,
    usual: bool,
) -> dict[str, CandidateSpec]:
    """Return the laws that a search begins with."""
    return {
        contact: (
            own[0]
            if usual and contact in asked
            else next((one for one in own if one.name == simplest), min(own, key=_size))
        )
        for contact, own in specs.items()
    }


def _starts(asked: Mapping[str, Explained], contacts: Iterable[str]) -> dict[str, FittedLaw]:
    """Return where searches of the laws of contacts begin, by contact and law."""
    found = {}
    for contact in contacts:
        for name, one in asked[contact].starts.items() if contact in asked else ():
            values = {
                path.replace("friction.", f"friction.{contact}.", 1): value
                for path, value in one.values.items()
            }
            laws = Laws(members=((contact, one.law),))
            found[f"{contact}={name}"] = replace(one, law=cast("Any", laws), values=values)
    return found


def _begin(fitter: JointFitter, chosen: Chosen, asked: Mapping[str, Explained]) -> RecordCandidate:
    """Return the first combination, fitted; one that cannot be fitted is kept with the reason."""
    name, title = combination_of(chosen), _title(chosen)
    starts = _starts(asked, chosen)
    keys = [f"{contact}={one.name}" for contact, one in chosen.items()]
    near = [starts[key] for key in keys if key in starts]
    try:
        fit = fitter.fitted(chosen, contained=near)
    except (ConvergenceError, SimulationError) as error:
        return RecordCandidate(
            name=name, title=title, fit=None, validation=None, dropped=str(error)
        )
    return RecordCandidate(name=name, title=title, fit=cast("Any", fit), validation=None)


def _told(one: RecordCandidate, laws: Chosen, asked: Mapping[str, Explained]) -> RecordCandidate:
    """Return a combination with what the force balances say is wrong with it."""
    assert one.fit is not None
    fit = cast("RecordFit[Laws]", one.fit)
    known = [
        error.at(contact)
        for contact, own in asked.items()
        for error in own.errors_of(
            laws[contact].name, fit.law[contact], joint_view(fit, contact).rms
        )
    ]
    return replace(one, fit=replace(one.fit, known_errors=tuple(known)))


def _without(work: Callable[[CandidateSpec], RecordCandidate]) -> RecordCandidate | None:
    """Return the fit without friction of a joint; None where it has nothing to look for."""
    try:
        return work(control())
    except InputError:
        return None


def _by_joint(watch: Watch, joint: str, descent: _Descent, name: str, residual: float) -> object:
    """Tell of a law at a joint, and note that the search was ended."""
    answer = watch(f"{joint}: {name}", residual)
    descent.stopped |= answer is False
    return answer


def _fitted(
    one: CandidateSpec,
    contained: Sequence[FittedLaw] = (),
    rival: float = 0.0,  # noqa: ARG001  # fits along the motion are not cut short
    watch: Watch | None = None,
    *,
    fitter: JointFitter,
    chosen: Chosen,
    contact: str,
    now: RecordCandidate,
    starts: Mapping[str, FittedLaw],
) -> RecordCandidate:
    """Fit one candidate at a joint, the others' laws as chosen; keep one that fails with why."""
    if one.name == chosen[contact].name:
        return replace(now, name=one.name, title=one.title, validation=None, second=None)
    near = cast("RecordFit[Laws]", now.fit)
    prefix = f"friction.{contact}."
    kept = tuple(path for path in now.left_out if not path.startswith(prefix))
    if watch is not None and watch(one.name, math.nan) is False:
        return unfitted(one, LEFT_OUT)
    report = None if watch is None else partial(watch, one.name)
    work = partial(fitter.fitted, near=near, changed=contact, progress=report)
    begin = starts.get(f"{contact}={one.name}")
    contained = (*contained, *([] if begin is None else [begin]))
    try:
        fit = work({**chosen, contact: one}, contained=contained)
        rest = without_spare(joint_view(fit, contact))
        if rest is not None:
            law, free = rest
            less = replace(one, law=law, free=tuple(path.partition(".")[2] for path in free))
            before, fit = fit, work({**chosen, contact: less})
            left = fit.free_parameters.paths
            kept += tuple(path for path in before.free_parameters.paths if path not in left)
    except (ConvergenceError, SimulationError) as error:
        return unfitted(one, str(error))
    return RecordCandidate(
        name=one.name,
        title=one.title,
        fit=cast("Any", fit),
        validation=None,
        left_out=kept,
    )

"""Selection for several joints: each is judged by its own balance, as a record of one coordinate.

Links that are looked for are found before, from all joints at once
(:mod:`~stickslip.identify.problems.joints`).
"""

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import block_diag

from stickslip.data import (
    Checks,
    Finding,
    LawEstimates,
    Measurement,
    levels_at,
    refuse_faults,
    refuse_same,
    refuse_unused,
    volts_sentence,
    with_doubts,
)
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw, Laws, assigned
from stickslip.identify.bands import Array, Foreseen, PredictionBand
from stickslip.identify.candidates import Candidate, Verdict, Wording, in_sentence
from stickslip.identify.compared import LawsToCompare, laws_for, with_own_laws
from stickslip.identify.fits import (
    MOST,
    OFFSET,
    Estimate,
    Fit,
    RecordSettings,
    check_inputs,
    estimates_for,
    load_of,
    names_of,
)
from stickslip.identify.fitting import NoLawError, fitted_law
from stickslip.identify.joint_request import JOINTS, JointRequest, suspected
from stickslip.identify.page import (
    figure_section,
    laws_section,
    parameters_section,
    run_section,
)
from stickslip.identify.problems.joint_motions import joint_record, resting_of
from stickslip.identify.problems.joints import JointRecords, Links
from stickslip.identify.problems.links import JointBalances, told_links
from stickslip.identify.problems.record_signals import NotToldError, Record
from stickslip.identify.selection import (
    checked,
    problem_of_records,
    record_verdict,
)
from stickslip.identify.verdict import BandVerdict, LawFit
from stickslip.mechanisms import LINKS, Axis, Mechanism, as_rotary
from stickslip.quantities import parameters
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import capital, parameter_words, percent, with_unit
from stickslip.show.report import (
    KeyValue,
    KeyValues,
    Origin,
    Paragraph,
    Section,
    SectionMaker,
    opening,
    record_and_checks,
    reproduce,
)

if TYPE_CHECKING:
    from stickslip.show.display import Drawing, Target


REST = "The joint {} rests throughout: its friction is not identified. Record it moving."
"""Sentence on a joint that rests."""


class _OfJoints:
    """What is judged joint by joint."""

    measurement: Measurement
    joints: Mapping[str, BandVerdict]

    def predict(self, measurement: Measurement) -> dict[str, Foreseen]:
        """Return readings of another measurement beside their 95 % band, by contact.

        Parameters
        ----------
        measurement : Measurement
            Positions and forces of the joints in another run.

        Returns
        -------
        dict of str to Foreseen
            Force at the rows of each joint that moves, its band, the share in it, and the error.

        Raises
        ------
        InputError
            If no joint of the fit moves in it, or it has the same readings.
        """
        refuse_same(self.measurement, measurement)
        result, resting = dict[str, Foreseen](), list[str]()
        for name, joint in self.joints.items():
            try:
                result[name] = joint.foreseer(measurement)
            except NotToldError as error:
                resting.append(str(error))
        if not result:
            raise InputError(" ".join(resting))
        return result


@dataclass(frozen=True, kw_only=True, repr=False)
class JointLawFit(_OfJoints, Fit[Laws]):
    """The laws of all joints and the mechanism, with their intervals."""

    measurement: Measurement
    """What was measured."""
    joints: Mapping[str, BandVerdict]
    """Verdicts by contact."""
    fits: Mapping[str, LawFit]
    """Fits by contact."""
    verdict: "JointVerdict | None" = None
    """What is said of the fit: the verdict with these laws alone; None in a verdict."""
    untold: tuple[str, ...] = ()
    """Why joints and parameters of the mechanism have no values, in sentences."""

    @property
    def sentences(self) -> tuple[str, ...]:
        said = () if self.verdict is None else self.verdict.words.cannot_tell
        return (*self.untold, *said)

    def law_estimates(self) -> LawEstimates:
        fits = self.fits
        parts = [np.eye(len(self.estimates) - sum(len(fit.estimates) for fit in fits.values()))]
        parts += [fit.correlation for fit in fits.values()]
        return estimates_for(
            self.law,
            self.estimates,
            block_diag(*parts),
            levels=levels_at(self.mechanism),
            largest_speed={name: fit.largest_speed for name, fit in fits.items()},
        )

    def _plot(self, ax: "Target") -> "Drawing":
        return next(iter(self.joints.values())).plot(ax)

    def __str__(self) -> str:
        return f"{self.law.title}: {', '.join(map(str, self.shown))}"


@dataclass(frozen=True, kw_only=True, repr=False)
class JointVerdict(_OfJoints, Verdict[Candidate[JointLawFit]]):
    """A verdict on each of several joints, and the mechanism that goes with them."""

    joints: Mapping[str, BandVerdict]
    """By contact."""
    resting: tuple[str, ...]
    """Coordinates that rest throughout: nothing tells their friction."""

    @property
    def route(self) -> str:
        return JOINTS

    @property
    def score_unit(self) -> str:
        units = {joint.score_unit for joint in self.joints.values()}
        return units.pop() if len(units) == 1 else ""

    @property
    def law(self) -> Laws:
        """The named laws by contact."""
        fit = self.candidates[0].fit
        assert fit is not None
        return fit.law

    def of(self, joint: str) -> BandVerdict:
        """Return the verdict on a joint, by the name of its contact.

        Raises
        ------
        InputError
            If no joint of that name was judged.
        """
        if joint not in self.joints:
            raise InputError(f"joint must be {' or '.join(self.joints)}, got {joint!r}.")
        return self.joints[joint]

    def band(
        self,
        velocity: Array | Sequence[float] | float,
        *,
        joint: str,
        level: float = 0.95,
        all_along: bool = False,
    ) -> PredictionBand:
        """Return what friction of a joint is at velocities, over all candidate laws.

        Parameters
        ----------
        velocity : array_like (n,)
            Velocities of the joint [rad/s] or [m/s].
        joint : str
            Name of its contact.
        level : float
            Probability with which friction at each velocity lies in the band.
        all_along : bool
            Whether that is the probability that it lies in the band at all of them together.

        Returns
        -------
        PredictionBand
            Limits and median (n,) [N m] or [N].

        Raises
        ------
        InputError
            If no joint of that name was judged.
        """
        return self.of(joint).band(velocity, level=level, all_along=all_along)

    def sample(self, count: int = 20, *, seed: int = 0) -> list[Laws]:
        """Return laws of all joints, drawn over their sets with their covariances.

        Parameters
        ----------
        count : int
            Number of draws.
        seed : int
            Seed of the draws.

        Returns
        -------
        list of Laws
            Laws by contact; those of one joint are drawn without regard to another.
        """
        drawn = {name: joint.sample(count, seed=seed + k)
                 for k, (name, joint) in enumerate(self.joints.items())}  # fmt: skip
        return [
            _laws(self.mechanism, {n: item[k] for n, item in drawn.items()}) for k in range(count)
        ]

    def _details(self) -> Mapping[str, Any]:
        return {
            "joints": {name: joint.to_dict() for name, joint in self.joints.items()},
            "resting": list(self.resting),
        }

    @staticmethod
    def schema() -> Mapping[str, Any]:
        """Return the JSON schema of `to_dict`, and of ``verdict.json`` with its heading.

        Returns
        -------
        mapping
            JSON schema of draft 2020-12; verdicts on joints are as `BandVerdict.schema` says.
        """
        text = files("stickslip.identify").joinpath("joints.schema.json").read_text("utf-8")
        result: dict[str, Any] = json.loads(text)
        of_joint = dict(BandVerdict.schema())
        return result | {"$defs": {**of_joint.pop("$defs"), "joint": of_joint}}

    def _plot(self, ax: "Target") -> "Drawing":
        return self.candidates[0].fit.plot(ax)  # type: ignore[union-attr]


def select_joints(
    mechanism: Mechanism,
    laws: Any,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    validate: Measurement | None = None,
    tolerance: float | None = None,
    settings: RecordSettings | None = None,
) -> JointVerdict:
    """Judge records of several joints: which law each has, and what its friction is."""
    judge = _JointJudge.of(
        mechanism, "viscous", measurement, vary=vary, fixed=fixed, settings=settings,
        validate=validate, tolerance=tolerance,
    )  # fmt: skip
    joints = {judge.records.contacts[name]: judge.verdict_of(name, laws) for name in judge.own}
    fits = {name: joint.closest.fit for name, joint in joints.items() if joint.closest.fit}
    return _verdict(judge, joints, fits)


def fit_joints(
    mechanism: Mechanism,
    laws: Any,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    settings: RecordSettings | None = None,
) -> JointLawFit:
    """Fit the laws of several contacts, and parameters of the mechanism.

    Friction along each joint is the applied force less what the motion takes. A constant force of
    a joint is found too where the record shows one, unless it is fixed or positions count from a
    zero of each record. A joint that rests, or shows no friction, has no law: `sentences` say so.

    Examples
    --------
    >>> from stickslip import CoulombViscous, TwoLinkArm
    >>> from stickslip.engine.formulation import JointTorques
    >>> t = np.linspace(0.0, 10.0, 2001)
    >>> upper, bend = np.sin(5.0 * t), 0.8 * np.sin(7.3 * t)
    >>> arm = TwoLinkArm(
    ...     upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    ...     lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03, gravity=0.0,
    ... )  # fmt: skip
    >>> rates = np.column_stack([5.0 * np.cos(5.0 * t), 0.8 * 7.3 * np.cos(7.3 * t)])
    >>> places = np.column_stack([upper, bend])
    >>> takes = JointTorques.of(arm, [])
    >>> forces, _ = takes.along(arm, t, places, rates, places * [-25.0, -(7.3**2)])
    >>> forces = forces + np.sign(rates) * [0.3, 0.1]
    >>> record = Measurement(
    ...     time=t,
    ...     position={"shoulder": upper, "elbow": bend},
    ...     force={"shoulder": forces[:, 0], "elbow": forces[:, 1]},
    ... )
    >>> both = {"shoulder": CoulombViscous, "elbow": CoulombViscous}
    >>> found = fit_joints(arm, both, record, vary=["friction.*", "upper_inertia"])
    >>> round(found.law["elbow"].kinetic_coefficient, 2)
    0.1
    """
    judge = _JointJudge.of(mechanism, laws, measurement, vary=vary, fixed=fixed, settings=settings)
    asked = judge.request
    joints, fits = dict[str, BandVerdict](), dict[str, LawFit]()
    untold = list(judge.untold)
    of_mechanism = bool(judge.paths) and not any(asked.free.values())
    for name in judge.own:
        contact = judge.records.contacts[name]
        law = asked.laws.get(contact)
        held = isinstance(law, FrictionLaw) and not asked.free[contact]
        if law is None or (held and not of_mechanism):
            continue
        check_inputs(
            law, mechanism, measurement, [*judge.own[name][0].inputs],
            contact=contact, fitted=judge.paths,
        )  # fmt: skip
        try:
            fit = fitted_law(
                partial(judge.verdict_of, name),
                law,
                free=asked.free[contact],
                known=asked.known.get(contact, {}),
                load=load_of(judge.alone(name)),
                unknown=judge.paths if of_mechanism else (),
            )
        except (NoLawError, NotToldError) as error:
            untold.append(f"The joint {contact} has no law. {capital(str(error))}")
            continue
        assert fit.verdict is not None
        joints[contact], fits[contact] = fit.verdict, fit
    if not fits:
        raise InputError(
            " ".join(untold)
            or "there is nothing to fit: give the law of a joint that moves, not all of it held."
        )
    still = {name: law for name, law in asked.laws.items() if isinstance(law, FrictionLaw)}
    verdict = _verdict(judge, joints, fits, still)
    fitted = verdict.closest.fit
    assert fitted is not None
    return replace(fitted, verdict=verdict, untold=tuple(untold))


@dataclass(frozen=True, kw_only=True, eq=False)
class _JointJudge:
    """Records of several joints, each as that of one coordinate with the others' motion known."""

    mechanism: Mechanism
    """Mechanism that was measured."""
    measurement: Measurement
    request: JointRequest
    settings: RecordSettings
    balances: JointBalances
    again: "_Again"
    """Makes records of another measurement."""
    own: Mapping[str, Sequence[Record]]
    """Records of each joint that moves, by coordinate."""
    checks: Checks
    wrong: str
    """Which columns seem to be exchanged, in a sentence; empty if none."""
    validate: Measurement | None = None
    moved: frozenset[str] = frozenset()
    """Joints that move in the second measurement."""
    tolerance: float | None = None

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        laws: Any,
        measurement: Measurement,
        *,
        vary: str | Sequence[str] | None,
        fixed: Mapping[str, float] | None,
        settings: RecordSettings | None,
        validate: Measurement | None = None,
        tolerance: float | None = None,
    ) -> "_JointJudge":
        """Return the records of a measurement, with the links that all joints tell together."""
        settings = settings or RecordSettings()
        held, zeros = settings.hold != "first", bool(settings.position_zeros)
        resting_of(mechanism, measurement)  # refuses records that lack a joint
        if vary is not None and LINKS in names_of(vary):
            mechanism, links = told_links(mechanism, measurement, held=held, zeros=zeros)
            vary = [*(item for item in names_of(vary) if item != LINKS), *links]
        request = JointRequest.of(mechanism, laws, vary, fixed, measurement, zeros=zeros)
        refuse_unused(measurement)
        refuse_faults(measurement, request.mechanism)
        with with_doubts(measurement, request.mechanism):
            balances = JointBalances.of(
                request.mechanism, measurement, request.linear, held=held, zeros=zeros
            )
        checks = checked(mechanism, measurement, validate)
        if said := _wrong_columns(request, measurement, balances.links.left, held=held):
            wrong = Finding(kind="joint columns", sentence=said, severity="warning")
            checks = replace(checks, findings=(wrong, *checks.findings))
        again = _Again(balances.made, balances.links, held=held)
        seen = set[str]() if validate is None else {*again.records(validate)}
        return cls(
            mechanism=mechanism, measurement=measurement, request=request, settings=settings,
            balances=balances, again=again, own=balances.records.at(balances.links, held=held),
            checks=checks, wrong=said, validate=validate, moved=frozenset(seen),
            tolerance=tolerance,
        )  # fmt: skip

    @property
    def records(self) -> JointRecords:
        """Records of all joints."""
        return self.balances.records

    @property
    def links(self) -> Links:
        """What they tell of parameters."""
        return self.balances.links

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths of what is looked for of the mechanism."""
        return self.request.linear

    @property
    def untold(self) -> tuple[str, ...]:
        """What is not told of joints that rest and of the mechanism, in sentences."""
        known = {path: q for path, q, _ in parameters(self.balances.mechanism, "mechanism")}
        lost = [
            f"the {parameter_words(path)} ({known[path].symbol})"
            for path in self.paths
            if math.isinf(self.links.errors[path])
        ]
        return (
            *(REST.format(name) for name in self.records.resting),
            *(
                f"{capital(item)} is not identified: the motion cannot distinguish it from others."
                for item in lost
            ),
        )

    def alone(self, name: str) -> Mechanism:
        """Return a joint as an axis."""
        return _alone(self.balances.mechanism, name, self.records.inertias[name])

    def verdict_of(self, name: str, laws: Any) -> BandVerdict:
        """Return the verdict on a joint."""
        alone, measurement, mechanism = self.alone(name), self.measurement, self.mechanism
        given = self.request.offsets.get(name)
        own = [*self.own[name]]
        if given is not None:
            own = [replace(item, force=item.force - given, constant=given) for item in own]
        # forces of another joint may follow none of the laws
        asked = LawsToCompare() if self.wrong else laws_for(laws, own, load_of(alone))
        judged = problem_of_records(
            alone, own, offset=given is None, families=asked.alone, turning="rad" in alone.units,
            highest=self.records.widest, timed=self.settings.hold is not None,
        )  # fmt: skip
        volts = volts_sentence(f"force.{name}")
        findings = (x for x in self.checks.findings if x.kind != "volts" or x.sentence == volts)
        return record_verdict(
            with_own_laws(judged, asked),
            alone,
            joint_record(mechanism, measurement, name),
            offset=not asked.fitted,  # joints have no constant force
            tolerance=self.tolerance,
            checks=replace(self.checks, findings=tuple(findings)),
            route=JOINTS,
            second=self.validate and joint_record(mechanism, self.validate, name),
            other=self.validate if name in self.moved else None,
            again=partial(self.again.of, name),
        )


def _wrong_columns(
    request: JointRequest, measurement: Measurement, left: float, *, held: bool
) -> str:
    """Return which signals would explain the forces if exchanged or converted, as a sentence.

    Looked for where balances leave most of the force of some joint; empty elsewhere, and if none
    takes most of that away.
    """
    if left < MOST:
        return ""
    result = []
    for finding, other in suspected(measurement, request.mechanism):
        try:
            seen = JointBalances.about(
                request.mechanism, other, request.linear, resting_of(request.mechanism, other),
                held=held, zeros=request.zeros,
            )  # fmt: skip
        except InputError:
            continue
        result.append((seen.links.left, finding))
    least, finding = min(result, default=(math.inf, ""))
    if least > MOST * min(left, 1.0):
        return ""
    falls = (
        f"what the mechanism does not explain of the forces falls from {percent(left)}"
        f" to {percent(least)}"
    )
    return finding.replace("{falls}", falls)


class _Again:
    """Makes records of joints in another measurement, once for all of them.

    Parameters
    ----------
    made : callable
        Makes the records of a measurement.
    links : Links
        What is told of parameters.
    held : bool
        Whether forces hold until the next sample.
    """

    def __init__(
        self, made: Callable[[Measurement], JointRecords], links: Links, *, held: bool
    ) -> None:
        self._made, self._links, self._held = made, links, held
        self._last: tuple[Measurement, Mapping[str, Sequence[Record]]] | None = None

    def records(self, measurement: Measurement) -> Mapping[str, Sequence[Record]]:
        """Return the records of the joints that move, by coordinate."""
        if self._last is None or self._last[0] is not measurement:
            made = self._made(measurement).at(self._links, held=self._held, again=True)
            self._last = measurement, made
        return self._last[1]

    def of(self, name: str, measurement: Measurement) -> Sequence[Record]:
        """Return the records of a joint."""
        result = self.records(measurement)
        if name not in result:
            raise NotToldError(f"the {name} does not move in the other measurement.")
        return result[name]


def _alone(mechanism: Mechanism, coordinate: str, inertia: float) -> Mechanism:
    """Return a joint as an axis, whose law has the same levels."""
    contact = next(item for item in mechanism.contacts() if item.slips[0] == coordinate)
    load = contact.load if isinstance(contact.load, int | float) else 1.0
    axis = Axis(inertia=max(inertia, 1e-300), load=float(load))
    turns = mechanism.units[mechanism.coordinates.index(coordinate)] == "rad"
    return as_rotary(axis) if turns else axis


def _values(mechanism: Mechanism, links: Links, paths: Sequence[str]) -> tuple[Estimate, ...]:
    """Return the parameters of the mechanism that were found."""
    known = {path: (q, value) for path, q, value in parameters(mechanism, "mechanism")}
    result = []
    for path in paths:
        q, given = known[path]
        value = given + links.change[path]
        half = 1.96 * links.errors[path]
        least = q.low if q.above is None else max(q.low, q.above)
        told = math.isfinite(half)
        result.append(
            Estimate(
                path=path, quantity=q, value=value, low=max(value - half, least),
                high=min(value + half, q.high), interval="95 %",
                reason="" if told else "the motion cannot distinguish it from others",
            )
        )  # fmt: skip
    return tuple(result)


def _laws(mechanism: Mechanism, laws: Mapping[str, FrictionLaw]) -> Laws:
    """Return laws by contact, none where a joint rests."""
    names = tuple(contact.name or contact.slips[0] for contact in mechanism.contacts())
    result = assigned(names, dict.fromkeys(names) | dict(laws))
    return result if isinstance(result, Laws) else Laws(members=tuple(laws.items()))


def _verdict(
    judge: _JointJudge,
    joints: Mapping[str, BandVerdict],
    fits: Mapping[str, LawFit],
    still: Mapping[str, FrictionLaw] = MappingProxyType({}),
) -> JointVerdict:
    """Return the verdict on all joints, in words; `still` are given laws of those that rest."""
    rig, records, checks = judge.balances.mechanism, judge.records, judge.checks
    mechanism, measurement = judge.mechanism, judge.measurement
    values = _values(rig, judge.links, judge.paths)
    along = {contact: name for name, contact in records.contacts.items()}
    of_joints = [
        replace(
            estimate,
            path=OFFSET + along[name]
            if estimate.path == "offset"
            else estimate.path.replace("friction.", f"friction.{name}.", 1),
        )
        for name, fit in fits.items()
        for estimate in fit.estimates
        # beside zeros that are not known, levels by direction may be one of them
        if estimate.path != "offset" or name not in judge.request.offsets
    ]
    try:
        moved = with_values(rig, "mechanism", {value.path: value.value for value in values})
    except ParameterError:  # what the motion tells is no links one by one: those of the fit are
        moved = rig
    fitted = JointLawFit(
        law=_laws(mechanism, {**still, **{name: fit.law for name, fit in fits.items()}}),
        mechanism=moved,
        measurement=measurement,
        estimates=(*values, *of_joints),
        remarks=tuple(dict.fromkeys(line for fit in fits.values() for line in fit.remarks)),
        joints=joints,
        fits=fits,
    )
    candidate: Candidate[JointLawFit] = Candidate(
        name=",".join(f"{name}={joint.closest.name}" for name, joint in joints.items()),
        title=", ".join(
            f"{name}: {in_sentence(joint.closest.title)}" for name, joint in joints.items()
        ),
        fit=fitted,
        outcome="named",
    )
    wrong = checks.of("joint columns")
    said = [
        f"{capital(name)}: {in_sentence(joint.words.verdict)}" for name, joint in joints.items()
    ]
    said += [f"{capital(name)}: at rest, so its friction is unknown." for name in records.resting]
    named = not wrong and all(joint.best is not None for joint in joints.values())
    words = Wording(
        verdict=f"No law is recommended. {wrong[0].sentence}" if wrong else " ".join(said),
        lede=" ".join(
            f"{capital(n)}: {in_sentence(joint.words.lede)}" for n, joint in joints.items()
        ),
        settles=_of_each(joints, "settles"),
        cannot_tell=_of_each(joints, "cannot_tell"),
        measure_next=_of_each(joints, "measure_next"),
        no_score="",
    )
    return JointVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=words,
        candidates=(candidate,),
        best=candidate if named else None,
        ranked=True,
        joints=joints,
        resting=records.resting,
        checks=checks,
    )


def _of_each(joints: Mapping[str, BandVerdict], part: str) -> tuple[str, ...]:
    """Return sentences on each joint in turn; those of all joints alike once."""
    lines = {name: getattr(joint.words, part) for name, joint in joints.items()}
    common = set.intersection(*({*own} for own in lines.values()))
    result = [
        f"{capital(name)}: {in_sentence(line)}"
        for name, own in lines.items()
        for line in own
        if line not in common
    ]
    first = next(iter(lines.values()))
    return (*result, *(line for line in first if line in common))


def joint_sections(verdict: JointVerdict, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of the page of a verdict on several joints."""
    words = verdict.words
    if verdict.best is not None:  # the sentences on several joints are no headline
        words = replace(words, verdict=capital(verdict.closest.title), lede=words.verdict)
    return (
        partial(opening, words, origin.data, remark),
        *(
            partial(joint_section, name, joint, number)
            for number, (name, joint) in enumerate(verdict.joints.items(), 1)
        ),
        partial(mechanism_section, verdict),
        partial(record_and_checks, verdict.checks),
        partial(reproduce, origin, laws=[law for _, law in verdict.law.members]),
    )


def joint_section(name: str, verdict: BandVerdict, number: int) -> Section:
    """Return the band, the laws and the parameters of one joint."""
    parts = (
        run_section(verdict, prefix=f"joint-{number}-run"),
        figure_section(verdict, prefix=f"joint-{number}"),
        laws_section(verdict, with_caption=number == 1),
        parameters_section(verdict, with_caption=number == 1),
    )
    blocks = (block for part in parts if part for block in part.blocks)
    return Section(
        id=f"joint-{number}",
        nav=capital(name),
        heading=f"{capital(name)}: {in_sentence(verdict.closest.title)}",
        blocks=(Paragraph(text=verdict.words.lede), *blocks),
    )


def mechanism_section(verdict: JointVerdict) -> Section | None:
    """Return what was found of the mechanism; None without anything."""
    fit = verdict.closest.fit
    assert fit is not None
    shown = [item for item in fit.shown if item.path.startswith("mechanism.")]
    if not shown:
        return None
    items = tuple(
        KeyValue(
            key=f"${item.quantity.symbol}$, {parameter_words(item.path)}",
            value=with_unit(item.range, item.quantity.unit),
        )
        for item in shown
    )
    return Section(
        id="mechanism", nav="Mechanism", heading="What was found of the mechanism",
        blocks=(KeyValues(items=items),),
    )  # fmt: skip

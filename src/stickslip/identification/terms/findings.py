"""What an explanation of a force balance says of the rig and of the record, as model errors."""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Final, final

import numpy as np

from stickslip.errors import InputError
from stickslip.evidence import (
    GEARS,
    LATE_OR_ELASTIC,
    SHOWN_LATE,
    Balance,
    Explanation,
    Fault,
    Fit,
    Rule,
    Series,
    Term,
    acceleration_noise,
    explain,
    fit,
    outliers,
    pieces,
    resolution,
    usual_band,
    vocabulary,
)
from stickslip.experiments import Measurement, check
from stickslip.formatting import (
    capital,
    number,
    parameter_words,
    percent,
    quantity,
    scale_of,
    with_unit,
    within,
)
from stickslip.formulation import JointTorques
from stickslip.friction import FrictionLaw
from stickslip.identification.results import UNSAID, ModelError
from stickslip.identification.series.inverse_dynamics import mass_of
from stickslip.identification.settings import Hold, SensorResponse
from stickslip.identification.terms.composed_laws import Asked
from stickslip.identification.terms.dense_series import (
    dense_series,
    is_dense,
    joints_series,
    loads_of,
    varies_load,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

NAMES: Final[Mapping[str, str]] = {
    "loose": "backlash",
    "flexible": "flexibility",
    "drift": "drift of the level",
    "offset_drift": "drift of the offset",
    "viscous_drift": "drift of the viscous part",
    "saturation": "force limit",
    "mass": "inertia",
    "ripple": "position force",
    "hum": "ripple in time",
    "skew": "clock",
}
"""Names of findings, where these are not those of the terms."""
SHIFTED: Final = {"late or elastic", *(NAMES.get(one, one) for one in (*LATE_OR_ELASTIC, "skew"))}
"""Names of findings that shift force against motion, as a hold does."""
OUTLIERS: Final = "outliers"
"""Name of the finding of samples far off those beside."""
HALF: Final = (0.35, 0.65)
"""Delays over the step of time which are those of a wrong setting of hold."""
ALIKE: Final = 0.999
"""Correlation from which a column of the mechanism is that of viscous friction."""
PAYS: Final = 0.95
"""Held-out error of presliding that is shown late, over that without, from which either may be
meant."""
NEARLY: Final = 1.5
"""Held-out error over that of presliding up to which a late channel may be meant instead."""
HOLDS: Final = 0.10
"""Share of the friction that may be left unexplained ..."""
WHITE: Final = 1.5
"""... or so many times the noise of the sensors in the band."""
OUTWEIGHS: Final = 2.0
"""Error without a level that grows with the torque of a gear, over that with it, below which such a
level is not named where much is left: errors of the links grow with torques, too."""
CORRECTED: Final = ("delay", "lag")
"""Kinds that settings correct for where friction is measured."""
PARTLY: Final = 0.025
"""Share of the friction from which what is left is said beside the law of the rest ..."""
FAR: Final = 4.0
"""... and so many times that noise."""
CALLED: Final[Mapping[str, str]] = {
    "delay": "a delay",
    "lag": "a filter of the force channel",
    "backlash": "backlash",
    "loose": "backlash",
    "flexible": "a flexible coupling",
    "spring": "a spring",
    "drift": "a drift of the friction level",
    "offset_drift": "a drifting force beside friction",
    "viscous_drift": "a drift of the viscous friction",
    "saturation": "saturation of the force",
    "mass": "another mass",
    "hum": "a ripple in time",
    "skew": "a drift between the clocks of force and position",
}
"""Kinds as nouns."""
MECHANICAL: Final = ("spring", "mass")
"""Kinds that look like given parameters of a mechanism of several joints if these are wrong."""
PARAMETERS: Final = ("parameters", "an error of the given parameters of the mechanism")
"""What these may look like instead: name and noun."""
CUT_OFF: Final = ("saturation", "more force than was recorded where it stays at its extreme")
"""What a fault may be instead that such samples alone ask for: name and noun."""


@final
@dataclass(frozen=True, kw_only=True)
class _Sized:
    """A fault with its size in words."""

    value: float
    """Its parameter, SI."""
    text: str
    """That, without a sign, with its unit and interval."""
    force: str
    """Root mean square of the force that it explains, with its unit."""
    half: str
    """What follows a delay: a colon, or that it may be a wrong setting of hold."""
    measured: bool
    """Whether friction itself was measured."""


def asked_of(
    mechanism: Mechanism,
    measurement: Measurement,
    hold: Hold,
    unknown: Sequence[str],
    response: SensorResponse,
    progress: Callable[[float, str], None] | None = None,
) -> Asked | None:
    """Return the laws that the force balance of a record asks for; None if it cannot be judged."""
    if not is_dense(mechanism, measurement):
        return None
    try:
        series = dense_series(mechanism, measurement, hold, unknown, response)
    except InputError:  # an unknown that is no coefficient of a column
        return None
    load = float(np.median(np.concatenate(loads_of(mechanism, measurement))))
    loaded = varies_load(mechanism, measurement)
    return _asked(series, load, mass_of(mechanism), None, progress, loaded=loaded)


def asked_of_joints(
    torques: JointTorques,
    mechanism: Mechanism,
    measurement: Measurement,
    hold: Hold,
    joints: Collection[str],
    progress: Callable[[str, float, str], None] | None = None,
) -> Mapping[str, Asked]:
    """Return the laws that the force balance of each joint asks for, of those that can be judged.

    Each joint is explained alone, beside columns by which the parameters of the mechanism that are
    looked for may differ for it: of several joints in one problem, the terms of one whose forces
    are small would not earn their place. Links are held as all joints together tell them: a block
    of one balance does not. The band is the least of all, as each balance has the accelerations of
    all joints, but not below that of the filter of their fits.
    """
    together = {path for path, one, _ in parameters(mechanism, "mechanism") if one.nuisance}
    if together.intersection(torques.linear):
        alone = [path for path in torques.linear if path not in together]
        torques = JointTorques.of(mechanism, alone, by_position=torques.by_position)
    every, loads, passed = joints_series(torques, mechanism, measurement, hold)
    own = {
        name: (series, load)
        for name, series, load in zip(torques.coordinates, every, loads, strict=True)
        if name in joints and series
    }
    bands = [usual_band([p for one in series for p in pieces(one)]) for series, _ in own.values()]
    fc, found = max([passed, min(bands, default=0.0)]), {}
    for name, (series, load) in own.items():
        told = None if progress is None else partial(progress, name)
        asked = _asked(series, load, series[0].mass, fc, told, loaded=True)
        if asked is not None:
            found[name] = asked
    return found


def _asked(
    series: Sequence[Series],
    load: float,
    mass: float | None,
    fc: float | None,
    progress: Callable[[float, str], None] | None,
    *,
    loaded: bool,
) -> Asked | None:
    """Return the laws of an explanation.

    Where inertia alone loads a gear (not `loaded`), it is named if hardly more than noise is left:
    torques of impacts in a gap or a coupling are in proportion to accelerations, too.
    """
    try:
        found = explain(series, fc=fc, progress=progress)
        doubtful = _leaves_much if loaded else _leaves_more_than_noise
        if _has_gear(found.best) and doubtful(found):
            plain = [one for one in vocabulary(found.balance) if one.kind not in GEARS]
            other = explain(found.balance, vocabulary=plain, progress=progress)
            if not loaded or other.best.rms < OUTWEIGHS * found.best.rms:
                found = replace(other, ties=(*other.ties, found.best))
    except InputError:
        return None
    asked = Asked.of(found, found.balance.references.get("load", load), mass)
    return asked if asked.laws else None


def _has_gear(one: Fit) -> bool:
    return any(term.kind in GEARS for term in one.structure.terms)


def _leaves_much(found: Explanation) -> bool:
    """Whether much is left that no law and no fault explains, and that is no noise."""
    return found.left > HOLDS and _leaves_more_than_noise(found)


def _leaves_more_than_noise(found: Explanation) -> bool:
    return found.best.rms > WHITE * noise_left(found)


def errors_of(
    asked: Asked, law: FrictionLaw, name: str, errors: Sequence[ModelError], unit: str
) -> tuple[ModelError, ...]:
    """Return what is wrong with rig and record, and which law the balance asks for instead."""
    own = None if name == asked.best.name else asked.fit_of(name, law)
    if own is None or not asked.rejects(own):
        return tuple(errors)
    return (*errors, _law_asked_for(asked, own, unit))


def _law_asked_for(asked: Asked, own: Fit, unit: str) -> ModelError:
    """Return that the force balance asks for another law."""
    best = asked.fits[asked.best.name]
    scale = scale_of([own.rms, best.rms], unit)
    title = asked.best.specification.title
    return ModelError(
        kind="law",
        finding=(
            f'The force balance asks for another law, {title} ("{asked.best.text}"): held-out error'
            f" {scale.error(best.rms)} instead of {scale.error(own.rms)}."
        ),
        consequence="Values of this law hold for motions like the recorded one only.",
        effect=own.rms - best.rms,
        interval=(math.nan, math.nan),
        share=1.0 - (best.rms / own.rms) ** 2,
    )


def model_errors(
    found: Explanation, measurement: Measurement, hold: Hold, response: SensorResponse
) -> tuple[ModelError, ...]:
    """Return the faults of an explanation, the largest first, and forces that no law has.

    Where much is left unexplained no cause is named, as that of the nearest structure would be a
    guess, but that something is late or elastic if this explains more than is left: not where
    the position jumps, as after lost samples, and forces would too.
    """
    far = _fitted_outliers(found.balance, measurement)
    others = any(one.taken is not None for one in found.balance.series)
    error = partial(_error, measurement=measurement, hold=hold, response=response)
    if _leaves_much(found):
        group = [_any_of(one) for one in found.faults if one.kinds[0] in LATE_OR_ELASTIC]
        if group and check(measurement).of("jump"):
            group = []
        larger = [error(one) for one in group if one.size > found.best.rms]
        return (*larger, _unexplained(found, measurement), *far)
    instead = _late_instead(found, measurement, response)
    inside = _inside(found, measurement) if found.faults else None

    def beside(fault: Fault) -> tuple[str, str] | None:
        if others and fault.kinds[0] in MECHANICAL:
            return PARAMETERS
        return None if _remains(inside, found, fault) else CUT_OFF

    errors = [
        error(one, instead=beside(one))
        for one in found.faults
        if instead is None or not {*one.kinds} & {*CORRECTED}  # one cause, said once
    ]
    errors += [
        _ripple(found, term, measurement)
        for term in found.best.structure.free
        if term.kind in {"ripple", "imbalance"} and _earned(found, term)
    ]
    errors += [
        one
        for one in (
            instead,
            _constant_level(found, measurement),
            _partly(found, measurement),
            _damped(found, measurement),
        )
        if one is not None
    ]
    return (*sorted(errors, key=lambda one: -one.share), *far)


def _inside(found: Explanation, measurement: Measurement) -> Balance | None:
    """Return the balance without the samples at which a force stays at its extreme, if any do."""
    told = [x.numbers for x in check(measurement).of("saturation") if "share" in x.numbers]
    if not told or len(found.balance.channels) > 1:
        return None
    ends = {one["end"] for one in told}
    return found.balance.inside(largest=1.0 in ends, smallest=-1.0 in ends)


def _remains(inside: Balance | None, found: Explanation, fault: Fault) -> bool:
    """Whether a fault earns its place without the samples at which the force stays at an end.

    Where they are nearly all, what is left has too few blocks to tell.
    """
    if inside is None:
        return True
    best = without = found.best.structure
    for term in best.faults:
        without = without.without(term) if term.kind in fault.kinds else without
    return Rule().better(fit(inside, best), fit(inside, without), found.scale)


def _any_of(fault: Fault) -> Fault:
    """Return a fault as any of those that are late or elastic: more is left than tells which."""
    return replace(fault, kinds=tuple(dict.fromkeys((*fault.kinds, *LATE_OR_ELASTIC))))


def outlying(counts: Mapping[str, int], *, fitted: bool = False) -> tuple[ModelError, ...]:
    """Return which columns have samples far off those beside, by how many they are.

    Fits to one coordinate leave them out, as the force balance does, unless they are `fitted`.
    """
    left_out = "Straight lines between the samples beside stand in their place."
    return tuple(
        ModelError(
            kind=OUTLIERS,
            finding=(
                f"{count} {'sample' if count == 1 else 'samples'} of the {column}"
                f" {'lies' if count == 1 else 'lie'} far off those beside"
                f"{': the force balance leaves them out' if fitted else ''}."
            ),
            consequence=(
                "Outliers stay in fits to the whole record: correct or remove them."
                if fitted
                else left_out
            ),
            effect=float(count),
            interval=(math.nan, math.nan),
            share=0.0,
            moved=None if fitted else (),
        )
        for column, count in counts.items()
    )


def _fitted_outliers(balance: Balance, measurement: Measurement) -> tuple[ModelError, ...]:
    """Return what of a force balance is left out that fits have seen."""
    force = "friction" if "friction" in measurement.quantities() else "force"
    flags = [outliers(one) for one in balance.series]
    counts = {
        force if name == "force" else name: sum(int(one[name].sum()) for one in flags)
        for name in flags[0]
    }
    return outlying({name: count for name, count in counts.items() if count}, fitted=True)


def _constant_level(found: Explanation, measurement: Measurement) -> ModelError | None:
    """Return that a level, or a part of it, does not grow with a load that varies, if so."""
    best = found.best
    level = sum(best.of("level"))
    if "load" not in found.balance.references or not level:
        return None
    by_load = sum(best.of("load"))
    size = quantity(level, measurement.unit("force"))
    if by_load:
        finding = (
            f"{size} of the friction level does not grow with the load; {number(by_load)} of the"
            " load adds to it."
        )
    else:
        finding = f"The friction level, {size}, does not grow with the load that was recorded."
    return ModelError(
        kind="load",
        finding=finding,
        consequence=f"Every law takes its level as a share of the load. {UNSAID}",
        effect=level,
        interval=found.intervals["-/level"][1:],
        share=(level / found.scale) ** 2 if level < found.scale else 1.0,
    )


def _damped(found: Explanation, measurement: Measurement) -> ModelError | None:
    """Return that a damping which is looked for has the viscous friction in it, if one is."""
    best, balance = found.best, found.balance
    for term, value in zip(best.owner, best.coef, strict=True):
        pairs = [(one.extra[term.what], one.v) for one in balance.parts if term.what in one.extra]
        if term.kind != "known" or not pairs:
            continue
        column, v = (np.concatenate(columns) for columns in zip(*pairs, strict=True))
        product = float(np.linalg.norm(column) * np.linalg.norm(v))
        if abs(float(column @ v)) <= ALIKE * product:
            continue
        size = quantity(abs(float(value)), _unit("viscous_drift", measurement))
        return ModelError(
            kind="damping",
            finding=(
                "Damping of the mechanism and viscous friction are the same force along this"
                f" motion: the {parameter_words(term.what)} of {size} is their sum."
            ),
            consequence="To tell them apart, hold one of them.",
            effect=float(value),
            interval=(math.nan, math.nan),
            share=0.0,
            moved=(),
        )
    return None


def _earned(found: Explanation, term: Term) -> bool:
    """Whether a force along the way earns the margins of a fault; not beside presliding.

    An axis that sticks and slips does so at even distances: what its law leaves looks like a force
    that depends on position.
    """
    best, usual = found.best, Rule()
    if best.structure.memories or usual.fault is None:
        return False
    without = fit(found.balance, best.structure.without(term))
    return Rule(*usual.fault).better(best, without, found.scale)


def _late_instead(
    found: Explanation, measurement: Measurement, response: SensorResponse
) -> ModelError | None:
    """Return that a late channel may be meant instead of presliding of measured friction, if so.

    Either where it explains nearly as much, or where presliding needs friction that comes before
    the motion: a memory that stands for a late channel is later than it after some reversals.
    """
    best = found.best
    if "friction" not in measurement.quantities() or not best.structure.memories:
        return None
    shift = next((one.par[0] for one in best.structure.terms if one.kind in CORRECTED), 0.0)
    if shift < 0.0:
        return _either(
            "The record does not tell presliding from a late channel: with presliding, the motion"
            f" lags the friction by {quantity(-shift, 's')}.",
            shift,
        )
    late = [
        one
        for one in found.family.values()
        if one.ok and not one.structure.memories and one.rms < NEARLY * best.rms
        if sum(one.structure.late[:2]) > 0.0
    ]
    if any(term.kind in SHOWN_LATE for term in best.structure.terms):
        return None
    both = [one for one in _shown_late(found) if one.rms < PAYS * best.rms]
    if not late and not both:
        return None
    other = min(late or both, key=lambda one: one.rms)
    term = next(term for term in other.structure.terms if term.kind in CORRECTED)
    scale = scale_of([best.rms, other.rms], measurement.unit("friction"))
    how = "better" if other.rms < best.rms else "nearly as well"
    law = "a law without memory" if late else "presliding"
    return _either(
        f"With {CALLED[term.kind]} of {quantity(term.par[0], 's')}, {law}"
        f" explains the record {how}: held-out error {scale.error(other.rms)},"
        f" presliding without it {scale.error(best.rms)}.",
        term.par[0],
        _cure(term.kind, term.par[0], measurement, response),
    )


def _shown_late(found: Explanation) -> Iterator[Fit]:
    """Yield fits of the best structure, or of one with less in it, behind a late channel."""
    kinds, shapes = found.best.structure.family
    for (own, own_shapes), one in found.family.items():
        further = [kind for kind, *_ in {*own} - {*kinds}]
        late = len(further) == 1 and further[0] in CORRECTED and sum(one.structure.late) > 0.0
        if one.ok and late and own_shapes == shapes:
            yield one


def _either(finding: str, late: float, cure: str = "") -> ModelError:
    return ModelError(
        kind="delay or presliding",
        finding=finding,
        consequence=(
            "After a reversal, presliding ends at a displacement, and a late channel after a time:"
            " reversals at other accelerations, or a step of force on the sensor alone, tell them"
            f" apart.{cure}"
        ),
        effect=-late,
        interval=(math.nan, math.nan),
        share=0.0,
    )


def noise_left(found: Explanation) -> float:
    """Return the noise of the sensors in the band [N]: of force, and of motion times inertia."""
    return math.hypot(force_noise(found), acceleration_noise(found.balance, found.best))


def force_noise(found: Explanation) -> float:
    """Return the noise of the force sensor in the band [N]."""
    balance = found.balance
    return max(
        resolution(one.raw) * math.sqrt(min(2.0 * one.h * balance.fc, 1.0)) for one in balance.parts
    )


def _half_sample(delay: float, measurement: Measurement, hold: Hold) -> str:
    """Return that a delay [s] may be a wrong setting: a held force is half a sample late."""
    other: Hold = "zero" if delay < 0.0 else "first"
    if "friction" in measurement.quantities() or other == hold:
        return ":"
    step = max(float(np.median(np.diff(np.asarray(r.time)))) for r in measurement.records())
    if not HALF[0] <= abs(delay) / step <= HALF[1]:
        return ":"
    meant = "a held command" if other == "zero" else "a sampled sensor signal"
    return f'. This is half a sample: either set hold to "{other}" ({meant}), or there is'


def _cure(kind: str, value: float, measurement: Measurement, response: SensorResponse) -> str:
    """Return how to fit friction that a sensor shows late, beyond what is corrected already."""
    if kind not in CORRECTED or "friction" not in measurement.quantities():
        return ""
    whole = getattr(response, kind) + value
    return (
        " If the channel is late, correct for it:"
        f" RecordSettings(friction_{kind}={whole:.3g}), or --friction-{kind} {whole:.3g}."
    )


def _unexplained(found: Explanation, measurement: Measurement) -> ModelError:
    unit = measurement.unit("force")
    force = quantity(found.best.rms, unit)
    gear = min((one.rms for one in found.ties if _has_gear(one)), default=math.nan)
    instead = (
        f" A level that grows with the torque of the gear would leave {quantity(gear, unit)}, but"
        " so may an error of the links, which this record does not tell from it."
        if not _has_gear(found.best) and gear < found.best.rms
        else ""
    )
    return ModelError(
        kind="unexplained",
        finding=(
            f"No law and no fault that was tried explains {force} of the force,"
            f" {percent(found.left)} of the friction.{instead}"
        ),
        consequence=UNSAID,
        effect=found.best.rms,
        interval=(math.nan, math.nan),
        share=1.0,
    )


def _partly(found: Explanation, measurement: Measurement) -> ModelError | None:
    """Return that a part of the friction is left that is no noise and no law explains, if so."""
    noise = noise_left(found)
    if found.left <= PARTLY or found.best.rms <= FAR * noise:
        return None
    force = quantity(found.best.rms, measurement.unit("force"))
    return ModelError(
        kind="unexplained",
        finding=(
            f"The force balance leaves {force} of the force, {percent(found.left)} of the friction,"
            " more than single samples scatter by: a law that was not tried may come closer."
        ),
        consequence="Intervals do not allow for it.",
        effect=found.best.rms,
        interval=(math.nan, math.nan),
        share=0.0,
        moved=(),
    )


def _error(
    fault: Fault,
    measurement: Measurement,
    hold: Hold,
    response: SensorResponse,
    *,
    instead: tuple[str, str] | None = None,
) -> ModelError:
    kind = fault.kinds[0]
    value = fault.value or 0.0
    ends = fault.interval or (math.nan, math.nan)
    # a delay counts from the force to the motion
    late = kind in SHOWN_LATE
    effect, limits = (-value, sorted(-one for one in ends)) if late else (value, ends)
    sized = _Sized(
        value=value,
        text=_size(value, ends, _unit(kind, measurement)),
        force=quantity(fault.size, measurement.unit("force")),
        half=_half_sample(value, measurement, hold) if kind == "delay" else ":",
        measured="friction" in measurement.quantities(),
    )
    others = [one for one in dict.fromkeys(CALLED[k] for k in fault.kinds) if one != CALLED[kind]]
    others += [instead[1]] if instead else []
    finding = _undecided(fault, sized, others) if others else f"{SAID[kind](sized)}."
    what = f"{CALLED[kind]} explains" if not others else "one of these explains"
    return ModelError(
        kind=f"{_group(fault.kinds)} or {instead[0]}" if instead else _group(fault.kinds),
        finding=finding,
        consequence=(
            f"{capital(what)} {sized.force} of the force, {percent(fault.share)} of the friction."
            f" {UNSAID}{_cure(kind, value, measurement, response)}"
        ),
        effect=effect,
        interval=(float(limits[0]), float(limits[1])),
        share=fault.share**2,
    )


def _group(kinds: tuple[str, ...]) -> str:
    """Return the name of a finding: of several kinds that are all late or elastic, the group."""
    names = dict.fromkeys(NAMES.get(one, one) for one in kinds)
    if len(names) == 1:
        return next(iter(names))
    return "late or elastic" if set(kinds) <= set(LATE_OR_ELASTIC) else " or ".join(names)


def _undecided(fault: Fault, sized: _Sized, others: list[str]) -> str:
    each = " in each second" if fault.kinds[0] == "skew" else ""
    own = f"{CALLED[fault.kinds[0]]} of {sized.text}{each}"
    choice = " or ".join([own, *others])
    if set(fault.kinds) <= set(LATE_OR_ELASTIC) and CUT_OFF[1] not in others:
        return (
            f"Something late or elastic acts between force and motion: {choice}. The record does"
            " not tell which."
        )
    return (
        f"Beside the friction law, the force balance asks for {choice}; the record does not tell"
        " which."
    )


def _ripple(found: Explanation, term: Term, measurement: Measurement) -> ModelError:
    """Return a force along the way that no law of friction has."""
    pairs = zip(found.best.coef, found.best.owner, strict=True)
    amplitude = math.hypot(*(float(x) for x, one in pairs if one == term))
    length = quantity(2.0 * math.pi / term.par[0], measurement.unit("position"))
    if term.kind == "imbalance":
        amplitude *= found.balance.speed[term.channel] ** 2
        finding = (
            "A force depends on position and grows with the square of speed, to"
            f" {quantity(amplitude, measurement.unit('force'))} at the largest speed, with"
            f" wavelength {length}: imbalance."
        )
    else:
        finding = (
            "A force in addition to friction depends on position, with amplitude"
            f" {quantity(amplitude, measurement.unit('force'))} and wavelength {length}: cogging,"
            " a cable or gravity."
        )
    share = amplitude / math.sqrt(2.0) / found.scale
    return ModelError(
        kind=NAMES.get(term.kind, term.kind),
        finding=finding,
        consequence=f"No law of friction has it. {UNSAID}",
        effect=amplitude,
        interval=(math.nan, math.nan),
        share=share**2,
    )


def _size(value: float, ends: tuple[float, float], unit: str) -> str:
    """Return a number without its sign, and its interval if there is one."""
    low, high = sorted(math.copysign(1.0, value) * one for one in ends)
    scale = scale_of([abs(value)], unit)
    if not np.isfinite([low, high]).all():
        return scale.quantity(abs(value))
    shown = within(scale.factor * abs(value), scale.factor * low, scale.factor * high)
    return f"{with_unit(shown, scale.unit)} (95 % interval {scale.interval(low, high)})"


def _unit(kind: str, measurement: Measurement) -> str:
    force, position = measurement.unit("force"), measurement.unit("position")
    return {
        "delay": "s",
        "lag": "s",
        "spring": f"{force}/{position}",
        "drift": force,
        "offset_drift": force,
        "viscous_drift": f"{force} s/{position}",
        "saturation": force,
        "backlash": position,
        "loose": position,
        "flexible": "Hz",
        "hum": "Hz",
        "skew": "s",
        "mass": "kg m^2" if measurement.turning else "kg",
    }[kind]


def _rises(sized: _Sized) -> str:
    return "rises" if sized.value > 0.0 else "falls"


def _late(sized: _Sized) -> str:
    if sized.value > 0.0:
        return (
            f"The recorded force lags the motion by {sized.text}{sized.half} a delay or filter of"
            " the force sensor, or two unsynchronised clocks"
        )
    return (
        f"The motion lags the recorded force by {sized.text}{sized.half} a delay of the amplifier"
        " or of the position sensor, or two unsynchronised clocks"
    )


def _drifting(sized: _Sized) -> str:
    sign = "later" if sized.value > 0.0 else "earlier"
    return (
        f"The recorded force comes {sign} by {sized.text} in each second: the clocks of force and"
        " position drift apart"
    )


def _saturated(sized: _Sized) -> str:
    return f"Force that was recorded beyond {sized.text} does not act: the amplifier saturates"


def _missing_mass(sized: _Sized) -> str:
    more = "larger" if sized.value > 0.0 else "smaller"
    return (
        f"The motion needs a mass {sized.text} {more} than the one given: the mass or the gain of"
        " the force is wrong"
    )


SAID: Final[Mapping[str, Callable[[_Sized], str]]] = {
    "delay": _late,
    "lag": lambda s: (
        f"The recorded force follows friction through a filter with a time constant of {s.text}:"
        " one of the force sensor or its amplifier"
    ),
    "saturation": _saturated,
    "mass": _missing_mass,
    "backlash": lambda s: (
        f"After each reversal, inertia and friction differ over {s.text}: backlash"
    ),
    "loose": lambda s: (
        f"Part of the inertia follows the motion through a gap of {s.text}: backlash"
    ),
    "flexible": lambda s: (
        f"Part of the inertia is coupled elastically, with a resonance at {s.text}"
    ),
    "skew": _drifting,
    "hum": lambda s: (
        f"A ripple of the recorded force has a frequency of {s.text} whatever the motion: one of"
        " the amplifier, the sensor or the mains, perhaps at a lower frequency by sampling"
    ),
    "spring": lambda s: (
        f"A force {_rises(s)} with position by {s.text}"
        f"{'' if s.measured else ': the mechanism lacks a spring'}"
    ),
    "drift": lambda s: f"The friction level {_rises(s)} by {s.text} over the record",
    "offset_drift": lambda s: (
        f"A force in addition to friction {_rises(s)} by {s.text} over the record"
    ),
    "viscous_drift": lambda s: (
        f"Viscous friction {_rises(s)} by {s.text} over the record, as in warm-up"
    ),
}
"""Sentences of faults, by kind."""

"""Friction of several joints by inverse dynamics: one problem in the parameters of all."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, between_gaps
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.contact_inputs import joint_inputs
from stickslip.identify.fits.estimation.bristle_integration import Path
from stickslip.identify.fits.force_map.data import (
    SEGMENTS,
    MotionSegment,
    blur_of,
    reach_of,
    smoothed,
)
from stickslip.identify.fits.force_map.force_balance import (
    FEWEST,
    OVERSAMPLED,
    PATH,
    SAMPLES,
    FilteredMotion,
    compared,
    filtered_motion,
    mean_force,
    mean_frequency,
    passed_by_balance,
    positive_noise,
    resting_motion,
    second_differences,
)
from stickslip.identify.fits.series.inverse_dynamics import (
    HARMONICS,
    HIGHEST,
    LEAST,
    check_even,
    positions_of,
)
from stickslip.identify.fits.settings import Hold
from stickslip.identify.fits.signals import play
from stickslip.mechanisms import Contact, Mechanism, motors_of
from stickslip.quantities import vary
from stickslip.show.formatting import joined

Array = NDArray[np.float64]
WEAK = 1e-3
"""Local states that rows see this much less than the whole stretch does are left as they are."""
Stretches = tuple[MotionSegment, ...]

AHEAD = 5.0
"""Positions are first filtered at so many times what the common filter passes: it changes nothing
that passes, by 3e-6, and else noise of the first acceleration would be seen for long."""
LEVELS = 2
"""Positions between which an encoder may jitter at rest, too seldom to be noise."""
FAR = 50.0
"""Range of a slow motion over the displacement that the sensor may miss from which it is one."""


def joint_stretches(
    torques: JointTorques,
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    hold: Hold,
    segment: float | None = None,
    samples: Sequence[float] = (SAMPLES,),
    slipping: bool = False,
    wider: float = 1.0,
) -> tuple[tuple[Stretches, ...], ...]:
    """Return stretches of the friction of each joint, which all have the same times and segments.

    All that stands in the balances passes one filter, since every balance has the accelerations of
    all joints. It passes `FEWEST` times the mean frequency of the fastest joint, as is usual for
    robots, whose gears make accelerations beyond that which no torque of a motor goes with.

    Source: M. Gautier, "Dynamic identification of robots with power model", 1997.
    """
    pieces: list[tuple[JointPiece, NDArray[np.intp]]] = []
    first = 0
    lengths = [float(np.ptp(np.asarray(one.time))) / SEGMENTS for one in measurement.records()]
    for own in joint_pieces(torques, mechanism, measurement, hold=hold, wider=wider):
        length = lengths[own.record] if segment is None else segment
        count = max(1, round(own.span / length))
        share = np.minimum((own.time - own.time[0]) / own.span * count, count - 1)
        pieces.append((own, first + share.astype(np.intp)))
        first += count
    joints = range(len(torques.coordinates))
    return tuple(_cut(pieces, joints, count, slipping=slipping) for count in samples)


def joint_pieces(
    torques: JointTorques,
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    hold: Hold,
    wider: float = 1.0,
    resolved: bool = False,
) -> Iterator["JointPiece"]:
    """Yield what lies between gaps of records, and is long enough to be filtered.

    The common filter passes what is usual for robots, or, `resolved`, all that noise of the
    positions allows with these values of the mechanism, if that is more.
    """
    for number, record in enumerate(measurement.records()):
        check_joints(record, torques.coordinates)
        set_up = vary(mechanism, "mechanism", record.overrides) if record.overrides else mechanism
        for piece in between_gaps(record):
            if np.asarray(piece.time).size >= LEAST:
                yield JointPiece.of(torques, set_up, number, piece, hold, wider, resolved)


def _cut(
    pieces: Sequence[tuple["JointPiece", NDArray[np.intp]]],
    joints: Sequence[int],
    samples: float,
    *,
    slipping: bool,
) -> tuple[Stretches, ...]:
    """Return the stretches of each joint, from pieces with their record and segment numbers."""
    found = [
        [own.stretch(i, numbers, samples=samples, slipping=slipping) for own, numbers in pieces]
        for i in joints
    ]
    kept = [one.segment[one.segment >= 0] for stretches in found for one in stretches]
    used = np.unique(np.concatenate(kept)) if kept else np.zeros(0, dtype=np.intp)
    if not used.size:
        raise InputError(
            f"inverse dynamics needs a stretch of at least {LEAST} samples without a gap, in which"
            " the joints move for longer than the memory of the filter of motion and forces:"
            " record longer."
        )
    return tuple(tuple(_renumbered(one, used) for one in stretches) for stretches in found)


def regression_of(
    stretches: Sequence[Sequence[MotionSegment]], slopes: int
) -> tuple[Array, Array, NDArray[np.intp]]:
    """Return columns, forces and joints of the rows of a regression of all joints.

    Columns are the slopes by parameters of the mechanism, then Coulomb friction, viscous friction
    and a constant force of each joint.
    """
    count = len(stretches)
    tables, wanted = [], []
    for i, whole in enumerate(stretches):
        for one in whole:
            rows = one.segment >= 0
            v = one.path.velocity
            table = np.zeros((len(v), slopes + 3 * count))
            table[:, :slopes] = one.regressors
            own = np.column_stack([np.sign(v), v, np.ones_like(v)])
            table[:, slopes + 3 * i : slopes + 3 * i + 3] = one.seen(own)
            seen, friction = table[rows], one.friction[rows]
            if one.zeros is not None:
                basis = spanned(one.zeros[rows])
                seen = seen - basis @ (basis.T @ seen)
                friction = friction - basis @ (basis.T @ friction)
            tables.append(seen)
            wanted.append((i, friction))
    joint = np.concatenate([np.full(len(column), i, dtype=np.intp) for i, column in wanted])
    return np.concatenate(tables), np.concatenate([column for _, column in wanted]), joint


def spanned(columns: Array) -> Array:
    """Return orthonormal columns that span others (n, r); none if all are 0."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > 0.0] / size[size > 0.0]
    if not columns.shape[1]:
        return columns
    u, s, _ = np.linalg.svd(columns, full_matrices=False)
    found: Array = u[:, s > WEAK * s.max(initial=0.0)]
    return found


def check_joints(record: Measurement, names: Sequence[str]) -> None:
    """Refuse a record that does not have position and force of every joint."""
    label = f"record {record.name!r}" if record.name else "the record"
    if not record.joints:
        raise InputError(
            f"{label} has nothing by joint: give position and force by joint, such as"
            f" position={{{', '.join(f'{name!r}: ...' for name in names)}}}."
        )
    for name in record.joints:
        if name not in names:
            raise InputError(
                f"{label} has a joint {name!r}, and the mechanism has the coordinates"
                f" {joined(list(names))}: use these names."
            )
    for name in names:
        known = record.joints[name].quantities() if name in record.joints else ()
        if not {"position", "velocity"} & {*known}:
            raise InputError(
                f"{label} has no position of the joint {name!r}, which inverse dynamics of several"
                " joints needs."
            )
        if "force" not in known:
            raise InputError(
                f"{label} has no force of the joint {name!r}: give what drives it; zeros if nothing"
                " does."
            )


def joint_record(mechanism: Mechanism, measurement: Measurement, coordinate: str) -> Measurement:
    """Return what was measured of one joint, as records of that joint alone.

    Examples
    --------
    >>> from stickslip import TwoLinkArm
    >>> arm = TwoLinkArm(
    ...     upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    ...     lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    ... )  # fmt: skip
    >>> q = {"shoulder": [0.0, 0.1], "elbow": [0.3, 0.2]}
    >>> record = Measurement(time=[0.0, 0.1], position=q, force=q, name="swing")
    >>> own = joint_record(arm, record, "elbow")
    >>> own.position, own.unit("force"), own.name
    (array([0.3, 0.2]), 'N m', 'swing')
    """
    turning = mechanism.units[mechanism.coordinates.index(coordinate)] == "rad"
    records = [
        replace(
            record.joints[coordinate],
            turning=turning,
            name=record.name,
            provenance=record.provenance,
            conditions=record.conditions,
        )
        for record in measurement.records()
    ]
    if not measurement.trials:
        return records[0]
    return Measurement(trials=tuple(records), provenance=measurement.provenance)


def _renumbered(one: MotionSegment, used: NDArray[np.intp]) -> MotionSegment:
    """Return a stretch whose segments are numbered without those that no row is of."""
    numbers = np.where(one.segment >= 0, np.searchsorted(used, one.segment), -1)
    return replace(one, segment=numbers.astype(np.intp))


@dataclass(frozen=True, kw_only=True, eq=False)
class JointPiece:
    """What lies between two gaps of a record: motions, and what all balances are made of."""

    mechanism: Mechanism
    """As it was in the record."""
    record: int
    """Which record it is of."""
    time: Array
    """Even times (n,) [s]."""
    raw: Array
    """Positions (n, m) at these times, not filtered."""
    motions: tuple[FilteredMotion, ...]
    """Motion of each joint."""
    accelerations: Array
    """Accelerations (n, m), of positions filtered at `AHEAD` times the common filter."""
    passed: float
    """What the common filter passes, over half the sampling frequency."""
    applied: Array
    """Applied forces (n, m)."""
    taken: Array
    """Forces that the motion takes (n, m)."""
    slopes: Array
    """Their slopes by the parameters that are looked for (n, m, k)."""
    by_position: Array | None
    """Their slopes by the positions (n, m, m); None where positions count from a known zero."""
    taken_at_rest: Array
    """The same for each joint as if it did not accelerate (n, m)."""
    slopes_at_rest: Array
    """Slopes of that (n, m, k)."""
    loads: Array
    """Load of the contact of each joint (n, m); 1 where nothing rubs."""
    inputs: Sequence[tuple[Mapping[str, Array], Mapping[str, Array]]]
    """Contact inputs of each joint (n,), by name, and their slopes (n, k)."""

    @property
    def span(self) -> float:
        """Length [s]."""
        return float(np.ptp(self.time))

    @classmethod
    def of(
        cls,
        torques: JointTorques,
        mechanism: Mechanism,
        number: int,
        record: Measurement,
        hold: Hold,
        wider: float,
        resolved: bool = False,
    ) -> "JointPiece":
        """Return one stretch of a record without a gap."""
        joints = [record.joints[name] for name in torques.coordinates]
        times, rows = np.asarray(record.time, dtype=float), [positions_of(one) for one in joints]
        forces = [np.asarray(one.values("force")) for one in joints]
        # steps of encoders, noise and rests show in the rows as they were recorded
        noises = [positive_noise(x, times) for x in rows]
        passed, moving = _cut_off(rows, noises, wider)
        if resolved and any(moving):
            found = zip(rows, moving, strict=True)
            allowed = min(passed_by_balance(x, resolved=True) for x, moves in found if moves)
            passed = max(passed, allowed)
        count = len(joints)
        time, columns = _on_even_times(times, [*rows, *forces])
        raw, forces = columns[:count], columns[count:]
        dt = float(time[1] - time[0])
        applied = np.column_stack([mean_force(u, joined=hold == "first") for u in forces])
        motions = tuple(
            filtered_motion(x, dt, passed, tracked="position" in one.quantities(), noise=noise)
            if moves
            else resting_motion(x, noise)
            for x, one, noise, moves in zip(raw, joints, noises, moving, strict=True)
        )
        places = np.column_stack([one.position for one in motions])
        rates = np.column_stack([one.velocity for one in motions])
        ahead = min(AHEAD * passed, PATH * HIGHEST)
        accelerations = np.column_stack(
            [
                second_differences(smoothed(x, ahead), dt) if moves else np.zeros_like(x)
                for x, moves in zip(raw, moving, strict=True)
            ]
        )
        inside = slice(int(np.ceil(2.0 / ahead)), -int(np.ceil(2.0 / ahead)))
        time, places, rates = time[inside], places[inside], rates[inside]
        accelerations = accelerations[inside]
        motions = tuple(one.within(inside) for one in motions)
        taken, slopes = torques.along(mechanism, time, places, rates, accelerations)
        count_of = len(torques.linear)
        smooth = smoothed(accelerations, passed)
        resting, resting_slopes = np.empty_like(taken), np.empty_like(slopes[..., :count_of])
        for i in range(count):
            still = smooth.copy()
            still[:, i] = 0.0
            force, slope = torques.along(mechanism, time, places, rates, still)
            resting[:, i], resting_slopes[:, i] = force[:, i], slope[:, i, :count_of]
        return cls(
            mechanism=mechanism,
            record=number,
            time=time,
            raw=np.column_stack(raw)[inside],
            motions=motions,
            accelerations=accelerations,
            passed=passed,
            applied=applied[inside],
            taken=taken,
            slopes=slopes[..., :count_of],
            by_position=slopes[..., count_of:] if torques.by_position else None,
            taken_at_rest=resting,
            slopes_at_rest=resting_slopes,
            loads=_loads(mechanism, time, places, rates),
            inputs=joint_inputs(
                mechanism,
                {along: one.name for along, one in contacts_along(mechanism).items()},
                record,
                time,
                places,
                rates,
                applied[inside],
                fitted=torques.linear,
                weights=torques.along(mechanism, time, places, 0.0 * rates, 0.0 * rates)[1],
                zeros=torques.by_position,
            ),
        )

    def compared(
        self, i: int, law: FrictionLaw | None, forces: Sequence[Array] = ()
    ) -> tuple[Array, ...]:
        """Return the force of a joint where it slips: measured, by a law, and others' (n,) of it.

        All passed the common filter.
        """
        own = self.stretch(
            i, np.zeros(len(self.time), dtype=np.intp), samples=SAMPLES, slipping=True
        )
        rows = own.segment >= 0
        assert own.applied is not None
        measured, predicted = own.applied[rows], own.applied[rows] - own.friction[rows]
        if law is not None and rows.any():
            steady = own.path.told(law).steady(own.path.velocity, own.path.load)
            predicted = predicted + own.seen(np.asarray(steady))[rows]
        at = np.searchsorted(self.time, own.path.time[rows])
        return measured, predicted, *(smoothed(one, self.passed)[at] for one in forces)

    def stretch(
        self, i: int, numbers: NDArray[np.intp], *, samples: float, slipping: bool
    ) -> MotionSegment:
        """Return the stretch of a joint."""
        motion, passed = self.motions[i], self.passed
        # where laws are judged, a joint that rests throughout shows what holds it
        kept = compared(motion, passed, slipping=slipping, throughout=not slipping)
        count = len(self.time)
        every = max(1, min(int(np.ceil(count / samples)), int(OVERSAMPLED / passed)))
        picked = slice(None, None, every)
        return MotionSegment(
            record=self.record,
            path=Path(
                time=self.time[picked],
                velocity=motion.velocity[picked],
                load=self.loads[picked, i],
                travel=np.diff(motion.position[picked]),
                inputs={name: x[picked] for name, x in self.inputs[i][0].items()},
                input_slopes={name: x[picked] for name, x in self.inputs[i][1].items()},
            ),
            friction=smoothed(self.applied[:, i] - self.taken[:, i], passed)[picked],
            segment=np.where(kept, numbers, -1)[picked],
            regressors=smoothed(self.slopes[:, i], passed)[picked],
            resting=motion.resting[picked],
            held=(self.applied[:, i] - self.taken_at_rest[:, i])[picked],
            held_regressors=self.slopes_at_rest[picked, i],
            applied=smoothed(self.applied[:, i], passed)[picked],
            zeros=(
                None
                if self.by_position is None
                else smoothed(self.by_position[:, i], passed)[picked]
            ),
            resolution=motion.resolution,
            passed=passed * every,
            blur=blur_of(every),
        )


def _cut_off(
    raw: Sequence[Array], noises: Sequence[float], wider: float
) -> tuple[float, list[bool]]:
    """Return what the common filter passes, and which joints move, from recorded positions (n,).

    The filter is that of the joints that move: of one at rest, jitter of its encoder would be the
    fastest. A joint moves if it is displaced within the memory of the filter by more than its
    sensor may miss, or in all by many times that.
    """
    reaches = [reach_of(x, noise) for x, noise in zip(raw, noises, strict=True)]
    followed = [play(x, reach) for x, reach in zip(raw, reaches, strict=True)]
    ranges = [float(np.ptp(x)) / (2.0 * reach) for x, reach in zip(followed, reaches, strict=True)]
    moving = [one > 1.0 and np.unique(x).size > LEVELS for x, one in zip(raw, ranges, strict=True)]

    def passed() -> float:
        found = zip(raw, noises, moving, strict=True)
        speeds = (mean_frequency(x, noise) for x, noise, moves in found if moves)
        least = FEWEST * max(speeds, default=0.0) / np.pi
        return float(max(least, 2.0 * HARMONICS / len(raw[0])))

    filtered = min(passed(), HIGHEST)
    for i, (x, reach) in enumerate(zip(followed, reaches, strict=True)):
        quickest = float(np.max(np.abs(np.gradient(smoothed(x, filtered)))))
        moving[i] &= quickest / filtered > 2.0 * reach or ranges[i] > FAR
    return min(wider * passed(), HIGHEST), moving


def _on_even_times(time: Array, columns: list[Array]) -> tuple[Array, list[Array]]:
    """Return signals at even times, joined by lines where they were sampled at others."""
    check_even(time)
    even = np.linspace(time[0], time[-1], len(time))
    return even, [np.interp(even, time, column) for column in columns]


def contacts_along(mechanism: Mechanism) -> dict[str, Contact]:
    """Return the contact along each coordinate that one rubs along."""
    owner = type(mechanism).__name__
    if len(mechanism.coordinates) > 1 and (motors := motors_of(mechanism)):
        raise InputError(
            f"{owner} has a DCMotor, {next(iter(motors))}, and fits of several joints take forces:"
            " give the torque of each joint, and leave the motor out; of a robot, its rotor is part"
            " of the armature."
        )
    found: dict[str, Contact] = {}
    for contact in mechanism.contacts():
        label = f"{owner}: the contact {contact.name!r}"
        if contact.normal is not None:
            raise InputError(
                f"{label} is pressed by a reaction, which fits of several joints do not know:"
                " prescribe its load."
            )
        if not isinstance(contact.slip, str):
            raise InputError(
                f"{label} slips along a combination of coordinates; fits of several joints need a"
                " contact that slips along one coordinate, without a factor."
            )
        if contact.slip in found:
            raise InputError(
                f"{label} and {found[contact.slip].name!r} rub along one coordinate, which no"
                " record tells apart: leave one of them out of the mechanism."
            )
        found[contact.slip] = replace(contact, name=contact.name or contact.slip)
    return found


def _loads(mechanism: Mechanism, time: Array, q: Array, q_dot: Array) -> Array:
    """Return the load of the contact along each coordinate (n, m); 1 where nothing rubs."""
    names = mechanism.coordinates
    places = {name: q[:, i] for i, name in enumerate(names)}
    rates = {name: q_dot[:, i] for i, name in enumerate(names)}
    loads = mechanism.loads(time, places, rates, dict.fromkeys(mechanism.drives(), 0.0))
    found = np.ones((len(time), len(names)))
    for coordinate, contact in contacts_along(mechanism).items():
        load = loads.get(contact.name, contact.load)
        i = names.index(coordinate)
        found[:, i] = np.asarray(1.0 if load is None else load, dtype=float)
        if not np.all(found[:, i] > 0.0):
            raise InputError(
                f"{type(mechanism).__name__}: the load of the contact {contact.name!r} must be"
                " above 0 N throughout the record."
            )
    return found

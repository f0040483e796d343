"""Which joints records have, along which of them contacts rub, and which of them rest."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, between_gaps
from stickslip.errors import InputError
from stickslip.identify.bands import Array
from stickslip.identify.fits import (
    HARMONICS,
    HIGHEST,
    mean_frequency,
    play,
    positions_of,
    positive_noise,
    reach_of,
    smoothed,
)
from stickslip.identify.problems.record_signals import FEWEST
from stickslip.mechanisms import Contact, Mechanism, motors_of
from stickslip.show.formatting import joined

QUICKEST = 5.0
"""Frequencies that tell rest from slow motion, over the mean frequency of the fastest joint."""
LEVELS = 2
"""Positions between which an encoder may jitter at rest, too seldom to be noise."""
FAR = 50.0
"""Range of a slow motion over the displacement that the sensor may miss from which it is one."""


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


def contacts_along(mechanism: Mechanism) -> dict[str, Contact]:
    """Return the contact along each coordinate that one rubs along."""
    owner = type(mechanism).__name__
    if len(mechanism.coordinates) > 1 and (motors := motors_of(mechanism)):
        raise InputError(
            f"{owner} has a DCMotor, {next(iter(motors))}, and fits of several joints take forces:"
            " give the torque of each joint, and leave the motor out; of a robot, its rotor is part"
            " of the armature."
        )
    result: dict[str, Contact] = {}
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
        if contact.slip in result:
            raise InputError(
                f"{label} and {result[contact.slip].name!r} rub along one coordinate, which no"
                " record tells apart: leave one of them out of the mechanism."
            )
        result[contact.slip] = replace(contact, name=contact.name or contact.slip)
    return result


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


def resting_of(mechanism: Mechanism, measurement: Measurement) -> tuple[str, ...]:
    """Return the coordinates that rest in all records: nothing tells their friction.

    Examples
    --------
    >>> from stickslip import TwoLinkArm
    >>> arm = TwoLinkArm(
    ...     upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
    ...     lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    ... )  # fmt: skip
    >>> t = np.linspace(0.0, 10.0, 2001)
    >>> q = {"shoulder": np.sin(t), "elbow": 0.3 + 0.0 * t}
    >>> resting_of(arm, Measurement(time=t, position=q, force=q))
    ('elbow',)
    """
    moved = np.zeros(len(mechanism.coordinates), dtype=bool)
    for record in measurement.records():
        check_joints(record, mechanism.coordinates)
        for piece in between_gaps(record):
            times = np.asarray(piece.time, dtype=float)
            if len(times) >= FEWEST:
                joints = [piece.joints[name] for name in mechanism.coordinates]
                moved |= _moving([positions_of(joint) for joint in joints], times)
    return tuple(
        name for name, moves in zip(mechanism.coordinates, moved.tolist(), strict=True) if not moves
    )


def _moving(places: list[Array], times: Array) -> NDArray[np.bool_]:
    """Return which joints move (m,), from their positions (n,).

    A joint moves if it is displaced by more than its sensor may miss while the fastest joint makes
    a part of its motion, or in all by many times that: jitter of an encoder is neither.
    """
    # steps of encoders, noise and rests show in the rows as they were recorded
    noises = [positive_noise(x, times) for x in places]
    reaches = [reach_of(x, noise) for x, noise in zip(places, noises, strict=True)]
    followed = [play(x, reach) for x, reach in zip(places, reaches, strict=True)]
    ranges = np.array([np.ptp(x) / (2.0 * own) for x, own in zip(followed, reaches, strict=True)])
    moving = (ranges > 1.0) & [np.unique(x).size > LEVELS for x in places]
    own = zip(places, noises, moving, strict=True)
    fastest = max((mean_frequency(x, noise) for x, noise, moves in own if moves), default=0.0)
    share = max(QUICKEST * fastest / math.pi, 2.0 * HARMONICS / len(times))
    share = min(share, HIGHEST)
    quickest = [float(np.max(np.abs(np.gradient(smoothed(x, share))))) for x in followed]
    return moving & ((np.array(quickest) > 2.0 * share * np.array(reaches)) | (ranges > FAR))

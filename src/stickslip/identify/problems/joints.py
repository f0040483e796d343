r"""Records of several joints: the balance of each is a record of one coordinate.

1. **Balance of a joint.** Along the measured motion of all joints, the equations of the mechanism
   (:class:`~stickslip.engine.formulation.JointTorques`) give the force
   :math:`T_i(q, \dot q, \ddot q)` that joint :math:`i` takes without friction, which is affine in
   the parameters :math:`p` of links that are looked for. With the inertia :math:`J_i` that it moves
   where all others rest,

   .. math:: F_i - (T_i - J_i \ddot q_i) - J_i \ddot q_i
             = \sum_k (p_k - p_{k0})\, \partial T_i / \partial p_k + \text{friction}_i ,

   so that it is a record of one coordinate, with known forces of the mechanism and unknown ones
   (:mod:`~stickslip.identify.problems.records`): all that is judged there is judged here.
2. **Motion.** Velocities and accelerations in :math:`T_i` come from positions in a band `AHEAD`
   times that of the balance, whose filter follows. Noise of the acceleration of joint :math:`j`
   is a force :math:`M_{ij}` times it, so that the band of joint :math:`i` is that of noise
   :math:`\sqrt{\sum_j M_{ij}^2 \sigma_j^2} / M_{ii}` of its own position.
3. **Links** that are looked for are found first (`at`), from the balances of all joints at once
   with the measured curve of each as its friction, whatever its law is. What columns :math:`R_i` of
   the curve of joint :math:`i` explain is projected out of its response :math:`y_i` and its slopes
   :math:`U_i`, each is weighed by what is left, :math:`\sigma_i`, and

   .. math:: p - p_0 = \Big(\sum_i U_i^T P_i U_i / \sigma_i^2\Big)^{-1}
                       \sum_i U_i^T P_i y_i / \sigma_i^2 .

   Their errors are twice those that stretches show.

Source: M. Gautier, "Dynamic identification of robots with power model", 1997.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement, between_gaps
from stickslip.engine.formulation import JointTorques
from stickslip.identify.bands import Array
from stickslip.identify.fits import (
    FilteredMotion,
    check_joints,
    contacts_along,
    gear_torques,
    joint_inputs,
    recorded_inputs,
)
from stickslip.identify.forces import Unknown, with_transmitted
from stickslip.identify.problems.record_columns import Balance
from stickslip.identify.problems.record_rows import MIDDLE, cutoff_of, even, mean_frequency, moves
from stickslip.identify.problems.record_signals import (
    FEWEST,
    STRETCHES,
    Filter,
    Record,
    noise_of,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

AHEAD = 2.0
"""Band of the motion in the equations over that of the balance."""
ROBOTS = 5.0
"""Band of the balances over the mean frequency of the fastest joint, at most: beyond it gears make
accelerations that no torque of a motor goes with (docs: why/filters-and-rest)."""
SEEN = 20.0
"""Range of the positions of a joint that moves, over their noise."""
UNSHOWN = 2.0
"""Errors of links over those that stretches show: a filter or a delay is the same in all."""
SAME = math.sqrt(np.finfo(float).eps)
"""Eigenvalue of scaled slopes, over the largest, below which parameters are not told apart."""


@dataclass(frozen=True, kw_only=True, eq=False)
class JointRecords:
    """The balance of each joint as records of one coordinate."""

    contacts: Mapping[str, str]
    """Contacts by coordinate: the joints that rub and move."""
    resting: tuple[str, ...]
    """Coordinates that rub and rest: nothing tells their friction."""
    records: Mapping[str, list[Record]]
    """By coordinate, with columns of all parameters that are looked for."""
    widest: float
    """Largest band of a balance [Hz]."""
    inertias: Mapping[str, float]
    """What moves with each coordinate, all others at rest [kg m^2] or [kg]."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        measurement: Measurement,
        *,
        unknown: Sequence[str] = (),
        zeros: bool = False,
        resting: Collection[str] = (),
    ) -> "JointRecords":
        """Return the records of the joints, with columns for parameters that are looked for.

        Joints that rest stay where they are in the median.
        """
        torques = JointTorques.of(mechanism, unknown, by_position=zeros)
        pieces = [
            _Piece.of(mechanism, record, piece, resting)
            for record in measurement.records()
            for piece in between_gaps(record)
            if len(np.asarray(piece.time)) >= FEWEST
        ]
        return cls._made(torques, mechanism, pieces, resting)

    def at(self, links: "Links", *, held: bool) -> dict[str, list[Record]]:
        """Return the records with parameters changed, and as uncertain as they are.

        Forces may be `held` until the next sample.
        """
        told = {path: x for path, x in links.errors.items() if 0.0 < x < math.inf}

        def moved(one: Record) -> Record:
            assert one.mechanism is not None
            forces = [x * one.unknown[path].force for path, x in links.change.items()]
            mechanism = np.sum([one.mechanism, *forces], axis=0)
            unknown = {path: replace(one.unknown[path], doubt=x) for path, x in told.items()}
            return replace(one, mechanism=mechanism, unknown=unknown, held=held)

        return {name: [moved(one) for one in own] for name, own in self.records.items()}

    @classmethod
    def _made(
        cls,
        torques: JointTorques,
        mechanism: Mechanism,
        pieces: Sequence["_Piece"],
        resting: Collection[str],
    ) -> "JointRecords":
        names, contacts = torques.coordinates, contacts_along(mechanism)
        moving = [name not in resting for name in names]
        middle = np.median(np.concatenate([one.position for one in pieces]), axis=0)
        mass = _mass(torques, mechanism, middle)
        noise = np.max([one.noise for one in pieces], axis=0) * moving
        plain = {
            i: [one.plain(i, abs(float(mass[i, i]))) for one in pieces]
            for i, moves in enumerate(moving)
            if moves
        }
        widest = ROBOTS * max(map(mean_frequency, plain.values()), default=math.inf)
        records = dict[str, list[Record]]()
        for i, own in plain.items():
            name, inertia = names[i], abs(float(mass[i, i]))
            if name not in contacts:
                continue
            gain = float(np.linalg.norm(mass[i] * noise) / (inertia * noise[i])) if inertia else 1.0
            noisy = [replace(one, gain=gain) for one in own]
            # where it moves less than its sensor misses, it rests: nothing tells its friction
            seen = [(a, b) for a, b in zip(pieces, noisy, strict=True) if _is_seen(b)]
            if not seen:
                continue
            band = min(*(cutoff_of(even(one)) for _, one in seen if moves(one)), widest)
            records[name] = [one.along(i, record, torques, band) for one, record in seen]
        return cls(
            contacts={name: contacts[name].name for name in records},
            resting=tuple(name for name in contacts if name not in records),
            records=records,
            widest=widest,
            inertias={name: abs(float(mass[i, i])) for i, name in enumerate(names)},
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Links:
    """What the balances of all joints tell of parameters."""

    change: Mapping[str, float]
    """By path, the change from the values that the records were made with."""
    errors: Mapping[str, float]
    """Standard errors; infinite where the motion does not tell a parameter from others."""
    freedom: float = math.inf
    """Degrees of freedom of these."""


def _is_seen(record: Record) -> bool:
    """Return whether a record moves by more than its sensor misses."""
    return bool(np.ptp(record.position) > SEEN * record.position_noise)


def links_of(records: JointRecords, held: bool, doubts: Mapping[str, float]) -> Links:
    """Return parameters from the balances of all joints at once, with their curves as friction.

    Those with stated errors (`doubts`) keep their values.
    """
    known = Links(change=dict.fromkeys(doubts, 0.0), errors=doubts)
    paths = [path for path in next(iter(records.records.values()))[0].unknown if path not in doubts]
    if not paths:
        return known
    parts = [
        _reduced([replace(one, held=held) for one in own], paths, records.widest)
        for own in records.records.values()
    ]
    gram = np.sum([slopes.T @ slopes for slopes, _, _ in parts], axis=0)
    scale = np.sqrt(np.diagonal(gram))
    scale[scale == 0.0] = 1.0  # nothing depends on it
    sizes, basis = np.linalg.eigh(gram / np.outer(scale, scale))
    kept = sizes > SAME * sizes[-1]
    inverse = (basis[:, kept] / sizes[kept]) @ basis[:, kept].T / np.outer(scale, scale)
    change = inverse @ np.sum([slopes.T @ left for slopes, left, _ in parts], axis=0)
    meat, count = np.zeros_like(gram), sum(int(one.max()) + 1 for _, _, one in parts)
    for slopes, left, stretches in parts:
        sums = np.zeros((int(stretches.max()) + 1, len(paths)))
        np.add.at(sums, stretches, slopes * (left - slopes @ change)[:, None])
        meat += sums.T @ sums
    freedom = max(count - (len(parts) + 1) * len(paths), 1)  # each balance fits its own, too
    meat *= count / freedom
    errors = UNSHOWN * np.sqrt(np.maximum(np.diagonal(inverse @ meat @ inverse), 0.0))
    errors[np.sum(basis[:, ~kept] ** 2, axis=1) > SAME] = math.inf
    return Links(
        change={**known.change, **dict(zip(paths, change.tolist(), strict=True))},
        errors={**known.errors, **dict(zip(paths, errors.tolist(), strict=True))},
        freedom=float(freedom),
    )


def _reduced(
    records: Sequence[Record], paths: Sequence[str], highest: float
) -> tuple[Array, Array, NDArray[np.intp]]:
    """Return slopes (n, k) and the response (n,) less what its curve explains, and stretches."""
    balance = Balance(records, highest=highest)
    rows, fixed = balance.rows(MIDDLE), balance.fixed(MIDDLE)
    sides = [np.column_stack([one.direction, np.abs(one.direction)]) for one in balance.pieces]
    hats = [balance.frame.hats(one.velocity) for one in balance.pieces]
    each = [np.hstack([a * b for b in s.T[:, :, None]]) for a, s in zip(hats, sides, strict=True)]
    curve = rows.seen(each)
    beside = [fixed[name] for name in ("slope", "delay")]
    x = np.column_stack([curve, *beside, np.ones(rows.count)])
    x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
    gram = x.T @ x + 1e-9 * len(x) * np.eye(x.shape[1])
    both = np.column_stack([*(fixed[path] for path in paths), rows.response])
    both = both - x @ np.linalg.solve(gram, x.T @ both)
    left = both[:, -1] - both[:, :-1] @ np.linalg.lstsq(both[:, :-1], both[:, -1], rcond=1e-8)[0]
    size = float(np.sqrt(np.mean(left**2))) + 1e-300
    stretches = np.minimum(np.arange(rows.count) * STRETCHES // rows.count, STRETCHES - 1)
    return both[:, :-1] / size, both[:, -1] / size, stretches


def _mass(torques: JointTorques, mechanism: Mechanism, q: Array) -> Array:
    """Return the mass matrix (m, m) at a place (m,)."""
    count = len(q)
    places, none, time = np.tile(q, (count, 1)), np.zeros((count, count)), np.zeros(count)
    still, _ = torques.along(mechanism, time, places, none, none)
    moving, _ = torques.along(mechanism, time, places, none, np.eye(count))
    return np.asarray((moving - still).T)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Piece:
    """What lies between two gaps of a record, at even times."""

    mechanism: Mechanism
    """As it was in the record."""
    record: Measurement
    time: Array
    """Times (n,) [s]."""
    position: Array
    """Positions (n, m)."""
    force: Array
    """Forces that drive the joints (n, m)."""
    noise: Sequence[float]
    """Standard deviation of the noise of the positions of each joint."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        record: Measurement,
        piece: Measurement,
        resting: Collection[str],
    ) -> "_Piece":
        check_joints(piece, mechanism.coordinates)
        joints = [piece.joints[name] for name in mechanism.coordinates]
        times = np.asarray(piece.time, dtype=float)
        step = float(np.median(np.diff(times)))
        even = times[0] + step * np.arange(int((times[-1] - times[0]) / step + 1e-6) + 1)
        places = [_position(one, times) for one in joints]
        moving = [name not in resting for name in mechanism.coordinates]
        noise = [noise_of(x) if moves else 0.0 for x, moves in zip(places, moving, strict=True)]
        return cls(
            mechanism=vary(mechanism, "mechanism", record.overrides)
            if record.overrides
            else mechanism,
            record=piece,
            time=even,
            position=np.column_stack(
                [
                    np.interp(even, times, x if moves else np.full_like(x, np.median(x)))
                    for x, moves in zip(places, moving, strict=True)
                ]
            ),
            force=np.column_stack(
                [np.interp(even, times, np.asarray(one.values("force"), float)) for one in joints]
            ),
            noise=noise,
        )

    def plain(self, i: int, inertia: float) -> Record:
        """Return the record of a joint without what others do to it."""
        return Record(
            time=self.time,
            position=self.position[:, i],
            force=self.force[:, i],
            inertia=inertia,
            joint=True,
        )

    def along(self, i: int, record: Record, torques: JointTorques, band: float) -> Record:
        """Return the record of a joint with the forces that the motion of all joints takes."""
        step = float(self.time[1] - self.time[0])
        filt = Filter(count=len(self.time), step=step, band=AHEAD * band, every=1)
        q = self.position
        v, a = filt(q, slope=1, full=True), filt(q, slope=2, full=True)
        taken, slopes = torques.along(self.mechanism, self.time, filt(q, full=True), v, a)
        inertia = record.inertia or 0.0
        paths = [*torques.linear]
        if torques.by_position:
            paths += [f"zero.{name}" for name in torques.coordinates]
        unknown = {
            path: Unknown(force=-slopes[:, i, k], inertia=0.0) for k, path in enumerate(paths)
        }
        name, place = torques.coordinates[i], filt(q, full=True)
        inputs = recorded_inputs(self.record, self.time, name)
        external = self._external(name, place, v)
        if external is not None:  # of what is measured friction is a part
            motion = FilteredMotion(
                position=q[:, i], velocity=v[:, i], resting=v[:, i] == 0.0, resolution=0.0
            )
            inputs |= gear_torques(
                motion, self.force[:, i], taken[:, i], external, 2.0 * step * band,
                unknown=[*slopes[:, i].T],
            )  # fmt: skip
        return replace(
            record,
            mechanism=inertia * a[:, i] - taken[:, i],
            unknown=unknown,
            load=self._load(name, place, v),
            inputs=with_transmitted(inputs),
        )

    def _external(self, coordinate: str, q: Array, v: Array) -> Array | None:
        """Return what acts on a joint beside its motor (n,); None where the mechanism is silent."""
        contacts = {along: one.name for along, one in contacts_along(self.mechanism).items()}
        own = joint_inputs(self.mechanism, contacts, self.record, self.time, q, v, self.force)
        known, _ = own[self.mechanism.coordinates.index(coordinate)]
        return known["external"] if {"motor", "external"} <= known.keys() else None

    def _load(self, coordinate: str, q: Array, v: Array) -> Array | None:
        """Return the normal force at the contact of a joint (n,) where one is known."""
        names = self.mechanism.coordinates
        loads = self.mechanism.loads(
            self.time,
            dict(zip(names, q.T, strict=True)),
            dict(zip(names, v.T, strict=True)),
            dict.fromkeys(self.mechanism.drives(), 0.0),
        )
        contact = contacts_along(self.mechanism)[coordinate]
        load = loads.get(contact.name, contact.load)
        return None if load is None else np.asarray(load + 0.0 * self.time, dtype=float)


def _position(joint: Measurement, times: Array) -> Array:
    """Return positions (n,), or the integral of velocities where these were measured alone."""
    if "position" in joint.quantities():
        return np.asarray(joint.values("position"), dtype=float)
    v = np.asarray(joint.values("velocity"), dtype=float)
    return np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(times))])

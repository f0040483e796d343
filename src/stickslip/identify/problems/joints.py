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
2. **Motion.** Velocities and accelerations in :math:`T_i` come from positions in a band `WIDER`
   times that of the balance, whose filter follows. Noise of the acceleration of joint :math:`j`
   is a force :math:`M_{ij}` times it, so that the band of joint :math:`i` is that of noise
   :math:`\sqrt{\sum_j M_{ij}^2 \sigma_j^2} / M_{ii}` of its own position.
3. **Links** that are looked for, and zeros :math:`z` of the positions of each record, which act as
   :math:`\partial T_i / \partial q_j` along it, are found first (`links_of`), from the balances of
   all joints at once with the measured curve of each as its friction, whatever its law is. What
   the curve of joint :math:`i` explains is projected out of its response :math:`y_i` and its
   slopes :math:`U_i`. With the noise :math:`\sigma_i` that is left of it, the share
   :math:`\kappa_i` of its rows that count, and a prior :math:`N(0, Q)`, parameters
   :math:`\theta = (p - p_0, z)` are

   .. math:: \theta \sim N(\Lambda^{-1} \sum_i \kappa_i U_i^T y_i / \sigma_i^2,\; \Lambda^{-1}),
             \qquad \Lambda = Q^{-1} + \sum_i \kappa_i U_i^T U_i / \sigma_i^2 .

   The size of zeros is that with the largest marginal likelihood. Columns of a joint are the axes
   of the covariance by all other joints (`at`), about what all tell, as its own rows tell links in
   its own posterior: of combinations that the motion does not tell apart, each alone is unknown,
   and their sum is not. Errors are `UNSHOWN` times those shown. Another measurement has zeros that
   nothing tells.
4. **Band.** Balances have rows for all these columns: of a short record, more for each second.

Source: M. Gautier, "Dynamic identification of robots with power model", 1997.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from stickslip.data import Measurement, between_gaps
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError
from stickslip.identify.bands import Array
from stickslip.identify.fits import (
    gear_torques,
    joint_inputs,
    positions_of,
    recorded_inputs,
)
from stickslip.identify.forces import Unknown, with_transmitted
from stickslip.identify.posterior import UNSHOWN
from stickslip.identify.problems.joint_motions import check_joints, contacts_along
from stickslip.identify.problems.record_columns import ZERO, Balance, Memory
from stickslip.identify.problems.record_model import LOOKED_FOR, SOFT, share_of
from stickslip.identify.problems.record_rows import (
    MIDDLE,
    PER,
    WIDER,
    cutoff_of,
    even,
    mean_frequency,
    moves,
)
from stickslip.identify.problems.record_signals import (
    FEWEST,
    Filter,
    Record,
    noise_of,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

ROBOTS = 5.0
"""Band of the balances over the mean frequency of the fastest joint, at most: beyond it gears make
accelerations that no torque of a motor goes with (docs: why/filters-and-rest)."""
SEEN = 20.0
"""Range of the positions of a joint that moves, over their noise."""
ROWS = 3.0
"""Rows of a balance over its columns of links, at least: beside them are those of its curve."""
ZEROS = {0.0005: 0.35, 0.003: 0.3, 0.01: 0.25, 0.03: 0.1}
"""Standard deviation of the zeros of positions from record to record [rad] or [m], with its prior:
encoders count from where they were switched on, or set by eye."""
ROUNDS = 4
"""Times that noise is taken again from what parameters leave."""
SAME = math.sqrt(np.finfo(float).eps)
"""Eigenvalue of scaled slopes, over the largest, below which parameters cannot be distinguished."""


NONE_MOVES = "no joint moves in these records: friction cannot be determined."
"""What is to be said where there are no records."""


@dataclass(frozen=True, kw_only=True, eq=False)
class JointRecords:
    """The balance of each joint as records of one coordinate."""

    contacts: Mapping[str, str]
    """Contacts by coordinate: the joints that rub and move."""
    resting: tuple[str, ...]
    """Coordinates that rub and rest: nothing tells their friction."""
    records: Mapping[str, list[Record]]
    """By coordinate, with columns of all parameters that are looked for."""
    numbers: Mapping[str, Sequence[int]]
    """By coordinate, the number of the measured record that each record is of."""
    bands: Mapping[str, float]
    """By coordinate, the band of its balance [Hz]."""
    widest: float
    """Largest band of a balance [Hz]."""
    inertias: Mapping[str, float]
    """What moves with each coordinate, all others at rest [kg m^2] or [kg]."""

    sought: tuple[str, ...]
    """Paths of the parameters that are looked for, and of those with stated errors."""
    zeros: tuple[str, ...]
    """Paths of the zeros of the coordinates."""
    bent: bool
    """Whether forces are not linear in the parameters together."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        measurement: Measurement,
        *,
        unknown: Sequence[str] = (),
        resting: Collection[str] = (),
        bands: Mapping[str, float] = MappingProxyType({}),
    ) -> "JointRecords":
        """Return the records of the joints, with columns for parameters that are looked for.

        Joints that rest stay where they are in the median. The bands [Hz] may be given.
        """
        torques = JointTorques.of(mechanism, unknown, by_position=True)
        pieces = [
            _Piece.of(mechanism, record, piece, resting, number)
            for number, record in enumerate(measurement.records())
            for piece in between_gaps(record)
            if len(np.asarray(piece.time)) >= FEWEST
        ]
        if not pieces:
            raise InputError(
                f"joints need a stretch of at least {FEWEST} samples without a gap: record longer."
            )
        return cls._made(torques, mechanism, pieces, resting, bands)

    def at(self, links: "Links", *, held: bool, again: bool = False) -> dict[str, list[Record]]:
        """Return the records with parameters changed, and as uncertain as they are together.

        Forces may be `held` until the next sample. Records of another measurement (`again`) have
        zeros that nothing tells.
        """
        count, zeros = len(links.paths), self.zeros

        def moved(told: Told, one: Record, number: int) -> Record:
            assert one.mechanism is not None
            own = () if again else zeros
            first = count + len(zeros) * number
            at = [*range(count), *range(first, first + len(own))]
            forces = [one.unknown[path].force for path in (*links.paths, *own)]
            slopes = np.reshape(forces, (len(at), len(one.time))).T
            doubts = dict(links.doubts) | dict.fromkeys(zeros if again else (), links.zero)
            unknown = {path: replace(one.unknown[path], doubt=x) for path, x in doubts.items()}
            name = "links." if count else ZERO
            for k, x in enumerate((slopes @ told.root[at]).T):
                unknown[f"{name}{k}"] = Unknown(force=x, inertia=0.0, doubt=1.0, link=True)
            mechanism = one.mechanism + slopes @ links.told.mean[at]
            return replace(one, mechanism=mechanism, unknown=unknown, held=held)

        return {
            name: [moved(links.beside[name], *x) for x in zip(own, self.numbers[name], strict=True)]
            for name, own in self.records.items()
        }

    @classmethod
    def _made(
        cls,
        torques: JointTorques,
        mechanism: Mechanism,
        pieces: Sequence["_Piece"],
        resting: Collection[str],
        bands: Mapping[str, float],
    ) -> "JointRecords":
        names, contacts = torques.coordinates, contacts_along(mechanism)
        moving = [name not in resting for name in names]
        middle = np.median(np.concatenate([piece.position for piece in pieces]), axis=0)
        mass = _mass(torques, mechanism, middle)
        noise = np.max([piece.noise for piece in pieces], axis=0) * moving
        plain = {
            i: [piece.plain(i, abs(float(mass[i, i]))) for piece in pieces]
            for i, moves in enumerate(moving)
            if moves
        }
        widest = ROBOTS * max(map(mean_frequency, plain.values()), default=math.inf)
        span = sum(float(np.ptp(piece.time)) for piece in pieces)
        widest = max(widest, ROWS * len(torques.linear) / (PER * span))
        records, numbers = dict[str, list[Record]](), dict[str, list[int]]()
        widths = dict[str, float]()
        for i, own in plain.items():
            name, inertia = names[i], abs(float(mass[i, i]))
            if name not in contacts:
                continue
            gain = float(np.linalg.norm(mass[i] * noise) / (inertia * noise[i])) if inertia else 1.0
            noisy = [replace(item, gain=gain) for item in own]
            # where it moves less than its sensor misses, it rests: nothing tells its friction
            seen = [
                (piece, item)
                for piece, item in zip(pieces, noisy, strict=True)
                if np.ptp(item.position) > SEEN * item.position_noise
            ]
            if not seen:
                continue
            cuts = (cutoff_of(even(item)) for _, item in seen if moves(item))
            widths[name] = bands[name] if name in bands else min(*cuts, widest)
            records[name] = [item.along(i, record, torques, widths[name]) for item, record in seen]
            numbers[name] = [item.number for item, _ in seen]
        return cls(
            contacts={name: contacts[name].name for name in records},
            resting=tuple(name for name in contacts if name not in records),
            records=records,
            numbers=numbers,
            bands=widths,
            widest=widest,
            sought=torques.linear,
            zeros=tuple(ZERO + name for name in names),
            bent=torques.bent,
            inertias={name: abs(float(mass[i, i])) for i, name in enumerate(names)},
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class Told:
    """What balances tell of links and of zeros of positions, as a normal distribution."""

    mean: Array
    """Changes of links, then zeros of each coordinate in each record (p,)."""
    root: Array
    """Root of the covariance (p, p)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Links:
    """What the balances of all joints tell of parameters."""

    doubts: Mapping[str, float]
    """Standard errors of parameters that are stated, by path."""
    paths: tuple[str, ...]
    """Parameters that are looked for."""
    told: Told
    """What is told of them, and of zeros."""
    beside: Mapping[str, Told]
    """The same by the balances of all other joints, by coordinate: its own rows count once."""
    zero: float
    """Standard deviation of the zeros [rad] or [m]."""
    lost: tuple[str, ...]
    """Parameters that the motion does not tell from others."""
    left: float
    """What is left of the force of a joint at most, over its standard deviation."""

    @property
    def change(self) -> dict[str, float]:
        """By path, the change from the values that the records were made with."""
        return dict(zip(self.paths, self.told.mean.tolist(), strict=False))

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors; infinite where the motion does not tell a parameter from others."""
        each = np.linalg.norm(self.told.root, axis=1).tolist()
        result = dict(zip(self.paths, each, strict=False))
        return result | dict.fromkeys(self.lost, math.inf)


def links_of(
    records: JointRecords, held: bool, doubts: Mapping[str, float], *, zeros: bool
) -> Links:
    """Return parameters from the balances of all joints at once, with their curves as friction.

    Those with stated errors (`doubts`) keep their values. Zeros of positions differ from record to
    record as usual, or may be anywhere (`zeros`).
    """
    paths = tuple(path for path in records.sought if path not in doubts)
    parts, count = reduced_of(records, held, paths), len(paths)
    usual = LOOKED_FOR * np.min([part.usual for part in parts], axis=0)
    shares = {max(ZEROS): 1.0} if zeros else ZEROS
    zero = max(shares)

    def prior(zero: float) -> Array:
        return np.where(np.arange(len(usual)) < count, usual, zero)

    for _ in range(ROUNDS):
        told = _told(parts, prior(zero))
        parts = [part.weighed(told) for part in parts]
        odds = {x: math.log(p) + _evidence(parts, prior(x)) for x, p in shares.items()}
        zero = max(odds, key=lambda x: odds[x])
    gram = np.sum([part.gram for part in parts], axis=0)[:count, :count]
    scale = np.sqrt(np.diagonal(gram))
    scale[scale == 0.0] = 1.0  # nothing depends on it
    values, basis = np.linalg.eigh(gram / np.outer(scale, scale))
    apart = basis[:, values <= SAME * values.max(initial=0.0)]
    lost = np.sum(apart**2, axis=1) > SAME
    told = _told(parts, prior(zero))
    return Links(
        doubts=doubts,
        paths=paths,
        told=told,
        beside={x.name: _told([y for y in parts if y is not x], prior(zero)) for x in parts},
        left=max(float(np.std(x.response - x.slopes @ told.mean)) / x.spread for x in parts),
        zero=zero,
        lost=tuple(path for path, x in zip(paths, lost.tolist(), strict=True) if x),
    )


def reduced_of(records: JointRecords, held: bool, paths: Sequence[str]) -> "list[Reduced]":
    """Return the balances of all joints less what their curves explain, forces `held` or not."""
    return [
        Reduced.of([replace(item, held=held) for item in own], records, name, paths)
        for name, own in records.records.items()
    ]


@dataclass(frozen=True, kw_only=True, eq=False)
class Reduced:
    """The balance of a joint less what its curve explains."""

    name: str
    slopes: Array
    """By links, and by the zeros of each record (n, p)."""
    response: Array
    """Force (n,)."""
    free: int
    """Degrees of freedom of the rows."""
    size: float
    """Standard deviation of the noise."""
    spread: float
    """Standard deviation of the force that was recorded."""
    kappa: float = 1.0
    """Share of the rows that count."""

    @classmethod
    def of(
        cls, own: Sequence[Record], records: JointRecords, name: str, paths: Sequence[str]
    ) -> "Reduced":
        """Return the balance of a joint, with columns for parameters (paths)."""
        balance = Balance(own, highest=records.widest)
        rows, fixed = balance.rows(MIDDLE), balance.fixed(MIDDLE)
        sides = [
            np.column_stack([piece.direction, np.abs(piece.direction)]) for piece in balance.pieces
        ]
        hats = [balance.frame.hats(piece.velocity) for piece in balance.pieces]
        each = [
            np.hstack([a * b for b in s.T[:, :, None]]) for a, s in zip(hats, sides, strict=True)
        ]
        beside = [fixed[name] for name in ("slope", "given") if name in fixed]
        late = balance.delayed(MIDDLE, Memory())
        x = np.column_stack([rows.seen(each), *beside, late, np.ones(rows.count)])
        x = x / (np.sqrt(np.mean(x * x, axis=0)) + 1e-300)
        values, basis = np.linalg.eigh(x.T @ x)
        kept = values > SOFT * values[-1]
        basis = x @ (basis[:, kept] / np.sqrt(values[kept]))
        of = np.asarray(records.numbers[name])[rows.piece]
        at = of[:, None] == np.arange(1 + max(map(max, records.numbers.values())))
        slopes = [fixed[path] for path in paths] + [fixed[path] * at for path in records.zeros]
        both = np.column_stack([*slopes, rows.response])
        both = both - basis @ (basis.T @ both)
        return cls(
            name=name,
            slopes=both[:, :-1],
            response=both[:, -1],
            free=max(rows.count - int(kept.sum()), 1),
            size=float(np.sqrt(np.mean(rows.response**2))) + 1e-300,
            spread=float(np.std(np.concatenate([item.force for item in own]))) + 1e-300,
        )

    @property
    def gram(self) -> Array:
        """Products of the slopes over the noise (p, p)."""
        return np.asarray(self.kappa / self.size**2 * (self.slopes.T @ self.slopes))

    @property
    def moment(self) -> Array:
        """Products of the slopes with the response over the noise (p,)."""
        return np.asarray(self.kappa / self.size**2 * (self.slopes.T @ self.response))

    @property
    def usual(self) -> Array:
        """Changes by which the response would change as much as it is (p,)."""
        slopes = np.linalg.norm(self.slopes, axis=0) + 1e-150
        return np.asarray(np.linalg.norm(self.response) / slopes)

    def weighed(self, told: Told) -> "Reduced":
        """Return the balance with the noise that parameters leave."""
        left = self.response - self.slopes @ told.mean
        used = float(np.sum((self.slopes @ told.root / (UNSHOWN * self.size)) ** 2)) * self.kappa
        basis, values, _ = np.linalg.svd(self.slopes @ told.root, full_matrices=False)
        kappa = share_of(basis[:, values > SAME * values.max(initial=0.0)] * left[:, None])
        # the mean of the variance over its posterior, to which so many rows go
        free = max(self.free - used, 0.5 * self.free) - 2.0 / kappa
        size = float(np.sqrt(np.sum(left**2) / max(free, 1.0))) + 1e-300
        return replace(self, size=size, kappa=kappa)


def _told(parts: Sequence[Reduced], prior: Array) -> Told:
    """Return what balances tell of parameters with prior standard deviations (p,)."""
    gram, moment = _normal(parts, prior)
    root = np.linalg.inv(np.linalg.cholesky(gram)).T
    return Told(mean=prior * (root @ (root.T @ moment)), root=UNSHOWN * prior[:, None] * root)


def _evidence(parts: Sequence[Reduced], prior: Array) -> float:
    """Return the logarithm of the marginal likelihood of prior standard deviations (p,)."""
    gram, moment = _normal(parts, prior)
    root = np.linalg.cholesky(gram)
    explained = np.linalg.solve(root, moment)
    return float(0.5 * explained @ explained - np.sum(np.log(np.diagonal(root))))


def _normal(parts: Sequence[Reduced], prior: Array) -> tuple[Array, Array]:
    """Return the normal equations of parameters over their priors (p, p) and (p,)."""
    gram = sum(part.gram for part in parts) * np.outer(prior, prior)
    return np.eye(len(prior)) + gram, sum(part.moment for part in parts) * prior


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
    number: int
    """Number of the record."""

    @classmethod
    def of(
        cls,
        mechanism: Mechanism,
        record: Measurement,
        piece: Measurement,
        resting: Collection[str],
        number: int,
    ) -> "_Piece":
        check_joints(piece, mechanism.coordinates)
        joints = [piece.joints[name] for name in mechanism.coordinates]
        times = np.asarray(piece.time, dtype=float)
        step = float(np.median(np.diff(times)))
        even = times[0] + step * np.arange(int((times[-1] - times[0]) / step + 1e-6) + 1)
        places, noise = [positions_of(joint) for joint in joints], list[float]()
        for k, name in enumerate(mechanism.coordinates):
            noise.append(0.0 if name in resting else noise_of(places[k]))
            if name in resting:
                places[k] = np.full_like(places[k], np.median(places[k]))
        forces = [np.asarray(joint.values("force"), float) for joint in joints]
        return cls(
            mechanism=vary(mechanism, "mechanism", record.overrides),
            record=piece,
            time=even,
            position=np.column_stack([np.interp(even, times, x) for x in places]),
            force=np.column_stack([np.interp(even, times, x) for x in forces]),
            noise=noise,
            number=number,
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
        filt = Filter(count=len(self.time), step=step, band=WIDER * band, every=1)
        q = self.position
        v, a = filt(q, slope=1, full=True), filt(q, slope=2, full=True)
        taken, slopes = torques.along(self.mechanism, self.time, filt(q, full=True), v, a)
        inertia = record.inertia or 0.0
        paths = [*torques.linear, *(ZERO + name for name in torques.coordinates)]
        unknown = {
            path: Unknown(force=-slopes[:, i, k], inertia=0.0) for k, path in enumerate(paths)
        }
        name, place = torques.coordinates[i], filt(q, full=True)
        inputs = recorded_inputs(self.record, self.time, name)
        external = self._external(name, place, v)
        if external is not None:  # of what is measured friction is a part
            inputs |= gear_torques(
                v[:, i], self.force[:, i], taken[:, i], external, 2.0 * step * band
            )
        return replace(
            record,
            mechanism=inertia * a[:, i] - taken[:, i],
            unknown=unknown,
            load=self._load(name, place, v),
            inputs=with_transmitted(inputs),
        )

    def _external(self, coordinate: str, q: Array, v: Array) -> Array | None:
        """Return what acts on a joint beside its motor (n,); None where the mechanism is silent."""
        contacts = {along: item.name for along, item in contacts_along(self.mechanism).items()}
        own = joint_inputs(self.mechanism, contacts, self.record, self.time, q, v, self.force)
        known = own[self.mechanism.coordinates.index(coordinate)]
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

"""Friction that was measured, and is predicted along the motion that was measured with it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import ParameterError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.estimation.bristle_integration import balancing, displaced, follow
from stickslip.identify.fits.estimation.parameters import (
    MOVED,
    FreeParameter,
    FreeParameters,
    PerturbedLaws,
)
from stickslip.identify.fits.estimation.problem import (
    FrictionSamples,
    RecordProblem,
    ResidualJacobian,
)
from stickslip.identify.fits.force_map.data import MotionSegment
from stickslip.identify.fits.settings import SensorResponse
from stickslip.mechanisms.contact_inputs import DRIVES

Array = NDArray[np.float64]

LOST = 0.98
"""Most by which friction may grow with the force of a drive: with all of it, nothing moves."""
BENT = 0.02
"""Share of the largest force of a drive over which the slope of friction by it is a difference:
that of its size jumps at 0, and residuals with it."""
WEAK = 1e-3
"""Local states that rows see this much less than the whole stretch does are left as they are."""


@dataclass(frozen=True, kw_only=True, eq=False)
class _Local:
    """One stretch, linearised: what is needed to carry its first bristle state on."""

    start: Array
    """Bristles at the first sample (b,)."""
    states: Array
    """Bristles at the samples (b, n)."""
    residual: Array
    """Measured less predicted, of the rows that are wanted."""
    slopes: Array
    """Of the prediction by the unknowns."""
    basis: Array
    """Orthonormal columns of what first states can do (rows, r)."""
    inverse: Array
    """First states by residual (b, rows)."""

    def near(self, change: Array) -> Array:
        """Return the first state that fits best where the unknowns have changed by (p,)."""
        moved = self.start + self.inverse @ (self.residual - self.slopes @ change)
        # beyond what the motion ever makes of it, a state is an artefact of the noise
        most = 2.0 * np.max(np.abs(self.states), axis=1)
        return np.clip(moved, -most, most)

    def projected(self, columns: Array) -> Array:
        """Return columns less what first states can do."""
        return columns - self.basis @ (self.basis.T @ columns)


class Rederivation(Protocol):
    """Derives friction anew with other values of parameters in which it is not linear."""

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths of these parameters of the mechanism."""

    def __call__(self, values: Mapping[str, float]) -> Sequence[MotionSegment]:
        """Return the stretches at values by path."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceMap(RecordProblem):
    """Measured friction less that of a law along the measured motion, less a constant offset.

    Friction that was derived from a force came through a filter, and so does what the law predicts.
    Parameters of the mechanism it was derived with, in which it is linear, may be among the
    unknowns: a mass, or the inertias of an arm.

    Friction of a gear grows with the force of the drive, of which it is a part: along the measured
    force, one that takes all of it explains any motion. What is left is therefore the error of the
    force that the motion takes by the law: that of friction over the share of the force which
    friction does not take.

    A set-valued law is not defined at rest. Where friction was measured, it is given the sign of
    the measured velocity, else of one that parabolas through neighbouring positions have, and 0
    where that is exactly 0: what such a law cannot say about samples at rest counts against it as
    it stands. Where friction was derived, the other forces are known, too: at rest a law has the
    friction that balances them, as far as its break-away level allows.

    Bristles are integrated through each stretch between gaps from its first sample on, whichever
    segments are wanted: no segment has a state of its own that could take up what the law does not
    explain. Only the state at the very first sample is not known. It begins with what the first
    force says, and is eliminated to first order from the rows that still see it.

    A table beside records in time knows no history: bristle laws are compared with their steady
    friction there.

    Where positions of a record count from a place that is not known, that is eliminated too: what
    it can do to friction, to first order, is projected out of the rows of each stretch.
    """

    law: FrictionLaw
    """Holds the parameters that are not looked for."""
    free_parameters: FreeParameters
    """The free parameters."""
    stretches: tuple[MotionSegment, ...]
    """Measured motion and friction, between gaps."""
    constant: str = "mechanism.offset"
    """Path of the constant force beside friction."""
    offset: float = 0.0
    """Its value [N] where it is not looked for."""
    linear: tuple[str, ...] = ()
    """Paths of the parameters of the mechanism that are looked for, in the order of the columns of
    `MotionSegment.regressors`."""
    derived: tuple[float, ...] = ()
    """Values of all these columns' parameters that friction was derived with."""
    mass: float = 0.0
    """What moves as the contact slips [kg], where friction was derived with it."""
    unidentified: tuple[FreeParameter, ...] = ()
    """What was to be looked for, and nothing in the record depends on; a start that is not a number
    stands for that of the parameter above which it is."""
    one_way: bool = False
    """Whether friction was derived along slip in one direction only, and nobody gave the constant
    force beside it: that is a part of the level."""
    rederived: Rederivation | None = None
    """Derives the stretches anew where parameters are looked for in which friction is not linear,
    such as those of a motor, on whose torque the friction of its gear depends, too."""
    of_applied: bool = False
    """Whether what is measured is the applied force, of which friction is a part."""

    @property
    def quantity(self) -> str:
        return "force" if self.of_applied else "friction"

    @property
    def variation(self) -> float:
        """That of what is measured about its mean."""
        return float(np.sum((self.measured - np.mean(self.measured)) ** 2))

    def with_free_parameters(self, free_parameters: FreeParameters) -> "ForceMap":
        return replace(self, free_parameters=free_parameters)

    @property
    def spans(self) -> Array:
        found = []
        for one in self._of_friction:
            for number in np.unique(one.segment[one.rows_of(None)]):
                own = one.path.time[one.segment == number]
                found.append([one.record, own[0], own[-1]])
        return np.array(found, dtype=float)

    @property
    def _of_friction(self) -> tuple[MotionSegment, ...]:
        """The stretches in which the law stands."""
        return tuple(one for one in self.stretches if not one.winding)

    def _ordered(self, rows: NDArray[Any], segment: NDArray[np.intp]) -> NDArray[Any]:
        """Return rows of all stretches (n, ...) in the order of the problem.

        Those of a winding stand in the segment of the friction beside them, so that blocks of time
        have both.
        """
        if len(self._of_friction) == len(self.stretches):
            return rows
        found: NDArray[Any] = rows[np.argsort(segment, kind="stable")]
        return found

    def _all_rows(self, columns: Sequence[Array]) -> Array:
        """Return the rows that are compared of a column (n,) of each stretch."""
        rows = [one.rows_of(None) for one in self.stretches]
        segment = [one.segment[mask] for one, mask in zip(self.stretches, rows, strict=True)]
        found = [column[mask] for column, mask in zip(columns, rows, strict=True)]
        ordered: Array = self._ordered(np.concatenate(found), np.concatenate(segment))
        return ordered

    @property
    def times(self) -> Array:
        return self._all_rows([one.path.time for one in self.stretches])

    @property
    def measured(self) -> Array:
        columns = [one.applied if self.of_applied else one.friction for one in self.stretches]
        return self._all_rows([column for column in columns if column is not None])

    @property
    def response(self) -> SensorResponse:
        return self.stretches[0].response

    @property
    def samples(self) -> tuple[FrictionSamples, ...]:
        return tuple(
            FrictionSamples(
                time=one.path.time if one.timed else None,
                velocity=one.path.velocity,
                friction=one.friction,
                load=one.path.load,
                beside=self._beside(one),
            )
            for one in self._of_friction
        )

    def _beside(self, one: MotionSegment) -> dict[str, Array]:
        """Return the temperature, and the force through a gear where friction is a part of it."""
        found = {name: x for name, x in one.path.inputs.items() if name == "temperature"}
        if self.of_applied and one.applied is not None:
            found["transmitted"] = np.abs(one.applied - one.friction)
        return found

    @property
    def held_offset(self) -> float:
        return float(self.offset)

    def along(self, stretches: Sequence[MotionSegment], measurement: Measurement) -> "ForceMap":
        """Return the same along other stretches, with the constant force that records set.

        Records that set different ones keep that of the mechanism.
        """
        offsets = {one.overrides.get(self.constant, self.offset) for one in measurement.records()}
        offset = offsets.pop() if len(offsets) == 1 else self.offset
        return replace(self, stretches=tuple(stretches), offset=offset)

    def predicted(self, values: Array) -> Array:
        """Return friction and offset by the law (n,) [N], nothing projected out.

        Examples
        --------
        >>> from stickslip import Axis, Coulomb, Measurement
        >>> from stickslip.identify.fits.force_map.problem import force_map
        >>> v = np.linspace(-1.0, 1.0, 8)
        >>> table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.5)
        >>> problem = force_map(Coulomb, Axis(inertia=1.0), table)
        >>> problem.free_parameters.paths
        ('friction.kinetic_coefficient', 'mechanism.offset')
        >>> problem.predicted(np.array([2.0, 0.5]))[[0, -1]]
        array([-1.5,  2.5])
        """
        near = self.linearise(values, slopes=False)
        locals_: Mapping[int, _Local] = near.memory
        if not locals_:
            return np.full(len(self.times), np.nan)
        segment = np.concatenate([one.segment[one.rows_of(None)] for one in self.stretches])
        residual = np.concatenate([one.residual for one in locals_.values()])
        ordered: Array = self._ordered(residual, segment)
        return self.measured - ordered

    def linearise(
        self,
        values: Array,
        near: ResidualJacobian | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> ResidualJacobian:
        if self.rederived is not None:
            return self._rederived(self.rederived, values, near, only, slopes=slopes)
        masks = [one.rows_of(only) for one in self.stretches]
        segment = np.concatenate(
            [one.segment[mask] for one, mask in zip(self.stretches, masks, strict=True)]
        )
        known: Mapping[int, _Local] = near.memory if near is not None else {}
        change = np.zeros(len(values)) if near is None else values - near.values
        done: dict[int, _Local] = {}
        with np.errstate(all="ignore"):  # a law that fails far out gives infinite residuals
            try:
                own = PerturbedLaws.of(
                    self.law, self.free_parameters, values, constant=self.constant, slopes=slopes
                )
                linear = self._linear(values)
                for k, mask in enumerate(masks):
                    if mask.any():
                        one = self.stretches[k]
                        done[k] = self._local(one, mask, own, linear, known.get(k), change)
            except (ParameterError, ArithmeticError):
                done = {}
        good = all(np.all(np.isfinite(one.residual)) for one in done.values())
        if not done or not good:
            return _failed(values, self._ordered(segment, segment))
        residual = np.concatenate([one.projected(one.residual) for one in done.values()])
        table = np.concatenate([one.projected(one.slopes) for one in done.values()])
        return ResidualJacobian(
            values=values,
            residual=self._ordered(residual, segment),
            slopes=self._ordered(table, segment),
            segment=self._ordered(segment, segment),
            memory=done,
        )

    def carried(self, seen: ResidualJacobian) -> Array:
        return self.linearise(seen.values, seen, slopes=False).residual

    def _rederived(
        self,
        rederived: Rederivation,
        values: Array,
        near: ResidualJacobian | None,
        only: Sequence[int] | None,
        *,
        slopes: bool,
    ) -> ResidualJacobian:
        """Return what stretches derived at these values leave; slopes by them are differences."""
        at = [self.free_parameters.paths.index(path) for path in rederived.paths]

        def seen(values: Array, *, slopes: bool) -> ResidualJacobian:
            own = dict(zip(rederived.paths, values[at].tolist(), strict=True))
            try:
                stretches = tuple(rederived(own))
            except (ParameterError, ArithmeticError):
                rows = np.concatenate([one.segment[one.rows_of(only)] for one in self.stretches])
                return _failed(values, self._ordered(rows, rows))
            one = replace(self, stretches=stretches, rederived=None)
            return one.linearise(values, near, only=only, slopes=slopes)

        here = seen(values, slopes=slopes)
        if not (slopes and here.finite):
            return here
        table = here.slopes.copy()
        for column in at:
            start = self.free_parameters.items[column].start
            step = MOVED * (max(abs(values[column]), abs(start)) or 1.0)
            there = seen(values + step * (np.arange(len(values)) == column), slopes=False)
            table[:, column] = (here.residual - there.residual) / step
        return ResidualJacobian(
            values=values,
            residual=here.residual,
            slopes=table,
            segment=here.segment,
            memory=here.memory,
        )

    def _linear(self, values: Array) -> Array:
        """Return the parameters of the mechanism that are looked for (k,)."""
        paths = self.free_parameters.paths
        return np.array([values[paths.index(path)] for path in self.linear])

    def _local(
        self,
        one: MotionSegment,
        mask: NDArray[np.bool_],
        own: PerturbedLaws,
        linear: Array,
        before: _Local | None,
        change: Array,
    ) -> _Local:
        """Return one stretch linearised, of the rows in a mask (n,)."""
        if one.winding:
            return _in_winding(one, mask, len(change))
        offset = self.offset if own.offset is None else own.offset
        # a filter sees what comes later, too
        last = len(mask) if one.passed else int(np.flatnonzero(mask)[-1]) + 1
        one = one.until(last)
        weighed = one.weighed and bool(self.linear)
        if weighed:  # by the only parameter, which is the mass
            one = one.loaded(float(linear[0]) / self.derived[0])
        change_of = linear - self.derived[: len(linear)]
        if self.linear:
            one = moved(one, change_of)
        force, states, nudge = _friction(own, one, offset, before, change)
        rows = mask[:last]
        balanced = _balanced(one, force[:, 0], offset)
        by_weight = np.zeros(last)
        if weighed:
            by_weight = _by_weight(own, one, states[..., 0], force[:, 0] * ~balanced)
        left = one.friction - offset
        force, gain = _seen(own, one, force, left, offset, before, change)
        local = (force[:, 1 + len(own.moved) :] - force[:, :1])[:, : len(states)] / nudge
        residual, slopes = left - force[:, 0], own.slopes_of(force)
        if own.constant is not None:
            slopes[:, own.constant] = gain[:, 0] * (1.0 - one.seen(balanced.astype(float)))
        if self.linear:
            columns = one.by_linear(balanced)
            if weighed:
                columns = columns + one.seen(by_weight)[:, None] / linear[0]
            columns = gain * columns
            if own.columns and any(name in one.path.input_slopes for name in own.base.inputs):
                columns = columns + _by_inputs(own, one, left, offset, before, change)
            paths = self.free_parameters.paths
            slopes[:, [paths.index(path) for path in self.linear]] = columns
        basis, inverse = _inverted(local, rows)
        if one.zeros is not None:
            # at rest friction balances whatever there is
            free = gain * one.zeros * ~balanced[:, None]
            basis = spanned(np.column_stack([basis, free[rows]]))
        return _Local(
            start=states[:, 0, 0],
            states=states[..., 0],
            residual=residual[rows],
            slopes=slopes[rows],
            basis=basis,
            inverse=inverse,
        )


def _in_winding(one: MotionSegment, mask: NDArray[np.bool_], count: int) -> _Local:
    """Return the rows of a winding: they change with what the stretch is derived with alone."""
    rows = int(mask.sum())
    return _Local(
        start=np.zeros(0),
        states=np.zeros((0, len(mask))),
        residual=one.friction[mask],
        slopes=np.zeros((rows, count)),
        basis=np.zeros((rows, 0)),
        inverse=np.zeros((0, rows)),
    )


def moved(one: MotionSegment, change: Array) -> MotionSegment:
    """Return a stretch as if friction had been derived with other parameters of the mechanism."""
    if one.regressors is None:
        return one
    held = one.held
    if held is not None and one.held_regressors is not None:
        held = held - one.held_regressors @ change
    path = one.path.moved(change)
    return replace(one, path=path, friction=one.friction - one.regressors @ change, held=held)


def _by_inputs(
    own: PerturbedLaws,
    one: MotionSegment,
    left: Array,
    offset: float,
    before: _Local | None,
    change: Array,
) -> Array:
    """Return slopes of friction (n, k) by parameters that contact inputs change with.

    An error of a weight is one of what a gear transmits, too.
    """
    bare = replace(own, law=own.base, moved=np.zeros(0), columns=())
    slopes = {n: x for n, x in one.path.input_slopes.items() if n in own.base.inputs}
    count = next(iter(slopes.values())).shape[1]
    found = np.zeros((len(left), count))

    def force(change_of: Array) -> Array:
        there = replace(one, path=one.path.moved(change_of))
        unseen = _friction(bare, there, offset, before, change)[0]
        return _seen(bare, there, unseen, left, offset, before, change)[0][:, 0]

    here = force(np.zeros(count))
    for j in range(count):
        most = max(float(np.max(np.abs(x[:, j]))) for x in slopes.values())
        if most > 0.0:
            size = max(float(np.max(np.abs(one.path.inputs[name]))) for name in slopes)
            step = MOVED * (size or 1.0) / most * (np.arange(count) == j)
            found[:, j] = (force(step) - here) / step[j]
    return found


def _seen(
    own: PerturbedLaws,
    one: MotionSegment,
    force: Array,
    left: Array,
    offset: float,
    before: _Local | None,
    change: Array,
) -> tuple[Array, Array]:
    """Return friction (n, copies) as it is seen, `left` (n,) of all other forces, and its gain.

    An error of friction is one of the force of a drive times a gain (n, 1): where friction grows
    with that force, what friction does not take is what the motion has.
    """
    seen = one.seen(force)
    inputs = {name: one.path.inputs[name] for name in DRIVES if name in own.base.inputs}
    if not (one.passed and inputs):
        return seen, np.ones((len(left), 1))
    step = BENT * max(float(np.max(np.abs(x))) for x in inputs.values()) or BENT
    there = []
    for way in (step, -step):
        known = {**one.path.inputs, **{name: x + way for name, x in inputs.items()}}
        path = replace(one.path, inputs=known)
        there.append(_friction(own, replace(one, path=path), offset, before, change)[0])
    share = one.seen((there[0] - there[1]) / (2.0 * step))
    if np.max(share[:, 0]) > LOST:
        raise ArithmeticError("friction takes all of the force of the drive: nothing moves.")
    gain = 1.0 / (1.0 - np.minimum(share, LOST))
    return left[:, None] - gain * (left[:, None] - seen), gain[:, :1]


def _friction(
    own: PerturbedLaws, one: MotionSegment, offset: float, before: _Local | None, change: Array
) -> tuple[Array, Array, float]:
    """Return friction (n, copies), bristles (b, n, copies), and by how much they were moved."""
    count = len(one.path.time)
    states, nudge = np.zeros((0, count, own.count)), 1.0
    if own.law.states and one.timed:
        force, states, nudge = _with_memory(own, one, offset, before, change)
    else:
        force = _without_memory(own.law, one)
    force = np.broadcast_to(force, (count, own.count))
    return _at_rest(own.law, one, force, states, offset), states, nudge


def _balanced(one: MotionSegment, force: Array, offset: float) -> NDArray[np.bool_]:
    """Return at which samples (n,) friction balances all else, an offset included."""
    if one.held is None or one.resting is None:
        return np.zeros(len(force), dtype=bool)
    return np.asarray(one.resting & (force == one.held - offset))


def _by_weight(own: PerturbedLaws, one: MotionSegment, states: Array, resting: Array) -> Array:
    """Return by how much friction (n,) [N] grows with the relative growth of the load.

    At rest, that is given (n,): weight moves what friction is held within.
    """
    law: Any = one.path.told(own.base)
    v, n = one.path.velocity[:, None], one.path.load[:, None]

    def force(load: Array) -> Array:
        found = law.force(v, load, tuple(states[..., None])) if len(states) else law.steady(v, load)
        return np.asarray(found)

    # friction is affine in the load, so that any difference is exact
    growth: Array = (force(2.0 * n) - force(n) + 0.0 * v)[:, 0]
    return growth if one.resting is None else np.where(one.resting, resting, growth)


def _without_memory(law: Any, one: MotionSegment) -> Array:
    """Return the friction of a law that knows no history, or in steady slip (n, copies)."""
    return _in_slip(one.path.told(law), one.path.velocity[:, None], one.path.load[:, None])


def _in_slip(law: Any, v: Array | float, n: Array) -> Array:
    """Return friction in steady slip at velocities, under loads (n, 1)."""
    return np.asarray(law.steady(v, n))


def _at_rest(law: Any, one: MotionSegment, force: Array, states: Array, offset: float) -> Array:
    """Return friction (n, copies) with what holds the body at rest: what other forces ask for.

    Rest is motion that the sensor does not resolve. Friction is then what balances the other
    forces, as far as displacements within the resolution make it so: within the cone, or what slow
    slip has, for a set-valued law; within a narrow range for soft bristles. The stiffer bristles
    are, the nearer they come to the cone.
    """
    if one.held is None or one.resting is None or not one.resting.any():
        return force
    rows = np.flatnonzero(one.resting)
    n, law = one.path.load[rows, None], one.path.told(law, rows)
    if len(states):
        low, high = (
            law.force(0.0 * n, n, tuple(displaced(law, states[:, rows], n, way)))
            for way in (-one.resolution, one.resolution)
        )
    else:
        low, high = (side * law.towards(side).break_away(n) for side in (-1, 1))
        if one.slowness > 0.0:
            back, ahead = (_in_slip(law, side * one.slowness, n) for side in (-1, 1))
            low, high = np.minimum(low, back), np.maximum(high, ahead)
        low, high = low - one.slack, high + one.slack
    force = force.copy()
    force[rows] = np.clip(one.held[rows, None] - offset, low, high)
    return force


def _with_memory(
    own: PerturbedLaws, one: MotionSegment, offset: float, before: _Local | None, change: Array
) -> tuple[Array, Array, float]:
    """Return friction along a motion (n, copies), bristles (b, n, copies), and their nudge."""
    if before is None:
        wanted = float(one.friction[0]) - offset
        start = balancing(own.base, one.path, wanted, own.bristles)[:, 0]
        guess = follow(own.base, one.path, start[:, None])[..., 0]
    else:
        start, guess = before.near(change), before.states
    nudge = MOVED * max(float(np.max(np.abs(guess))), 1e-300)
    starts = np.repeat(start[:, None], own.count, axis=1)
    for k in range(own.bristles):
        starts[k, 1 + len(own.moved) + k] += nudge
    states = follow(own.law, one.path, starts, _extended(guess, len(one.path.time)))
    v, n = one.path.velocity[:, None], one.path.load[:, None]
    return np.asarray(one.path.told(own.law).force(v, n, tuple(states))), states, nudge


def _extended(states: Array, count: int) -> Array:
    """Return states (b, count), the last one repeated where there are fewer."""
    rows = np.minimum(np.arange(count), states.shape[1] - 1)
    found: Array = states[:, rows]
    return found


def _inverted(local: Array, rows: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return the space of first states in some rows (r, k), and what gives them by residual."""
    count = local.shape[1]
    seen = local[rows]
    whole = np.linalg.norm(local, axis=0)
    strong = (np.linalg.norm(seen, axis=0) > WEAK * whole) & np.isfinite(whole)
    inverse = np.zeros((count, len(seen)))
    if not strong.any():
        return np.zeros((len(seen), 0)), inverse
    u, s, v = np.linalg.svd(seen[:, strong] / whole[strong], full_matrices=False)
    kept = s > WEAK * s[0]
    inverse[strong] = ((v[kept].T / s[kept]) @ u[:, kept].T) / whole[strong, None]
    return u[:, kept], inverse


def spanned(columns: Array) -> Array:
    """Return orthonormal columns that span others (n, r); none if all are 0."""
    size = np.linalg.norm(columns, axis=0)
    columns = columns[:, size > 0.0] / size[size > 0.0]
    if not columns.shape[1]:
        return columns
    u, s, _ = np.linalg.svd(columns, full_matrices=False)
    found: Array = u[:, s > WEAK * s.max(initial=0.0)]
    return found


def _failed(values: Array, segment: NDArray[np.intp]) -> ResidualJacobian:
    return ResidualJacobian(
        values=values,
        residual=np.full(len(segment), np.inf),
        slopes=np.zeros((len(segment), len(values))),
        segment=segment,
        memory={},
    )

"""Multiple shooting: a record is simulated segment by segment, each from a state of its own.

The initial states of segments are eliminated to first order: their part of the residuals is
projected out, and they follow the other unknowns from one linearisation to the next.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.friction import BristleLaw, FrictionLaw
from stickslip.identification.initial_states import (
    SETTLING,
    LocalState,
    followed,
    settled,
    worse,
)
from stickslip.identification.problem import STEEPEST, Linearised, RecordProblem
from stickslip.identification.unknowns import Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary
from stickslip.solver import EventDriven
from stickslip.trajectory import Trajectory

__all__ = ["Segment", "Shooting"]

Array = NDArray[np.float64]

SOLVER = EventDriven(tier="compiled", tolerance=1e-9, stiff_tolerance=1e-6, max_steps=5_000)
"""Six digits below the noise of any record. A segment takes a few hundred steps; where it takes
thousands, parameters have gone where nothing moves as measured."""


FIRST = 20
"""First rows of a segment from whose slope it is seen whether the body may be at rest ..."""
UNSEEN = 3.0
"""... if that is less than so many standard errors."""
SETTLED = 0.02
"""Bristles are settled that the first velocity bends within this share of a segment."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Segment:
    """A stretch of a record and what drives the mechanism in it."""

    record: int
    """Which record it is of."""
    start: float
    """First time in the record [s]."""
    mechanism: Mechanism
    """As set in this record, with the drive of this stretch; times count from its start."""
    times: Array
    """Times (n,) [s] from the start, at which it is compared."""
    measured: Array
    """What was measured there (n,)."""
    guess: Array
    """First guess of coordinates and rates (m,)."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Shooting(RecordProblem):
    """Positions (or velocities) of segments simulated with the measured drive."""

    law: FrictionLaw
    unknowns_: Unknowns
    segments: tuple[Segment, ...]
    quantity_: str = "position"

    @property
    @override
    def unknowns(self) -> Unknowns:
        return self.unknowns_

    @property
    @override
    def quantity(self) -> str:
        return self.quantity_

    @property
    @override
    def spans(self) -> Array:
        return np.array(
            [[s.record, s.start + s.times[0], s.start + s.times[-1]] for s in self.segments]
        )

    @property
    @override
    def times(self) -> Array:
        return np.concatenate([s.start + s.times for s in self.segments])

    @property
    @override
    def measured(self) -> Array:
        return np.concatenate([s.measured for s in self.segments])

    @override
    def linearise(
        self,
        values: Array,
        near: Linearised | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> Linearised:
        chosen = range(len(self.segments)) if only is None else only
        known: Mapping[int, LocalState] = near.memory if near is not None else {}
        change = np.zeros(len(values)) if near is None else values - near.values
        try:
            law, mechanisms = self._changed(values)
        except ParameterError:
            return _failed(values, [self.segments[k] for k in chosen], chosen)

        def one(k: int, before: LocalState | None) -> LocalState | None:
            segment, mechanism = self.segments[k], mechanisms[id(self.segments[k].mechanism)]
            shoot = partial(self._shot, segment, mechanism, law)
            at_rest = _may_rest(segment, self.quantity)
            if before is not None:
                shot = partial(shoot, slopes=slopes)
                return followed(before, change, segment.guess, shot, at_rest=at_rest)
            best = settled(segment.guess, partial(shoot, slopes=False), at_rest=at_rest)
            if best is None or not slopes:
                return best
            again = shoot(best.state, slopes=True)
            return None if again is None else replace(again, damping=best.damping)

        found = {k: one(k, known.get(k)) for k in chosen}
        if slopes and known and not change.any():
            # at the end of a descent: states carried on from poor values may be those of a side
            # valley, which shows in segments that fit worse than most
            for k, poor in worse(found).items():
                again = one(k, None)
                if again is not None and again.misfit < (1.0 - SETTLING) * poor.misfit:
                    found[k] = again
        return self._joined(values, chosen, list(found.values()))

    def _changed(self, values: Array) -> tuple[FrictionLaw, Mapping[int, Mechanism]]:
        """Return the law and, by identity, the segments' mechanisms with other values."""
        pairs = dict(zip(self.unknowns.paths, map(float, values), strict=True))
        own = {path: value for path, value in pairs.items() if path.startswith("mechanism.")}
        law = vary(self.law, "friction", {p: v for p, v in pairs.items() if p not in own})
        return law, {
            id(s.mechanism): vary(s.mechanism, "mechanism", own) if own else s.mechanism
            for s in self.segments
        }

    def _shot(
        self,
        segment: Segment,
        mechanism: Mechanism,
        law: FrictionLaw,
        state: Array,
        *,
        slopes: bool,
    ) -> LocalState | None:
        """Return a segment simulated from a state; None if the run fails or leaves all bounds."""
        run = _run(segment, mechanism, law, state)
        if run is None:
            return None
        column = run.states.index(_state_of(mechanism, self.quantity))
        inner = run.states[: 2 * len(mechanism.coordinates)]
        paths = [*(self.unknowns.paths if slopes else ()), *(f"initial.{n}" for n in inner)]
        assert run.differentiate is not None
        table = run.differentiate(segment.times, paths)[:, column, :]
        table = np.where(np.isfinite(table), table, 0.0)
        if np.max(np.abs(table)) >= STEEPEST:
            return None
        count = len(paths) - len(inner)
        own, local = table[:, :count], table[:, count:]
        units = np.ones(len(inner))
        units[len(mechanism.coordinates) :] = 1.0 / float(segment.times[-1])
        columns, singular, directions = np.linalg.svd(local * units, full_matrices=False)
        return LocalState(
            state=state,
            residual=segment.measured - _seen(run, segment.times, column),
            size=float(np.ptp(segment.measured)),
            slopes=own if slopes else np.zeros((len(segment.times), len(self.unknowns))),
            units=units,
            columns=columns,
            singular=singular,
            directions=directions,
        )

    def runs(self, seen: Linearised) -> tuple[Trajectory, ...]:
        """Return the segments simulated again from their fitted states, each with its certificate.

        Times of a run count from the start of its segment.
        """
        law, mechanisms = self._changed(seen.values)
        same = np.zeros(len(self.unknowns))
        found = [
            _run(one, mechanisms[id(one.mechanism)], law, seen.memory[k].near(same))
            for k, one in enumerate(self.segments)
            if k in seen.memory
        ]
        return tuple(run for run in found if run is not None)

    def _joined(
        self, values: Array, chosen: Sequence[int], shots: Sequence[LocalState | None]
    ) -> Linearised:
        done = [shot for shot in shots if shot is not None]
        if len(done) < len(shots):
            return _failed(values, [self.segments[k] for k in chosen], chosen)
        return Linearised(
            values=values,
            residual=np.concatenate([shot.projected(shot.residual) for shot in done]),
            slopes=np.concatenate([shot.projected(shot.slopes) for shot in done]),
            segment=np.repeat(chosen, [len(shot.residual) for shot in done]),
            memory=dict(zip(chosen, done, strict=True)),
        )


def _may_rest(segment: Segment, quantity: str) -> bool:
    """Whether the first samples of a segment are those of a body at rest, as far as one can see."""
    count = min(len(segment.times), FIRST)
    t, x = segment.times[:count], segment.measured[:count]
    columns = np.vander(t - t.mean(), 2 if quantity == "position" else 1)
    found = np.linalg.lstsq(columns, x, rcond=None)[0]
    left = x - columns @ found
    error = np.sqrt(left @ left / (count - columns.shape[1]) / np.sum(columns[:, 0] ** 2))
    return bool(abs(found[0]) <= UNSEEN * error)


def _run(
    segment: Segment, mechanism: Mechanism, law: FrictionLaw, state: Array
) -> Trajectory | None:
    """Return a segment simulated from a state; None if the run fails."""
    if not np.all(np.isfinite(state)):
        return None
    end = float(segment.times[-1])
    start = [*state.tolist(), *_bristles(mechanism, law, state, end)]
    run = SOLVER.run(mechanism, law, y0=start, t_end=end)
    return run if run.status.complete else None


def _bristles(mechanism: Mechanism, law: FrictionLaw, state: Array, end: float) -> list[float]:
    """Return bristles that slip has settled before the segment, or 0 where slip is too slow.

    They are not free like the other initial states: what they do in the first micrometres, an
    initial velocity does nearly as well, and both together are torn apart by noise.
    """
    if not isinstance(law, BristleLaw):
        return []
    slip = mechanism.coordinates.index(mechanism.contacts()[0].slip)
    v = float(state[slip + len(mechanism.coordinates)])
    if len(law.bristles) != 1 or v == 0.0:
        return [0.0] * len(law.bristles)
    at_rest, moved = (law.force(v, (z,), 1.0) for z in (0.0, 1e-6))
    z = 1e-6 * float((law.steady(v, 1.0) - at_rest) / (moved - at_rest))
    return [z if abs(z) < SETTLED * abs(v) * end else 0.0]


def _state_of(mechanism: Mechanism, quantity: str) -> str:
    """Return the name of the state that a quantity is of the slipping body."""
    slip = mechanism.contacts()[0].slip
    if quantity == "position":
        return slip
    return mechanism.rates[mechanism.coordinates.index(slip)]


def _seen(run: Trajectory, times: Array, column: int) -> Array:
    return run.at(times)[run.states[column]]


def _failed(values: Array, segments: Sequence[Segment], chosen: Sequence[int]) -> Linearised:
    sizes = [len(s.times) for s in segments]
    return Linearised(
        values=values,
        residual=np.full(sum(sizes), np.inf),
        slopes=np.zeros((sum(sizes), len(values))),
        segment=np.repeat(chosen, sizes),
        memory={},
    )

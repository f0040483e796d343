"""Multiple shooting: a record is simulated segment by segment, each from a state of its own.

The initial states of segments are eliminated to first order: their part of the residuals is
projected out, and they follow the other unknowns from one linearisation to the next.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.friction import BristleLaw, FrictionLaw
from stickslip.identification.problem import STEEPEST, Linearised, RecordProblem
from stickslip.identification.unknowns import Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary
from stickslip.solver import EventDriven
from stickslip.trajectory import Trajectory

__all__ = ["Segment", "Shooting"]

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-7
"""Singular values of the local states' slopes, over the largest, that are not told from 0."""
SOLVER = EventDriven(tier="compiled", tolerance=1e-9, stiff_tolerance=1e-6, max_steps=5_000)
"""Six digits below the noise of any record. A segment takes a few hundred steps; where it takes
thousands, parameters have gone where nothing moves as measured."""


ROUNDS = 12
"""Steps at most in which a first initial state is fitted."""
SETTLING = 0.01
"""It is fitted when a step promises to lower the misfit by less than this share."""
FIRST = 20
"""First rows of a segment from whose slope it is seen whether the body may be at rest ..."""
UNSEEN = 3.0
"""... if that is less than so many standard errors."""
WORSE = 1.3
"""Segments are looked at again whose mean square is so many times the median of all: that of a
hundred rows of noise scatters by a seventh."""
EXACT = 1e-6
"""Root mean square, over the size of the motion, that no step need take off: the solver's own."""
DAMPING = 1e-6
"""First damping of these steps, over the largest eigenvalue of the normal equations."""
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e4
"""Its bounds: at the upper one, nothing moves any more."""
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


@dataclass(frozen=True, kw_only=True, eq=False)
class _Local:
    """One segment, linearised: what is needed to carry its initial state on.

    Steps of initial states are damped (Levenberg) in units of the motion: a velocity counts as the
    way that it makes in the length of the segment. In the units of its own effect, the initial
    velocity of a body that stays at rest would be moved without end: all it does is to shift where
    the body stops, by next to nothing, as the initial position does too.
    """

    state: Array
    """Initial coordinates and rates (m,)."""
    residual: Array
    """Measured less what is simulated from this very state (n,)."""
    size: float
    """Largest change of what was measured."""
    slopes: Array
    """By the unknowns (n, p)."""
    units: Array
    """What initial coordinates and rates are counted in (m,)."""
    columns: Array
    """Orthonormal (n, m): left singular vectors of the slopes by initial states in these units."""
    singular: Array
    """Singular values (m,)."""
    directions: Array
    """Right singular vectors, in rows (m, m)."""
    damping: float = DAMPING
    """Over the largest singular value squared."""

    @property
    def misfit(self) -> float:
        """Sum of squares from this very state."""
        return float(self.residual @ self.residual)

    @property
    def basis(self) -> Array:
        """Orthonormal columns of what initial states can do (n, r)."""
        return self.columns[:, self.singular > NEGLIGIBLE * self.singular[0]]

    @property
    def settled(self) -> bool:
        """Whether another step promises next to nothing, or less than the solver is exact to."""
        kept = 1.0 - self._damped * self.singular
        promised = float(np.sum((self.columns.T @ self.residual) ** 2 * (1.0 - kept**2)))
        exact = len(self.residual) * (EXACT * self.size) ** 2
        return promised <= max(SETTLING * self.misfit, exact)

    @property
    def _damped(self) -> Array:
        """Inverse of the singular values (m,), damped."""
        bottom = self.singular**2 + self.damping * self.singular[0] ** 2
        found: Array = self.singular / np.maximum(bottom, np.finfo(float).tiny)
        return found

    def near(self, change: Array) -> Array:
        """Return the initial state that fits better where the unknowns have changed by (p,)."""
        wanted = self.columns.T @ (self.residual - self.slopes @ change)
        return self.state + self.units * (self.directions.T @ (self._damped * wanted))

    def stepped(self, *, well: bool) -> "_Local":
        """Return the segment with less damping if its last step went well, else with more."""
        damping = self.damping / 10.0 if well else self.damping * 100.0
        return replace(self, damping=min(max(damping, LEAST_DAMPING), MOST_DAMPING))

    def projected(self, columns: Array) -> Array:
        """Return columns less what initial states can do."""
        return columns - self.basis @ (self.basis.T @ columns)


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
        known: Mapping[int, _Local] = near.memory if near is not None else {}
        change = np.zeros(len(values)) if near is None else values - near.values
        try:
            law, mechanisms = self._changed(values)
        except ParameterError:
            return _failed(values, [self.segments[k] for k in chosen], chosen)

        def one(k: int, before: _Local | None) -> _Local | None:
            segment, mechanism = self.segments[k], mechanisms[id(self.segments[k].mechanism)]
            shoot = partial(self._shot, segment, mechanism, law)
            at_rest = _may_rest(segment, self.quantity)
            if before is not None:
                shot = partial(shoot, slopes=slopes)
                return _followed(before, change, segment.guess, shot, at_rest=at_rest)
            best = _settled(segment.guess, partial(shoot, slopes=False), at_rest=at_rest)
            if best is None or not slopes:
                return best
            again = shoot(best.state, slopes=True)
            return None if again is None else replace(again, damping=best.damping)

        found = {k: one(k, known.get(k)) for k in chosen}
        if slopes and known and not change.any():
            # at the end of a descent: states carried on from poor values may be those of a side
            # valley, which shows in segments that fit worse than most
            for k, poor in _worse(found).items():
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
    ) -> _Local | None:
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
        return _Local(
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
        self, values: Array, chosen: Sequence[int], shots: Sequence[_Local | None]
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


def _settled(
    guess: Array, shoot: Callable[[Array], _Local | None], *, at_rest: bool
) -> _Local | None:
    """Return a segment from the initial state that fits it best; None if no run succeeds."""
    first = shoot(guess)
    best = None if first is None else _descended(first, shoot)
    return _or_at_rest(best, guess, shoot) if at_rest or best is None else best


def _followed(
    before: _Local,
    change: Array,
    guess: Array,
    shoot: Callable[[Array], _Local | None],
    *,
    at_rest: bool,
) -> _Local | None:
    """Return a segment where the unknowns have changed by (p,): from a state carried on.

    Where that fits worse than the old state was promised to, the old state is tried as well.
    """
    moved = shoot(before.near(change))
    best = None if moved is None else replace(moved, damping=before.damping).stepped(well=True)
    expected = before.residual - before.slopes @ change
    if best is None or best.misfit > float(expected @ expected):
        stayed = shoot(before.state)
        if stayed is not None and (best is None or stayed.misfit < best.misfit):
            best = replace(stayed, damping=before.damping).stepped(well=False)
    if best is not None:
        best = _descended(best, shoot)
    return _or_at_rest(best, guess, shoot) if at_rest or best is None else best


def _or_at_rest(
    best: _Local | None, guess: Array, shoot: Callable[[Array], _Local | None]
) -> _Local | None:
    """Return a segment from rest, unless an initial velocity fits it clearly better.

    Rest is not found downhill: a body that moves at first slides to where it is just stuck, and all
    that its velocity does is to shift that place.
    """
    half = len(guess) // 2
    if best is not None and not best.state[half:].any():
        return best
    first = shoot(np.where(np.arange(len(guess)) < half, guess, 0.0))
    if first is None:
        return best
    rested = _descended(first, shoot)
    clearly = best is not None and best.misfit < (1.0 - SETTLING) * rested.misfit
    return best if clearly else rested


def _worse(found: Mapping[int, _Local | None]) -> Mapping[int, _Local]:
    """Return the segments whose mean square is above that of most."""
    done = {k: one for k, one in found.items() if one is not None}
    squares = {k: one.misfit / len(one.residual) for k, one in done.items()}
    usual = float(np.median(list(squares.values()))) if squares else 0.0
    return {k: one for k, one in done.items() if squares[k] > WORSE * usual}


def _may_rest(segment: Segment, quantity: str) -> bool:
    """Whether the first samples of a segment are those of a body at rest, as far as one can see."""
    count = min(len(segment.times), FIRST)
    t, x = segment.times[:count], segment.measured[:count]
    columns = np.vander(t - t.mean(), 2 if quantity == "position" else 1)
    found = np.linalg.lstsq(columns, x, rcond=None)[0]
    left = x - columns @ found
    error = np.sqrt(left @ left / (count - columns.shape[1]) / np.sum(columns[:, 0] ** 2))
    return bool(abs(found[0]) <= UNSEEN * error)


def _descended(best: _Local, shoot: Callable[[Array], _Local | None]) -> _Local:
    """Return a segment from the best state met on the way down.

    What is projected out of residuals is what a state can do to first order: it is true only of a
    state from which there is next to nothing left to do.
    """
    nothing = np.zeros(best.slopes.shape[1])
    for _ in range(ROUNDS):
        if best.settled:
            break
        there = shoot(best.near(nothing))
        if there is None or there.misfit >= best.misfit:
            best = best.stepped(well=False)
        else:
            best = replace(there, damping=best.damping).stepped(well=True)
    return best


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

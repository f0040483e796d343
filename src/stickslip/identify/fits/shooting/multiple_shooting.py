"""Multiple shooting: a record is simulated segment by segment, each from a state of its own.

The initial states of segments are eliminated to first order: their part of the slopes is projected
out, and they follow the other unknowns from one linearisation to the next.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.executors import on_threads
from stickslip.engine.solver import BareRun, EventDriven
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.levenberg_marquardt import STEEPEST, ResidualJacobian
from stickslip.identify.fits.parameters import MOVED, FreeParameters, not_whole
from stickslip.identify.fits.settings import RESOLUTION, ROUNDS, SURE
from stickslip.identify.fits.shooting.initial_states import LocalState, Start, Ways
from stickslip.identify.fits.shooting.sampled_loops import (
    LoopInSegment,
    run_through,
    without_steps,
)
from stickslip.mechanisms import Mechanism, slip_names, stops_of
from stickslip.quantities import parameters, vary

Array = NDArray[np.float64]

SOLVER = EventDriven(tier="compiled", tolerance=1e-9, stiff_tolerance=1e-6, max_steps=5_000)
"""Six digits below the noise of any record. A segment takes a few hundred steps; where it takes
thousands, parameters have gone where nothing moves as measured."""


DELAY = "delay"
"""Path of the time [s] by which all that drives a segment acts later than recorded: with a first
state that is free, it is the time by which the motion is later."""
FIRST = 20
"""First rows of a segment from whose slope it is seen whether the body may be at rest, and from
whose parabola its first velocity is guessed."""


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
    known: NDArray[np.bool_]
    """Which of these are known, and no guess (m,)."""
    loop: LoopInSegment | None = None
    """The loop that makes a voltage of the motion at its samples; None if none does."""

    @property
    def rest(self) -> Array:
        """The guess with rates of 0, but those that are known."""
        moves = np.arange(len(self.guess)) >= len(self.guess) // 2
        return np.where(moves & ~self.known, 0.0, self.guess)


@dataclass(frozen=True, kw_only=True, eq=False)
class Shooting:
    """Positions (or velocities) of segments simulated with the measured drive."""

    law: FrictionLaw
    """Holds the parameters that are not fitted."""
    free_parameters: FreeParameters
    """The free parameters."""
    segments: tuple[Segment, ...]
    """Stretches of the records that are simulated."""
    quantity: str = "position"
    """What is compared: ``"position"`` or ``"velocity"``."""
    steps: int = ROUNDS
    """Steps of an initial state at most, each time: the next goes on from there."""

    def shortened(self, share: float) -> "Shooting":
        """Return the same with the first rows of each segment only."""
        segments = []
        for s in self.segments:
            count = max(min(FIRST, len(s.times)), round(share * len(s.times)))
            segments.append(replace(s, times=s.times[:count], measured=s.measured[:count]))
        return replace(self, segments=tuple(segments))

    def starting_from(self, seen: ResidualJacobian) -> "Shooting":
        """Return the same with the initial states of an answer as first guesses."""
        segments = enumerate(self.segments)
        guesses = (replace(s, guess=seen.memory[k].state) for k, s in segments)
        return replace(self, segments=tuple(guesses))

    def with_free_parameters(self, free_parameters: FreeParameters) -> "Shooting":
        """Return the same with other bounds or start values of the unknowns."""
        return replace(self, free_parameters=free_parameters)

    def linearise(self, values: Array, near: ResidualJacobian | None = None) -> ResidualJacobian:
        """Return what predictions with values (p,) leave, and their slopes."""
        known: Mapping[int, LocalState] = near.memory if near is not None else {}
        change = np.zeros(len(values)) if near is None else values - near.values
        late = dict(zip(self.free_parameters.paths, values.tolist(), strict=True)).get(DELAY, 0.0)
        segments = [replace(item, times=item.times - late) for item in self.segments]
        try:
            law, mechanisms = self._changed(values)
        except ParameterError:
            return _failed(values, self.segments)

        def one(k: int, before: LocalState | None) -> LocalState | None:
            segment, mechanism = segments[k], mechanisms[id(segments[k].mechanism)]
            start = Start(
                shoot=partial(self._shot, segment, mechanism, law), rest=segment.rest,
                at_rest=_may_rest(segment, self.quantity), rounds=self.steps,
            )  # fmt: skip
            return start.followed(before, change) if before else start.settled(segment.guess)

        return self._joined(
            values, on_threads(lambda k: one(k, known.get(k)), range(len(self.segments)))
        )

    def _changed(self, values: Array) -> tuple[FrictionLaw, Mapping[int, Mechanism]]:
        """Return the law and, by identity, the segments' mechanisms with other values."""
        items = zip(self.free_parameters.items, map(float, values), strict=True)
        pairs = {item.path: not_whole(item, value) for item, value in items}
        own = {path: value for path, value in pairs.items() if path.startswith("mechanism.")}
        of_law = {path: x for path, x in pairs.items() if path not in {*own, DELAY}}
        law = vary(self.law, "friction", of_law)
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
    ) -> LocalState | None:
        """Return a segment simulated from a state; None if the run fails."""
        able = np.all(np.isfinite(state))
        run = _solved(segment, mechanism, law, _start(mechanism, state)) if able else None
        if run is None:
            return None
        column = run.states.index(slip_names(mechanism)[self.quantity != "position"])
        shot = _Shot(
            run=run, segment=segment, mechanism=mechanism, law=law, state=state, column=column,
            sizes={item.path: item.size for item in self.free_parameters.items},
        )  # fmt: skip
        units = np.ones(len(state))
        units[len(mechanism.coordinates) :] = 1.0 / float(segment.times[-1])
        units[segment.known] = 0.0

        def ways() -> Ways | None:
            local = shot.sensed([f"initial.{name}" for name in run.states[: len(state)]])
            if not np.max(np.abs(local)) < STEEPEST:  # NaN included
                return None
            return Ways(*np.linalg.svd(local * units, full_matrices=False))

        return LocalState(
            state=state,
            residual=segment.measured - shot.compared(run, 0.0),
            size=float(np.ptp(segment.measured)),
            sense=cache(partial(shot.sensed, self.free_parameters.paths)),
            units=units,
            ways=cache(ways),
        )

    def _joined(self, values: Array, shots: Sequence[LocalState | None]) -> ResidualJacobian:
        done = [shot for shot in shots if shot is not None]
        if len(done) < len(shots):
            return _failed(values, self.segments)
        return ResidualJacobian(
            values=values,
            residual=np.concatenate([shot.residual for shot in done]),
            slopes=lambda: np.concatenate(
                on_threads(lambda shot: shot.projected(shot.slopes), done)
            ),
            memory=dict(enumerate(done)),
        )


def _may_rest(segment: Segment, quantity: str) -> bool:
    """Whether the first samples of a segment are those of a body at rest, as far as one can see."""
    count = min(len(segment.times), FIRST)
    t, x = segment.times[:count], segment.measured[:count]
    columns = np.vander(t - t.mean(), 2 if quantity == "position" else 1)
    result = np.linalg.lstsq(columns, x, rcond=None)[0]
    left = x - columns @ result
    error = np.sqrt(left @ left / (count - columns.shape[1]) / np.sum(columns[:, 0] ** 2))
    return bool(abs(result[0]) <= SURE * error)


def _solved(
    segment: Segment, mechanism: Mechanism, law: FrictionLaw, start: Sequence[float]
) -> BareRun | None:
    """Return a segment simulated from its first states; None if the run fails."""
    end, steps = float(segment.times[-1]), SOLVER.max_steps * len(segment.times) // RESOLUTION
    solver = SOLVER if steps <= SOLVER.max_steps else replace(SOLVER, max_steps=steps)
    if segment.loop is not None:
        return run_through(solver, mechanism, law, segment.loop, y0=start, t_end=end)[0]
    run = solver.bare(mechanism, law, y0=start, t_end=end)
    return run if run.status.complete else None


@dataclass(frozen=True, kw_only=True, eq=False)
class _Shot:
    """A run of a segment from a state, of which a column is compared."""

    run: BareRun
    segment: Segment
    mechanism: Mechanism
    law: FrictionLaw
    state: Array
    column: int
    sizes: Mapping[str, float]
    """Usual sizes of parameters by path, of those that may be next to 0."""

    def compared(self, run: BareRun, late: float) -> Array:
        """Return what is compared (n,) of a run of the segment, at times that are later."""
        return np.asarray(run.at(self.segment.times + late)[:, self.column])

    def sensed(self, paths: Sequence[str]) -> Array:
        """Return the slopes (n, paths) of what is compared, by differences where a run has none."""
        segment, shot = self.segment, self
        if DELAY in paths:
            table = self.sensed([path for path in paths if path != DELAY])
            step = MOVED * float(np.ptp(segment.times))
            less, more = (self.compared(self.run, x) for x in (-step, step))
            return np.insert(table, [*paths].index(DELAY), (less - more) / (2.0 * step), axis=1)
        if segment.loop is None:
            table = self.run.differentiate(segment.times, paths)[:, self.column, :]
        else:  # the kernels know nothing of what the loop does about a change
            table = np.full((len(segment.times), len(paths)), np.nan)
            smooth = without_steps(self.mechanism)
            run = _solved(segment, smooth, self.law, _start(smooth, self.state))
            shot = replace(self, mechanism=smooth, run=run or self.run)
        for k in np.flatnonzero(~np.isfinite(table).all(axis=0)).tolist():
            table[:, k] = shot.differenced(paths[k])
        return np.asarray(table)

    def differenced(self, path: str) -> Array:
        """Return the slopes (n,) along one path by differences of runs; NaN if none can be made."""
        segment, start = self.segment, np.array(_start(self.mechanism, self.state))
        root, _, name = path.partition(".")
        if root == "initial":
            own = self.run.states.index(name)
            size = max(abs(start[own]), 1e-3 * float(np.ptp(segment.measured))) or MOVED
        else:
            known = parameters(self.law if root == "friction" else self.mechanism, root)
            value = next(value for other, _, value in known if other == path)
            size = max(abs(value), self.sizes.get(path, 0.0)) or 1e-3
        ends = []
        sides = (1.0,) if segment.loop else (-1.0, 1.0)  # such runs take ten times as long
        for change in (side * MOVED * size for side in sides):
            try:
                first, rig, own_law = start, self.mechanism, self.law
                if root == "initial":
                    first = start + change * (np.arange(len(start)) == own)
                elif root == "friction":
                    own_law = vary(own_law, root, {path: value + change})
                else:
                    rig = vary(rig, root, {path: value + change})
                moved = _solved(segment, rig, own_law, first.tolist())
            except InputError:  # out of its range, or beyond a stop
                continue
            if moved is not None:
                ends.append((change, self.compared(moved, 0.0)))
        if len(ends) == 1:
            ends.append((0.0, self.compared(self.run, 0.0)))
        if not ends:
            return np.full(len(segment.times), np.nan)
        (less, low), (more, high) = ends
        return np.asarray((high - low) / (more - less))


def _start(mechanism: Mechanism, state: Array) -> list[float]:
    """Return the first states of a segment: coordinates and rates."""
    first = dict(zip(mechanism.coordinates, state.tolist(), strict=False))
    for stop in stops_of(mechanism):  # noise puts what rests at a stop beyond it
        nearer = min if stop.side == "upper" else max
        first[stop.coordinate] = nearer(first[stop.coordinate], float(stop.position))
    return [*first.values(), *state[len(first) :].tolist()]


def _failed(values: Array, segments: Sequence[Segment]) -> ResidualJacobian:
    count = sum(len(segment.times) for segment in segments)
    return ResidualJacobian(
        values=values,
        residual=np.full(count, np.inf),
        slopes=np.zeros((count, len(values))),
        memory={},
    )

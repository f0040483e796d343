"""Initial states of segments: fitted by damped steps, carried on, or taken at rest."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-7
"""Singular values of the local states' slopes, over the largest, that are not told from 0."""
ROUNDS = 12
"""Steps at most in which a first initial state is fitted."""
SETTLING = 1e-3
"""It is fitted when a step promises to lower the misfit by less than this share."""
CLEARLY = 0.01
"""Share by which a moving start has to fit better than rest, which is preferred."""
WORSE = 1.3
"""Segments are looked at again whose mean square is so many times the median of all: that of a
hundred rows of noise scatters by a seventh."""
EXACT = 1e-6
"""Root mean square, over the size of the motion, that no step need take off: the solver's own."""
DAMPING = 1e-6
"""First damping of these steps, over the largest eigenvalue of the normal equations."""
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e4
"""Its bounds: at the upper one, nothing moves any more."""


@final
@dataclass(frozen=True)
class Known:
    """Slopes that are known."""

    slopes: Array
    """Derivatives of the prediction by the free parameters (n, p)."""

    def __call__(self) -> Array:
        """Return them."""
        return self.slopes


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class LocalState:
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
    sense: Callable[[], Array]
    """Finds the slopes by the unknowns (n, p); asked for where they are needed."""
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
    def slopes(self) -> Array:
        """Slopes by the unknowns (n, p)."""
        return self.sense()

    @override
    def __getstate__(self) -> dict[str, Any]:
        """Return what crosses processes: slopes that are found."""
        return {**self.__dict__, "sense": Known(self.slopes)}

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
        return promised <= max(SETTLING * self.misfit, self.exact)

    @property
    def exact(self) -> float:
        """Sum of squares that is the solver's own."""
        return len(self.residual) * (EXACT * self.size) ** 2

    @property
    def _damped(self) -> Array:
        """Inverse of the singular values (m,), damped."""
        bottom = self.singular**2 + self.damping * self.singular[0] ** 2
        found: Array = self.singular / np.maximum(bottom, np.finfo(float).tiny)
        return found

    def near(self, change: Array | None = None) -> Array:
        """Return the initial state that fits better where the unknowns have changed by (p,)."""
        wanted = self.columns.T @ self.expected(change)
        return self.state + self.units * (self.directions.T @ (self._damped * wanted))

    def expected(self, change: Array | None = None) -> Array:
        """Return the residual (n,) from this state, unknowns changed, to first order."""
        if change is None or not change.any():
            return self.residual
        return self.residual - self.slopes @ change

    def stepped(self, *, well: bool) -> "LocalState":
        """Return the segment with less damping if its last step went well, else with more."""
        damping = self.damping / 10.0 if well else self.damping * 100.0
        return replace(self, damping=min(max(damping, LEAST_DAMPING), MOST_DAMPING))

    def projected(self, columns: Array) -> Array:
        """Return columns less what initial states can do."""
        return columns - self.basis @ (self.basis.T @ columns)


def settled(
    guess: Array, rest: Array, shoot: Callable[[Array], LocalState | None], *, at_rest: bool
) -> LocalState | None:
    """Return a segment from the initial state that fits it best; None if no run succeeds.

    `rest` is the guess with rates of 0, but those that are known.
    """
    first = shoot(guess)
    best = None if first is None else _descended(first, shoot)
    return _or_at_rest(best, rest, shoot) if at_rest or best is None else best


def followed(
    before: LocalState,
    change: Array,
    rest: Array,
    shoot: Callable[[Array], LocalState | None],
    *,
    at_rest: bool,
) -> LocalState | None:
    """Return a segment where the unknowns have changed by (p,): from a state carried on.

    Where that fits worse than the old state was promised to, the old state is tried as well.
    """
    moved = shoot(before.near(change))
    best = None if moved is None else replace(moved, damping=before.damping).stepped(well=True)
    expected = before.expected(change)
    if best is None or best.misfit > float(expected @ expected):
        stayed = shoot(before.state)
        if stayed is not None and (best is None or stayed.misfit < best.misfit):
            best = replace(stayed, damping=before.damping).stepped(well=False)
    if best is not None:
        best = _descended(best, shoot)
    return _or_at_rest(best, rest, shoot) if at_rest or best is None else best


def _or_at_rest(
    best: LocalState | None, rest: Array, shoot: Callable[[Array], LocalState | None]
) -> LocalState | None:
    """Return a segment from rest, unless an initial velocity fits it clearly better.

    Rest is not found downhill: a body that moves at first slides to where it is just stuck, and all
    that its velocity does is to shift that place.
    """
    half = len(rest) // 2
    if best is not None and np.array_equal(best.state[half:], rest[half:]):
        return best
    first = shoot(rest)
    if first is None:
        return best
    rested = _descended(first, shoot)
    clearly = best is not None and best.misfit < (1.0 - CLEARLY) * rested.misfit
    return best if clearly else rested


def _descended(best: LocalState, shoot: Callable[[Array], LocalState | None]) -> LocalState:
    """Return a segment from the best state met on the way down.

    What is projected out of slopes is what a state can do to first order: it is true only of one
    from which there is next to nothing left to do.
    """
    for _ in range(ROUNDS):
        if best.settled:
            break
        there = shoot(best.near())
        if there is None or there.misfit >= best.misfit:
            best = best.stepped(well=False)
        else:
            best = replace(there, damping=best.damping).stepped(well=True)
    return best


def worse(found: Mapping[int, LocalState | None]) -> Mapping[int, LocalState]:
    """Return the segments whose mean square is above that of most."""
    done = {k: one for k, one in found.items() if one is not None}
    squares = {k: one.misfit / len(one.residual) for k, one in done.items()}
    usual = float(np.median(list(squares.values()))) if squares else 0.0
    return {k: one for k, one in done.items() if squares[k] > WORSE * usual}

"""Initial states of segments: coordinates and rates by damped steps, each as it fits best."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.fits.levenberg_marquardt import AGREE
from stickslip.identify.fits.settings import NEGLIGIBLE, ROUNDS, SETTLED

Array = NDArray[np.float64]

EXACT = 1e-6
"""Root mean square, over the size of the motion, that no step need take off: the solver's own."""
DAMPING = 1e-6
"""First damping of steps of initial states, over the largest eigenvalue of the normal equations;
at one over it nothing moves."""


Found = TypeVar("Found")


@dataclass(frozen=True)
class Known(Generic[Found]):
    """What was found, in place of what finds it."""

    found: Found
    """What was found."""

    def __call__(self) -> Found:
        """Return what was found."""
        return self.found


class Ways(NamedTuple):
    """What other initial states do: singular values of their slopes, in units of the motion."""

    columns: Array
    """Orthonormal (n, m): left singular vectors."""
    singular: Array
    """Singular values (m,)."""
    directions: Array
    """Right singular vectors, in rows (m, m)."""


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
    ways: Callable[[], Ways | None]
    """Finds what other initial states would do; None if that leaves all bounds. It is asked for
    where it is needed: of a state that fits worse than another, it is not."""
    damping: float = DAMPING
    """Over the largest singular value squared."""

    @property
    def slopes(self) -> Array:
        """Slopes by the unknowns (n, p)."""
        return self.sense()

    @property
    def able(self) -> bool:
        """Whether it is known what other initial states would do, so that steps can begin here."""
        return self.ways() is not None

    @property
    def known(self) -> Ways:
        """What they would do."""
        ways = self.ways()
        assert ways is not None
        return ways

    def __getstate__(self) -> dict[str, Any]:
        """Return what crosses processes: slopes that are found."""
        return {**self.__dict__, "sense": Known(self.slopes), "ways": Known(self.ways())}

    @property
    def misfit(self) -> float:
        """Sum of squares from this very state."""
        return float(self.residual @ self.residual)

    @property
    def basis(self) -> Array:
        """Orthonormal columns of what initial states can do (n, r)."""
        columns, singular, _ = self.known
        return columns[:, singular > NEGLIGIBLE * singular[0]]

    @property
    def settled(self) -> bool:
        """Whether another step promises next to nothing, or less than the solver is exact to."""
        columns, singular, _ = self.known
        kept = 1.0 - self._damped * singular
        promised = float(np.sum((columns.T @ self.residual) ** 2 * (1.0 - kept**2)))
        return promised <= max(SETTLED * self.misfit, self.exact)

    @property
    def exact(self) -> float:
        """Sum of squares that is the solver's own."""
        return len(self.residual) * (EXACT * self.size) ** 2

    @property
    def _damped(self) -> Array:
        """Inverse of the singular values (m,), damped."""
        singular = self.known.singular
        bottom = singular**2 + self.damping * singular[0] ** 2
        return np.asarray(singular / np.maximum(bottom, np.finfo(float).tiny))

    def near(self, change: Array | None = None) -> Array:
        """Return the initial state that fits better where the unknowns have changed by (p,)."""
        columns, _, directions = self.known
        wanted = columns.T @ self.expected(change)
        return self.state + self.units * (directions.T @ (self._damped * wanted))

    def expected(self, change: Array | None = None) -> Array:
        """Return the residual (n,) from this state, unknowns changed, to first order."""
        if change is None or not change.any():
            return self.residual
        return self.residual - self.slopes @ change

    def stepped(self, *, well: bool) -> "LocalState":
        """Return the segment with less damping if its last step went well, else with more."""
        damping = self.damping / 10.0 if well else self.damping * 100.0
        return replace(self, damping=min(damping, 1.0 / DAMPING))

    def projected(self, columns: Array) -> Array:
        """Return columns less what initial states can do."""
        return columns - self.basis @ (self.basis.T @ columns)


@dataclass(frozen=True, kw_only=True, eq=False)
class Start:
    """How the initial state of a segment is looked for."""

    shoot: Callable[[Array], LocalState | None]
    """Returns the segment simulated from a state; None if the run fails."""
    rest: Array
    """The first guess with rates of 0, but those that are known."""
    at_rest: bool
    """Whether the segment may begin at rest."""
    rounds: int = ROUNDS

    def settled(self, guess: Array) -> LocalState | None:
        """Return a segment from the initial state that fits it best; None if no run succeeds."""
        first = self.shoot(guess)
        able = first is not None and first.able
        return self._or_at_rest(self._descended(first) if first and able else None)

    def followed(self, before: LocalState, change: Array) -> LocalState | None:
        """Return a segment where the unknowns have changed by (p,): from a state carried on.

        Where that fits worse than the old state was promised to, or cannot be stepped from, the old
        state is tried as well.
        """
        moved, expected = self.shoot(before.near(change)), before.expected(change)
        tried = [] if moved is None else [(moved, True)]
        if moved is None or moved.misfit > float(expected @ expected) or not moved.able:
            stayed = self.shoot(before.state)
            tried += [] if stayed is None else [(stayed, False)]
        best = None
        for item, well in sorted(tried, key=lambda pair: pair[0].misfit):
            if item.able:
                begun = replace(item, damping=before.damping)
                best = self._descended(begun.stepped(well=well))
                break
        return self._or_at_rest(best)

    def _or_at_rest(self, best: LocalState | None) -> LocalState | None:
        """Return a segment from rest, if it may, unless a velocity fits it clearly better.

        Rest is not found downhill: a body that moves at first slides to where it is just stuck, and
        all that its velocity does is to shift that place.
        """
        rates = slice(len(self.rest) // 2, None)
        same = best is not None and np.array_equal(best.state[rates], self.rest[rates])
        if same or not (self.at_rest or best is None):
            return best
        first = self.shoot(self.rest)
        if first is None or not first.able:
            return best
        rested = self._descended(first)
        clearly = best is not None and best.misfit < (1.0 - AGREE) * rested.misfit
        return best if clearly else rested

    def _descended(self, best: LocalState) -> LocalState:
        """Return a segment from the best state met on the way down.

        What is projected out of slopes is what a state can do to first order: it is true only of
        one from which there is next to nothing left to do.
        """
        for _ in range(self.rounds):
            if best.settled:
                break
            there = self.shoot(best.near())
            if there is None or there.misfit >= best.misfit or not there.able:
                if best.damping >= 1.0 / DAMPING:
                    break
                best = best.stepped(well=False)
            else:
                best = replace(there, damping=best.damping).stepped(well=True)
        return best

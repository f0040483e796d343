"""Fits of structures: linear least squares, with errors of blocks that were held out."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar, final

import numpy as np
from numpy.typing import NDArray

from stickslip.evidence.balance import Balance
from stickslip.evidence.motion import acceleration_of_noise
from stickslip.evidence.structure import LATE_OR_ELASTIC, SHOWN_LATE, Structure
from stickslip.evidence.terms import TERMS, Term

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Item = TypeVar("Item", bound=np.generic)

RIDGE = 1e-9
"""What is added to the diagonal of scaled normal equations."""
EMPTY = 1e-10
"""Share of the sum of squares of a column that is rounding where the rest was taken off."""
EXCESS = 3.0
"""Least size of a saturation's force over the misfit of the other rows: its column holds the
recorded force, and would explain the noise of that."""
EVENLY = 0.1
"""Most by which the share of the excess that does not act may differ above its median. Measured:
0.04 at most where an amplifier saturates and 0.16 at least where a limit stands for gap or bristle.
Missed is a limit of which a record tells that share within 0.4 only: of one it was 0.31. To allow
for the error would let bristles be called limits."""
PLACED = ("ripple", "level_ripple", "level_slope", "spring")
"""Kinds that depend on position."""
APART = 2.0
"""Least ratio of the lengths of two bristles of a channel."""
STROKES = 10.0
"""Least range of the position over the length of a bristle, where such terms stand beside one."""
CONES = 20
"""Fits at most until the rows outside the cone lower the error no further."""
SAME = 1e-6
"""Share by which a fit has to lower it."""
CHANCE = 3.0
"""Distance to the cone that is noise, over the residuals of slipping rows. Rows that noise moves
out of the cone would raise the level: those that it moves in do not count."""
BLOCKS = 10
"""Blocks of time that standard errors come from."""


@final
@dataclass(frozen=True, eq=False)
class Design:
    """The columns of a structure along a balance."""

    balance: Balance
    structure: Structure
    made: tuple[tuple[Array, Array], ...]
    """Columns (n, d) of each term, and what multiplies the state of a bristle in them."""
    force: Array
    """Forces (n,) that the columns are to explain."""
    open: Flags
    """Rows (n,) at which the structure leaves the force open."""

    @cached_property
    def columns(self) -> Array:
        """Return the columns (n, p) of the terms."""
        return _side_by_side(self.force, [columns for columns, _ in self.made])

    @cached_property
    def multipliers(self) -> Array:
        """Return what multiplies the state of a bristle in each of them (n, p)."""
        return _side_by_side(self.force, [multipliers for _, multipliers in self.made])

    @cached_property
    def owners(self) -> tuple[Term, ...]:
        """Return the term of each column (p,)."""
        pairs = zip(self.structure.terms, self.made, strict=True)
        return tuple(term for term, (columns, _) in pairs for _ in range(columns.shape[1]))

    @cached_property
    def odd(self) -> Flags:
        """Return which columns (p,) turn with the direction."""
        return np.array([TERMS[one.kind].contact in ("odd", "own") for one in self.owners], bool)

    @cached_property
    def even(self) -> Flags:
        """Return which columns (p,) act through the contact alike in both directions."""
        return np.array([TERMS[one.kind].contact == "even" for one in self.owners], bool)

    @property
    def filters(self) -> bool:
        """Whether the force channel acts as a low-pass filter."""
        return self.structure.late[1] != 0.0

    @property
    def slipping(self) -> Flags:
        """Return the rows (n,) at which the structure says which force acts."""
        return self.balance.use & ~self.open

    def residual(self, values: Array, rows: NDArray[np.intp] | None = None) -> Array:
        """Return residuals at some rows; where the force is open, the distance to what it may be.

        A law without memory allows the cone from E - F to E + F, with the difference of directions
        E, and what it predicts of a slip, which the filter makes overshoot; one whose memory the
        path does not resolve allows what it cannot see of that.
        """
        columns, free = _picked(self.columns, rows), _picked(self.open, rows)
        left = _picked(self.force, rows) - columns @ values
        if not free.any() or not self.odd.any():
            return left
        multipliers = _picked(self.multipliers, rows)
        own = {name: _picked(self.balance.own[name], rows) for name, _ in self.structure.memories}
        return np.where(free, self._distance(values, left, columns, multipliers, own), left)

    def errors(self, values: Array) -> Array:
        """Return residuals (n,) as the force channel shows them."""
        return self.shown(self.residual(values))

    def shown(self, forces: Array) -> Array:
        """Return forces (n, ...) behind the filter of the force channel.

        To take that off a force adds to its noise, for which no structure is to be blamed.
        """
        return self.balance.filtered(forces, self.structure.late[1])

    def outside(self, values: Array) -> Array:
        """Return the residuals (f,) of the free rows, which are picked once for many values."""
        columns, force, multipliers, own = self.at_free
        return self._distance(values, force - columns @ values, columns, multipliers, own)

    @cached_property
    def free(self) -> NDArray[np.intp]:
        """Return the rows (f,) in use at which a cone of friction leaves the force open."""
        return np.flatnonzero(self.balance.use & self.open & self.odd.any())

    @cached_property
    def at_free(self) -> tuple[Array, Array, Array, dict[str, Flags]]:
        """Return columns, forces, multipliers and channels of memories there."""
        rows = self.free
        own = {name: self.balance.own[name][rows] for name, _ in self.structure.memories}
        return self.columns[rows], self.force[rows], self.multipliers[rows], own

    def _distance(
        self,
        values: Array,
        left: Array,
        columns: Array,
        multipliers: Array,
        own: Mapping[str, Flags],
    ) -> Array:
        through = self.odd | self.even
        contact = columns[:, through] @ values[through]
        half = np.abs(multipliers[:, self.odd] @ values[self.odd])
        middle = multipliers[:, self.even] @ values[self.even]
        needed = left + contact
        low, high = middle - half, middle + half
        for name, shape in self.structure.memories:
            at = own[name]
            unseen = half[at] * min(2.0 * self.balance.resolved[name] / shape[0], 1.0)
            low[at] = np.maximum(low[at], contact[at] - unseen)
            high[at] = np.minimum(high[at], contact[at] + unseen)
        low, high = np.minimum(low, high), np.maximum(low, high)
        return np.asarray(
            needed - np.clip(needed, np.minimum(low, contact), np.maximum(high, contact))
        )


@final
@dataclass(frozen=True, eq=False)
class Fit:
    """A structure with its coefficients, and how well they predict what they were not fitted to."""

    structure: Structure
    """The structure."""
    coef: Array
    """Coefficients (p,)."""
    owner: tuple[Term, ...]
    """The term of each coefficient."""
    sse: Array
    """Sums of squared errors of held-out blocks (folds,) [N^2]."""
    counts: Array
    """Rows of each block at which the structure says something (folds,), at least 1."""
    residual: Array
    """Residuals (n,) [N], as the force channel shows them."""
    ok: bool
    """Whether physics admits the coefficients."""

    @cached_property
    def folds(self) -> Array:
        """Return mean squared errors of held-out blocks (folds,) [N^2].

        A row of which the structure says nothing counts for nothing.
        """
        found: Array = self.sse / self.counts
        return found

    @cached_property
    def mse(self) -> float:
        """Return the mean squared held-out error [N^2]."""
        return float(self.folds.mean())

    @property
    def rms(self) -> float:
        """Return the root of the mean squared held-out error [N]."""
        return math.sqrt(self.mse)

    def of(self, kind: str, channel: str | None = None) -> list[float]:
        """Return the coefficients of terms of a kind, in a channel or in all."""
        return [
            float(value)
            for value, term in zip(self.coef, self.owner, strict=True)
            if term.kind == kind and channel in (None, term.channel)
        ]


def _picked(x: NDArray[Item], rows: NDArray[np.intp] | None) -> NDArray[Item]:
    """Return some rows of what has (n, ...), which costs a tenth of what an index does."""
    return x if rows is None else x.take(rows, axis=0)


def _at(flags: Flags, columns: Array, force: Array) -> tuple[Array, Array]:
    """Return columns and force at the rows (n,) that are flagged."""
    rows = np.flatnonzero(flags)
    return _picked(columns, rows), _picked(force, rows)


def design(balance: Balance, structure: Structure) -> Design:
    """Return the columns of a structure."""
    return Design(
        balance=balance,
        structure=structure,
        made=tuple(
            balance.columns(term, structure.shape(term.channel)) for term in structure.terms
        ),
        force=balance.late(*structure.late),
        open=balance.open(structure),
    )


def solved(square: Array, product: Array, whole: Array | None = None) -> Array:
    """Return solutions (..., p) of normal equations (..., p, p), scaled, with a small ridge.

    A column of which they hold nothing, or only rounding of the `whole`, has the coefficient 0.
    """
    own = np.diagonal(square, axis1=-2, axis2=-1)
    least = 0.0 if whole is None else EMPTY * np.diagonal(whole, axis1=-2, axis2=-1)
    size = np.where(own > np.maximum(least, 1e-290), 1.0 / np.sqrt(np.maximum(own, 1e-290)), 0.0)
    scaled = square * size[..., :, None] * size[..., None, :] + RIDGE * np.eye(square.shape[-1])
    return np.asarray(size * np.linalg.solve(scaled, (size * product)[..., None])[..., 0])


def admissible(values: Array, owners: Sequence[Term]) -> bool:
    """Return whether physics admits coefficients."""
    for value, term in zip(values, owners, strict=True):
        kind = TERMS[term.kind]
        if kind.positive and value < 0.0:
            return False
        if kind.limits is not None and not kind.limits[0] <= value <= kind.limits[1]:
            return False
    return True


def fit(balance: Balance, structure: Structure) -> Fit:
    """Fit a structure, and judge it on each block by a fit to the others but their gaps."""
    made = design(balance, structure)
    known = estimated(made)
    sse, counts = _held_out(made, known)
    return Fit(
        structure=structure,
        coef=known.values,
        owner=made.owners,
        sse=sse,
        counts=counts,
        residual=made.errors(known.values),
        ok=possible(made, known.values),
    )


@final
@dataclass(frozen=True, eq=False)
class Estimated:
    """Coefficients, and the rows and columns that they come from."""

    made: Design
    """What was fitted."""
    values: Array
    """Coefficients (p,)."""
    border: NDArray[np.intp]
    """Open rows (b,) that are on the border of the cone."""
    edge: Array
    """Columns (b, p) there."""
    error: float
    """Sum of the squared errors of slipping rows, and distances of open ones to the cone [N^2]."""

    @cached_property
    def rows(self) -> Flags:
        """Return the rows (n,) that count."""
        found = self.made.slipping
        found[self.border] = True
        return found

    @cached_property
    def columns(self) -> Array:
        """Return the columns (n, p), those of open rows at the border of the cone."""
        if not self.border.size:
            return self.made.columns
        found = self.made.columns.copy()
        found[self.border] = self.edge
        return found

    @cached_property
    def shown(self) -> tuple[Array, Array]:
        """Return columns (n, p) and forces (n,) of those rows, as the force channel shows them."""
        if not self.made.filters:
            return self.columns, self.made.force
        columns, force = self.columns * self.rows[:, None], self.made.force * self.rows
        return self.made.shown(columns), self.made.shown(force)


def estimated(made: Design) -> Estimated:
    """Return the coefficients of a design by least squares.

    Rows that are open count where the needed force lies outside the cone: it is on the border then.
    Which do is found anew after each fit, as a wider cone holds some that a first one does not, as
    long as that lowers the error.
    """
    found = _estimated(made)
    if not made.filters:
        return found
    values = _least_squares(*(one[found.rows] for one in found.shown))
    error = _squares(made.errors(values)[made.balance.use])
    return replace(found, values=values, error=error)


def _estimated(made: Design) -> Estimated:
    """Return them by plain least squares: a filter is taken off the forces, which adds to noise."""
    columns, force = _at(made.slipping, made.columns, made.force)
    square, product = columns.T @ columns, columns.T @ force
    values = solved(square, product)
    left = force - columns @ values
    found = Estimated(
        made, values, np.zeros(0, np.intp), np.zeros((0, len(values))), _squares(left)
    )
    if not made.free.size:
        return found
    all_columns, all_force, multipliers, _ = made.at_free
    outside = made.outside(values)
    found = replace(found, error=found.error + _squares(outside))
    within = CHANCE * math.sqrt(_squares(left) / len(left)) if len(left) else 0.0
    border = np.abs(outside) > within
    for _ in range(CONES):
        edge = all_columns[border]
        edge[:, made.odd] = np.sign(outside[border])[:, None] * multipliers[border][:, made.odd]
        values = solved(square + edge.T @ edge, product + edge.T @ all_force[border])
        outside = made.outside(values)
        error = _squares(force - columns @ values) + _squares(outside)
        if not (border.any() and error < (1.0 - SAME) * found.error):
            break
        found = Estimated(made, values, made.free[border], edge, error)
        border = np.abs(outside) > np.where(border, 0.0, within)
    return found


def _side_by_side(force: Array, tables: Sequence[Array]) -> Array:
    """Return columns (n, p) of several terms; none of a structure without terms."""
    return np.hstack([np.zeros((len(force), 0)), *tables])


def _squares(errors: Array) -> float:
    """Return the sum of squares."""
    return float(errors @ errors)


def possible(made: Design, values: Array) -> bool:
    """Return whether physics admits the coefficients of a design."""
    return (
        admissible(values, made.owners)
        and made.structure.complete
        and _memories_resolved(made)
        and _places_told(made)
        and _excess_stands_out(made, values)
        and _excess_is_even(made)
        and _motion_is_explained(made)
    )


def _memories_resolved(made: Design) -> bool:
    """Return whether two memories of a channel differ, and the path resolves what stands beside.

    One that it does not resolve would only leave rows at rest open for the other; and it is as late
    at reversals as a delay, a gap or a coupling is.
    """
    resolves = made.balance.resolves
    unseen = any(not resolves(shape[0], channel) for channel, shape in made.structure.memories)
    shifts = {*LATE_OR_ELASTIC, *SHOWN_LATE}
    if unseen and any(term.kind in shifts for term in made.structure.terms):
        return False
    for term in made.structure.terms:
        if term.kind == "second":
            lengths = sorted([term.par[0], made.structure.shape(term.channel)[0]])
            if not resolves(lengths[0], term.channel):
                return False
            if lengths[1] < APART * lengths[0]:
                return False
    return True


def _least_squares(columns: Array, force: Array) -> Array:
    return solved(columns.T @ columns, columns.T @ force)


def _held_out(made: Design, known: Estimated) -> tuple[Array, Array]:
    """Return squared errors and rows of each block (folds,), from Gram matrices of the others."""
    balance, rows = made.balance, known.rows
    columns, force = known.shown
    whole, known_force = _at(rows, columns, force)
    square, product = whole.T @ whole, whole.T @ known_force
    sse, counts = np.zeros(balance.folds), np.ones(balance.folds)
    for k in range(balance.folds):
        own, near = _at(balance.near[k] & rows, columns, force)
        values = solved(square - own.T @ own, product - own.T @ near, square)
        held = np.flatnonzero((balance.fold == k) & balance.use)
        left = made.residual(values, held)
        counts[k] = max(len(held) - np.sum(made.open[held] & (left == 0.0)), 1)
        sse[k] = _squares(made.errors(values)[held] if made.filters else left)
    return sse, counts


def _places_told(made: Design) -> bool:
    """Return whether the range of each channel tells what depends on position from memory.

    In a range of a few lengths of a bristle, every stroke shows both alike.
    """
    structure, balance = made.structure, made.balance
    longest = {channel: shape[0] for channel, shape in structure.memories}
    for term in structure.terms:
        if term.kind == "second":
            longest[term.channel] = max(longest.get(term.channel, 0.0), term.par[0])
    return not any(
        term.kind in PLACED
        and STROKES * longest.get(term.channel, 0.0) > balance.span[term.channel]
        for term in structure.terms
    )


def _excess_stands_out(made: Design, values: Array) -> bool:
    """Return whether the force of a saturation stands above the misfit of the other rows."""
    for j, term in enumerate(made.owners):
        if term.kind != "saturation":
            continue
        excess = made.columns[made.balance.use, j]
        on = np.abs(excess) > 1e-3 * np.abs(excess).max(initial=0.0)
        if not on.any() or on.all():
            return False
        left = made.residual(values)[made.balance.use]  # at rest what the law leaves open is none
        if not np.mean(excess[on] ** 2) > EXCESS**2 * np.mean(left[~on] ** 2):
            return False
    return True


def _excess_is_even(made: Design) -> bool:
    """Return whether a second limit, at the median of the excess, has nothing to explain.

    Of what is beyond its limit an amplifier delivers nothing, be it little or much.
    """
    for term in made.structure.terms:
        if term.kind != "saturation":
            continue
        force = np.abs(np.concatenate([one.raw for one in made.balance.of(term.channel)]))
        beyond = force[force > term.par[0]]
        if not beyond.size:
            return False
        second = replace(term, par=(float(np.median(beyond)),))
        above, _ = made.balance.columns(second, made.structure.shape(term.channel))
        columns = np.hstack([made.columns, above])[made.slipping]
        if abs(_least_squares(columns, made.force[made.slipping])[-1]) > EVENLY:
            return False
    return True


def _motion_is_explained(made: Design) -> bool:
    """Return whether a limit lowers the error of the acceleration, not of the force alone.

    Cut off at a limit below most of the force, any record is a constant force of which a level is
    all, with hardly an inertia.
    """
    owners, rows = made.owners, made.slipping
    limited = np.array([one.kind == "saturation" for one in owners], dtype=bool)
    inertia = np.array([one.kind == "inertia" for one in owners], dtype=bool)
    if not (limited.any() and inertia.any() and rows.any()):
        return True
    errors = []
    for columns in (made.columns[rows], made.columns[rows] * ~limited):
        values = _least_squares(columns, made.force[rows])
        left = float(np.linalg.norm(made.force[rows] - columns @ values))
        errors.append(left / max(float(values[inertia].sum()), 1e-300))
    return errors[0] < errors[1]


def training_error(balance: Balance, structure: Structure) -> float:
    """Return squared errors of all rows over the slipping ones [N^2], infinite if not admissible.

    It ranks values on a grid before any of them is judged.
    """
    made = design(balance, structure)
    known = estimated(made)
    rows = int(made.slipping.sum())
    return known.error / rows if rows and admissible(known.values, made.owners) else math.inf


def spread(made: Design, rows: Flags, blocks: int = BLOCKS) -> tuple[Array, Array]:
    """Return coefficients (p,) of some rows and their standard errors, from blocks of time."""
    rows = rows & made.slipping
    columns, force = made.columns[rows], made.force[rows]
    values = _least_squares(columns, force)
    return values, sandwich(columns, force - columns @ values, blocks, 1e-12)


def sandwich(slopes: Array, left: Array, blocks: int, cutoff: float) -> Array:
    """Return standard errors (p,) that the gradients of blocks of time give."""
    parts = np.array_split(np.arange(len(left)), blocks)
    gradients = np.array([slopes[one].T @ left[one] for one in parts])
    size = 1.0 / np.sqrt(np.maximum((slopes * slopes).sum(axis=0), 1e-300))
    scaled = slopes * size
    inverse = size[:, None] * np.linalg.pinv(scaled.T @ scaled, rcond=cutoff) * size
    covariance = inverse @ (gradients.T @ gradients) @ inverse * blocks / (blocks - 1)
    return np.sqrt(np.maximum(np.diag(covariance), 0.0))


def matched(owners: Sequence[Term], other: Sequence[Term]) -> list[int]:
    """Return the columns of `owners` in the order of `other`, whose parameters may differ."""
    free, found = list(range(len(owners))), []
    for term in other:
        name = (term.kind, term.channel, term.what)
        own = next(i for i in free if (owners[i].kind, owners[i].channel, owners[i].what) == name)
        found.append(own)
        free.remove(own)
    return found


def friction_scale(balance: Balance, found: Fit) -> float:
    """Return the root of the mean square [N] of what mechanism and offset leave: the friction."""
    made = design(balance, found.structure)
    own = np.array(
        [t.kind not in ("inertia", "mass", "known", "offset") for t in made.owners], bool
    )
    friction = found.residual + made.columns[:, own] @ found.coef[own]
    rows = balance.use & ~balance.at_rest
    square = float(np.mean(friction[rows] ** 2)) if rows.any() else 0.0
    return max(math.sqrt(square), 1e-12 * balance.scale)


def acceleration_noise(balance: Balance, found: Fit) -> float:
    """Return the force [N] that noise of the positions costs through the inertias in the band."""
    costs = [0.0]
    for one in balance.parts:
        moved = sum(sum(found.of(kind, one.channel)) for kind in ("inertia", "flexible", "loose"))
        mass = moved if one.mass is None else one.mass
        costs.append(abs(mass) * one.noise * acceleration_of_noise(one.h, balance.fc))
    return max(costs)

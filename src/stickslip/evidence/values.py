"""Nonlinear parameters of structures: which are free, and how they are moved off their grids."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.evidence.balance import Balance
from stickslip.evidence.fits import design, estimated, matched, solved, training_error
from stickslip.evidence.structure import GROWN, SHAPE_NAMES, SHOWN_LATE, Structure, fades
from stickslip.evidence.terms import TERMS, Term

Array = NDArray[np.float64]

STEPS = 2
"""Gauss-Newton steps of new members of the search."""
NUDGE = 0.03
"""Change of the logarithm of a parameter for the slope of columns."""
TURN = 0.2
"""Most by which a wave may turn [rad] at its end where its frequency is changed for a slope."""
SHORTENED = (1.0, 0.4, 0.15)
"""Shares of a step that are tried."""
LONGEST = 0.5
"""Largest step of a logarithm."""
EXPONENTS = (0.2, 2.5)
"""Limits of the exponent of a viscous power: one of less is nearly a level."""
SLOW = 0.5
"""Largest Stribeck velocity over the largest speed, at which the step has gone."""
LEAST_PERIODS = 1.8
"""Least periods of a wave in the range of the position."""
LATEST = 0.06
"""Largest delay [s], at the end of the record where it grows."""


@final
@dataclass(frozen=True)
class Value:
    """A nonlinear parameter of a structure: of a term, or of the shape of a channel."""

    owner: Term | str
    """The term, or the channel of the shape."""
    index: int
    """Which of its values."""

    @property
    def name(self) -> str:
        """Return its name in intervals."""
        if isinstance(self.owner, Term):
            return f"{key_of(self.owner)}.{self.index}"
        return f"{self.owner or '-'}/{SHAPE_NAMES[self.index]}"

    def of(self, structure: Structure) -> float:
        """Return what it is."""
        if isinstance(self.owner, Term):
            return self.owner.par[self.index]
        return structure.shape(self.owner)[self.index]


def key_of(term: Term) -> str:
    """Return the name of a term in intervals.

    Examples
    --------
    >>> key_of(Term("level")), key_of(Term("known", (), "*", "gravity"))
    ('-/level', '*/known:gravity')
    """
    what = f":{term.what}" if term.what not in ("", term.kind) else ""
    return f"{term.channel or '-'}/{term.kind}{what}"


def column_keys(owners: Sequence[Term]) -> list[str]:
    """Return the names of coefficients in intervals (p,)."""
    found, before = [], None
    number = 0
    for term in owners:
        number = number + 1 if term == before else 0
        names = TERMS[term.kind].columns
        found.append(f"{key_of(term)}.{names[number]}" if names else key_of(term))
        before = term
    return found


def free_values(structure: Structure) -> list[Value]:
    """Return the nonlinear parameters that may leave their grids; 0 has no logarithm."""
    found = [
        Value(term, i)
        for term in structure.terms
        for i, x in enumerate(term.par)
        if term.kind not in GROWN and i not in TERMS[term.kind].fixed and x != 0.0
    ]
    for channel, shape in structure.memories:
        which = (0, 2, 3) if fades(shape) else (0, 1)
        found += [Value(channel, i) for i in which if shape[i] != 0.0]
    return found


def logarithms(structure: Structure, which: Sequence[Value]) -> Array:
    """Return the logarithms (k,) of the sizes of parameters."""
    return np.log(np.abs([one.of(structure) for one in which]))


def moved(structure: Structure, which: Sequence[Value], logs: Array) -> Structure:
    """Return a structure with other values of parameters, of the same signs."""
    terms: dict[Term, list[float]] = {}
    for one, log in zip(which, logs, strict=True):
        value = math.copysign(math.exp(min(log, 700.0)), one.of(structure))
        if isinstance(one.owner, Term):
            terms.setdefault(one.owner, list(one.owner.par))[one.index] = value
        else:
            shape = list(structure.shape(one.owner))
            shape[one.index] = value
            structure = structure.shaped(one.owner, tuple(shape))
    for term, par in terms.items():
        structure = structure.without(term).having(replace(term, par=tuple(par)))
    return structure


def sane(balance: Balance, structure: Structure) -> bool:
    """Return whether the nonlinear parameters lie where the record can say something of them."""
    for channel, shape in structure.memories:
        resolved, span = balance.resolved[channel], balance.span[channel]
        if not (shape[1] <= EXPONENTS[1] and 1.5 * resolved < shape[0] < span):
            return False
        if fades(shape) and not (_seen(balance, channel, shape[2]) and shape[3] < 4.0):
            return False
    return all(_within(balance, term) for term in structure.terms)


def _within(balance: Balance, term: Term) -> bool:
    """Return whether the nonlinear parameters of a term lie there."""
    if not term.par:
        return True
    kind, first = term.kind, term.par[0]
    if kind.startswith("power"):
        return EXPONENTS[0] <= first < EXPONENTS[1]
    if kind.startswith("stribeck"):
        return _seen(balance, term.channel, first)
    if TERMS[kind].wave:
        return first * balance.span[term.channel] / (2.0 * math.pi) > LEAST_PERIODS
    if kind in SHOWN_LATE:
        return abs(first) * (balance.length if kind == "skew" else 1.0) <= LATEST
    if kind == "hum":
        return first < balance.fc
    return kind != "saturation" or first >= balance.least_limit[term.channel]


def _seen(balance: Balance, channel: str, v_s: float) -> bool:
    """Return whether a Stribeck velocity is among the speeds of a channel."""
    top = balance.speed[channel]
    return top / 1e3 < v_s < 1.2 * SLOW * top


def changes(
    balance: Balance, structure: Structure, which: Sequence[Value], usual: float
) -> list[float]:
    """Return changes (k,) of logarithms after which columns are alike: the usual, or less.

    A wave of a hundred periods is another one at its end if its frequency changes by a hundredth.
    """
    found = []
    for one in which:
        turns = 0.0
        if isinstance(one.owner, Term) and one.owner.kind == "hum":
            turns = 2.0 * math.pi * balance.length * one.of(structure)
        elif isinstance(one.owner, Term) and TERMS[one.owner.kind].wave:
            turns = balance.span[one.owner.channel] * one.of(structure)
        found.append(min(usual, TURN / max(turns, TURN)))
    return found


def slopes(
    balance: Balance, structure: Structure, which: Sequence[Value], values: Array, usual: float
) -> Array:
    """Return slopes (n, k) of the residual's negative by the logarithms of parameters."""
    owners = design(balance, structure).owners
    logs, found = logarithms(structure, which), []
    steps = changes(balance, structure, which, usual)
    for i, step in enumerate(steps):
        ends = []
        for sign in (1.0, -1.0):
            there = logs.copy()
            there[i] += sign * step
            with balance.passing():
                made = design(balance, moved(structure, which, there))
            ends.append(made.columns @ values[matched(owners, made.owners)] - made.force)
        found.append((ends[0] - ends[1]) / (2.0 * step))
    return np.array(found).reshape(len(which), balance.count).T


def polished(balance: Balance, structure: Structure, steps: int = STEPS) -> Structure:
    """Return a structure after Gauss-Newton steps of its nonlinear parameters.

    The slopes are those of slipping rows; rows on the border of the cone hold the coefficients.
    """
    for _ in range(steps):
        which = free_values(structure)
        if not which:
            break
        made = design(balance, structure)
        known = estimated(made)
        values = known.values
        columns, force = (one[known.rows] for one in known.shown)
        moving = slopes(balance, structure, which, values, NUDGE) * made.slipping[:, None]
        joint = np.column_stack([columns, made.shown(moving)[known.rows]])
        step = solved(joint.T @ joint, joint.T @ (force - columns @ values))[len(values) :]
        better = _shortened(balance, structure, which, np.clip(step, -1e3, 1e3))
        if better is None:
            break
        structure = better
    return structure


def _shortened(
    balance: Balance, structure: Structure, which: Sequence[Value], step: Array
) -> Structure | None:
    """Return the structure after the longest share of a step that lowers the error, if any."""
    logs, now = logarithms(structure, which), training_error(balance, structure)
    for share in SHORTENED:
        there = moved(structure, which, logs + np.clip(share * step, -LONGEST, LONGEST))
        if sane(balance, there):
            with balance.passing():
                error = training_error(balance, there)
            if error < now:
                return there
    return None

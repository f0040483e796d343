"""The search over structures: a beam of families, judged on held-out blocks by one rule."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from stickslip.evidence.balance import Balance
from stickslip.evidence.bristles import SIGN, Shape
from stickslip.evidence.fits import Fit, acceleration_noise, fit, friction_scale, training_error
from stickslip.evidence.moves import Move, moves
from stickslip.evidence.rule import Rule, repeats, seen_late
from stickslip.evidence.structure import (
    DAMPED,
    GROWN,
    SHIFTS,
    SHOWN_LATE,
    Family,
    Structure,
    fades,
)
from stickslip.evidence.terms import Term, through_bristle
from stickslip.evidence.values import polished
from stickslip.evidence.vocabulary import (
    SHAPE_EXPONENTS,
    STRIBECK_EXPONENTS,
    grid,
    hums,
    ripples,
    shapes,
)

Progress = Callable[[float, str], None]
Wrap = Callable[[Shape], Structure]

BEAM = 2
"""Structures, of different families, that the next level begins from."""
LEVELS = 10
"""Levels at most."""
BEST_MOVES = 8
"""Additions and swaps of each level that are fitted, of different kinds."""
BEST_DELAYS = 2
"""Delays that are fitted of those on the grid."""
BEST_SHAPES = 3
"""Bristle shapes that are fitted of those on the grid."""
MOST_TIES = 6
"""Ties that are reported."""
TEXTBOOK = ("viscous", "offset", "viscous_dir")
"""The second start beside a level: the textbook law of both directions."""
POWERS = (0.4, 0.6, 1.0)
"""Viscous exponents of the third start, a Stribeck law."""
SHARE = 0.85
"""Share of the time, about, that the search takes."""
USUAL_LEVELS = 3.0
"""Levels, about, that it takes."""


@final
@dataclass(frozen=True, eq=False)
class Searched:
    """What a search found."""

    best: Fit
    """The best fit by the rule."""
    ties: tuple[Fit, ...]
    """Others that the rule does not tell apart from it, the most usual first."""
    trail: tuple[str, ...]
    """The best structure of each level, with its held-out error [N]."""
    scale: float
    """Root of the mean square [N] of the friction."""
    family: dict[Family, Fit]
    """The best fit of every family that was met."""


@final
class Search:
    """A search along one balance by one rule; fits are kept.

    Parameters
    ----------
    balance : Balance
        What was measured.
    rule : Rule
        When a term stays.
    vocabulary : sequence of Term
        The candidates.
    progress : callable, optional
        Told the share that is done and the best structure after each level.
    """

    def __init__(
        self,
        balance: Balance,
        rule: Rule,
        vocabulary: Sequence[Term],
        progress: Progress | None = None,
    ) -> None:
        self.balance, self.rule, self.progress = balance, rule, progress
        self.terms = [term for term in vocabulary if term.kind not in SHOWN_LATE]
        self.delays = [term for term in vocabulary if term.kind in SHOWN_LATE]
        self.shapes = {channel: shapes(balance, channel) for channel in balance.channels}
        self.fits: dict[Structure, Fit] = {}
        self._known: dict[Structure, list[Structure]] = {}
        self.evaluated = 0
        self.scale = balance.scale

    def fit(self, structure: Structure) -> Fit:
        """Return the fit of a structure."""
        if structure not in self.fits:
            self.fits[structure] = fit(self.balance, structure)
            self.evaluated += 1
        return self.fits[structure]

    def better(self, new: Fit, old: Fit) -> bool:
        """Return whether the rule prefers a fit to another."""
        noise = acceleration_noise(self.balance, old)
        return self.rule.better(new, old, self.scale, noise) and (
            not self.rule.fault or seen_late(self.balance, new, old, self.scale)
        )

    def run(self, start: Structure) -> Searched:
        """Search from a structure and from the textbook law of both directions."""
        root = self.fit(start)
        self.scale = friction_scale(self.balance, root)
        beam = [root]
        peaked = [self._peaked(start, exponent) for exponent in STRIBECK_EXPONENTS]
        starts = (
            self._textbook(start),
            *peaked,
            *self._late_peaked(start),
            *self._late_memory(start),
            *self._damped_memory(start),
            *self._capped(start),
        )
        for structure in starts:
            full = self.prune(self.fit(structure))
            if full.ok and full.structure not in [one.structure for one in beam]:
                beam.append(full)
        for channel, wanted in self.shapes.items():
            self.balance.make_states(channel, wanted)
        trail: list[str] = []
        for level in range(LEVELS):
            before, beam = beam, self._next(beam)
            trail.append(f"{beam[0].structure} {beam[0].rms:.4g}")
            if self.progress is not None:
                done = SHARE * (1.0 - math.exp(-(level + 1) / USUAL_LEVELS))
                self.progress(done, str(beam[0].structure))
            if {one.structure for one in beam} <= {one.structure for one in before}:
                break
        return self._chosen(beam[0], trail)

    def _textbook(self, start: Structure) -> Structure:
        """Return the textbook law of both directions."""
        channels = self.balance.channels
        return start.having(*(Term(kind, (), one) for one in channels for kind in TEXTBOOK))

    def _peaked(self, start: Structure, exponent: float) -> Structure:
        """Return a Stribeck law of both directions, with the best velocity and viscous exponent.

        A step near rest and a power of the speed oppose each other: neither pays alone, and with
        another exponent of the step it is another power.
        """
        found = start
        for channel in self.balance.channels:
            top = self.balance.speed[channel]
            options = [
                found.having(
                    Term("offset", (), channel),
                    Term("stribeck", (v_s, exponent), channel),
                    Term("stribeck_dir", (v_s, exponent), channel),
                    Term("viscous", (), channel) if p == 1.0 else Term("power", (p,), channel),
                )
                for v_s in grid(top / 200.0, top / 3.0, 6)
                for p in POWERS
            ]
            errors = [training_error(self.balance, one) for one in options]
            best = int(np.argmin(errors))
            if math.isfinite(errors[best]):
                found = options[best]
        return polished(self.balance, found)

    def _capped(self, start: Structure) -> list[Structure]:
        """Return viscous friction below an amplifier's limit, at the best limit if any is possible.

        Of a force that is often beyond the limit, what does not act and what grows with the speed
        take up each other: neither pays alone.
        """
        options = [
            start.having(Term("viscous", (), term.channel), term)
            for term in self.terms
            if term.kind == "saturation"
        ]
        able = [x for x in self._best(options, 1) if training_error(self.balance, x) < math.inf]
        return [polished(self.balance, one) for one in able]

    @property
    def _measured_late(self) -> bool:
        """Whether friction itself was measured, by a channel that may be late."""
        return bool(self.delays) and not any(one.driven for one in self.balance.parts)

    def _late_peaked(self, start: Structure) -> list[Structure]:
        """Return Stribeck laws that are shown late, as the textbook law is best shown.

        A memory takes up what a late channel does to a level that falls with the speed.
        """
        if not self._measured_late:
            return []
        shown = {self._textbook(start).having(late): late for late in self.delays}
        return [
            self._peaked(start.having(shown[one]), exponent)
            for one in self._best([*shown], 1)
            for exponent in STRIBECK_EXPONENTS
        ]

    def _late_memory(self, start: Structure) -> list[Structure]:
        """Return Dahl friction that is shown late, at its best length and delay.

        Where friction itself was measured, either alone takes up most of the other.
        """
        if not self._measured_late:
            return []
        options = [
            start.having(Term("viscous", (), channel), late).shaped(channel, shape)
            for channel, wanted in self.shapes.items()
            for shape in wanted
            if shape[1:] == (1.0,)
            for late in self.delays
        ]
        return [polished(self.balance, one) for one in self._best(options, 1)]

    def _damped_memory(self, start: Structure) -> list[Structure]:
        """Return LuGre friction with a damped bristle, at its best shape, beside each shift.

        Where damping is a multiple of the level, it hides the bristle: either alone explains less
        than a gap does, as each reversal shows a force of its own.
        """
        return [
            polished(self.balance, found)
            for shift in SHIFTS
            if (found := self._damped(start, shift)) != start
        ]

    def _damped(self, start: Structure, shift: str) -> Structure:
        """Return a structure with the best damped bristle of each channel beside a shift."""
        found = start
        for channel, wanted in self.shapes.items():
            options = [
                found.having(*(Term(kind, (), channel) for kind in (shift, DAMPED, *more)))
                for more in ((), ("viscous",))
            ]
            shaped = [
                one.shaped(channel, _bell(shape))
                for one in options
                for shape in wanted
                if fades(shape)
            ]
            found = next(iter(self._best(shaped, 1)), found)
        return found

    def prune(self, found: Fit) -> Fit:
        """Return a fit without the terms and memories that do not earn their place."""
        while True:
            structure = found.structure
            smaller = [structure.without(term) for term in structure.free]
            smaller = smaller if len(structure.terms) > 1 else []
            smaller += [structure.forgetting(channel) for channel, _ in structure.memories]
            smaller += [
                structure.shaped(channel, shape[:2])
                for channel, shape in structure.memories
                if len(shape) == 5
            ]
            fits = [self.fit(one) for one in smaller if _has_columns(one)]
            enough = [one for one in fits if one.ok and not self.better(found, one)]
            if not enough:
                return found
            found = min(enough, key=lambda one: one.rms)

    def _next(self, beam: Sequence[Fit]) -> list[Fit]:
        """Return the beam of the next level: different families, not neighbours on a grid."""
        pool = {one.structure: one for one in beam}
        for old in beam:
            if old.structure not in self._known:
                self._known[old.structure] = self._proposed(old)
            for structure in self._known[old.structure]:
                new = self.fit(structure)
                if self._stays(new, old):
                    pool.setdefault(structure, new)
        ranked = sorted(pool.values(), key=lambda one: one.rms)
        found: list[Fit] = []
        for one in ranked:
            families = {other.structure.family for other in found}
            if len(found) < BEAM and one.structure.family not in families:
                found.append(one)
        return [one if one in beam else self._polished(one) for one in found]

    def _stays(self, new: Fit, old: Fit) -> bool:
        """Return whether a new fit may take the place of an old one."""
        if not new.ok:
            return False
        if new.structure.family == old.structure.family:
            return new.rms < old.rms
        if not self.better(new, old):
            return False
        further = [term for term in new.structure.terms if term not in old.structure.terms]
        return not self.rule.halves or all(repeats(self.balance, new, term) for term in further)

    def _polished(self, found: Fit) -> Fit:
        better = self.fit(polished(self.balance, found.structure))
        return better if better.ok and better.rms <= found.rms else found

    def _proposed(self, old: Fit) -> list[Structure]:
        """Return the structures that a level fits: added, swapped, late, remembering, smaller."""
        structure = old.structure
        terms = [
            structure.alike(one)
            for one in self.terms
            if one.kind not in (DAMPED, *GROWN) or structure.having(one).complete
        ]
        candidates = [*terms, *ripples(self.balance, old), *hums(self.balance, old)]
        ranked = moves(self.balance, structure, candidates)
        self.evaluated += len(ranked)
        seen, fresh = set(), []
        for move in ranked:
            key = (move.term.kind, move.term.channel, move.gone and move.gone.kind)
            if key not in seen:
                seen.add(key)
                fresh.append(move)
        proposed = [self._moved(structure, move) for move in fresh[:BEST_MOVES]]
        proposed += self.late(structure)
        for channel in self.balance.channels:
            proposed += self._remembering(structure, channel)
        if len(structure.terms) > 1:
            proposed += [structure.without(term) for term in structure.free]
        return [one for one in proposed if _has_columns(one)]

    def _moved(self, structure: Structure, move: Move) -> Structure:
        """Return a structure after a move.

        A limit is taken off its grid first: a part of what is beyond the nearest may act.
        """
        found = move.applied(structure)
        return polished(self.balance, found) if move.term.kind == "saturation" else found

    def late(self, structure: Structure, kinds: Sequence[str] = SHOWN_LATE) -> list[Structure]:
        """Return the structure with the best delays, or filters, of the force."""
        for term in structure.terms:
            if term.kind in SHOWN_LATE:
                structure = structure.without(term)
        options = [structure.having(term) for term in self.delays if term.kind in kinds]
        return self._best(options, BEST_DELAYS)

    def _remembering(self, structure: Structure, channel: str) -> list[Structure]:
        """Return the structure with the best bristle shapes, and with a second memory."""
        acts = any(
            through_bristle(term.kind) and term.channel == channel for term in structure.terms
        )
        if not acts or not self.shapes[channel]:
            return []

        def shaped(shape: Shape) -> Structure:
            return structure.shaped(channel, shape)

        def second(shape: Shape) -> Structure:
            return structure.having(Term("second", shape, channel))

        stribeck = any(term.kind.startswith("stribeck") for term in structure.terms)
        found = self._scanned(structure, channel, shaped, lugre=not stribeck)
        if structure.shape(channel) != SIGN:
            found.append(structure.forgetting(channel))
            if not structure.has("second"):
                seconds = self._scanned(structure, channel, second, lugre=False)
                found += [polished(self.balance, one) for one in seconds[:1]] + seconds[1:]
        return found

    def _scanned(
        self, structure: Structure, channel: str, wrap: Wrap, *, lugre: bool
    ) -> list[Structure]:
        """Return the best shapes: for each exponent by a grid and a parabola in its logarithm.

        Of LuGre shapes, the grid has levels that fade exponentially; one that fades as a bell, as
        the law is usually written, is found from the best of them.
        """
        options: list[Structure] = []
        for n in SHAPE_EXPONENTS:
            row = [one for one in self.shapes[channel] if one[1] == n and len(one) == 2]
            if not row:
                continue
            errors = np.array([training_error(self.balance, wrap(one)) for one in row])
            self.evaluated += len(row)
            at = int(np.argmin(errors))
            length = _between(row, errors, at)
            options += [
                wrap(one)
                for one in dict.fromkeys([(length, n), row[at]])
                if one != structure.shape(channel)
            ]
        if lugre:
            all_lugre = [wrap(one) for one in self.shapes[channel] if fades(one)]
            self.evaluated += len(all_lugre) + 1
            for one in self._best(all_lugre, 1):
                bell = one.shaped(channel, _bell(one.shape(channel)))
                damped = bell.having(Term(DAMPED, (), channel))
                options += [one, *(polished(self.balance, each) for each in (bell, damped))]
        return self._best(options, BEST_SHAPES)

    def _best(self, options: Sequence[Structure], count: int) -> list[Structure]:
        """Return the structures with the least errors in training."""
        errors = [training_error(self.balance, one) for one in options]
        order = sorted(range(len(options)), key=lambda i: errors[i])
        return [options[i] for i in order[:count]]

    def _chosen(self, best: Fit, trail: Sequence[str]) -> Searched:
        """Return the most usual structure that the rule does not tell apart from the best.

        An accusation of the rig that does not earn its margin is first replaced by the best
        structure without one: pruning by that margin would lose true terms.
        """
        family: dict[Family, Fit] = {}
        for one in self.fits.values():
            key = one.structure.family
            if one.ok and (key not in family or one.rms < family[key].rms):
                family[key] = one
        if self.rule.ties and best.structure.faults:
            sound = [
                one
                for one in family.values()
                if not one.structure.faults and not self.better(best, one)
            ]
            best = min(sound, key=lambda one: one.rms, default=best)
        best = self.prune(best)
        ties = [
            one
            for one in sorted(family.values(), key=lambda one: one.rms)
            if one.structure.family != best.structure.family and not self.better(best, one)
        ]
        known = {term.kind for term in best.structure.faults}
        simpler = [  # nor does a rig have to be accused to name what is more usual
            one
            for one in ties
            if one.structure.cost < best.structure.cost
            if {term.kind for term in one.structure.faults} <= known
        ]
        if self.rule.ties and simpler:
            usual = min(simpler, key=lambda one: (one.structure.cost, one.rms))
            ties = [best, *(one for one in ties if one is not usual)]
            best = usual
        ties.sort(key=lambda one: one.structure.cost)
        return Searched(
            best=best,
            ties=tuple(ties),
            trail=tuple(trail),
            scale=self.scale,
            family=family,
        )


def _bell(shape: Shape) -> Shape:
    """Return a LuGre shape whose level fades as a bell, as the law is usually written."""
    return (*shape[:4], 2.0)


def _has_columns(structure: Structure) -> bool:
    """Return whether a structure has a term with a column."""
    return any(term.kind not in SHOWN_LATE for term in structure.terms)


def _between(
    row: Sequence[Shape], errors: "np.ndarray[tuple[int], np.dtype[np.float64]]", at: int
) -> float:
    """Return the length of the least error by a parabola through it and its neighbours."""
    if not 0 < at < len(row) - 1 or not np.isfinite(errors[at - 1 : at + 2]).all():
        return row[at][0]
    left, middle, right = (float(one) for one in errors[at - 1 : at + 2])
    bend = left - 2.0 * middle + right
    share = float(np.clip(0.5 * (left - right) / max(bend, 1e-300), -0.5, 0.5))
    ratio = math.log(row[1][0] / row[0][0])
    return float(f"{math.exp(math.log(row[at][0]) + ratio * share):.3g}")

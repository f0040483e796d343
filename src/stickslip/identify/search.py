r"""The search: a beam over structures, and grids of shapes that are refined where laws are good.

A structure is scored by its held-out losses, damped block by block,

.. math:: R_b = (\nu + 1) \log(1 + L_b / \nu),

which is -2 log of Student's t density: one wild block cannot decide, and a wild law costs little
more there than a poor one. From the best structures (`Thresholds.beam`), terms are added, taken
away, or their shape is swapped, until no round finds a better structure. Then the shapes of the
best families are refined between the points of the grid, and the curves that are no law join,
beside the best law's properties of the rig.
"""

import itertools
import math
from collections.abc import Iterator, Sequence

import numpy as np

from stickslip.errors import InputError
from stickslip.identify.candidates import DIGITS
from stickslip.identify.evidence import evidence_of, prudent_choice
from stickslip.identify.problem import Array, Column, Family, Problem, Shape, Structure
from stickslip.identify.regression import TOGETHER, BlockRegression, noise_weights
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.show.formatting import joined


def block_scores(losses: Array) -> Array:
    """Return the scores (b,) of held-out losses (b,), in units of the noise.

    Examples
    --------
    >>> block_scores(np.array([0.0, 1.0, 1e12])).round(2).tolist()
    [0.0, 1.12, 131.22]
    """
    nu = THRESHOLDS.freedom
    return np.asarray((nu + 1.0) * np.log1p(losses / nu))


class Search:
    """Structures of a problem with their scores, after `run`."""

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.regression = BlockRegression(problem)
        self.regression.add(
            itertools.chain(
                ((name, shape) for name, term in problem.terms.items() for shape in term.shapes),
                itertools.chain.from_iterable(problem.references),
            )
        )
        self._orders: dict[Structure, tuple[float, int, Structure]] = {}

    def run(self) -> "Search":
        """Search with weights that follow from the best structure before; return itself."""
        regression = self.regression
        first = BlockRegression(self.problem)
        first.add(itertools.chain.from_iterable(self.problem.references))
        first.weigh(regression.weights)
        first.losses(self.problem.references)
        best = min(
            self.problem.references, key=lambda one: np.mean(block_scores(first.losses_of[one]))
        )
        weights = regression.weights
        for k in range(THRESHOLDS.weighings):
            last = weights
            # errors of a curve between the readings are no scatter
            weights = noise_weights(regression if k else first, best, even=k == 0)
            if k and np.allclose(weights, last, rtol=THRESHOLDS.weighed):
                break
            regression.weigh(weights)
            self._orders.clear()
            best = self._climb()
            self._add_usual(best)
            self._refine()
            self._exchange()
            best = self._likely()
        regression.forget()
        return self

    def _likely(self) -> Structure:
        """Return the structure by whose residuals the rows are weighed."""
        if not self.problem.worth:
            return min(self.structures, key=self._priced)
        structures = self.structures
        best_of: dict[Family, int] = {}
        for i, structure in enumerate(structures):
            if self.problem.is_law(structure):
                best_of.setdefault(self.problem.family(structure), i)
        evidence = evidence_of(self.regression, structures, best_of)
        return structures[prudent_choice(self.regression, structures, evidence)]

    @property
    def structures(self) -> list[Structure]:
        """Structures with physical coefficients that were met, the best first."""
        known = self.regression.losses_of
        found = [one for one, losses in known.items() if math.isfinite(losses[0])]
        return sorted(found, key=self._order)

    def _order(self, structure: Structure) -> tuple[float, int, Structure]:
        key = self._orders.get(structure)
        if key is None:
            losses = self.regression.losses_of[structure]
            score = round(float(np.mean(block_scores(losses))), DIGITS)
            key = self._orders[structure] = (score, self.problem.parameters(structure), structure)
        return key

    def _priced(self, structure: Structure) -> tuple[float, Structure]:
        """Return half the score plus what parameters cost: rich laws follow the noise."""
        price = self.regression.price or THRESHOLDS.price / len(self.problem.blocks)
        price *= self._order(structure)[1]
        return round(0.5 * self._order(structure)[0] + price, DIGITS), structure

    def _climb(self) -> Structure:
        """Return the best structure that additions, removals and swaps of terms lead to."""
        problem = self.problem
        front = self._begin()
        for _ in range(THRESHOLDS.depth):
            tried = [
                one
                for k, structure in enumerate(front)
                for one in self._neighbours(structure, replacing=k == 0)
                if self._is_determined(one) and problem.allowed(one)
            ]
            self.regression.losses(tried)
            best_of: dict[Family, Structure] = {}
            for structure in sorted(dict.fromkeys(tried), key=self._order):
                best_of.setdefault(self.problem.family(structure), structure)
            ranked = sorted(dict.fromkeys([*best_of.values(), *front]), key=self._order)
            ahead = ranked[: THRESHOLDS.beam]
            if set(ahead) <= set(front):
                break
            front = ahead
        self._add_curves(front[0])
        return min(self.structures, key=self._order)

    def _add_curves(self, law: Structure) -> None:
        """Compare the measured curves, alone and beside what they do not stand for in a law."""
        problem, beside = self.problem, self.problem.beside_curve(law)
        curves = [tuple(sorted({*one, *beside})) for one in problem.references]
        curves = [one for one in curves if problem.allowed(one)]
        self.regression.losses([*curves, *problem.references])

    def _is_determined(self, structure: Structure, *, usual: bool = False) -> bool:
        """Return whether blocks and rows are more than parameters by enough.

        With fewer, one of a hundred shapes is always exact by chance; usual laws need less.
        """
        problem, blocks = self.problem, len(self.problem.blocks)
        laws = tuple(one for one in structure if problem.terms[one[0]].role == "law")
        most = blocks - 1 if usual else max(2, min(2 * blocks // 3, blocks - 2))
        spare = 1 if usual else 3
        return (
            problem.parameters(laws) <= most
            and problem.parameters(structure) <= len(problem.response) - spare
        )

    def _begin(self) -> list[Structure]:
        """Return the structures from which the search begins: none, or the laws asked for.

        The best usual laws in their first shapes join, as terms that replace each other, such as a
        memory and a delay, are not reached from a structure that has the other.
        """
        problem, front = self.problem, list[Structure]([()])
        if problem.only:
            self._compare(problem.only, ())
            front = sorted((one for one in self.structures if problem.allowed(one)),
                           key=self._order)[: THRESHOLDS.beam]  # fmt: skip
            if not front:
                laws = joined([" + ".join(family) for family in problem.only])
                raise InputError(
                    f"this measurement cannot tell the parameters of {laws}: measure more, or"
                    " compare other laws."
                )
        else:
            terms = problem.terms
            usual = [
                tuple(sorted((name, terms[name].shapes[0]) for name in family))
                for family in problem.usual
                if set(family) <= terms.keys()
            ]
            usual = [one for one in usual if problem.allowed(one) and self._is_determined(one)]
            self.regression.losses(usual)
            front += sorted(usual, key=self._order)[: THRESHOLDS.beam - 1]
        self.regression.losses(front)
        return front

    def _add_usual(self, best: Structure) -> None:
        """Compare the usual laws, alone and beside what the best law has of the rig."""
        terms = self.problem.terms
        beside = [column for column in best if terms[column[0]].role in ("rig", "run", "fault")]
        self._compare(self.problem.only or self.problem.usual, beside)

    def _compare(self, families: Sequence[Family], beside: Sequence[Column]) -> None:
        """Compare families in all shapes, alone and beside other columns."""
        terms, tried = self.problem.terms, list[Structure]()
        for family in families:
            if not set(family) <= terms.keys():
                continue
            grids = [[(name, shape) for shape in terms[name].shapes] for name in family]
            for structure in itertools.product(*grids):
                together = {name: (name, shape) for name, shape in (*beside, *structure)}
                whole = [tuple(sorted(structure)), tuple(sorted(together.values()))]
                tried += [
                    one
                    for one in whole
                    if self.problem.allowed(one) and self._is_determined(one, usual=True)
                ]
        self.regression.losses(tried)

    def _neighbours(self, structure: Structure, *, replacing: bool) -> Iterator[Structure]:
        """Yield structures with a term more, less, in another shape, or in place of another."""
        less = [tuple(other for other in structure if other != one) for one in structure]
        yield from less
        for name, term in self.problem.terms.items():
            for begun in [structure, *(less if replacing else ())]:
                others = [column for column in begun if column[0] != name]
                for shape in term.shapes:
                    yield tuple(sorted([*others, (name, shape)]))

    def _refine(self) -> None:
        """Halve the grid around the best shapes of the best families."""
        for k in range(THRESHOLDS.refinements):
            best_of: dict[Family, dict[Shape, Structure]] = {}
            for structure in sorted(self.structures, key=self._priced):
                if self.problem.is_law(structure):
                    forms = best_of.setdefault(self.problem.family(structure), {})
                    forms.setdefault(self._fixed(structure), structure)
            # rows of a record are so many that the best of the coarse grid are the best
            top = [next(iter(forms.values())) for forms in best_of.values()][: THRESHOLDS.families]
            # what is named beside a law has to be needed with the best shapes of the law alone
            plain = self._laws_of(top)
            around = [
                one
                for structure in dict.fromkeys([*top, *plain])
                for one in self._between(structure, 0.5 ** (k + 1))
            ]
            around = [one for one in around if self.problem.allowed(one)]
            self.regression.add(column for one in around for column in one)
            self.regression.losses(around)

    def _exchange(self) -> None:
        """Give away, add and swap terms where shapes are fine, and refine what that leads to.

        On a coarse grid of shapes, terms that are not there make up for a limit or a time constant
        that is: the structure without them is only as good with fine shapes.
        """
        problem = self.problem
        best = self._cheapest()
        for _ in range(THRESHOLDS.depth):
            tried = [
                one
                for one in self._neighbours(best, replacing=True)
                if problem.allowed(one) and self._is_determined(one)
            ]
            self.regression.losses(tried)
            last, best = best, self._cheapest()
            if best == last:
                break
            if problem.family(best) != problem.family(last):
                self._refine()
                best = self._cheapest()
        self._add_curves(best)

    def _cheapest(self) -> Structure:
        """Return the law that predicts best at the price of its parameters."""
        return min((one for one in self.structures if self.problem.is_law(one)), key=self._priced)

    def _fixed(self, structure: Structure) -> Shape:
        """Return the entries of shapes that are not refined, such as a Stribeck exponent."""
        terms = self.problem.terms
        return tuple(
            value
            for name, shape in structure
            for value, step in zip(shape, terms[name].steps, strict=False)
            if step == 1.0
        )

    def _laws_of(self, structures: Sequence[Structure]) -> list[Structure]:
        """Return the best shapes that the laws of structures have without faults beside them."""
        terms, family = self.problem.terms, self.problem.family
        plain = dict.fromkeys(
            tuple(column for column in structure if terms[column[0]].role != "fault")
            for structure in structures
        )
        self.regression.losses(plain)
        best_of: dict[Family, Structure] = {}
        for structure in self.structures:
            best_of.setdefault(family(structure), structure)
        return [best_of.get(family(structure), structure) for structure in plain]

    def _between(self, structure: Structure, share: float) -> Iterator[Structure]:
        """Yield a structure with shapes a part of a step away, alone and together."""
        moved: list[Sequence[Column]] = []
        for name, shape in structure:
            steps = self.problem.terms[name].steps[: len(shape)]
            limits = self.problem.terms[name].ranges or [(0.0, math.inf)] * len(steps)
            entries = [
                (value,)
                if step == 1.0 or value == 0.0
                else [
                    other
                    for other in (value / step**share, value, value * step**share)
                    if low <= other <= high
                ]
                for value, step, (low, high) in zip(shape, steps, limits, strict=False)
            ]
            rest = shape[len(entries) :]
            moved.append([(name, (*entry, *rest)) for entry in itertools.product(*entries)])
        together = list(itertools.islice(itertools.product(*moved), TOGETHER + 1))
        if len(together) <= TOGETHER:
            yield from together
        else:  # one after the other
            for k, own in enumerate(moved):
                yield from ((*structure[:k], one, *structure[k + 1 :]) for one in own)

r"""What the judge takes: a response, its blocks, and the terms that may explain it.

A measurement of any kind is written as

.. math:: y_i = \sum_{j \in S} X_j(\text{row}_i; \theta_j)\, c_j + \text{noise},

where :math:`y` is a force (tables, maps, records), :math:`S` is a *structure*: a set of terms, each
with a shape :math:`\theta_j` that is not linear (a Stribeck velocity, an exponent, a length of
bristles), and :math:`c_j` are coefficients. Parts of friction laws, properties of the rig, faults
of the measurement and the curve as measured are all terms; what differs is their role.

Blocks are rows that are predicted together from the others: what is left out is what will be
asked, such as another speed, another load, another stretch of time.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.laws import Composition, Sliding
from stickslip.identify.posterior import family_of
from stickslip.identify.thresholds import THRESHOLDS

Array: TypeAlias = NDArray[np.float64]
Mask: TypeAlias = NDArray[np.bool_]
Shape: TypeAlias = tuple[float, ...]
Column: TypeAlias = tuple[str, Shape]
"""Name of a term and its shape."""
Structure: TypeAlias = tuple[Column, ...]
"""Terms with their shapes, in the order of their names."""
Family: TypeAlias = tuple[str, ...]
"""Names of the terms of a structure."""
Role: TypeAlias = Literal["law", "rig", "run", "fault", "curve"]
ALIKE = 0.02
"""Difference of logarithms up to which speeds, or loads, are the same."""
ASKED = 40
"""Speeds of each direction at which the band is stated."""
STRETCHES = 20
"""Stretches of records, or of the speeds of a table, that are left out one at a time, at most."""
BENDING = (0.001, 0.01, 0.1, 1.0)
"""Penalties of the bending of the measured curve, in units of the noise."""
BEYOND = 3
"""Knots of the measured curve beyond the measured speeds on either side."""
OPENING = 0.5
"""Part of the root of its stiffness that the measured curve has beyond the measured speeds."""
RUNNING_IN = (0.0, 0.2, 0.6)
"""Time constants of drifts over the time of measuring; 0: straight."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Term:
    """Something that may explain a part of the response."""

    name: str
    """Key; of parts of laws that of `stickslip.friction`."""
    role: Role
    """Part of a law, property of the rig, random effect of runs, fault, or the measured curve."""
    columns: Callable[[Any, Shape], Array]
    """Columns (n,) or (n, d) at rows of the problem, for a shape."""
    shapes: Sequence[Shape] = ((),)
    """Shapes that are tried first."""
    steps: Sequence[float] = ()
    """Ratios between neighbouring shapes, by entry; 1 for entries that are not refined."""
    ranges: Sequence[tuple[float, float]] = ()
    """Ranges of the entries of the shape in which they are refined; all if not given."""
    precision: Callable[[Shape], Array | float] = lambda _: 0.0
    """Inverse variance of the coefficients of a random effect, in units of the noise; 0: fixed."""
    nonnegative: bool = False
    """Whether coefficients below 0 are no physics."""
    limits: tuple[float, float] = (-math.inf, math.inf)
    """Least and largest coefficient that is physics."""
    excludes: frozenset[str] = frozenset()
    """Terms that never stand beside it: other forms of the same part."""
    needs: frozenset[str] = frozenset()
    """Terms of which at least one must stand beside it; empty: none."""
    same_shape: int | None = None
    """Entry of the shape that all terms of a structure that have one share, such as an exponent."""
    shared: int = 0
    """First entries of the shape that are those of the memory, which all terms of a structure
    that have one share; 0 in the first of them: no memory."""
    title: str = ""
    """What it is called in a sentence."""
    rank: int = 0
    """Place in the order from usual to unusual."""
    cost: int = 1
    """Parameters that the coefficients count."""
    doubt: float = 0.0
    """Standard uncertainty of a coefficient that is stated and not fitted: 0, give or take it."""

    def parameters(self, shape: Shape) -> int:
        """Return the number of parameters: coefficients, and entries of the shape that are fitted.

        Examples
        --------
        >>> step = Term(name="stribeck", role="law", columns=lambda _, s: _, steps=(1.5, 1.0))
        >>> step.parameters((0.1, 2.0))
        2
        """
        return self.cost + sum(
            step != 1.0 and value != 0.0
            for step, value in zip(self.steps[: len(shape)], shape, strict=False)
        )


SIDE = "direction"
"""Feature that has the sign of the motion."""
MEMORY = "memory"
"""Marks families whose law has a memory of the way."""


class Problem(ABC):
    """One measurement of any kind, as the judge sees it."""

    response: Array
    """What was measured (n,)."""
    blocks: Sequence[Mask]
    """Rows (n,) that are predicted together; they may overlap."""
    excluded: Sequence[Mask]
    """Rows (n,) that are not learned from while a block is left out: itself and what is near."""
    rows: Any
    """The rows, as the columns of terms take them."""
    terms: Mapping[str, Term]
    """The vocabulary by name."""
    references: Sequence[Structure]
    """Structures of the measured curve, which is no law."""
    always: frozenset[str] = frozenset()
    """Terms without which no others stand."""
    curved: frozenset[str] | None = None
    """Terms that the measured curve stands for; None: all parts of laws."""
    usual: Sequence[Family] = ()
    """Families that are always compared: the laws that the field uses."""
    instead: Mapping[str, str] = {}
    """By name of a term, what the same columns could be too, which the vocabulary leaves out."""
    only: Sequence[Family] = ()
    """Families whose laws are compared beside properties of the rig; empty for all."""
    curve_share: float = THRESHOLDS.curve_share
    """Least share of the measured curve in the ensemble."""
    stretches: NDArray[np.intp]
    """Number of the stretch of each row (n,), between which errors are independent."""
    worth: float = 1.0
    """Independent readings that a row is worth, by which structures have a likelihood; 0: none."""
    softness: float
    """Exponent by which rows beyond `Thresholds.outlier` lose weight."""
    spread: float = 1.0
    """Factor on the covariance: how far another record differs from this."""

    @abstractmethod
    def scales(self, fitted: Array) -> Sequence[Array]:
        """Return what the scatter may grow with, (n,) each and above 0."""

    @abstractmethod
    def speeds(self, rows: Any) -> Array:
        """Return the speeds of rows (n,), above 0: readings at alike ones scatter alike."""

    @abstractmethod
    def at(
        self,
        velocity: Any,
        load: Any = None,
        inputs: Mapping[str, Any] | None = None,
    ) -> Any:
        """Return rows of steady sliding at velocities (n,); the rest is usual if not given."""

    @abstractmethod
    def asked(self) -> Any:
        """Return the rows, with their `velocity`, over which the band is stated."""

    @abstractmethod
    def speeds_of_curve(self) -> Array:
        """Return rising speeds (n,) through which a curve is drawn as a law."""

    @abstractmethod
    def points(self, structure: Structure, coefficients: Array) -> "Points":
        """Return what a figure shows of the measurement beside a structure with coefficients."""

    @abstractmethod
    def composition(
        self, structure: Structure, coefficients: Array, *, offset: bool = False
    ) -> Composition:
        """Return the law that a structure with coefficients (d, p) is.

        With `offset` a constant offset is part of its levels, which differ by direction then.
        """

    def acting(self, structure: Structure, coefficients: Array, rows: Any) -> Array:
        """Return friction and constant offset (n,) of a structure with coefficients (p,) at rows.

        What drifts, ripples or differs between runs is 0 in the mean, and left out.
        """
        return self._summed(structure, coefficients, rows, offset=True)

    def sliding(
        self, structure: Structure, coefficients: Array, *, offset: bool = False
    ) -> Sliding:
        """Return how a structure with coefficients (p,) slides, with its offset or without."""
        # with the digits that a law through its levels is written with
        speeds = np.array([float(f"{u:.6g}") for u in self.speeds_of_curve()])
        velocity = np.concatenate([-speeds[::-1], speeds])
        rows = self.at(velocity)
        friction = self._summed(structure, coefficients, rows, offset=offset)
        return Sliding(velocity=velocity, friction=friction)

    def _summed(
        self, structure: Structure, coefficients: Array, rows: Any, *, offset: bool
    ) -> Array:
        """Return the sum (n,) of the terms of a law, and of a constant offset with it."""
        columns, at = Columns(self, rows), 0
        found = np.zeros(len(rows.velocity))
        for column in structure:
            x = columns.of(column)
            if self.terms[column[0]].role in ("law", "curve") or (offset and column[0] == "offset"):
                found += x @ coefficients[at : at + x.shape[1]]
            at += x.shape[1]
        return found

    def features(self, rows: Any) -> Mapping[str, Array]:
        """Return what rows may be told apart by: values (n,) or columns (n, d), by name.

        NaN where rows do not state it, such as the time of a steady motion. `SIDE` is among them.
        """
        return {}

    def parts(self) -> Sequence[Mask]:
        """Return rows (n,) that differ as another measurement does, if rows are dense."""
        return self.blocks

    def beside(self, rows: Any) -> Array:
        """Return what readings at asked rows show beside the response, at measured rows (n,)."""
        return np.zeros(len(self.response))

    def price(self, size: float) -> float:
        """Return the share of the held-out error that a parameter must save to be believed.

        `size` is that of the response over its noise. On a dense record everything is significant,
        and what saves less is not found in the next.
        """
        return 0.0

    def physical(self, structure: Structure, coefficients: Array) -> Mask:
        """Return which coefficients (d, p) of a structure are physics (d,)."""
        return np.ones(len(coefficients), dtype=bool)

    def noise_floor(self, structure: Structure, coefficients: Array) -> Array | float:
        """Return the mean square that noise of the sensors makes of the response (n,).

        0 where that is not known: then all that is left could be explained.
        """
        return 0.0

    @property
    def twins(self) -> Sequence["Problem"]:
        """The same measurement prepared otherwise, whose differences count as uncertainty."""
        return ()

    def serves(self, structure: Structure) -> bool:
        """Return whether this problem, as a twin of another, is one for a structure."""
        return True

    def allowed(self, structure: Structure) -> bool:
        """Return whether the terms of a structure may stand together."""
        names, shared = {name for name, _ in structure}, set()
        memories = {self._memory(column) for column in structure} - {()}
        if len(memories) > 1 or not (self.always <= names or names <= self.always):
            return False
        if self.only and not self._is_asked(names):
            return False
        for name, shape in structure:
            term = self.terms[name]
            if term.excludes & names or (term.needs and not term.needs & names):
                return False
            if term.same_shape is not None and len(shape) > term.same_shape:
                shared.add(shape[term.same_shape])
        return len(shared) < 2

    def _is_asked(self, names: Set[str]) -> bool:
        """Return whether the parts of laws among names are those of a law that is compared."""
        laws = {name for name in names if self.terms[name].role == "law"}
        asked = [{name for name in one if self.terms[name].role == "law"} for one in self.only]
        return laws in asked or any(self.terms[name].role == "curve" for name in names)

    def _memory(self, column: Column) -> Shape:
        name, shape = column
        return tuple(shape[: self.terms[name].shared])

    def family(self, structure: Structure) -> Family:
        """Return the names of the terms of a structure, marked where it has a memory.

        What is doubtful of all laws alike is of no family.
        """
        memory = any(one[0] != 0.0 for one in map(self._memory, structure) if one)
        names = tuple(name for name in family_of(structure) if not self.terms[name].doubt)
        return (*names, MEMORY) if memory else names

    def parameters(self, structure: Structure) -> int:
        """Return the number of parameters of a structure."""
        return sum(self.terms[name].parameters(shape) for name, shape in structure)

    def rank(self, structure: Structure) -> int:
        """Return how unusual the terms of a structure are, together."""
        return sum(self.terms[name].rank for name, _ in structure)

    def is_usual(self, structure: Structure) -> bool:
        """Return whether a law is in common use, or none, whatever runs and faults there are."""
        parts = {name for name, _ in structure if self.terms[name].role not in ("run", "fault")}
        return parts <= {"offset", *self.always} or parts in [set(one) for one in self.usual]

    def beside_curve(self, structure: Structure) -> Structure:
        """Return the columns of a structure that the measured curve does not stand for."""
        if self.curved is not None:
            return tuple(one for one in structure if one[0] not in self.curved)
        return tuple(one for one in structure if self.terms[one[0]].role in ("rig", "run"))

    def is_law(self, structure: Structure) -> bool:
        """Return whether a structure is a law, and not the measured curve."""
        return all(self.terms[name].role != "curve" for name, _ in structure)


def bending_of(knots: Array) -> tuple[Array, Array]:
    """Return eigenvalues (k,) and vectors (k, k) of the bending of a curve over its knots (k,).

    The slope of the curve walks at random over the knots; over those `BEYOND` what was measured at
    either end more freely. A straight line does not bend: its constant comes first, then
    its slope. Signs are such that no rounding decides them: draws depend on them.

    Examples
    --------
    >>> values, vectors = bending_of(np.linspace(0.0, 2.0, 9))
    >>> bool(values[1] == 0.0 < values[2]), np.round(vectors[:, 0], 3).tolist()[:2]
    (True, [0.333, 0.333])
    """
    gaps = np.maximum(np.diff(knots), 1e-6)
    slopes = np.diff(np.eye(len(knots)), axis=0) / gaps[:, None]
    between = 0.5 * (gaps[:-1] + gaps[1:])
    root = np.diff(slopes, axis=0) / np.sqrt(between)[:, None]
    root[:BEYOND] *= OPENING
    root[-BEYOND:] *= OPENING
    values, vectors = np.linalg.eigh(root.T @ root)
    straight, _ = np.linalg.qr(np.column_stack([np.ones(len(knots)), knots]))
    values[:2], vectors[:, :2] = 0.0, straight
    return values, vectors * np.sign(np.exp(np.linspace(0.0, 1.0, len(knots))) @ vectors)


@dataclass(frozen=True, kw_only=True, eq=False)
class Points:
    """Friction as it was measured, for a figure."""

    velocity: Array
    """Velocities (n,) [m/s]."""
    friction: Array
    """Friction (n,) [N]: the response, less what a structure says of the rig."""
    load: Array
    """Loads (n,) [N]."""
    rows: NDArray[np.intp] | None
    """Rows of the problem (n,) that are shown; None of free motions, whose forces have others."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fitted:
    """A structure fitted to all rows."""

    fitted: Array
    """Fitted values (n,)."""
    coefficients: Array
    """Coefficients (p,)."""
    covariance: Array
    """Their covariance (p, p)."""
    freedom: float
    """Degrees of freedom of Student's t."""
    root: Array | None = None
    """A root (k, p) of the covariance, where it is known: root.T @ root is the covariance."""


@dataclass(eq=False)
class Columns:
    """Columns of a problem at other rows, made once."""

    problem: Problem
    rows: Any
    made: dict[Column, Array] = field(default_factory=dict)

    def of(self, column: Column) -> Array:
        """Return the columns (n, d) of a term with a shape."""
        if column not in self.made:
            name, shape = column
            x = np.asarray(self.problem.terms[name].columns(self.rows, shape), dtype=float)
            self.made[column] = x[:, None] if x.ndim == 1 else x
        return self.made[column]

    def matrix(self, structure: Structure, count: int) -> Array:
        """Return the columns (n, p) of a structure."""
        if not structure:
            return np.zeros((count, 0))
        return np.hstack([self.of(column) for column in structure])

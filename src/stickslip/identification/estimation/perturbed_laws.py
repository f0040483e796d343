"""A law and copies of it with one parameter moved each, as one law whose parameters are arrays."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.quantities import parameters, shadow, vary

Array = NDArray[np.float64]

MOVED = 1e-5
"""Share of its size by which a parameter is moved for slopes."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PerturbedLaws:
    """A law at some values, copies with one parameter moved each, and plain ones for bristles.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> from stickslip.identification.estimation.parameters import FreeParameter
    >>> from stickslip.quantities import Quantity
    >>> level = FreeParameter(
    ...     path="friction.kinetic_coefficient", quantity=Quantity("mu_k"), start=0.5
    ... )
    >>> own = PerturbedLaws.of(
    ...     Coulomb(kinetic_coefficient=0.5), FreeParameters((level,)), np.array([0.4]), constant=""
    ... )
    >>> forces = own.law.force(np.array([[-0.1], [0.1]]), 10.0)
    >>> forces[:, 0], own.slopes_of(forces).round(6)[:, 0]
    (array([-4.,  4.]), array([-10.,  10.]))
    """

    law: Any
    """The law; parameters that are looked for are arrays (copies,)."""
    base: FrictionLaw
    """The same law with numbers."""
    constant: int | None
    """Which unknown is the constant force beside the law."""
    offset: float | None
    """Value of that unknown."""
    moved: Array
    """By how much the parameter of each moved copy was moved (m,)."""
    columns: tuple[int, ...]
    """Which unknown each moved copy is of."""
    free_parameters: int
    """Number of unknowns."""

    @property
    def bristles(self) -> int:
        """Number of bristles, for each of which there is one more copy."""
        return len(self.base.states)

    @property
    def count(self) -> int:
        """Number of copies."""
        return 1 + len(self.moved) + self.bristles

    @classmethod
    def of(
        cls,
        law: FrictionLaw,
        free_parameters: FreeParameters,
        values: Array,
        *,
        constant: str,
        slopes: bool = True,
    ) -> "PerturbedLaws":
        """Return the copies of a law at values (p,) of the unknowns."""
        items = free_parameters.items
        own = [i for i, item in enumerate(items) if item.path.startswith("friction.")]
        numbers = {items[i].path: float(values[i]) for i in own}
        base = vary(law, "friction", numbers)
        sizes = [_size(float(values[i]), items[i].start, items[i].high) for i in own]
        moved = MOVED * np.array(sizes) if slopes else np.zeros(0)
        table = {
            path: np.full(1 + len(moved) + len(base.states), value)
            for path, value in numbers.items()
        }
        for k in range(len(moved)):
            table[items[own[k]].path][1 + k] += moved[k]
        at = next((i for i, item in enumerate(items) if item.path == constant), None)
        return cls(
            law=with_arrays(base, table),
            base=base,
            constant=at,
            offset=None if at is None else float(values[at]),
            moved=moved,
            columns=tuple(own) if slopes else (),
            free_parameters=len(items),
        )

    def slopes_of(self, forces: Array) -> Array:
        """Return slopes by the unknowns (n, p) from the forces of the copies (n, copies)."""
        table = np.zeros((len(forces), self.free_parameters))
        moved = forces[:, 1 : 1 + len(self.moved)]
        table[:, list(self.columns)] = (moved - forces[:, :1]) / self.moved
        if self.constant is not None:
            table[:, self.constant] = 1.0
        return table


def _size(value: float, start: float, high: float) -> float:
    """Return the size that a parameter is moved by a share of; it may be 0 at a bound."""
    room = 1e-3 * high if np.isfinite(high) else 0.0
    return max(
        abs(value), abs(start) if value == 0.0 else 0.0, room if value == 0.0 else 0.0, 1e-12
    )


def with_arrays(law: FrictionLaw, table: Mapping[str, Array]) -> Any:
    """Return a law with arrays (copies,) for some of its parameters, by path.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> both = with_arrays(
    ...     Coulomb(kinetic_coefficient=0.5),
    ...     {"friction.kinetic_coefficient": np.array([0.5, 0.6])},
    ... )
    >>> both.force(np.array([[0.1]]), 10.0)
    array([[5., 6.]])
    """
    known = {path: value for path, _, value in parameters(law, "friction")}
    # a whole exponent is part of the equations' shape and would not be replaced
    whole = {path: float(v[0]) * (1.0 + 1e-12) for path, v in table.items() if path not in known}
    return shadow(
        vary(law, "friction", whole), "friction", lambda path: table.get(path, known.get(path))
    )

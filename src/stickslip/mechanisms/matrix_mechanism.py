"""Mechanisms given by their matrices: equations of motion that are known already."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

from typing_extensions import override

from stickslip.maths import Scalar
from stickslip.mechanisms.base import Mechanism


@dataclass(frozen=True, kw_only=True)
class MatrixMechanism(Mechanism, ABC):
    """A mechanism whose equations ``M(q) q'' = h(t, q, q') - W F`` are known already.

    `mass_matrix` gives M and `forces` all of h: weight, springs, dampers, drives, centrifugal and
    Coriolis terms. The contact names the coordinate along which friction F acts (W). Its normal
    coordinate, and others that are held at 0, have a row of M and a force too, from which their
    reactions follow.

    `potential_energy` serves the energy balance only, by which the certificate of a run is judged.
    Nothing is derived from it, so it must fit the forces.

    Examples
    --------
    >>> from stickslip import Coulomb, MatrixMechanism, simulate
    >>> from stickslip.mechanisms import Contact
    >>> class Sledge(MatrixMechanism):
    ...     name, coordinates, rates, units = "sledge", ("x",), ("v",), ("m",)
    ...
    ...     def mass_matrix(self, q):
    ...         return [[2.0], [0.0]]  # rows of x and of y, which the ground holds
    ...
    ...     def forces(self, t, q, q_dot, drives):
    ...         return {"y": -2.0 * 9.81}
    ...
    ...     def potential_energy(self, t, q):
    ...         return 2.0 * 9.81 * q["y"]
    ...
    ...     def contacts(self):
    ...         return (Contact(slip="x", normal="y"),)
    ...
    ...     def drives(self):
    ...         return {}
    >>> run = simulate(Sledge(), Coulomb(kinetic_coefficient=0.1), t_end=5.0, y0={"v": 1.962})
    >>> round(float(run["x"][-1]), 9)  # v^2 / (2 mu g)
    1.962
    """

    @abstractmethod
    def mass_matrix(self, q: Mapping[str, Scalar]) -> Sequence[Sequence[Scalar]]:
        """Return the rows of the mass matrix: one for each coordinate, then one for each held one.

        Each row has one number for each coordinate, in their order. The first of the held ones is
        the contact's normal coordinate if it has one, the others are those of `held`.

        Parameters
        ----------
        q : mapping
            Coordinates by name.
        """

    def power(
        self,
        t: Scalar,  # noqa: ARG002
        q: Mapping[str, Scalar],  # noqa: ARG002
        q_dot: Mapping[str, Scalar],  # noqa: ARG002
        drives: Mapping[str, Scalar],  # noqa: ARG002
    ) -> Scalar | None:
        """Return the power [W] that drives put in and dampers take out, or None.

        With it, a run whose forces do not fit its energies is not certified. With None, it is taken
        from the forces themselves, and the certificate speaks of the integration alone.

        Parameters
        ----------
        t : float or array
            Time [s].
        q : mapping of str to float or array
            Coordinates by name, held ones included.
        q_dot : mapping of str to float or array
            Their rates, by name of the coordinate.
        drives : mapping of str to float or array
            Present values of the drives by name.

        Returns
        -------
        float or array or None
            Power supplied [W].
        """
        return None

    @final
    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        rates = [q_dot[name] for name in self.coordinates]
        rows = self.mass_matrix(q)[: len(rates)]
        momenta = [sum((m * rate for m, rate in zip(row, rates, strict=True)), 0.0) for row in rows]
        return 0.5 * sum((p * rate for p, rate in zip(momenta, rates, strict=True)), 0.0)

"""The equations of motion of a mechanism as numbers: M, h, the directions of friction and drive."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

from stickslip.control.actuation import place_of
from stickslip.drives import Sampled
from stickslip.errors import InputError, UnknownNameError
from stickslip.friction import Viscous
from stickslip.mechanisms import Mechanism, normal_of, slip_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Dynamics", "Evaluator", "dynamics_at"]

ROUNDING = 1e-12
"""Share of the largest that is none in the direction of a drive."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Dynamics:
    """A mechanism at one moment: ``M a = h - W F + B u`` and ``N = N_0 + N_F F + N_u u``.

    F is the friction force at the contact, u the command; all else that acts is in h and N_0.
    """

    coordinates: tuple[str, ...]
    """Names in the order of rows."""
    mass: "NDArray[np.float64]"
    """Mass matrix M (n, n)."""
    forces: "NDArray[np.float64]"
    """Forces h (n,), among them those of drives that are not commanded."""
    friction_direction: "NDArray[np.float64]"
    """W (n,): 1 at the coordinate that slips."""
    command_direction: "NDArray[np.float64]"
    """B (n,), zeros where nothing is commanded."""
    normal: float
    """Normal force N_0 without friction and command [N]."""
    normal_by_friction: float
    """N_F."""
    normal_by_command: float
    """N_u."""

    def accelerations(self, friction: float = 0.0, command: float = 0.0) -> "NDArray[np.float64]":
        """Return the accelerations (n,) under a friction force and a command.

        Parameters
        ----------
        friction : float, default 0.0
            Friction force, with the sign of the slip velocity [N].
        command : float, default 0.0
            Value of the commanded drive, in its unit.

        Returns
        -------
        array (n,)
            Accelerations of the free coordinates [unit of the coordinate / s^2].
        """
        import numpy as np

        right = self.forces - self.friction_direction * friction + self.command_direction * command
        return np.asarray(np.linalg.solve(self.mass, right))

    def normal_force(self, friction: float = 0.0, command: float = 0.0) -> float:
        """Return the normal force under a friction force and a command [N].

        Parameters
        ----------
        friction : float, default 0.0
            Friction force, with the sign of the slip velocity [N].
        command : float, default 0.0
            Value of the commanded drive, in its unit.

        Returns
        -------
        float
            Normal force of the contact [N].
        """
        return self.normal + self.normal_by_friction * friction + self.normal_by_command * command


@final
class Evaluator:
    """Evaluates accelerations and normal force of a mechanism, affine in friction and command."""

    def __init__(self, mechanism: Mechanism, drive: str | None = None) -> None:
        """Derive the equations; `drive` names what is commanded, as in `closed_loop`.

        Parameters
        ----------
        mechanism : Mechanism
            Mechanism without prescribed motions.
        drive : str, optional
            Name of the drive that is commanded; the only one if not given.

        Raises
        ------
        InputError
            If the mechanism has a prescribed motion.
        """
        from stickslip.formulation import formulate
        from stickslip.kernels.state_layout import NUMBERS
        from stickslip.solver import Equations, gather

        if mechanism.guided():
            raise InputError(
                f"{type(mechanism).__name__} has a prescribed motion, whose effort is an output:"
                " give it a torque or a force instead."
            )
        none = Sampled(times=(0.0,), values=(0.0,))
        mechanism, name = place_of(mechanism, drive).commanded(mechanism, none)
        law = Viscous(viscous_coefficient=0.0)  # friction is given; any law will do
        model = formulate(mechanism, law)
        self.mechanism = mechanism
        self.slip = mechanism.coordinates.index(slip_of(mechanism))
        self._equations = Equations(model, gather(mechanism, law, model, 0.0))
        self._place = NUMBERS + 3 * model.drives.index(name)

    def __call__(self, t: float, state: Sequence[float]) -> Any:
        """Return accelerations and normal force (3, n + 1): free, by friction, by command.

        Row 0 is what is without both; the others are what a unit of each adds.
        """
        import numpy as np

        rows = [self._at(t, state, *unit) for unit in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))]
        found = np.array(rows)
        found[1:] -= found[0]
        return found

    def _at(self, t: float, state: Sequence[float], friction: float, command: float) -> list[Any]:
        equations = self._equations
        equations.load_at(t)
        equations.w[self._place] += command
        n = len(self.mechanism.coordinates)
        return equations("diagram", 0, 0, t, state, (friction,))[: n + 1]


def _states(given: Mapping[str, float], names: Sequence[str]) -> list[float]:
    for name in given:
        if name not in names:
            raise UnknownNameError("state", name, names)
    return [float(given.get(name, 0.0)) for name in names]


def dynamics_at(
    mechanism: Mechanism,
    t: float = 0.0,
    q: Mapping[str, float] | None = None,
    q_dot: Mapping[str, float] | None = None,
    *,
    drive: str | None = None,
) -> Dynamics:
    """Return mass matrix, forces and normal force of a mechanism at a state.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, without prescribed motions.
    t : float
        Time [s], for drives and moved supports.
    q : mapping, optional
        Coordinates by name; 0 where not given.
    q_dot : mapping, optional
        Their rates, by the names of the rates.
    drive : str, optional
        What is commanded, as in `closed_loop`.

    Returns
    -------
    Dynamics
        The numbers, by which laws of control are written.

    Raises
    ------
    InputError
        If the mechanism has a prescribed motion or nothing to command.

    Examples
    --------
    >>> from stickslip import PendulumCart
    >>> cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    >>> here = dynamics_at(cart, q={"theta": 0.0})
    >>> here.mass.round(12)
    array([[ 0.6  , -0.03 ],
           [-0.03 ,  0.009]])
    >>> round(here.normal_force(), 9)
    5.886
    """
    import numpy as np

    evaluator = Evaluator(mechanism, drive)
    state = _states(q or {}, mechanism.coordinates)
    state += _states(q_dot or {}, mechanism.rates)
    table = evaluator(t, state)
    n = len(mechanism.coordinates)
    mass = _mass(mechanism, state[:n])
    free, driven = mass @ table[0, :n], mass @ table[2, :n]
    return Dynamics(
        coordinates=mechanism.coordinates,
        mass=mass,
        forces=free,
        friction_direction=np.eye(n)[evaluator.slip],
        command_direction=np.where(np.abs(driven) > ROUNDING * np.abs(driven).max(), driven, 0.0),
        normal=float(table[0, n]),
        normal_by_friction=float(table[1, n]),
        normal_by_command=float(table[2, n]),
    )


def _mass(mechanism: Mechanism, places: Sequence[float]) -> Any:
    """Return the mass matrix: the second differences of the kinetic energy, which is quadratic."""
    import numpy as np

    normal = normal_of(mechanism)
    held = (*([] if normal is None else [normal]), *mechanism.held())
    q = {**dict(zip(mechanism.coordinates, places, strict=True)), **dict.fromkeys(held, 0.0)}
    still = dict.fromkeys(q, 0.0)

    def energy(*moving: str) -> float:
        rates = {name: still[name] + moving.count(name) for name in q}
        return float(mechanism.kinetic_energy(q, rates))

    names = mechanism.coordinates
    return np.array([[energy(i, j) - energy(i) - energy(j) for j in names] for i in names])

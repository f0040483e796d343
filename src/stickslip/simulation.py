"""Joins a mechanism, a law and a solver."""

from collections.abc import Mapping, Sequence

from stickslip.errors import InputError, SimulationError, UnknownNameError
from stickslip.friction import BristleLaw, FrictionLaw, PrintedForm
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.solver import EventDriven, Solver
from stickslip.trajectory import Trajectory

__all__ = ["simulate"]


def simulate(
    mechanism: Mechanism,
    law: FrictionLaw | PrintedForm,
    *,
    t_end: float,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    solver: Solver | None = None,
    throw: bool = True,
) -> Trajectory:
    """Simulate a mechanism with a friction law from time 0 on.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw or PrintedForm
        What holds it back; printed forms need ``solver=FixedStep(...)``.
    t_end : float
        Last time [s].
    y0 : mapping or sequence, optional
        Initial states by name (the others 0), or all of them in order. Rest at 0 if not given.
    solver : Solver, optional
        `EventDriven` if not given, or `FixedStep`.
    throw : bool
        Raise if the run ends early or is not certified; otherwise look at ``status`` and
        ``certificate``. Fixed steps are never certified and only raise if they end early.

    Returns
    -------
    Trajectory
        States, friction, events, status and certificate.

    Raises
    ------
    InputError
        If an argument cannot be used.
    SimulationError
        If the run ends early or is not certified, and `throw` is true.

    Examples
    --------
    >>> from stickslip import Coulomb, Pulse, SpringBlock
    >>> block = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    >>> run = simulate(block, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> round(float(run["x"][-1]), 7)
    0.1538736
    """
    if not isinstance(mechanism, Mechanism):
        raise InputError(f"mechanism must be a Mechanism such as SpringBlock, got {mechanism!r}.")
    if not isinstance(law, (FrictionLaw, PrintedForm)):
        raise InputError(f"law must be a friction law such as Coulomb, got {law!r}.")
    last = Quantity("T", "s", above=0).check("simulate", "t_end", t_end)
    start = _initial_state(mechanism, law, y0)
    solver = EventDriven() if solver is None else solver
    if not isinstance(solver, Solver):
        raise InputError(f"solver must be an EventDriven(...) or FixedStep(...), got {solver!r}.")
    run = solver.run(mechanism, law, y0=start, t_end=last)
    if throw and not run.status.complete:
        raise SimulationError(f"{run.status.value} It ended at t = {run.span[1]:g} s.")
    if throw and isinstance(solver, EventDriven) and not run.certificate.certified:
        raise SimulationError("The run is not certified: " + "; ".join(run.certificate.problems))
    return run


def _initial_state(
    mechanism: Mechanism,
    law: FrictionLaw | PrintedForm,
    y0: Mapping[str, float] | Sequence[float] | None,
) -> list[float]:
    """Return the initial state in order, checked."""
    bristles = law.bristles if isinstance(law, (BristleLaw, PrintedForm)) else ()
    names = (*mechanism.coordinates, *mechanism.rates, *bristles)
    if y0 is None:
        return [0.0] * len(names)
    if isinstance(y0, Mapping):
        for name in y0:
            if name not in names:
                raise UnknownNameError("state in y0", name, names)
        y0 = [y0.get(name, 0.0) for name in names]
    if not hasattr(y0, "__len__"):
        raise InputError(f"y0 must be a mapping of names or a sequence, got {y0!r}.")
    if len(y0) != len(names):
        raise InputError(f"y0 must have {len(names)} values ({', '.join(names)}), got {len(y0)}.")
    return [
        Quantity(name).check("simulate", f"y0[{name!r}]", value)
        for name, value in zip(names, y0, strict=True)
    ]

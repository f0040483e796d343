"""Joins a mechanism, a law and a solver."""

import functools
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias, cast

from stickslip.engine.solver import EventDriven, Output, Solver, run_ensemble
from stickslip.engine.trajectory import Ensemble, Status, Trajectory
from stickslip.errors import InputError, SimulationError, UnknownNameError
from stickslip.friction import (
    FrictionLaw,
    Laws,
    PrintedForm,
    assigned,
    bristle_names,
    is_bound,
    law_type,
    with_typical_values,
)
from stickslip.mechanisms import Mechanism, checked_contacts, input_names, slip_of
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Quantity, beginning, kept_by_identity
from stickslip.show.formatting import quantity

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from numpy.typing import ArrayLike

ALWAYS = ("friction", "normal_force", "mode")
"""Columns that every run has beside its states."""
END = Quantity("T", "s", above=0)
USUAL = EventDriven()
"""Settings of a single run, if none are given."""
OneLaw: TypeAlias = FrictionLaw | type[FrictionLaw] | str
GivenFriction: TypeAlias = OneLaw | Mapping[str, OneLaw | None] | Laws
"""A law, its type or its name, for all contacts or by the name of the contact."""

__all__ = [
    "END",
    "GivenFriction",
    "OneLaw",
    "beginning_pair",
    "check_pair",
    "ensemble",
    "event_driven_law",
    "initial_state",
    "no_law",
    "no_mechanism",
    "own_law",
    "refuse",
    "simulate",
]


def __dir__() -> list[str]:
    return sorted(__all__)


def simulate(
    mechanism: Mechanism,
    law: GivenFriction | PrintedForm,
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
    law : FrictionLaw, type or str, mapping of str to these, or PrintedForm
        What holds it back; a type or a name, such as ``"coulomb"``, has the typical values of the
        law. Where several contacts rub, the law of each by the contact's name, None where there is
        none, or one law that all share. Printed forms need ``solver=FixedStep(...)``.
    t_end : float
        Last time [s].
    y0 : mapping or sequence, optional
        Initial states by name, or all of them in order. What is not given is 0, or where the
        mechanism says that it begins (a swing at the start of its profile).
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
    >>> from stickslip import Coulomb, SpringBlock
    >>> from stickslip.mechanisms.drives import Pulse
    >>> block = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    >>> run = simulate(block, Coulomb(kinetic_coefficient=0.25), t_end=1.0)
    >>> round(float(run["x"][-1]), 7)
    0.1538736
    """
    laws = check_pair(mechanism, law)
    last = END.check("simulate", "t_end", t_end)
    start = initial_state("simulate", mechanism, laws, y0)
    # Made once: `EventDriven()` checks its settings, which a short run would feel.
    solver = USUAL if solver is None else solver
    if not isinstance(solver, Solver):
        raise InputError(f"solver must be an EventDriven(...) or FixedStep(...), got {solver!r}.")
    told = _told(mechanism, y0)
    run = solver.run(mechanism, laws, y0=start, t_end=last, told=told)
    if throw:
        # Fixed steps certify nothing, and are asked for nevertheless.
        refuse(run, certified=isinstance(solver, EventDriven))
    return run


def refuse(run: Trajectory, *, certified: bool = True) -> None:
    """Raise if a run ended early, or is not certified where it should be, as `simulate` does.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> refuse(simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0, throw=False))
    """
    if not run.status.complete:
        raise SimulationError(
            f"{run.ending}{_numbers(run)} The run ended at t = {quantity(run.span[1], 's', 6)}."
        )
    if certified and not run.certificate.certified:
        raise SimulationError("The run is not certified: " + "; ".join(run.certificate.problems))


def ensemble(
    mechanism: Mechanism,
    law: GivenFriction,
    parameters: Mapping[str, "ArrayLike"],
    *,
    t_end: float,
    outputs: Sequence[str] | Mapping[str, Output] | None = None,
    y0: Mapping[str, float] | Sequence[float] | None = None,
    solver: EventDriven | None = None,
    executor: "Executor | None" = None,
    progress: Callable[[int, int], object] | None = None,
) -> Ensemble:
    """Simulate a mechanism with a friction law many times, with other numbers each time.

    The runs are compiled (a first call waits for that) and spread over all cores. They are the
    runs that `simulate` makes, and do not depend on the number of threads.

    Parameters
    ----------
    mechanism : Mechanism
        What moves.
    law : FrictionLaw, type or str, or mapping of str to these
        What holds it back, as in `simulate`.
    parameters : mapping
        What varies: arrays (n,), or numbers for all runs, by path, such as
        ``"friction.kinetic_coefficient"``, ``"mechanism.drive.level"`` or ``"initial.x"``; the last
        name, or the symbol, alone will do where only one has it.
    t_end : float
        Last time of every run [s].
    outputs : sequence of str or mapping, optional
        States whose final values are kept, or `Final`, `Max`, `Min`, `Mean`, `Samples`,
        `EventTimes`, `EventCount` and `Sensitivity` by name. The final values of all states if not
        given.
    y0 : mapping or sequence, optional
        Initial states that do not vary, as in `simulate`.
    solver : EventDriven, optional
        Tolerances, limits and tier; compiled if not given.
    executor : concurrent.futures.Executor, optional
        Where chunks of runs are executed; threads for all cores if not given. Anything with its
        ``submit`` will do whose futures are those of `concurrent.futures`.
    progress : callable, optional
        Called with the number of runs done and of all runs after each chunk. If it returns False,
        no further chunks begin; runs that were not made are `Status.CANCELLED`.

    Returns
    -------
    Ensemble
        Outputs, status and certificate of each run.

    Raises
    ------
    InputError
        If an argument cannot be used. A run that ends early raises nothing: see its status.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Coulomb, SpringBlock
    >>> from stickslip.mechanisms.drives import Pulse
    >>> from stickslip.engine import EventTimes, Max
    >>> block = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    >>> runs = ensemble(
    ...     block,
    ...     Coulomb(kinetic_coefficient=0.25),
    ...     {"mechanism.drive.level": np.linspace(5.0, 10.0, 3)},
    ...     t_end=2.0,
    ...     outputs={"fastest": Max("v"), "rest": EventTimes("stop")},
    ... )
    >>> runs["fastest"].round(3), runs["rest"][:, 0].round(3)
    (array([0.255, 0.505, 0.755]), array([0.204, 0.306, 0.408]))
    """
    mechanism, laws = beginning_pair(mechanism, event_driven_law(mechanism, law), parameters)
    solver = EventDriven(tier="compiled") if solver is None else solver
    if not isinstance(solver, EventDriven):
        raise InputError(f"solver must be an EventDriven(...), got {solver!r}.")
    if solver.estimate_error:
        raise InputError("ensembles make no error estimate: use simulate for single runs.")
    last = END.check("ensemble", "t_end", t_end)
    start = initial_state("ensemble", mechanism, laws, y0)
    return run_ensemble(
        mechanism,
        laws,
        parameters,
        y0=start,
        told=_told(mechanism, y0),
        t_end=last,
        outputs=outputs,
        solver=solver,
        executor=executor,
        progress=progress,
    )


def beginning_pair(
    mechanism: Mechanism, law: FrictionLaw | Laws, varied: object
) -> tuple[Mechanism, FrictionLaw | Laws]:
    """Return mechanism and law with first values of what varies and was not given, if any."""
    if not isinstance(varied, Mapping):
        return mechanism, law
    states = (*mechanism.coordinates, *mechanism.rates)
    # States have initial values, whose paths must not be taken for parameters that lack one.
    known = {f"initial.{name}": Quantity(name) for name in states}
    roots = beginning({"mechanism": mechanism, "friction": law}, varied, known)
    return cast("Mechanism", roots["mechanism"]), cast("FrictionLaw | Laws", roots["friction"])


def _numbers(run: Trajectory) -> str:
    """Return what a run ended with in view of its limits: which one, and the efforts then."""
    if run.status is not Status.LIMIT:
        return ""
    last = run.at([run.span[1]])
    kinds = {name: name.partition(":")[0] for name in run.names if name not in run.states}
    shown = {name: name for name, kind in kinds.items() if kind not in ALWAYS}
    for name in (name for name, kind in kinds.items() if kind == "normal_force"):
        contact = name.partition(":")[2]
        shown[name] = f"normal force of {contact}" if contact else "normal force"
    values = [
        f"{word} {quantity(last[name][0], run.units[name], 4)}" for name, word in shown.items()
    ]
    return f" Limit: {run.events[-1].reason} ({', '.join(values)})."


def no_mechanism(given: object) -> InputError:
    """Return the error of what was given as a mechanism and is none."""
    return InputError(f"mechanism must be a Mechanism such as SpringBlock, got {given!r}.")


def no_law(given: object) -> InputError:
    """Return the error of what was given as a law and is none."""
    return InputError(f"law must be a friction law such as Coulomb, or its name, got {given!r}.")


@kept_by_identity
def check_pair(mechanism: object, law: object) -> "FrictionLaw | Laws | PrintedForm":
    """Return the law, or the laws by contact; refuse what is no mechanism or no law."""
    if not isinstance(mechanism, Mechanism):
        raise no_mechanism(mechanism)
    if isinstance(law, Mapping):
        law = {
            contact: None if item is None else _with_values(item) for contact, item in law.items()
        }
    elif not isinstance(law, PrintedForm | Laws):
        law = _with_values(law)
    names = tuple(contact.name for contact in checked_contacts(mechanism))
    if not names:
        raise InputError(f"{type(mechanism).__name__} has no contacts: it must rub somewhere.")
    # Laws by contact, columns and paths go by the names.
    if len(names) > 1 and (len(set(names)) < len(names) or "" in names):
        raise InputError(
            f"{type(mechanism).__name__} has {len(names)} contacts, which need different names, got"
            f" {', '.join(map(repr, names))}."
        )
    if isinstance(law, PrintedForm):
        return law
    # The only contact may be without a name: its law stands alone.
    if names == ("",) and isinstance(law, Mapping) and set(law) != {""}:
        raise InputError(
            f"{type(mechanism).__name__} has one contact, which has no name: give its law alone,"
            f" got {law!r}."
        )
    result = assigned(names, law)
    own = dict(result.members) if isinstance(result, Laws) else dict.fromkeys(names, result)
    for contact, member in own.items():
        _check_inputs(mechanism, contact, member)
    return result


def _with_values(given: object) -> FrictionLaw:
    """Return a law, of a type or a name with its typical values; refuse what is no law."""
    if isinstance(given, FrictionLaw):
        return given
    kind = law_type(given) if isinstance(given, str) else given
    if not (isinstance(kind, type) and issubclass(kind, FrictionLaw)):
        raise no_law(given)
    result = with_typical_values(kind)
    if result is None:
        raise InputError(
            f"the law {kind.name} has no typical values: give it with values, such as"
            f' law("{kind.name}")(...) of stickslip.friction.'
        )
    return result


def _check_inputs(mechanism: Mechanism, contact: str, law: FrictionLaw) -> None:
    """Refuse a law that asks for a contact input which nothing tells."""
    if law.inputs and is_bound(law):
        raise InputError(
            f"the friction law {law.name} is bound to {', '.join(law.inputs)}, but in a run the"
            " mechanism tells what changes: give the law as it was before, and values to"
            " given_inputs(mechanism, {...})."
        )
    known = input_names(mechanism, contact) if law.inputs else ()
    for name in law.inputs:
        if name not in known:
            where = f"{type(mechanism).__name__}" + (f" at {contact!r}" if contact else "")
            unit = CONTACT_INPUTS[name].unit if name in CONTACT_INPUTS else "1"
            raise InputError(
                f"the friction law {law.name} depends on the contact input {name!r}, which {where}"
                f" does not tell; it tells {', '.join(known) or 'none'}. Give it in the rig file,"
                f' as {name} = "1 {unit}" under [contact], in Python as given_inputs(mechanism,'
                f" {{{name!r}: 1.0}}), where a drive may stand for the number; or give a law"
                " without it."
            )


def own_law(mechanism: object, law: object) -> FrictionLaw:
    """Return the law of a mechanism that has one contact, for what takes no others."""
    result = event_driven_law(mechanism, law)
    assert isinstance(mechanism, Mechanism)  # as was checked
    slip_of(mechanism)
    assert isinstance(result, FrictionLaw)  # of one contact
    return result


def event_driven_law(mechanism: object, law: object) -> FrictionLaw | Laws:
    """Return the law, or the laws by contact, for what takes no fixed steps."""
    result = check_pair(mechanism, law)
    if isinstance(result, PrintedForm):
        raise InputError(
            f"this runs with EventDriven only, which cannot solve {law!r}: give another law, or"
            " run it alone with FixedStep(...)."
        )
    return result


def _told(
    mechanism: Mechanism, y0: Mapping[str, float] | Sequence[float] | None
) -> tuple[str, ...]:
    """Return the states that begin where the mechanism says, since nothing else was said."""
    # A sequence tells all states, a mapping those that it names.
    if y0 is not None and not isinstance(y0, Mapping):
        return ()
    return tuple(state for state in mechanism.start() if state not in (y0 or {}))


def initial_state(
    owner: str,
    mechanism: Mechanism,
    law: FrictionLaw | Laws | PrintedForm,
    y0: Mapping[str, float] | Sequence[float] | None,
) -> list[float]:
    """Return the initial state in order, checked."""
    states = _states(mechanism, law)
    names = tuple(states)
    if y0 is None:
        y0 = {}
    if isinstance(y0, Mapping):
        for name in y0:
            if name not in names:
                raise UnknownNameError("state in y0", name, names)
        begin = {**mechanism.start(), **y0}
        if not begin:
            return [0.0] * len(names)
        y0 = [begin.get(name, 0.0) for name in names]
    if not hasattr(y0, "__len__"):
        raise InputError(f"y0 must be a mapping by state name or a sequence, got {y0!r}.")
    if len(y0) != len(names):
        raise InputError(f"y0 must have {len(names)} values ({', '.join(names)}), got {len(y0)}.")
    return [
        state.check(owner, f"y0[{state.symbol!r}]", value)
        for state, value in zip(states.values(), y0, strict=True)
    ]


@kept_by_identity
def _states(mechanism: Mechanism, law: FrictionLaw | Laws | PrintedForm) -> dict[str, Quantity]:
    """Return the states by name, in their order."""
    if isinstance(law, PrintedForm):
        bristles = law.states
    else:
        bristles = bristle_names(tuple(contact.name for contact in mechanism.contacts()), law)
    names = (*mechanism.coordinates, *mechanism.rates, *bristles)
    return {name: _state(name) for name in names}


_state = functools.lru_cache(maxsize=256)(Quantity)

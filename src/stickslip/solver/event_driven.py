"""The event-driven solver: exact switching between stick and slip."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import InputError, ParameterError
from stickslip.formatting import number
from stickslip.formulation import PAINLEVE, Model, formulate, mass_fault, mass_vanishes
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.kernels import state_layout
from stickslip.kernels.batch import happened
from stickslip.kernels.state_layout import EVENT_COLUMNS, EVENTS, STATUS, STEPS
from stickslip.mechanisms import MatrixMechanism, Mechanism
from stickslip.quantities import Quantity
from stickslip.solver.base import Solver, column_units, name_of_only_contact
from stickslip.solver.certify import certify, driving
from stickslip.solver.dense_output import Playback
from stickslip.solver.drive_schedule import Inputs, gather
from stickslip.solver.initial_states import within_stops
from stickslip.solver.reducers import reasons
from stickslip.solver.run import Record, Tier, execute
from stickslip.solver.sensitivities import Sensing
from stickslip.solver.step_limits import cause_of_small_steps, cause_of_step_limit, cause_of_zeno
from stickslip.trajectory import Certificate, Event, Status, Trajectory

_STATUS = {
    state_layout.END_TIME: Status.END_TIME,
    state_layout.AT_REST: Status.AT_REST,
    state_layout.LIFTED_OFF: Status.LIFT_OFF,
    state_layout.STEP_LIMIT: Status.STEP_LIMIT,
    state_layout.STEP_TOO_SMALL: Status.STEP_TOO_SMALL,
    state_layout.ZENO: Status.ZENO,
}


def status_of(code: int, model: Model) -> Status:
    """Return how a run ended, from the kernels' code."""
    if code < state_layout.LIMITED:
        return _STATUS.get(code, Status.CANCELLED)
    limits = model.limits[code - state_layout.LIMITED :]
    return Status.LIMIT if limits and limits[0] != PAINLEVE else Status.PAINLEVE


PLACES = 200
"""Places of a run at which a mass matrix that was given is looked at."""
SMOOTH_TOLERANCE, BRISTLE_TOLERANCE = 1e-12, 1e-8
"""Tolerances that hold if none is given: without bristles, and with them, whose steps cost more."""
TIGHTEST = 1e-13
"""Least tolerance: rounding is not far below it."""


@final
@dataclass(frozen=True, kw_only=True)
class EventDriven(Solver):
    """Integrates each mode with its own smooth equations and locates every change of mode.

    Linear modes are propagated by their exact series, other smooth modes take DOP853 steps, modes
    with bristles and stiff ones Rodas5P steps. Errors are judged against the largest value each
    state has had, so any scale of units serves.

    Examples
    --------
    >>> from stickslip import Coulomb, SpringBlock, simulate
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> run = simulate(
    ...     rig, Coulomb(kinetic_coefficient=0.25), t_end=1.0, solver=EventDriven(tolerance=1e-6)
    ... )
    >>> bool(abs(run["x"][-1] - 0.2038736) < 1e-6)
    True
    """

    tolerance: Annotated[float, Quantity("rtol", low=TIGHTEST, high=1e-2)] | None = None
    """Local error of a step over the largest value so far. If it is not given, 1e-12 with laws
    without bristles and 1e-8 with others."""
    stiff_tolerance: Annotated[float, Quantity("rtol", low=TIGHTEST, high=1e-2)] | None = None
    """The same with bristles, where one solver runs laws of both kinds; `tolerance` if not
    given."""
    max_steps: Annotated[float, Quantity("n", low=1)] = 1_000_000
    """Steps after which a run is given up: ``Trajectory.cause`` then says what made them short."""
    estimate_error: bool = False
    """Whether to run once more with half the tolerance, and to put the difference into the
    certificate: errors that the tolerance controls are of its size."""
    tier: Tier = "auto"
    """``"python"`` runs at once; ``"compiled"`` compiles, which takes some seconds the first time
    on a machine and a tenth of a second for further equations, and is then a hundred times faster;
    ``"auto"`` takes what this process has compiled already, and compiles once plain runs have taken
    twice as long as that would."""

    @override
    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.tier not in ("auto", "python", "compiled"):
            raise ParameterError(
                f"EventDriven.tier must be 'auto', 'python' or 'compiled', got {self.tier!r}."
            )

    def tolerance_for(self, law: FrictionLaw | Laws) -> float:
        """Return the tolerance that holds for a law, or for several."""
        laws = [one for _, one in law.members] if isinstance(law, Laws) else [law]
        if not any(one.states for one in laws):
            return SMOOTH_TOLERANCE if self.tolerance is None else self.tolerance
        given = (one for one in (self.stiff_tolerance, self.tolerance) if one is not None)
        return next(given, BRISTLE_TOLERANCE)

    @override
    def run(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws | PrintedForm,
        *,
        y0: Sequence[float],
        t_end: float,
        told: Sequence[str] = (),
    ) -> Trajectory:
        if isinstance(law, PrintedForm):
            raise InputError(
                f"{type(law).__name__} is eq. {law.equation} as printed, which has no exact"
                " event-driven solution: run it with solver=FixedStep(...), or use the corrected"
                f" law {law.corrected.__name__}."
            )
        model = formulate(mechanism, law)
        inputs, record = self._executed(mechanism, law, model, y0, t_end)
        tolerance = self.tolerance_for(law)
        run = trajectory_of(mechanism, law, model, inputs, record, tolerance, t_end, told)
        if not self.estimate_error:
            return run
        half = max(0.5 * tolerance, TIGHTEST)
        finer = replace(self, tolerance=half, stiff_tolerance=None, estimate_error=False)
        other = finer.run(mechanism, law, y0=y0, t_end=t_end)
        error = _difference(run, other)
        return replace(run, certificate=replace(run.certificate, error_estimate=error))

    def bare(
        self, mechanism: Mechanism, law: FrictionLaw | Laws, *, y0: Sequence[float], t_end: float
    ) -> "BareRun":
        """Run without a certificate, for searches, which make runs by the thousand.

        Parameters
        ----------
        mechanism : Mechanism
            What moves.
        law : FrictionLaw
            Friction of its contact.
        y0 : sequence of float
            State at time 0: coordinates, rates, bristles [SI].
        t_end : float
            Last time [s].

        Returns
        -------
        BareRun
            Status, states and sensitivities of the run.
        """
        model = formulate(mechanism, law)
        inputs, record = self._executed(mechanism, law, model, y0, t_end)
        return bare_run(mechanism, law, model, inputs, record, t_end)

    def _executed(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws,
        model: Model,
        y0: Sequence[float],
        t_end: float,
    ) -> tuple[Inputs, Record]:
        """Return the numbers of a run, and what the kernels wrote down of it."""
        inputs = gather(mechanism, law, model, t_end)
        record = execute(
            model,
            inputs,
            within_stops(mechanism, y0),
            t_end=t_end,
            tolerance=self.tolerance_for(law),
            limit=int(self.max_steps),
            tier=self.tier,
        )
        return inputs, record


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class BareRun:
    """States, sensitivities and events of a run, without its certificate."""

    states: tuple[str, ...]
    """Names of the states."""
    status: Status
    """How the run ended."""
    playback: Playback
    """Its record."""
    differentiate: Sensing
    """Gives the sensitivities (n, states, paths) at an array of times."""

    def at(self, t: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the states (n, states) at times (n,)."""
        return self.playback.played(t)[0]

    def events(self) -> tuple[Event, ...]:
        """Return what happened, in the order of time."""
        sensing = self.differentiate
        return _events(sensing.mechanism, self.playback.model, sensing.record)


def bare_run(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    inputs: Inputs,
    record: Record,
    t_end: float,
) -> BareRun:
    """Wrap what the kernels recorded, without a certificate."""
    whole = record.whole
    return BareRun(
        states=model.states,
        status=status_of(whole[STATUS], model),
        playback=Playback.from_log(model, record.runner, inputs, record.log, whole[STEPS]),
        differentiate=Sensing(mechanism, law, inputs, record, t_end, ()),
    )


def _difference(run: Trajectory, other: Trajectory) -> float:
    """Return the largest difference of a state, over its largest value, between two runs."""
    last = min(run.span[1], other.span[1])
    times = run.t[run.t <= last]
    one, two = run.at(times), other.at(times)
    worst = 0.0
    for name in run.states:
        size = float(np.abs(one[name]).max())
        error = float(np.abs(one[name] - two[name]).max())
        worst = max(worst, error / size if size > 0.0 else error)
    return worst


def trajectory_of(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    inputs: Inputs,
    record: Record,
    tolerance: float,
    t_end: float,
    told: Sequence[str] = (),
) -> Trajectory:
    """Wrap what the kernels recorded."""
    whole = record.whole
    playback = Playback.from_log(model, record.runner, inputs, record.log, whole[STEPS])
    status, cause = status_of(whole[STATUS], model), ""
    if status is Status.STEP_LIMIT:
        cause = cause_of_step_limit(mechanism, law, model, inputs, record, t_end)
    elif status is Status.STEP_TOO_SMALL:
        cause = _cause_of_vanishing_mass(mechanism, playback)
        cause = cause or cause_of_small_steps(mechanism, law, model, inputs, record)
    certificate = certify(playback, record.w, whole, tolerance)
    driven = driving(mechanism, law, playback, certificate)
    certificate = replace(certificate, warnings=(*certificate.warnings, *driven))
    events = _events(mechanism, model, record)
    if status is Status.ZENO:
        cause = cause_of_zeno(events, playback.span()[1])
    return Trajectory(
        t=playback.times(),
        names=(*model.states, *model.columns, *(() if model.contacts else ("mode",))),
        units=column_units(mechanism, _others(mechanism, model)),
        events=events,
        status=status,
        cause=cause,
        certificate=_with_masses(mechanism, playback, certificate),
        span=playback.span(),
        evaluate=playback,
        states=model.states,
        differentiate=Sensing(mechanism, law, inputs, record, t_end, tuple(told)),
        only_contact=name_of_only_contact(mechanism),
    )


def _with_masses(mechanism: Mechanism, playback: Playback, certificate: Certificate) -> Certificate:
    """Return a certificate that also knows whether matrices given were masses all along the run."""
    if not isinstance(mechanism, MatrixMechanism):
        return certificate
    times = playback.times()
    states = playback.played(times[:: 1 + len(times) // PLACES])[0]
    for state in states[:, : len(mechanism.coordinates)]:
        fault = mass_fault(mechanism, state.tolist())
        if fault:
            return replace(certificate, problems=(*certificate.problems, fault.rstrip(".")))
    return certificate


def _cause_of_vanishing_mass(mechanism: Mechanism, playback: Playback) -> str:
    """Return why steps have become too small where masses that were given have vanished."""
    if not isinstance(mechanism, MatrixMechanism):
        return ""
    n, span = len(mechanism.coordinates), np.array(playback.span())
    start, end = playback.played(span)[0][:, :n].tolist()
    if not mass_vanishes(mechanism, start, end):
        return ""
    at = ", ".join(
        f"{name} = {number(place, 4)} {unit}"
        for name, place, unit in zip(mechanism.coordinates, end, mechanism.units, strict=True)
    )
    return (
        f"{type(mechanism).__name__}.mass_matrix tends to a singular one there, at {at}: a motion"
        " without mass has no acceleration."
    )


def _others(mechanism: Mechanism, model: Model) -> tuple[str, ...]:
    """Return the columns that are no coordinates and no rates."""
    bristles = model.states[2 * len(mechanism.coordinates) :]
    return (*bristles, *model.columns, *(() if model.contacts else ("mode",)))


def _events(
    mechanism: Mechanism,
    model: Model,
    record: Record,
) -> tuple[Event, ...]:
    """Translate the recorded events; switches without a name stay inside."""
    names = reasons(model)
    contacts = model.contacts or tuple(contact.name for contact in mechanism.contacts())
    events = []
    whole = record.whole
    rows = np.asarray(record.events[: EVENT_COLUMNS * whole[EVENTS]]).tolist()
    for i in range(whole[EVENTS]):
        t, before, after, _, _, margin, contact = rows[EVENT_COLUMNS * i : EVENT_COLUMNS * (i + 1)]
        reason = names[happened(rows, i, whole)]
        if reason is not None:
            event = Event(
                t=float(t),
                contact=contacts[int(contact)],
                from_mode=int(before),
                to_mode=int(after),
                reason=reason,
                margin=float(margin),
            )
            events.append(event)
    return tuple(events)

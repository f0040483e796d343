"""The event-driven solver: exact switching of stick and slip, and why a run could not go on.

A run, of `EventDriven`:

1. Mechanism and law are traced to equations, once for each structure (`formulation`); what all runs
   of the same objects have in common is kept (`_Pair`).
2. Parameters, and the pieces of the drives, are put into vectors (`starts`).
3. Kernels step from event to event in one of two tiers, which give the same bits (`run`,
   `kernels.driver`), and write down steps and events.
4. The record becomes a trajectory: a playback of its dense output, events in words, and a
   certificate (`certify`).

Where steps came out too small or too many, the cause is sought in the fastest motion: the
eigenvalue l of largest size of the Jacobian J at the end of the run, by central differences, in the
modes at hand or with all that is held slipping. With right and left vectors r and s, s r = 1, a
parameter p enters its time scale 1 / |l| with the power

    d ln(1 / |l|) / d ln p = -Re(s (p dJ/dp) r / l),

and the parameters with the largest powers are named.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Self

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.formulation import (
    LINKS,
    PAINLEVE,
    Model,
    formulate,
    mass_fault,
    mass_vanishes,
)
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.batch import happened
from stickslip.engine.kernels.equations import PREPARE, RESTORE, ask_here, field, put_constants
from stickslip.engine.solver.backend import Playback, runner_of
from stickslip.engine.solver.certify import Sensing, certify, driving, may_drive
from stickslip.engine.solver.delays import run_delayed
from stickslip.engine.solver.reducers import reasons
from stickslip.engine.solver.run import (
    Record,
    Solver,
    Tier,
    column_units,
    execute,
    path_units,
)
from stickslip.engine.solver.starts import (
    Inputs,
    gather,
    inputs_of,
    numbers_of,
    refuse_turned,
    within_stops,
)
from stickslip.engine.trajectory import Certificate, Event, Status, Trajectory
from stickslip.errors import InputError, ParameterError
from stickslip.friction import FrictionLaw, Laws, PrintedForm
from stickslip.mechanisms import MatrixMechanism, Mechanism, stops_of
from stickslip.mechanisms.drives import is_delayed
from stickslip.quantities import Quantity, kept_by_identity, parameters, unchecked
from stickslip.show.formatting import number, quantity

# Why a run could not go on: its fastest motion, its drives, or its events.

STATE_STEP = 1e-6
"""Change of a state over its size, for differences: between rounding and what is not linear."""
PARAMETER_STEP = 1e-4
"""The same of a parameter; the difference of differences has larger rounding errors."""
MATTERS = 0.1
"""Share of the largest influence on the time scale below which a parameter is not named."""
MOST_NAMED = 3
OFTEN = 0.25
"""Share of the steps that events or pieces of the drives end, from which they are the cause."""


@dataclass(frozen=True)
class FastestMotion:
    """The eigenvalue of largest size of the equations, linearised at a state."""

    time_scale: float
    """One over the size of the eigenvalue [s]."""
    influences: tuple[tuple[str, float], ...]
    """Paths of parameters, and the power with which each enters the time scale, the largest first.
    """


class _Rates:
    """Rates of the states in plain Python, at the end of a run."""

    def __init__(self, model: Model, record: Record) -> None:
        runner = runner_of(model, compiled=False)
        self.iw = list(record.iw)
        self.w: list[Any] = runner.taken_over(record.w)
        self.places = runner.places
        self.n = len(model.states)
        self.first, self.to = self.iw[layout.Y], len(self.w)
        self.w += [0.0] * self.n
        self.y = np.array(self.w[self.first : self.first + self.n])
        reached = np.abs(self.w[self.iw[layout.SCALE] : self.iw[layout.SCALE] + self.n])
        self.sizes = np.maximum(reached, np.abs(self.y))
        # What has never moved is given the largest size: its differences must not be divided by 0.
        self.sizes[self.sizes == 0.0] = self.sizes.max(initial=0.0) or 1.0

    def slip(self) -> None:
        """Let all that is held slip."""
        if self.iw[layout.N_CONTACTS] == 0:
            self.iw[layout.MODE] = self.iw[layout.MODE] or layout.FORWARD
            return
        modes = self.iw[layout.MODES]
        for i in range(modes, modes + self.iw[layout.N_DIRECTIONS]):
            if self.iw[i] == layout.HELD_FAST:
                self.iw[i] = layout.FORWARD

    def prepare(self) -> None:
        """Write what follows from the parameters and modes alone."""
        put_constants(self.w, self.iw)
        if self.iw[layout.N_CONTACTS] > 0:
            ask_here(PREPARE, self.w, self.iw)
            ask_here(RESTORE, self.w, self.iw)

    def at(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the rates (n,) at a state (n,)."""
        self.w[self.first : self.first + self.n] = y.tolist()
        field(self.w[layout.TIME], self.w, self.iw, self.first, self.to)
        return np.array(self.w[self.to : self.to + self.n])

    def along(self, direction: NDArray[Any]) -> NDArray[Any]:
        """Return the Jacobian times a direction (n,), which may be complex."""
        if np.iscomplexobj(direction):
            return self.along(direction.real) + 1j * self.along(direction.imag)
        largest = float((np.abs(direction) / self.sizes).max())
        if largest == 0.0:
            return np.zeros(self.n)
        # A share of the sizes, whatever the length of the direction is.
        step = STATE_STEP / largest
        after, before = self.at(self.y + step * direction), self.at(self.y - step * direction)
        return (after - before) / (2.0 * step)


@np.errstate(all="ignore")  # what is no number has no time scale
def fastest_motion(model: Model, inputs: Inputs, record: Record) -> FastestMotion | None:
    """Return the fastest motion of the equations at the end of a run, in its modes or slipping."""
    rates = _Rates(model, record)
    result = _eigen(rates)
    # what is held has no motion of its own; a step that lets it slip meets that of slipping
    rates.slip()
    slipping = _eigen(rates)
    if result is None or (slipping is not None and abs(slipping[0]) > abs(result[0])):
        result = slipping
    else:
        rates = _Rates(model, record)  # powers are of the modes in which the eigenvalue is
    if result is None:
        return None
    value, right, left = result
    powers = []
    for path, place, number_ in zip(model.parameter_paths, rates.places, inputs.p, strict=True):
        power = _power(rates, place, number_, value, right, left)
        if math.isfinite(power):
            powers.append((path, power))
    powers.sort(key=lambda pair: -abs(pair[1]))
    largest = abs(powers[0][1]) if powers else 0.0
    named = [(path, power) for path, power in powers if abs(power) > MATTERS * largest > 0.0]
    return FastestMotion(1.0 / abs(value), tuple(named))


def _eigen(rates: _Rates) -> tuple[complex, NDArray[Any], NDArray[Any]] | None:
    """Return the largest eigenvalue with its right and left vector, whose product is 1."""
    rates.prepare()
    # States have other units and sizes: scaled by these, differences lose as little of one as of
    # another, and eigenvalues stay what they are.
    columns = [rates.along(rates.sizes[i] * unit) for i, unit in enumerate(np.eye(rates.n))]
    scaled = np.array(columns).T / rates.sizes[:, None]
    if not np.isfinite(scaled).all():
        return None
    values, vectors = np.linalg.eig(scaled)
    at = int(np.argmax(np.abs(values)))
    try:
        # Rows of the inverse of the right vectors are the left ones, with product 1.
        left = np.linalg.inv(vectors)[at]
    except np.linalg.LinAlgError:  # a double eigenvalue with one vector
        left = np.full(rates.n, math.nan)
    if values[at] == 0.0:
        return None
    return complex(values[at]), vectors[:, at] * rates.sizes, left / rates.sizes


def _power(
    rates: _Rates,
    place: int,
    value: float,
    eigenvalue: complex,
    right: NDArray[Any],
    left: NDArray[Any],
) -> float:
    """Return the power with which a parameter enters the time scale."""
    if value == 0.0:  # a relative change leaves it 0
        return 0.0
    sides = []
    for sign in (1.0, -1.0):
        rates.w[place] = value * (1.0 + sign * PARAMETER_STEP)
        rates.prepare()
        sides.append(rates.along(right))
    rates.w[place] = value
    rates.prepare()
    # s (p dJ/dp) r by central differences; p cancels, as the change is relative.
    slope = complex(left @ (sides[0] - sides[1])) / (2.0 * PARAMETER_STEP)
    return -(slope / eigenvalue).real


def cause_of_step_limit(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    inputs: Inputs,
    record: Record,
    t_end: float,
) -> str:
    """Say what makes the steps of a run so short, and what to do."""
    steps, events, pieces = (
        record.iw[place] for place in (layout.STEPS, layout.EVENTS, layout.PIECE)
    )
    t = float(record.w[layout.TIME])
    taken = f"{steps} steps led to {quantity(t, 's', 4)}."
    if t > 0.0:
        needed = number(steps * t_end / t, 2)
        taken = f"{taken[:-1]}; at this rate {quantity(t_end, 's', 4)} take {needed} steps."
    advice = "End the run earlier, or allow more steps with EventDriven(max_steps=...)."
    if events > OFTEN * steps:
        taken += f" {events} of them ended with an event: the contacts keep switching."
    if pieces > OFTEN * steps:
        return f"{taken} The drives have changed their course {pieces} times. {advice}"
    fastest = fastest_motion(model, inputs, record)
    # Steps last a sixth of that scale at most: the shorter of both is the cause.
    if inputs.time_scale < (math.inf if fastest is None else fastest.time_scale):
        scale = quantity(inputs.time_scale, "s", 2)
        return f"{taken} A drive changes within {scale}, and a step takes a sixth of that. {advice}"
    if fastest is None:
        return f"{taken} {advice}"
    scale = quantity(fastest.time_scale, "s", 2)
    text = f"{taken} The fastest motion of the equations has a time scale of {scale}"
    if not fastest.influences:
        return f"{text}. {advice}"
    named = [path for path, _ in fastest.influences[:MOST_NAMED]]
    return (
        f"{text}, set by {_listed(_values(mechanism, law), named)}. Check these values, or leave"
        " that motion out: replace a stiff spring by a rigid joint, leave out a small mass, or"
        f" choose a law without bristles. {advice}"
    )


def cause_of_small_steps(
    mechanism: Mechanism, law: FrictionLaw | Laws, model: Model, inputs: Inputs, record: Record
) -> str:
    """Say what the equations are like where no step is short enough."""
    where = f"That was at {quantity(float(record.w[layout.TIME]), 's', 4)}."
    fastest = fastest_motion(model, inputs, record)
    if fastest is None:
        if _has_negative_mass(model, record):
            return (
                f"{where} The mass matrix is not positive definite there: some motion would have a"
                f" negative kinetic energy. Check masses and moments of inertia. {LINKS}"
            )
        return f"{where} Rates of states there are no finite numbers: check large and small values."
    scale = quantity(fastest.time_scale, "s", 2)
    named = [path for path, _ in fastest.influences[:MOST_NAMED]]
    by = f", set by {_listed(_values(mechanism, law), named)}" if named else ""
    return (
        f"{where} The fastest motion of the equations has a time scale of {scale}{by}, and times"
        f" are told apart to {quantity(math.ulp(float(record.w[layout.TIME])), 's', 2)} there."
    )


def _has_negative_mass(model: Model, record: Record) -> bool:
    """Whether the mass matrix of several contacts, where a run ended, is not positive definite."""
    if record.iw[layout.N_CONTACTS] == 0:
        return False
    rates = _Rates(model, record)
    rates.prepare()
    rates.at(rates.y)
    n, at = rates.iw[layout.N_COORDINATES], rates.iw[layout.MASS]
    masses = np.array(rates.w[at : at + n * n], dtype=float).reshape(n, n)
    return bool(np.isfinite(masses).all() and np.linalg.eigvalsh(masses)[0] <= 0.0)


def cause_of_zeno(events: Sequence[Event], t: float) -> str:
    """Say which events follow one another without time going on."""
    names: list[str] = []
    for event in reversed(events):
        name = f"{event.reason} at {event.contact}" if event.contact else event.reason
        # Only what happened at that very instant counts.
        if event.t != t or len(names) == MOST_NAMED + 1:
            break
        if name not in names:
            names.append(name)
    names = names or ["forces that switch at a threshold (`where`, `abs`)"]
    listed = " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
    return (
        f"At {quantity(t, 's', 4)} these follow one another without end: {listed}. On each side"
        " of such a threshold the forces lead back to it: let them change over a short way instead"
        " of at once."
    )


def _values(mechanism: Mechanism, law: FrictionLaw | Laws) -> dict[str, str]:
    """Return the parameters in words, by path."""
    roots, units = ((mechanism, "mechanism"), (law, "friction")), path_units(mechanism, law)
    return {
        path: f"{path} = {quantity(value, units[path], 3)}"
        for root, prefix in roots
        for path, _, value in parameters(root, prefix)
    }


def _listed(values: dict[str, str], paths: Sequence[str]) -> str:
    """Return parameters in a row, with their values."""
    words = [values[path] for path in paths]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"


_STATUS = {
    layout.END_TIME: Status.END_TIME,
    layout.AT_REST: Status.AT_REST,
    layout.LIFTED_OFF: Status.LIFT_OFF,
    layout.STEP_LIMIT: Status.STEP_LIMIT,
    layout.STEP_TOO_SMALL: Status.STEP_TOO_SMALL,
    layout.ZENO: Status.ZENO,
}


def status_of(code: int, model: Model) -> Status:
    """Return how a run ended, from the kernels' code."""
    if code < layout.LIMITED:
        return _STATUS.get(code, Status.CANCELLED)
    limits = model.limits[code - layout.LIMITED :]
    return Status.LIMIT if limits and limits[0] != PAINLEVE else Status.PAINLEVE


PLACES = 200
"""Places of a run at which a mass matrix that was given is looked at."""
SMOOTH_TOLERANCE, BRISTLE_TOLERANCE = 1e-12, 1e-8
"""Tolerances that hold if none is given: without bristles, and with them, whose steps cost more."""
TIGHTEST = 1e-13
"""Least tolerance: rounding is not far below it."""


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
    ``"auto"`` takes what this process or an earlier one has compiled already, and compiles once
    plain runs have taken twice as long as that would."""

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.tier not in ("auto", "python", "compiled"):
            raise ParameterError(
                f"EventDriven.tier must be 'auto', 'python' or 'compiled', got {self.tier!r}."
            )

    def tolerance_for(self, law: FrictionLaw | Laws) -> float:
        """Return the tolerance that holds for a law, or for several."""
        laws = [member for _, member in law.members] if isinstance(law, Laws) else [law]
        if not any(member.states for member in laws):
            return SMOOTH_TOLERANCE if self.tolerance is None else self.tolerance
        given = (value for value in (self.stiff_tolerance, self.tolerance) if value is not None)
        return next(given, BRISTLE_TOLERANCE)

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
        pair, tolerance = _pair_of(mechanism, law), self.tolerance_for(law)
        start = within_stops(mechanism, y0) if pair.bounded else y0
        if pair.delayed:
            inputs, record = run_delayed(
                mechanism,
                pair.model,
                pair.p,
                start,
                t_end,
                tolerance,
                compiled=self.tier != "python",
                most=int(self.max_steps),
            )
        else:
            inputs = inputs_of(mechanism, pair.p, t_end)
            record = self._executed(pair.model, inputs, start, t_end, tolerance)
        run = trajectory_of(mechanism, law, pair.model, inputs, record, tolerance, t_end, told)
        if not self.estimate_error:
            return run
        # errors that the tolerance controls fall with it, so that the difference is of their size
        half = max(0.5 * tolerance, TIGHTEST)
        finer = replace(self, tolerance=half, stiff_tolerance=None, estimate_error=False)
        other = finer.run(mechanism, law, y0=y0, t_end=t_end)
        error = _difference(run, other)
        return replace(run, certificate=replace(run.certificate, error_estimate=error))

    def bare(
        self,
        mechanism: Mechanism,
        law: FrictionLaw | Laws,
        *,
        y0: Sequence[float],
        t_end: float,
        form: "Form | None" = None,
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
        form : Form, optional
            Their equations and numbers; looked up if not given.

        Returns
        -------
        BareRun
            Status, states and sensitivities of the run.
        """
        if form is None:
            model, sloped = formulate(mechanism, law), None
            inputs = gather(mechanism, law, model, t_end)
        else:
            model, sloped = form.model, form.sloped
            refuse_turned(mechanism, model)
            inputs = inputs_of(mechanism, form.p, t_end)
        start = within_stops(mechanism, y0)
        record = self._executed(model, inputs, start, t_end, self.tolerance_for(law), books=False)
        return bare_run(mechanism, law, model, inputs, record, t_end, sloped)

    def _executed(
        self,
        model: Model,
        inputs: Inputs,
        y0: Sequence[float],
        t_end: float,
        tolerance: float,
        *,
        books: bool = True,
    ) -> Record:
        """Return what the kernels wrote down of a run."""
        return execute(
            model,
            inputs,
            y0,
            t_end=t_end,
            tolerance=tolerance,
            limit=int(self.max_steps),
            tier=self.tier,
            books=books,
        )


@dataclass(frozen=True, eq=False)
class Form:
    """The equations of runs that differ in numbers only, for searches, which look them up once."""

    model: Model
    """Equations of a mechanism with a law."""
    sloped: Model
    """The same with their derivatives."""
    p: list[float]
    """Parameters in the order of the models, not to be changed."""

    @classmethod
    def of(cls, mechanism: Mechanism, law: FrictionLaw | Laws) -> Self:
        """Look up the equations of a mechanism with a law."""
        model = formulate(mechanism, law)
        sloped = formulate(mechanism, law, slopes=True)
        return cls(model, sloped, numbers_of(mechanism, law, model))

    def at(self, path: str, value: float) -> "Form":
        """Return the form with a value of the parameter at a full path, if equations have it."""
        if path not in self.model.parameter_paths:
            return self
        p = self.p.copy()
        p[self.model.parameter_paths.index(path)] = value
        return Form(self.model, self.sloped, p)


@dataclass(frozen=True, eq=False)
class _Pair:
    """What all runs of a mechanism with a law have in common."""

    model: Model
    """Their equations."""
    p: list[float]
    """Parameters in the order of the model, not to be changed."""
    names: tuple[str, ...]
    """Columns of a run."""
    units: dict[str, str]
    """SI unit of each of them."""
    contacts: tuple[str, ...]
    """Names of the contacts; the only one may have none, ``""``."""
    may_drive: bool
    """Whether the friction of a law may be along the slip."""
    bounded: bool
    """Whether runs cannot begin anywhere: there are hard stops, or masses that may vanish."""
    reasons: Sequence[str | None]
    """Names of what happens, by their codes."""
    delayed: bool
    """Whether a drive feeds back what a state was a while ago."""


@kept_by_identity
def _pair_of(mechanism: Mechanism, law: FrictionLaw | Laws) -> _Pair:
    """Return what the runs of a mechanism with a law have in common."""
    model = formulate(mechanism, law)
    contacts = tuple(contact.name for contact in mechanism.contacts())
    names = (*model.states, *model.columns, *(() if model.contacts else ("mode",)))
    return _Pair(
        model,
        numbers_of(mechanism, law, model),
        names,
        column_units(mechanism, names[2 * len(mechanism.coordinates) :]),
        contacts,
        any(map(may_drive, dict(law.members).values() if isinstance(law, Laws) else [law])),
        isinstance(mechanism, MatrixMechanism) or bool(stops_of(mechanism)),
        reasons(model),
        any(map(is_delayed, mechanism.drives().values())),
    )


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
        model, contacts = self.playback.model, sensing.mechanism.contacts()
        names = model.contacts or tuple(contact.name for contact in contacts)
        return _events(reasons(model), names, sensing.record)

    def happened(self) -> bytes:
        """Return what happened, without its times: alike where the same came in the same order."""
        record = self.differentiate.record
        rows = np.array(record.events[: layout.EVENT_COLUMNS * record.iw[layout.EVENTS]])
        rows[0 :: layout.EVENT_COLUMNS] = rows[5 :: layout.EVENT_COLUMNS] = 0.0  # time and margin
        return rows.tobytes()


def bare_run(
    mechanism: Mechanism,
    law: FrictionLaw | Laws,
    model: Model,
    inputs: Inputs,
    record: Record,
    t_end: float,
    sloped: Model | None = None,
) -> BareRun:
    """Wrap what the kernels recorded, without a certificate."""
    iw = record.iw
    return BareRun(
        states=model.states,
        status=status_of(iw[layout.STATUS], model),
        playback=Playback.from_log(model, record.runner, inputs, record.log, iw[layout.STEPS]),
        differentiate=Sensing(mechanism, law, inputs, record, t_end, (), sloped),
    )


def _difference(run: Trajectory, other: Trajectory) -> float:
    """Return the largest difference of a state, over its largest value, between two runs."""
    last = min(run.span[1], other.span[1])
    times = run.t[run.t <= last]
    mine, theirs = run.at(times), other.at(times)
    worst = 0.0
    for name in run.states:
        size = float(np.abs(mine[name]).max())
        error = float(np.abs(mine[name] - theirs[name]).max())
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
    pair, iw = _pair_of(mechanism, law), record.iw
    playback = Playback.from_log(model, record.runner, inputs, record.log, iw[layout.STEPS])
    status, cause = status_of(iw[layout.STATUS], model), ""
    if status is Status.STEP_LIMIT:
        cause = cause_of_step_limit(mechanism, law, model, inputs, record, t_end)
    elif status is Status.STEP_TOO_SMALL:
        cause = _cause_of_vanishing_mass(mechanism, playback)
        cause = cause or cause_of_small_steps(mechanism, law, model, inputs, record)
    certificate = certify(playback, record.w, iw, tolerance)
    driven = driving(mechanism, law, playback, certificate) if pair.may_drive else ()
    if driven:
        certificate = replace(certificate, warnings=(*certificate.warnings, *driven))
    events = _events(pair.reasons, model.contacts or pair.contacts, record)
    if status is Status.ZENO:  # whose cause is told by the events
        cause = cause_of_zeno(events, playback.span()[1])
    return Trajectory(
        t=playback.times(),
        names=pair.names,
        units=dict(pair.units),
        events=events,
        status=status,
        cause=cause,
        certificate=_with_masses(mechanism, playback, certificate),
        span=playback.span(),
        evaluate=playback,
        states=model.states,
        differentiate=Sensing(mechanism, law, inputs, record, t_end, tuple(told)),
        only_contact=pair.contacts[0] if len(pair.contacts) == 1 else "",
    )


def _with_masses(mechanism: Mechanism, playback: Playback, certificate: Certificate) -> Certificate:
    """Return a certificate that also knows whether matrices given were masses all along the run."""
    if not isinstance(mechanism, MatrixMechanism):
        return certificate
    # Ends of steps, thinned to about PLACES: a run may have a million of them.
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


def _events(
    names: Sequence[str | None], contacts: Sequence[str], record: Record
) -> tuple[Event, ...]:
    """Translate the recorded events; switches without a name stay inside."""
    events, iw = [], record.iw
    rows = np.asarray(record.events[: layout.EVENT_COLUMNS * iw[layout.EVENTS]]).tolist()
    for i in range(iw[layout.EVENTS]):
        t, before, after, _, _, margin, contact = rows[
            layout.EVENT_COLUMNS * i : layout.EVENT_COLUMNS * (i + 1)
        ]
        reason = names[happened(rows, i, iw)]
        if reason is not None:
            event = unchecked(
                Event,
                t=t,
                contact=contacts[int(contact)],
                from_mode=int(before),
                to_mode=int(after),
                reason=reason,
                margin=margin,
            )
            events.append(event)
    return tuple(events)

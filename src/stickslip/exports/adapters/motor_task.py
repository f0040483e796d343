"""What a motor is to do in an environment, and its steps for many mechanisms at once."""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven, IncrementalEnsemble
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import Coulomb, FrictionLaw
from stickslip.mechanisms import Capsule, Mechanism, Motor, PendulumCart, Torque, slip_of
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Parametrised, Quantity, full_path, parameters, structure
from stickslip.quantities import vary as changed
from stickslip.show.display import require_library
from stickslip.show.formatting import number

Array = NDArray[np.float64]
Truths = NDArray[np.bool_]

SOLVER = EventDriven(tolerance=1e-9)
"""Of tasks that name none: looser tolerances save no time, since periods are single steps."""


@dataclass(frozen=True, kw_only=True)
class MotorTask(Parametrised):
    """A mechanism that its motor is to move far with little energy.

    The action is the share of the largest effort, -1 to 1, which the motor holds for a period.
    Observed are the velocity of the body, and place and rate of the inner body. The reward of a
    step is the travel less `work_weight` times the work of the motor, `effort` times the change of
    the inner body's place where that is positive: energy given back is lost. An episode ends where
    the run does (the body lifts off or tips), or where place or rate exceeds its limit; it is
    truncated at `duration`.

    Examples
    --------
    >>> CART.observation_names, CART.observation_units
    (('v', 'theta', 'omega'), ('m/s', 'rad', 'rad/s'))
    >>> CART.steps
    500
    """

    mechanism: Mechanism
    """`PendulumCart`, `Capsule`, or another mechanism of two coordinates with a `Motor`, which is
    replaced: what it was told is ignored."""
    law: FrictionLaw
    """Friction of its contact."""
    effort_limit: Annotated[float, Quantity("tau_m", "N m", above=0, or_unit="N")]
    """Largest torque or force of the motor."""
    position_limit: Annotated[float, Quantity("q_max", "rad", above=0, or_unit="m")]
    """Largest distance of the inner body from 0."""
    rate_limit: Annotated[float, Quantity("w_max", "rad/s", above=0, or_unit="m/s")]
    """Largest speed of the inner body."""
    speed_bound: Annotated[float, Quantity("v_max", "m/s", above=0)]
    """Largest velocity of the body that is observed; a larger one is clipped."""
    work_weight: Annotated[float, Quantity("c", "m/J", low=0)]
    """What a unit of work takes from the reward: the travel per energy that is just worth it."""
    period: Annotated[float, Quantity("T_s", "s", above=0)] = 0.01
    """Time for which an action is held."""
    duration: Annotated[float, Quantity("T", "s", above=0)] = 5.0
    """Time after which an episode is truncated."""
    start_spread: Annotated[float, Quantity("q_0", "rad", low=0, or_unit="m")] = 0.0
    """Largest distance from 0 at which the inner body begins; each place up to it is as likely."""
    solver: EventDriven = SOLVER
    """Tolerance, and most steps of a period."""

    def __post_init__(self) -> None:
        """Check the numbers, the mechanism and where episodes begin."""
        super().__post_init__()
        for name, kind, example in (
            ("mechanism", Mechanism, "a mechanism such as PendulumCart(...)"),
            ("law", FrictionLaw, "a friction law such as Coulomb(...)"),
            ("solver", EventDriven, "an EventDriven(...)"),
        ):
            given = getattr(self, name)
            if not isinstance(given, kind):
                raise ParameterError(f"MotorTask.{name} must be {example}, got {given!r}.")
        if self._motor is None or len(self.mechanism.coordinates) != 2:
            raise ParameterError(
                "MotorTask.mechanism must have two coordinates and a motor between them, as"
                f" PendulumCart and Capsule have, got {type(self.mechanism).__name__}."
            )
        if self.start_spread >= self.position_limit:
            raise ParameterError(
                "MotorTask.start_spread (q_0) must be below position_limit ="
                f" {self.position_limit:g}, got {self.start_spread:g}."
            )

    @property
    def _motor(self) -> str | None:
        """Name of the field that holds the motor."""
        fields = dataclasses.fields(self.mechanism)
        found = [f.name for f in fields if isinstance(getattr(self.mechanism, f.name), Motor)]
        return found[0] if found else None

    def driven(self, actions: Sequence[float] = ()) -> Mechanism:
        """Return the mechanism whose motor holds actions, one after the other.

        Parameters
        ----------
        actions : sequence of float (n,)
            Actions of the steps, -1 to 1; none for a motor at rest.

        Returns
        -------
        Mechanism
            A copy of the mechanism.
        """
        assert self._motor is not None
        # What is beyond the limits is clipped, as a real drive does.
        shares = [float(np.clip(action, -1.0, 1.0)) for action in actions] or [0.0]
        times = tuple(k * self.period for k in range(len(shares)))
        efforts = tuple(share * self.effort_limit for share in shares)
        motor = Torque(drive=Sampled(times=times, values=efforts))
        return dataclasses.replace(self.mechanism, **{self._motor: motor})

    @property
    def steps(self) -> int:
        """Steps after which an episode is truncated."""
        # Rounding must not add a step.
        return max(1, math.ceil(self.duration / self.period * (1.0 - 1e-12)))

    @cached_property
    def places(self) -> tuple[int, int, int, int]:
        """Places in the state of the body's position and velocity, and of the inner body's."""
        # Both coordinates, then both rates.
        body = self.mechanism.coordinates.index(slip_of(self.mechanism))
        return body, body + 2, 1 - body, 3 - body

    @property
    def observation_names(self) -> tuple[str, str, str]:
        """What is observed: velocity of the body, place and rate of the inner body."""
        names = (*self.mechanism.coordinates, *self.mechanism.rates)
        _, v, q, w = self.places
        return names[v], names[q], names[w]

    @property
    def observation_units(self) -> tuple[str, str, str]:
        """Units of what is observed."""
        body, _, inner, _ = self.places
        units = self.mechanism.units
        return f"{units[body]}/s", units[inner], f"{units[inner]}/s"

    @property
    def observation_bounds(self) -> Array:
        """Largest magnitude of each number that is observed (3,) [SI]."""
        return np.array([self.speed_bound, self.position_limit, self.rate_limit])

    def trajectory(self, start: Sequence[float], actions: Sequence[float]) -> Trajectory:
        """Return the run that actions make, one after the other, with its events and certificate.

        Parameters
        ----------
        start : sequence of float (n,)
            State at time 0 [SI].
        actions : sequence of float (m,)
            Actions of the steps, -1 to 1.

        Returns
        -------
        Trajectory
            The run; it ends where the episode would if the run does.
        """
        end = self.period * max(len(actions), 1)
        return simulate(
            self.driven(actions),
            self.law,
            t_end=end,
            y0=list(start),
            solver=self.solver,
            throw=False,
        )


CART = MotorTask(
    mechanism=PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3),
    law=Coulomb(kinetic_coefficient=0.2),
    effort_limit=1.25,
    position_limit=math.pi / 3.0,
    rate_limit=30.0,
    speed_bound=5.0,
    work_weight=0.0835,
    start_spread=0.05,
)
"""A cart that a pendulum drives. The weight of the work is the travel per energy of its steady
three-phase swing of 45 degrees with 120 and 30 rad/s^2, which needs 1.258 N m and brings 0.0635 m
for 0.760 J: a return above 0 is more travel per energy than that."""

CAPSULE = MotorTask(
    mechanism=Capsule(capsule_mass=0.8, inner_mass=0.2),
    law=Coulomb(kinetic_coefficient=0.2),
    effort_limit=8.0,
    position_limit=0.02,
    rate_limit=2.0,
    speed_bound=2.0,
    work_weight=0.1066,
    start_spread=0.001,
)
"""A capsule that an inner mass drives. The weight of the work is the travel per energy of its
steady three-phase motion with 9.81 and 50 m/s^2, which needs 8.39 N."""

TASKS: Mapping[str, MotorTask] = {"cart": CART, "capsule": CAPSULE}


def task_of(task: str | MotorTask) -> MotorTask:
    """Return a task, or the one of a name."""
    if isinstance(task, MotorTask):
        return task
    if not isinstance(task, str):
        raise InputError(f"task must be a MotorTask or a name, got {task!r}.")
    if task not in TASKS:
        raise UnknownNameError("task", task, TASKS)
    return TASKS[task]


@dataclass(frozen=True)
class Stepped:
    """What a step of all mechanisms has brought, a row each."""

    observations: Array
    """(count, 3) [SI], within their bounds."""
    rewards: Array
    """(count,) [m]."""
    terminated: Truths
    """Whether the episode has ended (count,)."""
    truncated: Truths
    """Whether its time is over (count,)."""
    travel: Array
    """Of the step (count,) [m]."""
    work: Array
    """Of the motor in the step (count,) [J]."""


class Draws(Protocol):
    """What draws laws: a verdict, or a tissue."""

    def sample(self) -> Sequence[FrictionLaw]:
        """Return laws, each of them as likely."""


def laws_of(task: MotorTask, laws: Sequence[FrictionLaw] | Draws | None) -> list[FrictionLaw]:
    """Return the laws of which episodes draw one: that of the task if none are given."""
    if laws is None:
        return [task.law]
    found = laws if isinstance(laws, Sequence) else getattr(laws, "sample", tuple)()
    if not found or not all(isinstance(law, FrictionLaw) for law in found):
        raise InputError(
            "laws must be friction laws, at least one, or what draws them by sample(), as a verdict"
            f" or TISSUES['wet'], got {laws!r}."
        )
    return [*found]


def values_in(task: MotorTask, vary: Mapping[str, Sequence[float | str]]) -> dict[str, list[float]]:
    """Return the values of which episodes draw one [SI], by the full path of a parameter."""
    known = {path: quantity for path, quantity, _ in parameters(task.mechanism, "mechanism")}
    found: dict[str, list[float]] = {}
    for name, given in vary.items():
        path = full_path(name, known)
        if isinstance(given, str) or np.ndim(given) != 1 or len(given) == 0:
            raise InputError(
                f"vary[{name!r}] must be the values of which an episode draws one, such as"
                f" np.linspace(-0.1, 0.1, 21), got {given!r}."
            )
        # Through the check of a parameter, which also reads units.
        for x in given:
            own = changed(task.mechanism, "mechanism", {path: cast("float", x)})
            found.setdefault(path, []).append(
                {p: v for p, _, v in parameters(own, "mechanism")}[path]
            )
    return found


class Steps:
    """Mechanisms of one task that step together, each with a law and parameters that it draws.

    Laws with the same equations are runs of one ensemble: each mechanism moves in that of its law.
    """

    def __init__(
        self,
        task: MotorTask,
        count: int,
        *,
        laws: Sequence[FrictionLaw] | Draws | None = None,
        vary: Mapping[str, Sequence[float | str]] | None = None,
        threads: int | None = None,
    ) -> None:
        """Make room; each has to begin before it can step."""
        self.task, self.count = task, count
        self._laws, self._values = laws_of(task, laws), values_in(task, vary or {})
        # By the structure of the equations: laws that differ in numbers share one ensemble.
        firsts = {structure(law): law for law in self._laws}
        self._runs = {
            form: IncrementalEnsemble(
                task.driven(), law, count=count, solver=task.solver, threads=threads
            )
            for form, law in firsts.items()
        }
        self._at = [next(iter(self._runs.values()))] * count
        self._moving: list[tuple[IncrementalEnsemble, NDArray[np.intp]]] = []
        """Ensembles that mechanisms move in, and which do."""
        self.tasks = [task] * count
        """That of each, with what it has drawn."""
        self.drawn: dict[str, NDArray[Any]] = {"law": np.full(count, None)}
        """What each has drawn (count,): its law, and parameters by path [SI]."""
        self.drawn |= {path: np.full(count, np.nan) for path in self._values}
        self._done = np.zeros(count, dtype=np.int64)
        self._bounds = task.observation_bounds

    @property
    def states(self) -> Array:
        """Coordinates and rates of all (count, 4) [SI]."""
        found = np.empty((self.count, 4))
        for runs, rows in self._moving:
            found[rows] = runs.states[rows, :4]
        return found

    def state(self, row: int) -> Array:
        """Return the state of one, with those of its law (n,) [SI]."""
        found: Array = self._at[row].states[row]
        return found

    @property
    def observations(self) -> Array:
        """What is observed of all (count, 3) [SI], clipped to its bounds."""
        return self._seen(self.states)

    def _seen(self, states: Array) -> Array:
        _, v, q, w = self.task.places
        return np.clip(states[:, (v, q, w)], -self._bounds, self._bounds)

    def _start(
        self, names: Sequence[str], generator: np.random.Generator, given: Mapping[str, float]
    ) -> Array:
        """Return a state at which an episode may begin (n,) [SI]."""
        state = np.zeros(len(names))
        _, _, q, w = self.task.places
        spread = self.task.start_spread
        state[q] = generator.uniform(-spread, spread)
        for name, value in given.items():
            if name not in names:
                raise UnknownNameError("state", name, names)
            state[names.index(name)] = value
        limits = ((q, self.task.position_limit), (w, self.task.rate_limit))
        for place, limit in limits:
            if not abs(state[place]) <= limit:
                raise InputError(
                    f"{names[place]} of the start must lie between {number(-limit, 6)} and"
                    f" {number(limit, 6)}, got {state[place]:g}."
                )
        return state

    def _draw(self, generator: np.random.Generator) -> tuple[int, ...]:
        """Return which law and which values an episode has."""
        # a choice of one takes nothing from the generator
        sizes = [len(self._laws), *map(len, self._values.values())]
        return tuple(int(generator.integers(size)) for size in sizes)

    def begin(
        self,
        rows: Sequence[int] | NDArray[np.intp],
        generators: Sequence[np.random.Generator],
        given: Mapping[str, float] | None = None,
    ) -> None:
        """Let some begin a new episode: each draws its law, parameters and start, in this order."""
        draws = [self._draw(generator) for generator in generators]
        names = [self._runs[structure(self._laws[k])].model.states for k, *_ in draws]
        starts = [self._start(*pair, given or {}) for pair in zip(names, generators, strict=True)]
        # Draws are alike where law and values are: such mechanisms begin together.
        alike: dict[tuple[int, ...], list[int]] = {}
        for i, (row, draw) in enumerate(zip(rows, draws, strict=True)):
            # It may have moved in the ensemble of another law.
            self._at[row].leave([row])
            alike.setdefault(draw, []).append(i)
        for (k, *places), which in alike.items():
            begun, law = [int(rows[i]) for i in which], self._laws[k]
            runs = self._runs[structure(law)]
            values = {path: x[j] for j, (path, x) in zip(places, self._values.items(), strict=True)}
            task = self.task
            if values or law is not task.law:
                mechanism = changed(task.mechanism, "mechanism", values)
                task = dataclasses.replace(task, law=law, mechanism=mechanism)
            self._done[begun] = 0
            runs.begin(begun, np.array([starts[i] for i in which]), task.mechanism, law)
            for row in begun:
                self.tasks[row], self._at[row] = task, runs
            for name, value in {"law": law, **values}.items():
                self.drawn[name][begun] = value
        used = dict.fromkeys(self._at)
        self._moving = [(share, np.flatnonzero([at is share for at in self._at])) for share in used]

    def step(self, actions: Array) -> Stepped:
        """Hold an action for a period in each."""
        task = self.task
        chosen = np.asarray(actions)
        if chosen.dtype.kind not in "iuf":
            raise InputError(
                f"actions must be real numbers from -1 to 1, got an array of {chosen.dtype}."
            )
        efforts: Array = np.array(chosen, dtype=np.float64)
        if efforts.shape != (self.count,):
            raise InputError(
                f"actions must have the shape ({self.count}, 1), a share of the largest effort for"
                f" each mechanism, got {efforts.shape}."
            )
        if np.isnan(efforts).any():
            row = int(np.argmax(np.isnan(efforts)))
            which = f" of mechanism {row}" if self.count > 1 else ""
            raise InputError(
                f"the action{which} must be a number from -1 to 1, the share of the largest effort,"
                " got nan."
            )
        efforts = np.multiply(np.clip(efforts, -1.0, 1.0), task.effort_limit, dtype=np.float64)
        before = self.states
        self._done += 1
        # From the count of steps, not summed up: no rounding piles up.
        untils = np.multiply(self._done, task.period, dtype=np.float64)
        running = np.empty(self.count, dtype=bool)
        for runs, rows in self._moving:
            runs.advance(untils, efforts)
            running[rows] = runs.running[rows]
        after = self.states
        x, _, q, w = task.places
        moved = after - before
        # A motor that is driven back gives nothing back.
        work = np.maximum(efforts * moved[:, q], 0.0)
        # Checked at the ends of steps only.
        beyond = (np.abs(after[:, q]) > task.position_limit) | (
            np.abs(after[:, w]) > task.rate_limit
        )
        return Stepped(
            observations=self._seen(after),
            rewards=moved[:, x] - task.work_weight * work,
            terminated=beyond | ~running,
            truncated=self._done >= task.steps,
            travel=moved[:, x],
            work=work,
        )

    def ending(self, row: int) -> str:
        """Return the sentence that says why an episode ended."""
        if not self._at[row].running[row]:
            return self._at[row].status(row).value
        name = self.task.observation_names[1]
        return f"{name} or its rate exceeded its limit."


# The environments that Gymnasium finds by their names.

IDS = {"stickslip/Cart-v0": "cart", "stickslip/Capsule-v0": "capsule"}
"""Names of the environments, and of their tasks."""
HOME = "stickslip.exports.adapters.environments"


def register_environments() -> None:
    """Tell Gymnasium the environments, as importing `stickslip.exports.gym` does.

    Raises
    ------
    InputError
        If gymnasium is not installed.

    Examples
    --------
    >>> import gymnasium
    >>> register_environments()
    >>> gymnasium.make("stickslip/Cart-v0").action_space.shape
    (1,)
    """
    registration = require_library("gymnasium.envs.registration", "gym")
    for name, task in IDS.items():
        if name not in registration.registry:
            registration.register(
                id=name,
                entry_point=f"{HOME}:MotorEnvironment",
                vector_entry_point=f"{HOME}:MotorVectorEnvironment",
                kwargs={"task": task},
            )

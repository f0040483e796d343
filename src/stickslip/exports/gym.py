"""Environments of Gymnasium: one mechanism whose motor acts, or many that step together.

Importing this module tells Gymnasium the environments, as ``make("stickslip.exports.gym:...")``
does. That is work at import, which no other module does: Gymnasium knows no other way to find them.
"""

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, ClassVar, Protocol, cast

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.engine.simulation import simulate
from stickslip.engine.solver import EventDriven, IncrementalEnsemble
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import Coulomb, FrictionLaw
from stickslip.mechanisms import Capsule, Coil, Mechanism, Motor, PendulumCart, Torque, slip_of
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Parametrised, Quantity, full_path, named, parameters, structure
from stickslip.quantities import vary as changed
from stickslip.show.display import require_library
from stickslip.show.formatting import number

require_library("gymnasium", "gym")

import gymnasium  # noqa: E402  # after the message of where to get it
from gymnasium.spaces import Box  # noqa: E402
from gymnasium.vector import AutoresetMode, VectorEnv  # noqa: E402
from gymnasium.vector.utils import batch_space  # noqa: E402

# What a motor is to do in an environment, and its steps for many mechanisms at once.

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
        result = [f.name for f in fields if isinstance(getattr(self.mechanism, f.name), Motor)]
        return result[0] if result else None

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
        drive, held = Sampled(times=times, values=efforts), getattr(self.mechanism, self._motor)
        # the force of a coil depends on the place still
        coil = isinstance(held, Coil)
        motor = dataclasses.replace(held, drive=drive) if coil else Torque(drive=drive)
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
    result: MotorTask = named(TASKS, task, "task")
    return result


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
    result = laws if isinstance(laws, Sequence) else getattr(laws, "sample", tuple)()
    if not result or not all(isinstance(law, FrictionLaw) for law in result):
        raise InputError(
            "laws must be friction laws, at least one, or what draws them by sample(), as a verdict"
            f" or TISSUES['wet'], got {laws!r}."
        )
    return [*result]


def values_in(task: MotorTask, vary: Mapping[str, Sequence[float | str]]) -> dict[str, list[float]]:
    """Return the values of which episodes draw one [SI], by the full path of a parameter."""
    known = {path: quantity for path, quantity, _ in parameters(task.mechanism, "mechanism")}
    result: dict[str, list[float]] = {}
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
            result.setdefault(path, []).append(
                {p: v for p, _, v in parameters(own, "mechanism")}[path]
            )
    return result


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
        result = np.empty((self.count, 4))
        for runs, rows in self._moving:
            result[rows] = runs.states[rows, :4]
        return result

    def state(self, row: int) -> Array:
        """Return the state of one, with those of its law (n,) [SI]."""
        result: Array = self._at[row].states[row]
        return result

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
HOME = "stickslip.exports.gym"


def register_environments() -> None:
    """Tell Gymnasium the environments, as importing `stickslip.exports.gym` does.

    Examples
    --------
    >>> import gymnasium
    >>> register_environments()
    >>> gymnasium.make("stickslip/Cart-v0").action_space.shape
    (1,)
    """
    registration = gymnasium.envs.registration
    for name, task in IDS.items():
        if name not in registration.registry:
            registration.register(
                id=name,
                entry_point=f"{HOME}:MotorEnvironment",
                vector_entry_point=f"{HOME}:MotorVectorEnvironment",
                kwargs={"task": task},
            )


# Environments: one mechanism whose motor acts, or many that step together.

Info = dict[str, Any]

PICTURE = (880, 400)
"""Width and height of a picture [px]."""


def _spaces(task: MotorTask) -> tuple[Any, Any]:
    """Return the spaces of observations and actions."""
    bounds = task.observation_bounds
    array = np.ones(1)
    return Box(-bounds, bounds, dtype=np.float64), Box(-array, array, dtype=np.float64)


def _given(options: Mapping[str, Any] | None) -> Mapping[str, float] | None:
    """Return the states that an episode is to begin with."""
    state = (options or {}).get("state")
    if state is not None and not isinstance(state, Mapping):
        raise InputError(
            f"options['state'] must give states by name, as {{'theta': 0.1}}, got {state!r}."
        )
    return state


class MotorEnvironment(gymnasium.Env[Array, Array]):
    """A mechanism whose motor acts, as an environment; `MotorTask` says what is seen and rewarded.

    ``reset(options={"state": {"theta": 0.1}})`` begins at a given state. The numbers of a step are
    exact: the run is that of `EventDriven`, and `trajectory` gives it with its certificate.

    Examples
    --------
    >>> env = MotorEnvironment("cart")
    >>> seen, info = env.reset(seed=0)
    >>> seen, reward, terminated, truncated, info = env.step(np.array([0.5]))
    >>> env.close()
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 25}  # type: ignore[misc]

    def __init__(
        self,
        task: str | MotorTask = "cart",
        render_mode: str | None = None,
        *,
        laws: Sequence[FrictionLaw] | Draws | None = None,
        vary: Mapping[str, Sequence[float | str]] | None = None,
    ) -> None:
        """Make the environment.

        Parameters
        ----------
        task : str or MotorTask
            The task, ``"cart"`` or ``"capsule"``.
        render_mode : str, optional
            ``"rgb_array"`` for pictures, each of which takes some tenths of a second.
        laws : sequence of FrictionLaw, or a verdict or tissue, optional
            Each episode has one of them, or of what ``laws.sample()`` draws, instead of that of the
            task.
        vary : mapping, optional
            Values of parameters of the mechanism, such as ``{"incline": [0.0, "5 deg"]}``: each
            episode has one of them.
        """
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise InputError(f"render_mode must be None or 'rgb_array', got {render_mode!r}.")
        self.task, self.render_mode = task_of(task), render_mode
        self.observation_space, self.action_space = _spaces(self.task)
        self._steps = Steps(self.task, 1, laws=laws, vary=vary, threads=1)
        self._start: list[float] | None = None
        self._actions: list[float] = []
        self._travel = self._work = 0.0

    @override
    def reset(self, *, seed: int | None = None, options: Info | None = None) -> tuple[Array, Info]:
        """Begin an episode; return what is observed, and travel, work and states.

        Parameters
        ----------
        seed : int, optional
            Of the generator, which goes on if not given.
        options : dict, optional
            ``{"state": {...}}`` has states by name at which the episode begins [SI].

        Returns
        -------
        (array (3,), dict)
            Observation [SI]; travel [m], work [J], all states, and what was drawn: ``"drawn"``.
        """
        super().reset(seed=seed)
        self._steps.begin([0], [self.np_random], _given(options))
        self._start, self._actions = self._steps.state(0).tolist(), []
        self._travel = self._work = 0.0
        return self._steps.observations[0], self._info()

    @override
    def step(self, action: Array) -> tuple[Array, float, bool, bool, Info]:
        """Hold an action for a period.

        Parameters
        ----------
        action : array (1,)
            Share of the largest effort, -1 to 1; what is beyond is clipped.

        Returns
        -------
        (array (3,), float, bool, bool, dict)
            Observation [SI], reward [m], whether the episode has ended, whether its time is over;
            travel [m], work [J], all states, and where it has ended the reason, ``"ending"``.

        Raises
        ------
        InputError
            If no episode has begun, or the action is no number.
        """
        if self._start is None:
            raise InputError("the environment has not begun: call reset() before step().")
        chosen = np.asarray(action).reshape(-1)
        done = self._steps.step(chosen)
        # As it was applied, so that `trajectory` makes the same run.
        self._actions.append(float(np.clip(chosen[0], -1.0, 1.0)))
        self._travel += float(done.travel[0])
        self._work += float(done.work[0])
        info, terminated = self._info(), bool(done.terminated[0])
        if terminated:
            info["ending"] = self._steps.ending(0)
        return (
            done.observations[0],
            float(done.rewards[0]),
            terminated,
            bool(done.truncated[0]),
            info,
        )

    def _info(self) -> Info:
        """Return travel [m] and work [J] of the episode, all states [SI], and what was drawn."""
        drawn = {name: values[0] for name, values in self._steps.drawn.items()}
        state = self._steps.state(0)
        return {"travel": self._travel, "work": self._work, "state": state, "drawn": drawn}

    def trajectory(self) -> Trajectory:
        """Return the run of the episode so far, with its events and certificate.

        Raises
        ------
        InputError
            If no episode has begun.
        """
        if self._start is None:
            raise InputError("the environment has not begun: call reset() before trajectory().")
        return self._steps.tasks[0].trajectory(self._start, self._actions)

    @override
    def render(self) -> Any:
        """Return the scene beside its time plots (400, 880, 3) in RGB; None without a mode."""
        if self.render_mode is None:
            return None
        from stickslip.show.plots import picture_of

        run = self.trajectory()
        # A run that ended early has no later state to show.
        now = min(len(self._actions) * self.task.period, run.span[1])
        return picture_of(run, self._steps.tasks[0].driven(self._actions), now, size=PICTURE)


class MotorVectorEnvironment(VectorEnv[Array, Array, NDArray[Any]]):
    """Many mechanisms of one task, which step in one call of machine code.

    Mechanism i is seeded with ``seed + i`` and does what a `MotorEnvironment` of that seed does.
    One whose episode is over begins anew in the next step, and its action is ignored. There is
    nothing to render.

    Examples
    --------
    >>> envs = MotorVectorEnvironment(num_envs=3)
    >>> seen, info = envs.reset(seed=0)
    >>> seen, rewards, terminated, truncated, info = envs.step(np.zeros((3, 1)))
    >>> seen.shape, rewards.shape
    ((3, 3), (3,))
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": [],
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 256,
        task: str | MotorTask = "cart",
        *,
        threads: int | None = None,
        render_mode: str | None = None,
        laws: Sequence[FrictionLaw] | Draws | None = None,
        vary: Mapping[str, Sequence[float | str]] | None = None,
    ) -> None:
        """Make the environments.

        Parameters
        ----------
        num_envs : int
            Number of mechanisms.
        task : str or MotorTask
            The task, ``"cart"`` or ``"capsule"``.
        threads : int, optional
            Threads that share them; one a processor if not given.
        render_mode : str, optional
            None: there is nothing to render.
        laws, vary
            As of `MotorEnvironment`.
        """
        count: object = num_envs
        if not (isinstance(count, int | np.integer) and count >= 1):
            raise InputError(f"num_envs must be a whole number above 0, got {num_envs!r}.")
        if render_mode is not None:
            raise InputError(
                f"render_mode must be None where many step together, got {render_mode!r}: render a"
                " MotorEnvironment of the same seed and actions."
            )
        self.task, self.num_envs = task_of(task), int(num_envs)
        self._steps = Steps(  # refuses too many
            self.task, self.num_envs, laws=laws, vary=vary, threads=threads
        )
        self.single_observation_space, self.single_action_space = _spaces(self.task)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._generators: list[np.random.Generator] = []
        self._begun = False
        self._over = np.ones(self.num_envs, dtype=bool)
        self._travel, self._work = np.zeros(self.num_envs), np.zeros(self.num_envs)

    @override
    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: Info | None = None
    ) -> tuple[Array, Info]:
        """Begin episodes; return what is observed, and travel and work of each.

        Parameters
        ----------
        seed : int or sequence of int, optional
            That of the first mechanism, or of each; generators go on where there is none.
        options : dict, optional
            ``"state"`` has states by name at which episodes begin [SI], ``"reset_mask"`` (count,)
            says which ones begin anew, all if not given.

        Returns
        -------
        (array (count, 3), dict)
            Observations [SI]; travel [m] and work [J] of each, and what each has drawn.

        Raises
        ------
        InputError
            If there is not one seed for each, or a mask is given before all have begun.
        """
        self._seed(seed)
        mask = (options or {}).get("reset_mask")
        rows = np.arange(self.num_envs) if mask is None else np.flatnonzero(mask)
        if not self._begun and len(rows) < self.num_envs:
            raise InputError("the environments have not begun: call reset() without a mask first.")
        self._begin(rows, _given(options))
        self._begun = True
        return self._steps.observations, self._info()

    def _seed(self, seed: int | Sequence[int | None] | None) -> None:
        """Make the generators: of all anew, or of those that have a seed."""
        if seed is None and self._generators:
            return
        if seed is None or isinstance(seed, int | np.integer):
            super().reset(seed=seed)
            first = int(self.np_random.integers(2**31)) if seed is None else int(seed)
            seed = range(first, first + self.num_envs)
        if len(seed) != self.num_envs:
            raise InputError(
                f"seed must be one number or {self.num_envs} of them, got {len(seed)}."
            )
        made = [gymnasium.utils.seeding.np_random(index)[0] for index in seed]
        triples = zip(seed, made, self._generators or made, strict=True)
        # Those without a seed of their own go on.
        self._generators = [old if index is None else new for index, new, old in triples]

    def _begin(self, rows: NDArray[np.intp], given: Mapping[str, float] | None = None) -> None:
        if not rows.size:
            return
        self._steps.begin(rows, [self._generators[row] for row in rows], given)
        self._over[rows] = False
        self._travel[rows] = self._work[rows] = 0.0

    @override
    def step(self, actions: Array) -> tuple[Array, Array, Truths, Truths, Info]:
        """Hold an action for a period in each; those whose episode is over begin anew instead.

        Parameters
        ----------
        actions : array (count, 1)
            Shares of the largest effort, -1 to 1; what is beyond is clipped.

        Returns
        -------
        (array (count, 3), array (count,), array (count,), array (count,), dict)
            Observations [SI], rewards [m], whether episodes have ended, whether their time is over;
            travel [m] and work [J] of each.

        Raises
        ------
        InputError
            If they have not begun, or an action is no number.
        """
        if not self._begun:
            raise InputError("the environments have not begun: call reset() before step().")
        chosen = np.asarray(actions)
        if chosen.shape == (self.num_envs, 1):
            chosen = chosen[:, 0]
        fresh = self._over
        if fresh.any():
            # Nothing pushes those whose episode is over; their step is the reset.
            chosen = np.where(fresh, 0.0, chosen)
        done = self._steps.step(chosen)
        self._travel += done.travel
        self._work += done.work
        seen, rewards = done.observations, done.rewards
        terminated, truncated = done.terminated, done.truncated
        if fresh.any():
            rows = np.flatnonzero(fresh)
            self._begin(rows)
            seen[rows] = self._steps.observations[rows]
            # A step that begins an episode has no reward and cannot end it.
            rewards[rows], terminated[rows], truncated[rows] = 0.0, False, False
        self._over = terminated | truncated
        return seen, rewards, terminated, truncated, self._info()

    def _info(self) -> Info:
        """Return travel [m] and work [J] of each episode, and what was drawn: all are there."""
        there = np.ones(self.num_envs, dtype=bool)

        def masked(values: Info) -> Info:
            return values | {f"_{name}": there for name in values}

        drawn = {name: values.copy() for name, values in self._steps.drawn.items()}
        work, travel = self._work.copy(), self._travel.copy()
        return masked({"travel": travel, "work": work, "drawn": masked(drawn)})


register_environments()

"""Environments of Gymnasium: one mechanism whose motor acts, or many that step together."""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError
from stickslip.exports.adapters.motor_task import Draws, MotorTask, Steps, task_of
from stickslip.friction import FrictionLaw
from stickslip.show.display import require_library

require_library("gymnasium", "gym")

import gymnasium  # noqa: E402  # after the message of where to get it
from gymnasium.spaces import Box  # noqa: E402
from gymnasium.vector import AutoresetMode, VectorEnv  # noqa: E402
from gymnasium.vector.utils import batch_space  # noqa: E402

Array = NDArray[np.float64]
Truths = NDArray[np.bool_]
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

"""Why a run could not go on: its fastest motion, its drives, or its events."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import number, quantity
from stickslip.formulation import LINKS, Model
from stickslip.friction import FrictionLaw, Laws
from stickslip.kernels.equations import PREPARE, RESTORE, ask_here, field, put_constants
from stickslip.kernels.state_layout import (
    EVENTS,
    FORWARD,
    HELD_FAST,
    MASS,
    MODE,
    MODES,
    N_CONTACTS,
    N_COORDINATES,
    N_DIRECTIONS,
    PIECE,
    SCALE,
    STEPS,
    TIME,
    Y,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters
from stickslip.solver.backend import runner_of
from stickslip.solver.base import path_units
from stickslip.solver.drive_schedule import Inputs
from stickslip.solver.run import Record
from stickslip.trajectory import Event

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
        self.whole = list(record.whole)
        self.w: list[Any] = runner.taken_over(record.w)
        self.places = runner.places
        self.n = len(model.states)
        self.first, self.to = self.whole[Y], len(self.w)
        self.w += [0.0] * self.n
        self.y = np.array(self.w[self.first : self.first + self.n])
        reached = np.abs(self.w[self.whole[SCALE] : self.whole[SCALE] + self.n])
        self.sizes = np.maximum(reached, np.abs(self.y))
        self.sizes[self.sizes == 0.0] = self.sizes.max(initial=0.0) or 1.0

    def slip(self) -> None:
        """Let all that is held slip."""
        if self.whole[N_CONTACTS] == 0:
            self.whole[MODE] = self.whole[MODE] or FORWARD
            return
        modes = self.whole[MODES]
        for i in range(modes, modes + self.whole[N_DIRECTIONS]):
            if self.whole[i] == HELD_FAST:
                self.whole[i] = FORWARD

    def prepare(self) -> None:
        """Write what follows from the parameters and modes alone."""
        put_constants(self.w, self.whole)
        if self.whole[N_CONTACTS] > 0:
            ask_here(PREPARE, self.w, self.whole)
            ask_here(RESTORE, self.w, self.whole)

    def at(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the rates (n,) at a state (n,)."""
        self.w[self.first : self.first + self.n] = y.tolist()
        field(self.w[TIME], self.w, self.whole, self.first, self.to)
        return np.array(self.w[self.to : self.to + self.n])

    def along(self, direction: NDArray[Any]) -> NDArray[Any]:
        """Return the Jacobian times a direction (n,), which may be complex."""
        if np.iscomplexobj(direction):
            return self.along(direction.real) + 1j * self.along(direction.imag)
        largest = float((np.abs(direction) / self.sizes).max())
        if largest == 0.0:
            return np.zeros(self.n)
        step = STATE_STEP / largest
        after, before = self.at(self.y + step * direction), self.at(self.y - step * direction)
        return (after - before) / (2.0 * step)


@np.errstate(all="ignore")  # what is no number has no time scale
def fastest_motion(model: Model, inputs: Inputs, record: Record) -> FastestMotion | None:
    """Return the fastest motion of the equations at the end of a run, in its modes or slipping."""
    rates = _Rates(model, record)
    found = _eigen(rates)
    rates.slip()
    slipping = _eigen(rates)
    if found is None or (slipping is not None and abs(slipping[0]) > abs(found[0])):
        found = slipping
    else:
        rates = _Rates(model, record)
    if found is None:
        return None
    value, right, left = found
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
    columns = [rates.along(rates.sizes[i] * unit) for i, unit in enumerate(np.eye(rates.n))]
    scaled = np.array(columns).T / rates.sizes[:, None]
    if not np.isfinite(scaled).all():
        return None
    values, vectors = np.linalg.eig(scaled)
    at = int(np.argmax(np.abs(values)))
    try:
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
    if value == 0.0:
        return 0.0
    sides = []
    for sign in (1.0, -1.0):
        rates.w[place] = value * (1.0 + sign * PARAMETER_STEP)
        rates.prepare()
        sides.append(rates.along(right))
    rates.w[place] = value
    rates.prepare()
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
    steps, events, pieces = (record.whole[place] for place in (STEPS, EVENTS, PIECE))
    t = float(record.w[TIME])
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
    where = f"That was at {quantity(float(record.w[TIME]), 's', 4)}."
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
        f" are told apart to {quantity(math.ulp(float(record.w[TIME])), 's', 2)} there."
    )


def _has_negative_mass(model: Model, record: Record) -> bool:
    """Whether the mass matrix of several contacts, where a run ended, is not positive definite."""
    if record.whole[N_CONTACTS] == 0:
        return False
    rates = _Rates(model, record)
    rates.prepare()
    rates.at(rates.y)
    n, at = rates.whole[N_COORDINATES], rates.whole[MASS]
    masses = np.array(rates.w[at : at + n * n], dtype=float).reshape(n, n)
    return bool(np.isfinite(masses).all() and np.linalg.eigvalsh(masses)[0] <= 0.0)


def cause_of_zeno(events: Sequence[Event], t: float) -> str:
    """Say which events follow one another without time going on."""
    names: list[str] = []
    for event in reversed(events):
        name = f"{event.reason} at {event.contact}" if event.contact else event.reason
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

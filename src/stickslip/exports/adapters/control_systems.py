"""Mechanisms and laws for python-control: nonlinear systems, describing functions."""

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.engine.formulation import Model, formulate
from stickslip.engine.kernels.state_layout import CAN_STICK, NUMBERS, SLIP
from stickslip.engine.simulation import check_pair
from stickslip.engine.solver import Equations, gather
from stickslip.errors import InputError
from stickslip.friction import Friction, FrictionLaw, Laws, PrintedForm, is_bound
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import Sampled
from stickslip.show.display import require_library
from stickslip.show.formatting import joined
from stickslip.study.control import Dynamics, DynamicsOfContacts, place_of

require_library("control", "control")

import control  # noqa: E402  # after the message of where to get it

Array = NDArray[np.float64]
INTEGRAL_TOLERANCE = 1e-12
"""Relative error of the integrals of a describing function."""


class _Field:
    """Time derivatives of the states at any state, without modes."""

    def __init__(self, mechanism: Mechanism, law: Any, model: Model, drive: str, speed: float):
        inputs = gather(mechanism, law, model, 0.0)
        self._equations = Equations(model, inputs)
        self._place = NUMBERS + 3 * model.drives.index(drive)
        header = model.sizes.header
        self._slip, self._band = header[SLIP], speed if header[CAN_STICK] else 0.0

    def __call__(self, t: float, y: Array, u: Array, _: Mapping[str, Any]) -> Array:
        """Return the derivatives (n,)."""
        equations = self._equations
        equations.load_at(t)
        equations.w[self._place] += float(u[0])
        v = float(y[self._slip])
        if abs(v) >= self._band:
            return self._in(1 if v >= 0.0 else -1, t, y)
        share = 0.5 * (1.0 + v / self._band)
        forward, backward = self._in(1, t, y), self._in(-1, t, y)
        return share * forward + (1.0 - share) * backward

    def _in(self, mode: int, t: float, y: Array) -> Array:
        """Return the derivatives in a mode of slip, with friction not below its band's."""
        state = [float(value) for value in y]
        rate = state[self._slip]
        if abs(rate) < self._band:
            state[self._slip] = mode * self._band
        flags = self._equations.flags(t, state)
        found = np.array(self._equations("field", mode, flags, t, state), dtype=np.float64)
        n = self._equations.sizes.coordinates
        found[self._slip - n] = rate
        return found


class _FieldOfContacts:
    """Time derivatives of the states of several contacts at any state, without modes."""

    def __init__(self, mechanism: Mechanism, laws: Laws, model: Model, drive: str, speed: float):
        for contact, law in laws.members:
            if law.states and law.holds:
                raise InputError(
                    "to_nonlinear_system has no states in which a body is held, and the law of"
                    f" {contact!r} has static_switch=True: leave it out, or run it with simulate or"
                    " closed_loop."
                )
        self._mechanism, self._laws, self._speed = mechanism, dict(laws.members), speed
        self._dynamics = DynamicsOfContacts(mechanism, [drive])
        self._bristles = {
            contact: [model.states.index(f"{state}:{contact}") for state in law.states]
            for contact, law in laws.members
        }

    def __call__(self, t: float, y: Array, u: Array, _: Mapping[str, Any]) -> Array:
        """Return the derivatives (n,)."""
        n = len(self._mechanism.coordinates)
        state = [float(value) for value in y]
        here = Dynamics(**self._dynamics.dynamics(self._mechanism, t, state[: 2 * n]))
        slips = here.friction_direction.T @ np.array(state[n : 2 * n])
        bristles = {
            contact: tuple(state[i] for i in self._bristles.get(contact, ()))
            for contact in here.contacts
        }
        constant, factor = np.zeros((2, len(here.contacts)))
        for i, contact in enumerate(here.contacts):
            law = self._laws.get(contact)
            if law is not None:  # friction is affine in the load
                forces = [
                    self._force(law, float(slips[i]), bristles[contact], load)
                    for load in (0.0, 1.0)
                ]
                constant[i], factor[i] = forces[0], forces[1] - forces[0]
        load = here.normal_force(command=u)
        for _again in here.contacts:  # one that nothing presses on does not rub
            free = np.linalg.solve(
                np.eye(len(constant)) - here.normal_by_friction * factor,
                load + here.normal_by_friction @ constant,
            )
            is_open = free < 0.0
            if not np.any(is_open & ((constant != 0.0) | (factor != 0.0))):
                break
            constant[is_open] = factor[is_open] = 0.0
        found = np.zeros(len(state))
        found[:n] = state[n : 2 * n]
        found[n : 2 * n] = here.accelerations(constant + factor * free, u)
        for i, contact in enumerate(here.contacts):
            law = self._laws.get(contact)
            if law is not None and law.states:
                pressed = max(float(free[i]), 0.0)
                rates = law.rates(float(slips[i]), pressed, bristles[contact])
                found[self._bristles[contact]] = [float(rate) for rate in rates]
        return found

    def _force(self, law: FrictionLaw, v: float, z: tuple[float, ...], load: float) -> float:
        """Return the friction force, below the least speed on a line between both directions."""
        if law.states:
            return float(law.force(v, load, z))
        band = self._speed
        if abs(v) >= band:
            return float(law.force(v, load))
        forward, backward = (float(law.force(side * band, load)) for side in (1, -1))
        share = 0.5 * (1.0 + v / band)
        return share * forward + (1.0 - share) * backward


def to_nonlinear_system(
    mechanism: Mechanism,
    law: Friction,
    *,
    drive: str | None = None,
    speed: float = 1e-3,
    name: str | None = None,
) -> "control.NonlinearIOSystem":
    """Return a mechanism with a law as a `control.NonlinearIOSystem`.

    Input is the command of a drive, outputs are the states. Where the body slips faster than
    `speed`, the equations are those of `simulate`. Slower, friction is a straight line between its
    values at both ends: a body that friction would hold creeps instead, at most at `speed`, and
    neither sticks nor breaks away. Switches of the law and saturations jump, and hard stops,
    lift-off and other limits are ignored: `simulate` and `closed_loop` have them exactly.

    Parameters
    ----------
    mechanism : Mechanism
        What moves, without prescribed motions.
    law : FrictionLaw or mapping of str to FrictionLaw
        Friction of its contacts, as in `simulate`. A law with bristles is smooth by itself, and
        `speed` has no effect on it.
    drive : str, optional
        What is commanded, as in `closed_loop`; the only drive if not given. A drive that is there
        stays, and the input is added to it.
    speed : float
        Speed below which friction is a straight line [m/s], or [rad/s].
    name : str, optional
        Name of the system; that of the mechanism if not given.

    Returns
    -------
    control.NonlinearIOSystem
        The system, in continuous time.

    Raises
    ------
    InputError
        If the mechanism has a prescribed motion, `speed` is not above 0, or bristles of one of
        several contacts have a static switch.

    Examples
    --------
    >>> import control
    >>> from stickslip import Axis, CoulombViscous
    >>> law = CoulombViscous(kinetic_coefficient=5.0, viscous_coefficient=30.0)
    >>> axis = to_nonlinear_system(Axis(inertia=5.0), law)
    >>> axis.input_labels, axis.output_labels
    (['drive'], ['x', 'v'])
    >>> control.linearize(axis, [0.0, 0.1], [8.0]).A.round(9)[1].tolist()
    [0.0, -6.0]
    """
    laws = check_pair(mechanism, law)
    if isinstance(laws, PrintedForm):
        raise InputError(f"to_nonlinear_system takes no printed forms, got {law!r}.")
    if mechanism.guided():
        raise InputError(
            f"{type(mechanism).__name__} has a prescribed motion, which nothing can command: give"
            " it a torque or a force instead."
        )
    if not (math.isfinite(speed) and speed > 0.0):
        raise InputError(f"speed [m/s] must be above 0, got {speed!r}.")
    place = place_of(mechanism, drive)
    driven, entry = place.commanded(mechanism, Sampled(times=(0.0,), values=(0.0,)))
    model = formulate(driven, laws)
    if model.latched:
        raise InputError(
            f"to_nonlinear_system asks for rates at a state, and {model.title} has latched"
            " switches, of which no state tells whether they are on: use simulate or closed_loop."
        )
    field: _Field | _FieldOfContacts
    if model.contacts:
        own = (
            laws
            if isinstance(laws, Laws)
            else Laws(members=tuple((contact, laws) for contact in model.contacts))
        )
        field = _FieldOfContacts(driven, own, model, entry, speed)
    else:
        field = _Field(driven, laws, model, entry, speed)
    return control.NonlinearIOSystem(
        field,
        inputs=[place.name.replace(".", "_")],  # python-control allows no dots
        outputs=list(model.states),
        states=list(model.states),
        name=name or mechanism.name,
    )


class DescribingFunction(control.DescribingFunctionNonlinearity):  # type: ignore[misc]
    """Friction over velocity as a nonlinearity of python-control, with its describing function.

    Examples
    --------
    >>> import control
    >>> from stickslip import Coulomb
    >>> friction = to_describing_function(Coulomb(kinetic_coefficient=0.2), load=10.0)
    >>> control.describing_function(friction, [0.5]).round(6)  # 4 F / (pi A)
    array([5.092958+0.j])
    """

    def __init__(self, law: FrictionLaw, load: float) -> None:
        """Take a law; `to_describing_function` checks it.

        Parameters
        ----------
        law : FrictionLaw
            The law.
        load : float
            Normal force [N]; 1 if the levels of the law are forces.
        """
        super().__init__()
        self.law, self.load = law, load

    def __call__(self, A: float) -> float:
        """Return the friction force at a velocity [N]; 0 at rest, where nothing moves it."""
        velocity = float(np.squeeze(A))
        return float(self.law.force(velocity, self.load)) if velocity != 0.0 else 0.0

    @override
    def describing_function(self, A: float) -> float:
        """Return the first harmonic of friction over a sinusoidal velocity of an amplitude.

        Parameters
        ----------
        A : float
            Amplitude of the velocity [m/s].

        Returns
        -------
        float
            Amplitude of the harmonic, in phase with the velocity, over that of the velocity
            [N s/m].

        Raises
        ------
        InputError
            If the amplitude is not above 0.
        """
        from scipy.integrate import quad

        amplitude = float(A)
        if not (math.isfinite(amplitude) and amplitude > 0.0):
            raise InputError(f"the amplitude of the velocity must be above 0, got {A!r}.")

        def along(angle: float) -> float:
            sine = math.sin(angle)
            forward, backward = self(amplitude * sine), self(-amplitude * sine)
            return (forward - backward) * sine

        # what falls steeply from rest does so at small angles
        parts = (0.0, 1e-6, 1e-4, 1e-2, 0.1, 0.5 * math.pi)
        pieces = [
            quad(along, a, b, epsrel=INTEGRAL_TOLERANCE, epsabs=0.0, limit=200)[0]
            for a, b in itertools.pairwise(parts)
        ]
        return 2.0 * math.fsum(pieces) / (math.pi * amplitude)

    @override
    def _isstatic(self) -> bool:
        """Whether it has no memory, which python-control asks."""
        return True


def to_describing_function(law: Friction, *, load: float = 1.0) -> DescribingFunction:
    """Return friction over velocity as a nonlinearity of python-control.

    Parameters
    ----------
    law : FrictionLaw
        A law without bristles, such as ``fit(...).law``.
    load : float
        Normal force [N]; 1 if the levels of the law are forces.

    Returns
    -------
    DescribingFunction
        What `control.describing_function` and `control.describing_function_plot` take. Its input
        is the slip velocity, so the linear system beside it is that from force to velocity.

    Raises
    ------
    InputError
        If the law has bristles: its describing function depends on the frequency too.

    Examples
    --------
    >>> from stickslip import Viscous
    >>> slope = to_describing_function(Viscous(viscous_coefficient=3.0), load=1.0)
    >>> round(slope.describing_function(0.2), 12)
    3.0
    """
    if not isinstance(law, FrictionLaw):
        raise InputError(f"law must be a friction law such as Coulomb(...), got {law!r}.")
    if law.states:
        raise InputError(
            f"{type(law).__name__} has bristles, which remember the motion: its describing function"
            " depends on the frequency too. Give a law without bristles."
        )
    if law.inputs and not is_bound(law):
        values = ", ".join(f"{name!r}: ..." for name in law.inputs)
        raise InputError(
            f"{law.name} depends on {joined(law.inputs)}, and a describing function is that of one"
            f" value: give bound(law, {{{values}}}) from stickslip.friction."
        )
    if not (math.isfinite(load) and load >= 0.0):
        raise InputError(f"load [N] must not be below 0, got {load!r}.")
    return DescribingFunction(law, load)

"""What a friction law is, parameters that several laws share, and laws of several contacts.

A law is set-valued at rest, or carried by the deflection of bristles.
"""

import copy
import dataclasses
import functools
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Self, TypeAlias, TypeVar, final

from typing_extensions import Doc, override

from stickslip.errors import InputError, UndeclaredError, UnknownNameError
from stickslip.maths import Scalar, sign
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.quantities import Group, Parametrised, Quantity, fields_of

# Parameters that several laws share: symbol, unit, range, where fits look for them, meaning.

KineticCoefficient = Annotated[
    float,
    Quantity("mu_k", low=0, scale="level", bounds=(0.0, 100.0), start=1.0),
    Doc("Friction force of sliding over the normal force, without what depends on the speed."),
]
StaticCoefficient = Annotated[
    float,
    Quantity(
        "mu_s", low=0, at_least="kinetic_coefficient", scale="level", bounds=(0.0, 10.0), start=1.1
    ),
    Doc("Friction force over the normal force at vanishing speed and, up to it, at rest."),
]
StribeckVelocity = Annotated[
    float,
    Quantity("v_s", "m/s", above=0, scale="speed", bounds=(1e-3, 1.0), start=0.1),
    Doc("Speed at which the static surplus has faded: to 1/e of it where it fades exponentially."),
]
FadingExponent = Annotated[
    float,
    Quantity("n", above=0, structural=True, scale="none", bounds=(0.3, 5.0), start=1.5),
    Doc("Shape of the fading of the static surplus: 1 Tustin, 2 Gaussian."),
]
ViscousCoefficient = Annotated[
    float,
    Quantity("sigma_2", "N s/m", low=0, scale="slope", bounds=(0.0, 100.0), start=1.0),
    Doc("Growth of the friction force with the slip speed."),
]
ViscousExponent = Annotated[
    float,
    Quantity("p", low=0.2, high=1.5, structural=True, scale="none", bounds=(0.2, 1.5), start=0.6),
    Doc("Power of the speed in the viscous part: 1 is linear, below 1 the lubricant thins."),
]
BristleStiffness = Annotated[
    float,
    Quantity("sigma_0", "1/m", above=0, scale="stiffness", bounds=(1e-2, 1e3), start=1.0),
    Doc("Slope of friction against displacement at the start, over the normal force."),
]
BristleDamping = Annotated[
    float,
    Quantity("sigma_1", "s/m", low=0, scale="damping", bounds=(1e-3, 1e3), start=1.0),
    Doc("Damping of the bristles over the normal force."),
]


@dataclass(frozen=True, kw_only=True)
class Containment:
    """How the parameters of a richer law follow from those of a simpler one that it contains.

    A fit of the richer law that leaves more than one of the simpler law was not searched to its
    end: what it leaves says nothing about the law.

    Parameters of the richer law that are named nowhere have no effect where it is the simpler one,
    such as a Stribeck velocity without a static surplus.
    """

    law: str
    """Registry name of the simpler law."""
    values: Mapping[str, str | float]
    """Parameter of the richer law -> the simpler one's parameter that it equals, or its value."""
    limits: tuple[str, ...] = ()
    """Parameters that go to infinity; none where the richer law is exactly the simpler one."""
    where: Mapping[str, float] = field(default_factory=dict)
    """Values that parameters of the simpler law must have, such as a whole exponent."""

    def embed(self, simpler: "FrictionLaw") -> dict[str, float] | None:
        """Return values of the richer law that make it the simpler one.

        Examples
        --------
        >>> from stickslip import CoulombViscous, Stribeck
        >>> (one,) = [c for c in Stribeck.contained if c.law == "coulomb-viscous"]
        >>> one.embed(CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=3.0))
        {'kinetic_coefficient': 0.2, 'viscous_coefficient': 3.0, 'static_coefficient': 0.2}
        """
        if any(getattr(simpler, name) != value for name, value in self.where.items()):
            return None
        values = {
            name: getattr(simpler, source) if isinstance(source, str) else source
            for name, source in self.values.items()
        }
        return {name: float(value) for name, value in values.items() if value is not None}


@dataclass(frozen=True, kw_only=True)
class Typical:
    """Values of a law: those of a publication, or an example."""

    values: Mapping[str, float]
    """Parameters by name [SI]."""
    source: str = ""
    """Key of `stickslip.friction.classes.SOURCES`; empty if they are an example."""

    def __str__(self) -> str:
        return ", ".join(f"{name} = {value:.6g}" for name, value in self.values.items())


@dataclass(frozen=True, kw_only=True)
class Passivity:
    """Whether a law returns no more energy than it has been given."""

    condition: str
    """``always``, or ``if`` and for which values it is known, with the symbols of the law."""
    holds: Callable[[Any, float], bool]
    """Whether it is known of a law with values, at a load [N]."""


ALWAYS = Passivity(condition="always", holds=lambda _law, _load: True)
"""Friction opposes slip at any speed, or yields as bristles that only take energy up."""


class _Undeclared:
    """Stands for a class attribute that each law has to declare; to ask for it is an error."""

    def __init__(self, example: str) -> None:
        self._example = example
        self._name = ""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, law: object, kind: type) -> Any:
        raise UndeclaredError(
            f"the law {kind.__name__} has no {self._name}: declare it in the class, such as"
            f" {self._name} = {self._example}."
        )


class _RangedParameters:
    """The order of a law that gives none: parameters with a range, exponents if they must be given.

    An exponent with a default keeps it.
    """

    def __get__(self, law: object, kind: type) -> Any:
        # @dataclass asks for the attribute as well, before a class has fields of its own
        made = next(member for member in kind.__mro__ if "__dataclass_fields__" in vars(member))
        given = {
            item.name
            for item in dataclasses.fields(made)
            if item.default is not dataclasses.MISSING
        }
        return tuple(
            name
            for name, quantity in fields_of(made).items()
            if quantity.scale and not (quantity.structural and name in given)
        )


@dataclass(frozen=True, kw_only=True)
class FrictionLaw(Parametrised, ABC):
    """A friction law F(v, N), affine in the load N.

    Friction has the sign of the slip velocity and acts against it. Levels are per unit load: with
    load 1 they read as forces. Equations use `stickslip.maths`, so that one text serves floats,
    arrays and the tracing of the solver.
    """

    name: ClassVar[str] = _Undeclared('"my-law"')  # type: ignore[assignment]  # a descriptor
    """Key in the registry, kebab-case."""
    title: ClassVar[str] = _Undeclared('"My law"')  # type: ignore[assignment]
    """Name in running text."""
    formula: ClassVar[str] = _Undeclared(r'r"F = \mu N"')  # type: ignore[assignment]
    """The law in LaTeX."""
    sources: ClassVar[tuple[str, ...]] = _Undeclared("()")  # type: ignore[assignment]
    """Keys of `stickslip.friction.classes.SOURCES`."""
    fit_order: ClassVar[tuple[str, ...]] = _RangedParameters()  # type: ignore[assignment]
    """Parameters in the order in which scarce data should pay for them.

    If a class gives none, these are its parameters with a range, in the order of the fields,
    without those that shape the equations (exponents).
    """
    composition: ClassVar[Any] = None
    """The parts that it is composed of, whose text `law` reads; None of a law in equations."""
    made_of: ClassVar[Any] = None
    """The composition made ready, with its fields."""
    typical: ClassVar[Typical | None] = None
    """Values as they occur, with their source."""
    passivity: ClassVar[Passivity | None] = None
    """For which values it returns no more energy than it has been given; None if not known."""
    defects: ClassVar[str] = ""
    """What it is known to get wrong."""
    compared: ClassVar[bool] = True
    """Whether its formula was compared with its source, or with a public program of it."""
    on_request: ClassVar[bool] = False
    """Whether it is tried only where it is named: few travels cannot tell it from simpler laws."""
    contained: ClassVar[tuple[Containment, ...]] = ()
    """Simpler laws that it is for some values of its parameters, the nearest first."""
    states: ClassVar[tuple[str, ...]] = ()
    """States of the contact by name, such as deflections of bristles; none without memory."""
    directional: ClassVar[bool] = False
    """Whether the directions of slip have parameters of their own."""
    inputs: ClassVar[tuple[str, ...]] = ()
    """What it asks of the contact beside velocity and load, by name, such as a temperature."""

    @classmethod
    def from_forces(cls, *, load: float, **parameters: Any) -> Self:
        """Make a law of forces [N], stiffness [N/m] and damping [N s/m] measured at a load.

        Parameters
        ----------
        load : float
            Normal force at which the others were measured, above 0 [N].
        **parameters : float
            Parameters of the law: levels as ``kinetic_force`` and its like [N], bristle stiffness
            [N/m] and damping [N s/m]; others as in the law.

        Returns
        -------
        type of the law
            The law with levels, stiffness and damping over the load.

        Raises
        ------
        ParameterError
            If a number is out of its range.

        Examples
        --------
        >>> from stickslip import Dahl
        >>> law = Dahl.from_forces(load=9.81, kinetic_force=2.4525, bristle_stiffness=1e5)
        >>> round(law.kinetic_coefficient, 9), round(law.bristle_stiffness, 3)
        (0.25, 10193.68)
        """
        load = Quantity("N", "N", above=0).check(cls.__name__, "load", load)
        values = {}
        for key, value in parameters.items():
            name, quantity = force_parameters(cls).get(key, (key, None))
            if quantity is None or quantity.unit == fields_of(cls)[name].unit:
                values[name] = value
            else:
                values[name] = quantity.check(cls.__name__, key, value) / load
        return cls(**values)

    @property
    def holds(self) -> bool:
        """Whether a body at rest is held by a force of any size up to break-away."""
        return not self.states

    @abstractmethod
    def force(self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        """Return the friction force at a slip velocity; without memory it is 0 at rest.

        Parameters
        ----------
        velocity : float or array
            Slip velocity [m/s].
        load : float or array
            Normal force [N].
        states : tuple of float or array
            States of the contact, of laws that have them; deflections are in [m].

        Returns
        -------
        float or array
            Friction force, with the sign of the velocity in steady sliding [N].

        Examples
        --------
        >>> from stickslip import Coulomb
        >>> Coulomb(kinetic_coefficient=0.25).force(-0.1, load=9.81)
        -2.4525
        """

    @abstractmethod
    def break_away(self, load: Scalar) -> Scalar:
        """Return the largest force the contact holds at rest, in the direction that holds less.

        Parameters
        ----------
        load : float or array
            Normal force [N].

        Returns
        -------
        float or array
            Break-away level [N].
        """

    def rates(
        self,
        velocity: Scalar,
        load: Scalar,
        states: tuple[Scalar, ...],
    ) -> tuple[Scalar, ...]:
        """Return the time derivatives of the states of the contact, arguments as in `force`.

        Parameters
        ----------
        velocity : float or array
            Slip velocity [m/s].
        load : float or array
            Normal force [N].
        states : tuple of float or array
            States of the contact; deflections are in [m].

        Returns
        -------
        tuple of float or array
            Rates in the order of the states; those of deflections are in [m/s].
        """
        return ()

    def moved(
        self,
        velocity: Scalar,
        load: Scalar,
        states: tuple[Scalar, ...],
        time: Scalar,
    ) -> tuple[Scalar, ...] | None:
        """Return the states of the contact after some time at a constant slip velocity.

        Parameters
        ----------
        velocity : float or array
            Slip velocity [m/s].
        load : float or array
            Normal force [N].
        states : tuple of float or array
            States of the contact before; deflections are in [m].
        time : float or array
            The time [s].

        Returns
        -------
        tuple of float or array, or None
            States after it; None where no formula tells them, and rates are integrated.
        """
        return None

    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        """Return the friction force [N] after long sliding at a constant velocity [m/s].

        Parameters
        ----------
        velocity : float or array
            Slip velocity [m/s].
        load : float or array
            Normal force [N].

        Returns
        -------
        float or array
            Friction force, with the sign of the velocity [N].
        """
        return self.force(velocity, load)

    def towards(self, direction: int) -> "FrictionLaw":
        """Return the law that holds in one direction of slip; most hold in both.

        Parameters
        ----------
        direction : int
            1 forwards, -1 backwards.

        Returns
        -------
        FrictionLaw
            The law itself, unless it is `directional`.
        """
        return self

    def limits(self) -> Mapping[str, Scalar]:
        """Return what ends a run as it falls below 0, by the name of the event.

        Returns
        -------
        mapping of str to float or array
            Such as a factor with which friction would drive instead of braking.
        """
        return {}

    def contact(self, name: str) -> Scalar:
        """Return an input of the contact, for the equations of a law that has `inputs`.

        Parameters
        ----------
        name : str
            One of `inputs`.

        Raises
        ------
        InputError
            If the law has not been bound to its inputs, see `bound`.
        """
        try:
            return vars(self)[BOUND][name]
        except KeyError:
            raise InputError(
                f"the friction law {self.name} depends on {name}, which is not given: bind it,"
                f" bound(law, {{{name!r}: ...}}), or give it in [contact] of the rig file."
            ) from None


BOUND = "_contact"
"""Where a law keeps the inputs of its contact."""
L = TypeVar("L", bound=FrictionLaw)


def bound(law: L, inputs: Mapping[str, Scalar]) -> L:
    """Return a law whose equations see inputs of the contact, such as its temperature."""
    for name in law.inputs:
        if name not in inputs:
            given = ", ".join(inputs) or "none"
            raise InputError(f"the friction law {law.name} depends on {name}; given: {given}.")
    if not law.inputs:
        return law
    # Laws do not change: whoever has this one does not see the inputs.
    twin = copy.copy(law)
    vars(twin)[BOUND] = {name: inputs[name] for name in law.inputs}
    return twin


def anywhere(law: L) -> L:
    """Return a law at usual inputs, for questions whose answer does not depend on these.

    Examples
    --------
    >>> from stickslip.friction import law
    >>> kind = law("level * linear[temperature]")
    >>> warm = kind(kinetic_coefficient=0.2, level_temperature_slope=0.01)
    >>> anywhere(warm).break_away(1.0) > 0.0
    True
    """
    return bound(law, {name: CONTACT_INPUTS[name].size for name in law.inputs})


def is_bound(law: FrictionLaw) -> bool:
    """Whether a law sees inputs of the contact already."""
    return BOUND in vars(law)


@functools.cache
def force_parameters(law: type[FrictionLaw]) -> Mapping[str, tuple[str, Quantity]]:
    """Return what a law takes in forces: key -> the field it becomes, its quantity.

    What the field has in another unit is divided by the load.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> force_parameters(Dahl)["bristle_stiffness"][1].unit
    'N/m'
    """
    result = {}
    for name, quantity in fields_of(law).items():
        is_level = quantity.scale.rstrip("+-") == "level"
        unit = quantity.force_unit
        if unit != quantity.unit or unit.startswith("N"):
            key = name.replace("_coefficient", "_force") if is_level else name
            symbol = quantity.symbol.replace("mu_", "F_") if is_level else quantity.symbol
            # `at_least` names a coefficient, and what is told is a force: the law itself checks it.
            own = dataclasses.replace(quantity, symbol=symbol, unit=unit, at_least=None)
            result[key] = name, own
    return MappingProxyType(result)


@dataclass(frozen=True, kw_only=True)
class SetValuedLaw(FrictionLaw, ABC):
    """A law that is a function of the slip speed, and at rest any force up to break-away."""

    @abstractmethod
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        """Return the magnitude of friction while sliding.

        Parameters
        ----------
        speed : float or array
            Slip speed [m/s], not negative.
        load : float or array
            Normal force [N].

        Returns
        -------
        float or array
            Magnitude of the friction force [N].
        """

    @final
    @override
    def force(self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        return sign(velocity) * self.sliding(abs(velocity), load)


@dataclass(frozen=True, kw_only=True)
class BristleLaw(FrictionLaw, ABC):
    """A law whose contact deflects before it slips: bristles are states of their own."""

    states: ClassVar[tuple[str, ...]] = ("z",)
    """Names of the bristle states."""

    static_switch: bool = False
    """Hold the body when its velocity crosses zero, as long as break-away is not exceeded.

    The switch of the source paper. It suppresses the elastic spring-back that these laws describe,
    and so changes results; the bristles are frozen while the body is held.
    """

    @property
    @override
    def holds(self) -> bool:
        return self.static_switch

    @abstractmethod
    @override
    def rates(
        self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...]
    ) -> tuple[Scalar, ...]:
        """Return the time derivatives of the bristle states, as `FrictionLaw.rates` says."""

    @abstractmethod
    @override
    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        """Return the friction force after long sliding, as `FrictionLaw.steady` says."""


# Laws of several contacts: one for each, or one that all share.

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class Laws(Group):
    """The laws of several contacts by the contacts' names.

    Paths of their parameters have the name of the contact, as in
    ``friction.elbow.kinetic_coefficient``.
    """

    members: tuple[tuple[str, FrictionLaw], ...]
    """Names of contacts, and their laws."""

    @property
    def name(self) -> str:
        """Names of the contacts with those of their laws."""
        return ", ".join(f"{contact}: {name}" for contact, name in self.names.items())

    @property
    def names(self) -> dict[str, str]:
        """Names of the laws by contact."""
        return {contact: law.name for contact, law in self.members}

    @property
    def title(self) -> str:
        """The contacts with their laws in running text."""
        return ", ".join(f"{contact}: {law.title}" for contact, law in self.members)


Friction: TypeAlias = FrictionLaw | Mapping[str, FrictionLaw | None] | Laws
"""One law for all contacts, or laws by the name of the contact; None where nothing rubs."""


def assigned(contacts: tuple[str, ...], law: Friction) -> FrictionLaw | Laws:
    """Return laws by contact, checked; or the one law that a single contact has, or all share.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> laws = assigned(
    ...     ("shoulder", "elbow"),
    ...     {"elbow": Coulomb(kinetic_coefficient=0.1), "shoulder": None},
    ... )
    >>> [name for name, _ in laws.members]
    ['elbow']
    """
    if isinstance(law, FrictionLaw):
        return law
    if isinstance(law, Laws):  # it names those that rub
        law = dict.fromkeys(contacts) | dict(law.members)
    if not isinstance(law, Mapping):
        raise InputError(
            "law must be a FrictionLaw, or a mapping from the names of contacts to laws, got"
            f" {law!r}."
        )
    known = given_to(contacts, law)
    for name, own in known.items():
        if own is not None and not isinstance(own, FrictionLaw):
            raise InputError(f"the law of the contact {name!r} must be a FrictionLaw, got {own!r}.")
    members = tuple((name, friction) for name, friction in known.items() if friction is not None)
    return members[0][1] if len(contacts) == 1 else Laws(members=members)


def given_to(contacts: tuple[str, ...], laws: Mapping[str, T | None]) -> dict[str, T | None]:
    """Return what is given for each contact, in their order.

    Examples
    --------
    >>> given_to(("shoulder", "elbow"), {"elbow": "coulomb", "shoulder": None})
    {'shoulder': None, 'elbow': 'coulomb'}
    """
    for name in laws:
        if name not in contacts:
            raise UnknownNameError("contact", name, contacts)
    missing = [name for name in contacts if name not in laws]
    if missing:
        raise InputError(
            f"no law is given for the contact {missing[0]!r}: add {missing[0]!r}: None if nothing"
            " rubs there."
        )
    if all(laws[name] is None for name in contacts):
        raise InputError(
            "no contact has a law: give one of them a law, with levels of 0 if need be."
        )
    return {name: laws[name] for name in contacts}


def law_of(contact: str, law: FrictionLaw | Laws) -> FrictionLaw | None:
    """Return the law of a contact, None where nothing rubs."""
    return dict(law.members).get(contact) if isinstance(law, Laws) else law


def bristle_names(contacts: tuple[str, ...], law: FrictionLaw | Laws) -> tuple[str, ...]:
    """Return the names of the bristle states; with several contacts, ``z:elbow`` and its like.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> bristle_names(("left", "right"), Dahl(kinetic_coefficient=0.2, bristle_stiffness=1e4))
    ('z:left', 'z:right')
    """
    if len(contacts) == 1:
        own = law_of(contacts[0], law)
        return () if own is None else own.states
    laws = [(name, law_of(name, law)) for name in contacts]
    return tuple(f"{z}:{name}" for name, own in laws if own is not None for z in own.states)

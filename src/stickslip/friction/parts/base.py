"""What a part of a friction law is: a few parameters, one equation, one fragment of LaTeX."""

import functools
import typing
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass
from typing import Any, ClassVar, TypeAlias

from stickslip.maths import Scalar
from stickslip.quantities import Quantity
from stickslip.show.described import marks

Values: TypeAlias = Any
"""The parameters of a law as one of its parts names them, read as attributes."""


@dataclass(frozen=True, kw_only=True)
class Slip:
    """What a part is told of the contact."""

    speed: Scalar
    """Slip speed [m/s], not negative."""
    along: Scalar
    """Slip velocity [m/s]; of a law without memory its speed, because the law is one of speeds."""
    inputs: tuple[Scalar, ...] = ()
    """The contact inputs that the part asks for."""
    rest: Scalar = None
    """Level at rest, over the load, of the curve that a memory is around, at inputs of 0."""
    choose: Callable[[Any, Any], Any] | None = None
    """Chooses between what holds forwards and backwards; None where both are alike."""


@dataclass(frozen=True, kw_only=True)
class Becomes:
    """A simpler part that a part is for some values of its parameters."""

    name: str
    """Name of the simpler part; empty where what stands in its brackets is left."""
    values: Mapping[str, float | str]
    """Values of parameters, or of the simpler part's that they equal, for which it is that part."""
    limits: tuple[str, ...] = ()
    """Parameters that go to infinity for it."""
    argument: str = ""
    """What stands in brackets behind the simpler part; as behind this one if empty."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter as its part declares it."""

    name: str
    hint: Any
    """Its annotation."""
    default: Any
    """`dataclasses.MISSING` if it has none."""

    @property
    def quantity(self) -> Quantity:
        """Its symbol, unit and range."""
        return next(mark for mark in marks(self.hint) if isinstance(mark, Quantity))


class Part(ABC):
    """A part of friction laws.

    Parameters are annotated class attributes, as in a dataclass; a value is their default. In its
    LaTeX, and in symbols and units of parameters, ``{0}`` is the argument.
    """

    name: ClassVar[str]
    """What the notation calls it."""
    title: ClassVar[str] = ""
    """Its name in running text; that of the notation if empty."""
    tex: ClassVar[str]
    """Its term of the formula."""
    tex_where: ClassVar[str] = ""
    """Equations of what stands in it: states, abbreviations."""
    role: ClassVar[str]
    """Where it may stand: level, flow, factor, sign, memory or smooth level."""
    argument: ClassVar[str] = ""
    """What its brackets hold, a number of elements or the contact input; empty if it has none."""
    inputs: ClassVar[tuple[str, ...]] = ()
    """Contact inputs that it always asks for."""
    needs: ClassVar[tuple[str, ...]] = ()
    """Parameters of other parts that it reads, and that have to be there."""
    vanishes: ClassVar[Mapping[str, float | str] | None] = None
    """Values of its parameters, or parameters that they equal, for which it is not there."""
    below: ClassVar[tuple[str, ...]] = ()
    """Parts that are not there without it, for values that these have where they are not."""
    becomes: ClassVar[tuple[Becomes, ...]] = ()
    """Simpler parts that it includes."""
    opposes: ClassVar[bool] = True
    """Whether its force, whatever its values, is against the slip at any speed."""
    compared: ClassVar[bool] = True
    """Whether its formula was compared with its source, or with a public program of it."""
    directional: ClassVar[bool] = False
    """Whether it differs by direction by itself, without ``both_ways`` around it."""

    def one_way(self, side: int) -> str:  # for those that are directional
        """Return what stands in its brackets where it is that of one direction, 1 or -1."""
        return ""

    def of(self, argument: str) -> "Part":  # for those that it shapes
        """Return the part with what stands in its brackets."""
        return self

    @functools.cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """What the class declares, in order."""
        hints = typing.get_type_hints(type(self), include_extras=True)
        return tuple(
            Parameter(name=name, hint=hint, default=getattr(type(self), name, MISSING))
            for name, hint in hints.items()
            if any(isinstance(mark, Quantity) for mark in marks(hint))
        )


class Level(Part, ABC):
    """A part of the level of friction, over the load."""

    role: ClassVar[str] = "level"
    rest: ClassVar[str]
    """Parameter that is the whole level at rest; of several levels the last one."""

    @abstractmethod
    def sliding(self, p: Values, s: Slip) -> Scalar:
        """Return its share of the level while sliding; None if it has none."""


class Extra(Part, ABC):
    """A level on top of the others: what an input of the contact adds."""

    role: ClassVar[str] = "level"
    holds: ClassVar[bool] = True
    """Whether some of it is there at rest."""

    @abstractmethod
    def at_rest(self, p: Values, s: Slip) -> Scalar:
        """Return the level at rest, over the load."""

    def left(self, p: Values, s: Slip) -> Scalar:
        """Return the share of it that is left at a speed."""
        return 1.0 + 0.0 * s.speed  # an array of speeds gives an array

    def sliding(self, p: Values, s: Slip) -> Scalar:
        """Return the level while sliding, over the load."""
        return self.at_rest(p, s) * self.left(p, s)


class Factor(Part, ABC):
    """A number that multiplies parts, or a parameter, as an input of the contact changes."""

    role: ClassVar[str] = "factor"
    argument: ClassVar[str] = "input"
    opposes: ClassVar[bool] = False
    positive_if: ClassVar[str] = ""
    """For which values it does not fall below 0, whatever the input; empty where that is open."""

    @abstractmethod
    def factor(self, p: Values, s: Slip) -> Scalar:
        """Return the number, 1 where the input has no effect."""

    def positive(self, p: Values) -> bool:  # most depend on the input
        """Whether `positive_if` is so: it does not fall below 0, whatever the input."""
        return self.opposes


class Flow(Part, ABC):
    """A force that is 0 at rest and does not depend on the load."""

    role: ClassVar[str] = "flow"

    @abstractmethod
    def flow(self, p: Values, s: Slip) -> Scalar:
        """Return the force [N], with the sign of `s.along`."""


class SmoothLevel(Part, ABC):
    """A level that grows from 0 at rest by a formula of its own."""

    role: ClassVar[str] = "smooth level"

    @abstractmethod
    def sliding(self, p: Values, s: Slip) -> Scalar:
        """Return the level, over the load, at a speed."""


class SmoothSign(Part, ABC):
    """A function of the speed that grows from 0 to 1 and takes the place of the sign."""

    role: ClassVar[str] = "sign"

    @abstractmethod
    def shape(self, p: Values, s: Slip) -> Scalar:
        """Return the share of the level at a speed."""


class Memory(Part, ABC):
    """States of the contact around a level curve g."""

    role: ClassVar[str] = "memory"
    opposes: ClassVar[bool] = False
    drops: ClassVar[bool] = False
    """Whether its force falls at once where a state reaches its limit."""
    limited: ClassVar[bool] = False
    """Whether its states stop at limits, which the level at rest sets."""
    dissipates: ClassVar[bool] = False
    """Whether it only takes energy up, whatever its values and the level around which it is."""
    relaxes: ClassVar[bool] = False
    """Whether its states go on while nothing slips."""
    usual: ClassVar[str] = "level"
    """The level curve that its title does not mention."""

    def states(self, argument: str) -> tuple[str, ...]:
        """Return the names of its states."""
        return ("z",)

    @abstractmethod
    def rates(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> tuple[Scalar, ...]:
        """Return the rates of the states."""

    @abstractmethod
    def force(self, p: Values, s: Slip, z: tuple[Scalar, ...], g: Scalar) -> Scalar:
        """Return the force, over the load."""

    def peak(self, p: Values) -> Scalar:  # most have none
        """Return what slow motion from rest reaches at most, over the level at rest."""
        return 1.0

    def moved(  # most have no formula for it
        self,
        p: Values,
        s: Slip,
        z: tuple[Scalar, ...],
        g: Scalar,
        time: Scalar,
    ) -> tuple[Scalar, ...] | None:
        """Return the states after some time at a constant velocity; None without a formula."""
        return None

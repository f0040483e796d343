"""How well the values of a fitted law are known: intervals, covariance, and what was not fitted."""

import dataclasses
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final, TypeAlias, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.data.measurement import Levels, levels_at
from stickslip.data.tolerances import NEARLY_ALL, NEGLIGIBLE, ROUNDING
from stickslip.errors import InputError, ParameterError, UnknownNameError, check_size
from stickslip.friction import FrictionLaw, Laws
from stickslip.maths import NORMAL_95
from stickslip.mechanisms import Mechanism, slips_by_angle
from stickslip.quantities import Quantity, fields_of, parameters, vary
from stickslip.show.formatting import number

T = TypeVar("T")
Array: TypeAlias = NDArray[np.float64]

LOAD: Final = Quantity("N", "N", above=0)
"""A normal force at which levels are given as forces."""
PREFIX: Final = "friction"
AT_REST: Final = "static_coefficient"
HARD: Final = ("rounding range", "stated interval")
"""Intervals that have an end beyond which the value cannot lie; others are of 95 %."""
KINDS: Final = ("95 %", *HARD)


def unit_on(mechanism: Mechanism, quantity: Quantity) -> str:
    """Return the unit in which a parameter of a law reads on a mechanism.

    A level over the normal force reads as a force where that force is left at 1, and about a pivot
    all are those of torque and angle.

    Examples
    --------
    >>> from stickslip import Axis, Pendulum
    >>> level, viscous = Quantity("mu_k", per_load=True), Quantity("sigma_2", "N s/m")
    >>> unit_on(Axis(inertia=1.0), level), unit_on(Axis(inertia=1.0, load=20.0), level)
    ('N', '1')
    >>> unit_on(Pendulum(mass=1.0, length=0.5), viscous)
    'N m s/rad'
    """
    per_load = levels_at(mechanism) == "per load"
    return quantity.unit_at(per_load=per_load, turning=slips_by_angle(mechanism))


def spread_of(value: float, low: float, high: float, kind: str = "95 %") -> float:
    """Return the standard deviation that an interval stands for.

    The longer side counts of an interval of 95 %: the other may be cut off where values end.

    Examples
    --------
    >>> round(spread_of(0.25, 0.25 - 1.96, 0.25 + 1.96), 3)
    1.0
    >>> round(spread_of(0.5, 0.0, 1.0, "rounding range") ** 2, 4)
    0.0833
    """
    if kind in HARD:
        return (high - low) / math.sqrt(12.0)
    return max(high - value, value - low) / NORMAL_95


@dataclass(frozen=True, kw_only=True)
class LawEstimates:
    """Intervals and covariance of the parameters of one law, or of the laws of several contacts.

    Parameters
    ----------
    law : str or mapping of str to str
        Name of the law; names by contact where contacts have laws of their own. Parameters are then
        called by contact, such as ``elbow.kinetic_coefficient``.
    intervals : mapping of str to tuple of float
        By parameter, lower and upper end of its interval.
    interval : str
        What they are: ``"95 %"``, or ``"rounding range"`` or ``"stated interval"`` of one reading,
        beyond which the value cannot lie.
    covariance_of : tuple of str
        Parameters of the rows and columns of `covariance`.
    covariance : tuple of tuple of float (p, p)
        Of the normal distribution that has these intervals. Where few readings were left over it is
        wider than that of the estimates, as Student's t is. Parameters without a row are
        independent of the others. Of those in `not_identified` it is what holds if this law does.
    not_identified : mapping of str to str
        Parameters that were fitted and that the data do not tell, and why.
    not_fitted : tuple of str
        Parameters that were taken as given or assumed.
    levels : {"per load", "forces", "torques"}
        Whether levels, and stiffness and damping of bristles, are over the normal force, or are
        forces or torques because no normal force was known.
    largest_speed : float or mapping of str to float, optional
        Largest slip speed in what was fitted [m/s] or [rad/s]; by contact where contacts have laws
        of their own.
    overridden : tuple of str
        Those of `not_fitted` that were fitted and whose values were then replaced.
    stated : tuple of str
        Parameters whose interval was not fitted, but stated with their value.

    Raises
    ------
    InputError
        If names, ends or the matrix cannot be used.

    Examples
    --------
    >>> from stickslip import CoulombViscous
    >>> known = LawEstimates(
    ...     law="coulomb-viscous",
    ...     intervals={"kinetic_coefficient": (0.23, 0.27), "viscous_coefficient": (0.1, 0.9)},
    ...     covariance_of=("kinetic_coefficient", "viscous_coefficient"),
    ...     covariance=((1e-4, -1.9e-3), (-1.9e-3, 0.04)),
    ... )
    >>> law = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.5)
    >>> draws = known.draw(law, 200, seed=1)
    >>> {path: values.shape for path, values in draws.items()}
    {'friction.kinetic_coefficient': (200,), 'friction.viscous_coefficient': (200,)}
    >>> bool(np.corrcoef(*draws.values())[0, 1] < -0.9)
    True
    """

    law: str | Mapping[str, str]
    intervals: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    interval: str = "95 %"
    covariance_of: tuple[str, ...] = ()
    covariance: tuple[tuple[float, ...], ...] = ()
    not_identified: Mapping[str, str] = field(default_factory=dict)
    not_fitted: tuple[str, ...] = ()
    levels: Levels = "per load"
    largest_speed: float | Mapping[str, float] | None = None
    overridden: tuple[str, ...] = ()
    stated: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check what can be checked without the law."""
        named = self.law.values() if isinstance(self.law, Mapping) else [self.law]
        if not named or not all(isinstance(name, str) for name in named):
            raise InputError(
                "estimates.law must be the name of a law, or names by contact such as {elbow ="
                f' "coulomb"}}, got {self.law!r}.'
            )
        if self.interval not in KINDS:
            raise UnknownNameError("estimates.interval", self.interval, KINDS)
        if self.levels not in get_args(Levels):
            raise UnknownNameError("estimates.levels", self.levels, get_args(Levels))
        seen: set[str] = set()
        for name in (*self.intervals, *self.not_identified, *self.not_fitted):
            if name in seen:
                raise InputError(
                    f"estimates: {name} is given twice; give it once, in intervals, not_identified"
                    " or not_fitted."
                )
            seen.add(name)
        for name, (low, high) in self.intervals.items():
            if not (math.isfinite(low) and math.isfinite(high) and low <= high):
                raise InputError(
                    f"estimates.intervals.{name} must be two finite numbers, the lower one first,"
                    f" got {low:g} and {high:g}. List a parameter without bounds in"
                    " estimates.not_identified."
                )
        self._check_speeds()
        self._check_covariance()

    def _check_speeds(self) -> None:
        said, contacts = self.largest_speed, isinstance(self.law, Mapping)
        if isinstance(said, Mapping) and not contacts:
            raise InputError(
                f"estimates.largest_speed is given by contact, {', '.join(said)}, but there is one"
                " law: give one number."
            )
        speeds = (
            {f".{name}": value for name, value in said.items()}
            if isinstance(said, Mapping)
            else ({} if said is None else {"": said})
        )
        for name, speed in speeds.items():
            if contacts and name and name[1:] not in self.law:
                raise UnknownNameError("contact in estimates.largest_speed", name[1:], self.law)
            if not (math.isfinite(speed) and speed >= 0.0):
                raise InputError(
                    f"estimates.largest_speed{name} must be at least 0 m/s, or 0 rad/s about an"
                    f" axis, got {speed:g}."
                )

    def of_contact(self, contact: str, *, rotary: bool) -> "LawEstimates":
        """Return what is known of the law of one of several contacts.

        Examples
        --------
        >>> known = LawEstimates(
        ...     law={"elbow": "coulomb", "slide": "coulomb"},
        ...     intervals={"elbow.kinetic_coefficient": (0.9, 1.1)},
        ...     levels="forces",
        ...     largest_speed={"elbow": 2.0, "slide": 0.1},
        ... )
        >>> own = known.of_contact("elbow", rotary=True)
        >>> own.intervals, own.levels, own.largest_speed
        ({'kinetic_coefficient': (0.9, 1.1)}, 'torques', 2.0)
        """
        assert isinstance(self.law, Mapping)  # of laws by contact
        prefix = f"{contact}."

        def own(names: Iterable[str]) -> list[str]:
            return [name for name in names if name.startswith(prefix)]

        def table(values: Mapping[str, T]) -> dict[str, T]:
            return {name.removeprefix(prefix): values[name] for name in own(values)}

        def short(names: Iterable[str]) -> tuple[str, ...]:
            return tuple(name.removeprefix(prefix) for name in own(names))

        speed = self.largest_speed
        return dataclasses.replace(
            self,
            law=self.law[contact],
            intervals=table(self.intervals),
            covariance_of=short(self.covariance_of),
            covariance=self._covariance_among(own(self.covariance_of)),
            not_identified=table(self.not_identified),
            not_fitted=short(self.not_fitted),
            overridden=short(self.overridden),
            levels=self.levels
            if self.levels == "per load"
            else ("torques" if rotary else "forces"),
            largest_speed=speed.get(contact) if isinstance(speed, Mapping) else speed,
        )

    def _covariance_among(self, names: Iterable[str]) -> tuple[tuple[float, ...], ...]:
        """Return the covariance of some parameters: that of the marginal distribution."""
        rows = [self.covariance_of.index(name) for name in names]
        return tuple(tuple(self.covariance[i][j] for j in rows) for i in rows)

    def _check_covariance(self) -> None:
        names = self.covariance_of
        for name in names:
            if name not in self.intervals and name not in self.not_identified:
                known = {**self.intervals, **self.not_identified}
                raise UnknownNameError("estimates.covariance_of", name, known)
        if len(set(names)) < len(names):
            raise InputError(f"estimates.covariance_of must list each name once, got {names}.")
        rows = [len(row) for row in self.covariance]
        if rows != [len(names)] * len(names):
            raise InputError(
                f"estimates.covariance must have {len(names)} rows of {len(names)} numbers, as"
                f" covariance_of names them, got rows of {rows}."
            )
        if not names:
            return
        table = np.array(self.covariance)
        spreads = np.sqrt(np.maximum(np.diag(table), 0.0))
        if not np.all(np.isfinite(table)) or np.any(np.diag(table) < 0.0):
            raise InputError(
                "estimates.covariance must consist of finite numbers, with variances of at least 0"
                f" on its diagonal, got {table.tolist()}."
            )
        # Scaled to variances of 1: tolerances hold whatever the units are.
        scale = np.where(spreads > 0.0, spreads, 1.0)
        scaled = table / np.outer(scale, scale)
        if np.max(np.abs(scaled - scaled.T)) > ROUNDING:
            raise InputError(
                "estimates.covariance must be symmetric; its two halves differ by up to"
                f" {number(np.max(np.abs(table - table.T)))}."
            )
        least = float(np.linalg.eigvalsh(scaled)[0])
        # Rounding in a file may make an eigenvalue a little less than 0.
        if least < -ROUNDING * len(names):
            raise InputError(
                "estimates.covariance must be positive semi-definite; scaled to unit variances,"
                f" its smallest eigenvalue is {number(least)}."
            )

    def checked(self, law: FrictionLaw | Laws) -> "LawEstimates":
        """Return this where it fits a law, or laws by contact; say what does not fit."""
        self._check_laws(law)
        values = _values(law)
        owner = "the laws" if isinstance(law, Laws) else law.name
        for name in (*self.intervals, *self.not_identified, *self.not_fitted):
            if name not in values:
                raise UnknownNameError(f"parameter of {owner} in estimates", name, values)
        for name, (low, high) in self.intervals.items():
            if not low <= values[name] <= high:
                raise ParameterError(
                    f"estimates.intervals.{name}: the value {number(values[name], 6)} lies outside"
                    f" its interval, {number(low, 6)} to {number(high, 6)}. Correct the value, or"
                    " remove the parameter from [estimates]."
                )
        return self

    def _check_laws(self, law: FrictionLaw | Laws) -> None:
        if isinstance(law, Laws) and isinstance(self.law, Mapping):
            known = law.names
            for contact, name in self.law.items():
                if contact not in known:
                    raise UnknownNameError("contact in estimates.law", contact, known)
                if name != known[contact]:
                    raise UnknownNameError(
                        f"law of {contact!r} in estimates", name, [known[contact]]
                    )
        elif isinstance(law, Laws):
            contacts = ", ".join(f'{contact} = "{name}"' for contact, name in law.names.items())
            raise InputError(
                f"estimates.law is {self.law!r}, but contacts have laws of their own: name these,"
                f" as in law = {{ {contacts} }}, and the contacts of parameters."
            )
        elif isinstance(self.law, Mapping):
            raise InputError(
                f"estimates.law names laws by contact, {', '.join(self.law)}, but there is one law:"
                f' write law = "{law.name}".'
            )
        elif law.name != self.law:
            raise UnknownNameError("law in estimates", self.law, [law.name])

    def without(self, names: Sequence[str]) -> "LawEstimates":
        """Return what is known of the other parameters; these have been overridden.

        Examples
        --------
        >>> known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.2, 0.3)})
        >>> changed = known.without(["kinetic_coefficient"])
        >>> changed.not_fitted, changed.overridden
        (('kinetic_coefficient',), ('kinetic_coefficient',))
        """
        mine = [name for name in names if name in self.intervals or name in self.not_identified]
        if not mine:
            return self
        kept = tuple(name for name in self.covariance_of if name not in mine)
        return dataclasses.replace(
            self,
            intervals={k: v for k, v in self.intervals.items() if k not in mine},
            not_identified={k: v for k, v in self.not_identified.items() if k not in mine},
            not_fitted=(*self.not_fitted, *mine),
            overridden=(*self.overridden, *mine),
            covariance_of=kept,
            covariance=self._covariance_among(kept),
        )

    def stating(
        self, law: FrictionLaw | Laws, uncertainties: Mapping[str, float]
    ) -> "LawEstimates":
        """Return the same with stated standard uncertainties of single parameters.

        They are independent of the others. Beside ranges beyond which no value lies, they are the
        even distribution of that standard deviation.

        Examples
        --------
        >>> from stickslip import Coulomb
        >>> known = LawEstimates(law="coulomb", not_fitted=("static_coefficient",))
        >>> law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
        >>> known.stating(law, {"static_coefficient": 0.01}).not_fitted
        ()
        """
        values = _values(law)
        others = self.without(tuple(uncertainties))
        hard = bool(others.intervals) and others.interval in HARD
        # Half the width of an even distribution is sqrt(3) standard deviations.
        reach = math.sqrt(3.0) if hard else NORMAL_95
        intervals = dict(others.intervals)
        for name, doubt in uncertainties.items():
            if name not in values:
                raise UnknownNameError("parameter with an uncertainty", name, values)
            intervals[name] = (values[name] - reach * doubt, values[name] + reach * doubt)
        return dataclasses.replace(
            others,
            intervals=intervals,
            interval=others.interval if hard else KINDS[0],
            not_fitted=tuple(name for name in others.not_fitted if name not in uncertainties),
            overridden=tuple(name for name in others.overridden if name not in uncertainties),
            stated=(*others.stated, *(name for name in uncertainties if name not in others.stated)),
        ).checked(law)

    def scaled(self, factors: Mapping[str, float]) -> "LawEstimates":
        """Return the same with parameters multiplied by factors, per load from now on.

        Examples
        --------
        >>> known = LawEstimates(
        ...     law="coulomb", intervals={"kinetic_coefficient": (2.0, 3.0)}, levels="forces"
        ... )
        >>> known.scaled({"kinetic_coefficient": 0.1}).intervals
        {'kinetic_coefficient': (0.2, 0.30000000000000004)}
        """
        by = [factors.get(name, 1.0) for name in self.covariance_of]
        return dataclasses.replace(
            self,
            intervals={
                name: (factors.get(name, 1.0) * low, factors.get(name, 1.0) * high)
                for name, (low, high) in self.intervals.items()
            },
            covariance=tuple(
                tuple(by[i] * by[j] * x for j, x in enumerate(row))
                for i, row in enumerate(self.covariance)
            ),
            levels="per load",
        )

    @property
    def drawn(self) -> tuple[str, ...]:
        """Parameters that draws vary: those with an interval or a row of the covariance."""
        if self.interval in HARD:
            return tuple(self.intervals)
        return tuple(dict.fromkeys([*self.intervals, *self.covariance_of]))

    @property
    def kept(self) -> tuple[str, ...]:
        """Parameters whose values draws keep."""
        drawn = self.drawn
        return tuple(name for name in (*self.not_fitted, *self.not_identified) if name not in drawn)

    def draw(self, law: FrictionLaw | Laws, count: int, *, seed: int = 0) -> dict[str, Array]:
        """Return values (count,) of the parameters in `drawn`, by full path.

        Normal with the covariance, and independent without one; halves of two normal ones where an
        interval is longer on one side; even between the ends of a rounding range or a stated
        interval. What is not identified has the spread that holds if this law does. Draws outside
        the valid ranges of the law are drawn again. Other parameters keep their values and are not
        among those returned.
        """
        self.checked(law)
        if count < 1:
            raise InputError(f"draws must be 1 or more, got {count}.")
        values, names = _values(law), list(self.drawn)
        if not names:
            raise InputError(self._nothing_to_draw())
        check_size("draws", count * len(names), "draw fewer")
        paths = [f"{PREFIX}.{name}" for name in names]
        random = np.random.default_rng(seed)
        kept: list[Array] = []
        tried = 0
        while len(kept) < count:
            for row in self._proposed(values, names, random, count):
                tried += 1
                if len(kept) < count and _is_valid(
                    law, dict(zip(paths, row.tolist(), strict=True))
                ):
                    kept.append(row)
            # Counted over all that was tried, so that the loop ends where hardly any draw is valid.
            if len(kept) < NEGLIGIBLE * tried:
                raise InputError(
                    f"nearly all samples of {', '.join(names)} are invalid for {law.name}: the"
                    " intervals extend beyond the allowed range of the parameters. Narrow the"
                    " intervals in [estimates]."
                )
        table = np.array(kept)
        return {path: table[:, i] for i, path in enumerate(paths)}

    def _nothing_to_draw(self) -> str:
        """Say why no parameter has an interval."""
        fixed = [name for name in self.not_fitted if name not in self.overridden]
        reasons = [
            f"{', '.join(names)} {what}"
            for names, what in (
                (self.overridden, "overridden"),
                (fixed, "given or assumed"),
                (list(self.not_identified), "not identified"),
            )
            if names
        ]
        why = f" ({'; '.join(reasons)})" if reasons else ""
        cure = (
            "leave the overrides out"
            if self.overridden
            else "fit the law to data that identify a parameter"
        )
        owner = self.law if isinstance(self.law, str) else "the laws"
        return (
            f"no parameter of {owner} has an interval{why}, so no ensemble can be sampled: {cure}."
        )

    def _proposed(
        self, values: Mapping[str, float], names: list[str], random: np.random.Generator, count: int
    ) -> Array:
        ends = np.array([self._ends(name, values[name]) for name in names])
        if self.interval in HARD:
            even: Array = random.uniform(ends[:, 0], ends[:, 1], size=(count, len(names)))
            return even
        centre = np.array([values[name] for name in names])
        # By eigenvectors, and not as Cholesky: a covariance may be singular.
        share, axes = np.linalg.eigh(self._whole(centre, ends, names))
        root = axes * np.sqrt(np.maximum(share, 0.0))
        apart = random.standard_normal((count, len(names))) @ root.T
        sides = np.abs(ends - centre[:, None])
        # The distribution is split at its centre, and each half scaled to the side of its interval.
        share = sides / np.maximum(sides.max(axis=1, keepdims=True), np.finfo(float).tiny)
        share[share > NEARLY_ALL] = 1.0  # a covariance is that of the longer side
        result: Array = centre + apart * np.where(apart < 0.0, share[:, 0], share[:, 1])
        return result

    def _ends(self, name: str, value: float) -> tuple[float, float]:
        """Return the interval of a parameter; without one, that of its row of the covariance."""
        if name in self.intervals:
            return self.intervals[name]
        at = self.covariance_of.index(name)
        half = NORMAL_95 * math.sqrt(max(self.covariance[at][at], 0.0))
        return value - half, value + half

    def _whole(self, centre: Array, ends: Array, names: list[str]) -> Array:
        """Return the covariance of all that have an interval (p, p)."""
        spreads = [
            spread_of(value, low, high)
            for value, (low, high) in zip(centre.tolist(), ends.tolist(), strict=True)
        ]
        table = np.diag(np.square(spreads))
        at = [names.index(name) for name in self.covariance_of]
        if at:
            # Variances of rows stay as they are told; only those without a row come from intervals.
            table[np.ix_(at, at)] = self.covariance
        return table


def equated(law: FrictionLaw) -> dict[str, tuple[str, str]]:
    """Return the level at rest that was not given, by field, with the symbol of what it equals.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> equated(Coulomb(kinetic_coefficient=0.25))
    {'static_coefficient': ('mu_s', 'mu_k')}
    >>> equated(Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3))
    {}
    """
    quantities = fields_of(type(law))
    quantity = quantities.get(AT_REST)
    if quantity is None or quantity.at_least is None or getattr(law, AT_REST) is not None:
        return {}
    return {AT_REST: (quantity.symbol, quantities[quantity.at_least].symbol)}


def _values(law: FrictionLaw | Laws) -> dict[str, float]:
    """Return the parameters of a law, or by contact of laws, without their prefix."""
    return {
        path.removeprefix(f"{PREFIX}."): float(value) for path, _, value in parameters(law, PREFIX)
    }


def _is_valid(law: FrictionLaw | Laws, changes: Mapping[str, float]) -> bool:
    try:
        vary(law, PREFIX, changes)
    except ParameterError:
        return False
    return True

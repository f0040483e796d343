"""A rig: what moves, which friction values are known, and what was measured.

Its mechanism has the values that all trials share. That of one record has what was different in
that record, and is driven by what was recorded.
"""

import html
import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any, Final, Generic, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip import friction, mechanisms
from stickslip.data import estimates
from stickslip.data.estimates import LawEstimates
from stickslip.data.measurement import ELECTRIC, Levels, Measurement, levels_at
from stickslip.data.readers.columns import Reading
from stickslip.data.tolerances import SIX_DIGITS, SLIGHT, SMALL
from stickslip.data.travels import scale_of
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, ParameterError, UnknownNameError, check_size, concerning
from stickslip.friction import FrictionLaw, Laws, anywhere, assigned
from stickslip.mechanisms import Mechanism, slip_names, slips_by_angle, static_normal_force
from stickslip.quantities import Quantity, fields_of, parameters, turned, vary
from stickslip.show.described import Described
from stickslip.show.formatting import joined, number, quantity, span
from stickslip.units import per_second

USUAL = "coulomb"
"""The law that is taken where the values of several are known, and none is named."""


@dataclass(frozen=True, kw_only=True)
class Published:
    """What a publication reports for one law.

    Parameters
    ----------
    law : str
        Name in the registry.
    travel : float, optional
        Published travel [m].
    velocity_positive, displacement_monotone : bool, optional
        Whether the velocity never becomes negative and the displacement never decreases.
    relative_error : float, optional
        Published relative error of the travel [1].
    note : str
        What else is to be said.

    Examples
    --------
    >>> Published(law="coulomb", travel=0.16, relative_error=0.2).travel
    0.16
    """

    law: str
    travel: float | None = None
    velocity_positive: bool | None = None
    displacement_monotone: bool | None = None
    relative_error: float | None = None
    note: str = ""

    def __post_init__(self) -> None:
        """Check that the law is known."""
        friction.law_type(self.law)


@dataclass(frozen=True, kw_only=True)
class KnownLaws:
    """The laws whose values a file gives, for one contact or for all.

    Parameters
    ----------
    laws : mapping of str to FrictionLaw
        By name: the laws all of whose parameters are known.
    named : tuple of str
        Laws that have a table of their own in the file.
    given : mapping of str to mapping of str to float
        By law, the parameters that the file gives, those of laws of which it lacks some included.
    assumed : mapping of str to tuple of str
        By law, the fields whose values are assumed and not measured.
    uncertainties : mapping of str to mapping of str to float
        By law, the standard uncertainties that are stated of single parameters.
    tables : mapping of str to str
        Names of laws by those of their tables, where these differ.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> KnownLaws(laws={"coulomb": Coulomb(kinetic_coefficient=0.2)}).chosen("pad").name
    'coulomb'
    """

    laws: Mapping[str, friction.FrictionLaw] = field(default_factory=dict)
    named: tuple[str, ...] = ()
    given: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    assumed: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    uncertainties: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    tables: Mapping[str, str] = field(default_factory=dict)

    def name_of(self, text: str) -> str:
        """Return the name of a law that is called by its table, or written in other words.

        Parameters
        ----------
        text : str
            What a user calls the law.

        Returns
        -------
        str
            Its name; the text, where nothing here is called so.

        Raises
        ------
        InputError
            If the text is a composition that no law can be.

        Examples
        --------
        >>> known = KnownLaws(tables={"mine": "level + power + drag"})
        >>> known.name_of("mine"), known.name_of("level+viscous"), known.name_of("lugre")
        ('level + power + drag', 'coulomb-viscous', 'lugre')
        """
        name = self.tables.get(text, text)
        return friction.law_type(name).name if friction.is_composition(name) else name

    def chosen(self, contact: str, name: str | None = None) -> friction.FrictionLaw:
        """Return the law of a contact: that of a name, the only one, or the usual one of several.

        Parameters
        ----------
        contact : str
            Name of the contact, for the error.
        name : str, optional
            Name of the law. If not given: the only one with a table of its own, the only one all of
            whose values are known, or ``coulomb``.

        Returns
        -------
        FrictionLaw
            The law.

        Raises
        ------
        InputError
            If there is none, or one of several has to be named.
        """
        name = None if name is None else self.name_of(name)
        for known in (self.named, tuple(self.laws)):
            if name is None and len(known) == 1:
                name = known[0]
        if name is None and USUAL in self.laws:
            name = USUAL
        if name is None and self.laws:
            raise InputError(
                f"the contact {contact!r} has values for several laws, {', '.join(self.laws)}:"
                f" choose one, such as {contact}={next(iter(self.laws))}."
            )
        if name is None or name not in self.laws:
            what = "any law" if name is None else f"the law {name!r}"
            raise InputError(
                f"the contact {contact!r} has no values of {what}: give them under"
                f' [friction.{contact}], or write {contact} = "none" under [friction] if nothing'
                " rubs there."
            )
        return self.laws[name]


@dataclass(frozen=True, kw_only=True)
class Rig(metaclass=Described):
    """A mechanism, the friction values known for it, and its measurement.

    Parameters
    ----------
    title, subject, source : str
        Heading of reports, what was examined, and where it comes from.
    mechanism : Mechanism
        What moves.
    laws : mapping of str to FrictionLaw
        By name: the laws all of whose parameters are known.
    named : tuple of str
        Laws that have a table of their own in the file.
    given : mapping of str to mapping of str to float
        By law, the parameters that the file gives, those of laws of which it lacks some included.
    assumed : mapping of str to tuple of str
        By law, the fields whose values are assumed and not measured.
    law_uncertainties : mapping of str to mapping of str to float
        By law, standard uncertainties that are stated of single parameters; they come before the
        intervals of `estimates`.
    tables : mapping of str to str
        Names of laws by those of their tables, where these differ.
    contacts : mapping of str to KnownLaws or None
        Where several contacts have tables of their own: the same for each of them, None where
        nothing rubs. `laws` is then empty.
    vary : tuple of str
        Parameters of the mechanism that the file marks to be fitted too, by path or last name.
    parameter_uncertainties : mapping of str to float
        Standard uncertainties of parameters of the mechanism, by path or last name; of what a
        trial sets, each trial has one of its own.
    measurement : Measurement, optional
        What was measured, to which the uncertainties are added.
    validate : Measurement, optional
        A second record, which no fit sees.
    reading : Reading
        How the files of the rig's measurements are read.
    hold : {"zero", "first"}, optional
        Whether a measured force keeps its value until the next sample, or goes straight to it;
        estimated from the record if not given. As `RecordSettings.hold`, to which `stickslip
        fit` and `select` hand it.
    tolerance : float, optional
        Share of friction by which the law that is named may be off.
    t_end : float
        Last time of runs [s].
    initial : mapping of str to float
        Values of states from which runs begin [SI], by name; trials have their own.
    estimates : LawEstimates, optional
        How well one of the laws, or those of contacts, are known, if they were fitted.
    published : tuple of Published
        What a publication reports.
    digest : str
        SHA-256 of the file, overrides and the contents of its data files included.
    path : str
        The file.
    files : tuple of Path
        Other files that it names: data, second records, robots.
    overridden : tuple of str
        Paths that overrides set, those of a law under its name.

    Raises
    ------
    InputError
        If the parts do not fit each other.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> Rig(mechanism=SpringBlock(mass=1.0), measurement=Measurement(travel=0.2)).t_end
    10.0
    """

    title: str = ""
    subject: str = ""
    source: str = ""
    mechanism: mechanisms.Mechanism
    laws: Mapping[str, friction.FrictionLaw] = field(default_factory=dict)
    named: tuple[str, ...] = ()
    given: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    assumed: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    law_uncertainties: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    tables: Mapping[str, str] = field(default_factory=dict)
    contacts: Mapping[str, KnownLaws | None] = field(default_factory=dict)
    vary: tuple[str, ...] = ()
    parameter_uncertainties: Mapping[str, float] = field(default_factory=dict)
    measurement: Measurement | None = None
    validate: Measurement | None = None
    reading: Reading = field(default_factory=Reading)
    hold: Literal["zero", "first"] | None = None
    tolerance: float | None = None
    t_end: float = 10.0
    initial: Mapping[str, float] = field(default_factory=dict)
    estimates: LawEstimates | None = None
    published: tuple[Published, ...] = ()
    digest: str = ""
    path: str = ""
    files: tuple[Path, ...] = ()
    overridden: tuple[str, ...] = ()

    @property
    def heading(self) -> str:
        """The title; the kind of mechanism if there is none."""
        return self.title or self.mechanism.title

    def __post_init__(self) -> None:
        """Check that laws, trials and mechanism fit each other."""
        if not isinstance(self.mechanism, mechanisms.Mechanism):
            raise InputError(f"Rig.mechanism must be a Mechanism, got {self.mechanism!r}.")
        t_end = Quantity("t_end", "s", above=0).check("Rig", "t_end", self.t_end)
        object.__setattr__(self, "t_end", t_end)
        for name, law in self.laws.items():
            given: object = law  # whatever the types say
            of_name = isinstance(given, friction.FrictionLaw) and given.name == name
            unlisted = of_name and name not in friction.laws()
            kind = type(law) if unlisted else friction.law_type(name)
            if not isinstance(law, kind):
                raise InputError(f"Rig.laws of {name!r} must be that law, got {law!r}.")
        if self.hold not in (None, "zero", "first"):
            raise InputError(f"Rig.hold must be 'zero' or 'first', got {self.hold!r}.")
        if self.tolerance is not None:
            as_tolerance(self.tolerance, "Rig.tolerance")
        if self.estimates is not None:
            named = estimated_law(self.estimates.law, self.laws, self.contacts)
            self.estimates.checked(named)
        contacts = [contact.name for contact in self.mechanism.contacts()]
        _check_names("contact in Rig.contacts", self.contacts, contacts)
        _check_names("state in Rig.initial", self.initial, state_units(self.mechanism))
        _check_names("law in Rig.assumed", self.assumed, self.laws)
        for name in self.law_uncertainties:
            if name in self.laws:
                self.estimates_of(name)
        paths = tuple(
            name if name == mechanisms.LINKS else mechanisms.canonical_path(self.mechanism, name)
            for name in self.vary
        )
        object.__setattr__(self, "vary", paths)
        stated = self.parameter_uncertainties.items()
        uncertainties = {
            mechanisms.canonical_path(self.mechanism, name): value for name, value in stated
        }
        object.__setattr__(self, "parameter_uncertainties", uncertainties)
        if self.measurement is not None and uncertainties:
            object.__setattr__(self, "measurement", self.with_uncertainties(self.measurement))
        records = () if self.measurement is None else self.measurement.records()
        for index, record in enumerate(records):
            label = f"trial {record.name or index}"
            check_record(self.mechanism, record, label)
            where = record.provenance or label  # its line, in a table of trials
            scale_of(self.mechanism, record, self.t_end, where)

    def name_of(self, text: str) -> str:
        """Return the name of a law, as `KnownLaws.name_of`."""
        return KnownLaws(tables=self.tables).name_of(text)

    def law_by_contact(
        self, names: str | Mapping[str, str] | None = None
    ) -> dict[str, friction.FrictionLaw | None]:
        """Return the law of each of several contacts, as `simulate` takes them.

        Parameters
        ----------
        names : str or mapping of str to str, optional
            Name of the law of all contacts, or names by contact. Where none is given: the only law
            that has a table of its own, the only one all of whose values are known, or
            ``coulomb``.

        Returns
        -------
        dict of str to FrictionLaw or None
            Laws by contact, None where nothing rubs.

        Raises
        ------
        UnknownNameError
            If there is no contact of a name.
        InputError
            If a contact has no such law, or no contact has a table of its own.

        Examples
        --------
        >>> from stickslip import Coulomb, TwoFeet
        >>> known = KnownLaws(laws={"coulomb": Coulomb(kinetic_coefficient=0.2)})
        >>> body = TwoFeet(mass=1.0, front=0.1, rear=0.1)
        >>> laws = Rig(mechanism=body, contacts={"front": known, "rear": None}).law_by_contact()
        >>> laws["front"].kinetic_coefficient, laws["rear"]
        (0.2, None)
        """
        if not self.contacts:
            raise InputError(f"{self.heading} has no laws by contact: see Rig.laws.")
        wanted = names if isinstance(names, Mapping) else dict.fromkeys(self.contacts, names)
        for contact in wanted:
            if contact not in self.contacts:
                raise UnknownNameError("contact", contact, self.contacts)
        try:
            return {
                contact: None if known is None else known.chosen(contact, wanted.get(contact))
                for contact, known in self.contacts.items()
            }
        except InputError as error:
            raise InputError(f"{self.path}: {error}" if self.path else str(error)) from None

    def estimates_of(
        self, name: str, law: friction.FrictionLaw | None = None
    ) -> LawEstimates | None:
        """Return how well a law is known: as it was fitted, and as single parameters are stated.

        Parameters
        ----------
        name : str
            Name of a law.
        law : FrictionLaw, optional
            The law with its values; that of `laws` if not given.

        Returns
        -------
        LawEstimates or None
            None where neither is known.

        Examples
        --------
        >>> from stickslip import Coulomb, SpringBlock
        >>> rig = Rig(
        ...     mechanism=SpringBlock(mass=1.0),
        ...     laws={"coulomb": Coulomb(kinetic_coefficient=0.25)},
        ...     law_uncertainties={"coulomb": {"kinetic_coefficient": 0.01}},
        ... )
        >>> low, high = rig.estimates_of("coulomb").intervals["kinetic_coefficient"]
        >>> round(low, 4), round(high, 4)
        (0.2304, 0.2696)
        """
        known = self.estimates if self.estimates and self.estimates.law == name else None
        stated = self.law_uncertainties.get(name, {})
        if not stated:
            return known
        known = known or LawEstimates(law=name, levels=levels_at(self.mechanism))
        return known.stating(self.laws[name] if law is None else law, stated)

    def with_uncertainties(self, measurement: Measurement) -> Measurement:
        """Return a measurement of this rig with the uncertainties of its mechanism beside its own.

        Examples
        --------
        >>> from stickslip import SpringBlock
        >>> rig = Rig(mechanism=SpringBlock(mass=1.0), parameter_uncertainties={"mass": 0.01})
        >>> rig.with_uncertainties(Measurement(travel=0.2)).parameter_uncertainties
        {'mechanism.mass': 0.01}
        """
        return replace(
            measurement,
            parameter_uncertainties={
                **self.parameter_uncertainties,
                **measurement.parameter_uncertainties,
            },
        )

    def start(self, law: friction.FrictionLaw | friction.Laws) -> dict[str, float]:
        """Return how the first trial, or else the rig, begins; bristles of other laws are left out.

        Parameters
        ----------
        law : FrictionLaw or Laws
            The friction law, or the laws by contact.

        Returns
        -------
        dict of str to float
            Initial values of states [SI] by name; the others are 0.

        Examples
        --------
        >>> from stickslip import Coulomb, SpringBlock
        >>> rig = Rig(mechanism=SpringBlock(mass=1.0), initial={"v": 0.5})
        >>> rig.start(Coulomb(kinetic_coefficient=0.2))
        {'v': 0.5}
        """
        initial = dict(self.initial)
        if self.measurement is not None:
            initial |= self.measurement.records()[0].initial
        bristles = friction.bristle_names(
            tuple(contact.name for contact in self.mechanism.contacts()), law
        )
        known = (*self.mechanism.coordinates, *self.mechanism.rates, *bristles)
        return {name: value for name, value in initial.items() if name in known}

    def _known(self) -> str:
        """Return the names of the laws, by contact where contacts have their own."""
        if not self.contacts:
            return ", ".join(self.laws) or "none"
        return "; ".join(
            f"{contact}: {'none' if known is None else ', '.join(known.laws) or 'none'}"
            for contact, known in self.contacts.items()
        )

    def _lines(self) -> tuple[str, ...]:
        """Return what moves, which laws are known and what was measured, a line each."""
        records = () if self.measurement is None else self.measurement.records()
        what = "" if self.measurement is None else ", ".join(self.measurement.quantities())
        measured = f"{len(records)} with {what}" if records else "none"
        return (
            f"Rig {self.title!r}",
            f"mechanism: {self.mechanism}",
            f"laws: {self._known()}",
            f"records: {measured}",
        )

    def __repr__(self) -> str:
        return "<" + "\n ".join(self._lines()) + ">"

    def _repr_html_(self) -> str:
        return "<p>" + "<br>".join(html.escape(line) for line in self._lines()) + "</p>"


def as_tolerance(value: float | str, called: str = "tolerance") -> float:
    """Return a share of friction by which a law may be off, from a number or a text.

    Examples
    --------
    >>> as_tolerance("5 %"), as_tolerance(0.05)
    (0.05, 0.05)
    >>> as_tolerance("5")
    Traceback (most recent call last):
    stickslip.errors.InputError: tolerance must be a share of friction from 0.001 to 0.5, such as
    0.02 or "2 %", got '5'.
    """
    text = str(value).strip()
    try:
        result = float(text.rstrip("% ")) / (100.0 if text.endswith("%") else 1.0)
    except ValueError:
        result = math.nan
    if not 0.001 <= result <= 0.5:
        raise InputError(
            f"{called} must be a share of friction from 0.001 to 0.5, such as 0.02 or"
            f' "2 %", got {value!r}.'
        )
    return result


def estimated_law(
    named: str | Mapping[str, str],
    known: Mapping[str, friction.FrictionLaw],
    contacts: Mapping[str, KnownLaws | None],
) -> friction.FrictionLaw | friction.Laws:
    """Return the law that estimates name, or those that they name by contact."""
    rubbing = {name: own for name, own in contacts.items() if own is not None}
    if rubbing:
        names = named if isinstance(named, Mapping) else dict.fromkeys(rubbing, named)
        _check_names("contact in estimates.law", names, rubbing)
        return friction.Laws(
            members=tuple((name, rubbing[name].chosen(name, law)) for name, law in names.items())
        )
    if not isinstance(named, str):
        raise InputError(
            f"estimates.law names laws by contact, {', '.join(named)}, but no contact has a table"
            ' of its own: name one law, such as law = "coulomb".'
        )
    _check_names("law in estimates.law", [named], known)
    return known[named]


def _check_names(kind: str, given: Iterable[str], known: Collection[str]) -> None:
    for name in given:
        if name not in known:
            raise UnknownNameError(kind, name, known)


def state_units(mechanism: mechanisms.Mechanism) -> dict[str, str]:
    """Return the units of all states a trial may start from, bristles of all laws included.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> [state_units(SpringBlock(mass=1.0))[name] for name in ("z", "x", "v")]
    ['m', 'm', 'm/s']
    """
    units = {state: "m" for law in friction.listed().values() for state in law.states}
    contacts = mechanism.contacts()
    if len(contacts) > 1:
        units = {f"{z}:{contact.name}": unit for z, unit in units.items() for contact in contacts}
    units |= dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    return units | dict(zip(mechanism.rates, map(per_second, mechanism.units), strict=True))


def check_record(mechanism: mechanisms.Mechanism, record: Measurement, label: str) -> None:
    """Check that what a record overrides and starts from exists in the mechanism."""
    for path in record.overrides:
        mechanisms.quantity_at(mechanism, path)
    with concerning(f"{label}:"):
        vary(mechanism, mechanisms.PREFIX, record.overrides)
    if record.initial:
        _check_names(f"state in initial of {label}:", record.initial, state_units(mechanism))


# The mechanism of a record: with what was different in it, and driven by what was recorded.

Array = NDArray[np.float64]


COMMANDS = ("force", *ELECTRIC, "reference")
"""What may have driven a record; the first of those that it has is what acts."""


def command_of(record: Measurement) -> str:
    """Return the name of what drives a record; empty if it moves by itself.

    Examples
    --------
    >>> command_of(Measurement(time=[0, 1], position=[0, 1], voltage=[6, 6], reference=[1, 1]))
    'voltage'
    """
    known = record.quantities()
    return next((name for name in COMMANDS if name in known), "")


def as_recorded(mechanism: mechanisms.Mechanism, record: Measurement) -> mechanisms.Mechanism:
    """Return a mechanism as it was in a record; its motor takes what was recorded as its command.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms import DCMotor
    >>> servo = Axis(inertia=1.0, drive=DCMotor(resistance=2.0, torque_constant=0.5, supply=7.4))
    >>> record = Measurement(
    ...     time=[0, 1], position=[0, 1], voltage=[6, 6], overrides={"mechanism.inertia": 2.0}
    ... )
    >>> one = as_recorded(servo, record)
    >>> one.inertia, one.drive.supply
    (2.0, None)
    """
    what = command_of(record)
    if record.overrides:
        mechanism = vary(mechanism, "mechanism", record.overrides)
    motor: Any = mechanisms.motor_of(mechanism)
    if motor is None:
        if what in ELECTRIC:
            raise InputError(
                f"a record of the {what} of a motor needs that motor: give"
                f" {type(mechanism).__name__} a DCMotor as its drive"
                ' (in a rig file, drive = { type = "dc-motor", ... }), or the force.'
            )
        return mechanism
    if what == "force":
        raise InputError(
            f"the record has a force, and {type(mechanism).__name__} a motor, which takes a"
            " current, a voltage or a reference: leave out the force, or the motor, whose rotor is"
            " then part of the inertia."
        )
    return replace(mechanism, drive=_taking(motor, what))  # type: ignore[call-arg]  # it has one


def _taking(motor: mechanisms.DCMotor, what: str) -> mechanisms.DCMotor:
    """Return a motor whose command is what was recorded."""
    if what == "current":
        return replace(motor, loop=mechanisms.CurrentLoop(), supply=None, supply_resistance=None)
    if what == "voltage":  # limited already, but by no droop
        limited = motor.supply_resistance is not None
        return replace(motor, loop=None, supply=motor.supply if limited else None)
    if what == "reference" and not isinstance(
        motor.loop, mechanisms.PositionLoop | mechanisms.SampledLoop
    ):
        raise InputError(
            "a record with a reference, and neither voltage nor current, is one of a position loop:"
            " give the DCMotor this loop, PositionLoop(gain=...) in V/rad or SampledLoop(...)."
        )
    return motor


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopSamples:
    """What a loop that samples saw in a record: goals and positions at its samples."""

    time: Array
    """Times (n,) [s] of the record at which it samples."""
    goal: Array
    """Goals (n,)."""
    position: Array
    """Measured positions (n,)."""

    @lru_cache(maxsize=8)  # noqa: B019  # a few values of few records, which fits ask for again
    def commands(
        self, loop: mechanisms.SampledLoop, limit: float
    ) -> tuple[Array, tuple[mechanisms.LoopMemory, ...]]:
        """Return the voltages (n,) [V] of a loop and what it remembers before each sample."""
        memory: mechanisms.LoopMemory = None
        result, memories = [], [memory]
        for goal, position in zip(self.goal.tolist(), self.position.tolist(), strict=True):
            voltage, memory = loop.sampled(goal, position, memory, limit=limit)
            result.append(voltage)
            memories.append(memory)
        return np.array(result), tuple(memories)


def loop_samples(
    mechanism: mechanisms.Mechanism, record: Measurement, hold: str
) -> LoopSamples | None:
    """Return what the loop of a motor saw in a record that it drives; None if none that samples.

    It samples from the first time of the record on. Goals are held between rows unless `hold` says
    ``"first"``, and positions go straight.
    """
    motor = mechanisms.motor_of(mechanism)
    loop = None if motor is None else motor.loop
    if not isinstance(loop, mechanisms.SampledLoop) or command_of(record) != "reference":
        return None
    if "position" not in record.quantities() or len(mechanism.coordinates) != 1:
        raise InputError(
            "a fit through a SampledLoop needs the recorded position, and a mechanism of one"
            f" coordinate: {type(mechanism).__name__} has {len(mechanism.coordinates)}."
        )
    t, goal = np.asarray(record.time), np.asarray(record.values("reference"))
    check_size("samples of a loop", float(np.ptp(t)) / loop.period, "give a longer period")
    times = t[0] + loop.period * np.arange(math.floor(np.ptp(t) / loop.period + SIX_DIGITS) + 1)
    last = np.maximum(np.searchsorted(t, times + SIX_DIGITS * loop.period, side="right") - 1, 0)
    return LoopSamples(
        time=times,
        goal=np.interp(times, t, goal) if hold == "first" else goal[last],
        position=np.interp(times, t, np.asarray(record.values("position"))),
    )


def with_voltage(mechanism: mechanisms.Mechanism, record: Measurement) -> Measurement:
    """Return a record with the voltage that a loop which samples made of what it measured.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.mechanisms import DCMotor, SampledLoop
    >>> loop = SampledLoop(gain=10.0, period=0.1)
    >>> servo = Axis(inertia=1.0, drive=DCMotor(resistance=2.0, torque_constant=0.5, loop=loop))
    >>> record = Measurement(time=[0, 0.1, 0.2], position=[0, 0.1, 0.2], reference=[0.3] * 3)
    >>> with_voltage(servo, record).values("voltage").round(9).tolist()
    [3.0, 2.0, 1.0]
    """
    set_up = as_recorded(mechanism, record)
    seen = loop_samples(set_up, record, "zero")
    if seen is None:
        return record
    motor: Any = mechanisms.motor_of(set_up)
    voltages, _ = seen.commands(motor.loop, motor.largest_voltage)
    acts = seen.time + motor.loop.delay
    last = np.searchsorted(
        acts, np.asarray(record.time) + SIX_DIGITS * motor.loop.period, side="right"
    )
    return replace(record, voltage=np.where(last > 0, voltages[np.maximum(last - 1, 0)], 0.0))


# A fitted law on another mechanism, what does not carry over, and where a run extrapolates.

BRISTLES: Final = {"stiffness", "damping"}
"""Sizes in the scale of parameters of bristles."""
SPEEDS: Final = (-0.1, 1e-3, 0.1, 1.0)
"""Speeds [m/s] at which a law over the normal force is compared with the same in forces."""
RUN_TIMES: Final = 4001
"""Evenly spaced times at which the extremes of a run are sought, beside the solver's own."""


Friction = TypeVar("Friction", FrictionLaw, Laws)


@dataclass(frozen=True, kw_only=True)
class CarriedLaw(Generic[Friction]):
    """A law, or laws by contact, for a mechanism, and where it is from."""

    law: Friction
    """The law, its levels over the normal force where the mechanism has one; or those by contact.
    """
    estimates: estimates.LawEstimates | None
    """How well it is known, if its file says so."""
    remarks: tuple[str, ...]
    """What does not carry over to this mechanism, in sentences; symbols between dollar signs."""
    source: str
    """The file it is from."""
    fitted_on: Mechanism
    """The mechanism of that file."""


def carried_by_contact(
    rig: Rig, mechanism: Mechanism, *, names: str | Mapping[str, str] | None = None
) -> CarriedLaw[Laws]:
    """Return the laws of a rig's contacts as they are on another mechanism with these contacts.

    Examples
    --------
    >>> from stickslip import BlockChain, Coulomb
    >>> from stickslip.data import KnownLaws
    >>> known = KnownLaws(laws={"coulomb": Coulomb(kinetic_coefficient=0.2)})
    >>> chain = BlockChain(blocks=2, mass=1.0, coupling=100.0)
    >>> rig = Rig(mechanism=chain, contacts={"block-1": known, "block-2": None}, path="law.toml")
    >>> carried_by_contact(rig, chain).law.names
    {'block-1': 'coulomb'}
    """
    here = [contact.name for contact in mechanism.contacts()]
    if not rig.contacts:
        raise InputError(
            f"{rig.path} has no laws by contact, but {mechanism.name} has {', '.join(here)}: write"
            f" the values into tables such as [friction.{here[0]}]."
        )
    if set(here) != set(rig.contacts):
        raise InputError(
            f"{rig.path} has laws of {', '.join(rig.contacts)}, but {mechanism.name} has"
            f" {', '.join(here)}: rename its tables to those of these contacts, with"
            ' "none" under [friction] where nothing rubs.'
        )
    there, own = levels_at(rig.mechanism), levels_at(mechanism)
    if there != own:
        raise InputError(
            f"{rig.path}: the levels of its laws are {_said(there)}, and those of"
            f" {mechanism.name} are {_said(own)}: write the values into tables such as"
            f" [friction.{here[0]}] of {mechanism.name}."
        )
    result = assigned(tuple(here), rig.law_by_contact(names))
    assert isinstance(result, Laws)  # of several contacts
    known = estimates_by_contact(rig, result)
    # Levels at rest that nobody measured are said of each contact.
    rest = [
        f"{contact}: {sentence}" for contact, law in result.members for sentence in _about_rest(law)
    ]
    remarks = (*rest, *_about_doubt(result, known))
    return CarriedLaw(
        law=result, estimates=known, remarks=remarks, source=rig.path, fitted_on=rig.mechanism
    )


def estimates_by_contact(rig: Rig, laws: Laws) -> estimates.LawEstimates | None:
    """Return how well laws by contact are known; None where a rig's estimates are of others."""
    known = rig.estimates
    named = {} if known is None or isinstance(known.law, str) else known.law
    # Estimates of another law say nothing of these.
    known = known if named and named.items() <= laws.names.items() else None
    stated = {
        f"{contact}.{name}": doubt
        for contact, law in laws.members
        if (own := rig.contacts.get(contact)) is not None
        for name, doubt in own.uncertainties.get(law.name, {}).items()
    }
    if not stated:
        return known
    known = known or estimates.LawEstimates(law=laws.names, levels=levels_at(rig.mechanism))
    return known.stating(laws, stated)


def carried(
    rig: Rig, mechanism: Mechanism, *, law: str | None = None, load: float | None = None
) -> CarriedLaw[FrictionLaw]:
    """Return a law of a rig as it is on another mechanism.

    Levels over the normal force carry over. Levels that are forces, because the rig's normal force
    was not known, do so only where they are divided by it.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, SpringBlock
    >>> axis = Rig(
    ...     mechanism=Axis(inertia=1.0),
    ...     laws={"coulomb": Coulomb(kinetic_coefficient=5.0)},
    ...     path="law.toml",
    ... )
    >>> carried(axis, SpringBlock(mass=1.0), load=20.0).law
    Coulomb(kinetic_coefficient=0.25, static_coefficient=None)
    >>> carried(axis, SpringBlock(mass=1.0))  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    stickslip.errors.InputError: law.toml: the levels of coulomb are forces, ...
    """
    name = _name(rig, law)
    result, known = rig.laws[name], rig.estimates_of(name)
    levels = levels_at(rig.mechanism) if known is None else known.levels
    divided = _per_load(result)
    here = levels_at(mechanism)
    remarks: list[str] = []
    if load is not None:
        load = _checked_load(rig, levels, load)
        # Only what is over the load: viscous coefficients and rates stay as they are.
        factors = dict.fromkeys(divided, 1.0 / load)
        changes = {f"friction.{name}": factors[name] * x for name, x in divided.items()}
        divided_law = vary(result, "friction", changes)
        _check_divided(rig, result, divided_law, load)
        result = divided_law
        known = None if known is None else known.scaled(factors)
        remarks.append(
            f"The levels were forces and are divided by the given load of {quantity(load, 'N')}."
        )
    elif divided and levels != "per load" and here == "per load":
        raise InputError(_refusal(rig, name, levels))
    elif divided and here != "per load":
        remarks += _about_unit_load(mechanism, levels, here)
    remarks += _about_viscosity(result, known, slips_by_angle(rig.mechanism))
    if here == "per load":
        remarks += _about_bristles(result, slips_by_angle(mechanism))
    remarks += [*_about_rest(result), *_about_doubt(result, known)]
    return CarriedLaw(
        law=result,
        estimates=known,
        remarks=tuple(remarks),
        source=rig.path,
        fitted_on=rig.mechanism,
    )


def extrapolations(
    law: CarriedLaw[FrictionLaw], mechanism: Mechanism, run: Trajectory
) -> tuple[str, ...]:
    """Return where a run leaves the speeds and normal forces at which its law was fitted.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, SpringBlock, simulate
    >>> from stickslip.data import LawEstimates
    >>> block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> known = LawEstimates(law="coulomb", largest_speed=0.5)
    >>> rig = Rig(
    ...     mechanism=Axis(inertia=1.0, load=20.0),
    ...     laws={"coulomb": Coulomb(kinetic_coefficient=0.25)},
    ...     estimates=known,
    ... )
    >>> law = carried(rig, block)
    >>> for sentence in extrapolations(law, block, simulate(block, law.law, t_end=1.0)):
    ...     print(sentence)
    The run reaches 0.755 m/s; the law was fitted up to 0.5 m/s and is ...
    The law was fitted at a normal force of 20 N; in this run it is 9.81 N, ...
    """
    known = law.estimates
    # Stated uncertainties without a range of speeds are no fit.
    fitted = known is not None and not (known.stated and known.largest_speed is None)
    if law.fitted_on is mechanism and not fitted:
        return ()
    said = []
    _, rate = slip_names(mechanism)
    # Ends of steps too: extremes of speed lie between even times.
    seen = run.at(np.union1d(np.linspace(*run.span, RUN_TIMES), run.t))
    speed, unit = float(np.abs(seen[rate]).max()), run.units[rate]
    most = None if known is None else known.largest_speed
    assert not isinstance(most, Mapping)  # that of one contact
    if most is not None and speed > (1.0 + SLIGHT) * most:
        said.append(
            f"The run reaches {quantity(speed, unit)}; the law was fitted up to"
            f" {quantity(most, unit)} and is extrapolated beyond that."
        )
    # A load that is 1 for want of a better one is no load to compare.
    both_known = levels_at(law.fitted_on) == levels_at(mechanism) == "per load"
    if (
        both_known
        # Without a level nothing is proportional to the load.
        and anywhere(law.law).break_away(1.0) > 0.0
        and len(law.fitted_on.contacts()) == 1
    ):
        load, forces = static_normal_force(law.fitted_on), seen["normal_force"]
        low, high = float(forces.min()), float(forces.max())
        if low * (1.0 + SLIGHT) < load or high > (1.0 + SLIGHT) * load:
            origin = "was fitted at" if known is not None else "is from a contact with"
            said.append(
                f"The law {origin} a normal force of {quantity(load, 'N')}; in this run it is"
                f" {span(low, high, 'N')}, and friction is taken to be in proportion to it."
            )
    return tuple(said)


def unfitted_bristles(
    law: FrictionLaw, known: estimates.LawEstimates | None, distance: float, mechanism: Mechanism
) -> tuple[str, ...]:
    """Return the bristle parameters that decide a distance and that no measurement determined.

    A contact that gives way elastically moves by up to twice its break-away level over its
    stiffness as the force on it reverses. They decide distances of which that is a tenth or more.

    Examples
    --------
    >>> from stickslip import Dahl, SpringBlock
    >>> law, block = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e4), SpringBlock(mass=1.0)
    >>> unfitted_bristles(law, None, 1e-4, block)
    ('$sigma_0$ = 10,000 1/m',)
    >>> unfitted_bristles(law, None, 0.2, block)
    ()
    """
    result = [
        (path.removeprefix("friction."), known_quantity, value)
        for path, known_quantity, value in parameters(law, "friction")
        if _is_of_bristles(known_quantity) and value
    ]
    stiffness = [
        value for _, known_quantity, value in result if known_quantity.scale == "stiffness"
    ]
    fitted = () if known is None else known.intervals
    if not stiffness or distance == 0.0:
        return ()
    # Break-away over stiffness on both sides of 0: the way from held back to held forth.
    give = 2.0 * float(anywhere(law).break_away(1.0)) / min(stiffness)
    if give < SMALL * abs(distance):
        return ()
    return tuple(
        f"${measured.symbol}$ = {quantity(value, estimates.unit_on(mechanism, measured))}"
        for name, measured, value in result
        if name not in fitted
    )


def bristle_remark(
    law: FrictionLaw,
    known: estimates.LawEstimates | None,
    distances: Mapping[str, float],
    mechanism: Mechanism,
) -> str:
    """Return which distances rest on bristles that no measurement determined, as a sentence.

    Examples
    --------
    >>> from stickslip import Dahl, SpringBlock
    >>> law = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e4)
    >>> lengths = {"travel": 0.2, "back-slip": 5e-5}
    >>> bristle_remark(law, None, lengths, SpringBlock(mass=1.0))
    'The back-slip of 50 µm depends on bristle parameters that were not measured: ...
    """
    unit = turned("m", slips_by_angle(mechanism))
    result = {
        f"{name} of {quantity(size, unit)}": symbols
        for name, size in distances.items()
        if (symbols := unfitted_bristles(law, known, size, mechanism))
    }
    if not result:
        return ""
    depend = "depends" if len(result) == 1 else "depend"
    (symbols, *_) = result.values()
    return (
        f"The {joined(list(result))} {depend} on bristle parameters that were not measured:"
        f" {joined(list(symbols))}."
    )


def _name(rig: Rig, law: str | None) -> str:
    if rig.contacts:
        raise InputError(
            f"{rig.path} has laws by contact, of {', '.join(rig.contacts)}, which a mechanism with"
            " one contact cannot take: write the values of one into a table such as"
            " [friction.coulomb]."
        )
    if law is not None:
        name = rig.name_of(law)
        if name not in rig.laws:
            if name in rig.named or name in rig.given:
                raise InputError(
                    f"{rig.path}: the law {law} lacks values: fit it first, with `stickslip fit"
                    f" {rig.path} --law {law} -o law.toml`, and give that file, or write all values"
                    " into its table."
                )
            called = {table for table, key in rig.tables.items() if key in rig.laws}
            raise UnknownNameError(f"law of {rig.path}:", law, {*rig.laws, *called})
        return name
    # The one that the file names, else the one that it has.
    for known in (rig.named, tuple(rig.laws)):
        if len(known) == 1 and known[0] in rig.laws:
            return known[0]
    if not rig.laws:
        raise InputError(
            f"{rig.path} has no law: a file for --law needs a table such as [friction.coulomb], as"
            " in the law.toml of `stickslip select` and of `stickslip fit -o law.toml`."
        )
    raise InputError(
        f"{rig.path} has several laws, {', '.join(rig.laws)}: choose one, such as"
        f" {rig.path}:{next(iter(rig.laws))}."
    )


def _per_load(law: FrictionLaw) -> dict[str, float]:
    """Return what is over the normal force, by field; shapes, shares and rates are not."""
    quantities = fields_of(type(law))
    return {
        name: float(getattr(law, name))
        for name, known_quantity in quantities.items()
        if known_quantity.per_load and getattr(law, name)
    }


def _check_divided(rig: Rig, forces: FrictionLaw, law: FrictionLaw, load: float) -> None:
    """Refuse a law of another package that does not say all that is over the normal force."""
    before, after = anywhere(forces), anywhere(law)
    # At several speeds: levels, fading and viscosity all have to fit.
    for speed in SPEEDS:
        wanted, got = float(before.steady(speed, 1.0)), float(after.steady(speed, load))
        if abs(got - wanted) > SIX_DIGITS * abs(wanted):
            silent = [name for name, measured in fields_of(type(law)).items() if not measured.scale]
            raise InputError(
                f"{rig.path}: the levels of {law.name} cannot be divided by {quantity(load, 'N')}:"
                f" its friction at {quantity(speed, 'm/s')} would be {quantity(got, 'N')} instead"
                f" of {quantity(wanted, 'N')}. Declare per_load=True in the Quantity of each"
                f" parameter that is over the normal force; {joined(silent) or 'none'} has no scale"
                " that tells."
            )


def _is_of_bristles(quantity: Quantity) -> bool:
    return quantity.per_load and not BRISTLES.isdisjoint(quantity.powers)


def _checked_load(rig: Rig, levels: Levels, load: float) -> float:
    result = estimates.LOAD.check("carried", "load", load)
    if levels == "per load":
        raise ParameterError(
            f"{rig.path}: the levels of its law are already coefficients (per normal force); leave"
            " --law-load out."
        )
    if levels == "torques":
        raise InputError(f"{_torques(rig)}, or leave --law-load out.")
    return result


def _refusal(rig: Rig, name: str, levels: Levels) -> str:
    if levels == "torques":
        return f"{_torques(rig)}."
    return (
        f"{rig.path}: the levels of {name} are forces, because the load of its"
        f" {type(rig.mechanism).__name__} is 1 (normal force unknown). Forces do not apply to a"
        " body with another normal force: give the normal force at which the law was measured,"
        ' such as --law-load "50 N" (in Python load=50.0), by which the levels are divided.'
    )


def _torques(rig: Rig) -> str:
    return (
        f"{rig.path}: the levels of its law are torques about an axis, and the radius at which it"
        " rubs is not known. A coefficient is the torque divided by normal force and radius: write"
        " it into a separate rig file"
    )


def _about_unit_load(mechanism: Mechanism, levels: Levels, here: Levels) -> list[str]:
    kind = type(mechanism).__name__
    if levels == "per load":
        return [
            f"The load of the {kind} is 1: its friction is the coefficient times 1 N. If the"
            " normal force is another, set mechanism.load."
        ]
    if levels != here:
        return [f"Levels were fitted as {levels}; here they are used unchanged as {here}."]
    return []


def _values(law: FrictionLaw, turning: bool, wanted: Callable[[Quantity], bool]) -> list[str]:
    """Return the wanted parameters of a law that are not 0, with their values, in words."""
    return [
        f"${known_quantity.symbol}$ = {number(value)} {turned(known_quantity.unit, turning)}"
        for _, known_quantity, value in parameters(law, "friction")
        if wanted(known_quantity) and value
    ]


def _about_viscosity(
    law: FrictionLaw, known: estimates.LawEstimates | None, turning: bool
) -> list[str]:
    result = _values(law, turning, lambda known_quantity: known_quantity.unit.startswith("N"))
    if not result:
        return []
    speed = known.largest_speed if known is not None else None
    assert not isinstance(speed, Mapping)  # that of one contact
    unit = turned("m/s", turning)
    reach = "" if speed is None else f", and was fitted up to {quantity(speed, unit)}"
    are = "applies" if len(result) == 1 else "apply"
    return [
        f"{joined(result)} {are} to the contact of the fit: viscous friction does not scale with"
        f" the normal force in this law{reach}."
    ]


def _about_bristles(law: FrictionLaw, turning: bool) -> list[str]:
    result = _values(law, turning, _is_of_bristles)
    if not result:
        return []
    are = "is" if len(result) == 1 else "are"
    return [
        f"{joined(result)} {are} per normal force: the bristles are assumed to stiffen in"
        " proportion to it, which was not tested."
    ]


def _about_rest(law: FrictionLaw) -> list[str]:
    return [
        f"${own}$ was neither measured nor given: it is set equal to ${other}$."
        for own, other in estimates.equated(law).values()
    ]


def _said(levels: Levels) -> str:
    return "coefficients" if levels == "per load" else levels


def _about_doubt(law: FrictionLaw | Laws, known: estimates.LawEstimates | None) -> list[str]:
    if known is None:
        return []
    symbols, values = {}, {}
    for path, known_quantity, value in parameters(law, "friction"):
        name = path.removeprefix("friction.")
        contact = name.rpartition(".")[0]
        symbols[name] = f"${known_quantity.symbol}$" + (f" of {contact}" if contact else "")
        values[name] = value
    said = []
    assumed = [
        name for name in known.not_fitted if values.get(name) and name not in known.overridden
    ]
    if assumed:
        were = "was" if len(assumed) == 1 else "were"
        names = joined([symbols[name] for name in assumed])
        said.append(f"{names} {were} given or assumed, not fitted.")
    said += [
        f"{symbols[name]} is not identified ({reason}): other values fit as well."
        for name, reason in known.not_identified.items()
    ]
    return said

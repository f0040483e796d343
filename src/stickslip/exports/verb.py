"""Exports a law to another program."""

import contextlib
import dataclasses
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from stickslip import data, mechanisms
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError, StickslipError, UnknownNameError
from stickslip.exports.joints import Mjcf, Urdf
from stickslip.exports.program import Export, Subject, Target, identifier
from stickslip.exports.targets import CCode, CsvTable, JsonDocument, Matlab
from stickslip.friction import FrictionLaw, Laws, bound
from stickslip.identify import Verdict
from stickslip.identify.fits import Fit
from stickslip.mechanisms.contact_inputs import CONTACT_INPUTS
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Given, Quantity, named, turned

if TYPE_CHECKING:
    Source: TypeAlias = FrictionLaw | Fit[Any] | Verdict[Any] | data.Rig

TARGETS: Final[Mapping[str, Target]] = MappingProxyType(
    {
        target.name: target
        for target in (CCode(), Matlab(), Mjcf(), Urdf(), CsvTable(), JsonDocument())
    }
)
"""What a law can be exported to."""

SPEED = Quantity("v_max", "m/s", above=0)
"""End of a range of speeds along a line; about an axis, in rad/s."""
SAMPLES = 2001
"""Evenly spaced times at which the largest speed of a run is sought, beside the solver's own."""


def export(
    source: "Source",
    to: str,
    *,
    name: str | None = None,
    law: str | None = None,
    contact: str | None = None,
    load: float | None = None,
    largest_speed: Given | None = None,
    law_load: float | None = None,
    rig: data.Rig | None = None,
    rotary: bool | None = None,
    at: Mapping[str, Given] | None = None,
) -> Export:
    r"""Return a friction law as files of another program.

    Targets are ``"c"`` (C99), ``"matlab"`` (MATLAB, Simulink, GNU Octave), ``"mjcf"``
    (MuJoCo), ``"urdf"``, ``"csv"`` (a lookup table) and ``"json"``. The files are the same for the
    same law, whenever they are made.

    Parameters
    ----------
    source : FrictionLaw, Fit, Verdict or Rig
        The law, or what has it: of a verdict it is the law to use. `load_rig` reads a ``law.toml``.
    to : str
        Name of the target.
    name : str, optional
        What the program is called; the name of the law if not given. Characters that a name of a
        program cannot have become underscores.
    law : str, optional
        Which of the laws of a rig.
    contact : str, optional
        Whose law, where several contacts have their own.
    load : float, optional
        Normal force [N] at which tables and joints have their friction; that of the mechanism at
        rest if not given.
    largest_speed : float or str, optional
        End of the range of speeds, in m/s or rad/s, of tables, and over which the friction of a
        joint is adapted to the law; a number or a text with its unit. If not given: that of a run
        of the rig, or of the fit.
    law_load : float, optional
        Normal force [N] at which the law was fitted, if its levels are forces: they are divided by
        it.
    rig : Rig, optional
        On which the law is used: of joints, the effect of their simplified friction on it is
        computed.
    rotary : bool, optional
        Of a law itself, given without a rig: whether it is of a rotary axis, so that its levels are
        torques [N m] and speeds are in rad/s; linear if not given. All else says what it turns.
    at : mapping of str to float or str, optional
        Contact inputs of the law, such as ``{"temperature": "35 degC"}``, at which tables and
        joints have their friction; what the mechanism was given, or a fit's record had in the
        median, if not given. Programs have arguments for them.

    Returns
    -------
    Export
        The files, to be written by `Export.save`.

    Raises
    ------
    InputError
        If there is no such target or law, or a target needs a load or a speed that is not known.

    Examples
    --------
    >>> from stickslip import CoulombViscous, export
    >>> law = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.4)
    >>> found = export(law, "mjcf", name="slide", load=20.0, largest_speed=0.5)
    >>> found.remarks[0]
    'Least squares over speeds up to 0.5 m/s leave 0 N at most and 0 N rms.'
    """
    if to == "fmu":
        raise InputError(
            "an FMU is of a mechanism with its law:"
            " stickslip.exports.export_fmu(mechanism, law, path, t_end=...)."
        )
    target: Target = named(TARGETS, to, "target")
    given = Usage(
        law=law,
        contact=contact,
        load=load,
        largest_speed=largest_speed,
        law_load=law_load,
        rotary=rotary,
        at=at or {},
    )
    return target.export(
        subject_of(source, target.title, given, evaluates=target.evaluates, name=name, rig=rig)
    )


@dataclasses.dataclass(frozen=True, kw_only=True)
class Usage:
    """Which law of a source, and where it is evaluated: arguments of `export`."""

    law: str | None = None
    contact: str | None = None
    load: float | None = None
    largest_speed: Given | None = None
    law_load: float | None = None
    rotary: bool | None = None
    at: Mapping[str, Given] = dataclasses.field(default_factory=dict)


def subject_of(
    source: "Source",
    title: str,
    usage: Usage,
    *,
    evaluates: bool,
    name: str | None = None,
    rig: data.Rig | None,
) -> Subject:
    """Return the law of a source as a target takes it, evaluated at its contact inputs or not."""
    rotary, law_load = usage.rotary, usage.law_load
    if rotary is not None and (rig is not None or not isinstance(source, FrictionLaw)):
        raise InputError(
            f"rotary={rotary} is for a law without a mechanism: leave it out, the mechanism says it"
            " (of an Axis, its field rotary)."
        )
    found = _taken(source, usage, rig)
    used = dataclasses.replace(
        found,
        name=identifier(name if name is not None else found.law.name),
        load=_load(found, law_load if usage.load is None and rig is None else usage.load),
        largest_speed=_speed(found, usage.largest_speed),
    )
    if name is not None and not any(character.isalnum() for character in name):
        raise InputError(f"the name of a program needs a letter or a digit, got {name!r}.")
    if evaluates:
        return evaluated(used, title, usage.at)
    _check_inputs(used.law, usage.at)
    if usage.at:
        raise InputError(
            f"{title} has an argument for each contact input ({', '.join(used.law.inputs)}):"
            " leave --at out (in Python at)."
        )
    return used


def evaluated(subject: Subject, title: str, given: Mapping[str, Given]) -> Subject:
    """Return a law at its contact inputs: those that are given, or that its mechanism tells."""
    law, body = subject.law, subject.mechanism
    _check_inputs(law, given)
    known: dict[str, float] = {}
    for name in law.inputs:
        unit = data.unit_of_input(name, turning=subject.rotary)
        quantity = CONTACT_INPUTS[name].quantity(unit)
        fields = [mechanisms.input_field(key, name) for key in (subject.contact, "")]
        own = next((getattr(body, field) for field in fields if hasattr(body, field)), None)
        value = given.get(name, own)
        if value is None or isinstance(value, Drive):
            raise InputError(
                f"{title} has the friction at one value of each contact input, and"
                f" {law.name} depends on {name}: give it, as --at {name}=... in"
                f" {quantity.unit} (in Python at={{{name!r}: ...}})."
            )
        known[name] = quantity.check("export.at", name, value)
    return dataclasses.replace(subject, law=bound(law, known), at=known)


def _check_inputs(law: FrictionLaw, given: Mapping[str, Given]) -> None:
    for name in given:
        if name not in law.inputs:
            raise UnknownNameError(f"contact input of {law.name}", name, law.inputs)


def law_or_rig(source: "Source") -> FrictionLaw | data.Rig:
    """Return a law as it is, and a rig with its law for all that has one."""
    if isinstance(source, Verdict):
        if source.best is None or source.best.fit is None:
            raise InputError(
                f"this verdict names no law to export: {source.sentence} Export the fit of a"
                " candidate, such as verdict.candidates[0].fit."
            )
        return law_or_rig(source.best.fit)
    if not isinstance(source, Fit):
        return source
    fitted: object = source.law
    if isinstance(fitted, Laws):
        own: dict[str, Any] = {"contacts": {name: _known(law) for name, law in fitted.members}}
    elif isinstance(fitted, FrictionLaw):
        own = {"laws": {fitted.name: fitted}, "named": (fitted.name,)}
    else:
        raise InputError(
            f"{getattr(fitted, 'title', fitted)} cannot be exported: the logarithm of the speed"
            " knows no rest. `to_dict()` of the fit has its numbers."
        )
    return data.Rig(mechanism=source.mechanism, estimates=source.law_estimates(), **own)


def _known(law: FrictionLaw) -> data.KnownLaws:
    return data.KnownLaws(laws={law.name: law}, named=(law.name,))


def laws_by_contact(rig: data.Rig, law: str | None = None) -> dict[str, FrictionLaw]:
    """Return the laws of the contacts that have their own; `law` names one where there are more."""
    return {name: part for name, part in rig.law_by_contact(law).items() if part is not None}


def _taken(given: "Source", usage: Usage, rig: data.Rig | None) -> Subject:
    """Return the law of what was given."""
    source, contact = law_or_rig(given), usage.contact
    if isinstance(source, data.Rig) and source.contacts:
        return _of_contact(
            laws_by_contact(source, usage.law), source.estimates, source.mechanism, contact
        )
    if not isinstance(source, data.Rig | FrictionLaw):
        raise InputError(f"export takes a friction law, a fit, a verdict or a rig, got {source!r}.")
    if contact is not None:
        raise InputError(
            f"contact={contact!r} chooses between laws by contact, but this is one law: leave it"
            " out."
        )
    if isinstance(source, data.Rig):
        return _carried(source, usage.law, rig, usage.law_load)
    if usage.law is not None or usage.law_load is not None:
        raise InputError(
            "law and law_load choose and divide the law of a rig: leave them out for a law itself."
        )
    if rig is None:
        levels: data.Levels = "torques" if usage.rotary else "per load"
        return Subject(law=source, name="", rotary=bool(usage.rotary), levels=levels)
    return Subject(
        law=source,
        name="",
        rig=rig,
        mechanism=rig.mechanism,
        rotary=mechanisms.slips_by_angle(rig.mechanism),
        levels=data.levels_at(rig.mechanism),
    )


def _carried(
    source: data.Rig, law: str | None, rig: data.Rig | None, law_load: float | None
) -> Subject:
    onto = source.mechanism if rig is None else rig.mechanism
    found: data.CarriedLaw = data.carried(source, onto, law=law, load=law_load)
    origin = Path(source.path).name
    if origin and source.digest:
        origin = f"{origin}, SHA-256 {source.digest}"
    known = found.estimates
    levels = data.levels_at(onto) if known is None else known.levels
    return Subject(
        law=found.law,
        name="",
        estimates=known,
        mechanism=onto,
        rotary=mechanisms.slips_by_angle(onto),
        levels=levels if law_load is None else "per load",
        source=origin,
        rig=rig,
        own_rig=source if source.path and len(source.mechanism.contacts()) == 1 else None,
    )


def _of_contact(
    laws: dict[str, FrictionLaw],
    known: data.LawEstimates | None,
    mechanism: mechanisms.Mechanism,
    contact: str | None,
) -> Subject:
    """Return the law of one of several contacts, with what is known of it."""
    if contact is None:
        raise InputError(
            f"{mechanism.title} has laws by contact, {', '.join(laws)}: choose one with --contact"
            f" (in Python contact={next(iter(laws), '')!r})."
        )
    if contact not in laws:
        raise UnknownNameError("contact with a law", contact, laws)
    (place,) = (one for one in mechanism.contacts() if one.name == contact)
    rotary = mechanisms.slips_by_angle(mechanism, place)
    said = data.LawEstimates(law={contact: laws[contact].name}, levels=data.levels_at(mechanism))
    if known is not None and not isinstance(known.law, str) and contact in known.law:
        said = known
    own = said.of_contact(contact, rotary=rotary)
    return Subject(
        law=laws[contact],
        name="",
        estimates=own if said is known else None,
        mechanism=mechanism,
        contact=contact,
        rotary=rotary,
        levels=own.levels,
    )


def _load(subject: Subject, given: float | None) -> float | None:
    if given is not None:
        if subject.levels != "per load":
            forces = subject.levels == "forces"
            cure = ", or divide them by --law-load (in Python law_load)" if forces else ""
            raise InputError(
                f"--load (in Python load): the levels of {subject.law.name} are {subject.levels},"
                f" which have no normal force: leave it out{cure}."
            )
        return data.LOAD.check("export", "load", given)
    if subject.levels != "per load":
        return 1.0
    mechanism = subject.mechanism
    if mechanism is None or len(mechanism.contacts()) != 1:
        return None
    return mechanisms.static_normal_force(mechanism)


def _speed(subject: Subject, given: Given | None) -> float | None:
    if given is not None:
        quantity = dataclasses.replace(SPEED, unit=turned(SPEED.unit, subject.rotary))
        return quantity.check("export", "largest_speed", given)
    if subject.rig is not None and len(subject.rig.mechanism.contacts()) == 1:
        fastest = _fastest(subject, subject.rig)
        if fastest is not None:
            return fastest
    known = None if subject.estimates is None else subject.estimates.largest_speed
    assert not isinstance(known, Mapping)  # that of one contact
    if known is None and subject.own_rig is not None:
        with contextlib.suppress(StickslipError):  # nobody has asked for a run of it
            return _fastest(subject, subject.own_rig)
    return known


def _fastest(subject: Subject, rig: data.Rig) -> float | None:
    """Return the largest slip speed of a rig with a law; None where nothing moves."""
    _, rate = mechanisms.slip_names(rig.mechanism)
    run = simulate(rig.mechanism, subject.law, t_end=rig.t_end, y0=rig.start(subject.law))
    times = np.union1d(np.linspace(0.0, rig.t_end, SAMPLES), run.t)
    return float(np.abs(run.at(times)[rate]).max()) or None

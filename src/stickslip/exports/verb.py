"""Exports a law to another program."""

import contextlib
import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from stickslip.errors import InputError, StickslipError, UnknownNameError
from stickslip.experiments import LOAD, CarriedLaw, LawEstimates, Rig, carried, levels_at
from stickslip.exports.base import Export, Target
from stickslip.exports.identifiers import identifier
from stickslip.exports.registry import TARGETS
from stickslip.exports.subject import Subject
from stickslip.friction import FrictionLaw, Laws
from stickslip.identification import Fit
from stickslip.mechanisms import Mechanism, slip_names, static_normal_force
from stickslip.quantities import Quantity, named
from stickslip.selection import Verdict
from stickslip.simulation import simulate

if TYPE_CHECKING:
    Source: TypeAlias = FrictionLaw | Fit[Any] | Verdict[Any] | Rig

__all__ = ["export"]

SPEED = Quantity("v_max", "m/s", above=0)
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
    largest_speed: float | None = None,
    law_load: float | None = None,
    rig: Rig | None = None,
) -> Export:
    r"""Return a friction law as files of another program.

    Targets are ``"c"`` (C99), ``"matlab"`` (MATLAB, Simulink, GNU Octave), ``"modelica"``,
    ``"mjcf"`` (MuJoCo), ``"urdf"``, ``"csv"`` (a lookup table) and ``"json"``. The files are the
    same for the same law, whenever they are made.

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
    largest_speed : float, optional
        End of the range of speeds [m/s] of tables, and over which the friction of a joint is
        adapted to the law. If not given: that of a run of the rig, or of the fit.
    law_load : float, optional
        Normal force [N] at which the law was fitted, if its levels are forces: they are divided by
        it.
    rig : Rig, optional
        On which the law is used: of joints, the effect of their simplified friction on it is
        computed.

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
    found = _taken(source, law, contact, rig, law_load)
    used = dataclasses.replace(
        found,
        name=identifier(name if name is not None else found.law.name),
        load=_load(found, law_load if load is None and rig is None else load),
        largest_speed=_speed(found, largest_speed),
    )
    if name is not None and not any(character.isalnum() for character in name):
        raise InputError(f"the name of a program needs a letter or a digit, got {name!r}.")
    return target.export(used)


def _taken(
    source: "Source",
    law: str | None,
    contact: str | None,
    rig: Rig | None,
    law_load: float | None,
) -> Subject:
    """Return the law of what was given."""
    if isinstance(source, Verdict):
        if source.best is None or source.best.fit is None:
            raise InputError(
                f"this verdict names no law to export: {source.sentence} Export the fit of a"
                " candidate, such as verdict.candidates[0].fit."
            )
        source = source.best.fit
    if isinstance(source, Fit):
        fitted = source.law
        if isinstance(fitted, Laws):
            return _of_contact(
                dict(fitted.members), source.law_estimates(), source.mechanism, contact
            )
        source = _as_rig(fitted, source)
    if isinstance(source, Rig):
        if source.contacts:
            given = {one: found for one, found in source.law_by_contact(law).items() if found}
            return _of_contact(given, source.estimates, source.mechanism, contact)
        _refuse_contact(contact)
        return _carried(source, law, rig, law_load)
    if not isinstance(source, FrictionLaw):
        raise InputError(f"export takes a friction law, a fit, a verdict or a rig, got {source!r}.")
    _refuse_contact(contact)
    if law is not None or law_load is not None:
        raise InputError(
            "law and law_load choose and divide the law of a rig: leave them out for a law itself."
        )
    return Subject(
        law=source,
        name="",
        rig=rig,
        mechanism=None if rig is None else rig.mechanism,
        levels="per load" if rig is None else levels_at(rig.mechanism),
    )


def _as_rig(fitted: object, fit: Fit[Any]) -> Rig:
    if not isinstance(fitted, FrictionLaw):
        raise InputError(
            f"{getattr(fitted, 'title', fitted)} cannot be exported: the logarithm of the speed"
            " knows no rest. `to_dict()` of the fit has its numbers."
        )
    return Rig(
        mechanism=fit.mechanism,
        laws={fitted.name: fitted},
        named=(fitted.name,),
        estimates=fit.law_estimates(),
    )


def _carried(source: Rig, law: str | None, rig: Rig | None, law_load: float | None) -> Subject:
    onto = source.mechanism if rig is None else rig.mechanism
    found: CarriedLaw = carried(source, onto, law=law, load=law_load)
    origin = Path(source.path).name
    if origin and source.digest:
        origin = f"{origin}, SHA-256 {source.digest}"
    known = found.estimates
    levels = levels_at(onto) if known is None else known.levels
    return Subject(
        law=found.law,
        name="",
        estimates=known,
        mechanism=onto,
        levels=levels if law_load is None else "per load",
        source=origin,
        rig=rig,
        own_rig=source if source.path and len(source.mechanism.contacts()) == 1 else None,
    )


def _refuse_contact(contact: str | None) -> None:
    if contact is not None:
        raise InputError(
            f"contact={contact!r} chooses between laws by contact, but this is one law: leave it"
            " out."
        )


def _of_contact(
    laws: dict[str, FrictionLaw],
    known: LawEstimates | None,
    mechanism: Mechanism,
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
    own = None
    if known is not None and not isinstance(known.law, str) and contact in known.law:
        own = _estimates_of(known, contact)
    levels = levels_at(mechanism) if own is None else own.levels
    return Subject(law=laws[contact], name="", estimates=own, mechanism=mechanism, levels=levels)


def _estimates_of(known: LawEstimates, contact: str) -> LawEstimates:
    prefix = f"{contact}."
    assert not isinstance(known.law, str)  # of laws by contact

    def inside(names: Any) -> list[str]:
        return [one for one in names if one.startswith(prefix)]

    kept = inside(known.covariance_of)
    rows = [known.covariance_of.index(one) for one in kept]
    return dataclasses.replace(
        known,
        law=known.law[contact],
        intervals={
            one.removeprefix(prefix): known.intervals[one] for one in inside(known.intervals)
        },
        covariance_of=tuple(one.removeprefix(prefix) for one in kept),
        covariance=tuple(tuple(known.covariance[i][j] for j in rows) for i in rows),
        not_identified={
            one.removeprefix(prefix): known.not_identified[one]
            for one in inside(known.not_identified)
        },
        not_fitted=tuple(one.removeprefix(prefix) for one in inside(known.not_fitted)),
        overridden=tuple(one.removeprefix(prefix) for one in inside(known.overridden)),
    )


def _load(subject: Subject, given: float | None) -> float | None:
    if given is not None:
        if subject.levels != "per load":
            raise InputError(
                f"load: the levels of {subject.law.name} are {subject.levels}, which have no normal"
                " force: leave it out, or divide them by law_load."
            )
        return LOAD.check("export", "load", given)
    if subject.levels != "per load":
        return 1.0
    mechanism = subject.mechanism
    if mechanism is None or len(mechanism.contacts()) != 1:
        return None
    return static_normal_force(mechanism)


def _speed(subject: Subject, given: float | None) -> float | None:
    if given is not None:
        return SPEED.check("export", "largest_speed", given)
    if subject.rig is not None and len(subject.rig.mechanism.contacts()) == 1:
        return _fastest(subject, subject.rig)
    known = None if subject.estimates is None else subject.estimates.largest_speed
    if known is None and subject.own_rig is not None:
        with contextlib.suppress(StickslipError):  # nobody has asked for a run of it
            return _fastest(subject, subject.own_rig)
    return known


def _fastest(subject: Subject, rig: Rig) -> float | None:
    """Return the largest slip speed of a rig with a law; None where nothing moves."""
    _, rate = slip_names(rig.mechanism)
    run = simulate(rig.mechanism, subject.law, t_end=rig.t_end, y0=rig.start(subject.law))
    times = np.union1d(np.linspace(0.0, rig.t_end, SAMPLES), run.t)
    return float(np.abs(run.at(times)[rate]).max()) or None

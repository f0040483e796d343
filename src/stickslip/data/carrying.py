"""A fitted law on another mechanism, what does not carry over, and where a run extrapolates."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

import numpy as np

from stickslip.data import estimates
from stickslip.data.measurement import Levels, levels_at
from stickslip.data.rig import Rig
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import FrictionLaw, Laws, anywhere, assigned
from stickslip.mechanisms import Mechanism, slip_names, slips_by_angle, static_normal_force
from stickslip.quantities import Quantity, fields_of, parameters, turned, vary
from stickslip.show.formatting import joined, number, quantity, span

BRISTLES: Final = {"stiffness", "damping"}
"""Sizes in the scale of parameters of bristles."""
SPEEDS: Final = (-0.1, 1e-3, 0.1, 1.0)
"""Speeds [m/s] at which a law over the normal force is compared with the same in forces."""
FRICTION_TOLERANCE: Final = 1e-6
"""How far apart both may be, over the friction: beyond rounding, which offsets of speeds leave."""
SAMPLES: Final = 4001
"""Evenly spaced times at which the extremes of a run are sought, beside the solver's own."""
BEYOND: Final = 1.05
"""Ratio to the range of the fit above which a run counts as outside of it: 5 % of speed or of
normal force change no law by more than its parameters are known."""
DECIDES: Final = 0.1
"""Share of a distance that the elastic give of a contact makes up, above which it decides it."""


@dataclass(frozen=True, kw_only=True)
class CarriedLaw:
    """A law for a mechanism, and where it is from."""

    law: FrictionLaw
    """The law, its levels over the normal force where the mechanism has one."""
    estimates: estimates.LawEstimates | None
    """How well it is known, if its file says so."""
    remarks: tuple[str, ...]
    """What does not carry over to this mechanism, in sentences; symbols between dollar signs."""
    source: str
    """The file it is from."""
    fitted_on: Mechanism
    """The mechanism of that file."""


@dataclass(frozen=True, kw_only=True)
class CarriedLaws:
    """Laws by contact for a mechanism, and where they are from."""

    laws: Laws
    """The laws of the contacts that rub."""
    estimates: estimates.LawEstimates | None
    """How well they are known, if their file says so."""
    remarks: tuple[str, ...]
    """What does not carry over to this mechanism, in sentences; symbols between dollar signs."""
    source: str
    """The file they are from."""


def carried_by_contact(
    rig: Rig, mechanism: Mechanism, *, names: str | Mapping[str, str] | None = None
) -> CarriedLaws:
    """Return the laws of a rig's contacts as they are on another mechanism with these contacts.

    Examples
    --------
    >>> from stickslip import BlockChain, Coulomb
    >>> from stickslip.data import KnownLaws
    >>> known = KnownLaws(laws={"coulomb": Coulomb(kinetic_coefficient=0.2)})
    >>> chain = BlockChain(blocks=2, mass=1.0, coupling=100.0)
    >>> rig = Rig(mechanism=chain, contacts={"block-1": known, "block-2": None}, path="law.toml")
    >>> carried_by_contact(rig, chain).laws.names
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
    found = assigned(tuple(here), rig.law_by_contact(names))
    assert isinstance(found, Laws)  # of several contacts
    known = estimates_by_contact(rig, found)
    # Levels at rest that nobody measured are said of each contact.
    rest = [
        f"{contact}: {sentence}" for contact, law in found.members for sentence in _about_rest(law)
    ]
    remarks = (*rest, *_about_doubt(found, known))
    return CarriedLaws(laws=found, estimates=known, remarks=remarks, source=rig.path)


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
) -> CarriedLaw:
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
    found, known = rig.laws[name], rig.estimates_of(name)
    levels = levels_at(rig.mechanism) if known is None else known.levels
    divided = _per_load(found)
    here = levels_at(mechanism)
    remarks: list[str] = []
    if load is not None:
        load = _checked_load(rig, levels, load)
        # Only what is over the load: viscous coefficients and rates stay as they are.
        factors = dict.fromkeys(divided, 1.0 / load)
        changes = {f"friction.{name}": factors[name] * x for name, x in divided.items()}
        divided_law = vary(found, "friction", changes)
        _check_divided(rig, found, divided_law, load)
        found = divided_law
        known = None if known is None else known.scaled(factors)
        remarks.append(
            f"The levels were forces and are divided by the given load of {quantity(load, 'N')}."
        )
    elif divided and levels != "per load" and here == "per load":
        raise InputError(_refusal(rig, name, levels))
    elif divided and here != "per load":
        remarks += _about_unit_load(mechanism, levels, here)
    remarks += _about_viscosity(found, known, slips_by_angle(rig.mechanism))
    if here == "per load":
        remarks += _about_bristles(found, slips_by_angle(mechanism))
    remarks += _about_rest(found)
    remarks += _about_doubt(found, known)
    return CarriedLaw(
        law=found, estimates=known, remarks=tuple(remarks), source=rig.path, fitted_on=rig.mechanism
    )


def extrapolations(law: CarriedLaw, mechanism: Mechanism, run: Trajectory) -> tuple[str, ...]:
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
    seen = run.at(np.union1d(np.linspace(*run.span, SAMPLES), run.t))
    speed, unit = float(np.abs(seen[rate]).max()), run.units[rate]
    most = None if known is None else known.largest_speed
    assert not isinstance(most, Mapping)  # that of one contact
    if most is not None and speed > BEYOND * most:
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
        if low * BEYOND < load or high > BEYOND * load:
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
    found = [
        (path.removeprefix("friction."), known_quantity, value)
        for path, known_quantity, value in parameters(law, "friction")
        if _is_of_bristles(known_quantity) and value
    ]
    stiffness = [value for _, known_quantity, value in found if known_quantity.scale == "stiffness"]
    fitted = () if known is None else known.intervals
    if not stiffness or distance == 0.0:
        return ()
    # Break-away over stiffness on both sides of 0: the way from held back to held forth.
    give = 2.0 * float(anywhere(law).break_away(1.0)) / min(stiffness)
    if give < DECIDES * abs(distance):
        return ()
    return tuple(
        f"${measured.symbol}$ = {quantity(value, estimates.unit_on(mechanism, measured))}"
        for name, measured, value in found
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
    found = {
        f"{name} of {quantity(size, unit)}": symbols
        for name, size in distances.items()
        if (symbols := unfitted_bristles(law, known, size, mechanism))
    }
    if not found:
        return ""
    depend = "depends" if len(found) == 1 else "depend"
    (symbols, *_) = found.values()
    return (
        f"The {joined(list(found))} {depend} on bristle parameters that were not measured:"
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
        if abs(got - wanted) > FRICTION_TOLERANCE * abs(wanted):
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
    found = estimates.LOAD.check("carried", "load", load)
    if levels == "per load":
        raise ParameterError(
            f"{rig.path}: the levels of its law are already coefficients (per normal force); leave"
            " --law-load out."
        )
    if levels == "torques":
        raise InputError(f"{_torques(rig)}, or leave --law-load out.")
    return found


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


def _about_viscosity(
    law: FrictionLaw, known: estimates.LawEstimates | None, turning: bool
) -> list[str]:
    found = [
        f"${known_quantity.symbol}$ = {number(value)} {turned(known_quantity.unit, turning)}"
        for path, known_quantity, value in parameters(law, "friction")
        if known_quantity.unit.startswith("N") and value
    ]
    if not found:
        return []
    speed = known.largest_speed if known is not None else None
    assert not isinstance(speed, Mapping)  # that of one contact
    unit = turned("m/s", turning)
    reach = "" if speed is None else f", and was fitted up to {quantity(speed, unit)}"
    are = "applies" if len(found) == 1 else "apply"
    return [
        f"{joined(found)} {are} to the contact of the fit: viscous friction does not scale with"
        f" the normal force in this law{reach}."
    ]


def _about_bristles(law: FrictionLaw, turning: bool) -> list[str]:
    found = [
        f"${known_quantity.symbol}$ = {number(value)} {turned(known_quantity.unit, turning)}"
        for _, known_quantity, value in parameters(law, "friction")
        if _is_of_bristles(known_quantity) and value
    ]
    if not found:
        return []
    are = "is" if len(found) == 1 else "are"
    return [
        f"{joined(found)} {are} per normal force: the bristles are assumed to stiffen in"
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

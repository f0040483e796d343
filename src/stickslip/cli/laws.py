"""Which law a command takes, where a rig file and an option may name one."""

from stickslip.cli.output import note
from stickslip.errors import InputError
from stickslip.experiments import Rig
from stickslip.friction import PRINTED_FORMS, FrictionLaw, law_type
from stickslip.identification import starting_law

__all__ = ["fitted_name", "law_of"]

USUAL = "coulomb"
FITTED = "coulomb-viscous"


def fitted_name(rig: Rig, name: str | None) -> str:
    """Return the law to fit: as asked, or the only one with a table of its own, or the usual."""
    if name is not None:
        return name
    return rig.named[0] if len(rig.named) == 1 else FITTED


def law_of(rig: Rig, name: str | None) -> FrictionLaw:
    """Return a law of the rig, or one with plain values where the rig does not have it."""
    name = _name(rig) if name is None else name
    if name in PRINTED_FORMS:
        raise InputError(
            f"{name} is an equation as printed; `stickslip paper` runs those. Its corrected law is"
            f" {PRINTED_FORMS[name].corrected.name}."
        )
    if name in rig.laws:
        return rig.laws[name]
    law = starting_law(law_type(name))
    note(f"{rig.path} has no values for {name}: it is run with ordinary ones, {law}.")
    return law


def _name(rig: Rig) -> str:
    """Return the law that a rig means: the only one it has, or the usual one of several."""
    for known in (rig.named, tuple(rig.laws)):
        if len(known) == 1:
            return known[0]
    if rig.laws and USUAL not in rig.laws:
        raise InputError(
            f"{rig.path} has values for several laws, {', '.join(rig.laws)}: say which with --law."
        )
    return USUAL

"""What verbs take: slips that Python lets pass, each refused in one message."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

from stickslip.errors import InputError
from stickslip.experiments import Measurement, Rig
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism

__all__ = ["Laws", "check_given", "laws_of", "names_of"]

Laws: TypeAlias = Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str]
"""Several laws, as instances, types or names."""


def check_given(verb: str, mechanism: object, measurement: object) -> None:
    """Check that a verb was given a mechanism and a measurement.

    Raises
    ------
    InputError
        If one is something else, such as a rig or the name of a file.

    Examples
    --------
    >>> from stickslip import Axis
    >>> check_given("fit", Axis(inertia=1.0), "run.csv")
    Traceback (most recent call last):
    stickslip.errors.InputError: fit takes a Measurement, got 'run.csv': read the file with ...
    """
    if isinstance(mechanism, Rig):
        raise InputError(
            f"{verb} takes a mechanism and a measurement, got a Rig: give rig.mechanism and"
            " rig.measurement."
        )
    if not isinstance(mechanism, Mechanism):
        raise InputError(
            f"{verb} takes a mechanism such as Axis(inertia=1.0), got {_called(mechanism)}."
        )
    if isinstance(measurement, Measurement):
        return
    cure = "read a file with load_measurement, or make a Measurement of arrays"
    if isinstance(measurement, str):
        cure = f"read the file with load_measurement({measurement!r})"
    elif isinstance(measurement, Rig):
        cure = "give rig.measurement"
    raise InputError(f"{verb} takes a Measurement, got {_called(measurement)}: {cure}.")


def _called(given: object) -> str:
    if isinstance(given, type):
        return f"the class {given.__name__}"
    return repr(given) if isinstance(given, str) else type(given).__name__


def names_of(given: str | Sequence[str]) -> Sequence[str]:
    """Return names, of which a single one may be given without a list around it.

    Examples
    --------
    >>> names_of("inertia"), names_of(["inertia", "offset"])
    (('inertia',), ['inertia', 'offset'])
    """
    return (given,) if isinstance(given, str) else given


def laws_of(given: Laws | FrictionLaw | type[FrictionLaw] | str | None) -> Laws | None:
    """Return laws, of which a single one may be given without a list around it.

    Examples
    --------
    >>> laws_of("coulomb"), laws_of(None)
    (['coulomb'], None)
    """
    return [given] if isinstance(given, str | type | FrictionLaw) else given

"""How options say that the files of a measurement are read."""

from collections.abc import Mapping, Sequence

from stickslip.cli.options import ReadingOptions
from stickslip.data import Column, Reading, column_of, motor_constants, read_gain
from stickslip.errors import InputError, ParameterError


def reading_of(asked: ReadingOptions) -> Reading:
    """Return what the options of that name say together."""
    texts = [part.strip() for given in asked.repair or () for part in given.split(",")]
    names = [part.strip() for given in asked.conditions or () for part in given.split(",")]
    constant = asked.motor_constant
    return Reading(
        columns=_columns(asked.columns),
        units=_pairs("--unit", "position=mm", asked.units),
        gain=_gains(_pairs("--gain", "force=35.15", asked.gain)),
        repair=tuple(texts),  # type: ignore[arg-type]  # checked by Reading itself
        conditions=tuple(names),
        motor_constant={} if constant is None else motor_constants(constant),
        by="options",
    )


def _columns(given: Sequence[str] | None) -> dict[str, Column]:
    """Split ``name=column`` pairs; what has no name is the second column of the one before."""
    found: dict[str, list[str]] = {}
    name = ""
    for part in (part for text in given or () for part in text.split(",")):
        if "=" in part or not name or not part.strip():
            ((name, column),) = _pairs("--columns", "position=q_m", [part]).items()
            found[name] = [column]
        else:
            found[name].append(part.strip())
    return {name: column_of(name, one[0] if len(one) == 1 else one) for name, one in found.items()}


def _pairs(option: str, example: str, given: Sequence[str] | None) -> dict[str, str]:
    """Split ``name=value`` pairs, parted by commas."""
    found = {}
    for pair in (part for text in given or () for part in text.split(",")):
        name, equals, value = pair.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise InputError(f"{option} takes NAME=VALUE such as {example}, got {pair!r}.")
        found[name.strip()] = value.strip()
    return found


def _gains(pairs: Mapping[str, str]) -> dict[str, float | str]:
    """Return gains as numbers, or as texts with their unit."""
    found: dict[str, float | str] = {}
    for name, value in pairs.items():
        try:
            found[name] = read_gain(value)
        except ParameterError:
            raise InputError(
                "--gain takes numbers such as force=35.15, perhaps with a unit as in"
                f' "position=0.5 um/count", got {name}={value}.'
            ) from None
    return found

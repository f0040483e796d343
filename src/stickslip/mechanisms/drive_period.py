"""How long a cycle of a mechanism's drives is."""

from collections.abc import Iterator

from stickslip.drives import Drive, Sum
from stickslip.errors import InputError
from stickslip.formatting import number
from stickslip.mechanisms.base import Mechanism

WHOLE = 1e-9
"""How far from a whole number the ratio of two periods may be: the rounding of their inputs."""


def cycle_of(mechanism: Mechanism) -> float:
    """Return the time after which all drives of a mechanism repeat themselves [s].

    Parameters
    ----------
    mechanism : Mechanism
        Its drives are `Sine`, `Square` or motion profiles, or sums of them; the period of the
        slowest must be a whole multiple of those of the others.

    Returns
    -------
    float
        The period [s].

    Raises
    ------
    InputError
        If there is no drive, or one does not repeat itself, or they have no common cycle.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.drives import Sine
    >>> cycle_of(Axis(inertia=1.0, drive=Sine(amplitude=2.0, frequency=4.0)))
    0.25
    """
    name = type(mechanism).__name__
    periods = [
        _period(f"{name}: the drive {key!r}", part)
        for key, drive in mechanism.drives().items()
        for part in _parts(drive)
    ]
    if not periods:
        raise InputError(
            f"{name} has no drive and therefore no drive period; give the period [s] explicitly."
        )
    longest = max(periods)
    for period in periods:
        if abs(longest / period - round(longest / period)) > WHOLE * longest / period:
            raise InputError(
                f"{name}: drives with periods of {number(period, 6)} and {number(longest, 6)} s"
                " have no common period equal to the longer one; give the period [s] explicitly."
            )
    return longest


def cycle_or_none(mechanism: Mechanism) -> float | None:
    """Return the time after which all drives repeat themselves [s], None where they do not.

    Examples
    --------
    >>> from stickslip import Axis
    >>> cycle_or_none(Axis(inertia=1.0)) is None
    True
    """
    try:
        return cycle_of(mechanism)
    except InputError:
        return None


def repeats(mechanism: Mechanism) -> bool:
    """Whether a drive of a mechanism, or a part of one, repeats itself.

    Examples
    --------
    >>> from stickslip import Axis
    >>> from stickslip.drives import Pulse, Sine
    >>> push, shake = Pulse(level=2.0, duration=0.1), Sine(amplitude=2.0, frequency=4.0)
    >>> repeats(Axis(inertia=1.0, drive=push)), repeats(Axis(inertia=1.0, drive=push + shake))
    (False, True)
    """
    parts = (part for drive in mechanism.drives().values() for part in _parts(drive))
    return any(part.repeats() is not None for part in parts)


def _parts(drive: Drive) -> Iterator[Drive]:
    if isinstance(drive, Sum):
        for part in drive.parts:
            yield from _parts(part)
    else:
        yield drive


def _period(owner: str, drive: Drive) -> float:
    period = drive.repeats()
    if period is None:
        raise InputError(
            f"{owner} is a {type(drive).__name__}, which is not known to be periodic; give the"
            " period [s] explicitly."
        )
    return float(period)

"""How long a cycle of the drives is."""

from collections.abc import Iterator

from stickslip.drives import Drive, Sum
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism

__all__ = ["cycle_of", "slip_names"]

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
    >>> from stickslip import Axis, Sine
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
        raise InputError(f"{name} has no drive, and so no cycle; give the period [s] yourself.")
    longest = max(periods)
    for period in periods:
        if abs(longest / period - round(longest / period)) > WHOLE * longest / period:
            raise InputError(
                f"{name}: drives with periods of {period:g} and {longest:g} s have no cycle that is"
                " that of the slower one; give the period [s] yourself."
            )
    return longest


def slip_names(mechanism: Mechanism) -> tuple[str, str]:
    """Return the state that slips at the first contact, and its rate.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> slip_names(Pendulum(mass=1.0, length=0.5))
    ('theta', 'omega')
    """
    slip = mechanism.contacts()[0].slip
    return slip, mechanism.rates[mechanism.coordinates.index(slip)]


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
            f"{owner} is a {type(drive).__name__}, which is not known to repeat itself; give the"
            " period [s] yourself."
        )
    return float(period)

"""A mechanism of which some drives are inputs."""

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, final

from typing_extensions import override

from stickslip.control import place_of
from stickslip.drives import Drive, Piece, PiecewiseAffine, Profile, Straight
from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised

__all__ = ["with_inputs"]

NOTHING = PiecewiseAffine(times=(0.0, 1.0), values=(0.0, 0.0), slopes=(0.0, 0.0))
"""What finds the place of a drive that is not there yet."""


@final
@dataclass(frozen=True, kw_only=True)
class Held(Straight):
    """A drive whose value is told from outside while the run goes on; 0 until then."""

    @override
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        return ()


def with_inputs(
    mechanism: Mechanism, names: Sequence[str]
) -> tuple[Mechanism, dict[str, tuple[str, float]]]:
    """Return a mechanism whose drives of some names are told from outside.

    Parameters
    ----------
    mechanism : Mechanism
        What is driven.
    names : sequence of str
        Drives as the mechanism lists them, or paths of places where it may have one, such as
        ``"pendulum.drive"``. Drives that are there are replaced.

    Returns
    -------
    (Mechanism, dict of str to (str, float))
        The mechanism, and of each name that was given the name under which its `drives` list the
        input, and the value at time 0 of the drive that was there before.

    Raises
    ------
    InputError
        If a drive is a prescribed motion, cannot be replaced, or is named twice.
    UnknownNameError
        If there is no such drive.
    """
    found: dict[str, tuple[str, float]] = {}
    for given in names:
        name = given
        if given not in mechanism.drives():
            driven, name = place_of(mechanism, given).commanded(mechanism, NOTHING)
            if name not in mechanism.drives():
                mechanism = driven
        if name in (used for used, _ in found.values()):
            raise InputError(f"the input {given!r} is named twice.")
        drive = mechanism.drives()[name]
        if isinstance(drive, Profile):
            raise InputError(
                f"the drive {given!r} of {mechanism.title} is a prescribed motion, which cannot be"
                " held over a step as an input: give the mechanism a force or torque instead."
            )
        found[given] = name, float(drive.value(0.0))
        mechanism = _with_held(mechanism, name)
    return mechanism, found


def _with_held(mechanism: Mechanism, name: str) -> Mechanism:
    """Return a mechanism whose drive of a name is held, and no other drive is."""
    own = mechanism.drives()
    candidate: Mechanism
    for candidate in _replaced(mechanism, own[name]):
        drives = candidate.drives()
        others = (drives.get(other) is drive for other, drive in own.items() if other != name)
        if isinstance(drives.get(name), Held) and all(others):
            return candidate
    raise InputError(f"the drive {name!r} of {mechanism.title} cannot be replaced by an input.")


def _replaced(root: Any, drive: Drive) -> Iterator[Any]:
    """Yield copies of an object, each with one occurrence of a drive replaced."""
    if root is drive:
        yield Held()
    elif isinstance(root, tuple):
        for index, item in enumerate(root):
            for other in _replaced(item, drive):
                yield (*root[:index], other, *root[index + 1 :])
    elif isinstance(root, Parametrised):
        for field in dataclasses.fields(root):
            for other in _replaced(getattr(root, field.name), drive):
                yield dataclasses.replace(root, **{field.name: other})

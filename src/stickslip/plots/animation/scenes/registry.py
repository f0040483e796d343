"""Which scene a mechanism has: ours, that of an installed package, or bars."""

import functools
from collections.abc import Mapping
from importlib.metadata import entry_points
from types import MappingProxyType

from stickslip.errors import StickslipError
from stickslip.mechanisms import Mechanism
from stickslip.plots.animation.scenes.fallback import bars
from stickslip.plots.animation.scenes.mechanisms import SCENES
from stickslip.plots.animation.scenes.shapes import Scene

GROUP = "stickslip.scenes"


@functools.cache
def _scenes() -> Mapping[str, Scene]:
    found = dict(SCENES)
    for entry in entry_points(group=GROUP):
        scene = entry.load()
        if not callable(scene):
            raise StickslipError(f"entry point {entry.value} of {GROUP} is not a function.")
        found[entry.name] = scene
    return MappingProxyType(found)


def scene_of(mechanism: Mechanism) -> Scene:
    """Return the scene of a mechanism, by the name of its type.

    Packages add scenes under the entry point ``stickslip.scenes``, by the name of the mechanism. A
    mechanism without one is shown by bars for its states.

    Parameters
    ----------
    mechanism : Mechanism
        The mechanism.

    Returns
    -------
    callable
        Called with mechanism and run, gives a `Picture`.

    Examples
    --------
    >>> from stickslip import Pendulum
    >>> scene_of(Pendulum(mass=0.2, length=0.5)).__name__
    'pendulum'
    """
    return _scenes().get(mechanism.name, bars)

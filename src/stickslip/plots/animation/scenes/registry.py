"""Which scene a mechanism has: ours, that of an installed package, or bars."""

import functools
from collections.abc import Mapping
from importlib.metadata import entry_points
from types import MappingProxyType

import numpy as np

from stickslip.errors import StickslipError
from stickslip.mechanisms import Mechanism
from stickslip.plots.animation.scenes.mechanisms import SCENES
from stickslip.plots.animation.scenes.shapes import (
    Box,
    Fill,
    Moment,
    Picture,
    Rod,
    Scene,
    Shape,
    Word,
)
from stickslip.trajectory import Trajectory

HALF = 1.0
"""Length of the bar of the largest value."""


def bars(mechanism: Mechanism, run: Trajectory) -> Picture:
    """Return bars for the states, each over its largest value in the run.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, simulate
    >>> from stickslip.drives import Pulse
    >>> axis = Axis(inertia=2.0, drive=Pulse(level=5.0, duration=1.0))
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=1.0), t_end=10.0).sampled(50)
    >>> picture = bars(axis, run)
    >>> bar, *_ = [s for s in picture.shapes({"x": 5.0, "v": 0.0}) if isinstance(s, Box)]
    >>> round(bar.left, 6), round(bar.width, 6), bar.fill
    (0.0, 1.0, 'mode')
    """
    contacts = mechanism.contacts()
    slips = {name: one.name for one in contacts for name in one.slips}
    names = tuple(name for name in run.states or (*mechanism.coordinates, *mechanism.rates))
    largest = {name: float(np.abs(run[name]).max()) or 1.0 for name in names}

    def shapes(now: Moment) -> list[Shape]:
        found: list[Shape] = []
        for row, name in enumerate(names):
            base = -0.45 * row
            length = HALF * now[name] / largest[name]
            fill: Fill = "mode" if name in slips else "body"
            contact = slips.get(name, "") if len(contacts) > 1 else ""
            left, width = min(0.0, length), abs(length)
            found += [
                Rod(points=((-HALF, base), (HALF, base)), width=0.6),
                Box(
                    left=left,
                    bottom=base,
                    width=width,
                    height=0.16,
                    fill=fill,
                    contact=contact,
                ),
                Rod(points=((0.0, base - 0.03), (0.0, base + 0.19)), width=1.2),
                Word(at=(-HALF, base + 0.25), text=name),
                Word(
                    at=(HALF, base + 0.25),
                    text=f"{now[name] + 0.0:.3g} {run.units.get(name, '1')}",
                    align="right",
                ),
            ]
        return found

    return Picture(shapes=shapes, metric=False)


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

"""What is said of wrong arguments of plots and animations, before anything is drawn."""

import math
import numbers
import os
from pathlib import Path

from stickslip.errors import InputError
from stickslip.mechanisms import Mechanism
from stickslip.simulation import no_mechanism
from stickslip.trajectory import Trajectory


def check_scene(run: object, mechanism: object, scene: object = None) -> None:
    """Refuse what is no run, no mechanism or no scene, and a run of another mechanism.

    Mechanisms are told apart by their coordinates and rates; bristles of a law come after these.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=1.0, y0={"theta": 0.5})
    >>> check_scene(run, clock)
    """
    if not isinstance(run, Trajectory):
        raise InputError(f"run must be a Trajectory such as simulate returns, got {run!r}.")
    if not isinstance(mechanism, Mechanism):
        raise no_mechanism(mechanism)
    if scene is not None and not callable(scene):
        raise InputError(
            f"scene must be a function of mechanism and run that gives a Picture, got {scene!r}."
        )
    own = (*mechanism.coordinates, *mechanism.rates)
    # a run that was put together from columns does not say which of them are states
    states = run.states[: len(own)] if run.states else tuple(n for n in own if n in run.names)
    if states != own:
        raise InputError(
            f"the run is not a run of {type(mechanism).__name__}, whose states are"
            f" {', '.join(own)}: it has {', '.join(run.states or run.names)}; give the mechanism"
            " that was simulated."
        )


def file_of(path: object) -> Path:
    """Return the path of a file.

    Examples
    --------
    >>> file_of("cart.gif").suffix
    '.gif'
    """
    if not isinstance(path, (str, os.PathLike)):
        raise InputError(f"path must be the name of a file such as 'cart.gif', got {path!r}.")
    return Path(path)


def number(name: str, value: object) -> None:
    """Refuse what is no finite number.

    Examples
    --------
    >>> number("fps", 25)
    """
    if isinstance(value, bool) or not isinstance(value, numbers.Real) or not math.isfinite(value):
        raise InputError(f"{name} must be a finite number, got {value!r}.")


def check_size(size: object) -> None:
    """Refuse what is no width and height.

    Examples
    --------
    >>> check_size((880, 400))
    """
    if not isinstance(size, (tuple, list)) or len(size) != 2:
        raise InputError(f"size must be (width, height) in px such as (880, 400), got {size!r}.")
    for name, value in zip(("width", "height"), size, strict=True):
        number(f"size: {name}", value)


def check_type(name: str, value: object, *kinds: type) -> None:
    """Refuse an argument of another type.

    Examples
    --------
    >>> check_type("run", 3, Trajectory)
    Traceback (most recent call last):
    ...
    stickslip.errors.InputError: run must be a Trajectory, got 3.
    """
    if not isinstance(value, kinds):
        names = [kind.__name__ for kind in kinds]
        known = " or ".join(filter(None, [", ".join(names[:-1]), names[-1]]))
        article = "an" if names[0][0] in "AEIO" else "a"
        raise InputError(f"{name} must be {article} {known}, got {value!r}.")

"""What a controller sees: states with noise, rounded to what a sensor resolves."""

from collections.abc import Mapping, Sequence
from typing import final

import numpy as np

from stickslip.errors import UnknownNameError
from stickslip.quantities import Quantity

SPREAD = Quantity("sigma", low=0)
STEP = Quantity("q", above=0)


@final
class Sensors:
    """Reads states as a controller gets them: noise first, then quantisation.

    Examples
    --------
    >>> sensors = Sensors(("x", "v"), quantisation={"x": 0.01})
    >>> sensors.read([0.123, 0.456])
    {'x': 0.12, 'v': 0.456}
    """

    def __init__(
        self,
        names: Sequence[str],
        *,
        noise: Mapping[str, float] | None = None,
        quantisation: Mapping[str, float] | None = None,
        seed: int = 0,
    ) -> None:
        """Take the names of what is measured."""
        self.names = tuple(names)
        self._noise = self._checked("noise", noise or {}, SPREAD)
        self._steps = self._checked("quantisation", quantisation or {}, STEP)
        self._random = np.random.default_rng(seed)

    def _checked(
        self, what: str, given: Mapping[str, float], quantity: Quantity
    ) -> dict[str, float]:
        for name in given:
            if name not in self.names:
                raise UnknownNameError(f"state in {what}", name, self.names)
        return {k: quantity.check("closed_loop", f"{what}[{k!r}]", v) for k, v in given.items()}

    def read(self, state: Sequence[float]) -> dict[str, float]:
        """Return what is measured of a state, by name."""
        found = dict(zip(self.names, state, strict=False))  # bristles are seen by nobody
        for name, spread in self._noise.items():
            found[name] += spread * float(self._random.standard_normal())
        for name, step in self._steps.items():
            found[name] = step * round(found[name] / step)
        return found

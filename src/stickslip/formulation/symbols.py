"""The symbols of one formulation."""

from dataclasses import dataclass

import symengine as se

from stickslip.formulation.trace import Switchboard, Traced, expression
from stickslip.mechanisms import Mechanism


@dataclass(frozen=True)
class Symbols:
    """The symbols of one formulation."""

    t: se.Symbol
    """Time."""
    coordinates: list[se.Symbol]
    """Of the coordinates."""
    rates: list[se.Symbol]
    """Of their rates."""
    bristles: list[se.Symbol]
    """Of the bristle states."""
    drives: dict[str, se.Symbol]
    """Of the drives' values by name."""
    inputs: dict[se.Symbol, se.Expr]
    """Expression of each drive."""
    given: dict[se.Symbol, se.Symbol]
    """Place of each drive where its value is given from outside."""
    constants: frozenset[str]
    """Names of the symbols of parameters."""

    def closed(self, e: se.Expr) -> se.Expr:
        """Put the drives' expressions in."""
        return e.subs(self.inputs)

    @property
    def states(self) -> list[se.Symbol]:
        """Coordinates, rates, bristles."""
        return [*self.coordinates, *self.rates, *self.bristles]


def symbols_of(
    twin: Mechanism, bristles: int, constants: frozenset[str], board: Switchboard
) -> Symbols:
    """Return the symbols of a mechanism whose parameters are symbols."""
    n = len(twin.coordinates)
    y = [se.Symbol(f"y{i}") for i in range(2 * n + bristles)]
    t = se.Symbol("t")
    drives, inputs = {}, {}
    for k, (name, drive) in enumerate(twin.drives().items()):
        value, slope, start = (se.Symbol(f"p{3 * k + i}") for i in range(3))
        drives[name] = se.Symbol(f"d{k}")
        linear = value + slope * (t - start)
        inputs[drives[name]] = linear + expression(drive.smooth(Traced(t, board)))
    given = {d: se.Symbol(f"p{3 * len(drives) + k}") for k, d in enumerate(drives.values())}
    return Symbols(t, y[:n], y[n : 2 * n], y[2 * n :], drives, inputs, given, constants)

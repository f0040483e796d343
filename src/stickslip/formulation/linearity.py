"""What is linear: modes with constant coefficients, solved in closed form; friction in the load."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import symengine as se

from stickslip.errors import TracingError
from stickslip.formulation.trace import LONGEST, collapsed, rebuilt
from stickslip.friction import FrictionLaw

MOST_SWITCHES = 4
"""A mode that depends on more switches than this is not examined."""


@dataclass(frozen=True)
class Waves:
    """Sines and cosines in time, all of one frequency, by which linear equations may be driven."""

    symbols: Mapping[se.Expr, se.Symbol]
    """What stands for each of them."""
    square: se.Expr
    """Square of their angular frequency."""

    def replaced(self, e: se.Expr) -> se.Expr:
        """Return an expression with symbols for the waves."""
        return e.xreplace(self.symbols) if self.symbols else e

    def term(self, e: se.Expr) -> se.Expr:
        """Return what the waves add to an expression that is affine in them."""
        replaced = self.replaced(e)
        slopes = {wave: collapsed(replaced.diff(symbol)) for wave, symbol in self.symbols.items()}
        return sum((slope * wave for wave, slope in slopes.items()), se.Integer(0))


def waves_of(expressions: Sequence[se.Expr], t: se.Symbol, states: Sequence[se.Symbol]) -> Waves:
    """Return the waves in expressions; none where their frequencies differ, or change."""
    atoms = {a for e in expressions for a in e.atoms(se.sin, se.cos) if not _free_of(a, {str(t)})}
    moving = {str(t), *map(str, states)}
    squares = {se.expand(a.args[0].diff(t) ** 2) for a in atoms}
    steady = all(_free_of(square, moving) for square in squares)
    alone = all(_free_of(a.args[0], moving - {str(t)}) for a in atoms)
    if len(squares) != 1 or not (steady and alone):
        return Waves({}, se.Integer(0))
    ordered = sorted(atoms, key=str)
    return Waves({a: se.Symbol(f"wave{i}") for i, a in enumerate(ordered)}, squares.pop())


def linear_where(
    expressions: Sequence[se.Expr], variables: Sequence[se.Symbol], switches: Sequence[se.Symbol]
) -> se.Expr:
    """Return 1 where all expressions are affine in the variables together, else 0."""
    names = {str(s) for e in expressions for s in e.free_symbols}
    used = [switch for switch in switches if str(switch) in names]
    if len(used) > MOST_SWITCHES:
        return se.Integer(0)
    return _decide(list(expressions), list(variables), used, {})


def _decide(
    expressions: list[se.Expr],
    variables: list[se.Symbol],
    pending: list[se.Symbol],
    fixed: Mapping[str, bool],
) -> se.Expr:
    if not pending:
        affine = all(_affine(_chosen(e, fixed), variables) for e in expressions)
        return se.Integer(int(affine))
    first, *others = pending
    yes, no = (
        _decide(expressions, variables, others, {**fixed, str(first): value})
        for value in (True, False)
    )
    return yes if yes == no else se.Piecewise((yes, first > 0), (no, True))


def _chosen(e: se.Expr, fixed: Mapping[str, bool]) -> se.Expr:
    """Return an expression with the branches that hold for given switches."""

    def chosen(switch: se.Piecewise) -> se.Expr:
        yes, condition, no, _ = switch.args
        name = str(condition.args[1])
        return _chosen(yes if fixed[name] else no, fixed) if name in fixed else switch

    return rebuilt(e, chosen)


def _affine(e: se.Expr, variables: list[se.Symbol]) -> bool:
    """Whether no slope of the expression depends on a variable."""
    names = {str(variable) for variable in variables}
    return all(_free_of(e.diff(variable), names) for variable in variables)


def _free_of(e: se.Expr, names: set[str]) -> bool:
    if not names & {str(s) for s in e.free_symbols}:
        return True
    if len(str(e)) > LONGEST:
        return False
    return not names & {str(s) for s in se.expand(e).free_symbols}


def load_factor(law: FrictionLaw, friction: se.Expr, load: se.Symbol) -> se.Expr:
    """Return b of friction a + b N."""
    factor = collapsed(friction.diff(load))
    if se.expand(collapsed(factor.diff(load))) != 0:
        raise TracingError(
            f"{type(law).__name__}: friction must be affine in the load, F = a + b N; its second"
            " derivative with respect to N is not zero"
        )
    return factor

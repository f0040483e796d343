"""A law that contains another one gives its friction."""

import numpy as np
import pytest

from stickslip.friction import FrictionLaw, bound, contained_laws, laws
from stickslip.identify.fits.parameters import starting_law
from stickslip.study.testing import ORDINARY

PAIRS = [(kind, one) for kind in laws().values() for one in kind.contained]
LARGE = 1e12
"""Stands for infinity: bristles then give way by less than a picometre."""


def steady(law: FrictionLaw, velocity: float) -> float:
    law = bound(law, ORDINARY)
    if law.states:
        return float(law.steady(velocity, 7.0))
    return float(law.force(velocity, 7.0))  # type: ignore[attr-defined]


@pytest.mark.parametrize(("kind", "one"), PAIRS, ids=[f"{k.name}<{o.law}" for k, o in PAIRS])
@pytest.mark.parametrize("velocity", [-0.8, -1e-3, 1e-3, 0.3])
def test_embedded_values_give_the_friction_of_the_simpler_law(kind, one, velocity):
    simpler = starting_law(laws()[one.law])
    values = one.embed(simpler)
    assert values is not None
    rest = starting_law(kind)
    values |= dict.fromkeys(one.limits, LARGE)
    names = {n: getattr(rest, n) for n in kind.fit_order} | values
    rich = kind(**names)
    # products of the same numbers in another order
    assert steady(rich, velocity) == pytest.approx(steady(simpler, velocity), rel=1e-12)


def test_values_that_the_richer_law_cannot_take_are_not_embedded():
    from stickslip import Dahl, LuGre

    yields_sharply = Dahl(kinetic_coefficient=0.2, bristle_stiffness=1e4, yield_exponent=0.5)
    (one,) = [c for c in LuGre.contained if c.law == "dahl"]
    assert one.embed(yields_sharply) is None


def test_no_law_contains_itself():
    assert all(name not in contained_laws(kind) for name, kind in laws().items())
    assert np.all([len(set(contained_laws(k))) == len(contained_laws(k)) for k in laws().values()])

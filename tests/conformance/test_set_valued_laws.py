"""What every law that is a function of the slip speed must do."""

import dataclasses
import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import SET_VALUED, decade, examples, laws

from stickslip.quantities import fields_of

speeds = decade(-9, 2)
loads = st.just(0.0) | decade(-3, 4)
each_law = pytest.mark.parametrize("kind", SET_VALUED, ids=lambda kind: kind.name)
EVERY = examples(40)
ROUNDING = 1e-14
"""A few dozen roundings of the result."""


@each_law
@EVERY
@given(data=st.data(), v=speeds, load=loads)
def test_sliding_friction_is_odd(kind, data, v, load):
    law = data.draw(laws(kind))
    assert law.force(-v, load) == -law.force(v, load)


@each_law
@EVERY
@given(data=st.data(), v=speeds, load=loads)
def test_sliding_friction_never_drives(kind, data, v, load):
    law = data.draw(laws(kind))
    assert law.force(v, load) * v >= 0
    assert law.force(-v, load) * -v >= 0


@each_law
@EVERY
@given(data=st.data(), load=loads)
def test_friction_has_no_value_of_its_own_at_rest(kind, data, load):
    law = data.draw(laws(kind))
    assert law.force(0.0, load) == 0


@each_law
@EVERY
@given(data=st.data(), load=decade(-3, 4))
def test_break_away_is_not_below_the_sliding_friction_it_gives_way_to(kind, data, load):
    law = data.draw(laws(kind))
    assert law.break_away(load) >= law.sliding(0.0, load) * (1 - ROUNDING)


@each_law
@EVERY
@given(data=st.data(), load=decade(-3, 4))
def test_sliding_friction_has_no_jump_at_any_speed(kind, data, load):
    law = data.draw(laws(kind))
    grid = [10.0 ** (i / 10) for i in range(-90, 21)]
    size = max(law.sliding(v, load) for v in grid)

    def change(low, high):
        return abs(law.sliding(high, load) - law.sliding(low, load))

    low, high = max(itertools.pairwise(grid), key=lambda ends: change(*ends))
    for _ in range(60):
        middle = 0.5 * (low + high)
        ends = ((low, middle), (middle, high))
        low, high = max(ends, key=lambda pair: change(*pair))
    # following the larger change down leads to a jump if there is one; rounding is left
    assert change(low, high) <= ROUNDING * size


@each_law
@EVERY
@given(data=st.data(), v=speeds, light=decade(-3, 3), more=decade(-3, 3))
def test_friction_is_affine_in_the_load(kind, data, v, light, more):
    law = data.draw(laws(kind))
    free = law.force(v, 0.0)
    together = law.force(v, light + more)
    apart = law.force(v, light) + law.force(v, more) - free
    assert abs(together - apart) <= ROUNDING * (abs(together) + abs(free))
    assert abs(law.break_away(light + more) - law.break_away(light) - law.break_away(more)) <= (
        ROUNDING * law.break_away(light + more)
    )


@each_law
@EVERY
@given(data=st.data(), v=speeds)
def test_without_load_only_what_is_free_of_levels_is_left(kind, data, v):
    law = data.draw(laws(kind))
    levels = [n for n, q in fields_of(kind).items() if q.unit == "1" and not q.structural]
    smooth = dataclasses.replace(law, **dict.fromkeys(levels, 0.0))
    assert law.force(v, 0.0) == smooth.force(v, 10.0)
    assert law.break_away(0.0) == 0

"""What every law must do that is one function of the speed forwards and another backwards."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import decade, examples, laws, mirrored_law

from stickslip.friction import LAWS, SetValuedLaw

DIRECTIONAL = [law for law in LAWS.values() if law.directional and not law.states]
each_law = pytest.mark.parametrize("kind", DIRECTIONAL, ids=lambda kind: kind.name)
FEW = examples(50)


@each_law
@FEW
@given(data=st.data(), v=decade(-9, 2), load=decade(-3, 4))
def test_each_direction_is_a_law_of_its_own(kind, data, v, load):
    law = data.draw(laws(kind))
    ahead, back = law.towards(1), law.towards(-1)
    assert isinstance(ahead, SetValuedLaw)
    assert isinstance(back, SetValuedLaw)
    assert law.force(v, load) == ahead.sliding(v, load) >= 0
    assert law.force(-v, load) == -back.sliding(v, load) <= 0
    assert law.force(0.0, load) == 0
    np.testing.assert_array_equal(
        law.force(np.array([v, -v]), load), [law.force(v, load), law.force(-v, load)]
    )


@each_law
@FEW
@given(data=st.data(), load=decade(-3, 4))
def test_the_break_away_level_is_what_is_held_in_either_direction(kind, data, load):
    law = data.draw(laws(kind))
    levels = [law.towards(side).break_away(load) for side in (1, -1)]
    assert law.break_away(load) == min(levels)


@each_law
@FEW
@given(data=st.data(), v=decade(-9, 2), load=decade(-3, 4))
def test_with_its_directions_exchanged_a_law_is_its_mirror_image(kind, data, v, load):
    law = data.draw(laws(kind))
    assert mirrored_law(law).force(v, load) == -law.force(-v, load)
    assert mirrored_law(mirrored_law(law)) == law

"""A second record is refused where it is one that the fit sees."""

import numpy as np
import pytest

from stickslip import Axis, Coulomb, Measurement, select
from stickslip.data.checking.data_quality import refuse_same
from stickslip.errors import InputError

V = np.linspace(-0.2, 0.2, 60)
TABLE = Measurement(velocity=V, friction=2.0 * np.sign(V), name="table")
SAME = "the second record is identical to the fitted one"


def test_select_refuses_its_own_record_whatever_it_is_called():
    again = Measurement(velocity=V, friction=2.0 * np.sign(V), name="another name")
    with pytest.raises(InputError, match=f"{SAME} .'another name'."):
        select(Axis(inertia=1.0), [Coulomb], TABLE, validate=again)


def test_a_trial_that_was_fitted_is_found_among_others():
    other = Measurement(velocity=V, friction=2.1 * np.sign(V))
    with pytest.raises(InputError, match=SAME):
        refuse_same(Measurement(trials=(other, TABLE)), TABLE)
    with pytest.raises(InputError, match=SAME):
        refuse_same(TABLE, Measurement(trials=(other, TABLE)))


@pytest.mark.parametrize(
    "second",
    [
        Measurement(velocity=V, friction=2.0 * np.sign(V) + 1e-12),
        Measurement(velocity=V[1:], friction=2.0 * np.sign(V[1:])),
    ],
    ids=["other values", "a part"],
)
def test_what_differs_in_any_number_is_another_record(second):
    refuse_same(TABLE, second)


def test_a_record_with_one_quantity_more_is_the_same_record():
    with pytest.raises(InputError, match=SAME):
        refuse_same(TABLE, Measurement(velocity=V, friction=2.0 * np.sign(V), load=1.0))


def test_times_alone_may_be_alike():
    t = np.arange(20.0)
    refuse_same(Measurement(time=t, position=0.1 * t), Measurement(time=t, position=0.2 * t))


def test_single_numbers_may_be_alike():
    refuse_same(Measurement(travel=0.2), Measurement(travel=0.2))

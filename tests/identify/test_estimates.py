"""What a notebook shows of an estimate: as many digits as its interval tells."""

import math

import pytest

from stickslip.identify import Estimate
from stickslip.quantities import Quantity

MASS = Quantity("J", "kg")


def estimate(value, low, high, quantity=MASS):
    return Estimate(
        path="mechanism.inertia",
        quantity=quantity,
        value=value,
        low=low,
        high=high,
        interval="95 %",
    )


@pytest.mark.parametrize(
    ("value", "low", "high", "said"),
    [
        (4.999965, 4.99985, 5.00008, "J = 4.99997 kg (4.99985 to 5.00008)"),
        (0.25512, 0.24871, 0.26113, "J = 0.255 kg (0.249 to 0.261)"),
        (-2.26e-5, -3.33e-4, 2.88e-4, "J = −0.00002 kg (−0.00033 to 0.00029)"),
        (24841.3, 24800.0, 24900.0, "J = 24,840 kg (24,800 to 24,900)"),
        (2.5e9, 2.4e9, 2.6e9, "J = 2.50 × 10⁹ kg (2.40 × 10⁹ to 2.60 × 10⁹)"),
        (2.0, -math.inf, math.inf, "J = not identified (not bounded)"),
        (2.0, 1.0, math.inf, "J = 2.00 kg (at least 1.00)"),
        (-2.0, -math.inf, -1.0, "J = −2.00 kg (at most −1.00)"),
    ],
)
def test_value_and_interval_end_at_the_same_digit(value, low, high, said):
    assert str(estimate(value, low, high)) == said
    # no minus but the true one, and no space that a search does not find
    assert "-" not in str(estimate(value, low, high))
    assert "\N{NO-BREAK SPACE}" not in str(estimate(value, low, high))

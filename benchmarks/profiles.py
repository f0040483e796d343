"""``python -m benchmarks.profiles``: how far motions beat the three-phase one within equal limits.

The cart weighs 500 g and carries 100 g on a rod of 30 cm; friction is Coulomb's with 0.2. It takes
some minutes; the same seed gives the same numbers.
"""

import argparse
import math
import time
from typing import NamedTuple

from stickslip import Coulomb, PendulumCart
from stickslip import optimise_profile as optimise
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import ThreePhase
from stickslip.study.optimisation import Limits, Optimum

SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))
LAW = Coulomb(kinetic_coefficient=0.2)
LIMITS = Limits(position=math.radians(60.0), rate=12.0, effort=0.6, load_share=0.1, back_slip=1e-3)


class Case(NamedTuple):
    """A goal and a kind of motion."""

    goal: str
    kind: str
    knots: int = 12

    def best(self, seed: int, evaluations: int) -> Optimum:
        """Return the best motion."""
        return optimise(
            CART,
            LAW,
            limits=LIMITS,
            goal=self.goal,
            kind=self.kind,
            knots=self.knots,
            seed=seed,
            evaluations=evaluations,
        )

    @property
    def title(self) -> str:
        return f"spline, {self.knots} knots" if self.kind == "spline" else self.kind


CASES = (
    Case("travel", "spline", 16),
    Case("travel", "spline", 12),
    Case("travel", "seven-step"),
    Case("speed", "spline", 16),
    Case("speed", "seven-step"),
    Case("economy", "spline", 16),
)


def row(case: Case, seed: int, evaluations: int) -> str:
    """Return a line of the table."""
    begun = time.perf_counter()
    found = case.best(seed, evaluations)
    assert found.three_phase is not None
    active = [m.name.replace("_", " ") for m in found.margins if m.share < 0.01]
    cells = [
        f"{found.goal.title}, {found.goal.unit}",
        case.title,
        f"{found.value:.5g}",
        f"{found.three_phase.value:.5g}",
        f"{found.factor:.3f}",
        ", ".join(active),
        str(seed),
        str(found.evaluations),
        f"{time.perf_counter() - begun:.0f}",
    ]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.profiles", description=__doc__)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--evaluations", type=int, default=1000)
    parser.add_argument("--first", type=int, default=len(CASES), help="only so many cases")
    asked = parser.parse_args()
    heads = "goal", "motion", "best", "three-phase", "factor", "limits met", "seed", "tried", "s"
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads))
    for case in CASES[: asked.first]:
        print(row(case, asked.seed, asked.evaluations), flush=True)


if __name__ == "__main__":
    main()

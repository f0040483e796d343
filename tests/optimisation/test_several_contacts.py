"""A capsule on two runners that share its weight: its motions are those of one contact."""

from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest

from stickslip import Coulomb, Mechanism, TwoFeet
from stickslip.engine.simulation import event_driven_law
from stickslip.errors import InputError
from stickslip.mechanisms import Contact, Prescribed, static_normal_forces
from stickslip.quantities import Quantity
from stickslip.show import plots
from stickslip.study.optimisation import Limits, measure, optimise_profile

WEIGHT = 9.81


@dataclass(frozen=True, kw_only=True)
class Sled(Mechanism):
    """1 kg, of which 0.2 kg move inside; half of the weight on each runner."""

    name: ClassVar[str] = "sled"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    share: Annotated[float, Quantity("s", low=0, high=1)] = 0.5
    drive: Prescribed = None

    def kinetic_energy(self, q, q_dot):
        inner = q_dot["x"] + q_dot["xi"]
        return 0.4 * q_dot["x"] * q_dot["x"] + 0.1 * inner * inner

    def potential_energy(self, t, q):
        return 0.0 * q["x"]

    def forces(self, t, q, q_dot, drives):
        return {"xi": self.drive.force(drives)}

    def contacts(self):
        return (
            Contact(name="left", slip="x", load=self.share * WEIGHT),
            Contact(name="right", slip="x", load=(1.0 - self.share) * WEIGHT),
        )

    def drives(self):
        return self.drive.drives()

    def start(self):
        return self.drive.start("xi", "xi_dot")

    def guided(self):
        return {"xi": self.drive.guide("force", "N")}


@pytest.fixture(scope="module")
def sled(capsule):
    return Sled(drive=Prescribed(profile=capsule.drive.profile))


def test_a_cycle_on_two_runners_is_that_on_one_contact(sled, capsule, law):
    both, alone = measure(sled, law), measure(capsule, law)
    assert both.travel == pytest.approx(alone.travel, abs=1e-12)
    assert both.work == pytest.approx(alone.work, rel=1e-9)
    assert both.load_share == pytest.approx(1.0, abs=1e-12)
    assert static_normal_forces(sled) == {"left": WEIGHT / 2, "right": WEIGHT / 2}


def test_a_runner_that_bears_nothing_at_rest_has_no_share_of_its_load(sled, law):
    one = measure(replace(sled, share=0.0), law)
    assert one.load_share == pytest.approx(1.0, abs=1e-12)


LAWS = {"left": Coulomb(kinetic_coefficient=0.2), "right": Coulomb(kinetic_coefficient=0.25)}
MIDDLE = Coulomb(kinetic_coefficient=0.225)
"""What the friction of both runners is together."""


def test_laws_by_contact_act_together(sled):
    both, middle = (measure(sled, law) for law in (event_driven_law(sled, LAWS), MIDDLE))
    assert both.travel == pytest.approx(middle.travel, abs=1e-12)


@pytest.mark.slow  # cycles are compared above
def test_a_profile_is_optimised_for_laws_by_contact(sled):
    limits = Limits(position=0.01, rate=0.8, effort=10.0, back_slip=0.0)
    how = {"limits": limits, "goal": "speed", "evaluations": 12}
    found = optimise_profile(sled, LAWS, **how)
    assert found.value >= found.start.value
    assert found.law.names == {"left": "coulomb", "right": "coulomb"}
    assert found.run.certificate.certified
    # ways of searches differ by rounding: the motion that was found is compared, not another one
    cycle = measure(found.mechanism, MIDDLE)
    assert cycle.travel / cycle.period == pytest.approx(found.value, rel=1e-9)
    assert np.size(plots.plot(found)) > 1


def test_weights_of_feet_follow_from_where_the_weight_acts():
    body = TwoFeet(mass=2.0, front=0.3, rear=0.2, height=0.15)
    found = static_normal_forces(body)
    assert found == pytest.approx({"front": 19.62 * 0.4, "rear": 19.62 * 0.6}, rel=1e-9)


def test_feet_without_an_inner_motion_have_nothing_to_optimise(law):
    with pytest.raises(InputError, match="must have a prescribed motion"):
        optimise_profile(
            TwoFeet(mass=1.0, front=0.1, rear=0.1), law, limits=Limits(position=1.0, rate=1.0)
        )

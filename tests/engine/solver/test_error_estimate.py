"""The error estimate of the certificate: the difference to a run with half the tolerance."""

import numpy as np
import pytest

from stickslip import Coulomb, EventDriven, LuGre, SpringBlock, TowedBlock, simulate

BLOCK = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
BRISTLES = LuGre(
    kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=1e-2,
    bristle_stiffness=1e3, bristle_damping=30.0, viscous_coefficient=0.4,
)  # fmt: skip


@pytest.mark.parametrize("tolerance", [1e-5, 1e-7])
def test_the_estimate_is_of_the_size_of_the_error(tolerance):
    solver = EventDriven(stiff_tolerance=tolerance, estimate_error=True, tier="python")
    run = simulate(BLOCK, BRISTLES, t_end=8.0, solver=solver)
    best = simulate(BLOCK, BRISTLES, t_end=8.0, solver=EventDriven(stiff_tolerance=1e-11))
    finer = best.at(run.t)
    errors = [np.abs(run[s] - finer[s]).max() / np.abs(finer[s]).max() for s in run.states]
    estimate = run.certificate.error_estimate
    # half the tolerance leaves a good part of the error in the finer run: an order of magnitude
    assert 0.1 * max(errors) <= estimate <= 10.0 * max(errors)


def test_exact_modes_have_no_error_that_a_tolerance_controls():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    law = Coulomb(kinetic_coefficient=0.2)
    run = simulate(rig, law, t_end=2.0, solver=EventDriven(estimate_error=True))
    assert run.certificate.error_estimate == 0.0

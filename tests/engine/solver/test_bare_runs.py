"""Runs without a certificate, and drives that are kept between runs."""

import numpy as np

from stickslip import Axis, CoulombViscous, LuGre, simulate
from stickslip.engine.solver import EventDriven
from stickslip.mechanisms.drives import Pulse, Sampled

LAW = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=1.0)
BRISTLES = LuGre(
    kinetic_coefficient=2.0,
    static_coefficient=3.0,
    stribeck_velocity=0.01,
    bristle_stiffness=1e4,
    bristle_damping=50.0,
)


def pushed(*values):
    return Axis(inertia=2.0, drive=Sampled(times=(0.0, 0.5, 1.0), values=values))


def test_a_bare_run_has_the_states_and_sensitivities_of_a_certified_one():
    t = np.linspace(0.0, 1.5, 31)
    paths = ["friction.kinetic_coefficient", "mechanism.inertia", "initial.v"]
    for law in (LAW, BRISTLES):
        axis, y0 = pushed(9.0, -7.0, 0.0), (0.0, 0.1, *[0.0] * (law is BRISTLES))
        bare = EventDriven().bare(axis, law, y0=y0, t_end=1.5)
        run = EventDriven().run(axis, law, y0=y0, t_end=1.5)
        iw = run.at(t)
        np.testing.assert_array_equal(bare.at(t), np.stack([iw[n] for n in run.states], axis=1))
        np.testing.assert_array_equal(bare.differentiate(t, paths), run.differentiate(t, paths))
        assert bare.status is run.status


def test_runs_that_differ_in_a_drive_or_its_end_do_not_share_what_is_kept():
    ends = [
        float(simulate(pushed(*values), LAW, t_end=t_end)["x"][-1])
        for values, t_end in [
            ((9.0, 0.0, 0.0), 1.5),
            ((12.0, 0.0, 0.0), 1.5),
            ((9.0, 0.0, 0.0), 0.4),
        ]
    ]
    again = float(simulate(pushed(9.0, 0.0, 0.0), LAW, t_end=1.5)["x"][-1])
    assert len(set(ends)) == 3
    assert again == ends[0]


def test_a_parameter_of_a_drive_still_has_a_sensitivity():

    axis = Axis(inertia=2.0, drive=Pulse(level=10.0, duration=0.3))
    run = simulate(axis, LAW, t_end=1.0)
    slope = float(run.at(1.0).sensitivity("x", "mechanism.drive.level")[0])
    ends = [
        float(
            simulate(Axis(inertia=2.0, drive=Pulse(level=p, duration=0.3)), LAW, t_end=1.0)["x"][-1]
        )
        for p in (10.0 - 1e-4, 10.0 + 1e-4)
    ]
    # central differences of 1e-5 of the level
    np.testing.assert_allclose(slope, (ends[1] - ends[0]) / 2e-4, rtol=1e-5)

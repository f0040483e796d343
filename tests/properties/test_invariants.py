"""What must hold for every rig, every law and every drive."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.support import (
    RIGID,
    SLIDERS,
    UNAIDED,
    decade,
    each_of,
    examples,
    held_by,
    laws,
    mirrored_law,
    mirrors,
    nearly,
    spring_blocks,
)

from stickslip import Coulomb, EventDriven, SpringBlock, simulate
from stickslip.mechanisms.drives import Drive, PiecewiseLinear, Pulse, Sum
from stickslip.quantities import Parametrised, fields_of

each_law = pytest.mark.parametrize("kind", each_of(UNAIDED.values()))
rigid = pytest.mark.parametrize("kind", each_of(RIGID))
SCALABLE = [kind for kind in UNAIDED.values() if "power" not in str(kind.composition)]
"""Laws without a speed of their own that is no parameter; see tests/friction/test_power_viscous."""
rigs = st.one_of(*SLIDERS.values())
starts = st.fixed_dictionaries({"x": nearly(-0.1, 0.1), "v": nearly(-0.5, 0.5) | st.just(0.0)})
FEW = examples(12)
T_END = 1.5


# Travel formulas


@examples(60)
@given(mass=decade(-6, 6), mu=decade(-2, 0.5), excess=decade(-2, 2), duration=decade(-6, 3))
def test_a_push_is_worth_its_work_over_many_decades(mass, mu, excess, duration):
    level = mu * mass * 9.81
    push = level * (1 + excess)
    stop = duration * (1 + excess)  # momentum: (F - f) T = f (t - T)
    block = SpringBlock(mass=mass, drive=Pulse(level=push, duration=duration))
    run = simulate(block, Coulomb(kinetic_coefficient=mu), t_end=2.0 * stop)
    travel = push * (push - level) * duration**2 / (2 * level * mass)
    # cancellation of the push against the level costs two digits of the solver's 1e-12
    assert math.isclose(run["x"][-1], travel, rel_tol=1e-9)


@examples(60)
@given(mass=decade(-6, 6), mu=decade(-2, 0.5), share=nearly(0.1, 0.9), stiffness=decade(-3, 6))
def test_a_spring_is_worth_its_energy_over_many_decades(mass, mu, share, stiffness):
    level = mu * mass * 9.81
    compression = level / (share * stiffness)  # the spring pushes harder than friction holds
    travel = 0.5 * stiffness * compression**2 / level
    w = math.sqrt(stiffness / mass)
    t_end = 2.0 * (math.pi / w + compression * w / (mu * 9.81))
    rig = SpringBlock(mass=mass, stiffness=stiffness, compression=compression)
    run = simulate(rig, Coulomb(kinetic_coefficient=mu), t_end=t_end)
    if share <= 0.5:
        assert math.isclose(run["x"][-1], travel, rel_tol=1e-9)  # as above
    else:  # stops before it leaves the spring: two friction lengths short of the mirror image
        stop = 2 * (compression - level / stiffness)
        assert math.isclose(run["x"][-1], stop, rel_tol=1e-9)


# Symmetries


def mirrored(value):
    """Return a rig or drive with every force and length that has a direction turned round."""
    signed = {
        "level",
        "high",
        "low",
        "rate",
        "amplitude",
        "compression",
        "speed",
        "offset",
        "incline",
    }
    changes = {}
    for field in dataclasses.fields(value):
        part = getattr(value, field.name)
        if field.name in signed:
            changes[field.name] = -part
        elif isinstance(value, PiecewiseLinear) and field.name == "values":
            changes[field.name] = tuple(-one for one in part)
        elif isinstance(value, Sum):
            changes[field.name] = tuple(mirrored(one) for one in part)
        elif isinstance(part, Drive):
            changes[field.name] = mirrored(part)
    return dataclasses.replace(value, **changes)


@each_law
@FEW
@given(data=st.data(), rig=rigs, y0=starts)
def test_a_mirrored_rig_moves_in_mirror_image(kind, data, rig, y0):
    # which way bristles face at rest without a force is a convention, and their turning an event
    assume(kind in RIGID or y0["v"] != 0)
    law = data.draw(laws(kind))
    if "viscous_exponent" in fields_of(kind):
        # where the plateau of a power begins is found to the tolerance of stiff runs, 1e-6, on
        # either side by itself: mirror images then agree to 1e-8 and not to the last bit
        law = dataclasses.replace(law, viscous_exponent=1.0)
    run = simulate(rig, law, t_end=T_END, y0=y0, throw=False)
    start = {name: -value for name, value in y0.items()}
    image = simulate(mirrored(rig), mirrored_law(law), t_end=T_END, y0=start, throw=False)
    mirrors(run, image, kind)


POWERS = {
    "m": 1, "m/s": 1, "m/s^2": 1, "N": 1, "N/s": 1, "1/m": -1, "s/m": -1, "N s^2/m^2": -1,
    "1": 0, "kg": 0, "1/s": 0, "N/m": 0, "N s/m": 0, "s": 0, "Hz": 0, "rad": 0,
}  # fmt: skip
"""How a quantity grows with all lengths and forces, times and masses being kept."""


def scaled(value, factor):
    changes = {}
    for field in dataclasses.fields(value):
        part = getattr(value, field.name)
        quantity = fields_of(type(value)).get(field.name)
        if quantity is not None and part is not None:
            changes[field.name] = part * factor ** POWERS[quantity.unit]
        elif isinstance(value, PiecewiseLinear) and field.name == "values":
            changes[field.name] = tuple(one * factor for one in part)
        elif isinstance(value, Sum):
            changes[field.name] = tuple(scaled(one, factor) for one in part)
        elif isinstance(part, Parametrised):
            changes[field.name] = scaled(part, factor)
    return dataclasses.replace(value, **changes)


@pytest.mark.parametrize("kind", each_of(SCALABLE))
@FEW
@given(data=st.data(), rig=rigs, y0=starts, doublings=st.integers(-20, 20))
def test_a_rig_a_million_times_larger_or_smaller_moves_alike_to_the_last_bit(
    kind, data, rig, y0, doublings
):
    law = data.draw(laws(kind))
    if "viscous_exponent" in fields_of(kind):
        # a power of the speed is over 1 m/s, whatever the size of the rig
        law = dataclasses.replace(law, viscous_exponent=1.0)
    factor = 2.0**doublings  # powers of two round nothing
    run = simulate(rig, law, t_end=T_END, y0=y0, throw=False)
    other = simulate(
        scaled(rig, factor),
        scaled(law, factor),
        t_end=T_END,
        y0={name: value * factor for name, value in y0.items()},
        throw=False,
    )
    np.testing.assert_array_equal(other.t, run.t)
    for name in ("x", "v", "friction"):
        np.testing.assert_array_equal(other[name], run[name] * factor)


@each_law
@examples(6)  # runs of stiff bristles take half a minute
@given(data=st.data(), share=nearly(0.1, 0.9))
def test_a_run_can_be_continued_from_any_of_its_states(kind, data, share):
    law = data.draw(laws(kind))
    rig = dataclasses.replace(data.draw(spring_blocks), drive=None)
    bristles = law.states if law.states else ()
    names = ("x", "v", *bristles)
    run = simulate(rig, law, t_end=T_END)
    middle = run.at(share * T_END)
    y0 = {name: float(middle[name][0]) for name in names}
    rest = simulate(rig, law, t_end=(1 - share) * T_END, y0=y0)
    # tolerances of 1e-8 with bristles and 1e-12 without, some hundred steps of each
    allowed = 1e-5 if bristles else 1e-9
    for name in ("x", "v"):
        size = np.abs(run[name]).max()
        assert abs(rest[name][-1] - run[name][-1]) <= allowed * size


# The certificate


@each_law
@examples(25)
@given(data=st.data(), rig=rigs, y0=starts)
def test_every_run_is_certified(kind, data, rig, y0):
    law = data.draw(laws(kind))
    run = simulate(rig, law, t_end=T_END, y0=y0, throw=False)
    assert run.status.complete
    assert run.certificate.problems == ()
    # for the tolerances of the solver see there; energies add up over some hundred steps
    assert run.certificate.energy_error <= (1e-5 if law.states else 1e-8)
    assert run.certificate.guard_violation <= 1e-9
    assert run.certificate.stick_drift == 0


@rigid
@examples(20)
@given(data=st.data(), rig=rigs, y0=starts)
def test_friction_stays_in_its_cone_and_a_stuck_body_does_not_move(kind, data, rig, y0):
    law = data.draw(laws(kind))
    run = simulate(rig, law, t_end=T_END, y0=y0).sampled(301)
    stuck = run["mode"] == 0
    level = held_by(law, run["friction"], run["normal_force"])
    # located to rounding, so that the level is met to rounding at either end of a stick
    assert np.all(np.abs(run["friction"][stuck]) <= level[stuck] * (1 + 1e-9) + 1e-12)
    assert np.all(run["v"][stuck] == 0)
    slips = ~stuck & (np.abs(run["v"]) > 1e-9)
    assert np.all(np.sign(run["v"][slips]) == run["mode"][slips])
    assert np.all(run["friction"] * run["v"] >= -1e-12)  # rounding of the speed at an event


@rigid
@examples(20)
@given(data=st.data(), y0=starts)
def test_without_a_drive_friction_only_takes_energy(kind, data, y0):
    law = data.draw(laws(kind))
    rig = dataclasses.replace(data.draw(spring_blocks), drive=None, attached=False)
    run = simulate(rig, law, t_end=T_END, y0=y0).sampled(301)
    gap = rig.compression - run["x"]
    spring = np.where(gap * rig.compression > 0, 0.5 * rig.stiffness * gap**2, 0.0)
    lifted = rig.mass * rig.gravity * math.sin(rig.incline) * run["x"]
    energy = spring + lifted + 0.5 * rig.mass * run["v"] ** 2
    size = np.abs(lifted).max() + np.abs(energy).max()
    assert np.all(np.diff(energy) <= 1e-9 * size)  # the certificate's limit


@rigid
@FEW
@given(data=st.data(), rig=rigs, y0=starts)
def test_a_coarser_tolerance_gives_the_same_run_coarsely(kind, data, rig, y0):
    law = data.draw(laws(kind))
    fine = simulate(rig, law, t_end=T_END, y0=y0)
    coarse = simulate(rig, law, t_end=T_END, y0=y0, solver=EventDriven(tolerance=1e-8))
    # 1e-8 a step; a stop that is just missed or just met is reached as the square root of it
    size = np.abs(fine["x"]).max() + np.abs(fine["v"]).max() * T_END
    assert abs(coarse["x"][-1] - fine["x"][-1]) <= 1e-4 * size

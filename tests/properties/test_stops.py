"""What must hold for every rig with hard stops, every law and every drive."""

import dataclasses

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.support import (
    RIGID,
    UNAIDED,
    axes,
    each_of,
    examples,
    held_by,
    laws,
    mirrored_law,
    mirrors,
    nearly,
    spring_blocks,
)

from stickslip import SpringBlock, simulate
from stickslip.friction import LAWS
from stickslip.mechanisms.drives import Drive, PiecewiseLinear, Pulse, Sum

T_END = 1.5
each_law = pytest.mark.parametrize("kind", each_of(UNAIDED.values()))
starts = st.fixed_dictionaries(
    {"x": nearly(-0.05, 0.05) | st.just(0.0), "v": nearly(-2, 2) | st.just(0.0)}
)
bounds = st.fixed_dictionaries(
    {
        "lower_stop": st.none() | nearly(-0.3, -0.05),
        "upper_stop": nearly(0.05, 0.3),
        "restitution": st.just(0.0) | nearly(0.1, 0.9),
    }
)


@st.composite
def bounded(draw, rigs=axes | spring_blocks):
    return dataclasses.replace(draw(rigs), **draw(bounds))


def mirrored(value):
    """Return a rig or drive turned round."""
    changes = {}
    for field in dataclasses.fields(value):
        part = getattr(value, field.name)
        if field.name in ("level", "high", "low", "compression", "offset", "incline"):
            changes[field.name] = -part
        elif isinstance(value, PiecewiseLinear) and field.name == "values":
            changes[field.name] = tuple(-one for one in part)
        elif isinstance(value, Sum):
            changes[field.name] = tuple(mirrored(one) for one in part)
        elif isinstance(part, Drive):
            changes[field.name] = mirrored(part)
    if hasattr(value, "upper_stop"):
        ends = (value.lower_stop, value.upper_stop)
        low, high = (None if end is None else -end for end in ends)
        changes |= {"lower_stop": high, "upper_stop": low}
    return dataclasses.replace(value, **changes)


@each_law
@examples(25)
@given(data=st.data(), rig=bounded(), y0=starts)
def test_every_run_is_certified_and_stays_within_its_stops(kind, data, rig, y0):
    law = data.draw(laws(kind, plain=True))
    run = simulate(rig, law, t_end=T_END, y0=y0, throw=False)
    assert run.status.complete
    assert run.certificate.problems == ()
    assert run.certificate.work_stops >= 0
    low = -np.inf if rig.lower_stop is None else rig.lower_stop
    # steps end at an impact or before it; within a step the polynomial is good to rounding
    assert np.all(run["x"] <= rig.upper_stop)
    assert np.all(run["x"] >= low)
    seen = run.sampled(301)
    assert np.all(seen["x"] <= rig.upper_stop * (1 + 1e-12))
    assert np.all(seen["x"] >= low * (1 + 1e-12))
    held = np.abs(seen["mode"]) == 2
    assert np.all(seen["v"][held] == 0)
    assert np.all(seen["x"][seen["mode"] == 2] == rig.upper_stop)


@each_law
@examples(12)
@given(data=st.data(), rig=bounded(), y0=starts)
def test_a_mirrored_rig_bounces_in_mirror_image(kind, data, rig, y0):
    # which way bristles face at rest without a force is a convention, and their turning an event
    assume(kind in RIGID or y0["v"] != 0)
    law = data.draw(laws(kind, plain=True))
    run = simulate(rig, law, t_end=T_END, y0=y0, throw=False)
    start = {name: -value for name, value in y0.items()}
    image = simulate(mirrored(rig), mirrored_law(law), t_end=T_END, y0=start, throw=False)
    if mirrors(run, image, kind, sums=rig.drive is not None and rig.stiffness > 0.0):
        assert image.certificate == run.certificate


@pytest.mark.parametrize("kind", RIGID, ids=lambda kind: kind.name)
@examples(25)
@given(data=st.data(), rig=bounded(), y0=starts)
def test_friction_stays_in_its_cone_at_a_stop_too(kind, data, rig, y0):
    law = data.draw(laws(kind, plain=True))
    run = simulate(rig, law, t_end=T_END, y0=y0).sampled(301)
    still = np.abs(run["mode"]) != 1
    level = held_by(law, run["friction"], run["normal_force"])
    # located to rounding, so that the level is met to rounding at either end
    assert np.all(np.abs(run["friction"][still]) <= level[still] * (1 + 1e-9) + 1e-12)


@examples(25)
@given(level=nearly(-20, 20), duration=nearly(0.05, 0.5), share=nearly(0.1, 0.9))
def test_a_stop_that_is_never_reached_changes_nothing(level, duration, share):
    free = SpringBlock(mass=1.0, drive=Pulse(level=level, duration=duration))
    law = LAWS["coulomb"](kinetic_coefficient=share)
    run = simulate(free, law, t_end=T_END)
    reach = float(np.abs(run["x"]).max()) + 1e-3
    fenced = dataclasses.replace(free, lower_stop=-reach, upper_stop=reach, restitution=share)
    other = simulate(fenced, law, t_end=T_END)
    np.testing.assert_array_equal(other["x"], run["x"])
    assert other.events == run.events

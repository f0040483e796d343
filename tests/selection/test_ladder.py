"""Usual candidates of records are fitted a part at a time, as far as a part is shown to gain."""

from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import Axis, Measurement, RecordSettings, select, simulate
from stickslip.drives import Sampled
from stickslip.friction import law, specification, usual_specifications
from stickslip.friction.registry import rungs
from stickslip.identification.estimation.containment import FittedLaw
from stickslip.selection import fitted_side_by_side
from stickslip.selection.candidates import contains

AXIS = Axis(inertia=1.0)
QUICK = RecordSettings(starts=1)
PARTS = {"direction-dependent", "stribeck", "power-viscous", "quadratic-drag"}
FIRST = {"viscous", "coulomb", "coulomb-viscous", *PARTS}
TWO_SIDED = "both_ways(level + stribeck + viscous)"


def table(kind, noise=0.01, seed=1, **values):
    """Friction of a law at 80 speeds of both directions, with noise."""
    random = np.random.default_rng(seed)
    v = np.geomspace(1e-3, 1.0, 80) * np.resize([1.0, -1.0], 80)
    friction = np.array([law(kind)(**values).force(one, 1.0) for one in v])
    return Measurement(velocity=v, friction=friction + noise * random.normal(size=v.size))


def tilted(**more):
    return table(
        TWO_SIDED,
        forward_kinetic_coefficient=2.0,
        backward_kinetic_coefficient=2.5,
        forward_static_coefficient=3.0,
        backward_static_coefficient=3.2,
        forward_stribeck_velocity=0.05,
        backward_stribeck_velocity=0.03,
        forward_viscous_coefficient=1.0,
        backward_viscous_coefficient=2.0,
        **more,
    )


def plain(**more):
    return table("level + viscous", kinetic_coefficient=2.0, viscous_coefficient=3.0, **more)


@pytest.fixture(scope="module")
def climbed():
    return select(AXIS, None, tilted(), settings=QUICK)


def names(verdict):
    return {one.name for one in verdict.candidates}


@pytest.mark.slow
def test_a_law_of_two_parts_is_reached_through_those_of_one(climbed):
    assert climbed.best.name == law(TWO_SIDED).name
    assert climbed.best.score < 0.3 * min(
        one.score for one in climbed.candidates if one.name in FIRST
    )
    assert {"direction-dependent", "stribeck"} <= {*climbed.best.simpler}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (
            "level + stribeck + power",
            {
                "kinetic_coefficient": 2.0,
                "static_coefficient": 3.0,
                "stribeck_velocity": 0.02,
                "viscous_coefficient": 3.0,
                "viscous_exponent": 0.5,
            },
        ),
        (
            "both_ways(level + power)",
            {
                "forward_kinetic_coefficient": 2.0,
                "backward_kinetic_coefficient": 2.6,
                "forward_viscous_coefficient": 3.0,
                "backward_viscous_coefficient": 2.0,
                "forward_viscous_exponent": 0.4,
                "backward_viscous_exponent": 0.5,
            },
        ),
    ],
)
def test_other_pairs_of_parts_are_reached_too(kind, values):
    found = select(AXIS, None, table(kind, **values), settings=QUICK)
    assert found.best.name == law(kind).name


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 4])
def test_where_simple_friction_suffices_no_richer_law_is_fitted(seed):
    found = select(AXIS, None, plain(seed=seed), settings=QUICK)
    assert found.best.name == "coulomb-viscous"
    assert names(found) <= {*FIRST, "dahl"}
    # of a table, one law with memory says why none serves
    suited = [one for one in usual_specifications() if one.name == "dahl" or not one.law.states]
    left = len(suited) - len(found.candidates)
    (said,) = (one for one in found.missing if "not tried" in one)
    assert said == (
        f"{left} richer candidates not tried: no law with one part more is shown to hold over"
        " Coulomb + viscous friction."
    )
    told = found.to_dict()["not_tried"]
    assert (len(told["laws"]), told["why"]) == (left, said)
    assert "stribeck-power" in told["laws"]


def test_noise_that_was_stated_leaves_no_room_for_more():
    record = tilted(noise=0.05)
    stated = Measurement(
        velocity=record.velocity, friction=record.friction, uncertainty={"friction": 2.0}
    )
    found = select(AXIS, None, stated, settings=QUICK)
    assert names(found) == FIRST
    assert "leaves no more than noise" in found.why_untried


@pytest.mark.slow
def test_laws_that_were_named_are_all_fitted():
    found = select(AXIS, ["coulomb", "stribeck", "level + stribeck + power"], plain())
    assert names(found) == {"coulomb", "stribeck", "level + stribeck + power"}
    assert found.why_untried == ""
    assert not found.usual


@pytest.mark.slow
def test_the_ladder_is_the_same_with_several_workers(climbed):
    with ThreadPoolExecutor(2) as executor:
        again = select(AXIS, None, tilted(), settings=QUICK, executor=executor)
    assert [one.name for one in again.candidates] == [one.name for one in climbed.candidates]
    assert [one.score for one in again.candidates] == [one.score for one in climbed.candidates]
    assert again.sentence == climbed.sentence
    assert again.untried == climbed.untried


def test_a_search_that_is_stopped_climbs_no_further():
    told = []

    def stop(name, _):
        told.append(name)
        return "stribeck" not in told

    found = select(AXIS, None, tilted(), settings=QUICK, progress=stop)
    assert law(TWO_SIDED).name not in names(found)
    assert {name for name in told if not name.startswith("held-out")} <= FIRST
    assert "not tried: the search was stopped." in found.why_untried


@pytest.mark.slow
def test_directions_are_not_told_apart_on_motion_of_one_direction():
    record = tilted()
    forwards = np.asarray(record.velocity) > 0.0
    one_way = Measurement(velocity=record.velocity[forwards], friction=record.friction[forwards])
    found = select(AXIS, None, one_way, settings=QUICK)
    assert found.closest.name == "stribeck"
    kinds = [
        one.law for one in usual_specifications() if one.name in (*names(found), *found.untried)
    ]
    assert not any(kind.directional for kind in kinds)


@pytest.mark.slow
def test_memory_is_not_tried_where_the_force_balance_does_not_ask_for_it():
    t = np.arange(0.0, 6.0, 2e-3)
    force = 6.0 * np.sin(2.0 * t) + 3.0 * np.sin(5.0 * t)
    friction = law("level + viscous")(kinetic_coefficient=2.0, viscous_coefficient=1.0)
    driven = Axis(inertia=1.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    x = np.asarray(simulate(driven, friction, t_end=float(t[-1])).at(t)["x"])
    x = x + 1e-4 * np.random.default_rng(2).normal(size=t.size)
    record = Measurement(time=t, position=x, force=force)
    found = select(AXIS, None, record, route="shooting", settings=QUICK)
    assert found.best.name == "coulomb-viscous"
    assert len(found.candidates) <= 5
    assert not any(one.law.states for one in found.candidates)


def test_every_rung_contains_those_that_it_is_reached_from():
    candidates = {one.name: one for one in usual_specifications()}
    own_shapes = []
    for name, rung in rungs().items():
        for above in rung.above():
            rich = candidates[above.specification.name]
            if not contains(rich, candidates[name]):
                own_shapes.append((rung, above))
    # only bristles share what is no level between the directions
    assert all(
        rung.both_ways
        and above.memory
        and not rung.memory
        and (rung.stribeck or rung.flow == "power")
        for rung, above in own_shapes
    )


@pytest.mark.parametrize("executor", [None, ThreadPoolExecutor(2)])
def test_laws_with_memory_are_told_what_the_leader_leaves(executor):
    told = {}

    def fitted(one, contained, rival, watch=None):
        told[one.name] = rival
        own = FittedLaw(law=one.law, values={}, cost=COSTS[one.name], rows=1)
        return SimpleNamespace(name=one.name, fit=None, fitted_law=own)

    chosen = [specification(name) for name in COSTS]
    fitted_side_by_side(fitted, chosen, None, executor, leader="gms")
    assert told == {"coulomb-viscous": 0.0, "gms": 9.0, "dahl": 1.0, "lugre": 1.0}
    fitted_side_by_side(fitted, chosen, None, executor)
    assert told["dahl"] == told["lugre"] == 9.0


COSTS = {"dahl": 5.0, "lugre": 4.0, "gms": 1.0, "coulomb-viscous": 9.0}

"""Usual candidates of records are fitted a part at a time, as far as a part is shown to gain."""

import math
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import Axis, Measurement, RecordSettings
from stickslip.friction import law, specification, usual_specifications
from stickslip.friction.registry import rungs
from stickslip.identification import RouteChoice
from stickslip.identification.estimation.containment import FittedLaw
from stickslip.identification.records.fitting import fit_record
from stickslip.kinds.joints.joint_verdict import RecordCandidate
from stickslip.kinds.joints.judging import with_contained
from stickslip.kinds.joints.ladder import climbed
from stickslip.selection import LEFT_OUT, effective_aic, fitted_side_by_side
from stickslip.selection.candidates import contains

AXIS = Axis(inertia=1.0)
ROUTE = RouteChoice(route="force-map", settings=RecordSettings(starts=1))
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


def fitted_to(measurement, one, contained=(), rival=0.0, watch=None):
    """Fit a law; one that the watcher stops before is left out."""
    own = {"name": one.name, "title": one.title, "validation": None}
    if watch is not None and watch(one.name, math.nan) is False:
        return RecordCandidate(**own, fit=None, dropped=LEFT_OUT)
    fit = fit_record(
        AXIS, one.law, measurement, route=ROUTE, free=one.free, contained=[*contained], rival=rival,
        watch=None if watch is None else partial(watch, one.name),
    )  # fmt: skip
    return RecordCandidate(**own, fit=fit)


def climb(measurement, *, watch=None, executor=None, noise=0.0, usual=True, laws=None):
    """Climb the laws without memory on friction at speeds, which are fitted in milliseconds."""
    fitted = partial(fitted_to, measurement)
    chosen = laws or [one for one in usual_specifications() if not one.law.states]
    return climbed(
        chosen,
        fitted,
        watch,
        executor,
        seen=with_contained,
        at_noise=lambda one: one.residual <= noise,
        usual=usual,
    )


@pytest.fixture(scope="module")
def tilted_climb():
    return climb(tilted())


def names(found):
    return {one.name for one in found.tried}


def least(found):
    """The name of the law that is the closest for its parameters."""
    aic = effective_aic([one for one in found.tried if one.fit])
    return min(aic, key=aic.get)


@pytest.mark.slow
def test_a_law_of_two_parts_is_reached_through_those_of_one(tilted_climb):
    assert least(tilted_climb) == law(TWO_SIDED).name
    by_name = {one.name: one for one in with_contained(tilted_climb.tried, tilted_climb.specs)}
    two = by_name[law(TWO_SIDED).name]
    assert two.residual < 0.3 * min(by_name[name].residual for name in FIRST)
    assert {"direction-dependent", "stribeck"} <= {*two.simpler}


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
    assert law(kind).name in names(climb(table(kind, **values)))


@pytest.mark.parametrize("seed", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_where_simple_friction_suffices_no_richer_law_is_fitted(seed):
    found = climb(plain(seed=seed))
    assert names(found) <= FIRST
    suited = [one for one in usual_specifications() if not one.law.states]
    left = len(suited) - len(found.tried)
    assert found.why == (
        f"{left} richer candidates not tried: no law with one part more is shown to hold over"
        " Coulomb + viscous friction."
    )
    assert len(found.untried) == left
    assert "stribeck-power" in found.untried


def test_noise_that_was_stated_leaves_no_room_for_more():
    found = climb(tilted(noise=0.05), noise=2.0)
    assert names(found) == FIRST
    assert "leaves no more than noise" in found.why


def test_laws_that_were_named_are_all_fitted():
    chosen = [specification(one) for one in ("coulomb", "level + stribeck + power", "stribeck")]
    found = climb(plain(), laws=chosen, usual=False)
    assert names(found) == {"coulomb", "stribeck", "level + stribeck + power"}
    assert found.why == ""


@pytest.mark.slow
def test_the_ladder_is_the_same_with_several_workers(tilted_climb):
    with ThreadPoolExecutor(2) as executor:
        again = climb(tilted(), executor=executor)
    assert [one.name for one in again.tried] == [one.name for one in tilted_climb.tried]
    assert [one.residual for one in again.tried] == [one.residual for one in tilted_climb.tried]
    assert again.untried == tilted_climb.untried


def test_a_search_that_is_stopped_climbs_no_further():
    told = []

    def stop(name, _):
        told.append(name)
        return "stribeck" not in told

    found = climb(tilted(), watch=stop)
    assert law(TWO_SIDED).name not in names(found)
    assert {*told} <= FIRST
    assert "not tried: the search was stopped." in found.why


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

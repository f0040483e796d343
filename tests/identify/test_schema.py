"""The document of a verdict: it is what its JSON schema says."""

import copy
import json

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from stickslip import Axis, Measurement, SpringBlock, select
from stickslip.identify import BandVerdict
from stickslip.show.documents import document, json_text

SCHEMA = BandVerdict.schema()
T = np.arange(0.0, 8.0, 0.004)
POSITION = 0.5 * np.sin(2.0 * T) + 0.3 * np.sin(4.6 * T)
VELOCITY = np.cos(2.0 * T) + 1.38 * np.cos(4.6 * T)
ACCELERATION = -2.0 * np.sin(2.0 * T) - 6.348 * np.sin(4.6 * T)


def noise(size, count, seed=0):
    return size * np.random.default_rng(seed).normal(size=count)


def table():
    v = np.tile(np.geomspace(0.05, 1.0, 8), 3)
    load = np.repeat([5.0, 10.0, 20.0], 8)
    friction = 0.2 * load + 0.5 * v + noise(0.02, 24)
    friction[5] *= 1.5  # an outlier
    again = Measurement(velocity=v, friction=0.2 * load + 0.5 * v + noise(0.02, 24, 1), load=load)
    return select(
        Axis(inertia=1.0), None, Measurement(velocity=v, friction=friction, load=load),
        validate=again,
    )  # fmt: skip


def record():
    force = 0.05 * ACCELERATION + np.sign(VELOCITY) + 0.3 * VELOCITY + 0.4 * POSITION
    measured = Measurement(
        time=T,
        position=POSITION + noise(3e-5, T.size, 1),
        force=force + noise(0.02, T.size),
        turning=True,
    )
    return select(
        Axis(inertia=0.05), None, measured, vary=["friction.*", "mechanism.inertia"],
        route="balance",
    )  # fmt: skip


def force_map():
    friction = np.sign(VELOCITY) + 0.3 * VELOCITY + noise(0.02, T.size)
    measured = Measurement(time=T, position=POSITION, friction=friction)
    return select(Axis(inertia=0.05), None, measured, route="balance")


def travels():
    trials = tuple(
        Measurement(travel=s, uncertainty=0.001, overrides={"mechanism.compression": x})
        for x, s in ((0.06, 0.105), (0.08, 0.188), (0.10, 0.292), (0.12, 0.42))
    )
    rig = SpringBlock(mass=0.82, stiffness=145.0, compression=0.06)
    return select(rig, ["coulomb", "coulomb-viscous", "viscous"], Measurement(trials=trials))


@pytest.fixture(scope="module", params=[table, record, force_map, travels])
def content(request):
    verdict = request.param()
    return json.loads(json_text(document("select", {"rig": "Axis", **verdict.to_dict()})))


def test_the_schema_is_one_and_describes_every_part():
    Draft202012Validator.check_schema(SCHEMA)
    assert all(one.get("description") for one in SCHEMA["properties"].values())
    # nothing is described that a verdict may leave out, but for the heading of the file
    heading = {"schema", "stickslip", "rig", "digest"}
    assert {*SCHEMA["required"]} | heading == {*SCHEMA["properties"]}


def test_the_document_of_a_verdict_is_what_the_schema_says(content):
    Draft202012Validator(SCHEMA).validate(content)
    band = content["band"]
    over = "setting" if content["route"] == "travel" else "velocity"
    assert len({len(band[name]) for name in (over, "low", "median", "high")}) == 1
    # those of the laws that are listed and that of the measured curve are of one posterior
    shares = [entry["share"] for entry in content["candidates"]] + [content["curve_share"] or 0.0]
    assert sum(shares) <= 1.0 + 1e-9
    assert content["candidates"][0]["law"] == content["closest"]


def test_documents_that_lack_a_part_or_have_another_are_refused(content):
    validator = Draft202012Validator(SCHEMA)
    for name in SCHEMA["required"]:
        assert not validator.is_valid({k: x for k, x in content.items() if k != name})
    assert not validator.is_valid({**content, "more": 1})
    changed = copy.deepcopy(content)
    changed["candidates"][0]["share"] = -1.0
    assert not validator.is_valid(changed)

"""Records in which some joints rest: these are said and not fitted, and spoil nothing."""

from dataclasses import replace

import numpy as np
import pytest
from tests.arm_cases import ARM, JOINTS, QUICK, TRUTH, motion, parts, record
from tests.support import quick

from stickslip import CoulombViscous, Measurement, check, fit
from stickslip.engine.formulation import JointTorques
from stickslip.identify.problems.joint_motions import resting_of

BOTH = dict.fromkeys(JOINTS, CoulombViscous)
COUNT = 2.0 * np.pi / 4096.0
RESTS = {
    "constant": lambda t, rng: np.zeros_like(t),
    "a jitter of one count in one of a hundred samples": lambda t, rng: (
        COUNT * (rng.random(len(t)) < 0.01)
    ),
    "a jitter of one count either way": lambda t, rng: (
        COUNT * np.rint(np.clip(rng.normal(0.0, 0.25, len(t)), -1.0, 1.0))
    ),
    "noise": lambda t, rng: rng.normal(0.0, 1e-4, len(t)),
    "a drift of 20 counts": lambda t, rng: COUNT * np.rint(20.0 * t / t[-1]),
}


def resting(joint, rest, seed=0, jitter=0.0):
    """Return a record in which one joint rests, with what its encoder shows."""
    i = JOINTS.index(joint)
    t, q, v, a = motion(seed, jitter=jitter)
    q[:, i], v[:, i], a[:, i] = 0.4, 0.0, 0.0
    forces, _ = JointTorques.of(ARM, []).along(ARM, t, q, v, a)
    for k, name in enumerate(JOINTS):
        forces[:, k] += TRUTH[name].force(v[:, k], 1.0)
    rng = np.random.default_rng(seed)
    forces += rng.normal(0.0, 0.01, forces.shape)
    forces[:, i] = 0.0  # off: friction holds it
    q[:, i] += RESTS[rest](t, rng)
    return Measurement(
        time=t,
        position=dict(zip(JOINTS, q.T, strict=True)),
        force=dict(zip(JOINTS, forces.T, strict=True)),
    )


@pytest.mark.slow
@pytest.mark.parametrize("joint", quick(JOINTS, JOINTS[-1]))
@pytest.mark.parametrize("rest", RESTS)
def test_a_joint_that_rests_spoils_nothing_of_its_neighbour(joint, rest):
    other = next(name for name in JOINTS if name != joint)
    found = fit(ARM, BOTH, resting(joint, rest), settings=QUICK)
    assert f"friction.{other}.viscous_coefficient" in {e.path for e in found.estimates}
    assert not any(joint in e.path for e in found.estimates)
    level = found.estimate(f"friction.{other}.kinetic_coefficient")
    # a hundredth: the torque has noise of 0.01 N m, ten times less after the filter; an encoder
    # that drifts by 0.03 rad moves what gravity seems to do to the other joint
    close = 0.03 if "drift" in rest else 0.01
    assert level.value == pytest.approx(TRUTH[other].kinetic_coefficient, rel=close)
    assert list(found.joints) == [other]
    assert found.sentences[0].startswith(f"The joint {joint} rests throughout")


@pytest.mark.parametrize("rest", RESTS)
@pytest.mark.parametrize("jitter", quick([0.1, 0.45], 0.1))
def test_a_joint_rests_at_uneven_times_as_at_even_ones(rest, jitter):
    for value in (0.0, jitter):
        assert resting_of(ARM, resting("elbow", rest, jitter=value)) == ("elbow",)


def test_a_joint_that_rests_is_no_fault_of_a_record_in_which_another_moves():
    found = check(resting("elbow", "constant"), mechanism=ARM)
    assert found.worst == "info"
    (said,) = (finding for finding in found.findings if "rests" in finding.sentence)
    assert said.record == "elbow"


@pytest.mark.slow
def test_a_joint_may_rest_in_one_of_several_records():
    moving, still = record(1, name="both"), resting("elbow", "noise", seed=2)
    trials = Measurement(trials=(moving, replace(still, name="elbow rests")))
    found = fit(ARM, BOTH, trials, settings=QUICK)
    assert {e.path for e in found.estimates} >= {
        f"friction.{name}.kinetic_coefficient" for name in JOINTS
    }
    for name in JOINTS:
        level = found.estimate(f"friction.{name}.kinetic_coefficient").value
        assert level == pytest.approx(TRUTH[name].kinetic_coefficient, rel=0.02)
    assert not any("rests" in sentence for sentence in found.sentences)


@pytest.mark.slow
@pytest.mark.parametrize("rest", RESTS)
def test_the_error_on_a_record_in_which_a_joint_rests_is_finite(rest):
    found = fit(ARM, BOTH, record(1), settings=QUICK)
    seen = found.predict(resting("elbow", rest, seed=2))
    assert ("elbow" in seen) == ("drift" in rest)
    assert np.isfinite(seen["shoulder"].error)
    assert all(np.isfinite(one.error) for one in seen.values())


@pytest.mark.slow
def test_jitter_does_not_set_the_filter_of_joints_that_move():
    still = record(1)
    t, q, u = parts(still)
    jittered = {**q, "elbow": q["elbow"] * 0.0 + COUNT * (np.arange(len(t)) % 90 == 0)}
    fitted = fit(ARM, BOTH, Measurement(time=t, position=jittered, force=u), settings=QUICK)
    other = fit(
        ARM, BOTH, Measurement(time=t, position={**q, "elbow": 0.0 * t}, force=u), settings=QUICK
    )
    # positions of the elbow differ by a ninetieth of a count in the mean
    left = [one.joints["shoulder"].closest.left for one in (fitted, other)]
    assert left[0] == pytest.approx(left[1], rel=1e-2)

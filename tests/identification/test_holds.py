"""Whether a recorded force was held between samples is estimated, and said."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.axis_records import ALL
from benchmarks.axis_records import record as axis_record

from stickslip import Axis, CoulombViscous, Measurement, RecordSettings, fit, simulate
from stickslip.drives import Sampled
from stickslip.identification.residuals.holds import HoldFinding, hold_of

AXIS = Axis(inertia=2.0)
LAW = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=5.0)
ONCE = RecordSettings(starts=1)


def record(hold, *, rate=100.0, seed=0, noise=1e-5, slow=1.0):
    """Return what an axis does under a force that is sampled and held, or joined by lines."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 16.0, 1.0 / rate)
    waves = [(w, rng.uniform(2.0, 5.0), rng.uniform(0.0, 6.0)) for w in (2.3, 6.1, 11.7)]
    force = sum(size * np.sin(slow * w * t + phase) for w, size, phase in waves)
    drive = Sampled(times=t, values=force, hold=hold)
    run = simulate(Axis(inertia=2.0, drive=drive), LAW, t_end=float(t[-1]))
    x = run.at(t)["x"] + noise * rng.standard_normal(len(t))
    return Measurement(time=t, position=x, force=force)


@pytest.fixture(scope="module", params=["zero", "first"])
def truth(request):
    return request.param, record(request.param)


def along(measurement, settings=ONCE):
    return fit(
        Axis(inertia=3.0), CoulombViscous, measurement, vary="inertia",
        route="inverse-dynamics", settings=settings,
    )  # fmt: skip


@pytest.mark.slow
def test_the_hold_that_nobody_gave_is_found_and_intervals_hold_the_truth(truth):
    hold, measurement = truth
    found = along(measurement)
    assert (found.hold.hold, found.hold.shown, found.hold.given) == (hold, hold, False)
    late = 0.5 if hold == "zero" else 0.0
    # the interval of 95 % twice over: a third of a sample is what decides
    assert abs(found.hold.lateness - late) < 2.0 * found.hold.half_width < 0.3
    assert found.estimate("inertia").low < 2.0 < found.estimate("inertia").high
    (sentence,) = found.assumptions
    assert sentence.startswith("Estimated from the record: between samples, the force ")
    assert f'(hold = "{hold}"); ' in sentence
    assert sentence.endswith("half a sample would look the same.") == (hold == "zero")
    assert found.to_dict()["hold"]["shown"] == hold


@pytest.mark.slow
def test_a_given_hold_is_used_and_what_contradicts_it_is_said(truth):
    hold, measurement = truth
    other = "first" if hold == "zero" else "zero"
    wrong = along(measurement, RecordSettings(starts=1, hold=other))
    assert wrong.hold.hold == other
    assert wrong.hold.contradicted
    assert f'does not agree with the given hold = "{other}"' in wrong.assumptions[0]
    assert not wrong.estimate("inertia").low < 2.0 < wrong.estimate("inertia").high
    right = along(measurement, RecordSettings(starts=1, hold=hold))
    assert right.assumptions == ()


def test_a_slow_motion_at_a_high_rate_does_not_tell_the_hold():
    found = hold_of(AXIS, record("zero", rate=500.0, noise=3e-4, slow=0.2), None)
    assert found.shown is None
    # fits by simulation may tell it: only of what was looked at is something said
    assert "The balance of forces does not tell whether" in found.sentence
    assert "Give the hold if it is known, or fit with both" in found.sentence


@pytest.mark.slow
@pytest.mark.parametrize("hold", ["zero", "first"])
def test_runs_tell_the_hold_that_the_balance_of_forces_does_not(hold):
    """Half a sample was taken wrongly, and sigma_2 stated as 5.73 to 5.82 for 6 N s/m."""
    rng, t = np.random.default_rng(12), np.arange(0.0, 3.0, 2e-3)
    force = 12.0 * np.sin(2.0 * np.pi * 0.8 * t)
    law = CoulombViscous(kinetic_coefficient=4.0, viscous_coefficient=6.0)
    drive = Sampled(times=t, values=force, hold=hold)
    run = simulate(Axis(inertia=2.0, drive=drive), law, t_end=float(t[-1]))
    x = run.at(t)["x"] + 1e-5 * rng.standard_normal(len(t))
    seen = Measurement(time=t, position=x, force=force)
    assert hold_of(AXIS, seen, None).shown is None
    found = fit(AXIS, CoulombViscous, seen, route="shooting", settings=ONCE)
    assert (found.hold.shown, found.hold.simulated) == (hold, True)
    assert found.assumptions[0].startswith("Estimated by simulation under both holds: ")
    viscous = found.estimate("viscous_coefficient")
    assert viscous.low < 6.0 < viscous.high
    assert viscous.value == pytest.approx(6.0, rel=1e-3)  # noise of 1e-5 m; half a sample takes 4 %


@pytest.mark.slow
def test_where_nothing_tells_the_hold_intervals_allow_for_either():
    unsure = record("zero", rate=500.0, noise=3e-2, slow=0.2)
    found = fit(AXIS, CoulombViscous, unsure, route="shooting", settings=ONCE)
    assert found.hold.is_open
    assert "intervals allow for either" in found.assumptions[0]
    for hold in ("zero", "first"):
        given = RecordSettings(starts=1, hold=hold)
        one = fit(AXIS, CoulombViscous, unsure, route="shooting", settings=given)
        for either, own in zip(found.estimates, one.estimates, strict=True):
            assert either.low <= own.value <= either.high


def test_measured_friction_and_free_decays_have_no_hold():
    v = np.linspace(-1.0, 1.0, 50)
    assert hold_of(AXIS, Measurement(velocity=v, friction=2.0 * v), None) is None
    t = np.linspace(0.0, 5.0, 500)
    assert hold_of(AXIS, Measurement(time=t, position=np.exp(-t)), None) is None


@pytest.mark.slow
@pytest.mark.parametrize("truth", ["zero", "first"])
def test_where_samples_are_too_coarse_for_accelerations_residuals_of_both_fits_tell(truth):
    """What the sentence advises: at 20 Hz, half a sample is hundreds of times the noise."""
    coarse = record(truth, rate=20.0, seed=1)
    found = hold_of(AXIS, coarse, None)
    assert found.shown is None
    assert "compare the residuals" in found.sentence
    left = {}
    for hold in ("zero", "first"):
        settings = RecordSettings(starts=1, hold=hold)
        one = fit(Axis(inertia=3.0), CoulombViscous, coarse, vary="inertia", settings=settings)
        left[hold] = float(np.std(one.residual))
    assert min(left, key=left.__getitem__) == truth
    assert max(left.values()) > 10.0 * min(left.values())


@pytest.mark.parametrize(("lateness", "half_width"), [(6.45, 0.26), (-2.0, 0.5), (0.7, 5.7)])
def test_an_estimate_that_no_hold_explains_or_that_is_vague_is_no_number_of_a_hold(
    lateness, half_width
):
    said = HoldFinding(hold="zero", lateness=lateness, half_width=half_width).sentence
    assert "does not tell" in said
    assert "samples" not in said.replace("between samples", "")
    close = HoldFinding(hold="zero", lateness=0.4, half_width=0.3).sentence
    assert "0.40 ± 0.30 samples later" in close


@pytest.mark.slow
def test_intervals_allow_for_a_force_that_is_recorded_later_than_any_hold():
    """By 4 ms: the inertia was stated as 0.0184 to 0.0189 kg m^2 for 0.02, with no word of it."""
    truth = next(one for one in ALL if one.name == "f_delay1")
    found = fit(
        Axis(inertia=0.026), CoulombViscous, axis_record(truth, 9442).measured,
        vary="inertia", route="shooting", settings=ONCE,
    )  # fmt: skip
    assert found.hold.is_open
    assert found.hold.apart > 3.0
    inertia = found.estimate("inertia")
    assert inertia.value < 0.019
    assert inertia.low < 0.02 < inertia.high


def test_what_runs_leave_open_beyond_either_hold_is_said():
    open_ = HoldFinding(hold="zero", lateness=0.31, half_width=0.21, simulated=True, apart=3.0)
    assert "it may act up to 1.5 samples earlier or later" in open_.sentence
    assert "intervals allow for either" in replace(open_, apart=1.0).sentence


@pytest.mark.parametrize(
    ("finding", "half_samples"),
    [
        (HoldFinding(hold="zero", given=True, lateness=0.7, half_width=0.1), 0.0),
        (HoldFinding(hold="zero", lateness=0.6, half_width=0.1, shown="zero"), 0.4),
        (HoldFinding(hold="first", lateness=-0.05, half_width=0.05, shown="first"), 0.2),
        (HoldFinding(hold="zero", simulated=True, apart=3.0), 3.0),
    ],
)
def test_how_far_a_hold_may_be_wrong_in_half_samples(finding, half_samples):
    assert finding.unsure == pytest.approx(half_samples)

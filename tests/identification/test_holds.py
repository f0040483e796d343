"""Whether a recorded force was held between samples is estimated, and intervals include a doubt."""

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, RecordSettings, fit, simulate
from stickslip.identify.fits.shooting.problems import HoldFinding, hold_of
from stickslip.mechanisms.drives import Sampled

AXIS = Axis(inertia=2.0)
LAW = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=5.0)


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


def along(measurement, hold=None, route="balance"):
    settings = RecordSettings(hold=hold)
    return fit(
        Axis(inertia=3.0), CoulombViscous, measurement, vary="inertia", route=route,
        settings=settings,
    )  # fmt: skip


def test_intervals_hold_the_mass_whichever_hold_nobody_gave():
    held = 0
    for hold in ("zero", "first"):
        for seed in (0, 3):
            inertia = along(record(hold, seed=seed)).estimate("inertia")
            held += inertia.low < 2.0 < inertia.high
            assert inertia.value == pytest.approx(2.0, rel=5e-3)
    # four intervals of 95 % miss no more than once with a probability of 98.6 %
    assert held >= 3


@pytest.mark.slow
@pytest.mark.parametrize("hold", ["zero", "first"])
def test_the_hold_that_nobody_gave_is_found_by_segments(hold):
    found = along(record(hold), route="shooting")
    assert (found.hold.hold, found.hold.told, found.hold.given) == (hold, True, False)
    late = 0.5 if hold == "zero" else 0.0
    # the interval of 95 % twice over: half a sample is what decides
    assert abs(found.hold.lateness - late) < 2.0 * found.hold.half_width < 0.5
    assert found.estimate("inertia").low < 2.0 < found.estimate("inertia").high
    (sentence,) = found.assumptions
    assert sentence.startswith("Estimated from the record: between samples, the force ")
    assert f'(hold = "{hold}"); ' in sentence
    assert found.to_dict()["hold"]["hold"] == hold


@pytest.mark.slow
def test_a_given_hold_is_used_and_nothing_is_said_of_it(truth):
    hold, measurement = truth
    other = "first" if hold == "zero" else "zero"
    wrong, right = (along(measurement, one, "shooting") for one in (other, hold))
    assert (wrong.hold.hold, wrong.assumptions) == (other, ())
    assert not wrong.estimate("inertia").low < 2.0 < wrong.estimate("inertia").high
    assert right.estimate("inertia").low < 2.0 < right.estimate("inertia").high


def test_where_the_record_does_not_tell_the_hold_intervals_include_either():
    unsure = record("zero", rate=500.0, noise=3e-3, slow=0.2)
    found = fit(AXIS, CoulombViscous, unsure, route="shooting")
    assert not found.hold.told
    assert found.hold.unsure == 1.0
    assert "intervals include half a sample" in found.assumptions[0]
    for hold in ("zero", "first"):
        fitted = fit(
            AXIS, CoulombViscous, unsure, route="shooting", settings=RecordSettings(hold=hold)
        )
        for either, own in zip(found.estimates, fitted.estimates, strict=True):
            assert either.low <= own.value <= either.high


def test_measured_friction_and_free_decays_have_no_hold():
    v = np.linspace(-1.0, 1.0, 50)
    assert hold_of(Measurement(velocity=v, friction=2.0 * v), None) is None
    t = np.linspace(0.0, 5.0, 500)
    assert hold_of(Measurement(time=t, position=np.exp(-t)), None) is None


@pytest.mark.parametrize(
    ("finding", "half_samples"),
    [
        (HoldFinding(hold="zero", given=True, lateness=0.7, half_width=0.1), 0.0),
        (HoldFinding(hold="zero", lateness=0.6, half_width=0.1), 0.4),
        (HoldFinding(hold="first", lateness=-0.05, half_width=0.05), 0.2),
        (HoldFinding(hold="zero", lateness=3.0, half_width=0.25), 5.5),
        (HoldFinding(hold="zero", lateness=3.0, half_width=2.0), 1.0),
        (HoldFinding(hold="zero"), 1.0),
    ],
)
def test_how_far_a_hold_may_be_wrong_in_half_samples(finding, half_samples):
    assert finding.unsure == pytest.approx(half_samples)

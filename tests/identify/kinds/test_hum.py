"""Stick-slip features beside mains hum: the slips decide, and contradictions are refused."""

import math

import numpy as np
import pytest

from stickslip import Measurement, TowedBlock, check
from stickslip.errors import InputError
from stickslip.identify.kinds import features_of

SPEED, STIFFNESS, LOAD = 42e-6, 168.0, 0.3
WAIT = 0.64


def block(natural=25.0):
    mass = STIFFNESS / (2.0 * math.pi * natural) ** 2
    return TowedBlock(mass=mass, stiffness=STIFFNESS, speed=SPEED, load=LOAD)


def stick_slip(*, seed, hum=(), scatter=0.3, rate=1000.0, seconds=100.0, natural=25.0):
    """Return a record with random waits and drops, and the rate of its slips.

    `hum` has pairs of a frequency and a share of the variance.
    """
    draw = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / rate)
    waits = WAIT * draw.gamma(scatter**-2, scatter**2, round(2.0 * seconds / WAIT))
    at = np.cumsum(np.maximum(waits, 2.0 / natural))
    at = at[at < seconds]
    slope = STIFFNESS * SPEED / LOAD
    force, fallen = 0.32 + slope * t, 0.0
    for slip in at:
        # back to a level that scatters by a tenth of a usual drop, and half of that at least
        drop = max(slope * slip - fallen - 0.1 * slope * WAIT * draw.normal(), 0.5 * slope * WAIT)
        fallen += drop
        phase = np.clip(2.0 * natural * (t - slip), 0.0, 1.0)
        force -= 0.5 * drop * (1.0 - np.cos(math.pi * phase))
    force += 2e-4 * draw.normal(size=len(t))
    power = force.var()
    for frequency, share in hum:
        wave = np.sin(2.0 * math.pi * frequency * t + draw.uniform(0.0, 6.0))
        force += math.sqrt(2.0 * share * power) * wave
    return Measurement(time=t, spring_force=LOAD * force), (len(at) - 1) / (at[-1] - at[0])


def without(record, frequency, rate=1000.0):
    """Return a record with a line taken out by a notch filter, as the message asks for."""
    from scipy.signal import filtfilt, iirnotch

    force = filtfilt(*iirnotch(frequency, 30.0, rate), np.asarray(record.spring_force))
    return Measurement(time=record.time, spring_force=force)


@pytest.mark.parametrize("seed", range(3))
def test_the_frequency_of_irregular_stick_slip_is_the_rate_of_its_slips(seed):
    record, rate = stick_slip(seed=seed)
    found = features_of(record, mechanism=block())
    # some small slips are missed
    assert found.frequency == pytest.approx(rate, rel=0.1)
    assert found.frequency == pytest.approx(1.0 / found.waiting_times.mean(), rel=1e-12)


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2))])
@pytest.mark.parametrize(
    ("hum", "shown"),
    [
        (((50.0, 0.002),), 50.0),
        (((49.95, 0.02),), 49.95),
        (((60.0, 0.005), (120.0, 0.002)), 60.0),
    ],
)
def test_hum_that_outweighs_the_slips_is_refused_with_both_numbers(seed, hum, shown):
    record, rate = stick_slip(seed=seed, hum=hum)
    with pytest.raises(InputError) as caught:
        features_of(record, mechanism=block())
    message = str(caught.value)
    line = float(message.partition("mains hum at ")[2].partition(" Hz")[0])
    assert line == pytest.approx(shown, abs=0.06)  # three digits
    assert "notch filter" in message
    said = float(message.partition("a rate of ")[2].partition(" Hz")[0])
    assert said == pytest.approx(rate, rel=0.15)


@pytest.mark.parametrize("seed", range(3))
def test_the_cure_of_the_message_works(seed):
    hummed, rate = stick_slip(seed=seed, hum=((50.0, 0.01),))
    found = features_of(without(hummed, 50.0), mechanism=block())
    assert found.frequency == pytest.approx(rate, rel=0.1)


def test_a_line_that_is_none_of_the_mains_contradicts_the_slips_as_well():
    record, _ = stick_slip(seed=0, hum=((37.0, 0.02),))
    with pytest.raises(InputError, match=r"at 37 Hz, but \d+ slips are .* on average"):
        features_of(record, mechanism=block())


@pytest.mark.parametrize("mains", [50.0, 60.0])
@pytest.mark.parametrize("natural", [8.0, 25.0, 80.0])
@pytest.mark.parametrize("amplitude", [0.003, 0.1])
def test_hum_without_stick_slip_is_refused(mains, natural, amplitude):
    t = np.arange(0.0, 20.0, 1e-3)
    noise = 0.002 * np.random.default_rng(0).normal(size=len(t))
    force = 0.3 * (1.0 + noise + amplitude * np.sin(2.0 * math.pi * mains * t))
    with pytest.raises(InputError, match=rf"mains hum and no stick-slip.*{mains:.0f} Hz"):
        features_of(Measurement(time=t, spring_force=LOAD * force), mechanism=block(natural))


def test_a_slow_force_without_slips_and_cycles_is_no_stick_slip():
    t = np.arange(0.0, 20.0, 1e-3)
    noise = 1e-4 * np.random.default_rng(0).normal(size=len(t))
    record = Measurement(
        time=t, spring_force=LOAD * (0.3 + 0.05 * np.sin(2.0 * math.pi * t / 15.0) + noise)
    )
    with pytest.raises(InputError, match="fewer than four slips"):
        features_of(record, mechanism=block())


@pytest.mark.parametrize("rate", [95.0, 500.0, 2000.0])
@pytest.mark.parametrize("mains", [50.0, 60.0])
def test_check_names_mains_hum_with_its_harmonics(rate, mains):
    harmonics = ((3.0 * mains, 0.001),) if rate > 6.0 * mains else ()
    record, _ = stick_slip(seed=1, hum=((mains, 0.004), *harmonics), rate=rate)
    (finding,) = check(record).of("mains hum")
    assert "mains hum" in str(finding)
    assert finding.severity == "warning"
    seen = min(mains, rate - mains)  # sampling at 95 Hz folds it
    assert finding.numbers["frequency"] == pytest.approx(seen, abs=0.1)
    if harmonics:
        assert f"harmonics at {3.0 * mains:.0f} Hz" in str(finding)
        assert finding.numbers["share"] == pytest.approx(0.005, rel=0.15)


@pytest.mark.parametrize("frequency", [1.0, 5.0, 10.0, 12.5, 16.6666, 25.0, 30.0])
def test_a_motion_with_a_harmonic_at_a_mains_frequency_is_no_hum(frequency):
    t = np.arange(0.0, 20.0, 1e-3)
    noise = 1e-3 * np.random.default_rng(0).normal(size=len(t))
    for wave in ((frequency * t) % 1.0, np.sign(np.sin(2.0 * math.pi * frequency * t) + 0.3)):
        assert not check(Measurement(time=t, spring_force=wave + noise)).of("mains hum")


def test_noise_has_no_hum():
    for seed in range(40):
        draw = np.random.default_rng(seed)
        noise = draw.normal(size=int(draw.choice([300, 2000, 10_000])))
        force = np.cumsum(noise) if seed % 2 else noise
        record = Measurement(time=1e-3 * np.arange(len(force)), spring_force=force)
        assert not check(record).of("mains hum")
